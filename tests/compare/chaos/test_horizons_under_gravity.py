"""Horizons where circles fall onto what stands: what would be met instead is what an exact run meets."""

from __future__ import annotations

from math import hypot, inf

import numpy as np
import pytest

from truebreak.compare.chaos.certified_chaos import chaos
from truebreak.compare.tangent import hazard
from truebreak.compare.tangent.flight_aside import falls_past
from truebreak.compare.tangent.hazard import Course, ErrorModel, error_curve
from truebreak.compare.tangent.impacts import impacts, moving
from truebreak.exact import ExactEngine
from truebreak.exact.replay.round_falls import RoundFall
from truebreak.scenarios import Circle, Quantity, Scene, Segment, Wall, catalogue


def met_next(scene: Scene, course: Course, i: int, without: set[str]) -> float:
    """How long until a circle meets something, by an exact run from where it is, without some of what stands."""
    (x, y), (vx, vy), c = course.places[i].tolist(), course.speeds[i].tolist(), scene.circles[i]
    mover = Circle(x, y, c.r * (1 - Quantity.of("10**-9")), vx, vy, m=c.m, id=c.id)  # in doubles it may overlap
    circles = [mover, *(other for other in scene.circles if other.fixed and str(other.id) not in without)]
    things = [one for one in scene.segments if str(one.id) not in without]
    walls = [wall for wall in scene.walls if str(wall.id) not in without]
    run = ExactEngine().run(Scene(circles, walls, segments=things, gravity=scene.gravity), events=1)
    return float(run.events[0].time) if run.events else inf


@pytest.mark.parametrize(("text", "events"), [("galton:e=1", 12), ("plinko", 12), ("platforms", 20)])
def test_what_would_be_met_instead_is_what_an_exact_run_meets(text: str, events: int) -> None:
    scene = catalogue.build(text)
    run = ExactEngine().run(scene, events=events)
    course, seen = Course(scene), 0
    for event, struck in zip(run.events, impacts(run, events), strict=True):
        course.fly(float(struck[0].time))
        [pair] = event.contacts
        [i] = [k for k in moving(scene) if scene.ids[k] in pair]
        [impact] = struck
        ends = {str(s.id): {(s.x0, s.y0), (s.x1, s.y1)} for s in scene.segments}
        joined = sum(not places.isdisjoint(ends.get(pair.second, ())) for places in ends.values()) > 1
        true = met_next(scene, course, i, set(pair) - {scene.ids[i]})
        others = course.instead(struck, i)
        if not joined:  # else what they have in common is another meeting of the one, and none of the other
            assert min(others.waits, default=inf) == pytest.approx(true, rel=1e-6)
        assert np.allclose(np.hypot(*others.normals.T), 1.0) and (others.rates > 0).all()
        seen += true < inf and not joined
        course.push(impact)
    assert seen > 6


def test_a_face_that_is_passed_from_below_is_met_from_above() -> None:
    """Beside a platform a ball rises above its line, and lands on it: where it stands its face lies before it."""
    scene = Scene(
        [Circle(-4, -2, "1/2", vx=2, vy=8, id="ball")],
        [Wall(0, -9, 1, -9, id="floor"), Wall(-8, 0, -8, 1, id="left")],
        segments=[Segment(-2, 0, 2, 0, id="platform")], gravity=(0, -8),
    )  # fmt: skip
    course = Course(scene)
    found = course._walls_of(0, [], 0)  # pyright: ignore[reportPrivateUsage]
    run = ExactEngine().run(scene, events=1)
    assert float(run.events[0].time) == pytest.approx(min(found.waits.tolist()))


@pytest.mark.parametrize("seed", range(40))
def test_the_nearest_of_a_fall_past_a_place_is_a_least_distance(seed: int) -> None:
    draw = np.random.default_rng(seed)
    fall = RoundFall(*(float(value) for value in draw.uniform(-2, 2, 6)), 0.5)
    wait, then = falls_past(fall)
    assert abs(then.dx * then.vx + then.dy * then.vy) < 1e-9 * hypot(then.dx, then.dy) * hypot(then.vx, then.vy) + 1e-12
    for aside in (-1e-3, 1e-3):
        near = fall.after(wait + aside)
        assert hypot(near.dx, near.dy) >= hypot(then.dx, then.dy)


@pytest.mark.parametrize("restitution", ["1", "7/10"])
def test_a_late_push_turns_an_impact_by_as_much_as_it_does(restitution: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The error of an engine of steps, beside the difference of two pushes, one of which is late by a millionth."""
    late = 2.0**-20
    scene = Scene(
        [Circle("1/3", 5, vx="1/9", id="ball"), Circle(0, 0, m="oo", id="peg")],
        gravity=(0, -10), restitution=restitution,
    )  # fmt: skip
    [[impact]] = impacts(ExactEngine().run(scene, events=1), 1)
    seen = []
    monkeypatch.setattr(hazard, "SAMPLES", 1)
    monkeypatch.setattr(np.random, "default_rng", lambda seed: Late())
    through = hazard.Displacements.through

    def kept(self: hazard.Displacements, struck: list[hazard.Impact]) -> None:
        through(self, struck)
        seen.append(self)

    monkeypatch.setattr(hazard.Displacements, "through", kept)
    error_curve(ExactEngine().run(scene, events=1), [[impact]], ErrorModel.STEPPED).hazard(0.0)
    pushed = []
    for lag in (0.0, late):
        course = Course(scene)
        course.fly(float(impact.time) + lag)
        dx, dy = (course.places[1] - course.places[0]).tolist()
        vx, vy = (-course.speeds[0]).tolist()
        course.push(impact._replace(dx=dx, dy=dy, vx=vx, vy=vy, reach=hypot(dx, dy)))
        course.fly(float(impact.time) + late)
        pushed.append(np.concatenate([course.places[0], course.speeds[0]]))
    wanted = (pushed[1] - pushed[0]) / late
    assert np.allclose(seen[0].of(0)[:, 0], wanted, rtol=1e-4)


class Late:
    """Draws the highest number that is asked for: a whole step of lateness."""

    def uniform(self, low: float, high: float, shape: object) -> np.ndarray:
        """That number, in so many places."""
        return np.full(shape, high)  # pyright: ignore[reportArgumentType, reportCallIssue]


def test_gravity_left_out_of_what_comes_instead_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """By straight flights other things come first, or nothing does."""
    monkeypatch.setattr(hazard, "falls_onto", hazard_straight)
    with pytest.raises(AssertionError):
        test_what_would_be_met_instead_is_what_an_exact_run_meets("plinko", 12)


def hazard_straight(fall: RoundFall[float]) -> tuple[float, RoundFall[float]] | None:
    """A meeting as if nothing fell."""
    from truebreak.compare.tangent.flight_aside import falls_onto

    return falls_onto(fall._replace(hx=0.0, hy=0.0))


def seen_in_bands(seeds: range) -> tuple[int, int]:
    """How often the first divergence falls in the band, and of how many."""
    held = told = 0
    for seed in seeds:
        scene = catalogue.build(f"galton:e=1,rows=6,seed={seed}")
        for horizon in chaos(scene, ["double", "single", "rounded:bits=30", "pymunk:dt=1/4096"], events=60).horizons:
            if horizon.seen is not None and horizon.seen.place is not None:
                told += 1
                held += horizon.holds(horizon.seen.place)
    return held, told


def test_the_bands_hold_what_is_seen() -> None:
    held, told = seen_in_bands(range(1, 11))
    assert told >= 30
    assert held / told > 0.75
