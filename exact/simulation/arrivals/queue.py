"""The queue of predicted arrivals: earliest lower bound first, stale ones dropped when they come up."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from heapq import heappop, heappush
from math import inf
from typing import TYPE_CHECKING, Generic, NamedTuple, Protocol, TypeAlias

from ...compiled import Doubles, predictions
from ...numbers.system import N
from ...replay.body import Body
from ...replay.contact import AtWall, Entry, Link, Pair, Touch

if TYPE_CHECKING:
    from ...predicates.double_filter import FloatLine


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


class Outlook(NamedTuple, Generic[N]):
    """What one or two circles may meet.

    Attributes:
        others: for each, the circles to be looked at.
        lines: for each, its walls.
        reaches: for each, sums of radii by kind of radius.
        pairs: how many pairs of circles that is.
    """

    others: list[list[Body[N]]]
    lines: list[list[FloatLine]]
    reaches: list[list[float]]
    pairs: int


class Crossings(Protocol):
    """What may make new arrivals of flights that stay as they are, from certain times on."""

    @property
    def next_crossing(self) -> float:
        """The next such time; infinite if there is none."""
        ...

    @property
    def early(self) -> float:
        """How much before that time they may be made."""
        ...

    def cross(self, since: float = inf, /) -> None:
        """Queues what is due at that time.

        Args:
            since: where that is more than `early` before, the earliest time at which anything else may happen next.
        """
        ...


class NoCrossings:
    """Every arrival is queued as its flights begin."""

    next_crossing = early = inf

    def cross(self, since: float = inf, /) -> None:
        """Nothing."""


PlainArrival: TypeAlias = tuple[float, int, float, int, int, int, int]
"""An arrival that is certain and no graze, at another circle or at a wall, whose time is not at hand: its bounds with
its order between them, two circles, the lower index first, or a circle and ~k for wall k, and their serial numbers."""


class ArrivalQueue(Generic[N]):
    """The arrivals of a run.

    Args:
        bodies: the circles, whose serial numbers tell which arrivals are stale.

    Attributes:
        crossings: what comes before an arrival is taken off.
    """

    def __init__(self, bodies: Mapping[int, Body[N]]) -> None:
        self._bodies = bodies
        self._heap: list[PlainArrival | Arrival[N]] = []
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
            if standing and ((index, other) in standing or (other, index) in standing):
                continue
            order += 1
            if index < other:
                heappush(heap, (low, order, high, index, other, serial, b.serial))
            else:
                heappush(heap, (low, order, high, other, index, b.serial, serial))
        self._order = order

    def push_walls(self, a: Body[N], found: Sequence[tuple[float, float, int]], standing: Collection[Link]) -> None:
        """Queues arrivals of a at walls, the earliest first, until one of them ends its flight."""
        if len(found) > 1:
            found = sorted(found)
        for low, high, wall in found:
            if low > a.until:
                return
            if not standing or (a.index, wall, "wall") not in standing:  # as an `AtWall`, made in a sixth of the time
                a.until = min(a.until, high)
                self._order += 1
                heappush(self._heap, (low, self._order, high, a.index, ~wall, a.serial, 0))

    def push_all(
        self,
        moved: Sequence[Body[N]],
        outlook: Outlook[N],
        bounds: Doubles,
        slopes: tuple[float, float],
        standing: Collection[Link],
    ) -> bool:
        """Predicts all meetings of one or two circles in doubles, and queues them; False, and nothing done, where that
        is not compiled, or not all is told by doubles.

        Args:
            moved: circles whose flights are new.
            outlook: what they may meet.
            bounds, slopes: see `DoubleFilter`.
            standing: contacts that are not to be predicted.
        """
        if predictions is None:
            return False
        others, lines, reaches, _ = outlook
        order = predictions.predict(moved, others, lines, reaches, bounds, slopes, standing, self._heap, self._order)
        if order is None:
            return False
        self._order = order
        return True

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
        return [entry for entry in self._heap if isinstance(entry, Arrival) and entry.graze]

    def alone(self, before: float) -> Touch | None:
        """Takes off the next arrival if it is certain to come, before a time, and nothing else may come with it.

        None where that is not plain at a glance: then all is as it was, or nearer to it.
        """
        heap, bodies, crossings = self._heap, self._bodies, self.crossings
        if predictions is not None:
            crossing = crossings.next_crossing
            found = predictions.first(heap, bodies, before if before < crossing else crossing)
            if found is not None:
                return _link_of(found)
        while heap:
            first = heap[0]
            if isinstance(first, Arrival):
                if not self.fresh(first):
                    heappop(heap)
                    continue
                low, _, high, certain, _, link, _, graze = first
                if graze or not certain or isinstance(link, Entry):
                    return None
            else:
                low, _, high, i, j, si, sj = first
                if bodies[i].serial != si or (j >= 0 and bodies[j].serial != sj):
                    heappop(heap)
                    continue
                link = None
            if not high < before:
                return None
            crossing = crossings.next_crossing
            if crossing <= high:
                if crossing >= low and high - low > crossings.early:
                    return None
                crossings.cross()
                continue
            heappop(heap)
            while heap and heap[0][0] <= high:
                if not self._is_stale(heap[0]):
                    heappush(heap, first)
                    return None
                heappop(heap)
            return _link_of(first) if link is None else link
        return None

    def rivals(self) -> list[Arrival[N]]:
        """Takes off every arrival that may be the first; with it come all that may fall on the same instant.

        An arrival is left where it is if its lower bound lies above the least upper bound of those taken, grazes aside:
        what comes first is chosen among the others, and these may all come after a graze.
        """
        heap, crossings = self._heap, self.crossings
        while True:
            while heap and self._is_stale(heap[0]):
                heappop(heap)
            crossing = crossings.next_crossing
            if crossing < inf and (not heap or heap[0][0] > crossing):
                crossings.cross()
                continue
            found = self._rivals()
            if crossing == inf or crossing > _bar(found):
                return found
            since = found[0].low
            if crossing > since and not any(arrival.certain for arrival in found):
                return found
            for arrival in found:
                heappush(heap, arrival)
            crossings.cross(since)

    def _rivals(self) -> list[Arrival[N]]:
        heap = self._heap
        found: list[Arrival[N]] = []
        bar = inf
        while heap and heap[0][0] <= bar:
            other = heappop(heap)
            if not self._is_stale(other):
                arrival = other if isinstance(other, Arrival) else self._as_arrival(other)
                found.append(arrival)
                if not arrival.graze:
                    bar = min(bar, arrival.high)
        return found

    def _is_stale(self, entry: PlainArrival | Arrival[N]) -> bool:
        """Whether an entry rests on a flight that is over."""
        if isinstance(entry, Arrival):
            return not self.fresh(entry)
        bodies, (_, _, _, i, j, si, sj) = self._bodies, entry
        return bodies[i].serial != si or (j >= 0 and bodies[j].serial != sj)

    def _as_arrival(self, entry: PlainArrival) -> Arrival[N]:
        """An entry as others see it."""
        low, order, high, _, j, si, sj = entry
        return Arrival(low, order, high, True, None, _link_of(entry), (si, sj) if j >= 0 else (si,))


def _bar(found: Sequence[Arrival[N]]) -> float:
    """By when one of some arrivals has come that is no graze; where all are grazes, one of them."""
    return min((arrival.high for arrival in found if not arrival.graze), default=min(arrival.high for arrival in found))


def _link_of(entry: PlainArrival) -> Touch:
    """Whose meeting it is."""
    i, j = entry[3], entry[4]
    return _new(Pair, (i, j)) if j >= 0 else _new(AtWall, (i, ~j, "wall"))


_new = tuple.__new__
"""Makes a named tuple of all its fields: what its own constructor does, in a third of the time."""
