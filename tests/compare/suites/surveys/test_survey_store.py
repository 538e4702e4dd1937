"""Rows of a survey that are kept: what is there is not made again, and what is damaged or of another day is."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from truebreak.compare.cli import main
from truebreak.compare.suites import survey as surveying
from truebreak.compare.suites.survey import SurveyEntry, survey
from truebreak.compare.suites.surveys.survey_page import page_text
from truebreak.compare.suites.surveys.survey_store import SurveyStore, survey_settings
from truebreak.scenarios import SceneError

SETTINGS = survey_settings(causes=True, advice=False, max_seconds=None)


@pytest.fixture(scope="module")
def rows(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file with the rows of two engines on two scenes."""
    path = tmp_path_factory.mktemp("survey") / "rows.jsonl"
    store = SurveyStore(str(path), SETTINGS)
    survey(["double", "quad"], ["lee", "near-tie"], advice=False, kept=store.entries, keep=store.add)
    return path


def copied(rows: Path, tmp_path: Path, lines: list[str] | None = None) -> Path:
    path = tmp_path / "rows.jsonl"
    text = rows.read_text("utf-8") if lines is None else "".join(f"{line}\n" for line in lines)
    path.write_text(text, encoding="utf-8")
    return path


def refuse(*given: Any) -> SurveyEntry:
    raise AssertionError(f"this row is there already: {given[:2]}")


def test_what_is_there_is_not_made_again(rows: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = SurveyStore(str(rows), SETTINGS)
    assert len(first.entries) == 4
    monkeypatch.setattr(surveying, "_entry", refuse)
    again = survey(["double", "quad"], ["lee", "near-tie"], advice=False, kept=first.entries)
    assert [(e.label, e.name) for e in again.entries] == [
        ("lee", "double"),
        ("lee", "quad"),
        ("near-tie", "double"),
        ("near-tie", "quad"),
    ]
    assert "| `double` | diverged | 0 of 4 |" in page_text(again)
    assert "input rounding" in page_text(again)
    with pytest.raises(AssertionError, match="this row is there already"):
        survey(["single"], ["lee"], advice=False, kept=first.entries)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"settings": ["double"]', '"settings": ["double:x=1"]'),
        ('"version": ""', '"version": "0.1"'),
        ('"digest": "', '"digest": "0'),
        ('"verdict":', '"vordict":'),
        ('"label": "lee"', '"label": "leee"'),
        ('"cells": [', '"cells": [3, '),
    ],
)
def test_a_row_of_another_day_is_made_again(rows: Path, tmp_path: Path, old: str, new: str) -> None:
    lines = rows.read_text("utf-8").splitlines()
    assert '"label": "lee"' in lines[1]
    assert old in lines[1]
    lines[1] = lines[1].replace(old, new)
    assert len(SurveyStore(str(copied(rows, tmp_path, lines)), SETTINGS).entries) == 3


def test_a_row_that_a_kill_cut_off_is_made_again(rows: Path, tmp_path: Path) -> None:
    path = copied(rows, tmp_path)
    whole = path.read_bytes()
    path.write_bytes(whole[:-40])
    store = SurveyStore(str(path), SETTINGS)
    assert ("near-tie", "quad") not in store.entries
    survey(["quad"], ["near-tie"], advice=False, kept=store.entries, keep=store.add)
    lines = path.read_text("utf-8").splitlines()
    assert len(lines) == 5, "the half line is written over"
    assert json.loads(lines[-1])["label"] == "near-tie"
    assert len(SurveyStore(str(path), SETTINGS).entries) == 4


def test_another_survey_is_refused(rows: Path, tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="its survey has causes = True, here it is False; choose another file"):
        SurveyStore(str(rows), survey_settings(causes=False, advice=False, max_seconds=None))
    other = tmp_path / "other.json"
    other.write_text("{}\n", encoding="utf-8")
    with pytest.raises(SceneError, match="holds no rows of a survey; choose another file"):
        SurveyStore(str(other), SETTINGS)
    with pytest.raises(SceneError, match="choose another place"):
        SurveyStore(str(tmp_path), SETTINGS)
    assert other.read_text("utf-8") == "{}\n"


@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_ctrl_c_keeps_the_rows_that_are_made(tmp_path: Path) -> None:
    path = tmp_path / "rows.jsonl"
    code = (
        "import os, signal, sys\n"
        "from truebreak.compare.suites.surveys import survey_store as kept\n"
        "real = kept.SurveyStore.add\n"
        "def add(self, entry):\n"
        "    real(self, entry)\n"
        "    os.kill(os.getpid(), signal.SIGINT)\n"
        "kept.SurveyStore.add = add\n"
        "from truebreak.compare.cli import main\n"
        "main(sys.argv[1:])\n"
    )
    words = ["survey", "--engines", "double,quad", "--scenes", "lee", "--no-advice", "--store", str(path), "--json"]
    done = subprocess.run([sys.executable, "-P", "-c", code, *words], capture_output=True, text=True, check=False)
    assert done.returncode == 130, done.stderr
    assert done.stderr == "truebreak: interrupted\n"
    assert done.stdout == ""
    assert [key[1] for key in SurveyStore(str(path), SETTINGS).entries] == ["double"]


def test_the_command_line_goes_on(rows: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = copied(rows, tmp_path)
    words = ["survey", "--engines", "double,quad", "--scenes", "lee;near-tie", "--no-advice", "--store", str(path)]
    with pytest.raises(SystemExit) as stop:
        main([*words, "--json"])
    assert not stop.value.code
    data = json.loads(capsys.readouterr().out)
    assert [cell["engine"] for cell in data["cells"]] == ["double", "quad"] * 2
    assert path.read_text("utf-8") == rows.read_text("utf-8"), "nothing was made"
    with pytest.raises(SystemExit) as stop:
        main([*words, "--from", "x.json"])
    assert stop.value.code == 2
    assert "give one of them" in capsys.readouterr().err
