"""A law that is not kept: what the audit of the engine's own steps says, before any experiment."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...validation import falls
from ..diagnosis import CauseName, Experiment

if TYPE_CHECKING:
    from ..laboratory.laboratory import Laboratory
    from ..so_far import SoFar

CAUSE = CauseName["LAW"]


def law(lab: Laboratory, found: SoFar) -> list[Experiment]:
    """A row where a step misses a law before the divergence: then no rounding has to be looked for."""
    laws, parted = lab.candidate.laws, lab.divergence
    if laws is None or laws.kept is not False:
        return []
    latest = max(time for time in (parted.time, parted.expected_time, parted.got_time) if time is not None)
    if laws.first is not None and falls(laws.first.time, latest, lab.engine.bits):
        return []
    return [Experiment(CAUSE, laws.finding, None, True)]
