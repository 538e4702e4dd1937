"""Exact values of any depth as text, with definitions of what they share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ....exact.exact_motion import ExactValue
from ....exact.replay.state import ReplayState, replay
from ....scenarios.numbers.quantity import Quantity

LONGEST = 96
"""Length beyond which a text is given a name and used by it: keeps the whole linear in the number of operations."""


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
    """Texts as numbers; long ones get names, the same text the same name."""

    def __init__(self) -> None:
        self.names: dict[str, str] = {}

    def constant(self, q: Quantity) -> _Text:
        text = q.text()
        return self.put(text if text.isdigit() else f"({text})")

    def root(self, value: _Text) -> _Text:
        return value if value.text in ("0", "1") else self.put(f"sqrt({value.text})")

    def put(self, text: str) -> _Text:
        if len(text) <= LONGEST:
            return _Text(self, text)
        return _Text(self, self.names.setdefault(text, f"n{len(self.names) + 1}"))


def definitions(values: Sequence[ExactValue]) -> Definitions:
    """Text for values of one run, whatever their depth: steps of + - * / and square roots, in text.

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
    log = values[0].log if values else None
    if log is None:
        return Definitions((), ())

    state = ReplayState(log.scene, book)
    done = 0
    for k in order:
        replay(state, log.steps, range(done, values[k].upto))
        done = max(done, values[k].upto)
        texts[k] = values[k].formula(state).text
    names = tuple((name, text) for text, name in book.names.items())
    return Definitions(names, tuple(texts[k] for k in range(len(values))))
