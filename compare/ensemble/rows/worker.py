"""What a worker of a sweep does. This module imports nothing heavy: its first words come before numpy is loaded."""

from __future__ import annotations

import os
import threading
import time as clock
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .row import SweepJob

THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")


def prepare() -> None:
    """Makes a fresh worker count in one thread, and end with the process that started it."""
    for name in THREADS:
        os.environ[name] = "1"
    import multiprocessing
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()


def _end_with(sentinel: int) -> None:
    from multiprocessing.connection import wait

    wait([sentinel])
    os._exit(1)


ONE_AT_A_TIME = threading.Lock()
"""Exact runs in threads of one process take turns: a job's seconds are its own where nothing else goes on meanwhile."""


def carry_out(job: SweepJob) -> tuple[list[dict[str, Any]], float]:
    """The rows of a job, and the seconds that it took."""
    from .row import rows_of

    with ONE_AT_A_TIME:
        began = clock.perf_counter()
        rows = rows_of(job)
        return rows, clock.perf_counter() - began
