"""The adapter of MuJoCo: discs are spheres that slide in a plane, and what touches is pressed apart by springs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...scenarios.errors import SceneError
from ..foreign.recording import StepFall
from .adapter import LASTING, Episodes, SteppedAdapter, bar_ends, bars, gravity_of, lines, package, sides

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ..foreign.impulses import Row
    from ..foreign.recording import Recording

MOST_FACES = 30
"""Faces of walls that MuJoCo's 32-bit masks tell apart, beside the bit of the circles."""

HARDNESS = 0.9999
"""MuJoCo's impedance of a contact, the most that it allows; the rest is a compliance, and makes a spring softer."""


@dataclass(frozen=True)
class MujocoEngine(SteppedAdapter):
    """Plays scenes in MuJoCo: doubles, by time steps, of which a collision takes several.

    MuJoCo has no restitution: a contact is a spring and a damper. Without the damper, and integrated finely, it gives
    back what it took: to 1e-5 of the energy of a hit for 16 steps a contact, to 3e-7 for 32. The springs push as masses
    ask for, so that every contact of two lasts as long. What presses together at one time is one event, at the first
    step at which it pressed; circles are then taken to have been elsewhere for as long as the contact lasted.

    Attributes:
        dt, max_steps: see `SteppedAdapter`.
        contact_steps: how many steps a contact of two takes, which sets the springs' stiffness.
        iterations: of MuJoCo's Newton solver, a step; its tolerance is 0.

    >>> MujocoEngine(dt=1 / 64).bits
    53
    """

    distribution = "mujoco"
    name = "mujoco"
    bits = 53
    step_microseconds = 20.0
    falls = StepFall(0.5, 0.0)
    dt: float = 1 / 2048
    contact_steps: int = 16
    iterations: int = 100

    def __post_init__(self) -> None:
        super().__post_init__()
        self.check_count("iterations")
        self.check_count("contact_steps")

    def world(self, scene: Scene) -> MujocoWorld:
        """The scene in MuJoCo.

        Raises:
            SceneError: for a point ball, and for more walls than it can tell apart.
            NotInstalled: without MuJoCo.
        """
        return MujocoWorld(scene, self)

    def teller(self, scene: Scene, recording: Recording) -> Episodes:
        """Gathers the steps of each contact."""
        return Episodes(scene, recording, LASTING * self.contact_steps * self.dt)


