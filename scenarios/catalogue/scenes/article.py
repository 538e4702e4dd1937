"""The worked examples of the article that derives the physics: two circles, or a circle and a wall."""

from __future__ import annotations

from ...scene import Scene
from ...things import Circle, Wall
from ..entry import Parameter, SceneEntry
from ..settings import one_of

SOURCE = (
    "C. M. Kadie, Perfect, Infinite-Precision, Game Physics in Python (Part 3), Towards Data Science, 2022; "
    "package perfect-physics 0.1.9"
)


def article(figure: str) -> Scene:
    """One figure of the article, by what it shows.

    >>> [float(c.vx) for c in article("approach").circles]
    [2.0, 0.0]
    """
    things = FIGURES[figure]
    circles = [thing for thing in things if isinstance(thing, Circle)]
    walls = [thing for thing in things if isinstance(thing, Wall)]
    return Scene(circles, walls, events=10)


FIGURES: dict[str, tuple[Circle | Wall, ...]] = {
    "approach": (Circle(0, 0, vx=2, id="a"), Circle(4, 0, id="b")),
    "apart": (Circle(2, 2, vx=1, vy=1, id="a"), Circle(0, 0, id="b")),
    "head-on": (Circle(0, 0, vx=1, vy=2, id="a"), Circle(2, 0, id="b")),
    "diagonal": (Circle(0, 0, vx=1, id="a"), Circle("sqrt(2)", "sqrt(2)", id="b")),
    "giant": (Circle(0, 1, vx=1, vy=-1, id="a"), Circle(0, -20, r=20, m=1000, id="b")),
    "floor": (Circle(0, 1, vx=1, vy=-1, id="a"), Wall(-1, 0, 1, 0, id="floor")),
    "slope": (Circle("-sqrt(2)/2", "sqrt(2)/2", vx=2, vy=1, id="a"), Wall(-1, -1, 1, 1, id="slope")),
}

SCENES = {
    "article": SceneEntry(
        name="article",
        summary="The worked examples of the article, small enough to check by hand.",
        parameters=(Parameter("figure", "diagonal", f"which example: {', '.join(FIGURES)}", one_of(*FIGURES)),),
        known=(
            "approach: they just touch at times 1 and 3, and collide at 1. "
            "apart: they just touch at -2 - sqrt(2) and -2 + sqrt(2), both past, and never collide. "
            "head-on: a goes on with (0, 2), b with (1, 0). "
            "diagonal: a goes on with (1/2, -1/2), b with (1/2, 1/2). "
            "giant: a goes on with (1, 999/1001), b with (0, -2/1001). "
            "floor: a goes on with (1, 1). slope: a goes on with (1, 2)."
        ),
        source=SOURCE,
        make=article,
    )
}
