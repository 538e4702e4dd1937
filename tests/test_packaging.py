"""The wheel holds everything, and only below `truebreak`: users keep their own `compare/` and `exact/`."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest
from test_docs import BLOCK

import truebreak as tb
import truebreak.exact
from truebreak.exact.compiled import predictions

ROOT = Path(__file__).resolve().parent.parent
LAYERS = ("scenarios", "tools", "exact", "floating", "compare")
FOLDERS = (*LAYERS, "truebreak")
HERE = Path(str(truebreak.exact.__file__)).parents[1]
"""What holds the packages of the installation that runs these tests: the sources, or `truebreak` of its own wheel."""

COMMAND = "import sys; sys.argv[:] = ['truebreak', '--help']; from truebreak.compare.cli import main; main()"
SETTINGS = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))


def sources() -> set[str]:
    """Every file of the packages, as a path from the project's top."""
    return {
        path.relative_to(ROOT).as_posix()
        for folder in FOLDERS
        for path in (ROOT / folder).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts and path.suffix not in (".so", ".pyd")
    }


def _compiled_from(name: str) -> bool:
    """Whether a file is a source of compiled parts; what is for engines of others is not."""
    return name.endswith((".c", ".h")) and not name.startswith(("compare/logdiff/", "compare/vectors/"))


def installed(name: str) -> str:
    """Where a file of the project is in an installation: all packages are below the face."""
    return name if name.startswith("truebreak/") else f"truebreak/{name}"


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, built from a copy of the sources so that nothing is left among them."""
    folder = tmp_path_factory.mktemp("wheel")
    copy = folder / "sources"
    for name in FOLDERS:
        shutil.copytree(ROOT / name, copy / name, ignore=shutil.ignore_patterns("__pycache__", "*.so", "*.pyd"))
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


def test_every_folder_with_code_is_a_package() -> None:
    """And so is in the wheel: `tools/building.py` finds packages by that file."""
    with_code = {name.rpartition("/")[0] for name in sources() if name.endswith(".py")}
    assert [folder for folder in with_code if not (ROOT / folder / "__init__.py").is_file()] == []


def test_wheel_holds_every_file_of_the_folders(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = {name for name in archive.namelist() if ".dist-info/" not in name}
    compiled = {name for name in names if name.endswith((".so", ".pyd"))}
    assert names - compiled == {installed(name) for name in sources() if not _compiled_from(name)}
    if predictions is not None:  # this installation was compiled, so that one is too
        assert {name.partition(".")[0] for name in compiled} == {
            module["name"].replace(".", "/") for module in SETTINGS["tool"]["setuptools"]["ext-modules"]
        }
    typed = set(FOLDERS) - {"tools"}  # the checker is written to be read, without types
    assert {installed(f"{folder}/py.typed") for folder in typed} <= names


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
    for name in (*LAYERS, "tests"):
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


@pytest.mark.parametrize("installed", ["wheel", "this one"])
def test_users_keep_their_own_folders_of_the_same_names(
    installed: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    project = user_project(tmp_path)
    environment = dict(os.environ)
    expected = HERE
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
    done = subprocess.run([sys.executable, "-c", code, *LAYERS], cwd=tmp_path, check=False)
    assert done.returncode == 0, "the installation puts a top-level package of a general name on the path"


@pytest.mark.parametrize("entry", [["-c", COMMAND], ["-m", "truebreak", "--help"]], ids=["command", "module"])
@pytest.mark.parametrize("where", ["wheel", "this one"])
def test_command_runs_from_anywhere(
    where: str, entry: list[str], tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    done = python(where, entry, tmp_path, request)
    assert done.returncode == 0, done.stderr
    assert "Usage: truebreak" in done.stdout


@pytest.mark.parametrize("where", ["wheel", "this one"])
def test_the_face_hands_its_names_on(where: str, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    code = (
        "import truebreak as tb\n"
        "scene = tb.Scene([tb.Circle(0, 0, vx=1), tb.Circle(4, 1)], [tb.Wall(9, 0, 9, 1)])\n"
        "assert set(tb.__all__) <= set(dir(tb))\n"
        "assert all(getattr(tb, name) is not None for name in tb.__all__)\n"
        "print(tb.__file__, tb.__version__, len(tb.run(scene, until=20).events), len(tb.scene('lee').circles))\n"
    )
    done = python(where, ["-c", code], tmp_path, request)
    assert done.returncode == 0, done.stderr
    file, *rest = done.stdout.split()
    assert Path(file).is_relative_to(request.getfixturevalue("site") if where == "wheel" else HERE)
    assert rest == [SETTINGS["project"]["version"], "2", "3"]


USER = """\
import truebreak as tb
scene = tb.scene("lee")
own = tb.Scene([tb.Circle(0, 0, vx=1)], [tb.Wall(9, 0, 9, 1)])
count: int = len(tb.run(own, "double", until=5).events)
verdict: str = tb.comparison(own, ["double"]).verdict
times: list[float] = [float(event.time) for event in tb.run(scene).events]
version: str = tb.__version__
wrong: int = tb.load("x.toml")
"""


def test_type_checkers_see_the_names_of_the_face(site: Path, tmp_path: Path) -> None:
    """In strict mode, in a user's project, with one deliberate mistake."""
    (tmp_path / "user.py").write_text(USER, "utf-8")
    found = strictly(site, tmp_path, "user.py")
    assert [line for _, line, _ in found] == [len(USER.splitlines())], found


