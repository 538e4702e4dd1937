"""All runs in Python alone, to the same end."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from truebreak.exact.compiled import PURE


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
