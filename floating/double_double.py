"""Numbers of 106 bits as unevaluated sums of two doubles.

The operations are those of T. J. Dekker, *A floating-point technique for extending the available precision*, Numerische
Mathematik 18 (1971), in the forms of Y. Hida, X. S. Li and D. H. Bailey, *Algorithms for quad-double precision floating
point arithmetic*, ARITH-15 (2001); each is off by a few units of 2**-104, relatively.
"""

from __future__ import annotations

from math import isfinite, sqrt

SPLITTER = 2.0**27 + 1.0


class DoubleDouble:
    """hi + lo, with |lo| at most half a unit in the last place of hi.

    >>> third = DoubleDouble(1.0) / DoubleDouble(3.0)
    >>> third.hi, third.lo
    (0.3333333333333333, 1.850371707708594e-17)
    >>> float(third * DoubleDouble(3.0) - DoubleDouble(1.0))
    0.0
    """

    __slots__ = ("hi", "lo")

    def __init__(self, hi: float, lo: float = 0.0) -> None:
        self.hi = hi
        self.lo = lo

    def __float__(self) -> float:
        return self.hi

    def __repr__(self) -> str:
        return f"DoubleDouble({self.hi!r}, {self.lo!r})"

    def __neg__(self) -> DoubleDouble:
        return DoubleDouble(-self.hi, -self.lo)

    def __add__(self, other: DoubleDouble) -> DoubleDouble:
        high, low = _two_sum(self.hi, other.hi)
        low_high, low_low = _two_sum(self.lo, other.lo)
        high, low = _quick_two_sum(high, low + low_high)
        return DoubleDouble(*_quick_two_sum(high, low + low_low))

    def __sub__(self, other: DoubleDouble) -> DoubleDouble:
        return self + DoubleDouble(-other.hi, -other.lo)

    def __mul__(self, other: DoubleDouble) -> DoubleDouble:
        high, low = _two_product(self.hi, other.hi)
        return DoubleDouble(*_quick_two_sum(high, low + (self.hi * other.lo + self.lo * other.hi)))

    def __truediv__(self, other: DoubleDouble) -> DoubleDouble:
        first = self.hi / other.hi
        if not isfinite(first):
            return DoubleDouble(first)
        rest = self - other * DoubleDouble(first)
        second = rest.hi / other.hi
        rest = rest - other * DoubleDouble(second)
        high, low = _quick_two_sum(first, second)
        return DoubleDouble(high, low) + DoubleDouble(rest.hi / other.hi)

    def sqrt(self) -> DoubleDouble:
        """The square root of a number that is not negative (Karp's form of Newton's step)."""
        if self.hi <= 0.0:
            return DoubleDouble(0.0)
        near = sqrt(self.hi)
        rest = self - DoubleDouble(*_two_product(near, near))
        return DoubleDouble(*_quick_two_sum(near, rest.hi / (2.0 * near)))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, DoubleDouble) and self.hi == other.hi and self.lo == other.lo

    def __hash__(self) -> int:
        return hash((self.hi, self.lo))

    def __lt__(self, other: DoubleDouble) -> bool:
        return self.hi < other.hi or (self.hi == other.hi and self.lo < other.lo)

    def __gt__(self, other: DoubleDouble) -> bool:
        return other < self

    def __le__(self, other: DoubleDouble) -> bool:
        return self < other or self == other

    def __ge__(self, other: DoubleDouble) -> bool:
        return other <= self


def _two_sum(a: float, b: float) -> tuple[float, float]:
    """a + b as the nearest double and its exact error (Knuth)."""
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


def _quick_two_sum(a: float, b: float) -> tuple[float, float]:
    """As `_two_sum`, where |a| >= |b| (Dekker)."""
    total = a + b
    return total, b - (total - a)


def _two_product(a: float, b: float) -> tuple[float, float]:
    """a * b as the nearest double and its exact error (Dekker, Veltkamp)."""
    product = a * b
    high_a, low_a = _split(a)
    high_b, low_b = _split(b)
    return product, ((high_a * high_b - product) + high_a * low_b + low_a * high_b) + low_a * low_b


def _split(a: float) -> tuple[float, float]:
    """A double as two of 26 bits each."""
    scaled = SPLITTER * a
    high = scaled - (scaled - a)
    return high, a - high
