"""The deviations of bodies from their midpoints: what `ErrorSet` counts in doubles, in the bodies' own numbers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import inf, ldexp, log2
from typing import NamedTuple, TypeAlias

from flint import arb

from ..numbers import ball
from .ball_state import BallState, Told
from .body import Body, Flight, new_flight
from .contact import AtWall, Link, Pair, Round
from .derivatives import CLOSE, SMALL_WAIT, pair_derivative, wall_steepness
from .errors import MOST, UP, Collision, Leg, Spent, scaled

LEAST_WEIGHT, LEAST_REACH = 1e-100, 1e-75
"""Bounds the squares of radii over masses, and the radii, of which doubles hold well all that is made of them."""

ENOUGH = 2**40
"""More bits than any number has."""

MOST_UNIT = 300
"""The largest power of two that is taken for a unit of time."""

Numbers: TypeAlias = tuple[arb, arb, arb, arb]


class Face(NamedTuple):
    """A wall in doubles, to a circle: its normal, and the matrix that mirrors, which is known up to `off`."""

    nx: float
    ny: float
    xx: float
    xy: float
    yy: float
    off: float


class Deviations:
    """The midpoints of some bodies, and the set of what the truth is away from them.

    Args:
        members: the bodies; their balls are the first set.
        circles: all circles by index, fixed ones too.

    Attributes:
        errors: the set.
        place: where each body stands in it, by index.
        unit: of time, in which the set counts velocities.
        weights: the inverse mass of every circle, by index.
    """

    def __init__(self, members: Sequence[Body[arb]], circles: Sequence[Body[arb]]) -> None:
        from .error_set import ErrorSet  # here, since it loads numpy, which short runs do without

        self._time_power = _unit_of_time(members)
        self.unit = 2.0**self._time_power
        self._near_time = SMALL_WAIT / 2 * self.unit
        self.weights = [float(body.w) for body in circles]
        self._mid = {body.index: _midpoints(numbers_of(body)) for body in members}
        self.place = {body.index: k for k, body in enumerate(members)}
        radii = [[number.rad().man_exp() for number in numbers_of(body)] for body in members]
        shift = max((int(e) + 30 for four in radii for m, e in four if m != 0), default=-ball.bits_in_use())
        powers = (0, 0, self._time_power, self._time_power)
        boxes = [[scaled(int(m), int(e) + p, shift) for (m, e), p in zip(four, powers, strict=True)] for four in radii]
        self.errors = ErrorSet(boxes, shift, self.unit)
        self._balls: dict[int, arb] = {}
        self._strengths: dict[Round, float] = {}
        self._faces: dict[AtWall, Face] = {}

    def holds(self, bodies: Iterable[int]) -> bool:
        """Whether all of these bodies are members."""
        return all(i in self.place for i in bodies)

    # -- the bodies' numbers

    def centre(self, body: Body[arb], numbers: Numbers | None = None) -> None:
        """Gives a body its midpoints, or other numbers made of midpoints alone."""
        set_numbers(body, numbers or self._mid[body.index])

    def show(self, body: Body[arb], instant: arb | None = None, late: arb | None = None) -> None:
        """Gives a body its balls: its midpoints, and its bound; none for a velocity of exactly zero.

        Args:
            body: the body.
            instant, late: of a contact from which it flies, where these are not its flight's. Its velocity is a ball
                then, even if that of the midpoints is zero.
        """
        power = self.errors.power(self.place[body.index])
        wide, narrow = self.ball(power), self.ball(power - self._time_power)
        x, y, vx, vy = self._mid[body.index]
        _, _, old_vx, old_vy, t, old_instant, old_late, last, rest = body.flight
        if instant is None:
            instant, late = old_instant, old_late
        else:
            rest = False
        vx, vy = (old_vx, old_vy) if rest else (vx + narrow, vy + narrow)
        body.flight = new_flight(Flight, (x + wide, y + wide, vx, vy, t, instant, late, last, rest))

    def show_place(self, body: Body[arb], before: Flight[arb]) -> None:
        """Gives a body that has been advanced its place as a ball, and the velocity that it had as one."""
        wide = self.ball(self.errors.power(self.place[body.index]))
        set_numbers(body, (body.flight.x + wide, body.flight.y + wide, before.vx, before.vy))

    def ball(self, power: int) -> arb:
        """All numbers of at most 2**power."""
        if power not in self._balls:
            self._balls[power] = arb(0, arb((1, power)))
        return self._balls[power]

    # -- steps

    def advance(
        self, lags: Iterable[tuple[int, float]], state: BallState, link: Link, told: Told, root: arb | None
    ) -> tuple[arb, arb, Collision | None] | None:
        """Carries flights to a contact; gives all errors of the instant, all of d at it, and the derivative.

        None where the truth may be too far from the midpoints for a derivative in doubles: then all is to be given up.

        Args:
            lags: the bodies that have flown, and how long.
            state: the state, advanced by midpoints.
            link: the contact.
            told, root: d at the hit of two circles and -d.v, as `BallState` has them.
        """
        if not self.stands_near(state.late):
            return None
        try:
            for i, lag in lags:
                self.errors.fly(Leg(self.place[i], ldexp(lag, -self._time_power)))
                self.errors.power(self.place[i])
            if isinstance(link, AtWall):
                return self._to_wall(state, link)
            return None if told is None or root is None else self._to_pair(state, *told, root)
        except (Spent, OverflowError):
            return None

    def _to_wall(self, state: BallState, link: AtWall) -> tuple[arb, arb, None] | None:
        flight = state.bodies[link.circle].flight
        spread = self.errors.bounds.nu[self.place[link.circle]]
        time = self.wall_time(self.face(state, link), spread, float(flight.vx), float(flight.vy))
        return None if time is None else (time, ball.ZERO, None)

    def wall_time(self, face: Face, spread: float, vx: float, vy: float) -> arb | None:
        """All errors of the instant of a wall's hit, for deviations up to `spread` at it; None where it is too flat."""
        steep = wall_steepness(face.nx, face.ny, vx, vy)
        if not steep * spread / self.unit < self.errors.doubles(CLOSE):
            return None
        return self.ball(self.errors.power_of(steep * spread * UP))

    def _to_pair(self, state: BallState, link: Round, dx: arb, dy: arb, root: arb) -> tuple[arb, arb, Collision] | None:
        i, j = (body.index for body in link.ends(state))
        a, b = (body.flight for body in link.ends(state))
        nu = self.errors.bounds.nu
        spread = (nu[self.place.get(i, -1)] + nu[self.place.get(j, -1)]) * UP
        found = self.collision(state, link, (dx, dy, b.vx - a.vx, b.vy - a.vy, root), spread)
        if found is None:
            return None
        power = self.errors.power_of
        return self.ball(power(found.steep * spread * UP)), self.ball(power(found.apart)), found

    def collision(
        self, state: BallState, link: Round, met: tuple[arb, arb, arb, arb, arb], spread: float
    ) -> Collision | None:
        """The derivative of the collision of two circles; None where the truth may be too far from the midpoints.

        Args:
            state: whose circles they are.
            link: the two.
            met: d, v and -d.v at the hit, from midpoints.
            spread: a bound of the deviations of d.
        """
        dx, dy, vx, vy, speed = met
        near, strength = self.errors.doubles(CLOSE), self._strengths.get(link) or self._strength(state, link)
        found = pair_derivative(
            float(dx), float(dy), float(vx), float(vy), float(speed), strength, self.unit, spread, near
        )
        if found is None or not found.steep * spread < near * 2.0 * self.unit:
            return None  # the hit, wherever it may truly be, is not so near the clock
        weight = self.weights[link[0]] + self.weights[link[1]]
        return found if found.norm * spread * (1.0 + weight) < MOST else None

    def _strength(self, state: BallState, link: Round) -> float:
        """-2 / (R^2 (wa + wb)) of two circles, or 0 where a double does not hold it well."""
        if link not in self._strengths:
            a, b = link.ends(state)
            reach = float(state.reach(a, b))
            weight = reach * reach * (self.weights[a.index] + self.weights[b.index])
            known = LEAST_WEIGHT < weight < 1.0 / LEAST_WEIGHT and LEAST_REACH < reach < 1.0 / LEAST_REACH
            self._strengths[link] = -2.0 / weight if known else 0.0
        return self._strengths[link]

    def face(self, state: BallState, link: AtWall) -> Face:
        """A wall in doubles, as a circle comes to it."""
        found = self._faces.get(link)
        if found is None:
            line, parts = state.line(link.circle, link.wall), state.mirror_of(link)
            off = 2.0 * (max(float(part.rad()) for part in parts) + 2.0**-52) * UP
            xx, xy, yy = map(float, parts)
            found = self._faces[link] = Face(float(line.nx), float(line.ny), xx, xy, yy, off)
        return found

    def stands_near(self, late: arb | None) -> bool:
        """Whether a clock is so near its instant that the time between them is a mere perturbation."""
        return late is not None and abs(float(late)) < self._near_time

    def mirror(self, face: Face, body: Body[arb]) -> bool:
        """A wall has mirrored a body; whether that could be carried."""
        leg = Leg(self.place[body.index], 0.0, face.xx, face.xy, face.yy)
        self.errors.fly(leg, face.off, self.recentre((body,)))
        return self._bounded((body,))

    def meet(self, link: Pair, movers: Sequence[Body[arb]], hit: Collision) -> bool:
        """Two circles have collided; whether that could be carried."""
        i, j = (self.place.get(k, -1) for k in link)
        weights = self.weights[link.a], self.weights[link.b]
        self.errors.meet(i, j, (0.0, 0.0), weights, hit, self.recentre(movers))
        return self._bounded(movers)

    def land(self, body: Body[arb], numbers: Numbers) -> bool:
        """A body has flown on, and no impulse came; whether that could be carried."""
        set_numbers(body, numbers)
        self.errors.fly(Leg(self.place[body.index], 0.0), 0.0, self.recentre((body,)))
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
        return all(self.errors.bounds.nu[self.place[body.index]] < MOST for body in bodies)

    def recentre(self, bodies: Iterable[Body[arb]]) -> float:
        """Takes bodies' midpoints from their numbers; gives a bound of what that drops, as the set counts it.

        A radius is below 2**(2 - accuracy) of its number. Infinite where the bits were too few for a number, or for
        doubles to tell.
        """
        size, bits, unit = 0.0, ENOUGH, self.unit
        for body in bodies:
            x, y, vx, vy, *_ = body.flight
            self._mid[body.index] = x.mid(), y.mid(), vx.mid(), vy.mid()
            size += abs(float(x)) + abs(float(y)) + unit * (abs(float(vx)) + abs(float(vy)))
            bits = min(
                bits, x.rel_accuracy_bits(), y.rel_accuracy_bits(), vx.rel_accuracy_bits(), vy.rel_accuracy_bits()
            )
        power = 2 - bits - self.errors.shift
        return ldexp(size * UP, max(power, -900)) if power < 500 and size < 2.0**500 else inf


def numbers_of(body: Body[arb]) -> Numbers:
    """(x, y, vx, vy) of a body."""
    return body.flight[:4]


def set_numbers(body: Body[arb], numbers: Numbers) -> None:
    """Gives a body a place and a velocity; all else of its flight stays."""
    body.flight = new_flight(Flight, (*numbers, *body.flight[4:]))


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
    if not (0.0 < width < inf and 0.0 < speed < inf):
        return 0
    return max(-MOST_UNIT, min(MOST_UNIT, round(log2(width) - log2(speed))))
