"""Cells that are compiled against those of Python: the same answers to whatever is asked of both, in any order."""

from __future__ import annotations

from math import inf, nan
from random import Random

import pytest

from truebreak.compare import engine
from truebreak.exact.compiled import CellLists, cells
from truebreak.exact.simulation import cells as in_python
from truebreak.exact.simulation.cells import Cells, FloatFlight, Grid, cells_of, frame_of
from truebreak.exact.simulation.near_walls import WallCells
from truebreak.scenarios import Trajectory, Wall
from truebreak.scenarios.catalogue import build

pytestmark = pytest.mark.skipif(cells is None, reason="nothing is compiled here")

COUNT = 40
STEPS = 400


def grids(draw: Random) -> Grid:
    """Few cells, so that circles are often neighbours; some far from the origin, where places are soon not sharp."""
    x, y = draw.choice([(0.0, 0.0), (-17.0, 4.5), (1e9, -1e9), (3e13, 0.0)])
    return Grid(x, y, draw.choice([1.0, 2.75, 0.3, 1e-9, 1e6]), draw.randint(1, 7), draw.randint(1, 6))


def walls_of(draw: Random, grid: Grid) -> list[Wall]:
    """More of them than a machine word has bits, now and then; some along an axis."""
    span = int(grid.width * 8) + 3
    near = lambda corner: int(corner) + draw.randint(-span, span)  # noqa: E731
    found = []
    for _ in range(draw.choice([0, 3, 5, 70])):
        x, y = near(grid.x), near(grid.y)
        dx, dy = draw.choice([(1, 0), (0, 1), (3, 4), (-1, 2)])
        found.append(Wall(x, y, x + dx, y + dy))
    return found


def flight(draw: Random, grid: Grid, now: float, speed: float) -> FloatFlight:
    def place(corner: float, count: int) -> float:
        kind = draw.random()
        if kind < 0.1:
            return corner + draw.randint(-1, count + 1) * grid.width
        if kind < 0.13:
            return draw.choice([1e99, -1e99, 1e120, nan])
        return corner + draw.uniform(-0.5, count + 0.5) * grid.width

    def velocity() -> float:
        kind = draw.random()
        if kind < 0.15:
            return draw.choice([0.0, -0.0])
        return speed * (draw.choice([-1.0, 1.0, 0.5]) if kind < 0.4 else draw.uniform(-1.0, 1.0))

    return place(grid.x, grid.columns), place(grid.y, grid.rows), velocity(), velocity(), now


def asked(one: CellLists, what: str, *of: object) -> object:
    """An answer, or what kind of error there is."""
    try:
        return getattr(one, what)(*of)
    except (ValueError, IndexError, OverflowError) as wrong:
        return type(wrong)


@pytest.mark.parametrize("seed", range(120))
def test_both_give_the_same_answers(seed: int) -> None:
    """In hostile order too: of circles that are not entered, crossings late and early, times that go back."""
    draw = Random(seed)
    grid = grids(draw)
    walls = walls_of(draw, grid)
    large = frozenset(i for i in range(COUNT) if draw.random() < draw.choice([0.0, 0.1]))
    near = [WallCells(walls, *grid.ends(), 0.3 * grid.width) for _ in range(2)]
    assert cells is not None
    pair: list[CellLists] = [
        Cells(grid, COUNT, large, near[0]),
        cells.Cells(*frame_of(grid), COUNT, large, near[1]),
    ]
    now, speed = 0.0, grid.width * draw.choice([1.0, 1.0, 1.0, 1e-195, 1e-230])
    for _ in range(STEPS):
        kind = draw.random()
        i = draw.randrange(COUNT)
        asking: tuple[str, *tuple[object, ...]]
        if kind < 0.35:
            if draw.random() < 0.02:
                speed = grid.width * draw.choice([3.0, 30.0, 1e40, 1e-3, 1e-230])
            asking = ("enter", i, flight(draw, grid, now, speed))
        elif kind < 0.38:
            asking = ("enter_loose", i)
        elif kind < 0.41:
            asking = ("remove", i)
        elif kind < 0.6:
            asking = ("around", i)
        elif kind < 0.7:
            asking = ("walls", i)
        else:
            now = (
                min(pair[0].next_crossing, 1e90) if draw.random() < 0.8 else now + draw.expovariate(speed) * grid.width
            )
            asking = ("cross",) if draw.random() < 0.5 else ("cross", now + draw.uniform(-3.0, 3.0) * pair[0].early)
        one, other = (asked(each, *asking) for each in pair)
        assert one == other, asking
        assert type(one) is type(other)
        assert pair[0].next_crossing == pair[1].next_crossing
        assert pair[0].early == pair[1].early
        assert pair[0].loose == pair[1].loose
    assert near[0].near == near[1].near


