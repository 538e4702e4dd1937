"""The two kinds of number of the checker: intervals of whole numbers, and fractions with square roots."""

import re
from fractions import Fraction
from math import isqrt

TEXT, ROOTS, SCENE_ROOTS, WORK = 20_000, 16, 12, 1 << 38
TERM = r"\d+(?:/0*[1-9]\d*)?(?:\*r\d+)*"


class Refuted(Exception):
    """The certificate states something false."""


class Malformed(Exception):
    """This is no certificate."""


class Undecided(Exception):
    """The intervals are too wide, or a witness is missing."""


class Ball:
    """The reals within r of m, in units of 2**-bits. What is exact at these bits stays so."""

    bits = 0

    def __init__(self, m, r=0):
        self.m, self.r = m, r

    def __add__(self, o):
        return Ball(self.m + o.m, self.r + o.r)

    def __neg__(self):
        return Ball(-self.m, self.r)

    def __sub__(self, o):
        return Ball(self.m - o.m, self.r + o.r)

    def __mul__(self, o):
        m, r = self.m * o.m, abs(self.m) * o.r + abs(o.m) * self.r + self.r * o.r
        return Ball(m, r).cut(Ball.bits)

    def cut(self, bits):
        """The same in units 2**bits as large."""
        kept = self.m >> bits
        return Ball(kept, 0 if self.r == 0 and kept << bits == self.m else (self.r >> bits) + 2)

    def __truediv__(self, o):
        if (least := abs(o.m) - o.r) <= 0:
            raise Undecided("a number that may be zero divides")
        m, rest = divmod(self.m << Ball.bits, o.m)
        if rest == self.r == o.r == 0:
            return Ball(m)
        return Ball(m, ((abs(self.m) * o.r // abs(o.m) + 1 + self.r) << Ball.bits) // least + 2)

    def sqrt(self):
        if (low := self.m - self.r) <= 0:
            raise Undecided("a number that may be negative has a root")
        root = isqrt(low << Ball.bits)
        if self.r == 0 and root * root == low << Ball.bits:
            return Ball(root)
        wide = (self.r << Ball.bits) // root + 2
        return Ball(root + (wide >> 1), (wide >> 1) + 1)

    def sign(self):
        """-1, 0 or +1; None where the interval does not tell."""
        return 1 if self.m > self.r else -1 if self.m < -self.r else 0 if self.m == self.r == 0 else None


class Exact:
    """a + b*sqrt(d): d is the k-th of `roots`, a and b use those before it; for k = 0 the fraction a."""

    roots, most, work, budget = [], ROOTS, 0, WORK

    def __init__(self, a, b=None, k=0):
        self.a, self.b, self.k = a, b, k

    def parts(self, k):
        return (self.a, self.b) if self.k == k else (self, ZERO)

    def __add__(self, o):
        if (k := max(self.k, o.k)) == 0:
            return Exact(self.a + o.a)
        (a, b), (c, d) = self.parts(k), o.parts(k)
        return a + c if (b + d).zero() else Exact(a + c, b + d, k)

    def __neg__(self):
        return Exact(-self.a, self.b and -self.b, self.k)

    def __sub__(self, o):
        return self + -o

    def __mul__(self, o):
        if (k := max(self.k, o.k)) == 0:
            sizes = [x.a.numerator.bit_length() + x.a.denominator.bit_length() for x in (self, o)]
            Exact.work += 10_000 + (sizes[0] * sizes[1] >> 8)  # about a nanosecond a unit
            if Exact.work > Exact.budget:
                raise Undecided("an exact witness takes too much work")
            return Exact(self.a * o.a)
        (a, b), (c, d) = self.parts(k), o.parts(k)
        high = a * d + b * c
        low = a * c if b.zero() or d.zero() else a * c + b * d * Exact.roots[k - 1]
        return low if high.zero() else Exact(low, high, k)

    def __truediv__(self, o):
        if o.k == 0:
            return self * Exact(1 / o.a)
        norm = o.a * o.a - o.b * o.b * Exact.roots[o.k - 1]
        return self * Exact(o.a / norm, -o.b / norm, o.k)

    def zero(self):
        return self.k == 0 and self.a == 0

    def ball(self):
        if self.k == 0:
            m, rest = divmod(self.a.numerator << Ball.bits, self.a.denominator)
            return Ball(m, int(rest > 0))
        return self.a.ball() + self.b.ball() * Exact.roots[self.k - 1].ball().sqrt()

    def sqrt(self):
        """The positive root: made of the roots at hand if it can be, else a new one."""
        if self.ball().sign() != 1:
            raise Undecided("a number that may not be positive has a root")
        if (found := self.within(len(Exact.roots))) is None:
            if len(Exact.roots) >= Exact.most:
                raise Undecided("an exact witness takes too many roots")
            Exact.roots.append(self)
            return Exact(ZERO, ONE, len(Exact.roots))
        if (sign := found.ball().sign()) is None:
            raise Undecided("a root may have either sign")
        return found if sign > 0 else -found

    def within(self, k):
        """A square root made of the first k roots, or None: from (c + e*sqrt(d))^2 = a + b*sqrt(d)."""
        if k == 0:
            p, q = isqrt(abs(self.a.numerator)), isqrt(self.a.denominator)
            return Exact(Fraction(p, q)) if Fraction(p * p, q * q) == self.a else None
        d, (a, b) = Exact.roots[k - 1], self.parts(k)
        if b.zero():
            e = None if (c := a.within(k - 1)) else (a / d).within(k - 1)
            return c or (e and Exact(ZERO, e, k))
        norm = (a * a - b * b * d).within(k - 1)
        for n in (norm, -norm) if norm else ():
            c = ((a + n) / Exact(Fraction(2))).within(k - 1)
            if c and not c.zero():
                return Exact(c, b / (c + c), k)
        return None


ZERO, ONE = Exact(Fraction(0)), Exact(Fraction(1))


def number(text):
    """Reads a sum of terms such as 3/4*r1*r2."""
    if len(text) > TEXT or not re.fullmatch(f"[+-]?{TERM}([+-]{TERM})*", text, re.ASCII):
        raise Malformed(f"{text[:40]!r} is no number")
    total = ZERO
    for term in re.findall(f"[+-]?{TERM}", text):
        factor, *names = term.split("*r")
        value = Exact(Fraction(factor))
        for k in map(int, names):
            if not 1 <= k <= len(Exact.roots):
                raise Malformed(f"there is no root r{k}")
            value = value * Exact(ZERO, ONE, k)
        total = total + value
    return total
