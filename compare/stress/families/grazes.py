"""A ball that passes another at almost exactly the distance of their radii."""

from __future__ import annotations

from ....scenarios import catalogue
from ....scenarios.scene import Scene
from ....scenarios.trajectory import Trajectory
from ..family import Family


def graze(k: int, side: str, seed: int) -> Scene:
    """To and fro between two walls, aslant by 36 degrees; it misses the other by 10**-k, or overlaps its path by that.

    >>> len(graze(3, "hit", 0).walls)
    2
    """
    sign = "" if side == "miss" else "-"
    return catalogue.build("grazing", miss=f"{sign}1/10**{k}", angle=36).with_changes(events=6)


def known(run: Trajectory, k: int, side: str, seed: int) -> bool:
    """Whether the two meet first of all, or the mover meets walls alone."""
    met = [pair for event in run.events for pair in event.impulses]
    return met[0] == ("mover", "rest") if side == "hit" else ("mover", "rest") not in met


FAMILY = Family(
    name="grazes",
    summary="A ball passes another, which rests, at the distance of their radii plus or minus 10**-k.",
    grows="10**-k is what it misses by, or overlaps by",
    make=graze,
    first=1,
    last=40,
    most=300,
    sides=("hit", "miss"),
    known=known,
)
