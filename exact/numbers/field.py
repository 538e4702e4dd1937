"""The field of a scene: rationals, with the square roots that the scene's own numbers are made of."""

from __future__ import annotations

from typing import TypeAlias

from flint import arb, fmpq

from ...scenarios.numbers.nested_roots import Tower
from ...scenarios.numbers.quantity import Quantity, rational_root
from ...scenarios.numbers.tower_element import Element
from ...scenarios.numbers.tower_ring import TowerLimit
from . import ball

FieldNumber: TypeAlias = fmpq | Element
"""`flint.fmpq` while no root is about, else a tower's `Element`."""

Known: TypeAlias = arb | FieldNumber
"""A number as a certified run keeps it: exact where it is at hand exactly, else a ball."""

MAX_ROOTS = 4
"""Nested levels that a scene's constants may need for its runs to be kept in their field."""

BOUND_BITS = 64
"""Bits to which a number is enclosed for its bounds as doubles."""


class LeavesField(Exception):
    """A square root that is not in the field."""


class Field:
    """Constants and roots within the smallest field that holds a scene's numbers."""

    def __init__(self) -> None:
        self.tower = Tower(max_depth=MAX_ROOTS)

    def constant(self, q: Quantity) -> FieldNumber:
        """An exact number; its roots join the field.

        Raises:
            LeavesField: if the field would grow too deep.
        """
        if q.rational is not None:
            return q.rational
        try:
            element = q.in_tower(self.tower)
        except TowerLimit as limit:
            raise LeavesField from limit
        return _simplest(element)

    def root(self, value: FieldNumber) -> FieldNumber:
        """The square root of a number of the field.

        Raises:
            LeavesField: if it is not in the field, or the number is negative.
        """
        if isinstance(value, fmpq):
            if value < 0:
                raise LeavesField
            root = rational_root(value)
            if root is not None:
                return root
            if self.tower.depth == 0:
                raise LeavesField
            value = self.tower.rational(value)
        if value.sign() < 0:
            raise LeavesField
        within = self.tower.own_root(value)
        if within is None:
            raise LeavesField
        return _simplest(within)

    def leaves(self, value: FieldNumber) -> bool:
        """Whether the square root of a number, which is not negative, is in no field of rationals alone."""
        return isinstance(value, fmpq) and rational_root(value) is None

    def sign(self, value: FieldNumber) -> int:
        """Always decided."""
        return field_sign(value)

    def bounds(self, value: FieldNumber) -> tuple[float, float]:
        """See `NumberSystem.bounds`."""
        with ball.precision(BOUND_BITS):
            return ball.double_bounds(field_ball(value, BOUND_BITS))

    def element(self, value: FieldNumber) -> Element:
        """The number as an element of the tower."""
        return self.tower.rational(value) if isinstance(value, fmpq) else value


def _simplest(element: Element) -> FieldNumber:
    fraction = element.fraction()
    return element if fraction is None else fraction


def field_sign(value: FieldNumber) -> int:
    """-1, 0 or +1."""
    if isinstance(value, fmpq):
        return (value > 0) - (value < 0)
    return value.sign()


def field_ball(value: FieldNumber, bits: int) -> arb:
    """A ball around the number, at flint's working precision, which is `bits`."""
    return arb(value) if isinstance(value, fmpq) else value.ball(bits)


def known_ball(value: Known, bits: int) -> arb:
    """A ball around a number of a certified run, in at least so many bits where it is known exactly."""
    if isinstance(value, arb):
        return value
    with ball.precision(bits):
        return field_ball(value, bits)


def height(value: FieldNumber) -> int:
    """Bits of the longest whole number in it."""
    return value.height_bits()


def field_text(value: FieldNumber) -> str:
    """The number's normal form as text: equal for equal numbers, and for no others, within one field."""
    return str(value) if isinstance(value, fmpq) else value.text()
