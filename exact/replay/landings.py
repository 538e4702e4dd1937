"""When a circle that falls comes to something round that stands, in a state's numbers; and which part an arc is."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations, pairwise
from math import copysign, frexp, inf, isfinite, ldexp, sqrt
from typing import NamedTuple, TypeAlias

from flint import arb, fmpq, fmpq_poly

from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ...scenarios.things import Circle, Wall
from ..laws.formulas import arc_range, pair_approach, pair_gap
from ..numbers.ball import FieldNumber, LeavesField, bits_in_use, field_sign, sharpened, sign_of, use_bits
from ..numbers.system import M, N
from .contact import AtArc, Flown, Link, Round, can_push, is_arc, is_flat, is_pair
from .round_falls import (
    EXACT_WEIGHTS,
    GREATEST,
    LEAST,
    SMALLEST,
    SPLITS,
    Isolated,
    RoundFall,
    Unclear,
    bernstein_end,
    bits_of,
    doubles_of,
    falling_zero,
    falling_zero_exactly,
    falling_zero_in_balls,
    first_zero_exactly,
    halved,
    horner,
    horner_slope,
    last_zero,
    parted,
)
from .state import Flights

# -- The ranges of arcs: which part of its circle each is, told by the side of a chord.


def arc_chord(state: Flights[N], link: AtArc) -> tuple[N, N, N]:
    """The normal of an arc's chord, and n.e |R|, as `formulas.arc_range` takes them."""
    side, reach, constant = state.scene.arc_sides[link.arc], state.reach(*link.ends(state)), state.constant
    return constant(side.nx), constant(side.ny), constant(side.h) * (-reach if link.hollow else reach)


def faces_arc(state: Flights[N], link: AtArc, dx: N, dy: N) -> N:
    """Whether a circle anywhere, d from the middle of an arc, is within its range: positive there."""
    side, constant = state.scene.arc_sides[link.arc], state.constant
    if side.full:
        return state.one
    return arc_range(dx, dy, constant(side.nx), constant(side.ny), constant(side.h) * state.root(dx * dx + dy * dy))


def within_arc(state: Flights[N], link: AtArc, dx: N, dy: N) -> N:
    """Whether d, as long as the centres are apart at a contact, leads to within an arc's range: positive there."""
    return state.one if state.scene.arc_sides[link.arc].full else arc_range(dx, dy, *arc_chord(state, link))


# -- Falls onto sides of arcs, and through rims, where one zero after the other may be the meeting.
#
# A side of an arc is met, as an end of a segment is, at a zero of a quartic at which its gap falls: |D|^2 - R^2 of the
# outside, R^2 - |D|^2 of the hollow side. The first such zero need not be it. Where D then does not lead to within the
# range, there is nothing, and the circle goes on through the opening; a later zero may be within. A flight may begin
# beyond a gap: the disc in a bowl is within the R of the outside, and the one above it outside of the R of the hollow
# side. So all zeros are gone through in turn, those at which the gap rises, and those beyond the range, are passed
# over, and the first that is left is the meeting: whatever the circle would cross before is met before. The rim of a
# pocket has no range.
#
# Where an interval of time surely has no place within the range, |D| being R, no zero in it matters, be it single,
# double, or none: it is left out undecided. So a circle may graze, or start upon, what of a circle is no arc.

SHORT = 1e-30
"""Least end of the times at which zeros are looked for, though they may all lie well before it."""

PARTS_A_BIT = 8
"""Most parts of the times looked at for each bit at hand: a zero, also a double one, needs about two. Beside a fourfold
one, as far as bits do not tell from it, each part would be looked at, and there may be 2 to a fourth of the bits."""

Landing: TypeAlias = arb | Unclear | None
"""What is known of when a circle lands: when, reckoned from its clock; what it is not before; None: it does not."""


