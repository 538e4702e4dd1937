"""Tables with arcs: a stadium, a mushroom, a lemon, a round table."""

from __future__ import annotations

from ..errors import SceneError
from ..numbers.quantity import Quantity
from ..scene import Scene
from ..things import Arc, Circle, Segment
from .degenerate import SIDES
from .scene_entry import Parameter, SceneEntry, cosine, number, one_of

EVENTS = 100


def stadium(straight: Quantity, r: Quantity, vx: Quantity, vy: Quantity) -> Scene:
    """A point between two straight sides, closed by two half circles of radius r.

    >>> len(stadium(Quantity.of(2), Quantity.of(1), Quantity.of(1), Quantity.of(0)).arcs)
    2
    """
    half = straight / 2
    arcs = [
        Arc(half, 0, r, half, -r, half, r, id="east"),
        Arc(-half, 0, r, -half, r, -half, -r, id="west"),
    ]
    sides = [Segment(-half, -r, half, -r, id="low"), Segment(half, r, -half, r, id="high")]
    ball = Circle(half / 10, r / 7, r=0, vx=vx, vy=vy, id="ball", point=True)
    return Scene([ball], arcs=arcs, segments=sides, events=EVENTS)


def mushroom(hat: Quantity, stem: Quantity, depth: Quantity, y: Quantity) -> Scene:
    """A point in a half circle of radius `hat` with a stem below its middle, half as wide as `stem` and `depth` long.

    Raises:
        SceneError: for a stem as wide as the hat, or a start outside of the hat.

    >>> one = Quantity.of(1)
    >>> [str(s.id) for s in mushroom(2 * one, one, one, one).segments]
    ['rim right', 'rim left', 'stem right', 'stem left', 'foot']
    """
    half = stem / 2
    if half >= hat:
        raise SceneError(f"stem = {stem.brief()}: is as wide as the hat; make it less than {(2 * hat).brief()}")
    if y.sign() <= 0 or y >= hat:
        raise SceneError(f"y = {y.brief()}: is not in the hat; choose it between 0 and {hat.brief()}")
    ways = {
        "rim right": (half, 0, hat, 0),
        "rim left": (-hat, 0, -half, 0),
        "stem right": (half, 0, half, -depth),
        "stem left": (-half, 0, -half, -depth),
        "foot": (-half, -depth, half, -depth),
    }
    segments = [Segment(*ends, id=name) for name, ends in ways.items()]
    ball = Circle(0, y, r=0, vx=1, id="ball", point=True)
    return Scene([ball], arcs=[Arc(0, 0, hat, hat, 0, -hat, 0, id="hat")], segments=segments, events=EVENTS)


def lemon(d: Quantity, y: Quantity) -> Scene:
    """A point in what two discs of radius 1 have in common, whose centres are d apart, y beside their axis.

    Raises:
        SceneError: for discs that have nothing in common, or all.

    >>> [float(arc.y1) for arc in lemon(Quantity.of("6/5"), Quantity.of(0)).arcs]
    [0.8, -0.8]
    """
    if d.sign() <= 0 or d >= 2:
        raise SceneError(f"d = {d.brief()}: choose a distance between 0 and 2")
    half = d / 2
    tip = (1 - half * half).sqrt()
    arcs = [Arc(-half, 0, 1, 0, -tip, 0, tip, id="right"), Arc(half, 0, 1, 0, tip, 0, -tip, id="left")]
    return Scene([Circle(0, y, r=0, vx=1, id="ball", point=True)], arcs=arcs, events=EVENTS)


def round_table(n: str, speed: Quantity) -> Scene:
    """A disc of radius 1 in a ring of radius 5, along the sides of a regular polygon of n corners.

    >>> float(round_table("6", Quantity.of(1)).circles[0].y) == -12**0.5
    True
    """
    reach = 4 * cosine(360 // int(n))
    return Scene([Circle(0, -reach, vx=speed, id="ball")], arcs=[Arc(0, 0, 5, full=True, id="ring")], events=EVENTS)


SCENES = {
    "stadium": SceneEntry(
        name="stadium",
        summary="A point between two straight sides, closed by two half circles: it is chaotic.",
        parameters=(
            Parameter("straight", "2", "length of the straight sides", number(above=0)),
            Parameter("r", "1", "radius of the half circles", number(above=0)),
            Parameter("vx", "3/5", "velocity to the right", number()),
            Parameter("vy", "4/5", "velocity up", number()),
        ),
        known=(
            "With r = 1, sides of 2 and speed 1 the exponent is .43 per unit of time, and the mean flight pi A / P, "
            "which is pi (pi + 4) / (2 pi + 4)."
        ),
        source=(
            "L. A. Bunimovich, Comm. Math. Phys. 65 (1979), 295; G. Benettin and J.-M. Strelcyn, "
            "Phys. Rev. A 17 (1978), 773"
        ),
        make=stadium,
    ),
    "mushroom": SceneEntry(
        name="mushroom",
        summary="A point in a half circle with a stem: order and chaos side by side, with a sharp border.",
        parameters=(
            Parameter("hat", "2", "radius of the half circle", number(above=0)),
            Parameter("stem", "1", "width of the stem", number(above=0)),
            Parameter("depth", "1", "length of the stem", number(above=0)),
            Parameter("y", "1/3", "height at which the point starts, level, over the middle", number(above=0)),
        ),
        known=(
            "A flight that passes the middle of the hat at more than half of the stem's width never enters the stem: "
            "it touches a circle of that distance for ever. Others enter it, but for a set of measure zero."
        ),
        source="L. A. Bunimovich, Mushrooms and other billiards with divided phase space, Chaos 11 (2001), 802",
        make=mushroom,
    ),
    "lemon": SceneEntry(
        name="lemon",
        summary="A point in what two discs have in common, going to and fro beside their axis.",
        parameters=(
            Parameter("d", "1/2", "distance of the centres of the two discs of radius 1", number(above=0)),
            Parameter("y", "1/100", "how far beside the axis it starts", number()),
        ),
        known=(
            "The flight along the axis is stable for every d between 0 and 2 but 1: beside it, a point turns about "
            "it by the angle arccos(2 (d - 1)**2 - 1) in each two bounces."
        ),
        source="E. J. Heller and S. Tomsovic, Physics Today 46, no. 7 (1993), 38; the angle: optics of two mirrors",
        make=lemon,
    ),
    "round-table": SceneEntry(
        name="round-table",
        summary="A disc in a ring, along the sides of a regular polygon: it closes, exactly.",
        parameters=(
            Parameter("n", "5", f"corners: {', '.join(SIDES)}", one_of(*SIDES)),
            Parameter("speed", "1", "its speed", number(above=0)),
        ),
        known="Each bounce turns it by 360/n degrees; n of them take 8 n sin(180/n) / speed, and all is as at first.",
        source="G. D. Birkhoff, Dynamical Systems (1927), chapter 6: the billiard in a circle",
        make=round_table,
    ),
}
