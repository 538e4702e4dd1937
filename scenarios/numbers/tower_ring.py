"""The ring Z[sqrt(m_1), ..., s_1, ...] in which towers of square roots compute, and the field that a tower spans."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final, TypeAlias

from flint import arb, fmpz

from ..work import Work, WorkSpent, gcd_units, product_units
from .precision import at_bits

# -- The ring Z[sqrt(m_1), ..., s_1, ...] in which towers compute: its values, and what is done to them one at a time.
#
# An integral value is one of
#
# - `fmpz`: a whole number;
# - `dict[int, fmpz]`: a sum of c * sqrt(product of the m_i with bit i set), not all bits 0;
# - `Nested`: a + b * s_k with b != 0, and a, b of lower level.
#
# Values are never changed once made, and no coefficient of a dict is zero. Products need the radicands: see
# `TowerField`.

ZERO: Final = fmpz(0)
ONE: Final = fmpz(1)
MINUS_ONE: Final = fmpz(-1)


class Nested:
    """The integral value a + b * s_level, with b not zero."""

    __slots__ = ("a", "b", "level")

    def __init__(self, level: int, a: Integral, b: Integral) -> None:
        self.level = level
        self.a = a
        self.b = b

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Nested) and self.level == other.level and self.b == other.b and self.a == other.a

    def __hash__(self) -> int:
        return hash((self.level, key(self.a), key(self.b)))


Integral: TypeAlias = fmpz | dict[int, fmpz] | Nested


def key(x: Integral) -> object:
    return frozenset(x.items()) if isinstance(x, dict) else x


def level_of(x: Integral) -> int:
    return x.level if isinstance(x, Nested) else 0


def nested(level: int, a: Integral, b: Integral) -> Integral:
    return Nested(level, a, b) if b else a


def surds(terms: dict[int, fmpz]) -> Integral:
    """Drop what is zero, and be a whole number where no root is left."""
    kept = {mask: c for mask, c in terms.items() if c}
    if not kept:
        return ZERO
    if len(kept) == 1 and 0 in kept:
        return kept[0]
    return kept


def add(x: Integral, y: Integral) -> Integral:
    if isinstance(x, fmpz) and isinstance(y, fmpz):
        return x + y
    if not x:
        return y
    if not y:
        return x
    p, q = level_of(x), level_of(y)
    if p or q:
        if p < q:
            x, y, p, q = y, x, q, p
        assert isinstance(x, Nested)
        if p > q:
            return Nested(p, add(x.a, y), x.b)
        assert isinstance(y, Nested)
        return nested(p, add(x.a, y.a), add(x.b, y.b))
    assert not isinstance(x, Nested)
    assert not isinstance(y, Nested)
    terms = dict(x) if isinstance(x, dict) else {0: x}
    for mask, c in y.items() if isinstance(y, dict) else ((0, y),):
        terms[mask] = terms.get(mask, ZERO) + c
    return surds(terms)


def scale(x: Integral, c: fmpz) -> Integral:
    """x * c for a whole c."""
    if isinstance(x, fmpz):
        return x * c
    if not c:
        return ZERO
    if isinstance(x, dict):
        return {mask: value * c for mask, value in x.items()}
    return Nested(x.level, scale(x.a, c), scale(x.b, c))


def negated(x: Integral) -> Integral:
    return scale(x, MINUS_ONE)


def subtract(x: Integral, y: Integral) -> Integral:
    return add(x, negated(y))


def coefficients(x: Integral) -> Iterator[fmpz]:
    if isinstance(x, fmpz):
        yield x
    elif isinstance(x, dict):
        yield from x.values()
    else:
        yield from coefficients(x.a)
        yield from coefficients(x.b)


def content(x: Integral, known: fmpz = ZERO) -> fmpz:
    """The greatest common divisor of `known` and all coefficients of x."""
    if isinstance(x, fmpz):
        return known.gcd(x)
    if isinstance(x, dict):
        for c in x.values():
            known = known.gcd(c)
            if known == 1:
                break
        return known
    known = content(x.a, known)
    return known if known == 1 else content(x.b, known)


def count_of(x: Integral) -> int:
    """How many coefficients x has."""
    if isinstance(x, dict):
        return len(x)
    return count_of(x.a) + count_of(x.b) if isinstance(x, Nested) else 1


def extent(x: Integral) -> tuple[int, int]:
    """How many coefficients x has, and how many bits they have together."""
    if isinstance(x, fmpz):
        return 1, x.bit_length()
    if isinstance(x, dict):
        return len(x), sum(map(bit_length, x.values()))
    count, bits = extent(x.a)
    more, further = extent(x.b)
    return count + more, bits + further


bit_length: Final = fmpz.bit_length


def divide(x: Integral, c: fmpz) -> Integral:
    """x / c for a whole c that divides every coefficient."""
    if c == 1:
        return x
    if isinstance(x, fmpz):
        return x // c
    if isinstance(x, dict):
        return {mask: value // c for mask, value in x.items()}
    return Nested(x.level, divide(x.a, c), divide(x.b, c))


def split_bit(x: dict[int, fmpz], bit: int) -> tuple[Integral, Integral]:
    """x as (terms without the root of m_bit, terms with it)."""
    flag = 1 << bit
    without = {mask: c for mask, c in x.items() if not mask & flag}
    return surds(without), surds({mask: c for mask, c in x.items() if mask & flag})


def masks_of(x: Integral) -> int:
    """All bits of the base that x uses, outside of radicands."""
    if isinstance(x, fmpz):
        return 0
    if isinstance(x, dict):
        union = 0
        for mask in x:
            union |= mask
        return union
    return masks_of(x.a) | masks_of(x.b)


def leaf_masks(x: Integral) -> Iterator[int]:
    """The sets of base radicands whose products have roots in x, outside of radicands."""
    if isinstance(x, dict):
        yield from x
    elif isinstance(x, Nested):
        yield from leaf_masks(x.a)
        yield from leaf_masks(x.b)


def span(masks: Iterable[int]) -> list[int]:
    """The reduced basis, modulo 2, of what the masks generate: the same for the same span."""
    basis: list[int] = []
    for mask in masks:
        for b in basis:
            mask = min(mask, mask ^ b)
        if mask:
            basis = sorted([*(min(b, b ^ mask) for b in basis), mask], reverse=True)
    return basis


# -- The field that a tower spans so far: its generators, counted arithmetic in its ring, signs and enclosures.

FIRST_BITS: Final = 64
"""Precision of the first ball of a sign test; doubled until the sign shows."""

SHORT_BITS: Final = 256
"""Up to this length of numbers the interpreter's part outweighs flint's, so that work is counted by numbers alone."""

LONG: Final = fmpz(1) << SHORT_BITS
LONG_NEGATIVE: Final = -LONG
"""Whole numbers that are not between these are long."""

SPENT: Final = "the work allowed is spent; allow more (--work)"
"""What `TowerLimit` says where a limit of work is met."""

TWO: Final = fmpz(2)


class TowerLimit(Exception):
    """The tower would become deeper, or its work longer, than the caller allowed."""


class TowerField:
    """The generators so far, and arithmetic with integral values in them.

    Attributes:
        work: counts what is done here, each step before it is taken; None counts nothing.
        base: the whole numbers m_i.
        base_product: the product of them all.
        coprime: whether they are pairwise coprime.
        radicands: D_1, D_2, ... of the nested generators.
        made: (whether nested, index) of each generator, in the order of making.
    """

    def __init__(self, work: Work | None) -> None:
        self.work = work
        self.base: list[fmpz] = []
        self.base_product = ONE
        self.coprime = True
        self.radicands: list[Integral] = []
        self.made: list[tuple[bool, int]] = []
        self._products: dict[int, fmpz] = {0: ONE}
        self._frames: dict[int, Frame] = {}

    def add_base(self, m: fmpz) -> Integral:
        """The root of m > 1, known not to be a square in the whole field.

        It may be put below the nested generators: with it the degree over Q doubles, so every
        step of the tower in its new order is still of degree two.
        """
        self.spend(1 + gcd_units(m.bit_length(), self.base_product.bit_length()))
        self.base.append(m)
        self.made.append((False, len(self.base) - 1))
        self.coprime = self.coprime and m.gcd(self.base_product) == 1
        self.base_product *= m
        return {1 << (len(self.base) - 1): ONE}

    def add_nested(self, radicand: Integral) -> Integral:
        """The root of a positive number, known not to be a square in the whole field."""
        self.radicands.append(radicand)
        self.made.append((True, len(self.radicands) - 1))
        return Nested(len(self.radicands), ZERO, ONE)

    # -- counting work

    def spend(self, units: int) -> None:
        """Counts work about to be done here; hot places ask first whether it is counted at all."""
        if self.work is not None:
            try:
                self.work.spend(units)
            except WorkSpent:
                raise TowerLimit(SPENT) from None

    def spend_scaling(self, x: Integral, bits: int) -> None:
        """Counts the product, or half the quotient, of x with a whole number of more than a few words."""
        count, total = extent(x)
        self.spend(count * (1 + product_units(total // count, bits)))

    def content(self, x: Integral, known: fmpz = ZERO) -> fmpz:
        """`content`, counted. Once what is known gets short, it costs little to go on."""
        if self.work is None:
            return content(x, known)
        if isinstance(x, fmpz):
            self.spend(gcd_units(known.bit_length(), x.bit_length()))
            return known.gcd(x)
        count, total = extent(x)
        if (known.bit_length() or total // count) <= SHORT_BITS:
            self.spend(1 + (count >> 2) + 2 * product_units(total, SHORT_BITS))
            return content(x, known)
        for c in coefficients(x):
            self.spend(1 + gcd_units(known.bit_length(), c.bit_length()))
            known = known.gcd(c)
            if known == 1:
                break
        return known

    def spend_product(self, x: dict[int, fmpz], y: dict[int, fmpz]) -> None:
        """Counts the product of two sums: of each term of one with each of the other."""
        rows, columns = len(x), len(y)
        units = 1 + (rows * columns >> 1)
        long, wide = sum(map(bit_length, x.values())), sum(map(bit_length, y.values()))
        if long > SHORT_BITS or wide > SHORT_BITS:
            long //= rows
            wide //= columns
            common = self.base_product.bit_length()
            units += rows * columns * (product_units(long, wide) + product_units(long + wide, common) // 2)
        self.spend(units)

    def quotient(self, x: Integral, c: fmpz) -> Integral:
        """`divide`, counted."""
        if self.work is not None and (bits := c.bit_length()) > SHORT_BITS:
            self.spend_scaling(x, bits)
            self.spend_scaling(x, bits)
        return divide(x, c)

    # -- arithmetic

    def product(self, mask: int) -> fmpz:
        """The product of the base radicands in mask."""
        known = self._products.get(mask)
        if known is None:
            low = mask & -mask
            known = self.product(mask ^ low) * self.base[low.bit_length() - 1]
            if self.work is not None and known > LONG:
                self.spend(1 + product_units(known.bit_length(), SHORT_BITS))
            self._products[mask] = known
        return known

    def mul(self, x: Integral, y: Integral) -> Integral:
        if isinstance(x, fmpz):
            if (x > LONG or x < LONG_NEGATIVE) and self.work is not None:
                self.spend_scaling(y, x.bit_length())
            return scale(y, x)
        if isinstance(y, fmpz):
            if (y > LONG or y < LONG_NEGATIVE) and self.work is not None:
                self.spend_scaling(x, y.bit_length())
            return scale(x, y)
        if isinstance(x, dict):
            if isinstance(y, dict):
                return self.mul_surds(x, y)
            return Nested(y.level, self.mul(y.a, x), self.mul(y.b, x))
        if isinstance(y, dict) or x.level > y.level:
            return Nested(x.level, self.mul(x.a, y), self.mul(x.b, y))
        if x.level < y.level:
            return Nested(y.level, self.mul(y.a, x), self.mul(y.b, x))
        if self.work is not None:
            self.spend(4)
        mul = self.mul
        radicand = self.radicands[x.level - 1]
        a, b, c, d = x.a, x.b, y.a, y.b
        high = mul(b, d)
        if not a or not c or isinstance(b, fmpz) or isinstance(d, fmpz):
            low = mul(a, c)
            cross = add(mul(a, d), mul(b, c))
        elif x is y:
            low = mul(a, a)
            cross = scale(mul(a, b), TWO)
        else:  # Karatsuba
            low = mul(a, c)
            cross = subtract(mul(add(a, b), add(c, d)), add(low, high))
        return nested(x.level, add(low, mul(high, radicand)), cross)

    def mul_surds(self, x: dict[int, fmpz], y: dict[int, fmpz]) -> Integral:
        if self.work is not None:
            self.spend_product(x, y)
        terms: dict[int, fmpz] = {}
        for p, c in x.items():
            for q, d in y.items():
                term = c * d
                if p & q:
                    term *= self.product(p & q)
                mask = p ^ q
                terms[mask] = terms[mask] + term if mask in terms else term
        return surds(terms)

    def inverse(self, x: Integral) -> tuple[Integral, fmpz]:
        """(y, d) with 1 / x = y / d, for x != 0; d > 0 has no factor common to all of y."""
        if isinstance(x, fmpz):
            return (ONE, x) if x > 0 else (MINUS_ONE, -x)
        common = self.content(x)
        if common != 1:
            x = self.quotient(x, common)
        assert not isinstance(x, fmpz)
        if isinstance(x, dict):
            a, y = split_bit(x, max(x).bit_length() - 1)
            norm = subtract(self.mul(a, a), self.mul(y, y))
            conjugate = subtract(a, y)
        else:
            square = self.mul(self.mul(x.b, x.b), self.radicands[x.level - 1])
            norm = subtract(self.mul(x.a, x.a), square)
            conjugate = Nested(x.level, x.a, negated(x.b))
        inverse, d = self.inverse(norm)
        product = self.mul(conjugate, inverse)
        d *= common
        g = self.content(product, d)
        return self.quotient(product, g), d // g

    # -- enclosures

    def sign(self, x: Integral) -> int:
        """-1, 0 or +1; a ball at rising precision decides what is not zero by its form."""
        if isinstance(x, fmpz):
            return (x > 0) - (x < 0)
        bits = FIRST_BITS
        while True:
            value = self.ball(x, bits)
            if value > 0:
                return 1
            if value < 0:
                return -1
            bits *= 2

    def ball(self, x: Integral, precision: int) -> arb:
        """x computed once at that working precision, however inaccurate."""
        frame = self._frames.get(precision)
        if frame is None:
            frame = self._frames[precision] = Frame(self, precision)
        with at_bits(precision):
            return frame.value(x)

    def accurate_ball(self, x: Integral, bits: int) -> arb:
        """x to a relative accuracy of about `bits`."""
        if not x:
            return arb(0)
        precision = bits + 16
        while True:
            value = self.ball(x, precision)
            if value.rel_accuracy_bits() >= bits:
                return value
            precision *= 2


class Frame:
    """The generators of a field as balls of one precision."""

    __slots__ = ("_field", "_nested", "_precision", "_roots", "_units")

    def __init__(self, field: TowerField, precision: int) -> None:
        self._field = field
        self._precision = precision
        self._units = 1 + 2 * product_units(precision, precision)  # of two terms
        self._roots: dict[int, arb] = {0: arb(1)}
        self._nested: dict[int, arb] = {}

    def value(self, x: Integral) -> arb:
        if isinstance(x, fmpz):
            return arb(x)
        if isinstance(x, dict):
            if self._field.work is not None:
                self._field.spend(len(x) * self._units >> 1)
            total = arb(0)
            for mask, c in x.items():
                total += self._root(mask) * c
            return total
        if self._field.work is not None:
            self._field.spend(self._units)
        return self.value(x.a) + self.value(x.b) * self._generator(x.level)

    def _root(self, mask: int) -> arb:
        known = self._roots.get(mask)
        if known is None:
            self._field.spend(2 * self._units)
            known = self._roots[mask] = arb(self._field.product(mask)).sqrt()
        return known

    def _generator(self, level: int) -> arb:
        """s_level; its radicand is made accurate first, for it may cancel nearly to zero."""
        known = self._nested.get(level)
        if known is None:
            radicand = self._field.radicands[level - 1]
            self._field.spend(2 * self._units)
            known = self._field.accurate_ball(radicand, self._precision).sqrt()
            self._nested[level] = known
        return known
