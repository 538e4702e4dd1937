"""The independent witness: brute force on small scenes that looks at every gap anew at every instant, in long numbers.

Numbers are whole multiples of 2**-bits (`flint.fmpz`), plain points without enclosures. There is no queue and no
memory of contacts. At an instant whatever falls on it is settled in one fixed order:

1. contacts, cluster by cluster, in rounds until none approaches: at most one event;
2. pocket entries, in the state that the contacts leave: a centre on the rim that moves strictly inward;
3. the reversal, if it is due, and then once more contacts (an event of its own at the same time) and entries;
4. the limits.

What is below 2**-(4/5 bits) is zero, what is above 2**-(1/2 bits) is not; anything between raises `Doubt`, and
`referee` plays again with twice the bits. So a flaw of 10**-100 is no zero, nor is its square.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from typing import Any

from flint import arb, fmpz  # type: ignore[attr-defined]

from fuzz.table import Blow, Doubt, Endless, Entry, Row, Table, TooLong
from truebreak.scenarios import Quantity, Scene

PLAIN, FINE, FINEST = 768, 2048, 8192
"""First bits for a scene of plain numbers, and for one with a number of over 40 bits, a deliberate flaw, or of so many
that its flaw would not be seen otherwise."""
LONG, LONGEST = 40, 1500
MOST_BITS = 16_384
MOST_EVENTS = 60
"""A scene with more events before its limit is none for the fuzz: a circle may rattle 10**40 times in a narrow gap."""


@dataclass(frozen=True)
class Told:
    """The refereed history of a scene, in multiples of 2**-bits.

    Attributes:
        reversal: the number of events before the reversal, and its time.
        stop: the name of the reason to stop; "ENDLESS" where the impulses of the next instant have no end (a disc
            that fills the gap between two walls and is pushed towards one): no engine can tell what follows.
        knots: the state of all circles after each instant at which something happened, and at the end.
        left: for each event, the state as it and the entries after it leave it, before a reversal at that instant.
        entered: likewise for each entry.
    """

    bits: int
    events: tuple[Blow, ...]
    entries: tuple[Entry, ...]
    reversal: tuple[int, fmpz] | None
    stop: str
    final_time: fmpz
    knots: tuple[tuple[fmpz, tuple[Row, ...]], ...]
    left: tuple[tuple[Row, ...], ...]
    entered: tuple[tuple[Row, ...], ...]

    def at(self, time: fmpz) -> list[Row]:
        """The state at a time; within rounding of an instant, the state after it."""
        close = fmpz(1) << (self.bits // 5)
        place = bisect_right([when - close for when, _ in self.knots], time) - 1
        when, rows = self.knots[max(place, 0)]
        dt = time - when
        return [(x + (vx * dt >> self.bits), y + (vy * dt >> self.bits), vx, vy) for x, y, vx, vy in rows]

    @property
    def final(self) -> list[Row]:
        """The state at the end."""
        return list(self.knots[-1][1])

    def number(self, value: fmpz) -> arb:
        """A fixed-point number as the exact ball that it is."""
        return arb((value, -self.bits))


class Play:
    """One play at one precision; see `referee`."""

    def __init__(self, scene: Scene, until: Quantity | None, events: int | None, bits: int, most: int) -> None:
        if until is None and events is None:
            until, events = scene.until, scene.events
        self.table, self.most = Table(scene, bits), most
        read = self.table.read
        self.limit = None if until is None else read(until)
        self.turn_at = None if scene.reverse_at is None else read(scene.reverse_at)
        self.turn_after = scene.reverse_after
        turns = self.turn_at is not None or self.turn_after is not None
        self.there_and_back = turns and self.limit is None and events is None
        self.wanted = 1000 if self.limit is None and events is None and not turns else events
        self.blows: list[Blow] = []
        self.entries: list[Entry] = []
        self.knots: list[tuple[fmpz, tuple[Row, ...]]] = []
        self.left: list[tuple[Row, ...]] = []
        self.entered: list[tuple[Row, ...]] = []
        self.reversal: tuple[int, fmpz] | None = None

    def settle(self) -> bool:
        """Contacts and entries; whether the last event that is wanted has happened."""
        found = self.table.blow()
        if found is not None:
            self.blows.append(found)
            if len(self.blows) > self.most:
                raise TooLong(f"over {self.most} events")
        self.entries += self.table.enter()
        rows = self.table.rows()
        self.left += [rows] * (len(self.blows) - len(self.left))
        self.entered += [rows] * (len(self.entries) - len(self.entered))
        return self.wanted is not None and len(self.blows) >= self.wanted

    def turn_is_due(self) -> bool:
        """Whether the reversal falls on this instant."""
        if self.reversal is not None:
            return False
        if self.turn_after is not None:
            return len(self.blows) == self.turn_after
        return self.turn_at is not None and self.table.sign(self.turn_at - self.table.now) == 0

    def instant(self) -> str | None:
        """Settles all that falls on this instant; the reason to stop, if it is the last."""
        table = self.table
        full = self.settle()
        if not full and self.turn_is_due():
            self.reversal = len(self.blows), table.now
            table.flip()
            full = self.settle()
            if self.there_and_back:
                self.limit = 2 * table.now
        self.knots.append((table.now, table.rows()))
        if full:
            return "EVENTS"
        return "HORIZON" if self.limit is not None and table.sign(self.limit - table.now) == 0 else None

    def told(self) -> Told:
        """The whole history."""
        table, bits = self.table, self.table.bits
        while True:
            marks = len(self.blows), len(self.entries), self.reversal
            before = table.rows()
            try:
                stop = self.instant()
            except Endless:
                del self.blows[marks[0] :], self.entries[marks[1] :], self.left[marks[0] :], self.entered[marks[1] :]
                self.reversal = marks[2]
                self.knots = self.knots or [(table.now, before)]
                stop = "ENDLESS"
            wait = table.next_wait() if stop is None else None
            turn = self.turn_at if self.reversal is None else None
            nexts = [t for t in (self.limit, turn, None if wait is None else table.now + wait) if t is not None]
            if stop is None and not nexts:
                stop = "QUIET"
            if stop is not None:
                blows, entries, knots = tuple(self.blows), tuple(self.entries), tuple(self.knots)
                left, entered = tuple(self.left), tuple(self.entered)
                return Told(bits, blows, entries, self.reversal, stop, knots[-1][0], knots, left, entered)
            table.advance(min(nexts))


def referee(
    scene: Scene, until: Any = None, events: int | None = None, bits: int | None = None, most: int = MOST_EVENTS
) -> Told:
    """The history of a scene, at as many bits as it takes to be in no doubt.

    Raises:
        Doubt: where `MOST_BITS` do not suffice.
        TooLong: where there are more than `most` events.
    """
    until = None if until is None else Quantity.of(until)
    bits = bits or first_bits(scene, until)
    while True:
        try:
            return Play(scene, until, events, bits, most).told()
        except Doubt:
            bits *= 2
            if bits > MOST_BITS:
                raise


def first_bits(scene: Scene, until: Quantity | None = None) -> int:
    """More for a scene in which some number has many digits: it may hold a flaw that must not count as zero."""
    things = [(c.x, c.y, c.r, c.vx, c.vy, c.m) for c in scene.circles]
    things += [(w.x0, w.y0, w.x1, w.y1) for w in scene.walls] + [(p.x, p.y, p.r) for p in scene.pockets]
    numbers = [q for row in things for q in row] + [scene.reverse_at, until]
    longest = max((_length(q) for q in numbers if isinstance(q, Quantity)), default=0)
    return FINEST if longest > LONGEST else FINE if longest > LONG else PLAIN


def _length(quantity: Quantity) -> int:
    if quantity.rational is not None:
        return quantity.rational.q.bit_length()
    return max((_length(argument) for argument in quantity.args), default=0)
