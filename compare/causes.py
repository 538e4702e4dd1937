"""Why an engine left the reference's history, found by experiment."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

from ..scenarios.errors import SceneError
from ..scenarios.trajectory import StopReason
from .align import Kind, align
from .rounding import rounded

if TYPE_CHECKING:
    from ..scenarios.engine import Engine
    from ..scenarios.trajectory import OnProgress, Trajectory
    from .align import Alignment, Divergence
    from .comparison import Candidate, Study

STEP_DIVISORS = (4, 16)
"""A divergence that comes of the time step moves, or goes, when the step is a quarter, at last a sixteenth."""

STEP_SECONDS = 20.0
"""No experiment with a smaller step is begun that would take longer than this, judged by the run at hand."""

OVERRUN = 1 / 32
"""Experiments run this share past the divergence."""


class CauseName(Enum):
    """The classes of causes; the value is what a person reads."""

    INPUT = "input rounding"
    ARITHMETIC = "arithmetic rounding"
    STEP = "time step"
    TIE = "tie"
    WIDTH = "enclosure width"
    BUDGET = "budget"
    UNABLE = "scene not possible in this engine"
    MODEL = "model"


@dataclass(frozen=True)
class Cause:
    """Why, and what the experiments showed.

    Attributes:
        name: the class of cause.
        evidence: one sentence that says which experiment had which result.
    """

    name: CauseName
    evidence: str

    def __str__(self) -> str:
        return self.name.value


def cause_of(study: Study, candidate: Candidate, engine: Engine, progress: OnProgress | None) -> Cause:
    """The cause of a candidate's divergence, by the first experiment that explains it.

    1. For an engine with a time step: does the divergence move when the step is smaller?
    2. Is it the order among contacts of one instant? That is seen in the events themselves.
    3. Input rounding: does the reference engine, on the scene rounded to doubles, diverge as early?
    4. Arithmetic rounding: does the candidate differ from the reference engine on that same rounded scene?
    Otherwise the difference is one of model.
    """
    divergence = candidate.alignment.divergence
    assert divergence is not None
    stepped = "dt" in candidate.trajectory.parameters and hasattr(engine, "dt")
    if stepped:
        smaller = _smaller_step(study, candidate, engine, divergence, progress)
        if smaller is not None:
            return smaller
    tie = _tie(study, candidate, divergence)
    if tie is not None:
        return tie
    if stepped:
        before = study.reference.events[: divergence.event + 1]
        earlier = [e.index for e in before if e.coupled and float(e.time) <= divergence.time]
        if earlier:
            return Cause(
                CauseName.TIE,
                f"a smaller step does not move it, and at event {earlier[-1]} several contacts fall on one instant "
                "so that the order of their impulses matters",
            )
    return _rounding(study, candidate, divergence, progress, stepped)


def _tie(study: Study, candidate: Candidate, divergence: Divergence) -> Cause | None:
    """The order among contacts of one instant, where an event says that it matters."""
    if divergence.kind is Kind.TIE:
        return Cause(
            CauseName.TIE,
            f"the reference has {divergence.expected}, {candidate.trajectory.engine} has {divergence.got}, "
            "and the two lead to different velocities",
        )
    reference, index = study.reference, divergence.event
    if index < len(reference.events) and reference.events[index].coupled:
        together = {name for pair in reference.events[index].contacts for name in pair}
        if divergence.body in together and divergence.got in together:
            return Cause(
                CauseName.TIE,
                f"{len(reference.events[index].contacts)} contacts fall on one instant, {divergence.got} among them, "
                "and the order of their impulses matters",
            )
    return None


def _reaches(study: Study, divergence: Divergence) -> float:
    """The share of the span that an experiment must cover to show a divergence."""
    return min(1.0, divergence.time / study.span) if study.span else 1.0


def _later(alignment: Alignment, divergence: Divergence) -> bool:
    """Whether a run agrees for longer than one that diverged."""
    return alignment.divergence is None or alignment.divergence.event > divergence.event


def _smaller_step(
    study: Study, candidate: Candidate, engine: Engine, divergence: Divergence, progress: OnProgress | None
) -> Cause | None:
    dt = engine.dt  # type: ignore[attr-defined]
    for divisor in STEP_DIVISORS:
        if candidate.seconds * divisor > STEP_SECONDS:
            break
        changes = {"dt": dt / divisor}
        if hasattr(engine, "max_steps"):
            changes["max_steps"] = engine.max_steps * divisor  # type: ignore[attr-defined]
        finer = dataclasses.replace(engine, **changes)  # type: ignore[type-var]
        run = study.run(finer, study.scene, progress, share=_reaches(study, divergence))
        alignment = study.aligned(run)
        if _later(alignment, divergence):
            then = alignment.divergence
            what = f"first differs at event {then.event}" if then else "agrees up to there"
            return Cause(CauseName.STEP, f"with a step {divisor} times smaller, {dt / divisor:.3g}, it {what}")
    return None


def _rounding(
    study: Study, candidate: Candidate, divergence: Divergence, progress: OnProgress | None, stepped: bool
) -> Cause:
    name = candidate.trajectory.engine
    try:
        scene = rounded(study.scene)
    except SceneError as error:
        return Cause(CauseName.INPUT, f"rounded to doubles, the scene is no longer valid: {error}")
    if scene.digest == study.scene.digest:
        if stepped:
            return Cause(CauseName.MODEL, "the scene is exact in doubles, and a smaller step does not move it")
        return Cause(CauseName.ARITHMETIC, "the scene is exact in doubles, so no input was rounded")
    share = _reaches(study, divergence)
    truth = study.run(study.truth, scene, progress, share)
    by_input = study.aligned(truth)
    by_arithmetic = align(truth, candidate.trajectory, span=min(study.span, float(truth.final_time)))
    input_event = _event(by_input)
    arithmetic_event = _event(by_arithmetic)
    said = (
        f"the reference engine on the scene rounded to doubles {_told(input_event)}; "
        f"{name} leaves that run {_told(arithmetic_event, 'not at all up to there')}"
    )
    if input_event is not None and input_event <= divergence.event:
        return Cause(CauseName.INPUT, said)
    if arithmetic_event is not None and not stepped:
        return Cause(CauseName.ARITHMETIC, said)
    if stepped:
        return Cause(CauseName.MODEL, f"neither a smaller step nor rounding of the input moves it: {said}")
    return Cause(CauseName.INPUT if input_event is not None else CauseName.MODEL, said)


def _event(alignment: Alignment) -> int | None:
    return alignment.divergence.event if alignment.divergence else None


def _told(event: int | None, otherwise: str = "agrees up to there") -> str:
    return otherwise if event is None else f"differs at event {event}" if otherwise[0] == "a" else f"at event {event}"


def cause_of_stop(study: Study, candidate: Candidate, engine: Engine, progress: OnProgress | None) -> Cause:
    """Why a candidate could not follow the reference to the end."""
    stop = candidate.trajectory.stop
    if stop.reason is not StopReason.UNDECIDED:
        return Cause(CauseName.BUDGET, stop.message)
    if not candidate.trajectory.parameters and not candidate.trajectory.events:
        return Cause(CauseName.UNABLE, stop.message)
    done = len(candidate.trajectory.events)
    key = next((k for k in ("bits", "precision", "prec") if isinstance(getattr(engine, k, None), int)), None)
    if key is not None:
        wider = dataclasses.replace(engine, **{key: 2 * getattr(engine, key)})  # type: ignore[type-var]
        run = study.run(wider, study.scene, progress)
        if len(run.events) > done:
            return Cause(
                CauseName.WIDTH, f"with {2 * getattr(engine, key)} bits it goes on to {len(run.events)} events"
            )
    if _tied(study.reference, done):
        return Cause(CauseName.TIE, f"several contacts fall on the instant of event {done}: no interval can tell")
    return Cause(CauseName.WIDTH, stop.message)


def _tied(reference: Trajectory, index: int) -> bool:
    return index < len(reference.events) and len(reference.events[index].contacts) > 1
