"""Which walls, and which faces of segments, are near a square cell: those that a circle in it may touch."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, inf
from typing import TypeAlias

from ...scenarios.things import Wall

# -- Which walls are near a cell: those that a circle entered there may touch before it comes to another one.
#
# A circle's centre is within a margin of its cell (see `cells.Cells`), so it touches a wall only where the wall's line
# comes as near to the cell, with the margin all round, as the radius. Heights over a line are compared with that in
# doubles; what their rounding leaves open is near.
#
# It touches a face of a segment only from its own side, with its centre over the face: that centre lies in a rectangle,
# which the face and the radius span. Two rectangles are apart only if the axes of one of them tell so: columns and rows
# tell by the rectangle's box, then heights over the face, and the way along it. Rectangles are closed, and what
# rounding leaves open is near: so a face that is touched as a flight begins, at its very end too, is near from then on.

ROUNDING = 2.0**-40
"""Share of its terms by which a height in doubles is off at most: six roundings of a wall's numbers and a cell's, and
those of eight operations, come to less than 2**-48 of them."""

TINIEST = 1e-280
"""More than what underflow may take from the terms of a height."""

Heights: TypeAlias = tuple[float, ...]
"""The part that each column, or each row, has in the heights over a wall."""

Spans: TypeAlias = tuple[Heights, Heights, Heights, Heights, float]
"""Of the columns, from and to what; of the rows, the same; beyond what height, on either side, a cell is not near."""


class WallCells:
    """The walls near each cell of a run, found when a circle first comes there.

    Args:
        walls: of the scene.
        columns, rows: the ends of the cells along each axis, from one margin below the first on; both ends of cell k
            are at k, the outermost infinite.
        radius: of the largest circle in cells.

    Attributes:
        near: for each cell, the walls near it, as bits of a number; None where nobody has looked.
        every: all walls, as such bits.
    """

    def __init__(
        self,
        walls: Sequence[Wall],
        columns: Sequence[tuple[float, float]],
        rows: Sequence[tuple[float, float]],
        radius: float,
    ) -> None:
        self.every = (1 << len(walls)) - 1
        self.near: list[int | None] = [None] * ((len(columns) + 2) * (len(rows) + 2))
        self._by_column, self._by_row = [0] * len(columns), [0] * len(rows)
        self._others: list[tuple[int, Spans]] = []
        self._face_columns, self._face_rows = [0] * len(columns), [0] * len(rows)
        self._slanted: dict[int, tuple[Spans, Spans]] = {}
        self._always = 0
        farthest = max((abs(end) for ends in (*columns, *rows) for end in ends if abs(end) < inf), default=0.0)
        for k, wall in enumerate(walls):
            if wall.is_face:
                self._admit_face(1 << k, _reach_of(wall, radius, farthest), columns, rows)
            else:
                self._admit(1 << k, _spans(wall, columns, rows, radius, farthest))
        self._indices: dict[int, tuple[int, ...]] = {}

    def _admit(self, bit: int, spans: Spans | None) -> None:
        """Takes up a wall: for each column, or each row, where it runs along them, that is all it takes."""
        if spans is None:
            self._always |= bit
            return
        left, right, low, high, off = spans
        if len({*low, *high}) == 1:
            near = [not (a + low[0] > off or b + low[0] < -off) for a, b in zip(left, right, strict=True)]
            self._by_column = [bits | bit * found for bits, found in zip(self._by_column, near, strict=True)]
        elif len({*left, *right}) == 1:
            near = [not (left[0] + a > off or left[0] + b < -off) for a, b in zip(low, high, strict=True)]
            self._by_row = [bits | bit * found for bits, found in zip(self._by_row, near, strict=True)]
        else:
            self._others.append((bit, spans))

    def _admit_face(
        self,
        bit: int,
        reach: FaceReach | None,
        columns: Sequence[tuple[float, float]],
        rows: Sequence[tuple[float, float]],
    ) -> None:
        """Takes up a face: the columns and rows that its rectangle's box meets; and its axes, where it is slanted."""
        if reach is None:
            self._always |= bit
            return
        x0, y0, nx, ny, length, radius, off = reach
        xs = (x0, x0 + ny * length, x0 + nx * radius, x0 + ny * length + nx * radius)
        ys = (y0, y0 - nx * length, y0 + ny * radius, y0 - nx * length + ny * radius)
        for bits, ends, places in ((self._face_columns, columns, xs), (self._face_rows, rows, ys)):
            low, high = min(places) - off, max(places) + off
            for k, (start, end) in enumerate(ends):
                if start <= high and end >= low:
                    bits[k] |= bit
        if nx and ny:
            sides = (nx, ny, nx * x0 + ny * y0, radius), (ny, -nx, ny * x0 - nx * y0, length)
            self._slanted[bit] = tuple(_between(side, columns, rows, off) for side in sides)  # pyright: ignore[reportArgumentType]

    def _faces(self, column: int, row: int) -> int:
        """The faces near a cell."""
        near = left = self._face_columns[column] & self._face_rows[row]
        while left:
            bit = left & -left
            left ^= bit
            for low_x, high_x, low_y, high_y, most in self._slanted.get(bit, ()):
                if low_x[column] + low_y[row] > most or high_x[column] + high_y[row] < 0.0:
                    near ^= bit
                    break
        return near

    def look(self, cell: int, column: int, row: int) -> int:
        """Finds the walls near a cell, and keeps them.

        >>> box = [Wall(0, 0, 0, 1), Wall(9, 0, 9, 1)]
        >>> columns = [(-inf, 3.0), (3.0, 6.0), (6.0, inf)]
        >>> found = WallCells(box, columns, columns, 1.0)
        >>> found.look(7, 1, 1), found.look(6, 0, 1), found.look(8, 2, 1)
        (0, 1, 2)
        """
        near = self._always | self._by_column[column] | self._by_row[row]
        for bit, (left, right, low, high, off) in self._others:
            if not (left[column] + low[row] > off or right[column] + high[row] < -off):
                near |= bit
        self.near[cell] = near = near | self._faces(column, row)
        return near

    def indices(self, bits: int) -> tuple[int, ...]:
        """The walls of such bits, in scene order."""
        found = self._indices.get(bits)
        if found is None:
            found = self._indices[bits] = tuple(k for k in range(bits.bit_length()) if bits >> k & 1)
        return found


