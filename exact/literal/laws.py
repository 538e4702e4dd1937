"""The derived laws as SymPy gave them, evaluated at numbers: nothing rearranged, every filter decided.

The article substitutes numbers into the solutions and filters out what is complex, nan or infinite.
With nested roots SymPy may leave a zero unrecognised in a denominator, and give nonsense for nan; so the
radicand and the denominator of each solution are looked at first, and their signs decided.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from sympy import Expr, Symbol, fraction, sqrt, together

from ..laws.derivation import (
    a_m,
    a_r,
    a_vx,
    a_vy,
    a_x,
    a_y,
    b_m,
    b_r,
    b_vx,
    b_vy,
    b_x,
    b_y,
    fixed_circle_velocities,
    pair_instant_speed,
    pair_times,
    pair_velocities,
    w_x0,
    w_x1,
    w_y0,
    w_y1,
    wall_instant_speed,
    wall_times,
    wall_velocities,
    x0,
    x1,
    y0,
    y1,
)
from .sign import normal, root, sign

_ROOT = Symbol("root")


@dataclass(frozen=True)
class Solution:
    """A derived expression taken apart: over / under, in which `_ROOT` stands for sqrt(radicand).

    Attributes:
        over: numerator.
        under: denominator.
        radicand: what the square root is taken of, over its own denominator; None without a root.
    """

    over: Any
    under: Any
    radicand: tuple[Any, Any] | None

    @staticmethod
    def of(expression: Any) -> Solution:
        """Takes an expression with at most one square root apart.

        >>> from sympy.abc import x, y
        >>> Solution.of((1 - sqrt(x)) / y).radicand
        (x, 1)
        """
        half_powers = {part for part in expression.atoms(type(sqrt(Symbol("x")))) if part.exp.q == 2}
        bases = {part.base for part in half_powers}
        if not bases:
            return Solution(*fraction(together(expression)), None)
        (base,) = bases
        rational = expression.xreplace({part: _ROOT ** (2 * part.exp) for part in half_powers})
        return Solution(*fraction(together(rational)), fraction(together(base)))

    def value(self, at: Mapping[Any, Any]) -> Expr | None:
        """The number that the solution takes, or None where it is complex, nan or infinite."""
        at = self._with_root(at)
        if at is None:
            return None
        under = normal(self.under.xreplace(at))
        if sign(under) == 0:
            return None
        return normal(self.over.xreplace(at) / under)

    def sign(self, at: Mapping[Any, Any]) -> int | None:
        """The sign of that number, without computing it; None where it is complex, nan or infinite."""
        at = self._with_root(at)
        if at is None:
            return None
        under = sign(normal(self.under.xreplace(at)))
        return under * sign(normal(self.over.xreplace(at))) if under else None

    def _with_root(self, at: Mapping[Any, Any]) -> Any:
        if self.radicand is None:
            return at
        over, under = (normal(part.xreplace(at)) for part in self.radicand)
        if sign(under) == 0:
            return None
        radicand = normal(over / under)
        if sign(radicand) < 0:
            return None
        return {**at, _ROOT: root(radicand)}


@dataclass(frozen=True)
class Disc:
    """A circle at one moment, in SymPy numbers; `m` is None for a fixed circle."""

    x: Any
    y: Any
    vx: Any
    vy: Any
    r: Any
    m: Any | None


@dataclass(frozen=True)
class Line:
    """A wall through two points, in SymPy numbers."""

    x0: Any
    y0: Any
    x1: Any
    y1: Any


def touch_times(a: Disc, b: Disc | Line) -> list[Expr]:
    """All real times from now at which two things would just touch, not ordered, negative ones too.

    >>> from sympy import Integer as I
    >>> touch_times(Disc(I(0), I(0), I(2), I(0), I(1), I(1)), Disc(I(4), I(0), I(0), I(0), I(1), I(1)))
    [1, 3]
    """
    found = [
        solution.value(_at(a, b)) for solution in _solutions("wall touched" if isinstance(b, Line) else "pair touched")
    ]
    return [time for time in found if time is not None]


def approach_sign(a: Disc, b: Disc | Line) -> int:
    """The sign of the instant speed at which two things come nearer; 0 where that is nan."""
    (solution,) = _solutions("wall speed" if isinstance(b, Line) else "pair speed")
    return solution.sign(_at(a, b)) or 0


def velocities_after(a: Disc, b: Disc | Line) -> tuple[Expr, ...]:
    """(vx, vy) of a after a collision with a wall or fixed circle b, or (vx, vy) of a and of b.

    Raises:
        ValueError: where the law has no value, as for two points at one place.
    """
    solutions = _solutions("wall" if isinstance(b, Line) else "fixed" if b.m is None else "pair")
    values = [solution.value(_at(a, b)) for solution in solutions]
    found = tuple(value for value in values if value is not None)
    if len(found) != len(values):
        raise ValueError("the velocities after this collision have no value")
    return found


@cache
def _solutions(law: str) -> Sequence[Solution]:
    laws: dict[str, Callable[[], tuple[Any, ...]]] = {
        "pair touched": pair_times,
        "wall touched": wall_times,
        "pair speed": lambda: (pair_instant_speed(),),
        "wall speed": lambda: (wall_instant_speed(),),
        "pair": lambda: pair_velocities()[1],
        "fixed": fixed_circle_velocities,
        "wall": wall_velocities,
    }
    return tuple(map(Solution.of, laws[law]()))


def _at(a: Disc, b: Disc | Line) -> dict[Any, Any]:
    """The article's symbols and their numbers."""
    values: dict[Any, Any] = {
        a_x: a.x, a_y: a.y, a_vx: a.vx, a_vy: a.vy, a_r: a.r, a_m: a.m,
    }  # fmt: skip
    if isinstance(b, Line):
        return values | {
            x0: b.x0, y0: b.y0, x1: b.x1, y1: b.y1,
            w_x0: b.x0, w_y0: b.y0, w_x1: b.x1, w_y1: b.y1,
        }  # fmt: skip
    return values | {
        b_x: b.x, b_y: b.y, b_vx: b.vx, b_vy: b.vy, b_r: b.r, b_m: b.m,
    }  # fmt: skip
