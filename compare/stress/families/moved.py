"""One scene far from the origin."""

from __future__ import annotations

from ....scenarios import catalogue
from ....scenarios.numbers.quantity import Quantity
from ....scenarios.scene import Scene
from ....scenarios.things import Circle, Wall
from ..family import Family

EVENTS = 8


def moved(k: int, side: str, seed: int) -> Scene:
    """Four discs in a box, 10**k to the right and up, or to the left and down.

    >>> moved(12, "out", 1).walls[0].x0.text()
    '1000000000000'
    """
    d = Quantity.of(10) ** k * (1 if side == "out" else -1)
    base = catalogue.build("gas", n=4, seed=seed)
    circles = [Circle(c.x + d, c.y + d, c.r, c.vx, c.vy, c.m, c.id) for c in base.circles]
    walls = [Wall(w.x0 + d, w.y0 + d, w.x1 + d, w.y1 + d, w.id) for w in base.walls]
    return Scene(circles, walls, events=EVENTS)


FAMILY = Family(
    name="moved",
    summary="Four discs in a box for 8 instants, the box 10**k away from the origin in x and in y.",
    grows="10**k is the distance",
    make=moved,
    first=0,
    last=40,
    most=300,
    sides=("out", "back"),
    seeds=(1,),
)
