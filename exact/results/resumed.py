"""A history carried out again from a saved run gets the numbers and counts that the run had."""

from __future__ import annotations

from dataclasses import replace

from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import Quantity, Real
from ...scenarios.numbers.tower_element import AnyTower, Element
from ...scenarios.numbers.tower_ring import TowerLimit
from ...scenarios.trajectory import StopReason, Trajectory
from ..numbers.field import Known, known_ball
from ..replay.contact import Named
from ..simulation.history import History, Mark
from ..simulation.limits import Limits
from ..simulation.loop import stopped
from ..simulation.tape import Reached, Tape
from .motion import ExactMotion
from .times import Source, TimeFormula
from .value import ExactValue

NOT_ITS_LOG = "the log is not what its scene does; save the run again"

CHECK_BITS = 128
"""Bits to which an exact time of the file is held against the one that comes of carrying the log out."""

FORGED = (ArithmeticError, AssertionError, AttributeError, LookupError, TypeError, ValueError)
"""What comes up where a log is carried out that no run has written."""


def tape_of(run: Trajectory) -> tuple[ExactMotion, Tape, Reached | None]:
    """What a run left for one that goes on from it.

    Raises:
        SceneError: for a run that left nothing.
    """
    motion = run.motion
    if not isinstance(motion, ExactMotion) or motion.tape is None:
        raise SceneError("only runs of the exact engine, with the scene's own tie policy, are gone on with")
    return motion, motion.tape, motion.tape.reached


def within(run: Trajectory, limits: Limits, reached: Reached) -> bool:
    """Whether all that a run had when it last looked for an instant lies before some limits, clearly."""
    had = [event.time for event in run.events if _number(event.time) <= 2 * reached.instants + 1]
    if limits.events is not None and limits.events <= len(had):
        return False
    had += [entry.time for entry in run.pocketings] + ([] if run.reversal is None else [run.reversal.time])
    return limits.until is None or all(time.bounds()[1] < limits.until.bounds()[0] for time in had)


def farther(run: Trajectory, again: Trajectory, limits: Limits) -> Trajectory:
    """What went on from a run; the run itself, where that was ended before it was as far and the limits admit it."""
    reason, had = again.stop.reason, len(run.events)
    if reason not in (StopReason.INTERRUPTED, StopReason.BUDGET) or len(again.events) >= had:
        return again
    if limits.events is not None and limits.events < had:
        return again
    if limits.until is not None and limits.until.bounds()[1] < run.events[-1].time.bounds()[0]:
        return again
    return replace(run, stop=stopped(reason, had) if reason is StopReason.INTERRUPTED else again.stop)


def _number(time: Real) -> int:
    assert isinstance(time, ExactValue)
    assert time.instant is not None
    return time.instant


def restore(history: History[Known], run: Trajectory, limits: Limits, tower: AnyTower) -> None:
    """Gives a history that was carried out again the numbers and counts of the run that it is the beginning of.

    Args:
        history: as `Loop.take_up` left it.
        run: that run.
        limits: where the history is to end.
        tower: of its exact numbers.

    Raises:
        SceneError: if it is not the beginning of that run.
    """
    motion, _, reached = tape_of(run)
    assert reached is not None
    if not _same(history, run, motion):
        raise SceneError(NOT_ITS_LOG)
    number = Moved(tower)
    times = {
        (value.instant, value.upto, _source(value)): number(value.near)
        for value in (*(e.time for e in run.events), *(e.time for e in run.pocketings))
        if isinstance(value, ExactValue)
    }
    if run.reversal is not None and isinstance(run.reversal.time, ExactValue):
        value = run.reversal.time
        times[value.instant, value.upto, _source(value)] = number(value.near)

    def timed(mark: Mark[Known]) -> Mark[Known]:
        time = times[mark.number, mark.step, mark.source]
        if not known_ball(time, CHECK_BITS).overlaps(known_ball(mark.time, CHECK_BITS)):
            raise SceneError(NOT_ITS_LOG)
        return mark._replace(time=time)

    history.records = [record._replace(mark=timed(record.mark)) for record in history.records]
    history.entries = [entry._replace(mark=timed(entry.mark)) for entry in history.entries]
    history.last = None if history.last is None else timed(history.last)
    if history.reversal is not None:
        history.reversal = (history.reversal[0], timed(history.reversal[1]))
    history.knots = [
        [
            (number(t), number(x), number(y), number(vx), number(vy), step, instant)
            for t, x, y, vx, vy, step, instant in row[: len(mine)]
        ]
        for mine, row in zip(history.knots, motion.knots, strict=True)
    ]
    history.plan.clear()
    history.plan.update(reached.plan)
    history.assumptions[:] = run.assumptions[: reached.assumed]
    wanted = {limits.until, run.scene.reverse_at}
    last = 2 * reached.instants + 1
    history.set_times = {t: part for t, part in motion.set_times.items() if t in wanted and part <= last}


def _source(value: ExactValue) -> Source:
    assert isinstance(value.formula, TimeFormula)
    return value.formula.source


def _same(history: History[Known], run: Trajectory, motion: ExactMotion) -> bool:
    """Whether a history is the beginning of a run: the same steps, events and flights."""
    named = Named(run.scene)
    if history.steps != list(motion.log.steps[: len(history.steps)]) or len(history.records) > len(run.events):
        return False
    if len(history.knots) != len(motion.knots):
        return False
    for record, event in zip(history.records, run.events, strict=False):
        links = [named(record.links), named(record.impulses)]
        if links != [event.contacts, event.impulses] or record.mark.number != _number(event.time):
            return False
    return all(
        [knot[5:] for knot in mine] == [knot[5:] for knot in row[: len(mine)]]
        for mine, row in zip(history.knots, motion.knots, strict=True)
    )


class Moved:
    """Numbers of another field of the same roots, in this one.

    Args:
        tower: this one's.
    """

    def __init__(self, tower: AnyTower) -> None:
        self._tower = tower
        self._known: dict[str, Element] = {}

    def __call__(self, number: Known) -> Known:
        """One number.

        Raises:
            SceneError: if it is not in the field.
        """
        if not isinstance(number, Element) or number.tower is self._tower:
            return number
        text = number.text()
        try:
            if text not in self._known:
                self._known[text] = Quantity.of(text).in_tower(self._tower)
        except TowerLimit:
            raise SceneError(NOT_ITS_LOG) from None
        return self._known[text]
