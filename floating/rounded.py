"""The event-driven engine with every operation rounded to so many bits: how few bits does a result need?"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from math import frexp, isfinite, ldexp, nan, sqrt
from operator import add, mul, sub, truediv
from typing import Any

from ..exact.numbers.system import Nearest, NumberSystem
from ..scenarios.errors import SceneError
from ..scenarios.numbers.quantity import Quantity
from .plain import EventEngine

MIN_BITS, MAX_BITS = 4, 53
"""Bits of a significand: with fewer than four no gas keeps its discs apart; a double has 53."""


def rounded(value: float, bits: int, beyond: Callable[[], int]) -> float:
    """The nearest number of so many bits to an exact result, ties to even; exponents are those of doubles.

    A half-way point of a shorter format is a double. So a double that is none lies on the same side of all of them as
    the exact result from which it was rounded; and for one that is, the exact result decides.

    Args:
        value: the double nearest to the exact result.
        beyond: the sign of the exact result less `value`; asked for at a half-way point only.

    >>> rounded(1.375, 3, lambda: 0), rounded(1.375, 3, lambda: -1), rounded(1.3, 3, lambda: 0)
    (1.5, 1.25, 1.25)
    """
    if not isfinite(value):
        return value
    mantissa, exponent = frexp(value)
    scaled = ldexp(mantissa, bits)
    nearest = round(scaled)
    if abs(scaled - nearest) == 0.5:
        side = beyond()
        if side:
            nearest = int(scaled + 0.5 * side)
    return ldexp(nearest, exponent - bits)


@cache
def number(bits: int) -> type[float]:
    """The type of numbers of so many bits.

    >>> third = number(8)(1) / number(8)(3)
    >>> float(third), type(third) is number(8)
    (0.333984375, True)
    """

    def arithmetic(operation: Callable[[Any, Any], Any]) -> Callable[[float, float], float]:
        def apply(one: float, other: float) -> float:
            a, b = float(one), float(other)
            try:
                value = operation(a, b)
            except ZeroDivisionError:
                return kind(nan)

            def beyond() -> int:
                exact = operation(Fraction(a), Fraction(b)) - Fraction(value)
                return (exact > 0) - (exact < 0)

            return kind(rounded(value, bits, beyond))

        return apply

    space = {
        "__slots__": (),
        "__add__": arithmetic(add),
        "__sub__": arithmetic(sub),
        "__mul__": arithmetic(mul),
        "__truediv__": arithmetic(truediv),
        "__neg__": lambda self: kind(-float(self)),
        "__abs__": lambda self: kind(abs(float(self))),
    }
    kind: type[float] = type(f"Rounded{bits}", (float,), space)
    return kind


class Rounding(Nearest):
    """The system of numbers of so many bits: every sign is an answer, perhaps a wrong one.

    Args:
        bits: of the significand, `MIN_BITS` to `MAX_BITS`.
    """

    def __init__(self, bits: int = MAX_BITS) -> None:
        self.bits = bits
        self._kind = number(bits)

    def constant(self, q: Quantity) -> float:
        """The nearest number of so many bits, ties to even.

        >>> float(Rounding(8).constant(Quantity.of("1/10")))
        0.10009765625
        """
        value = float(q)
        return self._kind(rounded(value, self.bits, (q - Quantity.of(Fraction(value))).sign))

    def root(self, value: float) -> float:
        """The square root, rounded; nan below zero."""
        if not value >= 0.0:
            return self._kind(nan)
        double = sqrt(value)

        def beyond() -> int:
            exact = Fraction(float(value)) - Fraction(double) ** 2
            return (exact > 0) - (exact < 0)

        return self._kind(rounded(double, self.bits, beyond))


@dataclass(frozen=True)
class RoundedEngine(EventEngine[float]):
    """The event loop of the exact engine, every operation rounded to so many bits (see `EventEngine`).

    With 53 bits it is `double`, with 24 `single` (but for its range), number for number.

    Attributes:
        bits: of the significand.

    >>> from truebreak.scenarios import Circle, Scene
    >>> float(RoundedEngine(12).run(Scene([Circle(0, 0, vx=1), Circle(4, 1)])).events[0].time)
    2.267578125
    """

    bits: int = 24

    def __post_init__(self) -> None:
        if isinstance(self.bits, bool) or not isinstance(self.bits, int) or not MIN_BITS <= self.bits <= MAX_BITS:
            raise SceneError(f"bits = {self.bits!r}: must be a whole number from {MIN_BITS} to {MAX_BITS}")

    @property
    def name(self) -> str:
        """The engine's name."""
        return "rounded"

    @property
    def parameters(self) -> Mapping[str, Any]:
        """The bits."""
        return {"bits": self.bits}

    @property
    def numbers(self) -> NumberSystem[float]:
        """Numbers of so many bits."""
        return Rounding(self.bits)

    def wider(self) -> RoundedEngine | None:
        """The same with twice the bits; None beyond those of a double."""
        return RoundedEngine(2 * self.bits) if 2 * self.bits <= MAX_BITS else None
