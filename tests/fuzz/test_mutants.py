"""The list of mutants is current, and the fuzz finds some of them at once."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from fuzz.mutants import MUTANTS, TOP, lacks, shows

QUICK = ("stale_signs", "limit_leaves_out", "bar_at_lower_bound")


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda mutant: mutant.name)
def test_its_text_stands_in_its_file_once(mutant):
    assert not mutant.misplaced(TOP)
    assert all(old != new for _, old, new in mutant.edits)


def test_names_are_unique():
    assert len({mutant.name for mutant in MUTANTS}) == len(MUTANTS)


def test_quick_ones_are_found(tmp_path):
    """In copies of their own: the checkout stays as it is."""
    files = {file: (TOP / file).read_bytes() for m in MUTANTS if m.name in QUICK for file, _, _ in m.edits}
    command = [sys.executable, str(Path(__file__).with_name("mutants.py")), "--scenes", "60"]
    command += ["--only", ",".join(QUICK), "--out", str(tmp_path / "out"), "--report", str(tmp_path / "report")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    rows = [json.loads(line) for line in (tmp_path / "out").read_text().splitlines()]
    assert {row["name"]: row["outcome"] for row in rows} == dict.fromkeys(QUICK, "found")
    assert (tmp_path / "report").read_text().count("\n") == 2 + len(QUICK)
    assert all((TOP / file).read_bytes() == text for file, text in files.items())


def test_what_aims_at_a_fault_finds_it_beside_a_scene_by_the_covering_array(tmp_path):
    """As docs/fuzz.md lists them: the seed that shows it."""
    command = [sys.executable, str(Path(__file__).with_name("mutants.py")), "--kinds", "mixed", "--scenes", "1"]
    command += ["--only", "bar_of_any_rival", "--start", "15", "--out", str(tmp_path / "out"), "--patience", "60"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    row = json.loads((tmp_path / "out").read_text())
    assert (row["outcome"], row["message"][:19]) == ("found", "beside it, loose 0:")


def test_the_docs_list_those_that_survive():
    text = (TOP / "docs" / "fuzz.md").read_text()
    rows = [f"| `{m.name}` | {m.breaks} | {m.why_it_survives} |" for m in MUTANTS if m.why_it_survives]
    assert [row for row in rows if row not in text] == []
    assert sum(line.startswith("| `") for line in text.splitlines()) == len(rows)


def test_a_relation_that_gives_up_shows_a_fault_where_it_does_not_without_it() -> None:
    right = {"kind": "mixed", "seed": 1, "outcome": "ok", "extra": "form beside", "seconds": 0.1}
    assert not shows(right, lambda: right, 20)
    assert lacks(right | {"extra": ""}) == {"form", "beside"}
    assert shows(right | {"extra": ""}, lambda: right, 20) == "undecided"
    assert not shows(right | {"extra": ""}, lambda: right | {"extra": ""}, 20)
    assert not shows(right | {"kind": "gas", "extra": ""}, lambda: right, 20)
    assert shows(right | {"outcome": "failure", "extra": ""}, lambda: right, 20) == "failure"
