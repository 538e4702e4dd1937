"""An engine of events or of steps, with gravity and moving walls, that breaks one law of which it is known which."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from truebreak.compare.foreign import Recording
from truebreak.compare.foreign.recorded import RecordedEngine
from truebreak.scenarios import Scene

Vector = list[float]

MOST = 40_000
"""Steps of one run."""


@dataclass(frozen=True)
class Faulty(RecordedEngine):
    """Doubles and the textbook's formulas; `fault` names one thing that is otherwise, `size` by how much.

    In steps, velocities fall first, all fly, and what overlaps and comes nearer is pushed.
    """

    fault: str = ""
    size: float = 0.0
    step: float | None = None
    name = "faulty"
    step_microseconds = 20.0
    scene_keys = frozenset({"wall", "gravity", "restitution"})

    def play(self, scene: Scene, recording: Recording) -> None:
        """The whole run, and where all are after each impact."""
        world = World(scene, self.fault, self.size)
        if self.step is not None:
            self._in_steps(world, recording)
            return
        while recording.open and (found := world.next()) is not None:
            wait, i, j = found
            world.fly(wait)
            told = world.meet(i, j)
            if told is not None:
                recording.hit(world.time, world.ids[i], world.ids[j], {world.ids[k]: world.state(k) for k in told})

    def _in_steps(self, world: World, recording: Recording) -> None:
        step = self.step or 1.0
        for done in range(1, MOST):
            if not recording.open:
                return
            world.time = done * step
            world.stride(step)
            hits: list[tuple[str, str]] = []
            moved: set[int] = set()
            for i in range(world.count):
                for j in range(i + 1, world.count + len(world.walls)):
                    gap, speed = world.apart(i, j)
                    if gap < 0 and speed < 0 and (told := world.meet(i, j)) is not None:
                        hits.append((world.ids[i], world.ids[j]))
                        moved |= told
            if hits:
                recording.hits(world.time, hits, {world.ids[k]: world.state(k) for k in moved})
            recording.state(world.time, [world.state(k) for k in range(world.count)])
        recording.spent(f"{MOST:,} steps")


@dataclass
class World:
    """Where all are, and what is wrong with how they are moved."""

    scene: Scene
    fault: str
    size: float
    time: float = 0.0
    events: int = 0
    through: set[tuple[int, int]] = field(default_factory=set[tuple[int, int]])

    def __post_init__(self) -> None:
        scene, fault, size = self.scene, self.fault, self.size
        self.ids = [str(name) for name in scene.ids]
        self.count = len(scene.circles)
        self.p: list[Vector] = [[float(c.x), float(c.y)] for c in scene.circles]
        self.v: list[Vector] = [[float(c.vx), float(c.vy)] for c in scene.circles]
        self.r = [float(c.r) for c in scene.circles]
        self.m = [float(c.m) for c in scene.circles]
        self.e = float(scene.restitution)
        self.pull: Vector = [0.0, 0.0] if scene.gravity is None else [float(part) for part in scene.gravity]
        self.walls: list[tuple[Vector, Vector, Vector]] = []
        for wall in scene.walls:
            nx, ny = (float(n) for n in wall.normal)
            long = math.hypot(nx, ny)
            self.walls.append(
                ([float(wall.x0), float(wall.y0)], [nx / long, ny / long], [float(wall.vx), float(wall.vy)])
            )
        self.sides = [
            [math.copysign(1, n[0] * (x - q[0]) + n[1] * (y - q[1])) for q, n, _ in self.walls] for x, y in self.p
        ]
        if fault == "restitution":
            self.e = size
        elif fault == "mass":
            self.m[0] *= size
        elif fault == "equal masses":
            self.m = [1.0] * self.count
        elif fault == "inverse masses":
            self.m = [1 / m for m in self.m]
        elif fault == "radius":
            self.r[0] += size
        elif fault == "place of a wall" and self.walls:
            q, n, u = self.walls[0]
            self.walls[0] = ([q[0] + size * n[0], q[1] + size * n[1]], n, u)
        elif fault == "gravity":
            self.pull = [self.pull[0], self.pull[1] + size]

    def apart(self, i: int, j: int) -> tuple[float, float]:
        """The gap of two, and how fast it grows."""
        (x, y), (vx, vy) = self.p[i], self.v[i]
        if j >= self.count:
            q, n, u = self.walls[j - self.count]
            side = self.sides[i][j - self.count]
            far = n[0] * (x - q[0] - u[0] * self.time) + n[1] * (y - q[1] - u[1] * self.time)
            return side * far - self.r[i], side * (n[0] * (vx - u[0]) + n[1] * (vy - u[1]))
        dx, dy = self.p[j][0] - x, self.p[j][1] - y
        far = math.hypot(dx, dy)
        return far - self.r[i] - self.r[j], (dx * (self.v[j][0] - vx) + dy * (self.v[j][1] - vy)) / far

    def wait(self, i: int, j: int) -> float:
        """How long until two meet; infinite if they do not."""
        gap, speed = self.apart(i, j)
        if j >= self.count:
            n = self.walls[j - self.count][1]
            half = self.sides[i][j - self.count] * (n[0] * self.pull[0] + n[1] * self.pull[1]) / 2
            gap = max(gap, 0.0)
            if not half:
                return gap / -speed if speed < 0 else math.inf
            root = speed * speed - 4 * half * gap
            if root < 0:
                return math.inf
            if half < 0:
                return (speed + math.sqrt(root)) / (-2 * half) if speed >= 0 else 2 * gap / (math.sqrt(root) - speed)
            return 2 * gap / (math.sqrt(root) - speed) if speed < 0 else math.inf
        dx, dy = (b - a for a, b in zip(self.p[i], self.p[j], strict=True))
        ux, uy = (b - a for a, b in zip(self.v[i], self.v[j], strict=True))
        near, square, reach = dx * ux + dy * uy, ux * ux + uy * uy, self.r[i] + self.r[j]
        root = near * near - square * (dx * dx + dy * dy - reach * reach)
        return max(0.0, (dx * dx + dy * dy - reach * reach) / (math.sqrt(root) - near)) if near < 0 < root else math.inf

    def next(self) -> tuple[float, int, int] | None:
        """The next two to meet, and how long until then."""
        found = [
            (self.wait(i, j), i, j)
            for i in range(self.count)
            for j in range(i + 1, self.count + len(self.walls))
            if (i, j) not in self.through
        ]
        wait, i, j = min(found, default=(math.inf, 0, 0))
        return (wait + (self.size if self.fault == "late" else 0.0), i, j) if wait < math.inf else None

    def fly(self, wait: float) -> None:
        """On their parabolas."""
        self.time += wait
        for p, v in zip(self.p, self.v, strict=True):
            for axis in (0, 1):
                p[axis] += v[axis] * wait + self.pull[axis] * wait * wait / 2
                v[axis] += self.pull[axis] * wait
                if self.fault == "damping":
                    v[axis] *= math.exp(-self.size * wait)

    def stride(self, step: float) -> None:
        """One step: velocities first."""
        for p, v in zip(self.p, self.v, strict=True):
            for axis in (0, 1):
                v[axis] += self.pull[axis] * step
                if self.fault == "damping":
                    v[axis] *= math.exp(-self.size * step)
                p[axis] += v[axis] * step

    def meet(self, i: int, j: int) -> set[int] | None:
        """The impulse of two; whose velocities have changed, or None where it is missed."""
        count, fault, size = self.events, self.fault, self.size
        if (fault == "missed wall" and j == self.count) or (fault == "missed once" and count == int(size)):
            self.through.add((i, j))
            self.events += fault == "missed once"
            return None
        if (i, j) in self.through:
            return None
        self.events += 1
        wall, moved = j >= self.count, {i} if j >= self.count else {i, j}
        others = [[0.0, 0.0], math.inf] if wall else [self.v[j], self.m[j]]
        u: Vector = list(self.walls[j - self.count][2]) if wall else others[0]  # pyright: ignore
        if wall and fault == "speed of walls":
            u = [size * part for part in u]
        wa, wb = 1 / self.m[i], 0.0 if wall else 1 / self.m[j]
        if wall:
            side, n = -self.sides[i][j - self.count], self.walls[j - self.count][1]
            nx, ny = side * n[0], side * n[1]
        else:
            dx, dy = self.p[j][0] - self.p[i][0], self.p[j][1] - self.p[i][1]
            nx, ny = dx / math.hypot(dx, dy), dy / math.hypot(dx, dy)
        if fault == "direction":
            nx, ny = nx * math.cos(size) - ny * math.sin(size), ny * math.cos(size) + nx * math.sin(size)
        rx, ry = u[0] - self.v[i][0], u[1] - self.v[i][1]
        if fault == "swap" and not wall:
            self.v[i], self.v[j] = self.v[j], self.v[i]
            return moved
        if fault == "along velocity" and not wall:
            far = math.hypot(rx, ry)
            nx, ny = -rx / far, -ry / far
        closing, e = nx * rx + ny * ry, self.e
        if (fault == "walls" and wall) or (fault == "circles" and not wall) or (fault == "once" and count == 0):
            e *= size
        if fault == "by speed":
            e /= 1 + size * abs(closing)
        push = (1 + e) * closing / (wa + wb)
        aside = (size - 1) * (nx * ry - ny * rx) / (wa + wb) if fault == "friction" else 0.0
        for k, sign, w in ((i, 1.0, wa), (j, -1.0, wb)):
            if w and not (fault == "one-sided" and k == j):
                self.v[k] = [
                    self.v[k][0] + sign * w * (push * nx + aside * ny),
                    self.v[k][1] + sign * w * (push * ny - aside * nx),
                ]
        for k in moved:
            if fault == "energy":
                self.v[k] = [part * size for part in self.v[k]]
            if fault == "top speed" and (fast := math.hypot(*self.v[k])) > size:
                self.v[k] = [part * size / fast for part in self.v[k]]
        if fault == "apart":
            self.p[i] = [self.p[i][0] - size * nx, self.p[i][1] - size * ny]
        if fault == "bystander" and len(moved) < self.count:
            k = next(k for k in range(self.count) if k not in moved)
            self.v[k] = [part * size for part in self.v[k]]
            moved.add(k)
        return moved

    def state(self, k: int) -> tuple[float, float, float, float]:
        """Place and velocity."""
        return (*self.p[k], *self.v[k])  # pyright: ignore
