"""The literal engine: signs are decided, the article's procedure is kept, ties follow the policy."""

from __future__ import annotations

from fractions import Fraction
from math import isqrt

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sympy import Integer, Rational, sqrt

from truebreak.exact.literal import symbolic_sign
from truebreak.exact.literal.symbolic_contacts import Disc, Line, approach_sign, touch_times, velocities_after
from truebreak.exact.literal.symbolic_engine import SymbolicEngine
from truebreak.exact.literal.symbolic_sign import SymbolicUndecided, enclosure, normal, quantity, sign
from truebreak.scenarios import Circle, Contact, Quantity, Scene, StopReason, Wall, catalogue

Q = Quantity.of
C = Circle


def run(scene, **limits):
    return SymbolicEngine().run(scene, **limits)


def velocities(trajectory):
    return [(c.vx, c.vy) for c in trajectory.final.circles]


def exact(*pairs):
    return [(Q(x), Q(y)) for x, y in pairs]


def disc(x, y, vx, vy, r=1, m=1):
    x, y, vx, vy, r = map(Integer, (x, y, vx, vy, r))
    return Disc(x, y, vx, vy, r, None if m is None else Integer(m))


# -- signs

S2, S3, S5 = sqrt(2), sqrt(3), sqrt(5)
ZEROS = [
    S2 * S3 - sqrt(6),
    S2 + S3 - sqrt(5 + 2 * sqrt(6)),
    sqrt(1 + S2) * sqrt(S2 - 1) - 1,
    1 / (S2 + S3 + S5) - (2 * S3 + 3 * S2 - sqrt(30)) / 12,
    sqrt(7 + sqrt(2 + S3)) ** 2 - 7 - sqrt(2 + S3),
    sqrt(4 + sqrt(15)) - (sqrt(10) + sqrt(6)) / 2,
    sqrt(S2 + sqrt(S3)) * sqrt(S2 - sqrt(S3)) - sqrt(2 - S3),
]


@pytest.mark.parametrize("zero", ZEROS, ids=str)
def test_zero_is_proved_and_its_neighbours_are_not_zero(zero):
    tiny = Rational(1, 10**200)
    assert sign(zero) == 0
    assert sign(zero + tiny) == 1
    assert sign(zero - tiny) == -1


@given(st.integers(1, 10**30), st.integers(-3, 3))
def test_sign_of_a_root_minus_a_whole_number(radicand, off):
    near = isqrt(radicand) + off
    expected = (radicand > near * near) - (radicand < near * near) if near >= 0 else 1
    assert sign(sqrt(Integer(radicand)) - near) == expected


@given(st.lists(st.fractions(max_denominator=50), min_size=4, max_size=4))
def test_normal_form_keeps_the_value_and_has_no_root_below(parts):
    a, b, c, d = (Rational(p.numerator, p.denominator) for p in parts)
    number = (a + b * S2) / (abs(c) + 1 + d**2 * S3 + sqrt(1 + S2))
    form = normal(number)
    assert sign(form - number) == 0
    assert all(not below.has(sqrt(Integer(2))) for below in form.as_numer_denom()[1:])


def fraction(end):
    """An end of an mpmath interval as the fraction that it is."""
    (negative, mantissa, exponent, _), _ = end._mpi_
    return Fraction(-int(mantissa) if negative else int(mantissa)) * Fraction(2) ** exponent


@given(st.integers(1, 10**40), st.integers(1, 10**40), st.sampled_from([64, 128]))
def test_enclosure_holds_the_square_root(p, q, bits):
    low, high = map(fraction, enclosure(sqrt(Rational(p, q)), bits))
    assert 0 < low <= high <= low * (1 + Fraction(1, 2 ** (bits - 8)))
    assert low * low <= Fraction(p, q) <= high * high


@pytest.mark.parametrize("text", ["sqrt(sqrt(3))/2", "sqrt(sqrt(2) + sqrt(sqrt(5)))", "1/sqrt(sqrt(8))"])
def test_roots_that_sympy_merges_are_taken_apart_again(text):
    number = Q(text).sympy()
    assert quantity(number) == Q(text)
    assert sign(normal(number) - number) == 0


def test_division_by_a_zero_in_disguise_is_refused():
    with pytest.raises(ZeroDivisionError):
        normal(1 / (S2 + S3 - sqrt(5 + 2 * sqrt(6))))


