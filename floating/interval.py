"""The event-driven engine in intervals: certifies as much as a width of numbers allows, then says so."""

from __future__ import annotations

import copyreg
import math
from bisect import bisect_right
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from math import inf, nextafter
from typing import TYPE_CHECKING, Any

import mpmath
from flint import arb, fmpq
from mpmath.libmp import mpf_gt, mpf_le, to_float

from ..exact.laws.formulas import advance
from ..exact.numbers import ball
from ..exact.numbers.system import Undecided
from ..exact.replay.contact import Gravity, Round, is_arc, is_pair
from ..exact.replay.landings import Unsharp, falling_zeros, gap_of, within_arc
from ..exact.replay.round_falls import Isolated, RoundFall, Unclear, falling_zero_in_balls, horner, horner_slope
from ..scenarios.engine import ALL_KEYS, EventDriven
from ..scenarios.errors import SceneError
from ..scenarios.numbers.precision import digits_of, hull
from ..scenarios.numbers.quantity import Quantity, QuantityLike
from ..scenarios.scene import Scene
from ..scenarios.trajectory import OnProgress, Trajectory
from .plain import LastBounces, PlainDecider, PlainState, bounced_knots, carried_knots, run_plain

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

MIN_BITS, MAX_BITS = 24, 100_000

QUARTIC_BITS = 64
"""Least precision at which the zeros of quartics are told apart."""

WHOLE = Quantity.of(1)

ZERO: Any = mpmath.iv.mpf(0)
ONE: Any = mpmath.iv.mpf(1)
"""An interval already: what mpmath must convert first, it converts where a Ctrl-C would be dropped."""


class IntervalNumber:
    """A value of an interval run: float() is its middle, `low` and `high` its ends.

    Attributes:
        instant: for the time of something that happened in the run, the number of its instant.
    """

    def __init__(self, value: Any, instant: int | None = None) -> None:
        self.value = value
        self.instant = instant

    def __float__(self) -> float:
        low, high = _ends(self.value)
        return low + (high - low) / 2

    @property
    def low(self) -> float:
        """A double at or below every number in the interval."""
        return bounds(self.value)[0]

    @property
    def high(self) -> float:
        """A double at or above every number in the interval."""
        return bounds(self.value)[1]

    def bounds(self) -> tuple[float, float]:
        """`low` and `high`."""
        return bounds(self.value)

    def text(self) -> str | None:
        """None: an interval is no exact value."""
        return None

    def digits(self, count: int) -> str:
        """The decimals that all numbers in the interval share, at most `count`."""
        return digits_of(self.ball(0), count)

    def ball(self, bits: int) -> arb:
        """A ball around the interval, whatever the precision asked for; nan if an end is infinite."""
        low, high = (arb(mpmath.mp.make_mpf(end)) for end in self.value._mpi_)
        return hull(low, high)

    def __mul__(self, other: Any) -> IntervalNumber:
        return IntervalNumber(self.value * other)

    __rmul__ = __mul__

    def __repr__(self) -> str:
        return f"[{self.low!r}, {self.high!r}]"


def _from_ends(ends: Any) -> Any:
    """The `mpmath.iv` interval between these ends."""
    return mpmath.iv.make_mpf(ends)


def _reduced(value: Any) -> tuple[Any, tuple[Any]]:
    return _from_ends, (value._mpi_,)


copyreg.pickle(type(mpmath.iv.mpf(0)), _reduced)


def bounds(value: Any) -> tuple[float, float]:
    """Doubles at or below, and at or above, every number in an interval."""
    low, high = _ends(value)
    if math.isnan(low) or math.isnan(high):
        return -inf, inf
    return nextafter(low, -inf), nextafter(high, inf)


def _ends(value: Any) -> tuple[float, float]:
    """The ends of an interval, each as a double nearest to it."""
    low, high = value._mpi_
    return to_float(low), to_float(high)


def sign(value: Any) -> int:
    """The sign of every number in an interval.

    mpmath answers None where it does not know; here that is Undecided.

    Raises:
        Undecided: if the interval holds numbers of different signs.
    """
    if (value > ZERO) is True:
        return 1
    if (value < ZERO) is True:
        return -1
    if value.a == ZERO and value.b == ZERO:
        return 0
    raise Undecided


def root(value: Any) -> Any:
    """The square root of a number that is known not to be negative; its interval may reach below zero."""
    iv: Any = mpmath.iv
    if (value >= ZERO) is True:
        return iv.sqrt(value)
    if (value < ZERO) is True:
        raise Undecided
    return iv.mpf([0, iv.sqrt(iv.mpf(value.b)).b])


