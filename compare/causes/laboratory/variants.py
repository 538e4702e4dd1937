"""Whether a variant of an engine, finer or firmer, still leaves the history as it does."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...alignment.align import align
from ...alignment.divergence import Kind
from ...alignment.instants import NEARER, instants, velocity_difference

if TYPE_CHECKING:
    from ....scenarios.trajectory import Trajectory
    from ...alignment.align import Alignment
    from .laboratory import Laboratory


def gone(lab: Laboratory, run: Trajectory, step: float | None) -> bool:
    """Whether a variant does not have the divergence.

    Where velocities after one exact instant are in question, they must have come nearer by what a series demands.
    """
    alignment = align(lab.reference, run, span=lab.span, step=step, bits=lab.engine.bits)
    if lab.divergence.kind is Kind.TIE:
        own = _difference(lab, lab.candidate.trajectory, lab.candidate.alignment)
        nearer = _difference(lab, run, alignment)
        if own is not None:
            return nearer is not None and nearer <= own / NEARER
        return alignment.divergence is None or alignment.divergence.expected_event > lab.divergence.expected_event
    found = alignment.divergence
    if lab.divergence.kind is Kind.MISSING or lab.divergence.kind is Kind.DIFFERENT:
        walked = alignment.walks[lab.divergence.body]
        if lab.divergence.expected_event not in {m for m, _ in walked.pairs}:
            return False
    return found is None or found.event > lab.divergence.event


def _difference(lab: Laboratory, run: Trajectory, alignment: Alignment) -> float | None:
    """How far the velocities after the instant in question are from the exact ones; None if it is not one instant."""
    event = lab.divergence.expected_event
    for found in instants(alignment.walks):
        if event in found.mine:
            return velocity_difference(lab.reference, run, found) if len(found.mine) == 1 else None
    return None
