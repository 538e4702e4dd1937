"""Entries into pockets near the end of what is compared, and after a run's last collision."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pytest

from truebreak.compare import compare
from truebreak.compare.comparison import Candidate
from truebreak.compare.engines import engine
from truebreak.compare.foreign import LogEngine, Recording
from truebreak.scenarios import Circle, Pocket, Scene, Wall

SHOT = Scene([Circle(0, 0, vx=1, id="a"), Circle(5, 0, id="b")], pockets=[Pocket(20, 0, 1, id="pocket")])
"""At 3, a hits b, whose centre enters the pocket at 17 and leaves it at 19."""

States = dict[str, tuple[float, float, float, float]]


def log(lines: Sequence[tuple[float, Any, States]], scene: Scene = SHOT, **end: Any) -> LogEngine:
    recording = Recording(scene, "log")
    for time, pair, states in lines:
        recording.hit(time, *pair, states=states)
    recording.end(**end)
    return LogEngine(recording)


def hit(vx: float = 1.0, vy: float = 0.0) -> list[tuple[float, Any, States]]:
    """The hit, after which b flies with another velocity."""
    return [(3.0, ("a", "b"), {"a": (3.0, 0.0, 0.0, 0.0), "b": (5.0, 0.0, vx, vy)})]


def judged(run: LogEngine, scene: Scene = SHOT, **limits: Any) -> Candidate:
    (candidate,) = compare(scene, [run], causes=False, **limits).candidates
    return candidate


@pytest.mark.parametrize("name", ["exact", "double", "pymunk", "interval"])
def test_a_run_that_is_over_has_the_entries_after_its_last_collision(name: str) -> None:
    run = engine(name).run(SHOT)
    ((circle, pocket, time),) = [(e.circle, e.pocket, float(e.time)) for e in run.pocketings]
    assert (circle, pocket, time) == ("b", "pocket", pytest.approx(17.0, abs=0.02))
    assert float(run.final_time) == time


def test_a_recording_that_is_over_has_the_entries_after_its_last_collision() -> None:
    run = log(hit(), time=5.0, quiet=True).recording.trajectory()
    assert [float(e.time) for e in run.pocketings] == [17.0]
    assert float(run.final_time) == 17.0
    assert log(hit(), time=5.0).recording.trajectory().pocketings == ()


@pytest.mark.parametrize("until", [None, 16, "17 - 1/1000", "17 - 1/10**20", 17, "17 + 1/10**20", "17 + 1/1000", 18])
def test_an_entry_that_is_a_little_late_counts_in_both_runs_or_in_neither(until: Any) -> None:
    """pymunk is late by a part of its time step, the last log by a billionth of the time."""
    late = log(hit(vx=1 - 1e-9), time=100.0, quiet=True)
    for candidate in compare(SHOT, ["single", "double", "pymunk", late], until=until, causes=False).candidates:
        assert candidate.verdict == "agree"
        assert "pocketed" not in candidate.changed, candidate.engine


@pytest.mark.parametrize("early", [1 - 1e-9, 0.999])
def test_an_entry_that_is_a_little_early_counts_in_both_runs_or_in_neither(early: float) -> None:
    """The reference ends short of it."""
    until = 3 + 14 * (1 + early) / 2
    candidate = judged(log(hit(vx=1 / early), time=100.0, quiet=True), until=until)
    assert float(candidate.trajectory.pocketings[0].time) < until < 17
    assert candidate.outcomes["pocketed"] == {}
    assert "pocketed" not in candidate.changed


@pytest.mark.parametrize("end", [5.0, 16.9, 17.0, 17.001, 18.0])
@pytest.mark.parametrize("until", [None, 17, 18])
def test_a_log_that_ends_before_its_late_entry_does_not_lack_it(end: float, until: Any) -> None:
    assert "pocketed" not in judged(log(hit(vx=0.9), time=end), until=until).changed


@pytest.mark.parametrize("until", [None, 17, 18])
def test_a_circle_that_misses_its_pocket_has_changed_the_outcome(until: Any) -> None:
    candidate = judged(log(hit(vy=0.1), time=100.0, quiet=True), until=until)
    assert candidate.verdict == "agree"
    assert "pocketed" in candidate.changed
    assert candidate.expected["pocketed"] == {"b": {"pocket": "pocket", "time": 17.0}}
    assert candidate.outcomes["pocketed"] == {}


def test_an_entry_that_only_the_run_has_changes_the_outcome() -> None:
    missed = Scene(SHOT.circles, pockets=[Pocket(20, "3/2", 1, id="pocket")])
    candidate = judged(log(hit(vy=0.1), missed, time=100.0, quiet=True), missed)
    assert candidate.verdict == "agree"
    assert "pocketed" in candidate.changed
    assert candidate.expected["pocketed"] == {}
    assert list(candidate.outcomes["pocketed"]) == ["b"]


def test_an_entry_past_all_patience_is_lacking() -> None:
    """Patience ends at 41, when a centre at two fifths of the speed has entered, and one at a third has not."""
    for slow, lacking in ((0.4, False), (0.33, True)):
        candidate = judged(log(hit(vx=slow), time=20.0), until=18)
        assert (candidate.verdict, "pocketed" in candidate.changed) == ("agree", lacking)


def test_a_circle_that_another_hit_took_away_does_not_await_its_entry() -> None:
    """The log has b turned back by a wall that stands elsewhere."""
    scene = Scene(SHOT.circles, [Wall(40, -5, 40, 5, id="wall")], pockets=SHOT.pockets)
    turned = [*hit(), (10.0, ("b", "wall"), {"b": (12.0, 0.0, -1.0, 0.0)})]
    for end, lacking in ((12.0, False), (16.99999, False), (17.00001, True)):
        candidate = judged(log(turned, scene, time=end), scene, until=18)
        assert (candidate.verdict, candidate.until) == ("diverged", end)
        assert ("pocketed" in candidate.changed) == lacking


RIM = [  # a centre, its velocity, and when it enters the pocket of radius 5 about 0, 0
    ((1, 0), (0, 0), []),
    ((1, 0), (1, 0), []),
    ((3, 4), (1, 0), []),
    ((3, 4), (4, -3), []),
    ((-9, 5), (1, 0), []),
    ((3, 4), (-1, 0), [0.0]),
    ((-9, 4), (1, 0), [6.0]),
    ((-9, 4), (-1, 0), []),
]


@pytest.mark.parametrize(("place", "velocity", "times"), RIM)
@pytest.mark.parametrize("name", ["exact", "double", "pymunk"])
def test_who_starts_inside_or_grazes_does_not_enter(
    name: str, place: tuple[int, int], velocity: tuple[int, int], times: list[float]
) -> None:
    (x, y), (vx, vy) = place, velocity
    scene = Scene([Circle(x, y, vx=vx, vy=vy), Circle(0, 50)], pockets=[Pocket(0, 0, 5)])
    assert [float(e.time) for e in engine(name).run(scene, until=20).pocketings] == times
    if name == "pymunk" and (vx or vy):
        recording = Recording(scene, "log")
        recording.end(20.0)
        assert [float(e.time) for e in recording.trajectory().pocketings] == times
