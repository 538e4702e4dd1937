"""What one step of a run misses the laws by, enclosed, beside what rounding by a declared unit may make of it.

docs/audit.md derives the constants.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from flint import arb

from ...exact.numbers import ball
from ...exact.replay.contact import Sides
from ...exact.simulation.arc_meetings import held_between
from ...scenarios.numbers.quantity import ZERO as NONE
from ...scenarios.surfaces import parts_of
from ..foreign.impulses import left_of, limits_of_pushes, sharpened, strengths_of
from .residual import (
    FLIGHT_UNITS,
    IMPULSE_UNITS,
    LEAST,
    ROOT_UNITS,
    UNDERFLOW,
    UNDERFLOWS,
    Residual,
    along,
    length_of,
    rested,
    size_of,
    uncaptured,
)
from .transcript import WallInBalls, groups_of

if TYPE_CHECKING:
    from ...scenarios.arcs import ArcSide
    from ...scenarios.numbers.quantity import Quantity
    from ...scenarios.scene import Scene
    from .transcript import Fall, ReportedFlight, ReportedInstant, Transcript

CLOSE = 2.0**-40
"""A share of a time within which two contacts may be of one instant."""


class Thing(NamedTuple):
    """A circle: radius, and 1/m, 0 of a fixed one; sizes as doubles."""

    r: arb
    weight: arb
    radius: float
    share: float


class SideInBalls(NamedTuple):
    """A side of an arc: the middle of its circle, its radius, and its range; doubles near them.

    Of a hollow one `inward` is -1, else 1. n = (nx, ny) and h tell the range: see `scenarios.things.Arc.chord`.
    """

    x: arb
    y: arb
    r: arb
    inward: int
    full: bool
    nx: float
    ny: float
    h: float
    place: float
    radius: float
    ends: tuple[int, ...]


class ImpactLaws(NamedTuple):
    """Two that meet, at the engine's own places: what the laws say of their impulse.

    Attributes:
        nx, ny: the unit vector of the line of centres, from the first to the second; of a wall, towards it.
        gap: between the surfaces, enclosed.
        opening: n.(v_second - v_first) before; negative: they approach.
        speed: size of the relative velocity before, as a double.
        room: what rounding may make of the gap.
        turned: by what angle rounding may turn the line of centres.
        stretched: by what share of itself it is taken for longer or shorter, as long as the radii together.
        bounced: the opening that the restitution multiplies, where that is another one: an engine that moves first
            bounces with the velocity of before its last g dt, which is there all the same; `opening` is then the one
            that the change of velocity is 1 + e times as large as.
        curve: a bound of the rate at which the opening changes, along the engine's flights; 0 of an engine of steps.
    """

    nx: arb
    ny: arb
    gap: arb
    opening: arb
    speed: float
    room: float
    turned: float
    stretched: float = 0.0
    bounced: arb | None = None
    curve: float = 0.0

    def bend(self, speed: float, opening: float) -> float:
        """By what speed an impulse may be off, for a line of centres that is turned or stretched."""
        return 4 * speed * self.turned + 4 * abs(opening) * self.stretched

    @property
    def bent(self) -> float:
        """The same for the impulse that the two get as they meet."""
        return self.bend(self.speed, float(self.opening.mid()))

    @property
    def grazed(self) -> float:
        """By what speed the opening may be off, as rounding of the gap moves the time: its square by 4 `curve` `room`.

        >>> ImpactLaws(arb(1), arb(0), arb(0), arb(-0.625), 1.0, 0.0625, 0.0, curve=1.0).grazed
        0.25
        """
        speed, off = abs(float(self.opening.mid())), 4 * self.curve * self.room
        share = off and (off / speed / speed if speed else math.inf)  # no square, which may be too small
        return speed * (1.0 - math.sqrt(1.0 - share)) if share < 1.0 else speed + math.hypot(speed, math.sqrt(off))


class Laws:
    """The laws of flight, contact and impulse for one scene, beside the rounding of an engine.

    Args:
        scene: what is run.
        unit: u, half a unit in the last place of a number of size 1: 2**-53 for doubles.
        start: whether a start may be rounded, by the engine or as it is reported.
        step: its time step, if it has one: each adds its roundings to a flight.
        fall: the gravity, as the engine's `Transcript` has it; None without.

    Attributes:
        supports: by circle, the walls that can carry it: those across gravity, to which that pulls it.
        holds: whether two walls hold a circle between them, by their places.

    To be used at `AUDIT_BITS`.
    """

    def __init__(
        self, scene: Scene, unit: float, start: bool = True, step: float | None = None, fall: Fall | None = None
    ) -> None:
        self.parts = parts_of(scene)
        scene = scene.surfaces
        self.scene, self.unit, self.start, self.step = scene, unit, start, step
        self.least = max(LEAST, 16 * UNDERFLOW.get(unit, 0.0))
        self.came: list[dict[float, tuple[float, float]]] = [{} for _ in scene.circles]
        self.change = 1 + ball.constant(scene.restitution)
        self.restitution = float(scene.restitution)
        self.fall = fall
        self.count = len(scene.circles)
        zero = arb(0)
        self.things = [
            Thing(
                ball.constant(c.r),
                zero if c.fixed else ball.constant(c.inverse_mass),
                float(c.r),
                0.0 if c.fixed else float(c.inverse_mass),
            )
            for c in scene.circles
        ]
        self.moving = [not c.fixed for c in scene.circles]
        self._fastest = max(math.hypot(float(c.vx), float(c.vy)) for c in scene.circles)
        self._sides = Sides(scene)
        self.holds = partial(held_between, self._sides)
        level = [w for w in range(len(scene.walls)) if scene.settle and self._sides.level(w)]
        self.supports = [[w for w in level if self._sides.pull(k, w) < 0] for k in range(self.count)]
        self._ends_of = {wall: parts.ends for parts in self.parts.values() for wall in parts.faces}
        self.first_side = self.count + len(scene.walls)
        self.sides = [self._side(k, side) for k, side in enumerate(scene.arc_sides)]
        self._owners: dict[int, list[int]] = {}
        for thing, parts in self.parts.items():
            first = self.first_side
            for place in (*parts.ends, *(self.count + w for w in parts.faces), *(first + s for s in parts.sides)):
                self._owners.setdefault(place, []).append(thing)
        self._lines: dict[int, tuple[WallInBalls, WallInBalls]] = {}

    def line(self, circle: int, wall: int) -> WallInBalls:
        """A wall at time 0, with the normal from a circle towards it; of a face, to the side of its segment."""
        if wall not in self._lines:
            exact = self.scene.walls[wall]
            x0, y0, x1, y1 = (ball.constant(value) for value in (exact.x0, exact.y0, exact.x1, exact.y1))
            nx, ny = y1 - y0, x0 - x1
            span = (nx * nx + ny * ny).sqrt()
            size = max(math.hypot(float(x0), float(y0)), math.hypot(float(x1), float(y1)))
            length = float(span)
            thick = max((self.things[k].radius for k in self._ends_of.get(wall, ())), default=0.0)
            ux, uy = ball.constant(exact.vx), ball.constant(exact.vy)
            moves = (ux, uy, math.hypot(float(ux), float(uy)))
            self._lines[wall] = (
                WallInBalls(x0, y0, nx / span, ny / span, size, length, thick, *moves),
                WallInBalls(x0, y0, -nx / span, -ny / span, size, length, thick, *moves),
            )
        return self._lines[wall][self._sides.negative(circle, wall)]

    def _side(self, k: int, side: ArcSide) -> SideInBalls:
        x, y, r = ball.constant(side.x), ball.constant(side.y), abs(ball.constant(side.r))
        nx, ny, h = float(side.nx), float(side.ny), float(side.h)
        ends = next(parts.ends for parts in self.parts.values() if k in parts.sides)
        place, radius = math.hypot(float(side.x), float(side.y)), abs(float(side.r))
        return SideInBalls(x, y, r, side.r.sign(), side.full, nx, ny, h, place, radius, ends)

    def reach(self, pair: tuple[int, int]) -> float:
        """From centre to centre as two touch: infinite for a wall, below zero for the hollow side of an arc."""
        i, j = pair
        if j >= self.first_side:
            side = self.sides[j - self.first_side]
            return side.inward * float(side.r.mid()) + self.things[i].radius
        return math.inf if j >= self.count else float((self.things[i].r + self.things[j].r).mid())

    @property
    def parts_places(self) -> Iterable[int]:
        """The faces, ends and sides of arcs, by place in `Scene.ids` of the scene as engines see it."""
        return self._owners

    def wholes(self, bodies: tuple[int, ...]) -> list[tuple[int, ...]]:
        """Who takes part, with the thing that a face or an end is of, or the things, in place of it."""
        if not self.parts or len(bodies) < 2:
            return [bodies]
        return [(bodies[0], thing) for thing in self._owners.get(bodies[1], [bodies[1]])]

    # -- one instant

    def residuals(self, instant: ReportedInstant, events: int) -> Iterator[Residual]:
        """All residuals of an instant.

        Args:
            events: how many events the run had before it.
        """
        for k in instant.rested:
            flight, after = instant.before[k], instant.after[k]
            rest = along(self, k, flight)
            yield rested(self, k, flight, rest, after)
            high = rest._replace(x=flight.x, y=flight.y)  # as it bounced last: an engine leaves it there, or puts it on
            instant.before[k] = min(rest, high, key=lambda way: self._flown(k, way, after, events).size)
        for k, after in instant.after.items():
            if self.moving[k]:
                yield self._flown(k, instant.before[k], after, events)
        left = instant.after
        if instant.turned:
            yield from self._turned(instant, events)
            return
        if not instant.impulses:
            for k, after in left.items():
                if self.moving[k]:
                    yield self._bystander("bystander", k, instant.before[k], after)
            return
        groups, hit = groups_of(instant.impulses, self.moving, self.count), instant.circles(self.count)
        for k in hit:
            if self.scene.capture and self.step is None and self.moving[k] and k in left:
                yield from uncaptured(self, k, instant.before[k], left[k], events)
            _begin(self, k, instant.before[k], instant.time)
        for pairs in groups:
            if len(pairs) == 1:
                yield from self._impact(pairs[0], instant, left, events)
            else:
                yield from self._several(pairs, instant, left, events)
        for k, after in left.items():
            if k not in hit and self.moving[k]:
                yield self._bystander("bystander", k, instant.before[k], after)

    def begun(self, transcript: Transcript) -> Iterator[Residual]:
        """Where the run begins, beside the scene's start."""
        for k, (row, circle) in enumerate(zip(transcript.first(), self.scene.circles, strict=True)):
            if self.step is not None and self.moving[k] and row.time != 0.0:
                continue
            ux, uy = circle.drift
            for ends in ((row.x, row.y, circle.x, circle.y), (row.vx, row.vy, circle.vx + ux, circle.vy + uy)):
                x, y = ends[0] - ball.constant(ends[2]), ends[1] - ball.constant(ends[3])
                size = math.hypot(float(ends[2]), float(ends[3]))
                yield Residual("start", (k,), length_of(x, y), 2 * self.unit * size * self.start + LEAST)

    def _flown(self, k: int, before: ReportedFlight, after: ReportedFlight, events: int) -> Residual:
        """How far from where it flew to a circle says that it is."""
        span = after.t - before.t
        x = after.x - before.x - before.vx * span
        y = after.y - before.y - before.vy * span
        return Residual("flight", (k,), length_of(x, y), self.flown_room(before, after, events))

    def flown_room(self, before: ReportedFlight, after: ReportedFlight, events: int) -> float:
        """What rounding may make of the place that a flight ends at."""
        return self._blurred(before, after.place, after.time, events, after.speed)

    def _blurred(self, before: ReportedFlight, place: float, time: float, events: int, speed: float) -> float:
        """What rounding may make of a place, at the end of a flight; `speed` is that with which the circle goes on."""
        moved = max(0, events - before.made) if self.step is None else (time - before.time) / self.step
        units = FLIGHT_UNITS * (1 + moved)
        return self.unit * units * (before.place + place + (before.speed + speed) * (time + before.time)) + self.least

    def _bystander(self, kind: str, k: int, before: ReportedFlight, after: ReportedFlight) -> Residual:
        """A circle that meets nothing keeps its velocity."""
        size, fast = length_of(after.vx - before.vx, after.vy - before.vy), before.speed + after.speed
        fast += before.fallen
        if self.step is not None:  # a solver goes on pushing what impacts of other speeds have left by rounding
            self._fastest = fast = max(fast, self._fastest)
        return Residual(kind, (k,), size, FLIGHT_UNITS * self.unit * fast + self.least)

    def _turned(self, instant: ReportedInstant, events: int) -> Iterator[Residual]:
        """At a reversal every velocity is negated; of what is hit at that very moment, the energy is kept."""
        hit = instant.circles(self.count)
        energy, room = arb(0), 0.0
        fastest = max((max(instant.before[k].speed, instant.left(k)) for k in hit), default=0.0)
        met = [self.meeting(pair, instant, events) for pair in instant.impulses]
        bent = sum(meeting.bend(2 * fastest, 2 * fastest) for meeting in met)
        for k, after in instant.after.items():
            if not self.moving[k]:
                continue
            before = instant.before[k]
            if k not in hit:
                yield self._bystander("reversal", k, before.turned(), after)
                continue
            mass = 1 / self.things[k].weight
            energy += mass * (after.vx**2 + after.vy**2 - before.vx**2 - before.vy**2) / 2
            speed = before.speed + after.speed + before.fallen
            room += float(mass) * speed * (2 * IMPULSE_UNITS * self.unit * speed + bent)
        if hit:
            yield Residual("energy", instant.impulses[0], size_of(energy), room + self.least)

    # -- contacts

    def meeting(self, pair: tuple[int, int], instant: ReportedInstant, events: int) -> ImpactLaws:
        """Two that meet, at the engine's own places."""
        i, j = pair
        a, xa, ya = instant.there(i)
        time = instant.time
        if j >= self.first_side:
            return self._at_side(i, self.sides[j - self.first_side], instant, events)
        if j >= self.count:
            line = self.line(i, j - self.count).at(instant.after[i].t if i in instant.after else instant.t)
            height = line.nx * (line.x - xa) + line.ny * (line.y - ya)
            opening = -line.nears(a.vx, a.vy)
            bounced = None
            if self.fall is not None:
                opening, bounced = self._bounced(opening, line.nx, line.ny, self.fall)
            away = math.hypot(float(xa - line.x), float(ya - line.y))
            place = math.hypot(float(xa), float(ya))
            blur = self._blurred(a, place, time, events, instant.left(i))
            turn = min(1.0, FLIGHT_UNITS * self.unit * line.size / line.length)
            turn += _bent_at_end(self, j - self.count, line, xa, ya, blur, self.things[i].radius)
            sizes = line.size + place + self.things[i].radius + a.speed * (time - a.time)
            room = blur + turn * away + ROOT_UNITS * self.unit * sizes
            gap = height - self.things[i].r
            curve = _curve(self, 0.0, 1.0, line.nx, line.ny, True)
            speed = a.speed + line.drift
            return ImpactLaws(line.nx, line.ny, gap, opening, speed, room, turn, bounced=bounced, curve=curve)
        b, xb, yb = instant.there(j)
        dx, dy = xb - xa, yb - ya
        square = dx * dx + dy * dy
        distance = square.sqrt()
        reach = self.things[i].r + self.things[j].r
        wide = float(reach)
        vx, vy = b.vx - a.vx, b.vy - a.vy
        speed, near = math.hypot(float(vx), float(vy)), float(distance.mid())
        blur = self._blurred(a, math.hypot(float(xa), float(ya)), time, events, instant.left(i))
        blur += self._blurred(b, math.hypot(float(xb), float(yb)), time, events, instant.left(j))
        if not near:  # two centres in one place: no line joins them
            return ImpactLaws(dx, dy, -reach, arb(0), speed, blur, 1.0)
        one_falls = self.fall is not None and _falls(self, i, a) != _falls(self, j, b)
        fast = 2 * max(speed, a.speed, b.speed) if one_falls else speed  # g t is no more than both its speeds
        room = blur + _missed(self, (i, a), (j, b), near, wide, fast, time)
        nx, ny, gap = dx / distance, dy / distance, distance - reach
        opening = nx * vx + ny * vy
        room += self.underflown(speed, abs(float(opening.mid())) * wide)
        stretched = 0.0 if self.step is not None else min(1.0, abs(float(gap.mid())) / near)
        bounced = None
        if one_falls and self.fall is not None:
            opening, bounced = self._bounced(opening, nx, ny, self.fall, 1 if _falls(self, i, a) else -1)
        curve = _curve(self, speed, near, nx, ny, one_falls)
        return ImpactLaws(nx, ny, gap, opening, speed, room, min(1.0, blur / near), stretched, bounced, curve)

    def _bounced(self, opening: arb, nx: arb, ny: arb, fall: Fall, sign: int = 1) -> tuple[arb, arb | None]:
        """See `ImpactLaws.bounced`, between what falls and what stands; `sign` is -1 where the second falls."""
        if not (fall.step and fall.early):
            return opening, None
        bounced = opening + sign * fall.early * (nx * fall.gx + ny * fall.gy) * fall.step
        return (opening + (self.change - 1) * bounced) / self.change, bounced

    def _at_side(self, i: int, side: SideInBalls, instant: ReportedInstant, events: int) -> ImpactLaws:
        """A circle and a side of an arc: as two circles, one of which never moves, is hollow, and ends somewhere."""
        a, x, y = instant.there(i)
        dx, dy = side.inward * (side.x - x), side.inward * (side.y - y)
        distance = (dx * dx + dy * dy).sqrt()
        gap = side.inward * (distance - side.r) - self.things[i].r
        near, wide = float(distance.mid()), side.radius + side.inward * self.things[i].radius
        blur = self._blurred(a, math.hypot(float(x), float(y)), instant.time, events, instant.left(i))
        blur += ROOT_UNITS * self.unit * (side.place + side.radius + self.things[i].radius)
        if not near:  # in the very middle: no line leads to the arc
            return ImpactLaws(dx, dy, gap, arb(0), a.speed, blur, 1.0)
        fast = a.speed if self.fall is None else 2 * a.speed  # as of two circles
        room = blur + _missed(self, (i, a), (i, a), near, abs(wide), fast, instant.time)
        nx, ny = dx / distance, dy / distance
        opening = -(nx * a.vx + ny * a.vy)
        room += self.underflown(a.speed, abs(float(opening.mid()) * wide))
        stretched = 0.0 if self.step is not None else min(1.0, abs(float(gap.mid())) / near)
        turned = min(1.0, blur / near) + _bent_beside(self, side, x, y, near, blur, self.things[i].radius)
        opening, bounced = (opening, None) if self.fall is None else self._bounced(opening, nx, ny, self.fall)
        curve = _curve(self, a.speed, near, nx, ny, True)
        return ImpactLaws(nx, ny, gap, opening, a.speed, room, min(1.0, turned), stretched, bounced, curve)

    def underflown(self, speed: float, root: float) -> float:
        """What numbers too small for the engine's format make of a gap: the discriminant has their fourth powers.

        Its root is the speed of approach times the reach; an error e of it moves the time by e / (2 root speed**2), or
        by sqrt(e) / speed**2 at most.
        """
        least = UNDERFLOW.get(self.unit, 0.0) * UNDERFLOWS
        if not least or not speed:
            return 0.0
        return min(math.sqrt(least), least / (2 * root) if root else math.inf) / speed

    def _impact(
        self, pair: tuple[int, int], instant: ReportedInstant, after: dict[int, ReportedFlight], events: int
    ) -> Iterator[Residual]:
        """A single contact: gap and impulse."""
        met = self.meeting(pair, instant, events)
        yield Residual("gap", pair, size_of(met.gap), met.room)
        i, j = pair
        wa = self.things[i].weight
        wall = j >= self.count
        wb = arb(0) if wall else self.things[j].weight
        total = arb(1) if wall else wa + wb
        closing = ball.sign_of(met.opening)
        size, room, faint = -math.inf, 0.0, True
        for k, weight, sign in ((i, arb(1) if wall else wa, 1), *(() if wall else ((j, wb, -1),))):
            if not self.moving[k]:
                continue
            before, left = instant.before[k], after.get(k, instant.before[k])
            dvx, dvy = left.vx - before.vx, left.vy - before.vy
            share = 1.0 if wall else float(weight / total)
            if closing != 1:  # v' = v +- (1 + e) w / (w_a + w_b) (n.v) n
                push = sign * self.change * (weight / total) * met.opening
                if closing is None:
                    push = push.union(arb(0))
                dvx, dvy = dvx - push * met.nx, dvy - push * met.ny
            other = 0.0 if wall else instant.before[j if k == i else i].speed
            units = IMPULSE_UNITS * self.unit
            granted = units * (before.speed + left.speed + 2 * share * (met.speed if wall else before.speed + other))
            granted += units * (before.fallen + (0.0 if wall else instant.before[j if k == i else i].fallen))
            granted += 2 * share * met.bent + self.least
            found, grazed = length_of(dvx, dvy), granted + 2 * share * met.grazed
            if found - grazed >= size - room:
                size, room = found, grazed
            faint = faint and (closing == 1 or 2 * share * abs(float(met.opening.mid())) <= granted)
        yield Residual("impulse", pair, size, room)
        if faint:  # the two part already, or come together by less than rounding
            yield Residual("phantom", pair, 0.0 if closing == 1 else abs(float(met.opening.mid())), math.inf)

    def faint(self, instant: ReportedInstant, events: int) -> list[tuple[int, float, float]]:
        """The impulses of an instant that are below rounding: place in `impulses`, speed of approach, speed of the two.

        The approach is below 0 of two that part by more than rounding, and that nothing pushes at all.

        The impulses are carried out one after the other, from the engine's own state before; none where that does not
        lead to the velocities that it reports.
        """
        moving: dict[int, tuple[arb, arb]] = {k: (f.vx, f.vy) for k, f in instant.before.items()}
        granted: dict[int, float] = dict.fromkeys(moving, self.least)
        found: list[tuple[int, float, float]] = []
        worn = 0.0  # by what speeds may be off, as impulses before are
        for place, (i, j) in enumerate(instant.impulses):
            met = self.meeting((i, j), instant, events)
            ends = [k for k in (i, j) if k < self.count]
            vx, vy = map(ball.constant, self.drift(j))
            va, vb = moving.get(i, (arb(0), arb(0))), moving.get(j, (vx, vy))
            opening = met.nx * (vb[0] - va[0]) + met.ny * (vb[1] - va[1])
            begun = [(instant.before[k], instant.left(k)) for k in ends if k in instant.before]
            speed = sum(flight.speed + flight.fallen + left for flight, left in begun)
            total = sum((self.things[k].weight for k in ends), arb(0))
            bent = met.bend(math.hypot(float(vb[0] - va[0]), float(vb[1] - va[1])), float(opening.mid()))
            room = 2 * (IMPULSE_UNITS * self.unit * speed + bent) + worn + self.least
            if ball.sign_of(opening) == 1 or 2 * abs(float(opening.mid())) <= room:
                parts = 2 * abs(float(opening.mid())) > room and not any(_changes(instant, k) for k in ends)
                found.append((place, -float(opening.mid()) if parts else max(0.0, -float(opening.mid())), speed))
            for k, sign in ((i, 1), (j, -1)):
                if k in moving and k < self.count and self.moving[k]:
                    granted[k] += 2 * room
                    worn = max(worn, granted[k])
                    if ball.sign_of(opening) != 1:
                        push = sign * self.change * (self.things[k].weight / total) * opening
                        vx, vy = moving[k]
                        moving[k] = vx + push * met.nx, vy + push * met.ny
        for k, (vx, vy) in moving.items():
            left = instant.after.get(k, instant.before[k])
            if length_of(left.vx - vx, left.vy - vy) > granted[k]:
                return []
        return found

    def _several(
        self, pairs: Sequence[tuple[int, int]], instant: ReportedInstant, after: dict[int, ReportedFlight], events: int
    ) -> Iterator[Residual]:
        """Several contacts of one instant: pushes along the lines of centres, as strong as some order makes them.

        The strengths s >= 0 that come nearest to the change are found in doubles, and sharpened to the engine's bits;
        what they leave is enclosed, and what they are beyond `limits_of_pushes`.
        """
        links = [*dict.fromkeys(pairs)]
        met = {link: self.meeting(link, instant, events) for link in links}
        for link in links:
            yield Residual("gap", link, size_of(met[link].gap), met[link].room)
        circles = sorted({k for link in links for k in link if k < self.count and self.moving[k]})
        change = {k: (arb(0), arb(0)) for k in circles}
        for k in after.keys() & change.keys():
            change[k] = after[k].vx - instant.before[k].vx, after[k].vy - instant.before[k].vy
        begun = instant.before
        fastest = max(max(begun[k].speed, after.get(k, begun[k]).speed) + begun[k].fallen for k in circles)
        columns = []
        for link in links:
            column: dict[int, tuple[float, float]] = {}
            for k, sign in zip(link, (-1.0, 1.0), strict=True):
                if k in change:
                    root = math.sqrt(self.things[k].share)
                    column[k] = sign * root * float(met[link].nx.mid()), sign * root * float(met[link].ny.mid())
            columns.append(column)
        wanted: dict[int, tuple[float, float]] = {}
        for k, (x, y) in change.items():
            root = math.sqrt(self.things[k].share)
            wanted[k] = float(x.mid()) / root, float(y.mid()) / root
        normals = {link: (met[link].nx, met[link].ny) for link in links}
        weights = {k: self.things[k].weight for k in change}
        rough = strengths_of(columns, wanted)
        strengths = sharpened(rough, columns, links, normals, change, weights, -math.log2(self.unit))
        bent = max(met[link].bend(2 * fastest, 2 * fastest) for link in links)  # two at rest may be fast a round later
        grazed = max(met[link].grazed for link in links)
        rounds = max(len(pairs), len(links))
        energy, room, worst = arb(0), 0.0, Residual("impulse", links[0], 0.0, math.inf)
        # a wall that moves does work, and none as seen from itself; of two that move apart nothing is known
        frames = {self.drift(j) for _, j in links if j >= self.count or not self.moving[j]}
        (ux, uy), off, most = map(ball.constant, next(iter(frames), (NONE, NONE))), 0.0, 0.0
        for k in circles:
            x, y = left_of(k, weights[k], change[k], links, strengths, normals)
            granted = IMPULSE_UNITS * self.unit * (2 + rounds) * 2 * fastest + 2 * rounds * (bent + grazed) + self.least
            found = Residual("impulse", (k,), length_of(x, y), granted)
            if found.size - found.room > worst.size - worst.room:
                worst = found
            before, left = instant.before[k], after.get(k, instant.before[k])
            mass = 1 / self.things[k].weight
            gained = (left.vx - ux) ** 2 + (left.vy - uy) ** 2 - (before.vx - ux) ** 2 - (before.vy - uy) ** 2
            energy += mass * gained / 2
            room += float(mass) * max(before.speed, left.speed) * granted
            off, most = math.hypot(off, math.sqrt(float(mass)) * granted), max(most, granted)
        times, approaches = [pairs.count(link) for link in links], [-met[link].opening for link in links]
        known = links, times, approaches, strengths, normals, weights, self.change - 1, off
        limits = limits_of_pushes(*known) if self.step is None else None
        if limits is not None:
            over = zip(links, map(size_of, limits.beyond), limits.rooms, strict=True)
            told = [worst, *(Residual("impulse", link, size, loose + 2 * most) for link, size, loose in over)]
            worst = max(told, key=lambda residual: residual.size - residual.room)
            energy, room = (-energy - limits.most).max(limits.least + energy).max(arb(0)), room + limits.room
        yield worst
        lost = limits is None and not self.scene.elastic and not energy > 0  # only a gain is known to be wrong there
        if len(frames) < 2:
            yield Residual("energy", links[0], 0.0 if lost else size_of(energy), room)

    def drift(self, place: int) -> tuple[Quantity, Quantity]:
        """The velocity of a wall, or of an end of a segment that moves, by place; of everything else that stands 0."""
        wall = place - self.count
        if wall < 0:
            return self.scene.circles[place].drift
        exact = self.scene.walls[wall] if wall < len(self.scene.walls) else None
        return (NONE, NONE) if exact is None else (exact.vx, exact.vy)


