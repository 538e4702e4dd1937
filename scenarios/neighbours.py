"""Which circles and walls may touch, found in doubles; which do, or overlap, decided exactly."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import floor, frexp, hypot, inf, isfinite
from typing import TypeAlias

from .errors import SceneError
from .numbers.quantity import Quantity
from .things import Circle, Squeeze, Wall

# -- Which circles and walls may touch: found in doubles with a bound on their rounding, never decided by them.

ROUNDING = 2.0**-48
"""What boxes are widened by, as a share of the coordinates and the radius: 32 units in the last place. Rounding to
doubles, adding the radius and taking the ends of a box lose fewer than 8 together."""

TINIEST = 2.0**-1000
"""Beyond what is lost near zero, where doubles get sparse: widens boxes, and is added to what a height must exceed."""

LARGEST = 1e100
"""Beyond this a product of two coordinates might overflow: such circles are compared with all others."""

Box: TypeAlias = tuple[float, float, float]
"""A centre, and half the width of a square around it that holds the circle for certain."""


def box(circle: Circle) -> Box | None:
    """The circle's box; None where it is beyond what doubles can be trusted with."""
    try:
        x, y, r = float(circle.x), float(circle.y), float(circle.r)
    except OverflowError:
        return None
    size = abs(x) + abs(y) + r
    return (x, y, r + ROUNDING * size + TINIEST) if size < LARGEST else None


class Neighbourhood:
    """Boxes in cells of a grid, one grid for each power of two among their sizes.

    A box is entered in the grid whose cells are as wide as it is, at the cell of its centre, and in every coarser
    one. So what may touch it is in the few cells around it: in its own grid what is no larger than it, in each coarser
    one what is of that size. With circles that do not overlap, few share a cell, and looking one up costs the same
    however many there are.

    Source: C. Ericson, *Real-Time Collision Detection* (2004), 7.2.1 (hierarchical grids).

    >>> near = Neighbourhood([(0.0, 0.0, 1.0), (1.5, 0.0, 1.0), (9.0, 0.0, 1.0), None])
    >>> for k in range(4):
    ...     print(near.around(k))
    ...     near.enter(k)
    []
    [0]
    []
    [0, 1, 2]
    """

    def __init__(self, boxes: Sequence[Box | None]) -> None:
        self._boxes = boxes
        self._levels = [None if b is None else _level(b) for b in boxes]
        sizes = sorted({level for level in self._levels if level is not None})
        self._coarser = {level: sizes[k + 1 :] for k, level in enumerate(sizes)}
        self._same: dict[tuple[int, int, int], list[int]] = {}
        self._finer: dict[tuple[int, int, int], list[int]] = {}
        self._anywhere: list[int] = []
        self._entered: list[int] = []

    def enter(self, k: int) -> None:
        """Lets those that come after it find box k."""
        b, level = self._boxes[k], self._levels[k]
        self._entered.append(k)
        if b is None or level is None:
            self._anywhere.append(k)
            return
        self._same.setdefault(_cell(level, b[0], b[1]), []).append(k)
        for coarser in self._coarser[level]:
            self._finer.setdefault(_cell(coarser, b[0], b[1]), []).append(k)

    def around(self, k: int) -> list[int]:
        """Those entered whose boxes meet box k, ascending."""
        b, level = self._boxes[k], self._levels[k]
        if b is None or level is None:
            return list(self._entered)
        found = list(self._anywhere)
        for cell in _cells(level, b):
            found += self._meeting(b, self._same.get(cell))
            found += self._meeting(b, self._finer.get(cell))
        for coarser in self._coarser[level]:
            for cell in _cells(coarser, b):
                found += self._meeting(b, self._same.get(cell))
        return sorted(found)

    def _meeting(self, b: Box, others: list[int] | None) -> list[int]:
        if others is None:
            return []
        x, y, half = b
        met: list[int] = []
        for k in others:
            other = self._boxes[k]
            if other is not None:
                reach = half + other[2]
                if abs(x - other[0]) <= reach and abs(y - other[1]) <= reach:
                    met.append(k)
        return met


