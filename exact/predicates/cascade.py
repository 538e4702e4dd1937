"""The exact engine's decisions: doubles, short balls, full balls, the scene's field, proofs of zero, more bits.

Every decision climbs only as far as it must. What a rung decides is certain; what none decides is Undecided.
"""

from __future__ import annotations

from collections.abc import Collection, Hashable, Iterable, Sequence
from typing import Any

from flint import arb, ctx, fmpq  # type: ignore[attr-defined]

from ...scenarios.quantity import Quantity
from ...scenarios.scene import Scene
from ...scenarios.tower import sign_of_root_sum
from ...scenarios.trajectory import Assumption, Contact, Tie, TieProof
from ...scenarios.work import Work
from ..live import LiveMachine
from ..machine import Body, Link, Number, Step
from ..numbers import ball
from ..numbers.field import LeavesField, field_ball, field_sign, field_text
from ..questions import Approach, Discriminant, Gap, Moment, Question, Sooner
from ..simulation.history import History
from ..simulation.limits import Limits
from ..simulation.queue import Arrival, ArrivalQueue
from ..simulation.start import touching_at_start
from ..undecided import BudgetSpent, Undecided
from .filtered_prediction import LATER, QUICK_BITS, FilteredPredictor
from .held import Held
from .isometry import Projection
from .log_symmetry import LogSymmetry
from .nested_roots import NestedRoots
from .past import Past
from .retrace import Retrace
from .ties import TieRule

FIRST_BITS = 256
"""Precision of the state at first: four words, twice the quick one, so the first rise comes late."""

SAFE_BITS = 96
"""When the times' accuracy falls below this, precision rises at once: predictions would soon be undecided, and
results should round to doubles without another look."""

FORESIGHT = 1.1
"""Share by which the bits foreseen for a whole run exceed the extrapolation, so that one rise mostly suffices."""

MOST_FORESIGHT = 16
"""Most by which one rise multiplies the precision: an extrapolation from a short past may be far off."""

TRY_BITS = 1024
"""Below this precision, more bits are cheaper than any attempt to prove a zero in nested roots."""

FIRST_SHARE = 100_000
"""Work that the first attempt in nested roots may take: a tenth of a second, about what shallow proofs need."""

SHARE_GROWTH = 4
"""By how much each further attempt may take more. Between two of them the bits are doubled, so that neither a number
that more bits tell from zero nor one that nested roots prove zero waits long for the other's attempts."""

STEP_UNITS = 60
"""Work of one step of the log in short balls: about 60 microseconds."""


ASK_UNITS = 20
"""Work of a question that balls answer."""


