"""The numbers of certified runs: balls, the field of a scene, nested square roots."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from math import inf, nan, nextafter
from typing import Any, TypeAlias

from flint import arb, fmpq, fmpq_poly, fmpz

from ...scenarios.numbers import precision as working
from ...scenarios.numbers.nested_roots import Tower
from ...scenarios.numbers.precision import BITS_PER_DIGIT, decimals_of
from ...scenarios.numbers.quantity import Quantity, rational_root
from ...scenarios.numbers.tower_element import Element
from ...scenarios.numbers.tower_ring import TowerLimit
from ...scenarios.work import Work
from ..laws.formulas import advance
from .system import N, Undecided

# -- Balls: midpoint and radius that enclose the exact value, through `flint.arb`.

precision, use_bits, bits_in_use = working.at_bits, working.use_bits, working.bits_in_use
"""Flint's working precision: for a while, from now on, and which it is."""

ZERO = arb(0)

SHARP_BITS = 60
"""A time accurate to this many bits lies within 2**-58 of its midpoint, relatively."""

SLACK = 2.0**-50
"""Relative room left around the nearest double of such a midpoint: 2**-53 for the rounding to double, 2**-58 for
the ball, twice 2**-53 for the rounding of the bounds themselves; four times their sum is still less."""

LEAST_ROOM = 1e-290
"""Room below which doubles near their underflow would need a closer look."""


def sign_of(value: arb) -> int | None:
    """-1, 0 or +1 if every number in the ball has that sign, None if not: the one comparison of balls.

    >>> sign_of(arb(2)), sign_of(arb(0)), sign_of(arb("0 +/- 1"))
    (1, 0, None)
    """
    if value > ZERO:
        return 1
    if value < ZERO:
        return -1
    return 0 if value.is_zero() else None


def double_bounds(value: arb) -> tuple[float, float]:
    """Doubles at or below, and at or above, every number in a ball.

    >>> low, high = double_bounds(arb(1) / 3)
    >>> low < 1 / 3 < high
    True
    """
    if value.rel_accuracy_bits() > SHARP_BITS:
        middle = float(value)
        room = abs(middle) * SLACK
        if LEAST_ROOM < room < inf or value.is_zero():
            return middle - room, middle + room
    if not value.is_finite():
        return -inf, inf
    return nextafter(float(value.lower()), -inf), nextafter(float(value.upper()), inf)


def is_sharp(value: arb) -> bool:
    """Whether the double of a ball's middle is off by two roundings at most, whatever made the ball."""
    return value.rel_accuracy_bits() > SHARP_BITS


LOWEST_DOUBLE = 1100
"""Bits below which an unsigned value rounds to the double zero whatever its sign."""


def is_accurate(value: arb, bits: int) -> bool:
    """Whether so many bits of a number are told; of zero all are."""
    return value.rel_accuracy_bits() >= bits or value.is_zero()


def is_faint(value: arb, bits: int) -> bool:
    """Whether a number may be zero, and is told to so many bits beyond those of all doubles."""
    return value.contains(0) and bool(value.abs_upper() < arb(2) ** -(bits + LOWEST_DOUBLE))


def as_double(value: arb) -> float:
    """The double of a ball's middle; not a number, which meets no condition, where the ball is too wide for it.

    >>> as_double(arb(3)), as_double(arb("1 +/- 1e-9"))
    (3.0, nan)
    """
    return float(value) if is_sharp(value) else nan


def constant(q: Quantity) -> arb:
    """An exact number as a ball at the working precision."""
    return arb(q.rational) if q.rational is not None else q.ball(bits_in_use())


def root(value: arb) -> arb:
    """The square root of a number that is known not to be negative; its ball may touch zero.

    Where the ball reaches below zero, the root is enclosed by that of its non-negative part: sqrt is increasing,
    so [0, sqrt(upper)] holds it.
    """
    if value > ZERO:
        return value.sqrt()
    if value.is_zero():
        return value
    top = value.upper()
    if not top >= ZERO:
        return arb.nan()
    return ZERO.union(top.sqrt())


class Balls:
    """The system of balls: the functions above, as others ask for them."""

    constant = staticmethod(constant)
    root = staticmethod(root)
    bounds = staticmethod(double_bounds)

    def sign(self, value: arb) -> int:
        """The sign of every number in the ball.

        Raises:
            Undecided: where they differ.
        """
        sign = sign_of(value)
        if sign is None:
            raise Undecided("a ball on both sides of zero")
        return sign


