"""Worlds of several engines, each with a fault that can be put into it: what `truebreak diff` is tried on, and what a
trial is (`python docs/studies/desync/trials_page.py`)."""

from __future__ import annotations

import json
import math
import random
import shutil
import struct
import subprocess
import tempfile
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import truebreak.compare.logdiff
from truebreak.compare.adapters.adapter import package
from truebreak.compare.logdiff.verdict import Finding

Lines = list[dict[str, Any]]
"""A log, line by line."""

HEADER = Path(truebreak.compare.logdiff.__path__[0]) / "truebreak_log.h"
"""The C header that engines in C write logs with."""


@dataclass(frozen=True)
class Trial:
    """One pair of logs.

    Attributes:
        world: the engine and what it plays.
        what: what came between them, for a person.
        true: what may be said of that; "not determined" is never wrong.
        make: gives both logs: lines, or text.
        at: the event from which on the runs differ, where that is known.
        suffix: of their files' names.
    """

    world: str
    what: str
    true: frozenset[Finding]
    make: Callable[[], tuple[Lines | str, Lines | str]]
    at: int | None = None
    suffix: str = ".jsonl"


Rows = dict[str, list[float]]
"""States by body: place, turn and velocities, as the engine has them."""


@dataclass(frozen=True)
class Fault:
    """What one of two runs has that the other has not.

    Attributes:
        kind: `ulp`, `moved`, `order`, `dt`, `contact`, `warm`, `input`, `mass`, `garbage`, `nan`, `gravity`, `threads`.
        at: the step at which it comes; 0 is the start.
        body: whose.
        size: how much, where that has a meaning.
    """

    kind: str = "none"
    at: int = 0
    body: int = 0
    size: float = 0.0


NONE = Fault()


@dataclass
class Steps:
    """One run: a record for each step, the start among them."""

    fields: list[str]
    dt: float
    records: list[dict[str, Any]] = field(default_factory=list)
    hit: int | None = None
    """The step at which the fault had something to change."""


def next_single(x: float) -> float:
    """The next number of 24 bits above.

    >>> next_single(1.0)
    1.0000001192092896
    """
    (bits,) = struct.unpack("<i", struct.pack("<f", x))
    return struct.unpack("<f", struct.pack("<i", bits + 1))[0]


