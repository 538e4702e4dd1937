"""Causes of entries into pockets: known by construction, and none of those of drawn scenes refuted by other runs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from decimal import Decimal
from fractions import Fraction
from typing import Any

import pytest
from drawn_falls import pocketed
from faults import Steps
from other_runs import falls_by, nearest
from refuting import refute, said_of

from truebreak.compare import compare
from truebreak.compare.candidate import Candidate
from truebreak.compare.causes.diagnosis import CauseName
from truebreak.compare.engines import engine as engine_named
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Pocket, Quantity, Scene, Wall

F = Fraction
FAR = Wall(40, 0, 40, 1, id="far")


def judged(scene: Scene, engine: Any, until: int = 400) -> Candidate:
    """What is said of an engine, which no other run refutes, and whose account closes."""
    chosen = engine_named(engine) if isinstance(engine, str) else engine
    found = compare(scene, [chosen], until=until).candidates[0]
    assert found.verdict == "diverged"
    assert found.diagnosis is not None
    assert found.diagnosis.closed
    assert sum(row.share or 0.0 for row in found.diagnosis.shares) == pytest.approx(1)
    assert not refute(scene, chosen, found)
    return found


def sizes(found: Candidate) -> Mapping[str, float]:
    assert found.diagnosis is not None
    return {row.cause.name: row.displacement or 0.0 for row in found.diagnosis.shares}


def passing(x: Any, y: Any, vx: Any, vy: Any, hole: Pocket) -> float:
    """How far a centre passes a rim: its distance from the pocket's centre, less the radius; below 0 within."""
    dx, dy = float(hole.x) - float(x), float(hole.y) - float(y)
    return abs(dx * float(vy) - dy * float(vx)) / (float(vx) ** 2 + float(vy) ** 2) ** 0.5 - float(hole.r)


# -- rounding of the input alone


@pytest.mark.parametrize("bits", [8, 12, 24, 53])
@pytest.mark.parametrize("side", [-1, 1])
def test_a_rim_is_passed_or_not_by_the_rounded_scene_alone(bits: int, side: int) -> None:
    """A ball that flies along a line meets no rounding but that of the line and the rim."""
    unit = F(1, 2**bits)
    radius = 1 + 48 * unit  # between multiples of what the line, 100 high, is rounded to
    height = next(
        h for h in (100 + F(k, 61) for k in range(60))
        if (nearest(h + radius + 8 * side * unit, bits) - nearest(h, bits) - radius) * side < 0
    )  # fmt: skip
    rim = height + radius + 8 * side * unit
    ball, hole = Circle(0, height, "1/4", vx=1, id="ball"), Pocket(10, rim, radius, id="hole")
    found = judged(
        Scene([ball], [FAR], pockets=[hole], capture=True), f"rounded:bits={bits}" if bits < 53 else "double"
    )
    exact, own = 8 * side * unit, nearest(rim, bits) - nearest(height, bits) - radius
    assert exact * own < 0
    assert found.diagnosis is not None
    assert found.diagnosis.name is CauseName.INPUT
    assert sizes(found)["INPUT"] == pytest.approx(float(own - exact), rel=1e-6)
    assert found.margin is not None
    assert found.margin.distance is not None
    assert found.margin.distance[0] == pytest.approx(float(exact))


@pytest.mark.parametrize(("wall", "radius"), [("401/20", "9/40"), ("401/20", "33/160"), ("1603/80", "77/320")])
def test_whether_a_wall_or_the_rim_comes_first_is_of_the_rounded_scene_alone(wall: str, radius: str) -> None:
    """A ball of radius 1/4 is at a wall a little before its centre is at the rim, or a little after."""
    at, reach = F(wall), F(radius)
    ball, hole = Circle(0, 0, "1/4", vx=1, id="ball"), Pocket(20, 0, reach, id="hole")
    exact = (at - F(1, 4)) - (20 - reach)
    own = (nearest(at, 8) - F(1, 4)) - (20 - nearest(reach, 8))
    assert exact * own < 0
    scene = Scene([ball], [Wall(at, 0, at, 1, id="wall"), Wall(-9, 0, -9, 1, id="left")],
                  pockets=[hole], capture=True)  # fmt: skip
    found = judged(scene, "rounded:bits=8")
    assert found.diagnosis is not None
    assert found.diagnosis.name is CauseName.INPUT
    assert abs(sizes(found)["INPUT"]) == pytest.approx(abs(float(own - exact)))


