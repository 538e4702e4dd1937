"""Numbers of an exact run as text, whatever their depth: as the run computes them, parts used again by names."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from flint import arb, fmpq

from ..scenarios.numbers.quantity import Quantity
from .numbers import ball
from .numbers.system import Undecided
from .replay.contact import Round
from .replay.landings import Unsharp, gap_of
from .replay.round_falls import horner_slope
from .replay.state import ReplayState, causal_past, replay

if TYPE_CHECKING:
    from .simulation.decider import Formula, RunLog


NAME = re.compile(r"\bn\d+\b")
"""A name in a text."""

LONGEST = 96
"""Length beyond which a text is given a name and used by it: keeps the whole linear in the number of operations."""


@dataclass(frozen=True)
class Definitions:
    """Exact values as text: each value's text, and the definitions of the names used in them.

    Attributes:
        names: (name, text) in order; a text uses numbers, + - * /, sqrt(), zero() and earlier names.
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


FEWEST_PLACES, MOST_PLACES = 6, 3_000
"""Decimal places of the two numbers between which a zero is the only one."""


class _Replay(ReplayState[_Text]):
    """A replay in text. What square roots do not give, a zero of a quartic, is told by the polynomial and two numbers
    between which it has that zero and no other."""

    def __init__(self, log: RunLog, book: _Book, only: Iterable[int] | None = None) -> None:
        super().__init__(log.scene, book, only=only)
        self._log, self._book, self._done = log, book, 0

    def to(self, upto: int, needed: Iterable[int] | None = None) -> None:
        """Carries out the steps up to one."""
        for k in range(self._done, upto) if needed is None else needed:
            self._done = k
            replay(self, self._log.steps, (k,))
        self._done = upto

    def peg_hit(self, link: Round) -> tuple[_Text, _Text]:
        """As `Flights.round_hit`."""
        gap = gap_of(link, self.peg_fall_at_clock(link), self.stood(link))
        told = ", ".join((*(part.text for part in gap), *self._between(link)))
        return self.faller(link).flight.t, self._book.put(f"zero({told})")

    def _between(self, link: Round) -> tuple[str, str]:
        """Two decimals, reckoned as the polynomial is, between which it has no other zero.

        Raises:
            Undecided: where no such decimals are found.
        """
        log = self._log
        bits = log.lost + int(FEWEST_PLACES * ball.BITS_PER_DIGIT) + 2 * ball.GUARD_BITS
        places = FEWEST_PLACES
        while places <= MOST_PLACES:
            bits *= 2
            with ball.precision(bits):
                try:
                    state = log.in_balls(bits, self._done)
                    ball.use_bits(bits)
                    base, wait = state.round_hit(link)
                except Unsharp:
                    places *= 2
                    continue
                wait = base + wait - state.faller(link).flight.instant
                gap = gap_of(link, state.peg_fall(link), state.stood(link))
                low, high = wait.lower().fmpq(), wait.upper().fmpq()
                while (high - low) * 10**places < 1:
                    ends = (low * 10**places).floor(), (high * 10**places).ceil()
                    hull = arb(fmpq(ends[0], 10**places)).union(arb(fmpq(ends[1], 10**places)))
                    if not horner_slope(gap, hull).contains(0):
                        return _decimal(int(ends[0]), places), _decimal(int(ends[1]), places)
                    places *= 2
        raise Undecided("no two decimals are found between which a zero of a quartic is the only one")


def _decimal(units: int, places: int) -> str:
    """A number of units of the last of some decimal places.

    >>> _decimal(41, 3), _decimal(2500, 3)
    ('0.041', '2.500')
    """
    whole, part = divmod(units, 10**places)
    return f"{whole}.{part:0{places}d}"


class InRun(Protocol):
    """A number of a run: see `ExactValue`."""

    log: RunLog
    upto: int
    formula: Formula


def definitions(values: Sequence[InRun]) -> Definitions:
    """Text for values of one run, whatever their depth: steps of + - * / and square roots, in text.

    zero(a, b, ..., low, high) is the one number between low and high at which the polynomial a + b s + ... is 0.
    Where a circle falls onto something round, it is the time from its last contact to there.

    Raises:
        Undecided: where counted work does not tell such a zero from others.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import Circle, Scene
    >>> run = ExactEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 1)]))
    >>> found = definitions([run.events[0].time])
    >>> found.values, [name for name, _ in found.names]
    (('n1',), ['n1'])
    >>> falls = Scene([Circle(0, 5), Circle("1/2", 0, m="oo")], gravity=(0, -10))
    >>> definitions([ExactEngine().run(falls, events=1).events[0].time]).names[0][1][-20:]
    ' 0.782752, 0.782753)'
    """
    if not values:
        return Definitions((), ())
    return _in_text(values, _Replay(values[0].log, book := _Book()), book)


def definition(log: RunLog, upto: int, bodies: Sequence[int], formula: Formula) -> str | None:
    """A number after a zero of a quartic as the run computes it, in one text; None of any other number.

    No square roots give such a number, so that no scene file takes it.

    Raises:
        Undecided: where counted work does not tell the zero from others.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import Circle, Scene
    >>> falls = Scene([Circle(0, 5), Circle("1/2", 0, m="oo")], gravity=(0, -10))
    >>> ExactEngine().run(falls, events=1).events[0].time.text()[-25:]
    ', 0.782752, 0.782753); n1'
    """
    if log.scene.gravity is None:
        return None
    book = _Book()
    needed, held = causal_past(log.steps[:upto], bodies)
    state = _Replay(log, book, held)
    state.to(upto, needed)
    text = formula(state).text
    names = {name: told for told, name in book.names.items()}
    used, new = set[str](), {text}
    while new:  # the texts that it uses, and those that they use
        new = {name for told in new for name in NAME.findall(told)} - used
        used, new = used | new, {names[name] for name in new}
    told = [f"{name} = {told}" for name, told in names.items() if name in used]
    return "; ".join([*told, text]) if any("zero(" in part for part in (*told, text)) else None


def _in_text(values: Sequence[InRun], state: _Replay, book: _Book) -> Definitions:
    texts = [""] * len(values)
    for k in sorted(range(len(values)), key=lambda k: values[k].upto):
        state.to(values[k].upto)
        texts[k] = values[k].formula(state).text
    return Definitions(tuple((name, text) for text, name in book.names.items()), tuple(texts))
