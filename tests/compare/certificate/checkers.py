"""Both checkers, put to certificates, and certificates put to both."""

from __future__ import annotations

import atexit
import json
import shutil
import subprocess
import sys
from collections.abc import Iterable
from functools import cache
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest

from truebreak.compare.certificate import certificate_json
from truebreak.tools.verify import verdict

TOOLS = Path(__file__).resolve().parents[3] / "tools"
NODE = shutil.which("node")

needs_node = pytest.mark.skipif(NODE is None, reason="node is not at hand")


def by_python(path: Path) -> tuple[int, str]:
    """The first checker's verdict, in this process."""
    return verdict(path)


def by_program(path: Path) -> tuple[int, str]:
    """The first checker's verdict, as a program of its own."""
    done = subprocess.run(
        [sys.executable, "-I", str(TOOLS / "verify.py"), str(path)], capture_output=True, text=True, check=False
    )
    assert done.stderr == ""
    return done.returncode, done.stdout.strip()


def started_node(paths: Iterable[Path]) -> subprocess.Popen[str]:
    """The second checker, at work on files."""
    assert NODE is not None
    command = [NODE, str(TOOLS / "verify.mjs"), *map(str, paths)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def node_verdicts(process: subprocess.Popen[str], count: int) -> list[tuple[int, str]]:
    """What it said of so many."""
    out, errors = process.communicate()
    assert errors == ""
    return _verdicts(out.splitlines(), count)


def _verdicts(lines: list[str], count: int) -> list[tuple[int, str]]:
    """The exit code of each line, which says it in words."""
    assert len(lines) == count, lines
    codes = {"verified": 0, "refuted": 1, "no certificate": 2, "not decided": 4, "declined": 4}
    return [(codes[line.partition(":")[0]], line) for line in lines]


SERVED = Path(__file__).parent / "served.mjs"


@cache
def _serving() -> subprocess.Popen[str]:
    """A process that runs the second checker, or one like it, as often as it is asked to; it ends with this one."""
    assert NODE is not None
    process = subprocess.Popen([NODE, str(SERVED)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    atexit.register(process.communicate)
    return process


def printed_by(program: Path, files: Iterable[Path]) -> tuple[int, list[str]]:
    """The exit code of a checker for node, and its lines."""
    process = _serving()
    assert process.stdin is not None and process.stdout is not None
    process.stdin.write(f"{json.dumps([str(program), *map(str, files)])}\n")
    process.stdin.flush()
    code, lines = json.loads(process.stdout.readline())
    return code, lines


def by_node(paths: Iterable[Path]) -> list[tuple[int, str]]:
    """The second checker's verdicts."""
    files = list(paths)
    return _verdicts(printed_by(TOOLS / "verify.mjs", files)[1], len(files))


def both_verify(certificates: Iterable[tuple[str, dict[str, Any]]], folder: Path) -> None:
    """Asserts that both checkers verify certificates."""
    paths = []
    for name, told in certificates:
        path = folder / f"{name.replace(':', '-').replace('/', '_')}.json"
        path.write_text(certificate_json(told), encoding="utf-8")
        code, sentence = by_python(path)
        assert code == 0, f"{name}: {sentence}"
        paths.append(path)
    if NODE is not None and paths:
        for path, (code, sentence) in zip(paths, by_node(paths), strict=True):
            assert code == 0, f"{path.stem}: {sentence}"


Lot = list[tuple[str, bool]]
"""Certificates as texts, and of each whether it is true."""


def lot_of(
    true: Iterable[dict[str, Any]], false: Iterable[dict[str, Any]] = (), refused: tuple[int, ...] = (1,)
) -> Lot:
    """Such a lot, of which the first checker says what is so: of what is false one of the codes `refused`."""
    lot = [(certificate_json(told), True) for told in true] + [(certificate_json(told), False) for told in false]
    with TemporaryDirectory() as folder:
        path = Path(folder) / "told.json"
        for text, is_true in lot:
            path.write_text(text, encoding="utf-8")
            code, sentence = by_python(path)
            assert code in ((0,) if is_true else refused), sentence
    return sorted(lot, key=lambda told: len(told[0]))  # a short one takes less time to be mistaken


def mistaken(first: Any, second: Path, lot: Lot, folder: Path, times: int = 1) -> None:
    """Asserts that a faulty checker, and its like for node, mistake so many: they are asked until they have."""

    def written(number: int, text: str) -> Path:
        path = folder / f"{number}.json"
        path.write_text(text, encoding="utf-8")
        return path

    texts = enumerate(lot)
    ours = (t for k, (t, is_true) in texts if (first.verdict(written(k, t))[0] == 0) is not is_true)
    assert len(list(islice(ours, times))) == times
    texts = enumerate(lot)
    theirs = (
        t for k, (t, is_true) in texts
        if printed_by(second, [written(k, t)])[1][0].startswith("verified") is not is_true
    )  # fmt: skip
    assert len(list(islice(theirs, times))) == times
