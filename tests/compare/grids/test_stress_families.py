"""The families of the stress map: valid scenes, what they are known to do, and witnesses that share no decision."""

from __future__ import annotations

from pathlib import Path

import pytest
from mpmath import mpf
from referee import compare_to_referee, settled
from segment_referee import Referee

from truebreak.compare.grids.stress_families import FAMILIES, MapPlace, StressFamily, stress_family
from truebreak.exact import ExactEngine, SymbolicEngine
from truebreak.scenarios import Circle, Scene, SceneError, Trajectory
from truebreak.scenarios.files import dump_toml, load_scene

ALL = [stress_family(name) for name in FAMILIES]
LANES = [(one, side) for one in ALL for side in one.sides]


def label(value: object) -> str:
    return value.name if isinstance(value, StressFamily) else str(value)


def run(one: StressFamily, k: int, side: str, seed: int | None = None) -> Trajectory:
    return ExactEngine().run(one.scene(one.place(k, side, seed)))


def history(told: Trajectory) -> list[tuple[tuple[str, str], ...]]:
    return [event.impulses for event in told.events]


@pytest.mark.parametrize("name", FAMILIES)
def test_a_family_bears_the_name_of_its_line_in_the_table(name: str) -> None:
    one = stress_family(name)
    assert one.name == name
    assert one.first < one.last <= one.most
    assert len(set(one.sides)) == len(one.sides) > 0
    assert all(side.isalnum() for side in one.sides)
    assert "k" in one.grows


