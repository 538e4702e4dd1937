"""Questions about meetings: whether and when two touch, and whether they come nearer."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar, Generic, TypeVar

from ...scenarios.lazy import frozen
from ...scenarios.numbers.quantity import Quantity
from ..numbers.system import N
from ..replay.contact import AtWall, Entry, Link, Round
from ..replay.state import State
from .question import Form, Plain, RootFree, RootSum, circles_of

L = TypeVar("L", Link, Round, Entry)


@frozen
class OfOne(RootFree, Generic[L]):
    """A root-free question about one contact, in words with a place for it; its circles are those it depends on."""

    link: L
    words: ClassVar[str]

    @property
    def bodies(self) -> tuple[int, ...]:
        return self.link.circles

    def describe(self, name: Callable[[Link], str]) -> str:
        return self.words.format(name(self.link))


class Approach(OfOne[Link]):
    """Do the two of a contact come nearer (negative) or part (positive)?"""

    words = "whether {} come nearer or part"

    def value(self, state: State[N]) -> N:
        return self.link.approach(state)

    def is_zero_by(self, form: Form) -> bool:
        return form.alike(self.link)


class Closing(OfOne[Link]):
    """At the instant at hand, do the two of a contact come nearer (negative) or part (positive)?"""

    words = "whether {} come nearer or part as they touch"

    def value(self, state: State[N]) -> N:
        return self.link.closing(state)

    def is_zero_by(self, form: Form) -> bool:
        return form.alike(self.link)


class Gap(OfOne[Link]):
    """Are the two of a contact apart (positive) or touching (zero)?"""

    words = "whether {} touch"

    def value(self, state: State[N]) -> N:
        return self.link.gap(state)


class Discriminant(OfOne[Round]):
    """Do the paths of two circles hit (positive), graze (zero) or miss (negative)?"""

    words = "whether {} hit, graze or miss"

    def value(self, state: State[N]) -> N:
        return state.discriminant(self.link)


class RelativeSpeed(OfOne[Round]):
    """Is the velocity of one circle relative to the other exactly zero (zero) or not (positive)?"""

    words = "whether {} move together"

    def value(self, state: State[N]) -> N:
        pair = state.relation(self.link)
        return pair.vx * pair.vx + pair.vy * pair.vy

    def is_zero_by(self, form: Form) -> bool:
        return form.alike(self.link)


class Rim(OfOne[Entry]):
    """At the instant at hand, is a centre outside of a pocket (positive), on its rim (zero) or inside (negative)?"""

    words = "whether the centre of {} stands on the rim"

    def value(self, state: State[N]) -> N:
        return state.rim(self.link)


@frozen
class Moment:
    """When two touch next: by a hit, or by a graze, which touches without pushing."""

    link: Link
    graze: bool = False

    def wait(self, state: State[N]) -> tuple[N, N]:
        """The clock from which it is reckoned, and the time from that."""
        if self.graze and not isinstance(self.link, AtWall):
            return state.graze(self.link)
        return self.link.hit(state)

    def parts(self, state: State[N]) -> tuple[N, N, N]:
        """p, q, D with time p + q*sqrt(D)."""
        if self.graze:
            clock, wait = self.wait(state)
            return clock + wait, state.zero, state.zero
        return self.link.parts(state)


@frozen
class Sooner:
    """Does `first` come before (negative), with (zero) or after (positive) `second`?"""

    first: Moment
    second: Moment

    @property
    def bodies(self) -> tuple[int, ...]:
        return circles_of(self.first.link, self.second.link)

    def value(self, state: State[N]) -> N:
        t1, wait1 = self.first.wait(state)
        t2, wait2 = self.second.wait(state)
        if t1 is t2:
            return wait1 - wait2
        return (t1 - t2) + wait1 - wait2

    def sum_of_roots(self, state: State[N]) -> RootSum[N]:
        p1, q1, d1 = self.first.parts(state)
        p2, q2, d2 = self.second.parts(state)
        return p1 - p2, q1, d1, -q2, d2

    def is_zero_by(self, form: Form) -> bool:
        return self.first.graze == self.second.graze and form.together(self.first.link, self.second.link)

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether {name(self.first.link)} meet before, with or after {name(self.second.link)}"


@frozen
class BeforeTime(Plain):
    """Does a meeting come before (negative), at (zero) or after (positive) a given time?

    `time` None stands for the return: twice the moment at which the velocities were negated.
    """

    moment: Moment
    time: Quantity | None

    @property
    def bodies(self) -> tuple[int, ...]:
        return self.moment.link.circles

    def _limit(self, state: State[N]) -> N:
        if self.time is None:
            return state.flip_time + state.flip_time
        return state.constant(self.time)

    def value(self, state: State[N]) -> N:
        t, wait = self.moment.wait(state)
        return (t - self._limit(state)) + wait

    def sum_of_roots(self, state: State[N]) -> RootSum[N]:
        p, q, d = self.moment.parts(state)
        return p - self._limit(state), q, d, state.zero, state.zero

    def describe(self, name: Callable[[Link], str]) -> str:
        when = "the return" if self.time is None else f"time {self.time}"
        return f"whether {name(self.moment.link)} meet before, at or after {when}"
