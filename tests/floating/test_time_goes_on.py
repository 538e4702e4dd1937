"""Whatever rounding does to balls that touch, the clock of a run does not go back."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from math import isfinite
from random import Random

import pytest

from truebreak.compare.engines import engine
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Circle, Scene, StopReason, Wall

ROUNDING = {"double": 1e-12, "single": 1e-4, "quad": 1e-25, "rounded:bits=30": 1e-6}
"""For each engine, more than a last bit of its clock."""


def row_of_balls(seed: int) -> Scene:
    """Balls on a line between two walls; some touch and fly together until another meets them."""
    draw = Random(seed)
    r = draw.choice([Fraction(1), Fraction(3, 10), Fraction(7, 10)])
    x, v, balls = Fraction(0), draw.randint(-2, 2), []
    for _ in range(draw.choice([3, 4, 5, 6, 8])):
        balls.append(Circle(str(x), 0, str(r), v))
        gap = draw.choice([0, 0, 1, Fraction(1, 3)])
        x += 2 * r + gap
        v = draw.randint(-2, 2) if gap else v
    walls = [Wall(-9, 0, -9, 1), Wall(str(x + 5), 0, str(x + 5), 1)]
    if seed % 2:
        walls.append(Wall(0, str(-r), 1, str(-r)))
    return Scene(balls, walls, tie_policy=draw.choice(["simultaneous", "sequential"]))


@pytest.mark.parametrize("name", ROUNDING)
def test_time_goes_on(name: str) -> None:
    """Two that all but rest with each other, and that rounding has put into each other, meet at once: the time at which
    they would have met lies far back."""
    for seed in range(24):
        run = engine(name).run(row_of_balls(seed), events=100)
        times = [float(event.time) for event in run.events]
        assert all(later >= time - ROUNDING[name] for time, later in pairwise(times)), seed
        assert len(times) == 100 or run.stop.reason.name == "QUIET", (seed, run.stop)


@pytest.mark.parametrize("name", ["double", "quad"])
@pytest.mark.parametrize("digits", [170, 240, 320, 400])
def test_a_speed_whose_square_is_nothing_ends_no_run(name: str, digits: int) -> None:
    """Between doubles' least number and its root; to such an engine the two never meet."""
    scene = Scene([Circle(0, 0, vx=f"10**-{digits}"), Circle(4, 0)])
    assert len(engine("exact").run(scene).events) == 1
    assert len(engine(name).run(scene).events) == 0


@pytest.mark.parametrize("digits", [170, 240, 320])
def test_enclosures_meet_at_any_speed(digits: int) -> None:
    """What rounded numbers take for nothing is no reason to leave a meeting out, where the history is certified."""
    scene = Scene([Circle(0, 0, vx=f"10**-{digits}"), Circle(4, 0)])
    run = engine("interval").run(scene)
    assert len(run.events) == 1 or not run.certified


def test_what_all_but_rests_in_a_corner_never_comes_to_it() -> None:
    """A speed of 5e-324 towards a wall is left of a push: in doubles that leads nowhere."""
    discs = [
        Circle("-1/10", "27/20", "1/2", "-4/5", "11/20", id="one"),
        Circle("16/5", "49/10", "1/2", "5/4", "-9/5", id="other"),
    ]
    box = [(-6, -6, 6, -6), (6, -6, 6, 6), (6, 6, -6, 6), (-6, 6, -6, -6)]
    walls = [Wall(*ends, id=f"w{k}") for k, ends in enumerate(box)]
    run = DoubleEngine().run(Scene(discs, walls, restitution=0), events=40)
    assert run.stop.reason is StopReason.QUIET
    assert all(isfinite(float(event.time)) for event in run.events)
