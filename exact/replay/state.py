"""The event log, and the state that it computes in any number system: steps without decisions, carried out."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, ClassVar, Literal, NamedTuple, TypeAlias

from flint import arb

from ...scenarios.lazy import frozen
from ...scenarios.numbers.quantity import Quantity, Real
from ...scenarios.scene import Scene
from ...scenarios.things import Pocket
from ...scenarios.trajectory import Settling
from ...scenarios.work import product_units
from ..laws.formulas import (
    advance,
    damped,
    pair_approach,
    pair_discriminant,
    pair_gap,
    pair_hit_time,
    pair_impulse,
    pair_last_time,
    pair_nearest_time,
    speed_change,
    wall_bounce,
)
from ..numbers.system import Arithmetic, N, solve_positive
from .contact import (
    AtArc,
    AtWall,
    Body,
    Entry,
    Flight,
    Gravity,
    Link,
    Pair,
    Relation,
    Round,
    Sides,
    Touch,
    can_push,
    contact_of,
)
from .round_falls import RoundFalls
from .wall_flights import WallFlights

if TYPE_CHECKING:
    from ...scenarios.arcs import ArcSide

# -- The event log: what happened, as steps without decisions, and which of them a number rests on.
#
# Given the scene and the log, every number of a run can be computed again: to more bits, in nested square roots.


class Go(NamedTuple):
    """Advance `bodies` to one instant.

    The instant is the hit time of `source` if that is a Link, the clock of a body if it is an int, the constant
    itself if it is a Quantity.
    """

    source: Link | int | Quantity
    bodies: tuple[int, ...]


class Kick(NamedTuple):
    """Apply, together, the impulses that make each of these contacts separate e times as fast as it approached.

    Attributes:
        links: the contacts that push.
        among: the contacts whose law this is: all that approach in a round of the policy `simultaneous`, of which
            `links` push; the contact alone where an order was chosen. The velocities that come out depend on the
            state and on `among` alone, so symmetric instants have symmetric `among`, whatever set of contacts was
            found to push.
    """

    links: tuple[Touch, ...]
    among: tuple[Touch, ...]


class Flip(NamedTuple):
    """Negate every velocity; all bodies stand at one instant."""


class Take(NamedTuple):
    """Take a body out of play: it rests where it is, and nothing meets it."""

    body: int


class Settle(NamedTuple):
    """From the instant at which a body stands on, a wall carries it, against gravity: it flies straight along it.

    Its flight is kept in true coordinates from then on. Down a slope it slides for ever, out of play, with what
    there is of gravity along that.

    Attributes:
        body: the circle.
        wall: what carries it: a wall across gravity, or a slope.
        slides: whether it moves along the wall.
        bounces: whether infinitely many bounces on it come before, of which nothing but the speed of the first is kept.
        other: the other wall of two slopes that hold it between them; below 0 where one carries it.
    """

    body: int
    wall: int
    slides: bool
    bounces: bool = False
    other: int = -1

    def told(self, scene: Scene, time: Real, since: Real | None) -> Settling:
        """As a run's record, of a time."""
        circle, wall = contact_of(scene, AtWall(self.body, self.wall))
        other = contact_of(scene, AtWall(self.body, self.other)).second if self.other >= 0 else None
        return Settling(circle, wall, time, since, other)


class Lift(NamedTuple):
    """Nothing carries a body any more, from the instant at which it stands on: it falls as others do."""

    body: int


class Leave(NamedTuple):
    """What falls touches something round that stands as its flight begins, pushed by others or by nothing: they part.

    Attributes:
        link: the contact.
        fold: of the zero that its gap has there: one, where they part at once; more, where their speed apart is zero.
    """

    link: Touch
    fold: int


Step: TypeAlias = Go | Kick | Flip | Take | Settle | Lift | Leave


STEP_UNITS = 60
"""Work of one step of the log in short numbers: about 60 microseconds."""

