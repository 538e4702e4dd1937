"""Holds several engines against a reference."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

from ..scenarios.errors import SceneError
from ..scenarios.scene import Scene
from ..scenarios.trajectory import Progress, Trajectory
from .alignment.align import UNKNOWING, VERDICTS, not_measured, return_miss, separation
from .alignment.instants import follows_the_law
from .alignment.walk import REPEATED
from .alternatives import Alternative, alternatives_of
from .audit.audit import audit_run
from .audit.transcript import Transcript
from .candidate import Candidate
from .deadline import NO_TIME, Clock, OutOfTime, checked_seconds, time_limit, time_to_read, uninterrupted
from .engines import engine as engine_named
from .engines import label_of
from .foreign.guard import run_guarded
from .outcomes.matched import held
from .outcomes.outcome import outcomes_of
from .outcomes.outcome import pattern as pattern_of
from .outcomes.permitted import PermittedPatterns, pattern_at_the_end, permitted_patterns
from .side_by_side import SideBySide
from .study import Study, run_or_unable
from .tangent.hazard import model_of
from .validation import check_engine, check_trajectory, check_until

if TYPE_CHECKING:
    from ..scenarios.engine import Engine
    from ..scenarios.numbers.quantity import QuantityLike
    from ..scenarios.trajectory import OnProgress
    from .alignment.align import Alignment, Verdict
    from .audit.audit import Audit
    from .certificate.certified import Certified
    from .outcomes.outcome import Outcome

DEFAULT_ENGINES = ("double", "interval", "pymunk")

REFERENCE_SHARE = 0.5
"""Share of the user's seconds that the reference's run may take: the rest is for what is compared with it."""

MEASURED_EVENTS = 1_000
"""Events at each of which two runs are measured; of more, a plot shows no single one."""


@dataclass(frozen=True)
class Comparison:
    """What came out of holding several engines against a reference.

    Attributes:
        scene: what was run.
        reference: the run taken as the truth.
        candidates: the engines compared, in the order asked for.
        outcomes: the reference's outcomes.
        span: the time up to which histories were compared; infinite where the reference's is known to be over.
        return_miss: after a reversal, the reference's own distance from the start at the return.
        permitted: break patterns under several tie policies, for a scene that has one and in which an engine
            comes to another.
        seconds: wall time of the reference's run.
        processor: processor time of it, in seconds.
        cut: what was left out as the user's seconds were over.
        certain: whether the reference counts in numbers that prove their decisions: exact ones, or enclosures.
        certificate: of the reference's run, checked, where it was asked for.
        alternatives: engines and settings that were run in place of those that diverged.
    """

    scene: Scene
    reference: Trajectory = field(repr=False)
    candidates: tuple[Candidate, ...]
    outcomes: Mapping[str, Any] = field(repr=False)
    span: float
    return_miss: float | None = None
    permitted: PermittedPatterns | None = None
    seconds: float = 0.0
    processor: float = 0.0
    cut: tuple[str, ...] = ()
    certain: bool = True
    certificate: Certified | None = field(default=None, repr=False)
    alternatives: tuple[Alternative, ...] = ()

    @property
    def verdict(self) -> Verdict:
        """The first of `diverged`, `unsettled`, `undecided`, `agree` that holds for any engine.

        A reference that stopped not knowing makes at least `undecided` of it.
        """
        verdicts = {candidate.verdict for candidate in self.candidates}
        if self.reference.stop.reason in UNKNOWING:
            verdicts.add("undecided")
        return next(verdict for verdict in VERDICTS if verdict in verdicts)

    def __str__(self) -> str:
        """The scene, the verdict, and where each engine first differs."""
        told: list[str] = []
        for candidate in self.candidates:
            parted = candidate.alignment.divergence
            where = "" if parted is None else f" at event {parted.event:,}"
            told.append(f"{candidate.engine} {candidate.verdict}{where}")
        return f"{self.scene.name}: {', '.join(told)}"

    def _repr_html_(self) -> str:
        """One row an engine, and a picture of where the first of them parts, or of the scene, for a notebook."""
        from ..scenarios.pictures import html_table, shown
        from .picture import notebook_picture

        rows: list[tuple[object, ...]] = [(self.reference.engine, "reference", len(self.reference.events), "", "")]
        for candidate in self.candidates:
            parted = candidate.alignment.divergence
            where = "" if parted is None else f"event {parted.event:,}"
            cause = "" if candidate.diagnosis is None else candidate.diagnosis
            rows.append((candidate.engine, candidate.verdict, candidate.alignment.agreed, where, cause))
        headings = ("engine", "verdict", "agreed", "differs at", "cause")
        table = html_table(f"{self.scene.name}: {self.verdict}", headings, rows, len(rows))
        return shown(table, self.scene, lambda: notebook_picture(self.reference, self.candidates), str(self))

    def __getitem__(self, engine: str) -> Candidate:
        """The candidate of an engine, by the text with which it was asked for."""
        for candidate in self.candidates:
            if candidate.engine == engine:
                return candidate
        raise KeyError(engine)


def compare(
    scene: Scene,
    engines: Sequence[str | Engine] | str | Engine = DEFAULT_ENGINES,
    *,
    until: QuantityLike | None = None,
    events: int | None = None,
    reference: str | Engine = "exact",
    outcomes: Mapping[str, Outcome] | None = None,
    causes: bool = True,
    bits: bool = False,
    sampled: bool = True,
    audited: bool = True,
    alternatives: bool = True,
    max_seconds: float | None = None,
    jobs: int | None = 1,
    progress: OnProgress | None = None,
) -> Comparison:
    """Runs `scene` in a reference engine and in others, and says where their histories part.

    The span compared ends where the reference ends. What lies near its end in one run is told from what is missing
    by running both on, as far as it takes.

    Args:
        engines: names, with parameters as in `pymunk:dt=1/1000`, or engines.
        until, events: limits of the reference's run, as in `Engine.run`.
        reference: the engine taken as the truth.
        outcomes: further outcomes by name.
        causes: whether to find out, by further runs, why an engine diverged.
        bits: whether to find out how many bits lead an engine to the end that cannot decide with those that it has.
        sampled: whether to measure how far apart the runs are over the time.
        audited: whether the steps of an engine's run are audited where its history agrees.
        alternatives: whether to run wider numbers, or a finer step, in place of an engine that diverged; only with
            `causes`.
        max_seconds: ends the whole comparison after about so many seconds; half of them at most are the
            reference's. What each run has by then is compared.
        jobs: how many engines are compared at once, each in a copy of this process; None: one for each processor. What
            comes out is the same, but for what `max_seconds` leaves out.
        progress: called now and then with how far a run is.

    Raises:
        SceneError: for an unknown engine or parameter, a limit that is not positive, a scene that the reference
            cannot run, or an engine that hands back what cannot be judged.
        OutOfTime: if `max_seconds` are over and there is nothing yet to compare.
        KeyboardInterrupt: if the user interrupts it.

    >>> from truebreak.scenarios import Circle, Scene
    >>> compare(Scene([Circle(0, 0, vx=1), Circle(4, 0)]), ["double"], until=5).verdict
    'agree'
    """
    scene = _checked_scene(scene)
    listed = [engines] if isinstance(engines, str) or not isinstance(engines, Iterable) else [*engines]
    if not listed:
        raise SceneError("no engine to compare; name at least one, such as double")
    chosen: list[tuple[str, Engine]] = [(_label(e), check_engine(_engine(e))) for e in listed]
    truth = check_engine(_engine(reference))
    for _, engine in [("", truth), *chosen]:
        check_until(engine, scene, until)
    study = studied(scene, truth, Clock(checked_seconds(max_seconds)), until, events, _noted(progress, truth.name))
    told, watch = study.reference, study.watch
    found = outcomes_of(told, outcomes)
    cut: list[str] = []
    results: list[Candidate] = []
    instead: list[Alternative] = []
    rest = _Rest(found, outcomes, causes, bits, sampled, audited, alternatives)
    with SideBySide(jobs, _there(study)) as tasks:
        for k, (label, engine) in enumerate(chosen):
            share = 1 / math.ceil((len(chosen) - k) / tasks.jobs)
            tasks.add(k, partial(_compared, study, label, engine, share, rest))
        for k in range(len(chosen)):
            one = tasks.result(k, progress)
            study.take(one.longest)
            results.append(one.candidate)
            instead += one.instead
            cut += one.cut
    permitted = None
    if causes and told.stop.reason not in UNKNOWING:
        own = pattern_of(told)
        others = [
            (c, e.step is not None)
            for c, (_, e) in zip(results, chosen, strict=True)
            if c.verdict == "diverged" and c.pattern not in (None, own)
        ]
        if others and not watch.over:
            permitted = permitted_patterns(
                study,
                [(c.trajectory, stepped) for c, stepped in others],
                _noted(progress, "orders"),
                wanted=[c.pattern for c, _ in others if c.pattern is not None],
            )
            for k, (c, (_, e)) in enumerate(zip(results, chosen, strict=True)):
                if permitted is not None and c.verdict == "diverged" and c.pattern is not None:
                    late = REPEATED * (e.step or 0.0)
                    results[k] = replace(c, pattern=pattern_at_the_end(permitted, c.pattern, c.trajectory, told, late))
        elif others:
            cut.append("which patterns are permitted")
    miss = return_miss(told, told)
    return Comparison(
        scene,
        told,
        tuple(results),
        found,
        study.span.time,
        miss,
        permitted,
        study.seconds,
        study.processor,
        tuple(cut),
        not truth.rounds_input,
        alternatives=tuple(instead),
    )


class _Rest(NamedTuple):
    """What is asked of every engine alike."""

    expected: Mapping[str, Any]
    outcomes: Mapping[str, Outcome] | None
    causes: bool
    bits: bool
    sampled: bool
    audited: bool
    alternatives: bool


class _Compared(NamedTuple):
    """What came of one engine: with the reference's run as far as it was taken for it, and what was left out."""

    candidate: Candidate
    instead: list[Alternative]
    cut: list[str]
    longest: Trajectory | None