def enclosure(q: Quantity) -> Any:
    """An exact number as an interval at the working precision."""
    iv: Any = mpmath.iv
    return q.evaluated(lambda r: iv.mpf(int(r.p)) / iv.mpf(int(r.q)), root)


class Intervals:
    """The system of `mpmath.iv` intervals, at its working precision."""

    def constant(self, q: Quantity) -> Any:
        """See `enclosure`."""
        return enclosure(q)

    def root(self, value: Any) -> Any:
        """See `root`."""
        return root(value)

    def sign(self, value: Any) -> int:
        """See `sign`."""
        return sign(value)

    def bounds(self, value: Any) -> tuple[float, float]:
        """See `bounds`."""
        return bounds(value)

    @contextmanager
    def at(self, bits: int) -> Iterator[None]:
        """Intervals of so many bits."""
        saved, mpmath.iv.prec = mpmath.iv.prec, bits
        try:
            yield
        finally:
            mpmath.iv.prec = saved


INTERVALS = Intervals()


class IntervalState(PlainState[Any]):
    """See `PlainState`; which zero of a quartic a fall ends at is certain, or not told."""

    def fall_wait(self, link: Round) -> Any:
        """See `Flights.fall_wait`: in doubles with a bound on their errors, else in balls, then by interval Newton."""
        fall, stood = self.peg_fall(link), self.stood(link)
        if is_pair(link) and not stood and (fall.gap() > ZERO) is not True:
            raise Unsharp(0.0)
        c = gap_of(link, fall, stood)
        for found in self._zeros(link, fall, c):
            if isinstance(found, Unclear):
                raise Unsharp(found.since)
            wait = _narrowed(c, found)
            within = self._within(link, fall, wait)
            if (within > ZERO) is True:
                return wait
            if (within < ZERO) is not True:
                raise Unsharp(bounds(wait)[0])
        return None

    def _within(self, link: Round, fall: RoundFall[Any], wait: Any) -> Any:
        """Whether a circle is within the range of an arc after a time; of what has none, 1."""
        place = fall.after(wait)
        return within_arc(self, link, place.dx, place.dy) if is_arc(link) else self.one

    def _zeros(self, link: Round, fall: RoundFall[Any], c: Sequence[Any]) -> Iterator[Isolated | Unclear]:
        """Where the gap of a contact falls; of two circles, the first time."""

        def beyond(low: fmpq, high: fmpq) -> bool:
            return (self._within(link, fall, _span_of(low, high)) < ZERO) is True

        with ball.precision(max(QUARTIC_BITS, mpmath.iv.prec)):
            balls = [IntervalNumber(value).ball(0) for value in c]
            if is_pair(link):
                found = falling_zero_in_balls(balls)
                return iter(() if found is None else (found,))
            return iter([*falling_zeros(balls, inf, beyond)])


def _span_of(low: float | fmpq, high: float | fmpq) -> Any:
    """What is between two doubles, or two fractions, as an interval."""
    iv: Any = mpmath.iv
    one, two = (
        iv.mpf(int(end.p)) / iv.mpf(int(end.q)) if isinstance(end, fmpq) else iv.mpf(float(end)) for end in (low, high)
    )
    return iv.mpf([one.a, two.b])


def _narrowed(c: Sequence[Any], found: Isolated) -> Any:
    """The falling zero of a polynomial that is the only one between two numbers, as sharply as intervals tell it."""
    iv: Any = mpmath.iv
    wait = _span_of(*found)
    while True:
        middle, slope = iv.mpf(wait.mid), horner_slope(c, wait)
        value = horner(c, middle)
        if (slope < ZERO) is True:
            near = middle - value / slope
            low, high = max(wait.a, near.a), min(wait.b, near.b)
            assert (low <= high) is True, "a zero of a quartic is nowhere: a defect"
        elif (value > ZERO) is True:  # where it does not fall all the way, it is halved
            low, high = middle.a, wait.b
        elif (value < ZERO) is True:
            low, high = wait.a, middle.b
        else:
            return wait
        narrower = iv.mpf([low, high])
        if (narrower.delta < wait.delta * 3 / 4) is not True:
            return narrower
        wait = narrower


