"""A budget of steps, events, work or seconds."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..diagnosis import CauseName, Experiment

if TYPE_CHECKING:
    from .stopped import Stopped


def budget(stopped: Stopped, rows: list[Experiment]) -> list[Experiment]:
    """What the engine said, where it was no decision that stopped it."""
    if stopped.undecided or stopped.candidate.unable:
        return []
    return [Experiment(CauseName["BUDGET"], stopped.message, None, True, 1.0)]
