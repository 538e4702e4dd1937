"""The adapter of Box2D, the game engine of Erin Catto, by its Python binding of version 2.3."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...scenarios.errors import SceneError
from ..foreign.recording import StepFall
from .adapter import (
    OutOfRoom,
    SteppedAdapter,
    bar_ends,
    bars,
    gravity_of,
    package,
    power_of_two,
    stretches,
    top_speed,
)

if TYPE_CHECKING:
    from ...floating.pymunk_space import Point
    from ...scenarios.scene import Scene
    from ..foreign.impulses import Row

QUICK = 2.0**30
"""How many of a scene's units of time pass in one of Box2D's seconds. What approaches slower than 1 m/s does not bounce
in Box2D; by this scale that is a speed of 2**-30, if a unit of length is a metre. A power of two, so that no other
number is rounded otherwise."""

FARTHEST = 2.0
"""Metres that Box2D lets a body go in one step at most (b2_maxTranslation)."""

NEARLY = 1 - 2.0**-16
"""What goes as far as that has been held back, but for rounding."""


@dataclass(frozen=True)
class Box2DEngine(SteppedAdapter):
    """Plays scenes in Box2D 2.3, as `pip install box2d` has it: numbers of 24 bits, by time steps.

    Circles are bodies that do not rotate, walls are edges of no thickness, long enough for the scene; a run in which a
    circle gets near the end of one stops; those that move are kinematic bodies. Segments are edges,
    with their thickness. The scene's restitution, friction 0, no damping, no sleeping, no continuous collision,
    no warm starting, and no correction of positions.

    Attributes:
        dt, max_steps: see `SteppedAdapter`.
        iterations: rounds of Box2D's solver over the contacts of a step; games use 8.

    >>> Box2DEngine(dt=1 / 64).bits
    24
    """

    distribution = "box2d"
    name = "box2d"
    bits = 24
    step_microseconds = 5.0
    falls = StepFall(1.0, 0.0)
    iterations: int = 64

    def __post_init__(self) -> None:
        super().__post_init__()
        self.check_count("iterations")

    @property
    def scene_keys(self) -> frozenset[str]:
        """As of other steppers, `restitution`, walls that move, and what lies on walls."""
        return super().scene_keys | {"restitution", "moving walls", "settle"}

    def allows(self, scene: Scene) -> dict[str, float]:
        """The speed below which nothing bounces, 1 m/s of its own (b2_velocityThreshold), in the scene's units.

        Its slop of 1/200 m is of the correction of positions, which is off.
        """
        return {"threshold": 1 / (metres(scene, self) * QUICK)}

    def world(self, scene: Scene) -> Box2DWorld:
        """The scene in Box2D.

        Raises:
            SceneError: where a circle may go farther in one step than Box2D lets it.
            NotInstalled: without Box2D.
        """
        return Box2DWorld(scene, self)


class Box2DWorld:
    """A scene in Box2D's terms (see `stepped.World`)."""

    def __init__(self, scene: Scene, engine: Box2DEngine) -> None:
        self._b2: Any = package("Box2D", "box2d")
        self._engine, self._ids, self._pushed = engine, scene.ids, []
        self._restitution = float(scene.restitution)
        self._metres = metres(scene, engine)
        self._speed = self._metres * QUICK
        gravity = [part * self._speed * QUICK for part in gravity_of(scene)]
        self._world = self._b2.b2World(gravity=gravity, doSleep=False)
        self._world.continuousPhysics = self._world.warmStarting = False
        self._bodies = [self._body(circle) for circle in scene.circles]
        self._moving = [not circle.fixed for circle in scene.circles]
        self._stretches = stretches(scene)
        for wall, stretch in zip(scene.walls, self._stretches, strict=True):
            self._edge(str(wall.id), (stretch.start, stretch.end), 0.0, stretch.pace if wall.moves else None)
        for bar in bars(scene):
            self._edge(str(bar.id), bar_ends(bar), float(bar.r))
        self._time = 0.0
        self._listener = self._listen()
        self._world.contactListener = self._listener

    def _body(self, circle: Any) -> Any:
        at = (float(circle.x) * self._metres, float(circle.y) * self._metres)
        if circle.fixed:
            body = self._world.CreateStaticBody(position=at)
        else:
            flight = (float(circle.vx) * self._speed, float(circle.vy) * self._speed)
            body = self._world.CreateDynamicBody(
                position=at, linearVelocity=flight, fixedRotation=True, allowSleep=False, linearDamping=0.0
            )
        body.CreateCircleFixture(
            radius=float(circle.r) * self._metres, density=1.0, friction=0.0, restitution=self._restitution
        )
        if not circle.fixed:
            body.massData = self._b2.b2MassData(mass=float(circle.m), center=(0, 0), I=0.0)
        body.userData = str(circle.id)
        return body

    def _edge(self, name: str, ends: tuple[Point, Point], r: float, pace: Point | None = None) -> None:
        shape = self._b2.b2EdgeShape(vertices=[(x * self._metres, y * self._metres) for x, y in ends])
        shape.radius = r * self._metres
        if pace is None:
            body = self._world.CreateStaticBody()
        else:
            body = self._world.CreateKinematicBody(linearVelocity=[part * self._speed for part in pace])
        body.CreateFixture(shape=shape, friction=0.0, restitution=self._restitution)
        body.userData = name

    def _listen(self) -> Any:
        """What Box2D calls with every impulse; an exception in there would be lost in C."""
        pushed = self._pushed

        class Listener(self._b2.b2ContactListener):
            def PostSolve(self, contact: Any, impulse: Any) -> None:
                if impulse.normalImpulses and impulse.normalImpulses[0] > 0.0:
                    pushed.append((contact.fixtureA.body.userData, contact.fixtureB.body.userData))

        return Listener()

    def step(self) -> Sequence[tuple[str, str]]:
        """See `World`."""
        self._pushed.clear()
        self._world.Step(self._engine.dt / QUICK, self._engine.iterations, 0)
        self._time += self._engine.dt
        return list(self._pushed)

    def rows(self) -> list[Row]:
        """See `World`.

        Raises:
            OutOfRoom: where a circle has come to the end of an edge that stands for a wall.
        """
        found: list[Row] = []
        for body, moves in zip(self._bodies, self._moving, strict=True):
            (x, y), (vx, vy) = body.position, body.linearVelocity
            row = (x / self._metres, y / self._metres, vx / self._speed, vy / self._speed)
            found.append(row)
            if moves and math.hypot(vx, vy) * self._engine.dt / QUICK >= FARTHEST * NEARLY:
                raise OutOfRoom(f"{body.userData!r} would go farther in a step than the {FARTHEST:g} m of Box2D's")
            if moves and not all(stretch.beside(row[0], row[1], self._time) for stretch in self._stretches):
                raise OutOfRoom(f"{body.userData!r} has come to the end of an edge that stands for a wall")
        return found

    def place(self, rows: Sequence[Row]) -> None:
        """See `World`."""
        for body, moves, (x, y, vx, vy) in zip(self._bodies, self._moving, rows, strict=True):
            if moves:
                body.position = (x * self._metres, y * self._metres)
                body.linearVelocity = (vx * self._speed, vy * self._speed)


def metres(scene: Scene, engine: Box2DEngine) -> float:
    """Box2D's metres for a unit of length: a power of two that makes radii about 1 m, and steps short enough.

    Raises:
        SceneError: where no circle could go as far as a hundredth of its radius in the longest step that Box2D allows.
    """
    radii = [float(circle.r) for circle in scene.circles if circle.r.sign()]
    scale, stride = power_of_two(2 / max(radii, default=1.0)), top_speed(scene) * engine.dt
    if stride:
        scale = min(scale, power_of_two(FARTHEST / stride))
    if radii and scale * min(radii) < 1 / 128:
        raise SceneError(
            f"{scene.name!r}: the smallest circle, of radius {min(radii):.3g}, is too small beside a step of up to "
            f"{stride:.3g}: engine 'box2d' cuts a step off at {FARTHEST:g} m, and takes 1/200 m for nothing; reduce dt"
        )
    return scale
