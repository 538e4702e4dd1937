"""An engine of events in doubles, for any scene of circles and walls, that breaks a law where it is asked to."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from math import hypot, inf, sqrt

from truebreak.compare.foreign import RecordedEngine, Recording
from truebreak.scenarios import Scene


def dot(a: complex, b: complex) -> float:
    return a.real * b.real + a.imag * b.imag


def wait(d: complex, v: complex, reach: float) -> float:
    """How long until two circles meet that are `d` apart and move by `v` against each other."""
    near, speed = dot(d, v), dot(v, v)
    root = near * near - speed * (dot(d, d) - reach * reach)
    return max(0.0, (-near - sqrt(root)) / speed) if near < 0 <= root else inf


@dataclass(frozen=True)
class Events(RecordedEngine):
    """Restitution is a share of the normal speed; `equal` takes all masses for one; `states` are reported, or not."""

    restitution: float = 1.0
    equal: bool = False
    states: bool = True
    name = "events"
    scene_keys = frozenset({"wall"})

    def play(self, scene: Scene, recording: Recording) -> None:
        rows = recording.rows
        p, v = [complex(*row[:2]) for row in rows], [complex(*row[2:4]) for row in rows]
        r = [float(c.r) for c in scene.circles]
        w = [1.0 if self.equal and not c.fixed else float(c.inverse_mass) for c in scene.circles]
        walls = [(complex(float(q.x0), float(q.y0)), complex(float(q.x1), float(q.y1))) for q in scene.walls]
        normals = [1j * (b - a) / hypot((b - a).real, (b - a).imag) for a, b in walls]
        now, count = 0.0, len(p)
        while recording.open:
            best, who = inf, (0, 0)
            for i, j in combinations(range(count), 2):
                best, who = min((best, who), (wait(p[j] - p[i], v[j] - v[i], r[i] + r[j]), (i, j)))
            for k, normal in enumerate(normals):
                for i in range(count):
                    height, speed = dot(normal, p[i] - walls[k][0]), dot(normal, v[i])
                    if height * speed < 0:
                        best, who = min((best, who), (max(0.0, (abs(height) - r[i]) / abs(speed)), (i, count + k)))
            if best == inf:
                return
            now, p = now + best, [x + best * u for x, u in zip(p, v, strict=True)]
            self.push(who, p, v, w, normals)
            i, j = who
            told = {scene.ids[k]: (p[k].real, p[k].imag, v[k].real, v[k].imag) for k in who if k < count and w[k]}
            recording.hit(now, scene.ids[i], scene.ids[j], told if self.states else None)

    def push(
        self, who: tuple[int, int], p: list[complex], v: list[complex], w: list[float], normals: list[complex]
    ) -> None:
        """One impulse."""
        i, j = who
        strength = 1 + self.restitution
        if j >= len(p):
            normal = normals[j - len(p)]
            v[i] -= strength * dot(normal, v[i]) * normal
            return
        d = p[j] - p[i]
        push = strength * dot(d, v[j] - v[i]) / dot(d, d) / (w[i] + w[j]) * d
        v[i], v[j] = v[i] + w[i] * push, v[j] - w[j] * push