@pytest.mark.parametrize(("apart", "radius"), [("5101/10", "21/100"), ("5103/10", "9/100")])
def test_whether_another_ball_or_the_rim_comes_first_is_of_the_rounded_scene_alone(apart: str, radius: str) -> None:
    """Two balls fly at each other, each with speed 1; the one comes to the rim about when they meet."""
    far, reach = F(apart), F(radius)
    times = [(x - 490 - F(1, 2)) / 2 - (10 - r) for x, r in ((far, reach), (nearest(far, 10), nearest(reach, 10)))]
    assert times[0] * times[1] < 0
    balls = [Circle(490, 0, "1/4", vx=1, id="ball"), Circle(far, 0, "1/4", vx=-1, id="other")]
    walls = [Wall(540, 0, 540, 1, id="far"), Wall(440, 0, 440, 1, id="left")]
    found = judged(Scene(balls, walls, pockets=[Pocket(500, 0, reach, id="hole")], capture=True), "rounded:bits=10")
    assert found.diagnosis is not None
    assert found.diagnosis.name is CauseName.INPUT
    assert abs(sizes(found)["INPUT"]) == pytest.approx(abs(float(times[1] - times[0])))


def test_an_entry_that_follows_from_a_contact_decides_nothing() -> None:
    """One that is to pass `c` hits it on the rounded scene; so the next finds it gone, and flies on into the pocket."""
    passes, comes = Circle("10074/100", -5, "9/25", vy=1, id="passes"), Circle(110, 0, "9/25", vx=-1, id="comes")
    walls = [Wall(60, 0, 60, 1), Wall(160, 0, 160, 1), Wall(0, -60, 1, -60), Wall(0, 60, 1, 60)]
    scene = Scene([Circle(100, 0, "9/25", id="c"), passes, comes], walls,
                  pockets=[Pocket(95, 0, "1/4", id="hole")], capture=True)  # fmt: skip
    found = judged(scene, "rounded:bits=8", 120)
    assert [(e.circle, e.pocket) for e in found.trajectory.pocketings] == [("comes", "hole")]
    assert found.diagnosis is not None
    assert found.diagnosis.name is CauseName.INPUT
    assert found.margin is not None
    assert found.margin.distance is not None
    assert found.margin.distance[0] == pytest.approx(0.74 - 0.72)
    own = 0.5 - 2 * float(nearest(F(9, 25), 8))
    assert found.diagnosis.displacement == pytest.approx(own - 0.02)


@pytest.mark.parametrize("high", ["2000 + 3/8", "2001 - 3/8"])
def test_under_gravity_a_parabola_passes_a_rim_or_not_by_the_rounded_scene_alone(high: str) -> None:
    """So high that the place where the ball begins is rounded by more than all else: the rim lies between the two."""
    height = Quantity.of(high).fraction
    assert height is not None
    zero, place = Decimal(0), (Decimal(3), Decimal(1994))
    exact, own = (
        falls_by((zero, Decimal(y.numerator) / y.denominator, Decimal(1), zero), place, (zero, Decimal(-1)), zero)[0]
        for y in (height, nearest(height, 11))
    )
    radius = nearest(F(str((exact + own) / 2)), 11)
    assert (exact - Decimal(float(radius))) * (own - Decimal(float(radius))) < 0
    floor, hole = Wall(0, 1990, 1, 1990, id="floor"), Pocket(3, 1994, radius, id="hole")
    ball = Circle(0, height, "1/4", vx=1, id="ball")
    found = judged(Scene([ball], [floor], pockets=[hole], capture=True, gravity=(0, -1)), "rounded:bits=11", 8)
    assert found.diagnosis is not None
    assert found.diagnosis.name is CauseName.INPUT
    assert sizes(found)["INPUT"] == pytest.approx(float(own - exact), rel=1e-6)


# -- the engine's own arithmetic


def aslant(radius: Any = "1/4") -> tuple[Scene, Wall]:
    """A ball that meets a wall aslant: all numbers are short, and what comes of the bounce has a 25 below the line."""
    wall = Wall(8, 0, 4, 3, id="wall")
    ball = Circle(-2, 1, radius, vx=1, id="ball")
    return Scene([ball], [wall, FAR, Wall(0, -80, 1, -80, id="low"), Wall(0, 80, 1, 80, id="high"),
                          Wall(-40, 0, -40, 1, id="left")]), wall  # fmt: skip


