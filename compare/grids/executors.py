"""Where the jobs of a grid are carried out. It imports nothing heavy: a worker is prepared before numpy is loaded."""

from __future__ import annotations

import multiprocessing
import os
import re
import threading
import time as clock
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Protocol

from ...scenarios.errors import SceneError
from ..side_by_side import cores

if TYPE_CHECKING:
    from .row import Row

THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")

ADDRESS = re.compile(r"dask://(?P<host>[^/\s:]+|\[[0-9a-fA-F:]+\]):(?P<port>\d{1,5})")

PATIENCE = 10
"""Seconds in which a scheduler answers, or there is none."""


RARELY = 20_000
"""Objects made, less those gone, after which a worker looks for garbage, as the command line does."""


class Job(Protocol):
    """What is asked of one scene; small, and made of text, so that any worker can take it."""

    @property
    def label(self) -> str:
        """What progress calls it."""
        ...

    def rows(self) -> list[Row]:
        """The rows, the same on every machine. Bad input is a SceneError, and ends all."""
        ...


def prepare() -> None:
    """Makes a fresh worker count in one thread, look for garbage seldom, and end with the process that started it."""
    for name in THREADS:
        os.environ[name] = "1"
    import atexit
    import gc
    import signal

    gc.set_threshold(RARELY)
    atexit.register(gc.freeze)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()


def _end_with(sentinel: int) -> None:
    from multiprocessing.connection import wait

    wait([sentinel])
    os._exit(1)


ONE_AT_A_TIME = threading.Lock()
"""Exact runs in threads of one process take turns: balls have one precision for a process."""


def do(job: Job) -> tuple[list[Row], float]:
    """The rows of a job, and the seconds that it took."""
    with ONE_AT_A_TIME:
        began = clock.perf_counter()
        rows = job.rows()
        return rows, clock.perf_counter() - began


def pool(jobs: int | None = None) -> ProcessPoolExecutor:
    """Worker processes, started afresh: one for each processor unless another number is given."""
    if getattr(multiprocessing.current_process(), "_inheriting", False):
        raise SystemExit(1)  # a worker that runs the user's script once more: its parent says what to do
    spawn = multiprocessing.get_context("spawn")
    return ProcessPoolExecutor(cores() if jobs is None else jobs, mp_context=spawn, initializer=prepare)


def starts() -> bool:
    """Whether a worker process comes up at all."""
    with pool(1) as executor:
        return executor.submit(os.getpid).exception() is None


class Here(Executor):
    """Carries a job out in this process, when it is handed out."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """The result, or what was raised; an interruption is no result."""
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


@contextmanager
def executor_named(text: str) -> Iterator[tuple[Executor, int]]:
    """The executor of `dask://HOST:PORT`, and how many jobs it takes at once; the connection ends with the context.

    Raises:
        SceneError: for any other text, without the package `distributed`, and where no scheduler answers.

    >>> with executor_named("dask:/here"):
    ...     pass
    Traceback (most recent call last):
      ...
    truebreak.scenarios.errors.SceneError: --executor 'dask:/here': is not dask://HOST:PORT; write dask://10.0.0.7:8786
    """
    match = ADDRESS.fullmatch(text.strip())
    if match is None:
        raise SceneError(f"--executor {text!r}: is not dask://HOST:PORT; write dask://10.0.0.7:8786")
    try:
        from distributed import Client
    except ImportError:
        raise SceneError(f"--executor {text!r}: needs the package distributed; pip install '.[dask]'") from None
    try:
        client = Client(f"tcp://{match['host']}:{match['port']}", timeout=PATIENCE, set_as_default=False)
    except (OSError, TimeoutError) as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise SceneError(
            f"--executor {text!r}: no scheduler answers ({reason[:120]}); start one, or mind the port"
        ) from None
    try:
        threads: Any = client.nthreads()
        slots = sum(threads.values())
        if not slots:
            raise SceneError(
                f"--executor {text!r}: the scheduler has no workers yet; start some: dask worker HOST:PORT"
            )
        yield client.get_executor(pure=False), slots
    finally:
        client.close()
