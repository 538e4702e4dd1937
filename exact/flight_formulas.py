"""Where a circle is at a time, and how fast, as formulas; also amid infinitely many bounces on a wall, ever lower."""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter
from collections.abc import Callable, Sequence
from operator import itemgetter
from typing import Protocol

from flint import arb

from ..scenarios.lazy import frozen
from ..scenarios.numbers.quantity import ZERO, Quantity
from ..scenarios.scene import Scene
from .laws.formulas import advance, fall_speed, sag
from .numbers import ball
from .numbers.ball import Known, known_ball
from .numbers.system import N
from .replay.state import ReplayState, Settle, Step, Velocity
from .simulation.decider import Formula, Knot


class Enclosable(Protocol):
    """A number that is enclosed to so many bits."""

    def ball(self, bits: int) -> arb: ...


class HasFormula(Protocol):
    """A time of a run, with the formula that computes it."""

    @property
    def formula(self) -> Formula: ...


@frozen
class OtherRun:
    """A place at a time of another run, which this run's log does not compute: what is at hand of it is told alone."""

    def __call__(self, state: ReplayState[N]) -> N:
        raise ValueError("the time is one of another run; ask for the place at its digits, such as at(time.digits(40))")


@frozen
class Place:
    """Computes a coordinate of a circle at a time, from the state after its last change of velocity before it."""

    body: int
    axis: int
    time: HasFormula | Quantity

    def __call__(self, state: ReplayState[N]) -> N:
        flight, bend = state.bodies[self.body].flight, state.bend(self.body)
        place, speed = (flight.x, flight.vx) if self.axis == 0 else (flight.y, flight.vy)
        if flight.rest and bend is None:
            return place
        when = _moment(self.time, state)
        if bend is None:
            return advance(place, speed, when - flight.t)
        if bend.bent:
            return sag(place, speed, bend.half(self.axis), when - flight.t)
        return advance(place, speed, when - flight.t) + sag(state.zero, state.zero, bend.half(self.axis), when)


def _moment(time: HasFormula | Quantity, state: ReplayState[N]) -> N:
    return state.constant(time) if isinstance(time, Quantity) else time.formula(state)


@frozen
class FallSpeed:
    """Computes a component of a circle's velocity at a time under gravity: v = V + g t, where the frame has V."""

    body: int
    axis: int
    time: HasFormula | Quantity

    def __call__(self, state: ReplayState[N]) -> N:
        speed, bend = Velocity(self.body, self.axis)(state), state.bend(self.body)
        if bend is None:
            return speed
        when = _moment(self.time, state)
        return fall_speed(speed, bend.half(self.axis), when - state.bodies[self.body].flight.t if bend.bent else when)


@frozen
class Bounced:
    """Computes a coordinate of a circle, or a component of its velocity, while it bounces on a wall infinitely often.

    After the bounce with number n, from 0, that is (2 v / |n.g|) (1 - e^n) / (1 - e) after the first, with the normal
    speed v after that, it leaves with v e^n.

    Attributes:
        body: the circle.
        along: the same as if a wall carried it.
        axis: 0 for x, 1 for y.
        speed: whether the velocity is asked for.
        time: the time.
        nth: of how many such ends of bounces of the circle this one is, from 0.
        number: of the bounce before it.
    """

    body: int
    along: Formula
    axis: int
    speed: bool
    time: HasFormula | Quantity
    nth: int
    number: int

    def __call__(self, state: ReplayState[N]) -> N:
        nx, ny, first, start = state.bounced[self.body][self.nth]
        e, half = state.scene.restitution, _half(nx, ny, state)
        up, gone = first * state.constant(e**self.number), state.constant((1 - e**self.number) / (1 - e))
        since = _moment(self.time, state) - start + first * gone / half
        across = up + (half + half) * since if self.speed else (up + half * since) * since
        return self.along(state) + (nx if self.axis == 0 else ny) * across / (nx * nx + ny * ny)


def _half(nx: N, ny: N, state: ReplayState[N]) -> N:
    """Half of the pull along a normal."""
    falls = state.falling
    assert falls is not None
    return nx * falls.hx + ny * falls.hy