def test_sign_gives_up_past_its_budget_of_terms(monkeypatch):
    monkeypatch.setattr(symbolic_sign, "MAX_TERMS", 1)
    with pytest.raises(SymbolicUndecided):
        sign((1 + S2) * (1 + S3) - (1 + S2 + S3 + sqrt(6)))


# -- the derived laws at numbers


def test_touch_times_of_the_article():
    assert sorted(touch_times(disc(0, 0, 2, 0), disc(4, 0, 0, 0))) == [1, 3]
    assert set(touch_times(disc(2, 2, 1, 1), disc(0, 0, 0, 0))) == {-2 + S2, -2 - S2}
    floor = Line(*map(Integer, (0, 0, 1, 0)))
    assert sorted(touch_times(disc(0, 5, 0, -2), floor)) == [2, 3]


def test_complex_nan_and_infinite_times_are_dropped():
    assert touch_times(disc(0, 0, 1, 0), disc(4, 4, 0, 0)) == []
    assert touch_times(disc(0, 0, 1, 0), disc(4, 0, 1, 0)) == []
    assert touch_times(disc(0, 5, 1, 0), Line(*map(Integer, (0, 0, 1, 0)))) == []


def test_nan_is_seen_where_sympy_does_not_recognise_the_zero():
    """Speeds whose difference is zero only after denesting."""
    a, b = disc(0, 0, 0, 0), disc(9, 0, 0, 0)
    one, other = sqrt(5 + 2 * sqrt(6)), S2 + S3
    a, b = (Disc(d.x, d.y, v, d.vy, d.r, d.m) for d, v in ((a, one), (b, other)))
    assert touch_times(a, b) == []


def test_fixed_circle_reflects():
    assert velocities_after(disc(0, 0, 3, -1), disc(0, -2, 0, 0, m=None)) == (3, 1)


def test_approach_has_a_direction():
    assert approach_sign(disc(0, 0, 1, 0), disc(2, 0, 0, 0)) == 1
    assert approach_sign(disc(0, 0, -1, 0), disc(2, 0, 0, 0)) == -1
    assert approach_sign(disc(0, 0, 0, 1), disc(2, 0, 0, 0)) == 0
    slope = Line(*map(Integer, (-1, -1, 1, 1)))
    at = Disc(-S2 / 2, S2 / 2, Integer(2), Integer(1), Integer(1), Integer(1))
    assert approach_sign(at, slope) == 1
    assert approach_sign(Disc(at.x, at.y, Integer(1), Integer(1), at.r, at.m), slope) == 0


# -- runs


def test_one_collision_then_quiet():
    trajectory = run(Scene([C(0, 0, vx=2), C(4, 0)]))
    (event,) = trajectory.events
    assert event.time == 1
    assert event.contacts == event.impulses == (Contact("c1", "c2"),)
    assert (event.ties, event.coupled) == ((), False)
    assert trajectory.stop.reason is StopReason.QUIET
    assert velocities(trajectory) == exact((0, 0), (2, 0))


def test_galperin_counts_the_digits_of_pi():
    scene = Scene([C(1, 0, 0, m=1, point=True), C(3, 0, 1, vx=-1, m=100)], [Wall(0, 0, 0, 1)])
    trajectory = run(scene)
    assert trajectory.collisions == 31
    assert trajectory.stop.reason is StopReason.QUIET


def lee(policy):
    return Scene([C(-3, 0, 1, vx=1), C(0, 0, 1), C(4, 0, 2, vx=-1, m=4)], tie_policy=policy)


def test_three_balls_of_lee_simultaneous():
    trajectory = run(lee("simultaneous"))
    (event,) = trajectory.events
    assert event.contacts == event.impulses == (Contact("c1", "c2"), Contact("c2", "c3"))
    assert event.coupled
    assert [tie.proof.proved for tie in event.ties] == [True]
    assert velocities(trajectory) == exact((-2, 0), (-1, 0), (0, 0))


LEE_ORDERS = {
    "c1": exact(("-11/5", 0), ("-8/25", 0), ("-3/25", 0)),
    "c2": exact(("-8/5", 0), ("-39/25", 0), ("1/25", 0)),
}
"""Final velocities by the contact that goes first."""


def test_three_balls_of_lee_sequential_in_scene_order():
    trajectory = run(lee("sequential"))
    assert [tuple(pair) for pair in trajectory.events[0].impulses[:2]] == [("c1", "c2"), ("c2", "c3")]
    assert velocities(trajectory) == LEE_ORDERS["c1"]


