"""A state on balls that loses bits at the dynamics' own rate: exact midpoints, and one set of all their deviations.

Balls forget that errors belong together: each collision pays for the box around what was a turned box, about twice
the bits that the motion itself takes. Here a body's midpoints are carried through a step by `BallState`, without any
radius, and what the truth is away from them by `Deviations`. The numbers of a body that others read are balls as
before: the midpoint, and the bound for the body.

Only the ordinary instant is carried so: one contact, of two circles or a circle and a wall, that nothing holds to a
line. At any other the deviations are given up, the balls are carried as `BallState` does it, and new ones are begun
after it. See docs/error-bound.md.
"""

from __future__ import annotations

from typing import NamedTuple

from flint import arb

from ....scenarios.numbers.quantity import Quantity
from ....scenarios.scene import Scene
from ...numbers import ball
from ..ball_state import BallState, Told
from ..body import Body, Flight
from ..contact import AtWall, Entry, Link, Touch
from .deviations import Deviations, Numbers, is_finite, numbers_of
from .errors import Collision

MOST_MOVERS = 24
"""Circles that move: a block costs the cube of their number, and balls lose little where each is hit seldom."""

LONGEST_BREAK = 64
"""Instants for which nothing is begun, at most, after deviations that came to nothing."""


class Pending(NamedTuple):
    """A contact to which bodies have been advanced, and whose impulse is to come.

    Attributes:
        link: the contact.
        centres: each flying body's (x, y, vx, vy) at the clock, from midpoints alone.
        central: late, told and root as `BallState` has them, from midpoints alone.
        shown: the first two as others see them.
        hit: of two circles, the derivative of their collision.
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
    """

    def __init__(self, scene: Scene, centred: bool = True) -> None:
        super().__init__(scene)
        self.centred = centred
        self.outside: set[int] = set()
        self._movers = tuple(i for i, circle in enumerate(scene.circles) if not circle.fixed)
        self._deviations: Deviations | None = None
        self._pending: Pending | None = None
        self._break = 0
        self._next_break = 1

    def loosen(self) -> None:
        """Gives the deviations up: each body keeps its balls."""
        if self._deviations is not None:
            self._deviations, self._pending = None, None
            self._break, self._next_break = self._next_break, min(2 * self._next_break, LONGEST_BREAK)

    def become(self, other: BallState) -> None:
        """As `BallState.become`."""
        super().become(other)
        if isinstance(other, CentredState):
            self.centred, self.outside = other.centred, other.outside
            self._deviations, self._pending = other._deviations, other._pending
            self._break, self._next_break = other._break, other._next_break

    # -- steps

    def go(self, source: Link | int | Quantity, bodies: tuple[int, ...]) -> None:
        """As `State.go`."""
        self._land()
        if isinstance(source, (int, Quantity, Entry)) or not self._ordinary(source, bodies):
            self.loosen()
            super().go(source, bodies)
            return
        held = self._deviations
        if held is None or not held.holds(bodies):
            held = self._deviations = self._begin()
        flying = [body for i in bodies if not (body := self.bodies[i]).flight.rest]
        before = [body.flight for body in flying]
        for body in flying:
            held.centre(body)
        super().go(source, bodies)
        centres = {body.index: numbers_of(body) for body in flying}
        waits = [(body.index, body.flight.t - flight.t) for body, flight in zip(flying, before, strict=True)]
        lags = [(i, float(wait)) for i, wait in waits if ball.is_sharp(wait)]
        told = None
        if len(lags) == len(waits):
            told = held.advance(lags, self, source, self._told, self._root)
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
            body.flight = body.flight._replace(rest=False)
            held.show(body)
        self.renew()

    def _carried(self, held: Deviations, pending: Pending, movers: list[Body[arb]]) -> bool:
        """Carries the deviations through an impulse; whether that could be done."""
        link = pending.link
        if isinstance(link, AtWall):
            return held.mirror(held.face(self, link), movers[0])
        assert pending.hit is not None
        return held.meet(link, movers, pending.hit)

    def forget_contact(self) -> None:
        """As `BallState.forget_contact`."""
        self._land()
        super().forget_contact()

    def take(self, index: int) -> None:
        """As `State.take`."""
        self.loosen()
        super().take(index)

    def flip(self) -> None:
        """As `State.flip`."""
        self.loosen()
        super().flip()

    def _movers_of(self, link: Touch) -> list[Body[arb]]:
        return [self.bodies[i] for i in link.circles if not self.scene.circles[i].fixed]

    def _ordinary(self, link: Touch, bodies: tuple[int, ...]) -> bool:
        """Whether deviations may be carried to this contact."""
        if not self.centred or self._break or len(self._movers) > MOST_MOVERS:
            self._break -= self._break > 0
            return False
        movers = self._movers_of(link)
        if sorted(body.index for body in movers) != sorted(bodies) or not self.outside.isdisjoint(bodies):
            return False
        return all(body.flight.rest or _is_inexact(body) for body in movers)

    def _begin(self) -> Deviations:
        """Boxes: the bodies' balls as they are."""
        self._pending = None
        members = [body for i in self._movers if i not in self.outside and is_finite(body := self.bodies[i])]
        return Deviations(members, list(self.bodies.values()))

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
        if held is None:
            return None
        carried = held.carried
        if link[0] in carried and (link[1] in carried or isinstance(link, AtWall)):
            return held  # nearly always
        for i in link.circles:
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
