"""Discs in a square box, drawn from a seed: chaos, its reversal, and a gas far from equilibrium that is turned back."""

from __future__ import annotations

from math import isqrt

from ..errors import SceneError
from ..numbers.quantity import Quantity
from ..scene import MAX_CIRCLES, Scene
from ..things import Circle, Wall
from .article import SOURCE as ARTICLE
from .scene_entry import Draw, Parameter, SceneEntry, automatic, number, whole, yes_no

# -- Discs in a square box, drawn from a seed: chaos, and its reversal.

EVENTS = 400

GRAIN = 1000
"""Positions and velocities are multiples of one thousandth: decimals that no double holds exactly."""

TRIES = 2000
"""Places tried for one disc before the box counts as full."""

AREA = 31
"""Area of the box for each disc of radius 1, where none is asked for: the discs then cover a tenth of it."""

MIXED = (500, 750, 1000, 1250, 1500)
"""Radii of a mixed gas, in thousandths; the mass is the square of the radius."""


def gas(n: int, seed: int, size: int | None, mixed: bool) -> Scene:
    """n discs that do not touch, in a box with sides of length `size`, at up to 1 in vx and in vy.

    Raises:
        SceneError: if no place is found for a disc.

    >>> len(gas(10, 1, None, False).circles)
    10
    """
    return Scene(*_box(n, seed, size, mixed), events=EVENTS)


def reversal(n: int, seed: int, size: int | None, mixed: bool, after: int) -> Scene:
    """The scene `gas`, every velocity negated once after `after` instants, run until it is back.

    >>> reversal(5, 1, None, False, 20).reverse_after
    20
    """
    return Scene(*_box(n, seed, size, mixed), reverse_after=after)


def cooling(n: int, seed: int, e: Quantity) -> Scene:
    """The scene `gas` with a restitution.

    >>> cooling(5, 1, Quantity.of("9/10")).restitution
    Quantity('9/10')
    """
    return Scene(*_box(n, seed, None, False), events=EVENTS, restitution=e)


def _box(n: int, seed: int, size: int | None, mixed: bool) -> tuple[list[Circle], list[Wall]]:
    side = isqrt(AREA * n) + 1 if size is None else size
    draw = Draw(seed)
    room = _Room(side * GRAIN)
    circles: list[Circle] = []
    for number in range(1, n + 1):
        r = MIXED[draw.between(0, len(MIXED) - 1)] if mixed else GRAIN
        x, y = room.place(draw, r, number)
        vx, vy = draw.between(-GRAIN, GRAIN), draw.between(-GRAIN, GRAIN)
        radius = Quantity.of(r) / GRAIN
        circles.append(
            Circle(
                Quantity.of(x) / GRAIN,
                Quantity.of(y) / GRAIN,
                r=radius,
                vx=Quantity.of(vx) / GRAIN,
                vy=Quantity.of(vy) / GRAIN,
                m=radius * radius,
                id=f"c{number}",
            )
        )
    return circles, _walls(side)


