"""A state on balls that loses bits at the dynamics' own rate: exact midpoints, and one set of all their deviations."""

from __future__ import annotations

from typing import NamedTuple

from flint import arb

from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ..laws.formulas import pair_turned, wall_approach, wall_gap, wall_hit_time
from ..numbers import ball
from .ball_state import SPARE_BITS, BallState, LoneContacts, Oblique, Told, Unchanging
from .contact import (
    AtWall,
    Body,
    Flight,
    Landed,
    Link,
    Midpoints,
    Pair,
    Round,
    Touch,
    WaitingBody,
    can_push,
    is_arc,
    is_flat,
    is_pair,
    new_flight,
)
from .deviations import (
    Carried,
    Deviations,
    Moved,
    Numbers,
    carry_fall,
    carry_pair,
    carry_round,
    carry_wall,
    is_finite,
    midpoints,
    numbers_of,
    slope_of,
)
from .error_bounds import Collision, Spent
from .landings import Met, met_beside, window_of

# -- A state on balls that loses bits at the dynamics' own rate: exact midpoints, and one set of all their deviations.
#
# Balls forget that errors belong together: each collision pays for the box around what was a turned box, about twice
# the bits that the motion itself takes. Here a body's midpoints are carried through a step by `BallState`, without
# any radius, and what the truth is away from them by `Deviations`. The numbers of a body that others read are balls
# as before: the midpoint, and the bound for the body.
#
# Only the ordinary instant is carried so: one contact, of two circles or a circle and a wall, that nothing holds to a
# line. At any other the deviations are given up, the balls are carried as `BallState` does it, and new ones are begun
# after it. See docs/error-bound.md.

MOST_MOVERS = 24
"""Circles that move: a block costs the cube of their number, and balls lose little where each is hit seldom."""

LONG_NUMBERS = 4_096
"""Bits beyond which a product of two such numbers costs so much that clocks are kept short."""

CLOCK_BITS = 256
"""Of a short clock: at times of up to 2**100 it is less than 2**-156 beside its instant, which is next to nothing."""

FALLING_SPARE_BITS = 128
"""As `SPARE_BITS`, in the frame that falls: what a body's bound grows by within a block, and by how much the numbers of
that frame, which grow as the square of the time, are larger than the distances that matter, may be 2**100 together."""

FALLING_COSTS = 2
"""By how much longer numbers have to be where walls fall or move, and a product is a smaller part of the work: 5,000
bounces in a wedge take 1.2 times as long in a set, with 4,800 bits, as on balls, with 14,600; 7,000 a third."""

ROUND_COSTS = 1.5
"""The same where something round stands under gravity: 3,400 events of `pinball-table:e=1` take as long in a set, with
5,600 bits, as on balls, with 12,800; 2,200 of `plinko:e=1`, with 5,500 and 9,700, seven eighths of it."""

CLOSING_COSTS = 4
"""The same where walls close, and each contact is carried out in two steps."""

LONGEST_BREAK = 64
"""Instants for which nothing is begun, at most, after deviations that came to nothing."""


class Pending(NamedTuple):
    """A contact to which bodies have been advanced, and whose impulse is to come.

    Attributes:
        link: the contact.
        centres: each flying body's (x, y, vx, vy) at the clock, from midpoints alone.
        central: late, told and root as `BallState` has them, from midpoints alone.
        shown: the first two as others see them.
        hit: the derivative of the collision of two circles, or of one and a wall that falls or moves.
    """

    link: Touch
    centres: dict[int, Numbers]
    central: tuple[arb | None, Told, arb | None]
    shown: tuple[arb | None, Told]
    hit: Collision | None


