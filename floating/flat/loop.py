"""The event loop of a flat run: ordinary instants in strides, every other by the general loop."""

from __future__ import annotations

from collections.abc import Callable
from math import inf

from ...exact.numbers.system import NumberSystem
from ...exact.policies import Policy, policy_for
from ...exact.policies.sequential import Sequential
from ...exact.policies.simultaneous import Simultaneous
from ...exact.replay.state import State
from ...exact.replay.steps import Go, Kick, Step
from ...exact.simulation.history import Record
from ...exact.simulation.instants.gathering import Gatherer
from ...exact.simulation.instants.instant import Instant
from ...exact.simulation.limits import Limits
from ...exact.simulation.loop import Loop
from ...scenarios.scene import Scene
from ...scenarios.trajectory import OnProgress, Stop
from ..plain.decider import PlainDecider
from .flights import FlatFlights
from .history import FlatHistory
from .meetings import FlatMeetings
from .queue import FlatQueue
from .stride import FlatStride

EVENTS_A_LOOK = 256
"""Events between looks at the clock, at most."""


class FlatDecider(PlainDecider[float]):
    """See `PlainDecider`; ordinary instants are not asked about."""

    def __init__(self, scene: Scene, state: State[float], numbers: NumberSystem[float]) -> None:
        super().__init__(scene, state, numbers)
        vars(self.meetings).clear()  # others take their place
        self.flights = FlatFlights(scene, state)
        self.history = self._kept = FlatHistory(self.flights)
        self.queue = FlatQueue(self.flights)
        plan = self.history.plan
        self.meetings = FlatMeetings(scene, state, self.queue, plan, numbers, self.ask, self.flights)
        self.plain_stride = FlatStride(self.flights, self._kept, self.meetings)

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
        if not self._touching and self.decider.plain_stride(self._most(), self._before()):
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
    """Whether a run of a scene can be flat: no pockets, and a tie policy that learns nothing from a contact alone."""
    return not scene.pockets and policy is None and isinstance(policy_for(scene.tie_policy), Simultaneous | Sequential)
