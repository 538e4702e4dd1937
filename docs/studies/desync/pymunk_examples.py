"""Pymunk's own examples, each recorded twice by `truebreak.pymunk.record` and compared: a table of docs/desync.md.

`python docs/studies/desync/pymunk_examples.py` prints it. Those that draw by pygame run on its dummy screen, without a
window (`pip install pygame-ce`), and their clock says that each frame took a 60th of a second.
"""

from __future__ import annotations

import importlib
import os
import random
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from pymunk import Space, examples

from truebreak.compare.logdiff.desync import diff
from truebreak.pymunk import record

STEPS = 400
"""Steps of each run."""

SECONDS = 120
"""Seconds after which an example that makes no steps is given up."""

THREADS = ("threaded_space 0", "threaded_space 1", "threaded_space 2")
"""The example that has no run of its own, with as many threads."""

WHY = {
    "basic_test": "its ball starts at a random place: Python's `random`, not seeded",
    "threaded_space 2": "two threads solve contacts in an order that is another each time",
}
"""Why two runs are not the same, where that is known."""


class Enough(BaseException):
    """An example has made its steps."""


def names() -> list[str]:
    """The examples that may step a space."""
    own = {path.stem for path in Path(examples.__path__[0]).glob("[a-z]*.py")} - {"threaded_space"}
    return [*sorted(own), *THREADS]


def logged(name: str, file: str, seed: int | None) -> None:
    """Runs an example, and logs the first space that it steps."""
    random.seed(seed)
    plain: Any = Space.step
    first: list[Any] = []
    count = 0

    def step(space: Space, dt: float) -> None:
        nonlocal count
        if not first:
            first.extend((space, record(space, file).__enter__()))
            space.step(dt)  # the recording's, which calls this again
            return
        if space is first[0]:
            if count == STEPS:
                raise Enough
            count += 1
        plain(space, dt)

    setattr(Space, "step", step)  # noqa: B010
    try:
        import pygame

        class Clock:
            """A clock that goes by frames."""

            def tick(self, *_: Any) -> int:
                return 16

            def get_fps(self) -> float:
                return 60.0

        setattr(pygame.time, "Clock", Clock)  # noqa: B010
    except ImportError:
        pass
    word, _, threads = name.partition(" ")
    try:
        module = importlib.import_module(f"pymunk.examples.{word}")
        if threads:
            module.PyramidDemo(int(threads)).step(STEPS + 1)
        elif hasattr(module, "main"):
            module.main()
    except Enough:
        pass
    finally:
        if first:
            first[1].__exit__(None, None, None)


def row(name: str, seed: int | None = None) -> str | None:
    """A row of the table; None for an example that steps no space here."""
    with tempfile.TemporaryDirectory() as folder:
        files = [str(Path(folder) / log) for log in ("a.jsonl", "b.jsonl")]
        for file in files:
            words = [sys.executable, __file__, "--log", name, file, "" if seed is None else str(seed)]
            silent = {**os.environ, "SDL_VIDEODRIVER": "dummy", "SDL_AUDIODRIVER": "dummy"}
            try:
                subprocess.run(
                    words, env=silent, capture_output=True, timeout=SECONDS, check=False, stdin=subprocess.DEVNULL
                )
            except subprocess.TimeoutExpired:
                return None
            if not Path(file).exists():
                return None
        found = diff(*files)
        steps = found.found.pairs
    why = "" if found.verdict.same or seed is not None else WHY.get(name, found.verdict.why)
    return f"| `{name}`{'' if seed is None else ', seeded'} | {steps} | {found.verdict.line} | {why} |"


def table() -> Iterator[str]:
    """The table, row by row; what is not the same is run again with a seed."""
    yield "| example | records compared | what came out | why |"
    yield "|---|---|---|---|"
    none: list[str] = []
    for name in names():
        told = row(name)
        if told is None:
            none.append(name)
            continue
        yield told
        if "identical" not in told and name not in THREADS:
            yield str(row(name, 1))
    yield f"\nWithout a row, as they step no space without a window or what they need is not here: {', '.join(none)}."


def main(words: Sequence[str]) -> None:
    """Prints the table; or, with `--log`, runs one example."""
    if words[:1] == ["--log"]:
        logged(words[1], words[2], int(words[3]) if words[3] else None)
        return
    for line in table():
        print(line, flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
