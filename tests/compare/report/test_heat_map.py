"""The stress map's picture in a real browser: all labels whole, none over the cells, on light and on dark pages."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from browser import Browser, found

from truebreak.compare.grids.stress_families import stress_family
from truebreak.compare.grids.stress_map import Ladder, MapMark
from truebreak.compare.report.pictures.heat_map import DARK, LIGHT, heat_map

pytestmark = pytest.mark.skipif(found() is None, reason="no chromium here: apt-get install chromium")

TEXTS = """[...document.querySelectorAll('svg > text, g > text')].map((node) => {
  const box = node.getBBox();
  return [node.textContent, box.x, box.x + box.width, box.y, box.y + box.height];
})"""
CELLS = """[...document.querySelectorAll('rect[fill^="url"]')].map((node) => {
  const box = node.getBoundingClientRect();
  return [box.left, box.right, box.top, box.bottom];
})"""
SIZE = "['width', 'height'].map((name) => document.documentElement[name].baseVal.value)"
FILL = "getComputedStyle(document.querySelector('{}')).fill"


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with Browser() as running:
        yield running


def many(levels: int, engine: str) -> str:
    """A map of long labels, with every mark in it."""
    marks = tuple(list(MapMark)[k % len(MapMark)] for k in range(levels))
    lanes = [("near-ties", "left", 0), ("near-ties", "right", 0), ("scaled", "down", 2)]
    told = [Ladder(*lane, engine, tuple(range(1, levels + 1)), marks) for lane in lanes]
    return heat_map(
        [stress_family("near-ties"), stress_family("scaled")], told, "Where each engine's answer turns wrong"
    )


@pytest.mark.parametrize("levels", [2, 40, 130])
@pytest.mark.parametrize("engine", ["exact", "mine=package.module:Engine:iterations=30,max_steps=300000"])
def test_labels_are_whole_and_beside_the_cells(browser: Browser, tmp_path: Path, levels: int, engine: str) -> None:
    file = tmp_path / "map.svg"
    file.write_text(many(levels, engine), "utf-8")
    browser.size(4000, 1200)
    browser.open(file)
    width, height = browser.ask(
        "[document.documentElement.width.baseVal.value, document.documentElement.height.baseVal.value]"
    )
    texts, cells = browser.ask(TEXTS), browser.ask(CELLS)
    assert len(cells) >= 3 * min(levels, len(MapMark)) + len(MapMark)
    for words, left, right, top, bottom in texts:
        assert left >= 0 and right <= width and top >= 0 and bottom <= height, words
    for _, right, _, bottom in cells:
        assert right <= width and bottom <= height
    inner = [(left, right, top + 3, bottom - 3, words) for words, left, right, top, bottom in texts]
    for left, right, top, bottom, words in inner:
        for start, end, up, down in cells:
            assert right <= start or end <= left or bottom <= up or down <= top, (words, start, up)
    for one in inner:
        for other in inner:
            if one is not other and not (one[3] <= other[2] or other[3] <= one[2]):
                assert one[1] <= other[0] or other[1] <= one[0], (one, other)


def test_colours_follow_the_page(browser: Browser, root: Path) -> None:
    def rgb(colour: str) -> str:
        return f"rgb({', '.join(str(int(colour[k : k + 2], 16)) for k in (1, 3, 5))})"

    for scheme, colours in (("light", LIGHT), ("dark", DARK)):
        browser.media(prefers_color_scheme=scheme)
        browser.open(root / "docs" / "stress.svg")
        assert browser.ask(FILL.format("rect.page")) == rgb(colours["page"])
        assert browser.ask(FILL.format("svg > text")) == rgb(colours["ink"])
        for mark in MapMark:
            assert browser.ask(FILL.format(f"rect.{mark.value}")) == rgb(colours[mark.value])
            assert browser.ask(FILL.format(f"text.{mark.value}-ink")) == rgb(colours[f"{mark.value}-ink"])
    browser.media()


def test_the_map_of_the_docs_is_whole(browser: Browser, root: Path) -> None:
    browser.size(2000, 1200)
    browser.open(root / "docs" / "stress.svg")
    width, _ = browser.ask(SIZE)
    texts = browser.ask(TEXTS)
    assert all(left >= 0 and right <= width for _, left, right, _, _ in texts)
    assert {name for name, *_ in texts} >= {"near-ties", "crowds", "k"}
