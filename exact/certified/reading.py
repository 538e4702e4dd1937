"""What the history keeps of a certified run: exact numbers where they are at hand, else short balls."""

from __future__ import annotations

from collections.abc import Hashable, Sequence

from flint import arb

from ...scenarios.numbers.quantity import Quantity
from ..numbers import ball
from ..numbers.field import Known, field_text
from ..predicates.hits import Moment
from ..replay.body import Body
from ..replay.contact import Entry
from ..replay.refinable import RefinableState
from .meetings import CertifiedMeetings
from .precision import rough
from .prediction import QUICK_BITS


class CertifiedReading:
    """Reads a state off.

    Args:
        state: that state.
        meetings: knows the times of entries.
    """

    def __init__(self, state: RefinableState, meetings: CertifiedMeetings) -> None:
        self._state = state
        self._meetings = meetings

    def knot(self, body: Body[arb]) -> tuple[Known, Known, Known, Known, Known]:
        """The state: exact numbers if the body is exact, else short balls."""
        exact = self._state.exact[body.index]
        x, y, vx, vy, t = self._state.flight(body.index)[:5] if exact else body.q
        return t, x, y, vx, vy

    def now(self, body: Body[arb]) -> Known:
        """The instant of a body's last contact: exact if the body is, else a short ball."""
        if self._state.exact[body.index]:
            return self._state.flight(body.index).t
        ball.use_bits(QUICK_BITS)
        return +body.flight.instant

    def entry_time(self, link: Entry) -> arb:
        """The time of an entry as a short ball."""
        time = self._meetings.time(Moment(link))
        with ball.precision(QUICK_BITS):
            return +time

    def reversal_time(self) -> Known:
        """The time of the reversal: exact if it is at hand exactly, else a ball."""
        state = self._state.field
        if state is not None and all(self._state.exact):
            return state.flip_time
        return self._state.flip_time

    def exact_state(self, bodies: Sequence[int]) -> Hashable | None:
        """The bodies' numbers as text, where all are exact."""
        state = self._state.field
        if state is None or not self._state.all_exact(tuple(bodies)):
            return None
        return tuple(field_text(number) for i in bodies for number in state.bodies[i].flight[:5])

    def rough(self, time: Known) -> float:
        """The double below a time."""
        return rough(time)

    def limit_bounds(self, time: Quantity | None) -> tuple[float, float]:
        """Doubles that enclose a set time (None: the return)."""
        ball.use_bits(self._state.bits)
        if time is None:
            return ball.double_bounds(self._state.flip_time + self._state.flip_time)
        return ball.double_bounds(ball.constant(time))

    def note(self) -> str:
        """The precision at work."""
        return f"{self._state.bits} bits"
