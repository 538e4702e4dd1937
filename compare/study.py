"""One reference run, and the runs compared with it, each taken as far as it takes to settle what is compared."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from ..scenarios.errors import SceneError
from ..scenarios.numbers.precision import Double
from ..scenarios.trajectory import AT_AN_END, Stop, StopReason, Trajectory
from .alignment.align import UNKNOWING, Alignment, Span, align
from .alignment.instants import Finer, SharedInstant, instants, velocity_difference
from .alignment.walk import Patience, patience_for
from .deadline import Clock, OutOfTime, time_limit, uninterrupted
from .foreign.guard import finer_of, run_guarded
from .outcomes.matched import told_until
from .validation import EngineError, check_trajectory, unsupported

if TYPE_CHECKING:
    from ..scenarios.engine import Engine
    from ..scenarios.scene import Scene
    from ..scenarios.trajectory import OnProgress

OVERRUN = 1 / 32
"""Share of the span by which a run goes on past its end at first, so that an event which it has a little late is
seen; each time that does not settle it, four times as far."""

FARTHER = 4.0

EVENTS_FACTOR, EVENTS_MORE = 4, 1_000
"""A run with this many times the reference's events, and this many more, has left it long before; and the reference
itself is never run on for longer than that."""


QUIET_BY = 16
"""A run that has left a history which comes to its end is asked to go on until it comes to its own, at most to this
many times the time at which it is asked to end at first, and to `FARTHER` times that if it takes steps, which cost as
much where nothing happens: only then are its outcomes told."""

QUIET_EVENTS, QUIET_MORE = 2, 4
"""An engine of events comes to its own end within this many times the reference's events, and this many more, or is
asked for what the reference's time is."""

RUN_SHARE = 7 / 8
"""Share of the seconds left that a run may take: what it has by then is still to be read."""

SERIES_STEPS = 1_000_000
"""Time steps of the longest run by which a series in the step is told: about a second of pymunk."""

SERIES_MICROSECONDS = 2_000_000
"""What such a run may cost, where it is to tell a cause, by the `step_microseconds` that an engine declares. A verdict
is never told by fewer steps than another engine's would be."""

SERIES_MORE = 64
"""Steps of the engine in question by which such a run goes on past the instant: as many as an impact through a dozen
touching circles takes."""


