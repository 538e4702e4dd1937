"""Why an engine could not follow the reference to the end."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

from ...scenarios.errors import SceneError
from ...scenarios.trajectory import StopReason
from .diagnosis import CauseName, Diagnosis, Experiment

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.trajectory import OnProgress, Trajectory
    from ..candidate import Candidate
    from ..study import Study

MOST_BITS = 1 << 13
"""The widest numbers that are tried, and `MOST_WORK` bits times events in all."""

MOST_WORK = 1 << 20
"""Bits times events that one try may take: at 1,000 events, numbers of 1,000 bits, some seconds of intervals."""


def diagnosis_of_stop(study: Study, candidate: Candidate, engine: Engine, progress: OnProgress | None) -> Diagnosis:
    """Why a candidate stopped: what it refuses, its budget, its width, or a zero that no width tells."""
    stop = candidate.trajectory.stop
    if candidate.unable:
        return _only(CauseName.UNABLE, stop.message)
    if stop.reason is not StopReason.UNDECIDED:
        return _only(CauseName.BUDGET, stop.message)
    done = len(candidate.trajectory.events)
    if engine.wider() is None:
        return _only(CauseName.UNKNOWN, stop.message)
    enough, tried = bits_enough(study, engine, done, progress)
    reference = study.longest or study.reference
    here = reference.events[done] if done < len(reference.events) else None
    tied = here is not None and len(here.contacts) > 1
    if enough is not None:
        told = f"with {enough} bits it goes on past event {done}, with fewer it does not"
        rows = (Experiment(CauseName.WIDTH, told, None, True, 1.0),)
        return Diagnosis(CauseName.WIDTH, rows, told)
    width = Experiment(CauseName.WIDTH, f"with {tried} bits it stops there too", None, False)
    if tied:
        told = f"several contacts fall on exactly one instant, event {done}: no enclosure can tell"
        return Diagnosis(CauseName.TIE, (width, Experiment(CauseName.TIE, told, None, True, 1.0)), told)
    told = f"with {tried} bits it stops there too: a sign that is exactly zero, no enclosure can tell"
    return Diagnosis(CauseName.ZERO, (width, Experiment(CauseName.ZERO, told, None, True, 1.0)), told)


def _only(cause: CauseName, told: str) -> Diagnosis:
    return Diagnosis(cause, (Experiment(cause, told, None, True, 1.0),), told)


def bits_enough(study: Study, engine: Engine, done: int, progress: OnProgress | None = None) -> tuple[int | None, int]:
    """The fewest bits with which an engine goes on past so many events, and the most that were tried.

    Found by doubling and halving, so that the run with so many bits decides it, and the one with a bit less does not.
    """

    def goes_on(wider: Engine) -> bool:
        run: Trajectory = study.run(wider, study.scene, study.until_event(done), progress)
        return len(run.events) > done or run.stop.reason is not StopReason.UNDECIDED

    low, high = _bits(engine), 0
    chosen: Engine | None = engine
    while not high:
        chosen = None if chosen is None else chosen.wider()
        bits = 0 if chosen is None else _bits(chosen)
        if chosen is None or bits > MOST_BITS or bits * (done + 1) > MOST_WORK:
            return None, low
        if goes_on(chosen):
            high = bits
        else:
            low = bits
    while high - low > 1:
        middle = (low + high) // 2
        try:
            between = dataclasses.replace(engine, bits=middle)  # type: ignore[type-var]
        except (TypeError, SceneError):
            return high, high
        low, high = (low, middle) if goes_on(between) else (middle, high)
    return high, high


def _bits(engine: Engine) -> int:
    own = getattr(engine, "bits", None)
    return own if isinstance(own, int) else 1
