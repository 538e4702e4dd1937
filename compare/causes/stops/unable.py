"""A scene that an engine refuses, or of which it declares that it does not follow one of its keys."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..diagnosis import CauseName, Experiment

if TYPE_CHECKING:
    from .stopped import Stopped


def unable(stopped: Stopped, rows: list[Experiment]) -> list[Experiment]:
    """What the engine said."""
    if not stopped.candidate.unable:
        return []
    return [Experiment(CauseName["UNABLE"], stopped.message, None, True, 1.0)]
