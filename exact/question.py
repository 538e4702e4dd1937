"""The questions that a run asks of its numbers, each the sign of something that any number system can compute."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar, Generic, NamedTuple, Protocol, TypeAlias, TypeVar

from ..scenarios.numbers.quantity import Quantity
from ..scenarios.trajectory import TieProof
from .laws.formulas import arc_range, face_along, fall_speed, sag, speed_change
from .numbers.ball import bits_in_use
from .numbers.system import N, solve_positive
from .replay.contact import AtArc, AtWall, Entry, Link, Round, Touch, is_flat
from .replay.landings import arc_chord, within_arc
from .replay.state import ReplayState

# -- A question that a run asks of its numbers, the sign of something that any number system can compute; its answer.
#
# A question is posed once and can be put to several number systems: to the balls at hand, to balls of more bits, to
# nested square roots. `value` may take square roots, so it suits enclosures; `sum_of_roots` adds none.

RootSum: TypeAlias = tuple[N, N, N, N, N]
"""A, B, D1, C, D2 of a number A + B*sqrt(D1) + C*sqrt(D2)."""


class Decision(NamedTuple):
    """The answer to a question.

    Attributes:
        sign: negative, zero or positive.
        rung: what decided it, as the plan counts it.
        proof: how a sign of zero is known.
        bound: for an assumption, the bits of agreement.
    """

    sign: int
    rung: str
    proof: TieProof = TieProof.CONSTRUCTION
    bound: int | None = None


class Form(Protocol):
    """What the form of a run's past proves, by an isometry that maps one part of it to another."""

    def together(self, first: Link, second: Link) -> bool:
        """Whether some isometry maps one meeting and its past to the other: they fall on one instant."""
        ...

    def same(self, first: Link, second: Link) -> bool:
        """Whether two contacts are one: of a circle with walls along one line, or pockets at one place."""
        ...

    def alike(self, link: Link) -> bool:
        """Whether the two of a contact fly alike.

        A circle flies along a wall if a mirror parallel to it keeps the circle and its past; two circles have one
        velocity if a shift maps the one and its past to the other. Of a pocket nothing is known.
        """
        ...


class Question(Protocol):
    """The sign of a number that depends on the state of some bodies."""

    @property
    def bodies(self) -> tuple[int, ...]:
        """The circles whose states the number depends on."""
        ...

    def value(self, state: ReplayState[N]) -> N:
        """The number."""
        ...

    def sum_of_roots(self, state: ReplayState[N]) -> RootSum[N]:
        """The number as A + B*sqrt(D1) + C*sqrt(D2), with parts that need no new root."""
        ...

    def is_zero_by(self, form: Form) -> bool:
        """Whether the form of the past makes the number zero; False says nothing."""
        ...

    def describe(self, name: Callable[[Link], str]) -> str:
        """The question as a person reads it."""
        ...


class Plain:
    """What the form of the past never makes zero."""

    def is_zero_by(self, form: Form) -> bool:
        """False: says nothing."""
        return False


class RootFree(Plain):
    """A question whose number needs no root."""

    def value(self, state: ReplayState[N]) -> N:
        """Each question has its own."""
        raise NotImplementedError

    def sum_of_roots(self, state: ReplayState[N]) -> RootSum[N]:
        """The number itself."""
        zero = state.zero
        return self.value(state), zero, zero, zero, zero


def circles_of(*links: Link) -> tuple[int, ...]:
    """The circles of some contacts, each once."""
    return tuple(dict.fromkeys(i for link in links for i in link.circles))


# -- Questions about meetings: whether and when two touch, and whether they come nearer.

L = TypeVar("L", Link, Round, Entry, AtWall, AtArc)


class OfOne(RootFree, Generic[L]):
    """A root-free question about one contact, in words with a place for it; its circles are those it depends on."""

    words: ClassVar[str]

    def __init__(self, link: L) -> None:
        self.link = link

    @property
    def bodies(self) -> tuple[int, ...]:
        return self.link.circles

    def describe(self, name: Callable[[Link], str]) -> str:
        return self.words.format(name(self.link))


