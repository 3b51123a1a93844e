#!/usr/bin/env bash
# Mutation tests of the modules that need no solver; their crates build in seconds.
#
# usage: tests/mutants.sh [law] [history] [fit] [verdict]     (default: all four)
set -euo pipefail
cd "$(dirname "$0")/.."

command -v cargo-mutants >/dev/null || {
    echo "mutants: cargo-mutants is missing: cargo install cargo-mutants --locked" >&2
    exit 2
}
[ $# -gt 0 ] || set -- law history fit verdict

status=0
for module in "$@"; do
    case $module in
    law | history) crate=vhi path=src/$module ;;
    fit) crate=fit path=src ;;
    verdict) crate=judge path=src/$module ;;
    *) echo "mutants: $module is not one of law, history, fit, verdict" >&2; exit 2 ;;
    esac
    # In place: a copy would build its dependencies anew. Survivors are status 2, which ends nothing here.
    # Of its two builds, library and unit tests, a mutant needs the second. What an earlier run caught is not run again
    # (remove target/mutants/MODULE to begin anew), so that an interrupted run goes on.
    cargo mutants --package "gronwall-$crate" --output "target/mutants/$module" --in-place --timeout 120 \
        --cargo-arg=--lib --iterate -f "crates/$crate/$path/**" || status=$?
done
exit "$status"
