"""Signs by replay of a causal past in nested square roots in normal form, within counted work."""

from __future__ import annotations

from collections.abc import Sequence

from ...scenarios.lazy import frozen
from ...scenarios.numbers.tower_element import sign_of_root_sum
from ...scenarios.numbers.tower_ring import TowerLimit
from ...scenarios.scene import Scene
from ...scenarios.work import Work
from ..numbers.nested import Nested
from ..predicates.question import Question
from ..replay.state import State, replay
from ..replay.steps import Step, causal_past

MAX_DEPTH = 7
"""Levels of nested roots that a proof may build: on a chain of collisions of short numbers six take a tenth of a
second and seven half of one; longer numbers take more, so the work is bounded too."""


@frozen
class Hopeless:
    """A past that could not be replayed, and the work that did not suffice; None: no work does, it is too deep."""

    past: frozenset[int]
    work: int | None


class NestedRoots:
    """Answers signs in nested square roots.

    Args:
        scene: the scene that runs.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._hopeless: list[Hopeless] = []

    def sign(self, question: Question, steps: Sequence[Step], work: Work) -> tuple[int | None, str]:
        """The sign of a question, or None and why it is not known.

        A past that holds one which was too deep is not tried, nor one that was too much work with no more than that.
        """
        work.spent += len(steps)  # the search for the past looks at each
        needed, bodies = causal_past(steps, question.bodies)
        past = frozenset(needed)
        allowed = 0 if work.limit is None else work.limit - work.spent
        for known in self._hopeless:
            if known.past <= past and (known.work is None or known.work >= allowed):
                return None, "its past holds one that was too deep for nested square roots"
        numbers = Nested(MAX_DEPTH, work)
        try:
            state = State(self.scene, numbers, only=bodies)
            replay(state, steps, needed)
            return sign_of_root_sum(*question.sum_of_roots(state)), ""
        except TowerLimit as limit:
            self._hopeless.append(Hopeless(past, allowed if work.is_spent else None))
            return None, f"nested square roots: {limit}"
