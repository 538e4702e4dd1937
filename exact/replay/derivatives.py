"""Derivatives of contacts in doubles, with a bound of what they are off wherever the truth may be."""

from __future__ import annotations

from math import inf

from .errors import UP, Collision

SMALL_WAIT = 2.0**-48
"""The most that a clock may stand beside its instant, in the set's unit of time, to be a mere perturbation."""

CLOSE = 2.0**-50
"""How near to the truth the doubles must be, relatively, of which a derivative is made."""

OFF = 2.0**-44
"""What a derivative made of such doubles is off, relatively to the sum of its sizes: each entry is a sum of at most
three products of at most six factors, and two entries are a row: 36 times `CLOSE` and the roundings, 2**-53 each."""


OFF_BESIDE = OFF + 2.0 * SMALL_WAIT
"""The same, at a clock beside the instant."""

LEAST = 1e-280
"""Squares of speeds, and speeds along a line, that doubles hold to a rounding, and some products of them."""

FLAT = 2.0**-30
"""Share of |n| |v| that n.v must have: in doubles it is off by less than 2**-51 of that, 2**-21 of itself."""

STEEPER = 1.0 + 2.0**-20
"""Covers what n.v in doubles is off by."""


def pair_derivative(
    dx: float,
    dy: float,
    vx: float,
    vy: float,
    speed: float,
    strength: float,
    unit: float,
    spread: float,
    near: float,
) -> Collision | None:
    """The derivative of a collision, at the clock beside its instant, or None where the truth may be too far.

    Args:
        dx, dy, vx, vy: d and v at the hit, from midpoints, rounded.
        speed: -d.v at the hit.
        strength: -2 / (R^2 (wa + wb)); 0 where it is not to be had.
        unit: the set's unit of time.
        spread: a bound of the deviations of d and of unit * v, however scaled.
        near: `CLOSE`, scaled like that.

    With tau the time from the clock to the hit, the derivative is (b - tau a, -tau^2 a; a, b + tau a). The instant
    moves by -d.(dd + tau dv) / d.v, and d at the hit by as much times v and what d itself does: both from
    |d + tau v| = R (see `laws/tangent.py`).
    """
    size_d, size_v, square = abs(dx) + abs(dy), abs(vx) + abs(vy), vx * vx + vy * vy
    if not (strength < 0.0 and LEAST < speed < inf and square > LEAST):
        return None
    steep = size_d / speed * UP
    apart = (1.0 + size_v * steep) * spread * UP
    far = apart * size_v + size_d * spread / unit
    if not (apart < near * size_d and spread < near * unit * size_v and far < near * speed):
        return None
    cross, push = abs(dx * vy - dy * vx), -strength
    size_b = push * size_d * size_d
    size = size_b + unit * (push * (speed + size_d * size_v) + square / speed * size_b)
    norm_b = push * max(abs(dx), abs(dy)) * size_d
    norm = (norm_b + unit * (push * (speed + cross) + square / speed * norm_b)) * UP
    return Collision(steep, apart, norm, size * OFF_BESIDE * UP, dx, dy, vx, vy, speed, strength)


def wall_steepness(nx: float, ny: float, vx: float, vy: float) -> float:
    """By how much, at most, the hit of a wall moves for a deviation of one in the place; infinite where not known.

    >>> wall_steepness(0.0, 2.0, 3.0, -4.0) >= 0.25
    True
    """
    speed, size = -(nx * vx + ny * vy), abs(nx) + abs(ny)
    return size / speed * STEEPER if speed > FLAT * size * (abs(vx) + abs(vy)) and speed > LEAST else inf
