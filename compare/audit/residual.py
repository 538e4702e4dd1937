"""A residual: what a step misses the laws by, its kinds, the units of rounding; overlaps; what walls carry.

The step's own numbers are taken as they are. Honest is mixed forward-backward (Higham, *Accuracy and Stability of
Numerical Algorithms*, 2nd edition 2002, section 1.5): the step is exact for inputs and outputs that are off by a few
units, relatively. docs/audit.md derives the constants.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple, Protocol

from flint import arb

from ...exact.numbers import ball

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory
    from .transcript import Fall, Leg, ReportedFlight, WallInBalls

AUDIT_BITS = 256
"""Bits in which residuals are taken: sums and products of doubles whose sizes are within 2**100 of each other are exact
or nearly so, and what is not is in the enclosure."""

FLIGHT_UNITS = 6.0
"""x + v (t - t0): a difference, a product, a sum, and telling place and time. An engine may fly on every circle at
every event, so that each event between adds as many. Measured over 17 formulations: at most 1.7."""

ROOT_UNITS = 16.0
"""The quadratic's coefficients, discriminant, root and quotient; docs/audit.md has the three usual formulas.
Measured: at most 2.7 of the sizes that are taken here."""

IMPULSE_UNITS = 16.0
"""The normal, the approach, the share of the masses, the product and the sum, by impulse along the line of centres, in
the frame of the centre of mass, or by angles. Measured: at most 3.9."""

UNDERFLOW = {2.0**-11: 2.0**-24, 2.0**-24: 2.0**-149, 2.0**-53: 2.0**-1074}
"""The least positive number of the formats of IEEE 754, by their units; others have no least number."""

UNDERFLOWS = 8
"""Products of fourth order that a discriminant has, each of which may underflow."""

LEAST = 2.0**-1070
"""Below the normal doubles a rounding is no longer relative: 16 of their least differences are granted."""


class Residual(NamedTuple):
    """One thing that a step misses, and what rounding may make of it.

    Attributes:
        kind: one of `KINDS`.
        bodies: the circle, or the two that meet, by place in `scene.ids`.
        size: a lower bound of what is missed: a length, or a speed.
        room: what rounding may make of it.
    """

    kind: str
    bodies: tuple[int, ...]
    size: float
    room: float

    @property
    def broken(self) -> bool:
        """Whether it is more than rounding."""
        return self.size > self.room


KINDS = (
    "start", "flight", "gap", "impulse", "energy", "bystander", "reversal", "depth", "support", "capture", "phantom",
)  # fmt: skip
"""The scene's start; the place flown to; the gap at the time of a contact; an impulse, in direction and strength; the
energy of several contacts; a velocity that changes without a contact; the reversal; a contact that is missed; a circle
that is carried where no wall can do so; a contact of a circle that a pocket has captured; a contact whose impulse is
below rounding, which breaks no law."""


FLIGHTS = ("damping", "acceleration", "lag", "correction")
"""Kinds of description that are of flights."""


EXPLAINS = {
    "restitution": {"impulse", "energy"},
    "mass": {"impulse", "energy"},
    "friction": {"impulse", "energy"},
    "once": {"impulse"},
    "radius": {"gap", "depth"},
    "wall": {"gap", "depth"},
    "gap": {"gap", "depth"},
    **{kind: {"flight", "impulse", "energy", "gap", "depth"} for kind in FLIGHTS},
}
"""Of each kind of description, the kinds of steps that miss a law for what it says."""


@dataclass(frozen=True, slots=True)
class Violation:
    """A step that misses a law by more than rounding.

    Attributes:
        kind: one of `residual.KINDS`.
        event: the event, by the engine's own count; of two that fly into each other, how many events came before.
        time: when.
        bodies: who takes part, by id.
        size, room: what is missed, and what rounding may make of it: a length, or a speed.
    """

    kind: str
    event: int
    time: float
    bodies: tuple[str, ...]
    size: float
    room: float

    def __str__(self) -> str:
        """What is wrong with the step, and by how much.

        >>> print(Violation("gap", 3, 1.5, ("a", "b"), 1e-6, 1e-15))
        event 3 (t = 1.5): a and b are 1e-06 from touching as they collide; rounding may make it 1e-15
        """
        who, size = " and ".join(self.bodies), f"{self.size:.3g}"
        what = {
            "start": f"{who} begins {size} from where, or as fast as, the scene says",
            "flight": f"{who} is {size} from where it flew to",
            "gap": f"{who} are {size} from touching as they collide",
            "impulse": f"the impulse of {who} leaves a velocity {size} off the law's",
            "energy": f"the energy of those that {who} collide with is {size} off the law's",
            "bystander": f"the velocity of {who} changes by {size} without a contact",
            "reversal": f"the velocity of {who} is {size} from its negative at the reversal",
            "depth": f"{who} fly {size} into each other, and do not collide",
            "support": f"{who} are {size} from touching as the one is carried by the other",
            "capture": f"{who} has come {size} within the rim of a pocket that captures, and meets something still",
        }[self.kind]
        when = f"event {self.event} (t = {self.time:.9g})" if self.kind != "depth" else f"at t = {self.time:.9g}"
        return f"{when}: {what}; rounding may make it {self.room:.3g}"


@dataclass(frozen=True)
class Defect:
    """One kind of defect of an engine of steps.

    Attributes:
        kind: `impulse`, `integrator`, `lateness`, `correction`, `several`, `bystander`, `missed`, `tunnelling`,
            `iterations`.
        size: at the run's own step: a share of the impulse, a time, a length, or how many.
        order: with which power of the step it falls; None where that is not known.
        finest: its size at the finest step that was run.
        step: that step.
        of_step: whether it is of the step; None where that cannot be told.
    """

    kind: str
    size: float
    order: float | None = None
    finest: float = math.nan
    step: float = math.nan
    of_step: bool | None = None


SAME_END = 2.0**-20  # of a step: what is no farther before an end of one is at it


class Passage(NamedTuple):
    """A depth to which two come, and when.

    Attributes:
        time: when they are deepest; where that is never, when the run ends.
        residual: of the kind `depth`: how much deeper than at the start of their flights.
        began: when their flights began.
        enter: when they begin to overlap, or when their flights begin, if they do then.
        leave: when the overlap is over, where it begins and ends in these flights; infinite where it does not.
        anew: under gravity, when they begin to overlap, where they did not before by more than rounding; else infinite.
    """

    time: float
    residual: Residual
    began: float
    enter: float = -math.inf
    leave: float = math.inf
    anew: float = math.inf

    @property
    def over(self) -> float:
        """When the overlap is over, as far as is known."""
        return self.leave if math.isfinite(self.leave) else self.time

    @property
    def deepest(self) -> float:
        """Up to when they come nearer: from then on there is nothing to push at."""
        return self.time if self.enter < self.time <= self.over else (self.enter + self.over) / 2


def falls_through(found: Sequence[Passage], late: float, slow: float) -> list[Passage]:
    """Overlaps that go on, flight after flight, for longer than an engine of steps takes to see one.

    Each flight may be one step, and the shorter that is, the less deep two come in it: what tells is how long they
    fall. Two that overlap as it begins may rest in each other, and so may those that come nearer no faster than `slow`:
    gravity adds as much to a speed before a push that comes late.

    Args:
        late: for how long an overlap may not be seen.

    Returns:
        For each, what is known as soon as it has gone on for that long, and when it is over.
    """
    lasted: dict[tuple[int, ...], tuple[Passage, float, int]] = {}
    told: list[Passage] = []
    for p in sorted(found, key=lambda passage: (passage.began, passage.time)):
        bodies, begin = p.residual.bodies, max(p.began, p.enter)
        last, fast, place = lasted.pop(bodies, (None, 0.0, -1))
        if last is not None and p.began <= last.time + SAME_END * late:
            depth = p.residual._replace(size=last.residual.size + p.residual.size)
            whole = p._replace(residual=depth, enter=last.enter, leave=p.time)
        elif math.isfinite(p.anew):
            begin, fast, place = p.anew, 0.0, -1
            whole = p._replace(enter=begin, leave=p.time)
        else:
            continue
        if p.residual.size > slow * (p.time - begin):
            fast += p.time - begin
        if place >= 0:
            told[place] = told[place]._replace(leave=p.time)
        elif fast > late:
            place = len(told)
            told.append(whole)
        lasted[bodies] = whole, fast, place
    return told


NEXT_TO = 4
"""Walls next to a circle of which two may hold it."""


def length_of(x: arb, y: arb) -> float:
    """A lower bound of sqrt(x^2 + y^2); 0 where nothing is known.

    >>> length_of(arb(3), arb(-4))
    5.0
    """
    size = math.hypot(float(x.mid()), float(y.mid())) - float(x.rad()) - float(y.rad())
    return size if size > 0.0 else 0.0


def size_of(x: arb) -> float:
    """A lower bound of |x|; 0 where nothing is known."""
    size = abs(float(x.mid())) - float(x.rad())
    return size if size > 0.0 else 0.0


# -- Pockets that capture.


SAMPLES, ROUNDS = 32, 3
"""Times of a fall at which it is looked whether it is in a pocket, on both sides of a middle, and how often this is
done around the best: any time at which it is in the pocket shows that it has come there."""


class PocketFlights(Protocol):
    """Of the laws of a scene, those of flight: see `residuals.Laws`."""

    scene: Scene
    unit: float
    fall: Fall | None

    def flown_room(self, before: ReportedFlight, after: ReportedFlight, events: int, /) -> float: ...


def uncaptured(
    laws: PocketFlights, k: int, before: ReportedFlight, after: ReportedFlight, events: int
) -> Iterator[Residual]:
    """How far within the rim of a pocket a circle has been on a flight that ends at a contact.

    A flight that begins within it is no entry. The smaller root of |d + v t| = R is one of a discriminant with terms
    of |d|^2 v^2 and R^2 v^2: rounded by u, relatively, an engine may take a depth of u (|d|^2 + R^2) / R for none.
    """
    span, gx, gy = after.t - before.t, arb(0), arb(0)
    x, y, vx, vy = before.x, before.y, before.vx, before.vy
    if laws.fall is not None and not before.carried:  # from the straight flight to the same end, back to the fall
        gx, gy, (way, gain) = laws.fall.gx, laws.fall.gy, laws.fall.fallen(span)
        x, y, vx, vy = x - gx * (way - gain * span), y - gy * (way - gain * span), vx - gx * gain, vy - gy * gain
    far = (before.speed + before.fallen + after.speed) * float(span.mid())
    for pocket in laws.scene.pockets:
        px, py, r = ball.constant(pocket.x), ball.constant(pocket.y), ball.constant(pocket.r)

        def depth(t: arb, px: arb = px, py: arb = py, r: arb = r) -> arb:
            dx, dy = x + (vx + gx * t / 2) * t - px, y + (vy + gy * t / 2) * t - py
            return r - (dx * dx + dy * dy).sqrt()

        radius, begin = float(r), float(depth(arb(0)).mid())
        wide = abs(radius - begin) + far
        room = laws.flown_room(before, after, events) + ROOT_UNITS * laws.unit * (wide * (wide / radius) + radius)
        if laws.fall is None:
            square = float((vx * vx + vy * vy).mid())
            nearest = float(((px - x) * vx + (py - y) * vy).mid()) / square if square else 0.0
            deepest = depth(arb(min(max(nearest, 0.0), float(span.mid()))))
        else:
            deepest, around, aside = depth(span), span / 2, span / 2
            for _ in range(ROUNDS):
                times = [around + aside * n / SAMPLES for n in range(-SAMPLES, SAMPLES + 1)]
                times = [t for t in times if 0 <= t <= span]
                around = max(times, key=lambda t: float(depth(t).mid()))
                aside, deepest = aside / SAMPLES, depth(around)
        if begin < -room:
            yield Residual("capture", (k,), size_of(deepest.max(arb(0))), room)


LOOK = 32
"""Ends of steps, after the entry into a pocket, at which it is looked how deep in it a centre is."""


def met_in_pockets(run: Trajectory, step: float, unit: float, late: float) -> Iterator[tuple[Residual, int, float]]:
    """Of an engine of steps: what collides more than `late` steps after one that ended with its centre in a pocket that
    captures; with the event and its time. Under gravity, and past a reversal, the ends of steps are not looked at.
    """
    asked, ids = run.scene.capture and run.scene.gravity is None and run.reversal is None, run.scene.ids
    entered = {entry.circle: float(entry.time) for entry in reversed(run.pocketings)}
    rims = [(float(p.x), float(p.y), float(p.r)) for p in run.scene.pockets]
    for event in run.events if asked else ():
        for name in entered.keys() & {name for pair in event.impulses for name in pair}:
            time, first = float(event.time), math.floor(entered[name] / step) + 1
            ends = [end for n in range(LOOK) if (end := (first + n) * step) + late * step < time]
            places = [(float(told.x), float(told.y)) for told in (run.circle(name, end) for end in ends)]
            deep = max((r - math.hypot(x - px, y - py) for x, y in places for px, py, r in rims), default=0.0)
            most = max(abs(number) for row in (*places, *rims) for number in row)
            yield (
                Residual("capture", (ids.index(name),), max(0.0, deep), 64 * unit * (first + LOOK) * most),
                event.index,
                time,
            )


# -- What a wall carries, or two hold between them.


class Weighted(Protocol):
    """A circle: its radius, in a ball and as a double."""

    @property
    def r(self) -> arb: ...

    @property
    def radius(self) -> float: ...


class Carrying(Protocol):
    """Of the laws of a scene, those of rest: see `residuals.Laws`."""

    scene: Scene
    unit: float
    count: int
    change: arb
    fall: Fall | None
    holds: Callable[[int, int, int], bool]

    @property
    def supports(self) -> Sequence[Sequence[int]]: ...

    @property
    def things(self) -> Sequence[Weighted]: ...

    def line(self, circle: int, wall: int, /) -> WallInBalls: ...


def along(laws: Carrying, k: int, flight: ReportedFlight) -> ReportedFlight:
    """How a circle would go on from the beginning of a flight if the wall next to it carried it, or two held it."""
    gaps = {wall: _gap(laws, k, wall, flight.x, flight.y) for wall in laws.supports[k]}
    wall = min(gaps, key=lambda place: abs(float(gaps[place].mid())), default=None)
    cradle = _cradle(laws, k, flight.x, flight.y, flight.time, flight.place)
    if cradle is not None:
        one, other = (laws.line(k, place) for place in cradle)
        a, b = (_gap(laws, k, place, flight.x, flight.y) for place in cradle)
        if wall is None or max(abs(float(gap.mid())) for gap in (a, b)) < abs(float(gaps[wall].mid())):
            turn = one.nx * other.ny - one.ny * other.nx
            x, y = flight.x + (a * other.ny - b * one.ny) / turn, flight.y + (b * one.nx - a * other.nx) / turn
            zero = arb(0)
            return flight._replace(x=x, y=y, vx=zero, vy=zero, fallen=flight.speed, carried=True, bounces=False)
    if wall is None:
        return flight
    line, gap = laws.line(k, wall), gaps[wall]
    closing = line.nears(flight.vx, flight.vy)
    x, y, vx, vy = (
        flight.x + line.nx * gap,
        flight.y + line.ny * gap,
        flight.vx - line.nx * closing,
        flight.vy - line.ny * closing,
    )
    return flight._replace(x=x, y=y, vx=vx, vy=vy, fallen=flight.speed, carried=True, bounces=False)


def _gap(laws: Carrying, k: int, wall: int, x: arb, y: arb) -> arb:
    line = laws.line(k, wall)
    return line.nx * (line.x - x) + line.ny * (line.y - y) - laws.things[k].r


def _cradle(laws: Carrying, k: int, x: arb, y: arb, time: float, away: float) -> tuple[int, int] | None:
    """Two walls that hold a circle between them, of those next to it; None where none do."""
    rows = [_beside(laws, k, wall, x, y, time, away) for wall in range(len(laws.scene.walls))]
    order = sorted(range(len(rows)), key=lambda wall: rows[wall].size - rows[wall].room)[:NEXT_TO]
    pairs = combinations(order, 2) if laws.scene.settle else ()
    return next((pair for pair in pairs if laws.holds(k, *pair)), None)


def _beside(
    laws: Carrying, k: int, wall: int, x: arb, y: arb, time: float, away: float, speed: float = 0.0, began: float = 0.0
) -> Residual:
    """How far a circle at a place is from touching a wall, or a face between its ends."""
    line, radius = laws.line(k, wall), laws.things[k].radius
    gap = _gap(laws, k, wall, x, y)
    along = float((line.nx * (y - line.y) - line.ny * (x - line.x)).mid())
    beside = max(0.0, -along, along - line.length) if wall in laws.scene.faces else 0.0
    sizes = (away + speed * (time - began) + speed * time) + line.size * (1 + abs(along) / line.length)
    room = ROOT_UNITS * laws.unit * (sizes + radius) + LEAST
    return Residual("support", (k, laws.count + wall), math.hypot(size_of(gap), beside), room)


def unsupported(laws: Carrying, leg: Leg) -> tuple[float, Residual] | None:
    """How far a circle that a wall carries is from any that can, and when it is.

    That is one across gravity, to which gravity pulls it; or two that hold it between them. Looked at is where its
    flight begins and ends; of one without an end, where it has gone its own distance. A face carries between its ends
    alone.
    """
    k = leg.circle
    away = math.hypot(leg.x, leg.y) + laws.things[k].radius
    later = leg.end if leg.end < math.inf else leg.start + (away / leg.speed if leg.speed else 1.0)
    worst: tuple[float, Residual] | None = None
    for time in (leg.start, later):
        nearest = Residual("support", (k,), math.inf, 0.0)
        x, y = (arb(time) - leg.t) * leg.vx + leg.x, (arb(time) - leg.t) * leg.vy + leg.y
        more = leg.apart + leg.turned * (time - leg.t)
        rows = [_beside(laws, k, wall, x, y, time, away, leg.speed, leg.t) for wall in range(len(laws.scene.walls))]
        rows = [row._replace(room=row.room + more) for row in rows]
        for wall in laws.supports[k]:
            nearest = min(nearest, rows[wall], key=lambda row: row.size - row.room)
        if nearest.broken and (pair := _cradle(laws, k, x, y, time, away)) is not None:
            between = max((rows[wall] for wall in pair), key=lambda row: row.size - row.room)
            nearest = min(nearest, between, key=lambda row: row.size - row.room)
        if nearest.broken and (worst is None or nearest.size > worst[1].size):
            worst = time, nearest
    return worst


def rested(laws: Carrying, k: int, flight: ReportedFlight, rest: ReportedFlight, after: ReportedFlight) -> Residual:
    """How far off the time is at which infinitely many bounces end, (2 v / a) / (1 - e) after the last one told.

    It is told as the way that the circle goes in it with the speed v after that; a is the pull.
    """
    assert laws.fall is not None
    ux, uy = flight.vx - rest.vx, flight.vy - rest.vy
    speed, lost = (ux * ux + uy * uy).sqrt(), 2 - laws.change
    per_speed = 2 / (laws.fall.pull * lost)
    size = size_of((after.t - flight.t - speed * per_speed) * speed)
    times = after.time + flight.time + flight.speed * float(per_speed.mid())
    return Residual("support", (k,), size, ROOT_UNITS * laws.unit * times * float(speed.mid()) + LEAST)


# -- Numbers of a description, in words.


def digits_off(value: float, law: float) -> str:
    """A number to three digits of what it differs from the law by.

    >>> digits_off(0.98, 1.0), digits_off(0.9990000001, 1.0), digits_off(1.0000012, 1.0)
    ('0.98', '0.999', '1.0000012')
    """
    off = abs(value - law)
    digits = max(0, 2 - math.floor(math.log10(off))) if off else 0
    text = f"{value:.{min(digits, 17)}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def digits_known(ratio: float, room: float) -> str:
    """A ratio in four digits, where that is one number in its room and the only one; else in all that it is known to.

    >>> digits_known(1.6, 1e-13), digits_known(1.000001, 1e-13), digits_known(1.23456789, 1e-3)
    ('1.6', '1.000001', '1.23')
    """
    few = f"{ratio:.4g}"
    only = abs(float(few) / ratio - 1) <= room < 5e-5
    return few if only or not room else f"{ratio:.{min(17, max(1, math.floor(-math.log10(room))))}g}"


def percent(share: float) -> str:
    """A share that is less, or more, in words.

    >>> percent(0.03), percent(-0.5)
    ('3 % less', '50 % more')
    """
    return f"{abs(100 * share):.3g} % {'less' if share > 0 else 'more'}"
