"""Depth and work: a tower stops at its limits, the same ones in every process, and can go on."""

from __future__ import annotations

import itertools
import os
import subprocess
import sys
from fractions import Fraction
from typing import Any

import pytest
import sympy
from flint import fmpz

from truebreak.scenarios.numbers.nested_roots import Tower
from truebreak.scenarios.numbers.tower_element import Element
from truebreak.scenarios.numbers.tower_ring import TowerField, TowerLimit, count_of
from truebreak.scenarios.work import Work, gcd_units, product_units


def test_depth_limit() -> None:
    t = Tower(max_depth=2)
    root = t.sqrt(1 + t.sqrt(2))
    assert t.depth == 2
    assert t.sqrt(3) * t.sqrt(3) == 3, "roots of whole numbers share one level"
    with pytest.raises(TowerLimit, match="depth 3"):
        t.sqrt(1 + root)
    assert t.depth == 2
    assert t.sqrt(root * root) == root
    with pytest.raises(TowerLimit):
        Tower(max_depth=0).sqrt(2)
    assert Tower(max_depth=0).sqrt(4) == 2


def test_work_limit() -> None:
    t = Tower()
    e = t.sqrt(1 + t.sqrt(2))
    t.work = Work(0)
    with pytest.raises(TowerLimit, match="the work allowed is spent"):
        _ = e * e
    with pytest.raises(TowerLimit):
        t.sqrt(e + 1)
    t.work = None
    assert e * e == 1 + t.sqrt(2)


def test_towers_that_share_work_share_its_limit() -> None:
    work = Work(1_000)
    first, second = Tower(work=work), Tower(work=work)
    with pytest.raises(TowerLimit):
        for k in range(2, 1_000):
            first.sqrt(k)
    assert work.is_spent
    with pytest.raises(TowerLimit):
        second.sqrt(2)


def several(t: Tower) -> list[Element]:
    """Numbers whose making goes through every way in which a tower grows."""
    a = t.sqrt(6) + t.sqrt(35) + t.sqrt(10**45 + 9)
    b = t.sqrt(2 + t.sqrt(3)) * t.sqrt(5 + t.sqrt(2))
    c = t.sqrt(b * b) / (1 + b) - t.sqrt(5 - t.sqrt(2)) * t.sqrt(23)
    d = t.sqrt(3 + t.sqrt(1 + t.sqrt(2)))
    return [a, b, c, t.sqrt(5 + 2 * t.sqrt(6)), d, t.sqrt((d + 1) ** 2), t.sqrt(77), t.sqrt(21)]


def few(t: Tower) -> list[Element]:
    return [t.sqrt(6) + t.sqrt(35), t.sqrt(77), t.sqrt(21), t.sqrt(t.sqrt(2) + 3), t.sqrt(5 + 2 * t.sqrt(6))]


