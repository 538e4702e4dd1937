"""The event-driven engine in double-double arithmetic: 106 bits, to see how far twice the bits carry."""

from __future__ import annotations

from bisect import bisect_right
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf, isfinite, nan, nextafter, sqrt
from typing import TYPE_CHECKING, SupportsFloat

from flint import arb

from ..exact.certified.filtered import BIG, TINY, DoubleFilter
from ..exact.laws.formulas import advance
from ..exact.numbers.double_pairs import SPLITTER, quick_two_sum, two_product
from ..exact.numbers.system import NumberSystem
from ..exact.replay.contact import Body, Gravity, Link
from ..exact.replay.state import ReplayState
from ..exact.simulation.prediction import ArrivalQueue, FloatLine, Predictor
from ..scenarios.lazy import Later
from ..scenarios.numbers.precision import Double, at_bits
from ..scenarios.numbers.quantity import Quantity, Real
from ..scenarios.scene import Scene
from ..scenarios.trajectory import Motion
from .knots import EndlessBounces, beside, ends_of
from .plain import EventEngine, Passed, PlainDecider

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
        return _sum(self.hi, self.lo, other.hi, other.lo)

    def __sub__(self, other: DoubleDouble) -> DoubleDouble:
        return _sum(self.hi, self.lo, -other.hi, -other.lo)

    def __mul__(self, other: DoubleDouble) -> DoubleDouble:
        a, b = self.hi, other.hi
        product = a * b
        scaled = SPLITTER * a
        high_a = scaled - (scaled - a)
        low_a = a - high_a
        scaled = SPLITTER * b
        high_b = scaled - (scaled - b)
        low_b = b - high_b
        error = ((high_a * high_b - product) + high_a * low_b + low_a * high_b) + low_a * low_b
        error = error + (a * other.lo + self.lo * b)
        high = product + error
        return DoubleDouble(high, error - (high - product))

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


def _sum(a: float, low_a: float, b: float, low_b: float) -> DoubleDouble:
    """The sum of two pairs: `two_sum` of their parts and `quick_two_sum` twice, written out: a run takes a million."""
    total = a + b
    part = total - a
    error = (a - (total - part)) + (b - part)
    low = low_a + low_b
    part = low - low_a
    rest = (low_a - (low - part)) + (low_b - part)
    error = error + low
    high = total + error
    rest = error - (high - total) + rest
    total = high + rest
    return DoubleDouble(total, rest - (total - high))


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


class QuadNumber(Double):
    """A number of a run: as a float, the nearest double.

    Attributes:
        value: all of its 106 bits.
    """

    value: DoubleDouble

    @classmethod
    def near(cls, value: DoubleDouble) -> QuadNumber:
        """The number.

        >>> third = QuadNumber.near(QUADS.constant(Quantity.of("1/3")))
        >>> float(third) == 1 / 3, third.digits(30), Double(1 / 3).digits(30)
        (True, '0.333333333333333333333333333333', '0.333333333333333314829616256247')
        """
        number = cls(value.hi)
        number.value = value
        return number

    def ball(self, bits: int) -> arb:
        """All of its bits."""
        with at_bits(max(bits, 2 * 106)):
            return arb(self.value.hi) + arb(self.value.lo)


