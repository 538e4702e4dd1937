"""The circles and walls of a scene in one number system, as they fly: how far two are apart, and when they meet."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ..laws.formulas import (
    advance,
    pair_approach,
    pair_discriminant,
    pair_gap,
    pair_hit_time,
    pair_nearest_time,
    wall_approach,
    wall_gap,
    wall_hit_time,
)
from ..numbers.system import Arithmetic, Number
from .body import Body
from .sides import Sides
from .steps import Link


class Line(NamedTuple):
    """A wall as seen from one circle: a point on it, the normal to the circle's side, and |n|^2, |n|."""

    x0: Number
    y0: Number
    nx: Number
    ny: Number
    nn: Number
    length: Number


class Relation(NamedTuple):
    """Two circles at the later of their clocks: that clock, d = b - a, v = b - a, R."""

    t: Number
    dx: Number
    dy: Number
    vx: Number
    vy: Number
    reach: Number


class Flights:
    """Bodies and walls of a scene in one number system.

    Args:
        scene: the scene; its state at time 0 is the state's first state.
        numbers: the system.
        only: the bodies that will be asked for; others are left out, to spare work.
    """

    def __init__(
        self,
        scene: Scene,
        numbers: Arithmetic,
        only: Iterable[int] | None = None,
    ) -> None:
        self.scene = scene
        self.constant = constant = numbers.constant
        self.root = numbers.root
        self.n = len(scene.circles)
        self.zero = constant(Quantity.of(0))
        self.one = constant(Quantity.of(1))
        chosen = range(self.n) if only is None else sorted(only)
        self.bodies: Any
        made = {i: self._body(i) for i in chosen}
        pockets = {-1 - k: self._pocket(k) for k in range(len(scene.pockets))}
        self.bodies = [*made.values(), *reversed(pockets.values())] if only is None else {**made, **pockets}
        self._lines: dict[int, tuple[Line, Line]] = {}
        self.sides = Sides(scene)

    def _body(self, i: int) -> Body:
        circle = self.scene.circles[i]
        start = [self.constant(value) for value in (circle.x, circle.y, circle.vx, circle.vy)]
        body = Body(i, start, self.zero, self.constant(circle.r), self.constant(circle.inverse_mass))
        body.rest = circle.at_rest
        return body

    def _pocket(self, k: int) -> Body:
        """A pocket as a body at rest, at index -1 - k."""
        pocket = self.scene.pockets[k]
        start = [self.constant(pocket.x), self.constant(pocket.y), self.zero, self.zero]
        body = Body(-1 - k, start, self.zero, self.constant(pocket.r), self.zero)
        body.rest = True
        return body

    # -- what the steps need

    def line(self, body: Body, wall: int) -> Line:
        """The wall as seen from the body."""
        if wall not in self._lines:
            exact = self.scene.walls[wall]
            nx, ny = exact.normal
            numbers = [self.constant(value) for value in (exact.x0, exact.y0, nx, ny)]
            x0, y0, mx, my = numbers
            nn = mx * mx + my * my
            length = self.root(nn)
            self._lines[wall] = (Line(x0, y0, mx, my, nn, length), Line(x0, y0, -mx, -my, nn, length))
        return self._lines[wall][self.sides.negative(body.index, wall)]

    def relation(self, i: int, j: int) -> Relation:
        """Bodies i and j at the later of their clocks, which the log's order tells without a comparison."""
        a, b = self.bodies[i], self.bodies[j]
        ax, ay, bx, by = a.x, a.y, b.x, b.y
        if a.last >= b.last:
            t = a.t
            if not b.rest:
                lag = a.t - b.t
                bx, by = advance(bx, b.vx, lag), advance(by, b.vy, lag)
        else:
            t = b.t
            if not a.rest:
                lag = b.t - a.t
                ax, ay = advance(ax, a.vx, lag), advance(ay, a.vy, lag)
        return Relation(t, bx - ax, by - ay, b.vx - a.vx, b.vy - a.vy, self.reach(a, b))

    def later(self, i: int, j: int) -> Body:
        """The one of two bodies whose flight is newer."""
        a, b = self.bodies[i], self.bodies[j]
        return a if a.last >= b.last else b

    def reach(self, a: Body, b: Body) -> Number:
        """The sum of two radii; for a pocket its own, as a centre enters it."""
        return b.r if b.index < 0 else a.r + b.r

    def gap(self, link: Link) -> Number:
        """|d|^2 - R^2 at the later clock; for a wall, its distance less the radius, times |n|."""
        i, j = link
        if j < self.n:
            pair = self.relation(i, j)
            return pair_gap(pair.dx, pair.dy, pair.reach)
        body = self.bodies[i]
        return self.wall_gap(body, j - self.n, body.x, body.y)

    def wall_gap(self, body: Body, wall: int, x: Number, y: Number) -> Number:
        """The distance of a circle at (x, y) from a wall, less its radius, times |n|."""
        line = self.line(body, wall)
        return wall_gap(x, y, line.x0, line.y0, line.nx, line.ny, body.r * line.length)

    def approach(self, link: Link) -> Number:
        """d.v at the later clock (for a wall n.v): negative while the two come nearer."""
        i, j = link
        if j < self.n:
            pair = self.relation(i, j)
            return pair_approach(pair.dx, pair.dy, pair.vx, pair.vy)
        body = self.bodies[i]
        line = self.line(body, j - self.n)
        return wall_approach(body.vx, body.vy, line.nx, line.ny)

    def discriminant(self, link: Link) -> Number:
        """|v|^2 R^2 - (d x v)^2 of two circles."""
        pair = self.relation(*link)
        return pair_discriminant(pair.dx, pair.dy, pair.vx, pair.vy, pair.reach)

    def hit(self, link: Link) -> tuple[Number, Number]:
        """The clock from which the hit is reckoned, and the time from it to the hit."""
        i, j = link
        if j < self.n:
            t, dx, dy, vx, vy, reach = self.relation(i, j)
            root = self.root(pair_discriminant(dx, dy, vx, vy, reach))
            return t, pair_hit_time(pair_gap(dx, dy, reach), pair_approach(dx, dy, vx, vy), root)
        a = self.bodies[i]
        return a.t, wall_hit_time(self.wall_gap(a, j - self.n, a.x, a.y), self.approach(link))

    def graze(self, link: Link) -> tuple[Number, Number]:
        """As `hit`, for two circles that touch without pushing: the time at which they are nearest."""
        t, dx, dy, vx, vy, _ = self.relation(*link)
        return t, pair_nearest_time(pair_approach(dx, dy, vx, vy), vx, vy)

    def hit_parts(self, link: Link) -> tuple[Number, Number, Number]:
        """p, q, D with hit time p + q*sqrt(D): the textbook root, for comparisons that add no root."""
        i, j = link
        if j < self.n:
            t, dx, dy, vx, vy, reach = self.relation(i, j)
            a = vx * vx + vy * vy
            disc = pair_discriminant(dx, dy, vx, vy, reach)
            return t - pair_approach(dx, dy, vx, vy) / a, -(self.one / a), disc
        t, wait = self.hit(link)
        return t + wait, self.zero, self.zero