def gap_of(link: Round, fall: RoundFall[N], stood: int) -> tuple[N, ...]:
    """The gap of a contact as a polynomial of the time: above 0 where they are apart (see `RoundFall.polynomial`)."""
    found = fall.polynomial(stood)
    return tuple(-value for value in found) if link.hollow else found


class Unsharp(ZeroDivisionError):
    """Balls at hand do not tell the first falling zero; none comes before `since`, reckoned from the instant."""

    def __init__(self, since: float) -> None:
        super().__init__(since)
        self.since = since


def landing_wait(state: Flights[arb], link: Round, end: float) -> arb:
    """The time from the clock of the one that falls to the hit, at the working precision.

    Where it is told from all else is reckoned from the instant, where the gap is above zero, or zero and divided out;
    then it is sharpened from the clock, whose time is exact.

    Raises:
        Unsharp: where balls at hand do not tell it.
        AssertionError: where there is none, as it is asked of contacts alone that come.
    """
    found = landing(state, link, end)
    if not isinstance(found, arb):
        assert found is not None, "a circle that was to fall onto another does not: a defect"
        raise Unsharp(found.since)
    return found


def landing(state: Flights[arb], link: Round, end: float, at_clock: RoundFall[arb] | None = None) -> Landing:
    """As `landing_wait`: what is known of it. Beyond `end`, reckoned from the instant, it may be left out.

    Args:
        at_clock: the two at the clock, where that is known already.
    """
    at_clock = at_clock or state.peg_fall_at_clock(link)
    late, stood = state.faller(link).flight.late, state.stood(link)
    fall = at_clock if late is None else at_clock.after(late)
    gap = gap_of(link, fall, stood)
    hollow = link.hollow
    dx, dy, vx, vy, hx, hy, reach = at_clock
    square = reach * reach

    def value(s: arb) -> arb:
        x, y = dx + (vx - hx * s) * s, dy + (vy - hy * s) * s
        found = x * x + y * y - square
        return -found if hollow else found

    def slope(s: arb) -> arb:
        bend_x, bend_y = hx * s, hy * s
        wx, wy = vx - bend_x, vy - bend_y
        found = ((dx + wx * s) * (wx - bend_x) + (dy + wy * s) * (wy - bend_y)) * 2
        return -found if hollow else found

    def beyond(low: fmpq, high: fmpq) -> bool:
        if not is_arc(link):
            return False
        place = fall.after(arb(low).union(arb(high)))
        return bool(within_arc(state, link, place.dx, place.dy) < 0)

    for found in falling_zeros(gap, end, beyond) if is_arc(link) or not can_push(link) else _first_falling(gap, end):
        if isinstance(found, Unclear):
            return found
        first, last = (arb(fmpq(*end.as_integer_ratio())) if isinstance(end, float) else arb(end) for end in found)
        low, high = (first, last) if late is None else (first + late, last + late)
        wait = sharpened(low, high, value, slope)
        if stood and (wait is None or 2 * wait.rel_accuracy_bits() < bits_in_use()):  # all but at the zero left out
            since = sharpened(first, last, lambda s: horner(gap, s), lambda s: horner_slope(gap, s))
            again = since if since is None or late is None else late + since
            wait = again if wait is None else wait if again is None else wait.intersection(again)
        within = None if wait is None else _is_within(state, link, at_clock.after(wait))
        if wait is None or within is None:
            return Unclear(float(found.low) * (1 - 2.0**-40))  # pyright: ignore[reportArgumentType]
        if within:
            return wait
    return None


def _is_within(state: Flights[arb], link: Round, place: RoundFall[arb]) -> bool | None:
    """Whether a circle at a falling zero is within the range of an arc; None where that is not told, or at its end."""
    if not is_arc(link):
        return True
    sign = sign_of(within_arc(state, link, place.dx, place.dy))
    return sign > 0 if sign else None


