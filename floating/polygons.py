"""Convex polygons, cut by lines: where walls leave room."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

Point: TypeAlias = tuple[float, float]


def clipped(region: Sequence[Point], nx: float, ny: float, height: float) -> list[Point]:
    """The part of a convex polygon where nx * x + ny * y >= height (Sutherland and Hodgman, 1974).

    >>> clipped([(0.0, 0.0), (2.0, 0.0), (0.0, 2.0)], -1.0, 0.0, -1.0)
    [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 2.0)]
    """
    kept: list[Point] = []
    for (x0, y0), (x1, y1) in zip(region, [*region[1:], region[0]], strict=True):
        h0, h1 = nx * x0 + ny * y0 - height, nx * x1 + ny * y1 - height
        if h0 >= 0:
            kept.append((x0, y0))
        if (h0 < 0) != (h1 < 0):
            share = h0 / (h0 - h1)
            kept.append((x0 + share * (x1 - x0), y0 + share * (y1 - y0)))
    return kept
