"""How large an engine's error is expected to be at each event of a certified run, before the engine is run.

Each model says what error an engine commits, and the tangent map says what becomes of it. What comes out is the error
that decisions meet: its size beside the margin of each decision, event by event, for an engine of unit error.
"""

from __future__ import annotations

from enum import Enum
from math import hypot, inf, log2
from typing import TYPE_CHECKING

import numpy as np
from flint import arb

from ....exact.exact_motion import motion_of, steps_through
from ....exact.laws.formulas import pair_impulse
from ....exact.numbers import ball
from ....exact.replay.state import ReplayState
from ...tangent.growth import Displacements
from ...tangent.impacts import LEAST_BITS, moving
from .margins import Course, margins
from .overturning import Errors, shares

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from ....scenarios.engine import Engine
    from ....scenarios.scene import Scene
    from ....scenarios.trajectory import Trajectory
    from ...tangent.impacts import Impact


class ErrorModel(Enum):
    """What an engine's declarations say of its error."""

    ROUNDING = "every number is rounded to so many bits"
    STEPPED = "contacts are found late, by up to a time step"
    ENCLOSED = "numbers are enclosed with so many bits, and a decision that the enclosure leaves open ends the run"


def model_of(engine: Engine) -> tuple[ErrorModel, float] | None:
    """The model of an engine, and log2 of its unit of error; None for one that has none: its numbers are exact.

    By what it declares: a time step; bits and rounded input; bits alone.

    >>> from truebreak.floating import DoubleEngine
    >>> model_of(DoubleEngine())
    (<ErrorModel.ROUNDING: 'every number is rounded to so many bits'>, -53.0)
    """
    if engine.step is not None:
        return ErrorModel.STEPPED, log2(engine.step)
    if engine.bits is None:
        return None
    return (ErrorModel.ROUNDING if engine.rounds_input else ErrorModel.ENCLOSED), -float(engine.bits)


SAMPLES = 16
"""Errors drawn at random and carried along side by side; their mean square is what is expected."""

SEED = 1967

PROBE_STEP = 2.0**-20
"""Share of the shortest time between events by which the stepped model's impacts are late: small, so that its error is
proportional to the step."""


TOSS = 8.0
"""What a decision adds to the hazard at most: one whose margin is far below the error is a coin toss, and half of the
engines get it right. By this hazard half of them have left (the median levels in `levels.py` are its logarithm, but for
a fraction of a bit)."""

FARTHEST = 1000.0
"""Powers of two beyond which a share is nothing, or more than any level: a double ends at 2**1024."""

HALVINGS = 60
"""Steps of bisection to an engine's unit: beyond the last bit of a double."""


class ErrorCurve:
    """The expected error of an engine along a run, beside the margins of the run's decisions.

    Args:
        model: what commits the error.
        events: how many there are.
        decisions: for each decision its event, and log2 of the error that an engine of unit error brings to it as a
            share of its margin.
    """

    def __init__(self, model: ErrorModel, events: int, decisions: Sequence[tuple[int, float]]) -> None:
        self.model = model
        self._events = events
        self._at = np.array([event for event, _ in decisions], dtype=int)
        self._shares: NDArray[np.float64] = np.array([share for _, share in decisions], dtype=float)

    def hazard(self, unit: float) -> NDArray[np.float64]:
        """Shape (events,): log2 of the sum, over the decisions so far, of an engine's errors as shares of the margins.

        A decision is overturned with a probability proportional to the error that it meets, but never more often than
        a coin toss; so this says how likely the history is left by then. Where an enclosure leaves a decision open the
        run ends for sure: no toss.

        Args:
            unit: log2 of the engine's unit of error.

        >>> ErrorCurve(ErrorModel.ROUNDING, 3, [(0, 0.0), (1, 0.0), (1, 1.0), (2, 99.0)]).hazard(0.0).tolist()
        [0.0, 2.0, 3.584962500721156]
        """
        most = inf if self.model is ErrorModel.ENCLOSED else TOSS
        shares = np.minimum(most, np.exp2(np.clip(self._shares + unit, -FARTHEST, FARTHEST)))
        sums = np.bincount(self._at, shares, minlength=self._events).cumsum()
        return np.log2(np.maximum(sums, 2.0**-FARTHEST))

    def reaches(self, level: float, unit: float) -> int | None:
        """The first event at which the hazard of an engine with that log2 unit reaches a level; None if none does."""
        above = np.nonzero(self.hazard(unit) >= level)[0]
        return int(above[0]) if len(above) else None

    def unit_at(self, level: float) -> float:
        """log2 of the unit of error with which the hazard at the last event is at a level.

        Infinite if no error is large enough for that, minus infinity if none is small enough.
        """
        finite = self._shares[np.isfinite(self._shares)]
        low, high = -float(finite.max(initial=0.0)) - FARTHEST, FARTHEST
        if self.hazard(high)[-1] < level:
            return inf
        if self.hazard(low)[-1] >= level:
            return -inf
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            low, high = (low, middle) if self.hazard(middle)[-1] >= level else (middle, high)
        return high