BALLS = Balls()


# -- Balls as whole numbers, bit for bit, and how they pickle.

Parts: TypeAlias = tuple[int, int, int, int] | tuple[()]
"""Midpoint and radius as m, e, r, f: m * 2**e +/- r * 2**f. Nothing, for a ball that is not finite."""


def parts_of(ball: arb) -> Parts:
    """A ball as whole numbers.

    >>> parts_of(arb(3) / 4), float(from_parts(*parts_of(arb(3) / 4)))
    ((3, -2, 0, 0), 0.75)
    """
    if not ball.is_finite():
        return ()
    middle, radius = ball.mid().man_exp(), ball.rad().man_exp()
    return int(middle[0]), int(middle[1]), int(radius[0]), int(radius[1])


def from_parts(*parts: int) -> arb:
    """The ball of these parts, at any working precision; one that says nothing, for none."""
    if not parts:
        return arb.nan()
    m, e, r, f = parts
    middle, radius = (fmpz(m), fmpz(e)), arb((fmpz(r), fmpz(f)))
    wide = arb(middle, radius)
    if _is(wide.rad(), radius):
        return wide
    spare = RADIUS_BITS - r.bit_length()
    same = arb(middle, arb((fmpz((r << spare) - 1), fmpz(f - spare))))
    return same if _is(same.rad(), radius) else wide


RADIUS_BITS = 31
"""One more than a radius has: flint adds a unit in the last place to one that it takes, so it is given half of one
less. What comes of it is looked at, and the wider ball taken where it is not the one wanted."""


def _is(one: arb, other: arb) -> bool:
    """Whether two numbers without a radius are the same."""
    return bool(one == other)


def reduced(ball: arb) -> tuple[Callable[..., arb], Parts]:
    """What pickle keeps of a ball."""
    return from_parts, parts_of(ball)


# -- The field of a scene: rationals, with the square roots that the scene's own numbers are made of.

FieldNumber: TypeAlias = fmpq | Element
"""`flint.fmpq` while no root is about, else a tower's `Element`."""

Known: TypeAlias = arb | FieldNumber
"""A number as a certified run keeps it: exact where it is at hand exactly, else a ball."""

MAX_ROOTS = 4
"""Nested levels that a scene's constants may need for its runs to be kept in their field."""

BOUND_BITS = 64
"""Bits to which a number is enclosed for its bounds as doubles."""


class LeavesField(Exception):
    """A square root that is not in the field."""


class Field:
    """Constants and roots within the smallest field that holds a scene's numbers."""

    def __init__(self) -> None:
        self.tower = Tower(max_depth=MAX_ROOTS)

    def constant(self, q: Quantity) -> FieldNumber:
        """An exact number; its roots join the field.

        Raises:
            LeavesField: if the field would grow too deep.
        """
        if q.rational is not None:
            return q.rational
        try:
            element = q.in_tower(self.tower)
        except TowerLimit as limit:
            raise LeavesField from limit
        return _simplest(element)

    def root(self, value: FieldNumber) -> FieldNumber:
        """The square root of a number of the field.

        Raises:
            LeavesField: if it is not in the field, or the number is negative.
        """
        if isinstance(value, fmpq):
            if value < 0:
                raise LeavesField
            root = rational_root(value)
            if root is not None:
                return root
            if self.tower.depth == 0:
                raise LeavesField
            value = self.tower.rational(value)
        if value.sign() < 0:
            raise LeavesField
        within = self.tower.own_root(value)
        if within is None:
            raise LeavesField
        return _simplest(within)

    def leaves(self, value: FieldNumber) -> bool:
        """Whether the square root of a number, which is not negative, is in no field of rationals alone."""
        return isinstance(value, fmpq) and rational_root(value) is None

    def sign(self, value: FieldNumber) -> int:
        """Always decided."""
        return field_sign(value)

    def bounds(self, value: FieldNumber) -> tuple[float, float]:
        """See `NumberSystem.bounds`."""
        with precision(BOUND_BITS):
            return double_bounds(field_ball(value, BOUND_BITS))

    def element(self, value: FieldNumber) -> Element:
        """The number as an element of the tower."""
        return self.tower.rational(value) if isinstance(value, fmpq) else value


