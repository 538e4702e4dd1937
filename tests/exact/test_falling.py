"""Gravity in every engine: their agreement, exact reversal, named stops, grazes, symmetry, and refusals by name."""

from __future__ import annotations

import numpy as np
import pytest
from flint import arb
from test_gravity import scene_of

from truebreak.compare import compare
from truebreak.compare.files.saved import resume, run_of, saved_run
from truebreak.compare.grids.row import energy_drift
from truebreak.compare.report.floats import floats_csv, floats_json
from truebreak.exact import ExactEngine
from truebreak.exact.literal.symbolic_engine import SymbolicEngine
from truebreak.exact.numbers import ball
from truebreak.exact.simulation.endings import Endings
from truebreak.floating import (
    DoubleEngine,
    IntervalEngine,
    PymunkEngine,
    QuadEngine,
    RoundedEngine,
    SingleEngine,
)
from truebreak.scenarios import Circle, Quantity, Scene, SceneError, Wall
from truebreak.scenarios.files import dump_json, dump_toml, loads_json, loads_toml
from truebreak.scenarios.trajectory import StopReason

FLOOR = Wall(0, 0, 1, 0, id="floor")
BOX = [FLOOR, Wall(-5, 0, -5, 1, id="left"), Wall(5, 0, 5, 1, id="right"), Wall(0, 9, 1, 9, id="top")]

ENGINES = (DoubleEngine(), QuadEngine(), SingleEngine(), RoundedEngine(40), IntervalEngine(200))

GRIDS = (
    Scene([Circle(0, 5, vx=1)], [FLOOR], gravity=(0, -10), restitution="1/2"),
    Scene([Circle(0, 3, vx=1), Circle(0, 6, vx="1/2", m=2)], BOX, gravity=(0, -4)),
    Scene([Circle(0, 1, vx=1, vy=3), Circle(2, 3, vx=1)], BOX, gravity=(0, -4)),
    Scene([Circle(0, 1, vx=1), Circle(2, 3, vx=1)], BOX, gravity=(0, 4)),
    Scene([Circle(0, 3, vx=1, vy=-4)], BOX, gravity=(0, 4)),
    Scene([Circle(0, 3, vx=1, vy=-4), Circle(-3, 4, vx=-1)], BOX, gravity=(4, 0)),
    Scene([Circle(-2, 4), Circle(2, 4), Circle(0, 8, vy=1, m=3)], BOX, gravity=(0, -2), restitution="1/2"),
    Scene([Circle(-2, 1, vy=4), Circle(2, 1, vy=4)], BOX, gravity=(0, -2), tie_policy="sequential"),
)


def history(run, count=6):
    return [(event.contacts, event.impulses) for event in run.events[:count]]


@pytest.mark.parametrize("scene", GRIDS)
def test_sympy_and_the_others_tell_what_the_exact_engine_does(scene: Scene):
    run = ExactEngine().run(scene, until=4, events=5)
    assert run.certified
    for engine in (SymbolicEngine(), DoubleEngine(), QuadEngine()):
        other = engine.run(scene, until=4, events=5)
        assert history(other) == history(run), engine.name
        assert (other.stop.reason, float(other.final_time)) == (run.stop.reason, pytest.approx(float(run.final_time)))
        np.testing.assert_allclose(other.final.array(), run.final.array(), atol=1e-12)


@pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.name)
def test_engines_of_finite_precision_fall_along_the_same_parabolas(engine):
    scenes = [scene for seed in range(24) if (scene := scene_of(seed)) is not None]
    assert len(scenes) > 20
    for scene in scenes:
        run, other = ExactEngine().run(scene, until=5, events=8), engine.run(scene, until=5, events=8)
        assert history(other, 8) == history(run, 8), scene.name
        times = np.linspace(0, min(float(run.final_time), float(other.final_time)) * 0.999, 7)
        far = np.abs(run.sample(times) - other.sample(times)).max()
        assert far < (1e-3 if engine.bits == 24 else 1e-7), scene.name


def test_doubles_between_events_are_those_of_the_exact_numbers():
    run = ExactEngine().run(GRIDS[1], until=6)
    times = [0.0, 0.3, 1.7, 2.25, 5.9]
    for time, row in zip(times, run.sample(times).tolist(), strict=True):
        assert row == [[float(c.x), float(c.y), float(c.vx), float(c.vy)] for c in run.at(time).circles]
    near = run.at("1/3")["c1"]
    assert near.vy.text() == "-4/3"
    assert near.y.text() == "25/9"


