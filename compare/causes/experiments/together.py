"""Input and arithmetic rounding together, where neither suffices alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..diagnosis import CauseName, Experiment

if TYPE_CHECKING:
    from ..laboratory.laboratory import Laboratory
    from ..so_far import SoFar


def together(lab: Laboratory, found: SoFar) -> list[Experiment]:
    """Both, where each was measured: what the engine itself shows."""
    if not found.neither:
        return []
    told = "neither suffices alone; both together do"
    return [Experiment(CauseName["TOGETHER"], told, lab.moved(lab.got, lab.margin), True, 1.0)]
