"""Ever more discs in a box of the same density."""

from __future__ import annotations

from ....scenarios import catalogue
from ....scenarios.scene import Scene
from ..family import Family


def crowd(k: int, side: str, seed: int) -> Scene:
    """2**k discs that cover a tenth of their box, for five instants a disc.

    >>> scene = crowd(5, "even", 1)
    >>> len(scene.circles), scene.events
    (32, 160)
    """
    n = 2**k
    return catalogue.build("gas", n=n, seed=seed, mixed="no" if side == "even" else "yes").with_changes(events=5 * n)


FAMILY = Family(
    name="crowds",
    summary="2**k discs in a box, of one radius or of five, for five instants a disc.",
    grows="2**k is the number of discs",
    make=crowd,
    first=0,
    last=6,
    most=10,
    sides=("even", "mixed"),
    seeds=(1,),
)
