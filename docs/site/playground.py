"""The page to play with as part of the site: `python docs/site/playground.py FOLDER [--serve [PORT] [--open]]`.

Python for WebAssembly and python-flint come from the npm and Python registries, by their clients, and each file is
checked by its digest: they are neither in the repository nor in the wheel. Where they cannot be fetched, the site is
built without the page, and says so.
"""

from __future__ import annotations

import argparse
import ast
import bz2
import hashlib
import io
import json
import shutil
import subprocess
import sys
import tarfile
import tempfile
import webbrowser
import zipfile
from collections.abc import Iterable, Mapping
from contextlib import suppress
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import ClassVar

from truebreak.compare.play.page_files import page_files

ROOT = Path(__file__).resolve().parent.parent.parent

PYODIDE = "pyodide@314.0.7"
FLINT = "python-flint==0.9.0"
PLATFORM = ("--python-version", "3.14", "--implementation", "cp", "--abi", "cp314")
PLATFORM += ("--platform", "pyemscripten_2026_0_wasm32")

WHEEL = "python_flint-0.9.0-cp314-cp314-pyemscripten_2026_0_wasm32.whl"

DIGESTS = {
    "pyodide.asm.mjs": "f7cdc8ece80678ceb712f8e65ebe6d3a83203a180c399865f49612a051693635",
    "pyodide.asm.wasm": "cc36e3cab04fdfc9a63ff13eb52eae2b911bf46c025cc7b281f394bd3de1d5e6",
    "pyodide.mjs": "6f1d60f7bf529beb300f0f47983c921d3982363640ba20af0e38efdddbc66109",
    "pyodide-lock.json": "5dc2fc119108bc148c7457dc86e7675b5c87e1cafd420b9c34c1eaef7b36c010",
    "python_stdlib.zip": "fa1957e5777068fc4f7437f96d860ae2fbe9c19732ba06c84e004ec16dd7dd7a",
    WHEEL: "b31f5c00e0e36040ab58d00b3025156e20869b990d776e4bf90f870b1ee11ad3",
}
"""SHA-256 of each file that is fetched and handed on."""

PYTHON = tuple(name for name in DIGESTS if name != WHEEL)

PACKAGES = ("scenarios", "exact", "floating", "compare", "tools", "truebreak")
LEFT_OUT = (
    *("compare/cli", "compare/adapters", "compare/grids", "compare/testing", "compare/logdiff", "compare/shadowing"),
    *("compare/vectors", "compare/tolerances", "compare/chaos/certified_chaos.py", "compare/chaos/accuracy.py"),
    *("compare/files/codec.py", "compare/scene_argument.py", "compare/report/tables.py", "compare/report/floats.py"),
    *("compare/reduction", "compare/foreign/isolation.py", "compare/foreign/log_engine.py", "compare/files/cache.py"),
    *("compare/files/saved.py", "compare/saved_comparisons.py", "exact/literal", "exact/laws/derivation.py"),
    *(f"compare/report/{name}.py" for name in ("changes", "chaos_page", "desync_page", "documents", "grid_page")),
    *(f"compare/report/{name}.py" for name in ("grid_tables", "html", "orders_page", "page", "schema", "search_text")),
    *(f"compare/report/{name}.py" for name in ("speed_report", "survey_page")),
    *("compare/report/pictures", "compare/play/play_server.py", "compare/play/page_files.py", "tools/building.py"),
    *("compare/play/engine_process.py", "exact/digest.py", "floating/pymunk_engine.py", "floating/pymunk_run.py"),
    *("floating/pymunk_space.py", "floating/interval.py", "floating/single.py", "floating/rounded.py"),
    "floating/quad.py",
)
"""What no message of the page reaches; `tests/compare/play/test_in_browser.py` runs the catalogue without it."""

EPOCH = (1980, 1, 1, 0, 0, 0)
"""The time of what is in an archive: so the same sources are the same bytes."""


class NotToBeHad(Exception):
    """Something cannot be fetched, or is not what it should be."""


