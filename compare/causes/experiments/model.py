"""Another law: what is left where nothing else suffices."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..diagnosis import CauseName, Experiment

if TYPE_CHECKING:
    from ..laboratory.laboratory import Laboratory
    from ..so_far import SoFar

CAUSE = CauseName["MODEL"]


def model(lab: Laboratory, found: SoFar) -> list[Experiment]:
    """The engine's law, where all else was tried."""
    needed = (CauseName["STEP"], CauseName["INPUT"])
    if found.enough:
        return [Experiment(CAUSE, "not tried: something else suffices")]
    if found.cut or any(row.suffices is None and row.cause in needed for row in found.rows):
        return [Experiment(CAUSE, "not tried: what else there could be was not all tried")]
    moved = lab.moved(lab.got, lab.margin)
    return [Experiment(CAUSE, "no rounding, no step and no tie explains it: its law differs", moved, True)]
