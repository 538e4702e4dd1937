"""A state on balls that loses few bits, and its contacts that stand alone: the flight and the impulse in one go."""

from __future__ import annotations

from math import inf
from typing import NamedTuple, TypeAlias

from flint import arb

from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ..laws.formulas import (
    damped,
    pair_head_on,
    pair_meeting,
    pair_mix,
    pair_strength,
    speed_change,
    wall_approach,
    wall_gap,
    wall_hit_time,
    wall_mirror,
)
from ..numbers import ball
from .contact import AtArc, AtWall, Body, Flight, Landed, Link, Pair, Round, Touch, is_flat, is_pair, new_flight
from .landings import Unsharp, landing_wait
from .state import ReplayState
from .wall_flights import FallingWall, falling_wall

# -- A state on balls that loses few bits: clocks without radius, reflections as matrices, contacts from laws.
#
# Interval arithmetic pays for every number that it uses twice. So:
#
# - A body's clock is a number without radius, the midpoint of its last instant's ball; the body is kept as its
#   straight line at that clock, and only the change of velocity is carried over the (tiny, uncertain) time between
#   clock and instant. The uncertainty of a hit time then enters a position by |change of v|, not by |v|, and lags
#   between clocks have none.
# - So a line holds from its instant on, and not from its clock: whether two come nearer and are apart is asked at the
#   later instant (`gap`, `approach`), a little before or after the later clock.
# - A wall mirrors the line itself: x' = H x + c with the Householder matrix H = I - 2 n n^T / |n|^2, whatever the
#   instant.
# - At contact, d has the d x v of before and d.v = -sqrt(discriminant): no time in it, and the first impulse of an
#   instant needs nothing else.
# - Where two circles fly exactly head on, as on a line, nothing need be lost: the direction of v is then known exactly
#   or nearly so, and the lines after are matrices times those before, v_a' = (I - A) v_a + A v_b, cut with what the
#   impulse tells. Elsewhere that would save a tenth of the bits for a fourth of the time.

Told: TypeAlias = tuple[Round, arb, arb] | None
"""A contact of two circles, and d at it, as the law of their meeting tells it."""

Mirror: TypeAlias = tuple[arb, arb, arb]
"""(xx, xy, yy) of a symmetric matrix."""


