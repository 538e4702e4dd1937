"""Cells among segments: histories are the same as without, and a face is near wherever it can be touched."""

from __future__ import annotations

from collections.abc import Callable
from math import hypot, inf
from random import Random

import pytest
from segment_scenes import scene_of

from truebreak.compare import engine
from truebreak.exact import ExactEngine
from truebreak.exact.simulation import cells as grid
from truebreak.exact.simulation.cells import Crowd, WallCells, usual_radius
from truebreak.exact.simulation.loop import Loop
from truebreak.scenarios import Circle, Quantity, Scene, Segment, Trajectory, Wall
from truebreak.scenarios.surfaces import SegmentFace


def crowd(bars: int, thick: str = "0", side: int = 9, seed: int = 1) -> Scene:
    """Discs on a lattice, a little off it, in a box, and segments of all directions between them."""
    draw = Random(seed)
    off = lambda: Quantity.of(draw.randint(-9, 9)) / 20  # noqa: E731
    speed = lambda: f"{draw.randint(-1000, 1000)}/500"  # noqa: E731
    discs = [Circle(4 * i + off(), 4 * j + off(), vx=speed(), vy=speed()) for i in range(side) for j in range(side)]
    top = 4 * side - 1
    walls = [Wall(-3, 0, -3, 1), Wall(top, 0, top, 1), Wall(0, -3, 1, -3), Wall(0, top, 1, top)]
    places = [(4 * i + 2, 4 * j + 2) for i in range(side - 1) for j in range(side - 1)]
    rows: list[Segment] = []
    for x, y in draw.sample(places, bars):
        dx, dy = draw.choice([(35, 0), (0, 35), (draw.randint(-35, 35), draw.randint(1, 35))])
        across, up = Quantity.of(dx) / 100, Quantity.of(dy) / 100
        rows.append(Segment(x - across, y - up, x + across, y + up, r=thick))
    return Scene(discs, walls, segments=rows)


def slide() -> Scene:
    """Discs slide along rows of segments, through many cells, and are struck from above: one over a gap in the row."""
    discs: list[Circle] = []
    row: list[Segment] = []
    for y, wait, gap in ((0, 50, 99), (-100, 44, 20)):
        discs += [Circle(-3, y + 1, vx=1), Circle(-3, y + 3 + wait, vx=1, vy=-1)]
        row += [Segment(2 * k, y, 2 * k + 2, y) for k in range(40) if k != gap]
    return Scene(discs, segments=row)


SCENES: dict[str, Callable[[], tuple[Scene, int]]] = {
    "among segments": lambda: (crowd(40), 250),
    "among thick ones": lambda: (crowd(30, "3/10"), 250),
    "more ends than discs": lambda: (crowd(60, side=9), 100),
    "there and back": lambda: (crowd(20).with_changes(reverse_after=60), 121),
    "a slide": lambda: (slide(), 9),
}


def told(run: Trajectory) -> list[object]:
    """All that a history says, its numbers as doubles; the contacts of one instant in no order."""
    events = [(float(e.time), sorted(e.contacts), sorted(e.impulses)) for e in run.events]
    final = [(float(c.x), float(c.y), float(c.vx), float(c.vy)) for c in run.final.circles]
    return [events, final, float(run.final_time), run.stop.reason, [(p.circle, float(p.time)) for p in run.pocketings]]


def both_ways(scene: Scene, events: int, name: str, monkeypatch: pytest.MonkeyPatch) -> tuple[Trajectory, Trajectory]:
    """A run with cells, and one without."""
    runs: list[Trajectory] = []
    for fewest in (1, 10**9):
        monkeypatch.setattr(grid, "FEWEST", fewest)
        runs.append(engine(name).run(scene, until=120, events=events))
    assert runs[0].plan["cells crossed"] > 0
    assert "cells crossed" not in runs[1].plan
    return runs[0], runs[1]


