"""Reads exact numbers by whitelist: from text, from SymPy, and from number types of one's own. Never eval."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from importlib import import_module
from math import isfinite
from numbers import Rational
from typing import Any, Generic, NamedTuple, Protocol, TypeVar, runtime_checkable

from flint import fmpq, fmpz

from ..errors import SceneError, shortened

# -- Reads exact numbers from text, by whitelist: never eval.

MAX_LENGTH = 20_000
"""Longest text of one number, in characters: ten times what any scene needs, read in a millisecond."""

MAX_DEPTH = 60
"""Deepest nesting of parentheses and roots."""

MAX_EXPONENT = 10_000
"""Largest power and largest decimal exponent."""

MAX_BITS = 1 << 20
"""Largest size of a rational result: a power tower built of allowed powers stops here."""

MAX_TERMS = 200
"""Most numbers that an expression with roots may hold: its tree is walked by recursion."""

TOKEN = (
    r"\s*(?:(?P<number>\d+(?:\.\d*)?(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?)"
    r"|(?P<name>[A-Za-z_]\w*)|(?P<op>\*\*|[-+*/()]))"
)

PLAIN = re.compile(r"(-?\d{1,18})(?:/(\d{1,18}))?", re.ASCII)
"""A whole number or a fraction, short and without spaces: most numbers of a large scene. They need no parser."""


class Token(NamedTuple):
    kind: str
    text: str


class Readable(Protocol):
    """What reading asks of the numbers that it makes."""

    @property
    def rational(self) -> fmpq | None:
        """Its value, if it is written without roots."""
        ...

    @property
    def size(self) -> int:
        """How many numbers it holds."""
        ...

    def sign(self) -> int:
        """-1, 0 or +1."""
        ...

    def sqrt(self: N) -> N:
        """The square root that is not negative."""
        ...

    def __add__(self: N, other: N, /) -> N: ...
    def __sub__(self: N, other: N, /) -> N: ...
    def __mul__(self: N, other: N, /) -> N: ...
    def __truediv__(self: N, other: N, /) -> N: ...
    def __neg__(self: N) -> N: ...
    def __pow__(self: N, exponent: int, /) -> N: ...


N = TypeVar("N", bound=Readable)


def parse(text: str, number: Callable[[fmpq], N]) -> N:
    """The exact number that `text` spells, built from what `number` makes of rationals.

    Grammar: whole numbers, decimals (`0.1` is one tenth, `1e-40` is exact too), `+ - * /`, integer powers
    with `**`, `sqrt(...)` of a non-negative value, parentheses. Nothing else, and nothing is evaluated by
    Python.

    Raises:
        SceneError: naming the text, the place and the reason.

    >>> from .quantity import Quantity, rational
    >>> parse("-(1 + sqrt(5))/2", rational)
    Quantity('(-1)*(1 + sqrt(5))/2')
    >>> float(parse("10**-40", rational))
    1e-40
    """
    plain = PLAIN.fullmatch(text)
    if plain is not None and (below := int(plain[2] or 1)):
        return number(fmpq(int(plain[1]), below))
    if len(text) > MAX_LENGTH:
        raise SceneError(f"{shortened(text)!r}: too long for one number; at most {MAX_LENGTH} characters")
    return _Parser(text, number).parse()


class _Parser(Generic[N]):
    """Recursive descent over the tokens of one number."""

    def __init__(self, text: str, number: Callable[[fmpq], N]) -> None:
        self.text = text
        self.number = number
        self.tokens = self._tokens()
        self.at = 0
        self.depth = 0

    def refuse(self, reason: str) -> SceneError:
        return SceneError(f"{shortened(self.text)!r} is not an exact number: {reason}")

    def _tokens(self) -> list[Token]:
        tokens: list[Token] = []
        place = 0
        end = len(self.text.rstrip())
        pattern = re.compile(TOKEN, re.ASCII)
        while place < end:
            match = pattern.match(self.text, place)
            if match is None or match.end() == place:
                rest = self.text[place:].lstrip()
                raise self.refuse(f"{rest[:1]!r} is not allowed; use digits, + - * / **, sqrt() and parentheses")
            kind = str(match.lastgroup)
            tokens.append(Token(kind, match.group(kind)))
            place = match.end()
        return tokens

    def peek(self) -> str:
        return self.tokens[self.at].text if self.at < len(self.tokens) else ""

    def take(self) -> Token:
        token = self.tokens[self.at]
        self.at += 1
        return token

    def parse(self) -> N:
        if not self.tokens:
            raise self.refuse("it is empty")
        value = self.sum()
        if self.at < len(self.tokens):
            raise self.refuse(f"{self.peek()!r} is not expected there")
        return value

    def bounded(self, value: N) -> N:
        if value.rational is not None and value.rational.height_bits() > MAX_BITS:
            raise self.refuse(f"it has more than {MAX_BITS} bits")
        if value.size > MAX_TERMS:
            raise self.refuse(f"it has more than {MAX_TERMS} terms")
        return value

    def sum(self) -> N:
        value = self.product()
        while self.peek() in ("+", "-"):
            operator = self.take().text
            right = self.product()
            value = self.bounded(value + right if operator == "+" else value - right)
        return value

    def product(self) -> N:
        value = self.signed()
        while self.peek() in ("*", "/"):
            operator = self.take().text
            right = self.signed()
            if operator == "/" and right.sign() == 0:
                raise self.refuse("division by zero")
            value = self.bounded(value * right if operator == "*" else value / right)
        return value

    def signed(self) -> N:
        negative = False
        while self.peek() in ("+", "-"):
            negative ^= self.take().text == "-"
        value = self.power()
        return -value if negative else value

    def power(self) -> N:
        base = self.atom()
        if self.peek() != "**":
            return base
        self.take()
        exponent = self.exponent()
        if self.peek() == "**":
            raise self.refuse("a power of a power; write the exponent as one whole number")
        if exponent < 0 and base.sign() == 0:
            raise self.refuse("division by zero")
        if base.rational is not None and base.rational.height_bits() * abs(exponent) > MAX_BITS:
            raise self.refuse(f"its power has more than {MAX_BITS} bits")
        if base.rational is None and base.size * abs(exponent) > MAX_TERMS:
            raise self.refuse(f"its power has more than {MAX_TERMS} terms")
        return self.bounded(base**exponent)

    def exponent(self) -> int:
        """A whole number, perhaps signed, perhaps in parentheses."""
        parentheses = self.peek() == "("
        if parentheses:
            self.take()
        negative = False
        while self.peek() in ("+", "-"):
            negative ^= self.take().text == "-"
        if not self.peek().isdigit():
            raise self.refuse("an exponent must be a whole number")
        digits = self.take().text
        if parentheses:
            self.close()
        if len(digits) > len(str(MAX_EXPONENT)) or int(digits) > MAX_EXPONENT:
            raise self.refuse(f"an exponent may be at most {MAX_EXPONENT}")
        return -int(digits) if negative else int(digits)

    def close(self) -> None:
        if self.peek() != ")":
            raise self.refuse("a parenthesis is not closed")
        self.take()

    def atom(self) -> N:
        if self.at >= len(self.tokens):
            raise self.refuse("it ends too early")
        token = self.take()
        if token.kind == "number":
            return self.number(self.decimal(token.text))
        if token.text == "(":
            return self.inside()
        if token.kind == "name":
            if token.text != "sqrt":
                raise self.refuse(f"{token.text!r} is not allowed; the only function is sqrt")
            if self.peek() != "(":
                raise self.refuse("sqrt needs parentheses")
            self.take()
            value = self.inside()
            if value.sign() < 0:
                raise self.refuse("the square root of a negative value")
            return value.sqrt()
        raise self.refuse(f"{token.text!r} is not expected there")

    def inside(self) -> N:
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise self.refuse(f"nested deeper than {MAX_DEPTH}")
        value = self.sum()
        self.close()
        self.depth -= 1
        return value

    def decimal(self, text: str) -> fmpq:
        mantissa, _, exponent = text.lower().partition("e")
        whole, _, part = mantissa.partition(".")
        if len(exponent.lstrip("+-")) > len(str(MAX_EXPONENT)) or abs(int(exponent or 0)) > MAX_EXPONENT:
            raise self.refuse(f"a decimal exponent may be at most {MAX_EXPONENT}")
        value = fmpq(fmpz((whole + part) or "0"), fmpz(10) ** len(part))
        shift = int(exponent or 0)
        return value * fmpz(10) ** shift if shift >= 0 else value / fmpz(10) ** -shift


# -- Exact numbers from SymPy expressions, by whitelist.

MAX_ROOTS = 1 << 10
"""Largest denominator of an exponent, a power of two: ten roots of one number."""


def is_sympy(value: object) -> bool:
    """Whether a value is a SymPy expression: never where SymPy is not loaded."""
    return "sympy" in sys.modules and isinstance(value, sys.modules["sympy"].Basic)


def from_sympy(value: Any, number: Callable[[fmpq], N]) -> N:
    """The exact number that a SymPy expression is, built from what `number` makes of rationals.

    Raises:
        SceneError: unless the expression is made of rationals, + - * /, and powers whose exponents have a power of two
            below the fraction bar.

    >>> import sympy
    >>> from .quantity import rational
    >>> from_sympy(sympy.sqrt(3) / 2, rational)
    Quantity('(1/2)*sqrt(3)')
    """
    sympy: Any = import_module("sympy")
    if isinstance(value, sympy.Float):
        return from_sympy(sympy.Rational(value), number)
    if isinstance(value, sympy.Rational) and value.q != 0:
        return number(fmpq(int(value.p), int(value.q)))
    if isinstance(value, sympy.Add):
        total, *parts = (from_sympy(argument, number) for argument in value.args)
        for part in parts:
            total = total + part
        return total
    if isinstance(value, sympy.Mul):
        product = number(fmpq(1))
        for argument in value.args:
            product = product * from_sympy(argument, number)
        return product
    if isinstance(value, sympy.Pow) and isinstance(value.exp, sympy.Rational):
        base = from_sympy(value.base, number)
        if value.exp.q == 1:
            return base ** int(value.exp)
        denominator = int(value.exp.q)
        if denominator & (denominator - 1) == 0 and denominator <= MAX_ROOTS:
            while denominator > 1:
                base, denominator = base.sqrt(), denominator // 2
            return base ** int(value.exp.p)
    raise SceneError(f"{shortened(str(value))!r} is not made of rationals and square roots")


# -- From exact numbers of every kind to those of one's own.


@runtime_checkable
class _Ratio(Protocol):
    """A number that is a ratio of whole numbers, such as a Decimal, or a float of numpy's."""

    def as_integer_ratio(self) -> tuple[int, int]: ...


