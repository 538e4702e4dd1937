"""The log of a run, version 1: JSON lines, CSV, or a list of hashes, read one record at a time.

Bodies have any shape, in two or three dimensions; nothing is known of the world but what the log says. The page
docs/log-format.md has every key.
"""

from __future__ import annotations

import csv
import json
import math
import re
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import Any

from ..validation import EngineError

FORMAT = "truebreak/log-1"
"""What the header of a log says under `log`. A log without a header is read all the same."""

MOST_LINE = 1 << 24
"""Bytes of one line: the states of 100,000 bodies."""

SHOWN = 60
"""Characters of a strange line that an error repeats."""

OWN_KEYS = frozenset({"step", "time", "contact", "contacts", "states", "hash", "input", "end", "quiet", "outline"})
"""The keys of a line that have a meaning of their own; all others are free, and compared by name. A first line with
none of them is a header."""

PLAIN = frozenset({float, int})

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
        raw: its text.
    """

    __slots__ = (
        "clock", "contacts", "fields", "hash", "input", "line", "number", "raw", "repeats", "states", "step", "time",
    )  # fmt: skip

    def __init__(self, line: int, raw: str) -> None:
        self.line, self.number, self.raw, self.repeats = line, 0, raw, 0
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

        >>> record = Record(7, "")
        >>> record.step, record.time = 5, 0.25
        >>> record.place()
        'step 5, t = 0.25, line 7'
        """
        named = f"step {self.step}" if self.step is not None else f"event {self.number}"
        at = "" if self.time is None else f", t = {self.time:.9g}"
        return f"{named}{at}, line {self.line}"


