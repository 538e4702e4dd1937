"""The event-driven engine in double-double arithmetic: 106 bits, to see how far twice the bits carry."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf, isfinite, nan, nextafter, sqrt
from typing import TYPE_CHECKING, SupportsFloat

from ..exact.laws.formulas import advance
from ..exact.numbers.double_pairs import quick_two_sum, two_product, two_sum
from ..exact.numbers.system import NumberSystem
from ..exact.replay.contact import Gravity
from ..scenarios.lazy import Later
from ..scenarios.numbers.precision import Double
from ..scenarios.numbers.quantity import Quantity, Real
from ..scenarios.trajectory import Motion
from .plain import EventEngine, Passed

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
else:
    np = Later("numpy")

# -- Numbers of 106 bits as unevaluated sums of two doubles.
#
# The operations are those of T. J. Dekker, *A floating-point technique for extending the available precision*,
# Numerische Mathematik 18 (1971), in the forms of Y. Hida, X. S. Li and D. H. Bailey, *Algorithms for quad-double
# precision floating point arithmetic*, ARITH-15 (2001); each is off by a few units of 2**-104, relatively.


class DoubleDouble:
    """hi + lo, with |lo| at most half a unit in the last place of hi.

    >>> third = DoubleDouble(1.0) / DoubleDouble(3.0)
    >>> third.hi, third.lo
    (0.3333333333333333, 1.850371707708594e-17)
    >>> float(third * DoubleDouble(3.0) - DoubleDouble(1.0))
    0.0
    """

    __slots__ = ("hi", "lo")

    def __init__(self, hi: float, lo: float = 0.0) -> None:
        self.hi = hi
        self.lo = lo

    def __float__(self) -> float:
        return self.hi

    def __repr__(self) -> str:
        return f"DoubleDouble({self.hi!r}, {self.lo!r})"

    def __neg__(self) -> DoubleDouble:
        return DoubleDouble(-self.hi, -self.lo)

    def __add__(self, other: DoubleDouble) -> DoubleDouble:
        high, low = two_sum(self.hi, other.hi)
        low_high, low_low = two_sum(self.lo, other.lo)
        high, low = quick_two_sum(high, low + low_high)
        return DoubleDouble(*quick_two_sum(high, low + low_low))

    def __sub__(self, other: DoubleDouble) -> DoubleDouble:
        return self + DoubleDouble(-other.hi, -other.lo)

    def __mul__(self, other: DoubleDouble) -> DoubleDouble:
        high, low = two_product(self.hi, other.hi)
        return DoubleDouble(*quick_two_sum(high, low + (self.hi * other.lo + self.lo * other.hi)))

    def __truediv__(self, other: DoubleDouble) -> DoubleDouble:
        first = self.hi / other.hi
        if not isfinite(first):
            return DoubleDouble(first)
        rest = self - other * DoubleDouble(first)
        second = rest.hi / other.hi
        rest = rest - other * DoubleDouble(second)
        high, low = quick_two_sum(first, second)
        return DoubleDouble(high, low) + DoubleDouble(rest.hi / other.hi)

    def sqrt(self) -> DoubleDouble:
        """The square root of a number that is not negative (Karp's form of Newton's step)."""
        if self.hi <= 0.0:
            return DoubleDouble(0.0)
        near = sqrt(self.hi)
        rest = self - DoubleDouble(*two_product(near, near))
        return DoubleDouble(*quick_two_sum(near, rest.hi / (2.0 * near)))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, DoubleDouble) and self.hi == other.hi and self.lo == other.lo

    def __hash__(self) -> int:
        return hash((self.hi, self.lo))

    def __lt__(self, other: DoubleDouble) -> bool:
        return self.hi < other.hi or (self.hi == other.hi and self.lo < other.lo)

    def __gt__(self, other: DoubleDouble) -> bool:
        return other < self

    def __le__(self, other: DoubleDouble) -> bool:
        return self < other or self == other

    def __ge__(self, other: DoubleDouble) -> bool:
        return other <= self


# -- The event-driven engine in double-double arithmetic: 106 bits, to see how far twice the bits carry.

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
        falling: half of gravity; None without.
        pegs: the circles that stand under it.
        carried: by circle, its knots from which on a wall carries it, by their place.
    """

    def __init__(
        self,
        knots: Sequence[Sequence[Passed[DoubleDouble]]],
        end: Real,
        falling: Gravity[DoubleDouble] | None = None,
        pegs: Collection[int] = (),
        carried: Mapping[int, frozenset[int]] | None = None,
    ) -> None:
        self.knots = knots
        self.end = end
        self.falling = falling
        self.pegs = pegs
        self.carried = carried or {}

    def state(self, time: SupportsFloat) -> list[tuple[float, float, float, float]]:
        """(x, y, vx, vy) of every circle, rounded to doubles; at a time of this run, as its event leaves it.

        Raises:
            ValueError: for a time before 0 or after the end.
        """
        at, end = _quad(time), _quad(self.end)
        if at < ZERO or at > end:
            raise ValueError(f"time {float(time)!r} is outside of the run: it lasts from 0 to {float(self.end)!r}")
        rows: list[tuple[float, float, float, float]] = []
        for i, knots in enumerate(self.knots):
            k = _place(knots, time, at)
            t, x, y, vx, vy, _ = knots[k]
            lag = at - t
            if self.falling is not None and i not in self.pegs and k not in self.carried.get(i, ()):
                x, y, vx, vy = map(float, self.falling.flown((x, y, vx, vy), lag))
                rows.append((x, y, vx, vy))
                continue
            rows.append((float(advance(x, vx, lag)), float(advance(y, vy, lag)), float(vx), float(vy)))
        return rows

    def carries(self, place: int, time: SupportsFloat) -> bool:
        """Whether a wall carries a circle, by its place in the scene, from a time on."""
        return _place(self.knots[place], time, _quad(time)) in self.carried.get(place, ())

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


def _place(knots: Sequence[Passed[DoubleDouble]], time: SupportsFloat, at: DoubleDouble) -> int:
    """The knot from which on a circle flies at a time."""
    if isinstance(time, QuadTime):
        return max(bisect_right(knots, time.instant, key=_instant) - 1, 0)
    return max(bisect_right(knots, at, key=_time) - 1, 0)


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

    def fallen_motion(
        self,
        knots: Sequence[Sequence[Passed[DoubleDouble]]],
        end: Real,
        falling: Gravity[DoubleDouble],
        pegs: Collection[int],
        carried: Mapping[int, frozenset[int]],
    ) -> Motion:
        """See `EventEngine.fallen_motion`."""
        return QuadMotion(knots, end, falling, pegs, carried)

    def shown(self, time: DoubleDouble, instant: int) -> QuadTime:
        """See `EventEngine.shown`."""
        return QuadTime.of(time, instant)
