"""Balls on one line: cradles, stacked drops, the collisions that count pi, and ties whose order matters."""

from __future__ import annotations

from ..numbers.quantity import Quantity
from ..scene import Scene
from ..settings import TiePolicy
from ..things import Circle, Wall
from .article import SOURCE as ARTICLE
from .scene_entry import Parameter, SceneEntry, number, one_of, tie_policy, whole

TIE = Parameter("tie", "simultaneous", "tie policy, such as sequential:order=scene", tie_policy)

ONE = Quantity.of(1)

CRADLE_EVENTS = 60
DROP_EVENTS = 400


def cradle(n: int, r: Quantity, gap: Quantity, tie: TiePolicy, e: Quantity = ONE) -> Scene:
    """A striker flies at n equal balls at rest between two walls; n=5, r=1, gap=0 are the article's numbers.

    >>> [float(c.x) for c in cradle(5, Quantity.of(1), Quantity.of(0), TiePolicy()).circles]
    [1.0, 6.0, 8.0, 10.0, 12.0, 14.0]
    """
    xs = [6 * r + (2 * r + gap) * place for place in range(n)]
    balls = [Circle(x, 0, r=r, id=f"b{place}") for place, x in enumerate(xs, start=1)]
    striker = Circle(r, 0, r=r, vx=1, id="striker")
    return Scene([striker, *balls], _ends(xs[-1] + 6 * r), tie_policy=tie, events=CRADLE_EVENTS, restitution=e)


def tennis(big: Quantity) -> Scene:
    """A small ball behind a big one, both at speed 1 toward a wall: the drop, laid on its side.

    The big ball has radius `big` and mass big**3, the small one radius 1 and mass 1.

    >>> [float(c.m) for c in tennis(Quantity.of(10)).circles]
    [1000.0, 1.0]
    """
    basketball = Circle(2 * big, 0, r=big, vx=1, m=big**3, id="basketball")
    ball = Circle(big - 1, 0, vx=1, id="tennis")
    return Scene([basketball, ball], _ends(4 * big), events=DROP_EVENTS)


def sizes(n: int, ratio: Quantity) -> Scene:
    """n touching balls of radius 1, 2, 3... and mass 1, ratio, ratio**2... at speed 1 toward a wall.

    >>> [float(c.x) for c in sizes(3, Quantity.of(1000)).circles]
    [1.0, 4.0, 9.0]
    """
    balls = [Circle(k * k, 0, r=k, vx=1, m=ratio ** (k - 1), id=f"b{k}") for k in range(1, n + 1)]
    return Scene(balls, _ends(Quantity.of(10 * n * (n + 1)) / 3), events=DROP_EVENTS)


def galperin(n: int) -> Scene:
    """A ball 100**n times as heavy pushes a small one to a wall; the collisions count out pi.

    >>> float(galperin(3).circles[1].m)
    1000000.0
    """
    small, big = Circle(2, 0, id="small"), Circle(6, 0, r=2, vx=-1, m=100**n, id="big")
    return Scene([small, big], [Wall(0, 0, 0, 1, id="wall")], events=4 * 10**n)


def lee(tie: TiePolicy) -> Scene:
    """Two balls meet a third, at rest between them, in the same instant.

    >>> [float(c.vx) for c in lee(TiePolicy()).circles]
    [1.0, 0.0, -1.0]
    """
    return Scene(_three(Quantity.of(0), Quantity.of(0)), tie_policy=tie, events=10)


def near_tie(k: int, first: str) -> Scene:
    """The scene `lee` with one of the outer balls 10**-k late.

    >>> near_tie(20, "left").circles[2].x - 4 == Quantity.of("10**-20")
    True
    """
    late = Quantity.of(10) ** -k
    none = Quantity.of(0)
    return Scene(_three(none, late) if first == "left" else _three(late, none), events=10)


def beads(n: int, e: Quantity) -> Scene:
    """A bead flies at n - 1 equal ones that rest on a wall and on each other, on one line.

    >>> [float(c.x) for c in beads(3, Quantity.of("1/3")).circles]
    [1.0, 3.0, 6.0]
    """
    resting = [Circle(2 * k + 1, 0, id=f"b{k + 1}") for k in range(n - 1)]
    return Scene(
        [*resting, Circle(2 * n, 0, vx=-1, id=f"b{n}")], [Wall(0, 0, 0, 1, id="wall")], restitution=e, events=10
    )


def collapse(e: Quantity) -> Scene:
    """Two equal discs fly at one between them, which is hit by them in turns."""
    discs = [Circle(0, 0, vx=1, id="left"), Circle(3, 0, id="middle"), Circle("13/2", 0, vx=-1, id="right")]
    return Scene(discs, restitution=e, events=200)


def _three(left_late: Quantity, right_late: Quantity) -> list[Circle]:
    return [
        Circle(-3 - left_late, 0, vx=1, id="left"),
        Circle(0, 0, id="middle"),
        Circle(4 + right_late, 0, r=2, vx=-1, m=4, id="right"),
    ]


def _ends(width: Quantity) -> list[Wall]:
    return [Wall(0, 0, 0, 1, id="start"), Wall(width, 0, width, 1, id="end")]


