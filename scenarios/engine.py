"""The one contract that every engine keeps."""

from __future__ import annotations

import sys
from types import FrameType
from typing import Any, ClassVar, Protocol

from .errors import SceneError
from .numbers.quantity import Quantity, QuantityLike
from .scene import Scene
from .settings import positive_count, positive_time
from .trajectory import OnProgress, Trajectory

DEFAULT_EVENTS = 1_000
"""Limit on instants where neither the caller nor the scene sets a horizon."""


SCENE_KEYS = frozenset(
    {"wall", "segment", "pocket", "capture", "reverse_at", "reverse_after", "tie_policy", "restitution"}
)
"""What a scene may ask of an engine beyond its circles: keys of a scene file."""

ALL_KEYS = SCENE_KEYS | {"polygon", "arc", "gravity", "settle", "fixed", "moving walls", "wall kinds"}
"""These, and the keys that an engine follows only where it says so: `Declared` leaves them out. `moving walls` have a
`vx` or `vy`; `fixed` is a circle that stands under gravity; `wall kinds` are those that recipes add to `WALL_KINDS`."""


class Engine(Protocol):
    """Runs scenes, and declares what it is. Engines are frozen dataclasses: their fields are their parameters.

    Whoever judges an engine goes by what it declares, never by its name. `Declared` has the declarations of an
    event-driven engine that follows every key of a scene; an engine derived from it states only what differs.
    """

    @property
    def name(self) -> str:
        """The name by which the command line and reports call the engine."""
        ...

    @property
    def step(self) -> float | None:
        """The time step of an engine that advances by steps; None for an event-driven one."""
        ...

    @property
    def bits(self) -> int | None:
        """Bits of its numbers, 53 for doubles; None for numbers that are exact, or as wide as they need to be."""
        ...

    @property
    def rounds_input(self) -> bool:
        """Whether it replaces every number of a scene by the nearest one of its own `bits`."""
        ...

    @property
    def scene_keys(self) -> frozenset[str]:
        """Those of `ALL_KEYS` that it follows."""
        ...

    def finer(self) -> Engine | None:
        """The same with half the time step, everything else as it is; None if there is none."""
        ...

    def wider(self) -> Engine | None:
        """The same with twice the bits; None if there is none."""
        ...

    def firmer(self) -> Engine | None:
        """The same with twice the solver's iterations; None if it iterates nothing."""
        ...

    def run(
        self,
        scene: Scene,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """The history of `scene` up to a time, a number of instants, or both, whichever comes first.

        With neither, the scene's own default horizon holds, and if it has none, `DEFAULT_EVENTS` instants. Limits
        only end a run: what it has before does not depend on them.
        """
        ...


def refuse_settled(scene: Scene, who: str) -> None:
    """Refuses a scene in which what comes to rest goes on so.

    Raises:
        SceneError: naming who does not follow it, and what to do.

    >>> from truebreak.scenarios import Circle
    >>> refuse_settled(Scene([Circle(0, 9)], gravity=(0, -1), settle=True), "engine 'sympy'")
    Traceback (most recent call last):
      ...
    truebreak.scenarios.errors.SceneError: settle = true: engine 'sympy' does not follow what has settled; use exact, \
or leave settle out
    """
    if scene.settle:
        raise SceneError(f"settle = true: {who} does not follow what has settled; use exact, or leave settle out")


class Unchangeable:
    """What an engine says that cannot be made finer, wider or firmer."""

    def finer(self) -> Engine | None:
        """None: there is no step to halve."""
        return None

    def wider(self) -> Engine | None:
        """None: no wider numbers are to be had."""
        return None

    def firmer(self) -> Engine | None:
        """None: nothing is iterated."""
        return None


class EventDriven(Unchangeable):
    """The declarations of an event-driven engine, but for its `bits`.

    What it declares is of any type here, so that an engine derived from it may state what differs by a class attribute,
    a field or a property; `Engine` has the types.

    Attributes:
        step: none: event-driven (see `Engine.step`).
        rounds_input: takes a scene's numbers as they are (see `Engine.rounds_input`).
        scene_keys: follows `SCENE_KEYS` (see `Engine.scene_keys`).
    """

    step: Any = None
    rounds_input: Any = False
    scene_keys: Any = SCENE_KEYS


class Declared(EventDriven):
    """The declarations of an event-driven engine of exact numbers, for engines to derive from.

    >>> Declared().step, Declared().rounds_input, Declared().finer()
    (None, False, None)

    Attributes:
        bits: as many as it takes (see `Engine.bits`).
    """

    bits: Any = None


def horizon(scene: Scene, until: QuantityLike | None, events: int | None) -> tuple[Quantity | None, int | None]:
    """The limits that hold for a run: the caller's, else the scene's, else `DEFAULT_EVENTS`.

    Raises:
        SceneError: for a limit that is not above zero.
    """
    time, count = positive_time("until", until), positive_count("events", events)
    if time is None and count is None:
        time, count = scene.until, scene.events
    if time is None and count is None:
        count = DEFAULT_EVENTS
    return time, count


class endable:  # a function to whoever calls it
    """`with endable():` in the body `TimeIsUp` may come at any place, since the engine around it catches that.

    An alarm that rings elsewhere is let be, and rings again.

    Attributes:
        frames: whose bodies are at work now.
    """

    frames: ClassVar[set[FrameType]] = set()

    __slots__ = ("_frame",)

    def __enter__(self) -> None:
        self._frame = sys._getframe(1)  # pyright: ignore[reportPrivateUsage]
        endable.frames.add(self._frame)

    def __exit__(self, *_: object) -> None:
        endable.frames.discard(self._frame)
