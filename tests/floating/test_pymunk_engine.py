"""The pymunk engine: what tends to the truth as its step shrinks, what it keeps at any step, how it ends."""

from __future__ import annotations

import doctest
import math
import random
import signal
import threading
from collections.abc import Callable, Iterator
from fractions import Fraction

import numpy as np
import pymunk
import pytest

from truebreak.floating import pymunk_engine, pymunk_run
from truebreak.floating.knots import DoubleMotion
from truebreak.floating.pymunk_engine import PymunkEngine, bench_overhead
from truebreak.scenarios import Circle, Contact, Scene, SceneError, StopReason, Trajectory, Wall, catalogue
from truebreak.scenarios.errors import TimeIsUp
from truebreak.scenarios.trajectory import Progress, Stop

FINE = PymunkEngine(dt=1 / 16384)
BOX = [
    Wall(0, 0, 1, 0, id="south"),
    Wall(0, 10, 1, 10, id="north"),
    Wall(0, 0, 0, 1, id="west"),
    Wall(10, 0, 10, 1, id="east"),
]


def gas(seed: int = 1, rows: int = 3) -> Scene:
    """Equal discs at unit speed on a jittered grid in a box, every number a short binary fraction."""
    draw = random.Random(seed)
    pitch = Fraction(10, rows)
    circles = []
    for i in range(rows * rows):
        middles = (float((k + 0.5) * pitch) for k in (i % rows, i // rows))
        x, y = (Fraction(round(middle * 64) + draw.randint(-8, 8), 64) for middle in middles)
        angle = draw.uniform(0, 2 * math.pi)
        vx, vy = Fraction(round(math.cos(angle) * 64), 64), Fraction(round(math.sin(angle) * 64), 64)
        circles.append(Circle(x, y, "1/2", vx, vy))
    return Scene(circles, BOX, name="gas")


def collided(run: Trajectory) -> list[Contact]:
    return [contact for event in run.events for contact in event.impulses]


def velocities(run: Trajectory) -> list[tuple[float, float]]:
    return [(float(c.vx), float(c.vy)) for c in run.final.circles]


def momentum_and_energy(scene: Scene, row: np.ndarray) -> tuple[float, float, float]:
    masses = np.array([float(c.inverse_mass) ** -1 for c in scene.circles])
    v = row[:, 2:]
    return float(masses @ v[:, 0]), float(masses @ v[:, 1]), float(masses @ (v**2).sum(axis=1))


def referee(scene: Scene) -> Iterator[tuple[float, str, str]]:
    """The true history, as far as doubles carry: after every collision, every hit is predicted anew."""
    discs = [[float(c.x), float(c.y), float(c.vx), float(c.vy), float(c.r)] for c in scene.circles]
    lines = []
    for wall in scene.walls:
        nx, ny = (float(part) for part in wall.normal)
        length = math.hypot(nx, ny)
        lines.append((nx / length, ny / length, (nx * float(wall.x0) + ny * float(wall.y0)) / length))
    now = 0.0
    while True:
        hits: list[tuple[float, int, int]] = []
        for j, (x, y, vx, vy, r) in enumerate(discs):
            for i, (x0, y0, vx0, vy0, r0) in enumerate(discs[:j]):
                dx, dy, ux, uy, reach = x - x0, y - y0, vx - vx0, vy - vy0, r + r0
                b, disc = dx * ux + dy * uy, (ux * ux + uy * uy) * reach**2 - (dx * uy - dy * ux) ** 2
                if b < 0 < disc:
                    hits.append(((dx * dx + dy * dy - reach**2) / (math.sqrt(disc) - b), i, j))
            for k, (nx, ny, height) in enumerate(lines):
                gap, speed = nx * x + ny * y - height, nx * vx + ny * vy
                if gap * speed < 0:
                    hits.append(((abs(gap) - r) / abs(speed), j, len(discs) + k))
        wait, i, j = min(hits)
        now += wait
        for disc_ in discs:
            disc_[0] += disc_[2] * wait
            disc_[1] += disc_[3] * wait
        a = discs[i]
        if j < len(discs):
            b_ = discs[j]
            nx, ny = b_[0] - a[0], b_[1] - a[1]
            share = ((b_[2] - a[2]) * nx + (b_[3] - a[3]) * ny) / (nx * nx + ny * ny)
            b_[2], b_[3] = b_[2] - share * nx, b_[3] - share * ny
        else:
            nx, ny, _ = lines[j - len(discs)]
            share = -2 * (a[2] * nx + a[3] * ny)
        a[2], a[3] = a[2] + share * nx, a[3] + share * ny
        yield now, scene.ids[i], scene.ids[j]


def test_docstring_examples_hold() -> None:
    assert doctest.testmod(pymunk_engine).failed == 0


# -- what tends to the truth as the step shrinks


@pytest.mark.parametrize("bits", [4, 8, 12, 16])
def test_wall_bounce_is_late_by_less_than_a_step(bits: int) -> None:
    dt = 2.0**-bits
    run = PymunkEngine(dt=dt).run(Scene([Circle(0, 0, 1, vx=1)], [Wall("31/10", 0, "31/10", 1)]), until=4)
    assert collided(run) == [("c1", "w1")]
    assert 0 < run.events[0].time - 2.1 <= dt
    assert velocities(run) == [(-1.0, 0.0)]
    assert abs(run.final["c1"].x - 0.2) <= 2 * dt


@pytest.mark.parametrize("bits", [6, 10, 14])
def test_oblique_collision_tends_to_the_analytic_one(bits: int) -> None:
    dt = 2.0**-bits
    run = PymunkEngine(dt=dt).run(Scene([Circle(0, 0, 1, vx=1), Circle(5, 1, 1, m=3)]), until=8)
    hit = 5 - math.sqrt(3)
    nx, ny = math.sqrt(3) / 2, 0.5
    impulse = 1.5 * nx
    expected = [(1 - impulse * nx, -impulse * ny), (impulse * nx / 3, impulse * ny / 3)]
    assert 0 < run.events[0].time - hit <= dt
    np.testing.assert_allclose(velocities(run), expected, atol=2 * dt)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_start_of_a_chaotic_gas_tends_to_the_true_one(seed: int) -> None:
    scene = gas(seed)
    truth = [hit for hit, _ in zip(referee(scene), range(10), strict=False)]
    error: dict[int, float] = {}
    for bits in (12, 16):
        run = PymunkEngine(dt=2.0**-bits).run(scene, until=truth[-1][0] + 0.01)
        seen = sorted((event.time, *contact) for event in run.events for contact in event.impulses)[:10]
        assert [hit[1:] for hit in seen] == [hit[1:] for hit in truth]
        error[bits] = max(abs(a[0] - b[0]) for a, b in zip(seen, truth, strict=True))
    assert error[16] < error[12] / 4
    assert error[12] < 2.0**-7


def test_three_balls_of_lee_settle_to_the_simultaneous_outcome() -> None:
    scene = Scene([Circle(-3, 0, 1, 1, 0, 1), Circle(0, 0, 1, 0, 0, 1), Circle(4, 0, 2, -1, 0, 4)])
    settled = PymunkEngine().run(scene, until=3)
    np.testing.assert_allclose(velocities(settled), [(-2, 0), (-1, 0), (0, 0)], atol=1e-14)
    assert settled.events[0].contacts == (("c1", "c2"), ("c2", "c3"))
    assert settled.events[0].coupled
    assert [tie.proof.name for tie in settled.events[0].ties] == ["FLOAT"]
    hasty = PymunkEngine(iterations=10).run(scene, until=3)
    assert 1e-5 < abs(velocities(hasty)[0][0] + 2) < 1e-3


def test_one_ball_onto_two_that_touch_settles_to_the_simultaneous_outcome() -> None:
    scene = Scene([Circle(-4, 0, 1, vx=1), Circle(0, 1, 1), Circle(0, -1, 1)])
    third = math.sqrt(3) / 5
    for bits in (6, 10, 14):
        run = PymunkEngine(dt=2.0**-bits).run(scene, until=6)
        expected = [(-0.2, 0), (0.6, third), (0.6, -third)]
        np.testing.assert_allclose(velocities(run), expected, atol=2 * 2.0**-bits)
        assert len(run.events) == 1


@pytest.mark.parametrize("radius", ["1", "3/10", "7/10"])
def test_touching_cradle_passes_the_push_on_one_step_a_ball(radius: str) -> None:
    r = Fraction(radius)
    balls = [Circle(-3 * r, 0, r, vx=1), *(Circle(2 * r * i, 0, r) for i in range(4))]
    run = FINE.run(Scene(balls), until=3)
    assert collided(run) == [(f"c{i}", f"c{i + 1}") for i in range(1, 5)]
    assert np.diff([event.time for event in run.events]).tolist() == [FINE.dt] * 3
    assert velocities(run) == [(0, 0)] * 4 + [(1, 0)]


# -- what it keeps at any step


def test_circles_that_only_touch_do_not_collide() -> None:
    small = [Circle("3/10", 5, "3/10"), Circle("9/10", 5, "3/10")]
    run = PymunkEngine().run(Scene([Circle(0, 0), Circle(2, 0), *small]))
    assert run.events == ()
    assert run.stop.reason is StopReason.QUIET


def test_a_gas_keeps_momentum_and_energy_and_stays_in_its_box() -> None:
    scene = gas(4)
    run = PymunkEngine().run(scene, until=200)
    assert run.collisions > 300
    rows = run.sample([float(t) for t in range(0, 201, 4)])
    energies = [momentum_and_energy(scene, row)[2] for row in rows]
    np.testing.assert_allclose(energies, energies[0], rtol=1e-12)
    assert rows[:, :, :2].min() > 0.45
    assert rows[:, :, :2].max() < 9.55


def test_free_circles_keep_momentum() -> None:
    light = Circle(3, 6, 1, 0, -1, "1/5")
    scene = Scene([Circle(0, 0, 1, 1, "1/3", 2), Circle(5, 1, 2, "-1/2", 0, 7), light])
    run = PymunkEngine().run(scene, until=20)
    assert run.collisions >= 2
    first, last = (momentum_and_energy(scene, row) for row in run.sample([0.0, 20.0]))
    np.testing.assert_allclose(last, first, rtol=1e-13)


@pytest.mark.parametrize("bias", [1.0, 0.5, 0.0])
def test_sampled_motion_is_that_of_the_space(bias: float) -> None:
    engine = PymunkEngine(dt=1 / 64, collision_bias=bias)
    run = engine.run(gas(7), until=20)
    world = engine.space(gas(7))
    expected = []
    for _ in range(64 * 20):
        world.space.step(1 / 64)
        expected.append([(*body.position, *body.velocity) for body in world.bodies])
    np.testing.assert_allclose(run.sample([k / 64 for k in range(1, 64 * 20 + 1)]), expected, atol=1e-11)


def test_the_same_run_gives_the_same_history() -> None:
    one, two = (PymunkEngine().run(gas(5), until=30) for _ in range(2))
    assert one.events == two.events
    assert one.final == two.final


def test_a_longer_run_begins_with_the_shorter() -> None:
    short, long = (PymunkEngine().run(gas(6), until=until) for until in ("50/3", 40))
    assert long.events[: len(short.events)] == short.events


def test_a_wall_stops_circles_on_both_of_its_sides() -> None:
    scene = Scene([Circle(-2, 0, 1, vx=1), Circle(3, "1/2", 1, vx=-1)], [Wall(0, 0, 0, 1, id="w")])
    run = PymunkEngine(dt=1 / 4).run(scene, until=10)
    assert sorted(collided(run)) == [("c1", "w"), ("c2", "w")]
    assert velocities(run) == [(-1, 0), (1, 0)]


def test_a_slanted_wall_turns_a_circle_by_a_right_angle() -> None:
    run = FINE.run(Scene([Circle(-5, 0, 1, vx=1)], [Wall(0, 0, 1, 1)]), until=8)
    assert 0 < run.events[0].time - (5 - math.sqrt(2)) <= FINE.dt
    np.testing.assert_allclose(velocities(run), [(0, 1)], atol=1e-15)


@pytest.mark.parametrize("slope", [0, 1, "1/1000"])
def test_a_wall_has_no_end(slope: int | str) -> None:
    scene = Scene([Circle(0, 2, 1, vx=1000, vy=0)], [Wall(0, 5, 1, Fraction(5) - Fraction(slope))])
    run = PymunkEngine(dt=1 / 1024).run(scene, until=20)
    assert len(run.events) == (0 if slope == 0 else 1)


def test_a_fast_circle_does_not_pass_through_a_wall() -> None:
    run = PymunkEngine(dt=1 / 4).run(Scene([Circle(0, 0, "1/100", vx=1000)], [Wall(10, 0, 10, 1)]), until=5)
    assert collided(run) == [("c1", "w1")]
    assert velocities(run) == [(-1000, 0)]
    assert any("smallest radius" in note for note in run.notes)


def test_a_circle_pressed_deep_into_a_wall_by_heavier_ones_comes_out_on_its_side() -> None:
    balls = [Circle(10 + 3 * k, 0, 1, vx=-3, m=10**k) for k in range(5)]
    run = PymunkEngine(dt=1 / 32).run(Scene(balls, [Wall(0, 0, 0, 1)]), until=40)
    assert min(float(ball.x) for ball in run.final.circles) > 1


def test_a_fixed_circle_stays_and_throws_back() -> None:
    run = PymunkEngine().run(Scene([Circle(0, 0, 1, vx=1), Circle(4, 0, 1, m="oo")]), until=5)
    assert velocities(run) == [(-1, 0), (0, 0)]
    assert (run.final["c2"].x, run.final["c2"].y) == (4, 0)


def test_a_point_ball_meets_walls_and_circles() -> None:
    scene = Scene([Circle(0, 0, 0, vx=1, point=True), Circle(6, 0, 1)], [Wall(-2, 0, -2, 1)])
    run = PymunkEngine().run(scene, until=12)
    assert collided(run) == [("c1", "c2")]
    back = PymunkEngine().run(scene.with_changes(circles=[Circle(0, 0, 0, vx=-1, point=True)]), until=12)
    assert collided(back) == [("c1", "w1")]
    assert back.events[0].time == 2 + PymunkEngine().dt


def test_two_point_balls_are_said_to_be_out_of_its_reach() -> None:
    points = [Circle(0, 0, 0, vx=1, point=True), Circle(6, 0, 0, point=True)]
    run = PymunkEngine().run(Scene(points), until=12)
    assert any("point balls" in note for note in run.notes)


def test_a_right_angle_corner_is_one_event_that_is_not_coupled() -> None:
    run = PymunkEngine().run(Scene([Circle(5, 5, 1, -1, -1)], BOX), until=5)
    (event,) = run.events
    assert event.contacts == (("c1", "south"), ("c1", "west"))
    assert not event.coupled
    assert velocities(run) == [(1, 1)]


def test_contacts_are_in_scene_order() -> None:
    for event in PymunkEngine(dt=1 / 16).run(gas(8, rows=4), until=60).events:
        order = gas(8, rows=4).ids.index
        pairs = [(order(a), order(b)) for a, b in event.contacts]
        assert pairs == sorted(pairs)
        assert all(i < j for i, j in pairs)
        assert sorted(event.impulses) == sorted(event.contacts)


# -- how it ends


def test_until_between_two_steps_is_reached_in_straight_flight() -> None:
    run = PymunkEngine(dt=1 / 4).run(Scene([Circle(0, 0, vx=1)], [Wall(9, 0, 9, 1)]), until="10/3")
    assert run.stop.reason is StopReason.HORIZON
    assert run.final_time == 10 / 3
    assert run.final["c1"].x == pytest.approx(10 / 3, rel=1e-15)


def test_an_event_limit_ends_the_run_at_that_event() -> None:
    run = PymunkEngine().run(gas(), events=7)
    assert len(run.events) == 7
    assert run.stop.reason is StopReason.EVENTS
    assert run.final_time == run.events[-1].time


def test_a_run_without_a_time_limit_ends_when_nothing_can_happen() -> None:
    circles = [Circle(0, 0, vx=1), Circle(4, 0), Circle(0, 9, vx=-1)]
    run = PymunkEngine().run(Scene(circles, [Wall(-9, 0, -9, 1)]))
    assert run.stop.reason is StopReason.QUIET
    assert collided(run) == [("c1", "c2"), ("c3", "w1")]


def test_a_time_limit_holds_where_nothing_can_happen() -> None:
    run = PymunkEngine().run(Scene([Circle(0, 0, vx=1)]), until=10**6)
    assert run.stop.reason is StopReason.HORIZON
    assert run.final["c1"].x == 10**6
    assert run.plan["steps"] < 1000


def test_the_budget_of_steps_ends_a_run() -> None:
    run = PymunkEngine(max_steps=300).run(gas(), events=10**6)
    assert run.stop.reason is StopReason.BUDGET
    assert run.final_time == 300 / 256
    assert PymunkEngine(max_steps=256).run(gas(), until=1).stop.reason is StopReason.HORIZON


@pytest.mark.parametrize(("limit", "time"), [({"reverse_at": "7/3"}, 7 / 3), ({"reverse_after": 2}, None)])
def test_a_reversed_run_goes_back_towards_its_start(limit: dict[str, str], time: float | None) -> None:
    scene = gas().with_changes(**limit)
    run = FINE.run(scene)
    assert run.reversal is not None
    turn = run.reversal.time if time is None else time
    assert run.reversal.time == turn
    assert run.final_time == 2 * turn
    assert run.stop.reason is StopReason.HORIZON
    start, before, after, end = run.sample([0.0, math.nextafter(turn, 0), turn, 2 * turn])
    if time is not None:
        np.testing.assert_allclose(after[:, 2:], -before[:, 2:])
    np.testing.assert_allclose(end[:, :2], start[:, :2], atol=0.05)
    np.testing.assert_allclose(end[:, 2:], -start[:, 2:], atol=0.05)


def test_a_reversal_right_after_a_collision_undoes_it() -> None:
    run = FINE.run(Scene([Circle(0, 0, vx=1), Circle(4, 0)], reverse_after=1))
    assert collided(run) == [("c1", "c2")] * 2
    assert run.reversal is not None
    assert run.reversal.after == 1
    assert velocities(run) == [(-1, 0), (0, 0)]
    assert run.final["c1"].x == pytest.approx(0, abs=4 * FINE.dt)


def test_a_limit_of_the_caller_may_come_before_the_reversal() -> None:
    run = PymunkEngine().run(gas().with_changes(reverse_at=9), until=2)
    assert run.reversal is None
    assert run.final_time == 2


def test_another_tie_policy_is_noted() -> None:
    assert PymunkEngine().run(gas().with_changes(tie_policy="sequential"), until=1).notes


# -- what it refuses, and what it passes on


def test_capture_is_refused() -> None:
    from truebreak.scenarios import Pocket

    scene = Scene([Circle(0, 0)], pockets=[Pocket(5, 5, 1)])
    assert PymunkEngine().run(scene, until=1).events == ()
    with pytest.raises(SceneError, match="cannot take circles out of play"):
        PymunkEngine().run(scene.with_changes(capture=True), until=1)


@pytest.mark.parametrize(
    "setting",
    [
        {"dt": 0},
        {"dt": math.nan},
        {"dt": math.inf},
        {"iterations": 0},
        {"iterations": 1.5},
        {"max_steps": True},
        {"collision_slop": -1},
        {"collision_bias": 1.1},
        {"collision_bias": math.nan},
    ],
)
def test_parameters_out_of_range_are_refused(setting: dict[str, float]) -> None:
    with pytest.raises(SceneError, match=next(iter(setting))):
        PymunkEngine(**setting)  # type: ignore[arg-type]


def test_numbers_beyond_doubles_are_refused() -> None:
    with pytest.raises(SceneError, match="1e308"):
        PymunkEngine().run(Scene([Circle("1e400", 0)]), until=1)


def test_more_groups_than_filters_are_refused() -> None:
    circles = [Circle(3 * k, 0, 1) for k in range(33)]
    walls = [Wall(3 * k + Fraction(3, 2), 0, 3 * k + Fraction(3, 2), 1) for k in range(32)]
    with pytest.raises(SceneError, match="33 groups"):
        PymunkEngine().run(Scene(circles, walls), until=1)
    assert PymunkEngine().run(Scene(circles[1:], walls), until=1).events == ()


def test_all_settings_are_told() -> None:
    told = PymunkEngine(dt=1 / 100, iterations=3).run(gas(), until=1).parameters
    assert told["dt"] == 1 / 100
    assert told["iterations"] == 3
    assert told["pymunk"] == pymunk.version
    assert {"collision_slop", "collision_bias", "collision_persistence", "elasticity"} <= told.keys()


def failing(error: BaseException) -> Callable[..., None]:
    def fail(*_: object) -> None:
        raise error

    return fail


def assert_begins_like(part: Trajectory, whole: Trajectory) -> None:
    """A run that was cut is the beginning of the whole, and its final state is the whole's at that time."""
    assert part.events == whole.events[: len(part.events)]
    assert float(part.final_time) < float(whole.final_time)
    assert len(part.events) == sum(float(event.time) <= float(part.final_time) for event in whole.events)
    assert np.allclose(part.final.array(), whole.at(part.final_time).array(), rtol=0, atol=1e-9)


def test_an_interrupt_ends_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pymunk_run, "PROGRESS_SECONDS", 0.0)
    run = PymunkEngine().run(gas(), until=100, progress=failing(KeyboardInterrupt()))
    assert run.stop.reason is StopReason.INTERRUPTED
    assert run.final_time == pymunk_run.STRETCH / 256
    assert_begins_like(run, PymunkEngine().run(gas(), until=100))


def test_the_end_of_the_users_time_ends_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pymunk_run, "PROGRESS_SECONDS", 0.0)
    told: list[Progress] = []

    def progress(state: Progress) -> None:
        told.append(state)
        if len(told) == 9:
            raise TimeIsUp("3 seconds")

    run = PymunkEngine().run(gas(), until=100, progress=progress)
    assert run.stop == Stop(StopReason.BUDGET, "the budget is spent: 3 seconds")
    assert (run.final_time, len(run.events)) == (told[-1].time, told[-1].events)
    assert len(run.events) > 5
    assert_begins_like(run, PymunkEngine().run(gas(), until=100))