@dataclass
class Study:
    """One reference run, with what is needed to hold others against it.

    Attributes:
        truth: the engine that made it.
        reference: the run, as far as the user asked for.
        watch: the seconds that the user allows for all.
        longest: the reference's longest run so far.
        share: of the seconds that are left, what one run may take: others are still to come.
        seconds, processor: what the reference's run took, on the wall and of the processor.
        took: processor time of the last run that was settled, in seconds, without the series that helped to settle it.
        pay: called with an engine and the steps before each run of a series, and before one beyond what was asked for;
            what it raises ends all.
    """

    scene: Scene
    truth: Engine
    reference: Trajectory
    watch: Clock = field(default_factory=lambda: Clock(None))
    longest: Trajectory | None = None
    share: float = 1.0
    seconds: float = 0.0
    processor: float = 0.0
    took: float = 0.0
    pay: Callable[[Engine, int], None] | None = None

    @property
    def span(self) -> Span:
        """What is compared."""
        return Span.of(self.reference)

    @property
    def cap(self) -> int:
        """The number of events after which a run is ended."""
        return EVENTS_FACTOR * len(self.reference.events) + EVENTS_MORE

    def patience(self, step: float | None) -> Patience:
        """How late an engine with such a step may be."""
        return patience_for(self.scene, step)

    def run(self, engine: Engine, scene: Scene, until: float, progress: OnProgress | None = None) -> Trajectory:
        """A checked run of an engine up to a time (infinite: to its quiet end), or to `cap` events.

        Raises:
            SceneError: if the engine refuses the scene, or hands back what cannot be judged.
            OutOfTime: if the user's seconds are over.
        """
        return self._run(engine, scene, until, progress)[0]

    def whole_run(self, engine: Engine, scene: Scene, until: float, progress: OnProgress | None = None) -> Trajectory:
        """As `run`, for what is told of the whole run only.

        Raises:
            OutOfTime: also if the user's seconds have cut it short.
        """
        told, cut = self._run(engine, scene, until, progress)
        if cut:
            raise OutOfTime(told.stop.message)
        return told

    def _run(
        self, engine: Engine, scene: Scene, until: float, progress: OnProgress | None, events: int | None = None
    ) -> tuple[Trajectory, bool]:
        """A run, and whether it was cut short as the seconds were over."""
        left = self.watch.left(RUN_SHARE * self.share)
        with time_limit(left, self.watch.seconds) as watch:
            told = run_guarded(
                engine,
                scene,
                until=until if math.isfinite(until) else None,
                events=events or self.cap,
                progress=watch.watched(progress),
            )
        checked = uninterrupted(check_trajectory(told, scene, engine.name, engine.bits))
        return checked, watch.over and checked.stop.reason is StopReason.BUDGET

    def until_event(self, event: int) -> float:
        """A time a little past an event of the reference, or past its end."""
        events = (self.longest or self.reference).events
        return self.past(float(events[event].time) if event < len(events) else float(self.reference.final_time))

    def past(self, time: float) -> float:
        """A little past a time."""
        return time + OVERRUN * (time or self.patience(None).slack)

    def reference_to(self, time: float, progress: OnProgress | None = None) -> Trajectory:
        """The reference, run on to a time if it can be."""
        longest = self.longest or self.reference
        over = longest.stop.reason in (StopReason.QUIET, *AT_AN_END, *UNKNOWING)
        if over or float(longest.final_time) >= time or len(longest.events) >= self.cap or self.watch.over:
            return longest
        try:
            more = self.run(self.truth, self.scene, time, progress)
        except OutOfTime:
            return longest
        if float(more.final_time) >= float(longest.final_time):
            self.longest = more
        return self.longest or self.reference

    def take(self, longest: Trajectory | None) -> None:
        """Takes a run of the reference that came farther than this one's, from whoever has made it."""
        if longest is not None and float(longest.final_time) > float((self.longest or self.reference).final_time):
            self.longest = longest

    def settled(self, engine: Engine, progress: OnProgress | None = None) -> tuple[Trajectory, Alignment]:
        """An engine's run and its alignment, both runs taken on until it is settled or cannot be."""
        end, step, patience = self.span.time, engine.step, self.patience(engine.step)
        if not math.isfinite(end):
            end = patience.latest(float(self.reference.final_time))
        asked = self.past(end)
        past, last = asked - end, asked * (QUIET_BY if step is None else FARTHER)
        mine, run = self.reference, self._to_its_end(engine, asked, progress)
        if run is None:
            run = self._timed(engine, asked, progress)
        else:
            asked = math.inf
        finer = self._series(engine)
        while True:
            alignment = align(mine, run, span=self.span, step=step, bits=engine.bits, patience=patience, finer=finer)
            wanted, past = alignment.wanted, past * FARTHER
            longer, goal = None, None
            if wanted.reference is not None:
                longer = self.reference_to(min(wanted.reference, end + past), progress)
            over = run.stop.reason in (*AT_AN_END, *UNKNOWING) or len(run.events) >= self.cap or self.watch.over
            if wanted.candidate is not None and not over and asked < wanted.candidate:
                goal = wanted.candidate if math.isinf(wanted.candidate) else min(wanted.candidate, end + past)
            if goal is None and not over and alignment.divergence is not None and told_until(run, mine, self.span):
                goal = self._later(run, asked, last)
            if goal is None and (longer is None or (longer is mine and end + past >= (wanted.reference or 0.0))):
                return run, alignment
            mine = longer or mine
            if goal is not None:
                if self.pay is not None and engine.step is not None and math.isfinite(goal):
                    self.pay(engine, math.ceil(goal / engine.step))
                try:
                    run, asked = self._timed(engine, max(goal, end), progress), max(goal, end)
                except OutOfTime:
                    return run, alignment

    def _later(self, run: Trajectory, asked: float, last: float) -> float | None:
        """When to ask for the end of a run that has left a history which comes to its end; None: no further."""
        later = FARTHER * asked
        went = run.stop.reason is StopReason.HORIZON and float(run.final_time) >= asked
        return later if went and math.isinf(self.span.time) and later <= last else None

    def _to_its_end(self, engine: Engine, asked: float, progress: OnProgress | None) -> Trajectory | None:
        """Beside a history that comes to its end, an engine of events is run to its own at once, if that is near."""
        if math.isfinite(self.span.time) or engine.step is not None or not engine.bits:
            return None
        try:
            run = self._timed(engine, math.inf, progress, events=QUIET_EVENTS * len(self.reference.events) + QUIET_MORE)
        except OutOfTime:
            return None
        early = run.stop.reason in UNKNOWING and float(run.final_time) < asked
        return run if early or run.stop.reason is StopReason.QUIET else None

    def _timed(
        self, engine: Engine, until: float, progress: OnProgress | None, events: int | None = None
    ) -> Trajectory:
        """A run that is to be settled, and what it took."""
        spent = clock.process_time()
        run = self._run(engine, self.scene, until, progress, events)[0]
        self.took = clock.process_time() - spent
        return run

    def _series(self, engine: Engine) -> Finer | None:
        """Tells how far the velocities after an instant are from the reference's at a finer step."""
        if engine.step is None or finer_of(engine) is None:
            return None

        runs: dict[int, tuple[Trajectory, Alignment]] = {}

        def difference(halvings: int, instant: SharedInstant) -> float | None:
            mine, chosen = self.longest or self.reference, finer_by(engine, halvings)
            if chosen is None or chosen.step is None:
                return None
            until = float(mine.events[instant.mine[-1]].time) + SERIES_MORE * (engine.step or 0.0)
            if until > SERIES_STEPS * chosen.step:
                return None
            if halvings not in runs or float(runs[halvings][0].final_time) < until:
                if self.pay is not None:
                    self.pay(chosen, math.ceil(until / chosen.step))
                run = self.whole_run(chosen, self.scene, until)
                runs[halvings] = run, align(mine, run, span=self.span, step=chosen.step, instants=False)
            run, alignment = runs[halvings]
            for found in instants(alignment.walks):
                if set(instant.mine) <= set(found.mine):
                    return velocity_difference(mine, run, found.among(instant))
            return None

        return difference


