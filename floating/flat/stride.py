"""Many instants in one go: each of one plain contact alone, with all that follows from it."""

from __future__ import annotations

from heapq import heappop, heappush
from math import inf

from .flights import FlatFlights
from .formulas.inlined import rebound, strike
from .history import FlatHistory
from .meetings import FlatMeetings


class FlatStride:
    """Carries out the ordinary instants of a run: one certain contact, no other at its time, nothing that touches.

    What it does is what the general loop would do, number for number; whatever is not ordinary is left where it is.

    Args:
        flights: the flights.
        history: takes the contacts up.
        meetings: makes the predictions.
    """

    def __init__(self, flights: FlatFlights, history: FlatHistory, meetings: FlatMeetings) -> None:
        self._flights = flights
        self._history = history
        self._meetings = meetings

    def __call__(self, most: float, before: float) -> int:
        """Carries out instants as long as they are ordinary; gives their number.

        Args:
            most: how many at most.
            before: a time that all come before.
        """
        f, crowd = self._flights, self._meetings.crowd
        alone = self._meetings.alone if crowd is None else crowd.alone
        records = self._history.items
        heap, flights, serial, last, n = f.heap, f.flights, f.serial, f.last, f.n
        f.take_up()
        shifted, ahead = f.shifted, f.ahead
        stale = f.stale
        done = 0
        while done < most and heap:
            first = heap[0]
            time, _, i, j, si, sj, wait, _ = first
            if serial[i] != si or serial[j] != sj:
                heappop(heap)
                continue
            if crowd is not None and time >= crowd.cells.next_crossing < inf:
                crowd.cross()
                continue
            if wait is None or not time < before or (shifted and (i in shifted or j in shifted)):
                break
            if j < n and last[i] < last[j]:
                break
            heappop(heap)
            while heap and heap[0][0] <= time and stale(heap[0]):
                heappop(heap)
            if heap and heap[0][0] <= time:
                heappush(heap, first)
                break
            if j >= n:
                rebound(f, i, j, time, wait)
                records.append((time, flights[i], None, j))
                ahead.add(i)
            else:
                strike(f, i, j, time, wait)
                if i > j:
                    i, j = j, i
                records.append((time, flights[i], flights[j], j))
                ahead.update((i, j))
            alone(i, j)
            done += 1
        return done
