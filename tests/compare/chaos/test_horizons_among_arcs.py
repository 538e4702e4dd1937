"""Predicted horizons among arcs: what an engine has lost by then, measured; and the margins that they rest on."""

from __future__ import annotations

from random import Random

import numpy as np
import pytest

from truebreak.compare import compare
from truebreak.compare.chaos.certified_chaos import chaos
from truebreak.compare.chaos.foreseen import foreseen
from truebreak.compare.tangent.hazard import Course
from truebreak.compare.tangent.impacts import impacts
from truebreak.exact import ExactEngine
from truebreak.scenarios import Arc, Circle, Quantity, Scene, catalogue

RING = Arc(0, 0, 5, id="ring", full=True)


def test_most_engines_diverge_within_what_is_predicted() -> None:
    """Of the 90 % prediction intervals on the tables with arcs and in a ring of three discs."""
    rng, inside, total = Random(5), 0, 0
    for k in range(12):
        vx, vy = f"{rng.randint(300, 1000)}/1000", f"{rng.randint(-1000, 1000)}/1000"
        ball = Circle(0, f"{rng.randint(200, 500)}/1000", r="1/10", vx=vx, vy=vy, id="ball")
        if k % 3 < 2:
            scene = catalogue.build(("stadium", "mushroom")[k % 3]).with_changes(circles=[ball])
        else:
            others = [Circle(2, "-1/2", r="1/2", vx=vy, vy=vx), Circle(-2, 0, r="1/3", vx="-1/3", vy=vx, m=2)]
            scene = Scene([ball, *others], arcs=[RING])
        for told in chaos(scene, ["double", "single", "rounded:bits=16"], events=60).horizons:
            if told.seen is not None and told.seen.place is not None and told.seen.verdict == "diverged":
                total += 1
                inside += told.holds(told.seen.place)
    assert total > 20
    assert inside >= 0.75 * total


def test_what_is_predicted_of_a_comparison() -> None:
    found = foreseen(compare(catalogue.build("stadium"), ["double"], events=100))
    assert found is not None
    assert found.horizons[0] is not None
    assert found.horizons[0].expected.event is not None
    assert 20 < found.horizons[0].expected.event < 60


@pytest.mark.parametrize("seed", range(20))
def test_the_depth_is_where_the_next_contact_changes(seed: int) -> None:
    """A disc moved aside by less than the depth has the same first contact, by a little more another, or none."""
    rng = Random(seed)
    bow = Arc(0, 0, 3, *rng.choice(((0, -1, 0, 1), (3, -4, -4, 3), (-1, 0, 1, 0))), id="bow")
    at = lambda: Quantity.of(rng.randint(-900, 900)) / 1000  # noqa: E731
    within = seed % 2 == 0
    x, y = (at(), at()) if within else (Quantity.of(8), at() * 3)
    vx, vy = (at(), at()) if within else (Quantity.of(-1), at() / 4)
    size = (vx * vx + vy * vy).sqrt()

    def scene(aside: float) -> Scene:
        off = Quantity.of(aside) / size
        return Scene([Circle(x - off * vy, y + off * vx, r="1/4", vx=vx, vy=vy, id="disc")], arcs=[bow])

    run = ExactEngine().run(scene(0.0), events=1, until=100)
    if not run.events:
        return
    [[impact]] = impacts(run, 1)
    course = Course(run.scene)
    course.fly(float(impact.time))
    passing = course.passing(impact)
    assert passing is not None
    if within and passing.depth > 0.5:  # so far aside it would begin somewhere else
        return
    for share, hits in ((0.999999, {True}), (1.000001, {True, False})):
        found = [bool(ExactEngine().run(scene(s * share * passing.depth), events=1, until=100).events) for s in (-1, 1)]
        assert {*found} == hits


def test_what_comes_next_but_for_an_impact() -> None:
    """A disc at a post, in a ring around both: the ring's inside is next, at its distance, as fast as it flies."""
    scene = Scene([Circle(0, 0, r=1, vx=2, id="c"), Circle(3, 0, r="1/2", m="oo", id="post")], arcs=[RING])
    [[impact]] = impacts(ExactEngine().run(scene, events=1), 1)
    course = Course(scene)
    course.fly(float(impact.time))
    others = course.instead([impact], 0)
    assert np.allclose(others.waits, [(4 - 1.5) / 2])
    assert np.allclose(others.normals, [[1, 0]])
    assert np.allclose(others.rates, [2])
