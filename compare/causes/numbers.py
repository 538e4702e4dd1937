"""An engine's numbers as balls: enclosures of what the engine says."""

from __future__ import annotations

from typing import Any

from flint import arb  # type: ignore[attr-defined]

from ...exact.numbers import ball
from ...scenarios.numbers.quantity import Quantity


def enclosure(value: Any, bits: int) -> arb:
    """A number of any engine as a ball: exact numbers to so many bits, a double as the dyadic number that it is.

    >>> from truebreak.scenarios import Quantity
    >>> enclosure(Quantity.of("1/3"), 64).overlaps(arb(1) / 3), enclosure(0.5, 64).is_exact()
    (True, True)
    """
    if hasattr(value, "low") and hasattr(value, "high"):
        return arb(value.low).union(arb(value.high))
    if hasattr(value, "ball"):
        with ball.precision(bits):
            return value.ball(bits)
    if isinstance(value, int | float):
        return arb(value)
    if hasattr(value, "free_symbols"):
        return Quantity.of(str(value)).ball(bits)
    return arb(float(value))


def ends(value: arb) -> tuple[float, float]:
    """Doubles at or below, and at or above, every number in a ball."""
    return ball.double_bounds(value)
