"""Derivatives of contacts in doubles, with a bound of what they are off wherever the truth may be."""

from __future__ import annotations

from math import inf, sqrt

from .errors import UP, Collision

MOST_TURN = 2.0**100
"""Beyond this, two circles all but graze, and doubles are no measure."""

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
    place: float,
    pace: float,
    near: float,
) -> Collision | None:
    """The derivative of a collision, at the clock beside its instant, or None where the truth may be too far.

    Args:
        dx, dy, vx, vy: d and v at the hit, from midpoints, rounded.
        speed: -d.v at the hit.
        strength: -2 / (R^2 (wa + wb)); 0 where it is not to be had.
        unit: the set's unit of time.
        place: a bound of the deviation of d at the clock and beside it, however scaled.
        pace: of unit * v, scaled like that.
        near: `CLOSE`, scaled like that.

    With tau the time from the clock to the hit, the derivative is (b - tau a, -tau^2 a; a, b + tau a). The instant
    moves by -d.(dd + tau dv) / d.v, and d at the hit by as much times v and what d itself does: both from
    |d + tau v| = R (see `laws/tangent.py`).
    """
    square, reach = vx * vx + vy * vy, sqrt(dx * dx + dy * dy)
    if not (strength < 0.0 and LEAST < speed < inf and LEAST < square < inf and reach > 0.0):
        return None
    slow, steep = sqrt(square), reach / speed * UP
    slant = slow * steep
    apart = (1.0 + slant) * place * UP
    turn = unit * square / speed * UP
    if not (slant * (apart / reach + pace / (unit * slow)) * UP < near and turn < MOST_TURN):
        return None
    return Collision(steep, apart, turn, dx, dy, vx, vy, speed, strength)


def wall_steepness(nx: float, ny: float, vx: float, vy: float) -> float:
    """By how much, at most, the hit of a wall moves for a deviation of one in the place; infinite where not known.

    >>> wall_steepness(0.0, 2.0, 3.0, -4.0) >= 0.25
    True
    """
    speed, size = -(nx * vx + ny * vy), abs(nx) + abs(ny)
    return size / speed * STEEPER if speed > FLAT * size * (abs(vx) + abs(vy)) and speed > LEAST else inf
