"""The exact engine against the referee of the fuzz where everything happens at once, and scenes that once broke it.

More kinds of scenes, and more checks of each, are in `fuzz`.
"""

from __future__ import annotations

from fractions import Fraction
from random import Random

import mpmath
import pytest
from flint import arb
from fuzz.check import check
from fuzz.table import TooLong
from mpmath import mpf
from referee import compare_to_referee, referee
from referee_scenes import gas, polygon

from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Quantity, Scene, Wall
from truebreak.scenarios.errors import SceneError

F = Fraction
BITS = 500
SAME_TIME = mpf(10) ** -25


def number(value) -> mpf:
    """A Quantity or an ExactValue as an mpf."""
    mantissa, exponent = value.ball(BITS + 50).mid().man_exp()
    return mpf(int(mantissa)) * mpf(2) ** int(exponent)


# -- scenes where much happens at once


def crowd(seed: int) -> Scene:
    """Circles on a grid with speeds of few values: touching, in a row, on a wall, or symmetric; then moved."""
    draw = Random(seed)
    kind = draw.choice(["grid", "grid", "grid", "touch", "line", "slide", "sym"])
    n, side = draw.choice([2, 3, 3, 4, 4, 5, 6, 8]), draw.choice([3, 4, 5, 6])
    cells = [(x, y) for x in range(side) for y in range(side)] if kind != "line" else [(x, 0) for x in range(3 * n)]
    motion = draw.choice(["id", "shift", "rot345", "rot45", "scale", "rot30"])
    policy = draw.choice(["simultaneous"] * 4 + ["sequential"])
    r = draw.choice([F(1, 2), F(1, 2), F(1, 4), F(1, 3), F(2, 5)]) if kind != "touch" else F(1, 2)
    draw.shuffle(cells)
    rows = []
    for x, y in cells[:n]:
        vx, vy = draw.choice([-1, 0, 0, 1]), draw.choice([-1, 0, 0, 1]) if kind != "line" else 0
        if kind == "touch" and draw.random() < 0.7:
            vx = vy = 0
        m = draw.choice([1, 1, 1, 1, 2, 3, "oo" if draw.random() < 0.3 else 1])
        if m == "oo":
            vx = vy = 0
        rows.append((F(x), F(y), r, vx * draw.choice([F(1), F(1), F(1, 2), F(2)]), F(vy), m))
    if kind == "touch" and draw.random() < 0.7:
        y, vy = draw.choice([0, 1, F(1, 2), F(1, 2)]), F(draw.choice([0, 0, 1]), 3)
        rows.append((F(-draw.choice([3, 5])), F(y), r, F(draw.choice([1, 2])), vy, 1))
    walls = []
    if kind == "slide":
        walls.append((F(0), -r, F(1), -r))
        rows = [
            (x, y, r, vx if y or m == "oo" else F(draw.choice([-1, 0, 1, 2])), vy if y else F(0), m)
            for x, y, r, vx, vy, m in rows
        ]
    if kind == "sym":
        above = [(x, y + 1, r, vx, vy, m) for x, y, r, vx, vy, m in rows[:4]]
        rows = [row for x, y, r, vx, vy, m in above for row in ((x, y, r, vx, vy, m), (x, -y, r, vx, -vy, m))]
        if draw.random() < 0.7:
            x, vx = -draw.choice([3, 4, 6]), draw.choice([1, 2])
            rows.append((F(x), F(0), r * draw.choice([F(1), F(3, 2)]), F(vx), F(0), draw.choice([1, 2])))
    if draw.random() < 0.6 and kind != "line":
        left, right = draw.choice([(-6, side + 3), (-5, side + 2), (-5, side + F(5, 2))])
        walls += [(left, 0, left, 1), (right, 0, right, 1)]
        if kind != "slide":
            walls += [(0, left - 1, 1, left - 1), (0, right + 4, 1, right + 4)]
        elif draw.random() < 0.5:
            walls.append((0, right, 1, right))
    if draw.random() < 0.15:
        walls.append((-9, -9, -8, -10))
    changes = {}
    if draw.random() < 0.3:
        after, at = draw.choice([1, 2, 3]), F(draw.randrange(1, 7), draw.choice([1, 2]))
        changes = draw.choice([{"reverse_after": after}, {"reverse_at": at}])
    return moved(rows, walls, motion, tie_policy=policy, name=f"{kind} {motion} {policy} {seed}", **changes)


