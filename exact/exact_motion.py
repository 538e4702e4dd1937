"""What an exact run gives back: its log, numbers that know their exact value, times, and the motion."""

from __future__ import annotations

import copyreg
from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from operator import itemgetter, sub
from typing import TYPE_CHECKING, Any, TypeAlias

from flint import arb, fmpq

from ..scenarios.lazy import frozen, kept
from ..scenarios.numbers.nested_roots import Tower
from ..scenarios.numbers.precision import (
    BITS_PER_DIGIT,
    MOST_BITS,
    MOST_DIGITS,
    asked,
    bounds_of,
    certain_double,
    decimals_of,
    even_double,
    nearest_double,
)
from ..scenarios.numbers.quantity import Quantity, QuantityLike, in_one_tower
from ..scenarios.numbers.tower_element import Element
from ..scenarios.numbers.tower_ring import TowerLimit
from .flight_formulas import Bounced, BounceTime, FallSpeed, OtherRun, Place, amid_bounces, bounce_before, endless, sunk
from .laws.formulas import fall_speed
from .numbers import ball
from .numbers.ball import Known, known_ball, reduced
from .numbers.double_pairs import advanced_pairs, fallen_pairs, pair_of
from .numbers.system import N, Undecided
from .replay.contact import Link
from .replay.landings import Unsharp
from .replay.state import Constant, ReplayState, Velocity
from .simulation.decider import Formula, Knot, Mark, RunLog
from .simulation.loop import Tape
from .simulation.policies import Accumulating

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ..scenarios.trajectory import Event, Trajectory

# -- Numbers of an exact run that know their exact value: to any digits, as SymPy, as text.

copyreg.pickle(arb, reduced)

LEAST_BITS = 320
"""Bits computed at the least: most numbers asked for one after another then come of one replay."""


