"""Two logs that are compared: how each is read, what bodies are called in both, and what is found."""

from __future__ import annotations

import copy
import math
from collections import Counter, deque
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import chain, islice, pairwise
from pathlib import Path
from typing import Any

import numpy as np

from ..validation import EngineError
from .growing import NEVER, Growing, Unit
from .log_format import Log, LogRecord

HEAD = 400
"""Records that are read ahead, to learn what a log has."""

MOST_HEAD = 1 << 25
"""Letters of them."""

NEAR, MOST_NEAR = 1e-7, 5_000
"""Share of the scene within which bodies start nearly alike, and bodies up to which such are looked for."""

AROUND = 3
"""Records kept for the table, on each side of the first difference."""


@dataclass(frozen=True)
class OtherPartner:
    """Whom a body meets first that it does not meet in the other run.

    Attributes:
        number, step, time: where, in the first log; in the second where the first has none.
        body: whose.
        a, b: its partners, joined by " + "; None for nobody.
        times: when, in each run.
        lines: of each log.
    """

    number: int
    step: int | None
    time: float | None
    body: str
    a: str | None
    b: str | None
    times: tuple[float | None, float | None]
    lines: tuple[int | None, int | None]


@dataclass
class Found:
    """What two logs have in common and not.

    Attributes:
        a, b: the logs, read.
        by: `step` or `body`: how records were paired.
        growing: the differences of states.
        compared: what there was to compare: states, contacts, hashes, times, inputs, fields.
        pairs: records, or meetings of bodies, that were compared.
        meeting: the first difference of partners.
        hash, input: the first record in which these differ: its record of each log.
        fields: free fields that differ: their first difference.
        reordered: the first (number, number) of what comes at another place.
        missing: (log, place) of lines that one log has and the other has not, though it goes on as if it had.
        repeated: (log, line) of lines that are there twice.
        uneven: the first record at which one log has the state of a body and the other only those of others: whose log
            has it (0 or 1), the record, the body, how many pairs of records there were up to it, and its state.
        all_told: whether each record with states, of one log at least, has those of all bodies.
        zeros: the first record at which a zero has another sign.
        explained: how many states differ by no more than the digits that one log leaves out.
        fields_alone: free fields that one log has at a record and the other has not: whose, and the record.
        field_leap: the first free field that differs by far more than states did by then, and where.
        alone: how many records of each log had none to be compared with; `alone_first`: the first of them.
        clock: how much later the clock of the second is, where it is otherwise the same.
        names: bodies of the first by what they are called in the second, where that differs.
        time_unit: what one rounding of a time is.
        tie: whether the first difference of partners is one of order, at one instant.
        meeting_off, onsets_then: by how many bits anything was off before it, and how many contacts there had been.
        first_states: the first record of which states were compared.
        contacts_each: whether contacts are logged; `touched_told`, with the states of those in contact.
        nans: first record with a number that is none, in both logs alike.
        context: records around the first difference, by log.
        final: last state of each body, by log.
        columns: which numbers of a state each log has that the other has, too; None for all.
    """

    a: Log
    b: Log
    by: str
    growing: Growing
    compared: Counter[str] = field(default_factory=Counter)
    pairs: int = 0
    meeting: OtherPartner | None = None
    hash: tuple[LogRecord, LogRecord] | None = None
    hash_same: int | None = None
    input: tuple[LogRecord, LogRecord] | None = None
    fields: dict[str, tuple[LogRecord, Any, Any]] = field(default_factory=dict)
    reordered: tuple[int, int] | None = None
    uneven: tuple[int, LogRecord, str, int, list[float]] | None = None
    all_told: bool = False
    zeros: LogRecord | None = None
    explained: int = 0
    fields_alone: dict[str, tuple[int, LogRecord]] = field(default_factory=dict)
    missing: list[tuple[str, str]] = field(default_factory=list)
    missing_count: int = 0
    repeated: list[tuple[str, int]] = field(default_factory=list)
    field_leap: tuple[str, LogRecord] | None = None
    alone: list[int] = field(default_factory=lambda: [0, 0])
    alone_first: list[LogRecord | None] = field(default_factory=lambda: [None, None])
    clock: float | None = None
    names: dict[str, str] = field(default_factory=dict)
    time_unit: Unit = field(default_factory=lambda: Unit(53))
    tie: bool = False
    meeting_off: float = NEVER
    onsets_then: int = 0
    first_states: int | None = None
    nans: str | None = None
    context: tuple[list[LogRecord], list[LogRecord]] = field(default_factory=lambda: ([], []))
    final: tuple[dict[str, list[float]], dict[str, list[float]]] = field(default_factory=lambda: ({}, {}))
    contacts: list[int] = field(default_factory=lambda: [0, 0])
    times_differ: tuple[LogRecord, LogRecord] | None = None
    contacts_each: bool = False
    touched_told: bool = False
    grid: bool = False
    last_common: LogRecord | None = None
    longer: str | None = None
    columns: tuple[list[int] | None, ...] = (None, None)

    def again(self) -> Iterator[Side]:
        """Both logs, to be read once more in the same words."""
        back = {theirs: ours for ours, theirs in self.names.items()}
        for log, rename, columns in zip((self.a, self.b), ({}, back), self.columns, strict=True):
            side = Side(Log(log.name))
            side.rename, side.columns = rename, columns
            side.translate()
            yield side


