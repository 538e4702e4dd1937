"""Runs in finite precision whose clock no longer gets on: they end, and say why."""

from __future__ import annotations

from fractions import Fraction

import pytest

from truebreak.compare import compare
from truebreak.compare.engines import engine
from truebreak.floating import plain as standing
from truebreak.scenarios import Circle, Scene, Segment, StopReason, Wall, catalogue

SQUEEZED = Scene(
    [Circle(0, 0, vx=1), Circle(2, 0, vx=-1, m=2)],
    [Wall("-1-10**-30", 0, "-1-10**-30", 1), Wall("3+10**-30", 0, "3+10**-30", 1)],
    until=1,
)
"""Two balls that fill a channel but for 10**-30: in few bits they push each other and the walls at one instant."""


@pytest.mark.parametrize("name", ["double", "single", "rounded:bits=8"])
def test_a_run_whose_flights_come_back_while_no_time_passes_ends(name: str) -> None:
    run = engine(name).run(SQUEEZED)
    assert run.stop.reason is StopReason.BUDGET
    assert "passes without end" in run.stop.message and "the same flights again" in run.stop.message
    assert run.final_time == 0


def test_it_is_no_end_where_the_numbers_are_fine_enough() -> None:
    assert engine("quad").run(SQUEEZED, events=3000).stop.reason is StopReason.EVENTS


def test_a_comparison_with_such_a_run_tells_why_it_left() -> None:
    """Its clock stands at 0, where no exact event is: in doubles the channel has no room left."""
    (told,) = compare(SQUEEZED, ["double"], events=500).candidates
    assert told.verdict == "diverged" and told.diagnosis is not None
    assert str(told.diagnosis) == "input rounding"
    assert "passes without end" in told.trajectory.stop.message


def test_events_at_one_time_that_lead_on_are_let_be() -> None:
    """Near its turning point Galperin's ball hits thousands of times within the last bit of the clock."""
    run = engine("rounded:bits=12").run(catalogue.build("galperin:n=3"))
    times = [float(event.time) for event in run.events]
    assert run.stop.reason is StopReason.QUIET
    assert max(times.count(time) for time in set(times)) > 1000


@pytest.mark.parametrize("name", ["double", "single"])
def test_grazes_are_no_return(name: str) -> None:
    """Three meetings at what is one time in doubles; then the ball flies on and grazes 120 others: no events."""
    balls = [Circle(-4098, 0, vx=1), *(Circle(f"{2 * k} + {k}/10**14", 0) for k in range(4))]
    pegs = [Circle(20 + 3 * k, 2, m="oo") for k in range(120)]
    run = engine(name).run(Scene([*balls, *pegs], [Wall(400, 0, 400, 1)]), events=5)
    times = [float(event.time) for event in run.events]
    assert times[:4] == [4096.0] * 4
    assert times[4] > 4400


@pytest.mark.parametrize("name", ["double", "rounded:bits=12"])
def test_events_at_one_time_are_counted(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(standing, "MOST", 500)
    monkeypatch.setattr(standing, "RETURNS", 10**9)
    run = engine(name).run(SQUEEZED if name == "double" else catalogue.build("galperin:n=3"))
    assert run.stop.reason is StopReason.BUDGET
    assert "passes without end" in run.stop.message and "again" not in run.stop.message
    assert 500 <= len(run.events) < 1500


def test_signs_that_contradict_each_other_end_an_instant() -> None:
    """Which of two contacts push went round in circles here, for ever."""
    run = engine("rounded:bits=8").run(catalogue.build("two-in-a-box:seed=2005"), until=40)
    assert run.stop.reason is StopReason.BUDGET
    assert "passes without end" in run.stop.message and "contradict" in run.stop.message
    assert run.events


def test_an_instant_in_which_nothing_pushes_is_no_event() -> None:
    """At 12 bits the first ball comes to stand in the midst of the others: all approach, and nothing pushes."""
    balls = [Circle(-1000003, 0, vx=1), Circle(0, 0), Circle("2+10**-16", 0, m="3/2"), Circle("4+10**-15", 0, m="oo")]
    (told,) = compare(Scene(balls), ["rounded:bits=12"], until=1000003).candidates
    assert told.trajectory.stop.reason is StopReason.BUDGET
    assert "contradict" in told.trajectory.stop.message
    assert told.verdict != "agree" and not told.trajectory.events


@pytest.mark.parametrize("name", ["double", "single", "quad", "rounded:bits=30"])
@pytest.mark.parametrize("share", ["1/2", "9/10"])
def test_bounces_straight_onto_an_end_come_to_one(name: str, share: str) -> None:
    """Each takes `share` of the time of the one before, and has that of its speed, however little that is; ever
    fainter, they end soon after the clock stands still: of double-double numbers it went on for a million events."""
    balls, shelves = [Circle(5, 6, id="ball")], [Segment(-5, 0, 5, 0)]
    scene = Scene(balls, segments=shelves, gravity=(0, -10), restitution=share)
    run = engine(name).run(scene, until=20, events=1500)
    assert run.stop.reason is StopReason.BUDGET
    assert "passes without end" in run.stop.message
    assert len(run.events) < 1000
    fine = run.events[:100] if name == "quad" else run.events[:15]
    speeds = [float(run.motion.state(event.time)[0][3]) for event in fine]
    wanted = [10 * float(Fraction(share)) ** (k + 1) for k in range(len(fine))]
    assert speeds == pytest.approx(wanted, rel=1e-9 if name == "quad" else 1e-2, abs=0)
