"""What was called a non-square is one, whichever way that was found."""

from __future__ import annotations

import itertools

import pytest
import sympy
from flint import acb, ctx, fmpz, fmpz_poly
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from towers import Pair, fresh, law, numbers, read, small

from truebreak.scenarios.numbers import tower_descent
from truebreak.scenarios.numbers.nested_roots import Tower
from truebreak.scenarios.numbers.tower_descent import Characters, Descent
from truebreak.scenarios.numbers.tower_element import Element
from truebreak.scenarios.numbers.tower_ring import ONE, Integral


def conjugates(tower: Tower, weights: list[int], bits: int) -> list[acb]:
    """All 2**n values of sum(weight * generator) over all choices of signs of the roots."""

    def value(x: Integral, base: list[acb], nested: list[acb]) -> acb:
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
        for signs in itertools.product((1, -1), repeat=len(tower.field.base) + len(tower.field.radicands)):
            chosen = iter(signs)
            base = [acb(m).sqrt() * next(chosen) for m in tower.field.base]
            nested: list[acb] = []
            for radicand in tower.field.radicands:
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
        patch.setattr(tower_descent, "factor", unfactored)
        patch.setattr(tower_descent, "by_reciprocity", lambda count, bits: reciprocity)
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
        within = tower.own_root(e)
        assert tower.generators == before
        root = tower.sqrt(e)
        assert (within is None) == (tower.generators != before)
        assert within is None or within == root


@settings(law, max_examples=40)
@given(numbers(1, depth=2))
def test_descent_without_places_gives_the_same_answers(pairs: list[Pair]) -> None:
    """The proofs by reduction only save time: the descent alone says square or not the same way."""
    e, _ = pairs[0]
    tower = e.tower
    for candidate in (e, e + 1, e * e, e * e + 1, 2 * e * e):
        x = (candidate if candidate.sign() > 0 else -candidate).num
        level = len(tower.field.radicands)
        quick = Descent(tower).root(x, level)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(Characters, "refute", lambda self, x, level: False)
            slow = Descent(tower).root(x, level)
        assert (quick is None) == (slow is None)
        if slow is not None:
            assert slow * slow == Element(tower, x, ONE)
