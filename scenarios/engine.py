"""The one contract that every engine keeps."""

from __future__ import annotations

from typing import Protocol

from .limits import positive_count, positive_time
from .numbers.quantity import Quantity, QuantityLike
from .scene import Scene
from .trajectory import OnProgress, Trajectory

DEFAULT_EVENTS = 1_000
"""Limit on instants where neither the caller nor the scene sets a horizon."""


class Engine(Protocol):
    """Runs scenes. Engines are frozen dataclasses: their fields are their parameters."""

    @property
    def name(self) -> str:
        """The name by which the command line and reports call the engine."""
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

        With neither, the scene's own default horizon holds, and if it has none, `DEFAULT_EVENTS` instants.
        """
        ...


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
