"""Identities among nested roots that are known from elsewhere, and large and unlucky numbers."""

from __future__ import annotations

import itertools
from fractions import Fraction

import pytest
import sympy
from towers import fresh, read

from truebreak.scenarios.numbers.nested_roots import Tower


def test_products_of_roots_of_whole_numbers() -> None:
    t = fresh()
    assert t.sqrt(2) * t.sqrt(8) == 4
    assert t.sqrt(6) == t.sqrt(2) * t.sqrt(3)
    assert t.sqrt(Fraction(1, 2)) == t.sqrt(2) / 2
    assert t.sqrt(Fraction(9, 4)) == Fraction(3, 2)
    assert t.sqrt(0) == 0
    assert len(t.generators) == 2


@pytest.mark.parametrize("late", [True, False])
def test_sqrt_of_5_plus_2_sqrt_6_in_either_order(late: bool) -> None:
    t = fresh()
    if late:
        root = t.sqrt(5 + 2 * t.sqrt(6))
        assert root == t.sqrt(2) + t.sqrt(3)
    else:
        total = t.sqrt(2) + t.sqrt(3)
        assert total == t.sqrt(5 + 2 * t.sqrt(6))
    assert len(t.generators) == 2


def test_sqrt_of_2_plus_sqrt_3() -> None:
    t = fresh()
    assert t.sqrt(2 + t.sqrt(3)) == (t.sqrt(6) + t.sqrt(2)) / 2
    assert t.sqrt(2 - t.sqrt(3)) == (t.sqrt(6) - t.sqrt(2)) / 2


def test_conjugate_nested_roots_share_a_generator() -> None:
    t = fresh()
    assert t.sqrt(2 - t.sqrt(2)) * t.sqrt(2 + t.sqrt(2)) == t.sqrt(2)
    assert t.depth == 2


def test_a_rational_that_becomes_a_square_only_through_two_nested_roots() -> None:
    """sqrt(5 + sqrt(2)) sqrt(5 - sqrt(2)) = sqrt(23), though no single one contains it."""
    t = fresh()
    product = t.sqrt(5 + t.sqrt(2)) * t.sqrt(5 - t.sqrt(2))
    before = len(t.generators)
    assert product == t.sqrt(23)
    assert t.sqrt(46) == t.sqrt(2) * product
    assert len(t.generators) == before


def test_a_square_norm_that_leads_back_to_its_start() -> None:
    """3**2 - 2 = 7: with both roots there, halving goes from 3 + sqrt 2 to 3 + sqrt 7 and back."""
    for first, second in ((2, 7), (7, 2)):
        t = fresh()
        for m in (first, second):
            t.sqrt(m)
        a, b = t.sqrt(3 + t.sqrt(2)), t.sqrt(3 - t.sqrt(2))
        assert a * b == t.sqrt(7)
        assert a + b == t.sqrt(6 + 2 * t.sqrt(7))
        assert len(t.generators) == 3


def test_pentagon() -> None:
    t = fresh()
    r5 = t.sqrt(5)
    cos36, sin36 = (1 + r5) / 4, t.sqrt(10 - 2 * r5) / 4
    cos72, sin72 = (r5 - 1) / 4, t.sqrt(10 + 2 * r5) / 4
    assert cos36**2 + sin36**2 == 1
    assert cos72**2 + sin72**2 == 1
    assert sin72 == 2 * sin36 * cos36
    assert cos72 == cos36**2 - sin36**2
    assert sin36 * sin72 == r5 / 4
    golden = 2 * cos36
    assert golden**2 == golden + 1
    assert t.depth == 2


def test_seventeen_sided_polygon() -> None:
    """Gauss: cos(2 pi / 17); its Chebyshev polynomial T_17 takes it to 1."""
    t = fresh()
    r = t.sqrt(17)
    a = t.sqrt(34 - 2 * r)
    c = (-1 + r + a + 2 * t.sqrt(17 + 3 * r - a - 2 * t.sqrt(34 + 2 * r))) / 16
    previous, current = t.rational(1), c
    for _ in range(16):
        previous, current = current, 2 * c * current - previous
    assert current == 1
    assert t.depth == 3


