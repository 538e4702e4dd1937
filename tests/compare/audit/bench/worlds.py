"""What an engine of the bench keeps between two steps, in numbers of any type.

The engines of this folder are written once for all number types: an engine in doubles is run again, from its own state,
in numbers of 60 digits, and what a planted bug does is then seen without any rounding.
"""

from __future__ import annotations

import math
from copy import copy
from fractions import Fraction
from typing import Any, NamedTuple

import mpmath
import numpy as np


class Numbers(NamedTuple):
    """A number type: how a number of it is made, and the functions that the engines need."""

    name: str
    of: Any
    sqrt: Any
    hypot: Any
    atan2: Any
    sin: Any
    cos: Any
    floor: Any


def _narrow(kind: Any) -> Numbers:
    return Numbers(kind.__name__, kind, np.sqrt, np.hypot, np.arctan2, np.sin, np.cos, lambda v: math.floor(float(v)))


PRECISE: Any = mpmath.MPContext()
PRECISE.dps = 60


def precisely(value: Any) -> Any:
    """A number of any type in 60 digits, exactly where it has fewer."""
    if isinstance(value, Fraction):
        return PRECISE.mpf(value.numerator) / value.denominator
    if isinstance(value, np.longdouble):
        high = float(value)
        return PRECISE.mpf(high) + float(value - np.longdouble(high))
    return PRECISE.mpf(float(value) if isinstance(value, np.floating) else value)


F64 = Numbers(
    "double",
    float,
    math.sqrt,
    math.hypot,
    math.atan2,
    math.sin,
    math.cos,
    math.floor,
)
F32 = _narrow(np.float32)
LONG = _narrow(np.longdouble)
MP = Numbers(
    "60 digits",
    precisely,
    PRECISE.sqrt,
    PRECISE.hypot,
    PRECISE.atan2,
    PRECISE.sin,
    PRECISE.cos,
    lambda v: int(PRECISE.floor(v)),
)


class Told(NamedTuple):
    """What an engine reports of one contact, or of one step: a time, the pairs, and states by id (or None)."""

    time: Any
    pairs: tuple[tuple[str, str], ...]
    states: dict[str, tuple[Any, Any, Any, Any]] | None


class Line(NamedTuple):
    """A wall: a point of it, its unit normal, and its two points as given."""

    x: Any
    y: Any
    nx: Any
    ny: Any


class World:
    """Circles and walls as an engine keeps them.

    Attributes:
        ids: of the circles, then of the walls.
        n: how many circles.
        r, m, w: radii, masses (None: fixed) and inverse masses.
        x, y, vx, vy: places and velocities at time t.
        walls, sides: the walls, and on which side of each (1 or -1) each circle is.
        count: contacts so far.
        more: what an engine keeps besides.
    """

    def __init__(self, scene: Any, numbers: Numbers) -> None:
        of = numbers.of
        self.ids = list(scene.ids)
        self.n = len(scene.circles)
        self.t = of(0.0)
        self.x, self.y, self.vx, self.vy, self.r = (
            [of(float(getattr(c, key))) for c in scene.circles] for key in ("x", "y", "vx", "vy", "r")
        )
        self.m = [None if c.fixed else of(float(c.m)) for c in scene.circles]
        self.w = [of(0.0) if m is None else 1 / m for m in self.m]
        self.walls: list[Line] = []
        for wall in scene.walls:
            x0, y0, x1, y1 = (of(float(v)) for v in (wall.x0, wall.y0, wall.x1, wall.y1))
            length = numbers.hypot(y0 - y1, x1 - x0)
            self.walls.append(Line(x0, y0, (y0 - y1) / length, (x1 - x0) / length))
        self.sides = [[1 if w.height(c.x, c.y).sign() >= 0 else -1 for w in scene.walls] for c in scene.circles]
        self.count = 0
        self.turn = scene.reverse_after
        self.more: dict[str, Any] = {}

    def lifted(self) -> World:
        """The same in numbers of 60 digits."""
        return self._mapped(precisely)

    def copied(self) -> World:
        """The same once more, of which the one may go on without the other."""
        return self._mapped(lambda value: value)

    def _mapped(self, change: Any) -> World:
        twin = copy(self)
        for key, value in vars(self).items():
            setattr(twin, key, _mapped(value, change))
        return twin

    def row(self, k: int) -> tuple[Any, Any, Any, Any]:
        """x, y, vx, vy of a circle."""
        return self.x[k], self.y[k], self.vx[k], self.vy[k]


def _mapped(value: Any, change: Any) -> Any:
    if isinstance(value, float | np.floating):
        return change(value)
    if isinstance(value, list | tuple):
        items = [_mapped(item, change) for item in value]
        return type(value)(*items) if hasattr(value, "_fields") else type(value)(items)
    if isinstance(value, dict):
        return {key: _mapped(item, change) for key, item in value.items()}
    return value
