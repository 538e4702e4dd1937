"""Carries out an event log in any number system: advance bodies to a contact, apply impulses, flip velocities.

An event log is a program without decisions: given the scene and the log, every number of a run can be computed
again, to more bits, in nested square roots, modulo a prime. The live run of every event-driven engine is such a
machine too, fed one step at a time.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple, TypeAlias

from ..scenarios.quantity import Quantity
from ..scenarios.scene import Scene
from .formulas import (
    advance,
    pair_approach,
    pair_discriminant,
    pair_gap,
    pair_hit_time,
    pair_impulse,
    wall_approach,
    wall_bounce,
    wall_gap,
    wall_hit_time,
)

Number: TypeAlias = Any
"""A number of the machine's system: it has + - * / and unary minus."""

Link: TypeAlias = tuple[int, int]
"""A contact by index: two circles (i < j < n), or circle i and wall j - n (j >= n)."""


class Go(NamedTuple):
    """Advance `bodies` to one instant.

    The instant is the hit time of `source` if that is a Link, the clock of a body if it is an int, the constant
    itself if it is a Quantity.
    """

    source: Link | int | Quantity
    bodies: tuple[int, ...]


class Kick(NamedTuple):
    """Apply, together, the impulses that make each of these contacts separate as fast as it approached."""

    links: tuple[Link, ...]


class Flip(NamedTuple):
    """Negate every velocity; all bodies stand at one instant."""


Step: TypeAlias = Go | Kick | Flip


class Body:
    """One circle's state: position and velocity at its own clock t."""

    __slots__ = ("acc", "index", "kind", "last", "q", "r", "rest", "serial", "t", "vx", "vy", "w", "x", "y")

    def __init__(self, index: int, state: Sequence[Number], t: Number, r: Number, w: Number) -> None:
        self.index = index
        self.x, self.y, self.vx, self.vy = state
        self.t = t
        self.r = r
        self.w = w
        self.q: tuple[Number, ...] = ()
        self.rest = False
        self.last = 0
        self.serial = 0
        self.kind = 0
        self.acc = 0

    def __repr__(self) -> str:
        return f"Body({self.index}, x={self.x}, y={self.y}, vx={self.vx}, vy={self.vy}, t={self.t})"


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


