"""What one contact may cost an honest engine: the rounding of its numbers, and what its time step adds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ....scenarios.errors import SceneError
from ...foreign.guard import run_guarded
from ...study import finer_by, series_steps

if TYPE_CHECKING:
    from ....scenarios.engine import Engine
    from ....scenarios.trajectory import Trajectory

ROUNDINGS = 64
"""k: roundings of one contact. To predict it, fly to it and bounce takes 57 operations of two circles in the plain
formulas, 25 of a circle and a wall, each off by half a unit in the last place (`test_tolerance.py` counts them);
engines write them in other ways, with a few more."""

HALVINGS = (0, 1, 2, 3)
"""How often a time step is halved to see with which order an engine's lateness falls."""

FALLING = 0.5
"""The slope of lateness over the step below which it does not fall, if at the finest step it is still longer than the
coarsest: a first order has slope 1, and rounding, which does not fall, is shorter."""

UNSEEN = 4.0
"""Steps of lateness that are granted at most where the step cannot be halved: an engine that finds an overlap at the
end of one step, and pushes in the next, is late by two, and twice what is seen is granted."""

FIRST_EVENTS = 24
"""Events of the true run among which each circle's first meeting is looked for: before it, nothing has grown."""


@dataclass(frozen=True)
class LocalError:
    """What one contact may cost.

    Attributes:
        unit: 2**-p for numbers of p bits, times `ROUNDINGS`: a share of the largest number that enters. 0: exact.
        input_unit: 2**-p where the scene is rounded, else 0.
        lateness: c * h**q, by how much time an engine of step h may be late to a contact; 0 without a step.
        order: q; None without a step.
    """

    unit: float
    input_unit: float
    lateness: float = 0.0
    order: float | None = None

    @property
    def told(self) -> str:
        """In words."""
        if self.order is None:
            return f"{self.unit:.3g} of the largest number at each contact"
        late = f"up to {self.lateness:.3g} late, of order {self.order:g} in the step"
        return f"{self.unit:.3g} of the largest number at each contact, which comes {late}"


def local_error(engine: Engine, reference: Trajectory, bits: int | None) -> LocalError:
    """The local error of an engine with so many bits.

    An engine with a time step is run on the first events with its step halved again and again. Each circle's first
    meeting is then compared with the true one, when nothing has grown yet: how far off it is after that, divided by
    the change of its velocity, is how late the push was; or, if that is more, how late the meeting is told, as by an
    engine that finds it at the end of one step and tells it at that of the next. q is the slope of the latest over
    the step, rounded to whole numbers from 1; c is twice the largest lateness / h**q, and at least 1 for q = 1, since
    a contact that is found at the end of a step may be late by a whole one. Lateness that does not fall as h is halved
    is no matter of the step: then, and where nothing is seen, q = 1 and c = 1. Where no step can be halved, q = 1 and
    c is at most `UNSEEN`.
    """
    unit = 0.0 if bits is None else 2.0**-bits
    rounding = LocalError(ROUNDINGS * unit, unit if engine.rounds_input else 0.0)
    if engine.step is None:
        return rounding
    seen = [(e.step, late) for e, late in _series(engine, reference) if e.step is not None and late > 0]
    order = 1.0
    if len(seen) > 1:
        (first, one), (last, other) = seen[0], seen[-1]
        slope = math.log(one / other) / math.log(first / last)
        if slope < FALLING and other > first:
            seen = []
        order = max(1.0, float(round(slope)))
    factor = max((2 * late / step**order for step, late in seen), default=0.0)
    if len(seen) == 1:
        factor = min(factor, UNSEEN)
    factor = max(factor, 1.0) if order == 1.0 else factor
    late = factor * engine.step**order
    return LocalError(rounding.unit, rounding.input_unit, late, order)


def _series(engine: Engine, reference: Trajectory) -> list[tuple[Engine, float]]:
    """An engine at finer and finer steps, each with its largest lateness at a circle's first meeting."""
    found: list[tuple[Engine, float]] = []
    events = reference.events[:FIRST_EVENTS]
    if not events:
        return found
    for halvings in HALVINGS:
        finer = finer_by(engine, halvings)
        if finer is None or finer.step is None:
            break
        until = float(events[-1].time) + 4 * (engine.step or 0.0)
        if until > series_steps(finer) * finer.step:
            break
        try:
            run = run_guarded(finer, reference.scene, until=until, events=4 * len(events) + 64)
        except SceneError:
            break
        late = [value for name in _alone(reference) if (value := _late(reference, run, name)) is not None]
        if late:
            found.append((finer, max(late)))
    return found


def _alone(reference: Trajectory) -> list[str]:
    """Circles whose first meeting is among the first events, and with one other thing, which has met nothing before."""
    met: set[str] = set()
    circles = {str(c.id) for c in reference.scene.circles if not c.fixed}
    found: list[str] = []
    for event in reference.events[:FIRST_EVENTS]:
        for pair in event.impulses:
            movers = [name for name in pair if name in circles]
            if len(event.impulses) == 1 and not met & set(movers):
                found += movers
            met.update(movers)
    return found


def _late(reference: Trajectory, run: Trajectory, name: str) -> float | None:
    """How late a circle's first meeting is; None if it is another, or changes nothing."""
    mine = next(e for e in reference.events if any(name in pair for pair in e.impulses))
    theirs = next((e for e in run.events if any(name in pair for pair in e.impulses)), None)
    if theirs is None or set(theirs.contacts) != set(mine.contacts):
        return None
    start = next(c for c in reference.scene.circles if c.id == name)
    after, got = reference.after(mine.index)[name], run.after(theirs.index)[name]
    kick = math.hypot(float(after.vx) - float(start.vx), float(after.vy) - float(start.vy))
    lag = float(theirs.time) - float(mine.time)
    off = math.hypot(
        float(got.x) - float(after.x) - lag * float(after.vx), float(got.y) - float(after.y) - lag * float(after.vy)
    )
    return max(off / kick, abs(lag)) if kick else None
