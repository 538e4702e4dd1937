"""The queue of predicted arrivals: earliest lower bound first, stale ones dropped when they come up."""

from __future__ import annotations

from collections.abc import Mapping
from heapq import heappop, heappush
from math import inf
from typing import Generic, NamedTuple

from ..numbers.system import N
from ..replay.body import Body
from ..replay.contact import AtWall, Link, Pair


class Arrival(NamedTuple, Generic[N]):
    """A predicted meeting: doubles that enclose its time, and what it rests on.

    Attributes:
        low, high: its time lies between them.
        order: its serial number, which breaks ties among equal bounds.
        certain: whether it comes if nothing else does first; if not, `low` bounds it from below, and `high` is
            infinite.
        time: its time, where that is at hand.
        link: the contact, or the entry of a centre into a pocket.
        serials: the serial numbers of the flights that it was predicted from.
        graze: whether the two touch then without approach.
    """

    low: float
    order: int
    high: float
    certain: bool
    time: N | None
    link: Link
    serials: tuple[int, ...]
    graze: bool = False


class ArrivalQueue(Generic[N]):
    """The arrivals of a run.

    Args:
        bodies: the circles, whose serial numbers tell which arrivals are stale.
    """

    def __init__(self, bodies: Mapping[int, Body[N]]) -> None:
        self._bodies = bodies
        self._heap: list[Arrival[N]] = []
        self._order = 0

    def push(self, low: float, high: float, time: N | None, link: Link, graze: bool = False) -> None:
        """Queues an arrival that is certain, predicted from the flights as they are."""
        self._push(low, high, True, time, link, graze)

    def push_doubtful(self, low: float, link: Link) -> None:
        """Queues one that may not come, and not before a time."""
        self._push(low, inf, False, None, link, False)

    def _push(self, low: float, high: float, certain: bool, time: N | None, link: Link, graze: bool) -> None:
        """Queues one, unless a wall ends the flight of one of the two before it can come."""
        a = self._bodies[link[0]]
        if low > a.until:
            return
        if isinstance(link, Pair):
            b = self._bodies[link.b]
            if low > b.until:
                return
            serials = (a.serial, b.serial)
        else:
            serials = (a.serial,)
            if high < a.until and isinstance(link, AtWall):
                a.until = high
        self._order += 1
        heappush(self._heap, Arrival(low, self._order, high, certain, time, link, serials, graze))

    def put_back(self, arrival: Arrival[N]) -> None:
        """Queues an arrival again."""
        heappush(self._heap, arrival)

    def clear(self) -> None:
        """Drops everything."""
        self._heap.clear()

    def fresh(self, arrival: Arrival[N]) -> bool:
        """Whether the flights that an arrival was predicted from still hold."""
        bodies, link, serials = self._bodies, arrival.link, arrival.serials
        if bodies[link[0]].serial != serials[0]:
            return False
        return len(serials) == 1 or bodies[link[1]].serial == serials[1]

    def grazes(self) -> list[Arrival[N]]:
        """Every graze that is queued."""
        return [arrival for arrival in self._heap if arrival.graze]

    def rivals(self) -> list[Arrival[N]]:
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
        bar = first.high
        while heap and heap[0].low <= bar:
            other = heappop(heap)
            if self.fresh(other):
                found.append(other)
                bar = min(bar, other.high)
        return found
