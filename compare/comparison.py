"""Runs one scene through several engines and holds their histories against a reference."""

from __future__ import annotations

import time as clock
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from ..scenarios.errors import SceneError
from ..scenarios.trajectory import Progress, Stop, StopReason, Trajectory
from .align import Alignment, align
from .causes import Cause, cause_of, cause_of_stop
from .deadline import OutOfTime, limited
from .engines import engine as engine_named
from .engines import is_stepped
from .margin import Margin, margin
from .outcomes import changed_outcomes, outcomes_of
from .separation import Separation, return_miss, separation

if TYPE_CHECKING:
    from ..scenarios.engine import Engine
    from ..scenarios.quantity import QuantityLike
    from ..scenarios.scene import Scene
    from ..scenarios.trajectory import OnProgress
    from .align import Divergence
    from .outcomes import Outcome

Verdict: TypeAlias = Literal["agree", "diverged", "undecided"]

DEFAULT_ENGINES = ("double", "interval", "pymunk")

OVERRUN = 1 / 32
"""Candidates run this share of the span past its end, so that an event which they have a little late is
seen."""

EVENTS_FACTOR, EVENTS_MORE = 4, 1_000
"""A candidate with this many times the reference's events, and this many more, has left it long before."""

MORE_REFERENCE = 1 / 16
"""Share of further reference events by which a doubt at the end of the span is settled; at least one a
circle."""

PATIENCE_LEAST = 5.0
"""Seconds that settling a doubt at the end may take, or as long as the reference took."""

UNDONE = (StopReason.UNDECIDED, StopReason.BUDGET, StopReason.INTERRUPTED)


@dataclass(frozen=True)
class Candidate:
    """One engine held against the reference.

    Attributes:
        engine: the engine as it was asked for, with its parameters.
        trajectory: its run, which goes on a little past the span compared.
        alignment: the causal comparison.
        separation: how far its circles are from the reference's, over time.
        outcomes: its outcomes over the span compared.
        changed: names of the outcomes that differ from the reference's.
        cause: why it diverged, or could not decide; None if it agrees, or if causes were not asked for.
        margin: how close the competing events were, at a divergence.
        return_miss: after a reversal, the largest distance from the start at the return.
        seconds: wall time of the run.
        unable: whether the engine cannot take the scene at all.
    """

    engine: str
    trajectory: Trajectory = field(repr=False)
    alignment: Alignment
    separation: Separation = field(repr=False)
    outcomes: Mapping[str, Any] = field(repr=False)
    changed: tuple[str, ...]
    cause: Cause | None = None
    margin: Margin | None = None
    return_miss: float | None = None
    seconds: float = 0.0
    unable: bool = False

    @property
    def verdict(self) -> Verdict:
        """Whether this engine tells the reference's history."""
        if self.alignment.divergence is not None:
            return "diverged"
        return "undecided" if self.alignment.undecided else "agree"


@dataclass(frozen=True)
class Comparison:
    """What came out of holding several engines against a reference.

    Attributes:
        scene: what was run.
        reference: the run taken as the truth.
        candidates: the engines compared, in the order asked for.
        outcomes: the reference's outcomes.
        span: the time up to which histories were compared.
        return_miss: after a reversal, the reference's own distance from the start at the return.
        seconds: wall time of the reference's run.
    """

    scene: Scene
    reference: Trajectory = field(repr=False)
    candidates: tuple[Candidate, ...]
    outcomes: Mapping[str, Any] = field(repr=False)
    span: float
    return_miss: float | None = None
    seconds: float = 0.0

    @property
    def verdict(self) -> Verdict:
        """`diverged` if any engine did; else `undecided` if anything, the reference included, is; else
        `agree`."""
        verdicts = {candidate.verdict for candidate in self.candidates}
        if "diverged" in verdicts:
            return "diverged"
        if "undecided" in verdicts or self.reference.stop.reason in UNDONE:
            return "undecided"
        return "agree"

    def __getitem__(self, engine: str) -> Candidate:
        """The candidate of an engine, by the text with which it was asked for."""
        for candidate in self.candidates:
            if candidate.engine == engine:
                return candidate
        raise KeyError(engine)


