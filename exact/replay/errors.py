"""What happens to the deviations of a state from its midpoints, step by step, in doubles with bounds."""

from __future__ import annotations

from math import ldexp
from typing import NamedTuple, TypeAlias

UP = 1.0 + 2.0**-40
"""Covers the roundings of a bound: sums of up to a hundred positive terms, each rounded by at most 2**-52."""

MOST = 2.0**900
"""Bounds beyond this are none."""


class Spent(ArithmeticError):
    """The set cannot be carried on: what is known then is each body's own bound."""


class Blocks(NamedTuple):
    """The derivative of a collision by d and v, per inverse mass: position by d is b, velocity by d is a, by v is b.

    Attributes:
        b, a: two rows of two doubles each.
        norm: at least the largest row sum of the whole.
        off: at least the largest row sum of what the doubles are away from the derivative on the hull.
    """

    b: tuple[tuple[float, float], tuple[float, float]]
    a: tuple[tuple[float, float], tuple[float, float]]
    norm: float
    off: float


class Fly(NamedTuple):
    """Body i moves on by a time, of which the double `lag` is the nearest."""

    i: int
    lag: float
    j: int = -1


class Mirror(NamedTuple):
    """Body i's line is mirrored by (xx, xy; xy, yy), known up to `off`; its midpoints are rounded."""

    i: int
    xx: float
    xy: float
    yy: float
    off: float
    rounding: float
    j: int = -1


class Meet(NamedTuple):
    """Bodies i and j collide (-1: a fixed one): i loses its inverse mass times what the blocks give, j gains it."""

    i: int
    j: int
    wi: float
    wj: float
    blocks: Blocks
    rounding_i: float
    rounding_j: float


class Round(NamedTuple):
    """Body i's midpoints are rounded."""

    i: int
    rounding: float
    j: int = -1


ErrorStep: TypeAlias = Fly | Mirror | Meet | Round


def grow(bounds: list[float], step: ErrorStep) -> None:
    """Carries a bound for each body through a step, by norms."""
    i = step.i
    if isinstance(step, Fly):
        bounds[i] *= (1.0 + abs(step.lag)) * UP
    elif isinstance(step, Meet):
        j = step.j
        gain = (step.blocks.norm + step.blocks.off) * (bounds[i] + bounds[j]) * UP
        if i >= 0:
            bounds[i] = (bounds[i] + step.wi * gain + step.rounding_i) * UP
        if j >= 0:
            bounds[j] = (bounds[j] + step.wj * gain + step.rounding_j) * UP
    elif isinstance(step, Mirror):
        norm = max(abs(step.xx), abs(step.yy)) + abs(step.xy) + step.off
        bounds[i] = (bounds[i] * norm + step.rounding) * UP
    else:
        bounds[i] = (bounds[i] + step.rounding) * UP


def scaled(mantissa: int, exponent: int, shift: int) -> float:
    """mantissa * 2**exponent / 2**shift as a double, not below it unless it vanishes.

    >>> 3.0 <= scaled(3, -400, -400) < 3.001
    True
    """
    return ldexp(float(mantissa), max(exponent - shift, -1000)) * UP
