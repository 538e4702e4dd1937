"""Billiards: balls among fixed discs, mirrors on a lattice, and others with published numbers."""

from __future__ import annotations

from ..errors import SceneError
from ..numbers.quantity import Quantity
from ..scene import Scene
from ..things import Circle, Wall
from .gas import SINAI
from .scene_entry import Draw, Parameter, SceneEntry, cosine, number, one_of, sine, whole

# -- Billiards with published numbers: mirrors on a lattice, a folded lattice, two discs in a box, an open pinball.

EVENTS = 300

GRAIN = 1000
"""Places and directions that are drawn are multiples of one thousandth, or made of them."""

CHALLENGE = (
    "L. N. Trefethen, A Hundred-Dollar, Hundred-Digit Challenge, SIAM News 35 (2002), problem 2; "
    "F. Bornemann, D. Laurie, S. Wagon, J. Waldvogel, The SIAM 100-Digit Challenge, SIAM (2004)"
)
PINBALL = "P. Gaspard and S. A. Rice, Scattering from a classically chaotic repellor, J. Chem. Phys. 90 (1989), 2225"
FOLDED = "DynamicalBilliards.jl (G. Datseris), documentation, Lyapunov exponents of the periodic Sinai billiard"
IN_A_BOX = (
    "W. Zapfe, D. P. Sanders, R. Rodriguez-Mota, arXiv:1908.04749; ergodic: N. Simanyi, Ergodicity of hard spheres in "
    "a box, Ergodic Theory Dynam. Systems 19 (1999), 741"
)


def siam(t: int) -> Scene:
    """A point among mirrors of radius 1/3 at every lattice point that it can reach until time t.

    >>> scene = siam(2)
    >>> len(scene.circles), scene.until
    (17, Quantity('2'))
    """
    x, y, reach = Quantity.of("1/2"), Quantity.of("1/10"), t + Quantity.of("1/3")
    photon = Circle(x, y, r=0, vx=1, id="photon", point=True)
    near = range(-t - 1, t + 3)
    mirrors = [
        Circle(i, j, r="1/3", m="oo", id=f"{i},{j}")
        for j in near
        for i in near
        if (i - x) ** 2 + (j - y) ** 2 <= reach**2
    ]
    return Scene([photon, *mirrors], until=t)


def hexagon(d: Quantity, vx: Quantity, vy: Quantity) -> Scene:
    """A point around one disc of radius 1 in six walls: the triangular lattice of spacing d, folded.

    A mirror image in the middle between two neighbouring discs maps the lattice to itself, so the path between the
    walls is the path in the lattice, folded. It starts half way from the disc to a corner of the cell.

    >>> len(hexagon(Quantity.of("21/10"), Quantity.of(1), Quantity.of(0)).walls)
    6
    """
    half = d / 2
    corner = d / Quantity.of("sqrt(3)")
    walls: list[Wall] = []
    for k in range(6):
        c, s = cosine(120 * k), sine(120 * k)
        walls.append(Wall(half * c, half * s, half * c - s, half * s + c, id=f"side {k + 1}"))
    away = (1 + corner) / 2
    ball = Circle(away * cosine(60), away * sine(60), r=0, vx=vx, vy=vy, id="ball", point=True)
    return Scene([ball, Circle(0, 0, m="oo", id="disc")], walls, events=EVENTS)


def two_in_a_box(size: Quantity, r: Quantity, seed: int) -> Scene:
    """Two discs in a square, each at speed 7/10, in places and directions drawn from a seed.

    Raises:
        SceneError: for discs that do not both fit.

    >>> a, b = two_in_a_box(Quantity.of(1), Quantity.of("1/10"), 1).circles
    >>> a.vx**2 + a.vy**2 + b.vx**2 + b.vy**2 == Quantity.of("98/100")
    True
    """
    room = size - 2 * r
    if 2 * room * room <= 9 * r * r:
        raise SceneError(
            f"r = {r} leaves too little room for two discs in a square of size {size}; lower r, or raise size"
        )
    draw = Draw(seed)
    while True:
        places = [(r + room * draw.between(1, GRAIN - 1) / GRAIN, r + room * draw.between(1, GRAIN - 1) / GRAIN)
                  for _ in range(2)]  # fmt: skip
        (ax, ay), (bx, by) = places
        if (ax - bx) ** 2 + (ay - by) ** 2 > 4 * r * r:
            break
    speed = Quantity.of("7/10")
    circles: list[Circle] = []
    for name, (x, y) in zip(("a", "b"), places, strict=True):
        c, s = _direction(draw)
        circles.append(Circle(x, y, r=r, vx=speed * c, vy=speed * s, id=name))
    zero = Quantity.of(0)
    walls = [Wall(zero, 0, zero, 1, id="left"), Wall(size, 0, size, 1, id="right"),
             Wall(0, zero, 1, zero, id="bottom"), Wall(0, size, 1, size, id="top")]  # fmt: skip
    return Scene(circles, walls, events=EVENTS)


