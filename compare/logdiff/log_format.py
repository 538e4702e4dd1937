"""The log of a run, version 1: JSON lines, CSV, or a list of hashes, read one record at a time.

Bodies have any shape, in two or three dimensions; nothing is known of the world but what the log says. The page
docs/log-format.md has every key.
"""

from __future__ import annotations

import copy
import json
import math
import re
from binascii import a2b_base64
from collections.abc import Callable, Iterator
from itertools import chain
from pathlib import Path
from struct import unpack
from typing import Any

from ..foreign.log_engine import cells_of, once, text_lines
from ..validation import EngineError

FORMAT = "truebreak/log-1"
"""What the header of a log says under `log`. A log without a header is read all the same."""

MOST_LINE = 1 << 24
"""Bytes of one line: the states of 100,000 bodies."""

SHOWN = 60
"""Characters of a strange line that an error repeats."""

OWN_KEYS = frozenset(
    {"step", "time", "contact", "contacts", "states", "hash", "input", "end", "quiet", "outline", "order", "packed"}
)
"""The keys of a line that have a meaning of their own; all others are free, and compared by name. A first line with
none of them is a header."""

LISTS, FLOATS = frozenset({list}), frozenset({float})

TELLS = frozenset({"log", "outline", "order", "end"})
"""Keys of lines that are no events."""

KEPT = 256
"""Parsed lines that are kept for the other log: so far apart independent events usually are."""

USELESS = 4_000
"""Lines in a row that are not among the other's, after which they are no longer kept for it."""


def _whole(text: str) -> float:
    """A number without a point: printf writes the zero below 0 as -0."""
    return -0.0 if text == "-0" else int(text)


DECODE = json.JSONDecoder(parse_int=_whole).raw_decode

WORDS = re.compile(r"[\s,;:=]+")

NOT_JSON = re.compile(r"(?<=[\[,:\s])(-?)(nan|inf|infinity)(?:\([^)]*\))?(?=[\],}\s])", re.IGNORECASE)
"""What printf writes for a number that is none."""


class Record:
    """One step or one event of a log; the lines of one step are one record.

    Attributes:
        line: number of its first line, from 1.
        number: its place among the records, from 0.
        step: the step, continued over restarts; None in a log without steps.
        time: the time, as written; None where there is none.
        clock: the time, continued over restarts.
        contacts: pairs of ids, in the order of the log.
        states: numbers by body.
        hash: of the whole state, as text.
        input: whatever was fed in.
        fields: free fields by name.
        repeats: how many of its lines repeat the line before them.
        texts: its lines.
    """

    __slots__ = (
        "clock", "contacts", "fields", "hash", "input", "line", "number", "repeats", "states", "step", "texts", "time",
    )  # fmt: skip

    def __init__(self, line: int, text: str) -> None:
        self.line, self.number, self.texts, self.repeats = line, 0, [text], 0
        self.step: int | None = None
        self.time: float | None = None
        self.clock: float | None = None
        self.contacts: list[tuple[str, str]] = []
        self.states: dict[str, list[float]] = {}
        self.hash: str | None = None
        self.input: Any = None
        self.fields: dict[str, Any] = {}

    def copied(self) -> Record:
        """Another record of the same, to which lines can be added."""
        other = copy.copy(self)
        other.texts, other.contacts = list(self.texts), list(self.contacts)
        other.states, other.fields = dict(self.states), dict(self.fields)
        return other

    def place(self) -> str:
        """Where it is, for a person: its step or number, its time and its line.

        >>> record = Record(7, "")
        >>> record.step, record.time = 5, 0.25
        >>> record.place()
        'step 5, t = 0.25, line 7'
        """
        named = f"step {self.step}" if self.step is not None else f"event {self.number}"
        at = "" if self.time is None else f", t = {self.time:.9g}"
        return f"{named}{at}, line {self.line}"


