"""Walls that move: against a referee in true coordinates, what the laws say, faults that must be found."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path
from random import Random

import pytest
from gravity_referee import GravityReferee, TieMet
from mpmath import mpf, workdps

from truebreak.compare.adapters.mujoco import MujocoEngine
from truebreak.compare.audit.audit import audit_run
from truebreak.compare.chaos.certified_chaos import chaos
from truebreak.compare.deadline import Clock
from truebreak.compare.grids.row import energy_drift, energy_gained
from truebreak.compare.report.documents import trajectory_json
from truebreak.compare.report.floats import floats_csv
from truebreak.compare.report.listing import print_trajectory
from truebreak.compare.report.player import played
from truebreak.compare.validation import unsupported
from truebreak.exact import ExactEngine
from truebreak.exact.literal.symbolic_engine import SymbolicEngine
from truebreak.exact.replay import wall_flights
from truebreak.exact.replay.state import Flights, ReplayState
from truebreak.exact.replay.wall_flights import SeenWall
from truebreak.exact.simulation import prediction
from truebreak.floating import DoubleEngine, IntervalEngine, PymunkEngine, QuadEngine, SingleEngine
from truebreak.scenarios import Circle, Quantity, Scene, SceneError, Segment, StopReason, Wall, catalogue, pictures
from truebreak.scenarios.files import dump_json, dump_toml, loads_json, loads_toml
from truebreak.scenarios.pictures import as_at

UNTIL, EVENTS = 12, 14

PULLS = (None, None, None, (0, -10), (0, -1), ("1/3", "-1/2"), (3, 0), ("-sqrt(2)", "1/7"), (0, "1/100"))

PACES = ((0, 1), (0, -1), ("1/3", 0), ("-2/7", "5/11"), ("sqrt(2)/9", "-1/10"), (-3, "1/2"), (0, 0), (0, 0))

LOSSES = ("1", "1", "1", "9/10", "1/2", "99/100", "sqrt(2)/2")


def _draw(rng: Random, low: int, high: int, under: int) -> Quantity:
    return Quantity.of(f"{rng.randint(low * under, high * under)}/{under}")


def scene_of(seed: int) -> Scene | None:
    """Discs off any grid, walls that move, gravity, restitution; None where what it draws is refused."""
    rng = Random(f"moving {seed}")
    discs = [
        Circle(
            3 * (k % 3) - 3 + _draw(rng, -1, 1, 97) / 2,
            3 * (k // 3) - 2 + _draw(rng, -1, 1, 89) / 2,
            r=f"{rng.randint(30, 100)}/101",
            m=rng.choice(("1", "2", "1/3")),
            vx=rng.choice((0, _draw(rng, -3, 3, 31))),
            vy=rng.choice((0, _draw(rng, -3, 3, 37))),
            id=f"c{k}",
        )
        for k in range(rng.randint(1, 5))
    ]
    floor = rng.choice(([0, -6, 1, -6], [-9, -8, 9, -7], [-9, -6, 9, "-13/2"], [9, -6, -9, "-13/2"]))
    right = [7, 0, "29/4" if rng.random() < 0.5 else 7, 9]
    kinds = {
        "floor": {"floor": floor},
        "box": {"floor": floor, "top": [0, 6, 1, 6], "left": [-7, 0, -7, 1], "right": right},
        "wedge": {"up": [0, -9, 5, -4], "down": [0, -9, -4, -4]},
        "shaft": {"left": [-6, 0, -6, 1], "right": [6, 0, 6, 1]},
    }
    lines = kinds[rng.choice(("floor", "box", "box", "wedge", "shaft"))]
    walls = []
    for name, points in lines.items():
        vx, vy = rng.choice(PACES)
        walls.append(Wall(*points, id=name, vx=vx, vy=vy))
    try:
        return Scene(discs, walls, gravity=rng.choice(PULLS), restitution=rng.choice(LOSSES), name=f"moving {seed}")
    except SceneError:
        return None


def differs(scene: Scene, events: int = EVENTS, until: int = UNTIL) -> str | None:
    """How the exact engine and the referee part; empty where they agree, None where the referee does not take it."""
    try:
        told = GravityReferee(scene).run(mpf(until), events)
    except TieMet:
        return None
    run = ExactEngine().run(scene, until=until, events=events)
    if run.stop.reason is StopReason.CRUSHED:
        del told.hits[len(run.events) :]
    elif not run.certified:
        return run.stop.message
    with workdps(60):
        for mine, theirs in zip(told.hits, run.events, strict=False):
            if [tuple(pair) for pair in theirs.contacts] != [mine.pair]:
                return f"event {theirs.index}: {theirs.contacts}, not {mine.pair}"
            if abs(mpf(theirs.time.digits(60)) - mine.time) > mpf(10) ** -40:
                return f"event {theirs.index} at {float(theirs.time)}, not {float(mine.time)}"
        if len(told.hits) != len(run.events):
            return f"{len(run.events)} events, not {len(told.hits)}: {run.stop.message}"
        if run.stop.reason is StopReason.CRUSHED:
            return ""
        for circle, disc in zip(run.final.circles, told.bodies, strict=True):
            pairs = zip((circle.x, circle.y, circle.vx, circle.vy), (disc.x, disc.y, disc.vx, disc.vy), strict=True)
            if any(abs(mpf(a.digits(60)) - b) > mpf(10) ** -35 for a, b in pairs):
                return f"{circle.id} ends elsewhere"
    return ""


SEEDS = range(120)


def test_scenes_agree_with_the_referee():
    found = {seed: told for seed in SEEDS if (scene := scene_of(seed)) and (told := differs(scene)) is not None}
    assert len(found) > 100
    assert {seed: told for seed, told in found.items() if told} == {}


# -- Faults that the comparison must find.


def _paces(change):
    """Other velocities of walls than the scene's."""

    def spoil(monkeypatch):
        known = Flights.__init__

        def made(self, scene, numbers, only=None):
            known(self, scene, numbers, only)
            self.drifts = {k: change(*pace) for k, pace in self.drifts.items()}

        monkeypatch.setattr(Flights, "__init__", made)

    return spoil


