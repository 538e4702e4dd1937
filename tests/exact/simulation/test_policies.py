"""Tie policies: what comes out of several contacts at one instant, in every event-driven engine."""

from __future__ import annotations

import math
from fractions import Fraction
from pathlib import Path
from typing import Any

import impulse_policies
import pytest

from truebreak.exact import ExactEngine
from truebreak.exact.simulation.policies import policy_for
from truebreak.floating import DoubleEngine, IntervalEngine
from truebreak.scenarios import Circle, Quantity, Scene, SceneError, StopReason, TiePolicy, Trajectory, Wall, catalogue

C = Circle
ENGINES = {"exact": ExactEngine(), "double": DoubleEngine(), "interval": IntervalEngine(bits=53)}
every_engine = pytest.mark.parametrize("engine", ENGINES)

LEE = catalogue.build("lee")
TWO = Scene([C(0, 0, vx=1, id="cue"), C("3+sqrt(3)", 1, id="up"), C("3+sqrt(3)", -1, id="down")])
THREE = Scene([C(-5, 0, vx=1), C(0, 0), C("sqrt(3)", 1), C("sqrt(3)", -1)])
SCENE_ORDER, OTHER_ORDER = "sequential:order=scene", "sequential:seed=0"


def velocities(run: Trajectory) -> list[Any]:
    return [value for c in run.final.circles for value in (c.vx, c.vy)]


def play(scene: Scene, policy: str, engine: str, **limits: Any) -> Trajectory:
    return ENGINES[engine].run(scene.with_changes(tie_policy=policy), **limits)


def assert_ends(run: Trajectory, expected: list[str]) -> None:
    """Exact engines give these numbers, intervals hold them, doubles come close."""
    for value, text in zip(velocities(run), expected, strict=True):
        number = Quantity.of(text)
        if run.engine == "exact":
            assert Quantity.of(value.text()) == number
        elif run.engine == "interval":
            assert value.low <= float(number) <= value.high
            assert value.high - value.low < 1e-12
        else:
            assert math.isclose(value, float(number), rel_tol=1e-14, abs_tol=1e-14)


def on_line(*vx: str) -> list[str]:
    """Velocities along x, with none along y between them."""
    return [text for v in vx for text in (v, "0")]


# -- three scenes under each policy

ENDS: dict[tuple[str, str], list[str]] = {
    ("lee", "simultaneous"): on_line("-2", "-1", "0"),
    ("lee", SCENE_ORDER): on_line("-11/5", "-8/25", "-3/25"),
    ("two", "simultaneous"): ["-1/5", "0", "3/5", "sqrt(3)/5", "3/5", "-sqrt(3)/5"],
    ("two", SCENE_ORDER): ["-1/8", "-sqrt(3)/8", "3/4", "sqrt(3)/4", "3/8", "-sqrt(3)/8"],
    ("cradle", "simultaneous"): on_line("0", "0", "0", "0", "0", "1"),
    ("cradle", SCENE_ORDER): on_line("0", "0", "0", "0", "0", "1"),
    ("three", "simultaneous"): ["-1/5", "0", "0", "0", "3/5", "sqrt(3)/5", "3/5", "-sqrt(3)/5"],
}
"""Final velocities, derived by hand: see docs/policies.md."""

SCENES = {"lee": LEE, "two": TWO, "cradle": catalogue.build("cradle:gap=0"), "three": THREE}


@every_engine
@pytest.mark.parametrize(("name", "policy"), ENDS)
def test_the_outcome_is_the_one_derived_by_hand(name: str, policy: str, engine: str) -> None:
    run = play(SCENES[name], policy, engine, events=1)
    if name == "two" and engine == "interval":
        assert run.stop.reason is StopReason.UNDECIDED  # intervals of two equal times overlap, and tell no more
        return
    assert_ends(run, ENDS[name, policy])


