"""Cells under the queue: which circles, and which walls, may meet at all before a circle comes to another cell.

The plane is cut into square cells; those at the border reach out without end. A circle is entered in the cell of its
centre, and is there, but for a margin m, until about the time at which it is m/2 beyond it. Time is cut into slices in
which nothing flies farther than m/2 along an axis: who leaves its cell in a slice is entered in the next one as the
slice begins, or up to the length of a slice before. That takes no queue in order of time. Cells are as wide as the
largest reach of two circles and two margins, so two whose cells are not neighbours do not touch.

Bound. A centre is within m of the cell in which it is entered:

- it is carried in doubles from the flight's (x, y) at t: with u = 2**-53 it is off by less than
  64 u (|x| + |y| + (|vx| + |vy|) T) at any time up to T (see `double_filter`, whose bound of a place this is); a circle
  of which that is not below m/4, at the time at which it leaves its cell, is held against all others;
- a slice begins where three roundings put it, which is off by less than 4 u T, so less than m/64 of the way;
- who leaves is entered in the next cell by the time at which it is m/2 beyond, and at most two slices before, when it
  is m/2 short of it: with both roundings, less than m either way.

Each pair is handed out once on its two flights, though their cells may part and come together again: of two flights,
the one that began later knows the other.

Source: M. P. Allen and D. J. Tildesley, *Computer Simulation of Liquids* (2nd ed., 2017), 5.3.2 (cell lists); crossings
as events: D. C. Rapaport, J. Comput. Phys. 34 (1980) 184.
"""

from __future__ import annotations

from heapq import heappop, heappush
from math import inf
from typing import TypeAlias

from ...compiled import CellLists
from ...compiled import cells as compiled
from .grid import FloatFlight, Grid, frame_of
from .wall_cells import WallCells

FARTHEST = 1e100
"""Beyond this, differences of places might not be doubles any more."""

SLOWEST = 1e-200
"""Margins in a unit of time: at less, slices would be as long as no double is."""

ROOM = 2.0
"""How much faster than the fastest circle so far one may get before time is cut into shorter slices."""

Crossing: TypeAlias = tuple[float, int, int, int]
"""When a circle leaves its cell; when its flight began, as a serial number; the circle; to which cell."""

