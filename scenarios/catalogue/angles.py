"""Exact cosines and sines of the angles that need square roots only."""

from __future__ import annotations

from functools import cache

from ..numbers.quantity import Quantity

COSINES = {
    0: "1",
    30: "(sqrt(6) + sqrt(2))/4",
    36: "sqrt(10 + 2*sqrt(5))/4",
    45: "sqrt(2 + sqrt(2))/2",
    60: "sqrt(3)/2",
    72: "(sqrt(5) + 1)/4",
    90: "sqrt(2)/2",
    108: "sqrt(10 - 2*sqrt(5))/4",
    120: "1/2",
    135: "sqrt(2 - sqrt(2))/2",
    144: "(sqrt(5) - 1)/4",
    150: "(sqrt(6) - sqrt(2))/4",
    180: "0",
}
"""Cosines by angle in half degrees. Euclid knew the pentagon's; the others halve 60 and 90 degrees."""


@cache
def cosine(half_degrees: int) -> Quantity:
    """The cosine of an angle, in half degrees: any multiple of 15, 18 or 22.5 degrees.

    >>> cosine(240), cosine(144)
    (Quantity('-1/2'), Quantity('(sqrt(5) - 1)/4'))
    """
    angle = abs((half_degrees + 360) % 720 - 360)
    return Quantity.of(COSINES[angle]) if angle <= 180 else -Quantity.of(COSINES[360 - angle])


def sine(half_degrees: int) -> Quantity:
    """The sine of an angle, in half degrees.

    >>> cosine(36) ** 2 + sine(36) ** 2 == 1
    True
    """
    return cosine(180 - half_degrees)