class BallState(ReplayState[arb]):
    """`ReplayState` on `flint.arb`, at flint's working precision."""

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene, ball.BALLS)
        self._told: Told = None
        self._root: arb | None = None
        self._straight = False
        self._mirrors: dict[int, Mirror] = {}
        self._landings: dict[Round, tuple[Flight[arb], int, arb]] = {}

    def set_instant(self, base: arb, wait: arb) -> tuple[arb, arb]:
        """A clock without radius at the middle of the instant."""
        instant = base + wait
        clock = instant.mid()
        lag = clock - base
        self.instant, self.late = instant, wait - lag
        return clock, lag

    def _hit_from_base(self, source: Link) -> tuple[arb, arb]:
        """The time of the hit, and for two circles their d at it."""
        if is_flat(source) or (self.stands and self.on_peg(source)):
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
        """As `ReplayState.go`."""
        self._told = self._root = None
        super().go(source, bodies)

    def kick(self, links: tuple[Touch, ...]) -> None:
        """As `ReplayState.kick`; the law of the meeting tells the first impulse of an instant, and no other."""
        if self._root is not None and self._told is not None and links == (self._told[0],):
            self._bounce_first(*self._told, self._root)
        else:
            super().kick(links)
        self._root = None

    def _bounce_first(self, link: Round, dx: arb, dy: arb, root: arb) -> None:
        """The bounce of two circles that meet at the instant, with d and d.v as their meeting tells them."""
        a, b = link.ends(self)
        strength = pair_strength(root, self.reach(a, b), a.w, b.w)
        if self.share is not None:
            strength = strength * self.share
        jx, jy = strength * dx, strength * dy
        self.push(a, -jx, -jy)
        if is_pair(link):
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
        for mine, new in zip((*self.pockets, *self.arcs), (*other.pockets, *other.arcs), strict=True):
            mine.become(new)
        self._lines, self._mirrors, self._told = other._lines, other._mirrors, other._told
        self.contacts, self.pegs = other.contacts, other.pegs
        self.zero, self.one, self.flip_time, self.share = other.zero, other.one, other.flip_time, other.share
        self.instant, self.late, self.met = other.instant, other.late, other.met
        self.falling, self.drifts = other.falling, other.drifts

    def round_hit(self, link: Round) -> tuple[arb, arb]:
        """As `ReplayState.round_hit`, in the sharper form; of a fall, made once for a flight and a precision."""
        if not (self.stands and self.on_peg(link)):
            return self._meeting(link)[:2]
        flight, bits = self.faller(link).flight, ball.bits_in_use()
        known = self._landings.get(link)
        if known is None or known[0] is not flight or known[1] != bits:
            known = self._landings[link] = flight, bits, landing_wait(self, link, inf)
        return flight.t, known[2]

    def arc_hit(self, link: AtArc) -> tuple[arb, arb]:
        """As `ReplayState.arc_hit`, in the sharper form."""
        return self.round_hit(link)

    def arc_span(self, link: AtArc, graze: bool) -> tuple[arb, arb]:
        """As `ReplayState.arc_span`, in the sharper form."""
        return super().arc_span(link, graze) if graze else self._meeting(link)[2:4]

    def _meeting(self, link: Round) -> tuple[arb, arb, arb, arb, arb | None]:
        """The clock and the time from it to the hit of two circles; their d at the hit; and -d.v at it.

        Where they fly exactly head on, in the form that loses nothing (see `_head_on`), d.v is left out. Of a hollow
        side of an arc, which is met at the later zero, the root has the other sign.
        """
        t, dx, dy, vx, vy, reach = self.relation(link)
        cross = dx * vy - dy * vx
        if cross.is_zero():
            return t, *self._head_on(dx, dy, vx, vy, reach), None
        square = vx * vx + vy * vy
        root = self.root(square * (reach * reach) - cross * cross)
        if link.hollow:
            root = -root
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
        """As `ReplayState.bounce_pair`; where the two met head on, the lines are mixed, as the velocities are."""
        if self._told is None or self._told[0] != link or not self._straight:
            super().bounce_pair(link)
            return
        dx, dy = self.span(link)
        a, b = link.ends(self)
        shares = pair_mix(dx, dy, self.reach(a, b), a.w, b.w)
        if self.share is not None:
            shares = tuple(part * self.share for part in shares)
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
        """As `ReplayState.bounce_wall`: the line is mirrored, which one that falls is not."""
        if self.falling is not None:
            super().bounce_wall(link)
            return
        body, line = self.bodies[link.circle], self.line(link.circle, link.wall)
        xx, xy, yy = self.mirror_of(link)
        x, y, vx, vy, t, instant, late, last, rest = body.flight
        if self.late is not None:
            offset = line.nx * line.x0 + line.ny * line.y0 + body.r * line.length
            shift = self.damping(speed_change(offset)) / line.nn
            x, y = xx * x + xy * y + shift * line.nx, xy * x + yy * y + shift * line.ny
        body.flight = Flight(x, y, xx * vx + xy * vy, xy * vx + yy * vy, t, instant, late, last, rest)

    def surely_falls(self, speed: arb) -> bool:
        """See `Flights.surely_falls`."""
        return speed < ball.ZERO

    def damping(self, change: arb) -> arb:
        """What is left of an elastic change at the scene's restitution."""
        return change if self.share is None else change * self.share

    def mirror_of(self, link: AtWall) -> Mirror:
        """The matrix by which a wall mirrors velocities: with a restitution e, I - (1 + e) n n^T / |n|^2."""
        if link.wall not in self._mirrors:
            line = self.line(link.circle, link.wall)
            xx, xy, yy = wall_mirror(line.nx, line.ny, line.nn)
            if self.share is not None:
                xx, xy, yy = damped(self.one, xx, self.share), xy * self.share, damped(self.one, yy, self.share)
            self._mirrors[link.wall] = xx, xy, yy
        return self._mirrors[link.wall]


# -- Numbers of contacts that no flight changes, in balls: made once for a precision.


class Partners(NamedTuple):
    """Of two circles: R^2, (1 + e) w / (R^2 (wa + wb)) for each, and whether their masses are one."""

    square: arb
    share_a: arb
    share_b: arb
    alike: bool


class Shares(NamedTuple):
    """Of two circles on one line: R, (1 + e) w / (wa + wb) for each, and what these leave of 1."""

    reach: arb
    a: arb
    b: arb
    rest_a: arb
    rest_b: arb


