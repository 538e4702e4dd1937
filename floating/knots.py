"""Motion in doubles, made of knots: where a circle was when its velocity last changed, and how it left."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple, SupportsFloat, TypeAlias

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

NEXT_TO = 1e-6
"""A share of a step within which a time is that of the step."""

DoubleKnot: TypeAlias = tuple[float, float, float, float, float]
"""(t, x, y, vx, vy) of one circle: from time t on it flies straight from (x, y) at (vx, vy)."""

DoubleRow: TypeAlias = tuple[float, float, float, float]
"""(x, y, vx, vy) of one circle."""


@dataclass(frozen=True)
class DoubleMotion:
    """Straight flight between knots: the `Motion` of engines that count in doubles.

    Attributes:
        knots: for each circle, in scene order, its knots by ascending time, at least one. Of several knots at
            one time the last holds, so that a state at an event is the state as the event leaves it.
        end: the last time that may be asked for.

    >>> motion = DoubleMotion([[(0.0, 0.0, 0.0, 1.0, 0.0), (2.0, 2.0, 0.0, -1.0, 0.0)]])
    >>> motion.state(1.5), motion.state(2), motion.state(3)
    ([(1.5, 0.0, 1.0, 0.0)], [(2.0, 0.0, -1.0, 0.0)], [(1.0, 0.0, -1.0, 0.0)])
    >>> motion.sample([1.5, 3.0])[:, 0, 0].tolist()
    [1.5, 1.0]
    """

    knots: Sequence[Sequence[DoubleKnot]]
    end: float = math.inf

    def state(self, time: SupportsFloat) -> list[tuple[float, float, float, float]]:
        """(x, y, vx, vy) of every circle at a time; at a knot, as it leaves it.

        Raises:
            ValueError: for a time before the first knot or after `end`.
        """
        t = float(time)
        self._check(t)
        rows: list[tuple[float, float, float, float]] = []
        for knots in self.knots:
            t0, x, y, vx, vy = knots[bisect_right(knots, t, key=_time) - 1]
            rows.append((x + vx * (t - t0), y + vy * (t - t0), vx, vy))
        return rows

    def flown_from(self, place: int, number: int, time: float) -> DoubleRow:
        """A circle at a time after one of its knots, both by their places."""
        return self.flown(place, self.knots[place][number], time)

    def sample(self, times: Sequence[float]) -> NDArray[np.float64]:
        """Shape (times, circles, 4): the same for many times at once.

        Raises:
            ValueError: as `state`.
        """
        import numpy as np

        at = np.asarray(times, dtype=np.float64)
        result = np.empty((len(at), len(self.knots), 4))
        if len(at):
            self._check(float(at.min()))
            self._check(float(at.max()))
        for column, knots in enumerate(self.knots):
            table = np.array(knots, dtype=np.float64)
            held = table[np.searchsorted(table[:, 0], at, side="right") - 1]
            result[:, column, :2] = held[:, 1:3] + held[:, 3:] * (at - held[:, 0])[:, None]
            result[:, column, 2:] = held[:, 3:]
        return result

    def among(self, place: int, time: float, done: int, count: int) -> DoubleRow | None:
        """A circle after some of its so many events at one time; None where it has not a knot for each.

        >>> knots = [(0.0, 0.0, 0.0, 1.0, 0.0), (2.0, 2.0, 0.0, -1.0, 0.0), (2.0, 2.0, 0.0, 3.0, 0.0)]
        >>> motion = DoubleMotion([knots])
        >>> [motion.among(0, 2.0, done, 2)[2] for done in range(3)], motion.among(0, 2.0, 1, 1)
        ([1.0, -1.0, 3.0], None)
        """
        knots = self.knots[place]
        first = max(bisect_left(knots, time, key=_time), 1)  # the start is no event
        if bisect_right(knots, time, key=_time) - first != count:
            return None
        return self.flown_from(place, first + done - 1, time)

    def flown(self, place: int, knot: DoubleKnot, time: float) -> DoubleRow:
        """A circle, by its place in the scene, at a time after one of its knots."""
        t, x, y, vx, vy = knot
        return x + vx * (time - t), y + vy * (time - t), vx, vy

    def _check(self, time: float) -> None:
        start = max((knots[0][0] for knots in self.knots), default=0.0)
        if not start <= time <= self.end:
            raise ValueError(f"time {time!r} is outside of the run: it lasts from {start!r} to {self.end!r}")


@dataclass(frozen=True)
class SteppedMotion(DoubleMotion):
    """The same by steps: what one of several events of a step leaves is not known."""

    def among(self, place: int, time: float, done: int, count: int) -> DoubleRow | None:
        """None."""
        return None


Slides: TypeAlias = "Mapping[int, tuple[float, float]]"
"""Half of what there is of gravity along a slope, by the knots of a circle from which on it slides down that."""


def bent(knot: DoubleKnot, time: float, halves: tuple[float, float]) -> DoubleRow:
    """x, y, vx, vy at a time after a knot, with half of what bends the flight.

    >>> bent((1.0, 0.0, 8.0, 1.0, 0.0), 2.0, (0.0, -5.0))
    (1.0, 3.0, 1.0, -10.0)
    """
    (t0, x, y, vx, vy), (hx, hy) = knot, halves
    lag = time - t0
    x, y = x + (vx + hx * lag) * lag, y + (vy + hy * lag) * lag
    return x, y, vx + 2.0 * hx * lag, vy + 2.0 * hy * lag


def beside(row: DoubleRow, bounces: EndlessBounces, time: float) -> DoubleRow:
    """A circle that bounces so at a time, from where it would be along the wall."""
    x, y, vx, vy = (one + other for one, other in zip(row, bounces.beside(time), strict=True))
    return x, y, vx, vy


class EndlessBounces(NamedTuple):
    """The infinitely many bounces of a circle on a wall, ever lower, of which an engine tells the first alone.

    Attributes:
        start: the time of that.
        until: when they have come to their end.
        nx, ny: the unit normal of the wall, to the circle's side.
        speed: along it, after the first.
        e: the restitution.
    """

    start: float
    until: float
    nx: float
    ny: float
    speed: float
    e: float

    @property
    def highest(self) -> float:
        """How high the circle comes over the wall: after a bounce with speed v under a pull a that is v^2 / (2 a)."""
        return self.speed * (self.until - self.start) * (1.0 - self.e) / 4.0

    def beside(self, time: float) -> DoubleRow:
        """By how much place and velocity at a time are beside those along the wall.

        >>> fall = EndlessBounces(start=1.0, until=3.0, nx=0.0, ny=1.0, speed=4.0, e=0.5)  # a pull of 8
        >>> fall.beside(1.5), fall.beside(2.25), fall.beside(3.0)
        ((0.0, 1.0, 0.0, 0.0), (0.0, 0.25, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0))
        """
        span = self.until - self.start
        left = (self.until - time) / span if span > 0.0 else 0.0
        if not 0.0 < left <= 1.0:
            return 0.0, 0.0, 0.0, 0.0
        part = self.e ** math.floor(math.log(left) / math.log(self.e))
        up, lag = self.speed * part, (part - left) * span
        pull = 2.0 * self.speed / (span * (1.0 - self.e))
        height, rise = max((up - pull * lag / 2.0) * lag, 0.0), up - pull * lag
        return self.nx * height, self.ny * height, self.nx * rise, self.ny * rise


def ends_of(bounced: Mapping[int, Mapping[int, EndlessBounces]]) -> dict[tuple[int, int], tuple[float, float]]:
    """By circle and the place of the knot after them: when infinitely many bounces begin, and when they end."""
    return {(i, n): (known.start, known.until) for i, row in bounced.items() for n, known in row.items()}


@dataclass(frozen=True)
class FallingMotion(DoubleMotion):
    """The same under gravity: flights between knots are parabolas.

    Attributes:
        halves: half of gravity, along x and along y.
        pegs: the circles that stand.
        carried: by circle, its knots from which on a wall carries it, by their place.
        slides: those of them from which on it slides down a slope, with half of what there is of gravity along that.
        bounced: those of them before which infinitely many bounces come, with these.

    >>> motion = FallingMotion([[(0.0, 0.0, 8.0, 1.0, 0.0)]], halves=(0.0, -2.0))
    >>> motion.state(1.0), motion.sample([2.0]).tolist()
    ([(1.0, 6.0, 1.0, -4.0)], [[[2.0, 0.0, 1.0, -8.0]]])
    """

    halves: tuple[float, float] = (0.0, 0.0)
    pegs: Collection[int] = ()
    carried: Mapping[int, frozenset[int]] = field(default_factory=dict[int, frozenset[int]])
    slides: Mapping[int, Slides] = field(default_factory=dict[int, "Slides"])
    bounced: Mapping[int, Mapping[int, EndlessBounces]] = field(default_factory=dict[int, Mapping[int, EndlessBounces]])

    def state(self, time: SupportsFloat) -> list[tuple[float, float, float, float]]:
        """See `DoubleMotion.state`."""
        t = float(time)
        self._check(t)
        return [self.flown_from(i, bisect_right(row, t, key=_time) - 1, t) for i, row in enumerate(self.knots)]

    def flown_from(self, place: int, number: int, time: float) -> DoubleRow:
        """See `DoubleMotion.flown_from`."""
        knot = self.knots[place][number]
        if number not in self.carried.get(place, ()):
            return FallingMotion.flown(self, place, knot, time)
        slope = self.slides.get(place, {}).get(number)
        row = DoubleMotion.flown(self, place, knot, time) if slope is None else bent(knot, time, slope)
        bounces = self.bounced.get(place, {}).get(number)
        return row if bounces is None else beside(row, bounces, time)

    @property
    def ends(self) -> dict[tuple[int, int], tuple[float, float]]:
        """By circle and the place of the knot after them: when infinitely many bounces begin, and when they end."""
        return ends_of(self.bounced)

    def carries(self, place: int, time: SupportsFloat) -> bool:
        """Whether a circle, by its place in the scene, does not fall from a time on: carried, or out of play."""
        return bisect_right(self.knots[place], float(time), key=_time) - 1 in self.carried.get(place, ())

    def flown(self, place: int, knot: DoubleKnot, time: float) -> DoubleRow:
        """See `DoubleMotion.flown`; of a circle that falls."""
        return bent(knot, knot[0] if place in self.pegs else time, self.halves)

    def sample(self, times: Sequence[float]) -> NDArray[np.float64]:
        """See `DoubleMotion.sample`."""
        import numpy as np

        return np.array([self.state(time) for time in times], dtype=np.float64).reshape(len(times), len(self.knots), 4)


@dataclass(frozen=True)
class SteppedFall(SteppedMotion):
    """The same under gravity by steps: each adds g dt to a velocity, and moves the circle on before that or after.

    Attributes:
        gravity: along x and along y.
        dt: the step; straight flight in between.
        pegs: the circles that stand.
        ahead: how much of its g dt a step moves a circle by: 0 of an engine that moves first, as pymunk, 1 of one that
            adds g dt first, 1/2 of one that falls as the law has it.
        early: how many g dt come between the velocity with which a circle bounces and the impulse: 1 in pymunk.
        rests: by circle, from when to when it lies on something, and goes straight on.

    >>> motion = SteppedFall([[(0.0, 0.0, 8.0, 1.0, 0.0)]], gravity=(0.0, -4.0), dt=0.5)
    >>> motion.state(0.5), motion.state(1.0), motion.state(1.25)
    ([(0.5, 8.0, 1.0, -2.0)], [(1.0, 7.0, 1.0, -4.0)], [(1.25, 6.0, 1.0, -4.0)])
    """

    gravity: tuple[float, float] = (0.0, 0.0)
    dt: float = 1.0
    pegs: Collection[int] = ()
    ahead: float = 0.0
    early: float = 1.0
    rests: Mapping[int, Sequence[tuple[float, float]]] = field(default_factory=dict[int, Sequence[tuple[float, float]]])

    def carries(self, place: int, time: SupportsFloat) -> bool:
        """Whether a circle, by its place in the scene, lies on something at a time."""
        return any(start <= float(time) < end for start, end in self.rests.get(place, ()))

    def state(self, time: SupportsFloat) -> list[tuple[float, float, float, float]]:
        """See `DoubleMotion.state`."""
        t = float(time)
        self._check(t)
        return [self.flown(i, row[bisect_right(row, t, key=_time) - 1], t) for i, row in enumerate(self.knots)]

    def flown(self, place: int, knot: DoubleKnot, time: float) -> DoubleRow:
        """See `DoubleMotion.flown`."""
        if place in self.rests:
            return self.let_go(place, knot, next((e for s, e in self.rests[place] if s <= knot[0] < e), knot[0]), time)
        return self._fallen(place, knot, time)

    def let_go(self, place: int, knot: DoubleKnot, until: float, time: float) -> DoubleRow:
        """A circle that goes straight on up to a time, and falls from then on.

        >>> motion = SteppedFall((), 9.0, gravity=(0.0, -4.0), dt=0.5)
        >>> motion.let_go(0, (0.0, 0.0, 8.0, 1.0, 0.0), 2.0, 3.0)
        (3.0, 7.0, 1.0, -4.0)
        """
        if until <= knot[0]:
            return self._fallen(place, knot, time)
        straight = DoubleMotion.flown(self, place, knot, min(time, until))
        return straight if time <= until else self._fallen(place, (until, *straight), time)

    def _fallen(self, place: int, knot: DoubleKnot, time: float) -> DoubleRow:
        (t0, x, y, vx, vy), (gx, gy), dt = knot, self.gravity, self.dt
        lag = 0.0 if place in self.pegs else time - t0
        steps = round(lag / dt)
        if abs(lag - steps * dt) > NEXT_TO * dt:  # not at a step, but for rounding
            steps = math.floor(lag / dt)
        fallen = dt * dt * steps * (steps - 1) / 2 + (lag - steps * dt) * steps * dt + self.ahead * dt * lag
        x, y = x + vx * lag + gx * fallen, y + vy * lag + gy * fallen
        return x, y, vx + gx * steps * dt, vy + gy * steps * dt

    def sample(self, times: Sequence[float]) -> NDArray[np.float64]:
        """See `DoubleMotion.sample`."""
        import numpy as np

        return np.array([self.state(time) for time in times], dtype=np.float64).reshape(len(times), len(self.knots), 4)


@dataclass(frozen=True)
class EventMotion(DoubleMotion):
    """The same for a run that can have several events at one time.

    Attributes:
        left: for each event its time, and how many knots each circle has once it is over.
        reckoned: the events of which the engine told only when they are: how they leave the circles is computed.
    """

    left: Sequence[tuple[float, Sequence[int]]] = ()
    reckoned: Collection[int] = ()

    def after(self, event: int) -> list[tuple[float, float, float, float]]:
        """(x, y, vx, vy) of every circle as an event leaves it, by its index, before what follows at the same time.

        >>> knots = [(0.0, 0.0, 0.0, 1.0, 0.0), (2.0, 2.0, 0.0, -1.0, 0.0), (2.0, 2.0, 0.0, 3.0, 0.0)]
        >>> EventMotion([knots], left=[(2.0, [2]), (2.0, [3])]).after(0)
        [(2.0, 0.0, -1.0, 0.0)]
        """
        time, counts = self.left[event]
        return [self.flown_from(k, count - 1, time) for k, count in enumerate(counts)]


@dataclass(frozen=True)
class FallingEvents(EventMotion, FallingMotion):
    """The same under gravity.

    >>> motion = FallingEvents([[(0.0, 0.0, 8.0, 1.0, 0.0)]], halves=(0.0, -2.0), left=[(1.0, [1])])
    >>> motion.after(0) == motion.state(1.0)
    True
    """


@dataclass(frozen=True)
class SteppedEvents(EventMotion, SteppedFall):
    """The same under gravity by steps.

    >>> motion = SteppedEvents([[(0.0, 0.0, 8.0, 1.0, 0.0)]], gravity=(0.0, -4.0), dt=0.5, ahead=1.0, left=[(1.0, [1])])
    >>> motion.after(0)
    [(1.0, 5.0, 1.0, -4.0)]
    """


class StepFall(NamedTuple):
    """How an engine of steps falls: see `SteppedFall`."""

    ahead: float
    early: float


FALLS_FEWEST = 3
"""Flights by which the way in which an engine falls is known."""


def step_fall(
    knots: Sequence[Sequence[DoubleKnot]], gravity: tuple[float, float], step: float, pegs: Collection[int],
    room: float, restitution: float = 1.0,
) -> StepFall | None:  # fmt: skip
    """How an engine of steps falls, by the states that it reports; None where they do not agree.

    Where a velocity has changed by gravity alone, the place tells by how much of g dt each step has moved the circle.
    A bounce on what stands tells whether the restitution is of the speed before the last g dt, or after it; where none
    does, an engine that moves first is taken for pymunk's like.

    Args:
        room: by how much a place may be off.
        restitution: of the scene.

    >>> fall = SteppedFall([[(0.0, 0.0, 8.0, 1.0, 0.0)]], gravity=(0.0, -4.0), dt=0.5, ahead=1.0)
    >>> told = [(t, *fall.state(t)[0]) for t in (0.0, 0.5, 1.0, 1.5)]
    >>> step_fall([told], (0.0, -4.0), 0.5, (), 1e-12)
    StepFall(ahead=1.0, early=0.0)
    """
    (gx, gy), found = gravity, list[tuple[float, float]]()
    bounces = [0, 0]
    square = gx * gx + gy * gy
    for k, row in enumerate(knots):
        for (t, x, y, vx, vy), (after, x1, y1, ux, uy) in pairwise(row if k not in pegs else ()):
            span = after - t
            size = max(1.0, math.hypot(vx, vy), math.hypot(ux, uy))
            jump = math.hypot(jx := ux - vx - gx * span, jy := uy - vy - gy * span)
            if span > 0.0 and jump > 2**10 * room * size:  # along the line of centres
                left, came = (ux * jx + uy * jy) / jump, ((ux - jx) * jx + (uy - jy) * jy) / jump
                for early in (0, 1):
                    off = left + restitution * (came - early * (gx * jx + gy * jy) / jump * step)
                    bounces[early] += abs(off) <= 2**5 * room * size
            if span <= 0.0 or jump > room * size:
                continue
            dx, dy = x1 - x - (vx + ux) * span / 2, y1 - y - (vy + uy) * span / 2
            unit = square * step * span
            found.append((0.5 + (dx * gx + dy * gy) / unit, 2 * room * size * math.sqrt(square) / unit))
    if len(found) < FALLS_FEWEST:
        return None
    ahead = sorted(value for value, _ in found)[len(found) // 2]
    if not -NEAR_AHEAD <= ahead <= 1.0 + NEAR_AHEAD:
        return None
    if sum(abs(value - ahead) <= NEAR_AHEAD + loose for value, loose in found) < len(found) * 0.9:
        return None
    ahead = round(2 * ahead) / 2 if abs(2 * ahead - round(2 * ahead)) <= 2 * NEAR_AHEAD else ahead
    early = ahead == 0.0 if bounces[0] == bounces[1] else bounces[1] > bounces[0]
    return StepFall(ahead, float(early))


NEAR_AHEAD = 2.0**-12
"""How near two flights have to agree on the way in which an engine falls."""


def _time(knot: DoubleKnot) -> float:
    return knot[0]
