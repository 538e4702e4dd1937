"""Ends a run that takes too long, through its progress callback."""

from __future__ import annotations

import time as clock
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..scenarios.trajectory import OnProgress, Progress


class OutOfTime(Exception):
    """A run went past its deadline."""


def limited(progress: OnProgress | None, seconds: float) -> OnProgress:
    """A callback that raises `OutOfTime` once that many seconds have gone by, and hands progress on until
    then.

    Engines call it between events, several times a second, so a run ends soon after its deadline.
    """
    deadline = clock.monotonic() + seconds

    def checked(state: Progress) -> None:
        if clock.monotonic() > deadline:
            raise OutOfTime
        if progress is not None:
            progress(state)

    return checked
