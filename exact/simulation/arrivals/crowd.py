"""Predictions among many circles: of each with those in the cells around it, as it comes to new cells."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from math import inf
from typing import Generic, Protocol

from ....scenarios.things import Wall
from ...compiled import CellLists
from ...numbers.system import N
from ...replay.body import Body
from ...replay.contact import Link
from .cells import cells_of
from .grid import LARGE, FloatFlight, grid_for
from .wall_cells import WallCells


class Predictions(Protocol[N]):
    """Makes the predictions of one run."""

    def in_doubles(self, a: Body[N], /) -> FloatFlight | None:
        """A circle's flight in doubles; None where they do not tell it to a rounding."""
        ...

    def walls(self, a: Body[N], walls: Sequence[int], standing: Collection[Link], /) -> None:
        """Queues the next hits of a circle with some walls."""
        ...

    def pairs(self, a: Body[N], others: list[Body[N]], standing: Collection[Link], /) -> None:
        """Queues the next meetings of a circle with others."""
        ...


class Crowd(Generic[N]):
    """The circles of a run in cells; it makes the queue's crossings.

    Args:
        cells: the cells.
        bodies, pockets: the circles and the pockets.
        plan: counts what is predicted and what is skipped.
        predictions: makes them.
    """

    def __init__(
        self,
        cells: CellLists,
        bodies: Mapping[int, Body[N]],
        pockets: Sequence[Body[N]],
        plan: Counter[str],
        predictions: Predictions[N],
    ) -> None:
        self._cells = cells
        self._bodies = bodies
        self._pockets = list(pockets)
        self._plan = plan
        self._predictions = predictions

    def predict(self, moved: Sequence[Body[N]], standing: Collection[Link], gone: Collection[int]) -> None:
        """Queues the next meetings of circles whose flights are new (see `Predictor.predict`)."""
        cells, bodies, plan, predictions = self._cells, self._bodies, self._plan, self._predictions
        for i in gone:
            cells.remove(i)
        for a in moved:
            a.until = inf
            flight = predictions.in_doubles(a)
            if flight is None:
                cells.enter_loose(a.index)
            elif not cells.enter(a.index, flight):
                continue
            walls = cells.walls(a.index)
            if walls and not a.flight.rest:
                plan["walls predicted"] += len(walls)
                predictions.walls(a, walls, standing)
        done: set[int] = set()
        predicted = 0
        for a in moved:
            near = cells.around(a.index)
            met = [bodies[k] for k in near if k not in done] if done else [bodies[k] for k in near]
            done.add(a.index)
            if a.flight.rest:
                count = len(met)
                met = [b for b in met if not b.flight.rest]
                plan["pairs at rest skipped"] += count - len(met)
            elif self._pockets:
                predicted -= len(self._pockets)
                met += self._pockets
            predicted += len(met)
            predictions.pairs(a, met, standing)
        plan["pairs predicted"] += predicted

    @property
    def next_crossing(self) -> float:
        """See `Crossings`."""
        return self._cells.next_crossing

    @property
    def early(self) -> float:
        """See `Crossings`."""
        return self._cells.early

    def cross(self, since: float = inf) -> None:
        """See `Crossings`. Two that touch have been neighbours, so nothing stands at gap zero here."""
        bodies, plan, predictions = self._bodies, self._plan, self._predictions
        crossed = self._cells.cross(since)
        plan["cells crossed"] += len(crossed)
        for i, near, walls in crossed:
            if walls:
                plan["walls predicted"] += len(walls)
                predictions.walls(bodies[i], walls, ())
            if near:
                plan["pairs predicted"] += len(near)
                predictions.pairs(bodies[i], [bodies[k] for k in near], ())


def cells_for(flights: Sequence[FloatFlight | None], radii: Sequence[float], walls: Sequence[Wall]) -> CellLists | None:
    """Cells for the circles of a run, empty; None where they would spare nothing."""
    grid = grid_for(flights, radii)
    if grid is None:
        return None
    usual = sorted(radii)[len(radii) // 2]
    large = frozenset(i for i, r in enumerate(radii) if r > LARGE * usual)
    radius = max(r for i, r in enumerate(radii) if i not in large)
    return cells_of(grid, len(radii), large, WallCells(walls, *grid.ends(), radius))
