"""Polygons: against a referee in plain coordinates, faults that must be found, the laws and the words of refusals."""

from __future__ import annotations

from random import Random

import pytest
from polygon_scenes import scene_of
from test_segments import UNTIL, differs

from truebreak.compare import compare
from truebreak.compare.orders.all_orders import all_orders
from truebreak.compare.orders.guided import Guided
from truebreak.exact import ExactEngine
from truebreak.exact.literal.symbolic_engine import SymbolicEngine
from truebreak.exact.replay.contact import AtWall, Pair, part_at
from truebreak.exact.simulation import cells
from truebreak.exact.simulation.prediction import Predictor
from truebreak.floating import DoubleEngine, IntervalEngine, PymunkEngine, QuadEngine, SingleEngine
from truebreak.scenarios import Circle, Polygon, Quantity, Scene, SceneError, Segment, Wall, catalogue, surfaces
from truebreak.scenarios.files import dump_json, dump_toml, loads_json, loads_toml

SEEDS = range(150)
NOOK = [(-9, -9), (9, -9), (9, 0), (1, 1), (0, 9), (-9, 9)]
DART = [(-3, 4), (-3, 0), (3, 0), (3, 4), (0, 1)]


def test_scenes_agree_with_the_referee():
    scenes = [(seed, scene) for seed in SEEDS if (scene := scene_of(seed)) is not None]
    assert len(scenes) > 100
    assert {seed: told for seed, scene in scenes if (told := differs(scene))} == {}


def _inside_out(monkeypatch):
    known = Polygon.corners
    monkeypatch.setattr(Polygon, "corners", lambda self: known(self)[::-1])


def _no_corners(monkeypatch):
    known = surfaces.ends_of
    monkeypatch.setattr(surfaces, "ends_of", lambda segments, polygons, points, arcs: known(segments, (), points))


def _concave_corners_alone(monkeypatch):
    known = surfaces.ends_of

    def others(segments, polygons, points, arcs):
        convex = {(end.x, end.y) for end in known(segments, polygons, False)}
        return tuple(end for end in known(segments, polygons, True) if (end.x, end.y) not in convex)

    monkeypatch.setattr(surfaces, "ends_of", others)


def _sharp(monkeypatch):
    known = surfaces.sides_of
    monkeypatch.setattr(surfaces, "sides_of", lambda polygon: known(Polygon(polygon.points, polygon.id)))


def _a_side_is_forgotten(monkeypatch):
    known = Polygon.sides
    monkeypatch.setattr(Polygon, "sides", lambda self: known(self)[:-1])


def _sides_in_pairs(monkeypatch):
    def wrong(self, link):
        return AtWall(link.circle, self.faces.start + ((link.wall - self.faces.start) ^ 1))

    monkeypatch.setattr(Predictor, "_other_side", wrong)
    monkeypatch.setattr(Scene, "two_sided", property(lambda scene: scene.faces))


FAULTS = {
    "faces that look inward": _inside_out,
    "no corners": _no_corners,
    "the concave corners in place of the convex": _concave_corners_alone,
    "no thickness": _sharp,
    "a side that is forgotten": _a_side_is_forgotten,
    "two sides of a polygon taken for those of one segment": _sides_in_pairs,
}

POINTS = [
    Scene([Circle(1, 3, r=0, vx=1, vy=-1, point=True)], [Wall(-9, 9, 9, 9)], polygons=[Polygon(DART, id="g")]),
    Scene([Circle(0, 6, r="1/4", vx="1/5", vy=-1)], [Wall(-9, 9, 9, 9)], polygons=[Polygon(DART, id="g")]),
]


def strays(scene: Scene) -> str:
    """Whether doubles have other partners than the exact engine in a few events; empty where not."""
    runs = [engine.run(scene, until=UNTIL, events=4) for engine in (ExactEngine(), DoubleEngine())]
    first, second = ([event.contacts for event in run.events] for run in runs)
    return "" if first == second else "doubles"


