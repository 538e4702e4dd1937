"""Laws of the filter: what doubles tell is true of the exact numbers, on easy states and on cruel ones."""

from __future__ import annotations

import math
from fractions import Fraction as Q

import pytest
from flint import arb, ctx
from hypothesis import given, settings
from hypothesis import strategies as st

from truebreak.exact.certified.filtered import DoubleFilter, float_line
from truebreak.exact.replay.contact import Body, Flight

wide = st.fractions(min_value=-1000, max_value=1000, max_denominator=10**6)
slow = st.fractions(min_value=-2, max_value=2, max_denominator=10**6)
radius = st.fractions(min_value=Q(1, 1000), max_value=5, max_denominator=1000)
clock = st.fractions(min_value=0, max_value=5000, max_denominator=10**6)
tiny = st.sampled_from([Q(0), Q(1, 10**9), Q(-1, 10**12), Q(1, 10**15), Q(-1, 10**17), Q(1, 10**25)])


def body(index: int, state: list[Q], filter_: DoubleFilter) -> Body:
    made = Body(index, Flight(*[arb(0)] * 6), arb(1), arb(1))
    ctx.prec = 128
    made.q = tuple(arb(q.numerator) / q.denominator for q in state)
    filter_.admit(made, made.flight.late)
    return made


