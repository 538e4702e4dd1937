"""The log of a finished run, from which every number of it is computed again."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol

from ...scenarios.numbers.tower_element import Element
from ...scenarios.numbers.tower_ring import TowerLimit
from ...scenarios.scene import Scene
from ...scenarios.work import Work
from ..numbers import ball
from ..numbers.nested import Nested
from ..numbers.system import N, number_system
from ..replay.centred.centred_state import CentredState
from ..replay.state import State, replay
from ..replay.steps import Step, causal_past, step_units

if TYPE_CHECKING:
    from ..numbers.expression import Expression

TEXT_DEPTH = 5
"""Nested roots up to which a value is written out in full; beyond, it is given by shared definitions."""

TEXT_WORK = 1_000_000
"""Units of work that writing out one value may take: about a second."""


class Formula(Protocol):
    """Computes a number from a state, in its numbers."""

    def __call__(self, state: State[N], /) -> N: ...


class RunLog:
    """A scene and the log of its run: enough to compute every number of the run again.

    Attributes:
        scene: the scene.
        steps: the log.
        lost: how many bits of its precision the run lost, at most, in the time of an event.
        centred: whether that was with the deviations in a set (see `CentredState`).
    """

    def __init__(self, scene: Scene, steps: Sequence[Step], lost: int, centred: bool = False) -> None:
        self.scene = scene
        self.steps = steps
        self.lost = lost
        self.centred = centred
        self._key: tuple[int, int] | None = None
        self._state: CentredState | None = None
        self._too_deep: list[frozenset[int]] = []

    def __getstate__(self) -> dict[str, Any]:
        """All but what is computed again at need."""
        return {**self.__dict__, "_key": None, "_state": None, "_too_deep": []}

    def in_balls(self, bits: int, upto: int) -> CentredState:
        """The state after the first `upto` steps, in balls computed with `bits` bits."""
        if self._key != (bits, upto):
            ball.use_bits(bits)
            state = CentredState(self.scene, self.centred)
            replay(state, self.steps, range(upto))
            self._key, self._state = (bits, upto), state
        assert self._state is not None
        return self._state

    def units(self, bits: int, upto: int) -> int:
        """The work of that."""
        return (len(self.scene.circles) + upto) * step_units(bits)

    def exact(self, upto: int, bodies: Sequence[int], formula: Formula) -> Element | None:
        """A number after the first `upto` steps in nested roots, or None if it is too deep.

        A value whose causal past contains one that was too deep is not tried.
        """
        steps = self.steps[:upto]
        needed, held = causal_past(steps, bodies)
        past = frozenset(needed)
        if any(deep <= past for deep in self._too_deep):
            return None
        numbers = Nested(TEXT_DEPTH, Work(TEXT_WORK))
        try:
            state = State(self.scene, numbers, only=held)
            replay(state, steps, needed)
            return formula(state)
        except TowerLimit:
            self._too_deep.append(past)
            return None

    def in_expressions(self, upto: int, bodies: Sequence[int]) -> State[Expression]:
        """The states of some bodies after the first `upto` steps, as SymPy expressions that share their parts."""
        needed, held = causal_past(self.steps[:upto], bodies)
        state: State[Expression] = State(self.scene, number_system("expression"), only=held)
        replay(state, self.steps, needed)
        return state
