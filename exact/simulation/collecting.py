"""Python's collector of cyclic garbage looks seldom while a run goes on, which makes tuples by the thousand, no cycles.

It looks through what is new each time that 700 more objects have been made than freed, and through all that there is
whenever a quarter has been added: among 1,000 discs, a tenth to a third of the exact engine's time. What keeps itself
alive is found all the same, `SELDOM` objects later at most; all else goes when nobody holds it, as ever. What a run has
made and is still held at its end counts as old from then on, as it would once the collector had been through it.
"""

from __future__ import annotations

import gc
from threading import Lock
from types import TracebackType

SELDOM = 100_000
"""Objects more made than freed, between two looks: some ten megabytes. An event makes about ten that last."""


class SeldomCollected:
    """While it is entered, by any number of runs in any number of threads, collections are seldom.

    A collector that is switched off, or that somebody has told to look still less often, stays as it is.

    >>> before = gc.get_threshold()
    >>> with SELDOM_COLLECTED:
    ...     gc.get_threshold()[0] >= SELDOM
    True
    >>> gc.get_threshold() == before
    True
    """

    def __init__(self) -> None:
        self._lock = Lock()
        self._entered = 0
        self._before = (0, 0, 0)

    def __enter__(self) -> None:
        with self._lock:
            self._entered += 1
            if self._entered == 1:
                self._before = gc.get_threshold()
                if 0 < self._before[0] < SELDOM:
                    gc.set_threshold(SELDOM, *self._before[1:])

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, traceback: TracebackType | None, /
    ) -> None:
        with self._lock:
            self._entered -= 1
            if not self._entered:
                if not gc.get_freeze_count():
                    gc.freeze()
                    gc.unfreeze()  # all is old now
                gc.set_threshold(*self._before)


SELDOM_COLLECTED = SeldomCollected()
"""What every run enters."""