def _first_falling(c: Sequence[arb], end: float) -> Iterator[Isolated | Unclear]:
    """The first zero at which a polynomial, positive at 0, falls; nothing where none does."""
    found = falling_zero_in_balls(c, end)
    if found is not None:
        yield found


def falling_zeros(c: Sequence[arb], end: float, beyond: Callable[[fmpq, fmpq], bool]) -> Iterator[Isolated | Unclear]:
    """The zeros in (0, end], and maybe some beyond, at which a polynomial falls, in turn; the first that is not told
    is the last.

    Args:
        c: the coefficients, whatever the sign at 0.
        end: what to look up to.
        beyond: whether what lies between two times surely does not matter.
    """
    mids, exact = doubles_of(c)
    if c[0] < 0 and falling_zero([-value for value in mids], exact, end) is None:
        return  # it never rises
    first = falling_zero(mids, exact, end) if c[0] > 0 else Unclear(0.0)
    if first is None:
        return
    if isinstance(first, Isolated):
        yield first
    # Beyond all zeros at which it falls: with a leading coefficient above 0 those lie before the last zero of the
    # derivative, whose coefficients have the same signs as those of the powers from the first on, and smaller ratios.
    last = last_zero(mids, exact)
    if last == 0.0:
        return
    last = min(max(last, SHORT), end)  # any later end is as good
    if not LEAST < last < GREATEST:
        yield Unclear(0.0)
        return
    top, most = fmpq(*bernstein_end(last).as_integer_ratio()), bits_of(c)
    terms, power = [c[0]], fmpq(1)
    for value in c[1:]:
        power *= top
        terms.append(value * arb(power))
    b = [sum((arb(w) * s for w, s in zip(row, terms, strict=False)), arb(0)) for row in EXACT_WEIGHTS[len(c) - 1]]
    stack, looked = [(fmpq(0), top, b, 0)], 0
    while stack:
        low, high, b, depth = stack.pop()
        looked += 1
        signs = [sign_of(value) for value in b]
        if all(signs):
            changes = sum(one != other for one, other in pairwise(signs))
            if changes == 0 or (changes == 1 and signs[0] == -1):
                continue
            if changes == 1:
                if isinstance(first, Unclear) or not _holds(low, high, first):
                    yield Isolated(low, high)
                continue
        if beyond(low, high):
            continue
        if depth > most or looked > PARTS_A_BIT * most:
            yield Unclear(float(low) * (1 - 2.0**-40))  # pyright: ignore[reportArgumentType]
            return
        for share in SPLITS:
            left, right = parted(b, arb(share))
            if sign_of(left[-1]):
                break
        else:
            share = SPLITS[0]
            left, right = parted(b, arb(share))
        at = low + (high - low) * share
        stack.append((at, high, right, depth + 1))
        stack.append((low, at, left, depth + 1))


def _holds(low: fmpq, high: fmpq, zero: Isolated) -> bool:
    """Whether what is between two fractions holds the ends of another zero, which is then its own."""
    one, other = (fmpq(*end.as_integer_ratio()) if isinstance(end, float) else end for end in zero)
    return bool(low <= one) and bool(other <= high)


# -- The same of midpoints: the zero beside which the truth has its own.
#
# A circle that is known by a midpoint and a bound meets something round at a zero of a quartic for each state that it
# may be in. Of the truth its balls tell which zero that is. The midpoint's is the one beside it, and the same zero
# carried on from one to the other, if the gap falls throughout where both lie, whatever the state: then there is one.


BRIEF_BITS = 160
"""Of balls that tell where a zero is; then it is sharpened with twice as many, and so on."""

GUARD_BITS = 64
"""By which precision is higher than half of what it is next, as a zero is sharpened."""


Met: TypeAlias = tuple[arb, RoundFall[arb]]
"""A time until two meet, and how they stand to each other then."""