NOWHERE = -1
"""The cell of a circle that is in none."""


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
        next_crossing: when the next slice of time with crossings begins; infinite if there is none.
        early: how much before a slice begins its crossings may be carried out.
    """

    def __init__(self, grid: Grid, count: int, large: frozenset[int], walls: WallCells) -> None:
        self.grid = grid
        self.large = large
        self.loose: set[int] = set()
        self.next_crossing = self.early = inf
        self._walls = walls
        self._near = walls.near
        self._row = row = grid.columns + 2
        self._ahead = {step: _ahead(step, row) for step in (-1, 1, -row, row)}
        (x, y, width, columns, rows), ends, last, self._margin, self._sharp = frame_of(grid)
        self._left, self._right, self._low, self._high = ends
        self._inside = x, y, *last, width
        self._farthest = abs(x) + abs(y) + (columns + rows) * width
        self._fastest = self._rate = 0.0
        self._calm = -inf
        self._slices: dict[int, list[Crossing]] = {}
        self._numbers: list[int] = []
        self._cell = [NOWHERE] * count
        self._held: list[list[int]] = [[] for _ in range(row * (grid.rows + 2))]
        self._flights: list[FloatFlight] = [(0.0, 0.0, 0.0, 0.0, 0.0)] * count
        self._count = 0
        self._begun = [0] * count
        self._known: list[tuple[int, ...]] = [()] * count
        self._known_walls = [0] * count

    # -- a new flight

    def enter(self, i: int, flight: FloatFlight) -> bool:
        """Takes up a circle's new flight; tells whether there may be walls near it."""
        self._count = self._begun[i] = self._count + 1
        self._known_walls[i] = 0
        x, y, vx, vy, _ = flight
        left, low, right, high, width = self._inside
        fastest = self._fastest
        if (
            left <= x <= right
            and low <= y <= high
            and -fastest <= vx <= fastest
            and -fastest <= vy <= fastest
            and i not in self.large
        ):
            column, row = int((x - left) / width), int((y - low) / width)
        elif i not in self.large and self._admit(flight):
            column = int(min(max((x - left) / width, 0.0), self.grid.columns - 1))
            row = int(min(max((y - low) / width, 0.0), self.grid.rows - 1))
        else:
            self._loosen(i)
            return True
        if self.loose:
            self.loose.discard(i)
        new, old = (row + 1) * self._row + column + 1, self._cell[i]
        if new != old:
            if old != NOWHERE:
                self._held[old].remove(i)
            self._held[new].append(i)
            self._cell[i] = new
        self._flights[i] = flight
        self._foresee(i, flight, column, row)
        return self._near[new] != 0 or bool(self.loose)

    def enter_loose(self, i: int) -> None:
        """Takes up a circle's new flight that doubles do not tell to a rounding; there may be walls near."""
        self._count = self._begun[i] = self._count + 1
        self._known_walls[i] = 0
        self._loosen(i)

    def remove(self, i: int) -> None:
        """Drops a circle."""
        self.loose.discard(i)
        cell = self._cell[i]
        if cell != NOWHERE:
            self._held[cell].remove(i)
            self._cell[i] = NOWHERE

    def around(self, i: int) -> list[int]:
        """The circles that one whose flight is new may meet before another crossing, itself aside, ascending.

        For a loose one that is all.
        """
        cell = self._cell[i]
        if cell == NOWHERE:
            found = self._all()
        else:
            held, row = self._held, self._row
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

    def cross(self, since: float = inf) -> list[tuple[int, list[int], tuple[int, ...]]]:
        """Carries out the crossings of the next slice of time.

        Args:
            since: what happens next may come as early as this; a circle that then is far from its new cell is loose.

        Returns:
            For each that crosses: which it is, the circles whose neighbour it has newly become, ascending, and the
            walls near its cell that its flight does not know yet.
        """
        number = heappop(self._numbers)
        before = number / self._rate - since
        self.next_crossing = self._numbers[0] / self._rate if self._numbers else inf
        held, cells, begun, near, row = self._held, self._cell, self._begun, self._near, self._row
        found: list[tuple[int, list[int], tuple[int, ...]]] = []
        for _, flight, i, step in self._slices.pop(number):
            old = cells[i]
            if begun[i] != flight or old == NOWHERE:
                continue
            cells[i] = cell = old + step
            held[old].remove(i)
            held[cell].append(i)
            self._foresee(i, self._flights[i], cell % row - 1, cell // row - 1)
            if before > self.early and cells[i] != NOWHERE:
                _, _, vx, vy, _ = self._flights[i]
                if not before * max(abs(vx), abs(vy)) < self._margin / 2:
                    self._loosen(i)
            if cells[i] == NOWHERE:
                others, walls = self._all(), self.walls(i)
            else:
                one, two, three = self._ahead[step]
                others = held[cell + one] + held[cell + two] + held[cell + three]
                walls = self.walls(i) if near[cell] != 0 else ()
            found.append((i, self._new(i, others) if others else others, walls))
        return found

    # -- one circle

    def _admit(self, flight: FloatFlight) -> bool:
        """Whether a flight can be held in cells; takes account of one farther out or faster than those before."""
        x, y, vx, vy, _ = flight
        far, fast = abs(x) + abs(y), abs(vx) + abs(vy)
        if not (far < FARTHEST and fast < FARTHEST / 8 * self._margin):
            return False
        if fast > self._fastest:
            if not fast > SLOWEST * self._margin:
                return False
            self._slice_anew(ROOM * max(abs(vx), abs(vy)))
        self._farthest = max(self._farthest, far)
        if self._fastest > 0.0:
            self._calm = min((self._sharp - self._farthest) / (2.0 * self._fastest), FARTHEST)
        return True

    def _slice_anew(self, fastest: float) -> None:
        """Cuts time into slices short enough for a speed along an axis: half a margin takes no less."""
        begun = self._begun
        waiting = [crossing for due in self._slices.values() for crossing in due if begun[crossing[2]] == crossing[1]]
        self._fastest, self._rate, self.next_crossing = fastest, 2.0 * fastest / self._margin, inf
        self.early = 1.0 / self._rate
        self._slices.clear()
        self._numbers.clear()
        for crossing in waiting:
            self._await(crossing)

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

    def _foresee(self, i: int, flight: FloatFlight, column: int, row: int) -> None:
        """Queues the time at which a circle is half a margin beyond its cell; a place not sharp enough is loose."""
        x, y, vx, vy, t = flight
        if vx > 0.0:
            wait, step = (self._right[column] - x) / vx, 1
        elif vx < 0.0:
            wait, step = (self._left[column] - x) / vx, -1
        else:
            wait, step = inf, 0
        if vy > 0.0:
            up = (self._high[row] - y) / vy
            if up < wait:
                wait, step = up, self._row
        elif vy < 0.0:
            up = (self._low[row] - y) / vy
            if up < wait:
                wait, step = up, -self._row
        time = t + wait
        if not t <= time < self._calm:
            last = t if wait == inf or wait < 0.0 else time
            if not (abs(x) + abs(y) + (abs(vx) + abs(vy)) * last < self._sharp and last < FARTHEST):
                self._loosen(i)
                return
            if wait == inf:
                return
        number = int(time * self._rate)
        waiting = self._slices.get(number)
        if waiting is None:
            self._begin(number)
            waiting = self._slices[number]
        waiting.append((time, self._begun[i], i, step))

    def _await(self, crossing: Crossing) -> None:
        """Puts a crossing into the slice of time that it falls in."""
        number = int(crossing[0] * self._rate)
        if number not in self._slices:
            self._begin(number)
        self._slices[number].append(crossing)

    def _begin(self, number: int) -> None:
        """A slice of time gets its first crossing."""
        self._slices[number] = []
        heappush(self._numbers, number)
        self.next_crossing = self._numbers[0] / self._rate


def cells_of(grid: Grid, count: int, large: frozenset[int], walls: WallCells) -> CellLists:
    """`Cells`, compiled where that can be."""
    if compiled is None:
        return Cells(grid, count, large, walls)
    return compiled.Cells(*frame_of(grid), count, large, walls)


def _ahead(step: int, row: int) -> tuple[int, int, int]:
    """The three cells that come to be around one, as seen from it, for who takes a step."""
    aside = row if abs(step) == 1 else 1
    return step - aside, step, step + aside
