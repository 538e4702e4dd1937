"""Free flights of circles and the bounces that end them, by the exact law: to a wall, to each other, in balls."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias, cast

from flint import arb, fmpq, fmpq_poly

from ...exact.laws import formulas as law
from ...exact.laws.formulas import (
    advance,
    damped,
    fall_speed,
    pair_approach,
    pair_discriminant,
    pair_gap,
    pair_hit_time,
    pair_impulse,
    pair_last_time,
    pair_strength,
    wall_approach,
    wall_bounce,
    wall_gap,
    wall_hit_time,
)
from ...exact.numbers import ball
from ...exact.replay.contact import is_arc, is_flat, is_pair
from ...exact.replay.round_falls import RoundFall, horner, horner_slope
from ...exact.replay.wall_flights import fall_of
from ...scenarios.numbers.quantity import ZERO, Quantity, Real, real

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...exact.replay.contact import AtArc, AtWall, Body, Flight, Gravity, Pair, Touch, WallFall
    from ...exact.replay.state import ReplayState
    from ...floating.knots import SteppedFall
    from ...scenarios.things import Circle

FlightBalls: TypeAlias = tuple[arb, arb, arb, arb, arb]
"""t, x, y, vx, vy of a flight."""

Row: TypeAlias = FlightBalls
"""t, x, y, vx, vy of one circle from its last contact on; under gravity in the frame that falls (`fallen`)."""

Rows: TypeAlias = dict[int, Row]
"""Circles by place."""


class OwnFlight(NamedTuple):
    """One circle from its last meeting on: x, y, vx, vy at time t, in the engine's own numbers."""

    t: Real
    x: Real
    y: Real
    vx: Real
    vy: Real


# -- the frame that falls, and steps in it


def fallen(falling: Gravity[arb] | None, row: FlightBalls) -> FlightBalls:
    """t, x, y, vx, vy of a circle in the frame that falls, in which it flies straight: X = x - g t^2/2, V = v - g t."""
    if falling is None:
        return row
    (t, x, y, vx, vy), (hx, hy, _) = row, falling
    return t, x - hx * t * t, y - hy * t * t, vx - 2 * hx * t, vy - 2 * hy * t


def last_step(motion: SteppedFall, begin: float, until: float) -> float | None:
    """The end of the last step before a time, of those that a flight has had since it began; None if it had none.

    >>> from truebreak.floating.knots import SteppedFall
    >>> motion = SteppedFall([[(0.0, 0.0, 8.0, 1.0, 0.0)]], 9.0, (0.0, -4.0), 0.5)
    >>> last_step(motion, 0.0, 1.75), last_step(motion, 0.0, 1.5), last_step(motion, 1.0, 1.5)
    (1.5, 1.0, None)
    """
    steps = math.ceil((min(until, motion.end) - begin) / motion.dt) - 1
    at = begin + steps * motion.dt
    return at if steps > 0 and begin < at < until else None


# -- to a wall


def wall_wait(fall: WallFall[arb], pull: int) -> arb | None:
    """How long it takes a circle to meet a wall; None if it does not, or if that is not known.

    Args:
        pull: see `Sides.pull`.
    """
    gap, approach, half = fall
    nears = ball.sign_of(approach) == -1
    if not pull:
        return law.wall_hit_time(gap, approach) if nears else None
    square = law.fall_discriminant(gap, approach, half)
    if ball.sign_of(square) in (None, -1) or (pull > 0 and not nears):
        return None
    root = ball.root(square)
    return law.fall_time(gap, approach, root) if nears else law.fall_time_back(approach, half, root)


def wall_margin(fall: WallFall[arb], pull: int) -> arb:
    """Whether a circle comes to a wall, as a number that is negative if it does, times the length of the normal.

    Of a wall that it is not pulled to or from, how fast it goes away from it; of one to which it is pulled, the speed
    at which it comes there; of one from which it is pulled, how near it comes.
    """
    gap, approach, half = fall
    if not pull:
        return approach
    square = law.fall_discriminant(gap, approach, half)
    if pull < 0:
        return -ball.root(square)
    return gap if ball.sign_of(approach) in (0, 1) else -square / (4 * half)


