"""One digest, in all the ways that this machine has: `python tests/same_bytes.py FOLDER`, or `make same-bytes`.

`truebreak.exact.digest` is run on every Python that there is, with the newest versions of what it stands on and with
the lowest, with and without compiled parts, in SymPy's three kinds of numbers, under five hash seeds; and in
WebAssembly, by Pyodide, where there are node and npm. Every way is a line; the exit code is 1 if any digest is another,
77 if there is no way to run it.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import product
from pathlib import Path

from lowest import declared, lowest
from pythons import pythons

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("scenarios", "exact", "floating", "compare", "tools", "truebreak")
NEEDED = ("mpmath", "python-flint", "sympy")
"""What the digest stands on; gmpy2, in which SymPy may count, is installed beside it."""

SEEDS = range(5)
KINDS = ("python", "gmpy", "flint")
PYODIDE = "pyodide@314.0.7"
WASM = (
    "--python-version",
    "3.14",
    "--implementation",
    "cp",
    "--abi",
    "cp314",
    "--platform",
    "pyemscripten_2026_0_wasm32",
)
"""For which Python and platform that Pyodide takes wheels."""

TOLD = """\
import sys
from truebreak.exact.compiled import predictions
from truebreak.exact.digest import main
try:
    from sympy.external.gmpy import GROUND_TYPES as kind
except ImportError:
    kind = "none"
from importlib.metadata import version
versions = [f"{name} {version(name)}" for name in ("python-flint", "sympy")]
print(sys.version.split()[0], "compiled" if predictions else "pure", kind, *versions)
main([])
if "sympy" in sys.argv:
    main(["--sympy"])
