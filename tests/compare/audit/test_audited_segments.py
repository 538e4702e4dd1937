"""The audit among segments: engines that keep the law pass, and one that takes a segment for another is found."""

from __future__ import annotations

from typing import Any

import pytest
from segment_faults import SEEN, SegmentFault
from segment_scenes import scene_of

from truebreak.compare import engine
from truebreak.compare.audit.audit import Audit, audit_run
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Circle, Scene, Segment

SCENES = [scene for seed in range(120) if (scene := scene_of(seed)) is not None]
UNTIL, EVENTS = 20, 30


def audited(chosen: Any, scene: Scene) -> Audit:
    return audit_run(chosen.run(scene, until=UNTIL, events=EVENTS), chosen)


@pytest.mark.parametrize(
    "name", ["double", "single", "quad", "rounded:bits=40", "rounded:bits=12", "interval", "exact"]
)
def test_engines_of_events_keep_the_laws_among_segments(name: str) -> None:
    chosen = engine(name)
    found = [audited(chosen, scene) for scene in SCENES[: 60 if name in ("interval", "exact") else None]]
    assert [audit.sentence for audit in found if not audit.kept] == []
    assert sum(audit.impacts for audit in found) > 150


def test_steps_keep_the_laws_among_segments_of_some_thickness() -> None:
    chosen = engine("pymunk:dt=1/512")
    thick = [s for s in SCENES if all(b.r.sign() > 0 for b in s.segments) and not any(c.point for c in s.circles)]
    found = [audited(chosen, scene) for scene in thick[:8]]
    assert [audit.sentence for audit in found if audit.kept is False] == []
    assert sum(audit.impacts for audit in found) > 30


@pytest.mark.parametrize("seed", [67, 119])
def test_a_step_before_or_after_a_face_ends_the_push_tells_which_it_was(seed: int) -> None:
    """The disc is within a step of where a face becomes an end, and nearer to the one that has not pushed."""
    scene = scene_of(seed)
    assert scene is not None
    for dt in ("1/256", "1/512"):
        audit = audited(engine(f"pymunk:dt={dt}"), scene)
        assert audit.kept, audit.sentence
        assert audit.impacts > 0


@pytest.mark.parametrize("fault", SEEN)
def test_a_fault_that_changes_what_happens_is_a_law_not_kept(fault: str) -> None:
    faulty, found = SegmentFault(fault=fault), 0
    for scene in SCENES:
        if any(c.point for c in scene.circles):  # where a point meets an end, no law says how it goes on
            continue
        honest, run = (each.run(scene, until=UNTIL, events=EVENTS) for each in (DoubleEngine(), faulty))
        if abs(honest.final.array() - run.final.array()).max() > 1e-3:
            audit = audit_run(run, faulty)
            assert audit.kept is False, (fault, scene.data())
            found += 1
    assert found > 10


def test_the_words_of_what_is_found() -> None:
    shelf = Segment(0, 0, 8, 0, id="shelf", r="1/2")
    up = Segment(0, 9, 8, 9, id="roof")
    scene = Scene([Circle(4, 5, vx="1/9", vy=-2, id="ball")], segments=[shelf, up])
    thin = audited(SegmentFault(fault="no thickness"), scene)
    assert str(thin.fit) == "shelf taken to be 0.5 thinner on each side fits 3 of 3 impacts"
    assert thin.first is not None
    assert thin.first.bodies == ("ball", "shelf")
    assert thin.first.size == pytest.approx(0.5)
    end = Scene([Circle("3/5", 5, vy=-2, id="ball")], segments=[Segment(-9, 0, "1/5", 0, id="shelf")])
    lost = audited(SegmentFault(), end)  # .4 beside its end it flies past: .6 deep
    assert lost.first is not None
    assert (lost.first.kind, lost.first.bodies) == ("depth", ("ball", "shelf"))
    assert lost.first.size == pytest.approx(0.6)
