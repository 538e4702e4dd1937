"""The adapter of pooltool, Evan Kiefl's simulator of pool: event-driven, with sliding, rolling and spinning balls."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...scenarios.errors import SceneError
from .adapter import Adapted, package, power_of_two, stretches

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ..foreign.impulses import Row
    from ..foreign.recording import Recording


SPACER = 1e-9
"""Metres: before every impulse pooltool moves the two along their line until they are so far apart (`make_kiss`, by its
constants.EPS_SPACE), whatever they were."""

TURNED = complex(math.cos(1.0), math.sin(1.0))
"""Scenes are turned by one radian, so that no wall lies along an axis, for which pooltool has a case of its own."""


MOST_SLOWED = 2.0
"""No ball is slowed by as many times `friction` (each by another, so that none are alike)."""

SPIN = 2.0**-10
"""Of a ball, as the speed of its rim; friction then does not act in the very direction of the flight, for which, where
that is the direction of a cushion, pooltool divides by zero."""


@dataclass(frozen=True)
class PooltoolEngine(Adapted):
    """Plays scenes in pooltool 0.3.3: doubles, from event to event.

    Ball on ball is its frictionless elastic model, ball on cushion its mirror ("unrealistic") without loss; walls are
    cushions long enough for the scene, fixed circles its round cushions. Its equation for the time of a collision needs
    some friction: the least that it solves is a parameter, and known. Balls that have met are put 1e-9 of its metres
    apart. It holds balls of one radius and one mass.

    Attributes:
        friction: by how much a ball is slowed, in pooltool's metres and a scene's units of time.
        metres: pooltool's metres for the radius of a ball, about; so 1e-9 of them are a smaller share of it.
        max_events: events after which a run stops with `StopReason.BUDGET`, those counted at which balls come to slide,
            roll or rest.

    >>> PooltoolEngine().bits
    53
    """

    distribution = "pooltool-billiards"
    name = "pooltool"
    bits = 53
    pair_microseconds = 6.0
    friction: float = 1e-9
    metres: float = 1.0
    max_events: int = 1_000_000

    def __post_init__(self) -> None:
        self.check_positive("friction")
        self.check_positive("metres")
        self.check_count("max_events")

    @property
    def scene_keys(self) -> frozenset[str]:
        """Walls, and pockets that take nothing: it tells no time of a collision as near as one is after a reversal."""
        return frozenset({"wall", "pocket"})

    def allows(self, scene: Scene) -> dict[str, float]:
        """The margin that it keeps between what has met, and the friction of its cloth, in the scene's units."""
        metres = metres_of(scene, self)
        return {"margin": SPACER / metres, "deceleration": MOST_SLOWED * self.friction / metres}

    def play(self, scene: Scene, recording: Recording) -> None:
        """Goes from event to event.

        Raises:
            SceneError: for balls of several radii or masses, and a point ball.
            NotInstalled: without pooltool.
        """
        shot = Shot(scene, self)
        for _ in range(self.max_events):
            if not recording.open:
                return
            try:
                event = shot.next()
            except (ArithmeticError, ValueError) as error:
                recording.spent(f"pooltool cannot solve for the next event: {error}")
                return
            if event.time == math.inf:
                return
            met = shot.do(event)
            if met is not None:
                rows = shot.rows()
                recording.hit(float(event.time), *met, {name: rows[name] for name in met if name in rows})
            if not shot.has_room:
                recording.spent("a ball has come to the end of a cushion that stands for a wall")
        recording.spent(f"{self.max_events:,} events; raise max_events")


