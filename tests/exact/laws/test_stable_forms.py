"""The stable forms: how many operations each takes, and what it keeps."""

from __future__ import annotations

from fractions import Fraction

import law_forms
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sympy import Integer, sqrt, symbols
from test_laws import F

from truebreak.exact.laws import formulas


class Counted:
    """A number that knows five operators only, and counts their uses."""

    used = 0

    def __init__(self, value):
        self.value = Fraction(value)

    def _made(self, value):
        Counted.used += 1
        return Counted(value)

    def __add__(self, other):
        return self._made(self.value + other.value)

    def __sub__(self, other):
        return self._made(self.value - other.value)

    def __mul__(self, other):
        return self._made(self.value * other.value)

    def __truediv__(self, other):
        return self._made(self.value / other.value)

    def __neg__(self):
        return self._made(-self.value)


COSTS = {
    "pair_approach": 3,
    "pair_turned": 8,
    "pair_gap": 5,
    "pair_discriminant": 10,
    "pair_hit_time": 2,
    "pair_nearest_time": 5,
    "pair_last_time": 2,
    "pair_meeting": 12,
    "pair_head_on": 10,
    "pair_strength": 5,
    "pair_impulse": 11,
    "pair_mix": 21,
    "wall_gap": 6,
    "wall_approach": 3,
    "wall_hit_time": 2,
    "wall_bounce": 9,
    "wall_mirror": 9,
    "face_along": 5,
    "face_foot": 3,
    "arc_range": 5,
    "speed_change": 1,
    "damped": 3,
    "advance": 2,
    "sag": 4,
    "fall_speed": 3,
    "fall_discriminant": 5,
    "fall_time": 3,
    "fall_time_back": 4,
}


@pytest.mark.parametrize("form", law_forms.FORMS, ids=lambda form: form.name)
def test_form_needs_five_operators_and_no_more_of_them_than_known(form):
    Counted.used = 0
    getattr(formulas, form.name)(*(Counted(3 * k + 2) for k in range(len(form.parameters))))
    assert Counted.used == COSTS[form.name]


small = st.fractions(min_value=-9, max_value=9, max_denominator=9)
positive = st.fractions(min_value=F(1, 9), max_value=9, max_denominator=9)


@given(small, small, small, small, positive, positive)
def test_impulse_keeps_energy_and_reverses_the_approach(dx, vx, vy, dy, wa, wb):
    """At rational contacts: d scaled so that |d| is the sum of radii needs its square only."""
    if (dx, dy) == (0, 0):
        return
    # R enters as a square alone, so the impulse for R**2 = |d|**2 is that for R = 1 over |d|**2
    jx, jy = (j / (dx * dx + dy * dy) for j in formulas.pair_impulse(dx, dy, vx, vy, F(1), wa, wb))
    ux, uy = vx + (wa + wb) * jx, vy + (wa + wb) * jy
    assert formulas.pair_approach(dx, dy, ux, uy) == -formulas.pair_approach(dx, dy, vx, vy)
    assert dx * uy - dy * ux == dx * vy - dy * vx
    assert ux * ux + uy * uy == vx * vx + vy * vy


@given(small, small, small, small)
def test_wall_bounce_is_a_reflection(vx, vy, nx, ny):
    nn = nx * nx + ny * ny
    if nn == 0:
        return
    ux, uy = formulas.wall_bounce(vx, vy, nx, ny, nn)
    assert ux * ux + uy * uy == vx * vx + vy * vy
    assert formulas.wall_approach(ux, uy, nx, ny) == -formulas.wall_approach(vx, vy, nx, ny)
    assert formulas.wall_bounce(ux, uy, nx, ny, nn) == (vx, vy)


@given(small, small, positive)
def test_wall_hit_brings_the_gap_to_zero(x, vx, r):
    gap = formulas.wall_gap(x, F(7), F(-20), F(0), F(2), F(0), 2 * r)
    approach = formulas.wall_approach(vx, F(1), F(2), F(0))
    if approach >= 0:
        return
    there = formulas.advance(x, vx, formulas.wall_hit_time(gap, approach))
    assert there - r == -20


def test_hit_time_equals_the_textbook_root_where_numbers_are_rational():
    d, v, reach = (F(10), F(1)), (F(-3), F(0)), F(1)
    gap, approach = formulas.pair_gap(*d, reach), formulas.pair_approach(*d, *v)
    assert formulas.pair_discriminant(*d, *v, reach) == 0
    assert formulas.pair_hit_time(gap, approach, F(0)) == F(10, 3)


def test_hit_time_keeps_the_digits_that_the_textbook_root_loses_near_contact():
    dx, vx, reach = 2 + 2.0**-20, -0.1, 2.0
    exact = (F(dx) - F(reach)) / -F(vx)
    gap, approach = formulas.pair_gap(dx, 0.0, reach), formulas.pair_approach(dx, 0.0, vx, 0.0)
    root = formulas.pair_discriminant(dx, 0.0, vx, 0.0, reach) ** 0.5
    stable, textbook = formulas.pair_hit_time(gap, approach, root), (-approach - root) / vx**2
    assert abs(F(stable) / exact - 1) < 2.0**-51
    assert abs(F(textbook) / exact - 1) > 2.0**-40


# -- the writing of Python


def test_renderer_writes_a_square_in_a_product_in_parentheses():
    x, y = symbols("x y")
    assert law_forms.python((x + y) * y**2, {x: 0, y: 1}) == "(x + y) * (y * y)"


def test_renderer_refuses_what_it_has_no_form_for():
    x = symbols("x")
    for expression in (sqrt(x), 3 * x, x**3, Integer(1)):
        with pytest.raises(ValueError):
            law_forms.python(expression, {x: 0})
