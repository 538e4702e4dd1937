"""Scenes whose cause is known by how they are made: at least five for each cause."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import pytest

from truebreak.compare import compare
from truebreak.compare.causes.diagnosis import CauseName
from truebreak.compare.causes.rounding import rounded
from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine, IntervalEngine, PymunkEngine
from truebreak.scenarios import Circle, Declared, Scene, Wall, catalogue


def found(scene: Scene, engine: Any, **limits: Any) -> CauseName:
    """The cause of an engine's divergence, or of its stop."""
    candidate = compare(scene, [engine], **limits).candidates[0]
    assert candidate.verdict != "agree", candidate
    assert candidate.diagnosis is not None
    assert candidate.diagnosis.name is not CauseName.UNKNOWN
    assert all(e.result for e in candidate.diagnosis.experiments)
    return candidate.diagnosis.name


def graze(miss: str, x: str = "-5") -> Scene:
    """A circle that passes another by a distance, and then meets a wall."""
    return Scene(
        [Circle(x, f"0.3 + {miss}", vx=1, id="mover"), Circle(0, "2.3", id="target")],
        [Wall(20, 0, 20, 1, id="wall")],
        until=40,
    )


@pytest.mark.parametrize("k", [20, 25, 30, 35, 40])
def test_events_nearer_than_the_scene_s_rounding_are_input(k: int) -> None:
    assert found(catalogue.build(f"near-tie:k={k}"), "double") is CauseName.INPUT


@pytest.mark.parametrize("x", ["-5", "-6", "-7", "-9", "-11"])
def test_a_graze_that_rounding_makes_a_hit_is_input(x: str) -> None:
    assert found(graze("0", x), "double") is CauseName.INPUT


@pytest.mark.parametrize("seed", [1, 2, 3, 4, 5])
def test_a_chaotic_scene_of_doubles_is_arithmetic(seed: int) -> None:
    scene = rounded(catalogue.build(f"gas:n=6,seed={seed}"))
    assert found(scene, "double", events=500) is CauseName.ARITHMETIC


@dataclass(frozen=True)
class Coarse(Declared):
    """The exact engine on a scene rounded by one amount, and then moved by another: both roundings by hand.

    Attributes:
        arithmetic: by how much the mover's height is off beyond the rounding of the scene.
    """

    arithmetic: str
    name: str = "coarse"

    @property
    def bits(self) -> int:
        return 53

    @property
    def rounds_input(self) -> bool:
        return True

    def run(self, scene: Scene, **limits: Any) -> Any:
        given = rounded(scene)
        first, *others = given.circles
        moved = replace_circle(first, y=first.y + self.arithmetic_quantity)
        run = ExactEngine().run(given.with_changes(circles=[moved, *others]), **limits)
        return replace(run, scene=scene, engine=self.name)

    @property
    def arithmetic_quantity(self) -> Any:
        from truebreak.scenarios import Quantity

        return Quantity.of(self.arithmetic)


def replace_circle(circle: Circle, **changes: Any) -> Circle:
    values = {key: getattr(circle, key) for key in ("x", "y", "r", "vx", "vy", "m", "id", "point")}
    return Circle(**{**values, **changes})


@pytest.mark.parametrize("share", ["0.6", "1", "1.2", "1.5", "1.9"])
def test_two_errors_of_which_neither_suffices_are_together(share: str) -> None:
    # The pass is 2**-51 + e wide. Rounding takes e of it, for the nearest double to 1/2 - e is 1/2; the engine then
    # takes 2**-51 + 2**-57, which is less than the whole, and more than what rounding leaves.
    circles = [Circle(-5, f"1/2 - {share} * 2**-56", vx=1, id="mover"), Circle(0, "5/2 + 2**-51", id="target")]
    scene = Scene(circles, [Wall(20, 0, 20, 1, id="wall")], until=40)
    assert found(scene, Coarse("2**-51 + 2**-57")) is CauseName.TOGETHER


@pytest.mark.parametrize("seed", [1, 2, 3, 4, 5])
def test_a_coarse_step_is_the_step(seed: int) -> None:
    scene = catalogue.build(f"gas:n=5,seed={seed}")
    assert found(scene, "pymunk:dt=1/64", events=40) is CauseName.STEP


@pytest.mark.parametrize("k", [2, 3, 4, 5, 6])
def test_events_within_one_step_are_the_step(k: int) -> None:
    assert found(catalogue.build(f"near-tie:k={k}"), f"pymunk:dt=1/{4 * 8 ** (k - 1)}") is CauseName.STEP


