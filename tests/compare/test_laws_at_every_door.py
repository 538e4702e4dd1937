"""An engine whose collisions are right, and whose law is not, is right nowhere: in no suite, sweep, map or advice."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from command_line import said
from lawless import Events

from truebreak.compare import compare
from truebreak.compare import minimise as smallest
from truebreak.compare.comparison import studied
from truebreak.compare.deadline import Clock
from truebreak.compare.engines import engine as engine_named
from truebreak.compare.grids.family_sweep import SweepJob, plan
from truebreak.compare.grids.goals import Digits, HistoryGoal, OutcomeGoal
from truebreak.compare.grids.stress_families import MapPlace
from truebreak.compare.grids.stress_map import StressJob
from truebreak.compare.grids.suite_file import Suite, Task, run_suite, since, suite_json
from truebreak.compare.grids.survival import summaries
from truebreak.compare.reduction.smallest import End
from truebreak.compare.report.documents import sweep_json
from truebreak.compare.report.schema import schema
from truebreak.exact import ExactEngine
from truebreak.scenarios import SceneError, catalogue

HOME = "lawless:Events"
LAWLESS = f"{HOME}:restitution=0.999"


@pytest.fixture
def suite() -> Callable[[str], Suite]:
    return lambda text: Suite("mine", (Task("gas:n=3", (f"mine={text}",), events=3),), causes=False)


def test_a_suite_says_which_cell_breaks_a_law(suite: Callable[[str], Suite]) -> None:
    right, wrong = run_suite(suite(HOME)), run_suite(suite(LAWLESS))
    assert [row.agrees for row in right.rows] == [True]
    (row,) = wrong.rows
    assert (wrong.verdict, wrong.lawless, row.verdict, row.agrees) == ("agree", 1, "agree", False)
    assert row.laws == {"kept": False, "finding": "restitution 0.999 fits 3 of 3 impacts"}
    for report in (right, wrong):
        jsonschema.Draft202012Validator(schema("suite-2")).validate(suite_json(report, []))
    (change,) = since(right.rows, wrong)
    assert change.what == "laws"
    assert "breaks no law before, does not keep the law (restitution 0.999 fits 3 of 3 impacts) now" in change.sentence
    jsonschema.Draft202012Validator(schema("suite-2")).validate(suite_json(wrong, [change]))
    earlier = [replace(old, laws=None) for old in right.rows]
    assert [change.what for change in since(earlier, wrong)] == ["outcomes"], "nothing was audited before"


@pytest.mark.parametrize(("engine", "code", "told"), [(HOME, 0, "kept"), (LAWLESS, 1, "in 1 the law is not kept")])
def test_a_suite_with_a_law_not_kept_exits_with_1(
    engine: str, code: int, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(f'engines = ["mine={engine}"]\nevents = 3\n[[scene]]\nname = "gas:n=3"\n', "utf-8")
    found, out, _ = said(capsys, "suite", str(path), "--jobs", "1")
    assert found == code
    assert told in " ".join(out.split())


def test_a_row_of_a_sweep_says_whether_the_laws_are_kept() -> None:
    job = SweepJob(0, "gas:n=3", {}, (HOME, LAWLESS, "perturbed:1e-12"), events=3)
    right, wrong, moved = job.rows()
    assert (right.verdict, right.laws) == ("agree", {"kept": True, "finding": ""})
    assert (wrong.verdict, wrong.lawless) == ("agree", True)
    assert (wrong.laws or {})["finding"] == "restitution 0.999 fits 3 of 3 impacts"
    assert moved.laws is None, "a displaced scene is another scene"
    counts = {summary.engine: summary.laws for summary in summaries([right, wrong, moved])}
    assert counts == {HOME: (1, 0, 0), LAWLESS: (0, 1, 0), "perturbed:1e-12": (0, 0, 0)}
    settings = plan("gas", ["n=3"], [HOME], events=3).settings
    told = sweep_json(settings, 1, summaries([right, wrong]), [], {})
    jsonschema.Draft202012Validator(schema("sweep-2")).validate(told)
    assert [engine["laws"]["not_kept"] for engine in told["engines"]] == [0, 1]
    assert all(row.laws is None for row in replace(job, audit=False).rows())


def test_a_sweep_may_leave_the_audit_out(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("sweep", "gas", "--vary", "n=3", "--engines", "double", "--events", "3", "--jobs", "1")
    assert "1 kept" in " ".join(said(capsys, *words)[1].split())
    data = json.loads(said(capsys, *words, "--no-audit", "--json")[1])
    assert (data["settings"]["audit"], data["engines"][0]["laws"]["kept"]) == (False, 0)


def test_a_place_of_the_map_where_a_law_is_broken_is_wrong() -> None:
    _, right, wrong = StressJob(0, MapPlace("near-ties", 2, "left"), (HOME, LAWLESS)).rows()
    assert right.mark == "right"
    assert (wrong.mark, wrong.event, wrong.lawless) == ("wrong", None, True)


@pytest.mark.parametrize("goal", [HistoryGoal(3), OutcomeGoal("collisions", 3), Digits(1, 3)])
def test_no_setting_is_advised_that_breaks_a_law(goal: Any) -> None:
    scene = catalogue.build("gas:n=3")
    study = studied(scene, ExactEngine(), Clock(None), None, 3)
    assert goal.judge(study, HOME, engine_named(HOME)).right
    found = goal.judge(study, LAWLESS, engine_named(LAWLESS))
    assert not found.right
    assert found.result == "does not keep the law: restitution 0.999 fits 3 of 3 impacts"


def test_the_smallest_scene_on_which_a_law_is_broken() -> None:
    found = smallest(catalogue.build("gas:n=4"), Events(0.98), events=8, same_law=True)
    assert (found.end, found.law, found.minimal) == (End.MINIMAL, True, True)
    assert found.scene.events == 1
    assert len(found.scene.circles) + len(found.scene.walls) == 2, "one contact"
    again = compare(found.scene, [Events(0.98)], causes=False)
    assert (again.verdict, again.candidates[0].lawless) == ("agree", True)
    assert all(step.comparison.candidates[0].lawless for step in found.steps)


def test_where_no_law_is_broken_there_is_nothing_to_minimise(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("minimise", "gas:n=3", "--events", "4", "--same", "law", "--engine")
    code, out, err = said(capsys, *words, HOME)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert "is not known to break a law on gas:n=3: it keeps the law in all of its 4 impacts" in err
    code, out, _ = said(capsys, *words, LAWLESS)
    assert code == 0
    assert "restitution 0.999" in out
    with pytest.raises(SceneError, match="what must remain is one of them"):
        smallest(catalogue.build("gas:n=3"), "double", same_law=True, same_cause=True)
