"""Scenes on the edge of a decision: exact grazes, corners, and symmetric rings in which most instants are ties."""

from __future__ import annotations

from ..errors import SceneError
from ..numbers.quantity import Quantity
from ..scene import Scene
from ..settings import TiePolicy
from ..things import Circle, Wall
from .article import SOURCE as ARTICLE
from .scene_entry import Parameter, SceneEntry, cosine, number, one_of, sine, tie_policy, yes_no

# -- Decisions on the edge: a ball that exactly grazes another, and one that runs exactly into a corner.

EVENTS = 20

DIRECTIONS = ("0", "30", "36", "45", "60", "72", "90")

FAR = 16
"""Distance of the closing wall from the corner: beyond the start of every ball."""


def grazing(miss: Quantity, angle: str) -> Scene:
    """A ball passes another at the distance of their radii and `miss`, to and fro between two walls.

    Everything is turned by `angle` degrees, which brings in square roots.

    >>> zero = Quantity.of(0)
    >>> a, b = grazing(zero, "60").circles
    >>> (a.x - b.x) * a.vy - (a.y - b.y) * a.vx == -2   # the distance of b from a's path is both radii
    True
    """
    c, s = cosine(2 * int(angle)), sine(2 * int(angle))
    beside = 2 + miss
    mover = Circle(-5 * c - beside * s, -5 * s + beside * c, vx=c, vy=s, id="mover")
    walls = [Wall(k * c, k * s, k * c - s, k * s + c, id=name) for k, name in ((-10, "back"), (10, "front"))]
    return Scene([mover, Circle(0, 0, id="rest")], walls, events=EVENTS)


def corner(angle: str, skew: Quantity, tie: TiePolicy) -> Scene:
    """A ball of radius 1 runs into the corner of two walls, so that it touches both in the same instant.

    The walls meet at the origin, at `angle` degrees, with the x axis between them. The ball starts 8 from
    where it will touch both, `skew` beside the axis, and a third wall closes the triangle.

    >>> corner("90", Quantity.of(0), TiePolicy()).circles[0].x
    Quantity('1/(sqrt(2)/2) + 8')
    """
    half = int(angle)  # half of the angle, in half degrees
    c, s = cosine(half), sine(half)
    walls = [
        Wall(0, 0, c, s, id="upper"),
        Wall(0, 0, c, -s, id="lower"),
        Wall(FAR, 0, FAR, 1, id="end"),
    ]
    ball = Circle(1 / s + 8, skew, vx=-1, vy=-skew / 8, id="ball")
    return Scene([ball], walls, tie_policy=tie, events=EVENTS)


# -- Circles on a ring inside a regular polygon of walls: symmetric, so that most instants are ties.

RING_EVENTS = 12

SIDES = ("3", "4", "5", "6", "8", "10", "12")


def inscribed(
    n: str, ring: Quantity, wall: Quantity, r: Quantity, speed: Quantity, spin: Quantity, corners: bool
) -> Scene:
    """n circles on a ring of radius `ring`, and n walls at distance `wall` from its centre.

    Circle k sits at the angle 360 k/n degrees, and moves with `speed` outward and `spin` across. It faces the
    middle of a wall, or with `corners` the corner of two.

    Raises:
        SceneError: for a circle that reaches the walls.

    >>> one = Quantity.of(1)
    >>> scene = inscribed("4", 3 * one, 7 * one, one, one, 0 * one, False)
    >>> [(float(c.x), float(c.vy)) for c in scene.circles]
    [(3.0, 0.0), (0.0, 1.0), (-3.0, 0.0), (0.0, -1.0)]
    """
    step = 720 // int(n)
    reach = ring * cosine(step // 2) if corners else ring
    if reach + r >= wall:
        raise SceneError(f"ring = {ring} with r = {r} reaches the walls at {wall}; raise wall, or lower ring")
    circles = [_circle(k, k * step, ring, r, speed, spin) for k in range(int(n))]
    walls = [_wall(k, k * step + (step // 2 if corners else 0), wall) for k in range(int(n))]
    return Scene(circles, walls, events=RING_EVENTS)


def _circle(k: int, angle: int, ring: Quantity, r: Quantity, speed: Quantity, spin: Quantity) -> Circle:
    c, s = cosine(angle), sine(angle)
    return Circle(ring * c, ring * s, r=r, vx=speed * c - spin * s, vy=speed * s + spin * c, id=f"c{k + 1}")


def _wall(k: int, angle: int, distance: Quantity) -> Wall:
    c, s = cosine(angle), sine(angle)
    x, y = distance * c, distance * s
    return Wall(x, y, x - s, y + c, id=f"w{k + 1}")


SCENES = {
    "grazing": SceneEntry(
        name="grazing",
        summary="A ball that exactly touches another in passing: no collision, with nothing to spare.",
        parameters=(
            Parameter("miss", "0", "distance by which it misses, such as 10**-20; negative hits", number()),
            Parameter("angle", "36", f"direction in degrees: {', '.join(DIRECTIONS)}", one_of(*DIRECTIONS)),
        ),
        known=(
            "The discriminant is exactly zero for miss=0, and a graze is no collision: the mover goes to and "
            "fro between the walls for ever, and the other stays at rest. With miss < 0 they collide."
        ),
        source=f"{ARTICLE} (a circle that grazes is not counted as colliding)",
        make=grazing,
    ),
    "corner": SceneEntry(
        name="corner",
        summary="A ball that runs into a corner exactly: both walls in one instant.",
        parameters=(
            Parameter("angle", "60", "angle of the corner in degrees", one_of("36", "45", "60", "72", "90")),
            Parameter("skew", "0", "distance of the start from the bisector", number()),
            Parameter("tie", "simultaneous", "tie policy, such as sequential:order=scene", tie_policy),
        ),
        known=(
            "With simultaneous, it comes back the way it went on the bisector; at 90 degrees, it does from "
            "anywhere, the impulses being at right angles. At 60, one wall at a time needs 3 bounces."
        ),
        source="the method of images: n bounces unfold a corner of 180/n degrees",
        make=corner,
    ),
    "inscribed": SceneEntry(
        name="inscribed",
        summary="Circles on a ring in a regular polygon of walls, moving alike: symmetric for ever.",
        parameters=(
            Parameter("n", "6", f"circles and walls: {', '.join(SIDES)}", one_of(*SIDES)),
            Parameter("ring", "4", "distance of the circles from the centre", number(above=0)),
            Parameter("wall", "8", "distance of the walls from the centre", number(above=0)),
            Parameter("r", "1", "radius of the circles", number(above=0)),
            Parameter("speed", "1", "speed outward; negative is inward", number()),
            Parameter("spin", "1/3", "speed across, counterclockwise", number()),
            Parameter("corners", "no", "yes turns the corners of the polygon to the circles", yes_no),
        ),
        known=(
            "A rotation by 360/n degrees maps the scene to itself, and so each of its later states; without "
            "spin, mirroring does too. Without spin, the motion is one circle's, back and forth on its ray."
        ),
        source=f"{ARTICLE} (World.inscribed)",
        make=inscribed,
    ),
}
