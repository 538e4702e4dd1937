"""One scene in other units of length."""

from __future__ import annotations

from ....scenarios import catalogue
from ....scenarios.numbers.quantity import Quantity
from ....scenarios.scene import Scene
from ....scenarios.things import Circle, Wall
from ..family import Family

EVENTS = 8


def scaled(k: int, side: str, seed: int) -> Scene:
    """Four discs in a box, all lengths and speeds 10**k as large, or as small.

    >>> scaled(12, "down", 1).circles[0].r.text()
    '1/1000000000000'
    """
    s = Quantity.of(10) ** (k if side == "up" else -k)
    base = catalogue.build("gas", n=4, seed=seed)
    circles = [Circle(c.x * s, c.y * s, c.r * s, c.vx * s, c.vy * s, c.m, c.id) for c in base.circles]
    walls = [Wall(w.x0 * s, w.y0 * s, w.x1 * s, w.y1 * s, w.id) for w in base.walls]
    return Scene(circles, walls, events=EVENTS)


FAMILY = Family(
    name="scaled",
    summary="Four discs in a box for 8 instants, every length and speed multiplied by 10**k, or divided by it.",
    grows="10**k is the scale",
    make=scaled,
    first=0,
    last=20,
    most=300,
    sides=("up", "down"),
    seeds=(1, 2),
)
