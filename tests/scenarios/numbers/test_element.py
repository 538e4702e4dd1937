"""Laws of a tower: it is a field, and its zeros are zeros."""

from __future__ import annotations

import itertools
from fractions import Fraction

import mpmath
import pytest
from flint import arb, ctx, fmpq, fmpz
from hypothesis import given
from hypothesis import strategies as st
from towers import DIGITS, TINY, Pair, fresh, law, numbers, small


@law
@given(numbers(3))
def test_field_axioms(pairs: list[Pair]) -> None:
    (a, _), (b, _), (c, _) = pairs
    assert a + b == b + a
    assert a * b == b * a
    assert (a + b) + c == a + (b + c)
    assert (a * b) * c == a * (b * c)
    assert a * (b + c) == a * b + a * c
    assert a - a == 0
    assert (a - b) + b == a
    negative = -a
    assert -negative == a
    assert (a - b).is_zero() == (a == b)
    if not b.is_zero():
        assert b / b == 1
        assert a / b * b == a
        assert b**-2 * b * b == 1
    assert hash(a + b) == hash(b + a)


@law
@given(numbers(2), small)
def test_rational_operands_of_every_type(pairs: list[Pair], q: Fraction) -> None:
    a = pairs[0][0]
    e = a.tower.rational(q)
    for same in (q, fmpq(q.numerator, q.denominator)):
        assert a + same == same + a == a + e
        assert a - same == -(same - a) == a - e
        assert a * same == same * a == a * e
        if q:
            assert a / same == a / e
        if not a.is_zero():
            assert same / a == e / a
    assert a + 3 == a + fmpz(3)
    assert (a == q) == (a - e).is_zero()


@law
@given(numbers(2))
def test_sign_and_zero_agree_with_400_digits(pairs: list[Pair]) -> None:
    for (a, x), (b, y) in itertools.product(pairs, repeat=2):
        with mpmath.workdps(DIGITS):
            for e, value in ((a, x), (a + b, x + y), (a - b, x - y), (a * b, x * y)):
                expected = 0 if abs(value) < TINY else (1 if value > 0 else -1)
                assert e.sign() == expected
                assert e.is_zero() == (expected == 0)


@law
@given(numbers(1), st.sampled_from([10, 53, 200, 900]))
def test_ball_encloses_and_is_as_accurate_as_asked(pairs: list[Pair], bits: int) -> None:
    e, value = pairs[0]
    ball = e.ball(bits)
    assert ball.rel_accuracy_bits() >= bits
    with mpmath.workdps(DIGITS), ctx.workprec(1400):
        text = mpmath.nstr(value, DIGITS - 20)
        assert ball.overlaps(arb(text, arb(10) ** -340))


@law
@given(numbers(1))
def test_the_root_squares_to_its_radicand_and_is_not_negative(pairs: list[Pair]) -> None:
    e = abs(pairs[0][0])
    root = e.tower.sqrt(e)
    assert root * root == e
    assert root.sign() >= 0


@law
@given(numbers(1, depth=3))
def test_a_square_is_recognised_without_a_new_root(pairs: list[Pair]) -> None:
    e = pairs[0][0]
    tower = e.tower
    before = tower.generators
    assert tower.sqrt(e * e) == abs(e)
    assert tower.generators == before


@pytest.mark.parametrize("depth", range(5))
@pytest.mark.parametrize("seed", range(4))
def test_a_square_is_recognised_at_each_depth(depth: int, seed: int) -> None:
    tower = fresh()
    e = tower.rational(Fraction(seed + 1, 3))
    for k in range(depth):
        e = e * Fraction(seed + 1, k + 2) + tower.sqrt(e * e + 10 * k + seed + 5) - 1
    assert tower.depth == depth
    for f in (e, 3 * e - 1, e * e / 7 + 5, (e - 7) ** 3 if e != 7 else e):
        assert tower.sqrt(f * f) == abs(f)
    assert tower.depth == depth
