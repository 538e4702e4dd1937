"""Suites: one report over many scenes, and what changed since an earlier one."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from truebreak.compare import compare, study
from truebreak.compare.cli import main
from truebreak.compare.grids.row import Row
from truebreak.compare.grids.suite_file import (
    SuiteReport,
    Task,
    hold,
    parsed_suite,
    read_report,
    read_suite,
    run_suite,
    since,
    suite_json,
)
from truebreak.compare.report.schema import schema
from truebreak.floating import PymunkEngine
from truebreak.scenarios import SceneError, catalogue

SUITE = """
engines = ["double", "single"]

[[scene]]
name = "lee"

[[scene]]
name = "gas:n=3"
events = 8

[[scene]]
name = "near-tie"
engines = ["double"]
"""


@pytest.fixture(scope="module")
def report() -> SuiteReport:
    """A suite of which one engine diverges on one scene."""
    return run_suite(parsed_suite(SUITE, "mine.toml"))


def test_every_engine_meets_every_scene(report: SuiteReport) -> None:
    assert [row.pair for row in report.rows] == [
        ("lee", "double"),
        ("lee", "single"),
        ("gas:n=3", "double"),
        ("gas:n=3", "single"),
        ("near-tie", "double"),
    ]
    assert [row.verdict for row in report.rows] == ["agree"] * 4 + ["diverged"]
    assert report.verdict == "diverged"
    last = report.rows[-1]
    assert last.event == 0
    assert last.cause == "input rounding"
    assert "final_velocities" in (last.changed or ())
    assert all(row.events == 8 for row in report.rows if row.scene == "gas:n=3")


def test_energy_drift_is_that_of_the_run(report: SuiteReport) -> None:
    drifts = {row.pair: row.drift for row in report.rows}
    assert abs(drifts["gas:n=3", "double"] or 0.0) < 1e-14
    assert 1e-9 < abs(drifts["gas:n=3", "single"] or 0.0) < 1e-5


def test_json_is_what_its_schema_says(report: SuiteReport) -> None:
    changed = since(report.rows, replace(report, rows=report.rows[1:]))
    for data in (suite_json(report), suite_json(report, changed)):
        jsonschema.Draft202012Validator(schema("suite-2")).validate(json.loads(json.dumps(data)))


def other(row: Row, **changes: Any) -> SuiteReport:
    return SuiteReport("mine.toml", (replace(row, **changes),))


def test_nothing_changed_where_only_seconds_and_last_digits_did(report: SuiteReport) -> None:
    again = tuple(replace(row, seconds=9.0, drift=0.25) for row in report.rows)
    assert since(report.rows, replace(report, rows=again)) == []


@pytest.mark.parametrize(
    ("changes", "what", "words"),
    [
        ({"verdict": "agree", "event": None}, "verdict", "diverged at event 0 before, agreed"),
        ({"changed": []}, "outcomes", "other outcomes are wrong"),
        ({"digest": "0" * 64}, "scene", "the scene itself is another"),
        ({"scene": "lee"}, "new", "is new, diverged at event 0"),
    ],
)
def test_what_changed_is_told(report: SuiteReport, changes: dict[str, Any], what: str, words: str) -> None:
    row = report.rows[-1]
    first = since([row], other(row, **changes))[0]
    assert first.what == what
    assert words in first.sentence


def test_another_partner_is_another_divergence(report: SuiteReport) -> None:
    row = report.rows[-1]
    assert [change.what for change in since([row], other(row, got="left"))] == ["divergence"]
    assert since([row], other(row, at=1.5)) == []


def test_what_is_gone_is_told(report: SuiteReport) -> None:
    (change,) = since(report.rows, replace(report, rows=report.rows[:-1]))
    assert change.what == "gone"
    assert change.sentence.startswith("double on near-tie: was in the earlier report")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("engines = [", "not TOML"),
        ("engines = " + "[" * 10_000, "nested too deeply"),
        ("events = " + "1" * 4400, "a bare whole number has more than 4300 digits"),
        (".".join(["a"] * 40_000) + " = 1", "is a dotted key; write a plain one"),
        ("x" * 3_000_000, "has 3000000 bytes; at most 2000000"),
        ('engines = ["double"]', "has no scene"),
        ('engine = ["double"]\n[[scene]]\nname = "lee"', "'engine' is no key of it; did you mean 'engines'?"),
        ('[[scene]]\nname = "lee"', "engines = []; must be a list"),
        ('engines = ["duoble"]\n[[scene]]\nname = "lee"', "did you mean 'double'?"),
        ('engines = ["double"]\n[[scene]]\nname = "leee"', "did you mean 'lee'?"),
        ('engines = ["double"]\n[[scene]]\nname = "lee"\nevent = 3', "'event' is no key of it; did you mean 'events'?"),
        ('engines = ["double"]\n[[scene]]\nname = "lee"\nevents = 0', "events = 0; must be a whole number from 1"),
        ('engines = ["double"]\n[[scene]]\nname = "lee"\nuntil = 0.5', "until = 0.5; must be exact, as text"),
        ('engines = ["double", "double"]\n[[scene]]\nname = "lee"', "is there twice with 'double'"),
        ('causes = 1\nengines = ["double"]\n[[scene]]\nname = "lee"', "causes = 1; must be true or false"),
        ('engines = ["double"]\n[[scene]]\nname = "no.toml"', "no.toml"),
    ],
)
def test_bad_suites_are_one_line(text: str, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SystemExit) as stop:
        main(["suite", str(path)])
    said = capsys.readouterr()
    assert stop.value.code == 2
    assert told in said.err
    assert "bad.toml" in said.err
    assert said.err.count("\n") == 1
    assert said.out == ""


def test_scenes_that_are_files_lie_beside_the_suite(tmp_path: Path) -> None:
    (tmp_path / "two.toml").write_text("[[circle]]\nid = 'a'\nx = 0\ny = 0\nr = 1\nvx = 1\n", encoding="utf-8")
    path = tmp_path / "mine.toml"
    path.write_text('engines = "double"\n[[scene]]\nname = "two.toml"\nuntil = 1\n', encoding="utf-8")
    (task,) = read_suite(str(path)).tasks
    assert (task.scene, task.until) == (str(tmp_path / "two.toml"), "1")


def test_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Report, JSON, what changed, exit codes."""
    path, before = tmp_path / "mine.toml", tmp_path / "before.json"
    path.write_text(SUITE, encoding="utf-8")

    def ran(*words: str) -> tuple[int, str]:
        with pytest.raises(SystemExit) as stop:
            main(["suite", str(path), "--jobs", "1", *words])
        said = capsys.readouterr()
        assert said.err == ""
        return int(stop.value.code or 0), said.out

    code, text = ran("--json")
    before.write_text(text, encoding="utf-8")
    assert code == 1
    assert ran("--exit-zero")[0] == 0
    code, text = ran("--against", str(before))
    assert (code, text.splitlines()[-1]) == (1, "Nothing changed.")
    assert ran("--against", str(before), "--only-changes")[0] == 0
    path.write_text(SUITE.replace('"double", "single"', '"double"'), encoding="utf-8")
    code, text = ran("--against", str(before), "--only-changes")
    assert code == 1
    assert "Changed since the earlier report: 2." in text
    assert "single on lee: was in the earlier report" in text


