#!/usr/bin/env bash
#SBATCH --ntasks=1 --cpus-per-task=1 --mem=2G --time=60
# A sweep by an array of Slurm's jobs, in the directory of cases.txt. With ARGUMENTS those of the list, EACH cases a job:
#     sweep run $ARGUMENTS --list-cases > cases.txt
#     sbatch --array=0-$(((($(wc -l < cases.txt) - 1) / EACH))) --export=ALL,ARGUMENTS,EACH array.sh
#     sweep merge parts --cases cases.txt --out merged
# Submitted again after failures, it runs what is missing.
set -euo pipefail
each=${EACH:-10}
mapfile -t keys < <(tail -n "+$((SLURM_ARRAY_TASK_ID * each + 1))" cases.txt | head -n "$each")
# ARGUMENTS are words.
# shellcheck disable=SC2086
exec "${SWEEP:-sweep}" run ${ARGUMENTS:-} --jobs 1 --resume --out "parts/$SLURM_ARRAY_TASK_ID" --only "${keys[@]}"
