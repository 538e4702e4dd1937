"""Discs that fall, in a line, a wedge, or a gas without a lid; and discs that a wall comes nearer to."""

from __future__ import annotations

from ..numbers.quantity import Quantity
from ..scene import Scene
from ..things import Circle, Segment, Wall
from .article import SOURCE as ARTICLE
from .scene_entry import Draw, Parameter, SceneEntry, number, whole

FLOOR = Wall(0, 0, 1, 0, id="floor")


def bounce(h: Quantity, g: Quantity, e: Quantity) -> Scene:
    """One disc falls by h.

    >>> bounce(Quantity.of(5), Quantity.of(10), Quantity.of("1/2")).circles[0].y
    Quantity('6')
    """
    return Scene([Circle(0, h + 1, id="ball")], [FLOOR], gravity=(0, -g), restitution=e, events=400)


def drop_pair(big: Quantity, h: Quantity, gap: Quantity) -> Scene:
    """A disc of mass 1 close above one of mass `big`, which is h above the floor."""
    return Scene(
        [Circle(0, h + 1, m=big, id="basketball"), Circle(0, h + gap + "5/2", r="1/2", id="tennis")],
        [FLOOR],
        gravity=(0, -10),
        events=20,
    )


def falling_line(n: int, g: Quantity) -> Scene:
    """n discs above each other, of masses n to 1 from below.

    >>> [str(circle.m) for circle in falling_line(3, Quantity.of(1)).circles]
    ['3', '2', '1']
    """
    discs = [
        Circle(0, 3 * k + 2 + Quantity.of(f"{k * k}/7"), vy=Quantity.of(f"{(k % 3) - 1}/5"), m=n - k, id=f"b{k + 1}")
        for k in range(n)
    ]
    return Scene(discs, [FLOOR], gravity=(0, -g), events=60)


def wedge(slope: Quantity, vx: Quantity) -> Scene:
    """A disc between two walls that open upwards, at x = slope y and x = -slope y."""
    walls = [Wall(0, 0, slope, 1, id="right"), Wall(0, 0, -slope, 1, id="left")]
    return Scene([Circle("1/3", 8, r="1/2", vx=vx, id="ball")], walls, gravity=(0, -1), events=40)