class Approach(OfOne[Link]):
    """Do the two of a contact come nearer (negative) or part (positive)?"""

    words = "whether {} come nearer or part"

    def value(self, state: ReplayState[N]) -> N:
        return self.link.approach(state)

    def is_zero_by(self, form: Form) -> bool:
        return form.alike(self.link)


class Closing(OfOne[Link]):
    """At the instant at hand, do the two of a contact come nearer (negative) or part (positive)?"""

    words = "whether {} come nearer or part as they touch"

    def value(self, state: ReplayState[N]) -> N:
        return self.link.closing(state)

    def is_zero_by(self, form: Form) -> bool:
        return form.alike(self.link)


class Slide(OfOne[AtWall]):
    """Does a circle move along a wall across gravity, towards its end (positive) or its start (negative)?"""

    words = "whether {} move along each other"

    def value(self, state: ReplayState[N]) -> N:
        flight, line = state.bodies[self.link.circle].flight, state.line(*self.link[:2])
        return face_along(flight.vx, flight.vy, state.zero, state.zero, line.nx, line.ny)


class Gap(OfOne[Link]):
    """Are the two of a contact apart (positive) or touching (zero)?"""

    words = "whether {} touch"

    def value(self, state: ReplayState[N]) -> N:
        return self.link.gap(state)


class Foot(OfOne[AtWall]):
    """Does a circle meet the line of a face beyond its start (positive), at it (zero) or before it? `far`: its end."""

    words = "whether {} meet between its ends"

    def __init__(self, link: AtWall, far: bool = False) -> None:
        super().__init__(link)
        self.far = far

    def value(self, state: ReplayState[N]) -> N:
        return state.face_foot(self.link, self.far)


class Beside(Plain):
    """Is a circle at the line of a face, at the time of a meeting, beyond its start (positive)? `far`: its end.

    Of one that slides along that line; under gravity also of one that comes to it, at that very time. Without a
    meeting: at the instant at hand, at which it stands.
    """

    def __init__(self, link: AtWall, far: bool, moment: Moment | None) -> None:
        self.link, self.far, self.moment = link, far, moment

    @property
    def bodies(self) -> tuple[int, ...]:
        return self.link.circles if self.moment is None else circles_of(self.link, self.moment.link)

    def value(self, state: ReplayState[N]) -> N:
        along, slide, bend, clock = state.face_place(self.link, self.far)
        if self.moment is None:
            lag = state.bodies[self.link.circle].flight.late
            if lag is None:
                return along
        else:
            t, wait = self.moment.wait(state)
            lag = wait if t is clock else (t - clock) + wait
        return along + slide * lag if bend is None else sag(along, slide, bend, lag)

    def sum_of_roots(self, state: ReplayState[N]) -> RootSum[N]:
        if self.moment is None:
            return self.value(state), state.zero, state.zero, state.zero, state.zero
        along, slide, bend, clock = state.face_place(self.link, self.far)
        p, q, d = self.moment.parts(state)
        lag = p - clock
        if bend is None:
            return along + slide * lag, slide * q, d, state.zero, state.zero
        fixed = sag(along, slide, bend, lag) + bend * (q * q * d)
        return fixed, fall_speed(slide, bend, lag) * q, d, state.zero, state.zero

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether {name(self.link)} are between its ends"


class Within(Plain):
    """Does a circle meet the circle of an arc within the arc (positive), at its end (zero) or beyond it?

    `graze`: where it is nearest to it.
    """

    def __init__(self, link: AtArc, graze: bool = False) -> None:
        self.link, self.graze = link, graze

    @property
    def bodies(self) -> tuple[int, ...]:
        return self.link.circles

    def value(self, state: ReplayState[N]) -> N:
        return within_arc(state, self.link, *state.arc_span(self.link, self.graze))

    def sum_of_roots(self, state: ReplayState[N]) -> RootSum[N]:
        zero = state.zero
        if self.graze or state.scene.arc_sides[self.link.arc].full:
            return self.value(state), zero, zero, zero, zero
        t, dx, dy, vx, vy, _ = state.relation(self.link)
        p, q, disc = self.link.parts(state)
        wait = p - t
        nx, ny, _ = arc_chord(state, self.link)
        fixed = within_arc(state, self.link, dx + vx * wait, dy + vy * wait)
        return fixed, -(nx * vx + ny * vy) * q, disc, zero, zero

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether {name(self.link)} meet between its ends"


