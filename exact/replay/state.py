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
from ..numbers.linear import solve_positive
from ..numbers.system import Arithmetic, N
from .body import Body, Flight
from .contact import AtWall, Entry, Link, Pair, Round, Touch
from .flights import Flights
from .steps import Go, Kick, Step, Take


class State(Flights[N]):
    """Flights, and the steps of a log upon them.

    Args:
        scene, numbers, only: see `Flights`.

    Attributes:
        steps_done: the number of steps carried out.
        instant, late: of the last step that advanced, the instant and the time to it from the clock (None: none).
        flip_time: the moment of the reversal.
        met: a contact, and d at it, where that is known.
    """

    def __init__(self, scene: Scene, numbers: Arithmetic[N], only: Iterable[int] | None = None) -> None:
        super().__init__(scene, numbers, only)
        self.steps_done = 0
        self.flip_time: N = self.zero
        self.instant: N = self.zero
        self.late: N | None = None
        self.met: tuple[Round, N, N] | None = None

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
        base = lag = None
        if isinstance(source, tuple):
            base, wait = self._hit_from_base(source)
            clock, lag = self.set_instant(base, wait)
        elif isinstance(source, int):
            clock = self.recall(self.bodies[source])
        else:
            clock = self.constant(source)
            self.instant, self.late = clock, None
        instant, late, done = self.instant, self.late, self.steps_done
        for index in bodies:
            body = self.bodies[index]
            x, y, vx, vy, t, _, _, _, rest = body.flight
            if not rest and t is not clock:
                step = lag if lag is not None and t is base else clock - t
                x, y = advance(x, vx, step), advance(y, vy, step)
            body.flight = Flight(x, y, vx, vy, clock, instant, late, done, rest)

    def _hit_from_base(self, source: Link) -> tuple[N, N]:
        """The time of a hit; a state may note more of the contact here."""
        return source.hit(self)

    def set_instant(self, base: N, wait: N) -> tuple[N, N]:
        """Fixes the instant base + wait; gives the clock at which bodies will stand, and its distance from base.

        In exact numbers the clock is the instant. Enclosures may choose a clock beside it and set `late` to the
        (small) time from the clock to the instant.
        """
        self.instant, self.late = base + wait, None
        return self.instant, wait

    def recall(self, body: Body[N]) -> N:
        """The clock of a body's last instant, which becomes the state's."""
        self.instant, self.late = body.flight.instant, body.flight.late
        return body.flight.t

    def place(self, body: Body[N]) -> tuple[N, N]:
        """Where a body is at the instant of its last contact."""
        x, y, vx, vy, _, _, late, *_ = body.flight
        return (x, y) if late is None else (advance(x, vx, late), advance(y, vy, late))

    def span(self, link: Round) -> tuple[N, N]:
        """d of two bodies at the instant."""
        if self.met is not None and self.met[0] == link:
            return self.met[1], self.met[2]
        a, b = link.ends(self)
        (ax, ay), (bx, by) = self.place(a), self.place(b)
        return bx - ax, by - ay

    def rim(self, link: Entry) -> N:
        """|d|^2 - R^2 of a centre and a pocket, at the instant at which the circle stands."""
        return pair_gap(*self.span(link), self.pockets[link.pocket].r)

    def round_closing(self, link: Round) -> N:
        """d.v at the instant: negative while the two come nearer."""
        a, b = link.ends(self)
        return pair_approach(*self.span(link), b.flight.vx - a.flight.vx, b.flight.vy - a.flight.vy)

    # -- impulses

    def kick(self, links: tuple[Touch, ...]) -> None:
        """Applies the impulses of contacts together; each then separates as fast as it approached."""
        if len(links) > 1:
            self._kick_together(links)
        else:
            for link in links:
                link.bounce(self)

    def bounce_pair(self, link: Pair) -> None:
        """The elastic bounce of two circles."""
        dx, dy = self.span(link)
        a, b = link.ends(self)
        vx, vy = b.flight.vx - a.flight.vx, b.flight.vy - a.flight.vy
        jx, jy = pair_impulse(dx, dy, vx, vy, self.reach(a, b), a.w, b.w)
        self.push(a, -jx, -jy)
        self.push(b, jx, jy)

    def bounce_wall(self, link: AtWall) -> None:
        """The elastic bounce of a circle off a wall."""
        body, line = self.bodies[link.circle], self.line(link.circle, link.wall)
        x, y, vx, vy, t, instant, late, last, rest = body.flight
        vx, vy = wall_bounce(vx, vy, line.nx, line.ny, line.nn)
        body.flight = Flight(x, y, vx, vy, t, instant, late, last, rest)

    def push(self, body: Body[N], jx: N, jy: N) -> None:
        """Gives a circle an impulse; a fixed one takes none."""
        if self.scene.circles[body.index].fixed:
            return
        x, y, vx, vy, t, instant, own, last, _ = body.flight
        ux, uy = body.w * jx, body.w * jy
        if self.late is not None:
            x, y = x - ux * self.late, y - uy * self.late
        body.flight = Flight(x, y, vx + ux, vy + uy, t, instant, own, last)

    def _kick_together(self, links: tuple[Touch, ...]) -> None:
        matrix, approaches = self.contact_system(links)
        strengths = solve_positive(matrix, [-(u + u) for u in approaches])
        for link, strength in zip(links, strengths, strict=True):
            for index, jx, jy in link.arms(self):
                self.push(self.bodies[index], strength * jx, strength * jy)

    def pair_arms(self, link: Pair) -> list[tuple[int, N, N]]:
        """The circles of a contact, each with the direction in which the impulse pushes it (not normalised)."""
        dx, dy = self.span(link)
        return [(link.a, -dx, -dy), (link.b, dx, dy)]

    def wall_arms(self, link: AtWall) -> list[tuple[int, N, N]]:
        """As `pair_arms`."""
        line = self.line(link.circle, link.wall)
        return [(link.circle, line.nx, line.ny)]

    def contact_system(self, links: Sequence[Touch]) -> tuple[list[list[N]], list[N]]:
        """The matrix by which impulses change separation speeds, and those speeds now.

        With J the arms of the contacts and W the inverse masses: G = J W J^T (symmetric, positive semidefinite)
        and u = J v, both in the scale of the arms. Impulses s change u by G s.
        """
        arms = [link.arms(self) for link in links]
        bodies, circles, zero = self.bodies, self.scene.circles, self.zero
        pushed = [
            {i: (bodies[i].w * jx, bodies[i].w * jy) for i, jx, jy in mine if not circles[i].fixed} for mine in arms
        ]
        size = range(len(arms))
        matrix: list[list[N]] = [[zero] * len(arms) for _ in size]
        for row in size:
            for column in range(row + 1):
                entry = zero
                for i, jx, jy in arms[row]:
                    if i in pushed[column]:
                        kx, ky = pushed[column][i]
                        entry = entry + (jx * kx + jy * ky)
                matrix[row][column] = matrix[column][row] = entry
        return matrix, [link.closing(self) for link in links]

    # -- what changes all at once

    def take(self, index: int) -> None:
        """Takes a body out of play, where it is at the instant."""
        body, zero = self.bodies[index], self.zero
        x, y = self.place(body)
        _, _, _, _, t, instant, late, last, _ = body.flight
        body.flight = Flight(x, y, zero, zero, t, instant, late, last, rest=True)

    def flip(self) -> None:
        """Negates every velocity, and keeps the moment."""
        self.flip_time = self.instant
        twice = None if self.late is None else self.late + self.late
        for body in self.bodies.values():
            x, y, vx, vy, t, instant, late, _, rest = body.flight
            if not rest:
                if twice is not None:
                    x, y = advance(x, vx, twice), advance(y, vy, twice)
                vx, vy = -vx, -vy
            body.flight = Flight(x, y, vx, vy, t, instant, late, self.steps_done, rest)


def replay(state: State[N], steps: Sequence[Step], needed: Iterable[int]) -> None:
    """Carries out the needed steps of a log on a state that may hold only some of the bodies."""
    held = state.bodies
    for k in needed:
        step = steps[k]
        if isinstance(step, Go) and len(held) < state.n:
            step = Go(step.source, tuple(i for i in step.bodies if i in held))
        state.steps_done = k
        state.do(step)
