"""Numbers of a tower as text and in SymPy."""

from __future__ import annotations

from fractions import Fraction

import mpmath
import pytest
import sympy
from hypothesis import given, settings
from towers import DIGITS, Pair, fresh, law, numbers, read


@settings(law, max_examples=25)
@given(numbers(1))
def test_sympy_and_text_spell_the_same_number(pairs: list[Pair]) -> None:
    e, value = pairs[0]
    with mpmath.workdps(DIGITS):
        for form in (e.sympy(), sympy.sympify(e.text())):
            assert abs(mpmath.mpf(form.evalf(60, maxn=400)) - value) <= abs(value) * mpmath.mpf(10) ** -50
    assert read(e.tower, e.text()) == e


def test_text_forms() -> None:
    t = fresh()
    r = t.sqrt(3)
    assert t.rational(0).text() == "0"
    assert t.rational(Fraction(-7, 2)).text() == "-7/2"
    assert (r / 2 - 175).text() == "1/2*sqrt(3) - 175"
    assert (-r).text() == "-sqrt(3)"
    nested = t.sqrt(1 + r)
    assert nested.text() == "sqrt(sqrt(3) + 1)"
    assert (5 - (2 + r) * nested).text() == "(-sqrt(3) - 2)*sqrt(sqrt(3) + 1) + 5"


@pytest.mark.parametrize("text", ["sqrt(2)*sqrt(3)", "sqrt(2 + sqrt(2))", "sqrt(5) + sqrt(3)", "sqrt(1 + sqrt(3))"])
def test_minimal_degree_agrees_with_sympy(text: str) -> None:
    t = fresh()
    e = read(t, text)
    degree = sympy.degree(sympy.minimal_polynomial(e.sympy(), sympy.Symbol("x")))
    assert 2 ** len(t.generators) % degree == 0
    assert ((e**2).fraction() is not None) == (degree == 2 and sympy.expand(e.sympy() ** 2).is_rational)


def test_height_and_fraction() -> None:
    t = fresh()
    a, b = t.sqrt(2), t.sqrt(3)
    assert (1023 * a).height_bits() == 10
    assert (a / 1024).height_bits() == 11
    assert (a * a).fraction() == 2
    assert a.fraction() is None
    assert hash(a * a) == hash(2)
    assert {a * b, b * a, t.sqrt(6)} == {t.sqrt(6)}