class Cascade:
    """Decides for the exact engine, and keeps its state.

    Args:
        scene: what runs.
        limits: where it ends; tells how many bits the whole run will need.
        max_bits: the precision beyond which an undecided sign stays so.
        work: what one question may cost before it is undecided.
        rule: what is taken for a zero that is not proved.
    """

    def __init__(self, scene: Scene, limits: Limits, max_bits: int, work: int, rule: TieRule) -> None:
        self.scene = scene
        self.limits = limits
        self.max_bits = max_bits
        self.work = work
        self.rule = rule
        self.n = len(scene.circles)
        self.live = LiveMachine(scene, FIRST_BITS)
        self.history = History(steps=self.live.steps)
        self.bodies: list[Body] = list(self.live.bodies)[: self.n]
        self.queue = ArrivalQueue(self.bodies)
        self.plan = self.history.plan
        self.predictor = FilteredPredictor(scene, self.live, self.queue, self.plan, self._unsure)
        self.past = Past([not circle.fixed for circle in scene.circles], self.live.steps)
        self.retrace = Retrace(self.past, touching_at_start(scene))
        self.log = LogSymmetry(scene, self.past)
        self.roots = NestedRoots(scene)
        self._held = Held(scene, self.log)
        if self._held:
            self.live.held = self._projection
        self.assumptions: list[Assumption] = []
        self._instant = self._instant_work = 0
        self._proof: tuple[TieProof, int | None] = (TieProof.CONSTRUCTION, None)
        self.refresh(list(self.live.bodies)[self.n :])

    # -- the state

    def begin(self, instant: int) -> None:
        """Full precision."""
        self.past.begin(instant)
        self._instant = instant
        self._instant_work = 0
        ctx.prec = self.live.bits

    def do(self, step: Step) -> None:
        """Carries out a step and logs it.

        Raises:
            BudgetSpent: if the steps of one instant, and what had to be proved for them, cost more than is allowed.
        """
        ctx.prec = self.live.bits
        self.live.do(step)
        self._instant_work += STEP_UNITS
        if self._instant_work > self.work:
            raise BudgetSpent(
                f"the impulses of one instant cost more than {self.work} units of work, {self._where()}; they may "
                "have no end: allow more (--work)"
            )

    def gathered(self, links: Iterable[Link]) -> None:
        """Notes the contacts at gap zero, for the way back."""
        self.retrace.gathered(self._instant, (link for link in links if link[1] >= 0))

    def catch_up(self) -> None:
        """Brings what is known of the past up to the end of the log."""
        self.retrace.note(self.past.catch_up())

    def _projection(self, i: int) -> Projection | None:
        """What holds a circle to a line or a point, after the last step of the log."""
        self.catch_up()
        return self._held(i)

    def refresh(self, bodies: Iterable[Body]) -> None:
        """Short copies of the states, with more bits first if the last instant is not accurate enough."""
        while self.live.lowest < SAFE_BITS:
            self._rise("accuracy had run low", self._foreseen_bits())
        self.predictor.refresh(bodies)

    def predict(self, moved: Sequence[Body], standing: Collection[Link], gone: Collection[int]) -> None:
        """Queues the next meetings of some circles."""
        self.predictor.predict(moved, standing, gone)

    def off_rim(self, link: Link) -> bool:
        """Whether doubles tell a centre from the rim."""
        return self.predictor.off_rim(link)

    def knot(self, body: Body) -> tuple[Any, ...]:
        """The state: exact numbers if the body is exact, else short balls."""
        if self.live.exact[body.index]:
            return self.live.state(body.index)
        x, y, vx, vy, t = body.q
        return t, x, y, vx, vy

    def now(self, body: Body) -> Number:
        """The instant of a body's last contact: exact if the body is, else a short ball."""
        if self.live.exact[body.index]:
            return self.live.state(body.index)[0]
        ctx.prec = QUICK_BITS
        return +body.instant

    def entry_time(self, link: Link) -> Number:
        """The time of an entry as a short ball."""
        time = self._time(Moment(link))
        with ball.precision(QUICK_BITS):
            return +time

    def reversal_time(self) -> Number:
        """The time of the reversal: exact if it is at hand exactly, else a ball."""
        machine = self.live.field
        if machine is not None and all(self.live.exact):
            return machine.flip_time
        return self.live.flip_time

    def exact_state(self, bodies: Sequence[int]) -> Hashable | None:
        """The bodies' numbers as text, where all are exact."""
        if not self.live.all_exact(tuple(bodies)):
            return None
        return tuple(str(field_text(number)) for i in bodies for number in self.live.state(i))

    def rough(self, time: Number) -> float:
        """The double below a time."""
        return ball.double_bounds(time if isinstance(time, arb) else field_ball(time, QUICK_BITS))[0]

    def limit_bounds(self, time: Quantity | None) -> tuple[float, float]:
        """Doubles that enclose a set time (None: the return)."""
        ctx.prec = self.live.bits
        if time is None:
            return ball.double_bounds(self.live.flip_time + self.live.flip_time)
        return ball.double_bounds(ball.constant(time))

    def note(self) -> str:
        """The precision at work."""
        return f"{self.live.bits} bits"

    def name(self, link: Link) -> str:
        """A contact as a person reads it."""
        ids = self.scene.ids
        other = ids[link[1]] if link[1] >= 0 else f"pocket {self.scene.pockets[-1 - link[1]].id}"
        return f"{ids[link[0]]} and {other}"

    # -- precision

    def _foreseen_bits(self) -> int:
        """The bits that the whole run will need if it goes on losing them as it has."""
        done = len(self.history.records)
        wholes: list[float] = []
        if self.limits.events is not None:
            wholes.append(self.limits.events)
        if self.limits.until is not None and done:
            reached = self.rough(self.history.records[-1].mark.time)
            if reached > 0.0:
                wholes.append(done * float(self.limits.until) / reached)
        if not wholes or not done:
            return 0
        lost = self.live.bits - self.live.lowest
        return int(min(min(wholes) / done * lost * FORESIGHT + 2 * SAFE_BITS, MOST_FORESIGHT * self.live.bits))

    def _rise(self, why: str, foreseen: int = 0) -> None:
        bits = max(2 * self.live.bits, min(foreseen, self.max_bits))
        if bits > self.max_bits:
            raise Undecided(
                f"{why} at {self.live.bits} bits, and max_bits is {self.max_bits}; "
                f"{self._where()}; allow more bits to go on"
            )
        self.plan["precision raised"] += 1
        self.live.rise(bits)

    def _where(self) -> str:
        return f"after {len(self.history.records)} instants"

    # -- the rungs

    def ask(self, question: Question) -> int:
        """The sign of a question.

        Raises:
            Undecided: naming the question, what was tried and the bits.
        """
        sign = self.ask_cheaply(question)
        self._instant_work += ASK_UNITS
        return self._prove(question) if sign is None else sign

    def ask_cheaply(self, question: Question) -> int | None:
        """The sign if balls or the field tell it, else None."""
        self._proof = (TieProof.CONSTRUCTION, None)
        sign = self._ball_sign(question)
        if sign is not None:
            self.plan["full ball"] += 1
        else:
            sign = self._field_sign(question)
            if sign is not None:
                self.plan["field"] += 1
        if sign == 0 and self.live.all_exact(question.bodies(self.n)):
            self._proof = (self._kind_of_field(question), None)
        return sign

    def _ball_sign(self, question: Question) -> int | None:
        bodies = question.bodies(self.n)
        ctx.prec = self.live.bits
        self.live.sync(bodies)
        try:
            return ball.sign_of(question.value(self.live.balls))
        except ZeroDivisionError:
            return None

    def _field_sign(self, question: Question) -> int | None:
        """The sign in the scene's field, where all bodies concerned are exact."""
        if not self.live.all_exact(question.bodies(self.n)):
            return None
        machine = self.live.field
        assert machine is not None
        try:
            parts = question.root_sum(machine)
        except LeavesField:
            return None
        if parts[2] == 0 and parts[4] == 0:
            return field_sign(parts[0])
        return sign_of_root_sum(*(self.live.numbers.element(part) for part in parts))

    def _prove(self, question: Question) -> int:
        """The sign of a question that balls at hand cannot tell from zero: proofs of zero, and more bits, in turns."""
        self.catch_up()
        sign = self.retrace.sign(question)
        if sign is not None:
            return self._taken(question, sign, TieProof.WAY_BACK)
        if self.log.proves_zero(question):
            return self._taken(question, 0, TieProof.SYMMETRY)
        work = Work(self.work)
        share, told = FIRST_SHARE, ""
        while True:
            rising = self._rise_units(2 * self.live.bits)
            agreed = self.rule.assumes and self._agreed_bits(question) >= self.rule.least
            last = agreed or 2 * self.live.bits > self.max_bits or work.spent + rising > self.work
            if last or self.live.bits >= TRY_BITS:
                left = self.work - work.spent
                attempt = Work(left if last else min(share, left // 2))
                sign, told = self.roots.sign(question, self.history.steps, attempt)
                work.spent += attempt.spent
                self._instant_work += attempt.spent
                if sign is not None:
                    return self._taken(question, sign, TieProof.TOWER)
                share *= SHARE_GROWTH
            if last:
                break
            work.spent += rising
            self._rise("undecided")
            sign = self.ask_cheaply(question)
            if sign is not None:
                return sign
        if agreed:
            return self._taken(question, 0, TieProof.ASSUMED, self.rule.bits)
        raise Undecided(self._undecided_message(question, told, work))

    def _rise_units(self, bits: int) -> int:
        """The work of computing the whole log again in balls of so many bits."""
        words = bits >> 6
        return len(self.history.steps) * (STEP_UNITS + words * words.bit_length())

    def _taken(self, question: Question, sign: int, proof: TieProof, bound: int | None = None) -> int:
        """A sign decided beyond balls; what is less than proof is kept as an assumption."""
        self._proof = (proof, bound)
        self.plan[proof.name.lower().replace("_", " ")] += 1
        if not proof.proved:
            event = len(self.history.records)
            self.assumptions.append(Assumption(event, question.describe(self.name), proof, bound))
        return sign

    def _agreed_bits(self, question: Question) -> int:
        """To how many bits, in absolute value, the number asked about agrees with zero."""
        ctx.prec = self.live.bits
        self.live.sync(question.bodies(self.n))
        size = question.value(self.live.balls).abs_upper()
        return 0 if not size.is_finite() else max(0, -int(size.log().__truediv__(arb(2).log()).upper().ceil().fmpz()))

    def _undecided_message(self, question: Question, tried: str, work: Work) -> str:
        return (
            f"{question.describe(self.name)} is not proved, {self._where()}, with {self.live.bits} bits"
            + (f"; {tried}" if tried else "")
            + f"; {work.spent} units of work of {self.work} (--work)"
        )

    def _kind_of_field(self, question: Question) -> TieProof:
        numbers = [number for i in question.bodies(self.n) for number in self.live.state(i)]
        rational = all(isinstance(number, fmpq) for number in numbers)
        return TieProof.RATIONAL if rational else TieProof.FIELD

    def tie(self, links: tuple[Link, ...]) -> Tie:
        """The tie that the last question found, and how it is known."""
        contacts = tuple(Contact(self.scene.ids[i], self.scene.ids[j]) for i, j in links)
        return Tie(contacts, *self._proof)

    # -- meetings

    def order(self, first: Arrival, second: Arrival) -> int:
        """Whether the one comes before, with or after the other."""
        return self.ask(Sooner(Moment(first.link, first.graze), Moment(second.link, second.graze)))

    def timed(self, arrival: Arrival) -> Arrival:
        """The arrival with its time in full precision."""
        if arrival.time is LATER:
            return arrival._replace(time=self._time(Moment(arrival.link)))
        return arrival

    def certainly_before(self, first: Arrival, second: Arrival) -> bool:
        """Whether the balls of their times tell."""
        return bool(first.time < second.time)

    def settled(self, arrival: Arrival) -> Arrival | None:
        """The arrival if it comes.

        Raises:
            Undecided: where that is not to be had.
        """
        link = arrival.link
        self.plan["doubtful settled"] += 1
        if self.ask(Approach(link)) >= 0:
            return None
        disc = self.ask(Discriminant(link)) if link[1] < self.n else 1
        if disc < 0:
            return None
        time = self._meeting(link, disc)
        low, high = ball.double_bounds(time)
        return arrival._replace(low=low, high=high, time=time, graze=disc == 0)

    def _meeting(self, link: Link, disc: int) -> arb:
        """The time of a hit or, where the discriminant is zero, of a graze, which is noted."""
        if disc == 0:
            self.catch_up()
            self.retrace.grazes(link)
        return self._time(Moment(link, disc == 0))

    def _time(self, moment: Moment) -> arb:
        """The time of a meeting that is certain, as a ball of full precision that excludes the past."""
        while True:
            ctx.prec = self.live.bits
            self.live.sync(tuple(i for i in moment.link if i < self.n))
            try:
                t, wait = moment.wait(self.live.balls)
                if t + wait > self._begun(moment.link):
                    return t + wait
            except ZeroDivisionError:
                pass
            self._rise(f"the time of {self.name(moment.link)} is unsharp")

    def _begun(self, link: Link) -> arb:
        """The instant from which on the flights of two hold."""
        machine = self.live.balls
        return (machine.later(*link) if link[1] < self.n else machine.bodies[link[0]]).instant

    def _unsure(self, link: Link) -> None:
        """A prediction that short balls could not decide: full balls, and proofs where they leave it open.

        A gap of zero does not occur here: what stands at gap zero at an instant was gathered for it.
        """
        self.plan["full predictions"] += 1
        ctx.prec = self.live.bits
        approach = self._ball_sign(Approach(link))
        if approach is not None and approach >= 0:
            return
        gap = self._ball_sign(Gap(link))
        if not gap:  # unknown; or zero, as at a rim on which a centre stands still
            approach = self.ask(Approach(link)) if approach is None else approach
            if approach >= 0:
                return
            gap = self.ask(Gap(link))
        if gap <= 0:
            if link[1] < 0 and gap < 0:
                return
            raise AssertionError(f"{self.name(link)} overlap, or touch unseen, {self._where()}: a defect")
        disc = self._ball_sign(Discriminant(link)) if link[1] < self.n else 1
        if disc is not None and disc < 0:
            return
        ctx.prec = self.live.bits
        if approach is None or disc is None:
            self.predictor.push_doubtful(link)
        else:
            self.predictor.push(self._meeting(link, disc), link, disc == 0)
