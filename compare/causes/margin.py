"""How close the two competing events at a divergence were, in the reference's own exact motion."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import mpmath

from ..alignment.divergence import Kind

if TYPE_CHECKING:
    from ...scenarios.trajectory import State, Trajectory
    from ..alignment.divergence import Divergence

DIGITS = 120
"""Decimal digits of the arithmetic here: gaps of 10**-40 come out to 80 digits."""


@dataclass(frozen=True)
class Margin:
    """What decided between the expected and the got event, at the divergence.

    Attributes:
        gap: the time between the two in the reference's motion, taken as if neither hindered the other;
            None if only one of the two would come to pass there.
        ulps: the same in units of a double's spacing at that time: an engine of doubles cannot tell events
            apart that are nearer than about one.
        miss: where one of them is a matter of hit or miss, by what distance: positive for a miss, negative
            for the depth of the hit.
    """

    gap: float | None
    ulps: float | None
    miss: float | None = None


def margin(reference: Trajectory, divergence: Divergence) -> Margin:
    """The margin of a divergence, from the reference's state just before it, in 120 digits.

    From that state all fly freely: the time at which the body would meet the expected partner, the time at
        which
    it would meet the one that it got, and by how much it would miss one of them.
    """
    index = divergence.event
    if divergence.kind is Kind.TIE and divergence.expected and " + " in divergence.expected:
        return Margin(0.0, 0.0)
    before = _state_before(reference, min(index, len(reference.events)))
    with mpmath.workdps(DIGITS):
        expected = _meeting(reference, before, divergence.body, divergence.expected)
        got = _meeting(reference, before, divergence.body, divergence.got)
        if divergence.kind is Kind.TIE and divergence.expected:
            names = divergence.expected.split(" then ")
            expected = _meeting(reference, before, divergence.body, names[0])
            got = _meeting(reference, before, divergence.body, names[-1])
        times = [m[0] for m in (expected, got) if m is not None and m[0] is not None]
        misses = [m[1] for m in (expected, got) if m is not None and m[1] is not None]
        gap = abs(times[0] - times[1]) if len(times) == 2 else None
        if gap is None:
            return Margin(None, None, float(max(misses)) if misses else None)
        ulp = math.ulp(max(abs(divergence.time), math.ulp(0.0)))
        return Margin(float(gap), float(gap / ulp))


def _state_before(reference: Trajectory, index: int) -> State:
    """The state that the event before an event leaves; after a reversal between them, the one that that
    leaves."""
    if reference.reversal is not None and reference.reversal.after == index:
        return reference.at(reference.reversal.time)
    return reference.at(reference.events[index - 1].time if index else 0)


def precise(value: Any) -> Any:
    """An engine's number in mpmath, to the digits at work where the engine knows them.

    >>> precise(0.5)
    mpf('0.5')
    """
    if hasattr(value, "ball"):
        middle = value.ball(int(mpmath.mp.prec)).mid()
        mantissa, exponent = middle.man_exp()
        return mpmath.ldexp(mpmath.mpf(int(mantissa)), int(exponent))
    if hasattr(value, "free_symbols"):
        return mpmath.mpf(value.evalf(mpmath.mp.dps)._mpf_)
    if isinstance(value, int | float):
        return mpmath.mpf(value)
    return mpmath.mpf(float(value))


def _meeting(reference: Trajectory, state: State, body: str, partner: str | None) -> tuple[Any, Any] | None:
    """In free flight from a state: the time until two touch (or None), and the least gap between them."""
    if partner is None:
        return None
    scene = reference.scene
    circles = {str(c.id): c for c in scene.circles}
    a = state[body]
    x, y, vx, vy = (precise(v) for v in (a.x, a.y, a.vx, a.vy))
    own = precise(circles[body].r)
    if partner in circles:
        b = state[partner]
        bx, by, bvx, bvy = (precise(v) for v in (b.x, b.y, b.vx, b.vy))
        return _pair(bx - x, by - y, bvx - vx, bvy - vy, own + precise(circles[partner].r))
    wall = next((w for w in scene.walls if w.id == partner), None)
    if wall is None:
        return None
    nx, ny = (precise(n) for n in wall.normal)
    length = mpmath.sqrt(nx * nx + ny * ny)
    height = (nx * (x - precise(wall.x0)) + ny * (y - precise(wall.y0))) / length
    speed = (nx * vx + ny * vy) / length
    gap = abs(height) - own
    closing = -speed if height > 0 else speed
    return (gap / closing, None) if closing > 0 else (None, gap)


def _pair(dx: Any, dy: Any, vx: Any, vy: Any, reach: Any) -> tuple[Any, Any]:
    """Touch time of two circles in the stable form, and least distance less the sum of radii."""
    approach, speed2 = dx * vx + dy * vy, vx * vx + vy * vy
    if approach >= 0:
        return None, mpmath.sqrt(dx * dx + dy * dy) - reach
    cross = dx * vy - dy * vx
    least = abs(cross) / mpmath.sqrt(speed2) - reach
    discriminant = speed2 * reach * reach - cross * cross
    if discriminant < 0:
        return None, least
    gap = dx * dx + dy * dy - reach * reach
    return gap / (-approach + mpmath.sqrt(discriminant)), least
