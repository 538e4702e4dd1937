"""The shared words: exact numbers, circles, walls, scenes, events, trajectories, and the engine contract."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .lazy.names import handed_on

if TYPE_CHECKING:
    from .engine import Declared, Engine
    from .errors import Disturbed, SceneError
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
    "Disturbed",
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
    "Disturbed": "errors",
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

__getattr__, __dir__ = handed_on(__name__, _HOMES)
