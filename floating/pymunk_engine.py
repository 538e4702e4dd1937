"""The pymunk engine: a scene played by the game engine Chipmunk, by time steps."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace
from typing import Any

import pymunk

from ..scenarios.engine import ALL_KEYS, Declared
from ..scenarios.errors import SceneError
from ..scenarios.numbers.quantity import QuantityLike
from ..scenarios.scene import Scene
from ..scenarios.trajectory import OnProgress, Trajectory
from .pymunk_run import Run
from .pymunk_space import (
    COLLISION_PERSISTENCE,
    DAMPING,
    ELASTICITY,
    FALLING_FOR,
    FRICTION,
    GRAVITY,
    PymunkSpace,
    build_space,
)

DEFAULT_MAX_STEPS = 10_000_000
"""Some fifteen seconds for ten circles."""


@dataclass(frozen=True)
class PymunkEngine(Declared):
    """Plays scenes in pymunk, the one engine here that shares no formula with the others.

    Pymunk knows no collision times. At every step it moves each circle on by `dt`, finds the circles that
    overlap by then, and gives each overlapping pair an impulse. So

    - an event's time is that of the step that found it, late by at most `dt`; circles have flown into each
      other meanwhile, and nothing gives that back, so that errors of the order of `dt` add up;
    - all impulses of one step are one event, with the evidence `TieProof.FLOAT`;
    - a contact is a collision if pymunk gave it an impulse; circles that only touch are none;
    - the order among contacts of one step is pymunk's own, whatever the scene's tie policy;
    - under gravity it moves a circle first, and adds g dt to its velocity after: from a knot on, n steps take it
      g dt**2 n (n - 1) / 2 far, half a step late;
    - `until` and `reverse_at` between two steps are reached by straight flight from the step before.

    The time step never varies within a run: after a change, pymunk rescales the impulse that it keeps for a
    contact that persists, and so can pull circles together that have just bounced.

    Attributes:
        dt: the time step. The default is the power of two next to the 1/240 of a game that makes four
            substeps a frame; step times k/256 are exact in doubles.
        iterations: rounds of pymunk's solver over the contacts of a step; its own default is 10. Steps
            without contacts cost nothing more.
        collision_slop: overlap that pymunk leaves alone; of no effect while `collision_bias` is 1.
        collision_bias: share of an overlap that remains after a unit of time. The default, 1, never pushes
            overlapping circles apart other than by their bounce, so that between knots they fly straight.
            Pymunk's own default is 0.9**60.
        max_steps: steps after which a run stops with `StopReason.BUDGET`.

    Raises:
        SceneError: for a parameter out of its range.

    >>> from truebreak.scenarios import Circle, Scene
    >>> run = PymunkEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 0)]), until=4)
    >>> [(event.time, *event.contacts) for event in run.events]
    [(2.00390625, Contact(first='c1', second='c2'))]
    >>> run.final["c1"].vx, run.final["c2"].vx
    (0.0, 1.0)
    """

    dt: float = 1 / 256
    iterations: int = 64
    collision_slop: float = 0.0
    collision_bias: float = 1.0
    max_steps: int = DEFAULT_MAX_STEPS

    def __post_init__(self) -> None:
        if not 0 < self.dt < math.inf:
            raise SceneError(f"engine 'pymunk': dt = {self.dt!r}: a time step must be above zero, and finite")
        if not 0 <= self.collision_slop < math.inf:
            raise SceneError(f"engine 'pymunk': collision_slop = {self.collision_slop!r}: must be 0 or above")
        if not 0 <= self.collision_bias <= 1:
            raise SceneError(f"engine 'pymunk': collision_bias = {self.collision_bias!r}: not in 0 to 1")
        for key in ("iterations", "max_steps"):
            value = getattr(self, key)
            if isinstance(value, bool) or not isinstance(value, int) or value < 1:
                raise SceneError(f"engine 'pymunk': {key} = {value!r}: must be a whole number from 1")

    @property
    def name(self) -> str:
        """`pymunk`."""
        return "pymunk"

    @property
    def step(self) -> float:
        """`dt`."""
        return self.dt

    @property
    def bits(self) -> int:
        """53: Chipmunk counts in doubles."""
        return 53

    @property
    def rounds_input(self) -> bool:
        """True: a scene is rounded to the nearest doubles."""
        return True

    @property
    def scene_keys(self) -> frozenset[str]:
        """All but `capture`, which pymunk has no notion of, and `tie_policy`: it solves all contacts of a step."""
        return ALL_KEYS - {"capture", "tie_policy", "arc", "wall kinds"}

    def finer(self) -> PymunkEngine:
        """Half the time step, and room for twice the steps."""
        return replace(self, dt=self.dt / 2, max_steps=2 * self.max_steps)

    def firmer(self) -> PymunkEngine:
        """Twice the iterations of pymunk's solver."""
        return replace(self, iterations=2 * self.iterations)

    @property
    def parameters(self) -> dict[str, Any]:
        """All that decides how pymunk plays a scene: the fields, and what is the same in every run."""
        return {
            **asdict(self),
            "collision_persistence": COLLISION_PERSISTENCE,
            "elasticity": ELASTICITY,
            "friction": FRICTION,
            "damping": DAMPING,
            "gravity": GRAVITY,
            "pymunk": pymunk.version,
            "chipmunk": pymunk.chipmunk_version,
        }

    def steps_for(self, scene: Scene) -> int:
        """Steps for which walls reach far enough: `max_steps`; under gravity, or where some move, `FALLING_FOR`."""
        stands = scene.gravity is None and not scene.moving_walls
        return self.max_steps if stands else min(self.max_steps, max(1, int(FALLING_FOR / self.dt)))

    def space(self, scene: Scene) -> PymunkSpace:
        """The scene as a pymunk space; see `build_space`.

        It is made for the longest run that `max_steps` allow, or for `FALLING_FOR`, after which its walls are laid
        anew; never for a limit of the caller's: the ends of its walls depend on it, to the last bit, and a history must
        not depend on when it is to end.
        """
        return build_space(
            scene,
            dt=self.dt,
            duration=self.steps_for(scene) * self.dt,
            iterations=self.iterations,
            slop=self.collision_slop,
            bias=self.collision_bias,
        )

    def run(
        self,
        scene: Scene,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """The history of `scene`; see `Engine.run`.

        With a reversal, and no limit from the caller, the run lasts to twice the time of the reversal. Under gravity,
        and where walls move, nothing shows that nothing will happen any more: with no limit on the time such a run ends
        once `FALLING_FOR` has gone by without an event.

        Raises:
            SceneError: for a limit that is not above zero, for pockets that capture, and arcs, which pymunk
                has no notion of, and as `build_space`.
        """
        if scene.arcs:
            raise SceneError(
                f"{scene.name!r}: has arcs, and engine 'pymunk' has no such shape; use another engine, or a chain "
                "of segments, which is another scene"
            )
        if scene.capture and scene.pockets:
            raise SceneError(
                f"{scene.name!r}: capture = true: engine 'pymunk' cannot take circles out of play; "
                "set capture = false, or use another engine"
            )
        return Run(self, scene, until, events, progress).trajectory()
