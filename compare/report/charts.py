"""Charts as SVG: the errors of several runs over time on a logarithmic scale, and plain curves with bands and marks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from html import escape
from typing import TYPE_CHECKING

from ...scenarios.trajectory import StopReason
from ..picture import states_at
from .answers import encloses
from .sentences import short

if TYPE_CHECKING:
    from ..alignment.align import Separation
    from ..candidate import Candidate
    from ..chaos.foreseen import Foreseen
    from ..comparison import Comparison

# -- Errors over time: the separation of several runs from the reference.

WIDE, NARROW = 900, 340
"""Widths of the plot in pixels: on a desk or on paper, and on a telephone. Its letters are of one size in both."""

HEIGHT = 310
LEFT, RIGHT, TOP, BOTTOM = 70, 14, 30, 42
"""Room for the labels around the plot, in pixels."""

NAMES_RIGHT, NAME_LINE, LONGEST_NAME = 130, 16, 16
"""Room for names at the right of a wide plot, the height of one, and its most letters."""

ROUNDING = 2.0**-53
"""The floor of the plot, as a share of the scene's size: places are doubles, which tell no smaller distance."""

TOGETHER = 0.05
"""Two lines share a name where they end within this share of the plot of each other."""

SAME, MARKS = 1.5, 7
"""Pixels within which two lines count as one, and the marks that are put on the upper one then."""


@dataclass(frozen=True)
class ErrorLine:
    """One engine's errors: its place among the engines, its name, the points, and when it first differs."""

    number: int
    label: str
    times: tuple[float, ...]
    values: tuple[float, ...]
    diverged: float | None


@dataclass(frozen=True)
class Predicted:
    """The time in which an engine is predicted to diverge: its place among the engines, and what is said."""

    number: int
    label: str
    low: float
    high: float


@dataclass(frozen=True)
class Scale:
    """From times and errors to pixels; what is below the floor is drawn on it."""

    width: int
    right: int
    end: float
    low: float
    high: float

    def x(self, time: float) -> float:
        """Pixels from the left."""
        return LEFT + (self.right - LEFT) * time / self.end

    def y(self, value: float) -> float:
        """Pixels from the top; what is not finite is drawn at the top."""
        height = max(math.log10(value), self.low) if 0 < value < math.inf else self.high if value else self.low
        return TOP + (HEIGHT - TOP - BOTTOM) * (self.high - height) / (self.high - self.low)


def error_lines(comparison: Comparison) -> list[ErrorLine]:
    """The lines of the plot: an engine that did not run has none."""
    lines: list[ErrorLine] = []
    for number, c in enumerate(comparison.candidates):
        errors, parted = errors_shown(comparison, c), c.alignment.divergence
        if len(errors.times) > 1:
            lines.append(ErrorLine(number, c.engine, errors.times, errors.largest, parted and parted.time))
    return lines


COASTING = 0.25
"""How much longer than its events a run is shown in which nothing is left to happen, as a share."""

COASTING_SAMPLES = 24


def errors_shown(comparison: Comparison, candidate: Candidate) -> Separation:
    """The errors up to where the runs are shown: past the last event, where both go on for ever, in straight flight."""
    reference, run, errors = comparison.reference, candidate.trajectory, candidate.separation
    last, final = errors.times[-1], max(float(reference.final_time), float(run.final_time))
    end = float(reference.final_time) * (1 + COASTING)
    known = reference.stop.reason is StopReason.QUIET and math.isfinite(final) and not math.isnan(errors.final)
    if not known or not end > last or (run.stop.reason is not StopReason.QUIET and float(run.final_time) < end):
        return errors
    times = [last + (end - last) * (k + 1) / COASTING_SAMPLES for k in range(COASTING_SAMPLES)]
    largest = [
        max(
            math.dist(mine[:2], theirs[:2])
            for mine, theirs in zip(states_at(reference, t), states_at(run, t), strict=True)
        )
        for t in times
    ]
    return replace(errors, times=(*errors.times, *times), largest=(*errors.largest, *largest))


