"""When two meet next, certified: predictions through the filter, times in balls, doubts settled by the cascade."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Sequence
from typing import Protocol

from flint import arb

from ...scenarios.scene import Scene
from ..cascade.enclosures import InBalls
from ..numbers import ball
from ..predicates.hits import Approach, Discriminant, Gap, Moment, Sooner
from ..predicates.question import Decision, Question
from ..replay.body import Body
from ..replay.contact import AtWall, Entry, Link
from ..replay.refinable import RefinableState
from ..simulation.arrivals.queue import Arrival, ArrivalQueue
from .precision import Precision
from .prediction import FilteredPredictor


class Judge(Protocol):
    """What decides the questions of a run."""

    def decide(self, question: Question) -> Decision:
        """The answer to a question."""
        ...

    def name(self, link: Link) -> str:
        """A contact as a person reads it."""
        ...


class CertifiedMeetings:
    """The meetings of a run.

    Args:
        scene: what runs.
        state: its state.
        queue: where arrivals go.
        plan: counts what is predicted, skipped and settled.
        precision: the bits of the run.
        balls: signs at the precision at hand.
        judge: decides what that leaves open.
        grazes: told of a pair proved to graze.
    """

    def __init__(
        self,
        scene: Scene,
        state: RefinableState,
        queue: ArrivalQueue[arb],
        plan: Counter[str],
        precision: Precision,
        balls: InBalls,
        judge: Judge,
        grazes: Callable[[Link], None],
    ) -> None:
        self.predictor = FilteredPredictor(scene, state, queue, plan, self._unsure)
        self._state = state
        self._plan = plan
        self._precision = precision
        self._balls = balls
        self._judge = judge
        self._grazes = grazes

    def predict(self, moved: Sequence[Body[arb]], standing: Collection[Link], gone: Collection[int]) -> None:
        """Queues the next meetings of some circles."""
        self.predictor.predict(moved, standing, gone)

    def off_rim(self, link: Entry) -> bool:
        """Whether doubles tell a centre from the rim."""
        return self.predictor.off_rim(link)

    def order(self, first: Arrival[arb], second: Arrival[arb]) -> Decision:
        """Whether the one comes before, with or after the other."""
        return self._judge.decide(Sooner(Moment(first.link, first.graze), Moment(second.link, second.graze)))

    def timed(self, arrival: Arrival[arb]) -> Arrival[arb]:
        """The arrival with its time in full precision."""
        if arrival.time is None:
            return arrival._replace(time=self.time(Moment(arrival.link)))
        return arrival

    def certainly_before(self, first: Arrival[arb], second: Arrival[arb]) -> bool:
        """Whether the balls of their times tell."""
        return first.time is not None and second.time is not None and first.time < second.time

    def settled(self, arrival: Arrival[arb]) -> Arrival[arb] | None:
        """The arrival if it comes.

        Raises:
            Undecided: where that is not to be had.
        """
        link = arrival.link
        self._plan["doubtful settled"] += 1
        if self._judge.decide(Approach(link)).sign >= 0:
            return None
        disc = 1 if isinstance(link, AtWall) else self._judge.decide(Discriminant(link)).sign
        if disc < 0:
            return None
        time = self._meeting(link, disc)
        low, high = ball.double_bounds(time)
        return arrival._replace(low=low, high=high, certain=True, time=time, graze=disc == 0)

    def time(self, moment: Moment) -> arb:
        """The time of a meeting that is certain, as a ball of full precision that excludes the past."""
        while True:
            ball.use_bits(self._state.bits)
            self._state.sync(moment.link.circles)
            try:
                t, wait = moment.wait(self._state.balls)
                if t + wait > self._begun(moment.link):
                    return t + wait
            except ZeroDivisionError:
                pass
            self._precision.rise(f"the time of {self._judge.name(moment.link)} is unsharp")

    def _meeting(self, link: Link, disc: int) -> arb:
        """The time of a hit or, where the discriminant is zero, of a graze, which is noted."""
        if disc == 0:
            self._grazes(link)
        return self.time(Moment(link, disc == 0))

    def _begun(self, link: Link) -> arb:
        """The instant from which on the flights of two hold."""
        return link.later(self._state.balls).flight.instant

    def _sign(self, question: Question) -> int | None:
        return self._balls.sign(question)

    def _unsure(self, link: Link) -> None:
        """A prediction that short balls could not decide: full balls, and proofs where they leave it open.

        A gap of zero does not occur here: what stands at gap zero at an instant was gathered for it.
        """
        self._plan["full predictions"] += 1
        ball.use_bits(self._state.bits)
        approach = self._sign(Approach(link))
        if approach is not None and approach >= 0:
            return
        gap = self._sign(Gap(link))
        if not gap:  # unknown; or zero, as at a rim on which a centre stands still
            approach = self._judge.decide(Approach(link)).sign if approach is None else approach
            if approach >= 0:
                return
            gap = self._judge.decide(Gap(link)).sign
        if gap <= 0:
            if isinstance(link, Entry) and gap < 0:
                return
            who, when = self._judge.name(link), self._precision.where()
            raise AssertionError(f"{who} overlap, or touch unseen, {when}: a defect")
        disc = 1 if isinstance(link, AtWall) else self._sign(Discriminant(link))
        if disc is not None and disc < 0:
            return
        ball.use_bits(self._state.bits)
        if approach is None or disc is None:
            self.predictor.push_doubtful(link)
        else:
            self.predictor.push(self._meeting(link, disc), link, disc == 0)
