"""A law that is not kept: what the audit of the engine's own steps says, before any experiment."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..diagnosis import CauseName, Experiment

if TYPE_CHECKING:
    from ..laboratory.laboratory import Laboratory
    from ..so_far import SoFar

CAUSE = CauseName["LAW"]


def law(lab: Laboratory, found: SoFar) -> list[Experiment]:
    """Whether a step that misses a law comes before the divergence: then no rounding has to be looked for."""
    laws = lab.candidate.laws
    if laws is None or laws.kept is None:
        return [Experiment(CAUSE, "not determined" if laws is None else f"not determined: {laws.reason}")]
    if laws.kept:
        return [Experiment(CAUSE, f"every step keeps it: {laws.steps}", None, False)]
    first, parted = laws.first, lab.divergence
    latest = max(time for time in (parted.time, parted.expected_time, parted.got_time) if time is not None)
    if first is not None and first.time > latest:
        return [Experiment(CAUSE, f"only later, from t = {first.time:.9g} on", None, False)]
    return [Experiment(CAUSE, laws.finding, None, True)]