@pytest.mark.parametrize("make, stops", [(few, 1_000), (several, 60)])
def test_a_tower_stopped_anywhere_goes_on_rightly(make: Any, stops: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Wherever the limit is met, nothing is left half done."""
    sums: list[int] = [0]
    with monkeypatch.context() as patch:
        patch.setattr(Work, "spend", lambda self, units: sums.append(sums[-1] + units))
        texts = [e.text() for e in make(Tower(work=Work()))]
    total = sums[-1]
    limits = sorted(set(sums) - {total})
    for limit in limits[:: max(1, len(limits) // stops)]:
        t = Tower(work=Work(limit))
        with pytest.raises(TowerLimit):
            make(t)
        t.work = None
        assert [e.text() for e in make(t)] == texts
        assert t.sqrt(14) * t.sqrt(15) == t.sqrt(210)
    assert [e.text() for e in make(Tower(work=Work(total)))] == texts, "what it spends is enough for it"


def grow_nested(t: Tower) -> None:
    e = t.rational(1)
    for k in range(40):
        e = t.sqrt(e * e + 3 * e + k) + 1 / (e + k + 1)


def grow_base(t: Tower) -> None:
    e = t.rational(1)
    for k in range(2, 60):
        e = e + t.sqrt(k)
    for _ in range(20):
        e = e * e


def grow_rational(t: Tower) -> None:
    e = t.rational(Fraction(2, 3))
    for _ in range(60):
        e = e * e + Fraction(1, 7)


def grow_terms(t: Tower) -> None:
    """Sums only: an element with 1,024 terms, over and over."""
    e = t.rational(1)
    for k in range(10):
        e = e * (1 + t.sqrt(int(sympy.prime(k + 1))))
    for k in range(10_000):
        e = e + k


@pytest.mark.parametrize("grow", [grow_nested, grow_base, grow_rational, grow_terms])
def test_work_stops_a_tower_that_grows_beyond_reason(grow: Any) -> None:
    work = Work(200_000)
    with pytest.raises(TowerLimit):
        grow(Tower(work=work))
    assert work.is_spent


def counted_terms(patch: pytest.MonkeyPatch) -> list[int]:
    """How many products of two terms each `mul_surds` from here on computes."""
    done: list[int] = []
    plain = TowerField.mul_surds

    def counting(self: TowerField, x: Any, y: Any) -> Any:
        product = plain(self, x, y)
        done.append(len(x) * len(y))
        return product

    patch.setattr(TowerField, "mul_surds", counting)
    return done


def deep(t: Tower, bits: int) -> Element:
    """An element with 2**8 coefficients of about so many bits, in a tower of six levels."""
    for p in (2, 3, 5):
        t.sqrt(p)
    for k in range(5):
        t.sqrt(t.generators[-1] + k + 4)
    assert t.depth == 6
    e = t.rational(1)
    for i, generator in enumerate(t.generators):
        e = e * (generator + fmpz(3) ** (bits // 13) + i)
    assert count_of(e.num) == 2**8
    return e


@pytest.mark.parametrize("operation", ["product", "inverse", "square"])
def test_one_step_in_a_deep_tower_ends_at_its_limit(operation: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """No step is taken that is not paid for: what is done within one operation stays within its limit."""
    t = Tower()
    e = deep(t, 1_000)
    square = e * e
    run, limit = {
        "product": (lambda: e * e, 3_000),
        "inverse": (lambda: 1 / e, 30_000),
        "square": (lambda: t.own_root(square), 30_000),
    }[operation]
    charges: list[int] = []
    spend = Work.spend

    def recording(self: Work, units: int) -> None:
        spend(self, units)
        charges.append(units)

    monkeypatch.setattr(Work, "spend", recording)
    done = counted_terms(monkeypatch)
    t.work = Work(limit)
    with pytest.raises(TowerLimit, match="--work"):
        run()
    assert sum(charges) <= limit, "what was refused was not done"
    assert len(charges) > 10
    assert sum(done) <= 2 * limit + 2, "a product of two terms counts half a unit at least"


def test_a_product_of_long_numbers_is_paid_for_before_it_is_computed() -> None:
    t = Tower()
    e = t.sqrt(2) * fmpz(3) ** 1_000_000 + fmpz(5) ** 1_000_000
    for step in (lambda: e * e, lambda: 1 / e, lambda: e * (fmpz(7) ** 1_000_000), lambda: e / fmpz(7) ** 1_000_000):
        t.work = Work(100)
        with pytest.raises(TowerLimit):
            step()
        assert t.work.is_spent


def test_work_grows_with_the_length_of_the_numbers() -> None:
    for units in (product_units, gcd_units):
        lengths = [2**k for k in range(5, 24)]
        table = [units(bits, bits) for bits in lengths]
        assert table == sorted(table)
        assert all(2 * a <= b <= 6 * a + 10 for a, b in itertools.pairwise(table))
        assert units(1_000, 50_000) == units(50_000, 1_000)


SPENDING = """
from fractions import Fraction
from truebreak.scenarios.numbers.nested_roots import Tower
from truebreak.scenarios.numbers.tower_ring import TowerLimit
from truebreak.scenarios.numbers.tower_element import sign_of_root_sum
from truebreak.scenarios.work import Work

work = Work()
t = Tower(work=work)
e = t.rational(Fraction(2, 3))
for k in range(4):
    e = e * Fraction(3, k + 2) + t.sqrt(e * e + 10 * k + 7) - 1
    hash(e), e.text(), t.sqrt(e * e), (1 / e).sign(), {e, e + 1, e - 1}
t.own_root(e * e + 1 - e.sign())
for n in (3 * 10**60 + 9, 10**45 + 9, 720, 30030, 1001, 6 * (10**45 + 9)):
    e = e + t.sqrt(n) * t.sqrt(1 + t.sqrt(3))
one = t.rational(1)
print(sign_of_root_sum(one, one, t.sqrt(2), -one, 1 + t.sqrt(2) + 2 * t.sqrt(t.sqrt(2))), work.spent)
for limit in (1_000, 30_000, 200_000):
    t = Tower(work=Work(limit))
    try:
        e = t.rational(1)
        for k in range(40):
            e = t.sqrt(e * e + 3 * e + k) + 1 / (e + k + 1)
    except TowerLimit:
        print(limit, k, t.work.spent, len(t.generators))
"""


def test_the_same_computation_spends_the_same_work_in_every_process() -> None:
    told = set()
    for seed in ("0", "1", "4711", "random"):
        done = subprocess.run(
            [sys.executable, "-P", "-c", SPENDING],
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        )
        told.add(done.stdout)
    assert len(told) == 1, told
    assert len(told.pop().splitlines()) == 4
