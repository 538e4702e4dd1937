"""The laws that every event-driven engine must keep, whatever it counts in."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise
from random import Random

import mpmath
import numpy as np
import pytest
from flint import arb, ctx
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from truebreak.exact import ExactEngine
from truebreak.exact.certified import cascade as reading
from truebreak.exact.certified import certified_decider as decider
from truebreak.exact.certified import filtered as filtered_prediction
from truebreak.exact.replay import refinable as live
from truebreak.floating import DoubleEngine, IntervalEngine
from truebreak.scenarios import Circle, Quantity, Scene, Wall

F = Fraction
ONE = F(1)
EVENTS = 12
ENGINES = {"exact": ExactEngine(), "double": DoubleEngine(), "interval": IntervalEngine(bits=200)}
TOLERANCE = {"exact": 1e-60, "double": 1e-7, "interval": 1e-25}
"""Share of the time by which two runs of one scene may differ."""

fixed_examples = settings(
    derandomize=True, database=None, deadline=None, max_examples=12, suppress_health_check=list(HealthCheck)
)
seeds = st.integers(0, 10**6)
every_engine = pytest.mark.parametrize("engine", ENGINES)


# -- scenes


def gas(seed: int, boxed: bool = True, roots: bool = True) -> Scene:
    """2 to 6 mixed discs, some with roots in their numbers, in a box with a slanted wall."""
    draw = Random(seed)
    placed: list[tuple[int, int, int]] = []
    wanted, circles = draw.randrange(2, 7), []
    while len(circles) < wanted:
        r, x, y = draw.randrange(200, 900), draw.randrange(900, 9100), draw.randrange(900, 9100)
        if not all((x - a) ** 2 + (y - b) ** 2 > (r + s) ** 2 for a, b, s in placed):
            continue
        if not r + 4 < x < 9990 - r or not r + 4 < y < 9990 - r or x + 2 * y < 4000 + 3 * r:
            continue
        placed.append((x, y, r))
        root = f" + sqrt({draw.choice((2, 3, 5))})/1000" if roots and draw.random() < 0.3 else ""
        inward = (5000 - x, 5000 - y) if not boxed else (0, 0)
        vx, vy = (f"{draw.randrange(-999, 1000) + part // 4}/1000" for part in inward)
        mass = F(draw.randrange(200, 5000), 1000)
        circles.append(Circle(f"{x}/1000{root}", f"{y}/1000", f"{r}/1000", vx, vy, mass))
    walls = [Wall(0, 0, 1, 0), Wall(0, 10, 1, 10), Wall(0, 0, 0, 1), Wall(10, 0, 10, 1), Wall(4, 0, 0, 2)]
    return Scene(circles, walls if boxed else (), name=f"gas {seed}")


Point = Callable[[Quantity, Quantity], tuple[Quantity, Quantity]]


def mapped(scene: Scene, place: Point, velocity: Point, size: Fraction | int = 1) -> Scene:
    """The scene with every place and velocity mapped, and every radius times `size`."""
    circles = [Circle(*place(c.x, c.y), c.r * size, *velocity(c.vx, c.vy), c.m, c.id, c.point) for c in scene.circles]
    walls = [Wall(*place(w.x0, w.y0), *place(w.x1, w.y1), id=w.id) for w in scene.walls]
    return scene.with_changes(circles=circles, walls=walls)


# -- what is compared


def history(run, limit=EVENTS):
    """(pairs in contact, number of impulses) of every instant."""
    return [(frozenset(map(frozenset, e.contacts)), len(e.impulses)) for e in run.events[:limit]]


def middle(number) -> mpmath.mpf:
    """A time of any engine to 300 bits."""
    mantissa, exponent = number.ball(300).mid().man_exp()
    return mpmath.mpf(int(mantissa)) * mpmath.mpf(2) ** int(exponent)


def assert_same_history(engine, one, other, factor=ONE):
    """The same instants, at times that differ by a factor only."""
    assert history(one) == history(other)
    assert one.stop.reason is other.stop.reason
    last = float(one.events[-1].time) * factor if one.events else 0
    with mpmath.workprec(300):
        for a, b in zip(one.events, other.events, strict=True):
            error = abs(middle(a.time) * factor.numerator / factor.denominator - middle(b.time))
            assert error <= TOLERANCE[engine] * float(last)


# -- symmetries of space and time


@every_engine
@fixed_examples
@given(seed=seeds)
def test_the_order_in_which_circles_and_walls_are_listed_does_not_matter(engine, seed):
    scene = gas(seed)
    shuffled = scene.with_changes(
        circles=Random(seed).sample(scene.circles, len(scene.circles)), walls=scene.walls[::-1]
    )
    runs = [ENGINES[engine].run(s, events=EVENTS) for s in (scene, shuffled)]
    assert_same_history(engine, *runs)


@every_engine
@fixed_examples
@given(seed=seeds)
def test_the_mirror_image_has_the_mirrored_history(engine, seed):
    scene = gas(seed)
    image = mapped(scene, lambda x, y: (y, x), lambda x, y: (y, x))
    assert_same_history(engine, *(ENGINES[engine].run(s, events=EVENTS) for s in (scene, image)))


@every_engine
@fixed_examples
@given(seed=seeds)
def test_a_turned_scene_has_the_turned_history(engine, seed):
    def turn(x, y):
        return (3 * x - 4 * y) / 5, (4 * x + 3 * y) / 5

    scene = gas(seed)
    image = mapped(scene, turn, turn)
    assert_same_history(engine, *(ENGINES[engine].run(s, events=EVENTS) for s in (scene, image)))


@every_engine
@fixed_examples
@given(seed=seeds)
def test_without_walls_only_relative_motion_counts(engine, seed):
    scene = gas(seed, boxed=False)
    moving = mapped(
        scene,
        lambda x, y: (x + F(1, 3), y - 7),
        lambda x, y: (x + F(5, 7), y - F(2, 3)),
    )
    assert_same_history(engine, *(ENGINES[engine].run(s, events=EVENTS) for s in (scene, moving)))


@every_engine
@pytest.mark.parametrize(("length", "time"), [(F(10, 3), F(7)), (F(1, 10**9), F(10**6)), (F(10**9), F(3, 10**6))])
@fixed_examples
@given(seed=seeds)
def test_units_do_not_matter(engine, length, time, seed):
    scene = gas(seed)
    image = mapped(
        scene,
        lambda x, y: (x * length, y * length),
        lambda x, y: (x * (length / time), y * (length / time)),
        length,
    )
    one, other = (ENGINES[engine].run(s, events=EVENTS) for s in (scene, image))
    assert_same_history(engine, one, other, time)


@fixed_examples
@given(seed=seeds, after=st.integers(1, 60))
def test_a_reversed_history_comes_back_to_its_start_exactly(seed, after):
    scene = gas(seed).with_changes(reverse_after=after)
    run = ExactEngine().run(scene)
    assume(run.reversal is not None)
    start = [[float(c.x), float(c.y), -float(c.vx), -float(c.vy)] for c in scene.circles]
    assert run.final.array().tolist() == start
    assert "came back to the start exactly" in run.notes[0]
    contacts = [frozenset(map(frozenset, event.contacts)) for event in run.events]
    assert contacts == contacts[::-1]


# -- conserved quantities


def sums(run, time):
    """Energy and both momenta at a time, in the engine's own enclosures (for doubles, in doubles)."""
    rows = []
    for circle, state in zip(run.scene.circles, run.at(time).circles, strict=True):
        m = circle.m
        vx, vy = state.vx, state.vy
        if isinstance(vx, float):
            rows.append((float(m), vx, vy))
        else:
            rows.append((arb(m.rational), vx.ball(256), vy.ball(256)))
    return [
        sum(m * (vx * vx + vy * vy) for m, vx, vy in rows),
        sum(m * vx for m, vx, _ in rows),
        sum(m * vy for m, _, vy in rows),
    ]


