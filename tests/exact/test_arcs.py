"""Arcs: against a referee in angles and distances, the laws that hold of them, and faults that must be found."""

from __future__ import annotations

import inspect
import math
from dataclasses import replace
from fractions import Fraction
from random import Random

import edge_campaign
import pytest
import range_campaign
import segment_referee
from arc_referee import ArcReferee
from arc_scenes import scene_of
from flint import arb
from mpmath import mp, mpf, sqrt

from truebreak.compare import compare
from truebreak.compare.adapters.billiards import BilliardsEngine
from truebreak.compare.adapters.box2d import Box2DEngine
from truebreak.compare.adapters.mujoco import MujocoEngine
from truebreak.compare.adapters.perfect_physics import PerfectPhysicsEngine
from truebreak.compare.adapters.pooltool import PooltoolEngine
from truebreak.compare.adapters.rapier import RapierEngine
from truebreak.compare.certificate import certificate_of
from truebreak.compare.certificate.certified import difference
from truebreak.compare.chaos.certified_chaos import chaos
from truebreak.compare.outcomes.outcome import mirror
from truebreak.compare.validation import unsupported
from truebreak.exact import ExactEngine, log_symmetry, question
from truebreak.exact.certified import certified_decider, filtered_arcs
from truebreak.exact.certified.filtered import DoubleFilter
from truebreak.exact.certified.filtered_arcs import FloatArc, ShortArcSides
from truebreak.exact.literal.symbolic_engine import SymbolicEngine
from truebreak.exact.replay import state as states
from truebreak.exact.replay.ball_state import BallState
from truebreak.exact.replay.contact import AtArc, Body, Flight
from truebreak.exact.simulation import arc_meetings
from truebreak.exact.simulation.arc_meetings import ArcSides
from truebreak.floating import DoubleEngine, IntervalEngine, PymunkEngine, QuadEngine, RoundedEngine, SingleEngine
from truebreak.scenarios import (
    Arc,
    Circle,
    Polygon,
    Quantity,
    Scene,
    SceneError,
    Segment,
    StopReason,
    Wall,
    arcs,
    surfaces,
)
from truebreak.scenarios.engine import SCENE_KEYS, Engine
from truebreak.scenarios.files import dump_json, dump_toml, loads_json, loads_toml

UNTIL, EVENTS = 20, 10
SEEDS = range(260)
ALONG = "touch from within, and the flight is along the arc"
AT_END = "a path touches the hollow side of an arc at its end, along it"


def differs(scene: Scene) -> str:
    """How the exact engine and the referee part; empty where they agree."""
    run = ExactEngine().run(scene, until=UNTIL, events=EVENTS)
    referee = ArcReferee(scene)
    try:
        told = referee.run(mpf(UNTIL), EVENTS)
    except AssertionError:  # from there on it is in the arc
        return "" if ALONG in run.stop.message or AT_END in run.stop.message else run.stop.message or "the referee fell"
    for mine, theirs in zip(told.events, run.events, strict=False):
        if abs(mpf(theirs.time.digits(80)) - mine.time) > mpf(10) ** -50:
            return f"event {theirs.index} at {float(theirs.time)}, not {float(mine.time)}"
        names = {tuple(pair) for pair in theirs.contacts}
        if not mine.approaching <= names <= mine.touching:
            return f"event {theirs.index}: {names}, not {mine.approaching}"
    if AT_END in run.stop.message or ALONG in run.stop.message:  # refused by name, whatever comes of it
        return ""
    if "no normal" in run.stop.message or told.blunt is not None:
        return "" if "no normal" in run.stop.message and told.blunt is not None else "a corner"
    if not run.certified:
        return run.stop.message
    if len(told.events) != len(run.events):
        return f"{len(run.events)} events, not {len(told.events)}"
    for circle, disc in zip(run.final.circles, told.discs, strict=True):
        pairs = zip((circle.x, circle.y, circle.vx, circle.vy), (disc.x, disc.y, disc.vx, disc.vy), strict=True)
        if any(abs(mpf(a.digits(70)) - b) > mpf(10) ** -45 for a, b in pairs):
            return f"{circle.id} ends elsewhere"
    return ""


def test_scenes_agree_with_the_referee():
    scenes = [(seed, scene) for seed in SEEDS if (scene := scene_of(seed)) is not None]
    assert len(scenes) > 150
    assert {seed: told for seed, scene in scenes if (told := differs(scene))} == {}
    stops = [ExactEngine().run(scene, until=UNTIL, events=EVENTS).stop.message for _, scene in scenes]
    assert sum(AT_END in message or ALONG in message for message in stops) <= 3  # refused by name: no more than that


