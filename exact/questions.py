"""The questions that a run asks of its numbers: each the sign of something that any machine can compute.

A question is posed once and can be put to several number systems: to the live balls, to balls of more bits, to
nested square roots. `value` may take square roots, so it suits enclosures; `exact_sign` adds none.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from ..scenarios.numbers.quantity import Quantity
from .machine import Link, Machine, Number, solve_positive

RootSum = tuple[Number, Number, Number, Number, Number]
"""A, B, D1, C, D2 of a number A + B*sqrt(D1) + C*sqrt(D2)."""


class Question(Protocol):
    """The sign of a number that depends on the state of some bodies."""

    def bodies(self, n: int) -> tuple[int, ...]:
        """The circles whose states the number depends on."""
        ...

    def value(self, machine: Machine) -> Number:
        """The number."""
        ...

    def root_sum(self, machine: Machine) -> RootSum:
        """The number as A + B*sqrt(D1) + C*sqrt(D2), with parts that need no new root."""
        ...

    def describe(self, name: Callable[[Link], str]) -> str:
        """The question as a person reads it."""
        ...


def _circles(link: Link, n: int) -> tuple[int, ...]:
    return link if 0 <= link[1] < n else link[:1]


@dataclass(frozen=True)
class _OfLink:
    """A root-free question about one contact."""

    link: Link

    def bodies(self, n: int) -> tuple[int, ...]:
        return _circles(self.link, n)

    def root_sum(self, machine: Machine) -> RootSum:
        zero = machine.zero
        return self.value(machine), zero, zero, zero, zero

    def value(self, machine: Machine) -> Number:
        raise AssertionError("each question has its own value")


@dataclass(frozen=True)
class Approach(_OfLink):
    """Do the two of a contact come nearer (negative) or part (positive)?"""

    def value(self, machine: Machine) -> Number:
        return machine.approach(self.link)

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether {name(self.link)} come nearer or part"


@dataclass(frozen=True)
class Closing(_OfLink):
    """At the instant at hand, do the two of a contact come nearer (negative) or part (positive)?"""

    def value(self, machine: Machine) -> Number:
        return machine.closing(self.link)

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether {name(self.link)} come nearer or part as they touch"


@dataclass(frozen=True)
class Gap(_OfLink):
    """Are the two of a contact apart (positive) or touching (zero)?"""

    def value(self, machine: Machine) -> Number:
        return machine.gap(self.link)

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether {name(self.link)} touch"


@dataclass(frozen=True)
class Discriminant(_OfLink):
    """Do the paths of two circles hit (positive), graze (zero) or miss (negative)?"""

    def value(self, machine: Machine) -> Number:
        return machine.discriminant(self.link)

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether {name(self.link)} hit, graze or miss"


@dataclass(frozen=True)
class RelativeSpeed(_OfLink):
    """Is the velocity of one circle relative to the other exactly zero (zero) or not (positive)?"""

    def value(self, machine: Machine) -> Number:
        state = machine.relation(*self.link)
        return state.vx * state.vx + state.vy * state.vy

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether {name(self.link)} move together"


@dataclass(frozen=True)
class Rim(_OfLink):
    """At the instant at hand, is a centre outside of a pocket (positive), on its rim (zero) or inside (negative)?"""

    def value(self, machine: Machine) -> Number:
        return machine.rim(self.link)

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether the centre of {name(self.link)} stands on the rim"


@dataclass(frozen=True)
class Moment:
    """When two touch next: by a hit, or by a graze, which touches without pushing."""

    link: Link
    graze: bool = False

    def wait(self, machine: Machine) -> tuple[Number, Number]:
        """The clock from which it is reckoned, and the time from that."""
        return machine.graze(self.link) if self.graze else machine.hit(self.link)

    def parts(self, machine: Machine) -> tuple[Number, Number, Number]:
        """p, q, D with time p + q*sqrt(D)."""
        if not self.graze:
            return machine.hit_parts(self.link)
        clock, wait = machine.graze(self.link)
        return clock + wait, machine.zero, machine.zero


@dataclass(frozen=True)
class Sooner:
    """Does `first` come before (negative), with (zero) or after (positive) `second`?"""

    first: Moment
    second: Moment

    def bodies(self, n: int) -> tuple[int, ...]:
        return tuple(dict.fromkeys(_circles(self.first.link, n) + _circles(self.second.link, n)))

    def value(self, machine: Machine) -> Number:
        t1, wait1 = self.first.wait(machine)
        t2, wait2 = self.second.wait(machine)
        if t1 is t2:
            return wait1 - wait2
        return (t1 - t2) + wait1 - wait2

    def root_sum(self, machine: Machine) -> RootSum:
        p1, q1, d1 = self.first.parts(machine)
        p2, q2, d2 = self.second.parts(machine)
        return p1 - p2, q1, d1, -q2, d2

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether {name(self.first.link)} meet before, with or after {name(self.second.link)}"


@dataclass(frozen=True)
class BeforeTime:
    """Does a meeting come before (negative), at (zero) or after (positive) a given time?

    `time` None stands for the return: twice the moment at which the velocities were negated.
    """

    moment: Moment
    time: Quantity | None

    def bodies(self, n: int) -> tuple[int, ...]:
        return _circles(self.moment.link, n)

    def _limit(self, machine: Machine) -> Number:
        if self.time is None:
            return machine.flip_time + machine.flip_time
        return machine.constant(self.time)

    def value(self, machine: Machine) -> Number:
        t, wait = self.moment.wait(machine)
        return (t - self._limit(machine)) + wait

    def root_sum(self, machine: Machine) -> RootSum:
        p, q, d = self.moment.parts(machine)
        return p - self._limit(machine), q, d, machine.zero, machine.zero

    def describe(self, name: Callable[[Link], str]) -> str:
        when = "the return" if self.time is None else f"time {self.time}"
        return f"whether {name(self.moment.link)} meet before, at or after {when}"


@dataclass(frozen=True)
class Strength:
    """In a set of contacts kicked together, how strong is one impulse?"""

    basis: tuple[Link, ...]
    link: Link

    def bodies(self, n: int) -> tuple[int, ...]:
        return tuple(dict.fromkeys(i for link in (*self.basis, self.link) for i in _circles(link, n)))

    def _strengths(self, machine: Machine) -> list[Number]:
        matrix, speeds = machine.contact_system(self.basis)
        return solve_positive(matrix, [-(u + u) for u in speeds])

    def value(self, machine: Machine) -> Number:
        return self._strengths(machine)[self.basis.index(self.link)]

    def root_sum(self, machine: Machine) -> RootSum:
        zero = machine.zero
        return self.value(machine), zero, zero, zero, zero

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether {name(self.link)} push each other at all"


@dataclass(frozen=True)
class Slack(Strength):
    """Kicking `basis` together, by how much more than needed does a contact outside of it separate?"""

    def value(self, machine: Machine) -> Number:
        matrix, speeds = machine.contact_system((*self.basis, self.link))
        inner = [row[:-1] for row in matrix[:-1]]
        strengths = solve_positive(inner, [-(u + u) for u in speeds[:-1]])
        slack = speeds[-1] + speeds[-1]
        for entry, strength in zip(matrix[-1][:-1], strengths, strict=True):
            slack = slack + entry * strength
        return slack

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether {name(self.link)} separate fast enough"


@dataclass(frozen=True)
class Pivot(Strength):
    """Is a contact's push independent of those in `basis` (positive) or already made of them (zero)?"""

    def value(self, machine: Machine) -> Number:
        matrix, _ = machine.contact_system((*self.basis, self.link))
        inner = [row[:-1] for row in matrix[:-1]]
        column = matrix[-1][:-1]
        pivot = matrix[-1][-1]
        for entry, part in zip(column, solve_positive(inner, column), strict=True):
            pivot = pivot - entry * part
        return pivot

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether the contact of {name(self.link)} depends on its neighbours"


@dataclass(frozen=True)
class Share(Strength):
    """How much of `entering`'s push is made of `link`'s, among the contacts of `basis`?"""

    entering: Link = (0, 0)

    def value(self, machine: Machine) -> Number:
        matrix, _ = machine.contact_system((*self.basis, self.entering))
        inner = [row[:-1] for row in matrix[:-1]]
        return solve_positive(inner, matrix[-1][:-1])[self.basis.index(self.link)]

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"how the contacts of {name(self.entering)} and {name(self.link)} depend on each other"


@dataclass(frozen=True)
class Coupling:
    """Can the order of two contacts matter? Zero where their pushes on shared bodies are at right angles."""

    first: Link
    second: Link

    def bodies(self, n: int) -> tuple[int, ...]:
        return tuple(dict.fromkeys(_circles(self.first, n) + _circles(self.second, n)))

    def value(self, machine: Machine) -> Number:
        return machine.contact_system((self.first, self.second))[0][0][1]

    def root_sum(self, machine: Machine) -> RootSum:
        zero = machine.zero
        return self.value(machine), zero, zero, zero, zero

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether the order of {name(self.first)} and {name(self.second)} matters"
