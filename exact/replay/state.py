"""Carries out an event log in any number system: advance bodies to a contact, apply impulses, flip velocities.

An event log holds no decisions: given the scene and the log, every number of a run can be computed
again, to more bits or in nested square roots. What an event-driven engine keeps while it runs is such a state too, fed
one step at a time.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ..laws.formulas import (
    advance,
    pair_approach,
    pair_discriminant,
    pair_gap,
    pair_hit_time,
    pair_impulse,
    pair_nearest_time,
    wall_approach,
    wall_bounce,
    wall_gap,
    wall_hit_time,
)
from ..numbers.system import Arithmetic, Number
from .body import Body
from .linear import solve_positive
from .sides import Sides
from .steps import Go, Kick, Link, Step, Take


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


class State:
    """Bodies and walls of a scene in one number system, and the steps of a log upon them.

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
        self.steps_done = 0
        self.flip_time = self.zero
        self.instant = self.zero
        self.late: Number | None = None
        self.met: tuple[Link, Number, Number] | None = None
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

    def rim(self, link: Link) -> Number:
        """|d|^2 - R^2 of a centre and a pocket, at the instant at which the circle stands."""
        return pair_gap(*self.span(*link), self.bodies[link[1]].r)

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

    # -- the steps

    def do(self, step: Step) -> None:
        """Carries out one step of a log."""
        self.steps_done += 1
        if type(step) is Go:
            self.go(step.source, step.bodies)
        elif type(step) is Kick:
            self.kick(step.links)
        elif type(step) is Take:
            self.take(step.body)
        else:
            self.flip()

    def go(self, source: Link | int | Quantity, bodies: tuple[int, ...]) -> None:
        """Advances bodies to the instant that `source` names (see `Go`)."""
        self.met = None
        if isinstance(source, tuple):
            base, wait = self._hit_from_base(source)
            clock, lag = self.set_instant(base, wait)
        elif isinstance(source, int):
            clock = self.recall(self.bodies[source])
            base = lag = None
        else:
            base = lag = None
            clock = self.constant(source)
            self.instant, self.late = clock, None
        for index in bodies:
            body = self.bodies[index]
            if not body.rest and body.t is not clock:
                step = lag if body.t is base else clock - body.t
                body.x, body.y = advance(body.x, body.vx, step), advance(body.y, body.vy, step)
            body.t = clock
            body.last = self.steps_done
            body.instant, body.late = self.instant, self.late

    def _hit_from_base(self, source: Link) -> tuple[Number, Number]:
        """The time of a hit, as `hit`; a state may note more of the contact here."""
        return self.hit(source)

    def set_instant(self, base: Number, wait: Number) -> tuple[Number, Number]:
        """Fixes the instant base + wait; gives the clock at which bodies will stand, and its distance from base.

        In exact numbers the clock is the instant. Enclosures may choose a clock beside it and set `late` to the
        (small) time from the clock to the instant.
        """
        self.instant, self.late = base + wait, None
        return self.instant, wait

    def recall(self, body: Body) -> Number:
        """The clock of a body's last instant, which becomes the state's."""
        self.instant, self.late = body.instant, body.late
        return body.t

    def place(self, body: Body) -> tuple[Number, Number]:
        """Where a body is at the instant of its last contact."""
        if body.late is None:
            return body.x, body.y
        return advance(body.x, body.vx, body.late), advance(body.y, body.vy, body.late)

    def span(self, i: int, j: int) -> tuple[Number, Number]:
        """d of two bodies at the instant."""
        if self.met is not None and self.met[0] == (i, j):
            return self.met[1], self.met[2]
        ax, ay = self.place(self.bodies[i])
        bx, by = self.place(self.bodies[j])
        return bx - ax, by - ay

    def closing(self, link: Link) -> Number:
        """d.v at the instant (for a wall n.v): negative while the two come nearer."""
        i, j = link
        if j >= self.n:
            return self.approach(link)
        a, b = self.bodies[i], self.bodies[j]
        return pair_approach(*self.span(i, j), b.vx - a.vx, b.vy - a.vy)

    def kick(self, links: tuple[Link, ...]) -> None:
        """Applies the impulses of contacts together; each then separates as fast as it approached."""
        if len(links) > 1:
            self._kick_together(links)
            return
        i, j = next(iter(links))
        a = self.bodies[i]
        if j < self.n:
            self.bounce_pair(a, self.bodies[j])
        else:
            self.bounce_wall(a, j - self.n)

    def bounce_pair(self, a: Body, b: Body) -> None:
        """The elastic bounce of two circles."""
        dx, dy = self.span(a.index, b.index)
        jx, jy = pair_impulse(dx, dy, b.vx - a.vx, b.vy - a.vy, self.reach(a, b), a.w, b.w)
        self._push(a, -jx, -jy)
        self._push(b, jx, jy)

    def bounce_wall(self, a: Body, wall: int) -> None:
        """The elastic bounce of a circle off a wall."""
        line = self.line(a, wall)
        a.vx, a.vy = wall_bounce(a.vx, a.vy, line.nx, line.ny, line.nn)

    def _push(self, body: Body, jx: Number, jy: Number) -> None:
        if self.scene.circles[body.index].fixed:
            return
        ux, uy = body.w * jx, body.w * jy
        body.vx = body.vx + ux
        body.vy = body.vy + uy
        body.rest = False
        if self.late is not None:
            body.x = body.x - ux * self.late
            body.y = body.y - uy * self.late

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
            dx, dy = self.span(i, j)
            return [(i, -dx, -dy), (j, dx, dy)]
        line = self.line(a, j - self.n)
        return [(i, line.nx, line.ny)]

    def contact_system(self, links: Sequence[Link]) -> tuple[list[list[Number]], list[Number]]:
        """The matrix by which impulses change separation speeds, and those speeds now.

        With J the arms of the contacts and W the inverse masses: G = J W J^T (symmetric, positive semidefinite)
        and u = J v, both in the scale of the arms. Impulses s change u by G s.
        """
        arms = [self.arms(link) for link in links]
        bodies, circles, zero = self.bodies, self.scene.circles, self.zero
        pushed = [
            {i: (bodies[i].w * jx, bodies[i].w * jy) for i, jx, jy in mine if not circles[i].fixed} for mine in arms
        ]
        size = range(len(arms))
        matrix: list[list[Number]] = [[zero] * len(arms) for _ in size]
        for row in size:
            for column in range(row + 1):
                entry = zero
                for i, jx, jy in arms[row]:
                    if i in pushed[column]:
                        kx, ky = pushed[column][i]
                        entry = entry + (jx * kx + jy * ky)
                matrix[row][column] = matrix[column][row] = entry
        return matrix, [self.closing(link) for link in links]

    def take(self, index: int) -> None:
        """Takes a body out of play, where it is at the instant."""
        body = self.bodies[index]
        body.x, body.y = self.place(body)
        body.vx = body.vy = self.zero
        body.rest = True

    def flip(self) -> None:
        """Negates every velocity, and keeps the moment."""
        self.flip_time = self.instant
        for body in self.bodies.values() if isinstance(self.bodies, dict) else self.bodies:
            if not body.rest:
                if self.late is not None:
                    twice = self.late + self.late
                    body.x, body.y = advance(body.x, body.vx, twice), advance(body.y, body.vy, twice)
                body.vx, body.vy = -body.vx, -body.vy
            body.last = self.steps_done


def replay(state: State, steps: Sequence[Step], needed: Iterable[int]) -> None:
    """Carries out the needed steps of a log on a state that may hold only some of the bodies."""
    held = set(state.bodies) if isinstance(state.bodies, dict) else None
    for k in needed:
        step = steps[k]
        if held is not None and isinstance(step, Go):
            step = Go(step.source, tuple(i for i in step.bodies if i in held))
        state.steps_done = k
        state.do(step)