class Window(NamedTuple):
    """Where a meeting is of all states that a circle may be in.

    Attributes:
        wait: encloses the time from the clock to the hit.
        fall: the two at the clock, in balls.
        hollow: whether they part there.
    """

    wait: arb
    fall: RoundFall[arb]
    hollow: bool

    def falls(self, until: arb) -> bool:
        """Whether the gap falls all along an interval of time, in every state."""
        speed = self.fall.after(until).approach()
        return bool(speed > 0) if self.hollow else bool(speed < 0)


def window_of(state: Flights[arb], link: Round) -> Window | None:
    """Where the meeting of a circle that falls and something round is, that is certain to come; None: not told."""
    bits = bits_in_use()
    for few in (min(BRIEF_BITS, bits), bits):
        use_bits(few)
        fall = state.peg_fall_at_clock(link)
        found = landing(state, link, inf, fall)
        use_bits(bits)
        if isinstance(found, arb) and found.is_finite():
            return Window(found, fall, link.hollow)
    return None


def met_beside(state: Flights[arb], link: Round, window: Window, flight: Flown[arb]) -> Met | None:
    """The time until a flight of midpoints meets something round, and the two then; None where that is not told."""
    fall = state.peg_fall_at_clock(link, flight)
    wait = zero_beside(fall, window.wait)
    return None if wait is None else (wait, fall.after(wait))


