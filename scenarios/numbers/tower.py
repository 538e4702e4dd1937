"""Real numbers made of nested square roots, in a normal form in which zero is decided.

The field is K = Q(sqrt(m_1), sqrt(m_2), ...)(s_1)(s_2)... and grows as roots are asked for:

- the *base* M = Q(sqrt(m_1), ...): whole numbers m_i > 1 of which no product of distinct ones
  is a square, usually primes. An element is a sparse sum of c * sqrt(product of some m_i);
- the *nested generators* s_k = +sqrt(D_k), with D_k > 0 in Q(..., s_1, ..., s_(k-1)) and
  certified not to be a square there.

The products of distinct generators are then a basis of K over Q, so an element is zero exactly
if all its coefficients are. Everything rests on one question: *is x a square in K?* It is
answered by descent (`Tower._root`), and a "yes" is squared again before it is believed. A "no"
mostly comes at once from reductions modulo primes (`Place`).

Numbers are stored as num / den with num in Z[sqrt(m_i), s_k], so that no fraction is reduced
in the middle of a product. A new radicand is scaled into that ring first.

Sources: the norm descent is Borodin, Fagin, Hopcroft and Tompa, *Decreasing the nesting depth
of expressions involving square roots* (J. Symbolic Computation 1, 1985); proving non-squares by
characters modulo primes is Adleman, *Factoring numbers using singular integers* (STOC 1991).

>>> tower = Tower()
>>> root = tower.sqrt(5 + 2 * tower.sqrt(6))
>>> root.text()
'sqrt(2) + sqrt(3)'
>>> (root - tower.sqrt(2) - tower.sqrt(3)).is_zero()
True
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Iterator
from fractions import Fraction
from typing import TYPE_CHECKING, Final, TypeAlias

from flint import arb, ctx, fmpq, fmpz
from flint.utils.flint_exceptions import DomainError

from ..work import (
    Work,
    WorkSpent,
    factor_units,
    gcd_units,
    inverse_units,
    jacobi_units,
    primality_units,
    product_units,
    root_units,
    sqrtmod_units,
)

if TYPE_CHECKING:
    import sympy

__all__ = ["Element", "Rational", "Tower", "TowerLimit", "sign_of_root_sum"]

Rational: TypeAlias = "int | Fraction | fmpq | fmpz"

FULL_FACTOR_BITS: Final = 100
"""Whole numbers up to here are factored completely: under 10 ms. Longer ones may stay composite,
which costs nothing but the beauty of the printed form (see `_square_subset`)."""

TRIAL_PRIMES: Final = 1000
"""How many primes are tried on a longer number: 0.3 ms at 2,000 bits."""

PLACES: Final = 20
"""Equations from places that must add nothing new before a square is believed possible, and the
descent tried. A non-square slips through about once in 2**20, and then costs time, not truth."""

PRIME_TRIES: Final = 300
"""Suitable primes tried for one place before the descent is left to work without more of them."""

FIRST_BITS: Final = 64
"""Precision of the first ball of a sign test; doubled until the sign shows."""

FILTER_BITS: Final = (64, 128, 256)
"""Ball precisions that `sign_of_root_sum` tries before it computes in the field."""

SHORT_BITS: Final = 256
"""Up to this length of numbers the interpreter's part outweighs flint's, so that work is counted by numbers alone."""

WORD_BITS: Final = 64
"""Modulo a number up to this length everything takes under 2 us, which what finds the number is charged for."""

LONG: Final = fmpz(1) << SHORT_BITS
LONG_NEGATIVE: Final = -LONG
"""Whole numbers that are not between these are long."""

SPENT: Final = "the work allowed is spent; allow more (--work)"
"""What `TowerLimit` says where a limit of work is met."""

ZERO: Final = fmpz(0)
ONE: Final = fmpz(1)


class TowerLimit(Exception):
    """The tower would become deeper, or its work longer, than the caller allowed."""


# --------------------------------------------------------------------------------------
# The ring Z[sqrt(m_1), ..., s_1, ...]. An integral value is one of
#   fmpz              a whole number;
#   dict[int, fmpz]   a sum of c * sqrt(product of the m_i with bit i set), not all bits 0;
#   Nested            a + b * s_k with b != 0, and a, b of lower level.
# Values are never changed once made, and no coefficient of a dict is zero.
# --------------------------------------------------------------------------------------


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
        return hash((self.level, _key(self.a), _key(self.b)))


Integral: TypeAlias = fmpz | dict[int, fmpz] | Nested


def _key(x: Integral) -> object:
    return frozenset(x.items()) if isinstance(x, dict) else x


def _level(x: Integral) -> int:
    return x.level if isinstance(x, Nested) else 0


def _nested(level: int, a: Integral, b: Integral) -> Integral:
    return Nested(level, a, b) if b else a


def _surds(terms: dict[int, fmpz]) -> Integral:
    """Drop what is zero, and be a whole number where no root is left."""
    kept = {mask: c for mask, c in terms.items() if c}
    if not kept:
        return ZERO
    if len(kept) == 1 and 0 in kept:
        return kept[0]
    return kept


def _add(x: Integral, y: Integral) -> Integral:
    if isinstance(x, fmpz) and isinstance(y, fmpz):
        return x + y
    if not x:
        return y
    if not y:
        return x
    p, q = _level(x), _level(y)
    if p or q:
        if p < q:
            x, y, p, q = y, x, q, p
        assert isinstance(x, Nested)
        if p > q:
            return Nested(p, _add(x.a, y), x.b)
        assert isinstance(y, Nested)
        return _nested(p, _add(x.a, y.a), _add(x.b, y.b))
    assert not isinstance(x, Nested)
    assert not isinstance(y, Nested)
    terms = dict(x) if isinstance(x, dict) else {0: x}
    for mask, c in y.items() if isinstance(y, dict) else ((0, y),):
        terms[mask] = terms.get(mask, ZERO) + c
    return _surds(terms)


def _scale(x: Integral, c: fmpz) -> Integral:
    """x * c for a whole c."""
    if isinstance(x, fmpz):
        return x * c
    if not c:
        return ZERO
    if isinstance(x, dict):
        return {mask: value * c for mask, value in x.items()}
    return Nested(x.level, _scale(x.a, c), _scale(x.b, c))


def _neg(x: Integral) -> Integral:
    return _scale(x, fmpz(-1))


def _sub(x: Integral, y: Integral) -> Integral:
    return _add(x, _neg(y))


def _coefficients(x: Integral) -> Iterator[fmpz]:
    if isinstance(x, fmpz):
        yield x
    elif isinstance(x, dict):
        yield from x.values()
    else:
        yield from _coefficients(x.a)
        yield from _coefficients(x.b)


def _content(x: Integral, known: fmpz = ZERO) -> fmpz:
    """The greatest common divisor of `known` and all coefficients of x."""
    if isinstance(x, fmpz):
        return known.gcd(x)
    if isinstance(x, dict):
        for c in x.values():
            known = known.gcd(c)
            if known == 1:
                break
        return known
    known = _content(x.a, known)
    return known if known == 1 else _content(x.b, known)


def _count(x: Integral) -> int:
    """How many coefficients x has."""
    if isinstance(x, dict):
        return len(x)
    return _count(x.a) + _count(x.b) if isinstance(x, Nested) else 1


def _extent(x: Integral) -> tuple[int, int]:
    """How many coefficients x has, and how many bits they have together."""
    if isinstance(x, fmpz):
        return 1, x.bit_length()
    if isinstance(x, dict):
        return len(x), sum(map(_bit_length, x.values()))
    count, bits = _extent(x.a)
    more, further = _extent(x.b)
    return count + more, bits + further


_bit_length: Final = fmpz.bit_length


def _divide(x: Integral, c: fmpz) -> Integral:
    """x / c for a whole c that divides every coefficient."""
    if c == 1:
        return x
    if isinstance(x, fmpz):
        return x // c
    if isinstance(x, dict):
        return {mask: value // c for mask, value in x.items()}
    return Nested(x.level, _divide(x.a, c), _divide(x.b, c))


def _split_bit(x: dict[int, fmpz], bit: int) -> tuple[Integral, Integral]:
    """x as (terms without the root of m_bit, terms with it)."""
    flag = 1 << bit
    without = {mask: c for mask, c in x.items() if not mask & flag}
    return _surds(without), _surds({mask: c for mask, c in x.items() if mask & flag})


def _masks(x: Integral) -> int:
    """All bits of the base that x uses, outside of radicands."""
    if isinstance(x, fmpz):
        return 0
    if isinstance(x, dict):
        union = 0
        for mask in x:
            union |= mask
        return union
    return _masks(x.a) | _masks(x.b)


def _leaf_masks(x: Integral) -> Iterator[int]:
    """The sets of base radicands whose products have roots in x, outside of radicands."""
    if isinstance(x, dict):
        yield from x
    elif isinstance(x, Nested):
        yield from _leaf_masks(x.a)
        yield from _leaf_masks(x.b)


def _span(masks: Iterable[int]) -> list[int]:
    """The reduced basis, modulo 2, of what the masks generate: the same for the same span."""
    basis: list[int] = []
    for mask in masks:
        for b in basis:
            mask = min(mask, mask ^ b)
        if mask:
            basis = sorted([*(min(b, b ^ mask) for b in basis), mask], reverse=True)
    return basis


# --------------------------------------------------------------------------------------
# Squares among the whole numbers.
# --------------------------------------------------------------------------------------


Spend: TypeAlias = Callable[[int], None]
"""Counts work about to be done (see `Work.spend`)."""


def _free(units: int) -> None:
    """Counts nothing."""


def _factor(n: fmpz) -> list[tuple[fmpz, int]]:
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


def _split_square(n: fmpz, spend: Spend | None = None) -> tuple[fmpz, list[fmpz]]:
    """(f, parts) with n = f**2 * product of parts; n > 0.

    The parts are square-free as far as the factorisation went.
    """
    if spend is not None:
        bits = n.bit_length()
        spend(2 + factor_units(bits, complete=bits <= FULL_FACTOR_BITS) + root_units(bits))
    root = ONE
    parts: list[fmpz] = []
    for f, e in _factor(n):
        root *= f ** (e // 2)
        if e % 2:
            parts.append(f)
    return root, parts


def _coprime_base(numbers: list[fmpz], spend: Spend = _free) -> list[fmpz]:
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


def _square_subset(n: fmpz, radicands: list[fmpz], spend: Spend = _free) -> int | None:
    """The bits of a set of radicands whose product with n > 0 is a square, or None: there is none.

    Over a coprime base, a product is a square exactly if each base number that is not itself a
    square has an even exponent. So this is linear algebra modulo 2 and needs no factoring.

    >>> _square_subset(fmpz(30), [fmpz(6), fmpz(10), fmpz(2)])
    7
    >>> _square_subset(fmpz(7), [fmpz(6), fmpz(10), fmpz(2)]) is None
    True
    """
    if n.is_square():
        return 0
    base = [b for b in _coprime_base([n, *radicands], spend) if not b.is_square()]
    base_bits = sum(map(_bit_length, base))

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


# --------------------------------------------------------------------------------------
# Non-squares, proved modulo a number.
# --------------------------------------------------------------------------------------


class Place:
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

    __slots__ = ("_products", "_rows", "_tower", "bits", "modulus", "nested", "roots")

    def __init__(self, tower: Tower, modulus: int) -> None:
        self._tower = tower
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
            self._tower._spend(1 + jacobi_units(self.bits))
        if fmpz(value).jacobi(n) != 1:
            return None
        if self.bits > WORD_BITS:
            self._tower._spend(sqrtmod_units(self.bits))
        try:
            r = fmpz(value).sqrtmod(n)
        except DomainError:  # n is not prime after all
            return None
        if (r * r - value) % n != 0 or r.gcd(n) != 1:
            return None
        return int(r if self._tower._random.random() < 0.5 else n - r)

    def split(self, masks: Iterable[int]) -> bool:
        """Get roots of these products of base radicands; False if one has none."""
        for mask in masks:
            while mask:
                known = self.roots.get(mask.bit_length())
                if known is None:
                    break
                mask ^= known[0]
            if mask:
                root = self.root(int(self._tower._product(mask) % self.modulus))
                if root is None:
                    return False
                self.roots[mask.bit_length()] = (mask, root)
        return True

    def lift(self, radicands: list[Integral]) -> bool:
        """Get roots of D_1, D_2, ..., trying both signs of each; False if there are none."""
        if len(self.nested) == len(radicands):
            return True
        radicand = radicands[len(self.nested)]
        if self._tower.work is not None:
            self._tower._spend(self.units(*_extent(radicand)))
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
                self._tower._spend(inverse_units(self.bits))
            rest = mask ^ lead
            shared = int(self._tower._product(rest & lead) % self.modulus)
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
        for m in self._tower._base[len(self._rows) :]:
            if self.bits > WORD_BITS:
                self._tower._spend(1 + jacobi_units(self.bits))
            self._rows.append(m.jacobi(self.modulus))
        row = int(symbol == -1)
        for i, of_m in enumerate(self._rows):
            if of_m == 0:
                return None
            if of_m == -1:
                row |= 2 << i
        return row


def _by_reciprocity(count: int, bits: int) -> bool:
    """Whether to make primes from the base radicands (of `bits` together), or to wait for luck.

    A prime of 61 bits takes 30 us, and one in 2**count will do; one that is made takes about
    30 us * (2 + bits**2 / 5000), and is slower to compute with.
    """
    return 2**count > 64 + bits * bits // 2000


# --------------------------------------------------------------------------------------
# The field.
# --------------------------------------------------------------------------------------


class Tower:
    """A field of real numbers that grows by the square roots asked of it. Not thread-safe.

    `max_depth` bounds `depth`; None means no bound. `work` counts what is done here, each step
    before it is taken; the step that would pass its limit raises `TowerLimit` instead. It may be
    shared with other towers, and be changed at any time; None means that nothing is counted. The
    same operations on a new tower spend the same work, in every process and on every machine.

    The number of coefficients doubles with every nested generator, and their lengths grow faster:
    4 generators on a chain of collisions are quick, 6 may be hopeless. So set a bound.
    """

    def __init__(self, max_depth: int | None = None, work: Work | None = None) -> None:
        self.max_depth = max_depth
        self.work = work
        self._base: list[fmpz] = []
        self._all = ONE  # the product of the base
        self._coprime = True  # whether its members are pairwise coprime
        self._radicands: list[Integral] = []
        self._made: list[tuple[bool, int]] = []  # (nested?, index), in order of making
        self._products: dict[int, fmpz] = {0: ONE}
        self._roots: dict[Element, Element] = {}
        self._places: dict[int, list[Place]] = {}
        self._exhausted: set[tuple[int, tuple[int, ...]]] = set()
        self._supports: list[tuple[int, ...]] = [()]
        self._frames: dict[int, _Frame] = {}
        self._random = random.Random(20)

    def __repr__(self) -> str:
        return f"Tower({', '.join(g.text() for g in self.generators)})"

    @property
    def depth(self) -> int:
        """Levels over Q: one for all roots of whole numbers, and one for each nested root."""
        return bool(self._base) + len(self._radicands)

    @property
    def generators(self) -> tuple[Element, ...]:
        """The roots that generate the field, in the order in which they were needed.

        >>> tower = Tower()
        >>> _ = tower.sqrt(1 + tower.sqrt(12))
        >>> [g.text() for g in tower.generators]
        ['sqrt(3)', 'sqrt(2*sqrt(3) + 1)']
        """
        return tuple(self._element(Nested(i + 1, ZERO, ONE) if nested else {1 << i: ONE}) for nested, i in self._made)

    def rational(self, q: Rational) -> Element:
        """q as an element of this field."""
        q = _fmpq(q)
        return _reduced(self, q.p, q.q)

    def sqrt(self, e: Element | Rational) -> Element:
        """The square root of e that is not negative; the field grows only if it must.

        Raises ValueError if e is negative, TowerLimit if a bound is met.

        >>> tower = Tower()
        >>> tower.sqrt(2) * tower.sqrt(8) == 4
        True
        >>> tower.sqrt(2 + tower.sqrt(3)).text()
        '1/2*sqrt(2) + 1/2*sqrt(6)'
        """
        e = self._own(e)
        known = self._roots.get(e)
        if known is not None:
            return known
        sign = e.sign()
        if sign < 0:
            raise ValueError(f"square root of the negative number {_brief(e)}")
        if sign == 0:
            return e
        # sqrt(num / den) = sqrt(num * den) / den, and the squares leave the content.
        x = self._mul(e.num, e.den)
        if isinstance(x, fmpz):
            root = self._sqrt_whole(x)
        else:
            content = self._content(x)
            factor, parts = _split_square(content, self._spend if self.work is not None else None)
            primitive = self._quotient(x, content)
            rest = ONE
            for part in parts:
                rest *= part
            root = self._sqrt_integral(self._mul(primitive, rest)) * factor
        root = self._checked(root / e.den, e)
        self._roots[e] = root
        return root

    def root_within(self, e: Element | Rational) -> Element | None:
        """The square root of e that is not negative if it lies in this field as it stands, else None.

        Raises ValueError if e is negative, TowerLimit if the work allowed is spent.

        >>> tower = Tower()
        >>> three = tower.sqrt(3)
        >>> tower.root_within(tower.rational(12)), tower.root_within(tower.rational(2))
        (Element(2*sqrt(3)), None)
        """
        e = self._own(e)
        sign = e.sign()
        if sign < 0:
            raise ValueError(f"square root of the negative number {_brief(e)}")
        if sign == 0:
            return e
        root = self._root(self._mul(e.num, e.den), len(self._radicands))
        return None if root is None else self._checked(abs(root) / e.den, e)

    def _checked(self, root: Element, e: Element) -> Element:
        if root * root != e or root.sign() <= 0:
            raise AssertionError(f"sqrt({_brief(e)}) did not square to its radicand: a defect")
        return root

    # -- growing -----------------------------------------------------------------------

    def _sqrt_whole(self, n: fmpz) -> Element:
        """sqrt(n) for a whole n > 0."""
        factor, parts = _split_square(n, self._spend if self.work is not None else None)
        core = ONE
        for part in parts:
            core *= part
        root = self._root(core, len(self._radicands))
        if root is not None:
            return abs(root) * factor
        product = self.rational(factor)
        for part in parts:
            root = self._root(part, len(self._radicands)) if len(parts) > 1 else None
            product *= self._new_base(part) if root is None else abs(root)
        return product

    def _sqrt_integral(self, x: Integral) -> Element:
        """sqrt(x) for x > 0 that is not a whole number."""
        root = self._root(x, len(self._radicands))
        if root is not None:
            return abs(root)
        root = self._denested(x)
        if root is not None:
            return root
        self._check_depth(len(self._radicands) + bool(self._base) + 1)
        self._radicands.append(x)
        self._made.append((True, len(self._radicands) - 1))
        return self._element(Nested(len(self._radicands), ZERO, ONE))

    def _denested(self, x: Integral) -> Element | None:
        """sqrt(x) by a root of lower level, where x has a norm that is a square.

        With x = a + y > 0, y**2 in the field below, and a**2 - y**2 = n**2, n >= 0: a > 0, and
        t = sqrt((a + n) / 2) gives sqrt(x) = t + y / (2 t), because (y / (2 t))**2 = (a - n) / 2;
        and it is not negative because t**2 >= |y| / 2. The new root is of the same degree, and
        needs a lower level or fewer bits of the base below it, so this comes to an end.
        """
        if isinstance(x, Nested):
            parts = [(x.a, Nested(x.level, ZERO, x.b), x.level - 1, 0)]
        else:
            assert isinstance(x, dict)
            union = _masks(x)
            bits = (bit for bit in range(union.bit_length()) if union >> bit & 1)
            parts = [(*_split_bit(x, bit), 0, ~union | 1 << bit) for bit in bits]
        for a, y, level, forbidden in parts:
            n = self._root(_sub(self._mul(a, a), self._mul(y, y)), level)
            if n is None or (level == 0 and _masks(n.num) & forbidden):
                continue
            t = self.sqrt((self._element(a) + abs(n)) / 2)
            return t + self._element(y) / (2 * t)
        return None

    def _new_base(self, m: fmpz) -> Element:
        """The root of m > 1, known not to be a square in the whole field.

        It may be put below the nested generators: with it the degree over Q doubles, so every
        step of the tower in its new order is still of degree two.
        """
        self._check_depth(len(self._radicands) + 1)
        self._spend(1 + gcd_units(m.bit_length(), self._all.bit_length()))
        self._base.append(m)
        self._made.append((False, len(self._base) - 1))
        self._coprime = self._coprime and m.gcd(self._all) == 1
        self._all *= m
        return self._element({1 << (len(self._base) - 1): ONE})

    def _check_depth(self, depth: int) -> None:
        if self.max_depth is not None and depth > self.max_depth:
            raise TowerLimit(f"depth {depth} is over the bound of {self.max_depth}; raise max_depth")

    # -- counting work -------------------------------------------------------------------

    def _spend(self, units: int) -> None:
        """Counts work about to be done here; hot places ask first whether it is counted at all."""
        if self.work is not None:
            try:
                self.work.spend(units)
            except WorkSpent:
                raise TowerLimit(SPENT) from None

    def _spend_scaling(self, x: Integral, bits: int) -> None:
        """Counts the product, or half the quotient, of x with a whole number of more than a few words."""
        count, total = _extent(x)
        self._spend(count * (1 + product_units(total // count, bits)))

    def _content(self, x: Integral, known: fmpz = ZERO) -> fmpz:
        """`_content`, counted. Once what is known gets short, it costs little to go on."""
        if self.work is None:
            return _content(x, known)
        if isinstance(x, fmpz):
            self._spend(gcd_units(known.bit_length(), x.bit_length()))
            return known.gcd(x)
        count, total = _extent(x)
        if (known.bit_length() or total // count) <= SHORT_BITS:
            self._spend(1 + (count >> 2) + 2 * product_units(total, SHORT_BITS))
            return _content(x, known)
        for c in _coefficients(x):
            self._spend(1 + gcd_units(known.bit_length(), c.bit_length()))
            known = known.gcd(c)
            if known == 1:
                break
        return known

    def _spend_product(self, x: dict[int, fmpz], y: dict[int, fmpz]) -> None:
        """Counts the product of two sums: of each term of one with each of the other."""
        rows, columns = len(x), len(y)
        units = 1 + (rows * columns >> 1)
        long, wide = sum(map(_bit_length, x.values())), sum(map(_bit_length, y.values()))
        if long > SHORT_BITS or wide > SHORT_BITS:
            long //= rows
            wide //= columns
            common = self._all.bit_length()
            units += rows * columns * (product_units(long, wide) + product_units(long + wide, common) // 2)
        self._spend(units)

    def _quotient(self, x: Integral, c: fmpz) -> Integral:
        """`_divide`, counted."""
        if self.work is not None and (bits := c.bit_length()) > SHORT_BITS:
            self._spend_scaling(x, bits)
            self._spend_scaling(x, bits)
        return _divide(x, c)

    # -- is x a square? ------------------------------------------------------------------

    def _root(self, x: Integral, level: int) -> Element | None:
        """A root of x in K_level (all of the base, and s_1 .. s_level), or None: it has none.

        Norm descent. Let x = a + b s, s**2 = D, b != 0. If x = (u + v s)**2, then
        n = u**2 - D v**2 is a root of the norm a**2 - D b**2 below s, and (a + n) / 2 = u**2,
        v = b / (2 u). The other sign of n gives D v**2 instead. Conversely such n and u give
        the root. If s does not occur in x, then u v = 0, so x is u**2 or D v**2, that is, x or
        x D is a square below.
        """
        self._spend(2)
        if isinstance(x, fmpz):
            if x < 0:
                return None
            subset = self._square_class(x) if x else 0
            if subset is not None:
                # x * product = square, so sqrt(x) = isqrt(x * product) / product * sqrt(product)
                product = self._product(subset)
                return self._element(_surds({subset: (x * product).isqrt()})) / product
            if level == 0:
                return None
        elif self._sign(x) < 0:
            return None
        if self._refuted(x, level):
            return None
        if isinstance(x, Nested) and x.level == level:
            return self._root_nested(x)
        if level:
            root = self._root(x, level - 1)
            if root is not None:
                return root
            radicand = self._radicands[level - 1]
            root = self._root(self._mul(x, radicand), level - 1)
            if root is None:
                return None
            return root * self._element(Nested(level, ZERO, ONE)) / self._element(radicand)
        assert isinstance(x, dict)
        return self._root_surds(x)

    def _square_class(self, n: fmpz) -> int | None:
        """`_square_subset` of the base, quickly where that is pairwise coprime.

        As no m is a square, n times a product of distinct m is one exactly if all exponents of the
        m are even in it, and what of n is coprime to the base is a square.
        """
        bits = n.bit_length()
        if n.is_square():
            self._spend(root_units(bits))
            return 0
        if not self._coprime:
            return _square_subset(n, self._base, self._spend)
        if self.work is not None:
            known = self._all.bit_length()
            self._spend(1 + 2 * gcd_units(bits, known) + 2 * product_units(bits, known))
        common = n.gcd(self._all)
        subset = 0
        for i, m in enumerate(self._base if common > 1 else ()):
            while common % m == 0 and n % m == 0:
                n //= m
                subset ^= 1 << i
        if n.gcd(self._all) != 1:
            return _square_subset(n * self._product(subset), self._base, self._spend)
        if not n.is_square():
            return None
        self._spend(root_units(bits))
        return subset

    def _root_nested(self, x: Nested) -> Element | None:
        below = x.level - 1
        square = self._mul(self._mul(x.b, x.b), self._radicands[below])
        n = self._root(_sub(self._mul(x.a, x.a), square), below)
        if n is None:
            return None
        a = self._element(x.a)
        for half in ((a + n) / 2, (a - n) / 2):
            u = self._root_of(half, below)
            if u is not None:
                return u + self._element(Nested(x.level, ZERO, x.b)) / (2 * u)
        return None

    def _root_surds(self, x: dict[int, fmpz]) -> Element | None:
        """`_root` in the base, which contains a root of each m.

        So either sign of n will do: with t = sqrt((a + n) / 2) in M, whether t is u or v sqrt(m),
        x = (t + y / (2 t))**2, where y is the part of x with sqrt(m).

        n must be free of sqrt(m), and can have no bit that x has not. For let F be the field of
        the bits of x. If w**2 = x with w in M, then F(w) is of degree at most 2 over F inside M,
        so w = c sqrt(e) with c in F and e a product of base radicands; and n = +-(w times its
        conjugate) = +-(c times its conjugate) e is in F. So each step has fewer bits.
        """
        union = _masks(x)
        bit = union.bit_length() - 1
        a, y = _split_bit(x, bit)
        n = self._root(_sub(self._mul(a, a), self._mul(y, y)), 0)
        if n is None or _masks(n.num) & (~union | 1 << bit):
            return None
        t = self._root_of((self._element(a) + n) / 2, 0)
        return None if t is None else t + self._element(y) / (2 * t)

    def _root_of(self, e: Element, level: int) -> Element | None:
        root = self._root(self._mul(e.num, e.den), level)
        return None if root is None else root / e.den

    def _refuted(self, x: Integral, level: int) -> bool:
        """Whether places prove that x is not a square in K_level.

        Each place says: the sum of its bits i + 1 over the unknown set of m_i is its bit 0, modulo
        2 (see `Place`). The proof is that these equations contradict one another.
        """
        pivots: dict[int, int] = {}
        idle = 0
        counted = self.work is not None
        count, total = _extent(x) if counted else (1, 0)
        units = 2 + (count >> 1) + (total >> 12)
        for place in self._places_for(x, level):
            if counted:
                self._spend(units if place.bits <= WORD_BITS else place.units(count, total))
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

    def _places_for(self, x: Integral, level: int) -> Iterator[Place]:
        """Homomorphisms that x and s_1 .. s_level have images under, made as they are needed."""
        masks = [*self._support(level), *_leaf_masks(x)]
        self._spend(1 + (len(masks) * (1 + len(self._base)) >> 3))
        basis = tuple(_span(masks))
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
            radicand = self._radicands[len(self._supports) - 1]
            masks = [*self._supports[-1], *_leaf_masks(radicand)]
            self._spend(1 + (len(masks) * (1 + len(self._base)) >> 3))
            self._supports.append(tuple(_span(masks)))
        return self._supports[level]

    def _new_place(self, basis: tuple[int, ...], level: int) -> Place | None:
        for modulus in self._moduli(basis):
            place = Place(self, modulus)
            if place.split(basis) and place.lift(self._radicands[:level]):
                return place
        return None

    def _moduli(self, basis: tuple[int, ...]) -> Iterator[int]:
        """Random primes (probably), modulo which the base products in the basis are likely squares.

        Few products: any prime does, once in 2**len(basis). Many: n = r**2 modulo 8 times every odd
        part of an m, so that 2 is a square modulo n, and by reciprocity each odd part, as n = 1
        modulo 4. Which of the two is quicker was measured: see `_by_reciprocity`.
        """
        odd = ONE
        union = 0
        for mask in basis:
            union |= mask
        if _by_reciprocity(len(basis), self._product(union).bit_length()):
            for i, m in enumerate(self._base):
                if union >> i & 1:
                    odd *= m // (m & -m) if m % 2 == 0 else m
            tries = PRIME_TRIES
        else:
            tries = PRIME_TRIES << len(basis)
        step = int(8 * odd)
        span = max(1 << 16, (1 << 61) // step)
        bits = (step * span).bit_length()
        # About one odd number in bits / 3 is prime; 10 for what is then computed modulo it (see WORD_BITS).
        units = bits * primality_units(bits) // 3 + 10
        for _ in range(tries):
            self._spend(units)
            r = self._random.randrange(step) | 1
            while odd.gcd(r) != 1:
                r = self._random.randrange(step) | 1
            n = 0
            while not fmpz(n).is_probable_prime():
                n = r * r % step + step * self._random.randrange(1, span)
            yield n

    # -- arithmetic of integral values ---------------------------------------------------

    def _element(self, x: Integral) -> Element:
        return _reduced(self, x, ONE)

    def _own(self, e: Element | Rational) -> Element:
        if isinstance(e, Element):
            if e.tower is not self:
                raise ValueError(f"{_brief(e)} belongs to another tower")
            return e
        return self.rational(e)

    def _product(self, mask: int) -> fmpz:
        """The product of the base radicands in mask."""
        known = self._products.get(mask)
        if known is None:
            low = mask & -mask
            known = self._product(mask ^ low) * self._base[low.bit_length() - 1]
            if self.work is not None and known > LONG:
                self._spend(1 + product_units(known.bit_length(), SHORT_BITS))
            self._products[mask] = known
        return known

    def _mul(self, x: Integral, y: Integral) -> Integral:
        if isinstance(x, fmpz):
            if (x > LONG or x < LONG_NEGATIVE) and self.work is not None:
                self._spend_scaling(y, x.bit_length())
            return _scale(y, x)
        if isinstance(y, fmpz):
            if (y > LONG or y < LONG_NEGATIVE) and self.work is not None:
                self._spend_scaling(x, y.bit_length())
            return _scale(x, y)
        if isinstance(x, dict):
            if isinstance(y, dict):
                return self._mul_surds(x, y)
            return Nested(y.level, self._mul(y.a, x), self._mul(y.b, x))
        if isinstance(y, dict) or x.level > y.level:
            return Nested(x.level, self._mul(x.a, y), self._mul(x.b, y))
        if x.level < y.level:
            return Nested(y.level, self._mul(y.a, x), self._mul(y.b, x))
        if self.work is not None:
            self._spend(4)
        mul = self._mul
        radicand = self._radicands[x.level - 1]
        a, b, c, d = x.a, x.b, y.a, y.b
        high = mul(b, d)
        if not a or not c or isinstance(b, fmpz) or isinstance(d, fmpz):
            low = mul(a, c)
            cross = _add(mul(a, d), mul(b, c))
        elif x is y:
            low = mul(a, a)
            cross = _scale(mul(a, b), fmpz(2))
        else:  # Karatsuba
            low = mul(a, c)
            cross = _sub(mul(_add(a, b), _add(c, d)), _add(low, high))
        return _nested(x.level, _add(low, mul(high, radicand)), cross)

    def _mul_surds(self, x: dict[int, fmpz], y: dict[int, fmpz]) -> Integral:
        if self.work is not None:
            self._spend_product(x, y)
        terms: dict[int, fmpz] = {}
        for p, c in x.items():
            for q, d in y.items():
                term = c * d
                if p & q:
                    term *= self._product(p & q)
                mask = p ^ q
                terms[mask] = terms[mask] + term if mask in terms else term
        return _surds(terms)

    def _inverse(self, x: Integral) -> tuple[Integral, fmpz]:
        """(y, d) with 1 / x = y / d, for x != 0; d > 0 has no factor common to all of y."""
        if isinstance(x, fmpz):
            return (ONE, x) if x > 0 else (fmpz(-1), -x)
        common = self._content(x)
        if common != 1:
            x = self._quotient(x, common)
        assert not isinstance(x, fmpz)
        if isinstance(x, dict):
            a, y = _split_bit(x, max(x).bit_length() - 1)
            norm = _sub(self._mul(a, a), self._mul(y, y))
            conjugate = _sub(a, y)
        else:
            square = self._mul(self._mul(x.b, x.b), self._radicands[x.level - 1])
            norm = _sub(self._mul(x.a, x.a), square)
            conjugate = Nested(x.level, x.a, _neg(x.b))
        inverse, d = self._inverse(norm)
        product = self._mul(conjugate, inverse)
        d *= common
        g = self._content(product, d)
        return self._quotient(product, g), d // g

    # -- enclosures ------------------------------------------------------------------------

    def _sign(self, x: Integral) -> int:
        """-1, 0 or +1; a ball at rising precision decides what is not zero by its form."""
        if isinstance(x, fmpz):
            return (x > 0) - (x < 0)
        bits = FIRST_BITS
        while True:
            value = self._ball(x, bits)
            if value > 0:
                return 1
            if value < 0:
                return -1
            bits *= 2

    def _ball(self, x: Integral, precision: int) -> arb:
        """x computed once at that working precision, however inaccurate."""
        frame = self._frames.get(precision)
        if frame is None:
            frame = self._frames[precision] = _Frame(self, precision)
        with ctx.workprec(precision):
            return frame.value(x)

    def _accurate_ball(self, x: Integral, bits: int) -> arb:
        """x to a relative accuracy of about `bits`."""
        if not x:
            return arb(0)
        precision = bits + 16
        while True:
            value = self._ball(x, precision)
            if value.rel_accuracy_bits() >= bits:
                return value
            precision *= 2

    def _radicand(self, k: int) -> Element:
        return self._element(self._radicands[k - 1])


class _Frame:
    """The generators of a tower as balls of one precision."""

    __slots__ = ("_nested", "_precision", "_roots", "_tower", "_units")

    def __init__(self, tower: Tower, precision: int) -> None:
        self._tower = tower
        self._precision = precision
        self._units = 1 + 2 * product_units(precision, precision)  # of two terms
        self._roots: dict[int, arb] = {0: arb(1)}
        self._nested: dict[int, arb] = {}

    def value(self, x: Integral) -> arb:
        if isinstance(x, fmpz):
            return arb(x)
        if isinstance(x, dict):
            if self._tower.work is not None:
                self._tower._spend(len(x) * self._units >> 1)
            total = arb(0)
            for mask, c in x.items():
                total += self._root(mask) * c
            return total
        if self._tower.work is not None:
            self._tower._spend(self._units)
        return self.value(x.a) + self.value(x.b) * self._generator(x.level)

    def _root(self, mask: int) -> arb:
        known = self._roots.get(mask)
        if known is None:
            self._tower._spend(2 * self._units)
            known = self._roots[mask] = arb(self._tower._product(mask)).sqrt()
        return known

    def _generator(self, level: int) -> arb:
        """s_level; its radicand is made accurate first, for it may cancel nearly to zero."""
        known = self._nested.get(level)
        if known is None:
            radicand = self._tower._radicands[level - 1]
            self._tower._spend(2 * self._units)
            known = self._tower._accurate_ball(radicand, self._precision).sqrt()
            self._nested[level] = known
        return known


# --------------------------------------------------------------------------------------
# Its elements.
# --------------------------------------------------------------------------------------


def _fmpq(q: Rational) -> fmpq:
    if isinstance(q, Fraction):
        return fmpq(q.numerator, q.denominator)
    if isinstance(q, (int, fmpz, fmpq)):
        return fmpq(q)
    raise TypeError(f"{q!r} is not a rational number")


class Element:
    """A number of a `Tower`: immutable, in normal form, num / den with den > 0.

    Use + - * / and whole powers with elements of the same tower and with rational numbers.
    == is exact. There is no order: ask `sign()` of a difference.

    >>> tower = Tower()
    >>> phi = (1 + tower.sqrt(5)) / 2
    >>> phi * phi == phi + 1, (phi - 2).sign(), (phi**-1).text()
    (True, -1, '1/2*sqrt(5) - 1/2')
    """

    __slots__ = ("den", "num", "tower")

    tower: Tower
    num: Integral
    den: fmpz

    def __init__(self, tower: Tower, num: Integral, den: fmpz) -> None:
        if tower.work is not None:
            tower._spend(1 if isinstance(num, fmpz) else 1 + (_count(num) >> 1))
        if den != 1:
            g = _content(num, den) if den < LONG else tower._content(num, den)
            if g != 1:
                num, den = tower._quotient(num, g), den // g
        self.tower = tower
        self.num = num
        self.den = den

    def __repr__(self) -> str:
        return f"Element({self.text()})"

    def _other(self, other: object) -> Element | None:
        if isinstance(other, Element):
            if other.tower is not self.tower:
                raise ValueError(f"{_brief(other)} belongs to another tower")
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
        return hash((_key(self.num), self.den))

    def __neg__(self) -> Element:
        return _reduced(self.tower, _neg(self.num), self.den)

    def __pos__(self) -> Element:
        return self

    def __abs__(self) -> Element:
        return -self if self.sign() < 0 else self

    def __add__(self, other: Element | Rational) -> Element:
        e = self._other(other)
        if e is None:
            return NotImplemented
        if self.den == e.den:
            return Element(self.tower, _add(self.num, e.num), self.den)
        scale = _scale
        if self.den > LONG or e.den > LONG:
            self.tower._spend(gcd_units(self.den.bit_length(), e.den.bit_length()))
            scale = self.tower._mul
        g = self.den.gcd(e.den)
        left, right = e.den // g, self.den // g
        return Element(self.tower, _add(scale(self.num, left), scale(e.num, right)), self.den * left)

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
        return Element(self.tower, self.tower._mul(self.num, e.num), self.den * e.den)

    __rmul__ = __mul__

    def __truediv__(self, other: Element | Rational) -> Element:
        e = self._other(other)
        if e is None:
            return NotImplemented
        return self * e._inverse()

    def __rtruediv__(self, other: Rational) -> Element:
        return self._inverse() * other

    def __pow__(self, exponent: int) -> Element:
        if exponent < 0:
            return self._inverse() ** -exponent
        power = self.tower.rational(1)
        for bit in bin(exponent)[2:]:
            power = power * power
            if bit == "1":
                power = power * self
        return power

    def _inverse(self) -> Element:
        if not self.num:
            raise ZeroDivisionError("division by zero in a tower")
        inverse, d = self.tower._inverse(self.num)
        return Element(self.tower, self.tower._mul(inverse, self.den), d)

    def is_zero(self) -> bool:
        """Whether this is exactly 0: read off the normal form."""
        return not self.num

    def sign(self) -> int:
        """-1, 0 or +1, exactly. A ball at rising precision is only asked of what is not zero."""
        return self.tower._sign(self.num)

    def ball(self, bits: int) -> arb:
        """An enclosure with a relative accuracy of about `bits` binary digits.

        >>> tower = Tower()
        >>> (tower.sqrt(10**40 + 1) - 10**20).ball(30)
        [5.000000000000e-21 +/- 1.23e-34]
        """
        if not self.num:
            return arb(0)
        value = self.tower._accurate_ball(self.num, bits + 2)
        with ctx.workprec(bits + 16):
            return value / self.den

    @property
    def is_rational(self) -> bool:
        """Whether no root is left in it."""
        return isinstance(self.num, fmpz)

    def fraction(self) -> fmpq | None:
        """The rational number that this is, or None."""
        return fmpq(self.num, self.den) if isinstance(self.num, fmpz) else None

    def height_bits(self) -> int:
        """The length in bits of the longest coefficient, or of the denominator."""
        return max(self.den.bit_length(), *(c.bit_length() for c in _coefficients(self.num)))

    def levels(self) -> frozenset[int]:
        """Indices into `tower.generators` of the generators in it and in their radicands.

        >>> tower = Tower()
        >>> a, b = tower.sqrt(2), tower.sqrt(3)
        >>> sorted(tower.sqrt(1 + b).levels())
        [1, 2]
        """
        base, nested = _used(self.tower, self.num)
        made = enumerate(self.tower._made)
        return frozenset(i for i, (deep, k) in made if (nested if deep else base) >> k & 1)

    def text(self) -> str:
        """In the grammar of scene files: + - * / sqrt ( ).

        >>> tower = Tower()
        >>> (tower.sqrt(3) / 2 - 175).text()
        '1/2*sqrt(3) - 175'
        """
        out = ""
        for c, factor in _terms(self.tower, self.num, self.den):
            size = abs(c)
            body = factor if factor and size == 1 else f"{size}*{factor}" if factor else str(size)
            if not out:
                out = body if c > 0 else f"-{body}"
            else:
                out += f" + {body}" if c > 0 else f" - {body}"
        return out or "0"

    def sympy(self) -> sympy.Expr:
        """The same number as a SymPy expression."""
        return _sympy(self.tower, self.num, self.den)


def _reduced(tower: Tower, num: Integral, den: fmpz) -> Element:
    """An element whose fraction is known to be in lowest terms."""
    e = Element.__new__(Element)
    e.tower, e.num, e.den = tower, num, den
    return e


def _used(tower: Tower, x: Integral) -> tuple[int, int]:
    """Bits of the base, and of the nested generators, in x and in the radicands in x."""
    if not isinstance(x, Nested):
        return _masks(x), 0
    base, nested = 0, 1 << (x.level - 1)
    for part in (x.a, x.b, tower._radicands[x.level - 1]):
        more = _used(tower, part)
        base, nested = base | more[0], nested | more[1]
    return base, nested


def _terms(tower: Tower, x: Integral, den: fmpz) -> list[tuple[fmpq, str]]:
    """Coefficients and factors as text; nested roots first, the rational term last."""
    if isinstance(x, fmpz):
        return [(fmpq(x, den), "")] if x else []
    if isinstance(x, dict):
        surds = sorted((tower._product(mask), c) for mask, c in x.items() if mask)
        terms = [(fmpq(c, den), f"sqrt({m.str()})") for m, c in surds]
        return terms + ([(fmpq(x[0], den), "")] if 0 in x else [])
    root = f"sqrt({tower._radicand(x.level).text()})"
    inner = _terms(tower, x.b, den)
    if len(inner) == 1:
        c, factor = inner[0]
        head = (c, f"{factor}*{root}" if factor else root)
    else:
        head = (fmpq(1), f"({Element(tower, x.b, den).text()})*{root}")
    return [head, *_terms(tower, x.a, den)]


def _sympy(tower: Tower, x: Integral, den: fmpz) -> sympy.Expr:
    import sympy

    def rational(c: fmpz) -> sympy.Expr:
        return sympy.Integer(int(c)) / sympy.Integer(int(den))

    if isinstance(x, fmpz):
        return rational(x)
    if isinstance(x, dict):
        return sympy.Add(*(rational(c) * sympy.sqrt(int(tower._product(mask))) for mask, c in x.items()))
    root = sympy.sqrt(_sympy(tower, tower._radicands[x.level - 1], ONE))
    return _sympy(tower, x.a, den) + _sympy(tower, x.b, den) * root


def _brief(e: Element) -> str:
    """The element for a message: its text if short, else its size and about its value."""
    if e.height_bits() <= 64 and len(text := e.text()) <= 80:
        return text
    return f"{float(e.ball(53).mid())!r} (about; {e.height_bits()} bits)"


# --------------------------------------------------------------------------------------
# Signs of sums with roots outside of the tower.
# --------------------------------------------------------------------------------------


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

    Raises ValueError if d1 or d2 is negative.

    >>> tower = Tower()
    >>> q = tower.rational
    >>> sign_of_root_sum(q(1), q(2), q(2), q(-1), 9 + 4 * tower.sqrt(2))
    0
    """
    for d in (d1, d2):
        if d.sign() < 0:
            raise ValueError(f"square root of the negative number {_brief(d)}")
    for bits in FILTER_BITS:
        balls = [e.ball(bits) for e in (a, b, d1, c, d2)]
        with ctx.workprec(bits):
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
