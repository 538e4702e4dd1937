"""Decisions in a finite precision that answers, or fails to answer, at once: nothing stronger stands behind it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Iterable, Sequence
from typing import Any

from ..exact.machine import Body, Link, Machine, Number, Step
from ..exact.questions import Approach, Discriminant, Gap, Moment, Question, Sooner
from ..exact.simulation.history import History
from ..exact.simulation.prediction import Predictor
from ..exact.simulation.queue import Arrival, ArrivalQueue
from ..exact.undecided import Undecided
from ..scenarios.event import Contact, Tie, TieProof
from ..scenarios.numbers.quantity import Quantity
from ..scenarios.scene import Scene


class PlainDecider:
    """The decider of one number system.

    Args:
        scene: what runs.
        machine: its state.
        sign: the sign of a number; raises Undecided where it is not known.
        bounds: doubles around a time.
    """

    def __init__(
        self,
        scene: Scene,
        machine: Machine,
        sign: Callable[[Number], int],
        bounds: Callable[[Number], tuple[float, float]],
    ) -> None:
        self.scene = scene
        self.machine = machine
        self.history = History()
        self.bodies: list[Body] = list(machine.bodies)[: machine.n]
        self.queue = ArrivalQueue(self.bodies)
        self.predictor = Predictor(scene, machine, self.queue, self.history.plan, bounds, self._unsure)
        self._sign = sign
        self._bounds = bounds
        self.refresh(machine.bodies)

    # -- the state

    def begin(self, instant: int) -> None:
        """Nothing to prepare: the precision is what it is."""

    def do(self, step: Step) -> None:
        """Carries out a step and logs it."""
        self.history.steps.append(step)
        self.machine.do(step)

    def gathered(self, links: Iterable[Link]) -> None:
        """Nothing to note."""

    def refresh(self, bodies: Iterable[Body]) -> None:
        """Predictions use the state itself; a velocity of exactly zero is noted."""
        zero = self.machine.zero
        for body in bodies:
            body.rest = bool(body.vx == zero) and bool(body.vy == zero)
            body.q = (body.x, body.y, body.vx, body.vy, body.t)

    def knot(self, body: Body) -> tuple[Any, ...]:
        """The state."""
        return body.t, body.x, body.y, body.vx, body.vy

    def now(self, body: Body) -> Number:
        """The instant of a body's last contact."""
        return body.instant

    def entry_time(self, link: Link) -> Number:
        """The time of an entry."""
        clock, wait = self.machine.hit(link)
        return clock + wait

    def reversal_time(self) -> Number:
        """The time of the reversal."""
        return self.machine.flip_time

    def exact_state(self, bodies: Sequence[int]) -> Hashable | None:
        """None: the state is not exact."""
        return None

    def note(self) -> str:
        """Nothing to add."""
        return ""

    def rough(self, time: Number) -> float:
        """The lower bound of a time."""
        return self._bounds(time)[0]

    def limit_bounds(self, time: Quantity | None) -> tuple[float, float]:
        """Doubles around a set time (None: the return)."""
        if time is None:
            return self._bounds(self.machine.flip_time + self.machine.flip_time)
        return self._bounds(self.machine.constant(time))

    def off_rim(self, link: Link) -> bool:
        """Nothing is plain before it is asked."""
        return False

    def predict(self, moved: Sequence[Body], standing: Collection[Link], gone: Collection[int]) -> None:
        """Queues the next meetings of some circles."""
        self.predictor.predict(moved, standing, gone)

    # -- decisions

    def ask(self, question: Question) -> int:
        """The sign of a question's number.

        Raises:
            Undecided: with the question in words.
        """
        try:
            return self._sign(question.value(self.machine))
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
        other = self.scene.ids[link[1]] if link[1] >= 0 else f"pocket {self.scene.pockets[-1 - link[1]].id}"
        return f"{self.scene.ids[link[0]]} and {other}"

    def tie(self, links: tuple[Link, ...]) -> Tie:
        """A tie of equal numbers."""
        ids = self.scene.ids
        return Tie(tuple(Contact(ids[i], ids[j]) for i, j in sorted(links)), TieProof.FLOAT)

    def timed(self, arrival: Arrival) -> Arrival:
        """Its time was computed when it was predicted."""
        return arrival

    def certainly_before(self, first: Arrival, second: Arrival) -> bool:
        """Whether the system's own comparison says so."""
        return (first.time < second.time) is True

    def order(self, first: Arrival, second: Arrival) -> int:
        """The sign of the difference of two times at hand, or of the question where that is not known."""
        try:
            return self._sign(first.time - second.time)
        except Undecided:
            return self.ask(Sooner(Moment(first.link, first.graze), Moment(second.link, second.graze)))

    def settled(self, arrival: Arrival) -> Arrival | None:
        """The arrival if it comes.

        Raises:
            Undecided: where that cannot be told.
        """
        found = self._meeting(arrival.link)
        if found is None:
            return None
        time, graze = found
        low, high = self._bounds(time)
        return arrival._replace(low=low, high=high, time=time, graze=graze)

    def _unsure(self, link: Link) -> None:
        """A prediction with a sign that is not certain, or with no gap left: by rounding, or touching."""
        try:
            found = self._meeting(link)
        except Undecided:
            self.predictor.push_doubtful(link)
            return
        if found is not None:
            self.predictor.push(found[0], link, found[1])

    def _meeting(self, link: Link) -> tuple[Number, bool] | None:
        """The time of a meeting, and whether it is a graze; None where there is none.

        Two that overlap by rounding and approach collide at once.

        Raises:
            Undecided: where that cannot be told.
        """
        if self.ask(Approach(link)) >= 0:
            return None
        disc = self.ask(Discriminant(link)) if link[1] < self.machine.n else 1
        if disc < 0:
            return None
        if self.ask(Gap(link)) <= 0:
            if link[1] < 0 or disc == 0:
                return None
            later = max((i for i in link if i < self.machine.n), key=lambda i: self.bodies[i].last)
            return self.bodies[later].t, False
        clock, wait = Moment(link, disc == 0).wait(self.machine)
        return clock + wait, disc == 0
