"""A log carried out again by the textbook, in many bits, and the derivative of each contact by dual numbers.

Nothing here is taken from `exact/`: a hit is the smaller root of a quadratic in the time, from places at time 0, and
within an arc the larger one; at a wall that falls it is the one at which the gap falls. Onto something round that
stands under gravity it is the first real zero of a quartic, of all that there are, at which the gap falls, on the arc
as angles have it. An impulse turns approach speeds around, all but what the restitution takes; a derivative is what
the rules of differentiation make of the very formulas that give the new lines. What a log's steps are called is all
that both know.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import acos, atan2, hypot, pi, tau
from typing import Any, NamedTuple, TypeVar

import numpy as np
from flint import arb, arb_mat

from truebreak.exact.numbers import ball
from truebreak.exact.replay.contact import AtArc, AtWall, Entry, Pair
from truebreak.exact.replay.state import Flip, Go, Kick, Step, Take
from truebreak.scenarios import Quantity, Scene
from truebreak.scenarios.arcs import ArcSide

BITS = 4096
"""Precision of the truth: a few thousand bits beyond what any bound here is about."""


class Line(NamedTuple):
    """A circle passes (x, y) at time t with velocity (vx, vy)."""

    x: Any
    y: Any
    vx: Any
    vy: Any
    t: Any

    def at(self, t: Any) -> Line:
        """The same line, told by where it is at another time."""
        late = t - self.t
        return Line(self.x + self.vx * late, self.y + self.vy * late, self.vx, self.vy, t)


class Dual:
    """A number with its derivatives by some variables; for 0 + 1, 0 - 1 and the like plain numbers do as well."""

    def __init__(self, value: arb, by: list[arb]) -> None:
        self.value = value
        self.by = by

    def _of(self, other: Any) -> Dual:
        return other if isinstance(other, Dual) else Dual(other, [arb(0)] * len(self.by))

    def __add__(self, other: Any) -> Dual:
        other = self._of(other)
        return Dual(self.value + other.value, [p + q for p, q in zip(self.by, other.by, strict=True)])

    def __sub__(self, other: Any) -> Dual:
        other = self._of(other)
        return Dual(self.value - other.value, [p - q for p, q in zip(self.by, other.by, strict=True)])

    def __mul__(self, other: Any) -> Dual:
        other = self._of(other)
        a, b = self.value, other.value
        return Dual(a * b, [p * b + a * q for p, q in zip(self.by, other.by, strict=True)])

    def __truediv__(self, other: Any) -> Dual:
        other = self._of(other)
        a, b = self.value, other.value
        return Dual(a / b, [(p - q * a / b) / b for p, q in zip(self.by, other.by, strict=True)])

    def __neg__(self) -> Dual:
        return Dual(-self.value, [-p for p in self.by])

    def __radd__(self, other: Any) -> Dual:
        return self + other

    def __rsub__(self, other: Any) -> Dual:
        return -self + other

    def __rmul__(self, other: Any) -> Dual:
        return self * other

    def __rtruediv__(self, other: Any) -> Dual:
        return self._of(other) / self

    def sqrt(self) -> Dual:
        """The square root."""
        root = self.value.sqrt()
        return Dual(root, [p / (root + root) for p in self.by])


L = TypeVar("L")


class Plane(NamedTuple):
    """A wall: a point of it at time 0, a normal n, n.u of its velocity, and half of n.g; None where that is zero."""

    x0: arb
    y0: arb
    nx: arb
    ny: arb
    drift: arb
    half: arb | None

    def speed(self, a: Line) -> Any:
        """n.v of a line that lies in the frame that falls, at its time, as seen from the wall."""
        speed = self.nx * a.vx + self.ny * a.vy - self.drift
        return speed if self.half is None else speed + (self.half + self.half) * a.t


class Table(NamedTuple):
    """What of a scene never changes, as enclosures: radii, inverse masses, walls, pockets, sides of arcs, the hollow
    ones with a radius below zero, the angles of each arc, gravity, the restitution; whether there is gravity."""

    r: list[arb]
    w: list[arb]
    walls: list[Plane]
    pockets: list[tuple[arb, arb, arb]]
    arcs: list[tuple[arb, arb, arb]]
    angles: list[tuple[float, float]]
    g: tuple[arb, ...]
    e: arb
    pulls: bool


def table_of(scene: Scene) -> Table:
    """The table of a scene, at the precision in use."""
    bits = ball.bits_in_use()

    def of(*numbers: Any) -> tuple[arb, ...]:
        return tuple(number.ball(bits) for number in numbers)

    w = [arb(0) if circle.fixed else 1 / circle.m.ball(bits) for circle in scene.circles]
    walls, g = list[Plane](), scene.gravity or (Quantity.of(0), Quantity.of(0))
    for wall in scene.walls:
        x0, y0, x1, y1, ux, uy = of(wall.x0, wall.y0, wall.x1, wall.y1, wall.vx, wall.vy)
        nx, ny = y0 - y1, x1 - x0
        half = ((wall.y0 - wall.y1) * g[0] + (wall.x1 - wall.x0) * g[1]) / 2
        walls.append(Plane(x0, y0, nx, ny, nx * ux + ny * uy, of(half)[0] if half.sign() else None))
    return Table(
        [of(c.r)[0] for c in scene.circles],
        w,
        walls,
        [of(p.x, p.y, p.r) for p in scene.pockets],
        [of(side.x, side.y, side.r) for side in scene.arc_sides],
        [_angles(side) for side in scene.arc_sides],
        of(*g),
        *of(scene.restitution),
        scene.gravity is not None,
    )


def _angles(side: ArcSide) -> tuple[float, float]:
    """The direction of the middle of an arc, and half of how wide it is."""
    nx, ny = float(side.nx), float(side.ny)
    return (0.0, tau) if side.full else (atan2(ny, nx), acos(float(side.h) / hypot(nx, ny)))


def first_root(a: Any, half: Any, c: Any) -> Any:
    """The smaller zero of a t^2 + 2 half t + c; the double one where the discriminant may be zero."""
    disc = half * half - a * c
    value = disc.value if isinstance(disc, Dual) else disc
    return -half / a if value.contains(0) else (-half - disc.sqrt()) / a


def last_root(a: Any, half: Any, c: Any) -> Any:
    """The larger zero of a t^2 + 2 half t + c."""
    return (-half + (half * half - a * c).sqrt()) / a


def meeting_time(a: Line, b: Line, reach: Any, hollow: bool = False) -> Any:
    """When two lines come as near as `reach`; or, `hollow`, are no nearer any more."""
    px, py = (b.x - b.vx * b.t) - (a.x - a.vx * a.t), (b.y - b.vy * b.t) - (a.y - a.vy * a.t)
    vx, vy = b.vx - a.vx, b.vy - a.vy
    root = last_root if hollow else first_root
    return root(vx * vx + vy * vy, px * vx + py * vy, px * px + py * py - reach * reach)


def wall_time(a: Line, wall: Plane, r: Any, side: int) -> Any:
    """When a line comes as near to a wall as r, on one side of it, and does not leave it."""
    x0, y0, nx, ny, drift, half = wall
    far = (nx * nx + ny * ny).sqrt() * r * side
    apart, speed = nx * (a.x - a.vx * a.t - x0) + ny * (a.y - a.vy * a.t - y0) - far, nx * a.vx + ny * a.vy - drift
    if half is None:
        return -apart / speed
    return (-speed - side * (speed * speed - 4 * half * apart).sqrt()) / (half + half)


def collided(
    a: Line, b: Line, reach: Any, wa: Any, wb: Any, e: Any, clock: Any, hollow: bool = False
) -> tuple[Line, Line]:
    """The lines after two circles have met, told at a time."""
    t = meeting_time(a, b, reach, hollow)
    a, b = a.at(t), b.at(t)
    dx, dy = b.x - a.x, b.y - a.y
    push = (dx * (b.vx - a.vx) + dy * (b.vy - a.vy)) * (-1 - e) / ((dx * dx + dy * dy) * (wa + wb))
    jx, jy = push * dx, push * dy
    a = Line(a.x, a.y, a.vx - wa * jx, a.vy - wa * jy, t)
    b = Line(b.x, b.y, b.vx + wb * jx, b.vy + wb * jy, t)
    return a.at(clock), b.at(clock)


def quartic(a: Line, b: Line, reach: Any, g: Sequence[Any]) -> list[Any]:
    """|d|^2 - reach^2 as a polynomial of the time from a's own on: a falls, and is told in the frame that falls; b does
    not, and is told where it is."""
    b = b.at(a.t)
    gx, gy = g
    px, py = a.x + gx * a.t * a.t / 2 - b.x, a.y + gy * a.t * a.t / 2 - b.y
    qx, qy = a.vx + gx * a.t - b.vx, a.vy + gy * a.t - b.vy
    return [
        px * px + py * py - reach * reach,
        2 * (px * qx + py * qy),
        qx * qx + qy * qy + px * gx + py * gy,
        qx * gx + qy * gy,
        (gx * gx + gy * gy) / 4,
    ]


def value_at(c: Sequence[Any], s: Any) -> Any:
    """The value of a polynomial."""
    found = c[-1]
    for part in reversed(c[:-1]):
        found = found * s + part
    return found


def falls_at(a: Line, b: Line, reach: Any, g: Sequence[Any], within: Callable[[Any], bool], hollow: bool) -> arb:
    """When, of all complex zeros of the quartic, the gap first falls while `within` says so of the time."""
    c = quartic(a, b, reach, g)
    slope, found = [k * part for k, part in enumerate(c)][1:], list[arb]()
    for root in np.roots([float(part) for part in reversed(c)]).tolist():
        s = arb(complex(root).real)
        for _ in range(SHARPENINGS):
            s = (s - value_at(c, s) / value_at(slope, s)).mid()
        rate = value_at(slope, s)
        s -= value_at(c, s) / value_at(slope, s + arb(0, NEAR_ZERO))
        far = abs(complex(root) - float(s)) > 1e-3 * (1 + abs(root))
        if not far and s > 0 and (rate > 0 if hollow else rate < 0) and within(a.t + s):
            found.append(s)
    return a.t + min(found, key=float)


SHARPENINGS = 12
"""Of a double, by Newton's rule: 50 bits become 4,096 long before."""

