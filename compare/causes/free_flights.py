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
from ...exact.replay.contact import AtArc, is_arc, is_flat, is_pair
from ...exact.replay.landings import faces_arc
from ...exact.replay.round_falls import RoundFall, horner, horner_slope
from ...exact.replay.wall_flights import fall_of
from ...scenarios.numbers.quantity import ZERO, Quantity, Real, real
from ..files.amounts import normal_form
from ..tangent.flight_aside import RoundSide, middle, out_of, stretches

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...exact.replay.contact import AtWall, Body, Flight, Gravity, Round, Touch, WallFall
    from ...exact.replay.state import ReplayState
    from ...floating.knots import SteppedFall
    from ...scenarios.surfaces import ThingParts
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


def risen(falling: Gravity[arb] | None, row: FlightBalls) -> FlightBalls:
    """The same in true coordinates, of a flight in the frame that falls."""
    return row if falling is None else fallen(falling._replace(hx=-falling.hx, hy=-falling.hy), row)


def seen_from(row: FlightBalls, pace: tuple[arb, arb] | None) -> FlightBalls:
    """A flight as seen from a thing that moves with a velocity, which so stands where it is at time 0; None: as it is.

    >>> [float(number) for number in seen_from(tuple(map(arb, (2, 10, 0, 3, 0))), (arb(1), arb(-1)))]
    [2.0, 8.0, 2.0, 2.0, 1.0]
    """
    if pace is None:
        return row
    (t, x, y, vx, vy), (ux, uy) = row, pace
    return t, x - ux * t, y - uy * t, vx - ux, vy - uy


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
    (_, x, y, vx, vy), (hx, hy, _) = risen(state.falling, row), state.falling
    px, py, *_ = peg.flight
    return RoundFall(px - x, py - y, -vx, -vy, hx, hy, state.reach(state.bodies[k], peg))


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


def _falling_zeros(gap: Sequence[arb]) -> list[float]:
    """Doubles beside the zeros from now on at which a gap falls; first the last one before, of two that overlap and
    come nearer."""
    met = ball.sign_of(gap[0]) == -1 and ball.sign_of(gap[1]) == -1
    mids = [float(value.mid()) for value in gap]
    falling = [zero for zero in _real_zeros(gap) if horner_slope(mids, zero) < 0.0]
    before = [zero for zero in falling if zero <= 0.0][-1:] if met else []
    return [*before, *(zero for zero in falling if zero > 0.0)]


def fall_wait(fall: RoundFall[arb]) -> arb | None:
    """How long until one that falls meets something round that stands; below 0 where they overlap and come nearer.

    None if it does not, or if that is not known.

    >>> float(fall_wait(RoundFall(*map(arb, (0, -9, 0, 0, 0, -1, 5)))))
    2.0
    """
    gap = fall.polynomial(False)
    return next((zero_beside(gap, near) for near in _falling_zeros(gap)), None)


def _turns(fall: RoundFall[arb], sign: int) -> list[RoundFall[arb]] | None:
    """The two whenever their distance has become least (1) or greatest (-1), from now on; None where not known."""
    slope = tuple(k * value for k, value in enumerate(fall.polynomial(False)) if k)
    mids = [float(value.mid()) for value in slope]
    ahead = [zero for zero in _real_zeros(slope) if zero > 0.0 and horner_slope(mids, zero) * sign > 0.0]
    waits = [zero_beside(slope, near) for near in ahead]
    known = [fall.after(wait) for wait in waits if wait is not None]
    return known if len(known) == len(waits) else None


def _distance(fall: RoundFall[arb]) -> arb:
    return ball.root(fall.dx * fall.dx + fall.dy * fall.dy)


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
    turns = _turns(fall, 1)
    if turns is None:
        return arb("nan")
    return min((_distance(then) - fall.reach for then in turns), key=middle, default=None)


def sides_of(state: ReplayState[arb], k: int, parts: ThingParts) -> list[RoundSide]:
    """The sides of an arc, as a circle that may meet it has them."""
    r, ends = state.bodies[k].r, [state.bodies[end].flight for end in parts.ends]
    return [
        RoundSide(body.flight.x, body.flight.y, abs(body.r), r, side % 2 == 1, tuple((e.x, e.y) for e in ends))
        for side in parts.sides
        for body in (state.arcs[side],)
    ]


def _side_wait(state: ReplayState[arb], link: AtArc, row: Row) -> arb | None:
    """As `fall_wait`, onto a side of an arc: the first zero within its range at which the gap falls."""
    fall, sign = fall_onto(state, link.circle, row, state.arcs[link.arc]), -1 if link.hollow else 1
    if link.hollow and ball.sign_of(fall.reach) != -1:  # no room for it within
        return None
    gap = [sign * value for value in fall.polynomial(False)]
    through = sign * middle(pair_gap(fall.dx, fall.dy, state.arcs[link.arc].r))
    before = through > 0.0 and _faces(state, link, fall)  # else the circle is beyond it, and does not overlap it
    for near in _falling_zeros(gap):
        if (near > 0.0 or before) and _faces(state, link, fall.after(arb(near))):
            return zero_beside(gap, near)
    return None


