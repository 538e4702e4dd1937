"""The Lyapunov spectrum along one run, with intervals from blocks of the series."""

from __future__ import annotations

from dataclasses import dataclass
from math import log
from typing import TYPE_CHECKING

import numpy as np

from ..tangent.growth import Displacements
from ..tangent.impacts import moving

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from ...scenarios.scene import Scene
    from ..tangent.impacts import Impact

BLOCKS = 20
"""Blocks of a long series to begin with: enough to tell their scatter to a sixth."""

FEWEST_BLOCKS = 5
"""With fewer an interval says nothing: Student's factor is above 3."""

SHORTEST = 4
"""Events of the shortest block."""

STUDENT_95 = (
    12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228,
    2.201, 2.179, 2.160, 2.145, 2.131, 2.120, 2.110, 2.101, 2.093,
)  # fmt: skip
"""Student's factor of a 95 % interval, for 1, 2, ... degrees of freedom."""


@dataclass(frozen=True)
class Rate:
    """A rate estimated from one run, with a 95 % interval from its blocks.

    Attributes:
        value: the growth of all of the series over its length.
        low, high: the interval; None where the series is too short for one.
        blocks: how many blocks it comes from; 0 where there is none.
    """

    value: float
    low: float | None = None
    high: float | None = None
    blocks: int = 0


