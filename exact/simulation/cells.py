"""Square cells over the circles of a run: which circles and walls may meet at all before one leaves its cell."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from heapq import heappop, heappush
from math import inf, isfinite, ulp
from typing import Generic, NamedTuple, Protocol, TypeAlias

from ...scenarios.things import Wall
from ..compiled import CellLists
from ..compiled import cells as compiled
from ..numbers.system import N
from ..replay.contact import Body, Link
from .near_walls import WallCells

# -- What makes arrivals as flights go on.


class Crossings(Protocol):
    """What may make new arrivals of flights that stay as they are, from certain times on."""

    @property
    def next_crossing(self) -> float:
        """The next such time; infinite if there is none."""
        ...

    @property
    def early(self) -> float:
        """How much before that time they may be made."""
        ...

    @property
    def slides(self) -> Sequence[Link]:
        """What was seen to slide along the face of a segment, as predictions were made; until it is taken up."""
        ...

    def cross(self, since: float = inf, /) -> None:
        """Queues what is due at that time.

        Args:
            since: where that is more than `early` before, the earliest time at which anything else may happen next.
        """
        ...


class NoCrossings:
    """Every arrival is queued as its flights begin."""

    next_crossing = early = inf
    slides: Sequence[Link] = ()

    def cross(self, since: float = inf, /) -> None:
        """Nothing."""


# -- Square cells over the circles of a run: where they lie, how wide they are, and between what ends.

UNIT = 2.0**-53

MARGIN = 1 / 8
"""The margin m, as a share of a cell's width: the wider, the longer a slice of time, and the wider cells have to be."""

MOST_CELLS = 1024
"""Cells along one side, at most."""

FEWEST = 64
"""Circles from which on there are cells: in the gas, time with them over that without is 0.95 at 32 discs, 0.8 at 64
and 0.7 at 96 in the exact engine, 1.05, 0.7 and 0.55 in doubles."""

SHARE = 0.35
"""Circles to a cell, where their reach allows it. With more of them more are looked at for each flight, with fewer they
come to new cells more often: in the gas of 1,000, 21 pairs and 1.7 crossings an event with one, 8 and 3.1 with this."""

LARGE = 4.0
"""Circles more than this many times as large as the usual one are held against all others."""

FloatFlight: TypeAlias = tuple[float, float, float, float, float]
"""(x, y, vx, vy, t) in doubles: it passes (x, y) at time t, each but for a rounding."""


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


class CellFrame(NamedTuple):
    """What a run's cells are measured by.

    Attributes:
        grid: the cells.
        ends: where a circle leaves each of the columns, to the left and to the right, and of the rows, down and up.
        last: about the last x, and y, that falls in one of them; all before it, from the grid's corner on, do so too.
        margin: by which a centre may be beyond its cell.
        sharp: where |x| + |y| + (|vx| + |vy|) T is below it, a place at time T is told to a quarter of the margin.
    """

    grid: Grid
    ends: tuple[list[float], list[float], list[float], list[float]]
    last: tuple[float, float]
    margin: float
    sharp: float


def frame_of(grid: Grid) -> CellFrame:
    """What some cells are measured by; `sharp` is derived where cells.py has their bound."""
    x, y, width, columns, rows = grid
    return CellFrame(
        grid,
        (*leaves(x, width, columns), *leaves(y, width, rows)),
        (last_within(x, width, columns), last_within(y, width, rows)),
        MARGIN * width,
        MARGIN / 8 * width / (64.0 * UNIT) - abs(x) - abs(y),
    )


