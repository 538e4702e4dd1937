"""The adapter of Rapier, the game engine of Dimforge: discs are spheres held to a plane."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...scenarios.errors import SceneError
from ..foreign.recording import StepFall
from .adapter import SteppedAdapter, bar_ends, bars, gravity_of, lines, package, power_of_two, sides

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.things import Segment
    from ..foreign.impulses import Row

UNCAPPED = 1e30
"""Rapier's greatest speed, in lengths a second: none that a scene comes near."""

MOST_FACES = 31
"""Faces of walls that Rapier's 32-bit groups tell apart, beside the group of the circles."""


@dataclass(frozen=True)
class RapierEngine(SteppedAdapter):
    """Plays scenes in Rapier 3D, as `pip install rapier3d` has it: numbers of 24 bits, by time steps.

    Circles are balls that move in x and y alone and do not rotate; a wall is a half-space for each side on which there
    are circles, which nothing else stops, of a kinematic body where it moves; a segment is one
    of its own, or a capsule. The scene's restitution, friction 0, no damping, no sleeping, no warm starting, no
    correction of overlaps, no contact ahead of a touch, no cap of speeds.

    Attributes:
        dt, max_steps: see `SteppedAdapter`.
        iterations: Rapier's solver iterations a step: substeps, 4 by its own default.

    >>> RapierEngine(dt=1 / 64).bits
    24
    """

    distribution = "rapier3d"
    name = "rapier"
    bits = 24
    step_microseconds = 35.0
    iterations: int = 4

    def __post_init__(self) -> None:
        super().__post_init__()
        self.check_count("iterations")

    @property
    def scene_keys(self) -> frozenset[str]:
        """As of other steppers, `restitution`, walls that move, and what lies on walls."""
        return super().scene_keys | {"restitution", "moving walls", "settle"}

    @property
    def falls(self) -> StepFall:
        """Each of its k iterations adds a k-th of g dt, and then moves a circle on: (k + 1) / (2 k) of g dt a step.

        It bounces with the velocity of before the step.
        """
        return StepFall((self.iterations + 1) / (2 * self.iterations), 1.0)

    def world(self, scene: Scene) -> RapierWorld:
        """The scene in Rapier.

        Raises:
            SceneError: for a point ball, and for more walls than it can tell apart.
            NotInstalled: without Rapier.
        """
        return RapierWorld(scene, self)


