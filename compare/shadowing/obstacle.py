"""Whether a shadow is found: proved distances from a run, or what stands in the way."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from itertools import pairwise
from math import exp2, hypot, inf, nextafter, sqrt
from typing import TYPE_CHECKING, Any, NamedTuple

from flint import arb

from ...exact.exact_motion import motion_of
from ...exact.numbers import ball
from ...exact.numbers.ball import known_ball
from ...scenarios.trajectory import StopReason
from ..tangent.impacts import moving
from .pseudo_orbit import in_the_frame

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory
    from .pseudo_orbit import Indices, OrbitRecord, Refined

BITS = 128
"""Accuracy of the certified run's numbers in the bounds: far beyond the doubles that are told."""


class FlightAfter(NamedTuple):
    """A circle's flight after a contact: the contact's instant, and x, y at clock t with velocity vx, vy."""

    instant: arb
    t: arb
    x: arb
    y: arb
    vx: arb
    vy: arb

    def place(self, time: arb) -> tuple[arb, arb]:
        """Where the line of the flight is at a time."""
        return self.x + self.vx * (time - self.t), self.y + self.vy * (time - self.t)


@dataclass(frozen=True)
class Distance:
    """Upper bounds, proved.

    Attributes:
        position: between the two places of a circle, at any time from 0 until one of the runs has its last contact.
        velocity: between its two velocities, after any contact that both have had.
        time: between the two times of a contact.
        circle: the one that is farthest.
    """

    position: float
    velocity: float
    time: float
    circle: str


@dataclass(frozen=True)
class StartDistance:
    """How far one start is from another: upper bounds, proved, over all circles.

    Attributes:
        position, velocity: of a circle.
    """

    position: float
    velocity: float


def distance(record: OrbitRecord, certified: Trajectory) -> Distance | None:
    """The distance of an engine's run from a certified run in which each circle has the same contacts in order.

    Both fly straight between contacts, under gravity in the frame that falls, which shifts both alike: so a circle is
    farthest at a contact of the one or of the other, and velocities are compared as they are at one moment. Where each
    contact comes in both before the circle's next one does in either, which is checked, these two moments, on the
    flights before and after it, bound all others.

    Returns:
        None where the contacts of one circle are closer to each other than the two runs are, or where the certified
        run tells of other changes of velocity than its contacts.
    """
    free = list(record.flights)
    flights = _flights(certified, record)
    if flights is None:
        return None
    position = velocity = time = 0.0
    circle = ""
    with ball.precision(BITS + 64):
        for i in free:
            mine = [_fallen(certified.scene, FlightAfter(arb(f[0]), *map(arb, f))) for f in record.flights[i]]
            theirs = flights[i][: len(mine)]
            ends: list[tuple[arb, arb]] = [(f.instant, g.instant) for f, g in zip(mine, theirs, strict=True)]
            for (a, b), (c, d) in pairwise(ends):
                if not all(first < second for first in (a, b) for second in (c, d)):
                    return None
            for k, (first, second) in enumerate(ends):
                time = max(time, _upper(first - second))
                f, g = mine[k], theirs[k]
                velocity = max(velocity, _length(f.vx - g.vx, f.vy - g.vy))
                for moment in (first, second):
                    for one in mine[max(k - 1, 0) : k + 1]:
                        for other in theirs[max(k - 1, 0) : k + 1]:
                            (ax, ay), (bx, by) = one.place(moment), other.place(moment)
                            apart = _length(ax - bx, ay - by)
                            if apart > position:
                                position, circle = apart, str(certified.scene.circles[i].id)
            last = arb(record.times[-1])
            (ax, ay), (bx, by) = mine[-1].place(last), theirs[-1].place(last)
            apart = _length(ax - bx, ay - by)
            if apart > position:
                position, circle = apart, str(certified.scene.circles[i].id)
    return Distance(position, velocity, time, circle)


