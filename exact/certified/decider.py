"""The exact engine's decider: keeps the state, refined as needed, and puts every question to the cascade."""

from __future__ import annotations

from collections.abc import Iterable

from flint import arb

from ...scenarios.scene import Scene
from ...scenarios.trajectory import Assumption
from ..cascade.cascade import Cascade
from ..cascade.enclosures import InBalls
from ..cascade.grounds import Grounds
from ..numbers import ball
from ..numbers.field import Known
from ..numbers.undecided import BudgetSpent
from ..predicates.question import Decision, Question
from ..predicates.ties import TieRule
from ..replay.body import Body
from ..replay.contact import Entry, Link, name_of
from ..replay.refinable import Projection, RefinableState
from ..replay.steps import STEP_UNITS, Step, step_units
from ..simulation.arrivals.initial import touching_at_start
from ..simulation.arrivals.queue import ArrivalQueue
from ..simulation.history import History
from ..simulation.limits import Limits
from ..symmetry.held import Held
from ..symmetry.log_symmetry import LogSymmetry
from ..symmetry.past import Past
from ..symmetry.retrace import Retrace
from .meetings import CertifiedMeetings
from .precision import FIRST_BITS, Precision
from .reading import CertifiedReading
from .stride import Stride

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

    def __init__(self, scene: Scene, limits: Limits, max_bits: int, work: int, rule: TieRule) -> None:
        self.scene = scene
        self.state = RefinableState(scene, FIRST_BITS)
        self.history: History[Known] = History(steps=self.state.steps)
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
            scene, self.state, self.queue, plan, self._precision, InBalls(grounds), self, self._note_graze
        )
        self.reading = CertifiedReading(self.state, self.meetings)
        self.stride: Stride | None = None
        if work >= 2 * STEP_UNITS:
            self.stride = Stride(
                self.state, self.history, self.queue, self.meetings, self.reading, self._precision, self._count, self.do
            )
        self._held = Held(scene, log)
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
        self.retrace.gathered(self._instant, (link for link in links if not isinstance(link, Entry)))

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
        vars(self.meetings.predictor).clear()
        vars(self.meetings).clear()
        vars(self).clear()

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