def test_scenes_with_older_ingredients_agree_with_the_referee(monkeypatch):
    """The beginning of the campaign `edge_campaign.py --arcs`; a referee that forgets to turn is seen."""
    monkeypatch.setattr(segment_referee, "DIGITS", edge_campaign.FINE[0])
    monkeypatch.setattr(segment_referee, "SAME", edge_campaign.FINE[1])
    rows = [row for seed in range(30) if (row := edge_campaign.verdict(seed, edge_campaign.BOWS)) is not None]
    assert len(rows) > 20
    assert [row for row in rows if row["outcome"] not in ("ok", "no normal", "undecided")] == []
    assert sum(row["outcome"] == "ok" for row in rows) > 20
    monkeypatch.setattr(edge_campaign.OlderReferee, "turn_at", property(lambda self: None, lambda self, _: None), False)
    drawn = ((seed, edge_campaign.scene_of(seed, edge_campaign.BOWS)) for seed in range(150))
    turned = [seed for seed, aged in drawn if aged is not None and aged.scene.reverse_at is not None]
    assert any(edge_campaign.verdict(seed, edge_campaign.BOWS)["outcome"] == "failure" for seed in turned)


def _outer_zero(monkeypatch):
    """The inside is met at the zero at which the path comes in, in doubles, balls and exact numbers."""
    _changed(monkeypatch, "ahead + depth) / speed", "ahead - depth) / speed")
    monkeypatch.setattr(states.Flights, "arc_hit", lambda self, link: self.round_hit(link))
    monkeypatch.setattr(BallState, "arc_hit", states.Flights.round_hit)
    monkeypatch.setattr(arc_meetings, "pair_last_time", lambda b, root, square: (-root - b) / square)


def _wrong_range(monkeypatch):
    """What is on the other side of the chord."""
    known = arcs.arc_sides

    def turned(of):
        for side in known(of):
            yield arcs.ArcSide(side.x, side.y, side.r, -side.nx, -side.ny, -side.h, side.id, side.full)

    monkeypatch.setattr(arcs, "arc_sides", turned)


def _sum_within(monkeypatch):
    """r + rho for r - rho inside."""
    known = states.Flights.reach

    def added(self, a, b):
        return a.r - b.r if not b.is_pocket and b.r < self.zero else known(self, a, b)

    monkeypatch.setattr(states.Flights, "reach", added)
    monkeypatch.setattr(filtered_arcs, "arcs_in_doubles", lambda _, a, sides: ([], [side.side for side in sides]))
    monkeypatch.setattr(ShortArcSides, "numbers", ArcSides.numbers)


def _normal_turned(monkeypatch):
    """The impulse of several contacts at one instant pushes out of the arc from within."""
    known = states.ReplayState.arc_arms
    monkeypatch.setattr(
        states.ReplayState, "arc_arms", lambda self, link: [(i, -x, -y) for i, x, y in known(self, link)]
    )


def _closing_turned(monkeypatch):
    monkeypatch.setattr(AtArc, "closing", lambda self, state: state.round_closing(self))


def _end_forgotten(monkeypatch):
    known = surfaces.ends_of
    monkeypatch.setattr(surfaces, "ends_of", lambda *of: known(*of)[:-1])


def _one_arc_no_more(monkeypatch):
    """After a bounce from within, the same arc is not looked for again."""
    known = ArcSides.of
    monkeypatch.setattr(
        ArcSides, "of", lambda self, a, standing: [k for k in known(self, a, standing) if k not in standing]
    )


def _no_range_in_doubles(monkeypatch):
    _changed(monkeypatch, "if not full:", "if False:")


def _no_range_in_balls(monkeypatch):
    monkeypatch.setattr(filtered_arcs, "arcs_in_doubles", lambda _, a, sides: ([], [side.side for side in sides]))
    monkeypatch.setattr(arc_meetings, "arc_range", lambda *of: of[0] * 0 + 1)
    monkeypatch.setattr(question, "within_arc", lambda state, *_: state.one)


def _range_at_the_arc(monkeypatch):
    """The chord is not moved out, or in, to where the circle's centre is."""
    known = ShortArcSides.numbers

    def fixed(self, link):
        x, y, reach, r, nx, ny, edge = known(self, link)
        return x, y, reach, r, nx, ny, edge * abs(r) / abs(reach)

    monkeypatch.setattr(ShortArcSides, "numbers", fixed)


def _changed(monkeypatch, right, wrong):
    source = inspect.getsource(filtered_arcs.arcs_in_doubles)
    faulty = source.replace(right, wrong)
    assert faulty != source
    scope = dict(vars(filtered_arcs))
    exec(faulty, scope)
    monkeypatch.setattr(filtered_arcs, "arcs_in_doubles", scope["arcs_in_doubles"])


