"""Numbers of few bits: each operation is the exact result rounded once, and the engine is `single` at 24 bits."""

from __future__ import annotations

import math
from fractions import Fraction
from operator import add, mul, sub, truediv

import mpmath
import pytest
from hypothesis import given
from hypothesis import strategies as st

from truebreak.compare import compare
from truebreak.compare.engines import engine
from truebreak.floating import DoubleEngine, RoundedEngine, SingleEngine
from truebreak.floating.rounded import Rounding, number
from truebreak.floating.single import SINGLES
from truebreak.scenarios import Quantity, SceneError, catalogue

BITS = st.integers(4, 53)
VALUES = st.floats(-1e6, 1e6).filter(lambda value: value == 0 or abs(value) > 1e-6)


def nearest(exact: Fraction, bits: int) -> Fraction:
    """By the definition, in whole numbers."""
    if exact == 0:
        return exact
    exponent = math.floor(math.log2(abs(exact))) - bits + 1
    for near in (exponent - 1, exponent, exponent + 1):
        scaled = abs(exact) / Fraction(2) ** near
        if 2 ** (bits - 1) <= scaled < 2**bits:
            return (1 if exact > 0 else -1) * round(scaled) * Fraction(2) ** near
    raise AssertionError


@given(BITS, VALUES, VALUES, st.sampled_from([add, sub, mul, truediv]))
def test_an_operation_is_the_exact_result_rounded_once(bits, x, y, operation):
    kind = number(bits)
    system = Rounding(bits)
    a, b = (system.constant(Quantity.of(Fraction(v))) for v in (x, y))
    if operation is truediv and b == 0:
        return
    found = operation(a, b)
    assert type(found) is kind
    assert Fraction(float(found)) == nearest(operation(Fraction(float(a)), Fraction(float(b))), bits)


@given(BITS, st.floats(1e-6, 1e6))
def test_a_root_is_rounded_once(bits, x):
    system = Rounding(bits)
    a = system.constant(Quantity.of(Fraction(x)))
    with mpmath.workprec(400):
        root = mpmath.sqrt(mpmath.mpf(float(a)))
        exact = Fraction(int(root * mpmath.mpf(2) ** 300), 2**300)
    assert Fraction(float(system.root(a))) == nearest(exact, bits)


@pytest.mark.parametrize("bits", [26, 40, 52])
def test_rounding_to_a_double_first_moves_nothing(bits):
    """1 + half a unit, and a little more or less than a double can tell: the sum of three parts, in two roundings."""
    kind = number(bits)
    half = 2.0**-bits
    assert float(kind(1.0) + kind(half)) == 1.0  # a tie, to even
    assert float(kind(1.0 + 2 * half) + kind(half)) == 1.0 + 4 * half
    a = kind(1.0 + 2 * half)  # its square is 1 + 4 half + 4 half**2: no tie, though a double may not tell
    assert Fraction(float(a * a)) == nearest(Fraction(float(a)) ** 2, bits)


@given(st.integers(-(2**60), 2**60), st.integers(1, 2**40))
def test_24_bits_are_singles(p, q):
    value = Quantity.of(Fraction(p, q))
    assert float(Rounding(24).constant(value)) == float(SINGLES.constant(value))


@pytest.mark.parametrize("spec", ["gas:n=4", "lorentz", "rack:rows=2"])
@pytest.mark.parametrize(("bits", "other"), [(53, DoubleEngine()), (24, SingleEngine())])
def test_the_engine_is_double_at_53_bits_and_single_at_24(spec, bits, other):
    scene = catalogue.build(spec)
    mine, theirs = RoundedEngine(bits).run(scene, events=120), other.run(scene, events=120)
    assert [(float(e.time), e.impulses) for e in mine.events] == [(float(e.time), e.impulses) for e in theirs.events]


def test_fewer_bits_leave_sooner():
    found = compare(catalogue.build("gas"), [f"rounded:bits={p}" for p in (12, 24, 36, 48)], events=200, causes=False)
    left = [candidate.alignment.divergence.event for candidate in found.candidates]
    assert left == sorted(left) and len(set(left)) == 4


def test_it_declares_what_it_is():
    told = engine("rounded:bits=30")
    assert (told.bits, told.rounds_input, told.step) == (30, True, None)
    assert told.run(catalogue.build("gas:n=2"), events=2).parameters == {"bits": 30}
    assert RoundedEngine(20).wider() == RoundedEngine(40)
    assert RoundedEngine(40).wider() is None


@pytest.mark.parametrize("bits", ["3", "54", "0", "x"])
def test_bits_that_cannot_be_are_refused(bits):
    with pytest.raises(SceneError, match="bits"):
        engine(f"rounded:bits={bits}")
