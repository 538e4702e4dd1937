"""Why an engine stopped where the reference goes on: a refusal, a budget, its width, or an exact zero."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...scenarios.errors import SceneError
from ...scenarios.trajectory import StopReason
from ..foreign.guard import wider_of
from .diagnosis import CauseName, Diagnosis, Experiment
from .reader import exact_zero

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.trajectory import OnProgress, Trajectory
    from ..candidate import Candidate
    from ..study import Study


@dataclass(frozen=True)
class Stopped:
    """A candidate that could not decide, with what it takes to ask why."""

    study: Study
    candidate: Candidate
    engine: Engine
    progress: OnProgress | None = None

    @property
    def message(self) -> str:
        """What it said itself."""
        return self.candidate.trajectory.stop.message

    @property
    def undecided(self) -> bool:
        """Whether it is a decision that stopped it."""
        return not self.candidate.unable and self.candidate.trajectory.stop.reason is StopReason.UNDECIDED

    @property
    def widens(self) -> bool:
        """Whether it is a decision that stopped it, and wider numbers can be tried."""
        return self.undecided and wider_of(self.engine) is not None

    @property
    def event(self) -> int:
        """How far it came."""
        return len(self.candidate.trajectory.events)

    @property
    def reference(self) -> Trajectory:
        """The longest run of the reference."""
        return self.study.longest or self.study.reference


def diagnosis_of_stop(stopped: Stopped) -> Diagnosis:
    """Why a candidate stopped: what it refuses, its budget, its width, or a zero that no width decides."""
    rows: list[Experiment] = []
    for tried in (unable, budget, width, tied, zero):
        rows += tried(stopped)
        if rows and rows[-1].suffices:
            return Diagnosis((rows[-1].cause,), tuple(rows), rows[-1].result)
    unknown = CauseName["UNKNOWN"]
    if not rows:
        message = stopped.message
        return Diagnosis((unknown,), (Experiment(unknown, message, None, True),), message)
    return Diagnosis((unknown,), tuple(rows), f"{rows[-1].result}, and no number is proved to be zero")


def unable(stopped: Stopped) -> list[Experiment]:
    """A scene that an engine refuses, or of which it declares that it does not follow one of its keys."""
    return [Experiment(CauseName["UNABLE"], stopped.message, None, True)] if stopped.candidate.unable else []


def budget(stopped: Stopped) -> list[Experiment]:
    """A budget of steps, events, work or seconds: what the engine said, where it was no decision that stopped it."""
    if stopped.undecided or stopped.candidate.unable:
        return []
    return [Experiment(CauseName["BUDGET"], stopped.message, None, True)]


def tied(stopped: Stopped) -> list[Experiment]:
    """Whether several contacts fall on the exact instant at which it stopped, which no enclosure separates."""
    events, event = stopped.reference.events, stopped.event
    if not stopped.widens or event >= len(events) or len(events[event].contacts) < 2:
        return []
    told = f"several contacts fall on exactly one instant, event {event}: no enclosure can tell"
    return [Experiment(CauseName["TIE"], told, None, True)]


def zero(stopped: Stopped) -> list[Experiment]:
    """Whether one of the numbers that lead to the event at which it stopped is proved to be exactly zero."""
    found = exact_zero(stopped.reference, stopped.event) if stopped.widens else None
    if found is None:
        return []
    return [Experiment(CauseName["ZERO"], f"exactly zero: {found}; no enclosure can tell", None, True)]


# -- the width of enclosures: how many bits would have been enough, found by running

MOST_WORK = 1 << 20
"""Bits times events that one try may take: at 1,000 events, numbers of 1,000 bits, some seconds of intervals."""


def width(stopped: Stopped) -> list[Experiment]:
    """Whether more bits go on past the stop, and how many."""
    if not stopped.widens:
        return []
    study, progress = stopped.study, stopped.progress
    found = bits_past(study, stopped.engine, stopped.event, progress)
    if found.engine is None:
        return [Experiment(CauseName["WIDTH"], f"with {found.short} bits it stops there too", None, False)]
    past = f"with {found.bits} bits it goes on past event {stopped.event}, with {found.short} it does not"
    told = f"{past}; {_through(study, found.engine, progress)}"
    return [Experiment(CauseName["WIDTH"], told, None, True)]


@dataclass(frozen=True)
class Fewest:
    """What the runs of one engine with more and fewer bits showed.

    Attributes:
        bits: the fewest that were seen to do; None if none was.
        short: the most that were seen not to do: one bit less, where the engine can be built with any number; None if
            the engine as it is does.
        engine: the engine with `bits`.
    """

    bits: int | None
    short: int | None
    engine: Engine | None = None


def bits_past(study: Study, engine: Engine, event: int, progress: OnProgress | None = None) -> Fewest:
    """The fewest bits with which an engine goes on past so many events."""
    until = study.until_event(event)

    def does(chosen: Engine) -> bool:
        run = study.whole_run(chosen, study.scene, until, progress)
        return len(run.events) > event or run.stop.reason is not StopReason.UNDECIDED

    return _fewest(engine, does, event + 1)


def bits_through(study: Study, engine: Engine, progress: OnProgress | None = None) -> Fewest:
    """The fewest bits, from its own on, with which an engine decides all that the reference has inside the span."""

    def does(chosen: Engine) -> bool:
        run = study.whole_run(chosen, study.scene, study.span.time, progress)
        return run.stop.reason is not StopReason.UNDECIDED

    return _fewest(engine, does, len(study.reference.events) + 1)


def _fewest(engine: Engine, does: Callable[[Engine], bool], work: int) -> Fewest:
    """Found by doubling and halving, so that both bounds are runs.

    Args:
        does: whether an engine's run decides what is asked.
        work: what one run takes, times bits.
    """
    if engine.bits is None or does(engine):
        return Fewest(engine.bits, None, engine)
    low, chosen = engine.bits, wider_of(engine)
    while True:
        if chosen is None or chosen.bits is None or chosen.bits * work > MOST_WORK:
            return Fewest(None, low)
        if does(chosen):
            break
        low, chosen = chosen.bits, wider_of(chosen)
    high, enough = chosen.bits, chosen
    while high - low > 1:
        middle = (low + high) // 2
        try:
            between = _with_bits(engine, middle)
        except (TypeError, SceneError):
            break
        if does(between):
            high, enough = middle, between
        else:
            low = middle
    return Fewest(high, low, enough)


def _through(study: Study, engine: Engine, progress: OnProgress | None) -> str:
    """With how many bits an engine that goes on past its stop comes to the end, in words."""
    found = bits_through(study, engine, progress)
    if found.bits is None:
        return f"with {found.short} it does not come to the end"
    if found.short is None:
        return f"with {found.bits} it comes to the end too"
    return f"with {found.bits} it comes to the end, with {found.short} it does not"


def _with_bits(engine: Any, bits: int) -> Engine:
    """The same engine with so many bits.

    Raises:
        TypeError, SceneError: if it cannot be built so.
    """
    return dataclasses.replace(engine, bits=bits)
