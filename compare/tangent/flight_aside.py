"""How far aside of a thing of faces, ends and arcs a flight passes, or is from it; and what one that falls meets."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import hypot, inf
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from flint import arb

from ...exact.laws.formulas import (
    fall_discriminant,
    fall_time,
    fall_time_back,
    pair_approach,
    pair_discriminant,
    wall_approach,
)
from ...exact.numbers import ball
from ...exact.replay.landings import told_falling_zero
from ...exact.replay.round_falls import RoundFall, horner
from ...exact.replay.wall_flights import SeenWall
from ...scenarios.lazy import Later

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
else:
    np = Later("numpy")

# -- Seen along the flight, a face, moved out by the circle's radius, covers a stretch of what lies across, and so does
# an end with both radii; the flight meets the thing where one of them covers it. It passes the thing once it is moved
# out of all that these cover together. What lies behind, or recedes, is never met: a circle in a notch of a thing that
# is not convex leaves it without meeting what it covers behind. A side of an arc covers what its contacts have aside of
# the flight: of the outside those where it comes in, of the hollow side those where it goes out.

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


class Passing(NamedTuple):
    """A circle that hits a thing with ends.

    Attributes:
        depth: how far aside its flight would have to be for it to pass the thing.
        wait: how long after the impact it would be beside the end that it would pass.
    """

    depth: float
    wait: float


ON_IT = 2.0**-40
"""A share of the coordinates: a centre no farther from an arc is on it, and on the side that its flight leads to."""


class RoundSide(NamedTuple):
    """A side of an arc as a circle may meet it.

    Attributes:
        x, y, radius: of the arc's circle.
        r: the circle's radius.
        hollow: whether it is the inside.
        ends: where it begins and ends, counter-clockwise; none of a full circle.
    """

    x: arb
    y: arb
    radius: arb
    r: arb
    hollow: bool
    ends: tuple[tuple[arb, arb], ...] = ()

    @property
    def reach(self) -> arb:
        """How far the centres are apart at a contact; for the hollow side no more than 0 where there is no room."""
        return self.radius - self.r if self.hollow else self.radius + self.r

    def _faces(self, ux: float, uy: float) -> bool:
        """Whether a direction from the middle leads to it."""
        if not self.ends:
            return True
        (ax, ay), (bx, by) = ((middle(x - self.x), middle(y - self.y)) for x, y in self.ends)
        nx, ny = by - ay, ax - bx
        return nx * ux + ny * uy > (nx * ax + ny * ay) * hypot(ux, uy) / hypot(ax, ay)

    def _ahead(self, way: Way) -> bool:
        """Whether a flight may come to it: to the outside from outside, to the inside from within or by the opening."""
        x, y, vx, vy = map(middle, way)
        dx, dy, radius = middle(self.x) - x, middle(self.y) - y, middle(self.radius)
        far, along = hypot(dx, dy), dx * vx + dy * vy
        room = ON_IT * (abs(x) + abs(y) + far + radius)
        inside = far < radius - room or (abs(far - radius) <= room and along > 0.0)
        if self.hollow:
            return middle(self.reach) > 0.0 and (inside or along > 0.0)
        return not inside and along > 0.0

    def waits(self, way: Way) -> tuple[arb, arb] | None:
        """How long until a flight touches it, and until it would have left it; None where it does not come to it.

        >>> ring = RoundSide(arb(0), arb(0), arb(5), arb(1), True)
        >>> [float(wait) for wait in ring.waits((arb(0), arb(0), arb(2), arb(0)))]
        [2.0, 3.0]
        """
        if not self._ahead(way):
            return None
        x, y, vx, vy = way
        dx, dy, square = self.x - x, self.y - y, vx * vx + vy * vy
        approach = pair_approach(dx, dy, -vx, -vy)
        discs = [pair_discriminant(dx, dy, -vx, -vy, reach) for reach in (self.reach, self.radius + self.r)]
        if ball.sign_of(discs[0]) in (-1, 0):
            return None
        first, over = map(ball.root, discs)
        enter, leave = (first if self.hollow else -first) - approach, over - approach
        wait = enter / square
        if not self._faces(middle(wait * vx - dx), middle(wait * vy - dy)):
            return None
        inner = self.radius - self.r
        if not self.hollow and middle(inner) > 0.0:
            through = pair_discriminant(dx, dy, -vx, -vy, inner)
            leave = -ball.root(through) - approach if ball.sign_of(through) == 1 else leave
        return wait, leave / square

    def meets(self, way: Way, gx: float, gy: float) -> tuple[float, float, float, float] | None:
        """How long until a flight under gravity (0, 0 without) meets it; the unit vector from the centre to the contact
        then, and how fast they approach. None where it does not come to it.

        >>> bow = RoundSide(arb(0), arb(0), arb(5), arb(1), True, ((arb(-5), arb(0)), (arb(5), arb(0))))
        >>> met = bow.meets((arb(0), arb(12), arb(0), arb(0)), 0.0, -2.0)  # through the opening, down to the bottom
        >>> [round(number, 9) + 0.0 for number in met]
        [4.0, 0.0, -1.0, 8.0]
        """
        x, y, vx, vy = map(middle, way)
        reach = middle(self.reach)
        fall = RoundFall(middle(self.x) - x, middle(self.y) - y, -vx, -vy, gx / 2, gy / 2, reach)
        if gx or gy:
            wait = self._fallen_to(fall) if reach > 0.0 else None
        else:
            waits = self.waits(way)
            wait = None if waits is None else max(middle(waits[0]), 0.0)
        if wait is None:
            return None
        then = fall.after(wait)
        far = hypot(then.dx, then.dy) * (-1.0 if self.hollow else 1.0)
        nx, ny = then.dx / far, then.dy / far
        return wait, nx, ny, -(nx * then.vx + ny * then.vy)

    def _fallen_to(self, fall: RoundFall[float]) -> float | None:
        """The time to the first zero at which the gap falls within the range; others are passed over."""
        sign, since, now = -1.0 if self.hollow else 1.0, 0.0, fall
        stood = abs(now.gap()) <= ON_IT * (now.dx**2 + now.dy**2 + now.reach**2)
        if stood and sign * now.approach() < 0.0 and self._faces(-now.dx, -now.dy):
            return 0.0
        for _ in range(4):  # zeros at most
            gap = [sign * value for value in now.polynomial(stood)]
            falls = gap[0] > 0.0
            wait = told_falling_zero(gap if falls else [-value for value in gap])
            if wait is None:
                return None
            since, now, stood = since + wait, now.after(wait), True
            if falls and self._faces(-now.dx, -now.dy):
                return since
        return None

    def spans(self, way: Way) -> list[AsideSpan]:
        """What it covers of a line across a flight.

        >>> bow = RoundSide(arb(0), arb(0), arb(5), arb(1), True, ((arb(3), arb(-4)), (arb(3), arb(4))))
        >>> [(round(float(s.low), 9), round(float(s.high), 9)) for s in bow.spans((arb(0), arb(1), arb(2), arb(0)))]
        [(-4.2, 2.2)]
        """
        if not self._ahead(way):
            return []
        x, y, vx, vy = way
        speed = ball.root(vx * vx + vy * vy)
        dx, dy, reach = self.x - x, self.y - y, self.reach
        off, ahead = (dy * vx - dx * vy) / speed, middle((dx * vx + dy * vy) / speed)
        fast, towards = middle(speed), 1.0 if self.hollow else -1.0
        edges: list[tuple[arb, float, bool]] = []  # how far aside, how far ahead, whether the arc goes on from there
        for begins, (ex, ey) in zip((True, False), self.ends, strict=False):
            ux, uy = (ex - self.x) / self.radius, (ey - self.y) / self.radius
            along = middle((ux * vx + uy * vy) / speed)
            if along * towards > 0.0:
                edges.append(((uy * vx - ux * vy) / speed, along, begins == self.hollow))
        edges.sort(key=lambda edge: middle(edge[0]))
        edges.append((arb(1), 0.0, False))
        found: list[AsideSpan] = []
        open_at = (arb(-1), 0.0) if self._faces(middle(vy) / fast, -middle(vx) / fast) else None
        for aside, along, begins in edges:
            if begins:
                open_at = aside, along
            elif open_at is not None:
                far = middle(reach)
                low, low_at = open_at
                found.append(
                    AsideSpan(off + reach * low, off + reach * aside, ahead + far * low_at, ahead + far * along)
                )
                open_at = None
        return found


def middle(value: arb) -> float:
    """The double at the middle of a ball."""
    return float(value.mid())


def stretches(
    way: Way, r: arb, lines: Iterable[SeenWall[arb]], ends: Iterable[tuple[int, arb, arb, arb]],
    sides: Iterable[RoundSide] = (),
) -> list[AsideSpan]:  # fmt: skip
    """What the parts of a thing cover, of what is ahead and approached.

    Args:
        way: the flight.
        r: the circle's radius.
        lines: the faces.
        ends: number, x, y and radius of the ends.
        sides: those of an arc.

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
    return [*found, *(span for side in sides for span in side.spans(way))]


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


