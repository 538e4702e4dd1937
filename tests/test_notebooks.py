"""The notebooks run, print what they show, and are notebooks."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from notebooks import FOLDER, NOTEBOOKS, played, text_of


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_prints_what_it_shows(path: Path) -> None:
    assert path.read_text("utf-8") == text_of(played(path)), "python tests/notebooks.py writes them anew"


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_has_the_form_of_one(path: Path) -> None:
    book = json.loads(path.read_text("utf-8"))
    assert (book["nbformat"], book["nbformat_minor"]) == (4, 5)
    ids = [cell["id"] for cell in book["cells"]]
    assert len(set(ids)) == len(ids)
    assert all(re.fullmatch(r"[a-zA-Z0-9_-]{1,64}", name) for name in ids)
    kinds = [cell["cell_type"] for cell in book["cells"]]
    assert kinds[0] == "markdown" and "code" in kinds
    for cell in book["cells"]:
        wanted = {"cell_type", "id", "metadata", "source"}
        assert set(cell) == (wanted | {"execution_count", "outputs"} if cell["cell_type"] == "code" else wanted)


def test_the_three_notebooks_are_there() -> None:
    assert [path.stem for path in NOTEBOOKS] == ["break", "lyapunov", "trust"]
    index = (FOLDER.parent / "index.md").read_text("utf-8")
    assert all(f"notebooks/{path.name}" in index for path in NOTEBOOKS)
