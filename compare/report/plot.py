"""The separation of several runs from the reference over time, as an SVG plot with a logarithmic scale."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..comparison import Comparison

WIDTH, HEIGHT = 720, 320
LEFT, RIGHT, TOP, BOTTOM = 64, 150, 14, 40
"""Room for the labels around the plot, in pixels."""

FLOOR = 1e-20
"""Smallest separation drawn; zero, which has no logarithm, is drawn there."""

STROKES = ("", "7 4", "2 3", "10 3 2 3", "5 2")
"""Dash patterns, so that the lines can be told apart without their colours."""


@dataclass(frozen=True)
class Line:
    """One engine's separation: the label, the points, and when it first differs."""

    label: str
    times: tuple[float, ...]
    values: tuple[float, ...]
    diverged: float | None


def separation_plot(comparison: Comparison) -> str:
    """The plot as one SVG element; a dot marks where an engine's history first differs."""
    lines = [
        Line(
            c.engine,
            c.separation.times,
            c.separation.largest,
            c.alignment.divergence.time if c.alignment.divergence else None,
        )
        for c in comparison.candidates
        if len(c.separation.times) > 1
    ]
    end = max((line.times[-1] for line in lines), default=0.0) or 1.0
    values = [max(v, FLOOR) for line in lines for v in line.values if math.isfinite(v)] or [FLOOR]
    low = math.floor(math.log10(min(values)))
    high = max(math.ceil(math.log10(max(values))), low + 1)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" '
        f'height="{HEIGHT}" role="img" class="plot">',
        "<title>Largest distance of a circle from its place in the reference run, over time, on a "
        "logarithmic scale</title>",
        *_axes(end, low, high),
    ]
    for number, line in enumerate(lines):
        parts += _drawn(line, number, end, low, high)
    parts.append("</svg>")
    return "\n".join(parts)


def _x(time: float, end: float) -> float:
    return LEFT + (WIDTH - LEFT - RIGHT) * time / end


def _y(value: float, low: int, high: int) -> float:
    height = math.log10(max(value, FLOOR)) if math.isfinite(value) else high
    return TOP + (HEIGHT - TOP - BOTTOM) * (high - height) / (high - low)


def _axes(end: float, low: int, high: int) -> list[str]:
    parts = []
    stride = max(1, math.ceil((high - low) / 8))
    for power in range(low, high + 1, stride):
        y = _y(10.0**power, low, high)
        label = "0" if 10.0**power <= FLOOR else f"1e{power}"
        parts.append(f'<line class="gridline" x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y:.1f}" y2="{y:.1f}"/>')
        parts.append(f'<text x="{LEFT - 8}" y="{y:.1f}" class="tick end">{label}</text>')
    for time in ticks(end):
        x = _x(time, end)
        parts.append(f'<line class="gridline" x1="{x:.1f}" x2="{x:.1f}" y1="{TOP}" y2="{HEIGHT - BOTTOM}"/>')
        parts.append(f'<text x="{x:.1f}" y="{HEIGHT - BOTTOM + 16}" class="tick">{time:g}</text>')
    middle = (LEFT + WIDTH - RIGHT) / 2
    parts.append(f'<text x="{middle}" y="{HEIGHT - 6}" class="tick">time</text>')
    return parts


def ticks(end: float) -> list[float]:
    """About six round numbers from 0 to an end.

    >>> ticks(10.0)
    [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]
    """
    raw = end / 6
    size = 10.0 ** math.floor(math.log10(raw))
    stride = next(size * factor for factor in (1, 2, 5, 10) if size * factor >= raw)
    return [round(stride * k, 12) for k in range(int(end / stride * (1 + 1e-12)) + 1)]


def _drawn(line: Line, number: int, end: float, low: int, high: int) -> list[str]:
    points = " ".join(f"{_x(t, end):.1f},{_y(v, low, high):.1f}" for t, v in zip(line.times, line.values, strict=True))
    dashes = STROKES[number % len(STROKES)]
    dash = f' stroke-dasharray="{dashes}"' if dashes else ""
    kind = f"series s{number % 5}"
    parts = [f'<polyline class="{kind}"{dash} points="{points}"><title>{escape(line.label)}</title></polyline>']
    if line.diverged is not None and line.diverged <= end:
        value = _at(line, line.diverged)
        x, y = _x(line.diverged, end), _y(value, low, high)
        parts.append(f'<circle class="dot s{number % 5}" cx="{x:.1f}" cy="{y:.1f}" r="4.5"/>')
    y = TOP + 14 + 20 * number
    x = WIDTH - RIGHT + 12
    parts.append(f'<line class="{kind}"{dash} x1="{x}" x2="{x + 30}" y1="{y}" y2="{y}"/>')
    label = line.label if len(line.label) <= 15 else f"{line.label[:14]}…"
    parts.append(f'<text x="{x + 36}" y="{y}" class="tick start">{escape(label)}</text>')
    return parts


def _at(line: Line, time: float) -> float:
    """The separation at the last sample that is not later than a time."""
    return next((v for t, v in reversed(_pairs(line)) if t <= time), line.values[0])


def _pairs(line: Line) -> Sequence[tuple[float, float]]:
    return list(zip(line.times, line.values, strict=True))
