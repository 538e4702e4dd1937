"""How many bits would have been enough: found by running."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ...scenarios.errors import SceneError
from ...scenarios.trajectory import StopReason
from ..foreign.guard import wider_of

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.trajectory import OnProgress
    from ..study import Study

MOST_WORK = 1 << 20
"""Bits times events that one try may take: at 1,000 events, numbers of 1,000 bits, some seconds of intervals."""


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
            between: Engine = dataclasses.replace(engine, bits=middle)  # type: ignore[type-var]
        except (TypeError, SceneError):
            break
        if does(between):
            high, enough = middle, between
        else:
            low = middle
    return Fewest(high, low, enough)
