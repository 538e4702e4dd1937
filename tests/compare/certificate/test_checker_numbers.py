"""The checker's two kinds of number: intervals enclose, and forms are zero where the writer's exact numbers are."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from math import isqrt
from operator import add, mul, sub, truediv
from random import Random
from types import SimpleNamespace
from typing import Any, cast

import pytest

from truebreak.compare.certificate.prover import Prover
from truebreak.compare.certificate.tower import WORK, Exact, text_of
from truebreak.tools.verify import UNTOLD, Ball, Declined, Sum, Unsettled, cost, enclosed, number


@pytest.fixture(autouse=True)
def numbers_of_its_own() -> Iterator[None]:
    saved = Ball.bits, Ball.roots, Sum.squares, cost.work, cost.most
    Ball.bits, Ball.roots, Sum.squares, cost.work, cost.most = 40, [], [], 0, 1 << 40
    Exact.roots, Exact.most, Exact.work, Exact.budget = [], 16, 0, WORK
    yield
    Ball.bits, Ball.roots, Sum.squares, cost.work, cost.most = saved


def of(x: int | str | Fraction) -> Ball:
    return enclosed(Sum({frozenset(): Fraction(x)} if Fraction(x) else {}))


def exact(x: int | str) -> Exact:
    return Exact(Fraction(x))


def told(x: Exact) -> Sum:
    """A number of the writer as the checker reads it, with the roots that it takes."""
    for root in Exact.roots[len(Sum.squares) :]:
        Sum.squares.append(number(text_of(root)))
        Ball.roots.append(enclosed(Sum.squares[-1]).sqrt())
    return number(text_of(x))


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


def test_square_roots_enclose() -> None:
    draw = Random(2)
    for _ in range(300):
        x = of(Fraction(draw.randrange(1, 9999), draw.randrange(1, 99)))
        x = x + Ball(0, draw.randrange(3) * draw.randrange(1 << 20), Ball.bits)
        if x.sign() == 1:
            root, scale = x.sqrt(), 2**Ball.bits
            assert max(0, root.m - root.r) ** 2 <= (x.m - x.r) * scale and (x.m + x.r) * scale <= (root.m + root.r) ** 2
    with pytest.raises(Unsettled):
        (of(1) - of(1)).sqrt()
    with pytest.raises(Unsettled):
        of(1) / Ball(1, 1, Ball.bits)


def test_nothing_times_anything_is_nothing() -> None:
    assert (of(0) * of("1/3")).sign() == 0 == (of("1/3") * of(0) + of(0)).sign()
    assert of("1/3").sign() == 1 and (of("1/3") - of("1/3")).sign() is None


def test_forms_are_zero_where_exact_numbers_are() -> None:
    two, three = exact(2).sqrt(), exact(3).sqrt()
    nested = (exact(5) + two * three).sqrt()
    five, six = told(nested), told(two * three)
    assert five * five - six - number("5") == Sum() and len(Sum.squares) == 3
    assert told(nested / (two - exact(1))) * (number("1*r1") - number("1")) - five == Sum()
    assert told((exact(3) + two + two).sqrt()) == number("1+1*r1")
    draw = Random(3)
    for _ in range(200):
        a, b = ([exact(draw.randrange(-3, 4)) for _ in "abc"] for _ in "ab")
        x, y = (p + q * two + r * nested for p, q, r in (a, b))
        assert told(x * y + x) == told(x) * told(y) + told(x) and told(x - y) == told(x) - told(y)


def test_what_is_not_told_is_never_zero() -> None:
    one = number("1/3")
    for value in (UNTOLD - UNTOLD, UNTOLD * one - UNTOLD, UNTOLD + number("9" * 400)):
        assert value and value + one and -value
    assert UNTOLD * Sum() == Sum() == Sum() * UNTOLD


LAWS: tuple[Callable[[Any, Any], Any], ...] = (add, sub, mul, truediv)


@pytest.mark.parametrize("law", LAWS)
def test_all_that_is_computed_is_charged(law: Callable[[Any, Any], Any]) -> None:
    cost.work = cost.most
    with pytest.raises(Declined, match=r"costs more than \d+ units of work; --work=N"):
        law(Ball(2, 0, 64), Ball(3, 1, 64))
    one, other = Sum({frozenset(): Fraction(2)}), Sum({frozenset(): Fraction(3)})
    if law is not truediv:
        with pytest.raises(Declined):
            law(one, other)


@pytest.mark.parametrize("law", LAWS)
def test_numbers_of_unlike_bits_are_refused(law: Callable[[Any, Any], Any]) -> None:
    with pytest.raises(Unsettled, match="unlike bits"):
        law(Ball(2, 0, 64), Ball(3, 0, 65))


@pytest.mark.parametrize("bits", [1, 7, 40, 200])
def test_an_interval_is_zero_only_if_the_number_is(bits: int) -> None:
    """Whatever is computed, and rounded to fewer bits: what has no width is the number itself."""
    draw, exact_ones = Random(f"zero {bits}"), 0
    Ball.bits = bits
    for _ in range(400):
        pairs = [(of(x), x) for x in (Fraction(draw.randrange(-9, 10), draw.choice([1, 2, 3, 4])) for _ in "abc")]
        for _ in range(8):
            (a, x), (b, y) = draw.choice(pairs), draw.choice(pairs)
            law = draw.choice(LAWS)
            if law is truediv and (b.sign() not in (1, -1) or not y):
                continue
            found, value = law(a, b), law(x, y)
            fewer = found.at(draw.randrange(1, bits + 1))
            for ball in (found, fewer):
                assert ball.r or Fraction(ball.m, 1 << ball.bits) == value
                assert ball.sign() != 0 or value == 0
                exact_ones += ball.r == 0
            pairs.append((found, value))
    assert exact_ones > 400


def test_numbers_as_they_are_written() -> None:
    told(exact(2).sqrt())
    assert number("-3/4+1/2*r1*r1-5*r1") == number("1/4") - number("5*r1") and number("0-0*r1") == Sum()
    with pytest.raises(IndexError):
        number("1*r2")


def test_signs_of_nested_roots_are_told_however_near_they_are_to_zero() -> None:
    two, three = exact(2).sqrt(), exact(3).sqrt()
    near = Exact(Fraction(isqrt(6 * 10**400), 10**200)) - two * three
    assert (near.sign(), (-near).sign(), (near - near).sign()) == (-1, 1, 0)


def test_a_ball_with_fewer_bits_encloses_what_it_did_before() -> None:
    draw = Random(4)
    for _ in range(300):
        ball = Ball(draw.randrange(-(1 << 60), 1 << 60), draw.randrange(1 << draw.randrange(1, 60)), 40)
        bits = draw.randrange(1, 50)
        less = ball.at(bits)
        assert less.bits == min(bits, 40)
        drop = 40 - less.bits
        assert less.m - less.r <= Fraction(ball.m - ball.r, 1 << drop)
        assert Fraction(ball.m + ball.r, 1 << drop) <= less.m + less.r
    assert Ball(0, 0, 40).at(3).sign() == 0
    assert Ball(1, 0, 40).at(3).sign() is None


class Drawn:
    """Two flights in whole numbers, each known to some units, and a time that is; and what they truly are.

    Args:
        wall: whether the second is a wall, a place and a normal; else the two are circles, or the second is a pocket.
        told: how much of the errors is told.
    """

    def __init__(self, draw: Random, wall: bool, told: int) -> None:
        self.wall, self.told, self.sides = wall, told, {(0, 1): 1} if wall else {}
        size = draw.choice([30, 300])
        self.numbers = [[draw.randrange(-size, size) for _ in range(4)] + [draw.randrange(9)] for _ in "ab"]
        self.radii = [[draw.choice([0, 0, 1, 2]) for _ in range(5)] for _ in "ab"]
        self.span, self.off = Ball(draw.randrange(0, 9), draw.choice([0, 1]), 0), draw.choice([0, 1])
        self.true = [
            [m + Fraction(draw.randrange(-8 * r, 8 * r + 1), 8) for m, r in zip(*rows, strict=True)]
            for rows in zip(self.numbers, self.radii, strict=True)
        ]
        self.duration = self.span.m + Fraction(draw.randrange(-8 * self.span.r, 8 * self.span.r + 1), 8)

    def rough(self, k: int, _: int) -> tuple[int, ...]:
        """As `Remembering.rough`."""
        m, r = self.numbers[k], [self.told * x for x in self.radii[k]]
        far, fast = abs(m[0]) + abs(m[1]) + abs(m[4]), abs(m[2]) + abs(m[3])
        return (*m, far, r[0] + r[1] + r[4], fast, r[2] + r[3])

    def wait(self, *_: int) -> Ball:
        """How long it is."""
        return self.span

    def law(self, turn: int) -> tuple[Fraction, Fraction, Fraction]:
        """Gap, closing and speed as they are, from an instant on, or back."""
        (x, y, vx, vy, r), (u, v, p, q, s) = self.true
        if self.wall:
            return 2 * (p * (x - u) + q * (y - v) - r * s), turn * (vx * p + vy * q), Fraction(0)
        dx, dy, wx, wy = u - x, v - y, p - vx, q - vy
        return dx * dx + dy * dy - (r + s) ** 2, turn * (dx * wx + dy * wy), wx * wx + wy * wy


def belied(seed: str, told: int) -> int:
    """How often what a look says of two flights is not so."""
    draw, wrong, said = Random(seed), 0, 0
    checker = SimpleNamespace(n=0, bends={})
    for _ in range(20_000):
        wall, turn = draw.random() < 0.3, draw.choice([1, -1])
        drawn, checker.n = Drawn(draw, wall, told), 1 if wall else 2
        ends = [0, 1] if draw.random() < 0.7 else [0]
        sign, safe, falls = Prover.look(cast(Any, checker), drawn, (0, 1), 0, turn, ends)
        gap, closing, speed = drawn.law(turn)
        until = drawn.duration if len(ends) == 2 else None
        lowest = gap if closing >= 0 or until == 0 else _lowest(gap, closing, speed, until)
        said += sign == 1 and safe
        wrong += sign is not None and sign != (gap > 0) - (gap < 0)
        wrong += bool(sign == 1 and safe and lowest <= 0)
        wrong += bool(falls and not safe and not (closing < 0 and closing * closing > speed * gap))
    assert said > 1_000
    return wrong


def _lowest(gap: Fraction, closing: Fraction, speed: Fraction, until: Fraction | None) -> Fraction:
    """The least gap from now on, or up to a time; it falls now."""
    if speed == 0:
        return Fraction(-1) if until is None else gap + 2 * closing * until
    at = -closing / speed
    at = at if until is None or at < until else until
    return gap + 2 * closing * at + speed * at * at


@pytest.mark.parametrize("seed", ["look 1", "look 2"])
def test_what_a_look_at_two_flights_says_is_so(seed: str) -> None:
    assert belied(seed, 1) == 0 < belied(seed, 0)
