"""A few discs: the worked examples of the article, and impacts whose outcome is known in closed form."""

from __future__ import annotations

from ..numbers.quantity import Quantity
from ..scene import Scene
from ..settings import TiePolicy
from ..things import Circle, Wall
from .scene_entry import Parameter, SceneEntry, cosine, number, one_of, sine, tie_policy

# -- The worked examples of the article that derives the physics: two circles, or a circle and a wall.

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


# -- A few balls and what their impacts come to: counts, masses that pass on everything, a ball onto two.

MURPHY = "T. J. Murphy and E. G. D. Cohen, J. Stat. Phys. 71 (1993), 1063; arXiv:1810.05777"
EE_AND_LEE = "B. Ee and E. A. Lee, Determinism in three-ball collisions, arXiv:1310.5200"
CROSS = "after R. Cross, Physics Education 57 (2022), 063002"

FOUR = (
    ("a", "0", "0", "0", "0"),
    ("b", "10.65231", "-12.31599", "-2.58092", "2.3715"),
    ("c", "12.75313", "-15.50088", "-2.99337", "3.07448"),
    ("d", "12.33185", "-13.41529", "-2.38775", "2.81039"),
)

FREE = {
    "3": (
        ("a", "0", "0", "0", "0"),
        ("b", "51/20", "-13/20", "-11/10", "13/10"),
        ("c", "-7/10", "39/20", "11/20", "0"),
    ),
    "4": FOUR,
    "5": (*FOUR, ("e", "-0.34208", "38.84731", "0.16615", "-6.66896")),
}
"""Witnesses: id, x, y, vx, vy of discs of radius and mass 1. The fifth was found by throwing discs at the four."""


def free_discs(n: str) -> Scene:
    """n equal discs without walls that collide often, and then never again.

    >>> len(free_discs("3").circles)
    3
    """
    return Scene([Circle(x, y, vx=vx, vy=vy, id=name) for name, x, y, vx, vy in FREE[n]], events=100)


def magic_masses(a: Quantity, start: str, tie: TiePolicy) -> Scene:
    """Three balls on a line with masses 1, a, 1: the outer two arrive at once, or one strikes two that touch.

    >>> [float(c.m) for c in magic_masses(Quantity.of("1/2"), "both", TiePolicy()).circles]
    [1.0, 0.5, 1.0]
    """
    if start == "both":
        circles = [Circle(-4, 0, vx=1, id="left"), Circle(0, 0, m=a, id="middle"), Circle(4, 0, vx=-1, id="right")]
    else:
        circles = [Circle(-4, 0, vx=1, id="left"), Circle(0, 0, m=a, id="middle"), Circle(2, 0, id="right")]
    return Scene(circles, tie_policy=tie, events=100)


def cross(angle: str, tie: TiePolicy) -> Scene:
    """A ball strikes the first of two that touch; the line of that impact is at an angle to the line of the two.

    >>> [float(c.x) for c in cross("60", TiePolicy()).circles]
    [-3.0, 0.0, 2.0]
    """
    c, s = cosine(2 * int(angle)), sine(2 * int(angle))
    cue = Circle(-6 * c, -6 * s, vx=c, vy=s, id="cue")
    return Scene([cue, Circle(0, 0, id="near"), Circle(2, 0, id="far")], tie_policy=tie, events=100)


TIE = Parameter("tie", "simultaneous", "tie policy, such as sequential:order=scene", tie_policy)

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
    ),
    "free-discs": SceneEntry(
        name="free-discs",
        summary="Equal discs in the open that collide as often as is known, and then never again.",
        parameters=(Parameter("n", "3", "number of discs: 3, 4 or 5", one_of(*FREE)),),
        known="Three discs collide at most 4 times. Four collide 10 times here, five 15 times: witnesses, no maxima.",
        source=MURPHY,
        make=free_discs,
    ),
    "magic-masses": SceneEntry(
        name="magic-masses",
        summary="Three balls whose middle mass decides whether the order of their impulses matters.",
        parameters=(
            Parameter("a", "sqrt(5) - 2", "mass of the middle ball", number(above=0)),
            Parameter("start", "both", "both: the outer two arrive at once; one: one strikes two that touch",
                      one_of("both", "one")),
            TIE,
        ),
        known=(
            "With a = 1/cos(pi/k) - 1 every order of impulses leads to one outcome. With a = sqrt(5) - 2 (k = 5) one "
            "ball hands all of its momentum to the last, in 4 collisions."
        ),
        source=EE_AND_LEE,
        make=magic_masses,
    ),
    "cross": SceneEntry(
        name="cross",
        summary="A ball strikes one of two that touch, at an angle to their line.",
        parameters=(
            Parameter("angle", "60", "degrees between the two lines of impact", one_of("0", "30", "45", "60", "72")),
            TIE,
        ),
        known=(
            "The far ball leaves along the line of the two with the cosine of the angle, the near one across it with "
            "the sine, and the striker stops: one contact approaches at a time."
        ),
        source=CROSS,
        make=cross,
    ),
}  # fmt: skip
