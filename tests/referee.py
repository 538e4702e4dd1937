"""An independent referee: plays a scene twice by brute force in long numbers, and keeps what agrees.

Nothing here is shared with the engines under test but the scene. Numbers are whole multiples of 2**-bits
(`flint.fmpz`), plain points without enclosures. Every step:

1. predicts every pair and every wall anew: t = (-b - sqrt(b*b - a*c)) / a;
2. moves every circle to the first of these times;
3. turns the two velocities into the frame of the impact, applies the one-dimensional law, turns them back.

A scene is played at `bits` and at `2*bits`, the second time as its mirror image, moved aside, with circles
and walls listed backwards. The instants on which both agree are the refereed history.

    python tests/referee.py            # plays every scene of tests/data/referee/ again and says what differs
    python tests/referee.py --write    # makes these scenes and histories anew
"""

from __future__ import annotations

import json
import sys
import time as clock
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from random import Random
from typing import Any

import mpmath
from flint import arb, fmpz  # type: ignore[attr-defined]
from mpmath import mpf

from truebreak.scenarios import Circle, Quantity, Scene, Trajectory, Wall

DATA = Path(__file__).parent / "data" / "referee"
DIGITS = 25
"""Significant digits of the committed times and states."""
AGREED_BITS = 100
"""Two plays agree on a time if its relative difference is below 2**-AGREED_BITS."""
TOLERANCE = 1e-12
"""Error allowed to an engine's times, relative, and to its final state, relative to the largest there."""

ContactIds = tuple[str, str]


# -- one play


@dataclass
class Disc:
    """A circle in fixed point; m is None if it is fixed."""

    id: str
    x: fmpz
    y: fmpz
    vx: fmpz
    vy: fmpz
    r: fmpz
    m: fmpz | None


@dataclass(frozen=True)
class Line:
    """A wall in fixed point: a point on it, and a normal of length 1."""

    id: str
    x: fmpz
    y: fmpz
    nx: fmpz
    ny: fmpz


@dataclass(frozen=True)
class Candidate:
    """A predicted contact: the time from now, and whether it is too close to a miss to tell."""

    dt: fmpz
    a: Disc
    b: Disc | Line
    grazing: bool = False


