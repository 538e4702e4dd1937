"""What a run has gathered, by index: records of events, entries, the reversal, and the knots of the flights."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import Generic, NamedTuple, TypeAlias, TypeVar

from ...scenarios.numbers.quantity import Quantity
from ...scenarios.trajectory import Assumption, Tie
from ..replay.contact import Link, Touch
from ..replay.steps import Step

K = TypeVar("K")
"""The numbers that a history keeps: of one system, or of several side by side."""

REVERSAL = "reversal"
"""The source of the reversal's own time."""


class Mark(NamedTuple, Generic[K]):
    """An instant of a run, and how its time is computed again from the log.

    Attributes:
        number: its place among the instants of the run; 0 is time 0.
        time: the number at hand.
        step: how many steps of the log there are at its end.
        source: the circle whose clock stands at it; or the entry that comes at it; or REVERSAL.
    """

    number: int
    time: K
    step: int
    source: int | Link | str


class Record(NamedTuple, Generic[K]):
    """One event."""

    mark: Mark[K]
    links: tuple[Touch, ...]
    impulses: tuple[Touch, ...]
    ties: tuple[Tie, ...]
    coupled: bool


class Arrived(NamedTuple, Generic[K]):
    """The centre of a circle enters a pocket."""

    circle: int
    pocket: int
    mark: Mark[K]


Knot: TypeAlias = tuple[K, K, K, K, K, int, int]
"""(t, x, y, vx, vy) of a circle, the steps of the log by then, the number of the instant."""


@dataclass(slots=True)
class Noted(Generic[K]):
    """What an instant did, or a part of it, in the history's terms."""

    records: list[Record[K]] = field(default_factory=list)
    entries: list[Arrived[K]] = field(default_factory=list)
    knots: list[tuple[int, Knot[K]]] = field(default_factory=list)
    reversal: Mark[K] | None = None
    last: Mark[K] | None = None


@dataclass
class History(Generic[K]):
    """What a loop has gathered, always up to the end of a whole instant.

    Attributes:
        records: the events.
        entries: the entries into pockets.
        reversal: how many events came before it, and when it was.
        knots: for each circle one at the start and one after each instant that changed its velocity.
        steps: the log.
        plan: what each rung decided, and what was skipped.
        rises: the bits of each rise of the precision, and whether deviations were kept in a set from then on.
        assumptions: what the run rests on that is not proved.
        set_times: limits and the reversal's time, with the number of the last part of the instant that falls on it.
    """

    records: list[Record[K]] = field(default_factory=list)
    entries: list[Arrived[K]] = field(default_factory=list)
    reversal: tuple[int, Mark[K]] | None = None
    knots: list[list[Knot[K]]] = field(default_factory=list)
    steps: list[Step] = field(default_factory=list)
    plan: Counter[str] = field(default_factory=Counter)
    rises: list[tuple[int, bool]] = field(default_factory=list)
    assumptions: list[Assumption] = field(default_factory=list)
    set_times: dict[Quantity, int] = field(default_factory=dict)
    _last: Mark[K] | None = None

    @property
    def last(self) -> Mark[K] | None:
        """The last instant at which anything happened; None before the first."""
        return self._last

    @last.setter
    def last(self, mark: Mark[K] | None) -> None:
        self._last = mark

    def add(self, note: Noted[K]) -> None:
        """Takes up what an instant, or a part of one, did. It is whole once `last` says so."""
        self.records += note.records
        self.entries += note.entries
        for i, knot in note.knots:
            self.knots[i].append(knot)

    def drop_unfinished(self) -> None:
        """Drops what does not belong to the last instant that was noted whole, or to those before it."""
        number, step = (-1, 0) if self.last is None else (self.last.number, self.last.step)
        del self.steps[step:]
        self.records = [record for record in self.records if record.mark.number <= number]
        self.entries = [entry for entry in self.entries if entry.mark.number <= number]
        if self.reversal is not None and self.reversal[1].number > number:
            self.reversal = None
        self.knots = [row[:1] + [knot for knot in row[1:] if knot[-1] <= number] for row in self.knots]
