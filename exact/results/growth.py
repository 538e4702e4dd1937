"""How small displacements grow along a run: its tangent map, collision by collision."""

from __future__ import annotations

from math import log2
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..laws.formulas import wall_bounce
from ..laws.tangent_formulas import pair_tangent

if TYPE_CHECKING:
    from ...scenarios.trajectory import CircleState, Trajectory

RESCALED = 2.0**256
"""Displacements larger than this are scaled down, and the scale is noted: a double ends at 2**1024."""


class Displacements:
    """Displacements of a whole state, carried along a run in doubles.

    Attributes:
        columns: shape (circles, 4, k): k displacements of x, y, vx, vy, at each circle's last event.
        scale: log2 of what they have been divided by.
    """

    def __init__(self, trajectory: Trajectory, columns: NDArray[np.float64]) -> None:
        scene = trajectory.scene
        self.trajectory = trajectory
        self.columns = columns.copy()
        self.scale = 0.0
        self._place = {str(c.id): k for k, c in enumerate(scene.circles)}
        self._walls = {str(w.id): [float(n) for n in w.normal] for w in scene.walls}
        self._radii = [float(c.r) for c in scene.circles]
        self._weights = [float(c.inverse_mass) for c in scene.circles]
        self._times = [0.0] * len(scene.circles)
        self._velocities = [(float(c.vx), float(c.vy)) for c in scene.circles]

    def through(self, index: int) -> None:
        """Carries them through an event, which must be the next.

        Raises:
            ValueError: if a circle has several contacts at it: nearby runs then take them in different orders, and
                no linear map says what becomes of a displacement.
        """
        event = self.trajectory.events[index]
        names = [name for pair in event.contacts for name in pair if name in self._place]
        movers = [name for name in names if self._weights[self._place[name]]]
        if len(movers) != len(set(movers)):
            raise ValueError(f"event {index}: a circle has several contacts at one instant, where no tangent map is")
        state, time = self.trajectory.at(event.time), float(event.time)
        for first, second in event.contacts:
            if second in self._walls:
                self._bounce(self._place[first], self._walls[second], time, state[first])
            else:
                self._collide(self._place[first], self._place[second], time, state[first], state[second])
        largest = float(np.abs(self.columns).max(initial=0.0))
        if largest > RESCALED:
            self.columns /= largest
            self.scale += log2(largest)

    def at(self, time: float) -> NDArray[np.float64]:
        """Shape (circles, 4, k): the displacements at one time, divided by 2**scale."""
        found = self.columns.copy()
        for k, since in enumerate(self._times):
            found[k, :2] += (time - since) * found[k, 2:]
        return found

    def _fly(self, k: int, time: float) -> None:
        self.columns[k, :2] += (time - self._times[k]) * self.columns[k, 2:]
        self._times[k] = time

    def _bounce(self, k: int, normal: list[float], time: float, after: CircleState) -> None:
        self._fly(k, time)
        p, (nx, ny) = self.columns[k], normal
        square = nx * nx + ny * ny
        p[0], p[1] = wall_bounce(p[0], p[1], nx, ny, square)
        p[2], p[3] = wall_bounce(p[2], p[3], nx, ny, square)
        self._velocities[k] = (float(after.vx), float(after.vy))

    def _collide(self, a: int, b: int, time: float, one: CircleState, other: CircleState) -> None:
        self._fly(a, time)
        self._fly(b, time)
        (ax, ay), (bx, by) = self._velocities[a], self._velocities[b]
        between = self.columns[b] - self.columns[a]
        gain = np.array(
            pair_tangent(
                float(other.x) - float(one.x),
                float(other.y) - float(one.y),
                bx - ax,
                by - ay,
                self._radii[a] + self._radii[b],
                self._weights[a],
                self._weights[b],
                *between,
            )
        )
        self.columns[b] += self._weights[b] * gain
        self.columns[a] -= self._weights[a] * gain
        for k, after in ((a, one), (b, other)):
            self._velocities[k] = (float(after.vx), float(after.vy))


def unit_displacements(circles: int) -> NDArray[np.float64]:
    """Shape (circles, 4, 4 * circles): one for each coordinate."""
    return np.eye(4 * circles).reshape(circles, 4, 4 * circles)


def error_growth(trajectory: Trajectory, events: int) -> float | None:
    """Bits an event by which the largest displacement grows over the first `events` of a run.

    The norm of the tangent map; its logarithm over the number of events tends to the largest Lyapunov exponent.
    None where there is no tangent map (several contacts of one circle at one instant, a reversal, or circles taken out
    of play), or no event.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import Circle, Scene
    >>> scene = Scene([Circle(0, 0, vx=1), Circle(4, "1/2")])
    >>> round(error_growth(ExactEngine().run(scene), 1), 3)
    2.003
    """
    turned = trajectory.reversal is not None and trajectory.reversal.after <= events
    if turned or trajectory.scene.capture or not 0 < events <= len(trajectory.events):
        return None
    carried = Displacements(trajectory, unit_displacements(len(trajectory.scene.circles)))
    try:
        for index in range(events):
            carried.through(index)
    except ValueError:
        return None
    last = carried.at(float(trajectory.events[events - 1].time))
    matrix = last.reshape(-1, last.shape[-1])
    return (carried.scale + log2(float(np.linalg.norm(matrix, 2)))) / events
