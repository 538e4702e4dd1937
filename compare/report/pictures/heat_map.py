"""A stress map as one SVG: a row for each engine and lane, a cell for each k, legible on light and dark pages."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from itertools import groupby

from ...grids.stress_families import StressFamily
from ...grids.stress_map import Ladder, MapMark

CELL, ROW, LETTER = 15, 18, 8
"""Width and height of a cell, and the room granted to one letter of 12 pixels, all in pixels: fixed-width letters of
that size are at most 7.3 wide."""

EDGE, LEAST = 16, 640
"""Room around the map, and its least width."""

MANY = 10
"""More levels than these are not all written above their cells."""

LIGHT = {
    "page": "#ffffff", "ink": "#1b1f24", "faint": "#555f69",
    "right": "#d7ecdd", "right-ink": "#1f6b39", "wrong": "#a3201a", "wrong-ink": "#ffffff",
    "unsettled": "#f3e0a6", "unsettled-ink": "#5a4200", "undecided": "#d3dae3", "undecided-ink": "#2c3743",
    "refused": "#ffffff", "refused-ink": "#555f69",
    "failed": "#5b3a86", "failed-ink": "#ffffff", "unchecked": "#ffb703", "unchecked-ink": "#000000",
}  # fmt: skip
DARK = {
    "page": "#14171b", "ink": "#e6e9ed", "faint": "#a4adb8",
    "right": "#1d3f2a", "right-ink": "#a6e0b6", "wrong": "#ff8a80", "wrong-ink": "#2b0000",
    "unsettled": "#5b4a12", "unsettled-ink": "#ffe39a", "undecided": "#38424e", "undecided-ink": "#dbe2ea",
    "refused": "#14171b", "refused-ink": "#a4adb8",
    "failed": "#c3a5f0", "failed-ink": "#1d0b3a", "unchecked": "#ffb703", "unchecked-ink": "#000000",
}  # fmt: skip
"""Colours: of the page, of letters on it, and of each mark's cell and its letter."""

LETTERS = {mark: mark.sign for mark in MapMark} | {MapMark.RIGHT: "·", MapMark.WRONG: "×", MapMark.REFUSED: "–"}
"""What stands in a cell, so that no mark is told by its colour alone."""


def heat_map(families: Sequence[StressFamily], ladders: Sequence[Ladder], title: str) -> str:
    """The map as one SVG document.

    Args:
        families: those that the ladders are of, with what they show.
        ladders: lane by lane.
        title: what the picture is of.
    """
    known = {one.name: one for one in families}
    engines = max((len(ladder.engine) for ladder in ladders), default=0)
    labels = max((len(_label(ladder, engines)) for ladder in ladders), default=0)
    levels = max((len(ladder.levels) for ladder in ladders), default=0)
    ends = max((len(_end(ladder)) for ladder in ladders), default=0)
    left = EDGE + labels * LETTER + LETTER
    sheet = _Sheet(engines, left, max(left + levels * CELL + 2 * LETTER + ends * LETTER + EDGE, LEAST))
    sheet.heading(title)
    sheet.legend()
    for name, group in groupby(ladders, key=lambda ladder: ladder.family):
        sheet.block(known[name], list(group))
    return sheet.document(title)


def _label(ladder: Ladder, engines: int = 0) -> str:
    """What stands before a row: the engine, in a column so many letters wide, and the lane."""
    return f"{ladder.engine:{engines}}  {ladder.lane}"


def _end(ladder: Ladder) -> str:
    """What stands behind a row."""
    first = ladder.first_short
    return "" if not first else f"wrong {first}" if first.startswith("at") else f"wrong at {first}"


