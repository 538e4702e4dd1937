"""What a tie is held to, in whatever order its impulses are taken: the time at which it begins."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from bugs import BUGS, Planted
from logs import triples

from truebreak.compare import engine
from truebreak.compare.testing.check import CheckFailed, check
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Circle, Scene, Wall

ROW = Scene(
    [Circle(-5, 0, vx=1, id="striker"), *(Circle(2 * k, 0, id=f"b{k}") for k in range(4))],
    [Wall(12, 0, 12, 1, id="right"), Wall(-9, 0, -9, 1, id="left")],
    name="row",
    events=6,
)
"""Balls that touch, and one that strikes them at t = 3: all that follows is a tie."""


def faster(scene: Scene) -> Scene:
    """The first circle has 0.1 % more speed."""
    first, *others = scene.circles
    quicker = Circle(first.x, first.y, first.r, first.vx * "1001/1000", first.vy, m=first.m, id=first.id)
    return scene.with_changes(circles=[quicker, *others])


FASTER = replace(BUGS[0], name="wrong speed", given=faster)


@pytest.mark.parametrize("permitted", [False, True])
@pytest.mark.parametrize("name", ["double", "single", "quad"])
def test_a_tie_is_at_its_time_whatever_happens_in_it(name: str, permitted: bool) -> None:
    assert check(name, ROW, permitted=permitted).asserted
    with pytest.raises(CheckFailed, match=r"first meeting of its tie is at 2\.997.* where it should be 3: off by"):
        check(Planted(engine(name), FASTER), ROW, permitted=permitted)


@pytest.mark.parametrize("permitted", [False, True])
def test_of_a_log_the_time_of_a_tie_is_known_too(permitted: bool) -> None:
    def told(scene: Scene) -> Any:
        return triples(DoubleEngine().run(scene))

    assert check(told(ROW), ROW, permitted=permitted).asserted
    with pytest.raises(CheckFailed, match=r"the first meeting of its tie is at 2\.997"):
        check(told(faster(ROW)), ROW, permitted=permitted)


def test_before_a_tie_no_order_excuses_a_history() -> None:
    """One that goes to and fro meets each wall twice; told once less before the tie, it still meets both."""
    scene = ROW.with_changes(circles=[*ROW.circles, Circle(0, 5, vx=16, id="shuttle")], events=8)
    told = triples(DoubleEngine().run(scene))
    assert told[1][1:] == ("shuttle", "left")
    assert check(told, scene, permitted=True).asserted
    with pytest.raises(CheckFailed, match=r"first differs at event 1 .*shuttle meets wall right instead of wall left"):
        check([told[0], *told[2:]], scene, permitted=True)


LOOSE = Scene(
    [Circle(-3, 0, r="1/2", vx=1, id="striker"), *(Circle(k, 0, r="1/2", id=f"b{k}") for k in range(5))],
    [Wall(7, 0, 7, 1, id="right")],
    name="loose",
    events=2,
)


@pytest.mark.parametrize("permitted", [False, True])
def test_a_wall_that_is_missed_at_the_very_end_is_found_after_it(permitted: bool) -> None:
    """The last of the row comes to it in the true run's last event."""
    missed = next(bug for bug in BUGS if bug.name == "missed wall")
    assert check("double", LOOSE, permitted=permitted).asserted
    with pytest.raises(CheckFailed, match="wall"):
        check(Planted(engine("double"), missed), LOOSE, permitted=permitted)