FAULTS = {
    "the zero at which the path comes in": _outer_zero,
    "the range on the wrong side of the chord": _wrong_range,
    "r + rho within": _sum_within,
    "the normal the other way": _normal_turned,
    "what nears is what parts": _closing_turned,
    "an end that is not met": _end_forgotten,
    "the same arc never again": _one_arc_no_more,
    "no range in doubles": _no_range_in_doubles,
    "no range in balls": _no_range_in_balls,
    "the chord where the arc is": _range_at_the_arc,
}


@pytest.mark.parametrize("fault", FAULTS)
def test_planted_faults_are_found(fault, monkeypatch):
    FAULTS[fault](monkeypatch)
    for seed in SEEDS:
        scene = scene_of(seed)
        if scene is None:
            continue
        try:
            told = differs(scene)
        except (AssertionError, KeyError, IndexError, ValueError):
            told = "it fell"
        if told:
            return
    raise AssertionError(f"nothing finds {fault}")


# -- The bounds of the filter in doubles: right beside an end, with numbers that are off by all that is granted.

GRANTED = Fraction(1, 2**52)


def _near_an_end(rng: Random):
    """A flight and a side of an arc in doubles, that is met within some units in the last place of an end."""
    x, y, vx, vy = (rng.uniform(-4, 4) for _ in range(4))
    wait, r, hollow = rng.uniform(0.1, 3), rng.uniform(0.5, 3), rng.random() < 0.5
    angle = rng.uniform(0, 6.3)
    ex, ey = float(mp.cos(angle)), float(mp.sin(angle))
    towards = vx * ex + vy * ey
    if abs(vx) + abs(vy) < 0.2 or (towards < 0.05 if hollow else towards > -0.05):
        return None
    cx, cy = x + vx * wait - r * ex, y + vy * wait - r * ey
    nx, ny = rng.uniform(-2, 2), rng.uniform(-2, 2)
    off = rng.choice((-1, 1)) * 2.0 ** -rng.randint(24, 58)
    return (x, y, vx, vy, rng.uniform(0, 2)), (cx, cy, -r if hollow else r, nx, ny, (nx * ex + ny * ey) * r + off)


def _truth(rng: Random, numbers):
    """Numbers that doubles tell, off by up to what is granted, in many digits."""
    return [mpf(value) * (1 + rng.choice((-1, 1, 0)) * mpf(2) ** -52) for value in numbers]


def _wrong_filter(seed: int) -> int:
    """How often the filter says what is not so; that it says anything is asserted too."""
    mp.dps = 80
    rng, wrong, told = Random(seed), 0, 0
    zero = arb(0)
    for _ in range(3000):
        drawn = _near_an_end(rng)
        if drawn is None:
            continue
        (x, y, vx, vy, t), (cx, cy, reach, nx, ny, edge) = drawn
        body = Body(0, Flight(zero, zero, zero, zero, zero, zero), zero, zero)
        check = DoubleFilter()
        check.take(body, (x, y, vx, vy, t, 0.0))
        found, unclear = filtered_arcs.arcs_in_doubles(
            check, body, [FloatArc(3, cx, cy, reach, nx, ny, edge, abs(nx) + abs(ny), False)]
        )
        bx, by, bvx, bvy, bt = _truth(rng, (x, y, vx, vy, t))
        fx, fy, fr, fnx, fny, fedge = _truth(rng, (cx, cy, reach, nx, ny, edge))
        dx, dy = bx - fx, by - fy
        a, b, c = bvx**2 + bvy**2, dx * bvx + dy * bvy, dx**2 + dy**2 - fr**2
        meets, when = False, None
        if b * b > a * c:
            when = (-b + (sqrt(b * b - a * c) if reach < 0 else -sqrt(b * b - a * c))) / a
            meets = when > 0 and fnx * (dx + bvx * when) + fny * (dy + bvy * when) > fedge
        told += not unclear
        if found:
            low, high, _ = found[0]
            wrong += not (meets and low <= bt + when <= high)
        elif not unclear:
            wrong += meets
    assert told > 400
    return wrong


def test_the_filter_is_never_wrong_beside_an_end():
    assert sum(map(_wrong_filter, range(3))) == 0


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("blur = 2.0 * blur + 64 * UNIT *", "blur = 2.0**-14 * blur + 2.0**-14 * UNIT *"),
        ("off_time = 2.0 * off_wait + 8 * UNIT", "off_time = 2.0**-14 * off_wait + 2.0**-14 * UNIT"),
    ],
)
def test_a_bound_that_is_too_small_is_found(monkeypatch, right, wrong):
    _changed(monkeypatch, right, wrong)
    assert sum(map(_wrong_filter, range(3))) > 0


# -- Laws and words.


