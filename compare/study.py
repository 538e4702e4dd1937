"""Holds other runs of a scene against one reference run."""

from __future__ import annotations

import time as clock
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from ..scenarios.engine import horizon
from ..scenarios.errors import SceneError
from ..scenarios.trajectory import Stop, StopReason, Trajectory
from .alignment.align import Alignment, align
from .alignment.separation import return_miss, separation
from .candidate import Candidate
from .causes.causes import cause_of, cause_of_stop
from .causes.margin import margin
from .deadline import OutOfTime, limited, time_limit, uninterrupted
from .engines import is_stepped
from .outcomes.table import changed_outcomes, outcomes_of

if TYPE_CHECKING:
    from ..scenarios.engine import Engine
    from ..scenarios.quantity import QuantityLike
    from ..scenarios.scene import Scene
    from ..scenarios.trajectory import OnProgress
    from .alignment.divergence import Divergence
    from .outcomes.table import Outcome

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


@dataclass
class Study:
    """One reference run, with what is needed to hold others against it.

    Attributes:
        seconds: how long it took.
        max_seconds: what the user allows any one run; None: no limit.
    """

    scene: Scene
    truth: Engine
    reference: Trajectory
    until: QuantityLike | None
    events: int | None
    seconds: float = 0.0
    max_seconds: float | None = None
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
        time, _ = horizon(self.scene, self.until, self.events)
        return None if time is None else float(time)

    def run(
        self, engine: Engine, scene: Scene, progress: OnProgress | None, seconds: float | None = None
    ) -> Trajectory:
        """Another engine's run over the span and a little more.

        Args:
            seconds: for an experiment, of which a part is of no use.

        Raises:
            OutOfTime: if it takes longer than `seconds`.
        """
        length = (self.span or self.limit or 1.0) * (1 + OVERRUN)
        if seconds is not None:
            watched = limited(progress, seconds, self.max_seconds)
            return uninterrupted(engine.run(scene, until=length, events=self.cap, progress=watched))
        with time_limit(self.max_seconds) as watch:
            return uninterrupted(engine.run(scene, until=length, events=self.cap, progress=watch.watched(progress)))

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
        watched = limited(progress, seconds, self.max_seconds)
        return uninterrupted(engine.run(scene, until=length, events=min(count, self.cap), progress=watched))

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
                    watched = limited(progress, self.patience, self.max_seconds)
                    self.longer = uninterrupted(self.truth.run(self.scene, events=more, progress=watched))
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
