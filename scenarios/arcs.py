"""What a circle meets of arcs: the outside and the hollow inside of part of a circle, and the two ends."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from .errors import SceneError
from .neighbours import shown_amount
from .numbers.quantity import Quantity
from .things import Arc, Circle, Point

# -- An arc is the part of a circle of radius r about (x, y) that lies between two directions e0 and e1 of length 1,
# counter-clockwise from the first; it has no thickness. With D the way from (x, y) to the centre of a disc of radius
# rho, the point of the arc that is nearest to the disc's centre is r D / |D| where that is on the arc, and one of its
# two ends where it is not: of a full circle, and of a part of any length. So the disc meets
#
# - the outside, where it comes to |D| = r + rho from above, with D within the range;
# - the inside, where it comes to |D| = r - rho from below, with D within the range; it has one only where rho < r;
# - an end, as a fixed circle of radius 0: it owns what is at the very bounds of the range, which is open.
#
# The range is one sign. The arc is what of its circle lies beyond the chord through its ends: with u = e1 - e0 and
# n = (u_y, -u_x), a direction e is within it exactly where n.e > n.e0, be it less than a half-turn, more, or just that.
# At a contact |D| is known, it is R = r + rho or r - rho, so that e = D / R and the sign is that of n.D - (n.e0) R.
#
# An inside has the radius -r, as hollow mirrors have: the sum of the radii of the two is then -R, and its square root
# of the discriminant has its sign, which makes the earlier zero of the gap the later one.


@dataclass(frozen=True)
class ArcSide:
    """One side of an arc, as engines see it.

    Attributes:
        x, y: the circle's centre.
        r: its radius, negative for the hollow side.
        nx, ny, h: see `Arc.chord`.
        id: the arc's.
        full: whether there is no range.
    """

    x: Quantity
    y: Quantity
    r: Quantity
    nx: Quantity
    ny: Quantity
    h: Quantity
    id: str | None
    full: bool


@dataclass(frozen=True)
class NearSide:
    """A side of an arc in doubles.

    Attributes:
        x, y: the middle of its circle.
        r: its radius, negative for the hollow side.
        ends: the directions from the middle in which it begins and ends, counter-clockwise; none of a full circle.
        normal, edge: see `Arc.chord`.
    """

    x: float
    y: float
    r: float
    ends: tuple[tuple[float, float], ...]
    normal: tuple[float, float]
    edge: float

    @staticmethod
    def both(arc: Arc) -> tuple[NearSide, NearSide]:
        """The outside and the hollow one.

        >>> from truebreak.scenarios import Arc
        >>> outside, hollow = NearSide.both(Arc(1, 2, 5, 6, 2, 1, 7))
        >>> hollow.r, hollow.ends, hollow.within(3.0, 4.0, 5.0) > 3.1, hollow.within(-4.0, 0.0, 4.0) < 0
        (-5.0, ((1.0, 0.0), (0.0, 1.0)), True, True)
        """
        x, y, r = float(arc.x), float(arc.y), float(arc.r)
        ends = () if arc.full else tuple((float(ex), float(ey)) for ex, ey in arc.directions)
        nx, ny, edge = map(float, arc.chord)
        outside = NearSide(x, y, r, ends, (nx, ny), edge)
        return outside, replace(outside, r=-r)

    def within(self, dx: float, dy: float, reach: float) -> float:
        """How far a place, d from the middle and as far as `reach`, is from where the side ends; below 0 beyond it."""
        if not self.ends:
            return math.inf
        least = min(math.hypot(dx - reach * ex, dy - reach * ey) for ex, ey in self.ends)
        return least if self.normal[0] * dx + self.normal[1] * dy > self.edge * math.hypot(dx, dy) else -least


def arc_sides(arcs: Iterable[Arc]) -> Iterator[ArcSide]:
    """The outside and the inside of each arc, in this order: an odd index is a hollow side.

    >>> [side.r.text() for side in arc_sides([Arc(0, 0, 2, full=True)])]
    ['2', '-2']
    """
    for arc in arcs:
        for r in (arc.r, -arc.r):
            yield ArcSide(arc.x, arc.y, r, *arc.chord, id=arc.id, full=arc.full)


def check_arcs(
    circles: Sequence[Circle], arcs: Sequence[Arc], ends: Sequence[Circle]
) -> tuple[list[tuple[int, int]], list[tuple[int, int, bool]]]:
    """Refuses arcs that lie on each other, and circles that lie across an arc or fit it all along.

    Args:
        ends: of the scene, as `surfaces.ends_of` gives them.

    Returns:
        The pairs at gap zero: circles with arcs, by index; circles with a side of an arc or, where that is so, with an
        end, by index among each.

    Raises:
        SceneError: naming both, and the remedy.

    >>> check_arcs([Circle(2, 0), Circle(0, 0)], [Arc(0, 0, 3, full=True)], [])
    ([(0, 0)], [(0, 1, False)])
    """
    for k, arc in enumerate(arcs):
        for other in arcs[:k]:
            if _overlap(arc, other):
                raise SceneError(f"arc {arc.id!r}: lies on arc {other.id!r}; make them one")
    places = {(end.x, end.y): k for k, end in enumerate(ends)}
    outer: list[tuple[int, int]] = []
    inner: list[tuple[int, int, bool]] = []
    for i, circle in enumerate(circles):
        if circle.fixed:
            continue
        for k, arc in enumerate(arcs):
            if circle.r == arc.r and _fits(circle, arc):
                told = f"circle {circle.id!r}: r = {circle.r.brief()} is that of arc {arc.id!r}"
                raise SceneError(f"{told}, which it fits all along, with no one normal; change one of them")
            parts = _touched(circle, arc)
            outer += [(i, k)] * bool(parts)
            inner += ((i, 2 * k + x, False) if isinstance(x, int) else (i, places[x], True) for x in parts)
    return outer, inner


def _fits(circle: Circle, arc: Arc) -> bool:
    """Whether a circle as wide as an arc lies on it all along, or may come to: by the opening of a half-turn or less.

    What is longer than that has an opening narrower than the circle, which meets its ends.
    """
    return (circle.x, circle.y) == (arc.x, arc.y) or (not arc.full and arc.chord[2].sign() >= 0)


def _touched(circle: Circle, arc: Arc) -> list[int | Point]:
    """The side that a circle touches, 0 or 1 for the hollow one, or the end, or both ends of a small opening.

    Raises:
        SceneError: where they overlap.
    """
    dx, dy = circle.x - arc.x, circle.y - arc.y
    square = dx * dx + dy * dy
    away = square.sqrt()
    parts: list[int | Point]
    nx, ny, h = arc.chord
    if arc.full or (away.sign() > 0 and (nx * dx + ny * dy - h * away).sign() > 0):
        gap = away - arc.r
        parts = [int(gap.sign() <= 0)]
        distance = abs(gap)
    elif away.sign() == 0:
        parts = [1]
        distance = arc.r
    else:
        squares = [(circle.x - x) * (circle.x - x) + (circle.y - y) * (circle.y - y) for x, y in arc.ends]
        nearer = (squares[1] - squares[0]).sign()  # 0 where both ends are as near
        parts = [end for end, sign in zip(arc.ends, (nearer, -nearer), strict=True) if sign >= 0]
        distance = squares[nearer < 0].sqrt()
    if distance.sign() == 0:
        raise SceneError(f"circle {circle.id!r}: its centre lies on arc {arc.id!r}; move it to one side")
    apart = distance - circle.r
    if apart.sign() < 0:
        overlap = shown_amount(-apart)
        told = f"circle {circle.id!r}: lies across arc {arc.id!r}, by {overlap} at time 0"
        raise SceneError(f"{told}; move it, or reduce r")
    return parts if apart.sign() == 0 else []


def _overlap(a: Arc, b: Arc) -> bool:
    """Whether two arcs are of one circle and have more than points in common.

    Either one of them begins within the other, or they begin in one direction.
    """
    if (a.x, a.y, a.r) != (b.x, b.y, b.r):
        return False
    if a.full or b.full:
        return True
    return a.directions[0] == b.directions[0] or _begins_within(a, b) or _begins_within(b, a)


def _begins_within(a: Arc, b: Arc) -> bool:
    (ex, ey), (nx, ny, h) = a.directions[0], b.chord
    return (nx * ex + ny * ey - h).sign() > 0
