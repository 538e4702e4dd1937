"""A scene and its image under a quarter turn run to the same place, also where it is counted work that ends them."""

from __future__ import annotations

import random
import re
from fractions import Fraction as Q
from typing import Any

import pytest

from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Quantity, Scene, TiePolicy, Trajectory, Wall

DIRECTIONS = [(Q(1), Q(0)), (Q(3, 5), Q(4, 5)), (Q(5, 13), Q(12, 13)), (Q(-8, 17), Q(15, 17)), (Q(0), Q(1))]


def drawn(seed: int) -> tuple[list[dict[str, Any]], list[tuple[Any, ...]], dict[str, Any], dict[str, Any]]:
    """Circles, walls, settings and limits: a row that touches or nearly does, a striker, walls, unlike masses."""
    draw = random.Random(seed)
    ux, uy = draw.choice(DIRECTIONS)
    circles: list[dict[str, Any]] = []
    place = Q(0)
    for _ in range(draw.randint(1, 3)):
        mass = draw.choice([1, 1, 10 ** draw.randint(1, 5), Q(draw.randint(1, 9), draw.randint(1, 9)), "2 + sqrt(2)"])
        circles.append({"x": place * ux, "y": place * uy, "m": mass})
        place += 2 + draw.choice([Q(0), Q(0), Q(1, 10**6), Q(draw.randint(1, 9), 7)])
    speed, aside = Q(draw.randint(1, 9), draw.randint(1, 5)), draw.choice([Q(0), Q(0), Q(1, 3), Q(1, 10**9)])
    start = -draw.randint(4, 9)
    circles.append(
        {
            "x": start * ux - aside * uy,
            "y": start * uy + aside * ux,
            "vx": speed * ux,
            "vy": speed * uy,
            "m": draw.choice([1, 1000, 10**6, Q(22, 7)]),
        }
    )
    walls: list[tuple[Any, ...]] = [(place * ux, place * uy, place * ux - uy, place * uy + ux)]
    if draw.random() < 0.5:
        walls.append((-20 * ux, -20 * uy, -20 * ux - uy, -20 * uy + ux))
    if seed % 10 == 9:  # two contacts at one time, the same number in two forms: little work does not prove it
        deep = Quantity.of(f"sqrt({draw.choice([3, 5])} + sqrt({draw.choice([6, 7])} + sqrt({draw.choice([2, 11])})))")
        time, height = 9 - (2 + deep).sqrt(), (7 - deep).sqrt()
        circles = [{"x": 0, "y": 60, "m": "oo", "r": 2}, {"x": -9, "y": 60 + height, "vx": 1}]
        circles += [{"x": 8 - time, "y": 90, "vx": 1}, {"x": 50, "y": 30, "vx": -1}]
        walls = [(9, 0, 9, 1)]
    policy = draw.choice([TiePolicy("simultaneous"), TiePolicy("sequential")])
    work = draw.choice([2_000, 20_000, 100_000])
    return circles, walls, {"tie_policy": policy}, {"work": work, "events": draw.randint(2, 12)}


def run_of(seed: int, turned: bool) -> Trajectory:
    circles, walls, settings, limits = drawn(seed)

    def turn(x: Any, y: Any) -> tuple[Any, Any]:
        return (-y, x) if turned else (x, y)

    made = []
    for circle in circles:
        x, y = turn(circle["x"], circle["y"])
        vx, vy = turn(circle.get("vx", 0), circle.get("vy", 0))
        made.append(Circle(x, y, circle.get("r", 1), vx, vy, circle.get("m", 1)))
    lines = [Wall(*turn(x0, y0), *turn(x1, y1)) for x0, y0, x1, y1 in walls]
    engine = ExactEngine(work=limits["work"], max_bits=1 << 14)
    return engine.run(Scene(made, lines, **settings), events=limits["events"])


def _place(run: Trajectory) -> tuple[str, str]:
    """Where a run stopped, and what it asked there. How much of the work an attempt in nested roots had taken may
    differ by a thousandth, as their numbers come in another order."""
    return run.stop.reason.name, re.sub(r"\d+ units of work of", "units of work of", run.stop.message)


def check(seed: int) -> str:
    one, other = run_of(seed, False), run_of(seed, True)
    assert _place(one) == _place(other), seed
    assert [(e.contacts, e.impulses) for e in one.events] == [(e.contacts, e.impulses) for e in other.events], seed
    assert [e.time.digits(20) for e in one.events] == [e.time.digits(20) for e in other.events], seed
    assert one.plan["bits"] == other.plan["bits"], seed
    return one.stop.reason.name


def test_a_quarter_turn_changes_nothing() -> None:
    ended = {check(seed) for seed in range(40)}
    assert {"EVENTS", "BUDGET", "QUIET"} <= ended


@pytest.mark.slow
def test_a_quarter_turn_changes_nothing_in_500_scenes() -> None:
    ended = {check(seed) for seed in range(500)}
    assert {"EVENTS", "BUDGET", "UNDECIDED", "QUIET"} <= ended


@pytest.mark.parametrize("k", [6, 8])
def test_a_cradle_against_a_wall_costs_the_same_along_both_axes(k: int) -> None:
    level = Scene([Circle(-9, 0, vx=1, m=10**k), Circle(-1, 0)], [Wall(0, 0, 0, 1)])
    upright = Scene([Circle(0, -9, vy=1, m=10**k), Circle(0, -1)], [Wall(0, 0, 1, 0)])
    one, other = (ExactEngine().run(scene, events=2) for scene in (level, upright))
    assert one.stop == other.stop
    assert [len(e.impulses) for e in one.events] == [len(e.impulses) for e in other.events]
    assert one.plan["bits"] == other.plan["bits"]
    if k == 8:  # 31,415 impulses
        assert one.stop.reason.name == "BUDGET"
        assert "10000 passes of impulses at one instant" in one.stop.message
