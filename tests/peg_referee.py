"""Discs, walls and fixed discs under uniform gravity, simulated anew in true coordinates with mpmath: shares no code
with truebreak.

Whether and when a disc comes to a fixed one is looked for among all four zeros of the squared distance as a polynomial
of the time, made anew by sampling it at five times; each zero is polished by Newton's rule to all digits from what
numpy says of it, and where that does not give four zeros apart from one another the scene is not for this referee.
"""

from __future__ import annotations

import numpy as np
from gravity_referee import DIGITS, NOW, Body, Course, GravityReferee, Hit, TieMet, number
from mpmath import mpc, mpf, workdps

from truebreak.scenarios import Scene


class NotForThis(Exception):
    """Zeros that cannot be told apart."""


def interpolated(values: list[mpf]) -> list[mpf]:
    """Coefficients, the constant one first, of the quartic with these values at -2, -1, 0, 1, 2."""
    a, b, c, d, e = values
    even2, odd1, even4, odd3 = (b + d) / 2 - c, (d - b) / 2, (a + e) / 2 - c, (e - a) / 2
    c4 = (even4 - 4 * even2) / 12
    c3 = (odd3 - 2 * odd1) / 6
    return [c, odd1 - c3, even2 - c4, c3, c4]


def zeros_of(c: list[mpf]) -> list[mpc]:
    """All zeros, polished; the leading coefficient is not zero."""
    seeds = np.roots([float(x) for x in reversed(c)])
    found: list[mpc] = []
    for seed in seeds:
        z = mpc(complex(seed))
        for _ in range(60):
            p, q = mpc(0), mpc(0)
            for x in reversed(c):
                q = q * z + p
                p = p * z + x
            if q == 0:
                raise NotForThis
            step = p / q
            z -= step
            if abs(step) < mpf(10) ** (8 - DIGITS) * (1 + abs(z)):
                break
        else:
            raise NotForThis
        found.append(z)
    if any(abs(z - w) < mpf(10) ** -30 * (1 + abs(z)) for k, z in enumerate(found) for w in found[:k]):
        raise NotForThis
    return found


class PegReferee(GravityReferee):
    """One run; circles of infinite mass stand."""

    def __init__(self, scene: Scene) -> None:
        with workdps(DIGITS):
            self.pegs = {k: [number(q) for q in (c.x, c.y, c.r)] for k, c in enumerate(scene.circles) if c.fixed}
            movable = [c for c in scene.circles if not c.fixed]
            self.peg_ids = [(str(scene.circles[k].id), *row) for k, row in self.pegs.items()]
        self.ids = [str(c.id) for c in movable]
        with workdps(DIGITS):
            assert scene.gravity is not None
            self.g = [number(part) for part in scene.gravity]
            self.e = number(scene.restitution)
            self.bodies = [Body(*(number(q) for q in (c.x, c.y, c.vx, c.vy, c.r)), number(c.m)) for c in movable]
            self.walls = [(str(w.id), [number(q) for q in (w.x0, w.y0, w.x1, w.y1)]) for w in scene.walls]
            self.paces = [(number(w.vx), number(w.vy)) for w in scene.walls]
            self.now = mpf(0)
            self.sides = [[self._height(b, k) > 0 for k in range(len(self.walls))] for b in self.bodies]

    def _coming(self) -> list[tuple[mpf, int, int]]:
        found, (gx, gy) = super()._coming(), self.g
        first = len(self.bodies) + len(self.walls)
        for i, a in enumerate(self.bodies):
            for k, (_, px, py, pr) in enumerate(self.peg_ids):

                def gap(t: mpf, a: Body = a, px: mpf = px, py: mpf = py, pr: mpf = pr) -> mpf:
                    x, y = a.x + a.vx * t + gx * t * t / 2, a.y + a.vy * t + gy * t * t / 2
                    return (x - px) ** 2 + (y - py) ** 2 - (a.r + pr) ** 2

                c = interpolated([gap(mpf(t)) for t in (-2, -1, 0, 1, 2)])
                for z in zeros_of(c):
                    if abs(z.imag) > NOW:
                        continue
                    t = z.real
                    slope = c[1] + t * (2 * c[2] + t * (3 * c[3] + t * 4 * c[4]))
                    if t > NOW and slope < 0:
                        found.append((t, i, first + k))
        return found

    def _push(self, i: int, j: int) -> str:
        first = len(self.bodies) + len(self.walls)
        if j < first:
            return super()._push(i, j)
        a, (name, px, py, pr) = self.bodies[i], self.peg_ids[j - first]
        nx, ny = (px - a.x) / (a.r + pr), (py - a.y) / (a.r + pr)
        change = (1 + self.e) * (nx * a.vx + ny * a.vy)
        a.vx, a.vy = a.vx - change * nx, a.vy - change * ny
        return name


__all__ = ["Course", "Hit", "NotForThis", "PegReferee", "TieMet"]