def compare(
    scene: Scene,
    engines: Sequence[str | Engine] = DEFAULT_ENGINES,
    *,
    until: QuantityLike | None = None,
    events: int | None = None,
    reference: str | Engine = "exact",
    outcomes: Mapping[str, Outcome] | None = None,
    causes: bool = True,
    progress: OnProgress | None = None,
) -> Comparison:
    """Runs `scene` in a reference engine and in others, and says where their histories part.

    The span compared ends where the reference ends. Candidates run a little past it; what they have there is
    looked at only to tell a late event from a missing one. Where that is not enough, the reference is run
    on too.

    Args:
        engines: names, with parameters as in `pymunk:dt=1/1000`, or engines.
        until, events: limits of the reference's run, as in `Engine.run`.
        reference: the engine taken as the truth.
        outcomes: further outcomes by name.
        causes: whether to find out, by further runs, why an engine diverged.
        progress: called now and then with how far a run is.

    Raises:
        SceneError: for an unknown engine or parameter, a limit that is not positive, or a scene that the
            reference cannot run.

    >>> from truebreak.scenarios import Circle, Scene
    >>> compare(Scene([Circle(0, 0, vx=1), Circle(4, 0)]), ["double"], until=5).verdict
    'agree'
    """
    if not engines:
        raise SceneError("no engine to compare; name at least one, such as double")
    if isinstance(engines, str):
        engines = [engines]
    chosen = [(_label(e), engine_named(e) if isinstance(e, str) else e) for e in engines]
    truth = engine_named(reference) if isinstance(reference, str) else reference
    began = clock.perf_counter()
    told = truth.run(scene, until=until, events=events, progress=_noted(progress, truth.name))
    seconds = clock.perf_counter() - began
    study = Study(scene, truth, told, until, events, seconds)
    found = outcomes_of(told, outcomes)
    results = []
    for label, engine in chosen:
        result = study.candidate(label, engine, found, outcomes, _noted(progress, label))
        results.append(
            study.explained(result, engine, _noted(progress, f"why {label}")) if causes else result
        )
    return Comparison(scene, told, tuple(results), found, study.span, return_miss(told, told), seconds)


