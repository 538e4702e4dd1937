"""Cells under the queue: which circles may meet at all before one of them comes to another cell.

The plane is cut into square cells; those at the border reach out without end. A circle is entered in the cell of its
centre, and is there, but for a margin m, until the double `leaves` at which it is entered in the next one. Cells are
as wide as the largest reach of two circles and four margins, so two whose cells are not neighbours do not touch.

Bound. A centre is carried in doubles from the flight's (x, y) at t: with u = 2**-53 it is off by less than
64 u (|x| + |y| + (|vx| + |vy|) T) at any time up to T (see `double_filter`, whose bound of a place this is); a circle
of which that is not below a fourth of m, at the time at which it leaves its cell, is held against all others. One that
leaves is taken out when it is half a margin beyond the border, so truly between a fourth and three fourths.

Source: M. P. Allen and D. J. Tildesley, *Computer Simulation of Liquids* (2nd ed., 2017), 5.3.2 (cell lists); crossings
as events: D. C. Rapaport, J. Comput. Phys. 34 (1980) 184.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from heapq import heappop, heappush
from math import inf, isfinite
from typing import NamedTuple, TypeAlias

UNIT = 2.0**-53

MARGIN = 1 / 16
"""The margin m, as a share of a cell's width."""

MOST_CELLS = 1024
"""Cells along one side, at most."""

FEWEST = 64
"""Circles from which on cells are worth it: in the gas, time with them over that without is 1.1 at 48 discs and 0.9 at
96 in the exact engine, 0.95 and 0.65 in doubles."""

LARGE = 4.0
"""Circles more than this many times as large as the usual one are held against all others."""

Cell: TypeAlias = tuple[int, int]


class Spot(NamedTuple):
    """A flight in doubles: (x, y) at time t, each but for a rounding, and the velocity."""

    x: float
    y: float
    vx: float
    vy: float
    t: float


class Grid(NamedTuple):
    """Square cells.

    Attributes:
        x, y: the corner of cell (0, 0).
        width: of a cell.
        columns, rows: how many there are.
    """

    x: float
    y: float
    width: float
    columns: int
    rows: int

    def cell(self, x: float, y: float) -> Cell:
        """The cell that a point lies in."""
        return (
            min(max(int((x - self.x) / self.width), 0), self.columns - 1),
            min(max(int((y - self.y) / self.width), 0), self.rows - 1),
        )