def layout(seed: int, count: int, kind: str) -> list[tuple[float, float, float, float]]:
    """Places and velocities of bodies of size about 1, none of which overlap."""
    rng = random.Random(seed)
    wide = max(3, int(math.sqrt(count)) + (2 if kind == "gas" else 0))
    found: list[tuple[float, float, float, float]] = []
    for k in range(count):
        x = 2.6 * (k % wide) + rng.uniform(-0.25, 0.25) + 2.0
        y = 2.6 * (k // wide) + rng.uniform(-0.25, 0.25) + 2.0
        speed = 6.0 if kind == "gas" else 0.5
        found.append((x, y, rng.uniform(-speed, speed), rng.uniform(-speed, speed)))
    return found


class World:
    """What the trials ask of an engine. Step 0 is the start; a fault at step k changes the step that leads to k."""

    fields: list[str]
    single = False

    def __init__(self, seed: int, count: int, kind: str, fault: Fault, dt: float) -> None:
        self.kind, self.fault, self.dt = kind, fault, dt * (fault.size if fault.kind == "dt" else 1)
        rows = layout(seed, count, kind)
        if fault.kind in ("ulp", "moved") and fault.at == 0:
            x, y, vx, vy = rows[fault.body]
            if self.single:
                x = struct.unpack("<f", struct.pack("<f", x))[0]
            moved = next_single(x) if self.single else math.nextafter(x, math.inf)
            rows[fault.body] = (moved if fault.kind == "ulp" else x + fault.size, y, vx, vy)
        order = list(range(count))
        if fault.kind == "order":
            random.Random(seed + 1).shuffle(order)
        self.gravity = (0.0, 0.0 if kind == "gas" else -9.81 * (1 + (fault.size if fault.kind == "gravity" else 0)))
        self.bodies: dict[str, Any] = {}
        self.size = 2.6 * max(3, int(math.sqrt(count)) + (2 if kind == "gas" else 0)) + 2.0
        self.ids = [f"b{k}" for k in range(count)]
        self.open()
        for k in order:
            mass = 1.0 + 0.25 * (k % 3)
            if fault.kind == "mass" and fault.at == 0 and k == fault.body:
                mass *= 1 + fault.size
            self.add(f"b{k}", rows[k], mass, box=kind != "gas" and k % 2 == 1)
        self.close()
        self.block = False

    def open(self) -> None: ...

    def close(self) -> None: ...

    def add(self, name: str, row: tuple[float, float, float, float], mass: float, box: bool) -> None:
        raise NotImplementedError

    def step(self) -> list[tuple[str, str]]:
        """One step; whom it gave an impulse."""
        raise NotImplementedError

    def states(self) -> Rows:
        """Of every body that moves."""
        raise NotImplementedError

    def push(self, name: str, dvx: float, dvy: float) -> None:
        """Changes a velocity."""
        raise NotImplementedError

    def forget(self) -> None:
        """Forgets what the solver keeps from step to step."""

    def weigh(self, name: str, factor: float) -> None:
        """Changes a mass."""

    def garbage(self, name: str, value: float) -> None:
        """Writes nonsense over a velocity."""
        self.push(name, value, 0.0)


def run(make: Callable[..., World], seed: int, count: int, kind: str, steps: int, fault: Fault, dt: float = 1 / 60,
        inputs: bool = False) -> Steps:  # fmt: skip
    """One run of a world with a fault."""
    world = make(seed, count, kind, fault, dt)
    told = Steps(world.fields, world.dt)
    told.records.append({"step": 0, "time": 0.0, "contacts": [], "states": world.states()})
    rng = random.Random(seed + 7)
    for k in range(1, steps + 1):
        given: Any = None
        if inputs and k % 20 == 5:
            given = {"body": f"b{rng.randrange(count)}", "push": [rng.uniform(-2, 2), rng.uniform(1, 3)]}
            if fault.kind == "input" and told.hit is None and k >= fault.at:
                told.hit, given = k, None
            else:
                world.push(given["body"], *given["push"])
        if k == fault.at:
            name = f"b{fault.body}"
            if fault.kind == "warm":
                world.forget()
            elif fault.kind == "mass":
                world.weigh(name, 1 + fault.size)
            elif fault.kind in ("garbage", "nan"):
                world.garbage(name, math.nan if fault.kind == "nan" else fault.size)
            elif fault.kind == "push":
                world.push(name, fault.size, 0.0)
        world.block = fault.kind == "contact" and k >= fault.at and told.hit is None
        pairs = world.step()
        if fault.kind == "contact" and world.block is None:
            told.hit = k
        record: dict[str, Any] = {"step": k, "time": k * world.dt}
        if given is not None:
            record["input"] = given
        told.records.append({**record, "contacts": [list(p) for p in pairs], "states": world.states()})
    return told


class PymunkWorld(World):
    """Chipmunk, in doubles."""

    fields = ["x", "y", "angle", "vx", "vy", "spin"]  # noqa: RUF012
    block: bool | None

    def open(self) -> None:
        import pymunk

        self.pymunk: Any = pymunk
        threads = 2 if self.fault.kind == "threads" else 1
        self.space = pymunk.Space(threaded=threads > 1)
        if threads > 1:
            self.space.threads = threads
        self.space.gravity = self.gravity
        s = self.size
        for k, (a, b) in enumerate((((0, 0), (s, 0)), ((s, 0), (s, s)), ((s, s), (0, s)), ((0, s), (0, 0)))):
            wall = pymunk.Segment(self.space.static_body, a, b, 0.1)
            self._material(wall)
            wall.tag = f"wall{k}"  # pyright: ignore[reportAttributeAccessIssue]
            self.space.add(wall)
        self.pairs: list[tuple[str, str]] = []
        self.blocked: frozenset[str] | None = None

    def _material(self, shape: Any) -> None:
        shape.elasticity, shape.friction = (1.0, 0.0) if self.kind == "gas" else (0.2, 0.6)

    def close(self) -> None:
        def after(arbiter: Any, _space: Any, _data: Any) -> None:
            if arbiter.total_impulse != (0.0, 0.0):
                a, b = arbiter.shapes
                self.pairs.append((a.tag, b.tag))

        def before(arbiter: Any, _space: Any, _data: Any) -> None:
            if self.block is not False:
                a, b = (shape.tag for shape in arbiter.shapes)
                if self.block or (self.block is None and self.blocked == frozenset((a, b))):
                    self.block, self.blocked = None, frozenset((a, b))
                    arbiter.process_collision = False

        if self.fault.kind == "contact":
            self.space.on_collision(pre_solve=before, post_solve=after)
        else:
            self.space.on_collision(post_solve=after)

    def add(self, name: str, row: tuple[float, float, float, float], mass: float, box: bool) -> None:
        p = self.pymunk
        moment = p.moment_for_box(mass, (1.6, 1.6)) if box else p.moment_for_circle(mass, 0, 0.9)
        body = p.Body(mass, math.inf if self.kind == "gas" else moment)
        body.position, body.velocity = row[:2], row[2:]
        shape = p.Poly.create_box(body, (1.6, 1.6)) if box else p.Circle(body, 0.9)
        self._material(shape)
        shape.tag = name
        self.space.add(body, shape)
        self.bodies[name] = body

    def step(self) -> list[tuple[str, str]]:
        self.pairs.clear()
        self.space.step(self.dt)
        return list(self.pairs)

    def states(self) -> Rows:
        return {
            name: [*body.position, body.angle, *body.velocity, body.angular_velocity]
            for name, body in ((f"b{k}", self.bodies[f"b{k}"]) for k in range(len(self.bodies)))
        }

    def push(self, name: str, dvx: float, dvy: float) -> None:
        body = self.bodies[name]
        body.velocity = body.velocity[0] + dvx, body.velocity[1] + dvy

    def forget(self) -> None:
        for body in self.bodies.values():
            for shape in list(body.shapes):
                self.space.remove(shape)
                self.space.add(shape)

    def weigh(self, name: str, factor: float) -> None:
        self.bodies[name].mass *= factor


class Box2DWorld(World):
    """Box2D 2.3, in floats."""

    fields = ["x", "y", "angle", "vx", "vy", "spin"]  # noqa: RUF012
    single = True
    block: bool | None

    def open(self) -> None:
        b2: Any = package("Box2D", "box2d")
        self.b2 = b2
        self.world = b2.b2World(gravity=self.gravity, doSleep=False)
        world, pairs = self, []
        self.pairs: list[tuple[str, str]] = pairs

        class Listener(b2.b2ContactListener):
            def PreSolve(self, contact: Any, _old: Any) -> None:
                flights = [f.body.linearVelocity for f in (contact.fixtureB, contact.fixtureA)]
                normal = contact.worldManifold.normal
                near = (flights[0][0] - flights[1][0]) * normal[0] + (flights[0][1] - flights[1][1]) * normal[1]
                if world.block and contact.touching and near < -0.2:
                    world.block, contact.enabled = None, False

            def PostSolve(self, contact: Any, impulse: Any) -> None:
                if impulse.normalImpulses and impulse.normalImpulses[0] > 0.0:
                    pairs.append((contact.fixtureA.body.userData, contact.fixtureB.body.userData))

        self.listener = Listener()
        self.world.contactListener = self.listener
        s = self.size
        for k, ends in enumerate((((0, 0), (s, 0)), ((s, 0), (s, s)), ((s, s), (0, s)), ((0, s), (0, 0)))):
            body = self.world.CreateStaticBody()
            body.CreateFixture(shape=b2.b2EdgeShape(vertices=ends), **self._material())
            body.userData = f"wall{k}"

    def _material(self) -> dict[str, float]:
        return {"restitution": 1.0, "friction": 0.0} if self.kind == "gas" else {"restitution": 0.1, "friction": 0.6}

    def add(self, name: str, row: tuple[float, float, float, float], mass: float, box: bool) -> None:
        body = self.world.CreateDynamicBody(
            position=row[:2], linearVelocity=row[2:], fixedRotation=self.kind == "gas", allowSleep=False
        )
        if box:
            body.CreatePolygonFixture(box=(0.8, 0.8), density=mass, **self._material())
        else:
            body.CreateCircleFixture(radius=0.9, density=mass, **self._material())
        body.userData = name
        self.bodies[name] = body

    def step(self) -> list[tuple[str, str]]:
        self.pairs.clear()
        self.world.Step(self.dt, 8, 3)
        self.world.warmStarting = True
        return list(self.pairs)

    def states(self) -> Rows:
        return {
            name: [*self.bodies[name].position, self.bodies[name].angle, *self.bodies[name].linearVelocity,
                   self.bodies[name].angularVelocity]
            for name in self.ids
        }  # fmt: skip

    def push(self, name: str, dvx: float, dvy: float) -> None:
        vx, vy = self.bodies[name].linearVelocity
        self.bodies[name].linearVelocity = (vx + dvx, vy + dvy)

    def forget(self) -> None:
        self.world.warmStarting = False

    def weigh(self, name: str, factor: float) -> None:
        body = self.bodies[name]
        body.massData = self.b2.b2MassData(mass=body.mass * factor, center=(0, 0), I=body.inertia * factor)


class RapierWorld(World):
    """Rapier 3D, in floats."""

    fields = ["x", "y", "z", "qi", "qj", "qk", "qw", "vx", "vy", "vz"]  # noqa: RUF012
    single = True

    def open(self) -> None:
        r: Any = package("rapier3d", "rapier")
        self.rapier = r
        self.world = r.PhysicsWorld(gravity=(*self.gravity, 0.0))
        self.world.set_num_threads(4 if self.fault.kind == "threads" else 1)
        self.world.integration_parameters.dt = self.dt
        self.names: dict[Any, str] = {}
        s = self.size
        faces = (((0, 1, 0), (0, 0, 0)), ((-1, 0, 0), (s, 0, 0)), ((0, -1, 0), (0, s, 0)), ((1, 0, 0), (0, 0, 0)),
                 ((0, 0, 1), (0, 0, -2)), ((0, 0, -1), (0, 0, 2)))  # fmt: skip
        for k, (normal, at) in enumerate(faces):
            shape = self._hard(r.Collider.halfspace(tuple(map(float, normal))).translation(tuple(map(float, at))))
            self.names[self.world.add_collider(shape)] = f"wall{k}"

    def _hard(self, shape: Any) -> Any:
        restitution, friction = (1.0, 0.0) if self.kind == "gas" else (0.1, 0.6)
        return shape.friction(friction).restitution(restitution)

    def add(self, name: str, row: tuple[float, float, float, float], mass: float, box: bool) -> None:
        r = self.rapier
        body = r.RigidBody.dynamic().translation((row[0], row[1], 0.0)).linvel((row[2], row[3], 0.0)).can_sleep(False)
        shape = r.Collider.cuboid(0.8, 0.8, 0.8) if box else r.Collider.ball(0.9)
        handle = self.world.add_body(body, [self._hard(shape).mass(mass)])
        for collider in self.world.rigid_bodies[handle].colliders:
            self.names[collider] = name
        self.bodies[name] = handle

    def step(self) -> list[tuple[str, str]]:
        told = self.world.integration_parameters
        self.world.step()
        told.warmstart_coefficient = self.warmth if hasattr(self, "warmth") else told.warmstart_coefficient
        return [
            (self.names[pair.collider1], self.names[pair.collider2])
            for pair in self.world.narrow_phase.contact_pairs()
            if pair.total_impulse_magnitude() > 0.0
        ]

    def states(self) -> Rows:
        found: Rows = {}
        for name in self.ids:
            body = self.world.rigid_bodies[self.bodies[name]]
            at, turn, flight = body.translation, body.rotation, body.linvel
            found[name] = [at.x, at.y, at.z, turn.i, turn.j, turn.k, turn.w, flight.x, flight.y, flight.z]
        return found

    def push(self, name: str, dvx: float, dvy: float) -> None:
        body = self.world.rigid_bodies[self.bodies[name]]
        flight = body.linvel
        body.linvel = (flight.x + dvx, flight.y + dvy, flight.z)

    def forget(self) -> None:
        told = self.world.integration_parameters
        self.warmth = told.warmstart_coefficient
        told.warmstart_coefficient = 0.0


class MujocoWorld(World):
    """MuJoCo, in doubles."""

    fields = ["x", "y", "z", "qw", "qi", "qj", "qk", "vx", "vy", "vz", "wx", "wy", "wz"]  # noqa: RUF012

    def open(self) -> None:
        m: Any = package("mujoco", "mujoco")
        self.mujoco, self.spec = m, m.MjSpec()
        self.spec.option.timestep, self.spec.option.gravity = self.dt / 4, [*self.gravity, 0.0]
        s = self.size
        for k, (at, axis) in enumerate((([0, 0, 0], [0, 1, 0]), ([s, 0, 0], [-1, 0, 0]), ([0, s, 0], [0, -1, 0]),
                                        ([0, 0, 0], [1, 0, 0]), ([0, 0, -2], [0, 0, 1]))):  # fmt: skip
            self.spec.worldbody.add_geom(
                name=f"wall{k}", type=m.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], pos=at, zaxis=axis
            )
        self.start: dict[str, tuple[float, float, float, float]] = {}

    def add(self, name: str, row: tuple[float, float, float, float], mass: float, box: bool) -> None:
        m = self.mujoco
        body = self.spec.worldbody.add_body(pos=[row[0], row[1], 0.0], name=name)
        body.add_freejoint()
        kind = m.mjtGeom.mjGEOM_BOX if box else m.mjtGeom.mjGEOM_SPHERE
        body.add_geom(name=name, type=kind, size=[0.8] * 3 if box else [0.9, 0, 0], mass=mass)
        self.start[name] = row

    def close(self) -> None:
        self.model: Any = self.spec.compile()
        self.data: Any = self.mujoco.MjData(self.model)
        self.places: dict[str, tuple[int, int]] = {}
        for name, row in self.start.items():
            joint = self.model.body(name).jntadr[0]
            at, v = int(self.model.jnt_qposadr[joint]), int(self.model.jnt_dofadr[joint])
            self.places[name] = at, v
            self.data.qvel[v : v + 2] = row[2:]

    def step(self) -> list[tuple[str, str]]:
        pairs: dict[tuple[str, str], None] = {}
        for _ in range(4):
            self.mujoco.mj_step(self.model, self.data)
            for k in range(self.data.ncon):
                contact = self.data.contact[k]
                pairs[tuple(self.model.geom(int(g)).name for g in contact.geom)] = None  # pyright: ignore[reportArgumentType]
        return list(pairs)

    def states(self) -> Rows:
        data = self.data
        return {
            name: [*data.qpos[at : at + 7].tolist(), *data.qvel[v : v + 6].tolist()]
            for name, (at, v) in ((name, self.places[name]) for name in self.ids)
        }

    def push(self, name: str, dvx: float, dvy: float) -> None:
        v = self.places[name][1]
        self.data.qvel[v] += dvx
        self.data.qvel[v + 1] += dvy

    def forget(self) -> None:
        self.data.qacc_warmstart[:] = 0.0

    def weigh(self, name: str, factor: float) -> None:
        body = self.model.body(name).id
        self.model.body_mass[body] *= factor
        self.model.body_inertia[body] *= factor


