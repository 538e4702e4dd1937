"""Predicted horizons among arcs: what an engine has lost by then, measured; and the margins that they rest on."""

from __future__ import annotations

from dataclasses import replace
from math import hypot, inf
from random import Random
from typing import TYPE_CHECKING

import numpy as np
import pytest
from arc_scenes import falls_to_arcs

from truebreak.compare import compare
from truebreak.compare.chaos.certified_chaos import chaos
from truebreak.compare.chaos.foreseen import foreseen
from truebreak.compare.tangent import flight_aside
from truebreak.compare.tangent.growth import Displacements, unit_displacements
from truebreak.compare.tangent.hazard import Course
from truebreak.compare.tangent.impacts import impacts
from truebreak.exact import ExactEngine
from truebreak.exact.numbers import ball as ball_numbers
from truebreak.scenarios import Arc, Circle, Quantity, Scene, catalogue

if TYPE_CHECKING:
    from flint import arb

    from truebreak.scenarios.trajectory import Trajectory

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


# -- Under gravity.


@pytest.mark.parametrize("seed", range(12))
def test_a_tangent_map_at_arcs_under_gravity_is_that_of_exact_neighbours(seed: int) -> None:
    """Place and velocity after the last impact, of runs a 2**-60th beside in each coordinate of the start."""
    scene, aside, events = falls_to_arcs(seed), Quantity.of(2) ** -60, 6
    [ball] = scene.circles

    def run_of(own: Circle) -> Trajectory:
        return ExactEngine().run(scene.with_changes(circles=[own]), events=events)

    def last(run: Trajectory, time: arb) -> list[arb]:
        """Where a run is at a time just beside its last event, as if it had flown there."""
        state = run.after(len(run.events) - 1)["ball"]
        x, y, vx, vy = (value.ball(400) for value in (state.x, state.y, state.vx, state.vy))
        assert scene.gravity is not None
        gx, gy = (ball_numbers.constant(part) for part in scene.gravity)
        late = time - run.events[-1].time.ball(400)
        return [x + (vx + gx * late / 2) * late, y + (vy + gy * late / 2) * late, vx + gx * late, vy + gy * late]

    run = run_of(ball)
    carried = Displacements(scene, unit_displacements(scene))
    for struck in impacts(run, len(run.events)):
        carried.through(struck)
    with ball_numbers.precision(400):
        time = run.events[-1].time.ball(400)
        here = last(run, time)
        for column, key in enumerate(("x", "y", "vx", "vy")):
            other = run_of(replace(ball, **{key: getattr(ball, key) + aside}))
            assert [event.contacts for event in other.events] == [event.contacts for event in run.events]
            wanted = [float((b - a) * 2**60) for a, b in zip(here, last(other, time), strict=True)]
            assert np.allclose(carried.matrix[:, column], wanted, rtol=1e-9, atol=1e-9 * max(map(abs, wanted)))


def met_next(scene: Scene, course: Course, without: str) -> tuple[float, float]:
    """When the ball meets something, by an exact run from where it is, and how it then approaches it."""
    (x, y), (vx, vy), [c] = course.places[0].tolist(), course.speeds[0].tolist(), scene.circles
    mover = Circle(x, y, c.r * (1 - Quantity.of("10**-9")), vx, vy, id="ball")  # in doubles it may overlap
    things = [one for one in scene.arcs if one.id != without]
    run = ExactEngine().run(Scene([mover], arcs=things, gravity=scene.gravity), events=1)
    if not run.events:
        return inf, 0.0
    after = run.after(0)["ball"]
    gx, gy = map(float, scene.gravity or (0, 0))
    time = float(run.events[0].time)
    change = hypot(float(after.vx) - vx - gx * time, float(after.vy) - vy - gy * time)
    return time, change / 2  # an elastic impulse is twice the approach


def met_instead(seeds: range) -> int:
    """Holds what a course says that would be met first against an exact run; how often something is."""
    seen = 0
    for seed in seeds:
        scene = falls_to_arcs(seed)
        run = ExactEngine().run(scene, events=8)
        course = Course(scene)
        for event, struck in zip(run.events, impacts(run, len(run.events)), strict=True):
            course.fly(float(struck[0].time))
            [pair], [impact] = event.contacts, struck
            time, rate = met_next(scene, course, pair.second)
            others = course.instead(struck, 0)
            assert min(others.waits, default=inf) == pytest.approx(time, rel=1e-6)
            if time < inf:
                assert others.rates[others.waits.argmin()] == pytest.approx(rate, rel=1e-5)
                seen += 1
            assert np.allclose(np.hypot(*others.normals.T), 1.0)
            course.push(impact)
    return seen


def test_what_would_be_met_instead_of_an_arc_is_what_an_exact_run_meets() -> None:
    assert met_instead(range(30)) > 40


def rising(self: flight_aside.RoundSide, fall: flight_aside.RoundFall[float]) -> float | None:
    """The first zero of the gap, within the range or not."""
    sign = -1.0 if self.hollow else 1.0
    return flight_aside.told_falling_zero([sign * value for value in fall.polynomial(False)])


def test_an_arc_that_is_taken_for_a_full_circle_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(flight_aside.RoundSide, "_fallen_to", rising)
    with pytest.raises(AssertionError):
        met_instead(range(30))
