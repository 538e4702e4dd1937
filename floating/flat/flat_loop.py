"""The event loop of a flat run: ordinary instants in strides, every other by the general loop; its history."""

from __future__ import annotations

from collections.abc import Callable
from heapq import heappop, heappush
from math import inf
from typing import TypeAlias, cast

from ...exact.numbers.system import NumberSystem
from ...exact.replay.state import Go, Kick, Step
from ...exact.simulation.decider import History, Limits, Mark, Noted, Record
from ...exact.simulation.instant import Gatherer, Instant
from ...exact.simulation.loop import Loop
from ...exact.simulation.policies import Policy, Sequential, Simultaneous, policy_for
from ...scenarios.scene import Scene
from ...scenarios.trajectory import OnProgress, Stop
from ..plain import PlainDecider
from .flat_flights import FlatFlight, FlatFlights, FlatQueue
from .flat_meetings import FlatMeetings
from .flying import rebound, strike

# -- The history of a flat run: a contact alone is noted in one stroke, and told in the general loop's terms when
# read.

Lone: TypeAlias = tuple[float, FlatFlight, FlatFlight | None, int]
"""A contact that stood alone at its instant: the time, the flights of the two from then on (of a wall there is none),
and the place of the second."""


class FlatHistory(History[float]):
    """See `History`. A lone contact is one item, so that an interruption leaves it out or lets it in, whole.

    Args:
        flights: of the run.
    """

    def __init__(self, flights: FlatFlights) -> None:
        self._flights = flights
        self._mark: Mark[float] | None = None
        self._marked = 0
        self._rows_of = 0
        super().__init__()

    @property
    def items(self) -> list[Record[float] | Lone]:
        """The records as they are in a flat run: contacts alone are not unfolded yet."""
        return cast("list[Record[float] | Lone]", self.records)

    @property
    def last(self) -> Mark[float] | None:
        """See `History`."""
        return self._newest(self.items[self._marked :]) or self._mark

    @last.setter
    def last(self, mark: Mark[float] | None) -> None:  # pyright: ignore[reportIncompatibleVariableOverride]
        self._mark = mark
        self._marked = len(self.records)

    def _newest(self, items: list[Record[float] | Lone]) -> Mark[float] | None:
        """The mark of the last of some records, if it is a lone contact."""
        return self._mark_of(items[-1]) if items and not isinstance(items[-1], Record) else None

    def add(self, note: Noted[float]) -> None:
        """See `History`."""
        self._add_rows()
        super().add(note)

    def drop_unfinished(self) -> None:
        """See `History`; a lone contact is whole."""
        number = -1 if self._mark is None else self._mark.number
        since = self.items[self._marked :]
        newest = self._newest([one for one in since if not isinstance(one, Record) or one.mark.number <= number])
        self.unfold()
        super().drop_unfinished()
        self._mark, self._marked = newest or self._mark, len(self.records)

    def unfold(self) -> None:
        """Puts every lone contact into the general loop's terms."""
        self._add_rows()
        items = self.items
        for place, one in enumerate(items):
            if not isinstance(one, Record):
                links = (self._flights.link(one[1][-1], one[3]),)
                items[place] = Record(self._mark_of(one), links, links, (), False)

    def _add_rows(self) -> None:
        """The knots of lone contacts that are not among the rows yet."""
        for one in self.items[self._rows_of :]:
            if not isinstance(one, Record):
                for flight in one[1:3]:
                    if flight is not None:
                        x, y, vx, vy, t, _, i = flight
                        self.knots[i].append((t, x, y, vx, vy, 0, -1))
        self._rows_of = len(self.records)

    def _mark_of(self, lone: Lone) -> Mark[float]:
        number = -1 if self._mark is None else self._mark.number
        return Mark(number, lone[0], len(self.steps), lone[1][-1])


# -- Many instants in one go: each of one plain contact alone, with all that follows from it.


