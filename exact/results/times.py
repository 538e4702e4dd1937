"""The times of a run, each with the formula that computes it again from the log."""

from __future__ import annotations

from typing import TypeAlias

from ...scenarios.lazy import frozen
from ..numbers.field import Known
from ..numbers.system import N
from ..replay.contact import Link
from ..replay.state import State
from ..simulation.history import Mark
from .run_log import RunLog
from .value import ExactValue

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

    def __call__(self, state: State[N]) -> N:
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


def time_zero(log: RunLog, zero: Known) -> ExactValue:
    """Time 0 of a run in which nothing happened."""
    return time_of(log, Mark(0, zero, 0, START))