@every_engine
def test_the_other_order_of_lee_comes_up_by_seed(engine: str) -> None:
    ends = {
        "left": on_line("-11/5", "-8/25", "-3/25"),
        "middle": on_line("-8/5", "-39/25", "1/25"),
    }
    seen = set()
    for seed in range(8):
        run = play(LEE, f"sequential:seed={seed}", engine)
        first = run.events[0].impulses[0].first
        seen.add(first)
        assert_ends(run, ends[first])
    assert seen == set(ends)


@pytest.mark.parametrize("engine", ["exact", "double"])
def test_one_onto_two_is_symmetric_only_if_simultaneous(engine: str) -> None:
    both = play(TWO, "simultaneous", engine)
    assert both.events[0].impulses == (("cue", "up"), ("cue", "down"))
    assert both.events[0].coupled
    up, down = both.final["up"], both.final["down"]
    assert math.isclose(float(up.vx), float(down.vx))
    assert math.isclose(float(up.vy), -float(down.vy))
    for policy in (SCENE_ORDER, OTHER_ORDER):
        run = play(TWO, policy, engine)
        first = run.events[0].impulses[0].second
        second = {"up": "down", "down": "up"}[first]
        assert math.isclose(float(run.final[first].vx), 2 * float(run.final[second].vx))


@every_engine
@pytest.mark.parametrize("policy", ["simultaneous", SCENE_ORDER, "sequential:seed=1", "sequential:seed=2"])
def test_one_ball_moves_in_a_cradle_whatever_the_policy(policy: str, engine: str) -> None:
    """Equal masses swap velocities; the article's numbers, for five returns and more."""
    run = play(SCENES["cradle"], policy, engine, events=40)
    assert len(run.events) == 40
    for event in run.events:
        speeds = sorted(abs(float(c.vx)) for c in run.at(event.time).circles)
        assert speeds == [0, 0, 0, 0, 0, 1]
    assert [len(event.impulses) for event in run.events[:4]] == [5, 1, 5, 1]


@pytest.mark.parametrize("balls", [2, 5, 17])
def test_two_strikers_send_two_balls_out(balls: int) -> None:
    circles = [C(-6, 0, vx=1), C(-4, 0, vx=1), *(C(2 * k, 0) for k in range(balls))]
    for policy in ("simultaneous", SCENE_ORDER):
        run = ExactEngine().run(Scene(circles, tie_policy=policy))
        moving = [k for k, c in enumerate(run.final.circles) if float(c.vx) == 1]
        assert moving == [balls, balls + 1]
        assert all(float(c.vx) in (0, 1) for c in run.final.circles)


# -- seeds


@every_engine
def test_a_seed_draws_the_same_order_each_time(engine: str) -> None:
    scene = catalogue.build("cradle:gap=0,n=4") if engine == "interval" else catalogue.build("rack:rows=4")
    runs = [play(scene, "sequential:seed=11", engine, events=6) for _ in range(2)]
    assert [e.impulses for e in runs[0].events] == [e.impulses for e in runs[1].events]


def test_a_seed_draws_the_same_order_in_every_engine() -> None:
    for seed in range(10):
        orders = {play(LEE, f"sequential:seed={seed}", engine).events[0].impulses for engine in ENGINES}
        assert len(orders) == 1


def test_each_of_the_contacts_is_drawn_equally_often() -> None:
    approaching = [(0, 1), (0, 2), (0, 3)]
    counts = dict.fromkeys(approaching, 0)
    policy = policy_for(TiePolicy("sequential", 5))
    for _ in range(6_000):
        (chosen,) = policy.choose(approaching, lambda question: 0)
        counts[chosen] += 1
    assert all(abs(count - 2_000) < 200 for count in counts.values())  # over 5 standard deviations


