"""One scene of a sweep in every engine: a row each, of plain data."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from ....exact.exact_engine import ExactEngine
from ....scenarios.errors import SceneError
from ....scenarios.numbers.quantity import Quantity
from ...alignment.align import separation
from ...audit.audit import audit_run
from ...candidate import Candidate
from ...chaos.following import Followed, follow
from ...chaos.growth.spectrum import spectrum
from ...chaos.horizon import MORE_EVENTS, Forecaster, Horizon
from ...comparison import explained
from ...deadline import uninterrupted
from ...engines import engine as engine_named
from ...files.amounts import plain
from ...files.documents import laws_brief
from ...outcomes.matched import held
from ...outcomes.outcome import outcome
from ...scene_argument import scene_from
from ...tangent.impacts import NoTangentMap, impacts
from .perturbed import Perturbed

if TYPE_CHECKING:
    from ....scenarios.engine import Engine
    from ....scenarios.trajectory import Trajectory

SweepRow = dict[str, Any]

PERTURBED = "perturbed:"
"""What the label of a displaced scene's certified run begins with."""


DISPLACED = "displaced start"
"""Why the certified run of a displaced scene leaves the history: there is nothing else."""


@dataclass(frozen=True)
class SweepJob:
    """One scene and what is asked of it; small, and made of text, so that any worker can take it.

    Attributes:
        index: its place in the sweep.
        spec: the scene's text.
        settings: its varied parameters.
        engines: labels of engines, and `perturbed:SIZE`.
        events: of the certified run; None: the scene's own limit.
        outcomes: names of outcomes to compare at the end; each engine then runs to the end.
        causes: whether to find out why engines left.
        work: what one question may cost the exact engine; None: its default.
        audit: whether every step of each engine's run is audited, as far as it was followed.
    """

    index: int
    spec: str
    settings: Mapping[str, str]
    engines: tuple[str, ...]
    events: int | None = None
    outcomes: tuple[str, ...] = ()
    causes: bool = False
    work: int | None = None
    audit: bool = True


def rows_of(job: SweepJob) -> list[SweepRow]:
    """The rows of one scene, in the order of its engines; the same on every machine.

    A scene that cannot be built, and an engine that cannot take it, are rows too, with the verdict `refused`.
    """
    shared: SweepRow = {"index": job.index, "scene": job.spec, "digest": None, "parameters": dict(job.settings)}
    try:
        scene = scene_from(job.spec)
        truth = ExactEngine() if job.work is None else ExactEngine(work=job.work)
        reference = uninterrupted(truth.run(scene, events=job.events))
    except SceneError as error:
        return [{**_blank(shared, label), "verdict": "refused", "note": str(error)} for label in job.engines]
    shared |= {
        "digest": scene.digest,
        "events": len(reference.events),
        "time": float(reference.final_time),
        "stop": reference.stop.reason.name.lower(),
        "work": dict(sorted((str(k), plain(v)) for k, v in reference.plan.items())),
        "versions": versions(),
    }
    forecaster, exponent = _forecast(reference, shared)
    return [_row(job, label, shared, reference, forecaster, exponent) for label in job.engines]


def _forecast(reference: Trajectory, shared: SweepRow) -> tuple[Forecaster | None, float]:
    """What the certified run foresees; the largest exponent goes into the rows."""
    shared |= dict.fromkeys(("lyapunov", "lyapunov_low", "lyapunov_high"))
    if not reference.events:
        return None, 0.0
    try:
        struck = impacts(reference, len(reference.events))
    except NoTangentMap:
        return None, 0.0
    if all(circle.fixed for circle in reference.scene.circles):
        return None, 0.0
    found = spectrum(reference.scene, struck, 1)
    told = found.per_time()
    shared |= {"lyapunov": told.value, "lyapunov_low": told.low, "lyapunov_high": told.high}
    return Forecaster(reference, struck), told.value if found.chaotic else 0.0


