"""Predictions among many circles, on flat flights: of each with those in the cells around it (see `Cells`)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection

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
        self._known: list[dict[int, int]] = [{} for _ in range(flights.n)]  # by circle: others met, and their serials

    @property
    def next_crossing(self) -> float:
        """See `Crossings`."""
        return self._cells.next_crossing

    def enter(self, i: int) -> None:
        """Takes up a circle's new flight."""
        self._cells.enter(i, spot(self._flights.flights[i]))

    def pairs(self, i: int, standing: Collection[int], done: Collection[int]) -> None:
        """Queues the next meetings of a circle, whose flight is new, with all around it but some."""
        flights, serial = self._flights.flights, self._flights.serial
        near = self._cells.around(i)
        if done:
            near = [k for k in near if k not in done]
        near.sort()
        self._known[i] = dict(zip(near, [serial[k] for k in near], strict=True))
        met = self._moving(i, [flights[k] for k in near])
        self._plan["pairs predicted"] += len(met)
        pairs(self._flights, i, met, standing)

    def cross(self, since: float, until: float) -> None:
        """See `Crossings`."""
        f, plan, known, serial = self._flights, self._plan, self._known, self._flights.serial
        for i, near in self._cells.crossed(since, until):
            plan["cells crossed"] += 1
            mine, own = known[i], serial[i]
            new = [k for k in near if mine.get(k) != serial[k] and known[k].get(i) != own]
            new.sort()
            mine.update((k, serial[k]) for k in new)
            for flight in self._moving(i, [f.flights[k] for k in new]):
                plan["pairs predicted"] += 1
                first, second = (i, flight[-1]) if i < flight[-1] else (flight[-1], i)
                if f.last[first] < f.last[second]:
                    first, second = second, first
                pairs(f, first, (f.flights[second],), ())

    def _moving(self, i: int, others: list[FlatFlight]) -> list[FlatFlight]:
        """Those of some flights that a circle may meet: two at rest do not."""
        if not self._flights.rests(i):
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
