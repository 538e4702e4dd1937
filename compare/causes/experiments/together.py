"""Input and arithmetic rounding together, where neither suffices alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..diagnosis import CauseName, Experiment

if TYPE_CHECKING:
    from ..found import Found
    from ..laboratory.laboratory import Laboratory


def together(lab: Laboratory, found: Found) -> list[Experiment]:
    """Both, where each was measured: what the engine itself shows."""
    if not found.neither:
        return []
    told = "neither suffices alone; both together do"
    return [Experiment(CauseName["TOGETHER"], told, lab.moved(lab.got, lab.margin), True, 1.0)]
