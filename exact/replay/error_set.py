"""What is known of the deviations of a state from its midpoints: one set for all bodies, carried along the run.

The midpoints z are numbers without radius; the true state is z + d. A step F leads from z to z' = F(z) - r, with the
rounding r, and from d to d' = J d + r, where J is the derivative of F on the hull of z and z + d (mean value theorem,
one row at a time). A product of so many J would be too wide as a box, by what the box around a turned box adds at each
step; so within a block of steps the set is kept as the image of a box,

    d = 2**shift (M e + b),  |e_k| <= box_k,  |b| <= E p for the place of a body, E q for its velocity,

with M in doubles. At the end of a block M is orthogonalised (Lohner 1987), its columns taken by size: with M = Q R,

    e' = Q^-1 (M e + b),  |e'| <= |R| box + |Q^-1| x,  x >= |M - Q R| box + |b|.

The computed Q is orthogonal only nearly: with Q^T Q = I + S, Q^-1 = (I + S)^-1 Q^T, so that
|Q^-1 x| <= y + s / (1 - s) max(y), where y = |Q^T| x and s >= the norm of S (Rump 1999). Beside M, each body keeps
p and q, bounds of how far its place and its velocity deviate, grown by norms at every step (`Bounds`): they are what a
reader of a body gets.

Coordinates of velocity are counted in a unit of time that makes them as large as those of position.

Sources: R. Lohner, "Enclosing the solutions of ordinary initial and boundary value problems", in Computer Arithmetic,
Teubner 1987; S. M. Rump, "Fast and parallel interval arithmetic", BIT 39, 534 (1999).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import frexp, inf, ldexp
from struct import Struct
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..compiled import steps
from ..laws.tangent_formulas import fall_turn, pair_tangent_blocks
from .error_bounds import CLOSE, MOST, NO_MIRROR, UP, Bounds, Collision, Mirror, Spent

Floats = NDArray[np.float64]

UNIT = 2.0**-53
"""The rounding of one operation in doubles, relative to its result."""

LEAST = 2.0**-300
"""Added to each edge of a box: products of doubles that vanish below 2**-1074 are far less."""

MOST_GROWTH = 2.0**45
"""By how much a bound may grow within a block. What is beside M is some 2**-32 of the bounds by then, as E grows by
2**-39 a step; in gases of 3 to 20 discs M grows by some 0.6 of the bits that they do, and stays 2**10 above that."""

FALLING_GROWTH, MANY_FALLING_GROWTH = 2.0**15, 2.0**30
"""The same in the frame that falls, of few bodies and of many. Of a circle that bounces on a floor bounds grow by 2.5
bits a contact, of one in a bowl by 1.5, and M hardly: at 2**30 what is beside M is 2**-5 of it, and fills the
directions in which it is thin. Of 900 events `bowl` loses 205 bits at 2**30, 94 at 2**15, two discs above a floor 342
and 310, five 361 and 348, and ten as many, for which a basis made anew costs more."""

FEW = 5
"""Bodies."""

CONTACTS_A_BODY = 20
"""Contacts in a block for each body, at most: making the basis anew then costs less than carrying it."""


def growth_in_a_block(bodies: int, fall: bool) -> float:
    """By how much a bound may grow before a block of so many bodies ends, which fall or do not."""
    if not fall:
        return MOST_GROWTH
    return FALLING_GROWTH if bodies <= FEW else MANY_FALLING_GROWTH


Legs: TypeAlias = tuple[float, float, float, float, float]
"""What a body flies between two collisions, walls among it: (xx, xy; yx, yy), all its mirrors, and how long. Mirrors
commute with flights, since they turn places and velocities alike."""

PARTS = 19
"""Numbers that are kept of a collision: the legs before it of both bodies, their weights, and its derivative."""

AS_BYTES = Struct(f"{PARTS}d").pack

STILL: Legs = (1.0, 0.0, 0.0, 1.0, 0.0)
"""Nothing yet."""


class ErrorSet:
    """The deviations of some bodies' x, y, vx, vy.

    Args:
        radii: for each body, bounds of its four deviations, divided by 2**shift.
        shift: see the module.
        unit: the time in which velocities are counted.
        growth: by how much a bound may grow within a block.

    Attributes:
        bounds: see there.
        near: `CLOSE` as the set counts it: divided by 2**shift, and no more than doubles hold.
    """

    def __init__(
        self, radii: Sequence[Sequence[float]], shift: int, unit: float = 1.0, growth: float = MOST_GROWTH
    ) -> None:
        count = len(radii)
        self._growth = growth
        self.shift = shift
        self._unit = unit
        self._basis: Floats = np.eye(4 * count)
        self._one = self._basis
        self._box: Floats = np.array(radii, dtype=np.float64).reshape(-1) * UP + LEAST
        self._count = count
        self._open()

    def _open(self) -> None:
        """The bounds at the start of a block: of each body, the lengths of its parts of the columns, summed."""
        squares = (self._basis * self._basis).reshape(self._count, 2, 2, -1).sum(axis=2)
        lengths = np.sqrt(squares) @ self._box * UP
        self.bounds = Bounds([*lengths[:, 0].tolist(), 0.0], [*lengths[:, 1].tolist(), 0.0])
        self._limit = float(lengths.max()) * self._growth
        self.near = ldexp(CLOSE, min(max(-self.shift, -900), 900))
        self._grown = False
        self._hits = bytearray()
        self._pairs: list[int] = []
        self._pending = [STILL] * (self._count + 1)
        self._steps = 0

    # -- steps: bounds are carried at once, what M needs at the end of the block

    def fly(self, i: int, lag: float, mirror: Mirror = NO_MIRROR, rounding: float = 0.0) -> None:
        """Body i moves on by `lag`, in the set's unit of time, and its line is then mirrored; see `Bounds.fly`."""
        self._steps += 1
        self.bounds.fly(i, lag, mirror.off, rounding)
        self._pending[i] = _then(self._pending[i], lag, mirror)
        if self.bounds.place[i] > self._limit:
            self._grown = True

    def meet(
        self, i: int, j: int, lags: tuple[float, float], weights: tuple[float, float], hit: Collision, rounding: float
    ) -> None:
        """See `Bounds.meet`."""
        bounds = self.bounds
        whole = weights[0] + weights[1]
        bounds.meet(i, j, lags, (2.0 * weights[0] / whole, 2.0 * weights[1] / whole), hit.turn, rounding)
        self._steps += 1
        pending, before_i, before_j = self._pending, self._pending[i], self._pending[j]
        legs = *before_i[:4], before_i[4] + lags[0], *before_j[:4], before_j[4] + lags[1]
        self._hits += AS_BYTES(*legs, *weights, *hit[3:])
        self._pairs += (i, j)
        pending[i] = pending[j] = STILL
        limit, place, pace = self._limit, bounds.place, bounds.pace
        if pace[i] > limit or pace[j] > limit or place[i] > limit or place[j] > limit:
            self._grown = True

    @property
    def full(self) -> bool:
        """Whether the block should end."""
        return self._grown or self._steps >= CONTACTS_A_BODY * self._count

    # -- the end of a block

    def close(self) -> None:
        """Ends a block: a new basis, a new box, tight bounds.

        Raises:
            Spent: if the doubles do not carry it.
        """
        with np.errstate(over="ignore", invalid="ignore"):  # told by what comes out
            basis = self._carried()
            order = np.argsort(-np.sqrt((basis * basis).sum(axis=0)) * self._box)
            ordered, box = basis[:, order], self._box[order]
            size = len(box)
            q, r = np.linalg.qr(ordered)
            size_q, inner = np.abs(q), np.abs(r) @ box
            gamma = (size + 8) * 4 * UNIT
            rest = np.abs(ordered - q @ r) @ box + gamma * (size_q @ inner + np.abs(ordered) @ box)
            x = (rest + self._beside()) * UP
            skew = float(np.abs(self._one - q.T @ q).sum(axis=1).max()) * UP + gamma * size * 2
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

    def _beside(self) -> Floats:
        """Bounds of what is beside M, coordinate by coordinate."""
        bounds = self.bounds
        of_two = np.array([bounds.place[:-1], bounds.pace[:-1]]).T * (bounds.beside * UP)
        return np.repeat(of_two.reshape(-1), 2)

    def _carried(self) -> Floats:
        """M at the end of the block: rows of fours, each collision a matrix on those of its two bodies; one body more,
        whose rows are zero, is all that is fixed."""
        rows = np.zeros((self._count + 1, 4, 4 * self._count))
        rows[:-1] = self._basis.reshape(self._count, 4, -1)
        hits = np.frombuffer(self._hits).reshape(-1, PARTS)
        blocks = _blocks(hits, self._unit)
        if steps is not None:
            steps.carry(rows, self._pairs, hits, blocks, self._pending)
        else:
            self._carry(rows, _maps(hits, blocks))
            rows = _flown(np.array(self._pending)) @ rows
        return rows[:-1].reshape(4 * self._count, -1)

    def _carry(self, rows: Floats, maps: Floats) -> None:
        """Carries rows through the collisions, those of bodies that share none together."""
        layers: list[int] = []
        layer = [0] * (self._count + 1)
        for i, j in zip(self._pairs[::2], self._pairs[1::2], strict=True):
            layer[-1] = 0  # what is fixed waits for nothing
            layers.append(max(layer[i], layer[j]))
            layer[i] = layer[j] = layers[-1] + 1
        order = np.argsort(layers, kind="stable")
        pairs, maps = np.array(self._pairs, dtype=np.intp).reshape(-1, 2)[order], maps[order]
        start = 0
        for end in np.cumsum(np.bincount(layers)).tolist():
            those = pairs[start:end].reshape(-1)
            part = maps[start:end] @ rows.take(those, axis=0).reshape(end - start, 8, -1)
            rows[those] = part.reshape(2 * (end - start), 4, -1)
            start = end

    def power_of(self, bound: float) -> int:
        """A k with bound * 2**shift at most 2**k.

        Raises:
            Spent: if the bound is beyond doubles.
        """
        if not bound < MOST:
            raise Spent
        return frexp(bound)[1] + self.shift


