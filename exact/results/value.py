"""Numbers of an exact run that know their exact value: to any digits, as SymPy, as text."""

from __future__ import annotations

import copyreg
from collections.abc import Sequence
from typing import Any

from flint import arb, fmpq

from ...scenarios.lazy.kept import kept
from ...scenarios.numbers.doubles import BITS_PER_DIGIT, bounds_of, certain_double, nearest_double
from ...scenarios.numbers.tower.element import Element
from ...scenarios.numbers.tower.tower import Tower
from ..numbers import ball
from ..numbers.field import Known
from .ball_parts import reduced
from .run_log import Formula, RunLog

copyreg.pickle(arb, reduced)

GUARD_BITS = 32
"""Bits asked for beyond the digits wanted."""

LEAST_BITS = 320
"""Bits computed at the least: most numbers asked for one after another then come of one replay."""


class ExactValue:
    """A real number of an exact run.

    float() gives the nearest double, certified; `digits`, `sympy` and `text` give the value itself.

    Attributes:
        log: the run that it belongs to.
        upto: how many steps of the log it needs.
        bodies: the circles that it depends on.
        formula: computes it from the state after those steps, in any state.
        near: a short enclosure, or the exact number where it is at hand.
        instant: for the time of something that happened in the run, the number of its instant.
    """

    def __init__(
        self,
        log: RunLog,
        upto: int,
        bodies: Sequence[int],
        formula: Formula,
        near: Known,
        instant: int | None = None,
    ) -> None:
        self.log = log
        self.upto = upto
        self.bodies = tuple(bodies)
        self.formula = formula
        self.near = near
        self.instant = instant

    def __repr__(self) -> str:
        return f"ExactValue({self.digits(17)})"

    def ball(self, bits: int) -> arb:
        """An enclosure accurate to about `bits` bits, relatively (absolutely, for a value that may be zero)."""
        if isinstance(self.near, fmpq):
            with ball.precision(bits + GUARD_BITS):
                return arb(self.near)
        if isinstance(self.near, Element):
            return self.near.ball(bits)
        if self.near.rel_accuracy_bits() >= bits:
            return self.near
        working = self.log.lost + max(bits + GUARD_BITS, LEAST_BITS)
        with ball.precision(working):
            while True:
                state = self.log.in_balls(working, self.upto)
                ball.use_bits(working)
                value = self.formula(state)
                if value.rel_accuracy_bits() >= bits or value.is_zero():
                    return value
                if value.contains(0) and value.abs_upper() < arb(2) ** -(bits + LOWEST_DOUBLE):
                    return value
                working *= 2

    def __float__(self) -> float:
        return self._double

    @kept
    def _double(self) -> float:
        if isinstance(self.near, fmpq):
            return nearest_double(self.near)
        double = certain_double(self.near) if isinstance(self.near, arb) else None
        bits = 64
        while double is None:
            bits *= 2
            double = certain_double(self.ball(bits))
            if double is None and bits >= HALF_WAY_BITS:
                exact = self.exact()
                fraction = None if exact is None else exact.fraction()
                if fraction is not None:
                    return nearest_double(fraction)
        return double

    def bounds(self) -> tuple[float, float]:
        """Doubles at or below, and at or above, the value."""
        return bounds_of(self.ball(DOUBLE_BITS))

    def digits(self, count: int) -> str:
        """The value in decimals, all of them right (the last may be off by one).

        >>> from truebreak.exact import ExactEngine
        >>> from truebreak.scenarios import Circle, Scene
        >>> scene = Scene([Circle(0, 0, vx=1), Circle(4, 1)])
        >>> ExactEngine().run(scene).events[0].time.digits(30)
        '2.26794919243112270647255365849'
        """
        if isinstance(self.near, fmpq) and self.near.q == 1 and len(str(self.near.p)) <= count:
            return str(self.near.p)
        value = self.ball(int(count * BITS_PER_DIGIT) + GUARD_BITS)
        with ball.precision(int(count * BITS_PER_DIGIT) + 2 * GUARD_BITS):
            return value.str(count, radius=False)

    def exact(self) -> Element | None:
        """The value in nested square roots in normal form, or None if it is too deep for that."""
        if isinstance(self.near, Element):
            return self.near
        if isinstance(self.near, fmpq):
            return Tower().rational(self.near)
        return self.log.exact(self.upto, self.bodies, self.formula)

    def sympy(self) -> Any:
        """The value as a SymPy expression.

        In normal form where it needs few nested roots; else the expression that the run computes, unsimplified,
        its subexpressions shared in memory (do not print it: see `text`).
        """
        exact = self.exact()
        if exact is not None:
            return exact.sympy()
        return self.formula(self.log.in_expressions(self.upto, self.bodies)).expression

    def text(self) -> str | None:
        """The value in the grammar of scene files, or None if it is too deep to be written out.

        >>> from truebreak.exact import ExactEngine
        >>> from truebreak.scenarios import Circle, Scene
        >>> scene = Scene([Circle(0, 0, vx=1), Circle(4, 1)])
        >>> ExactEngine().run(scene).events[0].time.text()
        '-sqrt(3) + 4'
        """
        if isinstance(self.near, fmpq):
            return str(self.near)
        exact = self.exact()
        return None if exact is None else exact.text()


DOUBLE_BITS = 64
"""Accuracy at which a value is held between doubles."""

HALF_WAY_BITS = 512
"""A value that still straddles two doubles at this accuracy is asked whether it is a rational half-way point."""

LOWEST_DOUBLE = 1100
"""Bits below which an unsigned value rounds to the double zero whatever its sign."""
