"""Discs under uniform gravity, walls that may move, simulated anew in true coordinates: shares no code with truebreak.

Every disc is moved to every event along its parabola. A meeting is a zero, later than now, at which a gap falls: it is
looked for among all zeros, by the sign of the gap's derivative there; no formula says which of them it is.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from mpmath import mpf, sqrt, workdps

from truebreak.scenarios import Quantity, Scene

DIGITS = 120
NOW = mpf(10) ** -50
"""Zeros this near to now are those of the contact that has just been; contacts this near to each other are a tie."""


class TieMet(Exception):
    """Two contacts at one instant: not for this referee."""


@dataclass
class Body:
    """A disc in true coordinates, at the time at hand."""

    x: mpf
    y: mpf
    vx: mpf
    vy: mpf
    r: mpf
    m: mpf


@dataclass
class Hit:
    """A contact: when, of which disc, with which disc or (after those) wall."""

    time: mpf
    pair: tuple[str, str]


@dataclass
class Course:
    """What a run did."""

    hits: list[Hit] = field(default_factory=list)
    bodies: list[Body] = field(default_factory=list)


def number(value: Quantity) -> mpf:
    """A number of a scene to all digits."""
    return mpf(value.digits(DIGITS + 10))  # at the working precision


def falling_zeros(a: mpf, b: mpf, c: mpf) -> list[mpf]:
    """The times after now at which a t**2 + b t + c is zero and falls."""
    if a == 0:
        return [] if b == 0 else [t for t in [-c / b] if t > NOW and b < 0]
    disc = b * b - 4 * a * c
    if abs(disc) < NOW * (b * b + abs(a * c) + NOW):
        return []  # a graze, which pushes nothing
    if disc < 0:
        return []
    return [t for s in (1, -1) if (t := (-b + s * sqrt(disc)) / (2 * a)) > NOW and 2 * a * t + b < 0]


class GravityReferee:
    """One run.

    Args:
        scene: of discs that move, and walls.
    """

    def __init__(self, scene: Scene) -> None:
        self.ids = [str(c.id) for c in scene.circles]
        with workdps(DIGITS):
            self.g = [number(part) for part in scene.gravity or (Quantity.of(0), Quantity.of(0))]
            self.e = number(scene.restitution)
            self.bodies = [Body(*(number(q) for q in (c.x, c.y, c.vx, c.vy, c.r)), number(c.m)) for c in scene.circles]
            self.walls = [(str(w.id), [number(q) for q in (w.x0, w.y0, w.x1, w.y1)]) for w in scene.walls]
            self.paces = [(number(w.vx), number(w.vy)) for w in scene.walls]
            self.now = mpf(0)
            self.sides = [[self._height(b, k) > 0 for k in range(len(self.walls))] for b in self.bodies]

    def _normal(self, k: int) -> tuple[mpf, mpf, mpf, mpf]:
        x0, y0, x1, y1 = self.walls[k][1]
        ux, uy = self.paces[k]
        x0, y0, x1, y1 = x0 + ux * self.now, y0 + uy * self.now, x1 + ux * self.now, y1 + uy * self.now
        ux, uy = x1 - x0, y1 - y0
        length = sqrt(ux * ux + uy * uy)
        return x0, y0, -uy / length, ux / length

    def _height(self, b: Body, k: int) -> mpf:
        x0, y0, nx, ny = self._normal(k)
        return nx * (b.x - x0) + ny * (b.y - y0)

    def run(self, until: mpf, events: int) -> Course:
        """Up to a time or a number of contacts; the discs as they are at that time, or after the last contact."""
        with workdps(DIGITS):
            course = Course(bodies=self.bodies)
            while len(course.hits) < events:
                found = sorted(self._coming(), key=lambda row: row[0])
                if len(found) > 1 and found[1][0] - found[0][0] < NOW:
                    raise TieMet("a tie")
                if not found or self.now + found[0][0] > until:
                    self._fly(until - self.now)
                    return course
                wait, i, j = found[0]
                self._fly(wait)
                other = self._push(i, j)
                course.hits.append(Hit(self.now, (self.ids[i], other)))
            return course

    def _fly(self, t: mpf) -> None:
        gx, gy = self.g
        self.now += t
        for b in self.bodies:
            b.x, b.y = b.x + b.vx * t + gx * t * t / 2, b.y + b.vy * t + gy * t * t / 2
            b.vx, b.vy = b.vx + gx * t, b.vy + gy * t

    def _coming(self) -> list[tuple[mpf, int, int]]:
        found, n, (gx, gy) = [], len(self.bodies), self.g
        for i, a in enumerate(self.bodies):
            for j in range(i + 1, n):
                b = self.bodies[j]
                dx, dy, vx, vy, reach = b.x - a.x, b.y - a.y, b.vx - a.vx, b.vy - a.vy, a.r + b.r
                zeros = falling_zeros(vx * vx + vy * vy, 2 * (dx * vx + dy * vy), dx * dx + dy * dy - reach * reach)
                found += [(t, i, j) for t in zeros]
            for k in range(len(self.walls)):
                _, _, nx, ny = self._normal(k)
                ux, uy = self.paces[k]
                s = 1 if self.sides[i][k] else -1
                zeros = falling_zeros(
                    s * (nx * gx + ny * gy) / 2, s * (nx * (a.vx - ux) + ny * (a.vy - uy)), s * self._height(a, k) - a.r
                )
                found += [(t, i, n + k) for t in zeros]
        return found

    def _push(self, i: int, j: int) -> str:
        a, n = self.bodies[i], len(self.bodies)
        if j >= n:
            _, _, nx, ny = self._normal(j - n)
            ux, uy = self.paces[j - n]
            change = (1 + self.e) * (nx * (a.vx - ux) + ny * (a.vy - uy))
            a.vx, a.vy = a.vx - change * nx, a.vy - change * ny
            return self.walls[j - n][0]
        b = self.bodies[j]
        nx, ny = (b.x - a.x) / (a.r + b.r), (b.y - a.y) / (a.r + b.r)
        impulse = -(1 + self.e) * (nx * (b.vx - a.vx) + ny * (b.vy - a.vy)) / (1 / a.m + 1 / b.m)
        a.vx, a.vy = a.vx - impulse / a.m * nx, a.vy - impulse / a.m * ny
        b.vx, b.vy = b.vx + impulse / b.m * nx, b.vy + impulse / b.m * ny
        return self.ids[j]
