"""The shared words: exact numbers, circles, walls, scenes, events, trajectories, and the engine contract."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .lazy import handed_on

if TYPE_CHECKING:
    from .engine import Declared, Engine
    from .errors import Disturbed, SceneError
    from .numbers.quantity import Quantity
    from .scene import Scene
    from .settings import TiePolicy
    from .things import Arc, Circle, Pocket, Polygon, Segment, Wall
    from .trajectory import Contact, Event, State, Stop, StopReason, Trajectory

__all__ = [
    "Arc",
    "Circle",
    "Contact",
    "Declared",
    "Disturbed",
    "Engine",
    "Event",
    "Pocket",
    "Polygon",
    "Quantity",
    "Scene",
    "SceneError",
    "Segment",
    "State",
    "Stop",
    "StopReason",
    "TiePolicy",
    "Trajectory",
    "Wall",
]

_HOMES = {
    "Arc": "things",
    "Circle": "things",
    "Contact": "trajectory",
    "Declared": "engine",
    "Disturbed": "errors",
    "Engine": "engine",
    "Event": "trajectory",
    "Pocket": "things",
    "Polygon": "things",
    "Quantity": "numbers.quantity",
    "Scene": "scene",
    "SceneError": "errors",
    "Segment": "things",
    "State": "trajectory",
    "Stop": "trajectory",
    "StopReason": "trajectory",
    "TiePolicy": "settings",
    "Trajectory": "trajectory",
    "Wall": "things",
}
"""The module of each name: imported when it is asked for, so that an error message loads no numbers."""

__getattr__, __dir__ = handed_on(__name__, _HOMES)
