"""The uncertainty exponent: how the share of scenes whose outcome a displacement changes falls with its size."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ...scenarios.numbers.quantity import Quantity
from .rows.row import PERTURBED
from .survival import Z_95, proportion

if TYPE_CHECKING:
    from .rows.row import SweepRow

FEWEST = 3
"""Sizes for a line and the scatter about it."""


SMALL = 0.5
"""The largest share that the line is drawn through: the law is one of small displacements, and where most scenes change
already, the share has no room to grow."""


@dataclass(frozen=True)
class ChangedShare:
    """Of `total` scenes, `count` have another outcome when displaced by up to `size`; the exact 95 % interval."""

    size: float
    count: int
    total: int
    low: float
    high: float


@dataclass(frozen=True)
class Uncertainty:
    """The exponent a of a share that goes as size**a.

    Near 1, an outcome is twice as safe for half the error; near 0, no accuracy helps: the boundary between outcomes
    fills nearly all of the space (of dimension D, it has D - a).

    Attributes:
        shares: for each size.
        exponent, low, high: of the line of ln(share) over ln(size), weighted by how well each share is known, with a
            95 % interval; None for fewer than three sizes with a share above none and up to `SMALL`.
    """

    shares: tuple[ChangedShare, ...]
    exponent: float | None
    low: float | None
    high: float | None


def uncertainty(rows: Iterable[SweepRow], outcome: str) -> Uncertainty:
    """The shares and the exponent of one outcome, from a sweep with `perturb` and `outcomes`.

    Source: C. Grebogi, S. W. McDonald, E. Ott, J. A. Yorke, Final state sensitivity, Physics Letters A 99 (1983), 415.
    """
    counts: dict[str, list[int]] = {}
    for row in rows:
        if row["engine"].startswith(PERTURBED) and row["changed"] is not None:
            mine = counts.setdefault(row["engine"].removeprefix(PERTURBED), [0, 0])
            mine[0] += outcome in row["changed"]
            mine[1] += 1
    shares = tuple(ChangedShare(float(Quantity.of(size)), count, total, *proportion(count, total))
                   for size, (count, total) in counts.items())  # fmt: skip
    return Uncertainty(tuple(sorted(shares, key=lambda share: share.size)), *slope(shares))


def slope(shares: Sequence[ChangedShare]) -> tuple[float | None, float | None, float | None]:
    """The slope of ln(share) over ln(size), and its 95 % interval.

    The variance of ln(count/total) is 1/count - 1/total, to first order.

    >>> told = slope([ChangedShare(10.0**-k, round(10**6 * 10 ** (-k / 2)), 10**6, 0, 1) for k in (1, 2, 3, 4)])
    >>> round(told[0], 3), told[1] < 0.5 < told[2]
    (0.5, True)
    """
    points = [(math.log(s.size), math.log(s.count / s.total), 1 / (1 / s.count - 1 / s.total))
              for s in shares if 0 < s.count <= SMALL * s.total]  # fmt: skip
    if len(points) < FEWEST:
        return None, None, None
    weight = sum(w for *_, w in points)
    mx, my = sum(w * x for x, _, w in points) / weight, sum(w * y for _, y, w in points) / weight
    xx = sum(w * (x - mx) ** 2 for x, _, w in points)
    value = sum(w * (x - mx) * (y - my) for x, y, w in points) / xx
    room = Z_95 / math.sqrt(xx)
    return value, value - room, value + room
