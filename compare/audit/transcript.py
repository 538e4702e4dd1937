"""A run as its engine reports it, instant by instant: who flew from where, who met whom, and how each was left."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections import Counter, deque
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import zip_longest
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from flint import arb

from ...exact.numbers import ball
from ...exact.replay.contact import places_of
from ...exact.replay.parts import PartsNear
from ...floating.knots import NEXT_TO, DoubleMotion, EventMotion, FallingMotion, SteppedFall
from ...floating.pocket_entries import left_play
from ...scenarios.numbers.quantity import Quantity, real
from ...scenarios.trajectory import StopReason

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Contact, Trajectory

WIDE_STATES = 4_000
"""States of circles that are read off a run of enclosures, a millisecond each; the rest is not audited."""

NEAREST = 2.0**-51
"""A share of sizes by which doubles may be from the numbers to which they are nearest, twice over."""

READ_BITS = 320
"""Bits to which numbers are read that are no doubles."""

TURNED = 2.0**-10
"""By what angle a time step may turn a push."""

SHORT = 2.0**-40
"""A share of its time below which nothing is looked at within a flight."""

ROUNDINGS = 64
"""How many roundings of its coordinates may keep a circle off a face that it is reported to meet."""


ZERO = arb(0)


class ReportedFlight(NamedTuple):
    """Straight flight of one circle as reported, from the time at which it begins.

    Attributes:
        t, x, y, vx, vy: time, place and velocity, enclosed; of a double, exactly.
        time, place, speed: sizes as doubles: of t, of (x, y), of (vx, vy).
        made: how many events the run had when it began.
        fallen: under gravity, a speed of which each rounding of the engine's may take its share; see `Fall.straight`.
        carried: whether a wall carries the circle, by what the engine says: then it does not fall.
        bounces: whether infinitely many bounces on a wall begin with it, of which the engine reports no more.
    """

    t: arb
    x: arb
    y: arb
    vx: arb
    vy: arb
    time: float
    place: float
    speed: float
    made: int
    fallen: float = 0.0
    carried: bool = False
    bounces: bool = False

    def turned(self) -> ReportedFlight:
        """The same with the velocity negated.

        >>> flight_of((0.0, 1.0, 2.0, 3.0, 0.0), 0).turned().vx == -3
        True
        """
        return self._replace(vx=-self.vx, vy=-self.vy)

    def at(self, t: arb) -> tuple[arb, arb]:
        """Where it is at a time."""
        span = t - self.t
        return self.x + self.vx * span, self.y + self.vy * span


class Fall(NamedTuple):
    """The gravity of a run, and how its engine follows it.

    Attributes:
        gx, gy: along x and y.
        size: of both.
        step: of an engine that adds g dt to a velocity at each step, and moves by it before, or after; else 0.
        ahead, early: see `SteppedFall`.
    """

    gx: arb
    gy: arb
    size: float
    step: float = 0.0
    ahead: float = 0.0
    early: float = 1.0

    @property
    def pull(self) -> arb:
        """How strong it is."""
        return (self.gx * self.gx + self.gy * self.gy).sqrt()

    def fallen(self, span: arb) -> tuple[arb, arb]:
        """After a flight: by how many g the place is off the straight way, and by how many the velocity has changed."""
        if not self.step:
            return span * span / 2, span
        dt, steps = arb(self.step), round(float(span) / self.step)
        if abs(float(span) - steps * self.step) > NEXT_TO * self.step:  # not at a step, but for rounding
            steps = math.floor(float(span) / self.step)
        way = dt * dt * steps * (steps - 1) / 2 + (span - steps * dt) * steps * dt
        return (way + self.ahead * dt * span if self.ahead else way), steps * dt

    def place_late(self, span: float) -> float:
        """By how far the place after a flight is off that of a fall, for an engine of steps: half a step in pymunk."""
        return self.size * self.step * span * abs(0.5 - self.ahead)

    def straight(self, flight: ReportedFlight, t: arb, made: int) -> ReportedFlight:
        """The straight flight that comes to the place where a fall is at a time, with the velocity that it has there.

        Whatever is asked of an end of a flight can be asked of this one.

        Args:
            made: how many events the run has by then: an engine may add to a velocity at each, or at each step.

        >>> fall = Fall(arb(0), arb(-2), 2.0)
        >>> told = fall.straight(flight_of((0.0, 0.0, 9.0, 1.0, 0.0), 0), arb(3), 0)
        >>> [float(v) for v in (*told.at(arb(3)), told.vx, told.vy)]
        [3.0, 0.0, 1.0, -6.0]
        """
        span = t - flight.t
        if flight.carried:
            return flight
        if span.is_zero():  # by its clock, of which a last bit may be all of a bounce
            return flight._replace(fallen=self.size * (abs(float(t)) + flight.time))
        way, gain = self.fallen(span)
        vx, vy = flight.vx + self.gx * gain, flight.vy + self.gy * gain
        x, y = flight.x + self.gx * (way - gain * span), flight.y + self.gy * (way - gain * span)
        speed = max(flight.speed, math.hypot(float(vx.mid()), float(vy.mid())))
        added = float(span) / self.step if self.step else float(max(0, made - flight.made))
        fallen = self.size * (abs(float(t)) + flight.time) + (1.0 + added) * speed
        place = max(flight.place, math.hypot(float(x.mid()), float(y.mid())))
        return ReportedFlight(flight.t, x, y, vx, vy, flight.time, place, speed, flight.made, fallen)


Bounced: TypeAlias = "Callable[[int, Sequence[ReportedFlight], float], Sequence[ReportedFlight]]"
"""Of a circle's flights up to a time: the same, and those of infinitely many bounces that nothing reports."""

