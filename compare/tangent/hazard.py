"""How near errors of an engine come to turning the decisions of a run over."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from enum import Enum
from math import copysign, hypot, inf, log2
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from flint import arb

from ...exact.exact_motion import motion_of, steps_through
from ...exact.laws.formulas import (
    pair_approach,
    pair_discriminant,
    pair_gap,
    pair_hit_time,
    pair_impulse,
    wall_approach,
    wall_bounce,
    wall_gap,
)
from ...exact.numbers import ball
from ...exact.replay.round_falls import RoundFall
from ...exact.replay.state import ReplayState
from ...exact.replay.wall_flights import SeenWall
from ...floating.plain import PlainState
from ...scenarios.lazy import Later
from ...scenarios.surfaces import ThingParts, parts_of
from .flight_aside import Passing, RoundSide, falls_onto, falls_past, falls_to_walls, out_of, stretches
from .growth import Displacements
from .impacts import LEAST_BITS, Impact, as_doubles, moving

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    import numpy as np
    from numpy.typing import NDArray

    from ...scenarios.engine import Engine
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory
else:
    np = Later("numpy")

WALL = -1
"""In place of the index of a circle."""

BEFORE = 2.0**-20
"""A share of the coordinates: so far before its contact with an arc a circle is on the side from which it comes."""


class Others(NamedTuple):
    """What a circle would meet next.

    Attributes:
        places: circles by index, or `WALL`.
        waits: how long until then.
        rates: how fast they then approach.
        normals: shape (others, 2): unit vectors from the circle to each, as they then meet.
    """

    places: NDArray[np.intp]
    waits: NDArray[np.float64]
    rates: NDArray[np.float64]
    normals: NDArray[np.float64]


Surroundings = dict[tuple[int, int], Others]
"""By event and circle."""


class Course:
    """The states of all circles along a run's impacts, in doubles, in the places of `Scene.surfaces`.

    Attributes:
        places, speeds: shape (circles, 2), at `time`; the middles of the sides of arcs come last.
        pulls: shape (circles, 2), what gravity changes these by in a unit of time.
        share: of an elastic impulse, what the scene's restitution leaves: (1 + e) / 2.
        time: where they stand.

    Args:
        scene: what ran.
        known: what circles would have met instead, by event and circle, as other courses along the same impacts found
            it; what this one finds is added.
    """

    def __init__(self, scene: Scene, known: Surroundings | None = None) -> None:
        parts = parts_of(scene)
        scene = scene.surfaces
        circles, sides = scene.circles, scene.arc_sides
        self._count, self._sides = len(circles), sides
        paces = [(c.vx + c.drift[0], c.vy + c.drift[1]) for c in circles]  # of an end: that of what it ends
        here = [(float(c.x), float(c.y), *map(float, pace)) for c, pace in zip(circles, paces, strict=True)]
        here += [(float(side.x), float(side.y), 0.0, 0.0) for side in sides]
        state: NDArray[np.float64] = np.array(here)
        self.places, self.speeds = state[:, :2].copy(), state[:, 2:].copy()
        self.time = 0.0
        self._event = -1
        self._known: Surroundings = {} if known is None else known
        self._radii = np.array([float(c.r) for c in circles])
        self._walls: NDArray[np.float64] = np.zeros((len(scene.walls), 4))
        self._is_face = np.array([wall.is_face for wall in scene.walls], dtype=bool)
        self.share = float((scene.restitution + 1) / 2)
        self._pegs = sorted(scene.pegs)
        self.pulls = np.zeros((len(here), 2))
        if scene.gravity is not None:
            self.pulls[[not circle.fixed for circle in circles] + [False] * len(sides)] = [*map(float, scene.gravity)]
        self._length = np.array([hypot(*map(float, wall.normal)) for wall in scene.walls])
        self._of: dict[tuple[bool, int], list[ThingParts]] = {}
        for thing in parts.values():
            places = (*thing.ends, *(self._count + side for side in thing.sides))
            for key in (*((True, wall) for wall in thing.faces), *((False, place) for place in places)):
                self._of.setdefault(key, []).append(thing)
        self._arcs = [thing for thing in parts.values() if thing.sides]
        for k, wall in enumerate(scene.walls):
            normal = np.array([float(part) for part in wall.normal])
            self._walls[k] = [float(wall.x0), float(wall.y0), *(normal / np.hypot(*normal))]
        self._paces = np.array([(float(wall.vx), float(wall.vy)) for wall in scene.walls]).reshape(-1, 2)

    def fly(self, time: float) -> None:
        """Goes on to the time of the next event, in flight."""
        self._event += 1
        wait = time - self.time
        self.places += wait * self.speeds
        self.places += wait * wait / 2 * self.pulls
        self.speeds += wait * self.pulls
        self._walls[:, :2] += wait * self._paces
        self.time = time

    def push(self, impact: Impact) -> list[tuple[int, NDArray[np.float64]]]:
        """Carries an impact out: each circle that takes part, and the change of its velocity."""
        a, b, dx, dy, vx, vy, reach, wa, wb = as_doubles(impact)
        if b is None:
            came = np.array((vx, vy)) if self._paces.any() else self.speeds[a]  # relative to a wall that moves
            after = np.array(wall_bounce(came[0], came[1], dx, dy, reach * reach))
            changes = [(a, self.share * (after - came))]
        else:
            impulse = self.share * np.array(pair_impulse(dx, dy, vx, vy, reach, wa, wb))
            changes = [(a, -wa * impulse), (b, wb * impulse)]
        for i, change in changes:
            self.speeds[i] += change
        return changes

    def margins(self, event: Sequence[Impact], impact: Impact, i: int) -> NDArray[np.float64]:
        """How far circle i, which takes part in an impact, may be displaced before its next meeting is another one.

        One number for each that it would meet next, were it not for the impact: an error changes the times of both
        meetings, each by the error's part along the approach over the speed of approach; taken as if both parts were as
        long as the margin, and of opposite effect. And one, for two circles, or a thing with ends, for how far they are
        from missing each other.
        """
        _, b, dx, dy, vx, vy, reach, *_ = as_doubles(impact)
        closing = abs(pair_approach(dx, dy, vx, vy)) / reach
        others = self.instead(event, i)
        orders = others.waits * (closing * others.rates / (closing + others.rates))
        thing = self.passing(impact)
        if thing is not None:
            return np.append(orders, thing.depth)
        if b is None:
            return orders
        return np.append(orders, max(reach - self.nearest(impact)[1], 0.0))

    def instead(self, event: Sequence[Impact], i: int) -> Others:
        """What circle i, which takes part in an event, would meet were it not for that.

        Where several contacts of one circle at one instant have a tangent map, their order decides nothing.
        """
        if (found := self._known.get((self._event, i))) is not None:
            return found
        met = [impact for impact in event if i in (impact.a, impact.b)]
        partners = [impact.b if i == impact.a else impact.a for impact in met if impact.b is not None]
        things = [thing for impact in met for thing in self._things_of(impact)]
        at = {impact.wall for impact in met if impact.wall is not None}
        # which part of a convex thing it is changes no history; of another one a face of a corner comes after the other
        at |= {wall for thing in things if thing.convex for wall in thing.faces}
        unknown = sum(impact.b is None and impact.wall is None for impact in met)
        circles = self._circles(i, [*partners, *(end for thing in things for end in thing.ends)])
        walls = self._walls_of(i, sorted(at), unknown)
        arcs = self._sides_of(i, {side for thing in things for side in thing.sides}) if self._sides else []
        found = Others(*map(np.concatenate, zip(circles, walls, *arcs, strict=True)))
        self._known[self._event, i] = found
        return found

    def _circles(self, i: int, partners: Sequence[int]) -> Others:
        """The circles in its way, but for its partners."""
        here, speeds, n = self.places[: self._count], self.speeds[: self._count], self._count
        (dx, dy), (vx, vy) = (here - here[i]).T, (speeds - speeds[i]).T
        reach = self._radii + self._radii[i]
        approach, room = pair_approach(dx, dy, vx, vy), pair_discriminant(dx, dy, vx, vy, reach)
        meets = (approach < 0) & (room > 0)
        falls = bool(self.pulls[i].any())
        meets[[i, *(k for k in partners if k < n), *(self._pegs if falls else ())]] = False
        dx, dy, reach, root = dx[meets], dy[meets], reach[meets], np.sqrt(room[meets])
        waits = pair_hit_time(np.maximum(pair_gap(dx, dy, reach), 0.0), approach[meets], root)
        normals = np.array((dx + waits * vx[meets], dy + waits * vy[meets])).T / reach[:, None]
        found = Others(np.flatnonzero(meets), waits, root / reach, normals)
        pegs = self._falls_onto(i, [k for k in self._pegs if k not in partners]) if falls else []
        return Others(*map(np.concatenate, zip(found, *pegs, strict=True))) if pegs else found

    def _fall(self, i: int, k: int) -> RoundFall[float]:
        """A circle that falls, and one that stands."""
        (x, y), (vx, vy) = self.places[k] - self.places[i], self.speeds[k] - self.speeds[i]
        gx, gy = self.pulls[i] / 2
        reach = self._radii[i] + self._radii[k]
        return RoundFall(*map(float, (x, y, vx, vy, gx, gy, reach)))

    def _falls_onto(self, i: int, pegs: Iterable[int]) -> list[Others]:
        """Those of some circles that stand onto which one falls."""
        found: list[Others] = []
        for k in pegs:
            if (met := falls_onto(self._fall(i, k))) is not None and met[1].approach() < 0.0:
                wait, then = met
                normal = np.array([then.dx, then.dy]) / hypot(then.dx, then.dy)
                rate = -float(normal @ [then.vx, then.vy])
                found.append(Others(np.array([k]), np.array([wait]), np.array([rate]), normal[None]))
        return found

    def _side(self, i: int, k: int, thing: ThingParts) -> RoundSide:
        """A side of an arc, as circle i may meet it."""
        places = [self._count + k, *thing.ends]
        (x, y), *ends = ((arb(x), arb(y)) for x, y in self.places[places].tolist())
        r = abs(float(self._sides[k].r))
        return RoundSide(x, y, arb(r), arb(float(self._radii[i])), k % 2 == 1, tuple(ends))

    def _sides_of(self, i: int, at: Collection[int]) -> list[Others]:
        """The sides of arcs in its way, but for those that it is at."""
        found: list[Others] = []
        (x, y), (ux, uy), (gx, gy) = self.places[i].tolist(), self.speeds[i].tolist(), self.pulls[i].tolist()
        if not (ux or uy or gx or gy):
            return found
        way = arb(x), arb(y), arb(ux), arb(uy)
        for thing in self._arcs:
            for k in thing.sides:
                met = None if k in at else self._side(i, k, thing).meets(way, gx, gy)
                if met is not None and met[3] > 0.0:
                    wait, nx, ny, rate = map(np.atleast_1d, met)
                    found.append(Others(np.array([self._count + k]), wait, rate, np.array((nx, ny)).T))
        return found

    def _things_of(self, impact: Impact) -> list[ThingParts]:
        """What has the face or the end that an impact is at; nothing for others."""
        if impact.wall is not None:
            return self._of.get((True, impact.wall), [])
        return [] if impact.b is None else self._of.get((False, impact.b), [])

    def passing(self, impact: Impact) -> Passing | None:
        """How far a circle is from passing the thing that it hits; None where it hits a circle, or a wall.

        Of one that falls along the line of its flight at the impact: as good as the bend between there and an end is
        small, and the end that a fall is about to miss is near.
        """
        things = self._things_of(impact)
        if any(not thing.convex for thing in things):
            return self._out_of(impact.a, things)
        ends = sorted({end for thing in things for end in thing.ends})
        if not ends:
            return None
        (dx, dy), (vx, vy) = (self.places[ends] - self.places[impact.a]).T, self.speeds[impact.a] - self.speeds[ends[0]]
        speed, reach = hypot(vx, vy), self._radii[ends] + self._radii[impact.a]
        waits, offset = (dx * vx + dy * vy) / speed**2, (dx * vy - dy * vx) / speed
        low, high = int(np.argmin(offset - reach)), int(np.argmax(offset + reach))
        below, above = float(reach[low] - offset[low]), float(offset[high] + reach[high])
        depth, end = (below, low) if below < above else (above, high)
        return Passing(max(depth, 0.0), float(waits[end]))

    def _out_of(self, i: int, things: Sequence[ThingParts]) -> Passing | None:
        """The same of things of which some are not convex: of what of them lies ahead of circle i."""
        faces = sorted({wall for thing in things for wall in thing.faces})
        ends = sorted({end for thing in things for end in thing.ends})
        pace = self._paces[faces[0]] if faces else np.zeros(2)  # a full arc has no faces, and none moves
        (x, y), (vx, vy), r = self.places[i], self.speeds[i] - pace, self._radii[i]
        lines = [
            SeenWall(*map(arb, (x0, y0, nx * long, ny * long, long * long, long)))
            for (x0, y0, nx, ny), long in zip(self._walls[faces].tolist(), self._length[faces].tolist(), strict=True)
        ]
        places, radii = self.places[ends].tolist(), self._radii[ends].tolist()
        round_ones = [(e, arb(ex), arb(ey), arb(er)) for e, (ex, ey), er in zip(ends, places, radii, strict=True)]
        sides = [self._side(i, k, thing) for thing in things for k in thing.sides]
        back = BEFORE * (abs(x) + abs(y) + r) / hypot(vx, vy) if sides else 0.0  # a point on an arc has come to it
        way = arb(float(x - back * vx)), arb(float(y - back * vy)), arb(float(vx)), arb(float(vy))
        passed = out_of(stretches(way, arb(float(r)), lines, round_ones, sides))
        if passed is None:
            return None
        return Passing(max(-float(passed.aside.mid()), 0.0), passed.ahead / hypot(vx, vy) - back)

    def _walls_of(self, i: int, at: Sequence[int], unknown: int) -> Others:
        """The walls and faces in its way, but for those that it is at, and the nearest where that is not known."""
        (x0, y0, nx, ny), (x, y), (gx, gy) = self._walls.T, self.places[i], self.pulls[i]
        ux, uy = (self.speeds[i] - self._paces).T
        gap, r = wall_gap(x, y, x0, y0, nx, ny, 0.0), self._radii[i]
        side = np.where((gap < 0) & ~self._is_face, -1.0, 1.0)
        gap = side * gap - r
        touches = (gap < 0.0) & (~self._is_face | (gap > -BEFORE * (abs(x) + abs(y) + r)))  # by rounding
        approach, pull = side * wall_approach(ux, uy, nx, ny), side * wall_approach(gx, gy, nx, ny)
        waits, rates = falls_to_walls(np.where(touches, 0.0, gap), approach, pull)
        meets = np.isfinite(waits)
        wait = np.where(meets, waits, 0.0)
        foot = (x + wait * (ux + wait / 2 * gx) - x0) * ny - (y + wait * (uy + wait / 2 * gy) - y0) * nx
        meets &= ~self._is_face | ((foot > 0.0) & (foot < self._length))
        meets[[*np.abs(gap).argsort()[:unknown], *at]] = False
        waits, rates = waits[meets], rates[meets]
        normals = -side[meets, None] * np.array((nx[meets], ny[meets])).T
        return Others(np.full(len(waits), WALL), waits, rates, normals)

    def pull(self, impact: Impact) -> NDArray[np.float64]:
        """By what gravity changes the velocity of an impact in a unit of time; nothing for two that fall."""
        return self.pulls[impact.a] if impact.b is None else self.pulls[impact.b] - self.pulls[impact.a]

    def fall_rate(self, impact: Impact) -> float:
        """By what share gravity changes the approach to what stands in a unit of time."""
        _, _, dx, dy, vx, vy, *_ = as_doubles(impact)
        gx, gy = self.pull(impact)
        if not (gx or gy):
            return 0.0
        pull, approach = float(pair_approach(dx, dy, gx, gy)), float(pair_approach(dx, dy, vx, vy))
        return pull / approach if approach else copysign(inf, -pull)  # of a hit that is a graze in doubles

    def pulled(self, impact: Impact) -> bool:
        """Whether gravity pulls a circle to what it hits: then it comes there at whatever speed it flies."""
        return self.fall_rate(impact) > 0.0

    def nearest(self, impact: Impact) -> tuple[float, float, NDArray[np.float64]]:
        """When two circles that meet would be nearest if they did not, how far aside, and with which velocity."""
        _, _, dx, dy, vx, vy, reach, *_ = as_doubles(impact)
        gx, gy = self.pull(impact)
        if not (gx or gy):
            aside, square = abs(dx * vy - dy * vx), vx * vx + vy * vy
            return -(dx * vx + dy * vy) / square, aside / float(np.hypot(vx, vy)), np.array([vx, vy])
        wait, then = falls_past(RoundFall(dx, dy, vx, vy, -float(gx) / 2, -float(gy) / 2, reach))
        return wait, hypot(then.dx, then.dy), np.array([then.vx, then.vy])


def margins(
    scene: Scene, struck: Sequence[Sequence[Impact]], free: Sequence[int], known: Surroundings | None = None
) -> list[list[tuple[int, NDArray[np.float64]]]]:
    """Event by event, the margins of each of the circles `free` that takes part.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.compare.tangent.impacts import impacts
    >>> from truebreak.scenarios import Circle, Scene, Wall
    >>> scene = Scene([Circle(0, 0, vx=1, vy=1)], [Wall(10, 0, 10, 1), Wall(0, "101/10", 1, "101/10")])
    >>> [[(circle, told)]] = margins(scene, impacts(ExactEngine().run(scene), 1), [0])
    >>> circle, [round(float(value), 3) for value in told]  # 0.05 back and 0.05 up, and it meets the other wall first
    (0, [0.05])
    """
    course, told = Course(scene, known), []
    for event in struck:
        course.fly(float(event[0].time))
        met = [(impact, i) for impact in event for i in (impact.a, impact.b) if i is not None and i in free]
        told.append([(i, course.margins(event, impact, i)) for impact, i in met])
        for impact in event:
            course.push(impact)
    return told


# ----------------------------------------
# What errors do to the decisions of an impact: each in its own direction, as a share of what turns them over.

Errors: TypeAlias = "NDArray[np.float64]"


def shares(
    course: Course,
    event: Sequence[Impact],
    impact: Impact,
    errors: Errors,
    movable: Callable[[int], bool],
    off: Callable[[int], Errors],
) -> list[float]:
    """Root mean squares, over a number of errors, of what they change in each decision as a share of its margin.

    To the first order. The decisions are

    - for each circle that can move, and each thing that it would meet next were it not for the impact: which of the two
      meetings is the earlier. The margin is the time between them;
    - for two circles, or a thing with ends: whether they pass each other by. The margin is how far they are from that;
    - whether they come together at all. The margin is the speed at which they do. To a wall to which gravity pulls it a
      circle always comes.

    So an error along the motion of two balls on a line lets none of them miss the other, however large it is.

    Args:
        course: the states at the event.
        event: all of its impacts.
        impact: the one in question.
        errors: shape (circles, 4, k): k errors of x, y, vx, vy of every circle.
        off: draws by how much an engine errs in the times of so many meetings themselves, shape (so many, k).

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.compare.tangent.impacts import impacts
    >>> from truebreak.scenarios import Circle, Scene
    >>> scene = Scene([Circle(0, 0, vx=1), Circle(6, "6/5")])
    >>> [[impact]] = impacts(ExactEngine().run(scene), 1)
    >>> course = Course(scene)
    >>> course.fly(float(impact.time))
    >>> errors = np.zeros((2, 4, 1))
    >>> def told(place, coordinate):
    ...     errors[:] = 0
    ...     errors[place, coordinate] = 0.1
    ...     found = shares(course, [impact], impact, errors, lambda i: True, lambda count: np.zeros((count, 1)))
    ...     return [round(share, 9) for share in found]
    >>> told(0, 0), told(0, 1), told(0, 2)  # forward; up, of the 0.8 to a miss; and in the speed
    ([0.0, 0.0], [0.125, 0.0], [0.0, 0.1])
    """
    a, b, dx, dy, vx, vy, reach, *_ = as_doubles(impact)
    normal, velocity = np.array([dx, dy]) / reach, np.array([vx, vy])
    apart = errors[a] if b is None else errors[b] - errors[a]
    rate = normal @ velocity
    shift = -(normal @ apart[:2]) / rate
    told: list[float] = []
    for i in (i for i in (a, b) if i is not None and movable(i)):
        others = course.instead(event, i)
        theirs = np.where((others.places == WALL)[:, None, None], 0.0, errors[others.places, :2])
        gaps = np.einsum("oc,ock->ok", others.normals, theirs - errors[i, :2])
        shifts = gaps / others.rates[:, None] - shift + off(len(gaps)) - off(len(gaps))
        told += _shares(shifts, others.waits)
    thing = course.passing(impact)
    if thing is not None:
        own = course.speeds[a]
        across = np.array([-own[1], own[0]]) / np.hypot(*own)
        told += _shares((across @ (errors[a][:2] + thing.wait * errors[a][2:]))[None], np.array([thing.depth]))
    if thing is not None or b is None:
        return told if course.pulled(impact) else told + _shares((normal @ apart[2:])[None], np.abs([rate]))
    wait, aside, there = course.nearest(impact)
    across = np.array([-there[1], there[0]]) / np.hypot(*there)
    told += _shares((across @ (apart[:2] + wait * apart[2:]))[None], np.array([reach - aside]))
    speed = float(np.hypot(vx, vy))
    return told if course.pulled(impact) else told + _shares((velocity / speed @ apart[2:])[None], np.array([speed]))


def _shares(changes: Errors, margins: NDArray[np.float64]) -> list[float]:
    """Row by row the root mean square of changes over its margin; infinite where there is none."""
    sizes = np.sqrt((changes * changes).sum(axis=1) / changes.shape[1])
    return np.divide(sizes, margins, out=np.full(len(margins), np.inf), where=margins > 0).tolist()


# ----------------------------------------
# How large an engine's error is expected to be at each event of a certified run, before the engine is run.
#
# Each model says what error an engine commits, and the tangent map says what becomes of it. What comes out is the error
# that decisions meet: its size beside the margin of each decision, event by event, for an engine of unit error.


class ErrorModel(Enum):
    """What an engine's declarations say of its error."""

    ROUNDING = "every number is rounded to so many bits"
    STEPPED = "contacts are found late, by up to a time step"
    ENCLOSED = "numbers are enclosed with so many bits, and a decision that the enclosure leaves open ends the run"


