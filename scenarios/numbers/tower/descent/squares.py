"""Squares among the whole numbers: factors, square parts, and products of radicands that are squares."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, TypeAlias

from flint import fmpz

from ....work import factor_units, gcd_units, product_units, sqrt_units
from ..ring import ONE, bit_length

FULL_FACTOR_BITS: Final = 100
"""Whole numbers up to here are factored completely: under 10 ms. Longer ones may stay composite,
which costs nothing but the beauty of the printed form (see `square_subset`)."""

TRIAL_PRIMES: Final = 1000
"""How many primes are tried on a longer number: 0.3 ms at 2,000 bits."""

Spend: TypeAlias = Callable[[int], None]
"""Counts work about to be done (see `Work.spend`)."""


def free(units: int) -> None:
    """Counts nothing."""


def factor(n: fmpz) -> list[tuple[fmpz, int]]:
    """Pairwise coprime factors of n > 0 with exponents; long ones may be composite."""
    if n.bit_length() <= FULL_FACTOR_BITS:
        return n.factor()
    factors: list[tuple[fmpz, int]] = []
    for f, e in n.factor(trial_limit=TRIAL_PRIMES):
        if f.bit_length() > FULL_FACTOR_BITS and f.is_square():
            factors.append((f.isqrt(), 2 * e))
        else:
            factors.append((f, e))
    return factors


def split_square(n: fmpz, spend: Spend = free) -> tuple[fmpz, list[fmpz]]:
    """(f, parts) with n = f**2 * product of parts; n > 0.

    The parts are square-free as far as the factorisation went.
    """
    bits = n.bit_length()
    spend(2 + factor_units(bits, complete=bits <= FULL_FACTOR_BITS) + sqrt_units(bits))
    root = ONE
    parts: list[fmpz] = []
    for f, e in factor(n):
        root *= f ** (e // 2)
        if e % 2:
            parts.append(f)
    return root, parts


def coprime_base(numbers: list[fmpz], spend: Spend = free) -> list[fmpz]:
    """Pairwise coprime numbers > 1 of which every given number is a product.

    By gcds alone (Bernstein, *Factoring into coprimes in essentially linear time*, 2005,
    in its plain quadratic form); nothing is factored.
    """
    base: list[fmpz] = []
    todo = [n for n in numbers if n > 1]
    while todo:
        n = todo.pop()
        bits = n.bit_length()
        for i, b in enumerate(base):
            spend(1 + gcd_units(bits, b.bit_length()))
            g = n.gcd(b)
            if g == 1:
                continue
            if n != b:
                del base[i]
                todo += [k for k in (b // g, g, n // g) if k > 1]
            break
        else:
            base.append(n)
    return base


def square_subset(n: fmpz, radicands: list[fmpz], spend: Spend = free) -> int | None:
    """The bits of a set of radicands whose product with n > 0 is a square, or None: there is none.

    Over a coprime base, a product is a square exactly if each base number that is not itself a
    square has an even exponent. So this is linear algebra modulo 2 and needs no factoring.

    >>> square_subset(fmpz(30), [fmpz(6), fmpz(10), fmpz(2)])
    7
    >>> square_subset(fmpz(7), [fmpz(6), fmpz(10), fmpz(2)]) is None
    True
    """
    if n.is_square():
        return 0
    base = [b for b in coprime_base([n, *radicands], spend) if not b.is_square()]
    base_bits = sum(map(bit_length, base))

    def parities(k: fmpz) -> int:
        spend(len(base) + 2 * product_units(k.bit_length(), base_bits))
        row = 0
        for i, b in enumerate(base):
            while k % b == 0:
                k //= b
                row ^= 1 << i
        return row

    pivots: dict[int, tuple[int, int]] = {}

    def reduce(row: int, used: int) -> tuple[int, int]:
        while row:
            pivot = pivots.get(row.bit_length())
            if pivot is None:
                break
            row ^= pivot[0]
            used ^= pivot[1]
        return row, used

    for i, m in enumerate(radicands):
        row, used = reduce(parities(m), 1 << i)
        if row:
            pivots[row.bit_length()] = (row, used)
    row, used = reduce(parities(n), 0)
    return None if row else used
