"""One scene far from the origin."""

from __future__ import annotations

from ....scenarios import catalogue
from ....scenarios.numbers.quantity import Quantity
from ....scenarios.scene import Scene
from ....scenarios.things import Circle, Wall
from ..family import Family

EVENTS = 8


def moved(k: int, side: str, seed: int) -> Scene:
    """Four discs in a box, 10**k to the right, or to the left and down.

    >>> scene = moved(12, "aslant", 1)
    >>> scene.walls[0].x0.text(), scene.walls[2].y0.text()
    ('-1000000000000', '-1000000000000')
    """
    far = Quantity.of(10) ** k
    dx, dy = (far, 0 * far) if side == "along" else (-far, -far)
    base = catalogue.build("gas", n=4, seed=seed)
    circles = [Circle(c.x + dx, c.y + dy, c.r, c.vx, c.vy, c.m, c.id) for c in base.circles]
    walls = [Wall(w.x0 + dx, w.y0 + dy, w.x1 + dx, w.y1 + dy, w.id) for w in base.walls]
    return Scene(circles, walls, events=EVENTS)


FAMILY = Family(
    name="moved",
    summary="Four discs in a box for 8 instants, the box 10**k away from the origin, in x or in both x and y.",
    grows="10**k is the distance",
    make=moved,
    first=0,
    last=40,
    most=300,
    sides=("along", "aslant"),
    seeds=(1,),
)
