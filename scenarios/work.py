"""Counted work: a limit that the same computation meets at the same place on every machine and under every load.

A limit in seconds makes a proof depend on the machine, on what else runs on it, and on chance. So work is counted
as it is done: each step is charged, before it is taken, a number of units that depends on nothing but the lengths
of the whole numbers in it. All of it is computed in whole numbers, for a float may round elsewhere in another way.

A *unit* is about a microsecond: a multiplication of two 64-bit words with the interpreter's part in it, such
as the loops around it and the making of what holds the product. A long step counts for more, by tables of what flint
takes (`product_units`, `gcd_units` and the others).

Measured where the tables were: CPython 3.11, python-flint 0.9 (flint 3.6), one core of a shared virtual machine with
little else to do, in seconds per million units of work in a `Tower`. Its elements have all of their 2**(base + levels)
coefficients, of so many bits, in a tower of `levels` nested roots above the roots of `base` primes. The first figure is
for sums, products, inverses and signs, the second for tests of squares, where they end in reasonable time:

    base  levels        8 bits      1,000 bits    10,000 bits   100,000 bits
       0       0     2.0           1.6           0.8           0.8
       1       0     1.7   1.1     1.8   1.6     0.8   0.9     0.7
       3       0     0.9   1.8     1.5   1.1     1.0   0.6     1.0
       5       0     0.7           1.1           1.2           1.2
       1       1     1.5   1.7     2.3   2.2     1.4   0.7     0.8
       1       2     1.3   1.1     1.6   1.2     1.0   0.6     0.9
       2       3     1.0           1.4           1.2           1.1
       1       5     1.5           1.9           1.5

Chains of nested roots with the squares of what they lead to take 0.9 to 1.1, replays of collisions 1.8. Not counted
are reading a text and writing one.
"""

from __future__ import annotations

from typing import Final

__all__ = [
    "Work",
    "WorkSpent",
    "factor_units",
    "gcd_units",
    "inverse_units",
    "jacobi_units",
    "primality_units",
    "product_units",
    "sqrt_units",
    "sqrtmod_units",
]


class WorkSpent(Exception):
    """More work would be done than is allowed."""


class Work:
    """A counter of work with a limit.

    Attributes:
        limit: units allowed, or None for no limit; it may be changed at any time.
        spent: units charged so far, those of the step refused included.

    >>> work = Work(limit=10)
    >>> work.spend(7)
    >>> work.spend(7)
    Traceback (most recent call last):
        ...
    truebreak.scenarios.work.WorkSpent: 14 units of work, and 10 are allowed
    >>> work.spent, work.is_spent
    (14, True)
    """

    __slots__ = ("limit", "spent")

    def __init__(self, limit: int | None = None) -> None:
        self.limit = limit
        self.spent = 0

    def __repr__(self) -> str:
        return f"Work(limit={self.limit}, spent={self.spent})"

    def spend(self, units: int) -> None:
        """Counts work that is about to be done.

        Raises:
            WorkSpent: if it passes the limit; then it must not be done.
        """
        self.spent += units
        if self.limit is not None and self.spent > self.limit:
            raise WorkSpent(f"{self.spent} units of work, and {self.limit} are allowed")

    @property
    def is_spent(self) -> bool:
        """Whether the limit is passed, so that the next step will be refused too."""
        return self.limit is not None and self.spent > self.limit


# --------------------------------------------------------------------------------------
# What long whole numbers cost beyond the interpreter's part, by their lengths in bits.
# --------------------------------------------------------------------------------------

SCALE: Final = 20
"""The tables are in 2**-20 units for each bit."""

MAX_LENGTH_BITS: Final = 64
"""No length of a number has more bits than that."""


def _table(shorter_than_128: int, *doubling: int) -> tuple[int, ...]:
    """Entries by `length.bit_length()`, so by powers of two; the last one goes on."""
    entries = [shorter_than_128] * 8 + list(doubling)
    return tuple(entries + [entries[-1]] * (MAX_LENGTH_BITS - len(entries)))