STEP_PRODUCTS = 30
"""Products of a step: those of long numbers are most of it."""


def step_units(bits: int) -> int:
    """Work of one step of the log in numbers of so many bits.

    >>> [step_units(bits) for bits in (256, 10_000, 1_000_000)]
    [60, 240, 77280]
    """
    return STEP_UNITS + STEP_PRODUCTS * product_units(bits, bits)


def causal_past(steps: Sequence[Step], bodies: Iterable[int]) -> tuple[list[int], list[int]]:
    """The steps on which the states of some bodies depend, in order, and all bodies in them.

    Args:
        steps: the log.
        bodies: indices of the circles asked about.
    """
    wanted = set(bodies)
    needed: list[int] = []
    for k in range(len(steps) - 1, -1, -1):
        step = steps[k]
        if isinstance(step, Go):
            if not wanted.isdisjoint(step.bodies):
                needed.append(k)
                if isinstance(step.source, int):
                    wanted.add(step.source)
                elif not isinstance(step.source, Quantity):
                    wanted.update(step.source.circles)
        elif isinstance(step, Kick):
            touched = {i for link in step.links for i in link.circles}
            if wanted & touched:
                needed.append(k)
                wanted |= touched
        elif isinstance(step, Take | Settle | Lift):
            if step.body in wanted:
                needed.append(k)
        elif isinstance(step, Leave):
            if not wanted.isdisjoint(step.link.circles):
                needed.append(k)
        else:
            needed.append(k)
    needed.reverse()
    return needed, sorted(wanted)


def circles_of(step: Step, count: int) -> tuple[int, ...]:
    """The circles that take part in a step, of so many."""
    if type(step) is Go:
        source = step.source
        if isinstance(source, tuple):
            extra = [i for i in source.circles if i not in step.bodies]
            return (*step.bodies, *extra) if extra else step.bodies
        return (*step.bodies, source) if isinstance(source, int) else step.bodies
    if type(step) is Kick:
        if len(step.links) == 1:
            return step.links[0].circles
        return tuple({i for link in step.links for i in link.circles})
    if isinstance(step, Take | Settle | Lift):
        return (step.body,)
    if isinstance(step, Leave):
        return step.link.circles
    return tuple(range(count))


# -- The circles and walls of a scene in one number system, as they fly: how far two are apart, and when they meet.