# -- The way back.


@pytest.mark.parametrize("scene", [*GRIDS[1:4], *filter(None, map(scene_of, range(12)))])
def test_a_run_turned_back_comes_home_exactly(scene: Scene):
    if not scene.elastic:
        scene = scene.with_changes(restitution=1)
    back = ExactEngine().run(scene.with_changes(reverse_at="5/3"))
    assert back.notes[0].startswith("came back to the start exactly")
    there = ExactEngine().run(scene, until="5/3")
    half = len(there.events)
    names = [event.contacts for event in back.events]
    assert names[:half] == [event.contacts for event in there.events]
    assert names[half : 2 * half] == names[:half][::-1]  # what touched at time 0 may be hit at the return itself
    last = back.at(Quantity.of("10/3") - Quantity.of("1/1024"))
    start = there.at("1/1024")
    for one, other in zip(last.circles, start.circles, strict=True):
        assert [float(one.x), float(one.y)] == pytest.approx([float(other.x), float(other.y)], abs=1e-12)
        assert [-float(one.vx), -float(one.vy)] == pytest.approx([float(other.vx), float(other.vy)], abs=1e-12)


# -- Named stops.


def test_bounces_end_at_the_same_exact_number_whichever_bounce_tells_it():
    scene = Scene([Circle(0, 6, vx=1)], [FLOOR], gravity=(0, -10), restitution="1/2")
    run = ExactEngine().run(scene)
    assert run.stop.reason is StopReason.ACCUMULATION
    assert run.ending is not None
    assert run.ending.text() == "3"  # sqrt(2 h / g) (1 + e) / (1 - e), with h = 5
    assert len(run.events) == 21
    for event in run.events:
        speed = run.after(event.index)["c1"].vy
        left = Quantity.of(event.time.text()) + Quantity.of(speed.text()) * 2 / (10 * (1 - Quantity.of("1/2")))
        assert left == Quantity.of(3)


def test_bounces_on_a_slope_end_at_the_number_that_they_come_to():
    scene = Scene([Circle(0, 6, vx=1)], [Wall(0, 0, 4, 1)], gravity=(1, -10), restitution="1/3")
    run = ExactEngine().run(scene)
    assert run.stop.reason is StopReason.ACCUMULATION
    assert run.ending is not None
    more = ExactEngine().run(scene, events=10)
    assert more.stop.reason is StopReason.EVENTS
    with ball.precision(600):
        times = [run.events[k].time.ball(400) for k in (3, 4, 5)]
        e, first, second = arb(1) / 3, times[1] - times[0], times[2] - times[1]
        assert abs(second / first - e) < arb(2) ** -200
        assert abs(times[1] + second / (1 - e) - run.ending.ball(400)) < arb(2) ** -200


def test_bounces_are_not_said_to_end_where_another_circle_comes_between():
    """A second disc falls on the first just before its bounces would end."""
    scene = Scene(
        [Circle(0, 2, id="low"), Circle("1/7", "62/5", vy="-1/2", id="high")],
        [FLOOR],
        gravity=(0, -10),
        restitution="1/2",
    )
    alone = ExactEngine().run(Scene(scene.circles[:1], scene.walls, gravity=scene.gravity, restitution="1/2"))
    assert alone.ending is not None
    run = ExactEngine().run(scene, events=60)
    met = next(event for event in run.events if event.contacts[0].second != "floor")
    assert float(met.time) < float(alone.ending) + 0.8
    assert all(float(run.events[k].time) < float(run.events[k + 1].time) for k in range(len(run.events) - 1))
    assert run.ending is None or float(run.ending) > float(met.time)


def test_a_proof_that_nothing_comes_between_counts_whoever_is_near():
    scene = Scene([Circle(0, 1), Circle(9, 1)], [FLOOR, Wall(-3, 0, -3, 1)], gravity=(0, -10), restitution="1/2")
    link = next(iter(ExactEngine().run(scene.with_changes(circles=[Circle(0, 2)])).motion.log.steps)).source
    assert link.wall == 0
    still = [(arb(0), arb(1), arb(0), arb(1)), (arb(9), arb(1), arb(0), arb(0))]
    endings = Endings(scene, True)
    assert endings.ends(link, -1, arb(0), arb("0.01"), still)
    assert not endings.ends(link, -1, arb(0), arb(10), still)  # by then the other may have come
    quick = [still[0], (arb(9), arb(1), arb(-800), arb(0))]
    assert not endings.ends(link, -1, arb(0), arb("0.01"), quick)
    near = [(arb(-2), arb(1), arb("-0.5"), arb(1)), still[1]]
    assert not endings.ends(link, -1, arb(0), arb("0.01"), near)  # it touches the wall on its left
    assert not endings.ends(link, -1, arb(0), arb.nan(), still)


