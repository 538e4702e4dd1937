"""Entries into pockets of a run whose engine knows none: they follow from the straight flights between its knots."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise

from ..scenarios.numbers.precision import Double
from ..scenarios.scene import Scene
from ..scenarios.trajectory import Pocketing
from .knots import DoubleKnot


def entries(scene: Scene, knots: Sequence[Sequence[DoubleKnot]], end: float) -> tuple[Pocketing, ...]:
    """Every time that a centre comes within a pocket's radius, in order.

    Between two knots a centre flies straight, and enters a pocket (X, Y, R) when |p + v t - (X, Y)|^2 = R^2 has its
    smaller root within the flight.
    """
    found = [
        Pocketing(str(circle.id), str(pocket.id), Double(time))
        for circle, row in zip(scene.circles, knots, strict=True)
        if not circle.fixed
        for pocket in scene.pockets
        for time in _times(row, float(pocket.x), float(pocket.y), float(pocket.r), end)
    ]
    return tuple(sorted(found, key=lambda entry: float(entry.time)))


def last_entry(scene: Scene, knots: Sequence[Sequence[DoubleKnot]], end: float) -> float:
    """When a run that has no contact left has no entry left either: never before `end`."""
    return max([end, *(float(entry.time) for entry in entries(scene, knots, math.inf))])


def _times(row: Sequence[DoubleKnot], x0: float, y0: float, r: float, end: float) -> Iterator[float]:
    """When one circle enters one pocket.

    At the time of a knot the velocity from then on decides: who is turned away at the rim does not enter.
    """
    _, x, y, _, _ = row[0]
    inside = _gap(x - x0, y - y0, r) < 0
    for (t, x, y, vx, vy), (after, *_) in pairwise([*row, (math.inf, 0.0, 0.0, 0.0, 0.0)]):
        if t > end or t == after:
            continue
        wait = time_to_enter(x - x0, y - y0, vx, vy, r)
        enters = wait is not None and t + wait < after and t + wait <= end
        if enters and not (inside and wait == 0):
            yield t + (wait or 0.0)
        lag = after - t
        inside = (inside or enters) and _gap(x + vx * lag - x0, y + vy * lag - y0, r) < 0


def time_to_enter(dx: float, dy: float, vx: float, vy: float, r: float) -> float | None:
    """Time until a point comes within r of the origin; 0 if it is there already, None if it never does, or grazes.

    >>> time_to_enter(-3.0, 0.0, 1.0, 0.0, 1.0), time_to_enter(-3.0, 1.0, 1.0, 0.0, 1.0)
    (2.0, None)
    """
    gap = _gap(dx, dy, r)
    if gap < 0:
        return 0.0
    approach, speed2 = dx * vx + dy * vy, vx * vx + vy * vy
    discriminant = speed2 * r * r - (dx * vy - dy * vx) ** 2
    if approach >= 0 or discriminant <= 0:
        return None
    return gap / (-approach + math.sqrt(discriminant))


def _gap(dx: float, dy: float, r: float) -> float:
    """The square of a centre's distance less that of the rim's: below zero inside."""
    return dx * dx + dy * dy - r * r
