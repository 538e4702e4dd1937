"""The article's engine taken literally, in SymPy alone: slow, the oracle for small scenes."""

from __future__ import annotations

from bisect import bisect_right
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import combinations, product
from math import ceil, log
from random import Random
from typing import TYPE_CHECKING, Any

from sympy import Expr, Integer

from ...scenarios.engine import ALL_KEYS, Declared, endable, horizon, refuse_settled
from ...scenarios.errors import SceneError, TimeIsUp
from ...scenarios.numbers.quantity import Quantity, QuantityLike, Real
from ...scenarios.scene import Scene
from ...scenarios.surfaces import ends_of, sides_of
from ...scenarios.things import Squeeze
from ...scenarios.trajectory import (
    Contact,
    Event,
    OnProgress,
    Pocketing,
    Progress,
    Reversal,
    Stop,
    StopReason,
    Tie,
    TieProof,
    Trajectory,
)
from .symbolic_contacts import (
    Bar,
    Bow,
    Collided,
    Disc,
    Indices,
    Line,
    Touching,
    UnendingCollision,
    apart,
    approach_sign,
    bow_of,
    collide,
    coupled,
    direction,
    disc_of,
    fall_times,
    height,
    is_within,
    length,
    line_of,
    may_fall_onto,
    rim_of,
    time_to_enter,
    to_ends,
    to_rim,
    touch_times,
)
from .symbolic_sign import SymbolicUndecided, above, below, normal, quantity, root, sign, smallest

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

ZERO: Any = Integer(0)

# -- Flights between instants, in SymPy numbers: straight ones, or parabolas under gravity.


@dataclass(frozen=True)
class SymbolicMotion:
    """Positions and velocities of a run: legs, and when each starts.

    Attributes:
        starts: when each leg starts; of legs that start at one time the last holds.
        legs: all circles at that time, with the velocities that they leave it with.
        end: when the run ends.
        gravity: what bends them.
    """

    starts: tuple[Any, ...]
    legs: tuple[tuple[Disc, ...], ...]
    end: Any
    gravity: tuple[Any, Any] = (ZERO, ZERO)

    def state(self, time: Any) -> list[tuple[Real, Real, Real, Real]]:
        """(x, y, vx, vy) of every circle at a time; at an event, as it leaves it.

        Raises:
            ValueError: for a time outside of the run.
        """
        at: Any = Quantity.of(time).sympy()
        if sign(at) < 0 or sign(at - self.end) > 0:
            raise ValueError(f"time {time} is not between 0 and the end of the run, {quantity(self.end)}")
        for begun, leg in zip(reversed(self.starts), reversed(self.legs), strict=True):
            since = at - begun
            if sign(since) >= 0:
                flown = (_flown(disc, since, self.gravity) for disc in leg)
                return [(quantity(d.x), quantity(d.y), quantity(d.vx), quantity(d.vy)) for d in flown]
        raise AssertionError("the first leg starts at time 0")

    def sample(self, times: Sequence[float]) -> NDArray[np.float64]:
        """Shape (times, circles, 4): the same as doubles, flights computed in doubles."""
        starts = [float(quantity(begun)) for begun in self.starts]
        import numpy as np  # here, since nothing else of this engine does: it runs where there is none

        legs = np.array([[[float(quantity(n)) for n in (d.x, d.y, d.vx, d.vy)] for d in leg] for leg in self.legs])
        places = [max(bisect_right(starts, time) - 1, 0) for time in times]
        found = legs[places].copy()
        since = np.array(times, dtype=float) - np.array(starts)[places]
        found[:, :, :2] += found[:, :, 2:] * since[:, None, None]
        g = np.array([float(quantity(part)) for part in self.gravity])
        if g.any():
            falls = np.array([disc.m is not None for disc in self.legs[0]], dtype=float)[None, :, None]
            found[:, :, :2] += g / 2 * falls * since[:, None, None] ** 2
            found[:, :, 2:] += g * falls * since[:, None, None]
        return found


