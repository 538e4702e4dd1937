"""Boltzmann's H of the speeds of a gas, and how it goes when every velocity is turned back."""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...scenarios.trajectory import Trajectory

CELLS = 8
"""Cells of speed, each of which holds the same share of discs in equilibrium."""


def h_value(speeds: Sequence[tuple[float, float]]) -> float:
    """The sum of f ln(f) over the cells, f the share of discs in a cell by that of equilibrium: 0 there, else above.

    In equilibrium v**2 is distributed exponentially about its mean (Maxwell, in the plane), so that
    exp(-v**2 / mean) is uniform.

    Args:
        speeds: (vx, vy) of discs of equal mass.

    >>> round(h_value([(1.0, 0.0)] * 100), 4) == round(math.log(CELLS), 4)
    True
    """
    squares = [vx * vx + vy * vy for vx, vy in speeds]
    mean = sum(squares) / len(squares)
    cells = Counter(min(CELLS - 1, int(CELLS * math.exp(-square / mean))) for square in squares)
    shares = [count / len(squares) for count in cells.values()]
    return sum(share * math.log(share * CELLS) for share in shares)


def h_curve(run: Trajectory, points: int) -> list[tuple[float, float]]:
    """(time, H) at so many times of a run, from 0 to its end."""
    end = float(run.final_time)
    times = [min(end, end * k / (points - 1)) for k in range(points)]
    return [(time, h_value([(float(vx), float(vy)) for vx, vy in rows]))
            for time, rows in zip(times, run.sample(times)[:, :, 2:], strict=True)]  # fmt: skip


def h_returned(run: Trajectory) -> float:
    """By how much H at the end of a run is above or below what it was at the start.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import catalogue
    >>> h_returned(ExactEngine().run(catalogue.build("echo:rows=3,after=20")))
    0.0
    """
    states = [run.at(time).array()[:, 2:] for time in (0, run.final_time)]
    first, last = (h_value([(float(vx), float(vy)) for vx, vy in rows]) for rows in states)
    return last - first
