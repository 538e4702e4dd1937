"""Numbers of an exact run that know their exact value: to any digits, as SymPy, as text."""

from __future__ import annotations

import copyreg
from collections.abc import Callable, Sequence
from typing import Any

from flint import arb, fmpq

from ...scenarios.lazy import kept
from ...scenarios.numbers.nested_roots import Tower
from ...scenarios.numbers.precision import BITS_PER_DIGIT, bounds_of, certain_double, decimals_of, nearest_double
from ...scenarios.numbers.tower_element import Element
from ..numbers import ball
from ..numbers.field import Known
from ..numbers.undecided import Undecided
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
        try:
            return f"ExactValue({self.digits(17)})"
        except Undecided:
            return f"ExactValue({self.ball(DOUBLE_BITS).str(3)})"

    def ball(self, bits: int) -> arb:
        """An enclosure accurate to about `bits` bits, relatively (absolutely, for a value that may be zero).

        Raises:
            Undecided: where counted work does not suffice for that.
        """
        if isinstance(self.near, fmpq):
            with ball.precision(bits + GUARD_BITS):
                return arb(self.near)
        if isinstance(self.near, Element):
            return self.near.ball(bits)
        if self.near.rel_accuracy_bits() >= bits:
            return self.near
        return self._sharpened(bits, lambda value: _is_accurate(value, bits) or _is_faint(value, bits))

    def _sharpened(self, bits: int, enough: Callable[[arb], bool]) -> arb:
        """The enclosure of a replay with so many bits, or with twice as many, and so on, until it is enough.

        Raises:
            Undecided: once that has cost all the work that it may.
        """
        log, upto = self.log, self.upto
        working = log.lost + max(bits + GUARD_BITS, LEAST_BITS)
        allowed = VALUE_WORK + MORE_WORK * log.units(working, upto)
        with ball.precision(working):
            while True:
                state = log.in_balls(working, upto)
                ball.use_bits(working)
                value = self.formula(state)
                if enough(value):
                    return value
                working *= 2
                allowed -= log.units(working, upto)
                if allowed < 0:
                    raise Undecided(
                        f"a number of the run, {value.str(3)}, is not told any nearer with {working // 2} bits of work "
                        "that is counted, nor proved to be zero; ask for its `ball`, which is what is known of it"
                    )

    def __float__(self) -> float:
        return self._double

    @kept
    def _double(self) -> float:
        if isinstance(self.near, fmpq):
            return nearest_double(self.near)
        double = certain_double(self.near) if isinstance(self.near, arb) else None
        if double is None and isinstance(self.near, Element):
            fraction, bits = self.near.fraction(), DOUBLE_BITS
            if fraction is not None:
                return nearest_double(fraction)
            while double is None:  # it is irrational, so that it lies half-way between no doubles
                bits *= 2
                double = certain_double(self.near.ball(bits))
        if double is None:
            value = self._sharpened(
                2 * DOUBLE_BITS, lambda value: _is_double(value) or _is_accurate(value, HALF_WAY_BITS)
            )
            double = certain_double(value)
        if double is None:
            exact = self.exact()
            fraction = None if exact is None else exact.fraction()
            if fraction is not None:
                return nearest_double(fraction)
            double = certain_double(self._sharpened(2 * HALF_WAY_BITS, _is_double))
            assert double is not None
        return double

    def bounds(self) -> tuple[float, float]:
        """Doubles at or below, and at or above, the value."""
        return bounds_of(self.ball(DOUBLE_BITS))

    def digits(self, count: int) -> str:
        """The value in decimals, all of them right (the last may be off by one): the same from any run of the scene.

        "0" is told of what is proved to be zero alone.

        Raises:
            Undecided: where a number beyond all bits that counted work allows for is not proved to be zero.

        >>> from truebreak.exact import ExactEngine
        >>> from truebreak.scenarios import Circle, Scene
        >>> scene = Scene([Circle(0, 0, vx=1), Circle(4, 1)])
        >>> ExactEngine().run(scene).events[0].time.digits(30)
        '2.26794919243112270647255365849'
        """
        near = self.near
        if isinstance(near, fmpq):
            return _fraction_in_decimals(near, count)
        if isinstance(near, Element):
            return _element_in_decimals(near, count)
        bits = int(count * BITS_PER_DIGIT) + 2 * GUARD_BITS
        told = decimals_of(near, count)
        if told is None:
            told = decimals_of(
                self._sharpened(
                    bits,
                    lambda value: (
                        decimals_of(value, count) is not None or _is_faint(value, bits) or _is_accurate(value, 2 * bits)
                    ),
                ),
                count,
            )
        if told is None:
            exact = self.exact()
            if exact is not None:
                return _element_in_decimals(exact, count)
            told = decimals_of(self._sharpened(2 * bits, lambda value: decimals_of(value, count) is not None), count)
            assert told is not None
        return told

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

VALUE_WORK = 3_000_000
"""Units of work that one number may cost: a few seconds."""

MORE_WORK = 40
"""Besides, so many times the work of its first replay: enough for five times twice the bits."""

LOWEST_DOUBLE = 1100
"""Bits below which an unsigned value rounds to the double zero whatever its sign."""


def _is_accurate(value: arb, bits: int) -> bool:
    """Whether so many bits of a number are told; of zero all are."""
    return value.rel_accuracy_bits() >= bits or value.is_zero()


def _is_faint(value: arb, bits: int) -> bool:
    """Whether a number may be zero, and is told to so many bits beyond those of all doubles."""
    return value.contains(0) and bool(value.abs_upper() < arb(2) ** -(bits + LOWEST_DOUBLE))


def _is_double(value: arb) -> bool:
    """Whether the nearest double is told."""
    return certain_double(value) is not None


def _element_in_decimals(value: Element, count: int) -> str:
    """A number in nested roots in decimals."""
    fraction, bits = value.fraction(), int(count * BITS_PER_DIGIT) + GUARD_BITS
    if fraction is not None:
        return _fraction_in_decimals(fraction, count)
    while (told := decimals_of(value.ball(bits), count)) is None:  # it is irrational, so no rounding is a tie
        bits *= 2
    return told


def _fraction_in_decimals(value: fmpq, count: int) -> str:
    """A fraction in decimals; half a unit of the last is rounded away from zero."""
    if value.q == 1 and len(str(value.p)) <= count:
        return str(value.p)
    with ball.precision(int(count * BITS_PER_DIGIT) + 2 * GUARD_BITS + value.height_bits()):
        near = arb(value)
        told = decimals_of(near, count)
        return told or (near.upper() if value > 0 else near.lower()).str(count, radius=False)
