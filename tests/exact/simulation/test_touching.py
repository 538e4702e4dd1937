"""Contact at rest: balls that touch before anything happens, the least gap, the least overlap, and ties with them."""

from __future__ import annotations

from typing import Any

import pytest
from flint import arb, ctx  # type: ignore[attr-defined]

from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine, IntervalEngine
from truebreak.scenarios import Circle, Quantity, Scene, StopReason, Trajectory, Wall
from truebreak.scenarios.catalogue.scene_entry import cosine, sine

C = Circle
Q = Quantity.of
ROOT3 = Q("sqrt(3)")
FLOOR = Wall(0, 0, 1, 0, id="floor")
LEFT, RIGHT = Wall(0, 0, 0, 1, id="left"), Wall(20, 0, 20, 1, id="right")


def run(scene: Scene, **limits: Any) -> Trajectory:
    trajectory = ExactEngine().run(scene, **limits)
    assert trajectory.certified
    assert trajectory.stop.reason is not StopReason.UNDECIDED
    return trajectory


def velocities(trajectory: Trajectory) -> list[tuple[Quantity, Quantity]]:
    return [(Q(c.vx.text()), Q(c.vy.text())) for c in trajectory.final.circles]


def exactly(*pairs: Any) -> list[tuple[Quantity, Quantity]]:
    return [(Q(x), Q(y)) for x, y in pairs]


def on_line(*vx: Any) -> list[tuple[Quantity, Quantity]]:
    return exactly(*((v, 0) for v in vx))


def instants(trajectory: Trajectory) -> list[tuple[Quantity, int]]:
    """Each instant's time, exactly, and its number of impulses."""
    return [(Q(event.time.text()), len(event.impulses)) for event in trajectory.events]


def doubles(trajectory: Trajectory) -> list[float]:
    return [float(value) for c in trajectory.final.circles for value in (c.vx, c.vy)]


# -- nothing happens until something does


RESTING = {
    "two balls": Scene([C(0, 0), C(2, 0)]),
    "two balls, aslant": Scene([C(0, 0), C("sqrt(2)", "sqrt(2)")]),
    "a ball on a wall": Scene([C(5, 1)], [FLOOR]),
    "three that touch each other": Scene([C(0, 0), C(ROOT3, 1), C(ROOT3, -1)]),
    "fifty in a row": Scene([C(2 * k, 0) for k in range(50)]),
    "a wedged ball": Scene([C(1, 1)], [FLOOR, LEFT]),
    "three that fly together": Scene([C(0, 0, vx=3, vy=1), C(2, 0, vx=3, vy=1), C(4, 0, vx=3, vy=1)]),
    "a ball that slides along a wall": Scene([C(0, 1, vx=1)], [FLOOR]),
    "two that part": Scene([C(0, 0, vx=-1), C(2, 0, vx=1)]),
    "two that roll past each other": Scene([C(0, 0, vy=1), C(2, 0, vy=-1)]),
}


@pytest.mark.parametrize("engine", [ExactEngine(), DoubleEngine(), IntervalEngine()], ids=lambda e: e.name)
@pytest.mark.parametrize("name", RESTING)
def test_contact_alone_is_no_collision(name: str, engine: Any) -> None:
    if name == "two balls, aslant" and engine.name == "double":
        pytest.skip("in doubles they overlap, or stand apart")
    trajectory = engine.run(RESTING[name], until=100)
    assert trajectory.events == ()
    assert trajectory.stop.reason is StopReason.HORIZON


def test_contact_that_approaches_collides_at_time_zero() -> None:
    trajectory = run(Scene([C(0, 0, vx=1), C(2, 0), C(4, 0)]))
    assert instants(trajectory) == [(Q(0), 2)]
    assert velocities(trajectory) == on_line(0, 0, 1)


# -- balls in contact that a third hits


def test_two_that_touch_are_hit() -> None:
    trajectory = run(Scene([C(-4, 0, vx=1), C(0, 0), C(2, 0)]))
    assert instants(trajectory) == [(Q(2), 2)]
    assert velocities(trajectory) == on_line(0, 0, 1)


def test_three_that_touch_each_other_are_hit_at_the_tip() -> None:
    """The tip passes the blow on as in one-onto-two, and comes back onto the ball that struck it."""
    trajectory = run(Scene([C(-5, 0, vx=1), C(0, 0), C(ROOT3, 1), C(ROOT3, -1)]))
    assert instants(trajectory) == [(Q(3), 4)]
    assert velocities(trajectory) == exactly(("-1/5", 0), (0, 0), ("3/5", "sqrt(3)/5"), ("3/5", "-sqrt(3)/5"))


