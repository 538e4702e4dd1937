"""The event-driven engine in doubles: what a careful simulation in floating point does."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan, sqrt

from ..exact.machine import Machine
from ..exact.policies import Policy
from ..scenarios.engine import Declared
from ..scenarios.quantity import QuantityLike
from ..scenarios.scene import Scene
from ..scenarios.trajectory import OnProgress, Trajectory
from .knots import DoubleMotion
from .plain_decider import PlainDecider
from .plain_run import run_plain


def sign(x: float) -> int:
    """The sign of a double: always an answer, perhaps a wrong one."""
    return (x > 0.0) - (x < 0.0)


def root(x: float) -> float:
    """The square root; nan below zero."""
    return sqrt(x) if x >= 0.0 else nan


def bounds(time: float) -> tuple[float, float]:
    """A double is its own bound."""
    return time, time


@dataclass(frozen=True)
class DoubleEngine(Declared):
    """The event loop of the exact engine, fed doubles.

    Inputs are rounded to the nearest doubles; every sign is taken at its word; equal event times are a tie; an
    overlap that rounding has made collides at once.

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
    def rounds_input(self) -> bool:
        """True: a scene is rounded to the nearest doubles."""
        return True

    def run(
        self,
        scene: Scene,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """The history as doubles see it (see `Engine.run`)."""
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
            {},
            PlainDecider(scene, Machine(scene, float, root), sign, bounds),
            lambda knots, end: DoubleMotion([[knot[:5] for knot in row] for row in knots], float(end)),
            lambda time, _: float(time),
            until=until,
            events=events,
            progress=progress,
            policy=policy,
        )
