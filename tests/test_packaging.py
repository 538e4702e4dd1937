"""The wheel holds everything, and only below `truebreak`: users keep their own `compare/` and `exact/`."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
FOLDERS = ("scenarios", "tools", "exact", "floating", "compare")
SETTINGS = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))


def sources() -> set[str]:
    """Every file of the folders, as a path from the project's top."""
    return {
        path.relative_to(ROOT).as_posix()
        for folder in FOLDERS
        for path in (ROOT / folder).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, built from a copy of the sources so that nothing is left among them."""
    folder = tmp_path_factory.mktemp("wheel")
    copy = folder / "sources"
    for name in FOLDERS:
        shutil.copytree(ROOT / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, copy / name)
    command = [
        sys.executable,
        "-m",
        "pip",
        "wheel",
        "-q",
        "--no-deps",
        "--no-build-isolation",
        "-w",
        str(folder),
    ]
    done = subprocess.run([*command, str(copy)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    (built,) = folder.glob("truebreak-*.whl")
    return built


@pytest.fixture(scope="module")
def site(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel's files, unpacked as an installer does."""
    folder = tmp_path_factory.mktemp("site")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder)
    return folder


def test_every_folder_with_code_is_a_listed_package() -> None:
    packages = set(SETTINGS["tool"]["setuptools"]["packages"])
    with_code = {"truebreak." + name.rpartition("/")[0].replace("/", ".") for name in sources() if name.endswith(".py")}
    assert with_code == packages


def test_wheel_holds_every_file_of_the_folders(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = {name for name in archive.namelist() if ".dist-info/" not in name}
    assert names == {f"truebreak/{name}" for name in sources()}
    typed = set(FOLDERS) - {"tools"}  # the checker is written to be read, without types
    assert {f"truebreak/{folder}/py.typed" for folder in typed} <= names


def test_wheel_claims_no_general_name(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        tops = {name.partition("/")[0] for name in archive.namelist()}
    assert {top for top in tops if not top.endswith(".dist-info")} == {"truebreak"}


def test_wheel_carries_the_licence_and_the_command(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        (commands,) = [archive.read(name).decode() for name in names if name.endswith("entry_points.txt")]
    assert any(name.endswith("LICENSE") for name in names)
    assert "truebreak = truebreak.compare.cli:main" in commands


def user_project(folder: Path) -> Path:
    """Somebody's project whose own folders bear the names of ours."""
    for name in (*FOLDERS, "tests"):
        (folder / name).mkdir()
        (folder / name / "__init__.py").write_text(f"mine = {name!r}\n", "utf-8")
    (folder / "tests" / "test_mine.py").write_text(
        "import compare, exact, floating, scenarios\n"
        "import truebreak.compare, truebreak.exact, truebreak.floating, truebreak.scenarios\n"
        "def test_both():\n"
        "    assert (compare.mine, exact.mine) == ('compare', 'exact')\n"
        "    assert truebreak.exact.__name__ == 'truebreak.exact'\n",
        "utf-8",
    )
    return folder


@pytest.mark.parametrize("installed", ["wheel", "editable"])
def test_users_keep_their_own_folders_of_the_same_names(
    installed: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    project = user_project(tmp_path)
    environment = dict(os.environ)
    expected = ROOT
    if installed == "wheel":
        expected = request.getfixturevalue("site")
        environment["PYTHONPATH"] = str(expected)
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "tests"]
    tests = subprocess.run(command, cwd=project, env=environment, capture_output=True, text=True, check=False)
    assert tests.returncode == 0, tests.stdout + tests.stderr
    where = [sys.executable, "-c", "import truebreak.exact as e, exact; print(e.__file__); print(exact.mine)"]
    done = subprocess.run(where, cwd=project, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    file, mine = done.stdout.splitlines()
    assert Path(file).is_relative_to(expected)
    assert mine == "exact"


def test_general_names_are_not_importable_from_elsewhere(tmp_path: Path) -> None:
    code = "import importlib.util as u, sys; sys.exit(any(u.find_spec(name) for name in sys.argv[1:]))"
    done = subprocess.run([sys.executable, "-c", code, *FOLDERS], cwd=tmp_path, check=False)
    assert done.returncode == 0, "the installation puts a top-level package of a general name on the path"


def test_installed_command_runs_from_anywhere(site: Path, tmp_path: Path) -> None:
    code = "import sys; sys.argv[:] = ['truebreak', '--help']; from truebreak.compare.cli import main; main()"
    environment = {**os.environ, "PYTHONPATH": str(site)}
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "compare" in done.stdout