def _faces(state: ReplayState[arb], link: AtArc, fall: RoundFall[arb]) -> bool:
    return middle(faces_arc(state, link, fall.dx, fall.dy)) > 0.0


NEAR_GRAZE = 2.0**-30
"""A share of the radii: by less, doubles do not tell a graze of an arc from a hit."""


class ThingFall(NamedTuple):
    """A circle that falls, and something with faces, ends or sides of arcs that stands, or from which it is seen.

    Attributes:
        state: has gravity, and where all that stands is.
        k: the circle.
        row: its flight, in the frame that falls, as seen from what moves (`seen_from`).
        parts: of what stands.
    """

    state: ReplayState[arb]
    k: int
    row: Row
    parts: ThingParts

    def wait(self) -> arb | None:
        """How long until the two meet, as `fall_wait`; of several parts that it would meet, the first."""
        faces = (wait for face in self.parts.faces if (wait := self._face_wait(face)) is not None)
        ends = (wait for fall in self._ends() if (wait := fall_wait(fall)) is not None)
        sides = (wait for link in self._sides() if (wait := _side_wait(self.state, link, self.row)) is not None)
        return min((*faces, *ends, *sides), key=middle, default=None)

    def margin(self) -> arb | None:
        """How near the two come, as `nearest_fall`; where they meet, how far the flight would have to be moved to miss.

        That is aside, out of what the parts cover together across the flight at the contact (`flight_aside`); or back,
        where gravity turns the circle round within what it meets. It is 0 where the two graze.
        """
        wait = self.wait()
        away = self._clearances()
        if away is None:
            return arb("nan")
        if wait is None:
            return min(away, key=middle, default=None)
        depth = self._aside(flown(self.row, self.row[0] + wait))
        return max((arb(0).min(depth), *(gap for gap in away if middle(gap) <= 0.0)), key=middle)

    def stay(self) -> tuple[arb, arb] | None:
        """From when to when they would overlap, if neither pushed and the circle flew straight on from there."""
        wait = self.wait()
        if wait is None:
            return None
        there = risen(self.state.falling, flown(self.row, self.row[0] + wait))
        return there[0], max(
            times_at(self.state, self.k, there, self.parts, leaving=True), key=middle, default=there[0]
        )

    def _ends(self) -> list[RoundFall[arb]]:
        return [fall_onto(self.state, self.k, self.row, self.state.bodies[end]) for end in self.parts.ends]

    def _sides(self) -> list[AtArc]:
        return [AtArc(self.k, side) for side in self.parts.sides]

    def _face(self, face: int) -> tuple[WallFall[arb], int, arb, bool]:
        """The circle and the line of a face, where gravity pulls it, |n|, and whether its centre is behind the line."""
        state, (t, x, y, vx, vy) = self.state, self.row
        assert state.falling is not None
        line = state.line(self.k, face)
        offset = state.bodies[self.k].r * line.length
        fall = fall_of(state.falling, (x, y, vx, vy, t), line, offset, None, state.zero)
        return fall, state.sides.pull(self.k, face), line.length, middle(fall.gap + offset) < 0.0

    def _is_within(self, face: int, wait: arb) -> bool:
        """Whether a circle is before a face, and not beside it, after a time."""
        line = self.state.line(self.k, face)
        _, x, y, *_ = risen(self.state.falling, flown(self.row, self.row[0] + wait))
        return 0.0 < middle(law.face_along(x, y, line.x0, line.y0, line.nx, line.ny)) < middle(line.nn)

    def _face_wait(self, face: int) -> arb | None:
        fall, pull, _, behind = self._face(face)
        if behind and not (pull < 0 and ball.sign_of(fall.approach) == 1):
            return None
        wait = wall_wait(fall, pull)
        return wait if wait is not None and self._is_within(face, wait) else None

    def _clearances(self) -> list[arb] | None:
        """The gaps to parts whenever they are least; of those that the flight passes, or comes to and turns back."""
        found: list[arb] = []
        for face in self.parts.faces:
            fall, pull, length, behind = self._face(face)
            turns = pull > 0 and ball.sign_of(fall.approach) == -1 and not behind
            if turns and self._is_within(face, -fall.approach / (2 * fall.half)):
                found.append(wall_margin(fall, pull) / length)
        for fall in self._ends():
            turns = _turns(fall, 1)
            if turns is None:
                return None
            found += [_distance(then) - fall.reach for then in turns]
        for link in self._sides():
            fall, sign = fall_onto(self.state, self.k, self.row, self.state.arcs[link.arc]), -1 if link.hollow else 1
            turns = _turns(fall, sign)
            if turns is None:
                return None
            for then in turns:
                gap = sign * (_distance(then) - abs(fall.reach))
                if middle(gap) >= -NEAR_GRAZE * middle(abs(fall.reach)) and _faces(self.state, link, then):
                    found.append(gap)
        return found

    def _aside(self, there: Row) -> arb:
        """How far aside a flight would have to be to pass what it meets at a place, below 0: along its tangent there.

        An end is passed at the distance at which the flight itself is nearest to it.
        """
        state, bodies = self.state, self.state.bodies
        seen = stretches(
            risen(state.falling, there)[1:],
            bodies[self.k].r,
            [state.line(self.k, face) for face in self.parts.faces],
            [(end, *bodies[end].flight[:2], bodies[end].r) for end in self.parts.ends],
            sides_of(state, self.k, self.parts),
        )
        for n, span in enumerate(seen):
            if span.end is None:
                continue
            fall = fall_onto(state, self.k, there, bodies[span.end])
            near = nearest_fall(fall)
            if near is not None and near.is_finite():
                off = (near + fall.reach) * (1 if middle(span.low + span.high) > 0.0 else -1)
                seen[n] = span._replace(low=off - fall.reach, high=off + fall.reach)
        passed = out_of(seen)
        return arb(0) if passed is None else passed.aside


