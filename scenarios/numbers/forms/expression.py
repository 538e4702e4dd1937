"""Expressions of rationals with + - * / and square roots: their form, told in text and in other number systems."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal, Protocol, Self, TypeAlias, TypeVar

from flint import fmpq

from ...checks.showing import shortened
from ...lazy.kept import kept

Op: TypeAlias = Literal["q", "+", "-", "*", "/", "sqrt"]


class Arithmetic(Protocol):
    """What the evaluation of an expression asks of a number system."""

    def __add__(self: N, other: N, /) -> N: ...
    def __sub__(self: N, other: N, /) -> N: ...
    def __mul__(self: N, other: N, /) -> N: ...
    def __truediv__(self: N, other: N, /) -> N: ...


N = TypeVar("N", bound=Arithmetic)


class Expression:
    """A rational, or an operation on expressions.

    Attributes:
        op: "q" for a rational.
        args: what the operation acts on.
        rational: its value, if it is a rational.
    """

    __slots__ = ("__dict__", "args", "op", "rational")

    def __init__(self, op: Op, args: tuple[Self, ...], rational: fmpq | None = None) -> None:
        self.op: Op = op
        self.args = args
        self.rational = rational

    @property
    def size(self) -> int:
        """How many numbers it holds."""
        return self._size

    @kept
    def _size(self) -> int:
        return sum(argument.size for argument in self.args) if self.args else 1

    @kept
    def radicands(self) -> frozenset[str]:
        """The distinct expressions under its roots, as text."""
        inner = frozenset[str]().union(*(argument.radicands for argument in self.args))
        return inner | {self.args[0].text()} if self.op == "sqrt" else inner

    def evaluated(self, number: Callable[[fmpq], N], root: Callable[[N], N]) -> N:
        """The same expression in another number system, from its rationals and its square root.

        >>> from ..quantity import Quantity
        >>> Quantity.of("sqrt(2) + 1/2").evaluated(lambda q: int(q.p) / int(q.q), lambda x: x**0.5)
        1.9142135623730951
        """
        if self.rational is not None:
            return number(self.rational)
        if self.op == "sqrt":
            return root(self.args[0].evaluated(number, root))
        left, right = (argument.evaluated(number, root) for argument in self.args)
        if self.op == "+":
            return left + right
        if self.op == "-":
            return left - right
        if self.op == "*":
            return left * right
        return left / right

    def text(self) -> str:
        """The expression as text that `parse` reads back to the same number."""
        if self.rational is not None:
            return str(self.rational)
        if self.op == "sqrt":
            return f"sqrt({self.args[0].text()})"
        left, right = (argument.text() for argument in self.args)
        if self.op == "+":
            loose = self.args[1].op in "+-" or right.startswith("-")
            return f"{left} + ({right})" if loose else f"{left} + {right}"
        if self.op == "-":
            return f"{left} - {self._wrapped(self.args[1], '+-', right)}"
        left = self._wrapped(self.args[0], "+-", left)
        return f"{left}{self.op}{self._wrapped(self.args[1], '+-*/', right)}"

    def brief(self) -> str:
        """The text, cut to what an error shows."""
        return shortened(self.text())

    @staticmethod
    def _wrapped(argument: Expression, weak: str, text: str) -> str:
        rational = argument.rational
        loose = argument.op in weak or (rational is not None and (rational < 0 or rational.q != 1))
        return f"({text})" if loose else text
