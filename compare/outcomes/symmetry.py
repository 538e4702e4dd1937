"""Whether a history keeps the mirror symmetry that its scene starts with."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from ..alignment.streams import history

if TYPE_CHECKING:
    from ...scenarios.numbers.quantity import Quantity
    from ...scenarios.scene import Scene
    from ...scenarios.things import Circle, Wall
    from ...scenarios.trajectory import Trajectory

Axis: TypeAlias = Literal["x", "y"]

DIGITS = 9
"""Decimals of a double by which likely mirror images are looked up; whether they are is then decided
exactly."""


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

    >>> from truebreak.scenarios import Circle, Scene
    >>> mirror(Scene([Circle(0, 2, id="a"), Circle(0, -2, id="b")]), "y")[1]
    {'a': 'b', 'b': 'a'}
    """
    from ...scenarios.numbers.quantity import ZERO

    if len(scene.circles) < 2:
        return None
    line = sum((getattr(c, axis) for c in scene.circles), ZERO) / len(scene.circles)
    image: dict[str, str] = {}
    if not _map_circles(scene, axis, line, image) or not _map_walls(scene, axis, line, image):
        return None
    return line, image


def _map_circles(scene: Scene, axis: Axis, line: Quantity, image: dict[str, str]) -> bool:
    places: dict[tuple[float, float], list[Circle]] = {}
    for circle in scene.circles:
        places.setdefault(_key(circle.x, circle.y), []).append(circle)
    other: Axis = "x" if axis == "y" else "y"
    for circle in scene.circles:
        across = 2 * line - getattr(circle, axis)
        place = (circle.x, across) if axis == "y" else (across, circle.y)
        twin = next(
            (
                c
                for c in places.get(_key(*place), [])
                if (c.x, c.y, c.r, c.m) == (*place, circle.r, circle.m)
                and getattr(c, f"v{other}") == getattr(circle, f"v{other}")
                and (getattr(c, f"v{axis}") + getattr(circle, f"v{axis}")).sign() == 0
            ),
            None,
        )
        if twin is None:
            return False
        image[str(circle.id)] = str(twin.id)
    return True


def _map_walls(scene: Scene, axis: Axis, line: Quantity, image: dict[str, str]) -> bool:
    for wall in scene.walls:
        ends = [
            (x, 2 * line - y) if axis == "y" else (2 * line - x, y) for x, y in ((wall.x0, wall.y0), (wall.x1, wall.y1))
        ]
        twin = next((w for w in scene.walls if _holds(w, ends)), None)
        if twin is None:
            return False
        image[str(wall.id)] = str(twin.id)
    return True


def _holds(wall: Wall, points: list[tuple[Quantity, Quantity]]) -> bool:
    return all(wall.height(x, y).sign() == 0 for x, y in points)


def _key(x: Quantity, y: Quantity) -> tuple[float, float]:
    return round(float(x), DIGITS) + 0.0, round(float(y), DIGITS) + 0.0


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