def _place(change):
    """Another place of a wall at a time."""
    return lambda monkeypatch: monkeypatch.setattr(SeenWall, "moved", change)


def _bounce(share):
    """An impulse in which the wall's velocity counts so often."""

    def spoil(monkeypatch):
        plain = ReplayState.bounce_wall

        def bounced(state, link):
            plain(state, link)
            drift = state.drifts.get(link.wall)
            if drift is not None:
                body, line = state.bodies[link.circle], state.line(*link[:2])
                more = (line.nx * drift[0] + line.ny * drift[1]) * (share - 1) / line.nn
                more = more + more if state.share is None else (more + more) * state.share
                state._turn(body, line.nx * more, line.ny * more)

        monkeypatch.setattr(ReplayState, "bounce_wall", bounced)

    return spoil


def _other_zero(monkeypatch):
    """Of two zeros the one at which the gap grows."""
    for place in (prediction, wall_flights):
        monkeypatch.setattr(place, "fall_time_back", lambda approach, half, root: (root - approach) / (half + half))


FAULTS = {
    "the other sign of u": _paces(lambda ux, uy: (-ux, -uy)),
    "u along y alone": _paces(lambda ux, uy: (ux - ux, uy)),
    "u off by 1e-9": _paces(lambda ux, uy: (ux + ux / 10**9, uy + uy / 10**9)),
    "half of u": _paces(lambda ux, uy: (ux / 2, uy / 2)),
    "a wall that stands, and pushes as if it moved": _place(lambda self, drift, time: self),
    "a wall that moves twice as far": _place(
        lambda self, u, t: self._replace(x0=self.x0 + (u[0] + u[0]) * t, y0=self.y0 + (u[1] + u[1]) * t)
    ),
    "a wall that moves backwards": _place(
        lambda self, u, t: self._replace(x0=self.x0 - u[0] * t, y0=self.y0 - u[1] * t)
    ),
    "u forgotten in the impulse": _bounce(0),
    "u twice in the impulse": _bounce(2),
    "the other zero": _other_zero,
}


