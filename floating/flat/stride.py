"""Many instants in one go: each of one plain contact alone, with all that follows from it."""

from __future__ import annotations

from heapq import heappop, heappush

from .flights import FlatFlights
from .history import FlatHistory
from .inlined import rebound, strike
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
        f, records, alone, crowd = self._flights, self._history.records, self._meetings.alone, self._meetings.crowd
        heap, flights, serial, last, n = f.heap, f.flights, f.serial, f.last, f.n
        f.take_up()
        shifted, ahead = f.shifted, f.ahead
        done = 0
        while done < most and heap:
            entry = heappop(heap)
            time, _, i, j, si, sj, wait, _ = entry
            if serial[i] != si or serial[j] != sj:
                continue
            while heap and heap[0][0] <= time and (serial[heap[0][2]] != heap[0][4] or serial[heap[0][3]] != heap[0][5]):
                heappop(heap)
            if crowd is not None and crowd.next_crossing <= time:
                heappush(heap, entry)
                crowd.cross(crowd.next_crossing, crowd.next_crossing)
                continue
            tied = heap and heap[0][0] <= time
            if wait is None or tied or not time < before or (shifted and (i in shifted or j in shifted)):
                heappush(heap, entry)
                break
            if j >= n:
                rebound(f, i, j, time, wait)
                records.append((time, flights[i], None, j))  # type: ignore[arg-type]
                ahead.add(i)
            elif last[i] < last[j]:
                heappush(heap, entry)
                break
            else:
                strike(f, i, j, time, wait)
                if i > j:
                    i, j = j, i
                records.append((time, flights[i], flights[j], j))  # type: ignore[arg-type]
                ahead.update((i, j))
            alone(i, j)
            done += 1
        return done
