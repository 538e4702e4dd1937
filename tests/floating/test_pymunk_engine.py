"""The pymunk engine: what tends to the truth as its step shrinks, what it keeps at any step, how it ends."""

from __future__ import annotations

import doctest
import math
import random
from collections.abc import Iterator
from fractions import Fraction

import numpy as np
import pytest

from truebreak.exact import ExactEngine
from truebreak.floating import pymunk_engine
from truebreak.floating.pymunk_engine import PymunkEngine
from truebreak.scenarios import Circle, Contact, Scene, StopReason, Trajectory, Wall

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


FLOOR = Wall(0, 0, 1, 0, id="floor")


def test_under_gravity_walls_reach_as_far_as_a_circle_comes_however_long_it_takes() -> None:
    scene = Scene([Circle(0, 6, vx=1000)], [FLOOR], gravity=(0, -10))
    run, short = (PymunkEngine(dt=1 / 64).run(scene, until=until) for until in (500, 30))
    assert (run.stop.reason, run.final["c1"].x) == (StopReason.HORIZON, 500_000)
    assert 245 < len(run.events) < 251  # every second time unit, the first after one
    assert abs(run.final["c1"].y - 6) < 0.1
    assert run.events[: len(short.events)] == short.events


def test_a_ball_that_comes_down_after_a_long_time_meets_a_wall_that_was_out_of_reach() -> None:
    thrown = Scene([Circle(0, 1, vx=3000, vy=2000)], [FLOOR], gravity=(0, -10))
    run = PymunkEngine(dt=1 / 64).run(thrown, until=410)
    assert collided(run) == [("c1", "floor")]
    assert abs(run.events[0].time - 400) < 1


def test_walls_that_move_are_met_however_late() -> None:
    walls = [Wall(0, 0, 0, 1, id="left"), Wall(9, 0, 9, 1, id="right", vx=1)]
    run = PymunkEngine(dt=1 / 64).run(Scene([Circle(3, 0, vx=5, vy=1)], walls), until=300)
    exact = ExactEngine().run(Scene([Circle(3, 0, vx=5, vy=1)], walls), until=300)
    assert collided(run) == collided(exact)
    assert abs(run.final["c1"].x - float(exact.final["c1"].x)) < 1
    assert run.final["c1"].y == 300


def test_a_run_under_gravity_with_no_limit_on_its_time_ends_once_nothing_comes() -> None:
    run = PymunkEngine(dt=1 / 64).run(Scene([Circle(0, 6, vx=1)], [Wall(9, 0, 9, 1)], gravity=(0, -10)))
    assert len(run.events) == 1
    assert run.stop.reason is StopReason.BUDGET
    assert 64 <= run.final_time - run.events[0].time <= 68  # seen within a stretch of 256 steps
    assert "give until" in run.stop.message


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