@pytest.mark.usefixtures("unfiltered")
@pytest.mark.parametrize("fault", FAULTS)
def test_a_planted_fault_is_found(fault: str, monkeypatch: pytest.MonkeyPatch):
    FAULTS[fault](monkeypatch)
    assert any(_found(scene) for seed in range(60) if (scene := scene_of(seed)))


def _found(scene: Scene) -> bool:
    try:
        return bool(differs(scene, events=8))
    except (AssertionError, ArithmeticError):
        return True


# -- What the laws say.


def closing(e: str = "1", **more: object) -> Scene:
    """A disc between a wall that stands and one that comes, which leave no room at 7/2."""
    walls = [Wall(0, 0, 0, 1, id="left"), Wall(9, 0, 9, 1, id="right", vx=-2)]
    return Scene([Circle(3, 0, vx=1, id="c")], walls, restitution=e, **more)


@pytest.mark.parametrize("e", ["1", "1/2", "0"])
@pytest.mark.parametrize("engine", [ExactEngine(), DoubleEngine(), QuadEngine(), IntervalEngine(300)])
def test_a_disc_between_walls_that_close_is_crushed_at_the_exact_time(engine, e):
    run = engine.run(closing(e), until=4)
    assert run.stop.reason is StopReason.CRUSHED
    assert run.stop.message.endswith("room for a circle: c between left and right at 3.5")
    assert run.ending is not None
    assert abs(float(run.ending) - 3.5) < 1e-12
    assert float(run.final_time) < 3.5


def test_the_width_that_is_left_at_each_bounce_has_a_closed_form():
    run = ExactEngine().run(closing(), until=4)
    assert run.ending.text() == "7/2"
    right = [event.time for event in run.events if event.contacts[0].second == "right"]
    left = [Quantity.of(7) - 2 * Quantity.of(time.text()) for time in right]
    speeds = [5 + 4 * n for n in range(len(left))]  # v grows by twice the wall's speed, 2, at each
    assert {width * (speed - 2) for width, speed in zip(left, speeds, strict=True)} == {left[0] * 3}
    assert [Quantity.of(run.at(time)["c"].vx.text()) for time in right] == [-speed for speed in speeds]


def test_no_event_is_lost_where_the_run_is_to_end_before_the_circle_is_crushed():
    before = ExactEngine().run(closing(), until="349/100")
    assert before.stop.reason is StopReason.HORIZON
    crushed = ExactEngine().run(closing(), until="351/100")
    assert crushed.stop.reason is StopReason.CRUSHED
    times = [event.time.text() for event in crushed.events]
    assert len(times) < len(before.events)
    assert [event.time.text() for event in before.events[: len(times)]] == times


def test_others_that_are_far_along_the_walls_are_no_hindrance_and_those_near_are():
    scene = closing()
    far = scene.with_changes(circles=[*scene.circles, Circle(5, 40, vy=1, id="d")])
    run = ExactEngine().run(far, until=4)
    assert run.stop.reason is StopReason.CRUSHED
    near = scene.with_changes(circles=[scene.circles[0], Circle("11/2", 0, id="d")])
    run = ExactEngine().run(near, until=4)
    assert run.stop.reason is StopReason.UNDECIDED
    assert "accumulation suspected: between surfaces that close" in run.stop.message
    assert float(run.final_time) < 2.5  # two of width 2 each have no room in one line from then on
    crossed = scene.with_changes(walls=[*scene.walls, Wall(0, 2, 1, 2, id="top")])
    far_off = scene.with_changes(walls=[*scene.walls, Wall(0, 9, 1, 9, id="top")])
    assert ExactEngine().run(far_off, until=4).stop.reason is StopReason.CRUSHED
    assert ExactEngine().run(crossed, until=4).stop.reason is StopReason.CRUSHED
    bound = scene.with_changes(circles=[Circle(3, 0, vx=1, vy=1, id="c")], walls=crossed.walls)
    run = ExactEngine().run(bound, until=4)
    assert [event.contacts[0].second for event in run.events].count("top") == 1


