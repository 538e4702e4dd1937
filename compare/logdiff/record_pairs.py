"""Two records that belong together compared: states, contacts, hashes, inputs and free fields."""

from __future__ import annotations

import math
from itertools import chain
from typing import Any

from .growing import NEVER
from .log_format import Record
from .sides import Found, Meeting, Side, kinds

MOST_FIELDS = 100
"""Free fields of which it is kept where they differ."""

MOST_BODIES = 100_000
"""Bodies of which the last state is kept."""

MOST_REPEATED = 20
"""Lines that are there twice of which it is kept which they are."""


class RecordPairs:
    """What both ways of pairing share."""

    def __init__(self, a: Side, b: Side, found: Found, ignore: frozenset[str]) -> None:
        self.a, self.b, self.found, self.ignore = a, b, found, ignore
        self.growing = found.growing
        self.settled = 0
        perm = None
        if a.log.names and b.log.names and a.log.names != b.log.names:
            perm = [b.log.names.index(name) for name in a.log.names]
        self.perm = perm
        self.plain = perm is None and not b.rename
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
            found.context[0].extend(self.a.ring)
            found.context[1].extend(self.b.ring)

    def take(self, side: int, record: Record) -> None:
        """Notes what a record has, for the end."""
        found = self.found
        found.contacts[side] += len(record.contacts)
        if record.states:
            self.end(found.final[side], record.states)
            if found.first_states is None and side == 0:
                found.first_states = record.number

    @staticmethod
    def end(final: dict[str, list[float]], states: dict[str, list[float]]) -> None:
        """Keeps the last states of bodies, of the first that there are."""
        if len(final) < MOST_BODIES:
            final.update(states)
        else:
            final.update((body, row) for body, row in states.items() if body in final)

    def alike(self, a: Record, b: Record) -> None:
        """Two records that are the same to the letter, and mean the same."""
        found, growing, states = self.found, self.growing, a.states
        compared, count = found.compared, len(a.contacts)
        found.pairs += 1
        found.last_common = a
        found.contacts[0] += count
        found.contacts[1] += count
        growing.onsets += count
        compared["contacts"] += count
        if states:
            self.end(found.final[0], states)
            self.end(found.final[1], states)
            if found.first_states is None:
                found.first_states = a.number
            compared["states"] += len(states)
            for body in states:
                growing.same(body, a.number)
            if found.pairs % 8 == 1:
                for row in states.values():
                    growing.unit.widen(row)
                    if found.nans is None and any(map(math.isnan, row)):
                        found.nans = a.place()
            elif found.nans is None and any("NaN" in text for text in a.texts) and _nan(states):
                found.nans = a.place()
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

    def uneven(self, a: Record, b: Record) -> None:
        """Keeps the first record of which one log has the state of a body and the other only those of others."""
        if self.found.uneven is None and a.states and b.states:
            for side, more in enumerate((a.states.keys() - b.states.keys(), b.states.keys() - a.states.keys())):
                if more:
                    self.found.uneven = side, a, min(more), self.found.pairs
                    break

    def zeros(self, a: Record, one: list[float], other: list[float]) -> None:
        """Keeps the first record at which a zero has another sign: two such are equal, and have other bits."""
        if self.found.zeros is None and any(
            x == 0.0 and math.copysign(1.0, x) != math.copysign(1.0, y) for x, y in zip(one, other, strict=True)
        ):
            self.found.zeros = a

    def others(self, a: Record, b: Record) -> None:
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
        if a.fields or b.fields:
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
                    if _alike(x, y):
                        self.growing.same(f"({name})", a.number)
                        self.growing.unit.widen((float(x),), name)
                    else:
                        before = self.growing.before(f"({name})", ())
                        self.growing.differs(
                            a, b, f"({name})", ((float(x),), (float(y),)), False, before, key=name, name=name
                        )
                elif not _alike(x, y) and name not in found.fields and len(found.fields) < MOST_FIELDS:
                    found.fields[name] = a, x, y

    def states(self, a: Record, b: Record, body: str, partners: Any, before: float | None = None) -> float:
        """Compares one body's states, if both have one; by how many bits they are off."""
        one, other = a.states.get(body), b.states.get(body)
        if one is None or other is None:
            if one is not other:
                self.uneven(a, b)
            return NEVER
        self.found.compared["states"] += 1
        if self.perm is not None and len(other) == len(self.perm):
            other = [other[j] for j in self.perm]
        if one == other:
            if self.found.nans is None and any(map(math.isnan, one)):
                self.found.nans = a.place()
            self.growing.same(body, a.number)
            if 0.0 in one:
                self.zeros(a, one, other)
            if self.found.compared["states"] % 8 == 1:
                self.growing.unit.widen(one)
            return NEVER
        if before is None:
            before = self.growing.before(body, partners)
        return self.growing.differs(a, b, body, (one, other), bool(partners), before)

    def repeated(self, side: int, line: int) -> None:
        """Keeps a line that is there twice."""
        lines = self.found.repeated
        if len(lines) < MOST_REPEATED and ("ab"[side], line) not in lines:
            lines.append(("ab"[side], line))

    def meet(self, meeting: Meeting) -> None:
        """Keeps the earliest difference of partners."""
        if self.found.meeting is None:
            self.found.meeting_off, self.found.onsets_then = self.growing.largest, self.growing.onsets
        if self.found.meeting is None or meeting.number < self.found.meeting.number:
            self.found.meeting = meeting


def _nan(states: dict[str, list[float]]) -> bool:
    """Whether a number of a state is none: letters of what is packed may look like it."""
    return any(map(math.isnan, chain.from_iterable(states.values())))


def _alike(x: Any, y: Any) -> bool:
    """Whether two values are the same; a number that is none is the same as another such."""
    return x == y or (isinstance(x, float) and isinstance(y, float) and math.isnan(x) and math.isnan(y))