@pytest.mark.parametrize(
    "radicand, denested",
    [
        ("16 - 2*sqrt(29) + 2*sqrt(55 - 10*sqrt(29))", "sqrt(5) + sqrt(11 - 2*sqrt(29))"),
        ("112 + 70*sqrt(2) + (46 + 34*sqrt(2))*sqrt(5)", "5 + 4*sqrt(2) + (3 + sqrt(2))*sqrt(5)"),
        ("10 + 2*sqrt(6) + 2*sqrt(10) + 2*sqrt(15)", "sqrt(2) + sqrt(3) + sqrt(5)"),
        ("sqrt(16 + 6*sqrt(7)) + 3 + sqrt(7) + 1 - sqrt(7)", None),
        ("13 + 30*sqrt(2 + sqrt(9 + 4*sqrt(2)))", "5 + 3*sqrt(2)"),
        ("7 + 4*sqrt(3)", "2 + sqrt(3)"),
        ("49 + 20*sqrt(6)", "5 + 2*sqrt(6)"),
    ],
)
def test_denesting(radicand: str, denested: str | None) -> None:
    """Zippel, Shanks, Ramanujan and Bhaskara: nested roots that are simpler than they look."""
    t = fresh()
    root = t.sqrt(read(t, radicand))
    if denested is not None:
        # Bhaskara's 13 + 30 sqrt(...) = 43 + 30 sqrt(2)
        assert root == read(t, denested)


def test_sum_of_denesting_shanks() -> None:
    """Shanks, *Incredible identities* (1974): both sides agree to all digits, for they are equal."""
    t = fresh()
    r5, r29 = t.sqrt(5), t.sqrt(29)
    left = r5 + t.sqrt(22 + 2 * r5)
    inner = t.sqrt(16 - 2 * r29 + 2 * t.sqrt(55 - 10 * r29))
    right = t.sqrt(11 + 2 * r29) + inner
    assert left == right
    assert (left - right).is_zero()


def test_nearly_zero_is_not_zero() -> None:
    t = fresh()
    e = t.sqrt(10**40 + 1) - 10**20
    assert e.sign() == 1
    assert not e.is_zero()
    assert (t.sqrt(10**400 - 1) - 10**200).sign() == -1
    assert (e - Fraction(1, 2 * 10**20)).sign() == -1
    # sqrt(a) + sqrt(a + 2) < 2 sqrt(a + 1), by about a**(-3/2) / 4
    a = 10**60
    assert (t.sqrt(a) + t.sqrt(a + 2) - 2 * t.sqrt(a + 1)).sign() == -1


def test_a_radicand_that_nearly_vanishes() -> None:
    t = fresh()
    tiny = t.sqrt(10**80 + 1) - 10**40
    root = t.sqrt(tiny)
    assert root * root == tiny
    assert (root - tiny).sign() == 1
    assert root.ball(200).rel_accuracy_bits() >= 200


def test_hard_numbers_need_no_factoring() -> None:
    p, q = (int(sympy.nextprime(10**k)) for k in (80, 90))
    for order in itertools.permutations((p * q, p, q)):
        t = fresh()
        for n in order:
            t.sqrt(n)
        assert len(t.generators) == 2
        assert t.sqrt(p) * t.sqrt(q) == t.sqrt(p * q)
        assert t.sqrt(p * p * q) == p * t.sqrt(q)
        assert t.sqrt(6 * p) == t.sqrt(2) * t.sqrt(3) * t.sqrt(p)


def test_a_hidden_square_factor_is_found_when_it_matters() -> None:
    p, q = int(sympy.nextprime(10**60)), int(sympy.nextprime(10**70))
    t = fresh()
    root = t.sqrt(p * p * q)
    assert t.sqrt(q) == root / p
    assert len(t.generators) == 1


def test_forty_roots_of_primes_are_little_work() -> None:
    t = fresh()
    total = t.rational(0)
    for i in range(1, 41):
        total = total + t.sqrt(int(sympy.prime(i)))
    square = total * total
    assert (square - 200_000).sign() == -1
    assert total.sign() == 1
    assert t.work is not None
    assert t.work.spent < 2_000_000
    assert len(t.generators) == 40
    assert t.depth == 1


def test_negative_and_foreign_numbers_are_refused() -> None:
    t = fresh()
    with pytest.raises(ValueError, match="negative"):
        t.sqrt(-1)
    with pytest.raises(ValueError, match="negative number sqrt\\(2\\) - 2"):
        t.sqrt(t.sqrt(2) - 2)
    with pytest.raises(ValueError, match="another tower"):
        _ = t.sqrt(2) + Tower().sqrt(2)
    with pytest.raises(ZeroDivisionError):
        _ = t.sqrt(2) / (t.sqrt(8) - 2 * t.sqrt(2))
    with pytest.raises(TypeError):
        t.rational(0.5)  # type: ignore[arg-type]
    assert t.sqrt(2) != 0.5
