"""The event-driven engine in doubles: what a careful simulation in floating point does."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from math import nan, sqrt
from typing import Any, ClassVar

from ..exact.numbers.system import NumberSystem
from ..scenarios.numbers.quantity import Quantity
from ..scenarios.trajectory import Motion
from .event_engine import EventEngine
from .knots import DoubleMotion


class Doubles:
    """The system of doubles: every sign is an answer, perhaps a wrong one."""

    name: ClassVar[str] = "double"

    def constant(self, q: Quantity) -> float:
        """The nearest double."""
        return float(q)

    def root(self, value: float) -> float:
        """The square root; nan below zero."""
        return sqrt(value) if value >= 0.0 else nan

    def sign(self, value: float) -> int:
        """The sign of the double."""
        return (value > 0.0) - (value < 0.0)

    def bounds(self, value: float) -> tuple[float, float]:
        """A double is its own bound."""
        return value, value

    def at(self, bits: int) -> AbstractContextManager[None]:
        """Doubles have 53 bits, whatever is asked."""
        return nullcontext()


DOUBLES = Doubles()


@dataclass(frozen=True)
class DoubleEngine(EventEngine):
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
    def numbers(self) -> NumberSystem:
        """Doubles."""
        return DOUBLES

    def motion(self, knots: Sequence[Sequence[tuple[Any, ...]]], end: Any) -> Motion:
        """See `EventEngine.motion`."""
        return DoubleMotion([[knot[:5] for knot in row] for row in knots], float(end))
