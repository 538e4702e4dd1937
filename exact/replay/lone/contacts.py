"""A contact alone, carried out in one go: the flight to it and its impulse, in balls.

`State` does it in two steps, for any contacts and any numbers; here is what those come to where one contact stands
alone, of two circles that move, or of one and a wall, and nothing is exact. The formulas are the same; numbers that
the one step makes for the other are made once, those that no flight changes once for a run, and all are rounded to
what the clocks are known to. Whatever is not ordinary (a circle at rest, circles that fly exactly head on, a
discriminant that may vanish) is left to the steps, with nothing changed.
"""

from __future__ import annotations

from flint import arb

from ...laws.formulas import pair_meeting, wall_approach, wall_gap, wall_hit_time
from ...numbers import ball
from ..ball_state import BallState
from ..body import Flight, Landed, new_flight
from ..contact import AtWall, Pair, Touch
from .unchanging import Oblique, Unchanging

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

    def _stand(self, instant: arb, late: arb, step: int, bits: int) -> int:
        """The state stands at the instant, after both steps; gives how many bits of it are known."""
        self._state.stand(instant, late, step + 1)
        accuracy = instant.rel_accuracy_bits()
        return accuracy if 0 < accuracy < bits else max(0, min(bits, accuracy))
