"""Executors by name: where the jobs of a sweep go instead of to worker processes of its own."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from ...scenarios.errors import SceneError

if TYPE_CHECKING:
    from concurrent.futures import Executor

ADDRESS = re.compile(r"dask://(?P<host>[^/\s:]+|\[[0-9a-fA-F:]+\]):(?P<port>\d{1,5})")

PATIENCE = 10
"""Seconds in which a scheduler answers, or there is none."""


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
