"""A number that is proved to be exactly zero."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..decision.zeros import exact_zero
from ..diagnosis import CauseName, Experiment

if TYPE_CHECKING:
    from .stopped import Stopped


def zero(stopped: Stopped, rows: list[Experiment]) -> list[Experiment]:
    """Whether one of the numbers that lead to the event at which it stopped is zero."""
    found = exact_zero(stopped.reference, stopped.event) if stopped.widens else None
    if found is None:
        return []
    return [Experiment(CauseName["ZERO"], f"exactly zero: {found}; no enclosure can tell", None, True, 1.0)]
