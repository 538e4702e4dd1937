"""A scene with every number rounded to the nearest one of an engine's own: what it is really given."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction

from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ...scenarios.things import Circle, Wall
from ..alignment.instants import DOUBLE_BITS

SINGLE_BITS, PAIR_BITS = 24, 106
"""Of a single, and of a pair of doubles: formats of which more is known than how many bits they have."""

LEAST_SINGLE = -149
"""log2 of the least single above zero."""

DIGITS = 1
"""Decimals that are looked at for each bit: three times as many as it is worth."""


def nearest(value: Quantity, bits: int = DOUBLE_BITS) -> Quantity:
    """The nearest number of so many bits, ties to even.

    Of 53 bits are doubles, of 24 singles, with the exponents that they have. Of 106 is a pair of doubles: the nearest
    one, and the one nearest to what it leaves.

    Raises:
        SceneError: beyond the doubles.

    >>> nearest(Quantity.of("1/3"), 2).text(), nearest(Quantity.of("3/8 - 1/10**40"), 1).text()
    ('3/8', '1/4')
    """
    double = _double(value)
    if bits == DOUBLE_BITS:
        return Quantity.of(Fraction(double))
    if bits == PAIR_BITS:
        high = Quantity.of(Fraction(double))
        return high + Quantity.of(Fraction(_double(value - high)))
    exponent = math.frexp(double)[1] - bits
    spacing = Fraction(2) ** (max(exponent, LEAST_SINGLE) if bits == SINGLE_BITS else exponent)
    scaled = value / Quantity.of(spacing)
    below = math.floor(Fraction(scaled.digits(DIGITS * bits)))
    side = (scaled - Quantity.of(below + Fraction(1, 2))).sign()
    return Quantity.of((below + (below % 2 if side == 0 else side > 0)) * spacing)


def rounded(scene: Scene, bits: int = DOUBLE_BITS) -> Scene:
    """The scene with every coordinate, radius, velocity and mass replaced by the nearest number of so many bits.

    Raises:
        SceneError: if the rounded circles overlap, or a number is beyond the doubles.

    >>> scene = Scene([Circle("1/3", 0)])
    >>> rounded(scene).circles[0].x == scene.circles[0].x, rounded(rounded(scene)) == rounded(scene)
    (False, True)
    """
    return _with_numbers(scene, lambda value: nearest(value, bits))


def shifted(scene: Scene, share: Quantity, bits: int = DOUBLE_BITS) -> Scene:
    """The scene with every number a share of the way to the nearest one of so many bits.

    Raises:
        SceneError: as `rounded`.

    >>> scene = Scene([Circle("1/3", 0)])
    >>> shifted(scene, Quantity.of(1)).circles == rounded(scene).circles
    True
    """
    return _with_numbers(scene, lambda value: value + (nearest(value, bits) - value) * share)


def wall_numbers(wall: Wall, bits: int) -> tuple[Quantity, Quantity, Quantity, Quantity]:
    """x0, y0, x1, y1 of a wall, rounded.

    >>> [value.text() for value in wall_numbers(Wall(0, "1/3", 1, "1/3"), 2)]
    ['0', '3/8', '1', '3/8']
    """
    return tuple(nearest(value, bits) for value in (wall.x0, wall.y0, wall.x1, wall.y1))  # pyright: ignore[reportReturnType]


def _with_numbers(scene: Scene, changed: Callable[[Quantity], Quantity]) -> Scene:
    """The scene with every coordinate, radius, velocity and mass changed in one way."""
    circles = [
        Circle(
            *map(changed, (c.x, c.y, c.r, c.vx, c.vy)),
            m=c.m if isinstance(c.m, str) else changed(c.m),
            id=c.id,
            point=c.point,
        )
        for c in scene.circles
    ]
    walls = [Wall(*map(changed, (w.x0, w.y0, w.x1, w.y1)), id=w.id) for w in scene.walls]
    return scene.with_changes(circles=circles, walls=walls)


def _double(value: Quantity) -> float:
    try:
        return float(value)
    except OverflowError:
        raise SceneError(f"{value.text()[:40]}: is beyond the doubles") from None