class Side:
    """One of two logs as it is read: its head, the rest, the last records, and whether it is at its end.

    Attributes:
        rename: ids by what the other log calls them.
        columns: which numbers of a state the other log has, too, in its order; None for all.
        events: how many records with contacts there have been.
    """

    def __init__(self, log: Log) -> None:
        letters, self.log = 0, log
        records = iter(log)
        self.head: list[LogRecord] = []
        for record in islice(records, HEAD):
            self.head.append(record)
            letters += sum(map(len, record.texts))
            if letters > MOST_HEAD:
                break
        self._records: Iterator[LogRecord] = chain(self.head, records)
        self.ring: deque[LogRecord] = deque(maxlen=AROUND + 1)
        self.rename: dict[str, str] = {}
        self.columns: list[int] | None = None
        self.ended = False
        self.last: LogRecord | None = None
        self.events = 0

    def translate(self) -> None:
        """Has records that are yet to come named as the other log names them."""
        if self.rename or self.columns is not None:
            self._records = map(self.translated, self._records)

    def next(self) -> LogRecord | None:
        """The next record."""
        record = next(self._records, None)
        if record is None:
            self.ended = True
            return None
        self.ring.append(record)
        self.last = record
        return record

    def translated(self, record: LogRecord) -> LogRecord:
        """A record in the words of the other log."""
        names, columns = self.rename, self.columns
        record = copy.copy(record)
        record.contacts = [(names.get(a, a), names.get(b, b)) for a, b in record.contacts]
        record.states = {
            names.get(body, body): row if columns is None else [row[j] for j in columns if j < len(row)]
            for body, row in record.states.items()
        }
        return record


def two_sides(one: str | Path, other: str | Path) -> tuple[Side, Side]:
    """Two logs that are read side by side, with their heads read: lines that are the same are parsed once.

    Raises:
        EngineError: for a log that cannot be read, and for two that have nothing to be compared.
    """
    logs = Log(one), Log(other)
    logs[1].parsed = logs[0].parsed
    a, b = map(Side, logs)
    check(a, b)
    if a.log.names and b.log.names and a.log.names != b.log.names:
        common = [name for name in a.log.names if name in b.log.names]
        for side in (a, b):
            own = side.log.names or []
            side.columns = None if own == common else [own.index(name) for name in common]
            if side.columns is not None:
                side.head = [*map(side.translated, side.head)]
    b.rename = names(a, b)
    for side in (a, b):
        side.translate()
    return a, b