def _level(b: Box) -> int:
    """The least power of two that is at least the width of a box."""
    return frexp(2 * b[2])[1]


def _cell(level: int, x: float, y: float) -> tuple[int, int, int]:
    width = 2.0**level
    return level, floor(x / width), floor(y / width)


def _cells(level: int, b: Box) -> list[tuple[int, int, int]]:
    """The cells that hold the centres of boxes, no wider than a cell, that meet this one."""
    width = 2.0**level
    reach = b[2] / width + 0.5 + ROUNDING * (2 + (abs(b[0]) + abs(b[1])) / width)
    x, y = b[0] / width, b[1] / width
    columns = range(floor(x - reach), floor(x + reach) + 1)
    rows = range(floor(y - reach), floor(y + reach) + 1)
    return [(level, column, row) for column in columns for row in rows]


class NearWalls:
    """The walls that a circle may reach, by its distance from them in doubles with a bound on the rounding.

    With a height h = nx (x - x0) + ny (y - y0) over a wall of normal (nx, ny), a circle is clear of it if |h| exceeds
    r |n| by more than what rounding can have added or taken.
    """

    def __init__(self, walls: Sequence[Wall]) -> None:
        self._rough = [_rough_wall(wall) for wall in walls]

    def around(self, b: Box | None) -> list[int]:
        """The walls that are not clear of what is in a box around a circle."""
        if b is None:
            return list(range(len(self._rough)))
        x, y, half = b
        found: list[int] = []
        for k, (x0, y0, nx, ny, length, slack) in enumerate(self._rough):
            height = abs(nx * (x - x0) + ny * (y - y0))
            lost = slack * (abs(x) + abs(x0) + abs(y) + abs(y0) + half)
            if not height > half * length + lost + TINIEST:
                found.append(k)
        return found


def _rough_wall(wall: Wall) -> tuple[float, float, float, float, float, float]:
    """x0, y0, the normal, its length, and by how much of the coordinates a height may be off."""
    try:
        x0, y0, x1, y1 = (float(q) for q in (wall.x0, wall.y0, wall.x1, wall.y1))
        nx, ny = (float(q) for q in wall.normal)
    except OverflowError:
        return 0.0, 0.0, 0.0, 0.0, inf, inf
    size = max(abs(q) for q in (x0, y0, x1, y1))
    length = hypot(nx, ny)
    if not (size < LARGEST and isfinite(length) and length > 1 / LARGEST):
        return 0.0, 0.0, 0.0, 0.0, inf, inf
    return x0, y0, nx, ny, length, ROUNDING * length


# -- Checks, exactly, that no circle of a scene overlaps another or crosses a wall, and finds what touches.


def check_apart(circles: Sequence[Circle], walls: Sequence[Wall]) -> tuple[tuple[int, int], ...]:
    """Refuses overlapping circles and circles across walls; touching is fine.

    Only what is near is looked at, so the work grows with the number of circles, not with its square.

    Returns:
        The pairs at gap zero, ascending, by index: walls come after all circles.

    Raises:
        SceneError: naming the pair, the overlap and the remedy.

    >>> check_apart([Circle(0, 0), Circle("sqrt(2)", "sqrt(2)"), Circle(5, 5)], [Wall(-1, 0, -1, 1)])
    ((0, 1), (0, 3))
    """
    boxes = [box(circle) for circle in circles]
    pairs = list(_touching_pairs(circles, boxes))
    return tuple(sorted([*pairs, *_touching_walls(circles, walls, boxes)]))


def _touching_pairs(circles: Sequence[Circle], boxes: Sequence[Box | None]) -> Iterator[tuple[int, int]]:
    near = Neighbourhood(boxes)
    for j, circle in enumerate(circles):
        for i in near.around(j):
            if _touch(circles[i], circle):
                yield i, j
        near.enter(j)