class Table:
    """All discs and lines of a scene at one time, in multiples of 2**-bits."""

    def __init__(self, scene: Scene, bits: int, mirrored: bool = False) -> None:
        if scene.reverse_after or scene.reverse_at or scene.capture:
            raise ValueError(f"{scene.name}: the referee plays no reversal and no capture")
        self.bits = bits
        self.one = fmpz(1) << bits
        self.close = fmpz(1) << (bits - bits // 2)
        self.mirrored = mirrored
        self.rank = {name: place for place, name in enumerate(scene.ids)}
        self.time = fmpz(0)
        self.aside = (self.one // 3, -2 * self.one // 7) if mirrored else (fmpz(0), fmpz(0))
        self.discs = [self._disc(circle) for circle in scene.circles]
        self.lines = [self._line(wall) for wall in scene.walls]
        if mirrored:
            self.discs.reverse()
            self.lines.reverse()

    def fixed(self, quantity: Quantity) -> fmpz:
        """The whole number just below quantity * 2**bits."""
        ball = quantity.ball(self.bits + 256)
        assert ball.rad() < arb(2) ** -(self.bits + 32), f"{quantity} is not enclosed sharply enough"
        mantissa, exponent = ball.mid().man_exp()
        shift = int(exponent) + self.bits
        return mantissa << shift if shift >= 0 else mantissa >> -shift

    def _vector(self, x: Quantity, y: Quantity) -> tuple[fmpz, fmpz]:
        return (self.fixed(y), self.fixed(x)) if self.mirrored else (self.fixed(x), self.fixed(y))

    def _point(self, x: Quantity, y: Quantity) -> tuple[fmpz, fmpz]:
        px, py = self._vector(x, y)
        return px + self.aside[0], py + self.aside[1]

    def _disc(self, circle: Circle) -> Disc:
        mass = self.fixed(circle.m) if isinstance(circle.m, Quantity) else None
        place, velocity = self._point(circle.x, circle.y), self._vector(circle.vx, circle.vy)
        return Disc(str(circle.id), *place, *velocity, self.fixed(circle.r), mass)

    def _line(self, wall: Wall) -> Line:
        x0, y0 = self._point(wall.x0, wall.y0)
        x1, y1 = self._point(wall.x1, wall.y1)
        length = ((x1 - x0) ** 2 + (y1 - y0) ** 2).isqrt()
        nx, ny = ((y0 - y1) << self.bits) // length, ((x1 - x0) << self.bits) // length
        return Line(str(wall.id), x0, y0, nx, ny)

    # -- predict

    def meeting(self, p: Disc, q: Disc) -> Candidate | None:
        """When two discs touch: |d + u t| = R, the smaller root of a t**2 + 2 b t + c = 0."""
        dx, dy, ux, uy, reach = q.x - p.x, q.y - p.y, q.vx - p.vx, q.vy - p.vy, p.r + q.r
        c = (dx * dx + dy * dy - reach * reach) >> self.bits
        assert c > -self.close, f"the referee lost count: {p.id} and {q.id} overlap at {self.now}"
        b = (dx * ux + dy * uy) >> self.bits
        if b >= 0:
            return None
        a = (ux * ux + uy * uy) >> self.bits
        if a == 0:  # a relative speed below 2**(-bits/2) is the rounding of rest
            return None
        discriminant = b * b - a * c
        if abs(discriminant) >> self.bits // 2 < b * b >> 2 * (self.bits // 2):
            return Candidate((-b << self.bits) // a, p, q, grazing=True)
        if discriminant < 0:
            return None
        return Candidate(((-b - discriminant.isqrt()) << self.bits) // a, p, q)

    def landing(self, p: Disc, line: Line) -> Candidate | None:
        """When a disc touches a line: its height falls to r, on whichever side it is."""
        height = ((p.x - line.x) * line.nx + (p.y - line.y) * line.ny) >> self.bits
        climb = (p.vx * line.nx + p.vy * line.ny) >> self.bits
        if height < 0:
            height, climb = -height, -climb
        assert height - p.r > -self.close, f"the referee lost count: {p.id} is inside {line.id} at {self.now}"
        if climb >= 0:
            return None
        return Candidate(((height - p.r) << self.bits) // -climb, p, line)

    def candidates(self) -> list[Candidate]:
        """Every predicted contact from here, earliest first."""
        found = []
        for place, p in enumerate(self.discs):
            found += [self.meeting(p, q) for q in self.discs[:place] if not (p.m is None and q.m is None)]
            if p.m is not None:
                found += [self.landing(p, line) for line in self.lines]
        return sorted((c for c in found if c is not None), key=lambda c: c.dt)

    # -- move and bounce

    def advance(self, dt: fmpz) -> None:
        """Moves every disc in a straight line for a time dt."""
        self.time += dt
        for disc in self.discs:
            disc.x += (disc.vx * dt) >> self.bits
            disc.y += (disc.vy * dt) >> self.bits

    def bounce(self, contact: Candidate) -> None:
        """The new velocities of the two that touch."""
        p, q = contact.a, contact.b
        if isinstance(q, Line):
            self._reflect(p, q.nx, q.ny)
            return
        dx, dy = q.x - p.x, q.y - p.y
        length = (dx * dx + dy * dy).isqrt()
        nx, ny = (dx << self.bits) // length, (dy << self.bits) // length
        if p.m is None:
            self._reflect(q, nx, ny)
        elif q.m is None:
            self._reflect(p, nx, ny)
        else:
            self._exchange(p, q, nx, ny)

    def _reflect(self, p: Disc, nx: fmpz, ny: fmpz) -> None:
        along, across = p.vx * nx + p.vy * ny, p.vy * nx - p.vx * ny
        self._turn_back(p, -(along >> self.bits), across >> self.bits, nx, ny)

    def _exchange(self, p: Disc, q: Disc, nx: fmpz, ny: fmpz) -> None:
        """The head-on law for the velocities along the normal; those across it stay."""
        u1, w1 = (p.vx * nx + p.vy * ny) >> self.bits, (p.vy * nx - p.vx * ny) >> self.bits
        u2, w2 = (q.vx * nx + q.vy * ny) >> self.bits, (q.vy * nx - q.vx * ny) >> self.bits
        assert p.m is not None and q.m is not None
        both = p.m + q.m
        self._turn_back(p, ((p.m - q.m) * u1 + 2 * q.m * u2) // both, w1, nx, ny)
        self._turn_back(q, ((q.m - p.m) * u2 + 2 * p.m * u1) // both, w2, nx, ny)

    def _turn_back(self, p: Disc, along: fmpz, across: fmpz, nx: fmpz, ny: fmpz) -> None:
        p.vx = (along * nx - across * ny) >> self.bits
        p.vy = (along * ny + across * nx) >> self.bits

    # -- tell

    def number(self, value: fmpz) -> mpf:
        """A fixed-point number as the mpf that it is, without rounding."""
        return mpmath.mp.make_mpf(mpmath.libmp.from_man_exp(int(value), -self.bits))

    @property
    def now(self) -> str:
        return f"time {mpmath.nstr(self.number(self.time), 15)}"

    def pair(self, contact: Candidate) -> ContactIds:
        """The two ids, the one that comes first in the scene first."""
        first, second = sorted((contact.a.id, contact.b.id), key=self.rank.__getitem__)
        return first, second

    def ordered(self, contacts: list[Candidate]) -> tuple[ContactIds, ...]:
        """The pairs of ids in scene order."""
        return tuple(sorted(map(self.pair, contacts), key=lambda pair: [self.rank[name] for name in pair]))

    def state(self) -> dict[str, tuple[mpf, ...]]:
        """x, y, vx, vy of every circle by id, in scene order, in the frame of the scene."""
        rows = {}
        for disc in sorted(self.discs, key=lambda disc: self.rank[disc.id]):
            x, y, vx, vy = disc.x - self.aside[0], disc.y - self.aside[1], disc.vx, disc.vy
            if self.mirrored:
                x, y, vx, vy = y, x, vy, vx
            rows[disc.id] = tuple(self.number(value) for value in (x, y, vx, vy))
        return rows


@dataclass(frozen=True)
class Instant:
    """When, and the pairs of ids that collide, in scene order."""

    time: mpf
    contacts: tuple[ContactIds, ...]


@dataclass(frozen=True)
class Play:
    """One play at one precision.

    Attributes:
        stop: "events" (as many as asked), "quiet" (no contact to come), "tie" or "graze" (two contacts, or a
            hit and a miss, that this precision does not tell apart; the instant is left out).
        gaps: for each instant, how long after it the next competing contact was predicted, over its time.
    """

    instants: list[Instant]
    gaps: list[mpf]
    stop: str
    final: dict[str, tuple[mpf, ...]]


def play(scene: Scene, events: int, bits: int, merge_ties: bool = False, mirrored: bool = False) -> Play:
    """Plays up to `events` instants.

    Contacts closer than 2**-(bits/2) in time count as a tie, which ends the play; with `merge_ties`, contacts
    that share no moving circle are one instant instead.
    """
    table = Table(scene, bits, mirrored)
    instants: list[Instant] = []
    gaps: list[mpf] = []
    stop = "events"
    while len(instants) < events:
        candidates = table.candidates()
        if not candidates:
            stop = "quiet"
            break
        first = candidates[0].dt
        group = [c for c in candidates if c.dt - first < table.close]
        if any(c.grazing for c in group):
            stop = "graze"
            break
        again = bool(instants) and first < table.close
        if again or (len(group) > 1 and not (merge_ties and _independent(group))):
            stop = "tie"
            break
        table.advance(first)
        for contact in group:
            table.bounce(contact)
        instants.append(Instant(table.number(table.time), table.ordered(group)))
        later = candidates[len(group)].dt - first if len(group) < len(candidates) else None
        with mpmath.workprec(64):
            gaps.append(mpf("inf") if later is None else table.number(later) / (instants[-1].time or 1))
    return Play(instants, gaps, stop, table.state())


def _independent(group: list[Candidate]) -> bool:
    moving = [x.id for c in group for x in (c.a, c.b) if isinstance(x, Disc) and x.m is not None]
    return len(moving) == len(set(moving))


# -- two plays, one history


@dataclass(frozen=True)
class History:
    """What two plays agree on.

    Attributes:
        events: the instants.
        stop: as in `Play`, or "precision" where the two plays part.
        final: x, y, vx, vy of every circle as the last of the events leaves it.
        bits: the lower of the two precisions.
        agreed_bits: the fewest bits on which the two agree, over all times and the final state.
        least_gap: the smallest gap to a competing contact, in units of the time, and the index of its event.
    """

    events: tuple[Instant, ...]
    stop: str
    final: dict[str, tuple[mpf, ...]]
    bits: int
    agreed_bits: int
    least_gap: tuple[mpf, int | None]


def referee(scene: Scene, events: int, bits: int = 1000, merge_ties: bool = False) -> History:
    """The history of `scene` as far as plays at `bits` and at `2*bits` agree, up to `events` instants."""
    low = play(scene, events, bits, merge_ties)
    high = play(scene, events, 2 * bits, merge_ties, mirrored=True)
    agreed = bits
    count = 0
    for one, other in zip(low.instants, high.instants, strict=False):
        same = _agreement(one.time, other.time)
        if one.contacts != other.contacts or same < AGREED_BITS:
            break
        agreed = min(agreed, same)
        count += 1
    stop = low.stop if count == len(low.instants) else "precision"
    if stop == "quiet" and high.stop != "quiet":
        stop = "precision"
    if 0 < count < len(low.instants):
        low = play(scene, count, bits, merge_ties)
    if 0 < count < len(high.instants):
        high = play(scene, count, 2 * bits, merge_ties, mirrored=True)
    for name, row in high.final.items():
        agreed = min([agreed, *(_agreement(a, b) for a, b in zip(low.final[name], row, strict=True))])
    least = min(((gap, index) for index, gap in enumerate(high.gaps[:count])), default=(mpf("inf"), None))
    return History(tuple(high.instants[:count]), stop, high.final, bits, agreed, least)


def _agreement(one: mpf, other: mpf) -> int:
    """Bits on which two numbers agree: relative above 1, absolute below."""
    with mpmath.workprec(20_000):
        difference = abs(one - other) / max(1, abs(other))
    return 20_000 if not difference else int(-mpmath.log(difference, 2))


def settled(scene: Scene, events: int, merge_ties: bool = False, bits: int = 1000) -> History:
    """A history that no lack of precision cuts short: the precision is doubled until it does not.

    Raises:
        RuntimeError: where 32,000 bits leave a tie, or do not suffice.
    """
    while bits <= 32_000:
        history = referee(scene, events, bits, merge_ties)
        if history.stop in ("events", "quiet") and history.agreed_bits >= AGREED_BITS:
            return history
        bits *= 2
    count = len(history.events)
    raise RuntimeError(f"{scene.name}: {history.stop} after {count} events at {history.bits} bits")


# -- judging an engine


def compare_to_referee(trajectory: Trajectory, history: History) -> None:
    """Holds an engine's history against the referee's, event by event, then the state after the last.

    A trajectory may go on longer, unless the referee found that nothing further happens.

    Raises:
        AssertionError: at the first wrong contact, or number that is off by more than `TOLERANCE`.
    """
    label = f"{trajectory.engine} on {trajectory.scene.name!r}"
    rank = {name: place for place, name in enumerate(trajectory.scene.ids)}
    for index, expected in enumerate(history.events):
        when = f"event {index} (time {mpmath.nstr(expected.time, 15)})"
        assert index < len(trajectory.events), (
            f"{label}: stops before {when}, where {_pairs(expected.contacts)} collide: "
            f"{trajectory.stop.reason.name}, {trajectory.stop.message}"
        )
        event = trajectory.events[index]
        contacts = tuple(sorted(map(tuple, event.contacts), key=lambda pair: [rank[name] for name in pair]))
        assert contacts == expected.contacts, (
            f"{label}: {when}: has {_pairs(contacts)} at {float(event.time)!r}, the referee {_pairs(expected.contacts)}"
        )
        error = abs(mpf(float(event.time)) - expected.time)
        assert error <= TOLERANCE * abs(expected.time), (
            f"{label}: {when}, {_pairs(contacts)}: has the time {float(event.time)!r}, off by {mpmath.nstr(error, 3)}"
        )
    if history.stop == "quiet":
        extra = trajectory.events[len(history.events) :]
        assert not extra, f"{label}: {_pairs(extra[0].contacts)} collide after the referee's last event"
    if history.events and history.final:
        _compare_states(label, trajectory, history)


def _compare_states(label: str, trajectory: Trajectory, history: History) -> None:
    state = trajectory.at(trajectory.events[len(history.events) - 1].time)
    for columns in (("x", "y"), ("vx", "vy")):
        places = [("x", "y", "vx", "vy").index(column) for column in columns]
        largest = max(abs(row[place]) for row in history.final.values() for place in places)
        for name, row in history.final.items():
            for column, place in zip(columns, places, strict=True):
                value = float(getattr(state[name], column))
                assert abs(mpf(value) - row[place]) <= TOLERANCE * largest, (
                    f"{label}: after event {len(history.events) - 1}: {name}.{column} is {value!r}, "
                    f"the referee has {mpmath.nstr(row[place], 17)}"
                )


def _pairs(contacts: Any) -> str:
    return ", ".join(f"{first}-{second}" for first, second in contacts)


# -- the scenes: every number is written as text, whole multiples of 1/1000 unless it says otherwise


def thousandths(number: int) -> str:
    return str(Fraction(number, 1000))


def box(width: int, height: int) -> list[Wall]:
    return [
        Wall(0, 0, 1, 0, id="floor"),
        Wall(0, height, 1, height, id="ceiling"),
        Wall(0, 0, 0, 1, id="left"),
        Wall(width, 0, width, 1, id="right"),
    ]


def scatter(
    draw: Random,
    radii: list[int],
    inside: Callable[[int, int, int], bool],
    size: tuple[int, int],
    taken: tuple[tuple[int, int, int], ...] = (),
) -> Iterator[tuple[int, int, int]]:
    """Places (x, y, r) in thousandths, drawn at random until they fit."""
    placed = list(taken)
    for r in radii:
        while True:
            x, y = draw.randrange(size[0]), draw.randrange(size[1])
            if inside(x, y, r) and all((x - a) ** 2 + (y - b) ** 2 > (r + s) ** 2 for a, b, s in placed):
                break
        placed.append((x, y, r))
        yield x, y, r


def within(width: int, height: int) -> Callable[[int, int, int], bool]:
    return lambda x, y, r: r < x < 1000 * width - r and r < y < 1000 * height - r


def velocity(draw: Random, top: int = 1000) -> dict[str, str]:
    return {"vx": thousandths(draw.randrange(-top, top)), "vy": thousandths(draw.randrange(-top, top))}


def gas(seed: int, n: int, side: int, mixed: bool) -> Scene:
    """Moving discs in a square box."""
    draw = Random(seed)
    radii = sorted((draw.randrange(150, 700) if mixed else 500 for _ in range(n)), reverse=True)
    circles = [
        Circle(thousandths(x), thousandths(y), thousandths(r), **velocity(draw),
               m=thousandths(draw.randrange(200, 5000)) if mixed else 1)
        for x, y, r in scatter(draw, radii, within(side, side), (1000 * side, 1000 * side))
    ]  # fmt: skip
    return Scene(circles, box(side, side), description=f"{n} moving discs in a box")


def rack(seed: int, rows: int) -> Scene:
    """A triangle of balls of radius 1, pitch 201/100, each moved by up to 1/500; a cue ball; cushions."""
    draw = Random(seed)
    height, vy = thousandths(12_500 + draw.randrange(-500, 500)), thousandths(draw.randrange(300))
    circles = [Circle(6, height, vx=20, vy=vy, id="cue")]
    for row in range(rows):
        for place in range(row + 1):
            jx, jy = (thousandths(draw.randrange(-2, 3)) for _ in range(2))
            x = f"20 + {row}*sqrt(3)*201/200 + {jx}"
            y = f"25/2 + {2 * place - row}*201/200 + {jy}"
            circles.append(Circle(x, y, id=f"b{len(circles)}"))
    return Scene(circles, box(50, 25), description=f"a cue ball and a loose rack of {len(circles) - 1}")


def lorentz(seed: int, triangular: bool) -> Scene:
    """One ball among fixed discs in a box."""
    draw = Random(seed)
    if triangular:
        grid = [(2 * i + j % 2 + 1, j) for i in range(4) for j in range(4)]
        places = [(f"{i}*11/10", f"({j}*sqrt(3) + 1)*11/10") for i, j in grid]
        obstacles = [Circle(x, y, "4/5", m="oo", id=f"o{k}") for k, (x, y) in enumerate(places, start=1)]
        ball = Circle("33/10", "11/10*(sqrt(3)/3*2 + 1)", "1/10", id="ball", vx="3/5", vy="7/10")
        walls = [
            Wall(0, 0, 1, 0, id="floor"),
            Wall(0, "(3*sqrt(3) + 2)*11/10", 1, "(3*sqrt(3) + 2)*11/10", id="ceiling"),
            Wall(0, 0, 0, 1, id="left"),
            Wall("99/10", 0, "99/10", 1, id="right"),
        ]
        return Scene([ball, *obstacles], walls, description="a ball in a triangular lattice of fixed discs")
    radii = sorted((draw.randrange(300, 1200) for _ in range(12)), reverse=True)
    circles = [
        Circle(thousandths(x), thousandths(y), thousandths(r), m="oo" if r > 200 else 1,
               **(velocity(draw) if r <= 200 else {}))
        for x, y, r in scatter(draw, [*radii, 200], within(10, 10), (10_000, 10_000))
    ]  # fmt: skip
    return Scene(circles, box(10, 10), description="one ball among 12 fixed discs of mixed radii")


def polygon(seed: int, corners: list[tuple[int, int]], n: int) -> Scene:
    """Moving discs in a convex polygon, corners anticlockwise, whose walls are neither level nor upright."""
    draw = Random(seed)
    ends = list(zip(corners, corners[1:] + corners[:1], strict=True))

    def inside(x: int, y: int, r: int) -> bool:
        for (ax, ay), (bx, by) in ends:
            height = (bx - ax) * (y - 1000 * ay) - (by - ay) * (x - 1000 * ax)
            if height <= 0 or height**2 <= r**2 * ((bx - ax) ** 2 + (by - ay) ** 2):
                return False
        return True

    size = (1000 * max(x for x, _ in corners), 1000 * max(y for _, y in corners))
    radii = sorted((draw.randrange(300, 900) for _ in range(n)), reverse=True)
    circles = [
        Circle(thousandths(x), thousandths(y), thousandths(r), **velocity(draw),
               m=thousandths(draw.randrange(500, 3000)))
        for x, y, r in scatter(draw, radii, inside, size)
    ]  # fmt: skip
    walls = [Wall(*a, *b) for a, b in ends]
    return Scene(circles, walls, description=f"{n} moving discs inside {len(corners)} slanted walls")


def triangle() -> Scene:
    """Four discs in an equilateral triangle of side 12: one level wall, two with sqrt(3) in their points."""
    walls = [
        Wall(0, 0, 12, 0, id="floor"),
        Wall(12, 0, 6, "6*sqrt(3)", id="right"),
        Wall(6, "6*sqrt(3)", 0, 0, id="left"),
    ]
    circles = [
        Circle(3, "1.3", "0.9", vx="0.7", vy="0.31"),
        Circle("9.1", "1.2", 1, vx="-0.45", vy="0.83", m=2),
        Circle("6.05", "sqrt(2)*3", "1.1", vx="0.2", vy="-sqrt(2)/2", m=3),
        Circle("6.1", "7.7", "0.5", vx="-0.9", vy="-0.6", m="1/2"),
    ]
    return Scene(circles, walls, description="4 discs inside an equilateral triangle")


def heavy(seed: int) -> Scene:
    """Two discs of mass 10**6 and six of mass 1 in a box."""
    draw = Random(seed)
    circles = [
        Circle(thousandths(x), thousandths(y), thousandths(r), m=10**6 if r == 1500 else 1,
               **velocity(draw, 100 if r == 1500 else 1000))
        for x, y, r in scatter(draw, [1500, 1500, *[250] * 6], within(10, 10), (10_000, 10_000))
    ]  # fmt: skip
    return Scene(circles, box(10, 10), description="2 discs a million times as heavy as the 6 others")


def chambers(seed: int, n: int) -> Scene:
    """n discs in one box and their mirror image in another: every instant is two independent contacts."""
    draw = Random(seed)
    circles = []
    for k, (x, y, r) in enumerate(scatter(draw, [600] * n, within(5, 6), (5000, 6000)), start=1):
        vx, vy = draw.randrange(-1000, 1000), draw.randrange(-1000, 1000)
        for side, sign in (("l", -1), ("r", 1)):
            place = thousandths(sign * (1000 + x)), thousandths(y)
            motion = thousandths(sign * vx), thousandths(vy)
            circles.append(Circle(*place, thousandths(r), *motion, id=f"{side}{k}"))
    walls = [
        Wall(0, 0, 1, 0, id="floor"),
        Wall(0, 6, 1, 6, id="ceiling"),
        Wall(-6, 0, -6, 1, id="left"),
        Wall(-1, 0, -1, 1, id="inner-left"),
        Wall(1, 0, 1, 1, id="inner-right"),
        Wall(6, 0, 6, 1, id="right"),
    ]
    return Scene(circles, walls, description=f"{n} discs in a box, and their mirror image in another")


SCENES: dict[str, tuple[Callable[[], Scene], int]] = {
    "gas5-equal": (lambda: gas(seed=1, n=5, side=6, mixed=False), 200),
    "gas5-mixed": (lambda: gas(seed=2, n=5, side=6, mixed=True), 500),
    "gas10-equal": (lambda: gas(seed=3, n=10, side=8, mixed=False), 400),
    "gas10-mixed": (lambda: gas(seed=4, n=10, side=8, mixed=True), 400),
    "gas20-equal": (lambda: gas(seed=5, n=20, side=8, mixed=False), 300),
    "gas20-mixed": (lambda: gas(seed=6, n=20, side=9, mixed=True), 300),
    "rack6": (lambda: rack(seed=7, rows=3), 300),
    "rack15": (lambda: rack(seed=8, rows=5), 300),
    "lorentz12": (lambda: lorentz(seed=9, triangular=False), 300),
    "lorentz-triangular": (lambda: lorentz(seed=0, triangular=True), 300),
    "slanted5": (lambda: polygon(11, [(1, 0), (9, 2), (10, 7), (4, 10), (0, 5)], 6), 400),
    "triangle4": (triangle, 400),
    "heavy8": (lambda: heavy(seed=13), 400),
    "chambers6": (lambda: chambers(seed=14, n=3), 200),
}
"""Every committed scene by name, and its number of instants."""
MERGED = {"chambers6"}
"""The scenes whose ties between independent contacts are merged."""


# -- the files


def scene_from(data: dict[str, Any]) -> Scene:
    """The scene that `Scene.data()` wrote."""
    rest = {key: value for key, value in data.items() if key not in ("circle", "wall")}
    circles, walls = [Circle(**row) for row in data["circle"]], [Wall(**row) for row in data.get("wall", ())]
    return Scene(circles, walls, **rest)


def make(name: str) -> Scene:
    """The scene of that name, made anew."""
    maker, events = SCENES[name]
    return maker().with_changes(name=name, events=events, source=f"tests/referee.py, SCENES[{name!r}]")


def written(history: History) -> str:
    """A history as compact JSON, one event a line."""

    def digits(number: mpf) -> str:
        return mpmath.nstr(number, DIGITS)

    head = {
        "stop": history.stop,
        "bits": history.bits,
        "agreed_bits": history.agreed_bits,
        "least_gap": [mpmath.nstr(history.least_gap[0], 3), history.least_gap[1]],
        "final": {name: [digits(value) for value in row] for name, row in history.final.items()},
    }
    rows = [json.dumps([digits(e.time), *e.contacts], separators=(",", ":")) for e in history.events]
    lines = [f"{json.dumps(key)}: {json.dumps(value)}" for key, value in head.items()]
    return "{\n" + ",\n".join(lines) + ',\n"events": [\n' + ",\n".join(rows) + "\n]}\n"


def names() -> list[str]:
    """The committed scenes."""
    return sorted(path.name.removesuffix(".scene.json") for path in DATA.glob("*.scene.json"))


def load(name: str) -> tuple[Scene, History]:
    """A committed scene and its refereed history, times and final state to `DIGITS` digits."""
    scene = scene_from(json.loads((DATA / f"{name}.scene.json").read_text()))
    told = json.loads((DATA / f"{name}.events.json").read_text())
    with mpmath.workprec(128):
        return scene, History(
            tuple(Instant(mpf(time), tuple((a, b) for a, b in pairs)) for time, *pairs in told["events"]),
            told["stop"],
            {key: tuple(mpf(value) for value in row) for key, row in told["final"].items()},
            told["bits"],
            told["agreed_bits"],
            (mpf(told["least_gap"][0]), told["least_gap"][1]),
        )


def texts(name: str) -> tuple[str, str]:
    """What the two files of a scene should hold: the scene, the events."""
    scene = make(name)
    history = settled(scene, SCENES[name][1], merge_ties=name in MERGED)
    return json.dumps(scene.data(), indent=1) + "\n", written(history)


def main(write: bool) -> int:
    stale = 0
    for name in SCENES:
        start = clock.perf_counter()
        told = dict(zip(("scene", "events"), texts(name), strict=True))
        seconds = clock.perf_counter() - start
        for kind, text in told.items():
            path = DATA / f"{name}.{kind}.json"
            if write:
                path.write_text(text)
            elif not path.exists() or path.read_text() != text:
                stale += 1
                print(f"{path.name} is not current")
        head = json.loads(told["events"])
        print(
            f"{name:20} {len(head['events']):4} events  {head['stop']:7}"
            f"{head['bits']:5} and {2 * head['bits']:5} bits, agreed to {head['agreed_bits']:5}"
            f"  least gap {head['least_gap'][0]:>9}  {seconds:6.1f} s"
            f"  {sum(map(len, told.values())) / 1000:5.1f} kB"
        )
    return stale


if __name__ == "__main__":
    sys.exit(bool(main("--write" in sys.argv[1:])))
