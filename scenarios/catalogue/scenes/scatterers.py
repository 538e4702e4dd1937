"""One ball among fixed discs: pinball, the Lorentz gas, and Sinai's billiard."""

from __future__ import annotations

from ...errors import SceneError
from ...numbers.quantity import Quantity
from ...scene import Scene
from ...things import Circle, Wall
from ..entry import Parameter, SceneEntry
from ..settings import number, one_of, whole
from .gas import SINAI

EVENTS = 60

DISTANCE = 6
"""Distance of the pinball's discs, in their radii: the value that the literature works with."""


def pinball(discs: str, r: Quantity, offset: Quantity) -> Scene:
    """A ball on an unstable periodic orbit between fixed discs of radius 1, `offset` beside it.

    With two discs, it goes back and forth on the line through their centres, which has the direction (3, 4),
    so that no double holds it. With three, it goes around the triangle that touches each disc once.

    >>> zero = Quantity.of(0)
    >>> [c.fixed for c in pinball("2", zero, zero).circles]
    [False, True, True]
    """
    cos, sin = Quantity.of("3/5"), Quantity.of("4/5")
    if discs == "2":
        centres = [(Quantity.of(0), Quantity.of(0)), (DISTANCE * cos, DISTANCE * sin)]
        half = Quantity.of(DISTANCE) / 2
        ball = _ball(half * cos - offset * sin, half * sin + offset * cos, r, cos, sin)
    else:
        top = Quantity.of(DISTANCE) / 2 * Quantity.of("sqrt(3)")
        half = Quantity.of(DISTANCE) / 2
        centres = [(Quantity.of(0), Quantity.of(0)), (2 * half, Quantity.of(0)), (half, top)]
        ball = _ball(half, (1 + r) / 2 + offset, r, Quantity.of(1), Quantity.of(0))
    return Scene([ball, *_fixed(centres, Quantity.of(1))], events=EVENTS)


def lorentz(rows: int, spacing: Quantity, r: Quantity, vx: Quantity, vy: Quantity) -> Scene:
    """A ball among rows * rows fixed discs of radius 1 on a square grid, in a box half a spacing wider.

    >>> one = Quantity.of(1)
    >>> len(lorentz(3, 4 * one, one / 4, one, one / 3).circles)
    10
    """
    centres = [(spacing * column, spacing * row) for row in range(rows) for column in range(rows)]
    ball = _ball(spacing / 2, spacing / 2, r, vx, vy)
    low, high = -spacing / 2, spacing * (2 * rows - 1) / 2
    return Scene([ball, *_fixed(centres, Quantity.of(1))], _square(low, high), events=EVENTS)


def point(size: Quantity, disc: Quantity, vx: Quantity, vy: Quantity) -> Scene:
    """A point in a square of side `size` with a fixed disc in its middle.

    Raises:
        SceneError: for a disc that leaves no way around it.

    >>> point(Quantity.of(6), Quantity.of(1), Quantity.of(1), Quantity.of(0)).circles[0].point
    True
    """
    if 2 * disc >= size:
        raise SceneError(f"disc = {disc} fills the square of size {size}; lower disc, or raise size")
    centre = size / 2
    ball = _ball((centre - disc) / 2, size / 3, Quantity.of(0), vx, vy)
    return Scene([ball, *_fixed([(centre, centre)], disc)], _square(Quantity.of(0), size), events=EVENTS)


def _ball(x: Quantity, y: Quantity, r: Quantity, vx: Quantity, vy: Quantity) -> Circle:
    return Circle(x, y, r=r, vx=vx, vy=vy, id="ball", point=r.sign() == 0)


def _fixed(centres: list[tuple[Quantity, Quantity]], r: Quantity) -> list[Circle]:
    return [Circle(x, y, r=r, m="oo", id=f"disc {k}") for k, (x, y) in enumerate(centres, start=1)]


def _square(low: Quantity, high: Quantity) -> list[Wall]:
    return [
        Wall(low, low, low, low + 1, id="left"),
        Wall(high, low, high, low + 1, id="right"),
        Wall(low, low, low + 1, low, id="bottom"),
        Wall(low, high, low + 1, high, id="top"),
    ]


SCENES = {
    "pinball": SceneEntry(
        name="pinball",
        summary="A ball on an unstable periodic orbit between fixed discs: exact for ever, lost in floats.",
        parameters=(
            Parameter("discs", "2", "fixed discs: 2 or 3", one_of("2", "3")),
            Parameter("r", "1/10", "radius of the ball; 0 makes it a point", number(least=0)),
            Parameter("offset", "0", "distance of the start from the orbit", number()),
        ),
        known=(
            "Exactly periodic without offset. With R = 6/(1 + r), each bounce multiplies a small offset by "
            "R - 1 + sqrt(R (R - 2)) between two discs (9.899 for r = 0), and on the triangle of three by "
            "R' - 1 + R' sqrt(1 - sqrt(3)/R) with R' = 2 R/sqrt(3) (11.771): an error in the last place of a "
            "double grows to the size of the scene in about 16 bounces."
        ),
        source=(
            "P. Gaspard and S. A. Rice, Scattering from a classically chaotic repellor, "
            "Journal of Chemical Physics 90 (1989), 2225; "
            "P. Cvitanovic et al., Chaos: classical and quantum (the game of pinball)"
        ),
        make=pinball,
    ),
    "lorentz": SceneEntry(
        name="lorentz",
        summary="One ball among fixed discs on a grid: the Lorentz gas, in a box.",
        parameters=(
            Parameter("rows", "3", "the grid has rows * rows discs", whole(2, 20)),
            Parameter("spacing", "4", "distance of neighbouring discs", number(above=2)),
            Parameter("r", "1/4", "radius of the ball; 0 makes it a point", number(least=0)),
            Parameter("vx", "1", "velocity in x", number()),
            Parameter("vy", "3/10", "velocity in y", number()),
        ),
        known="The speed never changes, and errors grow with every hit of a disc, as discs disperse.",
        source="H. A. Lorentz, The motion of electrons in metallic bodies, Proc. KNAW 7 (1905), 438",
        make=lorentz,
    ),
    "point": SceneEntry(
        name="point",
        summary="A point in a square with a disc in the middle: Sinai's billiard.",
        parameters=(
            Parameter("size", "6", "side of the square", number(above=0)),
            Parameter("disc", "1", "radius of the disc", number(above=0)),
            Parameter("vx", "1", "velocity in x", number()),
            Parameter("vy", "3/10", "velocity in y", number()),
        ),
        known="The speed never changes. The billiard is ergodic and chaotic.",
        source=SINAI,
        make=point,
    ),
}