def test_three_that_touch_each_other_are_hit_between_two() -> None:
    """Simultaneously; then each of the two would push the third, which takes what is left of their motion."""
    trajectory = run(Scene([C(-4 - ROOT3, 0, vx=1), C(-ROOT3, 1), C(-ROOT3, -1), C(0, 0)]))
    ((time, impulses),) = instants(trajectory)
    assert (time, impulses) == (4 - ROOT3, 4)
    cue, up, down, far = velocities(trajectory)
    assert cue == (Q("-1/5"), Q(0))
    assert (up[0], up[1]) == (down[0], -down[1])
    assert far[1] == 0
    assert cue[0] + up[0] + down[0] + far[0] == 1
    assert cue[0] ** 2 + 2 * (up[0] ** 2 + up[1] ** 2) + far[0] ** 2 == 1


@pytest.mark.parametrize("count", [1, 2, 50])
def test_a_row_that_touches_passes_the_blow_on(count: int) -> None:
    trajectory = run(Scene([C(-4, 0, vx=1), *(C(2 * k, 0) for k in range(count))]))
    assert instants(trajectory) == [(Q(2), count)]
    assert velocities(trajectory) == on_line(*[0] * count, 1)


def test_a_row_of_fifty_between_walls_is_a_cradle() -> None:
    """The free length is 8: the far ball flies 2 to the wall and 2 back, the striker 2 and 2."""
    balls = [C(5 + 2 * k, 0) for k in range(50)]
    scene = Scene([C(1, 0, vx=1), *balls], [Wall(0, 0, 0, 1), Wall(106, 0, 106, 1)])
    trajectory = run(scene, events=40)
    assert [impulses for _, impulses in instants(trajectory)] == [50, 1] * 20
    assert instants(trajectory)[2][0] - instants(trajectory)[0][0] == 4
    assert sorted(abs(vx) for vx, _ in velocities(trajectory)) == [0] * 50 + [1]


def test_two_that_fly_together_are_hit_by_a_third() -> None:
    trajectory = run(Scene([C(0, 0, vx=1), C(2, 0, vx=1), C(8, 0, vx=-1)]))
    assert instants(trajectory) == [(Q(2), 2)]
    assert velocities(trajectory) == on_line(-1, 1, 1)


def test_two_that_fly_together_hit_a_wall() -> None:
    trajectory = run(Scene([C(0, 0, vx=1), C(2, 0, vx=1)], [Wall(6, 0, 6, 1)]))
    assert instants(trajectory) == [(Q(3), 3)]
    assert velocities(trajectory) == on_line(-1, -1)


def test_two_that_touch_are_hit_from_both_sides_at_once() -> None:
    trajectory = run(Scene([C(-5, 0, vx=1), C(-1, 0), C(1, 0), C(5, 0, vx=-1)]))
    assert instants(trajectory) == [(Q(2), 5)]
    assert velocities(trajectory) == on_line(-1, 0, 0, 1)


def test_one_at_rest_is_hit_from_both_sides_at_once() -> None:
    trajectory = run(Scene([C(-4, 0, vx=1), C(0, 0), C(4, 0, vx=-1)]))
    assert instants(trajectory) == [(Q(2), 2)]
    assert velocities(trajectory) == on_line(-1, 0, 1)


def test_a_blow_from_the_side_parts_two_that_touch_without_a_push_between_them() -> None:
    trajectory = run(Scene([C(0, 5, vy=-1), C(0, 0), C(2, 0)]))
    assert instants(trajectory) == [(Q(3), 1)]
    assert velocities(trajectory) == exactly((0, 0), (0, -1), (0, 0))


# -- at a wall


def test_a_ball_at_rest_on_a_wall_is_pushed_into_it() -> None:
    """Down, off the wall, up again: three impulses, and the other goes back as it came."""
    trajectory = run(Scene([C(0, 1), C(0, 5, vy=-1)], [FLOOR]))
    assert instants(trajectory) == [(Q(2), 3)]
    assert velocities(trajectory) == exactly((0, 0), (0, 1))


def test_a_ball_at_rest_on_a_wall_is_hit_along_it() -> None:
    trajectory = run(Scene([C(0, 1), C(6, 1, vx=-1)], [FLOOR]))
    assert instants(trajectory) == [(Q(4), 1)]
    assert velocities(trajectory) == exactly((-1, 0), (0, 0))


@pytest.mark.parametrize("policy", ["simultaneous", "sequential:order=scene", "sequential:seed=1"])
def test_a_ball_that_slides_along_a_wall_hits_another(policy: str) -> None:
    trajectory = run(Scene([C(0, 1, vx=1), C(6, 1)], [FLOOR, RIGHT], tie_policy=policy), until=20)
    assert instants(trajectory) == [(Q(4), 1), (Q(17), 1)]
    assert velocities(trajectory) == exactly((0, 0), (-1, 0))


def test_a_ball_that_slides_along_a_wall_into_a_corner_slides_back() -> None:
    trajectory = run(Scene([C(3, 1, vx=-1)], [FLOOR, LEFT]), until=10)
    assert instants(trajectory) == [(Q(2), 1)]
    assert velocities(trajectory) == exactly((1, 0))


