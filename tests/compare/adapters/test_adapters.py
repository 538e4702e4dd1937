"""Other people's engines, adapted: each tells true histories where it can, and refuses what it cannot hold."""

from __future__ import annotations

import math
from importlib.util import find_spec

import pytest

from truebreak.compare.adapters.__main__ import SCENES as COSTED
from truebreak.compare.adapters.__main__ import main as costs_command
from truebreak.compare.adapters.adapter import NotInstalled, package
from truebreak.compare.causes.diagnosis import CauseName
from truebreak.compare.comparison import compare
from truebreak.compare.engines import engine
from truebreak.compare.grids.bounce_survey import BOUNCES, bounces_of
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Polygon, Scene, SceneError, Segment, Wall
from truebreak.scenarios.catalogue import build
from truebreak.scenarios.trajectory import StopReason

PACKAGES = {
    "box2d": "Box2D",
    "rapier": "rapier3d",
    "mujoco": "mujoco",
    "billiards": "billiards",
    "pooltool": "pooltool",
    "perfect-physics": "perfect_physics",
}
STEPPED = ("box2d", "rapier", "mujoco")
EVENT_DRIVEN = ("billiards", "pooltool", "perfect-physics")


@pytest.fixture(params=PACKAGES)
def name(request: pytest.FixtureRequest) -> str:
    """The name of an engine that is installed."""
    return installed(request.param)


def installed(name: str) -> str:
    """The name of an engine; the test is skipped where it is not installed."""
    if find_spec(PACKAGES[name]) is None:
        pytest.skip(f"needs truebreak[{name}]")
    return name


def two(**changes: object) -> Scene:
    """A disc that hits another off its centre, in a box of which it meets one wall."""
    walls = [Wall(-9, 0, -9, 1, id="left"), Wall(9, 0, 9, 1, id="right"), Wall(0, 9, 1, 9, id="top")]
    circles = [Circle(0, 0, vx=1, id="a"), Circle(4, "3/4", id="b")]
    return Scene(circles, walls, **changes)  # type: ignore[arg-type]


def test_two_discs_and_walls(name: str) -> None:
    """Who meets whom, and the velocities: a step's length may turn the line of centres, nothing more."""
    found = compare(two(), [name], events=3)
    (mine,) = found.candidates
    assert mine.verdict == "agree"
    run = mine.trajectory
    slack = 0.0 if engine(name).step is None else 8 * float(engine(name).step or 0)
    if name == "mujoco":
        slack *= 16
    for event, truth in zip(run.events, found.reference.events, strict=False):
        assert float(event.time) == pytest.approx(float(truth.time), abs=8 * slack + 1e-6)
        assert event.impulses == truth.impulses
    last, truth = engine(name).run(two(), events=3).final, found.reference.final
    for circle in ("a", "b"):
        for key in ("vx", "vy"):
            assert getattr(last[circle], key) == pytest.approx(float(getattr(truth[circle], key)), abs=slack + 1e-6)


def test_energy_stays(name: str) -> None:
    """Restitution 1, no friction, no damping: what is left of the energy after 20 hits among equal discs in a box."""
    events = 4 if name == "perfect-physics" else 20
    scene = two() if name == "perfect-physics" else build("gas:n=3,seed=1")
    run = engine(name).run(scene, events=events)
    assert len(run.events) >= events
    before = sum(float(c.m) * (float(c.vx) ** 2 + float(c.vy) ** 2) for c in scene.circles)
    after = sum(
        float(c.m) * (float(run.final[str(c.id)].vx) ** 2 + float(run.final[str(c.id)].vy) ** 2) for c in scene.circles
    )
    bound = {"mujoco": 1e-3, "box2d": 1e-5, "rapier": 1e-5, "pooltool": 1e-6}.get(name, 1e-13)
    assert after == pytest.approx(before, rel=bound)


