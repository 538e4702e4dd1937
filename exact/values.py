"""Numbers and times of an exact run, which know their exact value."""

from __future__ import annotations

import copyreg
from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

from flint import arb, fmpq

from ..scenarios.lazy import frozen, kept
from ..scenarios.numbers.nested_roots import Tower
from ..scenarios.numbers.precision import (
    BITS_PER_DIGIT,
    MOST_BITS,
    MOST_DIGITS,
    asked,
    bounds_of,
    certain_double,
    decimals_of,
    even_double,
    nearest_double,
)
from ..scenarios.numbers.quantity import Quantity
from ..scenarios.numbers.tower_element import Element
from .numbers import ball
from .numbers.ball import Known, reduced
from .numbers.system import N, Undecided
from .replay.contact import Link
from .replay.state import Constant, ReplayState
from .simulation.decider import Formula, Mark, RunLog
from .simulation.endings import Accumulating

# -- Numbers of an exact run that know their exact value: to any digits, as SymPy, as text.

copyreg.pickle(arb, reduced)

LEAST_BITS = 320
"""Bits computed at the least: most numbers asked for one after another then come of one replay."""


class ExactValue:
    """A real number of an exact run.

    float() gives the nearest double, certified; of a number so near half-way between two that counted work does not
    tell where it lies, the even one. `digits`, `sympy` and `text` give the value itself.

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
            SceneError: for bits that are no whole number from 1 to `MOST_BITS`.
            Undecided: where counted work does not suffice for that.
        """
        bits = asked("ball", bits, MOST_BITS)
        if isinstance(self.near, fmpq):
            with ball.precision(bits + ball.GUARD_BITS):
                return arb(self.near)
        if isinstance(self.near, Element):
            return self.near.ball(bits)
        if self.near.rel_accuracy_bits() >= bits:
            return self.near
        return self._sharpened(bits, lambda value: ball.is_accurate(value, bits) or ball.is_faint(value, bits))

    def _sharpened(self, bits: int, enough: Callable[[arb], bool]) -> arb:
        """The enclosure of a replay with so many bits, or with twice as many, and so on, until it is enough.

        Raises:
            Undecided: once that has cost all the work that it may.
        """
        log, upto = self.log, self.upto
        working = log.lost + max(bits + ball.GUARD_BITS, LEAST_BITS)
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
                        f"a number of the run, {value.str(20)}, is neither separated from zero, or from half-way "
                        f"between decimals, with {working // 2} bits of counted work, nor proved to be it; ask for "
                        "its `ball`"
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
                2 * DOUBLE_BITS, lambda it: certain_double(it) is not None or ball.is_accurate(it, HALF_WAY_BITS)
            )
            if (double := certain_double(value)) is None:
                exact = self.exact()
                fraction = None if exact is None else exact.fraction()
                if fraction is not None:
                    return nearest_double(fraction)
                try:
                    sharp = self._sharpened(2 * HALF_WAY_BITS, lambda it: certain_double(it) is not None)
                    double = certain_double(sharp)
                except Undecided:
                    double = even_double(value)
                assert double is not None
        return double

    def bounds(self) -> tuple[float, float]:
        """Doubles at or below, and at or above, the value."""
        return bounds_of(self.ball(DOUBLE_BITS))

    def digits(self, count: int) -> str:
        """The value in decimals, all of them right (the last may be off by one): the same from any run of the scene.

        "0" is told of what is proved to be zero alone.

        Raises:
            SceneError: for a count that is no whole number from 1 to `MOST_DIGITS`.
            Undecided: where a number beyond all bits that counted work allows for is not proved to be zero.

        >>> from truebreak.exact import ExactEngine
        >>> from truebreak.scenarios import Circle, Scene
        >>> scene = Scene([Circle(0, 0, vx=1), Circle(4, 1)])
        >>> ExactEngine().run(scene).events[0].time.digits(30)
        '2.26794919243112270647255365849'
        """
        count, near = asked("digits", count, MOST_DIGITS), self.near
        if isinstance(near, fmpq):
            return ball.fraction_in_decimals(near, count)
        if isinstance(near, Element):
            return ball.element_in_decimals(near, count)
        bits = int(count * BITS_PER_DIGIT) + 2 * ball.GUARD_BITS
        told = decimals_of(near, count)
        if told is None:
            told = decimals_of(
                self._sharpened(
                    bits,
                    lambda value: (
                        decimals_of(value, count) is not None
                        or ball.is_faint(value, bits)
                        or ball.is_accurate(value, 2 * bits)
                    ),
                ),
                count,
            )
        if told is None:
            exact = self.exact()
            if exact is not None:
                return ball.element_in_decimals(exact, count)
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

        Once a circle has fallen onto something round, its `definition`.

        >>> from truebreak.exact import ExactEngine
        >>> from truebreak.scenarios import Circle, Scene
        >>> scene = Scene([Circle(0, 0, vx=1), Circle(4, 1)])
        >>> ExactEngine().run(scene).events[0].time.text()
        '-sqrt(3) + 4'
        """
        from .texts import definition

        return self.normal_form() or definition(self.log, self.upto, self.bodies, self.formula)

    def normal_form(self) -> str | None:
        """As `text`, but None of what has a `definition` only."""
        exact = self.near if isinstance(self.near, fmpq) else self.exact()
        return None if exact is None else ball.field_text(exact)


DOUBLE_BITS = 64
"""Accuracy at which a value is held between doubles."""

HALF_WAY_BITS = 512
"""A value that still straddles two doubles at this accuracy is asked whether it is a rational half-way point."""

READ_BITS = 192
"""Precision at which stored states (short balls) are carried on to a time asked for."""

VALUE_WORK = 3_000_000
"""Units of work that one number may cost: a few seconds."""

MORE_WORK = 40
"""Besides, so many times the work of its first replay: enough for five times twice the bits."""


# -- The times of a run, each with the formula that computes it again from the log.

RETURN = "return"
"""The source of the time at which a reversed run is back: twice that of the reversal."""

START = "start"
"""The source of time 0, where nothing happened after it."""

Source: TypeAlias = int | Link | str
"""The circle whose clock stands at a time; or the meeting that comes at it; or `REVERSAL`, RETURN, START."""


@frozen
class OtherRun:
    """A place at a time of another run, which this run's log does not compute: what is at hand of it is told alone."""

    def __call__(self, state: ReplayState[N]) -> N:
        raise ValueError("the time is one of another run; ask for the place at its digits, such as at(time.digits(40))")


