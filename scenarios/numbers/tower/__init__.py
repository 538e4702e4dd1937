"""Real numbers made of nested square roots, in a normal form in which zero is decided.

The field is K = Q(sqrt(m_1), sqrt(m_2), ...)(s_1)(s_2)... and grows as roots are asked for:

- the *base* M = Q(sqrt(m_1), ...): whole numbers m_i > 1 of which no product of distinct ones
  is a square, usually primes. An element is a sparse sum of c * sqrt(product of some m_i);
- the *nested generators* s_k = +sqrt(D_k), with D_k > 0 in Q(..., s_1, ..., s_(k-1)) and
  certified not to be a square there.

The products of distinct generators are then a basis of K over Q, so an element is zero exactly
if all its coefficients are. Everything rests on one question: *is x a square in K?* It is
answered by descent (`roots.Descent`), and a "yes" is squared again before it is believed. A "no"
mostly comes at once from reductions modulo primes (`characters.Place`).

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

from .element import AnyTower, Element, Rational
from .field import TowerLimit
from .sums import sign_of_root_sum
from .tower import Tower

__all__ = ["AnyTower", "Element", "Rational", "Tower", "TowerLimit", "sign_of_root_sum"]
