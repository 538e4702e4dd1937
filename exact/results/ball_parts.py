"""Balls as whole numbers, bit for bit, and how they pickle."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

from flint import arb, fmpz

Parts: TypeAlias = tuple[int, int, int, int] | tuple[()]
"""Midpoint and radius as m, e, r, f: m * 2**e +/- r * 2**f. Nothing, for a ball that is not finite."""


def parts_of(ball: arb) -> Parts:
    """A ball as whole numbers.

    >>> parts_of(arb(3) / 4), float(from_parts(*parts_of(arb(3) / 4)))
    ((3, -2, 0, 0), 0.75)
    """
    if not ball.is_finite():
        return ()
    middle, radius = ball.mid().man_exp(), ball.rad().man_exp()
    return int(middle[0]), int(middle[1]), int(radius[0]), int(radius[1])


def from_parts(*parts: int) -> arb:
    """The ball of these parts, at any working precision; one that says nothing, for none."""
    if not parts:
        return arb.nan()
    m, e, r, f = parts
    middle, radius = (fmpz(m), fmpz(e)), arb((fmpz(r), fmpz(f)))
    wide = arb(middle, radius)
    if _is(wide.rad(), radius):
        return wide
    spare = RADIUS_BITS - r.bit_length()
    same = arb(middle, arb((fmpz((r << spare) - 1), fmpz(f - spare))))
    return same if _is(same.rad(), radius) else wide


RADIUS_BITS = 31
"""One more than a radius has: flint adds a unit in the last place to one that it takes, so it is given half of one
less. What comes of it is looked at, and the wider ball taken where it is not the one wanted."""


def _is(one: arb, other: arb) -> bool:
    """Whether two numbers without a radius are the same."""
    return bool(one == other)


def reduced(ball: arb) -> tuple[Callable[..., arb], Parts]:
    """What pickle keeps of a ball."""
    return from_parts, parts_of(ball)
