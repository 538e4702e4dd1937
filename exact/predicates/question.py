"""A question that a run asks of its numbers, the sign of something that any number system can compute; its answer.

A question is posed once and can be put to several number systems: to the balls at hand, to balls of more bits, to
nested square roots. `value` may take square roots, so it suits enclosures; `root_sum` adds none.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol

from ...scenarios.event import TieProof
from ..numbers.system import Number
from ..replay.state import State
from ..replay.steps import Link

RootSum = tuple[Number, Number, Number, Number, Number]
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

    def along(self, i: int, wall: int) -> bool:
        """Whether a mirror parallel to a wall keeps a circle and its past: it flies along the wall."""
        ...

    def abreast(self, i: int, j: int) -> bool:
        """Whether a shift maps one circle and its past to another: they have one velocity."""
        ...


class Question(Protocol):
    """The sign of a number that depends on the state of some bodies."""

    def bodies(self, n: int) -> tuple[int, ...]:
        """The circles whose states the number depends on."""
        ...

    def value(self, state: State) -> Number:
        """The number."""
        ...

    def root_sum(self, state: State) -> RootSum:
        """The number as A + B*sqrt(D1) + C*sqrt(D2), with parts that need no new root."""
        ...

    def is_zero_by(self, form: Form, n: int) -> bool:
        """Whether the form of the past makes the number zero, in a scene of n circles; False says nothing."""
        ...

    def describe(self, name: Callable[[Link], str]) -> str:
        """The question as a person reads it."""
        ...


class Plain:
    """What the form of the past never makes zero."""

    def is_zero_by(self, form: Form, n: int) -> bool:
        """False: says nothing."""
        return False


def circles_of(link: Link, n: int) -> tuple[int, ...]:
    """The circles of a contact."""
    return link if 0 <= link[1] < n else link[:1]
