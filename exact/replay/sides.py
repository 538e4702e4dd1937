"""On which side of a wall a circle lies."""

from __future__ import annotations

from math import isfinite

from ...scenarios.scene import Scene

CLEAR = 2.0**-40
"""Share of its terms beyond which a height in doubles has the sign of the true one. Six roundings to doubles, of
2**-53 each, and the roundings of five operations come to less than 2**-49 of them."""


class Sides:
    """On which side of each wall each circle starts, and so stays: decided exactly, once, when asked."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._known: dict[tuple[int, int], bool] = {}
        self._walls: dict[int, tuple[float, float, float, float] | None] = {}

    def negative(self, circle: int, wall: int) -> bool:
        """Whether the circle lies where the wall's own normal does not point."""
        key = (circle, wall)
        if key not in self._known:
            where = self.scene.circles[circle]
            told = self._in_doubles(circle, wall)
            self._known[key] = self.scene.walls[wall].height(where.x, where.y).sign() < 0 if told is None else told
        return self._known[key]

    def _in_doubles(self, circle: int, wall: int) -> bool | None:
        """The same, where doubles tell it."""
        if wall not in self._walls:
            exact = self.scene.walls[wall]
            try:
                nx, ny = exact.normal
                self._walls[wall] = (float(nx), float(ny), float(exact.x0), float(exact.y0))
            except OverflowError:
                self._walls[wall] = None
        line, where = self._walls[wall], self.scene.circles[circle]
        if line is None:
            return None
        nx, ny, x0, y0 = line
        try:
            x, y = float(where.x), float(where.y)
        except OverflowError:
            return None
        height = nx * (x - x0) + ny * (y - y0)
        terms = abs(nx) * (abs(x) + abs(x0)) + abs(ny) * (abs(y) + abs(y0))
        lost = CLEAR * terms + TINIEST * (1.0 + abs(nx) + abs(ny) + abs(x) + abs(y) + abs(x0) + abs(y0))
        return height < 0.0 if isfinite(terms) and abs(height) > lost else None


TINIEST = 1e-280
"""More than what underflow may take from a factor, or from a product: half of 2**-1074 each."""