class Log:
    """A log that is read from its beginning to its end, once.

    Iterating gives its records. What stands before the first of them is known as soon as that is read.

    Attributes:
        name: its path, as given.
        header: what it says of itself: `engine`, `bits`, `dt`, and free settings.
        names: names of the numbers of a state, where the log says them.
        outlines: shapes by body, as the log has them.
        end: the time at which it says that it ends; None without an `end`.
        cut: number of a last line that is not whole; None if there is none.
        stride: steps between its records, at least; 0 if there are not two.
        beside: a log that is read together with this one: a line that is the same in both is parsed once.
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
        self._last_step: tuple[int, int] | None = None  # as written, as continued
        self.stride = 0
        self._last_gap = 1
        self._first_step = 0
        self._step_base = 0
        self._clock_base = 0.0
        self._clock_first: float | None = None
        self._clock_last = 0.0
        self._clock_gap = 0.0
        self._clock_records = 0
        self.beside: Log | None = None
        self.loaded: tuple[str, dict[str, Any]] = "", {}

    def __iter__(self) -> Iterator[Record]:
        lines = self._lines()
        first = next(lines, None)
        if first is None:
            raise EngineError(f"file {self.name!r}: is empty; was anything recorded?")
        lines = chain([first], lines)
        if self.name.lower().endswith(".csv"):
            parsed = self._csv(lines)
        elif first[1].lstrip().startswith("{"):
            parsed = self._json(lines)
        else:
            parsed = self._hashes(lines)
        yield from self._grouped(parsed)
        if self.count == 0 and self.end is None:
            raise EngineError(f"file {self.name!r}: has no event, state or hash in it; was anything recorded?")

    def _fail(self, line: int, message: str) -> EngineError:
        return EngineError(f"file {self.name!r}, line {line}: {message}")

    def _lines(self) -> Iterator[tuple[int, str]]:
        """The lines that are not empty, with their numbers."""
        try:
            with Path(self.name).open("rb") as file:
                for number, raw in enumerate(iter(lambda: file.readline(MOST_LINE + 1), b""), 1):
                    if len(raw) > MOST_LINE:
                        raise self._fail(number, f"is longer than {MOST_LINE:,} bytes; is it a log?")
                    text = raw.decode("utf-8").removeprefix("\ufeff" if number == 1 else "").strip()
                    if text:
                        yield number, text
        except UnicodeDecodeError:
            raise EngineError(f"file {self.name!r}: is not text in UTF-8; is it a log?") from None
        except OSError as error:
            raise EngineError(f"file {self.name!r}: {error.strerror or error}; name a log that can be read") from None

    def _grouped(self, parsed: Iterator[Record]) -> Iterator[Record]:
        """Records with their places, the lines of one step put together."""
        current: Record | None = None
        last = ""
        for record in parsed:
            if current is not None and record.step is not None and record.step == current.step:
                self._merge(current, record, record.raw == last)
                last = record.raw
                continue
            if record.step is None:
                yield self._placed(record)
                continue
            if current is not None:
                yield self._placed(current)
            current, last = record, record.raw
        if current is not None:
            yield self._placed(current)

    def _merge(self, into: Record, record: Record, repeated: bool) -> None:
        if repeated:
            into.repeats += 1
            return
        if into.hash is not None and record.hash is not None and into.hash != record.hash:
            raise self._fail(
                record.line,
                f"step {record.step} has a second hash; of steps that were computed twice, log the last alone",
            )
        into.contacts += record.contacts
        into.states.update(record.states)
        into.fields.update(record.fields)
        into.hash = into.hash or record.hash
        into.input = record.input if into.input is None else into.input
        into.time = record.time if into.time is None else into.time
        into.raw = f"{into.raw}\n{record.raw}"

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
                self.stride = min(self.stride or step - before, step - before)
                self._last_gap = step - before
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
        if self._clock_first is None:
            self._clock_first = time
        elif time < self._clock_last:
            elapsed = self._clock_last - self._clock_first
            if self._clock_records >= 5 and time <= self._clock_first + 0.1 * elapsed:
                self._clock_base += self._clock_last + self._clock_gap - time
                if told:
                    self.restarts.append((line, self._clock_last, time))
                self._clock_first, self._clock_records = time, 0
                self._clock_last = time
        if time > self._clock_last and self._clock_records:
            self._clock_gap = time - self._clock_last
        self._clock_last = max(self._clock_last, time) if self._clock_records else time
        self._clock_records += 1
        return time + self._clock_base

    def _json(self, lines: Iterator[tuple[int, str]]) -> Iterator[Record]:
        """Records of JSON lines; a last line that is not whole is where the log was cut off."""
        waiting: tuple[int, str] | None = None
        for number, text in chain(lines, [(0, "")]):
            if waiting is not None:
                beside = self.beside
                if beside is not None and beside.loaded[0] == waiting[1]:
                    value = beside.loaded[1]
                else:
                    value = self._loaded(*waiting, last=number == 0)
                    if value is None:
                        return
                self.loaded = waiting[1], value
                record = self._record(waiting[0], waiting[1], value)
                if record is not None:
                    yield record
            waiting = number, text

    def _loaded(self, number: int, text: str, last: bool) -> dict[str, Any] | None:
        """One object; None for a last line that is cut off."""
        try:
            value = json.loads(text)
        except (ValueError, RecursionError):
            try:
                value = json.loads(NOT_JSON.sub(_as_json, text))
            except (ValueError, RecursionError):
                if last and text.startswith("{"):
                    self.cut = number
                    return None
                raise self._fail(
                    number, f"{text[:SHOWN]!r} is not a whole JSON object; is a line of the log damaged?"
                ) from None
        if not isinstance(value, dict):
            raise self._fail(number, f'{text[:SHOWN]!r} is no object, as in {{"step": 1, ...}}')
        if text.count('":') != _keys(value):
            try:
                json.loads(NOT_JSON.sub(_as_json, text), object_pairs_hook=_once)
            except KeyError as twice:
                raise self._fail(number, f"has {twice} twice; keep one") from None
        return value

    def _record(self, number: int, text: str, value: dict[str, Any]) -> Record | None:
        """What a line says; None for one that is no event: a header, an outline, the end."""
        if self.end is not None:
            raise self._fail(number, "comes after the end; leave it out, or put the end last")
        if "log" in value or (number == 1 and not value.keys() & OWN_KEYS):
            self._take_header(number, value)
            return None
        if "outline" in value:
            self.outlines[str(value.get("body", ""))] = value["outline"]
            return None
        if "end" in value:
            self.end, self.quiet = self._number(number, "end", value["end"]), bool(value.get("quiet", False))
            return None
        record = Record(number, text)
        for key, item in value.items():
            if key == "time":
                record.time = time = item if type(item) is float else self._number(number, "time", item)
                if time - time != 0.0:
                    raise self._fail(number, f"time = {item}; must be finite")
            elif key == "contact":
                record.contacts.append(self._pair(number, item))
            elif key == "states":
                record.states = self._states(number, item)
            elif key == "step":
                if isinstance(item, bool) or not isinstance(item, int):
                    raise self._fail(number, f"step = {str(item)[:SHOWN]}; must be a whole number")
                record.step = item
            elif key == "contacts":
                if not isinstance(item, list):
                    raise self._fail(number, f"contacts = {str(item)[:SHOWN]}; must be a list of pairs of ids")
                record.contacts += [self._pair(number, pair) for pair in item]
            elif key == "hash":
                record.hash = str(item)
            elif key == "input":
                record.input = item
            else:
                record.fields[key] = item
        if record.step is None and record.time is None:
            raise self._fail(number, "has neither a step nor a time; write one of them in every line")
        return record

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
            self.outlines.update(outlines)
        self.header.update({k: v for k, v in value.items() if k not in ("log", "outlines")})

    def _pair(self, number: int, pair: Any) -> tuple[str, str]:
        if type(pair) is list and len(pair) == 2:
            a, b = pair
            if type(a) is str and type(b) is str:
                return a, b
            if isinstance(a, str | int) and isinstance(b, str | int):
                return str(a), str(b)
        raise self._fail(number, f'contact = {str(pair)[:SHOWN]}; must be two ids, as in ["a", "b"]')

    def _states(self, number: int, states: Any) -> dict[str, list[float]]:
        if not isinstance(states, dict):
            raise self._fail(number, f'states = {str(states)[:SHOWN]}; must be numbers by id, as in {{"a": [0, 0]}}')
        found: dict[str, list[float]] = {}
        for body, row in states.items():
            if type(row) is list:
                if set(map(type, row)) <= PLAIN:
                    found[body] = row
                else:
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

    def _hashes(self, lines: Iterator[tuple[int, str]]) -> Iterator[Record]:
        """Records of a list of hashes: `HASH`, or `STEP HASH`, a line."""
        width: int | None = None
        for hashes, (number, text) in enumerate(lines):
            words = re.split(r"[\s,;:=]+", text)
            if len(words) > 2 or len(text) > 300 or not text.isprintable():
                raise self._fail(
                    number, f"{text[:SHOWN]!r} is neither a JSON object nor a hash, nor a step and a hash; is it a log?"
                )
            if width not in (None, len(words)):
                raise self._fail(number, f"{text[:SHOWN]!r}: other lines have {width} words; is a line damaged?")
            width = len(words)
            record = Record(number, text)
            try:
                record.step = int(words[0]) if width == 2 else hashes
            except ValueError:
                raise self._fail(number, f"{words[0][:SHOWN]!r} is no step; write STEP HASH") from None
            record.hash = words[-1]
            yield record

    def _csv(self, lines: Iterator[tuple[int, str]]) -> Iterator[Record]:
        """Records of a table with a line of names.

        `time,a,b` and perhaps states, an event a row; or `step` or `time`, `id` and numbers, a body a row; or `step`
        and `hash`; other columns are free.
        """
        number, head = next(lines)
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
        last: Record | None = None
        for number, text in lines:
            cells = [cell.strip() for cell in next(csv.reader([text]))]
            if len(cells) != len(names):
                following = next(lines, None)
                if following is None:
                    self.cut = number
                    break
                raise self._fail(number, f"has {len(cells)} cells, and {len(names)} columns; is a line damaged?")
            row = dict(zip(names, cells, strict=True))
            record = self._row(number, text, row, own)
            if record is None:
                continue
            if last is not None and record.step is None and "id" in row and record.time == last.time:
                last.states.update(record.states)  # a body a row: all of one time are one frame
                last.raw = f"{last.raw}\n{record.raw}"
                continue
            if last is not None:
                yield last
            last = record
        if last is not None:
            yield last

    def _row(self, number: int, text: str, row: dict[str, str], own: set[str]) -> Record | None:
        record = Record(number, text)
        if "step" in row:
            try:
                record.step = int(row["step"])
            except ValueError:
                raise self._fail(number, f"step = {row['step'][:SHOWN]!r}; must be a whole number") from None
        if "time" in row:
            record.time = self._cell(number, row, "time")
        if "a" in row and "b" in row:
            if not row["a"] and not row["b"]:
                self.end = record.time
                return None
            record.contacts.append((row["a"], row["b"]))
            for side in "ab":
                keys = [f"{key}{side}" for key in ("x", "y", "vx", "vy")]
                if all(row.get(key) for key in keys):
                    record.states[row[side]] = [self._cell(number, row, key) for key in keys]
        if "id" in row:
            record.states[row["id"]] = [self._cell(number, row, name) for name in self.names or []]
        else:
            for name in row.keys() - own:
                try:
                    record.fields[name] = float(row[name])
                except ValueError:
                    record.fields[name] = row[name]
        record.hash = row.get("hash")
        return record

    def _cell(self, number: int, row: dict[str, str], key: str) -> float:
        try:
            return float(row[key].replace("_", " "))
        except ValueError:
            raise self._fail(number, f"{key} = {row[key][:SHOWN]!r}; must be a number") from None


def _as_json(match: re.Match[str]) -> str:
    return "NaN" if match[2].lower() == "nan" else f"{match[1]}Infinity"


def _keys(value: dict[str, Any]) -> int:
    """How many keys an object has, with those of the objects in it; what lies deeper is looked at once more."""
    count = len(value)
    for item in value.values():
        if type(item) is dict:
            count += len(item)
    return count


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """An object each key of which is there once.

    Raises:
        KeyError: for one that is there again.
    """
    found: dict[str, Any] = {}
    for key, value in pairs:
        if key in found:
            raise KeyError(key[:SHOWN])
        found[key] = value
    return found
