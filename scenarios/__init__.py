"""The shared words: exact numbers, circles, walls, scenes, events, trajectories, and the engine contract."""

from .engine import Declared, Engine
from .errors import SceneError
from .quantity import Quantity
from .scene import Circle, Pocket, Scene, Wall
from .tie_policy import TiePolicy
from .trajectory import Contact, Event, State, Stop, StopReason, Trajectory

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
