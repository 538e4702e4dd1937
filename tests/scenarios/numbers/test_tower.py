"""Laws of the tower: it is a field, its zeros are zeros, and its non-squares are non-squares."""

from __future__ import annotations

import itertools
import os
import subprocess
import sys
import time
from fractions import Fraction
from typing import Any

import mpmath
import pytest
import sympy
from flint import acb, arb, ctx, fmpq, fmpz, fmpz_poly
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from truebreak.scenarios.numbers import tower as tower_module
from truebreak.scenarios.numbers.tower import Element, Tower, TowerLimit, sign_of_root_sum
from truebreak.scenarios.work import Work, gcd_units, product_units

DIGITS = 400
TINY = mpmath.mpf(10) ** -300
UNITS = 20_000_000
"""Far above what any example needs: a zero that is not recognised would otherwise run for ever."""

law = settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much]
)


def fresh() -> Tower:
    return Tower(work=Work(UNITS))


# -- random numbers, each beside its value to 400 digits ---------------------------------------------

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


# -- a field -----------------------------------------------------------------------------------------


@law
@given(numbers(3))
def test_field_axioms(pairs: list[Pair]) -> None:
    (a, _), (b, _), (c, _) = pairs
    assert a + b == b + a
    assert a * b == b * a
    assert (a + b) + c == a + (b + c)
    assert (a * b) * c == a * (b * c)
    assert a * (b + c) == a * b + a * c
    assert a - a == 0
    assert (a - b) + b == a
    negative = -a
    assert -negative == a
    assert (a - b).is_zero() == (a == b)
    if not b.is_zero():
        assert b / b == 1
        assert a / b * b == a
        assert b**-2 * b * b == 1
    assert hash(a + b) == hash(b + a)


@law
@given(numbers(2), small)
def test_rational_operands_of_every_type(pairs: list[Pair], q: Fraction) -> None:
    a = pairs[0][0]
    e = a.tower.rational(q)
    for same in (q, fmpq(q.numerator, q.denominator)):
        assert a + same == same + a == a + e
        assert a - same == -(same - a) == a - e
        assert a * same == same * a == a * e
        if q:
            assert a / same == a / e
        if not a.is_zero():
            assert same / a == e / a
    assert a + 3 == a + fmpz(3)
    assert (a == q) == (a - e).is_zero()


@law
@given(numbers(2))
def test_sign_and_zero_agree_with_400_digits(pairs: list[Pair]) -> None:
    for (a, x), (b, y) in itertools.product(pairs, repeat=2):
        with mpmath.workdps(DIGITS):
            for e, value in ((a, x), (a + b, x + y), (a - b, x - y), (a * b, x * y)):
                expected = 0 if abs(value) < TINY else (1 if value > 0 else -1)
                assert e.sign() == expected
                assert e.is_zero() == (expected == 0)


@law
@given(numbers(1), st.sampled_from([10, 53, 200, 900]))
def test_ball_encloses_and_is_as_accurate_as_asked(pairs: list[Pair], bits: int) -> None:
    e, value = pairs[0]
    ball = e.ball(bits)
    assert ball.rel_accuracy_bits() >= bits
    with mpmath.workdps(DIGITS), ctx.workprec(1400):
        text = mpmath.nstr(value, DIGITS - 20)
        assert ball.overlaps(arb(text, arb(10) ** -340))


@law
@given(numbers(1))
def test_the_root_squares_to_its_radicand_and_is_not_negative(pairs: list[Pair]) -> None:
    e = abs(pairs[0][0])
    root = e.tower.sqrt(e)
    assert root * root == e
    assert root.sign() >= 0


@law
@given(numbers(1, depth=3))
def test_a_square_is_recognised_without_a_new_root(pairs: list[Pair]) -> None:
    e = pairs[0][0]
    tower = e.tower
    before = tower.generators
    assert tower.sqrt(e * e) == abs(e)
    assert tower.generators == before