@pytest.mark.parametrize("seed", range(0, 120, 3))
def test_an_arc_in_two_parts_is_the_same_arc(seed):
    """Cut anywhere but where something is hit: the joint is smooth, and pushes no more than the arc did."""
    scene = scene_of(seed)
    if scene is None or all(arc.full for arc in scene.arcs):
        return
    parts: list[Arc] = []
    for arc in scene.arcs:
        (ax, ay), (bx, by) = arc.directions
        mx, my = by - ay, ax - bx  # away from the chord: the middle of the arc
        if arc.full or (mx.sign() == 0 and my.sign() == 0):
            parts.append(arc)
            continue
        mx, my = mx + my / 97, my - mx / 97
        cut = arc.x + mx, arc.y + my
        parts.append(Arc(arc.x, arc.y, arc.r, arc.x0, arc.y0, *cut, id=f"{arc.id}-"))
        parts.append(Arc(arc.x, arc.y, arc.r, *cut, arc.x1, arc.y1, id=f"{arc.id}+"))
    runs = [ExactEngine().run(each, until=UNTIL, events=6) for each in (scene, scene.with_changes(arcs=parts))]
    if any(not run.certified for run in runs):
        return
    times = [[event.time.digits(30) for event in run.events] for run in runs]
    assert times[0] == times[1]


@pytest.mark.parametrize("seed", range(60))
def test_intervals_never_say_what_is_not_so(seed):
    scene = scene_of(seed)
    if scene is not None:
        exact, wide = (engine.run(scene, until=UNTIL, events=6) for engine in (ExactEngine(), IntervalEngine()))
        told = [event.contacts for event in wide.events]
        assert told == [event.contacts for event in exact.events][: len(told)]


def test_sympy_agrees_by_its_own_way():
    compared = 0
    for seed in (8, 10, 26, 33, 56, 68, 127, 139):
        scene = scene_of(seed)
        if scene is not None and len(scene.circles) < 2:
            runs = [engine.run(scene, until=UNTIL, events=2) for engine in (ExactEngine(), SymbolicEngine())]
            first, second = ([(e.contacts, float(e.time)) for e in run.events] for run in runs)
            assert [names for names, _ in first] == [names for names, _ in second]
            assert [time for _, time in first] == pytest.approx([time for _, time in second])
            compared += bool(first)
    assert compared > 3


TABLE = Scene(
    [Circle("1/10", "1/7", r="1/5", vx=1, vy="2/3", id="c")],
    arcs=[Arc(1, 0, 1, 1, -1, 1, 1, id="east"), Arc(-1, 0, 1, -1, 1, -1, -1, id="west")],
    segments=[Segment(-1, -1, 1, -1, id="low"), Segment(1, 1, -1, 1, id="high")],
)


@pytest.mark.parametrize("engine", [DoubleEngine(), SingleEngine(), QuadEngine(), RoundedEngine(bits=40)])
def test_engines_of_finite_precision_follow_arcs(engine):
    exact, run = ExactEngine().run(TABLE, events=8), engine.run(TABLE, events=8)
    assert [event.contacts for event in run.events] == [event.contacts for event in exact.events]
    assert [float(e.time) for e in run.events] == pytest.approx([float(e.time) for e in exact.events], rel=1e-3)


def test_pymunk_has_no_arcs_and_says_so():
    with pytest.raises(SceneError, match="arc"):
        PymunkEngine().run(TABLE, events=3)


def test_the_way_back_is_the_way_out():
    run = ExactEngine().run(TABLE.with_changes(reverse_after=9))
    out = run.reversal.after
    assert [e.contacts for e in run.events[:out]] == [e.contacts for e in reversed(run.events[out:])]
    assert (run.final["c"].x.text(), run.final["c"].y.text()) == ("1/10", "1/7")


def test_a_chord_from_within_is_rational():
    """3-4-5: after the first bounce every time is rational, and so is every place."""
    scene = Scene([Circle(0, -3, r=0, vx=1, point=True, id="p")], arcs=[Arc(0, 0, 5, full=True, id="ring")])
    run = ExactEngine().run(scene, events=40)
    assert [event.time.text() for event in run.events[:3]] == ["4", "12", "20"]
    assert run.events[39].time.text() == "316"
    assert "/" in run.final["p"].x.text()


def test_a_flight_along_the_inside_stops_by_name():
    scene = Scene([Circle(0, -2, r=1, vx=1, id="c")], arcs=[Arc(0, 0, 3, full=True, id="ring")])
    for engine in (ExactEngine(), DoubleEngine()):
        run = engine.run(scene, until=9)
        assert not run.events
        assert f"c and ring {ALONG}" in run.stop.message