def test_a_disc_that_touches_a_wall_for_long_is_crushed_as_the_other_comes():
    scene = closing().with_changes(circles=[Circle(1, 0, vy=1, id="c")])
    run = ExactEngine().run(scene, until=4)
    assert (run.stop.reason, len(run.events), run.ending.text()) == (StopReason.CRUSHED, 0, "7/2")
    with pytest.raises(SceneError, match="circle 'c': walls 'left' and 'right' touch it and close at time 0"):
        scene.with_changes(walls=[scene.walls[0], Wall(2, 0, 2, 1, id="right", vx=-2)])


def test_a_wall_of_two_that_are_not_parallel_crushes_nothing():
    walls = [Wall(0, 0, 1, 1, vy=1), Wall(0, 0, -1, 1, vy=1)]
    run = ExactEngine().run(Scene([Circle(0, 5)], walls), until=9)
    assert (run.scene.closing, run.stop.reason) == ((), StopReason.HORIZON)
    assert [event.time.text() for event in run.events] == ["-sqrt(2) + 5"]


def test_bounces_on_a_floor_that_moves_end_as_on_one_that_stands():
    """A lift: everything is as seen from it."""
    for u in ("0", "3", "-1/2"):
        run = ExactEngine().run(
            Scene([Circle(0, 6, vy=u)], [Wall(0, 0, 1, 0, vy=u)], gravity=(0, -10), restitution="1/2"), until=9
        )
        assert (run.stop.reason, run.ending.text(), len(run.events)) == (StopReason.ACCUMULATION, "3", 21)
    rests = ExactEngine().run(Scene([Circle(0, 1, vy=2)], [Wall(0, 0, 1, 0, vy=2)], gravity=(0, -10)), until=3)
    assert rests.stop.reason is StopReason.REST


def test_what_moves_along_itself_changes_nothing():
    still, moving = (
        ExactEngine().run(Scene([Circle(0, 6, vx=1)], [Wall(0, 0, 1, 0, vx=u)], gravity=(0, -10)), events=4)
        for u in (0, 7)
    )
    assert [e.time.text() for e in still.events] == [e.time.text() for e in moving.events]


def test_bounces_on_one_wall_come_at_equal_intervals():
    run = ExactEngine().run(Scene([Circle(0, 6)], [Wall(0, 0, 1, 0, vy=1)], gravity=(0, -10)), events=9)
    first, second, *others = [Quantity.of(event.time.text()) for event in run.events]
    assert first == Quantity.of("(sqrt(101) - 1)/10")
    assert [time - before for before, time in zip([second, *others], others, strict=False)] == [second - first] * 7


def test_a_symmetric_scene_stays_symmetric_and_one_whose_walls_do_not_does_not():
    discs = [Circle(-3, "1/3", vx="-sqrt(3)", vy="sqrt(2)"), Circle(3, "1/3", vx="sqrt(3)", vy="sqrt(2)")]
    sides = [Wall(-6, 0, -6, 1, vx="1/7"), Wall(6, 0, 6, 1, vx="-1/7")]
    run = ExactEngine().run(Scene(discs, sides), events=12)
    assert all(len(event.contacts) == 2 or event.contacts[0] == ("c1", "c2") for event in run.events)
    assert run.certified
    odd = Scene(discs, [sides[0], Wall(6, 0, 6, 1, vx="-1/8")])
    assert len(ExactEngine().run(odd, events=3).events[0].contacts) == 1


