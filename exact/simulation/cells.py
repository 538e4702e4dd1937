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

Flight: TypeAlias = tuple[float, float, float, float, float]
"""(x, y, vx, vy, t) in doubles (see `Spot`)."""


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

    A cell is a number, row by row, with an empty column to the left and to the right: what it has around it is found by
    adding the same few numbers everywhere.

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
        self._row = row = grid.columns + 2
        self._around = tuple(across + up * row for across in (-1, 0, 1) for up in (-1, 0, 1))
        self._ahead = {step: _ahead(step, row) for step in (-1, 1, -row, row)}
        self._columns = _ends(grid.x, grid.width, grid.columns)
        self._rows = _ends(grid.y, grid.width, grid.rows)
        self._sharp = MARGIN / 8 * grid.width / (64.0 * UNIT) - abs(grid.x) - abs(grid.y)
        self._cell: dict[int, int] = {}
        self._held: dict[int, set[int]] = {}
        self._crossings: list[tuple[float, int, int]] = []
        self._newest: dict[int, int] = {}
        self._spots: dict[int, Flight] = {}
        self._steps: dict[int, int] = {}
        self._count = 0

    def enter(self, i: int, spot: Flight | None) -> None:
        """Takes up a circle's new flight."""
        if spot is None or i in self.large:
            self._loosen(i)
            return
        self.loose.discard(i)
        self._spots[i] = spot
        left, low, width, columns, rows = self.grid
        column, row = int((spot[0] - left) / width), int((spot[1] - low) / width)
        if not 0 <= column < columns:
            column = 0 if column < 0 else columns - 1
        if not 0 <= row < rows:
            row = 0 if row < 0 else rows - 1
        self._put(i, column + 1 + row * self._row)
        self._foresee(i, column, row)

    def remove(self, i: int) -> None:
        """Drops a circle."""
        self._newest.pop(i, None)
        self.loose.discard(i)
        cell = self._cell.pop(i, None)
        if cell is not None:
            self._held[cell].discard(i)

    def around(self, i: int) -> list[int]:
        """The circles that one may meet before another crossing, itself aside; for a loose one all."""
        found: list[int] = []
        if i in self.loose:
            found += self._cell
        else:
            cell, held = self._cell[i], self._held
            for step in self._around:
                group = held.get(cell + step)
                if group:
                    found += group
        if self.loose:
            found += self.loose
        found.remove(i)
        return found

    @property
    def next_crossing(self) -> float:
        """When the next circle leaves its cell; infinite if none does."""
        crossings, newest = self._crossings, self._newest
        while crossings:
            first = crossings[0]
            if newest.get(first[2]) == first[1]:
                return first[0]
            heappop(crossings)
        return inf

    def cross(self) -> tuple[int, list[int]]:
        """Carries out the next crossing: the circle, and those whose neighbour it has become."""
        _, _, i = heappop(self._crossings)
        step = self._steps[i]
        cell = self._cell[i] + step
        self._put(i, cell)
        row, column = divmod(cell, self._row)
        self._foresee(i, column - 1, row)
        if i in self.loose:
            return i, [k for k in (*self._cell, *self.loose) if k != i]
        found: list[int] = []
        held = self._held
        for ahead in self._ahead[step]:
            group = held.get(cell + ahead)
            if group:
                found += group
        return i, found

    def crossed(self, since: float, until: float) -> Iterator[tuple[int, list[int]]]:
        """Carries out the crossings up to a time: each circle, with those whose neighbour it has become.

        What happens next may come as early as `since`: a circle that then is far from its new cell is loose.
        """
        while self.next_crossing <= until:
            i, found = self.cross()
            _, _, vx, vy, _ = self._spots[i]
            if i not in self.loose and not (until - since) * (abs(vx) + abs(vy)) < MARGIN / 2 * self.grid.width:
                self._loosen(i)
                found = [k for k in (*self._cell, *self.loose) if k != i]
            yield i, found

    # -- one circle

    def _put(self, i: int, cell: int) -> None:
        """Moves a circle to a cell."""
        old = self._cell.get(i)
        if old == cell:
            return
        held = self._held
        if old is not None:
            held[old].discard(i)
        self._cell[i] = cell
        group = held.get(cell)
        if group is None:
            held[cell] = {i}
        else:
            group.add(i)

    def _loosen(self, i: int) -> None:
        """Holds a circle against all others."""
        self.remove(i)
        self.loose.add(i)

    def _foresee(self, i: int, column: int, row: int) -> None:
        """Queues the time at which a circle is half a margin beyond its cell; a place not sharp enough is loose."""
        x, y, vx, vy, t = self._spots[i]
        wait, step = inf, 0
        if vx > 0.0:
            wait, step = (self._columns[1][column] - x) / vx, 1
        elif vx < 0.0:
            wait, step = (self._columns[0][column] - x) / vx, -1
        if vy > 0.0:
            up = (self._rows[1][row] - y) / vy
            if up < wait:
                wait, step = up, self._row
        elif vy < 0.0:
            up = (self._rows[0][row] - y) / vy
            if up < wait:
                wait, step = up, -self._row
        last = t if wait == inf or wait < 0.0 else t + wait
        if not abs(x) + abs(y) + (abs(vx) + abs(vy)) * last < self._sharp:
            self._loosen(i)
        elif wait < inf:
            self._count += 1
            self._newest[i] = self._count
            self._steps[i] = step
            heappush(self._crossings, (t + wait, self._count, i))
        else:
            self._newest.pop(i, None)


def _ahead(step: int, row: int) -> tuple[int, int, int]:
    """The three cells that come to be around one, as seen from it, for who takes a step."""
    aside = row if abs(step) == 1 else 1
    return step - aside, step, step + aside


def _ends(start: float, width: float, count: int) -> tuple[list[float], list[float]]:
    """Where a circle leaves each of the cells along an axis, downwards and upwards: half a margin beyond its border."""
    low = [start + (k - MARGIN / 2) * width for k in range(count)]
    high = [start + (k + 1 + MARGIN / 2) * width for k in range(count)]
    low[0], high[-1] = -inf, inf
    return low, high
