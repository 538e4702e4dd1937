"""Pictures of two runs at the moment at which they part, as SVG."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ....scenarios.pictures import HEIGHT, WIDTH, DrawnDisc, View, draw, scene_picture, view_of
from .engine_style import engine_css

if TYPE_CHECKING:
    from ....scenarios.trajectory import Trajectory
    from ...candidate import Candidate


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
    style = engine_css(number + 1)
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
    from ....scenarios.errors import SceneError

    if not name.lower().endswith(".svg"):
        raise SceneError(f"--plot {name!r}: pictures are SVG; give a file name that ends in .svg")
    return Path(name)
