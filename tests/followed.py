"""Through how many modules does a reader follow one event, or one verdict? Those whose functions run, in Python alone.

`python tests/followed.py` prints them for one event of the exact engine, `python tests/followed.py verdict` for a
comparison: of `gas:n=3`, one event. The scene is made before, and what is loaded is loaded before: module and class
bodies do not count, nor do the methods that `dataclass` writes, which nobody reads.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from inspect import CO_OPTIMIZED
from types import FrameType
from typing import Any


def modules_run(work: Callable[[], object]) -> list[str]:
    """The modules of this project, by their names below `truebreak`, of which a function runs meanwhile."""
    found: set[str] = set()

    def note(frame: FrameType, event: str, argument: object) -> None:
        name = frame.f_globals.get("__name__", "")
        code = frame.f_code
        written = code.co_flags & CO_OPTIMIZED and code.co_filename != "<string>"
        if event == "call" and written and name.startswith("truebreak."):
            found.add(name.removeprefix("truebreak."))

    saved = sys.getprofile()
    sys.setprofile(note)
    try:
        work()
    finally:
        sys.setprofile(saved)
    return sorted(found)


def event() -> list[str]:
    """Of one event of the exact engine, its time read as a double."""
    import truebreak as tb
    from truebreak.exact import ExactEngine

    scene: Any = tb.scene("gas:n=3")
    return modules_run(lambda: float(ExactEngine().run(scene, events=1).events[0].time))


def verdict() -> list[str]:
    """Of one comparison with doubles."""
    import truebreak as tb
    from truebreak.compare.comparison import compare

    scene: Any = tb.scene("gas:n=3")
    return modules_run(lambda: compare(scene, ["double"], events=1))


def followed(what: str) -> list[str]:
    """The same, in a process of its own, where nothing is compiled and nothing has run before."""
    done = subprocess.run(
        [sys.executable, __file__, what],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "TRUEBREAK_PURE_PYTHON": "1"},
    )
    return done.stdout.split()


if __name__ == "__main__":
    print(*(verdict() if sys.argv[1:] == ["verdict"] else event()), sep="\n")
