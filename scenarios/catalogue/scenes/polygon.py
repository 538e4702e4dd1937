"""Circles on a ring inside a regular polygon of walls: symmetric, so that most instants are ties."""

from __future__ import annotations

from ...errors import SceneError
from ...numbers.quantity import Quantity
from ...scene import Scene
from ...things import Circle, Wall
from ..angles import cosine, sine
from ..entry import Parameter, SceneEntry
from ..settings import number, one_of, yes_no
from .article import SOURCE as ARTICLE

EVENTS = 12

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
    return Scene(circles, walls, events=EVENTS)


def _circle(k: int, angle: int, ring: Quantity, r: Quantity, speed: Quantity, spin: Quantity) -> Circle:
    c, s = cosine(angle), sine(angle)
    return Circle(ring * c, ring * s, r=r, vx=speed * c - spin * s, vy=speed * s + spin * c, id=f"c{k + 1}")


def _wall(k: int, angle: int, distance: Quantity) -> Wall:
    c, s = cosine(angle), sine(angle)
    x, y = distance * c, distance * s
    return Wall(x, y, x - s, y + c, id=f"w{k + 1}")


SCENES = {
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
    )
}