def test_a_path_that_touches_a_hollow_arc_at_its_very_end_is_refused():
    """The disc grazes the end, flying along the arc, and is in the arc after: no first order tells what happens."""
    bow = Arc(0, 0, 4, 1, 0, 1, 1, id="bow")
    for engine in (ExactEngine(), SymbolicEngine()):
        run = engine.run(Scene([Circle(3, -4, r=1, vy="3/2", id="c")], arcs=[bow]), until=9)
        assert not run.events
        assert AT_END in run.stop.message
    aside = ExactEngine().run(Scene([Circle("301/100", -4, r=1, vy="3/2", id="c")], arcs=[bow]), until=9)
    assert [event.contacts for event in aside.events][:1] == [(("c", "bow"),)]


@pytest.mark.parametrize(
    "engine", [ExactEngine(), DoubleEngine(), IntervalEngine(), SymbolicEngine()], ids=lambda engine: engine.name
)
def test_what_starts_along_a_hollow_arc_at_its_very_end_does_not_go_through_it(engine):
    """At the start, or after an impulse that leaves it there: these were certified to go through the arc."""
    bow, wall = Arc(0, 0, 5, 5, 0, -5, 0, id="bow"), Segment(5, 0, 5, -5, id="wall")
    into, out = (Scene([Circle(4, 0, vy=vy, id="c")], arcs=[bow]) for vy in (1, -1))
    assert AT_END in engine.run(into, until=9).stop.message
    assert engine.run(out, until=9).stop.reason.name == "HORIZON"
    onto = Scene([Circle(3, -1, vx=1, vy=1, id="c")], arcs=[bow], segments=[wall], restitution=0)
    run = engine.run(onto, until=9)
    assert [event.contacts for event in run.events] == [(("c", "wall"),)]
    assert AT_END in run.stop.message
    struck = Scene([Circle(4, 0, id="c"), Circle(5, -6, vx="-1/4", vy=1, id="d")], arcs=[bow])
    run = engine.run(struck, until=9)
    assert len(run.events) == 1
    assert AT_END in run.stop.message


@pytest.mark.parametrize(
    "engine", [ExactEngine(), DoubleEngine(), IntervalEngine(), SymbolicEngine()], ids=lambda engine: engine.name
)
@pytest.mark.parametrize("speed", ["1/3", "1/2", "sqrt(2)"])
def test_speeds_that_balls_round_go_through_no_end_of_an_arc(engine, speed):
    """Gap and approach are exact zeros there, the discriminant is a ball that holds zero: the arc was not looked at."""
    bow = Arc(0, 0, 1, "-12/13", "-5/13", 1, 0, id="bow")
    scene = Scene([Circle("3/4", 0, "1/4", vy=-Quantity.of(speed), id="c")], arcs=[bow])
    run = engine.run(scene, until=3)
    assert run.stop.reason is StopReason.UNDECIDED
    assert not run.events


@pytest.mark.parametrize(("vx", "vy", "pushes"), [(3, -1, 1), (0, -1, 2), (-1, 0, 2), (3, 1, 0)])
@pytest.mark.parametrize("engine", [ExactEngine(), DoubleEngine(), SymbolicEngine()], ids=lambda engine: engine.name)
def test_a_disc_in_the_opening_of_an_arc_touches_both_ends_at_the_start(engine, vx, vy, pushes):
    """The second of the two was left out of what touches; a run in which it was approached ended as a defect."""
    bow = Arc("-1/2", 0, "1/2", "-1/5", "2/5", 0, 0, id="bow")
    run = engine.run(Scene([Circle(0, "1/4", "1/4", vx=vx, vy=vy, id="d")], arcs=[bow]), until=2, events=1)
    assert [event.contacts for event in run.events] == [(("d", "bow"),) * pushes] * bool(pushes)
    assert [float(event.time) for event in run.events] == [0.0] * bool(pushes)


WERE_WRONG = {"arc": (47, 329, 501, 2348), "tangent": (200, 227, 341, 983, 5039), "bows": (71, 717, 745, 779)}
"""Of the scenes that `range_campaign` draws, those of which a run went through an arc, or ended as a defect."""


@pytest.mark.parametrize("family", range_campaign.FAMILIES)
def test_no_run_goes_through_what_begins_or_ends_where_it_is_touched(family):
    drawn = [range_campaign.case_of(family, seed) for seed in (*range(24), *WERE_WRONG.get(family, ()))]
    cases = [case for case in drawn if case is not None]
    assert cases
    for case in cases:
        _, found = range_campaign.judged(case)
        assert not found, case.words


@pytest.mark.parametrize(
    ("family", "seed", "sound"),
    [("arc", 501, "_may_go_along(link, sign)"), ("level", 8, "sign(Gap(link)) == 0 == sign(Approach(link))")],
)
def test_what_goes_through_an_arc_is_seen(monkeypatch, family, seed, sound):
    scope = dict(vars(arc_meetings))
    exec(inspect.getsource(arc_meetings.arc_contact).replace(sound, "False"), scope)
    monkeypatch.setattr(certified_decider, "arc_contact", scope["arc_contact"])
    _, found = range_campaign.judged(range_campaign.case_of(family, seed))
    assert [text.partition(" from ")[0] for text in found] == ["disc0 in bow0"]


