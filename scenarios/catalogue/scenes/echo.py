"""A gas that starts far from equilibrium, and whose velocities are all turned back once."""

from __future__ import annotations

from ...numbers.quantity import Quantity
from ...scene import Scene
from ...things import Circle, Wall
from ..draw import Draw
from ..entry import Parameter, SceneEntry
from ..settings import whole

GRAIN = 1000
"""Places and directions are made of thousandths."""

SPACING = 6
"""Between neighbours of the lattice, in radii: the gas is dilute, as theirs was."""

JITTER = 1500
"""Largest displacement from the lattice, in thousandths, so that no two contacts fall on one instant."""

SOURCE = "J. Orban and A. Bellemans, Physics Letters 24A (1967), 620 (recalled): reversal of a dilute gas of hard disks"


def echo(rows: int, after: int, seed: int) -> Scene:
    """rows x rows discs near a lattice, all at speed 1 in directions drawn from a seed, turned back after some events.

    >>> scene = echo(3, 20, 1)
    >>> len(scene.circles), scene.reverse_after, {c.vx**2 + c.vy**2 == 1 for c in scene.circles}
    (9, 20, {True})
    """
    draw = Draw(seed)
    circles: list[Circle] = []
    for row in range(rows):
        for column in range(rows):
            x, y = (SPACING * k + SPACING // 2 + Quantity.of(draw.between(-JITTER, JITTER)) / GRAIN
                    for k in (column, row))  # fmt: skip
            p, q = draw.between(1, GRAIN - 1), draw.between(1, GRAIN - 1)
            norm = Quantity.of(p * p + q * q)
            c, s = (p * p - q * q) / norm, 2 * p * q / norm
            vx, vy = ((c, s), (-c, -s))[draw.between(0, 1)]
            circles.append(Circle(x, y, vx=vx, vy=vy, id=f"c{len(circles) + 1}"))
    side = rows * SPACING
    walls = [Wall(0, 0, 0, 1, id="left"), Wall(side, 0, side, 1, id="right"),
             Wall(0, 0, 1, 0, id="bottom"), Wall(0, side, 1, side, id="top")]  # fmt: skip
    return Scene(circles, walls, reverse_after=after)


SCENES = {
    "echo": SceneEntry(
        name="echo",
        summary="A gas of one speed, turned back on its way to equilibrium: H returns, if nothing is lost.",
        parameters=(
            Parameter("rows", "10", "discs in a row of the lattice", whole(2, 30)),
            Parameter("after", "300", "turn back after this many instants", whole(1, 100_000)),
            Parameter("seed", "1", "seed of places and directions", whole(0, 10**9)),
        ),
        known=(
            "Boltzmann's H falls as the speeds spread, and has its first value again when the gas is back: every disc "
            "is where it began, with its velocity negated."
        ),
        source=SOURCE,
        make=echo,
    ),
}
