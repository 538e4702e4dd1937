"""Engines of events and of steps with the usual formulas, written for these tests, in which faults can be planted."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from truebreak.compare.foreign import Recording
from truebreak.compare.foreign.recorded import RecordedEngine
from truebreak.scenarios import Scene

FAULTS: dict[str, dict[str, Any]] = {
    "restitution 0.98": {"e": 0.98},
    "restitution 0.999": {"e": 0.999},
    "restitution 1 - 1e-12": {"e": 1 - 1e-12},
    "walls give 3 % less": {"walls": 0.94},
    "masses equal": {"masses": "equal"},
    "one mass 1 % more": {"masses": (0, 1.01)},
    "one mass 1e-10 more": {"masses": (0, 1 + 1e-10)},
    "one radius 1e-9 more": {"radius": (0, 1e-9)},
    "speeds decay": {"damping": 1e-9},
    "one impact weak": {"once": (7, 0.9)},
    "friction": {"slide": 1 - 1e-6},
    "pushed apart": {"nudge": 1e-12},
    "gravity": {"pull": -1e-10},
    "one contact missed": {"missed": 3},
}
"""Each changes some step by more than its rounding."""


class Planted(RecordedEngine):
    """Doubles, the textbook's quadratic formula, all circles flown on at every event, states at every hit."""

    name = "planted"

    def __init__(self, **fault: Any) -> None:
        told: dict[str, Any] = {"e": 1.0, "walls": None, "masses": None, "radius": None, "damping": 0.0, "once": None}
        told |= {"slide": 1.0, "nudge": 0.0, "missed": None, "pull": 0.0}
        self.__dict__.update(told | fault)
        self.fault = told | fault

    def play(self, scene: Scene, recording: Recording) -> None:
        """The whole run."""
        world = _World(scene, self.fault)
        count = 0
        while recording.open:
            found = world.next()
            if found is None:
                return
            wait, i, j = found
            world.fly(wait)
            hit = world.bounce(i, j, count)
            if hit:
                recording.hit(world.time, *world.names(i, j), world.states(i, j))
            count += 1


