"""Segments and polygons that move: against a referee in true coordinates, closed forms, faults that must be found."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from random import Random

import edge_campaign
import pytest
import segment_referee
from falling_campaign import FALLING

from truebreak.compare import compare
from truebreak.compare.audit.audit import audit_run
from truebreak.compare.certificate import CertificateError
from truebreak.compare.reduction.smallest import corners, with_number
from truebreak.compare.report.floats import floats_csv, floats_json
from truebreak.compare.report.html import world_phrase
from truebreak.compare.report.player import played
from truebreak.compare.tangent.impacts import NoTangentMap, impacts
from truebreak.compare.testing.check import check
from truebreak.exact import ExactEngine
from truebreak.exact.certified.filtered_falls import FallingPredictor, falls_in_doubles, peg_in_doubles
from truebreak.exact.literal.symbolic_engine import SymbolicEngine
from truebreak.exact.replay import state as states
from truebreak.exact.replay.ball_state import LoneContacts
from truebreak.exact.replay.refinable import RefinableState
from truebreak.exact.replay.state import Flights
from truebreak.exact.replay.wall_flights import SeenWall
from truebreak.exact.simulation.prediction import ArrivalQueue
from truebreak.floating import DoubleEngine, IntervalEngine, PymunkEngine, QuadEngine, RoundedEngine, SingleEngine
from truebreak.scenarios import Circle, Polygon, Quantity, Scene, SceneError, Segment, StopReason, Wall
from truebreak.scenarios.files import dump_json, dump_toml, loads_json, loads_toml
from truebreak.scenarios.pictures import as_at

CARRIED = replace(
    FALLING,
    name="carried",
    bases={name: FALLING.bases[name] for name in ("boxed", "pegs")},
    ingredients={name: FALLING.ingredients[name] for name in ("gravity", "motion", "restitution", "carried")},
    shares={"gravity": 0.5, "motion": 0.2, "restitution": 0.3, "carried": 1.0},
)
"""The campaign of what falls, of scenes in which segments move, few of whose other ingredients take long."""

SEEDS = 36


@pytest.fixture(autouse=True)
def _fine(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(segment_referee, "DIGITS", CARRIED.digits[0])
    monkeypatch.setattr(segment_referee, "SAME", CARRIED.digits[1])
    monkeypatch.setattr(edge_campaign, "CHECKS", ())


def _rows():
    return (row for seed in range(SEEDS) if (row := edge_campaign.verdict(seed, CARRIED)) is not None)


def test_events_times_and_ends_are_those_of_a_referee_in_true_coordinates():
    rows = list(_rows())
    outcomes = [row["outcome"] for row in rows]
    assert "failure" not in outcomes, [row for row in rows if row["outcome"] == "failure"]
    assert outcomes.count("ok") > 0.7 * len(outcomes)
    assert sum(row["events"] for row in rows) > 100


def _paces(change: Callable[[object], object]):
    """The velocities of ends, spoilt."""

    def spoil(monkeypatch: pytest.MonkeyPatch) -> None:
        plain = Flights.__init__

        def made(self, *args: object) -> None:
            plain(self, *args)
            self.paces = {end: tuple(map(change, pace)) for end, pace in self.paces.items()}

        monkeypatch.setattr(Flights, "__init__", made)

    return spoil


def _pace_that_only_places_have(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = Flights.peg_relation

    def related(self, link):
        found = plain(self, link)
        peg = link.ends(self)[0 if link[0] in self.pegs else 1]
        ux, uy = self.paces.get(peg.index, (self.zero, self.zero))
        sign = 1 if link[0] in self.pegs else -1
        return found._replace(vx=found.vx + ux * sign, vy=found.vy + uy * sign)

    monkeypatch.setattr(Flights, "peg_relation", related)


def _no_pull(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = Flights.peg_fall_at_clock
    monkeypatch.setattr(
        Flights, "peg_fall_at_clock", lambda self, link: plain(self, link)._replace(hx=self.zero, hy=self.zero)
    )


def _too_strong_a_push(monkeypatch: pytest.MonkeyPatch) -> None:
    plain, alone = states.pair_impulse, LoneContacts._off_peg
    monkeypatch.setattr(states, "pair_impulse", lambda *args: tuple(part + part / 8 for part in plain(*args)))
    monkeypatch.setattr(
        LoneContacts,
        "_off_peg",
        lambda self, link, a, peg, w, *rest: alone(self, link, a, peg, w * 9 / 8, *rest),
    )


FAULTS = {
    "ends go the other way": _paces(lambda part: -part),
    "ends stand": _paces(lambda part: part - part),
    "ends are a tenth too fast": _paces(lambda part: part + part / 10),
    "ends push as if they stood": _pace_that_only_places_have,
    "lines stand": lambda monkeypatch: monkeypatch.setattr(SeenWall, "moved", lambda self, drift, time: self),
    "nothing pulls towards an end": _no_pull,
    "a push is an eighth too strong": _too_strong_a_push,
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_planted_fault_is_found(fault: str, monkeypatch: pytest.MonkeyPatch):
    FAULTS[fault](monkeypatch)
    assert any(row["outcome"] == "failure" for row in _rows())


PAD = Segment(-2, 0, 2, 0, "pad", "1/4", "1/2", 1)


def paddle(**changes: object) -> Scene:
    return Scene([Circle(0, 6, "1/2", "1/3", -1, id="ball")], segments=[PAD], until=20).with_changes(**changes)


def test_a_paddle_throws_a_ball_back_in_closed_form():
    run = ExactEngine().run(paddle())
    assert [event.time.text() for event in run.events] == ["21/8"]
    assert (run.final["ball"].vx.text(), run.final["ball"].vy.text()) == ("1/3", "3")
    fallen = ExactEngine().run(paddle(gravity=(0, -10)), events=3)
    first, second, third = (event.time for event in fallen.events)
    assert first.text() == "1/10*sqrt(109) - 1/5"
    a, b, c = (time.ball(200) for time in (first, second, third))
    assert abs(float(c - b - (b - a))) < 1e-40  # seen from the paddle it bounces as on a floor


def test_an_end_that_moves_is_met_at_a_quadratic_and_under_gravity_at_a_quartic():
    end = Segment(0, 0, 4, 0, id="pad", r="1/4", vy=1)
    scene = Scene([Circle("-1/2", 6, "1/2", vy=-1, id="ball")], segments=[end])
    time = ExactEngine().run(scene, events=1).events[0].time
    assert time.text() == "-1/8*sqrt(5) + 3"  # where |(1/2, 6 - 2 t)| = 3/4
    fallen = ExactEngine().run(scene.with_changes(gravity=(0, -10)), events=1)
    t = Quantity.of(fallen.events[0].time.digits(60))
    gap = Quantity.of("1/4") + (6 - 2 * t - 5 * t * t) * (6 - 2 * t - 5 * t * t) - Quantity.of("9/16")
    assert abs(float(gap)) < 1e-50


@pytest.mark.parametrize("gravity", [None, (0, -4)])
def test_a_scene_seen_from_what_moves_is_one_in_which_it_stands(gravity: tuple[int, int] | None):
    pad = [Segment(-2, 0, 1, "1/3", "pad", "1/5"), Segment(1, "1/3", 3, 2, "ramp")]
    block = [Polygon([(-5, 0), (-4, 0), (-4, 3)], "block")]
    ball = Circle(0, 4, "1/2", "1/5", -1, id="ball")
    still = Scene([ball, Circle("9/10", 7, "1/3", 0, -2, id="other")], segments=pad, polygons=block, gravity=gravity)
    ux, uy = Quantity.of("2/7"), Quantity.of("sqrt(2)/3")
    moved = still.with_changes(
        circles=[Circle(c.x, c.y, c.r, c.vx + ux, c.vy + uy, id=c.id) for c in still.circles],
        segments=[Segment(s.x0, s.y0, s.x1, s.y1, s.id, s.r, ux, uy) for s in pad],
        polygons=[Polygon(p.points, p.id, p.r, ux, uy) for p in block],
    )
    one, other = (ExactEngine().run(scene, events=8, until=6) for scene in (still, moved))
    assert [e.contacts for e in one.events] == [e.contacts for e in other.events]
    assert len(one.events) > 2
    assert [e.time.digits(30) for e in one.events] == [e.time.digits(30) for e in other.events]


def _boosted(seed: int) -> tuple[Scene, Scene] | None:
    """A scene, and the same with one velocity more of all that is in it; None where it is refused."""
    rng = Random(f"boost {seed}")

    def some(low: int, high: int) -> str:
        return f"{rng.randint(low * 20, high * 20)}/20"

    circles = [
        Circle(some(-5, 5), some(-5, 5), rng.choice(("1/2", "1/3", "3/4")), some(-2, 2), some(-2, 2), id=f"c{k}")
        for k in range(rng.choice((1, 1, 2, 3)))
    ]
    pads = [
        Segment(*(some(-5, 5) for _ in range(4)), f"s{k}", rng.choice(("0", "1/10", "sqrt(2)/7")))
        for k in range(rng.choice((1, 2, 3)))
    ]
    if rng.random() < 0.4:  # a platform to roll off
        pads = [Segment(x := rng.randint(-3, 1), -k, x + 2, -k, f"s{k}", "1/10") for k in (0, 2, 4)]
    x, y = rng.randint(-5, 3), rng.randint(-5, 3)
    blocks = [Polygon([(x, y), (x + 1, y), (x + 1, y + 2)], "block")] if rng.random() < 0.3 else []
    ends = ((-6, -6, 6, -6), (6, -6, 6, 6), (6, 6, -6, 6), (-6, 6, -6, -6))
    walls = [Wall(*points, f"w{k}") for k, points in enumerate(ends) if rng.random() < 0.8]
    gravity = rng.choice((None, (0, -1), (0, -10), ("1/2", -3), (0, "-sqrt(3)")))
    ux, uy = map(Quantity.of, rng.choice((("1/2", 0), (0, "1/3"), ("-2/7", "sqrt(2)/3"), (0, -1), (3, "1/9"))))
    e = rng.choice(("1", "1", "9/10", "1/2", "0"))
    try:
        still = Scene(circles, walls, segments=pads, polygons=blocks, gravity=gravity, restitution=e)
        moved = still.with_changes(
            circles=[replace(circle, vx=circle.vx + ux, vy=circle.vy + uy) for circle in still.circles],
            walls=[replace(wall, vx=ux, vy=uy) for wall in still.walls],
            segments=[replace(pad, vx=ux, vy=uy) for pad in still.segments],
            polygons=[replace(block, vx=ux, vy=uy) for block in still.polygons],
        )
    except SceneError:
        return None
    return still, moved


@pytest.mark.parametrize("first", range(0, 400, 50))
def test_with_one_velocity_more_of_all_there_is_histories_are_the_same(first: int):
    """What doubles, balls and proofs make of things that move is what they make of the same things at rest."""
    compared = 0
    for seed in range(first, first + 50):
        if (scenes := _boosted(seed)) is None:
            continue
        one, other = (ExactEngine(work=500_000).run(scene, events=12, until=12) for scene in scenes)
        for event, again in zip(one.events, other.events, strict=False):
            assert (event.impulses, event.time.digits(25)) == (again.impulses, again.time.digits(25)), seed
        if StopReason.UNDECIDED not in (one.stop.reason, other.stop.reason):
            assert (len(one.events), one.stop.reason) == (len(other.events), other.stop.reason), seed
            compared += len(one.events)
    assert compared > 60


@pytest.mark.parametrize(
    "engine",
    [DoubleEngine(), SingleEngine(), QuadEngine(), RoundedEngine(bits=40), IntervalEngine(), SymbolicEngine()],
    ids=lambda engine: engine.name,
)
@pytest.mark.parametrize("gravity", [None, (0, -4)])
def test_every_engine_of_events_plays_them(engine, gravity: tuple[int, int] | None):
    block = Polygon([(-6, 0), (-3, 0), (-3, 1), (-6, 1)], "block", vx="-1/10", vy="1/3")
    circles = [Circle(0, 4, "1/2", "-4/5", -1, id="ball"), Circle("-9/2", 6, "1/3", "1/9", -2, id="other")]
    scene = Scene(circles, segments=[PAD], polygons=[block], gravity=gravity)
    if gravity is not None and isinstance(engine, SymbolicEngine):
        assert "is told by a zero of a quartic" in engine.run(scene, events=3, until=5).stop.message
        return
    truth, run = ExactEngine().run(scene, events=3, until=5), engine.run(scene, events=3, until=5)
    assert len(truth.events) >= 2
    assert [event.contacts for event in run.events] == [event.contacts for event in truth.events]
    for mine, theirs in zip(run.events, truth.events, strict=True):
        assert float(mine.time) == pytest.approx(float(theirs.time), rel=1e-5)


def test_pymunk_has_kinematic_bodies_for_them():
    block = Polygon([(-1, 0), (3, 0), (2, 2)], "block", vx=-1, vy=1)
    scene = Scene([Circle("12/5", 6, "1/2", "1/3", -1, id="a"), Circle(-1, 8, "1/3", vy=-3, id="b")], polygons=[block])
    truth, run = ExactEngine().run(scene, events=1), PymunkEngine(dt=1 / 4096).run(scene, events=1)
    assert [event.contacts for event in run.events] == [event.contacts for event in truth.events]
    assert float(run.events[0].time) == pytest.approx(float(truth.events[0].time), abs=1e-3)
    assert float(run.final["b"].vx) == pytest.approx(float(truth.final["b"].vx), abs=2e-2)
    found = compare(paddle(gravity=(0, -10)), [PymunkEngine(dt=1 / 1024)], events=4).candidates[0]
    assert found.alignment.divergence is None


def pressed(*more: Circle, **changes: object) -> Scene:
    ball = Circle(0, 2, "1/2", vy=-1, id="ball")
    top = Wall(0, 10, 1, 10, id="top")
    return Scene([ball, *more], [top], segments=[Segment(-2, 0, 2, 0, "pad", "1/4", vy=1)]).with_changes(**changes)


def test_a_disc_between_surfaces_that_close_is_crushed_at_the_exact_time():
    run = ExactEngine().run(pressed(), until=30)
    assert run.stop.reason is StopReason.CRUSHED
    assert run.ending is not None
    assert run.ending.text() == "35/4"
    lid = Segment(3, 6, -3, 6, "lid", vy=-1)
    both = pressed(walls=[], segments=[*pressed().segments, lid], gravity=(0, -10))
    ended = ExactEngine().run(both, until=30).ending
    assert ended is not None
    assert ended.text() == "19/8"  # 6 - t - 1/4 - t = 1
    resting = ExactEngine().run(pressed(restitution=0), until=30)
    assert (resting.stop.reason, len(resting.events)) == (StopReason.CRUSHED, 1)
    before = ExactEngine().run(pressed(), until=8)
    assert before.stop.reason is StopReason.HORIZON


def test_one_that_slips_out_is_not_and_where_others_may_come_nothing_is_said():
    slips = Circle(0, 2, "1/2", vx=1, vy=-1, id="ball")
    run = ExactEngine().run(pressed(circles=[slips]), until=30)
    assert run.stop.reason is StopReason.HORIZON
    for scene in (pressed(Circle(30, 2, id="far")), pressed(circles=[Circle(0, 2, "1/2", "1/5", -1, id="ball")])):
        run = ExactEngine().run(scene, until=30)
        assert run.stop.reason is StopReason.UNDECIDED
        assert "accumulation suspected: between surfaces that close" in run.stop.message


def test_files_hold_them_and_digests_of_others_stay():
    scene = paddle(polygons=[Polygon([(9, 0), (10, 0), (9, 2)], "block", vx="1/3")])
    assert loads_toml(dump_toml(scene)) == loads_json(dump_json(scene)) == scene
    assert scene.segments[0].moves
    still = Scene([Circle(0, 9)], segments=[Segment(0, 0, 1, 0)], polygons=[Polygon([(3, 0), (4, 0), (3, 1)])])
    again = Scene(
        [Circle(0, 9)], segments=[Segment(0, 0, 1, 0, vx=0)], polygons=[Polygon(still.polygons[0].points, vy=0)]
    )
    assert still.digest == again.digest
    told = floats_json(scene)
    assert (told["segments"][0]["vy"], told["polygons"][0]["vx"]) == (1.0, 1 / 3)
    assert world_phrase(scene).endswith("1 segment that moves, 1 polygon that moves")
    for kind in ("arc", "pocket"):
        text = f'[[circle]]\nid = "a"\nx = 0\ny = 0\nr = 1\n[[{kind}]]\nid = "s"\nx = 9\ny = 0\nr = 1\nvx = 1\n'
        with pytest.raises(SceneError, match=f"{kind} 's': vx: an arc or a pocket does not move; leave it out"):
            loads_toml(text)


def test_a_smaller_scene_keeps_their_velocities():
    scene = paddle(polygons=[Polygon([(9, 0), (10, 0), (10, 2), (9, 2)], "block", vx="1/3")])
    parts = corners(scene)
    left = parts.keeping([item for item in parts.items if item != "block.1"])
    assert (len(left.polygons[0].points), left.polygons[0].vx.text()) == (3, "1/3")
    assert with_number(scene.polygons[0], "polygons", "x1", Quantity.of(8)).vx.text() == "1/3"
    joined = paddle(segments=[PAD, Segment(2, 0, 3, 0, "more", "1/4", "1/2", 1)])
    assert corners(joined).keeping([]).segments[0].vy.text() == "1"


def test_pictures_and_the_player_have_them_where_they_are():
    scene = paddle(polygons=[Polygon([(9, 0), (10, 0), (9, 2)], "block", vx=2)])
    there = as_at(scene, 2.0)
    assert (float(there.segments[0].y0), float(there.polygons[0].points[0][0])) == (2.0, 13.0)
    told = played(scene, ExactEngine().run(scene, events=1), [], name="exact", title="exact")
    assert told is not None
    assert told["segments"][0][5:] == (0.5, 1.0)
    assert told["polygons"][0][2:] == (2.0, 0.0)


@pytest.mark.parametrize("gravity", [None, (0, -8)])
@pytest.mark.parametrize("drift", ["0", "1/3"])
def test_a_point_that_hits_a_point_ends_the_run(gravity: tuple[int, int] | None, drift: str):
    """There is no normal; one that passes beside it goes on."""
    more = Segment(9, 0, 12, 0, "more", vy=1)

    def run(x: str):
        still = gravity is None and drift == "0"
        ball = Circle(x, 5, 0, drift, -1, point=True, id="ball")
        segments = [Segment(0, 0, 3, 0, "bar", vx=drift), *([] if still else [more])]
        return ExactEngine().run(Scene([ball], segments=segments, gravity=gravity), until=3 if gravity else 9)

    assert run("0").stop.reason is StopReason.UNDECIDED
    assert run("-1/1000").stop.reason in (StopReason.HORIZON, StopReason.QUIET)
    assert run("1/1000").events


def test_what_goes_through_the_other_is_no_overlap():
    Scene([Circle(0, 9)], segments=[Segment(0, 0, 4, 0, vx=1), Segment(1, 0, 3, 0)])
    with pytest.raises(SceneError, match="lies on segment"):
        Scene([Circle(0, 9)], segments=[Segment(0, 0, 4, 0, vx=1), Segment(1, 0, 3, 0, vx=1)])
    box = [(0, 0), (2, 0), (2, 2), (0, 2)]
    Scene([Circle(0, 9)], polygons=[Polygon(box, vx=1), Polygon([(x + 1, y + 1) for x, y in box])])
    with pytest.raises(SceneError, match="overlaps polygon"):
        Scene([Circle(0, 9)], polygons=[Polygon(box), Polygon([(x + 1, y + 1) for x, y in box])])
    shared = Scene([Circle(0, 9)], segments=[Segment(0, 0, 1, 0), Segment(1, 0, 2, 0, vy=1)])
    assert len(shared.surfaces.ends) == 4


BAR = Segment(0, 0, 6, "1/2", id="bar", r="1/8", vx="1/7", vy="2/7")
BLOCK = Polygon([(0, 5), (3, 5), (3, 7), (0, 7)], id="block", vx="1/5", vy="-1/9")


@pytest.mark.parametrize("pull", [None, (0, -1)])
@pytest.mark.parametrize(
    ("things", "kept"),
    [
        ((BAR, BLOCK), True),
        ((Segment(0, 0, 6, "1/2", id="bar", r="1/8", vx="1/7", vy="3/7"), BLOCK), False),
        ((Segment(0, 0, 6, "1/2", id="bar", r="1/8", vx="1/7"), BLOCK), False),
        ((Segment(0, "1/1000", 6, "501/1000", id="bar", r="1/8", vx="1/7", vy="2/7"), BLOCK), False),
        ((Segment(0, -90, 6, -90, id="bar", r="1/8"), BLOCK), False),
        ((BAR, Polygon([(0, 5), (3, 5), (3, 7), (0, 7)], id="block", vx="1/5", vy="-1/8")), False),
        ((BAR, Polygon([(90, 5), (93, 5), (93, 7), (90, 7)], id="block", vx="1/5", vy="-1/9")), False),
    ],
)
def test_the_audit_distinguishes_runs_among_what_moves_from_runs_among_what_moves_otherwise(things, kept, pull):
    """The engine is given another bar, or another block, than that of the scene whose law it has to keep."""
    discs = [Circle(2, 3, "1/2", "1/5", -1, id="a"), Circle("24/5", "9/2", "1/3", "-1/3", "1/4", id="b")]
    walls = [Wall(-1, 0, -1, 1, id="left"), Wall(8, 0, 8, 1, id="right")]
    scene = Scene(discs, walls, segments=[BAR], polygons=[BLOCK], gravity=pull)
    for engine in (DoubleEngine(), SingleEngine(), QuadEngine()):
        own = engine.run(scene.with_changes(segments=[things[0]], polygons=[things[1]]), until=6)
        found = audit_run(replace(own, scene=scene), engine)
        assert found.kept is kept, (engine.name, found.sentence)
    met = {name for event in ExactEngine().run(scene, until=6).events for pair in event.contacts for name in pair}
    assert met >= {"bar"}


def test_what_does_not_know_them_says_so_in_one_line():
    scene = paddle()
    for build, told in (
        (lambda: scene.with_changes(reverse_at=1), "segment 'pad': moves: cannot be turned back"),
        (lambda: floats_csv(scene), "walls that move, which no row of a thing can say"),
        (lambda: check("double", scene), "segments or polygons that move"),
    ):
        with pytest.raises((SceneError, CertificateError), match=told) as error:
            build()
        assert "\n" not in str(error.value)
    run = DoubleEngine().run(scene)
    assert audit_run(run, PymunkEngine()).reason == "segment 'pad' moves, and what meets it is not audited yet in steps"
    with pytest.raises(NoTangentMap, match="of segments only runs of the exact engine distinguish faces from ends"):
        impacts(run, 1)


@pytest.mark.parametrize("stood", [False, True])
def test_what_moves_and_ends_is_never_told_in_doubles(stood: bool):
    """Not right after a contact either, when the gap is not looked at: a campaign found one that was."""
    scene = Scene([Circle(0, 6, "1/2", id="ball")], segments=[PAD], gravity=(0, -10)).surfaces
    state = RefinableState(scene, 256)
    predictor = FallingPredictor(scene, state, ArrivalQueue(state.balls.bodies), Counter(), lambda link: None)
    ball_body, flight = state.balls.bodies[0], (0.25, 3.0, 0.5, 2.0, 0.5, 1e-17)
    for peg in predictor.pegs_of(ball_body):
        assert peg_in_doubles(flight, peg, 99.0, stood) is True
    lines = predictor._as_they_fall(ball_body, range(len(scene.walls)))
    found, unclear = falls_in_doubles(flight, lines, 1e-15, 1e-15, [line.wall for line in lines[:1] if stood])
    assert found == []
    assert 0 in unclear


def test_a_point_that_comes_to_a_moving_end_has_no_normal_in_doubles_either() -> None:
    """By rounding it falls onto the end, which has no radius: a division by zero. Or rounding lets it by."""
    bars = (
        Segment("-47/26", "-56/65", "9/26", "7/195", r="1/10"),
        Segment("-33/26", "-99/52", "3/2", "-3/4", vx=-1, vy="1/2"),
    )
    scene = Scene([Circle("-15/13", "36/13", 0, "10/13", "-24/13", point=True, id="speck")], segments=bars)
    assert "no normal: speck and s2 meet in one point" in DoubleEngine().run(scene, until=3).stop.message
    for engine in (SingleEngine(), QuadEngine(), RoundedEngine()):
        assert engine.run(scene, until=3).stop.reason in (StopReason.HORIZON, StopReason.UNDECIDED)
    assert ExactEngine(max_bits=256).run(scene, until=3).stop.reason is StopReason.UNDECIDED
