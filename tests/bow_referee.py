"""Arcs beside all that the referee of faces has, under uniform gravity, in true coordinates with mpmath: shares no code
with truebreak.

An arc is all places of a circle whose angle about its middle lies between two. A disc comes to it where the distance
of its middle from that of the arc rises to the difference of both radii, or falls to their sum, at an angle of the arc;
or at an end, which is a fixed disc of radius 0. All zeros of both are looked at, each at its own angle.
"""

from __future__ import annotations

from face_referee import FaceReferee, NotForThis, TieMet
from gravity_referee import NOW, Body, Course, number
from mpmath import atan2, cos, mpf, pi, sin, workdps
from peg_referee import DIGITS, interpolated, zeros_of

from truebreak.scenarios import Scene

ANGLE = mpf(10) ** -40
"""Angles nearer to each other than this are not told apart."""


class BowReferee(FaceReferee):
    """One run; the ends of arcs are fixed discs that bear their names."""

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        with workdps(DIGITS):
            self.bows: list[tuple[str, mpf, mpf, mpf, mpf, mpf]] = []
            for arc in scene.arcs:
                x, y, r, x0, y0, x1, y1 = (number(q) for q in (arc.x, arc.y, arc.r, arc.x0, arc.y0, arc.x1, arc.y1))
                if arc.full:
                    self.bows.append((str(arc.id), x, y, r, mpf(0), 2 * pi))
                    continue
                start = atan2(y0 - y, x0 - x)
                turn = (atan2(y1 - y, x1 - x) - start) % (2 * pi)
                self.bows.append((str(arc.id), x, y, r, start, turn))
                for angle in (start, start + turn):
                    px, py = x + r * cos(angle), y + r * sin(angle)
                    if all(abs(qx - px) + abs(qy - py) > ANGLE for _, qx, qy, _ in self.peg_ids):
                        self.peg_ids.append((str(arc.id), px, py, mpf(0)))
            self.first_bar = len(self.bodies) + len(self.walls) + len(self.peg_ids)
        self.first_bow = self.first_bar + 2 * len(self.bars)

    def _coming(self) -> list[tuple[mpf, int, int]]:
        found, (gx, gy) = super()._coming(), self.g
        for i, a in enumerate(self.bodies):
            for k, (_, cx, cy, r, start, turn) in enumerate(self.bows):
                for inner in (False, True):
                    reach = r - a.r if inner else r + a.r
                    if reach <= 0:
                        continue

                    def square(t: mpf, a: Body = a, cx: mpf = cx, cy: mpf = cy) -> mpf:
                        x, y = a.x + a.vx * t + gx * t * t / 2, a.y + a.vy * t + gy * t * t / 2
                        return (x - cx) ** 2 + (y - cy) ** 2

                    c = interpolated([square(mpf(t)) - reach**2 for t in (-2, -1, 0, 1, 2)])
                    for z in zeros_of(c):
                        t = z.real
                        if abs(z.imag) > NOW or t <= NOW:
                            continue
                        rises = c[1] + t * (2 * c[2] + t * (3 * c[3] + t * 4 * c[4])) > 0
                        if rises != inner:
                            continue
                        x, y = a.x + a.vx * t + gx * t * t / 2, a.y + a.vy * t + gy * t * t / 2
                        angle = (atan2(y - cy, x - cx) - start) % (2 * pi)
                        if turn < 2 * pi and min(angle, abs(angle - turn), 2 * pi - angle) < ANGLE:
                            raise TieMet("at an end")
                        if turn >= 2 * pi or angle < turn:
                            found.append((t, i, self.first_bow + 2 * k + inner))
        return found

    def entries(self, scene: Scene, course: Course, until: mpf) -> list[tuple[mpf, str, str]]:
        """When centres come into pockets up to a time: on each flight between two contacts at all zeros that fall.

        Args:
            course: of another run of the same referee, whose contacts tell where flights end.
        """
        found: list[tuple[mpf, str, str]] = []
        with workdps(DIGITS):
            (gx, gy), ends = self.g, [*(hit.time for hit in course.hits), until]
            for end in ends:
                span = min(end, until) - self.now
                for i, a in enumerate(self.bodies):
                    for pocket in scene.pockets:
                        px, py, r = number(pocket.x), number(pocket.y), number(pocket.r)

                        def gap(t: mpf, a: Body = a, px: mpf = px, py: mpf = py, r: mpf = r) -> mpf:
                            x, y = a.x + a.vx * t + gx * t * t / 2, a.y + a.vy * t + gy * t * t / 2
                            return (x - px) ** 2 + (y - py) ** 2 - r**2

                        c = interpolated([gap(mpf(t)) for t in (-2, -1, 0, 1, 2)])
                        for z in zeros_of(c):
                            t = z.real
                            slope = c[1] + t * (2 * c[2] + t * (3 * c[3] + t * 4 * c[4]))
                            if abs(z.imag) < NOW < t < span and slope < 0:
                                found.append((self.now + t, self.ids[i], str(pocket.id)))
                if end >= until:
                    break
                wait, i, j = min(self._coming(), key=lambda row: row[0])
                self._fly(wait)
                self._push(i, j)
        return sorted(found)

    def _push(self, i: int, j: int) -> str:
        if j < self.first_bow:
            return super()._push(i, j)
        a, (name, cx, cy, *_) = self.bodies[i], self.bows[(j - self.first_bow) // 2]
        far = ((a.x - cx) ** 2 + (a.y - cy) ** 2) ** mpf("0.5")
        nx, ny = (a.x - cx) / far, (a.y - cy) / far
        change = (1 + self.e) * (nx * a.vx + ny * a.vy)
        a.vx, a.vy = a.vx - change * nx, a.vy - change * ny
        return name


__all__ = ["BowReferee", "NotForThis", "TieMet"]