ENGINES: dict[str, Callable[..., World]] = {
    "pymunk": PymunkWorld, "box2d": Box2DWorld, "rapier": RapierWorld, "mujoco": MujocoWorld,
}  # fmt: skip
"""Engines of steps, by name."""


C_ENGINE = r"""
#include <math.h>
#include <stdlib.h>
#include "truebreak_log.h"
#ifndef REAL
#define REAL double
#endif
enum { N = 16 };
static REAL x[N], y[N], vx[N], vy[N];
static const REAL r = 0.9, size = 14;
int main(int count, char **words) {
    int steps = atoi(words[1]), kind = atoi(words[2]), i, j, k;
    char name[16], other[16];
    unsigned seed = (unsigned)atoi(words[3]);
    REAL dt = (REAL)1 / 120, g = kind ? (REAL)-9.81 : 0, bounce = kind ? (REAL)0.6 : 1;
    tb_log *log = tb_open(words[4], "discs in C", "x,y,vx,vy", sizeof(REAL) == 4 ? 24 : 53);
    for (i = 0; i < N; i++) {
        seed = seed * 1103515245u + 12345u; x[i] = 2 + (REAL)2.9 * (i % 4) + (REAL)((seed >> 16) % 1000) / 2500;
        seed = seed * 1103515245u + 12345u; y[i] = 2 + (REAL)2.9 * (i / 4) + (REAL)((seed >> 16) % 1000) / 2500;
        seed = seed * 1103515245u + 12345u; vx[i] = (REAL)((seed >> 16) % 1000) / 100 - 5;
        seed = seed * 1103515245u + 12345u; vy[i] = (REAL)((seed >> 16) % 1000) / 100 - 5;
    }
    for (k = 0; k <= steps; k++) {
        tb_step(log, k, k * (double)dt);
        if (k) for (i = 0; i < N; i++) { vy[i] += g * dt; x[i] += vx[i] * dt; y[i] += vy[i] * dt; }
        if (k) for (i = 0; i < N; i++) {
            snprintf(name, sizeof name, "d%d", i);
            for (j = i + 1; j < N; j++) {
                REAL dx = x[j] - x[i], dy = y[j] - y[i], d2 = dx * dx + dy * dy;
                REAL near = (vx[j] - vx[i]) * dx + (vy[j] - vy[i]) * dy;
                if (d2 < 4 * r * r && near < 0) {
                    REAL s = (1 + bounce) / 2 * near / d2;
                    vx[i] += s * dx; vy[i] += s * dy; vx[j] -= s * dx; vy[j] -= s * dy;
                    snprintf(other, sizeof other, "d%d", j);
                    tb_contact(log, name, other);
                }
            }
            if (x[i] < r && vx[i] < 0) { vx[i] *= -bounce; tb_contact(log, name, "left"); }
            if (x[i] > size - r && vx[i] > 0) { vx[i] *= -bounce; tb_contact(log, name, "right"); }
            if (y[i] < r && vy[i] < 0) { vy[i] *= -bounce; tb_contact(log, name, "floor"); }
            if (y[i] > size - r && vy[i] > 0) { vy[i] *= -bounce; tb_contact(log, name, "roof"); }
        }
        for (i = 0; i < N; i++) {
            double state[4] = {x[i], y[i], vx[i], vy[i]};
            snprintf(name, sizeof name, "d%d", i);
            tb_state(log, name, state, 4);
        }
    }
    return tb_close(log);
}
"""
"""An engine of 16 discs by steps, in floats or doubles, with and without gravity."""


