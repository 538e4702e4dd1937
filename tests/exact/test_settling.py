"""Circles that walls carry: what comes to rest on a level wall, or slides along it, goes on so, and is struck."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from fractions import Fraction
from random import Random
from typing import Any

import numpy as np
import pytest
import settle_campaign
from flint import arb, fmpq
from settle_campaign import bouncing, differs, drawn, engines_differ, examined, guises_differ

from truebreak.compare import compare, html_report
from truebreak.compare.alignment.align import align
from truebreak.compare.deadline import Clock
from truebreak.compare.files.saved import run_of, saved_run
from truebreak.compare.report.listing import print_trajectory
from truebreak.compare.report.sentences import settled_phrase
from truebreak.compare.report.terminal import print_comparison
from truebreak.exact import ExactEngine
from truebreak.exact.literal.symbolic_engine import SymbolicEngine
from truebreak.exact.replay.state import Lift, ReplayState, Settle
from truebreak.exact.simulation import endings, instant
from truebreak.exact.simulation.endings import Carrier
from truebreak.floating import (
    DoubleEngine,
    IntervalEngine,
    PymunkEngine,
    QuadEngine,
    RoundedEngine,
    SingleEngine,
    plain,
)
from truebreak.floating.plain import PlainState
from truebreak.scenarios import (
    Arc,
    Circle,
    Engine,
    Pocket,
    Polygon,
    Quantity,
    Scene,
    SceneError,
    Segment,
    Wall,
    catalogue,
)
from truebreak.scenarios.files import dump_json, dump_toml, loads_json, loads_toml
from truebreak.scenarios.trajectory import StopReason, Trajectory

FLOOR = Wall(0, 0, 1, 0, id="floor")
DOWN = (0, -10)


def ran(circles: list[Circle], *walls: Wall, e: object = 0, until: object = None) -> Trajectory:
    """The certified run of some circles over a floor."""
    scene = Scene(circles, [FLOOR, *walls], gravity=DOWN, restitution=e, settle=True)
    return ExactEngine().run(scene, until=until)


def told(run: Trajectory) -> list[tuple[str | None, list[tuple[str, ...]]]]:
    """When each event is, and what pushes."""
    return [(event.time.text(), [tuple(link) for link in event.impulses]) for event in run.events]


def _sliders(seed: int) -> Scene | None:
    """Discs that slide over a floor, each at its own speed, and things that stand in their way, in any order."""
    rng = Random(f"sliders {seed}")

    def some(low: int, high: int) -> str:
        return f"{rng.randint(low * 20, high * 20)}/20"

    circles: list[Circle] = []
    for k in range(rng.choice((1, 1, 2, 3))):
        r = rng.choice(("1/2", "1", "1/3"))
        circles.append(Circle(some(-9, 9), r, r, some(-3, 3), 0, rng.choice(("1", "2")), id=f"b{k}"))
    for k in range(rng.choice((0, 1, 2))):
        r = rng.choice(("1/2", "1", "0"))
        circles.append(Circle(some(-9, 9), some(1, 3), r, m="oo", id=f"peg{k}", point=r == "0"))
    rng.shuffle(circles)
    bars = [
        Segment(some(-9, 9), some(0, 3), some(-9, 9), some(1, 5), f"s{k}", rng.choice(("0", "1/8")))
        for k in range(rng.choice((0, 1, 1, 2)))
    ]
    x, y = rng.randint(-9, 9), rng.choice(("1/4", "3/2"))
    blocks = [Polygon([(x, y), (x + 2, 3), (x - 1, 4)], "block")] if rng.random() < 0.4 else []
    walls = [FLOOR, Wall(12, 0, 13, rng.choice((3, -3)), "tilted"), Wall(-12, 9, -12, 0, "side")]
    try:
        return Scene(circles, walls, segments=bars, polygons=blocks)
    except SceneError:
        return None


def test_what_slides_meets_what_it_would_meet_without_gravity() -> None:
    """Up to the first meeting the floor does all that gravity does, whatever stands in the way, in whatever order."""
    compared = Counter[str]()
    for seed in range(160):
        free = _sliders(seed)
        if free is None:
            continue
        scenes = free, free.with_changes(gravity=DOWN, settle=True)
        one, other = (ExactEngine(work=100_000).run(scene, events=1, until=9) for scene in scenes)
        if one.stop.reason is StopReason.UNDECIDED:
            continue
        assert other.events or other.stop.reason is one.stop.reason, seed
        for mine, theirs in zip(one.events, other.events, strict=True):
            assert mine.time.digits(30) == theirs.time.digits(30), seed
            assert {frozenset(c) for c in mine.contacts} == {frozenset(c) for c in theirs.contacts}, seed
            compared.update({c for pair in mine.contacts for c in pair})
    assert {"b0", "peg0", "s0", "tilted", "block"} <= compared.keys()


def test_what_falls_and_stops_stays() -> None:
    run = ran([Circle(0, 6, id="ball")])
    assert run.stop.reason is StopReason.QUIET
    assert [(s.circle, s.wall, s.time.text()) for s in run.settlings] == [("ball", "floor", "1")]
    ball = run.final["ball"]
    assert [ball.x.text(), ball.y.text(), ball.vx.text(), ball.vy.text()] == ["0", "1", "0", "0"]
    assert run.at("1/2")["ball"].y.text() == "19/4"


def test_the_default_stops_there_as_before() -> None:
    scene = Scene([Circle(0, 6, id="ball")], [FLOOR], gravity=DOWN, restitution=0)
    run = ExactEngine().run(scene, until=20)
    assert run.stop.reason is StopReason.REST
    assert run.settlings == ()
    assert not scene.settle
    assert "settle" not in scene.data()


def test_it_slides_on_and_meets_walls_and_others_that_slide() -> None:
    right, left = Wall(30, 0, 30, 1, id="right"), Wall(-10, 0, -10, 1, id="left")
    run = ran([Circle(0, 6, vx=2, id="a"), Circle(20, 1, vx=-1, id="b")], right, left, until=20)
    assert told(run) == [("1", [("a", "floor")]), ("6", [("a", "b")])]
    slow = run.at("7")
    assert [slow["a"].vx.text(), slow["b"].vx.text()] == ["1/2", "1/2"]
    assert run.stop.reason is StopReason.HORIZON


def test_elastic_ones_slide_to_and_fro() -> None:
    right = Wall(5, 0, 5, 1, id="right")
    run = ran([Circle(0, 1, vx=1, id="a"), Circle(3, 1, id="b")], right, e=1, until=12)
    assert told(run) == [("1", [("a", "b")]), ("2", [("b", "right")]), ("3", [("a", "b")])]
    assert run.final["a"].x.text() == "-8"
    assert [s.circle for s in run.settlings] == ["a", "b"]


def test_what_is_struck_leaves_and_may_come_back() -> None:
    run = ran([Circle(0, 1, id="low"), Circle("1/2", 9, m=2, id="high")], e=1, until=2)
    first = run.events[0]
    assert [tuple(link) for link in first.impulses][:2] == [("low", "high"), ("low", "floor")]
    assert float(run.at(first.time)["low"].vy) > 1
    assert differs(run, run.scene) == ""


def test_samples_are_the_states() -> None:
    run = ran([Circle(0, 6, vx=1, id="a"), Circle(9, 1, vx=-1, id="b"), Circle(-9, 9, id="c")], until=7)
    times = [k / 16 for k in range(113)]
    states = np.array([run.at(time).array() for time in times])
    assert np.abs(run.sample(times) - states).max() < 1e-12
    assert len(run.settlings) >= 3


def test_a_corner_and_a_platform_hold_what_comes_to_rest() -> None:
    corner = ran([Circle(1, 3, id="ball")], Wall(0, 0, 0, 1, id="left"))
    assert [s.wall for s in corner.settlings] == ["floor"]
    platform = Segment(-2, 3, 2, 3, id="platform")
    scene = Scene([Circle(0, 9, id="ball"), Circle(0, 14, r="1/2", vx="1/2", id="next")], segments=[platform],
                  gravity=DOWN, restitution=0, settle=True)  # fmt: skip
    run = ExactEngine().run(scene, until=1.4)
    assert [(s.circle, s.wall) for s in run.settlings] == [("ball", "platform")]
    sliding = scene.with_changes(circles=[Circle(0, 9, vx=1, id="ball")])
    stopped = ExactEngine().run(sliding, until=9).stop
    assert stopped.reason is StopReason.REST
    assert stopped.message.endswith("ball and platform, a face, along which it slides: it would come to its end")


def test_a_slope_and_a_stack_end_by_name() -> None:
    end, slope = Wall(30, 0, 30, 1, id="end"), Wall(0, 0, 4, -1, id="slope")
    slope = Scene([Circle(0, 9, id="ball")], [slope, end], gravity=DOWN, restitution=0, settle=True)
    stop = ExactEngine().run(slope, until=9).stop
    told = "at rest: a circle stands on what gravity pulls it to: ball and slope"
    assert stop.reason is StopReason.REST
    assert stop.message == f"{told}, a slope, along which it slides: it is not proved that nothing meets it there"
    level = slope.with_changes(walls=[Wall(0, 0, 4, 0, id="floor")], settle=False)
    assert ExactEngine().run(level, until=9).stop.message == told.replace("slope", "floor")
    on_top = ran([Circle(0, 1, id="low"), Circle(0, 3, id="high")]).stop
    assert (on_top.reason, on_top.message.split(": ")[-1]) == (StopReason.REST, "low and high")
    struck = ran([Circle(0, 1, id="low"), Circle(0, 9, id="high")]).stop
    assert struck.reason is StopReason.UNDECIDED
    assert struck.message.split(": ")[1] == "what happens next could not be proved"


def test_what_bounces_infinitely_often_settles_and_the_run_goes_on() -> None:
    run = ran([Circle(0, 6, vx="1/3", id="ball"), Circle(9, 1, id="other"), Circle(6, 1, id="b")], e="1/2", until=20)
    assert run.stop.reason is StopReason.HORIZON
    settled = {rest.circle: rest for rest in run.settlings}
    assert (settled["ball"].time.text(), settled["other"].since, settled["other"].time.text()) == ("3", None, "0")
    bounces = [event for event in run.events if event.impulses == (("ball", "floor"),)]
    assert settled["ball"].since is not None
    assert (settled["ball"].since.text(), len(bounces)) == (bounces[-1].time.text(), 21)
    assert [event.time.text() for event in run.events[21:]] == ["12", "16"], "it rolls at 1/3 over 4 to b, that at 1/4"
    assert [circle.vx.text() for circle in run.final.circles] == ["1/12", "3/16", "1/16"]


def bounce_height(time: Fraction) -> tuple[Fraction, Fraction]:
    """How high a ball is at a time, and how fast, that falls by 5 under a pull of 10 with restitution 1/2."""
    start, up = Fraction(1), Fraction(5)
    while time >= start + up / 5:
        start, up = start + up / 5, up / 2
    lag = time - start
    return (up - 5 * lag) * lag, up - 10 * lag


@pytest.mark.parametrize("left", ["1/1000", "1/1000000", "1/3000000", "1/2100000", "1/10000000000000000", "1/33554432"])
def test_it_bounces_on_until_it_rests(left: str) -> None:
    run = ran([Circle(0, 6, vx="1/3", id="ball")], e="1/2", until=20)
    time = 3 - Fraction(left)
    height, speed = bounce_height(time)
    ball = run.at(time)["ball"]
    assert ball.x.text() == str(time / 3)
    assert (ball.y.text(), ball.vy.text()) == (str(1 + height), str(speed))
    assert run.sample([float(time)])[0, 0, 1] == pytest.approx(float(1 + height), rel=1e-15)
    for engine in FINITE[:-1]:
        shown = engine.run(run.scene, until=20).at(float(time))["ball"]
        assert float(shown.y) - 1 == pytest.approx(float(height), abs=1e-6 if engine.name == "single" else 1e-13)
        assert float(shown.vy) == pytest.approx(float(speed), abs=2e-3 if engine.name == "single" else 1e-6)
    known = IntervalEngine(200).run(run.scene, until=20).at(Quantity.of(time))["ball"]
    assert known.y.ball(200).overlaps(arb(fmpq(*(1 + height).as_integer_ratio())))
    assert known.vy.ball(200).overlaps(arb(fmpq(*speed.as_integer_ratio())))


def test_at_a_bounce_that_is_not_listed_it_leaves() -> None:
    """Also where its time is a root."""
    run = ran([Circle(0, 3, vx="1/3", id="ball")], e="1/2", until=20)
    first, gone = Quantity.of("sqrt(2/5)"), 1 - Quantity.of("1/2") ** 25
    ball = run.at(first + 2 * first * gone)["ball"]
    assert (ball.y.text(), ball.vy.digits(20)) == ("1", (10 * first * Quantity.of("1/2") ** 26).digits(20))


def test_amid_its_bounces_it_is_at_times_of_another_run_where_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """That lists more of the bounces, or has an event between two that neither lists."""
    discs = [Circle(0, 6, vx="1/3", id="ball")]
    run = ran(discs, e="1/2", until=20)
    falls = Fraction(2999999, 1000000)
    late = ran([Circle(9, str(1 + 5 * falls**2), id="b")], e=0).events[0].time
    monkeypatch.setattr(endings, "SHRUNK", 24)
    fine = ran([*discs, Circle(9, 1, id="other")], e="1/2", until=20)
    listed = [event.time for event in fine.events if float(event.time) > float(run.events[-1].time)]
    assert len(listed) == 4
    for time in [*listed, late]:
        height, speed = bounce_height(Fraction(time.text()))
        ball = run.at(time)["ball"]
        assert [float(ball.x), float(ball.y), float(ball.vx), float(ball.vy)] == [
            float(number) for number in (Fraction(time.text()) / 3, 1 + height, Fraction(1, 3), speed)
        ]


def test_a_run_that_ends_before_tells_of_no_rest() -> None:
    run = ran([Circle(0, 6, id="ball")], e="1/2", until="2999999/1000000")
    assert (run.stop.reason, run.settlings) == (StopReason.HORIZON, ())
    height, _ = bounce_height(Fraction("2999999/1000000"))
    assert run.final["ball"].y.text() == str(1 + height)
    alone = ran([Circle(0, 6, id="ball")], e="1/2")
    assert (alone.stop.reason, alone.final_time.text(), alone.final["ball"].vy.text()) == (StopReason.QUIET, "3", "0")
    again = run_of(saved_run(alone))
    assert again is not None
    assert (again.final_time.text(), again.settlings[0].since.text()) == ("3", alone.events[-1].time.text())
    assert again.at("2999999/1000000")["ball"].y.text() == str(1 + height)


def test_it_settles_in_a_corner_and_bounces_between_walls_meanwhile() -> None:
    """A push of a wall at right angles changes nothing of how it comes to rest."""
    sides = [Wall(-4, 0, -4, 1, id="left"), Wall(4, 0, 4, 1, id="right")]
    run = ran([Circle(-3, 6, id="corner"), Circle(0, 6, vx=7, id="ball")], *sides, e="1/2", until=2)
    assert run.settlings == ()
    run = ran([Circle(-3, 6, id="corner"), Circle(1, 6, vx="3/2", id="ball")], *sides, e="1/2", until=40)
    assert sorted((rest.circle, rest.time.text()) for rest in run.settlings) == [("ball", "3"), ("corner", "3")]
    pushes = [
        tuple(link) for event in run.events for link in event.impulses if "ball" in link and float(event.time) < 3
    ]
    assert ("ball", "right") in pushes
    assert run.stop.reason is StopReason.HORIZON


def test_down_a_slope_it_slides_after_its_bounces() -> None:
    """Place along the slope is that of a fall, whatever the bounces; across it they are those of a pull of 8."""
    slope = Wall(0, 0, 4, -3, id="slope")
    scene = Scene([Circle("3/5 + 12/5", "4/5 + 16/5", id="a")], [slope], gravity=DOWN, restitution="1/2", settle=True)
    run = ExactEngine().run(scene, until=9)
    assert run.settlings[0].time.text() == "3", "falls by 4 across the slope: 1, and 2 more"
    end = run.final["a"]
    along, across = Quantity.of("4/5"), Quantity.of("3/5")
    assert (along * Quantity.of(end.x.text()) - across * Quantity.of(end.y.text())).text() == str(6 * 81 // 2)
    assert (across * Quantity.of(end.x.text()) + along * Quantity.of(end.y.text())).text() == "1"
    for engine in FINITE[:-1]:
        assert engine.run(scene, until=9).settlings[0].circle == "a", engine.name


def test_where_something_comes_near_the_bounces_are_told_until_it_is_past() -> None:
    """Another disc that comes to the place at the very end of the bounces leaves nothing proved."""
    run = ran([Circle(0, 6, id="ball"), Circle(5, 1, vx=-1, id="other")], e="1/2", until=9)
    assert run.stop.reason is StopReason.UNDECIDED
    assert "accumulation suspected" in run.stop.message
    run = ran([Circle(0, 6, id="ball"), Circle("5 + 10**-14", 1, vx=-1, id="other")], e="1/2", until=9)
    assert run.stop.reason is StopReason.HORIZON
    bounces = sum(event.impulses == (("ball", "floor"),) for event in run.events)
    assert bounces > 24, "21 are told at least; the other is within reach for longer"
    assert run.settlings[1].time.text() == "3"


BOUNCING = [5, 7, 9, 12, 25]


@pytest.mark.parametrize("shrunk", [20, 2])
def test_the_referee_agrees_after_infinitely_many_bounces(shrunk: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where a wall carries a circle as soon as it is proved that nothing else meets it."""
    monkeypatch.setattr(endings, "SHRUNK", shrunk)
    counts = Counter[str]()
    found = [f"{seed}: {told}" for seed in BOUNCING if (told := examined(seed, counts, bouncing))]
    assert not found
    assert counts["after infinitely many bounces"] >= 8