# ----------------------------------------
# The same of flights that fall, in doubles: they are parabolas for what stands.


def falls_to_walls(
    gap: NDArray[np.float64], approach: NDArray[np.float64], pull: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """When gaps under gravity are 0 and fall, infinite where they never do from now on; and how fast they fall then.

    >>> gaps, approaches, pulls = np.array([4.0, 4.0, -3.0]), np.array([0.0, 1.0, 4.0]), np.array([-2.0, 2.0, -2.0])
    >>> waits, rates = falls_to_walls(gaps, approaches, pulls)
    >>> waits.tolist(), rates.tolist()
    ([2.0, inf, 3.0], [4.0, 0.0, 2.0])
    """
    within = fall_discriminant(gap, approach, pull / 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(np.maximum(within, 0.0))
        waits = np.where(approach < 0.0, fall_time(gap, approach, root), fall_time_back(approach, pull / 2, root))
    never = (within <= 0.0) | ((approach >= 0.0) & (pull >= 0.0)) | ~(waits >= 0.0)
    return np.where(never, inf, waits), root


def falls_onto(fall: RoundFall[float]) -> tuple[float, RoundFall[float]] | None:
    """How long until one that falls meets something round that stands, and both as they then are; None: never.

    >>> wait, then = falls_onto(RoundFall(0.0, -9.0, 0.0, 0.0, 0.0, -1.0, 5.0))
    >>> wait, then.dx, then.dy, then.vy
    (2.0, 0.0, -5.0, 4.0)
    >>> falls_onto(RoundFall(0.0, 9.0, 0.0, -1.0, 0.0, -1.0, 5.0))
    """
    stood = not fall.gap() > 0.0
    if stood and fall.approach() < 0.0:
        return 0.0, fall
    wait = told_falling_zero(fall.polynomial(stood))
    return None if wait is None else (wait, fall.after(wait))


def falls_past(fall: RoundFall[float]) -> tuple[float, RoundFall[float]]:
    """When two of which one falls are nearest to each other, whatever they would meet, and as they then are.

    Of several such times, that beside the one of a straight flight. It may have gone by.

    >>> wait, then = falls_past(RoundFall(4.0, -4.0, -2.0, 0.0, 0.0, -1.0, 1.0))
    >>> wait, then.dx, then.dy
    (2.0, 0.0, 0.0)
    """
    square, pull = fall.vx**2 + fall.vy**2, fall.dx * fall.hx + fall.dy * fall.hy
    along, lift = fall.approach(), fall.vx * fall.hx + fall.vy * fall.hy
    rates = along, square - 2 * pull, -3 * lift, 2 * (fall.hx**2 + fall.hy**2)  # of half of the distance's square
    turns = (rates[1], 2 * rates[2], 3 * rates[3])
    found = np.roots(rates[::-1])
    waits = [float(root.real) for root in found if abs(root.imag) <= NEARLY_REAL * abs(root)]
    least = [wait for wait in waits if horner(turns, wait) >= 0.0] or waits
    straight = -along / square if square else 0.0
    wait = min(least, key=lambda wait: abs(wait - straight))
    return wait, fall.after(wait)


NEARLY_REAL = 2.0**-20
"""A share of itself: a zero whose imaginary part is no larger is real, but for what a double zero loses in doubles."""