@pytest.mark.parametrize("depth", range(5))
@pytest.mark.parametrize("seed", range(4))
def test_a_square_is_recognised_at_each_depth(depth: int, seed: int) -> None:
    tower = fresh()
    e = tower.rational(Fraction(seed + 1, 3))
    for k in range(depth):
        e = e * Fraction(seed + 1, k + 2) + tower.sqrt(e * e + 10 * k + seed + 5) - 1
    assert tower.depth == depth
    for f in (e, 3 * e - 1, e * e / 7 + 5, (e - 7) ** 3 if e != 7 else e):
        assert tower.sqrt(f * f) == abs(f)
    assert tower.depth == depth


# -- what was called a non-square is one -------------------------------------------------------------


def conjugates(tower: Tower, weights: list[int], bits: int) -> list[acb]:
    """All 2**n values of sum(weight * generator) over all choices of signs of the roots."""

    def value(x: tower_module.Integral, base: list[acb], nested: list[acb]) -> acb:
        if isinstance(x, fmpz):
            return acb(x)
        if isinstance(x, dict):
            total = acb(0)
            for mask, c in x.items():
                term = acb(c)
                for i, root in enumerate(base):
                    if mask >> i & 1:
                        term *= root
                total += term
            return total
        return value(x.a, base, nested) + value(x.b, base, nested) * nested[x.level - 1]

    values = []
    with ctx.workprec(bits):
        for signs in itertools.product((1, -1), repeat=len(tower._base) + len(tower._radicands)):
            chosen = iter(signs)
            base = [acb(m).sqrt() * next(chosen) for m in tower._base]
            nested: list[acb] = []
            for radicand in tower._radicands:
                nested.append(value(radicand, base, nested).sqrt() * next(chosen))
            values.append(sum((w * r for w, r in zip(weights, base + nested, strict=True)), acb(0)))
    return values


def characteristic_polynomial(values: list[acb], bits: int) -> fmpz_poly:
    """The product of X - value, which has whole coefficients."""
    with ctx.workprec(bits):
        coefficients = [acb(1)]
        for value in values:
            shifted = [acb(0), *coefficients]
            for i, c in enumerate(coefficients):
                shifted[i] -= c * value
            coefficients = shifted
        nearest = [c.real.unique_fmpz() for c in coefficients]
    whole = [c for c in nearest if c is not None]
    assert len(whole) == len(nearest), "more bits needed"
    return fmpz_poly(whole)


@settings(law, max_examples=40)
@given(numbers(1, depth=2), st.integers(0, 10**6))
def test_the_degree_over_q_is_two_to_the_number_of_roots(pairs: list[Pair], salt: int) -> None:
    """A witness that uses nothing of the tower's own tests: an irreducible polynomial of that
    degree with a root in the field."""
    tower = pairs[0][0].tower
    n = len(tower.generators)
    assume(1 <= n <= 5)
    bits = 20_000
    for attempt in range(5):
        weights = [1 + (salt * (attempt + 3) + 7 * i * (i + attempt + 1)) % 23 for i in range(n)]
        polynomial = characteristic_polynomial(conjugates(tower, weights, bits), bits)
        assert polynomial.degree() == 2**n
        _, factors = polynomial.factor()
        if len(factors) == 1 and factors[0][1] == 1:
            return
    pytest.fail(f"no generator of degree {2**n} in {tower}")


# -- known identities --------------------------------------------------------------------------------


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


def test_sum_of_denesting_shanks() -> None:
    """Shanks, *Incredible identities* (1974): both sides agree to all digits, for they are equal."""
    t = fresh()
    r5, r29 = t.sqrt(5), t.sqrt(29)
    left = r5 + t.sqrt(22 + 2 * r5)
    inner = t.sqrt(16 - 2 * r29 + 2 * t.sqrt(55 - 10 * r29))
    right = t.sqrt(11 + 2 * r29) + inner
    assert left == right
    assert (left - right).is_zero()


# -- large and unlucky numbers -----------------------------------------------------------------------


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


