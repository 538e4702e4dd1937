"""The audit among arcs: engines that keep the law pass, and one that takes an arc for another is found."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from arc_faults import SEEN, ArcFault
from arc_scenes import falls_to_arcs, scene_of
from edge_campaign import scene_of as drawn_of
from guise_campaign import GUISED

from truebreak.compare import compare, engine
from truebreak.compare.audit.audit import Audit, audit_run
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Arc, Circle, Pocket, Polygon, Quantity, Scene, SceneError, Wall, catalogue

SCENES = [scene for seed in range(120) if (scene := scene_of(seed)) is not None and scene.elastic]
UNTIL, EVENTS = 20, 30


def audited(chosen: Any, scene: Scene) -> Audit:
    return audit_run(chosen.run(scene, until=UNTIL, events=EVENTS), chosen)


@pytest.mark.parametrize(
    "name", ["double", "single", "quad", "rounded:bits=40", "rounded:bits=12", "interval", "exact"]
)
def test_engines_of_events_keep_the_laws_among_arcs(name: str) -> None:
    chosen = engine(name)
    found = [audited(chosen, scene) for scene in SCENES[: 30 if name in ("interval", "exact") else None]]
    assert [audit.sentence for audit in found if not audit.kept] == []
    assert sum(audit.impacts for audit in found) > 150


@pytest.mark.parametrize("fault", SEEN)
def test_a_fault_that_changes_what_happens_is_a_law_not_kept(fault: str) -> None:
    faulty, found = ArcFault(fault=fault), 0
    for scene in SCENES:
        if any(c.point for c in scene.circles):  # where a point meets an end, no law says how it goes on
            continue
        try:
            honest, run = (each.run(scene, until=UNTIL, events=EVENTS) for each in (DoubleEngine(), faulty))
        except SceneError:  # a circle lies across the rest of the circle
            continue
        stopped = not run.events and "time limit" not in run.stop.message  # within its first instant
        if not stopped and abs(honest.final.array() - run.final.array()).max() > 1e-3:
            audit = audit_run(run, faulty)
            assert audit.kept is False, (fault, scene.data())
            found += 1
    assert found > 10


def test_two_contacts_with_one_thing_are_with_its_nearest_parts() -> None:
    """In numbers of 12 bits nearly everything is near: a disc that meets a side and an end meets no other end."""
    chosen = engine("rounded:bits=12")
    for seed in (4, 165):
        scene = scene_of(seed)
        assert scene is not None
        audit = audit_run(chosen.run(scene, until=200, events=60), chosen)
        assert audit.kept, audit.sentence


def test_a_disc_in_the_opening_is_not_pushed_by_what_lies_beside_it() -> None:
    """Seed 138 in single: a disc that has met an end, its centre no farther from the middle than the arc's radius."""
    scene = scene_of(138)
    assert scene is not None
    run, true = (engine(name).run(scene, until=20, events=14) for name in ("single", "exact"))
    assert [event.contacts for event in run.events] == [event.contacts for event in true.events]


def test_the_words_of_what_is_found() -> None:
    ring = Arc(0, 0, 5, id="ring", full=True)
    scene = Scene([Circle(0, "1/3", vx=2, vy="1/7", id="ball")], arcs=[ring])
    wide = audited(ArcFault(fault="too wide within"), scene)
    assert str(wide.fit) == "contacts 0.5 into each other fits 4 of 4 impacts"
    assert wide.first is not None
    assert wide.first.bodies == ("ball", "ring")
    assert wide.first.size == pytest.approx(0.5)
    lost = audited(ArcFault(fault="outside only"), scene)
    assert lost.first is not None
    assert (lost.first.kind, lost.first.bodies) == ("depth", ("ball", "ring"))


# -- Under gravity.

FALLS = [catalogue.build("bowl"), catalogue.build("pinball-table"), *map(falls_to_arcs, range(40))]


