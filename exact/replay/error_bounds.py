"""Bounds, in doubles, of what steps and contacts do to the deviations of a state from its midpoints."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, ldexp, log2, sqrt
from typing import NamedTuple

from flint import arb

from .contact import Body, Gravity

# -- What happens to the deviations of a state from its midpoints, step by step: bounds in doubles, grown by norms.

UP = 1.0 + 2.0**-40
"""Covers the roundings of a bound: sums of up to a hundred positive terms, each rounded by at most 2**-52."""

WIDER = 1.0 + 2.0**-39
"""Covers besides what a derivative differs by, relatively, wherever the truth may be: less than 2**-40."""

CARRIED = 2.0**-39
"""What one step leaves beside the matrix, relatively to the bounds after it: the derivative's difference, less than
2**-40, and the roundings of the matrix and of the rows, of which docs/error-bound.md counts less than 2**-46."""

SMALL_WAIT = 2.0**-48
"""The most that a clock may stand beside its instant, in the set's unit of time, to be a mere perturbation."""

CLOSE = 2.0**-50
"""How near to the truth the doubles must be, relatively, of which a derivative is made."""

MOST = 2.0**900
"""Bounds beyond this are none."""


LEAST_TURN = 16.0
"""Where |v|^2 / |d.v| is less, a wait of `SMALL_WAIT` turns a direction by less than 2**-44: its part in `WIDER`."""


class Spent(ArithmeticError):
    """The set cannot be carried on: what is known then is each body's own bound."""


class Collision(NamedTuple):
    """The derivative of a collision of two, or of a circle and a wall that falls, in doubles made of midpoints.

    Attributes:
        steep: by how much, at most, the instant moves for a deviation of one in d.
        apart: a bound of what d at the hit may be off.
        turn: at least (|v|^2 + |a| |d|) / |d.v|, in the set's unit of time; at a wall (1 + e) / 2 |n.g| / |n.v|.
        dx, dy, vx, vy, speed: d, v and -d.v at the hit, the last below 0 at a hollow side. At a wall n for d, and 0
            for v, but -n.v at the hit.
        strength: -2 / (R^2 (wa + wb)); at a wall -(1 + e) / |n|^2.
        pull: n.g at a wall; d.a, with a by which v changes in a unit of time, onto something round; else 0.
    """

    steep: float
    apart: float
    turn: float
    dx: float
    dy: float
    vx: float
    vy: float
    speed: float
    strength: float
    pull: float = 0.0


class Mirror(NamedTuple):
    """The matrix (xx, xy; xy, yy) that mirrors, in doubles, and by how much, at most, its rows are off in sum."""

    xx: float = 1.0
    xy: float = 0.0
    yy: float = 1.0
    off: float = 0.0


class Face(NamedTuple):
    """A wall in doubles, to a circle: its normal, and how it mirrors."""

    nx: float
    ny: float
    mirror: Mirror


class Slope(NamedTuple):
    """A wall that falls or moves, in doubles, to a circle.

    Attributes:
        nx, ny: its normal.
        strength: -(1 + e) / |n|^2, or 0 where a double does not hold it well.
        pull: n.g.
    """

    nx: float
    ny: float
    strength: float
    pull: float


NO_MIRROR = Mirror()
"""A flight alone."""


