#!/usr/bin/env bash
# Mutation tests of the modules that need no solver: `cargo mutants` builds and tests the whole crate once a
# mutant; this lays out a slim crate of the same files in target/slim, which builds in seconds.
#
# usage: tests/mutants.sh 'src/law/**' ...     (default: law, history, fit, verdict)
set -euo pipefail
cd "$(dirname "$0")/.."

command -v cargo-mutants >/dev/null || {
    echo "mutants: cargo-mutants is missing: cargo install cargo-mutants --locked" >&2
    exit 2
}
[ $# -gt 0 ] || set -- 'src/law/**' 'src/history/**' 'src/fit/**' 'src/verdict/**'

slim=${SLIM:-target/slim}
rm -rf "$slim/src"
mkdir -p "$slim/src/linalg"
cp -R src/tensor.rs src/record src/law src/history src/fit src/verdict "$slim/src"

# Of linalg only the generator of random numbers and the vector sums.
cp src/linalg/random.rs "$slim/src/linalg"
grep -v -e '^mod ' -e '^pub use ' src/linalg/mod.rs | sed 's/^$/&/' >"$slim/src/linalg/mod.rs"
printf 'mod random;\npub use random::signed_unit;\n' >>"$slim/src/linalg/mod.rs"

printf 'pub mod %s;\n' tensor record linalg law history fit verdict >"$slim/src/lib.rs"

# The same dependencies at the same versions; a test profile that builds fast. Its own workspace.
{
    printf '[workspace]\n[package]\nname = "slim"\nversion = "0.0.0"\nedition = "2024"\n'
    printf '[dependencies]\n'
    grep -E '^(comfy-table|csv|nalgebra|serde|serde_json|statrs|thiserror) = ' Cargo.toml
    printf '[profile.dev]\nopt-level = 1\ndebug = false\n[profile.dev.package."*"]\nopt-level = 3\n'
} >"$slim/Cargo.toml"
cp Cargo.lock "$slim/Cargo.lock"

files=()
for pattern in "$@"; do files+=(-f "$pattern"); done
exec cargo mutants --dir "$slim" --output "$slim" --in-place --timeout 60 --jobs 1 "${files[@]}" ${MUTANTS:-}
