"""Pictures of runs as SVG, and the colour and dash by which engines are known in every figure."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from ..scenarios.pictures import DrawnDisc, View, as_at, draw, scene_picture, view_of
from ..scenarios.trajectory import StopReason
from .alignment.align import rows_of

if TYPE_CHECKING:
    from ..scenarios.trajectory import Trajectory
    from .alignment.instants import Divergence
    from .candidate import Candidate

REFERENCE_HUE, APART = 211.0, 24.0
"""The reference's blue, and how far from it the hue of an engine stays, in degrees."""

REFERENCE = "#2b6cb0"
"""The reference on a light page."""

FIRST, TURN, ASIDE = 0.6, 0.632, 5
"""The hue of the first engine that has no colour of its own, as a share of the hues that are left; by what share each
next one is turned; and how many dashes they are ahead. These keep apart what has the same dash: by 49 units of CIELAB
among 12 engines, by 31 among 24."""

DASHES = ("7 4", "2 3", "11 3 2 3", "18 5", "11 3 2 3 2 3", "5 2 5 7")
"""Dashes of the engines compared. A solid line is the reference's alone."""

OWN = {
    "double": ("#8e250b", "#d50b0b"),
    "interval": ("#c28800", "#fae7a8"),
    "pymunk": ("#900ce9", "#8134f4"),
    "single": ("#f25f8b", "#e7748b"),
    "quad": ("#390b50", "#924f8d"),
    "rounded": ("#15322b", "#d0f7fb"),
}
"""Engines that have the same colour on every page, a light and a dark one. They and the reference's blue lie 30 units
of CIELAB apart at least, also for eyes that lack one kind of cones (by the matrices of Machado, Oliveira and Fernandes,
IEEE Transactions on Visualization and Computer Graphics 15, 2009)."""


class EngineStyle(NamedTuple):
    """The look of one engine.

    Attributes:
        light, dark: colours as CSS, on a light and on a dark page.
        dash: lengths of dashes and gaps in pixels, as SVG has them.
    """

    light: str
    dark: str
    dash: str


def engine_style(number: int) -> EngineStyle:
    """The style at a place, from 0: those of `OWN`, then one hue after the other.

    >>> engine_style(0)
    EngineStyle(light='#8e250b', dark='#d50b0b', dash='7 4')
    >>> len({engine_style(k)[:2] for k in range(100)})
    100
    """
    if number < len(OWN):
        light, dark = list(OWN.values())[number]
        return EngineStyle(light, dark, DASHES[number])
    dash = DASHES[(number + ASIDE) % len(DASHES)]
    share = (FIRST + TURN * (number - len(OWN))) % 1
    hue = f"{(REFERENCE_HUE + APART + (360 - 2 * APART) * share) % 360:.4g}"
    return EngineStyle(f"hsl({hue} 72% 36%)", f"hsl({hue} 80% 68%)", dash)


def engine_styles(names: Sequence[str]) -> list[EngineStyle]:
    """The styles of engines by their texts: an engine of `OWN` has its own, others the next that is free.

    >>> engine_styles(["pymunk:dt=1/64", "double"])[1] == engine_style(0)
    True
    >>> len(set(engine_styles(["double", "pymunk:dt=1/64", "pymunk:dt=1/256", "mine"])))
    4
    """
    own, taken, found = list(OWN), set[int](), list[EngineStyle]()
    free = len(OWN)
    for name in names:
        family = name.partition(":")[0]
        number = own.index(family) if family in OWN else free
        if number in taken:
            number = free
        free += number == free
        taken.add(number)
        found.append(engine_style(number))
    return found


def engine_css(names: Sequence[str]) -> str:
    """Style sheet for engines: the class `eK` sets `--engine` and `--dash` for the engine at place K."""
    styles = engine_styles(names)
    light = "".join(f".e{k} {{ --engine: {s.light}; --dash: {s.dash}; }}\n" for k, s in enumerate(styles))
    dark = "".join(f"  .e{k} {{ --engine: {s.dark}; }}\n" for k, s in enumerate(styles))
    return f"{light}@media screen and (prefers-color-scheme: dark) {{\n{dark}}}\n"


