"""The page of the physics: its statements, what SymPy makes of them, and the forms that the engines use."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from sympy import Add, Eq, Pow, Rational, Symbol, count_ops, fraction
from sympy.printing.mathml import mathml

from truebreak.exact.laws import derivation
from truebreak.exact.laws.derivation import Statement

sys.path.append(str(Path(__file__).resolve().parents[1] / "studies"))

from law_forms import FORMS, TANGENT_FORMS, StableForm
from law_proofs import pair_displacement

INTRODUCTION = """\
# The physics, derived

Equations and forms on this page are those of the program: `exact/laws/derivation.py` states them as SymPy's own
equations, this page prints the same objects, and `python docs/studies/law_proofs.py` solves them afresh and proves that
each formula which an engine runs is equal to what follows from them. Nothing here is typed in by hand. The statements
are those of Carl M. Kadie, *Perfect, Infinite-Precision, Game Physics in Python*; a prime is a position at time t, a
hat a velocity after the collision.
"""

HAT = re.compile("<mi>([a-z])hat</mi>")
"""A name with a hat, as SymPy has it in letters."""

LONG = 40
"""Operations beyond which a formula is shown in parts that have names, and a sum goes over several lines."""

STABLE = """\
## The forms that the engines run

Each is proved equal to the law that it names. They are written so that nothing cancels: d is the position of b less
that of a, v the same of velocities, R the sum of the radii, d × v = dx vy − dy vx, and w an inverse mass.
"""

TANGENT = """\
## What becomes of a small displacement

The tangent map of a collision is the derivative of the impulse and of the instant at which it comes: a pair displaced
by (p, q) touches later by the time for which the distance stays R to the first order. From it follow
[growth of errors, Lyapunov exponents and horizons](../docs/chaos.md).
"""


def laws_page(*, solved: bool) -> str:
    """The page as MyST.

    Args:
        solved: whether the solutions are derived too, which takes some ten seconds.
    """
    parts = [INTRODUCTION]
    for place, (statement, laws) in enumerate(_statements(), 1):
        parts += _told(place, statement)
        if solved:
            for name, law in laws:
                parts += [f"What SymPy makes of it (`{law.__name__}`): {name}", *_formulas(law())]
    parts.append(STABLE)
    for form in FORMS:
        parts += _form(form)
    parts.append(TANGENT)
    if solved:
        names = ("x", "y", "vx", "vy")
        found = pair_displacement()
        parts += ["What b gains, per inverse mass, in position and velocity:", *_named(names, found)]
    for form in TANGENT_FORMS:
        parts += _form(form)
    return "\n\n".join(parts) + "\n"


def _statements() -> Iterator[tuple[Statement, Sequence[tuple[str, Any]]]]:
    d = derivation
    yield d.pair_touch(), [("the two times at which the circles just touch.", d.pair_times)]
    yield d.wall_touch(), [("the two times at which the circle just touches the wall.", d.wall_times)]
    hits = [
        ("the velocities after a collision with a circle that cannot move, in the limit of its infinite mass.",
         d.fixed_circle_velocities),
    ]  # fmt: skip
    yield d.pair_collision(), hits
    yield d.wall_collision(), [("the velocity off a wall, in the limit of its infinite mass.", d.wall_velocities)]
    yield d.wall_aim(), [("the point of the wall.", d.wall_aim_point)]


def _told(place: int, statement: Statement) -> list[str]:
    title = statement.title[:1].upper() + statement.title[1:]
    unknowns = ", ".join(f"`{unknown}`" for unknown in statement.unknowns)
    return [f"## {place}. {title}", *map(_math, statement.equations), f"Solved for {unknowns}."]


def _formulas(found: Any) -> list[str]:
    expressions = found if isinstance(found, tuple) else (found,)
    if max(map(count_ops, expressions)) <= LONG:
        return [_math(expression) for expression in expressions]
    shown, names = in_parts(expressions)
    return [*map(_math, shown), "where", *(_sum(symbol, expression) for expression, symbol in names.items())]


def in_parts(expressions: Sequence[Any]) -> tuple[list[Any], dict[Any, Any]]:
    """Fractions of a numerator N and a denominator C, roots of a D; and the names of what SymPy has for these."""
    names: dict[Any, Any] = {}

    def name(expression: Any, letter: str) -> Any:
        if expression not in names:
            taken = sum(str(other)[0] == letter for other in names.values())
            names[expression] = Symbol(f"{letter}_{taken + 1}")
        return names[expression]

    def under_root(power: Any) -> Any:
        return Pow(name(power.base, "D"), power.exp)

    def is_root(part: Any) -> bool:
        return isinstance(part, Pow) and part.exp == Rational(1, 2) and isinstance(part.base, Add)

    shown = []
    for expression in expressions:
        above, below = fraction(expression.replace(is_root, under_root))
        shown.append(name(above, "N") / (1 if below == 1 else name(below, "C")))
    return shown, names


def _sum(name: Any, expression: Any) -> str:
    """What a name stands for, with a line that can end before each term."""
    first, *rest = expression.as_ordered_terms() if isinstance(expression, Add) else [expression]
    terms = [f"<span>{_inside(Eq(name, first, evaluate=False))}</span>"]
    for term in rest:
        negative = term.could_extract_minus_sign()
        terms.append(f"<span>{'−' if negative else '+'} {_inside(-term if negative else term)}</span>")
    return f'<div class="law sum">{" ".join(terms)}</div>'


def _named(names: Sequence[str], found: Sequence[Any]) -> list[str]:
    told: list[str] = []
    for name, value in zip(names, found, strict=True):
        told += [f"{name}:", *_formulas(value)]
    return told


def _form(form: StableForm) -> list[str]:
    doc = "\n".join(line.strip() for line in form.doc.splitlines())
    signature = f"{form.name}({', '.join(map(str, form.parameters))})"
    steps = [_math(Eq(name, value)) for name, value in form.steps]
    return [f"### `{form.name}`", f"```python\n{signature}\n```", _plain(doc), *steps, *map(_math, form.results)]


def _plain(text: str) -> str:
    """Text of a docstring, with what Markdown would take for its own made harmless."""
    return text.replace("|", "\\|").replace("*", "\\*").replace("<", "\\<")


def _math(expression: Any) -> str:
    return f'<div class="law">{_inside(expression)}</div>'


def _inside(expression: Any) -> str:
    text = HAT.sub(
        r'<mover accent="true"><mi>\1</mi><mo>^</mo></mover>',
        mathml(expression, printer="presentation", mul_symbol="dot"),
    )
    return f'<math xmlns="http://www.w3.org/1998/Math/MathML">{text}</math>'