def _spans(
    wall: Wall,
    columns: Sequence[tuple[float, float]],
    rows: Sequence[tuple[float, float]],
    radius: float,
    farthest: float,
) -> Spans | None:
    """What the cells' ends come to in heights over a wall; None where doubles do not hold it."""
    nx, ny = wall.normal
    try:
        fx, fy, x0, y0 = float(nx), float(ny), float(wall.x0), float(wall.y0)
    except OverflowError:
        return None
    length = hypot(fx, fy)
    if not TINIEST < length < 1.0 / TINIEST:
        return None
    fx, fy = fx / length, fy / length
    if (fx == 0.0 and nx.sign()) or (fy == 0.0 and ny.sign()):  # a cell without end reaches a wall at any angle
        return None
    across, along = [_span(fx, ends) for ends in columns], [_span(fy, ends) for ends in rows]
    height = fx * x0 + fy * y0
    size = abs(x0) + abs(y0) + radius + 2.0 * farthest
    left, right = zip(*across, strict=True)
    low, high = zip(*((least - height, most - height) for least, most in along), strict=True)
    return left, right, low, high, radius + ROUNDING * size + TINIEST


FaceReach: TypeAlias = tuple[float, float, float, float, float, float, float]
"""Where a face begins, its normal of length 1, how long it is, how far from it centres are; what all this is off by."""


def _reach_of(face: Wall, radius: float, farthest: float) -> FaceReach | None:
    """Of a face, in doubles, among cells that reach so far; None where doubles do not hold it."""
    nx, ny = face.normal
    try:
        fx, fy, x0, y0 = float(nx), float(ny), float(face.x0), float(face.y0)
    except OverflowError:
        return None
    length = hypot(fx, fy)
    if not TINIEST < length < 1.0 / TINIEST or (fx == 0.0 and nx.sign()) or (fy == 0.0 and ny.sign()):
        return None
    size = abs(x0) + abs(y0) + length + radius + 2.0 * farthest
    return x0, y0, fx / length, fy / length, length, radius, ROUNDING * size + TINIEST


def _between(
    side: tuple[float, float, float, float],
    columns: Sequence[tuple[float, float]],
    rows: Sequence[tuple[float, float]],
    off: float,
) -> Spans:
    """From what to what columns, and rows, are along an axis, so that a cell is apart from what lies between 0 and a
    width there only where the sum of its two starts is above the last number, or that of its two ends below 0."""
    nx, ny, start, width = side
    low_x, high_x = zip(*(_span(nx, ends) for ends in columns), strict=True)
    low_y, high_y = zip(*((a - start - off, b - start + off) for a, b in (_span(ny, e) for e in rows)), strict=True)
    return low_x, high_x, low_y, high_y, width


def _span(n: float, ends: tuple[float, float]) -> tuple[float, float]:
    """The least and the greatest of n times what lies between two ends."""
    if n > 0.0:
        return n * ends[0], n * ends[1]
    return (n * ends[1], n * ends[0]) if n < 0.0 else (0.0, 0.0)