def _simplest(element: Element) -> FieldNumber:
    fraction = element.fraction()
    return element if fraction is None else fraction


def field_sign(value: FieldNumber) -> int:
    """-1, 0 or +1."""
    if isinstance(value, fmpq):
        return (value > 0) - (value < 0)
    return value.sign()


CONVERTED = 2.0**-51
"""Relative error of the double taken for a ball's middle, and of what is reckoned of its radius: more than both."""

SMALLEST = 1e-280
"""Absolute error of a coefficient besides, more than any underflow."""


def doubles_of(c: Sequence[arb]) -> tuple[list[float], list[float]]:
    """Doubles beside some balls, and bounds of how far off they are."""
    mids = [float(x.mid()) for x in c]
    off = [float(x.rad()) * (1 + CONVERTED) + abs(mid) * CONVERTED + SMALLEST for x, mid in zip(c, mids, strict=True)]
    return mids, [0.0 if x.is_zero() else error for x, error in zip(c, off, strict=True)]


def bits_of(c: Sequence[arb]) -> int:
    """How deep an interval may be parted: as far as the coefficients are known."""
    return 16 + min(bits_in_use(), max([0, *(x.rel_accuracy_bits() for x in c if not x.is_zero())]))


SQUARE_BITS = 512
"""Precision in which zeros of polynomials of fractions are told apart, and from the ends of a range."""


def falling_in_square_roots(c: Sequence[fmpq], within: Callable[[arb], int | None]) -> tuple[fmpq, int, fmpq] | None:
    """The first positive zero at which a polynomial falls through 0 within a range, as p + turn sqrt(square), with a
    turn of -1, 0 or 1; None where no factor of first or second degree has it, or balls do not tell which it is.

    Args:
        c: the coefficients, the constant one first.
        within: whether what is in a ball is within the range, as a sign.

    >>> falling_in_square_roots([fmpq(2), fmpq(0), fmpq(-3), fmpq(0), fmpq(1)], lambda t: 1)
    (1, 0, 0)
    >>> falling_in_square_roots([fmpq(6), fmpq(0), fmpq(-5), fmpq(0), fmpq(1)], lambda t: 1)
    (0, 1, 2)
    >>> falling_in_square_roots([fmpq(2), fmpq(3), fmpq(0), fmpq(-1)], lambda t: 1)
    (2, 0, 0)
    >>> falling_in_square_roots([fmpq(2), fmpq(0), fmpq(0), fmpq(-1)], lambda t: 1)
    """
    found: list[tuple[arb, fmpq_poly]] = []
    with precision(SQUARE_BITS):
        for factor, times in fmpq_poly([*c]).numer().factor()[1]:
            zeros: Any = factor.complex_roots()  # each with how often
            found += [(zero.real, fmpq_poly(factor)) for zero, _ in zeros if times % 2 and zero.imag == 0]
        found.sort(key=lambda zero: float(zero[0].mid()))
        if c[0] == 0 or not all(one < other for (one, _), (other, _) in pairwise(found)):
            return None
        falls = c[0] > 0
        for zero, f in ((zero, f) for zero, f in found if not zero < 0):
            side = within(zero) if falls else -1
            if not side or not zero > 0:
                return None
            if side > 0 and f.degree() == 1:
                return -f[0] / f[1], 0, fmpq(0)
            if side > 0:
                middle = -f[1] / (2 * f[2]) if f.degree() == 2 else fmpq(0)
                turn = sign_of(zero - middle)
                return (middle, turn, middle * middle - f[0] / f[2]) if f.degree() == 2 and turn else None
            falls = not falls
    return None


def sharpened(low: arb, high: arb, value: Callable[[arb], arb], slope: Callable[[arb], arb]) -> arb | None:
    """The falling zero that is the only one between two balls, to the working precision, by interval Newton; None where
    that is not told.

    Args:
        low, high: the balls.
        value, slope: the polynomial and its derivative, as enclosures.

    >>> zero = sharpened(arb(1.25), arb(1.5), lambda t: 2 - t * t, lambda t: -2 * t)
    >>> zero.rel_accuracy_bits() > 40, abs(zero * zero - 2) < 1e-14
    (True, True)
    """
    at = low.union(high)  # a ball about both ends is a little wider: where the slope is below 0, no zero more is in it
    while True:
        middle, fall, near = at.mid(), slope(at), None
        if fall < 0:
            near = middle - value(middle) / fall
            if not near.overlaps(at):
                return None
            near = near.intersection(at)
            if near.rad() < at.rad() * arb(0.25):
                at, low, high = near, near.lower(), near.upper()
                continue
        sign = sign_of(value(middle)) if low < middle < high else None  # where Newton's rule is slow, at is halved
        if not sign:
            return near
        low, high = (middle, high) if sign > 0 else (low, middle)
        narrower = low.union(high)
        if not narrower.rad() < at.rad() * arb(0.75):
            return near
        at = narrower


