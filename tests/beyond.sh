#!/usr/bin/env bash
# A sweep in many processes against the same sweep in one: by Snakemake on two cores, killed midway and resumed, and by
# the tasks of a Slurm array, one after the other without Slurm. usage: tests/beyond.sh SWEEP SNAKEMAKE
set -euo pipefail
cd "$(dirname "$0")/.."
sweep=$(realpath "$1") snakemake=$(realpath "$2")
python=$(dirname "$snakemake")/python
scenes="affine signorini steady memory-minus-identity pure-strong"
root=$PWD out=target/beyond
rm -rf "$out"
mkdir -p "$out"/{flow,slurm}
out=$(realpath "$out")
# Nothing is written to the user's cache.
export XDG_CACHE_HOME=$out/cache

say() { printf '%s beyond: %s\n' "$(date -u +%H:%M:%S)" "$*"; }
stop() {
    say "$*" >&2
    exit 1
}

# Both directories hold the same: all of cases.csv but seconds_*, all of verdict.json but what ran it.
same='
import csv, json, sys
def rows(path):
    with open(path) as table:
        return [{k: v for k, v in row.items() if not k.startswith("seconds_")} for row in csv.DictReader(table)]
def verdict(path):
    with open(path) as file:
        document = json.load(file)
    del document["provenance"]["run"]
    return document
one, many = sys.argv[1:]
assert rows(f"{one}/cases.csv") == rows(f"{many}/cases.csv"), "cases.csv differs"
assert verdict(f"{one}/verdict.json") == verdict(f"{many}/verdict.json"), "verdict.json differs"
'

# shellcheck disable=SC2086
"$sweep" run $scenes --out "$out/whole" --jobs 2 --quiet >/dev/null
# shellcheck disable=SC2086
"$sweep" run $scenes --list-cases | tee "$out/flow/cases.txt" >"$out/slurm/cases.txt"
jobs=$((($(wc -l <"$out/flow/cases.txt") + 3) / 4))

# The scenes are those of this folder, wherever the jobs run.
arguments="--scenes $root/manufactured $scenes"
flow=("$snakemake" --directory "$out/flow" --snakefile docs/beyond/Snakefile --cores 2
    --config "sweep=$sweep" "arguments=$arguments" each=4)
parts() { find "$out/flow/parts" -path '*/cases.csv' 2>/dev/null | wc -l; }

# In a new session: the kill takes Snakemake with all that it has started, and nothing else.
setsid "${flow[@]}" </dev/null >"$out/killed.log" 2>&1 &
group=$!
for ((tries = 0; tries < 6000 && $(parts) < 3; tries++)); do
    kill -0 "$group" 2>/dev/null || break
    sleep 0.01
done
kill -KILL -- "-$group" 2>/dev/null || stop "snakemake ended before it could be killed: $(cat "$out/killed.log")"
wait "$group" 2>/dev/null || true
begun=$(parts)
[ "$begun" -gt 0 ] && [ "$begun" -lt "$jobs" ] || stop "nothing was killed midway: $begun of $jobs jobs begun"
status=0
"$sweep" merge "$out/flow/parts" --cases "$out/flow/cases.txt" --out "$out/early" >"$out/early.log" 2>&1 || status=$?
[ "$status" = 2 ] || stop "merged too early: $(cat "$out/early.log")"
"${flow[@]}" --unlock >"$out/unlock.log" 2>&1 || stop "$(cat "$out/unlock.log")"
"${flow[@]}" --rerun-incomplete >"$out/resumed.log" 2>&1 || stop "$(tail -n 40 "$out/resumed.log")"
"$python" -c "$same" "$out/whole" "$out/flow/merged" || stop "Snakemake and one process differ"

cd "$out/slurm"
array() {
    for ((task = 0; task < jobs; task++)); do
        ARGUMENTS=$arguments EACH=4 SWEEP=$sweep SLURM_ARRAY_TASK_ID=$task bash "$root/docs/beyond/array.sh"
    done >"$out/slurm.log" 2>&1 || stop "$(tail -n 20 "$out/slurm.log")"
}
array
"$sweep" merge parts --cases cases.txt --out merged --quiet >/dev/null
"$python" -c "$same" "$out/whole" merged || stop "the array and one process differ"
# Submitted again, nothing is computed again.
array
grep -q '\] .* done' "$out/slurm.log" && stop "cases ran twice: $(cat "$out/slurm.log")"

# The comparison sees the last bit of one error.
"$python" - merged/cases.csv <<'ALTER'
import csv, math, sys
with open(sys.argv[1]) as file:
    rows = list(csv.reader(file))
column = rows[0].index("error")
rows[7][column] = repr(math.nextafter(float(rows[7][column]), 1.0))
with open(sys.argv[1], "w") as file:
    csv.writer(file, lineterminator="\n").writerows(rows)
ALTER
"$python" -c "$same" "$out/whole" merged 2>/dev/null && stop "an altered error was not seen"
say "$jobs jobs by Snakemake (killed with $begun begun, and resumed) and by an array: bit for bit the sweep of one process"
