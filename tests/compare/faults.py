"""Engines with errors that are made by hand: faults of known kind, event and size in runs of 400 bits; and others.

The engine of `Run` flies straight and bounces elastically in 400 bits, which is as good as exact where no decision is
closer than 2**-60. No formula here is of the code under test.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from mpmath.ctx_mp import MPContext
from other_runs import OnRounded, nearest, rational, rounded_scene
from refuting import FLIGHTS, IMPACTS, INPUT, LAW, MISSED, PHANTOM

from truebreak.compare.foreign import RecordedEngine, Recording
from truebreak.exact import ExactEngine
from truebreak.scenarios import Declared, Scene, Trajectory

HIGH = MPContext()
HIGH.prec = 400

Vector = tuple[Any, Any]


def number(value: Fraction | int | str) -> Any:
    """A number of 400 bits."""
    exact = Fraction(value)
    return HIGH.mpf(exact.numerator) / exact.denominator


def dot(a: Vector, b: Vector) -> Any:
    """The scalar product."""
    return a[0] * b[0] + a[1] * b[1]


# -- faults


@dataclass(frozen=True)
class Rounded:
    """The input is rounded to so many bits."""

    bits: int
    kind: str = INPUT


@dataclass(frozen=True)
class Kick:
    """An impulse is off: after an event, by the run's own count, a circle's velocity is changed by so much."""

    event: int
    who: str
    by: tuple[Fraction, Fraction]
    kind: str = IMPACTS


@dataclass(frozen=True)
class Shift:
    """A flight is off: at an event, before the impulse, a circle is so far from where it flew to."""

    event: int
    who: str
    by: tuple[Fraction, Fraction]
    kind: str = FLIGHTS


@dataclass(frozen=True)
class Skip:
    """A contact is missed: the two fly through each other at what would be this event."""

    event: int
    kind: str = MISSED


@dataclass(frozen=True)
class Invent:
    """A contact that did not take place: right after an event, two exchange an impulse of this strength."""

    event: int
    after: Fraction
    one: str
    other: str
    strength: Fraction
    kind: str = PHANTOM


@dataclass(frozen=True)
class Always:
    """What is wrong in every event: restitution, masses, or places and velocities rounded to so many bits."""

    restitution: Fraction = Fraction(1)
    equal: bool = False
    flights: int | None = None
    impacts: int | None = None
    kind: str = LAW


Fault = Rounded | Kick | Shift | Skip | Invent | Always


@dataclass(frozen=True)
class Meeting:
    """One event of a run: when, who, and every circle after it."""

    time: Any
    pair: tuple[str, str]
    places: tuple[Vector, ...]
    speeds: tuple[Vector, ...]


class Run:
    """A run in 400 bits, with faults."""

    def __init__(self, scene: Scene, faults: Sequence[Fault] = ()) -> None:
        for fault in faults:
            if isinstance(fault, Rounded):
                scene = rounded_scene(scene, fault.bits)
        self.ids = scene.ids
        self.faults = [f for f in faults if not isinstance(f, Rounded)]
        always = [f for f in self.faults if isinstance(f, Always)]
        self.always = always[0] if always else Always()
        exact = [[number(rational(v)) for v in (c.x, c.y, c.vx, c.vy, c.r)] for c in scene.circles]
        self.p: list[Vector] = [(row[0], row[1]) for row in exact]
        self.v: list[Vector] = [(row[2], row[3]) for row in exact]
        self.r = [row[4] for row in exact]
        self.w = [number(rational(c.inverse_mass)) for c in scene.circles]
        if self.always.equal:
            self.w = [number(1) if w else w for w in self.w]
        self.walls: list[tuple[Vector, Vector]] = []
        for wall in scene.walls:
            x0, y0, x1, y1 = (number(rational(v)) for v in (wall.x0, wall.y0, wall.x1, wall.y1))
            length = HIGH.sqrt((x1 - x0) ** 2 + (y1 - y0) ** 2)
            self.walls.append(((x0, y0), ((y0 - y1) / length, (x1 - x0) / length)))
        self.now, self.through, self.skipped = number(0), set[tuple[int, int]](), 0
        self.invented = False
        self.meetings: list[Meeting] = []

    def wait(self, i: int, j: int) -> Any | None:
        """How long until two circles meet in free flight; None if they do not."""
        d = (self.p[j][0] - self.p[i][0], self.p[j][1] - self.p[i][1])
        v = (self.v[j][0] - self.v[i][0], self.v[j][1] - self.v[i][1])
        near, reach = dot(d, v), self.r[i] + self.r[j]
        root = near * near - dot(v, v) * (dot(d, d) - reach * reach)
        if near >= 0 or root <= 0:
            return None
        return (dot(d, d) - reach * reach) / (-near + HIGH.sqrt(root))

    def least(self, one: str, other: str) -> Any:
        """The least gap of two circles in free flight from now on; negative is the depth of a hit."""
        i, j = self.ids.index(one), self.ids.index(other)
        d = (self.p[j][0] - self.p[i][0], self.p[j][1] - self.p[i][1])
        v = (self.v[j][0] - self.v[i][0], self.v[j][1] - self.v[i][1])
        return abs(d[0] * v[1] - d[1] * v[0]) / HIGH.sqrt(dot(v, v)) - self.r[i] - self.r[j]

    def wall(self, i: int, k: int) -> Any | None:
        """How long until a circle meets a wall."""
        (place, normal) = self.walls[k]
        height = dot(normal, (self.p[i][0] - place[0], self.p[i][1] - place[1]))
        speed = dot(normal, self.v[i])
        return (abs(height) - self.r[i]) / abs(speed) if height * speed < 0 else None

    def next(self) -> tuple[Any, int, int] | None:
        """The next meeting: how long until then, and the two."""
        count = len(self.p)
        found: list[tuple[Any, int, int]] = []
        for i in range(count):
            if not self.w[i]:
                continue
            for j in range(count):
                if (j > i or not self.w[j]) and (min(i, j), max(i, j)) not in self.through:
                    wait = self.wait(i, j)
                    if wait is not None:
                        found.append((wait, min(i, j), max(i, j)))
            for k in range(len(self.walls)):
                wait = self.wall(i, k)
                if wait is not None:
                    found.append((wait, i, count + k))
        return min(found, default=None)

    def fly(self, time: Any) -> None:
        """Straight on."""
        self.p = [(p[0] + time * v[0], p[1] + time * v[1]) for p, v in zip(self.p, self.v, strict=True)]
        self.now += time

    def push(self, i: int, j: int, strength: Any | None = None) -> None:
        """The impulse of a contact, or one of a given strength along the line of centres."""
        count, share = len(self.p), 1 + number(self.always.restitution)
        if j >= count:
            normal = self.walls[j - count][1]
            by = share * dot(normal, self.v[i])
            self.v[i] = (self.v[i][0] - by * normal[0], self.v[i][1] - by * normal[1])
            return
        d = (self.p[j][0] - self.p[i][0], self.p[j][1] - self.p[i][1])
        length = HIGH.sqrt(dot(d, d))
        n = (d[0] / length, d[1] / length)
        if strength is None:
            speed = dot(n, (self.v[j][0] - self.v[i][0], self.v[j][1] - self.v[i][1]))
            strength = -share * speed / (self.w[i] + self.w[j])
        for k, sign in ((i, -1), (j, 1)):
            by = sign * strength * self.w[k]
            self.v[k] = (self.v[k][0] + by * n[0], self.v[k][1] + by * n[1])

    def step(self) -> Meeting | None:
        """The next event, with the faults that belong to it."""
        event = len(self.meetings)
        for fault in self.faults:
            if isinstance(fault, Invent) and fault.event == event - 1 and not self.invented:
                self.invented = True
                self.fly(number(fault.after))
                i, j = sorted((self.ids.index(fault.one), self.ids.index(fault.other)))
                self.push(i, j, number(fault.strength))
                return self.keep(i, j)
        found = self.next()
        if found is None:
            return None
        wait, i, j = found
        self.fly(wait)
        for a, b in [*self.through]:
            d = (self.p[b][0] - self.p[a][0], self.p[b][1] - self.p[a][1])
            if HIGH.sqrt(dot(d, d)) > (self.r[a] + self.r[b]) * (1 + number(Fraction(1, 10**6))):
                self.through.discard((a, b))
        if any(isinstance(f, Skip) and f.event == event for f in self.faults) and not self.skipped:
            self.skipped = 1
            self.through.add((i, j))
            return self.step()
        pair = {self.ids[i], self.ids[j]}
        for fault in self.faults:
            if isinstance(fault, Shift) and fault.event == event and fault.who in pair:
                k = self.ids.index(fault.who)
                self.p[k] = (self.p[k][0] + number(fault.by[0]), self.p[k][1] + number(fault.by[1]))
        if self.always.flights is not None:
            self.p = [self.cut(p, self.always.flights) for p in self.p]
        self.push(i, j)
        for fault in self.faults:
            if isinstance(fault, Kick) and fault.event == event and fault.who in pair:
                k = self.ids.index(fault.who)
                self.v[k] = (self.v[k][0] + number(fault.by[0]), self.v[k][1] + number(fault.by[1]))
        if self.always.impacts is not None:
            self.v = [self.cut(v, self.always.impacts) for v in self.v]
        return self.keep(i, j)

    def keep(self, i: int, j: int) -> Meeting:
        """Takes the event down."""
        self.meetings.append(Meeting(self.now, (self.ids[i], self.ids[j]), tuple(self.p), tuple(self.v)))
        return self.meetings[-1]

    def cut(self, vector: Vector, bits: int) -> Vector:
        """Both numbers, rounded to so many bits."""
        x, y = (number(nearest(fraction(v), bits)) for v in vector)
        return x, y

    def upto(self, events: int) -> Run:
        """Goes on until there are so many events, or nothing is left to happen."""
        while len(self.meetings) < events and self.step() is not None:
            pass
        return self


def fraction(value: Any) -> Fraction:
    """What a number of 400 bits is."""
    sign, mantissa, exponent, _ = value._mpf_
    return (-1 if sign else 1) * Fraction(int(mantissa)) * Fraction(2) ** exponent


@dataclass(frozen=True)
class Made(RecordedEngine):
    """The engine of events with faults, which reports doubles."""

    faults: tuple[Fault, ...] = ()
    bits: int = 53
    name = "made"
    scene_keys = frozenset({"wall"})

    @property
    def rounds_input(self) -> bool:
        """Whether one of the faults is that."""
        return any(isinstance(f, Rounded) for f in self.faults)

    def play(self, scene: Scene, recording: Recording) -> None:
        """Reports every event."""
        run = Run(scene, self.faults)
        while recording.open and (met := run.step()) is not None:
            states = {
                run.ids[k]: (*map(float, met.places[k]), *map(float, met.speeds[k]))
                for k in range(len(run.p))
                if run.ids[k] in met.pair and run.w[k]
            }
            recording.hit(float(met.time), *met.pair, states)


@dataclass(frozen=True)
class RoundedExact(Declared):
    """The exact engine on the scene that its bits make of it."""

    bits: int = 53
    name: str = "rounded-exact"
    rounds_input = True

    def run(self, scene: Scene, **limits: Any) -> Trajectory:
        """The certified run of the rounded scene, as one of the scene itself."""
        return replace(OnRounded(self.bits).run(scene, **limits), engine=self.name)


MOST = 200_000
"""Steps of one run of this engine: what loses energy goes slower and slower, and never comes to an end."""


def short(value: float, bits: int) -> float:
    """The nearest number of so many bits."""
    share, exponent = math.frexp(value)
    return math.ldexp(round(share * 2.0**bits), exponent - bits)


@dataclass(frozen=True)
class Steps(RecordedEngine):
    """An engine of steps of its own: all fly, then whatever overlaps and comes nearer is pushed.

    With a number of iterations, each brings half of what is left of an impulse. It may push those that it has hit
    apart, by a share of their overlap or by a length, and round places and speeds after each step. What has come into a
    pocket that captures is pushed no more.
    """

    step: float = 1 / 64
    bits: int = 53
    iterations: int | None = None
    parts: float = 0.0
    apart: float = 0.0
    rounds: bool = False
    name = "steps"
    step_microseconds = 20.0  # what a step costs here: series of finer steps go as far as that allows
    scene_keys = frozenset({"wall", "pocket", "capture"})

    def firmer(self) -> Any:
        """Twice the iterations."""
        return None if self.iterations is None else replace(self, iterations=2 * self.iterations)

    def play(self, scene: Scene, recording: Recording) -> None:
        """Reports where everything is after each step in which something was hit, and what was hit."""
        p = [[row[0], row[1]] for row in recording.rows]
        v = [[row[2], row[3]] for row in recording.rows]
        r, w = [float(c.r) for c in scene.circles], [float(c.inverse_mass) for c in scene.circles]
        walls = []
        for q in scene.walls:
            x0, y0, x1, y1 = (float(n) for n in (q.x0, q.y0, q.x1, q.y1))
            length = math.hypot(x1 - x0, y1 - y0)
            nx, ny = (y0 - y1) / length, (x1 - x0) / length
            walls.append([(x0, y0, *((nx, ny) if nx * (x - x0) + ny * (y - y0) > 0 else (-nx, -ny))) for x, y in p])
        pockets = [tuple(map(float, (q.x, q.y, q.r))) for q in scene.pockets if scene.capture]
        count, done, gone = len(p), 0, set[int]()
        part = 1.0 if self.iterations is None else 1 - 0.5**self.iterations
        while recording.open:
            if done == MOST:
                recording.spent(f"{MOST:,} steps")
                return
            done += 1
            hits: list[tuple[str, str]] = []
            for i in range(count):
                p[i][0] += self.step * v[i][0]
                p[i][1] += self.step * v[i][1]
            gone |= {i for i in range(count) for x, y, q in pockets if math.hypot(p[i][0] - x, p[i][1] - y) < q}
            there = [i for i in range(count) if i not in gone]
            for place, i in enumerate(there):
                for j in there[place + 1 :]:
                    dx, dy = p[j][0] - p[i][0], p[j][1] - p[i][1]
                    near = dx * (v[j][0] - v[i][0]) + dy * (v[j][1] - v[i][1])
                    if dx * dx + dy * dy < (r[i] + r[j]) ** 2 and near < 0:
                        by = 2 * part * near / (dx * dx + dy * dy) / (w[i] + w[j])
                        v[i] = [v[i][0] + w[i] * by * dx, v[i][1] + w[i] * by * dy]
                        v[j] = [v[j][0] - w[j] * by * dx, v[j][1] - w[j] * by * dy]
                        hits.append((scene.ids[i], scene.ids[j]))
                        if self.parts or self.apart:
                            far = math.hypot(dx, dy)
                            by = (self.apart + self.parts * (r[i] + r[j] - far)) / far / (w[i] + w[j])
                            p[i] = [p[i][0] - w[i] * by * dx, p[i][1] - w[i] * by * dy]
                            p[j] = [p[j][0] + w[j] * by * dx, p[j][1] + w[j] * by * dy]
                for k, sides in enumerate(walls):
                    x0, y0, nx, ny = sides[i]
                    speed = nx * v[i][0] + ny * v[i][1]
                    if nx * (p[i][0] - x0) + ny * (p[i][1] - y0) < r[i] and speed < 0:
                        v[i] = [v[i][0] - 2 * part * speed * nx, v[i][1] - 2 * part * speed * ny]
                        hits.append((scene.ids[i], scene.ids[count + k]))
            if self.rounds:
                p = [[short(x, self.bits) for x in row] for row in p]
                v = [[short(x, self.bits) for x in row] for row in v]
            if hits:
                moved = {scene.ids[k]: (*p[k], *v[k]) for k in range(count) if w[k]}
                recording.hits(done * self.step, hits, moved)
            recording.state(done * self.step, [(*x, *u) for x, u in zip(p, v, strict=True)])
            if (
                done % 64 == 0
                and not walls
                and not any(
                    (p[j][0] - p[i][0]) * (v[j][0] - v[i][0]) + (p[j][1] - p[i][1]) * (v[j][1] - v[i][1]) < 0
                    for i in range(count)
                    for j in range(i)
                )
            ):
                return  # all go apart


@dataclass(frozen=True)
class OtherPolicy(Declared):
    """The exact engine, which resolves ties in another way than the scene asks for."""

    policy: str = "sequential:order=scene"
    name: str = "other-policy"
    scene_keys = frozenset({"wall", "pocket", "capture", "reverse_at", "reverse_after"})

    def run(self, scene: Scene, **limits: Any) -> Trajectory:
        """The certified run under the other policy."""
        run = ExactEngine().run(scene.with_changes(tie_policy=self.policy), **limits)
        return replace(run, scene=scene, engine=self.name)
