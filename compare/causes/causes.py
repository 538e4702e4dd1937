"""Why an engine left the reference's history, found by experiment."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

from ...scenarios.errors import SceneError
from ...scenarios.trajectory import StopReason
from ..alignment.align import align
from ..alignment.divergence import Kind
from ..deadline import OutOfTime
from ..engines import engine, is_stepped
from .rounding import rounded

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import OnProgress, Trajectory
    from ..alignment.align import Alignment
    from ..alignment.divergence import Divergence
    from ..candidate import Candidate
    from ..study import Study

STEP_DIVISORS = (4, 16)
"""A divergence that comes of the time step moves or goes when the step is a quarter, or a sixteenth."""

EXPERIMENT_SECONDS = 20.0
"""Longest that one experiment may run."""

LONGER = 2.0
"""Experiments run to this many times the time of the divergence: a run that is a little off has its events
at other times, and must come to the one in question."""


class CauseName(Enum):
    """The classes of causes; the value is what a person reads."""

    INPUT = "input rounding"
    ARITHMETIC = "arithmetic rounding"
    STEP = "time step"
    TIE = "tie"
    WIDTH = "enclosure width"
    ZERO = "exact zero"
    BUDGET = "budget"
    UNABLE = "scene not possible in this engine"
    MODEL = "model"
    UNKNOWN = "not determined"


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


def cause_of(study: Study, candidate: Candidate, played: Engine, progress: OnProgress | None) -> Cause:
    """The cause of a candidate's divergence, by the first experiment that explains it.

    1. For an engine with a time step: does the divergence move when the step is smaller?
    2. Does the reference have several contacts at one instant there, whose order matters?
    3. Input rounding: does the reference engine, on the scene rounded to doubles, leave the reference's
       history too, and does the candidate still follow it at the divergence?
    4. Arithmetic rounding: does the candidate differ from the reference engine on that same rounded scene?
       With a time step: does the double engine, which has none, diverge too?
    Otherwise the difference is one of model.
    """
    divergence = candidate.alignment.divergence
    assert divergence is not None
    stepped = is_stepped(candidate.trajectory.engine)
    try:
        if stepped:
            smaller = _smaller_step(study, candidate, played, divergence, progress)
            if smaller is not None:
                return smaller
        tie = _tie(study, candidate, divergence)
        if tie is not None:
            return tie
        return _rounding(study, candidate, divergence, progress, stepped)
    except OutOfTime:
        return Cause(CauseName.UNKNOWN, f"an experiment took more than {EXPERIMENT_SECONDS:g} s")


def _tie(study: Study, candidate: Candidate, divergence: Divergence) -> Cause | None:
    """Contacts of one exact instant, where their order matters and the candidate has another."""
    name, reference = candidate.trajectory.engine, study.reference
    if divergence.kind is Kind.TIE and not _at_several(divergence.expected):
        return Cause(
            CauseName.TIE,
            f"the reference has {divergence.expected} at exactly one instant, {name} has {divergence.got}, "
            "and the two lead to different velocities",
        )
    if divergence.event < len(reference.events) and reference.events[divergence.event].coupled:
        contacts = reference.events[divergence.event].contacts
        together = {thing for pair in contacts for thing in pair}
        if divergence.body in together and divergence.got in together:
            return Cause(
                CauseName.TIE,
                f"{len(contacts)} contacts fall on exactly one instant, {divergence.got} among them, "
                "and the order of their impulses matters",
            )
    if is_stepped(name):
        before = reference.events[: divergence.event + 1]
        coupled = [e for e in before if e.coupled and float(e.time) <= divergence.time]
        if coupled:
            return Cause(
                CauseName.TIE,
                f"a smaller step does not move it, and at event {coupled[-1].index} several contacts fall on "
                "exactly one instant, where the order of impulses matters",
            )
        if divergence.kind is Kind.TIE:
            return Cause(
                CauseName.TIE,
                f"one step holds {divergence.got}, which the reference has as {divergence.expected}, "
                "and a smaller step does not tell them apart",
            )
    return None


def _at_several(partners: str | None) -> bool:
    """Whether the partners of a tie are met at several instants."""
    return partners is not None and " then " in partners


def _later(alignment: Alignment, divergence: Divergence) -> bool:
    """Whether a run agrees for longer than one that diverged."""
    return alignment.divergence is None or alignment.divergence.event > divergence.event


def _smaller_step(
    study: Study, candidate: Candidate, engine: Engine, divergence: Divergence, progress: OnProgress | None
) -> Cause | None:
    dt: float = engine.dt  # type: ignore[attr-defined]
    for divisor in STEP_DIVISORS:
        if candidate.seconds * divisor > EXPERIMENT_SECONDS:
            break
        changes = {"dt": dt / divisor}
        if hasattr(engine, "max_steps"):
            changes["max_steps"] = engine.max_steps * divisor  # type: ignore[attr-defined]
        finer = dataclasses.replace(engine, **changes)  # type: ignore[type-var]
        run = study.experiment(finer, study.scene, divergence, progress, LONGER, EXPERIMENT_SECONDS)
        alignment = align(study.reference, run, span=study.span, step=dt / divisor)
        if _later(alignment, divergence):
            then = alignment.divergence
            what = f"first differs at event {then.event}" if then else "agrees up to there"
            return Cause(CauseName.STEP, f"with a step {divisor} times smaller, {dt / divisor:.3g}, it {what}")
    return None


def _rounding(
    study: Study,
    candidate: Candidate,
    divergence: Divergence,
    progress: OnProgress | None,
    stepped: bool,
) -> Cause:
    name = candidate.trajectory.engine
    scene = _rounded(study.scene)
    if isinstance(scene, Cause):
        return scene
    still = "a smaller step does not move it; " if stepped else ""
    said = "the scene is exact in doubles, so no input was rounded"
    by_input = None
    if scene.digest != study.scene.digest:
        truth = study.experiment(study.truth, scene, divergence, progress, LONGER, EXPERIMENT_SECONDS)
        by_input = align(study.reference, truth, span=study.span).divergence
        rest = align(truth, candidate.trajectory, span=min(study.span, float(truth.final_time))).divergence
        said = (
            f"the reference engine on the scene rounded to doubles {_told(by_input, 'differs', 'agrees')}; "
            f"{name} {_told(rest, 'leaves that run', 'does not leave that run')}"
        )
        if by_input is not None and (rest is None or rest.event > divergence.event):
            return Cause(CauseName.INPUT, still + said)
        if rest is None and not stepped:
            return Cause(CauseName.UNKNOWN, said)
    if not stepped:
        return Cause(CauseName.ARITHMETIC, said)
    double = study.experiment(engine("double"), study.scene, divergence, progress, LONGER, EXPERIMENT_SECONDS)
    by_double = align(study.reference, double, span=study.span).divergence
    evidence = f"{still}{said}; double {_told(by_double, 'differs', 'agrees')}"
    return Cause(CauseName.MODEL if by_double is None else CauseName.ARITHMETIC, evidence)


def _told(divergence: Divergence | None, differs: str, agrees: str) -> str:
    """What became of an experiment."""
    return agrees if divergence is None else f"{differs} at event {divergence.event}"


def _rounded(scene: Scene) -> Scene | Cause:
    """The scene in doubles, or what that comes to if it is none."""
    try:
        return rounded(scene)
    except SceneError as error:
        return Cause(CauseName.INPUT, f"rounded to doubles, the scene is no longer valid: {error}")


def cause_of_stop(study: Study, candidate: Candidate, engine: Engine, progress: OnProgress | None) -> Cause:
    """Why a candidate could not follow the reference to the end: would wider numbers have gone on?"""
    stop = candidate.trajectory.stop
    if stop.reason is not StopReason.UNDECIDED:
        return Cause(CauseName.BUDGET, stop.message)
    if candidate.unable:
        return Cause(CauseName.UNABLE, stop.message)
    done = len(candidate.trajectory.events)
    key = next((k for k in ("bits", "precision", "prec") if isinstance(getattr(engine, k, None), int)), None)
    if key is None:
        return Cause(CauseName.UNKNOWN, stop.message)
    bits = 2 * getattr(engine, key)
    wider = dataclasses.replace(engine, **{key: bits})  # type: ignore[type-var]
    try:
        run = study.run(wider, study.scene, progress, EXPERIMENT_SECONDS)
    except OutOfTime:
        return Cause(CauseName.UNKNOWN, f"with {bits} bits it runs for more than {EXPERIMENT_SECONDS:g} s")
    if len(run.events) > done:
        return Cause(CauseName.WIDTH, f"with {bits} bits it goes on to {len(run.events)} events")
    if _tied(study.reference, done):
        return Cause(
            CauseName.TIE,
            f"several contacts fall on exactly one instant, event {done}: no enclosure can tell",
        )
    return Cause(
        CauseName.ZERO,
        f"with {bits} bits it stops there too: a sign that is exactly zero, no enclosure can tell",
    )


def _tied(reference: Trajectory, index: int) -> bool:
    return any(len(event.contacts) > 1 for event in reference.events[index : index + 1])
