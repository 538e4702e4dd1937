"""A state on balls that loses few bits: clocks without radius, reflections as matrices, contacts from laws.

Interval arithmetic pays for every number that it uses twice. So:

- A body's clock is a number without radius, the midpoint of its last instant's ball; the body is kept as its
  straight line at that clock, and only the change of velocity is carried over the (tiny, uncertain) time between
  clock and instant. The uncertainty of a hit time then enters a position by |change of v|, not by |v|, and lags
  between clocks have none.
- So a line holds from its instant on, and not from its clock: whether two come nearer and are apart is asked at the
  later instant (`gap`, `approach`), a little before or after the later clock.
- A wall mirrors the line itself: x' = H x + c with the Householder matrix H = I - 2 n n^T / |n|^2, whatever the
  instant.
- At contact, d has the d x v of before and d.v = -sqrt(discriminant): no time in it, and the first impulse of an
  instant needs nothing else.
- Where two circles fly exactly head on, as on a line, nothing need be lost: the direction of v is then known exactly
  or nearly so, and the lines after are matrices times those before, v_a' = (I - A) v_a + A v_b, cut with what the
  impulse tells. Elsewhere that would save a tenth of the bits for a fourth of the time.
"""

from __future__ import annotations

from typing import TypeAlias

from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ..laws.formulas import (
    advance,
    pair_approach,
    pair_gap,
    pair_head_on,
    pair_meeting,
    pair_mix,
    pair_strength,
    wall_mirror,
)
from ..numbers import ball
from ..numbers.system import Number
from .body import Body
from .state import State
from .steps import Link

Told: TypeAlias = tuple[Link, Number, Number] | None
"""A contact of two circles, and d at it, as the law of their meeting tells it."""


