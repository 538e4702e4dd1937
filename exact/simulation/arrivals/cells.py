"""Cells under the queue: which circles, and which walls, may meet at all before a circle comes to another cell.

The plane is cut into square cells; those at the border reach out without end. A circle is entered in the cell of its
centre, and is there, but for a margin m, until the double `leaves` at which it is entered in the next one. Cells are
as wide as the largest reach of two circles and four margins, so two whose cells are not neighbours do not touch.

Bound. A centre is carried in doubles from the flight's (x, y) at t: with u = 2**-53 it is off by less than
64 u (|x| + |y| + (|vx| + |vy|) T) at any time up to T (see `double_filter`, whose bound of a place this is); a circle
of which that is not below a fourth of m, at the time at which it leaves its cell, is held against all others. One that
leaves is taken out when it is half a margin beyond the border, so truly between a fourth and three fourths.

Each pair is handed out once on its two flights, though their cells may part and come together again: of two flights,
the one that began later knows the other.

Source: M. P. Allen and D. J. Tildesley, *Computer Simulation of Liquids* (2nd ed., 2017), 5.3.2 (cell lists); crossings
as events: D. C. Rapaport, J. Comput. Phys. 34 (1980) 184.
"""

from __future__ import annotations

from collections.abc import Sequence
from heapq import heappop, heappush
from math import inf, isfinite
from typing import NamedTuple, TypeAlias

from .wall_cells import WallCells

UNIT = 2.0**-53

MARGIN = 1 / 16
"""The margin m, as a share of a cell's width."""

MOST_CELLS = 1024
"""Cells along one side, at most."""

FEWEST = 64
"""Circles from which on there are cells: in the gas, time with them over that without is 0.95 at 32 discs, 0.8 at 64
and 0.7 at 96 in the exact engine, 1.05, 0.7 and 0.55 in doubles."""

SHARE = 0.5
"""Circles to a cell, where their reach allows it. With one to a cell twice as many are looked at for each flight, with
fewer they come to new cells more often: in the gas of 1,000, 25 pairs and 1.8 crossings an event against 13 and 2.6."""

LARGE = 4.0
"""Circles more than this many times as large as the usual one are held against all others."""

Flight: TypeAlias = tuple[float, float, float, float, float]
"""(x, y, vx, vy, t) in doubles: it passes (x, y) at time t, each but for a rounding."""

NOWHERE = -1
"""The cell of a circle that is in none."""


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

    def ends(self) -> tuple[list[tuple[float, float]], list[tuple[float, float]]]:
        """Between what the centres in each column, and in each row, lie: its ends, and a margin beyond them."""
        return self._ends(self.x, self.columns), self._ends(self.y, self.rows)

    def _ends(self, origin: float, count: int) -> list[tuple[float, float]]:
        width, margin = self.width, MARGIN * self.width
        ends = [(origin + k * width - margin, origin + (k + 1) * width + margin) for k in range(count)]
        ends[0] = -inf, ends[0][1]
        ends[-1] = ends[-1][0], inf
        return ends