class _Room:
    """Discs placed so far in a square, in thousandths, by the cell of their centre: wide enough that only neighbours
    can meet."""

    CELL = 2 * max(MIXED)

    def __init__(self, side: int) -> None:
        self.side = side
        self.cells: dict[tuple[int, int], list[tuple[int, int, int]]] = {}

    def place(self, draw: Draw, r: int, number: int) -> tuple[int, int]:
        """A place drawn for the next disc where it meets no other, and now holds it."""
        low, high = r + 1, self.side - r - 1
        for _ in range(TRIES if high > low else 0):
            x, y = draw.between(low, high), draw.between(low, high)
            if self.is_free(x, y, r):
                self.cells.setdefault((x // self.CELL, y // self.CELL), []).append((x, y, r))
                return x, y
        raise SceneError(f"no room for disc {number} in a box of size {self.side // GRAIN}; raise size, or lower n")

    def is_free(self, x: int, y: int, r: int) -> bool:
        column, row = x // self.CELL, y // self.CELL
        return all(
            (x - a) ** 2 + (y - b) ** 2 > (r + c) ** 2
            for i in (column - 1, column, column + 1)
            for j in (row - 1, row, row + 1)
            for a, b, c in self.cells.get((i, j), ())
        )


def _walls(side: int) -> list[Wall]:
    return [
        Wall(0, 0, 0, 1, id="left"),
        Wall(side, 0, side, 1, id="right"),
        Wall(0, 0, 1, 0, id="bottom"),
        Wall(0, side, 1, side, id="top"),
    ]


SINAI = "Y. G. Sinai, Dynamical systems with elastic reflections, Russian Mathematical Surveys 25 (1970), 137-189"

PARAMETERS = (
    Parameter("n", "10", "number of discs", whole(1, MAX_CIRCLES)),
    Parameter("seed", "1", "seed of the positions and velocities", whole(0, 10**9)),
    Parameter("size", "auto", "side of the box; auto leaves nine tenths free", automatic(whole(3, MAX_CIRCLES))),
    Parameter("mixed", "no", "yes draws radii from 1/2 to 3/2; the mass is their square", yes_no),
)


# -- A gas that starts far from equilibrium, and whose velocities are all turned back once.

ECHO_GRAIN = 1000
"""Places and directions are made of thousandths."""

SPACING = 6
"""Between neighbours of the lattice, in radii: the gas is dilute, as theirs was."""

JITTER = 1500
"""Largest displacement from the lattice, in thousandths, so that no two contacts fall on one instant."""

SOURCE = "J. Orban and A. Bellemans, Physics Letters 24A (1967), 620 (recalled): reversal of a dilute gas of hard disks"


def echo(rows: int, after: int, seed: int) -> Scene:
    """rows x rows discs near a lattice, all at speed 1 in directions drawn from a seed, turned back after some events.

    >>> scene = echo(3, 20, 1)
    >>> len(scene.circles), scene.reverse_after, {c.vx**2 + c.vy**2 == 1 for c in scene.circles}
    (9, 20, {True})
    """
    draw = Draw(seed)
    circles: list[Circle] = []
    for row in range(rows):
        for column in range(rows):
            x, y = (SPACING * k + SPACING // 2 + Quantity.of(draw.between(-JITTER, JITTER)) / ECHO_GRAIN
                    for k in (column, row))  # fmt: skip
            p, q = draw.between(1, ECHO_GRAIN - 1), draw.between(1, ECHO_GRAIN - 1)
            norm = Quantity.of(p * p + q * q)
            c, s = (p * p - q * q) / norm, 2 * p * q / norm
            vx, vy = ((c, s), (-c, -s))[draw.between(0, 1)]
            circles.append(Circle(x, y, vx=vx, vy=vy, id=f"c{len(circles) + 1}"))
    side = rows * SPACING
    walls = [Wall(0, 0, 0, 1, id="left"), Wall(side, 0, side, 1, id="right"),
             Wall(0, 0, 1, 0, id="bottom"), Wall(0, side, 1, side, id="top")]  # fmt: skip
    return Scene(circles, walls, reverse_after=after)


SCENES = {
    "gas": SceneEntry(
        name="gas",
        summary="Hard discs in a box, drawn from a seed: every hit of two makes rounding errors grow.",
        parameters=PARAMETERS,
        known=(
            "Hard discs are chaotic (Sinai 1970): a run in doubles keeps the true order of events for some "
            "hundreds of them at most. Energy is conserved, and says nothing of that."
        ),
        source=SINAI,
        make=gas,
    ),
    "reversal": SceneEntry(
        name="reversal",
        summary="A gas whose velocities are all negated once: physics runs back to the start, floats do not.",
        parameters=(
            *PARAMETERS,
            Parameter("after", "150", "reverse after this many instants", whole(1, 100_000)),
        ),
        known="After as many instants again, every disc is back where it began, with its velocity negated.",
        source=f"{ARTICLE} (World.reverse)",
        make=reversal,
    ),
    "echo": SceneEntry(
        name="echo",
        summary="A gas of one speed, reversed on its way to equilibrium: H returns, if nothing is lost.",
        parameters=(
            Parameter("rows", "10", "discs in a row of the lattice", whole(2, 30)),
            Parameter("after", "300", "turn back after this many instants", whole(1, 100_000)),
            Parameter("seed", "1", "seed of places and directions", whole(0, 10**9)),
        ),
        known=(
            "Boltzmann's H falls as the speeds spread, and has its first value again when the gas is back: every disc "
            "is where it began, with its velocity negated."
        ),
        source=SOURCE,
        make=echo,
    ),
    "cooling": SceneEntry(
        name="cooling",
        summary="A gas of discs that lose energy at each hit: Haff's law of cooling.",
        parameters=(
            Parameter("n", "50", "number of discs", whole(2, 2_000)),
            Parameter("seed", "1", "seed of the positions and velocities", whole(0, 10**9)),
            Parameter("e", "9/10", "restitution", number(above=0)),
        ),
        known=(
            "While it stays homogeneous, each hit, of two discs or of a wall, takes 1 - e**2 of the mean energy of a disc: "
            "after k hits there is left exp(-(1 - e**2) k/n) of the energy (Haff's law, by count instead of time, with "
            "nothing to fit)."
        ),
        source="P. K. Haff, Grain flow as a fluid-mechanical phenomenon, Journal of Fluid Mechanics 134 (1983), 401-430",
        make=cooling,
    ),
}
