"""Tells when a run in finite precision goes round without end while its clock stands still.

Where a wait is shorter than the last bit of the clock no time passes; and circles that rounding has put into each other
may then push each other on and on.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf

from ...exact.numbers.undecided import BudgetSpent

RETURNS = 100
"""How often all circles must come back to the same flights: what comes back once may yet leave, by what it met last."""

MOST = 1_000_000
"""Events at one time, whatever the circles do."""


class StandingClock:
    """Looks at a run as it goes on.

    >>> clock = StandingClock()
    >>> for events in range(1000):
    ...     clock.look(events, 4.0, lambda: [events % 2])
    Traceback (most recent call last):
        ...
    truebreak.exact.numbers.undecided.BudgetSpent: rounds without end: 541 events at time 4, and the same flights again
    """

    def __init__(self) -> None:
        self._time = -inf
        self._first = 0
        self._kept: Sequence[object] | None = None
        self._at = 0
        self._returns = 0
        self._seen = 0

    def look(self, events: int, time: float, flights: Callable[[], Sequence[object]]) -> None:
        """Notes where the run is.

        The flights are held against those at the last power of two of the events at this time: whatever the period, one
        of these is long enough (Brent).

        Args:
            events: how many there have been; no more since the last look, as where two only grazed, tell nothing.
            time: of the last of them.
            flights: of all circles.

        Raises:
            BudgetSpent: if no time passes any more.
        """
        if events == self._seen:
            return
        self._seen = events
        if time > self._time:
            self._time, self._first, self._kept, self._at = time, events, None, 1
            return
        stood = events - self._first
        if stood >= MOST:
            raise BudgetSpent(f"rounds without end: {stood:,} events at time {time:g}")
        if self._kept is not None and flights() == self._kept:
            self._returns += 1
            if self._returns == RETURNS:
                raise BudgetSpent(f"rounds without end: {stood:,} events at time {time:g}, and the same flights again")
        elif stood >= 2 * self._at:
            self._kept, self._at, self._returns = flights(), stood, 0