def test_a_smooth_joint_pushes_once():
    """Where a side of a stadium goes over into a half-circle, a disc hits the end that they share, and that alone."""
    scene = TABLE.with_changes(circles=[Circle(0, 0, r="1/5", vx=5, vy=4, id="c")])
    for engine in (ExactEngine(), DoubleEngine()):
        run = engine.run(scene, until="3/10")
        assert len(run.events) == 1
        assert len(run.events[0].contacts) == 1
        assert (float(run.final["c"].vx), float(run.final["c"].vy)) == pytest.approx((5, -4))


def test_files_keep_arcs():
    ring, bow = Arc(0, 0, 9, full=True, id="ring"), Arc(0, 0, "sqrt(2)", 1, 1, -1, 1, id="bow")
    scene = Scene([Circle(0, 5)], arcs=[ring, bow])
    text = dump_toml(scene)
    assert loads_toml(text).digest == loads_json(dump_json(scene)).digest == scene.digest
    assert text.count("[[arc]]") == 2
    assert text.count("full = true") == 1


@pytest.mark.parametrize(
    ("made", "says"),
    [
        (lambda: Arc(0, 0, 0, full=True, id="a"), "arc 'a': r = 0: a radius must be positive"),
        (lambda: Arc(0, 0, 1, id="a"), "x0 is missing; write where it begins and ends, or full = true"),
        (lambda: Arc(0, 0, 1, 1, 0, 0, 1, full=True, id="a"), "has no ends; leave out"),
        (lambda: Arc(0, 0, 1, 2, 0, 3, 0, id="a"), "in one direction; write full = true"),
        (lambda: Arc(1, 2, 1, 2, 0, 1, 2, id="a"), "x1, y1 is its centre (1, 2)"),
        (lambda: Scene([Circle(0, 0)], arcs=[Arc(0, 0, "1/2", full=True)]), "lies across arc 'a1', by 1/2"),
        (lambda: Scene([Circle(0, 5)], arcs=[Arc(0, 0, 3, 1, 0, 0, 1), Arc(0, 0, 3, 1, 1, 0, 1)]), "make them one"),
        (lambda: Scene([Circle(0, 5)], arcs=[Arc(0, 0, 1, 1, 0, 0, 1)]), "which it fits all along"),
        (lambda: Scene([Circle(0, 5)], arcs=[Arc(0, 0, 1, 1, 0, -1, 0)]), "which it fits all along"),
        (lambda: Scene([Circle(0, 0)], arcs=[Arc(0, 0, 1, full=True)]), "which it fits all along"),
        (lambda: Scene([Circle(3, 4, r=0, point=True)], arcs=[Arc(0, 0, 5, full=True)]), "centre lies on arc"),
        (lambda: loads_toml('[[arc]]\nid="a"\nx=0\ny=0\nr=1\nx0=1\ny0=0\nx1=1'), "y1 is missing"),
        (lambda: loads_toml('[[arc]]\nid="a"\nx=0\ny=0\nr=1\nfull="yes"'), "is not true or false"),
    ],
)  # fmt: skip
def test_bad_input_has_one_line(made, says):
    with pytest.raises(SceneError) as error:
        made()
    assert says in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(("x", "part"), [("4", "outside"), ("2", "within")])
def test_what_touches_at_the_start_is_known(x, part):
    scene = Scene(
        [Circle(x, 0, r=1, vx=1 if part == "within" else -1, id="c")], arcs=[Arc(0, 0, 3, 1, -1, 1, 1, id="a")]
    )
    assert scene.touching == ((0, 1),)
    run = ExactEngine().run(scene, until=1)
    assert [(float(event.time), event.contacts) for event in run.events] == [(0.0, (("c", "a"),))]
    assert run.final["c"].vx.text() == ("-1" if part == "within" else "1")


# -- What is without arcs, or is of others, says so.


LEMON = TABLE.with_changes(
    segments=[], arcs=[Arc(0, -3, 5, 4, 0, -4, 0, id="up"), Arc(0, 3, 5, -4, 0, 4, 0, id="down")]
)


def test_a_certificate_without_arcs_is_of_no_scene_with_them():
    plain = Scene([Circle(0, 0, vx=1, id="a"), Circle(4, 0, id="b")])
    block = certificate_of(ExactEngine().run(plain))["scene"]
    assert difference(block, plain) is None
    assert "it has 0 arcs, not 1" in difference(block, plain.with_changes(arcs=[Arc(0, 0, 99, full=True)]))


