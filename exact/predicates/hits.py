"""Questions about meetings: whether and when two touch, and whether they come nearer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ...scenarios.numbers.quantity import Quantity
from ..numbers.system import Number
from ..replay.state import State
from ..replay.steps import Link
from .question import Form, Plain, RootSum, circles_of


@dataclass(frozen=True)
class _OfLink(Plain):
    """A root-free question about one contact."""

    link: Link

    def bodies(self, n: int) -> tuple[int, ...]:
        return circles_of(self.link, n)

    def root_sum(self, state: State) -> RootSum:
        zero = state.zero
        return self.value(state), zero, zero, zero, zero

    def value(self, state: State) -> Number:
        raise AssertionError("each question has its own value")


def _fly_alike(link: Link, form: Form, n: int) -> bool:
    """Whether the two of a contact fly abreast, or a circle along its wall; of a pocket nothing is known."""
    i, j = link
    return form.along(i, j - n) if j >= n else j >= 0 and form.abreast(i, j)


@dataclass(frozen=True)
class Approach(_OfLink):
    """Do the two of a contact come nearer (negative) or part (positive)?"""

    def value(self, state: State) -> Number:
        return state.approach(self.link)

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether {name(self.link)} come nearer or part"

    def is_zero_by(self, form: Form, n: int) -> bool:
        return _fly_alike(self.link, form, n)


@dataclass(frozen=True)
class Closing(_OfLink):
    """At the instant at hand, do the two of a contact come nearer (negative) or part (positive)?"""

    def value(self, state: State) -> Number:
        return state.closing(self.link)

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether {name(self.link)} come nearer or part as they touch"

    def is_zero_by(self, form: Form, n: int) -> bool:
        return _fly_alike(self.link, form, n)


@dataclass(frozen=True)
class Gap(_OfLink):
    """Are the two of a contact apart (positive) or touching (zero)?"""

    def value(self, state: State) -> Number:
        return state.gap(self.link)

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether {name(self.link)} touch"


@dataclass(frozen=True)
class Discriminant(_OfLink):
    """Do the paths of two circles hit (positive), graze (zero) or miss (negative)?"""

    def value(self, state: State) -> Number:
        return state.discriminant(self.link)

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether {name(self.link)} hit, graze or miss"


@dataclass(frozen=True)
class RelativeSpeed(_OfLink):
    """Is the velocity of one circle relative to the other exactly zero (zero) or not (positive)?"""

    def value(self, state: State) -> Number:
        pair = state.relation(*self.link)
        return pair.vx * pair.vx + pair.vy * pair.vy

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether {name(self.link)} move together"

    def is_zero_by(self, form: Form, n: int) -> bool:
        return form.abreast(*self.link)


@dataclass(frozen=True)
class Rim(_OfLink):
    """At the instant at hand, is a centre outside of a pocket (positive), on its rim (zero) or inside (negative)?"""

    def value(self, state: State) -> Number:
        return state.rim(self.link)

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether the centre of {name(self.link)} stands on the rim"


@dataclass(frozen=True)
class Moment:
    """When two touch next: by a hit, or by a graze, which touches without pushing."""

    link: Link
    graze: bool = False

    def wait(self, state: State) -> tuple[Number, Number]:
        """The clock from which it is reckoned, and the time from that."""
        return state.graze(self.link) if self.graze else state.hit(self.link)

    def parts(self, state: State) -> tuple[Number, Number, Number]:
        """p, q, D with time p + q*sqrt(D)."""
        if not self.graze:
            return state.hit_parts(self.link)
        clock, wait = state.graze(self.link)
        return clock + wait, state.zero, state.zero


@dataclass(frozen=True)
class Sooner:
    """Does `first` come before (negative), with (zero) or after (positive) `second`?"""

    first: Moment
    second: Moment

    def bodies(self, n: int) -> tuple[int, ...]:
        return tuple(dict.fromkeys(circles_of(self.first.link, n) + circles_of(self.second.link, n)))

    def value(self, state: State) -> Number:
        t1, wait1 = self.first.wait(state)
        t2, wait2 = self.second.wait(state)
        if t1 is t2:
            return wait1 - wait2
        return (t1 - t2) + wait1 - wait2

    def root_sum(self, state: State) -> RootSum:
        p1, q1, d1 = self.first.parts(state)
        p2, q2, d2 = self.second.parts(state)
        return p1 - p2, q1, d1, -q2, d2

    def is_zero_by(self, form: Form, n: int) -> bool:
        return self.first.graze == self.second.graze and form.together(self.first.link, self.second.link)

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether {name(self.first.link)} meet before, with or after {name(self.second.link)}"


@dataclass(frozen=True)
class BeforeTime(Plain):
    """Does a meeting come before (negative), at (zero) or after (positive) a given time?

    `time` None stands for the return: twice the moment at which the velocities were negated.
    """

    moment: Moment
    time: Quantity | None

    def bodies(self, n: int) -> tuple[int, ...]:
        return circles_of(self.moment.link, n)

    def _limit(self, state: State) -> Number:
        if self.time is None:
            return state.flip_time + state.flip_time
        return state.constant(self.time)

    def value(self, state: State) -> Number:
        t, wait = self.moment.wait(state)
        return (t - self._limit(state)) + wait

    def root_sum(self, state: State) -> RootSum:
        p, q, d = self.moment.parts(state)
        return p - self._limit(state), q, d, state.zero, state.zero

    def describe(self, name: Callable[[Link], str]) -> str:
        when = "the return" if self.time is None else f"time {self.time}"
        return f"whether {name(self.moment.link)} meet before, at or after {when}"
