"""The event-driven engine in doubles: what a careful simulation in floating point does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import nan, sqrt

from ..exact.numbers.system import Nearest, NumberSystem
from ..exact.simulation.policies import Policy
from ..scenarios.lazy import Late
from ..scenarios.numbers.quantity import Quantity, QuantityLike, Real
from ..scenarios.scene import Scene
from ..scenarios.trajectory import Motion, OnProgress, Trajectory
from .flat.flat_loop import FlatDecider, FlatLoop, follows
from .knots import DoubleMotion
from .plain import EventEngine, Passed, PlainState, run_plain


class Doubles(Nearest):
    """The system of doubles: every sign is an answer, perhaps a wrong one."""

    def constant(self, q: Quantity) -> float:
        """The nearest double."""
        return float(q)

    def root(self, value: float) -> float:
        """The square root; nan below zero."""
        return sqrt(value) if value >= 0.0 else nan


DOUBLES = Doubles()


@dataclass(frozen=True)
class DoubleEngine(EventEngine[float]):
    """The event loop of the exact engine, fed doubles (see `EventEngine`).

    >>> from truebreak.scenarios import Circle, Scene
    >>> float(DoubleEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 1)])).events[0].time)
    2.267949192431123
    """

    @property
    def name(self) -> str:
        """The engine's name."""
        return "double"

    @property
    def bits(self) -> int:
        """53."""
        return 53

    @property
    def numbers(self) -> NumberSystem[float]:
        """Doubles."""
        return DOUBLES

    def motion(self, knots: Sequence[Sequence[Passed[float]]], end: Real) -> Motion:
        """See `EventEngine.motion`; made when it is first asked."""
        return DoubleMotion(Late(len(knots), lambda: ([knot[:5] for knot in row] for row in knots)), float(end))

    def run_with(
        self,
        scene: Scene,
        policy: Policy | None,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """As `EventEngine.run_with`, on flat flights where that can be (see `follows`)."""
        if not follows(scene, policy):
            return super().run_with(scene, policy, until=until, events=events, progress=progress)
        inner = scene.surfaces
        decider = FlatDecider(inner, PlainState(inner, DOUBLES), DOUBLES)
        return run_plain(
            scene,
            self.name,
            self.parameters,
            decider,
            self.motion,
            self.shown,
            until=until,
            events=events,
            progress=progress,
            loop=lambda limits: FlatLoop(inner, decider, limits, progress),
        )
