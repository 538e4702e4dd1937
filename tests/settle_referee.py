"""Discs that settle on level walls, simulated anew in true coordinates with mpmath: shares no code with truebreak.

Every disc has an acceleration: that of gravity, none while a wall carries it, none where it is fixed. The squared
distance of two is a polynomial of the time, made anew by sampling it, and a meeting is one of its zeros at which it
falls; at an instant all contacts at gap zero are looked at, those that approach push, one after the other where they
share no disc but at walls at right angles, until none approaches. What then neither approaches nor parts, at a wall
across gravity that it is pulled to, or at two that hold it between them, is carried. Bounces that come to an end are
followed until what is left of them is beyond all digits looked at.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import combinations

from gravity_referee import DIGITS, NOW, Body, falling_zeros, number
from mpmath import mpf, sqrt, workdps
from peg_referee import NotForThis, interpolated, zeros_of

from truebreak.scenarios import Scene

FAINT = mpf(10) ** -40
"""A speed or a gap that is none: numbers are known to many more digits."""

ENDLESS = mpf(10) ** -60
"""What is left of the time of bounces once they are taken to have ended."""


@dataclass
class Did:
    """What a run did.

    Attributes:
        hits: each event: when, and the contacts that pushed.
        settled: when which disc began to be carried by which wall.
        bodies: the discs at the end.
    """

    hits: list[tuple[mpf, frozenset[tuple[str, str]]]] = field(default_factory=list)
    settled: list[tuple[mpf, str, str]] = field(default_factory=list)
    bodies: list[Body] = field(default_factory=list)


class SettleReferee:
    """One run, of discs and walls.

    Args:
        scene: what runs.
    """

    def __init__(self, scene: Scene) -> None:
        self.ids = [str(c.id) for c in scene.circles]
        with workdps(DIGITS):
            self.g = [number(part) for part in scene.gravity or ()]
            self.e = number(scene.restitution)
            self.bodies = [
                Body(*(number(q) for q in (c.x, c.y, c.vx, c.vy, c.r)), mpf("inf") if c.fixed else number(c.m))
                for c in scene.circles
            ]
            self.walls: list[tuple[str, mpf, mpf, mpf, mpf]] = []
            for wall in scene.walls:
                x0, y0, x1, y1 = (number(q) for q in (wall.x0, wall.y0, wall.x1, wall.y1))
                length = sqrt((x1 - x0) ** 2 + (y1 - y0) ** 2)
                self.walls.append((str(wall.id), x0, y0, (y0 - y1) / length, (x1 - x0) / length))
            self.sides = [
                [1 if (b.x - x) * nx + (b.y - y) * ny > 0 else -1 for _, x, y, nx, ny in self.walls]
                for b in self.bodies
            ]
        self.carried: dict[int, int] = {}
        self.now = mpf(0)

    def pull(self, i: int) -> tuple[mpf, mpf]:
        """The acceleration of a disc."""
        if i in self.carried or self.bodies[i].m == mpf("inf"):
            return mpf(0), mpf(0)
        return self.g[0], self.g[1]

    def fly(self, t: mpf) -> None:
        """All go on."""
        self.now += t
        for i, b in enumerate(self.bodies):
            gx, gy = self.pull(i)
            b.x, b.y = b.x + b.vx * t + gx * t * t / 2, b.y + b.vy * t + gy * t * t / 2
            b.vx, b.vy = b.vx + gx * t, b.vy + gy * t

    def run(self, until: mpf, events: int) -> Did:
        """Up to a time, or until there were more events than asked for."""
        with workdps(DIGITS):
            did = Did(bodies=self.bodies)
            self._resolve(did)
            while len(did.hits) <= events:
                found = min(self._coming(), default=None)
                if found is None or self.now + found > until:
                    self.fly(until - self.now)
                    return did
                self.fly(found)
                self._resolve(did)
            return did

    def _coming(self) -> list[mpf]:
        times: list[mpf] = []
        for i, j in combinations(range(len(self.bodies)), 2):
            a, b = self.bodies[i], self.bodies[j]
            if a.m == b.m == mpf("inf"):
                continue
            (ax, ay), (bx, by) = self.pull(i), self.pull(j)
            dx, dy, vx, vy, gx, gy = b.x - a.x, b.y - a.y, b.vx - a.vx, b.vy - a.vy, bx - ax, by - ay
            reach = a.r + b.r
            if gx == gy == 0:
                c = [dx * dx + dy * dy - reach * reach, 2 * (dx * vx + dy * vy), vx * vx + vy * vy]
                times += falling_zeros(c[2], c[1], c[0])
                continue

            def gap(t: mpf, row: tuple[mpf, ...] = (dx, dy, vx, vy, gx, gy, reach)) -> mpf:
                x, y, u, v, hx, hy, r = row
                return (x + u * t + hx * t * t / 2) ** 2 + (y + v * t + hy * t * t / 2) ** 2 - r * r

            c = interpolated([gap(mpf(t)) for t in (-2, -1, 0, 1, 2)])
            for z in zeros_of(c):
                t = z.real
                slope = c[1] + t * (2 * c[2] + t * (3 * c[3] + t * 4 * c[4]))
                if abs(z.imag) < NOW and t > NOW and slope < 0:
                    times.append(t)
        for i, b in enumerate(self.bodies):
            if b.m == mpf("inf"):
                continue
            gx, gy = self.pull(i)
            for k, (_, x, y, nx, ny) in enumerate(self.walls):
                if self.carried.get(i) == k:
                    continue
                s = self.sides[i][k]
                gap0, speed = s * ((b.x - x) * nx + (b.y - y) * ny) - b.r, s * (b.vx * nx + b.vy * ny)
                times += falling_zeros(s * (gx * nx + gy * ny) / 2, speed, gap0)
        return times

    def _contacts(self) -> list[tuple[tuple[str, str], tuple[int, ...], int]]:
        """What is at gap zero now: its ids, its discs, and the wall (-1: none)."""
        found: list[tuple[tuple[str, str], tuple[int, ...], int]] = []
        for i, j in combinations(range(len(self.bodies)), 2):
            a, b = self.bodies[i], self.bodies[j]
            if a.m == b.m == mpf("inf"):
                continue
            if abs(sqrt((b.x - a.x) ** 2 + (b.y - a.y) ** 2) - a.r - b.r) < FAINT:
                found.append(((self.ids[i], self.ids[j]), (i, j), -1))
        for i, b in enumerate(self.bodies):
            for k, (name, x, y, nx, ny) in enumerate(self.walls):
                height = self.sides[i][k] * ((b.x - x) * nx + (b.y - y) * ny)
                if b.m != mpf("inf") and abs(height - b.r) < FAINT:
                    found.append(((self.ids[i], name), (i,), k))
        return found

    def closing(self, discs: tuple[int, ...], wall: int) -> mpf:
        """How fast two part."""
        a = self.bodies[discs[0]]
        if wall >= 0:
            _, _, _, nx, ny = self.walls[wall]
            return self.sides[discs[0]][wall] * (a.vx * nx + a.vy * ny)
        b = self.bodies[discs[1]]
        dx, dy = b.x - a.x, b.y - a.y
        return ((b.vx - a.vx) * dx + (b.vy - a.vy) * dy) / sqrt(dx * dx + dy * dy)

    def push(self, discs: tuple[int, ...], wall: int) -> None:
        """The impulse of one contact."""
        speed, a = self.closing(discs, wall), self.bodies[discs[0]]
        if wall >= 0:
            s, (_, _, _, nx, ny) = self.sides[discs[0]][wall], self.walls[wall]
            a.vx, a.vy = a.vx - (1 + self.e) * speed * s * nx, a.vy - (1 + self.e) * speed * s * ny
            return
        b = self.bodies[discs[1]]
        dx, dy = b.x - a.x, b.y - a.y
        length = sqrt(dx * dx + dy * dy)
        impulse = -(1 + self.e) * speed / (1 / a.m + 1 / b.m)
        a.vx, a.vy = a.vx - impulse / a.m * dx / length, a.vy - impulse / a.m * dy / length
        b.vx, b.vy = b.vx + impulse / b.m * dx / length, b.vy + impulse / b.m * dy / length

    def _resolve(self, did: Did) -> None:
        contacts = self._contacts()
        before, pushed = dict(self.carried), set[tuple[str, str]]()
        met = {i for _, discs, wall in contacts if self.closing(discs, wall) < -FAINT for i in discs}
        grown = True
        while grown:
            more = {i for _, discs, _ in contacts if not met.isdisjoint(discs) for i in discs}
            grown, met = not more <= met, met | more
        for i in met:
            self.carried.pop(i, None)
        for _ in range(300):
            coming = [row for row in contacts if self.closing(row[1], row[2]) < -FAINT]
            if not coming:
                break
            taken: dict[int, list[int]] = {}
            for _, discs, wall in coming:
                for i in discs:
                    if self.bodies[i].m != mpf("inf"):
                        others = taken.setdefault(i, [])
                        if any(min(wall, other) < 0 or abs(self._cosine(wall, other)) > FAINT for other in others):
                            raise NotForThis("two that share a disc push at once")
                        others.append(wall)
            for name, discs, wall in coming:
                pushed.add(name)
                self.push(discs, wall)
        else:
            raise NotForThis("pushes without end")
        if pushed:
            did.hits.append((self.now, frozenset(pushed)))
        self._settle(did, contacts, before)

    def _settle(
        self,
        did: Did,
        contacts: list[tuple[tuple[str, str], tuple[int, ...], int]],
        before: dict[int, int] | None = None,
    ) -> None:
        for (who, other), discs, k in contacts:
            i = discs[0]
            if k < 0:
                if abs(self.closing(discs, k)) < FAINT and not self._moves_as_one(discs):
                    raise NotForThis("two that touch, and neither approach nor part")
                continue
            s, (_, _, _, nx, ny) = self.sides[i][k], self.walls[k]
            pull, along = s * (self.g[0] * nx + self.g[1] * ny), self.g[0] * ny - self.g[1] * nx
            if abs(self.closing(discs, k)) < FAINT and i not in self.carried:
                still = [w for _, ds, w in contacts if ds[0] == i and w > k and abs(self.closing(ds, w)) < FAINT]
                held = next((w for w in still if self._hold(i, k, w)), None)
                if held is None and pull >= 0:
                    continue
                if held is None and along != 0:
                    if any(self._hold(i, w, v) for w in (k, *still) for v in still):
                        continue
                    raise NotForThis("at rest on a slope")
                if held is not None:
                    self.bodies[i].vx = self.bodies[i].vy = mpf(0)
                self.carried[i] = k
                b, speed = self.bodies[i], self.closing(discs, k) * s
                b.vx, b.vy = b.vx - speed * nx, b.vy - speed * ny
                if before is None or before.get(i) != k:
                    did.settled.append((self.now, who, other))

    def _cosine(self, one: int, other: int) -> mpf:
        """Of the angle between two walls' normals."""
        return self.walls[one][3] * self.walls[other][3] + self.walls[one][4] * self.walls[other][4]

    def _hold(self, i: int, one: int, other: int) -> bool:
        """Whether two walls hold a disc: the forces p and q along their normals that balance gravity both push."""
        (ax, ay), (bx, by) = (
            (self.sides[i][k] * self.walls[k][3], self.sides[i][k] * self.walls[k][4]) for k in (one, other)
        )
        turn = ax * by - ay * bx
        if abs(turn) < FAINT:
            return False
        p, q = (bx * self.g[1] - by * self.g[0]) / turn, (ay * self.g[0] - ax * self.g[1]) / turn
        return p > FAINT and q > FAINT

    def _moves_as_one(self, discs: tuple[int, ...]) -> bool:
        a, b = (self.bodies[i] for i in discs)
        return (discs[0] in self.carried) is (discs[1] in self.carried) and abs(b.vx - a.vx) + abs(b.vy - a.vy) < FAINT