class CentredState(BallState):
    """`BallState`, with the deviations of all midpoints in one set.

    Args:
        scene: see `State`.
        centred: whether that is done at all.

    Attributes:
        centred: as given.
        outside: circles whose numbers are kept elsewhere for now: no set holds them.
        spare: bits of working precision kept beyond the accuracy of the numbers at hand.
        costs: by how much longer numbers have to be for a set to be worth it.
    """

    def __init__(self, scene: Scene, centred: bool = True) -> None:
        super().__init__(scene)
        self.centred = centred
        self.outside: set[int] = set()
        falls = 1 if self.falling is None else FALLING_COSTS
        self.costs = CLOSING_COSTS if scene.closing else ROUND_COSTS if self.stands else falls
        self.spare = FALLING_SPARE_BITS if centred and self.falling is not None else SPARE_BITS
        self._movers = tuple(i for i, circle in enumerate(scene.circles) if not circle.fixed)
        self._deviations: Deviations | None = None
        self._pending: Pending | None = None
        self._landing: Met | None = None
        self._break = 0
        self._next_break = 1

    def _circle(self, i: int) -> Body[arb]:
        body = super()._circle(i)
        return WaitingBody(i, body.flight, body.r, body.w)

    def loosen(self) -> None:
        """Gives the deviations up: each body keeps its balls."""
        if self._deviations is not None:
            self._deviations, self._pending = None, None
            self._break, self._next_break = self._next_break, min(2 * self._next_break, LONGEST_BREAK)

    def become(self, other: BallState) -> None:
        """As `BallState.become`."""
        super().become(other)
        if isinstance(other, CentredState):
            self.centred, self.outside, self.spare = other.centred, other.outside, other.spare
            self._deviations, self._pending = other._deviations, other._pending
            self._break, self._next_break = other._break, other._next_break

    # -- steps

    def go(self, source: Link | int | Quantity, bodies: tuple[int, ...]) -> None:
        """As `State.go`."""
        self._land()
        if isinstance(source, (int, Quantity)) or not can_push(source) or not self._ordinary(source, bodies):
            self.loosen()
            super().go(source, bodies)
            return
        held = self._deviations
        if held is None or not held.holds(self._flying(bodies)):
            held = self._deviations = self._begin()
        flying = [body for i in bodies if not (body := self.bodies[i]).flight.rest]
        before = [body.flight for body in flying]
        round_one = None if is_flat(source) or not (self.stands and self.on_peg(source)) else source
        window = None if round_one is None else window_of(self, round_one)
        for body in flying:
            held.centre(body)
        if round_one is not None and window is not None:
            self._landing = met_beside(self, round_one, window, self.faller(round_one).flight)
        told, centres = None, dict[int, Numbers]()
        if round_one is None or self._landing:
            super().go(source, bodies)
            centres = {body.index: numbers_of(body) for body in flying}
            waits = [(body.index, body.flight.t - flight.t) for body, flight in zip(flying, before, strict=True)]
            lags = [(i, float(wait)) for i, wait in waits if ball.is_sharp(wait)]
            if len(lags) == len(waits):
                fallen = self._landing and self._landing[1]
                told = held.advance(lags, self, source, self._told, self._root, fallen)
            if told and window and self._landing and not window.falls(window.wait.union(self._landing[0] + told[0])):
                told = None
        self._landing = None
        if told is None:
            for body, flight in zip(flying, before, strict=True):
                body.flight = flight
            self.loosen()
            super().go(source, bodies)
            return
        time, place, hit = told
        for body, flight in zip(flying, before, strict=True):
            held.show_place(body, flight)
        late, met = self.late, self._told
        self.instant = self.instant + time
        self.late = time if late is None else late + time
        if met is not None:
            self._told = (met[0], met[1] + place, met[2] + place)
        for i in bodies:
            body = self.bodies[i]
            body.flight = body.flight._replace(instant=self.instant, late=self.late)
        self._pending = Pending(source, centres, (late, met, self._root), (self.late, self._told), hit)

    def _hit_from_base(self, source: Link) -> tuple[arb, arb]:
        """As `BallState._hit_from_base`; of a circle that falls onto something round, as it is known already."""
        if self._landing is None or is_flat(source):
            return super()._hit_from_base(source)
        assert can_push(source)
        wait, met = self._landing
        self._told, self._root, self._straight = (source, met.dx, met.dy), -met.approach(), False
        return self.faller(source).flight.t, wait

    def kick(self, links: tuple[Touch, ...]) -> None:
        """As `State.kick`."""
        pending, held = self._pending, self._deviations
        if pending is None or held is None or links != (pending.link,):
            self.loosen()
            super().kick(links)
            return
        movers = self._movers_of(pending.link)
        balls = [body.flight for body in movers]
        for body in movers:
            held.centre(body, pending.centres.get(body.index))
        self.late, self._told, self._root = pending.central
        self.met = self._pending = None
        if self.falling is not None:
            for body in movers:  # at what speed a wall that falls is met goes by the flight's own
                body.flight = body.flight._replace(late=self.late)
        super().kick(links)
        self.late, self._told = pending.shown
        self.met = None
        if not self._carried(held, pending, movers):
            for body, flight in zip(movers, balls, strict=True):
                body.flight = flight
            self.loosen()
            super().kick(links)
            return
        for body in movers:
            body.flight = body.flight._replace(rest=False, late=self.late)
            held.show(body)
        self.renew()

    def _carried(self, held: Deviations, pending: Pending, movers: list[Body[arb]]) -> bool:
        """Carries the deviations through an impulse; whether that could be done."""
        link = pending.link
        if pending.hit is not None:
            return held.meet(link, movers, pending.hit)
        assert is_flat(link)
        return held.mirror(held.face(self, link), movers[0])

    def forget_contact(self) -> None:
        """As `BallState.forget_contact`."""
        self._land()
        super().forget_contact()

    def take(self, index: int) -> None:
        """As `State.take`."""
        self.loosen()
        super().take(index)

    def settle(self, index: int, wall: int, slides: bool, bounces: bool, other: int = -1) -> None:
        """As `State.settle`."""
        self.loosen()
        super().settle(index, wall, slides, bounces, other)

    def lift(self, index: int) -> None:
        """As `State.lift`; what the law of the meeting told is of the flight before."""
        self.loosen()
        super().lift(index)
        self.met = self._told = self._root = None

    def flip(self) -> None:
        """As `State.flip`."""
        self.loosen()
        super().flip()

    def _movers_of(self, link: Touch) -> list[Body[arb]]:
        return [self.bodies[i] for i in link.circles if not self.scene.circles[i].fixed]

    def _ordinary(self, link: Touch, bodies: tuple[int, ...]) -> bool:
        """Whether deviations may be carried to this contact."""
        if not self.centred or self._break or len(self._movers) > MOST_MOVERS or self.carries(link):
            self._break -= self._break > 0
            return False
        movers = self._movers_of(link)
        if sorted(body.index for body in movers) != self._flying(bodies) or not self.outside.isdisjoint(bodies):
            return False
        falls = self.falling is not None and (is_flat(link) or (self.stands and self.on_peg(link)))
        return all((not falls and body.flight.rest) or _is_inexact(body) for body in movers)

    def carries(self, link: Touch) -> bool:
        """Whether a wall carries a circle of a contact, or it stands where it was taken: its flight is no fall."""
        return self.pegs is not self.scene.pegs and not self.scene.pegs.issuperset(self.pegs.intersection(link.circles))

    def _flying(self, bodies: tuple[int, ...]) -> list[int]:
        """Those of some circles that move, in order: an end, or another that is fixed, is no part of the set."""
        return sorted(i for i in bodies if not self.scene.circles[i].fixed)

    def _begin(self) -> Deviations:
        """Boxes: the bodies' balls as they are."""
        self._pending = None
        members = [body for i in self._movers if i not in self.outside and is_finite(body := self.bodies[i])]
        return Deviations(members, list(self.bodies.values()), self.falling)

    def _land(self) -> None:
        """Where no impulse came after a flight, the bodies have flown on, no more."""
        pending, held = self._pending, self._deviations
        if pending is None or held is None:
            return
        self._pending = None
        for i, numbers in pending.centres.items():
            if not held.land(self.bodies[i], numbers):
                self.loosen()
                return

    # -- contacts carried out elsewhere, in one go (see `LoneCentred`)

    def ready(self, link: Touch) -> Deviations | None:
        """The deviations, if they can be carried to this contact as it stands."""
        if self._pending is not None:
            self._land()
        held = self._deviations
        if held is None or self.carries(link):
            return None
        carried = held.carried
        if link[0] in carried and (link.flat or link[1] in carried):
            return held  # nearly always
        for i in link.circles:
            if self.stands and self.scene.circles[i].fixed:
                continue
            if i not in carried and not (i in held.place and _flies_inexactly(self.bodies[i].flight)):
                return None
        return held

    def renew(self) -> None:
        """Ends a block that is full; bodies keep the balls that they have until they are next struck."""
        held = self._deviations
        if held is None or not held.errors.full:
            return
        if not held.close():
            self.loosen()
            return
        self._next_break = 1


