"""Predictions among many circles, on flat flights: of each with those in the cells around it (see `Cells`)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Container, Sequence
from math import inf

from ...exact.compiled import CellLists
from ...exact.simulation.arrivals.cells import FARTHEST as FAR
from ...exact.simulation.arrivals.grid import FloatFlight
from .flights import FlatFlight, FlatFlights
from .formulas import pairs, walls


class FlatCrowd:
    """The circles of a run in cells; it makes the queue's crossings (see `Crowd`).

    Args:
        cells: the cells.
        flights: the flights.
        plan: counts what is predicted and what is skipped.
    """

    def __init__(self, cells: CellLists, flights: FlatFlights, plan: Counter[str]) -> None:
        self.cells = cells
        self._flights = flights
        self._plan = plan

    @property
    def next_crossing(self) -> float:
        """See `Crossings`."""
        return self.cells.next_crossing

    @property
    def early(self) -> float:
        """See `Crossings`; doubles know when each is, so nothing is ever so early."""
        return self.cells.early

    def enter(self, i: int) -> None:
        """Takes up a circle's new flight."""
        self.cells.enter(i, self._flights.flights[i][:5])

    def alone(self, i: int, j: int) -> None:
        """Queues the next meetings of the two of a contact alone; the second may be a wall."""
        f, cells = self._flights, self.cells
        flights, untils = f.flights, f.until
        one = flights[i]
        near_walls = cells.enter(i, one[:5])
        untils[i] = inf
        if j >= f.n:
            self.walls(i, (j,))
            self.pairs(i, (), ())
            return
        two = flights[j]
        untils[j] = inf
        near_others = cells.enter(j, two[:5])
        if near_walls:
            self.walls(i, ())
        if near_others:
            self.walls(j, ())
        if one[2] == 0.0 == one[3] or two[2] == 0.0 == two[3]:
            self.pairs(i, (j,), ())
            self.pairs(j, (), (i,))
            return
        flight, beside = flights.__getitem__, (i, j)
        near, close = cells.around(i), cells.around(j)
        pairs(f, i, map(flight, near), beside)
        pairs(f, j, map(flight, close), beside)
        self._plan["pairs predicted"] += len(near) + len(close) - (i in close)

    def walls(self, i: int, standing: Container[int]) -> None:
        """Queues the next hits of a circle with the walls near its cell that its flight does not know yet."""
        near = self.cells.walls(i)
        if near and not self._flights.rests(i):
            self._walls(i, near, standing)

    def pairs(self, i: int, standing: Container[int], done: Collection[int]) -> None:
        """Queues the next meetings of a circle, whose flight is new, with all around it but some."""
        flights = self._flights.flights
        met = [flights[k] for k in self.cells.around(i) if k not in done]
        if self._flights.rests(i):
            count = len(met)
            met = [flight for flight in met if flight[2] or flight[3]]
            self._plan["pairs at rest skipped"] += count - len(met)
        self._plan["pairs predicted"] += len(met)
        pairs(self._flights, i, met, standing)

    def cross(self, since: float = inf) -> None:
        """See `Crossings`."""
        f, plan, predicted = self._flights, self._plan, 0
        flights, last = f.flights, f.last
        crossed = self.cells.cross(since)
        for i, near, close in crossed:
            if close:
                self._walls(i, close, ())
            if not near:
                continue
            predicted += len(near)
            own = last[i]
            earlier = [flights[k] for k in near if last[k] <= own]
            if earlier:
                pairs(f, i, earlier, ())
            if len(earlier) < len(near):
                for k in near:
                    if last[k] > own:
                        pairs(f, k, (flights[i],), ())
        plan["cells crossed"] += len(crossed)
        plan["pairs predicted"] += predicted

    def _walls(self, i: int, near: Sequence[int], standing: Container[int]) -> None:
        """Queues the next hits of a circle with some walls."""
        self._plan["walls predicted"] += len(near)
        lines = self._flights.lines(i)
        walls(self._flights, i, [lines[k] for k in near], standing)


def in_range(flight: FlatFlight) -> FloatFlight | None:
    """A flight as cells take it; None beyond what they can be trusted with (see `Predictor.in_doubles`)."""
    x, y, vx, vy, t, _, _ = flight
    if -FAR < x < FAR and -FAR < y < FAR and -FAR < vx < FAR and -FAR < vy < FAR and t < FAR:
        return x, y, vx, vy, t
    return None
