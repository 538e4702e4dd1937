"""The last rung: nested square roots and more bits in turns, and in the end the user's own word."""

from __future__ import annotations

from flint import arb

from ...scenarios.trajectory import TieProof
from ...scenarios.work import Work
from ..numbers import ball
from ..numbers.undecided import Undecided
from ..predicates.question import Decision, Question
from ..replay.steps import step_units
from .enclosures import InBalls, InField
from .grounds import Grounds
from .nested_roots import NestedRoots

TRY_BITS = 1024
"""Below this precision, more bits are cheaper than any attempt to prove a zero in nested roots."""

FIRST_SHARE = 100_000
"""Work that the first attempt in nested roots may take: a tenth of a second, about what shallow proofs need."""

SHARE_GROWTH = 4
"""By how much each further attempt may take more. Between two of them the bits are doubled, so that neither a number
that more bits tell from zero nor one that nested roots prove zero waits long for the other's attempts."""


class RootsAndBits:
    """Proofs of zero in nested roots, and more bits, in turns, within counted work."""

    def __init__(self, grounds: Grounds) -> None:
        self._grounds = grounds
        self._roots = NestedRoots(grounds.scene)
        self._quick = (InBalls(grounds), InField(grounds))

    def __call__(self, question: Question) -> Decision:
        """The sign.

        Raises:
            Undecided: naming the question, what was tried and the bits.
        """
        grounds, state, rule = self._grounds, self._grounds.state, self._grounds.rule
        work = Work(grounds.work)
        share, told = FIRST_SHARE, ""
        while True:
            rising = self._rise_units(2 * state.bits)
            agreed = rule.bits is not None and self._agreed_bits(question) >= rule.bits
            last = agreed or 2 * state.bits > grounds.max_bits or work.spent + rising > grounds.work
            if last or state.bits >= TRY_BITS:
                left = grounds.work - work.spent
                attempt = Work(left if last else min(share, left // 2))
                sign, told = self._roots.sign(question, grounds.steps, attempt)
                work.spent += attempt.spent
                grounds.spend(attempt.spent)
                if sign is not None:
                    return Decision(sign, "tower", TieProof.TOWER)
                share *= SHARE_GROWTH
            if last:
                break
            work.spent += rising
            grounds.rise("undecided")
            for rung in self._quick:
                decision = rung(question)
                if decision is not None:
                    return decision
        if agreed:
            return Decision(0, "assumed", TieProof.ASSUMED, rule.bits)
        raise Undecided(
            f"{question.describe(grounds.name)} is not proved, {grounds.where()}, with {state.bits} bits"
            + (f"; {told}" if told else "")
            + f"; {work.spent} units of work of {grounds.work} (--work)"
        )

    def _rise_units(self, bits: int) -> int:
        """The work of computing the whole log again in balls of so many bits."""
        return len(self._grounds.steps) * step_units(bits)

    def _agreed_bits(self, question: Question) -> int:
        """To how many bits, in absolute value, the number asked about agrees with zero."""
        state = self._grounds.state
        ball.use_bits(state.bits)
        state.sync(question.bodies)
        size = question.value(state.balls).abs_upper()
        return 0 if not size.is_finite() else max(0, -int(size.log().__truediv__(arb(2).log()).upper().ceil().fmpz()))
