"""Two records that belong together compared, and records of both logs paired by their step."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from itertools import chain
from typing import Any

from .growing import NEVER
from .log_format import LogRecord
from .sides import Found, OtherPartner, Side, kinds

MOST_FIELDS = 100
"""Free fields of which it is kept where they differ."""

MOST_BODIES = 100_000
"""Bodies of which the last state is kept."""

MOST_KEPT = 20
"""Lines that are missing, or there twice, of which it is kept which they are."""

WIDENED = 8
"""Of so many records one is looked at for the largest numbers."""


FIELD_LEAP = 16.0
"""Bits above what states are off by from which a free field that differs is not computed from them."""


class RecordPairs:
    """What both ways of pairing share."""

    def __init__(self, a: Side, b: Side, found: Found, ignore: frozenset[str]) -> None:
        self.sides, self.found, self.ignore = (a, b), found, ignore
        self.growing = found.growing
        self.settled = 0
        coarse = self.growing.unit.coarse
        self.fewer = coarse if coarse is not None and coarse.side is not None else None
        self.plain = not (b.rename or a.columns or b.columns)
        self.only_fields = not ({"contacts", "states", "hashes"} & kinds(a) & kinds(b))

    def after(self) -> None:
        """Takes the records around the first difference, once a few after it are read."""
        found = self.found
        if found.context[0] or found.context[1]:
            return
        differs = self.growing.early or found.meeting or found.hash or found.input
        if not differs:
            return
        self.settled += 1
        if self.settled >= 2:
            for context, side in zip(found.context, self.sides, strict=True):
                context.extend(side.ring)

    def next(self, which: int) -> LogRecord | None:
        """The next record of one log; what it has is noted for the end."""
        record = self.sides[which].next()
        if record is None:
            return None
        found, count = self.found, len(record.contacts)
        found.contacts[which] += count
        if which == 0:
            self.growing.onsets += count
        if record.states:
            final = found.final[which]
            if len(final) < MOST_BODIES:
                final.update(record.states)
            else:
                final.update((body, row) for body, row in record.states.items() if body in final)
        return record

    def alike(self, a: LogRecord, b: LogRecord) -> None:
        """Two records that are the same to the letter, and mean the same."""
        found, growing, states = self.found, self.growing, a.states
        compared = found.compared
        found.pairs += 1
        found.last_common = a
        compared["contacts"] += len(a.contacts)
        if states:
            self.first(a)
            compared["states"] += len(states)
            for body in states:
                growing.same(body, a.number)
            looked_at = found.pairs % WIDENED == 1
            if looked_at:
                for row in states.values():
                    growing.unit.widen(row)
            if found.nans is None and (looked_at or any("NaN" in text for text in a.texts)):
                found.nans = a.place() if any(map(math.isnan, chain.from_iterable(states.values()))) else None
        if a.hash is not None:
            compared["hashes"] += 1
            if found.hash is None:
                found.hash_same = a.number
        compared["inputs"] += a.input is not None
        compared["fields"] += len(a.fields)
        if self.only_fields:
            for name, value in a.fields.items():
                if isinstance(value, int | float):
                    growing.same(f"({name})", a.number)
                    growing.unit.widen((float(value),), name)

    def first(self, a: LogRecord) -> None:
        """Keeps the first record of which states are compared."""
        if self.found.first_states is None or a.number < self.found.first_states:
            self.found.first_states = a.number
            for row in a.states.values():
                self.growing.unit.widen(row)

    def states(self, a: LogRecord, b: LogRecord, body: str, touching: bool, before: float) -> float:
        """Compares one body's states, if both have one; by how many bits they are off."""
        found, growing = self.found, self.growing
        one, other = a.states.get(body), b.states.get(body)
        if one is None or other is None:
            if one is not other:
                self.uneven(a, b)
            return NEVER
        found.compared["states"] += 1
        if one == other:
            growing.same(body, a.number)
            if 0.0 in one:
                self.zeros(a, one, other)
            if found.pairs % WIDENED == 1:
                growing.unit.widen(one)
            if found.nans is None and any(map(math.isnan, one)):
                found.nans = a.place()
            return NEVER
        if self.fewer is not None and len(one) == len(other) and all(map(self.fewer.explains, one, other)):
            found.explained += 1
            growing.same(body, a.number)
            return NEVER
        if found.pairs % WIDENED == 1:
            growing.unit.widen(one)
        off = growing.differs(a, b, body, (one, other), touching, before)
        if off == NEVER and found.nans is None:
            found.nans = a.place()
        return off

    def all_states(self, a: LogRecord, b: LogRecord, partners: Mapping[str, Iterable[str]]) -> None:
        """Compares the states of all bodies of two records."""
        growing = self.growing
        if a.states and b.states:
            self.first(a)
        if a.states.keys() != b.states.keys():
            self.uneven(a, b)
        befores = {body: growing.before(body, partners.get(body, ())) for body in a.states} if growing.off else {}
        for body in a.states:
            if body in b.states:
                self.states(a, b, body, body in partners, befores.get(body, NEVER))

    def uneven(self, a: LogRecord, b: LogRecord) -> None:
        """Keeps the first record of which one log has the state of a body and the other only those of others."""
        if self.found.uneven is None and a.states and b.states:
            for side, more in enumerate((a.states.keys() - b.states.keys(), b.states.keys() - a.states.keys())):
                if more:
                    body = min(more)
                    self.found.uneven = side, a, body, self.found.pairs, (a, b)[side].states[body]
                    break

    def zeros(self, a: LogRecord, one: list[float], other: list[float]) -> None:
        """Keeps the first record at which a zero has another sign: two such are equal, and have other bits."""
        if self.found.zeros is None and any(
            x == 0.0 and math.copysign(1.0, x) != math.copysign(1.0, y) for x, y in zip(one, other, strict=True)
        ):
            self.found.zeros = a

    def others(self, a: LogRecord, b: LogRecord) -> None:
        """Compares what is not of a body: hash, input and free fields."""
        found = self.found
        if a.hash is not None and b.hash is not None:
            found.compared["hashes"] += 1
            if a.hash == b.hash:
                if found.hash is None:
                    found.hash_same = a.number
            elif found.hash is None:
                found.hash = a, b
        if a.input != b.input and not (a.input is None and b.input is None):
            found.compared["inputs"] += 1
            if found.input is None:
                found.input = a, b
        if not a.fields and not b.fields:
            return
        for name in a.fields.keys() ^ b.fields.keys():
            if name not in self.ignore and name not in found.fields_alone and len(found.fields_alone) < MOST_FIELDS:
                found.fields_alone[name] = (0, a) if name in a.fields else (1, b)
        for name in a.fields.keys() & b.fields.keys():
            if name in self.ignore:
                continue
            x, y = a.fields[name], b.fields[name]
            found.compared["fields"] += 1
            number = isinstance(x, int | float) and isinstance(y, int | float) and not isinstance(x, bool)
            if self.only_fields and number:
                own, rows = f"({name})", ((float(x),), (float(y),))
                if _alike(x, y):
                    self.growing.same(own, a.number)
                    self.growing.unit.widen(rows[0], name)
                else:
                    before = self.growing.before(own, ())
                    self.growing.differs(a, b, own, rows, False, before, key=name, name=name)
            elif not _alike(x, y) and name not in found.fields and len(found.fields) < MOST_FIELDS:
                found.fields[name] = a, x, y
                off = abs(x - y) / max(abs(x), abs(y)) if type(x) is type(y) is float else 1.0
                size = 52 + math.log2(off) if off > 0 else 52.0
                if found.field_leap is None and size > max(self.growing.largest, 0.0) + FIELD_LEAP:
                    found.field_leap = name, a

    def repeated(self, side: int, line: int) -> None:
        """Keeps a line that is there twice."""
        lines = self.found.repeated
        if len(lines) < MOST_KEPT and ("ab"[side], line) not in lines:
            lines.append(("ab"[side], line))

    def missing(self, side: int, record: LogRecord) -> None:
        """Keeps a record of one log that the other has not, though it goes on as if it had."""
        reported = ("ba"[side], record.place())
        if len(self.found.missing) < MOST_KEPT and reported not in self.found.missing:
            self.found.missing.append(reported)
        self.found.missing_count += 1

    def alone(self, side: int, record: LogRecord) -> None:
        """Counts a record that one log has alone."""
        self.found.alone[side] += 1
        if self.found.alone_first[side] is None:
            self.found.alone_first[side] = record

    def meet(
        self, records: tuple[LogRecord | None, LogRecord | None], body: str, partners: tuple[str | None, str | None]
    ) -> None:
        """Keeps the earliest difference of partners: the records in which a body has them, and who they are."""
        found, record = self.found, records[0] or records[1]
        assert record is not None
        if found.meeting is None:
            found.meeting_off, found.onsets_then = self.growing.largest, self.growing.onsets
        elif record.number >= found.meeting.number:
            return
        times, lines = ([r and getattr(r, what) for r in records] for what in ("time", "line"))
        found.meeting = OtherPartner(
            record.number, record.step, record.time, body, *partners, (times[0], times[1]), (lines[0], lines[1])
        )


