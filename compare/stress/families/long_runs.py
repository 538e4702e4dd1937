"""The same few discs for ever longer."""

from __future__ import annotations

from ....scenarios import catalogue
from ....scenarios.scene import Scene
from ..family import Family


def long_run(k: int, side: str, seed: int) -> Scene:
    """Three discs in a box, for 2**k instants.

    >>> long_run(8, "gas", 1).events
    256
    """
    return catalogue.build("gas", n=3, seed=seed).with_changes(events=2**k)


FAMILY = Family(
    name="long-runs",
    summary="Three discs in a box, for 2**k instants.",
    grows="2**k is the number of instants",
    make=long_run,
    first=0,
    last=9,
    most=14,
    sides=("gas",),
    seeds=(1, 2, 3),
)
