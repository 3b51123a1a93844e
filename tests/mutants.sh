#!/usr/bin/env bash
# Mutation tests of the modules that need no solver. `cargo mutants` builds and tests the whole crate once a mutant;
# this lays out two crates of the same files in target/mutants, which build in a second.
#
# usage: tests/mutants.sh [law] [history] [fit] [verdict]     (default: all four)
set -euo pipefail
cd "$(dirname "$0")/.."

command -v cargo-mutants >/dev/null || {
    echo "mutants: cargo-mutants is missing: cargo install cargo-mutants --locked" >&2
    exit 2
}
[ $# -gt 0 ] || set -- law history fit verdict

# lay_out NAME DEPENDENCIES MODULES...: a crate of these modules, with the dependencies of this one.
lay_out() {
    local slim=target/mutants/$1 dependencies=$2
    shift 2
    rm -rf "$slim/src"
    mkdir -p "$slim/src"
    for module in "$@"; do
        if [ -d "src/$module" ]; then cp -R "src/$module" "$slim/src"; fi
        if [ -f "src/$module.rs" ]; then cp "src/$module.rs" "$slim/src"; fi
        printf 'pub mod %s;\n' "$module"
    done >"$slim/src/lib.rs"
    if [ -d "$slim/src/linalg" ]; then
        # Of linalg only the generator of random numbers and the sums of vectors.
        find "$slim/src/linalg" -type f ! -name random.rs -delete
        {
            perl -0pe 's/^pub use [^;]*;\n//mg; s/^mod \w+;\n//mg' src/linalg/mod.rs
            printf 'mod random;\npub use random::signed_unit;\n'
        } >"$slim/src/linalg/mod.rs"
    fi
    {
        printf '[workspace]\n[package]\nname = "slim"\nversion = "0.0.0"\nedition = "2024"\n[dependencies]\n'
        grep -E "^($dependencies) = " Cargo.toml
        printf '[profile.dev]\nopt-level = 1\ndebug = false\n[profile.dev.package."*"]\nopt-level = 3\n'
    } >"$slim/Cargo.toml"
    cp Cargo.lock "$slim"
}

lay_out laws 'nalgebra|thiserror' tensor linalg law history
lay_out judges 'comfy-table|csv|nalgebra|serde|serde_json|statrs|thiserror' record fit verdict

status=0
for module in "$@"; do
    case $module in
    law | history) slim=laws ;;
    fit | verdict) slim=judges ;;
    *) echo "mutants: no slim crate holds $module: law, history, fit, verdict" >&2; exit 2 ;;
    esac
    # In place: a copy would build its dependencies anew. Survivors are status 2, which ends nothing here.
    # Of its two builds, library and unit tests, a mutant needs the second. What an earlier run caught is not run again
    # (remove target/mutants/MODULE to begin anew), so that an interrupted run goes on.
    cargo mutants --dir "target/mutants/$slim" --output "target/mutants/$module" --in-place --timeout 120 \
        --cargo-arg=--lib --iterate -f "src/$module/**" || status=$?
done
exit "$status"
