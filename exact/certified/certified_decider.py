"""The decider of the exact engine: refines the state as needed, and puts every question to the cascade."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Sequence
from typing import NoReturn, Protocol

from flint import arb

from ...scenarios.scene import Scene
from ...scenarios.trajectory import Assumption
from ..log_symmetry import FixedProjections, LogSymmetry, Past, Retrace
from ..numbers import ball
from ..numbers.ball import Known
from ..numbers.system import BudgetSpent, Undecided
from ..question import Approach, Arrives, Decision, Discriminant, Foot, Gap, Moment, Question, Sooner
from ..replay.contact import (
    AtWall,
    Body,
    Entry,
    Link,
    Round,
    Touch,
    can_push,
    is_arc,
    is_flat,
    name_of,
    touching_at_start,
)
from ..replay.refinable import Projection, RefinableState, rises_in_sets
from ..replay.state import STEP_UNITS, Go, Kick, Step, step_units
from ..simulation.arc_meetings import arc_contact
from ..simulation.decider import History, Limits, Mark, PackedKnots, PackedRecords, Record
from ..simulation.prediction import Arrival, ArrivalQueue
from .cascade import Cascade, CertifiedReading, Grounds, InBalls, TieRule, rough
from .filtered import FilteredPredictor

# -- When the state is computed again with more bits, and with how many.

FIRST_BITS = 256
"""Precision of the state at first: four words, twice the quick one, so the first rise comes late."""

SAFE_BITS = 96
"""When the times' accuracy falls below this, precision rises at once: predictions would soon be undecided, and
results should round to doubles without another look."""

FORESIGHT = 1.1
"""Share by which the bits foreseen for a whole run exceed the extrapolation, so that one rise mostly suffices."""

SET_FORESIGHT = 1.06
"""The same where deviations are kept in a set, whose rate varies less from one part of a run to another."""

ONCE = 40
"""Bits that a set loses once and for all: what a body's bound grows within a block beyond the set itself."""

LONG_BITS = 8_000
"""Precision from which on deviations are kept in a set: it then costs no more, as it needs well under half the bits."""

CENTRED_SHARE = 0.5
"""Share of the bits that balls need which then suffices; if it does not, one more rise comes."""

PILOTS = 10
"""By how much fewer bits deviations are first kept in a set, for a start that tells how fast bits go then: what is
carried out twice is a tenth of the run, with a tenth of the bits, and the rest needs no wide margin."""

MOST_FORESIGHT = 64
"""Most by which one rise multiplies the precision: an extrapolation from a short past may be far off. With 16, a gas of
10,000 or 100,000 events rose once more, late, and was carried out nearly twice."""