def series_steps(engine: Engine) -> int:
    """Time steps of the longest run by which a series in the step tells a cause.

    >>> from .engines import engine
    >>> series_steps(engine("pymunk")), series_steps(engine("mujoco"))
    (1000000, 100000)
    """
    declared = getattr(engine, "step_microseconds", 1.0)
    dear = isinstance(declared, int | float) and declared > SERIES_MICROSECONDS / SERIES_STEPS
    return int(SERIES_MICROSECONDS / declared) if dear else SERIES_STEPS


def finer_by(engine: Engine, halvings: int) -> Engine | None:
    """The engine with its step halved so many times; None if it does not go that far."""
    chosen: Engine | None = engine
    for _ in range(halvings):
        chosen = None if chosen is None else finer_of(chosen)
    return chosen


def _without(error: BaseException) -> str:
    """What an error says, without the reason that it may name itself."""
    return str(error).removeprefix(f"{StopReason.BUDGET.value}: ")


def run_or_unable(study: Study, engine: Engine, progress: OnProgress | None) -> tuple[Trajectory, Alignment, bool]:
    """The settled run of an engine, and whether it could not take the scene at all."""
    key = unsupported(engine, study.scene)
    reason = None if key is None else f"it does not follow {key!r}"
    if reason is None:
        try:
            return (*study.settled(engine, progress), False)
        except EngineError:
            raise
        except OutOfTime as error:
            return (*_nothing(study, engine, StopReason.BUDGET, f"{StopReason.BUDGET.value}: {_without(error)}"), False)
        except SceneError as error:
            reason = str(error)
    return (*_nothing(study, engine, StopReason.UNDECIDED, f"cannot run this scene: {reason}"), True)


def _nothing(study: Study, engine: Engine, reason: StopReason, message: str) -> tuple[Trajectory, Alignment]:
    """The run of an engine that did not come to begin."""
    run = Trajectory(study.scene, engine.name, {}, (), Stop(reason, message), Double(0.0), _Still(study.scene))
    return run, align(study.reference, run, span=study.span)


@dataclass(frozen=True)
class _Still:
    """The motion of a run that did not begin: the start of its scene, at any time."""

    scene: Scene

    def state(self, time: Any) -> list[tuple[Any, Any, Any, Any]]:
        """(x, y, vx, vy) of every circle, exactly."""
        return [(c.x, c.y, c.vx, c.vy) for c in self.scene.circles]

    def sample(self, times: Sequence[float]) -> Any:
        """Shape (times, circles, 4): the same as doubles."""
        import numpy as np  # here, since a comparison needs it nowhere else

        row = [[float(value) for value in values] for values in self.state(0)]
        return np.array([row for _ in times])