def start_distance(one: Scene, other: Scene) -> StartDistance:
    """How far the starts of two scenes of the same circles are from each other."""
    position = velocity = 0.0
    with ball.precision(BITS + 64):
        for a, b in zip(one.circles, other.circles, strict=True):
            dx, dy, dvx, dvy = (
                ball.constant(p - q) for p, q in ((a.x, b.x), (a.y, b.y), (a.vx, b.vx), (a.vy, b.vy))
            )  # fmt: skip
            position, velocity = max(position, _length(dx, dy)), max(velocity, _length(dvx, dvy))
    return StartDistance(position, velocity)


def _flights(certified: Trajectory, record: OrbitRecord) -> dict[int, list[FlightAfter]] | None:
    """The flights of a certified run, from its knots; None unless there is one for each contact."""
    motion = motion_of(certified)
    assert motion is not None
    knots = motion.knots
    place = {name: k for k, name in enumerate(certified.scene.ids)}
    instants: dict[int, list[arb]] = {i: [arb(0)] for i in record.flights}
    for event in certified.events:
        value: Any = event.time
        near = None
        for name in {name for pair in event.impulses for name in pair}:
            if place[name] in instants:
                near = value.ball(BITS) if near is None else near
                instants[place[name]].append(near)
    told: dict[int, list[FlightAfter]] = {}
    with ball.precision(BITS + 64):
        for i, times in instants.items():
            if len(times) != len(knots[i]):
                return None
            told[i] = [FlightAfter(when, *(known_ball(number, BITS) for number in knot[:5]))
                       for when, knot in zip(times, knots[i], strict=True)]  # fmt: skip
    return told


def _fallen(scene: Scene, flight: FlightAfter) -> FlightAfter:
    """A true flight in the frame that falls with gravity."""
    if scene.gravity is None:
        return flight
    (instant, t, x, y, vx, vy), (gx, gy) = flight, map(ball.constant, scene.gravity)
    return FlightAfter(instant, t, x - gx * t * t / 2, y - gy * t * t / 2, vx - gx * t, vy - gy * t)


def _upper(value: arb) -> float:
    """A double at or above the size of every number in a ball."""
    if value.is_zero():
        return 0.0
    return nextafter(float(value.abs_upper()), inf) if value.is_finite() else inf


def _length(x: arb, y: arb) -> float:
    """An upper bound of a vector's length."""
    wide, high = x.abs_upper(), y.abs_upper()
    return _upper(ball.root(wide * wide + high * high))


# ----------------------------------------
# What stands in the way of a shadow, judged by numbers that are told with it.

GRAZING = 1e-12
"""Share of a diameter below which a contact is a graze whatever the corrections: doubles hardly tell it from a miss."""

DRIFT_SHARE = 0.1
"""Share of the largest correction that a drift of energy must account for, to be what stands in the way."""


class Obstacle(Enum):
    """What stands in the way; the value is what a person reads."""

    SIMULTANEOUS = "several contacts at one instant"
    TOUCHING = "circles that touch at the start"
    GRAZE = "a graze"
    ORDER = "contacts too close in time"
    DRIFT = "energy drift"
    GROWING = "too many growing directions"


@dataclass(frozen=True)
class Blocked:
    """Why no shadow was found.

    Attributes:
        obstacle: of which kind.
        event: of the engine's run, where it stands; None where it is not at one event.
        message: in words, with the numbers that it is judged by.
    """

    obstacle: Obstacle
    event: int | None
    message: str


def units(scene: Scene, record: OrbitRecord) -> tuple[float, float]:
    """What lengths and velocities are measured by: the mean diameter, and the root of the mean square at the start.

    Under gravity that is of all velocities that contacts leave.
    """
    sizes = [float(c.r) for k, c in enumerate(scene.circles) if float(c.r) > 0 and k not in scene.ends]
    falls = scene.gravity is not None  # then what starts at rest does not stay so
    known = [flight for flights in record.flights.values() for flight in (flights if falls else flights[:1])]
    squares = [vx**2 + vy**2 for *_, vx, vy in known]
    return (2 * sum(sizes) / len(sizes) if sizes else 1.0), sqrt(sum(squares) / len(squares)) or 1.0