@pytest.mark.parametrize(
    ("name", "count"),
    [("double", 42), ("single", 42), ("quad", 8), ("rounded:bits=40", 12), ("rounded:bits=12", 14), ("interval", 8),
     ("exact", 8)],
)  # fmt: skip
def test_engines_of_events_keep_the_laws_where_discs_fall_onto_arcs(name: str, count: int) -> None:
    chosen = engine(name)
    found = [audit_run(chosen.run(scene, events=30), chosen) for scene in FALLS[:count]]
    assert [audit.sentence for audit in found if not audit.kept] == []
    assert sum(audit.impacts for audit in found) > 5 * count


@pytest.mark.parametrize("fault", SEEN)
def test_a_fault_of_arcs_is_found_under_gravity(fault: str) -> None:
    faulty, found = ArcFault(fault=fault), 0
    for scene in FALLS[2:]:
        try:
            honest, run = (each.run(scene, events=20, until=4) for each in (DoubleEngine(), faulty))
        except SceneError:  # a circle lies across the rest of the circle
            continue
        if abs(honest.final.array() - run.final.array()).max() > 1e-3:
            audit = audit_run(run, faulty)
            assert audit.kept is False, (fault, scene.data())
            found += 1
    assert found > 1


class Heavier(DoubleEngine):
    """Falls by a millionth more than the scene says."""

    def run(self, scene: Scene, **limits: Any) -> Any:
        """The run, as if it were of the scene itself."""
        assert scene.gravity is not None
        more = Quantity.of("1 + 1/10**6")
        found = super().run(scene.with_changes(gravity=tuple(part * more for part in scene.gravity)), **limits)
        return replace(found, scene=scene)


def test_a_fall_that_is_faster_by_a_millionth_is_described_in_a_bowl() -> None:
    run = Heavier().run(catalogue.build("bowl"), events=20)
    found = audit_run(run, Heavier())
    assert found.kept is False
    assert "an acceleration of -1e-05 along y fits" in found.sentence


def test_a_disc_that_comes_through_a_bowl_is_found_where_it_does_so_late() -> None:
    """It leaves by the opening, falls back in, and is not stopped by the bottom: the third zero of the gap."""
    bowl = Arc(0, 0, 5, -4, 3, 4, 3, id="bowl")
    scene = Scene([Circle(0, 0, r="1/2", vy=12, id="ball")], arcs=[bowl], gravity=(0, -8), events=1)
    run = DoubleEngine().run(scene.with_changes(arcs=[]), until=5)
    found = audit_run(replace(run, scene=scene), DoubleEngine())
    assert found.first is not None
    assert (found.first.kind, found.first.bodies) == ("depth", ("ball", "bowl"))
    honest = DoubleEngine().run(scene)
    assert float(honest.events[0].time) < found.first.time


@pytest.mark.parametrize("far", [0, 10**6])
@pytest.mark.parametrize("name", ["double", "quad"])
def test_one_that_leaves_a_bowl_at_an_extreme_speed_meets_nothing_more(name: str, far: int) -> None:
    """Of its zeros, which are 10**8 radii apart, doubles tell of one that there is not."""
    ball = Circle(
        far + Quantity.of("37/10"), Quantity.of("27/10") - far * far, "23/100", -33 * 10**8, -4 * 10**8, id="ball"
    )
    bowl = Arc(far, -far * far, 9, far - 9, -far * far, far + 9, -far * far, id="bowl")
    scene = Scene([ball], arcs=[bowl], gravity=(1, -10))
    run = engine(name).run(scene, until=3)
    assert len(run.events) == 0 == len(engine("exact").run(scene, until=3).events)
    assert audit_run(run, engine(name)).kept


