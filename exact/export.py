"""Exact values of any depth, written out: SymPy expressions with shared parts, and text with definitions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..scenarios.numbers.quantity import Quantity
from .machine import Machine
from .program import causal_past, replay

if TYPE_CHECKING:
    from .value import ExactValue, Program

LONGEST = 96
"""Length beyond which a text is given a name and used by it: keeps the whole linear in the number of operations."""


class _Expression:
    """A SymPy expression under construction; nothing is simplified, so building it is linear."""

    __slots__ = ("expression",)

    def __init__(self, expression: Any) -> None:
        self.expression = expression

    def __add__(self, other: _Expression) -> _Expression:
        from sympy import Add

        return _Expression(Add(self.expression, other.expression, evaluate=False))

    def __sub__(self, other: _Expression) -> _Expression:
        return self + (-other)

    def __mul__(self, other: _Expression) -> _Expression:
        from sympy import Mul

        return _Expression(Mul(self.expression, other.expression, evaluate=False))

    def __truediv__(self, other: _Expression) -> _Expression:
        from sympy import Pow

        return self * _Expression(Pow(other.expression, -1, evaluate=False))

    def __neg__(self) -> _Expression:
        return _Expression(-1) * self if not self.expression.is_Rational else _Expression(-self.expression)


def sympy_machine(program: Program, upto: int, bodies: Sequence[int]) -> Machine:
    """The states of some bodies after the first `upto` steps, as SymPy expressions that share their parts."""
    from sympy import Pow, Rational, sympify

    def constant(q: Quantity) -> _Expression:
        return _Expression(sympify(q.sympy()))

    def root(value: _Expression) -> _Expression:
        return _Expression(Pow(value.expression, Rational(1, 2), evaluate=False))

    return _replayed(program, upto, bodies, constant, root)


def _replayed(program: Program, upto: int, bodies: Sequence[int], constant: Any, root: Any) -> Machine:
    steps = program.steps[:upto]
    needed, held = causal_past(steps, bodies, len(program.scene.circles))
    machine = Machine(program.scene, constant, root, only=held)
    replay(machine, steps, needed)
    return machine


@dataclass(frozen=True)
class Definitions:
    """Exact values as text: each value's text, and the definitions of the names used in them.

    Attributes:
        names: (name, text) in order; a text uses numbers, + - * /, sqrt() and earlier names.
        values: the text of each value asked for.
    """

    names: tuple[tuple[str, str], ...]
    values: tuple[str, ...]


class _Text:
    """A number as text; a long one is given a name."""

    __slots__ = ("book", "text")

    def __init__(self, book: _Book, text: str) -> None:
        self.book = book
        self.text = text

    def __add__(self, other: _Text) -> _Text:
        if self.text == "0" or other.text == "0":
            return other if self.text == "0" else self
        return self.book.put(f"({self.text} + {other.text})")

    def __sub__(self, other: _Text) -> _Text:
        return self if other.text == "0" else self.book.put(f"({self.text} - {other.text})")

    def __mul__(self, other: _Text) -> _Text:
        if "0" in (self.text, other.text):
            return self if self.text == "0" else other
        if "1" in (self.text, other.text):
            return other if self.text == "1" else self
        return self.book.put(f"{self.text}*{other.text}")

    def __truediv__(self, other: _Text) -> _Text:
        return self if self.text == "0" or other.text == "1" else self.book.put(f"{self.text}/({other.text})")

    def __neg__(self) -> _Text:
        return self if self.text == "0" else self.book.put(f"(-{self.text})")


class _Book:
    """Names for long texts; the same text gets the same name."""

    def __init__(self) -> None:
        self.names: dict[str, str] = {}

    def put(self, text: str) -> _Text:
        if len(text) <= LONGEST:
            return _Text(self, text)
        return _Text(self, self.names.setdefault(text, f"n{len(self.names) + 1}"))


def definitions(values: Sequence[ExactValue]) -> Definitions:
    """Text for values of one run, whatever their depth: a program of + - * / and square roots, in text.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import Circle, Scene
    >>> run = ExactEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 1)]))
    >>> found = definitions([run.events[0].time])
    >>> found.values, [name for name, _ in found.names]
    (('n1',), ['n1'])
    """
    book = _Book()
    texts: dict[int, str] = {}
    order = sorted(range(len(values)), key=lambda k: values[k].upto)
    program = values[0].program if values else None
    if program is None:
        return Definitions((), ())

    def constant(q: Quantity) -> _Text:
        text = q.text()
        plain = text.isdigit()
        return book.put(text if plain else f"({text})")

    def root(value: _Text) -> _Text:
        return value if value.text in ("0", "1") else book.put(f"sqrt({value.text})")

    machine = Machine(program.scene, constant, root)
    done = 0
    for k in order:
        replay(machine, program.steps, range(done, values[k].upto))
        done = max(done, values[k].upto)
        texts[k] = values[k].formula(machine).text
    names = tuple((name, text) for text, name in book.names.items())
    return Definitions(names, tuple(texts[k] for k in range(len(values))))