class ExactValue:
    """A real number of an exact run.

    float() gives the nearest double, certified; of a number so near half-way between two that counted work does not
    tell where it lies, the even one. `digits`, `sympy` and `text` give the value itself.

    Attributes:
        log: the run that it belongs to.
        upto: how many steps of the log it needs.
        bodies: the circles that it depends on.
        formula: computes it from the state after those steps, in any state.
        near: a short enclosure, or the exact number where it is at hand.
        instant: for the time of something that happened in the run, the number of its instant.
    """

    def __init__(
        self,
        log: RunLog,
        upto: int,
        bodies: Sequence[int],
        formula: Formula,
        near: Known,
        instant: int | None = None,
    ) -> None:
        self.log = log
        self.upto = upto
        self.bodies = tuple(bodies)
        self.formula = formula
        self.near = near
        self.instant = instant

    def __repr__(self) -> str:
        try:
            return f"ExactValue({self.digits(17)})"
        except Undecided:
            return f"ExactValue({self.ball(DOUBLE_BITS).str(3)})"

    def ball(self, bits: int) -> arb:
        """An enclosure accurate to about `bits` bits, relatively (absolutely, for a value that may be zero).

        Raises:
            SceneError: for bits that are no whole number from 1 to `MOST_BITS`.
            Undecided: where counted work does not suffice for that.
        """
        bits = asked("ball", bits, MOST_BITS)
        if isinstance(self.near, fmpq):
            with ball.precision(bits + ball.GUARD_BITS):
                return arb(self.near)
        if isinstance(self.near, Element):
            return self.near.ball(bits)
        if self.near.rel_accuracy_bits() >= bits:
            return self.near
        return self._sharpened(bits, lambda value: ball.is_accurate(value, bits) or ball.is_faint(value, bits))

    def _sharpened(self, bits: int, enough: Callable[[arb], bool]) -> arb:
        """The enclosure of a replay with so many bits, or with twice as many, and so on, until it is enough.

        Raises:
            Undecided: once that has cost all the work that it may.
        """
        log, upto = self.log, self.upto
        working = log.lost + max(bits + ball.GUARD_BITS, LEAST_BITS)
        allowed = VALUE_WORK + MORE_WORK * log.units(working, upto)
        with ball.precision(working):
            while True:
                try:
                    state = log.in_balls(working, upto)
                    ball.use_bits(working)
                    value = self.formula(state)
                except Unsharp:  # fewer bits than what was proved exactly needs in balls
                    value = arb.nan()
                if value.is_finite() and enough(value):
                    return value
                working *= 2
                allowed -= log.units(working, upto)
                if allowed < 0:
                    raise Undecided(
                        f"a number of the run, {value.str(20)}, is neither separated from zero, or from half-way "
                        f"between decimals, with {working // 2} bits of counted work, nor proved to be it; ask for "
                        "its `ball`"
                    )

    def __float__(self) -> float:
        return self._double

    @kept
    def _double(self) -> float:
        if isinstance(self.near, fmpq):
            return nearest_double(self.near)
        double = certain_double(self.near) if isinstance(self.near, arb) else None
        if double is None and isinstance(self.near, Element):
            fraction, bits = self.near.fraction(), DOUBLE_BITS
            if fraction is not None:
                return nearest_double(fraction)
            while double is None:  # it is irrational, so that it lies half-way between no doubles
                bits *= 2
                double = certain_double(self.near.ball(bits))
        if double is None:
            value = self._sharpened(
                2 * DOUBLE_BITS, lambda it: certain_double(it) is not None or ball.is_accurate(it, HALF_WAY_BITS)
            )
            if (double := certain_double(value)) is None:
                exact = self.exact()
                fraction = None if exact is None else exact.fraction()
                if fraction is not None:
                    return nearest_double(fraction)
                try:
                    sharp = self._sharpened(2 * HALF_WAY_BITS, lambda it: certain_double(it) is not None)
                    double = certain_double(sharp)
                except Undecided:
                    double = even_double(value)
                assert double is not None
        return double

    def bounds(self) -> tuple[float, float]:
        """Doubles at or below, and at or above, the value."""
        return bounds_of(self.ball(DOUBLE_BITS))

    def digits(self, count: int) -> str:
        """The value in decimals, all of them right (the last may be off by one): the same from any run of the scene.

        "0" is told of what is proved to be zero alone.

        Raises:
            SceneError: for a count that is no whole number from 1 to `MOST_DIGITS`.
            Undecided: where a number beyond all bits that counted work allows for is not proved to be zero.

        >>> from truebreak.exact import ExactEngine
        >>> from truebreak.scenarios import Circle, Scene
        >>> scene = Scene([Circle(0, 0, vx=1), Circle(4, 1)])
        >>> ExactEngine().run(scene).events[0].time.digits(30)
        '2.26794919243112270647255365849'
        """
        count, near = asked("digits", count, MOST_DIGITS), self.near
        if isinstance(near, fmpq):
            return ball.fraction_in_decimals(near, count)
        if isinstance(near, Element):
            return ball.element_in_decimals(near, count)
        bits = int(count * BITS_PER_DIGIT) + 2 * ball.GUARD_BITS
        told = decimals_of(near, count)
        if told is None:
            told = decimals_of(
                self._sharpened(
                    bits,
                    lambda value: (
                        decimals_of(value, count) is not None
                        or ball.is_faint(value, bits)
                        or ball.is_accurate(value, 2 * bits)
                    ),
                ),
                count,
            )
        if told is None:
            exact = self.exact()
            if exact is not None:
                return ball.element_in_decimals(exact, count)
            told = decimals_of(self._sharpened(2 * bits, lambda value: decimals_of(value, count) is not None), count)
            assert told is not None
        return told

    def exact(self) -> Element | None:
        """The value in nested square roots in normal form, or None if it is too deep for that."""
        if isinstance(self.near, Element):
            return self.near
        if isinstance(self.near, fmpq):
            return Tower().rational(self.near)
        return self.log.exact(self.upto, self.bodies, self.formula)

    def sympy(self) -> Any:
        """The value as a SymPy expression.

        In normal form where it needs few nested roots; else the expression that the run computes, unsimplified,
        its subexpressions shared in memory (do not print it: see `text`).
        """
        exact = self.exact()
        if exact is not None:
            return exact.sympy()
        return self.formula(self.log.in_expressions(self.upto, self.bodies)).expression

    def text(self) -> str | None:
        """The value in the grammar of scene files, or None if it is too deep to be written out.

        Once a circle has fallen onto something round, its `definition`.

        >>> from truebreak.exact import ExactEngine
        >>> from truebreak.scenarios import Circle, Scene
        >>> scene = Scene([Circle(0, 0, vx=1), Circle(4, 1)])
        >>> ExactEngine().run(scene).events[0].time.text()
        '-sqrt(3) + 4'
        """
        from .texts import definition

        return self.normal_form() or definition(self.log, self.upto, self.bodies, self.formula)

    def normal_form(self) -> str | None:
        """As `text`, but None of what has a `definition` only."""
        exact = self.near if isinstance(self.near, fmpq) else self.exact()
        return None if exact is None else ball.field_text(exact)


