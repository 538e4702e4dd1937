"""A machine on balls that loses few bits: clocks without radius, reflections as matrices, contacts from laws.

Interval arithmetic pays for every number that it uses twice. So:

- A body's clock is a number without radius, the midpoint of its last instant's ball; the body is kept as its
  straight line at that clock, and only the change of velocity is carried over the (tiny, uncertain) time between
  clock and instant. The uncertainty of a hit time then enters a position by |change of v|, not by |v|, and lags
  between clocks have none.
- So a line holds from its instant on, and not from its clock: whether two come nearer and are apart is asked at the
  later instant (`gap`, `approach`), a little before or after the later clock.
- A wall mirrors the line itself: x' = H x + c with the Householder matrix H = I - 2 n n^T / |n|^2, whatever the
  instant.
- At contact, d has the d x v of before and d.v = -sqrt(discriminant): no time in it.
- The velocities after are matrices times those before: v_a' = (I - A) v_a + A v_b.
- Where two formulas enclose one number, neither always sharper, the number lies in both: their intersection is
  kept. So it is with the time of a hit, d at contact, and the line after it.
"""

from __future__ import annotations

from ..scenarios.numbers.quantity import Quantity
from ..scenarios.scene import Scene
from .formulas import advance, pair_approach, pair_gap, pair_mix, wall_gap, wall_mirror
from .machine import Body, Link, Machine, Number
from .numbers import ball


