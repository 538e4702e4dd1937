"""CONTRIBUTING.md's recipes, followed to the letter in a copy of the project."""

from __future__ import annotations

import ast
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).resolve().parent.parent
PAGE = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
FOLDERS = ("scenarios", "tools", "exact", "floating", "compare")
BLOCK = re.compile(r"^```python\n# (?P<head>[^\n]*)\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL)
LINE = re.compile(r"(?P<path>[\w./-]+): in (?P<table>\w+)")


class Recipe(NamedTuple):
    """One section: the new file, or what comes before a table; the line for a table; and what then holds."""

    title: str
    file: tuple[str, str]
    table: tuple[str, str, str] | None
    holds: str


def line_of(row: tuple[str, str] | None = None) -> tuple[str, str, str] | None:
    """The path, the table and the line of a block; None where a recipe needs no table."""
    if row is None:
        return None
    place = LINE.fullmatch(row[0])
    assert place is not None, row[0]
    return place["path"], place["table"], row[1]


def recipes() -> list[Recipe]:
    """The sections that hold code."""
    found: list[Recipe] = []
    for section in PAGE.split("\n## ")[1:]:
        blocks = [(match["head"], match["text"]) for match in BLOCK.finditer(section)]
        if blocks:
            file, *row, holds = blocks
            assert holds[0] == "holds"
            found.append(Recipe(section.partition("\n")[0], file, line_of(*row), holds[1]))
    return found


RECIPES = recipes()


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """The packages as an installation has them: all below `truebreak`."""
    ignored = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "truebreak", tmp_path / "truebreak", ignore=ignored)
    for folder in FOLDERS:
        shutil.copytree(ROOT / folder, tmp_path / "truebreak" / folder, ignore=ignored)
    return tmp_path


def run(code: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Python with the copy in the place of the project."""
    command = [sys.executable, "-c", code]
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


def test_there_are_recipes() -> None:
    assert [recipe.title for recipe in RECIPES] == [
        "A scene family",
        "An outcome",
        "An engine",
        "A number system",
        "A tie policy",
        "A rung of the cascade",
        "A predicate",
        "A cause",
        "A surface",
        "A stress family",
    ]


def test_the_rooms_that_it_names_are_there() -> None:
    house = PAGE.partition("\n## The house")[2].partition("\n## ")[0]
    rooms = re.findall(r"`([a-z]+/[a-z]+)`", house)
    assert len(rooms) > 8
    assert [room for room in rooms if not (ROOT / room).is_dir()] == []


def code_of(text: str) -> list[str]:
    """The lines of a file that are neither imports nor docstrings nor empty."""
    beside: set[int] = set()
    for node in ast.walk(ast.parse(text)):
        told = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
        if told or isinstance(node, ast.Import | ast.ImportFrom):
            beside.update(range(node.lineno, (node.end_lineno or node.lineno) + 1))
        elif isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            beside.add(node.lineno)
    return [line for k, line in enumerate(text.splitlines(), 1) if line.strip() and k not in beside]


@pytest.mark.parametrize("recipe", RECIPES, ids=lambda recipe: recipe.title)
def test_a_recipe_is_at_most_ten_lines_of_code(recipe: Recipe) -> None:
    assert 0 < len(code_of(recipe.file[1])) <= 10


def add_line(top: Path, table: str, name: str, row: str) -> None:
    """Adds a line at the head of a table."""
    assert len(row.splitlines()) == 1
    place = top / table
    before = place.read_text("utf-8")
    after = re.sub(rf"^({name}\b[^\n]*[\[{{(])\n", rf"\g<1>\n{row}", before, count=1, flags=re.MULTILINE)
    assert after != before, f"{table} has no {name}"
    place.write_text(after, "utf-8")


@pytest.mark.parametrize("recipe", RECIPES, ids=lambda recipe: recipe.title)
def test_a_recipe_is_one_file_and_one_line(recipe: Recipe, copy: Path) -> None:
    assert run(recipe.holds, copy).returncode != 0, "it must not hold without the recipe"
    path, _, table = recipe.file[0].partition(": before ")
    new, text = copy / "truebreak" / path, recipe.file[1]
    if table:
        head, found, rest = new.read_text("utf-8").partition(f"\n{table} = (\n")
        text = f"{head}\n\n{text}\n{found}{rest}"
    assert new.exists() == bool(table)
    new.write_text(text, "utf-8")
    if recipe.table is not None:
        add_line(copy / "truebreak", *recipe.table)
    done = run(f"import truebreak\nassert truebreak.__file__.startswith({str(copy)!r})\n{recipe.holds}", copy)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("recipe", RECIPES, ids=lambda recipe: recipe.title)
def test_a_recipe_is_formatted_and_typed_as_the_project_is(recipe: Recipe, tmp_path: Path) -> None:
    path = tmp_path / Path(recipe.file[0].partition(":")[0]).name
    path.write_text(recipe.file[1], "utf-8")
    for command in (["check"], ["format", "--check"]):
        settings = ["--config", str(ROOT / "pyproject.toml")]
        done = subprocess.run(
            [sys.executable, "-m", "ruff", *command, *settings, str(path)], capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stdout