# -- to something round that stands, under gravity: zeros of quartics, near where doubles have them
#
# Which zero it is doubles tell, of the middles of the coefficients; where it is, interval Newton proves in balls. At a
# falling zero the gap goes from above 0 to below; as a flight leaves what it has just met, the zero of that is a rising
# one, whatever rounding has made of the gap.

NEARLY_REAL = 2.0**-20
"""Of a zero whose imaginary part is a smaller share doubles do not tell whether it is real: it is asked of balls."""

WIDENED = 24
"""Times that an interval about a zero is made eight times as wide, before it is given up."""


def fall_onto(state: ReplayState[arb], k: int, row: Row, peg: Body[arb]) -> RoundFall[arb]:
    """A circle and something round that stands, at the clock of the circle's flight, in true coordinates.

    Args:
        state: has gravity, and the radii.
        k: the circle.
        row: its flight, in the frame that falls.
        peg: what stands.
    """
    assert state.falling is not None
    (t, x, y, vx, vy), (hx, hy, _) = row, state.falling
    bend_x, bend_y = hx * t, hy * t
    x, y, vx, vy = x + bend_x * t, y + bend_y * t, vx + 2 * bend_x, vy + 2 * bend_y
    px, py, *_ = peg.flight
    return RoundFall(px - x, py - y, -vx, -vy, hx, hy, state.bodies[k].r + peg.r)


def _real_zeros(c: Sequence[arb]) -> list[float]:
    """Doubles beside the real zeros of a polynomial, in order; a double zero may be there as two, or not."""
    mids = [float(value.mid()) for value in c]
    if not all(map(math.isfinite, mids)) or not any(mids[1:]):
        return []
    zeros: Any = fmpq_poly([fmpq(*mid.as_integer_ratio()) for mid in mids]).complex_roots()  # each with how often
    parts = [(float(zero.real.mid()), float(zero.imag.mid())) for zero, _ in zeros]
    return sorted(x for x, y in parts if abs(y) <= NEARLY_REAL * math.hypot(x, y))


def zero_beside(c: Sequence[arb], near: float) -> arb | None:
    """The one zero of a polynomial about a double, proved by interval Newton; None where it is not.

    >>> zero = zero_beside([arb(-2), arb(0), arb(1)], 1.4)
    >>> zero.overlaps(arb(2).sqrt()), zero.rel_accuracy_bits() > 45, zero_beside([arb(1), arb(0), arb(1)], 1.0)
    (True, True, None)
    """
    at = arb(near)
    for _ in range(16):
        slope = horner_slope(c, at).mid()
        if slope == 0:
            return None
        step = (horner(c, at).mid() / slope).mid()
        at = (at - step).mid()
        if not at.is_finite():
            return None
    value, slope = horner(c, at), horner_slope(c, at)
    room = 2 * abs(value / slope).upper() if not slope.contains(0) else arb("inf")
    for _ in range(WIDENED):
        if not room.is_finite():
            return None
        around = arb(at, room)
        found = at - value / horner_slope(c, around)
        if found.is_finite() and around.contains_interior(found):
            return found
        room = 8 * room + arb(2) ** -ball.bits_in_use() * abs(at)
    return None