def test_a_circle_that_stands_on_a_wall_ends_the_run_by_name():
    for engine in (ExactEngine(), SymbolicEngine(), *ENGINES):
        run = engine.run(Scene([Circle(0, 1, vx=1)], BOX, gravity=(0, -10)))
        assert (run.stop.reason, len(run.events)) == (StopReason.REST, 0), engine.name
        assert run.stop.message.endswith("c1 and floor")
    hangs = ExactEngine().run(Scene([Circle(0, 1, vx=1)], [FLOOR], gravity=(0, 10)), until=3)
    assert (hangs.stop.reason, float(hangs.final["c1"].y)) == (StopReason.HORIZON, 46.0)
    slides = ExactEngine().run(Scene([Circle(0, 1, vx=1)], BOX, gravity=(1, 0)), until=9)
    assert (slides.stop.reason, [float(event.time) for event in slides.events]) == (StopReason.HORIZON, [2.0, 8.0])


def test_bounces_in_a_corner_are_suspected_to_accumulate():
    scene = Scene([Circle(1, 5, r="1/2")], [Wall(0, 0, 1, 1), Wall(0, 0, -1, 1)], gravity=(0, -10), restitution="9/10")
    run = ExactEngine().run(scene, events=3000)
    assert run.stop.reason in (StopReason.UNDECIDED, StopReason.ACCUMULATION)
    assert "accumulat" in run.stop.message or "infinitely" in run.stop.message


# -- Grazes, symmetry, late times.


@pytest.mark.parametrize(
    "engine", [ExactEngine(), SymbolicEngine(), DoubleEngine(), QuadEngine()], ids=lambda e: e.name
)
def test_a_circle_that_grazes_a_wall_flies_on(engine):
    """y = 3 - 4 t + 2 t^2 touches 1 at t = 1; the ceiling comes at 1 + sqrt(7/2)."""
    run = engine.run(GRIDS[4], until=3)
    assert [event.contacts[0].second for event in run.events] == ["top"]
    assert float(run.events[0].time) == pytest.approx(1 + 3.5**0.5)
    nearer = GRIDS[4].with_changes(circles=[Circle(0, 3, vx=1, vy="-4 - 1/10**30")])
    if engine.name == "exact":
        assert [event.contacts[0].second for event in engine.run(nearer, until=3).events] == ["floor", "top"]


def test_ties_by_symmetry_need_a_mirror_that_keeps_gravity():
    pair = [Circle("-2 - 1/7", 4, vx="sqrt(2)/3", vy="1/3"), Circle("2 + 1/7", 4, vx="-sqrt(2)/3", vy="1/3")]
    sides = {("c1", "left"), ("c2", "right")}
    for gravity, together in (((0, -3), True), (("1/100", -3), False)):
        run = ExactEngine().run(Scene(pair, BOX[:3], gravity=gravity), events=40)
        assert run.certified
        walls = [sides & set(event.contacts) for event in run.events]
        assert {len(found) for found in walls if found} == {2 if together else 1}
    for x, y in ((0, 1), (1, 0)):
        across = Scene([Circle(c.x, c.y, c.r, c.vx, c.vy) for c in pair], [], gravity=(x, y))
        assert ExactEngine().run(across, until=20).certified


def test_late_times_are_as_certain_as_early_ones():
    scene = Scene([Circle(0, 3, vx="1/3"), Circle("1/2", 6, vx="-1/7")], BOX, gravity=(0, -1))
    late = ExactEngine().run(scene, events=400)
    assert late.certified
    assert float(late.final_time) > 100
    energy = [
        sum(float(c.vx) ** 2 + float(c.vy) ** 2 + 2 * float(c.y) for c in s.circles) for s in (late.at(0), late.final)
    ]
    assert energy[0] == pytest.approx(energy[1], abs=1e-12)
    assert abs(energy_drift(late)) < 1e-13
    assert abs(energy_drift(SingleEngine().run(scene, events=40))) < 1e-4
    far = Scene([Circle(0, "10**12", vx=1)], [FLOOR], gravity=(0, "-1/10**6"))
    assert ExactEngine().run(far, events=5).certified


