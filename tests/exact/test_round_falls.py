"""First falling zeros of quartics, compared with Sturm's chains in fractions; planted faults are found first."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise
from typing import Any

import pytest
import sympy
from flint import arb, fmpq
from quartic_referee import Poly, first_fall, value

from truebreak.exact.numbers import ball
from truebreak.exact.replay import round_falls
from truebreak.exact.replay.round_falls import (
    ExactZero,
    Isolated,
    RoundFall,
    Unclear,
    falling_zero,
    falling_zero_exactly,
    falling_zero_in_balls,
    gap_quartic,
    sharpened,
    told_falling_zero,
)

WIDTH = Fraction(1, 2**220)
KINDS = ("free", "zeros", "double", "close", "graze", "short", "ends", "negative", "cubic")


def product(*zeros: Fraction, lead: Fraction = Fraction(1)) -> Poly:
    """The polynomial with these zeros."""
    found = [lead]
    for zero in zeros:
        found = [Fraction(0), *found]
        for k in range(len(found) - 1):
            found[k] -= zero * found[k + 1]
    return found


def drawn(rng: random.Random, kind: str) -> Poly | None:
    """A polynomial that is positive at 0; None for one that is not."""

    def number(low: int, high: int) -> Fraction:
        return Fraction(rng.randint(low * 1000, high * 1000), rng.choice([1000, 1024, 997]))

    some = number(0, 4) + Fraction(1, 1000)
    tiny = Fraction(1, 10 ** rng.choice([9, 16, 30, 60]))
    match kind:
        case "free":
            c = [some, *(number(-4, 4) for _ in range(4))]
        case "zeros":
            c = product(*(number(-2, 3) for _ in range(4)), lead=number(0, 2) + 1)
        case "double":
            c = product(some, some, number(-3, 6), number(-3, 6)) if rng.random() < 0.5 else product(some, some, -some)
        case "close":
            c = product(some, some + tiny, number(-3, 6), some + number(0, 1))
        case "graze":
            c = product(some, some, -some, -number(0, 3))
            c[0] += tiny * rng.choice([-1, 1])
        case "short":
            c = [some, *(number(-4, 4) for _ in range(rng.randint(1, 3))), Fraction(0)]
        case "ends":
            c = product(tiny, 1 / tiny, number(1, 3), number(1, 3))
        case "negative":
            c = [some, number(-4, 4), number(-4, 4), number(-4, 4), -number(1, 4)]
        case _:
            d, v, h = [(number(-4, 4), number(-4, 4)) for _ in range(3)]
            c = list(gap_quartic(*d, *v, *h, Fraction(0)))[1:]
    c = c if c[0] >= 0 else [-x for x in c]
    return c if c[0] > 0 and any(c[1:]) else None


def polynomials(many: int, seed: int) -> Iterator[tuple[str, Poly]]:
    """Of every kind in turn."""
    rng, k = random.Random(seed), 0
    while k < many:
        kind = KINDS[k % len(KINDS)]
        c = drawn(rng, kind)
        if c is not None:
            k += 1
            yield kind, c


def exact(x: Any) -> Fraction:
    """A double or a fraction as Python's."""
    return Fraction(x) if isinstance(x, float) else Fraction(int(x.p), int(x.q))


def is_wrong(found: Any, truth: tuple[Fraction, Fraction] | None) -> bool:
    """Whether an answer contradicts the truth; to say nothing is not wrong."""
    if isinstance(found, Unclear):
        return truth is not None and truth[1] < Fraction(found.since)
    if found is None or truth is None:
        return (found is None) != (truth is None)
    return not (exact(found.low) < truth[1] and truth[0] < exact(found.high))


def in_doubles(c: Poly) -> Any:
    """Decided in doubles."""
    mids = [float(x) for x in c]
    return falling_zero(mids, [float(abs(Fraction(m) - x)) * 1.001 for m, x in zip(mids, c, strict=True)])


def in_balls(c: Poly, bits: int = 300) -> Any:
    """Decided in balls of so many bits."""
    with ball.precision(bits):
        return falling_zero_in_balls([arb(fmpq(x.numerator, x.denominator)) for x in c])


def in_fractions(c: Poly) -> Any:
    """Decided exactly."""
    found = falling_zero_exactly([fmpq(x.numerator, x.denominator) for x in c])
    return Isolated(found.low, found.high) if isinstance(found, ExactZero) else None


@lru_cache
def judged(many: int, seed: int) -> list[tuple[Poly, tuple[Fraction, Fraction] | None]]:
    """Polynomials, and the truth."""
    return [(c, first_fall(c, WIDTH)) for _, c in polynomials(many, seed)]