def _there(study: Study) -> tuple[object, ...]:
    """What every engine's comparison shares: a copy of this process does not send it back."""
    run, log = study.reference, getattr(study.reference.motion, "log", None)
    return (study.scene, run, run.motion, run.events, *([] if log is None else [log]))


def _compared(
    study: Study, label: str, engine: Engine, share: float, rest: _Rest, progress: OnProgress | None
) -> _Compared:
    """One engine compared, explained, and what is right in its place."""
    cut: list[str] = []
    instead: list[Alternative] = []
    watch, study.share = study.watch, share
    result = candidate_of(
        study,
        label,
        engine,
        rest.expected,
        rest.outcomes,
        _noted(progress, label),
        sampled=rest.sampled,
        audited=rest.audited,
    )
    if rest.sampled and math.isnan(result.separation.final):
        cut.append(f"the position error of {label}")
    if rest.causes and not watch.over:
        try:
            result = explained(study, result, engine, _noted(progress, f"why {label}"), bits=rest.bits)
            if _in_part(result):
                cut.append(f"part of why {label}")
        except OutOfTime:
            cut.append(f"why {label}")
    elif rest.causes and result.verdict != "agree":
        cut.append(f"why {label}")
    if rest.causes and rest.alternatives and not watch.over:
        instead += alternatives_of(study, result, engine, _noted(progress, f"in place of {label}"))
    return _Compared(result, instead, cut, study.longest)


