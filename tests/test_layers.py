"""Imports run one way, scenarios, tools, exact, floating, compare, and nothing heavy comes before it is needed."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

import pytest
from followed import followed

ROOT = Path(__file__).resolve().parent.parent
TESTS = ROOT / "tests"
LAYERS = ("scenarios", "tools", "exact", "floating", "compare")
"""Lowest first: a layer imports itself and those before it."""

FILES = {
    ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path
    for layer in LAYERS
    for path in sorted((ROOT / layer).rglob("*.py"))
}
"""Every module by its name below `truebreak`."""


def tree(module: str) -> ast.Module:
    """What a module says; it is not kept, as all of them are much."""
    return ast.parse(FILES[module].read_text("utf-8"))


class Imports(NamedTuple):
    """What a module imports, and what of that is named from the top."""

    all: tuple[str, ...]
    running: tuple[str, ...]
    tops: tuple[str, ...]


@cache
def imports(module: str) -> Imports:
    """Those of a module, which is read once."""
    path, read = FILES[module], tree(module)
    package = f"truebreak.{module if path.name == '__init__.py' else module.rpartition('.')[0]}"
    nodes = [node for node in ast.walk(read) if isinstance(node, ast.Import | ast.ImportFrom)]
    tops = [alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names]
    tops += [str(node.module) for node in nodes if isinstance(node, ast.ImportFrom) and node.level == 0]
    return Imports(tuple(_imports(read, package, True)), tuple(_imports(read, package, False)), tuple(tops))


def imported(module: str, with_types: bool = True) -> tuple[str, ...]:
    """Full names that a module imports, relative ones resolved: `truebreak.exact.laws.formulas`, `sympy`.

    Imports inside functions count, and so does `import_module` of a literal name; with `with_types=False`
    those under `if TYPE_CHECKING` do not.
    """
    found = imports(module)
    return found.all if with_types else found.running


def _imports(node: ast.AST, package: str, with_types: bool) -> Iterator[str]:
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    elif isinstance(node, ast.ImportFrom):
        base = _absolute("." * node.level + (node.module or ""), package)
        yield base
        yield from (f"{base}.{alias.name}" for alias in node.names)
    elif isinstance(node, ast.Call) and ast.unparse(node.func).rpartition(".")[2] == "import_module":
        yield from (_absolute(str(a.value), package) for a in node.args[:1] if isinstance(a, ast.Constant))
    for child in ast.iter_child_nodes(node):
        if isinstance(node, ast.If) and ast.unparse(node.test).endswith("TYPE_CHECKING") and not with_types:
            continue
        yield from _imports(child, package, with_types)


def _absolute(name: str, package: str) -> str:
    level = len(name) - len(name.lstrip("."))
    if level == 0:
        return name
    parts = package.split(".")
    return ".".join([*parts[: len(parts) - level + 1], *filter(None, [name[level:]])])


def own(names: Iterable[str]) -> set[str]:
    """Those of the names that are modules of this project, without the leading `truebreak.`."""
    return {short for name in names if (short := name.removeprefix("truebreak.")) != name and short in FILES}


def reached(module: str) -> set[str]:
    """Every module of this project that a module imports when it runs, directly or through others."""
    found: set[str] = set()
    waiting = [module]
    while waiting:
        for name in own(imported(waiting.pop(), with_types=False)) - found:
            found.add(name)
            waiting.append(name)
    return found


def used(module: str) -> set[str]:
    """The files of this project that a file names in its imports: for a name from a package, the name's own file."""
    path = FILES[module]
    package = module if path.name == "__init__.py" else module.rpartition(".")[0]
    found: set[str] = set()
    for node in ast.walk(tree(module)):
        names = list(_imports(node, f"truebreak.{package}", True)) if isinstance(node, IMPORTING) else []
        files = own(names)
        found |= {name for name in files if not any(other.startswith(f"{name}.") for other in files)}
    return found - {module}


IMPORTING = (ast.Import, ast.ImportFrom, ast.Call)