def plain_css(names: Sequence[str]) -> str:
    """The same for a picture that is a file of its own, on white: without variables, which few other programs read.

    >>> print(plain_css(["double"]), end="")
    .e0 { stroke: #8e250b; stroke-dasharray: 7 4; } .dot.e0 { fill: #8e250b; stroke: none; }
    """
    return "".join(
        f".e{k} {{ stroke: {s.light}; stroke-dasharray: {s.dash}; }} .dot.e{k} {{ fill: {s.light}; stroke: none; }}\n"
        for k, s in enumerate(engine_styles(names))
    )


# ----------------------------------------
# Pictures of two runs at the moment at which they part, as SVG.

FRAME_WIDTH, FRAME_HEIGHT = 320.0, 240.0
"""Pixels of one frame."""

RADII = 4.0
"""Radii that the circles in question fly, at most, between the frame before and the moment itself."""

EVENTS_AFTER = 3
"""Events of the engine that lie between the moment and the last frame, where the other meeting is not later."""

ONE_INSTANT = 1e-9
"""Share of the time by which two meetings may lie apart and still be shown as one instant."""

LENS, LENS_GAP, SMALL_GAP = 44.0, 14.0, 9.0
"""Pixels: radius of the lens, of the gap in it, and below which a gap is shown through it."""


class MomentFrame(NamedTuple):
    """One picture of a moment, and what it says."""

    caption: str
    picture: str


def moment_frames(reference: Trajectory, candidate: Candidate, number: int = 0) -> list[MomentFrame]:
    """Both runs before the first divergence, at it, and some events after: the reference solid, the engine dashed.

    All frames show the same part of the plane. Where the gap that decides is too small to be seen, a lens enlarges it.
    """
    parted, run = candidate.alignment.divergence, candidate.trajectory
    assert parted is not None
    names = names_of((parted.body, parted.expected, parted.got))
    at, known = instant_of(parted), [t for t in (parted.expected_time, parted.got_time) if t is not None]
    times = [_before(reference, run, names, at), at, _after(reference, run, at, max(known, default=at))]
    shown = [_discs_at(reference, run, time, names, number) for time in times]
    view = _frame_view([[d for d in discs if d.id in names] for discs in shown], [d for row in shown for d in row],
                       reference)  # fmt: skip
    digits = next((d for d in range(6, 17) if len({f"{t:.{d}g}" for t in times}) == len({*times})), 17)
    lens = _lens(candidate, shown[1], view, number)
    told = ("Before", f"Event {parted.event:,}", "After")
    return [
        MomentFrame(
            f"{word}: t = {time:.{digits}g}",
            draw(
                as_at(reference.scene, time),
                discs,
                f"{word}, time {time:.{digits}g}: {reference.engine} solid, {candidate.engine} dashed",
                marked=names,
                view=view,
                over=lens if k == 1 else "",
            ),
        )
        for k, (word, time, discs) in enumerate(zip(told, times, shown, strict=True))
    ]


def instant_of(parted: Divergence) -> float:
    """The time to show a divergence at: the earlier meeting; where the two are one instant but for rounding, the later.

    So the contact that is first of the two is in the picture.
    """
    ends = [t for t in (parted.expected_time, parted.got_time) if t is not None]
    later = max(ends, default=parted.time)
    return later if later - parted.time <= ONE_INSTANT * later else parted.time


def _before(reference: Trajectory, run: Trajectory, names: Sequence[str], at: float) -> float:
    """A time before the moment: soon after the last meeting of those in question, or `RADII` of flight earlier."""
    circles = [c for c in reference.scene.circles if str(c.id) in names]
    last = max(
        (
            float(event.time)
            for each in (reference, run)
            for event in each.events
            if float(event.time) < at * (1 - ONE_INSTANT)
            and any(str(n) in names for pair in event.impulses for n in pair)
        ),
        default=0.0,
    )
    row = reference.sample([min(at, float(reference.final_time)) * (1 - 2**-40)])[0]
    places = {str(c.id): k for k, c in enumerate(reference.scene.circles)}
    speed = max((math.hypot(*row[places[str(c.id)]][2:]) for c in circles), default=0.0)
    radius = max((float(c.r) for c in circles), default=0.0)
    flown = RADII * radius / speed if speed > 0 and radius > 0 else math.inf
    return max(last + (at - last) / 8, at - flown)


