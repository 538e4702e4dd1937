"""Exact numbers: what their text may say, what it means, and that no comparison ever rounds."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction

import mpmath
import pytest
import sympy
from counted import calls
from hypothesis import given, settings
from hypothesis import strategies as st

from truebreak.scenarios import Quantity, SceneError
from truebreak.scenarios.numbers.parsing import MAX_LENGTH, MAX_TERMS

SMALL = st.integers(-30, 30)


@st.composite
def expressions(draw: st.DrawFn, depth: int = 3) -> tuple[Quantity, sympy.Expr]:
    """A number and the same number in SymPy, built by the same steps."""
    if depth == 0 or draw(st.booleans()):
        p, q = draw(SMALL), draw(st.integers(1, 9))
        return Quantity.of(Fraction(p, q)), sympy.Rational(p, q)
    a, x = draw(expressions(depth=depth - 1))
    operation = draw(st.sampled_from(["+", "-", "*", "/", "sqrt", "neg"]))
    if operation == "neg":
        return -a, -x
    if operation == "sqrt":
        square, squared = a * a + 2, x * x + 2
        return square.sqrt(), sympy.sqrt(squared)
    b, y = draw(expressions(depth=depth - 1))
    if operation == "+":
        return a + b, x + y
    if operation == "-":
        return a - b, x - y
    if operation == "*" or b.sign() == 0:
        return a * b, x * y
    return a / b, x / y


def digits(x: sympy.Expr) -> mpmath.mpf:
    """A SymPy number to 200 bits and more."""
    return mpmath.mpf(sympy.N(x, 100))


# -- the grammar


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("7", 7),
        ("-0.1", Fraction(-1, 10)),
        ("1e-3", Fraction(1, 1000)),
        ("1.5E+2", 150),
        (".5", Fraction(1, 2)),
        ("2.", 2),
        (" 1 + 2 * 3 ", 7),
        ("1 - 2 - 3", -4),
        ("8/4/2", 1),
        ("-2**2", -4),
        ("(-2)**2", 4),
        ("2**-2", Fraction(1, 4)),
        ("2**(-2)", Fraction(1, 4)),
        ("--3", 3),
        ("3*-2", -6),
        ("sqrt(9/4)", Fraction(3, 2)),
        ("sqrt(0)", 0),
        ("((1))", 1),
        ("007", 7),
    ],
)
def test_text_means_what_arithmetic_says(text: str, value: int | Fraction) -> None:
    assert Quantity.of(text).fraction == value


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "'' is not an exact number: it is empty"),
        ("1/0", "'1/0' is not an exact number: division by zero"),
        ("0**-1", "'0**-1' is not an exact number: division by zero"),
        ("1/(sqrt(4)-2)", "'1/(sqrt(4)-2)' is not an exact number: division by zero"),
        ("sqrt(-1)", "'sqrt(-1)' is not an exact number: the square root of a negative value"),
        (
            "9**9**9",
            "'9**9**9' is not an exact number: a power of a power; write the exponent as one whole number",
        ),
        ("2**0.5", "'2**0.5' is not an exact number: an exponent must be a whole number"),
        ("2**99999", "'2**99999' is not an exact number: an exponent may be at most 10000"),
        ("1e99999", "'1e99999' is not an exact number: a decimal exponent may be at most 10000"),
        ("pi", "'pi' is not an exact number: 'pi' is not allowed; the only function is sqrt"),
        ("sin(1)", "'sin(1)' is not an exact number: 'sin' is not allowed; the only function is sqrt"),
        ("sqrt 2", "'sqrt 2' is not an exact number: sqrt needs parentheses"),
        ("(1", "'(1' is not an exact number: a parenthesis is not closed"),
        ("1)", "'1)' is not an exact number: ')' is not expected there"),
        ("1+", "'1+' is not an exact number: it ends too early"),
        ("1 2", "'1 2' is not an exact number: '2' is not expected there"),
        ("1_000", "'1_000' is not an exact number: '_000' is not expected there"),
    ],
)
def test_text_outside_the_grammar_is_refused_with_the_reason(text: str, message: str) -> None:
    with pytest.raises(SceneError) as error:
        Quantity.of(text)
    assert str(error.value) == message


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os').system('true')",
        "__import__('os')",
        "().__class__",
        "lambda: 1",
        "x",
        "nan",
        "inf",
        "oo",
        "1;2",
        "1\n;",
        "0x10",
        "1j",
        "½",
        "٣",
        "1\u00a0+1",
        "sqrt(2",
        "[1]",
        "1,5",
        "1e",
        "1//2",
        "5%2",
        "\x00",
    ],
)
def test_nothing_else_is_read(text: str) -> None:
    with pytest.raises(SceneError) as error:
        Quantity.of(text)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    "text",
    [
        "1" * 10_000_000,
        "(" * 10_000_000,
        "(" * 10_000,
        "sqrt(" * 3_000,
        "-" * 15_000,
        "+".join(["sqrt(2)"] * 2_000),
        "((1+sqrt(2))**10000)**10000",
        "(1+sqrt(2))**201",
        "((2**10000)**10000)**10000",
        "*".join(["2**10000"] * 1_500),
        "1/" * 5_000,
    ],
)
def test_a_hostile_text_is_refused_at_once(text: str) -> None:
    def refused() -> None:
        with pytest.raises(SceneError) as error:
            Quantity.of(text)
        assert len(str(error.value)) < 250

    assert calls(refused) < 1_000_000


def test_the_longest_text_is_read() -> None:
    assert Quantity.of("1" * MAX_LENGTH) > 0
    assert Quantity.of(f"(1+sqrt(2))**{MAX_TERMS // 2}") > 1


def test_a_number_that_cannot_be_told_from_zero_is_refused() -> None:
    primes = list(sympy.primerange(80))
    product = "*".join(f"(1+sqrt({p}))" for p in primes)
    backwards = "*".join(f"(1+sqrt({p}))" for p in reversed(primes))
    with pytest.raises(SceneError, match="too close to zero to be distinguished from it"):
        (Quantity.of(product) - Quantity.of(backwards)).sign()


# -- what may be a number


@pytest.mark.parametrize(
    ("value", "fraction"),
    [
        (3, Fraction(3)),
        (0.5, Fraction(1, 2)),
        (0.1, Fraction(*(0.1).as_integer_ratio())),
        (Fraction(1, 3), Fraction(1, 3)),
        (Decimal("0.1"), Fraction(1, 10)),
        (sympy.Rational(2, 7), Fraction(2, 7)),
        (sympy.Integer(5), Fraction(5)),
    ],
)
def test_numbers_of_other_types_are_taken_exactly(value: object, fraction: Fraction) -> None:
    assert Quantity.of(value).fraction == fraction


@pytest.mark.parametrize(
    "value",
    [True, None, [], {}, 1j, float("nan"), float("inf"), Decimal("nan"), sympy.pi, sympy.oo, sympy.I],
)
def test_what_is_no_exact_number_is_refused(value: object) -> None:
    with pytest.raises(SceneError):
        Quantity.of(value)


def test_sympy_roots_are_taken_exactly() -> None:
    x = sympy.sqrt(2 + sympy.sqrt(3)) / 5 - sympy.Rational(1, 3)
    assert Quantity.of(x) == Quantity.of("sqrt(2 + sqrt(3))/5 - 1/3")
    assert Quantity.of(sympy.sqrt(2) ** 3) == Quantity.of("2*sqrt(2)")
    assert Quantity.of(1 / sympy.sqrt(3)) == Quantity.of("sqrt(3)/3")


# -- agreement with others


@given(SMALL, st.integers(1, 50), SMALL, st.integers(1, 50))
def test_rationals_agree_with_fractions(p: int, q: int, r: int, s: int) -> None:
    a, b = Fraction(p, q), Fraction(r, s)
    x, y = Quantity.of(a), Quantity.of(f"({r})/{s}")
    assert (x + y).fraction == a + b
    assert (x - y).fraction == a - b
    assert (x * y).fraction == a * b
    assert (x < y, x <= y, x == y) == (a < b, a <= b, a == b)
    assert (x != y, x > y, x >= y) == (a != b, a > b, a >= b)
    if b:
        assert (x / y).fraction == a / b


@given(expressions())
@settings(deadline=None, max_examples=150)
def test_expressions_agree_with_sympy(pair: tuple[Quantity, sympy.Expr]) -> None:
    quantity, expression = pair
    with mpmath.workprec(300):
        value = digits(expression)
        if abs(value) > mpmath.mpf(10) ** -60:
            assert quantity.sign() == mpmath.sign(value)
        assert abs(digits(quantity.sympy()) - value) < mpmath.mpf(10) ** -60 * (1 + abs(value))


@given(expressions())
@settings(deadline=None, max_examples=150)
def test_float_is_the_nearest_double(pair: tuple[Quantity, sympy.Expr]) -> None:
    quantity, expression = pair
    with mpmath.workprec(300):
        value = digits(expression)
        if abs(value) > mpmath.mpf(10) ** -60:
            with mpmath.workprec(200):
                rounded = +value
            assert float(quantity) == float(rounded)


@pytest.mark.parametrize("a", range(1, 40, 3))
def test_float_is_nearest_where_sympy_is_not(a: int) -> None:
    for b in range(1, 12):
        text = f"sqrt({a})/{b} + {a}/7"
        with mpmath.workprec(200):
            assert float(Quantity.of(text)) == float(mpmath.sqrt(a) / b + mpmath.mpf(a) / 7)


def test_a_rational_in_disguise_half_way_between_doubles_rounds_to_even() -> None:
    assert float(Quantity.of("(1 + sqrt(2)*sqrt(2))/3 + 2**-53")) == 1.0
    assert float(Quantity.of("(1 + sqrt(2)*sqrt(2))/3 + 3*2**-53")) == 1 + 2**-51


def test_beyond_the_doubles() -> None:
    for text in ("10**400", "sqrt(2)*10**400", "-sqrt(2)*10**400"):
        with pytest.raises(OverflowError):
            float(Quantity.of(text))
        assert hash(Quantity.of(text)) == hash(Quantity.of(text))
    assert float(Quantity.of("sqrt(2)*10**-400")) == 0.0


# -- by value


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ("sqrt(8)", "2*sqrt(2)"),
        ("sqrt(5 + 2*sqrt(6))", "sqrt(2) + sqrt(3)"),
        ("1/(sqrt(2) - 1)", "sqrt(2) + 1"),
        ("sqrt(2)*sqrt(2)", "2"),
        ("sqrt(2 + sqrt(3))", "(sqrt(6) + sqrt(2))/2"),
    ],
)
def test_equality_and_hash_go_by_value(left: str, right: str) -> None:
    a, b = Quantity.of(left), Quantity.of(right)
    assert a == b
    assert hash(a) == hash(b)
    assert not a < b
    assert a <= b
    assert len({a, b}) == 1


def test_a_tiny_difference_is_a_difference() -> None:
    assert Quantity.of("sqrt(2)") + Quantity.of("10**-300") > Quantity.of("sqrt(2)")
    assert Quantity.of("0.1") != Quantity.of(0.1)


def test_other_things_are_not_equal() -> None:
    assert Quantity.of(1) != "one"
    assert Quantity.of(1) is not None
    assert Quantity.of(1) != [1]


def test_division_by_zero_and_roots_of_negatives_are_refused() -> None:
    with pytest.raises(SceneError, match="division by zero in 1/"):
        Quantity.of(1) / (Quantity.of("sqrt(2)") * Quantity.of("sqrt(2)") - 2)
    with pytest.raises(SceneError, match=r"sqrt\(-2\) is not real"):
        Quantity.of(-2).sqrt()


# -- text


@given(expressions(depth=4))
@settings(deadline=None, max_examples=300)
def test_text_is_read_back_to_the_same_expression(pair: tuple[Quantity, sympy.Expr]) -> None:
    quantity, _ = pair
    again = Quantity.of(quantity.text())
    assert again.text() == quantity.text()
    assert again == quantity


def test_balls_hold_the_number_at_every_precision() -> None:
    x = Quantity.of("sqrt(2 + sqrt(3)) - sqrt(6)/2 - sqrt(2)/2 + 10**-50")
    exact = Quantity.of("10**-50")
    for bits in (64, 128, 256, 1024):
        assert x.ball(bits).contains(exact.ball(4096))
    assert x == exact


@pytest.mark.parametrize("text", ["0", "sqrt(6) - sqrt(2)*sqrt(3)", "5/2/sqrt(2) + (1 - (1 + 5/2/sqrt(2)))"])
def test_digits_of_a_proved_zero_are_zero(text: str) -> None:
    assert Quantity.of(text).digits(20).strip("0.") == ""
    assert Quantity.of(text).digits(20) != ""


def test_digits_of_a_small_number_between_roots_are_its_own() -> None:
    near = Quantity.of(f"sqrt(6) - sqrt(2)*sqrt(3) + 1/10**{400}")
    assert near.digits(5) == "1.0000e-400"