def drift(scene: Scene, record: OrbitRecord) -> float | None:
    """The largest relative change of the energy along an engine's run, the potential with it; None where none is kept.

    Its share is of the largest kinetic energy that is told, or without gravity of that at the start.
    """
    if not scene.elastic or scene.moving_walls:
        return None
    masses = {i: 1 / float(scene.circles[i].inverse_mass) for i in moving(scene)}
    gx, gy = (0.0, 0.0) if scene.gravity is None else map(float, scene.gravity)
    kinetic = {i: [masses[i] * hypot(*f[3:]) ** 2 for f in flights] for i, flights in record.flights.items()}
    energy = {
        i: [own - 2 * masses[i] * (gx * f[1] + gy * f[2]) for own, f in zip(kinetic[i], flights, strict=True)]
        for i, flights in record.flights.items()
    }
    now = {i: of[0] for i, of in energy.items()}
    done, start, worst = dict.fromkeys(now, 0), sum(now.values()), 0.0
    for link in record.links:
        for i in (i for i in link if i in now):
            done[i] += 1
            now[i] = energy[i][done[i]]
        worst = max(worst, abs(sum(now.values()) - start))
    whole = start if scene.gravity is None else sum(max(own) for own in kinetic.values())
    return worst / whole if whole else 0.0


def margin(scene: Scene, record: OrbitRecord, contact: int) -> float | None:
    """By how many diameters two discs would have to be displaced to miss each other; None for a wall."""
    i, j = record.links[contact]
    circles, time = scene.circles, record.times[contact]
    if j >= len(circles):
        return None
    falls = scene.gravity is not None and any(part.sign() for part in scene.gravity)
    if falls and not {i, j} <= record.flights.keys():  # what stands does not, in the frame
        return None
    rows: list[tuple[float, float, float, float]] = []
    for k in (i, j):
        if k not in record.flights:
            ux, uy = map(float, circles[k].drift)
            rows.append((float(circles[k].x) + ux * time, float(circles[k].y) + uy * time, ux, uy))
            continue
        turn = sum(k in link for link in record.links[:contact])
        t, x, y, vx, vy = in_the_frame(scene, record.flights[k][turn])
        rows.append((x + vx * (time - t), y + vy * (time - t), vx, vy))
    dx, dy, vx, vy = (b - a for a, b in zip(*rows, strict=True))
    speed = hypot(vx, vy)
    reach = float(circles[i].r + circles[j].r)
    return (reach - abs(dx * vy - dy * vx) / speed) / units(scene, record)[0] if speed else None


def not_closed(scene: Scene, record: OrbitRecord, found: Refined) -> Blocked:
    """Misfits that do not close.

    By a graze, if the correction is as large as what is left to one, or nothing is left to one; by a drift of energy,
    if it accounts for the corrections; else by growth.
    """
    reach = exp2(max(found.corrections)) if found.corrections else 0.0
    if found.missed is not None:
        shallow = margin(scene, record, found.missed)
        if shallow is not None and shallow <= max(reach, GRAZING):
            asked = f", and corrections of {reach:.2g} are asked for: the orbit that is sought passes them by"
            unasked = ", and by the flights that the engine reports they do miss"
            return _shallow(scene, record, found.missed, shallow, asked if found.corrections else unasked)
    for contact in range(len(record.links)):
        depth = margin(scene, record, contact)
        if depth is not None and abs(depth) <= GRAZING:
            return _shallow(scene, record, contact, depth, ", where errors grow without bound")
    if not found.misfits:
        return Blocked(Obstacle.GROWING, None, "the engine's run itself does not lead from one contact to the next")
    told = (
        f"misfits of up to {exp2(found.misfits[0]):.2g} of a diameter ask for corrections of {reach:.2g} and do not "
        f"close (after {len(found.misfits)} rounds they are {exp2(found.misfits[-1]):.2g})"
    )
    # A true orbit keeps its energy. Where the engine's drifts by a share d, speeds differ by d/2, and so do paths, of
    # length speed times time.
    length, speed = units(scene, record)
    lost = drift(scene, record)
    if lost is not None and lost / 2 * max(speed * record.times[-1] / length, 1.0) > DRIFT_SHARE * reach:
        message = f"the engine's energy drifts by {lost:.2g} of itself, which no true orbit does; {told}"
        return Blocked(Obstacle.DRIFT, None, message)
    growing = "errors grow in directions in which nothing draws them back"
    though = "" if lost is None else f"though the energy drifts by {lost:.2g} only: "
    return Blocked(Obstacle.GROWING, None, f"{told}, {though}{growing}")


