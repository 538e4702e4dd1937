"""How small displacements grow along a run: its tangent map, impact by impact, in doubles or in balls."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import log2, nextafter
from typing import TYPE_CHECKING, Any

import numpy as np
from flint import arb, arb_mat

from ...exact.laws.formulas import wall_bounce
from ...exact.laws.tangent_formulas import pair_tangent
from ...exact.numbers import ball
from ...exact.results.motion import motion_of
from .impacts import LEAST_BITS, Impact, NoTangentMap, Real, impacts, moving

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory

RESCALED = 2.0**256
"""Displacements in doubles that are larger than this are scaled down, and the scale is noted: a double ends at
2**1024."""


class Displacements:
    """Displacements of the circles that can move, carried along a run; all stand at one time.

    Args:
        scene: what ran.
        columns: shape (moving circles, 4, k): k displacements of x, y, vx, vy at time 0. Doubles, or balls as objects.

    Attributes:
        columns: the same at `time`, divided by 2**scale.
        scale: log2 of what they have been divided by; in balls always 0.
        time: where they stand, in their own kind of number.
    """

    def __init__(self, scene: Scene, columns: NDArray[Any]) -> None:
        self.columns = columns.copy()
        self.scale = 0.0
        self.in_balls = columns.dtype == object
        self.time: Real = arb(0) if self.in_balls else 0.0
        self._row: dict[int | None, int] = {i: row for row, i in enumerate(moving(scene))}

    def fly(self, time: Real) -> None:
        """Carries them to a time, in straight flight."""
        self.columns[:, :2] += (time - self.time) * self.columns[:, 2:]
        self.time = time

    def through(self, struck: Sequence[Impact]) -> None:
        """Carries them through the impacts of one event, which must be the next."""
        for impact in struck:
            hit = impact if self.in_balls else _doubles(impact)
            self.fly(hit.time)
            if hit.b is None:
                self._bounce(self.columns[self._row[hit.a]], hit)
            else:
                self._collide(hit)
        if not self.in_balls:
            self._rescale()

    def _bounce(self, own: NDArray[Any], hit: Impact) -> None:
        square = hit.reach * hit.reach
        own[0], own[1] = wall_bounce(own[0], own[1], hit.dx, hit.dy, square)
        own[2], own[3] = wall_bounce(own[2], own[3], hit.dx, hit.dy, square)

    def _collide(self, hit: Impact) -> None:
        a, b = self._row.get(hit.a), self._row.get(hit.b)
        between = self._of(b) - self._of(a)
        gain = np.array(pair_tangent(hit.dx, hit.dy, hit.vx, hit.vy, hit.reach, hit.wa, hit.wb, *between))
        if b is not None:
            self.columns[b] += hit.wb * gain
        if a is not None:
            self.columns[a] -= hit.wa * gain

    def _of(self, row: int | None) -> Any:
        """The displacements of a circle; a fixed one has none."""
        return self.columns[0] * 0 if row is None else self.columns[row]

    def _rescale(self) -> None:
        largest = float(np.abs(self.columns).max(initial=0.0))
        if largest > RESCALED:
            self.columns /= largest
            self.scale += log2(largest)

    @property
    def matrix(self) -> NDArray[Any]:
        """Shape (4 * moving circles, k)."""
        return self.columns.reshape(-1, self.columns.shape[-1])


def _doubles(impact: Impact) -> Impact:
    time, a, b, *numbers = impact
    dx, dy, vx, vy, reach, wa, wb = (float(number) for number in numbers)
    return Impact(float(time), a, b, dx, dy, vx, vy, reach, wa, wb)


def unit_displacements(scene: Scene) -> NDArray[np.float64]:
    """Shape (moving circles, 4, 4 * moving circles): one for each coordinate that can be displaced."""
    count = len(moving(scene))
    return np.eye(4 * count).reshape(count, 4, 4 * count)


def error_growth(trajectory: Trajectory, events: int) -> float | None:
    """Bits an event by which the largest displacement grows over the first `events` of a run.

    The norm of the tangent map; its logarithm over the number of events tends to the largest Lyapunov exponent.
    None where there is no tangent map (see `impacts`), or no event.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import Circle, Scene
    >>> scene = Scene([Circle(0, 0, vx=1), Circle(4, "1/2")])
    >>> round(error_growth(ExactEngine().run(scene), 1), 3)
    2.003
    """
    if not 0 < events <= len(trajectory.events):
        return None
    carried = Displacements(trajectory.scene, unit_displacements(trajectory.scene))
    try:
        for struck in impacts(trajectory, events):
            carried.through(struck)
    except NoTangentMap:
        return None
    return (carried.scale + log2(float(np.linalg.norm(carried.matrix, 2)))) / events


@dataclass(frozen=True)
class CertifiedGrowth:
    """The norm of a run's tangent map from time 0 to one of its events, enclosed.

    Attributes:
        events: how many events it leads through.
        low, high: log2 of the norm lies between them: bits by which the displacement that grows most has grown.
        bits: the precision of the balls that told.
    """

    events: int
    low: float
    high: float
    bits: int


TOLD_BITS = 40
"""Accuracy of the norm's square at which an enclosure is told: beyond what its doubles show."""

