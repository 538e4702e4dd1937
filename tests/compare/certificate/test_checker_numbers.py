"""The checker's two kinds of number: intervals enclose, and remember what they were computed from."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import isqrt
from random import Random

import pytest

from truebreak.tools.verify import ROOTS, WORK, Ball, Exact, Undecided, number


@pytest.fixture(autouse=True)
def numbers_of_its_own() -> Iterator[None]:
    bits, Ball.bits = Ball.bits, 40
    Exact.roots, Exact.named, Exact.most, Exact.work, Exact.budget = [], [], ROOTS, 0, WORK
    yield
    Ball.bits = bits


def of(x: int | str | Fraction) -> Ball:
    return Ball.of(Exact(Fraction(x)))


def encloses(ball: Ball, value: Fraction) -> bool:
    return abs(value * 2**Ball.bits - ball.m) <= ball.r


def test_sums_products_and_quotients_enclose_what_they_are_of() -> None:
    draw = Random(1)
    for _ in range(300):
        values = [Fraction(draw.randrange(-99, 99), draw.randrange(1, 99)) for _ in range(3)]
        pairs = [(of(value), value) for value in values]
        for _ in range(12):
            (a, x), (b, y) = draw.choice(pairs), draw.choice(pairs)
            kind = draw.choice("+-*/")
            if kind == "/" and (b.sign() not in (-1, 1) or abs(y) < Fraction(1, 1000)):
                continue
            value = {"+": x + y, "-": x - y, "*": x * y, "/": x / y if y else x}[kind]
            if abs(value) < 10**6:
                pairs.append(({"+": a + b, "-": a - b, "*": a * b, "/": a / b if kind == "/" else a}[kind], value))
        for ball, value in pairs:
            assert encloses(ball, value) and ball.sign() in (None, (value > 0) - (value < 0))
            assert (ball - of(value)).zero() and not (ball - of(value + 1)).zero()


def test_square_roots_enclose_and_exact_ones_stay_exact() -> None:
    draw = Random(2)
    for _ in range(300):
        x = of(Fraction(draw.randrange(1, 9999), draw.randrange(1, 99)))
        x = x + Ball(0, draw.randrange(3) * draw.randrange(1 << 20))
        if x.sign() == 1:
            root, scale = x.sqrt(), 2**Ball.bits
            assert max(0, root.m - root.r) ** 2 <= (x.m - x.r) * scale and (x.m + x.r) * scale <= (root.m + root.r) ** 2
    assert (of("9/4").sqrt().m, of("9/4").sqrt().r) == (3 << 39, 0)
    with pytest.raises(Undecided):
        (of(1) - of(1)).sqrt()
    with pytest.raises(Undecided):
        of(1) / Ball(1, 1)


def test_what_is_exact_at_the_bits_stays_exact() -> None:
    half, third = of("1/2"), of("1/3")
    assert (half * half / of(4) + of(3)).r == 0 and third.r == 1
    assert (half - of("1/4") - of("1/4")).sign() == 0 and (third + third + third - of(1)).sign() is None
    assert (third + third + third - of(1)).zero()


def test_nested_roots_are_put_in_normal_form() -> None:
    two, three = of(2).sqrt(), of(3).sqrt()
    zeros = [
        two * three - of(6).sqrt(),
        (of(3) + two + two).sqrt() - of(1) - two,
        two + three - (of(5) + of(24).sqrt()).sqrt(),
        of(1) / (two - of(1)) - two - of(1),
    ]
    for zero in zeros:
        assert zero.sign() is None and zero.zero() and Exact.roots == []
    assert not ((of(3) + two).sqrt() - of(1) - two).zero()


def test_exact_numbers_are_bounded_in_work_and_roots() -> None:
    Exact.most = 1
    with pytest.raises(Undecided, match="too many roots"):
        (of(2).sqrt() + of(3).sqrt()).zero()
    Exact.budget = 50_000
    with pytest.raises(Undecided, match="too much work"):
        (of(2) * of(3) * of(5) * of(7) * of(11) * of(13)).zero()


def test_numbers_as_they_are_written() -> None:
    Exact.named.append(number("2").sqrt())
    read = number("-3/4+1/2*r1*r1-5*r1")
    assert read and not read - number("1/4") + number("5*r1")


def test_signs_of_nested_roots_are_told_however_near_they_are_to_zero() -> None:
    Exact.named.append(number("2").sqrt())
    Exact.named.append(number("3").sqrt())
    near = number(f"{isqrt(6 * 10**400)}/{10**200}") - number("1*r1*r2")
    assert (near.sign(), (-near).sign(), (near - near).sign()) == (-1, 1, 0)
    Exact.named.append(number("5+2*r1*r2").sqrt())
    assert not number("1*r3-1*r1-1*r2") and number("1*r3-1*r1").sign() == 1