class Precision:
    """The bits of a run.

    Args:
        state: what is computed again.
        history: how far the run is; counts the rises.
        limits: where it ends; tells how many bits the whole run will need.
        max_bits: the precision beyond which there is none.
    """

    def __init__(self, state: RefinableState, history: History[Known], limits: Limits, max_bits: int) -> None:
        self._state = state
        self._history = history
        self._limits = limits
        self._max_bits = max_bits

    def secure(self) -> None:
        """More bits, if the last instant is not accurate enough.

        Raises:
            Undecided: if there are none.
        """
        while self._state.lowest < SAFE_BITS:
            self._rise("accuracy had run low", self._foreseen())

    def rise(self, why: str) -> None:
        """Twice the bits.

        Raises:
            Undecided: if there are none, with the reason for which they were wanted.
        """
        self._rise(why, 0)

    def units(self) -> int:
        """The work of computing the whole log again with twice the bits."""
        return len(self._state.steps) * step_units(2 * self._state.bits)

    def where(self) -> str:
        """How far the run is, as a person reads it."""
        return f"after {len(self._history.records)} instants"

    def _rise(self, why: str, foreseen: int) -> None:
        near = foreseen > 0 and self._state.centred  # the rate has settled: no need to double
        least = self._state.bits * 5 // 4 if near else 2 * self._state.bits
        bits = max(least, min(foreseen, self._max_bits))
        if bits > self._max_bits:
            raise Undecided(
                f"{why} at {self._state.bits} bits, and max_bits is {self._max_bits}; "
                f"{self.where()}; allow more bits to go on"
            )
        self._history.plan["precision raised"] += 1
        long = int(LONG_BITS * self._state.balls.costs)
        given_up = any(many >= long and not in_set for many, in_set in self._history.rises)
        centred = self._state.centred or (bits >= long and not (given_up or self._state.scene.settle))
        begun = centred and not self._state.centred
        if begun:
            bits = max(2 * self._state.bits, int(CENTRED_SHARE * bits) // PILOTS)
        lost = self._state.bits - self._state.lowest
        if begun and not rises_in_sets(self._state, bits, max(lost, ONCE)):
            begun, centred, bits = False, False, max(bits, long)  # a set that loses more than balls is given up
        if not begun:
            self._state.rise(bits, centred)
        self._history.rises.append((bits, centred))

    def _foreseen(self) -> int:
        """The bits that the whole run will need if it goes on losing them as it has."""
        done = len(self._history.records)
        wholes: list[float] = []
        if self._limits.events is not None:
            wholes.append(self._limits.events)
        if self._limits.until is not None and done:
            reached = rough(self._history.records[-1].mark.time)
            if reached > 0.0:
                wholes.append(done * ball.double_bounds(ball.constant(self._limits.until))[1] / reached)
        if not wholes or not done:
            return 0
        once = ONCE if self._state.centred else 0
        lost = max(self._state.bits - self._state.lowest - once, 1)
        share = SET_FORESIGHT if self._state.centred else FORESIGHT
        whole = min(wholes) / done * lost * share + once + 2 * SAFE_BITS
        return int(min(whole, MOST_FORESIGHT * self._state.bits))  # also where times are beyond doubles


# -- When two meet next, certified: predictions through the filter, times in balls, doubts settled by the cascade.


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
        work: what the time of one meeting may cost before it is undecided.
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
        work: int,
    ) -> None:
        if scene.gravity is not None or scene.moving_walls or scene.arc_sides:
            from .filtered_arcs import predictor_of

            self.predictor, self._pegs = predictor_of(scene, state, queue, plan, self._unsure)
        else:
            self.predictor, self._pegs = FilteredPredictor(scene, state, queue, plan, self._unsure), None
        self.slides = self.predictor.slides
        self._state = state
        self._plan = plan
        self._precision = precision
        self._sign = balls.sign
        self._judge = judge
        self._grazes = grazes
        self._work = work

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
        if not is_flat(link) and self._state.balls.on_peg(link):
            return self._settled_fall(arrival, link)
        if is_arc(link):
            disc = arc_contact(link, self._decided, final=True)
        elif self._pegs is not None and self._pegs.falls_to_face(link):
            disc = self._pegs.face_settled(link, self._sign, self._decided)
        elif self._judge.decide(Approach(link)).sign >= 0 or self._misses(link):
            return None
        else:
            disc = self._judge.decide(reached).sign if (reached := self._reached(link)) else 1
        if disc is None or disc < 0:
            return None
        low, high = ball.double_bounds(time := self._meeting(link, disc))
        return arrival._replace(low=low, high=high, certain=True, time=time, graze=disc == 0)

    def time(self, moment: Moment) -> arb:
        """The time of a meeting that is certain, as a ball of full precision that excludes the past.

        Raises:
            Undecided: where more bits than there are, or more work than is allowed, would be needed.
        """
        spent = 0
        while True:
            ball.use_bits(self._state.bits)
            self._state.sync(moment.link.circles)
            try:
                t, wait = moment.wait(self._state.balls)
                if t + wait > moment.link.later(self._state.balls).flight.instant:
                    return t + wait
            except ZeroDivisionError:
                pass
            why, units = f"the time of {self._judge.name(moment.link)} is unsharp", self._precision.units()
            if spent and spent + units > self._work:  # once is as when accuracy runs low
                where = f"{self._precision.where()}, with {self._state.bits} bits"
                raise Undecided(f"{why}, {where}; more than {self._work} units of work (--work)")
            spent += units
            self._precision.rise(why)

    def _settled_fall(self, arrival: Arrival[arb], link: Round) -> Arrival[arb] | None:
        """As `settled`, of a circle that falls onto something round: more bits, unless fractions tell of a graze."""
        spent, predictor = 0, self._pegs
        assert predictor is not None
        while True:
            found, grazes = predictor.comes(link, None if spent else (self._sign, self._decided))
            if found is None:
                return None
            if isinstance(found, arb):
                if grazes:
                    self._grazes(link)
                low, high = ball.double_bounds(found)
                return arrival._replace(low=low, high=high, certain=True, time=found, graze=grazes)
            why = f"whether {self._judge.name(link)} hit, graze or miss, at a zero of a quartic, which no field holds"
            bits = 2 * self._state.bits  # so often the interval is halved with the next ones, before nothing is said
            spent += self._precision.units() + bits * step_units(bits)
            if spent > self._work:
                where = f"{self._precision.where()}, with {self._state.bits} bits"
                raise Undecided(f"{why}, is not proved, {where}; {spent} units of work of {self._work} (--work)")
            self._precision.rise(f"{why}, was undecided")

    def _misses(self, link: Link) -> bool:
        """Whether a circle that approaches a face meets its line outside of it: its ends are none of it."""
        if not is_flat(link) or link.wall not in self.predictor.faces:
            return False
        return any(self._judge.decide(Foot(link, far)).sign <= 0 for far in (False, True))

    def _unsure_face(self, link: AtWall) -> None:
        """As `_unsure`, of a face; a circle at its line that neither nears nor leaves it slides along it.

        A gap below zero is behind the face, or beside it.
        """
        doubtful = self.predictor.push_doubtful
        gap, approach = self._sign(Gap(link)), self._sign(Approach(link))
        if (gap is not None and gap < 0) or (approach is not None and approach > 0):
            return
        feet = [self._sign(Foot(link, far)) for far in (False, True)]
        if approach is not None and approach < 0 and any(foot is not None and foot <= 0 for foot in feet):
            return
        if gap:
            if approach is None:
                doubtful(link)
            if not approach:
                return
        else:
            approach = self._judge.decide(Approach(link)).sign if approach is None else approach
            gap = self._judge.decide(Gap(link)).sign
            if approach > 0 or gap < 0 or (gap > 0 and approach == 0):
                return
            if approach == 0:
                self.predictor.slides.append(link)
                return
        if gap == 0:
            if not self._misses(link):
                self._overlap(link)
            return
        ball.use_bits(self._state.bits)
        if None in feet:
            doubtful(link)
        else:
            self.predictor.push(self._meeting(link, 1), link)

    def _lets_by(self, link: Link, gap: int) -> bool:
        """Whether a wall is of a kind that does not meet what is at it, or behind it."""
        return is_flat(link) and not self.predictor.scene.walls[link.wall].is_met(gap)

    def _decided(self, question: Question) -> int:
        return self._judge.decide(question).sign

    def _overlap(self, link: Link) -> NoReturn:
        raise AssertionError(f"{self._judge.name(link)} overlap, or touch unseen, {self._precision.where()}: a defect")

    def _pull(self, link: AtWall) -> int:
        """See `Sides.pull`; 0 without gravity."""
        return self._state.balls.pull(link)

    def _reached(self, link: Link) -> Question | None:
        """Whether two that approach meet at all; None where they always do."""
        return Discriminant(link) if not is_flat(link) else Arrives(link) if self._pull(link) else None

    def _meeting(self, link: Link, disc: int) -> arb:
        """The time of a hit or, where the discriminant is zero, of a graze, which is noted."""
        if disc == 0:
            self._grazes(link)
        return self.time(Moment(link, disc == 0))

    def _unsure(self, link: Link) -> None:
        """A prediction that short balls could not decide: full balls, and proofs where they leave it open.

        A gap of zero does not occur here: what stands at gap zero at an instant was gathered for it.
        """
        self._plan["full predictions"] += 1
        if self._pegs is not None and not is_flat(link) and self._state.balls.on_peg(link):
            return self._pegs.push_unsure(link)
        ball.use_bits(self._state.bits)
        if self._pegs is not None and self._pegs.falls_to_face(link):
            return self._push(link, self._pegs.face_unsure(link, self._sign, self._decided, self._overlap))
        if is_flat(link) and self._pull(link) < 0:
            if self._sign(Gap(link)) == -1:
                self._overlap(link)
            self.predictor.push(self._meeting(link, 1), link)
            return
        if is_flat(link) and link.wall in self.predictor.faces:
            return self._unsure_face(link)
        if is_arc(link):
            return self._push(link, arc_contact(link, self._sign))
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
            if (not link.pushes and gap < 0) or self._lets_by(link, gap):
                return
            self._overlap(link)
        disc = self._sign(reached) if (reached := self._reached(link)) else 1
        self._push(link, None if approach is None and (disc is None or disc >= 0) else disc)

    def _push(self, link: Link, disc: int | None) -> None:
        """Queues a hit (1), a graze (0) or what may be one (None); nothing for a miss (-1)."""
        ball.use_bits(self._state.bits)
        if disc is None:
            self.predictor.push_doubtful(link)
        elif disc >= 0:
            self.predictor.push(self._meeting(link, disc), link, disc == 0)


