"""The cascade: a question climbs from balls through the scene's field and proofs of zero to more bits."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Sequence
from importlib import import_module
from typing import Protocol

from flint import arb, fmpq, fmpq_poly

from ...scenarios.errors import SceneError
from ...scenarios.lazy import frozen
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.numbers.tower_element import sign_of_root_sum
from ...scenarios.numbers.tower_ring import TowerLimit
from ...scenarios.scene import Scene
from ...scenarios.trajectory import TieProof
from ...scenarios.work import Work
from ..log_symmetry import LogSymmetry, Retrace
from ..numbers import ball
from ..numbers.ball import Known, LeavesField, NestedNumbers, field_ball, field_sign, field_text
from ..numbers.system import Undecided
from ..question import BeforeTime, Decision, Moment, Question, Sooner
from ..replay.contact import Body, Entry, Link
from ..replay.landings import ExactMoment, exact_moment, order_exactly
from ..replay.refinable import RefinableState
from ..replay.round_falls import QUARTIC
from ..replay.state import ReplayState, Step, causal_past, replay, step_units
from ..simulation.endings import Rows
from ..simulation.policies import Accumulating
from .filtered import QUICK_BITS

# -- What is taken for a zero: proof alone, or the user's own word where proof fails.

MAX_ASSUMED = 1_000_000
"""Most bits that agreement may be asked to."""


@frozen
class TieRule:
    """What is taken for a zero once every proof has failed.

    Attributes:
        bits: agreement to so many bits; None: nothing.
    """

    bits: int | None = None

    @staticmethod
    def parse(text: str) -> TieRule:
        """The rule of a setting `proved` or `assume:BITS`.

        Raises:
            SceneError: for any other text.

        >>> TieRule.parse("assume:512")
        TieRule(bits=512)
        >>> TieRule.parse("probable")
        Traceback (most recent call last):
          ...
        truebreak.scenarios.errors.SceneError: ties = 'probable' is no longer known: evidence modulo random primes \
