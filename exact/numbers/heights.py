"""Numbers that are only measured: a bound on the height of each, and its exact value while that is short.

The height of an algebraic number x is the absolute logarithmic Weil height, here to base 2: for a rational
p/q in lowest terms, log2 max(|p|, |q|); for any x != 0 of a field of degree d, d times the height of x
bounds log2 of the numerator of the norm of x, and so tells how many primes can divide it.

Rules used (M. Waldschmidt, *Diophantine Approximation on Linear Algebraic Groups*, 2000, section 3.2):
h(x + y) <= h(x) + h(y) + 1, h(x y) <= h(x) + h(y), h(1 / x) = h(x), and h(x**2) = 2 h(x), so h(sqrt(x)) =
h(x) / 2.
"""

from __future__ import annotations

from collections.abc import Iterator

from flint import fmpz  # type: ignore[attr-defined]

from ...scenarios.tower import Element, Nested
from .field import FieldNumber

EXACT_BITS = 1024
"""Longest coefficients of an exact value that is kept; squares among longer numbers are not recognised."""

EXACT_TERMS = 8
"""Most terms of an exact value that is kept: products of longer sums would cost more than they tell."""


class Measured:
    """A number known by a bound on its height, the roots in it and, while that is short, its exact value.

    Attributes:
        height: a bound on its height.
        exact: its exact value, or None.
        roots: the numbered roots that it was computed from, as bits; an exact value has none.

    >>> from flint import fmpq
    >>> x = Measured.of(fmpq(3, 4)) + Measured.of(fmpq(5))
    >>> x.exact, x.height
    (23/4, 5)
    >>> y = Measured(100, roots=0b10)
    >>> (x * y).height, (x * y).roots
    (105, 2)
    """

    __slots__ = ("exact", "height", "roots")

    def __init__(self, height: int, exact: FieldNumber | None = None, roots: int = 0) -> None:
        self.height = height
        self.exact = exact
        self.roots = roots

    @staticmethod
    def of(value: FieldNumber, height: int | None = None) -> Measured:
        """A number from its exact value; an irrational one needs a bound on its height.

        Raises:
            ValueError: for an irrational number without such a bound.
        """
        if isinstance(value, Element):
            fraction = value.fraction()
            if fraction is None:
                if height is None:
                    raise ValueError(f"{value!r} is irrational; give a bound on its height")
                short = value.height_bits() <= EXACT_BITS and _terms(value) <= EXACT_TERMS
                return Measured(height, value if short else None)
            value = fraction
        bits = max(value.p.bit_length(), value.q.bit_length())
        return Measured(bits, value if bits <= EXACT_BITS else None)

    def __add__(self, other: Measured) -> Measured:
        height = self.height + other.height + 1
        if self.exact is None or other.exact is None:
            return Measured(height, None, self.roots | other.roots)
        return Measured.of(self.exact + other.exact, height)

    def __sub__(self, other: Measured) -> Measured:
        height = self.height + other.height + 1
        if self.exact is None or other.exact is None:
            return Measured(height, None, self.roots | other.roots)
        return Measured.of(self.exact - other.exact, height)

    def __mul__(self, other: Measured) -> Measured:
        height = self.height + other.height
        if self.exact is None or other.exact is None:
            for factor in (self, other):
                if factor.exact is not None and factor.exact == 0:
                    return factor
            return Measured(height, None, self.roots | other.roots)
        return Measured.of(self.exact * other.exact, height)

    def __truediv__(self, other: Measured) -> Measured:
        height = self.height + other.height
        if self.exact is None or other.exact is None:
            return Measured(height, None, self.roots | other.roots)
        return Measured.of(self.exact / other.exact, height)

    def __neg__(self) -> Measured:
        return Measured(self.height, None if self.exact is None else -self.exact, self.roots)

    def root(self, index: int) -> Measured:
        """The square root that has this number, without its exact value.

        >>> Measured(100, roots=0b1).root(2).height, Measured(100, roots=0b1).root(2).roots
        (50, 5)
        """
        return Measured((self.height + 1) // 2, None, self.roots | 1 << index)


def _terms(element: Element) -> int:
    return sum(1 for _ in masks_of(element))


def masks_of(element: Element) -> Iterator[int]:
    """The terms of an element by their roots of whole numbers: sets of the tower's base, as bits.

    >>> from truebreak.scenarios.tower import Tower
    >>> tower = Tower()
    >>> list(masks_of(tower.sqrt(2) + tower.sqrt(3) + 1))
    [1, 2, 0]
    """
    parts = [element.num]
    while parts:
        part = parts.pop()
        if isinstance(part, Nested):
            parts += [part.a, part.b]
        elif isinstance(part, fmpz):
            yield 0
        else:
            yield from part