@pytest.mark.parametrize(
    "kind",
    [BilliardsEngine, Box2DEngine, MujocoEngine, PerfectPhysicsEngine, PooltoolEngine, RapierEngine, PymunkEngine],
)
def test_engines_of_others_refuse_arcs_by_name_with_the_remedy(kind):
    """Before anything of theirs is loaded, and whoever asks them: a run without the arcs would be of another scene."""
    theirs = kind()
    assert unsupported(theirs, LEMON) == "arc"
    with pytest.raises(
        SceneError, match=f"has arcs, .*engine '{theirs.name}'.*; use another engine, or a chain of segments"
    ):
        theirs.run(LEMON, until=1)
    (found,) = compare(LEMON, [theirs], until=1).candidates
    assert found.unable
    assert "it does not follow 'arc'" in found.trajectory.stop.message


def test_engines_follow_no_arcs_unless_they_say_so():
    assert "arc" not in SCENE_KEYS
    assert unsupported(PymunkEngine(), TABLE) == "arc"
    assert unsupported(DoubleEngine(), TABLE) is None


def test_exponents_of_a_stadium_and_of_a_ring():
    """Benettin and Strelcyn, Phys. Rev. A 17, 773 (1978): .43 for radius 1 and straight sides of 2; a ring has none."""
    point = Circle("1/10", "1/7", r=0, point=True, vx="3/5", vy="4/5", id="p")
    rate = chaos(TABLE.with_changes(circles=[point]), [], events=3000).spectrum.per_time()
    assert rate.low < 0.43 < rate.high
    assert 0.38 < rate.value < 0.48
    ring = Scene([Circle(0, -3, r=0, vx="3/5", vy="4/5", point=True)], arcs=[Arc(0, 0, 5, full=True)])
    assert not chaos(ring, [], events=400).spectrum.chaotic


def test_the_mean_chord_of_a_stadium():
    """pi A / P, of Santalo's formula: for points, over 3,000 flights, within 3 standard errors of their blocks."""
    point = Circle("1/10", "1/7", r=0, point=True, vx="3/5", vy="4/5", id="p")
    run = ExactEngine().run(TABLE.with_changes(circles=[point]), events=3000)
    times = [float(event.time) for event in run.events]
    blocks = [(times[k + 99] - times[k]) / 99 for k in range(0, 2900, 100)]
    mean = sum(blocks) / len(blocks)
    error = (sum((b - mean) ** 2 for b in blocks) / len(blocks) / (len(blocks) - 1)) ** 0.5
    assert abs(mean - math.pi * (math.pi + 4) / (2 * math.pi + 4)) < 3 * error


def fitting(seed: int) -> Scene | None:
    """Circles as wide as an arc of more than a half-turn, most of them on their way to its middle."""
    draw = Random(seed)
    r = draw.choice(["1", "2", "3/2"])
    circles: list[Circle] = []
    try:
        arc = Arc(0, 0, r, *(draw.randint(-9, 9) for _ in range(4)))
        if arc.chord[2].sign() >= 0:
            return None
        for _ in range(draw.randint(1, 3)):
            x, y = draw.randint(-6, 6), draw.randint(-6, 6)
            aimed = draw.random() < 0.7
            vx, vy = (-x, -y) if aimed else (draw.randint(-3, 3), draw.randint(-3, 3))
            beside = f" + 1/10**{draw.randint(3, 20)}" if aimed and draw.random() < 0.3 else ""
            circles.append(Circle(x, y, r=r if draw.random() < 0.7 else "1/2", vx=f"{vx}{beside}", vy=vy))
        box = [Wall(-9, 0, -9, 1), Wall(9, 0, 9, 1), Wall(0, -9, 1, -9), Wall(0, 9, 1, 9)]
        return Scene(circles, box, arcs=[arc])
    except SceneError:
        return None


def test_circles_as_wide_as_an_arc_meet_its_outside_and_its_ends() -> None:
    scenes = [scene for seed in range(120) if (scene := fitting(seed)) is not None]
    wide = [scene for scene in scenes if any(circle.r == scene.arcs[0].r for circle in scene.circles)]
    assert len(wide) > 20
    assert [found for scene in wide if (found := differs(scene))] == []


MIRRORED = [
    Circle(0, 2, vy="9/7", id="middle"),
    *(Circle(s * Quantity.of("19/7"), "1/3", vx=s * Quantity.of("3/5"), vy="1/7", id=f"beside {s}") for s in (-1, 1)),
]
RING_ABOUT, CUP = Arc(0, 1, 9, full=True, id="ring"), Arc(0, 0, 9, -9, 0, 9, 0, id="cup")