def zero_beside(fall: RoundFall[arb], start: arb) -> arb | None:
    """The zero of |d + v s - h s^2| - R beside a time, by Newton's rule, to the working precision; None if not told.

    Each step is with twice the bits of the one before. The last is that of interval Newton, with a slope of half as
    many, which proves that there is a zero: so nothing has to be known of the steps before.

    Args:
        fall: the two at the time 0.
        start: an interval in which the zero is, or beside it.

    >>> from truebreak.exact.numbers.ball import precision
    >>> with precision(2000):
    ...     fall = RoundFall(*map(arb, (0, 4, 0, -1, 0, "0.5", 1)))
    ...     zero = zero_beside(fall, arb("1.64575131106459059050161575363 +/- 1e-29"))
    ...     off = abs(zero + 1 - arb(7).sqrt())
    >>> zero.rel_accuracy_bits() > 1900, off.contains(0), zero_beside(fall, arb(-1)) is None
    (True, True, True)
    """
    bits = bits_in_use()
    half = bits // 2 + GUARD_BITS
    steps, s = [half], start.mid()
    while steps[-1] > 2 * BRIEF_BITS:
        steps.append(steps[-1] // 2 + GUARD_BITS)
    for step in reversed(steps):
        use_bits(step)
        there = fall.after(s)
        slope = there.approach()
        s = (s - there.gap() / (slope + slope)).mid()
    use_bits(bits)
    there = fall.after(s)
    gap = there.gap()
    use_bits(half)
    slope = there.approach()
    wide = s + arb(0, 2) * (gap / slope).abs_upper()
    slope = fall.after(wide).approach()
    use_bits(bits)
    zero = s - gap / (slope + slope)
    return zero if wide.contains_interior(zero) else None


# -- The same in fractions, where the gap of a contact is a polynomial of them: by its factors, and common divisors.


class ExactMoment(NamedTuple):
    """A zero of a polynomial of the time with fractions for coefficients: it has no double zero, and this one alone
    between two times."""

    factor: fmpq_poly
    low: fmpq
    high: fmpq


def gap_in_fractions(state: Flights[FieldNumber], link: Link) -> tuple[fmpq, list[fmpq]] | None:
    """The clock of a contact, and its gap as a polynomial of the time from then on; None where these are no fractions,
    or where the gap is not above zero as the flight begins, nor zero and divided out."""
    try:
        if is_flat(link):
            flight = state.bodies[link.circle].flight
            if state.falling is None or state.scene.gravity is None or link.wall in state.drifts:
                return None
            fall = state.fall(state.falling, link)
            clock, found = flight.t, [fall.gap, fall.approach, fall.half]
            found = found[1:] if fall.gap == 0 else found  # as after a bounce
        elif state.on_peg(link):
            clock = state.faller(link).flight.t
            found = [*gap_of(link, state.peg_fall(link), state.stood(link))]
        else:
            clock, dx, dy, vx, vy, reach = state.relation(link)
            along = pair_approach(dx, dy, vx, vy)
            found = [pair_gap(dx, dy, reach), along + along, vx * vx + vy * vy]
    except LeavesField:
        return None
    while len(found) > 1 and found[-1] == 0:
        found.pop()
    fractions = [value for value in (clock, *found) if isinstance(value, fmpq)]
    if len(fractions) <= len(found) or not fractions[1] > 0:
        return None
    return fractions[0], fractions[1:]


def passes(state: Flights[FieldNumber], link: Round) -> bool | None:
    """Whether two whose gap is a polynomial of fractions that never falls through zero graze each other, True, or miss,
    False, which its factors tell; None where they may hit. Two points that graze do, and there is no normal."""
    known = gap_in_fractions(state, link)
    found = None if known is None else falling_zero_exactly(known[1])
    if known is None or not isinstance(found, bool):
        return None
    return None if found and field_sign(state.reach(*link.ends(state))) == 0 else found


class DoubleZero(NamedTuple):
    """p + q sqrt(D), of fractions; q is 0, 1 or -1."""

    p: fmpq
    q: int
    square: fmpq

    def in_ball(self) -> arb:
        """To the bits at hand."""
        return arb(self.p) + self.q * arb(self.square).sqrt() if self.q else arb(self.p)


def double_zeros_exactly(c: Sequence[fmpq]) -> list[DoubleZero]:
    """The positive double zeros, or fourfold, of a polynomial of degree at most 4, in order.

    >>> double_zeros_exactly([fmpq(4), fmpq(-12), fmpq(13), fmpq(-6), fmpq(1)])
    [DoubleZero(p=1, q=0, square=0), DoubleZero(p=2, q=0, square=0)]
    >>> double_zeros_exactly([fmpq(4), fmpq(0), fmpq(-4), fmpq(0), fmpq(1)])
    [DoubleZero(p=0, q=1, square=2)]
    """
    found: list[DoubleZero] = []
    for twice, times in fmpq_poly(list(c)).numer().factor()[1]:
        low, middle, high = (fmpq(int(twice[k])) for k in range(3))
        if times % 2:
            continue
        if twice.degree() == 1:
            found.append(DoubleZero(-low / middle, 0, fmpq(0)))
        elif twice.degree() == 2:
            p, both = -middle / (2 * high), low / high
            if p * p > both:
                found += [DoubleZero(p, -1, p * p - both)] * (p > 0 and both > 0)
                found += [DoubleZero(p, 1, p * p - both)] * (p > 0 or both < 0)
    return sorted(zero for zero in found if zero.q or zero.p > 0)


def grazes_of(state: Flights[FieldNumber], link: Round) -> list[DoubleZero]:
    """When two graze that `passes` says do, in order."""
    known = gap_in_fractions(state, link)
    assert known is not None, "two that graze have a gap in fractions: a defect"
    return [zero._replace(p=zero.p + known[0]) for zero in double_zeros_exactly(known[1])]


def begins_at(face: Wall, end: Circle) -> bool:
    """Whether a face of a segment begins or ends beside the middle of an end: at right angles to it.

    >>> begins_at(Wall(0, 1, 4, 1), Circle(4, 0, m="oo")), begins_at(Wall(0, 1, 4, 1), Circle(3, 0, m="oo"))
    (True, False)
    """
    nx, ny = face.normal
    across = ((end.x - x) * ny - (end.y - y) * nx for x, y in ((face.x0, face.y0), (face.x1, face.y1)))
    return any(value.sign() == 0 for value in across)


def joints_at(scene: Scene, end: int) -> list[tuple[int, int]]:
    """The pairs of faces on one line of which one ends, and the other begins, at an end that stands."""
    there, walls = scene.circles[end], scene.walls
    faces: range = scene.faces
    near = [k for k in faces if not scene.moving_ends and begins_at(walls[k], there)]
    found: list[tuple[int, int]] = []
    for one, other in combinations(near, 2):
        (nx, ny), (mx, my) = walls[one].normal, walls[other].normal
        along = (nx * my - ny * mx).sign() == 0 < (nx * mx + ny * my).sign()
        starts = [((there.x - walls[k].x0) * ny - (there.y - walls[k].y0) * nx).sign() == 0 for k in (one, other)]
        found += [(one, other)] * (along and starts[0] is not starts[1])
    return found


def face_gone_onto(state: Flights[FieldNumber], link: Round) -> int | None:
    """The face onto which a circle may go that grazes an end: it begins there, and does not pull it away.

    Beside the end its gap to that face is zero, too, and falls: neither gap does so through zero, and yet it would go
    into the face. Both are told of one moment by the common divisor of two polynomials.
    """
    scene = state.scene
    circle, end = (next((i for i in link.circles if (i in scene.ends) is wanted), None) for wanted in (False, True))
    known = gap_in_fractions(state, link)
    if circle is None or end is None or known is None:
        return None
    whole = fmpq_poly(known[1])
    fall, twice, there = state.peg_fall(link), whole.gcd(whole.derivative()), scene.circles[end]
    for k, face in enumerate(scene.walls):
        beside = k in scene.faces and (face.vx, face.vy) == there.drift and begins_at(face, there)
        if not beside or state.sides.pull(circle, k) >= 0:
            continue
        nx, ny = (state.constant(part) for part in face.normal)
        along = [ny * x - nx * y for x, y in ((fall.dx, fall.dy), (fall.vx, fall.vy), (-fall.hx, -fall.hy))]
        told = [value for value in along if isinstance(value, fmpq)]
        if len(told) < len(along) or twice.gcd(fmpq_poly(told)).degree() > 0:
            return k
    return None


def exact_moment(state: Flights[FieldNumber], link: Link, graze: bool = False) -> ExactMoment | None:
    """When a contact that is certain to come does, as a zero of a polynomial of fractions; None where it is none.

    Of part of an arc, where that need not be the first zero, nothing is said; nor of a graze that is not the only one.
    """
    if not is_flat(link) and is_arc(link) and not state.scene.arc_sides[link.arc].full:
        return None
    known = gap_in_fractions(state, link)
    if known is not None and graze:
        (clock, c), back = known, fmpq_poly([-known[0], 1])
        if len(double_zeros_exactly(c)) != 1:
            return None
        factors = fmpq_poly(c).numer().factor()[1]
        twice = next(f for f, n in ((fmpq_poly(f), n) for f, n in factors) if n % 2 == 0 and first_zero_exactly(f))
        low, high = first_zero_exactly(twice) or (clock, clock)
        return ExactMoment(twice(back), low + clock, high + clock)
    found = False if known is None else falling_zero_exactly(known[1])
    if known is None or isinstance(found, bool):
        return None
    clock = known[0]
    return ExactMoment(found.factor(fmpq_poly([-clock, 1])), found.low + clock, found.high + clock)


def order_exactly(one: ExactMoment, other: ExactMoment) -> int:
    """Whether a zero comes before (negative), with (zero) or after (positive) another: with it where a common divisor
    of their polynomials has a zero between the bounds of both.

    >>> two, same = fmpq_poly([-2, 0, 1]), fmpq_poly([-6, -2, 3, 1])
    >>> order_exactly(ExactMoment(two, fmpq(1), fmpq(3)), ExactMoment(same, fmpq(0), fmpq(2)))
    0
    >>> order_exactly(ExactMoment(two, fmpq(1), fmpq(3)), ExactMoment(fmpq_poly([-2, 1]), fmpq(1), fmpq(5)))
    -1
    """
    common = one.factor.gcd(other.factor)
    while True:
        low, high = max(one.low, other.low), min(one.high, other.high)
        if not low < high:
            return -1 if one.high <= other.low else 1
        if common.degree() > 0 and common(low) * common(high) < 0:
            return 0
        one, other = (ExactMoment(each.factor, *halved(each.factor, each.low, each.high)) for each in (one, other))


# -- The same in numbers that answer at once.

SHARPENINGS = 8
"""Steps of Newton's rule after doubles, each of which doubles the bits: enough for all that there are."""

LONGER = 4.0
"""A step that is so much longer than the one before is of the rounding of gaps, as where two all but graze."""

MOST_ZEROS = 4
"""A quartic has no more."""


NEARER = 16.0
"""Up to how many times the least time at which its first coefficient may be outweighed a zero is looked for nearby."""

NARROW, CLOSE = 2**24, 2**60
"""To what share of itself a zero is told of ends in doubles, where these part it from another so well, and exactly."""


def first_zero_after(since: float, constant: float, slope: float, half: float) -> float:
    """The first zero of constant + slope t + half t^2 after a time, in doubles; infinite where there is none.

    >>> first_zero_after(0.0, 4.0, 0.0, -1.0), first_zero_after(2.0, 4.0, 0.0, -1.0)
    (2.0, inf)
    """
    within = slope * slope - 4 * half * constant
    if within < 0.0:
        return inf
    sum_of = -slope - copysign(sqrt(within), slope)
    zeros = [sum_of / (2 * half)] if half else []
    zeros += [2 * constant / sum_of] if sum_of else []
    return min((zero for zero in zeros if zero > since), default=inf)


def told_falling_zero(c: Sequence[float]) -> float | None:
    """A double beside the first falling zero of the polynomial with these very coefficients; None where none falls.

    However near to 0 that is: right after a bounce, which may be the last of many, there is no bound to it.

    >>> told_falling_zero([2.0, 0.0, -1.0]), told_falling_zero([1.0, 0.0, -2.0, 0.0, 1.0])
    (1.414213562373095, None)
    >>> told_falling_zero([1e-100, -10.0, 0.0, 1.0])
    1e-101
    """
    if not all(map(isfinite, c)) or not c[0] > 0.0:
        return None
    found, unit = falling_zero(c, [0.0] * len(c)), 0
    if isinstance(found, Unclear):
        (_, first), *rest = map(frexp, c)
        unit = min(((first - power) // k for k, (share, power) in enumerate(rest, 1) if share), default=0)
        scaled = [ldexp(x, unit * k - first) for k, x in enumerate(c)]  # in units of time that make all 1 at most
        found = falling_zero(scaled, [SMALLEST if x else 0.0 for x in c], NEARER) or found
    if found is None:
        return None
    if isinstance(found, Isolated):
        low, high = float(found.low), float(found.high)  # pyright: ignore[reportArgumentType]
        if (high - low) * NARROW < high:
            return ldexp(0.5 * (low + high), unit)
    exact = falling_zero_exactly([fmpq(*value.as_integer_ratio()) for value in c])
    if isinstance(exact, bool):
        return None
    low, high = exact.low, exact.high
    while (high - low) * CLOSE > high:
        low, high = halved(exact.factor, low, high)
    return int(high.p) / int(high.q)


def told_wait(state: Flights[M], link: Round) -> M | None:
    """The time to the hit of a circle that falls onto something round that stands; None where it does not.

    Which zero of the quartic that is, is told of its coefficients in doubles, as they are; then it is sharpened in
    the state's own numbers. Two that rounding has put into each other collide at once where they approach, and
    else meet again as if they touched.
    """
    fall, stood, hollow = state.peg_fall(link), state.stood(link), link.hollow
    still, approach = fall.gap(), fall.approach()
    if hollow:
        still, approach = -still, -approach
    if stood == 1 and is_pair(link) and approach < state.zero:  # a push that rounding has left without effect
        return state.zero
    if not stood and not still > state.zero and _is_put_into(state, link, fall):
        if approach < state.zero and can_push(link):
            return state.zero
        stood = 1
    for found in _told_zeros([float(value) for value in gap_of(link, fall, stood)]):  # pyright: ignore[reportArgumentType]
        wait, far = state.constant(Quantity.of(found)), False
        # a circle that a push has left in another, deeper than rounding, has no zero there: then the first step is long
        step = inf if stood and (is_pair(link) or not _is_beside(fall, fall.after(wait))) else found / LONGER**5
        for _ in range(SHARPENINGS):
            then = fall.after(wait)
            slope = then.approach() + then.approach()
            gap = then.gap() if not stood else then.gap() - fall.gap()
            if not (slope > state.zero if hollow else slope < state.zero):
                break
            better = wait - gap / slope
            if not better > state.zero or not (better < wait or better > wait):
                break
            before, step = step, abs(float(better - wait))  # pyright: ignore[reportArgumentType]
            if step > LONGER * max(before, 2.0**-42 * float(wait)):  # pyright: ignore[reportArgumentType]
                break
            far = bool(better + better + better < wait + wait or better > wait + wait)
            wait = better
        then = fall.after(wait)
        if far and abs(float(then.gap())) > float(fall.reach * fall.reach) / 2:  # pyright: ignore[reportArgumentType]
            continue  # what has been divided out has left no zero here
        if not is_arc(link) or within_arc(state, link, then.dx, then.dy) > state.zero:
            return wait
    return None


def _is_beside(fall: RoundFall[M], then: RoundFall[M]) -> bool:
    """Whether a circle is still next to where it was: the rounding of places is more of gaps then than that of their
    polynomial's coefficients, once the zero at 0 is divided out."""
    way = max(abs(float(then.dx - fall.dx)), abs(float(then.dy - fall.dy)))  # pyright: ignore[reportArgumentType]
    return 16 * way < abs(float(fall.reach))  # pyright: ignore[reportArgumentType]


def _is_put_into(state: Flights[M], link: Round, fall: RoundFall[M]) -> bool:
    """Whether rounding has put two into each other whose gap is not above zero: of a side of an arc, that the middle of
    the circle is not through it, and within its range."""
    if not is_arc(link):
        return can_push(link)
    through = pair_gap(fall.dx, fall.dy, link.ends(state)[1].r)
    on_its_side = through < state.zero if link.hollow else through > state.zero
    return on_its_side and bool(faces_arc(state, link, fall.dx, fall.dy) > state.zero)


def _told_zeros(c: Sequence[float]) -> Iterator[float]:
    """Doubles beside the zeros at which a polynomial falls, in turn: beyond one it is divided out.

    >>> [[round(t, 9) for t in _told_zeros(c)] for c in ([-6.0, 11.0, -6.0, 1.0], [24.0, -50.0, 35.0, -10.0, 1.0])]
    [[2.0], [1.0, 3.0]]
    """
    since = 0.0
    for _ in range(MOST_ZEROS):
        while len(c) > 1 and c[0] == 0.0:  # at it now
            c = c[1:]
        falls = c[0] > 0.0
        found = told_falling_zero(c if falls else [-value for value in c])
        if found is None or found == inf:
            return
        since += found
        if falls:
            yield since
        c = _shifted(c, found)[1:]
        if len(c) < 2:
            return


def _shifted(c: Sequence[float], by: float) -> list[float]:
    """The coefficients of a polynomial of t as one of t - by."""
    found = [*c]
    for k in range(len(found) - 1):
        for j in range(len(found) - 2, k - 1, -1):
            found[j] += by * found[j + 1]
    return found
