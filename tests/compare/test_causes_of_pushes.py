"""Causes of engines of steps that differ in when they push, move and add g dt: each does what its account says."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import pytest

from truebreak.compare.causes.diagnosis import CauseName
from truebreak.compare.comparison import compare
from truebreak.compare.foreign import RecordedEngine
from truebreak.scenarios import catalogue
from truebreak.scenarios.scene import Scene
from truebreak.scenarios.things import Circle, Wall

ORDERS = (
    "moves, gains, pushes",
    "gains, moves, pushes",
    "falls, pushes",
    "gains, pushes, moves",
    "stops, moves, bounces",
)


@dataclass(frozen=True)
class Engine(RecordedEngine):
    """Exact impulses in doubles, in one of the orders; perhaps circles are pushed out of walls that they are in."""

    step: float = 1 / 128
    order: str = ORDERS[0]
    pushes_out: bool = False
    name = "orders"
    scene_keys = frozenset({"wall", "gravity", "restitution"})

    def finer(self) -> None:
        """A log has no finer step: the account has to tell alone."""

    def play(self, scene: Scene, recording: Any) -> None:
        dt, e = self.step, float(scene.restitution)
        gx, gy = (0.0, 0.0) if scene.gravity is None else map(float, scene.gravity)
        x = [complex(*row[:2]) for row in recording.rows]
        v = [complex(*row[2:4]) for row in recording.rows]
        gain, half = complex(gx, gy) * dt, complex(gx, gy) * dt * dt / 2
        steps = 0
        while recording.open:
            steps += 1
            if self.order == "moves, gains, pushes":
                x, v = [a + b * dt for a, b in zip(x, v, strict=True)], [b + gain for b in v]
            elif self.order == "gains, moves, pushes":
                v = [b + gain for b in v]
                x = [a + b * dt for a, b in zip(x, v, strict=True)]
            elif self.order == "falls, pushes":
                x, v = [a + b * dt + half for a, b in zip(x, v, strict=True)], [b + gain for b in v]
            else:
                v = [b + gain for b in v]
            came = list(v)
            self._push(scene, x, v, e)
            if self.order == "gains, pushes, moves":
                x = [a + b * dt for a, b in zip(x, v, strict=True)]
            elif self.order == "stops, moves, bounces":
                x = [a + (b + (c - b) / (1 + e)) * dt for a, b, c in zip(x, came, v, strict=True)]
            recording.state(steps * dt, [(a.real, a.imag, b.real, b.imag) for a, b in zip(x, v, strict=True)])

    def _push(self, scene: Scene, x: list[complex], v: list[complex], e: float) -> None:
        r, w = [float(c.r) for c in scene.circles], [1 / float(c.m) for c in scene.circles]
        for i in range(len(x)):
            for j in range(i + 1, len(x)):
                apart = x[j] - x[i]
                n = apart / abs(apart)
                speed = ((v[j] - v[i]) * n.conjugate()).real
                if abs(apart) < r[i] + r[j] and speed < 0:
                    push = (1 + e) * speed / (w[i] + w[j]) * n
                    v[i], v[j] = v[i] + w[i] * push, v[j] - w[j] * push
            for wall in scene.walls:
                along = complex(float(wall.x1) - float(wall.x0), float(wall.y1) - float(wall.y0))
                n = 1j * along / abs(along)
                height = ((x[i] - complex(float(wall.x0), float(wall.y0))) * n.conjugate()).real
                n, height = (n, height) if height > 0 else (-n, -height)
                speed = (v[i] * n.conjugate()).real
                if height < r[i] and speed < 0:
                    v[i] -= (1 + e) * speed * n
                    x[i] += (r[i] - height) * n if self.pushes_out else 0


SIDES = {"floor": (0, 0, 1, 0), "left": (0, 0, 0, 1), "right": (8, 0, 8, 1), "top": (0, 8, 1, 8)}
BOX = [Wall(*line, id=name) for name, line in SIDES.items()]
THREE = [
    Circle(2, "9/4", "1/2", vx="7/4", vy="-1/2", id="a"),
    Circle("11/2", 3, "3/4", vx=-1, vy="5/8", m=2, id="b"),
    Circle(4, "25/4", "5/8", vx="3/8", vy=-1, m="1/2", id="c"),
]


def account(order: str, gravity: Any = None, restitution: Any = 1, **how: Any) -> dict[CauseName, float]:
    """What each kind of error adds to the margin of a first divergence, at the first step that tells them apart."""
    scene = Scene(THREE, BOX, gravity=gravity, restitution=restitution)
    for step in (1 / 64, 1 / 128, 1 / 256):
        (found,) = compare(scene, [Engine(step, order, **how)], until=30).candidates
        assert found.verdict == "diverged" and found.diagnosis is not None and not found.lawless
        told = {e.cause: e.displacement for e in found.diagnosis.experiments if e.displacement is not None}
        if CauseName["LATENESS"] in told:
            return told
        assert "cannot be distinguished" in str(found.diagnosis.experiments[-1].result)
    raise AssertionError("no step tells them apart")


def faint(told: dict[CauseName, float], kind: str) -> bool:
    """Whether there is no more of a kind than rounding makes."""
    return abs(told.get(CauseName[kind], 0.0)) < 1e-9 * max(map(abs, told.values()))


def test_whether_it_pushes_after_it_moves_or_before_is_the_same_motion_with_the_same_causes() -> None:
    """Without gravity one is the other, told a step later; what is told a step later is no correction of places."""
    one, other = (account(order) for order in ("moves, gains, pushes", "gains, pushes, moves"))
    for kind in ("LATENESS", "OVERLAP"):
        assert math.isclose(one[CauseName[kind]], other[CauseName[kind]], rel_tol=1e-6)
    assert faint(other, "CORRECTION") and faint(other, "SOLVER")


@pytest.mark.parametrize("restitution", [1, "9/10"])
@pytest.mark.parametrize("gravity", [None, (0, -1), ("1/4", -1)], ids=["straight", "down", "aslant"])
@pytest.mark.parametrize("order", ORDERS)
def test_nothing_is_named_that_the_engine_does_not_do(order: str, gravity: Any, restitution: Any) -> None:
    told = account(order, gravity, restitution)
    assert faint(told, "CORRECTION") and faint(told, "SOLVER"), told
    assert not faint(told, "LATENESS")
    if gravity is None or order == "falls, pushes":
        assert faint(told, "INTEGRATOR")
    else:
        assert not faint(told, "INTEGRATOR")


@pytest.mark.parametrize("gravity", [None, (0, -1)], ids=["straight", "down"])
@pytest.mark.parametrize("order", ORDERS[:3])
def test_a_correction_of_places_is_named_as_ever(order: str, gravity: Any) -> None:
    assert not faint(account(order, gravity, pushes_out=True), "CORRECTION")


def test_what_the_exact_motion_comes_to_later_is_sooner_by_all_that_adds_up() -> None:
    """It flies to that wall too, a tenth as fast: no answer differs from what its flights lead to."""
    four = [
        Circle("343/64", "433/64", "19/32", vx="3/8", vy="-31/16", m="31/32", id="a"),
        Circle("131/64", "155/32", "21/32", vx="119/64", vy="-3/64", m="51/32", id="b"),
        Circle("181/32", "35/8", "1/2", vx="-91/64", vy="103/64", m="3/4", id="c"),
        Circle("329/64", "117/64", "11/16", vx="39/32", vy="3/2", m="75/64", id="d"),
    ]
    (found,) = compare(Scene(four, BOX, restitution="9/10"), [Engine(1 / 64)], until=10).candidates
    assert found.diagnosis is not None and found.margin is not None and found.margin.speed is not None
    assert found.diagnosis.causes == (CauseName["STEPS"],)
    assert "decide as the exact ones do" not in str(found.diagnosis.experiments)
    assert math.isclose(math.fsum(row.share or 0.0 for row in found.diagnosis.shares), 1.0, abs_tol=1e-9)


def test_what_parts_again_by_the_end_of_a_step_passes_through() -> None:
    """The ball is in the paddle at the end of a step, but beyond its middle, where nothing pushes it back."""
    (found,) = compare(catalogue.build("breakout"), ["pymunk:dt=1/8"], events=5).candidates
    assert found.diagnosis is not None and found.diagnosis.name is CauseName["TUNNELLING"]
    assert "they part again: one passes through the other" in str(found.diagnosis.experiments)