# -- in a corner

ANGLES = (90, 60, 45, 36)


def corner(angle: int, out: Quantity | int = 0) -> Scene:
    """A ball of radius 1 at rest in a corner, `out` further out along its bisector, and one that flies at it."""
    c, s = cosine(angle), sine(angle)
    walls = [Wall(0, 0, c, s, id="upper"), Wall(0, 0, c, -s, id="lower")]
    return Scene([C(1 / s + out, 0, id="ball"), C(1 / s + 6, 0, vx=-1, id="cue")], walls)


@pytest.mark.parametrize("angle", ANGLES)
def test_a_ball_wedged_in_a_corner_gives_the_blow_back(angle: int) -> None:
    """Cue to ball, ball to both walls at once, ball to cue: one instant."""
    trajectory = run(corner(angle))
    assert instants(trajectory) == [(Q(4), 4)]
    assert velocities(trajectory) == on_line(0, 1)
    assert set(trajectory.events[0].contacts) == {("ball", "cue"), ("ball", "upper"), ("ball", "lower")}


@pytest.mark.parametrize("policy", ["sequential:order=scene", "sequential:seed=1", "sequential:seed=2"])
@pytest.mark.parametrize("angle", ANGLES)
def test_one_wall_at_a_time_takes_180_degrees_over_the_angle(angle: int, policy: str) -> None:
    """The method of images unfolds a corner of 180/n degrees into n walls; after them the ball comes out again."""
    scene = corner(angle).with_changes(circles=corner(angle).circles[:1])
    (ball,) = scene.circles
    thrown = scene.with_changes(circles=[C(ball.x, 0, vx=-1)], tie_policy=policy)
    trajectory = run(thrown)
    assert instants(trajectory) == [(Q(0), 180 // angle)]
    assert velocities(trajectory) == on_line(1)


# -- grazing contacts beside a hit


@pytest.mark.parametrize("policy", ["simultaneous", "sequential:order=scene"])
def test_a_graze_at_the_instant_of_a_hit_takes_no_part(policy: str) -> None:
    """At time 5 the first ball touches the second in passing, and hits the third."""
    scene = Scene([C(0, 0, vx=1), C(5, 2), C(7, 0)], tie_policy=policy)
    trajectory = run(scene)
    assert instants(trajectory) == [(Q(5), 1)]
    assert trajectory.events[0].contacts == (("c1", "c3"),)
    assert velocities(trajectory) == on_line(0, 0, 1)


def test_a_grazed_ball_is_hit_by_another_at_that_instant() -> None:
    """The third drives the second down onto the first, which is just under it, and takes over the blow."""
    trajectory = run(Scene([C(0, 0, vx=1), C(5, 2), C(5, 9, vy=-1)]))
    assert instants(trajectory)[0] == (Q(5), 2)
    assert velocities(trajectory) == exactly((1, -1), (0, 0), (0, 0))


def test_a_graze_between_two_that_are_hit_from_afar() -> None:
    """Two balls pass each other touching at time 3; a third hits one of them from behind then, along its way."""
    scene = Scene([C(-3, 0, vx=1), C(3, 2, vx=-1), C(-8, 0, vx=2)])
    trajectory = run(scene)
    assert instants(trajectory)[0] == (Q(3), 1)
    assert trajectory.events[0].contacts == (("c1", "c3"),)


# -- a heap


@pytest.mark.parametrize("gap", ["0", "10**-40", "2**-52"])
@pytest.mark.parametrize("policy", ["simultaneous", "sequential:order=scene", "sequential:seed=5"])
def test_energy_and_momentum_of_a_heap_are_kept(gap: str, policy: str) -> None:
    side = 2 + Q(gap)
    heap = [C(side * x * ROOT3 / 2, side * y / 2) for x, y in ((0, 0), (1, 1), (1, -1), (2, 0), (2, 2), (2, -2))]
    scene = Scene([C(-5, "1/7", vx=1, m=2), *heap], tie_policy=policy)
    trajectory = ExactEngine().run(scene, events=1 if gap == "0" else 6)
    assert trajectory.stop.reason is StopReason.EVENTS
    with_masses = [(int(str(c.m)), s) for c, s in zip(scene.circles, trajectory.final.circles, strict=True)]
    saved, ctx.prec = ctx.prec, 300
    try:
        vx = [(m, s.vx.ball(300)) for m, s in with_masses]
        vy = [(m, s.vy.ball(300)) for m, s in with_masses]
        for total, expected in (
            (sum((m * v for m, v in vx), arb(0)), 2),
            (sum((m * v for m, v in vy), arb(0)), 0),
            (sum((m * v * v for m, v in (*vx, *vy)), arb(0)), 2),
        ):
            assert total.contains(expected)
            assert total.rad() < arb(10) ** -50
    finally:
        ctx.prec = saved