class MujocoWorld:
    """A scene in MuJoCo's terms (see `stepped.World`)."""

    def __init__(self, scene: Scene, engine: MujocoEngine) -> None:
        self._mujoco: Any = package("mujoco", "mujoco")
        self._fixed = {k: (float(c.x), float(c.y), 0.0, 0.0) for k, c in enumerate(scene.circles) if c.fixed}
        self._model: Any = self._spec(scene, engine).compile()
        self._data: Any = self._mujoco.MjData(self._model)
        self._names = {
            place: self._mujoco.mj_id2name(self._model, self._mujoco.mjtObj.mjOBJ_GEOM, place).partition("/")[2]
            for place in range(self._model.ngeom)
        }
        self._starts = [(float(c.x), float(c.y)) for c in scene.circles if not c.fixed]
        self._force = np.zeros(6)
        self._data.qvel[:] = [float(v) for c in scene.circles if not c.fixed for v in (c.vx, c.vy)]

    def _spec(self, scene: Scene, engine: MujocoEngine) -> Any:
        mujoco = self._mujoco
        spec = mujoco.MjSpec()
        spec.option.timestep, spec.option.gravity = engine.dt, [*gravity_of(scene), 0]
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
        spec.option.solver = mujoco.mjtSolver.mjSOL_NEWTON
        spec.option.iterations, spec.option.tolerance = engine.iterations, 0.0
        found = sides(scene)
        faces = sorted({(wall, side) for row in found for wall, side in enumerate(row)})
        if len(faces) > MOST_FACES:
            raise SceneError(
                f"{scene.name!r}: circles meet {len(faces)} faces of walls; engine 'mujoco' distinguishes {MOST_FACES}"
            )
        spring = -((math.pi / (engine.contact_steps * engine.dt)) ** 2)
        hard: dict[str, Any] = {
            "condim": 1, "friction": [0, 0, 0], "solref": [spring, 0], "solimp": [HARDNESS, HARDNESS, 1, 0.5, 2],
        }  # fmt: skip
        for circle, row in zip(scene.circles, found, strict=True):
            bits = 1 | sum(2 << faces.index(face) for face in enumerate(row))
            at = [float(circle.x), float(circle.y), 0.0]
            body = spec.worldbody if circle.fixed else spec.worldbody.add_body(pos=at)
            if not circle.fixed:
                for axis in ([1, 0, 0], [0, 1, 0]):
                    body.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis)
            body.add_geom(
                name=f"thing/{circle.id}",
                type=mujoco.mjtGeom.mjGEOM_SPHERE,
                size=[float(circle.r), 0, 0],
                pos=at if circle.fixed else [0, 0, 0],
                mass=0.0 if circle.fixed else float(circle.m),
                contype=bits,
                conaffinity=1,
                **hard,
            )
        for bit, (place, side) in enumerate(faces):
            line = lines(scene)[place]
            spec.worldbody.add_geom(
                name=f"face {side}/{scene.walls[place].id}",
                type=mujoco.mjtGeom.mjGEOM_PLANE,
                size=[0, 0, 1],
                pos=[line.nx * line.height, line.ny * line.height, 0.0],
                zaxis=[side * line.nx, side * line.ny, 0.0],
                contype=0,
                conaffinity=2 << bit,
                **hard,
            )
        for number, bar in enumerate(bars(scene)):
            if bar.r.sign() == 0:
                if bar in scene.segments:
                    told = f"segment {bar.id!r}: r = 0; engine 'mujoco' has segments of some thickness alone"
                    raise SceneError(f"{told}; give it half a thickness, r")
                told = f"polygon {bar.id!r}: r = 0; engine 'mujoco' has polygons with round corners alone"
                raise SceneError(f"{told}; give it a radius, r")
            spec.worldbody.add_geom(
                name=f"bar {number}/{bar.id}",
                type=mujoco.mjtGeom.mjGEOM_CAPSULE,
                fromto=[value for x, y in bar_ends(bar) for value in (x, y, 0.0)],
                size=[float(bar.r), 0, 0],
                contype=0,
                conaffinity=1,
                **hard,
            )
        return spec

    def step(self) -> Sequence[tuple[str, str]]:
        """See `World`."""
        model, data = self._model, self._data
        self._mujoco.mj_step(model, data)
        found: list[tuple[str, str]] = []
        for place in range(data.ncon):
            self._mujoco.mj_contactForce(model, data, place, self._force)
            if self._force[0] > 0.0:
                contact = data.contact[place]
                found.append((self._names[int(contact.geom1)], self._names[int(contact.geom2)]))
        return found

    def rows(self) -> list[Row]:
        """See `World`."""
        at, flight = self._data.qpos.tolist(), self._data.qvel.tolist()
        moving = iter(
            (x0 + at[2 * k], y0 + at[2 * k + 1], flight[2 * k], flight[2 * k + 1])
            for k, (x0, y0) in enumerate(self._starts)
        )
        return [
            self._fixed[k] if k in self._fixed else next(moving) for k in range(len(self._starts) + len(self._fixed))
        ]

    def place(self, rows: Sequence[Row]) -> None:
        """See `World`."""
        moving = [row for k, row in enumerate(rows) if k not in self._fixed]
        for k, ((x, y, vx, vy), (x0, y0)) in enumerate(zip(moving, self._starts, strict=True)):
            self._data.qpos[2 * k : 2 * k + 2] = (x - x0, y - y0)
            self._data.qvel[2 * k : 2 * k + 2] = (vx, vy)