proved nothing that more bits do not; choose proved, or assume:BITS (such as assume:512) for your own word
        """
        if text == "proved":
            return TieRule()
        head, _, bits = text.partition("assume:")
        if head == "" and bits.isascii() and bits.isdigit() and 0 < int(bits[:7]) <= MAX_ASSUMED:
            return TieRule(int(bits))
        if text == "probable":
            raise SceneError(
                "ties = 'probable' is no longer known: evidence modulo random primes proved nothing that more bits "
                "do not; choose proved, or assume:BITS (such as assume:512) for your own word"
            )
        raise SceneError(f"ties = {text!r} is not known; choose proved or assume:BITS (such as assume:512)")


# -- What the rungs of the cascade decide from.


@frozen
class Grounds:
    """One run, as its rungs see it.

    Attributes:
        scene: what runs.
        state: its state, refinable.
        steps: its log.
        retrace: what the way back knows of the way out.
        log: what the form of the past proves.
        rule: what is taken for a zero that is not proved.
        max_bits: the precision beyond which an undecided sign stays so.
        work: what one question may cost before it is undecided.
        catch_up: brings what is known of the past up to the end of the log.
        rise: computes the state again with twice the bits; told why.
        spend: told of work done.
        where: how far the run is, as a person reads it.
        name: a contact as a person reads it.
    """

    scene: Scene
    state: RefinableState
    steps: Sequence[Step]
    retrace: Retrace
    log: LogSymmetry
    rule: TieRule
    max_bits: int
    work: int
    catch_up: Callable[[], None]
    rise: Callable[[str], None]
    spend: Callable[[int], None]
    where: Callable[[], str]
    name: Callable[[Link], str]


# -- The cascade: a question climbs from balls through the scene's field and proofs of zero to more bits, until one
# tells.
#
# Every question climbs only as far as it must. What a rung decides is certain; what none decides is Undecided.

Rung = Callable[[Question], Decision | None]
"""The decision of a question, or None where it is left to the next rung."""

RUNGS: tuple[str, ...] = (
    "cascade:InBalls",
    "cascade:InField",
    "cascade:ByWayBack",
    "cascade:ByForm",
    "cascade:InFractions",
    "cascade:RootsAndBits",
)
"""From the cheapest up, by module and class: each class makes a rung for one run. A new one is its file, and one line
here."""

QUICK = RUNGS.index("cascade:InField") + 1
"""How many of them cost next to nothing: those up to the field."""


def rung_maker(text: str) -> Callable[[Grounds], Rung]:
    """What makes a rung of the table for a run, imported now."""
    module, _, name = text.partition(":")
    return getattr(import_module(f".{module}", __package__), name)


class Cascade:
    """Decides the questions of one run.

    Args:
        grounds: what is known of the run.
        plan: counts, by rung, what was decided.
    """

    def __init__(self, grounds: Grounds, plan: Counter[str]) -> None:
        self._rungs = [rung_maker(text)(grounds) for text in RUNGS]
        self._plan = plan

    def decide(self, question: Question) -> Decision:
        """The sign of a question, and how it is known.

        Raises:
            Undecided: naming the question, what was tried and the bits.
        """
        decision = self._climb(question, self._rungs)
        assert decision is not None  # the last rung decides or raises
        return decision

    def decide_quickly(self, question: Question) -> Decision | None:
        """The sign if balls at hand or the field tell it, else None."""
        return self._climb(question, self._rungs[:QUICK])

    def _climb(self, question: Question, rungs: list[Rung]) -> Decision | None:
        for rung in rungs:
            decision = rung(question)
            if decision is not None:
                self._plan[decision.rung] += 1
                return decision
        return None


# -- The first rungs: signs from balls at hand, and in the field of the scene.


class InBalls:
    """Signs from the state in balls, at its precision."""

    def __init__(self, grounds: Grounds) -> None:
        self._state = grounds.state

    def __call__(self, question: Question) -> Decision | None:
        """The sign if the ball of the number tells it."""
        bodies = question.bodies
        sign = self.sign(question)
        if sign is None:
            return None
        if sign == 0 and self._state.all_exact(bodies):
            return Decision(0, "full ball", _kind(self._state, bodies))
        return Decision(sign, "full ball")

    def sign(self, question: Question) -> int | None:
        """As the rung, the sign alone."""
        ball.use_bits(self._state.bits)
        self._state.sync(question.bodies)
        try:
            return ball.sign_of(question.value(self._state.balls))
        except ZeroDivisionError:
            return None


class InField:
    """Signs in the scene's field, where all bodies concerned are exact."""

    def __init__(self, grounds: Grounds) -> None:
        self._state = grounds.state

    def __call__(self, question: Question) -> Decision | None:
        """The sign, but where the number leaves the field."""
        state, bodies = self._state, question.bodies
        if not state.all_exact(bodies):
            return None
        assert state.field is not None
        try:
            parts = question.sum_of_roots(state.field)
        except LeavesField:
            return None
        if parts[2] == 0 and parts[4] == 0:
            sign = field_sign(parts[0])
        else:
            sign = sign_of_root_sum(*(state.numbers.element(part) for part in parts))
        return Decision(sign, "field", _kind(state, bodies) if sign == 0 else TieProof.CONSTRUCTION)


class InFractions:
    """Which of two meetings is first, by the polynomials of which they are zeros, where these are of fractions.

    Under gravity, where square roots do not give the zeros of quartics: no zero of a question is guessed from bits, but
    the two polynomials have a common divisor with a zero between the bounds of both.
    """

    def __init__(self, grounds: Grounds) -> None:
        self._state = grounds.state

    def __call__(self, question: Question) -> Decision | None:
        """The sign, where both times are zeros of such polynomials, or one is and the other is a fraction."""
        field = self._state.field
        if field is None or not field.stands or not isinstance(question, (Sooner, BeforeTime)):
            return None
        sooner = isinstance(question, Sooner)
        moments = (question.first, question.second) if sooner else (question.moment,)
        if not all(self._is_exact(moment.link) for moment in moments):
            return None
        found = [known for moment in moments if (known := exact_moment(field, moment.link, moment.graze)) is not None]
        if not sooner and question.time is not None and (time := question.time.rational) is not None:
            found.append(ExactMoment(fmpq_poly([-time, 1]), time - 1, time + 1))
        if len(found) < 2:
            return None
        return Decision(order_exactly(*found), "field", TieProof.RATIONAL)

    def _is_exact(self, link: Link) -> bool:
        """Whether the circles of a contact are exact: one that is fixed is as it was."""
        return all(self._state.exact[i] for i in link.circles if i not in self._state.scene.pegs)


