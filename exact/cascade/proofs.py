"""Proofs that a number is zero, or which of two came first, from the form of the log: rungs of the cascade."""

from __future__ import annotations

from ...scenarios.trajectory import TieProof
from ..predicates.question import Decision, Question
from ..symmetry.log_symmetry import LogSymmetry
from .grounds import Grounds


class ByWayBack:
    """What the way out of a reversed run tells of the way back."""

    def __init__(self, grounds: Grounds) -> None:
        self._retrace = grounds.retrace
        self._catch_up = grounds.catch_up

    def __call__(self, question: Question) -> Decision | None:
        """The sign, if the way out tells it."""
        self._catch_up()
        sign = self._retrace.sign(question)
        return None if sign is None else Decision(sign, "way back", TieProof.WAY_BACK)


class ByForm:
    """The form of the past: an isometry of logged histories."""

    def __init__(self, grounds: Grounds) -> None:
        self._log: LogSymmetry = grounds.log
        self._catch_up = grounds.catch_up

    def __call__(self, question: Question) -> Decision | None:
        """Zero, if an isometry makes it so."""
        self._catch_up()
        return Decision(0, "symmetry", TieProof.SYMMETRY) if self._log.proves_zero(question) else None
