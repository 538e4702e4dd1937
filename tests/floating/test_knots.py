"""Motion made of knots: straight flight from the last knot, the same whether asked once or for many times."""

from __future__ import annotations

import doctest
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from truebreak.compare.engines import engine
from truebreak.floating import interval, knots
from truebreak.floating.knots import DoubleKnot, DoubleMotion
from truebreak.scenarios import Circle, Quantity, Scene, catalogue

BOUNCE = DoubleMotion(
    [
        [(0.0, 0.0, 1.0, 1.0, 0.0), (2.0, 2.0, 1.0, -1.0, 0.5)],
        [(0.0, 5.0, 5.0, 0.0, 0.0)],
    ],
    end=4.0,
)


def test_docstring_examples_hold() -> None:
    assert doctest.testmod(knots).failed == 0


def test_flight_between_knots_is_straight() -> None:
    assert BOUNCE.state(0.5) == [(0.5, 1.0, 1.0, 0.0), (5.0, 5.0, 0.0, 0.0)]
    assert BOUNCE.state(4)[0] == (0.0, 2.0, -1.0, 0.5)


def test_state_at_a_knot_is_as_it_leaves() -> None:
    assert BOUNCE.state(2.0)[0] == (2.0, 1.0, -1.0, 0.5)
    assert BOUNCE.state(math.nextafter(2.0, 0.0))[0][2] == 1.0


def test_last_of_several_knots_at_one_time_holds() -> None:
    motion = DoubleMotion([[(0.0, 0.0, 0.0, 1.0, 0.0), (1.0, 1.0, 0.0, 2.0, 0.0), (1.0, 1.0, 0.0, 3.0, 0.0)]])
    assert motion.state(1.0) == [(1.0, 0.0, 3.0, 0.0)]
    assert motion.sample([1.0])[0, 0].tolist() == [1.0, 0.0, 3.0, 0.0]


def test_any_number_that_floats_is_a_time() -> None:
    assert BOUNCE.state(Quantity.of("1/2")) == BOUNCE.state(0.5)


@pytest.mark.parametrize("time", [-0.1, 4.1, math.nan])
def test_times_outside_of_the_run_are_refused(time: float) -> None:
    with pytest.raises(ValueError, match=r"outside of the run: it lasts from 0\.0 to 4\.0"):
        BOUNCE.state(time)
    with pytest.raises(ValueError, match="outside of the run"):
        BOUNCE.sample([time])


def test_sample_of_no_times_has_no_rows() -> None:
    assert BOUNCE.sample([]).shape == (0, 2, 4)


@st.composite
def histories(draw: st.DrawFn) -> list[DoubleKnot]:
    number = st.floats(-100, 100)
    times = sorted(draw(st.lists(st.floats(0, 10), max_size=8)))
    return [(t, draw(number), draw(number), draw(number), draw(number)) for t in [0.0, *times]]


@given(st.lists(histories(), min_size=1, max_size=4), st.lists(st.floats(0, 12), max_size=6))
def test_sample_is_state_at_many_times(history: list[list[DoubleKnot]], times: list[float]) -> None:
    motion = DoubleMotion(history)
    times = sorted(times)
    sampled = motion.sample(times)
    assert sampled.shape == (len(times), len(history), 4)
    for row, time in zip(sampled, times, strict=True):
        np.testing.assert_array_equal(row, np.array(motion.state(time), dtype=float))


def test_a_run_in_intervals_looks_up_what_stands_once(monkeypatch: pytest.MonkeyPatch) -> None:
    run, flown = engine("interval").run(catalogue.build("siam")), list[object]()
    times = [float(run.final_time) * k / 3 for k in range(3)]
    each = [[[float(value) for value in row] for row in run.motion.state(time)] for time in times]
    carry = interval._flown
    monkeypatch.setattr(interval, "_flown", lambda knot, *at: flown.append(knot) or carry(knot, *at))
    assert run.motion.sample(times).tolist() == each
    hit = sum(len(row) > 1 for row in run.motion.knots)
    assert 0 < len(flown) <= hit * len(times) < len(run.motion.knots)


def test_a_time_on_either_side_of_an_event_gets_what_encloses_both() -> None:
    """In intervals nothing says whether a double is before an event that an interval round it is of."""
    run = engine("interval").run(Scene([Circle(0, 0, vx=1), Circle(4, 1)]), until=5)
    [event] = run.events
    before, after, between = (run.motion.state(time)[0][2] for time in (2.0, event.time, float(event.time)))
    assert between.low <= after.low < after.high < before.low <= between.high
    assert run.motion.state(math.nextafter(event.time.high, 5))[0][2].high < before.low
