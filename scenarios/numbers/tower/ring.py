"""The ring Z[sqrt(m_1), ..., s_1, ...] in which towers compute: its values, and what is done to them one at a time.

An integral value is one of

- `fmpz`: a whole number;
- `dict[int, fmpz]`: a sum of c * sqrt(product of the m_i with bit i set), not all bits 0;
- `Nested`: a + b * s_k with b != 0, and a, b of lower level.

Values are never changed once made, and no coefficient of a dict is zero. Products need the radicands: see `Field`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final, TypeAlias

from flint import fmpz

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
