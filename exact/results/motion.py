"""The motion of an exact run between its events."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, TypeAlias

from flint import arb, fmpq

from ...scenarios.lazy import frozen, kept
from ...scenarios.numbers.nested_roots import Tower
from ...scenarios.numbers.precision import certain_double
from ...scenarios.numbers.quantity import Quantity, QuantityLike
from ...scenarios.numbers.tower_element import Element
from ..laws.formulas import advance
from ..numbers import ball
from ..numbers.field import Known, known_ball
from ..numbers.system import N
from ..replay.state import State
from ..simulation.history import Knot, Mark
from ..simulation.tape import Tape
from .run_log import RunLog
from .times import time_of
from .value import ExactValue

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ...scenarios.trajectory import Event, Trajectory

RunTime: TypeAlias = ExactValue | Quantity
"""A time of an exact run, or a number."""

ExactRow: TypeAlias = tuple[ExactValue, ExactValue, ExactValue, ExactValue]
"""x, y, vx, vy of one circle."""

READ_BITS = 192
"""Precision at which stored states (short balls) are carried on to a time asked for."""


@frozen
class Place:
    """Computes a coordinate of a circle at a time, from the state after its last change of velocity before it."""

    body: int
    axis: int
    time: ExactValue | Quantity

    def __call__(self, state: State[N]) -> N:
        flight = state.bodies[self.body].flight
        place, speed = (flight.x, flight.vx) if self.axis == 0 else (flight.y, flight.vy)
        if flight.rest:
            return place
        when = self.time.formula(state) if isinstance(self.time, ExactValue) else state.constant(self.time)
        return advance(place, speed, when - flight.t)


@frozen
class Velocity:
    """Computes a component of a circle's velocity."""

    body: int
    axis: int

    def __call__(self, state: State[N]) -> N:
        flight = state.bodies[self.body].flight
        return flight.vx if self.axis == 0 else flight.vy


@frozen
class Constant:
    """A number that the scene gives."""

    value: Quantity

    def __call__(self, state: State[N]) -> N:
        return state.constant(self.value)


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
            return [
                (_known(log, c.x), _known(log, c.y), _known(log, -c.vx), _known(log, -c.vy)) for c in log.scene.circles
            ]
        at = time if isinstance(time, ExactValue) else Quantity.of(time)
        if isinstance(at, Quantity) and at.sign() < 0:
            raise ValueError(f"time {at} is before the start; ask for 0 or later")
        if at is not self.end and self._own(at) is None and self._after(at, self.end):
            raise ValueError(f"time {_shown(at)} is after the end of the run; run it for longer")
        return [self._of_circle(i, at) for i in range(len(self.knots))]

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
        bits = 128
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
        while k > 0 and not rough[k] < near - room and self._after(self._time_value(i, k), time):
            k -= 1
        return max(k, 0)

    def _exactly_after(self, time: RunTime, other: RunTime) -> bool:
        exact = [value.exact() if isinstance(value, ExactValue) else value for value in (time, other)]
        tower = next((value.tower for value in exact if isinstance(value, Element)), Tower())
        left, right = (value.in_tower(tower) if isinstance(value, Quantity) else value for value in exact)
        if left is None or right is None or left.tower is not right.tower:
            raise ValueError(f"whether an event falls on time {_shown(time)} is not known; ask for a time beside it")
        return (left - right).sign() > 0

    def _time_value(self, i: int, k: int) -> ExactValue:
        """The instant of a knot. In balls the knot's own number is only a clock beside it, so nothing is at hand."""
        t, *_, upto, instant = self.knots[i][k]
        near = arb.nan() if isinstance(t, arb) else t
        return time_of(self.log, Mark(instant, near, upto, i))

    def _of_circle(self, i: int, time: RunTime) -> ExactRow:
        k = self._knot(i, time)
        t, x, y, vx, vy, upto, _ = self.knots[i][k]
        if isinstance(time, ExactValue):
            bodies = (i, *time.bodies)
            upto = max(upto, time.upto)
            near_time = time.near
        else:
            bodies = (i,)
            near_time = time.rational if time.rational is not None else time.ball(READ_BITS)

        near_x, near_y = _near(x, vx, near_time, t), _near(y, vy, near_time, t)
        make = ExactValue
        return (
            make(self.log, upto, bodies, Place(i, 0, time), near_x),
            make(self.log, upto, bodies, Place(i, 1, time), near_y),
            make(self.log, upto, bodies, Velocity(i, 0), vx),
            make(self.log, upto, bodies, Velocity(i, 1), vy),
        )

    def sample(self, times: Sequence[float]) -> NDArray[np.float64]:
        """Shape (times, circles, 4), as doubles; times within the run, ascending."""
        import numpy as np

        result = np.empty((len(times), len(self.knots), 4))
        for row, time in enumerate(times):
            exact, at = Quantity.of(float(time)), fmpq(*float(time).as_integer_ratio())
            for i in range(len(self.knots)):
                t, x, y, vx, vy, *_ = self.knots[i][self._knot(i, exact)]
                values = (_near(x, vx, at, t), _near(y, vy, at, t), vx, vy)
                result[row, i] = [_double(value) for value in values]
        return result


ROUGH_BITS = 64
"""Accuracy at which a time is looked for among the knots, as a double."""

EQUAL_BITS = 1024
"""Accuracy at which a time that still cannot be told from an event's is asked to be proved equal."""


def _instant(knot: Knot[Known]) -> int:
    return knot[-1]


def _exact_near(time: RunTime) -> fmpq | None:
    """A time as a rational number, where it is at hand as one."""
    if isinstance(time, Quantity):
        return time.rational
    return time.near if isinstance(time.near, fmpq) else None


def _near(x: Known, v: Known, time: Known, t: Known) -> Known:
    """x + v (time - t) in the numbers at hand: exact if they all are and share a field, else a ball."""
    numbers = (x, v, time, t)
    rational = [number for number in numbers if isinstance(number, fmpq)]
    if len(rational) == len(numbers):
        return _advanced(*rational)
    towers = {id(number.tower): number.tower for number in numbers if isinstance(number, Element)}
    if len(towers) == 1 and not any(isinstance(number, arb) for number in numbers):
        (tower,) = towers.values()
        return _advanced(*(tower.rational(n) if isinstance(n, fmpq) else n for n in numbers if not isinstance(n, arb)))
    with ball.precision(READ_BITS):
        return advance(_ball(x), _ball(v), _ball(time) - _ball(t))


def _advanced(x: N, v: N, time: N, t: N) -> N:
    """x + v (time - t)."""
    return advance(x, v, time - t)


def _ball(number: Known) -> arb:
    return known_ball(number, READ_BITS)


def _double(number: Known) -> float:
    """The nearest double where that is certain at the accuracy at hand, else the double nearest the midpoint."""
    value = _ball(number)
    double = certain_double(value)
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
