"""Balls that touch, ever more of them, and one that strikes them."""

from __future__ import annotations

from ....scenarios import catalogue
from ....scenarios.numbers.quantity import Quantity
from ....scenarios.scene import Scene
from ....scenarios.things import Circle
from ..family import Family

EVENTS = 3


def touching(k: int, side: str, seed: int) -> Scene:
    """A row of k + 1 touching balls of radius 3/10, or a triangle of k + 1 rows, struck by one more.

    >>> len(touching(3, "row", 0).circles), len(touching(3, "triangle", 0).circles)
    (5, 11)
    """
    if side == "row":
        return catalogue.build("cradle", n=k + 1, r="3/10", gap=0).with_changes(events=EVENTS)
    r, height = Quantity.of("3/10"), Quantity.of("sqrt(3)")
    balls = [Circle(r * height * row, r * (row - 2 * place), r) for row in range(k + 1) for place in range(row + 1)]
    return Scene([Circle(-2, 0, r, vx=1, id="cue"), *balls], events=EVENTS, until=3)


FAMILY = Family(
    name="touching",
    summary="A ball strikes a row of k + 1 touching balls, or a triangle of k + 1 rows of them.",
    grows="k + 1 is the number of balls in the row, or of rows",
    make=touching,
    first=1,
    last=6,
    most=20,
    sides=("row", "triangle"),
)
