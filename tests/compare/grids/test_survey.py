"""The survey: every engine and scene of it, and its page in the docs, which is what its record gives."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import jsonschema
import pytest

from truebreak.compare.cli import main
from truebreak.compare.engines import ENGINES, engine
from truebreak.compare.grids.engine_survey import (
    SCENES,
    SURVEYED,
    Survey,
    SurveyEntry,
    installed,
    read_survey,
    settings_tried,
    survey,
    survey_json,
)
from truebreak.compare.report.schema import schema
from truebreak.compare.report.survey_page import page_text
from truebreak.scenarios import SceneError
from truebreak.scenarios.catalogue import build


def test_it_has_sixteen_scenes_and_every_engine_but_those_that_none_would_use() -> None:
    assert len(SCENES) == 16
    assert {one.name for one in SURVEYED} == set(ENGINES) - {"exact", "sympy", "rounded"}
    drawn = [build(task.scene) for task in SCENES.values()]
    for kind in ("segments", "polygons", "arcs"):
        assert any(getattr(scene, kind) for scene in drawn), kind


def test_every_setting_is_one_of_the_engine() -> None:
    for one in installed():
        for settings in one.ladder:
            assert engine(f"{one.name}:{settings}" if settings else one.name).name == one.name


def test_settings_that_take_too_many_steps_are_not_tried() -> None:
    (pymunk,) = (one for one in SURVEYED if one.name == "pymunk")
    assert settings_tried(pymunk, "lee") == ["pymunk", "pymunk:dt=1/512", "pymunk:dt=1/2048"]
    assert settings_tried(pymunk, "gas") == ["pymunk", "pymunk:dt=1/512"]


@pytest.fixture(scope="module")
def found() -> Survey:
    return survey(["double", "pymunk", "interval"], ["near-tie", "lee"])


def test_the_best_setting_is_the_one_that_agrees_the_farthest(found: Survey) -> None:
    by_key = {(entry.label, entry.name): entry for entry in found.entries}
    assert len(by_key) == 6
    wide = by_key["near-tie", "interval"]
    assert [cell.engine for cell in wide.tried] == ["interval", "interval:bits=512", "interval:bits=96"]
    assert (wide.first.verdict, wide.best.engine, wide.best.verdict) == ("undecided", "interval:bits=512", "agree")
    assert by_key["near-tie", "double"].best.cause == "input rounding"
    same = by_key["lee", "pymunk"]
    assert same.best is same.first, "of those that agree as far, the cheapest"


def test_what_is_advised_is_run_and_right(found: Survey) -> None:
    by_key = {(entry.label, entry.name): entry for entry in found.entries}
    wide = by_key["near-tie", "interval"]
    assert wide.advice is not None
    assert (wide.advice.right, wide.advice.engine) == (True, "interval:bits=96")
    assert [(cell.engine, cell.verdict) for cell in wide.shown] == [
        ("interval:bits=512", "agree"),
        ("interval", "undecided"),
        ("interval:bits=96", "agree"),
    ]
    stepped = by_key["near-tie", "pymunk"]
    assert stepped.advice is not None
    assert stepped.advice.engine == "pymunk:dt=1/4096,iterations=1", "all four contacts, in two steps"
    assert by_key["near-tie", "double"].advice is None, "which has no settings"
    first, *others = (replace(row, right=None, note=None) for row in stepped.tried)
    none = replace(stepped, tried=(replace(first, right=False, note="none of 9 within 200,000 units"), *others))
    text = page_text(replace(found, entries=tuple(none if entry is stepped else entry for entry in found.entries)))
    assert "| `interval:bits=96`, advised | agrees | 4 of 4 |" in text
    assert "No setting to advise: `pymunk` (none of" in text


def test_every_time_is_a_ratio_to_the_certified_run(found: Survey) -> None:
    for entry in found.entries:
        for cell in entry.tried:
            assert cell.times is not None
            assert cell.times > 0


def test_why_is_told_of_every_setting_that_is_shown(found: Survey) -> None:
    for entry in found.entries:
        for cell in entry.shown:
            assert (cell.cause is None) == (cell.verdict == "agree"), (entry.label, cell.engine)


def test_a_record_of_before_is_refused(found: Survey, tmp_path: Path) -> None:
    data, path = survey_json(found), tmp_path / "earlier.json"
    path.write_text(json.dumps({**data, "schema": "truebreak/suite-1", "cells": data["rows"]}), encoding="utf-8")
    with pytest.raises(SceneError, match="is no truebreak/suite-2; write one with"):
        read_survey([str(path)])
    path.write_text(json.dumps({**data, "versions": {"double": 1}}), encoding="utf-8")
    with pytest.raises(SceneError, match=r"versions = .*1.*; write the report again"):
        read_survey([str(path)])


def test_a_survey_is_made_in_parts_and_the_later_of_two_is_taken(found: Survey, tmp_path: Path) -> None:
    whole = json.loads(json.dumps(survey_json(found)))
    again = {**whole, "rows": [{**c, "cause": "found later"} for c in whole["rows"] if c["scene"] == "lee"]}
    paths = [tmp_path / "one.json", tmp_path / "two.json"]
    for path, data in zip(paths, (whole, again), strict=True):
        path.write_text(json.dumps(data), encoding="utf-8")
    told = read_survey([str(path) for path in paths])
    assert [(e.label, e.name) for e in told.entries] == [(e.label, e.name) for e in sorted_entries(found)]
    for entry in told.entries:
        assert all((cell.cause == "found later") == (entry.label == "lee") for cell in entry.tried)


def test_what_is_written_is_read_again(found: Survey, tmp_path: Path) -> None:
    data = json.loads(json.dumps(survey_json(found)))
    jsonschema.Draft202012Validator(schema("suite-2")).validate(data)
    path = tmp_path / "survey.json"
    path.write_text(json.dumps(data), encoding="utf-8")
    again = read_survey([str(path)])
    assert page_text(again) == page_text(Survey(found.versions, tuple(sorted_entries(found)), (), None))


def sorted_entries(found: Survey) -> list[SurveyEntry]:
    labels = list(SCENES)
    return sorted(found.entries, key=lambda entry: labels.index(entry.label))


def test_the_page_of_the_docs_is_what_its_record_gives(root: Path) -> None:
    """Made by `truebreak survey --from docs/survey.json --page docs/survey.md`."""
    recorded = read_survey([str(root / "docs" / "survey.json")])
    assert page_text(recorded) == (root / "docs" / "survey.md").read_text("utf-8")
    assert {entry.label for entry in recorded.entries} == set(SCENES)
    assert set(recorded.versions) == {one.name for one in SURVEYED}, "made with every extra installed"
    for entry in recorded.entries:
        assert entry.best.digest == build(SCENES[entry.label].scene).digest, (
            "the scene has changed; run the survey again"
        )


def test_the_page_has_a_row_for_each_engine_on_each_scene(found: Survey) -> None:
    text = page_text(found)
    assert text.count("| `double` |") == 2
    assert "## Near-tie" in text
    assert "| `interval:bits=512` | agrees | 4 of 4 |" in text
    assert "| `interval` | undecided |" in text


def test_unknown_names_are_refused() -> None:
    with pytest.raises(SceneError, match="did you mean 'box2d'"):
        survey(["bxo2d"])
    with pytest.raises(SceneError, match="scene 'gass' is not in the survey"):
        survey([], ["gass"])


def test_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = tmp_path / "page.md"
    with pytest.raises(SystemExit) as stop:
        main(
            [
                "survey",
                "--engines",
                "double",
                "--scenes",
                "lee",
                "--page",
                str(page),
                "--no-causes",
                "--no-advice",
                "--jobs",
                "1",
            ]
        )
    said = capsys.readouterr()
    assert not stop.value.code
    assert "agrees" in said.out
    assert "| `double` | agrees | 1 of 1 |" in page.read_text("utf-8")
