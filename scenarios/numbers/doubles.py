"""Doubles: nearest to exact numbers, around balls, and as the numbers of a run."""

from __future__ import annotations

from math import inf, isfinite, isnan, nextafter

from flint import arb, fmpq

from .precision import at_bits

GUARD_BITS = 64
"""Bits beyond those of a ball's middle with which its ends are found."""

BITS_PER_DIGIT = 3.3219280948873626
"""log2(10)."""


class Double(float):
    """A double as a number of a run: the binary fraction that it is (see `Real`).

    >>> x = Double(0.1)
    >>> x == 0.1, x.text(), x.digits(25)
    (True, '3602879701896397/36028797018963968', '0.1000000000000000055511151')
    """

    __slots__ = ()

    def bounds(self) -> tuple[float, float]:
        """Itself twice."""
        return float(self), float(self)

    def text(self) -> str | None:
        """The fraction; None for nan and infinities.

        >>> Double(0.375).text(), Double(3).text()
        ('3/8', '3')
        """
        if not isfinite(self):
            return None
        numerator, denominator = self.as_integer_ratio()
        return str(numerator) if denominator == 1 else f"{numerator}/{denominator}"

    def digits(self, count: int) -> str:
        """The fraction in decimals, rounded to so many digits."""
        return digits_of(self.ball(64), count)

    def ball(self, bits: int) -> arb:
        """The double itself, whatever the precision asked for."""
        return arb(float(self))


def nearest_double(q: fmpq) -> float:
    """The double nearest to a rational, ties to even.

    Raises:
        OverflowError: if the rational is beyond the doubles.

    >>> from flint import fmpq
    >>> nearest_double(fmpq(1, 10))
    0.1
    """
    return int(q.p) / int(q.q)


def certain_double(value: arb) -> float | None:
    """The double nearest to every number in a ball, or None where the ball leaves a choice.

    >>> certain_double(arb(1) / 4), certain_double(arb("1 +/- 1e-10"))
    (0.25, None)
    """
    low, high = _nearest_to_ends(value)[:2]
    return low + 0.0 if low == high else None  # + 0.0: zero has no sign


def bounds_of(value: arb) -> tuple[float, float]:
    """Doubles at or below, and at or above, every number in a ball; the nearest that are.

    >>> bounds_of(arb(1) / 4), bounds_of(arb(2**60 + 1))
    ((0.25, 0.25), (1.152921504606847e+18, 1.1529215046068472e+18))
    """
    down, up, low, high = _nearest_to_ends(value)
    if isnan(down) or isnan(up):
        return -inf, inf
    if not arb(down) <= low:
        down = nextafter(down, -inf)
    if not arb(up) >= high:
        up = nextafter(up, inf)
    return down, up


def _nearest_to_ends(value: arb) -> tuple[float, float, arb, arb]:
    with at_bits(max(value.bits(), GUARD_BITS) + GUARD_BITS):
        low, high = value.lower(), value.upper()
        return float(low), float(high), low, high


def digits_of(value: arb, count: int) -> str:
    """The digits of a ball that are sure (the last may be off by one), at most so many; "" if none is.

    >>> digits_of(arb("0.123456 +/- 1e-4"), 10), digits_of(arb(2), 10), digits_of(arb("1 +/- 2"), 10)
    ('0.123', '2.000000000', '')
    """
    with at_bits(int(count * BITS_PER_DIGIT) + GUARD_BITS):
        text = value.str(count, radius=False)
    known = value.is_zero() or (value.is_finite() and text.partition("e")[0].strip("-0."))
    return text if known else ""


def decimals_of(value: arb, count: int) -> str | None:
    """The decimals, so many, to which every number of a ball is rounded; None where they differ.

    Two balls around one number tell the same, or nothing.

    >>> decimals_of(arb("0.123456 +/- 1e-9"), 4), decimals_of(arb("0.12345 +/- 1e-9"), 4), decimals_of(arb(0), 4)
    ('0.1235', None, '0')
    """
    if not value.is_finite() or (value.contains(0) and not value.is_zero()):
        return None
    with at_bits(max(value.bits(), int(count * BITS_PER_DIGIT)) + GUARD_BITS):
        low, high = value.lower().str(count, radius=False), value.upper().str(count, radius=False)
    return low if low == high else None


def hull(low: arb, high: arb) -> arb:
    """A ball around all from one number to another.

    >>> hull(arb(1), arb(2))
    [+/- 2.01]
    """
    with at_bits(max(low.bits(), high.bits()) + GUARD_BITS):
        return low.union(high)
