"""Walls for engines that want them in doubles, from one side, or of a finite length."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ....floating.pymunk_space import Point, clipped

if TYPE_CHECKING:
    from ....scenarios.scene import Scene

REACH = 64.0
"""How far a wall goes on, in extents of the scene, where no other wall ends it."""


@dataclass(frozen=True)
class WallLine:
    """A wall in doubles: where nx * x + ny * y = height; (nx, ny) has length 1."""

    nx: float
    ny: float
    height: float

    def distance(self, x: float, y: float) -> float:
        """Of a point, signed."""
        return self.nx * x + self.ny * y - self.height


@dataclass(frozen=True)
class Stretch:
    """The part of a wall beside which the circles of a scene can be."""

    start: Point
    end: Point

    def beside(self, x: float, y: float) -> bool:
        """Whether a point is between the two lines that cross the wall at its ends.

        >>> Stretch((0.0, 0.0), (2.0, 0.0)).beside(1.0, 5.0), Stretch((0.0, 0.0), (2.0, 0.0)).beside(3.0, 0.0)
        (True, False)
        """
        (x0, y0), (x1, y1) = self.start, self.end
        ux, uy = x1 - x0, y1 - y0
        return 0.0 <= ux * (x - x0) + uy * (y - y0) <= ux * ux + uy * uy


def lines(scene: Scene) -> list[WallLine]:
    """Every wall as a line.

    >>> from truebreak.scenarios import Circle, Scene, Wall
    >>> lines(Scene([Circle(0, 2)], [Wall(0, 0, 4, 0)]))
    [WallLine(nx=0.0, ny=1.0, height=0.0)]
    """
    found: list[WallLine] = []
    for wall in scene.walls:
        nx, ny = (float(part) for part in wall.normal)
        length = math.hypot(nx, ny)
        found.append(WallLine(nx / length, ny / length, (nx * float(wall.x0) + ny * float(wall.y0)) / length))
    return found


def sides(scene: Scene) -> list[list[int]]:
    """For each circle and each wall, on which side of it the circle is: 1 where its normal points, else -1."""
    return [[1 if w.height(c.x, c.y).sign() >= 0 else -1 for w in scene.walls] for c in scene.circles]


def stretches(scene: Scene) -> list[Stretch]:
    """For each wall, as much of it as circles can meet: to where other walls end it, or `REACH`.

    >>> from truebreak.scenarios import Circle, Scene, Wall
    >>> floor = stretches(Scene([Circle(2, 2)], [Wall(0, 0, 1, 0), Wall(0, 0, 0, 1), Wall(9, 0, 9, 1)]))[0]
    >>> round(floor.start[0], 9), round(floor.end[0], 9)
    (-1.0, 10.0)
    """
    walls, biggest = lines(scene), max(float(circle.r) for circle in scene.circles)
    centres = [(float(c.x), float(c.y)) for c in scene.circles]
    xs, ys = [x for x, _ in centres], [y for _, y in centres]
    apart = [abs(wall.distance(x, y)) for wall in walls for x, y in centres]
    spread = REACH * max(max(xs) - min(xs), max(ys) - min(ys), 2 * biggest, *apart)
    corners = (
        (min(xs) - spread, min(ys) - spread),
        (max(xs) + spread, min(ys) - spread),
        (max(xs) + spread, max(ys) + spread),
        (min(xs) - spread, max(ys) + spread),
    )
    room: list[Point] = []
    for side in {tuple(row) for row in sides(scene)}:
        region: list[Point] = list(corners)
        for sign, wall in zip(side, walls, strict=True):
            region = clipped(region, sign * wall.nx, sign * wall.ny, sign * wall.height)
        room += region
    found: list[Stretch] = []
    for wall in walls:
        along = [wall.ny * x - wall.nx * y for x, y in room]
        low, high = min(along) - biggest, max(along) + biggest
        start, end = ((wall.nx * wall.height + wall.ny * s, wall.ny * wall.height - wall.nx * s) for s in (low, high))
        found.append(Stretch(start, end))
    return found