@dataclass
class Study:
    """One reference run, with what is needed to hold others against it."""

    scene: Scene
    truth: Engine
    reference: Trajectory
    until: QuantityLike | None
    events: int | None
    seconds: float = 0.0
    longer: Trajectory | None = None

    @property
    def span(self) -> float:
        """The end of the time compared."""
        end = float(self.reference.final_time)
        if self.reference.stop.reason is StopReason.QUIET and self.limit is not None:
            return max(end, self.limit)
        return end

    @property
    def limit(self) -> float | None:
        """The time limit that the reference ran under, if any."""
        from ..scenarios.engine import horizon

        time, _ = horizon(self.scene, self.until, self.events)
        return None if time is None else float(time)

    def run(
        self, engine: Engine, scene: Scene, progress: OnProgress | None, seconds: float | None = None
    ) -> Trajectory:
        """Another engine's run over the span and a little more.

        Raises:
            OutOfTime: if it takes longer than `seconds`.
        """
        length = self.span or self.limit or 1.0
        if seconds is not None:
            progress = limited(progress, seconds)
        return engine.run(scene, until=length * (1 + OVERRUN), events=self.cap, progress=progress)

    def experiment(
        self,
        engine: Engine,
        scene: Scene,
        divergence: Divergence,
        progress: OnProgress | None,
        longer: float,
        seconds: float,
    ) -> Trajectory:
        """A run to `longer` times the time of a divergence.

        Raises:
            OutOfTime: if it takes longer than `seconds`.
        """
        length = longer * divergence.time or self.span or self.limit or 1.0
        count = EVENTS_FACTOR * divergence.event + EVENTS_MORE
        return engine.run(
            scene, until=length, events=min(count, self.cap), progress=limited(progress, seconds)
        )

    @property
    def cap(self) -> int:
        """The number of events after which a candidate is ended."""
        return EVENTS_FACTOR * len(self.reference.events) + EVENTS_MORE

    def aligned(self, trajectory: Trajectory, progress: OnProgress | None) -> Alignment:
        """The causal comparison, with the reference run on where the end of the span leaves a doubt."""
        step = step_of(trajectory)
        alignment = align(self.reference, trajectory, span=self.span, step=step)
        if alignment.unsettled and self.reference.stop.reason in (StopReason.EVENTS, StopReason.HORIZON):
            if self.longer is None:
                done = len(self.reference.events)
                more = done + max(len(self.scene.circles), int(done * MORE_REFERENCE))
                try:
                    self.longer = self.truth.run(
                        self.scene, events=more, progress=limited(progress, self.patience)
                    )
                except OutOfTime:
                    self.longer = self.reference
            alignment = align(self.longer, trajectory, span=self.span, step=step)
        return alignment

    @property
    def patience(self) -> float:
        """Seconds that running the reference on may take."""
        return max(PATIENCE_LEAST, self.seconds)

    def candidate(
        self,
        label: str,
        engine: Engine,
        expected: Mapping[str, Any],
        outcomes: Mapping[str, Outcome] | None,
        progress: OnProgress | None,
    ) -> Candidate:
        """One engine held against the reference, without causes."""
        began, unable = clock.perf_counter(), False
        try:
            trajectory = self.run(engine, self.scene, progress)
        except SceneError as error:
            trajectory, unable = _unable(self.scene, engine, str(error)), True
        seconds = clock.perf_counter() - began
        alignment = self.aligned(trajectory, progress)
        values = outcomes_of(_within(trajectory, alignment, self.span, self.reference), outcomes)
        return Candidate(
            engine=label,
            trajectory=trajectory,
            alignment=alignment,
            separation=separation(self.reference, trajectory, self.span),
            outcomes=values,
            changed=tuple(changed_outcomes(expected, values)),
            return_miss=return_miss(trajectory, self.reference),
            seconds=seconds,
            unable=unable,
        )

    def explained(self, candidate: Candidate, engine: Engine, progress: OnProgress | None) -> Candidate:
        """The same with cause and margin."""
        divergence = candidate.alignment.divergence
        if divergence is not None:
            return replace(
                candidate,
                margin=margin(self.reference, divergence),
                cause=cause_of(self, candidate, engine, progress),
            )
        if candidate.alignment.undecided:
            return replace(candidate, cause=cause_of_stop(self, candidate, engine, progress))
        return candidate


def step_of(trajectory: Trajectory) -> float:
    """The time step of a run by time steps; 0 for one by events."""
    step = trajectory.parameters.get("dt") if is_stepped(trajectory.engine) else None
    return 0.0 if step is None else float(step)


def _label(engine: str | Engine) -> str:
    return engine.strip() if isinstance(engine, str) else engine.name


def _noted(progress: OnProgress | None, name: str) -> OnProgress | None:
    """A progress callback that says which engine is at work."""
    if progress is None:
        return None

    def noted(state: Progress) -> None:
        progress(replace(state, note=f"{name}, {state.note}" if state.note else name))

    return noted


def _within(trajectory: Trajectory, alignment: Alignment, end: float, reference: Trajectory) -> Trajectory:
    """The run up to the end of the span: events matched with the reference's, and others within the time."""
    inside = len(reference.events)
    events = tuple(
        event
        for index, event in enumerate(trajectory.events)
        if alignment.matches.get(index, inside) < inside or float(event.time) <= end
    )
    return replace(trajectory, events=events, final_time=min(end, float(trajectory.final_time)))


@dataclass(frozen=True)
class _Still:
    """The motion of a run that did not begin: the start."""

    scene: Scene

    def state(self, time: Any) -> list[tuple[Any, Any, Any, Any]]:
        return [(c.x, c.y, c.vx, c.vy) for c in self.scene.circles]

    def sample(self, times: Sequence[float]) -> Any:
        import numpy as np

        row = [[float(value) for value in values] for values in self.state(0)]
        return np.array([row for _ in times])


def _unable(scene: Scene, engine: Engine, reason: str) -> Trajectory:
    """The run of an engine that cannot take a scene: it ends, undecided, before it begins."""
    return Trajectory(
        scene=scene,
        engine=engine.name,
        parameters={},
        events=(),
        stop=Stop(StopReason.UNDECIDED, f"cannot run this scene: {reason}"),
        final_time=0.0,
        motion=_Still(scene),
    )
