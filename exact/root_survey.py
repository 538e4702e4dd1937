"""What can be said of the square roots of a past without computing them: heights, exact ones, dependence."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

from flint import fmpq, fmpz  # type: ignore[attr-defined]

from ..scenarios.quantity import Quantity
from ..scenarios.tower import Element, Tower, TowerLimit
from .numbers.field import FieldNumber
from .numbers.heights import Measured, masks_of
from .numbers.residue import nested_radicands
from .root_past import Past, RootMachine
from .root_sums import norm

MAX_CONSTANT_DEPTH = 4
"""Levels of nested roots that the scene's own numbers may need."""

RATIO_BITS = 24
"""Longest numerator and denominator of the rational factor of a tie."""


class GaveUp(Exception):
    """Residues cannot tell; the message says why."""


@dataclass(frozen=True)
class Tie:
    """A root known from an earlier number: sqrt(D) = factor * |base|, where D = factor**2 * base**2.

    Attributes:
        source: index of an earlier root; "vx" or "vy", a component of the relative velocity; or "1".
        factor: the square root of the rational ratio, in K_0.
        ratio: its square.
        sign: the sign of a velocity; +1 for a root.
    """

    source: int | str
    factor: FieldNumber
    ratio: fmpq
    sign: int = 1


@dataclass
class Root:
    """One square root of the history, in the order of replay.

    Attributes:
        place: the step that takes it, as an index into the causal past; its length for the question itself.
        height: of the radicand.
        speeds: heights of the components of the relative velocity that went with it, if any.
        exact: the root as a number of K_0, if it is one.
        past: the roots that the radicand was computed from, as bits.
        needs: the free roots that it depends on, as bits; known once it has been visited.
        tie: set when it is found to be one.
        examined, certified: whether ties were looked for; whether the radicand is proved not to be a square.
        tries: visits without a non-square.
    """

    place: int
    height: int
    speeds: tuple[int, ...]
    exact: FieldNumber | None
    past: int
    needs: int = 0
    tie: Tie | None = None
    examined: bool = False
    certified: bool = False
    tries: int = 0
    last_modulus: fmpz | None = None
    tries_here: int = 0

    @property
    def free(self) -> bool:
        """Whether its sign is chosen."""
        return self.exact is None and self.tie is None


def needs(roots: Sequence[Root], past: int) -> int:
    """The free roots on whose signs a number depends, as bits, given the roots that it was computed from."""
    found = 0
    for index, root in enumerate(roots[: past.bit_length()]):
        if past >> index & 1 and root.exact is None:
            found |= root.needs
            if root.tie is None:
                found |= 1 << index
            elif isinstance(root.tie.source, int):
                found |= roots[root.tie.source].needs | 1 << root.tie.source
    return found


class Survey:
    """What can be said of a past without a prime: its roots, heights of its numbers, and the field K_0.

    Attributes:
        roots: the square roots, in order.
        weight: sum of the heights of the numbers that a verdict takes for zero, without ties.
        tower: the tower that holds K_0.

    Raises:
        GaveUp: if the scene's own numbers are nested too deeply, or time is up.
    """

    def __init__(self, past: Past, deadline: float) -> None:
        self.past = past
        self.tower = Tower(max_depth=MAX_CONSTANT_DEPTH, deadline=deadline)
        self._constants: dict[str, Measured] = {}
        try:
            while True:
                before = len(self.tower.generators)
                self.roots: list[Root] = []
                self._go()
                if len(self.tower.generators) == before:
                    return
        except TowerLimit as limit:
            raise GaveUp(f"the scene's own numbers: {limit}") from limit

    def _go(self) -> None:
        past = self.past
        self._place = 0
        machine = RootMachine(past.scene, self._constant, self._root, past.bodies)
        for self._place in range(len(past.steps)):
            past.carry_out(machine, self._place)
        self._place = len(past.steps)
        parts = past.root_sum(machine)
        self.weight = sum(part.height for part in (*parts, norm(*parts)))

    def _constant(self, q: Quantity) -> Measured:
        if q.rational is not None:
            return Measured.of(q.rational)
        text = q.text()
        known = self._constants.get(text)
        if known is None:
            known = self._constants[text] = Measured(height_of(q), q.in_tower(self.tower))
        return known

    def constant(self, q: Quantity) -> FieldNumber:
        """A constant of the past as a number of K_0."""
        return q.rational if q.rational is not None else self._constant(q).exact

    def _root(self, index: int, value: Measured, along: tuple[Measured, ...]) -> Measured:
        exact = None if value.exact is None else self.exact_root(value.exact)
        speeds = tuple(speed.height for speed in along)
        self.roots.append(Root(self._place, value.height, speeds, exact, value.roots))
        root = value.root(index)
        return root if exact is None else Measured.of(exact, root.height)

    def exact_root(self, value: FieldNumber) -> FieldNumber | None:
        """The root of a positive number of K_0, which may gain roots of whole numbers; None if it nests."""
        tower = self.tower
        if isinstance(value, fmpq):
            value = tower.rational(value)
        deepest, tower.max_depth = tower.max_depth, max(1, tower.depth)
        try:
            root = tower.sqrt(value)
        except TowerLimit:
            if tower.deadline is not None and time.monotonic() > tower.deadline:
                raise
            return None
        finally:
            tower.max_depth = deepest
        fraction = root.fraction()
        return root if fraction is None else fraction

    def masks(self) -> list[int]:
        """The roots of whole numbers that K_0 is made of, as masks of the tower's base."""
        numbers = [root.exact for root in self.roots]
        numbers += [root.tie.factor for root in self.roots if root.tie is not None]
        numbers += [constant.exact for constant in self._constants.values()]
        numbers += nested_radicands(self.tower)
        masks = {mask for number in numbers if isinstance(number, Element) for mask in masks_of(number)}
        return sorted(masks - {0})

    @property
    def degree(self) -> int:
        """log2 of an upper bound on the degree of K over the rationals."""
        base = min(len(self.masks()), sum(isinstance(g.num, dict) for g in self.tower.generators))
        return base + len(nested_radicands(self.tower)) + sum(root.free for root in self.roots)

    @property
    def tie_weight(self) -> int:
        """Sum of the heights of the numbers that ties take for zero."""
        total = 0
        for root in self.roots:
            if root.tie is not None:
                source = root.tie.source
                speed = max(root.speeds, default=0)
                base = self.roots[source].height if isinstance(source, int) else 2 * speed
                total += root.height + base + 2 * RATIO_BITS + 1
        return total


def height_of(q: Quantity) -> int:
    """A bound on the height of a constant, from the expression that it is."""
    if q.rational is not None:
        return Measured.of(q.rational).height
    heights = [height_of(argument) for argument in q.args]
    if q.op == "sqrt":
        return (heights[0] + 1) // 2
    return sum(heights) + (q.op in "+-")
