"""Logs that tell, in doubles, what the exact run has: none is said to differ, wherever it ends, whatever is asked."""

from __future__ import annotations

import math
from dataclasses import dataclass
from random import Random
from typing import Any

import pytest
from fuzz.generators import PLAIN, case_of

from truebreak.compare import compare
from truebreak.compare.foreign import LogEngine, RecordedEngine, Recording
from truebreak.compare.validation import EngineError
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Pocket, Scene, StopReason, Trajectory, Wall

WORK = 100_000

BELOW_DOUBLES = ("raft", "pocket_rafts", "on_rim", "pressed", "entry_ties", "holes", "rim_instant", "neighbours")
"""Kinds with pockets and contacts that differ by less than double resolution, where a log of doubles says otherwise."""

PLAYED = tuple(kind for kind in PLAIN if kind not in (*BELOW_DOUBLES, "wedged"))
"""The others, but for one in which a circle may strike two walls without end before the double of a time is over."""

FOUND = (
    *(("instant", 4), ("onto_pair", 4), ("wedged", 9), ("graze_blow", 11), ("near_ties", 13), ("corner", 20)),
    *(("raft", 24), ("slide", 28), ("wedged", 28), ("corner", 28), ("neighbours", 29), ("pressed", 33)),
    *(("raft", 36), ("wedged", 37), ("mirrored", 49), ("on_rim", 3), ("pressed", 6)),
)
"""Cases that were said to differ: events at one double, a reversal at that of an event, an end between them."""


def told(scene: Scene, run: Trajectory, events: int) -> Recording:
    """A log of a run's first events. Impulses one after the other, as by a sequential policy, are so many lines."""
    recording = Recording(scene, "log")
    for event in run.events[:events]:
        state = run.after(event.index)
        moving = {c.id: c for c in state.circles if not scene.circles[scene.ids.index(c.id)].fixed}
        states = {name: (float(c.x), float(c.y), float(c.vx), float(c.vy)) for name, c in moving.items()}
        pairs = [(pair.first, pair.second) for pair in event.impulses]
        if scene.tie_policy.name == "sequential":
            for pair in pairs[:-1]:
                recording.hit(float(event.time), *pair)
            pairs = pairs[-1:]
        recording.hits(float(event.time), pairs, states)
    return recording


