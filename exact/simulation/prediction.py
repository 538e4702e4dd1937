"""Predictions of the next meetings, and the queue that keeps them in order: earliest lower bound first."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from heapq import heappop, heappush
from math import inf, nextafter
from typing import Generic, NamedTuple, TypeAlias

from ...scenarios.scene import Scene
from ..compiled import Doubles, predictions
from ..laws.formulas import (
    advance,
    face_along,
    face_foot,
    fall_discriminant,
    fall_speed,
    fall_time,
    fall_time_back,
    pair_approach,
    pair_discriminant,
    pair_gap,
    pair_hit_time,
    sag,
    wall_approach,
    wall_gap,
    wall_hit_time,
)
from ..numbers.system import M, N
from ..replay.contact import AtWall, Body, Entry, Gravity, Link, Pair, Round, Touch, can_push, is_arc, is_flat, is_pair
from ..replay.state import ReplayState
from ..replay.wall_flights import SeenWall, fall_of
from . import cells as crowding
from .arc_meetings import ArcSides, FallenOnArcs
from .cells import FARTHEST, Crossings, Crowd, FloatFlight, NoCrossings, cells_for

# -- The queue of predicted arrivals: earliest lower bound first, stale ones dropped when they come up.


class FloatLine(NamedTuple):
    """A wall as seen from a circle, in doubles: which it is, a point, a normal, r*|n|, the normal's 1-norm, and the
    size of the fixed terms of the gap."""

    wall: int
    x0: float
    y0: float
    nx: float
    ny: float
    offset: float
    norm: float
    size: float


class Arrival(NamedTuple, Generic[N]):
    """A predicted meeting: doubles that enclose its time, and what it rests on.

    Attributes:
        low, high: its time lies between them.
        order: its serial number, which breaks ties among equal bounds.
        certain: whether it comes if nothing else does first; if not, `low` bounds it from below, and `high` is
            infinite.
        time: its time, where that is at hand.
        link: the contact, or the entry of a centre into a pocket.
        serials: the serial numbers of the flights that it was predicted from.
        graze: whether the two touch then without approach.
    """

    low: float
    order: int
    high: float
    certain: bool
    time: N | None
    link: Link
    serials: tuple[int, ...]
    graze: bool = False


class Outlook(NamedTuple, Generic[N]):
    """What one or two circles may meet.

    Attributes:
        others, pegs, lines: for each, circles to look at, those that stand under gravity, walls and then faces.
        reaches: for each, sums of radii by kind of radius.
        pairs: how many pairs of circles that is.
        first_face: the first of the walls that is a face.
    """

    others: list[list[Body[N]]]
    lines: list[Sequence[tuple[float, ...]]]
    reaches: list[list[float]]
    pegs: list[Sequence[tuple[object, ...]]]
    pairs: int
    first_face: int


PlainArrival: TypeAlias = tuple[float, int, float, int, int, int, int]
"""An arrival that is certain and no graze, at another circle or at a wall, whose time is not at hand: its bounds with
its order between them, two circles, the lower index first, or a circle and ~k for wall k, and their serial numbers."""


class ArrivalQueue(Generic[N]):
    """The arrivals of a run.

    Args:
        bodies: the circles, whose serial numbers tell which arrivals are stale.

    Attributes:
        crossings: what comes before an arrival is taken off.
    """

    def __init__(self, bodies: Mapping[int, Body[N]]) -> None:
        self._bodies = bodies
        self._heap: list[PlainArrival | Arrival[N]] = []
        self._order = 0
        self.crossings: Crossings = NoCrossings()

    def push(self, low: float, high: float, time: N | None, link: Link, graze: bool = False) -> None:
        """Queues an arrival that is certain, predicted from the flights as they are."""
        self._push(low, high, True, time, link, graze)

    def push_pairs(self, a: Body[N], found: Iterable[tuple[float, float, Body[N]]], standing: Collection[Link]) -> None:
        """Queues arrivals of a at other circles, as `push` does each: bounds of the time, and the circle."""
        heap, index, serial, until, order = self._heap, a.index, a.serial, a.until, self._order
        for low, high, b in found:
            if low > until or low > b.until:
                continue
            other = b.index
            if standing and ((index, other) in standing or (other, index) in standing):
                continue
            order += 1
            if index < other:
                heappush(heap, (low, order, high, index, other, serial, b.serial))
            else:
                heappush(heap, (low, order, high, other, index, b.serial, serial))
        self._order = order

    def push_walls(self, a: Body[N], found: Sequence[tuple[float, float, int]], standing: Collection[Link]) -> None:
        """Queues arrivals of a at walls, the earliest first, until one of them ends its flight."""
        if len(found) > 1:
            found = sorted(found)
        for low, high, wall in found:
            if low > a.until:
                return
            if not standing or (a.index, wall, "wall") not in standing:  # as an `AtWall`, made in a sixth of the time
                a.until = min(a.until, high)
                self._order += 1
                heappush(self._heap, (low, self._order, high, a.index, ~wall, a.serial, 0))

    def push_all(
        self,
        moved: Sequence[Body[N]],
        outlook: Outlook[N],
        bounds: Doubles,
        slopes: tuple[float, float],
        standing: Collection[Link],
    ) -> bool:
        """Predicts all meetings of one or two circles in doubles, and queues them; False, and nothing done, where that
        is not compiled, or not all is told by doubles.

        Args:
            moved: circles whose flights are new.
            outlook: what they may meet.
            bounds, slopes: see `DoubleFilter`.
            standing: contacts that are not to be predicted.
        """
        if predictions is None:
            return False
        others, lines, reaches, pegs, _, first = outlook
        heap, stand = self._heap, tuple(standing)
        order = predictions.predict(
            moved, others, lines, reaches, pegs, bounds, slopes, stand, heap, self._order, first
        )
        if order is None:
            return False
        self._order = order
        return True

    def push_doubtful(self, low: float, link: Link) -> None:
        """Queues one that may not come, and not before a time."""
        self._push(low, inf, False, None, link, False)

    def _push(self, low: float, high: float, certain: bool, time: N | None, link: Link, graze: bool) -> None:
        """Queues one, unless a wall ends the flight of one of the two before it can come."""
        a = self._bodies[link[0]]
        if low > a.until:
            return
        if is_pair(link):
            b = self._bodies[link.b]
            if low > b.until:
                return
            serials = (a.serial, b.serial)
        else:
            serials = (a.serial,)
            if high < a.until and (link.flat or is_arc(link)) and not graze:  # one that grazes flies on
                a.until = high
        self._order += 1
        heappush(self._heap, Arrival(low, self._order, high, certain, time, link, serials, graze))

    def put_back(self, arrival: Arrival[N]) -> None:
        """Queues an arrival again."""
        heappush(self._heap, arrival)

    def clear(self) -> None:
        """Drops everything."""
        self._heap.clear()

    def fresh(self, arrival: Arrival[N]) -> bool:
        """Whether the flights that an arrival was predicted from still hold."""
        bodies, link, serials = self._bodies, arrival.link, arrival.serials
        if bodies[link[0]].serial != serials[0]:
            return False
        return len(serials) == 1 or bodies[link[1]].serial == serials[1]

    def grazes(self) -> list[Arrival[N]]:
        """Every graze that is queued."""
        return [entry for entry in self._heap if isinstance(entry, Arrival) and entry.graze]

    def alone(self, before: float) -> Touch | None:
        """Takes off the next arrival if it is certain to come, before a time, and nothing else may come with it.

        None where that is not plain at a glance: then all is as it was, or nearer to it.
        """
        heap, bodies, crossings = self._heap, self._bodies, self.crossings
        if predictions is not None:
            crossing = crossings.next_crossing
            found = predictions.first(heap, bodies, before if before < crossing else crossing)
            if found is not None:
                return _link_of(found)
        while heap:
            first = heap[0]
            if isinstance(first, Arrival):
                if not self.fresh(first):
                    heappop(heap)
                    continue
                low, _, high, certain, _, link, _, graze = first
                if graze or not certain or not can_push(link):
                    return None
            else:
                low, _, high, i, j, si, sj = first
                if bodies[i].serial != si or (j >= 0 and bodies[j].serial != sj):
                    heappop(heap)
                    continue
                link = None
            if not high < before:
                return None
            crossing = crossings.next_crossing
            if crossing <= high:
                if crossing >= low and high - low > crossings.early:
                    return None
                crossings.cross()
                if crossings.slides:
                    return None
                continue
            heappop(heap)
            while heap and heap[0][0] <= high:
                if not self._is_stale(heap[0]):
                    heappush(heap, first)
                    return None
                heappop(heap)
            return _link_of(first) if link is None else link
        return None

    def rivals(self) -> list[Arrival[N]]:
        """Takes off every arrival that may be the first; with it come all that may fall on the same instant.

        An arrival is left where it is if its lower bound lies above the least upper bound of those taken, grazes aside:
        what comes first is chosen among the others, and these may all come after a graze.
        """
        heap, crossings = self._heap, self.crossings
        while True:
            while heap and self._is_stale(heap[0]):
                heappop(heap)
            crossing = crossings.next_crossing
            if crossing < inf and (not heap or heap[0][0] > crossing):
                crossings.cross()
                continue
            found = self._rivals()
            if crossing == inf or crossing > _bar(found):
                return found
            since = found[0].low
            if crossing > since and not any(arrival.certain for arrival in found):
                return found
            for arrival in found:
                heappush(heap, arrival)
            crossings.cross(since)

    def _rivals(self) -> list[Arrival[N]]:
        heap = self._heap
        found: list[Arrival[N]] = []
        bar = inf
        while heap and heap[0][0] <= bar:
            other = heappop(heap)
            if not self._is_stale(other):
                arrival = other if isinstance(other, Arrival) else self._as_arrival(other)
                found.append(arrival)
                if not arrival.graze:
                    bar = min(bar, arrival.high)
        return found

    def _is_stale(self, entry: PlainArrival | Arrival[N]) -> bool:
        """Whether an entry rests on a flight that is over."""
        if isinstance(entry, Arrival):
            return not self.fresh(entry)
        bodies, (_, _, _, i, j, si, sj) = self._bodies, entry
        return bodies[i].serial != si or (j >= 0 and bodies[j].serial != sj)

    def _as_arrival(self, entry: PlainArrival) -> Arrival[N]:
        """An entry as others see it."""
        low, order, high, _, j, si, sj = entry
        return Arrival(low, order, high, True, None, _link_of(entry), (si, sj) if j >= 0 else (si,))


def _bar(found: Sequence[Arrival[N]]) -> float:
    """By when one of some arrivals has come that is no graze; where all are grazes, one of them."""
    return min((arrival.high for arrival in found if not arrival.graze), default=min(arrival.high for arrival in found))


def _link_of(entry: PlainArrival) -> Touch:
    """Whose meeting it is."""
    i, j = entry[3], entry[4]
    return _new(Pair, (i, j)) if j >= 0 else _new(AtWall, (i, ~j, "wall"))


_new = tuple.__new__
"""Makes a named tuple of all its fields: what its own constructor does, in a third of the time."""


# -- Predicts the next meetings of circles whose flights are new, in the state's own numbers.

ROUNDED_DOWN = 1 - 2.0**-50
"""Makes a quotient of doubles a lower bound: its rounding, 2**-53, is less."""

SHARP = 2.0**-49
"""Most by which bounds of a number may differ, as a share of it, where a double tells it to a few roundings."""


class Predictor(Generic[M]):
    """Predictions in one number system; what its signs leave open goes to `unsure`.

    Args:
        scene: what runs.
        state: its state.
        queue: where arrivals go.
        plan: counts what is predicted and what is skipped.
        bounds: doubles that enclose a time.
        unsure: deals with a prediction whose signs were not all certain.

    Attributes:
        few: whether there are circles and walls alone, and every pair is looked at; known after the first predictions.
    """

    def __init__(
        self,
        scene: Scene,
        state: ReplayState[M],
        queue: ArrivalQueue[M],
        plan: Counter[str],
        bounds: Callable[[M], tuple[float, float]],
        unsure: Callable[[Link], None],
    ) -> None:
        self.scene, self.state, self.queue, self.plan = scene, state, queue, plan
        plan["pairs at rest skipped"] = 0
        self.bounds, self.unsure = bounds, unsure
        self._count = len(scene.circles)
        self.faces = scene.faces
        self.two_sided = scene.two_sided
        self.arcs: ArcSides[M] | None = None
        if scene.arc_sides:
            self.arcs = ArcSides(scene, state) if scene.gravity is None else FallenOnArcs(scene, state)
        self.wall_count = len(scene.walls) - len(self.faces)
        self.slides: list[AtWall] = []
        self.points = frozenset(i for i, c in enumerate(scene.circles) if c.r.sign() == 0 and i not in scene.ends)
        self._begun = self.few = False
        self._crowd: Crowd[M] | None = None
        self.zero, self.root, self.falling = state.zero, state.root, state.falling

    def close(self) -> None:
        """Lets go of what knows it."""
        del self._crowd, self.unsure, self.queue

    def prepare(self) -> None:
        """Called before predictions in the state's own numbers, and after each that was unsure."""

    def land(self, a: Body[M], link: Round, standing: Collection[Link]) -> None:
        """Queues the next meeting of a circle that falls with something round that stands."""
        raise NotImplementedError

    def reach(self, a: Body[M], b: Body[M]) -> M:
        """The sum of two radii as predictions use it."""
        return self.state.reach(a, b)

    def line(self, body: Body[M], wall: int) -> tuple[M, M, M, M, M]:
        """(x0, y0, nx, ny, r*|n|) of a wall as seen from a body, as predictions use them."""
        line = self.state.line(body.index, wall)
        return line.x0, line.y0, line.nx, line.ny, body.r * line.length

    def predict(self, moved: Sequence[Body[M]], standing: Collection[Link], gone: Collection[int]) -> None:
        """Queues the next meetings of some circles with every other circle, wall and pocket.

        Walls come first: what a flight would meet after a wall, it does not meet (see `ArrivalQueue`).

        Args:
            moved: circles whose flights are new.
            standing: contacts and rims at gap zero that do not approach: nothing to predict until a flight changes.
            gone: circles out of play.
        """
        plan, count = self.plan, self._count
        if gone:
            moved = [a for a in moved if a.index not in gone]
        if not self._begun:
            self._begun = True
            self._gather_crowd()
            self.few = self._crowd is None and not self.state.pockets and (self.falling is None or self.arcs is None)
        if self._crowd is not None:
            self._crowd.predict(moved, standing, gone)
            return
        self._walls_of(moved, standing)
        others = (
            [b for b in self.state.bodies.values() if b.index not in gone] if gone else [*self.state.bodies.values()]
        )
        pockets = self.state.pockets
        predicted = 0
        for done, a in enumerate(moved, start=1):
            others.remove(a)
            met = others
            if a.flight.rest:
                met = [b for b in others if not b.flight.rest]
                plan["pairs at rest skipped"] += len(others) - len(met)
            predicted += count - done - len(others) + len(met)
            self.pairs(a, [*met, *pockets] if pockets and not a.flight.rest else met, standing)
        if moved:
            plan["pairs predicted"] += predicted

    def _gather_crowd(self) -> None:
        """Puts the circles in cells, if they are many."""
        state = self.state
        if self._count < crowding.FEWEST or self.arcs is not None or self.falling is not None:  # see `Cells`
            return
        try:
            radii = [float(circle.r) for circle in self.scene.circles]
        except OverflowError:  # beyond doubles, as no grid is
            return
        flights = [self.in_doubles(body) for body in state.bodies.values()]
        cells = cells_for(flights, radii, self.scene.walls, len(self.scene.ends))
        if cells is not None:
            self._crowd = self.queue.crossings = Crowd(cells, state.bodies, state.pockets, self.plan, self)

    def in_doubles(self, a: Body[M]) -> FloatFlight | None:
        """A flight in doubles; None where they do not tell it to a rounding."""
        numbers: list[float] = []
        for number in a.q:
            low, high = self.bounds(number)
            if not (high - low <= SHARP * abs(low) and abs(low) < FARTHEST):
                return None
            numbers.append(low)
        x, y, vx, vy, t = numbers
        return x, y, vx, vy, t

    def _walls_of(self, moved: Sequence[Body[M]], standing: Collection[Link]) -> None:
        flying, every = 0, range(self.wall_count)
        for a in moved:
            a.until = inf
            free = self.falling is not None and a.index not in self.state.pegs
            if (free or not a.flight.rest) and not self.scene.circles[a.index].fixed:
                flying += 1
                self.walls(a, every, standing)
                if self.faces:
                    self.meet_faces(a, standing)
                if self.arcs is not None:
                    self.arcs.meet(a, standing, self)
        if flying:
            self.plan["walls predicted"] += flying * self.wall_count

    def pairs(self, a: Body[M], others: list[Body[M]], standing: Collection[Link]) -> None:
        """Queues the next meetings of a circle with other circles and with pockets, those of older flights first."""
        last = a.flight.last
        for b in others:
            if b.flight.last <= last:
                self.pair(a, b, standing)
        for b in others:
            if b.flight.last > last:
                self.pair(b, a, standing)

    def walls(self, a: Body[M], walls: Sequence[int], standing: Collection[Link]) -> None:
        """Queues the next hits of a circle with some walls, and faces of segments, which come after them."""
        for k in walls:
            if k < self.wall_count:
                self.wall(a, k, standing)
            else:
                self.face(a, k, standing)

    def meet_faces(self, a: Body[M], standing: Collection[Link]) -> None:
        """Queues the next hits of a circle with all faces of segments."""
        for k in self.faces:
            self.face(a, k, standing)

    def pair(self, a: Body[M], b: Body[M], standing: Collection[Link]) -> None:
        """Queues the next meeting of a, which has a new flight, with the circle or pocket b.

        That they are apart and come nearer is asked at the instant at which the flight begins; the time is reckoned
        from the clock (see `BallState`).
        """
        ax, ay, avx, avy, at = a.q
        bx, by, bvx, bvy, bt = b.q
        if self.falling is not None and self.falling.bent and a.index not in self.state.pegs:
            bx, by, bvx, bvy = self.falling.flown((bx, by, bvx, bvy), at - bt)
            dx, dy, vx, vy = bx - ax, by - ay, bvx - avx, bvy - avy
        elif b.flight.rest:
            dx, dy, vx, vy = bx - ax, by - ay, -avx, -avy
        else:
            if bt is at:
                dx, dy = bx - ax, by - ay
            else:
                lag = at - bt
                dx, dy = advance(bx, bvx, lag) - ax, advance(by, bvy, lag) - ay
            vx, vy = bvx - avx, bvy - avy
        zero, late = self.zero, a.flight.late
        gx, gy = (dx, dy) if late is None else (advance(dx, vx, late), advance(dy, vy, late))
        if pair_approach(gx, gy, vx, vy) >= zero:
            return
        link = link_of(a, b)
        if link in standing or (link.pushes and a.index in self.points and b.index in self.points):
            return
        reach = self.reach(a, b)
        disc = pair_discriminant(dx, dy, vx, vy, reach)
        if disc < zero:
            return
        if disc > zero and pair_approach(gx, gy, vx, vy) < zero and pair_gap(gx, gy, reach) > zero:
            approach = pair_approach(dx, dy, vx, vy)
            self.push(at + pair_hit_time(pair_gap(dx, dy, reach), approach, self.root(disc)), link)
        else:
            self.unsure(link)
            self.prepare()

    def wall(self, a: Body[M], wall: int, standing: Collection[Link]) -> None:
        """Queues the next hit of a, which has a new flight, with a wall."""
        falling = self.state.falls(a.index)
        if falling is not None and ((pull := self.state.sides.pull(a.index, wall)) or wall in self.state.drifts):
            self._fall(falling, a, wall, pull, standing)
            return
        x0, y0, nx, ny, offset = self.line(a, wall)
        ax, ay, avx, avy, at = a.q
        approach = wall_approach(avx, avy, nx, ny)
        if approach >= self.zero:
            return
        link = AtWall(a.index, wall)
        if link in standing:
            return
        gap = wall_gap(ax, ay, x0, y0, nx, ny, offset)
        late = a.flight.late
        still = (
            gap if late is None else wall_gap(advance(ax, avx, late), advance(ay, avy, late), x0, y0, nx, ny, offset)
        )
        if approach < self.zero and still > self.zero:
            self.push(at + wall_hit_time(gap, approach), link)
        else:
            self.unsure(link)
            self.prepare()

    def _fall(self, falling: Gravity[M], a: Body[M], wall: int, pull: int, standing: Collection[Link]) -> None:
        """As `wall`, where gravity pulls towards the wall (negative) or away from it (positive); 0: a wall that moves.

        What stands at gap zero as the flight begins, and does not approach, comes back where it is pulled to; elsewhere
        it never does. What is pulled towards a wall always comes; what is pulled away may miss it, or graze it.
        """
        x0, y0, nx, ny, offset = self.line(a, wall)
        zero, late, link, drift = self.zero, a.flight.late, AtWall(a.index, wall), self.state.drifts.get(wall)
        at, fall = a.q[4], fall_of(falling, a.q, SeenWall(x0, y0, nx, ny, nx, ny), offset, drift, zero)
        gap, approach, half = fall
        still, now = (gap, approach) if late is None else (sag(*fall, late), fall_speed(approach, half, late))
        if link in standing:
            if pull >= 0:
                return
            if now > zero:
                wait = fall_time_back(now, half, now)
                self.push(at + wait if late is None else at + (late + wait), link)
                return
        elif pull >= 0 and now >= zero:
            return
        elif pull == 0:
            if approach < zero and still > zero:
                self.push(at + wall_hit_time(gap, approach), link)
                return
        else:
            disc = fall_discriminant(gap, approach, half)
            if pull > 0 and disc < zero:
                return
            if disc > zero and still > zero and (pull < 0 or now < zero):
                root, early = self.root(disc), approach < zero
                self.push(at + (fall_time(gap, approach, root) if early else fall_time_back(*fall[1:], root)), link)
                return
        self.unsure(link)
        self.prepare()

    def face(self, a: Body[M], wall: int, standing: Collection[Link]) -> None:
        """Queues the next hit of a, which has a new flight, with a face: from its own side, strictly between its ends.

        Where that is not plain, and where a may slide along its line, `unsure` is asked.
        """
        x0, y0, nx, ny, offset = self.line(a, wall)
        ax, ay, avx, avy, at = a.q
        zero, late, approach = self.zero, a.flight.late, wall_approach(avx, avy, nx, ny)
        if approach > zero:
            return
        link = AtWall(a.index, wall)
        if link in standing or (wall in self.two_sided and self._other_side(link) in standing):  # a point is at both
            return
        gap = wall_gap(ax, ay, x0, y0, nx, ny, offset)
        still = (
            gap if late is None else wall_gap(advance(ax, avx, late), advance(ay, avy, late), x0, y0, nx, ny, offset)
        )
        if approach < zero and still > zero:
            along, slide = face_along(ax, ay, x0, y0, nx, ny), face_along(avx, avy, zero, zero, nx, ny)
            foot = face_foot(along, slide, gap, approach)
            beyond = -((nx * nx + ny * ny) * approach) - foot
            if foot < zero or beyond < zero:
                return
            if foot > zero and beyond > zero:
                self.push(at + wall_hit_time(gap, approach), link)
                return
        self.unsure(link)
        self.prepare()

    def _other_side(self, link: AtWall) -> AtWall:
        """The contact of the same circle with the other side of a segment."""
        first = self.two_sided.start
        return AtWall(link.circle, first + ((link.wall - first) ^ 1))

    def push(self, time: M, link: Link, graze: bool = False) -> None:
        """Queues a meeting that is certain to come if nothing else does first; one beyond all numbers never comes."""
        low, high = self.bounds(time)
        if low < inf:
            self.queue.push(low, high, time, link, graze)

    def push_doubtful(self, link: Link) -> None:
        """Queues a meeting that may not come at all, to be settled when its turn comes."""
        low = earliest_possible(self.state, link, self.bounds)
        if self.falling is not None and is_flat(link):  # whose speed changes on the way
            low = self.bounds(link.later(self.state).flight.instant)[0]
        if low < inf:
            self.queue.push_doubtful(low, link)


