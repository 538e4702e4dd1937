"""What a run shows at the decision in question."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from ....exact.numbers import ball
from ..diagnosis import Experiment

if TYPE_CHECKING:
    from ..decision.decision import DecidingNumber, Pairing
    from ..decision.reader import RunReader
    from ..diagnosis import CauseName
    from .laboratory import Laboratory

SMALLER = 200
"""Halvings by which a displacement is made small, so that the exact run on it stays in the same history."""


def shown(
    lab: Laboratory, cause: CauseName, decision: DecidingNumber, truth: RunReader, reader: RunReader, what: str
) -> Experiment:
    """What a run shows at a decision, beside the run of which the true answer is read."""
    if not all(reader.follows(p) for p in decision.pairings):
        return Experiment(cause, f"{what} leaves the history before that, among what leads to the contact", None, True)
    value = reader.value(decision)
    if value is None:
        first = first_of(decision, truth)
        if first is not None and reader.hit_time(first) is not None:
            return Experiment(cause, f"{what} has only that of the two meetings which comes first", None, False)
        return Experiment(cause, f"{what} does not have both meetings", None, True)
    moved = lab.moved(value, truth.value(decision))
    flips = lab.changes(value)
    return Experiment(cause, f"{what} {verb(moved, flips)}", moved, flips)


def first_of(decision: DecidingNumber, truth: RunReader) -> Pairing | None:
    """Which of two meetings comes first in the exact motion; None where one is in question, or both come at once."""
    value = truth.value(decision)
    sign = None if value is None or decision.second is None else ball.sign_of(value)
    return decision.first if sign == 1 else decision.second if sign == -1 else None


def to_first_order(told: Experiment, moved: float | None) -> Experiment:
    """With the displacement to the first order, where the run itself does not come to the contact."""
    if moved is None:
        return told
    return replace(
        told, displacement=moved, result=f"{told.result}; to the first order it moves the decision by {abs(moved):.3g}"
    )


def verb(moved: float | None, flips: bool) -> str:
    """What a displacement does, in words."""
    by = "decides otherwise" if moved is None else f"moves the decision by {abs(moved):.3g}"
    return f"{by}, which {'changes it' if flips else 'does not change it'}"