POWER = 5
"""Squarings of the Gram matrix: the trace of its power 2**POWER exceeds the largest entry of its spectrum by a factor
of its size at most, and so the norm by the size to the power of 2**-(POWER + 1)."""


def certified_growth(trajectory: Trajectory, events: int) -> CertifiedGrowth:
    """Encloses the norm of the tangent map from time 0 to just after an event, along a certified run.

    The product of the maps of all flights and impacts is taken in balls along the run's log, with as many bits as it
    takes; what comes out is proved. Norms are Euclidean, over positions and velocities in the scene's own units.

    With G the product's Gram matrix and s its norm, trace(G**k) lies between s**(2 k) and size * s**(2 k); and no
    direction grows by more than s.

    Raises:
        NoTangentMap: where there is none (see `impacts`), for a run of floats, and for one with no such event.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import Circle, Scene
    >>> told = certified_growth(ExactEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, "1/2")])), 1)
    >>> round(told.low, 3), round(told.high, 3)
    (2.003, 2.003)
    """
    if not 0 < events <= len(trajectory.events):
        raise NoTangentMap(f"events = {events}: the run has {len(trajectory.events)}")
    motion = motion_of(trajectory)
    if motion is None or not trajectory.certified:
        raise NoTangentMap("growth is certified along a certified run only; run the exact engine")
    start = unit_displacements(trajectory.scene)
    direction = _most_grown(trajectory, events)
    bits = motion.log.lost + LEAST_BITS
    while True:
        with ball.precision(bits):
            carried = Displacements(trajectory.scene, np.vectorize(arb, otypes=[object])(start))
            for struck in impacts(trajectory, events, bits):
                carried.through(struck)
            low, high = _norm_squared(carried.matrix, direction)
            if min(low.rel_accuracy_bits(), high.rel_accuracy_bits()) >= TOLD_BITS:
                two = arb(4).log()
                ends = float((low.log() / two).lower()), float((high.log() / two).upper())
                return CertifiedGrowth(events, nextafter(ends[0], -1e9), nextafter(ends[1], 1e9), bits)
        bits *= 2


def _most_grown(trajectory: Trajectory, events: int) -> NDArray[np.float64]:
    """The displacement at time 0 that grows most, as doubles tell it."""
    carried = Displacements(trajectory.scene, unit_displacements(trajectory.scene))
    for struck in impacts(trajectory, events):
        carried.through(struck)
    return np.linalg.svd(carried.matrix)[2][0]


def _norm_squared(matrix: NDArray[Any], direction: NDArray[np.float64]) -> tuple[arb, arb]:
    """Bounds of the largest singular value's square: below by the growth of a direction, above by a trace."""
    product = arb_mat([list(row) for row in matrix])
    vector = arb_mat([[arb(float(value))] for value in direction])
    grown = product * vector
    low = (grown.transpose() * grown)[0, 0] / (vector.transpose() * vector)[0, 0]
    power = product.transpose() * product
    for _ in range(POWER):
        power = power * power
    trace = arb(0)
    for k in range(power.nrows()):
        trace += power[k, k]
    return low, trace.root(2**POWER)
