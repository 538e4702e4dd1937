"""Two circles, or a circle and a wall, near an event of the true run: when they meet, and how errors move that."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from .errors_grown import GrownErrors


class Nearby:
    """Pairs, at the event at which the positions of `grown` are, and their displacements, to the first order.

    Everything is named by its place in `scene.ids`; of a pair with a wall, the wall is second.

    Attributes:
        scale: the scene's largest coordinate or radius.
        rounding: what one decision is off by itself.
    """

    def __init__(self, grown: GrownErrors) -> None:
        self.grown = grown
        self.scale = max(float(np.abs(grown.position).max()), float(grown.radii.max()))
        self.rounding = grown.local.unit * self.scale

    def gap(self, i: int, j: int) -> float:
        """The distance of the two surfaces."""
        if j >= self.grown.count:
            return self.wall(i, j)[0]
        d, _ = self.relative(i, j)
        return float(np.hypot(*d)) - float(self.grown.radii[i] + self.grown.radii[j])

    def speed(self, i: int, j: int) -> float:
        """How fast the two move against each other."""
        v = self.grown.velocity[i] if j >= self.grown.count else self.relative(i, j)[1]
        return float(np.hypot(*v))

    def apart(self, columns: NDArray[np.float64], i: int, j: int) -> float:
        """By how much all errors can move the one against the other at the event."""
        return float(np.hypot(*self.between(columns, i, j, 0.0)).sum()) + self.rounding

    def relative(self, i: int, j: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """d and v of two circles, at the time of the event that positions are at."""
        grown = self.grown
        return grown.position[j] - grown.position[i], grown.velocity[j] - grown.velocity[i]

    def between(self, columns: NDArray[np.float64], i: int, j: int, lag: float) -> NDArray[np.float64]:
        """Shape (2, errors): the displacement of j against i, so much later than the columns."""
        other = columns[j] if j < self.grown.count else np.zeros_like(columns[i])
        between = other - columns[i]
        return between[:2] + lag * between[2:]

    def across(self, columns: NDArray[np.float64], i: int, j: int, near: float, time: float) -> float:
        """By how much all errors can move the least distance of two circles."""
        _, v = self.relative(i, j)
        across = np.array([-v[1], v[0]]) / math.sqrt(float(v @ v))
        return float(np.abs(across @ self.between(columns, i, j, near - time)).sum()) + self.rounding

    def wait(self, i: int, j: int) -> float | None:
        """How long after an event two would meet in free flight; None if they do not."""
        grown = self.grown
        if j >= grown.count:
            gap, closing = self.wall(i, j)
            return max(gap, 0.0) / closing if closing > 0 else None
        d, v = self.relative(i, j)
        reach = float(grown.radii[i] + grown.radii[j])
        b, square = float(d @ v), float(v @ v)
        root = square * reach * reach - float(d[0] * v[1] - d[1] * v[0]) ** 2
        if b >= 0 or root < 0:
            return None
        return max(float(d @ d) - reach * reach, 0.0) / (-b + math.sqrt(root))

    def wall(self, i: int, j: int) -> tuple[float, float]:
        """The gap between a circle and a wall, and the speed at which it closes."""
        nx, ny, side, height = self.side(i, j)
        vx, vy = self.grown.velocity[i]
        return side * height - float(self.grown.radii[i]), -side * float(nx * vx + ny * vy)

    def side(self, i: int, j: int) -> tuple[float, float, float, float]:
        """The unit normal of a wall, the side on which a circle is, and its height above it."""
        x0, y0, x1, y1 = self.grown.walls[j - self.grown.count]
        nx, ny = y0 - y1, x1 - x0
        length = math.hypot(nx, ny)
        x, y = self.grown.position[i]
        height = float(nx * (x - x0) + ny * (y - y0)) / length
        return nx / length, ny / length, (1.0 if height >= 0 else -1.0), height

    def shift(self, columns: NDArray[np.float64], i: int, j: int, meeting: float, time: float) -> NDArray[np.float64]:
        """By how much each error delays the meeting of two, at a time of the flights under way; a graze by any time."""
        grown = self.grown
        if j >= grown.count:
            nx, ny, side, _ = self.side(i, j)
            closing = self.wall(i, j)[1]
            normal = np.array([side * nx, side * ny])
            return -(normal @ self.between(columns, i, j, meeting - time)) / closing
        d, v = self.relative(i, j)
        there = d + (meeting - time) * v
        if not float(there @ v):
            return np.full(columns.shape[2], math.inf)
        return -(there @ self.between(columns, i, j, meeting - time)) / float(there @ v)

    def bent(self, columns: NDArray[np.float64], i: int, j: int) -> float:
        """What the curvature of two circles adds to the delay of their meeting: all errors across it, to second order.

        Where the two fly head on, errors across their way delay it by nothing to the first order.
        """
        if j >= self.grown.count:
            return 0.0
        d, v = self.relative(i, j)
        reach = float(self.grown.radii[i] + self.grown.radii[j])
        closing = abs(float(d @ v)) / math.sqrt(float(d @ d))
        return self.apart(columns, i, j) ** 2 / (reach * closing) if reach and closing else 0.0
