"""From exact numbers of every kind to those of one's own."""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite
from numbers import Rational
from typing import Any, Protocol, runtime_checkable

from flint import fmpq, fmpz

from ...errors import SceneError
from ..parsing import N, parse
from .sympy_form import from_sympy, is_sympy


@runtime_checkable
class _Ratio(Protocol):
    """A number that is a ratio of whole numbers, such as a Decimal, or a float of numpy's."""

    def as_integer_ratio(self) -> tuple[int, int]: ...


def converted(value: Any, number: Callable[[fmpq], N]) -> N:
    """The exact number that `value` is, built from what `number` makes of rationals (see `Quantity.of`).

    Raises:
        SceneError: for what is no exact number.
    """
    if isinstance(value, bool):
        raise SceneError(f'{value!r} is not a number; write a whole number or text such as "9/4"')
    if isinstance(value, (int, fmpz)):
        return number(fmpq(value))
    if isinstance(value, str):
        return parse(value, number)
    if isinstance(value, fmpq):
        return number(value)
    if isinstance(value, float):
        if not isfinite(value):
            raise SceneError(f"{value!r} is not a finite number")
        return number(fmpq(*value.as_integer_ratio()))
    if isinstance(value, Rational):
        return number(fmpq(int(value.numerator), int(value.denominator)))
    if is_sympy(value):
        return from_sympy(value, number)
    if isinstance(value, _Ratio):
        try:
            numerator, denominator = value.as_integer_ratio()
        except (OverflowError, ValueError) as error:
            raise SceneError(f"{value!r} is not a finite number") from error
        return number(fmpq(int(numerator), int(denominator)))
    raise SceneError(
        f"{value!r} ({type(value).__name__}) is not an exact number; "
        'write a whole number, a Fraction, or text such as "sqrt(3)/2"'
    )
