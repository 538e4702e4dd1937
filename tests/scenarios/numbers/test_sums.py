"""Signs of sums with roots outside of the tower."""

from __future__ import annotations

from fractions import Fraction

import mpmath
import pytest
from hypothesis import given
from hypothesis import strategies as st
from towers import DIGITS, TINY, Pair, fresh, law, numbers

from truebreak.scenarios.numbers.tower_element import sign_of_root_sum


@law
@given(numbers(5, depth=1))
def test_sign_of_root_sum_agrees_with_400_digits(pairs: list[Pair]) -> None:
    (a, x), (b, y), (d1, u), (c, z), (d2, w) = pairs
    d1, d2 = abs(d1), abs(d2)
    with mpmath.workdps(DIGITS):
        u, w = abs(u), abs(w)
        u, w = (mpmath.mpf(0) if abs(k) < TINY else k for k in (u, w))
        total = x + y * mpmath.sqrt(u) + z * mpmath.sqrt(w)
        expected = 0 if abs(total) < TINY else (1 if total > 0 else -1)
    before = a.tower.generators
    assert sign_of_root_sum(a, b, d1, c, d2) == expected
    assert a.tower.generators == before


@law
@given(numbers(4, depth=1), st.sampled_from([0, 1, -1]))
def test_sign_of_root_sum_at_and_beside_exact_zeros(pairs: list[Pair], nudge: int) -> None:
    """-(b u + c v) + b sqrt(u**2) + c sqrt(v**2) is 0; with a nudge of 10**-200 it is not."""
    b, u, c, v = (e for e, _ in pairs)
    tower = b.tower
    a = -(b * abs(u) + c * abs(v)) + Fraction(nudge, 10**200)
    before = tower.generators
    assert sign_of_root_sum(a, b, u * u, c, v * v) == nudge
    assert tower.generators == before


@law
@given(numbers(3, depth=1), st.sampled_from([1, -1]))
def test_sign_of_root_sum_with_conjugate_roots(pairs: list[Pair], order: int) -> None:
    """k sqrt(d) - sqrt(k**2 d) = 0 and s (sqrt(p + q sqrt(d)))... with no rational root in sight."""
    (k, _), (d, _), (e, _) = pairs
    k, d = abs(k), abs(d)
    zero = k.tower.rational(0)
    one = k.tower.rational(order)
    assert sign_of_root_sum(zero, k * order, d, -one, k * k * d) == 0
    # 1 + |e| sqrt(d) = sqrt(1 + e**2 d + 2 |e| sqrt(d)) needs sqrt(d) in the field
    root = k.tower.sqrt(d)
    e = abs(e)
    assert sign_of_root_sum(one, e * order, d, -one, 1 + e * e * d + 2 * e * root) == 0
    larger = 1 + e * e * d + 2 * e * root + Fraction(1, 10**150)
    assert sign_of_root_sum(one, e * order, d, -one, larger) == -order


def test_sign_of_root_sum_refuses_negative_radicands() -> None:
    t = fresh()
    one = t.rational(1)
    with pytest.raises(ValueError, match="negative number -sqrt"):
        sign_of_root_sum(one, one, 1 - t.sqrt(2), one, one)