def grid_for(flights: Sequence[Flight | None], radii: Sequence[float]) -> Grid | None:
    """Cells for circles, about two to a circle; None where they would spare nothing."""
    known = [flight for flight in flights if flight is not None]
    if len(known) < FEWEST:
        return None
    usual = sorted(radii)[len(radii) // 2]
    reach = 2.0 * max(r for r in radii if r <= LARGE * usual)
    left, right = min(flight[0] for flight in known), max(flight[0] for flight in known)
    low, high = min(flight[1] for flight in known), max(flight[1] for flight in known)
    area = (right - left) * (high - low)
    width = max(
        reach / (1.0 - 4.0 * MARGIN), (SHARE * area / len(known)) ** 0.5, (right - left + high - low) / MOST_CELLS
    )
    if not (0.0 < width < inf and isfinite(left + right + low + high)):
        return None
    columns, rows = int((right - left) / width) + 1, int((high - low) / width) + 1
    return Grid(left, low, width, columns, rows) if columns * rows > 9 else None


class Cells:
    """The circles of a run in cells.

    A cell is a number, row by row, with an empty column to the left and to the right, and an empty row below and
    above: what it has around it is found by adding the same few numbers everywhere.

    Args:
        grid: the cells.
        count: how many circles there are.
        large: circles that are held against all others and all walls, whatever they do.
        walls: which walls are near a cell.

    Attributes:
        loose: all circles that are, for now.
    """

    def __init__(self, grid: Grid, count: int, large: frozenset[int], walls: WallCells) -> None:
        self.grid = grid
        self.large = large
        self.loose: set[int] = set()
        self._walls = walls
        self._near = walls.near
        self._row = row = grid.columns + 2
        self._ahead = {step: _ahead(step, row) for step in (-1, 1, -row, row)}
        self._left, self._right = _ends(grid.x, grid.width, grid.columns)
        self._low, self._high = _ends(grid.y, grid.width, grid.rows)
        self._sharp = MARGIN / 8 * grid.width / (64.0 * UNIT) - abs(grid.x) - abs(grid.y)
        self._cell = [NOWHERE] * count
        self._held: list[list[int]] = [[] for _ in range(row * (grid.rows + 2))]
        self._crossings: list[tuple[float, int, int, int]] = [(inf, 0, count, 0)]
        self._newest = [0] * (count + 1)
        self._flights: list[Flight] = [(0.0, 0.0, 0.0, 0.0, 0.0)] * count
        self._count = 0
        self._begun = [0] * count
        self._known: list[tuple[int, ...]] = [()] * count
        self._known_walls = [0] * count

    # -- a new flight

    def enter(self, i: int, flight: Flight) -> None:
        """Takes up a circle's new flight."""
        self._begin(i)
        if i in self.large:
            self._loosen(i)
            return
        self.loose.discard(i)
        left, low, width, columns, rows = self.grid
        column, row = int((flight[0] - left) / width), int((flight[1] - low) / width)
        if not 0 <= column < columns:
            column = 0 if column < 0 else columns - 1
        if not 0 <= row < rows:
            row = 0 if row < 0 else rows - 1
        new, old = (row + 1) * self._row + column + 1, self._cell[i]
        if new != old:
            if old != NOWHERE:
                self._held[old].remove(i)
            self._held[new].append(i)
            self._cell[i] = new
        self._flights[i] = flight
        self._foresee(i, flight, column, row)

    def enter_loose(self, i: int) -> None:
        """Takes up a circle's new flight that doubles do not tell to a rounding."""
        self._begin(i)
        self._loosen(i)

    def remove(self, i: int) -> None:
        """Drops a circle."""
        self._newest[i] = 0
        self.loose.discard(i)
        cell = self._cell[i]
        if cell != NOWHERE:
            self._held[cell].remove(i)
            self._cell[i] = NOWHERE

    def around(self, i: int) -> list[int]:
        """The circles that one whose flight is new may meet before another crossing, itself aside, ascending.

        For a loose one that is all.
        """
        if i in self.loose:
            found = self._all()
        else:
            held, row, cell = self._held, self._row, self._cell[i]
            low, high = cell - row, cell + row
            found = [
                *held[low - 1], *held[low], *held[low + 1],
                *held[cell - 1], *held[cell], *held[cell + 1],
                *held[high - 1], *held[high], *held[high + 1],
            ]  # fmt: skip
            if self.loose:
                found += self.loose
        found.remove(i)
        found.sort()
        self._known[i] = tuple(found)
        return found

    def walls(self, i: int) -> tuple[int, ...]:
        """The walls that a circle may touch before another crossing, and that its flight does not know yet."""
        cell = self._cell[i]
        near = self._near[cell] if cell != NOWHERE else self._walls.every
        if near == 0:
            return ()
        if near is None:
            row, column = divmod(cell, self._row)
            near = self._walls.look(cell, column - 1, row - 1)
        new = near & ~self._known_walls[i]
        self._known_walls[i] |= new
        return self._walls.indices(new)

    # -- crossings

    @property
    def next_crossing(self) -> float:
        """When the next circle leaves its cell; infinite if none does."""
        crossings, newest = self._crossings, self._newest
        while True:
            time, count, i, _ = crossings[0]
            if newest[i] == count:
                return time
            heappop(crossings)

    def cross(self) -> tuple[int, list[int]]:
        """Carries out the next crossing: the circle, and those whose neighbour it has newly become, ascending."""
        _, _, i, step = heappop(self._crossings)
        held, old = self._held, self._cell[i]
        self._cell[i] = cell = old + step
        held[old].remove(i)
        held[cell].append(i)
        row, column = divmod(cell, self._row)
        self._foresee(i, self._flights[i], column - 1, row - 1)
        if i in self.loose:
            return i, self._new(i, self._all())
        one, two, three = self._ahead[step]
        near = held[cell + one] + held[cell + two] + held[cell + three]
        return i, self._new(i, near) if near else near

    def cross_early(self, since: float, until: float) -> tuple[int, list[int]]:
        """As `cross`, of a crossing at `until`, where what happens next may come as early as `since`.

        A circle that then is far from its new cell is loose.
        """
        i, found = self.cross()
        _, _, vx, vy, _ = self._flights[i]
        if i not in self.loose and not (until - since) * (abs(vx) + abs(vy)) < MARGIN / 2 * self.grid.width:
            self._loosen(i)
            found = sorted([*found, *self._new(i, self._all())])
        return i, found

    # -- one circle

    def _begin(self, i: int) -> None:
        """A flight begins: it knows no wall; whom it knows, `around` tells."""
        self._count = self._begun[i] = self._count + 1
        self._known_walls[i] = 0

    def _new(self, i: int, others: list[int]) -> list[int]:
        """Those of some circles that have not been handed out with one on their flights, ascending; now they are."""
        known, begun = self._known, self._begun
        mine, own = known[i], begun[i]
        new: list[int] = []
        newer = 0
        for k in others:
            if own > begun[k]:
                if k not in mine:
                    new.append(k)
            elif i not in known[k] and k != i:
                known[k] += (i,)
                new.append(k)
                newer += 1
        if newer < len(new):
            known[i] += tuple(new)
        new.sort()
        return new

    def _all(self) -> list[int]:
        return [*(i for i, cell in enumerate(self._cell) if cell != NOWHERE), *self.loose]

    def _loosen(self, i: int) -> None:
        """Holds a circle against all others."""
        self.remove(i)
        self.loose.add(i)

    def _foresee(self, i: int, flight: Flight, column: int, row: int) -> None:
        """Queues the time at which a circle is half a margin beyond its cell; a place not sharp enough is loose."""
        x, y, vx, vy, t = flight
        wait, step, speed = inf, 0, 0.0
        if vx > 0.0:
            wait, step, speed = (self._right[column] - x) / vx, 1, vx
        elif vx < 0.0:
            wait, step, speed = (self._left[column] - x) / vx, -1, -vx
        if vy > 0.0:
            up = (self._high[row] - y) / vy
            speed += vy
            if up < wait:
                wait, step = up, self._row
        elif vy < 0.0:
            up = (self._low[row] - y) / vy
            speed -= vy
            if up < wait:
                wait, step = up, -self._row
        last = t if wait == inf or wait < 0.0 else t + wait
        if not abs(x) + abs(y) + speed * last < self._sharp:
            self._loosen(i)
        elif step:
            self._count = self._newest[i] = self._count + 1
            heappush(self._crossings, (t + wait, self._count, i, step))
        else:
            self._newest[i] = 0


def _ahead(step: int, row: int) -> tuple[int, int, int]:
    """The three cells that come to be around one, as seen from it, for who takes a step."""
    aside = row if abs(step) == 1 else 1
    return step - aside, step, step + aside


def _ends(origin: float, width: float, count: int) -> tuple[list[float], list[float]]:
    """Where a circle leaves each of the cells along an axis, downwards and upwards: half a margin beyond its border."""
    low = [origin + (k - MARGIN / 2) * width for k in range(count)]
    high = [origin + (k + 1 + MARGIN / 2) * width for k in range(count)]
    low[0], high[-1] = -inf, inf
    return low, high