@pytest.mark.parametrize(
    ("of", "name", "fault"),
    [
        (instant, "leaves_as_is", lambda *_: True),
        (Carrier, "carry", lambda self, link, bounces=False: SETTLES(self, link, bounces=False)),
    ],
)
def test_planted_faults_of_bounces_are_found(
    of: Any, name: str, fault: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(of, name, fault)
    for seed in BOUNCING:
        try:
            if examined(seed, Counter(), bouncing):
                return
        except AssertionError:
            return
    raise AssertionError("the fault was not found")


SETTLES = Carrier.carry


def test_histories_that_list_more_of_the_bounces_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = Scene([Circle(0, 6, vx="1/3", id="ball"), Circle(6, 1, id="b")], [FLOOR], gravity=DOWN, restitution="1/2",
                  settle=True)  # fmt: skip
    run = ExactEngine().run(scene, until=60)
    for shrunk in (10, 30):
        with monkeypatch.context() as change:
            change.setattr("truebreak.exact.simulation.endings.SHRUNK", shrunk)
            other = DoubleEngine().run(scene, until=60)
        assert len(other.events) != len(run.events)
        assert align(run, other).divergence is None
        assert align(other, run).divergence is None
    missed = replace(other, events=[event for event in other.events if tuple(event.impulses[0]) != ("ball", "b")])
    assert align(run, missed).divergence is not None


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"gravity": None},
            "settle = true: without gravity nothing is at rest on a wall; write gravity, or leave settle out",
        ),
        ({"reverse_at": 3}, "settle = true: cannot be turned back, as what has settled stays; leave reverse_at out"),
        (
            {"reverse_after": 3},
            "settle = true: cannot be turned back, as what has settled stays; leave reverse_after out",
        ),
        (
            {"walls": [Wall(0, 0, 1, 0, vy=1, id="lift")]},
            "settle = true: wall 'lift' moves, and what has settled is not followed beside it; leave settle out",
        ),
        (
            {"arcs": [Arc(0, -9, 2, full=True, id="ring")]},
            "settle = true: arc 'ring' is round, and what has settled is not followed beside it; leave settle out",
        ),
        (
            {"pockets": [Pocket(0, 9, 2, id="hole")]},
            "settle = true: pocket 'hole' is round, and what has settled is not followed beside it; leave settle out",
        ),
        ({"settle": 1}, "settle = 1 is not true or false"),
    ],
)  # fmt: skip
def test_what_it_has_no_meaning_for_is_refused(change: dict[str, object], message: str) -> None:
    scene = Scene([Circle(0, 6)], [FLOOR], gravity=DOWN, settle=True)
    with pytest.raises(SceneError) as refused:
        scene.with_changes(**change)
    assert str(refused.value) == message