def fall_wait(fall: RoundFall[arb]) -> arb | None:
    """How long until one that falls meets something round that stands; below 0 where they overlap and come nearer.

    None if it does not, or if that is not known.

    >>> float(fall_wait(RoundFall(*map(arb, (0, -9, 0, 0, 0, -1, 5)))))
    2.0
    """
    gap = fall.polynomial(False)
    met = ball.sign_of(gap[0]) == -1 and ball.sign_of(gap[1]) == -1
    mids = [float(value.mid()) for value in gap]
    falling = [zero for zero in _real_zeros(gap) if horner_slope(mids, zero) < 0.0]
    near = max((zero for zero in falling if zero <= 0.0), default=None) if met else None
    if near is None:
        near = min((zero for zero in falling if zero > 0.0), default=None)
    return None if near is None else zero_beside(gap, near)


def nearest_fall(fall: RoundFall[arb]) -> arb | None:
    """How near one that falls comes to something round that stands, from now on: from surface to surface.

    Negative for how deep it would come in; of several times at which it is nearest, that of the least distance. None
    where it only goes away; not a number where that is not known.

    >>> float(nearest_fall(RoundFall(*map(arb, (4, -4, -2, 0, 0, -1, 1)))))
    -1.0
    >>> thrown_up = RoundFall(*(arb(part, 2**-6) for part in (0.125, -1, 0, -1, 0, -1, 0.5)))
    >>> thrown_up.approach() > 0, nearest_fall(thrown_up).is_nan()
    (True, True)
    """
    gap = fall.polynomial(False)
    slope = tuple(k * value for k, value in enumerate(gap) if k)
    mids = [float(value.mid()) for value in slope]
    ahead = [zero for zero in _real_zeros(slope) if zero > 0.0 and horner_slope(mids, zero) > 0.0]
    found: list[arb] = []
    for near in ahead:
        wait = zero_beside(slope, near)
        if wait is None:
            return arb("nan")
        then = fall.after(wait)
        found.append(ball.root(then.dx * then.dx + then.dy * then.dy) - fall.reach)
    return min(found, key=lambda far: float(far.mid()), default=None)


def falls_on(state: ReplayState[arb], link: Touch) -> bool:
    """Whether a contact is of one that falls with a circle that stands."""
    return state.stands and is_pair(link) and state.on_peg(link)


def _off_peg(state: ReplayState[arb], link: Pair, rows: Mapping[int, Row], here: bool) -> Rows:
    """See `bounce`: of one that falls onto a circle that stands."""
    k, other = (link.b, link.a) if link.a in state.pegs else link
    t, x, y, vx, vy = rows[k]
    fall = fall_onto(state, k, rows[k], state.bodies[other])
    wait = arb(0) if here else fall_wait(fall)
    if wait is None:  # it does not come there
        wait = arb("nan")
    then = fall.after(wait)
    reach = ball.root(then.dx * then.dx + then.dy * then.dy) if here else then.reach
    w = state.bodies[k].w
    jx, jy = pair_impulse(*then[:4], reach, w, arb(0))
    if state.share is not None:
        jx, jy = jx * state.share, jy * state.share
    return {k: (t + wait, advance(x, vx, wait), advance(y, vy, wait), vx - w * jx, vy - w * jy)}


# -- a bounce


def _bounce_off_arc(state: ReplayState[arb], link: AtArc, row: Row, here: bool) -> Rows:
    """See `bounce`: a hollow side is met at the later zero of the gap."""
    a, b = link.ends(state)
    t, x, y, vx, vy = row
    dx, dy, reach = b.flight.x - x, b.flight.y - y, a.r + b.r
    wait = t - t
    if here:
        reach = (dx * dx + dy * dy).sqrt()
    else:
        root, approach = pair_discriminant(dx, dy, -vx, -vy, reach).sqrt(), pair_approach(dx, dy, -vx, -vy)
        if link.hollow:
            wait = pair_last_time(approach, root, vx * vx + vy * vy)
        else:
            wait = pair_hit_time(pair_gap(dx, dy, reach), approach, root)
        dx, dy = advance(dx, -vx, wait), advance(dy, -vy, wait)
    jx, jy = pair_impulse(dx, dy, -vx, -vy, reach, a.w, b.w)
    if state.share is not None:
        jx, jy = jx * state.share, jy * state.share
    return {link.circle: (t + wait, advance(x, vx, wait), advance(y, vy, wait), vx - a.w * jx, vy - a.w * jy)}


