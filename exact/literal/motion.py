"""Straight flights between instants, in SymPy numbers."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...scenarios.numbers.quantity import Quantity, Real
from .laws import Disc
from .sign import normal, quantity, sign


@dataclass(frozen=True)
class SymbolicMotion:
    """Positions and velocities of a run: legs, and when each starts.

    Attributes:
        starts: when each leg starts; of legs that start at one time the last holds.
        legs: all circles at that time, with the velocities that they leave it with.
        end: when the run ends.
    """

    starts: tuple[Any, ...]
    legs: tuple[tuple[Disc, ...], ...]
    end: Any

    def state(self, time: Any) -> list[tuple[Real, Real, Real, Real]]:
        """(x, y, vx, vy) of every circle at a time; at an event, as it leaves it.

        Raises:
            ValueError: for a time outside of the run.
        """
        at: Any = Quantity.of(time).sympy()
        if sign(at) < 0 or sign(at - self.end) > 0:
            raise ValueError(f"time {time} is not between 0 and the end of the run, {quantity(self.end)}")
        for begun, leg in zip(reversed(self.starts), reversed(self.legs), strict=True):
            since = at - begun
            if sign(since) >= 0:
                return [
                    (
                        quantity(normal(disc.x + disc.vx * since)),
                        quantity(normal(disc.y + disc.vy * since)),
                        quantity(disc.vx),
                        quantity(disc.vy),
                    )
                    for disc in leg
                ]
        raise AssertionError("the first leg starts at time 0")

    def sample(self, times: Sequence[float]) -> NDArray[np.float64]:
        """Shape (times, circles, 4): the same as doubles, flights computed in doubles."""
        starts = [float(quantity(begun)) for begun in self.starts]
        legs = np.array([[[float(quantity(n)) for n in (d.x, d.y, d.vx, d.vy)] for d in leg] for leg in self.legs])
        places = [max(bisect_right(starts, time) - 1, 0) for time in times]
        found = legs[places].copy()
        since = np.array(times, dtype=float) - np.array(starts)[places]
        found[:, :, :2] += found[:, :, 2:] * since[:, None, None]
        return found
