"""Small linear systems in any numbers."""

from __future__ import annotations

from collections.abc import Sequence

from .system import N


def solve_positive(matrix: Sequence[Sequence[N]], right: Sequence[N]) -> list[N]:
    """Solves a symmetric positive definite system by elimination; its pivots need no choice.

    >>> from fractions import Fraction as Q
    >>> solve_positive([[Q(2), Q(1)], [Q(1), Q(2)]], [Q(3), Q(0)])
    [Fraction(2, 1), Fraction(-1, 1)]
    """
    rows = [[*row, value] for row, value in zip(matrix, right, strict=True)]
    size = len(rows)
    for k in range(size):
        for below in rows[k + 1 :]:
            factor = below[k] / rows[k][k]
            for column in range(k + 1, size + 1):
                below[column] = below[column] - factor * rows[k][column]
    solution: list[N] = []  # from the last to the first
    for k in reversed(range(size)):
        value = rows[k][size]
        for column in range(k + 1, size):
            value = value - rows[k][column] * solution[size - 1 - column]
        solution.append(value / rows[k][k])
    return solution[::-1]