def usual_radius(radii: Sequence[float], ends: int = 0) -> float:
    """The middle one of some radii, of which the last are of ends of segments: these may be points."""
    return sorted(radii[: len(radii) - ends])[(len(radii) - ends) // 2]


def grid_for(flights: Sequence[FloatFlight | None], radii: Sequence[float], ends: int = 0) -> Grid | None:
    """Cells for circles, about three to a circle; None where they would spare nothing."""
    known = [flight for flight in flights if flight is not None]
    if len(known) < FEWEST:
        return None
    usual = usual_radius(radii, ends)
    reach = 2.0 * max(r for r in radii if r <= LARGE * usual)
    left, right = min(flight[0] for flight in known), max(flight[0] for flight in known)
    low, high = min(flight[1] for flight in known), max(flight[1] for flight in known)
    wide, tall = right - left, high - low
    width = max(reach / (1.0 - 2.0 * MARGIN), (SHARE * wide * tall / len(known)) ** 0.5, (wide + tall) / MOST_CELLS)
    if not (0.0 < width < inf and isfinite(left + right + low + high)):
        return None
    columns, rows = int(wide / width) + 1, int(tall / width) + 1
    return Grid(left, low, width, columns, rows) if columns * rows > 9 else None


def last_within(start: float, width: float, count: int) -> float:
    """A double, about the last, that falls in one of so many cells; all before it, from the start on, do so too.

    >>> last_within(-16.0, 4.0, 4) < 0.0
    True
    """
    last = start + count * width
    step = ulp(max(abs(start), abs(last)))  # one of `last` itself might be lost in the difference
    while int((last - start) / width) >= count:
        last, step = last - step, 2.0 * step
    return last


def leaves(origin: float, width: float, count: int) -> tuple[list[float], list[float]]:
    """Where a circle leaves each of the cells along an axis, downwards and upwards: half a margin beyond its border."""
    low = [origin + (k - MARGIN / 2) * width for k in range(count)]
    high = [origin + (k + 1 + MARGIN / 2) * width for k in range(count)]
    low[0], high[-1] = -inf, inf
    return low, high


# -- Cells under the queue: which circles, and which walls, may meet at all before a circle comes to another cell.
#
# The plane is cut into square cells; those at the border reach out without end. A circle is entered in the cell of
# its centre, and is there, but for a margin m, until about the time at which it is m/2 beyond it. Time is cut into
# slices in which nothing flies farther than m/2 along an axis: who leaves its cell in a slice is entered in the next
# one as the slice begins, or up to the length of a slice before. That takes no queue in order of time. Cells are as
# wide as the largest reach of two circles and two margins, so two whose cells are not neighbours do not touch.
#
# Bound. A centre is within m of the cell in which it is entered:
#
# - it is carried in doubles from the flight's (x, y) at t: with u = 2**-53 it is off by less than
#   64 u (|x| + |y| + (|vx| + |vy|) T) at any time up to T (see `filtered`, whose bound of a place this is); a circle of
#   which that is not below m/4, at the time at which it leaves its cell, is compared with all others;
# - a slice begins where three roundings put it, which is off by less than 4 u T, so less than m/64 of the way;
# - who leaves is entered in the next cell by the time at which it is m/2 beyond, and at most two slices before, when it
#   is m/2 short of it: with both roundings, less than m either way.
#
# Each pair is handed out once on its two flights, though their cells may part and come together again: of two
# flights, the one that began later knows the other.
#
# Source: M. P. Allen and D. J. Tildesley, *Computer Simulation of Liquids* (2nd ed., 2017), 5.3.2 (cell lists);
# crossings as events: D. C. Rapaport, J. Comput. Phys. 34 (1980) 184.

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


# -- Predictions among many circles: of each with those in the cells around it, as it comes to new cells.


class Predictions(Protocol[N]):
    """Makes the predictions of one run.

    Attributes:
        slides: what predictions have seen to slide along a face, until it is taken up.
    """

    @property
    def slides(self) -> Sequence[Link]: ...

    def in_doubles(self, a: Body[N], /) -> FloatFlight | None:
        """A circle's flight in doubles; None where they do not tell it to a rounding."""
        ...

    def walls(self, a: Body[N], walls: Sequence[int], standing: Collection[Link], /) -> None:
        """Queues the next hits of a circle with some walls."""
        ...

    def pairs(self, a: Body[N], others: list[Body[N]], standing: Collection[Link], /) -> None:
        """Queues the next meetings of a circle with others."""
        ...


class Crowd(Generic[N]):
    """The circles of a run in cells; it makes the queue's crossings.

    Args:
        cells: the cells.
        bodies, pockets: the circles and the pockets.
        plan: counts what is predicted and what is skipped.
        predictions: makes them.
    """

    def __init__(
        self,
        cells: CellLists,
        bodies: Mapping[int, Body[N]],
        pockets: Sequence[Body[N]],
        plan: Counter[str],
        predictions: Predictions[N],
    ) -> None:
        self._cells = cells
        self._bodies = bodies
        self._pockets = list(pockets)
        self._plan = plan
        self._predictions = predictions

    def predict(self, moved: Sequence[Body[N]], standing: Collection[Link], gone: Collection[int]) -> None:
        """Queues the next meetings of circles whose flights are new (see `Predictor.predict`)."""
        cells, bodies, plan, predictions = self._cells, self._bodies, self._plan, self._predictions
        for i in gone:
            cells.remove(i)
        for a in moved:
            a.until = inf
            flight = predictions.in_doubles(a)
            if flight is None:
                cells.enter_loose(a.index)
            elif not cells.enter(a.index, flight):
                continue
            walls = cells.walls(a.index)
            if walls and not a.flight.rest:
                plan["walls predicted"] += len(walls)
                predictions.walls(a, walls, standing)
        done: set[int] = set()
        predicted = 0
        for a in moved:
            near = cells.around(a.index)
            met = [bodies[k] for k in near if k not in done] if done else [bodies[k] for k in near]
            done.add(a.index)
            if a.flight.rest:
                count = len(met)
                met = [b for b in met if not b.flight.rest]
                plan["pairs at rest skipped"] += count - len(met)
            elif self._pockets:
                predicted -= len(self._pockets)
                met += self._pockets
            predicted += len(met)
            predictions.pairs(a, met, standing)
        plan["pairs predicted"] += predicted

    @property
    def next_crossing(self) -> float:
        """See `Crossings`."""
        return self._cells.next_crossing

    @property
    def early(self) -> float:
        """See `Crossings`."""
        return self._cells.early

    @property
    def slides(self) -> Sequence[Link]:
        """See `Crossings`."""
        return self._predictions.slides

    def cross(self, since: float = inf) -> None:
        """See `Crossings`. Two that touch have been neighbours, so nothing stands at gap zero here."""
        bodies, plan, predictions = self._bodies, self._plan, self._predictions
        crossed = self._cells.cross(since)
        plan["cells crossed"] += len(crossed)
        for i, near, walls in crossed:
            if walls:
                plan["walls predicted"] += len(walls)
                predictions.walls(bodies[i], walls, ())
            if near:
                plan["pairs predicted"] += len(near)
                predictions.pairs(bodies[i], [bodies[k] for k in near], ())


def cells_for(
    flights: Sequence[FloatFlight | None], radii: Sequence[float], walls: Sequence[Wall], ends: int = 0
) -> CellLists | None:
    """Cells for the circles of a run, empty; None where they would spare nothing.

    Args:
        flights: of the circles; None where doubles do not tell one.
        radii: theirs.
        walls: those of the scene, and the faces of its segments.
        ends: how many of the circles, the last, are ends of segments.
    """
    grid = grid_for(flights, radii, ends)
    if grid is None:
        return None
    usual = usual_radius(radii, ends)
    large = frozenset(i for i, r in enumerate(radii) if r > LARGE * usual)
    radius = max(r for i, r in enumerate(radii) if i not in large)
    return cells_of(grid, len(radii), large, WallCells(walls, *grid.ends(), radius))
