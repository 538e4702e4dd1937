"""Pictures of runs as SVG, and the colour and dash by which engines are known in every figure."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from ..scenarios.pictures import HEIGHT, WIDTH, DrawnDisc, View, draw, scene_picture, view_of

if TYPE_CHECKING:
    from ..scenarios.trajectory import Trajectory
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


def divergence_picture(reference: Trajectory, candidate: Candidate, number: int = 0) -> str:
    """Both runs at the time of the first divergence: the reference solid, the candidate in the style of its place.

    Where the circles in question are small, a close-up of them follows.
    """
    discs, marked, title = _parting(reference, candidate, number)
    whole = view_of(discs, reference.scene)
    close = view_near([d for d in discs if "marked" in d.classes], whole)
    if close is not None:
        near = draw(reference.scene, discs, f"{title}, close up", marked=marked, view=close)
        return draw(reference.scene, discs, title, marked=marked) + near
    return draw(reference.scene, discs, title, marked=marked)


def notebook_picture(reference: Trajectory, candidates: Sequence[Candidate]) -> str:
    """The first of these engines that leaves the history, where it does, as a file of SVG; else the scene at time 0."""
    parted = [(d.time, k) for k, c in enumerate(candidates) if (d := c.alignment.divergence) is not None]
    if not parted:
        return scene_picture(reference.scene, standalone=True)
    _, number = min(parted)
    discs, marked, title = _parting(reference, candidates[number], number)
    style = engine_css([c.engine for c in candidates[: number + 1]])
    return draw(reference.scene, discs, title, marked=marked, standalone=True, style=style)


def _parting(reference: Trajectory, candidate: Candidate, number: int) -> tuple[list[DrawnDisc], set[str], str]:
    """The circles of both runs at the time of the first divergence, the names of those in question, and a title."""
    divergence = candidate.alignment.divergence
    assert divergence is not None
    marked = _names((divergence.body, divergence.expected, divergence.got))
    run = candidate.trajectory
    ends = [t for t in (divergence.expected_time, divergence.got_time) if t is not None]
    time = min(max(ends), float(reference.final_time) * (1 - 2**-50), float(run.final_time) * (1 - 2**-50))
    discs = []
    for trajectory, kind in ((reference, "circle"), (run, f"other e{number}")):
        for circle, row in zip(trajectory.scene.circles, trajectory.sample([time])[0], strict=True):
            if circle.fixed and kind != "circle":
                continue
            classes = f"{'fixed' if circle.fixed else kind}{' marked' if circle.id in marked else ''}"
            x, y, vx, vy = (float(v) for v in row)
            discs.append(DrawnDisc(str(circle.id), x, y, float(circle.r), vx, vy, classes, label=kind == "circle"))
    return discs, marked, f"{reference.engine} (solid) and {candidate.engine} (dashed) at time {time:.9g}"


CLOSE_UP_FROM = 20.0
"""Radius in pixels below which the circles that matter are drawn once more, close up."""

CLOSE_UP_REACH = 6.0
"""Size of a close-up, in radii beyond the circles that matter."""


def view_near(discs: Sequence[DrawnDisc], whole: View) -> View | None:
    """A view of a few discs alone; None if the whole shows them as large, or nearly so."""
    radius = max((d.r for d in discs), default=0.0)
    if radius <= 0 or radius * whole.scale >= CLOSE_UP_FROM:
        return None
    room = CLOSE_UP_REACH * radius
    left, right = min(d.x for d in discs) - room, max(d.x for d in discs) + room
    bottom, top = min(d.y for d in discs) - room, max(d.y for d in discs) + room
    size = max((right - left) / WIDTH, (top - bottom) / HEIGHT)
    if 1 / size < 1.5 * whole.scale:
        return None
    width, height = size * WIDTH, size * HEIGHT
    return View((left + right - width) / 2, (bottom + top - height) / 2, width, height)


def _names(marked: Iterable[str | None]) -> set[str]:
    """The ids among the partners of a divergence; those of a tie are joined by + or then."""
    return {name for text in marked if text for name in text.replace(" then ", " + ").split(" + ")}


def svg_path(name: str) -> Path:
    """A path for a picture.

    Raises:
        SceneError: unless it ends in .svg.
    """
    from ..scenarios.errors import SceneError

    if not name.lower().endswith(".svg"):
        raise SceneError(f"--plot {name!r}: pictures are SVG; give a file name that ends in .svg")
    return Path(name)
