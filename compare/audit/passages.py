"""Contacts that a run misses: circles that fly into each other, or across a wall or an arc, in its own flights."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from heapq import heappop, heappush
from typing import TYPE_CHECKING

from flint import arb

from ...exact.replay.landings import first_zero_after, told_falling_zero
from ...exact.replay.round_falls import RoundFall
from .residual import FLIGHT_UNITS, LEAST, ROOT_UNITS, SAME_END, Passage, Residual, size_of, unsupported
from .residuals import SideInBalls
from .transcript import Leg, WallInBalls, legs_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from .residuals import Laws
    from .transcript import Fall

FEW = 48
"""Circles up to which every pair is looked at at once; beyond it, those whose flights share a cell. Under gravity all
are, as flights are no straight ways through cells."""

MOST_CELLS = 4096
"""Cells of one flight; one that crosses more is taken to be everywhere."""

CLOSE = 2.0**-46
"""Share of all sizes by which doubles may be wrong about how near two come: what is nearer is enclosed."""


def passes_between(enter: float, deepest: float, step: float, base: float) -> bool:
    """Whether two come nearer between two ends of steps, of which none can see it, or for no time.

    One that ends as a flight does is seen with what ends that, which may take all of the approach.

    Args:
        base: from when steps are counted: the start, or the reversal.

    >>> passes_between(0.3, 0.6, 1.0, 0.0), passes_between(0.3, 1.6, 1.0, 0.0), passes_between(0.3, 1.0, 1.0, 0.0)
    (True, False, True)
    """
    if not math.isfinite(deepest):
        return False
    return deepest <= enter or (math.ceil((deepest - base) / step - SAME_END) - 1 + SAME_END) * step + base < enter


def passages(
    laws: Laws,
    flights: Sequence[Sequence[Sequence[float]]],
    end: float,
    gone: Mapping[int, float],
    carried: Mapping[int, Collection[int]],
) -> Iterator[Passage]:
    """Every depth that is more than rounding, pair by pair and flight by flight.

    What two overlap by as their flights begin has come to be before, and is told there.

    Args:
        flights: for each circle (t, x, y, vx, vy), by ascending time.
        end: up to when the last of each goes on; infinite where nothing is left to happen.
        gone: when circles leave play.
        carried: by circle, the places of its flights along which a wall carries it.
    """
    legs = [
        leg for k, row in enumerate(flights) for leg in legs_of(k, row, min(end, gone.get(k, end)), carried.get(k, ()))
    ]
    legs.sort(key=lambda leg: leg.start)
    near = _All(laws) if laws.count <= FEW or laws.fall is not None else _Cells(laws, legs)
    for leg in legs:
        found: list[Passage | None] = []
        fall = laws.fall if laws.moving[leg.circle] and not leg.carried else None
        if laws.moving[leg.circle]:
            for wall in range(len(laws.scene.walls)):
                if fall is None:
                    found.append(_across(laws, leg, wall))
                else:
                    found.append((_fallen_into if wall in laws.scene.faces else _fallen_across)(laws, leg, wall, fall))
            found += [
                _into_side(laws, leg, side) if fall is None else _fallen_to_side(laws, leg, side, fall)
                for side in range(len(laws.sides))
            ]
        if leg.carried:
            off = unsupported(laws, leg)
            found.append(None if off is None else Passage(*off, leg.start))
        for other in near.beside(leg):
            if not (laws.moving[leg.circle] or laws.moving[other.circle]):
                continue
            also = laws.fall if laws.moving[other.circle] and not other.carried else None
            if fall is not None and also is not None:
                # two fall alike: from where the later flight begins, they pass each other on a straight way
                start = max(leg.start, other.start)
                found.append(_between(laws, _from(leg, start, fall), _from(other, start, fall)))
            elif fall is not None:
                found.append(_fallen_onto(laws, leg, other, fall))
            else:
                found.append(_between(laws, leg, other) if also is None else _fallen_onto(laws, other, leg, also))
        yield from (passage for passage in found if passage is not None)


def _from(leg: Leg, start: float, fall: Fall) -> Leg:
    """The straight flight beside which a fall goes on from a time: each has its place and velocity then."""
    x, y, vx, vy = _fallen(leg, start, fall)
    apart = leg.apart + leg.turned * (start - leg.t) if leg.apart else 0.0
    x0, y0, ux, uy = (float(value.mid()) for value in (x, y, vx, vy))
    return Leg(leg.circle, start, leg.end, start, x0, y0, ux, uy, apart, leg.turned)


def _fallen(leg: Leg, time: float, fall: Fall) -> tuple[arb, arb, arb, arb]:
    """(x, y, vx, vy) at a time."""
    span = arb(time) - leg.t
    way, gain = fall.fallen(span)
    return (
        arb(leg.vx) * span + leg.x + fall.gx * way,
        arb(leg.vy) * span + leg.y + fall.gy * way,
        fall.gx * gain + leg.vx,
        fall.gy * gain + leg.vy,
    )


def _fallen_across(laws: Laws, leg: Leg, wall: int, fall: Fall) -> Passage | None:
    """How far across a wall a circle falls: at the end of its flight, or where its way turns back."""
    line, r = laws.line(leg.circle, wall).at(arb(leg.start)), laws.things[leg.circle].r
    pull = float((line.nx * fall.gx + line.ny * fall.gy).mid())
    closing = float(line.nears(leg.vx, leg.vy).mid())
    first = line.nx * (line.x - leg.x) + line.ny * (line.y - leg.y) - r
    if leg.end < math.inf:
        times = [leg.end]
    elif pull > 0.0 or (pull == 0.0 < closing):  # for ever: at twice the time to the wall it is beyond it
        times = [leg.start + 2 * _wait(max(0.0, float(first.mid())), closing, pull) + 1.0]
    else:
        times = []
    if pull < 0.0 < closing:
        turn = leg.start - closing / pull
        if turn < leg.end:
            times.append(fall.step * math.floor((turn - leg.t) / fall.step) + leg.t if fall.step else turn)
    deepest: Passage | None = None
    for time in times:
        x, y, vx, vy = _fallen(leg, time, fall)
        there = laws.line(leg.circle, wall).at(arb(time))
        then = there.nx * (there.x - x) + there.ny * (there.y - y) - r
        deeper = (first.min(arb(0)) - then).mid()
        size = size_of(deeper) if deeper > 0 else 0.0
        speed = max(leg.speed, math.hypot(float(vx.mid()), float(vy.mid()))) + line.drift
        away = math.hypot(leg.x - float(line.x), leg.y - float(line.y)) + speed * (time - leg.start)
        sizes = math.hypot(leg.x, leg.y) + speed * time + line.size * (1 + away / line.length)
        steps = 1.0 + (time - leg.t) / fall.step if fall.step else 1.0
        room = ROOT_UNITS * laws.unit * steps * (sizes + laws.things[leg.circle].radius) + LEAST
        room += leg.apart + leg.turned * (time - leg.t) if leg.apart else 0.0
        if size > room and (deepest is None or size > deepest.residual.size):
            residual = Residual("depth", (leg.circle, laws.count + wall), size, room)
            gap = float(first.mid())
            anew = leg.start + _wait(max(0.0, gap), closing, pull) if gap >= -room else math.inf
            deepest = Passage(time, residual, leg.start, anew=anew)
    return deepest


def _wait(gap: float, closing: float, pull: float) -> float:
    """How long a fall takes to a line that it comes to."""
    root = math.sqrt(max(0.0, closing * closing + 2 * pull * gap))
    return 2 * gap / (closing + root) if closing > 0.0 else (root - closing) / pull if pull > 0.0 else 0.0


def _as_fallen(leg: Leg, start: float, fall: Fall) -> tuple[float, float, float, float]:
    """(x, y, vx, vy) at a time, of the parabola that is the flight; of an engine of steps, of one beside it."""
    x, y, vx, vy = (float(value.mid()) for value in _fallen(leg, start, fall))
    late = fall.step * (fall.ahead - 0.5)
    return x, y, vx + late * float(fall.gx), vy + late * float(fall.gy)


def _slid(leg: Leg, time: float, x: arb | float, y: arb | float) -> tuple[arb, arb]:
    """How far from a place a circle is at a time that does not fall."""
    span = arb(time) - leg.t
    return span * leg.vx + leg.x - x, span * leg.vy + leg.y - y


def _fallen_onto(laws: Laws, leg: Leg, stands: Leg, fall: Fall) -> Passage | None:
    """How deep a circle falls into one that does not: where it is nearest, or at the end of its flight.

    Each time that the two come to overlap is looked at, up to one that is deeper than rounding.
    """
    start, end = max(leg.start, stands.start), min(leg.end, stands.end)
    wide = laws.things[leg.circle].radius + laws.things[stands.circle].radius
    if end <= start or not wide:
        return None
    x, y, vx, vy = _as_fallen(leg, start, fall)
    dx, dy = (float(value.mid()) for value in _slid(stands, start, x, y))
    begun = RoundFall(dx, dy, stands.vx - vx, stands.vy - vy, float(fall.gx) / 2, float(fall.gy) / 2, wide)
    since, now, turned = 0.0, begun, False
    overlaps = begun.gap() <= 0.0
    while True:
        leaves = turned or now.approach() >= 0.0  # where it is nearest, rounding has it come nearer or not
        if overlaps and leaves:
            out = told_falling_zero([-c for c in now.polynomial(False)]) if now.gap() < 0.0 else 0.0
            if out is None:
                return None
            since, now = since + out, now.after(out)
        if not overlaps or leaves:
            wait = told_falling_zero(now.polynomial(overlaps))
            if wait is None or not start + since + wait < end:
                return None
            since, now = since + wait, now.after(wait)
        _, *slopes = now.polynomial(False)
        nearest = told_falling_zero([-k * c for k, c in enumerate(slopes, 1)])  # where the gap falls no more
        if nearest is None:
            return None
        enter, time = start + since, min(start + since + nearest, end)
        since, now, overlaps, turned = since + nearest, now.after(nearest), True, True
        out = told_falling_zero([-c for c in now.polynomial(False)]) if now.gap() < 0.0 else 0.0
        leave = math.inf if out is None or not start < enter or not start + since + out < end else start + since + out
        found = _fallen_deep(laws, leg, stands, fall, start, time)
        if found is not None:
            return Passage(time, found, start, enter, leave, enter if begun.gap() >= -found.room else math.inf)
        if not start + since < end:
            return None


def _fallen_deep(laws: Laws, leg: Leg, stands: Leg, fall: Fall, start: float, time: float) -> Residual | None:
    """The same, enclosed: by how much more than at the start the two overlap then; None: by no more than rounding."""
    one, other = laws.things[leg.circle], laws.things[stands.circle]
    gaps: list[arb] = []
    fastest = leg.speed
    for moment in (start, time):
        x, y, vx, vy = _fallen(leg, moment, fall)
        dx, dy = _slid(stands, moment, x, y)
        gaps.append((dx * dx + dy * dy).sqrt() - one.r - other.r)
        fastest = max(fastest, math.hypot(float(vx.mid()), float(vy.mid())) + stands.speed)
    first, then = gaps
    deeper = (first.min(arb(0)) - then).mid()
    size, wide = size_of(deeper) if deeper > 0 else 0.0, one.radius + other.radius
    far = float(first.mid()) + wide + 2 * fastest * (time - start)
    sizes = far + math.hypot(leg.x, leg.y) + math.hypot(stands.x, stands.y) + 2 * fastest * time
    steps = 1.0 + (time - leg.t) / fall.step if fall.step else 1.0
    room = laws.unit * steps * (2 * FLIGHT_UNITS * sizes + ROOT_UNITS * (far * (far / wide) + wide)) + LEAST
    room += (
        leg.apart
        + leg.turned * (time - leg.t)
        + stands.apart
        + stands.turned * (time - stands.t)
        + laws.underflown(fastest, 0.0)
    )
    pair = (min(leg.circle, stands.circle), max(leg.circle, stands.circle))
    return Residual("depth", pair, size, room) if size > room else None


def _fallen_into(laws: Laws, leg: Leg, wall: int, fall: Fall) -> Passage | None:
    """How far into a face a circle falls that comes to it from before, between its ends by more than rounding.

    Up to where it is out on the other side, beside an end, or turns back. What comes beside an end meets that first.
    """
    line, r = laws.line(leg.circle, wall), laws.things[leg.circle].r
    drift, (leg, line) = line.drift, line.seen(leg)
    radius, start, end = laws.things[leg.circle].radius, leg.start, min(leg.end, 1e300)
    x, y, vx, vy = _as_fallen(leg, start, fall)
    nx, ny, gx, gy = (float(value) for value in (line.nx, line.ny, fall.gx, fall.gy))
    dx, dy = float(line.x) - x, float(line.y) - y
    height, closing, pull = nx * dx + ny * dy, nx * vx + ny * vy, nx * gx + ny * gy
    gap = height - radius
    sizes = math.hypot(x, y) + line.size + radius + leg.speed * abs(leg.start)
    blur = max(CLOSE, ROOT_UNITS * laws.unit) * sizes + leg.apart
    rise = 0.0 if closing > 0.0 else closing * closing / (2 * pull) if pull > 0.0 and not line.thick else math.inf
    if height + rise <= blur:  # a point on the line, or that grazes it, may be on either side
        return None
    if gap <= 0.0 < closing:
        wait = 0.0
    else:  # the zero at which the gap falls
        if closing * closing + 2 * pull * gap <= 0.0 or (closing <= 0.0 and pull <= 0.0):
            return None
        wait = _wait(gap, closing, pull)
    if not start + wait < end:
        return None
    foot, slide, bend = nx * -dy + ny * dx, nx * vy - ny * vx, (nx * gy - ny * gx) / 2
    along = foot + (slide + bend * wait) * wait
    fast = math.hypot(vx + gx * wait, vy + gy * wait) + leg.speed + drift
    blur = max(CLOSE, ROOT_UNITS * laws.unit) * (sizes + 2 * fast * (start + wait)) + leg.apart + leg.turned * wait
    if not blur < along < line.length - blur:
        return None
    thick = 2 * (radius + line.thick)
    through = first_zero_after(wait, gap + thick, -closing, -pull / 2) if thick else math.inf
    beside = min(first_zero_after(wait, foot, slide, bend), first_zero_after(wait, foot - line.length, slide, bend))
    turn = -closing / pull if pull < 0.0 < closing else math.inf
    time = min(end, start + min(through, beside, turn))
    if fall.step and (whole := fall.step * math.floor((time - leg.t) / fall.step) + leg.t) > start + wait:
        time = whole
    depths: list[arb] = []
    for moment in (start, time):
        px, py, ux, uy = _fallen(leg, moment, fall)
        depths.append(line.nx * (line.x - px) + line.ny * (line.y - py) - r)
        fast = max(fast, math.hypot(float(ux.mid()), float(uy.mid())) + drift)
    in_it = height > 0.0 and 0.0 < foot < line.length  # else it is beside the face, however far below its line
    deeper = ((depths[0].min(arb(0)) if in_it else arb(0)) - depths[1]).mid()
    size = size_of(deeper) if deeper > 0 else 0.0
    steps = 1.0 + (time - leg.t) / fall.step if fall.step else 1.0
    away = math.hypot(dx, dy) + 2 * fast * (time - start)
    room = ROOT_UNITS * laws.unit * steps * (sizes + 2 * fast * time + line.size * (1 + away / line.length)) + LEAST
    room += leg.apart + leg.turned * (time - leg.t) if leg.apart else 0.0
    if size <= room:
        return None
    leave = start + (through if thick else wait)
    residual = Residual("depth", (leg.circle, laws.count + wall), size, room)
    leave = leave if wait > 0.0 and leave < leg.end else math.inf
    return Passage(time, residual, start, start + wait, leave, start + wait if gap >= -room else math.inf)


class _All:
    """Every circle's last flight."""

    def __init__(self, laws: Laws) -> None:
        self._flying: dict[int, Leg] = {}

    def beside(self, leg: Leg) -> list[Leg]:
        """The flights under way that may come near one that begins."""
        found = [other for k, other in self._flying.items() if k != leg.circle and other.end > leg.start]
        self._flying[leg.circle] = leg
        return found


