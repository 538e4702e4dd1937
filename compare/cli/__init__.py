"""The command line: `truebreak scenes | show | run | compare | orders | chaos | sweep | bench`."""

from __future__ import annotations

import atexit
import gc

__all__ = ["main"]

RARELY = 50_000
"""Objects made, less those gone, after which garbage is looked for: more than a short command makes in all, and of what
a program imports none is garbage."""


def main(arguments: list[str] | None = None) -> None:
    """Runs the command line and exits with its code: `entry.main`, which is imported here.

    Without arguments, which are then those of the program, the program ends with it: garbage is looked for seldom, and
    not at all at the end, which is a tenth of a short command.
    """
    if arguments is None:
        atexit.register(gc.freeze)
        gc.set_threshold(RARELY, *gc.get_threshold()[1:])
    from .entry import main as run

    run(arguments)
