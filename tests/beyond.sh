#!/usr/bin/env bash
# A sweep in many processes against the same sweep in one: by Snakemake on two cores, killed midway and resumed, and by
# the tasks of the Slurm arrays. No Slurm is needed: `sbatch` is a stand-in that runs the tasks of an array one after
# the other. usage: tests/beyond.sh SWEEP SNAKEMAKE
set -euo pipefail
cd "$(dirname "$0")/.."
sweep=$(realpath "$1") snakemake=$(realpath "$2")
python=$(dirname "$snakemake")/python
scenes=(affine signorini steady memory-minus-identity pure-strong)
out=target/beyond
rm -rf "$out"
mkdir -p "$out"
out=$(realpath "$out")

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

"$sweep" run "${scenes[@]}" --out "$out/whole" --jobs 2 --quiet >/dev/null
"$sweep" plan "${scenes[@]}" --out "$out/plan" --format snakemake --seconds 1 --quiet
jobs=$(($(wc -l <"$out/plan/jobs.csv") - 1))

# Nothing is written to the user's cache.
export XDG_CACHE_HOME=$out/cache
flow=("$snakemake" --directory "$out/plan" --snakefile "$out/plan/Snakefile" --cores 2 --config "sweep=$sweep")
parts() { find "$out/plan/parts" -path "*/$1" 2>/dev/null | wc -l; }

# In a new session: the kill takes Snakemake with all that it has started, and nothing else.
setsid "${flow[@]}" </dev/null >"$out/killed.log" 2>&1 &
group=$!
for ((tries = 0; tries < 6000; tries++)); do
    # One part is finished, and another one begun.
    [ "$(parts cases.csv)" -gt "$(parts .unfinished/cases.csv)" ] && [ "$(parts .unfinished/cases.csv)" -gt 0 ] && break
    kill -0 "$group" 2>/dev/null || break
    sleep 0.01
done
kill -KILL -- "-$group" 2>/dev/null || stop "snakemake ended before it could be killed: $(cat "$out/killed.log")"
wait "$group" 2>/dev/null || true
begun=$(parts .unfinished/cases.csv)
done=$(($(parts cases.csv) - begun))
[ "$begun" -gt 0 ] && [ "$done" -lt "$jobs" ] || stop "nothing was killed midway: $done of $jobs jobs done, $begun begun"
sleep 1
[ "$(parts .unfinished/cases.csv)" = "$begun" ] || stop "a job outlived the kill"
status=0
"$sweep" merge "$out/plan/parts" --plan "$out/plan" --out "$out/early" >"$out/early.log" 2>&1 || status=$?
[ "$status" = 2 ] && grep -q missing "$out/early.log" || stop "merged too early: $(cat "$out/early.log")"
say "killed with $done of $jobs jobs done and $begun begun; $(cut -c1-60 "$out/early.log" | head -n 1) ..."

start=$(date +%s%N)
"${flow[@]}" --unlock >"$out/unlock.log" 2>&1 || stop "$(cat "$out/unlock.log")"
"${flow[@]}" --rerun-incomplete >"$out/resumed.log" 2>&1 || stop "$(tail -n 40 "$out/resumed.log")"
say "resumed and merged in $((($(date +%s%N) - start) / 1000000)) ms"
"$python" -c "$same" "$out/whole" "$out/plan/merged" || stop "Snakemake and one process differ"

# Slurm: the arrays as they would be submitted.
"$sweep" plan "${scenes[@]}" --out "$out/slurm" --format slurm --seconds 1 --quiet
bash -n "$out/slurm/submit.sh"
bash -n "$out/slurm/array.sh"
mkdir "$out/bin"
cat >"$out/bin/sbatch" <<'STAND_IN'
#!/usr/bin/env bash
# Every option is one word; the first other word is the script.
set -euo pipefail
while [[ $1 == --* ]]; do
    [[ $1 == --array=0-* ]] && last=${1#--array=0-}
    shift
done
for ((task = 0; task <= last; task++)); do SLURM_ARRAY_TASK_ID=$task bash "$@"; done
STAND_IN
chmod +x "$out/bin/sbatch"
submit() { PATH="$out/bin:$PATH" SWEEP="$sweep" bash "$out/slurm/submit.sh" "$@" >"$out/slurm.log" 2>&1; }
submit --account=any || stop "$(tail -n 20 "$out/slurm.log")"
"$sweep" merge "$out/slurm/parts" --plan "$out/slurm" --out "$out/slurm/merged" --quiet >/dev/null
"$python" -c "$same" "$out/whole" "$out/slurm/merged" || stop "the arrays and one process differ"
# Submitted again, nothing is computed again.
submit || stop "$(tail -n 20 "$out/slurm.log")"
[ "$(grep -c 'recorded before' "$out/slurm.log")" = "$jobs" ] || stop "jobs ran twice: $(cat "$out/slurm.log")"

# The comparison sees the last bit of one error.
table=$out/slurm/merged/cases.csv
"$python" - "$table" <<'ALTER'
import csv, math, sys
with open(sys.argv[1]) as file:
    rows = list(csv.reader(file))
column = rows[0].index("error")
rows[7][column] = repr(math.nextafter(float(rows[7][column]), 1.0))
with open(sys.argv[1], "w") as file:
    csv.writer(file, lineterminator="\n").writerows(rows)
ALTER
"$python" -c "$same" "$out/whole" "$out/slurm/merged" 2>/dev/null && stop "an altered error was not seen"
say "$jobs jobs by Snakemake (killed and resumed) and by arrays: bit for bit the sweep of one process"
