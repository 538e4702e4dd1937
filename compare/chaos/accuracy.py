"""How many digits of a run are right at the end, with a bound that is proved."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from flint import arb

from ...exact.numbers import ball
from ...scenarios.numbers.quantity import Quantity

if TYPE_CHECKING:
    from ...scenarios.numbers.quantity import Real
    from ...scenarios.trajectory import State, Trajectory

LEAST_BITS, MOST_BITS = 512, 1 << 14
"""Bits with which places are enclosed: twice as many as long as the bound of the error still falls, for then it is not
the error that it tells; 2**14 bits are 4,900 digits."""

STILL = 0.01
"""A bound that falls by less than so many digits stands still."""


@dataclass(frozen=True)
class EndError:
    """How far the circles of a run are from their certified places at one time.

    Attributes:
        time: when, a double.
        circle: the one that is farthest off.
        error: an upper bound of its distance from its place, as log10; minus infinity for none at all.
        scale: the largest coordinate or radius there, as log10.
    """

    time: float
    circle: str
    error: float
    scale: float

    @property
    def digits(self) -> float:
        """Decimal digits that are right: -log10 of the distance as a share of the largest coordinate.

        >>> EndError(4.0, "c1", -5.0, 1.0).digits
        6.0
        """
        return self.scale - self.error


def end_error(reference: Trajectory, candidate: Trajectory, end: float | None = None) -> EndError | None:
    """The error of a candidate at the end of a certified run; None if the candidate does not get there.

    The end is the last double that is not after it, so that all engines are asked for one and the same time. An engine
    that encloses its numbers is taken at the worst of what it encloses.

    Args:
        end: another time, before the end.

    >>> from truebreak.compare.foreign.guard import run
    >>> from truebreak.scenarios import Circle, Scene
    >>> scene = Scene([Circle(0, 0, vx=1), Circle(4, 1)], until=9)
    >>> 14 < end_error(run(scene), run(scene, "double")).digits < 18
    True
    """
    last = float(reference.final_time) if end is None else end
    if end is None and Quantity.of(Fraction(last)) > _at_most(reference.final_time):
        last = max(math.nextafter(last, -math.inf), 0.0)
    if float(candidate.final_time) < last:
        return None
    time = Quantity.of(Fraction(last))
    mine, theirs = reference.at(time), candidate.at(time)
    bits = LEAST_BITS
    found = _farthest(mine, theirs, bits)
    while bits < MOST_BITS:
        bits *= 2
        before, found = found, _farthest(mine, theirs, bits)
        if before[0] - found[0] < STILL:
            break
    error, circle = found
    reach = max(abs(float(v)) for c in mine.circles for v in (c.x, c.y))
    widest = max(float(c.r) for c in reference.scene.circles)
    return EndError(last, circle, error, math.log10(max(reach, widest) or 1.0))


def _at_most(time: Real) -> Quantity:
    """A number that is not above a time, and hardly below."""
    return time if isinstance(time, Quantity) else Quantity.of(Fraction(max(time.bounds()[0], 0.0)))


def _farthest(mine: State, theirs: State, bits: int) -> tuple[float, str]:
    """log10 of a bound of the largest distance of a circle from its place, and the circle."""
    told: list[tuple[float, str]] = []
    with ball.precision(2 * bits):
        for a, b in zip(mine.circles, theirs.circles, strict=True):
            apart = [(p.ball(bits) - q.ball(bits)).abs_upper() for p, q in ((a.x, b.x), (a.y, b.y))]
            told.append((_log10((apart[0] ** 2 + apart[1] ** 2).sqrt().upper()), a.id))
    return max(told)


def _log10(value: arb) -> float:
    """log10 of a number from 0 on, rounded up; minus infinity for 0."""
    if value.is_zero():
        return -math.inf
    return ball.double_bounds(value.log() / arb(10).log())[1]