def link_of(a: Body[M], b: Body[M]) -> Round:
    """The contact of two circles, or the entry of a circle into the pocket b.

    >>> from truebreak.exact.numbers.system import number_system
    >>> from truebreak.scenarios import Circle
    >>> two = ReplayState(Scene([Circle(0, 0), Circle(3, 0)]), number_system("double")).bodies
    >>> link_of(two[1], two[0])
    Pair(a=0, b=1)
    """
    if b.is_pocket:
        return Entry(a.index, b.index)
    return Pair(a.index, b.index) if a.index < b.index else Pair(b.index, a.index)


def earliest_possible(state: ReplayState[M], link: Link, bounds: Callable[[M], tuple[float, float]]) -> float:
    """A double before which a doubtful meeting cannot come: the gap over the greatest closing speed; inf: never."""
    t, gap = link.later(state).flight.instant, link.gap(state)
    if is_flat(link):
        speed = -link.approach(state)
    else:
        _, dx, dy, vx, vy, reach = state.relation(link)
        reach = -reach if link.hollow else reach
        gap = gap / (state.root(dx * dx + dy * dy) + reach)
        speed = state.root(vx * vx + vy * vy)
    least_gap, top_speed = bounds(gap)[0], bounds(speed)[1]
    if top_speed <= 0.0:
        return inf
    if not least_gap > 0.0:
        return -inf
    wait = least_gap / top_speed * ROUNDED_DOWN
    return nextafter(bounds(t)[0] + wait, -inf)