class BySteps(RecordPairs):
    """Records of both logs by their step, continued over restarts."""

    def run(self) -> None:
        """Reads both logs to their ends."""
        a, b = self.next(0), self.next(1)
        while a is not None and b is not None:
            x, y = (-1 if r.step is None else r.step for r in (a, b))
            if x == y:
                self.both(a, b)
            elif x < y:
                self.one(0, a)
            else:
                self.one(1, b)
            a, b = a if y < x else self.next(0), b if x < y else self.next(1)
            self.after()
        if a is not None or b is not None:
            self.found.longer = "b" if a is None else "a"
        self.settled += 2
        self.after()
        for which in (0, 1):
            while self.next(which) is not None:
                pass

    def one(self, side: int, record: LogRecord) -> None:
        """A step that one log has alone."""
        self.alone(side, record)
        if record.contacts:
            self.missing(side, record)

    def both(self, a: LogRecord, b: LogRecord) -> None:
        """One step of both."""
        if a.repeats != b.repeats:
            self.repeated(*((0, a.line) if a.repeats > b.repeats else (1, b.line)))
        if self.plain and a.texts == b.texts:
            self.alike(a, b)
            return
        self.found.pairs += 1
        self.found.last_common = a
        self.times(a, b)
        self.contacts(a, b)
        partners: dict[str, list[str]] = {}
        for p, q in a.contacts if a.contacts == b.contacts else chain(a.contacts, b.contacts):
            partners.setdefault(p, []).append(q)
            partners.setdefault(q, []).append(p)
        self.all_states(a, b, partners)
        self.others(a, b)

    def times(self, a: LogRecord, b: LogRecord) -> None:
        """Compares the clocks of a step, but for how much later one was started."""
        found = self.found
        if a.clock is None or b.clock is None or "time" in self.ignore:
            return
        found.compared["times"] += 1
        late = b.clock - a.clock
        if found.clock is None:
            found.clock = late if abs(late) > 1e-9 * max(abs(a.clock), abs(b.clock)) else 0.0
        elif abs(late - found.clock) > 1e-6 * max(abs(a.clock), abs(b.clock), 1e-300) and found.times_differ is None:
            found.times_differ = a, b

    def contacts(self, a: LogRecord, b: LogRecord) -> None:
        """Compares the contacts of a step, in whatever order."""
        found = self.found
        if not a.contacts and not b.contacts:
            return
        found.compared["contacts"] += max(len(a.contacts), len(b.contacts))
        if a.contacts == b.contacts:
            return
        counts = [Counter(tuple(sorted(p)) for p in r.contacts) for r in (a, b)]
        if counts[0] == counts[1]:
            if found.reordered is None:
                found.reordered = a.number, b.number
            return
        if found.meeting is not None:
            return
        more = sorted((counts[0] - counts[1]).keys()) or sorted((counts[1] - counts[0]).keys())
        body = min(more[0], key=lambda i: sum(i in p for r in (a, b) for p in r.contacts))  # a ground has many
        own = [[q if p == body else p for p, q in r.contacts if body in (p, q)] for r in (a, b)]
        partners = [" + ".join(sorted(names)) or None for names in own]
        self.meet((a, b), body, (partners[0], partners[1]))


def _alike(x: Any, y: Any) -> bool:
    """Whether two values are the same; a number that is none is the same as another such."""
    return x == y or (isinstance(x, float) and isinstance(y, float) and math.isnan(x) and math.isnan(y))
