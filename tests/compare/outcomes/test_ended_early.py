"""A run that ends before the span does is held against the reference up to its end, also after a divergence."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from command_line import said

from truebreak.compare import compare
from truebreak.compare.comparison import Comparison, studied
from truebreak.compare.deadline import Clock
from truebreak.compare.foreign import LogEngine, Recording
from truebreak.compare.grids.family_sweep import SweepJob
from truebreak.compare.grids.goals import OutcomeGoal
from truebreak.compare.grids.row import compared
from truebreak.compare.grids.scene_family import Perturbed
from truebreak.compare.report.changes import changes_of
from truebreak.compare.report.documents import comparison_json
from truebreak.compare.report.grid_tables import outcome_words
from truebreak.compare.report.html import changed, html_report, kept
from truebreak.compare.report.schema import schema
from truebreak.compare.report.sentences import consequence_phrase
from truebreak.compare.report.terminal import changed_text
from truebreak.compare.testing.check import CheckFailed, check
from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Circle, Scene, Trajectory, Wall, catalogue
from truebreak.scenarios.engine import Declared
from truebreak.scenarios.numbers.quantity import Quantity

GAS = catalogue.build("gas:n=4")
TRUE = ExactEngine().run(GAS, events=220)
DOUBLE = DoubleEngine().run(GAS, events=260)
HITS = [(float(event.time), *pair) for event in DOUBLE.events for pair in event.impulses]
"""Of an engine that leaves the history at event 78."""

TIED = Scene(
    [Circle(-3, 0, vx=1, id="a"), Circle(0, 0, id="b"), Circle(3, 0, vx=-1, id="c")],
    [Wall(-20, 0, -20, 1, id="left"), Wall(20, 0, 20, 1, id="right")],
)


def logged(
    hits: Sequence[tuple[float, str, str]], scene: Scene = GAS, end: float | None = None, quiet: bool = False
) -> LogEngine:
    recording = Recording(scene, "log")
    for time, a, b in hits:
        recording.hit(time, a, b)
    recording.end(end, quiet=quiet)
    return LogEngine(recording)


@dataclass(frozen=True)
class Blind(Declared):
    """An engine that does not see the circle b, and notes up to when it is asked."""

    asked: list[float]
    step: float | None = None

    @property
    def name(self) -> str:
        return "blind"

    def run(self, scene: Scene, *, until: Any = None, events: int | None = None, progress: Any = None) -> Trajectory:
        self.asked.append(float(until))
        seen = [replace(c, y=Quantity.of(500)) if c.id == "b" else c for c in scene.circles]
        told = DoubleEngine().run(scene.with_changes(circles=seen), until=until, events=events)
        return replace(told, scene=scene, engine=self.name)


def held(hits: int, end: float | None = None) -> Comparison:
    return compare(GAS, [logged(HITS[:hits], end=end)], events=200, causes=False)


@pytest.mark.parametrize("hits", [79, 80, 85, 120, 150])
@pytest.mark.parametrize("between", [0.0, 0.5])
def test_a_diverged_log_is_held_against_the_reference_up_to_its_end(hits: int, between: float) -> None:
    end = HITS[hits - 1][0] + between * (HITS[hits][0] - HITS[hits - 1][0])
    found = held(hits, end)
    (log,) = found.candidates
    assert (log.verdict, log.until, log.whole) == ("diverged", end, False)
    assert log.outcomes["collisions"] == hits
    assert log.expected["collisions"] == sum(float(event.time) <= end for event in TRUE.events)
    assert ("collisions" in log.changed) == (log.expected["collisions"] != hits)
    true = TRUE.at(end)
    assert log.expected["final_velocities"] == {
        c.id: pytest.approx([float(true[str(c.id)].vx), float(true[str(c.id)].vy)], abs=1e-9) for c in GAS.circles
    }
    assert log.pattern is None


def test_what_lies_beyond_the_end_is_not_claimed() -> None:
    """The same log ended where it agreed, and where it had parted: neither has fewer collisions than the whole run."""
    agreed, (parted,) = held(60), held(120).candidates
    assert (agreed.verdict, agreed["log"].changed) == ("unsettled", ())
    assert parted.expected["collisions"] < 200
    text = consequence_phrase(held(120), parted)
    assert text == "up to t = 196.086551, where its record ends: 120 collisions instead of 111"


def test_a_log_of_all_the_span_is_told_as_before() -> None:
    for log, options in ((logged(HITS[:260]), {"events": 200}), (logged(HITS[:120]), {"until": 180})):
        (whole,) = compare(GAS, [log], causes=False, **options).candidates  # type: ignore[arg-type]
        assert (whole.verdict, whole.until, whole.whole) == ("diverged", None, True)
        assert changed_text(whole).startswith("log changed: ")


def test_a_log_that_says_that_nothing_is_left_is_whole() -> None:
    found = compare(GAS, [logged(HITS[:120], quiet=True)], events=200, causes=False)
    assert found["log"].until is None
    assert (found["log"].outcomes["collisions"], found["log"].expected["collisions"]) == (120, 200)
    assert (consequence_phrase(found, found["log"]) or "").startswith("120 collisions instead of 200")


@pytest.mark.parametrize(
    ("tie", "until"),
    [([("a", "b")], pytest.approx(1.0)), ([("b", "c")], pytest.approx(1.0)), ([("a", "b"), ("b", "c")], 1.0)],
)
def test_a_log_that_ends_in_the_midst_of_a_tie_tells_what_was_before(tie: list[tuple[str, str]], until: float) -> None:
    (log,) = compare(TIED, [logged([(1.0, *pair) for pair in tie], TIED)], events=3, causes=False).candidates
    assert log.until == until
    assert log.outcomes["collisions"] == log.expected["collisions"] == (2 if len(tie) == 2 else 0)
    assert "collisions" not in log.changed
    if len(tie) == 1:
        assert log.until is not None
        assert log.until < 1.0
        assert log.changed == ()


def test_what_a_run_may_only_be_late_for_is_no_change() -> None:
    """Far from where it diverged, the log ends a little before a meeting that it would have had a little late."""
    far = [Circle(100, 0, vx=1, id="d"), Circle(104, 0, id="e")]
    scene = Scene(
        [Circle(0, 0, vx=1, id="a"), Circle(3, 0, id="b"), Circle(0, 50, id="c"), *far],
        [Wall(0, -100, 1, -100, id="w"), Wall(500, 0, 500, 1, id="right")],
    )
    reference = ExactEngine().run(scene, events=2)
    assert [event.impulses[0] for event in reference.events] == [("a", "b"), ("d", "e")]
    log = logged([(1.0, "a", "c")], scene, end=2.0)
    (late,) = compare(scene, [log], events=3, causes=False).candidates
    assert (late.verdict, late.until) == ("diverged", 2.0)
    assert "who_hit_whom" in late.changed
    assert late.expected["collisions"] == 2
    assert "collisions" not in late.changed  # 1, and may be 2 with the meeting that may be late


@pytest.mark.parametrize("engine", ["pymunk:dt=1/8,max_steps=1500", "rounded:bits=6"])
def test_an_engine_that_stops_after_diverging_is_held_up_to_its_stop(engine: str) -> None:
    (found,) = compare(GAS, [engine], events=200, causes=False).candidates
    assert found.verdict == "diverged"
    if found.until is None:
        pytest.skip("it comes to the end of the span")
    assert found.until == float(found.trajectory.final_time)
    assert found.expected["collisions"] == sum(float(event.time) <= found.until for event in TRUE.events)
    assert "where its run ends" in changed_text(found)


def test_a_span_without_end_is_told_by_a_run_whose_circles_all_part() -> None:
    """The log has a pass through the fixed circle: behind it there is a wall, or nothing more to meet."""
    circles = [Circle(0, 0, vx=1, id="a"), Circle(4, 0, m="oo", id="b")]
    for walls, whole in (([Wall(1000, 0, 1000, 1, id="right")], False), ([], True)):
        scene = Scene(circles, walls)
        (ended,) = compare(scene, [logged([], scene, end=40.0)], causes=False).candidates
        assert (ended.verdict, ended.whole) == ("diverged", whole)
        assert ended.until == (None if whole else float(ended.trajectory.final_time))


def test_an_engine_that_left_a_history_with_an_end_is_taken_on_to_its_own() -> None:
    """The certified run has no meeting; displaced, the point comes in between the discs, and meets them a while."""
    scene = catalogue.build("three-disc:distance=5/2,seed=19")
    (near,) = compare(scene, [Perturbed(Quantity.of("1/3"), 18)], causes=False).candidates
    assert (near.verdict, near.until) == ("diverged", None)
    assert (near.expected["collisions"], near.outcomes["collisions"]) == (0, 9)
    job = SweepJob(18, "three-disc:distance=5/2,seed=19", {}, ("perturbed:1/3",), outcomes=("collisions",))
    (row,) = job.rows()
    assert (row.events, row.verdict, row.changed) == (0, "diverged", ["collisions"])


@pytest.mark.parametrize(("step", "times"), [(None, [1, 4, 16]), (1 / 64, [1, 4])])
def test_an_engine_that_has_no_end_is_not_run_for_ever(step: float | None, times: list[float]) -> None:
    """It takes no notice of one fixed circle, and goes to and fro between the two behind it."""
    circles = [Circle(x, 0, m="oo", id=name) for name, x in (("c", 10), ("d", -10))]
    scene = Scene([Circle(0, 0, vx=1, id="a"), Circle(4, 1, m="oo", id="b"), *circles])
    blind = Blind([], step)
    (endless,) = compare(scene, [blind], causes=False).candidates
    assert (endless.verdict, endless.until, endless.whole) == ("diverged", blind.asked[-1], False)
    assert [later / blind.asked[0] for later in blind.asked] == pytest.approx(times)


def test_every_report_says_up_to_where(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = held(120)
    (log,) = found.candidates
    told = "up to t = 196.086551, where its record ends"
    assert changed_text(log).startswith(f"log, {told}: changed: collisions")
    assert changed_text(log).endswith("; what lies beyond is not settled")
    data = comparison_json(found)
    jsonschema.Draft202012Validator(schema("comparison-5")).validate(data)
    (mine,) = data["candidates"]
    assert (mine["outcomes_until"], mine["outcomes_expected"]["collisions"]) == (log.until, 111)
    page = html_report(found).replace("\N{NO-BREAK SPACE}", " ")
    assert f"U{told[1:]}: 120 collisions instead of 111" in page
    assert "120, not 111, up to t = 196.086551" in page
    assert f"log, {told}: changed 3 of 4" in page
    path = tmp_path / "log.jsonl"
    path.write_text("".join(json.dumps({"time": t, "contact": [a, b]}) + "\n" for t, a, b in HITS[:120]), "utf-8")
    code, out, _ = said(capsys, "judge", "gas:n=4", str(path), "--events", "200")
    assert code == 1
    assert f"U{told[1:]}: 120 collisions instead of 111" in " ".join(out.split())
    with pytest.raises(CheckFailed, match=f"known: +{told}; what lies beyond is not settled"):
        check(logged(HITS[:120]), GAS, events=200)


def test_the_page_holds_no_outcome_of_a_part_to_be_kept() -> None:
    found = held(120)
    names = [one.name for one in changed(found)]
    assert "collisions" in names
    assert not {*names} & {name for name, _ in kept(found)}


def test_a_suite_and_advice_tell_no_outcome_of_a_part() -> None:
    log = logged(HITS[:120])
    study = studied(GAS, ExactEngine(), Clock(None), None, 200)
    row = compared(study, held(120)["log"], 0, "gas:n=4")
    assert outcome_words(row) == "not known"
    assert outcome_words(replace(row, until=None)) == "wrong"
    judged = OutcomeGoal("collisions").judge(study, "log", log)
    assert not judged.right
    assert judged.result.startswith("stops at t = 196.087: the record ends")


def test_a_sweep_tells_no_outcome_of_a_part(monkeypatch: pytest.MonkeyPatch) -> None:
    for hits, told in ((120, None), (260, ["collisions"])):
        monkeypatch.setattr("truebreak.compare.grids.family_sweep.engine_of", lambda label, seed: log)  # noqa: B023
        log = logged(HITS[:hits])
        (row,) = SweepJob(0, "gas:n=4", {}, ("log",), 200, ("collisions",)).rows()
        assert (row.verdict, row.changed) == ("diverged", told)


def test_two_logs_of_other_ends_are_not_held_against_each_other() -> None:
    short, long = logged(HITS[:120]), replace(logged(HITS[:150]), name="other")
    (change,) = changes_of(compare(GAS, [short, long], events=200, causes=False))
    assert change.outcomes == ()