def studied(
    scene: Scene,
    truth: Engine,
    watch: Clock,
    until: QuantityLike | None,
    events: int | None,
    progress: OnProgress | None = None,
) -> Study:
    """The reference's run, ready for engines to be compared with it.

    Raises:
        SceneError: for a scene that the reference cannot run.
        OutOfTime: if the user's seconds are over and there is nothing of it.
        KeyboardInterrupt: if the user interrupts it.
    """
    began, spent = clock.perf_counter(), clock.process_time()
    with time_limit(watch.left(REFERENCE_SHARE), watch.seconds) as limit:
        ran = run_guarded(truth, scene, until=until, events=events, progress=limit.watched(progress))
    told = uninterrupted(check_trajectory(ran, scene, truth.name, truth.bits))
    seconds, processor = clock.perf_counter() - began, clock.process_time() - spent
    return Study(scene, truth, told, watch, seconds=seconds, processor=processor)


def candidate_of(
    study: Study,
    label: str,
    engine: Engine,
    expected: Mapping[str, Any],
    outcomes: Mapping[str, Outcome] | None,
    progress: OnProgress | None,
    *,
    sampled: bool = True,
    audited: bool = True,
) -> Candidate:
    """One engine compared with the reference, without causes."""
    began = clock.perf_counter()
    run, alignment, unable = run_or_unable(study, engine, progress)
    seconds = clock.perf_counter() - began
    reference = study.longest or study.reference
    tell = partial(outcomes_of, more=outcomes)
    only_error = partial(_only_error, engine, run, alignment, study)
    patience = study.patience(engine.step)
    found = held(run, reference, alignment, study.span, patience, tell, expected, only_error)
    end = min(study.span.time, float(study.reference.final_time)) or float(run.final_time)
    try:
        with time_to_read(study.watch):
            measured = _measured_at(study.reference, alignment) if sampled else []
            apart = separation(study.reference, run, end, at=measured) if sampled else not_measured(study.reference)
    except OutOfTime:
        apart = not_measured(study.reference)
    candidate = Candidate(
        engine=label,
        trajectory=run,
        alignment=alignment,
        separation=apart,
        outcomes=found.values,
        expected=found.expected,
        changed=found.changed,
        until=found.until,
        return_miss=return_miss(run, study.reference),
        seconds=seconds,
        processor=study.took,
        unable=unable,
        stepped=engine.step is not None,
        pattern=pattern_of(found.history) if found.until is None else None,
        error=model_of(engine),
    )
    if unable or (not audited and candidate.verdict == "agree"):
        return candidate
    return replace(candidate, laws=_audited(study, engine, candidate))


