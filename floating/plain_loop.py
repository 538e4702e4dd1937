"""The event loop in a finite precision that answers, or fails to answer, at once: no ladder behind it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import inf
from typing import Any

from ..exact.event_loop import Candidate, EventLoop, Limits
from ..exact.machine import Body, Link, Machine, Number
from ..exact.policies import Policy
from ..exact.questions import Approach, Discriminant, Gap, Question, Sooner
from ..exact.undecided import Undecided
from ..scenarios.scene import Scene
from ..scenarios.trajectory import Contact, OnProgress, Tie, TieProof


class PlainLoop(EventLoop):
    """The loop in one number system.

    Args:
        sign: the sign of a number; raises Undecided where it is not known.
        bounds: doubles around a time.
        root: the square root that predictions use.
    """

    def __init__(
        self,
        scene: Scene,
        machine: Machine,
        limits: Limits,
        progress: OnProgress | None,
        sign: Callable[[Number], int],
        bounds: Callable[[Number], tuple[float, float]],
        policy: Policy | None = None,
    ) -> None:
        super().__init__(scene, machine, limits, progress, policy)
        self.quick_zero = machine.zero
        self.quick_root = machine.root
        self._sign = sign
        self._bounds = bounds

    def refresh(self, bodies: Iterable[Body]) -> None:
        """Predictions use the state itself; a velocity of exactly zero is noted."""
        zero = self.machine.zero
        for body in bodies:
            body.rest = bool(body.vx == zero) and bool(body.vy == zero)
            body.q = (body.x, body.y, body.vx, body.vy, body.t)

    def to_predict(self) -> None:
        """Nothing to prepare: predictions are made in the state's own numbers."""

    def bounds(self, time: Number) -> tuple[float, float]:
        """Doubles around a time."""
        return self._bounds(time)

    def quick_reach(self, a: Body, b: Body) -> Number:
        """The sum of two radii."""
        return self.machine.reach(a, b)

    def knot(self, body: Body) -> tuple[Any, ...]:
        """The state."""
        return body.t, body.x, body.y, body.vx, body.vy

    def ask(self, question: Question) -> int:
        """The sign of the question's number, or Undecided with the question in words."""
        try:
            return self._sign(question.value(self.machine))
        except Undecided:
            raise Undecided(
                f"{question.describe(self._name)} cannot be told, after {len(self.history.records)} instants"
            ) from None

    def _name(self, link: Link) -> str:
        other = self.scene.ids[link[1]] if link[1] >= 0 else f"pocket {self.scene.pockets[-1 - link[1]].id}"
        return f"{self.scene.ids[link[0]]} and {other}"

    def unsure(self, link: Link) -> None:
        """A prediction with a sign that is not certain, or with no gap left: by rounding, or touching."""
        try:
            time = self._hit_time(link)
        except Undecided:
            low = self.earliest_possible(link)
            if low < inf:
                self.push_doubtful(low, link)
            return
        if time is not None:
            self.push(time, link)

    def _hit_time(self, link: Link) -> Number | None:
        """The time of a hit, None where there is none.

        Raises:
            Undecided: where that cannot be told.
        """
        if link[1] < self.n and self.ask(Discriminant(link)) <= 0:
            return None
        if self.ask(Approach(link)) >= 0:
            return None
        if self.ask(Gap(link)) <= 0:
            if link[1] < 0:
                return None
            later = max((i for i in link if i < self.n), key=lambda i: self.bodies[i].last)
            return self.bodies[later].t
        clock, wait = self.machine.hit(link)
        return clock + wait

    def _settled(self, candidate: Candidate) -> Candidate | None:
        if candidate.time is not None:
            return candidate
        time = self._hit_time(candidate.link)
        return None if time is None else candidate._replace(time=time)

    def earliest(self, rivals: list[Candidate]) -> tuple[list[Candidate], list[Candidate], list[Tie]]:
        """The first by the system's own comparison; equal times make a tie."""
        certain = [c for c in map(self._settled, rivals) if c is not None]
        chosen = certain[:1]
        rest: list[Candidate] = []
        for candidate in certain[1:]:
            sign = self._compare(candidate, chosen[0])
            if sign < 0:
                rest += chosen
                chosen = [candidate]
            elif sign > 0:
                rest.append(candidate)
            else:
                chosen.append(candidate)
        return chosen, rest, self._ties(chosen)

    def _compare(self, candidate: Candidate, other: Candidate) -> int:
        try:
            return self._sign(candidate.time - other.time)
        except Undecided:
            return self.ask(Sooner(candidate.link, other.link))

    def _ties(self, chosen: list[Candidate]) -> list[Tie]:
        if len(chosen) < 2:
            return []
        ids = self.scene.ids
        chosen = [c for c in chosen if c.link[1] >= 0]
        contacts = tuple(Contact(ids[c.link[0]], ids[c.link[1]]) for c in sorted(chosen, key=lambda c: c.link))
        return [Tie(contacts, TieProof.FLOAT)]
