"""Engines of time steps push what lies on a wall in every step: that is no collision, and all else is."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from truebreak.compare import compare
from truebreak.compare.foreign.log_engine import LogEngine
from truebreak.compare.foreign.recording import Recording
from truebreak.exact import ExactEngine
from truebreak.floating import PymunkEngine
from truebreak.scenarios import Circle, Scene, Segment, Wall, catalogue

FLOOR = Wall(0, 0, 1, 0, id="floor")
GRAVITY = (0, -10)


def met(run: object) -> list[tuple[tuple[str, str], ...]]:
    """Who hit whom, event for event."""
    return [tuple((c.first, c.second) for c in event.contacts) for event in run.events]  # pyright: ignore


def falling(e: str, *more: Circle, walls: tuple[Wall, ...] = (FLOOR,)) -> Scene:
    """A disc that falls onto a floor, and what else there is."""
    return Scene([Circle(0, 3, vx=1, id="a"), *more], walls, gravity=GRAVITY, restitution=e, settle=True)


@pytest.mark.parametrize("dt", [1 / 64, 1 / 256, 1 / 1024])
def test_a_disc_that_pushes_another_along_a_floor_meets_it_once(dt: float) -> None:
    """Each step pushes both from the floor, and rounding the one from the other."""
    scene = catalogue.build("landing")
    run = PymunkEngine(dt=dt).run(scene)
    assert met(run) == met(ExactEngine().run(scene))
    assert [(s.circle, s.wall) for s in run.settlings] == [("sitter", "floor"), ("slider", "floor")]
    assert run.stop.reason.name == "QUIET"


def test_what_lies_there_stays_there_between_knots() -> None:
    """In a run of some thousand steps it has few knots, and its place is that on the floor."""
    run = PymunkEngine().run(falling("0"), until=20)
    assert met(run) == [(("a", "floor"),)]
    assert len(run.motion.knots[0]) < 20  # pyright: ignore
    for time in (1.0, 7.03, 19.5):
        at = run.at(time)["a"]
        assert (float(at.x), float(at.vy)) == (pytest.approx(time), 0.0)
        assert abs(float(at.y) - 1) < 0.05


@pytest.mark.parametrize("e", ["1/3", "1/2", "4/5"])
def test_bounces_that_become_too_small_for_a_step_end_at_rest(e: str) -> None:
    """The exact run lists many more of them; they are infinitely many, and matched as one."""
    comparison = compare(falling(e, Circle(60, 1, id="b")), ["pymunk"], until=8)
    found = comparison.candidates[0]
    assert found.alignment.verdict == "agree", found.alignment
    assert len(found.trajectory.events) < len(comparison.reference.events)
    rest = next(s for s in found.trajectory.settlings if s.circle == "a")
    assert rest.since is not None and float(rest.since) <= float(rest.time)


def test_what_falls_off_an_end_lands_again() -> None:
    """It lay on the platform; its landing on the floor is a collision, and so is what it hits there."""
    platform = Segment(-2, 2, 2, 2, "platform")
    scene = Scene(
        [Circle(0, 3, vx=2, id="a"), Circle(9, 1, id="b")], [FLOOR], segments=[platform], gravity=GRAVITY,
        restitution=0, settle=True,
    )  # fmt: skip
    run = PymunkEngine(dt=1 / 512).run(scene, until=4)
    names = [pair for event in met(run) for pair in event]
    assert names.count(("a", "floor")) == 1 and ("a", "b") in names
    assert [(s.circle, s.wall) for s in run.settlings][-1] == ("a", "floor")
    fallen = run.at(1.6)["a"]
    assert float(fallen.y) < 2.95 and float(fallen.vy) < -1


def test_a_blow_from_above_takes_the_wall_along_and_one_along_it_does_not() -> None:
    """The wall is one of the contacts where the blow presses to it by more than lying there takes."""
    above = Scene(
        [Circle(0, 1, id="lies"), Circle(0, 4, vy=-3, id="comes")], [FLOOR], gravity=GRAVITY, restitution=0, settle=True
    )
    assert set(met(PymunkEngine().run(above, until=0.5))[0]) == {("lies", "comes"), ("lies", "floor")}
    along = Scene(
        [Circle(0, 1, id="lies"), Circle(-4, 1, vx=3, id="comes")], [FLOOR], gravity=GRAVITY, restitution=1, settle=True
    )
    assert met(PymunkEngine().run(along, until=1)) == [(("lies", "comes"),)]


def test_between_two_slopes_it_settles_once() -> None:
    """Both push it in every step; it was said to settle anew in each."""
    slopes = [Wall(0, 0, 4, 3, id="right"), Wall(0, 0, -4, 3, id="left")]
    scene = Scene([Circle(0, 3, id="a")], slopes, gravity=GRAVITY, restitution=0, settle=True)
    run = PymunkEngine().run(scene, until=3)
    assert len(run.events) == 1 and len(run.settlings) == 1
    assert abs(float(run.at(2.5)["a"].y) - 1.25) < 0.05


@settings(deadline=None, max_examples=12)
@given(
    st.integers(2, 40), st.integers(-8, 8), st.integers(3, 30), st.sampled_from([("0", 0.0), ("1/2", 0.5)]),
    st.sampled_from([1 / 128, 1 / 500]),
)  # fmt: skip
def test_a_step_by_step_log_has_the_same_collisions(
    height: int, pace: int, way: int, e: tuple[str, float], dt: float
) -> None:
    """A plain engine's places and velocities alone: its landings above g dt are collisions, and no step at rest is."""
    scene = Scene(
        [Circle(0, f"{10 + height}/10", vx=f"{pace}/4", id="a"), Circle(100 + way, 1, id="b")],
        [FLOOR], gravity=GRAVITY, restitution=e[0], settle=True,
    )  # fmt: skip
    recording = Recording(scene, step=dt)
    x, y, vx, vy = 0.0, 1 + height / 10, pace / 4, 0.0
    landed = []
    for number in range(1, int(2 / dt)):
        vy -= 10 * dt
        x, y = x + vx * dt, y + vy * dt
        if y <= 1.0 and vy < 0.0:
            if -vy > 2 * 10 * dt * (1 + 1e-6):
                landed.append(number * dt)
            y, vy = 1.0, -e[1] * vy
        recording.state(number * dt, {"a": (x, y, vx, vy), "b": (100 + way, 1.0, 0.0, 0.0)})
    run = recording.trajectory()
    assert [float(event.time) for event in run.events] == landed
    assert all(event.contacts[0].second == "floor" for event in run.events)
    assert [(s.circle, s.wall) for s in run.settlings if s.circle == "b"] == [("b", "floor")]


def test_a_collision_left_out_is_still_a_divergence() -> None:
    """Power: an engine that lets the slider through the sitter is told, and one that rests agrees."""
    scene = catalogue.build("landing")
    whole = PymunkEngine(dt=1 / 64).run(scene, until=4)
    for lacks, verdict in ((False, "agree"), (True, "diverged")):
        recording = Recording(scene, step=1 / 64)
        for event in whole.events[: len(whole.events) - lacks]:
            states = {c.id: (c.x, c.y, c.vx, c.vy) for c in whole.at(event.time).circles}
            recording.hits(float(event.time), [tuple(c) for c in event.contacts], states)  # pyright: ignore
        recording.end(400)
        log = LogEngine(recording, "log", 53, 1 / 64)
        assert compare(scene, [log], until=3).candidates[0].alignment.verdict == verdict
