"""How a run of the pymunk engine ends, what it refuses, and what it passes on."""

from __future__ import annotations

import math
import signal
import threading
from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pymunk
import pytest
from test_pymunk_engine import FINE, collided, gas, velocities

from truebreak.floating import pymunk_run
from truebreak.floating.knots import DoubleMotion
from truebreak.floating.pymunk_engine import PymunkEngine
from truebreak.scenarios import Circle, Scene, SceneError, StopReason, Trajectory, Wall, catalogue
from truebreak.scenarios.errors import TimeIsUp
from truebreak.scenarios.trajectory import Progress, Stop

# -- how it ends


def test_until_between_two_steps_is_reached_in_straight_flight() -> None:
    run = PymunkEngine(dt=1 / 4).run(Scene([Circle(0, 0, vx=1)], [Wall(9, 0, 9, 1)]), until="10/3")
    assert run.stop.reason is StopReason.HORIZON
    assert run.final_time == 10 / 3
    assert run.final["c1"].x == pytest.approx(10 / 3, rel=1e-15)


def test_an_event_limit_ends_the_run_at_that_event() -> None:
    run = PymunkEngine().run(gas(), events=7)
    assert len(run.events) == 7
    assert run.stop.reason is StopReason.EVENTS
    assert run.final_time == run.events[-1].time


def test_a_run_without_a_time_limit_ends_when_nothing_can_happen() -> None:
    circles = [Circle(0, 0, vx=1), Circle(4, 0), Circle(0, 9, vx=-1)]
    run = PymunkEngine().run(Scene(circles, [Wall(-9, 0, -9, 1)]))
    assert run.stop.reason is StopReason.QUIET
    assert collided(run) == [("c1", "c2"), ("c3", "w1")]


def test_a_time_limit_holds_where_nothing_can_happen() -> None:
    run = PymunkEngine().run(Scene([Circle(0, 0, vx=1)]), until=10**6)
    assert run.stop.reason is StopReason.HORIZON
    assert run.final["c1"].x == 10**6
    assert run.plan["steps"] < 1000


def test_the_budget_of_steps_ends_a_run() -> None:
    run = PymunkEngine(max_steps=300).run(gas(), events=10**6)
    assert run.stop.reason is StopReason.BUDGET
    assert run.final_time == 300 / 256
    assert PymunkEngine(max_steps=256).run(gas(), until=1).stop.reason is StopReason.HORIZON


@pytest.mark.parametrize(("limit", "time"), [({"reverse_at": "7/3"}, 7 / 3), ({"reverse_after": 2}, None)])
def test_a_reversed_run_goes_back_towards_its_start(limit: dict[str, str], time: float | None) -> None:
    scene = gas().with_changes(**limit)
    run = FINE.run(scene)
    assert run.reversal is not None
    turn = run.reversal.time if time is None else time
    assert run.reversal.time == turn
    assert run.final_time == 2 * turn
    assert run.stop.reason is StopReason.HORIZON
    start, before, after, end = run.sample([0.0, math.nextafter(turn, 0), turn, 2 * turn])
    if time is not None:
        np.testing.assert_allclose(after[:, 2:], -before[:, 2:])
    np.testing.assert_allclose(end[:, :2], start[:, :2], atol=0.05)
    np.testing.assert_allclose(end[:, 2:], -start[:, 2:], atol=0.05)


def test_a_reversal_right_after_a_collision_undoes_it() -> None:
    run = FINE.run(Scene([Circle(0, 0, vx=1), Circle(4, 0)], reverse_after=1))
    assert collided(run) == [("c1", "c2")] * 2
    assert run.reversal is not None
    assert run.reversal.after == 1
    assert velocities(run) == [(-1, 0), (0, 0)]
    assert run.final["c1"].x == pytest.approx(0, abs=4 * FINE.dt)


def test_a_limit_of_the_caller_may_come_before_the_reversal() -> None:
    run = PymunkEngine().run(gas().with_changes(reverse_at=9), until=2)
    assert run.reversal is None
    assert run.final_time == 2


def test_another_tie_policy_is_noted() -> None:
    assert PymunkEngine().run(gas().with_changes(tie_policy="sequential"), until=1).notes


# -- what it refuses, and what it passes on


def test_capture_is_refused() -> None:
    from truebreak.scenarios import Pocket

    scene = Scene([Circle(0, 0)], pockets=[Pocket(5, 5, 1)])
    assert PymunkEngine().run(scene, until=1).events == ()
    with pytest.raises(SceneError, match="cannot take circles out of play"):
        PymunkEngine().run(scene.with_changes(capture=True), until=1)