def error_words(comparison: Comparison, candidate: Candidate) -> str:
    """The largest position error; where it grows for ever, up to when it was taken; a dash where nothing ran.

    >>> from truebreak.compare import compare
    >>> from truebreak.scenarios import catalogue
    >>> found = compare(catalogue.build("near-tie"), ["double"])
    >>> error_words(found, found.candidates[0])
    '0.17 by t = 1.25, growing'
    """
    if candidate.unable:
        return short(None)
    errors, measured = errors_shown(comparison, candidate), candidate.separation.maximum
    if errors is candidate.separation or not errors.final > 2 * measured:
        return short(measured)
    return f"{short(errors.final)} by t = {errors.times[-1]:.6g}, growing"


def predictions(comparison: Comparison, foreseen: Foreseen | None) -> list[Predicted]:
    """The bands of the plot: an engine that is not expected to diverge in the events looked at has none."""
    if foreseen is None:
        return []
    return [
        Predicted(
            number,
            f"{candidate.engine}: predicted to {'stop' if encloses(candidate) else 'diverge'} here",
            horizon.low.time,
            foreseen.time if horizon.high.time is None else horizon.high.time,
        )
        for number, (candidate, horizon) in enumerate(zip(comparison.candidates, foreseen.horizons, strict=True))
        if horizon is not None and horizon.low.time is not None and not candidate.unable
    ]


def error_plot(comparison: Comparison, width: int = WIDE, bands: Sequence[Predicted] = ()) -> str:
    """The plot as one SVG element; a dot marks where a history first differs, a band where that was predicted."""
    wide = width != NARROW
    lines = error_lines(comparison)
    size = max((c.separation.scale for c in comparison.candidates), default=0.0) or 1.0
    radius = min((float(c.r) for c in comparison.scene.circles if float(c.r) > 0), default=0.0)
    values = [v for line in lines for v in line.values if 0 < v < math.inf]
    low = math.log10(size * ROUNDING)
    high = max([low + 1, *(math.log10(v) for v in [*values, radius] if v > 0)])
    end = max((line.times[-1] for line in lines), default=0.0) or 1.0
    scale = Scale(width, width - (NAMES_RIGHT if wide else RIGHT), end, low, high + 0.03 * (high - low))
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {HEIGHT}" width="{width}" '
        f'height="{HEIGHT}" role="img" class="plot {"wide" if wide else "narrow"}" data-left="{LEFT}" '
        f'data-right="{scale.right}" data-top="{TOP}" data-bottom="{HEIGHT - BOTTOM}" data-end="{scale.end!r}">',
        "<title>Largest distance of a circle from its place in the reference run, over time, on a "
        "logarithmic scale</title>",
        *_axes(scale, radius),
        *_shaded([band for band in bands if band.low < scale.end], scale),
    ]
    drawn: list[tuple[ErrorLine, list[tuple[float, float]]]] = []
    twins: dict[str, str] = {}
    for line in lines:
        points = _points(line, scale)
        twin = next((other for other, theirs in drawn if _alike(points, theirs)), None)
        if twin is not None and abs(line.times[-1] - twin.times[-1]) <= TOGETHER * end:
            twins[line.label] = twin.label
        parts += _line(line, points, scale, marked=twin is not None)
        drawn.append((line, points))
    if wide:
        parts += _names(drawn, twins, scale)
    parts.append("</svg>")
    return "\n".join(parts)


def _points(line: ErrorLine, scale: Scale) -> list[tuple[float, float]]:
    """Its points in pixels: of those in one column of pixels the highest and the lowest."""
    columns: dict[int, list[tuple[float, float]]] = {}
    for time, value in zip(line.times, line.values, strict=True):
        if not math.isnan(value):
            columns.setdefault(int(scale.x(time)), []).append((scale.x(time), scale.y(value)))
    found: list[tuple[float, float]] = []
    for column in columns.values():
        ends = {min(column, key=lambda p: p[1]), max(column, key=lambda p: p[1])}
        found += sorted(ends, key=column.index)
    return found


def _alike(points: Sequence[tuple[float, float]], others: Sequence[tuple[float, float]]) -> bool:
    """Whether two lines lie on each other nearly everywhere where both are above the floor."""
    there = {round(x): y for x, y in others}
    pairs = [(y, there[round(x)]) for x, y in points if round(x) in there]
    return len(pairs) > 1 and sum(abs(a - b) <= SAME for a, b in pairs) >= 0.9 * len(pairs)


