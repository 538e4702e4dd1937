"""Certificates of runs among polygons: both checkers prove them, of the sides as segments, and refuse forgeries."""

from __future__ import annotations

from copy import deepcopy
from fractions import Fraction
from functools import cache
from pathlib import Path

import pytest
from polygon_scenes import scene_of

from certificate.checkers import both_verify, by_node, by_python, needs_node
from certificate.test_segment_tampering import BAR_WAYS
from certificate.test_tampering import WAYS, Told, altered, refused
from truebreak.compare.certificate import certificate_json, certificate_of
from truebreak.compare.certificate.certified import difference
from truebreak.compare.certificate.outlines import bars_of, numbers_of
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Polygon, Scene, Segment, Wall

HOOK = [(0, 0), (6, 0), (6, 6), (0, 6), (0, 4), (4, 4), (4, 2), (0, 2)]
NOOK = Polygon([(-9, -9), (9, -9), (9, 0), (0, 0), (0, 9), (-9, 9)], id="nook", r="1/4")
BOX = [Wall(-9, 0, -9, 1, id="l"), Wall(9, 0, 9, 1, id="r"), Wall(0, 9, 1, 9, id="t"), Wall(0, -9, 1, -9, id="b")]
SEEDS, EVENTS = range(60), 6


def by_hand() -> dict[str, Scene]:
    """A notch, both faces of a concave corner at once, slides over a joint, corners, points, and there and back."""
    row = [Polygon([(k, 0), (k + 2, 0), (k + 2, -1), (k, -1)], id=f"g{k}") for k in (-6, -4, -2, 0)]
    point = Circle(-3, 5, r=0, point=True, vx="1/2", vy=-1, id="p")
    slider = Circle(-5, 1, vx=1, id="slider")
    return {
        "into a notch": Scene(
            [Circle(-4, 3, r="1/2", vx=1, vy="1/9", id="c")], BOX[:1], polygons=[Polygon(HOOK, "hook")], events=9
        ),
        "a concave corner": Scene([Circle(5, 5, vx=-1, vy=-1, id="c")], polygons=[NOOK]),
        "a concave corner, one by one": Scene(
            [Circle(5, 5, vx=-1, vy=-1, id="c")], polygons=[NOOK], tie_policy="sequential:seed=3"
        ),
        "a slide over joints": Scene([slider, Circle(-5, 6, vx=1, vy=-1)], polygons=row),
        "a corner": Scene([Circle("27/4", 8, vy=-1, id="c")], BOX, polygons=[Polygon(HOOK, "hook")], events=5),
        "a point": Scene([point], BOX, polygons=[row[2]], events=6),
        "there and back": Scene(
            [Circle(-4, 3, r="1/2", vx=1, vy="1/9", id="c")],
            BOX,
            polygons=[Polygon(HOOK, "hook", "1/4")],
            reverse_after=5,
        ),
        "with a segment": Scene(
            [Circle(0, 7, vx="1/9", vy=-1)], BOX, segments=[Segment(-3, 4, 3, 4, r="1/8")], polygons=row, events=6
        ),
    }


def sample(scene: Scene) -> Told:
    """The certificate of a run of it."""
    limits = {} if scene.reverse_after or scene.events else {"until": 30, "events": EVENTS}
    told = certificate_of(ExactEngine().run(scene, **limits))
    assert difference(told["scene"], scene) is None
    return told


@cache
def polygon_samples() -> dict[str, Told]:
    """Certificates of these, and of random scenes."""
    scenes = {**by_hand(), **{f"seed {seed}": scene for seed in SEEDS if (scene := scene_of(seed)) is not None}}
    return {name: sample(scene) for name, scene in scenes.items()}


def test_both_verify_runs_among_polygons(tmp_path: Path) -> None:
    assert sum(len(told["instants"]) for told in polygon_samples().values()) > 150
    both_verify(polygon_samples().items(), tmp_path)


def test_concave_corners_and_notches_are_among_them() -> None:
    pushes = [len(one) for one in polygon_samples()["a concave corner"]["instants"][1]["rounds"]]
    assert pushes == [2]
    assert sum("met" in instant for instant in polygon_samples()["into a notch"]["instants"]) > 3