@pytest.mark.parametrize("fault", FAULTS)
def test_planted_faults_are_found(fault, monkeypatch):
    assert not any(map(strays, POINTS))
    FAULTS[fault](monkeypatch)
    again = [lambda scene=scene: scene.with_changes(polygons=scene.polygons) for scene in POINTS]
    for make in (*again, *(lambda seed=seed: scene_of(seed) for seed in SEEDS)):
        try:
            scene = make()
            told = "" if scene is None else differs(scene) or (make in again and strays(scene))
        except (AssertionError, KeyError, IndexError, ValueError):
            told = "it fell"
        if told:
            return
    raise AssertionError(f"nothing finds {fault}")


# -- Laws.


@pytest.mark.parametrize("seed", range(0, 100, 5))
def test_it_does_not_matter_how_the_points_are_listed(seed):
    scene = scene_of(seed)
    if scene is None:
        return
    turned = [Polygon([*p.points[2:], *p.points[:2]][::-1], p.id, p.r) for p in scene.polygons]
    runs = [ExactEngine().run(each, until=UNTIL, events=5) for each in (scene, scene.with_changes(polygons=turned))]
    times = [[(event.time.digits(30), set(event.contacts)) for event in run.events] for run in runs]
    assert times[0] == times[1]


@pytest.mark.parametrize("seed", range(40))
def test_intervals_never_say_what_is_not_so(seed):
    scene = scene_of(seed)
    if scene is not None:
        exact, wide = (engine.run(scene, until=UNTIL, events=6) for engine in (ExactEngine(), IntervalEngine()))
        told = [event.contacts for event in wide.events]
        assert told == [event.contacts for event in exact.events][: len(told)]


@pytest.mark.parametrize(("name", "least"), [("wind-tree", 40), ("barrier", 40), ("mushroom", 15)])
def test_intervals_pass_what_is_no_meeting_on_either_side_of_the_zero(name, least):
    """A point on the line of a face beyond its end, or on the end of a face whose line it is through."""
    scene = catalogue.build(name)
    exact, wide = (engine.run(scene, events=100) for engine in (ExactEngine(), IntervalEngine()))
    assert least <= len(wide.events) < 100
    for true, told in zip(exact.events, wide.events, strict=False):
        assert told.contacts == true.contacts
        assert told.time.low <= float(true.time) <= told.time.high


def test_sympy_agrees_by_its_own_way():
    house = Polygon([(-2, 0), (2, 0), (2, 2), (0, 2), (-2, 2)], id="house", r="1/2")
    dart = Polygon(DART, id="dart")
    for scene in (
        Scene([Circle("1/3", 7, vy=-1)], [Wall(-9, 9, 9, 9, id="top")], polygons=[house]),
        Scene([Circle(0, 7, r="1/2", vy=-1)], [Wall(-9, 9, 9, 9, id="top")], polygons=[dart]),
        Scene([Circle("1/3", 7, r=0, vy=-1, point=True)], [Wall(-9, 9, 9, 9, id="top")], polygons=[dart]),
    ):
        runs = [engine.run(scene, until=99, events=3) for engine in (ExactEngine(), SymbolicEngine())]
        first, second = ([(e.contacts, float(e.time)) for e in run.events] for run in runs)
        assert len(first) == 3
        assert [names for names, _ in first] == [names for names, _ in second]
        assert [time for _, time in first] == pytest.approx([time for _, time in second])


def test_every_engine_sees_one_thing():
    box = [
        Wall(-9, -9, 9, -9, id="b"),
        Wall(9, -9, 9, 9, id="r"),
        Wall(9, 9, -9, 9, id="t"),
        Wall(-9, 9, -9, -9, id="l"),
    ]
    house = Polygon([(-3, 0), (3, 0), (3, 3), (0, 5), (-3, 3)], id="house", r="1/3")
    dart = Polygon([(-3, 0), (3, 0), (3, 3), (0, 1), (-3, 3)], id="dart", r="1/3")
    for solid in (house, dart):
        scene = Scene([Circle(0, 7, r="1/2", vx="1/7", vy=-1, id="c")], box, polygons=[solid], until=60)
        found = compare(scene, [DoubleEngine(), SingleEngine(), QuadEngine(), PymunkEngine()])
        assert len(found.reference.events) > 4
        assert solid.id in {pair.second for event in found.reference.events for pair in event.contacts}
        assert [candidate.verdict for candidate in found.candidates] == ["agree"] * 4


