"""Progress of a run on stderr, if that is a terminal."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...scenarios.trajectory import OnProgress, Progress


@contextmanager
def showing_progress(title: str) -> Iterator[OnProgress | None]:
    """A line on stderr that follows a run; None, and no output, where stderr is not a terminal."""
    if not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.markup import escape

    console = Console(stderr=True)
    with console.status(escape(title)) as status:

        def show(progress: Progress) -> None:
            note = f", {progress.note}" if progress.note else ""
            status.update(escape(f"{title}: {progress.events} events, time {progress.time:.6g}{note}"))

        yield show