# -- Many instants in one go: each of one contact alone, which nothing comes near.
#
# Nearly all instants of a run are like that. Nothing is to be gathered or ordered for them, there is one impulse, and
# what the loop would do step by step (see `Loop`) is done here in a row, to the same end: the same log, the same
# history, the same queue. Whatever is otherwise is left to the loop.


class Stride:
    """Carries out the ordinary instants of one run.

    Args:
        state: its state.
        history: what it has gathered.
        queue: its arrivals.
        meetings: predicts.
        reading: reads the state off.
        precision: its bits.
        begin: called before the steps of an instant, with its number.
        do: carries out a step that is not ordinary, and logs it.
    """

    def __init__(
        self,
        state: RefinableState,
        history: History[Known],
        queue: ArrivalQueue[arb],
        meetings: CertifiedMeetings,
        reading: CertifiedReading,
        precision: Precision,
        begin: Callable[[int], None],
        do: Callable[[Go | Kick], None],
    ) -> None:
        self._state = state
        self._history = history
        self._queue = queue
        self._meetings = meetings
        self._reading = reading
        self._precision = precision
        self._begin = begin
        self._do = do
        self._refresh = meetings.predictor.refresh
        self._take = meetings.predictor.take
        self._steps: dict[Touch, tuple[tuple[Go, Kick], list[Body[arb]], list[Body[arb]]]] = {}

    def __call__(
        self, last: int, most: float, before: float, look: Callable[[], None], note: Callable[[Touch], None]
    ) -> int:
        """Carries out instants while they are ordinary; gives the number of the last.

        Args:
            last: the number of the instant before.
            most: how many at most.
            before: a time that all come before.
            look: called before each look for an instant.
            note: told of each contact.
        """
        queue, predict, slides = self._queue, self._meetings.predictor.predict, self._meetings.slides
        while most > 0:
            look()
            link = queue.alone(before)
            if link is None:
                break
            most -= 1
            last += 2
            predict(*self._carried_out(link, last, note, self._precision), ())
            if slides:
                break
        return last

    def again(self, link: Touch, number: int, note: Callable[[Touch], None]) -> None:
        """Carries out an instant that an earlier run had in a stride; its meetings are not predicted.

        Args:
            link: its contact.
            number: of the instant.
            note: told of the contact.
        """
        self._carried_out(link, number, note, None)

    def _carried_out(
        self, link: Touch, number: int, note: Callable[[Touch], None], precision: Precision | None
    ) -> tuple[list[Body[arb]], tuple[Touch, ...]]:
        """Carries out one instant, with the precision looked after if one is given: what it moves, and its contact.

        A fixed circle flies on as it did: what is predicted of it and of others holds.
        """
        history, state, reading = self._history, self._state, self._reading
        self._begin(number)
        both, moved, free = self._steps.get(link) or self._steps_of(link)
        in_balls = state.strike(link, both)
        if not in_balls:
            for step in both:
                self._do(step)
        circles, alone = both[0].bodies, both[1].links
        note(alone[0])  # of which there is one object however often it comes
        if precision is not None and state.lowest < SAFE_BITS:
            precision.secure()
        landed = state.lone.landed if in_balls else None
        if landed is not None:
            self._take(landed, landed[0][1][4])
        else:
            self._refresh(moved)
        done = len(state.steps)
        time = +state.balls.instant if in_balls else reading.now(moved[0])  # short, as `refresh` has left it
        mark = _new(Mark, (number, time, done, circles[0]))
        history.records.append(_new(Record, (mark, alone, alone, (), False)))
        knots = history.knots
        for body in free:
            body.serial += 1
        for body in moved:
            if in_balls:
                x, y, vx, vy, t = body.q
                knots[body.index].append((t, x, y, vx, vy, done, number))
            else:
                knots[body.index].append((*reading.knot(body), done, number))
        history.last = mark
        return free, alone

    def _steps_of(self, link: Touch) -> tuple[tuple[Go, Kick], list[Body[arb]], list[Body[arb]]]:
        """The steps of a contact, its circles, and those of them that move."""
        circles, steps = self._state.scene.circles, (Go(link, link.circles), Kick((link,), (link,)))
        bodies = [self._state.bodies[i] for i in link.circles]
        free = [body for body in bodies if not circles[body.index].fixed]
        found = self._steps[link] = steps, bodies, bodies if len(free) == len(bodies) else free
        return found


