"""First falling zeros of quartics, compared with Sturm's chains in fractions; planted faults are found first."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise
from typing import Any

import pytest
import quartic_campaign
import sympy
from flint import arb, fmpq
from quartic_campaign import (
    WAYS,
    WIDTH,
    campaign,
    in_balls,
    in_doubles,
    is_wrong,
    known,
    polynomials,
    product,
)
from quartic_referee import Poly, first_fall, value

from truebreak.exact.numbers import ball
from truebreak.exact.replay import round_falls
from truebreak.exact.replay.landings import told_falling_zero
from truebreak.exact.replay.round_falls import (
    ExactZero,
    Isolated,
    RoundFall,
    Unclear,
    falling_zero,
    falling_zero_exactly,
    falling_zero_in_balls,
    gap_quartic,
)


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


@pytest.mark.parametrize("bits", [3, 40, 70, 120, 220, 400, 1000])
def test_a_zero_next_to_0_is_told_to_as_many_digits_as_others(bits: int) -> None:
    """As after a bounce of such a speed: v - 5 s - 10 v s^2 + 25 s^3; it was off by as much as a far one is."""
    speed = 2.0**-bits
    assert told_falling_zero([speed, -5.0, -10 * speed, 25.0]) == pytest.approx(
        speed / 5, rel=0.05 if bits == 3 else 1e-9
    )


@pytest.mark.parametrize("fault", [by_samples, grazes_taken_for_hits, without_bounds])
def test_the_referee_finds_planted_faults(fault: Callable[[Poly], Any]) -> None:
    assert faults(fault, 180, seed=1) > 2


@pytest.mark.parametrize("decide", WAYS.values(), ids=WAYS)
def test_no_first_zero_is_wrong_or_missed(decide: Callable[[Poly], Any]) -> None:
    assert faults(decide, 650, seed=2) == 0


def test_the_campaign_counts_what_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(WAYS, "doubles", by_samples)
    counts = campaign(0, 130)
    assert counts["doubles: WRONG"] > 0 == sum(counts[f"{way}: WRONG"] for way in WAYS if way != "doubles")
    assert counts["Newton: fewer than 180 bits of 300"] == 0


def test_none_is_wrong_where_the_zeros_are_known(monkeypatch: pytest.MonkeyPatch) -> None:
    """As compiled, where it is, and as written; without a bound on rounding some are."""
    counts = known(0, 3000)
    assert counts["WRONG"] == 0 < counts["close: open"] < counts["close: falls"]
    assert counts["free: open"] == counts["short: open"] == 0
    monkeypatch.setattr(round_falls, "predictions", None)
    assert known(3000, 5000)["WRONG"] == 0
    monkeypatch.setattr(round_falls, "UNIT", 0.0)
    monkeypatch.setattr(quartic_campaign, "falling_zero", lambda c, off: falling_zero(c, [0.0] * len(c)))
    assert known(0, 2000)["WRONG"] > 100


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
        zero = ball.sharpened(arb(1.25), arb(1.5), lambda t: 2 - t * t, lambda t: -2 * t)
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
