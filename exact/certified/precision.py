"""When the state is computed again with more bits, and with how many."""

from __future__ import annotations

from flint import arb

from ..numbers import ball
from ..numbers.field import Known, field_ball
from ..numbers.undecided import Undecided
from ..replay.refinable import RefinableState
from ..simulation.history import History
from ..simulation.limits import Limits
from .prediction import QUICK_BITS

FIRST_BITS = 256
"""Precision of the state at first: four words, twice the quick one, so the first rise comes late."""

SAFE_BITS = 96
"""When the times' accuracy falls below this, precision rises at once: predictions would soon be undecided, and
results should round to doubles without another look."""

FORESIGHT = 1.1
"""Share by which the bits foreseen for a whole run exceed the extrapolation, so that one rise mostly suffices."""

SET_FORESIGHT = 1.06
"""The same where deviations are kept in a set, whose rate varies less from one part of a run to another."""

ONCE = 40
"""Bits that a set loses once and for all: what a body's bound grows within a block beyond the set itself."""

LONG_BITS = 8_000
"""Precision from which on deviations are kept in a set: it then costs no more, as it needs well under half the bits."""

CENTRED_SHARE = 0.5
"""Share of the bits that balls need which then suffices; if it does not, one more rise comes."""

PILOTS = 10
"""By how much fewer bits deviations are first kept in a set, for a start that tells how fast bits go then: what is
carried out twice is a tenth of the run, with a tenth of the bits, and the rest needs no wide margin."""

MOST_FORESIGHT = 64
"""Most by which one rise multiplies the precision: an extrapolation from a short past may be far off. With 16, a gas of
10,000 or 100,000 events rose once more, late, and was carried out nearly twice."""


class Precision:
    """The bits of a run.

    Args:
        state: what is computed again.
        history: how far the run is; counts the rises.
        limits: where it ends; tells how many bits the whole run will need.
        max_bits: the precision beyond which there is none.
    """

    def __init__(self, state: RefinableState, history: History[Known], limits: Limits, max_bits: int) -> None:
        self._state = state
        self._history = history
        self._limits = limits
        self._max_bits = max_bits

    def secure(self) -> None:
        """More bits, if the last instant is not accurate enough.

        Raises:
            Undecided: if there are none.
        """
        while self._state.lowest < SAFE_BITS:
            self._rise("accuracy had run low", self._foreseen())

    def rise(self, why: str) -> None:
        """Twice the bits.

        Raises:
            Undecided: if there are none, with the reason for which they were wanted.
        """
        self._rise(why, 0)

    def where(self) -> str:
        """How far the run is, as a person reads it."""
        return f"after {len(self._history.records)} instants"

    def _rise(self, why: str, foreseen: int) -> None:
        near = foreseen > 0 and self._state.centred  # the rate has settled: no need to double
        least = self._state.bits * 5 // 4 if near else 2 * self._state.bits
        bits = max(least, min(foreseen, self._max_bits))
        if bits > self._max_bits:
            raise Undecided(
                f"{why} at {self._state.bits} bits, and max_bits is {self._max_bits}; "
                f"{self.where()}; allow more bits to go on"
            )
        self._history.plan["precision raised"] += 1
        centred = self._state.centred or bits >= LONG_BITS
        if centred and not self._state.centred:
            bits = max(2 * self._state.bits, int(CENTRED_SHARE * bits) // PILOTS)
        self._history.rises.append((bits, centred))
        self._state.rise(bits, centred)

    def _foreseen(self) -> int:
        """The bits that the whole run will need if it goes on losing them as it has."""
        done = len(self._history.records)
        wholes: list[float] = []
        if self._limits.events is not None:
            wholes.append(self._limits.events)
        if self._limits.until is not None and done:
            reached = rough(self._history.records[-1].mark.time)
            if reached > 0.0:
                wholes.append(done * ball.double_bounds(ball.constant(self._limits.until))[1] / reached)
        if not wholes or not done:
            return 0
        once = ONCE if self._state.centred else 0
        lost = max(self._state.bits - self._state.lowest - once, 1)
        share = SET_FORESIGHT if self._state.centred else FORESIGHT
        whole = min(wholes) / done * lost * share + once + 2 * SAFE_BITS
        return int(min(whole, MOST_FORESIGHT * self._state.bits))  # also where times are beyond doubles


def rough(time: Known) -> float:
    """The double below a time, a ball or exact."""
    return ball.double_bounds(time if isinstance(time, arb) else field_ball(time, QUICK_BITS))[0]
