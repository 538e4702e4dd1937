"""The smallest scene that still diverges: it does, it is 1-minimal, and limits end the search in good order."""

from __future__ import annotations

import itertools
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from truebreak.compare import compare
from truebreak.compare import minimise as smallest
from truebreak.compare.causes.diagnosis import CauseName
from truebreak.compare.cli import main
from truebreak.compare.deadline import Clock
from truebreak.compare.reduction import minimal_scene as module
from truebreak.compare.reduction.minimal_scene import Reducing
from truebreak.compare.reduction.smallest import End, SceneSize, Smallest, corners, ddmin, digits
from truebreak.compare.report.search_text import size_phrase
from truebreak.scenarios import Arc, Circle, Pocket, Polygon, Quantity, Scene, SceneError, Segment, Wall, catalogue
from truebreak.scenarios.files import dump_toml, load_scene, loads_toml

TIE = 10**40
"""One part in this many is how far from a tie the scenes of these tests are."""


def near_tie(*more: Circle, **keys: Any) -> Scene:
    """Three balls in a line that meet all but at once, which no double tells, with what else there is."""
    trio = [
        Circle(-3, 0, vx=1, id="left"),
        Circle(0, 0, id="middle"),
        Circle(f"4 + 1/{TIE}", 0, r=2, vx=-1, m=4, id="right"),
    ]
    return Scene([*more, *trio], **keys)


def verdict(scene: Scene, engine: str) -> str:
    """By a call of its own."""
    return compare(scene, [engine], causes=False).verdict


def without_one(scene: Scene) -> list[Scene]:
    """The scene without each circle, each wall and its last event."""
    found = []
    for kind in ("circles", "walls"):
        things = getattr(scene, kind)
        for k in range(len(things)):
            rest = [*things[:k], *things[k + 1 :]]
            if rest or kind == "walls":
                found.append(scene.with_changes(**{kind: rest}))
    if scene.events is not None and scene.events > 1:
        found.append(scene.with_changes(events=scene.events - 1))
    return found


# -- ddmin


@pytest.mark.parametrize("size", range(1, 8))
def test_ddmin_finds_exactly_what_is_needed_where_each_item_counts_by_itself(size: int) -> None:
    for count in range(size + 1):
        for needed in itertools.combinations(range(size), count):
            assert ddmin(range(size), lambda kept, n=needed: {*n} <= {*kept}) == list(needed)


def test_ddmin_leaves_a_1_minimal_list_where_items_depend_on_each_other() -> None:
    """Held whatever holds: an odd number of items above 6, or any five in a row."""

    def still(kept: Any) -> bool:
        items = [*kept]
        return len(items) % 2 == 1 and (len(items) > 6 or any({*range(k, k + 5)} <= {*items} for k in range(16)))

    for parts in (2, 21):
        found = ddmin(range(21), still, parts)
        assert still(found)
        assert not any(still(found[:k] + found[k + 1 :]) for k in range(len(found)))


def test_ddmin_asks_no_more_than_its_authors_say() -> None:
    asked = 0

    def still(kept: Any) -> bool:
        nonlocal asked
        asked += 1
        return len([*kept]) == 12

    ddmin(range(12), still)
    assert asked <= 12**2 + 3 * 12


# -- scenes


@pytest.fixture(scope="module")
def of_gas() -> dict[str, Smallest]:
    gas = catalogue.build("gas:n=6")
    return {engine: smallest(gas, engine) for engine in ("double", "pymunk")}


@pytest.mark.parametrize("engine", ["double", "pymunk"])
def test_of_six_discs_two_at_most_are_left_and_they_diverge(of_gas: dict[str, Smallest], engine: str) -> None:
    found = of_gas[engine]
    assert found.end is End.MINIMAL
    assert len(found.scene.circles) <= 2
    assert found.scene.events is not None
    assert found.scene.events < 400
    again = loads_toml(dump_toml(found.scene), "small.toml")
    assert verdict(again, engine) == "diverged"


@pytest.mark.parametrize("engine", ["double", "pymunk"])
def test_without_any_one_thing_it_agrees_or_is_not_known_to_diverge(of_gas: dict[str, Smallest], engine: str) -> None:
    smaller = without_one(of_gas[engine].scene)
    assert len(smaller) >= 3
    assert "diverged" not in {verdict(scene, engine) for scene in smaller}