def times_at(state: ReplayState[arb], k: int, row: Row, parts: ThingParts, *, leaving: bool) -> list[arb]:
    """When a circle that flies straight touches each part that it comes to, or leaves it if neither pushes."""
    (t, x, y, vx, vy), found = row, list[arb]()
    r = state.bodies[k].r
    for face in parts.faces:
        line = state.line(k, face)
        gap = wall_gap(x, y, line.x0, line.y0, line.nx, line.ny, r * line.length)
        approach = wall_approach(vx, vy, line.nx, line.ny)
        behind = middle(gap + r * line.length) < 0.0
        if ball.sign_of(approach) != (1 if leaving else -1) or (behind and not leaving):
            continue
        wait = wall_hit_time(gap, approach)
        foot = law.face_along(advance(x, vx, wait), advance(y, vy, wait), line.x0, line.y0, line.nx, line.ny)
        if 0.0 < middle(foot) < middle(line.nn):
            found.append(t + wait)
    for end in parts.ends:
        there = state.bodies[end].flight
        dx, dy, reach = there.x - x, there.y - y, r + state.bodies[end].r
        time = meeting_time((t, dx, dy, -vx, -vy, reach))
        if time is not None and leaving:
            root = ball.root(pair_discriminant(dx, dy, -vx, -vy, reach))
            time += (root + root) / (vx * vx + vy * vy)
        found += [] if time is None else [time]
    ways = [told for side in sides_of(state, k, parts) if (told := side.waits((x, y, vx, vy)))]
    if ways:  # of an arc the time through the side that is met first
        found.append(t + min(ways, key=lambda told: middle(told[0]))[leaving])
    return found


Relative: TypeAlias = tuple[arb, arb, arb, arb, arb, arb]
"""t, d, v and R of two round things."""


def meeting_time(relative: Relative) -> arb | None:
    """When two round things touch in free flight."""
    t, dx, dy, vx, vy, reach = relative
    approach, discriminant = pair_approach(dx, dy, vx, vy), pair_discriminant(dx, dy, vx, vy, reach)
    if ball.sign_of(approach) != -1 or ball.sign_of(discriminant) == -1:
        return None
    return t + pair_hit_time(pair_gap(dx, dy, reach), approach, ball.root(discriminant))


def falls_on(state: ReplayState[arb], link: Touch) -> bool:
    """Whether a contact is of one that falls with something round that stands."""
    return state.stands and not is_flat(link) and state.on_peg(link)


def standing(state: ReplayState[arb], link: Round) -> Body[arb]:
    """Of a contact of which `falls_on` holds, what stands."""
    a, b = link.ends(state)
    return a if is_pair(link) and link.a in state.pegs else b


def fall_of_contact(state: ReplayState[arb], link: Round, row: Row) -> RoundFall[arb]:
    """As `fall_onto`, of a contact of which `falls_on` holds; of an end that moves, as seen from it."""
    stands = standing(state, link)
    pace = state.paces.get(stands.index) if is_pair(link) else None
    return fall_onto(state, state.faller(link).index, seen_from(row, pace), stands)


def round_wait(state: ReplayState[arb], link: Round, row: Row) -> arb | None:
    """How long until one that falls comes to such a contact; None if it does not, or if that is not known."""
    if is_arc(link):
        return _side_wait(state, link, row)
    return fall_wait(fall_of_contact(state, link, row))


def _off_what_stands(state: ReplayState[arb], link: Round, rows: Mapping[int, Row], here: bool) -> Rows:
    """See `bounce`: of one that falls onto something round that stands."""
    k = state.faller(link).index
    t, x, y, vx, vy = rows[k]
    fall = fall_of_contact(state, link, rows[k])
    wait = arb(0) if here else round_wait(state, link, rows[k])
    if wait is None:  # it does not come there
        wait = arb("nan")
    then = fall.after(wait)
    w = state.bodies[k].w
    jx, jy = pair_impulse(*then[:4], _distance(then) if here else then.reach, w, arb(0))
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
    if falls_on(state, link):
        return _off_what_stands(state, cast("Round", link), rows, here)
    if is_arc(link):
        return _bounce_off_arc(state, link, rows[link.circle], here)
    assert is_pair(link)
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
    text = normal_form(real(value))
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
