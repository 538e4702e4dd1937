"""Segments and polygons beside discs, walls and fixed discs under uniform gravity, simulated anew in true coordinates
with mpmath: shares no code with truebreak.

A segment is all that is within its half thickness of the line between its points. A disc comes to it along the line
where its height over that falls to the sum of both radii, on either side, at a time at which it is beside the line; or
at an end, which is a fixed disc. Of a polygon every side is such a segment; a disc outside of it is never beside the
inner side of one, so that both sides are looked at here too.
"""

from __future__ import annotations

from typing import Any, TypeAlias

from gravity_referee import Body, TieMet, falling_zeros, number
from mpmath import mpf, sqrt, workdps
from peg_referee import DIGITS, NotForThis, PegReferee

from truebreak.scenarios import Scene

Bar: TypeAlias = tuple[str, Any, Any, Any, Any, Any]
"""Whose it is, from where to where, and its half thickness."""


class FaceReferee(PegReferee):
    """One run; a thing's ends are fixed discs that bear its name."""

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        with workdps(DIGITS):
            self.bars: list[Bar] = [
                (str(s.id), *(number(q) for q in (s.x0, s.y0, s.x1, s.y1, s.r))) for s in scene.segments
            ]
            for polygon in scene.polygons:
                corners = [(number(x), number(y)) for x, y in polygon.points]
                for (x0, y0), (x1, y1) in zip(corners, [*corners[1:], corners[0]], strict=True):
                    self.bars.append((str(polygon.id), x0, y0, x1, y1, number(polygon.r)))
            ends: dict[tuple[Any, Any], tuple[str, Any]] = {}
            for name, x0, y0, x1, y1, r in self.bars:
                for place in ((x0, y0), (x1, y1)):
                    if place not in ends or ends[place][1] < r:
                        ends[place] = name, r
            self.peg_ids += [(name, *place, r) for place, (name, r) in ends.items()]
        self.first_bar = len(self.bodies) + len(self.walls) + len(self.peg_ids)

    def _coming(self) -> list[tuple[mpf, int, int]]:
        found, (gx, gy) = super()._coming(), self.g
        for i, a in enumerate(self.bodies):
            for k, (_, x0, y0, x1, y1, r) in enumerate(self.bars):
                length = sqrt((x1 - x0) ** 2 + (y1 - y0) ** 2)
                ux, uy = (x1 - x0) / length, (y1 - y0) / length
                for side in (1, -1):
                    nx, ny = -side * uy, side * ux
                    zeros = falling_zeros(
                        (nx * gx + ny * gy) / 2,
                        nx * a.vx + ny * a.vy,
                        nx * (a.x - x0) + ny * (a.y - y0) - r - a.r,
                    )
                    for t in zeros:
                        x, y = a.x + a.vx * t + gx * t * t / 2, a.y + a.vy * t + gy * t * t / 2
                        along = ux * (x - x0) + uy * (y - y0)
                        if abs(along) < mpf(10) ** -40 or abs(along - length) < mpf(10) ** -40:
                            raise TieMet("a joint")
                        if 0 < along < length:
                            found.append((t, i, self.first_bar + 2 * k + (side < 0)))
        return found

    def _push(self, i: int, j: int) -> str:
        if j < self.first_bar:
            return super()._push(i, j)
        k, back = divmod(j - self.first_bar, 2)
        name, x0, y0, x1, y1, _ = self.bars[k]
        a: Body = self.bodies[i]
        length = sqrt((x1 - x0) ** 2 + (y1 - y0) ** 2)
        nx, ny = -(y1 - y0) / length, (x1 - x0) / length
        if back:
            nx, ny = -nx, -ny
        change = (1 + self.e) * (nx * a.vx + ny * a.vy)
        a.vx, a.vy = a.vx - change * nx, a.vy - change * ny
        return name


__all__ = ["FaceReferee", "NotForThis", "TieMet"]