def _after(reference: Trajectory, run: Trajectory, at: float, other: float) -> float:
    """A time after it: of the other meeting, or a few events later."""
    if other > at * (1 + ONE_INSTANT):
        return other
    later = [t for event in run.events if (t := float(event.time)) > at * (1 + ONE_INSTANT)][:EVENTS_AFTER]
    if later:
        return later[-1]
    ends = [float(each.final_time) for each in (reference, run) if each.stop.reason is not StopReason.QUIET]
    return min([at * 1.25, *ends])


def states_at(run: Trajectory, time: float) -> list[list[float]]:
    """x, y, vx, vy of each circle; of a run in which nothing is left to happen also after its last event."""
    final = float(run.final_time)
    if time < final:
        return [list(row) for row in rows_of(run, [time])[0]]
    flown = time - final if run.stop.reason is StopReason.QUIET else 0.0
    return [
        [x + (vx + gx / 2 * flown) * flown, y + (vy + gy / 2 * flown) * flown, vx + gx * flown, vy + gy * flown]
        for (x, y, vx, vy), (gx, gy) in zip(run.final.rows(), pulls(run, final), strict=True)
    ]


def pulls(run: Trajectory, time: float) -> list[tuple[float, float]]:
    """What bends the flight of each circle at a time: gravity, or what it has along a slope that it slides down.

    Nothing of one that is fixed, carried by a wall, or out of play.
    """
    carries = getattr(run.motion, "carries", None) if run.scene.settle or run.scene.capture else None
    at, slides = time if time < float(run.final_time) else run.final_time, run.slides if run.scene.settle else {}
    gx, gy = run.scene.gravity or (0, 0)
    found: list[tuple[float, float]] = []
    for i, circle in enumerate(run.scene.circles):
        begun, slope = slides.get(str(circle.id), (math.inf, (0.0, 0.0)))
        stands = circle.fixed or (carries is not None and carries(i, at))
        found.append((float(gx), float(gy)) if not stands else slope if begun <= time else (0.0, 0.0))
    return found


def _discs_at(
    reference: Trajectory, run: Trajectory, time: float, names: Sequence[str], number: int
) -> list[DrawnDisc]:
    """The circles of both runs just before a time, those in question marked."""
    discs: list[DrawnDisc] = []
    for trajectory, kind in ((reference, "circle"), (run, f"other e{number}")):
        for circle, row in zip(trajectory.scene.circles, states_at(trajectory, time * (1 - 2**-40)), strict=True):
            if circle.fixed and kind != "circle":
                continue
            classes = f"{'fixed' if circle.fixed else kind}{' marked' if str(circle.id) in names else ''}"
            x, y, vx, vy = row
            discs.append(DrawnDisc(str(circle.id), x, y, float(circle.r), vx, vy, classes, label=kind == "circle"))
    return discs


NEAR = 3.0
"""Room around the circles in question, in radii of the largest."""


def _frame_view(near: Sequence[Sequence[DrawnDisc]], every: Sequence[DrawnDisc], reference: Trajectory) -> View:
    """One view for all frames: the circles in question with room around them, or all where that is as much."""
    whole = view_of(every, reference.scene)
    discs = [disc for row in near for disc in row]
    left, bottom, width, height = whole.left, whole.bottom, whole.width, whole.height
    if discs:
        room = max(NEAR * max(d.r for d in discs), 1e-3 * whole.width)
        left, right = min(d.x for d in discs) - room, max(d.x for d in discs) + room
        bottom, top = min(d.y for d in discs) - room, max(d.y for d in discs) + room
        width, height = right - left, top - bottom
        if max(width / whole.width, height / whole.height) > 1:
            left, bottom, width, height = whole.left, whole.bottom, whole.width, whole.height
    size = max(width / FRAME_WIDTH, height / FRAME_HEIGHT)
    across, up = size * FRAME_WIDTH, size * FRAME_HEIGHT
    return View(left + (width - across) / 2, bottom + (height - up) / 2, across, up, FRAME_WIDTH, FRAME_HEIGHT)