class QuadTime(QuadNumber):
    """The time of something that happened in a run.

    Attributes:
        instant: the number of its instant; None of the end of infinitely many bounces.
    """

    instant: int | None

    @classmethod
    def of(cls, value: DoubleDouble, instant: int | None) -> QuadTime:
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
        slides: what there is of half of gravity along the slope that a circle slides down from its last knot on.
        bounced: by circle, its knots before which infinitely many bounces come, with these.
    """

    def __init__(
        self,
        knots: Sequence[Sequence[Passed[DoubleDouble]]],
        end: Real,
        falling: Gravity[DoubleDouble] | None = None,
        pegs: Collection[int] = (),
        carried: Mapping[int, frozenset[int]] | None = None,
        slides: Mapping[int, Gravity[DoubleDouble]] | None = None,
        bounced: Mapping[int, Mapping[int, EndlessBounces]] | None = None,
    ) -> None:
        self.knots = knots
        self.end = end
        self.falling = falling
        self.pegs = pegs
        self.carried, self.slides, self.bounced = carried or {}, slides or {}, bounced or {}

    def state(self, time: SupportsFloat) -> list[tuple[float, float, float, float]]:
        """(x, y, vx, vy) of every circle, each a double that keeps its 106 bits; at a time of this run, as its event
        leaves it.

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
            falls = i not in self.pegs and k not in self.carried.get(i, ())
            bend = self.falling if falls else self.slides.get(i) if k == len(knots) - 1 else None
            flown = (advance(x, vx, lag), advance(y, vy, lag), vx, vy)
            x, y, vx, vy = map(QuadNumber.near, flown if bend is None else bend.flown((x, y, vx, vy), lag))
            bounces = self.bounced.get(i, {}).get(k)
            rows.append((x, y, vx, vy) if bounces is None else beside((x, y, vx, vy), bounces, float(at)))
        return rows

    @property
    def ends(self) -> dict[tuple[int, int], tuple[float, float]]:
        """By circle and the place of the knot after them: when infinitely many bounces begin, and when they end."""
        return ends_of(self.bounced)

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
    if isinstance(time, QuadTime) and time.instant is not None:
        return max(bisect_right(knots, time.instant, key=_instant) - 1, 0)
    return max(bisect_right(knots, at, key=_time) - 1, 0)


def _quad(time: SupportsFloat) -> DoubleDouble:
    if isinstance(time, QuadTime):
        return time.value
    return QUADS.constant(time) if isinstance(time, Quantity) else DoubleDouble(float(time))


# -- What doubles exclude beyond all doubt is not asked for in 106 bits.
#
# The double next to a number is off by less than the 2u that `DoubleFilter` allows, and what it says of all numbers so
# near is true of these. Its bounds are twice what they must be, and that is far more than what 106 bits round: where a
# sign is certain for it, these have that sign, and where a time is, it is theirs.