def model_of(engine: Engine) -> tuple[ErrorModel, float] | None:
    """The model of an engine, and log2 of its unit of error; None for one that has none: its numbers are exact.

    Floats that do not round their input round what they compute; only truebreak's own intervals enclose.

    >>> from truebreak.floating import DoubleEngine
    >>> model_of(DoubleEngine())
    (<ErrorModel.ROUNDING: 'every number is rounded to so many bits'>, -53.0)
    """
    if engine.step is not None:
        return ErrorModel.STEPPED, log2(engine.step)
    if engine.bits is None:
        return None
    if engine.rounds_input:  # which none of truebreak's own intervals does
        return ErrorModel.ROUNDING, -float(engine.bits)
    from ...floating.interval import IntervalEngine  # here, since most have none

    return (ErrorModel.ENCLOSED if isinstance(engine, IntervalEngine) else ErrorModel.ROUNDING), -float(engine.bits)


SAMPLES = 16
"""Errors drawn at random and carried along side by side; their mean square is what is expected."""

SEED = 1967

PROBE_STEP = 2.0**-20
"""Share of the shortest time between events by which the stepped model's impacts are late: small, so that its error is
proportional to the step."""


TOSS = 8.0
"""What a decision adds to the hazard at most: one whose margin is far below the error is a coin toss, and half of the
engines get it right. By this hazard half of them have left (the median levels in `levels.py` are its logarithm, but for
a fraction of a bit)."""