ENGINES = """\
from dataclasses import dataclass
from typing import Any
from truebreak.floating import DoubleEngine
from truebreak.compare.foreign import RecordedEngine, Recording
from truebreak.scenarios import Declared, Engine, Scene, Trajectory

class Stated(Declared):
    name, step, bits, rounds_input = "stated", 1 / 64, 24, True
    scene_keys = frozenset({"wall"})

    def run(self, scene: Scene, **limits: Any) -> Trajectory:
        return DoubleEngine().run(scene, **limits)

@dataclass(frozen=True)
class Fields(Stated):
    bits: int = 53
    step: float = 1 / 64

class Told(Stated):
    @property
    def step(self) -> float:
        return 1 / 64

@dataclass(frozen=True)
class Played(RecordedEngine):
    step: float = 1 / 256
    bits = 24
    scene_keys = frozenset({"wall"})

    def play(self, scene: Scene, recording: Recording) -> None:
        return None

engines: list[Engine] = [Stated(), Fields(), Played()]
wrong: list[Engine] = [3]
"""


def test_an_engine_states_what_it_is_by_attributes_fields_or_properties(site: Path, tmp_path: Path) -> None:
    """Derived from either base, in strict mode, with one deliberate mistake."""
    (tmp_path / "engines.py").write_text(ENGINES, "utf-8")
    found = strictly(site, tmp_path, "engines.py")
    assert [line for _, line, _ in found] == [len(ENGINES.splitlines())], found


def statements(text: str) -> str:
    """The Python of a page's blocks: of sessions what is typed at the prompt."""
    found: list[str] = []
    for match in BLOCK.finditer(text):
        if match["language"] == "pycon":
            lines = (line for line in match["text"].splitlines() if line.startswith((">>> ", "... ")))
            found += [line[4:] for line in lines]
        elif match["language"] == "python":
            found += match["text"].splitlines()
    return "\n".join(found) + "\n"


def test_the_readmes_python_passes_a_strict_type_checker(site: Path, tmp_path: Path) -> None:
    """In a user's project; what pytest hands to a test has the type that a user gives it."""
    code = statements((ROOT / "README.md").read_text("utf-8"))
    assert "ExactEngine" in code
    assert "truebreak.check" in code
    code = code.replace("def test_my_engine(truebreak):", "def test_my_engine(truebreak: Truebreak) -> None:")
    shown = [line for line in code.splitlines() if line and not line[0].isspace()]
    alone = {line for line in shown if not line.startswith(("from ", "import ", "def ", "@")) and " = " not in line}
    code = "\n".join(f"print({line})" if line in alone else line for line in code.splitlines())
    code = f"from truebreak.testing import Truebreak\n{code}\n"
    face = "import truebreak as tb\n" + "\n".join(f"print(tb.{name})" for name in tb.__all__) + "\n"
    (tmp_path / "readme.py").write_text(code, "utf-8")
    (tmp_path / "face.py").write_text(face, "utf-8")
    (tmp_path / "wrong.py").write_text('import truebreak as tb\nwrong: int = tb.resume("run.json")\n', "utf-8")
    found = strictly(site, tmp_path, "readme.py", "face.py", "wrong.py")
    assert [(file, line) for file, line, _ in found] == [("wrong.py", 2)], found