CHAIN = r"""
#include <math.h>
#include <stdio.h>
#ifndef REAL
#define REAL double
#endif
enum { N = 9 };
int main(void) {
    REAL a[N], w[N], dt = (REAL)0.01;
    int i, k;
    for (i = 0; i < N; i++) a[i] = (REAL)0.7 + (REAL)0.31 * i, w[i] = (REAL)0.1 * i;
    printf("{\"log\": \"truebreak/log-1\", \"fields\": [\"angle\", \"spin\"]}\n");
    for (k = 0; k <= 250; k++) {
        if (k) for (i = 0; i < N; i++) {
            REAL f = (REAL)-9.8 * (REAL)SIN(a[i]), last = i ? a[i - 1] : 0, next = i < N - 1 ? a[i + 1] : a[i];
            f += 4 * (last - 2 * a[i] + next) - w[i] / 7;
            w[i] += f * dt;
        }
        if (k) for (i = 0; i < N; i++) a[i] += w[i] * dt;
        printf("{\"step\": %d, \"states\": {", k);
        for (i = 0; i < N; i++) printf("%s\"p%d\": [%.17g, %.17g]", i ? ", " : "", i, (double)a[i], (double)w[i]);
        printf("}}\n");
    }
    return 0;
}
"""
"""A chain of pendulums: sines and a spring, no contacts."""


