"""Every link of a built site that stays within it leads somewhere; every other one is an address, well formed."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

FOREIGN = re.compile(
    r"https://([a-z0-9]([a-z0-9-]*[a-z0-9])?\.)+[a-z]{2,}(/[\w./~@:+,=&%-]*)?(\?[\w./~=&%+-]+)?(#[\w./~=&%+-]+)?"
)
"""An address of another site: encrypted, with a name, and with nothing in it that only a slip brings there."""


class _Page(HTMLParser):
    """The addresses that a page has, the places in it, and what it loads from elsewhere."""

    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.places: set[str] = set()
        self.loaded: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = {key: value or "" for key, value in attrs}
        self.places |= {found[key] for key in ("id", "name") if key in found}
        address = found.get("href" if tag in ("a", "link") else "src", "")
        if address:
            self.links.append(address)
        relation = found.get("rel", "")
        if tag in ("script", "img", "iframe") or (tag == "link" and "stylesheet" in relation):
            self.loaded.append(address)


def broken(folder: Path) -> list[str]:
    """What is wrong with a site: links that lead nowhere or are malformed, and whatever is loaded over a network."""
    pages: dict[Path, _Page] = {}
    for path in sorted(folder.rglob("*.html")):
        pages[path] = _Page()
        pages[path].feed(path.read_text("utf-8"))
    wrong = []
    for path, page in pages.items():
        told = path.relative_to(folder)
        wrong += [
            f"{told}: loads {address[:80]}" for address in page.loaded if urlsplit(address).scheme in ("http", "https")
        ]
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme == "data":
                continue
            if parts.scheme or parts.netloc:
                if FOREIGN.fullmatch(link) is None or link[-1] in ".,:":
                    wrong.append(f"{told}: {link[:80]} is no address of another site")
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not target.is_file():
                wrong.append(f"{told}: {link} leads to no file")
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].places:
                wrong.append(f"{told}: {link} leads to no place in its page")
    return wrong


def same_titles(site: Path) -> list[str]:
    """Pages that have one title, which a reader of a list of tabs or of results cannot tell apart.

    Args:
        site: a folder of pages; those of `reports/` bear the names of their scenes, and are left out.
    """
    titles: dict[str, list[str]] = {}
    for path in sorted(site.rglob("*.html")):
        name = path.relative_to(site).as_posix()
        found = re.search(r"<title>(.*?)</title>", path.read_text("utf-8"), re.DOTALL)
        if found and not name.startswith("reports/"):
            titles.setdefault(" ".join(found[1].split()), []).append(name)
    return [f"{', '.join(names)}: have one title: {title}" for title, names in titles.items() if len(names) > 1]