Row: TypeAlias = "tuple[Any, Any, Any, Any, Any]"
"""t, x, y, vx, vy of one circle, in the engine's numbers."""


def flight_of(row: Row, made: int, carried: bool = False) -> ReportedFlight:
    """A flight from (t, x, y, vx, vy)."""
    if type(row[0]) is float and type(row[1]) is float:
        t, x, y, vx, vy = row
        sizes = abs(t), math.hypot(x, y), math.hypot(vx, vy)
        return ReportedFlight(arb(t), arb(x), arb(y), arb(vx), arb(vy), *sizes, made, 0.0, carried)
    t, x, y, vx, vy = (arb(float(v)) if isinstance(v, float) else real(v).ball(READ_BITS) for v in row)
    near = [float(value.mid()) for value in (t, x, y, vx, vy)]
    sizes = abs(near[0]), math.hypot(*near[1:3]), math.hypot(*near[3:])
    return ReportedFlight(t, x, y, vx, vy, *sizes, made, 0.0, carried)


def _middle(flight: ReportedFlight, following: ReportedFlight | None = None) -> tuple[float, ...]:
    """The middle of a flight's numbers, and the radius of its place and of its velocity; when it ends may be unsure."""
    numbers = flight[:5]
    wide = [float(value.rad()) for value in numbers]
    apart = wide[1] + wide[2] + flight.speed * wide[0] + NEAREST * (flight.place + flight.speed * flight.time)
    if following is not None:
        apart += max(flight.speed, following.speed) * (float(following.t.rad()) + NEAREST * following.time)
    return (*(float(value.mid()) for value in numbers), apart, wide[3] + wide[4] + NEAREST * flight.speed)


