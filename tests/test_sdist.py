"""The distribution of sources holds all that its tests need; `make sdist` runs all of them in it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import sdist

ROOT = Path(__file__).resolve().parent.parent
SOME = ("tests/scenarios/test_scene.py", "tests/scenarios/test_files.py", "tests/test_lowest.py")
"""Tests that read data, folders of the project, and modules beside them."""


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return sdist.build(tmp_path_factory.mktemp("sdist"))


def test_it_holds_every_file_that_git_knows(unpacked: Path) -> None:
    if not shutil.which("git") or not (ROOT / ".git").exists():
        pytest.skip("no clone here, whose files could be listed")
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    files = {name for name in listed.split("\0") if name and (ROOT / name).is_file()}
    assert {name for name in files if not (unpacked / name).is_file()} == set()


def test_it_holds_nothing_that_was_only_made(unpacked: Path) -> None:
    made = [p for p in unpacked.rglob("*") if p.name in ("__pycache__", "node_modules", ".venv", ".hypothesis")]
    assert made == []


def test_some_of_its_tests_pass_there_against_its_own_wheel(unpacked: Path, tmp_path: Path) -> None:
    wheel = [sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--no-build-isolation"]
    subprocess.run([*wheel, "--target", str(tmp_path), str(unpacked)], check=True, capture_output=True)
    where = "import truebreak.exact as e; print(e.__file__)"
    environment = {**os.environ, "PYTHONPATH": str(tmp_path)}
    asked = [sys.executable, "-c", where]
    told = subprocess.run(asked, cwd=tmp_path, env=environment, capture_output=True, text=True, check=True)
    assert Path(told.stdout.strip()).is_relative_to(tmp_path)
    pytest_there = [Path(sys.executable).with_name("pytest"), "-q", "-p", "no:cacheprovider", *SOME]
    done = subprocess.run(pytest_there, cwd=unpacked, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_citation_names_the_version_and_the_licence_of_the_project() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    lines = (ROOT / "CITATION.cff").read_text("utf-8").splitlines()
    assert f"version: {project['version']}" in lines
    assert f"license: {project['license']}" in lines
    assert f"title: {project['name']}" in lines
    assert not any("http" in line for line in lines)