class Onward(OfOne[AtArc]):
    """Does a circle at the end of an arc go on into its range (positive), or out of it?"""

    words = "whether {} comes into or leaves its range"

    def value(self, state: ReplayState[N]) -> N:
        pair, (nx, ny, _) = state.relation(self.link), arc_chord(state, self.link)
        return arc_range(pair.vx, pair.vy, nx, ny, state.zero)


class Discriminant(OfOne[Round]):
    """Do the paths of two circles hit (positive), graze (zero) or miss (negative)?"""

    words = "whether {} hit, graze or miss"

    def value(self, state: ReplayState[N]) -> N:
        return state.discriminant(self.link)


class FallsStraight(OfOne[Round]):
    """Is the velocity of a circle, seen from what is round and stands, along gravity (zero)?"""

    words = "whether {} pass along gravity"

    def value(self, state: ReplayState[N]) -> N:
        fall = state.peg_fall(self.link)
        return fall.vx * fall.hy - fall.vy * fall.hx


class Abreast(OfOne[Round]):
    """Across gravity, is a circle as far from what is round and stands as they are at a contact (zero), or farther?"""

    words = "whether {} touch as one passes the other along gravity"

    def value(self, state: ReplayState[N]) -> N:
        fall = state.peg_fall(self.link)
        across = fall.dx * fall.hy - fall.dy * fall.hx
        return across * across - fall.reach * fall.reach * (fall.hx * fall.hx + fall.hy * fall.hy)


class Bend(OfOne[Round]):
    """Of what falls and what is round and stands, at gap zero: which sign has its gap's coefficient of s**order?

    Positive where, all before it being zero, the two part; negative where one presses on the other.
    """

    words = "whether {} part as they bend away from each other"

    def __init__(self, link: Round, order: int) -> None:
        super().__init__(link)
        self._order = order

    def value(self, state: ReplayState[N]) -> N:
        found = state.peg_fall(self.link).polynomial(self._order)[0]
        return -found if self.link.hollow else found


class Leans(OfOne[Round]):
    """Of what stands still on something round: is that not straight below it (positive), or is it (zero)?"""

    words = "whether one of {} is straight above the other"

    def value(self, state: ReplayState[N]) -> N:
        fall = state.peg_fall(self.link)
        aside = fall.dx * fall.hy - fall.dy * fall.hx
        return aside * aside + fall.vx * fall.vx + fall.vy * fall.vy


class Arrives(OfOne[AtWall]):
    """Does a circle that gravity pulls away from a wall hit (positive), graze (zero) or miss it (negative)?"""

    words = "whether {} hit, graze or miss"

    def value(self, state: ReplayState[N]) -> N:
        return state.wall_discriminant(self.link)


class RelativeSpeed(OfOne[Round]):
    """Is the velocity of one circle relative to the other exactly zero (zero) or not (positive)?"""

    words = "whether {} move together"

    def value(self, state: ReplayState[N]) -> N:
        pair = state.relation(self.link)
        return pair.vx * pair.vx + pair.vy * pair.vy

    def is_zero_by(self, form: Form) -> bool:
        return form.alike(self.link)


class Rim(OfOne[Entry]):
    """At the instant at hand, is a centre outside of a pocket (positive), on its rim (zero) or inside (negative)?"""

    words = "whether the centre of {} stands on the rim"

    def value(self, state: ReplayState[N]) -> N:
        return state.rim(self.link)


class Moment:
    """When two touch next: by a hit, or by a graze, which touches without pushing."""

    def __init__(self, link: Link, graze: bool = False) -> None:
        self.link, self.graze = link, graze

    def wait(self, state: ReplayState[N]) -> tuple[N, N]:
        """The clock from which it is reckoned, and the time from that."""
        if self.graze and not is_flat(self.link):
            return state.graze(self.link)
        if self.graze and is_flat(self.link):
            return state.wall_graze(self.link)
        return self.link.hit(state)

    def parts(self, state: ReplayState[N]) -> tuple[N, N, N]:
        """p, q, D with time p + q*sqrt(D)."""
        if self.graze:
            clock, wait = self.wait(state)
            return clock + wait, state.zero, state.zero
        return self.link.parts(state)


