"""What the numbers of every engine can do, and that it is true of them."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from math import inf, nan, nextafter

import numpy as np
import pytest
import sympy
from flint import arb
from hypothesis import given
from hypothesis import strategies as st

from truebreak.exact import ExactEngine, SymbolicEngine
from truebreak.floating import DoubleEngine, IntervalEngine, PymunkEngine
from truebreak.scenarios import Circle, Quantity, Scene, Wall
from truebreak.scenarios.engine import Engine
from truebreak.scenarios.numbers.precision import Double, bounds_of, hull
from truebreak.scenarios.numbers.quantity import Real, real

SCENE = Scene([Circle(0, 0, vx=1), Circle("9/2", 1, vx=-1), Circle(8, 5)], [Wall(12, 0, 12, 1)], reverse_after=2)
ENGINES = (ExactEngine(), SymbolicEngine(), DoubleEngine(), IntervalEngine(), PymunkEngine())


@pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.name)
def test_every_number_of_a_run_is_a_real_that_agrees_with_itself(engine: Engine) -> None:
    run = engine.run(SCENE, events=4)
    assert len(run.events) == 4
    assert run.reversal is not None
    states = [run.final, run.at(run.events[0].time), run.at("1/2"), run.at(0.25)]
    times = [run.final_time, run.reversal.time, *(event.time for event in run.events), *(s.time for s in states)]
    rows = [(c.x, c.y, c.vx, c.vy) for s in states for c in s.circles]
    for number in [*times, *(value for row in rows for value in row)]:
        assert isinstance(number, Real)
        low, high = number.bounds()
        assert low <= float(number) <= high
        ball = number.ball(100)
        assert ball.overlaps(arb(float(number)) + arb(0, 1e-12))
        assert hull(arb(low), arb(high)).overlaps(ball)
        text = number.text()
        if text is not None:
            assert float(Quantity.of(text)) == float(number)
            assert abs(Fraction(number.digits(12)) - Fraction(float(number))) < 1e-9


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_double_is_the_fraction_that_it_is(x: float) -> None:
    value = real(x)
    assert value == x
    assert value.bounds() == (x, x)
    assert Quantity.of(value.text()) == Quantity.of(x)
    assert value.ball(10) == arb(x)


def test_doubles_that_are_no_numbers_have_no_text() -> None:
    assert [Double(x).text() for x in (nan, inf, -inf)] == [None, None, None]


@pytest.mark.parametrize(
    "value",
    [1, 10**400, 0.1, np.float64(0.1), np.float32(0.1), Fraction(1, 3), Decimal("0.1"), sympy.sqrt(2), Quantity.of(5)],
)
def test_numbers_of_any_engine_become_reals(value: object) -> None:
    number = real(value)
    assert isinstance(number, Real)
    assert Quantity.of(number.text()) == Quantity.of(value)


@given(st.fractions(), st.integers(20, 200))
def test_bounds_are_the_nearest_doubles_around(q: Fraction, bits: int) -> None:
    low, high = Quantity.of(q).bounds()
    assert Fraction(low) <= q <= Fraction(high)
    assert high in (low, nextafter(low, inf))
    wide = bounds_of(Quantity.of(q).ball(bits))
    assert wide[0] <= low
    assert wide[1] >= high