class Upright(NamedTuple):
    """A wall along an axis, to a circle: the coordinate at which the circle touches it, twice that, and which it is."""

    touch: arb
    twice: arb
    level: bool


class Oblique(NamedTuple):
    """Any other wall, to a circle.

    Attributes:
        x0, y0, nx, ny, offset: a point on it, the normal to the circle's side, and r |n|.
        xx, xy, yy: the matrix that mirrors (see `wall_mirror`).
        shift_x, shift_y: what it moves a place by.
    """

    x0: arb
    y0: arb
    nx: arb
    ny: arb
    offset: arb
    xx: arb
    xy: arb
    yy: arb
    shift_x: arb
    shift_y: arb


class Unchanging:
    """The numbers of a state's contacts, at one precision.

    Args:
        state: whose circles and walls.
    """

    def __init__(self, state: BallState) -> None:
        self._state = state
        self._bits = 0
        self._partners: dict[Round, Partners] = {}
        self._alike: dict[tuple[int, int, int, int], Partners] = {}
        self._shares: dict[Pair, Shares] = {}
        self._walls: dict[AtWall, Upright | Oblique] = {}
        self._falls: dict[AtWall, FallingWall[arb]] = {}

    def at(self, bits: int) -> None:
        """At so many bits from now on."""
        if bits != self._bits:
            self._bits = bits
            self._partners.clear()
            self._alike.clear()
            self._shares.clear()
            self._walls.clear()
            self._falls.clear()

    def partners(self, link: Round) -> Partners:
        """Those of two circles, or of one and an arc."""
        return self._partners.get(link) or self._become_partners(link)

    def shares(self, link: Pair) -> Shares:
        """Those of two circles on one line."""
        return self._shares.get(link) or self._share(link)

    def wall(self, link: AtWall) -> Upright | Oblique:
        """Those of a circle and a wall."""
        return self._walls.get(link) or self._face(link)

    def fall(self, link: AtWall) -> FallingWall[arb]:
        """Those of a circle and a wall that falls or moves."""
        return self._falls.get(link) or self._fall(link)

    def _fall(self, link: AtWall) -> FallingWall[arb]:
        ball.use_bits(self._bits)
        state, falling = self._state, self._state.falling
        assert falling is not None
        line, r = state.line(link.circle, link.wall), state.bodies[link.circle].r
        pull, drift = state.sides.pull(link.circle, link.wall), state.drifts.get(link.wall)
        found = self._falls[link] = falling_wall(line, r, falling, pull, drift, state.damping, ball.ZERO)
        return found

    def _become_partners(self, link: Round) -> Partners:
        a, b = link.ends(self._state)
        kinds = id(a.r), id(a.w), id(b.r), id(b.w)  # circles of one radius and mass have the same two numbers
        found = self._alike.get(kinds)
        if found is None:
            ball.use_bits(self._bits)
            reach = self._state.reach(a, b)
            square = reach * reach
            whole = square * (a.w + b.w)
            damping = self._state.damping
            shares = damping(speed_change(a.w)) / whole, damping(speed_change(b.w)) / whole
            found = self._alike[kinds] = Partners(square, *shares, self._are_alike(a, b))
        self._partners[link] = found
        return found

    def _are_alike(self, a: Body[arb], b: Body[arb]) -> bool:
        """Whether two circles have one mass: told by the balls of their inverse masses where these are exact."""
        if a.w.is_exact() and b.w.is_exact():
            return (a.w - b.w).is_zero()
        circles = self._state.scene.circles
        return circles[a.index].m == circles[b.index].m

    def _share(self, link: Pair) -> Shares:
        ball.use_bits(self._bits)
        a, b = link.ends(self._state)
        whole, one = a.w + b.w, self._state.one
        damping = self._state.damping
        share_a, share_b = damping(speed_change(a.w)) / whole, damping(speed_change(b.w)) / whole
        found = self._shares[link] = Shares(self._state.reach(a, b), share_a, share_b, one - share_a, one - share_b)
        return found

    def _face(self, link: AtWall) -> Upright | Oblique:
        """A wall as a circle comes to it.

        Along an axis the centre keeps r from it, on its side, and for e = 1 the mirror is x' = 2 touch - x: `wall_gap`
        and `wall_mirror` for a normal of one component n, of which r |n| / n is r or -r.
        """
        ball.use_bits(self._bits)
        r = self._state.bodies[link.circle].r
        x0, y0, nx, ny, nn, length = self._state.line(link.circle, link.wall)
        for level, across, along, start in ((True, ny, nx, y0), (False, nx, ny, x0)):
            sign = ball.sign_of(across)
            if along.is_zero() and sign and self._state.share is None:
                touch = start + r if sign > 0 else start - r
                found = self._walls[link] = Upright(touch, speed_change(touch), level)
                return found
        offset = r * length
        shift = nx * x0 + ny * y0 + offset
        shift = self._state.damping(speed_change(shift)) / nn
        mirror = self._state.mirror_of(link)
        found = self._walls[link] = Oblique(x0, y0, nx, ny, offset, *mirror, shift * nx, shift * ny)
        return found


