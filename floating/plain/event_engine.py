"""What event-driven engines without certainty share: the event loop, fed numbers of one system that always answers."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, Generic, Protocol, SupportsFloat, TypeVar

from ...exact.numbers.system import NumberSystem, Ordered
from ...exact.policies import Policy
from ...exact.simulation.collecting import SELDOM_COLLECTED
from ...scenarios.engine import EventDriven
from ...scenarios.numbers.precision import Double
from ...scenarios.numbers.quantity import QuantityLike, Real
from ...scenarios.scene import Scene
from ...scenarios.trajectory import Motion, OnProgress, Trajectory
from ..knots import DoubleMotion
from .decider import PlainDecider
from .run import Passed, run_plain
from .state import PlainState


class Counted(Ordered, SupportsFloat, Protocol):
    """A number of finite precision, which has a double next to it."""


F = TypeVar("F", bound=Counted)


class EventEngine(EventDriven, ABC, Generic[F]):
    """The event loop of the exact engine in one number system.

    Inputs are rounded to the system's nearest numbers; every sign is taken at its word; equal event times are a tie;
    an overlap that rounding has made collides at once.
    """

    @property
    @abstractmethod
    def name(self) -> str:
        """The engine's name."""

    @property
    @abstractmethod
    def numbers(self) -> NumberSystem[F]:
        """The system."""

    @property
    def parameters(self) -> Mapping[str, Any]:
        """Its settings, all of them."""
        return {}

    @property
    def rounds_input(self) -> bool:
        """True: a scene is rounded to the system's nearest numbers."""
        return True

    def motion(self, knots: Sequence[Sequence[Passed[F]]], end: Real) -> Motion:
        """The motion, from the knots of each circle and the last time that may be asked for: here, in doubles."""
        rows = [[(float(t), float(x), float(y), float(vx), float(vy)) for t, x, y, vx, vy, _ in row] for row in knots]
        return DoubleMotion(rows, float(end))

    def shown(self, time: F, instant: int) -> Real:
        """A time of the trajectory, from a number and the number of its instant."""
        return Double(float(time))

    def run(
        self,
        scene: Scene,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """The history as these numbers see it (see `Engine.run`)."""
        with SELDOM_COLLECTED:
            return self.run_with(scene, None, until=until, events=events, progress=progress)

    def run_with(
        self,
        scene: Scene,
        policy: Policy | None,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """As `run`, with a policy of the caller's in place of the scene's."""
        return run_plain(
            scene,
            self.name,
            self.parameters,
            PlainDecider(scene, PlainState(scene, self.numbers), self.numbers),
            self.motion,
            self.shown,
            until=until,
            events=events,
            progress=progress,
            policy=policy,
        )
