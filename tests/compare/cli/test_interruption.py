"""Runs that the user ends: by --max-seconds, by Ctrl-C, by the work a question may cost. What is shown is whole."""

from __future__ import annotations

import json
import signal
import subprocess
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias

import jsonschema
import numpy as np
import pytest
from command_line import done
from ended import ended_at

from truebreak.compare import compare, engine, trajectory_json
from truebreak.compare.deadline import Clock, OutOfTime, time_limit
from truebreak.compare.orders.all_orders import all_orders, search_orders
from truebreak.compare.report.schema import schema
from truebreak.exact import ExactEngine
from truebreak.exact.simulation.decider import History, Noted
from truebreak.exact.simulation.loop import Loop
from truebreak.scenarios import Scene, SceneError, StopReason, Trajectory, catalogue
from truebreak.scenarios.errors import TimeIsUp
from truebreak.scenarios.trajectory import Stop

ENDLESS = {
    "exact": ["--events", "10000000"],
    "double": ["--events", "10000000"],
    "interval:bits=20000": ["--events", "10000000"],
    "pymunk:max_steps=1000000000": ["--until", "10000000"],
    "sympy": ["--events", "10000000"],
}
"""Runs that nobody waits for."""


def endless(name: str) -> str:
    """The scene for one: ten discs; for sympy, which predicts all pairs by itself, two."""
    return "galperin:n=3" if name == "sympy" else "gas"


def patience(name: str) -> str:
    """Seconds in which a run has some events, and not too many; sympy derives its laws first."""
    return {"sympy": "9", "double": "0.6"}.get(name, "1.5")


Said: TypeAlias = "subprocess.CompletedProcess[str]"


def patiently(*words: str, enough: Callable[[Said], bool]) -> tuple[Said, int]:
    """What a command that runs out of time says once it has something to show, and its seconds."""
    for seconds in (3, 12, 48):
        said = done(*words, "--max-seconds", str(seconds), "--json")
        if enough(said):
            return said, seconds
    raise AssertionError(said)


def assert_beginning(told: dict[str, Any], whole: Trajectory) -> None:
    """A partial result as JSON is what the whole run has up to a whole instant, and nothing else."""
    few = {**told, "events": told["events"][:500]}  # the validator takes its time
    jsonschema.Draft202012Validator(schema("trajectory-1")).validate(few)
    count = len(told["events"])
    expected = trajectory_json(whole)
    assert told["events"] == expected["events"][:count]
    assert told["final"] == expected["final"]


def finished(name: str, told: dict[str, Any], scene: Scene) -> Trajectory:
    """The run of an engine to where a partial result ends."""
    if name.startswith("pymunk"):
        return engine(name).run(scene, until=told["final"]["time"])
    return engine(name).run(scene, events=len(told["events"]))


# -- --max-seconds


@pytest.mark.parametrize("name", ENDLESS)
def test_a_run_out_of_time_shows_what_it_has(name: str) -> None:
    said = done("run", endless(name), "--engine", name, *ENDLESS[name], "--max-seconds", patience(name), "--json")
    assert (said.returncode, said.stderr) == (4, "")
    told = json.loads(said.stdout)
    assert told["stop"] == {
        "reason": "budget",
        "message": f"the budget is spent: {patience(name)} seconds (--max-seconds)",
    }
    if told["events"] and "interval" not in name:
        assert_beginning(told, finished(name, told, catalogue.build(endless(name))))


def test_a_run_out_of_time_is_shown_to_people() -> None:
    said = done("run", "gas", *ENDLESS["exact"], "--max-seconds", "1")
    assert (said.returncode, said.stderr) == (4, "")
    assert "stopped: the budget is spent: 1 second (--max-seconds)" in said.stdout
    assert "at the end" in said.stdout


def test_a_run_in_time_does_not_notice() -> None:
    bounded, free = (done("run", "galperin:n=1", "--json", *words) for words in (["--max-seconds", "60"], []))
    assert (bounded.returncode, bounded.stdout) == (0, free.stdout)


