"""A contact alone, carried out in one go: the flight to it and its impulse, in balls.

`State` does it in two steps, for any contacts and any numbers; here is what those come to where one contact stands
alone, of two circles that move, or of one and a wall, and nothing is exact. The formulas are the same; numbers that
the one step makes for the other are made once, those that no flight changes once for a run, and all are rounded to
what the clocks are known to. Whatever is not ordinary (a circle at rest, circles that fly exactly head on, a
discriminant that may vanish) is left to the steps, with nothing changed.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

from flint import arb

from ..laws.formulas import pair_meeting, wall_approach, wall_gap, wall_hit_time
from ..numbers import ball
from .ball_state import BallState
from .body import Body, Flight, new_flight
from .contact import AtWall, Pair, Touch

SPARE_BITS = 64
"""Bits of working precision kept beyond the accuracy of the numbers at hand."""


Met: TypeAlias = tuple[arb, arb, arb, arb, arb]
"""d, v and -d.v of two circles as they meet."""


class Partners(NamedTuple):
    """What no flight of two circles changes: R^2, and 2 w / (R^2 (wa + wb)) for each."""

    square: arb
    share_a: arb
    share_b: arb
    alike: bool


class Shares(NamedTuple):
    """What no flight of two circles on one line changes: R, 2 w / (wa + wb) for each, and what these leave of 1."""

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


class LoneContacts:
    """Carries out contacts that stand alone.

    Args:
        state: whose bodies fly.

    Attributes:
        met: of two circles carried out last, not on one line: d, v and -d.v at the hit.
    """

    def __init__(self, state: BallState) -> None:
        self._state = state
        self.met: Met | None = None
        self._bits = 0
        self._partners: dict[Pair, Partners] = {}
        self._shares: dict[Pair, Shares] = {}
        self._walls: dict[AtWall, Upright | Oblique] = {}

    def strike(self, link: Touch, bits: int, done: int) -> int | None:
        """Advances the circles of a contact to it, and has them bounce; None where that is left to the steps.

        Args:
            link: the contact.
            bits: the precision of the state.
            done: how many steps of the log there are.

        Returns:
            How many bits of the instant are known.
        """
        if bits != self._bits:
            self._bits = bits
            self._partners.clear()
            self._shares.clear()
            self._walls.clear()
        return self._bounce(link, bits, done + 1) if isinstance(link, Pair) else self._rebound(link, bits, done + 1)

    def _bounce(self, link: Pair, bits: int, step: int) -> int | None:
        """Two circles."""
        a, b = self._state.bodies[link[0]], self._state.bodies[link[1]]
        ax, ay, avx, avy, at, _, _, alast, arest = a.flight
        bx, by, bvx, bvy, bt, _, _, blast, brest = b.flight
        if arest or brest:
            return None
        if (avy.is_zero() and bvy.is_zero()) or (avx.is_zero() and bvx.is_zero()):
            return self._on_line(link, bits, step)
        square_reach, share_a, share_b, alike = self._partners.get(link) or self._become_partners(link, bits)
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
        self.met = ex, ey, vx, vy, root
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
        reach, share_a, share_b, rest_a, rest_b = self._shares.get(link) or self._share(link, bits)
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
        if rest:
            return None
        wall = self._walls.get(link) or self._face(link, body, bits)
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

    def _stand(self, instant: arb, late: arb, step: int, bits: int) -> int:
        """The state stands at the instant, after both steps; gives how many bits of it are known."""
        self._state.stand(instant, late, step + 1)
        accuracy = instant.rel_accuracy_bits()
        return accuracy if 0 < accuracy < bits else max(0, min(bits, accuracy))

    # -- what no flight changes

    def _become_partners(self, link: Pair, bits: int) -> Partners:
        ball.use_bits(bits)
        a, b = link.ends(self._state)
        reach = self._state.reach(a, b)
        square = reach * reach
        whole = square * (a.w + b.w)
        shares = (a.w + a.w) / whole, (b.w + b.w) / whole
        found = self._partners[link] = Partners(square, *shares, self._are_alike(a, b))
        return found

    def _are_alike(self, a: Body[arb], b: Body[arb]) -> bool:
        """Whether two circles have one mass: told by the balls of their inverse masses where these are exact."""
        if a.w.is_exact() and b.w.is_exact():
            return (a.w - b.w).is_zero()
        circles = self._state.scene.circles
        return circles[a.index].m == circles[b.index].m

    def _share(self, link: Pair, bits: int) -> Shares:
        ball.use_bits(bits)
        a, b = link.ends(self._state)
        whole, one = a.w + b.w, self._state.one
        share_a, share_b = (a.w + a.w) / whole, (b.w + b.w) / whole
        found = self._shares[link] = Shares(self._state.reach(a, b), share_a, share_b, one - share_a, one - share_b)
        return found

    def _face(self, link: AtWall, body: Body[arb], bits: int) -> Upright | Oblique:
        """A wall as a circle comes to it.

        Along an axis the centre keeps r from it, on its side, and the mirror is x' = 2 touch - x: `wall_gap` and
        `wall_mirror` for a normal of one component n, of which r |n| / n is r or -r.
        """
        ball.use_bits(bits)
        x0, y0, nx, ny, nn, length = self._state.line(link.circle, link.wall)
        for level, across, along, start in ((True, ny, nx, y0), (False, nx, ny, x0)):
            sign = ball.sign_of(across)
            if along.is_zero() and sign:
                touch = start + body.r if sign > 0 else start - body.r
                found = self._walls[link] = Upright(touch, touch + touch, level)
                return found
        offset = body.r * length
        shift = nx * x0 + ny * y0 + offset
        shift = (shift + shift) / nn
        mirror = self._state.mirror_of(link)
        found = self._walls[link] = Oblique(x0, y0, nx, ny, offset, *mirror, shift * nx, shift * ny)
        return found
