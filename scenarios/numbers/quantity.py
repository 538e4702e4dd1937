"""Exact real numbers for scenes: rationals and square roots, kept as the expression that they are."""

from __future__ import annotations

from fractions import Fraction
from functools import cached_property
from math import isfinite
from numbers import Rational
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from flint import arb, ctx, fmpq, fmpz  # type: ignore[attr-defined]

from ..errors import SceneError

if TYPE_CHECKING:
    from .tower import AnyTower, Element

Op: TypeAlias = Literal["q", "+", "-", "*", "/", "sqrt"]
QuantityLike: TypeAlias = "Quantity | int | str | float | Fraction | Any"

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

SHOWN = 60
"""How much of a number an error repeats, in characters."""


class Quantity:
    """An exact real number: a rational, or an expression of rationals with + - * / and square roots.

    Rational arithmetic is carried out at once; anything with a root keeps its expression, and can be enclosed
    to any precision, decided against zero exactly, or handed to SymPy. Immutable. Comparisons and hashes go by
    value, never by rounding.

    Build one with `Quantity.of`:

    >>> Quantity.of("9*sqrt(3)/8 + 69")
    Quantity('9*sqrt(3)/8 + 69')
    >>> Quantity.of("0.1") == Quantity.of(Fraction(1, 10))   # the decimal that it spells
    True
    >>> Quantity.of(0.1) == Quantity.of("0.1")               # a float is the dyadic rational that it is
    False
    >>> Quantity.of("sqrt(2)*sqrt(8)") == 4
    True
    """

    __slots__ = ("__dict__", "args", "op", "rational")

    def __init__(self, op: Op, args: tuple[Quantity, ...], rational: fmpq | None = None) -> None:
        self.op = op
        self.args = args
        self.rational = rational

    # -- building

    @staticmethod
    def of(value: QuantityLike) -> Quantity:
        """The exact number that `value` is.

        Takes text (see `parse_quantity`), int, Fraction, Decimal, float (as the dyadic rational that it is),
        `flint.fmpq`, a SymPy number made of rationals and square roots, or a Quantity.

        Raises:
            SceneError: for anything else, for nan and infinity, and for text outside the grammar.
        """
        if isinstance(value, Quantity):
            return value
        if isinstance(value, bool):
            raise SceneError(f'{value!r} is not a number; write a whole number or text such as "9/4"')
        if isinstance(value, int):
            return Quantity("q", (), fmpq(value))
        if isinstance(value, str):
            from .parsing import parse_quantity

            return parse_quantity(value)
        if isinstance(value, fmpq):
            return Quantity("q", (), value)
        if isinstance(value, fmpz):
            return Quantity("q", (), fmpq(value))
        if isinstance(value, float):
            if not isfinite(value):
                raise SceneError(f"{value!r} is not a finite number")
            return Quantity("q", (), fmpq(*value.as_integer_ratio()))
        if isinstance(value, Rational):
            return Quantity("q", (), fmpq(int(value.numerator), int(value.denominator)))
        if hasattr(value, "as_integer_ratio") and not hasattr(value, "free_symbols"):
            try:
                numerator, denominator = value.as_integer_ratio()
            except (OverflowError, ValueError) as error:
                raise SceneError(f"{value!r} is not a finite number") from error
            return Quantity("q", (), fmpq(int(numerator), int(denominator)))
        if hasattr(value, "free_symbols"):
            from .parsing import quantity_from_sympy

            return quantity_from_sympy(value)
        raise SceneError(
            f"{value!r} ({type(value).__name__}) is not an exact number; "
            'write a whole number, a Fraction, or text such as "sqrt(3)/2"'
        )

    def _binary(self, op: Op, other: QuantityLike, swapped: bool = False) -> Quantity:
        right = Quantity.of(other)
        left = self
        if swapped:
            left, right = right, left
        a, b = left.rational, right.rational
        if a is not None and b is not None:
            if op == "+":
                return Quantity("q", (), a + b)
            if op == "-":
                return Quantity("q", (), a - b)
            if op == "*":
                return Quantity("q", (), a * b)
        if op == "/":
            if right.sign() == 0:
                raise SceneError(f"division by zero in {left.text()}/({right.text()})")
            if a is not None and b is not None:
                return Quantity("q", (), a / b)
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
            return Quantity("q", (), self.rational**exponent)
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
                return Quantity("q", (), root)
        return Quantity("sqrt", (self,))

    # -- deciding

    def sign(self) -> int:
        """-1, 0 or +1, decided exactly.

        >>> (Quantity.of("sqrt(5 + 2*sqrt(6))") - Quantity.of("sqrt(2) + sqrt(3)")).sign()
        0
        """
        return self._sign

    @cached_property
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

    @cached_property
    def _element(self) -> Element:
        from ..work import Work
        from .tower import Tower, TowerLimit

        if len(self.radicands) > MAX_ROOTS:
            raise SceneError(f"{self.brief()}: too close to zero to be told from it, with over {MAX_ROOTS} roots")
        try:
            element = self.in_tower(Tower(work=Work(PATIENCE)))
            element.sign()
        except TowerLimit:
            raise SceneError(
                f"{self.brief()}: too close to zero to be told from it within {PATIENCE:,} units of work"
            ) from None
        element.tower.work = None
        return element

    def __eq__(self, other: object) -> bool:
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

    @cached_property
    def size(self) -> int:
        """How many numbers its expression holds."""
        return sum(argument.size for argument in self.args) if self.args else 1

    @cached_property
    def radicands(self) -> frozenset[str]:
        """The distinct expressions under its roots, as text."""
        inner = frozenset[str]().union(*(argument.radicands for argument in self.args))
        return inner | {self.args[0].text()} if self.op == "sqrt" else inner

    def ball(self, bits: int) -> arb:
        """An enclosure computed with a working precision of `bits` bits."""
        saved = ctx.prec
        ctx.prec = bits
        try:
            return self._ball()
        finally:
            ctx.prec = saved

    def _ball(self) -> arb:
        if self.rational is not None:
            return arb(self.rational)
        if self.op == "sqrt":
            inner = self.args[0]
            while True:  # a positive radicand whose ball touches zero is enclosed more sharply
                value = inner._ball()
                if value > 0 or inner.sign() == 0:
                    return value.sqrt() if inner.sign() else arb(0)
                ctx.prec *= 2
        left, right = self.args
        if self.op == "+":
            return left._ball() + right._ball()
        if self.op == "-":
            return left._ball() - right._ball()
        if self.op == "*":
            return left._ball() * right._ball()
        divisor = right._ball()
        while not (divisor > 0 or divisor < 0):
            ctx.prec *= 2
            divisor = right._ball()
        return left._ball() / divisor

    def in_tower(self, tower: AnyTower) -> Element:
        """The same number as an element of `tower`, which gains the roots that it lacks.

        Raises:
            TowerLimit: if the tower may not grow that far.
        """
        if self.rational is not None:
            return tower.rational(self.rational)
        if self.op == "sqrt":
            return tower.sqrt(self.args[0].in_tower(tower))
        left, right = (argument.in_tower(tower) for argument in self.args)
        if self.op == "+":
            return left + right
        if self.op == "-":
            return left - right
        if self.op == "*":
            return left * right
        return left / right

    @property
    def fraction(self) -> Fraction | None:
        """The number as a Fraction if it is written without roots, else None."""
        if self.rational is None:
            return None
        return Fraction(int(self.rational.p), int(self.rational.q))

    def __float__(self) -> float:
        """The nearest double.

        Raises:
            OverflowError: if the number is beyond the doubles.
        """
        return self._double

    @cached_property
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

    def sympy(self) -> Any:
        """The same expression in SymPy."""
        import sympy

        if self.rational is not None:
            return sympy.Rational(int(self.rational.p), int(self.rational.q))
        if self.op == "sqrt":
            return sympy.sqrt(self.args[0].sympy())
        left, right = (argument.sympy() for argument in self.args)
        if self.op == "+":
            return left + right
        if self.op == "-":
            return left - right
        if self.op == "*":
            return left * right
        return left / right

    def text(self) -> str:
        """The expression as text that `parse_quantity` reads back to the same number."""
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

    def brief(self) -> str:
        """The text, cut to what an error shows."""
        text = self.text()
        return text if len(text) <= SHOWN else f"{text[:SHOWN]}... ({len(text)} characters)"

    @staticmethod
    def _wrapped(argument: Quantity, weak: str, text: str) -> str:
        rational = argument.rational
        loose = argument.op in weak or (rational is not None and (rational < 0 or rational.q != 1))
        return f"({text})" if loose else text

    def __str__(self) -> str:
        return self.text()

    def __repr__(self) -> str:
        return f"Quantity({self.text()!r})"


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


def certain_double(value: arb) -> float | None:
    """The double nearest to every number in a ball, or None where the ball leaves a choice.

    >>> certain_double(arb(1) / 4), certain_double(arb("1 +/- 1e-10"))
    (0.25, None)
    """
    saved = ctx.prec
    ctx.prec = max(value.bits(), FIRST_BITS) + FIRST_BITS
    try:
        low, high = float(value.lower()), float(value.upper())
    finally:
        ctx.prec = saved
    return low + 0.0 if low == high else None  # + 0.0: zero has no sign


def nearest_double(q: fmpq) -> float:
    """The double nearest to a rational, ties to even.

    Raises:
        OverflowError: if the rational is beyond the doubles.

    >>> from flint import fmpq
    >>> nearest_double(fmpq(1, 10))
    0.1
    """
    return int(q.p) / int(q.q)


ZERO = Quantity.of(0)
