"""Predictions among many circles, on flat flights: of each with those in the cells around it (see `Cells`)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable

from ...exact.simulation.cells import Cells, Spot
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
        self._known: dict[int, int] = {}

    @property
    def next_crossing(self) -> float:
        """See `Crossings`."""
        return self._cells.next_crossing

    def enter(self, i: int) -> None:
        """Takes up a circle's new flight."""
        self._cells.enter(i, spot(self._flights.flights[i]))

    def pairs(self, i: int, standing: Collection[int], done: Collection[int]) -> None:
        """Queues the next meetings of a circle, whose flight is new, with all around it but some."""
        met = self._to_meet(i, [k for k in self._cells.around(i) if k not in done])
        self._plan["pairs predicted"] += len(met)
        pairs(self._flights, i, met, standing)

    def cross(self, since: float, until: float) -> None:
        """See `Crossings`."""
        f, plan, known, serial = self._flights, self._plan, self._known, self._flights.serial
        for i, near in self._cells.crossed(since, until):
            plan["cells crossed"] += 1
            new = [k for k in near if known.get(i * f.n + k if i < k else k * f.n + i) != serial[i] + serial[k]]
            for flight in self._to_meet(i, new):
                plan["pairs predicted"] += 1
                first, second = (i, flight[-1]) if i < flight[-1] else (flight[-1], i)
                if f.last[first] < f.last[second]:
                    first, second = second, first
                pairs(f, first, (f.flights[second],), ())

    def _to_meet(self, i: int, others: Iterable[int]) -> list[FlatFlight]:
        """Those of some circles that one may meet, in scene order; they are known from now on.

        What is known of two is the sum of their serial numbers, which both only grow.
        """
        f, known = self._flights, self._known
        flights, serial, n, own = f.flights, f.serial, f.n, f.serial[i]
        met: list[FlatFlight] = []
        for k in sorted(others):
            known[i * n + k if i < k else k * n + i] = own + serial[k]
            met.append(flights[k])
        if f.rests(i):
            moving = [flight for flight in met if flight[2] or flight[3]]
            self._plan["pairs at rest skipped"] += len(met) - len(moving)
            return moving
        return met


def spot(flight: FlatFlight) -> Spot | None:
    """A flight as cells take it; None beyond what they can be trusted with (see `Predictor.spot`)."""
    x, y, vx, vy, t, _, _ = flight
    if abs(x) < FARTHEST and abs(y) < FARTHEST and abs(vx) < FARTHEST and abs(vy) < FARTHEST and abs(t) < FARTHEST:
        return Spot(x, y, vx, vy, t)
    return None
