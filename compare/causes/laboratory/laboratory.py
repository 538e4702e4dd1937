"""What every experiment on one divergence needs: the decision, and how each run has it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar

from flint import arb

from ....exact.numbers import ball
from ....scenarios.errors import SceneError
from ...alignment.align import Span, align
from ...alignment.divergence import Kind
from ...alignment.impulse_order import DOUBLE_BITS
from ...deadline import OutOfTime, time_to_read
from ...engines import engine
from ...study import SERIES_MORE
from ..decision.decision import DecidingNumber, Pairing, answer
from ..decision.decisions import decisions
from ..decision.reader import RunReader
from ..decision.rounding import rounded

if TYPE_CHECKING:
    from ....scenarios.engine import Engine
    from ....scenarios.scene import Scene
    from ....scenarios.trajectory import OnProgress, Trajectory
    from ...candidate import Candidate
    from ...study import Study


REORDERED = 2.0**16
"""How many times farther off than doubles rounding in another order of operations can be. An order costs what it
cancels: the discriminant as (d.v)^2 - |v|^2 (|d|^2 - R^2) loses (|d| / R)^2 against its stable form, so much at 256
radii. A time step, or another law, knows no such bound."""

LEAST_ROUNDING = 2.0**-50
"""A share of the scene's measures that a few operations in doubles are off by, whatever one run of them shows."""


Told = TypeVar("Told")


class Laboratory:
    """What every experiment on one divergence needs.

    Attributes:
        bits: of the numbers to which the scene is rounded, where it is; `numbers` names them.
        given: the scene as the engine is given it; None if rounding makes it invalid.
        decision: what was decided; None where no contact could be named.
        truth, own: the reference and the candidate at it.
    """

    def __init__(self, study: Study, candidate: Candidate, judged: Engine, progress: OnProgress | None) -> None:
        divergence = candidate.alignment.divergence
        assert divergence is not None
        self.study, self.candidate, self.engine, self.progress = study, candidate, judged, progress
        self.divergence = divergence
        self.reference = study.longest or study.reference
        self.name = judged.name
        self.bits = judged.bits or DOUBLE_BITS
        self.given = rounded_or_none(study.scene, self.bits) if judged.rounds_input else study.scene
        turned = self.reference.reversal
        self.turned = None if turned is None or turned.after > divergence.expected_event else turned.after
        self.truth = RunReader(self.reference, turned_after=self.turned)
        self.own = RunReader(candidate.trajectory, candidate.alignment.walks, self.given, self.turned)
        self.decision = self._decision()
        self._doubles: RunReader | None = None
        self.margin = None if self.decision is None else self.truth.value(self.decision)
        self.got = None if self.decision is None else self.own.value(self.decision)

    def _decision(self) -> DecidingNumber | None:
        """The decision that the candidate has otherwise; where its own flights have none, the closest.

        Two that part in both, as after their last meeting, decide nothing: whatever the candidate tells of them.
        """
        found = decisions(self.reference, self.candidate.trajectory, self.candidate.alignment)
        asked = [d for d in found if d.kind == "order" or not (self.truth.parts(d.first) and self.own.parts(d.first))]
        told = [(d, v) for d in asked if (v := self.truth.value(d)) is not None]
        for decision, value in told:
            other = self.own.value(decision)
            if other is not None and answer(decision, other) != answer(decision, value):
                return decision
        return min(told, key=lambda pair: abs(float(pair[1].mid())), default=(None, None))[0]

    @property
    def numbers(self) -> str:
        """What the scene is rounded to, in words."""
        return "doubles" if self.bits == DOUBLE_BITS else f"numbers of {self.bits} bits"

    @property
    def pairings(self) -> list[Pairing]:
        """What the decision is between."""
        return [] if self.decision is None else self.decision.pairings

    def run(self, judged: Engine, scene: Scene, until: float) -> Trajectory:
        """A run that no want of time has cut short.

        Raises:
            OutOfTime: if the user's seconds are over before it ends.
        """
        return self.study.whole_run(judged, scene, until, self.progress)

    @property
    def tied(self) -> bool:
        """Whether what is in question is an order of meetings that the reference has at one instant."""
        events, event, divergence = self.reference.events, self.divergence.expected_event, self.divergence
        if event >= len(events):
            return False
        pairs = {frozenset(pair) for pair in events[event].contacts}
        if self.decision is not None:
            asked = {frozenset((p.body, p.partner)) for p in self.pairings}
        else:
            known = {*divergence.partners} & {*self.study.scene.ids}
            asked = {frozenset((divergence.body, name)) for name in known if divergence.kind is Kind.TIE}
        return len(asked) > 1 and asked <= pairs

    def tried(self, experiment: Callable[[], Told], otherwise: Told) -> Told:
        """What an experiment tells; something else once the user's seconds are over."""
        try:
            with time_to_read(self.study.watch):
                return experiment()
        except OutOfTime:
            return otherwise

    def check_time(self) -> None:
        """Ends what is tried once the user's seconds are over.

        Raises:
            OutOfTime: then.
        """
        if self.study.watch.over:
            raise OutOfTime(str(self.study.watch.is_up()))

    @property
    def scale(self) -> float:
        """The largest coordinate or radius of the scene."""
        return max(max(abs(float(c.x)), abs(float(c.y)), float(c.r)) for c in self.study.scene.circles)

    def reader(self, run: Trajectory, scene: Scene | None, step: float | None) -> RunReader:
        """Another run at the decision."""
        walks = align(self.reference, run, span=self.span, step=step, instants=False).walks
        return RunReader(run, walks, scene, self.turned)

    @property
    def span(self) -> Span:
        """Up to the divergence."""
        return Span(min(self.divergence.expected_event + 1, len(self.reference.events)), self.divergence.time)

    def until(self, step: float | None) -> float:
        """How far an experiment has to run: past both meetings, by what an error may delay them."""
        times = (self.divergence.time, self.divergence.expected_time or 0.0)
        return max(times) * 1.125 + SERIES_MORE * (step or 0.0) + self.study.patience(None).slack / 8

    def of_doubles(self, start: arb | None) -> float | None:
        """How far doubles are off at the decision; None if they do not come to it.

        Args:
            start: the decision in the exact run of the scene as the engine is given it.
        """
        assert self.decision is not None
        if self._doubles is None:
            run = self.run(engine("double"), self.study.scene, self.until(None))
            self._doubles = self.reader(run, self.given, None)
        return self.moved(self._doubles.value(self.decision), start)

    def by_rounding(self, start: arb | None) -> float:
        """The most that rounding moves the decision by: what it does in doubles, in whatever order of operations."""
        least = LEAST_ROUNDING * max(self.scale, self.divergence.time)
        return REORDERED * max(abs(self.of_doubles(start) or 0.0), least)

    def changes(self, value: arb | None) -> bool:
        """Whether a value of the decision is another answer than the exact one."""
        told = None if self.decision is None else answer(self.decision, value)
        return self.decision is not None and told is not None and told != answer(self.decision, self.margin)

    def moved(self, value: arb | None, start: arb | None) -> float | None:
        """How far a value lies from another."""
        if value is None or start is None:
            return None
        with ball.precision(4096):
            return float((value - start).mid())


def rounded_or_none(scene: Scene, bits: int) -> Scene | None:
    """The scene in numbers of so many bits; None if it is no longer valid."""
    try:
        return rounded(scene, bits)
    except SceneError:
        return None
