"""The deviations of bodies from their midpoints, step by step, and through a contact that stands alone."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import frexp, inf, ldexp
from typing import TypeAlias

from flint import arb

from ..compiled import steps
from ..laws.formulas import speed_change, wall_approach
from ..numbers import ball
from .ball_state import BallState, Told
from .contact import (
    FAINT,
    AtWall,
    Body,
    Doubles,
    Flight,
    Gravity,
    Link,
    Midpoints,
    Pair,
    Round,
    is_flat,
    new_flight,
)
from .error_bounds import (
    LEAST_TURN,
    MOST,
    SMALL_WAIT,
    UP,
    Collision,
    Face,
    Mirror,
    Slope,
    Spent,
    counted_radius,
    fall_derivative,
    pair_derivative,
    scaled,
    unit_of_time,
    waited,
    wall_steepness,
)
from .landings import Met, Window
from .round_falls import RoundFall

# -- The deviations of bodies from their midpoints: what `ErrorSet` counts in doubles, in the bodies' own numbers.

LEAST_WEIGHT, LEAST_REACH = 1e-100, 1e-75
"""Bounds the squares of radii over masses, and the radii, of which doubles hold well all that is made of them."""

ENOUGH = 2**40
"""More bits than any number has."""

FEW_BITS = 64
"""A number of which fewer bits are known is near 0, where its radius is told by itself: on a level wall, say."""

FIXED = -1
"""The place in the set of what has no deviations."""

Numbers: TypeAlias = tuple[arb, arb, arb, arb]

Moved: TypeAlias = tuple[Body[arb], arb, arb, arb, arb]
"""A body, and its new (x, y, vx, vy)."""

FINE = 5
"""Of a power of two, the bits that are told apart within a coarse one."""

POWERS = tuple(arb(1 << k) for k in range(1 << FINE))


class Deviations:
    """The midpoints of some bodies, and the set of what the truth is away from them.

    Args:
        members: the bodies; their balls are the first set.
        circles: all circles by index, fixed ones too.
        falling: half of gravity, where bodies are in the frame that falls.

    Attributes:
        errors: the set.
        mid: the midpoints of each body, by index.
        carried: those that have been carried through a step.
        place: where each body stands in it, by index.
        unit: of time, in which the set counts velocities; 2**time_power.
        near_time: the most that a clock may be off its instant.
        weights: the inverse mass of every circle, by index.
        slopes: the walls that fall or move, in doubles, as far as they were met.
    """

    def __init__(
        self, members: Sequence[Body[arb]], circles: Sequence[Body[arb]], falling: Gravity[arb] | None = None
    ) -> None:
        from .error_set import ErrorSet, growth_in_a_block  # here, since it loads numpy, which short runs do without

        self.time_power = unit_of_time(members, falling)
        self.unit = 2.0**self.time_power
        self.near_time = SMALL_WAIT / 2 * self.unit
        self.weights = [ball.as_double(body.w) for body in circles]
        self.mid = {body.index: midpoints(body.flight) for body in members}
        self.carried: set[int] = set()
        self.place = {body.index: k for k, body in enumerate(members)}
        radii = [[number.rad().man_exp() for number in numbers_of(body)] for body in members]
        shift = max((int(e) + 30 for four in radii for m, e in four if m != 0), default=-ball.bits_in_use())
        powers = (0, 0, self.time_power, self.time_power)
        boxes = [[scaled(int(m), int(e) + p, shift) for (m, e), p in zip(four, powers, strict=True)] for four in radii]
        self.errors = ErrorSet(boxes, shift, self.unit, growth_in_a_block(len(members), falling is not None))
        self._balls: dict[int, arb] = {}
        self._strengths: dict[Round, float] = {}
        self._faces: dict[AtWall, Face] = {}
        self.slopes: dict[AtWall, Slope] = {}

    def holds(self, bodies: Iterable[int]) -> bool:
        """Whether all of these bodies are members."""
        return all(i in self.place for i in bodies)

    # -- the bodies' numbers

    def centre(self, body: Body[arb], numbers: Numbers | None = None) -> None:
        """Gives a body its midpoints, or other numbers made of midpoints alone."""
        set_numbers(body, numbers or self.mid[body.index][:4])

    def show(self, body: Body[arb]) -> None:
        """Gives a body its balls: its midpoints, and its bound; none for a velocity of exactly zero."""
        wide, narrow = self.balls_of(self.place[body.index])
        x, y, vx, vy, *_ = self.mid[body.index]
        if body.flight.rest:
            _, _, vx, vy, *_ = body.flight
        else:
            vx, vy = vx + narrow, vy + narrow
        set_numbers(body, (x + wide, y + wide, vx, vy))

    def show_place(self, body: Body[arb], before: Flight[arb]) -> None:
        """Gives a body that has been advanced its place as a ball, and the velocity that it had as one."""
        wide, _ = self.balls_of(self.place[body.index])
        set_numbers(body, (body.flight.x + wide, body.flight.y + wide, before.vx, before.vy))

    def balls_of(self, i: int) -> tuple[arb, arb]:
        """All deviations of the place, and of the velocity, of the body that stands at i in the set.

        Raises:
            Spent: if they are beyond doubles.
        """
        errors = self.errors
        bounds, power = errors.bounds, errors.power_of
        return self.ball(power(bounds.place[i])), self.ball(power(bounds.pace[i]) - self.time_power)

    def ball(self, power: int) -> arb:
        """All numbers of at most 2**power."""
        coarse, fine = power >> FINE, power & ((1 << FINE) - 1)
        found = self._balls.get(coarse)
        if found is None:
            found = self._balls[coarse] = arb(0, arb((1, coarse << FINE)))
        return found * POWERS[fine]  # a product costs far less than a ball made afresh

    # -- steps

    def advance(
        self,
        lags: Iterable[tuple[int, float]],
        state: BallState,
        link: Link,
        told: Told,
        root: arb | None,
        fallen: RoundFall[arb] | None = None,
    ) -> tuple[arb, arb, Collision | None] | None:
        """Carries flights to a contact; gives all errors of the instant, all of d at it, and the derivative.

        None where the truth may be too far from the midpoints for a derivative in doubles: then all is to be given up.

        Args:
            lags: the bodies that have flown, and how long.
            state: the state, advanced by midpoints.
            link: the contact.
            told, root: d at the hit of two circles and -d.v, as `BallState` has them.
            fallen: the two at the hit, where one falls onto the other.
        """
        if not waited(state.late) < self.near_time:
            return None
        try:
            for i, lag in lags:
                self.errors.fly(self.place[i], ldexp(lag, -self.time_power))
                self.errors.power_of(self.errors.bounds.place[self.place[i]])
            if is_flat(link):
                return self._to_wall(state, link)
            return None if told is None or root is None else self._to_pair(state, *told, root, fallen)
        except (Spent, OverflowError):
            return None

    def _to_wall(self, state: BallState, link: AtWall) -> tuple[arb, arb, Collision | None] | None:
        if state.falling is not None:
            speed = state.wall_discriminant(link)
            found = to_fall(
                self, slope_of(self, state, link), self.place[link.circle], 0.0, speed.sqrt(), waited(state.late)
            )
            return found and (self.ball(self.errors.power_of(found[1])), ball.ZERO, found[0])
        flight, i = state.bodies[link.circle].flight, self.place[link.circle]
        vx, vy = float(flight.vx), float(flight.vy)
        spread = self.wall_time(self.face(state, link), i, 0.0, vx, vy, waited(state.late))
        return None if spread is None else (self.ball(self.errors.power_of(spread)), ball.ZERO, None)

    def wall_time(self, face: Face, i: int, lag: float, vx: float, vy: float, late: float) -> float | None:
        """A bound of all errors of the instant of a wall's hit, as the set counts; None where it is too flat.

        Args:
            face: the wall.
            i: where the circle stands in the set.
            lag: how long it flies to it, in the set's unit of time, from where the set has it.
            vx, vy: its velocity.
            late: a bound of the time from the clock to the hit, from midpoints.
        """
        bounds = self.errors.bounds
        spread = (bounds.place[i] + (abs(lag) + SMALL_WAIT) * bounds.pace[i]) * UP
        spread *= wall_steepness(face.nx, face.ny, vx, vy) * UP
        return spread if spread < self.errors.near * self.unit and late < self.near_time else None

    def _to_pair(
        self, state: BallState, link: Round, dx: arb, dy: arb, root: arb, fallen: RoundFall[arb] | None
    ) -> tuple[arb, arb, Collision] | None:
        i, j = self.places(link)
        a, b = (body.flight for body in link.ends(state))
        met = (dx, dy, b.vx - a.vx, b.vy - a.vy, root) if fallen is None else (*fallen[:4], root)
        found = self.collision(state, link, met, i, j, (0.0, 0.0), waited(state.late), fallen)
        if found is None:
            return None
        hit, time = found
        power = self.errors.power_of
        return self.ball(power(time)), self.ball(power(hit.apart)), hit

    def collision(
        self,
        state: BallState,
        link: Round,
        met: tuple[arb, arb, arb, arb, arb],
        i: int,
        j: int,
        lags: tuple[float, float],
        late: float,
        fallen: RoundFall[arb] | None = None,
    ) -> tuple[Collision, float] | None:
        """The derivative of the collision of two circles, and a bound of all errors of its instant, as the set counts.

        None where the truth may be too far from the midpoints.

        Args:
            state: whose circles they are.
            link: the two.
            met: d, v and -d.v at the hit, from midpoints.
            i, j: where they stand in the set.
            lags: how long they fly to it, in the set's unit of time, from where the set has them.
            late: a bound of the time from the clock to the hit, from midpoints.
            fallen: the two at the hit, where one falls onto the other.
        """
        dx, dy, vx, vy, speed = met
        pull = () if fallen is None else (-2.0 * ball.as_double(fallen.hx), -2.0 * ball.as_double(fallen.hy))
        near, strength = self.errors.near, self.strength(state, link)
        places, paces, unit = self.errors.bounds.place, self.errors.bounds.pace, self.unit
        pace_i, pace_j = paces[i], paces[j]
        pace = (pace_i + pace_j) * UP
        place = (places[i] + abs(lags[0]) * pace_i + places[j] + abs(lags[1]) * pace_j + SMALL_WAIT * pace) * UP
        found = pair_derivative(
            float(dx), float(dy), float(vx), float(vy), float(speed), strength, unit, place, pace, near, *pull
        )
        return at_once(self, found, place, late)

    def places(self, link: Link) -> tuple[int, int]:
        """Where the two of a contact stand in the set: -1 for a circle that is fixed, an arc and a wall."""
        first, *rest = (self.place.get(k, FIXED) for k in link.circles)
        return first, rest[0] if rest else FIXED

    def strength(self, state: BallState, link: Round) -> float:
        """-(1 + e) / (R^2 (wa + wb)) of two circles, or 0 where a double does not hold it well."""
        if (found := self._strengths.get(link)) is None:
            reach = abs(ball.as_double(state.reach(*link.ends(state))))
            weight = reach * reach * sum(weights_of(self, link))
            share = 1.0 if state.share is None else ball.as_double(state.share)
            known = LEAST_WEIGHT < weight < 1.0 / LEAST_WEIGHT and LEAST_REACH < reach < 1.0 / LEAST_REACH
            found = self._strengths[link] = -speed_change(1.0) * share / weight if known else 0.0
        return found

    def face(self, state: BallState, link: AtWall) -> Face:
        """A wall in doubles, as a circle comes to it; one whose normal they do not tell is never steep enough."""
        found = self._faces.get(link)
        if found is None:
            line, parts = state.line(link.circle, link.wall), state.mirror_of(link)
            off = 2.0 * (max(float(part.rad()) for part in parts) + 2.0**-52) * UP
            xx, xy, yy = map(float, parts)
            found = self._faces[link] = Face(ball.as_double(line.nx), ball.as_double(line.ny), Mirror(xx, xy, yy, off))
        return found

    def mirror(self, face: Face, body: Body[arb]) -> bool:
        """A wall has mirrored a body; whether that could be carried."""
        rounding, _ = self.recentre([(body, *numbers_of(body))], body.flight.t, body.flight.last)
        self.errors.fly(self.place[body.index], 0.0, face.mirror, rounding)
        return self.bounded((body,))

    def meet(self, link: Link, movers: Sequence[Body[arb]], hit: Collision) -> bool:
        """Two circles have collided, or one and an arc or a wall that falls; whether that could be carried."""
        (i, j), weights = self.places(link), weights_of(self, link)
        moved = [(body, *numbers_of(body)) for body in movers]
        rounding, _ = self.recentre(moved, movers[0].flight.t, movers[0].flight.last)
        self.errors.meet(i, j, (0.0, 0.0), weights, hit, rounding)
        return self.bounded(movers)

    def land(self, body: Body[arb], numbers: Numbers) -> bool:
        """A body has flown on, and no impulse came; whether that could be carried."""
        set_numbers(body, numbers)
        rounding, _ = self.recentre([(body, *numbers_of(body))], body.flight.t, body.flight.last)
        self.errors.fly(self.place[body.index], 0.0, rounding=rounding)
        if not self.bounded((body,)):
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

    def bounded(self, bodies: Iterable[Body[arb]]) -> bool:
        """Whether doubles still hold the bounds of bodies."""
        return all(self.errors.bounds.both(self.place[body.index]) < MOST for body in bodies)

    def recentre(
        self, moved: Sequence[Moved], clock: arb, last: int
    ) -> tuple[float, list[tuple[float, float, float, float]]]:
        """Takes bodies' midpoints from their numbers; gives a bound of what that drops, as the set counts it, and the
        midpoints in doubles.

        A radius is below 2**(2 - accuracy) of its number, and is taken itself where that tells little. Infinite where
        doubles do not tell it.

        Args:
            moved: the bodies and their numbers.
            clock, last: of their flights.
        """
        size, bits, beside, unit, mid = 0.0, ENOUGH, 0.0, self.unit, self.mid
        doubles: list[tuple[float, float, float, float]] = []
        for body, x, y, vx, vy in moved:
            mid[body.index] = x.mid(), y.mid(), vx.mid(), vy.mid(), clock, last
            fx, fy, fvx, fvy = float(x), float(y), float(vx), float(vy)
            doubles.append((fx, fy, fvx, fvy))
            size += abs(fx) + abs(fy) + unit * (abs(fvx) + abs(fvy))
            for number, scale in ((x, 1.0), (y, 1.0), (vx, unit), (vy, unit)):
                known = number.rel_accuracy_bits()
                if known < FEW_BITS:
                    beside += counted_radius(number, self.errors.shift) * scale
                elif known < bits:
                    bits = known
            self.carried.add(body.index)
        power = 2 - bits - self.errors.shift
        rounding = ldexp(size * UP, max(power, -900)) if power < 500 and size < 2.0**500 else inf
        return (rounding + beside) * UP if beside else rounding, doubles


def slope_of(held: Deviations, state: BallState, link: AtWall) -> Slope:
    """A wall that falls or moves, in doubles, as a circle comes to it; not a number where they do not tell it."""
    found = held.slopes.get(link)
    if found is None:
        line, falling = state.line(link.circle, link.wall), state.falling
        assert falling is not None
        nx, ny, change = ball.as_double(line.nx), ball.as_double(line.ny), speed_change(state.one)
        strength, pull = ball.as_double(-state.damping(change) / line.nn), 0.0
        if state.pull(link):
            pull = ball.as_double(speed_change(wall_approach(falling.hx, falling.hy, line.nx, line.ny)))
        for number in (strength, pull):
            if number and not LEAST_WEIGHT < abs(number) < 1.0 / LEAST_WEIGHT:
                strength = 0.0
        found = held.slopes[link] = Slope(nx, ny, strength, pull)
    return found


def to_fall(
    held: Deviations, slope: Slope, i: int, lag: float, speed: arb, late: float
) -> tuple[Collision, float] | None:
    """As `Deviations.collision`, of a circle and a wall that falls or moves.

    Args:
        held: the deviations.
        slope: the wall.
        i, lag, late: as `wall_time` has them.
        speed: -n.v at the hit, relative to the wall, from midpoints.
    """
    bounds = held.errors.bounds
    pace = bounds.pace[i]
    place = (bounds.place[i] + (abs(lag) + SMALL_WAIT) * pace) * UP
    found = fall_derivative(
        slope.nx,
        slope.ny,
        ball.as_double(speed),
        slope.strength,
        slope.pull,
        held.unit,
        place,
        pace,
        held.errors.near,
    )
    return at_once(held, found, place, late)


def at_once(held: Deviations, found: Collision | None, place: float, late: float) -> tuple[Collision, float] | None:
    """A derivative, and a bound of all errors of the instant, where that is so near the clock, wherever it may
    truly be, that nothing turns until then.

    Args:
        held: the deviations.
        found: the derivative.
        place: a bound of the deviation of d, as the set counts.
        late: see `Deviations.collision`.
    """
    if found is None:
        return None
    spread, turn = found.steep * place * UP, max(found.turn, LEAST_TURN)
    near, far = held.errors.near * LEAST_TURN * 2.0 * held.unit, LEAST_TURN * held.near_time
    return (found, spread) if spread * turn < near and late * turn < far else None


def weights_of(held: Deviations, link: Link) -> tuple[float, float]:
    """The inverse masses of the two of a contact, 0 for an arc; at a wall, which no mass enters, 1 and 0."""
    if is_flat(link):
        return 1.0, 0.0
    first, *rest = (held.weights[k] for k in link.circles)
    return first, rest[0] if rest else 0.0


def numbers_of(body: Body[arb]) -> Numbers:
    """(x, y, vx, vy) of a body."""
    return body.flight[:4]


def set_numbers(body: Body[arb], numbers: Numbers) -> None:
    """Gives a body a place and a velocity; all else of its flight stays."""
    body.flight = new_flight(Flight, (*numbers, *body.flight[4:]))


def is_finite(body: Body[arb]) -> bool:
    """Whether no number of a body has an infinite radius."""
    return all(number.is_finite() for number in numbers_of(body))


def midpoints(flight: Flight[arb]) -> Midpoints[arb]:
    """The numbers of a flight without their radii, its clock, and as of which step it is."""
    return flight.x.mid(), flight.y.mid(), flight.vx.mid(), flight.vy.mid(), flight.t, flight.last


# -- The deviations of midpoints, carried through a contact that stands alone; compiled, where there was a compiler.
#
# What comes out is the same: a power of two that bounds all errors of the instant, what is beside the clock, and for
# each body a `Landing`. None, with nothing changed, where the truth may be too far from the midpoints for a
# derivative.

PLAIN = 2.0**-100
"""Numbers beyond this, with a radius of at most 2**FAINT, less than 2**-140 of them, are told by the doubles of their
midpoints, and by short balls around these."""

Landing: TypeAlias = tuple[Midpoints[arb], int, int, Doubles | None]
"""Of one body: its new midpoints, powers of two that bound how far its place and its velocity are off, and its doubles;
None where they do not tell it."""

Carried: TypeAlias = tuple[int, float, tuple[Landing, ...]]
"""Of a contact: a power of two that bounds all errors of the instant, a bound of the time between that and the clock,
and what becomes of each body."""


def carry_pair(
    held: Deviations,
    state: BallState,
    link: Pair,
    met: tuple[arb, arb, arb, arb, arb],
    since: tuple[arb, arb],
    late: arb,
    moved: tuple[Moved, Moved],
    clock: arb,
    last: int,
) -> Carried | None:
    """Through a collision of two circles.

    Args:
        held: the deviations.
        state: whose circles they are.
        link: the two.
        met: d, v and -d.v at the hit.
        since: how long each has flown to the clock.
        late: the time from the clock to the hit.
        moved: the two, with numbers around their new midpoints.
        clock, last: of their new flights.

    Raises:
        Spent: if the deviations are too large after it: the set is not to be used any more.
    """
    i, j = held.place[link[0]], held.place[link[1]]
    weights = held.weights[link[0]], held.weights[link[1]]
    if steps is not None:
        (_, *a), (_, *b) = moved
        strength, near, least = held.strength(state, link), held.near_time, held.time_power
        told = steps.bounce(
            held.errors, i, j, met, *since, strength, weights, late, near, tuple(a), tuple(b), clock, last, least
        )
        if told is False:
            raise Spent
        return told
    beside, unit = float(late.abs_upper()) * UP, held.unit
    lags = float(since[0]) / unit, float(since[1]) / unit
    found = held.collision(state, link, met, i, j, lags, beside)
    if found is None or not _well_known(moved):
        return None
    hit, spread = found
    rounding, doubles = held.recentre(moved, clock, last)
    held.errors.meet(i, j, lags, weights, hit, rounding)
    return _landed(held, moved, doubles, spread, beside, clock)


def carry_wall(
    held: Deviations,
    link: AtWall,
    face: Face,
    since: arb,
    velocity: tuple[arb, arb],
    late: arb,
    moved: Moved,
    clock: arb,
    last: int,
) -> Carried | None:
    """Through the impact of a circle on a wall.

    Args:
        held: the deviations.
        link: the two.
        face: the wall, as the circle comes to it.
        since: how long it has flown to the clock.
        velocity: with which it came.
        late: the time from the clock to the hit.
        moved: the circle, with numbers around its new midpoints.
        clock, last: of its new flight.

    Raises:
        Spent: as `carry_pair`.
    """
    i = held.place[link[0]]
    if steps is not None:
        _, *a = moved
        near, least = held.near_time, held.time_power
        told = steps.rebound(held.errors, i, since, velocity, face, late, near, tuple(a), clock, last, least)
        if told is False:
            raise Spent
        return told
    beside, lag = float(late.abs_upper()) * UP, float(since) / held.unit
    spread = held.wall_time(face, i, lag, float(velocity[0]), float(velocity[1]), beside)
    if spread is None or not _well_known((moved,)):
        return None
    rounding, doubles = held.recentre((moved,), clock, last)
    held.errors.fly(i, lag, face.mirror, rounding)
    return _landed(held, (moved,), doubles, spread, beside, clock)


def carry_fall(
    held: Deviations,
    link: AtWall,
    slope: Slope,
    since: arb,
    speed: arb,
    late: arb,
    moved: Moved,
    clock: arb,
    last: int,
) -> Carried | None:
    """Through the impact of a circle on a wall that falls or moves.

    Args:
        held: the deviations.
        link: the two.
        slope: the wall, as the circle comes to it.
        since: how long it has flown to the clock.
        speed: -n.v at the hit, relative to the wall.
        late, moved, clock, last: as `carry_wall` has them.

    Raises:
        Spent: as `carry_pair`.
    """
    i = held.place[link[0]]
    if steps is not None:
        _, *a = moved
        near, least, meets = held.near_time, held.time_power, ball.as_double(speed)
        told = steps.fall(held.errors, i, since, meets, slope, late, near, tuple(a), clock, last, least)
        if told is False:
            raise Spent
        return told
    beside, lag = float(late.abs_upper()) * UP, float(since) / held.unit
    found = to_fall(held, slope, i, lag, speed, beside)
    return None if found is None else _turned(held, 1.0, lag, found, beside, moved, clock, last)


def carry_round(
    held: Deviations,
    state: BallState,
    link: Round,
    met: Met,
    window: Window,
    since: arb,
    late: arb,
    moved: Moved,
    clock: arb,
    last: int,
) -> Carried | None:
    """Through the impact of a circle that falls on something round that stands.

    Args:
        held: the deviations.
        state: whose they are.
        link: the two.
        met: the time from the circle's clock to the hit, and the two then.
        window: where that is.
        since, late, moved, clock, last: as `carry_wall` has them.

    Raises:
        Spent: as `carry_pair`.
    """
    (wait, there), (body, *_) = met, moved
    beside, lag, i = float(late.abs_upper()) * UP, float(since) / held.unit, held.place[body.index]
    found = held.collision(state, link, (*there[:4], -there.approach()), i, FIXED, (lag, 0.0), beside, there)
    if found is None or not window.falls(window.wait.union(wait + held.ball(held.errors.power_of(found[1])))):
        return None
    return _turned(held, held.weights[body.index], lag, found, beside, moved, clock, last)


def _turned(
    held: Deviations,
    weight: float,
    lag: float,
    found: tuple[Collision, float],
    beside: float,
    moved: Moved,
    clock: arb,
    last: int,
) -> Carried | None:
    """What becomes of a circle and what takes no impulse, of that derivative."""
    if not _well_known((moved,)):
        return None
    hit, spread = found
    i = held.place[moved[0].index]
    rounding, doubles = held.recentre((moved,), clock, last)
    held.errors.meet(i, FIXED, (lag, 0.0), (weight, 0.0), hit, rounding)
    return _landed(held, (moved,), doubles, spread, beside, clock)


def _well_known(moved: Sequence[Moved]) -> bool:
    """Whether no number is near 0, where its bits do not tell its radius: the two steps take that (`FEW_BITS`)."""
    return all(number.rel_accuracy_bits() >= FEW_BITS for _, *numbers in moved for number in numbers)


def _landed(
    held: Deviations,
    moved: tuple[Moved, ...],
    doubles: list[tuple[float, float, float, float]],
    spread: float,
    beside: float,
    clock: arb,
) -> Carried:
    """What becomes of a contact that has been carried.

    Args:
        held: the deviations.
        moved: the bodies.
        doubles: their midpoints.
        spread: a bound of all errors of the instant, as the set counts it.
        beside: of the time from the clock to it.
        clock: of their new flights.
    """
    now = float(clock)
    bounds, shift, place = held.errors.bounds, held.errors.shift, held.place
    if not spread + bounds.both(place[moved[0][0].index]) + bounds.both(place[moved[-1][0].index]) < MOST:
        raise Spent
    power = frexp(spread)[1] + shift
    beside = (beside + ldexp(1.0, power if power > -1000 else -1000)) * UP
    landed: list[Landing] = []
    for (body, *_), (fx, fy, fvx, fvy) in zip(moved, doubles, strict=True):
        i = place[body.index]
        far, fast = frexp(bounds.place[i])[1] + shift, frexp(bounds.pace[i])[1] + shift - held.time_power
        told = (
            far < FAINT
            and fast < FAINT
            and (fx > PLAIN or fx < -PLAIN)
            and (fy > PLAIN or fy < -PLAIN)
            and (fvx > PLAIN or fvx < -PLAIN)
            and (fvy > PLAIN or fvy < -PLAIN)
        )
        landed.append((held.mid[body.index], far, fast, (fx, fy, fvx, fvy, now, beside) if told else None))
    return power, beside, tuple(landed)
