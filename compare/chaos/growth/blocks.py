"""An interval for a rate from the blocks of one series: how far it would scatter if it were measured again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

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
