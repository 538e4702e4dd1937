"""The cascade: a question climbs from balls through the scene's field and proofs of zero to more bits, until one tells.

Every question climbs only as far as it must. What a rung decides is certain; what none decides is Undecided.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

from .enclosures import Balls, Field
from .grounds import Grounds
from .proofs import Symmetry, WayBack
from .question import Decision, Question
from .refinement import RootsAndBits

Rung = Callable[[Question], Decision | None]
"""The decision of a question, or None where it is left to the next rung."""

RUNGS: tuple[Callable[[Grounds], Rung], ...] = (Balls, Field, WayBack, Symmetry, RootsAndBits)
"""From the cheapest up: each makes a rung for one run."""

QUICK = 2
"""How many of them cost next to nothing."""


class Cascade:
    """Decides the questions of one run.

    Args:
        grounds: what is known of the run.
        plan: counts, by rung, what was decided.
    """

    def __init__(self, grounds: Grounds, plan: Counter[str]) -> None:
        self._rungs = [make(grounds) for make in RUNGS]
        self._plan = plan

    def decide(self, question: Question) -> Decision:
        """The sign of a question, and how it is known.

        Raises:
            Undecided: naming the question, what was tried and the bits.
        """
        for rung in self._rungs:
            decision = rung(question)
            if decision is not None:
                self._plan[decision.rung] += 1
                return decision
        raise AssertionError("the last rung decides or raises")

    def decide_quickly(self, question: Question) -> Decision | None:
        """The sign if balls at hand or the field tell it, else None."""
        for rung in self._rungs[:QUICK]:
            decision = rung(question)
            if decision is not None:
                self._plan[decision.rung] += 1
                return decision
        return None
