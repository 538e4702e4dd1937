"""The elements of a tower: immutable real numbers in normal form."""

from __future__ import annotations

from fractions import Fraction
from typing import Any, Protocol, TypeAlias

from flint import arb, fmpq, fmpz

from ...work import gcd_units
from ..precision import at_bits
from .field import LONG, Field
from .ring import Integral, add, coefficients, content, count_of, key, negated, scale
from .written import sympy_form, text_of

Rational: TypeAlias = "int | Fraction | fmpq | fmpz"


class AnyTower(Protocol):
    """What elements and those who make them need of a tower."""

    @property
    def field(self) -> Field:
        """The generators so far, and the arithmetic in them."""
        ...

    def rational(self, q: Rational) -> Element:
        """q as an element."""
        ...

    def sqrt(self, e: Element | Rational) -> Element:
        """The square root of e that is not negative."""
        ...


class Element:
    """A number of a `Tower`: immutable, in normal form, num / den with den > 0.

    Use + - * / and whole powers with elements of the same tower and with rational numbers.
    == is exact. There is no order: ask `sign()` of a difference.

    >>> from truebreak.scenarios.numbers.tower import Tower
    >>> tower = Tower()
    >>> phi = (1 + tower.sqrt(5)) / 2
    >>> phi * phi == phi + 1, (phi - 2).sign(), (phi**-1).text()
    (True, -1, '1/2*sqrt(5) - 1/2')
    """

    __slots__ = ("den", "num", "tower")

    tower: AnyTower
    num: Integral
    den: fmpz

    def __init__(self, tower: AnyTower, num: Integral, den: fmpz) -> None:
        field = tower.field
        if field.work is not None:
            field.spend(1 if isinstance(num, fmpz) else 1 + (count_of(num) >> 1))
        if den != 1:
            g = content(num, den) if den < LONG else field.content(num, den)
            if g != 1:
                num, den = field.quotient(num, g), den // g
        self.tower = tower
        self.num = num
        self.den = den

    def __repr__(self) -> str:
        return f"Element({self.text()})"

    def _other(self, other: object) -> Element | None:
        if isinstance(other, Element):
            if other.tower is not self.tower:
                raise ValueError(f"{other.brief()} belongs to another tower")
            return other
        if isinstance(other, (int, Fraction, fmpq, fmpz)):
            return self.tower.rational(other)
        return None

    def __eq__(self, other: object) -> bool:
        e = self._other(other)
        if e is None:
            return NotImplemented
        return self.den == e.den and self.num == e.num

    def __hash__(self) -> int:
        if isinstance(self.num, fmpz):
            return hash(fmpq(self.num, self.den))
        return hash((key(self.num), self.den))

    def __neg__(self) -> Element:
        return reduced(self.tower, negated(self.num), self.den)

    def __pos__(self) -> Element:
        return self

    def __abs__(self) -> Element:
        return -self if self.sign() < 0 else self

    def __add__(self, other: Element | Rational) -> Element:
        e = self._other(other)
        if e is None:
            return NotImplemented
        if self.den == e.den:
            return Element(self.tower, add(self.num, e.num), self.den)
        times = scale
        if self.den > LONG or e.den > LONG:
            self.tower.field.spend(gcd_units(self.den.bit_length(), e.den.bit_length()))
            times = self.tower.field.mul
        g = self.den.gcd(e.den)
        left, right = e.den // g, self.den // g
        return Element(self.tower, add(times(self.num, left), times(e.num, right)), self.den * left)

    __radd__ = __add__

    def __sub__(self, other: Element | Rational) -> Element:
        e = self._other(other)
        return NotImplemented if e is None else self + -e

    def __rsub__(self, other: Rational) -> Element:
        return -self + other

    def __mul__(self, other: Element | Rational) -> Element:
        e = self._other(other)
        if e is None:
            return NotImplemented
        return Element(self.tower, self.tower.field.mul(self.num, e.num), self.den * e.den)

    __rmul__ = __mul__

    def __truediv__(self, other: Element | Rational) -> Element:
        e = self._other(other)
        if e is None:
            return NotImplemented
        return self * e.inverse()

    def __rtruediv__(self, other: Rational) -> Element:
        return self.inverse() * other

    def __pow__(self, exponent: int) -> Element:
        if exponent < 0:
            return self.inverse() ** -exponent
        power = self.tower.rational(1)
        for bit in bin(exponent)[2:]:
            power = power * power
            if bit == "1":
                power = power * self
        return power

    def inverse(self) -> Element:
        """1 over it.

        Raises:
            ZeroDivisionError: if it is zero.
        """
        if not self.num:
            raise ZeroDivisionError("division by zero in a tower")
        field = self.tower.field
        inverse, d = field.inverse(self.num)
        return Element(self.tower, field.mul(inverse, self.den), d)

    def is_zero(self) -> bool:
        """Whether this is exactly 0: read off the normal form."""
        return not self.num

    def sign(self) -> int:
        """-1, 0 or +1, exactly. A ball at rising precision is only asked of what is not zero."""
        return self.tower.field.sign(self.num)

    def ball(self, bits: int) -> arb:
        """An enclosure with a relative accuracy of about `bits` binary digits.

        >>> from truebreak.scenarios.numbers.tower import Tower
        >>> (Tower().sqrt(10**40 + 1) - 10**20).ball(30)
        [5.000000000000e-21 +/- 1.23e-34]
        """
        if not self.num:
            return arb(0)
        value = self.tower.field.accurate_ball(self.num, bits + 2)
        with at_bits(bits + 16):
            return value / self.den

    def fraction(self) -> fmpq | None:
        """The rational number that this is, or None."""
        return fmpq(self.num, self.den) if isinstance(self.num, fmpz) else None

    def height_bits(self) -> int:
        """The length in bits of the longest coefficient, or of the denominator."""
        return max(self.den.bit_length(), *(c.bit_length() for c in coefficients(self.num)))

    def text(self) -> str:
        """In the grammar of scene files: + - * / sqrt ( ).

        >>> from truebreak.scenarios.numbers.tower import Tower
        >>> (Tower().sqrt(3) / 2 - 175).text()
        '1/2*sqrt(3) - 175'
        """
        return text_of(self.tower.field, self.num, self.den)

    def brief(self) -> str:
        """It in a message: its text if short, else its size and about its value."""
        if self.height_bits() <= 64 and len(text := self.text()) <= 80:
            return text
        return f"{float(self.ball(53).mid())!r} (about; {self.height_bits()} bits)"

    def sympy(self) -> Any:
        """The same number as a SymPy expression."""
        return sympy_form(self.tower.field, self.num, self.den)


def reduced(tower: AnyTower, num: Integral, den: fmpz) -> Element:
    """An element whose fraction is known to be in lowest terms."""
    e = Element.__new__(Element)
    e.tower, e.num, e.den = tower, num, den
    return e


def rational_number(q: object) -> fmpq:
    """A rational number of any of the kinds that towers take.

    Raises:
        TypeError: for anything else.
    """
    if isinstance(q, Fraction):
        return fmpq(q.numerator, q.denominator)
    if isinstance(q, (int, fmpz, fmpq)):
        return fmpq(q)
    raise TypeError(f"{q!r} is not a rational number")