def circles() -> list[frozenset[str]]:
    """The largest sets of files of which each imports every other, directly or through others."""
    uses = {module: used(module) for module in FILES}
    below: dict[str, set[str]] = {}
    for module in FILES:
        below[module], waiting = set(), [module]
        while waiting:
            new = uses[waiting.pop()] - below[module]
            below[module] |= new
            waiting += new
    together = {frozenset({m, *(n for n in below[m] if m in below[n])}) for m in FILES if m in below[m]}
    return sorted(together, key=sorted)


def test_no_two_files_import_each_other() -> None:
    """Directly or through others, imports inside functions and those for types included."""
    assert circles() == []


MOST_LINES = 700
MOST_METHODS = 20
KNOWN_LONG_FILES: dict[str, int] = {"tests/compare/causes_known.py": 720}
KNOWN_LARGE_CLASSES: dict[str, int] = {
    "compare.causes.decision.RunReader": 23,
    "exact.replay.state.ReplayState": 22,
}
"""Not mended yet, with their lines and methods: these lists and their numbers may only shrink. `ReplayState` has a few
methods for each kind of contact, and will until each kind has a class; the checker is one file for one reader."""
GENERATED = ("exact.laws.formulas", "tests/fuzz/mutants_fresh.py", "tests/fuzz/mutants_questions.py")
"""And lists of planted faults: data."""


def test_no_file_is_long() -> None:
    lines = {module: len(path.read_text("utf-8").splitlines()) for module, path in FILES.items()}
    others = [*sorted(TESTS.rglob("*.py")), *sorted((ROOT / "docs").rglob("*.py"))]
    lines |= {str(p.relative_to(ROOT)): len(p.read_text("utf-8").splitlines()) for p in others}
    whole = ("tools.verify",)  # one file by intent: test_certificates.py holds its limit
    long = {module: n for module, n in lines.items() if n > MOST_LINES and module not in GENERATED + whole}
    assert long.keys() == KNOWN_LONG_FILES.keys()
    assert all(n <= KNOWN_LONG_FILES[module] for module, n in long.items())


def methods(node: ast.ClassDef) -> int:
    """How many methods a class has, operators aside."""
    names = {n.name for n in node.body if isinstance(n, ast.FunctionDef)}
    return sum(not (name.startswith("__") and name.endswith("__")) for name in names)


def test_no_class_is_large() -> None:
    large: dict[str, int] = {}
    for module in FILES:
        for node in ast.walk(tree(module)):
            if isinstance(node, ast.ClassDef) and methods(node) > MOST_METHODS:
                large[f"{module}.{node.name}"] = methods(node)
    assert large.keys() == KNOWN_LARGE_CLASSES.keys()
    assert all(n <= KNOWN_LARGE_CLASSES[name] for name, n in large.items())


def test_no_name_of_a_module_or_of_a_public_class_stands_twice() -> None:
    places: dict[str, list[str]] = {}
    for module, path in FILES.items():
        if path.name not in ("__init__.py", "__main__.py"):
            places.setdefault(path.stem, []).append(module)
        for node in tree(module).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                places.setdefault(node.name, []).append(module)
    assert len(places) > 700
    assert {name: modules for name, modules in places.items() if len(modules) > 1} == {}


def test_one_event_is_followed_through_few_modules() -> None:
    """A reader opens these, and no more, to follow an event of the exact engine."""
    modules = followed("event")
    assert {"exact.simulation.loop", "exact.replay.state", "scenarios.scene"} <= set(modules) <= set(FILES)
    assert len(modules) <= 28, modules


def test_one_verdict_is_followed_through_few_modules() -> None:
    """And these to follow one comparison with its causes."""
    modules = followed("verdict")
    assert {"compare.comparison", "compare.alignment.align", "exact.simulation.loop"} <= set(modules) <= set(FILES)
    assert len(modules) <= 70, modules


def test_resolver_sees_relative_lazy_and_named_imports() -> None:
    source = (
        "import sympy\n"
        "from ..scenarios.scene import Scene\n"
        "def late():\n"
        "    from .laws import formulas\n"
        "    import_module('..floating.double', __package__)\n"
    )
    names = set(_imports(ast.parse(source), "truebreak.exact", True))
    assert {
        "sympy",
        "truebreak.scenarios.scene",
        "truebreak.exact.laws.formulas",
        "truebreak.floating.double",
    } <= names


