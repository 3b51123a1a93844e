#!/usr/bin/env bash
# The LaTeX tables of a report, compiled: no error, no sign that LaTeX does not know, nothing wider than the page.
# Usage: tests/latex.sh DIR [OUT]: DIR has tables.tex; tables.pdf goes to OUT (default target/latex).
# PDFLATEX names the program. Without one the check fails; booktabs.sty is replaced by three rules where it is missing.
set -euo pipefail

tables=$(realpath "${1:?directory of a report}/tables.tex")
out=${2:-target/latex}

latex=$(command -v "${PDFLATEX:-pdflatex}" || true)
if [ -z "$latex" ]; then
    echo "LaTeX check failed: no pdflatex on this machine; \`make latex\` brings a small TeX" >&2
    exit 1
fi
rm -rf "$out"
mkdir -p "$out"
cd "$out"
cp "$tables" tables.tex

fail() {
    echo "LaTeX check failed: $*" >&2
    exit 1
}

ended=0
"$latex" -interaction=nonstopmode -halt-on-error -draftmode tables.tex >said 2>&1 || ended=$?
rules=
if [ $ended -ne 0 ] && grep -q "booktabs.sty' not found" said; then
    rules=", with plain rules for booktabs"
    for rule in toprule=0.8pt midrule=0.4pt bottomrule=0.8pt; do
        echo "\\newcommand\\${rule%=*}{\\noalign{\\hrule height ${rule#*=}}}"
    done >booktabs.sty
fi
# longtable settles the widths of its columns in three runs.
for _ in 1 2 3; do
    "$latex" -interaction=nonstopmode -halt-on-error tables.tex >said 2>&1 || {
        grep -A 4 '^!' said >&2
        fail "$(basename "$latex") ended with an error"
    }
done
if grep -q 'Missing character' tables.log; then
    grep 'Missing character' tables.log >&2
    fail "characters without a glyph"
fi
# Less than a letter beyond the margin is not seen.
wide=$(sed -n 's/^Overfull .hbox (\([0-9]*\)\.[0-9]*pt too wide.*/\1/p' tables.log | sort -n | tail -n 1)
if [ "${wide:-0}" -gt 5 ]; then
    grep 'Overfull' tables.log >&2
    fail "a table is $wide pt wider than the page"
fi
pages=$(sed -n 's/^Output written on .*(\([0-9]*\) pages.*/\1/p' tables.log)
echo "tables.tex: $pages pages$rules; $out/tables.pdf"
