"""What is declared as the lowest version of each dependency is what `make lowest` installs."""

from __future__ import annotations

import doctest
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import lowest
import pytest

ROOT = Path(__file__).resolve().parent.parent
DECLARED = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["dependencies"]


def test_every_dependency_has_a_lower_bound() -> None:
    assert doctest.testmod(lowest).failed == 0
    assert len(lowest.lowest(DECLARED)) == len(DECLARED)
    with pytest.raises(ValueError, match="no lower bound"):
        lowest.lowest(["click"])


def test_the_command_prints_what_pip_takes() -> None:
    done = subprocess.run([sys.executable, lowest.__file__], capture_output=True, text=True, check=True)
    assert all(re.fullmatch(r"[\w-]+==[\d.]+", line) for line in done.stdout.splitlines())


def test_make_lowest_installs_these_and_runs_tests_that_are_there() -> None:
    (recipe,) = re.findall(r"^lowest:.*\n((?:\t.*\n)+)", (ROOT / "Makefile").read_text("utf-8"), re.MULTILINE)
    assert "tests/lowest.py" in recipe
    named = re.findall(r"tests/[\w/]+\.py", recipe)
    assert len(named) > 5
    assert all((ROOT / name).is_file() for name in named)