def faults(decide: Callable[[Poly], Any], many: int, seed: int) -> int:
    """How many answers are wrong."""
    return sum(is_wrong(decide(c), truth) for c, truth in judged(many, seed))


# -- Planted faults: what the referee has to find.


def by_samples(c: Poly) -> Any:
    """Looks at 1,000 times, and misses what comes and goes between two of them."""
    top = 2 + max(abs(x / c[-1]) for x in c if c[-1]) if c[-1] else Fraction(4)
    times = [top * k / 1000 for k in range(1001)]
    for low, high in pairwise(times):
        if value(c, high) < 0:
            return Isolated(fmpq(low.numerator, low.denominator), fmpq(high.numerator, high.denominator))
    return None


def grazes_taken_for_hits(c: Poly) -> Any:
    """Takes a double zero for a hit."""
    plain = falling_zero_exactly([fmpq(x.numerator, x.denominator) for x in c])
    if plain is True:
        return Isolated(fmpq(0), fmpq(10**9))
    return Isolated(plain.low, plain.high) if isinstance(plain, ExactZero) else None


def without_bounds(c: Poly) -> Any:
    """Doubles at their word."""
    found = told_falling_zero([float(x) for x in c])
    return None if found is None else Isolated(found * (1 - 2.0**-45), found * (1 + 2.0**-45))


@pytest.mark.parametrize("fault", [by_samples, grazes_taken_for_hits, without_bounds])
def test_the_referee_finds_planted_faults(fault: Callable[[Poly], Any]) -> None:
    assert faults(fault, 180, seed=1) > 2


@pytest.mark.parametrize("decide", [in_doubles, in_balls, in_fractions])
def test_no_first_zero_is_wrong_or_missed(decide: Callable[[Poly], Any]) -> None:
    assert faults(decide, 450, seed=2) == 0


def test_doubles_decide_what_is_ordinary() -> None:
    found = [in_doubles(c) for kind, c in polynomials(450, 3) if kind in {"free", "zeros", "cubic", "short"}]
    assert sum(isinstance(one, Unclear) for one in found) <= len(found) // 50


def test_balls_decide_zeros_far_nearer_than_doubles() -> None:
    close = [c for kind, c in polynomials(450, 4) if kind in {"close", "graze"}]
    assert sum(isinstance(in_doubles(c), Unclear) for c in close) > len(close) // 3
    unclear = [sum(isinstance(in_balls(c, bits), Unclear) for c in close) for bits in (300, 1200)]
    assert unclear[0] > 0 == unclear[1]


def test_a_double_zero_is_a_graze_and_no_hit() -> None:
    c = [fmpq(1), fmpq(0), fmpq(-2), fmpq(0), fmpq(1)]
    assert falling_zero_exactly(c) is True
    assert isinstance(falling_zero_in_balls([arb(x) for x in c]), Unclear)


def test_newton_sharpens_to_the_working_precision() -> None:
    with ball.precision(2000):
        zero = sharpened(arb(1.25), arb(1.5), lambda t: 2 - t * t, lambda t: -2 * t)
        assert zero is not None
        assert zero.rel_accuracy_bits() > 1980
        assert (zero * zero - 2).contains(0)


def test_the_quartic_is_the_gap_of_the_two() -> None:
    dx, dy, vx, vy, hx, hy, reach, s = sympy.symbols("dx dy vx vy hx hy R s")
    gap = (dx + vx * s - hx * s**2) ** 2 + (dy + vy * s - hy * s**2) ** 2 - reach**2
    mine = sum(c * s**k for k, c in enumerate(gap_quartic(dx, dy, vx, vy, hx, hy, reach)))
    assert sympy.expand(gap - mine) == 0
    fall = RoundFall(dx, dy, vx, vy, hx, hy, reach).after(s)
    assert sympy.expand(fall.gap() - gap) == 0
    assert sympy.expand(2 * fall.approach() - sympy.diff(gap, s)) == 0


def test_no_bound_on_rounding_is_idle(monkeypatch: pytest.MonkeyPatch) -> None:
    c = product(Fraction(1), Fraction(1), Fraction(-1), Fraction(-2))
    c[0] -= Fraction(1, 10**25)
    assert isinstance(in_doubles(c), Unclear)
    monkeypatch.setattr(round_falls, "UNIT", 0.0)
    mids = [float(x) for x in c]
    assert not isinstance(falling_zero(mids, [0.0] * 5), Unclear) or value(c, Fraction(1)) < 0