def test_a_comparison_out_of_time_goes_over_what_there_is(tmp_path: Path) -> None:
    path = tmp_path / "report.html"
    words = ["compare", "gas", *ENDLESS["exact"], "--engines", "interval:bits=4000,double", "--html", str(path)]

    def enough(said: Said) -> bool:
        return said.returncode == 1 and json.loads(said.stdout)["reference"]["events"] > 100

    told = json.loads(patiently(*words, enough=enough)[0].stdout)
    jsonschema.Draft202012Validator(schema("comparison-5")).validate(told)
    assert told["reference"]["stop"]["reason"] == "budget"
    interval, double = told["candidates"]
    assert interval["stop"]["reason"] == "budget"
    assert interval["verdict"] == "undecided"
    assert double["verdict"] == "diverged"
    assert "</html>" in path.read_text(encoding="utf-8")


def test_a_comparison_out_of_time_without_a_difference_is_undecided() -> None:
    comparison = compare(catalogue.build("gas"), ["exact"], events=10**7, max_seconds=0.3)
    assert comparison.reference.stop.message == "the budget is spent: 0.3 seconds (--max-seconds)"
    assert comparison.verdict == "undecided"
    assert comparison["exact"].alignment.divergence is None


def test_orders_out_of_time_are_those_found() -> None:
    words = ["orders", "rack:rows=4", "--events", "40", "--cap", "100000"]
    said, seconds = patiently(*words, enough=lambda said: bool(json.loads(said.stdout)["outcomes"]))
    assert (said.returncode, said.stderr) == (4, "")
    told = json.loads(said.stdout)
    jsonschema.Draft202012Validator(schema("orders-2")).validate(told)
    assert told["stop"] == {"reason": "budget", "message": f"the budget is spent: {seconds} seconds (--max-seconds)"}
    assert told["complete"] is False
    assert {outcome["stop"]["reason"] for outcome in told["outcomes"]} == {"events"}
    said = done("orders", "gas", "--events", "10000000", "--max-seconds", "1")
    assert said.returncode == 4
    assert "0 outcomes so far: the budget is spent: 1 second (--max-seconds)." in said.stdout


