"""A ball on an unstable periodic orbit, but for next to nothing."""

from __future__ import annotations

from ....scenarios import catalogue
from ....scenarios.scene import Scene
from ..family import Family


def orbit(k: int, side: str, seed: int) -> Scene:
    """Between two fixed discs, 10**-k beside the line through their centres: it leaves after about k bounces.

    >>> orbit(3, "left", 0).events
    28
    """
    sign = "" if side == "left" else "-"
    return catalogue.build("pinball", discs=2, r="1/10", offset=f"{sign}1/10**{k}").with_changes(events=k + 25)


FAMILY = Family(
    name="unstable",
    summary="A ball bounces between two fixed discs, 10**-k beside the line through their centres, until it leaves.",
    grows="10**-k is the distance from the orbit; each bounce multiplies it by about ten",
    make=orbit,
    first=1,
    last=40,
    most=300,
    sides=("left", "right"),
)