# -- pymunk.


def test_pymunk_falls_half_a_step_late_and_gains_what_its_correction_pushes_out():
    scene = Scene([Circle(0, 2)], [FLOOR], gravity=(0, -1))
    apexes = {}
    for bias in (0.0, 0.9**60, 1.0):
        run = PymunkEngine(dt=1 / 64, collision_bias=bias).run(scene, until=6)
        apexes[bias] = max(run.sample(np.arange(96, 250) / 64)[:, 0, 1]) - 1
    assert apexes[0.0] == pytest.approx(1.022, abs=1e-3)  # the figures of what pymunk is known to do
    assert apexes[0.9**60] == pytest.approx(1.002, abs=1e-3)
    assert apexes[1.0] == 1.0
    dt, run = 1 / 64, PymunkEngine(dt=1 / 64).run(scene, until=1)
    for n in (1, 7, 63):
        assert run.at(n * dt)["c1"].y == pytest.approx(2 - dt**2 * n * (n - 1) / 2)
        assert run.at(n * dt)["c1"].vy == -n * dt


# -- What does not know gravity says so.


def test_a_file_keeps_gravity_and_scenes_without_have_no_such_key():
    scene = GRIDS[1].with_changes(gravity=("sqrt(2)", "-981/100"))
    assert loads_toml(dump_toml(scene)) == scene == loads_json(dump_json(scene))
    assert "gravity" not in scene.with_changes(gravity=None).data()
    assert "gravity" not in scene.with_changes(gravity=(0, 0)).data()
    assert scene.digest != scene.with_changes(gravity=None).digest


def test_gravity_is_two_exact_numbers():
    for bad in ((0,), "down", (0, "x"), [1, 2, 3]):
        with pytest.raises(SceneError, match="gravity"):
            Scene([Circle(0, 5)], gravity=bad)


def test_a_divergence_of_steps_under_gravity_has_a_cause_that_closes():
    scene = GRIDS[1]
    found = compare(scene, [PymunkEngine(dt=1 / 4)], events=12)
    assert found.candidates[0].alignment.divergence is not None
    assert found.candidates[0].diagnosis.closed


def test_a_run_goes_on_under_gravity_as_one_run_would_have():
    scene = GRIDS[1]
    short, whole = ExactEngine().run(scene, events=3), ExactEngine().run(scene, events=9)
    again = ExactEngine().resume(short, events=9)
    assert [event.time.text() for event in again.events[:6]] == [event.time.text() for event in whole.events[:6]]
    assert again.final.array().tolist() == whole.final.array().tolist()


def test_what_is_written_for_other_programs_has_gravity_and_restitution_or_is_refused():
    told = floats_json(GRIDS[0])
    assert (told["gravity"], told["restitution"]) == ([0.0, -10.0], 0.5)
    for scene, key in ((GRIDS[1], "gravity"), (GRIDS[0].with_changes(gravity=None), "restitution")):
        with pytest.raises(SceneError, match=f"has {key}, which no row of a thing can say"):
            floats_csv(scene)


def test_a_saved_run_falls_as_it_did_and_ends_where_it_did():
    run = ExactEngine().run(GRIDS[1], events=6)
    again = run_of(saved_run(run))
    assert again.scene == run.scene
    assert again.at("7/3")["c1"].y.digits(40) == run.at("7/3")["c1"].y.digits(40)
    assert again.final.array().tolist() == run.final.array().tolist()
    run = ExactEngine().run(GRIDS[0])
    again = run_of(saved_run(run))
    assert run.stop == again.stop and run.stop.reason is StopReason.ACCUMULATION
    assert again.ending is not None and run.ending is not None
    assert again.ending.digits(100) == run.ending.digits(100)
    assert saved_run(again) == saved_run(run)


def test_a_saved_run_is_crushed_when_it_was_and_goes_on_to_the_same_end():
    walls = [Wall(0, 0, 0, 1), Wall("7 + sqrt(2)", 0, "7 + sqrt(2)", 1, vx=-2)]
    run = ExactEngine().run(Scene([Circle(3, 0, vx=1)], walls))
    again = run_of(saved_run(run))
    assert run.stop.reason is StopReason.CRUSHED
    assert again.ending is not None and again.ending.text() == run.ending.text() == "1/2*sqrt(2) + 5/2"
    on = resume(again, until=9)
    assert (on.stop, on.ending.text()) == (run.stop, run.ending.text())
