"""How far aside of a thing of faces and ends a straight flight passes; or how far it is from passing it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple, TypeAlias

from flint import arb

from ...exact.laws.formulas import pair_approach, wall_approach
from ...exact.numbers import ball
from ...exact.replay.wall_flights import SeenWall

# -- Seen along the flight, a face, moved out by the circle's radius, covers a stretch of what lies across, and so does
# an end with both radii; the flight meets the thing where one of them covers it. It passes the thing once it is moved
# out of all that these cover together. What lies behind, or recedes, is never met: a circle in a notch of a thing that
# is not convex leaves it without meeting what it covers behind.

Way: TypeAlias = tuple[arb, arb, arb, arb]
"""x, y, vx, vy of a circle's centre, which moves."""


class AsideSpan(NamedTuple):
    """What a face or an end covers of a line across a flight, by how far aside of it.

    Attributes:
        low, high: from where to where.
        low_at, high_at: how far ahead these two are.
        end: which end it is; None of a face.
    """

    low: arb
    high: arb
    low_at: float = 0.0
    high_at: float = 0.0
    end: int | None = None


class Passed(NamedTuple):
    """How far aside a flight passes, negative where it has to be moved to pass; and how far ahead that is decided."""

    aside: arb
    ahead: float


def middle(value: arb) -> float:
    """The double at the middle of a ball."""
    return float(value.mid())


def stretches(
    way: Way, r: arb, lines: Iterable[SeenWall[arb]], ends: Iterable[tuple[int, arb, arb, arb]]
) -> list[AsideSpan]:
    """What the faces and ends of a thing cover, of what is ahead and approached.

    Args:
        way: the flight.
        r: the circle's radius.
        lines: the faces.
        ends: number, x, y and radius of the ends.

    >>> [seen] = stretches((arb(0), arb(0), arb(2), arb(0)), arb(1), [], [(7, arb(5), arb(3), arb(1))])
    >>> float(seen.low), float(seen.high), seen.end
    (1.0, 5.0, 7)
    """
    x, y, vx, vy = way
    speed = ball.root(vx * vx + vy * vy)
    found: list[AsideSpan] = []
    for line in lines:
        if not middle(wall_approach(vx, vy, line.nx, line.ny)) < 0.0:
            continue
        dx, dy = line.x0 + line.nx * r / line.length - x, line.y0 + line.ny * r / line.length - y
        places = [(dx, dy), (dx + line.ny, dy - line.nx)]  # of both its points, from the circle's centre
        along = [(px * vx + py * vy) / speed for px, py in places]
        aside = [(py * vx - px * vy) / speed for px, py in places]
        back = [middle(one + r) < 0.0 for one in along]  # what is nearer than its radius may be so by rounding
        if all(back):
            continue
        for k in (0, 1):
            if back[k]:
                share = (along[1 - k] + r) / (along[1 - k] - along[k])
                aside[k] = aside[1 - k] + share * (aside[k] - aside[1 - k])
                along[k] = -r
        (low, first), (high, last) = sorted(zip(aside, along, strict=True), key=lambda place: middle(place[0]))
        found.append(AsideSpan(low, high, middle(first), middle(last)))
    for end, ex, ey, radius in ends:
        dx, dy = ex - x, ey - y
        if middle(pair_approach(dx, dy, -vx, -vy)) < 0.0:
            off, ahead = (dy * vx - dx * vy) / speed, middle((dx * vx + dy * vy) / speed)
            found.append(AsideSpan(off - r - radius, off + r + radius, ahead, ahead, end))
    return found


def out_of(covered: Sequence[AsideSpan]) -> Passed | None:
    """How far 0 is from what some stretches cover together, or from the nearer end of what covers it.

    None of no stretches.

    >>> three = [AsideSpan(arb(-3), arb(-1)), AsideSpan(arb(-2), arb(1)), AsideSpan(arb(5), arb(6))]
    >>> float(out_of(three).aside), float(out_of(three[2:]).aside), out_of([])
    (-1.0, 5.0, None)
    """
    joined: list[AsideSpan] = []
    for one in sorted(covered, key=lambda stretch: (middle(stretch.low), stretch.low_at)):
        last = joined[-1] if joined else None
        if last is None or middle(one.low) > middle(last.high):
            joined.append(one)
        else:
            farther = max(last, one, key=lambda stretch: (middle(stretch.high), -stretch.high_at))
            joined[-1] = last._replace(high=last.high.max(one.high), high_at=farther.high_at)
    sides = [Passed(s.low.max(-s.high), s.low_at if middle(s.low) > middle(-s.high) else s.high_at) for s in joined]
    return min(sides, key=lambda passed: middle(passed.aside), default=None)
