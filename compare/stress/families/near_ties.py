"""Two collisions that share a ball, almost at one instant: which comes first decides what comes out."""

from __future__ import annotations

from ....scenarios import catalogue
from ....scenarios.scene import Scene
from ....scenarios.trajectory import Trajectory
from ..family import Family

ENDS = {"left": ("-11/5", "-8/25", "-3/25"), "right": ("-8/5", "-39/25", "1/25")}
"""Final velocities where the left pair goes first, and where the right one does, by hand: three impulses each."""


def near_tie(k: int, side: str, seed: int) -> Scene:
    """Lee's three balls, the outer one on the other side 10**-k late.

    >>> near_tie(3, "left", 0).circles[2].x.text()
    '4001/1000'
    """
    return catalogue.build("near-tie", k=k, first=side)


def known(run: Trajectory, k: int, side: str, seed: int) -> bool:
    """Whether the balls end as they do by hand."""
    return tuple(circle.vx.text() for circle in run.final.circles) == ENDS[side]


FAMILY = Family(
    name="near-ties",
    summary="Two balls meet a third between them, one 10**-k after the other.",
    grows="10**-k is the distance by which the later one is late",
    make=near_tie,
    first=1,
    last=40,
    most=300,
    sides=("left", "right"),
    known=known,
)