NEAR_ZERO = 1e-300
"""Beside a midpoint found by it, where the zero is."""


def fallen(a: Line, b: Line, e: Any, g: Sequence[Any], t: Any, clock: Any) -> Line:
    """The line of what falls after it has met, at a time, what takes no impulse, told at another."""
    a, b = a.at(t), b.at(t)
    gx, gy = g
    dx, dy = a.x + gx * t * t / 2 - b.x, a.y + gy * t * t / 2 - b.y
    push = (dx * (a.vx + gx * t - b.vx) + dy * (a.vy + gy * t - b.vy)) * (-1 - e) / (dx * dx + dy * dy)
    return Line(a.x, a.y, a.vx + push * dx, a.vy + push * dy, t).at(clock)


def fallen_beside(a: Line, b: Line, reach: arb, e: arb, g: Sequence[arb], clock: arb) -> Line:
    """The same, of dual numbers: the time is the zero beside the clock, and its derivative that of a zero."""
    c = quartic(a, b, reach, g)
    plain = [part.value if isinstance(part, Dual) else part for part in c]
    slope, start = [k * part for k, part in enumerate(plain)][1:], clock - a.t
    wide = 4 * abs(value_at(plain, start) / value_at(slope, start)).upper()
    around = start + arb(0, 1) * wide
    rate = value_at(slope, around)
    s = start - value_at(plain, start) / rate
    assert around.contains(s), "no zero is beside the clock"
    by = [-part / value_at(slope, s) for part in value_at(c, s).by]
    return fallen(a, b, e, g, Dual(a.t + s, by), clock)


