"""What is known of the tables with arcs in the catalogue, against what the engines make of them."""

from __future__ import annotations

import math

import pytest

from truebreak.compare.chaos.certified_chaos import chaos
from truebreak.exact import ExactEngine
from truebreak.scenarios import Quantity, SceneError, catalogue
from truebreak.scenarios.catalogue.scene_entry import sine


def test_the_stadium_has_its_exponent_and_its_mean_flight() -> None:
    rate = chaos(catalogue.build("stadium"), [], events=3000).spectrum.per_time()
    assert rate.low is not None
    assert rate.high is not None
    assert rate.low < 0.43 < rate.high
    assert 0.38 < rate.value < 0.48
    times = [float(event.time) for event in ExactEngine().run(catalogue.build("stadium"), events=3000).events]
    blocks = [(times[k + 99] - times[k]) / 99 for k in range(0, 2900, 100)]
    mean = sum(blocks) / len(blocks)
    error = (sum((b - mean) ** 2 for b in blocks) / len(blocks) / (len(blocks) - 1)) ** 0.5
    assert abs(mean - math.pi * (math.pi + 4) / (2 * math.pi + 4)) < 3 * error


@pytest.mark.parametrize(("y", "enters"), [("2/3", False), ("11/20", False), ("9/20", True), ("1/3", True)])
def test_a_mushroom_s_stem_is_entered_by_what_comes_near_its_middle(y: str, enters: bool) -> None:
    run = ExactEngine().run(catalogue.build(f"mushroom:y={y}"), events=200)
    assert run.certified
    met = {event.contacts[0].second for event in run.events}
    assert bool(met & {"stem right", "stem left", "foot"}) is enters
    assert len(run.events) == 200


@pytest.mark.parametrize("d", ["1/2", "3/4", "5/4", "8/5"])
def test_beside_the_axis_of_a_lemon_a_point_turns_by_its_angle(d: str) -> None:
    run = ExactEngine().run(catalogue.build(f"lemon:d={d},y=1/10**9"), events=60)
    times = [event.time for event in run.events if event.contacts[0].second == "right"]
    heights = [float(run.at(time).circles[0].y) * 1e9 for time in times]
    assert len(heights) == 30
    turn = 2 * (2 * (float(Quantity.of(d)) - 1) ** 2 - 1)  # twice the cosine
    for a, b, c in zip(heights, heights[1:], heights[2:], strict=False):
        assert c == pytest.approx(turn * b - a, abs=1e-6)


@pytest.mark.parametrize("n", ["3", "4", "5", "6", "8", "10", "12"])
def test_a_round_table_closes_exactly(n: str) -> None:
    scene = catalogue.build(f"round-table:n={n},speed=3/2")
    period = 8 * int(n) * sine(360 // int(n)) / Quantity.of("3/2")
    run = ExactEngine().run(scene, until=period)
    assert run.certified
    assert len(run.events) == int(n)
    (start,), (end,) = scene.circles, run.final.circles
    for key in ("x", "y", "vx", "vy"):
        assert Quantity.of(getattr(end, key).text()) == getattr(start, key), key


@pytest.mark.parametrize("spec", ["mushroom:stem=4", "mushroom:y=2", "lemon:d=2", "lemon:d=5/2"])
def test_what_is_no_such_table_is_refused(spec: str) -> None:
    with pytest.raises(SceneError, match=r"between 0 and|make it less"):
        catalogue.build(spec)
