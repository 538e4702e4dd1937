"""The geometry of isometries is that of the plane: the code itself runs on rational functions, and what it says of
distances, lines and images is held against what an isometry is.

A direction turned by some angle is (1 - s^2, 2 s) / (1 + s^2) of the one before, s the tangent of half of it: all
rotations are of this form but the one by half a turn, which is looked at by itself. So what holds here holds for all.
"""

from __future__ import annotations

from itertools import product
from types import SimpleNamespace

import pytest
from flint import fmpq
from sympy import QQ
from sympy.polys.fields import field

from truebreak.exact import isometry
from truebreak.exact import log_symmetry as held
from truebreak.exact.isometry import Isometry, SceneData, from_vectors, line_key, minus, turned, wall_key

NAMES = "ux, uy, wx, wy, px, py, qx, qy, nx, ny, s, t, k"
_, ux, uy, wx, wy, px, py, qx, qy, nx, ny, s, t, k = field(NAMES, QQ)
ONE, ZERO = s / s, s - s
U, W, P, Q, N = (ux, uy), (wx, wy), (px, py), (qx, qy), (nx, ny)

COS, SIN = (1 - s * s) / (1 + s * s), 2 * s / (1 + s * s)
ROTATION, MIRROR = (COS, -SIN, SIN, COS), (COS, SIN, SIN, -COS)
HALF_TURN, UPRIGHT = (-ONE, ZERO, ZERO, -ONE), (-ONE, ZERO, ZERO, ONE)
EVERY = {"rotation": ROTATION, "mirror": MIRROR, "half turn": HALF_TURN, "the mirror left out": UPRIGHT}
every = pytest.mark.parametrize("matrix", EVERY.values(), ids=EVERY)


@pytest.fixture(autouse=True)
def signs(monkeypatch):
    """A sign tells only zero from what is not: no formula here asks for more."""
    monkeypatch.setattr(isometry, "field_sign", lambda value: 0 if value == 0 else 1)


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1]


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


def plus(a, b, times=1):
    return a[0] + times * b[0], a[1] + times * b[1]


def is_orthogonal(matrix) -> bool:
    a, b, c, d = matrix
    return a * a + c * c == 1 == b * b + d * d and a * b + c * d == 0


def of_lines(*walls) -> SceneData:
    """The data of some lines, and of a circle at P."""
    data = SceneData.__new__(SceneData)
    data.gravity = None
    data.n, data.places, data.speeds, data.kinds, data.pockets = 1, [P], [U], [(ONE, ONE)], []
    data.walls, data.ends = list(walls), [None] * len(walls)
    data.paces = [ZERO for _ in walls]
    data.wall_of = {wall_key(*wall, None, ZERO): k for k, wall in enumerate(walls)}
    return data


def moving(matrix, point=P, image=Q, data=None) -> Isometry:
    """As `LogSymmetry.isometry` makes it."""
    return Isometry(data or SimpleNamespace(gravity=None), matrix, minus(image, turned(matrix, point)))


@every
def test_an_isometry_keeps_distances_and_takes_a_point_to_its_image(matrix):
    g = moving(matrix)
    assert is_orthogonal(matrix)
    assert g.move(P) == Q
    between = minus(g.move(U), g.move(W))
    assert dot(between, between) == dot(minus(U, W), minus(U, W))
    assert between == g.turn(minus(U, W))
    assert moving(matrix, P, P).move(P) == P  # `isometry_about`


@every
def test_the_maps_between_two_vectors_are_all_there_are(matrix):
    """Sound: each is orthogonal, and takes the one to the other. Complete: any that does is among them."""
    image = turned(matrix, U)
    found = list(from_vectors([U], [image]))
    assert len(found) == 2
    assert all(is_orthogonal(one) and turned(one, U) == image for one in found)
    assert matrix in found
    (a, b, c, d), (e, f, g, h) = found
    assert (a * d - b * c, e * h - f * g) == (1, -1)  # the rotation, then the mirror


