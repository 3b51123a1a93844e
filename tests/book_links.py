"""Follows every local link, picture and anchor of the pages below a folder: python book_links.py FOLDER."""

import pathlib
import sys
import urllib.parse
from html.parser import HTMLParser


class Page(HTMLParser):
    """Targets and anchors of a page."""

    def __init__(self, text):
        super().__init__()
        self.targets, self.anchors = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id":
                self.anchors.add(value)
            elif (tag, name) in {("a", "href"), ("img", "src")} and value:
                self.targets.append(value)


def broken(folder):
    pages = {path.resolve(): Page(path.read_text("utf-8")) for path in folder.rglob("*.html")}
    for path, page in pages.items():
        if path.name in {"print.html", "404.html", "toc.html"}:
            continue
        for target in page.targets:
            url = urllib.parse.urlsplit(target)
            if url.scheme or url.netloc:
                continue
            file = path
            if url.path:
                file = (path.parent / urllib.parse.unquote(url.path)).resolve()
            anchor = urllib.parse.unquote(url.fragment)
            if not file.exists():
                yield f"{path.name}: {target} is not there"
            elif anchor and file in pages and anchor not in pages[file].anchors:
                yield f"{path.name}: {target} has no such section"


if __name__ == "__main__":
    root = pathlib.Path(sys.argv[1])
    found = sorted(set(broken(root)))
    print("\n".join(found) or f"{sum(1 for _ in root.rglob('*.html'))} pages, no broken link")
    sys.exit(bool(found))
