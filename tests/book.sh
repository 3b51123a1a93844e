#!/usr/bin/env bash
# The documents as a book, and every link and picture of its pages followed. Pages link to sources and to pages outside of
# docs/, so the book is built from a copy of what git keeps. usage: tests/book.sh MDBOOK PYTHON OUT
set -euo pipefail
cd "$(dirname "$0")/.."
mdbook=$1 python=$2 out=$PWD/$3
rm -rf "$out"
mkdir -p "$out/source"
git ls-files -z --cached --others --exclude-standard |
    while IFS= read -r -d '' file; do [ -f "$file" ] && printf '%s\0' "$file"; done |
    tar --null --files-from - --create --file - | tar --extract --file - --directory "$out/source"
cp docs/book.toml "$out/source/book.toml"
# The table of contents names pages as docs/ sees them.
sed -E 's#\]\(([A-Za-z])#](docs/\1#; s#\]\(\.\./#](#' docs/SUMMARY.md >"$out/source/SUMMARY.md"
"$mdbook" build "$out/source" --dest-dir "$out/html"
"$python" tests/book_links.py "$out/html"
# A link that leads nowhere is found.
rm -rf "$out/broken"
mkdir "$out/broken"
echo '<a href="nowhere.html">x</a>' >"$out/broken/index.html"
if "$python" tests/book_links.py "$out/broken" >/dev/null; then
    echo "book: a broken link is not found" >&2
    exit 1
fi