@every
def test_of_two_vectors_one_map_is_left_and_none_of_lengths_that_differ(matrix):
    images = [turned(matrix, U), turned(matrix, W)]
    assert list(from_vectors([U, W], images)) == [matrix]
    assert list(from_vectors([(ZERO, ZERO), U, W], [(ZERO, ZERO), *images])) == [matrix]
    assert not list(from_vectors([U], [plus(images[0], images[0])]))
    assert not list(from_vectors([(ZERO, ZERO), U], [U, U]))
    assert not list(from_vectors([(ZERO, ZERO)], [(ZERO, ZERO)]))


LINES = {"oblique": N, "upright": (nx, ZERO), "level": (ZERO, ny)}
lines = pytest.mark.parametrize("normal", LINES.values(), ids=LINES)


@lines
def test_a_line_has_one_key_and_a_key_one_line(normal):
    along = (-normal[1], normal[0])
    key = line_key(P, normal, dot(normal, W))
    scaled = k * normal[0], k * normal[1]
    assert line_key(plus(P, along, t), scaled, dot(scaled, W)) == key
    assert line_key(P, normal, dot(normal, plus(W, normal))) != key  # it moves otherwise
    assert line_key(P, normal, dot(normal, plus(W, along))) == key
    assert cross(key[:2], normal) == 0 != dot(key[:2], key[:2])
    assert dot(key[:2], plus(P, along, t)) == key[2]
    assert line_key(plus(P, normal), normal, dot(normal, W)) != key


@every
@lines
def test_the_image_of_a_line_holds_the_images_of_its_points(matrix, normal):
    g = moving(matrix, U, W)
    image = (g.move(P), g.turn(normal))
    g._data = of_lines((P, normal), (plus(image[0], turned(matrix, (-normal[1], normal[0])), k), image[1]))
    assert g.wall(0) == (0 if line_key(*image, ZERO) == line_key(P, normal, ZERO) else 1)
    there = g.move(plus(P, (-normal[1], normal[0]), t))
    assert dot(image[1], minus(there, image[0])) == 0


@every
@lines
def test_the_foot_is_the_way_from_the_wall_at_right_angles_and_goes_with_an_isometry(matrix, normal):
    data = of_lines((Q, normal))
    foot = data.foot(0, 0)
    assert cross(foot, normal) == 0
    assert dot(normal, minus(minus(P, foot), Q)) == 0
    g, other = moving(matrix, U, W), of_lines()
    other.walls, other.places = [(g.move(Q), g.turn(normal))], [g.move(P)]
    assert other.foot(0, 0) == g.turn(foot)


def times(a, b):
    """A product of linear maps."""
    one, two = turned(a, (b[0], b[2])), turned(a, (b[1], b[3]))
    return one[0], two[0], one[1], two[1]


QUARTER = (ZERO, -ONE, ONE, ZERO)
GROUPS = {
    "a mirror": [MIRROR],
    "half a turn": [HALF_TURN],
    "quarter turns": [QUARTER, HALF_TURN, times(QUARTER, HALF_TURN)],
    "two mirrors": [MIRROR, times(HALF_TURN, MIRROR), HALF_TURN],
}


@pytest.mark.parametrize("group", GROUPS.values(), ids=GROUPS)
def test_the_mean_of_a_group_projects_on_what_all_of_it_leaves_in_place(group):
    """It is its own square, what it gives is left in place by each, and what each leaves in place it leaves."""
    mean, centre = held._mean([SimpleNamespace(matrix=matrix, centre=P) for matrix in group])
    assert centre == P
    assert times(mean, mean) == mean
    assert all(times(matrix, mean) == mean == times(mean, matrix) for matrix in group)
    fixed = plus(U, turned(MIRROR, U)) if len(group) == 1 and group[0] == MIRROR else (ZERO, ZERO)
    assert turned(mean, fixed) == fixed


def test_the_axis_of_a_mirror_is_what_it_leaves_in_place():
    centre = (fmpq(3), fmpq(5))
    for a, b, c, d in product((-1, 0, 1), repeat=4):
        found = held._axis([(SimpleNamespace(matrix=(a, b, c, d), centre=centre), None)])
        if found is None:
            assert (a, b, c, d) not in ((1, 0, 0, -1), (-1, 0, 0, 1))
            continue
        level, offset = found
        on_it = (7, int(float(offset))) if level else (int(float(offset)), 7)
        x, y = on_it[0] - 3, on_it[1] - 5
        assert (3 + a * x + b * y, 5 + c * x + d * y) == on_it
