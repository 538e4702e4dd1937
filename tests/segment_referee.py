"""A referee of scenes with segments, polygons and a restitution, in plain coordinates and 100 digits, of its own code.

Every disc flies as x + v t. It meets a segment where its distance from the segment, as a set of points, comes down to
both radii: that is found in the segment's own frame, along and across. What meets at one instant is resolved by the
definition of the policy `simultaneous`, all subsets tried. Numbers closer than `SAME` are taken to be equal, which
random numbers of a few digits do not come near by chance.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import combinations

from mpmath import atan2, lu_solve, matrix, mp, mpf, sqrt

from truebreak.scenarios import Scene

DIGITS = 100
SAME = mpf(10) ** -55


def number(quantity) -> mpf:
    """An exact number of a scene, to all digits."""
    return mpf(quantity.digits(DIGITS)) if hasattr(quantity, "digits") else mpf(quantity)


@dataclass
class Disc:
    id: str
    x: mpf
    y: mpf
    r: mpf
    vx: mpf
    vy: mpf
    w: mpf


@dataclass
class Bar:
    """A segment by its start, its direction of length 1, its length and half its thickness."""

    id: str
    x: mpf
    y: mpf
    ux: mpf
    uy: mpf
    length: mpf
    r: mpf


@dataclass
class Happened:
    time: mpf
    approaching: set[tuple[str, str]]
    touching: set[tuple[str, str]]
    rounds: int


@dataclass
class Told:
    events: list[Happened] = field(default_factory=list)
    blunt: mpf | None = None
    discs: list[Disc] = field(default_factory=list)
    end: mpf | None = None


def _mass(circle) -> mpf:
    return mpf(0) if circle.fixed else 1 / number(circle.m)


def read(scene: Scene) -> tuple[list[Disc], list[Bar], list[tuple[str, mpf, mpf, mpf, mpf]]]:
    """Discs, segments, and walls as a point and a normal of length 1."""
    discs = [
        Disc(c.id, number(c.x), number(c.y), number(c.r), number(c.vx), number(c.vy), _mass(c)) for c in scene.circles
    ]
    bars, walls = [], []
    for s in scene.segments:
        x0, y0, x1, y1 = (number(q) for q in (s.x0, s.y0, s.x1, s.y1))
        length = sqrt((x1 - x0) ** 2 + (y1 - y0) ** 2)
        bars.append(Bar(s.id, x0, y0, (x1 - x0) / length, (y1 - y0) / length, length, number(s.r)))
    for w in scene.walls:
        x0, y0, x1, y1 = (number(q) for q in (w.x0, w.y0, w.x1, w.y1))
        length = sqrt((x1 - x0) ** 2 + (y1 - y0) ** 2)
        walls.append((w.id, x0, y0, -(y1 - y0) / length, (x1 - x0) / length))
    return discs, bars, walls


def outline(polygon) -> list[tuple[mpf, mpf]]:
    """The points of a polygon without those that lie on the way from one neighbour to the other."""
    points = [(number(x), number(y)) for x, y in polygon.points]
    kept = []
    for (ax, ay), (bx, by), (cx, cy) in zip([points[-1], *points], points, [*points[1:], points[0]], strict=False):
        if abs((bx - ax) * (cy - by) - (by - ay) * (cx - bx)) > SAME:
            kept.append((bx, by))
    return kept


def sides(polygon) -> list[Bar]:
    """The sides of a polygon as segments: both sides of each push, but on the one there is nobody."""
    points, found = outline(polygon), []
    for (x0, y0), (x1, y1) in zip(points, [*points[1:], points[0]], strict=True):
        length = sqrt((x1 - x0) ** 2 + (y1 - y0) ** 2)
        found.append(Bar(polygon.id, x0, y0, (x1 - x0) / length, (y1 - y0) / length, length, number(polygon.r)))
    return found


def inside(x: mpf, y: mpf, points: list[tuple[mpf, mpf]]) -> bool:
    """Whether the way around goes once around a point: the sum of the angles under which it sees the sides."""
    around = mpf(0)
    for (ax, ay), (bx, by) in zip(points, [*points[1:], points[0]], strict=True):
        px, py, qx, qy = ax - x, ay - y, bx - x, by - y
        around += atan2(px * qy - py * qx, px * qx + py * qy)
    return abs(around) > 3


def falls(dx: mpf, dy: mpf, vx: mpf, vy: mpf, reach: mpf) -> tuple[mpf, bool] | None:
    """When |d + v t| comes down to a reach, for the first time from now on; and whether it goes below. None: never."""
    a, b, c = vx * vx + vy * vy, dx * vx + dy * vy, dx * dx + dy * dy - reach * reach
    if a < SAME or b > -SAME:
        return None
    inside = b * b - a * c
    if inside < -SAME:
        return None
    if inside < SAME:
        return -b / a, False
    t = (-b - sqrt(inside)) / a
    return (t, True) if t > -SAME else None


class Referee:
    """One run."""

    def __init__(self, scene: Scene) -> None:
        mp.dps = DIGITS
        self.discs, self.bars, self.walls = read(scene)
        self.bars += [side for polygon in scene.polygons for side in sides(polygon)]
        self.outlines = [outline(polygon) for polygon in scene.polygons]
        self.ends: list[tuple[str, mpf, mpf, mpf]] = []
        for bar in self.bars:
            for x, y in ((bar.x, bar.y), (bar.x + bar.length * bar.ux, bar.y + bar.length * bar.uy)):
                place = next(
                    (k for k, (_, ex, ey, _) in enumerate(self.ends) if abs(ex - x) + abs(ey - y) < SAME), None
                )
                if place is None:
                    self.ends.append((bar.id, x, y, bar.r))
                else:
                    name, ex, ey, r = self.ends[place]  # the first of the thickest names it
                    self.ends[place] = (bar.id, ex, ey, bar.r) if bar.r > r else (name, ex, ey, r)
        self.now = mpf(0)
        self.e = number(scene.restitution)
        self.paces: dict[str, tuple[mpf, mpf]] = {}
        """Velocities of what does not stand, where something does not."""

    # -- what touches, now

    def normals(self) -> Iterator[tuple[tuple[str, str], list[tuple[Disc, mpf, mpf]]]]:
        """Each contact at gap zero, with the direction, of length 1, in which it pushes each disc."""
        for a, b in combinations(self.discs, 2):
            dx, dy = b.x - a.x, b.y - a.y
            away = sqrt(dx * dx + dy * dy)
            if abs(away - a.r - b.r) < SAME and a.r + b.r > 0:
                yield (a.id, b.id), [(a, -dx / away, -dy / away), (b, dx / away, dy / away)]
        for disc in self.discs:
            for name, x, y, nx, ny in self.walls:
                height = (disc.x - x) * nx + (disc.y - y) * ny
                if abs(abs(height) - disc.r) < SAME:
                    ux, uy = self.paces.get(name, (0, 0))  # a point is where it comes from
                    away = height if disc.r > 0 else -((disc.vx - ux) * nx + (disc.vy - uy) * ny)
                    side = 1 if away > 0 else -1
                    yield (disc.id, name), [(disc, side * nx, side * ny)]
            for bar in self.bars:
                along = (disc.x - bar.x) * bar.ux + (disc.y - bar.y) * bar.uy
                across = (disc.y - bar.y) * bar.ux - (disc.x - bar.x) * bar.uy
                if SAME < along < bar.length - SAME and abs(abs(across) - disc.r - bar.r) < SAME:
                    if disc.r + bar.r == 0:  # a point on a line: it stands on the side from which it came
                        ux, uy = self.paces.get(bar.id, (0, 0))
                        side = -1 if (disc.vy - uy) * bar.ux - (disc.vx - ux) * bar.uy > 0 else 1
                    else:
                        side = 1 if across > 0 else -1
                    yield (disc.id, bar.id), [(disc, -side * bar.uy, side * bar.ux)]
            for name, x, y, r in self.ends:
                away = sqrt((disc.x - x) ** 2 + (disc.y - y) ** 2)
                if abs(away - disc.r - r) < SAME and away > SAME:
                    yield (disc.id, name), [(disc, (disc.x - x) / away, (disc.y - y) / away)]

    def resolve(self) -> Happened:
        """Impulses of the policy `simultaneous` until nothing approaches."""
        contacts = list(self.normals())
        first: set[tuple[str, str]] = set()
        for rounds in range(1000):
            speeds = [sum(nx * d.vx + ny * d.vy for d, nx, ny in arms) for _, arms in contacts]
            coming = [k for k, u in enumerate(speeds) if u < -SAME]
            if not coming:
                return Happened(self.now, first, {name for name, _ in contacts}, rounds)
            first = first or {contacts[k][0] for k in coming}
            self.push([contacts[k][1] for k in coming], [speeds[k] for k in coming])
        raise AssertionError("no end")

    def push(self, arms: list[list[tuple[Disc, mpf, mpf]]], speeds: list[mpf]) -> None:
        """The impulses s >= 0 of least number with u + G s >= -e u, and equal where s > 0."""
        size = range(len(arms))

        def coupled(i: int, j: int) -> mpf:
            return sum((d.w * (ax * bx + ay * by) for d, ax, ay in arms[i] for e, bx, by in arms[j] if d is e), mpf(0))

        gram = [[coupled(i, j) for j in size] for i in size]
        for count in range(1, len(arms) + 1):
            for chosen in combinations(size, count):
                try:
                    found = lu_solve(
                        matrix([[gram[i][j] for j in chosen] for i in chosen]),
                        matrix([-self.e * speeds[i] - speeds[i] for i in chosen]),
                    )
                except ZeroDivisionError:
                    continue
                strengths = dict(zip(chosen, found, strict=True))
                if any(s < -SAME or s > 10**30 for s in strengths.values()):
                    continue
                slack = [
                    speeds[i] + self.e * speeds[i] + sum(gram[i][j] * s for j, s in strengths.items()) for i in size
                ]
                if all(value > -SAME for value in slack):
                    for j, s in strengths.items():
                        for disc, nx, ny in arms[j]:
                            disc.vx += disc.w * s * nx
                            disc.vy += disc.w * s * ny
                    return
        raise AssertionError("no impulses")

    # -- what comes next

    def next_time(self) -> tuple[mpf, bool] | None:
        """The time until something is hit, and whether that is a point at a point, which has no normal."""
        found: list[tuple[mpf, bool]] = []
        for a, b in combinations(self.discs, 2):
            if a.r + b.r > 0 and (hit := falls(b.x - a.x, b.y - a.y, b.vx - a.vx, b.vy - a.vy, a.r + b.r)) and hit[1]:
                found.append((hit[0], False))
        for disc in self.discs:
            for _, x, y, nx, ny in self.walls:
                height, speed = (disc.x - x) * nx + (disc.y - y) * ny, disc.vx * nx + disc.vy * ny
                side = 1 if height > 0 else -1
                if side * speed < -SAME and (t := (abs(height) - disc.r) / (-side * speed)) > SAME:
                    found.append((t, False))
            for bar in self.bars:
                reach = disc.r + bar.r
                along = (disc.x - bar.x) * bar.ux + (disc.y - bar.y) * bar.uy
                across = (disc.y - bar.y) * bar.ux - (disc.x - bar.x) * bar.uy
                slide, speed = disc.vx * bar.ux + disc.vy * bar.uy, disc.vy * bar.ux - disc.vx * bar.uy
                if abs(speed) < SAME:
                    continue
                side = -1 if speed > 0 else 1  # it comes down from there
                t = (side * across - reach) / abs(speed)
                if t > SAME and SAME < along + slide * t < bar.length - SAME:
                    found.append((t, False))
            for _, x, y, r in self.ends:
                hit = falls(disc.x - x, disc.y - y, disc.vx, disc.vy, disc.r + r)
                if hit is not None and (hit[1] or disc.r + r == 0):
                    found.append((hit[0], disc.r + r == 0))
        first = min((t for t, _ in found), default=None)
        return None if first is None else (first, any(blunt for t, blunt in found if t < first + SAME))

    def clear(self) -> bool:
        """Whether no disc is in a segment, as a set of points."""
        for disc in self.discs:
            for bar in self.bars:
                along = (disc.x - bar.x) * bar.ux + (disc.y - bar.y) * bar.uy
                near = min(max(along, mpf(0)), bar.length)
                away = sqrt((disc.x - bar.x - near * bar.ux) ** 2 + (disc.y - bar.y - near * bar.uy) ** 2)
                if away < disc.r + bar.r - SAME:
                    return False
                if away < SAME:  # a point on a side
                    break
            else:
                if any(inside(disc.x, disc.y, points) for points in self.outlines):
                    return False
        return True

    def run(self, until: mpf, events: int) -> Told:
        """To a time, or a number of instants."""
        told = Told(discs=self.discs)
        start = self.resolve()
        if start.approaching:
            told.events.append(start)
        while len(told.events) < events:
            coming = self.next_time()
            if coming is None or self.now + coming[0] > until + SAME:
                self.fly(until - self.now)
                break
            self.fly(coming[0])
            assert self.clear(), "the referee let a disc into a segment"
            if coming[1]:
                told.blunt = self.now
                break
            happened = self.resolve()
            assert happened.approaching, "the referee met what does not approach"
            told.events.append(happened)
        told.end = self.now
        return told

    def fly(self, wait: mpf) -> None:
        for disc in self.discs:
            disc.x += disc.vx * wait
            disc.y += disc.vy * wait
        self.now += wait