# -- A contact alone, carried out in one go: the flight to it and its impulse, in balls.
#
# `ReplayState` does it in two steps, for any contacts and any numbers; here is what those come to where one contact
# stands alone, of two circles, or of one and a wall, and nothing that moves is exact. The formulas are the same;
# numbers that the one step makes for the other are made once, those that no flight changes once for a run, and all
# are rounded to what the clocks are known to. Whatever is not ordinary (a circle at rest, circles that fly exactly
# head on, a discriminant that may vanish) is left to the steps, with nothing changed.

SPARE_BITS = 64
"""Bits of working precision kept beyond the accuracy of the numbers at hand."""


class LoneContacts:
    """Carries out contacts that stand alone.

    Args:
        state: whose bodies fly.

    Attributes:
        landed: the circles of the contact carried out last, in order, with their doubles where these are off by less
            than 2u; None where there is nothing but their flights.
    """

    landed: list[Landed[arb]] | None = None

    def __init__(self, state: BallState) -> None:
        self._state = state
        self._known = Unchanging(state)

    def strike(self, link: Touch, bits: int, done: int) -> int | None:
        """Advances the circles of a contact to it, and has them bounce; None where that is left to the steps.

        Args:
            link: the contact.
            bits: the precision of the state.
            done: how many steps of the log there are.

        Returns:
            How many bits of the instant are known.
        """
        self._known.at(bits)
        if is_pair(link):
            return self._bounce(link, bits, done + 1)
        return self._rebound(link, bits, done + 1) if is_flat(link) else None

    def _bounce(self, link: Pair, bits: int, step: int) -> int | None:
        """Two circles."""
        a, b = self._state.bodies[link[0]], self._state.bodies[link[1]]
        ax, ay, avx, avy, at, _, _, alast, arest = a.flight
        bx, by, bvx, bvy, bt, _, _, blast, brest = b.flight
        if arest or brest:
            return self._off_fixed(link, bits, step)
        if (avy.is_zero() and bvy.is_zero()) or (avx.is_zero() and bvx.is_zero()):
            return self._on_line(link, bits, step)
        square_reach, share_a, share_b, alike = self._known.partners(link)
        worst = (a.acc if a.acc < b.acc else b.acc) + SPARE_BITS
        ball.use_bits(worst if worst < bits else bits)
        if alast >= blast:
            base = at
            if bt is not at:
                lag = at - bt
                bx, by = bx + bvx * lag, by + bvy * lag
        else:
            base = bt
            lag = bt - at
            ax, ay = ax + avx * lag, ay + avy * lag
        dx, dy, vx, vy = bx - ax, by - ay, bvx - avx, bvy - avy
        cross = dx * vy - dy * vx
        square = vx * vx + vy * vy
        disc = square * square_reach - cross * cross
        if cross.is_zero() or ball.sign_of(disc) != 1:
            return None
        root = disc.sqrt()
        wait, ex, ey = pair_meeting(dx * vx + dy * vy, cross, square, root, vx, vy)
        instant = base + wait
        clock = instant.mid()
        lag = clock - base
        late = wait - lag
        strength = share_a * root
        jx, jy = strength * ex, strength * ey
        wx, wy = avx - jx, avy - jy
        rest = wx.is_zero() and wy.is_zero()
        x, y = ax + avx * lag + jx * late, ay + avy * lag + jy * late
        one = new_flight(Flight, (x, y, wx, wy, clock, instant, late, step, rest))
        if not alike:
            strength = share_b * root
            jx, jy = strength * ex, strength * ey
        wx, wy = bvx + jx, bvy + jy
        rest = wx.is_zero() and wy.is_zero()
        x, y = bx + bvx * lag - jx * late, by + bvy * lag - jy * late
        a.flight, b.flight = one, new_flight(Flight, (x, y, wx, wy, clock, instant, late, step, rest))
        accuracy = self._stand(instant, late, step, bits)
        a.acc = b.acc = accuracy
        return accuracy

    def _off_fixed(self, link: Pair, bits: int, step: int) -> int | None:
        """A circle that flies and a fixed one: an obstacle, an end or a corner. What is fixed stays as it is told."""
        circles, bodies = self._state.scene.circles, self._state.bodies
        square_reach, share_a, share_b, _ = self._known.partners(link)
        a, b, share = bodies[link[0]], bodies[link[1]], share_a
        if circles[a.index].fixed:
            a, b, share = b, a, share_b
        ax, ay, vx, vy, base, *_, rest = a.flight
        if self._state.falling is not None and circles[b.index].fixed:
            return self._off_peg(link, a, b, share, bits, step) if self._state.on_peg(link) else None
        if rest or not circles[b.index].fixed or vx.is_zero() or vy.is_zero():
            return None
        bx, by, *_ = b.flight
        worst = a.acc + SPARE_BITS
        ball.use_bits(worst if worst < bits else bits)
        dx, dy = bx - ax, by - ay
        cross = dy * vx - dx * vy
        square = vx * vx + vy * vy
        disc = square * square_reach - cross * cross
        if cross.is_zero() or ball.sign_of(disc) != 1:
            return None
        root = disc.sqrt()
        wait, ex, ey = pair_meeting(-(dx * vx + dy * vy), cross, square, root, -vx, -vy)
        strength = share * root
        return self._turn(a, -strength * ex, -strength * ey, base, wait, step, bits, b)

    def _off_peg(self, link: Pair, body: Body[arb], peg: Body[arb], share: arb, bits: int, step: int) -> int | None:
        """A circle that falls and a fixed one, at a zero of a quartic (see landings.py)."""
        state = self._state
        worst = body.acc + SPARE_BITS
        ball.use_bits(worst if worst < bits else bits)
        try:
            base, wait = state.round_hit(link)
        except Unsharp:
            return None
        met = state.peg_fall_at_clock(link).after(wait)
        strength = share * met.approach()
        ux, uy = strength * met.dx, strength * met.dy  # away from the fixed one, to which d leads from the other
        if body.index == link[1]:
            ux, uy = -ux, -uy
        accuracy = self._turn(body, ux, uy, base, wait, step, bits, peg)
        state.note_stood((link,))
        return accuracy

    def _on_line(self, link: Pair, bits: int, step: int) -> int | None:
        """Two circles that fly along one level or upright line, exactly: `BallState`'s forms of `_head_on` and `_mix`.

        There the direction of v is (1, 0) or (-1, 0), say, and pair_mix's matrix has one entry, 2 w / (wa + wb).
        """
        a, b = self._state.bodies[link[0]], self._state.bodies[link[1]]
        ax, ay, avx, avy, at, _, _, alast, _ = a.flight
        bx, by, bvx, bvy, bt, _, _, blast, _ = b.flight
        level = avy.is_zero() and bvy.is_zero()
        if not (by - ay if level else bx - ax).is_zero():
            return None
        reach, share_a, share_b, rest_a, rest_b = self._known.shares(link)
        worst = (a.acc if a.acc < b.acc else b.acc) + SPARE_BITS
        ball.use_bits(worst if worst < bits else bits)
        p, u, q, v = (ax, avx, bx, bvx) if level else (ay, avy, by, bvy)
        if alast >= blast:
            base = at
            now_p, now_q = p, q + v * (at - bt)
        else:
            base = bt
            now_p, now_q = p + u * (bt - at), q
        speed = v - u
        sign = ball.sign_of(speed)
        if not sign:
            return None
        apart = reach if sign < 0 else -reach  # d at the hit
        wait = (apart - (now_q - now_p)) / speed
        instant = base + wait
        clock = instant.mid()
        lag = clock - base
        late = wait - lag
        p, q = now_p + u * lag, now_q + v * lag
        place, pace = p.mid(), u.mid()
        own, other, mine, its = p - place, q - place, u - pace, v - pace
        change = (mine - its) * late
        p = (place + (rest_a * own + share_a * (other - apart))).intersection(p + share_a * change)
        q = (place + (rest_b * other + share_b * (own + apart))).intersection(q - share_b * change)
        u, v = pace + (rest_a * mine + share_a * its), pace + (rest_b * its + share_b * mine)
        still = u.is_zero(), v.is_zero()
        if level:
            one, two = (p, ay, u, avy), (q, by, v, bvy)
        else:
            one, two = (ax, p, avx, u), (bx, q, bvx, v)
        a.flight = new_flight(Flight, (*one, clock, instant, late, step, still[0]))
        b.flight = new_flight(Flight, (*two, clock, instant, late, step, still[1]))
        a.acc = b.acc = accuracy = self._stand(instant, late, step, bits)
        return accuracy

    def _rebound(self, link: AtWall, bits: int, step: int) -> int | None:
        """A circle and a wall."""
        body = self._state.bodies[link[0]]
        x, y, vx, vy, base, _, _, _, rest = body.flight
        if self._state.falling is not None:
            return self._off_falling(link, bits, step)
        if rest:
            return None
        wall = self._known.wall(link)
        worst = body.acc + SPARE_BITS
        ball.use_bits(worst if worst < bits else bits)
        if isinstance(wall, Oblique):
            wait = wall_hit_time(wall_gap(x, y, *wall[:5]), wall_approach(vx, vy, wall.nx, wall.ny))
        else:
            wait = (wall.touch - y) / vy if wall.level else (wall.touch - x) / vx
        instant = base + wait
        if not instant.is_finite():
            return None
        clock = instant.mid()
        lag = clock - base
        late = wait - lag
        x, y = x + vx * lag, y + vy * lag
        if isinstance(wall, Oblique):
            *_, xx, xy, yy, shift_x, shift_y = wall
            x, y = xx * x + xy * y + shift_x, xy * x + yy * y + shift_y
            vx, vy = xx * vx + xy * vy, xy * vx + yy * vy
        elif wall.level:
            y, vy = wall.twice - y, -vy
        else:
            x, vx = wall.twice - x, -vx
        rest = vx.is_zero() and vy.is_zero()
        body.flight = new_flight(Flight, (x, y, vx, vy, clock, instant, late, step, rest))
        body.acc = accuracy = self._stand(instant, late, step, bits)
        return accuracy

    def _off_falling(self, link: AtWall, bits: int, step: int) -> int | None:
        """A circle and a wall that falls or moves (see wall_flights.py).

        The speed along n at which they meet is -sqrt(D), or without a pull what it is all the way: so it needs no
        time, and enters the flight after as the discriminant has it.
        """
        body = self._state.bodies[link[0]]
        x, y, vx, vy, base, *_ = body.flight
        wall = self._known.fall(link)
        worst = body.acc + SPARE_BITS
        ball.use_bits(worst if worst < bits else bits)
        met = wall.met(x, y, vx, vy, base, ball.ZERO, arb.sqrt)
        if met is None:
            return None
        wait, strength = met
        if not wait.is_finite():
            return None
        ux, uy = wall.turn_x * strength, wall.turn_y * strength
        return self._turn(body, ux, uy, base, wait, step, bits)

    def _turn(
        self, a: Body[arb], ux: arb, uy: arb, base: arb, wait: arb, step: int, bits: int, fixed: Body[arb] | None = None
    ) -> int:
        """A circle flies from its clock to a contact, where its velocity changes; a fixed one that it meets stays."""
        instant = base + wait
        clock = instant.mid()
        lag = clock - base
        late = wait - lag
        x, y, vx, vy, *_ = a.flight
        x, y = x + vx * lag - ux * late, y + vy * lag - uy * late
        vx, vy = vx + ux, vy + uy
        rest = vx.is_zero() and vy.is_zero()
        a.flight = new_flight(Flight, (x, y, vx, vy, clock, instant, late, step, rest))
        if fixed is not None:
            fixed.flight = new_flight(Flight, (*fixed.flight[:4], clock, instant, late, step, fixed.flight.rest))
        a.acc = accuracy = self._stand(instant, late, step, bits)
        return accuracy

    def _stand(self, instant: arb, late: arb, step: int, bits: int) -> int:
        """The state stands at the instant, after both steps; gives how many bits of it are known."""
        self._state.stand(instant, late, step + 1)
        accuracy = instant.rel_accuracy_bits()
        return accuracy if 0 < accuracy < bits else max(0, min(bits, accuracy))
