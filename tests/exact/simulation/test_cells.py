"""Histories with cells and without are the same."""

from __future__ import annotations

from math import hypot, inf, sqrt
from random import Random

import pytest

from truebreak.compare import engine
from truebreak.exact.simulation import cells as grid
from truebreak.exact.simulation.cells import cells_for
from truebreak.scenarios import Circle, Scene, Trajectory, Wall, catalogue
from truebreak.scenarios.trajectory import StopReason

LATTICE = Scene(
    [Circle(3 * i, 3 * j, vx=(i * 7 + j) % 5 - 2, vy=(i + 3 * j) % 5 - 2) for i in range(10) for j in range(7)],
    [Wall(-4, 0, -4, 1), Wall(32, 0, 32, 1), Wall(0, -4, 1, -4), Wall(0, 23, 1, 23)],
    events=300,
)
"""Many instants of several contacts, far from one another."""

SLANTED = LATTICE.with_changes(
    walls=[
        Wall(0, -4, 3, -5), Wall(27, -3, 30, -2), Wall(0, 25, 7, 24), Wall(-6, 0, -5, 5), Wall(32, 0, 33, 9),
    ]
)  # fmt: skip
"""The same, and fewer of them once they have met walls at all angles."""

SCENES = {
    "gas": lambda: (catalogue.build("gas:n=70,seed=3"), {"events": 300}),
    "mixed": lambda: (catalogue.build("gas:n=70,seed=4,mixed=yes"), {"events": 300}),
    "crowd": lambda: (catalogue.build("gas:n=200,seed=1"), {"events": 400}),
    "lattice": lambda: (LATTICE, {"events": 200}),
    "slanted": lambda: (SLANTED, {"events": 300}),
    "there and back": lambda: (
        catalogue.build("gas:n=70,seed=2").with_changes(until=None, events=None, reverse_after=60),
        {},
    ),
    "turned at a time": lambda: (
        catalogue.build("gas:n=70,seed=5").with_changes(until=None, events=None, reverse_at=1),
        {},
    ),
    "one large among small": lambda: (
        Scene(
            [
                Circle(0, 0, 40, 1, 0, m=9),
                *(Circle(50 + 3 * i, 3 * j, vx=-1 - i % 3) for i in range(10) for j in range(-3, 4)),
            ]
        ),
        {"events": 60},
    ),
}


def told(run: Trajectory) -> list[object]:
    """All that a history says, its numbers as doubles; the contacts of one instant in no order."""
    events = [(float(e.time), sorted(e.contacts), sorted(e.impulses), {t.proof for t in e.ties}) for e in run.events]
    final = [(float(c.x), float(c.y), float(c.vx), float(c.vy)) for c in run.final.circles]
    return [events, final, float(run.final_time), run.stop.reason, [(p.circle, float(p.time)) for p in run.pocketings]]