PRODUCT: Final = _table(30, 60, 110, 200, 330, 390, 480, 700, 950, 1200, 1600, 1900, 2300, 2700, 2900)
"""A product for each bit of the longer factor, by the length of the shorter one: from 128 bits on, doubling. Flint
multiplies word by word up to about 2,000 bits, then by Karatsuba's and Toom's ways, then by fast Fourier transforms."""

GCD: Final = _table(
    2000, 3500, 4000, 4100, 4400, 4700, 5500, 10_000, 17_000, 26_000, 39_000, 52_000, 68_000, 84_000, 100_000
)
"""A greatest common divisor of two numbers of the same length, likewise. One that is long takes 1.5 times as much as
one that is 1; the table is between the two."""


def product_units(a: int, b: int) -> int:
    """A product of numbers of a and b bits; a quotient with remainder takes about twice that.

    >>> [product_units(bits, bits) for bits in (64, 1_000, 10_000, 100_000, 1_000_000)]
    [0, 0, 6, 152, 2574]
    """
    if a < b:
        a, b = b, a
    return a * PRODUCT[b.bit_length()] >> SCALE


def gcd_units(a: int, b: int) -> int:
    """A greatest common divisor of numbers of a and b bits: a remainder, and then Lehmer's or the half-gcd way.

    >>> [gcd_units(bits, bits) for bits in (64, 1_000, 10_000, 100_000, 1_000_000)]
    [0, 3, 95, 3719, 80108]
    """
    if a < b:
        a, b = b, a
    return ((a - b) * PRODUCT[b.bit_length()] * 2 + b * GCD[b.bit_length()]) >> SCALE


def sqrt_units(bits: int) -> int:
    """The whole root of a square, or the proof that a likely square is one.

    >>> [sqrt_units(bits) for bits in (64, 1_000, 10_000, 100_000, 1_000_000)]
    [0, 0, 4, 114, 2192]
    """
    return 2 * product_units(bits // 2, bits // 2)


def inverse_units(bits: int) -> int:
    """An inverse modulo a number of that many bits, by Python's own `pow`, which is quadratic.

    >>> [inverse_units(bits) for bits in (61, 1_000, 4_000)]
    [2, 63, 978]
    """
    return 2 + (bits * bits >> 14)


def jacobi_units(bits: int) -> int:
    """A Jacobi symbol modulo a number of that many bits.

    >>> [jacobi_units(bits) for bits in (61, 1_000, 4_000)]
    [0, 3, 15]
    """
    return bits >> 8


def sqrtmod_units(bits: int) -> int:
    """A square root modulo a prime of that many bits: 1.5 times less or more, by the twos in the prime less 1.

    >>> [sqrtmod_units(bits) for bits in (61, 1_000, 4_000)]
    [2, 721, 34424]
    """
    return 1 + (bits * bits * (bits + 512) >> 21)


def primality_units(bits: int) -> int:
    """One candidate in a search for a prime of that many bits: few of them are put to more than trial division.

    >>> [primality_units(bits) for bits in (61, 1_000, 4_000)]
    [1, 46, 1442]
    """
    return 1 + (bits * bits * (bits + 2048) >> 26)


def factor_units(bits: int, complete: bool) -> int:
    """A factorisation, complete or by trial of the first thousand primes.

    Numbers of the same length differ: a complete one of 60 bits takes 5 microseconds or 300, one of 90 bits takes
    0.2 to 5 ms, by how large the second largest prime factor is.

    >>> [factor_units(bits, complete=True) for bits in (30, 60, 90)], factor_units(2_000, complete=False)
    ([1, 41, 1501], 125)
    """
    if not complete:
        return bits >> 4
    return 1 + (40 if 48 < bits <= 64 else 50 * max(0, bits - 60) if bits > 64 else 0)
