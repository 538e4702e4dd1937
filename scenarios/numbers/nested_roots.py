"""Real numbers made of nested square roots, in a normal form in which zero is decided.

The field is K = Q(sqrt(m_1), sqrt(m_2), ...)(s_1)(s_2)... and grows as roots are asked for:

- the *base* M = Q(sqrt(m_1), ...): whole numbers m_i > 1 of which no product of distinct ones
  is a square, usually primes. An element is a sparse sum of c * sqrt(product of some m_i);
- the *nested generators* s_k = +sqrt(D_k), with D_k > 0 in Q(..., s_1, ..., s_(k-1)) and
  certified not to be a square there.

The products of distinct generators are then a basis of K over Q, so an element is zero exactly
if all its coefficients are. Everything rests on one question: *is x a square in K?* It is
answered by descent (`tower_descent.Descent`), and a "yes" is squared again before it is believed. A "no"
mostly comes at once from reductions modulo primes (`tower_descent.Characters`).

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

from typing import TYPE_CHECKING

from flint import fmpz

from ..lazy import kept
from ..work import Work
from .tower_element import Element, Rational, rational_number, reduced
from .tower_ring import ONE, ZERO, Integral, Nested, TowerField, TowerLimit, masks_of, split_bit, subtract

if TYPE_CHECKING:
    from .tower_descent import Descent


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
        self.field = TowerField(work)
        self._roots: dict[Element, Element] = {}

    def __repr__(self) -> str:
        return f"Tower({', '.join(g.text() for g in self.generators)})"

    @kept
    def _descent(self) -> Descent:
        """Finds roots. Most runs ask for none, so that its module is imported when one does."""
        from .tower_descent import Descent

        return Descent(self)

    @property
    def work(self) -> Work | None:
        """What counts the work done here."""
        return self.field.work

    @work.setter
    def work(self, work: Work | None) -> None:
        self.field.work = work

    @property
    def depth(self) -> int:
        """Levels over Q: one for all roots of whole numbers, and one for each nested root."""
        return bool(self.field.base) + len(self.field.radicands)

    @property
    def generators(self) -> tuple[Element, ...]:
        """The roots that generate the field, in the order in which they were needed.

        >>> tower = Tower()
        >>> _ = tower.sqrt(1 + tower.sqrt(12))
        >>> [g.text() for g in tower.generators]
        ['sqrt(3)', 'sqrt(2*sqrt(3) + 1)']
        """
        made = self.field.made
        return tuple(self._element(Nested(i + 1, ZERO, ONE) if nested else {1 << i: ONE}) for nested, i in made)

    def rational(self, q: Rational) -> Element:
        """q as an element of this field."""
        q = rational_number(q)
        return reduced(self, q.p, q.q)

    def sqrt(self, e: Element | Rational) -> Element:
        """The square root of e that is not negative; the field grows only if it must.

        Raises:
            ValueError: if e is negative.
            TowerLimit: if a bound is met.

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
        if _positive(e):
            # sqrt(num / den) = sqrt(num * den) / den, and the squares leave the content.
            x = self.field.mul(e.num, e.den)
            if isinstance(x, fmpz):
                root = self._sqrt_whole(x)
            else:
                from .tower_descent import split_square

                content = self.field.content(x)
                factor, parts = split_square(content, self.field.spend)
                primitive = self.field.quotient(x, content)
                root = self._sqrt_integral(self.field.mul(primitive, _product(parts))) * factor
            self._roots[e] = root = _checked(root / e.den, e)
            return root
        return e

    def own_root(self, e: Element | Rational) -> Element | None:
        """The square root of e that is not negative if it lies in this field as it stands, else None.

        Raises:
            ValueError: if e is negative.
            TowerLimit: if the work allowed is spent.

        >>> tower = Tower()
        >>> three = tower.sqrt(3)
        >>> tower.own_root(tower.rational(12)), tower.own_root(tower.rational(2))
        (Element(2*sqrt(3)), None)
        """
        e = self._own(e)
        if not _positive(e):
            return e
        root = self._root(self.field.mul(e.num, e.den))
        return None if root is None else _checked(abs(root) / e.den, e)

    def _sqrt_whole(self, n: fmpz) -> Element:
        """sqrt(n) for a whole n > 0."""
        from .tower_descent import split_square

        factor, parts = split_square(n, self.field.spend)
        root = self._root(_product(parts))
        if root is not None:
            return abs(root) * factor
        product = self.rational(factor)
        for part in parts:
            root = self._root(part) if len(parts) > 1 else None
            product *= self._new_root(part) if root is None else abs(root)
        return product

    def _new_root(self, m: fmpz) -> Element:
        """The root of m > 1, known not to be a square in the whole field."""
        self._check_depth(len(self.field.radicands) + 1)
        return self._element(self.field.add_base(m))

    def _sqrt_integral(self, x: Integral) -> Element:
        """sqrt(x) for x > 0 that is not a whole number."""
        root = self._root(x)
        if root is not None:
            return abs(root)
        root = self._denested(x)
        if root is not None:
            return root
        self._check_depth(self.depth + 1)
        return self._element(self.field.add_nested(x))

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
            union = masks_of(x)
            bits = (bit for bit in range(union.bit_length()) if union >> bit & 1)
            parts = [(*split_bit(x, bit), 0, ~union | 1 << bit) for bit in bits]
        for a, y, level, forbidden in parts:
            n = self._descent.root(subtract(self.field.mul(a, a), self.field.mul(y, y)), level)
            if n is None or (level == 0 and masks_of(n.num) & forbidden):
                continue
            t = self.sqrt((self._element(a) + abs(n)) / 2)
            return t + self._element(y) / (2 * t)
        return None

    def _check_depth(self, depth: int) -> None:
        if self.max_depth is not None and depth > self.max_depth:
            raise TowerLimit(f"depth {depth} is over the bound of {self.max_depth}; raise max_depth")

    def _root(self, x: Integral) -> Element | None:
        """A root of x in the whole field as it stands."""
        return self._descent.root(x, len(self.field.radicands))

    def _element(self, x: Integral) -> Element:
        return reduced(self, x, ONE)

    def _own(self, e: Element | Rational) -> Element:
        if isinstance(e, Element):
            if e.tower is not self:
                raise ValueError(f"{e.brief()} belongs to another tower")
            return e
        return self.rational(e)


def _positive(e: Element) -> bool:
    """Whether it is above zero, and not zero.

    Raises:
        ValueError: if it is negative.
    """
    sign = e.sign()
    if sign < 0:
        raise ValueError(f"square root of the negative number {e.brief()}")
    return sign > 0


def _checked(root: Element, e: Element) -> Element:
    if root * root != e or root.sign() <= 0:
        raise AssertionError(f"sqrt({e.brief()}) did not square to its radicand: a defect")
    return root


def _product(parts: list[fmpz]) -> fmpz:
    product = ONE
    for part in parts:
        product *= part
    return product