@pytest.mark.parametrize("name", ["exact", "double"])
@pytest.mark.parametrize("scene", SCENES)
def test_cells_change_nothing(scene: str, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    built, limits = SCENES[scene]()
    with_cells = engine(name).run(built, **limits)
    assert with_cells.plan["cells crossed"] > 0
    monkeypatch.setattr(grid, "FEWEST", 10**9)
    without = engine(name).run(built, **limits)
    assert "cells crossed" not in without.plan
    assert told(with_cells) == told(without)
    assert with_cells.plan["pairs predicted"] < without.plan["pairs predicted"] / 2
    assert with_cells.plan.get("walls predicted", 0) <= without.plan["walls predicted"] * 2 / 3


def comes_within(dx: float, dy: float, vx: float, vy: float, reach: float) -> float:
    """How long until two are within a reach of each other, or infinite."""
    gap, approach, square = dx * dx + dy * dy - reach * reach, dx * vx + dy * vy, vx * vx + vy * vy
    if gap <= 0.0:
        return 0.0
    disc = approach * approach - square * gap
    return gap / (sqrt(disc) - approach) if approach < 0.0 <= disc else inf


@pytest.mark.parametrize("seed", range(6))
def test_whoever_may_meet_is_handed_out_in_time_and_once(seed: int) -> None:
    """Circles of radius 1 fly through each other and through walls, and turn at random, now and then before crossings
    that have been carried out already: what cells promise, by brute force."""
    draw = Random(seed)
    n, size, now = 90, 60.0, 0.0
    walls = [
        Wall(0, 0, 1, 0),
        Wall(0, 0, 1, 3),
        Wall(55, 0, 60, -9),
        Wall(0, 70, 9, 69),
        Wall(30, 30, 31, 29),
        Wall(57, 0, 57, 1),
    ]
    turn = lambda: (draw.uniform(-2, 2), draw.uniform(-2, 2)) if draw.random() > 0.1 else (0.0, draw.choice([0.0, 1.0]))  # noqa: E731
    flights = [(draw.uniform(0, size), draw.uniform(0, size), *turn(), 0.0) for _ in range(n)]
    begun = [0] * n
    cells = cells_for(flights, [1.0] * n, walls)
    assert cells is not None
    handed: dict[tuple[int, ...], float] = {}

    def hand(key: tuple[int, ...]) -> None:
        assert key not in handed
        handed[key] = now

    def met(i: int, others: list[int], near: tuple[int, ...]) -> None:
        assert others == sorted(others)
        for k in near:
            hand((i, begun[i], ~k))
        for k in others:
            a, b = sorted((i, k))
            hand((a, b, begun[a], begun[b]))

    def check(until: float) -> None:
        """All that come to touch before a time, on their flights as they are, have been handed out before."""
        for a in range(n):
            ax, ay, avx, avy, at = flights[a]
            for k, wall in enumerate(walls):
                nx, ny = (float(c) for c in wall.normal)
                height = (nx * (ax - float(wall.x0)) + ny * (ay - float(wall.y0))) / hypot(nx, ny)
                speed = (nx * avx + ny * avy) / hypot(nx, ny)
                when = at + comes_within(height, 0.0, speed, 0.0, 1.0)
                if when < until - 1e-9:
                    assert handed[a, begun[a], ~k] <= max(when, at) + 1e-9
            for b in range(a):
                bx, by, bvx, bvy, bt = flights[b]
                t = max(at, bt)
                apart = bx + bvx * (t - bt) - ax - avx * (t - at), by + bvy * (t - bt) - ay - avy * (t - at)
                when = t + comes_within(*apart, bvx - avx, bvy - avy, 2.0)
                if when < until - 1e-9:
                    assert handed[b, a, begun[b], begun[a]] <= when + 1e-9

    for i, flight in enumerate(flights):
        cells.enter(i, flight)
    for i in range(n):
        met(i, [k for k in cells.around(i) if k >= i], cells.walls(i))
    for _ in range(150):
        then = now + draw.expovariate(4.0)
        turns_at = draw.uniform(now, then) if draw.random() < 0.3 else then
        while cells.next_crossing <= then:
            now = max(now, min(cells.next_crossing, turns_at))
            for crossed in cells.cross(turns_at):
                met(*crossed)
        check(then)
        now, i = turns_at, draw.randrange(n)
        x, y, vx, vy, t = flights[i]
        begun[i] += 1
        flights[i] = (x + vx * (now - t), y + vy * (now - t), *turn(), now)
        may_be_near = cells.enter(i, flights[i])
        near = cells.walls(i)
        assert may_be_near or not near
        met(i, cells.around(i), near)
    assert cells.loose


def test_what_no_double_holds_is_held_against_all() -> None:
    """Places, radii and walls beyond the range of doubles, and below it."""
    far = "10**400"
    run = engine("exact").run(
        Scene([Circle(0, 0, far, 1, 0), Circle("4*10**400", 0, far)], [Wall(far, far, 0, "2*10**400")])
    )
    assert run.certified
    rows = [Circle(f"4*{k}*{far}", 0, far, -k) for k in range(70)]
    assert engine("exact").run(Scene(rows), events=2).certified
    near = "10**-320"
    beside = Scene(
        [Circle(f"{k}*{near}", 0, f"{near}/4", 1) for k in (1, 3)], [Wall(f"2*{near}", 0, f"2*{near}", "10**300")]
    )
    hit = engine("exact").run(beside).events[0]
    assert hit.contacts[0] == ("c1", "w1")
    assert float(hit.time) == 7.5e-321


@pytest.mark.parametrize("digits", [20, 320, 330, 400])
def test_what_doubles_take_for_zero_is_not_at_rest(digits: int) -> None:
    """A speed, and the slope of a wall, below all doubles: what they lead to comes late, but it comes."""
    slow = [Circle(4 * (k % 10), 4 * (k // 10)) for k in range(80)]
    run = engine("exact").run(Scene([*slow, Circle(-40, 20, vx=f"10**-{digits}")]), events=1)
    assert [run.scene.ids.index(one) for one in run.events[0].contacts[0]] == [50, 80]
    aside = [Circle(9 + 4 * (k % 10), 4 * (k // 10), vy=int(k == 75)) for k in range(80)]
    run = engine("exact").run(Scene(aside, [Wall(0, 0, f"10**-{digits}", 1)]), events=1)
    assert run.events[0].contacts[0] == ("c76", "w1")


def test_a_time_beyond_doubles_is_no_crossing() -> None:
    aside = [Circle(9 + 4 * (k % 10), 4 * (k // 10), vy=int(k == 75)) for k in range(80)]
    assert len(engine("double").run(Scene(aside, [Wall(0, 0, "10**-320", 1)]), events=1).events) == 1


def test_who_is_too_slow_for_slices_of_time_is_held_against_all() -> None:
    """They would be longer than any double is. In doubles the square of such a speed is 0, so nobody comes."""
    places = [(f"{4 * (k % 8)}*10**95", f"{4 * (k // 8)}*10**95") for k in range(64)]
    scene = Scene([Circle(x, y, "10**95", vx="10**-240" if k == 0 else 0) for k, (x, y) in enumerate(places)])
    run = engine("exact").run(scene, events=1)
    assert [scene.ids.index(one) for one in run.events[0].contacts[0]] == [0, 1]
    assert engine("double").run(scene, events=1).events == ()


def test_cells_may_end_at_zero() -> None:
    """To look for the last double before it, one step after another, took for ever."""
    rows = [Circle(-20 + q, 2 * k, "3/4", 1, 0) for k in range(16) for q in (0, 4, 8, 19)]
    assert engine("exact").run(Scene(rows), events=3).stop.reason is StopReason.QUIET


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("far", [1e16, 1e30, 1e200])
def test_cells_far_from_the_origin_are_as_few_as_near_it(far: float, turned: bool) -> None:
    """A sum of spans in another order once cancelled: 255 million columns, each as wide as a circle."""
    places = [(3.0 * k, far) for k in range(70)] + [(1.4e9, far)]
    flights = [(y, x, 0.0, 1.0, 0.0) if turned else (x, y, 1.0, 0.0, 0.0) for x, y in places]
    found = grid.grid_for(flights, [1.0] * len(flights))
    assert found is not None
    assert 9 < found.columns * found.rows < 2 * grid.MOST_CELLS
