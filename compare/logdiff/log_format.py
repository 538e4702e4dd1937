"""The log of a run, version 1: JSON lines, CSV, or a list of hashes, read one record at a time.

Bodies have any shape, in two or three dimensions; nothing is known of the world but what the log says. The page
docs/log-format.md has every key.
"""

from __future__ import annotations

import json
import math
import re
from binascii import a2b_base64
from collections.abc import Iterator
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


DECODE: Any = json.JSONDecoder(parse_int=_whole).scan_once  # pyright: ignore[reportAttributeAccessIssue]

WORDS = re.compile(r"[\s,;:=]+")

NOT_JSON = re.compile(r"(?<=[\[,:\s])(-?)(nan|inf|infinity)(?:\([^)]*\))?(?=[\],}\s])", re.IGNORECASE)
"""What printf writes for a number that is none."""


class LogRecord:
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

    def place(self) -> str:
        """Where it is, for a person: its step or number, its time and its line.

        >>> record = LogRecord(7, "")
        >>> record.step, record.time = 5, 0.25
        >>> record.place()
        'step 5, t = 0.25, line 7'
        """
        named = f"step {self.step}" if self.step is not None else f"event {self.number}"
        at = "" if self.time is None else f", t = {self.time:.9g}"
        return f"{named}{at}, line {self.line}"