@pytest.mark.parametrize("name", ["exact", "double"])
@pytest.mark.parametrize("scene", SCENES)
def test_cells_change_nothing(scene: str, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    built, events = SCENES[scene]()
    crossed, whole = both_ways(built, events, name, monkeypatch)
    assert told(crossed) == told(whole)
    assert len(crossed.events) > 1
    if len(built.circles) > 9:
        assert crossed.plan["walls predicted"] < len(built.surfaces.walls) * len(crossed.events) / 4


def test_cells_change_nothing_in_random_scenes(monkeypatch: pytest.MonkeyPatch) -> None:
    with_cells = 0
    for seed in range(150):
        scene = scene_of(seed)
        if scene is not None:
            runs: list[Trajectory] = []
            for fewest in (1, 10**9):
                monkeypatch.setattr(grid, "FEWEST", fewest)
                runs.append(ExactEngine().run(scene, until=20, events=8))
            with_cells += "cells crossed" in runs[0].plan
            assert told(runs[0]) == told(runs[1]), seed
    assert with_cells > 60


def test_what_slides_is_seen_as_it_comes_to_a_cell(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = both_ways(slide(), 9, "exact", monkeypatch)[1]
    pushed = {contact for event in whole.events for contact in event.contacts if contact.second.startswith("s")}
    assert len(pushed) > 1
    monkeypatch.setattr(Loop, "_take_slides", lambda self, slides: slides.clear())
    monkeypatch.setattr(Crowd, "slides", ())
    try:
        lost = told(both_ways(slide(), 9, "exact", monkeypatch)[0])
    except AssertionError as found:
        assert "overlap" in str(found)  # noqa: PT017 (the engine's own look at what it may not see)
        return
    assert lost != told(whole)


# -- Which faces are near a cell, by brute force.

RADIUS = 1.25
COLUMNS = [(-inf, 2.0), *((2.0 * k - 0.25, 2.0 * k + 2.25) for k in range(1, 19)), (37.75, inf)]


def random_faces(draw: Random, count: int) -> list[SegmentFace]:
    """Both faces of segments, thick and thin, of all directions and lengths, and along the axes."""
    faces: list[SegmentFace] = []
    for _ in range(count):
        x, y = draw.randint(0, 400), draw.randint(0, 400)
        dx, dy = draw.choice(
            [(draw.randint(1, 90), 0), (0, draw.randint(1, 90)), (draw.randint(-90, 90), draw.randint(1, 90))]
        )
        ends = (Quantity.of(v) / 10 for v in (x, y, x + dx, y + dy))
        segment = Segment(*ends, id="s", r=Quantity.of(draw.choice([0, 5])) / 10)
        faces += [SegmentFace.of(segment, back) for back in (False, True)]
    return faces


def missing(seed: int) -> int:
    """How many places at which a face can be touched lie in cells to which it is said not to be near."""
    draw = Random(seed)
    faces = random_faces(draw, 25)
    found = WallCells(faces, COLUMNS, COLUMNS, RADIUS)
    size, lost, near = len(COLUMNS), 0, 0
    bits = {(c, r): found.look((r + 1) * (size + 2) + c + 1, c, r) for c in range(size) for r in range(size)}
    for k, face in enumerate(faces):
        x0, y0, x1, y1 = (float(q) for q in (face.x0, face.y0, face.x1, face.y1))
        length = hypot(x1 - x0, y1 - y0)
        nx, ny = (y0 - y1) / length, (x1 - x0) / length
        near += sum(bits[cell] >> k & 1 for cell in bits)
        for _ in range(60):
            t, away = draw.choice([0.0, 1.0, draw.random()]), draw.choice([0.0, RADIUS, draw.uniform(0.0, RADIUS)])
            x, y = x0 + t * (x1 - x0) + away * nx, y0 + t * (y1 - y0) + away * ny
            cells = [
                (c, r)
                for c, (left, right) in enumerate(COLUMNS) if left <= x <= right
                for r, (low, high) in enumerate(COLUMNS) if low <= y <= high
            ]  # fmt: skip
            assert cells
            lost += sum(not bits[cell] >> k & 1 for cell in cells)
    assert near < len(bits) * len(faces) / 12  # and elsewhere it is far
    return lost


def test_a_face_is_near_where_it_can_be_touched() -> None:
    assert sum(map(missing, range(8))) == 0


FAULTS = {
    "half as long": lambda x0, y0, nx, ny, length, r, off: (x0, y0, nx, ny, length / 2, r, off),
    "on the other side": lambda x0, y0, nx, ny, length, r, off: (x0, y0, -nx, -ny, length, r, off),
    "half as far": lambda x0, y0, nx, ny, length, r, off: (x0, y0, nx, ny, length, r / 2, off),
    "closed on the wrong side of nothing": lambda x0, y0, nx, ny, length, r, off: (x0, y0, nx, ny, length, r, -0.01),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_planted_faults_are_found(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    known = grid._reach_of
    monkeypatch.setattr(grid, "_reach_of", lambda *of: FAULTS[fault](*known(*of)))
    assert sum(map(missing, range(8))) > 0


def test_points_and_ends_leave_the_usual_radius_as_it_is() -> None:
    assert usual_radius([1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 0.0], ends=4) == 2.0