@pytest.mark.parametrize("place", ["10.0625", "20.0625", "30.0625", "50.0625", "100.0625"])
def test_a_bullet_through_a_small_target_is_tunnelling(place: str) -> None:
    circles = [Circle(0, 0, "1/1000", vx=10, id="bullet"), Circle(place, 0, "1/1000", id="target")]
    assert found(Scene(circles), "pymunk:dt=1/64", until=20) is CauseName.TUNNELLING


@pytest.mark.parametrize(
    "text",
    ["rack:rows=3", "lee:tie=sequential:order=scene", "tied-3", "tied-5", "tied-7"],
)
def test_a_tie_taken_otherwise_is_a_tie(text: str) -> None:
    if text.startswith("tied"):
        shift = f"0.{text[-1]}"
        circles = [
            Circle(f"-3 - {shift}", 0, vx=1),
            Circle(0, 0),
            Circle(f"4 + {shift}", 0, 2, vx=-1, m=4),
        ]
        assert found(Scene(circles), Reordered()) is CauseName.TIE
        return
    engine: Any = "double" if text.startswith("rack") else "pymunk"
    assert found(catalogue.build(text), engine, events=6) is CauseName.TIE


class Reordered(DoubleEngine):
    """Doubles that take a tie one contact after the other, the last one first."""

    def run(self, scene: Scene, **limits: Any) -> Any:
        run = super().run(scene.with_changes(tie_policy="sequential:order=scene"), **limits)
        return replace(run, scene=scene)


ONTO_TWO = {
    "equal": ("1", "1"),
    "heavy": ("3", "1"),
    "light": ("1/2", "1"),
    "onto heavier ones": ("1", "2"),
    "onto lighter ones": ("1", "1/2"),
}


@pytest.mark.parametrize("name", ONTO_TWO)
def test_a_solver_that_is_stopped_early_is_its_iterations(name: str) -> None:
    mass, other = ONTO_TWO[name]
    scene = Scene([Circle(-4, 0, vx=1, m=mass), Circle("sqrt(3)", 1, m=other), Circle("sqrt(3)", -1, m=other)])
    assert compare(scene, ["pymunk"], until=5).verdict == "agree"
    assert found(scene, "pymunk:iterations=1", until=5) is CauseName.ITERATIONS


@pytest.mark.parametrize("text", ["cradle", "gas", "gas:seed=2", "near-tie:k=20", "near-tie:k=40"])
def test_intervals_that_more_bits_decide_are_too_wide(text: str) -> None:
    assert found(catalogue.build(text), "interval", events=60) is CauseName.WIDTH


@pytest.mark.parametrize("x", ["-5", "-6", "-7", "-9", "-11"])
def test_no_width_tells_a_graze(x: str) -> None:
    assert found(graze("0", x), IntervalEngine()) is CauseName.ZERO


@dataclass(frozen=True)
class Heavy(Declared):
    """Doubles that take the first circle for three times as heavy: another law."""

    name: str = "heavy"

    @property
    def bits(self) -> int:
        return 53

    def run(self, scene: Scene, **limits: Any) -> Any:
        circles = [replace_circle(c, m=c.m * 3) if k == 0 else c for k, c in enumerate(scene.circles)]
        return replace(DoubleEngine().run(scene.with_changes(circles=circles), **limits), scene=scene)


@pytest.mark.parametrize("seed", [1, 2, 3, 4, 5])
def test_another_law_is_the_model(seed: int) -> None:
    assert found(catalogue.build(f"gas:n=5,seed={seed}"), Heavy(), events=40) is CauseName.MODEL


@dataclass(frozen=True)
class Blind(Heavy):
    """Doubles that report nothing."""

    def run(self, scene: Scene, **limits: Any) -> Any:
        return replace(DoubleEngine().run(scene, **limits), events=())


@pytest.mark.parametrize("seed", [1, 2, 3, 4, 5])
def test_a_meeting_that_is_not_told_is_the_model(seed: int) -> None:
    assert found(catalogue.build(f"gas:n=4,seed={seed}"), Blind(), events=5) is CauseName.MODEL


@pytest.mark.parametrize("steps", [10, 20, 30, 40, 50])
def test_a_spent_budget_is_the_budget(steps: int) -> None:
    assert found(catalogue.build("cradle"), PymunkEngine(max_steps=steps)) is CauseName.BUDGET


@pytest.mark.parametrize("name", ["pymunk", "sympy", "pymunk:dt=1/8", "pymunk:iterations=3", "pymunk:dt=1/1024"])
def test_a_scene_that_an_engine_cannot_take_is_said_so(name: str) -> None:
    scene = catalogue.build("rack:rows=2").with_changes(capture=True, events=3)
    assert found(scene, name) is CauseName.UNABLE
