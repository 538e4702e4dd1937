"""Square cells over the circles of a run: where they lie, how wide they are, and between what ends."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, isfinite, ulp
from typing import NamedTuple, TypeAlias

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


class Frame(NamedTuple):
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


def frame_of(grid: Grid) -> Frame:
    """What some cells are measured by; `sharp` is derived where cells.py has their bound."""
    x, y, width, columns, rows = grid
    return Frame(
        grid,
        (*leaves(x, width, columns), *leaves(y, width, rows)),
        (last_within(x, width, columns), last_within(y, width, rows)),
        MARGIN * width,
        MARGIN / 8 * width / (64.0 * UNIT) - abs(x) - abs(y),
    )


def grid_for(flights: Sequence[FloatFlight | None], radii: Sequence[float]) -> Grid | None:
    """Cells for circles, about three to a circle; None where they would spare nothing."""
    known = [flight for flight in flights if flight is not None]
    if len(known) < FEWEST:
        return None
    usual = sorted(radii)[len(radii) // 2]
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