class Log:
    """A log that is read from its beginning to its end, once, line by line: `take` each, then `finish`.

    Iterating reads the file and gives its records.

    Attributes:
        name: its path, as given.
        header: what it says of itself: `engine`, `bits`, `dt`, and free settings.
        names: names of the numbers of a state, where the log says them.
        outlines: shapes by body, as the log has them.
        end: the time at which it says that it ends; None without an `end`.
        cut: number of a last line that is not whole; None if there is none.
        stride: steps between its records, at least; 0 if there are not two.
        count: how many records there have been.
        parsed: lines that another log, read beside this one, has had lately: what is in both is parsed once.
        restarts: (line, from, to) for each time that the clock, or the count of steps, begins anew.

    Raises:
        EngineError: naming the file, the line and the remedy.
    """

    def __init__(self, path: str | Path) -> None:
        self.name = str(path)
        self.header: dict[str, Any] = {}
        self.names: list[str] | None = None
        self.outlines: dict[str, Any] = {}
        self.end: float | None = None
        self.quiet = False
        self.cut: int | None = None
        self.restarts: list[tuple[int, float, float]] = []
        self.count = 0
        self.stride = 0
        self.parsed: dict[str, dict[str, Any]] = {}
        self._misses = self._shared = 0  # lines in a row that the other log had not lately, and letters that are kept
        self._form: Callable[[Log, int, str], Record | None] | None = None
        self._pending: Record | None = None  # a step that may have further lines
        self._last = ""
        self._damaged: tuple[int, str] | None = None
        self._last_step: tuple[int, int] | None = None  # as written, as continued
        self._last_gap = 1
        self._first_step = 0
        self._step_base = 0
        self._clock_base = 0.0
        self._clock_first: float | None = None
        self._clock_last = 0.0
        self._clock_gap = 0.0
        self._clock_records = 0
        self._hashes = 0
        self._width = 0
        self._order: list[str] = []
        self._columns: list[str] = []
        self._own: set[str] = set()
        self._row_pending: Record | None = None

    def __iter__(self) -> Iterator[Record]:
        for number, text in text_lines(Path(self.name), self.name, MOST_LINE):
            record = self.take(number, text)
            if record is not None:
                yield record
        yield from self.finish()

    def follow(self, other: Log) -> None:
        """Takes over what another log has said up to now, whose lines were the same."""
        own = {"name": self.name, "parsed": self.parsed}
        self.__dict__.update(other.__dict__ | own)
        self.header, self.outlines, self.restarts = dict(other.header), dict(other.outlines), list(other.restarts)
        self._pending = other._pending and other._pending.copied()
        self._row_pending = other._row_pending and other._row_pending.copied()

    def take(self, number: int, text: str) -> Record | None:
        """One more line that is not empty; the record that is whole with it, if one is."""
        form = self._form
        if form is None:
            form = Log._csv if self.name.lower().endswith(".csv") else Log._json if text[0] == "{" else Log._hash
            self._form = form
        elif self._damaged is not None:
            raise self._damage()
        record = form(self, number, text)
        if record is None:
            return None
        if record.step is None:
            return self._placed(record)
        current = self._pending
        if current is not None and record.step == current.step:
            self._merge(current, record, text == self._last)
            self._last = text
            return None
        self._pending, self._last = record, text
        return None if current is None else self._placed(current)

    def finish(self) -> list[Record]:
        """The log is at its end: the records that only that has made whole."""
        if self._form is None:
            raise EngineError(f"file {self.name!r}: is empty; was anything recorded?")
        if self._damaged is not None:
            number, text = self._damaged
            if self._form is Log._json and not text.startswith("{"):
                raise self._damage()
            self.cut = number
        left: list[Record] = []
        row, self._row_pending = self._row_pending, None
        if row is not None and row.step is None:
            left.append(self._placed(row))
        if self._pending is not None:
            left.append(self._placed(self._pending))
            self._pending = None
        if self.count == 0 and self.end is None:
            raise EngineError(f"file {self.name!r}: has no event, state or hash in it; was anything recorded?")
        return left

    def _fail(self, line: int, message: str) -> EngineError:
        return EngineError(f"file {self.name!r}, line {line}: {message}")

    def _damage(self) -> EngineError:
        """A line that is not whole, and not the last."""
        assert self._damaged is not None
        number, text = self._damaged
        if self._form is Log._csv:
            cells = len(cells_of(text, self.name))
            return self._fail(number, f"has {cells} cells, and {len(self._columns)} columns; is a line damaged?")
        return self._fail(number, f"{text[:SHOWN]!r} is not a whole JSON object; is a line of the log damaged?")

    def _merge(self, into: Record, record: Record, repeated: bool) -> None:
        """One more line of a step."""
        if repeated:
            into.repeats += 1
            return
        if into.hash is not None and record.hash is not None and into.hash != record.hash:
            raise self._fail(
                record.line,
                f"step {record.step} has a second hash; of steps that were computed twice, log the last alone",
            )
        if len(into.texts) == 1:
            into.states = dict(into.states)  # what was parsed may be another log's, too
        into.contacts += record.contacts
        into.states.update(record.states)
        into.fields.update(record.fields)
        into.hash = into.hash or record.hash
        into.input = record.input if into.input is None else into.input
        into.time = record.time if into.time is None else into.time
        into.texts += record.texts

    def _placed(self, record: Record) -> Record:
        record.number = self.count
        self.count += 1
        if record.step is not None:
            record.step = self._continued(record.step, record.line)
        if record.time is not None:
            record.clock = self._clocked(record.time, record.line, record.step is None)
        return record

    def _continued(self, step: int, line: int) -> int:
        """A step counted on over restarts."""
        if self._last_step is None:
            self._first_step = step
        else:
            before, counted = self._last_step
            if step > before:
                gap = step - before
                if not self.stride or gap < self.stride:
                    self.stride = gap
                self._last_gap = gap
            elif step <= self._first_step + 1:
                self._step_base = counted + self._last_gap - step
                self.restarts.append((line, before, step))
            else:
                raise self._fail(
                    line,
                    f"step {step} comes after step {before}; sort the log by steps, and of steps that were computed "
                    "twice log the last alone",
                )
        self._last_step = step, step + self._step_base
        return step + self._step_base

    def _clocked(self, time: float, line: int, told: bool) -> float:
        """A time counted on over restarts: a fall back to near the first time of all, not a swap of neighbours."""
        last = self._clock_last
        if self._clock_first is None:
            self._clock_first = time
        elif time < last:
            elapsed = last - self._clock_first
            if self._clock_records >= 5 and time <= self._clock_first + 0.1 * elapsed:
                self._clock_base += last + self._clock_gap - time
                if told:
                    self.restarts.append((line, last, time))
                self._clock_first, self._clock_records = time, 0
                self._clock_last = last = time
        if not self._clock_records:
            self._clock_last = time
        elif time > last:
            self._clock_gap = time - last
            self._clock_last = time
        self._clock_records += 1
        return time + self._clock_base

    def _json(self, number: int, text: str) -> Record | None:
        """What a line of JSON says; None for one that is no event: a header, an outline, the end."""
        sharing = self._misses < USELESS
        value = self.parsed.pop(text, None) if sharing else None
        if value is not None:
            self._misses = 0
        else:
            self._misses += 1
            try:
                value, stop = DECODE(text)
            except (ValueError, RecursionError):
                stop = -1
            if stop != len(text) or type(value) is not dict or not _each_key_once(text, value):
                value = self._loaded(number, text)
                if value is None:
                    return None
            if sharing:
                self._shared += len(text)
                if len(self.parsed) > KEPT or self._shared > MOST_LINE:
                    self.parsed.clear()
                    self._shared = len(text)
                self.parsed[text] = value
        if self.end is not None:
            raise self._fail(number, "comes after the end; leave it out, or put the end last")
        record = Record(number, text)
        for key, item in value.items():
            if key == "time":
                record.time = time = item if type(item) is float else self._number(number, "time", item)
                if time - time != 0.0:
                    raise self._fail(number, f"time = {item}; must be finite")
            elif key == "contacts":
                if type(item) is not list:
                    raise self._fail(number, f"contacts = {str(item)[:SHOWN]}; must be a list of pairs of ids")
                for pair in item:
                    if type(pair) is list and len(pair) == 2 and type(pair[0]) is str and type(pair[1]) is str:
                        record.contacts.append((pair[0], pair[1]))
                    else:
                        record.contacts.append(_pair(self, number, pair))
            elif key == "states":
                record.states = self._states(number, item)
            elif key == "step":
                if isinstance(item, bool) or not isinstance(item, int):
                    raise self._fail(number, f"step = {str(item)[:SHOWN]}; must be a whole number")
                record.step = item
            elif key == "hash":
                record.hash = str(item)
            elif key == "packed":
                record.states = _unpacked(self, number, item)
            elif key in TELLS:
                self._tell(number, value)
                return None
            elif key == "contact":
                record.contacts.append(_pair(self, number, item))
            elif key == "input":
                record.input = item
            else:
                record.fields[key] = item
        if record.step is None and record.time is None:
            if number == 1 and not value.keys() & OWN_KEYS:
                self._take_header(number, value)
                return None
            raise self._fail(number, "has neither a step nor a time; write one of them in every line")
        return record

    def _loaded(self, number: int, text: str) -> dict[str, Any] | None:
        """One object that is not plainly one; None for one that is cut off, which only a last line may be."""
        try:
            value = json.loads(NOT_JSON.sub(_as_json, text), object_pairs_hook=once)
        except KeyError as twice:
            raise self._fail(number, f"has {twice} twice; keep one") from None
        except (ValueError, RecursionError):
            self._damaged = number, text
            return None
        if not isinstance(value, dict):
            raise self._fail(number, f'{text[:SHOWN]!r} is no object, as in {{"step": 1, ...}}')
        return value

    def _tell(self, number: int, value: dict[str, Any]) -> None:
        """Takes a line that is no event: a header, an outline, or the end."""
        if "log" in value:
            self._take_header(number, value)
        elif "outline" in value:
            self._outline(number, value.get("body", ""), value["outline"])
        elif "order" in value:
            order = value["order"]
            if not isinstance(order, list) or not order or not all(isinstance(body, str) for body in order):
                raise self._fail(number, f"order = {str(order)[:SHOWN]}; must be a list of ids")
            self._order = order
        else:
            self.end, self.quiet = self._number(number, "end", value["end"]), bool(value.get("quiet", False))

    def _outline(self, number: int, body: Any, outline: Any) -> None:
        """Takes the shape of a body: one or more of a circle, a polygon and a segment."""
        parts = outline if isinstance(outline, list) else [outline]
        for part in parts:
            if not isinstance(part, dict) or not all(
                _points(part[key], least) for key, least in (("polygon", 1), ("segment", 2)) if key in part
            ) or not ("circle" not in part or (_sized(part["circle"]) and _points([part.get("at", [0, 0])], 1))) or (
                not part.keys() & {"circle", "polygon", "segment"} or not _sized(part.get("radius", 0))
            ):  # fmt: skip
                raise self._fail(
                    number,
                    f"outline of {str(body)[:SHOWN]!r} = {str(part)[:SHOWN]}; must be circle, polygon or segment, as "
                    'in {"circle": 1} or {"polygon": [[0, 0], [1, 0], [0, 1]]}, in finite numbers',
                )
        self.outlines[str(body)] = outline

    def _take_header(self, number: int, value: dict[str, Any]) -> None:
        version = value.get("log", FORMAT)
        if version != FORMAT:
            raise self._fail(number, f"log = {str(version)[:SHOWN]!r}; this version reads {FORMAT!r}")
        names = value.get("fields")
        if names is not None:
            if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
                raise self._fail(number, f"fields = {str(names)[:SHOWN]}; must be a list of names")
            self.names = names
        outlines = value.get("outlines")
        if isinstance(outlines, dict):
            for body, outline in outlines.items():
                self._outline(number, body, outline)
        self.header.update({k: v for k, v in value.items() if k not in ("log", "outlines")})

    def _states(self, number: int, states: Any) -> dict[str, list[float]]:
        if type(states) is not dict:
            raise self._fail(number, f'states = {str(states)[:SHOWN]}; must be numbers by id, as in {{"a": [0, 0]}}')
        rows = states.values()
        if set(map(type, rows)) <= LISTS and set(map(type, chain.from_iterable(rows))) <= FLOATS:
            return states
        found: dict[str, list[float]] = {}
        for body, row in states.items():
            if type(row) is list:
                found[body] = [self._number(number, f"states of {body!r}", v) for v in row]
            elif isinstance(row, dict):
                found[body] = self._named(number, body, row)
            else:
                raise self._fail(number, f"states of {body!r} = {str(row)[:SHOWN]}; must be a list of numbers")
        return found

    def _named(self, number: int, body: str, row: dict[str, Any]) -> list[float]:
        """A state whose numbers have names."""
        if self.names is None:
            self.names = list(row)
        if row.keys() != set(self.names):
            other = sorted(row.keys() ^ set(self.names))[0]
            raise self._fail(number, f"states of {body!r}: {other!r} is not in every state; give all the same names")
        return [self._number(number, f"{name} of {body!r}", row[name]) for name in self.names]

    def _number(self, number: int, what: str, value: Any) -> float:
        if isinstance(value, float):
            return value
        if isinstance(value, int) and not isinstance(value, bool):
            try:
                return float(value)
            except OverflowError:
                return math.inf if value > 0 else -math.inf
        if value is None:
            return math.nan
        if isinstance(value, str):  # a double by its bits, as C's %a writes it
            try:
                return float.fromhex(value)
            except (ValueError, OverflowError):
                pass
        raise self._fail(number, f"{what}: {str(value)[:SHOWN]!r} is no number; write 17 digits, or C's %a in quotes")

    def _hash(self, number: int, text: str) -> Record:
        """A line of a list of hashes: `HASH`, or `STEP HASH`."""
        words = WORDS.split(text)
        if len(words) > 2 or len(text) > 300 or not text.isprintable():
            raise self._fail(
                number, f"{text[:SHOWN]!r} is neither a JSON object nor a hash, nor a step and a hash; is it a log?"
            )
        self._width = self._width or len(words)
        if self._width != len(words):
            raise self._fail(number, f"{text[:SHOWN]!r}: other lines have {self._width} words; is a line damaged?")
        record = Record(number, text)
        try:
            record.step = int(words[0]) if len(words) == 2 else self._hashes
        except ValueError:
            raise self._fail(number, f"{words[0][:SHOWN]!r} is no step; write STEP HASH") from None
        self._hashes += 1
        record.hash = words[-1]
        return record

    def _csv(self, number: int, text: str) -> Record | None:
        """A line of a table with a line of names.

        `time,a,b` and perhaps states, an event a row; or `step` or `time`, `id` and numbers, a body a row; or `step`
        and `hash`; other columns are free.
        """
        if not self._columns:
            self._take_columns(number, text)
            return None
        cells = cells_of(text, f"file {self.name!r}, line {number}")
        if len(cells) != len(self._columns):
            self._damaged = number, text
            return None
        if self.end is not None:
            raise self._fail(number, "comes after the end; leave it out, or put the end last")
        row = dict(zip(self._columns, cells, strict=True))
        record = self._row(number, text, row, self._own)
        if record is None or record.step is not None or "id" not in row:
            return record
        last = self._row_pending
        if last is not None and record.time == last.time:  # a body a row: all of one time are one frame
            last.states.update(record.states)
            last.texts += record.texts
            return None
        self._row_pending = record
        return last

    def _take_columns(self, number: int, head: str) -> None:
        names = [name.strip() for name in head.split(",")]
        known = set(names)
        if len(known) != len(names) or not known & {"step", "time"} or not known - {"step", "time"}:
            raise self._fail(
                number,
                f"{head[:SHOWN]!r} does not name the columns; begin with time,a,b or step,id,x,y,... or step,hash",
            )
        own = {"step", "time", "a", "b", "id", "hash"} | {f"{k}{s}" for k in ("x", "y", "vx", "vy") for s in "ab"}
        if "id" in known:
            own -= {f"{k}{s}" for k in ("x", "y", "vx", "vy") for s in "ab"}
            self.names = [name for name in names if name not in own]
        self._columns, self._own = names, own

    def _row(self, number: int, text: str, row: dict[str, str], own: set[str]) -> Record | None:
        record = Record(number, text)
        if "step" in row:
            try:
                record.step = int(row["step"])
            except ValueError:
                raise self._fail(number, f"step = {row['step'][:SHOWN]!r}; must be a whole number") from None
        if "time" in row:
            record.time = _cell(self, number, row, "time")
        if "a" in row and "b" in row:
            if not row["a"] and not row["b"]:
                self.end = record.time
                return None
            record.contacts.append((row["a"], row["b"]))
            for side in "ab":
                keys = [f"{key}{side}" for key in ("x", "y", "vx", "vy")]
                if all(row.get(key) for key in keys):
                    record.states[row[side]] = [_cell(self, number, row, key) for key in keys]
        if "id" in row:
            record.states[row["id"]] = [_cell(self, number, row, name) for name in self.names or []]
        else:
            for name in row.keys() - own:
                try:
                    record.fields[name] = float(row[name])
                except ValueError:
                    record.fields[name] = row[name]
        record.hash = row.get("hash")
        return record