class _Cells:
    """Flights by the cells of a square grid that they cross."""

    def __init__(self, laws: Laws, legs: Sequence[Leg]) -> None:
        widest = max(thing.radius for thing in laws.things)
        ways = sorted(leg.speed * (leg.end - leg.start) for leg in legs if leg.end < math.inf)
        self._cell = max(2 * widest, ways[len(ways) // 2] if ways else 0.0) or 1.0
        self._radii = [thing.radius for thing in laws.things]
        self._in: dict[tuple[int, int], set[Leg]] = {}
        self._everywhere: set[Leg] = set()
        self._ends: list[tuple[float, int, Leg, tuple[tuple[int, int], ...] | None]] = []
        self._all: set[Leg] = set()
        self._serial = 0

    def beside(self, leg: Leg) -> list[Leg]:
        """The flights under way that may come near one that begins."""
        while self._ends and self._ends[0][0] <= leg.start:
            _, _, over, cells = heappop(self._ends)
            self._all.discard(over)
            if cells is None:
                self._everywhere.discard(over)
            else:
                for cell in cells:
                    self._in[cell].discard(over)
        cells = self._crossed(leg)
        if cells is None:
            found = set(self._all)
            self._everywhere.add(leg)
        else:
            found = set(self._everywhere)
            for cell in cells:
                there = self._in.setdefault(cell, set())
                found |= there
                there.add(leg)
        self._all.add(leg)
        if leg.end < math.inf:
            self._serial += 1
            heappush(self._ends, (leg.end, self._serial, leg, cells))
        return [other for other in found if other.circle != leg.circle]

    def _crossed(self, leg: Leg) -> tuple[tuple[int, int], ...] | None:
        """The cells that a circle touches on a flight, and perhaps some beside; None for too many."""
        way, cell, r = leg.speed * (leg.end - leg.start), self._cell, self._radii[leg.circle]
        pieces = way / cell + 1
        if not pieces * (2 + 2 * r / cell) ** 2 <= MOST_CELLS:
            return None
        found: set[tuple[int, int]] = set()
        count = math.ceil(pieces)
        span = (leg.end - leg.start) / count
        for piece in range(count):
            x0, y0 = leg.x + leg.vx * span * piece, leg.y + leg.vy * span * piece
            x1, y1 = x0 + leg.vx * span, y0 + leg.vy * span
            wide = r + CLOSE * (abs(x0) + abs(y0) + way)
            for cx in range(math.floor((min(x0, x1) - wide) / cell), math.floor((max(x0, x1) + wide) / cell) + 1):
                for cy in range(math.floor((min(y0, y1) - wide) / cell), math.floor((max(y0, y1) + wide) / cell) + 1):
                    found.add((cx, cy))
        return tuple(found)


def _between(laws: Laws, leg: Leg, other: Leg) -> Passage | None:
    """How deep two circles fly into each other while both fly straight."""
    start, end = max(leg.start, other.start), min(leg.end, other.end)
    if end <= start:
        return None
    reach = laws.things[leg.circle].radius + laws.things[other.circle].radius
    dx = other.x + other.vx * (start - other.t) - leg.x - leg.vx * (start - leg.t)
    dy = other.y + other.vy * (start - other.t) - leg.y - leg.vy * (start - leg.t)
    vx, vy = other.vx - leg.vx, other.vy - leg.vy
    towards = dx * vx + dy * vy
    if towards >= 0.0 or not reach:
        return None
    square = vx * vx + vy * vy
    if not square:
        return None
    wait = -towards / square
    if wait < end - start:
        near, time = abs(dx * vy - dy * vx) / math.sqrt(square), start + wait
    else:
        time = end
        near = math.hypot(dx + vx * (end - start), dy + vy * (end - start))
    speed, away = math.sqrt(square), math.hypot(dx, dy)
    late = min(time, 1e300)
    sizes = away + speed * (late - start) + math.hypot(leg.x, leg.y) + math.hypot(other.x, other.y)
    sizes += (leg.speed + other.speed) * late
    if near - CLOSE * sizes > reach:
        return None
    return _enclosed(laws, leg, other, start, min(time, end), start + wait, away, speed, sizes)


def _enclosed(
    laws: Laws, leg: Leg, other: Leg, start: float, time: float, deepest: float, away: float, speed: float, sizes: float
) -> Passage | None:
    """The same, enclosed: by how much more than at the start the two overlap at a time."""
    reach = laws.things[leg.circle].r + laws.things[other.circle].r
    gaps: list[arb] = []
    for moment in (start, time):
        x = (arb(moment) - other.t) * other.vx + other.x - (arb(moment) - leg.t) * leg.vx - leg.x
        y = (arb(moment) - other.t) * other.vy + other.y - (arb(moment) - leg.t) * leg.vy - leg.y
        gaps.append((x * x + y * y).sqrt() - reach)
    first, then = gaps
    deeper = (first.min(arb(0)) - then).mid()
    wide = float(reach)
    far = away + speed * (time - start)
    room = laws.unit * (2 * FLIGHT_UNITS * sizes + ROOT_UNITS * (far * (far / wide) + wide)) + LEAST
    room += sum(one.apart + one.turned * (time - one.t) for one in (leg, other) if one.apart)
    beside = float(abs((x * (other.vy - leg.vy) - y * (other.vx - leg.vx)).mid())) / speed
    room += laws.underflown(speed, speed * math.sqrt(max(0.0, (wide - beside) * (wide + beside))))
    size = size_of(deeper) if deeper > 0 else 0.0
    if size <= room:
        return None
    pair = (min(leg.circle, other.circle), max(leg.circle, other.circle))
    half = math.sqrt(max(0.0, (wide - beside) * (wide + beside))) / speed
    enter, leave = deepest - half, deepest + half
    whole = start < enter and leave < min(leg.end, other.end)
    leave, enter = leave if whole else math.inf, max(start, enter)
    anew = enter if float(first.mid()) >= -room else math.inf
    return Passage(time, Residual("depth", pair, size, room), start, enter, leave, anew)


def _across(laws: Laws, leg: Leg, wall: int) -> Passage | None:
    """How far across a wall, or a face, a circle flies."""
    line, radius = laws.line(leg.circle, wall).at(arb(leg.start)), laws.things[leg.circle].radius
    speed = leg.speed + line.drift
    closing = float(line.nears(leg.vx, leg.vy).mid())
    if closing <= 0.0:
        return None
    height = float(line.nx * (line.x - leg.x) + line.ny * (line.y - leg.y))
    gap, end = height - radius, min(leg.end, 1e300)
    away = math.hypot(leg.x - float(line.x), leg.y - float(line.y))

    def sizes(time: float) -> float:
        far = line.size * (1 + (away + speed * (time - leg.start)) / line.length)
        return math.hypot(leg.x, leg.y) + speed * time + far

    if gap - closing * (end - leg.start) > CLOSE * sizes(end):
        return None
    if wall in laws.scene.faces:
        blur = max(CLOSE, ROOT_UNITS * laws.unit) * sizes(leg.start + max(0.0, gap) / closing) + leg.apart
        end = min(end, _through(*laws.line(leg.circle, wall).seen(leg), height, closing, radius, blur))
    r = laws.things[leg.circle].r
    first = line.nx * (line.x - leg.x) + line.ny * (line.y - leg.y) - r
    then = first - line.nears(leg.vx, leg.vy) * (arb(end) - leg.start)
    deeper = (first.min(arb(0)) - then).mid()
    room = ROOT_UNITS * laws.unit * (sizes(end) + radius) + LEAST
    room += leg.apart + leg.turned * (end - leg.t) if leg.apart else 0.0
    size = size_of(deeper) if deeper > 0 else 0.0
    if size <= room:
        return None
    residual = Residual("depth", (leg.circle, laws.count + wall), size, room)
    enter = leg.start + max(0.0, gap) / closing
    if wall not in laws.scene.faces:
        return Passage(leg.end, residual, leg.start, enter)
    leave = leg.start + (gap + 2.0 * (radius + line.thick)) / closing
    return Passage(end, residual, leg.start, enter, leave if leg.start < enter and leave < leg.end else math.inf)


def _through(leg: Leg, line: WallInBalls, height: float, closing: float, radius: float, blur: float) -> float:
    """Until when a circle that flies at a face is in it: to the end of either, or out on its other side.

    The start of the flight, where it does not come there: one whose centre begins behind the face comes from another
    side, which says what it meets; one that crosses the line beyond an end, or within it by less than rounding, meets
    the end first, at a distance that is the same.

    Args:
        height: of the centre above the face as the flight begins.
        closing: how fast it falls.
        blur: what rounding may make of a place.
    """
    wait = max(0.0, height - radius) / closing
    blur += leg.turned * wait
    slide = leg.vy * float(line.nx) - leg.vx * float(line.ny)
    foot = (leg.y - float(line.y)) * float(line.nx) - (leg.x - float(line.x)) * float(line.ny)
    if height <= blur or not blur < foot + slide * wait < line.length - blur:
        return leg.start
    ahead = (line.length - foot if slide > 0.0 else foot) / abs(slide) if slide else math.inf
    thick = radius + line.thick
    return leg.start + min(ahead, (height - radius + 2.0 * thick) / closing if thick else math.inf)


def _into_side(laws: Laws, leg: Leg, place: int) -> Passage | None:
    """How far into a side of an arc a circle flies.

    Looked at is what comes to the side, from where it certainly is on it, within the range by more than rounding: from
    then on it grows into the arc, up to where it is nearest to the middle, or, from within, to the end of its flight.
    What comes from the other side says there what it meets; what is beside the range meets an end first.
    """
    side, circle = laws.sides[place], laws.things[leg.circle]
    r, hollow = circle.radius, side.inward < 0
    reach = side.radius + side.inward * r
    if reach <= 0.0 or not leg.speed or (hollow and not (side.r - circle.r).mid() > 0):
        return None
    x, y, speed = leg.x - float(side.x), leg.y - float(side.y), leg.speed
    ux, uy = leg.vx / speed, leg.vy / speed
    flown, end = speed * (leg.start - leg.t), min(leg.end, 1e300)
    x, y = x + ux * flown, y + uy * flown
    nearest, beside = -(x * ux + y * uy), abs(x * uy - y * ux)
    root = (reach - beside) * (reach + beside)
    way = speed * (end - leg.start)
    if root <= 0.0 or (nearest <= 0.0 and not hollow):
        return None
    half = math.sqrt(root)
    begin = max(0.0, nearest) if hollow else 0.0
    meets = max(begin, nearest + half if hollow else nearest - half)
    last = way if hollow else min(way, nearest)
    if last <= meets:
        return None
    away = math.hypot(x, y)
    sizes = math.hypot(leg.x, leg.y) + speed * min(leg.start + last / speed, 1e300) + side.place + side.radius + away
    blur = max(CLOSE, ROOT_UNITS * laws.unit) * sizes + leg.apart + leg.turned * meets / speed
    height = math.hypot(x + ux * begin, y + uy * begin) - side.radius
    dx, dy = x + ux * meets, y + uy * meets
    turn = math.hypot(side.nx, side.ny) * 2.0 * blur * (1.0 + reach / half)
    within = math.inf if side.full else side.nx * dx + side.ny * dy - side.h * math.hypot(dx, dy)
    if side.inward * height <= blur or within <= turn:
        return None
    gaps: list[arb] = []
    for moment in (leg.start + begin / speed, leg.start + last / speed):
        cx = (arb(moment) - leg.t) * leg.vx + leg.x - side.x
        cy = (arb(moment) - leg.t) * leg.vy + leg.y - side.y
        gaps.append(side.inward * ((cx * cx + cy * cy).sqrt() - side.r) - circle.r)
    deeper = (gaps[0].min(arb(0)) - gaps[1]).mid()
    far = away + speed * (end - leg.start) if end < 1e300 else away + last
    room = laws.unit * (2 * FLIGHT_UNITS * sizes + ROOT_UNITS * (far * (far / reach) + reach + side.radius)) + LEAST
    room += leg.apart + leg.turned * last / speed if leg.apart else 0.0
    room += laws.underflown(speed, speed * half)
    size = size_of(deeper) if deeper > 0 else 0.0
    if size <= room:
        return None
    time = leg.start + last / speed
    return Passage(time, Residual("depth", (leg.circle, laws.first_side + place), size, room), leg.start)


def _fallen_to_side(laws: Laws, leg: Leg, place: int, fall: Fall) -> Passage | None:
    """How far into a side of an arc a circle falls: as `_into_side`, up to where it is deepest.

    All zeros of the gap are gone through: the circle has to come from where it certainly is on the side, and within the
    range by more than rounding; a zero that is beyond it is passed over.
    """
    side, circle = laws.sides[place], laws.things[leg.circle]
    sign, start, end = float(side.inward), leg.start, min(leg.end, 1e300)
    reach = side.radius + sign * circle.radius
    if reach <= 0.0 or end <= start or (sign < 0.0 and not (side.r - circle.r).mid() > 0):
        return None
    x, y, vx, vy = _as_fallen(leg, start, fall)
    now = RoundFall(float(side.x) - x, float(side.y) - y, -vx, -vy, float(fall.gx) / 2, float(fall.gy) / 2, reach)
    sizes = math.hypot(x, y) + side.place + side.radius + circle.radius + leg.speed * abs(start)

    def blur(after: float) -> float:
        """What rounding may make of a place after a time."""
        fast = leg.speed + math.hypot(now.vx, now.vy)
        rounded = max(CLOSE, ROOT_UNITS * laws.unit) * (sizes + 2 * fast * (start + after))
        return rounded + leg.apart + leg.turned * after

    def is_on_it(then: RoundFall[float], after: float) -> bool:
        """Whether a centre is on the side by more than rounding."""
        return sign * (math.hypot(then.dx, then.dy) - side.radius) > blur(after)

    def is_off(then: RoundFall[float], after: float) -> bool:
        """Whether a centre is where no zero of the gap is, as where doubles have told of one that there is not."""
        return abs(math.hypot(then.dx, then.dy) - reach) > max(reach / 4, blur(after))

    since, stood = 0.0, False
    came, overlaps = is_on_it(now, 0.0), sign * now.gap() <= 0.0
    for _ in range(4):  # zeros at most
        if overlaps and not (came and sign * now.approach() < 0.0 and since == 0.0):
            out = told_falling_zero([-sign * value for value in now.polynomial(stood)])
            if out is None:
                return None
            since, now, stood, overlaps, came = since + out, now.after(out), True, False, False
            if is_off(now, since):
                return None
        if not overlaps:
            wait = told_falling_zero([sign * value for value in now.polynomial(stood)])
            if wait is None or not start + since + wait < end:
                return None
            if not came:
                _, *rates = now.polynomial(False)
                top = told_falling_zero([sign * k * value for k, value in enumerate(rates, 1)])
                came = top is not None and is_on_it(now.after(top), since + top)
            since, now, stood = since + wait, now.after(wait), True
            if is_off(now, since):
                return None
        if came and _is_within(side, now, blur(since)):
            found = _fallen_deep_in_side(laws, leg, place, fall, now, since)
            if found is not None:
                return found
        overlaps, came = True, False
    return None


def _is_within(side: SideInBalls, now: RoundFall[float], blur: float) -> bool:
    """Whether a circle that comes to an arc's circle is within the range, by more than rounding makes of it."""
    if side.full:
        return True
    speed, half = math.hypot(now.vx, now.vy), abs(now.approach())
    turn = math.hypot(side.nx, side.ny) * 2.0 * blur * (1.0 + now.reach * speed / half) if half else math.inf
    return -side.nx * now.dx - side.ny * now.dy - side.h * math.hypot(now.dx, now.dy) > turn


def _fallen_deep_in_side(
    laws: Laws, leg: Leg, place: int, fall: Fall, now: RoundFall[float], since: float
) -> Passage | None:
    """How deep it comes to be in a side, from a zero of the gap on, enclosed; None: by no more than rounding."""
    side, circle = laws.sides[place], laws.things[leg.circle]
    sign, start, end = float(side.inward), leg.start, min(leg.end, 1e300)
    _, *rates = now.polynomial(False)
    deepest = told_falling_zero([-sign * k * value for k, value in enumerate(rates, 1)])
    enter = start + since
    gone = end if end < 1e300 else enter + since + 1.0  # of what never comes back
    time = gone if deepest is None else min(enter + deepest, end)
    gaps: list[arb] = []
    fastest = leg.speed
    for moment in (start, time):
        x, y, vx, vy = _fallen(leg, moment, fall)
        gaps.append(side.inward * (((side.x - x) ** 2 + (side.y - y) ** 2).sqrt() - side.r) - circle.r)
        fastest = max(fastest, math.hypot(float(vx.mid()), float(vy.mid())))
    first = gaps[0].min(arb(0)) if since == 0.0 else arb(0)
    deeper = (first - gaps[1]).mid()
    size, reach = size_of(deeper) if deeper > 0 else 0.0, now.reach
    far = side.radius + circle.radius + abs(float(gaps[0].mid())) + 2 * fastest * (time - start)
    sizes = far + math.hypot(leg.x, leg.y) + side.place + 2 * fastest * time
    steps = 1.0 + (time - leg.t) / fall.step if fall.step else 1.0
    room = laws.unit * steps * (2 * FLIGHT_UNITS * sizes + ROOT_UNITS * (far * (far / reach) + reach + side.radius))
    room += LEAST + leg.apart + leg.turned * (time - leg.t) + laws.underflown(fastest, 0.0)
    if size <= room:
        return None
    out = told_falling_zero([-sign * value for value in now.polynomial(True)])
    leave = math.inf if out is None or since == 0.0 or not enter + out < end else enter + out
    anew = enter if since > 0.0 or float(gaps[0].mid()) >= -room else math.inf
    return Passage(
        time, Residual("depth", (leg.circle, laws.first_side + place), size, room), start, enter, leave, anew
    )