class Machine:
    """Bodies and walls of a scene in one number system, and the steps of a log upon them.

    Args:
        scene: the scene; its state at time 0 is the machine's first state.
        constant: makes a number of the system from an exact one.
        root: the square root of a non-negative number of the system.
        only: the bodies that will be asked for; others are left out, to spare work.
    """

    def __init__(
        self,
        scene: Scene,
        constant: Callable[[Quantity], Number],
        root: Callable[[Number], Number],
        only: Iterable[int] | None = None,
    ) -> None:
        self.scene = scene
        self.constant = constant
        self.root = root
        self.n = len(scene.circles)
        self.zero = constant(Quantity.of(0))
        self.one = constant(Quantity.of(1))
        self.steps_done = 0
        self.flip_time = self.zero
        chosen = range(self.n) if only is None else sorted(only)
        self.bodies: dict[int, Body] | list[Body]
        made = {i: self._body(i) for i in chosen}
        self.bodies = list(made.values()) if only is None else made
        self._lines: dict[int, tuple[Line, Line]] = {}
        self._sides = Sides(scene)

    def _body(self, i: int) -> Body:
        circle = self.scene.circles[i]
        state = [self.constant(value) for value in (circle.x, circle.y, circle.vx, circle.vy)]
        body = Body(i, state, self.zero, self.constant(circle.r), self.constant(circle.inverse_mass))
        body.rest = circle.at_rest
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
        return self._lines[wall][self._sides.negative(body.index, wall)]

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

    def reach(self, a: Body, b: Body) -> Number:
        """The sum of two radii."""
        return a.r + b.r

    def gap(self, link: Link) -> Number:
        """|d|^2 - R^2 at the later clock; for a wall, its distance less the radius, times |n|."""
        i, j = link
        if j < self.n:
            state = self.relation(i, j)
            return pair_gap(state.dx, state.dy, state.reach)
        body = self.bodies[i]
        line = self.line(body, j - self.n)
        return wall_gap(body.x, body.y, line.x0, line.y0, line.nx, line.ny, body.r * line.length)

    def approach(self, link: Link) -> Number:
        """d.v at the later clock (for a wall n.v): negative while the two come nearer."""
        i, j = link
        if j < self.n:
            state = self.relation(i, j)
            return pair_approach(state.dx, state.dy, state.vx, state.vy)
        body = self.bodies[i]
        line = self.line(body, j - self.n)
        return wall_approach(body.vx, body.vy, line.nx, line.ny)

    def discriminant(self, link: Link) -> Number:
        """|v|^2 R^2 - (d x v)^2 of two circles."""
        state = self.relation(*link)
        return pair_discriminant(state.dx, state.dy, state.vx, state.vy, state.reach)

    def hit(self, link: Link) -> tuple[Number, Number]:
        """The clock from which the hit is reckoned, and the time from it to the hit."""
        i, j = link
        if j < self.n:
            t, dx, dy, vx, vy, reach = self.relation(i, j)
            root = self.root(pair_discriminant(dx, dy, vx, vy, reach))
            return t, pair_hit_time(pair_gap(dx, dy, reach), pair_approach(dx, dy, vx, vy), root)
        return self.bodies[i].t, wall_hit_time(self.gap(link), self.approach(link))

    def hit_parts(self, link: Link) -> tuple[Number, Number, Number]:
        """p, q, D with hit time p + q*sqrt(D): the textbook root, for comparisons that add no root."""
        i, j = link
        if j < self.n:
            t, dx, dy, vx, vy, reach = self.relation(i, j)
            a = vx * vx + vy * vy
            disc = pair_discriminant(dx, dy, vx, vy, reach)
            return t - pair_approach(dx, dy, vx, vy) / a, -(self.one / a), disc
        return self.bodies[i].t + wall_hit_time(self.gap(link), self.approach(link)), self.zero, self.zero

    # -- the steps

    def do(self, step: Step) -> None:
        """Carries out one step of a log."""
        self.steps_done += 1
        if type(step) is Go:
            self.go(step.source, step.bodies)
        elif type(step) is Kick:
            self.kick(step.links)
        else:
            self.flip()

    def go(self, source: Link | int | Quantity, bodies: tuple[int, ...]) -> None:
        """Advances bodies to the instant that `source` names (see `Go`)."""
        if isinstance(source, tuple):
            base, wait = self.hit(source)
            time = base + wait
        elif isinstance(source, int):
            base = time = self.bodies[source].t
            wait = None
        else:
            base = time = self.constant(source)
            wait = None
        for index in bodies:
            body = self.bodies[index]
            if not body.rest and body.t is not time:
                if wait is not None and body.t is base:
                    lag = wait
                elif wait is not None:
                    lag = (base - body.t) + wait
                else:
                    lag = time - body.t
                body.x, body.y = advance(body.x, body.vx, lag), advance(body.y, body.vy, lag)
            body.t = time
            body.last = self.steps_done

    def kick(self, links: tuple[Link, ...]) -> None:
        """Applies the impulses of contacts together; each then separates as fast as it approached."""
        if len(links) > 1:
            self._kick_together(links)
            return
        i, j = links[0]
        a = self.bodies[i]
        if j < self.n:
            b = self.bodies[j]
            jx, jy = pair_impulse(
                b.x - a.x, b.y - a.y, b.vx - a.vx, b.vy - a.vy, self.reach(a, b), *self.weights(a, b)
            )
            self._push(a, -jx, -jy)
            self._push(b, jx, jy)
        else:
            line = self.line(a, j - self.n)
            a.vx, a.vy = wall_bounce(a.vx, a.vy, line.nx, line.ny, line.nn)

    def weights(self, a: Body, b: Body) -> tuple[Number, Number]:
        """The inverse masses of two bodies."""
        return a.w, b.w

    def _push(self, body: Body, jx: Number, jy: Number) -> None:
        if self.scene.circles[body.index].fixed:
            return
        body.vx = body.vx + body.w * jx
        body.vy = body.vy + body.w * jy
        body.rest = False

    def _kick_together(self, links: tuple[Link, ...]) -> None:
        matrix, approaches = self.contact_system(links)
        strengths = solve_positive(matrix, [-(u + u) for u in approaches])
        for link, strength in zip(links, strengths, strict=True):
            for index, jx, jy in self.arms(link):
                self._push(self.bodies[index], strength * jx, strength * jy)

    def arms(self, link: Link) -> list[tuple[int, Number, Number]]:
        """The bodies of a contact, each with the direction in which the impulse pushes it (not normalised)."""
        i, j = link
        a = self.bodies[i]
        if j < self.n:
            b = self.bodies[j]
            dx, dy = b.x - a.x, b.y - a.y
            return [(i, -dx, -dy), (j, dx, dy)]
        line = self.line(a, j - self.n)
        return [(i, line.nx, line.ny)]

    def contact_system(self, links: Sequence[Link]) -> tuple[list[list[Number]], list[Number]]:
        """The matrix by which impulses change separation speeds, and those speeds now.

        With J the arms of the contacts and W the inverse masses: G = J W J^T (symmetric, positive semidefinite)
        and u = J v, both in the scale of the arms. Impulses s change u by G s.
        """
        arms = [{index: (jx, jy) for index, jx, jy in self.arms(link)} for link in links]
        matrix = []
        for mine in arms:
            row = []
            for other in arms:
                entry = self.zero
                for index, (jx, jy) in mine.items():
                    if index in other and not self.scene.circles[index].fixed:
                        kx, ky = other[index]
                        entry = entry + self.bodies[index].w * (jx * kx + jy * ky)
                row.append(entry)
            matrix.append(row)
        return matrix, [self.approach(link) for link in links]

    def flip(self) -> None:
        """Negates every velocity, and keeps the moment."""
        for body in self.bodies.values() if isinstance(self.bodies, dict) else self.bodies:
            self.flip_time = body.t
            if not body.rest:
                body.vx, body.vy = -body.vx, -body.vy
            body.last = self.steps_done