class RapierWorld:
    """A scene in Rapier's terms (see `stepped.World`)."""

    def __init__(self, scene: Scene, engine: RapierEngine) -> None:
        self._rapier: Any = package("rapier3d", "rapier")
        self._restitution = float(scene.restitution)
        self._metres = power_of_two(2 / max((float(c.r) for c in scene.circles if c.r.sign()), default=1.0))
        gx, gy = gravity_of(scene)
        self._world = self._rapier.PhysicsWorld(gravity=(gx * self._metres, gy * self._metres, 0))
        self._world.set_num_threads(1)
        self._set(engine)
        self._names: dict[Any, str] = {}
        found = sides(scene)
        faces = sorted({(wall, side) for row in found for wall, side in enumerate(row)})
        if len(faces) > MOST_FACES:
            raise SceneError(
                f"{scene.name!r}: circles meet {len(faces)} faces of walls; engine 'rapier' distinguishes {MOST_FACES}"
            )
        self._handles = [
            self._ball(circle, [faces.index(face) for face in enumerate(row)])
            for circle, row in zip(scene.circles, found, strict=True)
        ]
        self._moving = [not circle.fixed for circle in scene.circles]
        for bit, (place, side) in enumerate(faces):
            line = lines(scene)[place]
            normal = (side * line.nx, side * line.ny, 0.0)
            at = (line.nx * line.height * self._metres, line.ny * line.height * self._metres, 0.0)
            shape = self._rapier.Collider.halfspace(normal).translation(at)
            group = self._group(2 << bit)
            shape, wall = self._hard(shape).collision_groups(self._groups(group, group)), scene.walls[place]
            if wall.moves:
                pace = (float(wall.vx) * self._metres, float(wall.vy) * self._metres, 0.0)
                body = self._rapier.RigidBody.kinematic_velocity_based().linvel(pace).can_sleep(False)
                (collider,) = self._world.rigid_bodies[self._world.add_body(body, [shape])].colliders
            else:
                collider = self._world.add_collider(shape)
            self._names[collider] = str(wall.id)
        for bar in bars(scene):
            self._names[self._world.add_collider(self._bar(bar))] = str(bar.id)

    def _set(self, engine: RapierEngine) -> None:
        told = self._world.integration_parameters
        told.dt = engine.dt
        told.num_solver_iterations = engine.iterations
        told.warmstart_coefficient = 0.0
        told.normalized_max_corrective_velocity = 0.0
        told.normalized_prediction_distance = 0.0
        told.normalized_max_linear_velocity = UNCAPPED
        told.contact_recycling = told.contact_clustering = False

    def _bar(self, bar: Segment) -> Any:
        """A segment, which every circle meets: a capsule where it has some thickness."""
        ends = [(float(x) * self._metres, float(y) * self._metres, 0.0) for x, y in bar_ends(bar)]
        kind, r = self._rapier.Collider, float(bar.r) * self._metres
        shape = kind.capsule_from_endpoints(*ends, r) if r else kind.segment(*ends)
        return self._hard(shape).collision_groups(self._groups(self._group(1), self._group(1)))

    def _hard(self, shape: Any) -> Any:
        return shape.friction(0.0).restitution(self._restitution)

    def _group(self, bits: int) -> Any:
        return self._rapier.Group.from_bits(bits)

    def _groups(self, member: Any, meets: Any) -> Any:
        return self._rapier.InteractionGroups(member, meets)

    def _ball(self, circle: Any, faces: Sequence[int]) -> Any:
        at = (float(circle.x) * self._metres, float(circle.y) * self._metres, 0.0)
        kind = self._rapier.RigidBody
        if circle.fixed:
            body = kind.fixed().translation(at)
        else:
            flight = (float(circle.vx) * self._metres, float(circle.vy) * self._metres, 0.0)
            body = kind.dynamic().translation(at).linvel(flight).can_sleep(False)
            body = body.enabled_translations((True, True, False)).enabled_rotations((False, False, False))
        group = self._group(1 | sum(2 << face for face in faces))
        shape = self._hard(self._rapier.Collider.ball(float(circle.r) * self._metres))
        shape = shape.collision_groups(self._groups(group, group)).density(0.0)
        handle = self._world.add_body(body, [shape if circle.fixed else shape.mass(float(circle.m))])
        for collider in self._world.rigid_bodies[handle].colliders:
            self._names[collider] = str(circle.id)
        return handle

    def step(self) -> Sequence[tuple[str, str]]:
        """See `World`."""
        self._world.step()
        return [
            (self._names[pair.collider1], self._names[pair.collider2])
            for pair in self._world.narrow_phase.contact_pairs()
            if pair.total_impulse_magnitude() > 0.0
        ]

    def rows(self) -> list[Row]:
        """See `World`."""
        bodies, metres = self._world.rigid_bodies, self._metres
        found: list[Row] = []
        for handle in self._handles:
            body = bodies[handle]
            at, flight = body.translation, body.linvel
            found.append((at.x / metres, at.y / metres, flight.x / metres, flight.y / metres))
        return found

    def place(self, rows: Sequence[Row]) -> None:
        """See `World`."""
        for handle, moves, (x, y, vx, vy) in zip(self._handles, self._moving, rows, strict=True):
            if moves:
                body = self._world.rigid_bodies[handle]
                body.translation = (x * self._metres, y * self._metres, 0.0)
                body.linvel = (vx * self._metres, vy * self._metres, 0.0)