def enclosed_root(value: Q, bits: int = 400) -> tuple[Q, Q]:
    scale = 1 << bits
    low = math.isqrt(value.numerator * scale * scale // value.denominator)
    return Q(low, scale), Q(low + 1, scale)


def check_pair(filter_: DoubleFilter, a: list[Q], b: list[Q], reach: Q) -> str:
    one, other = body(0, a, filter_), body(1, b, filter_)
    told, unclear = filter_.pairs(one, [other], [float(reach)])
    assert repr(filter_.pairs(other, [one], [float(reach)])).replace("Body(0", "Body(1") == repr((told, unclear))
    if b[4] > a[4]:
        a, b = b, a
    lag = a[4] - b[4]
    dx, dy = b[0] + b[2] * lag - a[0], b[1] + b[3] * lag - a[1]
    vx, vy = b[2] - a[2], b[3] - a[3]
    approach, gap = dx * vx + dy * vy, dx * dx + dy * dy - reach * reach
    disc = (vx * vx + vy * vy) * reach * reach - (dx * vy - dy * vx) ** 2
    hits = approach < 0 and disc > 0
    if unclear:
        assert (told, unclear) == ([], [other])
        return "unclear"
    if not told:
        assert not hits or gap <= 0
        return "miss"
    ((low, high, named),) = told
    assert named is other
    assert hits
    low_root, high_root = enclosed_root(disc)
    square = vx * vx + vy * vy
    early = a[4] + (-approach - high_root) / square
    late = a[4] + (-approach - low_root) / square
    assert Q(low) <= early
    assert late <= Q(high)
    return "hit"


@settings(max_examples=600)
@given(st.lists(wide, min_size=4, max_size=4), st.lists(slow, min_size=4, max_size=4), clock, clock, radius)
def test_what_is_told_of_a_pair_is_true(places, speeds, first, second, reach):
    a = [places[0], places[1], speeds[0], speeds[1], first]
    b = [places[2], places[3], speeds[2], speeds[3], second]
    check_pair(DoubleFilter(), a, b, reach)


@pytest.mark.parametrize("apart", [Q(0), Q(1, 10**20), Q(-1, 10**20), Q(1), Q(-1)])
def test_a_hit_counts_only_after_both_flights_have_begun(apart):
    """Of two clocks that doubles do not tell apart, either flight may be the later; b's, plainly the earlier, does not
    matter."""
    for late in (Q(1, 2), Q(3)):
        for which in (0, 1):
            filter_ = DoubleFilter()
            clocks = [Q(7), 7 + apart]
            two = [body(k, [Q(4 * k), Q(0), Q(1 - 2 * k), Q(0), clocks[k]], filter_) for k in (0, 1)]
            two[which].flight = two[which].flight._replace(late=arb(late.numerator) / late.denominator)
            filter_.admit(two[which], two[which].flight.late)
            hit = 7 + 1 + apart / 2  # the gap of 2 closes at 2, and a later clock finds b where it then is
            told, unclear = filter_.pairs(two[0], [two[1]], [2.0])
            if (which == 1 and apart == -1) or hit > max(clocks) + late:
                assert not unclear
                assert told[0][0] <= hit <= told[0][1]
            else:
                assert not told


@settings(max_examples=600)
@given(st.lists(slow, min_size=4, max_size=4), tiny, tiny, radius, clock, st.integers(1, 400))
def test_what_is_told_of_a_near_graze_is_true(speeds, miss, shift, reach, now, far):
    """b passes a at a distance of the sum of radii, give or take next to nothing, or next to touching."""
    vx, vy = speeds[2] - speeds[0], speeds[3] - speeds[1]
    if vx == 0 and vy == 0:
        return
    low, _ = enclosed_root(vx * vx + vy * vy)
    ux, uy = vx / low, vy / low
    along = Q(far, 100)
    dx, dy = -along * ux + (reach + miss) * uy, -along * uy - (reach + miss) * ux
    a = [Q(3), Q(-7), speeds[0], speeds[1], now]
    b = [3 + dx + shift, -7 + dy, speeds[2], speeds[3], now]
    check_pair(DoubleFilter(), a, b, reach)


def test_the_filter_decides_most_of_a_dilute_gas():
    """A filter that called everything unclear would be true and of no use."""
    from truebreak.exact import ExactEngine
    from truebreak.scenarios import catalogue

    plan = ExactEngine().run(catalogue.build("gas:n=10,seed=3"), events=300).plan
    assert plan.get("unclear in doubles", 0) < plan["pairs predicted"] / 100


@settings(max_examples=400)
@given(wide, wide, slow, slow, clock, slow, slow, wide, wide, radius)
def test_what_is_told_of_a_wall_is_true(x, y, vx, vy, now, nx, ny, x0, y0, offset):
    filter_ = DoubleFilter()
    one = body(0, [x, y, vx, vy, now], filter_)
    ctx.prec = 128
    line = float_line(0, *(arb(q.numerator) / q.denominator for q in (x0, y0, nx, ny, offset)))
    told, unclear = filter_.walls(one, [line])
    approach, gap = nx * vx + ny * vy, nx * (x - x0) + ny * (y - y0) - offset
    if unclear:
        assert (told, unclear) == ([], [0])
        return
    if not told:
        assert approach >= 0
        return
    ((low, high, wall),) = told
    assert wall == 0
    assert approach < 0 < gap
    assert Q(low) <= now - gap / approach <= Q(high)


@settings(max_examples=300)
@given(st.lists(st.tuples(wide, wide, slow, slow, clock), min_size=3, max_size=6), radius, radius)
def test_a_row_of_several_is_told_as_one_by_one(states, r, s):
    """Order is kept, and misses are left out; each body's sum of radii is that of its kind."""
    filter_ = DoubleFilter()
    present = max(state[4] for state in states)
    bodies = [body(i, [*state[:4], present if i == 0 else state[4]], filter_) for i, state in enumerate(states)]
    for other in bodies[1:]:
        other.kind = other.index % 2
    one, others, reaches = bodies[0], bodies[1:], [float(r), float(s)]
    alone = [filter_.pairs(one, [other], reaches) for other in others]
    told, unclear = filter_.pairs(one, others, reaches)
    assert repr(told) == repr([found for mine, _ in alone for found in mine])
    assert unclear == [body for _, mine in alone for body in mine]


def off_rim(centre: list[Q], pocket: list[Q], r: Q) -> tuple[bool, bool]:
    """What the filter tells of a centre and a rim, and what is true."""
    filter_ = DoubleFilter()
    one, hole = body(0, centre, filter_), body(-1, [*pocket, Q(0), Q(0), Q(0)], filter_)
    dx, dy = pocket[0] - centre[0], pocket[1] - centre[1]
    return filter_.apart(one, hole, float(r)), dx * dx + dy * dy != r * r


@settings(max_examples=400)
@given(wide, wide, slow, slow, clock, wide, wide, radius)
def test_a_centre_told_to_be_off_a_rim_is_off_it(x, y, vx, vy, now, px, py, r):
    told, true = off_rim([x, y, vx, vy, now], [px, py], r)
    assert true or not told


@settings(max_examples=600)
@given(wide, wide, slow, slow, clock, st.sampled_from([(3, 4, 5), (5, 12, 13), (20, 21, 29), (1, 0, 1)]), radius, tiny)
def test_a_centre_on_a_rim_or_next_to_it_is_never_told_to_be_off_it(x, y, vx, vy, now, triple, r, miss):
    """Rational points of a rim; the doubles of centre, pocket and radius round, the filter must not."""
    a, b, c = triple
    pocket = [x + r * a / c, y + r * b / c]
    assert off_rim([x, y, vx, vy, now], pocket, r) == (False, False)
    told, true = off_rim([x + miss, y, vx, vy, now], pocket, r)
    assert true or not told


def test_a_centre_far_from_a_rim_is_told_to_be_off_it():
    """A filter that told nothing would be true and of no use."""
    for x in ("1/2", "9/10", "11/10", "99/100", "1000001/1000000", "5"):
        assert off_rim([Q(x), Q(0), Q(1), Q(0), Q(10)], [Q(0), Q(0)], Q(1)) == (True, True)


def test_of_bodies_without_doubles_nothing_is_told():
    filter_ = DoubleFilter()
    sharp = body(0, [Q(0), Q(0), Q(1), Q(0), Q(0)], filter_)
    blurred = body(1, [Q(5), Q(0), Q(0), Q(0), Q(0)], filter_)
    blurred.f = None
    ctx.prec = 128
    line = float_line(0, arb(9), arb(0), arb(-1), arb(0), arb(1))
    for a, b in ((sharp, blurred), (blurred, sharp)):
        assert filter_.pairs(a, [b], [2.0]) == ([], [b])
        assert not filter_.apart(a, b, 1.0)
    assert filter_.walls(blurred, [line]) == ([], [0])
    ((low, high, _),), _ = filter_.walls(sharp, [line])
    assert low <= 8 <= high


@pytest.mark.parametrize("scale", [Q(10) ** k for k in (-200, -110, -60, 60, 99, 110, 200)])
def test_scales_beyond_safe_doubles_are_left_to_balls_or_told_rightly(scale):
    a = [Q(0), Q(0), scale, Q(0), Q(0)]
    b = [4 * scale, scale / 3, Q(0), Q(0), Q(0)]
    check_pair(DoubleFilter(), a, b, scale)


def test_an_unsharp_ball_is_not_admitted():
    filter_ = DoubleFilter()
    blurred = Body(0, Flight(*[arb(0)] * 6), arb(1), arb(1))
    blurred.q = (arb("1 +/- 1e-10"), arb(0), arb(1), arb(0), arb(0))
    filter_.admit(blurred, blurred.flight.late)
    assert blurred.f is None