class Sooner:
    """Does `first` come before (negative), with (zero) or after (positive) `second`?"""

    def __init__(self, first: Moment, second: Moment) -> None:
        self.first, self.second = first, second

    @property
    def bodies(self) -> tuple[int, ...]:
        return circles_of(self.first.link, self.second.link)

    def value(self, state: ReplayState[N]) -> N:
        t1, wait1 = self.first.wait(state)
        t2, wait2 = self.second.wait(state)
        if t1 is t2:
            return wait1 - wait2
        return (t1 - t2) + wait1 - wait2

    def sum_of_roots(self, state: ReplayState[N]) -> RootSum[N]:
        p1, q1, d1 = self.first.parts(state)
        p2, q2, d2 = self.second.parts(state)
        return p1 - p2, q1, d1, -q2, d2

    def is_zero_by(self, form: Form) -> bool:
        return self.first.graze == self.second.graze and form.together(self.first.link, self.second.link)

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether {name(self.first.link)} meet before, with or after {name(self.second.link)}"


class BeforeTime(Plain):
    """Does a meeting come before (negative), at (zero) or after (positive) a given time?

    `time` None stands for the return: twice the moment at which the velocities were negated.
    """

    def __init__(self, moment: Moment, time: Quantity | None) -> None:
        self.moment, self.time = moment, time

    @property
    def bodies(self) -> tuple[int, ...]:
        return self.moment.link.circles

    def _limit(self, state: ReplayState[N]) -> N:
        if self.time is None:
            return state.flip_time + state.flip_time
        return state.constant(self.time)

    def value(self, state: ReplayState[N]) -> N:
        t, wait = self.moment.wait(state)
        return (t - self._limit(state)) + wait

    def sum_of_roots(self, state: ReplayState[N]) -> RootSum[N]:
        p, q, d = self.moment.parts(state)
        return p - self._limit(state), q, d, state.zero, state.zero

    def describe(self, name: Callable[[Link], str]) -> str:
        when = "the return" if self.time is None else f"time {self.time}"
        return f"whether {name(self.moment.link)} meet before, at or after {when}"


# -- Questions about impulses at one instant: which contacts push, and whether their order matters.


class Strengths:
    """The impulses of contacts kicked together: solved once for the questions about each, while no number changes."""

    def __init__(self, basis: tuple[Touch, ...]) -> None:
        self.basis, self.circles = basis, circles_of(*basis)
        self._of: tuple[Any, ...] = ()
        self._found: list[Any] = []

    def __call__(self, state: ReplayState[N]) -> list[N]:
        """Of a state, computed with the bits in use; again where it is another state, or has other numbers."""
        of = state, *(state.bodies[i].flight for i in self.circles)
        same = len(of) == len(self._of) - 1 and all(one is other for one, other in zip(of, self._of, strict=False))
        if not (same and self._of[-1] == bits_in_use()):
            matrix, speeds = state.contact_system(self.basis)
            self._found = solve_positive(matrix, [-speed_change(u) for u in speeds], state.zero)
            self._of = *of, bits_in_use()
        return self._found


class Strength(RootFree):
    """In a set of contacts kicked together, how strong is one impulse?"""

    words: ClassVar[str] = "whether {} push each other at all"

    def __init__(self, basis: tuple[Touch, ...], link: Touch, strengths: Strengths | None = None) -> None:
        self.basis, self.link, self.strengths = basis, link, strengths or Strengths(basis)

    @property
    def bodies(self) -> tuple[int, ...]:
        return circles_of(*self.basis, self.link)

    def value(self, state: ReplayState[N]) -> N:
        return self.strengths(state)[self.basis.index(self.link)]

    def describe(self, name: Callable[[Link], str]) -> str:
        return self.words.format(name(self.link))


