"""The studies run from the repository by the commands that the docs name, and no installation has them."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import pytest

import truebreak

ROOT = Path(__file__).resolve().parents[2]
STUDIES = sorted((ROOT / "docs" / "studies").glob("*.py"))
COMMANDS = [path for path in STUDIES if "__main__" in path.read_text("utf-8")]
NAMED = re.compile(r"docs/studies/\w+\.\w+")


RUN = """
import contextlib, io, json, pathlib, runpy, sys, traceback
told = {}
for name in sys.argv[1:]:
    sys.path[0], sys.argv[:] = str(pathlib.Path(name).resolve().parent), [name, "--help"]
    code, out = 0, io.StringIO()
    with contextlib.redirect_stdout(out):
        try:
            runpy.run_path(name, run_name="__main__")
        except SystemExit as stop:
            code = stop.code or 0
        except BaseException:
            code = traceback.format_exc()
    told[name] = code, out.getvalue()
print(json.dumps(told))
"""
"""Commands one after the other, each as Python begins it, in one process, as importing takes most of their time."""


@cache
def helped() -> dict[str, tuple[Any, str]]:
    """By each command its exit code, or how it failed, and what it prints."""
    words = [sys.executable, "-c", RUN, *(str(path.relative_to(ROOT)) for path in COMMANDS)]
    return json.loads(subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True).stdout)


@pytest.mark.parametrize("path", COMMANDS, ids=lambda path: path.stem)
def test_a_study_is_run_from_the_root(path: Path) -> None:
    code, out = helped()[str(path.relative_to(ROOT))]
    assert code == 0, code
    assert f"usage: python {path.relative_to(ROOT).as_posix()}" in out


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