# -- Restitution 0.


def test_what_hits_with_restitution_0_stays_closed():
    pair = ExactEngine().run(Scene([Circle(0, 0, vx=2), Circle(4, 0)], restitution=0), until=9)
    assert [event.time.text() for event in pair.events] == ["1"]
    assert [circle.vx.text() for circle in pair.final.circles] == ["1", "1"]
    sliding = ExactEngine().run(Scene([Circle(0, 3, vx=2, vy=-1)], [Wall(0, 0, 1, 0)], restitution=0), until=9)
    assert (sliding.final["c1"].y.text(), sliding.final["c1"].vy.text(), len(sliding.events)) == ("1", "0", 1)
    rests = ExactEngine().run(Scene([Circle(0, 6, vx=1)], [Wall(0, 0, 1, 0)], restitution=0, gravity=(0, -10)), until=9)
    assert (rests.stop.reason, float(rests.final_time)) == (StopReason.REST, 1.0)
    falls_off = ExactEngine().run(
        Scene([Circle(0, 3, vy=-1)], [Wall(0, 0, 1, 0)], restitution=0, gravity=(0, "1/10")), until=40
    )
    assert falls_off.stop.reason is StopReason.HORIZON
    assert len(falls_off.events) == 1


def test_a_lasting_contact_of_restitution_0_takes_the_next_hit_with_it():
    """Three in a row, apart: the third is hit by two that move as one."""
    discs = [Circle(0, 0, vx=3), Circle(4, 0), Circle(9, 0)]
    for engine in (ExactEngine(), DoubleEngine(), SymbolicEngine()):
        run = engine.run(Scene(discs, restitution=0), until=9)
        assert run.events[0].contacts == (("c1", "c2"),), engine.name
    run = ExactEngine().run(Scene(discs, restitution=0), until=9)
    assert run.stop.reason is StopReason.UNDECIDED  # they push each other in turns, each time with half of it
    assert "collapse" in run.stop.message


def test_oblique_hits_of_restitution_0_leave_what_slides():
    run = ExactEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 1)], restitution=0), until=9)
    assert len(run.events) == 1
    after = run.at(run.events[0].time)
    a, b = after.circles
    dx, dy = (float(q) - float(p) for p, q in ((a.x, b.x), (a.y, b.y)))
    assert abs(dx * (float(b.vx) - float(a.vx)) + dy * (float(b.vy) - float(a.vy))) < 1e-12
    assert run.stop.reason is StopReason.HORIZON


# -- Every engine, and what is refused.


@pytest.mark.parametrize("engine", [DoubleEngine(), SingleEngine(), QuadEngine(), IntervalEngine(300)])
def test_engines_of_finite_precision_agree(engine):
    room = 1e-2 if engine.name == "single" else 1e-6
    seen = 0
    for seed in range(25):
        scene = scene_of(seed)
        run = None if scene is None else ExactEngine().run(scene, until=4, events=4)
        if scene is None or run is None or not run.certified:
            continue
        other = engine.run(scene, until=4, events=4)
        seen += len(other.events)
        assert [e.contacts for e in other.events] == [e.contacts for e in run.events], seed
        for mine, theirs in zip(run.events, other.events, strict=True):
            assert abs(float(mine.time) - float(theirs.time)) < room, seed
    assert seen > 30