def test_numbers_are_those_of_the_sides() -> None:
    scene = by_hand()["with a segment"]
    numbers, bars = numbers_of(scene), bars_of(scene)
    seen, count = scene.surfaces, len(scene.circles) + len({p for b in bars for p in ((b.x0, b.y0), (b.x1, b.y1))})
    for k in seen.faces:
        number = numbers[len(seen.circles) + k] - count - len(scene.walls)
        bar, face = bars[number // 2], seen.walls[k]
        turned = (bar.x1, bar.y1, bar.x0, bar.y0) if number % 2 else (bar.x0, bar.y0, bar.x1, bar.y1)
        assert (face.x1 - face.x0, face.y1 - face.y0) == (turned[2] - turned[0], turned[3] - turned[1])
    plain = scene.with_changes(polygons=[])
    assert all(k == number for k, number in numbers_of(plain).items())


@needs_node
@pytest.mark.parametrize("count", [90, pytest.param(900, marks=pytest.mark.slow)])
def test_altered_runs_among_polygons_are_refused_or_shown_to_be_true(count: int, tmp_path: Path) -> None:
    single = {  # two with a common side would be no scene of segments
        name: told
        for name, told in polygon_samples().items()
        if len({bar["id"].split("/")[0] for bar in told["scene"]["segments"]}) == 1
    }
    tried = altered(count, (*BAR_WAYS, *WAYS), "polygons", single)
    assert refused(tried, tmp_path) > count // 2


@cache
def forged() -> dict[str, Told]:
    """Of true certificates what an engine with a fault would have said."""
    found: dict[str, Told] = {}
    scenes = by_hand()
    scene = scenes["a corner"]
    told = certificate_of(ExactEngine().run(scene))
    past = deepcopy(told)
    past["instants"] = past["instants"][:1]
    past["end"] = {"reason": "horizon", "until": "9"}
    past["final"] = {"time": "9", "circles": [["6.75", "-1", "0", "-1"]]}
    found["it passes a corner"] = past
    through = certificate_of(ExactEngine().run(Scene([Circle(3, 9, vy=-1)], polygons=[Polygon(HOOK, "hook")]), until=9))
    through["instants"] = through["instants"][:1]
    through["final"] = {"time": "9", "circles": [["3", "0", "0", "-1"]]}
    found["it goes through a side"] = through
    nook = sample(scenes["a concave corner"])
    for instant in nook["instants"]:
        if "rounds" in instant:
            instant["rounds"] = [[push] for one in instant["rounds"] for push in one]
    found["two faces push one by one, by the other policy"] = nook
    one = sample(scenes["a concave corner"])
    one["instants"][1]["rounds"] = [one["instants"][1]["rounds"][0][:1]]
    found["one face of a concave corner pushes alone"] = one
    inner = sample(scenes["into a notch"])
    for instant in inner["instants"]:
        if "met" in instant:
            instant["exact"] = str(Fraction(instant["time"]))  # else the forged face would be what tells it
        rows = [*instant.get("met", ()), *(push for one in instant.get("rounds", ()) for push in one)]
        first = 1 + 8 + len(inner["scene"]["walls"])  # the disc, the corners, the wall
        for row in rows:
            if row[1] >= first:
                row[1] = first + ((row[1] - first) ^ 1)
    found["the inner sides push"] = inner
    return found


@needs_node
@pytest.mark.parametrize("name", [*forged()])
def test_what_an_engine_with_a_fault_says_is_refuted_by_both(name: str, tmp_path: Path) -> None:
    path = tmp_path / "forged.json"
    path.write_text(certificate_json(forged()[name]), encoding="utf-8")
    assert by_python(path)[0] == 1, by_python(path)
    assert by_node([path])[0][0] == 1


def test_a_certificate_is_compared_with_the_polygons_that_are_meant() -> None:
    wedge = Polygon([(0, 0), (3, 0), (0, 4)], "wedge")
    scene = Scene([Circle(0, 9, vy=-1, id="c")], polygons=[wedge])
    block = certificate_of(ExactEngine().run(scene, until=5))["scene"]
    assert difference(block, scene) is None
    assert difference(block, scene.with_changes(polygons=[Polygon([(0, 4), (3, 0), (0, 0)], "wedge")])) is not None
    turned = [Polygon([(3, 0), (0, 0), (0, 4)], "wedge")]  # begins elsewhere: another list of sides, and another scene
    assert "'wedge/1': x0" in str(difference(block, scene.with_changes(polygons=turned)))
    thick = scene.with_changes(polygons=[Polygon(wedge.points, "wedge", "1/9")])
    assert difference(block, thick) == "segment 'wedge/1': r is 0, not 1/9"
    assert "is not 'other/1'" in str(difference(block, scene.with_changes(polygons=[Polygon(wedge.points, "other")])))
    for k in range(3):
        lost = deepcopy(block)
        del lost["segments"][k]
        assert difference(lost, scene) == "it has 2 segments, not 3"
    sides = [Segment(b.x0, b.y0, b.x1, b.y1, id=b.id) for b in bars_of(scene)]
    assert difference(block, scene.with_changes(polygons=[], segments=sides[:2])) == "it has 3 segments, not 2"


def test_sides_have_names_of_their_own() -> None:
    wedge = Polygon([(0, 0), (3, 0), (0, 4)], "c")
    bars = bars_of(Scene([Circle(0, 9, id="c/1")], polygons=[wedge], segments=[Segment(5, 5, 6, 6, id="c/1/")]))
    assert [bar.id for bar in bars] == ["c/1/", "c/1//", "c/2", "c/3"]
