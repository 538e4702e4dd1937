"""A rack whose balls almost touch: all that happens, happens in next to no time."""

from __future__ import annotations

from ....scenarios import catalogue
from ....scenarios.scene import Scene
from ..family import Family

EVENTS = 12


def gap(k: int, side: str, seed: int) -> Scene:
    """Three rows of balls, neighbours 10**-k apart, struck by a cue ball 1/10 above the axis, or below it.

    >>> len(gap(3, "above", 0).circles)
    7
    """
    offset = "1/10" if side == "above" else "-1/10"
    spec = {"rows": 3, "gap": f"1/10**{k}", "offset": offset, "pockets": "no"}
    return catalogue.build("rack", **spec).with_changes(events=EVENTS)


FAMILY = Family(
    name="gaps",
    summary="A ball strikes a triangle of three rows whose balls are 10**-k apart, a little beside its axis.",
    grows="10**-k is the gap between neighbours",
    make=gap,
    first=1,
    last=40,
    most=300,
    sides=("above", "below"),
)
