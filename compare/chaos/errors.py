"""How large an engine's error is expected to be at each event of a certified run, before the engine is run.

Each model says what error an engine commits, and the tangent map says what becomes of it. What comes out is the error
that decisions meet: its size beside the reach of the impacts, event by event, for an engine of unit error.
"""

from __future__ import annotations

from enum import Enum
from math import log2
from typing import TYPE_CHECKING

import numpy as np
from flint import arb

from ...exact.laws.formulas import pair_impulse, wall_bounce
from ...exact.numbers import ball
from ...exact.replay.state import State
from ...exact.results.motion import motion_of, steps_through
from ..tangent.growth import Displacements
from ..tangent.impacts import LEAST_BITS, moving

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from ...scenarios.engine import Engine
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory
    from ..tangent.impacts import Impact


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


class ErrorCurve:
    """The expected error of an engine of unit error along a run, as `log2` of what each event adds to the hazard.

    Attributes:
        model: what commits the error.
        hazard: shape (events,): log2 of the sum, over the events so far, of the error of those who meet, as a share
            of the reach. A decision is overturned with a probability proportional to the error that it meets, so this
            plus log2 of the unit says how likely the history is left by then.
    """

    def __init__(self, model: ErrorModel, shares: Sequence[float]) -> None:
        self.model = model
        logs = np.array(shares, dtype=float)
        self.hazard: NDArray[np.float64] = np.logaddexp2.accumulate(logs) if len(logs) else logs

    def reaches(self, level: float, unit: float) -> int | None:
        """The first event at which the hazard of an engine with that log2 unit reaches a level; None if none does."""
        above = np.nonzero(self.hazard + unit >= level)[0]
        return int(above[0]) if len(above) else None


def error_curve(trajectory: Trajectory, struck: Sequence[Sequence[Impact]], model: ErrorModel) -> ErrorCurve:
    """The curve of one model along the first events of a certified run, those of `struck`."""
    if model is ErrorModel.ENCLOSED:
        return ErrorCurve(model, _widths(trajectory, struck))
    return ErrorCurve(model, _carried(trajectory.scene, struck, model))


def _carried(scene: Scene, struck: Sequence[Sequence[Impact]], model: ErrorModel) -> list[float]:
    """log2 of the error of those who meet at each event, as a share of the reach, for a unit of 1."""
    draw = np.random.default_rng(SEED)
    free = moving(scene)
    row = {i: k for k, i in enumerate(free)}
    state = np.array([[float(v) for v in (c.x, c.y, c.vx, c.vy)] for c in (scene.circles[i] for i in free)])
    start = np.zeros((len(free), 4, SAMPLES))
    if model is ErrorModel.ROUNDING:
        start = state[:, :, None] * draw.uniform(-1, 1, start.shape)
    carried, now, shares = Displacements(scene, start), 0.0, []
    reach = _usual_reach(scene)
    for impacts in struck:
        time = float(impacts[0].time)
        state[:, :2] += (time - now) * state[:, 2:]
        now = time
        carried.fly(time)
        met = [row[i] for impact in impacts for i in (impact.a, impact.b) if i in row]
        errors = np.sqrt((carried.columns[met, :2] ** 2).sum(axis=1).mean(axis=1))
        shares.append(carried.scale + log2(max(float(errors.max()), 1e-300) / reach))
        for impact in impacts:
            _strike(carried, state, row, impact, model, draw)
    return shares


def _strike(
    carried: Displacements,
    state: NDArray[np.float64],
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
    for i, weight, sign in ((impact.a, wa, -1.0), (impact.b, wb, 1.0)):
        if i not in row:
            continue
        k = row[i]
        before = state[k, 2:].copy()
        if impact.b is None:
            state[k, 2:] = wall_bounce(before[0], before[1], dx, dy, reach * reach)
            turned = np.zeros((2, SAMPLES))
        else:
            here = pair_impulse(dx, dy, vx, vy, reach, wa, wb)
            state[k, 2:] += sign * weight * np.array(here)
            lag = PROBE_STEP * reach / (abs(vx) + abs(vy))
            px, py = dx + vx * lag, dy + vy * lag
            there = pair_impulse(px, py, vx, vy, float(np.hypot(px, py)), wa, wb)
            turned = sign * weight * (np.array(there) - np.array(here))[:, None] / lag * late
        change = state[k, 2:] - before
        if model is ErrorModel.STEPPED:
            carried.columns[k, :2] -= shrink * change[:, None] * late
            carried.columns[k, 2:] += shrink * turned
        else:
            size = np.abs(state[k]) + np.array([abs(change[0]), abs(change[1]), 0.0, 0.0]) * time
            speed = float(np.abs(change).max())
            room = np.array([size[0], size[1], abs(state[k, 2]) + speed, abs(state[k, 3]) + speed])
            carried.columns[k] += shrink * room[:, None] * draw.uniform(-1, 1, (4, SAMPLES))


def _usual_reach(scene: Scene) -> float:
    """The mean diameter of what can be met: against this an error is large or small."""
    sizes = [float(c.r) for c in scene.circles if float(c.r) > 0]
    return 2 * sum(sizes) / len(sizes) if sizes else 1.0


def _widths(trajectory: Trajectory, struck: Sequence[Sequence[Impact]]) -> list[float]:
    """log2 of the width of the places of those who meet, for one unit in the last of the bits.

    Interval arithmetic forgets how errors depend on each other, so its widths grow faster than any displacement. They
    are measured: the run's log is replayed by the plain formulas in balls, with bits to spare.
    """
    motion = motion_of(trajectory)
    assert motion is not None, "foreseen of an exact run only"
    log = motion.log
    reach, circles = _usual_reach(trajectory.scene), trajectory.scene.circles
    bits = 2 * (log.lost + LEAST_BITS)
    while True:
        with ball.precision(bits):
            state = State(trajectory.scene, ball.BALLS)
            shares: list[float] = []
            done = 0
            for event, impacts in zip(trajectory.events, struck, strict=False):
                upto = steps_through(event)
                for step in log.steps[done:upto]:
                    state.do(step)
                done = upto
                met = [state.bodies[i] for impact in impacts for i in (impact.a, impact.b) if i is not None]
                widths = [
                    _log2(body.flight.x.rad() + body.flight.y.rad()) for body in met if not circles[body.index].fixed
                ]
                shares.append(bits + max(widths) - log2(reach))
        if all(share < bits / 2 for share in shares):
            return shares
        bits *= 2


def _log2(value: arb) -> float:
    """log2 of a radius, however small."""
    return float((value + arb(2) ** -100_000).log() / arb(2).log())