@pytest.mark.parametrize("capture", [False, True])
def test_laws_are_kept_among_pockets_under_gravity(capture: bool) -> None:
    discs = [Circle(0, 5, id="falls"), Circle(5, 5, vx=-1, vy=3, id="thrown"), Circle(-6, 2, vx=1, id="rolls")]
    floor, hole = Wall(0, 0, 1, 0, id="floor"), Pocket(0, 2, 1, id="hole")
    scene = Scene(discs, [floor], pockets=[hole], capture=capture, gravity=(0, -1))
    for name in ("double", "single", "rounded:bits=20", *(() if capture else ("pymunk:dt=1/256",))):
        run = engine(name).run(scene, until=20)
        assert run.pocketings
        assert audit_run(run, engine(name)).kept, name


def test_what_comes_after_all_is_turned_back_at_one_double_is_no_part_of_the_turn() -> None:
    """Two mirrored discs meet theirs at one instant, which rounding takes apart; all is turned back between the two."""
    aged = drawn_of(417, GUISED)
    assert aged is not None
    run = engine("quad").run(aged.scene, until=aged.until, events=20)
    assert run.reversal is not None
    assert sum(float(event.time) == float(run.reversal.time) for event in run.events) > run.reversal.after - 1
    assert audit_run(run, engine("quad")).kept


@pytest.mark.parametrize("name", ["double", "interval", "single"])
@pytest.mark.parametrize("thing", ["arc", "polygon"])
def test_two_ends_of_one_thing_that_push_at_once_are_both_seen(name: str, thing: str) -> None:
    """Their normals are at more than a right angle, and the one that pushes less seems to pull."""
    nook = [(0, 0), (0, -1), (-2, -1), (-2, 1), ("-1/5", 1), ("-1/5", "2/5"), (-1, "2/5"), (-1, 0)]
    solid: dict[str, Any] = (
        {"arcs": [Arc("-1/2", 0, "1/2", "-1/5", "2/5", 0, 0, id="a")]}
        if thing == "arc"
        else {"polygons": [Polygon(nook, "a")]}
    )
    for vx in (0, "-1/3", "1/9"):
        disc = Circle(0, "1/4", "1/4", vx=vx, vy=-1, id="d")
        found = compare(Scene([disc], **solid), [name], until=4)
        assert found.reference.events[0].contacts == (("d", "a"), ("d", "a"))
        laws = found.candidates[0].laws
        assert laws is not None
        assert laws.kept


def test_what_a_pocket_takes_as_time_begins_began_as_the_scene_says() -> None:
    """On the rim, and moving in: its state at time 0 is the one in which the pocket leaves it, at rest."""
    scene = Scene([Circle(0, 0, vx=1, id="a")], [], pockets=[Pocket(1, 0, 1, id="hole")], capture=True)
    run = engine("exact").run(scene, until=2)
    assert [(entry.circle, float(entry.time)) for entry in run.pocketings] == [("a", 0.0)]
    assert audit_run(run, engine("exact")).kept


@pytest.mark.parametrize(("taken", "size"), [("1999/1000", "0.001 less"), ("2001/1000", "0.001 more")])
@pytest.mark.parametrize("within", [False, True])
def test_of_an_arc_met_on_one_side_alone_the_radius_is_wrong(within: bool, taken: str, size: str) -> None:
    """It has no thickness, and of the side that nothing met nothing is known."""
    inside = [Circle(-1, "1/7", "1/4", "6/5", "1/2", id="a"), Circle(1, "-1/3", "1/4", "-1/2", "2/3", id="b")]
    rows = [
        (-6, 0, 1, "1/20", "a"),
        (6, "1/3", -1, 0, "b"),
        (0, 7, 0, -1, "c"),
        (-3, 20, 1, 0, "d"),
        (3, 20, -1, 0, "e"),
    ]
    outside = [Circle(x, y, 1, vx, vy, id=name) for x, y, vx, vy, name in rows]

    def scene(radius: Any) -> Scene:
        return Scene(inside if within else outside, arcs=[Arc(0, 0, radius, id="ring", full=True)])

    run = engine("double").run(scene(taken), events=12 if within else 4)
    found = audit_run(replace(run, scene=scene(2)), engine("double"))
    assert found.kept is False
    assert str(found.fit).startswith(f"the radius of ring taken for {size} fits"), found.sentence