FARTHEST = 1000.0
"""Powers of two beyond which a share is nothing, or more than any level: a double ends at 2**1024."""

AT_ONCE = 32
"""Events whose decisions are made at first, where it is asked when a level is reached; then twice as many."""

HALVINGS = 60
"""Steps of bisection to an engine's unit: beyond the last bit of a double."""


class ErrorCurve:
    """The expected error of an engine along a run, beside the margins of the run's decisions.

    Args:
        model: what commits the error.
        events: how many there are.
        decisions: for each decision its event, and log2 of the error that an engine of unit error brings to it as a
            share of its margin.
    """

    def __init__(self, model: ErrorModel, events: int, decisions: Iterable[tuple[int, float]]) -> None:
        self.model = model
        self._events = events
        self._decisions = iter(decisions)
        self._known: list[tuple[int, float]] = []
        self._at: NDArray[np.intp] = np.zeros(0, dtype=np.intp)
        self.shares: NDArray[np.float64] = np.zeros(0)

    def _through(self, event: int) -> None:
        """Makes the decisions of all events up to one, if they are not made yet."""
        made = len(self._known)
        for decision in self._decisions:
            self._known.append(decision)
            if decision[0] > event:
                break
        if len(self._known) > made:
            self._at = np.array([at for at, _ in self._known], dtype=np.intp)
            self.shares = np.array([share for _, share in self._known], dtype=float)

    def hazard(self, unit: float) -> NDArray[np.float64]:
        """Shape (events,): log2 of the sum, over the decisions so far, of an engine's errors as shares of the margins.

        A decision is overturned with a probability proportional to the error that it meets, but never more often than
        a coin toss; so this says how likely the history is left by then. Where an enclosure leaves a decision open the
        run ends for sure: no toss.

        Args:
            unit: log2 of the engine's unit of error.

        >>> ErrorCurve(ErrorModel.ROUNDING, 3, [(0, 0.0), (1, 0.0), (1, 1.0), (2, 99.0)]).hazard(0.0).tolist()
        [0.0, 2.0, 3.584962500721156]
        """
        self._through(self._events)
        return self._hazard(unit)

    def _hazard(self, unit: float) -> NDArray[np.float64]:
        """The hazard by the decisions made so far."""
        most = inf if self.model is ErrorModel.ENCLOSED else TOSS
        shares = np.minimum(most, np.exp2(np.clip(self.shares + unit, -FARTHEST, FARTHEST)))
        sums = np.bincount(self._at, shares, minlength=self._events).cumsum()
        return np.log2(np.maximum(sums, 2.0**-FARTHEST))

    def reaches(self, level: float, unit: float) -> int | None:
        """The first event at which the hazard of an engine with that log2 unit reaches a level; None if none does."""
        upto = 0
        while upto < self._events:
            upto = min(max(2 * upto, AT_ONCE), self._events)
            self._through(upto)
            above = np.nonzero(self._hazard(unit)[:upto] >= level)[0]
            if len(above):
                return int(above[0])
        return None

    def unit_at(self, level: float) -> float:
        """log2 of the unit of error with which the hazard at the last event is at a level.

        Infinite if no error is large enough for that, minus infinity if none is small enough.
        """
        finite = self.shares[np.isfinite(self.shares)]
        low, high = -float(finite.max(initial=0.0)) - FARTHEST, FARTHEST
        if self.hazard(high)[-1] < level:
            return inf
        if self.hazard(low)[-1] >= level:
            return -inf
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            low, high = (low, middle) if self.hazard(middle)[-1] >= level else (middle, high)
        return high


