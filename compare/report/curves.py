"""Plain curves over time as one SVG plot: linear axes, bands and marks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

WIDTH, HEIGHT = 720, 320
LEFT, RIGHT, TOP, BOTTOM = 64, 150, 26, 40
"""Room for the labels around the plot, in pixels; to the right there is more where a label is longer."""

LETTER, LINE = 7, 20
"""Pixels of a letter of the legend, none of which is wider in the mean, and of one of its lines."""

NARROW = 400
"""Up to this width, every other label of time is left out."""

MARK = 46
"""Pixels of the legend beside its letters: a line, and room around it."""

BARE_RIGHT = 14
"""Room to the right of a plot without a legend."""


@dataclass(frozen=True)
class Curve:
    """Points joined by a line; its style is a class of the style sheet, `reference` or that of an engine."""

    label: str
    points: Sequence[tuple[float, float]]
    style: str


@dataclass(frozen=True)
class Band:
    """A stretch of time, perhaps with a mark in it, drawn at a height."""

    label: str
    low: float
    high: float
    height: float
    mark: float | None
    style: str


def plot(
    title: str,
    across: str,
    up: str,
    curves: Sequence[Curve],
    bands: Sequence[Band] = (),
    *,
    width: int = WIDTH,
    legend: bool = True,
    kind: str = "",
    dots: Sequence[Curve] = (),
) -> str:
    """The curves as one SVG element; a band is a bar at its height, its mark a dot; `dots` are points not joined.

    Args:
        width: in pixels.
        legend: whether the labels stand beside the curves, for which there is room in a wide plot alone; of what has
            one style the last one does.
        kind: a further class of the element.
    """
    points = [p for curve in (*curves, *dots) for p in curve.points if math.isfinite(p[1])]
    end = max((x for x, _ in points), default=1.0) or 1.0
    heights = [y for _, y in points] + [band.height for band in bands]
    low, high = min([0.0, *heights]), max([*heights, 1e-300])
    labels = {item.style: item.label for item in (*curves, *bands, *dots)} if legend else {}
    right = width - (RIGHT if legend else BARE_RIGHT)
    width += max(0, max((MARK + LETTER * len(label) for label in labels.values()), default=0) - RIGHT)
    height = max(HEIGHT, TOP + LINE * (len(labels) + 1))
    view = _View(end, low, high if high > low else low + 1.0, right)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
        f'height="{height}" role="img" class="{f"plot {kind}".strip()}" data-left="{LEFT}" data-right="{right}" '
        f'data-top="{TOP}" data-bottom="{HEIGHT - BOTTOM}" data-end="{end!r}">',
        f"<title>{escape(title)}</title>",
        *view.axes(across, up),
    ]
    for curve in curves:
        path = " ".join(f"{view.x(x):.1f},{view.y(y):.1f}" for x, y in curve.points if math.isfinite(y))
        parts.append(
            f'<polyline class="series {curve.style}" points="{path}"><title>{escape(curve.label)}</title></polyline>'
        )
    for band in bands:
        y = view.y(band.height)
        ends = (view.x(min(value, end)) for value in (band.low, band.high))
        parts.append('<line class="series {}" x1="{:.1f}" x2="{:.1f}" y1="{:.1f}" y2="{:.1f}"/>'.format(
            band.style, *ends, y, y))  # fmt: skip
        if band.mark is not None:
            parts.append(f'<circle class="dot {band.style}" cx="{view.x(band.mark):.1f}" cy="{y:.1f}" r="4.5"/>')
    for cloud in dots:
        parts += [
            f'<circle class="dot {cloud.style}" cx="{view.x(x):.1f}" cy="{view.y(y):.1f}" r="3"/>'
            for x, y in cloud.points
            if math.isfinite(y)
        ]
    for number, (style, label) in enumerate(labels.items()):
        parts += _legend(number, label, style, right)
    return "\n".join([*parts, "</svg>"])


def _legend(number: int, label: str, style: str, right: int) -> list[str]:
    x, y = right + 12, TOP + 14 + LINE * number
    return [
        f'<line class="series {style}" x1="{x}" x2="{x + 22}" y1="{y}" y2="{y}"/>',
        f'<text x="{x + 28}" y="{y}" class="tick start">{escape(label)}</text>',
    ]


@dataclass(frozen=True)
class _View:
    end: float
    low: float
    high: float
    right: int

    def x(self, value: float) -> float:
        return LEFT + (self.right - LEFT) * value / self.end

    def y(self, value: float) -> float:
        return TOP + (HEIGHT - TOP - BOTTOM) * (self.high - value) / (self.high - self.low)

    def axes(self, across: str, up: str) -> list[str]:
        parts: list[str] = []
        for value in _ticks(self.low, self.high):
            y = self.y(value)
            parts.append(f'<line class="gridline" x1="{LEFT}" x2="{self.right}" y1="{y:.1f}" y2="{y:.1f}"/>')
            parts.append(f'<text x="{LEFT - 8}" y="{y:.1f}" class="tick end">{value:.6g}</text>')
        for value in _ticks(0.0, self.end)[:: 1 if self.right > NARROW else 2]:
            x = self.x(value)
            parts.append(f'<text x="{x:.1f}" y="{HEIGHT - BOTTOM + 14}" class="tick">{value:.6g}</text>')
        middle = (LEFT + self.right) / 2
        parts.append(f'<text x="{middle:.0f}" y="{HEIGHT - 8}" class="tick">{escape(across)}</text>')
        parts.append(f'<text x="{LEFT}" y="8" class="tick start">{escape(up)}</text>')
        return parts


def _ticks(low: float, high: float) -> list[float]:
    """Round values between two numbers, about six of them.

    >>> _ticks(0.0, 10.0)
    [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]
    """
    rough = (high - low) / 5
    if not rough > 0:
        return [low]
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(m * power for m in (1, 2, 5, 10) if m * power >= rough * 0.999)
    first = math.ceil(low / step - 1e-9)
    return [k * step for k in range(first, math.floor(high / step + 1e-9) + 1)]
