"""The queue of predicted arrivals: earliest lower bound first, stale ones dropped when they come up."""

from __future__ import annotations

from collections.abc import Sequence
from heapq import heappop, heappush
from math import inf
from typing import NamedTuple

from ..numbers.system import Number
from ..replay.body import Body
from ..replay.steps import Link


class Arrival(NamedTuple):
    """A predicted meeting: doubles that enclose its time, and what it rests on.

    Attributes:
        low, high: its time lies between them.
        order: its serial number, which breaks ties among equal bounds.
        time: its time; None if it may not come at all (`low` then bounds it from below, `high` is infinite).
        link: the contact, or the entry of a centre into a pocket.
        serials: the serial numbers of the flights that it was predicted from.
        graze: whether the two touch then without approach.
    """

    low: float
    order: int
    high: float
    time: Number
    link: Link
    serials: tuple[int, int]
    graze: bool = False


class ArrivalQueue:
    """The arrivals of a run.

    Args:
        bodies: the circles, whose serial numbers tell which arrivals are stale.
    """

    def __init__(self, bodies: Sequence[Body]) -> None:
        self._bodies = bodies
        self._n = len(bodies)
        self._heap: list[Arrival] = []
        self._order = 0

    def push(self, low: float, high: float, time: Number, link: Link, graze: bool = False) -> None:
        """Queues an arrival predicted from the flights as they are."""
        i, j = link
        bodies = self._bodies
        serials = (bodies[i].serial, bodies[j].serial if 0 <= j < self._n else 0)
        self._order += 1
        heappush(self._heap, Arrival(low, self._order, high, time, link, serials, graze))

    def put_back(self, arrival: Arrival) -> None:
        """Queues an arrival again."""
        heappush(self._heap, arrival)

    def clear(self) -> None:
        """Drops everything."""
        self._heap.clear()

    def fresh(self, arrival: Arrival) -> bool:
        """Whether the flights that an arrival was predicted from still hold."""
        i, j = arrival.link
        bodies = self._bodies
        if bodies[i].serial != arrival.serials[0]:
            return False
        return not 0 <= j < self._n or bodies[j].serial == arrival.serials[1]

    def grazes(self) -> list[Arrival]:
        """Every graze that is queued."""
        return [arrival for arrival in self._heap if arrival.graze]

    def rivals(self) -> list[Arrival]:
        """Takes off every arrival that may be the first; with it come all that may fall on the same instant.

        An arrival is left where it is if its lower bound lies above the least upper bound of those taken.
        """
        heap = self._heap
        while heap and not self.fresh(heap[0]):
            heappop(heap)
        if not heap:
            return []
        first = heappop(heap)
        found = [first]
        bar = first.high if first.time is not None else inf
        while heap and heap[0].low <= bar:
            other = heappop(heap)
            if self.fresh(other):
                found.append(other)
                if other.time is not None and other.high < bar:
                    bar = other.high
        return found
