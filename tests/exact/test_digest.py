"""The same bytes everywhere: the catalogue's histories are those of every way to run them."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from truebreak.exact.digest import history_lines, main, scene_digest
from truebreak.exact.exact_engine import ExactEngine
from truebreak.scenarios import catalogue


def told(*words: str, **environment: str) -> str:
    """What the command prints in a process of its own."""
    command = [sys.executable, "-m", "truebreak.exact.digest", *words]
    return subprocess.run(command, env={**os.environ, **environment}, capture_output=True, text=True, check=True).stdout


def test_the_digest_is_the_same_pure_and_compiled_and_under_every_seed_and_kind_of_number() -> None:
    first = told(PYTHONHASHSEED="0", TRUEBREAK_PURE_PYTHON="")
    assert first.split()[1] == str(len(catalogue.names()))
    assert told(PYTHONHASHSEED="1", TRUEBREAK_PURE_PYTHON="1", SYMPY_GROUND_TYPES="python") == first
    assert told(PYTHONHASHSEED="2", TRUEBREAK_PURE_PYTHON="", SYMPY_GROUND_TYPES="flint", LC_ALL="C") == first


def test_the_sympy_engines_digest_is_the_same_in_every_kind_of_number() -> None:
    """It counts in them, where the exact engine asks SymPy for nothing."""
    first = told("--sympy", "lee", "cross", PYTHONHASHSEED="0", SYMPY_GROUND_TYPES="python")
    assert told("--sympy", "lee", "cross", PYTHONHASHSEED="1", SYMPY_GROUND_TYPES="flint") == first


@pytest.mark.slow
@pytest.mark.parametrize("pure", ["", "1"])
@pytest.mark.parametrize("kind", ["python", "gmpy", "flint"])
@pytest.mark.parametrize("seed", range(5))
def test_the_digest_is_the_same_in_every_combination(seed: int, kind: str, pure: str) -> None:
    """Where gmpy2 is not installed, SymPy counts in Python's numbers."""
    assert told(PYTHONHASHSEED=str(seed), SYMPY_GROUND_TYPES=kind, TRUEBREAK_PURE_PYTHON=pure) == told()


def test_the_digest_tells_histories_apart(capsys: pytest.CaptureFixture[str]) -> None:
    """Another scene, another number of events, another last digit."""
    assert scene_digest("gas:n=3", 9) != scene_digest("gas:n=3,seed=2", 9)
    assert scene_digest("gas:n=3", 9) != scene_digest("gas:n=3", 8)
    assert scene_digest("near-tie:k=20") != scene_digest("near-tie:k=21")
    assert main(["lee", "cradle", "--each"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split("  ")[1] for line in lines] == ["lee: 1 events", "cradle: 60 events", "2 scenes, 61 events"]


def test_a_history_has_its_reversal_and_its_entries() -> None:
    scene = catalogue.build("rack:rows=2,pockets=yes").with_changes(reverse_after=2, until=None, events=None)
    lines = list(history_lines(ExactEngine().run(scene, events=6)))
    assert any(line.startswith("reversal after 2 at") for line in lines)