def _off_falling_wall(state: ReplayState[arb], link: AtWall, row: Row, here: bool) -> Row:
    """See `bounce`: of a wall that falls in the frame that does, or moves, whose speed the circle's is relative to."""
    assert state.falling is not None
    (t, x, y, vx, vy), line = row, state.line(link.circle, link.wall)
    offset = state.bodies[link.circle].r * line.length
    fall = fall_of(state.falling, (x, y, vx, vy, t), line, offset, state.drifts.get(link.wall), state.zero)
    wait = arb(0) if here else wall_wait(fall, state.sides.pull(link.circle, link.wall))
    if wait is None:  # it does not come there
        wait = arb("nan")
    change = 2 * fall_speed(fall.approach, fall.half, wait) / line.nn
    if state.share is not None:
        change = change * state.share
    return (t + wait, advance(x, vx, wait), advance(y, vy, wait), vx - change * line.nx, vy - change * line.ny)


def row_of(flight: Flight[arb]) -> Row:
    """t, x, y, vx, vy."""
    return flight.t, flight.x, flight.y, flight.vx, flight.vy


def flown(row: Row, time: arb) -> Row:
    """The same flight from another time on."""
    t, x, y, vx, vy = row
    if t is time:
        return row
    late = time - t
    return time, advance(x, vx, late), advance(y, vy, late), vx, vy


def less(rows: Mapping[int, Row], others: Mapping[int, Row]) -> Rows:
    """By what rows differ from others."""
    return {k: tuple(a - b for a, b in zip(row, others[k], strict=True)) for k, row in rows.items()}  # pyright: ignore[reportReturnType]


def added(rows: Mapping[int, Row], others: Mapping[int, Row]) -> Rows:
    """The sums of rows, of the circles that either has."""
    return {**rows, **{k: plus(rows[k], row, None) if k in rows else row for k, row in others.items()}}


def plus(row: Row, other: Row, scale: arb | None) -> Row:
    """A row and another, or a part of that."""
    t, x, y, vx, vy = row
    dt, dx, dy, ux, uy = other
    if scale is not None:
        return t + scale * dt, x + scale * dx, y + scale * dy, vx + scale * ux, vy + scale * uy
    return t + dt, x + dx, y + dy, vx + ux, vy + uy