class IntervalMotion:
    """Straight flight between knots, in intervals.

    Args:
        knots: for each circle (t, x, y, vx, vy, number of the instant), in intervals, ascending.
        bits: the precision.
        end: the last time that may be asked for.
        falling: half of gravity; None without.
        pegs: the circles that stand under it.
        carried: by circle, its knots from which on a wall carries it, by their place.
        slides: what there is of half of gravity along the slope that a circle slides down from its last knot on.
        bounced: by circle, its knots before which infinitely many bounces come, with these.
        e: the restitution.
    """

    def __init__(
        self,
        knots: Sequence[Sequence[tuple[Any, ...]]],
        bits: int,
        end: Any,
        falling: Gravity[Any] | None = None,
        pegs: Collection[int] = (),
        carried: Mapping[int, frozenset[int]] | None = None,
        slides: Mapping[int, Gravity[Any]] | None = None,
        bounced: Mapping[int, Mapping[int, LastBounces[Any]]] | None = None,
        e: Quantity = WHOLE,
    ) -> None:
        self.knots = knots
        self.bits = bits
        self.end = end
        self.falling = falling
        self.pegs, self.e = pegs, e
        self.carried, self.slides, self.bounced = carried or {}, slides or {}, bounced or {}

    def state(self, time: Any) -> list[tuple[Any, Any, Any, Any]]:
        """(x, y, vx, vy) of every circle, as `IntervalNumber`s; at a time of this run, as its event leaves it.

        Another time that may fall on either side of an event gets what encloses both.

        Raises:
            ValueError: for a time that is certainly before 0 or after the end.
        """
        return self._rows(time, range(len(self.knots)))

    def _rows(self, time: Any, circles: Sequence[int]) -> list[tuple[Any, Any, Any, Any]]:
        """The same of some circles."""
        with INTERVALS.at(self.bits):
            at, end = _interval(time), _interval(self.end)
            if (at < ZERO) is True or (at > end) is True:
                raise ValueError(f"time {float(time):.17g} is outside of the run: it lasts from 0 to {self.end}")
            rows = []
            waits: dict[int, Any] = {}  # from the time of a knot, which circles share: by the number itself
            for i in circles:
                knots, falling = self.knots[i], None if i in self.pegs else self.falling
                carried = self.carried.get(i, ())
                last = self.slides.get(i)
                places = self._places(i, time, at)
                ways = []
                for k in places:
                    knot = knots[k]
                    wait = waits.get(id(knot[0]))
                    if wait is None:
                        wait = waits[id(knot[0])] = at - knot[0]
                    falls = falling if k not in carried else last if k == len(knots) - 1 else None
                    ways.append(_flown(knot, wait, falls))
                for k in places:
                    if (known := self.bounced.get(i, {}).get(k)) is not None:
                        begins = isinstance(time, IntervalNumber) and time.instant == knots[k][-1]
                        ways = _rising(known, ways) if begins else ways + _beside(known, at, ways, self.e)
                rows.append(tuple(map(IntervalNumber, _hull(ways))))
            return rows

    def _places(self, i: int, time: Any, at: Any) -> list[int]:
        """The knots of a circle from which on it may fly at a time."""
        knots = self.knots[i]
        if time is self.end:
            return [len(knots) - 1]
        if isinstance(time, IntervalNumber) and time.instant is not None:
            return [max(bisect_right(knots, time.instant, key=_instant) - 1, 0)]
        found: list[int] = []
        for k in range(len(knots) - 1, -1, -1):
            (low, high), (first, last) = knots[k][0]._mpi_, at._mpi_
            if not mpf_gt(low, last):
                found.append(k)
                if mpf_le(high, first):  # by then it no longer flies as before
                    break
        return found[::-1] or [0]

    @property
    def ends(self) -> dict[tuple[int, int], tuple[IntervalNumber, IntervalNumber]]:
        """By circle and the place of the knot after them: when infinitely many bounces begin, and when they end."""
        pairs = {(i, n): (known.start, known.until) for i, row in self.bounced.items() for n, known in row.items()}
        return {place: (IntervalNumber(start), IntervalNumber(end)) for place, (start, end) in pairs.items()}

    def carries(self, place: int, time: Any) -> bool:
        """Whether a wall certainly carries a circle, by its place in the scene, from a time on."""
        with INTERVALS.at(self.bits):
            return self.carried.get(place, frozenset()).issuperset(self._places(place, time, _interval(time)))

    def sample(self, times: Sequence[float]) -> NDArray[np.float64]:
        """Shape (times, circles, 4): the middles; what is at rest throughout is looked up once."""
        import numpy as np  # here, since a run needs it nowhere else

        still = self.falling is None
        flies = [
            i for i, row in enumerate(self.knots) if not still or len(row) > 1 or row[0][3] != ZERO or row[0][4] != ZERO
        ]
        result = np.empty((len(times), len(self.knots), 4))
        if len(flies) < len(self.knots) and len(times):
            result[:] = [[float(IntervalNumber(value)) for value in row[0][1:5]] for row in self.knots]
        for k, time in enumerate(times):
            rows = self._rows(time, flies)
            result[k, flies] = np.reshape([[float(value) for value in row] for row in rows], (len(flies), 4))
        return result