class Leg(NamedTuple):
    """One flight of one circle, as doubles: from `start` to `end`.

    Attributes:
        apart, turned: how far place and velocity may be from these, where the engine's numbers are enclosures.
        carried: whether a wall carries it: then the flight is straight under gravity, too.
    """

    circle: int
    start: float
    end: float
    t: float
    x: float
    y: float
    vx: float
    vy: float
    apart: float = 0.0
    turned: float = 0.0
    carried: bool = False

    @property
    def speed(self) -> float:
        """Of the circle."""
        return math.hypot(self.vx, self.vy)

    def seen_from(self, ux: float, uy: float) -> Leg:
        """As seen from what moves with a velocity, and is where it is as the flight begins."""
        late, x, y = self.t - self.start, abs(self.x), abs(self.y)
        turned = self.turned + 2.0**-52 * (abs(self.vx) + abs(ux) + abs(self.vy) + abs(uy))  # its own rounding
        apart = self.apart + 2.0**-52 * (x + y + (abs(ux) + abs(uy)) * abs(late))
        x, y, vx, vy = self.x - ux * late, self.y - uy * late, self.vx - ux, self.vy - uy
        return self._replace(x=x, y=y, vx=vx, vy=vy, apart=apart, turned=turned)


def legs_of(k: int, row: Sequence[Sequence[float]], end: float, carried: Collection[int]) -> Iterator[Leg]:
    """The flights of a circle's row, up to an end."""
    for n, knot in enumerate(row):
        until = min(end, row[n + 1][0]) if n + 1 < len(row) else end
        if until > knot[0] or (n + 1 == len(row) and until == knot[0]):
            t, x, y, vx, vy, *more = knot
            apart, turned = more or (0.0, 0.0)
            yield Leg(k, t, until, t, x, y, vx, vy, apart, turned, n in carried)


class WallInBalls(NamedTuple):
    """A wall: a point of it, its unit normal; how far its points are from the origin and from each other.

    Of a face, `thick` is half the thickness of its segment. One that moves has the velocity (ux, uy), of size `drift`.
    """

    x: arb
    y: arb
    nx: arb
    ny: arb
    size: float
    length: float
    thick: float = 0.0
    ux: arb = ZERO
    uy: arb = ZERO
    drift: float = 0.0

    def at(self, time: arb) -> WallInBalls:
        """Where it is at a time, of one that has been told where it is at time 0."""
        if not self.drift:
            return self
        size = self.size + self.drift * abs(float(time.mid()))
        return self._replace(x=self.x + self.ux * time, y=self.y + self.uy * time, size=size)

    def seen(self, leg: Leg) -> tuple[Leg, WallInBalls]:
        """A flight as seen from it, and itself, which so stands where it is as the flight begins."""
        if not self.drift:
            return leg, self
        still = self.at(arb(leg.start))._replace(ux=ZERO, uy=ZERO, drift=0.0)
        return leg.seen_from(float(self.ux), float(self.uy)), still

    def nears(self, vx: arb | float, vy: arb | float) -> arb:
        """How fast something of a velocity comes nearer to it."""
        return self.nx * (vx - self.ux) + self.ny * (vy - self.uy)


@dataclass
class ReportedInstant:
    """All that a run reports of one moment.

    Attributes:
        events: its events, by index; none where a velocity changes without one.
        time: the moment, as a double.
        t: the same, enclosed.
        impulses: pairs of places in `scene.ids`, in the order reported.
        before, after: the flight that ends, and the one that begins, of each circle that has a new one. Under gravity
            the former is the straight one that ends there as the fall does (`Fall.straight`).
        turned: whether every velocity is negated here. What is hit at the very moment of a reversal is hit before it,
            after it, or both: of that only the energy is known.
    """

    events: tuple[int, ...]
    time: float
    t: arb
    impulses: tuple[tuple[int, int], ...]
    before: dict[int, ReportedFlight] = field(default_factory=dict[int, ReportedFlight])
    after: dict[int, ReportedFlight] = field(default_factory=dict[int, ReportedFlight])
    turned: bool = False

    @property
    def rested(self) -> list[int]:
        """The circles of which infinitely many bounces on a wall have come to an end here."""
        return [k for k, flight in self.before.items() if flight.bounces and k in self.after and self.after[k].carried]

    def circles(self, count: int) -> set[int]:
        """The circles that meet something, by place; there are `count` circles."""
        return {k for pair in self.impulses for k in pair if k < count}

    def there(self, k: int) -> tuple[ReportedFlight, arb, arb]:
        """A circle's flight before it, and its place at it: as reported, or flown to where nothing is."""
        flight, told = self.before[k], self.after.get(k)
        if told is not None:
            return flight, told.x, told.y
        span = self.t - flight.t
        return flight, flight.x + flight.vx * span, flight.y + flight.vy * span

    def left(self, k: int) -> float:
        """How fast a circle goes on."""
        return self.after.get(k, self.before[k]).speed


