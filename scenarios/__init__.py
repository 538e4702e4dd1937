"""The shared words: exact numbers, circles, walls, scenes, events, trajectories, and the engine contract."""

from .engine import Engine
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
