"""The deviations of midpoints, carried through a contact that stands alone; compiled, where there was a compiler.

What comes out is the same: a power of two that bounds all errors of the instant, what is beside the clock, and for each
body a `Landing`. None, with nothing changed, where the truth may be too far from the midpoints for a derivative.
"""

from __future__ import annotations

from math import frexp, ldexp
from typing import TypeAlias

from flint import arb

from ...compiled import steps
from ..ball_state import BallState
from ..body import FAINT, Doubles, Midpoints
from ..centred.deviations import Deviations, Face, Moved
from ..centred.errors import MOST, UP, Spent
from ..contact import AtWall, Pair

PLAIN = 2.0**-100
"""Numbers beyond this, with a radius of at most 2**FAINT, less than 2**-140 of them, are told by the doubles of their
midpoints, and by short balls around these."""

Landing: TypeAlias = tuple[Midpoints[arb], int, int, Doubles | None]
"""Of one body: its new midpoints, powers of two that bound how far its place and its velocity are off, and its doubles;
None where they do not tell it."""

Carried: TypeAlias = tuple[int, float, tuple[Landing, ...]]
"""Of a contact: a power of two that bounds all errors of the instant, a bound of the time between that and the clock,
and what becomes of each body."""


def carry_pair(
    held: Deviations,
    state: BallState,
    link: Pair,
    met: tuple[arb, arb, arb, arb, arb],
    since: tuple[arb, arb],
    late: arb,
    moved: tuple[Moved, Moved],
    clock: arb,
    last: int,
) -> Carried | None:
    """Through a collision of two circles.

    Args:
        held: the deviations.
        state: whose circles they are.
        link: the two.
        met: d, v and -d.v at the hit.
        since: how long each has flown to the clock.
        late: the time from the clock to the hit.
        moved: the two, with numbers around their new midpoints.
        clock, last: of their new flights.

    Raises:
        Spent: if the deviations are too large after it: the set is not to be used any more.
    """
    i, j = held.place[link[0]], held.place[link[1]]
    weights = held.weights[link[0]], held.weights[link[1]]
    if steps is not None:
        (_, *a), (_, *b) = moved
        strength, near, least = held.strength(state, link), held.near_time, held.time_power
        told = steps.bounce(
            held.errors, i, j, met, *since, strength, weights, late, near, tuple(a), tuple(b), clock, last, least
        )
        if told is False:
            raise Spent
        return told
    beside, unit = float(late.abs_upper()) * UP, held.unit
    lags = float(since[0]) / unit, float(since[1]) / unit
    found = held.collision(state, link, met, i, j, lags, beside)
    if found is None:
        return None
    hit, spread = found
    rounding, doubles = held.recentre(moved, clock, last)
    held.errors.meet(i, j, lags, weights, hit, rounding)
    return _landed(held, moved, doubles, spread, beside, clock)


def carry_wall(
    held: Deviations,
    link: AtWall,
    face: Face,
    since: arb,
    velocity: tuple[arb, arb],
    late: arb,
    moved: Moved,
    clock: arb,
    last: int,
) -> Carried | None:
    """Through the impact of a circle on a wall.

    Args:
        held: the deviations.
        link: the two.
        face: the wall, as the circle comes to it.
        since: how long it has flown to the clock.
        velocity: with which it came.
        late: the time from the clock to the hit.
        moved: the circle, with numbers around its new midpoints.
        clock, last: of its new flight.

    Raises:
        Spent: as `carry_pair`.
    """
    i = held.place[link[0]]
    if steps is not None:
        _, *a = moved
        near, least = held.near_time, held.time_power
        told = steps.rebound(held.errors, i, since, velocity, face, late, near, tuple(a), clock, last, least)
        if told is False:
            raise Spent
        return told
    beside, lag = float(late.abs_upper()) * UP, float(since) / held.unit
    spread = held.wall_time(face, i, lag, float(velocity[0]), float(velocity[1]), beside)
    if spread is None:
        return None
    rounding, doubles = held.recentre((moved,), clock, last)
    held.errors.fly(i, lag, face.mirror, rounding)
    return _landed(held, (moved,), doubles, spread, beside, clock)


def _landed(
    held: Deviations,
    moved: tuple[Moved, ...],
    doubles: list[tuple[float, float, float, float]],
    spread: float,
    beside: float,
    clock: arb,
) -> Carried:
    """What becomes of a contact that has been carried.

    Args:
        held: the deviations.
        moved: the bodies.
        doubles: their midpoints.
        spread: a bound of all errors of the instant, as the set counts it.
        beside: of the time from the clock to it.
        clock: of their new flights.
    """
    now = float(clock)
    bounds, shift, place = held.errors.bounds, held.errors.shift, held.place
    if not spread + bounds.both(place[moved[0][0].index]) + bounds.both(place[moved[-1][0].index]) < MOST:
        raise Spent
    power = frexp(spread)[1] + shift
    beside = (beside + ldexp(1.0, power if power > -1000 else -1000)) * UP
    landed: list[Landing] = []
    for (body, *_), (fx, fy, fvx, fvy) in zip(moved, doubles, strict=True):
        i = place[body.index]
        far, fast = frexp(bounds.place[i])[1] + shift, frexp(bounds.pace[i])[1] + shift - held.time_power
        told = (
            far < FAINT
            and fast < FAINT
            and (fx > PLAIN or fx < -PLAIN)
            and (fy > PLAIN or fy < -PLAIN)
            and (fvx > PLAIN or fvx < -PLAIN)
            and (fvy > PLAIN or fvy < -PLAIN)
        )
        landed.append((held.mid[body.index], far, fast, (fx, fy, fvx, fvy, now, beside) if told else None))
    return power, beside, tuple(landed)