DOUBLE_BITS = 64
"""Accuracy at which a value is held between doubles."""

HALF_WAY_BITS = 512
"""A value that still straddles two doubles at this accuracy is asked whether it is a rational half-way point."""

VALUE_WORK = 3_000_000
"""Units of work that one number may cost: a few seconds."""

MORE_WORK = 40
"""Besides, so many times the work of its first replay: enough for five times twice the bits."""


# -- The times of a run, each with the formula that computes it again from the log.

RETURN = "return"
"""The source of the time at which a reversed run is back: twice that of the reversal."""

START = "start"
"""The source of time 0, where nothing happened after it."""

Source: TypeAlias = int | Link | str
"""The circle whose clock stands at a time; or the meeting that comes at it; or `REVERSAL`, RETURN, START."""


@frozen
class TimeFormula:
    """Computes a time from the state at the end of its instant."""

    source: Source

    @property
    def bodies(self) -> tuple[int, ...]:
        """The circles that it depends on."""
        if isinstance(self.source, str):
            return (0,)
        return (self.source,) if isinstance(self.source, int) else self.source.circles[:1]

    def __call__(self, state: ReplayState[N]) -> N:
        source = self.source
        if isinstance(source, int):
            return state.bodies[source].flight.instant
        if not isinstance(source, str):
            clock, wait = source.hit(state)
            return clock + wait
        if source == START:
            return state.zero
        return state.flip_time + state.flip_time if source == RETURN else state.flip_time


def time_of(log: RunLog, mark: Mark[Known]) -> ExactValue:
    """The time of an instant, which knows its exact value."""
    formula = TimeFormula(mark.source)
    return ExactValue(log, mark.step, formula.bodies, formula, mark.time, instant=mark.number)


def time_of_return(log: RunLog, reversal: Mark[Known], instant: int) -> ExactValue:
    """Twice the time of the reversal; `instant` is the last at which anything happens."""
    return time_of(log, Mark(instant, reversal.time * 2, reversal.step, RETURN))


def ending_of(log: RunLog, last: int | None, bounces: Accumulating | Constant | None) -> ExactValue | None:
    """When the bounces that ended a run have all happened, or a circle was crushed; None where neither did.

    Args:
        last: how many steps of the log lead through the last of the bounces that are in it.
    """
    if bounces is None:
        return None
    if isinstance(bounces, Constant):
        return _known(log, bounces.value)
    assert last is not None
    return ExactValue(log, last, bounces.circles, bounces, arb.nan())


# -- The motion of an exact run between its events.

RunTime: TypeAlias = ExactValue | Quantity
"""A time of an exact run, or a number."""

ExactRow: TypeAlias = tuple[ExactValue, ExactValue, ExactValue, ExactValue]
"""x, y, vx, vy of one circle."""

READ_BITS = 192
"""Precision at which stored states (short balls) are carried on to a time asked for."""


def _halved(vector: Sequence[Quantity]) -> tuple[Known, Known]:
    halves = [part / 2 for part in vector]
    x, y = (half.ball(READ_BITS) if half.rational is None else half.rational for half in halves)
    return x, y


