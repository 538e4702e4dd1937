"""Exact values of any depth as SymPy expressions with shared parts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sympy import Add, Mul, Pow, Rational, sympify

from ...scenarios.quantity import Quantity
from ..replay.state import State, replay
from ..replay.steps import causal_past
from .run_log import RunLog


class _Expression:
    """A SymPy expression under construction; nothing is simplified, so building it is linear."""

    __slots__ = ("expression",)

    def __init__(self, expression: Any) -> None:
        self.expression = expression

    def __add__(self, other: _Expression) -> _Expression:
        return _Expression(Add(self.expression, other.expression, evaluate=False))

    def __sub__(self, other: _Expression) -> _Expression:
        return self + (-other)

    def __mul__(self, other: _Expression) -> _Expression:
        return _Expression(Mul(self.expression, other.expression, evaluate=False))

    def __truediv__(self, other: _Expression) -> _Expression:
        return self * _Expression(Pow(other.expression, -1, evaluate=False))

    def __neg__(self) -> _Expression:
        return _Expression(-1) * self if not self.expression.is_Rational else _Expression(-self.expression)


def sympy_state(log: RunLog, upto: int, bodies: Sequence[int]) -> State:
    """The states of some bodies after the first `upto` steps, as SymPy expressions that share their parts."""

    def constant(q: Quantity) -> _Expression:
        return _Expression(sympify(q.sympy()))

    def root(value: _Expression) -> _Expression:
        return _Expression(Pow(value.expression, Rational(1, 2), evaluate=False))

    steps = log.steps[:upto]
    needed, held = causal_past(steps, bodies, len(log.scene.circles))
    state = State(log.scene, constant, root, only=held)
    replay(state, steps, needed)
    return state
