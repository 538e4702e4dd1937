"""Numbers that are formulas: what a function of the code makes of them is the formula that it holds.

Each is a rational function of symbols, and of square roots. It takes part in the code's own arithmetic, in the place of
a double or a ball, and two of them are equal where they are so identically. Each symbol has a value besides, by which
comparisons choose their branch: what is proved then holds for all numbers that take that branch.
"""

from __future__ import annotations

import math
import operator
from fractions import Fraction
from itertools import chain, combinations
from types import SimpleNamespace

import numpy as np
from sympy import QQ
from sympy.polys.fields import field

from truebreak.exact.numbers import ball

FRESH, ROOTS = 8, 4


class World:
    """Some symbols, with their values.

    Args:
        values: of the symbols, by name.

    Attributes:
        zero, one: the numbers.
    """

    def __init__(self, **values: float) -> None:
        names = [*values, *(f"middle_{k}" for k in range(FRESH)), *(f"root_{k}" for k in range(ROOTS))]
        self.field, *generators = field(names, QQ)
        self._generators = dict(zip(names, generators, strict=True))
        self._near = [1.0] * len(names)
        self._roots: list[tuple[Formula, Formula]] = []
        self._middles: list[tuple[Formula, Formula]] = []
        for name, value in values.items():
            setattr(self, name, self._new(name, value))
        self.zero, self.one = self.number(0), self.number(1)

    def number(self, value: float | Fraction) -> Formula:
        exact = Fraction(value)
        return Formula(self, self.field(QQ(exact.numerator, exact.denominator)), float(value))

    # -- a system of numbers, as `exact/numbers/system.py` has it

    def constant(self, q) -> Formula:
        assert q.rational is not None
        return self.number(Fraction(int(q.rational.p), int(q.rational.q)))

    def root(self, value: Formula) -> Formula:
        """The square root: a new symbol, but where the number is a square, or one times numbers that have roots."""
        assert value.near > 0
        value = Formula(self, self._reduced(value.told.numer) / self._reduced(value.told.denom), value.near)
        for some in chain.from_iterable(combinations(self._roots, size) for size in range(len(self._roots) + 1)):
            factor = self._rooted(math.prod((square for square, _ in some), start=self.one) ** -1 * value)
            if factor is not None:
                return abs(math.prod((root for _, root in some), start=factor))
        made = self._new(f"root_{len(self._roots)}", math.sqrt(value.near))
        self._roots.append((value, made))
        return made

    def _rooted(self, value: Formula) -> Formula | None:
        """A root of what is the square of a rational function."""
        result = self.field.one
        for part, power in ((value.told.numer, 1), (value.told.denom, -1)):
            factor, factors = part.sqf_list()
            top, bottom = math.isqrt(abs(int(factor.numerator))), math.isqrt(int(factor.denominator))
            if QQ(top**2, bottom**2) != factor or any(times % 2 for _, times in factors):
                return None
            result *= self.field(QQ(top, bottom)) ** power
            for base, times in factors:
                result *= self.field(base) ** (power * times // 2)
        return Formula(self, result, self._value(result.numer) / self._value(result.denom))

    def _value(self, polynomial) -> float:
        """What the symbols' values make of it."""
        return sum(
            float(factor) * math.prod(near**power for near, power in zip(self._near, powers, strict=True))
            for powers, factor in polynomial.terms()
        )

    def _new(self, name: str, near: float) -> Formula:
        generator = self._generators[name]
        self._near[next(k for k, power in enumerate(generator.numer.leading_expv()) if power)] = near
        return Formula(self, generator, near)

    def middle(self, value: Formula) -> Formula:
        """Some number beside another: a symbol of its own, so that nothing rests on how near it is."""
        for whole, middle in self._middles:
            if whole == value:
                return middle
        made = self._new(f"middle_{len(self._middles)}", value.near + 1 / 64)
        self._middles.append((value, made))
        return made

    def is_zero(self, told) -> bool:
        """Whether a rational function is zero."""
        return not self._reduced(told.numer)

    def _reduced(self, polynomial):
        """A polynomial in which each even power of a root is one of its square."""
        told = self.field(polynomial)
        for square, root in reversed(self._roots):
            index = next(k for k, power in enumerate(root.told.numer.leading_expv()) if power)
            even = odd = self.field.zero
            for powers, factor in told.numer.terms():
                rest = tuple(0 if k == index else power for k, power in enumerate(powers))
                term = self.field(self.field.ring({rest: factor})) * square.told ** (powers[index] // 2)
                even, odd = (even, odd + term) if powers[index] % 2 else (even + term, odd)
            told = (even + odd * root.told) / self.field(told.denom)
        return told


def _operator(act):
    """What numbers and their values undergo alike; an array sees to its own members."""

    def apply(self, other):
        if isinstance(other, np.ndarray):
            return NotImplemented
        other = self._of(other)
        return Formula(self.world, act(self.told, other.told), act(self.near, other.near))

    return apply


class Formula:
    """A number of a world."""

    def __init__(self, world: World, told, near: float) -> None:
        self.world, self.told, self.near = world, told, near

    def _of(self, other) -> Formula:
        return other if isinstance(other, Formula) else self.world.number(other)

    __add__, __radd__ = _operator(operator.add), _operator(lambda a, b: b + a)
    __sub__, __rsub__ = _operator(operator.sub), _operator(lambda a, b: b - a)
    __mul__, __rmul__ = _operator(operator.mul), _operator(lambda a, b: b * a)
    __truediv__, __rtruediv__ = _operator(operator.truediv), _operator(lambda a, b: b / a)

    def __neg__(self):
        return Formula(self.world, -self.told, -self.near)

    def __abs__(self):
        return -self if self.near < 0 else self

    def __pow__(self, power: int):
        return Formula(self.world, self.told**power, self.near**power)

    def __eq__(self, other) -> bool:
        return self.world.is_zero((self - other).told)

    __hash__ = None

    # -- by value: these choose the branch

    def __float__(self) -> float:
        return self.near

    def __bool__(self) -> bool:
        return not self.is_zero()

    def __lt__(self, other) -> bool:
        return self.near < float(other)

    def __le__(self, other) -> bool:
        return self.near <= float(other)

    def __gt__(self, other) -> bool:
        return self.near > float(other)

    def __ge__(self, other) -> bool:
        return self.near >= float(other)

    # -- what balls have

    def is_zero(self) -> bool:
        return self.world.is_zero(self.told)

    def is_exact(self) -> bool:
        return True

    def is_finite(self) -> bool:
        return True

    def rel_accuracy_bits(self) -> int:
        return 200

    def abs_upper(self) -> Formula:
        return abs(self)

    def sqrt(self) -> Formula:
        return self.world.root(self)

    def mid(self) -> Formula:
        return self.world.middle(self)

    def intersection(self, other: Formula) -> Formula:
        """Two enclosures of one number: it must be one."""
        assert self == other
        return self

    def __repr__(self) -> str:
        return f"{self.told} ({self.near:g})"


def root_of(value):
    """In the place of `math.sqrt`."""
    return value.sqrt() if isinstance(value, Formula) else math.sqrt(value)


def balls_are(world: World, monkeypatch) -> None:
    """Has what is written for balls run on the numbers of a world."""
    monkeypatch.setattr(ball, "BALLS", world)
    monkeypatch.setattr(ball, "use_bits", lambda bits: None)


def stub(**parts) -> SimpleNamespace:
    return SimpleNamespace(**parts)
