"""The width of enclosures: how many bits would have been enough, found by running."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ....scenarios.errors import SceneError
from ....scenarios.trajectory import StopReason
from ..diagnosis import CauseName, Experiment

if TYPE_CHECKING:
    from ....scenarios.engine import Engine
    from ....scenarios.trajectory import OnProgress
    from ...study import Study
    from .stopped import Stopped

MOST_WORK = 1 << 20
"""Bits times events that one try may take: at 1,000 events, numbers of 1,000 bits, some seconds of intervals."""


def width(stopped: Stopped, rows: list[Experiment]) -> list[Experiment]:
    """Whether more bits go on past the stop, and how many."""
    if not stopped.widens:
        return []
    study, progress = stopped.study, stopped.progress
    found = bits_past(study, stopped.engine, stopped.event, progress)
    if found.engine is None:
        return [Experiment(CauseName["WIDTH"], f"with {found.short} bits it stops there too", None, False)]
    past = f"with {found.bits} bits it goes on past event {stopped.event}, with {found.short} it does not"
    told = f"{past}; {_through(study, found.engine, progress)}"
    return [Experiment(CauseName["WIDTH"], told, None, True, 1.0)]


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
    low, chosen = engine.bits, engine.wider()
    while True:
        if chosen is None or chosen.bits is None or chosen.bits * work > MOST_WORK:
            return Fewest(None, low)
        if does(chosen):
            break
        low, chosen = chosen.bits, chosen.wider()
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