def test_a_seed_draws_each_order_and_only_these():
    seen = set()
    for seed in range(6):
        trajectory = run(lee(f"sequential:seed={seed}"))
        first = trajectory.events[0].impulses[0].first
        assert velocities(trajectory) == LEE_ORDERS[first]
        assert velocities(run(lee(f"sequential:seed={seed}"))) == LEE_ORDERS[first]
        seen.add(first)
    assert seen == {"c1", "c2"}


def test_one_ball_onto_two_that_touch():
    trajectory = run(Scene([C(0, 0, vx=1), C("3 + sqrt(3)", 1), C("3 + sqrt(3)", -1)]))
    (event,) = trajectory.events
    assert event.time == 3
    assert event.coupled
    assert velocities(trajectory) == exact(("-1/5", 0), ("3/5", "sqrt(3)/5"), ("3/5", "-sqrt(3)/5"))


def test_cradle_that_touches_passes_one_ball_on_in_sequence():
    scene = Scene([C(0, 0, vx=1), C(3, 0), C(5, 0), C(7, 0)], tie_policy="sequential")
    trajectory = run(scene)
    assert trajectory.collisions == 3
    assert velocities(trajectory) == exact((0, 0), (0, 0), (0, 0), (1, 0))


def test_corner_hit_is_a_tie_whose_order_cannot_matter():
    for policy in ("simultaneous", "sequential"):
        scene = Scene([C(0, 0, vx=1, vy=1)], [Wall(4, 0, 4, 1), Wall(0, 4, 1, 4)], tie_policy=policy)
        (event,) = run(scene).events
        assert event.time == 3
        assert len(event.impulses) == 2
        assert not event.coupled


def test_two_far_collisions_at_one_instant_are_one_event():
    scene = Scene([C(0, 0, vx=2), C(4, 0), C(0, 9, vx=2), C(4, 9)])
    (event,) = run(scene).events
    assert event.impulses == (Contact("c1", "c2"), Contact("c3", "c4"))
    assert not event.coupled


def test_grazing_is_no_collision():
    trajectory = run(Scene([C(0, 0, vx=1), C(5, 2)], [Wall(0, -1, 1, -1)]))
    assert trajectory.events == ()
    assert trajectory.stop.reason is StopReason.QUIET
    assert trajectory.final_time == 0


def test_a_circle_that_grazed_one_goes_on_to_hit_another():
    trajectory = run(Scene([C(0, 0, vx=1), C(5, 2), C(9, 0)]))
    assert [(e.time, e.contacts) for e in trajectory.events] == [(7, (Contact("c1", "c3"),))]


def test_touching_and_moving_together_is_no_collision_until_one_is_stopped():
    trajectory = run(Scene([C(0, 0, vx=1), C(2, 0, vx=1)], [Wall(6, 0, 6, 1)]))
    first = trajectory.events[0]
    assert first.time == 3
    assert first.contacts == (Contact("c1", "c2"), Contact("c2", "w1"))
    assert velocities(trajectory) == exact((-1, 0), (-1, 0))


def test_contact_at_time_zero_collides_at_time_zero():
    trajectory = run(Scene([C(0, 0, vx=1), C(2, 0)]))
    assert [event.time for event in trajectory.events] == [0]


def test_fixed_circles_and_walls_stay():
    scene = Scene([C(0, 0, vx=1), C(5, 0, m="oo"), C(9, 0, m="oo")], [Wall(-4, 0, -4, 1)])
    trajectory = run(scene, events=4)
    assert [event.time for event in trajectory.events] == [3, 9, 15, 21]
    assert velocities(trajectory) == exact((1, 0), (0, 0), (0, 0))


def test_points_bounce_off_walls_and_not_off_each_other():
    """They fly to one place at time 2, where no direction of an impact is defined."""
    point = {"r": 0, "point": True}
    scene = Scene([C(0, 1, vx=1, vy=-1, **point), C(4, 1, vx=-1, vy=-1, **point)], [Wall(0, 0, 1, 0)])
    trajectory = run(scene)
    assert [(e.time, len(e.contacts)) for e in trajectory.events] == [(1, 2)]
    assert velocities(trajectory) == exact((1, 1), (-1, 1))


def test_a_number_too_long_for_sympy_ends_the_run_as_undecided():
    trajectory = run(catalogue.build("lorentz:rows=2,r=0"), events=6)
    assert trajectory.stop.reason is StopReason.UNDECIDED
    assert "so long a number" in trajectory.stop.message
