"""By how much each meeting of a run was decided: how far a circle may be displaced before another comes of it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....exact.laws.formulas import (
    pair_approach,
    pair_discriminant,
    pair_gap,
    pair_hit_time,
    pair_impulse,
    wall_approach,
    wall_bounce,
    wall_gap,
    wall_hit_time,
)
from ...tangent.impacts import Impact

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ....scenarios.scene import Scene


WALL = -1
"""In place of the index of a circle."""


class Others(NamedTuple):
    """What a circle would meet next.

    Attributes:
        places: circles by index, or `WALL`.
        waits: how long until then.
        rates: how fast they then approach.
        normals: shape (others, 2): unit vectors from the circle to each, as they then meet.
    """

    places: NDArray[np.intp]
    waits: NDArray[np.float64]
    rates: NDArray[np.float64]
    normals: NDArray[np.float64]


class Course:
    """The states of all circles along a run's impacts, in doubles.

    Attributes:
        places, speeds: shape (circles, 2), at `time`.
        time: where they stand.
    """

    def __init__(self, scene: Scene) -> None:
        circles = scene.circles
        self.places: NDArray[np.float64] = np.array([[float(c.x), float(c.y)] for c in circles])
        self.speeds: NDArray[np.float64] = np.array([[float(c.vx), float(c.vy)] for c in circles])
        self.time = 0.0
        self._radii = np.array([float(c.r) for c in circles])
        self._walls: NDArray[np.float64] = np.zeros((len(scene.walls), 4))
        for k, wall in enumerate(scene.walls):
            normal = np.array([float(part) for part in wall.normal])
            self._walls[k] = [float(wall.x0), float(wall.y0), *(normal / np.hypot(*normal))]

    def fly(self, time: float) -> None:
        """Goes on to a time, in straight flight."""
        self.places += (time - self.time) * self.speeds
        self.time = time

    def push(self, impact: Impact) -> list[tuple[int, NDArray[np.float64]]]:
        """Carries an impact out: each circle that takes part, and the change of its velocity."""
        a, b, dx, dy, vx, vy, reach, wa, wb = as_doubles(impact)
        if b is None:
            ux, uy = self.speeds[a]
            after = np.array(wall_bounce(ux, uy, dx, dy, reach * reach))
            changes = [(a, after - self.speeds[a])]
        else:
            impulse = np.array(pair_impulse(dx, dy, vx, vy, reach, wa, wb))
            changes = [(a, -wa * impulse), (b, wb * impulse)]
        for i, change in changes:
            self.speeds[i] += change
        return changes

    def margins(self, event: Sequence[Impact], impact: Impact, i: int) -> NDArray[np.float64]:
        """How far circle i, which takes part in an impact, may be displaced before its next meeting is another one.

        One number for each that it would meet next, were it not for the impact: an error changes the times of both
        meetings, each by the error's part along the approach over the speed of approach; taken as if both parts were as
        long as the margin, and of opposite effect. And one, for two circles, for how far they are from missing each
        other.
        """
        _, b, dx, dy, vx, vy, reach, *_ = as_doubles(impact)
        closing = abs(pair_approach(dx, dy, vx, vy)) / reach
        others = self.instead(event, i)
        orders = others.waits * (closing * others.rates / (closing + others.rates))
        if b is None:
            return orders
        return np.append(orders, max(reach - abs(dx * vy - dy * vx) / np.hypot(vx, vy), 0.0))

    def instead(self, event: Sequence[Impact], i: int) -> Others:
        """What circle i, which takes part in an event, would meet were it not for that.

        Where several contacts of one circle at one instant have a tangent map, their order decides nothing.
        """
        met = [impact for impact in event if i in (impact.a, impact.b)]
        partners = [impact.b if i == impact.a else impact.a for impact in met if impact.b is not None]
        circles, walls = self._circles(i, partners), self._walls_of(i, len(met) - len(partners))
        return Others(
            np.concatenate([circles.places, walls.places]),
            np.concatenate([circles.waits, walls.waits]),
            np.concatenate([circles.rates, walls.rates]),
            np.concatenate([circles.normals, walls.normals]),
        )

    def _circles(self, i: int, partners: Sequence[int]) -> Others:
        """The circles in its way, but for its partners."""
        (dx, dy), (vx, vy) = (self.places - self.places[i]).T, (self.speeds - self.speeds[i]).T
        reach = self._radii + self._radii[i]
        approach, room = pair_approach(dx, dy, vx, vy), pair_discriminant(dx, dy, vx, vy, reach)
        meets = (approach < 0) & (room > 0)
        meets[[i, *partners]] = False
        dx, dy, reach, root = dx[meets], dy[meets], reach[meets], np.sqrt(room[meets])
        waits = pair_hit_time(np.maximum(pair_gap(dx, dy, reach), 0.0), approach[meets], root)
        normals = np.column_stack([dx + waits * vx[meets], dy + waits * vy[meets]]) / reach[:, None]
        return Others(np.flatnonzero(meets), waits, root / reach, normals)

    def _walls_of(self, i: int, at_walls: int) -> Others:
        """The walls in its way, but for those that it is at."""
        (x0, y0, nx, ny), (x, y), (ux, uy) = self._walls.T, self.places[i], self.speeds[i]
        gap = wall_gap(x, y, x0, y0, nx, ny, 0.0)
        side = np.where(gap < 0, -1.0, 1.0)
        gap, approach = side * gap - self._radii[i], side * wall_approach(ux, uy, nx, ny)
        meets = approach < 0
        meets[np.abs(gap).argsort()[:at_walls]] = False
        waits = wall_hit_time(np.maximum(gap[meets], 0.0), approach[meets])
        normals = -side[meets, None] * np.column_stack([nx[meets], ny[meets]])
        return Others(np.full(len(waits), WALL), waits, -approach[meets], normals)


def as_doubles(impact: Impact) -> tuple[int, int | None, float, float, float, float, float, float, float]:
    """All of an impact but its time."""
    dx, dy, vx, vy, reach, wa, wb = (float(number) for number in impact[3:])
    return impact.a, impact.b, dx, dy, vx, vy, reach, wa, wb


def margins(
    scene: Scene, struck: Sequence[Sequence[Impact]], free: Sequence[int]
) -> list[list[tuple[int, NDArray[np.float64]]]]:
    """Event by event, the margins of each of the circles `free` that takes part.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.compare.tangent.impacts import impacts
    >>> from truebreak.scenarios import Circle, Scene, Wall
    >>> scene = Scene([Circle(0, 0, vx=1, vy=1)], [Wall(10, 0, 10, 1), Wall(0, "101/10", 1, "101/10")])
    >>> [[(circle, told)]] = margins(scene, impacts(ExactEngine().run(scene), 1), [0])
    >>> circle, [round(float(value), 3) for value in told]  # 0.05 back and 0.05 up, and it meets the other wall first
    (0, [0.05])
    """
    course, told = Course(scene), []
    for event in struck:
        course.fly(float(event[0].time))
        met = [(impact, i) for impact in event for i in (impact.a, impact.b) if i is not None and i in free]
        told.append([(i, course.margins(event, impact, i)) for impact, i in met])
        for impact in event:
            course.push(impact)
    return told
