"""The times of a run, each with the formula that computes it again from the log."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

from ..numbers.system import Number
from ..replay.steps import Link
from ..simulation.history import Mark
from .run_log import RunLog
from .value import ExactValue

RETURN = "return"
"""The source of the time at which a reversed run is back: twice that of the reversal."""

START = "start"
"""The source of time 0, where nothing happened after it."""

Source: TypeAlias = int | Link | str
"""The circle whose clock stands at a time; or the meeting that comes at it; or `REVERSAL`, RETURN, START."""


@dataclass(frozen=True)
class TimeFormula:
    """Computes a time from the state at the end of its instant."""

    source: Source

    @property
    def bodies(self) -> tuple[int, ...]:
        """The circles that it depends on."""
        if isinstance(self.source, tuple):
            return self.source[:1]
        return (self.source,) if isinstance(self.source, int) else (0,)

    def __call__(self, state: Any) -> Number:
        source = self.source
        if isinstance(source, int):
            return state.bodies[source].instant
        if isinstance(source, tuple):
            clock, wait = state.hit(source)
            return clock + wait
        if source == START:
            return state.zero
        return state.flip_time + state.flip_time if source == RETURN else state.flip_time


def time_of(log: RunLog, mark: Mark) -> ExactValue:
    """The time of an instant, which knows its exact value."""
    formula = TimeFormula(mark.source)
    return ExactValue(log, mark.step, formula.bodies, formula, mark.time, instant=mark.number)


def time_of_return(log: RunLog, reversal: Mark, instant: int) -> ExactValue:
    """Twice the time of the reversal; `instant` is the last at which anything happens."""
    return time_of(log, Mark(instant, reversal.time + reversal.time, reversal.step, RETURN))


def time_zero(log: RunLog, zero: Number) -> ExactValue:
    """Time 0 of a run in which nothing happened."""
    return time_of(log, Mark(0, zero, 0, START))
