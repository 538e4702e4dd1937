"""The sign of a SymPy number made of rationals, + - * / and square roots, decided rigorously.

First by enclosures in interval arithmetic. A number that these cannot tell from zero is proved
to be zero, or not, by squaring: A + B s, with s = sqrt(E), is zero just if A and B s have opposite
signs and A**2 = B**2 E, which is a question with one root less.

Nothing here is shared with the number systems of the exact engine, whose oracle this is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from threading import local
from typing import Any

from mpmath.ctx_iv import MPIntervalContext
from sympy import QQ, Add, Expr, Mul, Pow, Rational, Symbol, fraction, ring, sqrt, sqrtdenest
from sympy import together as on_one_denominator
from sympy.core.evalf import PrecisionExhausted

from ...scenarios.numbers.quantity import Quantity

ENCLOSURE_BITS = (64, 128, 256)
"""Precisions tried before a proof of zero is; 256 bits are 77 digits."""

MAX_BITS = 1 << 16
"""A number proved not to be zero is enclosed to at most so many bits."""

MAX_TERMS = 20_000
"""Squaring doubles degrees; with more terms than this the question is given up as undecided."""


class SymbolicUndecided(ArithmeticError):
    """The sign of a number could not be proved within the budget of terms or bits."""


def sign(number: Any) -> int:
    """-1, 0 or +1.

    Raises:
        SymbolicUndecided: beyond `MAX_TERMS` or `MAX_BITS`.

    >>> sign(sqrt(2) + sqrt(3) - sqrt(5 + 2*sqrt(6))), sign(sqrt(2) - Rational(141421356, 10**8))
    (0, 1)
    """
    if number.is_Rational:
        return bool(number > 0) - bool(number < 0)
    roots = Roots.of(number)
    return roots.sign(roots.polynomial(number))


def normal(number: Any) -> Expr:
    """The same number, expanded, each root at most once in a product and none in a denominator.

    Equal numbers get the same form if no root is a combination of the others.

    Raises:
        SymbolicUndecided: as `sign` does.

    >>> normal((1 + sqrt(2)) / (3 - sqrt(2)))
    5/7 + 4*sqrt(2)/7
    """
    if number.is_Rational:
        return number
    roots = Roots.of(number)
    return roots.expression(roots.polynomial(number))


def root(radicand: Any) -> Expr:
    """The square root of a number known not to be negative, denested where SymPy can.

    Raises:
        SymbolicUndecided: for a number so long that SymPy, which looks for its factors, fails.

    >>> root(3 + 2*sqrt(2))
    1 + sqrt(2)
    """
    try:
        return sqrtdenest(sqrt(radicand))
    except OverflowError as error:
        raise SymbolicUndecided(f"SymPy cannot take the root of so long a number: {error}") from error


def quantity(number: Any) -> Quantity:
    """A number as the exact quantity that trajectories hold.

    >>> quantity(sqrt(sqrt(3)) / 2) == Quantity.of("sqrt(sqrt(3))/2")
    True
    """
    roots = Roots.of(number)
    values: list[Quantity] = []

    def value(polynomial: Any) -> Quantity:
        total = Quantity.of(0)
        for exponents, coefficient in polynomial.terms():
            term = Quantity.of(int(coefficient.numerator)) / int(coefficient.denominator)
            for root, exponent in zip(values, exponents, strict=False):
                term = term * root if exponent else term
            total = total + term
        return total

    for radicand in roots.radicands:
        values.append(value(radicand).sqrt())  # noqa: PERF401  each rests on those before
    return value(roots.polynomial(number))


def enclosure(number: Any, bits: int) -> tuple[Any, Any]:
    """Two mpmath numbers between which a number lies, computed with so many bits."""
    roots = Roots.of(number)
    found = roots.enclose(roots.polynomial(number), bits)
    return found.a, found.b


class _Context(local):
    """The intervals of mpmath, made once for each thread, which sets their precision; a sign costs less than that."""

    def __init__(self) -> None:
        self.iv: Any = MPIntervalContext()


_CONTEXT = _Context()


class Roots:
    """The square roots s_0, s_1, ... that occur in a number, inner ones first.

    Numbers in them are polynomials of degree at most 1 in each, with rational coefficients.

    Attributes:
        bases: each root as (base, k), the 2**k-th root of base, since SymPy merges sqrt(sqrt(3)) to 3**(1/4).
        radicands: their squares, as polynomials in the roots before.
    """

    def __init__(self, bases: list[tuple[Any, int]]) -> None:
        self.bases = bases
        self.ring: Any = ring([Symbol(f"s_{k}") for k in range(len(bases))] or [Symbol("s_0")], QQ)[0]
        self.radicands: list[Any] = []
        self._enclosures: dict[int, list[Any]] = {}
        for base, level in bases:
            known = self.polynomial(base) if level == 1 else self._generator(base, level - 1)
            self.radicands.append(known)

    @staticmethod
    def of(number: Any) -> Roots:
        """The roots in a number."""
        powers = number.atoms(type(sqrt(Symbol("x"))))
        bases = {(part.base, k) for part in powers for k in range(1, _level_of_root(part) + 1)}
        return Roots(sorted(bases, key=lambda root: (_depth(root[0]), root[1], root[0].sort_key())))

    def _generator(self, base: Any, level: int) -> Any:
        return self.ring.gens[self.bases.index((base, level))]

    def polynomial(self, number: Any) -> Any:
        """A number in these roots as a polynomial in them.

        Raises:
            SymbolicUndecided: for a number that holds anything but rationals and roots.
            ZeroDivisionError: for a division by zero.
        """
        if number.is_Rational:
            return self.ring(QQ(int(number.p), int(number.q)))
        if isinstance(number, Add):
            return sum((self.polynomial(part) for part in number.args), self.ring.zero)
        if isinstance(number, Mul):
            product = self.ring.one
            for part in number.args:
                product = self._reduced(product * self.polynomial(part))
            return product
        level = _level_of_root(number)
        if level or (number.is_Pow and number.exp.is_Integer):
            value = self._generator(number.base, level) if level else self.polynomial(number.base)
            exponent = int(number.exp * 2**level)
            if exponent < 0:
                value = self._inverse(value)
            power = self.ring.one
            for _ in range(abs(exponent)):
                power = self._reduced(power * value)
            return power
        raise SymbolicUndecided(f"{number} is not made of rationals and square roots")

    def expression(self, polynomial: Any) -> Expr:
        """A polynomial in the roots as a SymPy number."""
        total = []
        for exponents, coefficient in polynomial.terms():
            used = (root for root, exponent in zip(self.bases, exponents, strict=False) if exponent)
            factors = [Pow(base, Rational(1, 2**level)) for base, level in used]
            total.append(Mul(Rational(int(coefficient.numerator), int(coefficient.denominator)), *factors))
        return Add(*total)

    def sign(self, polynomial: Any) -> int:
        """The sign of a polynomial in the roots.

        Raises:
            SymbolicUndecided: beyond `MAX_TERMS` or `MAX_BITS`.
        """
        if len(polynomial) == 0:
            return 0
        for bits in ENCLOSURE_BITS:
            found = self._certain_sign(polynomial, bits)
            if found:
                return found
        if self._vanishes(polynomial):
            return 0
        bits = ENCLOSURE_BITS[-1]
        while bits < MAX_BITS:
            bits *= 2
            found = self._certain_sign(polynomial, bits)
            if found:
                return found
        raise SymbolicUndecided(f"a number that is not 0 cannot be distinguished from 0 by {MAX_BITS} bits")

    def enclose(self, polynomial: Any, bits: int) -> Any:
        """An mpmath interval that holds the value of a polynomial in the roots."""
        iv = _CONTEXT.iv
        iv.prec = bits
        roots = self._enclosures.setdefault(bits, [])
        for radicand in self.radicands[len(roots) :]:
            under = self._value(radicand, roots)
            roots.append(iv.sqrt(iv.mpf([max(under.a, 0), max(under.b, 0)])))  # radicands are never negative
        return self._value(polynomial, roots)

    def _value(self, polynomial: Any, roots: list[Any]) -> Any:
        iv = _CONTEXT.iv
        total = iv.mpf(0)
        for exponents, coefficient in polynomial.terms():
            term = iv.mpf(int(coefficient.numerator)) / int(coefficient.denominator)
            for value, exponent in zip(roots, exponents, strict=False):
                if exponent:
                    term *= value**exponent
            total += term
        return total

    def _certain_sign(self, polynomial: Any, bits: int) -> int:
        """+1 or -1 if an enclosure of so many bits shows it, else 0."""
        found = self.enclose(polynomial, bits)
        return bool(found.a > 0) - bool(found.b < 0)

    def _reduced(self, polynomial: Any) -> Any:
        """The same value, with s_k**2 replaced by its radicand."""
        for k in reversed(range(len(self.radicands))):
            if polynomial.degree(self.ring.gens[k]) < 2:
                continue
            by_power: dict[int, Any] = {}
            for exponents, coefficient in polynomial.terms():
                half, odd = divmod(exponents[k], 2)
                rest = self.ring({(*exponents[:k], odd, *exponents[k + 1 :]): coefficient})
                by_power[half] = by_power.get(half, self.ring.zero) + rest
            polynomial = sum((part * self.radicands[k] ** half for half, part in by_power.items()), self.ring.zero)
        if len(polynomial) > MAX_TERMS:
            raise SymbolicUndecided(f"a number with {len(self.bases)} nested roots needs over {MAX_TERMS} terms")
        return polynomial

    def _split(self, polynomial: Any) -> tuple[int, Any, Any] | None:
        """(k, A, B) with the polynomial = A + B s_k, where s_k is its last root; None without a root."""
        last = max((k for monomial in polynomial.monoms() for k, e in enumerate(monomial) if e), default=None)
        if last is None:
            return None
        parts = [self.ring.zero, self.ring.zero]
        for exponents, coefficient in polynomial.terms():
            rest = (*exponents[:last], 0, *exponents[last + 1 :])
            parts[exponents[last]] += self.ring({rest: coefficient})
        return last, parts[0], parts[1]

    def _vanishes(self, polynomial: Any) -> bool:
        split = self._split(polynomial)
        if split is None:
            return not polynomial
        k, a, b = split
        sign_b = self.sign(b)
        sign_a = self.sign(a)
        if sign_b == 0:
            return sign_a == 0
        if sign_a == 0:
            return self.sign(self.radicands[k]) == 0
        return sign_a != sign_b and self.sign(self._reduced(a**2 - b**2 * self.radicands[k])) == 0

    def _inverse(self, polynomial: Any) -> Any:
        over = self.ring.one
        while (split := self._split(polynomial)) is not None:
            k, a, b = split
            conjugate = a - b * self.ring.gens[k]
            if self.sign(conjugate) == 0:  # the root is a combination of earlier ones: A + B s = 2 A
                polynomial = 2 * a
                continue
            over = self._reduced(over * conjugate)
            polynomial = self._reduced(a**2 - b**2 * self.radicands[k])
        constant = polynomial.coeff(1)
        if not constant:
            raise ZeroDivisionError("division by a number that is exactly zero")
        return over.mul_ground(1 / constant)


def above(number: Any) -> Any:
    """A fraction at or just above a number."""
    return -below(-number)


def below(number: Any) -> Any:
    """A fraction at or just below a number: itself, where it is one.

    Raises:
        SymbolicUndecided: where SymPy does not give sixty digits of it.
    """
    if number.is_Rational:
        return number
    try:
        near = Rational(number.evalf(60, strict=True))
    except PrecisionExhausted:
        raise SymbolicUndecided("a number cancels by more digits than SymPy follows") from None
    return near - abs(near) / 10**40


def smallest(times: Sequence[Any]) -> Any:
    """The smallest number, by proved signs; None of none."""
    found = None
    for time in times:
        if found is None or sign(time - found) < 0:
            found = time
    return found


def _level_of_root(part: Any) -> int:
    """k if a number is a power with an exponent m / 2**k in lowest terms, else 0."""
    if not (part.is_Pow and part.exp.is_Rational):
        return 0
    below = int(part.exp.q)
    return below.bit_length() - 1 if below & (below - 1) == 0 else 0


def _depth(number: Any) -> int:
    """How deep square roots are nested in a number."""
    return max((_depth(part) for part in number.args), default=0) + _level_of_root(number)


# -- The derived laws as SymPy gave them, evaluated at numbers: nothing rearranged, every filter decided.
#
# The article substitutes numbers into the solutions and filters out what is complex, nan or infinite. With nested
# roots SymPy may leave a zero unrecognised in a denominator, and give nonsense for nan; so the radicand and the
# denominator of each solution are looked at first, and their signs decided.

_ROOT = Symbol("root")


@dataclass(frozen=True)
class Solution:
    """A derived expression taken apart: over / under, in which `_ROOT` stands for sqrt(radicand).

    Attributes:
        over: numerator.
        under: denominator.
        radicand: what the square root is taken of, over its own denominator; None without a root.
    """

    over: Any
    under: Any
    radicand: tuple[Any, Any] | None

    @staticmethod
    def of(expression: Any) -> Solution:
        """Takes an expression with at most one square root apart.

        >>> from sympy.abc import x, y
        >>> Solution.of((1 - sqrt(x)) / y).radicand
        (x, 1)
        """
        half_powers = {part for part in expression.atoms(type(sqrt(Symbol("x")))) if part.exp.q == 2}
        bases = {part.base for part in half_powers}
        if not bases:
            return Solution(*fraction(on_one_denominator(expression)), None)
        (base,) = bases
        rational = expression.xreplace({part: _ROOT ** (2 * part.exp) for part in half_powers})
        return Solution(*fraction(on_one_denominator(rational)), fraction(on_one_denominator(base)))

    def value(self, at: Mapping[Any, Any]) -> Expr | None:
        """The number that the solution takes, or None where it is complex, nan or infinite."""
        at = self._with_root(at)
        if at is None:
            return None
        under = normal(self.under.xreplace(at))
        if sign(under) == 0:
            return None
        return normal(self.over.xreplace(at) / under)

    def sign(self, at: Mapping[Any, Any]) -> int | None:
        """The sign of that number, without computing it; None where it is complex, nan or infinite."""
        at = self._with_root(at)
        if at is None:
            return None
        under = sign(normal(self.under.xreplace(at)))
        return under * sign(normal(self.over.xreplace(at))) if under else None

    def _with_root(self, at: Mapping[Any, Any]) -> Any:
        if self.radicand is None:
            return at
        over, under = (normal(part.xreplace(at)) for part in self.radicand)
        if sign(under) == 0:
            return None
        radicand = normal(over / under)
        if sign(radicand) < 0:
            return None
        return {**at, _ROOT: root(radicand)}
