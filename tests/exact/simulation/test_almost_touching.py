"""Contact but for one unit in the last place, and the touching cradle in decimals and in doubles."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import pairwise
from typing import Any

import pytest
from test_touching import ANGLES, FLOOR, ROOT3, C, Q, corner, doubles, exactly, instants, on_line, run, velocities

from truebreak.floating import DoubleEngine, IntervalEngine, PymunkEngine
from truebreak.scenarios import Scene, SceneError, StopReason
from truebreak.scenarios.catalogue.scene_entry import cosine, sine

# -- the next double


def ulp(x: float) -> Fraction:
    """The distance from a double to the next one."""
    return Fraction(math.nextafter(x, math.inf)) - Fraction(x)


def test_a_gap_of_one_ulp_is_a_gap() -> None:
    """Two instants, one ulp of flight apart."""
    gap = ulp(2.0)
    trajectory = run(Scene([C(-4, 0, vx=1), C(0, 0), C(2 + gap, 0)]))
    assert instants(trajectory) == [(Q(2), 1), (Q(2 + gap), 1)]
    assert velocities(trajectory) == on_line(0, 0, 1)


def test_a_row_of_fifty_with_gaps_of_one_ulp_is_hit_ball_by_ball() -> None:
    gap = ulp(100.0)
    trajectory = run(Scene([C(-4, 0, vx=1), *(C(k * (2 + gap), 0) for k in range(50))]))
    assert instants(trajectory) == [(Q(2 + k * gap), 1) for k in range(50)]
    assert velocities(trajectory) == on_line(*[0] * 50, 1)


def test_three_with_gaps_of_one_ulp_take_three_instants_to_the_same_end() -> None:
    """Apart by an ulp from the tip, and so from each other."""
    gap = ulp(2.0)
    scene = Scene([C(-5, 0, vx=1), C(0, 0), C(ROOT3 + gap, 1), C(ROOT3 + gap, -1)])
    trajectory = run(scene)
    assert [impulses for _, impulses in instants(trajectory)] == [1, 2, 1]
    touching = Scene([C(-5, 0, vx=1), C(0, 0), C(ROOT3, 1), C(ROOT3, -1)])
    assert velocities(trajectory) == velocities(run(touching))


def test_three_with_one_gap_of_one_ulp_go_another_way() -> None:
    """The tip meets one ball first, if only by an ulp: then the outcome is a sequential one."""
    gap = ulp(2.0)
    scene = Scene([C(-5, 0, vx=1), C(0, 0), C(ROOT3, 1), C(ROOT3 + gap, -1)])
    ends = doubles(run(scene))
    near = doubles(
        run(Scene([C(-5, 0, vx=1), C(0, 0), C(ROOT3, 1), C(ROOT3, -1)], tie_policy="sequential:order=scene"))
    )
    assert all(abs(a - b) < 1e-14 for a, b in zip(ends, near, strict=True))
    assert abs(ends[5] - 0.3464) > 0.05  # simultaneously, sqrt(3)/5


def test_a_ball_one_ulp_off_a_wall_makes_three_instants_of_one() -> None:
    gap = ulp(1.0)
    trajectory = run(Scene([C(0, 1 + gap), C(0, 5, vy=-1)], [FLOOR]))
    assert instants(trajectory) == [(2 - Q(gap), 1), (Q(2), 1), (2 + Q(gap), 1)]
    assert velocities(trajectory) == exactly((0, 0), (0, 1))


@pytest.mark.parametrize("angle", ANGLES)
def test_a_ball_one_ulp_out_of_its_corner_makes_three_instants_of_one(angle: int) -> None:
    gap = ulp(2.0)
    trajectory = run(corner(angle, out=Q(gap)))
    assert instants(trajectory) == [(4 - Q(gap), 1), (Q(4), 2), (4 + Q(gap), 1)]
    assert velocities(trajectory) == on_line(0, 1)


@pytest.mark.parametrize("angle", ANGLES)
def test_a_ball_one_ulp_off_one_wall_of_its_corner_hits_them_in_turn(angle: int) -> None:
    """Moved along the lower wall: that one it touches, the upper it does not."""
    gap = Q(ulp(2.0))
    c, s = cosine(angle), sine(angle)
    ball = C(1 / s + gap * c, -gap * s, vx=-1, id="ball")
    trajectory = run(Scene([ball], corner(angle).walls))
    assert trajectory.collisions == 180 // angle
    assert instants(trajectory)[0] == (Q(0), 1)
    assert len(trajectory.events) == 180 // angle
    assert velocities(trajectory) == on_line(1)


OVERLAPPING = {
    "two balls": (lambda e: Scene([C(0, 0, id="a"), C(2 - e, 0, id="b")]), 2.0, "circle 'b': overlaps 'a' by"),
    "a ball and a wall": (lambda e: Scene([C(0, 1 - e, id="a")], [FLOOR]), 1.0, "circle 'a': lies across wall 'floor'"),
    "three": (
        lambda e: Scene([C(0, 0), C(ROOT3, 1, id="up"), C(ROOT3 - e, -1, id="down")]),
        2.0,
        "circle 'down': overlaps 'c1' by",
    ),
    "fifty in a row": (
        lambda e: Scene([C(2 * k - (e if k == 49 else 0), 0, id=f"b{k}") for k in range(50)]),
        100.0,
        "circle 'b49': overlaps 'b48' by",
    ),
    **{
        f"a corner of {angle}": (
            lambda e, angle=angle: corner(angle, out=-e),
            2.0,
            "circle 'ball': lies across wall 'upper'",
        )
        for angle in ANGLES
    },
}


@pytest.mark.parametrize("name", OVERLAPPING)
def test_an_overlap_of_one_ulp_is_refused_by_name(name: str) -> None:
    scene, size, message = OVERLAPPING[name]
    with pytest.raises(SceneError) as error:
        scene(Q(ulp(size)) / 2)  # the spacing below a power of two is half of that above
    assert message in str(error.value)
    assert str(error.value).endswith("at time 0; move it, or reduce r")
    assert scene(Q(0))


# -- the touching cradle, in decimals and in doubles

RADII = ("1", "0.3", "0.7", "0.1")
PLACES = (-2, 0, 1, 2, 3, 4)
"""Places in a row, in diameters: the striker, and five balls that touch."""


def row(radius: Any, xs: list[Any]) -> Scene:
    return Scene([C(x, 0, radius, vx=0 if k else 1, id=f"b{k}") for k, x in enumerate(xs)])


def apart(radius: float) -> list[float]:
    """The least doubles, from left to right, at which balls do not overlap."""
    xs = [-4 * radius, 0.0]
    while len(xs) < len(PLACES):
        x = xs[-1] + 2 * radius
        while Fraction(x) - Fraction(xs[-1]) < 2 * Fraction(radius):
            x = math.nextafter(x, math.inf)
        xs.append(x)
    return xs


@pytest.mark.parametrize("radius", RADII)
def test_the_touching_cradle_is_exact_at_every_radius(radius: str) -> None:
    r = Q(radius)
    trajectory = run(row(r, [2 * r * k for k in PLACES]))
    assert instants(trajectory) == [(2 * r, 5)]
    assert velocities(trajectory) == on_line(0, 0, 0, 0, 0, 1)


@pytest.mark.parametrize(
    ("radius", "pair"), [("0.3", "'b4': overlaps 'b3'"), ("0.7", "'b4': overlaps 'b3'"), ("0.1", "'b5': overlaps 'b4'")]
)
def test_a_cradle_of_rounded_doubles_overlaps_and_is_refused(radius: str, pair: str) -> None:
    r = float(radius)
    with pytest.raises(SceneError, match=pair):
        row(r, [2 * r * k for k in PLACES])


def test_a_cradle_of_doubles_with_radius_one_is_the_exact_one() -> None:
    xs = [2 * 1.0 * k for k in PLACES]
    assert apart(1.0) == xs
    assert row(1.0, xs).digest == row(1, [2 * k for k in PLACES]).digest


@pytest.mark.parametrize("radius", RADII[1:])
def test_a_cradle_of_doubles_that_stand_apart_is_another_scene_with_the_same_end(radius: str) -> None:
    """Some neighbours touch, some have a gap of an ulp: instants follow from it exactly."""
    r = float(radius)
    xs = apart(r)
    gaps = [Fraction(b) - Fraction(a) - 2 * Fraction(r) for a, b in pairwise(xs)][1:]
    assert min(gaps) == 0 < max(gaps) < Fraction(1, 10**15)
    trajectory = run(row(r, xs))
    assert len(trajectory.events) == 1 + sum(gap > 0 for gap in gaps)
    assert trajectory.collisions == 5
    assert velocities(trajectory) == on_line(0, 0, 0, 0, 0, 1)


def test_doubles_get_the_cradle_right_for_radius_one_and_almost_right_otherwise() -> None:
    for radius in RADII:
        r = Q(radius)
        trajectory = DoubleEngine().run(row(r, [2 * r * k for k in PLACES]), until=4)
        vx = doubles(trajectory)[::2]
        assert all(math.isclose(v, e, abs_tol=1e-14) for v, e in zip(vx, (0, 0, 0, 0, 0, 1), strict=True))
        assert (vx == [0, 0, 0, 0, 0, 1]) == (radius == "1")
        assert (trajectory.collisions == 5) == (radius == "1")


def test_intervals_say_that_they_cannot_tell_a_rounded_contact() -> None:
    for radius in RADII:
        r = Q(radius)
        trajectory = IntervalEngine().run(row(r, [2 * r * k for k in PLACES]), until=4)
        undecided = trajectory.stop.reason is StopReason.UNDECIDED
        assert undecided == (radius != "1")


@pytest.mark.parametrize("dt", [1 / 256, 1 / 4096])
def test_an_overlap_made_by_rounding_changes_what_pymunk_does(dt: float) -> None:
    """Where balls overlap by 1e-16 pymunk pushes them together with their neighbours: several fly off."""
    for radius in RADII:
        r = Q(radius)
        trajectory = PymunkEngine(dt=dt).run(row(r, [2 * r * k for k in PLACES]), until=4)
        right = math.isclose(doubles(trajectory)[-2], 1, abs_tol=1e-6)
        assert right == (radius == "1")