def strictly(site: Path, folder: Path, *files: str) -> list[tuple[str, int, str]]:
    """What pyright has to say of a user's files in strict mode: file, line and message."""
    settings = {"include": files, "strict": files, "extraPaths": [str(site)]}
    (folder / "pyrightconfig.json").write_text(json.dumps(settings), "utf-8")
    command = [sys.executable, "-m", "pyright", "--outputjson", "--pythonpath", sys.executable]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    told = json.loads(done.stdout)["generalDiagnostics"]
    return [(Path(d["file"]).name, d["range"]["start"]["line"] + 1, d["message"]) for d in told]


def test_the_studies_are_typed(site: Path, tmp_path: Path) -> None:
    """They are no part of the packages, and import them as a user does."""
    shutil.copytree(ROOT / "docs" / "studies", tmp_path / "studies")
    settings = {"include": ["studies"], "extraPaths": [str(site)], "reportMissingTypeStubs": False}
    (tmp_path / "pyrightconfig.json").write_text(json.dumps(settings), "utf-8")
    command = [sys.executable, "-m", "pyright", "--pythonpath", sys.executable]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


def python(
    where: str, arguments: list[str], folder: Path, request: pytest.FixtureRequest
) -> subprocess.CompletedProcess[str]:
    """Python in an empty folder, with the wheel or with the installation that runs these tests."""
    environment = dict(os.environ)
    if where == "wheel":
        environment["PYTHONPATH"] = str(request.getfixturevalue("site"))
    command = [sys.executable, *arguments]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


def test_the_version_is_told_once_more_where_nothing_is_looked_up() -> None:
    from truebreak.scenarios.lazy import VERSION

    assert tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["version"] == VERSION


@pytest.mark.parametrize("pure", ["", "1"])
def test_the_version_says_whether_compiled_parts_are_in_use(pure: str, tmp_path: Path) -> None:
    environment = {**os.environ, "TRUEBREAK_PURE_PYTHON": pure}
    command = [sys.executable, "-m", "truebreak", "--version"]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    version = SETTINGS["project"]["version"]
    parts = "compiled parts in use" if predictions is not None else "pure Python: no compiled parts are installed"
    told = "pure Python: TRUEBREAK_PURE_PYTHON is set" if pure else parts
    assert (done.returncode, done.stdout, done.stderr) == (0, f"truebreak {version} ({told})\n", "")


@pytest.mark.parametrize(
    "words",
    [
        ["-m", "truebreak", "run", "galperin:n=1", "--events", "3", "--json"],
        [
            "-c",
            "import truebreak.scenarios, truebreak.compare.cli, truebreak.tools as t; print(t)",
        ],
        ["-m", "pytest", "-q", "tests/scenarios/test_neighbours.py"],
    ],
    ids=["command", "import", "tests"],
)
def test_a_checkout_works_in_place_whatever_is_installed(words: list[str], site: Path, tmp_path: Path) -> None:
    """In its top folder Python finds the folder truebreak/ before the wheel, and the packages beside it."""
    copy = tmp_path / "checkout"
    for name in (*FOLDERS, "tests"):
        shutil.copytree(ROOT / name, copy / name, ignore=shutil.ignore_patterns("__pycache__", "*.so", "*.pyd", "data"))
    shutil.copy(ROOT / "pyproject.toml", copy / "pyproject.toml")
    found = "import sys; sys.meta_path = [f for f in sys.meta_path if 'editable' not in type(f).__module__ + str(f)]\n"
    (tmp_path / "sitecustomize.py").write_text(found, "utf-8")
    environment = {**os.environ, "PYTHONPATH": f"{tmp_path}{os.pathsep}{site}"}
    done = subprocess.run(
        [sys.executable, *words], cwd=copy, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    where = [
        sys.executable,
        "-c",
        "import truebreak.exact as e, truebreak.scenarios as s; print(e.__file__, s.__file__)",
    ]
    told = subprocess.run(where, cwd=copy, env=environment, capture_output=True, text=True, check=True).stdout
    assert all(Path(file).is_relative_to(copy) for file in told.split())