def _instant(knot: tuple[Any, ...]) -> int:
    return knot[-1]


def _flown(knot: tuple[Any, ...], wait: Any, falling: Gravity[Any] | None) -> tuple[Any, ...]:
    """(x, y, vx, vy) of a circle some time after a knot."""
    _, x, y, vx, vy, _ = knot
    if falling is not None:
        return falling.flown((x, y, vx, vy), wait)
    return _advanced(x, vx, wait), _advanced(y, vy, wait), vx, vy


def _advanced(x: Any, v: Any, wait: Any) -> Any:
    """A coordinate some time later; at rest the very same."""
    return x if v._mpi_ == ZERO._mpi_ else advance(x, v, wait)


def _beside(known: LastBounces[Any], at: Any, ways: list[tuple[Any, ...]], e: Quantity) -> list[tuple[Any, ...]]:
    """How far a circle may be beside its ways along a wall while it bounces on it, and how fast across it."""
    if (at >= known.until) is True:
        return []
    line, up = known.line, known.speed / known.line.nn
    height = up * (known.until - known.start) * (ONE - enclosure(e)) / 4
    across = _hull([(ZERO, -up), (height, up)])
    beside = [part * wide for wide in across for part in (line.nx, line.ny)]
    return [tuple(one + other for one, other in zip(way, beside, strict=True)) for way in ways]


def _rising(known: LastBounces[Any], ways: list[tuple[Any, ...]]) -> list[tuple[Any, ...]]:
    """The same as its bounces begin."""
    line, up = known.line, known.speed / known.line.nn
    return [(x, y, vx + line.nx * up, vy + line.ny * up) for x, y, vx, vy in ways]


def _hull(states: list[tuple[Any, ...]]) -> list[Any]:
    """For each number, an interval that holds all of its values."""
    iv: Any = mpmath.iv
    return [
        values[0] if len(values) == 1 else iv.mpf([min(v.a for v in values), max(v.b for v in values)])
        for values in zip(*states, strict=True)
    ]


def _interval(time: Any) -> Any:
    if isinstance(time, IntervalNumber):
        return time.value
    if isinstance(time, Quantity):
        return enclosure(time)
    iv: Any = mpmath.iv
    return iv.mpf(float(time))


@dataclass(frozen=True)
class IntervalEngine(EventDriven):
    """The event loop of the exact engine, fed `mpmath.iv` intervals of a fixed precision.

    Attributes:
        bits: the precision; 53 is that of doubles.

    Every event that it reports is certain. Where two events or a sign cannot be told apart, the run stops
    UNDECIDED: that is its result.

    >>> from truebreak.scenarios import Circle, Scene
    >>> run = IntervalEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 1)]))
    >>> run.events[0].time.low < 2.267949192431123 < run.events[0].time.high
    True
    """

    bits: int = 53
    scene_keys = ALL_KEYS

    def __post_init__(self) -> None:
        if isinstance(self.bits, bool) or not isinstance(self.bits, int) or not MIN_BITS <= self.bits <= MAX_BITS:
            raise SceneError(f"bits = {self.bits!r}: must be a whole number from {MIN_BITS} to {MAX_BITS}")

    def wider(self) -> IntervalEngine | None:
        """Intervals of twice the bits; None beyond the most that there can be."""
        return IntervalEngine(2 * self.bits) if 2 * self.bits <= MAX_BITS else None

    @property
    def name(self) -> str:
        """The engine's name."""
        return "interval"

    def run(
        self,
        scene: Scene,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """The history as far as intervals certify it (see `Engine.run`)."""
        with INTERVALS.at(self.bits):
            state = IntervalState(scene.surfaces, INTERVALS)
            decider, pegs = PlainDecider(scene.surfaces, state, INTERVALS), state.pegs
            return run_plain(
                scene,
                self.name,
                {"bits": self.bits},
                decider,
                lambda knots, end: IntervalMotion(
                    knots,
                    self.bits,
                    end,
                    state.falling,
                    pegs,
                    carried_knots(decider.history),
                    state.slides,
                    bounced_knots(state, decider.history),
                    scene.restitution,
                ),
                IntervalNumber,
                until=until,
                events=events,
                progress=progress,
            )
