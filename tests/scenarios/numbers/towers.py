"""Numbers of towers drawn at random, each beside its value to 400 digits, and numbers read from text."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import mpmath
import sympy
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

from truebreak.scenarios.numbers.nested_roots import Tower
from truebreak.scenarios.numbers.tower_element import Element
from truebreak.scenarios.work import Work

DIGITS = 400
TINY = mpmath.mpf(10) ** -300
UNITS = 20_000_000
"""Far above what any example needs: a zero that is not recognised would otherwise run for ever."""

law = settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much]
)


def fresh() -> Tower:
    return Tower(work=Work(UNITS))


small = st.fractions(min_value=-9, max_value=9, max_denominator=6)
Real = Any
"""An mpmath number; mpmath has no type stubs."""
Pair = tuple[Element, Real]


def exactly(q: Fraction) -> Real:
    return mpmath.mpf(q.numerator) / q.denominator


def number(draw: st.DrawFn, tower: Tower, depth: int) -> Pair:
    """A random expression with at most `depth` roots inside one another."""
    with mpmath.workdps(DIGITS):
        q = draw(small)
        element, value = tower.rational(q), exactly(q)
        for _ in range(draw(st.integers(0, 2)) if depth else 0):
            inside, number_inside = number(draw, tower, depth - 1)
            factor = draw(small)
            if abs(number_inside) < TINY:
                number_inside = mpmath.mpf(0)
            root = tower.sqrt(abs(inside)) * factor
            root_value = mpmath.sqrt(abs(number_inside)) * exactly(factor)
            if draw(st.booleans()):
                element, value = element + root, value + root_value
            else:
                element, value = element * root, value * root_value
        return element, value


@st.composite
def numbers(draw: st.DrawFn, count: int = 1, depth: int = 2) -> list[Pair]:
    tower = fresh()
    return [number(draw, tower, depth) for _ in range(count)]


def read(tower: Tower, text: str) -> Element:
    """The element that the text spells; only for texts of these tests."""
    tree = sympy.parse_expr(text, evaluate=False)

    def walk(e: sympy.Basic) -> Element:
        if isinstance(e, sympy.Rational):
            return tower.rational(Fraction(int(e.p), int(e.q)))
        parts = [walk(arg) for arg in e.args[:1]] if isinstance(e, sympy.Pow) else list(map(walk, e.args))
        if isinstance(e, sympy.Add):
            total = parts[0]
            for part in parts[1:]:
                total = total + part
            return total
        if isinstance(e, sympy.Mul):
            product = parts[0]
            for part in parts[1:]:
                product = product * part
            return product
        assert isinstance(e, sympy.Pow)
        exponent = e.args[1]
        if exponent == sympy.Rational(1, 2):
            return tower.sqrt(parts[0])
        if exponent == sympy.Rational(-1, 2):
            return 1 / tower.sqrt(parts[0])
        return parts[0] ** int(exponent)

    return walk(tree)