def _kind(state: RefinableState, bodies: tuple[int, ...]) -> TieProof:
    """In what numbers exact bodies stand."""
    rational = all(isinstance(number, fmpq) for i in bodies for number in state.flight(i)[:5])
    return TieProof.RATIONAL if rational else TieProof.FIELD


# -- Proofs that a number is zero, or which of two came first, from the form of the log: rungs of the cascade.


class ByWayBack:
    """What the way out of a reversed run tells of the way back."""

    def __init__(self, grounds: Grounds) -> None:
        self._retrace = grounds.retrace
        self._catch_up = grounds.catch_up

    def __call__(self, question: Question) -> Decision | None:
        """The sign, if the way out tells it."""
        self._catch_up()
        sign = self._retrace.sign(question)
        return None if sign is None else Decision(sign, "way back", TieProof.WAY_BACK)


class ByForm:
    """The form of the past: an isometry of logged histories."""

    def __init__(self, grounds: Grounds) -> None:
        self._log: LogSymmetry = grounds.log
        self._catch_up = grounds.catch_up

    def __call__(self, question: Question) -> Decision | None:
        """Zero, if an isometry makes it so."""
        self._catch_up()
        return Decision(0, "symmetry", TieProof.SYMMETRY) if self._log.proves_zero(question) else None


# -- Signs by replay of a causal past in nested square roots in normal form, within counted work.

MAX_DEPTH = 7
"""Levels of nested roots that a proof may build: on a chain of collisions of short numbers six take a tenth of a
second and seven half of one; longer numbers take more, so the work is bounded too."""


@frozen
class Hopeless:
    """A past that could not be replayed, and the work that did not suffice; None: no work does. And why not."""

    past: frozenset[int]
    work: int | None
    why: str


class NestedRoots:
    """Answers signs in nested square roots.

    Args:
        scene: the scene that runs.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._hopeless: list[Hopeless] = []

    def sign(self, question: Question, steps: Sequence[Step], work: Work) -> tuple[int | None, str]:
        """The sign of a question, or None and why it is not known.

        A past that holds one which was too deep is not tried, nor one that was too much work with no more than that.
        """
        work.spent += len(steps)  # the search for the past looks at each
        needed, bodies = causal_past(steps, question.bodies)
        past = frozenset(needed)
        allowed = 0 if work.limit is None else work.limit - work.spent
        for known in self._hopeless:
            if known.past <= past and (known.work is None or known.work >= allowed):
                return None, f"its past holds {known.why}"
        numbers = NestedNumbers(MAX_DEPTH, work)
        try:
            state = ReplayState(self.scene, numbers, only=bodies)
            replay(state, steps, needed)
            return sign_of_root_sum(*question.sum_of_roots(state)), ""
        except TowerLimit as limit:
            why = QUARTIC if str(limit) == QUARTIC else "one that was too deep for nested square roots"
            self._hopeless.append(Hopeless(past, allowed if work.is_spent else None, why))
            return None, f"nested square roots: {limit}"


# -- The last rung: nested square roots and more bits in turns, and in the end the user's own word.

TRY_BITS = 1024
"""Below this precision, more bits are cheaper than any attempt to prove a zero in nested roots."""

FIRST_SHARE = 100_000
"""Work that the first attempt in nested roots may take: a tenth of a second, about what shallow proofs need."""

SHARE_GROWTH = 4
"""By how much each further attempt may take more. Between two of them the bits are doubled, so that neither a number
that more bits tell from zero nor one that nested roots prove zero waits long for the other's attempts."""