def _curve(laws: Laws, speed: float, near: float, nx: arb, ny: arb, falls: bool) -> float:
    """See `ImpactLaws.curve`, of two so far from each other, of which only one falls, or none, or both."""
    if laws.step is not None:
        return 0.0
    pull = 0.0 if laws.fall is None or not falls else abs(float((nx * laws.fall.gx + ny * laws.fall.gy).mid()))
    return speed**2 / near + pull


def _changes(instant: ReportedInstant, k: int) -> bool:
    """Whether an instant changes the velocity of a circle at all."""
    before, after = instant.before.get(k), instant.after.get(k)
    return before is not None and after is not None and (before.vx, before.vy) != (after.vx, after.vy)


def _missed(
    laws: Laws, one: tuple[int, ReportedFlight], other: tuple[int, ReportedFlight],
    near: float, wide: float, fast: float, time: float,
) -> float:  # fmt: skip
    """What rounding of the discriminant makes of a gap, over the flights before: 16 u (D^2 / R + R).

    Where these begin so shortly before that such rounding covers it, the two contacts are of one instant, and the
    second may have been found before the first: then over the flights before that.
    """
    rooms, begun = list[float](), max(one[1].time, other[1].time)
    before = [laws.came[k].get(flight.time, (flight.time, 0.0)) for k, flight in (one, other)]
    for since, speed in ((begun, fast), (max(t for t, _ in before), max(fast, *(2 * v for _, v in before)))):
        far = near + speed * max(0.0, time - since)
        rooms.append(ROOT_UNITS * laws.unit * (far * (far / (near + wide)) + wide))
    return rooms[1] if fast * (time - begun) <= rooms[1] else rooms[0]