class Flights(RoundFalls[N], WallFlights[N]):
    """Bodies and walls of a scene in one number system.

    Args:
        scene: the scene; its state at time 0 is the state's first state.
        numbers: the system.
        only: the circles that will be asked for; others are left out, to spare work.

    Attributes:
        bodies: the circles, by index.
        pockets: the pockets, as bodies at rest.
        arcs: the sides of arcs, as bodies at rest: a hollow one has its radius below zero.
        sides: on which side of each wall each circle lies.
        falling: half of the scene's gravity, zero where walls move without; None where neither is.
        drifts: the velocities of the walls that move.
        share: (1 + e) / 2 with the scene's restitution e, the part of an elastic impulse that there is; None for e = 1.
    """

    bends: ClassVar[bool] = False
    """Whether flights under gravity are kept in true coordinates (see `Gravity`)."""

    def __init__(self, scene: Scene, numbers: Arithmetic[N], only: Iterable[int] | None = None) -> None:
        self.scene = scene
        self.constant = constant = numbers.constant
        self.root = numbers.root
        self.n = len(scene.circles)
        self.zero: N = constant(Quantity.of(0))
        self.one: N = constant(Quantity.of(1))
        self.share: N | None = None if scene.elastic else constant((scene.restitution + 1) / 2)
        self.falling: Gravity[N] | None = None
        if scene.gravity is not None:
            self.falling = Gravity(constant(scene.gravity[0] / 2), constant(scene.gravity[1] / 2), self.bends)
        elif scene.moving_walls:
            self.falling = Gravity(self.zero, self.zero, self.bends)
        moving = [(k, wall) for k, wall in enumerate(scene.walls) if wall.moves]
        self.drifts: dict[int, tuple[N, N]] = {k: (constant(wall.vx), constant(wall.vy)) for k, wall in moving}
        self._measures: dict[tuple[Quantity, Quantity | Literal["oo"]], tuple[N, N]] = {}
        self.bodies = {i: self._circle(i) for i in (range(self.n) if only is None else sorted(only))}
        self.pockets = [self._still(k, pocket, True) for k, pocket in enumerate(scene.pockets)]
        self.arcs = [self._still(k, side, False) for k, side in enumerate(scene.arc_sides)]
        self._lines = {}
        self.sides = Sides(scene)
        self.pegs, self.contacts, self.slopes, self.bounced = scene.pegs, {}, {}, {}
        self.paces = {i: (constant(end.drift[0]), constant(end.drift[1])) for i, end in scene.moving_ends.items()}
        self.curved = self.bends or (scene.gravity is not None and any(part.sign() for part in scene.gravity))
        self.stands = scene.gravity is not None and bool(scene.settle or self.pegs or self.arcs or self.pockets)

    def _circle(self, i: int) -> Body[N]:
        circle, constant, zero = self.scene.circles[i], self.constant, self.zero
        x, y, vx, vy = constant(circle.x), constant(circle.y), constant(circle.vx), constant(circle.vy)
        flight = Flight(x, y, vx, vy, zero, zero, rest=circle.at_rest and (not self.bends or circle.fixed))
        r, m = circle.r, circle.m
        if r.rational is None or (isinstance(m, Quantity) and m.rational is None):
            return Body(i, flight, constant(r), constant(circle.inverse_mass))
        known = self._measures.get((r, m))
        if known is None:
            known = self._measures[r, m] = constant(r), constant(circle.inverse_mass)
        return Body(i, flight, *known)

    def _still(self, k: int, thing: Pocket | ArcSide, is_pocket: bool) -> Body[N]:
        constant, zero = self.constant, self.zero
        flight = Flight(constant(thing.x), constant(thing.y), zero, zero, zero, zero, rest=True)
        return Body(k, flight, constant(thing.r), zero, is_pocket=is_pocket)

    # -- what the steps need

    def relation(self, link: Round) -> Relation[N]:
        """The two of a contact at the later of their clocks, which the log's order tells without a comparison."""
        a, b = link.ends(self)
        f, g = a.flight, b.flight
        if self.stands and self.on_peg(link):
            return self.peg_relation(link)
        if self.falling is not None and self.falling.bent and not self.carried(link):
            return self.bent_relation(self.falling, a, b)
        ax, ay, bx, by = f.x, f.y, g.x, g.y
        if f.last >= g.last:
            t = f.t
            if not g.rest:
                lag = f.t - g.t
                bx, by = advance(bx, g.vx, lag), advance(by, g.vy, lag)
        else:
            t = g.t
            if not f.rest:
                lag = g.t - f.t
                ax, ay = advance(ax, f.vx, lag), advance(ay, f.vy, lag)
        return Relation(t, bx - ax, by - ay, g.vx - f.vx, g.vy - f.vy, self.reach(a, b))

    def later(self, link: Round) -> Body[N]:
        """The one of the two of a contact whose flight is newer; one that falls, rather than one that stands."""
        if self.stands and self.on_peg(link):
            return self.faller(link)
        a, b = link.ends(self)
        return a if a.flight.last >= b.flight.last else b

    def reach(self, a: Body[N], b: Body[N]) -> N:
        """The sum of two radii; for a pocket its own, as a centre enters it."""
        return b.r if b.is_pocket else a.r + b.r

    # -- two circles, a circle and an arc, or a centre and a pocket

    def round_gap(self, link: Round) -> N:
        """|d|^2 - R^2 at the later clock; in enclosures, whose clocks may stand beside it, at the instant."""
        if self.stands and self.on_peg(link):
            return self.peg_fall(link).gap()
        pair, late = self.relation(link), self.later(link).flight.late
        if late is None:
            return pair_gap(pair.dx, pair.dy, pair.reach)
        return pair_gap(advance(pair.dx, pair.vx, late), advance(pair.dy, pair.vy, late), pair.reach)

    def round_approach(self, link: Round) -> N:
        """d.v then: negative while the two come nearer."""
        if self.stands and self.on_peg(link):
            return self.peg_fall(link).approach()
        pair, late = self.relation(link), self.later(link).flight.late
        if late is None:
            return pair_approach(pair.dx, pair.dy, pair.vx, pair.vy)
        return pair_approach(advance(pair.dx, pair.vx, late), advance(pair.dy, pair.vy, late), pair.vx, pair.vy)

    def discriminant(self, link: Round) -> N:
        """|v|^2 R^2 - (d x v)^2."""
        pair = self.relation(link)
        return pair_discriminant(pair.dx, pair.dy, pair.vx, pair.vy, pair.reach)

    def round_hit(self, link: Round) -> tuple[N, N]:
        """The clock from which the hit is reckoned, and the time from it to the hit."""
        if self.curved and self.stands and self.on_peg(link):
            return self.peg_hit(link)
        t, dx, dy, vx, vy, reach = self.relation(link)
        root = self.root(pair_discriminant(dx, dy, vx, vy, reach))
        return t, pair_hit_time(pair_gap(dx, dy, reach), pair_approach(dx, dy, vx, vy), root)

    def fall_wait(self, link: Round) -> N | None:
        """The time from its clock until a circle falls onto something round; None where it does not.

        Only of numbers that answer at once.

        Raises:
            Unsharp: where they do not tell it.
        """
        raise NotImplementedError

    def graze(self, link: Round) -> tuple[N, N]:
        """As `round_hit`, for two that touch without pushing: the time at which they are nearest.

        Raises:
            ZeroDivisionError, or as `peg_hit`: of a circle that falls onto something round.
        """
        if self.curved and self.stands and self.on_peg(link):
            if isinstance(self.zero, arb):
                raise ZeroDivisionError("no ball tells a double zero")
            return self.no_closed_form()
        t, dx, dy, vx, vy, _ = self.relation(link)
        return t, pair_nearest_time(pair_approach(dx, dy, vx, vy), vx, vy)

    def round_parts(self, link: Round) -> tuple[N, N, N]:
        """p, q, D with hit time p + q*sqrt(D): the textbook root, for comparisons that add no root."""
        if self.curved and self.stands and self.on_peg(link):
            return self.peg_parts(link)
        t, dx, dy, vx, vy, reach = self.relation(link)
        a = vx * vx + vy * vy
        disc = pair_discriminant(dx, dy, vx, vy, reach)
        return t - pair_approach(dx, dy, vx, vy) / a, -(self.one / a), disc

    def arc_hit(self, link: AtArc) -> tuple[N, N]:
        """As `round_hit`; a hollow side is met at the later zero of the gap."""
        if not link.hollow or (self.curved and self.stands):
            return self.round_hit(link)
        t, dx, dy, vx, vy, reach = self.relation(link)
        root = self.root(pair_discriminant(dx, dy, vx, vy, reach))
        return t, pair_last_time(pair_approach(dx, dy, vx, vy), root, vx * vx + vy * vy)

    def arc_span(self, link: AtArc, graze: bool) -> tuple[N, N]:
        """d where a circle meets the circle of an arc, or, `graze`, is nearest to it."""
        pair = self.relation(link)
        _, wait = self.graze(link) if graze else self.arc_hit(link)
        return advance(pair.dx, pair.vx, wait), advance(pair.dy, pair.vy, wait)


