"""What is declared as the lowest version of each dependency is what `make lowest` installs; every Python is tried."""

from __future__ import annotations

import doctest
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import lowest
import pytest
import pythons

ROOT = Path(__file__).resolve().parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]


def test_every_dependency_has_a_lower_bound() -> None:
    assert doctest.testmod(lowest).failed == 0
    assert set(lowest.declared()) > set(PROJECT["dependencies"])
    assert len(lowest.lowest(lowest.declared())) == len(lowest.declared())
    with pytest.raises(ValueError, match="no lower bound"):
        lowest.lowest(["click"])


def test_the_command_prints_what_pip_takes() -> None:
    done = subprocess.run([sys.executable, lowest.__file__], capture_output=True, text=True, check=True)
    assert all(re.fullmatch(r"[\w-]+==[\d.]+", line) for line in done.stdout.splitlines())


def test_every_extra_with_lower_bounds_is_among_them() -> None:
    extras = PROJECT["optional-dependencies"]
    bounded = {name for name, needs in extras.items() if all(re.fullmatch(r"[\w-]+>=[\d.]+", need) for need in needs)}
    assert bounded - {"mujoco"} == set(lowest.EXTRAS)


def test_make_installs_these_and_runs_tests_that_are_there() -> None:
    makefile = (ROOT / "Makefile").read_text("utf-8").replace("\\\n", "")
    (named,) = re.findall(r"^TOUCHING = (.*)$", makefile, re.MULTILINE)
    assert len(named.split()) > 10
    assert all((ROOT / name).is_file() for name in named.split())
    for target, script in (("lowest", "tests/lowest.py"), ("pythons", "tests/pythons.py")):
        (recipe,) = re.findall(rf"^{target}:.*\n((?:\t.*\n)+)", makefile, re.MULTILINE)
        assert script in recipe and "$(TOUCHING)" in recipe


def test_each_python_that_is_declared_is_at_least_the_lowest_that_is_asked_for() -> None:
    prefix = "Programming Language :: Python :: 3."
    minors = [int(line.removeprefix(prefix)) for line in PROJECT["classifiers"] if line.startswith(prefix)]
    assert minors == list(range(pythons.LOWEST, pythons.LOWEST + len(minors)))
    assert PROJECT["requires-python"] == f">=3.{pythons.LOWEST}"


def test_a_python_is_found_on_the_path_and_with_pyenv_if_it_works(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept = tmp_path / "pyenv" / "versions"
    here = tmp_path / "bin"
    for path, code in (
        (here / "python3.11", 0),
        (here / "python3.12", 1),
        (kept / "3.11.9" / "bin" / "python3.11", 0),
        (kept / "3.12.1" / "bin" / "python3.12", 0),
        (kept / "3.13.0" / "bin" / "python3.13", 1),
        (kept / "3.10.2" / "bin" / "python3.10", 0),
    ):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"#!/bin/sh\nexit {code}\n", "utf-8")
        path.chmod(0o755)
    monkeypatch.setenv("PATH", str(here))
    monkeypatch.setenv("PYENV_ROOT", str(tmp_path / "pyenv"))
    assert pythons.pythons() == {
        "3.11": here / "python3.11",
        "3.12": kept / "3.12.1" / "bin" / "python3.12",
    }


def test_a_test_that_fails_on_one_python_fails_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pythons, "pythons", lambda: {"3.11": Path("a"), "3.12": Path("b")})
    for codes, told in (({"3.11": 0, "3.12": 0}, 0), ({"3.11": 1, "3.12": 0}, 1), ({"3.11": 0, "3.12": 5}, 1)):
        monkeypatch.setattr(pythons, "tried", lambda _, folder, __, codes=codes: codes[folder.name])
        assert pythons.main(str(tmp_path), "test.py") == told
    monkeypatch.setattr(pythons, "pythons", dict)
    assert pythons.main(str(tmp_path)) == 1
