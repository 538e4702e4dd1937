"""Rows of a survey that are kept: what is there is not made again, and what is of another day is."""

from __future__ import annotations

import json
import os
import shutil
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

from truebreak.compare.cli import main
from truebreak.compare.grids.engine_survey import SurveyJob, entries_of, survey
from truebreak.compare.grids.row import Row
from truebreak.compare.grids.store import Store, merged
from truebreak.compare.report.survey_page import page_text
from truebreak.scenarios import SceneError

WORDS = ["survey", "--engines", "double,quad", "--scenes", "lee;near-tie", "--no-advice", "--jobs", "1", "--store"]


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file with the rows of two engines on two scenes."""
    path = tmp_path_factory.mktemp("survey") / "rows.db"
    survey(["double", "quad"], ["lee", "near-tie"], advice=False, store=str(path))
    return path


def refuse(job: SurveyJob) -> list[Row]:
    raise AssertionError(f"this row is there already: {job.label}")


def test_what_is_there_is_not_made_again(kept: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(SurveyJob, "rows", refuse)
    again = survey(["double", "quad"], ["lee", "near-tie"], advice=False, store=str(kept))
    assert [(e.label, e.name) for e in again.entries] == [
        ("lee", "double"),
        ("lee", "quad"),
        ("near-tie", "double"),
        ("near-tie", "quad"),
    ]
    assert "| `double` | diverged | 0 of 4 |" in page_text(again)
    assert "input rounding" in page_text(again)
    assert [e.name for e in survey(["quad"], ["lee"], advice=False, store=str(kept)).entries] == ["quad"]
    with pytest.raises(AssertionError, match="this row is there already: lee: single"):
        survey(["single"], ["lee"], advice=False, store=str(kept))


@pytest.mark.parametrize("name", ["installed_version", "scene_digest"])
def test_a_row_of_another_day_is_made_again(
    name: str, kept: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of another version of the engine, or another scene."""
    path = shutil.copy(kept, tmp_path / "rows.db")
    made: list[str] = []
    real = SurveyJob.rows
    monkeypatch.setattr(f"truebreak.compare.grids.engine_survey.{name}", lambda of: "another")
    monkeypatch.setattr(SurveyJob, "rows", lambda job: made.append(job.label) or real(job))
    survey(["double"], ["lee"], advice=False, store=str(path))
    assert made == ["lee: double"]


def test_a_row_that_was_changed_is_refused(kept: Path, tmp_path: Path) -> None:
    path = shutil.copy(kept, tmp_path / "rows.db")
    with sqlite3.connect(path) as base:
        base.execute("UPDATE rows SET row = replace(row, 'diverged', 'agree') WHERE row LIKE '%diverged%'")
    with pytest.raises(SceneError, match="is damaged: it holds"):
        survey(["double"], ["near-tie"], advice=False, store=str(path))


def test_another_survey_is_refused(kept: Path, tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="another survey: its causes is true, here it is false; choose another file"):
        survey(["double"], ["lee"], advice=False, causes=False, store=str(kept))
    other = tmp_path / "rows.jsonl"
    other.write_text('{"schema": "truebreak/survey-rows-1"}\n' * 99, encoding="utf-8")
    before = other.read_bytes()
    with pytest.raises(SceneError, match="is no store of a grid, or damaged"):
        survey(["double"], ["lee"], store=str(other))
    with pytest.raises(SceneError, match="is a folder"):
        survey(["double"], ["lee"], store=str(tmp_path))
    assert other.read_bytes() == before


@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_ctrl_c_keeps_the_rows_that_are_made(tmp_path: Path) -> None:
    path = tmp_path / "rows.db"
    code = (
        "import os, signal, sys\n"
        "from truebreak.compare.grids.store import Store\n"
        "real = Store.add\n"
        "def add(self, *given):\n"
        "    real(self, *given)\n"
        "    os.kill(os.getpid(), signal.SIGINT)\n"
        "Store.add = add\n"
        "from truebreak.compare.cli import main\n"
        "main(sys.argv[1:])\n"
    )
    command = [sys.executable, "-P", "-c", code, *WORDS, str(path), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 130, done.stderr
    assert done.stderr == "truebreak: interrupted\n"
    assert done.stdout == ""
    assert [entry.name for entry in entries_of(Store(str(path)))] == ["double"]


def test_the_command_line_goes_on(kept: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = shutil.copy(kept, tmp_path / "rows.db")
    with pytest.raises(SystemExit) as stop:
        main([*WORDS, str(path), "--json"])
    assert not stop.value.code
    data = json.loads(capsys.readouterr().out)
    assert [row["engine"] for row in data["rows"]] == ["double", "quad"] * 2
    assert merged([str(path)]) == merged([str(kept)]), "nothing was made"
    with pytest.raises(SystemExit) as stop:
        main([*WORDS, str(path), "--from", "x.json"])
    assert stop.value.code == 2
    assert "give one of them" in capsys.readouterr().err