def _audited(study: Study, engine: Engine, candidate: Candidate) -> Audit | None:
    """The audit of a run's steps; None where the user's seconds leave no time for it."""
    try:
        with time_to_read(study.watch):
            found = audit_run(candidate.trajectory, engine)
            return found if Transcript(candidate.trajectory).states else _timed(study, engine, candidate, found)
    except OutOfTime:
        return None


def _timed(study: Study, engine: Engine, candidate: Candidate, found: Audit) -> Audit:
    """The audit of a record without states: its times and partners, up to the certified horizon of its bits."""
    from .tolerances.errors_grown import local_error
    from .tolerances.reach import MOST_CIRCLES, Demand, number_off, reach_of

    reference = study.reference
    stands = reference.scene.gravity is None and not reference.scene.moving_walls and not reference.scene.other_walls
    plain = reference.scene.elastic and stands and len(reference.scene.circles) <= MOST_CIRCLES
    if not plain or study.truth.rounds_input:
        return found
    reach = reach_of(reference, local_error(engine, reference, engine.bits))
    parted = candidate.alignment.divergence
    off = number_off(reference, candidate, Demand(), reach, False)
    if off is None and parted is not None and parted.event < reach.events:
        off = f"event {parted.event} (t = {parted.time:.9g}): {parted.body} meets another partner"
    horizon = f"event {reach.events:,}, the certified horizon of its rounding"
    told = f"they are right up to {horizon}" if off is None else f"up to {horizon}, they have to agree: {off}"
    return replace(found, reason=f"{found.reason}; {told}", horizon=reach.events)


def _measured_at(reference: Trajectory, alignment: Alignment) -> list[float]:
    """Times at which two runs are measured beside those of a plot: just after every event, and where they part."""
    parted = alignment.divergence
    times = [] if parted is None else [parted.time, parted.expected_time, parted.got_time]
    events = reference.events if len(reference.events) <= MEASURED_EVENTS else ()
    known = [*(float(event.time) for event in events), *(time for time in times if time is not None)]
    # at the double of an event an exact run may not know on what side of it that lies
    return [math.nextafter(time, math.inf) for time in known]


