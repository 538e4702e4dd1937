"""The cascade: a question climbs from balls through the scene's field and proofs of zero to more bits, until one tells.

Every question climbs only as far as it must. What a rung decides is certain; what none decides is Undecided.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from importlib import import_module

from ..predicates.question import Decision, Question
from .grounds import Grounds

Rung = Callable[[Question], Decision | None]
"""The decision of a question, or None where it is left to the next rung."""

RUNGS: tuple[str, ...] = (
    "enclosures:InBalls",
    "enclosures:InField",
    "proofs:ByWayBack",
    "proofs:ByForm",
    "refinement:RootsAndBits",
)
"""From the cheapest up, by module and class: each class makes a rung for one run. A new one is its file, and one line
here."""

QUICK = RUNGS.index("enclosures:InField") + 1
"""How many of them cost next to nothing: those up to the field."""


def rung_maker(text: str) -> Callable[[Grounds], Rung]:
    """What makes a rung of the table for a run, imported now."""
    module, _, name = text.partition(":")
    return getattr(import_module(f".{module}", __package__), name)


class Cascade:
    """Decides the questions of one run.

    Args:
        grounds: what is known of the run.
        plan: counts, by rung, what was decided.
    """

    def __init__(self, grounds: Grounds, plan: Counter[str]) -> None:
        self._rungs = [rung_maker(text)(grounds) for text in RUNGS]
        self._plan = plan

    def decide(self, question: Question) -> Decision:
        """The sign of a question, and how it is known.

        Raises:
            Undecided: naming the question, what was tried and the bits.
        """
        decision = self._climb(question, self._rungs)
        assert decision is not None  # the last rung decides or raises
        return decision

    def decide_quickly(self, question: Question) -> Decision | None:
        """The sign if balls at hand or the field tell it, else None."""
        return self._climb(question, self._rungs[:QUICK])

    def _climb(self, question: Question, rungs: list[Rung]) -> Decision | None:
        for rung in rungs:
            decision = rung(question)
            if decision is not None:
                self._plan[decision.rung] += 1
                return decision
        return None