def gas_under_gravity(n: int, seed: int, g: Quantity) -> Scene:
    """n small discs between two upright walls, above a floor, drawn from a seed."""
    draw, discs = Draw(seed), list[Circle]()
    for k in range(n):
        x = Quantity.of(f"{draw.between(-400, 400)}/1000") + 2 * (k % 4) - 3
        y = Quantity.of(f"{draw.between(-400, 400)}/1000") + 2 * (k // 4) + 1
        vx, vy = (Quantity.of(f"{draw.between(-1000, 1000)}/1000") for _ in range(2))
        discs.append(Circle(x, y, r="1/10", vx=vx, vy=vy, id=f"d{k + 1}"))
    sides = [Wall(-4, 0, -4, 1, id="left"), Wall(4, 0, 4, 1, id="right")]
    return Scene(discs, [FLOOR, *sides], gravity=(0, -g), events=200)


def closing_wall(length: Quantity, v: Quantity, u: Quantity) -> Scene:
    """A disc between a wall and one that comes nearer; its centre starts in the middle of a way of `length`.

    >>> closing_wall(Quantity.of(8), Quantity.of(1), Quantity.of("1/10")).closing[0].time.text()
    '80'
    """
    walls = [Wall(-1, 0, -1, 1, id="left"), Wall(length + 1, 0, length + 1, 1, id="right", vx=-u)]
    return Scene([Circle(length / 2, 0, vx=v, id="ball")], walls, events=400)


def piston(n: int, seed: int, u: Quantity) -> Scene:
    """n small discs in a box, drawn from a seed, whose right wall moves in to half of it."""
    draw, discs = Draw(seed), list[Circle]()
    for k in range(n):
        x = Quantity.of(f"{draw.between(-300, 300)}/1000") + k % 4 + "1/2"
        y = Quantity.of(f"{draw.between(-300, 300)}/1000") + k // 4 + "1/2"
        vx, vy = (Quantity.of(f"{draw.between(-1000, 1000)}/1000") for _ in range(2))
        discs.append(Circle(x, y, r="1/20", vx=vx, vy=vy, id=f"d{k + 1}"))
    top = (n + 3) // 4
    walls = [
        Wall(0, 0, 0, 1, id="left"), Wall(0, 0, 1, 0, id="bottom"), Wall(0, top, 1, top, id="top"),
        Wall(4, 0, 4, 1, id="piston", vx=-u),
    ]  # fmt: skip
    return Scene(discs, walls, until=2 / u)


def landing(h: Quantity, v: Quantity, m: Quantity) -> Scene:
    """A disc that flies to the right falls by h, and stops falling on a floor; another, of mass m, falls in its way.

    >>> [str(circle.y) for circle in landing(Quantity.of(5), Quantity.of(2), Quantity.of(3)).circles]
    ['6', '4']
    """
    way = 3 + v * (2 * h / 10).sqrt()
    discs = [Circle(0, h + 1, vx=v, id="slider"), Circle(way, "3/5" * h + 1, m=m, id="sitter")]
    return Scene(discs, [FLOOR], gravity=(0, -10), restitution=0, settle=True, events=10)


def struck(n: int, vx: Quantity) -> Scene:
    """A disc is thrown onto n discs that lie on a floor between two upright walls."""
    lying = [Circle(Quantity.of("1/3") + 3 * k, 1, id=f"d{k + 1}") for k in range(n)]
    sides = [Wall(-8, 0, -8, 1, id="left"), Wall(3 * n + 2, 0, 3 * n + 2, 1, id="right")]
    return Scene([Circle(-6, 6, vx=vx, id="thrown"), *lying], [FLOOR, *sides], gravity=(0, -10), settle=True, events=40)


def paddle(u: Quantity, h: Quantity, vx: Quantity) -> Scene:
    """A disc falls by h, to the right, onto a paddle that rises."""
    bat = Segment(-1, 0, 8, 0, "paddle", vy=u)
    return Scene([Circle(0, h + 1, vx=vx, id="ball")], segments=[bat], gravity=(0, -10), until=20)


G = Parameter("g", "1", "gravity", number(above=0))

SCENES = {
    "bounce": SceneEntry(
        name="bounce",
        summary="A disc is dropped on a floor, and bounces lower each time.",
        parameters=(
            Parameter("h", "5", "how far it falls", number(above=0)),
            Parameter("g", "10", "gravity", number(above=0)),
            Parameter("e", "9/10", "restitution", number(above=0)),
        ),
        known="Infinitely many bounces end at the time sqrt(2 h / g) (1 + e) / (1 - e), exactly.",
        source="school physics: a geometric series",
        make=bounce,
    ),
    "drop-pair": SceneEntry(
        name="drop-pair",
        summary="A tennis ball dropped on top of a basketball, under gravity.",
        parameters=(
            Parameter("big", "9", "mass of the lower, of the upper's", number(above=0)),
            Parameter("h", "5", "how far the lower falls", number(above=0)),
            Parameter("gap", "1/100", "between the two", number(above=0)),
        ),
        known=(
            "As the gap vanishes the upper is thrown back at (3 big - 1) / (big + 1) times the speed of the fall: "
            "at 3 times it, and 9 times as high, where the lower is much heavier."
        ),
        source=f"{ARTICLE} (Part 1: the tennis ball and the basketball, there without gravity)",
        make=drop_pair,
    ),
    "falling-line": SceneEntry(
        name="falling-line",
        summary="Discs above each other fall on a floor, the heavier ones below.",
        parameters=(Parameter("n", "3", "number of discs", whole(2, 8)), G),
        known="With masses that do not increase upwards it is ergodic for almost every choice of them (a preprint).",
        source=(
            "M. P. Wojtkowski, A system of one dimensional balls with gravity, Comm. Math. Phys. 126 (1990); "
            "N. Simanyi, arXiv:2407.12033"
        ),
        make=falling_line,
    ),
    "wedge": SceneEntry(
        name="wedge",
        summary="A disc falls between two walls that open upwards.",
        parameters=(
            Parameter("slope", "1", "tangent of half of the angle between the walls", number(above=0)),
            Parameter("vx", "1/5", "velocity to the right", number()),
        ),
        known=(
            "At half of a right angle (slope 1) the motions across the two walls do not touch each other: each wall is "
            "hit at equal intervals of time. Where the walls are wider apart it is chaotic."
        ),
        source="H. E. Lehtihet and B. N. Miller, Physica D 21 (1986); M. P. Wojtkowski, Comm. Math. Phys. 126 (1990)",
        make=wedge,
    ),
    "gas-under-gravity": SceneEntry(
        name="gas-under-gravity",
        summary="Small discs between two upright walls, above a floor, without a lid.",
        parameters=(
            Parameter("n", "6", "number of discs", whole(2, 40)),
            Parameter("seed", "1", "seed of the draw", whole(0, 10**9)),
            G,
        ),
        known=(
            "While it is dilute, a disc is at height y with density (1 - m g y / E)**(2 n - 2), the barometric formula "
            "as n grows; half of the energy E is that of height."
        ),
        source="the microcanonical ensemble of n particles in the plane",
        make=gas_under_gravity,
    ),
    "closing-wall": SceneEntry(
        name="closing-wall",
        summary="A disc between a wall and one that comes nearer at a constant speed.",
        parameters=(
            Parameter("length", "8", "way between the walls at the start", number(above=0)),
            Parameter("v", "1", "speed of the disc, to the wall that moves", number(above=0)),
            Parameter("u", "1/10", "speed of that wall", number(above=0)),
        ),
        known=(
            "Its n-th hit on the wall that moves, where it has the way d left, leaves it at the speed v + 2 n u, and "
            "d (v + (2 n - 1) u) is the same for every n, exactly. It is crushed at length / u. This is not the model "
            "of Fermi and Ulam, whose wall goes to and fro."
        ),
        source="school physics: each round is 2 d / (v + (2 n + 1) u) long",
        make=closing_wall,
    ),
    "piston": SceneEntry(
        name="piston",
        summary="A dilute gas of discs, which a wall presses to half of its room.",
        parameters=(
            Parameter("n", "8", "number of discs", whole(2, 40)),
            Parameter("seed", "1", "seed of the draw", whole(0, 10**9)),
            Parameter("u", "1/50", "speed of the wall", number(above=0)),
        ),
        known=(
            "A wall that is slow beside the discs does work at the pressure E / A of a gas in the plane: the energy "
            "E times the area A stays nearly the same where collisions share it out, and E is doubled."
        ),
        source="kinetic theory: the adiabatic law with the exponent 2 of two degrees of freedom",
        make=piston,
    ),
    "landing": SceneEntry(
        name="landing",
        summary="A disc lands without a bounce, slides along the floor, and pushes another that has landed.",
        parameters=(
            Parameter("h", "5", "how far it falls", number(above=0)),
            Parameter("v", "2", "its speed to the right", number(above=0)),
            Parameter("m", "3", "mass of the other one", number(above=0)),
        ),
        known=(
            "It lands at sqrt(2 h / 10), the other at sqrt(3/5) times that; it slides for 1 / v, "
            "and the two go on together at v / (1 + m), all exactly."
        ),
        source="school physics: a completely inelastic collision keeps the momentum",
        make=landing,
    ),
    "struck": SceneEntry(
        name="struck",
        summary="A disc is thrown onto others that lie on a floor; what it strikes leaves the floor.",
        parameters=(
            Parameter("n", "3", "number of discs that lie there", whole(1, 6)),
            Parameter("vx", "3", "speed of the one that is thrown, to the right", number(above=0)),
        ),
        known="The energy is kept, and each disc lies where it was until something comes to it.",
        source="school physics: the floor pushes only against what comes to it",
        make=struck,
    ),
    "paddle": SceneEntry(
        name="paddle",
        summary="A disc bounces on a paddle that rises at a constant speed, until it comes to its end.",
        parameters=(
            Parameter("u", "1", "speed of the paddle, upwards", number(above=0)),
            Parameter("h", "4", "how far above the paddle the disc starts", number(above=0)),
            Parameter("vx", "1/2", "speed of the disc, to the right", number(above=0)),
        ),
        known=(
            "As seen from the paddle the disc is thrown down at the speed u, and lands at w = sqrt(u**2 + 20 h) each "
            "time: first after (w - u) / 10, then every w / 5. It leaves at w + u upwards, until its centre is "
            "beyond the end of the paddle."
        ),
        source="school physics: gravity is the same in a frame of constant velocity",
        make=paddle,
    ),
}