def test_circles_do_cross_in_that() -> None:
    """Each flies on from cell to cell, and both say so."""
    draw = Random(1)
    grid = Grid(0.0, 0.0, 1.0, 30, 30)
    pair = [
        Cells(grid, 500, frozenset(), WallCells([], *grid.ends(), 0.3)),
        cells_of(grid, 500, frozenset(), WallCells([], *grid.ends(), 0.3)),
    ]
    for i in range(500):
        told = draw.uniform(0, 30), draw.uniform(0, 30), draw.uniform(-1, 1), draw.uniform(-1, 1), 0.0
        assert [each.enter(i, told) for each in pair] == [True, True]
    count = 0
    for i in range(500):
        assert pair[0].around(i) == pair[1].around(i)
    while pair[0].next_crossing < inf:
        one, other = (each.cross() for each in pair)
        assert one == other
        count += len(one)
    assert pair[1].next_crossing == inf
    assert count > 5_000


def told(run: Trajectory) -> list[object]:
    return [(float(e.time), e.contacts, e.impulses, e.ties) for e in run.events]


@pytest.mark.parametrize("name", ["exact", "double"])
@pytest.mark.parametrize("scene", ["gas:n=100,seed=8", "gas:n=80,seed=2,mixed=yes"])
def test_histories_are_the_same(scene: str, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    compiled = engine(name).run(build(scene), events=400)
    monkeypatch.setattr(in_python, "compiled", None)
    plain = engine(name).run(build(scene), events=400)
    assert told(compiled) == told(plain)
    assert len(compiled.events) == 400
    assert compiled.plan == plain.plan
    assert compiled.plan["cells crossed"] > 0


def test_the_numbers_that_are_written_twice_are_the_same() -> None:
    assert cells is not None
    assert cells.constants() == {name: getattr(in_python, name) for name in ("FARTHEST", "SLOWEST", "ROOM")}


@pytest.mark.parametrize(
    ("method", "arguments"),
    [
        ("enter", (COUNT, (0.0,) * 5)), ("enter", (-1, (0.0,) * 5)), ("enter", (0, (0.0,) * 4)),
        ("enter", (0, (0.0,) * 6)), ("enter", (0, [0.0] * 5)), ("enter", (0,)), ("enter", (0, ("",) * 5)),
        ("around", (COUNT,)), ("walls", ("",)), ("remove", (2**70,)), ("enter_loose", (None,)), ("cross", ("",)),
        ("cross", (0.0, 0.0)), ("cross", ()),
    ],
)  # fmt: skip
def test_what_is_not_asked_rightly_is_refused(method: str, arguments: tuple[object, ...]) -> None:
    grid = Grid(0.0, 0.0, 1.0, 4, 4)
    with pytest.raises((IndexError, TypeError, ValueError, OverflowError)):
        getattr(cells_of(grid, COUNT, frozenset(), WallCells([], *grid.ends(), 0.3)), method)(*arguments)


def test_cells_that_do_not_fit_together_are_refused() -> None:
    assert cells is not None
    grid, wider = Grid(0.0, 0.0, 1.0, 4, 4), Grid(0.0, 0.0, 1.0, 5, 4)
    near = WallCells([], *wider.ends(), 0.3)
    for frame, large in (
        (frame_of(grid), frozenset()),
        (frame_of(wider)._replace(grid=grid), frozenset()),
        (frame_of(wider), frozenset({COUNT})),
        (frame_of(wider)._replace(grid=wider._replace(columns=0)), frozenset()),
        (frame_of(wider)._replace(ends=tuple([0.0] * len(ends) for ends in frame_of(wider).ends)), frozenset()),
    ):
        with pytest.raises((ValueError, IndexError)):
            cells.Cells(*frame, COUNT, large, near)
    with pytest.raises(AttributeError):
        cells.Cells(*frame_of(grid), COUNT, frozenset(), None)