LEE = (
    "E. A. Lee, Fundamental limits of cyber-physical systems modeling, "
    "ACM Transactions on Cyber-Physical Systems 1 (2016), article 3"
)
BERNU = (
    "B. Bernu and R. Mazighi, One-dimensional bounce of inelastically colliding marbles on a wall, J. Phys. A 23 (1990)"
)
LEFT_FIRST = "(-11/5, -8/25, -3/25) if the left pair goes first"
RIGHT_FIRST = "(-8/5, -39/25, 1/25) if the right pair does"

SCENES = {
    "cradle": SceneEntry(
        name="cradle",
        summary="Newton's cradle: a striker and a row of equal balls between two walls.",
        parameters=(
            Parameter("n", "5", "balls in the row", whole(1, 200)),
            Parameter("r", "1", "radius of every ball", number(above=0)),
            Parameter("gap", "1/10", "gap between the balls of the row; 0 makes them touch", number(least=0)),
            TIE,
            Parameter("e", "1", "restitution; with gaps, the last ball is set off at ((1 + e)/2)**n", number(above=0)),
        ),
        known=(
            "Equal masses exchange their velocities, so that one ball moves at any time, at speed 1, "
            "and the state returns with period 2 L, where the free length L is the distance of the walls "
            "less all diameters."
        ),
        source=f"{ARTICLE} (Part 1: five balls in a row, gap=0)",
        make=cradle,
    ),
    "tennis": SceneEntry(
        name="tennis",
        summary="Tennis ball and basketball dropped together, as big balls between two walls.",
        parameters=(Parameter("big", "10", "radius of the basketball; its mass is the cube", number(least=2)),),
        known=(
            "The first bounce leaves the tennis ball at (1 - 3 m)/(1 + m) for a basketball of mass m: "
            "at -2999/1001 for big=10, with the basketball at -997/1001; at -3 for a very heavy one."
        ),
        source=f"{ARTICLE} (Part 1: big=10)",
        make=tennis,
    ),
    "sizes": SceneEntry(
        name="sizes",
        summary="Several balls dropped together, each heavier than the one above by the same ratio.",
        parameters=(
            Parameter("n", "3", "number of balls", whole(1, 12)),
            Parameter("ratio", "1000", "mass of each ball in that of the next smaller one", number(above=0)),
        ),
        known=(
            "In the limit of a large ratio, the first bounce leaves the balls, from the heavy end, at speeds "
            "1, 3, 7, 15...: each at twice that of the one before and 1 more."
        ),
        source=f"{ARTICLE} (notebooks: n=3, ratio=1000)",
        make=sizes,
    ),
    "galperin": SceneEntry(
        name="galperin",
        summary="A heavy ball pushes a light one against a wall: the number of collisions spells pi.",
        parameters=(Parameter("n", "2", "decimals of pi; the mass ratio is 100**n", whole(0, 7)),),
        known="Exactly floor(pi * 10**n) collisions: 3, 31, 314, 3141, 31415...",
        source="G. Galperin, Playing pool with pi, Regular and Chaotic Dynamics 8 (2003), 375-394",
        make=galperin,
    ),
    "lee": SceneEntry(
        name="lee",
        summary="Three balls on a line that meet in one instant: what comes out is a modelling choice.",
        parameters=(TIE,),
        known=f"simultaneous: (-2, -1, 0). sequential: {LEFT_FIRST}, {RIGHT_FIRST}.",
        source=LEE,
        make=lee,
    ),
    "near-tie": SceneEntry(
        name="near-tie",
        summary="Two collisions that share a ball, 10**-k apart in time: the order decides what comes out.",
        parameters=(
            Parameter("k", "20", "the collisions are 10**-k apart", whole(1, 1000)),
            Parameter("first", "left", "which pair goes first: left or right", one_of("left", "right")),
        ),
        known=(
            f"{LEFT_FIRST}, {RIGHT_FIRST}, for every k. An engine that takes the two for one instant gives "
            "(-2, -1, 0), or the other order."
        ),
        source=f"a perturbation of: {LEE}",
        make=near_tie,
    ),
    "beads": SceneEntry(
        name="beads",
        summary="A bead falls on others that rest on a wall: whether they bounce at all.",
        parameters=(
            Parameter("n", "2", "number of beads", whole(2, 8)),
            Parameter("e", "1/6", "restitution, of the wall too", number(above=0)),
        ),
        known=(
            "Up to a restitution of tan**2(pi/4 (1 - 1/n)) the pushes of the one instant have no end: "
            "3 - 2 sqrt(2) = 0.1716 for two beads, 1/3 for three."
        ),
        source=BERNU,
        make=beads,
    ),
    "collapse": SceneEntry(
        name="collapse",
        summary="Three equal discs on a line that lose so much energy that their hits have no end.",
        parameters=(Parameter("e", "1/20", "restitution", number(above=0)),),
        known=(
            "Below a restitution of 7 - 4 sqrt(3) = 0.0718 there are infinitely many hits in finite time; the speed at "
            "which two part follows u(k + 2) = (1 + e) / 2 u(k + 1) - e u(k). Above it the last hit leaves them apart."
        ),
        source=(
            "S. McNamara and W. R. Young, Inelastic collapse and clumping in a one-dimensional granular medium, "
            "Physics of Fluids A 4 (1992)"
        ),
        make=collapse,
    ),
}