class BallMachine(Machine):
    """`Machine` on `flint.arb`, at flint's working precision."""

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene, ball.constant, ball.root)
        self._told: tuple[Link, Number, Number] | None = None
        self._mirrors: dict[int, tuple[Number, Number, Number]] = {}

    def set_instant(self, base: Number, wait: Number) -> tuple[Number, Number]:
        """A clock without radius at the middle of the instant."""
        instant = base + wait
        clock = instant.mid()
        lag = clock - base
        self.instant, self.late = instant, wait - lag
        return clock, lag

    def _hit_from_base(self, source: Link) -> tuple[Number, Number]:
        """The time of the hit, and for two circles their d at it, each cut from two enclosures."""
        i, j = source
        if j >= self.n:
            return super().hit(source)
        t, wait, dx, dy = self._encounter(i, j)
        self._told = (source, dx, dy)
        return t, wait.intersection(super().hit(source)[1])

    def span(self, i: int, j: int) -> tuple[Number, Number]:
        """d at the instant: from the bodies' places, cut with what the law of the encounter told of it."""
        if self.met is not None and self.met[0] == (i, j):
            return self.met[1], self.met[2]
        dx, dy = super().span(i, j)
        if self._told is not None and self._told[0] == (i, j):
            dx, dy = dx.intersection(self._told[1]), dy.intersection(self._told[2])
            self.met = ((i, j), dx, dy)
        return dx, dy

    def go(self, source: Link | int | Quantity, bodies: tuple[int, ...]) -> None:
        """As `Machine.go`."""
        self._told = None
        super().go(source, bodies)

    def gap(self, link: Link) -> Number:
        """As `Machine.gap`, at the instant of the later of the two: its clock may stand before or after it."""
        i, j = link
        if j >= self.n:
            body = self.bodies[i]
            line = self.line(body, j - self.n)
            return wall_gap(*self.place(body), line.x0, line.y0, line.nx, line.ny, body.r * line.length)
        state, late = self.relation(i, j), self.later(i, j).late
        if late is None:
            return pair_gap(state.dx, state.dy, state.reach)
        return pair_gap(advance(state.dx, state.vx, late), advance(state.dy, state.vy, late), state.reach)

    def approach(self, link: Link) -> Number:
        """As `Machine.approach`, at the instant of the later of the two."""
        i, j = link
        late = None if j >= self.n else self.later(i, j).late
        if late is None:
            return super().approach(link)
        state = self.relation(i, j)
        dx, dy = advance(state.dx, state.vx, late), advance(state.dy, state.vy, late)
        return pair_approach(dx, dy, state.vx, state.vy)

    def hit(self, link: Link) -> tuple[Number, Number]:
        """As `Machine.hit`, in the sharper form."""
        i, j = link
        return self._encounter(i, j)[:2] if j < self.n else super().hit(link)

    def _encounter(self, i: int, j: int) -> tuple[Number, Number, Number, Number]:
        """The clock and the time from it to the hit of two circles, and their d at the hit.

        With u the direction of v, p = d x u is the distance at which the centres would pass, h = sqrt(R^2 - p^2)
        the way still to go then: the hit is -(d.u + h)/|v| away, and there d = p u' - h u, u' = (u_y, -u_x).
        u comes from the quotient of v's components, so that only the uncertainty of v's direction enters.
        """
        t, dx, dy, vx, vy, reach = self.relation(i, j)
        if abs(float(vx)) >= abs(float(vy)):
            quotient = vy / vx
            stretch = (self.one + quotient * quotient).sqrt()
            speed = vx * stretch
            ux, uy = self.one / stretch, quotient / stretch
        else:
            quotient = vx / vy
            stretch = (self.one + quotient * quotient).sqrt()
            speed = vy * stretch
            ux, uy = quotient / stretch, self.one / stretch
        if speed < ball.ZERO:
            speed, ux, uy = -speed, -ux, -uy
        passing = dx * uy - dy * ux
        depth = self.root(reach * reach - passing * passing)
        wait = -(dx * ux + dy * uy + depth) / speed
        return t, wait, passing * uy - depth * ux, -(passing * ux + depth * uy)

    def bounce_pair(self, a: Body, b: Body) -> None:
        """As `Machine.bounce_pair`: the lines are mixed, as the velocities are."""
        dx, dy = self.span(a.index, b.index)
        shares = pair_mix(dx, dy, self.reach(a, b), a.w, b.w)
        origin = (a.x.mid(), a.y.mid(), a.vx.mid(), a.vy.mid())
        state_a = [value - shift for value, shift in zip((a.x, a.y, a.vx, a.vy), origin, strict=True)]
        state_b = [value - shift for value, shift in zip((b.x, b.y, b.vx, b.vy), origin, strict=True)]
        if not self.scene.circles[a.index].fixed:
            self._mix(a, shares[:4], state_a, state_b, origin, -dx, -dy)
        if not self.scene.circles[b.index].fixed:
            self._mix(b, shares[4:], state_b, state_a, origin, dx, dy)

    def _mix(
        self,
        body: Body,
        share: tuple[Number, ...],
        own: list[Number],
        other: list[Number],
        origin: tuple[Number, ...],
        dx: Number,
        dy: Number,
    ) -> None:
        """v' = (I - A) v + A w for the velocities, the same plus k d for the lines at the clock.

        Reckoned from an origin (in position and velocity) beside one of the two: A's uncertainty then multiplies
        their differences only.
        """
        xx, xy, yy, k = share
        x, y, vx, vy = own
        px, py, wx, wy = other
        left, right = self.one - xx, self.one - yy
        body.vx = origin[2] + (left * vx - xy * vy + xx * wx + xy * wy)
        body.vy = origin[3] + (right * vy - xy * vx + xy * wx + yy * wy)
        if self.late is not None:
            ux, uy = vx - wx, vy - wy
            mixed_x = origin[0] + (left * x - xy * y + xx * px + xy * py + k * dx)
            mixed_y = origin[1] + (right * y - xy * x + xy * px + yy * py + k * dy)
            body.x = mixed_x.intersection(body.x + (xx * ux + xy * uy) * self.late)
            body.y = mixed_y.intersection(body.y + (xy * ux + yy * uy) * self.late)
        body.rest = False

    def bounce_wall(self, a: Body, wall: int) -> None:
        """As `Machine.bounce_wall`: the line is mirrored."""
        line = self.line(a, wall)
        if wall not in self._mirrors:
            self._mirrors[wall] = wall_mirror(line.nx, line.ny, line.nn)
        xx, xy, yy = self._mirrors[wall]
        if self.late is not None:
            offset = line.nx * line.x0 + line.ny * line.y0 + a.r * line.length
            shift = (offset + offset) / line.nn
            a.x, a.y = xx * a.x + xy * a.y + shift * line.nx, xy * a.x + yy * a.y + shift * line.ny
        a.vx, a.vy = xx * a.vx + xy * a.vy, xy * a.vx + yy * a.vy