@pytest.mark.parametrize("cap", [1, 4, 10**6])
def test_a_search_cut_short_has_the_first_outcomes_of_the_whole(cap: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whether it is cut while it enumerates or while it draws."""
    scene, limits = catalogue.build("rack:rows=3"), {"events": 3, "cap": cap, "samples": 30}
    whole = all_orders(ExactEngine(), scene, **limits)
    runs: list[int] = []

    def over(self: Clock) -> bool:
        return len(runs) >= 6

    class Counting(ExactEngine):
        def run_with(self, *args: Any, **kwargs: Any) -> Trajectory:
            runs.append(1)
            return super().run_with(*args, **kwargs)

    monkeypatch.setattr(Clock, "over", property(over))
    search = search_orders(Counting(), scene, max_seconds=100, **limits)
    assert search.stop == Stop(StopReason.BUDGET, "the budget is spent: 100 seconds (--max-seconds)")
    found = [outcome.decisions for outcome in search.tree.outcomes]
    assert found == [outcome.decisions for outcome in whole.outcomes][: len(found)]
    assert len(found) > 0
    assert not search.tree.complete
    assert search.tree.sampled == (5 if cap == 1 else search.tree.sampled)
    assert len(runs) == 6


def test_what_was_found_stays_when_the_time_is_up_before_a_run_has_begun(monkeypatch: pytest.MonkeyPatch) -> None:
    """The alarm can ring in a run's first lines, where no loop catches it yet."""
    runs: list[int] = []

    class Late(ExactEngine):
        def run_with(self, *args: Any, **kwargs: Any) -> Trajectory:
            runs.append(1)
            if len(runs) == 4:
                monkeypatch.setattr(Clock, "over", property(lambda self: True))
                raise TimeIsUp("enough")
            return super().run_with(*args, **kwargs)

    search = search_orders(Late(), catalogue.build("rack:rows=3"), events=3, max_seconds=100)
    assert search.stop == Stop(StopReason.BUDGET, "the budget is spent: 100 seconds (--max-seconds)")
    assert (len(search.tree.outcomes) > 0, search.tree.complete, len(runs)) == (True, False, 4)


@pytest.mark.parametrize("seconds", [0, -1, float("nan"), float("inf"), 1e300])
def test_seconds_that_are_none(seconds: float) -> None:
    with pytest.raises(SceneError, match="max_seconds"), time_limit(seconds):
        pass


@pytest.mark.parametrize("command", ["run", "compare", "orders"])
@pytest.mark.parametrize("words", [["--max-seconds", "0"], ["--max-seconds", "nan"], ["--work", "0"]])
def test_limits_that_are_none_are_usage(command: str, words: list[str]) -> None:
    said = done(command, "lee", *words)
    assert (said.returncode, said.stdout) == (2, "")
    assert len(said.stderr.splitlines()) == 1


# -- wherever it comes

SCENES: dict[str, Callable[[], Scene]] = {
    "gas": lambda: catalogue.build("gas").with_changes(until=None, events=120),
    "there and back": lambda: catalogue.build("gas:n=4").with_changes(until=None, events=None, reverse_after=40),
    "captures": lambda: catalogue.build("rack:rows=3").with_changes(until=None, events=100, capture=True),
    "orders": lambda: catalogue.build("rack:rows=4,tie=sequential:seed=2").with_changes(until=None, events=60),
    "symmetry": lambda: catalogue.build("inscribed:n=6").with_changes(until=None, events=60),
}


def assert_same_state(part: Trajectory, whole: Trajectory) -> None:
    """Where a run ended, the whole one has the same places; and where it ended with an event, velocities."""
    end, count = float(part.final_time), len(part.events)
    if count and float(whole.events[count - 1].time) == end:
        if part.reversal is None or part.reversal.after < count or whole.events[count:]:
            expected = whole.at(whole.events[count - 1].time).array()
            if part.reversal is not None and part.reversal.after == count:
                expected[:, 2:] = -expected[:, 2:]
            assert np.allclose(part.final.array(), expected, rtol=0, atol=1e-6)
    else:
        assert np.allclose(part.final.array()[:, :2], whole.sample([end])[0, :, :2], rtol=0, atol=1e-6)


@pytest.mark.parametrize("name", ["exact", "rounded:bits=53"])
@pytest.mark.parametrize("kind", SCENES)
def test_a_run_that_is_ended_anywhere_ends_at_a_whole_instant(
    kind: str, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Events, entries, the reversal and the final state are those of the whole run up to there."""
    scene, played = SCENES[kind](), engine(name)
    with ended_at(0, True, KeyboardInterrupt(), monkeypatch) as counted:
        whole = played.run(scene)
    for k in range(24):
        error = TimeIsUp("enough") if k % 2 else KeyboardInterrupt()
        with ended_at(1 + counted[0] * k // 24, k % 3 == 0, error, monkeypatch):
            part = played.run(scene)
        assert part.stop.reason in (StopReason.BUDGET, StopReason.INTERRUPTED)
        told = "the budget is spent: enough" if k % 2 else f"interrupted: after {len(part.events)} events"
        assert part.stop.message == told
        assert [(float(e.time), e.contacts, e.impulses, e.ties) for e in part.events] == [
            (float(e.time), e.contacts, e.impulses, e.ties) for e in whole.events[: len(part.events)]
        ]
        end = float(part.final_time)
        entries = [(float(p.time), p.circle, p.pocket) for p in whole.pocketings]
        assert [(float(p.time), p.circle, p.pocket) for p in part.pocketings] == [e for e in entries if e[0] <= end]
        assert sum(float(e.time) <= end for e in whole.events) == len(part.events)
        if part.reversal is not None:
            assert whole.reversal is not None
            assert (part.reversal.after, float(part.reversal.time)) == (
                whole.reversal.after,
                float(whole.reversal.time),
            )
        elif whole.reversal is not None:
            assert end < float(whole.reversal.time) or len(part.events) < whole.reversal.after
        assert_same_state(part, whole)


@pytest.mark.parametrize("name", ["exact", "double", "interval"])
@pytest.mark.parametrize("error", [TimeIsUp("enough"), KeyboardInterrupt()])
def test_a_run_that_is_ended_before_it_begins_is_at_its_start(
    name: str, error: BaseException, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The very first thing that the loop asks for is not had."""

    def ended(*_: object) -> None:
        raise error

    monkeypatch.setattr(Loop, "_open", ended)
    scene = catalogue.build("gas")
    part = engine(name).run(scene, events=50)
    assert part.stop.reason in (StopReason.BUDGET, StopReason.INTERRUPTED)
    assert (part.events, float(part.final_time)) == ((), 0.0)
    start = [[float(q) for q in (c.x, c.y, c.vx, c.vy)] for c in scene.circles]
    assert np.allclose(part.final.array(), start)
    assert json.dumps(trajectory_json(part))


def interrupting(monkeypatch: pytest.MonkeyPatch, when: Callable[[History, Noted], bool]) -> None:
    """Interrupts a run when an instant is half noted."""
    add = History.add

    def half(self: History, note: Noted) -> None:
        if when(self, note):
            self.records += note.records
            raise KeyboardInterrupt
        add(self, note)

    monkeypatch.setattr(History, "add", half)


def test_an_instant_that_is_half_noted_is_dropped(monkeypatch: pytest.MonkeyPatch) -> None:
    interrupting(monkeypatch, lambda history, note: len(history.records) == 5)
    part = ExactEngine().run(catalogue.build("rack:rows=3,pockets=yes"), events=50)  # with pockets there are no strides
    assert len(part.events) == 5
    assert part.stop == Stop(StopReason.INTERRUPTED, "interrupted: after 5 events")


def test_an_instant_that_is_noted_up_to_its_reversal_is_dropped(monkeypatch: pytest.MonkeyPatch) -> None:
    interrupting(monkeypatch, lambda history, note: note.reversal is not None)
    part = ExactEngine().run(SCENES["there and back"]())
    assert part.reversal is None
    assert len(part.events) == 39
    assert part.stop.message == "interrupted: after 39 events"


def test_where_there_are_no_timers_progress_ends_a_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """As in a thread that is not the main one."""
    found: list[Trajectory] = []

    def work() -> None:
        with time_limit(0.5) as watch:
            found.append(ExactEngine().run(catalogue.build("gas"), events=10**7, progress=watch.watched(None)))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join(60)
    assert found[0].stop.message == "the budget is spent: 0.5 seconds (--max-seconds)"
    monkeypatch.delattr(signal, "setitimer")
    with time_limit(0.5) as watch:
        run = ExactEngine().run(catalogue.build("gas"), events=10**7, progress=watch.watched(None))
    assert run.stop.reason is StopReason.BUDGET


def test_what_is_not_in_a_loop_is_not_ended() -> None:
    """The timer goes on until there is something to end; the handler and timer of before come back."""
    handler, timer = signal.getsignal(signal.SIGALRM), signal.getitimer(signal.ITIMER_REAL)
    with time_limit(0.05) as watch:
        end = time.monotonic() + 0.2
        while time.monotonic() < end:
            pass
        assert watch.over
        run = ExactEngine().run(catalogue.build("gas"), events=10**7)
    assert run.stop.reason is StopReason.BUDGET
    assert signal.getsignal(signal.SIGALRM) is handler
    assert (signal.getitimer(signal.ITIMER_REAL)[0] > 0) == (timer[0] > 0)


def test_time_that_is_up_where_nothing_is_left_is_said() -> None:
    with pytest.raises(OutOfTime, match="3 seconds"), time_limit(3):
        raise TimeIsUp("3 seconds")