@pytest.mark.parametrize("name", [*STEPPED, "billiards", "pooltool"])
def test_a_slow_hit_bounces(name: str) -> None:
    """No threshold under which a hit is taken for a push: at a speed of 2**-16 it is elastic too."""
    scene = Scene([Circle(0, 0, vx=math.ldexp(1, -16), id="a"), Circle("2 + 1/2**12", 0, id="b")])
    text = f"{installed(name)}:dt=1/4" if name in STEPPED else installed(name)
    run = engine(text).run(scene, until=64)
    assert [event.impulses for event in run.events] == [(("a", "b"),)]
    assert run.final["b"].vx == pytest.approx(math.ldexp(1, -16), rel=1e-2)
    assert abs(float(run.final["a"].vx)) < math.ldexp(1, -22)


@pytest.mark.parametrize("contact", ["wall", "discs"])
@pytest.mark.parametrize("name", ["box2d", "rapier"])
def test_bounces_have_the_restitution_of_the_scene(name: str, contact: str) -> None:
    pytest.importorskip({"box2d": "Box2D", "rapier": "rapier3d"}[name])
    found = bounces_of(engine(name), contact, "9/10")
    assert (found.bounces, found.missed, found.refused) == (BOUNCES, 0, None)
    assert found.least == pytest.approx(0.9, abs=1e-6)
    assert found.greatest == pytest.approx(0.9, abs=1e-6)


@pytest.mark.parametrize("name", STEPPED)
def test_a_fast_flight_is_not_cut_off(name: str) -> None:
    """No cap of speeds: a disc at speed 1,000 is where it is to be."""
    scene = Scene([Circle(0, 0, vx=1000, id="a"), Circle(0, 9, vx=1000, id="b")])
    run = engine(f"{installed(name)}:dt=1/4096").run(scene, until=4)
    assert run.events == ()
    assert run.final["a"].x == pytest.approx(4000, rel=1e-4)


@pytest.mark.parametrize("name", STEPPED)
def test_nothing_falls_asleep(name: str) -> None:
    """A disc that has rested for long is still hit."""
    scene = Scene([Circle(0, 0, vx="1/8", id="a"), Circle(12, 0, id="b")])
    run = engine(f"{installed(name)}:dt=1/64").run(scene, until=100)
    assert len(run.events) == 1
    assert run.final["b"].vx == pytest.approx(0.125, rel=1e-3)


@pytest.mark.parametrize("name", [*STEPPED, "billiards", "pooltool"])
def test_fixed_circles_and_both_sides_of_a_wall(name: str) -> None:
    """A fixed circle sends back, and a wall is hard on both sides."""
    scene = Scene(
        [
            Circle(-3, 0, vx=1, id="a"),
            Circle(4, 0, vx=-1, id="b"),
            Circle(-9, 0, m="oo", id="post"),
        ],
        [Wall(0, 0, 0, 1, id="wall")],
    )
    found = compare(scene, [installed(name)], until=10)
    assert found.verdict == "agree"
    assert [sorted(event.impulses[0]) for event in found.candidates[0].trajectory.events] == [
        ["a", "wall"],
        ["b", "wall"],
        ["a", "post"],
    ]


@pytest.mark.parametrize("name", [*STEPPED, "billiards"])
@pytest.mark.parametrize("turn", [{"reverse_after": 2}, {"reverse_at": "9/2"}])
def test_reversal(name: str, turn: dict[str, object]) -> None:
    """A reversal leads back to where the discs were."""
    run = engine(installed(name)).run(two(**turn))
    assert run.reversal is not None
    first = run.final["a"]
    slack = 0.0 if engine(name).step is None else 0.2
    assert (float(first.x), float(first.y)) == pytest.approx((0.0, 0.0), abs=slack + 1e-6)


@pytest.mark.parametrize("name", STEPPED)
def test_finer_steps_come_nearer(name: str) -> None:
    """The time of the second hit converges as the step is halved."""
    truth = engine("exact").run(two(), events=2).events[1].time
    misses = []
    for dt in ("1/128", "1/512", "1/2048"):
        runner = engine(f"{installed(name)}:dt={dt}")
        misses.append(abs(float(runner.run(two(), events=2).events[1].time) - float(truth)))
    assert misses[2] < misses[0] / 4
    finer = engine(f"{name}:dt=1/128").finer()
    assert finer is not None
    assert finer.step == 1 / 256


