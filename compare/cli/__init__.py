"""The command line: `truebreak scenes | show | run | compare | orders | chaos | sweep | bench`."""

from __future__ import annotations

import atexit
import gc
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["main"]

RARELY = 50_000
"""Objects made, less those gone, after which garbage is looked for: more than a short command makes in all, and of what
a program imports none is garbage."""


def main(arguments: list[str] | None = None) -> None:
    """Runs the command line and exits with its code: `entry.main`, which is imported here."""
    with _rarely_collecting():
        from .entry import main as run

        run(arguments)


@contextmanager
def _rarely_collecting() -> Iterator[None]:
    """Looks for garbage seldom, and not at all once the program ends: a tenth of a short command."""
    atexit.register(gc.freeze)
    before = gc.get_threshold()
    gc.set_threshold(RARELY, *before[1:])
    try:
        yield
    finally:
        gc.set_threshold(*before)