def error_curve(
    trajectory: Trajectory,
    struck: Sequence[Sequence[Impact]],
    model: ErrorModel,
    known: Surroundings | None = None,
) -> ErrorCurve:
    """The curve of one model along the first events of a certified run, those of `struck`.

    Args:
        known: as `Course` has it; one for all models of a run saves the second of them most of the work.
    """
    scene = trajectory.scene
    if model is not ErrorModel.ENCLOSED:
        return ErrorCurve(model, len(struck), _carried(scene, struck, model, known))
    decisions: list[tuple[int, float]] = []
    widths = _widths(trajectory, struck)
    for event, (told, margin_of) in enumerate(zip(widths, margins(scene, struck, moving(scene), known), strict=True)):
        for i, found in margin_of:
            decisions += [(event, told[i] - log2(margin) if margin else inf) for margin in found.tolist()]
    return ErrorCurve(model, len(struck), decisions)


def _carried(
    scene: Scene, struck: Sequence[Sequence[Impact]], model: ErrorModel, known: Surroundings | None
) -> Iterator[tuple[int, float]]:
    """Each decision's event, and log2 of what the errors carried there are of its margin, for a unit of 1."""
    draw = np.random.default_rng(SEED)
    free = moving(scene)
    row = {i: k for k, i in enumerate(free)}
    course = Course(scene, known)
    start = np.zeros((len(free), 4, SAMPLES))
    if model is ErrorModel.ROUNDING:
        state = np.hstack([course.places, course.speeds])[free]
        start = state[:, :, None] * draw.uniform(-1, 1, start.shape)
    carried, errors = Displacements(scene, start), np.zeros((len(course.places), 4, SAMPLES))
    for event, impacts in enumerate(struck):
        time = float(impacts[0].time)
        course.fly(time)
        carried.fly(time)
        errors[free] = carried.columns
        ends = (0.0, 1.0) if model is ErrorModel.STEPPED else (-time, time)  # found late; or the clock is rounded

        def off(count: int, ends: tuple[float, float] = ends, shrink: float = 2.0**-carried.scale) -> Errors:
            return shrink * draw.uniform(*ends, (count, SAMPLES))

        for impact in impacts:
            found = shares(course, impacts, impact, errors, row.__contains__, off)
            yield from ((event, carried.scale + log2(share) if share else -inf) for share in found)
        for impact in impacts:
            _strike(carried, course, row, impact, model, draw)