def _begin(laws: Laws, k: int, flight: ReportedFlight, time: float) -> None:
    """Notes from when on, and how fast, a circle flew that begins another flight; at one instant the first."""
    known = laws.came[k]
    short = abs(time - flight.time) <= CLOSE * abs(time)
    since = known.get(flight.time, (flight.time, flight.speed)) if short else (flight.time, flight.speed)
    laws.came[k] = {**({flight.time: known[flight.time]} if flight.time in known else {}), time: since}


def _falls(laws: Laws, k: int, flight: ReportedFlight) -> bool:
    """Whether a circle falls along a flight under gravity: it is neither fixed nor carried by a wall."""
    return laws.moving[k] and not flight.carried


def _bent_beside(laws: Laws, side: SideInBalls, x: arb, y: arb, near: float, blur: float, radius: float) -> float:
    """As `_bent_at_end`, of an arc: how near the point of it that is met is to its ends."""
    share = side.radius / near
    fx, fy = float(side.x + (x - side.x) * share), float(side.y + (y - side.y) * share)
    blur *= 1.0 + share
    for end in side.ends:
        circle = laws.scene.circles[end]
        if math.hypot(fx - float(circle.x), fy - float(circle.y)) <= blur:
            return min(1.0, blur / (radius or blur))
    return 0.0


def _bent_at_end(laws: Laws, wall: int, line: WallInBalls, x: arb, y: arb, blur: float, radius: float) -> float:
    """By what angle the normal may turn where rounding may make of a face the end beside it; 0 elsewhere."""
    if wall not in laws.scene.faces:
        return 0.0
    foot = float(line.nx * (y - line.y) - line.ny * (x - line.x))
    beside = min(abs(foot), abs(line.length - foot))
    blur += ROOT_UNITS * laws.unit * (line.size + radius)
    return min(1.0, blur / ((radius + line.thick) or blur)) if beside <= blur else 0.0