def _only_error(engine: Engine, run: Trajectory, alignment: Alignment, study: Study) -> bool:
    """Whether numbers that are not whole may differ by error alone: no divergence, and no impact against the law.

    Of each circle the last meeting inside the span is looked at, with which it ends. An engine with a time step has no
    state at a contact; what its step makes of velocities is looked at where contacts are coupled.
    """
    if alignment.divergence is not None or engine.step is not None:
        return alignment.divergence is None
    events = study.span.events
    last = {max((c for m, c in w.pairs if m < events), default=None) for w in alignment.walks.values()}
    return all(follows_the_law(run, c, engine.bits) for c in last if c is not None)


def explained(
    study: Study, candidate: Candidate, engine: Engine, progress: OnProgress | None, *, bits: bool = False
) -> Candidate:
    """The same with causes and margin.

    Raises:
        OutOfTime: if the user's seconds are over before anything was tried.
    """
    from .causes.laboratory import Laboratory, diagnosis_of, margin_of
    from .causes.other_settings import Stopped, by_finer_steps, diagnosis_of_stop

    unsettled = candidate.alignment.divergence is not None or candidate.alignment.undecided
    scene = study.scene
    new = ""
    if engine.step is not None and scene.gravity is not None and not scene.restitution.sign():
        new = "with gravity whose restitution is 0, of engines of steps"
    if scene.moving_solid is not None and engine.step is not None:
        new = f"in which {scene.moving_solid} moves, of engines of steps"
    if scene.other_walls:
        new = f"with a wall of kind {scene.other_walls[0].kind!r}"
    if scene.settle and engine.step is not None:
        new = "in which walls carry what settles, of engines of steps"
    told = f"causes other than the step are not looked for yet in scenes {new}"
    if candidate.trajectory.certified and study.truth.rounds_input:
        name = study.reference.engine
        told = f"{candidate.engine} is proved, and {name} is not: the error is {name}'s"
        new = new or "compared with a float engine"
    if new and unsettled and not candidate.unable:
        from .causes.diagnosis import CauseName, Diagnosis, Experiment

        if engine.step is not None and candidate.alignment.divergence is not None and not scene.other_walls:
            return replace(candidate, diagnosis=by_finer_steps(Laboratory(study, candidate, engine, progress), told))
        unknown = CauseName["UNKNOWN"]
        return replace(candidate, diagnosis=Diagnosis((unknown,), (Experiment(unknown, told, None, True),), told))
    if candidate.alignment.divergence is not None:
        with time_to_read(study.watch):
            lab = Laboratory(study, candidate, engine, progress)
        found = diagnosis_of(lab)
        return replace(candidate, diagnosis=found, margin=margin_of(lab, found))
    if candidate.alignment.undecided:
        with time_to_read(study.watch):
            found = diagnosis_of_stop(Stopped(study, candidate, engine, progress, bits))
            return replace(candidate, diagnosis=found)
    return candidate


def _in_part(candidate: Candidate) -> bool:
    """Whether some of the experiments, or of the margin, was left out for want of time."""
    found, margin = candidate.diagnosis, candidate.margin
    cut = found is not None and any(e.result == NO_TIME for e in found.experiments)
    return cut or (margin is not None and margin.cut)


def _checked_scene(scene: Any) -> Scene:
    """A scene; text is refused with what to write instead."""
    if isinstance(scene, Scene):
        return scene
    hint = f"; write scenarios.catalogue.build({scene!r})" if isinstance(scene, str) else ""
    raise SceneError(f"scene = {str(scene)[:60]!r} is not a Scene{hint}")


def _engine(engine: str | Engine) -> Engine:
    return engine_named(engine) if isinstance(engine, str) else engine


def _label(engine: str | Engine) -> str:
    return label_of(engine) if isinstance(engine, str) else getattr(engine, "name", type(engine).__name__)


def _noted(progress: OnProgress | None, name: str) -> OnProgress | None:
    """A progress callback that says which engine is at work."""
    if progress is None:
        return None

    def noted(state: Progress) -> None:
        progress(replace(state, note=f"{name}, {state.note}" if state.note else name))

    return noted
