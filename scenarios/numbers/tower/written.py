"""Numbers of a field written out: as text in the grammar of scene files, and as SymPy expressions."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from flint import fmpq, fmpz

from .field import Field
from .ring import ONE, Integral, content, divide


def text_of(field: Field, num: Integral, den: fmpz) -> str:
    """num / den as text, made of + - * / sqrt ( )."""
    out = ""
    for c, factor in _terms(field, num, den):
        size = abs(c)
        body = factor if factor and size == 1 else f"{size}*{factor}" if factor else str(size)
        if not out:
            out = body if c > 0 else f"-{body}"
        else:
            out += f" + {body}" if c > 0 else f" - {body}"
    return out or "0"


def _terms(field: Field, x: Integral, den: fmpz) -> list[tuple[fmpq, str]]:
    """Coefficients and factors as text; nested roots first, the rational term last."""
    if isinstance(x, fmpz):
        return [(fmpq(x, den), "")] if x else []
    if isinstance(x, dict):
        surds = sorted((field.product(mask), c) for mask, c in x.items() if mask)
        terms = [(fmpq(c, den), f"sqrt({m.str()})") for m, c in surds]
        return terms + ([(fmpq(x[0], den), "")] if 0 in x else [])
    root = f"sqrt({text_of(field, field.radicands[x.level - 1], ONE)})"
    inner = _terms(field, x.b, den)
    if len(inner) == 1:
        c, factor = inner[0]
        head = (c, f"{factor}*{root}" if factor else root)
    else:
        g = content(x.b, den)
        head = (fmpq(1), f"({text_of(field, divide(x.b, g), den // g)})*{root}")
    return [head, *_terms(field, x.a, den)]


def sympy_form(field: Field, num: Integral, den: fmpz) -> Any:
    """num / den as a SymPy expression."""
    sympy: Any = import_module("sympy")

    def rational(c: fmpz) -> Any:
        return sympy.Integer(int(c)) / sympy.Integer(int(den))

    if isinstance(num, fmpz):
        return rational(num)
    if isinstance(num, dict):
        return sympy.Add(*(rational(c) * sympy.sqrt(int(field.product(mask))) for mask, c in num.items()))
    root = sympy.sqrt(sympy_form(field, field.radicands[num.level - 1], ONE))
    return sympy_form(field, num.a, den) + sympy_form(field, num.b, den) * root
