"""How long an engine can be trusted, foreseen from the certified run alone, beside what happened."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ...exact.exact_engine import ExactEngine
from ...scenarios.trajectory import Stop, StopReason
from ..study import Study, run_or_unable
from ..tangent.hazard import ErrorCurve, ErrorModel, Surroundings, error_curve, model_of
from .levels import LEVELS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...scenarios.engine import Engine
    from ...scenarios.trajectory import Trajectory
    from ..alignment.align import Alignment, Verdict
    from ..tangent.impacts import Impact

# ----------------------------------------
# Runs an engine beside a certified run no further than it takes to see it leave.

FIRST_EVENTS = 32
"""Events compared at first where nothing is foreseen."""

FARTHER = 4


@dataclass(frozen=True)
class Followed:
    """An engine's run up to where it left, or to the end.

    Attributes:
        study: the reference as far as it was compared.
        run, alignment: of the engine.
        unable: whether it could not take the scene at all.
    """

    study: Study
    run: Trajectory
    alignment: Alignment
    unable: bool


def prefix(trajectory: Trajectory, events: int) -> Trajectory:
    """The first events of a run as a run of its own, which ends at the last of them.

    Only of a scene without reversal and pockets, where nothing but events happens.

    >>> from truebreak.scenarios import catalogue
    >>> run = prefix(ExactEngine().run(catalogue.build("gas:n=3"), events=20), 5)
    >>> len(run.events), run.final_time is run.events[-1].time
    (5, True)
    """
    stop = Stop(StopReason.EVENTS, f"{StopReason.EVENTS.value} ({events})")
    return replace(
        trajectory, events=trajectory.events[:events], stop=stop, final_time=trajectory.events[events - 1].time
    )


def follow(
    reference: Trajectory,
    engine: Engine,
    foreseen: int | None = None,
    pay: Callable[[Engine, int], None] | None = None,
) -> Followed:
    """Runs an engine over ever more of a certified run, until it has left it or all is compared.

    A longer span takes no divergence back, and names no other as the first, so what is found early is what a
    comparison over all of the run finds.

    Args:
        foreseen: the event by which it is expected to have left.
        pay: as `Study.pay`.
    """
    for events in _spans(reference, foreseen):
        part = reference if events == len(reference.events) else prefix(reference, events)
        study = Study(reference.scene, ExactEngine(), part, longest=reference, pay=pay)
        run, alignment, unable = run_or_unable(study, engine, None)
        if unable or alignment.divergence is not None or alignment.undecided or part is reference:
            return Followed(study, run, alignment, unable)
    raise AssertionError("the last span is all of the run")


def _spans(reference: Trajectory, foreseen: int | None) -> Iterator[int]:
    scene, total = reference.scene, len(reference.events)
    events = FIRST_EVENTS if foreseen is None else foreseen
    if not (scene.pockets or scene.reverse_after or scene.reverse_at):
        while events < total:
            yield events
            events *= FARTHER
    yield total


# ----------------------------------------
# How long an engine can be trusted, foreseen from the certified run alone, beside what happened.

MORE_EVENTS = 10
"""Events beyond the band at which a departure is still looked for at first."""


@dataclass(frozen=True)
class EventTime:
    """An event of the certified run, and its time; None where the run ends before it."""

    event: int | None
    time: float | None


@dataclass(frozen=True)
class Seen:
    """What came of running the engine.

    Attributes:
        verdict: as in a comparison: `diverged`, `undecided` of an engine of enclosures, `agree` to the run's end.
        place: the first event that it has otherwise, or not at all; None if there is none.
    """

    verdict: Verdict
    place: EventTime | None


@dataclass(frozen=True)
class Horizon:
    """Where an engine is expected to diverge.

    Attributes:
        engine: as it was asked for.
        model: what its declarations say of its error.
        unit: log2 of its unit of error: of its last bit, or of its time step.
        expected: half of all engines in such a place have diverged by then.
        low, high: the band; it is to hold nine in ten of the departures.
        by_exponent: ln(1/unit) / lambda: the time by the largest exponent alone; None if that may be zero.
        seen: what happened; None if the engine was not run, or could not be.
    """

    engine: str
    model: ErrorModel
    unit: float
    expected: EventTime
    low: EventTime
    high: EventTime
    by_exponent: float | None
    seen: Seen | None = None

    def holds(self, place: EventTime) -> bool:
        """Whether the band holds an event; beyond the run it goes on for ever."""
        if place.event is None or self.low.event is None or place.event < self.low.event:
            return False
        return self.high.event is None or place.event <= self.high.event


class Forecaster:
    """Foresees engines along one certified run; the error curve of each model is made once.

    Args:
        trajectory: a certified run of the exact engine.
        struck: its impacts, event by event; what is foreseen lies among these.
    """

    def __init__(self, trajectory: Trajectory, struck: Sequence[Sequence[Impact]]) -> None:
        self.trajectory = trajectory
        self.struck = struck
        self._curves: dict[ErrorModel, ErrorCurve] = {}
        self._known: Surroundings = {}

    def curve(self, model: ErrorModel) -> ErrorCurve:
        """The error curve of a model."""
        if model not in self._curves:
            self._curves[model] = error_curve(self.trajectory, self.struck, model, self._known)
        return self._curves[model]

    def place(self, event: int | None) -> EventTime:
        """An event with its time."""
        return EventTime(None, None) if event is None else EventTime(event, float(self.trajectory.events[event].time))

    def foresee(self, label: str, engine: Engine, exponent: float = 0.0) -> Horizon | None:
        """The horizon of an engine; None for one whose numbers are exact.

        Args:
            exponent: the largest Lyapunov exponent per unit time, for comparison.
        """
        declared = model_of(engine)
        if declared is None:
            return None
        return self.horizon(label, *declared, exponent)

    def horizon(self, label: str, model: ErrorModel, unit: float, exponent: float = 0.0) -> Horizon:
        """The horizon of an engine of this model and log2 unit of error."""
        low, middle, high = (self.place(self.curve(model).reaches(level, unit)) for level in LEVELS[model.name])
        by_exponent = -unit * math.log(2) / exponent if exponent > 0 else None
        return Horizon(label, model, unit, middle, low, high, by_exponent)

    def watch(self, horizon: Horizon, engine: Engine) -> Seen | None:
        """Runs the engine until it leaves the history, or to the end of the events at hand.

        Only as much of the certified run is compared at first as the band reaches to.
        """
        total = len(self.struck)
        high = horizon.high.event
        told = follow(self.trajectory, engine, total if high is None else high + MORE_EVENTS)
        if told.unable:
            return None
        if told.alignment.divergence is not None:
            return Seen("diverged", self.place(min(told.alignment.divergence.event, total - 1)))
        if told.alignment.undecided:
            return Seen("undecided", self.place(min(told.alignment.agreed, total - 1)))
        return Seen(told.alignment.verdict, None)