@cache
def chain(*flags: str) -> str:
    """The chain's log, built with flags."""
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "chain.c"
        source.write_text(CHAIN, encoding="utf-8")
        words = flags if any(f.startswith("-DSIN") for f in flags) else (*flags, "-DSIN=sin")
        subprocess.run(
            ["cc", "-std=gnu99", *words, "-o", f"{folder}/chain", str(source), "-lm"], check=True, capture_output=True
        )
        return subprocess.run([f"{folder}/chain"], check=True, capture_output=True, text=True).stdout


@cache
def compiler() -> str | None:
    """The C compiler, if there is one."""
    return next((path for name in ("cc", "gcc", "clang") if (path := shutil.which(name))), None)


@cache
def built(flags: tuple[str, ...], folder: str) -> str:
    """The C engine, built with flags.

    Raises:
        OSError, subprocess.CalledProcessError: without a compiler that knows them.
    """
    source = Path(folder) / "discs.c"
    source.write_text(C_ENGINE, encoding="utf-8")
    shutil.copy(HEADER, folder)
    target = Path(folder) / f"discs{abs(hash(flags))}"
    words = [compiler() or "cc", "-std=c99", *flags, "-o", str(target), str(source), "-lm"]
    subprocess.run(words, check=True, capture_output=True)
    return str(target)