@pytest.mark.parametrize(
    "setting",
    [
        {"dt": 0},
        {"dt": math.nan},
        {"dt": math.inf},
        {"iterations": 0},
        {"iterations": 1.5},
        {"max_steps": True},
        {"collision_slop": -1},
        {"collision_bias": 1.1},
        {"collision_bias": math.nan},
    ],
)
def test_parameters_out_of_range_are_refused(setting: dict[str, float]) -> None:
    with pytest.raises(SceneError, match=next(iter(setting))):
        PymunkEngine(**setting)  # type: ignore[arg-type]


def test_numbers_beyond_doubles_are_refused() -> None:
    with pytest.raises(SceneError, match="1e308"):
        PymunkEngine().run(Scene([Circle("1e400", 0)]), until=1)


def test_more_groups_than_filters_are_refused() -> None:
    circles = [Circle(3 * k, 0, 1) for k in range(33)]
    walls = [Wall(3 * k + Fraction(3, 2), 0, 3 * k + Fraction(3, 2), 1) for k in range(32)]
    with pytest.raises(SceneError, match="33 groups"):
        PymunkEngine().run(Scene(circles, walls), until=1)
    assert PymunkEngine().run(Scene(circles[1:], walls), until=1).events == ()


def test_all_settings_are_told() -> None:
    told = PymunkEngine(dt=1 / 100, iterations=3).run(gas(), until=1).parameters
    assert told["dt"] == 1 / 100
    assert told["iterations"] == 3
    assert told["pymunk"] == pymunk.version
    assert {"collision_slop", "collision_bias", "collision_persistence", "elasticity"} <= told.keys()


def test_the_elasticity_that_makes_up_the_restitution_is_told() -> None:
    """Chipmunk takes the product of the two shapes' for a contact."""
    scene = Scene([Circle(0, 0, 1, vx=1), Circle(4, 0, 1)], restitution="9/10")
    told = PymunkEngine().run(scene, until=4)
    assert told.parameters["elasticity"] ** 2 == pytest.approx(0.9, rel=1e-15)
    assert float(told.final["c1"].vx) == pytest.approx(0.05, abs=1e-9)


def failing(error: BaseException) -> Callable[..., None]:
    def fail(*_: object) -> None:
        raise error

    return fail


def assert_begins_like(part: Trajectory, whole: Trajectory) -> None:
    """A run that was cut is the beginning of the whole, and its final state is the whole's at that time."""
    assert part.events == whole.events[: len(part.events)]
    assert float(part.final_time) < float(whole.final_time)
    assert len(part.events) == sum(float(event.time) <= float(part.final_time) for event in whole.events)
    assert np.allclose(part.final.array(), whole.at(part.final_time).array(), rtol=0, atol=1e-9)


def test_an_interrupt_ends_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pymunk_run, "PROGRESS_SECONDS", 0.0)
    run = PymunkEngine().run(gas(), until=100, progress=failing(KeyboardInterrupt()))
    assert run.stop.reason is StopReason.INTERRUPTED
    assert run.final_time == pymunk_run.STRETCH / 256
    assert_begins_like(run, PymunkEngine().run(gas(), until=100))


def test_the_end_of_the_users_time_ends_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pymunk_run, "PROGRESS_SECONDS", 0.0)
    told: list[Progress] = []

    def progress(state: Progress) -> None:
        told.append(state)
        if len(told) == 9:
            raise TimeIsUp("3 seconds")

    run = PymunkEngine().run(gas(), until=100, progress=progress)
    assert run.stop == Stop(StopReason.BUDGET, "the budget is spent: 3 seconds")
    assert (run.final_time, len(run.events)) == (told[-1].time, told[-1].events)
    assert len(run.events) > 5
    assert_begins_like(run, PymunkEngine().run(gas(), until=100))


def test_control_c_waits_for_the_end_of_a_step() -> None:
    """The signal mostly comes while C code is at work; raised there it would be printed, and lost."""
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    timer.start()
    run = PymunkEngine(max_steps=10**9).run(catalogue.build("gas"), until=10**6)
    assert run.stop.reason is StopReason.INTERRUPTED
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    assert_begins_like(run, PymunkEngine().run(catalogue.build("gas"), until=float(run.final_time) + 1))


def test_an_interrupt_while_pymunk_reports_a_contact_ends_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pymunk.Arbiter, "total_impulse", property(failing(KeyboardInterrupt())))
    with pytest.raises(KeyboardInterrupt):
        PymunkEngine().run(gas(), until=100)


def test_circles_that_fly_on_in_touch_leave_no_knots_behind() -> None:
    pair = [Circle(0, 0, "3/10", vx=1), Circle("3/5", 0, "3/10", vx=1), Circle("6/5", 0, "3/10", vx=1)]
    run = PymunkEngine().run(Scene(pair), until=20)
    assert run.events == ()
    assert isinstance(run.motion, DoubleMotion)
    assert max(len(knots) for knots in run.motion.knots) < 10