def _then(legs: Legs, lag: float, mirror: Mirror) -> Legs:
    """One more flight and mirror."""
    xx, xy, yx, yy, flown = legs
    a, b, d, _ = mirror
    return a * xx + b * yx, a * xy + b * yy, b * xx + d * yx, b * xy + d * yy, flown + lag


def _blocks(hits: Floats, unit: float) -> Floats:
    """Of each collision: (xx, xy, yy) of B and (xx, xy, yx, yy) of A, in the set's unit of time."""
    dx, dy, vx, vy, speed, strength, pull = hits[:, 12:].T
    cross, square = dx * vy - dy * vx, vx * vx + vy * vy
    xx, xy, yy, *turn = pair_tangent_blocks(dx, dy, -speed, cross, square, strength)
    (fxx, fyx), (fxy, fyy) = (fall_turn(dx, dy, -2.0 / strength, -speed, pull, *one) for one in ((1, 0), (0, 1)))
    flat, fallen = square == 0.0, (fxx, fxy, fyx, fyy)  # v is 0 at walls alone
    blocks: list[Floats] = [(np.where(flat, 0.0, part) + more) * unit for more, part in zip(fallen, turn, strict=True)]
    return np.array([xx, xy, yy, *blocks])


def _maps(hits: Floats, blocks: Floats) -> Floats:
    """The matrix of each collision: what its bodies flew before, and then the collision."""
    xx, xy, yy, *turn = blocks
    c = np.zeros((len(hits), 4, 4))
    c[:, 0, 0] = c[:, 2, 2] = xx
    c[:, 0, 1] = c[:, 1, 0] = c[:, 2, 3] = c[:, 3, 2] = xy
    c[:, 1, 1] = c[:, 3, 3] = yy
    c[:, 2, 0], c[:, 2, 1], c[:, 3, 0], c[:, 3, 1] = turn
    both = np.empty((len(hits), 8, 8))
    one, other = _flown(hits[:, :5]), _flown(hits[:, 5:10])
    mine, its = c @ one, c @ other
    wi, wj = hits[:, 10, None, None], hits[:, 11, None, None]
    both[:, :4, :4], both[:, :4, 4:] = one + wi * mine, -wi * its
    both[:, 4:, :4], both[:, 4:, 4:] = -wj * mine, other + wj * its
    return both


def _flown(legs: Floats) -> Floats:
    """The matrices of `Legs`, on fours."""
    maps = np.zeros((len(legs), 4, 4))
    maps[:, :2, :2] = maps[:, 2:, 2:] = turned = legs[:, :4].reshape(-1, 2, 2)
    maps[:, :2, 2:] = turned * legs[:, 4, None, None]
    return maps