def grid_for(spots: Sequence[Spot | None], radii: Sequence[float]) -> Grid | None:
    """Cells for circles, about one circle to a cell; None where they would spare nothing."""
    known = [spot for spot in spots if spot is not None]
    if len(known) < FEWEST:
        return None
    usual = sorted(radii)[len(radii) // 2]
    reach = 2.0 * max(r for r in radii if r <= LARGE * usual)
    left, right = min(spot.x for spot in known), max(spot.x for spot in known)
    low, high = min(spot.y for spot in known), max(spot.y for spot in known)
    area = (right - left) * (high - low)
    width = max(reach / (1.0 - 4.0 * MARGIN), (area / len(known)) ** 0.5, (right - left + high - low) / MOST_CELLS)
    if not (0.0 < width < inf and isfinite(left + right + low + high)):
        return None
    columns, rows = int((right - left) / width) + 1, int((high - low) / width) + 1
    return Grid(left, low, width, columns, rows) if columns * rows > 9 else None


class Cells:
    """The circles of a run in cells.

    Args:
        grid: the cells.
        large: circles that are held against all others, whatever they do.

    Attributes:
        loose: all circles that are, for now.
    """

    def __init__(self, grid: Grid, large: frozenset[int]) -> None:
        self.grid = grid
        self.large = large
        self.loose: set[int] = set()
        self._cell: dict[int, Cell] = {}
        self._held: dict[Cell, set[int]] = {}
        self._crossings: list[tuple[float, int, int]] = []
        self._newest: dict[int, int] = {}
        self._spots: dict[int, Spot] = {}
        self._count = 0

    def enter(self, i: int, spot: Spot | None) -> None:
        """Takes up a circle's new flight."""
        self.remove(i)
        if spot is None or i in self.large:
            self.loose.add(i)
            return
        self._spots[i] = spot
        self._put(i, self.grid.cell(spot.x, spot.y))
        self._foresee(i)

    def remove(self, i: int) -> None:
        """Drops a circle."""
        self._newest.pop(i, None)
        self.loose.discard(i)
        self._take_out(i)

    def around(self, i: int) -> Iterator[int]:
        """The circles that one may meet before another crossing, itself aside; for a loose one all."""
        if i in self.loose:
            yield from (k for k in self._cell if k != i)
        else:
            column, row = self._cell[i]
            held = self._held
            for cell in [(c, r) for c in (column - 1, column, column + 1) for r in (row - 1, row, row + 1)]:
                for k in held.get(cell, ()):
                    if k != i:
                        yield k
        yield from (k for k in self.loose if k != i)

    @property
    def next_crossing(self) -> float:
        """When the next circle leaves its cell; infinite if none does."""
        crossings = self._crossings
        while crossings and self._newest.get(crossings[0][2]) != crossings[0][1]:
            heappop(crossings)
        return crossings[0][0] if crossings else inf

    def crossed(self, since: float, until: float) -> Iterator[tuple[int, list[int]]]:
        """Carries out the crossings up to a time: each circle, with those whose neighbour it has become.

        What happens next may come as early as `since`: a circle that then is far from its new cell is loose.
        """
        crossings = self._crossings
        while self.next_crossing <= until:
            _, _, i = heappop(crossings)
            column, row = self._cell[i]
            across, up = self._way(i)
            self._take_out(i)
            self._put(i, (column + across, row + up))
            self._foresee(i)
            spot = self._spots[i]
            if not (until - since) * (abs(spot.vx) + abs(spot.vy)) < MARGIN / 2 * self.grid.width:
                self._loosen(i)
            if i in self.loose:
                yield i, [k for k in (*self._cell, *self.loose) if k != i]
                continue
            ahead = (
                [(column + 2 * across, row + r) for r in (-1, 0, 1)]
                if across
                else [(column + c, row + 2 * up) for c in (-1, 0, 1)]
            )
            yield i, [k for cell in ahead for k in self._held.get(cell, ())]

    # -- one circle

    def _put(self, i: int, cell: Cell) -> None:
        self._cell[i] = cell
        self._held.setdefault(cell, set()).add(i)

    def _take_out(self, i: int) -> None:
        cell = self._cell.pop(i, None)
        if cell is not None:
            self._held[cell].discard(i)

    def _loosen(self, i: int) -> None:
        self._newest.pop(i, None)
        self._take_out(i)
        self.loose.add(i)

    def _waits(self, i: int) -> tuple[float, float]:
        """The times until a circle is half a margin beyond its cell, along x and along y."""
        x, y, vx, vy, _ = self._spots[i]
        grid, (column, row) = self.grid, self._cell[i]
        half = MARGIN / 2
        across = up = inf
        if vx > 0.0 and column + 1 < grid.columns:
            across = (grid.x + (column + 1 + half) * grid.width - x) / vx
        elif vx < 0.0 and column > 0:
            across = (grid.x + (column - half) * grid.width - x) / vx
        if vy > 0.0 and row + 1 < grid.rows:
            up = (grid.y + (row + 1 + half) * grid.width - y) / vy
        elif vy < 0.0 and row > 0:
            up = (grid.y + (row - half) * grid.width - y) / vy
        return across, up

    def _way(self, i: int) -> tuple[int, int]:
        """In which direction a circle leaves its cell."""
        across, up = self._waits(i)
        spot = self._spots[i]
        if across <= up:
            return (1 if spot.vx > 0.0 else -1), 0
        return 0, (1 if spot.vy > 0.0 else -1)

    def _foresee(self, i: int) -> None:
        """Queues the time at which a circle leaves its cell; one whose place is not sharp enough is loose."""
        x, y, vx, vy, t = self._spots[i]
        wait = min(self._waits(i))
        last = t if wait == inf else t + max(wait, 0.0)
        off = 64.0 * UNIT * (abs(x) + abs(y) + (abs(vx) + abs(vy)) * last + abs(self.grid.x) + abs(self.grid.y))
        if not off < MARGIN / 8 * self.grid.width:
            self._loosen(i)
            return
        if wait < inf:
            self._count += 1
            self._newest[i] = self._count
            heappush(self._crossings, (t + wait, self._count, i))
