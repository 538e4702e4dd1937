"""Reads exact numbers from text and from SymPy, by whitelist: never eval."""

from __future__ import annotations

import re
from typing import Any, NamedTuple

from flint import fmpq, fmpz  # type: ignore[attr-defined]

from ..errors import SceneError
from .quantity import Quantity

MAX_LENGTH = 20_000
"""Longest text of one number, in characters: ten times what any scene needs, read in a millisecond."""

MAX_DEPTH = 60
"""Deepest nesting of parentheses and roots."""

MAX_EXPONENT = 10_000
"""Largest power and largest decimal exponent."""

MAX_ROOTS = 1 << 10
"""Largest denominator of a SymPy exponent, a power of two: ten roots of one number."""

MAX_BITS = 1 << 20
"""Largest size of a rational result: a power tower built of allowed powers stops here."""

MAX_TERMS = 200
"""Most numbers that an expression with roots may hold: its tree is walked by recursion."""

SHOWN = 60
"""How much of a bad text an error repeats."""

TOKEN = re.compile(
    r"\s*(?:(?P<number>\d+(?:\.\d*)?(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?)"
    r"|(?P<name>[A-Za-z_]\w*)|(?P<op>\*\*|[-+*/()]))",
    re.ASCII,
)


class Token(NamedTuple):
    kind: str
    text: str
    place: int


def shown(text: str) -> str:
    """A bad text as an error repeats it: quoted and cut.

    >>> shown("1" * 100)[:20] + "..."
    "'1111111111111111111..."
    """
    return repr(text if len(text) <= SHOWN else f"{text[:SHOWN]}... ({len(text)} characters)")


def parse_quantity(text: str) -> Quantity:
    """The exact number that `text` spells.

    Grammar: whole numbers, decimals (`0.1` is one tenth, `1e-40` is exact too), `+ - * /`, integer powers
    with `**`, `sqrt(...)` of a non-negative value, parentheses. Nothing else, and nothing is evaluated by
    Python.

    Raises:
        SceneError: naming the text, the place and the reason.

    >>> parse_quantity("-(1 + sqrt(5))/2")
    Quantity('(-1)*(1 + sqrt(5))/2')
    >>> float(parse_quantity("10**-40"))
    1e-40
    """
    if len(text) > MAX_LENGTH:
        raise SceneError(f"{shown(text)}: too long for one number; at most {MAX_LENGTH} characters")
    return _Parser(text).parse()


class _Parser:
    """Recursive descent over the tokens of one number."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.tokens = self._tokens()
        self.at = 0
        self.depth = 0

    def refuse(self, reason: str) -> SceneError:
        return SceneError(f"{shown(self.text)} is not an exact number: {reason}")

    def _tokens(self) -> list[Token]:
        tokens: list[Token] = []
        place = 0
        end = len(self.text.rstrip())
        while place < end:
            match = TOKEN.match(self.text, place)
            if match is None or match.end() == place:
                rest = self.text[place:].lstrip()
                raise self.refuse(f"{rest[:1]!r} is not allowed; use digits, + - * / **, sqrt() and parentheses")
            kind = str(match.lastgroup)
            tokens.append(Token(kind, match.group(kind), match.start(kind)))
            place = match.end()
        return tokens

    def peek(self) -> str:
        return self.tokens[self.at].text if self.at < len(self.tokens) else ""

    def take(self) -> Token:
        token = self.tokens[self.at]
        self.at += 1
        return token

    def parse(self) -> Quantity:
        if not self.tokens:
            raise self.refuse("it is empty")
        value = self.sum()
        if self.at < len(self.tokens):
            raise self.refuse(f"{self.peek()!r} is not expected there")
        return value

    def bounded(self, value: Quantity) -> Quantity:
        if value.rational is not None and value.rational.height_bits() > MAX_BITS:
            raise self.refuse(f"it has more than {MAX_BITS} bits")
        if value.size > MAX_TERMS:
            raise self.refuse(f"it has more than {MAX_TERMS} terms")
        return value

    def sum(self) -> Quantity:
        value = self.product()
        while self.peek() in ("+", "-"):
            operator = self.take().text
            right = self.product()
            value = self.bounded(value + right if operator == "+" else value - right)
        return value

    def product(self) -> Quantity:
        value = self.signed()
        while self.peek() in ("*", "/"):
            operator = self.take().text
            right = self.signed()
            if operator == "/" and right.sign() == 0:
                raise self.refuse("division by zero")
            value = self.bounded(value * right if operator == "*" else value / right)
        return value

    def signed(self) -> Quantity:
        negative = False
        while self.peek() in ("+", "-"):
            negative ^= self.take().text == "-"
        value = self.power()
        return -value if negative else value

    def power(self) -> Quantity:
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

    def atom(self) -> Quantity:
        if self.at >= len(self.tokens):
            raise self.refuse("it ends too early")
        token = self.take()
        if token.kind == "number":
            return Quantity("q", (), self.decimal(token.text))
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

    def inside(self) -> Quantity:
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


def quantity_from_sympy(value: Any) -> Quantity:
    """The exact number that a SymPy expression is.

    Raises:
        SceneError: unless the expression is made of rationals, + - * /, and powers whose exponents have a power of two
            below the fraction bar.

    >>> import sympy
    >>> quantity_from_sympy(sympy.sqrt(3) / 2) == Quantity.of("sqrt(3)/2")
    True
    """
    import sympy

    if isinstance(value, sympy.Float):
        return quantity_from_sympy(sympy.Rational(value))
    if isinstance(value, sympy.Rational) and value.q != 0:
        return Quantity.of(int(value.p)) / int(value.q)
    if isinstance(value, sympy.Add):
        parts = [quantity_from_sympy(argument) for argument in value.args]
        return sum(parts[1:], parts[0])
    if isinstance(value, sympy.Mul):
        product = Quantity.of(1)
        for argument in value.args:
            product = product * quantity_from_sympy(argument)
        return product
    if isinstance(value, sympy.Pow) and isinstance(value.exp, sympy.Rational):
        base = quantity_from_sympy(value.base)
        if value.exp.q == 1:
            return base ** int(value.exp)
        denominator = int(value.exp.q)
        if denominator & (denominator - 1) == 0 and denominator <= MAX_ROOTS:
            while denominator > 1:
                base, denominator = base.sqrt(), denominator // 2
            return base ** int(value.exp.p)
    raise SceneError(f"{shown(str(value))} is not made of rationals and square roots")
