"""A contact alone, carried out in one go on midpoints, with their deviations: `CentredState` does it in two steps.

The numbers are those of `LoneContacts`, made of midpoints, with fewer products: d at the hit is d moved on by v, and
one circle is reckoned from the other and from that. The deviations follow in one step of their set
(docs/error-bound.md). Balls are made when somebody asks for them, which few do. What is not ordinary is left to the two
steps, with nothing changed.
"""

from __future__ import annotations

from flint import arb

from ...laws.formulas import wall_approach, wall_gap, wall_hit_time
from ...numbers import ball
from ..body import Flight, Landed, Midpoints, new_flight
from ..centred.centred_state import CentredState
from ..centred.deviations import Deviations, Moved
from ..centred.errors import Spent
from ..contact import AtWall, Pair, Touch
from .carrying import Carried, carry_pair, carry_wall
from .contacts import SPARE_BITS, LoneContacts
from .unchanging import Oblique, Unchanging


def lone_contacts(state: CentredState) -> LoneContacts | LoneCentred:
    """What carries out contacts that stand alone: on balls, or on midpoints where deviations are kept in a set."""
    return LoneCentred(state) if state.centred else LoneContacts(state)


class LoneCentred:
    """Carries out contacts that stand alone, on midpoints.

    Args:
        state: whose bodies fly.

    Attributes:
        landed: see `LoneContacts`.
    """

    def __init__(self, state: CentredState) -> None:
        self.landed: list[Landed[arb]] | None = None
        self._state = state
        self._known = Unchanging(state)

    def strike(self, link: Touch, bits: int, done: int) -> int | None:
        """As `LoneContacts.strike`."""
        self.landed = None
        held = self._state.ready(link)
        if held is None:
            return None
        self._known.at(bits)
        try:
            if isinstance(link, Pair):
                return self._bounce(held, link, bits, done + 1)
            return self._rebound(held, link, bits, done + 1)
        except (Spent, OverflowError):
            self._state.loosen()
            return None

    def _bounce(self, held: Deviations, link: Pair, bits: int, step: int) -> int | None:
        """Two circles.

        Raises:
            Spent: if the deviations are too large after it.
        """
        state = self._state
        one, other = link
        a, b = state.bodies[one], state.bodies[other]
        square_reach, share_a, share_b, alike = self._known.partners(link)
        worst = (a.acc if a.acc < b.acc else b.acc) + SPARE_BITS
        ball.use_bits(worst if worst < bits else bits)
        ax, ay, avx, avy, at, a_last = held.mid[one]
        bx, by, bvx, bvy, bt, b_last = held.mid[other]
        vx, vy = bvx - avx, bvy - avy
        of_a = a_last >= b_last  # the younger of the two is the one from which the other is reckoned
        if of_a:
            base = at
            lag = at - bt
            dx, dy = bx + bvx * lag - ax, by + bvy * lag - ay
        else:
            base = bt
            lag = bt - at
            dx, dy = bx - (ax + avx * lag), by - (ay + avy * lag)
        cross = dx * vy - dy * vx
        square = vx * vx + vy * vy
        disc = square * square_reach - cross * cross
        if cross.is_zero() or not disc > ball.ZERO:
            return None
        root = disc.sqrt()
        wait = -(dx * vx + dy * vy + root) / square
        ex, ey = dx + vx * wait, dy + vy * wait
        instant = base + wait
        clock = instant.mid()
        lag = clock - base
        late = wait - lag
        if of_a:
            since = lag, clock - bt
            ax, ay = ax + avx * lag, ay + avy * lag
            bx, by = ax + ex - vx * late, ay + ey - vy * late
        else:
            since = clock - at, lag
            bx, by = bx + bvx * lag, by + bvy * lag
            ax, ay = bx - ex + vx * late, by - ey + vy * late
        if not (ball.is_sharp(since[0]) and ball.is_sharp(since[1])):
            return None
        strength = share_a * root
        jx, jy = strength * ex, strength * ey
        px, py = jx * late, jy * late
        ax, ay, avx, avy = ax + px, ay + py, avx - jx, avy - jy
        if not alike:
            strength = share_b * root
            jx, jy = strength * ex, strength * ey
            px, py = jx * late, jy * late
        bx, by, bvx, bvy = bx - px, by - py, bvx + jx, bvy + jy
        moved = (a, ax, ay, avx, avy), (b, bx, by, bvx, bvy)
        found = carry_pair(held, state, link, (ex, ey, vx, vy, root), since, late, moved, clock, step)
        return None if found is None else self._land(held, moved, found, (instant, late), step, bits)

    def _rebound(self, held: Deviations, link: AtWall, bits: int, step: int) -> int | None:
        """A circle and a wall.

        Raises:
            Spent: if the deviations are too large after it.
        """
        state, index = self._state, link[0]
        body = state.bodies[index]
        wall = self._known.wall(link)
        worst = body.acc + SPARE_BITS
        ball.use_bits(worst if worst < bits else bits)
        x, y, vx, vy, base, _ = held.mid[index]
        if isinstance(wall, Oblique):
            wait = wall_hit_time(wall_gap(x, y, *wall[:5]), wall_approach(vx, vy, wall.nx, wall.ny))
        else:
            wait = (wall.touch - y) / vy if wall.level else (wall.touch - x) / vx
        instant = base + wait
        if not instant.is_finite():
            return None
        clock = instant.mid()
        lag = clock - base
        if not ball.is_sharp(lag):
            return None
        late = wait - lag
        velocity = vx, vy
        if isinstance(wall, Oblique):
            *_, xx, xy, yy, shift_x, shift_y = wall
            x, y = x + vx * lag, y + vy * lag
            x, y = xx * x + xy * y + shift_x, xy * x + yy * y + shift_y
            vx, vy = xx * vx + xy * vy, xy * vx + yy * vy
        elif wall.level:
            x, y, vy = x + vx * lag, wall.touch + vy * late, -vy
        else:
            x, y, vx = wall.touch + vx * late, y + vy * lag, -vx
        moved = body, x, y, vx, vy
        found = carry_wall(held, link, held.face(state, link), lag, velocity, late, moved, clock, step)
        return None if found is None else self._land(held, (moved,), found, (instant, late), step, bits)

    def _land(
        self,
        held: Deviations,
        moved: tuple[Moved, ...],
        carried: Carried,
        when: tuple[arb, arb],
        step: int,
        bits: int,
    ) -> int:
        """The bodies fly on from their new midpoints, in balls; gives how many bits of the instant are known.

        Args:
            held: their deviations.
            moved: the bodies.
            carried: what becomes of them.
            when: the instant of the midpoints, and the time to it from its clock.
            step: the number of the step to the contact.
            bits: the precision of the state.
        """
        instant, late = when
        power, _, landings = carried
        time = held.ball(power)
        instant, late = instant + time, late + time
        accuracy = instant.rel_accuracy_bits()
        if not 0 < accuracy < bits:
            accuracy = max(0, min(bits, accuracy))
        used, mids, known = ball.bits_in_use(), held.mid, held.carried
        landed: list[Landed[arb]] = []
        for (body, *_), (mid, far, fast, doubles) in zip(moved, landings, strict=True):
            index = body.index
            mids[index] = mid
            known.add(index)
            body.acc = accuracy
            body.await_flight(_flight, held, mid, far, fast, used, instant, late)
            landed.append((body, mid, doubles))
        self._state.stand(instant, late, step + 1)
        if held.errors.full:
            self._state.renew()
        self.landed = landed
        return accuracy


def _flight(
    held: Deviations, mid: Midpoints[arb], far: int, fast: int, bits: int, instant: arb, late: arb
) -> Flight[arb]:
    """A flight in balls: its midpoints, at most 2**far and 2**fast off."""
    x, y, vx, vy, clock, last = mid
    wide, narrow = held.ball(far), held.ball(fast)
    with ball.precision(bits):
        numbers = x + wide, y + wide, vx + narrow, vy + narrow
    return new_flight(Flight, (*numbers, clock, instant, late, last, False))
