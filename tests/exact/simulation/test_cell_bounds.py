"""The bounds that cells rest on: each against what it claims, in exact fractions of the doubles that the code makes."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from math import inf, isfinite

import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st
from sympy import Rational, symbols

from truebreak.exact.simulation.cells import (
    MARGIN,
    UNIT,
    Cells,
    Grid,
    cells_for,
    grid_for,
    last_within,
    leaves,
)
from truebreak.exact.simulation.near_walls import ROUNDING, WallCells
from truebreak.scenarios import Wall

COLUMNS = 5


def test_circles_whose_cells_are_no_neighbours_do_not_touch() -> None:
    """Centres, each within a margin of its cell, are apart by a reach at least, where a cell is as wide as they are
    made: by the formulas, and in the doubles of a run."""
    x, width, reach = symbols("x width reach", positive=True)
    columns, _ = Grid(x, x, width, COLUMNS, COLUMNS).ends()
    gap = columns[3][0] - columns[1][1]
    assert gap.subs(width, reach / (1 - 2 * Rational(MARGIN))).equals(reach)
    assert columns[0][0] == -inf
    assert columns[-1][1] == inf
    assert [one[1] - two[0] for one, two in pairwise(columns)] == [2 * MARGIN * width] * 4
    flights = [(3.0 * i, 2.5 * j, 1.0, 0.0, 0.0) for i in range(12) for j in range(9)]
    grid = grid_for(flights, [1.3] * len(flights))
    assert grid is not None
    assert grid.width * (1 - 2 * MARGIN) >= 2.6 * (1 - 4 * UNIT)


@pytest.mark.parametrize("times", [1.0, 3.0, 4.0, 4.0 + 2.0**-50, 5.0])
def test_whoever_is_in_cells_fits_them_whatever_its_size(times: float) -> None:
    """Up to four times the usual radius; larger ones are held against all."""
    flights = [(9.0 * i, 9.0 * j, 1.0, 0.0, 0.0) for i in range(12) for j in range(9)]
    radii = [1.0] * (len(flights) - 1) + [times]
    grid, cells = grid_for(flights, radii), cells_for(flights, radii, [])
    assert grid is not None
    assert cells is not None
    for i, flight in enumerate(flights):
        cells.enter(i, flight)
    held = [r for i, r in enumerate(radii) if i not in cells.loose]
    assert len(held) == len(radii) - (times > 4.0)
    assert grid.width * (1 - 2 * MARGIN) >= 2.0 * max(held) * (1 - 4 * UNIT)


def test_a_circle_leaves_half_a_margin_beyond_its_cell() -> None:
    x, width = symbols("x width", positive=True)
    low, high = leaves(x, width, COLUMNS)
    columns, _ = Grid(x, x, width, COLUMNS, COLUMNS).ends()
    for k in range(COLUMNS):
        assert k == 0 or ((low[k] - columns[k][0]) - MARGIN / 2 * width).equals(0)
        assert k == COLUMNS - 1 or ((columns[k][1] - high[k]) - MARGIN / 2 * width).equals(0)
    assert (low[0], high[-1]) == (-inf, inf)


@given(st.floats(-1e6, 1e6), st.floats(1e-3, 1e6), st.integers(1, 1024))
@example(-16.0, 4.0, 4)
@example(-0.3, 0.1, 3)
def test_all_up_to_the_last_fall_in_a_cell(start: float, width: float, count: int) -> None:
    """The quotient grows with the place, so the last speaks for all before it."""
    assume(start + width > start)
    last = last_within(start, width, count)
    assert last >= start
    assert int((last - start) / width) < count
    assert last - start > (count - 1e-6) * width


def test_in_a_slice_nothing_flies_farther_than_half_a_margin() -> None:
    fastest, margin = symbols("fastest margin", positive=True)
    cells = Cells.__new__(Cells)
    cells._begun, cells._slices, cells._numbers, cells._margin = [], {}, [], margin
    cells._slice_anew(fastest)
    assert (cells.early * fastest).equals(margin / 2)
    assert (cells._rate * cells.early).equals(1)


def test_a_place_is_as_sharp_as_is_claimed() -> None:
    """What is not loose: 64 u (|x| + |y| + (|vx| + |vy|) T), the grid's own corner put in, is below m/4."""
    grid = Grid(-40.0, 3.0, 4.0, 20, 20)
    cells = Cells(grid, 1, frozenset(), WallCells([], *grid.ends(), 1.0))
    sharp = Fraction(cells._sharp) + 43
    assert 64 * Fraction(UNIT) * sharp <= Fraction(MARGIN) * 4 / 4
    assert cells._margin == MARGIN * 4


