"""How far engines are held to the true history among segments, polygons and arcs: honest ones keep it, others not."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from arc_scenes import scene_of as arcs
from joint_scenes import scene_of as joints
from polygon_scenes import scene_of as polygons
from segment_scenes import scene_of as segments

from truebreak.compare.testing.check import NotDecided, check
from truebreak.compare.tolerances.errors_grown import local_error
from truebreak.compare.tolerances.reach import Reach, reach_of
from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine, SingleEngine
from truebreak.scenarios import Arc, Circle, Engine, Quantity, Scene, Segment, Trajectory, Wall, catalogue

MAKERS = {"segments": segments, "polygons": polygons, "joints": joints, "arcs": arcs}


@cache
def scenes(make: Callable[[int], Scene | None], seeds: range) -> list[Scene]:
    """Those whose true run is not ended by a point at an end, which has no normal."""
    drawn = [scene for seed in seeds if (scene := make(seed)) is not None]
    found = [scene.with_changes(events=8) for scene in drawn if scene.elastic]
    return [scene for scene in found if not ExactEngine().run(scene).stop.message.startswith("undecided")]


def reach(scene: Scene, engine: Engine) -> Reach:
    run = ExactEngine().run(scene)
    return reach_of(run, local_error(engine, run, engine.bits))


@pytest.mark.parametrize("kind", MAKERS)
@pytest.mark.parametrize("engine", [DoubleEngine(), SingleEngine()], ids=["double", "single"])
def test_honest_engines_are_not_found_fault_with(kind: str, engine: Engine) -> None:
    required = 0
    for scene in scenes(MAKERS[kind], range(12)):
        try:
            check(engine, scene)
        except NotDecided:
            continue
        required += reach(scene, engine).events
    assert required > 15


@pytest.mark.parametrize(("make", "seed"), [(polygons, 60), (polygons, 71), (segments, 75), (polygons, 304)])
def test_what_flies_along_or_grazes_on_the_way_is_no_ones_duty(make: Callable[[int], Scene], seed: int) -> None:
    """Grazes of exactly no depth by a circle whose own next event is later than others', or not in the run at all."""
    scene = make(seed).with_changes(events=12)
    limit = reach(scene, SingleEngine()).limit
    assert limit is not None
    check(SingleEngine(), scene)


@dataclass(frozen=True)
class Thick(DoubleEngine):
    """Doubles that take every segment to be thicker, by some 10**-9."""

    by: str = "1/10**9"

    def run(self, scene: Scene, **limits: Any) -> Trajectory:
        bars = [Segment(s.x0, s.y0, s.x1, s.y1, id=s.id, r=s.r + self.by) for s in scene.segments]
        return replace(super().run(scene.with_changes(segments=bars), **limits), scene=scene)


@pytest.mark.parametrize("name", ["funnel", "barrier"])
def test_an_engine_whose_segments_are_thicker_is_found(name: str) -> None:
    scene = catalogue.build(name).with_changes(events=20)
    check(DoubleEngine(), scene)
    with pytest.raises(AssertionError, match="double"):
        check(Thick(), scene)


def test_near_the_place_where_a_face_becomes_an_end_nothing_is_required() -> None:
    corner = reach(catalogue.build("corner-hit"), DoubleEngine())
    assert corner.events == 0
    assert corner.limit is not None
    assert "meets box between its ends or at one; its margin is 1e-20" in str(corner.limit)
    beside = Scene([Circle("3 - 1/10**6", 2, vy=-1)], segments=[Segment(-3, 0, 3, 0)], events=1)
    assert reach(beside, DoubleEngine()).limit is None
    assert reach(beside, SingleEngine()).limit is not None


def test_what_flies_along_a_face_is_not_required_to_miss_it() -> None:
    scene = Scene([Circle(-2, 1, vx=1), Circle(6, 1)], segments=[Segment(-9, 0, 9, 0, id="floor")], events=2)
    limit = reach(scene, DoubleEngine()).limit
    assert limit is not None
    assert limit.event == 0
    assert "which flies along floor, meets it" in limit.told


