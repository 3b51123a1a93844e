#!/usr/bin/env bash
# The page of a report in headless Chromium: no error in its console, no wider than a phone, at most twelve screens tall,
# tables that sort, links that lead somewhere, a name for every picture; no grave finding of axe-core; screenshots light and
# dark. Before the page a broken one has to fail.
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
if ! command -v node >/dev/null || ! command -v npm >/dev/null; then
    echo "page check failed: no node or npm on this machine; Debian has them: apt-get install nodejs npm" >&2
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

# Screens of 1000 px at 1280 px, as the page opens.
screens=12

# What the page says of itself when its script has run: width, height as opened, the first column of the first table
# sorted twice, links within it that lead nowhere, pictures without words.
probing() {
    cat "$1" - >"$profile/probe.html" <<'PROBE'
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
const ids = [...document.querySelectorAll("[id]")].map((element) => element.id);
const mute = document.querySelectorAll("svg:not([aria-label])");
said.push(lost.length + mute.length + ids.length - new Set(ids).size === 0 ? "sound" : "links, names or words are lost");
parent.postMessage({ text: said.join(", ") + `, ${innerWidth} x ${height} px`, height }, "*");
</script>
PROBE
}

# A window of the browser has a least width, a frame has none.
framed() {
    cat >"$profile/frame.html" <<FRAME
<!DOCTYPE html><html lang="en"><title>silent</title><body style="margin:0">
<script>addEventListener("message", (event) => { document.title = event.data.text; });</script>
<iframe src="file://$2" width="${1%,*}" height="${1#*,}" style="border:0;display:block"></iframe></body></html>
FRAME
}

# What is wrong with a page at a size; nothing if it is right. What it says of itself is left in $profile/said.
wrong() {
    local size=$1 log=$profile/log said height
    probing "$2"
    framed "$size" "$profile/probe.html"
    chromium --window-size=1300,1000 --virtual-time-budget=20000 --dump-dom "file://$profile/frame.html" \
        >"$profile/dom" 2>"$log" || { echo "chromium ended with $?"; return; }
    said=$(grep -o '<title>[^<]*' "$profile/dom" | head -n 1)
    said=${said#<title>}
    echo "$said" >"$profile/said"
    height=$(sed -n 's/.* x \([0-9]*\) px$/\1/p' "$profile/said")
    if grep -q 'CONSOLE' "$log"; then
        echo "messages in the console: $(grep -m 1 'CONSOLE' "$log")"
        return
    fi
    case $said in
    *"does not sort"* | *"lost"*) echo "$said" ;;
    fits*)
        if [ "${size%,*}" = 1280 ] && [ "$height" -gt $((screens * 1000)) ]; then
            echo "$height px tall as it opens, and $((screens * 1000)) are allowed"
        fi
        ;;
    *) echo "$said" ;;
    esac
}

# A page that is too tall, and one with a link that leads nowhere.
seeded=$profile/seeded.html
for defect in "<div style='height:${screens}001px'>tall</div>" "<a href='#nowhere'>lost</a>"; do
    { cat "$page"; echo "$defect"; } >"$seeded"
    [ -n "$(wrong 1280,1000 "$seeded")" ] || fail "a page with $defect passes"
done

for size in 1280,1000 390,844; do
    found=$(wrong "$size" "$page")
    [ -z "$found" ] || fail "$size: $found"
    said=$(cat "$profile/said")
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

# axe-core and the driver of the browser are installed once, beside the screenshots.
axe=$(realpath "$(dirname "$0")/axe.mjs")
tools=$(realpath "$out")/axe
browser=$(command -v "$browser")
if [ ! -d "$tools/node_modules/axe-core" ] || [ ! -d "$tools/node_modules/puppeteer-core" ]; then
    npm install --silent --no-audit --no-fund --prefix "$tools" axe-core@4.14.1 puppeteer-core@24.43.1 ||
        fail "axe-core could not be installed from npm"
fi
cat >"$seeded" <<'SEEDED'
<!DOCTYPE html><html><title>seeded</title><body><main><h1>seeded</h1><img src="data:,">
<p style="color:#bbb;background:#fff">too pale</p></main></body></html>
SEEDED
if (cd "$tools" && node "$axe" "$browser" "$seeded" >/dev/null 2>&1); then
    fail "axe-core finds nothing on a page with pale words and a picture without words"
fi
(cd "$tools" && node "$axe" "$browser" "$page") || fail "axe-core has grave findings"
