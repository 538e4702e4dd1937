"""The few isometries that may map one meeting of a scene to another, or a circle's past to itself, from data alone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from .tower import ONE, ZERO, Exact, text_of

Contact = tuple[int, int]
Vector = tuple[Exact, Exact]
Matrix = tuple[Exact, Exact, Exact, Exact]
TWO = ONE + ONE


class Isometries:
    """Finds isometries of a scene and says what they map to what.

    Args:
        things: circles, walls and pockets by index, in exact numbers, as the checker reads them.
        n: how many of them are circles.
        faces: which of them are faces of segments, the last of the walls.
        arcs: which of them are sides of arcs, after these.
        drift: the velocities of walls and faces that move, by index.
        pull: gravity.
    """

    def __init__(
        self,
        things: dict[int, list[Exact]],
        n: int,
        faces: range,
        arcs: range,
        drift: Mapping[int, Vector],
        pull: Vector | None,
    ) -> None:
        self.drift, self.pull = drift, pull
        self.circles, self.n = [things[i] for i in range(n)], n
        self.walls = [row[:4] for k, row in things.items() if n <= k < arcs.start]
        self.sides, self._first_side = [things[k] for k in arcs], arcs.start
        self._side_of = {_key([*row, _hollow(k)]): k for k, row in enumerate(self.sides)}
        self.pockets = [[things[k][0], things[k][1], things[k][4]] for k in sorted(things, reverse=True) if k < 0]
        self._circle_of = {_key(row): i for i, row in enumerate(self.circles)}
        self._thick = [things[k][5] for k in faces]
        self._first = faces.start - n
        self._wall_of = {_key(_line(*row)): k for k, row in enumerate(self.walls[: self._first])}
        rows = zip(self.walls[self._first :], self._thick, strict=True)
        self._face_of = {_key([*_face(*row), r, *self._way(k)]): k for k, (row, r) in enumerate(rows, self._first)}
        self._pocket_of = {_key(row): k for k, row in enumerate(self.pockets)}

    def between(self, c: Contact, other: Contact) -> Iterator[dict[str, Any]]:
        """Those that take one meeting's data to another's."""
        (i, j), (k, m) = c, other
        if self._sort(j) != self._sort(m):
            return
        for to, of in ((k, m), (m, k)) if 0 <= j < self.n else ((k, m),):
            sources, images = [self._speed(i), self._arm(i, j)], [self._speed(to), self._arm(to, of)]
            if 0 <= j < self.n:
                sources.append(self._speed(j))
                images.append(self._speed(of))
            for matrix in orthogonal_maps(sources, images):
                yield self._told(matrix, i, to)

    def holding(self, c: Contact) -> Iterator[dict[str, Any]]:
        """Those that may show that a closing speed is zero: the mirror along a wall, the shift between two circles."""
        i, j = c
        if j >= self._first_side:
            return
        if j >= self.n:
            _, _, nx, ny = self.walls[j - self.n]
            square = nx * nx + ny * ny
            across = -(TWO * nx * ny) / square
            yield self._told((ONE - TWO * nx * nx / square, across, across, ONE - TWO * ny * ny / square), i, i)
        elif j >= 0:
            yield self._told((ONE, ZERO, ZERO, ONE), i, j)

    def _sort(self, j: int) -> tuple[bool, bool, int]:
        """What an index stands for: pocket, circle, wall or face, either side of an arc."""
        side = j - self._first_side
        return j < 0, j < self.n, -1 if side < 0 else side % 2

    def _as_fast(self, m: int, image: int, matrix: Matrix) -> bool:
        """Whether a wall and its image stay mapped as time goes on: both as they move, and as the frame falls."""
        a, b, d, e = matrix
        ways = [(self.pull, self.pull)] if self.pull else []
        ways += [(self._way(m), self._way(image))]
        _, _, nx, ny = self.walls[image]
        return not any((a * x + b * y - u) * nx + (d * x + e * y - v) * ny for (x, y), (u, v) in ways)

    def _way(self, m: int) -> Vector:
        """The velocity of a wall, or of a face."""
        return self.drift.get(self.n + m, (ZERO, ZERO))

    def _speed(self, i: int) -> Vector:
        return self.circles[i][2], self.circles[i][3]

    def _arm(self, i: int, j: int) -> Vector:
        """The vector from a circle's centre to the other one, to a pocket's, an arc's, or at right angles to a wall."""
        x, y = self.circles[i][:2]
        if j >= self._first_side:
            u, v = self.sides[j - self._first_side][:2]
            return u - x, v - y
        if j >= self.n:
            x0, y0, nx, ny = self.walls[j - self.n]
            scale = (nx * (x0 - x) + ny * (y0 - y)) / (nx * nx + ny * ny)
            return scale * nx, scale * ny
        u, v = self.circles[j][:2] if j >= 0 else self.pockets[-1 - j][:2]
        return u - x, v - y

    def _told(self, matrix: Matrix, i: int, k: int) -> dict[str, Any]:
        """The isometry of a linear part that takes centre i to centre k, in the terms of a certificate."""
        a, b, d, e = matrix
        (x, y), (u, v) = self.circles[i][:2], self.circles[k][:2]
        gx, gy = self.pull or (ZERO, ZERO)
        falls = not (a * gx + b * gy - gx or d * gx + e * gy - gy)  # else nothing that stands is mapped
        p, q = u - (a * x + b * y), v - (d * x + e * y)

        def turned(x: Exact, y: Exact) -> Vector:
            return a * x + b * y, d * x + e * y

        def moved(x: Exact, y: Exact) -> Vector:
            return a * x + b * y + p, d * x + e * y + q

        pairs: list[list[int]] = []
        for m, (x, y, vx, vy, *kind) in enumerate(self.circles):
            image = self._circle_of.get(_key([*moved(x, y), *turned(vx, vy), *kind])) if falls or kind[1] else None
            pairs += [] if image is None else [[m, image]]
        for m, (x, y, nx, ny) in enumerate(self.walls):
            if m < self._first:
                image = self._wall_of.get(_key(_line(*moved(x, y), *turned(nx, ny))))
                if image is not None and not self._as_fast(m, image, matrix):
                    image = None
            else:
                (x, y), (u, v) = moved(x, y), moved(x + ny, y - nx)
                key = [x + u, y + v, *turned(nx, ny), self._thick[m - self._first], *turned(*self._way(m))]
                image = self._face_of.get(_key(key)) if falls else None
            pairs += [] if image is None else [[self.n + m, self.n + image]]
        for m, (x, y, nx, ny, *kind) in enumerate(self.sides):
            image = self._side_of.get(_key([*moved(x, y), *turned(nx, ny), *kind, _hollow(m)])) if falls else None
            pairs += [] if image is None else [[self._first_side + m, self._first_side + image]]
        for m, (x, y, r) in enumerate(self.pockets):
            image = self._pocket_of.get(_key([*moved(x, y), r])) if falls else None
            pairs += [] if image is None else [[-1 - m, -1 - image]]
        one_each = list({image: pair for pair in pairs for image in pair[1:]}.values())  # two may be alike
        return {"matrix": [text_of(x) for x in matrix], "shift": [text_of(p), text_of(q)], "map": one_each}