class Shot:
    """A scene in pooltool's terms, played event by event: the loop is that of its own `simulate`."""

    def __init__(self, scene: Scene, engine: PooltoolEngine) -> None:
        radius = check_balls(scene)
        self._loop: Any = package("pooltool.evolution.event_based.simulate", "pooltool")
        self._pt: Any = package("pooltool", "pooltool")
        self._metres = metres_of(scene, engine)
        self._radius = radius * self._metres
        self._stretches = stretches(scene)
        self._names = scene.ids
        self._physics = self._frictionless()
        rows = {str(c.id): (float(c.x), float(c.y), float(c.vx), float(c.vy)) for c in scene.circles if not c.fixed}
        self._shot: Any = self._pt.System(cue=self._pt.Cue(), table=self._table(scene), balls=self._balls(rows, engine))
        self.place(rows)

    def _balls(self, names: Iterable[str], engine: PooltoolEngine) -> dict[str, Any]:
        """The balls, each slowed by a little more than the one before: for two slowed alike it finds no time at all."""
        found: dict[str, Any] = {}
        for number, name in enumerate(names):
            slowed = engine.friction * (1 + number / 64)
            slowing = {"u_s": slowed, "u_r": slowed, "u_sp_proportionality": slowed, "g": 1.0}
            found[name] = self._pt.Ball.create(name, R=self._radius, m=1.0, e_c=1.0, f_c=0.0, **slowing)
        return found

    def _frictionless(self) -> Any:
        resolve: Any = package("pooltool.physics.resolve.resolver", "pooltool")
        config = resolve.ResolverConfig(
            ball_ball=resolve.BallBallModel.FRICTIONLESS_ELASTIC,
            ball_ball_params={},
            ball_linear_cushion=resolve.BallLCushionModel.UNREALISTIC,
            ball_linear_cushion_params={"restitution": False},
            ball_circular_cushion=resolve.BallCCushionModel.UNREALISTIC,
            ball_circular_cushion_params={"restitution": False},
            ball_pocket=resolve.BallPocketModel.CANONICAL,
            ball_pocket_params={},
            stick_ball=resolve.StickBallModel.INSTANTANEOUS_POINT,
            stick_ball_params={"throttle_english": True},
            transition=resolve.BallTransitionModel.CANONICAL,
            transition_params={},
        )
        return package("pooltool.physics.engine", "pooltool").PhysicsEngine(resolve.Resolver.from_config(config))

    def _table(self, scene: Scene) -> Any:
        parts: Any = package("pooltool.objects.table.components", "pooltool")
        numpy: Any = package("numpy", "pooltool")

        def point(x: float, y: float) -> Any:
            return numpy.array([*self._to(x, y), self._radius])

        linear = {
            str(wall.id): parts.LinearCushionSegment(str(wall.id), point(*stretch.start), point(*stretch.end))
            for wall, stretch in zip(scene.walls, self._stretches, strict=True)
        }
        circular = {
            str(c.id): parts.CircularCushionSegment(str(c.id), point(float(c.x), float(c.y)), float(c.r) * self._metres)
            for c in scene.circles
            if c.fixed
        }
        return self._pt.Table(parts.CushionSegments(linear, circular), {}, self._pt.TableType.BILLIARD)

    def next(self) -> Any:
        """The next event, at an infinite time if there is none."""
        return self._loop.get_next_event(
            self._shot, transition_cache=self._transitions, quartic_solver=self._loop.QuarticSolver.NUMERIC
        )

    def do(self, event: Any) -> tuple[str, str] | None:
        """Goes to an event and resolves it; who met whom, if anybody did."""
        self._loop._evolve(self._shot, event.time - self._shot.t)
        self._physics.resolver.resolve(self._shot, event)
        self._transitions.update(event)
        self._shot.t = event.time
        if not event.event_type.is_collision():
            return None
        first, second = (agent.id for agent in event.agents)
        return first, second

    def rows(self) -> dict[str, Row]:
        """x, y, vx, vy of every ball, in the scene's units."""
        found: dict[str, Row] = {}
        for name, ball in self._shot.balls.items():
            at, flight = (complex(row[0], row[1]) / TURNED / self._metres for row in ball.state.rvw[:2])
            found[name] = (at.real, at.imag, flight.real, flight.imag)
        return found

    def _to(self, x: float, y: float) -> tuple[float, float]:
        """A vector of the scene in pooltool's metres and directions."""
        turned = complex(x, y) * TURNED * self._metres
        return turned.real, turned.imag

    @property
    def has_room(self) -> bool:
        """Whether every ball is beside the cushions that stand for walls."""
        return all(stretch.beside(*row[:2]) for row in self.rows().values() for stretch in self._stretches)

    def place(self, rows: dict[str, Row]) -> None:
        """Puts every ball where a row says, sliding, or at rest."""
        const = self._pt.constants
        for name, (x, y, vx, vy) in rows.items():
            state = self._shot.balls[name].state
            state.rvw[0] = [*self._to(x, y), self._radius]
            state.rvw[1] = [*self._to(vx, vy), 0.0]
            state.rvw[2] = [SPIN * self._metres / self._radius, 0.0, 0.0]
            state.s = const.sliding if vx or vy else const.stationary
        self._transitions = self._loop.TransitionCache.create(self._shot)


def metres_of(scene: Scene, engine: PooltoolEngine) -> float:
    """Pooltool's metres for a unit of length of the scene: a power of two times those asked for."""
    radii = [float(circle.r) for circle in scene.circles if not circle.fixed]
    return engine.metres * power_of_two(1 / (radii[0] if radii else 1.0))


def check_balls(scene: Scene) -> float:
    """The one radius of all circles that move.

    Raises:
        SceneError: for several radii or masses, and a point ball.
    """
    moving = [circle for circle in scene.circles if not circle.fixed]
    for circle in moving:
        for key in ("r", "m"):
            if getattr(circle, key) != getattr(moving[0], key):
                raise SceneError(
                    f"circle {circle.id!r}: {key} differs from that of {moving[0].id!r}: engine 'pooltool' 0.3.3 has "
                    "balls of one radius and one mass; use another engine"
                )
        if not circle.r.sign():
            raise SceneError(f"circle {circle.id!r}: r = 0: engine 'pooltool' has no point balls; use another engine")
    return float(moving[0].r) if moving else 1.0
