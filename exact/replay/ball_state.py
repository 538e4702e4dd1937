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

from flint import arb

from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ..laws.formulas import pair_head_on, pair_meeting, pair_mix, pair_strength, wall_mirror
from ..numbers import ball
from .body import Body, Flight
from .contact import AtWall, Link, Pair, Round, Touch
from .state import State

Told: TypeAlias = tuple[Round, arb, arb] | None
"""A contact of two circles, and d at it, as the law of their meeting tells it."""

Mirror: TypeAlias = tuple[arb, arb, arb]
"""(xx, xy, yy) of a symmetric matrix."""


class BallState(State[arb]):
    """`State` on `flint.arb`, at flint's working precision."""

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene, ball.BALLS)
        self._told: Told = None
        self._root: arb | None = None
        self._straight = False
        self._mirrors: dict[int, Mirror] = {}

    def set_instant(self, base: arb, wait: arb) -> tuple[arb, arb]:
        """A clock without radius at the middle of the instant."""
        instant = base + wait
        clock = instant.mid()
        lag = clock - base
        self.instant, self.late = instant, wait - lag
        return clock, lag

    def _hit_from_base(self, source: Link) -> tuple[arb, arb]:
        """The time of the hit, and for two circles their d at it."""
        if isinstance(source, AtWall):
            return source.hit(self)
        t, wait, dx, dy, root = self._meeting(source)
        self._told, self._root, self._straight = (source, dx, dy), root, root is None
        return t, wait

    def span(self, link: Round) -> tuple[arb, arb]:
        """d at the instant: from the bodies' places, cut with what the law of the meeting told of it."""
        if self.met is not None and self.met[0] == link:
            return self.met[1], self.met[2]
        dx, dy = super().span(link)
        if self._told is not None and self._told[0] == link:
            dx, dy = dx.intersection(self._told[1]), dy.intersection(self._told[2])
            self.met = (link, dx, dy)
        return dx, dy

    def go(self, source: Link | int | Quantity, bodies: tuple[int, ...]) -> None:
        """As `State.go`."""
        self._told = self._root = None
        super().go(source, bodies)

    def kick(self, links: tuple[Touch, ...]) -> None:
        """As `State.kick`; the law of the meeting tells the first impulse of an instant, and no other."""
        if self._root is not None and self._told is not None and links == (self._told[0],):
            self._bounce_first(*self._told, self._root)
        else:
            super().kick(links)
        self._root = None

    def _bounce_first(self, link: Round, dx: arb, dy: arb, root: arb) -> None:
        """The elastic bounce of two circles that meet at the instant, with d and d.v as their meeting tells them."""
        a, b = link.ends(self)
        strength = pair_strength(root, self.reach(a, b), a.w, b.w)
        jx, jy = strength * dx, strength * dy
        self.push(a, -jx, -jy)
        self.push(b, jx, jy)

    def forget_contact(self) -> None:
        """After an instant reached in another system: clocks are the instant itself, and no d is known beforehand."""
        self.late, self.met, self._told = None, None, None

    def stand(self, instant: arb, late: arb, steps_done: int) -> None:
        """At an instant, after steps carried out elsewhere (see `LoneContacts`)."""
        self.instant, self.late, self.steps_done = instant, late, steps_done
        self.met = self._told = self._root = None

    def become(self, other: BallState) -> None:
        """Takes over the numbers of the same state, computed again; the bodies stay the same objects."""
        for mine, new in zip(self.bodies.values(), other.bodies.values(), strict=True):
            mine.become(new)
        for mine, new in zip(self.pockets, other.pockets, strict=True):
            mine.become(new)
        self._lines, self._mirrors, self._told = other._lines, other._mirrors, other._told
        self.zero, self.one, self.flip_time = other.zero, other.one, other.flip_time
        self.instant, self.late, self.met = other.instant, other.late, other.met

    def round_hit(self, link: Round) -> tuple[arb, arb]:
        """As `State.round_hit`, in the sharper form."""
        return self._meeting(link)[:2]

    def _meeting(self, link: Round) -> tuple[arb, arb, arb, arb, arb | None]:
        """The clock and the time from it to the hit of two circles; their d at the hit; and -d.v at it.

        Where they fly exactly head on, in the form that loses nothing (see `_head_on`), and d.v is left out.
        """
        t, dx, dy, vx, vy, reach = self.relation(link)
        cross = dx * vy - dy * vx
        if cross.is_zero():
            return t, *self._head_on(dx, dy, vx, vy, reach), None
        square = vx * vx + vy * vy
        root = self.root(square * (reach * reach) - cross * cross)
        return t, *pair_meeting(dx * vx + dy * vy, cross, square, root, vx, vy), root

    def _head_on(self, dx: arb, dy: arb, vx: arb, vy: arb, reach: arb) -> tuple[arb, arb, arb]:
        """The time to the hit of two circles whose d and v are parallel, and d at it.

        The direction u of v comes from the quotient of v's components, so that only the uncertainty of that enters.
        """
        steep = bool(abs(vx) < abs(vy))  # in balls: both may be below all doubles
        quotient = vx / vy if steep else vy / vx
        stretch = (self.one + quotient * quotient).sqrt()
        speed = (vy if steep else vx) * stretch
        ux, uy = self.one / stretch, quotient / stretch
        if steep:
            ux, uy = uy, ux
        if speed < ball.ZERO:
            speed, ux, uy = -speed, -ux, -uy
        return pair_head_on(dx, dy, ux, uy, speed, reach)

    def bounce_pair(self, link: Pair) -> None:
        """As `State.bounce_pair`; where the two met head on, the lines are mixed, as the velocities are."""
        if self._told is None or self._told[0] != link or not self._straight:
            super().bounce_pair(link)
            return
        dx, dy = self.span(link)
        a, b = link.ends(self)
        shares = pair_mix(dx, dy, self.reach(a, b), a.w, b.w)
        f, g = a.flight, b.flight
        origin = (f.x.mid(), f.y.mid(), f.vx.mid(), f.vy.mid())
        state_a = [value - shift for value, shift in zip(f[:4], origin, strict=True)]
        state_b = [value - shift for value, shift in zip(g[:4], origin, strict=True)]
        if not self.scene.circles[link.a].fixed:
            self._mix(a, shares[:4], state_a, state_b, origin, -dx, -dy)
        if not self.scene.circles[link.b].fixed:
            self._mix(b, shares[4:], state_b, state_a, origin, dx, dy)

    def _mix(
        self,
        body: Body[arb],
        share: tuple[arb, ...],
        own: list[arb],
        other: list[arb],
        origin: tuple[arb, ...],
        dx: arb,
        dy: arb,
    ) -> None:
        """v' = (I - A) v + A w for the velocities, the same plus k d for the lines at the clock.

        Reckoned from an origin (in position and velocity) beside one of the two: A's uncertainty then multiplies
        their differences only.
        """
        xx, xy, yy, k = share
        x, y, vx, vy = own
        px, py, wx, wy = other
        left, right = self.one - xx, self.one - yy
        before = body.flight
        place = before[:2]
        if self.late is not None:
            ux, uy = vx - wx, vy - wy
            mixed_x = origin[0] + (left * x - xy * y + xx * px + xy * py + k * dx)
            mixed_y = origin[1] + (right * y - xy * x + xy * px + yy * py + k * dy)
            place = (
                mixed_x.intersection(before.x + (xx * ux + xy * uy) * self.late),
                mixed_y.intersection(before.y + (xy * ux + yy * uy) * self.late),
            )
        body.flight = Flight(
            *place,
            origin[2] + (left * vx - xy * vy + xx * wx + xy * wy),
            origin[3] + (right * vy - xy * vx + xy * wx + yy * wy),
            before.t,
            before.instant,
            before.late,
            before.last,
        )

    def bounce_wall(self, link: AtWall) -> None:
        """As `State.bounce_wall`: the line is mirrored."""
        body, line = self.bodies[link.circle], self.line(link.circle, link.wall)
        xx, xy, yy = self.mirror_of(link)
        x, y, vx, vy, t, instant, late, last, rest = body.flight
        if self.late is not None:
            offset = line.nx * line.x0 + line.ny * line.y0 + body.r * line.length
            shift = (offset + offset) / line.nn
            x, y = xx * x + xy * y + shift * line.nx, xy * x + yy * y + shift * line.ny
        body.flight = Flight(x, y, xx * vx + xy * vy, xy * vx + yy * vy, t, instant, late, last, rest)

    def mirror_of(self, link: AtWall) -> Mirror:
        """The matrix by which a wall mirrors velocities."""
        if link.wall not in self._mirrors:
            line = self.line(link.circle, link.wall)
            self._mirrors[link.wall] = wall_mirror(line.nx, line.ny, line.nn)
        return self._mirrors[link.wall]
