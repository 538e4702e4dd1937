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

from .errors import MOST, UP, ErrorStep, Fly, Meet, Mirror, Spent, grow

Floats = NDArray[np.float64]

UNIT = 2.0**-53
"""The rounding of one operation in doubles, relative to its result."""

LEAST = 2.0**-300
"""Added to each edge of a box: products of doubles that vanish below 2**-1074 are far less."""

MOST_GROWTH = 2.0**35
"""By how much nu may grow within a block: twice that is what doubles lose of M, and they have 53 bits."""


STEPS_A_BODY = 20
"""Steps in a block for each body, some three collisions: there the cost of making the basis anew is no more than that
of carrying it."""


class ErrorSet:
    """The deviations of some bodies' x, y, vx, vy.

    Args:
        radii: for each body, bounds of its four deviations, divided by 2**shift.
        shift: see the module.

    Attributes:
        nu: for each body, a bound of its deviations, divided by 2**shift; 0 at last, for what is fixed.
    """

    def __init__(self, radii: Sequence[Sequence[float]], shift: int) -> None:
        count = len(radii)
        self.shift = shift
        self._basis: Floats = np.eye(4 * count)
        self._box: Floats = np.array(radii, dtype=np.float64).reshape(-1) * UP + LEAST
        self._count = count
        self._steps: list[tuple[ErrorStep, float, float]] = []
        self._open()

    def _open(self) -> None:
        """The bounds at the start of a block."""
        self.nu = self._bounds()
        self._limit = max(self.nu) * MOST_GROWTH

    def _bounds(self) -> list[float]:
        """For each body, the largest coordinate of any deviation in the set at the start of the block; 0 at last, for
        what is fixed."""
        rows = (np.abs(self._basis) @ self._box).reshape(self._count, 4).max(axis=1) * UP
        return [*rows.tolist(), 0.0]

    def do(self, step: ErrorStep) -> None:
        """Carries nu through a step; what M needs is done at the end of the block."""
        nu, j = self.nu, step.j
        self._steps.append((step, nu[step.i], nu[j]))
        grow(nu, step)

    @property
    def full(self) -> bool:
        """Whether the block should end."""
        return len(self._steps) >= STEPS_A_BODY * self._count or max(self.nu) > self._limit

    # -- the end of a block

    def close(self) -> None:
        """Ends a block: a new basis, a new box, tight bounds.

        Raises:
            Spent: if the doubles do not carry it.
        """
        with np.errstate(over="ignore", invalid="ignore"):  # told by what comes out
            basis, mu = self._carried()
        size = basis.shape[0]
        order = np.argsort(-np.linalg.norm(basis, axis=0) * self._box)
        ordered, box = basis[:, order], self._box[order]
        if not np.isfinite(ordered).all():
            raise Spent
        q, r = np.linalg.qr(ordered)
        size_q, size_r = np.abs(q), np.abs(r)
        gamma = (size + 8) * 4 * UNIT
        rest = np.abs(ordered - q @ r) * UP + gamma * (size_q @ size_r + np.abs(ordered))
        x = (rest @ box + np.repeat(mu[:-1], 4)) * UP
        skew = float(np.abs(np.eye(size) - q.T @ q).sum(axis=1).max()) * UP + gamma * size * 2
        if not skew < 2.0**-20:
            raise Spent
        y = size_q.T @ x * UP
        new = (size_r @ box + y + skew / (1.0 - skew) * float(y.max())) * UP
        top = float(new.max())
        if not 0.0 < top < inf:
            raise Spent
        up = frexp(top)[1]
        self._basis, self._box, self.shift = q, new * 2.0**-up + LEAST, self.shift + up
        self._steps = []
        self._open()

    def _carried(self) -> tuple[Floats, list[float]]:
        """M at the end of the block, and for each body a bound of what it does not tell.

        What M loses in a step is bounded by its norm and by nu before it, which bounds |M| box as well.
        """
        rows = list(self._basis.copy().reshape(self._count, 4, -1))
        mu = [0.0] * (self._count + 1)
        c = np.zeros((4, 4))
        top, low = c[:2, :2], c[2:, 2:]
        turn = c[2:, :2]
        for step, nu_i, nu_j in self._steps:
            i = step.i
            if isinstance(step, Fly):
                own, lag = rows[i], step.lag
                own[:2] += lag * own[2:]
                grow(mu, step)
                mu[i] += 5 * UNIT * (1.0 + abs(lag)) * nu_i
            elif isinstance(step, Meet):
                j, wi, wj, blocks = step.j, step.wi, step.wj, step.blocks
                top[:] = low[:] = blocks.b
                turn[:] = blocks.a
                gain = c @ (-rows[i] if j < 0 else rows[j] if i < 0 else rows[j] - rows[i])
                slip = (blocks.off + 32 * UNIT * blocks.norm) * (nu_i + nu_j) * UP
                grow(mu, step)
                if i >= 0:
                    rows[i] -= gain if wi == 1.0 else wi * gain
                    mu[i] = (mu[i] + wi * slip + 8 * UNIT * nu_i) * UP
                if j >= 0:
                    rows[j] += gain if wj == 1.0 else wj * gain
                    mu[j] = (mu[j] + wj * slip + 8 * UNIT * nu_j) * UP
            elif isinstance(step, Mirror):
                _mirror(rows[i], step.xx, step.xy, step.yy)
                grow(mu, step)
                mu[i] = (mu[i] + (step.off + 16 * UNIT) * nu_i) * UP
            else:
                grow(mu, step)
        return np.array(rows).reshape(4 * self._count, -1), mu

    def doubles(self, bound: float) -> float:
        """A bound as the set counts it: divided by 2**shift, and no more than doubles hold."""
        return ldexp(bound, min(max(-self.shift, -900), 900))

    def power(self, i: int) -> int:
        """A k with all deviations of body i at most 2**k."""
        return self.power_of(self.nu[i])

    def power_of(self, bound: float) -> int:
        """A k with bound * 2**shift at most 2**k.

        Raises:
            Spent: if the bound is beyond doubles.
        """
        if not bound < MOST:
            raise Spent
        return frexp(bound)[1] + self.shift


def _mirror(own: Floats, xx: float, xy: float, yy: float) -> None:
    """Mirrors four rows in place."""
    if xy == 0.0:
        own *= np.array(((xx,), (yy,), (xx,), (yy,)))
    else:
        matrix = np.array(((xx, xy), (xy, yy)))
        own[:2], own[2:] = matrix @ own[:2], matrix @ own[2:]
