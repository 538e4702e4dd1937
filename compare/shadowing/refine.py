"""Multiple shooting: the true orbit of a fixed order of contacts that is nearest to given nodes, to any accuracy.

Newton's method on the misfits between the image of each node and the next. Of the many corrections that close them to
first order the shortest is taken, over all nodes together: so the orbit found stays by the nodes, forwards and
backwards alike. Misfits are computed in balls, tangent maps in doubles: each round gains about as many digits as these
are good for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, log2
from typing import TYPE_CHECKING, Any

import numpy as np
from flint import arb

from ...exact.numbers import ball
from .order import FixedOrder, Missed, Node

if TYPE_CHECKING:
    from numpy.typing import NDArray

MOST_ROUNDS = 200
"""Rounds of Newton's method at most: each gains more than a bit, or the search ends."""

GUARD_BITS = 64
"""Bits beyond what the run loses: so near to the true orbit is that of the start that comes out, at its end."""

FIRST_BITS = 192
"""Bits of the first rounds, which start from doubles."""

LINEAR = 2.0**-20
"""Corrections, as a share of the scale, below which tangent maps are not taken anew: the error of the old ones is of
that size itself."""

LEAST_GAIN = 0.5
"""A round that leaves more than this share of the misfits gains nothing."""

PATIENCE = 3
"""Rounds without gain after which the search ends: from a start that is far off, misfits may grow at first."""


@dataclass(frozen=True)
class Refined:
    """What came of the search.

    Attributes:
        nodes: the last nodes.
        misfits: the largest misfit of each round, as a share of the scale, in bits (log2).
        corrections: the largest correction of each round, likewise.
        closed: whether the misfits became as small as was asked for.
        bits: the precision at the end.
        missed: a contact that came to nothing, as the two passed each other by; None if none did.
    """

    nodes: list[Node]
    misfits: tuple[float, ...]
    corrections: tuple[float, ...]
    closed: bool
    bits: int
    missed: int | None = None


def refined(order: FixedOrder, nodes: Sequence[Sequence[float]], scale: Sequence[float]) -> Refined:
    """Closes the misfits from nodes in doubles.

    Args:
        nodes: the coordinates at the begin of each segment, and at the end of the last.
        scale: for each coordinate the size by which it is measured.
    """
    weights = np.array(scale)
    now: list[Node] = [[arb(value) for value in node] for node in nodes]
    maps: list[NDArray[np.float64]] = []
    misfits: list[float] = []
    corrections: list[float] = []
    bits, goal, stale = FIRST_BITS, 0.0, 0
    for _ in range(MOST_ROUNDS):
        with ball.precision(bits):
            fresh = not corrections or corrections[-1] > log2(LINEAR)
            try:
                residuals, new = _misfits(order, now, weights, fresh)
            except Missed as error:
                return Refined(now, tuple(misfits), tuple(corrections), False, bits, error.contact)
            if fresh:
                maps = new
                goal = -(_growth(maps) + GUARD_BITS)
            misfits.append(_largest(residuals))
            if misfits[-1] < goal:
                return Refined(now, tuple(misfits), tuple(corrections), True, bits)
            best = min(misfits[:-1], default=inf)
            stale = 0 if misfits[-1] < best + log2(LEAST_GAIN) else stale + 1
            if stale >= PATIENCE:
                break
            try:
                steps, exponent = shortest(maps, residuals)
            except np.linalg.LinAlgError:  # by a graze: growth there is without bound
                break
            corrections.append(exponent + log2(max(float(np.abs(step).max()) for step in steps) or 2.0**-1000))
            if corrections[-1] > 0:
                break
            factor = arb(2) ** exponent
            now = [
                [(value + arb(float(step) * float(weight)) * factor).mid() for value, step, weight in zip(
                    node, mine, weights, strict=True)]
                for node, mine in zip(now, steps, strict=True)
            ]  # fmt: skip
        bits = max(bits, int(GUARD_BITS + FIRST_BITS - goal))
    return Refined(now, tuple(misfits), tuple(corrections), False, bits)


def _misfits(
    order: FixedOrder, nodes: Sequence[Node], weights: NDArray[np.float64], fresh: bool
) -> tuple[list[list[arb]], list[NDArray[np.float64]]]:
    """Image less next node, of every segment, and the tangent maps if they are wanted; both by the scale."""
    residuals: list[list[arb]] = []
    maps: list[NDArray[np.float64]] = []
    for k, node in enumerate(nodes[:-1]):
        image, struck = order.image(k, node)
        residuals.append([(a - b) / arb(float(w)) for a, b, w in zip(image, nodes[k + 1], weights, strict=True)])
        if fresh:
            maps.append(order.tangent(k, struck) * weights[None, :] / weights[:, None])
    return residuals, maps


def _largest(residuals: Sequence[Sequence[arb]]) -> float:
    """log2 of the largest, whatever its size."""
    return max(_exponent(value) for row in residuals for value in row)


def _exponent(value: arb) -> float:
    top = value.abs_upper()
    return -inf if top.is_zero() else float(top.log() / arb(2).log())


def _growth(maps: Sequence[NDArray[np.float64]]) -> float:
    """Bits by which the worst displacement grows along all segments."""
    product, scale = np.eye(len(maps[0])), 0.0
    for step in maps:
        product = step @ product
        size = float(np.abs(product).max())
        product /= size
        scale += log2(size)
    return max(0.0, scale + log2(float(np.linalg.norm(product, 2))))


def shortest(
    maps: Sequence[NDArray[np.float64]], residuals: Sequence[Sequence[arb]]
) -> tuple[list[NDArray[np.float64]], int]:
    """The shortest corrections s with maps[k] s[k] - s[k + 1] = -residuals[k], and the exponent that they share.

    With A the matrix of these equations, s = -A^T (A A^T)^-1 r; A A^T has blocks on three diagonals only, and is
    solved by its block elimination.

    >>> import numpy as np
    >>> steps, exponent = shortest([np.eye(1) * 2], [[arb(1)]])
    >>> [float(step[0]) * 2.0**exponent for step in steps]  # 2 s0 - s1 = -1
    [-0.4, 0.2]
    """
    exponent = int(max(_largest(residuals), -1e9))
    factor = arb(2) ** -exponent
    right = [-np.array([float(value * factor) for value in row]) for row in residuals]
    unit = np.eye(len(right[0]))
    below: list[NDArray[Any]] = []
    sides: list[NDArray[Any]] = []
    for k, step in enumerate(maps):
        block, side = step @ step.T + unit, right[k]
        if k:
            block = block - step @ below[-1]
            side = side + step @ sides[-1]
        if k + 1 < len(maps):
            solved = np.linalg.solve(block, np.column_stack([maps[k + 1].T, side]))
            below.append(solved[:, :-1])
            sides.append(solved[:, -1])
        else:
            sides.append(np.linalg.solve(block, side))
    for k in range(len(maps) - 2, -1, -1):
        sides[k] = sides[k] + below[k] @ sides[k + 1]
    steps = [maps[0].T @ sides[0]]
    steps += [maps[k].T @ sides[k] - sides[k - 1] for k in range(1, len(maps))]
    return [*steps, -sides[-1]], exponent
