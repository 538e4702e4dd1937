"""Derivatives of contacts in doubles, with a bound of what they are off wherever the truth may be."""

from __future__ import annotations

from math import inf
from typing import NamedTuple

from ..laws.tangent_formulas import pair_tangent_blocks
from .errors import UP, Blocks

SMALL_WAIT = 2.0**-48
"""The most that a clock may stand beside its instant, in the set's unit of time, to be a mere perturbation."""

CLOSE = 2.0**-50
"""How near to the truth the doubles must be, relatively, of which a derivative is made."""

OFF = 2.0**-44
"""What a derivative made of such doubles is off, relatively to the sum of its sizes: each entry is a sum of at most
three products of at most six factors, and two entries are a row: 36 times `CLOSE` and the roundings, 2**-53 each."""


class PairDerivative(NamedTuple):
    """What is known of the collision of two circles wherever the truth may be.

    Attributes:
        steep: by how much, at most, the instant moves for a deviation of one in d and v.
        apart: a bound of what d at the hit may be off.
        blocks: the derivative.
    """

    steep: float
    apart: float
    blocks: Blocks


def pair_derivative(
    d: tuple[float, float],
    v: tuple[float, float],
    speed: float,
    strength: float,
    unit: float,
    spread: float,
    near: float,
) -> PairDerivative | None:
    """The derivative of a collision, at the clock beside its instant, or None where the truth may be too far.

    Args:
        d, v: at the hit, from midpoints, rounded.
        speed: -d.v at the hit.
        strength: -2 / (R^2 (wa + wb)); 0 where it is not to be had.
        unit: the set's unit of time.
        spread: a bound of the deviations of d and of unit * v, however scaled.
        near: `CLOSE`, scaled like that.

    With tau the time from the clock to the hit, the derivative is (b - tau a, -tau^2 a; a, b + tau a). The instant
    moves by -d.(dd + tau dv) / d.v, and d at the hit by as much times v and what d itself does: both from
    |d + tau v| = R (see `laws/tangent.py`).
    """
    size_d, size_v = abs(d[0]) + abs(d[1]), abs(v[0]) + abs(v[1])
    if not strength < 0.0 < speed < inf:
        return None
    steep = size_d / speed * UP
    apart = (1.0 + size_v * steep) * spread * UP
    if not max(apart / size_d, spread / (unit * size_v), (apart * size_v + size_d * spread / unit) / speed) < near:
        return None
    square, cross = v[0] * v[0] + v[1] * v[1], d[0] * v[1] - d[1] * v[0]
    xx, xy, yy, *a = pair_tangent_blocks(*d, -speed, cross, square, strength)
    norm_b = -strength * size_d * size_d
    norm_a = unit * (-strength * (speed + size_d * size_v) + square / speed * norm_b)
    norm = (norm_a + norm_b) * UP
    pxx, pxy, pyx, pyy = (part * unit for part in a)
    blocks = Blocks(((xx, xy), (xy, yy)), ((pxx, pxy), (pyx, pyy)), norm, norm * (OFF + 2.0 * SMALL_WAIT))
    return PairDerivative(steep, apart, blocks)


def wall_steepness(nx: float, ny: float, vx: float, vy: float) -> float:
    """By how much, at most, the hit of a wall moves for a deviation of one in the place; infinite where not known.

    >>> wall_steepness(0.0, 2.0, 3.0, -4.0) >= 0.25
    True
    """
    speed, size = -(nx * vx + ny * vy), abs(nx) + abs(ny)
    return size / speed * UP * UP if speed > CLOSE * size * (abs(vx) + abs(vy)) * 2.0**20 else inf
