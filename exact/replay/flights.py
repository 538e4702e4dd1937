"""The circles and walls of a scene in one number system, as they fly: how far two are apart, and when they meet."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Generic, Literal, NamedTuple

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
from ..numbers.system import Arithmetic, N
from .body import Body, Flight
from .contact import AtWall, Round
from .sides import Sides


class SeenWall(NamedTuple, Generic[N]):
    """A wall as seen from one circle: a point on it, the normal to the circle's side, and |n|^2, |n|."""

    x0: N
    y0: N
    nx: N
    ny: N
    nn: N
    length: N


class Relation(NamedTuple, Generic[N]):
    """Two bodies at the later of their clocks: that clock, d = b - a, v = b - a, R."""

    t: N
    dx: N
    dy: N
    vx: N
    vy: N
    reach: N


class Flights(Generic[N]):
    """Bodies and walls of a scene in one number system.

    Args:
        scene: the scene; its state at time 0 is the state's first state.
        numbers: the system.
        only: the circles that will be asked for; others are left out, to spare work.

    Attributes:
        bodies: the circles, by index.
        pockets: the pockets, as bodies at rest.
        sides: on which side of each wall each circle lies.
    """

    def __init__(self, scene: Scene, numbers: Arithmetic[N], only: Iterable[int] | None = None) -> None:
        self.scene = scene
        self.constant = constant = numbers.constant
        self.root = numbers.root
        self.n = len(scene.circles)
        self.zero: N = constant(Quantity.of(0))
        self.one: N = constant(Quantity.of(1))
        self._measures: dict[tuple[Quantity, Quantity | Literal["oo"]], tuple[N, N]] = {}
        self.bodies = {i: self._circle(i) for i in (range(self.n) if only is None else sorted(only))}
        self.pockets = [self._pocket(k) for k in range(len(scene.pockets))]
        self._lines: dict[int, tuple[SeenWall[N], SeenWall[N]]] = {}
        self.sides = Sides(scene)

    def _circle(self, i: int) -> Body[N]:
        circle, constant, zero = self.scene.circles[i], self.constant, self.zero
        x, y, vx, vy = constant(circle.x), constant(circle.y), constant(circle.vx), constant(circle.vy)
        flight = Flight(x, y, vx, vy, zero, zero, rest=circle.at_rest)
        r, m = circle.r, circle.m
        if r.rational is None or (isinstance(m, Quantity) and m.rational is None):
            return Body(i, flight, constant(r), constant(circle.inverse_mass))
        known = self._measures.get((r, m))
        if known is None:
            known = self._measures[r, m] = constant(r), constant(circle.inverse_mass)
        return Body(i, flight, *known)

    def _pocket(self, k: int) -> Body[N]:
        pocket, zero = self.scene.pockets[k], self.zero
        flight = Flight(self.constant(pocket.x), self.constant(pocket.y), zero, zero, zero, zero, rest=True)
        return Body(k, flight, self.constant(pocket.r), zero, is_pocket=True)

    # -- what the steps need

    def line(self, circle: int, wall: int) -> SeenWall[N]:
        """The wall as seen from a circle."""
        if wall not in self._lines:
            exact = self.scene.walls[wall]
            nx, ny = exact.normal
            x0, y0, mx, my = (self.constant(value) for value in (exact.x0, exact.y0, nx, ny))
            nn = mx * mx + my * my
            length = self.root(nn)
            self._lines[wall] = (SeenWall(x0, y0, mx, my, nn, length), SeenWall(x0, y0, -mx, -my, nn, length))
        return self._lines[wall][self.sides.negative(circle, wall)]

    def relation(self, link: Round) -> Relation[N]:
        """The two of a contact at the later of their clocks, which the log's order tells without a comparison."""
        a, b = link.ends(self)
        f, g = a.flight, b.flight
        ax, ay, bx, by = f.x, f.y, g.x, g.y
        if f.last >= g.last:
            t = f.t
            if not g.rest:
                lag = f.t - g.t
                bx, by = advance(bx, g.vx, lag), advance(by, g.vy, lag)
        else:
            t = g.t
            if not f.rest:
                lag = g.t - f.t
                ax, ay = advance(ax, f.vx, lag), advance(ay, f.vy, lag)
        return Relation(t, bx - ax, by - ay, g.vx - f.vx, g.vy - f.vy, self.reach(a, b))

    def later(self, link: Round) -> Body[N]:
        """The one of the two of a contact whose flight is newer."""
        a, b = link.ends(self)
        return a if a.flight.last >= b.flight.last else b

    def reach(self, a: Body[N], b: Body[N]) -> N:
        """The sum of two radii; for a pocket its own, as a centre enters it."""
        return b.r if b.is_pocket else a.r + b.r

    # -- two circles, or a centre and a pocket

    def round_gap(self, link: Round) -> N:
        """|d|^2 - R^2 at the later clock; in enclosures, whose clocks may stand beside it, at the instant."""
        pair, late = self.relation(link), self.later(link).flight.late
        if late is None:
            return pair_gap(pair.dx, pair.dy, pair.reach)
        return pair_gap(advance(pair.dx, pair.vx, late), advance(pair.dy, pair.vy, late), pair.reach)

    def round_approach(self, link: Round) -> N:
        """d.v then: negative while the two come nearer."""
        pair, late = self.relation(link), self.later(link).flight.late
        if late is None:
            return pair_approach(pair.dx, pair.dy, pair.vx, pair.vy)
        return pair_approach(advance(pair.dx, pair.vx, late), advance(pair.dy, pair.vy, late), pair.vx, pair.vy)

    def discriminant(self, link: Round) -> N:
        """|v|^2 R^2 - (d x v)^2."""
        pair = self.relation(link)
        return pair_discriminant(pair.dx, pair.dy, pair.vx, pair.vy, pair.reach)

    def round_hit(self, link: Round) -> tuple[N, N]:
        """The clock from which the hit is reckoned, and the time from it to the hit."""
        t, dx, dy, vx, vy, reach = self.relation(link)
        root = self.root(pair_discriminant(dx, dy, vx, vy, reach))
        return t, pair_hit_time(pair_gap(dx, dy, reach), pair_approach(dx, dy, vx, vy), root)

    def graze(self, link: Round) -> tuple[N, N]:
        """As `round_hit`, for two that touch without pushing: the time at which they are nearest."""
        t, dx, dy, vx, vy, _ = self.relation(link)
        return t, pair_nearest_time(pair_approach(dx, dy, vx, vy), vx, vy)

    def round_parts(self, link: Round) -> tuple[N, N, N]:
        """p, q, D with hit time p + q*sqrt(D): the textbook root, for comparisons that add no root."""
        t, dx, dy, vx, vy, reach = self.relation(link)
        a = vx * vx + vy * vy
        disc = pair_discriminant(dx, dy, vx, vy, reach)
        return t - pair_approach(dx, dy, vx, vy) / a, -(self.one / a), disc

    # -- a circle and a wall

    def wall_gap(self, link: AtWall) -> N:
        """The distance of a circle from a wall, less its radius, times |n|; when, see `round_gap`."""
        x, y, vx, vy, _, _, late, *_ = self.bodies[link.circle].flight
        if late is None:
            return self._wall_gap(link, x, y)
        return self._wall_gap(link, advance(x, vx, late), advance(y, vy, late))

    def _wall_gap(self, link: AtWall, x: N, y: N) -> N:
        line = self.line(*link[:2])
        return wall_gap(x, y, line.x0, line.y0, line.nx, line.ny, self.bodies[link.circle].r * line.length)

    def wall_approach(self, link: AtWall) -> N:
        """n.v: negative while the circle comes nearer."""
        flight, line = self.bodies[link.circle].flight, self.line(*link[:2])
        return wall_approach(flight.vx, flight.vy, line.nx, line.ny)

    def wall_hit(self, link: AtWall) -> tuple[N, N]:
        """As `round_hit`."""
        flight = self.bodies[link.circle].flight
        return flight.t, wall_hit_time(self._wall_gap(link, flight.x, flight.y), self.wall_approach(link))
