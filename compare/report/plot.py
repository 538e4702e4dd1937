"""The separation of several runs from the reference over time, as an SVG plot with a logarithmic scale."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..chaos.foreseen import Foreseen
    from ..comparison import Comparison

WIDE, NARROW = 900, 340
"""Widths of the plot in pixels: on a desk or on paper, and on a telephone. Its letters are of one size in both."""

HEIGHT = 300
LEFT, RIGHT, TOP, BOTTOM = 52, 14, 14, 40
"""Room for the labels around the plot, in pixels."""

FLOOR = 1e-20
"""Smallest separation drawn; zero, which has no logarithm, is drawn there."""


@dataclass(frozen=True)
class Graph:
    """One engine's separation: its place among the engines, its name, the points, and when it first differs."""

    number: int
    label: str
    times: tuple[float, ...]
    values: tuple[float, ...]
    diverged: float | None


@dataclass(frozen=True)
class ForecastBand:
    """The time in which an engine is foreseen to leave the history: its place among the engines, and what is said."""

    number: int
    label: str
    low: float
    high: float


@dataclass(frozen=True)
class Scale:
    """From times and separations to pixels."""

    width: int
    end: float
    low: int
    high: int

    def x(self, time: float) -> float:
        """Pixels from the left."""
        return LEFT + (self.width - LEFT - RIGHT) * time / self.end

    def y(self, value: float) -> float:
        """Pixels from the top; what is not finite is drawn at the top."""
        height = math.log10(max(value, FLOOR)) if math.isfinite(value) else self.high
        return TOP + (HEIGHT - TOP - BOTTOM) * (self.high - height) / (self.high - self.low)


def separation_lines(comparison: Comparison) -> list[Graph]:
    """The lines of the plot: an engine that did not run has none."""
    return [
        Graph(
            number,
            c.engine,
            c.separation.times,
            c.separation.largest,
            c.alignment.divergence.time if c.alignment.divergence else None,
        )
        for number, c in enumerate(comparison.candidates)
        if len(c.separation.times) > 1
    ]


def horizon_bands(comparison: Comparison, foreseen: Foreseen | None) -> list[ForecastBand]:
    """The bands of the plot: an engine that is not expected to leave the events looked at has none."""
    if foreseen is None:
        return []
    return [
        ForecastBand(
            number,
            f"{candidate.engine}: foreseen to leave the history here",
            horizon.low.time,
            foreseen.time if horizon.high.time is None else horizon.high.time,
        )
        for number, (candidate, horizon) in enumerate(zip(comparison.candidates, foreseen.horizons, strict=True))
        if horizon is not None and horizon.low.time is not None and not candidate.unable
    ]


def separation_plot(comparison: Comparison, width: int = WIDE, bands: Sequence[ForecastBand] = ()) -> str:
    """The plot as one SVG element; a dot marks where a history first differs, a band where that was foreseen."""
    kind = "narrow" if width == NARROW else "wide"
    lines = separation_lines(comparison)
    values = [max(v, FLOOR) for line in lines for v in line.values if math.isfinite(v)] or [FLOOR]
    low = math.floor(math.log10(min(values)))
    scale = Scale(
        width,
        max((line.times[-1] for line in lines), default=0.0) or 1.0,
        low,
        max(math.ceil(math.log10(max(values))), low + 1),
    )
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {HEIGHT}" width="{width}" '
        f'height="{HEIGHT}" role="img" class="plot {kind}" data-left="{LEFT}" data-right="{width - RIGHT}" '
        f'data-top="{TOP}" data-bottom="{HEIGHT - BOTTOM}" data-end="{scale.end!r}">',
        "<title>Largest distance of a circle from its place in the reference run, over time, on a "
        "logarithmic scale</title>",
        *_axes(scale),
        *_shaded([band for band in bands if band.low < scale.end], scale),
    ]
    for line in lines:
        parts += _drawn(line, scale)
    parts.append("</svg>")
    return "\n".join(parts)


def _shaded(bands: Sequence[ForecastBand], scale: Scale) -> list[str]:
    """Each band, paler the more of them lie on each other, with a line of its engine's at each end within the plot."""
    parts = []
    for band in bands:
        left, right = scale.x(band.low), scale.x(min(band.high, scale.end))
        parts.append(
            f'<rect class="horizon e{band.number}" x="{left:.1f}" y="{TOP}" width="{max(right - left, 1):.1f}" '
            f'height="{HEIGHT - TOP - BOTTOM}" fill-opacity="{min(1.0, 3 / len(bands)):.2f}">'
            f"<title>{escape(band.label)}</title></rect>"
        )
        parts += [
            f'<line class="brink e{band.number}" x1="{x:.1f}" x2="{x:.1f}" y1="{TOP}" y2="{HEIGHT - BOTTOM}"/>'
            for x in ([left, right] if band.high < scale.end else [left])
        ]
    return parts


def _axes(scale: Scale) -> list[str]:
    parts = []
    stride = max(1, math.ceil((scale.high - scale.low) / 8))
    right = scale.width - RIGHT
    for power in range(scale.low, scale.high + 1, stride):
        y = scale.y(10.0**power)
        label = "0" if 10.0**power <= FLOOR else f"1e{power}"
        parts.append(f'<line class="gridline" x1="{LEFT}" x2="{right}" y1="{y:.1f}" y2="{y:.1f}"/>')
        parts.append(f'<text x="{LEFT - 8}" y="{y:.1f}" class="tick end">{label}</text>')
    for time in ticks(scale.end, 6 if scale.width > NARROW else 3):
        x = scale.x(time)
        parts.append(f'<line class="gridline" x1="{x:.1f}" x2="{x:.1f}" y1="{TOP}" y2="{HEIGHT - BOTTOM}"/>')
        parts.append(f'<text x="{x:.1f}" y="{HEIGHT - BOTTOM + 16}" class="tick">{time:g}</text>')
    parts.append(f'<text x="{(LEFT + right) / 2}" y="{HEIGHT - 6}" class="tick">time</text>')
    return parts


def ticks(end: float, count: int = 6) -> list[float]:
    """About so many round numbers from 0 to an end.

    >>> ticks(10.0)
    [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]
    """
    raw = end / count
    size = 10.0 ** math.floor(math.log10(raw))
    stride = next(size * factor for factor in (1, 2, 5, 10) if size * factor >= raw)
    return [round(stride * k, 12) for k in range(int(end / stride * (1 + 1e-12)) + 1)]


def _drawn(line: Graph, scale: Scale) -> list[str]:
    points = " ".join(f"{scale.x(t):.1f},{scale.y(v):.1f}" for t, v in zip(line.times, line.values, strict=True))
    parts = [
        f'<polyline class="series e{line.number}" points="{points}"><title>{escape(line.label)}</title></polyline>'
    ]
    if line.diverged is not None and line.diverged <= scale.end:
        x, y = scale.x(line.diverged), scale.y(_at(line, line.diverged))
        parts.append(f'<circle class="dot e{line.number}" cx="{x:.1f}" cy="{y:.1f}" r="4.5"/>')
    return parts


def _at(line: Graph, time: float) -> float:
    """The separation at the last sample that is not later than a time."""
    return next((v for t, v in reversed(_pairs(line)) if t <= time), line.values[0])


def _pairs(line: Graph) -> Sequence[tuple[float, float]]:
    return list(zip(line.times, line.values, strict=True))