def _flown(disc: Disc, since: Any, g: tuple[Any, Any]) -> Disc:
    """A circle so much later; one that is fixed stands, or moves with what it is an end of."""
    if disc.m is None and disc.vx == 0 == disc.vy:
        return disc
    gx, gy = g if disc.m is not None else (ZERO, ZERO)
    return replace(
        disc,
        x=normal(disc.x + disc.vx * since + gx * since**2 / 2),
        y=normal(disc.y + disc.vy * since + gy * since**2 / 2),
        vx=normal(disc.vx + gx * since),
        vy=normal(disc.vy + gy * since),
    )


# -- The article's engine taken literally, in SymPy alone: slow, the oracle for small scenes.
#
# 1. For each circle with each other circle and each wall, put the numbers into the derived solutions for the    time
# of touch; drop complex, nan and negative times, keep the smallest. 2. Advance every circle to the smallest of all.
# 3. Of the pairs that touch, those whose instant speed toward each other is positive collide. 4. Put the numbers into
# the derived solutions for the velocities; repeat.
#
# Two additions, for points, where the article's instant speed is nan. At a wall it is taken at the position from
# which the point came, so that points bounce as the smallest of circles do. Two points never collide with each other,
# in any engine here: where they meet, no direction of the impact is defined.
#
# Source: Carl M. Kadie, 'Perfect, Infinite-Precision, Game Physics in Python', parts 1 and 3, 2023. It uses no
# formula, number system or decision of the exact engine.