def _row(
    job: SweepJob, label: str, shared: SweepRow, reference: Trajectory, forecaster: Forecaster | None, exponent: float
) -> SweepRow:
    row = _blank(shared, label)
    engine = engine_of(label, job.index)
    horizon = None if forecaster is None else forecaster.foresee(label, engine, exponent)
    eps = _unit(label, horizon)
    if exponent > 0 and eps is not None:
        row["by_exponent"] = -eps * math.log(2) / exponent
    foreseen = len(reference.events) if job.outcomes else None
    if horizon is not None:
        row |= {f"foreseen{end}": place.event for end, place in (
            ("", horizon.expected), ("_low", horizon.low), ("_high", horizon.high))}  # fmt: skip
        if foreseen is None:
            foreseen = None if horizon.high.event is None else horizon.high.event + MORE_EVENTS
    try:
        told = follow(reference, engine, foreseen)
    except SceneError as error:
        return {**row, "verdict": "refused", "note": str(error)}
    if told.unable:
        return {**row, "verdict": "refused", "note": told.run.stop.message}
    divergence = told.alignment.divergence
    row |= {"verdict": told.alignment.verdict, "agreed": told.alignment.agreed}
    if divergence is not None:
        row |= {"event": divergence.event, "at": divergence.time, "body": divergence.body,
                "expected": divergence.expected, "got": divergence.got, "kind": divergence.kind.value}  # fmt: skip
    if job.audit and not label.startswith(PERTURBED):
        row["laws"] = laws_brief(audit_run(told.run, engine))
    if job.outcomes and told.alignment.verdict in ("agree", "diverged"):
        row["changed"] = _changed(job, told, reference, engine.step)
    if job.causes:
        row |= {"cause": DISPLACED} if divergence and label.startswith(PERTURBED) else _why(told, label, engine)
    return row


def _blank(shared: SweepRow, label: str) -> SweepRow:
    return {**dict.fromkeys(COLUMNS), **shared, "engine": label}


def _changed(job: SweepJob, told: Followed, reference: Trajectory, step: float | None) -> list[str] | None:
    """The outcomes that differ, of those asked for; None where the run ends before the span does."""
    chosen = {name: outcome(name) for name in job.outcomes}

    def tell(run: Trajectory) -> dict[str, Any]:
        return {name: value(run) for name, value in chosen.items()}

    mine, study = told.study.longest or reference, told.study
    found = held(told.run, mine, told.alignment, study.span, study.patience(step), tell, tell(reference))
    return list(found.changed) if found.until is None else None


def _why(told: Followed, label: str, engine: Engine) -> SweepRow:
    """The cause, the margin and the engine's error, by the experiments of `compare`."""
    apart = separation(told.study.reference, told.run, float(told.study.reference.final_time))
    stepped = engine.step is not None
    candidate = Candidate(label, told.run, told.alignment, apart, {}, (), stepped=stepped)
    candidate = explained(told.study, candidate, engine, None)
    margin = candidate.margin
    return {
        "cause": None if candidate.diagnosis is None else candidate.diagnosis.name.value,
        "margin": None if margin is None or margin.distance is None else list(margin.distance),
        "error": None if margin is None else margin.error,
    }


def engine_of(label: str, seed: int) -> Engine:
    """The engine of a label; the displacements of a perturbed scene are drawn by the scene's place in the sweep.

    Raises:
        SceneError: for an unknown one.
    """
    if label.startswith(PERTURBED):
        return Perturbed(Quantity.of(label.removeprefix(PERTURBED)), seed)
    return engine_named(label)


def _unit(label: str, horizon: Horizon | None) -> float | None:
    """log2 of an engine's unit of error."""
    if label.startswith(PERTURBED):
        return float(Quantity.of(label.removeprefix(PERTURBED)).ball(64).log()) / math.log(2)
    return None if horizon is None else horizon.unit


def versions() -> str:
    """What computed a row."""
    return ", ".join(f"{name} {version(name)}" for name in ("truebreak", "python-flint", "pymunk"))


COLUMNS = (
    "index", "scene", "digest", "parameters", "engine", "verdict", "agreed", "events", "time", "stop",
    "event", "at", "body", "expected", "got", "kind", "cause", "margin", "error",
    "foreseen_low", "foreseen", "foreseen_high", "by_exponent", "lyapunov", "lyapunov_low", "lyapunov_high",
    "changed", "laws", "work", "versions", "note",
)  # fmt: skip
"""What a row tells, in order; docs/sweep.md says what each means."""


def text_of(row: SweepRow) -> str:
    """A row as JSON text in one form: equal rows are equal byte by byte."""
    return json.dumps({key: row[key] for key in COLUMNS}, ensure_ascii=False, sort_keys=False, separators=(",", ":"))
