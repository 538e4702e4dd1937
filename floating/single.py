"""The event-driven engine in single precision: 24 bits, in which many game engines compute."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import isfinite
from typing import Any

import numpy as np

from ..exact.numbers.system import Nearest, NumberSystem
from ..exact.simulation.policies import Policy
from ..scenarios.errors import SceneError
from ..scenarios.numbers.quantity import Quantity, QuantityLike
from ..scenarios.scene import Scene
from ..scenarios.trajectory import OnProgress, Trajectory
from .plain import EventEngine


class Singles(Nearest):
    """The system of IEEE 754 binary32: every sign is an answer, perhaps a wrong one."""

    def constant(self, q: Quantity) -> np.float32:
        """The nearest single, ties to even.

        Raises:
            SceneError: beyond the range of singles.

        >>> float(SINGLES.constant(Quantity.of("1/10")))
        0.10000000149011612
        """
        double = float(q)
        with np.errstate(over="ignore"):
            single = np.float32(double)
        if not isfinite(single):
            raise SceneError(f"{q} is beyond single precision, which ends at 3.4e38; scale the scene down")
        for end in (-np.inf, np.inf):
            other = np.nextafter(single, np.float32(end))
            if float(single) + float(other) == 2 * double and other != single:
                # Half-way: the double may have been rounded onto it, so the exact number decides.
                side = (q - Quantity.of(Fraction(double))).sign()
                return single if side == 0 else max(single, other) if side > 0 else min(single, other)
        return single

    def root(self, value: np.float32) -> np.float32:
        """The square root; nan below zero."""
        return np.sqrt(value) if value >= 0 else np.float32(np.nan)


SINGLES = Singles()


@dataclass(frozen=True)
class SingleEngine(EventEngine[Any]):
    """The event loop of the exact engine, fed singles (see `EventEngine`); states between events in doubles.

    >>> from truebreak.scenarios import Circle, Scene
    >>> float(SingleEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 1)])).events[0].time)
    2.267949104309082
    """

    @property
    def name(self) -> str:
        """The engine's name."""
        return "single"

    @property
    def bits(self) -> int:
        """24."""
        return 24

    @property
    def numbers(self) -> NumberSystem[Any]:
        """Singles."""
        return SINGLES

    def run_with(
        self,
        scene: Scene,
        policy: Policy | None,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """As `EventEngine.run_with`; what overflows goes on as infinity, without a warning."""
        with np.errstate(all="ignore"):
            return super().run_with(scene, policy, until=until, events=events, progress=progress)
