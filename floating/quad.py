"""The event-driven engine in double-double arithmetic: 106 bits, to see how far twice the bits carry."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf, nan, nextafter
from typing import SupportsFloat

import numpy as np
from numpy.typing import NDArray

from ..exact.laws.formulas import advance
from ..exact.numbers.system import NumberSystem
from ..scenarios.numbers.precision import Double
from ..scenarios.numbers.quantity import Quantity, Real
from ..scenarios.trajectory import Motion
from .double_double import DoubleDouble
from .plain.event_engine import EventEngine
from .plain.run import Passed

ZERO = DoubleDouble(0.0)


class Quads:
    """The system of double-double numbers: every sign is an answer, perhaps a wrong one."""

    def constant(self, q: Quantity) -> DoubleDouble:
        """The nearest double, and the double nearest to what it leaves.

        >>> QUADS.constant(Quantity.of("1/10"))
        DoubleDouble(0.1, -5.551115123125783e-18)
        """
        high = float(q)
        return DoubleDouble(high, float(q - Quantity.of(Fraction(high))))

    def root(self, value: DoubleDouble) -> DoubleDouble:
        """The square root; nan below zero."""
        return DoubleDouble(nan) if value < ZERO else value.sqrt()

    def sign(self, value: DoubleDouble) -> int:
        """The sign of the number."""
        return (value > ZERO) - (value < ZERO)

    def bounds(self, value: DoubleDouble) -> tuple[float, float]:
        """The doubles around the number."""
        return nextafter(value.hi, -inf), nextafter(value.hi, inf)


QUADS = Quads()


class QuadTime(Double):
    """The time of something that happened in a run: as a float, the nearest double.

    Attributes:
        value: all of its 106 bits.
        instant: the number of its instant.
    """

    value: DoubleDouble
    instant: int

    @classmethod
    def of(cls, value: DoubleDouble, instant: int) -> QuadTime:
        """The time of an instant."""
        time = cls(value.hi)
        time.value, time.instant = value, instant
        return time


class QuadMotion:
    """Straight flight between knots, computed with 106 bits.

    Args:
        knots: for each circle (t, x, y, vx, vy, number of the instant), ascending.
        end: the last time that may be asked for.
    """

    def __init__(self, knots: Sequence[Sequence[Passed[DoubleDouble]]], end: Real) -> None:
        self.knots = knots
        self.end = end

    def state(self, time: SupportsFloat) -> list[tuple[float, float, float, float]]:
        """(x, y, vx, vy) of every circle, rounded to doubles; at a time of this run, as its event leaves it.

        Raises:
            ValueError: for a time before 0 or after the end.
        """
        at, end = _quad(time), _quad(self.end)
        if at < ZERO or at > end:
            raise ValueError(f"time {float(time)!r} is outside of the run: it lasts from 0 to {float(self.end)!r}")
        rows: list[tuple[float, float, float, float]] = []
        for knots in self.knots:
            if isinstance(time, QuadTime):
                k = bisect_right(knots, time.instant, key=_instant) - 1
            else:
                k = bisect_right(knots, at, key=_time) - 1
            t, x, y, vx, vy, _ = knots[max(k, 0)]
            lag = at - t
            rows.append((float(advance(x, vx, lag)), float(advance(y, vy, lag)), float(vx), float(vy)))
        return rows

    def sample(self, times: Sequence[float]) -> NDArray[np.float64]:
        """Shape (times, circles, 4): the same for many times.

        Raises:
            ValueError: as `state`.
        """
        return np.array([self.state(time) for time in times], dtype=np.float64).reshape(len(times), len(self.knots), 4)


def _instant(knot: Passed[DoubleDouble]) -> int:
    return knot[-1]


def _time(knot: Passed[DoubleDouble]) -> DoubleDouble:
    return knot[0]


def _quad(time: SupportsFloat) -> DoubleDouble:
    if isinstance(time, QuadTime):
        return time.value
    return QUADS.constant(time) if isinstance(time, Quantity) else DoubleDouble(float(time))


@dataclass(frozen=True)
class QuadEngine(EventEngine[DoubleDouble]):
    """The event loop of the exact engine, fed double-doubles (see `EventEngine`).

    >>> from truebreak.scenarios import Circle, Scene
    >>> run = QuadEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 1)]))
    >>> run.events[0].time, run.events[0].time.value.lo  # 4 - sqrt(3)
    (2.267949192431123, -1.00350842218069e-16)
    """

    @property
    def name(self) -> str:
        """The engine's name."""
        return "quad"

    @property
    def bits(self) -> int:
        """106."""
        return 106

    @property
    def numbers(self) -> NumberSystem[DoubleDouble]:
        """Double-doubles."""
        return QUADS

    def motion(self, knots: Sequence[Sequence[Passed[DoubleDouble]]], end: Real) -> Motion:
        """See `EventEngine.motion`."""
        return QuadMotion(knots, end)

    def shown(self, time: DoubleDouble, instant: int) -> QuadTime:
        """See `EventEngine.shown`."""
        return QuadTime.of(time, instant)