def test_forty_roots_of_primes_are_fast() -> None:
    t = fresh()
    start = time.perf_counter()
    total = t.rational(0)
    for i in range(1, 41):
        total = total + t.sqrt(int(sympy.prime(i)))
    square = total * total
    assert (square - 200_000).sign() == -1
    assert total.sign() == 1
    assert time.perf_counter() - start < 2
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


# -- whichever way the base is factored, and the places are found ---


@pytest.mark.parametrize("reciprocity", [True, False])
@settings(law, max_examples=30)
@given(st.data(), st.lists(st.sampled_from([6, 10, 12, 15, 35, 77, 143, 1001, 30030]), min_size=2, max_size=5))
def test_composite_radicands_and_either_source_of_primes(
    reciprocity: bool, data: st.DataObject, radicands: list[int]
) -> None:
    """Where nothing can be factored, the base is neither prime nor coprime, and no less right."""

    def unfactored(n: fmpz) -> list[tuple[fmpz, int]]:
        return [(n.isqrt(), 2)] if n.is_square() else [(n, 1)]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tower_module, "_factor", unfactored)
        patch.setattr(tower_module, "_by_reciprocity", lambda count, bits: reciprocity)
        rough = fresh()
        total = rough.rational(0)
        for n in radicands:
            total = total + rough.sqrt(n) * data.draw(small)
        nested = total + rough.sqrt(1 + total * total)
        before = rough.generators
        for i, j in itertools.combinations(radicands, 2):
            assert rough.sqrt(i * j) == rough.sqrt(i) * rough.sqrt(j)
        assert rough.sqrt(nested * nested) == abs(nested)
        assert rough.generators == before
    fine = fresh()
    for n in radicands:
        fine.sqrt(n)
    assert read(fine, total.text()).text() == read(fine, sympy.sstr(total.sympy())).text()


@law
@given(numbers(1))
def test_root_within_agrees_with_whether_the_root_needs_a_new_generator(pairs: list[Pair]) -> None:
    tower = pairs[0][0].tower
    for e in (abs(pairs[0][0]), abs(pairs[0][0] + 1), pairs[0][0] ** 2, tower.rational(6)):
        before = tower.generators
        within = tower.root_within(e)
        assert tower.generators == before
        root = tower.sqrt(e)
        assert (within is None) == (tower.generators != before)
        assert within is None or within == root


# -- limits ------------------------------------------------------------------------------------------


def test_depth_limit() -> None:
    t = Tower(max_depth=2)
    root = t.sqrt(1 + t.sqrt(2))
    assert t.depth == 2
    assert t.sqrt(3) * t.sqrt(3) == 3, "roots of whole numbers share one level"
    with pytest.raises(TowerLimit, match="depth 3"):
        t.sqrt(1 + root)
    assert t.depth == 2
    assert t.sqrt(root * root) == root
    with pytest.raises(TowerLimit):
        Tower(max_depth=0).sqrt(2)
    assert Tower(max_depth=0).sqrt(4) == 2


def test_work_limit() -> None:
    t = Tower()
    e = t.sqrt(1 + t.sqrt(2))
    t.work = Work(0)
    with pytest.raises(TowerLimit, match="the work allowed is spent"):
        _ = e * e
    with pytest.raises(TowerLimit):
        t.sqrt(e + 1)
    t.work = None
    assert e * e == 1 + t.sqrt(2)


def test_towers_that_share_work_share_its_limit() -> None:
    work = Work(1_000)
    first, second = Tower(work=work), Tower(work=work)
    with pytest.raises(TowerLimit):
        for k in range(2, 1_000):
            first.sqrt(k)
    assert work.is_spent
    with pytest.raises(TowerLimit):
        second.sqrt(2)


def several(t: Tower) -> list[Element]:
    """Numbers whose making goes through every way in which a tower grows."""
    a = t.sqrt(6) + t.sqrt(35) + t.sqrt(10**45 + 9)
    b = t.sqrt(2 + t.sqrt(3)) * t.sqrt(5 + t.sqrt(2))
    c = t.sqrt(b * b) / (1 + b) - t.sqrt(5 - t.sqrt(2)) * t.sqrt(23)
    d = t.sqrt(3 + t.sqrt(1 + t.sqrt(2)))
    return [a, b, c, t.sqrt(5 + 2 * t.sqrt(6)), d, t.sqrt((d + 1) ** 2), t.sqrt(77), t.sqrt(21)]