class RootsAndBits:
    """Proofs of zero in nested roots, and more bits, in turns, within counted work."""

    def __init__(self, grounds: Grounds) -> None:
        self._grounds = grounds
        self._roots = NestedRoots(grounds.scene)
        self._quick = (InBalls(grounds), InField(grounds))

    def __call__(self, question: Question) -> Decision:
        """The sign.

        Raises:
            Undecided: naming the question, what was tried and the bits.
        """
        grounds, state, rule = self._grounds, self._grounds.state, self._grounds.rule
        work = Work(grounds.work)
        share, told = FIRST_SHARE, ""
        while True:
            rising = self._rise_units(2 * state.bits)
            agreed = rule.bits is not None and self._agreed_bits(question) >= rule.bits
            last = agreed or 2 * state.bits > grounds.max_bits or work.spent + rising > grounds.work
            if last or state.bits >= TRY_BITS:
                left = grounds.work - work.spent
                attempt = Work(left if last else min(share, left // 2))
                sign, told = self._roots.sign(question, grounds.steps, attempt)
                work.spent += attempt.spent
                grounds.spend(attempt.spent)
                if sign is not None:
                    return Decision(sign, "tower", TieProof.TOWER)
                share *= SHARE_GROWTH
            if last:
                break
            work.spent += rising
            grounds.rise("undecided")
            for rung in self._quick:
                decision = rung(question)
                if decision is not None:
                    return decision
        if agreed:
            return Decision(0, "assumed", TieProof.ASSUMED, rule.bits)
        raise Undecided(
            f"{question.describe(grounds.name)} is not proved, {grounds.where()}, with {state.bits} bits"
            + (f"; {told}" if told else "")
            + f"; {work.spent} units of work of {grounds.work} (--work)"
        )

    def _rise_units(self, bits: int) -> int:
        """The work of computing the whole log again in balls of so many bits."""
        return len(self._grounds.steps) * step_units(bits)

    def _agreed_bits(self, question: Question) -> int:
        """To how many bits, in absolute value, the number asked about agrees with zero."""
        state = self._grounds.state
        ball.use_bits(state.bits)
        state.sync(question.bodies)
        size = question.value(state.balls).abs_upper()
        return 0 if not size.is_finite() else max(0, -int(size.log().__truediv__(arb(2).log()).upper().ceil().fmpz()))


# -- What the history keeps of a certified run: exact numbers where they are at hand, else short balls.


class Timed(Protocol):
    """What tells the time of a meeting."""

    def time(self, moment: Moment) -> arb:
        """As a ball of full precision."""
        ...


def rough(time: Known) -> float:
    """The double below a time, a ball or exact."""
    return ball.double_bounds(time if isinstance(time, arb) else field_ball(time, QUICK_BITS))[0]


class CertifiedReading:
    """Reads a state off.

    Args:
        state: that state.
        meetings: knows the times of entries.
    """

    def __init__(self, state: RefinableState, meetings: Timed) -> None:
        self._state = state
        self._meetings = meetings

    def knot(self, body: Body[arb]) -> tuple[Known, Known, Known, Known, Known]:
        """The state: exact numbers if the body is exact, else short balls."""
        exact = self._state.exact[body.index]
        x, y, vx, vy, t = self._state.flight(body.index)[:5] if exact else body.q
        return t, x, y, vx, vy

    def now(self, body: Body[arb]) -> Known:
        """The instant of a body's last contact: exact if the body is, else a short ball."""
        if self._state.exact[body.index]:
            return self._state.flight(body.index).t
        ball.use_bits(QUICK_BITS)
        return +body.flight.instant

    def entry_time(self, link: Entry) -> arb:
        """The time of an entry as a short ball."""
        time = self._meetings.time(Moment(link))
        with ball.precision(QUICK_BITS):
            return +time

    def reversal_time(self) -> Known:
        """The time of the reversal: exact if it is at hand exactly, else a ball."""
        state = self._state.field
        if state is not None and all(self._state.exact):
            return state.flip_time
        return self._state.flip_time

    def exact_state(self, bodies: Sequence[int]) -> Hashable | None:
        """The bodies' numbers as text, where all are exact."""
        state = self._state.field
        if state is None or not self._state.all_exact(tuple(bodies)):
            return None
        return tuple(field_text(number) for i in bodies for number in state.bodies[i].flight[:5])

    def rough(self, time: Known) -> float:
        """The double below a time."""
        return rough(time)

    def limit_bounds(self, time: Quantity | None) -> tuple[float, float]:
        """Doubles that enclose a set time (None: the return)."""
        ball.use_bits(self._state.bits)
        if time is None:
            return ball.double_bounds(self._state.flip_time + self._state.flip_time)
        return ball.double_bounds(ball.constant(time))

    def fallen(self, circle: int) -> tuple[arb, Rows]:
        """In balls of full precision."""
        ball.use_bits(self._state.bits)
        self._state.sync(tuple(range(self._state.n)))
        balls = self._state.balls
        time = balls.bodies[circle].flight.instant
        return time, balls.true_rows(time)

    def bounces(self, end: Accumulating) -> arb:
        """In balls of full precision."""
        ball.use_bits(self._state.bits)
        self._state.sync(end.circles)
        return end.wait(self._state.balls)

    def note(self) -> str:
        """The precision at work."""
        return f"{self._state.bits} bits"
