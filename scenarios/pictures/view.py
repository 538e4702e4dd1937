"""What a picture of a scene shows: discs and walls, and the part of the plane that holds them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from ..things import Circle, Pocket, Wall

WIDTH, HEIGHT = 720.0, 480.0
"""Largest size of a picture in pixels."""

MARGIN = 0.06
"""Room around what is shown, as a share of its size."""


class Pictured(Protocol):
    """What a picture takes of a scene."""

    @property
    def name(self) -> str: ...
    @property
    def circles(self) -> tuple[Circle, ...]: ...
    @property
    def walls(self) -> tuple[Wall, ...]: ...
    @property
    def pockets(self) -> tuple[Pocket, ...]: ...


@dataclass(frozen=True)
class DrawnDisc:
    """One circle to draw: where, how large, how fast, and with which classes."""

    id: str
    x: float
    y: float
    r: float
    vx: float
    vy: float
    classes: str
    label: bool = True


@dataclass(frozen=True)
class View:
    """The part of the plane that is shown; y goes up."""

    left: float
    bottom: float
    width: float
    height: float

    @property
    def scale(self) -> float:
        """Pixels to a unit."""
        return min(WIDTH / self.width, HEIGHT / self.height)

    def x(self, x: float) -> float:
        """Pixels from the left."""
        return (x - self.left) * self.scale

    def y(self, y: float) -> float:
        """Pixels from the top."""
        return (self.bottom + self.height - y) * self.scale


def view_of(discs: Sequence[DrawnDisc], scene: Pictured) -> View:
    """A view of the discs, and of the walls' own points where those lie near."""
    xs = [v for d in discs for v in (d.x - d.r, d.x + d.r)]
    ys = [v for d in discs for v in (d.y - d.r, d.y + d.r)]
    size = max(max(xs) - min(xs), max(ys) - min(ys), 1e-9)
    for wall in scene.walls:
        for x, y in _nearest(wall_line(wall), [(d.x, d.y) for d in discs]):
            if min(xs) - 3 * size <= x <= max(xs) + 3 * size and min(ys) - 3 * size <= y <= max(ys) + 3 * size:
                xs.append(x)
                ys.append(y)
    width, height = max(xs) - min(xs), max(ys) - min(ys)
    room = MARGIN * max(width, height, 1e-9)
    width, height = (
        max(width + 2 * room, (height + 2 * room) / 4),
        max(height + 2 * room, (width + 2 * room) / 4),
    )
    middle_x, middle_y = (max(xs) + min(xs)) / 2, (max(ys) + min(ys)) / 2
    return View(middle_x - width / 2, middle_y - height / 2, width, height)


def wall_line(wall: Wall) -> tuple[float, float, float, float]:
    """A wall's two points as doubles."""
    return float(wall.x0), float(wall.y0), float(wall.x1), float(wall.y1)


def _nearest(
    line: tuple[float, float, float, float], points: Iterable[tuple[float, float]]
) -> list[tuple[float, float]]:
    """The feet of perpendiculars from points to a line."""
    x0, y0, x1, y1 = line
    dx, dy = x1 - x0, y1 - y0
    length2 = dx * dx + dy * dy
    feet: list[tuple[float, float]] = []
    for x, y in points:
        share = ((x - x0) * dx + (y - y0) * dy) / length2
        feet.append((x0 + share * dx, y0 + share * dy))
    return feet