def groups_of(pairs: Sequence[tuple[int, int]], moving: Sequence[bool], count: int) -> list[list[tuple[int, int]]]:
    """Impulses of one instant, those that hang together through circles that can move; in the order reported.

    >>> groups_of([(0, 1), (2, 5), (1, 3)], [True] * 4, 4)
    [[(2, 5)], [(0, 1), (1, 3)]]
    """
    if len(pairs) == 1:
        return [[pairs[0]]]
    found: list[tuple[set[int], list[tuple[int, int]]]] = []
    for pair in pairs:
        names = {k for k in pair if k < count and moving[k]}
        joined = [group for group in found if group[0] & names]
        fresh = (names.union(*(group[0] for group in joined)), [p for group in joined for p in group[1]] + [pair])
        found = [group for group in found if group not in joined] + [fresh]
    return [group[1] for group in found]


class Transcript:
    """A run, to be read once from its start to its end.

    Args:
        run: what an engine handed back.
        encloses: whether numbers other than doubles are to be read as enclosures.
        unit: of the engine's numbers.
        step: its time step, if it has one. Both say how far away a part of a thing may be that has pushed.

    Attributes:
        scene: of the run, as engines see it (`Scene.surfaces`), in whose places circles and what they meet are told.
        states: whether the engine reports where circles are, for every event; without, places were computed from times.
        wide: whether its states are read as enclosures; otherwise they are doubles, whatever it computes in.
        gone: when circles leave play, by place.
        fall: the gravity of the run; None without.
        carries: whether a wall carries a circle, by its place, from a time on; None where the motion does not say.
        carried: by circle, the places in its row of `flights` of those along which a wall carries it; known after that.
        end: up to when flights are known, once all of it is read; infinite where nothing is left to happen.

    >>> from truebreak.scenarios import Circle, Scene
    >>> from truebreak.floating import DoubleEngine
    >>> run = DoubleEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 0)]), until=5)
    >>> [(instant.events, instant.impulses, sorted(instant.after)) for instant in Transcript(run).instants()]
    [((0,), ((0, 1),), [0, 1])]
    """

    def __init__(
        self, run: Trajectory, encloses: bool = False, unit: float = NEAREST, step: float | None = None
    ) -> None:
        self.run, self._loose, self._step = run, ROUNDINGS * unit, step
        self.scene: Scene = run.scene.surfaces
        motion = run.motion
        self._motion = motion
        self.states = not getattr(motion, "reckoned", ())
        wide = not isinstance(motion, DoubleMotion) and encloses
        self.wide = wide and not all(isinstance(v, float) for v in next(iter(motion.state(0.0)), (0.0,)))
        self._count = len(run.scene.circles)
        self._places: Mapping[str, int] = {name: k for k, name in enumerate(run.scene.ids)}
        self._moving = [not circle.fixed for circle in self.scene.circles]
        left = left_play(run, step is not None, self._loose)
        self.gone: dict[int, float] = {self._places[name]: time for name, time in left.items()}
        self._flown: list[list[ReportedFlight]] | None = None
        told = not run.scene.settle or isinstance(motion, FallingMotion)
        self.carries: Callable[[int, Any], bool] | None = (
            (lambda *_: False) if told else getattr(motion, "carries", None)
        )
        self.fall: Fall | None = None
        if run.scene.gravity is not None:
            gx, gy = (ball.constant(part) for part in run.scene.gravity)
            size = math.hypot(*map(float, run.scene.gravity))
            by_steps = (motion.dt, motion.ahead, motion.early) if isinstance(motion, SteppedFall) else ()
            self.fall = Fall(gx, gy, size, *by_steps)
        self.end = math.inf if run.stop.reason is StopReason.QUIET else float(run.final_time)
        self.carried: Mapping[int, Collection[int]] = {}
        self._carried: Mapping[int, Collection[int]] = {}
        ends: Mapping[tuple[int, int], tuple[Any, Any]] = getattr(motion, "ends", {})
        self._ends = {(k, float(since)): time for (k, _), (since, time) in ends.items()}
        self._late = {*ends}
        self._open: dict[int, Any] = {}
        if isinstance(motion, FallingMotion):
            self._carried = {
                k: {n for n in row if motion.knots[k][n][0] < self.gone.get(k, math.inf)}
                for k, row in motion.carried.items()
            }

    def first(self) -> list[ReportedFlight]:
        """The flight with which each circle begins; the ends of segments, which never move, come last."""
        return [*self._first(), *(_end_of(self.scene, k) for k in self.scene.ends)]

    def _first(self) -> list[ReportedFlight]:
        if isinstance(self._motion, DoubleMotion):
            return [flight_of(row[0][:5], 0, 0 in self._carried.get(k, ())) for k, row in enumerate(self._motion.knots)]
        happened = [float(event.time) for event in (*self.run.events[:1], *self.run.pocketings)]
        if 0.0 in happened:  # a state at 0 is the one that it leaves
            rows = [(c.x, c.y, c.vx, c.vy) for c in self.run.scene.circles]
            return [self._flight((0.0, *row), 0) for row in rows]
        return [self._flight((0.0, *row), 0, k, 0.0) for k, row in enumerate(self._motion.state(0.0))]

    def instants(self) -> Iterator[ReportedInstant]:
        """Every instant, in the order of time."""
        told = self._told()
        if self.fall is not None:
            told = self._straightened(told, self.fall)
        return told if self.scene is self.run.scene else map(self._by_parts, told)

    def _told(self) -> Iterator[ReportedInstant]:
        motion, self._open = self._motion, {}
        return self._from_flights(motion) if isinstance(motion, DoubleMotion) else self._from_rows()

    def _straightened(self, told: Iterator[ReportedInstant], fall: Fall) -> Iterator[ReportedInstant]:
        """The same with flights that end as they do under gravity."""
        made = 0
        for instant in told:
            made += len(instant.events)
            rested = instant.rested
            ended = {
                k: fall.straight(flight, instant.after[k].t if k in instant.after else instant.t, made)
                if k < self._count and self._moving[k] and k not in rested
                else flight
                for k, flight in instant.before.items()
            }
            yield replace(instant, before=ended)

    def _by_parts(self, instant: ReportedInstant) -> ReportedInstant:
        """The same with the faces and ends that circles meet at their own places, for the things that have them."""
        first, more = self._count + len(self.run.scene.walls), len(self.scene.ends)
        parts = {
            pair: self._pushing(*pair, times, instant)
            for pair, times in Counter(instant.impulses).items()
            if pair[1] >= first
        }
        links = [
            parts[i, j].pop(0) if j >= first else (i, j + more if j >= self._count else j) for i, j in instant.impulses
        ]
        links += [link for others in parts.values() for link in others]
        for _, j in links:
            if j in self.scene.ends:
                instant.before[j] = _end_of(self.scene, j)
        return replace(instant, impulses=tuple(links))

    def _pushing(self, i: int, j: int, times: int, instant: ReportedInstant) -> list[tuple[int, int]]:
        """The parts of a thing that push a circle at an instant, by place, for so many contacts that are reported."""
        flight, told = instant.before[i], instant.after.get(i)
        x, y = (told.x, told.y) if told is not None else flight.at(instant.t)
        push = (arb(0), arb(0)) if told is None else (told.vx - flight.vx, told.vy - flight.vy)
        room = self._loose * (flight.place + flight.speed * flight.time)
        room += 0.0 if self._step is None else flight.speed * self._step
        turn = self._loose if self._step is None else TURNED
        with ball.precision(READ_BITS):
            vx, vy = flight.vx, flight.vy
            for face in self._parts.things[j].faces[:1]:
                thing, time = self.scene.walls[face], instant.t if told is None else told.t
                if thing.moves:  # as seen from it
                    ux, uy = (value.ball(READ_BITS) for value in (thing.vx, thing.vy))
                    x, y, vx, vy = x - ux * time, y - uy * time, vx - ux, vy - uy
            blur = self._loose + NEAREST if self._step is None else 0.0
            blur *= flight.speed + instant.left(i)
            links = self._parts.pushing(i, j, x, y, vx, vy, push, times, room, turn, blur)
        return [places_of(self.scene, link) for link in links]

    @cached_property
    def _parts(self) -> PartsNear[arb]:
        with ball.precision(READ_BITS):
            return PartsNear(self.run.scene, ball.BALLS)

    def flights(self, bounced: Bounced | None = None) -> Sequence[Sequence[Sequence[float]]]:
        """For each circle (t, x, y, vx, vy) of its flights as doubles, by ascending time.

        Of enclosures they are the middles, followed by how far place and velocity may be from them.

        Args:
            bounced: fills in the infinitely many bounces of which only the first is reported.
        """
        fixed = [[_middle(_end_of(self.scene, k))] for k in self.scene.ends]
        if isinstance(self._motion, DoubleMotion) and not self._ends:
            self.carried = self._carried
            return [*self._motion.knots, *fixed] if fixed else self._motion.knots
        if self._flown is None:
            deque(self._told(), maxlen=0)
        flown = self._flown or []
        if self._ends and bounced is not None:
            flown = [bounced(k, row, min(self.end, self.gone.get(k, math.inf))) for k, row in enumerate(flown)]
        self.carried = {k: {n for n, flight in enumerate(row) if flight.carried} for k, row in enumerate(flown)}
        return [*([_middle(*pair) for pair in zip_longest(row, row[1:])] for row in flown), *fixed]

    # -- from the flights that a motion keeps

    def _from_flights(self, motion: DoubleMotion) -> Iterator[ReportedInstant]:
        knots = motion.knots
        flown = [[flight] for flight in self._first()]
        end = float(self.run.final_time)  # a record may know more than was asked for
        new = sorted(
            (row[n][0], k, n)
            for k, row in enumerate(knots)
            for n in range(1, len(row))
            if row[n][0] <= end and (k, n) not in self._late
        )
        events = self.run.events
        times = [float(event.time) for event in events]
        order = sorted(range(len(times)), key=times.__getitem__)
        turn = None if self.run.reversal is None else float(self.run.reversal.time)
        left = motion.left if isinstance(motion, EventMotion) else ()
        e = n = 0
        while e < len(order) or n < len(new):
            now = min(times[order[e]] if e < len(order) else math.inf, new[n][0] if n < len(new) else math.inf)
            mine, changed = [], dict[int, list[int]]()
            while e < len(order) and times[order[e]] == now:
                mine.append(order[e])
                e += 1
            while n < len(new) and new[n][0] == now:
                changed.setdefault(new[n][1], []).append(new[n][2])
                n += 1
            turned = turn is not None and now == turn
            yield from self._bounced(now, flown, e)
            for instant in self._split(now, mine, changed, left, turned):
                for k, place in instant[1].items():
                    instant[0].before[k] = flown[k][-1]
                    found = flight_of(knots[k][place][:5], e, place in self._carried.get(k, ()))
                    found = self._begun(k, found, self._ends[k, now] if (k, place + 1) in self._late else None)
                    flown[k][len(flown[k]) - (not self._ends) :] = [found]
                    instant[0].after[k] = found
                for k in instant[0].circles(self._count):
                    if k not in instant[0].before:
                        instant[0].before[k] = flown[k][-1]
                yield instant[0]
        yield from self._bounced(end, flown, e)
        self._flown = flown

    # -- infinitely many bounces, of which only the first is reported

    def _begun(self, k: int, flight: ReportedFlight, end: Any) -> ReportedFlight:
        """The flight with which a circle goes on, perhaps into such bounces, up to a time."""
        self._open.pop(k, None)
        if end is None:
            return flight
        span = float(end) - flight.time
        lag = span * (1.0 - float(self.scene.restitution)) / 2
        highest = [Quantity.of(flight.time + lag)] if lag > SHORT * flight.time else []
        self._open[k] = [*highest, end]
        return flight._replace(carried=False, bounces=True)

    def _bounced(self, now: float, flown: list[list[ReportedFlight]], made: int) -> Iterator[ReportedInstant]:
        """What is told of them up to a time: where the circle is half-way to the next one, and how they leave it."""
        for when, k in sorted((float(t), k) for k, times in self._open.items() for t in times if float(t) <= now):
            time = self._open[k].pop(0)
            rest = not self._open[k]
            row: tuple[Any, ...] = self._motion.state(time)[k]
            after = flight_of((time, *row) if self.wide else (when, *map(float, row)), made, rest)  # pyright: ignore
            yield ReportedInstant((), when, self._number(time), (), {k: flown[k][-1]}, {k: after})
            if rest:
                del self._open[k]
                flown[k].append(after)

    def _split(
        self,
        now: float,
        events: Sequence[int],
        changed: Mapping[int, Sequence[int]],
        left: Sequence[tuple[float, Sequence[int]]],
        turned: bool,
    ) -> Iterator[tuple[ReportedInstant, dict[int, int]]]:
        """What falls on one double, taken apart into its events, as far as the motion says which flight is of which."""
        t, remaining = arb(now), {k: list(rows) for k, rows in changed.items()}
        if turned:
            left_by = {k: rows[-1] for k, rows in remaining.items()}
            links = tuple(link for index in events for link in self._links(index))
            yield ReportedInstant(tuple(events), now, t, links, turned=True), left_by
            return
        if len(events) > 1 and self._apart(events, remaining, left):
            for index in events:
                mine = {k: _due(remaining[k], index, k, left) for k in self._circles(index) if remaining.get(k)}
                yield (
                    ReportedInstant((index,), now, t, self._links(index)),
                    {k: n for k, n in mine.items() if n is not None},
                )
            rest = {k: rows[-1] for k, rows in remaining.items() if rows}
            if rest:
                yield ReportedInstant((), now, t, ()), rest
        elif events or any(remaining.values()):
            links = tuple(link for index in events for link in self._links(index))
            yield ReportedInstant(tuple(events), now, t, links), {k: rows[-1] for k, rows in remaining.items() if rows}

    def _apart(
        self, events: Sequence[int], changed: Mapping[int, Sequence[int]], left: Sequence[tuple[float, Sequence[int]]]
    ) -> bool:
        """Whether it is known which event each flight of one time is of."""
        if left:
            return max(events) < len(left)
        hits: dict[int, int] = {}
        for index in events:
            for k in self._circles(index):
                hits[k] = hits.get(k, 0) + 1
        return all(len(changed.get(k, ())) in (0, number) for k, number in hits.items())

    # -- from states read at every event

    def _from_rows(self) -> Iterator[ReportedInstant]:
        """By the state after every event: of circles that are in it, or whose velocity is no longer the same."""
        run, after = self.run, getattr(self._motion, "after", None)
        flown = [[flight] for flight in self._first()]
        turn = None if run.reversal is None else float(run.reversal.time)
        before = len(run.events) if run.reversal is None else run.reversal.after
        at_once = [event.index for event in run.events[:before] if float(event.time) == turn]
        for index, event in enumerate(run.events):
            if self.wide and index * self._count > WIDE_STATES:
                self.end = float(run.events[index - 1].time)
                break
            mine, now = (index,), float(event.time)
            yield from self._bounced(now, flown, index)
            if turn is not None and now >= turn:
                if now > turn or index not in at_once:
                    yield self._read((), run.reversal and run.reversal.time, turn, index, flown, None)
                    turn = None
                else:
                    mine = tuple(at_once)
            if index not in at_once or index == at_once[-1]:
                yield self._read(mine, event.time, turn, index + 1, flown, after)
            turn = None if now == turn and index == at_once[-1] else turn
        else:
            if run.reversal is not None and turn is not None:
                yield self._read((), run.reversal.time, turn, len(run.events), flown, None)
            yield from self._bounced(float(run.final_time), flown, len(run.events))
        self._flown = flown

    def _read(
        self,
        events: tuple[int, ...],
        time: Any,
        turn: float | None,
        made: int,
        flown: list[list[ReportedFlight]],
        after: Any,
    ) -> ReportedInstant:
        """An instant by the state that it leaves."""
        now, run = float(time), self.run
        turned = turn is not None and now == turn and run.reversal is not None
        links = tuple(link for index in events for link in self._links(index))
        if turned and run.reversal is not None:
            time, after = run.reversal.time, None
        rows = list(self._motion.state(time) if after is None else after(events[-1]))
        instant = ReportedInstant(events, now, self._number(time), links, turned=turned)
        hit = instant.circles(self._count)
        for k, row in enumerate(rows):
            if k in self._open and k not in hit:
                continue
            found = self._begun(
                k, self._flight((time, *row), made, k, time), self._ends.get((k, now)) if k in hit else None
            )
            last = flown[k][-1]
            known = last if self.fall is None else self.fall.straight(last, found.t, made)
            same = found.vx.overlaps(known.vx) and found.vy.overlaps(known.vy) and found.carried == known.carried
            if k in hit or turned or (self._moving[k] and not same):
                instant.before[k], instant.after[k] = last, found
                flown[k].append(found)
        return instant

    def _flight(self, row: Row, made: int, k: int = 0, since: Any = None) -> ReportedFlight:
        """A flight from a state; of exact numbers, from the doubles that are nearest to them."""
        carried = since is not None and self.carries is not None and self.carries(k, since)
        return flight_of(row if self.wide else (*map(float, row),), made, carried)  # pyright: ignore[reportArgumentType]

    def _number(self, value: Any) -> arb:
        return real(value).ball(READ_BITS) if self.wide else arb(float(value))

    # -- contacts by place

    def _circles(self, index: int) -> list[int]:
        """The circles of an event that can move, by place."""
        found = {k for link in self._links(index) for k in link}
        return [k for k in sorted(found) if k < self._count and self._moving[k]]

    def _links(self, index: int) -> tuple[tuple[int, int], ...]:
        """The impulses of an event, by place."""
        impulses: Sequence[Contact] = self.run.events[index].impulses
        return tuple((self._places[a], self._places[b]) for a, b in impulses)


def _due(rows: list[int], index: int, place: int, left: Sequence[tuple[float, Sequence[int]]]) -> int | None:
    """The flight of a circle, out of those of one time, with which an event leaves it."""
    if not left:
        return rows.pop(0)
    upto = bisect_left(rows, left[index][1][place])
    if not upto:
        return None
    found = rows[upto - 1]
    del rows[:upto]
    return found


def _end_of(scene: Scene, k: int) -> ReportedFlight:
    """An end of a segment, which stands, or flies straight with it."""
    end = scene.circles[k]
    x, y, vx, vy = (value.ball(READ_BITS) for value in (end.x, end.y, *end.drift))
    place, speed = math.hypot(float(end.x), float(end.y)), math.hypot(*map(float, end.drift))
    return ReportedFlight(arb(0), x, y, vx, vy, 0.0, place, speed, 0)