def test_files_and_saved_runs_keep_it() -> None:
    run = ran([Circle(0, 6, vx=1, id="a"), Circle(9, 1, vx=-1, id="b")], until=9)
    assert loads_toml(dump_toml(run.scene), "x") == run.scene == loads_json(dump_json(run.scene), "x")
    assert run.scene != run.scene.with_changes(settle=False)
    again = run_of(saved_run(run))
    assert [(s.circle, s.wall, s.time.text()) for s in again.settlings] == [
        (s.circle, s.wall, s.time.text()) for s in run.settlings
    ]
    assert again.at("17/2")["a"].x.digits(30) == run.at("17/2")["a"].x.digits(30)
    steps = again.motion.log.steps
    assert Settle(1, 0, True) in steps
    assert Lift(0) in steps


def test_a_printed_run_says_what_has_settled(capsys: pytest.CaptureFixture[str]) -> None:
    ball, floor = Circle(0, 6, vx=1, id="ball"), Wall(0, 0, 1, 0, id="floor")
    scene = Scene([ball], [floor], gravity=(0, -10), restitution=0, settle=True)
    print_trajectory(ExactEngine().run(scene), exact=True, watch=Clock(None))
    assert "settled: ball on floor at time 1\n" in capsys.readouterr().out


def test_engines_that_do_not_follow_it_say_so() -> None:
    scene = Scene([Circle(0, 6)], [FLOOR], gravity=DOWN, restitution=0, settle=True)
    found = compare(scene, [SymbolicEngine()], until=9)
    assert [row.diagnosis.finding for row in found.candidates] == ["cannot run this scene: it does not follow 'settle'"]
    with pytest.raises(SceneError) as refused:
        SymbolicEngine().run(scene, until=9)
    remedy = "does not follow what has settled; use exact, or leave settle out"
    assert str(refused.value) == f"settle = true: engine 'sympy' {remedy}"