@pytest.mark.parametrize("module", FILES)
def test_a_layer_imports_only_itself_and_those_below(module: str) -> None:
    layer = module.partition(".")[0]
    allowed = LAYERS[: LAYERS.index(layer) + 1]
    wrong = {name for name in own(imported(module)) if name.partition(".")[0] not in allowed}
    assert not wrong, f"{module} imports {sorted(wrong)}, which lies above {layer}"


FLOORS = (
    "compiled",
    "laws",
    "numbers",
    "replay",
    "question",
    "isometry",
    "log_symmetry",
    "simulation",
    "certified",
    "texts",
    "flight_formulas",
    "exact_motion",
    "exact_engine",
    "literal",  # which itself imports of these only numbers and laws
    "digest",
)
"""The rooms of `exact`, lowest first: a room imports itself and those before it."""


@pytest.mark.parametrize("module", [name for name in FILES if name.startswith("exact.")])
def test_a_room_of_exact_imports_only_itself_and_those_below(module: str) -> None:
    room = module.split(".")[1]
    below = {"numbers", "laws"} if room == "literal" else set(FLOORS[: FLOORS.index(room) + 1])
    used = {name.split(".")[1] for name in own(imported(module)) if name.startswith("exact.")}
    assert used <= below | {room}, f"{module} imports {sorted(used - below - {room})}, which lie above {room}"


COMPARE_FLOORS = (
    "writing validation deadline engines scene_argument",
    "foreign run adapters side_by_side",
    "files",
    "alignment tangent picture orders",
    "outcomes study",
    "audit causes tolerances candidate",
    "alternatives comparison",
    "chaos shadowing certificate vectors",
    "grids",
    "reduction logdiff",
    "report",
    "saved_comparisons testing",
    "play",
    "cli",
)
"""The rooms and modules of `compare`, lowest first: what runs there runs nothing of a floor above."""


def floor_of(module: str) -> int:
    """The number of a module's floor; `compare` itself only hands names on."""
    room = module.split(".")[1] if "." in module else ""
    return next((k for k, floor in enumerate(COMPARE_FLOORS) if room in floor.split()), -1)


@pytest.mark.parametrize("module", [name for name in FILES if name.startswith("compare.")])
def test_a_floor_of_compare_runs_only_itself_and_those_below(module: str) -> None:
    """Imports inside functions count; those for types alone do not, as they are never carried out."""
    mine = floor_of(module)
    assert mine >= 0, f"{module} is on no floor: add its room to COMPARE_FLOORS"
    above = {n for n in own(imported(module, with_types=False)) if n.startswith("compare.") and floor_of(n) > mine}
    assert not above, f"{module} imports {sorted(above)}, which lie above its floor"


@pytest.mark.parametrize("module", FILES)
def test_siblings_are_imported_relatively(module: str) -> None:
    wrong = [name for name in imports(module).tops if name.partition(".")[0] in ("truebreak", *LAYERS)]
    assert not wrong, f"{module} imports {wrong}; write it relatively, as in `from ..scenarios.scene import Scene`"


def test_pymunk_engine_is_independent_of_the_exact_layer() -> None:
    used = {name for name in reached("floating.pymunk_engine") if name.partition(".")[0] == "exact"}
    assert not used, f"floating/pymunk_engine.py reaches {sorted(used)}; it must stay an independent witness"


def test_symbolic_engine_does_not_share_the_event_loop() -> None:
    own = (
        "exact.simulation",
        "exact.question",
        "exact.isometry",
        "exact.log_symmetry",
        "exact.numbers",
        "exact.exact_engine",
        "exact.replay",
        "exact.certified",
        "exact.laws.formulas",
    )
    used = {name for name in reached("exact.literal.symbolic_engine") if name.startswith(own)}
    assert {name for name in reached("exact.exact_engine") if name.startswith(own)} > {"exact.simulation.loop"}
    assert not used, f"exact/literal/symbolic_engine.py reaches {sorted(used)}; it must stay an independent oracle"


TINY = "Scene([Circle(0, 0, vx=1), Circle('9/2', 1, vx=-1)], [Wall(9, 0, 9, 1)])"
"""Irrational from its first collision on, so that the exact engine must leave plain rationals."""