def _shallow(scene: Scene, record: OrbitRecord, contact: int, depth: float, why: str) -> Blocked:
    """A contact that is hardly one."""
    event, (one, other) = record.events[contact], (scene.ids[k] for k in record.links[contact])
    told = f"{one} and {other} meet {max(depth, 0.0):.2g} of a diameter from missing each other"
    return Blocked(Obstacle.GRAZE, event, f"event {event}: {told}{why}")


TO_THE_END = frozenset({StopReason.EVENTS, StopReason.HORIZON, StopReason.QUIET})
"""Stops after which it is known that a circle meets nothing more, or what was asked for is over."""


def other_history(scene: Scene, record: OrbitRecord, run: Trajectory, theirs: OrbitRecord) -> Blocked | None:
    """Where a true history has another contact than an engine's; None if each circle has the same ones, in order.

    Args:
        theirs: the true run as a record, of as many contacts at least.
    """
    if not run.certified:
        message = f"the run of the start that was found is not certified: {run.stop.message}"
        return Blocked(Obstacle.SIMULTANEOUS, None, message)
    wanted, links = record.links, theirs.links[: len(record.links)]
    streams = [{i: [link for link in told if i in link] for i in record.flights} for told in (links, wanted)]
    if streams[0] == streams[1]:
        return None
    for k, link in enumerate(wanted):
        for i in (i for i in link if i in record.flights):
            turn = sum(i in other for other in wanted[:k])
            got = streams[0][i][turn] if turn < len(streams[0][i]) else None
            if got is None and run.stop.reason not in TO_THE_END:
                told = f"the certified run of the start that was found ends after {len(run.events)} events"
                return Blocked(
                    Obstacle.ORDER, record.events[k], f"event {record.events[k]}: {told}, {run.stop.message}"
                )
            if got != link:
                return _parted(scene, record, theirs, k, i, got)
    raise AssertionError("streams that differ have a first difference")


def _parted(
    scene: Scene, record: OrbitRecord, theirs: OrbitRecord, contact: int, i: int, got: Indices | None
) -> Blocked:
    """Circle i has a contact in the engine's run, and another one, or none, in the true one."""
    ids, link, event = scene.ids, record.links[contact], record.events[contact]
    turn = sum(i in other for other in record.links[:contact])
    place = [k for k, other in enumerate(theirs.links) if i in other][turn : turn + 1]
    depths = [margin(scene, record, contact), *(margin(scene, theirs, k) for k in place)]
    shallow = min((depth for depth in depths if depth is not None), default=None)
    other = "meets nothing more" if got is None else f"meets {ids[got[got[0] == i]]}"
    told = (
        f"event {event}: {ids[i]} meets {ids[link[link[0] == i]]} in the engine's run; in the true history of the "
        f"start that was found it {other}"
    )
    if shallow is not None and shallow < SHALLOW:
        return Blocked(Obstacle.GRAZE, event, f"{told}; a graze, {shallow:.2g} of a diameter from a miss")
    return Blocked(Obstacle.ORDER, event, told)


SHALLOW = 0.05
"""Share of a diameter below which a contact that only one history has is called a graze."""
