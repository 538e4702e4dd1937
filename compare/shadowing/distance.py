"""How far an engine's run is from a certified one of the same contacts: proved bounds, over all of the time."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import inf, nextafter
from typing import TYPE_CHECKING, Any, NamedTuple

from flint import arb

from ...exact.exact_motion import motion_of
from ...exact.numbers import ball
from ...exact.numbers.ball import known_ball

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory
    from .record import Record

BITS = 128
"""Accuracy of the certified run's numbers in the bounds: far beyond the doubles that are told."""


class FlightAfter(NamedTuple):
    """A circle's flight after a contact: the contact's instant, and x, y at clock t with velocity vx, vy."""

    instant: arb
    t: arb
    x: arb
    y: arb
    vx: arb
    vy: arb

    def place(self, time: arb) -> tuple[arb, arb]:
        """Where the line of the flight is at a time."""
        return self.x + self.vx * (time - self.t), self.y + self.vy * (time - self.t)


@dataclass(frozen=True)
class Distance:
    """Upper bounds, proved.

    Attributes:
        position: between the two places of a circle, at any time from 0 until one of the runs has its last contact.
        velocity: between its two velocities, after any contact that both have had.
        time: between the two times of a contact.
        circle: the one that is farthest.
    """

    position: float
    velocity: float
    time: float
    circle: str


@dataclass(frozen=True)
class StartDistance:
    """How far one start is from another: upper bounds, proved, over all circles.

    Attributes:
        position, velocity: of a circle.
    """

    position: float
    velocity: float


def distance(record: Record, certified: Trajectory) -> Distance | None:
    """The distance of an engine's run from a certified run in which each circle has the same contacts in order.

    Both fly straight between contacts, so a circle is farthest at a contact of the one or of the other. Where each
    contact comes in both before the circle's next one does in either, which is checked, these two moments, on the
    flights before and after it, bound all others.

    Returns:
        None where the contacts of one circle are closer to each other than the two runs are, or where the certified
        run tells of other changes of velocity than its contacts.
    """
    free = list(record.flights)
    flights = _flights(certified, record)
    if flights is None:
        return None
    position = velocity = time = 0.0
    circle = ""
    with ball.precision(BITS + 64):
        for i in free:
            mine = [FlightAfter(arb(f[0]), *map(arb, f)) for f in record.flights[i]]
            theirs = flights[i][: len(mine)]
            ends: list[tuple[arb, arb]] = [(f.instant, g.instant) for f, g in zip(mine, theirs, strict=True)]
            for (a, b), (c, d) in pairwise(ends):
                if not all(first < second for first in (a, b) for second in (c, d)):
                    return None
            for k, (first, second) in enumerate(ends):
                time = max(time, _upper(first - second))
                f, g = mine[k], theirs[k]
                velocity = max(velocity, _length(f.vx - g.vx, f.vy - g.vy))
                for moment in (first, second):
                    for one in mine[max(k - 1, 0) : k + 1]:
                        for other in theirs[max(k - 1, 0) : k + 1]:
                            (ax, ay), (bx, by) = one.place(moment), other.place(moment)
                            apart = _length(ax - bx, ay - by)
                            if apart > position:
                                position, circle = apart, str(certified.scene.circles[i].id)
            last = arb(record.times[-1])
            (ax, ay), (bx, by) = mine[-1].place(last), theirs[-1].place(last)
            apart = _length(ax - bx, ay - by)
            if apart > position:
                position, circle = apart, str(certified.scene.circles[i].id)
    return Distance(position, velocity, time, circle)


def start_distance(one: Scene, other: Scene) -> StartDistance:
    """How far the starts of two scenes of the same circles are from each other."""
    position = velocity = 0.0
    with ball.precision(BITS + 64):
        for a, b in zip(one.circles, other.circles, strict=True):
            dx, dy, dvx, dvy = (
                ball.constant(p - q) for p, q in ((a.x, b.x), (a.y, b.y), (a.vx, b.vx), (a.vy, b.vy))
            )  # fmt: skip
            position, velocity = max(position, _length(dx, dy)), max(velocity, _length(dvx, dvy))
    return StartDistance(position, velocity)


def _flights(certified: Trajectory, record: Record) -> dict[int, list[FlightAfter]] | None:
    """The flights of a certified run, from its knots; None unless there is one for each contact."""
    motion = motion_of(certified)
    assert motion is not None
    knots = motion.knots
    place = {name: k for k, name in enumerate(certified.scene.ids)}
    instants: dict[int, list[arb]] = {i: [arb(0)] for i in record.flights}
    for event in certified.events:
        value: Any = event.time
        near = None
        for name in {name for pair in event.impulses for name in pair}:
            if place[name] in instants:
                near = value.ball(BITS) if near is None else near
                instants[place[name]].append(near)
    told: dict[int, list[FlightAfter]] = {}
    with ball.precision(BITS + 64):
        for i, times in instants.items():
            if len(times) != len(knots[i]):
                return None
            told[i] = [FlightAfter(when, *(known_ball(number, BITS) for number in knot[:5]))
                       for when, knot in zip(times, knots[i], strict=True)]  # fmt: skip
    return told


def _upper(value: arb) -> float:
    """A double at or above the size of every number in a ball."""
    if value.is_zero():
        return 0.0
    return nextafter(float(value.abs_upper()), inf) if value.is_finite() else inf


def _length(x: arb, y: arb) -> float:
    """An upper bound of a vector's length."""
    wide, high = x.abs_upper(), y.abs_upper()
    return _upper(ball.root(wide * wide + high * high))
