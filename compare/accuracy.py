"""How many digits of a run are right at the end, with a bound that is proved."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from flint import arb  # type: ignore[attr-defined]

from ..exact.numbers import ball
from ..scenarios.numbers.quantity import Quantity

if TYPE_CHECKING:
    from ..scenarios.numbers.real import Real
    from ..scenarios.trajectory import State, Trajectory

LEAST_BITS, MOST_BITS = 192, 1 << 14
"""Bits with which the places of a certified run are enclosed: more as long as they, and not the engine's own numbers,
limit what is known of the error; 2**14 bits are 4,900 digits."""


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

    >>> from truebreak.compare.run import run
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
    while True:
        found = _farthest(mine, theirs, bits)
        if found.sharp or bits >= MOST_BITS:
            break
        bits *= 2
    reach = max(abs(float(v)) for c in mine.circles for v in (c.x, c.y))
    widest = max(float(c.r) for c in reference.scene.circles)
    return EndError(last, found.circle, found.error, math.log10(max(reach, widest) or 1.0))


def _at_most(time: Real) -> Quantity:
    """A number that is not above a time, and hardly below."""
    return time if isinstance(time, Quantity) else Quantity.of(Fraction(max(time.bounds()[0], 0.0)))


@dataclass(frozen=True)
class _Found:
    circle: str
    error: float
    sharp: bool


def _farthest(mine: State, theirs: State, bits: int) -> _Found:
    """The circle farthest off; `sharp` if the certified places are known far better than that."""
    told: list[tuple[float, str, bool]] = []
    with ball.precision(2 * bits):
        for a, b in zip(mine.circles, theirs.circles, strict=True):
            places = [(p.ball(bits), q.ball(bits)) for p, q in ((a.x, b.x), (a.y, b.y))]
            apart = [(p - q).abs_upper() for p, q in places]
            far = (apart[0] ** 2 + apart[1] ** 2).sqrt().upper()
            known = sum((p.rad() for p, _ in places), arb(0))
            sharp = bool(far.is_zero()) or bool(known * 1000 < far)
            told.append((_log10(far), a.id, sharp))
    worst = max(told, key=lambda one: one[0])
    return _Found(worst[1], worst[0], worst[2])


def _log10(value: arb) -> float:
    """log10 of a number from 0 on, rounded up; minus infinity for 0."""
    if value.is_zero():
        return -math.inf
    return ball.double_bounds(value.log() / arb(10).log())[1]