def _touch(a: Circle, b: Circle) -> bool:
    dx, dy, reach = b.x - a.x, b.y - a.y, a.r + b.r
    sign = (dx * dx + dy * dy - reach * reach).sign()
    if sign < 0:
        overlap = reach - (dx * dx + dy * dy).sqrt()
        raise SceneError(
            f"circle {b.id!r}: overlaps {a.id!r} by {shown_amount(overlap)} at time 0; move it, or reduce r"
        )
    if sign == 0 and reach.sign() == 0:
        raise SceneError(f"circle {b.id!r}: is the same point as {a.id!r}; move it")
    return sign == 0


def _touching_walls(
    circles: Sequence[Circle], walls: Sequence[Wall], boxes: Sequence[Box | None]
) -> Iterator[tuple[int, int]]:
    near = NearWalls(walls)
    for i, circle in enumerate(circles):
        for k in near.around(boxes[i]):
            if _touches_wall(circle, walls[k]):
                yield i, len(circles) + k


def _touches_wall(circle: Circle, wall: Wall) -> bool:
    nx, ny = wall.normal
    height = wall.height(circle.x, circle.y)
    length2 = nx * nx + ny * ny
    sign = (height * height - circle.r * circle.r * length2).sign()
    if sign < 0:
        overlap = circle.r - abs(height) / length2.sqrt()
        raise SceneError(
            f"circle {circle.id!r}: lies across wall {wall.id!r}, by {shown_amount(overlap)} at time 0; "
            "move it, or reduce r"
        )
    if height.sign() == 0:
        raise SceneError(f"circle {circle.id!r}: its centre lies on wall {wall.id!r}; move it to one side")
    return sign == 0 and wall.side(circle.x, circle.y) == height.sign()


def shown_amount(amount: Quantity) -> str:
    """An exact amount as an error shows it: itself if short, else its first digits."""
    text = amount.text()
    if len(text) <= 24:
        return text
    try:
        return f"about {float(amount):.6g}"
    except OverflowError:
        return "more than 1e308"


def closing_of(circles: Sequence[Circle], walls: Sequence[Wall]) -> tuple[Squeeze, ...]:
    """The circles between two parallel walls that close, each with the two that first leave no room for it.

    Between walls that are not parallel nothing is crushed: their meeting point moves with one velocity, and in its
    frame both stand.

    >>> walls = [Wall(0, 0, 0, 1), Wall(9, 0, 9, 1, vx=-2)]
    >>> closing_of([Circle(3, 0)], walls)[0].time, closing_of([Circle(3, 0), Circle(12, 0)], walls)[-1].circle
    (Quantity('7/2'), 0)
    """
    found: dict[int, Squeeze] = {}
    for k, wall in enumerate(walls):
        for j in range(k):
            other = walls[j]
            if not (wall.moves or other.moves):
                continue
            (nx, ny), (mx, my) = wall.normal, other.normal
            if (nx * my - ny * mx).sign() != 0:
                continue
            length = (nx * nx + ny * ny).sqrt()
            rate = (nx * (wall.vx - other.vx) + ny * (wall.vy - other.vy)) / length
            across = (nx * (wall.x0 - other.x0) + ny * (wall.y0 - other.y0)) / length
            side = across.sign()
            if side == 0 or rate.sign() != -side:
                continue
            for i, circle in enumerate(circles):
                above = wall.height(circle.x, circle.y).sign()
                below = (nx * (circle.x - other.x0) + ny * (circle.y - other.y0)).sign()
                if circle.fixed or above != -side or below != side:
                    continue
                time = (across if side > 0 else -across) - circle.r - circle.r
                time = time / abs(rate)
                if i not in found or time < found[i].time:
                    found[i] = Squeeze(i, (j, k), time)
    return tuple(found[i] for i in sorted(found))
