"""Questions about impulses at one instant: which contacts push, and whether their order matters."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

from ...scenarios.lazy import frozen
from ..numbers.linear import solve_positive
from ..numbers.system import N
from ..replay.contact import Link, Touch
from ..replay.state import State
from .question import RootFree, circles_of


@frozen
class Strength(RootFree):
    """In a set of contacts kicked together, how strong is one impulse?"""

    basis: tuple[Touch, ...]
    link: Touch
    words: ClassVar[str] = "whether {} push each other at all"

    @property
    def bodies(self) -> tuple[int, ...]:
        return circles_of(*self.basis, self.link)

    def _strengths(self, state: State[N]) -> list[N]:
        matrix, speeds = state.contact_system(self.basis)
        return solve_positive(matrix, [-(u + u) for u in speeds])

    def value(self, state: State[N]) -> N:
        return self._strengths(state)[self.basis.index(self.link)]

    def describe(self, name: Callable[[Link], str]) -> str:
        return self.words.format(name(self.link))


class Slack(Strength):
    """Kicking `basis` together, by how much more than needed does a contact outside of it separate?"""

    words = "whether {} separate fast enough"

    def value(self, state: State[N]) -> N:
        matrix, speeds = state.contact_system((*self.basis, self.link))
        inner = [row[:-1] for row in matrix[:-1]]
        strengths = solve_positive(inner, [-(u + u) for u in speeds[:-1]])
        slack = speeds[-1] + speeds[-1]
        for entry, strength in zip(matrix[-1][:-1], strengths, strict=True):
            slack = slack + entry * strength
        return slack


class Pivot(Strength):
    """Is a contact's push independent of those in `basis` (positive) or already made of them (zero)?"""

    words = "whether the contact of {} depends on its neighbours"

    def value(self, state: State[N]) -> N:
        matrix, _ = state.contact_system((*self.basis, self.link))
        inner = [row[:-1] for row in matrix[:-1]]
        column = matrix[-1][:-1]
        pivot = matrix[-1][-1]
        for entry, part in zip(column, solve_positive(inner, column), strict=True):
            pivot = pivot - entry * part
        return pivot


@frozen
class Share(Strength):
    """How much of `entering`'s push is made of `link`'s, among the contacts of `basis`?"""

    entering: Touch

    def value(self, state: State[N]) -> N:
        matrix, _ = state.contact_system((*self.basis, self.entering))
        inner = [row[:-1] for row in matrix[:-1]]
        return solve_positive(inner, matrix[-1][:-1])[self.basis.index(self.link)]

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"how the contacts of {name(self.entering)} and {name(self.link)} depend on each other"


@frozen
class Coupling(RootFree):
    """Can the order of two contacts matter? Zero where their pushes on shared bodies are at right angles."""

    first: Touch
    second: Touch

    @property
    def bodies(self) -> tuple[int, ...]:
        return circles_of(self.first, self.second)

    def value(self, state: State[N]) -> N:
        return state.contact_system((self.first, self.second))[0][0][1]

    def describe(self, name: Callable[[Link], str]) -> str:
        return f"whether the order of {name(self.first)} and {name(self.second)} matters"
