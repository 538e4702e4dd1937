"""Circles that pass through each other within one time step."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ...deadline import NO_TIME
from ..decision.decisions import decisions
from ..diagnosis import CauseName, Experiment

if TYPE_CHECKING:
    from ..laboratory.laboratory import Laboratory
    from ..so_far import SoFar

CAUSE = CauseName["TUNNELLING"]


def tunnelling(lab: Laboratory, found: SoFar) -> list[Experiment]:
    """Whether a circle that should be met is passed through, for an engine that takes steps."""
    if lab.engine.step is None:
        return []
    return [lab.tried(lambda: _tunnelling(lab), Experiment(CAUSE, NO_TIME))]


def _tunnelling(lab: Laboratory) -> Experiment:
    """Whether the two overlap for less than a step, and between two of its instants."""
    step = lab.engine.step
    assert step is not None
    missed = [d for d in decisions(lab.reference, lab.candidate.trajectory, lab.candidate.alignment) if d.kind == "hit"]
    for decision in missed:
        if decision.first.partner != lab.divergence.expected:
            continue
        stay = lab.own.stay(decision.first)
        if stay is None or not math.isfinite(stay[1]):
            continue
        enter, leave = stay
        base = 0.0
        reversal = lab.candidate.trajectory.reversal
        if reversal is not None and lab.study.scene.reverse_at is not None and float(reversal.time) < enter:
            base = float(reversal.time)
        whole = math.floor((leave - base) / step) * step + base
        body, partner = decision.first.body, decision.first.partner
        told = f"{body} and {partner} overlap for {leave - enter:.3g}, a step takes {step:.3g}"
        if whole < enter:
            return Experiment(CAUSE, f"{told}, and none ends in between: they pass through each other", None, True, 1.0)
        return Experiment(CAUSE, told, None, False)
    return Experiment(CAUSE, "no circle that it should meet is passed through", None, False)
