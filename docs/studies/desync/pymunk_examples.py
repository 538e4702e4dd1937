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

from truebreak.compare.logdiff.desync import Desync, diff
from truebreak.pymunk import record

STEPS = 400
"""Steps of each run."""

SECONDS = 120
"""Seconds after which an example that makes no steps is given up."""

THREADS = ("threaded_space 0", "threaded_space 1", "threaded_space 2")
"""The example that has no run of its own, with as many threads."""

TRIES = 5
"""Further pairs of runs of those that are not the same each time."""

WHY = {
    "index_video": "balls come by a timer, and that goes by the clock on the wall",
    "threaded_space 2": "two threads solve contacts in an order that is another most times; some pairs are identical",
}
"""Why two runs are not the same, where a seed does not make them so."""


class Enough(BaseException):
    """An example has made its steps."""


def names() -> list[str]:
    """The examples that may step a space."""
    own = {path.stem for path in Path(examples.__path__[0]).glob("[a-z]*.py")} - {"threaded_space"}
    return [*sorted(own), *THREADS]


def logged(name: str, file: str, seed: int | None) -> None:
    """Runs an example, and logs the first space that it steps."""
    random.seed(seed)
    sys.argv = [name, "/i"] if name == "newtons_cradle" else [name]  # a screen saver, which is told what it is
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
        import pygame  # pyright: ignore[reportMissingImports]

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


def compared(name: str, seed: int | None = None) -> Desync | None:
    """Two runs of an example, compared; None for an example that steps no space here."""
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
        return diff(*files)


def table() -> Iterator[str]:
    """The table, row by row; what is not the same is run again with a seed."""
    yield "| example | what came out | why |"
    yield "|---|---|---|"
    none: list[str] = []
    for name in names():
        found = compared(name)
        for _ in range(TRIES if name in WHY else 0):
            found = compared(name) if found is not None and found.verdict.same else found
        if found is None:
            none.append(name)
            continue
        why = ""
        if not found.verdict.same:
            again = compared(name, 1) if name not in WHY else None
            seeded = again is not None and again.verdict.same
            why = "Python's `random`, not seeded: with a seed it is identical" if seeded else WHY.get(name, "not known")
        yield f"| `{name}` | {found.verdict.line} | {why} |"
    others = ", ".join(f"`{name}`" for name in none)
    yield f"\nWithout a row, as they step no space, or none without a window: {others}."


def main(words: Sequence[str]) -> None:
    """Prints the table; or, with `--log`, runs one example."""
    if words[:1] == ["--log"]:
        logged(words[1], words[2], int(words[3]) if words[3] else None)
        return
    for line in table():
        print(line, flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
