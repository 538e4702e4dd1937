"""Predictions among many circles, on flat flights: of each with those in the cells around it (see `Cells`)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection
from itertools import count

from ...exact.simulation.cells import Cells, Flight
from ...exact.simulation.prediction import FARTHEST
from .flights import FlatFlight, FlatFlights
from .inlined import pairs


class FlatCrowd:
    """The circles of a run in cells; it makes the queue's crossings (see `Crowd`).

    Args:
        cells: the cells.
        flights: the flights.
        plan: counts what is predicted and what is skipped.
    """

    def __init__(self, cells: Cells, flights: FlatFlights, plan: Counter[str]) -> None:
        self._cells = cells
        self._flights = flights
        self._plan = plan
        self._known: list[set[int]] = [set()] * flights.n
        self._born = [0] * flights.n
        self._births = count(1).__next__

    @property
    def next_crossing(self) -> float:
        """See `Crossings`."""
        return self._cells.next_crossing

    def enter(self, i: int) -> None:
        """Takes up a circle's new flight."""
        self._cells.enter(i, spot(self._flights.flights[i]))
        self._born[i] = self._births()

    def pairs(self, i: int, standing: Collection[int], done: Collection[int]) -> None:
        """Queues the next meetings of a circle, whose flight is new, with all around it but some."""
        flights = self._flights.flights
        near = self._cells.around(i)
        self._known[i] = set(near)
        if done:
            near = [k for k in near if k not in done]
        near.sort()
        met = self._moving(i, [flights[k] for k in near])
        self._plan["pairs predicted"] += len(met)
        pairs(self._flights, i, met, standing)

    def cross(self, since: float, until: float) -> None:
        """See `Crossings`."""
        while self._cells.next_crossing <= until:
            self.cross_one()

    def cross_one(self) -> None:
        """The next crossing; doubles know when it is, so nothing can be far from its cell.

        What two flights come to is predicted once: of the two born last, it knows the other.
        """
        f, known, born = self._flights, self._known, self._born
        flights = f.flights
        i, near = self._cells.cross()
        mine, own = known[i], born[i]
        new = [k for k in near if (k not in mine if own > born[k] else i not in known[k])]
        self._plan["cells crossed"] += 1
        new.sort()
        for k in new:
            if own > born[k]:
                mine.add(k)
            else:
                known[k].add(i)
        if not new:
            return
        met, last = self._moving(i, [flights[k] for k in new]), f.last
        self._plan["pairs predicted"] += len(met)
        earlier = [flight for flight in met if last[flight[-1]] <= last[i]]
        if earlier:
            pairs(f, i, earlier, ())
        for flight in met:
            if last[flight[-1]] > last[i]:
                pairs(f, flight[-1], (flights[i],), ())

    def _moving(self, i: int, others: list[FlatFlight]) -> list[FlatFlight]:
        """Those of some flights that a circle may meet: two at rest do not."""
        _, _, vx, vy, _, _, _ = self._flights.flights[i]
        if vx or vy:
            return others
        moving = [flight for flight in others if flight[2] or flight[3]]
        self._plan["pairs at rest skipped"] += len(others) - len(moving)
        return moving


def spot(flight: FlatFlight) -> Flight | None:
    """A flight as cells take it; None beyond what they can be trusted with (see `Predictor.spot`)."""
    x, y, vx, vy, t, _, _ = flight
    far = FARTHEST
    if -far < x < far and -far < y < far and -far < vx < far and -far < vy < far and t < far:
        return x, y, vx, vy, t
    return None
