"""Mirrors and rotations that map a scene to itself, found exactly.

They are candidates for isometries that map the past of a circle to itself (`predicates.held`), and what `--symmetric`
asks for. That a history keeps a symmetry is proved on its log (`predicates.log_symmetry`).
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from math import inf
from typing import Any

from ...scenarios.errors import SceneError
from ...scenarios.frozen import frozen
from ...scenarios.scene import Scene
from ..numbers.field import FieldNumber, LeavesField, field_sign
from .isometry import Matrix, scene_data

NEAR = 1e-6
"""How far, relatively, an image may be from its target in doubles and still be looked at exactly; it only spares
exact work on candidates that are plainly none."""


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
    centre: tuple[FieldNumber, FieldNumber]
    circles: tuple[int, ...]
    walls: tuple[int, ...]
    mirror: bool


def symmetries(scene: Scene) -> tuple[Symmetry, ...]:
    """All mirrors and rotations of a scene, without the identity; none if its numbers are too deep to tell.

    >>> from truebreak.scenarios import Circle, Scene
    >>> [s.circles for s in symmetries(Scene([Circle(0, 3, vx=1), Circle(0, -3, vx=1), Circle(9, 0, vx=-1)]))]
    [(1, 0, 2)]
    """
    return _symmetries(scene)


def require_symmetry(scene: Scene) -> None:
    """Refuses a scene without symmetry.

    Raises:
        SceneError: if no mirror and no rotation maps the scene to itself.
    """
    if not symmetries(scene):
        raise SceneError(
            f"scene {scene.name!r}: no mirror and no rotation maps it to itself exactly; "
            "make it symmetric, or leave out --symmetric"
        )


@lru_cache(maxsize=8)
def _symmetries(scene: Scene) -> tuple[Symmetry, ...]:
    if len(scene.circles) < 2 and not scene.walls:
        return ()
    rough = _Rough(scene)
    if not rough.usable:
        return ()
    wanted = list(rough.candidates())
    if not wanted:
        return ()
    try:
        exact = _Exact(scene)
        found = [exact.check(reference, image, mirror) for reference, image, mirror in wanted]
    except LeavesField:
        return ()
    return tuple(symmetry for symmetry in found if symmetry is not None)


class _Rough:
    """The scene in doubles: picks the isometries worth an exact check."""

    def __init__(self, scene: Scene) -> None:
        try:
            self.rows = [
                (float(c.x), float(c.y), float(c.vx), float(c.vy), float(c.r), float(c.inverse_mass))
                for c in scene.circles
            ]
        except OverflowError:
            self.usable = False
            return
        n = len(self.rows)
        cx, cy = sum(row[0] for row in self.rows) / n, sum(row[1] for row in self.rows) / n
        self.rows = [(x - cx, y - cy, *rest) for x, y, *rest in self.rows]  # type: ignore[misc]
        self.size = max(abs(value) for row in self.rows for value in row[:2]) or 1.0
        self.speed = max(abs(value) for row in self.rows for value in row[2:4]) or 1.0
        self.usable = True

    def _alike(self, a: tuple[float, ...], b: tuple[float, ...]) -> bool:
        return a[4:] == b[4:]

    def candidates(self) -> Iterator[tuple[tuple[int, bool], int, bool]]:
        """(reference circle, by velocity?), image circle, mirror?, for isometries that nearly fit."""
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
            if not self._alike(row, rows[reference]):
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
                    yield (reference, by_velocity), j, mirror

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


class _Exact:
    """The scene in its field: decides whether an isometry maps it to itself."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        data = scene_data(scene)
        n = data.n
        rows = [[*data.places[i], *data.speeds[i], *data.kinds[i]] for i in range(n)]
        cx, cy = _total(row[0] for row in rows) / n, _total(row[1] for row in rows) / n
        self.centre = (cx, cy)
        self.rows = [(x - cx, y - cy, *rest) for x, y, *rest in rows]
        self.walls = [(*point, point[0] + normal[1], point[1] - normal[0], *normal) for point, normal in data.walls]
        self.pockets = [(*place, r) for place, r in data.pockets]

    def check(self, reference: tuple[int, bool], image: int, mirror: bool) -> Symmetry | None:
        """The isometry that maps one circle's place (or velocity) to another's, if it is a symmetry."""
        index, by_velocity = reference
        at = 2 if by_velocity else 0
        ux, uy = self.rows[index][at : at + 2]
        wx, wy = self.rows[image][at : at + 2]
        square = ux * ux + uy * uy
        if field_sign(square) == 0 or not _equal(square, wx * wx + wy * wy):
            return None
        if mirror:
            c, s = (ux * wx - uy * wy) / square, (ux * wy + uy * wx) / square
            matrix = (c, s, s, -c)
        else:
            c, s = (ux * wx + uy * wy) / square, (ux * wy - uy * wx) / square
            matrix = (c, -s, s, c)
        circles = self._map_circles(matrix)
        walls = self._map_walls(matrix) if circles is not None else None
        if circles is None or walls is None or (self.scene.capture and not self._maps_pockets(matrix)):
            return None
        return Symmetry(matrix, self.centre, circles, walls, mirror)

    def _turn(self, m: Matrix, x: FieldNumber, y: FieldNumber) -> tuple[FieldNumber, FieldNumber]:
        return m[0] * x + m[1] * y, m[2] * x + m[3] * y

    def _map_circles(self, m: Matrix) -> tuple[int, ...] | None:
        images: list[int] = []
        for x, y, vx, vy, r, w in self.rows:
            target = (*self._turn(m, x, y), *self._turn(m, vx, vy), r, w)
            match = next((j for j, row in enumerate(self.rows) if all(map(_equal, row, target))), None)
            if match is None:
                return None
            images.append(match)
        return tuple(images) if len(set(images)) == len(images) else None

    def _map_walls(self, m: Matrix) -> tuple[int, ...] | None:
        cx, cy = self.centre
        images: list[int] = []
        for x0, y0, x1, y1, *_ in self.walls:
            ends = [self._turn(m, x - cx, y - cy) for x, y in ((x0, y0), (x1, y1))]
            ends = [(x + cx, y + cy) for x, y in ends]
            match = next((j for j, wall in enumerate(self.walls) if self._on(wall, ends)), None)
            if match is None:
                return None
            images.append(match)
        return tuple(images) if len(set(images)) == len(images) else None

    @staticmethod
    def _on(wall: tuple[FieldNumber, ...], points: list[tuple[FieldNumber, FieldNumber]]) -> bool:
        x0, y0, _, _, nx, ny = wall
        return all(field_sign(nx * (x - x0) + ny * (y - y0)) == 0 for x, y in points)

    def _maps_pockets(self, m: Matrix) -> bool:
        """Whether every pocket has an image among them."""
        cx, cy = self.centre
        for x, y, r in self.pockets:
            gx, gy = self._turn(m, x - cx, y - cy)
            target = (gx + cx, gy + cy, r)
            if not any(all(map(_equal, pocket, target)) for pocket in self.pockets):
                return False
        return True


def _total(numbers: Iterator[Any]) -> Any:
    numbers = iter(numbers)
    total = next(numbers)
    for number in numbers:
        total = total + number
    return total


def _equal(a: FieldNumber, b: FieldNumber) -> bool:
    return field_sign(a - b) == 0