def test_a_disc_in_a_concave_corner_is_one_contact_to_whom_cannot_tell():
    scene = Scene([Circle(0, 6, vy=-1, id="c")], [Wall(-9, 9, 9, 9)], polygons=[Polygon(DART, id="dart")], until=20)
    (event, *_) = ExactEngine().run(scene).events
    assert event.contacts == (("c", "dart"), ("c", "dart"))  # a face on either side
    assert all(tie.proof.proved for tie in event.ties)
    found = compare(scene, ["double", "pymunk"])
    assert [candidate.verdict for candidate in found.candidates] == ["agree", "agree"]


@pytest.mark.parametrize("solid", ["segments", "polygon"])
def test_all_orders_of_a_corner_are_named_and_followed(solid):
    left, right = [(-3, 2), (0, 0)], [(0, 0), (4, 1)]
    things = {
        "segments": {"segments": [Segment(*left[0], 0, 0, id="l"), Segment(0, 0, *right[1], id="r")]},
        "polygon": {"polygons": [Polygon([*left, right[1], (4, -1), (-3, -1)], id="valley")]},
    }[solid]
    scene = Scene([Circle("1/5", 9, id="post", m="oo"), Circle(*_in_a_valley(), vy=-1, vx="1/9", id="c")], **things)
    tree = all_orders(ExactEngine(), scene, until=20, events=1)
    assert tree.complete
    named = [outcome.decisions[0].chosen.second for outcome in tree.outcomes]
    assert named == (["l", "r"] if solid == "segments" else ["valley", "valley"])
    for outcome in tree.outcomes:
        event = outcome.trajectory.events[0]
        if solid == "segments":
            again = ExactEngine().run_with(scene, Guided(scene, outcome.trajectory), until=20, events=1)
            assert again.events[0].impulses == event.impulses
    assert len({outcome.trajectory.final["c"].vx.text() for outcome in tree.outcomes}) == 2


def _in_a_valley():
    """The middle of a disc of radius 1 that touches both sides of the valley, moved back along (1/9, -1) for 2."""
    ax, ay, bx, by = Quantity.of(2), Quantity.of(3), Quantity.of(-1), Quantity.of(4)
    la, lb = (ax * ax + ay * ay).sqrt(), (bx * bx + by * by).sqrt()
    a, b = (ax / la, ay / la), (bx / lb, by / lb)  # normals of both sides: n.p = 1 at either
    det = a[0] * b[1] - a[1] * b[0]
    x, y = (b[1] - a[1]) / det, (a[0] - b[0]) / det
    return x - Quantity.of("2/9"), y + 2


def test_a_point_that_flies_into_a_corner_stops_by_name():
    for y in (1, 4):  # a concave and a convex one
        x = 0 if y == 1 else 3
        scene = Scene([Circle(x, 9, r=0, vy=-1, point=True, id="p")], polygons=[Polygon(DART, id="dart")])
        assert "no normal: p and dart" in ExactEngine().run(scene, until=99).stop.message


def test_the_way_back_is_the_way_out():
    walls = [Wall(-8, 0, -8, 1, id="l"), Wall(8, 0, 8, 1, id="r"), Wall(0, 9, 1, 9, id="t"), Wall(0, -9, 1, -9, id="b")]
    scene = Scene([Circle(0, 7, r="1/2", vx="1/3", vy=-1, id="c"), Circle(5, 5, vx=-1, id="d")], walls,
                  polygons=[Polygon(DART, id="g", r="1/4")], reverse_at=25)  # fmt: skip
    run = ExactEngine().run(scene)
    out = run.reversal.after
    assert out > 4
    assert [e.contacts for e in run.events[:out]] == [e.contacts for e in reversed(run.events[out:])]
    assert (run.final["c"].x.text(), run.final["c"].y.text()) == ("0", "7")


