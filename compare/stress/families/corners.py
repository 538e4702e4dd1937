"""A ball that runs almost exactly into a corner."""

from __future__ import annotations

from ....scenarios import catalogue
from ....scenarios.numbers.quantity import Quantity
from ....scenarios.scene import Scene
from ....scenarios.things import Circle
from ....scenarios.trajectory import Trajectory
from ..family import Family

EVENTS = 6


def corner(k: int, side: str, seed: int) -> Scene:
    """A corner of 72 degrees, closed by a third wall; the ball flies along its bisector, 10**-k above it or below.

    >>> ball = corner(3, "lower", 0).circles[0]
    >>> ball.y.text(), ball.vy.text()
    ('-1/1000', '0')
    """
    beside = Quantity.of(10) ** -k * (1 if side == "upper" else -1)
    base = catalogue.build("corner", angle=72)
    ball = Circle(base.circles[0].x, beside, vx=-1, id="ball")
    return base.with_changes(circles=[ball], events=EVENTS)


def known(run: Trajectory, k: int, side: str, seed: int) -> bool:
    """Whether the ball meets the wall on its side of the bisector first, and then the other."""
    other = "lower" if side == "upper" else "upper"
    return [event.impulses for event in run.events[:2]] == [(("ball", side),), (("ball", other),)]


FAMILY = Family(
    name="corners",
    summary="A ball runs into a corner of 72 degrees, 10**-k beside the bisector, and so meets one wall first.",
    grows="10**-k is the distance from the bisector",
    make=corner,
    first=1,
    last=40,
    most=300,
    sides=("upper", "lower"),
    known=known,
)
