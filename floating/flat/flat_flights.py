"""The flights of a run in doubles, plain floats in flat lists, and the queue of arrivals upon them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from heapq import heappop, heappush
from itertools import count
from math import inf
from typing import TypeAlias

from ...exact.replay.contact import AtWall, Body, Flight, Link, Pair
from ...exact.replay.state import ReplayState
from ...exact.simulation.prediction import Arrival, ArrivalQueue
from ...scenarios.scene import Scene

# -- The flights of a run in doubles: plain floats in flat lists, and the queue's entries upon them.
#
# A flight here is (x, y, vx, vy, t, r, place): the place of a circle is its index, that of wall k is n + k. The state
# of the general loop holds the same flights; of those that changed here last it is told when it is asked for
# (`sync`), and what it changed is taken over (`take_up`). Clocks are handed on as the objects that they are: that two
# bodies stand at one instant is told by the clock being the same.

FlatFlight: TypeAlias = tuple[float, float, float, float, float, float, int]
"""(x, y, vx, vy, t, r, place)."""

FlatLine: TypeAlias = tuple[int, float, float, float, float, float, float, bool]
"""(place, x0, y0, nx, ny, r |n|, |n|^2) of a wall as seen from a circle (see `SeenWall`), and whether it is a face."""

Queued: TypeAlias = tuple[float, int, int, int, int, int, float | None, bool]
"""An arrival: its time, its order among equal ones, the places of the two, the serial numbers of their flights, the
time to it from the clock of the first, and whether it is a graze. What is no plain hit, or has been taken off before,
has None in place of the wait: the general loop sees to it."""


class FlatFlights:
    """The circles and walls of a run.

    Args:
        scene: what runs, with its segments and polygons as faces and ends; it has no pockets.
        state: the general loop's state of it.

    Attributes:
        flights: of each circle.
        until: for each place, the time by which its flight ends at a wall; infinite for walls.
        serial: for each place, how often its velocity has changed.
        last: for each circle, how many steps of the log were done when it was last touched.
        weights: for each circle, its inverse mass, and whether it is fixed.
        heap: the queue.
        tick: numbers its entries.
        steps: how many steps of the log are done.
        shifted: circles that a lasting or a passive contact advanced: their clocks are no longer those that their
            arrivals are reckoned from.
        ahead: circles whose flights here are newer than the state's.
        share: part of an elastic impulse that the scene's restitution leaves; None: all of it.
        unsure: deals with a meeting of two places whose signs are not plain.
    """

    def __init__(self, scene: Scene, state: ReplayState[float]) -> None:
        self.n = n = state.n
        self.wall_count = len(scene.walls)
        places = n + self.wall_count
        self.flights: list[FlatFlight] = [(*body.flight[:5], body.r, i) for i, body in state.bodies.items()]
        self.until = [inf] * places
        self.serial = [0] * places
        self.last = [0] * n
        self.weights = [
            (body.w, circle.fixed) for body, circle in zip(state.bodies.values(), scene.circles, strict=True)
        ]
        self.heap: list[Queued] = []
        self.tick = count(1).__next__
        self.steps = 0
        self.shifted: set[int] = set()
        self.share = state.share
        self.unsure: Callable[[int, int], None] = _nothing
        self._state = state
        self.ahead: set[int] = set()
        self._behind: set[int] = set()
        self._first_face = scene.faces.start
        self._sides_from, self._sides_to = n + scene.two_sided.start, n + scene.two_sided.stop
        self._lines: list[tuple[FlatLine, ...] | None] = [None] * n

    def lines(self, i: int) -> tuple[FlatLine, ...]:
        """The walls as a circle sees them."""
        found = self._lines[i]
        if found is None:
            seen = ((k, self._state.line(i, k)) for k in range(self.wall_count))
            r, first = self.flights[i][5], self._first_face
            found = tuple((self.n + k, w.x0, w.y0, w.nx, w.ny, r * w.length, w.nn, k >= first) for k, w in seen)
            self._lines[i] = found
        return found

    def beside(self, j: int) -> tuple[int, ...]:
        """A place, with that of the other side of a segment, of which what is at one side meets neither."""
        first = self._sides_from
        return (j,) if j < first or j >= self._sides_to else (j, first + ((j - first) ^ 1))

    def link(self, i: int, j: int) -> Pair | AtWall:
        """The contact of two places, the first a circle."""
        if j >= self.n:
            return AtWall(i, j - self.n)
        return Pair(i, j) if i < j else Pair(j, i)

    def places(self, link: Link) -> tuple[int, int]:
        """The places of a contact."""
        return (link[0], self.n + link[1]) if link.flat else (link[0], link[1])

    def stale(self, entry: Queued) -> bool:
        """Whether an arrival rests on flights that are over."""
        return self.serial[entry[2]] != entry[4] or self.serial[entry[3]] != entry[5]

    def rests(self, i: int) -> bool:
        """Whether a circle's velocity is exactly zero."""
        return self.flights[i][2] == 0.0 == self.flights[i][3]

    # -- the general loop's state

    def sync(self) -> None:
        """Brings the state up to the flights here."""
        state = self._state
        for i in self.ahead:
            x, y, vx, vy, t, _, _ = self.flights[i]
            body = state.bodies[i]
            body.flight = flight = Flight(x, y, vx, vy, t, t, None, self.last[i], vx == 0.0 == vy)
            body.q = flight[:5]
        self.ahead.clear()
        state.steps_done = self.steps

    def changed(self, bodies: Iterable[int]) -> None:
        """Notes circles whose flights in the state are newer than those here."""
        self._behind.update(bodies)

    def take_up(self, moved: Iterable[Body[float]] = ()) -> None:
        """Brings the flights here up to the state.

        Args:
            moved: circles whose velocity has changed: arrivals that rest on their flights are stale.
        """
        bodies = self._state.bodies
        for i in self._behind:
            flight = bodies[i].flight
            self.flights[i] = (flight.x, flight.y, flight.vx, flight.vy, flight.t, bodies[i].r, i)
            self.last[i] = flight.last
            self.shifted.add(i)
        if self._behind:
            self.steps = self._state.steps_done
            self._behind.clear()
        for body in moved:
            self.shifted.discard(body.index)
            self.serial[body.index] += 1


def _nothing(i: int, j: int) -> None:
    """Stands in until there is somebody to ask."""


# -- The queue of a flat run, as the general loop sees it: entries become arrivals when it takes them off.


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
        if high < f.until[i] and link.flat:
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
