"""On which side of a wall a circle lies."""

from __future__ import annotations

from ...scenarios.scene import Scene


class Sides:
    """On which side of each wall each circle starts, and so stays: decided exactly, once, when asked."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._known: dict[tuple[int, int], bool] = {}

    def negative(self, circle: int, wall: int) -> bool:
        """Whether the circle lies where the wall's own normal does not point."""
        key = (circle, wall)
        if key not in self._known:
            where = self.scene.circles[circle]
            self._known[key] = self.scene.walls[wall].height(where.x, where.y).sign() < 0
        return self._known[key]
