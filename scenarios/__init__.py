"""The shared words: exact numbers, circles, walls, scenes, events, trajectories, and the engine contract."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .engine import Declared, Engine
    from .errors import SceneError
    from .event import Contact, Event
    from .numbers.quantity import Quantity
    from .scene import Scene
    from .things import Circle, Pocket, Wall
    from .tie_policy import TiePolicy
    from .trajectory import State, Stop, StopReason, Trajectory

__all__ = [
    "Circle",
    "Contact",
    "Declared",
    "Engine",
    "Event",
    "Pocket",
    "Quantity",
    "Scene",
    "SceneError",
    "State",
    "Stop",
    "StopReason",
    "TiePolicy",
    "Trajectory",
    "Wall",
]

_HOMES = {
    "Circle": "things",
    "Contact": "event",
    "Declared": "engine",
    "Engine": "engine",
    "Event": "event",
    "Pocket": "things",
    "Quantity": "numbers.quantity",
    "Scene": "scene",
    "SceneError": "errors",
    "State": "trajectory",
    "Stop": "trajectory",
    "StopReason": "trajectory",
    "TiePolicy": "tie_policy",
    "Trajectory": "trajectory",
    "Wall": "things",
}
"""The module of each name: imported when it is asked for, so that an error message loads no numbers."""


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f".{_HOMES[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