class _World:
    def __init__(self, scene: Scene, fault: dict[str, Any]) -> None:
        self.fault, self.ids, self.time = fault, [str(c.id) for c in scene.circles], 0.0
        self.x = [[float(c.x), float(c.y)] for c in scene.circles]
        self.v = [[float(c.vx), float(c.vy)] for c in scene.circles]
        self.r = [float(c.r) for c in scene.circles]
        self.w = [float(c.inverse_mass) for c in scene.circles]
        if fault["radius"] is not None:
            self.r[fault["radius"][0]] += fault["radius"][1]
        if fault["masses"] == "equal":
            self.w = [1.0 if weight else 0.0 for weight in self.w]
        elif fault["masses"] is not None:
            self.w[fault["masses"][0]] /= fault["masses"][1]
        self.walls: list[tuple[float, float, float, float, str]] = []
        for wall in scene.walls:
            nx, ny = (float(n) for n in wall.normal)
            size = math.hypot(nx, ny)
            self.walls.append((float(wall.x0), float(wall.y0), nx / size, ny / size, str(wall.id)))
        self.sides = [
            [1 if nx * (x - x0) + ny * (y - y0) > 0 else -1 for x0, y0, nx, ny, _ in self.walls] for x, y in self.x
        ]
        self.passed: set[tuple[int, int]] = set()

    def next(self) -> tuple[float, int, int] | None:
        best: tuple[float, int, int] | None = None
        n = len(self.x)
        for i in range(n):
            for j in [*range(i + 1, n), *range(n, n + len(self.walls))]:
                wait = self.wait(i, j)
                if wait is not None and (i, j) not in self.passed and (best is None or wait < best[0]):
                    best = wait, i, j
        return best

    def wait(self, i: int, j: int) -> float | None:
        (x, y), (vx, vy), n = self.x[i], self.v[i], len(self.x)
        if j >= n:
            x0, y0, nx, ny, _ = self.walls[j - n]
            side = self.sides[i][j - n]
            gap, closing = side * (nx * (x - x0) + ny * (y - y0)) - self.r[i], -side * (nx * vx + ny * vy)
            return max(gap, 0.0) / closing if closing > 0 and self.w[i] else None
        dx, dy, ux, uy = self.x[j][0] - x, self.x[j][1] - y, self.v[j][0] - vx, self.v[j][1] - vy
        b, a, c = dx * ux + dy * uy, ux * ux + uy * uy, dx * dx + dy * dy - (self.r[i] + self.r[j]) ** 2
        root = b * b - a * c
        return max(0.0, (-b - math.sqrt(root)) / a) if b < 0 and root > 0 else None

    def fly(self, wait: float) -> None:
        self.time += wait
        for place, speed in zip(self.x, self.v, strict=True):
            place[0] += speed[0] * wait
            place[1] += speed[1] * wait + self.fault["pull"] * wait * wait / 2
            decay = math.exp(-self.fault["damping"] * wait)
            speed[0], speed[1] = speed[0] * decay, (speed[1] + self.fault["pull"] * wait) * decay

    def bounce(self, i: int, j: int, count: int) -> bool:
        e, n, v, w = self.fault["e"], len(self.x), self.v, self.w
        if self.fault["once"] is not None:
            e = self.fault["once"][1] if count == self.fault["once"][0] else 1.0
        if self.fault["missed"] is not None and count >= self.fault["missed"] and not self.passed:
            self.passed.add((i, j))
            return False
        if j >= n:
            _, _, nx, ny, _ = self.walls[j - n]
            e = e if self.fault["walls"] is None else self.fault["walls"]
            push = (1 + e) * (nx * v[i][0] + ny * v[i][1])
            v[i][0], v[i][1] = v[i][0] - push * nx, v[i][1] - push * ny
            return True
        dx, dy = self.x[j][0] - self.x[i][0], self.x[j][1] - self.x[i][1]
        nx, ny = dx / math.hypot(dx, dy), dy / math.hypot(dx, dy)
        ux, uy = v[j][0] - v[i][0], v[j][1] - v[i][1]
        push = (1 + e) * (nx * ux + ny * uy) / (w[i] + w[j])
        drag = (1 - self.fault["slide"]) * (nx * uy - ny * ux) / (w[i] + w[j])
        for k, sign in ((i, 1.0), (j, -1.0)):
            v[k][0] += sign * w[k] * (push * nx - drag * ny)
            v[k][1] += sign * w[k] * (push * ny + drag * nx)
        self.x[j][0] += self.fault["nudge"] * nx
        self.x[j][1] += self.fault["nudge"] * ny
        return True

    def names(self, i: int, j: int) -> tuple[str, str]:
        return self.ids[i], self.walls[j - len(self.x)][4] if j >= len(self.x) else self.ids[j]

    def states(self, i: int, j: int) -> dict[str, tuple[float, float, float, float]]:
        return {self.ids[k]: (*self.x[k], *self.v[k]) for k in (i, j) if k < len(self.x)}  # pyright: ignore


@dataclass(frozen=True)
class PlantedSteps(RecordedEngine):
    """Steps, g dt before each, states after each; it pushes at its end what overlaps and comes nearer.

    Attributes:
        blind: a wall that it does not see; discs that it does not see either, for "discs".
        strong: a wall, and how many times too strong its impulses are.
    """

    step: float = 1 / 64
    blind: str = ""
    strong: tuple[str, float] = ("", 1.0)
    name, scene_keys = "planted-steps", frozenset({"wall", "gravity"})

    def play(self, scene: Scene, recording: Recording) -> None:
        """The whole run."""
        world, count = _World(scene, Planted().fault), 0
        pull = float(scene.gravity[1]) if scene.gravity else 0.0
        n, bodies = len(world.x), [*world.ids, *(wall[4] for wall in world.walls)]
        pairs = [(i, j) for i in range(n) for j in range(i + 1, n + len(world.walls))]
        while recording.open:
            count += 1
            for (x, y), v, k in zip(list(map(tuple, world.x)), world.v, range(n), strict=True):
                v[1] += pull * self.step
                world.x[k] = [x + v[0] * self.step, y + v[1] * self.step]
            hits: list[tuple[str, str]] = []
            for i, j in pairs:
                if self.blind == ("discs" if j < n else bodies[j]) or world.wait(i, j) != 0.0:
                    continue
                before = world.v[i][:]
                world.bounce(i, j, 0)
                if bodies[j] == self.strong[0]:
                    world.v[i] = [u + self.strong[1] * (v - u) for u, v in zip(before, world.v[i], strict=True)]
                hits.append((bodies[i], bodies[j]))
            time, rows = count * self.step, [(*world.x[k], *world.v[k]) for k in range(n)]
            if hits:
                moved = {name for pair in hits for name in pair}
                recording.hits(time, hits, {name: rows[k] for k, name in enumerate(world.ids) if name in moved})
            recording.state(time, rows)
