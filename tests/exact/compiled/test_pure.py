"""All runs in Python alone, to the same end."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from sysconfig import get_config_var, get_path

import pytest

from truebreak.exact.compiled import PURE

SOURCES = [
    path
    for folder in ("exact/compiled", "floating/flat")
    for path in sorted((Path(__file__).parents[3] / folder).glob("*.c"))
]
COMPILER = (get_config_var("CC") or "").split()[:1]


@pytest.mark.parametrize("scene", ["gas", "gas:n=70,seed=2", "rack:rows=4", "galperin:n=2"])
def test_python_alone_gives_the_same_history(scene: str) -> None:
    command = [sys.executable, "-P", "-m", "truebreak", "run", scene, "--events", "300", "--json"]
    others = {key: value for key, value in os.environ.items() if key != PURE}
    told = [
        subprocess.run(command, capture_output=True, text=True, check=True, env=environment).stdout
        for environment in (others, {**others, PURE: "1"})
    ]
    assert told[0] == told[1]
    assert len(told[0]) > 1_000


def test_nothing_compiled_is_loaded_where_python_is_wished_for() -> None:
    code = (
        "from sys import modules; import truebreak.exact.compiled; "
        "print([name for name in modules if '.compiled._' in name])"
    )
    done = subprocess.run(
        [sys.executable, "-P", "-c", code], capture_output=True, text=True, check=True, env={**os.environ, PURE: "1"}
    )
    assert done.stdout == "[]\n"


@pytest.mark.skipif(
    not COMPILER or shutil.which(COMPILER[0]) is None or not Path(get_path("include"), "Python.h").exists(),
    reason="there is no compiler here",
)
@pytest.mark.parametrize("source", SOURCES, ids=lambda path: path.name)
def test_a_compiler_that_may_alter_sums_is_refused(source: Path) -> None:
    """As with CFLAGS=-Ofast: then Python runs."""
    command = [*COMPILER, "-fsyntax-only", f"-I{get_path('include')}", str(source)]
    assert subprocess.run(command, capture_output=True, check=False).returncode == 0
    for option in ("-Ofast", "-ffast-math", "-funsafe-math-optimizations", "-ffinite-math-only"):
        done = subprocess.run([*command, option], capture_output=True, text=True, check=False)
        assert done.returncode != 0
        assert "the Python is used" in done.stderr