def _strike(
    carried: Displacements,
    course: Course,
    row: dict[int, int],
    impact: Impact,
    model: ErrorModel,
    draw: np.random.Generator,
) -> None:
    """One impact: what was carried goes through it, and what the engine gets wrong at it is added."""
    carried.through([impact])
    time, dx, dy, vx, vy, reach, wa, wb = (float(v) for v in (impact.time, *impact[3:10]))
    shrink = 2.0**-carried.scale
    late = draw.uniform(0, 1, SAMPLES) if model is ErrorModel.STEPPED else np.zeros(SAMPLES)
    for (i, change), weight in zip(course.push(impact), (-wa, wb), strict=False):
        if i not in row:
            continue
        own = carried.of(i)
        if model is ErrorModel.STEPPED:
            own[:2] -= shrink * change[:, None] * late
            if impact.b is None and (fallen := course.fall_rate(impact)):
                own[2:] += shrink * fallen * change[:, None] * late
            if impact.b is not None:
                lag = PROBE_STEP * reach / (abs(vx) + abs(vy))
                px, py = dx + vx * lag, dy + vy * lag
                gx, gy = course.pull(impact)
                there = course.share * np.array(
                    pair_impulse(px, py, vx + gx * lag, vy + gy * lag, hypot(px, py), wa, wb)
                )
                turned = (weight * there - change)[:, None] / lag * late
                own[2:] += shrink * turned
            continue
        (x, y), (ux, uy), speed = course.places[i], course.speeds[i], float(np.abs(change).max())
        room = np.abs([x, y, ux, uy]) + np.array([abs(change[0]) * time, abs(change[1]) * time, speed, speed])
        room[2:][(course.speeds[i] == 0) & (change == 0)] = 0.0  # a zero to which a zero is added is exact
        own += shrink * room[:, None] * draw.uniform(-1, 1, (4, SAMPLES))


