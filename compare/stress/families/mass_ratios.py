"""A light ball's kick decides which of two heavy ones is first."""

from __future__ import annotations

from ....scenarios.numbers.quantity import Quantity
from ....scenarios.scene import Scene
from ....scenarios.things import Circle
from ..family import Family


def kick(k: int, side: str, seed: int) -> Scene:
    """Lee's three balls, 10**k as heavy, the outer two equally far off; a ball of mass 1 catches one up and pushes it.

    The push changes its speed by 4/(10**k + 1) or 4/(4 * 10**k + 1), so that it is first by about 10**-k.

    >>> [c.m.text() for c in kick(2, "left", 0).circles]
    ['100', '100', '400', '1']
    """
    m = Quantity.of(10) ** k
    heavy = [
        Circle(-12, 0, vx=1, m=m, id="left"),
        Circle(0, 0, m=m, id="middle"),
        Circle(13, 0, r=2, vx=-1, m=4 * m, id="right"),
    ]
    at, speed = (-16, 3) if side == "left" else (18, -3)
    return Scene([*heavy, Circle(at, 0, vx=speed, id="light")], events=12)


FAMILY = Family(
    name="mass-ratios",
    summary="Two heavy balls would meet a third at one instant, had a ball 10**k times lighter not pushed one of them.",
    grows="10**k is the ratio of masses",
    make=kick,
    first=0,
    last=36,
    most=300,
    sides=("left", "right"),
)
