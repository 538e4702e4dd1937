"""One play of a scene by brute force, in long numbers: the referee has two of them agree."""

from __future__ import annotations

from dataclasses import dataclass

import mpmath
from flint import arb, fmpz  # type: ignore[attr-defined]
from mpmath import mpf

from truebreak.scenarios import Circle, Quantity, Scene, Wall

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
