"""Checks, exactly, that no circle of a scene overlaps another or crosses a wall."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .errors import SceneError
from .numbers.quantity import Quantity

if TYPE_CHECKING:
    from .scene import Circle, Scene, Wall

SAFE = 1e-9
"""Share of the coordinates' size beyond which a gap computed in doubles is a gap for certain: their rounding,
a few units of 2**-53, is a millionth of it. Anything closer is decided exactly."""


def check_apart(scene: Scene) -> None:
    """Refuses overlapping circles and circles across walls; touching is fine.

    Raises:
        SceneError: naming the pair, the overlap and the remedy.
    """
    circles = scene.circles
    rough = [rough_circle(circle) for circle in circles]
    for j, (b, near_b) in enumerate(zip(circles, rough, strict=True)):
        for a, near_a in zip(circles[:j], rough[:j], strict=True):
            if not surely_apart(near_a, near_b):
                _check_pair(a, b)
    for circle in circles:
        for wall in scene.walls:
            _check_wall(circle, wall)


def rough_circle(circle: Circle) -> tuple[float, float, float] | None:
    """x, y, r as nearest doubles; None where one is beyond them."""
    try:
        return float(circle.x), float(circle.y), float(circle.r)
    except OverflowError:
        return None


def surely_apart(a: tuple[float, float, float] | None, b: tuple[float, float, float] | None) -> bool:
    """Whether two circles are apart beyond any doubt that rounding could leave."""
    if a is None or b is None:
        return False
    size = abs(a[0]) + abs(a[1]) + abs(b[0]) + abs(b[1]) + a[2] + b[2]
    if not 1e-100 < size < 1e100:
        return False
    reach = a[2] + b[2] + SAFE * size
    return abs(a[0] - b[0]) > reach or abs(a[1] - b[1]) > reach


def _check_pair(a: Circle, b: Circle) -> None:
    dx, dy, reach = b.x - a.x, b.y - a.y, a.r + b.r
    gap = dx * dx + dy * dy - reach * reach
    if gap.sign() < 0:
        overlap = reach - (dx * dx + dy * dy).sqrt()
        raise SceneError(
            f"circle {b.id!r}: overlaps {a.id!r} by {shown_amount(overlap)} at time 0; move it, or reduce r"
        )
    if gap.sign() == 0 and reach.sign() == 0:
        raise SceneError(f"circle {b.id!r}: is the same point as {a.id!r}; move it")


def _check_wall(circle: Circle, wall: Wall) -> None:
    nx, ny = wall.normal
    height = wall.height(circle.x, circle.y)
    length2 = nx * nx + ny * ny
    if (height * height - circle.r * circle.r * length2).sign() < 0:
        overlap = circle.r - abs(height) / length2.sqrt()
        raise SceneError(
            f"circle {circle.id!r}: lies across wall {wall.id!r}, by {shown_amount(overlap)} at time 0; "
            "move it, or reduce r"
        )
    if height.sign() == 0:
        raise SceneError(f"circle {circle.id!r}: its centre lies on wall {wall.id!r}; move it to one side")


def shown_amount(amount: Quantity) -> str:
    """An exact amount as an error shows it: itself if short, else its first digits."""
    text = amount.text()
    if len(text) <= 24:
        return text
    try:
        return f"about {float(amount):.6g}"
    except OverflowError:
        return "more than 1e308"