def test_boxes_side_by_side_are_one_floor():
    row = [Polygon([(k, 0), (k + 1, 0), (k + 1, 1), (k, 1)], id=f"g{k}") for k in range(12)]
    for engine in (ExactEngine(), DoubleEngine(), PymunkEngine()):
        assert not engine.run(Scene([Circle(-2, 2, vx=1)], polygons=row), until=20).events
    (event,) = ExactEngine().run(Scene([Circle(5, 4, vy=-1)], polygons=row), until=9).events
    assert len(event.contacts) == 1  # the corner of two, which pushes once


def test_parts_are_those_that_are_touched():
    scene = Scene([Circle(0, 9)], polygons=[Polygon(DART, id="g")])
    left = part_at(scene, 0, 0, 0.0, 2.4)
    right = part_at(scene, 0, 0, 0.0, 2.4, [left])
    assert {scene.surfaces.walls[link.wall].normal for link in (left, right)} == {(3, 3), (-3, 3)}
    corner = part_at(scene, 0, 0, 3.5, 4.5)
    assert isinstance(corner, Pair)
    assert scene.surfaces.circles[corner.b].x == 3


def test_cells_change_nothing(monkeypatch):
    draw, discs = Random(5), []
    walls = [
        Wall(0, 0, 40, 0, id="b"),
        Wall(40, 0, 40, 40, id="r"),
        Wall(40, 40, 0, 40, id="t"),
        Wall(0, 40, 0, 0, id="l"),
    ]
    shape = [(4, 4), (7, 5), (6, 7), (5, 6)]
    solids = [
        Polygon([(x + 8 * i, y + 8 * j) for x, y in shape], id=f"g{i}{j}", r="1/4") for i in range(4) for j in range(4)
    ]
    while len(discs) < 70:
        place, speed = ([draw.randint(*ends) for _ in "xy"] for ends in ((5, 395), (-99, 99)))
        (x, y), (vx, vy) = (f"{place[0]}/10", f"{place[1]}/10"), (f"{speed[0]}/50", f"{speed[1]}/50")
        try:
            disc = Circle(x, y, r="2/5", vx=vx, vy=vy, id=f"c{len(discs)}")
            scene = Scene([*discs, disc], walls, polygons=solids)
        except SceneError:
            continue
        discs.append(disc)
    runs = [ExactEngine().run(scene, events=150)]
    monkeypatch.setattr(cells, "FEWEST", 10**9)
    runs.append(ExactEngine().run(scene, events=150))
    assert runs[0].plan["cells crossed"] > 0 == runs[1].plan.get("cells crossed", 0)
    told = [[(event.contacts, event.time.digits(25)) for event in run.events] for run in runs]
    assert told[0] == told[1]
    assert sum(pair.second.startswith("g") for event in runs[0].events for pair in event.contacts) > 20


# -- Words.


def test_files_keep_polygons():
    many = [(k, k * k) for k in range(-30, 31)]
    scene = Scene(
        [Circle(0, -5)], polygons=[Polygon(DART, "a", "1/3"), Polygon([(9, 0), ("9 + sqrt(2)", 0), (9, "1/3")])]
    )
    long = Scene([Circle(0, -5)], polygons=[Polygon(many, "parabola")])
    for one in (scene, long):
        assert loads_toml(dump_toml(one)) == one == loads_json(dump_json(one))
        assert loads_toml(dump_toml(one)).digest == one.digest
    assert "points = [[-3, 4], [-3, 0]" in dump_toml(scene)
    assert scene.digest != scene.with_changes(polygons=scene.polygons[:1]).digest


SQUARE = [(0, 0), (2, 0), (2, 2), (0, 2)]


