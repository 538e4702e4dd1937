"""Nested square roots in normal form, within a depth and counted work."""

from __future__ import annotations

from ...scenarios.numbers.nested_roots import Tower
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.numbers.tower_element import Element
from ...scenarios.work import Work
from . import ball
from .field import BOUND_BITS


class Nested:
    """The numbers of one tower.

    Args:
        max_depth: nested levels that it may have.
        work: what it may cost; both raise `TowerLimit` beyond.
    """

    def __init__(self, max_depth: int, work: Work) -> None:
        self.tower = Tower(max_depth=max_depth, work=work)

    def constant(self, q: Quantity) -> Element:
        """See `Arithmetic.constant`."""
        return q.in_tower(self.tower)

    def root(self, value: Element) -> Element:
        """See `Arithmetic.root`."""
        return self.tower.sqrt(value)

    def sign(self, value: Element) -> int:
        """Always decided."""
        return value.sign()

    def bounds(self, value: Element) -> tuple[float, float]:
        """See `NumberSystem.bounds`."""
        return ball.double_bounds(value.ball(BOUND_BITS))
