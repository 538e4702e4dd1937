"""Numbers of an exact run that know their exact value: to any digits, as SymPy, as text."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

from flint import arb, ctx, fmpq  # type: ignore[attr-defined]

from ..scenarios.numbers.doubles import BITS_PER_DIGIT, bounds_of, certain_double, nearest_double
from ..scenarios.numbers.tower import Element, Tower, TowerLimit
from ..scenarios.scene import Scene
from ..scenarios.work import Work
from .ball_machine import BallMachine
from .machine import Machine, Number, Step
from .numbers import ball
from .program import causal_past, replay

TEXT_DEPTH = 5
"""Nested roots up to which a value is written out in full; beyond, it is given by shared definitions."""

TEXT_WORK = 1_000_000
"""Units of work that writing out one value may take: about a second."""

GUARD_BITS = 32
"""Bits asked for beyond the digits wanted."""

Formula = Callable[[Machine], Number]


class Program:
    """A scene and the log of its run: enough to compute every number of the run again.

    Attributes:
        scene: the scene.
        steps: the log.
        bits: a precision that sufficed for the run.
    """

    def __init__(self, scene: Scene, steps: Sequence[Step], bits: int) -> None:
        self.scene = scene
        self.steps = steps
        self.bits = bits
        self._key: tuple[int, int] | None = None
        self._machine: Machine | None = None
        self._too_deep: list[frozenset[int]] = []

    def in_balls(self, bits: int, upto: int) -> Machine:
        """The state after the first `upto` steps, in balls computed with `bits` bits."""
        if self._key != (bits, upto):
            ctx.prec = bits
            machine = BallMachine(self.scene)
            replay(machine, self.steps, range(upto))
            self._key, self._machine = (bits, upto), machine
        assert self._machine is not None
        return self._machine

    def exact(self, upto: int, bodies: Sequence[int], formula: Formula) -> Element | None:
        """A number after the first `upto` steps in nested roots, or None if it is too deep.

        A value whose causal past contains one that was too deep is not tried.
        """
        steps = self.steps[:upto]
        needed, held = causal_past(steps, bodies, len(self.scene.circles))
        past = frozenset(needed)
        if any(deep <= past for deep in self._too_deep):
            return None
        tower = Tower(max_depth=TEXT_DEPTH, work=Work(TEXT_WORK))
        try:
            machine = Machine(self.scene, lambda q: q.in_tower(tower), tower.sqrt, only=held)
            replay(machine, steps, needed)
            return formula(machine)
        except TowerLimit:
            self._too_deep.append(past)
            return None


class ExactValue:
    """A real number of an exact run.

    float() gives the nearest double, certified; `digits`, `sympy` and `text` give the value itself.

    Attributes:
        program: the run that it belongs to.
        upto: how many steps of the log it needs.
        bodies: the circles that it depends on.
        formula: computes it from the state after those steps, in any machine.
        near: a short enclosure, or the exact number where it is at hand.
        instant: for the time of something that happened in the run, the number of its instant.
    """

    def __init__(
        self,
        program: Program,
        upto: int,
        bodies: Sequence[int],
        formula: Formula,
        near: Number,
        instant: int | None = None,
    ) -> None:
        self.program = program
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
        saved = ctx.prec
        try:
            working = max(self.program.bits, bits + GUARD_BITS)
            while True:
                machine = self.program.in_balls(working, self.upto)
                ctx.prec = working
                value = self.formula(machine)
                if value.rel_accuracy_bits() >= bits or value.is_zero():
                    return value
                if value.contains(0) and value.abs_upper() < arb(2) ** -(bits + LOWEST_DOUBLE):
                    return value
                working *= 2
        finally:
            ctx.prec = saved

    def __float__(self) -> float:
        return self._double

    @cached_property
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
        return self.program.exact(self.upto, self.bodies, self.formula)

    def sympy(self) -> Any:
        """The value as a SymPy expression.

        In normal form where it needs few nested roots; else the expression that the run computes, unsimplified,
        its subexpressions shared in memory (do not print it: see `text`).
        """
        exact = self.exact()
        if exact is not None:
            return exact.sympy()
        from .export import sympy_machine

        machine = sympy_machine(self.program, self.upto, self.bodies)
        return self.formula(machine).expression

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
