"""The first rungs: signs from balls at hand, and in the field of the scene."""

from __future__ import annotations

from flint import fmpq

from ...scenarios.numbers.tower_element import sign_of_root_sum
from ...scenarios.trajectory import TieProof
from ..numbers import ball
from ..numbers.field import LeavesField, field_sign
from ..predicates.question import Decision, Question
from ..replay.refinable import RefinableState
from .grounds import Grounds


class InBalls:
    """Signs from the state in balls, at its precision."""

    def __init__(self, grounds: Grounds) -> None:
        self._state = grounds.state

    def __call__(self, question: Question) -> Decision | None:
        """The sign if the ball of the number tells it."""
        bodies = question.bodies
        sign = self.sign(question)
        if sign is None:
            return None
        if sign == 0 and self._state.all_exact(bodies):
            return Decision(0, "full ball", _kind(self._state, bodies))
        return Decision(sign, "full ball")

    def sign(self, question: Question) -> int | None:
        """As the rung, the sign alone."""
        ball.use_bits(self._state.bits)
        self._state.sync(question.bodies)
        try:
            return ball.sign_of(question.value(self._state.balls))
        except ZeroDivisionError:
            return None


class InField:
    """Signs in the scene's field, where all bodies concerned are exact."""

    def __init__(self, grounds: Grounds) -> None:
        self._state = grounds.state

    def __call__(self, question: Question) -> Decision | None:
        """The sign, but where the number leaves the field."""
        state, bodies = self._state, question.bodies
        if not state.all_exact(bodies):
            return None
        assert state.field is not None
        try:
            parts = question.sum_of_roots(state.field)
        except LeavesField:
            return None
        if parts[2] == 0 and parts[4] == 0:
            sign = field_sign(parts[0])
        else:
            sign = sign_of_root_sum(*(state.numbers.element(part) for part in parts))
        return Decision(sign, "field", _kind(state, bodies) if sign == 0 else TieProof.CONSTRUCTION)


def _kind(state: RefinableState, bodies: tuple[int, ...]) -> TieProof:
    """In what numbers exact bodies stand."""
    rational = all(isinstance(number, fmpq) for i in bodies for number in state.flight(i)[:5])
    return TieProof.RATIONAL if rational else TieProof.FIELD
