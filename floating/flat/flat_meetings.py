"""Predictions of a flat run, among few circles and among many."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Container, Iterable, Sequence
from math import inf
from typing import Protocol, cast

from ...exact.compiled import CellLists, loaded
from ...exact.numbers.system import NumberSystem
from ...exact.question import Question
from ...exact.replay.contact import Body, Link
from ...exact.replay.state import ReplayState
from ...exact.simulation import cells as crowding
from ...exact.simulation.cells import FARTHEST as FAR
from ...exact.simulation.cells import FloatFlight, cells_for
from ...scenarios.scene import Scene
from ..plain_meetings import PlainMeetings
from . import flying
from .flat_flights import FlatFlight, FlatFlights, FlatLine, FlatQueue

# -- The formulas of the laws as the flat loop runs them: those of flying.py, or of flying.c where there was a compiler
# when truebreak was installed: the same operations in the same order (see `truebreak.exact.compiled`).


class Flying(Protocol):
    """See flying.py."""

    def walls(self, f: FlatFlights, i: int, lines: Iterable[FlatLine], standing: Container[int], /) -> None:
        """Queues the next hits of a circle with some walls, up to the first."""
        ...

    def pairs(self, f: FlatFlights, i: int, others: Iterable[FlatFlight], standing: Container[int], /) -> None:
        """Queues the next meetings of a circle, whose flight is new, with circles whose flights are older."""
        ...


compiled = cast("Flying | None", loaded(f"{__package__}._flying"))
walls = flying.walls if compiled is None else compiled.walls
pairs = flying.pairs if compiled is None else compiled.pairs


# -- Predictions among many circles, on flat flights: of each with those in the cells around it (see `Cells`).


class FlatCrowd:
    """The circles of a run in cells; it makes the queue's crossings (see `Crowd`).

    Args:
        cells: the cells.
        flights: the flights.
        plan: counts what is predicted and what is skipped.
        slides: what predictions see to slide along a face.

    Attributes:
        slides: see `Crossings`.
    """

    def __init__(self, cells: CellLists, flights: FlatFlights, plan: Counter[str], slides: Sequence[Link]) -> None:
        self.slides = slides
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
            self.walls(i, f.beside(j))
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


# -- Predictions of a flat run.


class FlatMeetings(PlainMeetings[float]):
    """See `PlainMeetings`; what is plain is predicted on flat flights.

    Args:
        scene, state, queue, plan, numbers, ask: see there.
        flights: the flights.
    """

    def __init__(
        self,
        scene: Scene,
        state: ReplayState[float],
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
        self._points = frozenset(i for i, c in enumerate(scene.circles) if c.r.sign() == 0 and i not in scene.ends)
        self.crowd: FlatCrowd | None = None
        self._begun = False
        self._queue = queue
        self._straight = len(scene.walls) - len(scene.faces)
        self._radii = [circle.r for circle in scene.circles]
        flights.unsure = self._look_closer

    def close(self) -> None:
        """See `PlainMeetings`."""
        super().close()
        del self._flights.unsure

    def predict(self, moved: Sequence[Body[float]], standing: Collection[Link], gone: Collection[int]) -> None:
        """See `PlainMeetings`; nothing is gone where there are no pockets."""
        f = self._flights
        f.take_up(moved)
        beside: dict[int, set[int]] = {}
        for link in standing:
            i, j = f.places(link)
            beside.setdefault(i, set()).update(f.beside(j))
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
            self._walls(i, f.beside(j))
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
        if not f.rests(i):
            walls(f, i, f.lines(i), standing)
            self._plan["walls predicted"] += self._straight

    def _gather_crowd(self) -> None:
        """Puts the circles in cells, if they are many."""
        f = self._flights
        if f.n < crowding.FEWEST:
            return
        try:
            radii = [float(r) for r in self._radii]
        except OverflowError:  # beyond doubles, as no grid is
            return
        scene = self._scene
        cells = cells_for([in_range(flight) for flight in f.flights], radii, scene.walls, len(scene.ends))
        if cells is not None:
            self.crowd = self._queue.crossings = FlatCrowd(cells, f, self._plan, self.slides)

    def _count(self, i: int, done: Collection[int]) -> None:
        """Counts the predictions of a circle with all others but some."""
        f, plan = self._flights, self._plan
        others = f.n - len(done)
        if f.rests(i):
            resting = sum(vx == 0.0 == vy for _, _, vx, vy, *_ in f.flights) - sum(map(f.rests, done))
            plan["pairs at rest skipped"] += resting
            others -= resting
        plan["pairs predicted"] += others

    def _look_closer(self, i: int, j: int) -> None:
        """A meeting whose signs are not plain is left to the general loop's questions."""
        if i not in self._points or j not in self._points:
            self._flights.sync()
            self._unsure(self._flights.link(i, j))
