"""A fast ball passes a slow one, whose drift decides whether they meet."""

from __future__ import annotations

from ....scenarios.numbers.quantity import Quantity
from ....scenarios.scene import Scene
from ....scenarios.things import Circle, Wall
from ....scenarios.trajectory import Trajectory
from ..family import Family

COS, SIN = Quantity.of("3/5"), Quantity.of("4/5")
"""The direction in which the fast one flies: no double holds it."""


def drift(k: int, side: str, seed: int) -> Scene:
    """The slow one starts where the fast one would exactly graze it, and drifts into its path, or out of it.

    >>> slow = drift(3, "in", 0).circles[1]
    >>> (slow.vx.text(), slow.vy.text())
    ('1/1250', '-3/5000')
    """
    speed = Quantity.of(10) ** -k * (-1 if side == "in" else 1)
    fast = Circle(-5 * COS, -5 * SIN, vx=COS, vy=SIN, id="fast")
    slow = Circle(-2 * SIN, 2 * COS, vx=-speed * SIN, vy=speed * COS, id="slow")
    walls = [Wall(d * COS, d * SIN, d * COS - SIN, d * SIN + COS, id=name) for d, name in ((-9, "back"), (9, "front"))]
    return Scene([fast, slow], walls, events=4)


def known(run: Trajectory, k: int, side: str, seed: int) -> bool:
    """Whether the two meet before anything else, or the fast one flies on to the front wall."""
    return run.events[0].impulses == ((("fast", "slow") if side == "in" else ("fast", "front")),)


FAMILY = Family(
    name="slow-fast",
    summary="A ball at speed 1 passes one at speed 10**-k, which drifts into its path or out of it.",
    grows="10**k is the ratio of speeds",
    make=drift,
    first=1,
    last=40,
    most=300,
    sides=("in", "out"),
    known=known,
)
