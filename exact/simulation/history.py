"""What a run has gathered, by index: records of events, entries, the reversal, and the knots of the flights."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from ...scenarios.event import Assumption, Tie
from ...scenarios.numbers.quantity import Quantity
from ..numbers.system import Number
from ..replay.steps import Link, Step

REVERSAL = "reversal"
"""The source of the reversal's own time."""


class Mark(NamedTuple):
    """An instant of a run, and how its time is computed again from the log.

    Attributes:
        number: its place among the instants of the run; 0 is time 0.
        time: the number at hand.
        step: how many steps of the log there are at its end.
        source: the circle whose clock stands at it; or the entry that comes at it; or REVERSAL.
    """

    number: int
    time: Number
    step: int
    source: int | Link | str


class Record(NamedTuple):
    """One event."""

    mark: Mark
    links: tuple[Link, ...]
    impulses: tuple[Link, ...]
    ties: tuple[Tie, ...]
    coupled: bool


class Entry(NamedTuple):
    """The centre of a circle enters a pocket."""

    circle: int
    pocket: int
    mark: Mark


@dataclass(slots=True)
class Noted:
    """What an instant did, or a part of it, in the history's terms."""

    records: list[Record] = field(default_factory=list)
    entries: list[Entry] = field(default_factory=list)
    knots: list[tuple[int, tuple[Any, ...]]] = field(default_factory=list)
    reversal: Mark | None = None
    last: Mark | None = None


@dataclass
class History:
    """What a loop has gathered, always up to the end of a whole instant.

    Attributes:
        records: the events.
        entries: the entries into pockets.
        reversal: how many events came before it, and when it was.
        knots: for each circle (t, x, y, vx, vy, steps of the log, number of the instant) at the start and after
            each instant that changed its velocity.
        last: the last instant at which anything happened; None before the first.
        steps: the log.
        plan: what each rung decided, and what was skipped.
        rises: the bits of each rise of the precision, and whether deviations were kept in a set from then on.
        assumptions: what the run rests on that is not proved.
        set_times: limits and the reversal's time, with the number of the last part of the instant that falls on it.
    """

    records: list[Record] = field(default_factory=list)
    entries: list[Entry] = field(default_factory=list)
    reversal: tuple[int, Mark] | None = None
    knots: list[list[tuple[Any, ...]]] = field(default_factory=list)
    last: Mark | None = None
    steps: list[Step] = field(default_factory=list)
    plan: Counter[str] = field(default_factory=Counter)
    rises: list[tuple[int, bool]] = field(default_factory=list)
    assumptions: list[Assumption] = field(default_factory=list)
    set_times: dict[Quantity, int] = field(default_factory=dict)

    def add(self, note: Noted) -> None:
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