TURNS = {
    "rot345": ("3/5", "4/5"),
    "rot45": ("sqrt(2)/2", "sqrt(2)/2"),
    "rot30": ("sqrt(3)/2", "1/2"),
    "scale": ("sqrt(2)", "0"),
}


def moved(rows, walls, motion: str, **changes) -> Scene:
    """The scene turned by an angle, stretched by sqrt(2), or shifted by roots: the same history in harder numbers."""
    c, s = map(Quantity.of, TURNS.get(motion, ("1", "0")))
    shift = map(Quantity.of, ("sqrt(3)/7", "-sqrt(5)/3") if motion == "shift" else ("0", "0"))
    dx, dy = shift

    def turn(x, y):
        return c * x - s * y, s * x + c * y

    def place(x, y):
        x, y = turn(x, y)
        return x + dx, y + dy

    stretch = c if motion == "scale" else Quantity.of(1)
    circles = [Circle(*place(x, y), stretch * r, *turn(vx, vy), m) for x, y, r, vx, vy, m in rows]
    return Scene(circles, [Wall(*place(a, b), *place(c, d)) for a, b, c, d in walls], **changes)


def check_crowds(seeds: range, events: int) -> set[str]:
    stops = set()
    for seed in seeds:
        try:
            scene = crowd(seed)
        except SceneError:  # a circle lies across a wall
            continue
        try:
            stops.add(check(scene, events=events))
        except TooLong:  # brute force has nothing to say
            continue
        except AssertionError as error:
            raise AssertionError(f"{scene.name}: {error}") from error
    return stops


@pytest.fixture
def without_fields(monkeypatch):
    """Numbers that are not kept in exact fields."""
    live = pytest.importorskip("truebreak.exact.replay.refinable")
    if not hasattr(live, "FIELD_BITS"):
        pytest.skip("this engine has no limit on the size of its exact fields")
    monkeypatch.setattr(live, "FIELD_BITS", 0)


@pytest.mark.parametrize("start", range(0, 400, 50))
def test_what_happens_at_once_is_what_brute_force_finds(start):
    assert check_crowds(range(start, start + 50), events=12) <= {"QUIET", "EVENTS", "HORIZON"}


@pytest.mark.parametrize("start", range(1000, 1100, 50))
@pytest.mark.usefixtures("without_fields")
def test_it_is_the_same_without_exact_fields(start):
    assert check_crowds(range(start, start + 50), events=12) <= {"QUIET", "EVENTS", "HORIZON"}


@pytest.mark.slow
def test_a_thousand_crowds():
    check_crowds(range(10_000, 11_000), events=20)


@pytest.mark.slow
@pytest.mark.usefixtures("without_fields")
def test_a_thousand_crowds_without_exact_fields():
    check_crowds(range(10_000, 11_000), events=20)


# -- one law each, with the smallest scene that once broke it


def test_impulses_in_sequence_break_the_symmetry_that_the_scene_had():
    scene = Scene([Circle(-5, 0, vx=1), Circle(0, 1), Circle(0, -1)], tie_policy="sequential", name="two at once")
    assert check(scene, events=3) == "QUIET"
    velocities = ExactEngine().run(scene).final.circles
    assert sum((c.vy.ball(200) for c in velocities), arb(0)).contains(0)


def test_a_graze_at_the_very_reversal_leaves_nothing_behind():
    a = Circle("-6/5", "17/5", vx="12/5", vy="-9/5")
    b, c = Circle(0, 0, m="oo"), Circle("-6/5", "27/5", vy=7, m=3)
    scene = Scene([a, b, c], reverse_at=1, name="graze at the reversal")
    check(scene, events=3)


