"""What happens to the deviations of a state from its midpoints, step by step: bounds in doubles, grown by norms."""

from __future__ import annotations

from math import ldexp
from typing import NamedTuple

UP = 1.0 + 2.0**-40
"""Covers the roundings of a bound: sums of up to a hundred positive terms, each rounded by at most 2**-52."""

MOST = 2.0**900
"""Bounds beyond this are none."""

CARRIED = 2.0**-49
"""What carrying a row through a step in doubles adds, relatively to the sum of its sizes: sixteen roundings, of which
docs/error-bound.md counts fourteen."""


class Spent(ArithmeticError):
    """The set cannot be carried on: what is known then is each body's own bound."""


class Collision(NamedTuple):
    """The derivative of the collision of two circles, in doubles made of midpoints.

    Attributes:
        steep: by how much, at most, the instant moves for a deviation of one in d and v.
        apart: a bound of what d at the hit may be off.
        norm: at least the largest row sum of the derivative by d and v, per inverse mass, as doubles have it.
        off: at least the largest row sum of what that is away from the derivative on the hull.
        dx, dy, vx, vy, speed: d, v and -d.v at the hit.
        strength: -2 / (R^2 (wa + wb)).
    """

    steep: float
    apart: float
    norm: float
    off: float
    dx: float
    dy: float
    vx: float
    vy: float
    speed: float
    strength: float


class Leg(NamedTuple):
    """Body i moves on by `lag`, in the set's unit of time, and its line is then mirrored by (xx, xy; xy, yy)."""

    i: int
    lag: float
    xx: float = 1.0
    xy: float = 0.0
    yy: float = 1.0


class Bounds:
    """For each body, in each of its coordinates: what deviates, and what the matrix of a block does not tell of it.

    Attributes:
        nu: bounds of the deviations; 0 at last, for what is fixed.
        mu: bounds of what is beside the matrix.
    """

    def __init__(self, nu: list[float]) -> None:
        self.nu = nu
        self.mu = [0.0] * len(nu)

    def fly(self, leg: Leg, off: float = 0.0, rounding: float = 0.0) -> None:
        """Carries them through a leg, whose mirror is known up to `off`; the midpoints after it are rounded."""
        i, lag, xx, xy, yy = leg
        nu, mu = self.nu, self.mu
        far = (1.0 + abs(lag)) * UP
        norm = max(abs(xx), abs(yy)) + abs(xy)
        wide = nu[i] * far
        mu[i] = (mu[i] * far * (norm + off) + (off + CARRIED * norm) * wide + rounding) * UP
        nu[i] = (wide * (norm + off) + rounding) * UP

    def meet(
        self, i: int, j: int, lags: tuple[float, float], weights: tuple[float, float], hit: Collision, rounding: float
    ) -> None:
        """Carries them through the flights of i and j to their collision, and through that.

        Args:
            i, j: -1 for a fixed one.
            lags: how long they fly.
            weights: their inverse masses.
            hit: the derivative.
            rounding: of the midpoints after it.
        """
        nu, mu = self.nu, self.mu
        far_i, far_j = (1.0 + abs(lags[0])) * UP, (1.0 + abs(lags[1])) * UP
        wide_i, wide_j, beside_i, beside_j = nu[i] * far_i, nu[j] * far_j, mu[i] * far_i, mu[j] * far_j
        both, norm, off = wide_i + wide_j, hit.norm, hit.off
        gain = (norm + off) * both * UP
        loss = ((norm + off) * (beside_i + beside_j) + (off + CARRIED * norm) * both) * UP
        if i >= 0:
            weight = weights[0]
            mu[i] = (beside_i + weight * loss + CARRIED * wide_i + rounding) * UP
            nu[i] = (wide_i + weight * gain + rounding) * UP
        if j >= 0:
            weight = weights[1]
            mu[j] = (beside_j + weight * loss + CARRIED * wide_j + rounding) * UP
            nu[j] = (wide_j + weight * gain + rounding) * UP


def scaled(mantissa: int, exponent: int, shift: int) -> float:
    """mantissa * 2**exponent / 2**shift as a double, not below it unless it vanishes.

    >>> 3.0 <= scaled(3, -400, -400) < 3.001
    True
    """
    return ldexp(float(mantissa), max(exponent - shift, -1000)) * UP