_new = tuple.__new__
"""Makes a named tuple of all its fields: what its own constructor does, in a third of the time."""


# -- The exact engine's decider: keeps the state, refined as needed, and puts every question to the cascade.

ASK_UNITS = 20
"""Work of a question that balls answer."""


class CertifiedDecider:
    """Decides for the exact engine, and keeps its state (see `Decider`).

    Args:
        scene: what runs.
        limits: where it ends; tells how many bits the whole run will need.
        max_bits: the precision beyond which an undecided sign stays so.
        work: what one question may cost before it is undecided.
        rule: what is taken for a zero that is not proved.

    Attributes:
        state: the state.
        retrace: what the way back knows of the way out.
        stride: carries ordinary instants out; None where too little work is allowed for them.
        grazes: by the number of the instant at which the later of their flights begins: the pairs proved to graze.
    """

    proves = True

    def __init__(self, scene: Scene, limits: Limits, max_bits: int, work: int, rule: TieRule) -> None:
        self.scene = scene
        self.state = RefinableState(scene, FIRST_BITS)
        self.history: History[Known] = History(PackedRecords(), steps=self.state.steps, row=PackedKnots)
        self.bodies = self.state.bodies
        self.queue = ArrivalQueue(self.bodies)
        self.retrace = Retrace(Past([not c.fixed for c in scene.circles], self.state.steps), touching_at_start(scene))
        self.grazes: dict[int, list[Link]] = {}
        self._past = self.retrace.past
        self._precision = Precision(self.state, self.history, limits, max_bits)
        self._work = work
        self._instant = self._instant_work = 0
        log = LogSymmetry(scene, self._past)
        grounds = Grounds(
            scene, self.state, self.state.steps, self.retrace, log, rule, max_bits, work,
            self.catch_up, self._precision.rise, self._spend, self._precision.where, self.name,
        )  # fmt: skip
        plan = self.history.plan
        self._cascade = Cascade(grounds, plan)
        self.meetings = CertifiedMeetings(
            scene, self.state, self.queue, plan, self._precision, InBalls(grounds), self, self._note_graze, work
        )
        self.reading = CertifiedReading(self.state, self.meetings)
        self.stride: Stride | None = None
        if work >= 2 * STEP_UNITS:
            self.stride = Stride(
                self.state, self.history, self.queue, self.meetings, self.reading, self._precision, self._count, self.do
            )
        self._held = FixedProjections(scene, log)
        if self._held:
            self.state.held = self._projection
        self.refresh(self.state.balls.pockets)

    # -- the state

    def begin(self, instant: int) -> None:
        """Full precision."""
        self._count(instant)
        ball.use_bits(self.state.bits)

    def _count(self, instant: int) -> None:
        """An instant begins."""
        self._past.begin(instant)
        self._instant = instant
        self._instant_work = 0

    def do(self, step: Step) -> None:
        """Carries out a step and logs it.

        Raises:
            BudgetSpent: if the steps of one instant, and what had to be proved for them, cost more than is allowed.
        """
        ball.use_bits(self.state.bits)
        self.state.do(step)
        self._instant_work += step_units(self.state.length)
        if self._instant_work > self._work:
            raise BudgetSpent(
                f"the impulses of one instant cost more than {self._work} units of work, {self._precision.where()}; "
                "they may have no end: allow more (--work)"
            )

    def gathered(self, links: Iterable[Link]) -> None:
        """Notes the contacts at gap zero, for the way back."""
        self.retrace.gathered(self._instant, filter(can_push, links))

    def refresh(self, bodies: Iterable[Body[arb]]) -> None:
        """Short copies of the states, with more bits first if the last instant is not accurate enough."""
        self._precision.secure()
        self.meetings.predictor.refresh(bodies)

    def catch_up(self) -> None:
        """Brings what is known of the past up to the end of the log."""
        self.retrace.note(self._past.catch_up())

    def _note_graze(self, link: Link) -> None:
        self.catch_up()
        if self.retrace.grazes(link):
            begun = max(self.history.knots[i][-1][-1] for i in link.circles) // 2 * 2
            self.grazes.setdefault(begun, []).append(link)

    def graze_again(self, instant: int) -> None:
        """Notes the grazes that are known of flights that begin at an instant, which has just been carried out."""
        self.catch_up()
        for link in self.grazes.get(instant, ()):
            self.retrace.grazes(link)

    def _projection(self, i: int) -> Projection | None:
        """What holds a circle to a line or a point, after the last step of the log; None if it stands there."""
        if self._held.stands(self.state.balls.bodies[i]):
            return None
        self.catch_up()
        return self._held(i)

    def _spend(self, units: int) -> None:
        self._instant_work += units

    def close(self) -> None:
        """Lets go of all that it holds but its history: its parts know each other, and would await the collector."""
        self.meetings.predictor.close()
        del self.meetings.predictor, self.meetings, self.reading, self.stride, self._cascade
        self.state.held = None

    # -- questions

    def ask(self, question: Question) -> int:
        """The sign of a question.

        Raises:
            Undecided: naming the question, what was tried and the bits.
        """
        return self.decide(question).sign

    def ask_cheaply(self, question: Question) -> int | None:
        """The sign if balls or the field tell it, else None."""
        decision = self._cascade.decide_quickly(question)
        return None if decision is None else decision.sign

    def decide(self, question: Question) -> Decision:
        """The answer to a question; what is less than proof is kept as an assumption.

        Raises:
            Undecided: as `ask`.
        """
        self._instant_work += ASK_UNITS
        decision = self._cascade.decide(question)
        if decision.bound is not None:
            event, told = len(self.history.records), question.describe(self.name)
            self.history.assumptions.append(Assumption(event, told, decision.proof, decision.bound))
        return decision

    def name(self, link: Link) -> str:
        """A contact as a person reads it."""
        return name_of(self.scene, link)