def test_sympy_and_pymunk_agree():
    walls = [Wall(0, 0, 1, 1, id="low", vx="1/3"), Wall(9, 0, 9, 1, id="right", vx="1/4"), Wall(0, 9, 1, 9, vy=-1)]
    discs = [Circle(3, 0, vx=1), Circle(6, 3, vy=-1)]
    for gravity in (None, (0, -1)):
        scene = Scene(discs, walls, restitution="9/10", gravity=gravity)
        run = ExactEngine().run(scene, until=9, events=3)
        assert len(run.events) > 1
        literal = SymbolicEngine().run(scene, until=9, events=3)
        assert [Quantity.of(e.time.text()) for e in literal.events] == [Quantity.of(e.time.text()) for e in run.events]
        stepped = PymunkEngine(dt=1 / 2048).run(scene, until=9, events=len(run.events))
        assert [e.contacts for e in stepped.events] == [e.contacts for e in run.events]
        for mine, theirs in zip(run.events, stepped.events, strict=True):
            assert abs(float(mine.time) - float(theirs.time)) < 3e-3


def test_a_point_meets_a_wall_that_moves():
    scene = Scene([Circle(0, 3, r=0, point=True)], [Wall(0, 0, 1, 0, vy=1), Wall(0, 9, 1, 9)])
    for engine in (ExactEngine(), SymbolicEngine(), DoubleEngine()):
        run = engine.run(scene, until=6)
        assert [float(event.time) for event in run.events] == [3.0, 6.0], engine.name
        assert float(run.final["c1"].vy) == -2.0


@pytest.mark.parametrize(
    "engine",
    [
        ExactEngine(),
        SymbolicEngine(),
        DoubleEngine(),
        SingleEngine(),
        QuadEngine(),
        IntervalEngine(300),
        PymunkEngine(),
    ],
    ids=lambda engine: engine.name,
)
@pytest.mark.parametrize("gravity", [None, (0, 0)])
def test_walls_pass_what_is_fixed(engine, gravity):
    post = Circle(0, 0, m="oo", id="post")
    rail = Segment(-1, 4, 0, 5, "rail", "1/5")
    push = Wall(-3, 0, -3, 1, "push", vx=1)
    for segments in ((), (rail,)):
        scene = Scene([post, Circle(9, 0, id="ball")], [push], segments=segments, gravity=gravity)
        run = engine.run(scene, until=20)
        assert [event.contacts for event in run.events] == [(("ball", "push"),)]
        assert abs(float(run.events[0].time) - 11.0) < 0.02
        assert (float(run.final["post"].vx), float(run.final["post"].x)) == (0.0, 0.0)


def test_what_does_not_know_walls_that_move_refuses_them_in_one_line():
    scene = closing()
    for build, told in (
        (lambda: scene.with_changes(reverse_at=1), "cannot be turned back, as walls go on; leave reverse_at out"),
        (lambda: scene.with_changes(reverse_after=1), "leave reverse_after out"),
        (lambda: floats_csv(scene), "walls that move, which no row of a thing can say"),
    ):
        with pytest.raises(Exception, match=told) as error:
            build()
        assert "\n" not in str(error.value)
    found = audit_run(DoubleEngine().run(scene, events=2), DoubleEngine())
    assert found.kept
    assert energy_drift(DoubleEngine().run(scene, events=2)) is None
    assert unsupported(MujocoEngine(), scene) == "moving walls"


def test_chaos_is_measured_among_them_and_volumes_are_kept():
    """The map of a push by a wall that moves is linear in what is displaced, with the mirror's own determinant."""
    told = chaos(catalogue.build("piston"), ["double"], events=130)
    volume = told.spectrum.volume()
    assert volume is not None
    assert abs(volume) < 1e-6
    assert told.spectrum.per_time().value > 0.5
    assert told.horizons[0].holds(told.horizons[0].seen.place)
    quiet = chaos(catalogue.build("closing-wall"), [], events=20).spectrum
    assert not quiet.chaotic


