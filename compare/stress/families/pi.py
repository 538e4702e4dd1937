"""The collisions that count out pi, for any power of ten as the ratio of masses."""

from __future__ import annotations

from math import isqrt

from flint import arb

from ....scenarios.numbers.precision import at_bits
from ....scenarios.scene import Scene
from ....scenarios.things import Circle, Wall
from ....scenarios.trajectory import Trajectory
from ..family import Family


def galperin(k: int, side: str, seed: int) -> Scene:
    """A ball 10**k times as heavy pushes a small one to a wall.

    >>> galperin(2, "wall", 0).circles[1].m.text()
    '100'
    """
    small, big = Circle(2, 0, id="small"), Circle(6, 0, r=2, vx=-1, m=10**k, id="big")
    return Scene([small, big], [Wall(0, 0, 0, 1, id="wall")], events=4 * isqrt(10**k) + 10)


def known(run: Trajectory, k: int, side: str, seed: int) -> bool:
    """Whether there are ceil(pi / arctan(sqrt(1 / 10**k))) - 1 collisions, for the angle that each turns.

    Only for k = 0 is the quotient a whole number, 4.
    """
    with at_bits(256):
        turns = (arb.pi() / (arb(1) / arb(10) ** k).sqrt().atan()).floor().unique_fmpz()
    return run.collisions == (3 if k == 0 else turns)


FAMILY = Family(
    name="pi",
    summary="A ball 10**k times as heavy pushes a small one to a wall, and all collisions are counted.",
    grows="10**k is the ratio of masses; there are about pi * 10**(k/2) collisions",
    make=galperin,
    first=0,
    last=5,
    most=8,
    sides=("wall",),
    known=known,
)
