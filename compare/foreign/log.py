"""Reads the log of an engine: JSON lines, or CSV, one event a line."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from ..validation import EngineError
from .lines import cells_of, once, text_lines
from .runs.recording import Recording

if TYPE_CHECKING:
    from ...scenarios.scene import Scene

MOST_BYTES = 64 * 1024 * 1024
"""The longest log that is read: half a million events with states."""

MOST_LINE = 1 << 20
"""Characters of one line: the states of 10,000 circles."""

KEYS = frozenset({"time", "contact", "contacts", "states", "end", "quiet"})

BESIDE = frozenset({"step", "hash", "input"})
"""Keys of the log format that a judge has no use for (docs/log-format.md)."""

COLUMNS = ("time", "a", "b")
"""The columns that every CSV log has. A row without a and b is the end."""

STATE_COLUMNS = ("xa", "ya", "vxa", "vya", "xb", "yb", "vxb", "vyb")
"""Columns that it may have: where the event leaves the two. A wall's are empty."""

Numbered: TypeAlias = tuple[int, dict[str, Any]]
"""The number of a line, and what it says, as a line of JSON does."""


def read_log(
    path: str | Path, scene: Scene, name: str | None = None, *, bits: int | None = 53, step: float | None = None
) -> Recording:
    """The recording that a log is: `.csv` files are CSV, all others JSON lines.

    A line of JSON has a `time` and a `contact` of two ids; or `contacts`, several of one instant; perhaps with
    `states`, x, y, vx, vy by circle, as the event leaves them. A line with states alone tells where circles are. The
    last may be an `end`, perhaps with `"quiet": true`: nothing is left to happen. Of the log format of
    `truebreak diff`, headers, outlines, steps, hashes, inputs and free fields are passed over.

    Args:
        name: of the engine, for reports; by default the path.
        bits, step: what the engine declares (see `Recording`).

    Raises:
        EngineError: naming the file, the line, the field and the remedy.
    """
    shown = str(path)
    recording = Recording(scene, name or shown, bits=bits, step=step, parameters={"log": shown})
    ended = told = headed = False
    lines = _csv_lines if shown.lower().endswith(".csv") else _json_lines
    for number, line in lines(Path(path), shown):
        recording.where = where = f"file {shown!r}, line {number}"
        if ended:
            raise EngineError(f"{where}: comes after the end; leave it out, or put the end last")
        if "log" in line or "outline" in line:
            headed = True
            continue
        if headed or line.keys() & BESIDE:
            line = {key: value for key, value in line.items() if key in KEYS}
            if line.keys() <= {"time"}:
                continue  # a hash or an input, or a step in which nothing happened
        ended = _take(recording, line, where)
        told = True
    if not told:
        raise EngineError(f"file {shown!r}: says nothing: no event and no end; was anything recorded?")
    recording.where = f"file {shown!r}"
    if not ended:
        recording.end()
    return recording


def _take(recording: Recording, line: dict[str, Any], where: str) -> bool:
    """Reports one line; whether it was the end."""
    strange = sorted(line.keys() - KEYS)
    if strange:
        raise EngineError(f"{where}: has {strange[0]!r}; a line may have {', '.join(sorted(KEYS))}")
    if "end" in line:
        if not isinstance(quiet := line.get("quiet", False), bool) or line.keys() - {"end", "quiet"}:
            raise EngineError(f'{where}: an end is {{"end": TIME}}, perhaps with "quiet": true, and nothing else')
        recording.end(line["end"], quiet=quiet)
        return True
    if "time" not in line:
        raise EngineError(f"{where}: has no time; write the time of the event, or of the end")
    if "contact" in line and "contacts" in line:
        raise EngineError(f"{where}: has contact and contacts; keep one")
    states = line.get("states")
    if "contact" in line:
        recording.hit(line["time"], *_pair(line["contact"], where), states)
    elif "contacts" in line:
        pairs = line["contacts"]
        if not isinstance(pairs, list) or not pairs:
            raise EngineError(f"{where}: contacts = {str(pairs)[:60]}; must be a list of pairs of ids")
        recording.hits(line["time"], [_pair(pair, where) for pair in pairs], states)
    elif states is not None:
        recording.state(line["time"], states)
    else:
        raise EngineError(f"{where}: has neither a contact nor states; say what happens at that time")
    return False


def _pair(pair: Any, where: str) -> tuple[str, str]:
    if not isinstance(pair, list) or [type(name) for name in pair] != [str, str]:
        raise EngineError(f'{where}: contact = {str(pair)[:60]}; must be two ids, as in ["a", "b"]')
    return pair[0], pair[1]


def _json_lines(path: Path, shown: str) -> Iterator[Numbered]:
    for number, text in text_lines(path, shown, MOST_LINE, MOST_BYTES):
        try:
            line = json.loads(text, object_pairs_hook=once)
        except KeyError as twice:
            raise EngineError(f"file {shown!r}, line {number}: has {twice} twice; keep one") from None
        except (ValueError, RecursionError):
            raise EngineError(
                f"file {shown!r}, line {number}: {text[:60]!r} is not a whole JSON object; was the log cut off?"
            ) from None
        if not isinstance(line, dict):
            raise EngineError(f'file {shown!r}, line {number}: {text[:60]!r} is no object, as in {{"time": 1, ...}}')
        yield number, line


def _csv_lines(path: Path, shown: str) -> Iterator[Numbered]:
    rows = text_lines(path, shown, MOST_LINE, MOST_BYTES)
    number, head = next(rows, (0, ""))
    if number == 0:
        return
    names = [name.strip() for name in head.split(",")]
    if set(names) not in ({*COLUMNS}, {*COLUMNS, *STATE_COLUMNS}) or len(names) != len(set(names)):
        raise EngineError(
            f"file {shown!r}, line {number}: {head[:60]!r} does not name the columns; begin with "
            f"{','.join(COLUMNS)}, perhaps with {','.join(STATE_COLUMNS)}"
        )
    for number, text in rows:
        where = f"file {shown!r}, line {number}"
        cells = cells_of(text, where)
        if len(cells) != len(names):
            raise EngineError(f"{where}: has {len(cells)} cells, and {len(names)} columns; was the log cut off?")
        yield number, _csv_line(dict(zip(names, cells, strict=True)), where)


def _csv_line(row: dict[str, str], where: str) -> dict[str, Any]:
    """A row of CSV as a line of JSON says it."""
    time = _csv_number(row, "time", where)
    if not row["a"] and not row["b"]:
        return {"end": time}
    line: dict[str, Any] = {"time": time, "contact": [row["a"], row["b"]]}
    states = {
        row[name]: [_csv_number(row, f"{key}{name}", where) for key in ("x", "y", "vx", "vy")]
        for name in ("a", "b")
        if any(row.get(f"{key}{name}") for key in ("x", "y", "vx", "vy"))
    }
    return {**line, "states": states} if states else line


def _csv_number(row: dict[str, str], key: str, where: str) -> float:
    try:
        return float(row[key].replace("_", " "))  # no number in a log, though one in Python
    except ValueError:
        raise EngineError(f"{where}: {key} = {row[key][:60]!r}; must be a number") from None