class Log:
    """A log that is read once, from its beginning to its end; iterating gives its records.

    Attributes:
        name: its path, as given.
        header: what it says of itself: `engine`, `bits`, `dt`, and free settings.
        names: names of the numbers of a state, where the log says them.
        outlines: shapes by body, as the log has them.
        order: bodies in the order in which their states are packed.
        end: the time at which it says that it ends; None without an `end`.
        cut: number of a last line that is not whole; None if there is none.
        count: how many records there have been.
        counted: steps and times, counted on where they begin anew.
        parsed: lines that another log, read beside this one, has had lately: what is in both is parsed once.

    Raises:
        EngineError: naming the file, the line and the remedy.
    """

    def __init__(self, path: str | Path) -> None:
        self.name = str(path)
        self.header: dict[str, Any] = {}
        self.names: list[str] | None = None
        self.outlines: dict[str, Any] = {}
        self.order: list[str] = []
        self.end: float | None = None
        self.cut: int | None = None
        self.count = 0
        self.counted = RunningCount(self)
        self.parsed = Parsed()

    def __iter__(self) -> Iterator[LogRecord]:
        form: _Form | None = None
        step: LogRecord | None = None  # a step that may have further lines
        last = ""
        for number, text in text_lines(Path(self.name), self.name, MOST_LINE):
            if form is None:
                csv = self.name.lower().endswith(".csv")
                form = _Table(self) if csv else _Json(self) if text[0] == "{" else _Hashes(self)
            elif form.damaged is not None:
                raise form.damage()
            if self.end is not None:
                raise self.fail(number, "comes after the end; leave it out, or put the end last")
            record = form.record(number, text)
            if record is None:
                continue
            if record.step is None:
                yield self._placed(record)
            elif step is not None and record.step == step.step:
                self._merge(step, record, text == last)
                last = text
            else:
                if step is not None:
                    yield self._placed(step)
                step, last = record, text
        if form is None:
            raise EngineError(f"file {self.name!r}: is empty; was anything recorded?")
        if form.damaged is not None:
            self.cut = form.damaged[0]
            if not form.cut_off():
                raise form.damage()
        for record in (form.left, step):
            if record is not None:
                yield self._placed(record)
        if self.count == 0 and self.end is None:
            raise EngineError(f"file {self.name!r}: has no event, state or hash in it; was anything recorded?")

    def fail(self, line: int, message: str) -> EngineError:
        """An error in one line."""
        return EngineError(f"file {self.name!r}, line {line}: {message}")

    def _merge(self, into: LogRecord, record: LogRecord, repeated: bool) -> None:
        """One more line of a step."""
        if repeated:
            into.repeats += 1
            return
        if into.hash is not None and record.hash is not None and into.hash != record.hash:
            raise self.fail(
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

    def _placed(self, record: LogRecord) -> LogRecord:
        record.number = self.count
        self.count += 1
        if record.step is not None:
            record.step = self.counted.step(record.step, record.line)
        if record.time is not None:
            record.clock = self.counted.time(record.time, record.line, record.step is None)
        return record

    def tell(self, number: int, value: dict[str, Any]) -> None:
        """Takes a line that is no event: a header, an outline, an order, or the end."""
        if "log" in value:
            self.take_header(number, value)
        elif "outline" in value:
            self._outline(number, value.get("body", ""), value["outline"])
        elif "order" in value:
            order = value["order"]
            if not isinstance(order, list) or not order or not all(isinstance(body, str) for body in order):
                raise self.fail(number, f"order = {str(order)[:SHOWN]}; must be a list of ids")
            self.order = order
        else:
            self.end = self.number(number, "end", value["end"])

    def take_header(self, number: int, value: dict[str, Any]) -> None:
        """Takes what the log says of itself."""
        version = value.get("log", FORMAT)
        if version != FORMAT:
            raise self.fail(number, f"log = {str(version)[:SHOWN]!r}; this version reads {FORMAT!r}")
        names = value.get("fields")
        if names is not None:
            if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
                raise self.fail(number, f"fields = {str(names)[:SHOWN]}; must be a list of names")
            self.names = names
        outlines = value.get("outlines")
        if isinstance(outlines, dict):
            for body, outline in outlines.items():
                self._outline(number, body, outline)
        self.header.update({k: v for k, v in value.items() if k not in ("log", "outlines")})

    def _outline(self, number: int, body: Any, outline: Any) -> None:
        """Takes the shape of a body: one or more of a circle, a polygon and a segment."""
        for part in outline if isinstance(outline, list) else [outline]:
            if not _is_shape(part):
                raise self.fail(
                    number,
                    f"outline of {str(body)[:SHOWN]!r} = {str(part)[:SHOWN]}; must be circle, polygon or segment, as "
                    'in {"circle": 1} or {"polygon": [[0, 0], [1, 0], [0, 1]]}, in finite numbers',
                )
        self.outlines[str(body)] = outline

    def number(self, line: int, what: str, value: Any) -> float:
        """A number of a log: also none at all, or a double by its bits, as C's %a writes it."""
        if isinstance(value, float):
            return value
        if isinstance(value, int) and not isinstance(value, bool):
            try:
                return float(value)
            except OverflowError:
                return math.inf if value > 0 else -math.inf
        if value is None:
            return math.nan
        if isinstance(value, str):
            try:
                return float.fromhex(value)
            except (ValueError, OverflowError):
                pass
        raise self.fail(line, f"{what}: {str(value)[:SHOWN]!r} is no number; write 17 digits, or C's %a in quotes")


class RunningCount:
    """Steps and times of a log, counted on where they begin anew.

    Attributes:
        stride: steps between records, at least; 0 if there are not two.
        restarts: (line, from, to) for each time that the clock, or the count of steps, begins anew.
    """

    def __init__(self, log: Log) -> None:
        self._log = log
        self.stride = 0
        self.restarts: list[tuple[int, float, float]] = []
        self._last_step: tuple[int, int] | None = None  # as written, as counted on
        self._first_step = self._step_base = 0
        self._last_gap = 1
        self._first_time: float | None = None
        self._last_time = self._time_base = self._time_gap = 0.0
        self._times = 0

    def step(self, step: int, line: int) -> int:
        """A step counted on."""
        if self._last_step is None:
            self._first_step = step
        else:
            before, counted = self._last_step
            if step > before:
                self._last_gap = step - before
                self.stride = min(self.stride or self._last_gap, self._last_gap)
            elif step <= self._first_step + 1:
                self._step_base = counted + self._last_gap - step
                self.restarts.append((line, before, step))
            else:
                raise self._log.fail(
                    line,
                    f"step {step} comes after step {before}; sort the log by steps, and of steps that were computed "
                    "twice log the last alone",
                )
        self._last_step = step, step + self._step_base
        return step + self._step_base

    def time(self, time: float, line: int, reported: bool) -> float:
        """A time counted on: a fall back to near the first time of all is a restart, not a swap of neighbours."""
        last = self._last_time
        if self._first_time is None:
            self._first_time = time
        elif time < last:
            elapsed = last - self._first_time
            if self._times >= 5 and time <= self._first_time + 0.1 * elapsed:
                self._time_base += last + self._time_gap - time
                if reported:
                    self.restarts.append((line, last, time))
                self._first_time, self._times = time, 0
                self._last_time = last = time
        if not self._times:
            self._last_time = time
        elif time > last:
            self._time_gap = time - last
            self._last_time = time
        self._times += 1
        return time + self._time_base


class _Form:
    """What the lines of a log look like.

    Attributes:
        damaged: a line that is not whole, with its number: the last of a log may be cut off.
        left: a record that only the end of the log makes whole.
    """

    def __init__(self, log: Log) -> None:
        self.log = log
        self.damaged: tuple[int, str] | None = None
        self.left: LogRecord | None = None

    def record(self, number: int, text: str) -> LogRecord | None:
        """The record that a line makes, if it makes one."""
        raise NotImplementedError

    def damage(self) -> EngineError:
        """What is wrong with the damaged line, where it is not the last."""
        raise NotImplementedError

    def cut_off(self) -> bool:
        """Whether the damaged line is the beginning of a whole one."""
        return True


class Parsed:
    """Lines that one of two logs had lately: what is in both is parsed once.

    Attributes:
        lines: what they say.
        letters: how long they are.
        misses: lines in a row that the other log had not lately.
    """

    def __init__(self) -> None:
        self.lines: dict[str, dict[str, Any]] = {}
        self.letters = self.misses = 0

    def keep(self, text: str, value: dict[str, Any]) -> None:
        """Keeps one for the other log."""
        self.letters += len(text)
        if len(self.lines) > KEPT or self.letters > MOST_LINE:
            self.lines.clear()
            self.letters = len(text)
        self.lines[text] = value


class _Json(_Form):
    """Objects of JSON, one a line."""

    def record(self, number: int, text: str) -> LogRecord | None:
        """What a line says; None for one that is no event: a header, an outline, the end."""
        log = self.log
        value = self._parsed(number, text)
        if value is None:
            return None
        record = LogRecord(number, text)
        for key, item in value.items():
            if key == "time":
                record.time = time = item if type(item) is float else log.number(number, "time", item)
                if time - time != 0.0:
                    raise log.fail(number, f"time = {item}; must be finite")
            elif key == "contacts":
                if type(item) is not list:
                    raise log.fail(number, f"contacts = {str(item)[:SHOWN]}; must be a list of pairs of ids")
                for pair in item:
                    if type(pair) is list and len(pair) == 2 and type(pair[0]) is str and type(pair[1]) is str:
                        record.contacts.append((pair[0], pair[1]))
                    else:
                        record.contacts.append(_pair(log, number, pair))
            elif key == "states":
                record.states = _states(log, number, item)
            elif key == "step":
                if isinstance(item, bool) or not isinstance(item, int):
                    raise log.fail(number, f"step = {str(item)[:SHOWN]}; must be a whole number")
                record.step = item
            elif key == "hash":
                record.hash = str(item)
            elif key == "packed":
                record.states = _unpacked(log, number, item)
            elif key in TELLS:
                log.tell(number, value)
                return None
            elif key == "contact":
                record.contacts.append(_pair(log, number, item))
            elif key == "input":
                record.input = item
            else:
                record.fields[key] = item
        if record.step is None and record.time is None:
            if number == 1 and not value.keys() & OWN_KEYS:
                log.take_header(number, value)
                return None
            raise log.fail(number, "has neither a step nor a time; write one of them in every line")
        return record

    def _parsed(self, number: int, text: str) -> dict[str, Any] | None:
        """The object of a line, parsed once for both logs; None where it is not whole."""
        kept = self.log.parsed
        if kept.misses < USELESS:
            value = kept.lines.pop(text, None)
            if value is not None:
                kept.misses = 0
                return value
            kept.misses += 1
        try:
            value, stop = DECODE(text, 0)
        except (StopIteration, ValueError, RecursionError):
            value, stop = None, -1
        if stop != len(text) or type(value) is not dict or not _each_key_once(text, value):
            value = self._loaded(number, text)
        if value is not None and kept.misses < USELESS:
            kept.keep(text, value)
        return value

    def _loaded(self, number: int, text: str) -> dict[str, Any] | None:
        """One object that is not plainly one; None for one that is cut off, which only a last line may be."""
        try:
            value = json.loads(NOT_JSON.sub(_as_json, text), object_pairs_hook=once)
        except KeyError as twice:
            raise self.log.fail(number, f"has {twice} twice; keep one") from None
        except (ValueError, RecursionError):
            self.damaged = number, text
            return None
        if not isinstance(value, dict):
            raise self.log.fail(number, f'{text[:SHOWN]!r} is no object, as in {{"step": 1, ...}}')
        return value

    def damage(self) -> EngineError:
        assert self.damaged is not None
        number, text = self.damaged
        return self.log.fail(number, f"{text[:SHOWN]!r} is not a whole JSON object; is a line of the log damaged?")

    def cut_off(self) -> bool:
        return self.damaged is not None and self.damaged[1].startswith("{")


class _Hashes(_Form):
    """A list of hashes: `HASH`, or `STEP HASH`, a line."""

    def __init__(self, log: Log) -> None:
        super().__init__(log)
        self._count = self._width = 0

    def record(self, number: int, text: str) -> LogRecord:
        words = WORDS.split(text)
        if len(words) > 2 or len(text) > 300 or not text.isprintable():
            raise self.log.fail(
                number, f"{text[:SHOWN]!r} is neither a JSON object nor a hash, nor a step and a hash; is it a log?"
            )
        self._width = self._width or len(words)
        if self._width != len(words):
            raise self.log.fail(number, f"{text[:SHOWN]!r}: other lines have {self._width} words; is a line damaged?")
        record = LogRecord(number, text)
        try:
            record.step = int(words[0]) if len(words) == 2 else self._count
        except ValueError:
            raise self.log.fail(number, f"{words[0][:SHOWN]!r} is no step; write STEP HASH") from None
        self._count += 1
        record.hash = words[-1]
        return record


class _Table(_Form):
    """CSV with a line of names.

    `time,a,b` and perhaps states, an event a row; or `step` or `time`, `id` and numbers, a body a row; or `step` and
    `hash`; other columns are free.
    """

    def __init__(self, log: Log) -> None:
        super().__init__(log)  # `left`: a frame that may have further rows
        self._columns: list[str] = []
        self._free: list[str] = []

    def record(self, number: int, text: str) -> LogRecord | None:
        if not self._columns:
            self._take_columns(number, text)
            return None
        cells = cells_of(text, f"file {self.log.name!r}, line {number}")
        if len(cells) != len(self._columns):
            self.damaged = number, text
            return None
        row = dict(zip(self._columns, cells, strict=True))
        record = self._row(number, text, row)
        if record is None or record.step is not None or "id" not in row:
            return record
        last = self.left
        if last is not None and record.time == last.time:  # a body a row: all of one time are one frame
            last.states.update(record.states)
            last.texts += record.texts
            return None
        self.left = record
        return last

    def _take_columns(self, number: int, head: str) -> None:
        names = [name.strip() for name in head.split(",")]
        known = set(names)
        if len(known) != len(names) or not known & {"step", "time"} or not known - {"step", "time"}:
            raise self.log.fail(
                number,
                f"{head[:SHOWN]!r} does not name the columns; begin with time,a,b or step,id,x,y,... or step,hash",
            )
        rest = [name for name in names if name not in ("step", "time", "a", "b", "id", "hash")]
        if "id" in known:
            self.log.names = rest
        else:
            self._free = [name for name in rest if name not in SIDES]
        self._columns = names

    def _row(self, number: int, text: str, row: dict[str, str]) -> LogRecord | None:
        log, record = self.log, LogRecord(number, text)
        if "step" in row:
            try:
                record.step = int(row["step"])
            except ValueError:
                raise log.fail(number, f"step = {row['step'][:SHOWN]!r}; must be a whole number") from None
        if "time" in row:
            record.time = _cell(log, number, row, "time")
        if "a" in row and "b" in row:
            if not row["a"] and not row["b"]:
                log.end = record.time
                return None
            record.contacts.append((row["a"], row["b"]))
            for side in "ab":
                keys = [f"{key}{side}" for key in ("x", "y", "vx", "vy")]
                if all(row.get(key) for key in keys):
                    record.states[row[side]] = [_cell(log, number, row, key) for key in keys]
        if "id" in row:
            record.states[row["id"]] = [_cell(log, number, row, name) for name in log.names or []]
        for name in self._free:
            try:
                record.fields[name] = float(row[name])
            except ValueError:
                record.fields[name] = row[name]
        record.hash = row.get("hash")
        return record

    def damage(self) -> EngineError:
        assert self.damaged is not None
        number, text = self.damaged
        cells = len(cells_of(text, self.log.name))
        return self.log.fail(number, f"has {cells} cells, and {len(self._columns)} columns; is a line damaged?")


SIDES = frozenset(f"{key}{side}" for key in ("x", "y", "vx", "vy") for side in "ab")
"""Columns of the states that an event leaves."""


def _states(log: Log, number: int, states: Any) -> dict[str, list[float]]:
    """States by body: lists of numbers, or objects with their names."""
    if type(states) is not dict:
        raise log.fail(number, f'states = {str(states)[:SHOWN]}; must be numbers by id, as in {{"a": [0, 0]}}')
    rows = states.values()
    if set(map(type, rows)) <= LISTS and set(map(type, chain.from_iterable(rows))) <= FLOATS:
        return states
    found: dict[str, list[float]] = {}
    for body, row in states.items():
        if type(row) is list:
            found[body] = [log.number(number, f"states of {body!r}", v) for v in row]
        elif isinstance(row, dict):
            if log.names is None:
                log.names = list(row)
            if row.keys() != set(log.names):
                other = sorted(row.keys() ^ set(log.names))[0]
                raise log.fail(number, f"states of {body!r}: {other!r} is not in every state; give all the same names")
            found[body] = [log.number(number, f"{name} of {body!r}", row[name]) for name in log.names]
        else:
            raise log.fail(number, f"states of {body!r} = {str(row)[:SHOWN]}; must be a list of numbers")
    return found


def _is_shape(part: Any) -> bool:
    """Whether this is a circle, a polygon or a segment, in finite numbers."""
    return (
        isinstance(part, dict)
        and bool(part.keys() & {"circle", "polygon", "segment"})
        and _sized(part.get("radius", 0))
        and ("circle" not in part or (_sized(part["circle"]) and _points([part.get("at", [0, 0])], 1)))
        and ("polygon" not in part or _points(part["polygon"], 1))
        and ("segment" not in part or _points(part["segment"], 2))
    )


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
    raise log.fail(number, f'contact = {str(pair)[:SHOWN]}; must be two ids, as in ["a", "b"]')


def _unpacked(log: Log, number: int, text: Any) -> dict[str, list[float]]:
    """States of all bodies, in their order: doubles in base64."""
    try:
        raw = a2b_base64(text, strict_mode=True) if isinstance(text, str) else b""
    except ValueError:
        raw = b""
    count = 8 * len(log.order)
    if not raw or not count or len(raw) % count:
        raise log.fail(
            number, f"packed = {str(text)[:SHOWN]!r}; must be base64 of as many doubles for each body of an order"
        )
    values, wide = unpack(f"<{len(raw) // 8}d", raw), len(raw) // count
    return {body: list(values[wide * k : wide * (k + 1)]) for k, body in enumerate(log.order)}


def _cell(log: Log, number: int, row: dict[str, str], key: str) -> float:
    try:
        return float(row[key].replace("_", " "))
    except ValueError:
        raise log.fail(number, f"{key} = {row[key][:SHOWN]!r}; must be a number") from None
