"""Horizons of engines among segments: the bands hold as often as they say, and a thing's own sides decide nothing."""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from random import Random

import numpy as np
import pytest

from truebreak.compare import compare
from truebreak.compare.chaos.certified_chaos import chaos
from truebreak.compare.chaos.foreseen import foreseen
from truebreak.compare.tangent import hazard
from truebreak.compare.tangent import impacts as impacts_of
from truebreak.compare.tangent.growth import Displacements, unit_displacements
from truebreak.compare.tangent.hazard import Course
from truebreak.compare.tangent.impacts import NoTangentMap, impacts, moving
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Polygon, Quantity, Scene, SceneError, Segment, Wall

BOX = [Wall(-8, -8, 8, -8), Wall(8, -8, 8, 8), Wall(8, 8, -8, 8), Wall(-8, 8, -8, -8)]


def drawn(seed: int) -> Scene | None:
    """Three discs among three segments in a box."""
    rng = Random(seed)
    at = lambda: Quantity.of(rng.randint(-4000, 4000)) / 1000  # noqa: E731
    try:
        bars = [Segment(at(), at(), at(), at(), id=f"s{k}", r=rng.choice(("0", "1/3"))) for k in range(3)]
        discs = [Circle(-6 + 3 * k, 6, r="1/2", vx=at(), vy=at(), id=f"c{k}") for k in range(3)]
        return Scene(discs, BOX, segments=bars)
    except SceneError:
        return None


def adrift(seed: int) -> Scene | None:
    """Such a scene, in which each segment moves slowly, its own way."""
    scene, ways = drawn(seed), [("1/40", "-1/30"), ("-1/50", "1/60"), ("0", "1/35")]
    bars = [] if scene is None else [(s.x0, s.y0, s.x1, s.y1, s.id, s.r) for s in scene.segments]
    return scene and scene.with_changes(segments=[Segment(*row, *way) for row, way in zip(bars, ways, strict=True)])


def seen_in_bands(seeds: range, scenes: Callable[[int], Scene | None] = drawn) -> tuple[int, int]:
    """How often the first divergence falls in the band, and of how many."""
    held = told = 0
    for seed in seeds:
        scene = scenes(seed)
        if scene is None:
            continue
        for horizon in chaos(scene, ["double", "single", "rounded:bits=30", "pymunk"], events=130).horizons:
            if horizon.seen is not None and horizon.seen.place is not None:
                told += 1
                held += horizon.holds(horizon.seen.place)
    return held, told


def test_the_bands_hold_what_is_seen() -> None:
    held, told = seen_in_bands(range(100, 112))
    assert told >= 36
    assert held / told > 0.8


def test_the_bands_hold_what_is_seen_among_segments_that_move() -> None:
    held, told = seen_in_bands(range(100, 112), adrift)
    assert told >= 30
    assert held / told > 0.8