def few(t: Tower) -> list[Element]:
    return [t.sqrt(6) + t.sqrt(35), t.sqrt(77), t.sqrt(21), t.sqrt(t.sqrt(2) + 3), t.sqrt(5 + 2 * t.sqrt(6))]


@pytest.mark.parametrize("make, stops", [(few, 1_000), (several, 60)])
def test_a_tower_stopped_anywhere_goes_on_rightly(make: Any, stops: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Wherever the limit is met, nothing is left half done."""
    sums: list[int] = [0]
    with monkeypatch.context() as patch:
        patch.setattr(Work, "spend", lambda self, units: sums.append(sums[-1] + units))
        texts = [e.text() for e in make(Tower(work=Work()))]
    total = sums[-1]
    limits = sorted(set(sums) - {total})
    for limit in limits[:: max(1, len(limits) // stops)]:
        t = Tower(work=Work(limit))
        with pytest.raises(TowerLimit):
            make(t)
        t.work = None
        assert [e.text() for e in make(t)] == texts
        assert t.sqrt(14) * t.sqrt(15) == t.sqrt(210)
    assert [e.text() for e in make(Tower(work=Work(total)))] == texts, "what it spends is enough for it"


def grow_nested(t: Tower) -> None:
    e = t.rational(1)
    for k in range(40):
        e = t.sqrt(e * e + 3 * e + k) + 1 / (e + k + 1)


def grow_base(t: Tower) -> None:
    e = t.rational(1)
    for k in range(2, 60):
        e = e + t.sqrt(k)
    for _ in range(20):
        e = e * e


def grow_rational(t: Tower) -> None:
    e = t.rational(Fraction(2, 3))
    for _ in range(60):
        e = e * e + Fraction(1, 7)


def grow_terms(t: Tower) -> None:
    """Sums only: an element with 1,024 terms, over and over."""
    e = t.rational(1)
    for k in range(10):
        e = e * (1 + t.sqrt(int(sympy.prime(k + 1))))
    for k in range(10_000):
        e = e + k


@pytest.mark.parametrize("grow", [grow_nested, grow_base, grow_rational, grow_terms])
def test_work_stops_a_tower_that_grows_beyond_reason(grow: Any) -> None:
    t = Tower(work=Work(200_000))
    start = time.process_time()
    with pytest.raises(TowerLimit):
        grow(t)
    assert time.process_time() - start < 5, "a fifth of a second's work took twenty times as long"


def counted_terms(patch: pytest.MonkeyPatch) -> list[int]:
    """How many products of two terms each `_mul_surds` from here on computes."""
    done: list[int] = []
    plain = Tower._mul_surds

    def counting(self: Tower, x: Any, y: Any) -> Any:
        product = plain(self, x, y)
        done.append(len(x) * len(y))
        return product

    patch.setattr(Tower, "_mul_surds", counting)
    return done


def deep(t: Tower, bits: int) -> Element:
    """An element with 2**8 coefficients of about so many bits, in a tower of six levels."""
    for p in (2, 3, 5):
        t.sqrt(p)
    for k in range(5):
        t.sqrt(t.generators[-1] + k + 4)
    assert t.depth == 6
    e = t.rational(1)
    for i, generator in enumerate(t.generators):
        e = e * (generator + fmpz(3) ** (bits // 13) + i)
    assert tower_module._count(e.num) == 2**8
    return e


@pytest.mark.parametrize("operation", ["product", "inverse", "square"])
def test_one_step_in_a_deep_tower_ends_at_its_limit(operation: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """No step is taken that is not paid for: what is done within one operation stays within its limit."""
    t = Tower()
    e = deep(t, 1_000)
    square = e * e
    run, limit = {
        "product": (lambda: e * e, 3_000),
        "inverse": (lambda: 1 / e, 30_000),
        "square": (lambda: t.root_within(square), 30_000),
    }[operation]
    charges: list[int] = []
    spend = Work.spend

    def recording(self: Work, units: int) -> None:
        spend(self, units)
        charges.append(units)

    monkeypatch.setattr(Work, "spend", recording)
    done = counted_terms(monkeypatch)
    t.work = Work(limit)
    with pytest.raises(TowerLimit, match="--work"):
        run()
    assert sum(charges) <= limit, "what was refused was not done"
    assert len(charges) > 10
    assert sum(done) <= 2 * limit + 2, "a product of two terms counts half a unit at least"


def test_a_product_of_long_numbers_is_paid_for_before_it_is_computed() -> None:
    t = Tower()
    e = t.sqrt(2) * fmpz(3) ** 1_000_000 + fmpz(5) ** 1_000_000
    start = time.process_time()
    for step in (lambda: e * e, lambda: 1 / e, lambda: e * (fmpz(7) ** 1_000_000), lambda: e / fmpz(7) ** 1_000_000):
        t.work = Work(100)
        with pytest.raises(TowerLimit):
            step()
        assert t.work.is_spent
    assert time.process_time() - start < 5


def test_work_grows_with_the_length_of_the_numbers() -> None:
    for units in (product_units, gcd_units):
        lengths = [2**k for k in range(5, 24)]
        table = [units(bits, bits) for bits in lengths]
        assert table == sorted(table)
        assert all(2 * a <= b <= 6 * a + 10 for a, b in itertools.pairwise(table))
        assert units(1_000, 50_000) == units(50_000, 1_000)


SPENDING = """
from fractions import Fraction
from truebreak.scenarios.numbers.tower import Tower, TowerLimit, sign_of_root_sum
from truebreak.scenarios.work import Work

work = Work()
t = Tower(work=work)
e = t.rational(Fraction(2, 3))
for k in range(4):
    e = e * Fraction(3, k + 2) + t.sqrt(e * e + 10 * k + 7) - 1
    hash(e), e.text(), e.levels(), t.sqrt(e * e), (1 / e).sign(), {e, e + 1, e - 1}
t.root_within(e * e + 1 - e.sign())
for n in (3 * 10**60 + 9, 10**45 + 9, 720, 30030, 1001, 6 * (10**45 + 9)):
    e = e + t.sqrt(n) * t.sqrt(1 + t.sqrt(3))
one = t.rational(1)
print(sign_of_root_sum(one, one, t.sqrt(2), -one, 1 + t.sqrt(2) + 2 * t.sqrt(t.sqrt(2))), work.spent)
for limit in (1_000, 30_000, 200_000):
    t = Tower(work=Work(limit))
    try:
        e = t.rational(1)
        for k in range(40):
            e = t.sqrt(e * e + 3 * e + k) + 1 / (e + k + 1)
    except TowerLimit:
        print(limit, k, t.work.spent, len(t.generators))
"""


def test_the_same_computation_spends_the_same_work_in_every_process() -> None:
    told = set()
    for seed in ("0", "1", "4711", "random"):
        done = subprocess.run(
            [sys.executable, "-c", SPENDING],
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        )
        told.add(done.stdout)
    assert len(told) == 1, told
    assert len(told.pop().splitlines()) == 4


# -- other forms -------------------------------------------------------------------------------------


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
    assert 2 ** len(e.levels()) % degree == 0
    assert (e**2).is_rational == (degree == 2 and sympy.expand(e.sympy() ** 2).is_rational)


def test_levels_height_and_fraction() -> None:
    t = fresh()
    a, b, c = t.sqrt(2), t.sqrt(3), t.sqrt(1 + t.sqrt(3))
    assert a.levels() == {0}
    assert (a * b).levels() == {0, 1}
    assert c.levels() == {1, 2}
    assert t.rational(5).levels() == frozenset()
    assert (1023 * a).height_bits() == 10
    assert (a / 1024).height_bits() == 11
    assert (a * a).fraction() == 2
    assert a.fraction() is None
    assert (a * a).is_rational
    assert hash(a * a) == hash(2)
    assert {a * b, b * a, t.sqrt(6)} == {t.sqrt(6)}


# -- signs of sums with roots outside of the tower ---------------------------------------------------


@law
@given(numbers(5, depth=1))
def test_sign_of_root_sum_agrees_with_400_digits(pairs: list[Pair]) -> None:
    (a, x), (b, y), (d1, u), (c, z), (d2, w) = pairs
    d1, d2 = abs(d1), abs(d2)
    with mpmath.workdps(DIGITS):
        u, w = abs(u), abs(w)
        u, w = (mpmath.mpf(0) if abs(k) < TINY else k for k in (u, w))
        total = x + y * mpmath.sqrt(u) + z * mpmath.sqrt(w)
        expected = 0 if abs(total) < TINY else (1 if total > 0 else -1)
    before = a.tower.generators
    assert sign_of_root_sum(a, b, d1, c, d2) == expected
    assert a.tower.generators == before


@law
@given(numbers(4, depth=1), st.sampled_from([0, 1, -1]))
def test_sign_of_root_sum_at_and_beside_exact_zeros(pairs: list[Pair], nudge: int) -> None:
    """-(b u + c v) + b sqrt(u**2) + c sqrt(v**2) is 0; with a nudge of 10**-200 it is not."""
    b, u, c, v = (e for e, _ in pairs)
    tower = b.tower
    a = -(b * abs(u) + c * abs(v)) + Fraction(nudge, 10**200)
    before = tower.generators
    assert sign_of_root_sum(a, b, u * u, c, v * v) == nudge
    assert tower.generators == before


@law
@given(numbers(3, depth=1), st.sampled_from([1, -1]))
def test_sign_of_root_sum_with_conjugate_roots(pairs: list[Pair], order: int) -> None:
    """k sqrt(d) - sqrt(k**2 d) = 0 and s (sqrt(p + q sqrt(d)))... with no rational root in sight."""
    (k, _), (d, _), (e, _) = pairs
    k, d = abs(k), abs(d)
    zero = k.tower.rational(0)
    one = k.tower.rational(order)
    assert sign_of_root_sum(zero, k * order, d, -one, k * k * d) == 0
    # 1 + |e| sqrt(d) = sqrt(1 + e**2 d + 2 |e| sqrt(d)) needs sqrt(d) in the field
    root = k.tower.sqrt(d)
    e = abs(e)
    assert sign_of_root_sum(one, e * order, d, -one, 1 + e * e * d + 2 * e * root) == 0
    larger = 1 + e * e * d + 2 * e * root + Fraction(1, 10**150)
    assert sign_of_root_sum(one, e * order, d, -one, larger) == -order


def test_sign_of_root_sum_refuses_negative_radicands() -> None:
    t = fresh()
    one = t.rational(1)
    with pytest.raises(ValueError, match="negative number -sqrt"):
        sign_of_root_sum(one, one, 1 - t.sqrt(2), one, one)


# -- the two kinds of evidence agree -----------------------------------------------------------------


@settings(law, max_examples=40)
@given(numbers(1, depth=2))
def test_descent_without_places_gives_the_same_answers(pairs: list[Pair]) -> None:
    """The proofs by reduction only save time: the descent alone says square or not the same way."""
    e, _ = pairs[0]
    tower = e.tower
    for candidate in (e, e + 1, e * e, e * e + 1, 2 * e * e):
        x = (candidate if candidate.sign() > 0 else -candidate).num
        level = len(tower._radicands)
        quick = tower._root(x, level)
        patient, tower._refuted = tower._refuted, lambda x, level: False  # type: ignore[method-assign]
        try:
            slow = tower._root(x, level)
        finally:
            tower._refuted = patient  # type: ignore[method-assign]
        assert (quick is None) == (slow is None)
        if slow is not None:
            assert slow * slow == tower._element(x)
