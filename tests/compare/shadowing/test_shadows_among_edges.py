"""Shadows among segments and polygons: the certified start has the engine's contacts; what breaks a law has none."""

from __future__ import annotations

from random import Random

import pytest
from arc_faults import ArcFault
from arc_scenes import scene_of as arcs_of
from polygon_faults import PolygonFault
from segment_faults import SegmentFault

from truebreak.compare.shadowing.pseudo_orbit import recorded
from truebreak.compare.shadowing.shadows import shadow
from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Arc, Circle, Polygon, Quantity, Scene, SceneError, Segment, Wall, catalogue

BOX = [Wall(-8, -8, 8, -8), Wall(8, -8, 8, 8), Wall(8, 8, -8, 8), Wall(-8, 8, -8, -8)]
DART = [(0, 0), (4, 0), (4, 3), (2, 1), (0, 3)]


def drawn(seed: int) -> Scene | None:
    """Three discs among three segments, or two polygons of which one is not convex, in a box."""
    rng = Random(seed)
    at = lambda: Quantity.of(rng.randint(-4000, 4000)) / 1000  # noqa: E731
    discs = [Circle(-6 + 3 * k, 7, r="1/2", vx=at(), vy=at(), id=f"c{k}") for k in range(3)]
    try:
        if seed % 2:
            bars = [Segment(at(), at(), at(), at(), id=f"s{k}", r=rng.choice(("0", "1/3"))) for k in range(3)]
            return Scene(discs, BOX, segments=bars)
        x, y = at(), at()
        solids = [
            Polygon([(x + a, y + b) for a, b in DART], "dart"),
            Polygon([(at(), at()) for _ in range(3)], "wedge"),
        ]
        return Scene(discs, BOX, polygons=solids)
    except SceneError:
        return None


SCENES = [scene for seed in range(100, 116) if (scene := drawn(seed)) is not None]


def test_what_doubles_compute_among_edges_has_a_shadow() -> None:
    left = 0
    for scene in SCENES:
        found = shadow(scene, "double", events=70)
        assert found.proof is not None, found.blocked
        theirs, mine = found.proof.run, DoubleEngine().run(scene, events=70)
        for name in (str(circle.id) for circle in scene.circles):
            streams = [
                [pair for event in run.events for pair in event.impulses if name in pair] for run in (theirs, mine)
            ]
            count = min(map(len, streams))
            assert streams[0][:count] == streams[1][:count]
        assert found.proof.run.certified
        assert found.proof.run_distance.position < 1e-9
        left += found.divergence is not None
    assert len(SCENES) >= 8
    assert left > 0  # some of them are other histories than that of the scene's own start


def test_the_parts_of_things_are_told_apart() -> None:
    """In places of the scene as engines see it: the left face of the one bar, an end of the other."""
    bars = [Segment(-3, 0, 3, 0, id="floor"), Segment("15/2", 2, "17/2", 2, id="shelf")]
    scene = Scene([Circle(-1, 3, vx="1/2", vy=-1, id="disc")], BOX[1:2], segments=bars)
    told = recorded(ExactEngine().run(scene, events=1), 1)
    seen = scene.surfaces
    assert told.links == ((0, len(seen.circles) + seen.faces.start),)
    side = Scene([Circle(-9, "1/2", vx=1, id="disc")], segments=bars[:1])
    assert recorded(ExactEngine().run(side, events=1), 1).links == ((0, 1),)


@pytest.mark.parametrize("fault", ["no ends", "no thickness", "faces too long"])
def test_what_takes_segments_for_others_has_none(fault: str) -> None:
    bars = [Segment(-4, 0, "1/5", 0, id="a", r="1/2"), Segment(-4, 0, -4, 5, id="b", r="1/2")]
    scene = Scene([Circle("3/5", 5, vx="1/90", vy=-2, id="c")], BOX, segments=bars)
    faulty = SegmentFault(fault=fault)
    honest, run = DoubleEngine().run(scene, events=12), faulty.run(scene, events=12)
    assert abs(honest.after(11).array() - run.after(11).array()).max() > 1e-3
    assert shadow(scene, faulty, events=12).proof is None


@pytest.mark.parametrize("fault", ["no thickness", "no corners"])
def test_what_takes_polygons_for_others_has_none_nearby(fault: str) -> None:
    """Some true history may have its contacts in their order: not one that is near it."""
    scene = Scene([Circle("3/5", 5, vx="1/90", vy=-2, id="c")], BOX, polygons=[Polygon(DART, "dart", "1/2")])
    honest, run = DoubleEngine().run(scene, events=12), PolygonFault(fault=fault).run(scene, events=12)
    assert abs(honest.after(11).array() - run.after(11).array()).max() > 1e-3
    told = shadow(scene, PolygonFault(fault=fault), events=12).proof
    assert told is None or told.run_distance.position > 0.1
    good = shadow(scene, "double", events=12).proof
    assert good is not None
    assert good.run_distance.position < 1e-12


def test_runs_among_arcs_have_shadows() -> None:
    """Of the tables with arcs, and of random scenes: a disc within may fly away from the side that it meets next."""
    scenes = [catalogue.build(name) for name in ("stadium", "mushroom", "lemon")]
    scenes += [s for seed in range(14) if (s := arcs_of(seed)) is not None and s.elastic]
    proved = 0
    for scene in scenes:
        told = shadow(scene, "double", events=20)
        if told.proof is None:
            continue
        proved += 1
        mine, theirs = recorded(DoubleEngine().run(scene, events=20), 20), recorded(told.proof.run, 20)
        assert sorted(mine.links[: len(theirs.links)]) == sorted(theirs.links)
        assert told.proof.run_distance.position < 1e-10
    assert proved >= len(scenes) - 1


def test_the_shadow_of_a_law_broken_at_an_arc_is_far() -> None:
    ring = Scene([Circle(0, "1/3", r="1/2", vx=2, vy="1/7", id="c")], arcs=[Arc(0, 0, 5, id="ring", full=True)])
    near, far = (shadow(ring, engine, events=12).proof for engine in ("double", ArcFault(fault="too wide within")))
    assert near is not None
    assert near.run_distance.position < 1e-10
    assert far is None or far.run_distance.position > 0.1  # in a ring every order of contacts is some run's
