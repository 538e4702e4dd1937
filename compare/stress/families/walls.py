"""A ball between two walls that are almost parallel."""

from __future__ import annotations

from ....scenarios.numbers.quantity import Quantity
from ....scenarios.scene import Scene
from ....scenarios.things import Circle, Wall
from ..family import Family


def wedge(k: int, side: str, seed: int) -> Scene:
    """A ball goes from wall to wall at 45 degrees, and exactly grazes an obstacle, were the walls parallel.

    The upper one is tilted by 10**-k about its point above the start. The obstacle is 1/4 in radius, 5/4 beside the
    ball's way up from (40, 1) to (42, 3).

    >>> wedge(5, "opening", 0).walls[1].y1.text()
    '400001/100000'
    """
    tilt = Quantity.of(10) ** -k * (1 if side == "opening" else -1)
    beside = Quantity.of("5/8") * Quantity.of("sqrt(2)")
    obstacle = Circle(Quantity.of("203/5") + beside, Quantity.of("8/5") - beside, r="1/4", m="oo", id="obstacle")
    walls = [Wall(0, 0, 1, 0, id="lower"), Wall(0, 4, 1, 4 + tilt, id="upper")]
    return Scene([Circle(0, 1, vx=1, vy=1, id="ball"), obstacle], walls, events=24)


FAMILY = Family(
    name="walls",
    summary="A ball flies from wall to wall 20 times, and then past an obstacle; one wall is tilted by 10**-k.",
    grows="10**-k is the slope between the walls",
    make=wedge,
    first=4,
    last=40,
    most=300,
    sides=("opening", "closing"),
)
