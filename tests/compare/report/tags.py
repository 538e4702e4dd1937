"""A page as tags: what is open, what it loads, where it links to, the files to save from it."""

from __future__ import annotations

import base64
import gzip
from html.parser import HTMLParser

VOID = ("meta", "link", "img", "br", "input", "hr", "wbr")


class Tags(HTMLParser):
    """Collects tags, the addresses in them, links within the page, the files to save, and the text of scripts."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.resources: list[str] = []
        self.files: dict[str, str] = {}
        self.scripts: dict[str, str] = {}
        self.places: set[str] = set()
        self.within: set[str] = set()
        self._script: str | None = None

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.places.add(given.get("id") or "")
        if tag not in VOID:
            self.open.append(tag)
        if tag == "a" and "download" in given:
            self.files[str(given["download"])] = str(given["href"])
            return
        if tag == "a" and str(given["href"]).startswith("#"):
            self.within.add(str(given["href"])[1:])
            return
        self.resources += [value or "" for key, value in attrs if key in ("src", "href", "srcset", "action")]
        if tag == "script":
            self._script = given.get("id") or given.get("type") or ""

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag
        self._script = None

    def handle_data(self, data: str) -> None:
        if self._script is not None:
            self.scripts[self._script] = self.scripts.get(self._script, "") + data


def tags(text: str) -> Tags:
    """The tags of a page."""
    found = Tags()
    found.feed(text)
    return found


def saved(text: str, ending: str) -> str:
    """The contents of the file that a page offers under a name with this ending."""
    (address,) = [a for name, a in tags(text).files.items() if name.endswith(ending)]
    data = base64.b64decode(address.partition("base64,")[2])
    return (gzip.decompress(data) if ending.endswith(".gz") else data).decode()