@pytest.mark.parametrize(
    ("made", "says"),
    [
        (lambda: Polygon([(0, 0), (1, 1)], id="g"), "polygon 'g': has 2 points; a polygon needs three or more"),
        (lambda: Polygon([(0, 0), (2, 2), (2, 0), (0, 2)], id="g"), "sides 1 and 3 meet"),
        (lambda: Polygon([(0, 0), (4, 0), (4, 4), (2, 0), (0, 4)], id="g"), "sides 1 and 3 meet"),
        (lambda: Polygon([(0, 0), (1, 0), (2, 0)], id="g"), "meet; order the points"),
        (lambda: Polygon([(0, 0), (3, 0), (1, 0), (1, 1)], id="g"), "sides 1 and 2 meet"),
        (lambda: Polygon([(0, 0), (3, 0), (0, 0), (1, 1)], id="g"), "point 3 is point 1 again"),
        (lambda: Polygon([(0, 0), (3, 0), (1, 1)], id="g", r=-1), "r = -1"),
        (lambda: Polygon([(0, 0), (3, 0), 7], id="g"), "point 3 = '7' is not a pair"),
        (lambda: Polygon([(0, 0), (3, "x"), (1, 1)], id="g"), "point 2: y = 'x' is not"),
        (lambda: Scene([Circle(1, 1, r="1/9", id="c")], polygons=[Polygon(SQUARE, id="g")]), "centre is in polygon"),
        (lambda: Scene([Circle(3, 1, r="10/9", id="c")], polygons=[Polygon(SQUARE, id="g")]), "across polygon 'g', by"),
        (  # as far from a concave corner as if it touched that
            lambda: Scene([Circle(2, 1, r=1, id="c")], polygons=[Polygon(NOOK, id="g")]),
            "across polygon 'g', by",
        ),
        (lambda: Scene([Circle(2, 1, r=0, point=True)], polygons=[Polygon(SQUARE, id="g")]), "lies on polygon 'g'"),
        (lambda: Scene([Circle(9, 9)], polygons=[Polygon(SQUARE), Polygon(SQUARE)]), "overlaps polygon 'g1'"),
        (lambda: Scene([Circle(9, 9)], polygons=[Polygon(SQUARE), Polygon([(1, 1), (5, 1), (5, 5)])]), "overlaps"),
        (
            lambda: Scene([Circle(9, 9)], polygons=[Polygon(SQUARE), Polygon([("1/2", "1/2"), (1, "1/2"), (1, 1)])]),
            "overlaps polygon 'g1'; make them one, or move it",
        ),
        (lambda: Scene([Circle(9, 9)], segments=[Segment(1, 2, 5, 2)], polygons=[Polygon(SQUARE)]), "lies on a side"),
        (lambda: Scene([Circle(9, 9, id="g1")], polygons=[Polygon(SQUARE)]), "used twice"),
        (lambda: loads_toml('[[polygon]]\nid = "g"'), "points is missing; write points = [[x, y]"),
        (lambda: loads_toml('[[polygon]]\nid = "g"\npoints = 3'), "points = 3 is not a list"),
        (lambda: loads_toml('[[polygon]]\nid = "g"\npoints = [[1, 2, 3]]'), "point 1 = [1, 2, 3] is not a pair"),
        (lambda: loads_toml('[[polygon]]\nid = "g"\npoints = [[1, true]]'), "point 1: y = true is not a number"),
        (lambda: loads_toml('[[polygon]]\nid = "g"\npoints = [[1, 1]]\nfill = 1'), "key 'fill' is not known"),
    ],
)  # fmt: skip
def test_bad_input_has_one_line(made, says):
    with pytest.raises(SceneError) as error:
        made()
    assert says in str(error.value)
    assert "\n" not in str(error.value)


def test_what_does_not_know_polygons_says_so():
    from truebreak.compare.validation import unsupported
    from truebreak.scenarios import Declared

    scene = Scene([Circle(0, 6, vy=-1)], [Wall(-9, 9, 9, 9)], polygons=[Polygon(DART)], events=3)
    assert unsupported(Declared(), scene) == "polygon"
