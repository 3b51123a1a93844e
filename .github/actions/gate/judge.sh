#!/usr/bin/env bash
# One judging command with records, JUnit and report in one directory, in CI of whatever kind.
#
# SWEEP    the program
# COMMAND  its arguments, as on a command line: quotes hold words together
# REPORT   directory for what it writes
# SCENES   folder of scenes; empty: those inside the program, or of manufactured/ where that is here
set -euo pipefail

: "${SWEEP:?the program}" "${COMMAND:?its arguments}" "${REPORT:?a directory}"
# Words as a shell reads them, without expanding anything in them.
words=()
while IFS= read -r -d '' word; do words+=("$word"); done < <(xargs printf '%s\0' <<<"$COMMAND")

scenes=${SCENES:-}
mkdir -p "$REPORT"
case ${words[0]} in
fit) exec "$SWEEP" "${words[@]}" --junit "$REPORT/junit.xml" ;;
gate)
    status=0
    "$SWEEP" ${scenes:+--scenes "$scenes"} "${words[@]}" --out "$REPORT" --junit "$REPORT/junit.xml" || status=$?
    # The gate writes records and verdicts; pages come from them without solving, and repeat its exit code.
    "$SWEEP" report "$REPORT" >/dev/null || true
    exit "$status"
    ;;
verify)
    exec "$SWEEP" ${scenes:+--scenes "$scenes"} "${words[@]}" --out "$REPORT" --junit "$REPORT/junit.xml"
    ;;
*)
    echo "gate: \`${words[0]}\` judges nothing here: gate, verify or fit" >&2
    exit 2
    ;;
esac