@dataclass
class _Sheet:
    """Draws from the top to the bottom.

    Attributes:
        engines: letters of the longest engine's label.
        left: where the cells begin.
        width: of the whole.
        y: how far it is drawn.
    """

    engines: int
    left: int
    width: int
    y: int = EDGE

    def __post_init__(self) -> None:
        self.parts: list[str] = []

    def text(self, x: float, words: str, kind: str = "", row: int = ROW) -> None:
        """One line of text at the height reached."""
        shown = f' class="{kind}"' if kind else ""
        self.parts.append(f'<text x="{x:g}" y="{self.y + row - 5}"{shown}>{escape(words)}</text>')

    def lines(self, words: str, kind: str) -> None:
        """Text that goes on in the next line."""
        for line in textwrap.wrap(words, (self.width - 2 * EDGE) // LETTER):
            self.text(EDGE, line, kind)
            self.y += ROW

    def heading(self, title: str) -> None:
        """What the picture is of."""
        self.lines(title, "title")
        self.y += ROW // 2

    def legend(self) -> None:
        """Each mark and what it means."""
        for mark in MapMark:
            self.parts.append(_cells(EDGE, self.y, mark, 1))
            for line in textwrap.wrap(mark.meaning, (self.width - 3 * EDGE - CELL) // LETTER):
                self.text(EDGE + CELL + LETTER, line)
                self.y += ROW
        self.y += ROW // 2

    def block(self, family: StressFamily, ladders: Sequence[Ladder]) -> None:
        """One family: what it is, the k, and a row for each engine and lane."""
        self.y += ROW // 2
        self.text(EDGE, family.name, "title")
        self.y += ROW
        self.lines(f"{family.summary} {family.grows}.", "faint")
        self._ticks(max((ladder.levels for ladder in ladders), key=len))
        for ladder in ladders:
            self.parts.append(f"<g><title>{escape(f'{_label(ladder)}: {ladder.summary()}')}</title>")
            self.text(EDGE, _label(ladder, self.engines))
            place = dict(zip(ladder.levels, range(len(ladder.levels)), strict=True))
            for mark, low, high in ladder.stretches:
                x = self.left + place[low] * CELL
                self.parts.append(_cells(x, self.y, mark, place[high] - place[low] + 1))
            self.text(self.left + len(ladder.levels) * CELL + LETTER, _end(ladder))
            self.parts.append("</g>")
            self.y += ROW

    def _ticks(self, levels: Sequence[int]) -> None:
        """The k above the cells: of many every fifth, and none where there is no room."""
        self.text(EDGE, "k", "faint")
        free = 0.0
        for place, k in enumerate(levels):
            middle, half = self.left + (place + 0.5) * CELL, len(str(k)) * LETTER / 2
            if (place == 0 or len(levels) <= MANY or k % 5 == 0) and middle - half >= free:
                self.text(middle, str(k), "faint tick")
                free = middle + half + LETTER / 2
        self.y += ROW

    def document(self, title: str) -> str:
        """The whole SVG."""
        height = self.y + EDGE
        head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width} {height}" width="{self.width}" '
            f'height="{height}" role="img">'
        )
        page = f'<rect width="{self.width}" height="{height}" class="page"/>'
        name = f"<title>{escape(title)}</title>"
        return "\n".join([head, name, _style(), _patterns(), page, *self.parts, "</svg>", ""])


def _cells(x: int, y: int, mark: MapMark, count: int) -> str:
    """Cells of one mark, side by side."""
    return (
        f'<g transform="translate({x} {y})"><rect width="{count * CELL}" height="{ROW}" '
        f'fill="url(#stress-{mark.value})"/></g>'
    )


def _patterns() -> str:
    """The cell of each mark."""
    told = [
        f'<pattern id="stress-{mark.value}" width="{CELL}" height="{ROW}" patternUnits="userSpaceOnUse">'
        f'<rect x="0.5" y="1" width="{CELL - 1}" height="{ROW - 2}" rx="2" class="{mark.value}"/>'
        f'<text x="{CELL / 2}" y="{ROW - 5}" class="{mark.value}-ink tick">{LETTERS[mark]}</text></pattern>'
        for mark in MapMark
    ]
    return "\n".join(["<defs>", *told, "</defs>"])


def _style() -> str:
    """Letters and colours, on light and on dark pages."""
    return "\n".join(
        [
            "<style>",
            'text { font: 12px ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace; white-space: pre; }',
            ".title { font-weight: bold; }",
            ".tick { text-anchor: middle; }",
            *_colours(LIGHT),
            "@media (prefers-color-scheme: dark) {",
            *_colours(DARK),
            "}",
            "</style>",
        ]
    )


def _colours(colours: dict[str, str]) -> list[str]:
    told = [f"text {{ fill: {colours['ink']}; }}", f".faint {{ fill: {colours['faint']}; }}"]
    told += [f".{name} {{ fill: {colour}; }}" for name, colour in colours.items() if name not in ("ink", "faint")]
    return [*told, f".refused {{ stroke: {colours['faint']}; stroke-width: 0.5; }}"]