@frozen
class TimeFormula:
    """Computes a time from the state at the end of its instant."""

    source: Source

    @property
    def bodies(self) -> tuple[int, ...]:
        """The circles that it depends on."""
        if isinstance(self.source, str):
            return (0,)
        return (self.source,) if isinstance(self.source, int) else self.source.circles[:1]

    def __call__(self, state: ReplayState[N]) -> N:
        source = self.source
        if isinstance(source, int):
            return state.bodies[source].flight.instant
        if not isinstance(source, str):
            clock, wait = source.hit(state)
            return clock + wait
        if source == START:
            return state.zero
        return state.flip_time + state.flip_time if source == RETURN else state.flip_time


def time_of(log: RunLog, mark: Mark[Known]) -> ExactValue:
    """The time of an instant, which knows its exact value."""
    formula = TimeFormula(mark.source)
    return ExactValue(log, mark.step, formula.bodies, formula, mark.time, instant=mark.number)


def time_of_return(log: RunLog, reversal: Mark[Known], instant: int) -> ExactValue:
    """Twice the time of the reversal; `instant` is the last at which anything happens."""
    return time_of(log, Mark(instant, reversal.time * 2, reversal.step, RETURN))


def ending_of(log: RunLog, last: int | None, bounces: Accumulating | Constant | None) -> ExactValue | None:
    """When the bounces that ended a run have all happened, or a circle was crushed; None where neither did.

    Args:
        last: how many steps of the log lead through the last of the bounces that are in it.
    """
    if bounces is None:
        return None
    if isinstance(bounces, Constant):
        return known_number(log, bounces.value)
    assert last is not None
    return ExactValue(log, last, bounces.circles, bounces, arb.nan())


def known_number(log: RunLog, value: Quantity) -> ExactValue:
    """A number that the scene gives."""
    near = value.rational if value.rational is not None else value.ball(READ_BITS)
    return ExactValue(log, 0, (), Constant(value), near)