@pytest.mark.parametrize("engine", ["double", "pymunk"])
def test_each_step_has_a_certified_verdict_and_fewer_parts(of_gas: dict[str, Smallest], engine: str) -> None:
    found = of_gas[engine]
    assert all(step.comparison.certain and step.comparison.verdict == "diverged" for step in found.steps)
    counts = [len(step.comparison.scene.circles) for step in found.steps]
    assert counts == sorted(counts, reverse=True)
    assert {step.kind for step in found.steps} >= {"circles", "events", "digits"}
    assert [step.runs for step in found.steps] == sorted(step.runs for step in found.steps)
    assert found.steps[-1].runs <= found.runs


@pytest.mark.parametrize("engine", ["double", "pymunk"])
def test_each_step_tells_what_it_left_out_and_no_more(of_gas: dict[str, Smallest], engine: str) -> None:
    found = of_gas[engine]
    ids = [*found.original.ids]
    for step in found.steps:
        if step.kind in ("circles", "walls"):
            assert {*step.removed} <= {*ids}
            ids = [name for name in ids if name not in step.removed]
        assert [*step.comparison.scene.ids] == ids
    assert [*found.scene.ids] == ids


def test_what_has_no_part_in_a_near_tie_is_left_out() -> None:
    scene = near_tie(
        Circle("123/7", 50, vx="sqrt(2)", id="stranger"),
        walls=[Wall(0, 90, 1, 90, id="far")],
        pockets=[Pocket(40, 40, "3/7", id="hole")],
        capture=True,
        reverse_at=40,
        until=70,
        name="crowd",
    )
    found = smallest(scene, "double")
    assert found.minimal
    assert found.scene.ids == ("left", "middle", "right")
    assert not found.scene.pockets
    assert (found.scene.capture, found.scene.reverse_at, found.scene.until) == (False, None, None)
    assert found.scene.events == 1
    assert found.scene.circles[2].x == scene.circles[3].x, "its digits are what the near-tie is made of"
    assert "diverged" not in {verdict(s, "double") for s in without_one(found.scene)}
    assert found.candidate.diagnosis is not None
    assert found.candidate.diagnosis.name is CauseName.INPUT
    assert found.original == scene


def test_digits_that_matter_stay_and_others_go() -> None:
    scene = Scene(
        [Circle(0, 0, vx="1001/1000"), Circle(5, f"2 - 1/{TIE}", id="grazed", m="355/113")], name="graze", until=20
    )
    found = smallest(scene, "double")
    assert found.minimal
    first, second = found.scene.circles
    assert (first.vx, second.m) == (1, 3)
    assert second.y == scene.circles[1].y


def two_causes() -> Scene:
    """A bullet that a stepped engine lets pass through a disc, and, before, a near-tie that it takes for a tie."""
    bullet = Circle(-5001, 500, r="1/10", vx=1000, id="bullet")
    return near_tie(bullet, Circle(0, 500, r="1/10", id="target"), name="two causes", until=20)


def test_the_cause_may_be_held() -> None:
    first = compare(two_causes(), ["pymunk"])["pymunk"].diagnosis
    kept = smallest(two_causes(), "pymunk", same_cause=True)
    free = smallest(two_causes(), "pymunk")
    assert first is not None
    assert kept.candidate.diagnosis is not None
    assert free.candidate.diagnosis is not None
    assert free.candidate.diagnosis.name is CauseName.TUNNELLING
    assert free.scene.ids == ("bullet", "target")
    assert kept.candidate.diagnosis.name is first.name is not CauseName.TUNNELLING
    assert kept.scene.ids == ("left", "middle", "right")


# -- ends


def test_where_nothing_diverges_there_is_nothing_to_minimise() -> None:
    with pytest.raises(SceneError, match="'double' is not known to diverge on cradle:n=3: the verdict is agree"):
        smallest(catalogue.build("cradle:n=3"), "double")


def test_an_engine_that_stops_undecided_does_not_diverge() -> None:
    with pytest.raises(SceneError, match="the verdict is undecided"):
        smallest(near_tie(), "interval")


