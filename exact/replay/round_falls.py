"""Circles that fall onto round things that stand: the zeros at which a quartic falls, in any numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from math import frexp, inf, isfinite, ldexp
from typing import Any, Generic, NamedTuple, NoReturn, TypeAlias

from flint import arb, fmpq, fmpq_poly

from ...scenarios.errors import NoClosedForm
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.numbers.tower_element import Element
from ...scenarios.numbers.tower_ring import TowerLimit
from ...scenarios.scene import Scene
from ..compiled import predictions
from ..laws.formulas import advance, arc_range, fall_discriminant, fall_time, fall_time_back
from ..numbers.ball import (
    SMALLEST,
    SQUARE_BITS,
    LeavesField,
    bits_in_use,
    bits_of,
    doubles_of,
    falling_in_square_roots,
    field_sign,
    known_ball,
    precision,
    sharpened,
    sign_of,
)
from ..numbers.system import N, horner, horner_slope
from .contact import (
    AtArc,
    Body,
    Flown,
    Gravity,
    Link,
    Relation,
    Round,
    is_arc,
    is_flat,
    is_pair,
    rims_at_start,
    touching_at_start,
)

# -- A disc that falls, d from its centre to that of something round and fixed, v the velocity of d, h half of gravity:
# after a time s their centres are d + v s - h s^2 apart, and the gap is a quartic. It is positive as the flight begins,
# or zero, right after a contact: then that zero is divided out, and a cubic is left. What is looked for is the first
# zero at which the gap goes from above 0 to below; a double zero is no such one, but a graze.
#
# In the Bernstein basis of [0, T] the coefficients of a polynomial bound it, and the changes of their signs count its
# zeros there, by an even number too many: none is none, one is one. Halving the interval (de Casteljau) ends, for a
# polynomial without double zeros, with one of both. Where a sign is not certain, nothing is said.

UNIT = 2.0**-53
"""Half the distance of doubles at 1: the greatest relative error of one rounding."""

LEAST, GREATEST = 1e-60, 1e60
"""Ends of intervals that doubles are used for: their fourth powers, times coefficients, neither vanish nor overflow."""

PRIMES = (
    131, 137, 139, 149, 151, 157, 163, 167, 173, 179, 181, 191, 193, 197, 199, 211, 223, 227, 229, 233, 239, 241, 251,
    257,
)  # fmt: skip
"""Ends of intervals are one of these times a power of 2: so all that they are halved to is exact in doubles, and a zero
that is a short fraction seldom lies at an end."""

DEEPEST = 40
"""Most halvings of an interval in doubles: 8 bits of a prime and 40 more are exact."""

MOST_PARTS = 200
"""Most intervals looked at in doubles."""


class Isolated(NamedTuple):
    """Where the first falling zero is, and no other zero: between two numbers, both doubles or both fractions."""

    low: float | fmpq
    high: float | fmpq


class Unclear(NamedTuple):
    """The first falling zero is not told from a graze, or from none; none comes before `since`."""

    since: float


Found = Isolated | Unclear | None
"""What is known of the first falling zero; None: there is none."""


def gap_quartic(dx: N, dy: N, vx: N, vy: N, hx: N, hy: N, reach: N) -> tuple[N, ...]:
    """|d + v s - h s^2|^2 - R^2 as a polynomial of s, the constant term first.

    >>> gap_quartic(0, -5, 0, 0, 0, -5, 1)
    (24, 0, -50, 0, 25)
    """
    along, fall, lift = dx * vx + dy * vy, dx * hx + dy * hy, vx * hx + vy * hy
    square = vx * vx + vy * vy
    return (
        dx * dx + dy * dy - reach * reach,
        along + along,
        square - (fall + fall),
        -(lift + lift),
        hx * hx + hy * hy,
    )


# -- In doubles, with one bound for all rounding.


def falling_zero(c: Sequence[float], off: Sequence[float], end: float = inf) -> Found:
    """The first zero in (0, end], or a little beyond, at which a polynomial falls from above zero.

    Every polynomial whose coefficients are off by no more than told has it there.

    Args:
        c: coefficients, the constant one first: at most five.
        off: bounds of their errors.
        end: what to look up to.

    >>> low, high = falling_zero((24.0, 0.0, -50.0, 0.0, 25.0), (0.0,) * 5)
    >>> 25 * (1 - low**2) ** 2 > 1 > 25 * (1 - high**2) ** 2, high - low < 1e-13
    (True, True)
    >>> falling_zero((24.0, 0.0, 50.0, 0.0, 25.0), (0.0,) * 5)
    >>> falling_zero((1.0, 0.0, -2.0, 0.0, 1.0), (0.0,) * 5).since < 1
    True
    """
    if predictions is not None:
        found = predictions.falling_zero(c, off, end)
        return Isolated(*found) if isinstance(found, tuple) else None if found is None else Unclear(found)
    if not (c[0] > off[0] and all(map(isfinite, c)) and all(map(isfinite, off))):
        return Unclear(0.0)
    begun = started(c, off, end)
    if not isinstance(begun, Started):
        return begun
    stack, parts = [(0.0, begun.top, begun.b, 0)], 0
    while stack:
        low, high, b, depth = stack.pop()
        changes = begun.changes(b, depth, 1)
        if changes == 0:
            continue
        if changes == 1:
            return sharpened_in_doubles(c, off, low, high)
        parts += 1
        if depth >= DEEPEST or parts > MOST_PARTS:
            return Unclear(low)
        stack += halves(low, high, b, depth)
    return None


Part: TypeAlias = tuple[float, float, list[float], int]
"""Times from one to another, Bernstein coefficients there, and after how many halvings."""


class Started(NamedTuple):
    """All times that matter: their end, coefficients, and how far these are off; `per`: more for each halving."""

    top: float
    b: list[float]
    base: float
    per: float

    def changes(self, b: list[float], depth: int, first: int) -> int | None:
        """How often signs change, after a first one; None where one of them is not certain."""
        off = self.base + self.per * depth
        signs = [(x > off) - (x < -off) for x in b]
        return None if 0 in signs else sum(one != other for one, other in pairwise((first, *signs)))


def started(c: Sequence[float], off: Sequence[float], end: float) -> Started | Unclear | None:
    """Where what looks for falling zeros begins; None: there are none."""
    last = last_zero(c, off)
    if last == 0.0:
        return None
    last = last if last < end else end
    if not LEAST < last < GREATEST:
        return Unclear(0.0)
    top, power = bernstein_end(last), 1.0
    size = slack = 0.0
    for value, error in zip(c, off, strict=True):
        size += abs(value) * power
        slack += error * power
        power *= top
    if not SMALLEST < size < 1 / SMALLEST:
        return Unclear(0.0)
    # A term c_j T^j is off by at most 5 roundings; a coefficient is a sum of at most five of them with weights of at
    # most 1, which are off by one, and as many roundings more: under 16 in all, of what `size` is. Each halving adds
    # at most as many as the degree, of numbers that are no larger. The bound allows four times that.
    return Started(top, _bernstein(c, top), 1.01 * slack + 64 * UNIT * size, 8 * UNIT * size)


def halves(low: float, high: float, b: list[float], depth: int) -> tuple[Part, Part]:
    """Both halves of a part, the later one first (de Casteljau)."""
    half, left, right = 0.5 * (low + high), [b[0]], [b[-1]]
    for _ in range(len(b) - 1):
        b = [(x + y) * 0.5 for x, y in pairwise(b)]
        left.append(b[0])
        right.append(b[-1])
    right.reverse()
    return (half, high, right, depth + 1), (low, half, left, depth + 1)


def last_zero(c: Sequence[float], off: Sequence[float]) -> float:
    """A double beyond all positive zeros (Kioustelidis, Fujiwara): 0 where there are none, infinite where unknown."""
    degree = len(c) - 1
    while degree and c[degree] == 0.0 == off[degree]:
        degree -= 1
    lead = abs(c[degree]) - off[degree]
    negative = [(k, off[k] - c[k]) for k in range(1, degree + 1) if not c[k] >= off[k]]
    if not negative:
        return 0.0
    if not lead > 0.0:
        return inf
    if c[degree] < 0.0:  # Fujiwara
        negative = [(k, abs(c[k]) + off[k]) for k in range(degree)]
    try:
        return 2.000001 * max((value / lead) ** (1.0 / (degree - k)) for k, value in negative)
    except OverflowError:
        return inf


def bernstein_end(last: float) -> float:
    """A prime times a power of 2, at least a double."""
    share, power = frexp(last)
    wanted = share * 256.0
    return ldexp(next(prime for prime in PRIMES if prime >= wanted), power - 8)


def _bernstein(c: Sequence[float], top: float) -> list[float]:
    """Bernstein coefficients on [0, top]: b_i = sum over j <= i of C(i, j) / C(n, j) c_j top^j."""
    terms, power = [0.0] * len(c), 1.0
    for j, value in enumerate(c):
        terms[j] = value * power
        power *= top
    found = [0.0] * len(c)
    for i, row in enumerate(WEIGHTS[len(c) - 1]):
        for w, s in zip(row, terms, strict=False):
            found[i] += w * s
    return found


def _weights(degree: int) -> list[list[fmpq]]:
    """C(i, j) / C(n, j) for j <= i."""
    rows = [[fmpq(1)] * (degree + 1) for _ in range(degree + 1)]
    for i, row in enumerate(rows):
        for j in range(1, i + 1):
            row[j] = row[j - 1] * fmpq(i - j + 1, degree - j + 1)
    return [row[: i + 1] for i, row in enumerate(rows)]


EXACT_WEIGHTS = [_weights(degree) for degree in range(5)]
WEIGHTS = [[[int(w.p) / int(w.q) for w in row] for row in rows] for rows in EXACT_WEIGHTS]


def _doubt(c: Sequence[float], off: Sequence[float], t: float) -> float:
    """How far `horner` may be off: Horner's rule by 2 n roundings of the sum of the terms' sizes, here twice that."""
    found = 0.0
    for value, error in zip(reversed(c), reversed(off), strict=True):
        found = found * t + (abs(value) * 16 * UNIT + error)
    return 1.01 * found


def sharpened_in_doubles(c: Sequence[float], off: Sequence[float], low: float, high: float) -> Isolated:
    """A shorter interval around the one zero of another, at whose ends the signs are certain, or which are its ends."""
    a, b = low, high
    t = 0.5 * (a + b)
    for _ in range(60):
        value, slope = horner(c, t), horner_slope(c, t)
        if value > 0.0:
            a = t
        else:
            b = t
        near = t - value / slope if slope else inf
        if not a < near < b:
            near = 0.5 * (a + b)
        done = abs(near - t) <= 4 * UNIT * t
        t = near
        if done:
            break
    slope = horner_slope(c, t)
    if slope >= 0.0:
        return Isolated(low, high)
    width = 2.0 * _doubt(c, off, t) / -slope + 4 * UNIT * t
    for _ in range(8):
        x, y = max(low, t - width), min(high, t + width)
        if (x == low or horner(c, x) > _doubt(c, off, x)) and (y == high or horner(c, y) < -_doubt(c, off, y)):
            return Isolated(x, y)
        width *= 4.0
    return Isolated(low, high)


# -- In balls, and in fractions: the same, with signs that are certain or None.

SPLITS = (fmpq(1, 2), fmpq(3, 7), fmpq(4, 7), fmpq(5, 11), fmpq(6, 11))
"""Where an interval is parted: at most four of five places are zeros."""


def falling_zero_in_balls(c: Sequence[arb], end: float = inf) -> Found:
    """As `falling_zero`, of balls at the working precision: in doubles where these tell it, else in balls.

    >>> falling_zero_in_balls([arb(2), arb(0), arb(-1)])
    Isolated(low=1.414213562373088, high=1.4142135623731018)
    """
    mids, exact = doubles_of(c)
    found = falling_zero(mids, exact, end)
    if not isinstance(found, Unclear) or not c[0] > 0:
        return found
    last = last_zero(mids, exact)
    if not last < end:
        last = end
    if not LEAST < last < GREATEST:
        return found
    return _isolated(c, fmpq(*bernstein_end(last).as_integer_ratio()), sign_of, bits_of(c))


def _isolated(c: Sequence[Any], top: fmpq, sign: Callable[[Any], int | None], most: int | None) -> Found:
    """The first falling zero in (0, top], by parting; `most` times at most."""
    kind: Callable[[Any], Any] = arb if isinstance(c[0], arb) else fmpq
    terms, power = [c[0]], fmpq(1)
    for value in c[1:]:
        power *= top
        terms.append(value * kind(power))
    b = [sum((kind(w) * s for w, s in zip(row, terms, strict=False)), kind(0)) for row in EXACT_WEIGHTS[len(c) - 1]]
    stack = [(fmpq(0), top, b, 0)]
    while stack:
        low, high, b, depth = stack.pop()
        signs = [sign(x) for x in b]
        if 0 not in signs[1:-1] and None not in signs and 0 not in (signs[0], signs[-1]):
            changes = sum(one != other for one, other in pairwise(signs))
            if not changes:
                continue
            if changes == 1:
                return Isolated(low, high)
        if most is not None and depth > most:
            return Unclear(float(low) * (1 - 2.0**-40))  # pyright: ignore[reportArgumentType]
        for share in SPLITS:
            left, right = parted(b, kind(share))
            if sign(left[-1]):
                break
        else:
            share = SPLITS[0]
            left, right = parted(b, kind(share))
        at = low + (high - low) * share
        stack.append((at, high, right, depth + 1))
        stack.append((low, at, left, depth + 1))
    return None


def parted(b: list[Any], share: Any) -> tuple[list[Any], list[Any]]:
    """The Bernstein coefficients of both parts of an interval (de Casteljau): means of what was, and no wider.

    >>> [round(float(part[-1].rad()), 6) for part in parted([arb(1, 1), arb(2, 1), arb(-1, 1)], arb(0.5))]
    [1.0, 1.0]
    """
    left, right, rest = [b[0]], [b[-1]], 1 - share
    while len(b) > 1:
        b = [x * rest + y * share for x, y in pairwise(b)]
        left.append(b[0])
        right.append(b[-1])
    right.reverse()
    return left, right


# -- Exactly, where coefficients are rational.


class ExactZero(NamedTuple):
    """A first falling zero of a polynomial of rational coefficients.

    Attributes:
        factor: a polynomial without double zeros, positive before the zero, that has it.
        low, high: it is between them, and no other zero of the factor.
        grazes: whether the polynomial has a double zero before.
    """

    factor: fmpq_poly
    low: fmpq
    high: fmpq
    grazes: bool


def falling_zero_exactly(c: Sequence[fmpq]) -> ExactZero | bool:
    """The first positive zero at which a polynomial, positive at 0, falls; without one, whether it grazes.

    >>> falling_zero_exactly([fmpq(1), fmpq(0), fmpq(-2), fmpq(0), fmpq(1)])
    True
    >>> zero = falling_zero_exactly([fmpq(2), fmpq(-3), fmpq(1)])
    >>> zero.low < 1 < zero.high, zero.grazes
    (True, False)
    """
    assert c[0] > 0
    odd, even = fmpq_poly([1]), fmpq_poly([1])
    for factor, times in fmpq_poly(list(c)).numer().factor()[1]:
        if times % 2:
            odd *= fmpq_poly(factor)
        else:
            even *= fmpq_poly(factor)
    odd, even = (poly if poly[0] > 0 else -poly for poly in (odd, even))
    found, touched = first_zero_exactly(odd), first_zero_exactly(even)
    if found is None:
        return touched is not None
    low, high = found
    while touched is not None and touched[0] <= high and low <= touched[1]:
        (low, high), touched = halved(odd, low, high), halved(even, *touched)
    grazes = touched is not None and touched[1] < low
    return ExactZero(odd, low, high, grazes)


def first_zero_exactly(poly: fmpq_poly) -> tuple[fmpq, fmpq] | None:
    """Where the first positive zero of a polynomial without double ones is."""
    degree = poly.degree()
    if degree < 1:
        return None
    c = [fmpq(poly[k]) for k in range(degree + 1)]
    top = fmpq(1) + max(abs(value / c[-1]) for value in c[:-1])
    found = _isolated(c, top, field_sign, None)
    assert not isinstance(found, Unclear)
    return None if found is None else (fmpq(found.low), fmpq(found.high))  # pyright: ignore[reportArgumentType]


def halved(poly: fmpq_poly, low: fmpq, high: fmpq) -> tuple[fmpq, fmpq]:
    """Half of an interval, or a little more, with the zero at which a polynomial changes sign there."""
    for share in SPLITS:
        at = low + (high - low) * share
        sign = field_sign(poly(at))
        if sign:
            return (at, high) if sign == field_sign(poly(low)) else (low, at)
    raise AssertionError("a polynomial has more zeros than its degree: a defect")


def fraction_at_which_it_falls(c: Sequence[Any]) -> tuple[fmpq, int, fmpq] | None:
    """As `falling_in_square_roots`, of a polynomial of any numbers, positive at 0: where it is a fraction."""
    from fractions import Fraction

    with precision(SQUARE_BITS):
        zero = falling_zero_in_balls(balls := [known_ball(value, SQUARE_BITS) for value in c])
        if not isinstance(zero, Isolated):
            return None
        low, high = (fmpq(*end.as_integer_ratio()) if isinstance(end, float) else end for end in zero)
        near = sharpened(arb(low), arb(high), lambda t: horner(balls, t), lambda t: horner_slope(balls, t))
    mantissa, power = (0, 0) if near is None else map(int, near.mid().man_exp())
    told = (Fraction(mantissa) * Fraction(2) ** power).limit_denominator(2 ** (SQUARE_BITS // 4)).as_integer_ratio()
    at = fmpq(*told)
    return (at, 0, fmpq(0)) if low < at < high and field_sign(horner(list(c), at)) == 0 else None


QUARTIC = "the time at which a circle falls onto something round, a zero of a quartic"
"""What has no closed form, in words."""

# -- The same in a state: which contacts it concerns, and where the two are.


class RoundFall(NamedTuple, Generic[N]):
    """A circle that falls and one that stands, at one time: d, its velocity, half of its fall (d + v s - h s^2), R."""

    dx: N
    dy: N
    vx: N
    vy: N
    hx: N
    hy: N
    reach: N

    def after(self, s: N) -> RoundFall[N]:
        """After a time."""
        bend_x, bend_y = self.hx * s, self.hy * s
        return RoundFall(
            self.dx + (self.vx - bend_x) * s,
            self.dy + (self.vy - bend_y) * s,
            self.vx - (bend_x + bend_x),
            self.vy - (bend_y + bend_y),
            *self[4:],
        )

    def gap(self) -> N:
        """|d|^2 - R^2."""
        return self.dx * self.dx + self.dy * self.dy - self.reach * self.reach

    def approach(self) -> N:
        """d.v: negative while the two come nearer."""
        return self.dx * self.vx + self.dy * self.vy

    def polynomial(self, stood: int) -> tuple[N, ...]:
        """The gap as a polynomial of the time; `stood`: as it is 0 now, with that zero, of such a fold, divided out."""
        return gap_quartic(self.dx, self.dy, self.vx, self.vy, self.hx, self.hy, self.reach)[stood:]


class RoundFalls(Generic[N]):
    """What of a state concerns round things that stand under gravity: circles, the sides of arcs, rims of pockets.

    Attributes:
        stands: whether there are any, or may be.
        pegs: the circles that do; and those that a wall carries, which fly straight, in true coordinates.
        paces: the velocities of those of the fixed ones that move.
        curved: whether anything pulls, so that flights are parabolas.
        contacts: for a circle that falls, what it touched when it was last pushed, each with the fold of the zero that
            the gap has there, and as of which step (see `Flight`).
    """

    scene: Scene
    zero: N
    one: N
    constant: Callable[[Quantity], N]
    root: Callable[[N], N]
    falling: Gravity[N] | None
    bodies: dict[int, Body[N]]
    pockets: list[Body[N]]
    arcs: list[Body[N]]
    stands: bool
    pegs: frozenset[int]
    paces: dict[int, tuple[N, N]]
    curved: bool
    contacts: dict[int, tuple[int, Mapping[Link, int]]]

    def reach(self, a: Body[N], b: Body[N]) -> N:
        """The sum of two radii."""
        raise NotImplementedError

    def on_peg(self, link: Link) -> bool:
        """Whether one of the two of a contact is round and stands under gravity, or is carried, and the other falls."""
        if is_pair(link):
            return (link.a in self.pegs) is not (link.b in self.pegs)
        return self.stands and not is_flat(link)

    def carried(self, link: Round) -> bool:
        """Whether neither of the two of a contact falls."""
        return self.pegs.issuperset(link.circles)

    def _stands_first(self, link: Round) -> bool:
        """Whether the first of a contact's two is the one that stands, a circle."""
        return is_pair(link) and link.a in self.pegs

    def faller(self, link: Round) -> Body[N]:
        """The other."""
        return self.bodies[link[1] if self._stands_first(link) else link[0]]

    def peg_relation(self, link: Round, flight: Flown[N] | None = None) -> Relation[N]:
        """The two at the clock of the one that falls, or of a flight that it is to have, in true coordinates."""
        body, first = self.faller(link), self._stands_first(link)
        peg = link.ends(self)[0 if first else 1]
        (x, y, vx, vy, t, *_), falling = flight or body.flight, self.falling
        assert falling is not None
        if not falling.bent:
            wx, wy = falling.hx * t, falling.hy * t
            x, y, vx, vy = x + wx * t, y + wy * t, vx + (wx + wx), vy + (wy + wy)
        px, py, pvx, pvy, since, *_ = peg.flight
        pace = self.paces.get(peg.index) if is_pair(link) else None
        if pace is not None:  # an end that moves, as seen from it
            px, py, vx, vy = px + pace[0] * t, py + pace[1] * t, vx - pace[0], vy - pace[1]
        elif not peg.flight.rest:  # what a wall carries
            px, py, vx, vy = advance(px, pvx, t - since), advance(py, pvy, t - since), vx - pvx, vy - pvy
        dx, dy = px - x, py - y
        reach = self.reach(body, peg)
        return Relation(t, -dx, -dy, vx, vy, reach) if first else Relation(t, dx, dy, -vx, -vy, reach)

    def peg_fall_at_clock(self, link: Round, flight: Flown[N] | None = None) -> RoundFall[N]:
        """As `peg_relation`."""
        falling = self.falling
        assert falling is not None
        first = self._stands_first(link)
        hx, hy = (-falling.hx, -falling.hy) if first else (falling.hx, falling.hy)
        _, dx, dy, vx, vy, reach = self.peg_relation(link, flight)
        return RoundFall(dx, dy, vx, vy, hx, hy, reach)

    def peg_fall(self, link: Round) -> RoundFall[N]:
        """The two at the instant from which the flight of the one that falls holds."""
        late, fall = self.faller(link).flight.late, self.peg_fall_at_clock(link)
        return fall if late is None else fall.after(late)

    def bent_relation(self, falling: Gravity[N], a: Body[N], b: Body[N]) -> Relation[N]:
        """Of two that fall, in true coordinates, where velocities change too until the later of the clocks."""
        f, g = a.flight, b.flight
        t = f.t if f.last >= g.last else g.t
        ax, ay, avx, avy = f[:4] if f.t is t else falling.flown(f[:4], t - f.t)
        bx, by, bvx, bvy = g[:4] if g.t is t else falling.flown(g[:4], t - g.t)
        return Relation(t, bx - ax, by - ay, bvx - avx, bvy - avy, self.reach(a, b))

    # -- contacts at gap zero as a flight begins

    def note_stood(self, links: Sequence[Link], fold: int = 1) -> None:
        """Told which contacts are at gap zero, at the instant at which their circles stand; some may not be held."""
        for link in links:
            for i in link.circles:
                if i in self.pegs or i not in self.bodies:
                    continue
                last, before = self.bodies[i].flight.last, self.contacts.get(i)
                mine = {other: fold for other in links if i in other.circles}
                self.contacts[i] = last, {**before[1], **mine} if before is not None and before[0] == last else mine

    def stood(self, link: Round) -> int:
        """Whether the two of a contact touch as the flight of the one that falls begins: the fold of that zero, or 0.

        Or whether that one then touches another part of the circle that an arc is of, which makes the gap zero too.
        """
        body = self.faller(link)
        last, (at, links) = body.flight.last, self.contacts.get(body.index, (-1, dict[Link, int]()))
        begun = links if at == last else dict[Link, int]()
        if last == 0:
            begun = {**dict.fromkeys((*touching_at_start(self.scene), *rims_at_start(self.scene)), 1), **begun}
        if link in begun or not is_arc(link):
            return begun.get(link, 0)
        return max((fold for other, fold in begun.items() if is_arc(other) and self._is_as_far(link, other)), default=0)

    def _is_as_far(self, link: AtArc, other: AtArc) -> bool:
        """Whether a circle is at two sides of arcs wherever it is at one: about one middle, and as far from it."""
        if link.circle != other.circle:
            return False
        sides, r = self.scene.arc_sides, self.scene.circles[link.circle].r
        one, two = sides[link.arc], sides[other.arc]
        return (one.x, one.y) == (two.x, two.y) and (one.r == two.r or (one.r + two.r + r + r).sign() == 0)

    # -- when they meet

    def peg_hit(self, link: Round) -> tuple[N, N]:
        """As `Flights.round_hit`: in closed numbers where it falls straight onto the middle, or the gap has factors.

        Raises:
            LeavesField, TowerLimit, NoClosedForm: by the kind of the numbers.
        """
        clock = self.faller(link).flight.t
        try:
            gap, approach, half = self.axial_fall(link)
        except (LeavesField, TowerLimit):
            p, turn, square = self._factored(link)
            return clock, p + turn * self.root(square)
        root = self.root(fall_discriminant(gap, approach, half))
        back = field_sign(half) < 0  # pyright: ignore[reportArgumentType]
        return clock, fall_time_back(approach, half, root) if back else fall_time(gap, approach, root)

    def peg_parts(self, link: Round) -> tuple[N, N, N]:
        """As `Flights.round_parts`, where `peg_hit` has a number."""
        clock = self.faller(link).flight.t
        try:
            gap, approach, half = self.axial_fall(link)
        except (LeavesField, TowerLimit):
            p, turn, square = self._factored(link)
            return clock + p, turn, square
        pull = half + half
        return clock - approach / pull, -(self.one / pull), fall_discriminant(gap, approach, half)

    def _factored(self, link: Round) -> tuple[N, N, N]:
        """The wait as p + turn sqrt(D): of a polynomial of fractions, where a factor of low degree has the zero; of any
        other, where that is a fraction.

        Raises:
            LeavesField, TowerLimit: where it is neither.
        """
        fall = self.peg_fall(link)
        found: list[Any] = [-value if link.hollow else value for value in fall.polynomial(self.stood(link))]
        known = [value.fraction() if isinstance(value, Element) else value for value in found]
        c = [value for value in known if isinstance(value, fmpq)]
        if len(c) == len(known):
            told = falling_in_square_roots(c, lambda wait: self._in_range(link, fall, wait))
        else:
            told = None if is_arc(link) or isinstance(self.zero, arb) else fraction_at_which_it_falls(found)
        zeros: Any = self.zero
        return zeros + (told or self.no_closed_form())[0], zeros + told[1], zeros + told[2]

    def _in_range(self, link: Round, fall: RoundFall[Any], wait: arb) -> int | None:
        """Whether a circle is within the range of an arc after a time, as a sign: see `landings.within_arc`."""
        if not is_arc(link) or self.scene.arc_sides[link.arc].full:
            return 1
        side, bits = self.scene.arc_sides[link.arc], bits_in_use()
        then = RoundFall(*(known_ball(value, bits) for value in fall)).after(wait)
        edge = side.h.ball(bits) * (-then.reach if link.hollow else then.reach)
        return sign_of(arc_range(then.dx, then.dy, side.nx.ball(bits), side.ny.ball(bits), edge))

    def axial_fall(self, link: Round) -> tuple[N, N, N]:
        """Of a circle that falls along the line through the middle of another: gap, approach, half of the pull.

        There d, v and h, half of gravity, are parallel, and |d + v s - h s^2| = R, times |h|, is of second degree.

        Raises:
            LeavesField, TowerLimit, NoClosedForm: as `peg_hit`, of any other.
        """
        if not is_pair(link) or not isinstance(self.zero, fmpq | Element):
            self.no_closed_form()
        dx, dy, vx, vy, hx, hy, reach = self.peg_fall_at_clock(link)
        along, speed, square = dx * hx + dy * hy, vx * hx + vy * hy, hx * hx + hy * hy
        aside = field_sign(dx * hy - dy * hx) or field_sign(vx * hy - vy * hx)  # pyright: ignore[reportArgumentType]
        side = field_sign(along)  # pyright: ignore[reportArgumentType]
        if aside or not side:
            self.no_closed_form()
        gap = (along if side > 0 else -along) - reach * self.root(square)
        approach, half = (speed, -square) if side > 0 else (-speed, square)
        if side < 0 and not (field_sign(approach) < 0 < field_sign(fall_discriminant(gap, approach, half))):  # pyright: ignore
            self.no_closed_form()
        return gap, approach, half

    def no_closed_form(self) -> NoReturn:
        """What a zero of a quartic is, in numbers that have square roots alone."""
        if isinstance(self.zero, fmpq):
            raise LeavesField
        if isinstance(self.zero, Element):
            raise TowerLimit(QUARTIC)
        raise NoClosedForm(f"{QUARTIC}, has no closed form in square roots: ask for `digits` or `ball`")