@pytest.mark.parametrize(
    ("arcs", "mirrors"),
    [
        ([RING_ABOUT], 1),
        ([CUP], 1),
        ([Arc(9, 0, 4, 9, 4, 9, -4, id="right"), Arc(-9, 0, 4, -9, -4, -9, 4, id="left")], 1),
        ([Arc(1, 1, 9, full=True, id="ring")], 0),  # beside the line
        ([Arc(9, 0, 4, 9, 4, 9, -4, id="right"), Arc(-9, 0, 3, -9, -3, -9, 3, id="left")], 0),  # of another radius
        ([Arc(0, 0, 9, -9, 0, 0, 9, id="cup")], 0),  # longer on one side
        # one of less than a half-turn, and the rest of a circle like it: their chords are alike
        ([Arc(15, 0, 5, 18, -4, 18, 4, id="right"), Arc(-15, 0, 5, -12, 4, -12, -4, id="left")], 0),
    ],
)  # fmt: skip
def test_a_scene_with_arcs_is_its_own_mirror_image_where_its_arcs_are(arcs, mirrors):
    scene = Scene(MIRRORED, arcs=arcs)
    assert len(log_symmetry.symmetries(scene.surfaces)) == mirrors
    assert (mirror(scene, "x") is not None) == bool(mirrors)


@pytest.mark.parametrize("arcs", [[RING_ABOUT], [CUP]])
def test_what_a_mirror_among_arcs_holds_to_its_line_meets_the_same(arcs, monkeypatch):
    """The circle in the middle stays on the line, whatever its balls say; and the history is that of a run without."""
    scene = Scene(MIRRORED, [Wall(0, 11, 1, 11)], arcs=arcs)
    held = ExactEngine().run(scene, events=60)
    monkeypatch.setattr(log_symmetry, "symmetries", lambda scene: ())
    free = ExactEngine().run(scene, events=60)
    assert [(e.contacts, e.impulses) for e in held.events] == [(e.contacts, e.impulses) for e in free.events]
    for one, other in zip(held.events[::7], free.events[::7], strict=True):
        assert one.time.ball(300).overlaps(other.time.ball(300))
    assert held.final["middle"].x.bounds() == (0.0, 0.0)


def test_scenes_as_engines_see_them_differ_where_their_arcs_do():
    """What is known of a scene is looked up by it: nothing of another ring, hardly beside it, may be taken."""
    one, other = (Scene(MIRRORED, arcs=[Arc(x, 1, 9, full=True, id="ring")]) for x in (0, "1/10**400"))
    assert one.surfaces != other.surfaces and one.surfaces == Scene(MIRRORED, arcs=one.arcs).surfaces
    assert hash(one.surfaces) == hash(Scene(MIRRORED, arcs=one.arcs).surfaces)
    ties = [sum(len(event.ties) for event in ExactEngine().run(scene, events=20).events) for scene in (one, other)]
    assert ties[0] > 4 and ties[1] == 0


def test_what_hardly_moves_beside_an_arc_meets_none_of_it() -> None:
    """Without restitution what is wedged is slowed until the square of its speed is none: it was divided by."""
    scene = Scene(
        [Circle(0, 0, vx="-2/5", vy="3/10"), Circle("-6/5", "-8/5", m="oo")],
        polygons=[Polygon([("-11/26", "66/65"), ("-35/26", "41/65"), ("-21/26", "126/65")], r="1/10")],
        arcs=[
            Arc("5/26", "-6/13", "3/2", "-5/13", "12/13", "-17/13", "-6/13"),
            Arc("5/26", "-6/13", "3/2", "-17/13", "-6/13", "-5/13", "12/13"),
        ],
        restitution=0,
        tie_policy="sequential",
    )
    for engine in (DoubleEngine(), QuadEngine()):
        assert engine.run(scene, until="3/2").stop.reason is StopReason.HORIZON


@pytest.mark.parametrize("engine", [ExactEngine(), SymbolicEngine(), DoubleEngine()])
def test_a_flight_along_the_inside_from_between_its_ends_is_no_flight_through_it(engine: Engine) -> None:
    """At the start, in a ring, and after an impulse that takes all of the speed across the arc."""
    bow = Arc(0, "-1/4", "7/12", 0, "-5/6", "-35/156", "-41/52")
    along = Circle(0, 0, "1/3", vx="1/2")
    ring = Arc(0, "-1/4", "7/12", full=True)
    onto = Circle(0, "-1/4", "1/3", vx="3/5", vy="4/5")
    for scene in (
        Scene([along], arcs=[bow]),
        Scene([along], arcs=[ring]),
        Scene([replace(onto, y="-1/8", x=0)], arcs=[bow], restitution=0),
    ):
        run = engine.run(scene, until=3, events=4)
        assert run.stop.reason is StopReason.UNDECIDED, run
        assert range_campaign.wrong(run) == []
    assert engine.run(Scene([replace(along, vx=0)], arcs=[bow]), until=3).stop.reason is not StopReason.UNDECIDED