class FlatStride:
    """Carries out the ordinary instants of a run: one certain contact, no other at its time, nothing that touches.

    What it does is what the general loop would do, number for number; whatever is not ordinary is left where it is.

    Args:
        flights: the flights.
        history: takes the contacts up.
        meetings: makes the predictions.
    """

    def __init__(self, flights: FlatFlights, history: FlatHistory, meetings: FlatMeetings) -> None:
        self._flights = flights
        self._history = history
        self._meetings = meetings

    def __call__(self, most: float, before: float) -> int:
        """Carries out instants as long as they are ordinary; gives their number.

        Args:
            most: how many at most.
            before: a time that all come before.
        """
        f, crowd = self._flights, self._meetings.crowd
        alone = self._meetings.alone if crowd is None else crowd.alone
        records = self._history.items
        heap, flights, serial, last, n = f.heap, f.flights, f.serial, f.last, f.n
        f.take_up()
        shifted, ahead = f.shifted, f.ahead
        stale, slides = f.stale, self._meetings.slides
        done = 0
        while done < most and heap and not slides:
            first = heap[0]
            time, _, i, j, si, sj, wait, _ = first
            if serial[i] != si or serial[j] != sj:
                heappop(heap)
                continue
            if crowd is not None and time >= crowd.cells.next_crossing < inf:
                crowd.cross()
                continue
            if wait is None or not time < before or (shifted and (i in shifted or j in shifted)):
                break
            if j < n and last[i] < last[j]:
                break
            heappop(heap)
            while heap and heap[0][0] <= time and stale(heap[0]):
                heappop(heap)
            if heap and heap[0][0] <= time:
                heappush(heap, first)
                break
            if j >= n:
                rebound(f, i, j, time, wait)
                records.append((time, flights[i], None, j))
                ahead.add(i)
            else:
                strike(f, i, j, time, wait)
                if i > j:
                    i, j = j, i
                records.append((time, flights[i], flights[j], j))
                ahead.update((i, j))
            alone(i, j)
            done += 1
        return done


# -- The event loop of a flat run: ordinary instants in strides, every other by the general loop.

EVENTS_A_LOOK = 256
"""Events between looks at the clock, at most."""


class FlatDecider(PlainDecider[float]):
    """See `PlainDecider`; ordinary instants are not asked about."""

    def _parts(self, numbers: NumberSystem[float]) -> tuple[FlatHistory, FlatQueue, FlatMeetings]:
        self.flights = FlatFlights(self.scene, self.state)
        self._kept = FlatHistory(self.flights)
        queue = FlatQueue(self.flights)
        meetings = FlatMeetings(self.scene, self.state, queue, self._kept.plan, numbers, self.ask, self.flights)
        self.plain_stride = FlatStride(self.flights, self._kept, meetings)
        return self._kept, queue, meetings

    def do(self, step: Step) -> None:
        """Carries out a step and logs it."""
        super().do(step)
        if isinstance(step, Go):
            self.flights.changed(step.bodies)
        elif isinstance(step, Kick):
            self.flights.changed(i for link in step.links for i in link.circles)
        else:
            self.flights.changed(self.bodies)

    def _clock(self) -> float:
        """See `PlainDecider`."""
        newest = self._kept.items[-1]
        return newest.mark.time if isinstance(newest, Record) else newest[0]

    def _flights(self) -> list[tuple[float, ...]]:
        """See `PlainDecider`."""
        self.flights.sync()
        return super()._flights()

    @property
    def finish(self) -> Callable[[], None]:
        """Puts every contact into the general loop's terms."""
        return self._kept.unfold


class FlatGatherer(Gatherer[float, float]):
    """See `Gatherer`; before it gathers an instant, the ordinary ones up to it are carried out."""

    decider: FlatDecider

    def gather(self, last: int) -> Instant | Stop | None:
        """See `Gatherer`; None also after a stride."""
        self.decider.pass_on()
        slides = self.decider.meetings.slides
        if not self._touching and (self.decider.plain_stride(self._most(), self._before()) or slides):
            for link in slides:
                self._touching.add(link)
            slides.clear()
            return None
        self.decider.flights.sync()
        return super().gather(last)

    def _before(self) -> float:
        """A double before which no limit in time lies; infinite where there is none."""
        limit = self._time_limit()
        return inf if limit is None else self._bounds(limit[0])[0]

    def _most(self) -> float:
        """How many events may come before a limit on them, the reversal, or the next look at the clock."""
        records, due, most = len(self.history.records), self.scene.reverse_after, EVENTS_A_LOOK
        if self.limits.events is not None:
            most = min(most, self.limits.events - records)
        if due is not None and self.history.reversal is None:
            most = min(most, due - records - 1)
        return most


class FlatLoop(Loop[float, float]):
    """See `Loop`."""

    def __init__(self, scene: Scene, decider: FlatDecider, limits: Limits, progress: OnProgress | None) -> None:
        super().__init__(scene, decider, limits, progress)
        self.gatherer = FlatGatherer(scene, decider, limits, self.resolver.touching)


def follows(scene: Scene, policy: Policy | None) -> bool:
    """Whether a run of a scene can be flat: circles, walls that stand, a policy that learns nothing of one contact."""
    return (
        not scene.pockets
        and not scene.arcs
        and scene.gravity is None
        and not scene.moving_walls
        and not scene.other_walls
        and scene.restitution.sign() != 0
        and policy is None
        and isinstance(policy_for(scene.tie_policy), Simultaneous | Sequential)
    )