def test_nothing_is_drawn_where_one_contact_approaches() -> None:
    """So a scene without ties has one history, and a tie's draw does not depend on what came before."""
    late = LEE.with_changes(circles=[*LEE.circles, C(50, 9, vx=1), C(52, 9)])
    for seed in range(6):
        policy = f"sequential:seed={seed}"
        first = [play(scene, policy, "exact").events[-1].impulses[0] for scene in (LEE, late)]
        assert first[0] == first[1]


# -- what does not depend on the policy


@every_engine
@pytest.mark.parametrize("policy", ["simultaneous", SCENE_ORDER, OTHER_ORDER])
def test_contacts_at_right_angles_are_not_coupled(policy: str, engine: str) -> None:
    scene = Scene([C(0, 0, vx=1, vy=1)], [Wall(4, 0, 4, 1), Wall(0, 4, 1, 4)])
    run = play(scene, policy, engine)
    (event,) = run.events
    assert len(event.impulses) == 2
    assert not event.coupled
    assert_ends(run, ["-1", "-1"])


# -- pymunk

SUBJECTS = {subject.scene.name: subject for subject in impulse_policies.subjects()}
OVERLAPPING = ("one onto three that touch", "cradle:r=3/10,gap=0")
"""Scenes in which rounding to doubles makes circles that touch overlap."""


@pytest.mark.parametrize("name", [name for name in SUBJECTS if name not in OVERLAPPING])
def test_pymunk_tends_to_simultaneous_as_its_step_shrinks(name: str) -> None:
    steps = (Fraction(1, 64), Fraction(1, 512), Fraction(1, 4096))
    together, ordered = zip(*(impulse_policies.distances(SUBJECTS[name], step) for step in steps), strict=True)
    assert [d.policy for d in (together[0], ordered[0])] == ["simultaneous", SCENE_ORDER]
    assert together[0].position > 4 * together[1].position > 16 * together[2].position
    assert together[2].velocity < 1e-4
    assert all(d.velocity > 0.2 for d in ordered)


@pytest.mark.parametrize("name", OVERLAPPING)
def test_pymunk_tends_to_no_policy_where_rounding_makes_an_overlap(name: str) -> None:
    for step in (Fraction(1, 256), Fraction(1, 4096)):
        assert all(d.velocity > 0.5 for d in impulse_policies.distances(SUBJECTS[name], step))


def test_the_table_in_the_docs_is_what_the_command_prints(root: Path) -> None:
    """But for the last digits, which may differ from machine to machine."""
    lines = (root / "docs" / "policies.md").read_text("utf-8").splitlines()
    shown = [line for line in lines if any(f" | {step} | " in line for step in impulse_policies.STEPS)]
    assert len(shown) == len(SUBJECTS) * len(impulse_policies.STEPS)
    steps = impulse_policies.STEPS[:2]
    for line in list(impulse_policies.rows(list(SUBJECTS.values()), steps))[2:]:
        cells = line.strip("| ").split(" | ")
        (row,) = [other for other in shown if other.startswith(f"| {cells[0]} | {cells[1]} |")]
        for mine, theirs in zip(cells[2:], row.strip("| ").split(" | ")[2:], strict=True):
            assert math.isclose(float(mine), float(theirs), rel_tol=0.2, abs_tol=1e-6)


# -- names


@pytest.mark.parametrize(
    "name", ["", "fair", "sequential:", "sequential:seed=", "sequential:seed=-1", "sequential:order=last", 7]
)
def test_an_unknown_policy_is_refused(name: Any) -> None:
    with pytest.raises(SceneError, match="choose simultaneous, sequential:order=scene or sequential:seed=N"):
        LEE.with_changes(tie_policy=name)


@pytest.mark.parametrize("name", ["simultaneous", SCENE_ORDER, "sequential:seed=7"])
def test_a_trajectory_names_its_policy(name: str) -> None:
    assert str(play(LEE, name, "exact").scene.tie_policy) == name
    assert TiePolicy.parse(name) == TiePolicy.parse(TiePolicy.parse(name))
