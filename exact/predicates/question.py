"""A question that a run asks of its numbers, the sign of something that any number system can compute; its answer.

A question is posed once and can be put to several number systems: to the balls at hand, to balls of more bits, to
nested square roots. `value` may take square roots, so it suits enclosures; `sum_of_roots` adds none.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol, TypeAlias

from ...scenarios.trajectory import TieProof
from ..numbers.system import N
from ..replay.contact import Link
from ..replay.state import State

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

    def value(self, state: State[N]) -> N:
        """The number."""
        ...

    def sum_of_roots(self, state: State[N]) -> RootSum[N]:
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

    def value(self, state: State[N]) -> N:
        """Each question has its own."""
        raise NotImplementedError

    def sum_of_roots(self, state: State[N]) -> RootSum[N]:
        """The number itself."""
        zero = state.zero
        return self.value(state), zero, zero, zero, zero


def circles_of(*links: Link) -> tuple[int, ...]:
    """The circles of some contacts, each once."""
    return tuple(dict.fromkeys(i for link in links for i in link.circles))
