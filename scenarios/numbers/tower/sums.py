"""Signs of sums with roots that need not be in the tower."""

from __future__ import annotations

from typing import Final

from ..precision import at_bits
from .element import Element

FILTER_BITS: Final = (64, 128, 256)
"""Ball precisions that `sign_of_root_sum` tries before it computes in the field."""


def _sign_with_root(a: Element, b: Element, d: Element) -> int:
    """The sign of a + b sqrt(d), d >= 0, from signs in the field.

    If a and b sqrt(d) do not differ in sign, it is theirs. If they do, the one of the
    larger square wins, and the squares are a**2 and b**2 d.
    """
    p = a.sign()
    q = b.sign() if not d.is_zero() else 0
    if q in (0, p):
        return p
    if p == 0:
        return q
    return p * (a * a - b * b * d).sign()


def sign_of_root_sum(a: Element, b: Element, d1: Element, c: Element, d2: Element) -> int:
    """The sign of S = a + b sqrt(d1) + c sqrt(d2), exactly; adds no root to the tower.

    Balls decide what is plainly not zero. What is left is decided in the field. Write
    S = P + Q, P = a + b sqrt(d1), Q = c sqrt(d2). The sign of P is that of one root
    (`_sign_with_root`), the sign of Q is that of c, or 0 if d2 = 0. If P and Q are not of
    opposite sign, that is the sign of S. If they are, S P > 0 exactly if P**2 > Q**2, so
    sign S = sign P * sign(P**2 - Q**2), and
    P**2 - Q**2 = (a**2 + b**2 d1 - c**2 d2) + 2 a b sqrt(d1) has one root again.

    Raises:
        ValueError: if d1 or d2 is negative.

    >>> from truebreak.scenarios.numbers.tower import Tower
    >>> tower = Tower()
    >>> q = tower.rational
    >>> sign_of_root_sum(q(1), q(2), q(2), q(-1), 9 + 4 * tower.sqrt(2))
    0
    """
    for d in (d1, d2):
        if d.sign() < 0:
            raise ValueError(f"square root of the negative number {d.brief()}")
    for bits in FILTER_BITS:
        balls = [e.ball(bits) for e in (a, b, d1, c, d2)]
        with at_bits(bits):
            value = balls[0] + balls[1] * balls[2].sqrt() + balls[3] * balls[4].sqrt()
        if value > 0:
            return 1
        if value < 0:
            return -1
    p = _sign_with_root(a, b, d1)
    q = c.sign() if not d2.is_zero() else 0
    if q in (0, p):
        return p
    if p == 0:
        return q
    return p * _sign_with_root(a * a + b * b * d1 - c * c * d2, 2 * a * b, d1)
