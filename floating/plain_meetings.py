"""When two meet next, in numbers that answer at once: what rounding has put into each other collides at once."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Sequence
from contextlib import suppress
from typing import Generic

from ..exact.laws.formulas import pair_gap
from ..exact.numbers.system import M, NumberSystem, Undecided
from ..exact.question import Approach, Arrives, Beside, Decision, Discriminant, Foot, Gap, Moment, Question, Sooner
from ..exact.replay.contact import AtArc, AtWall, Body, Entry, Link, Round, is_arc, is_flat, is_pair, name_of
from ..exact.replay.landings import Unsharp, faces_arc
from ..exact.replay.state import ReplayState
from ..exact.simulation.arc_meetings import arc_contact, face_contact, fall_to_face, predict_falls
from ..exact.simulation.instant import no_normal
from ..exact.simulation.prediction import Arrival, ArrivalQueue, Predictor
from ..scenarios.scene import Scene
from ..scenarios.trajectory import TieProof


class PlainPegs(Predictor[M]):
    """Predictions of scenes in which something round stands under gravity. See `Predictor`."""

    def predict(self, moved: Sequence[Body[M]], standing: Collection[Link], gone: Collection[int]) -> None:
        """See `Predictor.predict`."""
        predict_falls(self, moved, standing, gone, self._walls_of)

    def face(self, a: Body[M], wall: int, standing: Collection[Link]) -> None:
        """See `Predictor.face`."""
        fall_to_face(self, a, wall, standing, rounded=True)

    def land(self, a: Body[M], link: Round, standing: Collection[Link]) -> None:
        """See `Predictor.land`."""
        try:
            wait = self.state.fall_wait(link)
        except Unsharp as error:
            self.queue.push_doubtful(self.bounds(a.flight.instant)[0] + error.since * (1 - 2.0**-40), link)
            return
        if wait is None:
            return
        time = a.flight.t + wait
        if _has_normal(self.scene, link):
            self.push(time, link)
        else:
            self.queue.push_doubtful(self.bounds(time)[0], link)


def _has_normal(scene: Scene, link: Round) -> bool:
    """Whether two that meet are more than two points, of which rounding alone has the one fall onto the other."""
    return not is_pair(link) or any(scene.circles[i].r.sign() for i in link)


class PlainMeetings(Generic[M]):
    """Predicts and orders meetings by the system's own comparisons.

    Args:
        scene: what runs.
        state: its state.
        queue: where arrivals go.
        plan: counts what is predicted and what is skipped.
        numbers: the state's system.
        ask: decides questions.
        predictor: what predicts, where nothing round stands under gravity.
    """

    def __init__(
        self,
        scene: Scene,
        state: ReplayState[M],
        queue: ArrivalQueue[M],
        plan: Counter[str],
        numbers: NumberSystem[M],
        ask: Callable[[Question], int],
        predictor: type[Predictor[M]] = Predictor,
    ) -> None:
        made = PlainPegs if state.stands else predictor
        self.predictor = made(scene, state, queue, plan, numbers.bounds, self._unsure)
        self.slides = self.predictor.slides
        self._state = state
        self._sign = numbers.sign
        self._bounds = numbers.bounds
        self._ask = ask

    def off_rim(self, link: Entry) -> bool:
        """Nothing is plain before it is asked."""
        return False

    def close(self) -> None:
        """Lets go of its predictor and of who decides for it, which know it."""
        self.predictor.close()
        del self.predictor, self._ask

    def predict(self, moved: Sequence[Body[M]], standing: Collection[Link], gone: Collection[int]) -> None:
        """Queues the next meetings of some circles."""
        self.predictor.predict(moved, standing, gone)

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
            self.predictor.push_doubtful(link)
            return
        if found is not None:
            self.predictor.push(found[0], link, found[1])

    def _meeting(self, link: Link) -> tuple[M, bool] | None:
        """The time of a meeting, and whether it is a graze; None where there is none.

        Two that overlap by rounding and approach collide at once. Where the square of their speed is below all numbers
        of the engine they do not come together, as far as it can tell. That is so of rounded numbers alone: what is
        divided by an enclosure with 0 in it has no ends, and is no error.

        Raises:
            Undecided: where that cannot be told.
        """
        if not is_flat(link) and self._state.on_peg(link):
            return self._meeting_fallen_onto(link)
        if is_arc(link):
            return self._meeting_arc(link)
        if is_flat(link) and link.wall in self.predictor.faces and self._state.scene.gravity is not None:
            return self._meeting_fallen_face(link, self._pull(link))
        if is_flat(link) and (pull := self._pull(link)):
            return self._meeting_fallen(link, pull)
        approach = self._ask(Approach(link))
        if is_flat(link) and link.wall in self.predictor.faces:
            return self._meeting_face(link, approach)
        if approach >= 0:
            return None
        disc = 1 if is_flat(link) else self._ask(Discriminant(link))
        if disc < 0:
            return None
        if (gap := self._ask(Gap(link))) <= 0:
            if not link.pushes or disc == 0 or (is_flat(link) and not self._state.scene.walls[link.wall].is_met(gap)):
                return None
            return link.later(self._state).flight.t, False
        try:
            clock, wait = Moment(link, disc == 0).wait(self._state)
        except ZeroDivisionError:
            return None
        return clock + wait, disc == 0

    def _meeting_arc(self, link: AtArc) -> tuple[M, bool] | None:
        """As `_meeting`, of a side of an arc; what rounding has put into it is on its side, within it, not through."""
        state = self._state
        if self._ask(Approach(link)) < 0 and self._ask(Gap(link)) <= 0:
            a, b = link.ends(state)
            pair = state.relation(link)
            through = self._sign(pair_gap(pair.dx, pair.dy, b.r)) * (1 if link.hollow else -1)
            if through < 0 and self._sign(faces_arc(state, link, pair.dx, pair.dy)) > 0:
                return a.flight.t, False
        try:
            disc = arc_contact(link, self._ask, final=True)
            if disc is None or disc < 0:
                return None
            clock, wait = Moment(link, disc == 0).wait(state)
        except ZeroDivisionError:
            return None
        return clock + wait, disc == 0

    def _meeting_fallen_onto(self, link: Round) -> tuple[M, bool] | None:
        """As `_meeting`, of a circle that falls onto something round that stands."""
        try:
            wait = self._state.fall_wait(link)
        except Unsharp:
            who = name_of(self._state.scene, link)
            raise Undecided(
                f"whether {who} hit, graze or miss, at a zero of a quartic, cannot be decided in numbers of this width"
            ) from None
        if wait is not None and not _has_normal(self._state.scene, link):
            raise Undecided(no_normal(self._state.scene, link))
        return None if wait is None else (self._state.faller(link).flight.t + wait, False)

    def _pull(self, link: AtWall) -> int:
        """See `Sides.pull`; 0 without gravity."""
        return self._state.pull(link)

    def _meeting_fallen(self, link: AtWall, pull: int) -> tuple[M, bool] | None:
        """As `_meeting`, under gravity; what rounding has put into a wall to which it is pulled comes back to it."""
        state, approach, disc = self._state, self._ask(Approach(link)), 1
        now = link.later(state).flight.t
        if pull > 0 and (approach >= 0 or (disc := self._ask(Arrives(link))) < 0):
            return None
        if self._ask(Gap(link)) <= 0:
            if approach <= 0:
                return None if disc == 0 else (now, False)
            if self._ask(Arrives(link)) < 0:  # in it for all of its way up and down
                clock, wait = state.wall_graze(link)
                return clock + wait, False
        try:
            clock, wait = Moment(link, disc == 0).wait(state)
        except ZeroDivisionError:
            return None
        return clock + wait, disc == 0

    def _meeting_fallen_face(self, link: AtWall, pull: int) -> tuple[M, bool] | None:
        """As `_meeting_face`, under gravity; what is put into it for all of its way up comes to it where it turns."""
        state, approach, gap = self._state, self._ask(Approach(link)), self._ask(Gap(link))
        if gap <= 0 and self._is_in_face(link, gap, None):
            if approach < 0 or (approach == 0 and pull < 0):
                return link.later(state).flight.t, False
            if approach == 0 and pull == 0 == gap:
                self.slides.append(link)
            if approach == 0 or pull >= 0:
                return None
            if self._ask(Arrives(link)) < 0:
                moment = Moment(link, graze=True)
                if not self._is_in_face(link, gap, moment):
                    return None
                clock, wait = moment.wait(state)
                return clock + wait, False
        found = face_contact(link, pull, self._ask)
        if found is None or found < 0:
            return None
        try:
            clock, wait = Moment(link, found == 0).wait(state)
        except ZeroDivisionError:
            return None
        return clock + wait, found == 0

    def _is_in_face(self, link: AtWall, gap: int, moment: Moment | None) -> bool:
        """Whether a circle whose gap to a face is not above 0 was put there by rounding: its centre is not through,
        and between the ends, now or at a time.

        Either alone tells that it is not: a point that has left a corner of right angles is through the line of the
        next side, and flies along its end.
        """
        state = self._state
        through = link.gap(state) + state.bodies[link.circle].r * state.line(link.circle, link.wall).length
        with suppress(Undecided):
            if gap and self._sign(through) <= 0:
                return False
        if any(self._ask(Beside(link, far, moment)) <= 0 for far in (False, True)):
            return False
        return gap == 0 or self._sign(through) > 0

    def _is_beyond(self, link: AtWall) -> bool:
        """Whether a circle certainly is beyond an end of a face, and beyond it where it comes to the face's line."""

        def short(question: Question) -> bool:
            with suppress(Undecided):
                return self._ask(question) < 0
            return False

        return any(short(Beside(link, far, None)) and short(Foot(link, far)) for far in (False, True))

    def _meeting_face(self, link: AtWall, approach: int) -> tuple[M, bool] | None:
        """As `_meeting`, of a face; what rounding has put into it is on its side, between its ends, and not through."""
        if approach > 0:
            return None
        try:
            gap = self._ask(Gap(link))
        except Undecided:  # of no matter where it is beyond an end of the face, and comes to its line there
            if approach < 0 and self._is_beyond(link):
                return None
            raise
        if approach == 0:
            if gap == 0:
                self.slides.append(link)
            return None
        state = self._state
        if gap <= 0:
            return (link.later(state).flight.t, False) if self._is_in_face(link, gap, None) else None
        if any(self._ask(Foot(link, far)) <= 0 for far in (False, True)):
            return None
        try:
            clock, wait = link.hit(state)
        except ZeroDivisionError:
            return None
        return clock + wait, False