def parts(cache: Path) -> Path:
    """A folder with every file of `DIGESTS`, fetched unless it is there, and checked.

    Raises:
        NotToBeHad: saying what is missing, and why.
    """
    cache.mkdir(parents=True, exist_ok=True)
    if any(not (cache / name).is_file() or digest(cache / name) != told for name, told in DIGESTS.items()):
        with tempfile.TemporaryDirectory() as folder:
            _fetch(Path(folder))
            modules = Path(folder, "node_modules", "pyodide")
            for name, told in DIGESTS.items():
                found = Path(folder, name) if name == WHEEL else modules / name
                if not found.is_file():
                    raise NotToBeHad(f"{name} was not among what was fetched")
                if digest(found) != told:
                    raise NotToBeHad(f"{name} has another SHA-256 than it should: {digest(found)}")
                shutil.copy(found, cache / name)
    return cache


def _fetch(folder: Path) -> None:
    npm = shutil.which("npm")
    if npm is None:
        raise NotToBeHad("npm is not installed")
    load = [npm, "install", "--silent", "--no-audit", "--no-fund", "--no-package-lock", "--ignore-scripts"]
    get = [sys.executable, "-m", "pip", "download", "-q", "--no-deps", "--only-binary=:all:", *PLATFORM]
    for command in ([*load, "--prefix", str(folder), PYODIDE], [*get, "-d", str(folder), FLINT]):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise NotToBeHad(f"{command[-1]} cannot be fetched")


def digest(path: Path) -> str:
    """SHA-256 of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def archive(path: Path, files: Mapping[str, bytes]) -> None:
    """Writes files into a zip archive, the same bytes for the same files."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as made:
        for name in sorted(files):
            made.writestr(zipfile.ZipInfo(name, EPOCH), files[name], zipfile.ZIP_DEFLATED, 9)


def packed(path: Path, files: Mapping[str, bytes]) -> None:
    """Writes files into one compressed archive, a third smaller than each compressed by itself."""
    whole = io.BytesIO()
    with tarfile.open(fileobj=whole, mode="w", format=tarfile.USTAR_FORMAT) as made:
        for name in sorted(files):
            about = tarfile.TarInfo(name)
            about.size = len(files[name])
            made.addfile(about, io.BytesIO(files[name]))
    path.write_bytes(bz2.compress(whole.getvalue()))


def sources() -> dict[str, bytes]:
    """truebreak's own modules that a message of the page may reach."""
    found: dict[str, bytes] = {}
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*.py")):
            place = path.relative_to(ROOT).as_posix()
            if not any(place == out or place.startswith(f"{out}/") for out in LEFT_OUT):
                found[place if package == "truebreak" else f"truebreak/{place}"] = bare(path.read_text("utf-8"))
    return found


def _without_type(line: ast.stmt) -> ast.stmt:
    """A statement of a function without the type of what is set, which is never asked for."""
    if not isinstance(line, ast.AnnAssign) or line.value is None:
        return line
    return ast.Assign([line.target], line.value, lineno=line.lineno)


def _is_for_types(line: ast.stmt) -> bool:
    """Whether a statement is only for what checks types: never true as a module runs."""
    return isinstance(line, ast.If) and ast.unparse(line.test) == "TYPE_CHECKING" and not line.orelse


def bare(source: str) -> bytes:
    """A module without comments, docstrings, types of functions and what is imported for types: half of its bytes.

    >>> bare('def f():\\n    "What it does."\\n    return 1  # one').decode()
    'def f():\\n    return 1'
    """
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, ast.arg):
            node.annotation = None
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            node.returns = None
        body = getattr(node, "body", None)
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef) and isinstance(
            body, list
        ):
            kept = [line for line in body if not (isinstance(line, ast.Expr) and isinstance(line.value, ast.Constant))]
            kept = [line for line in kept if not _is_for_types(line)]
            node.body = kept or [ast.Pass()]
    for node in (
        node for function in ast.walk(tree) if isinstance(function, ast.FunctionDef) for node in ast.walk(function)
    ):
        for name in () if isinstance(node, ast.ClassDef) else ("body", "orelse"):
            body = getattr(node, name, None)
            if isinstance(body, list):
                setattr(node, name, [_without_type(line) for line in body])
    return ast.unparse(tree).encode()


NUMBERS = ("arb", "arb_mat", "ctx", "fmpq", "fmpq_poly", "fmpz")
"""What truebreak's modules take from python-flint."""


