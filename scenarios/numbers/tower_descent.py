"""Is a number a square? Its root, by descent, or the proof that it has none."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from random import Random
from typing import Final, TypeAlias

from flint import fmpz
from flint.utils.flint_exceptions import DomainError

from ..work import (
    factor_units,
    gcd_units,
    inverse_units,
    jacobi_units,
    primality_units,
    product_units,
    sqrt_units,
    sqrtmod_units,
)
from .tower_element import AnyTower, Element, reduced
from .tower_ring import (
    ONE,
    ZERO,
    Integral,
    Nested,
    TowerField,
    bit_length,
    extent,
    leaf_masks,
    masks_of,
    span,
    split_bit,
    subtract,
    surds,
)

# -- Squares among the whole numbers: factors, square parts, and products of radicands that are squares.

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


# -- Proofs that a number is not a square: its characters modulo primes contradict one another.

PLACES: Final = 20
"""Equations from places that must add nothing new before a square is believed possible, and the
descent tried. A non-square slips through about once in 2**20, and then costs time, not truth."""

PRIME_TRIES: Final = 300
"""Suitable primes tried for one place before the descent is left to work without more of them."""

WORD_BITS: Final = 64
"""Modulo a number up to this length everything takes under 2 us, which what finds the number is charged for."""


class ResidueMap:
    """A ring homomorphism to Z/n, n odd, from Z[sqrt(B), ..., s_1, ..., s_level].

    It is given by a root modulo n of every D_k and of some products B of base radicands, all
    prime to n. Let E be the field of those roots. The whole K_level is E with roots of the m_i.

    What it proves. Let x in E be a square in K_level. As K_level is E with square roots of whole
    numbers, x P is a square in E for some product P of distinct m_i. Let q be a prime factor of n,
    and follow the homomorphism to F_q. The roots do not become zero and q is not 2, so the ring,
    localised at the kernel, is etale over Z localised at q, hence normal; a root of x P is integral
    over it, so lies in it, and the image of x P is a square in F_q. So the Jacobi symbol of the
    image of x P, a product of Legendre symbols, is +1 (or 0, where the place has nothing to say).
    So *the symbol of x is a product of symbols of the m_i, over the same m_i at every place*; and
    if no choice of m_i does that, x is not a square in K_level. Nothing here needs n to be prime,
    so a pseudoprime could do no harm.
    """

    __slots__ = ("_chance", "_field", "_products", "_rows", "bits", "modulus", "nested", "roots")

    def __init__(self, field: TowerField, modulus: int, chance: Random) -> None:
        self._field = field
        self._chance = chance
        self.modulus = modulus
        self.bits = modulus.bit_length()
        self.roots: dict[int, tuple[int, int]] = {}  # leading bit -> (mask, root of its product)
        self.nested: list[int] = []
        self._products: dict[int, int] = {0: 1}
        self._rows: list[int] = []  # Jacobi symbols of the base radicands: 0 for +1, 1 for -1

    def root(self, value: int) -> int | None:
        """A root of value modulo n, prime to n, of random sign; None if there is none to be had."""
        n = fmpz(self.modulus)
        if self.bits > WORD_BITS:
            self._field.spend(1 + jacobi_units(self.bits))
        if fmpz(value).jacobi(n) != 1:
            return None
        if self.bits > WORD_BITS:
            self._field.spend(sqrtmod_units(self.bits))
        try:
            r = fmpz(value).sqrtmod(n)
        except DomainError:  # n is not prime after all
            return None
        if (r * r - value) % n != 0 or r.gcd(n) != 1:
            return None
        return int(r if self._chance.random() < 0.5 else n - r)

    def split(self, masks: Iterable[int]) -> bool:
        """Get roots of these products of base radicands; False if one has none."""
        for mask in masks:
            while mask:
                known = self.roots.get(mask.bit_length())
                if known is None:
                    break
                mask ^= known[0]
            if mask:
                root = self.root(int(self._field.product(mask) % self.modulus))
                if root is None:
                    return False
                self.roots[mask.bit_length()] = (mask, root)
        return True

    def lift(self, radicands: list[Integral]) -> bool:
        """Get roots of D_1, D_2, ..., trying both signs of each; False if there are none."""
        if len(self.nested) == len(radicands):
            return True
        radicand = radicands[len(self.nested)]
        if self._field.work is not None:
            self._field.spend(self.units(*extent(radicand)))
        root = self.root(self.value(radicand))
        if root is not None:
            for choice in (root, self.modulus - root):
                self.nested.append(choice)
                if self.lift(radicands):
                    return True
                self.nested.pop()
        return False

    def _product(self, mask: int) -> int:
        """The image of the root of a product: sqrt(P Q) = sqrt(P) sqrt(Q) over their common part."""
        known = self._products.get(mask)
        if known is None:
            lead, root = self.roots[mask.bit_length()]
            if self.bits > WORD_BITS:
                self._field.spend(inverse_units(self.bits))
            rest = mask ^ lead
            shared = int(self._field.product(rest & lead) % self.modulus)
            known = self._product(rest) * root * pow(shared, -1, self.modulus) % self.modulus
            self._products[mask] = known
        return known

    def value(self, x: Integral) -> int:
        """The image of x, in 0 .. n - 1."""
        n = self.modulus
        if isinstance(x, fmpz):
            return int(x % n)
        if isinstance(x, dict):
            return sum(int(c % n) * self._product(mask) for mask, c in x.items()) % n
        return (self.value(x.a) + self.value(x.b) * self.nested[x.level - 1]) % n

    def units(self, count: int, bits: int) -> int:
        """The work of `value` for so many coefficients of so many bits together."""
        units = 2 + (count >> 1)
        if self.bits <= WORD_BITS:
            return units + (bits >> 12)
        return units + 2 * count * (product_units(bits // count, self.bits) + product_units(self.bits, self.bits))

    def row(self, x: Integral) -> int | None:
        """Jacobi symbols, -1 as bit 1: of each m_i as bit i + 1, of x as bit 0. None if x becomes 0."""
        symbol = fmpz(self.value(x)).jacobi(self.modulus)
        if symbol == 0:
            return None
        for m in self._field.base[len(self._rows) :]:
            if self.bits > WORD_BITS:
                self._field.spend(1 + jacobi_units(self.bits))
            self._rows.append(m.jacobi(self.modulus))
        row = int(symbol == -1)
        for i, of_m in enumerate(self._rows):
            if of_m == 0:
                return None
            if of_m == -1:
                row |= 2 << i
        return row


class Characters:
    """Proves by characters modulo primes that numbers of a field are not squares; the primes are drawn by chance."""

    def __init__(self, field: TowerField) -> None:
        self._field = field
        self._places: dict[int, list[ResidueMap]] = {}
        self._exhausted: set[tuple[int, tuple[int, ...]]] = set()
        self._supports: list[tuple[int, ...]] = [()]
        self._random = Random(20)

    def refute(self, x: Integral, level: int) -> bool:
        """Whether places prove that x is not a square in K_level.

        Each place says: the sum of its bits i + 1 over the unknown set of m_i is its bit 0, modulo
        2 (see `ResidueMap`). The proof is that these equations contradict one another.
        """
        pivots: dict[int, int] = {}
        idle = 0
        counted = self._field.work is not None
        count, total = extent(x) if counted else (1, 0)
        units = 2 + (count >> 1) + (total >> 12)
        for place in self._places_for(x, level):
            if counted:
                self._field.spend(units if place.bits <= WORD_BITS else place.units(count, total))
            row = place.row(x)
            while row is not None and row > 1 and row.bit_length() in pivots:
                row ^= pivots[row.bit_length()]
            if row is None:
                continue
            if row == 1:
                return True
            if row == 0:
                idle += 1
                if idle == PLACES:
                    break
            else:
                pivots[row.bit_length()] = row
        return False

    def _places_for(self, x: Integral, level: int) -> Iterator[ResidueMap]:
        """Homomorphisms that x and s_1 .. s_level have images under, made as they are needed."""
        masks = [*self._support(level), *leaf_masks(x)]
        self._field.spend(1 + (len(masks) * (1 + len(self._field.base)) >> 3))
        basis = tuple(span(masks))
        pool = self._places.setdefault(level, [])
        for place in pool:
            if place.split(basis):
                yield place
        while (level, basis) not in self._exhausted:
            place = self._new_place(basis, level)
            if place is None:
                self._exhausted.add((level, basis))
                return
            pool.append(place)
            yield place

    def _support(self, level: int) -> tuple[int, ...]:
        """A basis of the base products in D_1 .. D_level."""
        while len(self._supports) <= level:
            radicand = self._field.radicands[len(self._supports) - 1]
            masks = [*self._supports[-1], *leaf_masks(radicand)]
            self._field.spend(1 + (len(masks) * (1 + len(self._field.base)) >> 3))
            self._supports.append(tuple(span(masks)))
        return self._supports[level]

    def _new_place(self, basis: tuple[int, ...], level: int) -> ResidueMap | None:
        for modulus in self._moduli(basis):
            place = ResidueMap(self._field, modulus, self._random)
            if place.split(basis) and place.lift(self._field.radicands[:level]):
                return place
        return None

    def _moduli(self, basis: tuple[int, ...]) -> Iterator[int]:
        """Random primes (probably), modulo which the base products in the basis are likely squares.

        Few products: any prime does, once in 2**len(basis). Many: n = r**2 modulo 8 times every odd
        part of an m, so that 2 is a square modulo n, and by reciprocity each odd part, as n = 1
        modulo 4. Which of the two is quicker was measured: see `by_reciprocity`.
        """
        odd = ONE
        union = 0
        for mask in basis:
            union |= mask
        if by_reciprocity(len(basis), self._field.product(union).bit_length()):
            for i, m in enumerate(self._field.base):
                if union >> i & 1:
                    odd *= m // (m & -m) if m % 2 == 0 else m
            tries = PRIME_TRIES
        else:
            tries = PRIME_TRIES << len(basis)
        step = int(8 * odd)
        reach = max(1 << 16, (1 << 61) // step)
        bits = (step * reach).bit_length()
        # About one odd number in bits / 3 is prime; 10 for what is then computed modulo it (see WORD_BITS).
        units = bits * primality_units(bits) // 3 + 10
        for _ in range(tries):
            self._field.spend(units)
            r = self._random.randrange(step) | 1
            while odd.gcd(r) != 1:
                r = self._random.randrange(step) | 1
            n = 0
            while not fmpz(n).is_probable_prime():
                n = r * r % step + step * self._random.randrange(1, reach)
            yield n


def by_reciprocity(count: int, bits: int) -> bool:
    """Whether to make primes from the base radicands (of `bits` together), or to wait for luck.

    A prime of 61 bits takes 30 us, and one in 2**count will do; one that is made takes about
    30 us * (2 + bits**2 / 5000), and is slower to compute with.
    """
    return 2**count > 64 + bits * bits // 2000


# -- Is a number a square in the field? Its root by descent, or the proof that it has none.


class Descent:
    """Finds square roots in the field of a tower as it stands; what it finds is left to be squared again.

    Args:
        tower: makes the elements.
    """

    def __init__(self, tower: AnyTower) -> None:
        self._tower = tower
        self._field = tower.field
        self.characters = Characters(tower.field)

    def root(self, x: Integral, level: int) -> Element | None:
        """A root of x in K_level (all of the base, and s_1 .. s_level), or None: it has none.

        Norm descent. Let x = a + b s, s**2 = D, b != 0. If x = (u + v s)**2, then
        n = u**2 - D v**2 is a root of the norm a**2 - D b**2 below s, and (a + n) / 2 = u**2,
        v = b / (2 u). The other sign of n gives D v**2 instead. Conversely such n and u give
        the root. If s does not occur in x, then u v = 0, so x is u**2 or D v**2, that is, x or
        x D is a square below.
        """
        field = self._field
        field.spend(2)
        if isinstance(x, fmpz):
            if x < 0:
                return None
            subset = self._square_class(x) if x else 0
            if subset is not None:
                # x * product = square, so sqrt(x) = isqrt(x * product) / product * sqrt(product)
                product = field.product(subset)
                return self._element(surds({subset: (x * product).isqrt()})) / product
            if level == 0:
                return None
        elif field.sign(x) < 0:
            return None
        if self.characters.refute(x, level):
            return None
        if isinstance(x, Nested) and x.level == level:
            return self._nested_root(x)
        if level:
            root = self.root(x, level - 1)
            if root is not None:
                return root
            radicand = field.radicands[level - 1]
            root = self.root(field.mul(x, radicand), level - 1)
            if root is None:
                return None
            return root * self._element(Nested(level, ZERO, ONE)) / self._element(radicand)
        assert isinstance(x, dict)
        return self._surd_root(x)

    def _square_class(self, n: fmpz) -> int | None:
        """`square_subset` of the base, quickly where that is pairwise coprime.

        As no m is a square, n times a product of distinct m is one exactly if all exponents of the
        m are even in it, and what of n is coprime to the base is a square.
        """
        field = self._field
        bits = n.bit_length()
        if n.is_square():
            field.spend(sqrt_units(bits))
            return 0
        if not field.coprime:
            return square_subset(n, field.base, field.spend)
        if field.work is not None:
            known = field.base_product.bit_length()
            field.spend(1 + 2 * gcd_units(bits, known) + 2 * product_units(bits, known))
        common = n.gcd(field.base_product)
        subset = 0
        for i, m in enumerate(field.base if common > 1 else ()):
            while common % m == 0 and n % m == 0:
                n //= m
                subset ^= 1 << i
        if n.gcd(field.base_product) != 1:
            return square_subset(n * field.product(subset), field.base, field.spend)
        if not n.is_square():
            return None
        field.spend(sqrt_units(bits))
        return subset

    def _nested_root(self, x: Nested) -> Element | None:
        below = x.level - 1
        field = self._field
        square = field.mul(field.mul(x.b, x.b), field.radicands[below])
        n = self.root(subtract(field.mul(x.a, x.a), square), below)
        if n is None:
            return None
        a = self._element(x.a)
        for half in ((a + n) / 2, (a - n) / 2):
            u = self._found_root(half, below)
            if u is not None:
                return u + self._element(Nested(x.level, ZERO, x.b)) / (2 * u)
        return None

    def _surd_root(self, x: dict[int, fmpz]) -> Element | None:
        """`root` in the base, which contains a root of each m.

        So either sign of n will do: with t = sqrt((a + n) / 2) in M, whether t is u or v sqrt(m),
        x = (t + y / (2 t))**2, where y is the part of x with sqrt(m).

        n must be free of sqrt(m), and can have no bit that x has not. For let F be the field of
        the bits of x. If w**2 = x with w in M, then F(w) is of degree at most 2 over F inside M,
        so w = c sqrt(e) with c in F and e a product of base radicands; and n = +-(w times its
        conjugate) = +-(c times its conjugate) e is in F. So each step has fewer bits.
        """
        union = masks_of(x)
        bit = union.bit_length() - 1
        a, y = split_bit(x, bit)
        n = self.root(subtract(self._field.mul(a, a), self._field.mul(y, y)), 0)
        if n is None or masks_of(n.num) & (~union | 1 << bit):
            return None
        t = self._found_root((self._element(a) + n) / 2, 0)
        return None if t is None else t + self._element(y) / (2 * t)

    def _found_root(self, e: Element, level: int) -> Element | None:
        root = self.root(self._field.mul(e.num, e.den), level)
        return None if root is None else root / e.den

    def _element(self, x: Integral) -> Element:
        return reduced(self._tower, x, ONE)