def test_long_runs_among_edges_are_required_as_far_as_their_digits_go() -> None:
    double, single = (
        reach(catalogue.build("triangle").with_changes(events=60), e) for e in (DoubleEngine(), SingleEngine())
    )
    assert double.whole
    assert 30 < single.events <= double.events
    for name in ("wind-tree", "funnel", "barrier"):
        assert reach(catalogue.build(name).with_changes(events=25), DoubleEngine()).events == 25


@dataclass(frozen=True)
class Wide(DoubleEngine):
    """Doubles that take every arc to be wider, by some 10**-9, or to end by as much elsewhere."""

    longer: bool = False

    def run(self, scene: Scene, **limits: Any) -> Trajectory:
        by = Quantity.of("1/10**9")
        more = by if self.longer else Quantity.of(0)
        bows = [
            Arc(a.x, a.y, a.r if self.longer else a.r + by, id=a.id, full=True) if a.full else
            Arc(a.x, a.y, a.r if self.longer else a.r + by, a.x0 + more, a.y0 + more, a.x1, a.y1, id=a.id)
            for a in scene.arcs
        ]  # fmt: skip
        return replace(super().run(scene.with_changes(arcs=bows), **limits), scene=scene)


@pytest.mark.parametrize("name", ["stadium", "mushroom", "lemon", "round-table"])
def test_an_engine_whose_arcs_are_wider_is_found(name: str) -> None:
    scene = catalogue.build(name).with_changes(events=20)
    check(DoubleEngine(), scene)
    with pytest.raises(AssertionError, match="double"):
        check(Wide(), scene)


@pytest.mark.parametrize("hollow", [True, False])
def test_near_the_place_where_an_arc_ends_nothing_is_required(hollow: bool) -> None:
    """A disc that meets a side of a half-circle 10**-6, or 10**-20, before its end: doubles decide the first."""

    def meets(off: str) -> Scene:
        bow = Arc(0, 0, 5, 0, -5, 0, 5, id="bow")
        reach = Quantity.of(4 if hollow else 6)
        x = Quantity.of(off)
        y = (reach * reach - x * x).sqrt()
        return Scene([Circle(x, y + (-2 if hollow else 2), vy=1 if hollow else -1, id="c")], arcs=[bow], events=1)

    assert reach(meets("1/10**6"), DoubleEngine()).limit is None
    limit = reach(meets("1/10**20"), DoubleEngine()).limit
    assert limit is not None
    assert limit.told in ("whether c would meet bow first", "whether c meets bow between its ends or at one")
    assert reach(meets("1/10**6"), SingleEngine()).limit is not None
    onto_its_end = Scene([Circle("23/10", -3, vy=-1, id="c")], arcs=[Arc(0, 0, 5, 3, -4, 0, 5)], events=1)
    check(DoubleEngine(), onto_its_end)
    with pytest.raises(AssertionError, match=r"velocity of c|time = "):
        check(Wide(longer=True), onto_its_end)


def test_grazes_of_the_outside_are_no_ones_duty_and_what_flies_within_is_far_from_it() -> None:
    """A disc passes a full circle by 10**-k; another bounces in one, and is not asked whether it passes the outside."""

    def passes(k: int) -> Reach:
        ring = Arc(0, 0, 3, full=True, id="ring")
        gone = [Circle(-9, 4 + Quantity.of(10) ** -k, vx=1, id="c"), Circle(9, 9, vx=1, vy="1/100")]
        return reach(Scene(gone, [Wall(8, 0, 8, 1)], arcs=[ring], events=3), DoubleEngine())

    assert passes(6).limit is None
    limit = passes(20).limit
    assert limit is not None
    assert "whether c passes ring" in limit.told
    within = reach(Scene([Circle(0, 1, vx=1)], arcs=[Arc(0, 0, 9, full=True)], events=30), DoubleEngine())
    assert within.whole


def test_long_runs_in_tables_of_arcs_are_required_as_far_as_their_digits_go() -> None:
    found = {
        name: [reach(catalogue.build(name).with_changes(events=40), e).events for e in (DoubleEngine(), SingleEngine())]
        for name in ("stadium", "mushroom", "lemon")
    }
    assert found["lemon"] == [40, 40]
    assert found["mushroom"][0] == 40
    assert 20 < found["stadium"][0] < 40
    assert all(0 < single <= double for double, single in found.values())
