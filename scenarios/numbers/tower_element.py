"""The elements of a tower: immutable real numbers in normal form, how they are written, and signs of their sums."""

from __future__ import annotations

from importlib import import_module
from numbers import Rational as PythonsRational
from typing import Any, Final, Protocol, TypeAlias

from flint import arb, fmpq, fmpz

from ..work import gcd_units
from .precision import at_bits
from .tower_ring import (
    LONG,
    ONE,
    Integral,
    TowerField,
    add,
    coefficients,
    content,
    count_of,
    divide,
    key,
    negated,
    scale,
)

# -- Numbers of a field written out: as text in the grammar of scene files, and as SymPy expressions.


def text_of(field: TowerField, num: Integral, den: fmpz) -> str:
    """num / den as text, made of + - * / sqrt ( )."""
    out = ""
    for c, factor in _terms(field, num, den):
        size = abs(c)
        body = factor if factor and size == 1 else f"{size}*{factor}" if factor else str(size)
        if not out:
            out = body if c > 0 else f"-{body}"
        else:
            out += f" + {body}" if c > 0 else f" - {body}"
    return out or "0"


def _terms(field: TowerField, x: Integral, den: fmpz) -> list[tuple[fmpq, str]]:
    """Coefficients and factors as text; nested roots first, the rational term last."""
    if isinstance(x, fmpz):
        return [(fmpq(x, den), "")] if x else []
    if isinstance(x, dict):
        surds = sorted((field.product(mask), c) for mask, c in x.items() if mask)
        terms = [(fmpq(c, den), f"sqrt({m.str()})") for m, c in surds]
        return terms + ([(fmpq(x[0], den), "")] if 0 in x else [])
    root = f"sqrt({text_of(field, field.radicands[x.level - 1], ONE)})"
    inner = _terms(field, x.b, den)
    if len(inner) == 1:
        c, factor = inner[0]
        head = (c, f"{factor}*{root}" if factor else root)
    else:
        g = content(x.b, den)
        head = (fmpq(1), f"({text_of(field, divide(x.b, g), den // g)})*{root}")
    return [head, *_terms(field, x.a, den)]


def sympy_form(field: TowerField, num: Integral, den: fmpz) -> Any:
    """num / den as a SymPy expression."""
    sympy: Any = import_module("sympy")

    def rational(c: fmpz) -> Any:
        return sympy.Integer(int(c)) / sympy.Integer(int(den))

    if isinstance(num, fmpz):
        return rational(num)
    if isinstance(num, dict):
        return sympy.Add(*(rational(c) * sympy.sqrt(int(field.product(mask))) for mask, c in num.items()))
    root = sympy.sqrt(sympy_form(field, field.radicands[num.level - 1], ONE))
    return sympy_form(field, num.a, den) + sympy_form(field, num.b, den) * root


# -- The elements of a tower: immutable real numbers in normal form.

Rational: TypeAlias = "int | PythonsRational | fmpq | fmpz"


class AnyTower(Protocol):
    """What elements and those who make them need of a tower."""

    @property
    def field(self) -> TowerField:
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

    >>> from truebreak.scenarios.numbers.nested_roots import Tower
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
        if isinstance(other, (int, fmpq, fmpz, PythonsRational)):
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

        >>> from truebreak.scenarios.numbers.nested_roots import Tower
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

        >>> from truebreak.scenarios.numbers.nested_roots import Tower
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
    if isinstance(q, (int, fmpz, fmpq)):
        return fmpq(q)
    if isinstance(q, PythonsRational):
        return fmpq(int(q.numerator), int(q.denominator))
    raise TypeError(f"{q!r} is not a rational number")


# -- Signs of sums with roots that need not be in the tower.

FILTER_BITS: Final = (64, 128, 256)
"""Ball precisions that `sign_of_root_sum` tries before it computes in the field."""


def _sign_with_root(a: Element, b: Element, d: Element) -> int:
    """The sign of a + b sqrt(d), d >= 0, from signs in the field.

    If a and b sqrt(d) do not differ in sign, it is theirs. If they do, the one of the
    larger square wins, and the squares are a**2 and b**2 d.
    """
    p = a.sign()
    q = b.sign() if not d.is_zero() else 0
    if q in (0, p):
        return p
    if p == 0:
        return q
    return p * (a * a - b * b * d).sign()


def sign_of_root_sum(a: Element, b: Element, d1: Element, c: Element, d2: Element) -> int:
    """The sign of S = a + b sqrt(d1) + c sqrt(d2), exactly; adds no root to the tower.

    Balls decide what is plainly not zero. What is left is decided in the field. Write
    S = P + Q, P = a + b sqrt(d1), Q = c sqrt(d2). The sign of P is that of one root
    (`_sign_with_root`), the sign of Q is that of c, or 0 if d2 = 0. If P and Q are not of
    opposite sign, that is the sign of S. If they are, S P > 0 exactly if P**2 > Q**2, so
    sign S = sign P * sign(P**2 - Q**2), and
    P**2 - Q**2 = (a**2 + b**2 d1 - c**2 d2) + 2 a b sqrt(d1) has one root again.

    Raises:
        ValueError: if d1 or d2 is negative.

    >>> from truebreak.scenarios.numbers.nested_roots import Tower
    >>> tower = Tower()
    >>> q = tower.rational
    >>> sign_of_root_sum(q(1), q(2), q(2), q(-1), 9 + 4 * tower.sqrt(2))
    0
    """
    for d in (d1, d2):
        if d.sign() < 0:
            raise ValueError(f"square root of the negative number {d.brief()}")
    for bits in FILTER_BITS:
        balls = [e.ball(bits) for e in (a, b, d1, c, d2)]
        with at_bits(bits):
            value = balls[0] + balls[1] * balls[2].sqrt() + balls[3] * balls[4].sqrt()
        if value > 0:
            return 1
        if value < 0:
            return -1
    p = _sign_with_root(a, b, d1)
    q = c.sign() if not d2.is_zero() else 0
    if q in (0, p):
        return p
    if p == 0:
        return q
    return p * _sign_with_root(a * a + b * b * d1 - c * c * d2, 2 * a * b, d1)