def check(a: Side, b: Side) -> None:
    """Refuses two logs with nothing in common to be compared."""
    had = [kinds(side) for side in (a, b)]
    if not had[0] & had[1]:
        told = [" and ".join(sorted(kind)) or "nothing" for kind in had]
        raise EngineError(
            f"files {a.log.name!r} and {b.log.name!r}: the one has {told[0]}, the other {told[1]}: there is nothing to "
            "compare; log the same things in both"
        )
    if bool(a.head and a.head[0].step is not None) != bool(b.head and b.head[0].step is not None) and not (
        {"contacts", "states"} & had[0] & had[1] and all(r.time is not None for s in (a, b) for r in s.head[:3])
    ):
        raise EngineError(
            f"files {a.log.name!r} and {b.log.name!r}: one has steps, the other has not; log steps, or times, in both"
        )
    if a.log.names and b.log.names and not set(a.log.names) & set(b.log.names):
        raise EngineError(
            f"files {a.log.name!r} and {b.log.name!r}: states have {', '.join(a.log.names)[:80]} in the one and "
            f"{', '.join(b.log.names)[:80]} in the other; name the same numbers alike"
        )


def kinds(side: Side) -> set[str]:
    """What a log has to compare, from its first records."""
    found: set[str] = set()
    for record in side.head:
        found |= {
            kind
            for kind, there in (
                ("contacts", record.contacts), ("states", record.states), ("hashes", record.hash is not None),
                ("inputs", record.input is not None), ("fields", record.fields),
            )
            if there
        }  # fmt: skip
    if side.log.end is not None and not side.head:
        found |= {"contacts", "states"}
    return found


def grid(side: Side) -> bool:
    """Whether the times of a log are those of steps: whole multiples of one, which tell nothing of rounding."""
    if side.head and side.head[0].step is not None:
        return True
    times = sorted({record.time for record in side.head if record.time is not None})
    gaps = [y - x for x, y in pairwise(times) if y > x]
    if len(gaps) < 8:
        return False
    least = min(gaps)
    return all(abs(gap / least - round(gap / least)) < 1e-3 for gap in gaps) and max(gaps) / least < 1e5


def touched_told(side: Side) -> bool:
    """Whether the states of bodies come with their contacts, those aside that never have any, such as walls."""
    stated = {body for record in side.head for body in record.states}
    touching = [{i for p in record.contacts for i in p} & stated for record in side.head]
    return bool(stated) and all(t <= r.states.keys() for t, r in zip(touching, side.head, strict=True))


def all_told(side: Side) -> bool:
    """Whether each record with states has those of the same bodies."""
    told = [record.states.keys() for record in side.head if record.states]
    return bool(told) and all(keys == told[0] for keys in told)


def _starts(side: Side) -> dict[str, tuple[float, ...]]:
    """The first state of each body of a log's head."""
    found: dict[str, tuple[float, ...]] = {}
    for record in side.head:
        for body, row in record.states.items():
            found.setdefault(body, tuple(row))
    return found


def names(a: Side, b: Side) -> dict[str, str]:
    """What bodies of the second log are called in the first, by where they start, if their ids do not tell.

    Where the ids are the same and the bodies start as those of the same id do, or nearly, there is nothing to rename.
    """
    starts = _starts(a), _starts(b)
    ids = [
        {i for r in side.head for p in r.contacts for i in p} | set(s) for side, s in zip((a, b), starts, strict=True)
    ]
    if not starts[0] or not starts[1]:
        return _names_by_order(a, b, ids)
    common = starts[0].keys() & starts[1].keys()
    if len(common) * 2 > max(len(starts[0]), len(starts[1])) and any(starts[0][i] == starts[1][i] for i in common):
        own = sum(starts[0][i] == starts[1][i] for i in common)
    else:
        own = 0
    places = [_unique(s) for s in starts]
    alike = {places[1][row]: places[0][row] for row in places[0].keys() & places[1].keys()}
    if not common and len(alike) * 2 < min(map(len, starts)):
        alike = _nearly(*starts)
    if len(alike) <= own or (common and own * 2 >= len(common)):
        return {}
    rest = [
        {i: row for i, row in s.items() if i not in known}
        for s, known in zip(starts, ({*alike.values()}, alike), strict=True)
    ]
    if rest[0] and rest[1]:
        only = len(rest[0]) == len(rest[1]) == 1
        alike |= {next(iter(rest[1])): next(iter(rest[0]))} if only else _nearly(*rest)
    moved = {theirs: ours for theirs, ours in alike.items() if theirs != ours}
    if not moved or (common and len(alike) * 2 < len(common)):
        return {}
    if any(i not in alike and i in moved.values() for i in ids[1]):
        return {}
    return {**moved, **_names_of_others(a, b, ids, moved)}