def holds(kind: str, seed: int) -> bool:
    """Asserts it of one scene; whether that has an exact run to be told."""
    draw, scene = Random(f"{kind}-{seed}"), case_of(kind, seed).scene
    engine = ExactEngine(work=WORK)
    run = engine.run(scene, events=draw.choice([6, 15, 25]))
    if scene.capture or not run.events or run.stop.reason in (StopReason.UNDECIDED, StopReason.BUDGET):
        return False
    times = [float(event.time) for event in run.events]
    for events in sorted({0, 1, len(times) // 2, len(times)} | {draw.randint(0, len(times))}):
        ends = [float(run.final_time) if events == len(times) else times[events]]
        before = times[events - 1] if events else 0.0
        ends += [before, before + (ends[0] - before) * draw.random()]
        limits: list[dict[str, Any]] = [{"events": max(events, 1)}, {"events": len(times)}]
        limits += [{"until": end} for end in ends if end > 0.0]
        if run.stop.reason is StopReason.QUIET:
            limits.append({})
        recording = told(scene, run, events)
        over = events == len(times) and run.stop.reason is StopReason.QUIET
        recording.end(max(before, ends[0]) if over else draw.choice(ends[1:]), quiet=over)
        for asked in limits:
            (log,) = compare(scene, [LogEngine(recording)], reference=engine, causes=False, **asked).candidates
            assert log.verdict in ("agree", "unsettled"), (events, asked)
            assert log.changed == (), (events, asked)
    return True


@pytest.mark.parametrize(("kind", "seed"), FOUND)
def test_a_log_that_was_said_to_differ(kind: str, seed: int) -> None:
    assert holds(kind, seed)


@pytest.mark.parametrize("kind", PLAYED)
def test_a_log_of_the_exact_run_differs_in_nothing(kind: str) -> None:
    assert sum(holds(kind, seed) for seed in range(1, 5)) > 0


@pytest.mark.slow
@pytest.mark.parametrize("kind", PLAYED)
def test_many_logs_of_exact_runs_differ_in_nothing(kind: str) -> None:
    assert sum(holds(kind, seed) for seed in range(5, 41)) > 0


def with_captures(scene: Scene, run: Trajectory, says: str) -> Recording:
    """A log of a run in which pockets capture: it is `silent` of that, `stops` what is captured, or says `all`."""
    recording = Recording(scene, "log")
    happened = [(float(event.time), 0, k) for k, event in enumerate(run.events)]
    happened += [(float(entry.time), 1, k) for k, entry in enumerate(run.pocketings)]
    for time, entered, k in sorted(happened):
        state = run.at(run.pocketings[k].time) if entered else run.after(k)
        rows = {str(c.id): (float(c.x), float(c.y), float(c.vx), float(c.vy)) for c in state.circles}
        if entered and says != "silent":
            name = run.pocketings[k].circle
            recording.state(time, {name: (*rows[name][:2], 0.0, 0.0)})
        elif not entered:
            pairs = [(pair.first, pair.second) for pair in run.events[k].impulses]
            met = {name for pair in pairs for name in pair if name in rows}
            recording.hits(time, pairs, rows if says == "all" else {name: rows[name] for name in met})
    recording.end(float(run.final_time))
    return recording


@pytest.mark.parametrize("says", ["silent", "stops", "all"])
def test_what_a_pocket_stops_breaks_no_law_and_an_ignored_pocket_does(says: str) -> None:
    """Whatever an engine says of it, also where a circle is struck at the instant at which it is captured."""
    seen = 0
    for kind, seed in (("entry_ties", 0), ("entry_ties", 11), ("pressed", 20), ("pressed", 25)):
        scene = case_of(kind, seed).scene
        run = ExactEngine(work=WORK).run(scene, events=12)
        seen += len(run.pocketings) if scene.capture and run.events else 0
        for capture in (True, False):  # the log of an engine that ignores the pocket, too
            own = ExactEngine(work=WORK).run(scene.with_changes(capture=capture), events=12)
            log = LogEngine(with_captures(scene, own, says if capture else "silent"), lacks=frozenset())
            (found,) = compare(scene, [log], until=float(own.final_time) or 1, causes=False).candidates
            same = capture or [e.contacts for e in own.events] == [e.contacts for e in run.events]
            assert found.verdict == "agree" or not same, (kind, seed)
            assert same or found.lawless or found.verdict == "diverged", (kind, seed)
            assert not capture or (found.laws is not None and found.laws.kept), (kind, seed)
    assert seen >= 6


@pytest.mark.parametrize("place", [(6.75, 0.0), (8.0, 1 / 3), (-50.0, -50.0)])
@pytest.mark.parametrize("step", [None, 1 / 64])
def test_a_captured_disc_may_lie_anywhere_and_stays_out_of_play(place: tuple[float, float], step: float | None) -> None:
    scene = Scene(
        [Circle(0, 0, vx=1, id="a"), Circle(4, 7, vx=1, id="b")],
        [Wall(20, 0, 20, 1, id="w")],
        pockets=[Pocket(8, "1/3", "7/5", id="p")],
        capture=True,
    )
    recording = Recording(scene, "log", step=step)
    recording.state(6.75, {"a": (*place, 0.0, 0.0), "b": (10.75, 7.0, 1.0, 0.0)})
    rest = {"a": (*place, 0.0, 0.0), "b": (19.0, 7.0, -1.0, 0.0)}
    recording.hit(15.0, "b", "w", rest)
    recording.state(15.0, rest)
    recording.end(16.0)
    (found,) = compare(scene, [LogEngine(recording, step=step, lacks=frozenset())], until=16).candidates
    assert found.verdict == "agree" and found.laws is not None and found.laws.kept is not False, found.laws
    assert [entry.circle for entry in recording.trajectory().pocketings] == ["a"]
    early = Recording(scene, "log", step=step)
    with pytest.raises(EngineError, match="no contact near it explains how"):  # nothing has captured it yet
        early.state(5.0, {"a": (8.0, 1 / 3, 0.0, 0.0), "b": (9.0, 7.0, 1.0, 0.0)})


@dataclass(frozen=True)
class Pockets(RecordedEngine):
    """Steps that see at their ends whose centre is in a pocket, and stop those, or do `nothing`, or say no `more`."""

    step: float = 1 / 64
    habit: str = "stops"
    name, scene_keys = "pockets", frozenset({"wall", "pocket", "capture"})

    def play(self, scene: Scene, recording: Recording) -> None:
        rows = [list(row) for row in recording.rows]
        ((px, py, pr),), number = [(float(p.x), float(p.y), float(p.r)) for p in scene.pockets], 0
        gone: set[int] = set()
        while recording.open:
            number += 1
            for k, row in enumerate(rows):
                row[0], row[1] = row[0] + self.step * row[2], row[1] + self.step * row[3]
                row[2] = -row[2] if abs(row[0]) > 19 and row[0] * row[2] > 0 else row[2]
                if self.habit != "nothing" and math.hypot(row[0] - px, row[1] - py) < pr:
                    gone.add(k)
                    row[2] = row[3] = 0.0
            told = {name: tuple(row) for k, (name, row) in enumerate(zip(scene.ids, rows, strict=False))
                    if k not in gone or self.habit != "more"}  # fmt: skip
            recording.state(number * self.step, told)


@pytest.mark.parametrize("habit", ["stops", "more", "nothing"])
def test_an_engine_of_steps_that_ignores_a_pocket_does_not_keep_the_law(habit: str) -> None:
    """That was said to be an overlap."""
    discs = [Circle(0, 0, vx=1, id="a"), Circle(0, 9, vx=1, id="b")]
    walls = [Wall(20, 0, 20, 1, id="right"), Wall(-20, 0, -20, 1, id="left")]
    for y in ("0", "1/3", "13/10"):
        scene = Scene(discs, walls, pockets=[Pocket(8, y, "7/5", id="p")], capture=True)
        (found,) = compare(scene, [Pockets(habit=habit)], until=50).candidates
        assert found.laws is not None and found.lawless is (habit == "nothing"), found.laws.sentence
        assert found.verdict == ("diverged" if habit == "nothing" else "agree")
        if habit == "nothing":
            assert found.laws.first is not None and found.laws.first.kind == "capture"
            assert found.diagnosis is not None and found.diagnosis.name.value == "law not kept"


def test_a_velocity_that_is_rounded_otherwise_is_no_contact() -> None:
    """An engine of steps whose numbers are those of the scene but for the last bits: at first, or from step to step."""
    scene = Scene([Circle("1/3", 0, vx="1/10", id="a"), Circle(9, 0, id="b")], [Wall(20, 0, 20, 1, id="w")])
    recording, speed = Recording(scene, "steps", step=0.125), 0.1
    for number in range(1, 200):
        speed *= 1 + 2.0**-44
        recording.state(
            0.125 * number, {"a": (1 / 3 + 0.1 * 0.125 * number, 0.0, speed, 0.0), "b": (9.0, 0.0, 0.0, 0.0)}
        )
    recording.end()
    run = recording.trajectory()
    assert run.events == ()
    assert float(run.final["a"].vx) == speed
    (found,) = compare(scene, [LogEngine(recording, step=0.125)], until=20, causes=False).candidates
    assert (found.verdict, found.changed) == ("agree", ())


def test_ties_told_by_time_alone_are_not_judged_by_velocities_that_are_reckoned() -> None:
    for kind, seed in (("graze_blow", 9), ("corner", 31), ("instant", 32), ("slide", 7)):
        scene = case_of(kind, seed).scene
        run = ExactEngine(work=WORK).run(scene, events=3)
        recording = Recording(scene, "log")
        for event in run.events:
            recording.hits(float(event.time), [(pair.first, pair.second) for pair in event.contacts])
        recording.end()
        (log,) = compare(scene, [LogEngine(recording)], events=len(run.events), causes=False).candidates
        assert log.verdict in ("agree", "unsettled")
        assert log.changed == ()
