"""The audit among segments: engines that keep the law pass, and one that takes a segment for another is found."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from segment_faults import SEEN, SegmentFault
from segment_scenes import scene_of

from truebreak.compare import compare, engine
from truebreak.compare.audit.audit import Audit, audit_run
from truebreak.floating import DoubleEngine, PymunkEngine
from truebreak.scenarios import Circle, Declared, Scene, Segment, Wall, catalogue
from truebreak.scenarios.files import load_scene

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


class Blind(Declared):
    """pymunk, which does not know of any segment, at this step or the finer ones."""

    name, bits, rounds_input = "blind", 53, True

    def __init__(self, step: float, sees: float) -> None:
        self.step, self.sees = step, sees

    def finer(self) -> Blind:
        return Blind(self.step / 2, self.sees)

    def run(self, scene: Scene, **limits: Any) -> Any:
        seen = scene if self.step <= self.sees else scene.with_changes(segments=())
        told = PymunkEngine(dt=self.step).run(seen, **limits)
        return replace(told, scene=scene, engine=self.name)


def slit(thick: str) -> Scene:
    """A disc of radius 1/100 that flies at a slit twice as thick as is given, and back from a wall behind it."""
    disc = Circle("11/50", "1/3", r="1/100", vx=1, vy="1/7", id="disc")
    sides = [Wall(0, 0, 0, 1, id="left"), Wall(1, 1, 1, 0, id="right")]
    return Scene([disc], sides, segments=[Segment("1/2", 0, "1/2", 1, r=thick, id="slit")])


@pytest.mark.parametrize(
    ("thick", "dt", "sees", "kind"),
    [
        ("0", "1/16", 1 / 128, "tunnelling"),
        ("1/2000", "1/16", 1 / 32, "tunnelling"),
        ("0", "1/16", 0.0, "missed"),
        ("1/100", "1/256", 0.0, "missed"),
    ],
)
def test_what_is_passed_between_two_steps_is_tunnelling_and_the_rest_a_law(
    thick: str, dt: str, sees: float, kind: str
) -> None:
    """An overlap in which a step ends, or a finer one, and which is not told, is no matter of the step."""
    chosen = Blind(float(Fraction(dt)), sees)
    audit = audited(chosen, slit(thick))
    assert kind in [defect.kind for defect in audit.defects], audit.defects
    assert audit.kept is (kind == "tunnelling"), audit.sentence
    found = compare(slit(thick), [chosen], until=2).candidates[0]
    assert found.diagnosis is not None
    assert found.diagnosis.name.name == {"tunnelling": "TUNNELLING", "missed": "LAW"}[kind]


@pytest.mark.parametrize(("speed", "kept"), [(8, None), (4, False)])
def test_what_is_missed_after_the_series_is_a_law_where_more_steps_end_in_it_than_it_takes_to_see_it(
    speed: int, kept: bool | None
) -> None:
    """The series ends long before the slow disc comes to what the engine does not see: in an overlap of 1.6 steps
    nothing shows that it falls; in one of 3.2 there is no need of that."""
    discs = [Circle("1/2", -5, r="1/10", vx=24, id="fast"), Circle("1/2", 0, r="1/10", vy=speed, id="slow")]
    walls = [Wall(0, 0, 0, 1, id="left"), Wall(1, 1, 1, 0, id="right")]
    scene = Scene(discs, walls, segments=[Segment("1/10", 50, "9/10", 50, id="shelf")])
    blind = Blind(1 / 64, 0.0)
    audit = audit_run(blind.run(scene, until=15), blind)
    assert [(d.kind, d.of_step) for d in audit.defects if d.kind == "missed"] == [("missed", kept)]
    assert audit.kept is kept, audit.sentence
    assert "missed" in audit.reason or "fly 0.2 into each other" in audit.sentence


def test_a_bullet_that_a_step_lets_through_breaks_no_law() -> None:
    """It overlaps the target for a twelfth of the finest step of the series: no end of a step can see it."""
    scene = load_scene(Path(__file__).parents[2] / "data" / "verdict" / "bullet.json")
    laws = compare(scene, ["pymunk:dt=1/64"], until=12).candidates[0].laws
    assert laws is not None and laws.kept, laws


def test_a_point_and_a_segment_without_thickness_never_overlap() -> None:
    """No finer step helps; nor is it a law that is not kept: at no step's end is there anything to see."""
    found = compare(catalogue.build("barrier"), ["pymunk"], events=40)["pymunk"]
    assert found.laws is not None and found.laws.kept, found.laws
    assert "between the ends of its steps it passes through" in found.laws.sentence
    assert found.diagnosis is not None
    assert found.diagnosis.name.value == "tunnelling"
    assert found.diagnosis.finding == "ball and slit have no thickness: they overlap at no step's end"


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
