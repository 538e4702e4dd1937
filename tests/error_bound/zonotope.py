"""The set of deviations carried along a log in plain matrices of balls: one generator for each edge of the first boxes,
and for each rounding since. Its hull is the least that a bound of the same set can be.
"""

from __future__ import annotations

from collections.abc import Sequence

from flint import arb, arb_mat

from error_bound.oracle import Dual, Line, Table, collided, fallen_beside, middle, rebounded
from truebreak.exact.numbers import ball
from truebreak.exact.replay.contact import AtArc, AtWall, Pair, Touch

BITS = 1024
"""Precision of the matrices: what they lose by being multiplied is far less."""


def hull(one: arb, other: arb) -> arb:
    """A ball that holds two."""
    return one.union(other)


class Zonotope:
    """All deviations of some circles: sums of generators, each taken at most once, either way.

    Args:
        midpoints: of each circle, by index, with its clock.
        radii: of its four numbers.
        table, sides: of the scene.
    """

    def __init__(
        self, midpoints: dict[int, Line], radii: dict[int, Sequence[arb]], table: Table, sides: list[list[int]]
    ) -> None:
        self.midpoints = midpoints
        self._table = table
        self._sides = sides
        self._columns = 0
        self._rows: dict[int, list[list[arb]]] = {i: [[] for _ in range(4)] for i in midpoints}
        self._spans: dict[int, int] = dict.fromkeys(midpoints, 0)
        for i, four in radii.items():
            self._widen(i, four)

    def _widen(self, i: int, radii: Sequence[arb]) -> None:
        """A generator for each coordinate of a circle."""
        rows = self._rows[i]
        zeros = [arb(0)] * (self._columns - len(rows[0]))
        for k, radius in enumerate(radii):
            rows[k] += [*zeros, *(radius if k == other else arb(0) for other in range(4))]
        self._columns += 4

    def step(
        self, link: Touch | None, moved: Sequence[int], after: dict[int, Line], truth: dict[int, Line],
        radii: dict[int, Sequence[arb]],
    ) -> None:  # fmt: skip
        """Carries the circles of one contact, or in flight, to new midpoints.

        Args:
            link: what they meet; None for a flight.
            moved: the circles of the set among them.
            after: their new midpoints and clocks.
            truth: before it, the true lines of all its circles.
            radii: the roundings of the new midpoints.
        """
        with ball.precision(BITS):
            ends = link.circles if isinstance(link, Pair) else moved
            duals: dict[int, Line] = {}
            width = 4 * len(moved)
            for i in ends:
                old = self.midpoints.get(i, truth[i])
                there = truth[i].at(old.t)
                values = [hull(+p, +q) for p, q in zip(old[:4], there[:4], strict=True)]
                if i in moved:
                    at = 4 * moved.index(i)
                    four = [Dual(v, [arb(int(at + k == c)) for c in range(width)]) for k, v in enumerate(values)]
                else:
                    four = [Dual(v, [arb(0)] * width) for v in values]
                duals[i] = Line(*four, old.t)
            clock = after[moved[0]].t
            new = dict(zip(ends, self._carried(link, [duals[i] for i in ends], clock), strict=True))
            jacobian = arb_mat([new[i][k].by for i in moved for k in range(4)])
            rows = [[*row, *([arb(0)] * (self._columns - len(row)))] for i in moved for row in self._rows[i]]
            if self._columns:
                product = (jacobian * arb_mat(rows)).tolist()
                for place, i in enumerate(moved):
                    self._rows[i] = product[4 * place : 4 * place + 4]
            for i in moved:
                self.midpoints[i] = after[i]
                self._widen(i, radii[i])

    def _carried(self, link: Touch | None, ends: list[Line], clock: arb) -> Sequence[Line]:
        table = self._table
        if table.pulls and isinstance(link, Pair) and (table.w[link.a] == 0) is not (table.w[link.b] == 0):
            return self._fallen(link, ends, clock)
        if isinstance(link, Pair):
            a, b = link
            return collided(ends[0], ends[1], table.r[a] + table.r[b], table.w[a], table.w[b], table.e, clock)
        if isinstance(link, AtWall):
            i, k = link.circle, link.wall
            return [rebounded(ends[0], table.walls[k], table.r[i], self._sides[i][k], table.e, clock)]
        if isinstance(link, AtArc):
            at, reach, hollow = middle(table, link)
            if table.pulls:
                return [fallen_beside(ends[0], at, reach, table.e, table.g, clock)]
            return collided(ends[0], at, reach, table.w[link.circle], arb(0), table.e, clock, hollow)[:1]
        return [line.at(clock) for line in ends]

    def _fallen(self, link: Pair, ends: list[Line], clock: arb) -> Sequence[Line]:
        """One that falls onto one that stands; in their order."""
        table, turned = self._table, bool(self._table.w[link.a] == 0)
        a, b = reversed(ends) if turned else ends
        still = Line(*(part.value for part in b[:4]), b.t)
        after = fallen_beside(a, still, table.r[link.a] + table.r[link.b], table.e, table.g, clock)
        return [b, after] if turned else [after, b]

    def hull(self, i: int) -> list[arb]:
        """The largest deviation of each of a circle's four numbers."""
        with ball.precision(BITS):
            return [sum((abs(value) for value in row), arb(0)) for row in self._rows[i]]

    def along(self, basis: arb_mat, order: Sequence[int], unit: float) -> list[arb]:
        """The largest coordinate of any deviation along each vector of a basis.

        Args:
            basis: its vectors are columns, of four rows for each circle.
            order: the circles.
            unit: the time in which velocities are counted.
        """
        with ball.precision(BITS):
            rows: list[list[arb]] = []
            for i in order:
                for k, row in enumerate(self._rows[i]):
                    full = [*row, *([arb(0)] * (self._columns - len(row)))]
                    rows.append([value * unit for value in full] if k > 1 else full)
            found = basis.solve(arb_mat(rows)).tolist()
            return [sum((abs(value) for value in row), arb(0)) for row in found]