def bounce(state: ReplayState[arb], link: Touch, rows: Mapping[int, Row], here: bool = False) -> Rows:
    """The bounce of two circles, or of a circle and a wall or an arc, where they touch first in free flight.

    It leaves 1 + e times the approach, with the state's restitution e; a wall, or a fixed circle, may fall in the
    state's frame, or a wall move.

    Args:
        state: has the radii, the masses, the walls and the arcs, and where fixed circles are.
        rows: the flights of those that can move.
        here: where they are now, along their line of centres, however long it is.
    """
    if is_flat(link):
        if state.falling is not None:
            return {link.circle: _off_falling_wall(state, link, rows[link.circle], here)}
        t, x, y, vx, vy = rows[link.circle]
        line, r = state.line(link.circle, link.wall), state.bodies[link.circle].r
        wait = t - t
        if not here:
            gap = wall_gap(x, y, line.x0, line.y0, line.nx, line.ny, r * line.length)
            wait = wall_hit_time(gap, wall_approach(vx, vy, line.nx, line.ny))
        left = wall_bounce(vx, vy, line.nx, line.ny, line.nn)
        if state.share is not None:
            left = damped(vx, left[0], state.share), damped(vy, left[1], state.share)
        return {link.circle: (t + wait, advance(x, vx, wait), advance(y, vy, wait), *left)}
    if is_arc(link):
        return _bounce_off_arc(state, link, rows[link.circle], here)
    assert is_pair(link)
    if falls_on(state, link):
        return _off_peg(state, link, rows, here)
    a, b = link.ends(state)
    one, other = (rows[k] if k in rows else row_of(state.bodies[k].flight) for k in link)
    later = one[0] if link.b not in rows else other[0]
    (_, ax, ay, avx, avy), (_, bx, by, bvx, bvy) = flown(one, later), flown(other, later)
    dx, dy, vx, vy, reach = bx - ax, by - ay, bvx - avx, bvy - avy, a.r + b.r
    if here:
        jx, jy = pair_impulse(dx, dy, vx, vy, (dx * dx + dy * dy).sqrt(), a.w, b.w)
    else:
        root = pair_discriminant(dx, dy, vx, vy, reach).sqrt()
        wait = pair_hit_time(pair_gap(dx, dy, reach), pair_approach(dx, dy, vx, vy), root)
        later = later + wait
        strength = pair_strength(root, reach, a.w, b.w)
        jx, jy = strength * advance(dx, vx, wait), strength * advance(dy, vy, wait)
    if state.share is not None:
        jx, jy = jx * state.share, jy * state.share
    found: Rows = {}
    for k, row, body, sign in ((link.a, one, a, -1), (link.b, other, b, 1)):
        if k in rows:
            t, x, y, ux, uy = flown(row, later)
            found[k] = t, x, y, ux + sign * body.w * jx, uy + sign * body.w * jy
    return found


# -- zeros that are proved

ExactFlight: TypeAlias = tuple[Quantity, Quantity, Quantity, Quantity, Quantity]
"""t, x, y, vx, vy of a flight."""

LONGEST_TEXT = 400
"""Characters of an exact value that is still calculated with as text: some levels of square roots, which a `Quantity`
tells from zero in milliseconds. A longer one proves nothing, and is never called zero."""


def exact_flight(flight: OwnFlight | None, gravity: tuple[Quantity, Quantity] | None = None) -> ExactFlight | None:
    """A flight in exact numbers, where they are short; under gravity that of the frame that falls.

    >>> flight = OwnFlight(*map(Quantity.of, (2, 0, 5, 1, -8)))
    >>> [number.text() for number in exact_flight(flight, (Quantity.of(0), Quantity.of(-4)))]
    ['2', '0', '13', '1', '0']
    """
    values = [] if flight is None else [short_quantity(value) for value in flight]
    if None in values or len(values) < 5:
        return None
    found = cast("ExactFlight", tuple(values))
    if gravity is None:
        return found
    (t, x, y, vx, vy), (gx, gy) = found, gravity
    return t, x - gx * t * t / 2, y - gy * t * t / 2, vx - gx * t, vy - gy * t


def short_quantity(value: Real) -> Quantity | None:
    """A number as a `Quantity`, if it is exact and short."""
    text = real(value).text()
    return None if text is None or len(text) > LONGEST_TEXT else Quantity.of(text)


def resting(circle: Circle) -> ExactFlight:
    """The flight of what never moves."""
    return ZERO, circle.x, circle.y, ZERO, ZERO


def apart_at(one: ExactFlight, other: ExactFlight) -> tuple[Quantity, Quantity, Quantity, Quantity]:
    """d and v from one to the other, at the later of the times from which they fly."""
    (s, *a), (t, *b) = one, other
    later = s if (s - t).sign() >= 0 else t
    ax, ay = advance(a[0], a[2], later - s), advance(a[1], a[3], later - s)
    bx, by = advance(b[0], b[2], later - t), advance(b[1], b[3], later - t)
    return bx - ax, by - ay, b[2] - a[2], b[3] - a[3]


def is_zero(formula: Callable[..., Quantity], *numbers: Quantity) -> bool:
    """Whether a formula is proved to give zero."""
    try:
        return formula(*numbers).sign() == 0
    except ValueError:
        return False