@frozen
class BounceTime:
    """Computes when the bounce with a number is, of such bounces, or when all have happened (see `Bounced`).

    Attributes:
        body, nth: see `Bounced`.
        wall: on which they are; below 0 where they are between two.
        number: of the bounce; None for the end.
    """

    body: int
    wall: int
    nth: int
    number: int | None = None

    def __call__(self, state: ReplayState[N]) -> N:
        nx, ny, first, start = state.bounced[self.body][self.nth]
        e, number = state.scene.restitution, self.number
        gone = state.constant((1 if number is None else 1 - e**number) / (1 - e))
        return start - first * gone / _half(nx, ny, state)


def endless(
    steps: Sequence[Step], knots: Sequence[Sequence[Knot[Known]]]
) -> dict[tuple[int, int], tuple[int, BounceTime]]:
    """By circle and the place of the knot after them: what computes the end of such bounces, after how many steps.

    Args:
        steps: the log.
        knots: of each circle.
    """
    found: dict[tuple[int, int], tuple[int, BounceTime]] = {}
    counts = Counter[int]()
    for number, step in enumerate(steps, start=1):
        if isinstance(step, Settle) and step.bounces:
            place = bisect_left(knots[step.body], number, key=itemgetter(5))
            wall = step.wall if step.other < 0 else -1
            found[step.body, place] = number, BounceTime(step.body, wall, counts[step.body])
            counts[step.body] += 1
    return found


QUARTER = arb("0.25")


def bounce_before(
    start: Enclosable, end: Enclosable, time: Enclosable, e: Quantity, most: int, is_later: Callable[[int], bool]
) -> int:
    """The number of the last bounce that is not after a time, from 0 at their start.

    Args:
        start, end, time: of the bounces, and the time, before their end.
        e: the restitution.
        most: bits that are tried.
        is_later: whether the bounce with a number is after the time; asked where the bits do not tell it.

    >>> start, end, e = map(Quantity.of, (0, 2, "1/2"))
    >>> bounce_before(start, end, Quantity.of("8/5"), e, 1024, lambda number: False)
    2
    >>> bounce_before(start, end, Quantity.of("3/2"), e, 1024, lambda number: True)
    1
    """
    bits = 96
    while True:
        with ball.precision(bits + 64):
            last = end.ball(bits)
            left = (last - time.ball(bits)) / (last - start.ball(bits))
            passed = left.log() / ball.constant(e).log() if left > 0 else arb.nan()
            whole = passed.floor().unique_fmpz()
        if whole is not None:
            return max(int(whole), 0)
        if bits >= most and passed.rad() < QUARTER:  # so that no other whole number is in it
            nearest = round(float(passed.mid()))
            return max(nearest - is_later(nearest), 0)
        bits *= 2


def amid_bounces(
    row: Sequence[Known],
    scene: Scene,
    wall: int,
    start: Enclosable,
    end: Enclosable,
    time: Enclosable,
    number: int,
) -> tuple[arb, ...]:
    """Place and velocity of a circle that bounces so, in balls, from where it would be along the wall.

    Args:
        row: that: x, y, vx, vy.
        scene, wall: what runs, and on what the circle bounces; below 0 between two slopes.
        start, end, time: of the bounces, and the time.
        number: of the bounce before the time.
    """
    gravity = scene.gravity or (ZERO, ZERO)
    free = (ZERO, ZERO) if wall < 0 else scene.walls[wall].along(*gravity)
    with ball.precision(AMID_BITS):
        e, begun, last = ball.constant(scene.restitution), start.ball(AMID_BITS), end.ball(AMID_BITS)
        halves = [ball.constant(part - along) / 2 for part, along in zip(gravity, free, strict=True)]
        since = time.ball(AMID_BITS) - begun - (last - begun) * (1 - e**number)
        lag = (last - begun) * (1 - e) * e**number
        beside = *(h * since * (since - lag) for h in halves), *(h * (since + since - lag) for h in halves)
        return tuple(known_ball(along, AMID_BITS) + across for along, across in zip(row, beside, strict=True))


AMID_BITS = 1024
"""Precision at which places amid bounces are computed at a time of another run."""


def sunk(x: N, half: N, time: N) -> N:
    """The true coordinate, at a time, of what is at x in the falling frame."""
    return x + half * time * time