class Bounds:
    """For each body: how far its place deviates, and its velocity; and the share that a block's matrix does not tell.

    Lengths of vectors in the plane: what a step does to them is bounded by the 2-norms of its parts, which for a
    collision are known in closed form (docs/error-bound.md).

    Attributes:
        place: bounds of the deviations of places; 0 at last, for what is fixed.
        pace: of velocities, in the set's unit of time.
        beside: the part of any of them, at most, that is beside the matrix.
    """

    def __init__(self, place: list[float], pace: list[float]) -> None:
        self.place = place
        self.pace = pace
        self.beside = 0.0

    def both(self, i: int) -> float:
        """The two of one body, added."""
        return self.place[i] + self.pace[i]

    def fly(self, i: int, lag: float, off: float, rounding: float) -> None:
        """Carries them through a flight, and a mirror known up to `off`; the midpoints after it are rounded."""
        pace, up = self.pace[i], (1.0 + off) * UP
        place = self.place[i] = (self.place[i] + abs(lag) * pace) * up + rounding
        pace = self.pace[i] = pace * up + rounding
        self.beside += CARRIED + 2.0 * off
        if rounding:
            self.beside += rounding / min(place, pace)

    def meet(
        self, i: int, j: int, lags: tuple[float, float], shares: tuple[float, float], turn: float, rounding: float
    ) -> None:
        """Carries them through the flights of i and j to their collision, and through that.

        Args:
            i, j: -1 for a fixed one.
            lags: how long they fly.
            shares: for each, 2 w / (wi + wj) with its inverse mass w.
            turn: see `Collision`.
            rounding: of the midpoints after it.
        """
        places, paces = self.place, self.pace
        pace_i, pace_j = paces[i], paces[j]
        place_i, place_j = places[i] + abs(lags[0]) * pace_i, places[j] + abs(lags[1]) * pace_j
        share_i, share_j = shares
        both, waited = turn * (place_i + place_j), SMALL_WAIT * (pace_i + pace_j)
        least = MOST
        if i >= 0:
            place = places[i] = (place_i + share_i * place_j + waited) * WIDER + rounding
            pace = paces[i] = (pace_i + share_i * (pace_j + both)) * WIDER + rounding
            least = place if place < pace else pace
        if j >= 0:
            place = places[j] = (place_j + share_j * place_i + waited) * WIDER + rounding
            pace = paces[j] = (pace_j + share_j * (pace_i + both)) * WIDER + rounding
            least = min(least, place, pace)
        self.beside += CARRIED + rounding / least


def waited(late: arb | None) -> float:
    """A bound of the time between a clock and its instant; infinite where there is none.

    >>> waited(arb(-3)) >= 3.0
    True
    """
    return inf if late is None else float(late.abs_upper()) * UP


def scaled(mantissa: int, exponent: int, shift: int) -> float:
    """mantissa * 2**exponent / 2**shift as a double, not below it unless it vanishes.

    >>> 3.0 <= scaled(3, -400, -400) < 3.001
    True
    """
    return ldexp(float(mantissa), max(exponent - shift, -1000)) * UP


def counted_radius(number: arb, shift: int) -> float:
    """A number's radius, divided by 2**shift; infinite where doubles do not tell it.

    >>> 4.0 <= counted_radius(arb(0, 0.5), -3) < 4.001
    True
    """
    if not number.is_finite():
        return inf
    mantissa, exponent = map(int, number.rad().man_exp())
    return scaled(mantissa, exponent, shift) if exponent - shift < 900 else inf


MOST_UNIT = 300
"""The largest power of two that is taken for a unit of time."""


def unit_of_time(bodies: Sequence[Body[arb]], falling: Gravity[arb] | None) -> int:
    """The power of two nearest to the time in which the fastest circle flies as far as the circles are wide."""
    gx, gy = (0.0, 0.0) if falling is None else (2.0 * float(falling.hx), 2.0 * float(falling.hy))
    flights = [(body.flight, float(body.flight.t)) for body in bodies]
    speed = max(max(abs(float(of.vx) + gx * t), abs(float(of.vy) + gy * t)) for of, t in flights)
    width = sum(float(body.r) for body in bodies) / len(bodies)
    if not (0.0 < width < inf and 0.0 < speed < inf):
        return 0
    return max(-MOST_UNIT, min(MOST_UNIT, round(log2(width) - log2(speed))))


# -- Derivatives of contacts in doubles, with a bound of what they are off wherever the truth may be.

MOST_TURN = 2.0**100
"""Beyond this, two circles all but graze, and doubles are no measure."""

LEAST = 1e-280
"""Squares of speeds, and speeds along a line, that doubles hold to a rounding, and some products of them."""