def test_a_hazard_without_ends_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where neither ends nor passing count, engines leave before they are foreseen to."""
    monkeypatch.setattr(hazard, "parts_of", lambda scene: {})
    monkeypatch.setattr(Course, "_circles", lambda self, i, partners: self._walls_of(i, range(len(self._walls)), 0))
    held, told = seen_in_bands(range(100, 112))
    assert held / told < 0.8


@pytest.mark.parametrize(("x", "depth"), [("1", 3.0), ("-5/2", 1.5), ("0", 4.0)])
def test_how_far_a_disc_is_from_passing_a_segment(x: str, depth: float) -> None:
    scene = Scene([Circle(x, 5, vx=0, vy=-1)], segments=[Segment(-3, 0, 3, 0)])
    [[impact]] = impacts(ExactEngine().run(scene), 1)
    course = Course(scene)
    course.fly(float(impact.time))
    found = course.passing(impact)
    assert found is not None
    assert found.depth == pytest.approx(depth)
    assert found.wait == pytest.approx(1.0)  # the ends lie 1 below the centre as the disc touches
    assert len(course.instead([impact], 0).places) == 0  # its other side and its ends are no other meeting


def test_what_would_be_met_instead_is_within_its_range() -> None:
    bars = [Segment(-3, 0, 3, 0, id="near"), Segment(-9, -4, 9, -4, id="far"), Segment(5, -2, 9, -2, id="beside")]
    scene = Scene([Circle(0, 5, vy=-1, id="disc")], segments=bars)
    run = ExactEngine().run(scene)
    [[impact]] = impacts(run, 1)
    course = Course(scene)
    course.fly(float(impact.time))
    others = course.instead([impact], 0)
    np.testing.assert_allclose(others.waits, [4.0])
    np.testing.assert_allclose(others.normals, [[0.0, -1.0]])


# -- Segments and polygons that move: the same as at rest, seen from another frame; and unlike each other.

PACE = Quantity.of("3/7"), Quantity.of("-2/5")


def boosted(scene: Scene) -> Scene:
    """The same, seen from a frame that moves the other way: all that was at rest moves alike."""
    vx, vy = PACE
    return scene.with_changes(
        circles=[Circle(c.x, c.y, c.r, c.vx + vx, c.vy + vy, m=c.m, id=c.id) for c in scene.circles],
        walls=[Wall(w.x0, w.y0, w.x1, w.y1, w.id, vx, vy) for w in scene.walls],
        segments=[Segment(s.x0, s.y0, s.x1, s.y1, s.id, s.r, vx, vy) for s in scene.segments],
        polygons=[Polygon(p.points, p.id, p.r, vx, vy) for p in scene.polygons],
    )


def hooked(seed: int, gravity: tuple[int, int] | None) -> Scene | None:
    """Such a scene, with a polygon that is not convex, and half of them with a restitution."""
    scene = drawn(seed)
    hook = Polygon([(-6, -7), (6, -7), (6, -5), (0, "-13/2"), (-6, -5)], "hook")
    try:
        e = ("1", "9/10")[seed % 2]
        return scene and scene.with_changes(polygons=[hook], gravity=gravity, restitution=e)
    except SceneError:
        return None


@pytest.mark.parametrize("gravity", [None, (0, -1)])
def test_tangent_maps_and_margins_are_those_of_another_frame(gravity: tuple[int, int] | None) -> None:
    ends = faces = 0
    for seed in range(100, 109):
        if (scene := hooked(seed, gravity)) is None:
            continue
        found = []
        for one in (scene, boosted(scene)):
            run = ExactEngine().run(one, events=14)
            struck = impacts(run, 14)
            carried = Displacements(one, unit_displacements(one))
            for event in struck:
                carried.through(event)
            found.append((struck, carried.matrix, hazard.margins(one, struck, moving(one))))
        (met, matrix, margins), (again, other, others) = found
        for one, two in zip(met, again, strict=True):
            assert [(i.a, i.b, i.wall) for i in one] == [(i.a, i.b, i.wall) for i in two]
        ends += sum(i.b is not None and i.b >= len(scene.circles) for event in met for i in event)
        faces += sum(i.wall is not None and i.wall >= len(BOX) for event in met for i in event)
        np.testing.assert_allclose(other, matrix, rtol=1e-7, atol=1e-7 * abs(matrix).max())
        for one, two in zip(margins, others, strict=True):
            for (i, mine), (k, theirs) in zip(one, two, strict=True):
                assert i == k
                np.testing.assert_allclose(np.sort(theirs), np.sort(mine), rtol=1e-6, atol=1e-6)
    assert ends > 3 and faces > 10


@pytest.mark.parametrize("gravity", [None, (0, -1)])
def test_a_graze_of_an_end_comes_when_it_does_in_another_frame(gravity: tuple[int, int] | None) -> None:
    """One disc is at the floor before another grazes the end of a segment, and a third one after that."""
    heights = ("-4", "-1") if gravity is None else ("-6", "-1")  # the graze comes at 5, or after 2.3
    others = [Circle(-6 + 3 * k, y, "1/2", vy=-1, id=f"d{k}") for k, y in enumerate(heights)]
    scene = Scene([Circle(4, 5, vy=-1, id="c"), *others], BOX[:1], segments=[Segment(1, 0, 3, 0)], gravity=gravity)
    for one in (scene, boosted(scene)):
        with pytest.raises(NoTangentMap, match="before event 1, c and s1 graze"):
            impacts(ExactEngine().run(one, events=3), 3)


def carried(gravity: tuple[int, int] | None) -> Scene:
    """Discs that meet faces, and ends, of segments that move each its own way."""
    bars = [
        Segment(-3, 0, 0, 0, id="left", vx="1/5", vy="1/2"),
        Segment("1/2", "-1/2", 4, -1, id="right", r="1/4", vx="-1/9", vy="1/3"),
    ]
    discs = [Circle("3/4", 5, "1/2", vy="-5/4", id="a"), Circle("5/2", 7, "1/2", vx="-1/7", vy=-1, id="b")]
    lid = Wall(0, 9, 1, 9, id="lid")
    return Scene(discs, [lid], segments=bars, gravity=gravity, restitution="4/5" if gravity else 1)


@pytest.mark.parametrize("gravity", [None, (0, -1)])
def test_the_tangent_map_of_what_moves_is_that_of_runs_nearby(gravity: tuple[int, int] | None) -> None:
    scene = carried(gravity)
    run = ExactEngine().run(scene, until=9)
    struck = impacts(run, len(run.events))
    met = [impact for event in struck for impact in event]
    assert any(i.wall is not None and i.wall > 0 for i in met) and any((i.b or 0) >= 2 for i in met)
    mapped = Displacements(scene, unit_displacements(scene))
    for event in struck:
        mapped.through(event)
    mapped.fly(9.0)
    small = Quantity.of(2) ** -60
    for place, key in ((4 * i + k, (i, key)) for i in (0, 1) for k, key in enumerate(("x", "y", "vx", "vy"))):
        i, name = key
        circles = list(scene.circles)
        c = circles[i]
        parts = {part: getattr(c, part) + (small if part == name else 0) for part in ("x", "y", "vx", "vy")}
        circles[i] = Circle(**parts, r=c.r, m=c.m, id=c.id)
        near = ExactEngine().run(scene.with_changes(circles=circles), until=9)
        assert [event.contacts for event in near.events] == [event.contacts for event in run.events]
        pairs = [
            (getattr(p, part), getattr(q, part))
            for p, q in zip(run.at(9).circles, near.at(9).circles, strict=True)
            for part in ("x", "y", "vx", "vy")
        ]
        grown = [float((Decimal(q.digits(60)) - Decimal(p.digits(60))) * 2**60) for p, q in pairs]
        np.testing.assert_allclose(mapped.matrix[:, place], grown, rtol=1e-7, atol=1e-7)


def still(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ends that are met as if they stood."""
    speed = impacts_of.true_speed
    halt = lambda state, i: (state.zero, state.zero) if i in state.paces else speed(state, i)  # noqa: E731
    monkeypatch.setattr(impacts_of, "true_speed", halt)


def standing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ends that are passed as if they stood."""
    made = Course.__init__

    def stand(self: Course, scene: Scene, known: object = None) -> None:
        made(self, scene, known)  # pyright: ignore[reportArgumentType]
        self.speeds[len(scene.circles) :] = 0.0

    monkeypatch.setattr(Course, "__init__", stand)


@pytest.mark.parametrize("gravity", [None, (0, -1)])
@pytest.mark.parametrize("plant", [still, standing])
def test_ends_that_move_as_if_they_stood_are_found(
    plant: Callable[[pytest.MonkeyPatch], None], gravity: tuple[int, int] | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    plant(monkeypatch)
    with pytest.raises(AssertionError):
        test_tangent_maps_and_margins_are_those_of_another_frame(gravity)
    if plant is still:
        with pytest.raises(AssertionError):
            test_the_tangent_map_of_what_moves_is_that_of_runs_nearby(gravity)


def test_a_comparison_foresees_its_engines() -> None:
    scene = drawn(100)
    assert scene is not None
    found = foreseen(compare(scene, ["single", "double"], events=80))
    assert found is not None
    assert found.events == 80
    assert all(horizon is not None for horizon in found.horizons)
