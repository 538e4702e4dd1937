"""Carries out an event log in any number system: advance bodies to a contact, apply impulses, flip velocities.

An event log holds no decisions: given the scene and the log, every number of a run can be computed
again, to more bits or in nested square roots. What an event-driven engine keeps while it runs is such a state too, fed
one step at a time.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ..laws.formulas import advance, pair_approach, pair_gap, pair_impulse, wall_bounce
from ..numbers.system import Arithmetic, Number
from .body import Body
from .flights import Flights
from .linear import solve_positive
from .steps import Go, Kick, Link, Step, Take


class State(Flights):
    """Flights, and the steps of a log upon them.

    Args:
        scene, numbers, only: see `Flights`.

    Attributes:
        steps_done: the number of steps carried out.
        instant, late: of the last step that advanced, the instant and the time to it from the clock (None: none).
        flip_time: the moment of the reversal.
    """

    def __init__(self, scene: Scene, numbers: Arithmetic, only: Iterable[int] | None = None) -> None:
        super().__init__(scene, numbers, only)
        self.steps_done = 0
        self.flip_time = self.zero
        self.instant = self.zero
        self.late: Number | None = None
        self.met: tuple[Link, Number, Number] | None = None

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

    def rim(self, link: Link) -> Number:
        """|d|^2 - R^2 of a centre and a pocket, at the instant at which the circle stands."""
        return pair_gap(*self.span(*link), self.bodies[link[1]].r)

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