def _names(
    drawn: Sequence[tuple[ErrorLine, list[tuple[float, float]]]], twins: dict[str, str], scale: Scale
) -> list[str]:
    """Each engine's name at the right end of its line, none over another; lines that lie on each other share one."""
    ends = [(points[-1][1] if points else scale.y(0.0), line) for line, points in drawn if line.label not in twins]
    parts, floor = [], TOP - NAME_LINE / 2
    for y, line in sorted(ends, key=lambda pair: pair[0]):
        y = floor = max(y, floor + NAME_LINE)
        also = [label for label, twin in twins.items() if twin == line.label]
        name = " = ".join([line.label, *also])
        told = name if len(name) <= LONGEST_NAME else f"{name[: LONGEST_NAME - 1]}…"
        x, last = scale.right, next(points[-1] for other, points in drawn if other is line)
        parts.append(f'<path class="leader e{line.number}" d="M{last[0]:.1f} {last[1]:.1f}L{x + 8} {y:.1f}"/>')
        title = f"<title>{escape(name)}</title>"
        parts.append(f'<text x="{x + 12}" y="{y:.1f}" class="tick start">{escape(told)}{title}</text>')
    return parts


def _shaded(bands: Sequence[Predicted], scale: Scale) -> list[str]:
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


def _axes(scale: Scale, radius: float) -> list[str]:
    parts, right = [], scale.right
    powers = range(math.ceil(scale.low), math.floor(scale.high) + 1)
    stride = max(1, math.ceil(len(powers) / 8))
    floor = scale.y(0.0)
    for power in powers:
        y = scale.y(10.0**power)
        if power % stride or floor - y < 12:
            continue
        parts.append(f'<line class="gridline" x1="{LEFT}" x2="{right}" y1="{y:.1f}" y2="{y:.1f}"/>')
        parts.append(f'<text x="{LEFT - 8}" y="{y:.1f}" class="tick end">1e{power}</text>')
    parts.append(f'<line class="floor" x1="{LEFT}" x2="{right}" y1="{floor:.1f}" y2="{floor:.1f}"/>')
    parts.append(f'<text x="{LEFT - 8}" y="{floor:.1f}" class="tick end">rounding</text>')
    for time in ticks(scale.end, 6 if scale.width > NARROW else 3):
        x = scale.x(time)
        parts.append(f'<line class="gridline" x1="{x:.1f}" x2="{x:.1f}" y1="{TOP}" y2="{HEIGHT - BOTTOM}"/>')
        parts.append(f'<text x="{x:.1f}" y="{HEIGHT - BOTTOM + 16}" class="tick">{time:g}</text>')
    if radius > 0 and floor - scale.y(radius) > 12:
        y = scale.y(radius)
        parts.append(f'<line class="radius" x1="{LEFT}" x2="{right}" y1="{y:.1f}" y2="{y:.1f}"/>')
        parts.append(f'<text x="{LEFT + 6}" y="{y + 10:.1f}" class="tick start halo">one radius</text>')
    across = "time" if scale.width == NARROW else "time, in the units of the scene"
    up = (
        "distance off"
        if scale.width == NARROW
        else "largest distance of a circle from its place, in the units of the scene"
    )
    parts.append(f'<text x="{(LEFT + right) / 2:.0f}" y="{HEIGHT - 9}" class="tick">{across}</text>')
    parts.append(f'<text x="4" y="12" class="tick start">{up}</text>')
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