def test_runs_are_counted_and_the_best_so_far_is_given() -> None:
    gas = catalogue.build("gas:n=6")
    found = smallest(gas, "double", runs=3)
    assert (found.runs, found.end, found.minimal) == (3, End.RUNS, False)
    assert len(found.scene.circles) < 6
    assert verdict(found.scene, "double") == "diverged"
    whole = smallest(gas, "double", runs=1)
    assert (whole.runs, whole.end, whole.steps) == (1, End.RUNS, ())
    assert whole.scene.circles == gas.circles


def test_the_end_of_the_seconds_leaves_the_best_so_far(monkeypatch: pytest.MonkeyPatch) -> None:
    """A clock that says so stands for the seconds."""
    seen: list[Reducing] = []

    class Told(Clock):
        @property
        def over(self) -> bool:
            return len(seen) >= 4

        def left(self, share: float = 1.0) -> float | None:
            return 1000.0

    monkeypatch.setattr(module, "Clock", Told)
    found = smallest(catalogue.build("gas:n=6"), "double", max_seconds=1000, progress=seen.append)
    assert (found.runs, found.end) == (4, End.SECONDS)
    assert len(found.scene.circles) < 6
    assert verdict(found.scene, "double") == "diverged"


def interrupting(after: int) -> Any:
    """Presses Ctrl-C once so many comparisons are made."""

    def progress(state: Reducing) -> None:
        if state.runs == after:
            raise KeyboardInterrupt

    return progress


def test_an_interruption_leaves_the_best_so_far() -> None:
    found = smallest(catalogue.build("gas:n=6"), "double", progress=interrupting(4))
    assert found.end is End.INTERRUPTED
    assert len(found.scene.circles) < 6
    assert verdict(found.scene, "double") == "diverged"
    with pytest.raises(KeyboardInterrupt):
        smallest(catalogue.build("gas:n=6"), "double", progress=interrupting(0))


@pytest.mark.parametrize(("limits", "told"), [({"runs": 0}, "runs = 0"), ({"max_seconds": -1}, "max_seconds = -1")])
def test_a_limit_that_is_none_is_refused(limits: dict[str, Any], told: str) -> None:
    with pytest.raises(SceneError, match=told):
        smallest(near_tie(), "double", **limits)


# -- the command


def called(*words: str) -> int:
    with pytest.raises(SystemExit) as stop:
        main(["minimise", *words])
    assert isinstance(stop.value.code, int)
    return stop.value.code


