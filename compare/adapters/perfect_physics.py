"""The adapter of perfect-physics, Carl Kadie's engine of the article: SymPy throughout."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...scenarios.errors import SceneError
from .adapter import Adapted, package

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ..foreign.recording import Recording


@dataclass(frozen=True)
class PerfectPhysicsEngine(Adapted):
    """Plays scenes in perfect-physics 0.1.9: exact expressions, from event to event; what is handed on is in doubles.

    Its expressions grow with every event, and so does the time that SymPy takes to simplify them; two are taken for
    equal, or one for zero, where SymPy says so. Collisions at one instant come one after the other, in an order that it
    shuffles by a seed of its own.

    Attributes:
        max_events: instants after which a run stops with `StopReason.BUDGET`.
        max_size: operations of all numbers of the circles, after which it stops with that too: the next instant would
            take SymPy very long.
        max_pairs: pairs of circles, and of a circle and a wall, of a scene that it takes on: SymPy simplifies a
            solution for each of those at the first instant.

    >>> PerfectPhysicsEngine().bits is None
    True
    """

    distribution = "perfect-physics"
    name = "perfect-physics"
    bits = None
    rounds_input = False
    max_events: int = 100
    max_size: int = 2_000
    max_pairs: int = 28

    def __post_init__(self) -> None:
        for key in ("max_events", "max_size", "max_pairs"):
            self.check_count(key)

    @property
    def scene_keys(self) -> frozenset[str]:
        """Walls and pockets, and a reversal after a number of events, not at a time."""
        return frozenset({"wall", "pocket", "reverse_after"})

    def play(self, scene: Scene, recording: Recording) -> None:
        """Goes from instant to instant.

        Raises:
            SceneError: for a fixed circle, and for more pairs than `max_pairs`.
            NotInstalled: without perfect-physics.
        """
        count = len(scene.circles)
        pairs = count * (count - 1) // 2 + count * len(scene.walls)
        if pairs > self.max_pairs:
            raise SceneError(
                f"{scene.name!r}: {pairs} pairs: engine 'perfect-physics' has SymPy simplify a solution for each; "
                f"{self.max_pairs} are allowed; raise max_pairs, or use another engine"
            )
        world, timeline = world_of(scene), package("perfect_physics._timeline", "perfect-physics")
        hints: list[Any] = []
        turned = False
        for done in range(self.max_events):
            if not recording.open:
                return
            if done and (size := _size(world)) > self.max_size:
                recording.spent(f"expressions of {size:,} operations; raise max_size")
                return
            told = timeline.Timeline()
            instant, hints = world._tick(told, hints)
            if not instant[2]:
                return
            world._tock(instant, told)
            rows = {c.id: tuple(float(getattr(c, key)) for key in ("x", "y", "vx", "vy")) for c in world.circle_list}
            for event in told.events:
                if isinstance(event, timeline.Collision):
                    states = {thing.id: rows[thing.id] for thing in event.after if thing.id in rows}
                    recording.hit(float(world.clock), event.after[0].id, event.after[1].id, states)
            if recording.reversal is not None and not turned:
                turned, hints = True, []
                for circle in world.circle_list:
                    circle.vx, circle.vy = -circle.vx, -circle.vy
        recording.spent(f"{self.max_events:,} instants; raise max_events")


def world_of(scene: Scene) -> Any:
    """A scene as a world of perfect-physics, in exact numbers.

    Raises:
        SceneError: for a fixed circle.
        NotInstalled: without perfect-physics.
    """
    theirs = package("perfect_physics", "perfect-physics")
    for circle in scene.circles:
        if circle.fixed:
            raise SceneError(
                f"circle {circle.id!r}: is fixed: the formulas of engine 'perfect-physics' have no infinite mass; "
                "give it a mass, or use another engine"
            )
    circles = [
        theirs.Circle(*(getattr(c, key).sympy() for key in ("x", "y", "r", "vx", "vy", "m")), id=str(c.id))
        for c in scene.circles
    ]
    walls = [
        theirs.Wall(*(getattr(w, key).sympy() for key in ("x0", "y0", "x1", "y1")), id=str(w.id)) for w in scene.walls
    ]
    return theirs.World(circles, walls)


def _size(world: Any) -> int:
    """Operations of all numbers of the circles."""
    return sum(int(getattr(c, key).count_ops()) for c in world.circle_list for key in ("x", "y", "vx", "vy"))
