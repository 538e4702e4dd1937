"""The falling zeros of a polynomial by Sturm's chains in fractions: shares no code or method with truebreak."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import pairwise
from math import gcd, lcm

Poly = list[Fraction]
"""Coefficients, the constant one first; the last is not zero."""


def trimmed(p: Poly) -> Poly:
    """Without leading zeros."""
    p = list(p)
    while p and p[-1] == 0:
        p.pop()
    return p


def whole(p: Poly) -> list[int]:
    """A positive multiple in whole numbers without a common factor."""
    common = lcm(*(x.denominator for x in p))
    found = [int(x * common) for x in p]
    shared = gcd(*found)
    return [x // shared for x in found]


def remainder(p: list[int], q: list[int]) -> list[int]:
    """A positive multiple of the remainder of p by q, without a common factor."""
    rest, square = list(p), q[-1] * q[-1]
    while len(rest) >= len(q):
        share = rest[-1] * q[-1]
        at = len(rest) - len(q)
        rest = [x * square for x in rest]
        for k, x in enumerate(q):
            rest[at + k] -= share * x
        rest.pop()
        while rest and rest[-1] == 0:
            rest.pop()
    shared = gcd(*rest)
    return [x // shared for x in rest] if rest else []


def chain_of(p: list[int]) -> list[list[int]]:
    """Sturm's chain."""
    chain = [p, [k * x for k, x in enumerate(p)][1:]]
    while len(chain[-1]) > 1:
        rest = remainder(chain[-2], chain[-1])
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


def sign_at(p: list[int], t: Fraction) -> int:
    """The sign of its value."""
    found, power = 0, 1
    for x in reversed(p):
        found = found * t.numerator + x * power
        power *= t.denominator
    return (found > 0) - (found < 0)


def changes(chain: list[list[int]], t: Fraction) -> int:
    """Changes of sign at t."""
    signs = [sign for p in chain if (sign := sign_at(p, t))]
    return sum(a != b for a, b in pairwise(signs))


def first_fall(c: Poly, width: Fraction) -> tuple[Fraction, Fraction] | None:
    """Where a polynomial, positive at 0, first falls through zero, to a width; None where it never does."""
    return next(falls(c, width), None)


def falls(c: Poly, width: Fraction) -> Iterator[tuple[Fraction, Fraction]]:
    """Where a polynomial, not zero at 0, falls through zero, each time to a width."""
    p = trimmed(c)
    if len(p) < 2:
        return
    q = whole(p)
    chain, top = chain_of(q), 1 + max(abs(x / p[-1]) for x in p[:-1])
    stack = [(Fraction(0), top, changes(chain, Fraction(0)), changes(chain, top))]
    while stack:
        low, high, before, after = stack.pop()
        if before == after:
            continue
        if before - after == 1:
            if sign_at(q, low) <= 0 or sign_at(q, high) >= 0:
                continue
            while high - low >= width:
                middle = (low + high) / 2
                sign = sign_at(q, middle)
                if sign == 0:
                    low, high = middle - width / 4, middle + width / 4
                    break
                low, high = (middle, high) if sign > 0 else (low, middle)
            yield low, high
            continue
        middle, share = (low + high) / 2, Fraction(1, 3)
        while sign_at(q, middle) == 0:
            middle, share = low + (high - low) * share, share / 2
        here = changes(chain, middle)
        stack += [(middle, high, here, after), (low, middle, before, here)]