def orthogonal_maps(sources: Sequence[Vector], images: Sequence[Vector]) -> Iterator[Matrix]:
    """The orthogonal linear maps, two at most, that take each vector to its image; none where all are zero."""
    for (ux, uy), (wx, wy) in zip(sources, images, strict=True):
        square = ux * ux + uy * uy
        if square - (wx * wx + wy * wy):
            return
        if square:
            break
    else:
        return
    along, across = (ux * wx + uy * wy) / square, (ux * wy - uy * wx) / square
    mirrored, skew = (ux * wx - uy * wy) / square, (ux * wy + uy * wx) / square
    for a, b, d, e in ((along, -across, across, along), (mirrored, skew, skew, -mirrored)):
        pairs = zip(sources, images, strict=True)
        if not any((a * x + b * y - u) or (d * x + e * y - v) for (x, y), (u, v) in pairs):
            yield a, b, d, e


def _hollow(side: int) -> Exact:
    return ONE if side % 2 else ZERO


def _line(x: Exact, y: Exact, nx: Exact, ny: Exact) -> list[Exact]:
    """A line's normal form: n.p = c with the first component of n that is not zero made 1."""
    offset = nx * x + ny * y
    return [ZERO, ONE, offset / ny] if not nx else [ONE, ny / nx, offset / nx]


def _face(x: Exact, y: Exact, nx: Exact, ny: Exact) -> list[Exact]:
    """Twice the middle of a face, which begins at (x, y), and its normal: whichever way round an isometry puts it."""
    return [x + x + ny, y + y - nx, nx, ny]


def _key(numbers: Sequence[Exact]) -> tuple[str, ...]:
    return tuple(text_of(number) for number in numbers)