@pytest.mark.parametrize(
    ("code", "absent"),
    [
        (
            "import truebreak; dir(truebreak); truebreak.__version__",
            "sympy numpy flint pymunk mpmath click rich jinja2",
        ),
        ("import truebreak as tb; tb.scene('rack').digest", "sympy numpy pymunk mpmath click rich jinja2"),
        ("import truebreak.scenarios", "sympy numpy flint pymunk"),
        (f"from truebreak.scenarios import *; {TINY}", "sympy numpy pymunk"),
        ("import truebreak.exact; truebreak.exact.ExactEngine", "sympy pymunk"),
        (
            f"from truebreak.scenarios import *; from truebreak.exact import ExactEngine; "
            f"run = ExactEngine().run({TINY}, events=5); assert run.events; float(run.final.circles[0].x)",
            "sympy numpy pymunk",
        ),
        ("import truebreak.floating; truebreak.floating.DoubleEngine", "sympy pymunk"),
        ("import truebreak.compare", "sympy pymunk"),
        ("import truebreak.compare.grids.family_sweep", "sympy numpy pymunk email"),
        (
            "import sys; sys.argv[1:] = ['--help']; from truebreak.compare.cli import main; main()",
            "sympy pymunk",
        ),
        (
            "import sys; sys.argv[1:] = ['scenes']; from truebreak.compare.cli import main; main()",
            "sympy pymunk",
        ),
        (
            "from truebreak.compare.cli import main; main(['run', 'gas', '--events', '5'])",
            "sympy numpy pymunk mpmath jinja2",
        ),
    ],
    ids=[
        "face",
        "face-scene",
        "scenarios",
        "scene",
        "exact",
        "exact-run",
        "floating",
        "compare",
        "worker",
        "help",
        "scenes",
        "run",
    ],
)
def test_heavy_packages_are_not_imported_before_they_are_needed(code: str, absent: str, tmp_path: Path) -> None:
    script = (
        "import atexit, sys\n"
        "atexit.register(lambda: print('LOADED', *sorted(m for m in sys.modules if '.' not in m)))\n" + code
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, cwd=tmp_path, check=False)
    assert done.returncode == 0, done.stderr
    loaded = set(done.stdout.rpartition("LOADED")[2].split())
    assert "sys" in loaded
    assert not loaded & set(absent.split())


@pytest.mark.parametrize("layer", [layer for layer in LAYERS if (ROOT / "tests" / layer).is_dir()])
def test_the_tests_lie_in_rooms_of_the_house(layer: str) -> None:
    """Each folder of tests of a layer has the name of one of its rooms."""
    top = ROOT / "tests" / layer
    rooms = {path.relative_to(top) for path in top.rglob("*") if any(path.glob("*.py"))}
    strange = {str(room) for room in rooms if not (ROOT / layer / room / "__init__.py").is_file()}
    strange -= {"audit/bench"}  # what is audited: engines, faults and scenes of their own
    assert not strange, f"tests/{layer}: {sorted(strange)}"


def test_the_page_on_architecture_names_every_room() -> None:
    """Each folder that holds code, in the picture at its head."""
    page = (ROOT / "docs" / "architecture.md").read_text("utf-8").partition("\n## ")[0]
    for layer in ("compare", "exact", "scenarios"):
        rooms = {path.name for path in (ROOT / layer).iterdir() if (path / "__init__.py").exists()}
        unnamed = {room for room in rooms if room not in page.split()}
        assert not unnamed, f"{layer}: {sorted(unnamed)}"


def test_files_that_the_docs_name_are_there() -> None:
    """Each `room/file.py`, as it ends some path of the project."""
    there = {
        str(path.relative_to(ROOT)) for layer in (*LAYERS, "tests", "docs") for path in (ROOT / layer).rglob("*.py")
    }
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
    named = {(page.name, name) for page in pages for name in re.findall(r"`([\w/]+\.py)`", page.read_text("utf-8"))}
    assert named
    lost = {(page, name) for page, name in named if not any(f"/{path}".endswith(f"/{name}") for path in there)}
    assert not lost, sorted(lost)
