"""Discs in a square box, drawn from a seed: chaos, and its reversal."""

from __future__ import annotations

from math import isqrt

from ...errors import SceneError
from ...numbers.quantity import Quantity
from ...scene import MAX_CIRCLES, Scene
from ...things import Circle, Wall
from ..draw import Draw
from ..entry import Parameter, SceneEntry
from ..settings import automatic, whole, yes_no
from .article import SOURCE as ARTICLE

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
}
