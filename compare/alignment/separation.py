"""How far apart two runs of one scene are, over time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...scenarios.trajectory import Trajectory

SAMPLES = 200
"""Sample times of a separation: as many as a plot of ordinary width can show apart."""

WITHIN = 1 - 2.0**-50
"""The last sample lies this share of the span inside of both runs, whatever the rounding of their end."""


@dataclass(frozen=True)
class Separation:
    """The largest distance between where two runs have a circle, at sample times.

    Attributes:
        times: ascending, from 0 to the end of the shorter run.
        largest: at each time, the largest distance over all circles, in units of the scene.
        circle: id of the circle that is farthest off at the end.
        scale: the largest coordinate of the reference: what a distance is to be compared with.

    A distance of nan was not measured, an infinite one is beyond the doubles.
    """

    times: tuple[float, ...]
    largest: tuple[float, ...]
    circle: str
    scale: float

    @property
    def final(self) -> float:
        """The largest distance at the end."""
        return self.largest[-1]

    @property
    def maximum(self) -> float:
        """The largest distance at any sample time."""
        return max(self.largest)

    def thinned(self, count: int) -> Separation:
        """The same at `count` of the times, first and last included."""
        if len(self.times) <= count:
            return self
        keep = [round(k * (len(self.times) - 1) / (count - 1)) for k in range(count)]
        return Separation(
            tuple(self.times[k] for k in keep), tuple(self.largest[k] for k in keep), self.circle, self.scale
        )


def not_measured(reference: Trajectory) -> Separation:
    """What stands for a separation that there was no time for: nan at time 0, of no circle in particular."""
    return Separation((0.0,), (math.nan,), str(reference.scene.circles[0].id), 0.0)


def separation(
    reference: Trajectory, candidate: Trajectory, end: float, samples: int = SAMPLES, at: Sequence[float] = ()
) -> Separation:
    """The distance between two runs at evenly spaced times, up to `end` or the end of the shorter.

    Args:
        at: other times at which it is measured too, such as a divergence, as far as they lie in between.
    """
    last = WITHIN * min(end, float(reference.final_time), float(candidate.final_time))
    times = [last * k / (samples - 1) for k in range(samples)] if last > 0 else [0.0]
    if at:
        times = sorted({*times, *(time for time in at if 0.0 <= time <= last)})
    mine, theirs = reference.sample(times)[:, :, :2], candidate.sample(times)[:, :, :2]
    apart = np.hypot(mine[:, :, 0] - theirs[:, :, 0], mine[:, :, 1] - theirs[:, :, 1])
    farthest = int(np.argmax(apart[-1]))
    scale = float(np.max(np.abs(mine))) if mine.size else 0.0
    return Separation(
        tuple(times),
        tuple(float(value) for value in np.nan_to_num(apart.max(axis=1), nan=math.inf)),
        str(reference.scene.circles[farthest].id),
        scale,
    )


RETURNED = 2.0**-40
"""A run that ends within this share of its length of twice the time of reversal ends at the return."""


def return_miss(trajectory: Trajectory, reference: Trajectory) -> float | None:
    """After a reversal, the largest distance from the start when the reference is back at its start.

    That is at twice the time of the reversal. None without a reversal, or if a run does not last that long.
    """
    if reference.reversal is None or trajectory.reversal is None:
        return None
    back, end = 2 * float(reference.reversal.time), float(reference.final_time)
    at_end = abs(end - back) <= RETURNED * back
    if float(trajectory.final_time) < back and not (at_end and trajectory is reference):
        return None
    if end < back and not at_end:
        return None
    state = trajectory.at(reference.final_time if at_end else back)
    return max(
        math.hypot(float(now.x) - float(start.x), float(now.y) - float(start.y))
        for now, start in zip(state.circles, trajectory.scene.circles, strict=True)
    )
