"""Decisions in a finite precision that answers, or fails to answer, at once: nothing stronger stands behind it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Hashable, Iterable, Sequence
from typing import Generic

from ...exact.numbers.system import M, NumberSystem
from ...exact.numbers.undecided import Undecided
from ...exact.predicates.hits import Approach, Discriminant, Gap, Moment, Sooner
from ...exact.predicates.question import Decision, Question
from ...exact.replay.body import Body
from ...exact.replay.contact import AtWall, Entry, Link, name_of
from ...exact.replay.state import State
from ...exact.replay.steps import Step
from ...exact.simulation.arrivals.prediction import Predictor
from ...exact.simulation.arrivals.queue import Arrival, ArrivalQueue
from ...exact.simulation.history import History
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ...scenarios.trajectory import TieProof
from .standing import StandingClock


class PlainReading(Generic[M]):
    """Reads a state off as it is.

    Args:
        state: that state.
        numbers: its system.
    """

    def __init__(self, state: State[M], numbers: NumberSystem[M]) -> None:
        self._state = state
        self._bounds = numbers.bounds

    def knot(self, body: Body[M]) -> tuple[M, M, M, M, M]:
        """The state."""
        x, y, vx, vy, t, *_ = body.flight
        return t, x, y, vx, vy

    def now(self, body: Body[M]) -> M:
        """The instant of a body's last contact."""
        return body.flight.instant

    def entry_time(self, link: Entry) -> M:
        """The time of an entry."""
        clock, wait = link.hit(self._state)
        return clock + wait

    def reversal_time(self) -> M:
        """The time of the reversal."""
        return self._state.flip_time

    def exact_state(self, bodies: Sequence[int]) -> Hashable | None:
        """None: the state is not exact."""
        return None

    def note(self) -> str:
        """Nothing to add."""
        return ""

    def rough(self, time: M) -> float:
        """The lower bound of a time."""
        return self._bounds(time)[0]

    def limit_bounds(self, time: Quantity | None) -> tuple[float, float]:
        """Doubles around a set time (None: the return)."""
        if time is None:
            return self._bounds(self._state.flip_time + self._state.flip_time)
        return self._bounds(self._state.constant(time))


class PlainMeetings(Generic[M]):
    """Predicts and orders meetings by the system's own comparisons.

    Args:
        scene: what runs.
        state: its state.
        queue: where arrivals go.
        plan: counts what is predicted and what is skipped.
        numbers: the state's system.
        ask: decides questions.
    """

    def __init__(
        self,
        scene: Scene,
        state: State[M],
        queue: ArrivalQueue[M],
        plan: Counter[str],
        numbers: NumberSystem[M],
        ask: Callable[[Question], int],
    ) -> None:
        self._predictor = Predictor(scene, state, queue, plan, numbers.bounds, self._unsure)
        self._state = state
        self._sign = numbers.sign
        self._bounds = numbers.bounds
        self._ask = ask

    def off_rim(self, link: Entry) -> bool:
        """Nothing is plain before it is asked."""
        return False

    def predict(self, moved: Sequence[Body[M]], standing: Collection[Link], gone: Collection[int]) -> None:
        """Queues the next meetings of some circles."""
        self._predictor.predict(moved, standing, gone)

    def timed(self, arrival: Arrival[M]) -> Arrival[M]:
        """Its time was computed when it was predicted."""
        return arrival

    def certainly_before(self, first: Arrival[M], second: Arrival[M]) -> bool:
        """Whether the system's own comparison says so."""
        assert first.time is not None
        assert second.time is not None
        return (first.time < second.time) is True

    def order(self, first: Arrival[M], second: Arrival[M]) -> Decision:
        """The sign of the difference of two times at hand, or of the question where that is not known."""
        assert first.time is not None
        assert second.time is not None
        try:
            sign = self._sign(first.time - second.time)
        except Undecided:
            sign = self._ask(Sooner(Moment(first.link, first.graze), Moment(second.link, second.graze)))
        return Decision(sign, "plain", TieProof.FLOAT)

    def settled(self, arrival: Arrival[M]) -> Arrival[M] | None:
        """The arrival if it comes.

        Raises:
            Undecided: where that cannot be told.
        """
        found = self._meeting(arrival.link)
        if found is None:
            return None
        time, graze = found
        low, high = self._bounds(time)
        return arrival._replace(low=low, high=high, certain=True, time=time, graze=graze)

    def _unsure(self, link: Link) -> None:
        """A prediction with a sign that is not certain, or with no gap left: by rounding, or touching."""
        try:
            found = self._meeting(link)
        except Undecided:
            self._predictor.push_doubtful(link)
            return
        if found is not None:
            self._predictor.push(found[0], link, found[1])

    def _meeting(self, link: Link) -> tuple[M, bool] | None:
        """The time of a meeting, and whether it is a graze; None where there is none.

        Two that overlap by rounding and approach collide at once. Where the square of their speed is below all numbers
        of the engine they do not come together, as far as it can tell. That is so of rounded numbers alone: what is
        divided by an enclosure with 0 in it has no ends, and is no error.

        Raises:
            Undecided: where that cannot be told.
        """
        if self._ask(Approach(link)) >= 0:
            return None
        disc = 1 if isinstance(link, AtWall) else self._ask(Discriminant(link))
        if disc < 0:
            return None
        if self._ask(Gap(link)) <= 0:
            if isinstance(link, Entry) or disc == 0:
                return None
            return link.later(self._state).flight.t, False
        try:
            clock, wait = Moment(link, disc == 0).wait(self._state)
        except ZeroDivisionError:
            return None
        return clock + wait, disc == 0