LEAST_PULL = 1e-100
"""What bends a flight, which doubles hold with all that is made of it, is more, and less than its inverse."""

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
    ax: float = 0.0,
    ay: float = 0.0,
) -> Collision | None:
    """The derivative of a collision, at the clock beside its instant, or None where the truth may be too far.

    Args:
        dx, dy, vx, vy: d and v at the hit, from midpoints, rounded.
        speed: -d.v at the hit: below 0 at the hollow side of an arc, which is met from within.
        strength: -2 / (R^2 (wa + wb)); 0 where it is not to be had.
        unit: the set's unit of time.
        place: a bound of the deviation of d at the clock and beside it, however scaled.
        pace: of unit * v, scaled like that.
        near: `CLOSE`, scaled like that.
        ax, ay: by which v changes in a unit of time, where one of the two falls and the other does not.

    With tau the time from the clock to the hit, the derivative is (b - tau a, -tau^2 a; a, b + tau a). The instant
    moves by -d.(dd + tau dv) / d.v, d at the hit by as much times v and what d itself does, and v by as much times what
    it changes by: from |d + tau v| = R (see `docs/studies/law_proofs.py`).

    >>> hit = pair_derivative(2.0, 0.0, -1.0, 0.0, 2.0, -1.0, 1.0, 1e-20, 1e-20, CLOSE, 3.0, 4.0)
    >>> 5.5 <= hit.turn < 5.501, hit.pull
    (True, 6.0)
    >>> pair_derivative(2.0, 0.0, -1.0, 0.0, 2.0, -1.0, 1.0, 1e-17, 1e-17, CLOSE, 0.0, 100.0) is None
    True
    """
    square, reach, fast = vx * vx + vy * vy, sqrt(dx * dx + dy * dy), abs(speed)
    bend = sqrt(ax * ax + ay * ay)
    if not (strength < 0.0 and LEAST < fast < inf and LEAST < square < inf and reach > 0.0):
        return None
    if not (bend == 0.0 or LEAST_PULL < bend < 1.0 / LEAST_PULL):
        return None
    slow, steep = sqrt(square), reach / fast * UP
    slant = slow * steep
    apart = (1.0 + slant) * place * UP
    turn = unit * (square + bend * reach) / fast * UP
    swerved = slant * bend * place / square
    if not (slant * (apart / reach + pace / (unit * slow) + swerved) * UP < near and turn < MOST_TURN):
        return None
    pull = dx * ax + dy * ay if bend else 0.0
    return Collision(steep, apart, turn, dx, dy, vx, vy, speed, strength, pull)


def fall_derivative(
    nx: float,
    ny: float,
    speed: float,
    strength: float,
    pull: float,
    unit: float,
    place: float,
    pace: float,
    near: float,
) -> Collision | None:
    """The derivative of the hit of a wall that falls or moves, or None where the truth may be too far.

    Args:
        nx, ny: the normal.
        speed: -n.v at the hit, relative to the wall, from midpoints, rounded.
        strength: -(1 + e) / |n|^2; 0 where it is not to be had.
        pull: n.g.
        unit, place, pace, near: as `pair_derivative` has them; of the place of the circle.

    The instant moves by -n.(dp + tau dv) / n.v, and n.v by n.dv and by n.g times that (docs/studies/law_proofs.py).
    What is asked is that this is less than `near` of it, as n.v is all of the derivative that a deviation changes.

    >>> hit = fall_derivative(0.0, 1.0, 2.0, -2.0, -4.0, 1.0, 1e-20, 1e-20, CLOSE)
    >>> 2.0 <= hit.turn < 2.001, 0.5 <= hit.steep < 0.501
    (True, True)
    >>> fall_derivative(0.0, 1.0, 2.0, -2.0, -4.0, 1.0, 1e-15, 1e-20, CLOSE) is None
    True
    """
    size = sqrt(nx * nx + ny * ny)
    if not (strength < 0.0 and LEAST < speed < inf and abs(pull) < inf):
        return None
    steep, bend = size / speed * UP, abs(pull) / speed * UP
    turn = bend * unit * (-strength * size * size / 2.0) * UP
    if not (steep * (pace / unit + bend * place) * UP < near and turn < MOST_TURN):
        return None
    return Collision(steep, place, turn, nx, ny, 0.0, 0.0, speed, strength, pull)


def wall_steepness(nx: float, ny: float, vx: float, vy: float) -> float:
    """By how much, at most, the hit of a wall moves for a deviation of one in the place; infinite where not known.

    >>> wall_steepness(0.0, 2.0, 3.0, -4.0) >= 0.25
    True
    """
    speed, size = -(nx * vx + ny * vy), abs(nx) + abs(ny)
    return size / speed * STEEPER if speed > FLAT * size * (abs(vx) + abs(vy)) and speed > LEAST else inf