def error_curve(trajectory: Trajectory, struck: Sequence[Sequence[Impact]], model: ErrorModel) -> ErrorCurve:
    """The curve of one model along the first events of a certified run, those of `struck`."""
    scene = trajectory.scene
    if model is not ErrorModel.ENCLOSED:
        return ErrorCurve(model, len(struck), list(_carried(scene, struck, model)))
    decisions: list[tuple[int, float]] = []
    widths = _widths(trajectory, struck)
    for event, (told, margin_of) in enumerate(zip(widths, margins(scene, struck, moving(scene)), strict=True)):
        for i, found in margin_of:
            decisions += [(event, told[i] - log2(margin) if margin else inf) for margin in found.tolist()]
    return ErrorCurve(model, len(struck), decisions)


def _carried(scene: Scene, struck: Sequence[Sequence[Impact]], model: ErrorModel) -> Iterator[tuple[int, float]]:
    """Each decision's event, and log2 of what the errors carried there are of its margin, for a unit of 1."""
    draw = np.random.default_rng(SEED)
    free = moving(scene)
    row = {i: k for k, i in enumerate(free)}
    course = Course(scene)
    start = np.zeros((len(free), 4, SAMPLES))
    if model is ErrorModel.ROUNDING:
        state = np.hstack([course.places, course.speeds])[free]
        start = state[:, :, None] * draw.uniform(-1, 1, start.shape)
    carried, errors = Displacements(scene, start), np.zeros((len(scene.circles), 4, SAMPLES))
    for event, impacts in enumerate(struck):
        time = float(impacts[0].time)
        course.fly(time)
        carried.fly(time)
        errors[free] = carried.columns
        ends = (0.0, 1.0) if model is ErrorModel.STEPPED else (-time, time)  # found late; or the clock is rounded

        def off(count: int, ends: tuple[float, float] = ends, shrink: float = 2.0**-carried.scale) -> Errors:
            return shrink * draw.uniform(*ends, (count, SAMPLES))

        for impact in impacts:
            found = shares(course, impacts, impact, errors, row.__contains__, off)
            yield from ((event, carried.scale + log2(share) if share else -inf) for share in found)
        for impact in impacts:
            _strike(carried, course, row, impact, model, draw)


def _strike(
    carried: Displacements,
    course: Course,
    row: dict[int, int],
    impact: Impact,
    model: ErrorModel,
    draw: np.random.Generator,
) -> None:
    """One impact: what was carried goes through it, and what the engine gets wrong at it is added."""
    carried.through([impact])
    time, dx, dy, vx, vy, reach, wa, wb = (float(v) for v in (impact.time, *impact[3:]))
    shrink = 2.0**-carried.scale
    late = draw.uniform(0, 1, SAMPLES) if model is ErrorModel.STEPPED else np.zeros(SAMPLES)
    for (i, change), weight in zip(course.push(impact), (-wa, wb), strict=False):
        if i not in row:
            continue
        k = row[i]
        if model is ErrorModel.STEPPED:
            carried.columns[k, :2] -= shrink * change[:, None] * late
            if impact.b is not None:
                lag = PROBE_STEP * reach / (abs(vx) + abs(vy))
                px, py = dx + vx * lag, dy + vy * lag
                there = pair_impulse(px, py, vx, vy, hypot(px, py), wa, wb)
                turned = (weight * np.array(there) - change)[:, None] / lag * late
                carried.columns[k, 2:] += shrink * turned
            continue
        (x, y), (ux, uy), speed = course.places[i], course.speeds[i], float(np.abs(change).max())
        room = np.abs([x, y, ux, uy]) + np.array([abs(change[0]) * time, abs(change[1]) * time, speed, speed])
        room[2:][(course.speeds[i] == 0) & (change == 0)] = 0.0  # a zero to which a zero is added is exact
        carried.columns[k] += shrink * room[:, None] * draw.uniform(-1, 1, (4, SAMPLES))


def _widths(trajectory: Trajectory, struck: Sequence[Sequence[Impact]]) -> list[dict[int, float]]:
    """log2 of the width of the places of those who meet, for one unit in the last of the bits.

    Interval arithmetic forgets how errors depend on each other, so its widths grow faster than any displacement. They
    are measured: the run's log is replayed by the plain formulas in balls, with bits to spare.
    """
    motion = motion_of(trajectory)
    assert motion is not None, "foreseen of an exact run only"
    log, circles = motion.log, trajectory.scene.circles
    bits = 2 * (log.lost + LEAST_BITS)
    while True:
        with ball.precision(bits):
            state = ReplayState(trajectory.scene, ball.BALLS)
            told: list[dict[int, float]] = []
            done = 0
            for event, impacts in zip(trajectory.events, struck, strict=False):
                upto = steps_through(event)
                for step in log.steps[done:upto]:
                    state.do(step)
                done = upto
                met = {i: state.bodies[i].flight for impact in impacts for i in (impact.a, impact.b) if i is not None}
                widths = [_log2(flight.x.rad() + flight.y.rad()) for i, flight in met.items() if not circles[i].fixed]
                told.append(dict.fromkeys(met, bits + max(widths)))
        if all(width < bits / 2 for errors in told for width in errors.values()):
            return told
        bits *= 2


def _log2(value: arb) -> float:
    """log2 of a radius, however small."""
    return float((value + arb(2) ** -100_000).log() / arb(2).log())
