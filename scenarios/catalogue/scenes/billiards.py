"""Billiards with published numbers: mirrors on a lattice, a folded lattice, two discs in a box, an open pinball."""

from __future__ import annotations

from ...errors import SceneError
from ...numbers.quantity import Quantity
from ...scene import Scene
from ...things import Circle, Wall
from ..angles import cosine, sine
from ..draw import Draw
from ..entry import Parameter, SceneEntry
from ..settings import number, whole

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
}
