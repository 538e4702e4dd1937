"""Mirrors and rotations that map a scene to itself, found exactly.

They are candidates for isometries that map the past of a circle to itself (`symmetry.held`), and what `--symmetric`
asks for. That a history keeps a symmetry is proved on its log (`symmetry.log_symmetry`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import lru_cache
from math import inf
from typing import TypeAlias

from ...scenarios.lazy import frozen
from ...scenarios.scene import Scene
from ..numbers.field import LeavesField
from .isometry import Isometry, Matrix, Vector, from_vectors, minus, scene_data, turned

NEAR = 1e-6
"""How far, relatively, an image may be from its target in doubles and still be looked at exactly; it only spares
exact work on candidates that are plainly none."""


Likely: TypeAlias = tuple[int, bool, int, bool]
"""A circle, whether by its velocity (else by its place), the circle whose velocity or place is its image; mirror?"""


@frozen
class Symmetry:
    """An isometry that maps the scene to itself.

    Attributes:
        matrix: its linear part (a, b, c, d): (x, y) becomes (a x + b y, c x + d y), about `centre`.
        centre: a point that it leaves in place, the mean of the circles' centres.
        circles: for each circle, the index of its image.
        walls: for each wall, the index of its image.
        mirror: whether it is a reflection (else a rotation).
    """

    matrix: Matrix
    centre: Vector
    circles: tuple[int, ...]
    walls: tuple[int, ...]
    mirror: bool


@lru_cache(maxsize=8)
def symmetries(scene: Scene) -> tuple[Symmetry, ...]:
    """All mirrors and rotations of a scene, without the identity; none if its numbers are too deep to tell.

    >>> from truebreak.scenarios import Circle, Scene
    >>> [s.circles for s in symmetries(Scene([Circle(0, 3, vx=1), Circle(0, -3, vx=1), Circle(9, 0, vx=-1)]))]
    [(1, 0, 2)]
    """
    if len(scene.circles) < 2 and not scene.walls:
        return ()
    rough = _Rough(scene)
    if not rough.usable:
        return ()
    wanted = list(rough.candidates())
    try:
        return tuple(_exactly(scene, wanted)) if wanted else ()
    except LeavesField:
        return ()


class _Rough:
    """The scene in doubles: picks the isometries worth an exact check."""

    def __init__(self, scene: Scene) -> None:
        try:
            self.rows: list[tuple[float, ...]] = [
                (float(c.x), float(c.y), float(c.vx), float(c.vy), float(c.r), float(c.inverse_mass))
                for c in scene.circles
            ]
        except OverflowError:
            self.usable = False
            return
        n = len(self.rows)
        cx, cy = sum(row[0] for row in self.rows) / n, sum(row[1] for row in self.rows) / n
        self.rows = [(x - cx, y - cy, *rest) for x, y, *rest in self.rows]
        self.size = max(abs(value) for row in self.rows for value in row[:2]) or 1.0
        self.speed = max(abs(value) for row in self.rows for value in row[2:4]) or 1.0
        self.usable = True

    def candidates(self) -> Iterator[Likely]:
        """Isometries that nearly fit."""
        rows = self.rows
        reference = max(range(len(rows)), key=lambda i: abs(rows[i][0]) + abs(rows[i][1]))
        by_velocity = abs(rows[reference][0]) + abs(rows[reference][1]) < NEAR * self.size or len(rows) == 1
        if by_velocity:
            reference = max(range(len(rows)), key=lambda i: abs(rows[i][2]) + abs(rows[i][3]))
            if rows[reference][2] == 0.0 == rows[reference][3]:
                return
        at = 2 if by_velocity else 0
        ux, uy = rows[reference][at : at + 2]
        square = ux * ux + uy * uy
        if not 0.0 < square < inf:
            return
        for j, row in enumerate(rows):
            if row[4:] != rows[reference][4:]:
                continue
            wx, wy = row[at : at + 2]
            if abs(wx * wx + wy * wy - square) > NEAR * square:
                continue
            for mirror in (False, True):
                if not mirror and j == reference:
                    continue
                c = (ux * wx - uy * wy if mirror else ux * wx + uy * wy) / square
                s = (ux * wy + uy * wx if mirror else ux * wy - uy * wx) / square
                if self._fits((c, s if mirror else -s, s, -c if mirror else c)):
                    yield reference, by_velocity, j, mirror

    def _fits(self, m: tuple[float, float, float, float]) -> bool:
        a, b, c, d = m
        near, slow = NEAR * self.size, NEAR * self.speed
        for x, y, vx, vy, r, w in self.rows:
            gx, gy, hx, hy = a * x + b * y, c * x + d * y, a * vx + b * vy, c * vx + d * vy
            if not any(
                abs(gx - p) <= near and abs(gy - q) <= near and abs(hx - s) <= slow and abs(hy - t) <= slow
                for p, q, s, t, r2, w2 in self.rows
                if r2 == r and w2 == w
            ):
                return False
        return True


def _exactly(scene: Scene, wanted: Iterable[Likely]) -> Iterator[Symmetry]:
    """Those of the candidates that map the scene to itself."""
    data = scene_data(scene)
    x, y = (sum((place[k] for place in data.places[1:]), start=data.places[0][k]) / data.n for k in (0, 1))
    centre = (x, y)
    arms = [minus(place, centre) for place in data.places]
    for circle, by_velocity, image, mirror in wanted:
        vectors = data.speeds if by_velocity else arms
        matrices = list(from_vectors([vectors[circle]], [vectors[image]]))
        if not matrices:
            continue
        matrix = matrices[mirror]
        g = Isometry(data, matrix, minus(centre, turned(matrix, centre)))
        circles = _all_apart([g.circle(i) for i in range(data.n)])
        walls = _all_apart([g.wall(k) for k in range(len(data.walls))])
        held = not scene.capture or all(g.pocket(k) is not None for k in range(len(data.pockets)))
        if circles is not None and walls is not None and held:
            yield Symmetry(matrix, centre, circles, walls, mirror)


def _all_apart(images: list[int | None]) -> tuple[int, ...] | None:
    """The images, if each thing has one of its own."""
    found = tuple(image for image in images if image is not None)
    return found if len(set(found)) == len(images) else None