"""
"""Prints what is in use, and the digest of the exact engine, and perhaps that of the SymPy engine."""

SYMPY_SEEDS = (0, 1)
"""The SymPy engine derives its laws first, which takes ten times as long as the rest: under these seeds only, and where
there are no compiled parts, of which it uses none."""


@dataclass(frozen=True)
class Way:
    """One way to run it.

    Attributes:
        label: which, as it was asked for.
        found: what was in use: the version, `compiled` or `pure`, the kind of numbers; or what went wrong.
        digests: of the exact engine, and perhaps of the SymPy engine; none if it went wrong.
    """

    label: str
    found: str
    digests: tuple[str, ...]

    @classmethod
    def of(cls, label: str, done: subprocess.CompletedProcess[str]) -> Way:
        """The way that a process went."""
        found, *digests = done.stdout.splitlines() or [""]
        if done.returncode or not digests:
            return cls(label, " ".join((done.stderr or done.stdout).split())[-300:], ())
        return cls(label, found, tuple(digests))


def sources(folder: Path) -> Path:
    """A copy of the sources, so that nothing is built among them."""
    copy = folder / "sources"
    shutil.rmtree(copy, ignore_errors=True)
    leave = shutil.ignore_patterns("__pycache__", "*.so", "*.pyd")
    for name in PACKAGES:
        shutil.copytree(ROOT / name, copy / name, ignore=leave)
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, copy / name)
    return copy


def requirements(*, oldest: bool) -> list[str]:
    """What pyproject.toml demands of `NEEDED`, or the lowest of it."""
    asked = [text for text in declared() if re.split(r"[<>=]", text)[0] in NEEDED]
    return lowest(asked) if oldest else asked


def installed(python: Path, folder: Path, copy: Path, wanted: Iterable[str]) -> Path:
    """Python in an environment of its own, with truebreak and what the digest stands on."""
    subprocess.run([python, "-m", "venv", "--clear", folder], check=True)
    own = folder / "bin" / "python"
    subprocess.run([own, "-m", "pip", "install", "-q", *wanted, "gmpy2"], check=True)
    subprocess.run([own, "-m", "pip", "install", "-q", "--no-deps", copy], check=True)
    return own


def native(python: Path, label: str, seeds: Iterable[int]) -> Iterator[Way]:
    """Every way of one environment."""
    for pure, kind, seed in product(("", "1"), KINDS, seeds):
        setting = {"PYTHONHASHSEED": str(seed), "SYMPY_GROUND_TYPES": kind, "TRUEBREAK_PURE_PYTHON": pure}
        done = subprocess.run(
            [python, "-c", TOLD, *(["sympy"] if pure and seed in SYMPY_SEEDS else [])],
            env={**os.environ, **setting},
            cwd=python.parent,
            capture_output=True,
            text=True,
            check=False,
        )
        yield Way.of(f"{label}, {'pure' if pure else 'compiled'}, {kind}, seed {seed}", done)


def wasm(folder: Path, seeds: Iterable[int]) -> Iterator[Way]:
    """Every way in WebAssembly; none where Pyodide, or what it needs, is not to be had."""
    wheels = folder / "wheels"
    if shutil.which("node") is None or shutil.which("npm") is None:
        return
    folder.mkdir(parents=True, exist_ok=True)
    shutil.rmtree(wheels, ignore_errors=True)
    load = ["npm", "install", "--silent", "--no-audit", "--no-fund", "--no-package-lock", "--prefix", folder, PYODIDE]
    get = [sys.executable, "-m", "pip", "download", "-q", "--no-deps", "--only-binary=:all:", "-d", wheels]
    others = [text for text in requirements(oldest=False) if not text.startswith("python-flint")]
    if any(subprocess.run(c, check=False).returncode for c in (load, [*get, *WASM, "python-flint"], [*get, *others])):
        return
    with zipfile.ZipFile(wheels / "truebreak.zip", "w") as archive:
        for name in PACKAGES:
            for path in sorted((ROOT / name).rglob("*.py")):
                place = path.relative_to(ROOT)
                archive.write(path, place if name == "truebreak" else Path("truebreak", place))
    for kind, seed in product(("python", "flint"), seeds):
        setting = {"PYTHONHASHSEED": str(seed), "SYMPY_GROUND_TYPES": kind}
        code = f"import sys; sys.argv = {['', 'sympy'] if seed in SYMPY_SEEDS else ['']}\n{TOLD}"
        command = ["node", ROOT / "tests" / "same_bytes.mjs", folder, json.dumps(setting), code]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        yield Way.of(f"WebAssembly, pure, {kind}, seed {seed}", done)


def ways(folder: Path, seeds: Iterable[int], only: str) -> Iterator[Way]:
    """All of them, or those of one kind: `wasm`, `lowest`, or a version of Python."""
    if only in ("", "wasm"):
        yield from wasm(folder / "wasm", seeds)
    found = pythons()
    if only != "wasm":
        copy = sources(folder)
    for version, python in found.items():
        if only in ("", version):
            own = installed(python, folder / version, copy, requirements(oldest=False))
            yield from native(own, f"Python {version}", seeds)
    if only in ("", "lowest"):
        own = installed(next(iter(found.values())), folder / "lowest", copy, requirements(oldest=True))
        yield from native(own, "lowest versions", seeds)


def main(folder: str, only: str = "", count: str = str(len(SEEDS))) -> int:
    """The command line: `FOLDER [wasm|lowest|3.12] [SEEDS]`."""
    told: dict[str, int] = {}
    for way in ways(Path(folder).resolve(), range(int(count)), only):
        for digest in way.digests or ("FAILED",):
            told[digest] = told.get(digest, 0) + 1
        print(f"{' '.join(text[:16] for text in way.digests) or 'FAILED'}  {way.label}: {way.found}", flush=True)
    for digest, number in told.items():
        print(f"{digest}: in {number} way{'' if number == 1 else 's'}")
    scenes = {digest.partition("  ")[2] for digest in told}
    if not told:
        print("there is no such way here")
        return 77
    return 0 if len(told) == len(scenes) and "FAILED" not in told else 1


if __name__ == "__main__":
    if len(sys.argv) < 2 or sys.argv[1].startswith("-"):
        sys.exit("usage: python tests/same_bytes.py FOLDER [wasm|lowest|3.12] [SEEDS]")
    sys.exit(main(*sys.argv[1:]))