def agree(a, b, engine):
    """Whether two numbers may be equal, and are known well enough for that to mean something."""
    if engine in ("exact", "interval"):
        return (a - b).contains(0) and (a - b).abs_upper() < (1e-50 if engine == "exact" else 1e-30)
    return abs(a - b) <= 1e-12 * max(1, abs(a))


@every_engine
@fixed_examples
@given(seed=seeds)
def test_energy_is_conserved_always_and_momentum_without_walls(engine, seed):
    saved, saved_iv = ctx.prec, mpmath.iv.prec
    ctx.prec, mpmath.iv.prec = 256, 200
    try:
        for boxed in (True, False):
            run = ENGINES[engine].run(gas(seed, boxed), events=EVENTS)
            start = sums(run, 0)
            for event in run.events:
                now = sums(run, event.time)
                assert agree(start[0], now[0], engine)
                if not boxed:
                    assert agree(start[1], now[1], engine)
                    assert agree(start[2], now[2], engine)
    finally:
        ctx.prec, mpmath.iv.prec = saved, saved_iv


# -- agreement of engines, and of one engine with itself


@fixed_examples
@given(seed=seeds, bits=st.sampled_from([53, 120]))
def test_intervals_enclose_the_exact_times_and_states(seed, bits):
    exact = ExactEngine().run(gas(seed), events=40)
    interval = IntervalEngine(bits=bits).run(gas(seed), events=40)
    assert history(interval, None) == history(exact, len(interval.events))
    for mine, theirs in zip(exact.events, interval.events, strict=False):
        assert theirs.time.low <= float(mine.time) <= theirs.time.high
        for a, b in zip(exact.at(mine.time).circles, interval.at(theirs.time).circles, strict=True):
            for name in ("vx", "vy"):
                assert getattr(b, name).low <= float(getattr(a, name)) <= getattr(b, name).high