def _widths(trajectory: Trajectory, struck: Sequence[Sequence[Impact]]) -> list[dict[int, float]]:
    """log2 of the width of the places of those who meet, for one unit in the last of the bits.

    Interval arithmetic forgets how errors depend on each other, so its widths grow faster than any displacement. They
    are measured: the run's log is replayed by the plain formulas in balls, with bits to spare; under gravity in true
    coordinates, as the engine does it.
    """
    motion = motion_of(trajectory)
    assert motion is not None, "predicted of an exact run only"
    log, circles = motion.log, motion.log.scene.circles
    bits = 2 * (log.lost + LEAST_BITS)
    while True:
        with ball.precision(bits):
            falls = log.scene.gravity is not None
            state = PlainState(log.scene, ball.BALLS) if falls else ReplayState(log.scene, ball.BALLS)
            told: list[dict[int, float]] = []
            done = 0
            for event, impacts in zip(trajectory.events, struck, strict=False):
                upto = steps_through(event)
                for step in log.steps[done:upto]:
                    state.do(step)
                done = upto
                both = (i for impact in impacts for i in (impact.a, impact.b) if i is not None and i < len(circles))
                met = {i: state.bodies[i].flight for i in both}
                widths = [_log2(flight.x.rad() + flight.y.rad()) for i, flight in met.items() if not circles[i].fixed]
                told.append(dict.fromkeys(met, bits + max(widths)))
        if all(width < bits / 2 for errors in told for width in errors.values()):
            return told
        bits *= 2


def _log2(value: arb) -> float:
    """log2 of a radius, however small."""
    return float((value + arb(2) ** -100_000).log() / arb(2).log())
