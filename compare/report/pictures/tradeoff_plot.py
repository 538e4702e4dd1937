"""Run time against digits as one SVG: a panel for each scene, a point for each engine and setting."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from itertools import groupby
from typing import TYPE_CHECKING

from ...picture import REFERENCE, engine_styles

if TYPE_CHECKING:
    from ...grids.row import Row

COLUMNS, WIDTH, HEIGHT = 2, 430, 250
"""Panels in a row, and the size of one, in pixels."""

LEFT, RIGHT, TOP, BOTTOM = 46, 22, 34, 38
HEAD, LEGEND = 16, 22
"""Room around a panel, above all, and for each line of what tells the engines apart."""

LETTER, MARK = 7, 26
"""Pixels of a letter of the legend, none of which is wider in the mean, and of a mark with the room around it."""

EXACT = "exact"
"""The engine whose time is the unit, in the colour that the reference has everywhere."""

CIRCLE = "M -4.5 0 A 4.5 4.5 0 1 1 4.5 0 A 4.5 4.5 0 1 1 -4.5 0 Z"
"""The mark of exact alone; its centre is at 0, as that of all marks."""

MARKS = (
    "M -4 -4 H 4 V 4 H -4 Z",
    "M 0 -5 L 5 4 H -5 Z",
    "M 0 -5.5 L 5.5 0 L 0 5.5 L -5.5 0 Z",
    "M 0 5 L 5 -4 H -5 Z",
    "M -2 -5 H 2 V -2 H 5 V 2 H 2 V 5 H -2 V 2 H -5 V -2 H -2 Z",
    "M -5 -5 H 5 L -5 5 H 5 Z",
)
"""Those of others, in turn: colours alone do not tell many engines apart (`engine_style` has as many dashes)."""

MOST_DIGITS = 20
"""Digits of the upper edge: what has more is drawn there."""

STYLE = """
svg { font: 12px system-ui, sans-serif; }
.grid { stroke: #ddd; } .front { stroke: #555; fill: none; stroke-dasharray: 4 3; }
text { fill: #333; } .title { font-weight: 600; } .end { text-anchor: end; } .mid { text-anchor: middle; }
"""


@dataclass(frozen=True)
class _Panel:
    """Where a panel is, and from times to pixels: powers of ten of the exact engine's time."""

    x0: int
    y0: int
    low: int
    high: int

    def x(self, ratio: float) -> float:
        share = (math.log10(ratio) - self.low) / (self.high - self.low)
        return self.x0 + LEFT + (WIDTH - LEFT - RIGHT) * share

    def y(self, digits: float) -> float:
        share = min(max(digits, 0.0), MOST_DIGITS) / MOST_DIGITS
        return self.y0 + HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * share


def tradeoff_plot(rows: Sequence[Row]) -> str:
    """The plot; empty panels are left out. Rows that did not get to the end have no digits, and no point.

    >>> from truebreak.compare.grids.row import Row
    >>> tradeoff_plot([Row(0, "gas", "double", "agree", ratio=0.3, digits=14.0)]).count('class="mark"')
    2
    """
    scenes = [(name, list(mine)) for name, mine in groupby(rows, key=lambda row: row.scene)]
    drawn = [(name, [row for row in mine if _has_point(row)]) for name, mine in scenes]
    drawn = [(name, mine) for name, mine in drawn if mine]
    families = list(dict.fromkeys(_family(row) for _, mine in drawn for row in mine))
    wide = WIDTH * min(COLUMNS, max(len(drawn), 1))
    legend, lines = _legend(families, wide)
    head = HEAD + LEGEND * lines
    tall = head + HEIGHT * -(-len(drawn) // COLUMNS)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide} {tall}" width="{wide}" height="{tall}" '
        'role="img">',
        "<title>Digits that are right at the end, over run time as a multiple of the exact engine's</title>",
        f"<style>{STYLE}</style>",
        f'<rect width="{wide}" height="{tall}" fill="#fff"/>',
        *legend,
    ]
    for place, (name, mine) in enumerate(drawn):
        ratios = [math.log10(row.ratio or 1.0) for row in mine]
        low = math.floor(min(ratios))
        panel = _Panel(
            WIDTH * (place % COLUMNS),
            head + HEIGHT * (place // COLUMNS),
            low,
            max(math.ceil(max(ratios)), low + 1),
        )
        parts += [*_axes(panel, name), *_points(panel, mine, families)]
    return "\n".join([*parts, "</svg>\n"])


def _has_point(row: Row) -> bool:
    return row.refused is None and row.digits is not None and bool(row.ratio)


def _family(row: Row) -> str:
    return row.engine.partition(":")[0]


def _look(family: str, families: Sequence[str]) -> tuple[str, str]:
    """The colour of an engine, and its mark."""
    if family == EXACT:
        return REFERENCE, CIRCLE
    others = [name for name in families if name != EXACT]
    number = others.index(family)
    return engine_styles(others)[number].light, MARKS[number % len(MARKS)]


def _mark(place: tuple[float, float], look: tuple[str, str], filled: bool, told: str) -> str:
    (x, y), (colour, mark) = place, look
    return (
        f'<path class="mark" transform="translate({x:.1f} {y:.1f})" d="{mark}" stroke="{colour}" stroke-width="1.5" '
        f'fill="{colour if filled else "#fff"}"><title>{escape(told)}</title></path>'
    )


def _legend(families: Sequence[str], wide: int) -> tuple[list[str], int]:
    """A mark and a name for each engine, in as many lines as they take; how many these are."""
    parts, x, line = [], LEFT, 0
    for family in families:
        room = MARK + LETTER * len(family)
        if x > LEFT and x + room > wide:
            x, line = LEFT, line + 1
        y = HEAD + LEGEND * line
        parts.append(_mark((x, y), _look(family, families), True, family))
        parts.append(f'<text x="{x + 9}" y="{y + 4}">{escape(family)}</text>')
        x += room
    return parts, line + 1


def _axes(panel: _Panel, name: str) -> list[str]:
    left, right = panel.x0 + LEFT, panel.x0 + WIDTH - RIGHT
    top, bottom = panel.y0 + TOP, panel.y0 + HEIGHT - BOTTOM
    parts = [f'<text class="title" x="{left}" y="{panel.y0 + 20}">{escape(name)}</text>']
    for digits in range(0, MOST_DIGITS + 1, 5):
        y = panel.y(digits)
        label = f"{digits}+" if digits == MOST_DIGITS else str(digits)
        parts.append(f'<line class="grid" x1="{left}" x2="{right}" y1="{y:.1f}" y2="{y:.1f}"/>')
        parts.append(f'<text class="end" x="{left - 6}" y="{y + 4:.1f}">{label}</text>')
    for power in range(panel.low, panel.high + 1):
        x = panel.x(10.0**power)
        parts.append(f'<line class="grid" x1="{x:.1f}" x2="{x:.1f}" y1="{top}" y2="{bottom}"/>')
        parts.append(f'<text class="mid" x="{x:.1f}" y="{bottom + 16}">{10.0**power:g}</text>')
    told = "time / exact; upwards: digits right at the end"
    parts.append(f'<text class="mid" x="{(left + right) // 2}" y="{bottom + 31}">{told}</text>')
    return parts


def _points(panel: _Panel, rows: Sequence[Row], families: Sequence[str]) -> list[str]:
    places = {row.engine: (panel.x(row.ratio or 0.0), panel.y(row.digits or 0.0)) for row in rows}
    front = sorted(places[row.engine] for row in rows if row.front)
    parts = []
    if len(front) > 1:
        line = " ".join(f"{x:.1f},{y:.1f}" for x, y in front)
        parts.append(f'<polyline class="front" points="{line}"/>')
    for row in rows:
        told = f"{row.engine}: {row.ratio:.3g} of exact"
        parts.append(_mark(places[row.engine], _look(_family(row), families), bool(row.front), told))
    return parts