class PlainDecider(Generic[M]):
    """The decider of one number system (see `Decider`).

    Args:
        scene: what runs.
        state: its state.
        numbers: the system that the state is in; what its signs do not tell is undecided.
    """

    def __init__(self, scene: Scene, state: State[M], numbers: NumberSystem[M]) -> None:
        self.scene = scene
        self.state = state
        self.history: History[M] = History()
        self.bodies = state.bodies
        self.queue = ArrivalQueue(self.bodies)
        self.meetings = PlainMeetings(scene, state, self.queue, self.history.plan, numbers, self.ask)
        self.reading = PlainReading(state, numbers)
        self.stride = None
        self._sign = numbers.sign
        self._standing = StandingClock()
        self.refresh([*state.bodies.values(), *state.pockets])

    def begin(self, instant: int) -> None:
        """The precision is what it is; but time must pass (see `pass_on`)."""
        self.pass_on()

    def pass_on(self) -> None:
        """Looks whether time passes.

        Raises:
            BudgetSpent: if it no longer does.
        """
        if self.history.records:
            self._standing.look(len(self.history.records), self._clock(), self._flights)

    def _clock(self) -> float:
        """The time of the last event."""
        return self.reading.rough(self.history.records[-1].mark.time)

    def _flights(self) -> list[tuple[M, ...]]:
        """(x, y, vx, vy, t) of every circle."""
        return [body.flight[:5] for body in self.bodies.values()]

    def do(self, step: Step) -> None:
        """Carries out a step and logs it."""
        self.history.steps.append(step)
        self.state.do(step)

    def gathered(self, links: Iterable[Link]) -> None:
        """Nothing to note."""

    @property
    def finish(self) -> Callable[[], None]:
        """To be called before the history is read: does nothing."""
        return _nothing

    def close(self) -> None:
        """Lets go of all that it holds but its history: its parts know each other, and would await the collector."""
        vars(self.meetings).clear()
        vars(self).clear()

    def refresh(self, bodies: Iterable[Body[M]]) -> None:
        """Predictions use the state itself; a velocity of exactly zero is noted."""
        zero = self.state.zero
        for body in bodies:
            flight = body.flight
            rest = bool(flight.vx == zero) and bool(flight.vy == zero)
            if rest is not flight.rest:
                body.flight = flight._replace(rest=rest)
            body.q = flight[:5]

    def ask(self, question: Question) -> int:
        """The sign of a question's number.

        Raises:
            Undecided: with the question in words.
        """
        try:
            return self._sign(question.value(self.state))
        except Undecided:
            told = f"{question.describe(self._name)} cannot be told, after {len(self.history.records)} instants"
            raise Undecided(told) from None

    def ask_cheaply(self, question: Question) -> int | None:
        """The sign, or None where it is not known."""
        try:
            return self.ask(question)
        except Undecided:
            return None

    def _name(self, link: Link) -> str:
        return name_of(self.scene, link)


def _nothing() -> None:
    """What there is to do where a history needs no finish."""
