"""Exact real numbers for scenes: rationals and square roots, kept as the expression that they are."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, Literal, Protocol, Self, SupportsFloat, TypeAlias, TypeVar, runtime_checkable

from flint import arb, fmpq

from ..errors import SceneError, shortened
from ..lazy import kept
from .parsing import converted
from .precision import (
    BITS_PER_DIGIT,
    MOST_DIGITS,
    Double,
    asked,
    at_bits,
    bounds_of,
    certain_double,
    digits_of,
    nearest_double,
)

if TYPE_CHECKING:
    from fractions import Fraction

    from .tower_element import AnyTower, Element

# -- Roots of rationals that are rational.


def rational_root(q: fmpq) -> fmpq | None:
    """The square root of a non-negative rational if that is rational, else None.

    >>> from flint import fmpq
    >>> rational_root(fmpq(4, 9)), rational_root(fmpq(2))
    (2/3, None)
    """
    p, r = q.p, q.q
    if not p.is_square() or not r.is_square():
        return None
    return fmpq(p.isqrt(), r.isqrt())


# -- Expressions of rationals with + - * / and square roots: their form, written as text and in other number systems.

Op: TypeAlias = Literal["q", "+", "-", "*", "/", "sqrt"]


class ExpressionArithmetic(Protocol):
    """What the evaluation of an expression asks of a number system."""

    def __add__(self: N, other: N, /) -> N: ...
    def __sub__(self: N, other: N, /) -> N: ...
    def __mul__(self: N, other: N, /) -> N: ...
    def __truediv__(self: N, other: N, /) -> N: ...


N = TypeVar("N", bound=ExpressionArithmetic)


class Expression:
    """A rational, or an operation on expressions.

    Attributes:
        op: "q" for a rational.
        args: what the operation acts on.
        rational: its value, if it is a rational.
    """

    __slots__ = ("__dict__", "args", "op", "rational")

    def __init__(self, op: Op, args: tuple[Self, ...], rational: fmpq | None = None) -> None:
        self.op: Op = op
        self.args = args
        self.rational = rational

    @property
    def size(self) -> int:
        """How many numbers it holds."""
        return self._size

    @kept
    def _size(self) -> int:
        return sum(argument.size for argument in self.args) if self.args else 1

    @kept
    def radicands(self) -> frozenset[str]:
        """The distinct expressions under its roots, as text."""
        inner = frozenset[str]().union(*(argument.radicands for argument in self.args))
        return inner | {self.args[0].text()} if self.op == "sqrt" else inner

    def evaluated(self, number: Callable[[fmpq], N], root: Callable[[N], N]) -> N:
        """The same expression in another number system, from its rationals and its square root.

        >>> from .quantity import Quantity
        >>> Quantity.of("sqrt(2) + 1/2").evaluated(lambda q: int(q.p) / int(q.q), lambda x: x**0.5)
        1.9142135623730951
        """
        if self.rational is not None:
            return number(self.rational)
        if self.op == "sqrt":
            return root(self.args[0].evaluated(number, root))
        left, right = (argument.evaluated(number, root) for argument in self.args)
        if self.op == "+":
            return left + right
        if self.op == "-":
            return left - right
        if self.op == "*":
            return left * right
        return left / right

    def text(self) -> str:
        """The expression as text that `parse` reads back to the same number."""
        if self.rational is not None:
            return str(self.rational)
        if self.op == "sqrt":
            return f"sqrt({self.args[0].text()})"
        left, right = (argument.text() for argument in self.args)
        if self.op == "+":
            loose = self.args[1].op in "+-" or right.startswith("-")
            return f"{left} + ({right})" if loose else f"{left} + {right}"
        if self.op == "-":
            return f"{left} - {self._wrapped(self.args[1], '+-', right)}"
        left = self._wrapped(self.args[0], "+-", left)
        return f"{left}{self.op}{self._wrapped(self.args[1], '+-*/', right)}"

    def is_written_as(self, other: Expression) -> bool:
        """Whether another is the same expression, which is the same number, and known at once.

        >>> Quantity.of("1 + sqrt(2)").is_written_as(Quantity.of("1 + sqrt(2)"))
        True
        >>> Quantity.of("sqrt(2) + 1").is_written_as(Quantity.of("1 + sqrt(2)"))
        False
        """
        if self is other:
            return True
        if self.op != other.op or self.rational != other.rational or len(self.args) != len(other.args):
            return False
        return all(mine.is_written_as(theirs) for mine, theirs in zip(self.args, other.args, strict=True))

    def brief(self) -> str:
        """The text, cut to what an error shows."""
        return shortened(self.text())

    @staticmethod
    def _wrapped(argument: Expression, weak: str, text: str) -> str:
        rational = argument.rational
        loose = argument.op in weak or (rational is not None and (rational < 0 or rational.q != 1))
        return f"({text})" if loose else text


# -- Exact real numbers for scenes: rationals and square roots, kept as the expression that they are.

QuantityLike: TypeAlias = "Quantity | int | str | float | Fraction | Any"
"""What `Quantity.of` takes; SymPy numbers, which have no types, are among it."""

FIRST_BITS = 64
"""Working precision of the first look at a sign; most are decided there."""

TOWER_FROM_BITS = 512
"""A number whose ball still holds zero at this precision is asked in the tower, where zero is decided."""

MAX_ROOTS = 16
"""Most distinct roots of a number that is asked in the tower: products of n of them have up to 2**n terms."""

PATIENCE = 5_000_000
"""Units of work that the tower may spend on one number: about five seconds (see `work`). An identity such as
sqrt(5 + 2*sqrt(6)) = sqrt(2) + sqrt(3) takes 1,500, seven roots in one another 96,000. The inverse of a sum of 13 roots
takes 390,000, and three times as much for each further root, so that 15 are within reach and 16 are not."""


class Quantity(Expression):
    """An exact real number: a rational, or an expression of rationals with + - * / and square roots.

    Rational arithmetic is carried out at once; anything with a root keeps its expression, and can be enclosed
    to any precision, decided against zero exactly, or handed to SymPy. Immutable. Comparisons and hashes go by
    value, never by rounding.

    Build one with `Quantity.of`:

    >>> from fractions import Fraction
    >>> Quantity.of("9*sqrt(3)/8 + 69")
    Quantity('9*sqrt(3)/8 + 69')
    >>> Quantity.of("0.1") == Quantity.of(Fraction(1, 10))   # the decimal that it spells
    True
    >>> Quantity.of(0.1) == Quantity.of("0.1")               # a float is the dyadic rational that it is
    False
    >>> Quantity.of("sqrt(2)*sqrt(8)") == 4
    True
    """

    # -- building

    @staticmethod
    def of(value: QuantityLike) -> Quantity:
        """The exact number that `value` is.

        Takes text (see `parse`), int, Fraction, Decimal, float (as the dyadic rational that it is),
        `flint.fmpq`, a SymPy number made of rationals and square roots, or a Quantity.

        Raises:
            SceneError: for anything else, for nan and infinity, and for text outside the grammar.
        """
        return value if isinstance(value, Quantity) else converted(value, rational)

    def _binary(self, op: Op, other: QuantityLike, swapped: bool = False) -> Quantity:
        right = Quantity.of(other)
        left = self
        if swapped:
            left, right = right, left
        a, b = left.rational, right.rational
        if a is not None and b is not None:
            if op == "+":
                return rational(a + b)
            if op == "-":
                return rational(a - b)
            if op == "*":
                return rational(a * b)
        if op == "/":
            if right.sign() == 0:
                raise SceneError(f"division by zero in {left.text()}/({right.text()})")
            if a is not None and b is not None:
                return rational(a / b)
        if op in "+-" and b is not None and not b:
            return left
        if op == "+" and a is not None and not a:
            return right
        if op == "*" and ((a is not None and not a) or (b is not None and not b)):
            return ZERO
        if op == "*" and a is not None and a == 1:
            return right
        if op in "*/" and b is not None and b == 1:
            return left
        return Quantity(op, (left, right))

    def __add__(self, other: QuantityLike) -> Quantity:
        return self._binary("+", other)

    def __radd__(self, other: QuantityLike) -> Quantity:
        return self._binary("+", other, swapped=True)

    def __sub__(self, other: QuantityLike) -> Quantity:
        return self._binary("-", other)

    def __rsub__(self, other: QuantityLike) -> Quantity:
        return self._binary("-", other, swapped=True)

    def __mul__(self, other: QuantityLike) -> Quantity:
        return self._binary("*", other)

    def __rmul__(self, other: QuantityLike) -> Quantity:
        return self._binary("*", other, swapped=True)

    def __truediv__(self, other: QuantityLike) -> Quantity:
        return self._binary("/", other)

    def __rtruediv__(self, other: QuantityLike) -> Quantity:
        return self._binary("/", other, swapped=True)

    def __neg__(self) -> Quantity:
        return Quantity.of(-1) * self

    def __abs__(self) -> Quantity:
        return -self if self.sign() < 0 else self

    def __pow__(self, exponent: int) -> Quantity:
        """An integer power.

        >>> Quantity.of("sqrt(2)") ** 2 == 2, Quantity.of(2) ** -1
        (True, Quantity('1/2'))
        """
        if exponent < 0:
            return Quantity.of(1) / self ** (-exponent)
        if self.rational is not None:
            return rational(self.rational**exponent)
        result, square = Quantity.of(1), self
        while exponent:
            if exponent & 1:
                result = result * square
            exponent >>= 1
            if exponent:
                square = square * square
        return result

    def sqrt(self) -> Quantity:
        """The non-negative square root; a rational one comes out rational.

        Raises:
            SceneError: if the number is negative.

        >>> Quantity.of("9/4").sqrt(), Quantity.of(2).sqrt()
        (Quantity('3/2'), Quantity('sqrt(2)'))
        """
        if self.sign() < 0:
            raise SceneError(f"sqrt({self.text()}) is not real; only non-negative values have a square root")
        if self.rational is not None:
            root = rational_root(self.rational)
            if root is not None:
                return rational(root)
        return Quantity("sqrt", (self,))

    # -- deciding

    def sign(self) -> int:
        """-1, 0 or +1, decided exactly.

        >>> (Quantity.of("sqrt(5 + 2*sqrt(6))") - Quantity.of("sqrt(2) + sqrt(3)")).sign()
        0
        """
        return self._sign

    @kept
    def _sign(self) -> int:
        if self.rational is not None:
            return (self.rational > 0) - (self.rational < 0)
        bits = FIRST_BITS
        while bits < TOWER_FROM_BITS:
            value = self.ball(bits)
            if value > 0:
                return 1
            if value < 0:
                return -1
            bits *= 2
        return self._element.sign()

    @kept
    def _element(self) -> Element:
        from ..work import Work
        from .nested_roots import Tower
        from .tower_ring import TowerLimit  # loaded for numbers that need it

        if len(self.radicands) > MAX_ROOTS:
            raise SceneError(
                f"{self.brief()}: too close to zero to be distinguished from it, with over {MAX_ROOTS} roots"
            )
        tower = Tower(work=Work(PATIENCE))
        try:
            element = self.in_tower(tower)
            element.sign()
        except TowerLimit:
            raise SceneError(
                f"{self.brief()}: too close to zero to be distinguished from it within {PATIENCE:,} units of work"
            ) from None
        tower.work = None
        return element

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Quantity) and self.rational is not None and other.rational is not None:
            return self.rational == other.rational
        if isinstance(other, Quantity) and self.is_written_as(other):
            return True
        try:
            return (self - Quantity.of(other)).sign() == 0
        except SceneError:
            return NotImplemented

    def __hash__(self) -> int:
        try:
            return hash(float(self))
        except OverflowError:
            return self.sign()

    def __lt__(self, other: QuantityLike) -> bool:
        return (self - other).sign() < 0

    def __le__(self, other: QuantityLike) -> bool:
        return (self - other).sign() <= 0

    def __gt__(self, other: QuantityLike) -> bool:
        return (self - other).sign() > 0

    def __ge__(self, other: QuantityLike) -> bool:
        return (self - other).sign() >= 0

    # -- handing on

    def ball(self, bits: int) -> arb:
        """An enclosure computed with a working precision of `bits` bits."""
        with at_bits(bits):
            return self._ball(bits)

    def _ball(self, bits: int) -> arb:
        if self.rational is not None:
            return arb(self.rational)
        if self.op == "sqrt":
            inner = self.args[0]
            return inner._clear_of_zero(bits).sqrt() if inner.sign() else arb(0)
        left, right = self.args
        if self.op == "+":
            return left._ball(bits) + right._ball(bits)
        if self.op == "-":
            return left._ball(bits) - right._ball(bits)
        if self.op == "*":
            return left._ball(bits) * right._ball(bits)
        return left._ball(bits) / right._clear_of_zero(bits)

    def _clear_of_zero(self, bits: int) -> arb:
        """A ball of a number that is not zero, more sharply where one of so many bits touches zero."""
        value = self._ball(bits)
        while not (value > 0 or value < 0):
            bits *= 2
            value = self.ball(bits)
        return value

    def in_tower(self, tower: AnyTower) -> Element:
        """The same number as an element of `tower`, which gains the roots that it lacks.

        Raises:
            TowerLimit: if the tower may not grow that far.
        """
        return self.evaluated(tower.rational, tower.sqrt)

    @property
    def fraction(self) -> Fraction | None:
        """The number as a Fraction if it is written without roots, else None."""
        if self.rational is None:
            return None
        from fractions import Fraction

        return Fraction(int(self.rational.p), int(self.rational.q))

    def __float__(self) -> float:
        """The nearest double.

        Raises:
            OverflowError: if the number is beyond the doubles.
        """
        return self._double

    @kept
    def _double(self) -> float:
        if self.rational is not None:
            return nearest_double(self.rational)
        bits = 2 * FIRST_BITS
        while True:
            double = certain_double(self.ball(bits))
            if double is not None:
                if double in (float("inf"), float("-inf")):
                    raise OverflowError("the number is beyond the doubles")
                return double
            if bits == TOWER_FROM_BITS:  # a rational in disguise may lie half-way between two doubles
                rational = self._element.fraction()
                if rational is not None:
                    return nearest_double(rational)
            bits *= 2

    def bounds(self) -> tuple[float, float]:
        """Doubles at or below, and at or above, the number.

        >>> Quantity.of("1/4").bounds(), Quantity.of("sqrt(2)").bounds()
        ((0.25, 0.25), (1.414213562373095, 1.4142135623730951))
        """
        return bounds_of(self.ball(2 * FIRST_BITS))

    def digits(self, count: int) -> str:
        """The value in decimals, so many digits (the last may be off by one).

        >>> Quantity.of("sqrt(2)").digits(20), Quantity.of("2/3 - 1").digits(5)
        ('1.4142135623730950488', '-0.33333')
        >>> Quantity.of("sqrt(6) - sqrt(2)*sqrt(3)").digits(5)
        '0'
        """
        count = asked("digits", count, MOST_DIGITS)
        bits = int(count * BITS_PER_DIGIT) + FIRST_BITS
        value = self.ball(bits)
        if value.contains(0) and not self.sign():
            return "0"
        while value.rel_accuracy_bits() < count * BITS_PER_DIGIT + 2:
            bits *= 2
            value = self.ball(bits)
        return digits_of(value, count)

    def sympy(self) -> Any:
        """The same expression in SymPy."""
        sympy: Any = import_module("sympy")
        return self.evaluated(lambda q: sympy.Rational(int(q.p), int(q.q)), sympy.sqrt)

    def __str__(self) -> str:
        return self.text()

    def __repr__(self) -> str:
        return f"Quantity({self.text()!r})"


def rational(q: fmpq) -> Quantity:
    """A rational number as a Quantity."""
    return Quantity("q", (), q)


ZERO = Quantity.of(0)


# -- What the numbers of every run can do, whatever the engine computes in.


@runtime_checkable
class Real(Protocol):
    """A number of a run: a time, a coordinate, a speed. `Quantity` and `Double` are two; engines have more.

    The enclosures hold what the engine knows: the value itself, or an interval that is as narrow as it gets.
    """

    def __float__(self) -> float:
        """The nearest double; the middle of an interval."""
        ...

    def bounds(self) -> tuple[float, float]:
        """Doubles at or below, and at or above, the value."""
        ...

    def text(self) -> str | None:
        """The exact value in the grammar of scene files; None where it is not known, or too deep to be written."""
        ...

    def digits(self, count: int) -> str:
        """The value in decimals: as many digits as are known, and at most `count`; "" if none is."""
        ...

    def ball(self, bits: int) -> arb:
        """An enclosure, to about `bits` bits where the engine can go that far."""
        ...


@lru_cache(maxsize=64)
def _is_real(kind: type) -> bool:
    """Whether numbers of a type are `Real`: asked once, since looking at a protocol takes ten times as long."""
    return all(callable(getattr(kind, name, None)) for name in ("__float__", "bounds", "text", "digits", "ball"))


def real(value: Any) -> Real:
    """A number of any engine as a `Real`: those of an engine that hands back plain floats are doubles.

    >>> real(0.375).text(), real(10**400).bounds()[1], real("sqrt(2)").digits(10)
    ('3/8', inf, '1.414213562')
    """
    if type(value) is float:
        return Double(value)
    if _is_real(value.__class__) or isinstance(value, Real):
        return value
    if isinstance(value, float):
        return Double(value)
    try:
        return Quantity.of(value)
    except SceneError:
        number: SupportsFloat = value
        return Double(number)


def in_one_tower(value: Element | Quantity, tower: AnyTower) -> Element:
    """A number as an element of `tower`; each exact value of a run has a tower of its own.

    Raises:
        TowerLimit: if the tower may not grow that far.

    >>> from truebreak.scenarios.numbers.nested_roots import Tower
    >>> one, other = Tower(), Tower()
    >>> in_one_tower(other.sqrt(2) + 1, one) == in_one_tower(Quantity.of("1+sqrt(2)"), one)
    True
    """
    if isinstance(value, Quantity):
        return value.in_tower(tower)
    return value if value.tower is tower else Quantity.of(value.text()).in_tower(tower)