@dataclass(frozen=True)
class SymbolicEngine(Declared):
    """Runs a scene in SymPy numbers, with the laws as derived and every pair predicted.

    Each pair costs milliseconds while numbers are rational, and more with every square root that nests in
    the last, so limit a run by `until` or `events`. A sign that cannot be proved ends it as UNDECIDED.

    >>> from truebreak.scenarios import Circle
    >>> trajectory = SymbolicEngine().run(Scene([Circle(0, 0, vx=2), Circle(4, 0)]))
    >>> trajectory.events[0].time, trajectory.stop.reason.name
    (Quantity('1'), 'QUIET')
    """

    @property
    def scene_keys(self) -> frozenset[str]:
        """All but `capture`: no circle is ever taken out of play."""
        return ALL_KEYS - {"capture", "settle"}

    @property
    def name(self) -> str:
        """The name by which the command line and reports call the engine."""
        return "sympy"

    def run(
        self,
        scene: Scene,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """The history of a scene up to a time, a number of instants, or both, whichever comes first.

        Raises:
            SceneError: for a limit that is not above zero, or pockets that capture circles.
        """
        refuse_settled(scene, "engine 'sympy'")
        if scene.capture:
            raise SceneError(f"scene {scene.name!r}: the sympy engine knows no capture by pockets; set it to false")
        return _Run(scene, *horizon(scene, until, events), progress).trajectory()


@dataclass
class _Run:
    """The state of one run, from time 0 on."""

    scene: Scene
    until: Quantity | None
    limit: int | None
    progress: OnProgress | None
    now: Any = ZERO
    discs: tuple[Disc, ...] = ()
    lines: tuple[Line, ...] = ()
    events: list[Event] = field(default_factory=list)
    starts: list[Any] = field(default_factory=list)
    legs: list[tuple[Disc, ...]] = field(default_factory=list)
    reversal: Reversal | None = None
    hits: dict[Indices, Any] = field(default_factory=dict)
    came: dict[Indices, tuple[Disc, ...]] = field(default_factory=dict)
    plan: dict[str, int] = field(default_factory=lambda: {"predictions": 0, "moves": 0})
    entered: list[Pocketing] = field(default_factory=list)
    whole: tuple[int, int, int, Reversal | None, Any] = (0, 0, 1, None, ZERO)
    ending: Any = None

    def __post_init__(self) -> None:
        scene = self.scene
        points = any(circle.r.sign() == 0 for circle in scene.circles)
        ends = ends_of(scene.segments, scene.polygons, points, scene.arcs)
        segments = (*scene.segments, *(side for polygon in scene.polygons for side in sides_of(polygon)))
        self.discs = tuple(map(disc_of, (*scene.circles, *ends)))
        self.real = len(scene.circles)
        told = ([normal(q.sympy()) for q in (s.x0, s.y0, s.x1, s.y1, s.r, s.vx, s.vy)] for s in segments)
        bars = (Bar(*q[:5], ux=q[5], uy=q[6]) for q in told)
        self.lines = (*map(line_of, scene.walls), *bars, *map(bow_of, scene.arcs))
        n = len(self.discs)
        pairs = [*combinations(range(n), 2), *((i, n + k) for i in range(n) for k in range(len(self.lines)))]
        self.pairs = sorted(
            pair
            for pair in pairs
            if any(k < n and self.discs[k].m is not None for k in pair)
            and not all(k < self.real and self.discs[k].r == 0 for k in pair)
        )
        self.kinds = {
            (i, n + k): wall.side(circle.x, circle.y)
            for k, wall in enumerate(scene.walls)
            for i, circle in enumerate(scene.circles)
            if wall in scene.other_walls
        }
        self.rims = [*map(rim_of, scene.pockets)]
        things = (*scene.circles, *ends, *scene.walls, *segments, *scene.arcs)
        self.names = tuple(str(thing.id) for thing in things)
        self.draw = Random(self.scene.tie_policy.seed)
        self.quartics = _quartics(self)
        self.e = normal(scene.restitution.sympy())
        self.g: tuple[Any, Any] = (ZERO, ZERO)
        if scene.gravity is not None:
            gx, gy = scene.gravity
            self.g = normal(gx.sympy()), normal(gy.sympy())
        self._leg()

    def trajectory(self) -> Trajectory:
        """Runs to the end."""
        stop = self._played()
        return Trajectory(
            scene=self.scene,
            engine="sympy",
            parameters={},
            events=tuple(self.events),
            stop=stop,
            final_time=quantity(self.now),
            motion=SymbolicMotion(tuple(self.starts), tuple(self.legs), self.now, self.g),
            reversal=self.reversal,
            pocketings=tuple(self.entered),
            plan=self.plan,
            ending=None if self.ending is None else quantity(self.ending),
        )

    def _played(self) -> Stop:
        """Runs, and says why it ended."""
        try:
            with endable():
                return self._run()
        except SymbolicUndecided as error:
            return _stop(StopReason.UNDECIDED, str(error))
        except UnendingCollision as error:
            return _stop(StopReason.BUDGET, str(error))
        except TimeIsUp as error:
            self._drop_unfinished()
            return _stop(StopReason.BUDGET, str(error))
        except KeyboardInterrupt:
            self._drop_unfinished()
            return _stop(StopReason.INTERRUPTED, f"after {len(self.events)} events")

    def _drop_unfinished(self) -> None:
        """Goes back to the last instant that was done when the next was looked for."""
        events, entries, legs, self.reversal, self.now = self.whole
        del self.entered[entries:], self.events[events:], self.legs[legs:], self.starts[legs:]

    def _run(self) -> Stop:
        endings = _Endings(self)
        while True:
            touching = self._touching()
            ended = endings.crushed(touching) if sign(self.now) else None
            if ended is not None:
                self.now = self.starts[-1]
                return ended
            outcome = collide(touching, self.scene.tie_policy, self.draw, self.e)
            if outcome.first:
                self._record(outcome)
            resting = self._resting(touching.after({i: (d.vx, d.vy) for i, d in enumerate(self.discs)}))
            if outcome.first:
                ended = None if resting else endings.after(outcome.impulses)
                if ended is not None:
                    return ended
                if len(self.events) == self.limit and not resting:
                    self._enter(ZERO, last=True)
                    return _stop(StopReason.EVENTS, str(self.limit))
                if self.reversal is None and len(self.events) == self.scene.reverse_after:
                    self._reverse()
                    continue
            if resting:
                return _stop(StopReason.REST, resting)
            if self._reversal_due() and sign(self.now - self._reverse_at) == 0:
                self._reverse()
                continue
            stop = self._advance(set(touching.pairs))
            if stop is not None:
                return stop

    @property
    def _reverse_at(self) -> Any:
        return self.scene.reverse_at.sympy() if self.scene.reverse_at is not None else None

    def _reversal_due(self) -> bool:
        return self.reversal is None and self.scene.reverse_at is not None

    def _advance(self, touching: set[Indices]) -> Stop | None:
        """Moves every circle to the next moment at which something may happen; a Stop if there is none."""
        self.whole = (len(self.events), len(self.entered), len(self.legs), self.reversal, self.now)
        moments = [hit for pair in self.pairs if (hit := self._hit(pair, pair in touching)) is not None]
        if self._reversal_due():
            moments.append(self._reverse_at)
        soonest = smallest(moments)
        end = self.until.sympy() if self.until is not None else None
        if self.quartics or (self.rims and self.scene.gravity is not None):
            at_end = end is not None and (soonest is None or sign(soonest - end) > 0)
            _refuse_quartics(self, end if at_end else soonest)
        if end is not None and (soonest is None or sign(soonest - end) > 0):
            self._move(end, last=True)
            return _stop(StopReason.HORIZON, str(self.until))
        if soonest is None:
            self.now = self.starts[-1]  # a graze since then was not an event
            self._enter(None)
            self.now = max([quantity(self.now), *(Quantity.of(entry.time) for entry in self.entered)]).sympy()
            return Stop(StopReason.QUIET, StopReason.QUIET.value)
        self._move(soonest)
        return None

    def _hit(self, pair: Indices, touches: bool) -> Any:
        """When a pair will touch next, if it does not touch now. It is predicted once a flight."""
        if pair in self.quartics:
            return None
        known = pair in self.hits and not (touches and not _straight(self, pair))
        if not known:
            i, j = pair
            n = len(self.discs)
            b = self.lines[j - n] if j >= n else self.discs[j]
            self.plan["predictions"] += 1
            own = pair in self.kinds
            times = self._by_kind(pair) if own else self._touches_to_come(self.discs[i], b, touches)
            found = smallest(times)
            self.hits[pair] = None if found is None else normal(self.now + found)
        elif touches and not (pair[1] >= len(self.discs) and self._still_to_come(pair)):
            self.hits[pair] = None  # a grazing touch: on a straight flight there is no other
        return self.hits[pair]

    def _by_kind(self, pair: Indices) -> list[Any]:
        """When a circle meets a wall of a kind of its own: the zero of the gap to its side, where that is met."""
        height, rise, length = self._seen(pair)
        if sign(rise) >= 0:
            return []
        gap = normal(height - self.discs[pair[0]].r * length)
        met = self.scene.walls[pair[1] - len(self.discs)].is_met(sign(gap))
        return [normal(-gap / rise)] if met else []

    def _seen(self, pair: Indices) -> tuple[Any, Any, Any]:
        """The height of a circle above the side of a wall that it meets, how fast it grows, and |n|, all times |n|."""
        a, w, side = self.discs[pair[0]], self.lines[pair[1] - len(self.discs)], self.kinds[pair]
        nx, ny = side * (w.y0 - w.y1), side * (w.x1 - w.x0)
        height, rise = nx * (a.x - w.x0) + ny * (a.y - w.y0), nx * a.vx + ny * a.vy
        return normal(height), normal(rise), root(normal(nx**2 + ny**2))

    def _still_to_come(self, pair: Indices) -> bool:
        """Whether what touches now was found to touch again, later on the same flight."""
        hit = self.hits[pair]
        return isinstance(self.lines[pair[1] - len(self.discs)], Bow) and hit is not None and sign(hit - self.now) > 0

    def _touches_to_come(self, a: Disc, b: Disc | Line, touches: bool) -> list[Any]:
        """The times from now at which two will touch, where they touch now or not."""
        if self.scene.gravity is None or isinstance(b, Disc):
            least = 1 if isinstance(b, Bow) else 0  # what leaves an arc to within comes to it again
            times = touch_times(a, b) if least or not touches else []
            return [time for time in times if sign(time) >= (least if touches else 0)]
        return [time for time in fall_times(a, b, self.g) if sign(time) > (0 if touches else -1)]

    def _resting(self, touching: Touching) -> str:
        """Who stands at a wall to which gravity pulls it, in words."""
        found: list[tuple[Indices, bool]] = []
        for pair in touching.pairs if self.scene.gravity is not None else ():
            a, b = touching.things(pair)
            if isinstance(b, Line) and approach_sign(a, b) == 0:
                a, ux, uy = b.seen(a), b.x1 - b.x0, b.y1 - b.y0
                side = sign(normal(ux * (a.y - b.y0) - uy * (a.x - b.x0)))
                along, pull = ux * a.vy - uy * a.vx, ux * self.g[1] - uy * self.g[0]
                if sign(normal(along)) == 0 and side * sign(normal(pull)) < 0:
                    found.append((pair, sign(normal(ux * self.g[0] + uy * self.g[1])) != 0))
        held = Counter(pair[0] for pair, _ in found)  # by two walls or more it slides along none
        slides = [", a slope, along which it slides" * (leans and held[pair[0]] == 1) for pair, leans in found]
        return " as well as ".join(" and ".join(_contact(self, f[0])) + s for f, s in zip(found, slides, strict=True))

    def _enter(self, lasts: Any, last: bool = False) -> None:
        """Notes who enters a pocket so soon, or ever, at the end too if that is the last; under gravity nobody does."""
        found: list[Pocketing] = []
        falls = self.scene.gravity is not None
        for (i, a), (pocket, rim) in product(enumerate(self.discs), zip(self.scene.pockets, self.rims, strict=True)):
            if not falls and a.m is not None:
                wait = time_to_enter(a, rim)
                if wait is not None and (lasts is None or sign(normal(wait - lasts)) < last):
                    found.append(Pocketing(self.names[i], str(pocket.id), quantity(normal(self.now + wait))))
        self.entered += sorted(found, key=lambda entry: Quantity.of(entry.time))

    def _move(self, time: Any, last: bool = False) -> None:
        duration = normal(time - self.now)
        self._enter(duration, last)
        before = self.discs
        self.plan["moves"] += 1
        self.discs = tuple(_flown(d, duration, self.g) for d in before)
        for pair, hit in self.hits.items():
            if hit is not None and before[pair[0]].r == 0 and sign(hit - time) == 0:
                number = pair[1] - len(self.discs)
                line = self.lines[number] if number >= 0 else None
                halfway = (_flown(disc, duration / 2, self.g) for disc in before)  # both ends may be on one wall
                self.came[pair] = tuple(_beside(disc, line, duration / 2) for disc in halfway)
        self.lines = tuple(line.moved(duration) for line in self.lines)
        self.now = time
        if self.progress is not None:
            self.progress(Progress(len(self.events), float(quantity(time))))

    def _touching(self) -> Touching:
        """Who touches now: what was predicted to, and every other pair by its distance."""
        found = []
        for pair in self.pairs:
            hit = self.hits.get(pair)
            arrived = hit is not None and sign(hit - self.now) == 0
            if arrived and all(k < len(self.discs) and self.discs[k].r == 0 for k in pair):
                point, end = (self.names[k] for k in pair)
                raise SymbolicUndecided(f"no normal: {point} and {end} meet in one point; give one of them a radius")
            if arrived or sign(self._gap(pair)) == 0:
                found.append(pair)
        return Touching(self.discs, self.lines, tuple(found), self.came)

    def _gap(self, pair: Indices) -> Expr:
        """Square of the distance minus square of the sum of radii."""
        i, j = pair
        a, n = self.discs[i], len(self.discs)
        if j < n:
            b = self.discs[j]
            return normal((a.x - b.x) ** 2 + (a.y - b.y) ** 2 - (a.r + b.r) ** 2)
        w = self.lines[j - n]
        ux, uy = w.x1 - w.x0, w.y1 - w.y0
        reach = a.r
        if pair in self.kinds:  # what rises to gap zero there comes from behind, and passes
            height, rise, length = self._seen(pair)
            return Integer(1) if sign(rise) > 0 else normal(height - a.r * length)
        if isinstance(w, Bow):
            if not w.beside(a, ZERO):
                return Integer(1)
            far = (a.x - w.x) ** 2 + (a.y - w.y) ** 2
            gaps = [normal(far - square) for square in w.distances(a)]
            return next((gap for gap in gaps if sign(gap) == 0), gaps[0])
        if isinstance(w, Bar):
            if not w.beside(a, ZERO):
                return Integer(1)  # its ends are other things
            reach = a.r + w.r
        return normal((ux * (a.y - w.y0) - uy * (a.x - w.x0)) ** 2 / (ux**2 + uy**2) - reach**2)

    def _record(self, outcome: Collided) -> None:
        before, self.discs = self.discs, outcome.touching.discs
        changed = {i for i, (a, b) in enumerate(zip(before, self.discs, strict=True)) if a != b}
        self.hits = {pair: hit for pair, hit in self.hits.items() if not changed & set(pair)}
        ties: tuple[Tie, ...] = ()
        if len(outcome.first) > 1:
            rational = all(number.is_Rational for d in before for number in (d.x, d.y))
            proof = TieProof.RATIONAL if rational else TieProof.TOWER
            ties = (Tie(tuple(map(partial(_contact, self), outcome.first)), proof),)
        self.events.append(
            Event(
                index=len(self.events),
                time=quantity(self.now),
                contacts=tuple(map(partial(_contact, self), outcome.contacts)),
                impulses=tuple(map(partial(_contact, self), outcome.impulses)),
                ties=ties,
                coupled=coupled(outcome.touching, outcome.contacts),
            )
        )
        self._leg()

    def _reverse(self) -> None:
        self.discs = tuple(replace(d, vx=-d.vx, vy=-d.vy) for d in self.discs)
        self.hits = {}
        self.reversal = Reversal(len(self.events), quantity(self.now))
        self._leg()

    def _leg(self) -> None:
        self.starts.append(self.now)
        self.legs.append(self.discs[: self.real])


def _stop(reason: StopReason, particulars: str) -> Stop:
    return Stop(reason, f"{reason.value}: {particulars}")


def _straight(run: _Run, pair: Indices) -> bool:
    """Whether the gap of two is that of straight flights: of a circle and a wall under gravity it is not."""
    return pair[1] < len(run.discs) or run.scene.gravity is None


def _contact(run: _Run, pair: Indices) -> Contact:
    return Contact(run.names[pair[0]], run.names[pair[1]])


def _beside(disc: Disc, line: Any, duration: Any) -> Disc:
    """Where a circle was beside a thing that it meets, if that moves, as seen from where that is so much later."""
    if line is None or line.ux == 0 == line.uy:
        return disc
    return replace(disc, x=normal(disc.x + line.ux * duration), y=normal(disc.y + line.uy * duration))


def _quartics(run: _Run) -> list[Indices]:
    """The pairs of a circle that falls and something round: one that is fixed, an end, or an arc."""
    if run.scene.gravity is None:
        return []
    n, discs = len(run.discs), run.discs
    things = [(pair, isinstance(run.lines[pair[1] - n], Bow) if pair[1] >= n else None) for pair in run.pairs]
    return [pair for pair, bow in things if (any(discs[k].m is None for k in pair) if bow is None else bow)]


def _refuse_quartics(run: _Run, end: Any) -> None:
    """Sees to it that no circle falls onto something round up to a time; None: ever.

    Raises:
        SymbolicUndecided: where one may: when is a zero that square roots do not give.
    """
    n, wait = len(run.discs), None if end is None else end - run.now
    for pair in run.quartics:
        i, j = pair if pair[1] >= n or run.discs[pair[0]].m is not None else reversed(pair)
        a, bow = run.discs[i], run.lines[j - n] if j >= n else None
        b = bow.disc if isinstance(bow, Bow) else run.discs[j]
        within = bow is not None and is_within(a, b)
        if may_fall_onto(a, b, b.r - a.r if within else a.r + b.r, within, run.g, wait):
            raise SymbolicUndecided(_QUARTIC.format(f"{run.names[i]} falls onto {run.names[j]}"))
    for k, rim in enumerate(run.rims if run.scene.gravity is not None else ()):
        for i, a in enumerate(run.discs):
            if a.m is not None and may_fall_onto(a, rim, rim.r, is_within(a, rim), run.g, wait):
                raise SymbolicUndecided(_QUARTIC.format(f"{run.names[i]} enters {run.scene.pockets[k].id}"))


_QUARTIC = "whether and when {} is told by a zero of a quartic, and this engine has square roots alone; use exact"


# -- Where infinitely many hits end a run. When that is looked for is what all engines agree on; that a circle meets
# nothing else until then is proved by bounds of this engine's own, in fractions.

SHRUNK = 20
"""Bounces on a wall are told until their speed is 2**-SHRUNK of the first one's."""

SQUEEZED = 31
"""Bounces between two walls that close are told while more than one part in SQUEEZED + 1 of their time is left."""


class _Endings:
    """Looks for them, event by event."""

    def __init__(self, run: _Run) -> None:
        self.run, self.times = run, list[float]()
        e, self.rows, self.since = float(run.scene.restitution), dict[int, tuple[int, int]](), dict[int, float]()
        self.enough = ceil(SHRUNK * log(2.0) / -log(e)) if 0.0 < e < 1.0 and run.scene.gravity is not None else None
        self.closing = {squeeze.circle: squeeze for squeeze in run.scene.closing}

    def crushed(self, touching: Touching) -> Stop | None:
        """Whether a circle touches both of two walls that close."""
        count, pairs = len(self.run.discs), set(touching.pairs)
        told = (s for s in self.closing.values() if pairs.issuperset((s.circle, count + wall) for wall in s.walls))
        return next((self._crush(squeeze) for squeeze in told), None)

    def after(self, impulses: Sequence[Indices]) -> Stop | None:
        """Notes the impulses of an event; what ends the run, if infinitely many of them do."""
        run, count = self.run, len(self.run.discs)
        self.times.append(float(quantity(run.now)))
        n, now = len(self.times), self.times[-1]
        if run.scene.moving_solid and n >= 64 and n & (n - 1) == 0 and now - self.times[n // 2] < now / 1000:
            raise SymbolicUndecided(f"accumulation suspected: {n} events up to time {now:.9g}; end the run before")
        shares = Counter(k for pair in impulses for k in pair if k < count)
        bounced: list[Indices] = []
        for pair in impulses:
            if pair[1] >= count and shares[pair[0]] == 1:
                bounced.append(pair)
                continue
            for k in pair:
                self.rows.pop(k, None)
                self.since.pop(k, None)
        for i, k in bounced:
            wall, number = self.rows.get(i, (k, 0))
            self.rows[i] = (k, number + 1 if wall == k else 1)
            last = self.enough is not None and self.rows[i][1] > self.enough
            wait = self._wait(i, k) if last else None
            if wait is not None and self._meets_nothing(i, k - count, wait):
                run.ending = normal(run.now + wait)
                told = f"{' and '.join(_contact(run, (i, k)))} by {float(quantity(run.ending)):.12g}"
                return _stop(StopReason.ACCUMULATION, told)
        return next((stop for pair in bounced if (stop := self._squeezed(*pair)) is not None), None)

    def _wait(self, i: int, k: int) -> Any:
        """How long a circle that leaves a wall to which it is pulled will bounce there; None if it is not pulled."""
        run, line = self.run, self.run.lines[k - len(self.run.discs)]
        disc, ux, uy = line.seen(run.discs[i]), line.x1 - line.x0, line.y1 - line.y0
        side = sign(normal(ux * (disc.y - line.y0) - uy * (disc.x - line.x0)))
        rate, pull = side * (ux * disc.vy - uy * disc.vx), side * (ux * run.g[1] - uy * run.g[0])
        return normal(-2 * rate / (pull * (1 - run.e))) if sign(normal(pull)) < 0 else None

    def _meets_nothing(self, i: int, own: int, wait: Any) -> bool:
        """Whether a circle surely meets nothing but one wall for so long: no way of any is long enough."""
        run = self.run
        movers: list[Any] = [disc for disc in self.run.discs if disc.m is not None]
        if len(movers) > 1 and run.scene.moving_walls:
            return False
        pull, wait = length(*run.g), above(wait)
        energy = sum((above(d.m * (d.vx**2 + d.vy**2)) for d in movers), ZERO)
        swing = above(root(energy)) + pull * above(root(above(sum((d.m for d in movers), ZERO)))) * wait
        disc, line = run.discs[i], run.lines[own]
        pace = length(disc.vx - line.ux, disc.vy - line.uy) + length(line.ux, line.uy)
        way = (pace + pull * wait) * wait
        for j, other in enumerate(run.discs):
            its = ZERO if other.m is None else swing * above(1 / root(other.m)) * wait
            room = above(disc.r + other.r) + way + its
            if j != i and below((disc.x - other.x) ** 2 + (disc.y - other.y) ** 2) <= room**2:
                return False
        if isinstance(line, Bar) and below(to_ends(line, disc)) <= way:
            return False
        if any(below(to_rim(disc, rim)) <= way for rim in run.rims):
            return False
        others = ((other, apart(other, disc)) for k, other in enumerate(run.lines) if k != own)
        return all(below(h) > above(disc.r) + way + length(line.ux, line.uy) * wait for line, h in others)

    def _squeezed(self, i: int, k: int) -> Stop | None:
        """Whether a circle that has bounced on a wall surely bounces between two that close until it has no room."""
        run, squeeze, count = self.run, self.closing.get(i), len(self.run.discs)
        if squeeze is None or k - count not in squeeze.walls:
            self.since.pop(i, None)
            return None
        now = float(quantity(run.now))
        first = self.since.setdefault(i, now)
        soon = (float(squeeze.time) - now) * SQUEEZED <= now - first
        within = run.until is None or run.until >= squeeze.time
        return self._crush(squeeze) if soon and within and self._is_alone(squeeze) else None

    def _is_alone(self, squeeze: Squeeze) -> bool:
        """Whether, of those between two walls, none can meet another, or a third wall, by when they leave no room."""
        run, walls = self.run, [self.run.lines[wall] for wall in squeeze.walls]
        wait, own = above(squeeze.time.sympy() - run.now), run.discs[squeeze.circle]
        ux, uy = direction(walls[0])
        sides = [sign(height(line, own)) for line in walls]
        among = {
            i: d for i, d in enumerate(run.discs) if d.m is None or [sign(height(line, d)) for line in walls] == sides
        }
        movers = {i: disc for i, disc in among.items() if disc.m is not None}
        if any(self.closing[i].time < squeeze.time for i in movers):
            return False
        fall = above(abs(normal(ux * run.g[0] + uy * run.g[1]))) * wait / 2
        drift = dict.fromkeys(among, ZERO)
        drift |= {i: (above(abs(normal(ux * d.vx + uy * d.vy))) + fall) * wait for i, d in movers.items()}
        for i, j in combinations(among, 2):
            a, b = among[i], among[j]
            between = below(abs(normal(ux * (a.x - b.x) + uy * (a.y - b.y))))
            if (i in movers or j in movers) and between <= above(a.r + b.r) + drift[i] + drift[j]:
                return False
        room = above(sum((abs(height(line, own)) for line in walls), ZERO))
        if run.scene.gravity is not None and run.rims:
            return False
        for number, line in enumerate(run.lines):
            along = across = Integer(1)  # an arc is met in any direction
            if not isinstance(line, Bow):
                wx, wy = direction(line)
                along, across = above(abs(normal(ux * wy - uy * wx))), above(abs(normal(ux * wx + uy * wy)))
            moved = room * across + length(line.ux, line.uy) * wait
            if number not in squeeze.walls and any(
                below(apart(line, d)) <= above(d.r) + drift[i] * along + moved for i, d in movers.items()
            ):
                return False
        return True

    def _crush(self, squeeze: Squeeze) -> Stop:
        run, count = self.run, len(self.run.discs)
        run.ending = squeeze.time.sympy()
        who, (one, other) = run.names[squeeze.circle], (run.names[count + wall] for wall in squeeze.walls)
        return _stop(StopReason.CRUSHED, f"{who} between {one} and {other} at {float(squeeze.time):.12g}")