def test_files_hold_them_and_digests_of_others_stay():
    scene = closing()
    assert loads_toml(dump_toml(scene)) == loads_json(dump_json(scene)) == scene
    still = Scene([Circle(3, 0, vx=1)], [Wall(0, 0, 0, 1)])
    assert "vx" not in still.data()["wall"][0]
    assert still.digest == Scene([Circle(3, 0, vx=1)], [Wall(0, 0, 0, 1, vx=0, vy="0")]).digest
    for kind in ("arc", "pocket"):
        body = "x = 9\ny = 3\nr = 1"
        text = f'[[circle]]\nid = "a"\nx = 0\ny = 0\nr = 1\n[[{kind}]]\nid = "s"\n{body}\nvx = 1\n'
        with pytest.raises(SceneError, match=f"{kind} 's': vx: an arc or a pocket does not move"):
            loads_toml(text)


def test_pictures_draw_walls_where_they_are_at_the_time():
    scene = closing().with_changes(walls=[Wall(9, 0, 9, 1, id="right", vx=-2)])
    run = ExactEngine().run(scene, events=1)
    there = as_at(scene, float(run.final_time))
    assert float(there.walls[0].x0) == pytest.approx(float(run.final["c"].x) + 1)
    assert (there.walls[0].id, scene.walls[0].x0.text()) == ("right", "9")
    told = played(scene, run, [], name="exact", title="exact")
    assert told is not None
    assert told["walls"] == [[9.0, 0.0, 9.0, 1.0, "right", -2.0, 0.0]]
    still = played(Scene([Circle(3, 0)], [Wall(9, 0, 9, 1)]), run, [], name="exact", title="exact")
    assert still is not None
    assert still["walls"] == [[9.0, 0.0, 9.0, 1.0, "w1"]]


def test_the_player_moves_walls():
    node = shutil.which("node")
    if node is None:
        pytest.skip("node is not there")
    source = (Path(pictures.__file__).parents[1] / "compare/report/templates/stage.js").read_text("utf-8")
    body = re.search(r"  moved\((.*?)\n  }", source, re.DOTALL)
    assert body is not None
    calls = "[moved([9,0,9,1,'w',-2,1],1.5),moved([9,0,9,1,'w'],3)]"
    told = f"const moved = function({body[1]}\n}}; console.log(JSON.stringify({calls}))"
    found = subprocess.run([node, "-e", told], capture_output=True, text=True, check=True).stdout
    assert json.loads(found) == [[6, 1.5, 6, 2.5], [9, 0, 9, 1]]


def test_what_moving_walls_brought_in_is_said(capsys):
    """Each hit of a wall that comes with speed u takes v to v + 2 u: m ((v + 2 u)^2 - v^2) / 2."""
    run = ExactEngine().run(closing(), events=3)
    assert energy_gained(run) == pytest.approx((9**2 - 1) / 2)
    falls = ExactEngine().run(Scene([Circle(0, 6)], [Wall(0, 0, 1, 0, vy=1)], gravity=(0, -10)), until=3)
    hits = [(float(falls.after(e.index)["c1"].vy) - 2, float(falls.after(e.index)["c1"].vy)) for e in falls.events]
    assert energy_gained(falls) == pytest.approx(sum((after**2 - before**2) / 2 for before, after in hits))
    still = ExactEngine().run(Scene([Circle(0, 6)], [Wall(0, 0, 1, 0)], gravity=(0, -10)), until=3)
    assert energy_gained(still) == pytest.approx(0, abs=1e-9)
    print_trajectory(run, exact=False, watch=Clock(None))
    assert "energy: walls that move brought in 40" in capsys.readouterr().out


@pytest.mark.parametrize(("text", "ending"), [("closing-wall", "80"), ("bounce", "19"), ("wedge", None)])
def test_the_end_of_the_motion_itself_is_in_json(text: str, ending: str | None) -> None:
    told = trajectory_json(ExactEngine().run(catalogue.build(text)), exact=True)
    if ending is None:
        assert not any(key.startswith("ending") for key in told)
        return
    assert (told["ending"], told["ending_exact"]) == (float(ending), ending)
