"""Balls: midpoint and radius that enclose the exact value, through `flint.arb`."""

from __future__ import annotations

from math import inf, nan, nextafter

from flint import arb

from ...scenarios.numbers import precision as working
from ...scenarios.numbers.quantity import Quantity
from .undecided import Undecided

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