def gap_values(candidate: Candidate) -> tuple[float, float | None] | None:
    """The gap that decides in the exact motion, and as the engine has it; None where the decision is no hit or miss.

    Above zero is a miss, below a hit.
    """
    margin, found = candidate.margin, candidate.diagnosis
    if margin is None or margin.gap is not None or margin.distance is None:
        return None
    exact = margin.distance[0] + (margin.distance[1] - margin.distance[0]) / 2
    shift = None if found is None or not found.closed else found.displacement
    return exact, None if shift is None else exact + shift


def _lens(candidate: Candidate, discs: Sequence[DrawnDisc], view: View, number: int) -> str:
    """The gap that decides, enlarged in a corner of the picture; empty where it can be seen, or is exactly zero.

    A line for the surface of the circle, one for the reference's partner, and a dashed one for the engine's.
    """
    values, parted = gap_values(candidate), candidate.alignment.divergence
    if values is None or parted is None or not values[0] or abs(values[0]) * view.scale >= SMALL_GAP:
        return ""
    exact, own = values
    partner = parted.got if exact > 0 else parted.expected
    solid = {d.id: d for d in discs if d.label}
    body, other = solid.get(parted.body), solid.get(partner or "")
    nx, ny = (1.0, 0.0) if body is None or other is None else (other.x - body.x, body.y - other.y)
    size = math.hypot(nx, ny) or 1.0
    nx, ny = nx / size, ny / size
    times = LENS_GAP / (abs(exact) * view.scale)
    cx, cy = FRAME_WIDTH - LENS - 8, FRAME_HEIGHT - LENS - 22

    def edge(kind: str, along: float) -> str:
        x, y, half = cx + nx * along, cy + ny * along, math.sqrt(LENS**2 - along**2)
        ends = f'x1="{x - ny * half:.1f}" y1="{y + nx * half:.1f}" x2="{x + ny * half:.1f}" y2="{y - nx * half:.1f}"'
        return f'<line class="{kind}" {ends}/>'

    start, limit = -LENS_GAP / 2, LENS - 6
    lines = [edge("circle", start), edge("circle", max(-limit, min(limit, start + exact * times * view.scale)))]
    if own is not None:
        lines.append(edge(f"other e{number}", max(-limit, min(limit, start + own * times * view.scale))))
    told = f"{times:,.0f}" if times < 1e6 else f"{times:.1g}"
    return "".join(
        [
            f'<circle class="lens" cx="{cx}" cy="{cy}" r="{LENS}"/>',
            *lines,
            f'<text class="name" x="{cx}" y="{FRAME_HEIGHT - 10}">gap, {told} times</text>',
        ]
    )


def notebook_picture(reference: Trajectory, candidates: Sequence[Candidate]) -> str:
    """The first of these engines that leaves the history, where it does, as a file of SVG; else the scene at time 0."""
    parted = [(d.time, k) for k, c in enumerate(candidates) if (d := c.alignment.divergence) is not None]
    if not parted:
        return scene_picture(reference.scene, standalone=True)
    _, number = min(parted)
    divergence = candidates[number].alignment.divergence
    assert divergence is not None
    names, time = names_of((divergence.body, divergence.expected, divergence.got)), instant_of(divergence)
    discs = _discs_at(reference, candidates[number].trajectory, time, names, number)
    title = f"{reference.engine} (solid) and {candidates[number].engine} (dashed) at time {time:.9g}"
    style = engine_css([c.engine for c in candidates[: number + 1]])
    return draw(as_at(reference.scene, time), discs, title, marked=names, standalone=True, style=style)


def names_of(partners: Iterable[str | None]) -> list[str]:
    """The ids among the partners of a divergence, each once; those of a tie are joined by + or then."""
    return list(dict.fromkeys(n for text in partners if text for n in text.replace(" then ", " + ").split(" + ")))


def svg_path(name: str) -> Path:
    """A path for a picture.

    Raises:
        SceneError: unless it ends in .svg.
    """
    from ..scenarios.errors import SceneError

    if not name.lower().endswith(".svg"):
        raise SceneError(f"--plot {name!r}: pictures are SVG; give a file name that ends in .svg")
    return Path(name)
