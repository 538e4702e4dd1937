"""What rounding may do under gravity, with a restitution and among walls that move: neighbours stay within it."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from random import Random
from typing import Any

import numpy as np
import pytest

from truebreak.compare import engine
from truebreak.compare.tangent.growth import push_together
from truebreak.compare.tangent.impacts import Impact
from truebreak.compare.testing.check import CheckFailed, check
from truebreak.compare.tolerances.errors_grown import GrownErrors, LocalError, Nearby, local_error
from truebreak.compare.tolerances.reach import Reach, reach_of
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Quantity, Scene, SceneError, Trajectory, Wall, catalogue
from truebreak.scenarios.engine import Declared

UNIT = 2.0**-24
"""How far off a start may be, as a share of each number."""

SECOND = 1.07
"""Where errors are a sixteenth of every margin, what the first order says of their size is right to so much."""


def drawn(seed: int) -> Scene:
    """Discs over a floor that may slope or move, under a ceiling that one of them may all but reach."""
    rng = Random(seed)
    sixteenths = lambda low, high: Fraction(rng.randint(low, high), 16)  # noqa: E731
    circles = [
        Circle(
            str(sixteenths(-40, 40) + 6 * k),
            str(sixteenths(24, 90)),
            r="1/2",
            vx=str(sixteenths(-32, 32)),
            vy=str(sixteenths(1, 48)),
            id=f"c{k}",
        )
        for k in range(rng.randint(1, 3))
    ]
    pace = lambda: str(Fraction(rng.choice((0, 0, 1, -1)), 16))  # noqa: E731
    pull = -sixteenths(4, 40)
    first = circles[0]
    apex = Fraction(str(first.y)) + Fraction(str(first.vy)) ** 2 / (-2 * pull) + Fraction(1, 2)
    top = apex + Fraction(rng.choice((1, -1, 10, -10, 100, -100, 2**22)), 2**24)
    walls = [
        Wall(0, 0, rng.choice((1, 5)), rng.choice((0, 1)), vy=pace(), id="floor"),
        Wall(-6, 0, -6, 1, vx=pace(), id="left"),
        Wall(18, 0, 18, 1, vx=pace(), id="right"),
        Wall(0, str(top), 1, str(top), id="top"),
    ]
    return Scene(circles, walls, gravity=(0, str(pull)), restitution=rng.choice(("1", "9/10")))


def beside(scene: Scene, rng: Random) -> Scene:
    """A scene whose start is off by a share of each number."""

    def off(value: Quantity) -> str:
        number = Fraction(str(value))
        return str(number + Fraction(UNIT) * abs(number) * rng.choice((1, -1)))

    circles = [Circle(off(c.x), off(c.y), r=c.r, vx=off(c.vx), vy=off(c.vy), id=c.id) for c in scene.circles]
    return scene.with_changes(circles=circles)


def met(run: Trajectory, events: int, name: str) -> list[tuple[str, int]]:
    """Whom a circle meets, and in which event."""
    pairs = ((pair, event.index) for event in run.events[:events] for pair in event.contacts)
    return [(next(other for other in pair if other != name), k) for pair, k in pairs if name in pair]


def assert_within(scene: Scene, run: Trajectory, other: Trajectory, reach: Reach) -> None:
    gx, gy = map(float, scene.gravity or (0, 0))
    for name in (str(circle.id) for circle in scene.circles):
        mine, theirs = met(run, reach.events, name), met(other, len(other.events), name)
        assert [who for who, _ in mine] == [who for who, _ in theirs[: len(mine)]]
        for (_, k), (_, its) in zip(mine, theirs, strict=False):
            if k >= reach.linear:
                break
            one, two = run.after(k)[name], other.after(its)[name]
            lag = float(other.events[its].time) - float(run.events[k].time)
            vx, vy = float(two.vx) - gx * lag, float(two.vy) - gy * lag
            x, y = float(two.x) - (vx + gx * lag / 2) * lag, float(two.y) - (vy + gy * lag / 2) * lag
            assert abs(lag) <= SECOND * reach.time[k]
            assert math.hypot(x - float(one.x), y - float(one.y)) <= SECOND * reach.position[k][name]
            assert math.hypot(vx - float(one.vx), vy - float(one.vy)) <= SECOND * reach.velocity[k][name]


@pytest.mark.parametrize("first", range(0, 60, 15))
def test_neighbours_have_the_history_as_far_as_is_required_and_stay_as_near_as_is_granted(first: int) -> None:
    events = 0
    for seed in range(first, first + 15):
        try:
            scene = drawn(seed)
        except SceneError:
            continue
        run = ExactEngine().run(scene, events=20)
        reach = reach_of(run, LocalError(0.0, UNIT))
        events += reach.events
        for trial in range(2):
            other = ExactEngine().run(beside(scene, Random(1000 * seed + trial)), events=reach.events + 6)
            assert_within(scene, run, other, reach)
    assert events > 60


def ceiling(above: str) -> Scene:
    """A ball whose apex is at height 3, where it touches a ceiling at 4; this one is so much above."""
    walls = [Wall(0, 0, 1, 0, id="floor"), Wall(0, f"4 + {above}", 1, f"4 + {above}", id="top")]
    return Scene([Circle(0, 1, vy=4, id="ball")], walls, gravity=(0, -4))


def test_whether_a_ceiling_is_reached_is_no_ones_duty_where_errors_may_change_it() -> None:
    for above, told in (("10**-14", "whether ball passes top"), ("-10**-14", "whether ball reaches top")):
        run = ExactEngine().run(ceiling(above), events=6)
        limit = reach_of(run, local_error(engine("double"), run, 53)).limit
        assert limit is not None and limit.told == told and limit.event == 0
    for above in ("10**-10", "-10**-10"):
        run = ExactEngine().run(ceiling(above), events=6)
        assert reach_of(run, local_error(engine("double"), run, 53)).whole
        limit = reach_of(run, local_error(engine("single"), run, 24)).limit
        assert limit is not None and limit.event == 0


@pytest.mark.parametrize("slope", [0, 1, -2])
@pytest.mark.parametrize("lift", ["0", "1/4", "-1/3"])
def test_what_would_be_met_next_is_met_when_the_law_says(slope: int, lift: str) -> None:
    """A ball between two walls: at its first hit, when it would come to the floor were it not for that."""
    floor, right = Wall(0, 0, 5, slope, vy=lift, id="floor"), Wall(6, 0, 6, 1, vx="-1/5", id="right")
    ball = Circle(0, 9, vx=3, vy=4, id="ball")
    run, alone = (ExactEngine().run(Scene([ball], walls, gravity=(0, -2)), events=1) for walls in
                  ([floor, right], [floor]))  # fmt: skip
    assert [pair.second for event in run.events for pair in event.contacts] == ["right"]
    grown = GrownErrors(run, LocalError(0.0, UNIT))
    grown.come_to(0)
    near = Nearby(grown)
    wait = near.wait(0, 1)
    assert wait == pytest.approx(float(alone.events[0].time) - float(run.events[0].time), rel=1e-12)
    late = near.shift(grown.at(float(run.events[0].time)), 0, 1, float(alone.events[0].time), float(run.events[0].time))
    for k, changes in enumerate(({"x": 0.0}, {"y": 9.0}, {"vx": 3.0}, {"vy": 4.0})):
        ((key, value),) = changes.items()
        moved = Circle(**{"x": 0, "y": 9, "vx": 3, "vy": 4, "id": "ball", key: str(value + 1e-7)})
        other = ExactEngine().run(Scene([moved], [floor], gravity=(0, -2)), events=1)
        slope_of = (float(other.events[0].time) - float(alone.events[0].time)) / 1e-7
        assert late[k] == pytest.approx(slope_of * UNIT * value, rel=1e-5, abs=1e-12)


class Slightly(Declared):
    """Doubles that play another scene than the one given."""

    name = "slightly"
    scene_keys = engine("double").scene_keys
    bits = 53

    def __init__(self, **changes: Any) -> None:
        self.changes = changes

    def run(self, scene: Scene, **limits: Any) -> Trajectory:
        run = engine("double").run(scene.with_changes(**self.changes), **limits)
        return replace(run, scene=scene, engine=self.name)


LIFT = Scene(
    [Circle(0, 3, vx="1/3", id="a"), Circle("1/4", 6, id="b")],
    [Wall(0, 0, 5, 1, vy="1/2", id="floor"), Wall(-3, 0, -3, 1, id="l"), Wall(3, 0, 3, 1, vx="1/9", id="r")],
    gravity=(0, -2),
    restitution="9/10",
)


@pytest.mark.parametrize(
    "changes",
    [
        {"restitution": "9/10 + 10**-9"},
        {"gravity": (0, "-2 + 10**-9")},
        {"gravity": ("10**-9", -2)},
        {"walls": [Wall(0, 0, 5, 1, vy="1/2 + 10**-9", id="floor"), *LIFT.walls[1:]]},
    ],
    ids=["restitution", "gravity", "its direction", "walls"],
)
def test_a_law_that_is_off_by_a_billionth_is_found(changes: dict[str, Any]) -> None:
    assert check(engine("double"), LIFT.with_changes(events=12)).asserted
    with pytest.raises(CheckFailed):
        check(Slightly(**changes), LIFT.with_changes(events=12))


def test_what_is_not_bounded_is_refused_in_one_line_and_a_span_is_not() -> None:
    for scene, name, told in (
        (LIFT, "pymunk", "gravity, and the engine falls by steps"),
        (
            catalogue.build("galton"),
            "double",
            r"gravity and something round and fixed \(a circle, an arc, an end or a corner\)",
        ),
        (LIFT.with_changes(restitution=0), "double", "restitution 0"),
    ):
        with pytest.raises(SceneError, match=f"has {told}, where what rounding may do is not bounded yet; give a span"):
            check(name, scene)
    assert check("double", catalogue.build("galton"), events=1).asserted


def test_contacts_that_push_together_have_the_derivative_of_their_differences() -> None:
    """A disc in a corner of two walls under gravity, with a restitution: each wall is met at its own displaced time."""
    turn, gravity = 1.7, (0.25, -2.0)
    normals, speed = ((0.0, 1.0), (0.8, 0.6)), (-1.0, -1.5)
    struck = [Impact(0.0, 0, None, nx, ny, *speed, 1.0, 0.0, 0.0) for nx, ny in normals]
    columns = np.eye(4).reshape(1, 4, 4)
    found = push_together(columns, {0: 0}, np.array([1.0]), struck, turn, gravity)
    assert found is not None

    def after(start: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
        """Where the disc would have been at time 0 on the flight it has after: the round's strengths from each wall's
        own time."""
        lines = np.array(normals)
        waits = -(lines @ start[:2]) / (lines @ np.array(speed))
        opening = np.array(
            [line @ (start[2:] + wait * np.array(gravity)) for line, wait in zip(lines, waits, strict=True)]
        )
        kicks = (-turn * np.linalg.solve(lines @ lines.T, opening))[:, None] * lines
        place = start[:2] - (kicks * waits[:, None]).sum(axis=0)
        return np.concatenate([place, start[2:] + kicks.sum(axis=0)])

    base, step = np.array([0.0, 0.0, *speed]), 1e-6
    for k in range(4):
        aside = np.zeros(4)
        aside[k] = step
        slope = (after(base + aside) - after(base - aside)) / (2 * step)
        assert found.columns[0, :, k] == pytest.approx(slope, abs=1e-6)
