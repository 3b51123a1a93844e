#!/usr/bin/env bash
# Written by `sweep plan --format slurm`. One task of a job array: submit.sh says which file of job numbers it reads.
set -euo pipefail
job=$(sed -n "$((SLURM_ARRAY_TASK_ID + 1))p" "$1")
if [ -z "$job" ]; then
    echo "$1 has no line $((SLURM_ARRAY_TASK_ID + 1))" >&2
    exit 2
fi
# Records that are there are kept, and what a killed task had finished is not run again.
exec "${SWEEP:-sweep}" case --job "$job" --plan . --out "parts/$job"
