"""What is known of the deviations of a state from its midpoints: one set for all bodies, carried along the run.

The midpoints z are numbers without radius; the true state is z + d. A step F leads from z to z' = F(z) - r, with the
rounding r, and from d to d' = J d + r, where J is the derivative of F on the hull of z and z + d (mean value theorem,
one row at a time). A product of so many J would be too wide as a box, by what the box around a turned box adds at each
step; so within a block of steps the set is kept as the image of a box,

    d = 2**shift (M e + b),  |e_k| <= box_k,  |b| <= mu of the body (largest coordinate),

with M in doubles. At the end of a block M is orthogonalised (Lohner 1987), its columns taken by size: with M = Q R,

    e' = Q^-1 (M e + b),  |e'| <= |R| box + |Q^-1| x,  x >= |M - Q R| box + mu.

The computed Q is orthogonal only nearly: with Q^T Q = I + S, Q^-1 = (I + S)^-1 Q^T, so that
|Q^-1 x| <= y + s / (1 - s) max(y), where y = |Q^T| x and s >= the norm of S (Rump 1999). Beside M, each body keeps
nu, a bound of all its coordinates that is grown by norms at every step: it is what a reader of a body gets.

Coordinates of velocity are counted in a unit of time that makes them as large as those of position.

Sources: R. Lohner, "Enclosing the solutions of ordinary initial and boundary value problems", in Computer Arithmetic,
Teubner 1987; S. M. Rump, "Fast and parallel interval arithmetic", BIT 39, 534 (1999).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import frexp, inf, ldexp

import numpy as np
from numpy.typing import NDArray

from ..laws.tangent_formulas import pair_tangent_blocks
from .errors import MOST, UP, Bounds, Collision, Leg, Spent

Floats = NDArray[np.float64]

UNIT = 2.0**-53
"""The rounding of one operation in doubles, relative to its result."""

LEAST = 2.0**-300
"""Added to each edge of a box: products of doubles that vanish below 2**-1074 are far less."""

MOST_GROWTH = 2.0**35
"""By how much nu may grow within a block: what is beside M grows alike, from 2**-49, so that it stays below the box. M
itself grows by less than half as many bits, as norms know nothing of directions."""

CONTACTS_A_BODY = 12
"""Contacts in a block for each body, at most: making the basis anew then costs less than carrying it."""


class ErrorSet:
    """The deviations of some bodies' x, y, vx, vy.

    Args:
        radii: for each body, bounds of its four deviations, divided by 2**shift.
        shift: see the module.
        unit: the time in which velocities are counted.

    Attributes:
        bounds: see there.
    """

    def __init__(self, radii: Sequence[Sequence[float]], shift: int, unit: float = 1.0) -> None:
        count = len(radii)
        self.shift = shift
        self._unit = unit
        self._basis: Floats = np.eye(4 * count)
        self._box: Floats = np.array(radii, dtype=np.float64).reshape(-1) * UP + LEAST
        self._count = count
        self._open()

    def _open(self) -> None:
        """The bounds at the start of a block: the largest coordinate of any deviation in the set."""
        rows = (np.abs(self._basis) @ self._box).reshape(self._count, 4).max(axis=1) * UP
        self.bounds = Bounds([*rows.tolist(), 0.0])
        self._limit = max(self.bounds.nu) * MOST_GROWTH
        self._grown = False
        self._legs: list[tuple[float, ...]] = []
        self._hits: list[tuple[int, tuple[float, float], tuple[float, float], Collision]] = []
        self._pairs: list[tuple[int, int]] = []
        self._layers: list[int] = []
        self._layer = [0] * (self._count + 1)

    # -- steps: bounds are carried at once, what M needs at the end of the block

    def fly(self, leg: Leg, off: float = 0.0, rounding: float = 0.0) -> None:
        """See `Bounds.fly`."""
        self.bounds.fly(leg, off, rounding)
        i, lag, xx, xy, yy = leg
        self._legs.append((len(self._pairs), lag, xx, xy, yy))
        self._grown |= self.bounds.nu[i] > self._limit
        self._pairs.append((i, -1))
        self._layers.append(self._layer[i])
        self._layer[i] += 1

    def meet(
        self, i: int, j: int, lags: tuple[float, float], weights: tuple[float, float], hit: Collision, rounding: float
    ) -> None:
        """See `Bounds.meet`."""
        self.bounds.meet(i, j, lags, weights, hit, rounding)
        self._hits.append((len(self._pairs), lags, weights, hit))
        nu = self.bounds.nu
        self._grown |= nu[i] > self._limit or nu[j] > self._limit
        self._pairs.append((i, j))
        layer = self._layer
        layer[-1] = 0  # what is fixed waits for nothing
        later = max(layer[i], layer[j])
        self._layers.append(later)
        layer[i] = layer[j] = later + 1

    @property
    def full(self) -> bool:
        """Whether the block should end."""
        return self._grown or len(self._pairs) >= CONTACTS_A_BODY * self._count

    # -- the end of a block

    def close(self) -> None:
        """Ends a block: a new basis, a new box, tight bounds.

        Raises:
            Spent: if the doubles do not carry it.
        """
        with np.errstate(over="ignore", invalid="ignore"):  # told by what comes out
            basis = self._carried()
            order = np.argsort(-np.linalg.norm(basis, axis=0) * self._box)
            ordered, box = basis[:, order], self._box[order]
            if not np.isfinite(ordered).all():
                raise Spent
            size = len(box)
            q, r = np.linalg.qr(ordered)
            size_q, inner = np.abs(q), np.abs(r) @ box
            gamma = (size + 8) * 4 * UNIT
            rest = np.abs(ordered - q @ r) @ box + gamma * (size_q @ inner + np.abs(ordered) @ box)
            x = (rest * UP + np.repeat(np.array(self.bounds.mu[:-1]), 4)) * UP
            skew = float(np.abs(np.eye(size) - q.T @ q).sum(axis=1).max()) * UP + gamma * size * 2
            if not skew < 2.0**-20:
                raise Spent
            y = size_q.T @ x * UP
            new = (inner + y + skew / (1.0 - skew) * float(y.max())) * UP
        top = float(new.max())
        if not 0.0 < top < inf:
            raise Spent
        up = frexp(top)[1]
        self._basis, self._box, self.shift = q, new * 2.0**-up + LEAST, self.shift + up
        self._open()

    def _carried(self) -> Floats:
        """M at the end of the block: rows of fours, each step a matrix on those of its two bodies.

        Steps of bodies that share none are carried together; one body more, whose rows are zero, is all that is fixed.
        """
        rows = np.zeros((self._count + 1, 4, 4 * self._count))
        rows[:-1] = self._basis.reshape(self._count, 4, -1)
        layers = np.array(self._layers, dtype=np.intp)
        order = np.argsort(layers, kind="stable")
        pairs, maps = np.array(self._pairs, dtype=np.intp).reshape(-1, 2)[order], self._maps()[order]
        start = 0
        for end in np.cumsum(np.bincount(layers)).tolist():
            those, part = pairs[start:end], maps[start:end]
            rows[those] = (part @ rows[those].reshape(end - start, 8, -1)).reshape(end - start, 2, 4, -1)
            start = end
        return rows[:-1].reshape(4 * self._count, -1)

    def _maps(self) -> Floats:
        """The matrix of each step: flights, then a mirror or a collision."""
        maps = np.zeros((len(self._pairs), 8, 8))
        if self._legs:
            k, lag, xx, xy, yy = np.array(self._legs).T
            own = maps[at := k.astype(np.intp)]
            own[:, 0, 0] = own[:, 2, 2] = xx
            own[:, 0, 1] = own[:, 1, 0] = own[:, 2, 3] = own[:, 3, 2] = xy
            own[:, 1, 1] = own[:, 3, 3] = yy
            own[:, :2, 2:4] = own[:, :2, :2] * lag[:, None, None]
            maps[at] = own
        if self._hits:
            hits = np.array([(k, *lags, *weights, *hit[4:]) for k, lags, weights, hit in self._hits])
            k, lag_i, lag_j, wi, wj, dx, dy, vx, vy, speed, strength = hits.T
            cross, square = dx * vy - dy * vx, vx * vx + vy * vy
            xx, xy, yy, *turn = pair_tangent_blocks(dx, dy, -speed, cross, square, strength)
            c = np.zeros((len(k), 4, 4))
            c[:, 0, 0] = c[:, 2, 2] = xx
            c[:, 0, 1] = c[:, 1, 0] = c[:, 2, 3] = c[:, 3, 2] = xy
            c[:, 1, 1] = c[:, 3, 3] = yy
            c[:, 2, 0], c[:, 2, 1], c[:, 3, 0], c[:, 3, 1] = (part * self._unit for part in turn)
            both = np.empty((len(k), 8, 8))
            own, other = wi[:, None, None] * c, wj[:, None, None] * c
            both[:, :4, :4], both[:, :4, 4:] = np.eye(4) + own, -own
            both[:, 4:, :4], both[:, 4:, 4:] = -other, np.eye(4) + other
            both[:, :, 2:4] += lag_i[:, None, None] * both[:, :, :2]
            both[:, :, 6:] += lag_j[:, None, None] * both[:, :, 4:6]
            maps[k.astype(np.intp)] = both
        return maps

    def doubles(self, bound: float) -> float:
        """A bound as the set counts it: divided by 2**shift, and no more than doubles hold."""
        return ldexp(bound, min(max(-self.shift, -900), 900))

    def power(self, i: int) -> int:
        """A k with all deviations of body i at most 2**k."""
        return self.power_of(self.bounds.nu[i])

    def power_of(self, bound: float) -> int:
        """A k with bound * 2**shift at most 2**k.

        Raises:
            Spent: if the bound is beyond doubles.
        """
        if not bound < MOST:
            raise Spent
        return frexp(bound)[1] + self.shift