def rebounded(a: Line, wall: Plane, r: Any, side: int, e: Any, clock: Any) -> Line:
    """The line after a circle has met a wall, told at a time."""
    nx, ny = wall.nx, wall.ny
    a = a.at(wall_time(a, wall, r, side))
    turn = wall.speed(a) * (1 + e) / (nx * nx + ny * ny)
    return Line(a.x, a.y, a.vx - turn * nx, a.vy - turn * ny, a.t).at(clock)


def middle(table: Table, link: AtArc) -> tuple[Line, arb, bool]:
    """The middle of an arc, which rests; how near a centre comes to it; and whether that is from within."""
    x, y, r = table.arcs[link.arc]
    zero = arb(0)
    return Line(x, y, zero, zero, zero), abs(r + table.r[link.circle]), r < 0


class Truth:
    """A log carried out with `BITS` bits: for each circle its lines, each from a number of steps on.

    Args:
        scene, steps: the log.
    """

    def __init__(self, scene: Scene, steps: Sequence[Step]) -> None:
        with ball.precision(BITS):
            self._table = table_of(scene)
            zero = arb(0)
            starts = [[number.ball(BITS) for number in (c.x, c.y, c.vx, c.vy)] for c in scene.circles]
            self.lines = [[(0, Line(*start, zero))] for start in starts]
            self._now = [rows[0][1] for rows in self.lines]
            self.sides = [[self._side(i, k) for k in range(len(scene.walls))] for i in range(len(starts))]
            self._free = [not c.fixed for c in scene.circles]
            self._time: arb = zero
            self.times = [zero]
            for count, step in enumerate(steps, 1):
                for i in self._do(step):
                    self.lines[i].append((count, self._now[i]))
                self.times.append(self._time)

    def after(self, i: int, steps: int) -> Line:
        """How circle i flies after so many steps."""
        return next(line for count, line in reversed(self.lines[i]) if count <= steps)

    def _seen(self, i: int) -> Line:
        """A circle at the instant, where it truly is."""
        line, (gx, gy), t = self._now[i].at(self._time), self._table.g, self._time
        if not self._free[i]:
            return line
        x, y, vx, vy, _ = line
        return Line(x + gx * t * t / 2, y + gy * t * t / 2, vx + gx * t, vy + gy * t, t)

    def _onto(self, i: int, at: Line, reach: arb, arc: int | None = None) -> arb:
        """When a circle that falls comes to something that stands."""
        table, a = self._table, self._now[i]

        def within(t: arb) -> bool:
            if arc is None:
                return True
            (middle, half), (gx, gy), line = table.angles[arc], table.g, a.at(t)
            x, y = line.x + gx * t * t / 2 - at.x, line.y + gy * t * t / 2 - at.y
            return abs((atan2(float(y), float(x)) - middle + pi) % tau - pi) < half

        return falls_at(a, at, reach, table.g, within, arc is not None and table.arcs[arc][2] < 0)

    def _side(self, i: int, k: int) -> int:
        x0, y0, nx, ny, *_ = self._table.walls[k]
        return 1 if nx * (self._now[i].x - x0) + ny * (self._now[i].y - y0) > 0 else -1

    def _do(self, step: Step) -> Sequence[int]:
        """Carries out a step; the circles that have a new line."""
        now = self._now
        if isinstance(step, Go):
            self._time = self._instant(step.source)
            for i in step.bodies:
                now[i] = now[i].at(self._time)
            return step.bodies
        if isinstance(step, Kick):
            return self._kick(step.links)
        if isinstance(step, Take):
            x, y, *_ = self._seen(step.body)
            self._free[step.body] = False
            now[step.body] = Line(x, y, arb(0), arb(0), self._time)
            return (step.body,)
        assert isinstance(step, Flip)
        for i, line in enumerate(now):
            x, y, vx, vy, t = line.at(self._time)
            turned = (-v - 2 * g * t for v, g in zip((vx, vy), self._table.g, strict=True))
            now[i] = Line(x, y, *turned, t)
        return range(len(now))

    def _instant(self, source: Any) -> arb:
        now, table = self._now, self._table
        if isinstance(source, int):
            return now[source].t
        if table.pulls and isinstance(source, Pair) and self._free[source.a] is not self._free[source.b]:
            i, k = source if self._free[source.a] else source[::-1]
            return self._onto(i, now[k], table.r[i] + table.r[k])
        if isinstance(source, Pair):
            return meeting_time(now[source.a], now[source.b], table.r[source.a] + table.r[source.b])
        if isinstance(source, AtWall):
            i, k = source.circle, source.wall
            return wall_time(now[i], table.walls[k], table.r[i], self.sides[i][k])
        if isinstance(source, AtArc):
            at, reach, hollow = middle(table, source)
            if table.pulls:
                return self._onto(source.circle, at, reach, source.arc)
            return meeting_time(now[source.circle], at, reach, hollow)
        if isinstance(source, Entry):
            x, y, r = table.pockets[source.pocket]
            zero = arb(0)
            at = Line(x, y, zero, zero, zero)
            return self._onto(source.circle, at, r) if table.pulls else meeting_time(now[source.circle], at, r)
        return source.ball(BITS)

    def _arms(self, link: Any) -> dict[int, tuple[arb, arb]]:
        """The direction in which each circle of a contact is pushed."""
        if isinstance(link, AtWall):
            i, k = link.circle, link.wall
            _, _, nx, ny, *_ = self._table.walls[k]
            return {i: (nx * self.sides[i][k], ny * self.sides[i][k])}
        if isinstance(link, AtArc):
            at, _, hollow = middle(self._table, link)
            x, y, *_ = self._seen(link.circle)
            return {link.circle: (at.x - x, at.y - y) if hollow else (x - at.x, y - at.y)}
        a, b = (self._seen(i) for i in link)
        dx, dy = b.x - a.x, b.y - a.y
        return {link.a: (-dx, -dy), link.b: (dx, dy)}

    def _kick(self, links: Sequence[Any]) -> list[int]:
        arms, now, w = [self._arms(link) for link in links], self._now, self._table.w

        def product(one: dict[int, tuple[arb, arb]], other: dict[int, tuple[arb, arb]]) -> arb:
            both = [(w[i], *one[i], *other[i]) for i in one if i in other]
            return sum((m * (x * p + y * q) for m, x, y, p, q in both), arb(0))

        seen = {i: self._seen(i) for arm in arms for i in arm}
        speeds = [sum((x * seen[i].vx + y * seen[i].vy for i, (x, y) in arm.items()), arb(0)) for arm in arms]
        for k, link in enumerate(links):
            if isinstance(link, AtWall):
                wall, i = self._table.walls[link.wall], link.circle
                speeds[k] = wall.speed(now[i].at(self._time)) * self.sides[i][link.wall]
        matrix = arb_mat([[product(one, other) for other in arms] for one in arms])
        strengths = matrix.solve(arb_mat([[-speed - self._table.e * speed] for speed in speeds]))
        struck = sorted({i for arm in arms for i in arm if self._free[i]})
        for i in struck:
            x, y, vx, vy, t = now[i].at(self._time)
            for k, arm in enumerate(arms):
                if i in arm:
                    gain = w[i] * strengths[k, 0]
                    vx, vy = vx + gain * arm[i][0], vy + gain * arm[i][1]
            now[i] = Line(x, y, vx, vy, t)
        return struck