speed = st.floats(-4.0, 4.0).filter(lambda v: v == 0.0 or abs(v) > 1e-3)
place = st.floats(0.0, 60.0)


@given(place, place, speed, speed, st.floats(0.0, 100.0))
def test_a_centre_is_within_a_margin_of_its_cell(x: float, y: float, vx: float, vy: float, t: float) -> None:
    """From as early as a crossing may be carried out to as late as the next one is, in exact numbers: outer cells
    reach out without end."""
    others = [(9.0 * i, 9.0 * j, 0.0, 0.0, 0.0) for i in range(8) for j in range(9)]
    grid = grid_for([(x, y, vx, vy, t), *others], [1.0] * 73)
    assert grid is not None
    columns, rows = grid.ends()
    cells = Cells(grid, 73, frozenset(), WallCells([], columns, rows, 1.0))
    cells.enter(0, (x, y, vx, vy, t))
    since = Fraction(t)
    for _ in range(30):
        assert 0 not in cells.loose
        row, column = divmod(cells._cell[0], cells._row)
        until = cells.next_crossing
        end = since + 10**6 if until == inf else Fraction(until)
        for when in (since, end):
            for told, v, ends in ((x, vx, columns[column - 1]), (y, vy, rows[row - 1])):
                there = Fraction(told) + Fraction(v) * (when - Fraction(t))
                low, high = ends
                assert not isfinite(low) or Fraction(low) <= there
                assert not isfinite(high) or there <= Fraction(high)
        if until == inf:
            return
        since = max(Fraction(t), Fraction(until) - Fraction(cells.early))
        ((i, _, _),) = cells.cross()
        assert i == 0


whole = st.integers(-30, 90)


@given(whole, whole, whole, whole, st.integers(0, 6), st.fractions(0, 5, max_denominator=64))
@example(4, 3, 1, 0, 0, Fraction(1))
@example(4, 3, 0, -1, 0, Fraction(1))
def test_a_wall_that_a_circle_in_a_cell_may_touch_is_near_it(
    x0: int, y0: int, dx: int, dy: int, halves: int, radius: Fraction
) -> None:
    """The heights of a cell's corners over the line, in exact numbers: whichever has a point within the radius is near,
    and none that is farther by more than the roundings' share is."""
    if not (dx or dy):
        return
    wall = Wall(x0, y0, x0 + dx, y0 + dy)
    grid = Grid(-7.5 + halves / 2, 2.25, 8.0, 9, 7)
    columns, rows = grid.ends()
    near = WallCells([wall], columns, rows, float(radius))
    square = (radius * radius) * (dx * dx + dy * dy)
    for column in range(1, 8):
        for row in range(1, 6):
            corners = [dx * (Fraction(y) - y0) - dy * (Fraction(x) - x0) for x in columns[column] for y in rows[row]]
            apart = min(abs(h) for h in corners) if min(corners) > 0 or max(corners) < 0 else Fraction(0)
            told = near.look((row + 1) * 11 + column + 1, column, row)
            if apart * apart <= square:
                assert told == 1
            elif apart * apart > (radius + Fraction(1, 10**6)) ** 2 * (dx * dx + dy * dy):
                assert told == 0


@pytest.mark.parametrize(("column", "row"), [(0, 3), (8, 3), (4, 0), (4, 6), (0, 0), (8, 6)])
def test_an_outer_cell_reaches_out_without_end(column: int, row: int) -> None:
    """A wall beyond the grid is near the outer cells that it meets out there, and no wall is lost far away."""
    grid = Grid(0.0, 0.0, 8.0, 9, 7)
    columns, rows = grid.ends()
    far = {0: -(10**6), 8: 10**6}.get(column, 8 * column + 4), {0: -(10**6), 6: 10**6}.get(row, 8 * row + 4)
    for normal in ((1, 0), (0, 1), (3, 4)):
        wall = Wall(*far, far[0] - normal[1], far[1] + normal[0])
        assert WallCells([wall], columns, rows, 1.0).look(0, column, row) == 1


def test_the_share_of_rounding_covers_the_roundings() -> None:
    """Six of a wall's numbers and a cell's, and those of eight operations."""
    u = Fraction(UNIT)
    assert (1 + u) ** 14 - 1 < Fraction(1, 2**48) < Fraction(ROUNDING) / 2