def trimmed(wheel: Path) -> dict[str, bytes]:
    """What of python-flint runs: no tests, no sources in Cython; of its kinds of numbers only `NUMBERS` are loaded at
    once, with what they import themselves, which halves the time that loading takes. The others are there."""
    with zipfile.ZipFile(wheel) as whole:
        names: Iterable[str] = whole.namelist()
        out = (".pyx", ".pxd", ".pyi", ".c")
        found = {name: whole.read(name) for name in names if "/test/" not in name and not name.endswith(out)}
    found["flint/__init__.py"] = fewer_imports(found["flint/__init__.py"].decode(), NUMBERS)
    return found


def fewer_imports(source: str, kept: Iterable[str]) -> bytes:
    """A module that hands names on from others of its package, with the names that are kept alone.

    >>> fewer_imports("from .a import b\\nfrom .c import d, e\\n__version__ = '1'\\n__all__ = ['b', 'd', 'e']", ["d"])
    b"from .c import d\\n__version__ = '1'"
    """
    tree, kept = ast.parse(source), set(kept)
    for node in tree.body:
        if isinstance(node, ast.ImportFrom):
            node.names = [name for name in node.names if name.name in kept]
    is_list = [isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__" for node in tree.body]
    rows = zip(tree.body, is_list, strict=True)
    tree.body = [node for node, out in rows if not out and not (isinstance(node, ast.ImportFrom) and not node.names)]
    return ast.unparse(tree).encode()


def write_playground(folder: Path, cache: Path) -> dict[str, int]:
    """Writes the page and its engines into a folder; the bytes of each file, as they are stored.

    Raises:
        NotToBeHad: where the engines' parts cannot be fetched; then nothing is written.
    """
    have = parts(cache)
    folder.mkdir(parents=True, exist_ok=True)
    for path, file in page_files("worker").items():
        place = folder / (path.removeprefix("/") or "index.html")
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_bytes(file.content)
    for name in PYTHON:
        shutil.copy(have / name, folder / name)
    archive(folder / "flint.zip", trimmed(have / WHEEL))
    packed(folder / "truebreak.tar.bz2", sources())
    names = sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())
    told = hashlib.sha256("".join(digest(folder / name) for name in names).encode()).hexdigest()
    keep = json.dumps(
        {"digest": told[:16], "files": ["./", *(n for n in names if n not in ("offline.js", "index.html"))]}
    )
    offline = folder / "offline.js"
    offline.write_text(offline.read_text("utf-8").replace('"@@KEPT@@"', json.dumps(keep)), "utf-8")
    return {name: (folder / name).stat().st_size for name in names}


class _Quiet(SimpleHTTPRequestHandler):
    """The files of a folder; nothing is logged."""

    extensions_map: ClassVar = {
        **SimpleHTTPRequestHandler.extensions_map,
        ".mjs": "text/javascript",
        ".wasm": "application/wasm",
    }

    def log_message(self, format: str, *args: object) -> None:
        """Nothing."""


def served(folder: Path, port: int = 0) -> ThreadingHTTPServer:
    """A server of a folder, on this computer alone."""
    return ThreadingHTTPServer(("127.0.0.1", port), partial(_Quiet, directory=str(folder)))


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--serve", type=int, nargs="?", const=0, metavar="PORT", help="serve it, and print its address")
    parser.add_argument("--open", action="store_true", help="open it in a browser")
    asked = parser.parse_args()
    try:
        sizes = write_playground(asked.folder, ROOT / "build" / "play-parts")
    except NotToBeHad as error:
        print(f"no page to play with: {error}", file=sys.stderr)
        return 77
    print(f"{len(sizes)} files, {sum(sizes.values()) / 1e6:.1f} MB in {asked.folder}")
    if asked.serve is not None:
        with served(asked.folder, asked.serve) as server:
            print(f"http://127.0.0.1:{server.server_port}/ (Ctrl-C ends it)", flush=True)
            if asked.open:
                webbrowser.open(f"http://127.0.0.1:{server.server_port}/")
            with suppress(KeyboardInterrupt):
                server.serve_forever()
    return 0


if __name__ == "__main__":
    sys.exit(main())