class Slack(Strength):
    """Kicking `basis` together, by how much more than needed does a contact outside of it separate?"""

    words = "whether {} separate fast enough"

    def is_zero_by(self, form: Form) -> bool:
        return any(form.same(link, self.link) for link in self.basis)

    def value(self, state: ReplayState[N]) -> N:
        matrix, speeds = state.contact_system((*self.basis, self.link))
        inner = [row[:-1] for row in matrix[:-1]]
        strengths = solve_positive(inner, [-speed_change(u) for u in speeds[:-1]], state.zero)
        slack = speed_change(speeds[-1])
        for entry, strength in zip(matrix[-1][:-1], strengths, strict=True):
            slack = slack + entry * strength
        return slack


class Pivot(Strength):
    """Is a contact's push independent of those in `basis` (positive) or already made of them (zero)?"""

    words = "whether the contact of {} depends on its neighbours"

    def is_zero_by(self, form: Form) -> bool:
        return any(form.same(link, self.link) for link in self.basis)

    def value(self, state: ReplayState[N]) -> N:
        matrix, _ = state.contact_system((*self.basis, self.link))
        inner = [row[:-1] for row in matrix[:-1]]
        column = matrix[-1][:-1]
        pivot = matrix[-1][-1]
        for entry, part in zip(column, solve_positive(inner, column, state.zero), strict=True):
            pivot = pivot - entry * part
        return pivot


class Share(Strength):
    """How much of `entering`'s push is made of `link`'s, among the contacts of `basis`?"""

    def __init__(self, basis: tuple[Touch, ...], link: Touch, entering: Touch) -> None:
        super().__init__(basis, link)
        self.entering = entering

    def value(self, state: ReplayState[N]) -> N:
        matrix, _ = state.contact_system((*self.basis, self.entering))
        inner = [row[:-1] for row in matrix[:-1]]
        return solve_positive(inner, matrix[-1][:-1], state.zero)[self.basis.index(self.link)]

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"how the contacts of {name(self.entering)} and {name(self.link)} depend on each other"


class Coupling(RootFree):
    """Can the order of two contacts matter? Zero where their pushes on shared bodies are at right angles."""

    def __init__(self, first: Touch, second: Touch) -> None:
        self.first, self.second = first, second

    @property
    def bodies(self) -> tuple[int, ...]:
        return circles_of(self.first, self.second)

    def value(self, state: ReplayState[N]) -> N:
        return state.contact_system((self.first, self.second))[0][0][1]

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether the order of {name(self.first)} and {name(self.second)} matters"


# -- Two contacts of one instant that push each other in turns, where energy is lost at each: whether that has an end.
#
# The one approaches with speed p, the other parts with q, in the scale of their arms; G as in `State.contact_system`,
# with G_12 < 0. A push makes of that the speeds e p and -(1 + e) p |G_12| / G_11 + q. With r_n the speeds at which they
# are pushed in turn, each over the square root of its own entry of G, r_(n+1) = (1 + e) c r_n - e r_(n-1), where
# c^2 = G_12^2 / (G_11 G_22). All of them are positive, so that the pushes have no end, where both zeros of
# z^2 - (1 + e) c z + e are real, and r_(n+1) / r_n is once at least the smaller of them: such as half their sum.


class Endless(Coupling):
    """Can two contacts push each other without end (not negative)? (1 + e)^2 c^2 - 4 e, in the scale of G."""

    def value(self, state: ReplayState[N]) -> N:
        (one, row), _ = state.contact_system((self.first, self.second))
        share = state.one if state.share is None else state.share
        return share * share * one[1] * one[1] - (share + share - state.one) * one[0] * row[1]

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether {name(self.first)} and {name(self.second)} push each other without end"


class Falling(Endless):
    """Do they, once `first` approaches (not negative)? r_(n+1) / r_n less half the sum of the zeros, in its scale."""

    def value(self, state: ReplayState[N]) -> N:
        (one, _), (closing, parting) = state.contact_system((self.first, self.second))
        share = state.one if state.share is None else state.share
        return share * one[1] * closing - one[0] * parting