def three_disc(distance: Quantity, seed: int) -> Scene:
    """A point in the middle of three fixed discs of radius 1, flying off in a direction drawn from a seed.

    >>> [c.fixed for c in three_disc(Quantity.of(6), 1).circles]
    [False, True, True, True]
    """
    draw = Draw(seed)
    c, s = _direction(draw)
    far = distance / Quantity.of("sqrt(3)")
    discs = [Circle(far * cosine(240 * k), far * sine(240 * k), m="oo", id=f"disc {k + 1}") for k in range(3)]
    return Scene([Circle(0, 0, r=0, vx=c, vy=s, id="ball", point=True), *discs], events=EVENTS)


def _direction(draw: Draw) -> tuple[Quantity, Quantity]:
    """A unit vector of rational numbers, in one of four quarters."""
    t = Quantity.of(draw.between(0, GRAIN * GRAIN)) / (GRAIN * GRAIN)
    c, s = (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)
    quarter = draw.between(0, 3)
    return [(c, s), (-s, c), (-c, -s), (s, -c)][quarter]


# -- One ball among fixed discs: pinball, the Lorentz gas, and Sinai's billiard.

SCATTERER_EVENTS = 60

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
    return Scene([ball, *_fixed(centres, Quantity.of(1))], events=SCATTERER_EVENTS)


def lorentz(rows: int, spacing: Quantity, r: Quantity, vx: Quantity, vy: Quantity) -> Scene:
    """A ball among rows * rows fixed discs of radius 1 on a square grid, in a box half a spacing wider.

    >>> one = Quantity.of(1)
    >>> len(lorentz(3, 4 * one, one / 4, one, one / 3).circles)
    10
    """
    centres = [(spacing * column, spacing * row) for row in range(rows) for column in range(rows)]
    ball = _ball(spacing / 2, spacing / 2, r, vx, vy)
    low, high = -spacing / 2, spacing * (2 * rows - 1) / 2
    return Scene([ball, *_fixed(centres, Quantity.of(1))], _square(low, high), events=SCATTERER_EVENTS)


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
    return Scene([ball, *_fixed([(centre, centre)], disc)], _square(Quantity.of(0), size), events=SCATTERER_EVENTS)


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
    "siam": SceneEntry(
        name="siam",
        summary="A photon among circular mirrors on a lattice: ten digits of where it is at t = 10.",
        parameters=(Parameter("t", "10", "the time until which it flies", whole(1, 50)),),
        known=(
            "At t = 10 it is 0.9952629194433541608903118094267216210294669227341543498032088580729861796228306 from "
            "the origin, after 14 hits."
        ),
        source=CHALLENGE,
        make=siam,
    ),
    "hexagon": SceneEntry(
        name="hexagon",
        summary="The triangular Lorentz gas, folded into one cell by six walls.",
        parameters=(
            Parameter("d", "21/10", "distance of neighbouring discs, whose radius is 1", number(above=2)),
            Parameter("vx", "3/5", "velocity in x", number()),
            Parameter("vy", "4/5", "velocity in y", number()),
        ),
        known="The speed never changes; the billiard is ergodic, and its exponent falls as d grows.",
        source=FOLDED,
        make=hexagon,
    ),
    "two-in-a-box": SceneEntry(
        name="two-in-a-box",
        summary="Two discs in a square: how often they meet is known in closed form.",
        parameters=(
            Parameter("size", "1", "side of the square", number(above=0)),
            Parameter("r", "1/10", "radius of the discs", number(above=0)),
            Parameter("seed", "1", "seed of places and directions", whole(0, 10**9)),
        ),
        known=(
            "With a = size - 2 r, s = 2 r/a, F = pi s**2 - 8 s**3/3 + s**4/2 they meet "
            "2 sqrt(2)/(3 pi) V F'/(a (1 - F)) times a unit of time, V**2 = v1**2 + v2**2: 0.485268 with the defaults."
        ),
        source=IN_A_BOX,
        make=two_in_a_box,
    ),
    "three-disc": SceneEntry(
        name="three-disc",
        summary="A point escapes from between three discs: few stay long.",
        parameters=(
            Parameter("distance", "6", "distance of the centres, in radii", number(above=2)),
            Parameter("seed", "1", "seed of the direction", whole(0, 10**9)),
        ),
        known="The share that has not escaped falls as exp(-0.4103384 t) at distance 6.",
        source=PINBALL,
        make=three_disc,
    ),
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