class QuadPredictor(Predictor[DoubleDouble]):
    """Predictions that are made only of what doubles do not exclude. See `Predictor`.

    Left out is what is surely missed, and what surely comes after a hit that surely ends the flight: that would be
    queued, and be stale when its turn came. So every run is the same, to the last bit, as one without.
    """

    def __init__(
        self,
        scene: Scene,
        state: ReplayState[DoubleDouble],
        queue: ArrivalQueue[DoubleDouble],
        plan: Counter[str],
        bounds: Callable[[DoubleDouble], tuple[float, float]],
        unsure: Callable[[Link], None],
    ) -> None:
        super().__init__(scene, state, queue, plan, bounds, unsure)
        self._filter = DoubleFilter()
        self._reaches: list[list[float]] = []
        self._lines: dict[tuple[int, int, bool], FloatLine] = {}
        self._tables: dict[tuple[int, Sequence[int]], tuple[list[FloatLine], list[FloatLine]]] = {}
        self._kinds(state)

    def _kinds(self, state: ReplayState[DoubleDouble]) -> None:
        """Numbers the radii, and has the sums of any two."""
        bodies, radii = [*state.bodies.values(), *state.pockets], dict[tuple[DoubleDouble, bool], int]()
        for body in bodies:
            body.kind = radii.setdefault((body.r, body.is_pocket), len(radii))
        some = {body.kind: body for body in bodies}
        self._reaches = [[float(self.reach(some[k], some[j])) for j in range(len(radii))] for k in range(len(radii))]

    def admit(self, bodies: Iterable[Body[DoubleDouble]]) -> None:
        """Sets the doubles of circles whose flights are new; None where they are beyond what the bounds allow."""
        for body in bodies:
            x, y, vx, vy, t = map(float, body.q)
            body.f = None
            if isfinite(x + y + vx + vy + t) and body.flight.late is None:
                self._filter.take(body, (x, y, vx, vy, t, 0.0))

    def pairs(self, a: Body[DoubleDouble], others: list[Body[DoubleDouble]], standing: Collection[Link]) -> None:
        """See `Predictor.pairs`."""
        if self.falling is None and a.f is not None and others:
            found, unclear = self._filter.pairs(a, others, self._reaches[a.kind])
            near = {id(b) for b in unclear}
            near.update(id(b) for low, _, b in found if low <= a.until and low <= b.until)
            others = [b for b in others if id(b) in near]
        super().pairs(a, others, standing)

    def walls(self, a: Body[DoubleDouble], walls: Sequence[int], standing: Collection[Link]) -> None:
        """See `Predictor.walls`."""
        super().walls(a, self._near(a, walls), standing)

    def meet_faces(self, a: Body[DoubleDouble], standing: Collection[Link]) -> None:
        """See `Predictor.meet_faces`."""
        for k in self._near(a, self.faces):
            self.face(a, k, standing)

    def _near(self, a: Body[DoubleDouble], walls: Sequence[int]) -> Sequence[int]:
        """Those of some walls, or faces, that a circle may be the first to hit."""
        if self.falling is not None or a.f is None or len(walls) == 0:
            return walls
        plain, faces = self._seen(a, walls)
        found, unclear = self._filter.walls(a, plain)
        among, open_faces = self._filter.faces(a, faces)
        found += among
        ends = min([a.until, *(high for _, high, _ in found)])  # what stands at gap zero is never surely hit
        near = {*unclear, *open_faces, *(k for low, _, k in found if low <= ends)}
        return [k for k in walls if k in near]

    def _seen(self, a: Body[DoubleDouble], walls: Sequence[int]) -> tuple[list[FloatLine], list[FloatLine]]:
        """Walls, and faces, as a circle sees them."""
        key = a.index, walls
        found = self._tables.get(key) if isinstance(walls, range) else None
        if found is None:
            lines = [self._float_line(a, k) for k in walls]
            found = [line for line in lines if line.wall < self.wall_count], lines
            found = found[0], lines[len(found[0]) :]
            if isinstance(walls, range):
                self._tables[key] = found
        return found

    def _float_line(self, a: Body[DoubleDouble], wall: int) -> FloatLine:
        """The doubles of a wall; where these are beyond what the bounds allow nothing is ever clear."""
        key = a.kind, wall, self.state.sides.negative(a.index, wall)
        found = self._lines.get(key)
        if found is None:
            told = x0, y0, nx, ny, offset = tuple(map(float, self.line(a, wall)))
            norm = abs(nx) + abs(ny)
            size = norm * (abs(x0) + abs(y0)) + abs(offset)
            if not (size < BIG and TINY < norm < BIG and all(value == 0.0 or abs(value) > TINY for value in told)):
                norm = size = inf
            found = self._lines[key] = FloatLine(wall, x0, y0, nx, ny, offset, norm, size)
        return found


class QuadDecider(PlainDecider[DoubleDouble]):
    """Decides in double-doubles. See `PlainDecider`."""

    predictor = QuadPredictor

    def refresh(self, bodies: Iterable[Body[DoubleDouble]]) -> None:
        """See `PlainDecider.refresh`."""
        bodies = [*bodies]
        super().refresh(bodies)
        predictor = self.meetings.predictor
        if isinstance(predictor, QuadPredictor):
            predictor.admit(bodies)


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

    def decider(self, scene: Scene, state: ReplayState[DoubleDouble]) -> PlainDecider[DoubleDouble]:
        """See `EventEngine.decider`."""
        return QuadDecider(scene, state, QUADS)

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
        slides: Mapping[int, Gravity[DoubleDouble]],
        bounced: Mapping[int, Mapping[int, EndlessBounces]],
    ) -> Motion:
        """See `EventEngine.fallen_motion`."""
        return QuadMotion(knots, end, falling, pegs, carried, slides, bounced)

    def shown(self, time: DoubleDouble, instant: int | None) -> QuadTime:
        """See `EventEngine.shown`."""
        return QuadTime.of(time, instant)
