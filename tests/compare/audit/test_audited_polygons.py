"""The audit among polygons: engines that keep the law pass, and one that takes a polygon for another is found."""

from __future__ import annotations

from typing import Any

import pytest
from polygon_faults import SEEN, PolygonFault
from polygon_scenes import scene_of

from truebreak.compare import engine
from truebreak.compare.audit.audit import Audit, audit_run
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Circle, Polygon, Scene, Wall

SCENES = [scene for seed in range(90) if (scene := scene_of(seed)) is not None]
UNTIL, EVENTS = 20, 20
NOOK = Polygon([(-9, -9), (9, -9), (9, 0), (0, 0), (0, 9), (-9, 9)], id="nook", r="1/4")


def audited(chosen: Any, scene: Scene) -> Audit:
    return audit_run(chosen.run(scene, until=UNTIL, events=EVENTS), chosen)


@pytest.mark.parametrize("name", ["double", "rounded:bits=40", "rounded:bits=12", "exact"])
def test_engines_of_events_keep_the_laws_among_polygons(name: str) -> None:
    chosen = engine(name)
    found = [audited(chosen, scene) for scene in SCENES[: 20 if name == "exact" else None]]
    assert [audit.sentence for audit in found if not audit.kept] == []
    assert sum(audit.impacts for audit in found) > 100


def test_steps_keep_the_laws_among_polygons() -> None:
    chosen = engine("pymunk:dt=1/512")
    scenes = [s for s in SCENES if not any(c.point for c in s.circles)]
    found = [audited(chosen, scene) for scene in scenes[:8]]
    assert [audit.sentence for audit in found if audit.kept is False] == []
    assert sum(audit.impacts for audit in found) > 20


@pytest.mark.parametrize("name", ["double", "rounded:bits=20"])
@pytest.mark.parametrize("vy", ["-1", "-2", "-100001/100000"])
def test_in_a_concave_corner_each_of_both_faces_is_told_apart(name: str, vy: str) -> None:
    """At one instant, at instants that rounding tells apart, and one after the other."""
    scene = Scene([Circle(5, 5, r=1, vx=-1, vy=vy, id="c")], polygons=[NOOK])
    audit = audited(engine(name), scene)
    assert audit.kept, audit.sentence
    assert audit.impacts >= 2


@pytest.mark.parametrize("fault", SEEN)
def test_a_fault_that_changes_what_happens_is_a_law_not_kept(fault: str) -> None:
    faulty, found = PolygonFault(fault=fault), 0
    for scene in SCENES:
        if any(c.point for c in scene.circles):  # where a point meets a corner, no law says how it goes on
            continue
        if fault == "an open outline" and len(scene.polygons) > 1:  # outlines that share a side are no scene
            continue
        honest, run = (each.run(scene, until=UNTIL, events=EVENTS) for each in (DoubleEngine(), faulty))
        if abs(honest.final.array() - run.final.array()).max() > 1e-3:
            audit = audit_run(run, faulty)
            assert audit.kept is False, (fault, scene.data())
            found += 1
    assert found > 5


def test_the_words_of_what_is_found() -> None:
    slab = Polygon([(-9, -2), (9, -2), (9, 0), (-9, 0)], id="slab", r="1/2")
    scene = Scene([Circle(0, 5, vx="1/9", vy=-2, id="ball")], [Wall(-9, 9, 9, 9, id="roof")], polygons=[slab])
    thin = audited(PolygonFault(fault="no thickness"), scene)
    assert str(thin.fit) == "slab taken to be 0.5 thinner on each side fits 3 of 3 impacts"
    assert thin.first is not None
    assert thin.first.bodies == ("ball", "slab")
    assert thin.first.size == pytest.approx(0.5)
    corner = Scene([Circle("48/5", 5, vy=-2, id="ball")], polygons=[Polygon(slab.points, "slab")])
    lost = audited(PolygonFault(fault="no corners"), corner)  # .6 beside the corner it flies past: .4 deep
    assert lost.first is not None
    assert (lost.first.kind, lost.first.bodies) == ("depth", ("ball", "slab"))
    assert lost.first.size == pytest.approx(0.4)
