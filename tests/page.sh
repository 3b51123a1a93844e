#!/usr/bin/env bash
# The page of a report in headless Chromium: no error in its console, no wider than a phone, tables that sort.
# Usage: tests/page.sh DIR [OUT]: DIR has index.html; screenshots go to OUT (default target/page).
set -euo pipefail

dir=${1:?directory of a report}
out=${2:-target/page}
page=$(realpath "$dir/index.html")

browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
if [ -z "$browser" ]; then
    echo "page check skipped: no chromium on this machine"
    exit 0
fi
mkdir -p "$out"
profile=$(mktemp -d)
trap 'rm -rf "$profile"' EXIT

chromium() {
    "$browser" --headless --no-sandbox --disable-gpu --disable-dev-shm-usage --hide-scrollbars \
        --no-first-run --user-data-dir="$profile/data" --enable-logging=stderr "$@"
}

fail() {
    echo "page check failed: $*" >&2
    exit 1
}

# What the page says of itself when its script has run: width, and the first column of the first table sorted twice.
probe=$profile/probe.html
cat "$page" - >"$probe" <<'PROBE'
<script>
const said = [document.documentElement.scrollWidth <= innerWidth ? "fits" : "wider than the window"];
const table = document.querySelector("table");
if (table) {
  const button = table.querySelector("th button");
  const first = () => [...table.tBodies[0].rows].map((row) => row.cells[0].textContent);
  button.click();
  const up = first();
  button.click();
  const down = first();
  said.push(up[0] === down[down.length - 1] ? "sorts" : "does not sort");
}
document.title = said.join(", ");
</script>
PROBE

for size in 1280,1600 390,844; do
    log=$profile/log
    chromium --window-size="$size" --dump-dom "file://$probe" >"$profile/dom" 2>"$log" || fail "chromium ended with $?"
    said=$(grep -o '<title>[^<]*' "$profile/dom" | head -n 1)
    if grep -q 'CONSOLE' "$log"; then
        grep 'CONSOLE' "$log" >&2
        fail "messages in the console at $size"
    fi
    case $said in
    *"fits"*) ;;
    *) fail "$size: ${said#<title>}" ;;
    esac
    case $said in
    *"does not sort"*) fail "$size: ${said#<title>}" ;;
    esac
    chromium --window-size="$size" --screenshot="$out/page-${size%,*}.png" "file://$page" 2>/dev/null >&2 ||
        fail "no screenshot at $size"
    echo "page at $size: ${said#<title>}; $out/page-${size%,*}.png"
done
