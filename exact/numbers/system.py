"""What a system of numbers must do, the table of those that there are, and linear systems in any of them."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import Any, Protocol, Self, TypeVar

from ...scenarios.numbers.quantity import Quantity
from ..laws.formulas import N, Number

# -- The typed outcome of a comparison that a number system cannot answer.


class Undecided(Exception):
    """A sign that is not known. The message says which, at which event, to how many bits."""


class BudgetSpent(Exception):
    """A limit that the user set on effort was reached before an answer was."""


# -- What a system of numbers must do, and the table of those that there are.


class Ordered(Number, Protocol):
    """A number that can be compared; what is neither true nor false, as of two balls that overlap, is False."""

    def __lt__(self, other: Self, /) -> bool: ...
    def __gt__(self, other: Self, /) -> bool: ...
    def __ge__(self, other: Self, /) -> bool: ...


M = TypeVar("M", bound=Ordered)


class Arithmetic(Protocol[N]):
    """Where the numbers of a state come from: constants, and the one operation that + - * / leave out."""

    def constant(self, q: Quantity) -> N:
        """An exact number, or what the system has for it."""
        ...

    def root(self, value: N) -> N:
        """The square root of a number that is not negative."""
        ...


class NumberSystem(Arithmetic[N], Protocol[N]):
    """A system whose numbers can be decided on."""

    def sign(self, value: N) -> int:
        """-1, 0 or +1.

        Raises:
            Undecided: where the number does not tell.
        """
        ...

    def bounds(self, value: N) -> tuple[float, float]:
        """Doubles at or below, and at or above, the number; for a system without bounds, twice the nearest double."""
        ...


class HeldToZero(Protocol):
    """A number that is compared with 0, and has a nearest double."""

    def __gt__(self, other: int, /) -> object: ...
    def __lt__(self, other: int, /) -> object: ...
    def __float__(self) -> float: ...


class Nearest:
    """What systems share whose numbers are taken at their word: every sign is an answer, perhaps a wrong one.

    >>> Nearest().sign(-0.5), Nearest().bounds(0.5)
    (-1, (0.5, 0.5))
    """

    def sign(self, value: HeldToZero) -> int:
        """The sign of the number."""
        return bool(value > 0) - bool(value < 0)

    def bounds(self, value: HeldToZero) -> tuple[float, float]:
        """The nearest double, twice."""
        double = float(value)
        return double, double


SYSTEMS: dict[str, str] = {
    "ball": ".numbers.ball:BALLS",
    "field": ".numbers.ball:Field",
    "nested": ".numbers.ball:NestedNumbers",
    "expression": ".numbers.expression:EXPRESSIONS",
    "double": "..floating.double:DOUBLES",
    "single": "..floating.single:SINGLES",
    "quad": "..floating.quad:QUADS",
    "interval": "..floating.interval:INTERVALS",
    "rounded": "..floating.rounded:Rounding",
}
"""Where each system lives, seen from `exact`. A new one is its own file, and one line here."""

PACKAGE = __name__.rpartition(".numbers")[0]


def number_system(name: str) -> Any:
    """The system of that name, or, where one is made for each scene, its class; imported now.

    Raises:
        KeyError: for an unknown name.

    >>> system = number_system("double")
    >>> system.sign(system.root(system.constant(Quantity.of(2))))
    1
    """
    module, _, attribute = SYSTEMS[name].partition(":")
    return getattr(import_module(module, PACKAGE), attribute)


# -- Small linear systems in any numbers.


def solve_positive(matrix: Sequence[Sequence[N]], right: Sequence[N], nothing: N | None = None) -> list[N]:
    """Solves a symmetric positive definite system by elimination; its pivots need no choice.

    Args:
        nothing: the zero that stands, itself and no other like it, where the matrix has no entry: it is passed over.

    >>> from fractions import Fraction as Q
    >>> solve_positive([[Q(2), Q(1)], [Q(1), Q(2)]], [Q(3), Q(0)])
    [Fraction(2, 1), Fraction(-1, 1)]
    """
    rows = [[*row, value] for row, value in zip(matrix, right, strict=True)]
    size = len(rows)
    for k in range(size):
        entries = [column for column in range(k + 1, size + 1) if rows[k][column] is not nothing]
        for below in rows[k + 1 :]:
            if below[k] is nothing:
                continue
            factor = below[k] / rows[k][k]
            for column in entries:
                below[column] = below[column] - factor * rows[k][column]
    solution: list[N] = []  # from the last to the first
    for k in reversed(range(size)):
        value = rows[k][size]
        for column in range(k + 1, size):
            if rows[k][column] is not nothing:
                value = value - rows[k][column] * solution[size - 1 - column]
        solution.append(value / rows[k][k])
    return solution[::-1]


# -- Polynomials in any numbers.


def horner(c: Sequence[N], t: N) -> N:
    """The value of a polynomial."""
    found = c[-1]
    for k in range(len(c) - 2, -1, -1):
        found = found * t + c[k]
    return found


def horner_slope(c: Sequence[Any], t: Any) -> Any:
    """The value of its derivative."""
    last = len(c) - 1
    found = last * c[last]
    for k in range(last - 1, 0, -1):
        found = found * t + k * c[k]
    return found
