"""The first falling zero of a polynomial by Sturm's chains in fractions: shares no code or method with truebreak."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

Poly = list[Fraction]
"""Coefficients, the constant one first; the last is not zero."""


def trimmed(p: Poly) -> Poly:
    """Without leading zeros."""
    p = list(p)
    while p and p[-1] == 0:
        p.pop()
    return p


def divided(p: Poly, q: Poly) -> tuple[Poly, Poly]:
    """Quotient and remainder."""
    rest, found = list(p), [Fraction(0)] * max(len(p) - len(q) + 1, 0)
    for k in reversed(range(len(found))):
        found[k] = rest[k + len(q) - 1] / q[-1]
        for i, x in enumerate(q):
            rest[k + i] -= found[k] * x
    return found, trimmed(rest[: len(q) - 1])


def derivative(p: Poly) -> Poly:
    """The derivative."""
    return [k * x for k, x in enumerate(p)][1:]


def chain_of(p: Poly) -> list[Poly]:
    """Sturm's chain."""
    chain = [p, derivative(p)]
    while len(chain[-1]) > 1:
        rest = divided(chain[-2], chain[-1])[1]
        if not rest:
            break
        chain.append([-x for x in rest])
    return [one for one in chain if one]


def value(p: Poly, t: Fraction) -> Fraction:
    """Its value."""
    found = Fraction(0)
    for x in reversed(p):
        found = found * t + x
    return found


def changes(chain: list[Poly], t: Fraction) -> int:
    """Changes of sign at t."""
    signs = [x > 0 for p in chain if (x := value(p, t)) != 0]
    return sum(a != b for a, b in pairwise(signs))


def first_fall(c: Poly, width: Fraction) -> tuple[Fraction, Fraction] | None:
    """Where a polynomial, positive at 0, first falls through zero, to a width; None where it never does."""
    p = trimmed(c)
    if len(p) < 2:
        return None
    chain, top = chain_of(p), 1 + max(abs(x / p[-1]) for x in p[:-1])
    stack = [(Fraction(0), top, changes(chain, Fraction(0)), changes(chain, top))]
    while stack:
        low, high, before, after = stack.pop()
        if before == after:
            continue
        if before - after == 1:
            if value(p, low) <= 0 or value(p, high) >= 0:
                continue
            while high - low >= width:
                middle = (low + high) / 2
                sign = value(p, middle)
                if sign == 0:
                    return middle - width / 4, middle + width / 4
                low, high = (middle, high) if sign > 0 else (low, middle)
            return low, high
        middle, share = (low + high) / 2, Fraction(1, 3)
        while value(p, middle) == 0:
            middle, share = low + (high - low) * share, share / 2
        here = changes(chain, middle)
        stack += [(middle, high, here, after), (low, middle, before, here)]
    return None