def solve_positive(matrix: Sequence[Sequence[Number]], right: Sequence[Number]) -> list[Number]:
    """Solves a symmetric positive definite system by elimination; its pivots need no choice.

    >>> from fractions import Fraction as Q
    >>> solve_positive([[Q(2), Q(1)], [Q(1), Q(2)]], [Q(3), Q(0)])
    [Fraction(2, 1), Fraction(-1, 1)]
    """
    rows = [[*row, value] for row, value in zip(matrix, right, strict=True)]
    size = len(rows)
    for k in range(size):
        for below in rows[k + 1 :]:
            factor = below[k] / rows[k][k]
            for column in range(k + 1, size + 1):
                below[column] = below[column] - factor * rows[k][column]
    solution: list[Number] = [None] * size
    for k in reversed(range(size)):
        value = rows[k][size]
        for column in range(k + 1, size):
            value = value - rows[k][column] * solution[column]
        solution[k] = value / rows[k][k]
    return solution


class Sides:
    """On which side of each wall each circle starts, and so stays: decided exactly, once, when asked."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._known: dict[tuple[int, int], bool] = {}

    def negative(self, circle: int, wall: int) -> bool:
        """Whether the circle lies where the wall's own normal does not point."""
        key = (circle, wall)
        if key not in self._known:
            where = self.scene.circles[circle]
            self._known[key] = self.scene.walls[wall].height(where.x, where.y).sign() < 0
        return self._known[key]