def test_control_c_waits_for_the_end_of_a_step() -> None:
    """The signal mostly comes while C code is at work; raised there it would be printed, and lost."""
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    timer.start()
    run = PymunkEngine(max_steps=10**9).run(catalogue.build("gas"), until=10**6)
    assert run.stop.reason is StopReason.INTERRUPTED
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    assert_begins_like(run, PymunkEngine().run(catalogue.build("gas"), until=float(run.final_time) + 1))


def test_an_interrupt_while_pymunk_reports_a_contact_ends_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pymunk.Arbiter, "total_impulse", property(failing(KeyboardInterrupt())))
    with pytest.raises(KeyboardInterrupt):
        PymunkEngine().run(gas(), until=100)


def test_overhead_times_the_same_steps_twice() -> None:
    bare, recorded = bench_overhead(gas(), steps=500, rounds=2)
    assert bare > 0
    assert recorded > 0


def test_circles_that_fly_on_in_touch_leave_no_knots_behind() -> None:
    pair = [Circle(0, 0, "3/10", vx=1), Circle("3/5", 0, "3/10", vx=1), Circle("6/5", 0, "3/10", vx=1)]
    run = PymunkEngine().run(Scene(pair), until=20)
    assert run.events == ()
    assert isinstance(run.motion, DoubleMotion)
    assert max(len(knots) for knots in run.motion.knots) < 10
