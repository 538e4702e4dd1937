"""An engine of events that swaps velocities along the line of centres, as if all masses were alike."""

from itertools import combinations
from math import inf, sqrt

from truebreak.compare.foreign import RecordedEngine


def dot(a, b):
    return a.real * b.real + a.imag * b.imag


class Pool(RecordedEngine):
    name, scene_keys = "pool", frozenset()
    minds_masses = False

    def play(self, scene, recording):
        p, v = ([complex(*row[k : k + 2]) for row in recording.rows] for k in (0, 2))
        reach, now = [float(c.r) for c in scene.circles], 0.0
        w = [float(c.inverse_mass) if self.minds_masses else 1.0 for c in scene.circles]
        while recording.open:
            dt, i, j = min((self.wait(p, v, reach, i, j), i, j) for i, j in combinations(range(len(p)), 2))
            if dt == inf:
                return
            p, now = [x + dt * u for x, u in zip(p, v, strict=True)], now + dt
            d = p[j] - p[i]
            push = 2 * dot(d, v[j] - v[i]) / dot(d, d) / (w[i] + w[j]) * d
            v[i], v[j] = v[i] + w[i] * push, v[j] - w[j] * push
            states = {scene.ids[k]: (p[k].real, p[k].imag, v[k].real, v[k].imag) for k in (i, j)}
            recording.hit(now, scene.ids[i], scene.ids[j], states)

    def wait(self, p, v, reach, i, j):
        d, u, r = p[j] - p[i], v[j] - v[i], reach[i] + reach[j]
        root = dot(d, u) ** 2 - dot(u, u) * (dot(d, d) - r * r)
        return (-dot(d, u) - sqrt(root)) / dot(u, u) if dot(d, u) < 0 <= root else inf


class Mended(Pool):
    name = "mended"
    minds_masses = True