def test_an_instant_lasts_until_no_contact_approaches():
    a, b = Circle(0, -1, "1/2", vy=1), Circle(1, 0, "1/2", m=3)
    scene = Scene([a, b, Circle(-2, 0, "1/2", vx=1)], name="grazing one while hit by another")
    assert check(scene, events=3) == "QUIET"


@pytest.mark.parametrize("power", [-300, -160, -99, -90, -60, -9, 0, 9, 60, 80, 99, 160, 300])
def test_a_near_graze_is_told_from_a_graze_at_any_size(power):
    size = F(10) ** power
    for angle, distance, offset in [(2, 7, 10**17), (3, 30, 10**20), (5, 11, 10**40), (9, 4, 10**300)]:
        c, s = F(angle**2 - 1, angle**2 + 1), F(2 * angle, angle**2 + 1)
        for sign in (-1, 0, 1):
            aside = 2 + F(sign, offset)
            x, y = c * distance - s * aside, s * distance + c * aside
            moving = Circle(0, 0, size, c * size, s * size)
            run = ExactEngine().run(Scene([moving, Circle(x * size, y * size, size)]))
            assert len(run.events) == (1 if sign < 0 else 0)


@pytest.mark.parametrize("late", [F(0), F(1, 10**40), F(-1, 10**40), F(1, 10**300), F(-1, 10**300)])
def test_a_near_tie_is_told_from_a_tie(late):
    # both meet their partner after 4 - sqrt(3), the second one later by `late`
    one = [Circle(0, 0, vx=1), Circle(4, 1)]
    two = [Circle(-late, 10, vx=1), Circle(4, 11)]
    contacts = [[tuple(c) for c in event.contacts] for event in ExactEngine().run(Scene(one + two)).events]
    first, second = [("c1", "c2")], [("c3", "c4")]
    assert contacts == ([first + second] if late == 0 else [first, second] if late > 0 else [second, first])


@pytest.mark.parametrize("until", ["4 - sqrt(3)", "sqrt(2)", "4 - sqrt(3) - 1/10000000000000000000000000000000000"])
def test_an_event_at_the_time_limit_happens_and_one_beyond_does_not(until):
    run = ExactEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 1)]), until=until)
    assert len(run.events) == (1 if until == "4 - sqrt(3)" else 0)
    assert run.stop.reason.name == "HORIZON"
    assert run.final["c1"].x.digits(20) == (Quantity.of(until)).ball(100).str(20, radius=False)


@pytest.mark.parametrize("exponent", [-330, -12, 330])
def test_times_beyond_the_doubles_are_times(exponent):
    speed = Quantity.of(F(10) ** exponent)
    scene = Scene([Circle(0, 0, vx=speed), Circle(4, 1), Circle(40, 1)])
    run = ExactEngine().run(scene)
    with mpmath.workprec(BITS):
        first = mpmath.mpf(10) ** -exponent * (4 - mpmath.sqrt(3))
        assert abs(number(run.events[0].time) / first - 1) < SAME_TIME


@pytest.mark.parametrize(("maker", "events"), [
    (lambda: gas(101, 3, 5, False), 150),
    (lambda: gas(102, 12, 9, True), 120),
    (lambda: gas(103, 25, 12, False), 100),
    (lambda: polygon(104, [(1, 0), (9, 2), (10, 7), (4, 10), (0, 5)], 5), 120),
])  # fmt: skip
def test_gases_that_the_engine_has_not_seen_are_as_the_referee_finds(maker, events):
    scene = maker()
    history = referee(scene, events, bits=1500)
    assert len(history.events) == events
    compare_to_referee(ExactEngine().run(scene, events=events), history)


@pytest.mark.slow
def test_three_thousand_events_are_as_the_referee_finds():
    scene = gas(3, 10, 8, False)
    history = referee(scene, 3000, bits=16_000)
    assert len(history.events) == 3000
    compare_to_referee(ExactEngine().run(scene, events=3000), history)
