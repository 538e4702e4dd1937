"""Whether a history keeps the mirror symmetry that its scene starts with."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from ..alignment.streams import history

if TYPE_CHECKING:
    from ...scenarios.numbers.quantity import Quantity
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory

Axis: TypeAlias = Literal["x", "y"]

LINEAR_PARTS: dict[Axis, tuple[int, int, int, int]] = {"y": (1, 0, 0, -1), "x": (-1, 0, 0, 1)}
"""Of the mirror whose line is a value of the axis: (x, y) becomes (a x + b y, c x + d y)."""


def symmetry(trajectory: Trajectory) -> dict[str, Any] | None:
    """Whether each ball keeps meeting the mirror images of what its own image meets.

    Looks for a mirror line parallel to an axis through the centre of the circles, exactly; None if there is
    none. Then compares partners only, so that a late rounding of positions counts for nothing until it
    changes whom a ball meets.

    Returns:
        `line` (such as `y = 21`), `kept`, and `lost_at`, the time of the first meeting without an image.
    """
    for axis in ("y", "x"):
        found = mirror(trajectory.scene, axis)
        if found is None:
            continue
        line, image = found
        lost = _lost_at(trajectory, image)
        return {"line": f"{axis} = {line.text()}", "kept": lost is None, "lost_at": lost}
    return None


def mirror(scene: Scene, axis: Axis) -> tuple[Quantity, dict[str, str]] | None:
    """A mirror line `axis = constant` of the whole scene, with the image of every circle and wall; else None.

    The exact engine's own isometries are looked through; a lone circle has none worth telling.

    >>> from truebreak.scenarios import Circle, Scene
    >>> mirror(Scene([Circle(0, 2, id="a"), Circle(0, -2, id="b")]), "y")[1]
    {'a': 'b', 'b': 'a'}
    """
    from ...exact.log_symmetry import symmetries
    from ...scenarios.numbers.quantity import ZERO

    circles = scene.circles
    if len(circles) < 2:
        return None
    found = next((s for s in symmetries(scene) if s.mirror and s.matrix == LINEAR_PARTS[axis]), None)
    if found is None:
        return None
    line = sum((getattr(c, axis) for c in circles), ZERO) / len(circles)
    image = {str(c.id): str(circles[place].id) for c, place in zip(circles, found.circles, strict=True)}
    image |= {str(w.id): str(scene.walls[place].id) for w, place in zip(scene.walls, found.walls, strict=True)}
    return line, image


def _lost_at(trajectory: Trajectory, image: dict[str, str]) -> float | None:
    """Time of the first meeting whose mirror image does not take place."""
    seen = history(trajectory)
    lost: list[float] = []
    for body, meetings in seen.meetings.items():
        mine = [(name, m.event) for m in meetings for name in sorted(image[p] for p in m.partners)]
        theirs = [(name, m.event) for m in seen.meetings[image[body]] for name in sorted(m.partners)]
        for (a, event), (b, other) in zip(mine, theirs, strict=False):
            if a != b:
                lost.append(min(seen.times[event], seen.times[other]))
                break
        else:
            longer = mine if len(mine) > len(theirs) else theirs
            if abs(len(mine) - len(theirs)) > 1:  # one may lie beyond the end by rounding
                lost.append(seen.times[longer[min(len(mine), len(theirs))][1]])
    return min(lost, default=None)
