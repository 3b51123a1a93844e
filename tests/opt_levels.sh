#!/usr/bin/env bash
# The same gate from programs of different optimisation levels: records bit-identical but for the clock, verdicts too.
# Dependencies keep their level; the code of the crate, and what it instantiates of theirs, is compiled anew.
#
# usage: tests/opt_levels.sh [SCENE ...]     LEVELS="0 1 2 3" by default; the first is what the others are compared with
set -euo pipefail
cd "$(dirname "$0")/.."

levels=${LEVELS:-0 1 2 3}
[ $# -gt 0 ] || set -- affine affine-random broken-m0-at broken-body-end in-space signorini compliance steady
out=target/opt-levels

timeless() { # the table without its seconds
    awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i !~ /^seconds_/) keep[++m] = i }
             { for (i = 1; i <= m; i++) printf "%s%s", $keep[i], i < m ? "," : "\n" }' "$1"
}
verdicts() { sed -n '/^  "verdicts"/,$p' "$1"; }

first=
for level in $levels; do
    CARGO_PROFILE_DEV_OPT_LEVEL=$level cargo build --quiet --bin sweep
    run=$out/$level
    rm -rf "$run"
    # Without a verdict to await: 1 is an answer, 2 is none.
    target/debug/sweep run "$@" --out "$run" >/dev/null || [ $? -eq 1 ]
    timeless "$run/cases.csv" >"$run/timeless.csv"
    verdicts "$run/verdict.json" >"$run/verdicts.json"
    if [ -n "$first" ]; then
        cmp "$out/$first/timeless.csv" "$run/timeless.csv"
        cmp "$out/$first/verdicts.json" "$run/verdicts.json"
    fi
    echo "opt-level $level: $(($(wc -l <"$run/timeless.csv") - 1)) rows${first:+, those of opt-level $first}"
    first=${first:-$level}
done
