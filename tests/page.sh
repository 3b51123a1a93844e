#!/usr/bin/env bash
# The page of a report in headless Chromium: no error in its console, no wider than a phone, tables that sort,
# links that lead somewhere, a name for every picture; screenshots light and dark.
# Usage: tests/page.sh DIR [OUT]: DIR has index.html; screenshots go to OUT (default target/page).
set -euo pipefail

dir=${1:?directory of a report}
out=${2:-target/page}
page=$(realpath "$dir/index.html")

browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
if [ -z "$browser" ]; then
    echo "page check failed: no chromium on this machine; Debian has it: apt-get install chromium" >&2
    exit 1
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

# What the page says of itself when its script has run: width, height as opened, the first column of the first table
# sorted twice, links within it that lead nowhere, pictures without words.
probe=$profile/probe.html
cat "$page" - >"$probe" <<'PROBE'
<script>
const said = [document.documentElement.scrollWidth <= innerWidth ? "fits" : "wider than the window"];
const height = document.documentElement.scrollHeight;
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
const lost = [...document.querySelectorAll("a[href^='#']")].filter((a) => !document.getElementById(a.hash.slice(1)));
const ids = [...document.querySelectorAll("[id]")].map((own) => own.id);
const mute = document.querySelectorAll("svg:not([aria-label])");
said.push(lost.length + mute.length + ids.length - new Set(ids).size === 0 ? "sound" : "links, names or words are lost");
parent.postMessage({ text: said.join(", ") + `, ${innerWidth} x ${height} px`, height }, "*");
</script>
PROBE

# A window of the browser has a least width, a frame has none.
framed() {
    cat >"$profile/frame.html" <<FRAME
<!DOCTYPE html><html lang="en"><title>silent</title><body style="margin:0">
<script>addEventListener("message", (event) => { document.title = event.data.text; });</script>
<iframe src="file://$2" width="${1%,*}" height="${1#*,}" style="border:0;display:block"></iframe></body></html>
FRAME
}

for size in 1280,1000 390,844; do
    log=$profile/log
    framed "$size" "$probe"
    chromium --window-size=1300,1000 --virtual-time-budget=20000 --dump-dom "file://$profile/frame.html" \
        >"$profile/dom" 2>"$log" || fail "chromium ended with $?"
    said=$(grep -o '<title>[^<]*' "$profile/dom" | head -n 1)
    said=${said#<title>}
    if grep -q 'CONSOLE' "$log"; then
        grep 'CONSOLE' "$log" >&2
        fail "messages in the console at $size"
    fi
    case $said in
    *"does not sort"* | *"lost"*) fail "$size: $said" ;;
    fits*) ;;
    *) fail "$size: $said" ;;
    esac
    for scheme in light dark; do
        framed "$size" "$page"
        # 0 is dark, 1 is light.
        chromium --blink-settings="preferredColorScheme=$([ $scheme = dark ] && echo 0 || echo 1)" \
            --window-size="$((${size%,*} > 500 ? ${size%,*} : 500)),${size#*,}" \
            --screenshot="$out/page-${size%,*}-$scheme.png" "file://$profile/frame.html" 2>/dev/null >&2 ||
            fail "no screenshot at $size"
    done
    echo "page at $said; $out/page-${size%,*}-light.png"
done
