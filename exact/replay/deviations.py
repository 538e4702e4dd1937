"""The deviations of bodies from their midpoints: what `ErrorSet` counts in doubles, in the bodies' own numbers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import inf, ldexp, log2
from typing import TypeAlias

from flint import arb

from ..numbers import ball
from . import errors as step
from .ball_state import BallState, Mirror, Told
from .body import Body, Flight
from .contact import AtWall, Link, Pair, Round
from .derivatives import CLOSE, SMALL_WAIT, pair_derivative, wall_steepness
from .errors import MOST, UP, Blocks, Spent, scaled

LEAST_WEIGHT = 1e-100
"""Bounds the squares of radii over masses that doubles hold well."""

MOST_UNIT = 300
"""The largest power of two that is taken for a unit of time."""

Numbers: TypeAlias = tuple[arb, arb, arb, arb]


class Deviations:
    """The midpoints of some bodies, and the set of what the truth is away from them.

    Args:
        members: the bodies; their balls are the first set.
        circles: all circles by index, fixed ones too.

    Attributes:
        errors: the set.
        place: where each body stands in it, by index.
    """

    def __init__(self, members: Sequence[Body[arb]], circles: Sequence[Body[arb]]) -> None:
        from .error_set import ErrorSet  # here, since it loads numpy, which short runs do without

        self._time_power = _unit_of_time(members)
        self._unit = 2.0**self._time_power
        self._weights = [float(body.w) for body in circles]
        self._mid = {body.index: _midpoints(numbers_of(body)) for body in members}
        self.place = {body.index: k for k, body in enumerate(members)}
        radii = [[number.rad().man_exp() for number in numbers_of(body)] for body in members]
        shift = max((int(e) + 30 for four in radii for m, e in four if m != 0), default=-ball.bits_in_use())
        powers = (0, 0, self._time_power, self._time_power)
        boxes = [[scaled(int(m), int(e) + p, shift) for (m, e), p in zip(four, powers, strict=True)] for four in radii]
        self.errors = ErrorSet(boxes, shift)
        self._balls: dict[int, arb] = {}
        self._strengths: dict[Round, float] = {}

    def holds(self, bodies: Iterable[int]) -> bool:
        """Whether all of these bodies are members."""
        return all(i in self.place for i in bodies)

    # -- the bodies' numbers

    def centre(self, body: Body[arb], numbers: Numbers | None = None) -> None:
        """Gives a body its midpoints, or other numbers made of midpoints alone."""
        set_numbers(body, numbers or self._mid[body.index])

    def show(self, body: Body[arb]) -> None:
        """Gives a body its balls: its midpoints, and its bound; none for a velocity of exactly zero."""
        power = self.errors.power(self.place[body.index])
        wide, narrow = self._ball(power), self._ball(power - self._time_power)
        x, y, vx, vy = self._mid[body.index]
        if body.flight.rest:
            _, _, vx, vy = numbers_of(body)
        else:
            vx, vy = vx + narrow, vy + narrow
        set_numbers(body, (x + wide, y + wide, vx, vy))

    def show_place(self, body: Body[arb], before: Flight[arb]) -> None:
        """Gives a body that has been advanced its place as a ball, and the velocity that it had as one."""
        wide = self._ball(self.errors.power(self.place[body.index]))
        set_numbers(body, (body.flight.x + wide, body.flight.y + wide, before.vx, before.vy))

    def _ball(self, power: int) -> arb:
        """All numbers of at most 2**power."""
        if power not in self._balls:
            self._balls[power] = arb(0, arb((1, power)))
        return self._balls[power]

    # -- steps

    def advance(
        self, lags: Iterable[tuple[int, float]], state: BallState, link: Link, told: Told, root: arb | None
    ) -> tuple[arb, arb, Blocks | None] | None:
        """Carries flights to a contact; gives all errors of the instant, all of d at it, and the derivative.

        None where the truth may be too far from the midpoints for a derivative in doubles: then all is to be given up.

        Args:
            lags: the bodies that have flown, and how long.
            state: the state, advanced by midpoints.
            link: the contact.
            told, root: d at the hit of two circles and -d.v, as `BallState` has them.
        """
        if state.late is None or not abs(float(state.late)) < SMALL_WAIT / 2 * self._unit:
            return None
        try:
            for i, lag in lags:
                self.errors.do(step.Fly(self.place[i], ldexp(lag, -self._time_power)))
            if isinstance(link, AtWall):
                return self._to_wall(state, link)
            return None if told is None or root is None else self._to_pair(state, *told, root)
        except (Spent, OverflowError):
            return None

    def _to_wall(self, state: BallState, link: AtWall) -> tuple[arb, arb, None] | None:
        flight, line = state.bodies[link.circle].flight, state.line(link.circle, link.wall)
        spread = self.errors.nu[self.place[link.circle]]
        steep = wall_steepness(float(line.nx), float(line.ny), float(flight.vx), float(flight.vy))
        if not steep * spread / self._unit < self.errors.doubles(CLOSE):
            return None
        return self._ball(self.errors.power_of(steep * spread * UP)), ball.ZERO, None

    def _to_pair(self, state: BallState, link: Round, dx: arb, dy: arb, root: arb) -> tuple[arb, arb, Blocks] | None:
        i, j = (body.index for body in link.ends(state))
        a, b = (body.flight for body in link.ends(state))
        spread = (self.errors.nu[self.place.get(i, -1)] + self.errors.nu[self.place.get(j, -1)]) * UP
        d, v = (float(dx), float(dy)), (float(b.vx - a.vx), float(b.vy - a.vy))
        near = self.errors.doubles(CLOSE)
        found = pair_derivative(d, v, float(root), self._strength(state, link), self._unit, spread, near)
        if found is None:
            return None
        steep, apart, blocks = found
        if not steep * spread < self.errors.doubles(SMALL_WAIT / 2 * self._unit):
            return None  # the hit, wherever it may truly be, is not so near the clock
        if not blocks.norm * spread * (1.0 + self._weights[i] + self._weights[j]) < MOST:
            return None
        power = self.errors.power_of
        return self._ball(power(steep * spread * UP)), self._ball(power(apart)), blocks

    def _strength(self, state: BallState, link: Round) -> float:
        """-2 / (R^2 (wa + wb)) of two circles, or 0 where a double does not hold it well."""
        if link not in self._strengths:
            a, b = link.ends(state)
            weight = float(state.reach(a, b)) ** 2 * (self._weights[a.index] + self._weights[b.index])
            self._strengths[link] = -2.0 / weight if LEAST_WEIGHT < weight < 1.0 / LEAST_WEIGHT else 0.0
        return self._strengths[link]

    def mirror(self, body: Body[arb], parts: Mirror) -> bool:
        """A wall has mirrored a body by the matrix (xx, xy; xy, yy); whether that could be carried."""
        xx, xy, yy = (float(part) for part in parts)
        off = 2.0 * (max(float(part.rad()) for part in parts) + 2.0**-52) * UP
        self.errors.do(step.Mirror(self.place[body.index], xx, xy, yy, off, self._recentre(body)))
        return self._bounded((body,))

    def meet(self, link: Pair, movers: Sequence[Body[arb]], blocks: Blocks) -> bool:
        """Two circles have collided; whether that could be carried."""
        rounded = {body.index: self._recentre(body) for body in movers}
        i, j = link
        places = [self.place[k] if k in rounded else -1 for k in link]
        weights = self._weights
        self.errors.do(
            step.Meet(places[0], places[1], weights[i], weights[j], blocks, rounded.get(i, 0.0), rounded.get(j, 0.0))
        )
        return self._bounded(movers)

    def land(self, body: Body[arb], numbers: Numbers) -> bool:
        """A body has flown on, and no impulse came; whether that could be carried."""
        self._mid[body.index] = _midpoints(numbers)
        self.errors.do(step.Round(self.place[body.index], self._largest(numbers)))
        if not self._bounded((body,)):
            return False
        self.show(body)
        return True

    def close(self) -> bool:
        """Ends a block of the set; whether it could be carried."""
        try:
            self.errors.close()
        except Spent:
            return False
        return True

    def _bounded(self, bodies: Iterable[Body[arb]]) -> bool:
        return all(self.errors.nu[self.place[body.index]] < MOST for body in bodies)

    def _recentre(self, body: Body[arb]) -> float:
        """Takes a body's midpoints from its numbers; gives what that drops, as the set counts it."""
        numbers = numbers_of(body)
        self._mid[body.index] = _midpoints(numbers)
        return self._largest(numbers)

    def _largest(self, numbers: Numbers) -> float:
        """A bound of all radii, as the set counts them: a radius is below 2**-accuracy of its number.

        Infinite where the bits were too few for a number, or for doubles to tell.
        """
        if not all(number.is_finite() for number in numbers):
            return inf
        x, y, vx, vy = numbers
        size = max(abs(float(x)), abs(float(y)), self._unit * abs(float(vx)), self._unit * abs(float(vy))) * UP
        bits = min(x.rel_accuracy_bits(), y.rel_accuracy_bits(), vx.rel_accuracy_bits(), vy.rel_accuracy_bits())
        power = 2 - bits - self.errors.shift
        return ldexp(size, max(power, -900)) if power < 500 and size < 2.0**500 else inf


def numbers_of(body: Body[arb]) -> Numbers:
    """(x, y, vx, vy) of a body."""
    return body.flight[:4]


def set_numbers(body: Body[arb], numbers: Numbers) -> None:
    """Gives a body a place and a velocity; all else of its flight stays."""
    _, _, _, _, t, instant, late, last, rest = body.flight
    body.flight = Flight(*numbers, t, instant, late, last, rest)


def is_finite(body: Body[arb]) -> bool:
    """Whether no number of a body has an infinite radius."""
    return all(number.is_finite() for number in numbers_of(body))


def _midpoints(numbers: Numbers) -> Numbers:
    x, y, vx, vy = numbers
    return x.mid(), y.mid(), vx.mid(), vy.mid()


def _unit_of_time(bodies: Sequence[Body[arb]]) -> int:
    """The power of two nearest to the time in which the fastest circle flies as far as the circles are wide."""
    speed = max(max(abs(float(body.flight.vx)), abs(float(body.flight.vy))) for body in bodies)
    width = sum(float(body.r) for body in bodies) / len(bodies)
    return max(-MOST_UNIT, min(MOST_UNIT, round(log2(width) - log2(speed)))) if width > 0.0 and speed > 0.0 else 0