REFUSED = {
    "pooltool": (Scene([Circle(0, 0, vx=1), Circle(4, 0, r=2)]), "balls of one radius and one mass"),
    "perfect-physics": (Scene([Circle(0, 0, vx=1), Circle(4, 0, m="oo")]), "no infinite mass"),
    "rapier": (Scene([Circle(3, 3, vx=1)], [Wall(-k, 0, -k, 1) for k in range(40)]), "distinguishes 31"),
    "mujoco": (Scene([Circle(3, 3, vx=1)], [Wall(-k, 0, -k, 1) for k in range(40)]), "distinguishes 30"),
    "box2d": (Scene([Circle(0, 0, vx=1000, r="1/1000"), Circle(4, 0)]), "reduce dt"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_scene_that_it_cannot_hold_is_refused(name: str) -> None:
    """With a message, and the verdict of a comparison is that it cannot run the scene."""
    scene, told = REFUSED[installed(name)]
    with pytest.raises(SceneError, match=told):
        engine(name).run(scene, until=1)
    (mine,) = compare(scene, [name], until=1).candidates
    assert mine.unable
    assert told in mine.trajectory.stop.message


def test_captures_are_refused(name: str) -> None:
    """None of them takes balls out of play."""
    assert "capture" not in engine(name).scene_keys


def test_declarations_are_what_they_are(name: str) -> None:
    """By steps or by events, bits, input."""
    mine = engine(name)
    assert (mine.step is not None) == (name in STEPPED)
    assert mine.rounds_input == (name != "perfect-physics")
    assert mine.bits == {"box2d": 24, "rapier": 24, "perfect-physics": None}.get(name, 53)


@pytest.mark.parametrize("text", ["box2d:dt=0", "rapier:iterations=0", "mujoco:contact_steps=0", "pooltool:friction=0"])
def test_settings_out_of_range_are_refused(text: str) -> None:
    """In one line that names the engine and the setting."""
    key = text.partition(":")[2].partition("=")[0]
    with pytest.raises(SceneError, match=key):
        engine(text)


def test_an_engine_that_is_not_installed_says_how_to_get_it() -> None:
    """One clear error, naming the extra."""
    with pytest.raises(NotInstalled, match=r"pip install '\.\[box2d\]'"):
        package("no_such_package", "box2d")


def test_a_comparison_with_an_engine_that_is_not_installed_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is not told as a scene that the engine cannot take."""

    def missing(name: str) -> None:
        raise ModuleNotFoundError(f"No module named {name!r}")

    monkeypatch.setattr("truebreak.compare.adapters.adapter.import_module", missing)
    with pytest.raises(NotInstalled, match=r"pip install '\.\[box2d\]'"):
        compare(two(), ["box2d"], events=3)


def test_a_circle_that_leaves_the_edges_ends_the_run() -> None:
    """Box2D's walls are long, not infinite: the run stops there, and says so."""
    scene = Scene([Circle(0, 2, vx=64, id="a"), Circle(0, 9, vy="-1/1000", id="b")], [Wall(0, 0, 1, 0)])
    run = engine(f"{installed('box2d')}:dt=1/64").run(scene, until=10_000)
    assert run.stop.reason is StopReason.BUDGET
    assert "end of an edge" in run.stop.message


def test_what_a_step_costs_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    """A row for each engine of steps that is installed, and each scene."""
    assert costs_command(["--steps", "20"]) == 0
    rows = [line.split("|")[1:4] for line in capsys.readouterr().out.splitlines()[2:]]
    assert {row[0].strip(" `") for row in rows} >= {"pymunk"}
    assert len(rows) % len(COSTED) == 0
    assert all(float(row[2]) > 0 for row in rows if "not possible" not in row[2])
    assert costs_command(["--steps", "0"]) == 2


def among_segments(r: str) -> Scene:
    """A disc that hits a face, then a wall, and then the end of another segment, off its line."""
    bars = [Segment(-3, 0, 3, 0, id="floor", r=r), Segment("15/2", 2, "17/2", 2, id="shelf", r=r)]
    walls = [Wall(-9, 0, -9, 1, id="left"), Wall(9, 0, 9, 1, id="right"), Wall(0, 10, 1, 10, id="top")]
    return Scene([Circle(-1, 3, vx="1/2", vy=-1, id="disc")], walls, segments=bars, until=30)


@pytest.mark.parametrize("name", STEPPED)
@pytest.mark.parametrize("r", ["0", "1/4"])
def test_segments_have_faces_ends_and_thickness(name: str, r: str) -> None:
    chosen = engine(f"{installed(name)}:dt=1/512")
    scene = among_segments(r)
    if name == "mujoco" and r == "0":
        with pytest.raises(SceneError, match="segment 'floor': r = 0; engine 'mujoco' has segments of some thickness"):
            chosen.run(scene)
        return
    exact = ExactEngine().run(scene, events=3)
    told = chosen.run(scene, events=3)
    assert [e.contacts for e in told.events] == [e.contacts for e in exact.events]
    assert {pair.second for e in exact.events for pair in e.contacts} >= {"floor", "shelf"}
    assert [float(e.time) for e in told.events] == pytest.approx([float(e.time) for e in exact.events], abs=0.1)


def among_polygons(r: str) -> Scene:
    """A disc that falls onto a side, then on a wall, a jaw of a notch, and what is in it."""
    hook = [(0, 0), (6, 0), (6, 6), (0, 6), (0, 4), (4, 4), (4, 2), (0, 2)]
    walls = [Wall(-9, 0, -9, 1, id="left"), Wall(0, 12, 1, 12, id="top")]
    slab = Polygon([(-8, -3), (-2, -3), (-2, -2), (-8, -2)], "slab", r)
    disc = Circle(-4, 4, r="1/2", vx="1/2", vy=-2, id="disc")
    return Scene([disc], walls, polygons=[Polygon(hook, "hook", r), slab], until=30)


@pytest.mark.parametrize("name", STEPPED)
@pytest.mark.parametrize("r", ["0", "1/4"])
def test_polygons_have_sides_and_corners(name: str, r: str) -> None:
    chosen = engine(f"{installed(name)}:dt=1/512")
    scene = among_polygons(r)
    if name == "mujoco" and r == "0":
        with pytest.raises(SceneError, match="polygon 'hook': r = 0; engine 'mujoco' has polygons with round corners"):
            chosen.run(scene)
        return
    exact = ExactEngine().run(scene, events=4)
    told = chosen.run(scene, events=4)
    assert [e.contacts for e in told.events] == [e.contacts for e in exact.events]
    assert {pair.second for e in exact.events for pair in e.contacts} >= {"hook", "slab"}
    assert [float(e.time) for e in told.events] == pytest.approx([float(e.time) for e in exact.events], abs=0.1)


@pytest.mark.parametrize("name", EVENT_DRIVEN)
def test_engines_without_segments_say_so(name: str) -> None:
    assert not {"segment", "polygon"} & engine(installed(name)).scene_keys


FLOOR = Wall(0, 0, 1, 0, id="floor")

AHEAD = {"box2d": 1.0, "rapier": 5 / 8, "mujoco": 1 / 2}
"""How much of its g dt each step moves a circle by: `SteppedFall.ahead`."""


@pytest.mark.parametrize("name", STEPPED)
def test_an_engine_of_steps_falls_as_its_adapter_says(name: str) -> None:
    """By its own states, of which the adapter's declaration knows nothing."""
    runner = engine(installed(name))
    scene = Scene([Circle(0, "3/2", vx="1/2", id="ball")], [FLOOR], gravity=(0, -1))
    world = runner.world(scene)
    for _ in range(64):
        world.step()
    ((x, y, vx, vy),) = world.rows()
    span = 64 * runner.step
    assert (x, vx, vy) == pytest.approx((span / 2, 0.5, -span), rel=1e-5)
    ahead = 0.5 - (y - 1.5 + span * span / 2) / (runner.step * span)
    assert ahead == pytest.approx(AHEAD[name], abs=0.05)
    assert runner.falls.ahead == AHEAD[name]


@pytest.mark.parametrize("name", STEPPED)
def test_two_discs_under_gravity(name: str) -> None:
    scene = Scene(
        [Circle(0, 3, vx="1/3", id="a"), Circle("1/5", 6, id="b", m=2)],
        [FLOOR, Wall(-4, 0, -4, 1, id="left"), Wall(4, 0, 4, 1, id="right")],
        gravity=(0, -1),
    )
    (mine,) = compare(scene, [installed(name)], until=6).candidates
    assert mine.verdict == "agree" and len(mine.trajectory.events) == 5
    assert mine.laws is not None and mine.laws.kept is not False
    kinds = {defect.kind for defect in mine.laws.defects}
    assert ("integrator" in kinds) == (AHEAD[name] != 0.5)


@pytest.mark.parametrize("name", STEPPED)
def test_drops_of_adapted_engines_come_back(name: str) -> None:
    """Every drop bounces, at each phase of the step, with the restitution asked for, to first order in the step."""
    for asked in ("1",) if name == "mujoco" else ("9/10", "1"):
        found = bounces_of(engine(installed(name)), "drop", asked)
        assert (found.bounces, found.missed, found.refused) == (BOUNCES, 0, None)
        assert found.mean == pytest.approx(0.9 if asked == "9/10" else 1.0, abs=4e-3)


@pytest.mark.parametrize("name", ["box2d", "rapier"])
@pytest.mark.parametrize("gravity", [None, (0, -4)])
def test_walls_that_move_push_by_the_speed_relative_to_them(name: str, gravity: tuple[int, int] | None) -> None:
    """One quickens a disc by twice its speed at each hit; under gravity a floor rises, with a restitution."""
    walls = [Wall(0, 0, 0, 1, id="left"), Wall(9, 0, 9, 1, id="right", vx="-1/2")]
    scene = Scene([Circle(3, 0, vx=1, id="c")], walls)
    if gravity is not None:
        floor = Wall(0, 0, 1, 0, id="floor", vy="1/2")
        circles = [Circle(3, 5, vx="1/3", id="c"), Circle(6, 9, id="d")]
        scene = Scene(circles, [floor], gravity=gravity, restitution="9/10")
    mine, truth = (
        runner.run(scene, events=5) for runner in (engine(f"{installed(name)}:dt={2.0**-10}"), ExactEngine())
    )
    assert [event.contacts for event in mine.events] == [event.contacts for event in truth.events]
    for event, exact in zip(mine.events, truth.events, strict=True):
        assert float(event.time) == pytest.approx(float(exact.time), abs=1e-2)
    for circle in scene.circles:
        end, exact_end = mine.final[str(circle.id)], truth.final[str(circle.id)]
        assert float(end.vx) == pytest.approx(float(exact_end.vx), abs=2e-2)
        assert float(end.vy) == pytest.approx(float(exact_end.vy), abs=5e-2)


@pytest.mark.parametrize("name", STEPPED)
def test_a_reversal_under_gravity_is_refused_by_name(name: str) -> None:
    scene = Scene([Circle(0, 3, id="a")], [FLOOR], gravity=(0, -1), reverse_at=1)
    with pytest.raises(SceneError, match=f"has gravity and a reversal, which engine '{name}' does not follow together"):
        engine(installed(name)).run(scene, until=2)


def test_box2d_says_where_it_would_hold_a_circle_back() -> None:
    """Beyond 2 m a step it takes speed off a circle without a word: the run ends before that."""
    runner = engine(installed("box2d") + ":dt=1")
    deep = Wall(0, -99999, 1, -99999, id="deep")
    run = runner.run(Scene([Circle(0, 0, vy=-9, id="a")], [deep], gravity=(0, -1)), until=999)
    assert run.stop.reason is StopReason.BUDGET
    assert "would go farther in a step than the 2 m" in run.stop.message


def test_where_an_engine_pushes_before_it_moves_is_taken_for_no_correction() -> None:
    """Box2D's correction of positions is off: a cause of that name would be a false one."""
    top = Wall(0, "3001/1000", 1, "3001/1000", id="top")
    room = Scene([Circle(0, 2)], [FLOOR, top], gravity=(0, -1))
    (found,) = compare(room, [installed("box2d") + ":dt=1/64"], events=4).candidates
    assert found.verdict == "diverged" and found.diagnosis is not None
    assert found.diagnosis.shares[0].cause is CauseName["INTEGRATOR"]
    assert all(abs(row.share or 0.0) < 1e-6 for row in found.diagnosis.shares if row.cause is CauseName["CORRECTION"])