@pytest.mark.parametrize(
    "text", ["", "[]", "[" * 100_000, '{"schema": "truebreak/suite-1", "cells": []}', '{"schema": "truebreak/suite-2"}']
)
def test_bad_earlier_reports_are_one_line(text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, before = tmp_path / "mine.toml", tmp_path / "before.json"
    path.write_text(SUITE, encoding="utf-8")
    before.write_text(text, encoding="utf-8")
    with pytest.raises(SystemExit) as stop:
        main(["suite", str(path), "--against", str(before)])
    said = capsys.readouterr()
    assert (stop.value.code, said.err.count("\n")) == (2, 1)
    assert "before.json" in said.err


RAISES = """
from truebreak.compare.foreign import RecordedEngine

class Broken(RecordedEngine):
    name = "broken"
    def play(self, scene, recording):
        raise RuntimeError("my engine is broken")
"""


def test_an_engine_that_raises_has_a_cell_that_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The others' cells are not lost by it."""
    (tmp_path / "broken_engine.py").write_text(RAISES, encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    text = 'engines = ["mine=broken_engine:Broken", "double"]\n[[scene]]\nname = "lee"'
    mine, double = run_suite(parsed_suite(text, "mine.toml")).rows
    assert (mine.engine, mine.verdict, double.verdict) == ("mine", "failed", "agree")
    assert "my engine is broken" in str(mine.note)


def test_the_time_of_a_run_is_without_the_series_that_settles_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """By a clock that counts runs: of the engine's, those at finer steps are no part of what the run took."""
    runs = [0]
    real = study.run_guarded

    def counted(*given: Any, **limits: Any) -> Any:
        runs[0] += 1
        return real(*given, **limits)

    monkeypatch.setattr(study, "run_guarded", counted)
    monkeypatch.setattr(study.clock, "process_time", lambda: float(runs[0]))
    held = hold(Task("lee", (), events=1), "pymunk:dt=1/64,iterations=2", None)
    assert runs[0] > 1
    assert (held.study.took, held.candidate.processor) == (1.0, 1.0)


def test_an_engine_whose_steps_are_dear_has_a_shorter_series() -> None:
    @dataclass(frozen=True)
    class Dear(PymunkEngine):
        step_microseconds: float = 1.0

    assert [study.series_steps(Dear(step_microseconds=dear)) for dear in (0.0, 1.0, 40.0, float("nan"))] == [
        1_000_000, 1_000_000, 50_000, 1_000_000,
    ]  # fmt: skip
    scene = catalogue.build("gas:n=3")
    told = {
        dear: compare(scene, [Dear(1 / 64, step_microseconds=dear)]).candidates[0].diagnosis for dear in (1.0, 2000.0)
    }
    rows = {dear: {row.cause.value: row.result for row in found.experiments} for dear, found in told.items() if found}
    assert rows[1.0]["time step"].startswith("a step of 0.00781")
    assert rows[2000.0]["time step"] == "not tried: a finer step takes more than 1,000 steps"


def test_only_changes_needs_an_earlier_report(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="--against"):
        from truebreak.compare.cli.commands.suite import suite

        suite.main([str(tmp_path / "mine.toml"), "--only-changes"], standalone_mode=False)


@pytest.mark.parametrize(
    ("key", "value", "told"),
    [
        ("event", "five", "row 0: event = 'five'"),
        ("event", 3, "row 0: event 3 has no body"),
        ("agreed", "many", "row 0: agreed = 'many'"),
        ("agreed", True, "row 0: agreed = true"),
        ("changed", [1], "row 0: changed = [1]"),
        ("engine", ["double"], "row 0: engine = ['double']"),
        ("verdict", "right", "row 0: verdict = 'right'"),
        ("laws", {"kept": True}, "row 0: laws = {'kept': True}"),
        ("cell", 1, "row 0: 'cell' is no part of a row"),
    ],
)
def test_rows_of_something_else_are_one_line(
    report: SuiteReport, key: str, value: object, told: str, tmp_path: Path
) -> None:
    data = json.loads(json.dumps(suite_json(report)))
    data["rows"][0][key] = value
    path = tmp_path / "earlier.json"
    path.write_text(json.dumps(data), encoding="utf-8")
    with pytest.raises(SceneError, match=re.escape(told)):
        read_report(str(path))
    path.write_text(json.dumps({**data, "rows": [5]}), encoding="utf-8")
    with pytest.raises(SceneError, match="row 0 is no object"):
        read_report(str(path))