def field_ball(value: FieldNumber, bits: int) -> arb:
    """A ball around the number, at flint's working precision, which is `bits`."""
    return arb(value) if isinstance(value, fmpq) else value.ball(bits)


def known_ball(value: Known, bits: int) -> arb:
    """A ball around a number of a certified run, in at least so many bits where it is known exactly."""
    if isinstance(value, arb):
        return value
    with precision(bits):
        return field_ball(value, bits)


def height(value: FieldNumber) -> int:
    """Bits of the longest whole number in it."""
    return value.height_bits()


def field_text(value: FieldNumber) -> str:
    """The number's normal form as text: equal for equal numbers, and for no others, within one field."""
    return str(value) if isinstance(value, fmpq) else value.text()


# -- Nested square roots in normal form, within a depth and counted work.


class NestedNumbers:
    """The numbers of one tower.

    Args:
        max_depth: nested levels that it may have.
        work: what it may cost; both raise `TowerLimit` beyond.
    """

    def __init__(self, max_depth: int, work: Work) -> None:
        self.tower = Tower(max_depth=max_depth, work=work)

    def constant(self, q: Quantity) -> Element:
        """See `Arithmetic.constant`."""
        return q.in_tower(self.tower)

    def root(self, value: Element) -> Element:
        """See `Arithmetic.root`."""
        return self.tower.sqrt(value)

    def sign(self, value: Element) -> int:
        """Always decided."""
        return value.sign()

    def bounds(self, value: Element) -> tuple[float, float]:
        """See `NumberSystem.bounds`."""
        return double_bounds(value.ball(BOUND_BITS))


# -- What is computed of numbers at hand, and written in decimals.

GUARD_BITS = 32
"""Bits asked for beyond the digits wanted."""


def flown(x: Known, v: Known, time: Known, t: Known, bits: int) -> Known:
    """x + v (time - t) in the numbers at hand; see `combined`."""
    return combined(_advanced, (x, v, time, t), bits)


def combined(formula: Callable[..., Any], numbers: Sequence[Known], bits: int) -> Known:
    """A formula of numbers at hand: exact if they all are and share a field, else a ball of so many bits."""
    rational = [number for number in numbers if isinstance(number, fmpq)]
    if len(rational) == len(numbers):
        return formula(*rational)
    towers = {id(number.tower): number.tower for number in numbers if isinstance(number, Element)}
    if len(towers) == 1 and not any(isinstance(number, arb) for number in numbers):
        (tower,) = towers.values()
        return formula(*(tower.rational(n) if isinstance(n, fmpq) else n for n in numbers))
    with precision(bits):
        return formula(*(known_ball(n, bits) for n in numbers))


def _advanced(x: N, v: N, time: N, t: N) -> N:
    """x + v (time - t)."""
    return advance(x, v, time - t)


def element_in_decimals(value: Element, count: int) -> str:
    """A number in nested roots in decimals."""
    fraction, bits = value.fraction(), int(count * BITS_PER_DIGIT) + GUARD_BITS
    if fraction is not None:
        return fraction_in_decimals(fraction, count)
    while (told := decimals_of(value.ball(bits), count)) is None:  # it is irrational, so no rounding is a tie
        bits *= 2
    return told


def fraction_in_decimals(value: fmpq, count: int) -> str:
    """A fraction in decimals; half a unit of the last is rounded away from zero."""
    if value.q == 1 and len(str(value.p)) <= count:
        return str(value.p)
    with precision(int(count * BITS_PER_DIGIT) + 2 * GUARD_BITS + value.height_bits()):
        near = arb(value)
        told = decimals_of(near, count)
        return told or (near.upper() if value > 0 else near.lower()).str(count, radius=False)
