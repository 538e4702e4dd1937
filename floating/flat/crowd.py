"""Predictions among many circles, on flat flights: of each with those in the cells around it (see `Cells`)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Container

from ...exact.simulation.arrivals.cells import Cells, Flight
from ...exact.simulation.arrivals.prediction import FARTHEST as FAR
from .flights import FlatFlight, FlatFlights
from .formulas.inlined import pairs, walls


class FlatCrowd:
    """The circles of a run in cells; it makes the queue's crossings (see `Crowd`).

    Args:
        cells: the cells.
        flights: the flights.
        plan: counts what is predicted and what is skipped.
    """

    def __init__(self, cells: Cells, flights: FlatFlights, plan: Counter[str]) -> None:
        self.cells = cells
        self._flights = flights
        self._plan = plan

    @property
    def next_crossing(self) -> float:
        """See `Crossings`."""
        return self.cells.next_crossing

    def enter(self, i: int) -> None:
        """Takes up a circle's new flight."""
        flight = in_range(self._flights.flights[i])
        if flight is None:
            self.cells.enter_loose(i)
        else:
            self.cells.enter(i, flight)

    def walls(self, i: int, standing: Container[int]) -> None:
        """Queues the next hits of a circle with the walls near its cell that its flight does not know yet."""
        near = () if self._flights.rests(i) else self.cells.walls(i)
        if near:
            self._plan["walls predicted"] += len(near)
            lines = self._flights.lines(i)
            walls(self._flights, i, [lines[k] for k in near], standing)

    def pairs(self, i: int, standing: Container[int], done: Collection[int]) -> None:
        """Queues the next meetings of a circle, whose flight is new, with all around it but some."""
        flights = self._flights.flights
        near = self.cells.around(i)
        met = [flights[k] for k in near if k not in done] if done else [flights[k] for k in near]
        _, _, vx, vy, _, _, _ = flights[i]
        if vx == 0.0 == vy:
            count = len(met)
            met = [flight for flight in met if flight[2] or flight[3]]
            self._plan["pairs at rest skipped"] += count - len(met)
        self._plan["pairs predicted"] += len(met)
        pairs(self._flights, i, met, standing)

    def cross_early(self, since: float, until: float) -> None:
        """See `Crossings`; doubles know when each is, so nothing can be far from its cell."""
        while self.cells.next_crossing <= until:
            self.cross()

    def cross(self) -> None:
        """See `Crossings`."""
        f, plan = self._flights, self._plan
        i, near = self.cells.cross()
        plan["cells crossed"] += 1
        self.walls(i, ())
        if not near:
            return
        plan["pairs predicted"] += len(near)
        flights, last = f.flights, f.last
        own = last[i]
        earlier = [flights[k] for k in near if last[k] <= own]
        if earlier:
            pairs(f, i, earlier, ())
        if len(earlier) < len(near):
            for k in near:
                if last[k] > own:
                    pairs(f, k, (flights[i],), ())


def in_range(flight: FlatFlight) -> Flight | None:
    """A flight as cells take it; None beyond what they can be trusted with (see `Predictor.in_doubles`)."""
    x, y, vx, vy, t, _, _ = flight
    if -FAR < x < FAR and -FAR < y < FAR and -FAR < vx < FAR and -FAR < vy < FAR and t < FAR:
        return x, y, vx, vy, t
    return None
