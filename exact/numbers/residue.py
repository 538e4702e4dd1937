"""Residues: a scene's numbers modulo a large random prime, through `flint.fmpz_mod`.

A field of real numbers K has a homomorphism to the integers modulo a prime p wherever the roots that
generate it can be chosen modulo p (its domain are the numbers whose denominators p does not divide). Zero
goes to zero. So a number that is not zero modulo p is not zero; and one that is not zero is zero modulo few
primes (see `heights`).
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Sequence
from typing import Any, TypeAlias

from flint import fmpq, fmpz, fmpz_mod_ctx  # type: ignore[attr-defined]
from flint.utils.flint_exceptions import DomainError

from ...scenarios.tower import Element, Nested, Place, Tower
from .field import FieldNumber

Residue: TypeAlias = Any
"""`flint.fmpz_mod`."""

SMALL_PRIMES = fmpz.primorial_ui(2000)  # type: ignore[arg-type]
"""Product of the primes up to 2,000: one gcd spares nine of ten tests for primality."""

BATCH = 64
"""Candidates drawn from one choice of residues, so that the choice costs little beside them."""

WITNESSES = 80
"""Rounds of Miller and Rabin's test: a composite number passes all with a chance of at most 4**-80."""


class Candidates:
    """Random odd numbers; if one is a prime, then modulo it the given whole numbers are squares.

    A candidate n is r + M t. M is 8 times the product of the odd coprime factors c of the whole numbers; r
    is 7 modulo 8, and random modulo each c with Jacobi symbol (r/c) = 1 if c is 1 modulo 4, else -1; t is
    uniform in [2**k, 2**(k + 1)). By reciprocity (2/n) = 1 and (c/n) = 1; and as n is 3 modulo 4, a root
    modulo n is one power. Every number of the set {r + M t} is as likely as any other, and it has at least
    2**log2_size elements: 2**k for t, and for each c phi(c) / 2 for r, where phi(c) >= c / L with L the bit
    length of c (an odd c has fewer than L distinct prime factors, the i-th is at least i + 1, and the
    product of 1 - 1/(i + 1) telescopes).

    Args:
        squares: positive whole numbers that shall be squares.
        log2_size: how many numbers the candidates shall be drawn from, at the least.
        rng: where randomness comes from.

    >>> some = Candidates([fmpz(12), fmpz(15)], 64, random.Random(1))
    >>> p = some.prime(limit=10_000)
    >>> fmpz(3).jacobi(p), fmpz(5).jacobi(p)
    (1, 1)
    """

    def __init__(self, squares: Iterable[fmpz], log2_size: int, rng: random.Random) -> None:
        self._rng = rng
        self._parts = coprime_parts(squares)
        self._modulus = fmpz(8)
        size = 0
        for c in self._parts:
            self._modulus *= c
            size += c.bit_length() - 2 - c.bit_length().bit_length()
        self._spread = max(log2_size - size, 32)
        self.log2_size = self._spread + size
        self.bits = self._modulus.bit_length() + self._spread + 1
        self.drawn = 0
        self._start = fmpz(7)

    def _choose(self) -> None:
        """A random r, put together by the Chinese remainder theorem."""
        start, modulus = fmpz(7), fmpz(8)
        for c in self._parts:
            wanted = 1 if c % 4 == 1 else -1
            while True:
                r = fmpz(self._rng.randrange(1, int(c)))
                if r.jacobi(c) == wanted:
                    break
            start += modulus * ((r - start) * pow(modulus, -1, c) % c)
            modulus *= c
        self._start = start

    def prime(self, limit: int) -> fmpz | None:
        """The next candidate that passes a test for primality; None if `limit` have been drawn in all."""
        lead = 1 << self._spread
        while self.drawn < limit:
            if self.drawn % BATCH == 0:
                self._choose()
            self.drawn += 1
            n = self._start + self._modulus * (self._rng.getrandbits(self._spread) | lead)
            if n.gcd(SMALL_PRIMES) == 1 and n.is_probable_prime():
                return n
        return None