@pytest.mark.parametrize("bits", [12, 14, 20])
@pytest.mark.parametrize("side", [1, -1])
def test_after_a_bounce_aslant_the_rim_is_passed_or_not_by_arithmetic_alone(bits: int, side: int) -> None:
    """The pocket's rim, of exact numbers, lies between the exact flight and the one that the engine reports."""
    scene, _ = aslant()
    engine = engine_named(f"rounded:bits={bits}")
    exact, own = (run.run(scene, events=1).after(0).circles[0] for run in (ExactEngine(), engine))
    rows = [tuple(float(getattr(state, key)) for key in ("x", "y", "vx", "vy")) for state in (exact, own)]
    x, y, vx, vy = rows[0]
    along, away = 24.0, side * 1.5
    centre = [nearest(F(value), bits) for value in (x + along * vx - away * vy, y + along * vy + away * vx)]
    far = [passing(*row, Pocket(*centre, 1)) + 1 for row in rows]
    radius = nearest(F((far[0] + far[1]) / 2), bits)
    assert (far[0] - float(radius)) * (far[1] - float(radius)) < 0
    hole = Pocket(*centre, radius, id="hole")
    found = judged(scene.with_changes(pockets=[hole], capture=True), engine)
    assert found.diagnosis is not None
    assert found.diagnosis.displacement == pytest.approx(far[1] - far[0], rel=1e-6)
    assert sizes(found).get("INPUT", 0.0) == 0.0
    assert set(said_of(found).causes) <= {"arithmetic in flights", "arithmetic in impacts", "arithmetic"} | {
        "arithmetic rounding"
    }


def test_the_input_and_arithmetic_each_have_their_share() -> None:
    """The radius of the ball is no number of 12 bits: by that the flight from the wall lies elsewhere."""
    scene, _ = aslant("1/3")
    engine = engine_named("rounded:bits=12")
    states = [run.run(scene, events=1).after(0).circles[0] for run in (ExactEngine(), engine)]
    given = ExactEngine().run(aslant(nearest(F(1, 3), 12))[0], events=1).after(0).circles[0]
    rows = [tuple(float(getattr(s, key)) for key in ("x", "y", "vx", "vy")) for s in (*states, given)]
    x, y, vx, vy = rows[0]
    centre = [nearest(F(value), 12) for value in (x + 12 * vx - 1.5 * vy, y + 12 * vy + 1.5 * vx)]
    far = [passing(*row, Pocket(*centre, 1)) + 1 for row in rows]
    radius = nearest(F((far[0] + far[1]) / 2), 12)
    assert (far[0] - float(radius)) * (far[1] - float(radius)) < 0
    found = judged(scene.with_changes(pockets=[Pocket(*centre, radius, id="hole")], capture=True), engine)
    assert found.diagnosis is not None
    assert sizes(found)["INPUT"] == pytest.approx(far[2] - far[0], rel=1e-6)
    assert found.diagnosis.displacement == pytest.approx(far[1] - far[0], rel=1e-6)


# -- an engine of steps


@pytest.mark.parametrize("step", [1 / 16, 1 / 64])
def test_an_impulse_at_the_end_of_a_step_is_late_and_the_rim_is_missed(step: float) -> None:
    """Down to a floor at 45 degrees: late by d, the ball leaves from d deeper, sqrt(2) d aside of its line."""
    height = F(7, 3)
    ball = Circle(0, height + F(1, 4), "1/4", vx=1, vy=-1, id="ball")  # at the floor after 7/3
    clock = Circle(-20, 15, "1/4", vy=1, id="clock")  # which has contacts later
    ends = -(-height // F(step)) * F(step)
    late = float(ends - height)
    assert late > step / 8
    # it flies up at 45 degrees; a lateness of d puts it lower by 2 d, so sqrt(2) d across its line
    across = late * 2**0.5
    x, y = float(height), 0.25
    centre = x + 6 - 1.0, y + 6 + 1.0
    hole = Pocket(F(centre[0]), F(centre[1]), F(2**0.5 + across / 2), id="hole")
    scene = Scene([ball, clock], [Wall(0, 0, 1, 0, id="floor"), Wall(0, 30, 1, 30, id="high"), FAR],
                  pockets=[hole], capture=True)  # fmt: skip
    found = judged(scene, Steps(step=step), 120)
    assert sizes(found)["LATENESS"] == pytest.approx(across, rel=1e-6)
    assert found.diagnosis is not None
    assert found.diagnosis.name in (CauseName.STEP, CauseName.LATENESS)


# -- drawn scenes


def campaign(seeds: range, names: tuple[str, ...]) -> Counter[str]:
    """How many divergences are of an entry, and have an account; none of any is refuted."""
    seen = Counter[str]()
    for seed in seeds:
        scene = pocketed(seed)
        for name in names:
            found = compare(scene, [engine_named(name)], events=60).candidates[0]
            if found.verdict != "diverged" or found.diagnosis is None:
                continue
            refuted = refute(scene, engine_named(name), found)
            assert not refuted, (seed, name, refuted)
            taken = [
                {e.circle for e in run.pocketings} for run in (ExactEngine().run(scene, events=60), found.trajectory)
            ]
            seen["diverged"] += 1
            seen["entered in one"] += taken[0] != taken[1]
            seen["closed"] += found.diagnosis.closed
    return seen


def test_what_is_said_of_drawn_scenes_with_pockets_no_other_run_refutes() -> None:
    seen = campaign(range(16), ("single", "rounded:bits=12"))
    assert seen["diverged"] >= 6
    assert seen["closed"] >= 0.8 * seen["diverged"]
