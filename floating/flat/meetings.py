"""Predictions of a flat run."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Container, Sequence
from math import inf

from ...exact.numbers.system import NumberSystem
from ...exact.predicates.question import Question
from ...exact.replay.body import Body
from ...exact.replay.contact import Link
from ...exact.replay.state import State
from ...exact.simulation.arrivals import grid as crowding
from ...exact.simulation.arrivals.crowd import cells_for
from ...scenarios.scene import Scene
from ..plain.decider import PlainMeetings
from .crowd import FlatCrowd, in_range
from .flights import FlatFlights
from .formulas import pairs, walls
from .queue import FlatQueue


class FlatMeetings(PlainMeetings[float]):
    """See `PlainMeetings`; what is plain is predicted on flat flights.

    Args:
        scene, state, queue, plan, numbers, ask: see there.
        flights: the flights.
    """

    def __init__(
        self,
        scene: Scene,
        state: State[float],
        queue: FlatQueue,
        plan: Counter[str],
        numbers: NumberSystem[float],
        ask: Callable[[Question], int],
        flights: FlatFlights,
    ) -> None:
        super().__init__(scene, state, queue, plan, numbers, ask)
        self._scene = scene
        self._flights = flights
        self._plan = plan
        self._points = frozenset(i for i, circle in enumerate(scene.circles) if circle.r.sign() == 0)
        self.crowd: FlatCrowd | None = None
        self._begun = False
        self._queue = queue
        self._radii = [circle.r for circle in scene.circles]
        flights.unsure = self._look_closer

    def predict(self, moved: Sequence[Body[float]], standing: Collection[Link], gone: Collection[int]) -> None:
        """See `PlainMeetings`; nothing is gone where there are no pockets."""
        f = self._flights
        f.take_up(moved)
        beside: dict[int, set[int]] = {}
        for link in standing:
            i, j = f.places(link)
            beside.setdefault(i, set()).add(j)
            beside.setdefault(j, set()).add(i)
        if not self._begun:
            self._begun = True
            self._gather_crowd()
        crowd, done = self.crowd, set[int]()
        if crowd is not None:
            for body in moved:
                crowd.enter(body.index)
        for body in moved:
            self._walls(body.index, beside.get(body.index, ()))
        for body in moved:
            i = body.index
            done.add(i)
            if crowd is not None:
                crowd.pairs(i, beside.get(i, ()), done)
            else:
                pairs(f, i, [flight for flight in f.flights if flight[-1] not in done], beside.get(i, ()))
                self._count(i, done)

    def alone(self, i: int, j: int) -> None:
        """Queues the next meetings of the two of a contact alone, without cells; the second may be a wall."""
        f = self._flights
        flights, both = f.flights, (i, j)
        if j >= f.n:
            self._walls(i, (j,))
            pairs(f, i, flights, (i,))
            self._count(i, (i,))
            return
        self._walls(i, ())
        self._walls(j, ())
        pairs(f, i, flights, both)
        pairs(f, j, flights, both)
        self._count(i, (i,))
        self._count(j, both)

    def _walls(self, i: int, standing: Container[int]) -> None:
        """Queues the next hits of a circle, whose flight is new, with the walls."""
        f = self._flights
        f.until[i] = inf
        if self.crowd is not None:
            self.crowd.walls(i, standing)
            return
        walls(f, i, f.lines(i), standing)
        if not f.rests(i):
            self._plan["walls predicted"] += f.wall_count

    def _gather_crowd(self) -> None:
        """Puts the circles in cells, if they are many."""
        f = self._flights
        if f.n < crowding.FEWEST:
            return
        try:
            radii = [float(r) for r in self._radii]
        except OverflowError:  # beyond doubles, as no grid is
            return
        cells = cells_for([in_range(flight) for flight in f.flights], radii, self._scene.walls)
        if cells is not None:
            self.crowd = self._queue.crossings = FlatCrowd(cells, f, self._plan)

    def _count(self, i: int, done: Collection[int]) -> None:
        """Counts the predictions of a circle with all others but some."""
        f, plan = self._flights, self._plan
        others = f.n - len(done)
        if f.rests(i):
            resting = sum(f.rests(k) for k in range(f.n) if k not in done)
            plan["pairs at rest skipped"] += resting
            others -= resting
        plan["pairs predicted"] += others

    def _look_closer(self, i: int, j: int) -> None:
        """A meeting whose signs are not plain is left to the general loop's questions."""
        if i not in self._points or j not in self._points:
            self._flights.sync()
            self._unsure(self._flights.link(i, j))