@pytest.mark.parametrize(("one", "side"), LANES, ids=label)
def test_every_scene_has_limits_and_is_read_back_from_its_file(one: StressFamily, side: str, tmp_path: Path) -> None:
    ks = {one.first, (one.first + one.last) // 2, one.last, one.most}
    for k in sorted(ks):
        for seed in one.seeds:
            place = one.place(k, side, seed)
            scene = one.scene(place)
            assert scene.events is not None
            assert scene.source == place.show
            file = tmp_path / "scene.toml"
            file.write_text(dump_toml(scene), "utf-8")
            assert load_scene(str(file)).digest == scene.digest
            assert load_scene(str(file)) == scene


@pytest.mark.parametrize(("one", "side"), LANES, ids=label)
def test_every_k_is_another_scene_or_another_length(one: StressFamily, side: str) -> None:
    scenes = [one.scene(one.place(k, side)) for k in one.levels(short=True)]
    assert len({(scene.digest, scene.events) for scene in scenes}) == len(scenes)


def test_a_family_s_places_are_in_order_lane_by_lane() -> None:
    told = list(stress_family("scaled").places((0, 5)))
    assert told[:3] == [MapPlace("scaled", 0, "up", 1), MapPlace("scaled", 5, "up", 1), MapPlace("scaled", 0, "up", 2)]
    assert len(told) == 8


@pytest.mark.parametrize(
    ("k", "side", "seed", "message"),
    [
        (0, None, None, "near-ties has k from 1 to 300"),
        (301, None, None, "near-ties has k from 1 to 300"),
        (3, "lft", None, "did you mean 'left'?"),
        (3, None, 7, "near-ties draws nothing; leave --seed out"),
    ],
)
def test_a_place_that_is_not_there_is_refused(k: int, side: str | None, seed: int | None, message: str) -> None:
    with pytest.raises(SceneError) as error:
        stress_family("near-ties").place(k, side, seed)
    assert message in str(error.value)
    with pytest.raises(SceneError, match="has the seeds 1, 2, 3"):
        stress_family("long-runs").place(3, "gas", 9)
    with pytest.raises(SceneError, match="did you mean 'near-ties'"):
        stress_family("near-tie")


# -- what is known of them


@pytest.mark.parametrize(("one", "side"), [(one, s) for one, s in LANES if one.known is not None], ids=label)
def test_the_closed_form_holds_and_not_for_another_side_or_k(one: StressFamily, side: str) -> None:
    assert one.known is not None
    low, high = one.first, min(one.last, 4) if one.name == "pi" else one.last
    for k in (low, high):
        assert one.known(run(one, k, side), k, side, 0)
    others = [s for s in one.sides if s != side]
    if others:
        assert not one.known(run(one, high, others[0]), high, side, 0)
    else:
        assert not one.known(run(one, high, side), low, side, 0)


@pytest.mark.parametrize("side", ["up", "down"])
def test_units_of_length_change_no_history(side: str) -> None:
    one = stress_family("scaled")
    told = [run(one, k, side, 1) for k in (0, 7, 12, 20)]
    assert all(history(other) == history(told[0]) for other in told[1:])
    assert all([e.time.text() for e in t.events] == [e.time.text() for e in told[0].events] for t in told[1:])


@pytest.mark.parametrize("side", ["along", "aslant"])
def test_the_place_of_the_origin_changes_no_history(side: str) -> None:
    one = stress_family("moved")
    told = [run(one, k, side) for k in (0, 12, 40)]
    assert all(history(other) == history(told[0]) for other in told[1:])
    assert all(other.events[-1].time.digits(30) == told[0].events[-1].time.digits(30) for other in told[1:])


def test_the_brink_of_the_walls_is_at_parallel_ones() -> None:
    one, pair = stress_family("walls"), (("ball", "obstacle"),)
    for k in (4, 10, 17, 40):
        assert pair in history(run(one, k, "opening"))
        assert pair not in history(run(one, k, "closing"))


@pytest.mark.parametrize("side", ["left", "right"])
def test_the_pushed_one_is_first_whatever_the_ratio(side: str) -> None:
    one = stress_family("mass-ratios")
    pushed = ("left", "middle") if side == "left" else ("middle", "right")
    for k in (1, 8, 20, 40):
        assert history(run(one, k, side))[1] == (pushed,)


@pytest.mark.parametrize("side", ["left", "right"])
def test_an_orbit_is_left_after_about_k_bounces(side: str) -> None:
    one = stress_family("unstable")
    counts = [len(run(one, k, side).events) for k in (5, 10, 20, 40)]
    assert counts == sorted(counts)
    assert all(k < count < 1.2 * k + 2 for k, count in zip((5, 10, 20, 40), counts, strict=True))


@pytest.mark.parametrize("side", ["hit", "miss"])
@pytest.mark.parametrize("k", [1, 30, 60, 80])
def test_the_end_of_a_segment_is_hit_or_missed(k: int, side: str) -> None:
    """As the closed form says, and as the referee of segments does, which shares nothing with the engine."""
    one = stress_family("ends")
    told = run(one, k, side)
    assert one.known is not None
    assert one.known(told, k, side, 0)
    theirs = Referee(told.scene).run(mpf(99), 4)
    assert [event.approaching for event in theirs.events] == [set(event.contacts) for event in told.events]
    assert all(abs(a.time - mpf(b.time.digits(60))) < 1e-40 for a, b in zip(theirs.events, told.events, strict=True))


# -- witnesses

REFEREED = [
    ("near-ties", 33, 3), ("grazes", 36, 6), ("slow-fast", 38, 4), ("mass-ratios", 25, 4), ("pi", 3, 40),
    ("scaled", 12, 8), ("moved", 12, 8), ("walls", 30, 24), ("corners", 40, 6), ("unstable", 36, 30),
    ("gaps", 20, 10), ("long-runs", 5, 32), ("crowds", 3, 40),
]  # fmt: skip
"""A place of each family whose contacts never fall on one instant, and how many of its events are compared."""


@pytest.mark.parametrize(("name", "k", "events"), REFEREED)
def test_the_referee_tells_the_exact_engine_s_history(name: str, k: int, events: int) -> None:
    """The referee keeps no queue, has no exact numbers, and shares no decision with the engine."""
    one = stress_family(name)
    for side in one.sides:
        scene = one.scene(one.place(k, side))
        told = ExactEngine().run(scene, events=events)
        compare_to_referee(told, settled(scene, len(told.events)))


@pytest.mark.parametrize(("name", "k"), [("near-ties", 40), ("mass-ratios", 30), ("slow-fast", 20), ("ends", 60)])
def test_the_literal_engine_tells_the_exact_engine_s_history(name: str, k: int) -> None:
    one = stress_family(name)
    for side in one.sides:
        scene = one.scene(one.place(k, side))
        told, literal = (engine.run(scene, events=3) for engine in (ExactEngine(), SymbolicEngine()))
        assert history(told) == history(literal)
        assert [float(e.time) for e in told.events] == pytest.approx([float(e.time) for e in literal.events], 1e-15)


def test_a_family_of_one_s_own_is_a_family() -> None:
    """What the recipe shows, without the table."""

    def make(k: int, side: str, seed: int) -> Scene:
        return Scene([Circle(k, 0)], events=1)

    one = StressFamily(name="own", summary="A ball waits.", grows="k is nothing", make=make, last=2, most=3)
    assert one.scene(MapPlace("own", 2, "only")).name == "own-only-2"
    assert one.levels() == one.levels(short=True) == (1, 2)
