"""SymPy expressions, built as a run computes them and never simplified, so that building them is linear."""

from __future__ import annotations

from typing import Any

from sympy import Add, Mul, Pow, Rational, sympify  # pyright: ignore[reportMissingTypeStubs]

from ...scenarios.numbers.quantity import Quantity


class Expression:
    """A SymPy expression under construction."""

    __slots__ = ("expression",)

    def __init__(self, expression: Any) -> None:
        self.expression = expression

    def __add__(self, other: Expression) -> Expression:
        return Expression(Add(self.expression, other.expression, evaluate=False))

    def __sub__(self, other: Expression) -> Expression:
        return self + (-other)

    def __mul__(self, other: Expression) -> Expression:
        return Expression(Mul(self.expression, other.expression, evaluate=False))

    def __truediv__(self, other: Expression) -> Expression:
        return self * Expression(Pow(other.expression, -1, evaluate=False))

    def __neg__(self) -> Expression:
        return Expression(-1) * self if not self.expression.is_Rational else Expression(-self.expression)


class Expressions:
    """The system: constants and roots; a sign is SymPy's business (see the literal engine)."""

    def constant(self, q: Quantity) -> Expression:
        """See `Arithmetic.constant`."""
        return Expression(sympify(q.sympy()))

    def root(self, value: Expression) -> Expression:
        """See `Arithmetic.root`."""
        return Expression(Pow(value.expression, Rational(1, 2), evaluate=False))


EXPRESSIONS = Expressions()