class ExactMotion:
    """Positions and velocities at any time, as `ExactValue`s.

    Args:
        log: the scene and its log.
        knots: for each circle, (t, x, y, vx, vy, length of the log, number of the instant) at the start and after
            each instant that changed its velocity.
        end: the last time that may be asked for.
        set_times: exact times with the number of the last part of the instant that is known to fall on each.

    Attributes:
        returned: whether the state at the end is known to be the start with velocities negated.
        tape: what a run needs that goes on from this one; None if none can.
    """

    def __init__(
        self,
        log: RunLog,
        knots: Sequence[Sequence[Knot[Known]]],
        end: ExactValue | Quantity,
        set_times: Mapping[Quantity, int],
    ) -> None:
        self.log = log
        self.set_times = set_times
        self.knots = knots
        self.end = end
        self.returned = False
        self.tape: Tape | None = None

    @kept
    def _beside(self) -> dict[tuple[int, float], int]:
        """Which knot a circle is past, at times beside an event that were asked for."""
        return {}

    @kept
    def _halves(self) -> tuple[Known, Known] | None:
        """Half of gravity: then knots are in the falling frame (see `Gravity`), but those of what stands."""
        g = self.log.scene.gravity
        return None if g is None else _halved(g)

    def _bend(self, i: int, k: int) -> tuple[Known, Known] | None:
        """Half of what bends a circle's flight from a knot on; None of a straight one.

        That is `_halves`, or what there is of it along a slope that the circle slides down: in true coordinates.
        """
        scene, upto = self.log.scene, self.knots[i][k][5]
        if scene.gravity is None or i in scene.pegs:
            return None
        if (wall := self.log.slope(i, upto)) is not None:
            return _halved(scene.walls[wall].along(*scene.gravity))
        return None if self.log.carries(i, upto) else self._halves

    def carries(self, place: int, time: ExactValue | QuantityLike) -> bool:
        """Whether a wall carries a circle, by its place in the scene, from a time on."""
        return self.log.carries(place, self.knots[place][self._knot(place, self._within(time))][5])

    @kept
    def _rough(self) -> list[list[float]]:
        """About when each knot is."""
        return [[float(_ball(knot[0])) for knot in row] for row in self.knots]

    def state(self, time: ExactValue | QuantityLike) -> list[ExactRow]:
        """(x, y, vx, vy) of every circle; at an instant, after all that happens at it.

        Args:
            time: a number of any kind (see `Quantity.of`), or a time of this run.

        Raises:
            ValueError: before 0 or after the end.
        """
        if self.returned and time is self.end:
            log = self.log
            circles = log.scene.circles[: len(self.knots)]
            return [(_known(log, c.x), _known(log, c.y), _known(log, -c.vx), _known(log, -c.vy)) for c in circles]
        at = self._within(time)
        return [self._of_circle(i, at) for i in range(len(self.knots))]

    def circle(self, i: int, time: ExactValue | QuantityLike) -> ExactRow:
        """(x, y, vx, vy) of one circle, by its place; see `state`.

        Raises:
            ValueError: before 0 or after the end.
        """
        return self.state(time)[i] if self.returned and time is self.end else self._of_circle(i, self._within(time))

    def _within(self, time: ExactValue | QuantityLike) -> RunTime:
        """A time that may be asked for.

        Raises:
            ValueError: before 0 or after the end.
        """
        at = time if isinstance(time, ExactValue) else Quantity.of(time)
        if isinstance(at, Quantity) and at.sign() < 0:
            raise ValueError(f"time {at} is before the start; ask for 0 or later")
        if at is not self.end and self._own(at) is None and self._after(at, self.end):
            raise ValueError(f"time {_shown(at)} is after the end of the run; run it for longer")
        return at

    def reaches(self, time: RunTime) -> bool:
        """Whether a time is not after the end, or not known to be."""
        with suppress(ValueError):
            return time is self.end or self._own(time) is not None or not self._after(time, self.end)
        return True

    def _own(self, time: RunTime) -> int | None:
        """The number of the instant of this run that a time is; None for any other time."""
        return time.instant if isinstance(time, ExactValue) and time.log is self.log else None

    def _after(self, time: RunTime, other: RunTime) -> bool:
        """Whether a time is later than another; equal times are not.

        Raises:
            ValueError: if that is not to be had.
        """
        mine, theirs = self._own(time), self._own(other)
        if mine is not None and theirs is not None:
            return mine > theirs
        if isinstance(time, Quantity) and isinstance(other, Quantity):
            return time > other
        near, far = (_exact_near(value) for value in (time, other))
        if near is not None and far is not None:
            return near > far
        bits = 96  # the time of an event is known to more in its run, and told from a double beside it
        while True:
            with ball.precision(bits + 64):
                sign = ball.sign_of(time.ball(bits) - other.ball(bits))
            if sign is not None:
                return sign > 0
            if bits >= EQUAL_BITS:
                return self._exactly_after(time, other)
            bits *= 2

    def _knot(self, i: int, time: RunTime) -> int:
        """The last knot of a circle that is not later than a time."""
        knots = self.knots[i]
        own = self._own(time)
        if own is not None:
            return max(bisect_right(knots, own, key=_instant) - 1, 0)
        if isinstance(time, Quantity) and time in self.set_times:
            return max(bisect_right(knots, self.set_times[time], key=_instant) - 1, 0)
        if time is self.end:
            return len(knots) - 1
        rough = self._rough[i]
        near = float(time.ball(ROUGH_BITS))  # infinite beyond doubles, where every knot is looked at
        room = abs(near) * 2.0**-50
        k = bisect_right(rough, near + room) - 1
        while k > 0 and not rough[k] < near - room and self._after(self.knot_time(i, k), time):
            k -= 1
        return max(k, 0)

    def _exactly_after(self, time: RunTime, other: RunTime) -> bool:
        exact = [value.exact() if isinstance(value, ExactValue) else value for value in (time, other)]
        tower = next((value.tower for value in exact if isinstance(value, Element)), Tower())
        try:
            left, right = (None if value is None else in_one_tower(value, tower) for value in exact)
        except TowerLimit:
            left = right = None
        if left is None or right is None:
            raise ValueError(f"whether an event falls on time {_shown(time)} is not known; ask for a time beside it")
        return (left - right).sign() > 0

    def knot_time(self, i: int, k: int) -> ExactValue:
        """The instant of a knot. In balls the knot's own number is only a clock beside it."""
        t, *_, upto, instant = self.knots[i][k]
        near = t if not isinstance(t, arb) else self.log.events.time_at(instant) if self.log.events else arb.nan()
        return time_of(self.log, Mark(instant, near, upto, i))

    def _of_circle(self, i: int, time: RunTime) -> ExactRow:
        k = self._knot(i, time)
        t, x, y, vx, vy, upto, _ = self.knots[i][k]
        where: Callable[[int], Formula] = lambda axis: Place(i, axis, time)  # noqa: E731
        if isinstance(time, ExactValue):
            near_time = time.near
            if time.log.begins(self.log, time.upto):
                bodies, upto = (i, *time.bodies), max(upto, time.upto)
            else:
                bodies, where = (i,), lambda axis: OtherRun()
        else:
            bodies = (i,)
            near_time = time.rational if time.rational is not None else time.ball(READ_BITS)

        near = ball.flown(x, vx, near_time, t, READ_BITS), ball.flown(y, vy, near_time, t, READ_BITS), vx, vy
        formulas: list[Formula] = [where(0), where(1), Velocity(i, 0), Velocity(i, 1)]
        bounces = self._bounces(i, k, time)
        if (halves := self._bend(i, k)) is not None:
            lag = near_time if halves is self._halves else ball.combined(sub, (near_time, t), READ_BITS)
            bent = zip((sunk, sunk, fall_speed, fall_speed), near, halves * 2, strict=True)
            near = tuple(ball.combined(formula, (number, half, lag), READ_BITS) for formula, number, half in bent)
            other = isinstance(formulas[0], OtherRun)
            formulas[2:] = formulas[:2] if other else [FallSpeed(i, 0, time), FallSpeed(i, 1, time)]
        if bounces is not None and isinstance(formulas[0], OtherRun):
            formulas, (start, end) = formulas[:2] * 2, self.ends[i, k]
            near = amid_bounces(near, self.log.scene, end.formula.wall, start, end, time, bounces)
        elif bounces is not None:
            nth = self.ends[i, k][1].formula.nth
            formulas = [Bounced(i, along, n % 2, n > 1, time, nth, bounces) for n, along in enumerate(formulas)]
            near = (arb.nan(),) * 4
        rows = zip(formulas, near, strict=True)
        return tuple(ExactValue(self.log, upto, bodies, *row) for row in rows)  # pyright: ignore[reportReturnType]

    @kept
    def ends(self) -> dict[tuple[int, int], tuple[ExactValue, ExactValue]]:
        """By circle and the place of the knot after them: when infinitely many bounces begin, and end."""
        found = endless(self.log.steps, self.knots) if self.log.given.settle else {}
        return {
            place: (self.knot_time(*place), ExactValue(self.log, upto, place[:1], end, arb.nan()))
            for place, (upto, end) in found.items()
        }

    def _bounces(self, i: int, k: int, time: RunTime) -> int | None:
        """After how many of the infinitely many bounces before a knot a time is, besides the first; None of others."""
        if (i, k) not in self.ends:
            return None
        (start, end), begins = self.ends[i, k], self._own(time) == self.knots[i][k][6]
        last = time is self.end and any(time is other for _, other in self.ends.values())  # none is known to be later
        if last or time is end or not (begins or self._after(end, time)):
            return None

        def is_later(number: int) -> bool:
            then = BounceTime(i, end.formula.wall, end.formula.nth, number)
            return self._after(ExactValue(self.log, end.upto, (i,), then, arb.nan()), time)

        e = self.log.scene.restitution
        return 0 if begins else bounce_before(start, end, time, e, EQUAL_BITS, is_later)

    def sample(self, times: Sequence[float]) -> NDArray[np.float64]:
        """Shape (times, circles, 4), as doubles; times within the run, ascending.

        Computed in pairs of doubles, good to some 100 bits; where numbers are too large or small for that, in balls.
        """
        import numpy as np

        at = np.asarray(times, dtype=np.float64)
        result = np.empty((len(at), len(self.knots), 4))
        for i, found in enumerate(self._knots_at(at)):
            used, which = np.unique(found, return_inverse=True)
            bends = [self._bend(i, int(k)) for k in used]
            pairs = np.array([self._pairs(i, int(k)) for k in used]).reshape(len(used), 5, 2)
            sizes = np.abs(pairs[:, :, 0])
            if np.all(np.abs(at) < 1 / SMALL) and np.all((sizes == 0) | ((sizes > SMALL) & (sizes < 1 / SMALL))):
                t, x, y, vx, vy = np.moveaxis(pairs[which], 1, 0)
                on = np.ones(len(at), dtype=bool)
                for halves in {id(halves): halves for halves in bends if halves is not None}.values():
                    hx, hy = (pair_of(_ball(half)) for half in halves)
                    bent = np.array([other is halves for other in bends])[which]
                    now, on = at[bent], on & ~bent
                    result[bent, i, 0], result[bent, i, 2] = fallen_pairs(x[bent], vx[bent], hx, t[bent], now)
                    result[bent, i, 1], result[bent, i, 3] = fallen_pairs(y[bent], vy[bent], hy, t[bent], now)
                t, x, y, vx, vy = (part[on] for part in (t, x, y, vx, vy))
                result[on, i, 0], result[on, i, 1] = advanced_pairs(x, vx, t, at[on]), advanced_pairs(y, vy, t, at[on])
                result[on, i, 2], result[on, i, 3] = vx[:, 0], vy[:, 0]
            else:
                for row, time in enumerate(times):
                    t, x, y, vx, vy, *_ = self.knots[i][int(used[which[row]])]
                    then = fmpq(*float(time).as_integer_ratio())
                    if self._halves is not None:
                        result[row, i] = [float(value) for value in self._of_circle(i, Quantity.of(float(time)))]
                        continue
                    near = (ball.flown(x, vx, then, t, READ_BITS), ball.flown(y, vy, then, t, READ_BITS), vx, vy)
                    result[row, i] = [_double(value) for value in near]
            for k, end in ((k, end) for (j, k), (_, end) in self.ends.items() if j == i):
                for row in np.nonzero((found == k) & (at <= float(end)))[0]:
                    result[row, i] = [float(value) for value in self._of_circle(i, Quantity.of(float(at[row])))]
        return result

    def _knots_at(self, times: NDArray[np.float64]) -> list[NDArray[np.int64]]:
        """For each circle, `_knot` for many times: only those that are beside an event's need more than doubles.

        These are told in the order of the log, so that they cost one replay together, and once for all samples.
        """
        import numpy as np

        room = np.abs(times) * 2.0**-50
        told: list[NDArray[np.int64]] = []
        unclear: list[tuple[int, int, int]] = []
        for i, row in enumerate(self._rough):
            rough = np.array(row)
            found = np.maximum(np.searchsorted(rough, times + room, side="right") - 1, 0)
            least = np.maximum(np.searchsorted(rough, times - room, side="left") - 1, 0)
            unclear += [(self.knots[i][int(found[k])][5], i, int(k)) for k in np.nonzero(found != least)[0]]
            told.append(found)
        for _, i, k in sorted(unclear):
            time = float(times[k])
            if (i, time) not in self._beside:
                self._beside[i, time] = self._knot(i, Quantity.of(time))
            told[i][k] = self._beside[i, time]
        return told

    def _pairs(self, i: int, k: int) -> list[tuple[float, float]]:
        """The time, place and velocity of a knot, each as two doubles whose sum it is to about 100 bits.

        Under gravity in true coordinates, at the knot.
        """
        t, x, y, vx, vy, *_ = map(_ball, self.knots[i][k][:5])
        if (halves := self._bend(i, k)) is not None and halves is self._halves:
            with ball.precision(READ_BITS):
                hx, hy = map(_ball, halves)
                x, y, vx, vy = sunk(x, hx, t), sunk(y, hy, t), fall_speed(vx, hx, t), fall_speed(vy, hy, t)
        return [pair_of(number) for number in (t, x, y, vx, vy)]