def _sized(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e300


def _points(value: Any, least: int) -> bool:
    """Whether this is a list of points in the plane."""
    return (
        isinstance(value, list)
        and len(value) >= least
        and all(isinstance(point, list) and len(point) == 2 and all(map(_sized, point)) for point in value)
    )


def _as_json(match: re.Match[str]) -> str:
    return "NaN" if match[2].lower() == "nan" else f"{match[1]}Infinity"


def _each_key_once(text: str, value: dict[str, Any]) -> bool:
    """Whether no key was there twice, which a dictionary does not tell; False also where that is not plain."""
    count = len(value)
    for item in value.values():
        if type(item) is dict:
            count += len(item)
    told = text.count('":')
    return told == count or told == _keys(value)


def _keys(value: Any) -> int:
    """How many keys an object has, with those of all that is in it."""
    if isinstance(value, dict):
        return len(value) + sum(map(_keys, value.values()))
    return sum(map(_keys, value)) if isinstance(value, list) else 0


def _pair(log: Log, number: int, pair: Any) -> tuple[str, str]:
    if type(pair) is list and len(pair) == 2:
        a, b = pair
        if type(a) is str and type(b) is str:
            return a, b
        if isinstance(a, str | int) and isinstance(b, str | int):
            return str(a), str(b)
    raise log._fail(number, f'contact = {str(pair)[:SHOWN]}; must be two ids, as in ["a", "b"]')


def _unpacked(log: Log, number: int, text: Any) -> dict[str, list[float]]:
    """States of all bodies, in their order: doubles in base64."""
    try:
        raw = a2b_base64(text, strict_mode=True) if isinstance(text, str) else b""
    except ValueError:
        raw = b""
    count = 8 * len(log._order)
    if not raw or not count or len(raw) % count:
        raise log._fail(
            number, f"packed = {str(text)[:SHOWN]!r}; must be base64 of as many doubles for each body of an order"
        )
    values, wide = unpack(f"<{len(raw) // 8}d", raw), len(raw) // count
    return {body: list(values[wide * k : wide * (k + 1)]) for k, body in enumerate(log._order)}


def _cell(log: Log, number: int, row: dict[str, str], key: str) -> float:
    try:
        return float(row[key].replace("_", " "))
    except ValueError:
        raise log._fail(number, f"{key} = {row[key][:SHOWN]!r}; must be a number") from None