# -- Carries out an event log in any number system: advance bodies to a contact, apply impulses, flip velocities.
#
# An event log holds no decisions: given the scene and the log, every number of a run can be computed again, to more
# bits or in nested square roots. What an event-driven engine keeps while it runs is such a state too, fed one step at
# a time.


class ReplayState(Flights[N]):
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
            if self.stands and isinstance(step.source, tuple) and not can_push(step.source):
                self.note_stood((step.source,))
        elif type(step) is Kick:
            self.kick(step.links)
            if self.stands:
                self.note_stood(step.among)
        elif type(step) is Take:
            self.take(step.body)
        elif type(step) is Settle:
            self.settle(*step)
        elif type(step) is Lift:
            self.lift(step.body)
        elif type(step) is Leave:
            self.note_stood((step.link,), step.fold)
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
        instant, late, done, falls = self.instant, self.late, self.steps_done, self.falling
        for index in bodies:
            body = self.bodies[index]
            x, y, vx, vy, t, _, _, _, rest = body.flight
            if falls is not None and falls.bent and index not in self.pegs:
                if t is not clock:
                    x, y, vx, vy = falls.flown((x, y, vx, vy), lag if lag is not None and t is base else clock - t)
            elif not rest and t is not clock:
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
        if self.stands and self.on_peg(link):
            return self.peg_fall(link)[:2]
        a, b = link.ends(self)
        (ax, ay), (bx, by) = self.place(a), self.place(b)
        return bx - ax, by - ay

    def rim(self, link: Entry) -> N:
        """|d|^2 - R^2 of a centre and a pocket, at the instant at which the circle stands."""
        return pair_gap(*self.span(link), self.pockets[link.pocket].r)

    def round_closing(self, link: Round) -> N:
        """d.v at the instant: negative while the two come nearer."""
        if self.stands and self.on_peg(link):
            return self.peg_fall(link).approach()
        a, b = link.ends(self)
        return pair_approach(*self.span(link), b.flight.vx - a.flight.vx, b.flight.vy - a.flight.vy)

    # -- impulses

    def kick(self, links: tuple[Touch, ...]) -> None:
        """Applies the impulses of contacts together; each then separates e times as fast as it approached."""
        if len(links) > 1:
            self._kick_together(links)
        else:
            for link in links:
                link.bounce(self)

    def bounce_pair(self, link: Pair) -> None:
        """The bounce of two circles."""
        a, b = link.ends(self)
        if self.stands and self.on_peg(link):
            dx, dy, vx, vy, *_ = self.peg_fall(link)
        else:
            (dx, dy), vx, vy = self.span(link), b.flight.vx - a.flight.vx, b.flight.vy - a.flight.vy
        jx, jy = pair_impulse(dx, dy, vx, vy, self.reach(a, b), a.w, b.w)
        if self.share is not None:
            jx, jy = jx * self.share, jy * self.share
        self.push(a, -jx, -jy)
        self.push(b, jx, jy)

    def bounce_wall(self, link: AtWall) -> None:
        """The bounce of a circle off a wall."""
        body, line = self.bodies[link.circle], self.line(link.circle, link.wall)
        if self.falling is not None:
            change = speed_change(self.wall_approach(link)) / line.nn
            change = change if self.share is None else change * self.share
            self._turn(body, -(line.nx * change), -(line.ny * change))
            return
        x, y, vx, vy, t, instant, late, last, rest = body.flight
        wx, wy = wall_bounce(vx, vy, line.nx, line.ny, line.nn)
        vx, vy = (wx, wy) if self.share is None else (damped(vx, wx, self.share), damped(vy, wy, self.share))
        body.flight = Flight(x, y, vx, vy, t, instant, late, last, rest)

    def bounce_arc(self, link: AtArc) -> None:
        """The bounce of a circle off an arc, as off a fixed circle."""
        a, b = link.ends(self)
        if self.stands:
            dx, dy, vx, vy, *_ = self.peg_fall(link)
        else:
            (dx, dy), vx, vy = self.span(link), -a.flight.vx, -a.flight.vy
        jx, jy = pair_impulse(dx, dy, vx, vy, self.reach(a, b), a.w, b.w)
        if self.share is not None:
            jx, jy = jx * self.share, jy * self.share
        self.push(a, -jx, -jy)

    def push(self, body: Body[N], jx: N, jy: N) -> None:
        """Gives a circle an impulse; a fixed one takes none."""
        if self.scene.circles[body.index].fixed:
            return
        self._turn(body, body.w * jx, body.w * jy)

    def _turn(self, body: Body[N], ux: N, uy: N) -> None:
        """Changes a circle's velocity at the instant."""
        x, y, vx, vy, t, instant, own, last, _ = body.flight
        if self.late is not None:
            x, y = x - ux * self.late, y - uy * self.late
        body.flight = Flight(x, y, vx + ux, vy + uy, t, instant, own, last)

    def _kick_together(self, links: tuple[Touch, ...]) -> None:
        matrix, approaches = self.contact_system(links)
        strengths = solve_positive(matrix, [-speed_change(u) for u in approaches], self.zero)
        if self.share is not None:
            strengths = [strength * self.share for strength in strengths]
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

    def arc_arms(self, link: AtArc) -> list[tuple[int, N, N]]:
        """As `pair_arms`: away from the outside, towards the middle from within."""
        dx, dy = self.span(link)
        return [(link.circle, dx, dy) if link.hollow else (link.circle, -dx, -dy)]

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
        """Takes a body out of play, where it is at the instant: under gravity it stands there, in true coordinates."""
        body, zero = self.bodies[index], self.zero
        if self.falling is not None and index not in self.pegs:
            x, y, _, _ = self.true_row(body)
            self.pegs |= {index}
        else:
            x, y = self.place(body)
        _, _, _, _, t, instant, late, last, _ = body.flight
        body.flight = Flight(x, y, zero, zero, t, instant, late, last, rest=True)

    def flip(self) -> None:
        """Negates every velocity, and keeps the moment."""
        self.flip_time = self.instant
        twice = None if self.late is None else self.late + self.late
        falls = self.falling
        for body in self.bodies.values():
            x, y, vx, vy, t, instant, late, _, rest = body.flight
            if falls is not None and not falls.bent:
                fourfold = self.instant + self.instant + self.instant + self.instant
                wx, wy = -vx - falls.hx * fourfold, -vy - falls.hy * fourfold  # v = V + g t turns to -v = W + g t
                if self.late is not None:
                    x, y = advance(x, vx - wx, self.late), advance(y, vy - wy, self.late)
                vx, vy, rest = wx, wy, False
            elif not rest:
                if twice is not None:
                    x, y = advance(x, vx, twice), advance(y, vy, twice)
                vx, vy = -vx, -vy
            body.flight = Flight(x, y, vx, vy, t, instant, late, self.steps_done, rest)


def replay(state: ReplayState[N], steps: Sequence[Step], needed: Iterable[int]) -> None:
    """Carries out the needed steps of a log on a state that may hold only some of the bodies."""
    held = state.bodies
    for k in needed:
        step = steps[k]
        if isinstance(step, Go) and len(held) < state.n:
            step = Go(step.source, tuple(i for i in step.bodies if i in held))
        state.steps_done = k
        state.do(step)


# -- Numbers of a state that are asked for again and again.


@frozen
class Velocity:
    """Computes a component of a circle's velocity."""

    body: int
    axis: int

    def __call__(self, state: ReplayState[N]) -> N:
        flight = state.bodies[self.body].flight
        return flight.vx if self.axis == 0 else flight.vy


@frozen
class Constant:
    """A number that the scene gives."""

    value: Quantity

    def __call__(self, state: ReplayState[N]) -> N:
        return state.constant(self.value)