def test_the_command_writes_a_scene_that_compare_calls_diverged(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "small.toml"
    assert called("gas:n=6", "--engine", "double", "-o", str(path)) == 0
    said = capsys.readouterr().out
    assert "1-minimal" in said
    assert "circles c" in said
    assert "double first differs at event" in said
    assert len(load_scene(path).circles) <= 2
    with pytest.raises(SystemExit) as stop:
        main(["compare", str(path), "--engines", "double"])
    assert stop.value.code == 1


def test_without_a_file_the_scene_ends_the_output(capsys: pytest.CaptureFixture[str]) -> None:
    assert called("near-tie:k=40", "--engine", "double") == 0
    said = capsys.readouterr().out
    scene = loads_toml(said[said.index('name = "') :], "stdout")
    assert verdict(scene, "double") == "diverged"


def test_no_divergence_is_one_line_and_code_2(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "none.toml"
    assert called("cradle:n=3", "--engine", "double", "-o", str(path)) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert "nothing to minimise" in captured.err
    assert not path.exists()


def test_a_limit_that_came_first_is_code_4_and_the_scene_is_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "some.toml"
    assert called("gas:n=6", "--engine", "double", "--runs", "2", "--out", str(path)) == 4
    assert "the limit on comparisons was reached" in capsys.readouterr().out
    assert verdict(load_scene(path), "double") == "diverged"


def test_ctrl_c_is_code_130_and_the_scene_so_far_is_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    calls = itertools.count()

    def interrupted(*given: Any, **options: Any) -> Any:
        if next(calls) == 4:
            raise KeyboardInterrupt
        return compare(*given, **options)

    monkeypatch.setattr(module, "compare", interrupted)
    path = tmp_path / "some.toml"
    assert called("gas:n=6", "--engine", "double", "-o", str(path)) == 130
    assert "interrupted" in capsys.readouterr().out
    assert len(load_scene(path).circles) < 6
    assert verdict(load_scene(path), "double") == "diverged"


def test_segments_are_left_out_and_corners_straightened() -> None:
    """Of a chain beside the way, and of one whose end is missed by less than doubles tell, one piece remains."""
    small = Quantity.of(Fraction(1, 2**60))
    chain = [Segment(k, -k % 2, k + 1, -(k + 1) % 2, id=f"chain{k}") for k in range(-8, -4)]
    bars = [Segment(0, 0, -1, "-1/3", id="tip"), Segment(-1, "-1/3", -2, 0, id="tail"), *chain]
    scene = Scene([Circle(1 - small, 5, vy=-1, id="disc")], segments=bars, until=20)
    found = smallest(scene, "double")
    assert found.minimal
    assert len(found.scene.segments) == 1
    assert found.scene.segments[0].id == "tip"
    assert "segments" in {step.kind for step in found.steps}


def test_a_corner_is_straightened_once_and_named_by_the_first() -> None:
    bars = [Segment(0, 0, 1, 1, id="a"), Segment(2, 0, 1, 1, id="b"), Segment(2, 0, 3, 1, id="c")]
    parts = corners(Scene([Circle(0, 9)], segments=bars))
    assert parts.items == ("a/b", "b/c")
    (left,) = parts.keeping([]).segments
    assert (left.id, left.x0, left.y0, left.x1, left.y1) == ("a", 0, 0, 3, 1)
    assert [s.id for s in parts.keeping(["b/c"]).segments] == ["a", "c"]


def test_polygons_are_left_out_and_their_corners_straightened() -> None:
    """What decides is one corner of one of them; the others go, and their numbers get short."""
    small = Quantity.of(Fraction(1, 2**60))
    tip = Polygon([("-1/3", "3/7"), (0, 0), ("-1/3", "-13/7"), (-3, -2), (-3, "1/2")], id="tip")
    beside = Polygon([(6, 0), (8, 0), (8, 2)], id="beside")
    scene = Scene([Circle(1 - small, 5, vy=-1, id="disc")], polygons=[tip, beside], until=20)
    found = smallest(scene, "double")
    assert found.minimal
    (left,) = found.scene.polygons
    assert (left.id, len(left.points)) == ("tip", 3)
    assert {"polygons", "corners", "digits"} <= {step.kind for step in found.steps}
    assert "1 polygon" in size_phrase(SceneSize.of(found.scene))


def test_numbers_of_polygons_have_names() -> None:
    scene = Scene([Circle(0, 9)], polygons=[Polygon([("22/7", 0), (0, "22/7"), (0, 0)], "g", "1/3")])
    parts = digits(scene, 1)
    assert [name for name in parts.items if name.startswith("g.")] == ["g.r", "g.x1", "g.y2"]
    changed = parts.keeping([name for name in parts.items if name != "g.y2"]).polygons[0]
    assert [[value.text() for value in place] for place in changed.points] == [["22/7", "0"], ["0", "3"], ["0", "0"]]


def test_arcs_are_left_out_and_their_digits_shortened() -> None:
    small = Quantity.of(Fraction(1, 2**60))
    bow = Arc(0, 0, 2, "-22/7", "-355/113", 0, 5, id="bow")
    rings = [Arc(40, 0, 1, id="far", full=True), Arc("70/9", "40/7", "1/3", id="off", full=True)]
    scene = Scene([Circle(3 - small, -5, vy=1, id="disc"), Circle(9, 30, id="other")], arcs=[bow, *rings], until=20)
    found = smallest(scene, "double")
    assert [arc.id for arc in found.scene.arcs] == ["bow"]
    assert {"arcs", "digits"} <= {step.kind for step in found.steps}
    assert "1 arc," in size_phrase(SceneSize.of(found.scene))


def test_numbers_of_arcs_have_names() -> None:
    scene = Scene(
        [Circle(0, 9)], arcs=[Arc("22/7", 0, 2, 1, 0, 0, "22/7", id="bow"), Arc(0, 0, "50/7", id="o", full=True)]
    )
    parts = digits(scene, 1)
    assert {"bow.x", "bow.y1", "o.r"} <= {*parts.items}
    assert not any(name.startswith("o.x0") for name in parts.items)
    bow, ring = parts.keeping([name for name in parts.items if name != "bow.y1"]).arcs
    assert (bow.y1.text(), bow.x.text(), ring.r.text(), ring.full) == ("3", "22/7", "50/7", True)
