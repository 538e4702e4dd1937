"""Predictions among many circles: of each with those in the cells around it, as it comes to new cells."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import Generic

from ..numbers.system import N
from ..replay.body import Body
from ..replay.contact import Link
from .cells import LARGE, Cells, Spot, grid_for

Pairs = Callable[[Body[N], list[Body[N]], Collection[Link]], None]
"""Queues the next meetings of a circle with others that have changed no later than it."""


class Crowd(Generic[N]):
    """The circles of a run in cells; it makes the queue's crossings.

    Args:
        cells: the cells.
        bodies, pockets: the circles and the pockets.
        plan: counts what is predicted and what is skipped.
        prepare: called before predictions.
        pairs: makes them.
        spot: a circle's flight in doubles; None where they do not tell it to a rounding.
    """

    def __init__(
        self,
        cells: Cells,
        bodies: Mapping[int, Body[N]],
        pockets: Sequence[Body[N]],
        plan: Counter[str],
        prepare: Callable[[], None],
        pairs: Pairs[N],
        spot: Callable[[Body[N]], Spot | None],
    ) -> None:
        self._cells = cells
        self._bodies = bodies
        self._pockets = list(pockets)
        self._plan = plan
        self._prepare = prepare
        self._pairs = pairs
        self._spot = spot
        self._count = len(bodies)
        self._known: dict[int, int] = {}

    def predict(self, moved: Sequence[Body[N]], standing: Collection[Link], gone: Collection[int]) -> None:
        """Queues the next meetings of circles whose flights are new (see `Predictor.predict`)."""
        cells, done = self._cells, set[int]()
        for i in gone:
            cells.remove(i)
        for a in moved:
            cells.enter(a.index, self._spot(a))
        for a in moved:
            done.add(a.index)
            met = self._to_meet(a, [k for k in cells.around(a.index) if k not in done])
            self._plan["pairs predicted"] += len(met)
            self._pairs(a, met if a.flight.rest else [*met, *self._pockets], standing)

    @property
    def next_crossing(self) -> float:
        """See `Crossings`."""
        return self._cells.next_crossing

    def cross(self, since: float, until: float) -> None:
        """See `Crossings`. Two that touch have been neighbours, so nothing stands at gap zero here."""
        self._prepare()
        for i, near in self._cells.crossed(since, until):
            self._plan["cells crossed"] += 1
            a = self._bodies[i]
            known, count, bodies, serial = self._known, self._count, self._bodies, a.serial
            new = [k for k in near if known.get(i * count + k if i < k else k * count + i) != serial + bodies[k].serial]
            if not new:
                continue
            met = self._to_meet(a, new)
            self._plan["pairs predicted"] += len(met)
            last = a.flight.last
            earlier = [b for b in met if b.flight.last <= last]
            if earlier:
                self._pairs(a, earlier, ())
            for b in met:
                if b.flight.last > last:
                    self._pairs(b, [a], ())

    def _to_meet(self, a: Body[N], others: Iterable[int]) -> list[Body[N]]:
        """Those of some circles that a may meet, in scene order; they are known from now on.

        What is known of two is the sum of their serial numbers, which changes whenever a flight of one does.
        """
        met: list[Body[N]] = []
        known, count, bodies = self._known, self._count, self._bodies
        i, serial, rest = a.index, a.serial, a.flight.rest
        for k in sorted(others):
            b = bodies[k]
            known[i * count + k if i < k else k * count + i] = serial + b.serial
            if rest and b.flight.rest:
                self._plan["pairs at rest skipped"] += 1
            else:
                met.append(b)
        return met


def cells_for(spots: Mapping[int, Spot | None], radii: Sequence[float]) -> Cells | None:
    """Cells for the circles of a run, empty; None where they would spare nothing."""
    grid = grid_for(list(spots.values()), radii)
    if grid is None:
        return None
    usual = sorted(radii)[len(radii) // 2]
    return Cells(grid, frozenset(i for i, r in enumerate(radii) if r > LARGE * usual))
