"""What the adapters of engines that go by time steps share: the loop, the reversal, the budget."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

from ....scenarios.engine import SCENE_KEYS
from .adapted import Adapted

if TYPE_CHECKING:
    from ....scenarios.scene import Scene
    from ...foreign.runs.impulses import Row
    from ...foreign.runs.recording import Recording

LOOK = 64
"""Steps between two reports of a flight in which nothing happens."""

ENERGY_MARGIN = 2.0
"""Factor on the speed that a scene's energy allows: a solver that has not settled may gain some."""


class OutOfRoom(Exception):
    """A circle has left the part of the plane that the engine's world is made for; the run ends there."""


class World(Protocol):
    """A scene in the engine's own terms, ready to step."""

    def step(self) -> Sequence[tuple[str, str]]:
        """One time step; the pairs between which the engine had an impulse, by ids."""
        ...

    def rows(self) -> list[Row]:
        """x, y, vx, vy of every circle, in the scene's units."""
        ...

    def place(self, rows: Sequence[Row]) -> None:
        """Puts every circle that moves where a row says."""
        ...


@dataclass(frozen=True)
class SteppedAdapter(Adapted):
    """An engine that goes by time steps, adapted: `world` is what a subclass writes.

    An event's time is that of the end of the step that had the impulse; all impulses of one step are one event.

    Attributes:
        dt: the time step, in the scene's unit of time.
        max_steps: steps after which a run stops with `StopReason.BUDGET`.
        step_microseconds: what a step costs, measured: the more, the fewer steps are taken to tell a series.

    Raises:
        SceneError: for a parameter out of its range.
    """

    dt: float = 1 / 256
    max_steps: int = 2_000_000
    step_microseconds: ClassVar[float]

    def __post_init__(self) -> None:
        self.check_positive("dt")
        self.check_count("max_steps")

    @property
    def step(self) -> float:
        """`dt`."""
        return self.dt

    @property
    def scene_keys(self) -> frozenset[str]:
        """All but `capture`, as there are no pockets, and `tie_policy`: the contacts of a step are solved at once."""
        return SCENE_KEYS - {"capture", "tie_policy"}

    def finer(self) -> SteppedAdapter:
        """Half the time step, and room for twice the steps."""
        return replace(self, dt=self.dt / 2, max_steps=2 * self.max_steps)

    def firmer(self) -> SteppedAdapter | None:
        """Twice the solver's iterations, if it has a field of that name."""
        settings: Any = {f.name: 2 * getattr(self, f.name) for f in fields(self) if f.name == "iterations"}
        return replace(self, **settings) if settings else None

    @abstractmethod
    def world(self, scene: Scene) -> World:
        """The scene in the engine's own terms.

        Raises:
            SceneError: for a scene that it cannot hold.
        """

    def play(self, scene: Scene, recording: Recording) -> None:
        """Steps on while the recording is open; ends it where the world has no more room."""
        try:
            self._steps(scene, recording)
        except OutOfRoom as error:
            recording.spent(str(error))

    def _steps(self, scene: Scene, recording: Recording) -> None:
        world, told = self.world(scene), self.teller(scene, recording)
        turn = math.inf if scene.reverse_at is None else float(scene.reverse_at)
        base, base_step, turned = 0.0, 0, False
        for number in range(1, self.max_steps + 1):
            now = base + (number - base_step) * self.dt
            if now > turn and not turned:
                rows = glided(world.rows(), turn - (now - self.dt))
                told.at_rest(turn, rows)
                world.place([(x, y, -vx, -vy) for x, y, vx, vy in rows])
                base, base_step, turned = turn, number - 1, True
                now = base + self.dt
            pairs = world.step()
            if pairs or told.waiting:
                told.contacts(now, pairs, world.rows())
                if recording.reversal is not None and not turned:
                    turned = True
                    world.place([(x, y, -vx, -vy) for x, y, vx, vy in world.rows()])
            elif number % LOOK == 0:
                told.at_rest(now, world.rows())
            else:
                continue
            if not recording.open:
                return
        if recording.open:
            recording.spent(f"{self.max_steps:,} steps of {self.dt!r}; raise max_steps, or dt")

    def teller(self, scene: Scene, recording: Recording) -> Teller:
        """What tells the recording of a step with contacts."""
        return Teller(scene, recording)


class Teller:
    """Tells a recording what each step brought, of an engine whose collisions take one step."""

    def __init__(self, scene: Scene, recording: Recording) -> None:
        self.scene, self.recording = scene, recording

    @property
    def waiting(self) -> bool:
        """Whether something is still to be told, though nothing touches."""
        return False

    def contacts(self, now: float, pairs: Sequence[tuple[str, str]], rows: Sequence[Row]) -> None:
        """A step at whose end things are so, and in which these pairs had an impulse."""
        self.recording.hits(now, pairs, dict(zip(self.circles, rows, strict=True)))

    def at_rest(self, now: float, rows: Sequence[Row]) -> None:
        """A time at which nothing touches."""
        self.recording.state(now, rows)

    @property
    def circles(self) -> list[str]:
        """The circles' ids."""
        return [str(circle.id) for circle in self.scene.circles]


def glided(rows: Sequence[Row], time: float) -> list[Row]:
    """Rows after straight flight of so long.

    >>> glided([(0.0, 0.0, 1.0, -2.0)], 0.5)
    [(0.5, -1.0, 1.0, -2.0)]
    """
    return [(x + vx * time, y + vy * time, vx, vy) for x, y, vx, vy in rows]


def top_speed(scene: Scene) -> float:
    """What the lightest circle would do with all of the energy, times `ENERGY_MARGIN`.

    >>> from truebreak.scenarios import Circle, Scene
    >>> top_speed(Scene([Circle(0, 0, vx=3, m=4), Circle(9, 0)]))
    12.0
    """
    moving = [circle for circle in scene.circles if not circle.fixed]
    shares = [float(circle.inverse_mass) for circle in moving]
    squares = [(float(c.vx) ** 2 + float(c.vy) ** 2) / w for c, w in zip(moving, shares, strict=True)]
    return ENERGY_MARGIN * math.sqrt(max(shares, default=0.0) * sum(squares))


def power_of_two(value: float) -> float:
    """The greatest power of two that is not above a number: scaling by it rounds nothing.

    >>> power_of_two(0.3), power_of_two(4.0)
    (0.25, 4.0)
    """
    return 2.0 ** math.floor(math.log2(value))
