"""Is a number a square in the field? Its root by descent, or the proof that it has none."""

from __future__ import annotations

from flint import fmpz

from ....work import gcd_units, product_units, sqrt_units
from ..element import AnyTower, Element, reduced
from ..ring import ONE, ZERO, Integral, Nested, masks_of, split_bit, subtract, surds
from .characters import Characters
from .squares import square_subset


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
