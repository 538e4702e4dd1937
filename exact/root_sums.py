"""Sums of two square roots, A + B*sqrt(D1) + C*sqrt(D2): what their conjugates tell without a root."""

from __future__ import annotations

from .machine import Number
from .questions import RootSum


def norm(a: Number, b: Number, d1: Number, c: Number, d2: Number) -> Number:
    """The product of the four numbers A +- B*sqrt(D1) +- C*sqrt(D2).

    It is E^2 - F^2 D1 with E = A^2 + B^2 D1 - C^2 D2 and F = 2 A B.

    >>> norm(3, 1, 4, -1, 25)
    0
    """
    e = a * a + b * b * d1 - c * c * d2
    f = (a + a) * b
    return e * e - f * f * d1


def conjugates(parts: RootSum) -> list[tuple[int, int]]:
    """Pairs (s, r): of the numbers A + s B*sqrt(D1) + r C*sqrt(D2), exactly one is zero if their product is.

    Two of them are zero together only if a term is zero, or if A is and both signs change; neither is in
    the list.

    >>> conjugates((5, 1, 2, 0, 0))
    [(1, 0), (-1, 0)]
    >>> conjugates((0, 1, 2, 3, 4))
    [(1, 1), (1, -1)]
    """
    a, b, d1, c, d2 = parts
    has_b, has_c = b != 0 and d1 != 0, c != 0 and d2 != 0
    signs_b = (1, -1) if has_b and not (has_c and a == 0) else (int(has_b),)
    signs_c = (1, -1) if has_c else (0,)
    return [(s, r) for s in signs_b for r in signs_c]