def _names_of_others(a: Side, b: Side, ids: list[set[str]], moved: dict[str, str]) -> dict[str, str]:
    """What things without states, such as walls, are called in the first log: by whom bodies meet in both."""
    found: dict[str, str] = {}
    met: list[dict[str, list[str]]] = [{}, {}]
    for partners, side, names in zip(met, (a, b), ({}, moved), strict=True):
        for record in side.head:
            for p, q in record.contacts:
                partners.setdefault(names.get(p, p), []).append(names.get(q, q))
                partners.setdefault(names.get(q, q), []).append(names.get(p, p))
    for body in met[0].keys() & met[1].keys():
        for ours, theirs in zip(met[0][body], met[1][body], strict=False):
            if ours == theirs:
                continue
            if theirs in ids[0] or ours in ids[1] or found.setdefault(theirs, ours) != ours:
                break
    return found if len(set(found.values())) == len(found) else {}


def _unique(starts: dict[str, tuple[float, ...]]) -> dict[tuple[float, ...], str]:
    """Bodies by their first state, where no other has it."""
    counts = Counter(starts.values())
    return {row: body for body, row in starts.items() if counts[row] == 1}


def _nearly(one: dict[str, tuple[float, ...]], other: dict[str, tuple[float, ...]]) -> dict[Any, str]:
    """Bodies of the second by those of the first that start nearest, where that is far nearer than any other."""
    widths = {len(row) for starts in (one, other) for row in starts.values()}
    if len(widths) != 1 or not widths.isdisjoint({0}) or max(len(one), len(other)) > MOST_NEAR:
        return {}
    rows, theirs = np.array(list(one.values())), np.array(list(other.values()))
    with np.errstate(all="ignore"):
        scales = np.nanmax(np.abs(rows), axis=0)
        scales[~(scales > 0)] = 1.0
        ids, found = list(one), {}
        for body, row in zip(other, theirs, strict=True):
            off = np.nan_to_num(np.max(np.abs(rows - row) / scales, axis=1), nan=math.inf)
            near = int(off.argmin())
            least, off[near] = off[near], math.inf
            if least <= NEAR and off.min() > 1e3 * max(least, NEAR):
                found[body] = ids[near]
    return found if len(set(found.values())) == len(found) else {}


def _names_by_order(a: Side, b: Side, ids: list[set[str]]) -> dict[str, str]:
    """Names of logs of contacts alone that share none: by the order in which they come, where that fits throughout."""
    if ids[0] & ids[1] or not ids[0]:
        return {}
    found: dict[str, str] = {}
    taken: set[str] = set()
    for one, other in zip(a.head, b.head, strict=False):
        for p, q in zip(one.contacts, other.contacts, strict=False):
            for x, y in zip(p, q, strict=True):
                if found.setdefault(y, x) != x or (y not in found and x in taken):
                    raise EngineError(
                        f"files {a.log.name!r} and {b.log.name!r}: no body has the same id in both, and they cannot be "
                        "matched by their order; name bodies alike, or log states at the start"
                    )
                taken.add(x)
    return found
