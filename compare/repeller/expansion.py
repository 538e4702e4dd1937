"""Cycle expansion: escape rate, mean exponent and entropy of the repeller, from its periodic orbits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import takewhile

from flint import arb

from ...exact.numbers import ball
from ...scenarios.numbers.quantity import Quantity
from .orbits import BITS, Orbit, orbit, pinball, words

STEPS = 60
"""Newton steps in which a simple zero is found to all bits."""


@dataclass(frozen=True)
class Averages:
    """What the expansion up to cycles of so many letters gives.

    Attributes:
        order: letters of the longest cycles.
        orbits: how many there are.
        escape: the escape rate per unit time, at speed 1 and radius 1.
        exponent: the mean Lyapunov exponent per unit time on the repeller.
    """

    order: int
    orbits: int
    escape: arb
    exponent: arb

    @property
    def entropy(self) -> arb:
        """The Kolmogorov-Sinai entropy per unit time: the exponent less the escape rate.

        H. Kantz, P. Grassberger, Physica D 17 (1985), 75.
        """
        with ball.precision(BITS):
            return self.exponent - self.escape


def determinant(orbits: Sequence[Orbit], order: int, s: arb) -> tuple[arb, arb, arb]:
    """The spectral determinant, cut off after cycles of `order` letters, and its slopes in s and in b.

    exp(-sum over cycles p and repeats r of exp(r (b ln|M| - s T)) / (r |1 - M**r| |1 - M**-r|)), expanded in the
    number of letters; T is a cycle's period, M its multiplier; the slopes are those at b = 0. This is the factor of
    functions that are symmetric under all of the triangle.

    Sources: P. Cvitanovic, B. Eckhardt, Symmetry decomposition of chaotic dynamics, Nonlinearity 6 (1993), 277; the
    recursion of the coefficients is Newton's, from power sums.
    """
    sums = [[arb(0)] * 3 for _ in range(order + 1)]
    for told in orbits:
        letters, stretched = len(told.word), abs(told.multiplier).log()
        for repeat in range(1, order // letters + 1):
            power = told.multiplier**repeat
            weight = letters * (-s * told.length * repeat).exp() / abs((1 - power) * (1 - 1 / power))
            mine = sums[letters * repeat]
            for k, factor in enumerate((arb(1), -told.length * repeat, stretched * repeat)):
                mine[k] += weight * factor
    terms = [[arb(1), arb(0), arb(0)]]
    for k in range(1, order + 1):
        new = [arb(0)] * 3
        for j in range(1, k + 1):
            (c, cs, cb), (f, fs, fb) = sums[j], terms[k - j]
            new[0] -= c * f / k
            new[1] -= (cs * f + c * fs) / k
            new[2] -= (cb * f + c * fb) / k
        terms.append(new)
    value, by_s, by_b = (sum((term[i] for term in terms), arb(0)) for i in range(3))
    return value, by_s, by_b


def averages(orbits: Sequence[Orbit], order: int) -> Averages:
    """The averages from the cycles of up to `order` letters.

    The escape rate is -s at the determinant's zero that is nearest below s = 0, where Newton's method begins; how that
    zero moves with b is the mean exponent.
    """
    used = [told for told in orbits if len(told.word) <= order]
    with ball.precision(BITS):
        s = arb(0)
        for _ in range(STEPS):
            value, slope, _ = determinant(used, order, s)
            step = (value / slope).mid()
            s = (s - step).mid()
            if abs(step) < arb(2) ** (-BITS // 2):
                break
        value, slope, tilt = determinant(used, order, s)
        return Averages(order, len(used), value / slope - s, -tilt / slope)


def ladder(distance: Quantity, most: int) -> Iterator[Averages]:
    """The averages by cycles of up to 1, 2, ... letters.

    Raises:
        SceneError: if the discs stand too close for every word to have its orbit.

    >>> *_, told = ladder(Quantity.of(6), 5)
    >>> told.orbits, told.escape.str(13, radius=False), told.exponent.str(10, radius=False)
    (14, '0.4103384077696', '0.5775525788')
    """
    scene = pinball(distance)
    orbits = [orbit(scene, word) for word in words(most)]
    for order in range(1, most + 1):
        yield averages(orbits, order)


def settled(one: arb, two: arb) -> str:
    """The digits that two orders have in common, cut off.

    >>> settled(arb("0.41033"), arb("0.41056"))
    '0.410'
    """
    with ball.precision(BITS):
        texts = [value.str(60, radius=False) for value in (one, two)]
    return "".join(a for a, _ in takewhile(lambda pair: pair[0] == pair[1], zip(*texts, strict=False)))
