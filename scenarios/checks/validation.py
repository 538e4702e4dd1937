"""Checks, exactly, that no circle of a scene overlaps another or crosses a wall, and finds what touches."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..errors import SceneError
from ..numbers.quantity import Quantity
from ..things import Circle, Wall
from .neighbours import Box, NearWalls, Neighbourhood, box


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
    return sign == 0


def shown_amount(amount: Quantity) -> str:
    """An exact amount as an error shows it: itself if short, else its first digits."""
    text = amount.text()
    if len(text) <= 24:
        return text
    try:
        return f"about {float(amount):.6g}"
    except OverflowError:
        return "more than 1e308"
