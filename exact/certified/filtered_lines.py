"""Walls and faces in doubles; those that fall or move, and when a circle meets them, with a bound on every rounding."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from math import inf, isfinite, sqrt
from typing import NamedTuple

from flint import arb

from ..compiled import Doubles, predictions
from ..simulation.prediction import FloatLine

# -- A state's doubles, and its walls', are off by at most 2u relatively: see filtered.py, which has u, S, V and the
# bounds of walls that stand.

UNIT = 2.0**-53

ACCURATE_BITS = 60
"""A ball with this relative accuracy has a radius below 2**-58 of its middle: u/32 at most."""

BIG = 1e50
"""Beyond this, or its inverse, fourth powers and quotients of bounds might overflow or vanish: left to balls."""

TINY = 1 / BIG


def float_line(wall: int, x0: arb, y0: arb, nx: arb, ny: arb, offset: arb) -> FloatLine:
    """The doubles of a wall's short balls. Where these cannot tell the wall, its normal and its size are infinite, and
    nothing is ever clear: neither that a circle meets it nor that it flies away from it."""
    fx0, fy0, fnx, fny, fixed = (float(value) for value in (x0, y0, nx, ny, offset))
    norm = abs(fnx) + abs(fny)
    size = norm * (abs(fx0) + abs(fy0)) + abs(fixed)
    sharp = all(value.rel_accuracy_bits() > ACCURATE_BITS for value in (x0, y0, nx, ny, offset))
    if not (sharp and size < BIG and 1 / BIG < norm < BIG):
        norm = size = inf
    return FloatLine(wall, fx0, fy0, fnx, fny, fixed, norm, size)


# -- Walls that fall, or move, and faces under gravity.
#
# In the frame that falls, s after a circle's clock t, the gap is g + a s + k s^2, with k half of n.g, m = n.u, and
#
#     g = n.(x - p) - r |n| + (k t - m) t,    a = n.v + 2 k t - m
#
# - k t - m is off by 6u |k| t + 3u |m|: 2u from each number, a rounding of the product and one of the difference;
#   times t, and with the last sum, by 10u |k| t^2 + 6u |m| t. The rest of g is off by less than 9u of its terms. The
#   bound is 32u of all terms.
# - a is off by less than 7u of its terms, n.v, 2 k t and m, in the same way: the bound is 16u of them.
# - D = a^2 - 4 k g is off by 2 |a| times what a is, the square of that, 4 |k| times what g is, and under 4u of its two
#   terms: the bound is twice that, with 8u. Where D is more than four times its bound its root is off by less than
#   the bound over that root: by 1 / 1.8 of it, and a rounding.
# - D, the square of the speed at the line, is the same number at the instant as at the clock. The other of the two
#   zeros is of the other sign of that speed.
# - The zero at which the gap falls is 2 g / (sqrt(D) - a), or (-a - sqrt(D)) / (2 k), whichever does not cancel; in
#   each the numerator's and the denominator's bounds add up, over a denominator that is known to an eighth.
#
# The flight begins at its instant, `late` from its clock at most: a differs there by 2 |k| `late`, g by (|a| + |k|
# `late`) `late`; both are taken twice. A circle that touches the wall at the instant, and comes back to it by the pull
# alone, does so -a/k - `late` after its clock: the two zeros add up to -a/k, and the other is the instant.
#
# Which zero is to come, and what of the signs tells that there is none, is as in `Predictor._fall`, and of faces as in
# `arc_meetings.fall_to_face`. Where along a face the line is met is off by what the place and the speed along it are
# off, as above, and by what the wait is off, over the speed then; products and sums are rounded by 8u of them: twice
# taken.


class FloatFall(NamedTuple):
    """A wall that falls or moves, or a face under gravity, as seen from a circle, in doubles.

    Attributes:
        wall: which it is.
        other: the other side of a segment; -1 without.
        is_face: whether it ends.
        x0, y0, nx, ny, offset: a point at time 0, a normal, r*|n|.
        norm, size: the normal's 1-norm, and the size of the fixed terms of the gap; infinite where nothing is clear.
        half: half of n.g, whose sign is true: negative where gravity pulls towards it.
        drift: n.u, of its velocity.
        bend: half of gravity along it, in the scale of `formulas.face_along`.
    """

    wall: int
    other: int
    is_face: bool
    x0: float
    y0: float
    nx: float
    ny: float
    offset: float
    norm: float
    size: float
    half: float
    drift: float
    bend: float


def float_fall(
    line: FloatLine,
    other: int,
    is_face: bool,
    pulls: tuple[arb, arb, arb],
    zeros: tuple[bool, bool, bool],
    sign: int,
) -> FloatFall:
    """A wall that falls or moves, of its doubles as it stands.

    Args:
        line: as `float_line` gives it.
        other, is_face: see `FloatFall`.
        pulls: half of n.g, n.u, and half of gravity along the line.
        zeros: which of these are zero.
        sign: whether gravity pulls towards it (negative), along it (0), or away.
    """
    half, drift, bend = (0.0 if zero else float(value) for value, zero in zip(pulls, zeros, strict=True))
    norm, size = line.norm, line.size
    for value, told, zero in zip(pulls, (half, drift, bend), zeros, strict=True):
        if not (zero or (value.rel_accuracy_bits() > ACCURATE_BITS and TINY < abs(told) < BIG)):
            norm = size = inf
    if size == inf:
        half = float(sign)
    return FloatFall(line.wall, other, is_face, *line[1:6], norm, size, half, drift, bend)


def falls_in_doubles(
    flight: Doubles, lines: Sequence[FloatFall], flat: float, far: float, stands: Collection[int]
) -> tuple[list[tuple[float, float, int]], list[int]]:
    """Which of several walls that fall or move, or faces under gravity, a circle hits whose flight is new.

    Args:
        flight: its doubles.
        lines: the walls and faces.
        flat, far: see `DoubleFilter.wall_bounds`.
        stands: those that it touches as its flight begins, and does not approach.

    Returns:
        Bounds of the time, and the wall; and those that are unclear.
    """
    if predictions is not None:
        return predictions.falls(flight, lines, flat, far, tuple(stands))
    found: list[tuple[float, float, int]] = []
    unclear: list[int] = []
    for line in lines:
        if line.other in stands:
            continue
        told = fall_in_doubles(flight, line, flat, far, line.wall in stands)
        if isinstance(told, bool):
            if told:
                unclear.append(line.wall)
        else:
            found.append((*told, line.wall))
    return found, unclear


def fall_in_doubles(
    flight: Doubles, line: FloatFall, flat: float, far: float, stands: bool
) -> tuple[float, float] | bool:
    """When a circle meets a wall that falls or moves: bounds; False where it does not, True where that is unclear."""
    x, y, vx, vy, t, late = flight
    _, _, is_face, x0, y0, nx, ny, offset, norm, size, half, drift, bend = line
    lift = half * t
    gap = nx * (x - x0) + ny * (y - y0) - offset + (lift - drift) * t
    speed = nx * vx + ny * vy + (2.0 * lift - drift)
    grown = abs(lift) + abs(drift)
    blur = norm * flat + 32 * UNIT * grown
    blur_gap = 32 * UNIT * size + norm * far + 32 * UNIT * grown * t
    turn = blur + 4.0 * abs(half) * late
    if stands:
        if half >= 0.0:
            return False
        if not speed > 8.0 * turn:
            return True
        wait = speed / -half
        blur_wait = blur / -half + late + 8 * UNIT * wait
    else:
        early = blur_gap + 2.0 * (abs(speed) + turn) * late
        if half >= 0.0 and speed > turn:
            return False
        if is_face and gap < -early and (half >= 0.0 or speed < -turn):
            return False
        if half == 0.0:
            if not (speed < -8.0 * turn and gap > early):
                return True
            wait = gap / -speed
            blur_wait = (blur_gap + wait * blur) / -speed + 8 * UNIT * wait
        else:
            depth = 4.0 * half * gap
            square = speed * speed
            disc = square - depth
            blur_disc = (2.0 * abs(speed) + blur) * blur + 4.0 * abs(half) * blur_gap
            blur_disc = 2.0 * (blur_disc + 8 * UNIT * (square + abs(depth)))
            if disc < -blur_disc and (is_face or half > 0.0):
                return False
            if not disc > 4.0 * blur_disc:
                return True
            if not (gap > early and (half < 0.0 or speed < -turn)) and not (is_face and half < 0.0 and speed > turn):
                return True
            root = sqrt(disc)
            blur_root = blur_disc / root + 4 * UNIT * root
            if speed < 0.0:
                fast = root - speed
                blur_fast = blur_root + blur + 2 * UNIT * fast
                if not fast > 8.0 * blur_fast:
                    return True
                wait = 2.0 * gap / fast
                blur_wait = (2.0 * blur_gap + wait * blur_fast) / fast + 8 * UNIT * wait
            else:
                wait = (speed + root) / (-2.0 * half)
                blur_wait = (blur + blur_root) / (-2.0 * half) + 8 * UNIT * wait
    time = t + wait
    blur_time = 2.0 * blur_wait + 8 * UNIT * (t + wait)
    if not (wait > blur_time + late) or not isfinite(time):
        return True
    if is_face:
        along, slide = (x - x0) * ny - (y - y0) * nx + bend * t * t, vx * ny - vy * nx + 2.0 * bend * t
        arch = bend * wait
        foot, beyond = along + (slide + arch) * wait, nx * nx + ny * ny
        tilt = abs(bend) * t
        blur_slide = norm * flat + 32 * UNIT * tilt
        blur_foot = 32 * UNIT * (size + tilt * t) + norm * far + wait * blur_slide
        fast = abs(slide) + blur_slide + 2.0 * abs(arch) + 2.0 * abs(bend) * blur_time
        blur_foot += fast * 2.0 * blur_wait
        blur_foot = 2.0 * blur_foot + 16 * UNIT * (abs(along) + (abs(slide) + abs(arch)) * wait + beyond)
        if foot < -blur_foot or foot > beyond + blur_foot:
            return False
        if not (foot > blur_foot and foot < beyond - blur_foot):
            return True
    return time - blur_time, time + blur_time
