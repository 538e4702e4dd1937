"""Exact numbers from SymPy expressions, by whitelist."""

from __future__ import annotations

import sys
from collections.abc import Callable
from importlib import import_module
from typing import Any

from flint import fmpq

from ...checks.showing import shortened
from ...errors import SceneError
from ..parsing import N

MAX_ROOTS = 1 << 10
"""Largest denominator of an exponent, a power of two: ten roots of one number."""


def is_sympy(value: object) -> bool:
    """Whether a value is a SymPy expression: never where SymPy is not loaded."""
    return "sympy" in sys.modules and isinstance(value, sys.modules["sympy"].Basic)


def from_sympy(value: Any, number: Callable[[fmpq], N]) -> N:
    """The exact number that a SymPy expression is, built from what `number` makes of rationals.

    Raises:
        SceneError: unless the expression is made of rationals, + - * /, and powers whose exponents have a power of two
            below the fraction bar.

    >>> import sympy
    >>> from ..quantity import rational
    >>> from_sympy(sympy.sqrt(3) / 2, rational)
    Quantity('(1/2)*sqrt(3)')
    """
    sympy: Any = import_module("sympy")
    if isinstance(value, sympy.Float):
        return from_sympy(sympy.Rational(value), number)
    if isinstance(value, sympy.Rational) and value.q != 0:
        return number(fmpq(int(value.p), int(value.q)))
    if isinstance(value, sympy.Add):
        total, *parts = (from_sympy(argument, number) for argument in value.args)
        for part in parts:
            total = total + part
        return total
    if isinstance(value, sympy.Mul):
        product = number(fmpq(1))
        for argument in value.args:
            product = product * from_sympy(argument, number)
        return product
    if isinstance(value, sympy.Pow) and isinstance(value.exp, sympy.Rational):
        base = from_sympy(value.base, number)
        if value.exp.q == 1:
            return base ** int(value.exp)
        denominator = int(value.exp.q)
        if denominator & (denominator - 1) == 0 and denominator <= MAX_ROOTS:
            while denominator > 1:
                base, denominator = base.sqrt(), denominator // 2
            return base ** int(value.exp.p)
    raise SceneError(f"{shortened(str(value))!r} is not made of rationals and square roots")