SMALL = 1e-140
"""Products of numbers no smaller than this, and no larger than its inverse, lose no bits of a pair of doubles."""

ROUGH_BITS = 64
"""Accuracy at which a time is looked for among the knots, as a double."""

EQUAL_BITS = 1024
"""Accuracy at which a time that still cannot be told from an event's is asked to be proved equal."""


_instant = itemgetter(-1)  # of a knot


def _exact_near(time: RunTime) -> fmpq | None:
    """A time as a rational number, where it is at hand as one."""
    near = time.rational if isinstance(time, Quantity) else time.near
    return near if isinstance(near, fmpq) else None


def _ball(number: Known) -> arb:
    return known_ball(number, READ_BITS)


def _double(number: Known) -> float:
    """The nearest double where that is certain at the accuracy at hand, else the double nearest the midpoint."""
    double = certain_double(value := _ball(number))
    return float(value) if double is None else double


def motion_of(run: Trajectory) -> ExactMotion | None:
    """The motion of an exact run, which has its log; None for a run of any other engine."""
    return run.motion if isinstance(run.motion, ExactMotion) else None


def steps_through(event: Event) -> int:
    """How many steps of its log lead through an event of an exact run."""
    assert isinstance(event.time, ExactValue)
    return event.time.upto


def _shown(time: RunTime) -> str:
    return time.ball(ROUGH_BITS).str(17, radius=False)


def _known(log: RunLog, value: Quantity) -> ExactValue:
    near = value.rational if value.rational is not None else value.ball(READ_BITS)
    return ExactValue(log, 0, (), Constant(value), near)