def converted(value: Any, number: Callable[[fmpq], N]) -> N:
    """The exact number that `value` is, built from what `number` makes of rationals (see `Quantity.of`).

    Raises:
        SceneError: for what is no exact number.
    """
    if isinstance(value, bool):
        raise SceneError(f'{value!r} is not a number; write a whole number or text such as "9/4"')
    if isinstance(value, (int, fmpz)):
        return number(fmpq(value))
    if isinstance(value, str):
        return parse(value, number)
    if isinstance(value, fmpq):
        return number(value)
    if isinstance(value, float):
        if not isfinite(value):
            raise SceneError(f"{value!r} is not a finite number")
        return number(fmpq(*value.as_integer_ratio()))
    if isinstance(value, Rational):
        return number(fmpq(int(value.numerator), int(value.denominator)))
    if is_sympy(value):
        return from_sympy(value, number)
    if isinstance(value, _Ratio):
        try:
            numerator, denominator = value.as_integer_ratio()
        except (OverflowError, ValueError) as error:
            raise SceneError(f"{value!r} is not a finite number") from error
        return number(fmpq(int(numerator), int(denominator)))
    raise SceneError(
        f"{value!r} ({type(value).__name__}) is not an exact number; "
        'write a whole number, a Fraction, or text such as "sqrt(3)/2"'
    )