def fingerprint(run):
    """Everything certified that a run says."""
    return (
        [(float(e.time), e.time.digits(40), e.contacts, e.impulses, e.coupled) for e in run.events],
        run.stop.reason,
        run.final.array().tolist(),
    )


@pytest.mark.parametrize("seed", range(6))
def test_the_precision_that_a_run_starts_with_does_not_matter(seed, monkeypatch):
    scene, seen = gas(seed), []
    for first, quick in ((256, 128), (64, 64), (128, 128), (512, 512), (1000, 96)):
        monkeypatch.setattr(decider, "FIRST_BITS", first)
        for module in (filtered_prediction, reading):
            monkeypatch.setattr(module, "QUICK_BITS", quick)
        seen.append(fingerprint(ExactEngine().run(scene, events=150)))
    assert all(one == other for one, other in pairwise(seen))


@pytest.mark.parametrize("seed", range(6))
def test_fields_and_balls_give_the_same_history(seed, monkeypatch):
    seen = []
    for bits in (768, 0, 10**9):
        monkeypatch.setattr(live, "FIELD_BITS", bits)
        events = 25 if bits == 10**9 else 60
        seen.append(fingerprint(ExactEngine().run(gas(seed), events=events)))
    assert seen[0] == seen[1]
    assert seen[0][0][:25] == seen[2][0][:25]


@pytest.mark.parametrize("bits", [2, 24, 53, 4000])
def test_the_callers_precision_neither_matters_nor_changes(bits):
    saved = ctx.prec
    expected = fingerprint(ExactEngine().run(gas(1), events=30))
    try:
        ctx.prec = bits
        run = ExactEngine().run(gas(1), events=30)
        assert ctx.prec == bits
        assert fingerprint(run) == expected
        run.sample([0.0, 0.5])
        assert ctx.prec == bits
    finally:
        ctx.prec = saved


# -- the numbers handed out


def fraction(value) -> Fraction:
    """A number to 3,000 bits."""
    mantissa, exponent = value.ball(3000).mid().man_exp()
    return F(int(mantissa)) * F(2) ** int(exponent)


@fixed_examples
@given(seed=seeds)
def test_a_number_is_its_nearest_double_and_its_digits_and_its_text(seed):
    run = ExactEngine().run(gas(seed), events=8)
    for event in run.events:
        rows = [number for c in run.at(event.time).circles for number in (c.x, c.y, c.vx, c.vy)]
        for number in (event.time, *rows):
            assert float(number) == float(fraction(number))  # Python rounds fractions to the nearest
    for event in run.events[:2]:
        digits = event.time.digits(40)
        assert abs(F(digits) / fraction(event.time) - 1) < F(1, 10**38)
        text = event.time.text()
        if text is not None and len(text) < 2000:
            assert Quantity.of(text).ball(200).overlaps(event.time.ball(200))


@fixed_examples
@given(seed=seeds)
def test_flight_is_straight_between_events_and_the_state_at_one_is_as_it_leaves(seed):
    run = ExactEngine().run(gas(seed), events=EVENTS, until=50)
    start = [[float(v) for v in (c.x, c.y, c.vx, c.vy)] for c in run.scene.circles]
    assert run.at(0).array().tolist() == start or float(run.events[0].time) == 0
    times = [Quantity.of(0), *(e.time for e in run.events)]
    for before, after in pairwise(times):
        early, late = float(before), float(after)
        middle_time = early + (late - early) / 2
        state, leaving = run.at(middle_time).array(), run.at(before).array()
        assert (state[:, 2:] == leaving[:, 2:]).all()
        reached = leaving[:, :2] + leaving[:, 2:] * (middle_time - early)
        assert np.allclose(state[:, :2], reached, rtol=1e-12, atol=1e-12)
        sampled = run.sample([middle_time])[0]
        assert sampled.tolist() == state.tolist()


@pytest.mark.parametrize("digits", [20, 30, 36, 38, 45, 80])
def test_a_time_just_beside_an_event_is_told_from_it(digits):
    run = ExactEngine().run(gas(3, roots=False), events=120)
    for event in run.events[40:-1:5]:
        beside = Quantity.of(event.time.digits(digits))
        is_after = (beside.ball(2000) - event.time.ball(2000)) > 0
        leaving = run.at(event.time)[event.contacts[0].first]
        seen = run.at(beside)[event.contacts[0].first]
        assert ((float(seen.vx), float(seen.vy)) == (float(leaving.vx), float(leaving.vy))) == is_after
