"""The queue of a flat run, as the general loop sees it: entries become arrivals when it takes them off."""

from __future__ import annotations

from heapq import heappop, heappush
from math import inf

from ...exact.replay.contact import AtWall, Link
from ...exact.simulation.arrivals.queue import Arrival, ArrivalQueue
from .flights import FlatFlights, Queued


class FlatQueue(ArrivalQueue[float]):
    """See `ArrivalQueue`; what a sign in doubles says of an arrival is certain.

    Args:
        flights: whose heap it is.
    """

    def __init__(self, flights: FlatFlights) -> None:
        super().__init__({})
        self._flights = flights

    def _push(self, low: float, high: float, certain: bool, time: float | None, link: Link, graze: bool) -> None:
        """See `ArrivalQueue`; what comes here is no plain hit."""
        f = self._flights
        i, j = f.places(link)
        if low > f.until[i] or low > f.until[j]:
            return
        if high < f.until[i] and isinstance(link, AtWall):
            f.until[i] = high
        heappush(f.heap, (low, f.tick(), i, j, f.serial[i], f.serial[j], None, graze))

    def put_back(self, arrival: Arrival[float]) -> None:
        """Queues an arrival again."""
        i, j = self._flights.places(arrival.link)
        si, sj = arrival.serials
        heappush(self._flights.heap, (arrival.low, arrival.order, i, j, si, sj, None, arrival.graze))

    def clear(self) -> None:
        """Drops everything."""
        self._flights.heap.clear()

    def fresh(self, arrival: Arrival[float]) -> bool:
        """Whether the flights that an arrival was predicted from still hold."""
        serial = self._flights.serial
        i, j = self._flights.places(arrival.link)
        return (serial[i], serial[j]) == arrival.serials

    def grazes(self) -> list[Arrival[float]]:
        """Every graze that is queued."""
        return [self._arrival(entry) for entry in self._flights.heap if entry[-1]]

    def rivals(self) -> list[Arrival[float]]:
        """See `ArrivalQueue`: all that fall on the earliest time."""
        heap, crossings = self._flights.heap, self.crossings
        while True:
            self._drop_stale()
            first = heap[0][0] if heap else inf
            crossing = crossings.next_crossing
            if crossing == inf or crossing > first:
                break
            crossings.cross()
        found: list[Arrival[float]] = []
        while heap and (not found or heap[0][0] <= first):
            found.append(self._arrival(heappop(heap)))
            self._drop_stale()
        return found

    def _drop_stale(self) -> None:
        heap, stale = self._flights.heap, self._flights.stale
        while heap and stale(heap[0]):
            heappop(heap)

    def _arrival(self, entry: Queued) -> Arrival[float]:
        time, order, i, j, si, sj, _, graze = entry
        serials = (si, sj) if j >= self._flights.n or i < j else (sj, si)
        return Arrival(time, order, time, True, time, self._flights.link(i, j), serials, graze)