class BallState(State):
    """`State` on `flint.arb`, at flint's working precision."""

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene, ball.BALLS)
        self._told: Told = None
        self._root: Number | None = None
        self._straight = False
        self._mirrors: dict[int, tuple[Number, Number, Number]] = {}

    def set_instant(self, base: Number, wait: Number) -> tuple[Number, Number]:
        """A clock without radius at the middle of the instant."""
        instant = base + wait
        clock = instant.mid()
        lag = clock - base
        self.instant, self.late = instant, wait - lag
        return clock, lag

    def _hit_from_base(self, source: Link) -> tuple[Number, Number]:
        """The time of the hit, and for two circles their d at it."""
        i, j = source
        if j >= self.n:
            return self.hit(source)
        t, wait, dx, dy, root = self._meeting(i, j)
        self._told, self._root, self._straight = (source, dx, dy), root, root is None
        return t, wait

    def span(self, i: int, j: int) -> tuple[Number, Number]:
        """d at the instant: from the bodies' places, cut with what the law of the meeting told of it."""
        if self.met is not None and self.met[0] == (i, j):
            return self.met[1], self.met[2]
        dx, dy = super().span(i, j)
        if self._told is not None and self._told[0] == (i, j):
            dx, dy = dx.intersection(self._told[1]), dy.intersection(self._told[2])
            self.met = ((i, j), dx, dy)
        return dx, dy

    def go(self, source: Link | int | Quantity, bodies: tuple[int, ...]) -> None:
        """As `State.go`."""
        self._told = self._root = None
        super().go(source, bodies)

    def kick(self, links: tuple[Link, ...]) -> None:
        """As `State.kick`; the law of the meeting tells the first impulse of an instant, and no other."""
        if self._root is not None and self._told is not None and links == (self._told[0],):
            self._bounce_first(*self._told, self._root)
        else:
            super().kick(links)
        self._root = None

    def _bounce_first(self, link: Link, dx: Number, dy: Number, root: Number) -> None:
        """The elastic bounce of two circles that meet at the instant, with d and d.v as their meeting tells them."""
        a, b = self.bodies[link[0]], self.bodies[link[1]]
        strength = pair_strength(root, self.reach(a, b), a.w, b.w)
        jx, jy = strength * dx, strength * dy
        self._push(a, -jx, -jy)
        self._push(b, jx, jy)

    def forget_contact(self) -> None:
        """After an instant reached in another system: clocks are the instant itself, and no d is known beforehand."""
        self.late, self.met, self._told = None, None, None

    def become(self, other: BallState) -> None:
        """Takes over the numbers of the same state, computed again; the bodies stay the same objects."""
        for mine, new in zip(self.bodies, other.bodies, strict=True):
            mine.become(new)
        self._lines, self._mirrors, self._told = other._lines, other._mirrors, other._told
        self.zero, self.one, self.flip_time = other.zero, other.one, other.flip_time
        self.instant, self.late, self.met = other.instant, other.late, other.met

    def gap(self, link: Link) -> Number:
        """As `State.gap`, at the instant of the later of the two: its clock may stand before or after it."""
        i, j = link
        if j >= self.n:
            return self.wall_gap(self.bodies[i], j - self.n, *self.place(self.bodies[i]))
        pair, late = self.relation(i, j), self.later(i, j).late
        if late is None:
            return pair_gap(pair.dx, pair.dy, pair.reach)
        return pair_gap(advance(pair.dx, pair.vx, late), advance(pair.dy, pair.vy, late), pair.reach)

    def approach(self, link: Link) -> Number:
        """As `State.approach`, at the instant of the later of the two."""
        i, j = link
        late = None if j >= self.n else self.later(i, j).late
        if late is None:
            return super().approach(link)
        pair = self.relation(i, j)
        dx, dy = advance(pair.dx, pair.vx, late), advance(pair.dy, pair.vy, late)
        return pair_approach(dx, dy, pair.vx, pair.vy)

    def hit(self, link: Link) -> tuple[Number, Number]:
        """As `State.hit`, in the sharper form."""
        i, j = link
        return self._meeting(i, j)[:2] if j < self.n else super().hit(link)

    def _meeting(self, i: int, j: int) -> tuple[Number, Number, Number, Number, Number | None]:
        """The clock and the time from it to the hit of two circles; their d at the hit; and -d.v at it.

        Where they fly exactly head on, in the form that loses nothing (see `_head_on`), and d.v is left out.
        """
        t, dx, dy, vx, vy, reach = self.relation(i, j)
        cross = dx * vy - dy * vx
        if cross.is_zero():
            return t, *self._head_on(dx, dy, vx, vy, reach), None
        square = vx * vx + vy * vy
        root = self.root(square * (reach * reach) - cross * cross)
        return t, *pair_meeting(dx * vx + dy * vy, cross, square, root, vx, vy), root

    def _head_on(self, dx: Number, dy: Number, vx: Number, vy: Number, reach: Number) -> tuple[Number, Number, Number]:
        """The time to the hit of two circles whose d and v are parallel, and d at it.

        The direction u of v comes from the quotient of v's components, so that only the uncertainty of that enters.
        """
        steep = abs(float(vx)) < abs(float(vy))
        quotient = vx / vy if steep else vy / vx
        stretch = (self.one + quotient * quotient).sqrt()
        speed = (vy if steep else vx) * stretch
        ux, uy = self.one / stretch, quotient / stretch
        if steep:
            ux, uy = uy, ux
        if speed < ball.ZERO:
            speed, ux, uy = -speed, -ux, -uy
        return pair_head_on(dx, dy, ux, uy, speed, reach)

    def bounce_pair(self, a: Body, b: Body) -> None:
        """As `State.bounce_pair`; where the two met head on, the lines are mixed, as the velocities are."""
        if self._told is None or self._told[0] != (a.index, b.index) or not self._straight:
            super().bounce_pair(a, b)
            return
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
        """As `State.bounce_wall`: the line is mirrored."""
        line = self.line(a, wall)
        if wall not in self._mirrors:
            self._mirrors[wall] = wall_mirror(line.nx, line.ny, line.nn)
        xx, xy, yy = self._mirrors[wall]
        if self.late is not None:
            offset = line.nx * line.x0 + line.ny * line.y0 + a.r * line.length
            shift = (offset + offset) / line.nn
            a.x, a.y = xx * a.x + xy * a.y + shift * line.nx, xy * a.x + yy * a.y + shift * line.ny
        a.vx, a.vy = xx * a.vx + xy * a.vy, xy * a.vx + yy * a.vy