def c_run(flags: tuple[str, ...], kind: str, seed: int, steps: int) -> Steps:
    """A run of the C engine."""
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "log.jsonl"
        subprocess.run([built(flags, _folder()), str(steps), str(int(kind != "gas")), str(seed), str(log)], check=True)
        lines = [json.loads(line) for line in log.read_text("utf-8").splitlines()]
    told = Steps(["x", "y", "vx", "vy"], 1 / 120)
    told.records = [{"contacts": [], **line} for line in lines if "step" in line]
    return told


@cache
def _folder() -> str:
    return tempfile.mkdtemp(prefix="truebreak-trials-")


def scene_run(name: str, engine: str, change: Callable[[Any], Any] | None, events: int) -> Iterator[dict[str, Any]]:
    """The events of one of truebreak's own engines, with the states that each leaves."""
    from truebreak.compare.engines import engine as engine_named
    from truebreak.compare.scene_argument import scene_from

    scene = scene_from(name)
    trajectory = engine_named(engine).run(change(scene) if change else scene, events=events)
    end = float(trajectory.final_time)
    after = (math.nextafter(float(event.time), math.inf) for event in trajectory.events)  # of quads: what it leaves
    times = [min(t, math.nextafter(end, 0.0)) for t in after]
    rows: Iterable[Any] = trajectory.sample(times) if times else []
    for event, row in zip(trajectory.events, rows, strict=True):
        pairs = [[str(name) for name in pair] for pair in event.impulses]
        places = {str(c.id): k for k, c in enumerate(trajectory.scene.circles)}
        touched = [i for pair in pairs for i in pair if i in places]
        yield {
            "time": float(event.time), "contacts": pairs, "states": {i: row[places[i]].tolist() for i in touched},
        }  # fmt: skip
