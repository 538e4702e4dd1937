"""What the command line's exit code says."""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...scenarios.trajectory import Stop
    from ..comparison import Comparison


class ExitCode(IntEnum):
    """The codes; a shell reads 128 + n as ended by signal n."""

    DONE = 0
    DIVERGED = 1
    USAGE = 2
    INTERNAL = 3
    UNDECIDED = 4
    INTERRUPTED = 130
    PIPE_CLOSED = 141


DONE = ExitCode.DONE


def of_stop(stop: Stop) -> ExitCode:
    """The code of a single run: 4 where the engine could not go on, else 0."""
    from ...scenarios.trajectory import StopReason

    if stop.reason is StopReason.INTERRUPTED:
        return ExitCode.INTERRUPTED
    return ExitCode.UNDECIDED if stop.reason in (StopReason.UNDECIDED, StopReason.BUDGET) else ExitCode.DONE


def of_comparison(comparison: Comparison) -> ExitCode:
    """The code of a comparison.

    1 if any engine diverged, or does not keep the laws; else 4 if anything is not settled or undecided, else 0.
    """
    if any(candidate.lawless for candidate in comparison.candidates):
        return ExitCode.DIVERGED
    codes = {"agree": ExitCode.DONE, "diverged": ExitCode.DIVERGED}
    return codes.get(comparison.verdict, ExitCode.UNDECIDED)
