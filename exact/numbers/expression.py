"""SymPy expressions, built as a run computes them and never simplified, so that building them is linear."""

from __future__ import annotations

from typing import Any

from sympy import Add, Mul, Pow, Rational, sympify  # pyright: ignore[reportMissingTypeStubs]

from ...scenarios.numbers.quantity import Quantity


class SymPyExpression:
    """A SymPy expression under construction."""

    __slots__ = ("expression",)

    def __init__(self, expression: Any) -> None:
        self.expression = expression

    def __add__(self, other: SymPyExpression) -> SymPyExpression:
        return SymPyExpression(Add(self.expression, other.expression, evaluate=False))

    def __sub__(self, other: SymPyExpression) -> SymPyExpression:
        return self + (-other)

    def __mul__(self, other: SymPyExpression) -> SymPyExpression:
        return SymPyExpression(Mul(self.expression, other.expression, evaluate=False))

    def __truediv__(self, other: SymPyExpression) -> SymPyExpression:
        return self * SymPyExpression(Pow(other.expression, -1, evaluate=False))

    def __neg__(self) -> SymPyExpression:
        return SymPyExpression(-1) * self if not self.expression.is_Rational else SymPyExpression(-self.expression)


class Expressions:
    """The system: constants and roots; a sign is SymPy's business (see the literal engine)."""

    def constant(self, q: Quantity) -> SymPyExpression:
        """See `Arithmetic.constant`."""
        return SymPyExpression(sympify(q.sympy()))

    def root(self, value: SymPyExpression) -> SymPyExpression:
        """See `Arithmetic.root`."""
        return SymPyExpression(Pow(value.expression, Rational(1, 2), evaluate=False))


EXPRESSIONS = Expressions()
