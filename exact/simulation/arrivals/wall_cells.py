"""Which walls are near a cell: those that a circle entered there may touch before it comes to another one.

A circle's centre is within a margin of its cell (see `Cells`), so it touches a wall only where the wall's line comes
as near to the cell, with the margin all round, as the radius. Heights over a line are held against that in doubles;
what their rounding leaves open is near.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, inf
from typing import TypeAlias

from ....scenarios.things import Wall

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
        self._count = len(walls)
        self._by_column, self._by_row = [0] * len(columns), [0] * len(rows)
        self._others: list[tuple[int, Spans]] = []
        self._always = 0
        for k, wall in enumerate(walls):
            self._admit(1 << k, _spans(wall, columns, rows, radius))
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
        self.near[cell] = near
        return near

    def indices(self, bits: int) -> tuple[int, ...]:
        """The walls of such bits, in scene order."""
        found = self._indices.get(bits)
        if found is None:
            found = self._indices[bits] = tuple(k for k in range(self._count) if bits >> k & 1)
        return found


def _spans(
    wall: Wall, columns: Sequence[tuple[float, float]], rows: Sequence[tuple[float, float]], radius: float
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
    farthest = max((abs(end) for ends in (*columns, *rows) for end in ends if abs(end) < inf), default=0.0)
    size = abs(x0) + abs(y0) + radius + 2.0 * farthest
    left, right = zip(*across, strict=True)
    low, high = zip(*((least - height, most - height) for least, most in along), strict=True)
    return left, right, low, high, radius + ROUNDING * size + TINIEST


def _span(n: float, ends: tuple[float, float]) -> tuple[float, float]:
    """The least and the greatest of n times what lies between two ends."""
    if n > 0.0:
        return n * ends[0], n * ends[1]
    return (n * ends[1], n * ends[0]) if n < 0.0 else (0.0, 0.0)