def test_what_falls_is_reckoned_from_the_instant_at_which_another_settles(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where a slides, reckoned back to time 0, another one was."""
    both = [Circle(8, 6, vx=-8, id="a"), Circle("17/2", 2, r="1/2", vy=9, id="b")]
    run = ran(both, until=3)
    assert differs(run, run.scene) == ""
    assert len(run.settlings) == 2
    monkeypatch.setattr(Carrier, "anchored", _anchors_nothing)
    assert len(ran(both, until=3).settlings) == 1


# -- Against the referee.

SEEDS = [*range(0, 60)]


def test_the_referee_agrees() -> None:
    counts = Counter[str]()
    found = [f"{seed}: {told}" for seed in SEEDS if (told := examined(seed, counts))]
    assert not found
    assert counts["compared"] > 40
    assert counts["settlings"] > 50


def _forgets_its_velocity(self: ReplayState, index: int) -> None:
    body = self.bodies[index]
    body.flight = body.flight._replace(vx=self.zero)
    LIFT(self, index)


def _slides_backwards(self: ReplayState, index: int, wall: int, slides: bool, bounces: bool, other: int = -1) -> None:
    SETTLE(self, index, wall, slides, bounces)
    body = self.bodies[index]
    body.flight = body.flight._replace(vx=-body.flight.vx)


def _keeps_falling(self: ReplayState, index: int, wall: int, slides: bool, bounces: bool, other: int = -1) -> None:
    SETTLE(self, index, wall, slides, bounces)
    body = self.bodies[index]
    body.flight = body.flight._replace(vy=self.one / (self.one + self.one))


def _starts_from_zero(self: ReplayState, index: int) -> None:
    LIFT(self, index)
    body = self.bodies[index]
    body.flight = body.flight._replace(vx=self.zero, vy=self.zero)


def _anchors_nothing(self: Carrier, at_hand: object) -> set[int]:
    found = ANCHORED(self, range(len(self._scene.circles)))
    return found & set(self.walls)


LIFT, SETTLE, ANCHORED = ReplayState.lift, ReplayState.settle, Carrier.anchored


@pytest.mark.parametrize(
    ("of", "name", "fault"),
    [
        (ReplayState, "lift", _forgets_its_velocity),
        (ReplayState, "lift", _starts_from_zero),
        (ReplayState, "settle", _slides_backwards),
        (ReplayState, "settle", _keeps_falling),
    ],
)
def test_planted_faults_are_found(of: type, name: str, fault: object, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(of, name, fault)
    for seed in SEEDS:
        try:
            if examined(seed, Counter()):
                return
        except AssertionError:
            return  # a circle that was to come does not, or comes unseen
    pytest.fail("not found")


def test_scenes_are_drawn_with_what_matters() -> None:
    scenes = [scene for seed in SEEDS if (scene := drawn(seed)) is not None]
    assert any(circle.fixed for scene in scenes for circle in scene.circles)
    assert any(len(scene.walls) > 2 for scene in scenes)
    assert settle_campaign.EVENTS > 9


# -- Engines of finite precision, against the certified run.

FINITE = DoubleEngine(), SingleEngine(), QuadEngine(), RoundedEngine(bits=40), IntervalEngine()


@pytest.mark.parametrize("engine", FINITE, ids=lambda engine: engine.name)
def test_engines_of_finite_precision_settle_slide_are_struck_and_leave(engine: Engine) -> None:
    for name in ("landing", "landing:h=45,v=7,m=1/4", "struck:n=2"):
        scene = catalogue.build(name)
        true, run = (one.run(scene, events=4) for one in (ExactEngine(), engine))
        if engine.name == "interval":  # which does not know that two move together from then on
            true = ExactEngine().run(scene, events=len(run.events))
            assert len(run.events) >= 2
        assert [e.impulses for e in run.events] == [e.impulses for e in true.events]
        assert [(s.circle, s.wall) for s in run.settlings] == [(s.circle, s.wall) for s in true.settlings]
        for mine, theirs in zip(run.settlings, true.settlings, strict=True):
            assert float(mine.time) == pytest.approx(float(theirs.time), abs=1e-5)
        end = min(float(run.final_time), float(true.final_time))
        for time in (end * k / 16 for k in range(16)):
            for mine, theirs in zip(run.at(time).circles, true.at(time).circles, strict=True):
                assert float(mine.y) == pytest.approx(float(theirs.y), abs=1e-4)
                assert float(mine.x) == pytest.approx(float(theirs.x), abs=1e-4)


def test_what_settles_in_doubles_is_where_its_wall_has_it() -> None:
    """Else two that slide at one height would push each other into the floor by rounding, at 53 bits and at 106."""
    discs = [Circle(0, "31/10", r="1/3", vx=2, id="a"), Circle(8, "57/10", r="1/3", id="b")]
    scene = Scene(discs, [Wall(0, 0, 7, 0, "floor")], gravity=(0, "-981/100"), restitution=0, settle=True)
    for engine in FINITE[:-1]:
        run = engine.run(scene)
        assert [e.impulses for e in run.events][2:] == [(("a", "b"),)], engine.name


def test_a_comparison_says_what_has_settled_and_who_has_it_otherwise(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = catalogue.build("struck:n=6")
    found = compare(scene, [DoubleEngine(), SingleEngine(), IntervalEngine(), PymunkEngine()])
    four = ", ".join(f"d{k} on floor at time 0" for k in range(1, 5))
    others = "the same in double, single and interval; at other times in pymunk"
    assert settled_phrase(found) == f"{four} and 2 more; {others}"
    assert [c.alignment.verdict for c in found.candidates] == ["agree", "agree", "undecided", "diverged"]
    kept = {c.engine: c.laws.kept for c in found.candidates if c.laws is not None}
    assert kept.pop("pymunk", None) is None
    assert len(kept) == 3
    assert all(kept.values())
    print_comparison(found)
    assert f"settled: {four}" in " ".join(capsys.readouterr().out.split())
    assert f"{four} and 2 more" in html_report(found)
    monkeypatch.setattr(plain, "_settlings", lambda *_: ())
    assert settled_phrase(compare(scene, [DoubleEngine()])).endswith("; otherwise in double")
    apart = scene.with_changes(settle=False, walls=[], gravity=None)
    assert settled_phrase(compare(apart, [DoubleEngine()])) == ""


def test_they_stop_where_the_certified_run_does() -> None:
    stack = Scene([Circle(0, 1, id="low"), Circle(0, 3, id="high")], [FLOOR], gravity=DOWN, restitution=0, settle=True)
    for engine in FINITE:
        assert engine.run(stack).stop.reason is StopReason.REST, engine.name
    ledge = Segment(-9, 0, 9, 0, id="ledge")
    bounce = Scene([Circle(0, 6, vx="1/9", id="ball")], segments=[ledge], gravity=DOWN, restitution="1/2", settle=True)
    for engine in (ExactEngine(), *FINITE[:-1]):
        run = engine.run(bounce)
        assert run.stop.reason is StopReason.ACCUMULATION, f"{engine.name}: it slides to the end of the ledge"
        assert float(run.ending or 0) == pytest.approx(3, abs=1e-5)


def test_engines_agree_and_intervals_contradict_nothing() -> None:
    counts = Counter[str]()
    assert not [f"{seed}: {what}" for seed in SEEDS[:30] if (what := engines_differ(seed, counts))]
    assert counts["double: settlings"] > 20
    assert counts["interval of 53 bits: events"] > 100


def test_in_the_mirror_in_another_order_and_frame_all_is_the_same() -> None:
    counts = Counter[str]()
    assert not [f"{seed}: {what}" for seed in range(20) if (what := guises_differ(seed, counts))]
    assert min(counts[name] for name in ("mirrored", "reversed", "moving")) > 0


def _sinks(self: PlainState[Any], index: int, wall: int, slides: bool, bounces: bool, other: int = -1) -> None:
    PLAIN_SETTLE(self, index, wall, slides, bounces)
    body = self.bodies[index]
    body.flight = body.flight._replace(y=body.flight.y + self.one)


PLAIN_SETTLE = PlainState.settle


@pytest.mark.parametrize(
    ("of", "name", "fault"),
    [
        (PlainState, "settle", _sinks),
        (PlainState, "settle", _slides_backwards),
        (PlainState, "lift", lambda self, index: None),
        (plain, "carried_knots", lambda history: {}),
        (plain, "_settlings", lambda *_: ()),
    ],
)
def test_planted_faults_in_finite_precision_are_found(
    of: Any, name: str, fault: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(of, name, fault)
    for seed in SEEDS:
        try:
            if engines_differ(seed, Counter()):
                return
        except AssertionError:
            return
    pytest.fail("not found")