def _is_inexact(body: Body[arb]) -> bool:
    """Whether both velocities have a radius, and no number an infinite one."""
    return _flies_inexactly(body.flight) and is_finite(body)


def _flies_inexactly(flight: Flight[arb]) -> bool:
    """Whether a circle flies, and both velocities have a radius: a step of the set leaves them one."""
    return not (flight.rest or flight.vx.is_exact() or flight.vy.is_exact())


# -- A contact alone, carried out in one go on midpoints, with their deviations: `CentredState` does it in two steps.
#
# The numbers are those of `LoneContacts`, made of midpoints, with fewer products: d at the hit is d moved on by v,
# and one circle is reckoned from the other and from that. The deviations follow in one step of their set
# (docs/error-bound.md). Balls are made when somebody asks for them, which few do. What is not ordinary is left to the
# two steps, with nothing changed.


def short_clock(instant: arb, used: int) -> arb:
    """A number without radius beside an instant, of few bits: times of that cost next to nothing in products.

    Args:
        instant: the instant.
        used: the working precision.

    >>> with ball.precision(9000):
    ...     clock = short_clock(arb(2).sqrt(), 9000)
    ...     off = float(abs(clock - arb(2).sqrt()))
    >>> clock.is_exact(), 0 < off < 2.0**-255
    (True, True)
    """
    ball.use_bits(CLOCK_BITS)
    clock = (+instant).mid()
    ball.use_bits(used)
    return clock


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
        onto = self._state.stands and not is_flat(link) and self._state.on_peg(link)
        if is_arc(link) and not onto:
            return None
        held = self._state.ready(link)
        if held is None:
            return None
        self._known.at(bits)
        try:
            if onto and not is_flat(link):
                return self._off_round(held, link, bits, done + 1)
            if is_pair(link):
                return self._bounce(held, link, bits, done + 1)
            return self._rebound(held, link, bits, done + 1) if is_flat(link) else None
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
        worst = (a.acc if a.acc < b.acc else b.acc) + state.spare
        used = worst if worst < bits else bits
        ball.use_bits(used)
        if used > LONG_NUMBERS:
            return self._bounce_long(held, link, used, bits, step)
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

    def _bounce_long(self, held: Deviations, link: Pair, used: int, bits: int, step: int) -> int | None:
        """Two circles, in long numbers.

        Args:
            used: the working precision.

        Raises:
            Spent: as `_bounce`.
        """
        state = self._state
        one, other = link
        a, b = state.bodies[one], state.bodies[other]
        square_reach, share_a, share_b, alike = self._known.partners(link)
        ax, ay, avx, avy, at, a_last = held.mid[one]
        bx, by, bvx, bvy, bt, b_last = held.mid[other]
        vx, vy = bvx - avx, bvy - avy
        if a_last >= b_last:
            base = at
            lag = at - bt
            dx, dy = bx + bvx * lag - ax, by + bvy * lag - ay
        else:
            base = bt
            lag = bt - at
            dx, dy = bx - (ax + avx * lag), by - (ay + avy * lag)
        along, cross = pair_turned(dx, dy, vx, vy)
        square = vx**2 + vy**2
        disc = square * square_reach - cross**2
        if cross.is_zero() or not disc > ball.ZERO:
            return None
        root = disc.sqrt()
        wait = -(along + root) / square
        ex, ey = dx + vx * wait, dy + vy * wait
        instant = base + wait
        clock = short_clock(instant, used)
        lag = clock - base
        late = wait - lag
        since_a, since_b = clock - at, clock - bt
        if not (ball.is_sharp(since_a) and ball.is_sharp(since_b)):
            return None
        strength = share_a * root
        jx, jy = strength * ex, strength * ey
        px, py = jx * late, jy * late
        ax, ay, avx, avy = ax + avx * since_a + px, ay + avy * since_a + py, avx - jx, avy - jy
        if not alike:
            strength = share_b * root
            jx, jy = strength * ex, strength * ey
            px, py = jx * late, jy * late
        bx, by, bvx, bvy = bx + bvx * since_b - px, by + bvy * since_b - py, bvx + jx, bvy + jy
        moved = (a, ax, ay, avx, avy), (b, bx, by, bvx, bvy)
        since = since_a, since_b
        found = carry_pair(held, state, link, (ex, ey, vx, vy, root), since, late, moved, clock, step)
        return None if found is None else self._land(held, moved, found, (instant, late), step, bits)

    def _rebound(self, held: Deviations, link: AtWall, bits: int, step: int) -> int | None:
        """A circle and a wall.

        Raises:
            Spent: if the deviations are too large after it.
        """
        state, index = self._state, link[0]
        if state.falling is not None:
            return self._off_falling(held, link, bits, step)
        body = state.bodies[index]
        wall = self._known.wall(link)
        worst = body.acc + state.spare
        used = worst if worst < bits else bits
        ball.use_bits(used)
        x, y, vx, vy, base, _ = held.mid[index]
        if isinstance(wall, Oblique):
            wait = wall_hit_time(wall_gap(x, y, *wall[:5]), wall_approach(vx, vy, wall.nx, wall.ny))
        else:
            wait = (wall.touch - y) / vy if wall.level else (wall.touch - x) / vx
        instant = base + wait
        if not instant.is_finite():
            return None
        long = used > LONG_NUMBERS
        clock = short_clock(instant, used) if long else instant.mid()
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
        elif long:
            x, y = x + vx * lag, y + vy * lag
            if wall.level:
                y, vy = wall.twice - y, -vy
            else:
                x, vx = wall.twice - x, -vx
        elif wall.level:
            x, y, vy = x + vx * lag, wall.touch + vy * late, -vy
        else:
            x, y, vx = wall.touch + vx * late, y + vy * lag, -vx
        moved = body, x, y, vx, vy
        found = carry_wall(held, link, held.face(state, link), lag, velocity, late, moved, clock, step)
        return None if found is None else self._land(held, (moved,), found, (instant, late), step, bits)

    def _off_falling(self, held: Deviations, link: AtWall, bits: int, step: int) -> int | None:
        """A circle and a wall that falls or moves: as `LoneContacts` has it, of midpoints.

        Raises:
            Spent: if the deviations are too large after it.
        """
        state, index = self._state, link[0]
        body, wall = state.bodies[index], self._known.fall(link)
        worst = body.acc + state.spare
        used = worst if worst < bits else bits
        ball.use_bits(used)
        x, y, vx, vy, base, _ = held.mid[index]
        met = wall.met(x, y, vx, vy, base, ball.ZERO, arb.sqrt)
        if met is None or not (base + met[0]).is_finite():
            return None
        wait, speed = met
        instant = base + wait
        clock = short_clock(instant, used) if used > LONG_NUMBERS else instant.mid()
        lag = clock - base
        if not ball.is_sharp(lag):
            return None
        late = wait - lag
        ux, uy = wall.turn_x * speed, wall.turn_y * speed
        moved = body, x + vx * lag - ux * late, y + vy * lag - uy * late, vx + ux, vy + uy
        found = carry_fall(held, link, slope_of(held, state, link), lag, speed, late, moved, clock, step)
        return None if found is None else self._land(held, (moved,), found, (instant, late), step, bits)

    def _off_round(self, held: Deviations, link: Round, bits: int, step: int) -> int | None:
        """A circle that falls and something round that stands: a fixed circle, an end, a side of an arc.

        Raises:
            Spent: if the deviations are too large after it.
        """
        state = self._state
        body = state.faller(link)
        _, share_a, share_b, _ = self._known.partners(link)
        used = min(body.acc + state.spare, bits)
        ball.use_bits(used)
        window, mid = window_of(state, link), held.mid[body.index]
        x, y, vx, vy, base, _ = mid
        met = None if window is None else met_beside(state, link, window, mid)
        if window is None or met is None:
            return None
        wait, there = met
        instant = base + wait
        clock = short_clock(instant, used) if used > LONG_NUMBERS else instant.mid()
        lag = clock - base
        if not ball.is_sharp(lag):
            return None
        late = wait - lag
        first = body is link.ends(state)[0]
        strength = (share_a if first else -share_b) * there.approach()
        ux, uy = strength * there.dx, strength * there.dy
        moved = body, x + vx * lag - ux * late, y + vy * lag - uy * late, vx + ux, vy + uy
        found = carry_round(held, state, link, met, window, lag, late, moved, clock, step)
        if found is None:
            return None
        accuracy = self._land(held, (moved,), found, (instant, late), step, bits)
        state.contacts[body.index] = step, {link: 1}
        if is_pair(link):
            peg = state.bodies[link.b if first else link.a]
            peg.flight = peg.flight._replace(t=clock, instant=state.instant, late=state.late, last=step)
            assert self.landed is not None
            self.landed.append((peg, midpoints(peg.flight), None))
        return accuracy

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