def coprime_parts(numbers: Iterable[fmpz]) -> list[fmpz]:
    """Pairwise coprime odd non-squares > 1; the given numbers are products of them, of twos and squares.

    >>> sorted(coprime_parts([fmpz(15), fmpz(21), fmpz(8), fmpz(49)]))
    [3, 5, 7]
    """
    base: list[fmpz] = []
    todo = [n >> _twos(n) for n in numbers]
    while todo:
        n = todo.pop()
        if n == 1:
            continue
        if n.is_square():
            todo.append(n.isqrt())
            continue
        for i, b in enumerate(base):
            g = n.gcd(b)
            if g != 1:
                if n != b:
                    del base[i]
                    todo += [b // g, g, n // g]
                break
        else:
            base.append(n)
    return base


def _twos(n: fmpz) -> int:
    """How often 2 divides n > 0."""
    return int(n & -n).bit_length() - 1


def passes_witnesses(n: fmpz, rng: random.Random) -> bool:
    """Whether an odd n > 3 passes `WITNESSES` rounds of the Miller-Rabin test with random bases.

    Source: M. O. Rabin, *Probabilistic algorithm for testing primality* (J. Number Theory 12, 1980).

    >>> passes_witnesses(fmpz(2**127 - 1), random.Random(1)), passes_witnesses(fmpz(561), random.Random(1))
    (True, False)
    """
    twos = _twos(n - 1)
    odd = (n - 1) >> twos
    for _ in range(WITNESSES):
        x = pow(fmpz(rng.randrange(2, int(n) - 1)), odd, n)
        if x in (1, n - 1):
            continue
        for _ in range(twos - 1):
            x = x * x % n
            if x == n - 1:
                break
        else:
            return False
    return True


class Residues:
    """The numbers of a tower modulo a prime, and square roots modulo it.

    Args:
        modulus: the prime.
        place: a homomorphism to its residues from the tower's elements in use.
    """

    def __init__(self, modulus: fmpz, place: Place | None) -> None:
        self.modulus = modulus
        self._place = place
        self._make = fmpz_mod_ctx(modulus)
        self._known: dict[Element, Residue] = {}

    def number(self, value: FieldNumber) -> Residue:
        """An exact number modulo the prime.

        Raises:
            ZeroDivisionError: if the prime divides its denominator.

        >>> Residues(fmpz(7), None).number(fmpq(1, 2))
        fmpz_mod(4, 7)
        """
        if isinstance(value, fmpq):
            top = self._make(value.p)
            return top if value.q == 1 else top / self._make(value.q)
        known = self._known.get(value)
        if known is None:
            assert self._place is not None
            known = self._make(self._place.value(value.num)) / self._make(value.den)
            self._known[value] = known
        return known

    def root(self, value: Residue) -> Residue | None:
        """A square root of a residue that is not zero; None if it has none.

        Nothing that follows from None, or from a root, needs the modulus to be prime: see `Place`.

        Raises:
            ZeroDivisionError: for zero, where nothing follows; or if the modulus turns out not to be prime.

        >>> residues = Residues(fmpz(7), None)
        >>> residues.root(residues.number(fmpq(3))) is None, residues.root(residues.number(fmpq(2))) ** 2
        (True, fmpz_mod(2, 7))
        """
        whole = fmpz(int(value))
        symbol = whole.jacobi(self.modulus)
        if symbol == -1:
            return None
        if symbol == 0:
            raise ZeroDivisionError("a radicand is zero modulo the prime")
        try:
            root = self._make(whole.sqrtmod(self.modulus))
        except DomainError:
            root = self._make(0)
        if root * root != value:
            raise ZeroDivisionError("the modulus is not prime")
        return root


def products(tower: Tower, masks: Iterable[int]) -> list[fmpz]:
    """The whole numbers whose roots the masks stand for.

    >>> tower = Tower()
    >>> (mask,) = tower.sqrt(15).num
    >>> products(tower, [mask])
    [15]
    """
    base: dict[int, fmpz] = {}
    for generator in tower.generators:
        square = (generator * generator).num
        if isinstance(generator.num, dict) and isinstance(square, fmpz):
            (mask,) = generator.num
            base[mask] = square
    whole = []
    for mask in masks:
        product = fmpz(1)
        for bit, m in base.items():
            if mask & bit:
                product *= m
        whole.append(product)
    return whole


def nested_radicands(tower: Tower) -> list[Element]:
    """The radicands of the tower's nested generators, lowest first."""
    return [g * g for g in tower.generators if isinstance(g.num, Nested)]


def residues_of(tower: Tower, masks: Sequence[int], modulus: fmpz) -> Residues | None:
    """Residues modulo a number for the elements of a tower with such terms; None if a root is not to be had.

    >>> tower = Tower()
    >>> root = tower.sqrt(2)
    >>> residues_of(tower, [1], fmpz(7)).number(root) ** 2
    fmpz_mod(2, 7)
    >>> residues_of(tower, [1], fmpz(5)) is None
    True
    """
    place = Place(tower, int(modulus))
    if not place.split(masks) or not place.lift([radicand.num for radicand in nested_radicands(tower)]):
        return None
    return Residues(modulus, place)


def small_ratio(value: Residue, modulus: fmpz, bits: int) -> fmpq | None:
    """The fraction p / q > 0 with p, q < 2**bits that a residue is, if there is one; it is the only one.

    By the half-way remainders of Euclid's algorithm, for a modulus over 2**(2 * bits + 1).
    Source: P. S. Wang, *A p-adic algorithm for univariate partial fractions* (SYMSAC 1981).

    >>> x = fmpz_mod_ctx(fmpz(2**61 - 1))(4) / 9
    >>> small_ratio(x, fmpz(2**61 - 1), 20)
    4/9
    """
    high, low = int(modulus), int(value)
    s, t = 0, 1
    bound = 1 << bits
    while low >= bound:
        quotient = high // low
        high, low = low, high - quotient * low
        s, t = t, s - quotient * t
    if not 0 < t < bound or low == 0:
        return None
    return fmpq(low, t)
