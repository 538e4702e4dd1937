"""The same sources give the same distributions, wherever and whenever they are built."""

from __future__ import annotations

import hashlib
import io
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path
from typing import Any

import pytest
import yaml

from truebreak.exact.compiled import predictions
from truebreak.tools.building import packages, repacked

ROOT = Path(__file__).resolve().parent.parent
LEFT = shutil.ignore_patterns(
    *(
        ".git",
        ".venv",
        "build",
        "dist",
        "__pycache__",
        "node_modules",
        "*.egg-info",
        ".*_cache",
        "*.so",
        "*.pyd",
        ".h*",
    ),
    *("data", "fuzz", "docs"),
)
CODE = """\
import sys
from setuptools import build_meta
_, place, *also = sys.argv  # which setuptools changes
build_meta.build_wheel(place)
if also:
    build_meta.build_sdist(place)
"""


def built(folder: Path, *also: str, time: int, **environment: str) -> dict[str, bytes]:
    """What is built from a copy of the sources, whose files are all of one time."""
    copy, out = folder / "sources", folder / "out"
    shutil.copytree(ROOT, copy, ignore=LEFT)
    out.mkdir(parents=True)
    for path in copy.rglob("*"):
        os.utime(path, (time, time))
    command = [sys.executable, "-c", CODE, str(out), *also]
    done = subprocess.run(command, cwd=copy, env={**os.environ, **environment}, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr.decode()
    return {path.name: path.read_bytes() for path in out.iterdir()}


@pytest.mark.slow
def test_two_builds_are_the_same_bytes(tmp_path: Path) -> None:
    """In folders of other names and lengths, from files of other times; compiled parts too."""
    one, other = tmp_path / "one", tmp_path / "another" / "place"
    for folder in (one, other):
        folder.mkdir(parents=True)
    first = built(one, "sdist", time=1_600_000_000, SOURCE_DATE_EPOCH="1700000000")
    second = built(other, "sdist", time=1_650_000_000, SOURCE_DATE_EPOCH="1700000000")
    assert len(first) == 2
    assert {name: hashlib.sha256(data).hexdigest() for name, data in first.items()} == {
        name: hashlib.sha256(data).hexdigest() for name, data in second.items()
    }
    (wheel,) = (name for name in first if name.endswith(".whl"))
    assert wheel.endswith("-none-any.whl") == (predictions is None)


def test_a_wheel_without_compiled_parts_is_of_any_platform(tmp_path: Path) -> None:
    """And two builds of it, and of the sources, are the same bytes."""
    pure = {"TRUEBREAK_PURE_PYTHON": "1", "SOURCE_DATE_EPOCH": "1700000000"}
    first, second = (built(tmp_path / name, "sdist", time=time, **pure) for name, time in (("a", 10**9), ("bb", 2**30)))
    assert len(first) == 2
    assert first == second
    ((name, data),) = ((name, data) for name, data in first.items() if name.endswith(".whl"))
    assert name.endswith("-py3-none-any.whl")
    with zipfile.ZipFile(io.BytesIO(data)) as wheel:
        assert not any(entry.endswith((".so", ".pyd")) for entry in wheel.namelist())
        (told,) = [wheel.read(entry).decode() for entry in wheel.namelist() if entry.endswith(".dist-info/WHEEL")]
        assert "Root-Is-Purelib: true" in told
        assert "truebreak/exact/exact_engine.py" in wheel.namelist()


def test_a_new_folder_is_a_package_without_being_listed(tmp_path: Path) -> None:
    for place in ("exact", "exact/new", "exact/new/within", "face", "exact/data"):
        (tmp_path / place).mkdir()
        if place != "exact/data":
            (tmp_path / place / "__init__.py").touch()
    folders = {"truebreak": str(tmp_path / "face"), "truebreak.exact": str(tmp_path / "exact")}
    assert packages(folders) == ["truebreak", "truebreak.exact", "truebreak.exact.new", "truebreak.exact.new.within"]


def packed(names: list[str], time: int, owner: str, mode: int) -> bytes:
    out = io.BytesIO()
    with tarfile.open(fileobj=out, mode="w:gz") as archive:
        for name in names:
            member = tarfile.TarInfo(name)
            member.size, member.mtime, member.uname, member.uid, member.mode = len(name), time, owner, time % 99, mode
            archive.addfile(member, io.BytesIO(name.encode()))
    return out.getvalue()


def test_an_archive_of_sources_tells_neither_who_packed_it_nor_when() -> None:
    one = repacked(packed(["b", "a"], 5, "me", 0o600), 7)
    assert one == repacked(packed(["a", "b"], 6, "you", 0o664), 7)
    assert one != repacked(packed(["a", "b"], 6, "you", 0o664), 8)
    assert one != repacked(packed(["a", "b"], 6, "you", 0o755), 7)  # a program stays one
    with tarfile.open(fileobj=io.BytesIO(one)) as archive:
        files = {name: archive.extractfile(name) for name in archive.getnames()}
        assert {name: file.read() for name, file in files.items() if file} == {"a": b"a", "b": b"b"}


# -- the workflow that would build a release


def workflow() -> dict[str, Any]:
    (path,) = (ROOT / ".github" / "workflows").glob("*.yml")
    return yaml.safe_load(path.read_text("utf-8"))


def test_the_workflow_builds_wheels_for_every_python_and_system_that_is_declared() -> None:
    jobs = workflow()["jobs"]
    settings = jobs["wheels"]["steps"][2]["env"]
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["classifiers"]
    versions = [text.rpartition(" ")[2] for text in declared if text.startswith("Programming Language :: Python :: 3.")]
    assert settings["CIBW_BUILD"].split() == [f"cp{version.replace('.', '')}-*" for version in versions]
    systems = jobs["wheels"]["strategy"]["matrix"]["os"]
    assert {name.partition("-")[0] for name in systems} == {"ubuntu", "macos", "windows"}
    assert settings["CIBW_ENVIRONMENT_PASS_LINUX"] == "SOURCE_DATE_EPOCH"


def test_the_workflow_runs_what_there_is_here() -> None:
    """Its own commands: targets of the Makefile, the command's words; what others made has a version."""
    steps = [step for job in workflow()["jobs"].values() for step in job["steps"]]
    assert all(re.fullmatch(r"[\w-]+/[\w-]+@v\d[\d.]*", step["uses"]) for step in steps if "uses" in step)
    runs = "\n".join(step["run"] for step in steps if "run" in step)
    makefile = (ROOT / "Makefile").read_text("utf-8")
    targets = re.findall(r"\bmake (\w+)", runs)
    assert targets
    assert all(f"\n{target}:" in makefile for target in targets)
    said = next(step["env"]["CIBW_TEST_COMMAND"] for step in steps if "cibuildwheel" in step.get("uses", ""))
    for command in said.split(" && "):
        name, *words = command.split()
        assert name == "truebreak"
        done = subprocess.run([sys.executable, "-m", "truebreak", *words], cwd=ROOT, capture_output=True, check=False)
        assert done.returncode == 0, done.stderr.decode()
    assert workflow()["permissions"] == {"contents": "read"}  # it publishes nothing
