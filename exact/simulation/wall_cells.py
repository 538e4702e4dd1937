"""Which walls are near a cell: those that a circle entered there may touch before it comes to another one.

A circle's centre is within a margin of its cell (see `Cells`), so it touches a wall only where the wall's line comes
as near to the cell, with the margin all round, as the radius. Heights over a line are held against that in doubles;
what their rounding leaves open is near.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, inf
from typing import TypeAlias

from ...scenarios.things import Wall

ROUNDING = 2.0**-40
"""Share of its terms by which a height in doubles is off at most: six roundings of a wall's numbers and a cell's, and
those of eight operations, come to less than 2**-48 of them."""

TINIEST = 1e-280
"""More than what underflow may take from the terms of a height."""

Line: TypeAlias = tuple[float, float, float, float]
"""(nx, ny, x0, y0) of a wall in doubles: a normal of length 1, but for roundings, and a point."""


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
        self._lines = [_line(wall) for wall in walls]
        self._columns = columns
        self._rows = rows
        self._radius = radius
        self._indices: dict[int, tuple[int, ...]] = {}

    def look(self, cell: int, column: int, row: int) -> int:
        """Finds the walls near a cell, and keeps them.

        >>> box = [Wall(0, 0, 0, 1), Wall(9, 0, 9, 1)]
        >>> columns = [(-inf, 3.0), (3.0, 6.0), (6.0, inf)]
        >>> WallCells(box, columns, columns, 1.0).look(7, 1, 1), WallCells(box, columns, columns, 1.0).look(6, 0, 1)
        (0, 1)
        """
        ends = self._columns[column], self._rows[row]
        near = sum(1 << k for k, line in enumerate(self._lines) if line is None or _is_near(line, *ends, self._radius))
        self.near[cell] = near
        return near

    def indices(self, bits: int) -> tuple[int, ...]:
        """The walls of such bits, in scene order."""
        found = self._indices.get(bits)
        if found is None:
            found = self._indices[bits] = tuple(k for k in range(len(self._lines)) if bits >> k & 1)
        return found


def _line(wall: Wall) -> Line | None:
    """A wall in doubles; None where they do not hold it."""
    nx, ny = wall.normal
    try:
        fx, fy, x0, y0 = float(nx), float(ny), float(wall.x0), float(wall.y0)
    except OverflowError:
        return None
    length = hypot(fx, fy)
    if not TINIEST < length < 1.0 / TINIEST:
        return None
    return fx / length, fy / length, x0, y0


def _is_near(line: Line, column: tuple[float, float], row: tuple[float, float], radius: float) -> bool:
    """Whether a line may come within a radius of a cell with these ends."""
    nx, ny, x0, y0 = line
    least, most = _span(nx, column), _span(ny, row)
    low, high = least[0] + most[0], least[1] + most[1]
    height = nx * x0 + ny * y0
    size = abs(x0) + abs(y0) + radius + sum(abs(end) for end in (*column, *row) if abs(end) < inf)
    off = radius + ROUNDING * size + TINIEST
    return not (low - height > off or high - height < -off)


def _span(n: float, ends: tuple[float, float]) -> tuple[float, float]:
    """The least and the greatest of n times what lies between two ends."""
    if n > 0.0:
        return n * ends[0], n * ends[1]
    return (n * ends[1], n * ends[0]) if n < 0.0 else (0.0, 0.0)
