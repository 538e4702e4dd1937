"""Why an engine could not follow the reference to the end."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...scenarios.trajectory import StopReason
from ..foreign.guard import wider_of
from .diagnosis import CauseName, Diagnosis, Experiment
from .widths import bits_past, bits_through
from .zeros import exact_zero

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.trajectory import OnProgress
    from ..candidate import Candidate
    from ..study import Study


def diagnosis_of_stop(study: Study, candidate: Candidate, engine: Engine, progress: OnProgress | None) -> Diagnosis:
    """Why a candidate stopped: what it refuses, its budget, its width, or a zero that no width tells."""
    stop = candidate.trajectory.stop
    if candidate.unable:
        return _only(CauseName.UNABLE, stop.message)
    if stop.reason is not StopReason.UNDECIDED:
        return _only(CauseName.BUDGET, stop.message)
    done = len(candidate.trajectory.events)
    if wider_of(engine) is None:
        return _only(CauseName.UNKNOWN, stop.message)
    found = bits_past(study, engine, done, progress)
    reference = study.longest or study.reference
    here = reference.events[done] if done < len(reference.events) else None
    tied = here is not None and len(here.contacts) > 1
    if found.engine is not None:
        past = f"with {found.bits} bits it goes on past event {done}, with {found.short} it does not"
        told = f"{past}; {_through(study, found.engine, progress)}"
        rows = (Experiment(CauseName.WIDTH, told, None, True, 1.0),)
        return Diagnosis(CauseName.WIDTH, rows, told)
    width = Experiment(CauseName.WIDTH, f"with {found.short} bits it stops there too", None, False)
    if tied:
        told = f"several contacts fall on exactly one instant, event {done}: no enclosure can tell"
        return Diagnosis(CauseName.TIE, (width, Experiment(CauseName.TIE, told, None, True, 1.0)), told)
    zero = exact_zero(reference, done)
    if zero is None:
        none = "no wider numbers were tried" if found.short is None else f"with {found.short} bits it stops there too"
        return Diagnosis(CauseName.UNKNOWN, (width,), f"{none}, and no number is proved to be zero")
    told = f"exactly zero: {zero}; no enclosure can tell"
    return Diagnosis(CauseName.ZERO, (width, Experiment(CauseName.ZERO, told, None, True, 1.0)), told)


def _only(cause: CauseName, told: str) -> Diagnosis:
    return Diagnosis(cause, (Experiment(cause, told, None, True, 1.0),), told)


def _through(study: Study, engine: Engine, progress: OnProgress | None) -> str:
    """With how many bits an engine that goes on past its stop comes to the end, in words."""
    found = bits_through(study, engine, progress)
    if found.bits is None:
        return f"with {found.short} it does not come to the end"
    if found.short is None:
        return f"with {found.bits} it comes to the end too"
    return f"with {found.bits} it comes to the end, with {found.short} it does not"