def _line(line: ErrorLine, points: Sequence[tuple[float, float]], scale: Scale, *, marked: bool) -> list[str]:
    """The line, a dot where it diverges, and squares along it where it would hide another."""
    told = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    parts = [f'<polyline class="series e{line.number}" points="{told}"><title>{escape(line.label)}</title></polyline>']
    if marked:
        for x, y in points[:: max(1, len(points) // MARKS)]:
            parts.append(f'<rect class="dot e{line.number}" x="{x - 3:.1f}" y="{y - 3:.1f}" width="6" height="6"/>')
    if line.diverged is not None and line.diverged <= scale.end:
        x, y = scale.x(line.diverged), scale.y(_at(line, line.diverged))
        parts.append(f'<circle class="dot e{line.number}" cx="{x:.1f}" cy="{y:.1f}" r="4.5"/>')
    return parts


def _at(line: ErrorLine, time: float) -> float:
    """The error at the last sample that is not later than a time."""
    known = [(t, v) for t, v in zip(line.times, line.values, strict=True) if t <= time]
    return known[-1][1] if known else line.values[0]


# -- Plain curves over time.

CURVES_WIDTH, CURVES_HEIGHT = 720, 320
CURVES_LEFT, CURVES_RIGHT, CURVES_TOP, CURVES_BOTTOM = 64, 150, 26, 40
"""Room for the labels around the plot, in pixels; to the right there is more where a label is longer."""

LETTER, LINE = 7, 20
"""Pixels of a letter of the legend, none of which is wider in the mean, and of one of its lines."""

FEW_LABELS = 400
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
class ForecastBand:
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
    bands: Sequence[ForecastBand] = (),
    *,
    width: int = CURVES_WIDTH,
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
    right = width - (CURVES_RIGHT if legend else BARE_RIGHT)
    width += max(0, max((MARK + LETTER * len(label) for label in labels.values()), default=0) - CURVES_RIGHT)
    height = max(CURVES_HEIGHT, CURVES_TOP + LINE * (len(labels) + 1))
    view = _Axes(end, low, high if high > low else low + 1.0, right)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
        f'height="{height}" role="img" class="{f"plot {kind}".strip()}" data-left="{CURVES_LEFT}" data-right="{right}" '
        f'data-top="{CURVES_TOP}" data-bottom="{CURVES_HEIGHT - CURVES_BOTTOM}" data-end="{end!r}">',
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
    x, y = right + 12, CURVES_TOP + 14 + LINE * number
    return [
        f'<line class="series {style}" x1="{x}" x2="{x + 22}" y1="{y}" y2="{y}"/>',
        f'<text x="{x + 28}" y="{y}" class="tick start">{escape(label)}</text>',
    ]


@dataclass(frozen=True)
class _Axes:
    end: float
    low: float
    high: float
    right: int

    def x(self, value: float) -> float:
        return CURVES_LEFT + (self.right - CURVES_LEFT) * value / self.end

    def y(self, value: float) -> float:
        return CURVES_TOP + (CURVES_HEIGHT - CURVES_TOP - CURVES_BOTTOM) * (self.high - value) / (self.high - self.low)

    def axes(self, across: str, up: str) -> list[str]:
        parts: list[str] = []
        for value in _round_values(self.low, self.high):
            y = self.y(value)
            parts.append(f'<line class="gridline" x1="{CURVES_LEFT}" x2="{self.right}" y1="{y:.1f}" y2="{y:.1f}"/>')
            parts.append(f'<text x="{CURVES_LEFT - 8}" y="{y:.1f}" class="tick end">{value:.6g}</text>')
        for value in _round_values(0.0, self.end)[:: 1 if self.right > FEW_LABELS else 2]:
            x = self.x(value)
            parts.append(f'<text x="{x:.1f}" y="{CURVES_HEIGHT - CURVES_BOTTOM + 14}" class="tick">{value:.6g}</text>')
        middle = (CURVES_LEFT + self.right) / 2
        parts.append(f'<text x="{middle:.0f}" y="{CURVES_HEIGHT - 8}" class="tick">{escape(across)}</text>')
        parts.append(f'<text x="{CURVES_LEFT}" y="8" class="tick start">{escape(up)}</text>')
        return parts


def _round_values(low: float, high: float) -> list[float]:
    """Round values between two numbers, about six of them.

    >>> _round_values(0.0, 10.0)
    [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]
    """
    rough = (high - low) / 5
    if not rough > 0:
        return [low]
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(m * power for m in (1, 2, 5, 10) if m * power >= rough * 0.999)
    first = math.ceil(low / step - 1e-9)
    return [k * step for k in range(first, math.floor(high / step + 1e-9) + 1)]