def rate(gains: NDArray[np.float64], lengths: NDArray[np.float64]) -> Rate:
    """Sum of the gains over sum of the lengths; the interval by Student's factor from the scatter of block rates.

    Blocks of consecutive events are nearly independent where they are long against the series' memory. So the
    correlation of each block with the next is measured, and as long as it is above that of independent ones
    (-1/blocks), half as many blocks are taken, down to `FEWEST_BLOCKS`.

    Source: the blocks of Flyvbjerg and Petersen, J. Chem. Phys. 91 (1989), 461.

    >>> import numpy as np
    >>> told = rate(np.array([1.0, 3.0] * 40), np.ones(80))
    >>> told.value, told.low, told.high, told.blocks
    (2.0, 2.0, 2.0, 20)
    >>> rate(np.ones(3), np.ones(3)).low is None
    True
    """
    total = float(lengths.sum())
    value = float(gains.sum()) / total if total else 0.0
    count = min(BLOCKS, len(gains) // SHORTEST)
    if count < FEWEST_BLOCKS:
        return Rate(value)
    while count // 2 >= FEWEST_BLOCKS and _neighbours(gains - value * lengths, count) > -1 / count:
        count //= 2
    parts = [(float(g.sum()), float(t.sum())) for g, t in zip(
        np.array_split(gains, count), np.array_split(lengths, count), strict=True)]  # fmt: skip
    if any(length <= 0 for _, length in parts):
        return Rate(value)
    rates = np.array([gain / length for gain, length in parts])
    room = STUDENT_95[count - 2] * float(rates.std(ddof=1)) / count**0.5
    return Rate(value, value - room, value + room, count)


def _neighbours(rest: NDArray[np.float64], count: int) -> float:
    """The correlation of the means of a series' blocks with those of the next; -1 of a series that is constant."""
    means = np.array([float(block.mean()) for block in np.array_split(rest, count)])
    means -= means.mean()
    square = float((means * means).sum())
    return float((means[:-1] * means[1:]).sum()) / square if square else -1.0


# ----------------------------------------
# The Lyapunov spectrum along one run, by orthonormalised displacements.

SEED = 1
"""Of the displacements that are carried at first: any will do but a set of measure zero."""

WHOLE = 80
"""Coordinates up to which the whole spectrum is taken unless told otherwise: twenty discs."""

FEW = 8
"""Exponents taken of a larger scene."""

TURNING = 0.1
"""Share of the events in which the displacements turn into the directions of growth; left out of the estimates."""


ABOVE_LINEAR = 2.0
"""An exponent is told from zero if its lower bound is so many times what growth in proportion to time would give."""


@dataclass(frozen=True)
class Spectrum:
    """What each orthonormalised displacement gained at each event.

    Attributes:
        dimension: of the phase space: four for each circle that can move.
        times: of the events, shape (events,).
        gains: shape (events, exponents): the logarithm of what each gained since the event before.
        skipped: events at the start that the estimates leave out.
        shrunk: the logarithm of what restitution makes of the volume that all displacements span: 2 ln e an impulse.
    """

    dimension: int
    times: NDArray[np.float64]
    gains: NDArray[np.float64]
    skipped: int
    shrunk: float = 0.0

    @property
    def lengths(self) -> NDArray[np.float64]:
        """The times between the events."""
        return np.diff(self.times, prepend=0.0)

    def per_time(self, k: int = 0) -> Rate:
        """Exponent number k per unit time."""
        return rate(self.gains[self.skipped :, k], self.lengths[self.skipped :])

    def per_event(self, k: int = 0) -> Rate:
        """Exponent number k per event."""
        gains = self.gains[self.skipped :, k]
        return rate(gains, np.ones(len(gains)))

    @property
    def linear(self) -> float:
        """What the estimate of the largest exponent is for displacements that grow in proportion to time: no chaos.

        It falls to 0 as the run gets longer; an estimate that is not well above it is not told from zero.
        """
        begin = float(self.times[self.skipped - 1]) if self.skipped else float(self.times[0])
        end = float(self.times[-1])
        return float(np.log(end / begin)) / (end - begin) if 0 < begin < end else float("inf")

    @property
    def chaotic(self) -> bool:
        """Whether the largest exponent is told from zero."""
        told = self.per_time()
        return (told.value if told.low is None else told.low) > ABOVE_LINEAR * self.linear

    @property
    def whole(self) -> bool:
        """Whether it has every exponent."""
        return self.gains.shape[1] == self.dimension

    def entropy(self) -> Rate | None:
        """The sum of the larger half of the exponents per unit time; None unless all are there, or if energy is lost.

        They come in pairs of opposite sign, so these are those that are not negative. In a closed ergodic scene that
        is the Kolmogorov-Sinai entropy (Pesin), elsewhere a bound on it (Ruelle).
        """
        if not self.whole or self.shrunk:
            return None
        half = self.gains[self.skipped :, : self.dimension // 2].sum(axis=1)
        return rate(half, self.lengths[self.skipped :])

    def pairing(self) -> float | None:
        """The largest |sum| of two exponents that should be opposite, per unit time; None as `entropy`."""
        if not self.whole or self.shrunk:
            return None
        values = np.array([self.per_time(k).value for k in range(self.dimension)])
        return float(np.abs(values + values[::-1]).max())

    def volume(self) -> float | None:
        """The logarithm of the volume that all displacements span at the end: 0, but for rounding (Liouville).

        With a restitution it is that beside `shrunk`.
        """
        return float(self.gains.sum()) - self.shrunk if self.whole else None

    def running(self, points: int) -> list[tuple[int, float, float]]:
        """The largest exponent as it converges: after so many events, at that time, the estimate from there back."""
        events = len(self.times)
        told: list[tuple[int, float, float]] = []
        for end in sorted({round(self.skipped + (events - self.skipped) * k / points) for k in range(1, points + 1)}):
            length = float(self.lengths[self.skipped : end].sum())
            if length > 0:
                told.append((end, float(self.times[end - 1]), float(self.gains[self.skipped : end, 0].sum()) / length))
        return told


def spectrum(scene: Scene, struck: Sequence[Sequence[Impact]], exponents: int | None = None) -> Spectrum:
    """Carries displacements along the impacts of a run, and makes them orthonormal after every event.

    Benettin, Galgani, Giorgilli and Strelcyn, Meccanica 15 (1980), 9; for hard discs Dellago, Posch and Hoover,
    Phys. Rev. E 53 (1996), 1485.

    Args:
        struck: the run's impacts, event by event (`compare.tangent.impacts`).
        exponents: how many, the largest first; by default all, or `FEW` of a large scene.
    """
    count = len(moving(scene))
    dimension = 4 * count
    wanted = (dimension if dimension <= WHOLE else FEW) if exponents is None else min(exponents, dimension)
    start = np.linalg.qr(np.random.default_rng(SEED).standard_normal((dimension, wanted)))[0]
    carried = Displacements(scene, start.reshape(count, 4, wanted))
    times, gains = np.zeros(len(struck)), np.zeros((len(struck), wanted))
    for index, impacts in enumerate(struck):
        carried.through(impacts)
        frame, triangle = np.linalg.qr(carried.matrix)
        with np.errstate(divide="ignore"):
            gains[index] = np.log(np.abs(np.diag(triangle))) + carried.scale * np.log(2.0)
        times[index] = float(carried.time)
        carried.columns, carried.scale = frame.reshape(count, 4, wanted), 0.0
    shrunk = 0.0 if scene.elastic else 2 * log(float(scene.restitution)) * sum(map(len, struck))
    return Spectrum(dimension, times, gains, int(TURNING * len(struck)), shrunk)
