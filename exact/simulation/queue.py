"""The queue of predicted arrivals: earliest lower bound first, stale ones dropped when they come up."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from heapq import heappop, heappush
from math import inf
from typing import Generic, NamedTuple, Protocol

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


_new = tuple.__new__
"""Makes a named tuple of all its fields: what its own constructor does, in a third of the time."""


class Crossings(Protocol):
    """What may make new arrivals of flights that stay as they are."""

    @property
    def next_crossing(self) -> float:
        """When that comes next; infinite if never."""
        ...

    def cross(self, since: float, until: float) -> None:
        """Queues what it makes up to a time, where what happens next may come as early as `since`."""
        ...


class NoCrossings:
    """Every arrival is queued as its flights begin."""

    next_crossing = inf

    def cross(self, since: float, until: float) -> None:
        """Nothing."""


class ArrivalQueue(Generic[N]):
    """The arrivals of a run.

    Args:
        bodies: the circles, whose serial numbers tell which arrivals are stale.

    Attributes:
        crossings: what comes before an arrival is taken off.
    """

    def __init__(self, bodies: Mapping[int, Body[N]]) -> None:
        self._bodies = bodies
        self._heap: list[Arrival[N]] = []
        self._order = 0
        self.crossings: Crossings = NoCrossings()

    def push(self, low: float, high: float, time: N | None, link: Link, graze: bool = False) -> None:
        """Queues an arrival that is certain, predicted from the flights as they are."""
        self._push(low, high, True, time, link, graze)

    def push_pairs(self, a: Body[N], found: Iterable[tuple[float, float, Body[N]]], standing: Collection[Link]) -> None:
        """Queues arrivals of a at other circles, as `push` does each: bounds of the time, and the circle."""
        heap, index, serial, until, order = self._heap, a.index, a.serial, a.until, self._order
        for low, high, b in found:
            if low > until or low > b.until:
                continue
            other = b.index
            if index < other:
                link, serials = _new(Pair, (index, other)), (serial, b.serial)
            else:
                link, serials = _new(Pair, (other, index)), (b.serial, serial)
            if link not in standing:
                order += 1
                heappush(heap, _new(Arrival, (low, order, high, True, None, link, serials, False)))
        self._order = order

    def push_walls(self, a: Body[N], found: Sequence[tuple[float, float, int]], standing: Collection[Link]) -> None:
        """Queues arrivals of a at walls, the earliest first, until one of them ends its flight."""
        if len(found) > 1:
            found = sorted(found)
        for low, high, wall in found:
            if low > a.until:
                return
            link = _new(AtWall, (a.index, wall, "wall"))
            if link not in standing:
                a.until = min(a.until, high)
                self._order += 1
                serials = (a.serial,)
                heappush(self._heap, _new(Arrival, (low, self._order, high, True, None, link, serials, False)))

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

    def alone(self, before: float) -> Arrival[N] | None:
        """Takes off the next arrival if it is certain to come, before a time, and nothing else may come with it.

        None where that is not plain at a glance: then all is as it was, or nearer to it.
        """
        heap, bodies, crossings = self._heap, self._bodies, self.crossings
        while heap:
            first = heap[0]
            low, _, high, certain, _, link, serials, graze = first
            if bodies[link[0]].serial != serials[0] or (len(serials) > 1 and bodies[link[1]].serial != serials[1]):
                heappop(heap)
                continue
            if graze or not certain or not high < before:
                return None
            crossing = crossings.next_crossing
            if crossing < low:
                crossings.cross(crossing, crossing)
                continue
            if crossing <= high:
                return None
            heappop(heap)
            while heap and heap[0].low <= high:
                if self.fresh(heap[0]):
                    heappush(heap, first)
                    return None
                heappop(heap)
            return first
        return None

    def rivals(self) -> list[Arrival[N]]:
        """Takes off every arrival that may be the first; with it come all that may fall on the same instant.

        An arrival is left where it is if its lower bound lies above the least upper bound of those taken.
        """
        heap, crossings = self._heap, self.crossings
        while True:
            self._drop_stale()
            crossing = crossings.next_crossing
            if crossing < inf and (not heap or heap[0].low > crossing):
                crossings.cross(crossing, crossing)
                continue
            found = self._rivals()
            if crossing == inf or crossing > min(arrival.high for arrival in found):
                return found
            since = found[0].low
            if crossing > since and not any(arrival.certain for arrival in found):
                return found
            for arrival in found:
                heappush(heap, arrival)
            crossings.cross(since, crossing)

    def _drop_stale(self) -> None:
        heap = self._heap
        while heap and not self.fresh(heap[0]):
            heappop(heap)

    def _rivals(self) -> list[Arrival[N]]:
        heap = self._heap
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
