"""The studies run from the repository by the commands that the docs name, and no installation has them."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

import truebreak

ROOT = Path(__file__).resolve().parents[2]
STUDIES = sorted((ROOT / "docs" / "studies").glob("*.py"))
COMMANDS = [path for path in STUDIES if "__main__" in path.read_text("utf-8")]
NAMED = re.compile(r"docs/studies/\w+\.\w+")


@pytest.mark.parametrize("path", COMMANDS, ids=lambda path: path.stem)
def test_a_study_is_run_from_the_root(path: Path) -> None:
    command = [sys.executable, str(path.relative_to(ROOT)), "--help"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert f"usage: python {path.relative_to(ROOT).as_posix()}" in done.stdout


def test_every_study_that_is_named_is_there_and_every_command_is_named() -> None:
    layers = ("scenarios", "exact", "floating", "compare", "tools", "docs", "tests")
    files = [path for layer in layers for path in (ROOT / layer).rglob("*.*") if path.suffix in (".py", ".md")]
    files += [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "Makefile", "pyproject.toml")]
    named = {name for path in files for name in NAMED.findall(path.read_text("utf-8"))}
    assert {name for name in named if not (ROOT / name).is_file()} == set()
    pages = [ROOT / "README.md", ROOT / "Makefile", *sorted((ROOT / "docs").glob("*.md"))]
    told = {name for path in pages for name in NAMED.findall(path.read_text("utf-8"))}
    assert {path.relative_to(ROOT).as_posix() for path in COMMANDS} <= told


def test_an_installation_has_no_study() -> None:
    """A package of theirs has no such module, wherever it lies (the wheel's files are compared in test_packaging)."""
    for path in STUDIES:
        assert not list(Path(str(truebreak.__file__)).parent.rglob(path.name)), path.stem
