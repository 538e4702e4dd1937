"""Exact values of a document as text: written out where they are shallow, by shared definitions where not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from flint import arb

from ...exact.exact_motion import ExactValue
from ...exact.replay.state import ReplayState, replay
from ...scenarios.numbers.quantity import Quantity, Real
from ..deadline import Clock

NORMAL_WORK = 5_000_000
"""What one document may spend on normal forms, in units of about a microsecond that are counted, not timed, so that
it is the same on every machine. Values get deeper with every collision, and soon none has a normal form that could be
written; those left are given by definitions, which costs little."""

NORMAL_LENGTH = 4_000
"""Characters beyond which a normal form is longer than anyone would read."""

VALUE_UNITS, CHARACTER_UNITS = 1_000, 2
"""What a normal form is taken to cost, for itself and for each character."""

STEP_UNITS = 150
"""What each step of the log before a value is taken to cost, where the value is not at hand."""

FAILED_UNITS = 200_000
"""What a value is taken to cost that turns out to have none; the search for it is bounded too."""


@dataclass
class ExactTexts:
    """Collects the exact values of a document and writes them out, those first that come first.

    Attributes:
        work: units left for normal forms.
        watch: the user's seconds: once they are over, values are given by definitions, which is quick.
        deep: rows, keys and values to be given by definitions.
    """

    work: int = NORMAL_WORK
    watch: Clock = field(default_factory=lambda: Clock(None))
    deep: list[tuple[dict[str, Any], str, ExactValue]] = field(default_factory=list)
    _failed: dict[tuple[int, ...], int] = field(default_factory=dict)

    def put(self, row: dict[str, Any], key: str, value: Real) -> None:
        """Puts the text of a value into a row under `KEY_exact`, now or in `finish`.

        >>> row = {}
        >>> from truebreak.scenarios.numbers.quantity import real
        >>> ExactTexts().put(row, "x", real(0.375))
        >>> row
        {'x_exact': '3/8'}
        """
        if not isinstance(value, ExactValue):
            row[f"{key}_exact"] = value.text()
            return
        row[f"{key}_exact"] = text = self._normal_form(value)
        if text is None:
            self.deep.append((row, f"{key}_exact", value))

    def _normal_form(self, value: ExactValue) -> str | None:
        """The normal form of a value of an exact run; None if it is too long, or too much work.

        A circle whose state had none earlier has none later.
        """
        if (
            self.work <= 0
            or self.watch.over
            or any(value.upto >= upto and set(bodies) <= set(value.bodies) for bodies, upto in self._failed.items())
        ):
            return None
        text = value.text()
        if text is None:
            self.work -= FAILED_UNITS
            self._failed[value.bodies] = min(value.upto, self._failed.get(value.bodies, value.upto))
            return None
        steps = value.upto if isinstance(value.near, arb) else 0
        self.work -= VALUE_UNITS + STEP_UNITS * steps + CHARACTER_UNITS * len(text)
        return text if len(text) <= NORMAL_LENGTH else None

    def finish(self) -> dict[str, str]:
        """Fills in the values put off, and gives the definitions that their texts refer to, in order."""
        if not self.deep:
            return {}
        found = definitions([value for _, _, value in self.deep])
        for (row, key, _), text in zip(self.deep, found.values, strict=True):
            row[key] = text
        return dict(found.names)


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
