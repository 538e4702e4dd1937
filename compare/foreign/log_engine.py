"""The log of an engine, read line by line, and in the place of an engine."""

from __future__ import annotations

import csv
import json
import math
import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from ...scenarios.engine import ALL_KEYS, Unchangeable, horizon
from ...scenarios.errors import SceneError
from ...scenarios.trajectory import StopReason, Trajectory
from ..validation import EngineError
from .recording import Recording

if TYPE_CHECKING:
    from ...scenarios.numbers.quantity import QuantityLike
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import OnProgress

MARK = "\ufeff"
"""The mark of byte order that some editors write first; it is none of the text."""


def text_lines(path: Path, shown: str, most: int, whole: int | None = None) -> Iterator[tuple[int, str]]:
    """The lines of a file that are not empty, without the space around them, with their numbers.

    Args:
        shown: what the file is called.
        most, whole: bytes of one line, and of all, beyond which it is refused.

    Raises:
        EngineError: naming the file and the line.
    """
    long = f"the log is longer than {whole or 0:,} bytes; judge its beginning, or leave out states"
    try:
        with path.open("rb") as file:
            if whole is not None and os.fstat(file.fileno()).st_size > whole:
                raise EngineError(f"file {shown!r}: {long}")
            number, read = 1, 0
            while raw := file.readline(most + 1):
                read += len(raw)
                if len(raw) > most:
                    raise EngineError(f"file {shown!r}, line {number}: is longer than {most:,} bytes; is it a log?")
                if whole is not None and read > whole:  # of a pipe, whose length is not known before
                    raise EngineError(f"file {shown!r}, line {number}: {long}")
                text = raw.decode("utf-8").strip()
                if number == 1:
                    text = text.removeprefix(MARK).strip()
                if text:
                    yield number, text
                number += 1
    except UnicodeDecodeError:
        raise EngineError(f"file {shown!r}: is not text in UTF-8; is it a log?") from None
    except OSError as error:
        raise EngineError(f"file {shown!r}: {error.strerror or error}; name a log that can be read") from None


def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """An object of JSON, each key of which is there once.

    Raises:
        KeyError: for one that is there again.

    >>> once([("a", 1), ("b", 2)])
    {'a': 1, 'b': 2}
    """
    found: dict[str, Any] = {}
    for key, value in pairs:
        if key in found:
            raise KeyError(key[:60])
        found[key] = value
    return found


def cells_of(text: str, where: str) -> list[str]:
    """The cells of a row of CSV.

    Raises:
        EngineError: for a row that is none.

    >>> cells_of('1, 0.5,"a,b"', "line 2")
    ['1', '0.5', 'a,b']
    """
    try:
        return [cell.strip() for cell in next(csv.reader([text]))]
    except csv.Error as error:
        raise EngineError(f"{where}: {text[:60]!r} is no row of CSV: {error}") from None


# ----------------------------------------
# Reads the log of an engine: JSON lines, or CSV, one event a line.

MOST_BYTES = 64 * 1024 * 1024
"""The longest log that is read: half a million events with states."""

MOST_LINE = 1 << 20
"""Characters of one line: the states of 10,000 circles."""

KEYS = frozenset({"time", "contact", "contacts", "states", "carried", "end", "quiet"})

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
    `states`, x, y, vx, vy by circle, as the event leaves them, and with `carried`, the wall by circle of those that
    walls carry from then on. A line that has only states says where circles are. The last may be an `end`, perhaps with
    `"quiet": true`: nothing is left to happen. Headers, outlines, steps, hashes, inputs and free fields
    of the log format of `truebreak diff` are passed over.

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
    states, carried = line.get("states"), line.get("carried")
    if "carried" in line and carried is None:
        raise EngineError(f'{where}: carried = None; must be walls by the ids of circles, as in {{"a": "floor"}}')
    if "contact" in line:
        recording.hit(line["time"], *_pair(line["contact"], where), states, carried)
    elif "contacts" in line:
        pairs = line["contacts"]
        if not isinstance(pairs, list) or not pairs:
            raise EngineError(f"{where}: contacts = {str(pairs)[:60]}; must be a list of pairs of ids")
        recording.hits(line["time"], [_pair(pair, where) for pair in pairs], states, carried)
    elif states is not None or carried is not None:
        recording.state(line["time"], states or {}, carried)
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


# ----------------------------------------
# A log in the place of an engine: it runs the one scene of which it is, as far as it goes.


SHORT = 1024
"""Whole parts of 1: what has no more to it tells nothing of bits."""

MANY_STEPS, MOST_STEPS, SAME_STEP = 12, 100_000, 1e-9
"""So many equal steps are no chance; how many may be a unit of time; by what share of the time they may differ."""


FEW_DIGITS = 14
"""Digits up to which numbers are of a text that does not have all of a double's."""


def _digits(number: float) -> int:
    """How many decimal digits a double has in the shortest text that is read as it.

    >>> _digits(0.1), _digits(-12.25), _digits(1e300)
    (1, 4, 1)
    """
    return max(1, len(repr(abs(number)).partition("e")[0].replace(".", "").strip("0")))


@dataclass(frozen=True)
class LogEngine(Unchangeable):
    """An engine of which there is a log, and no more: it cannot be run on, nor made finer.

    Attributes:
        recording: what the log says.
        bits, step, rounds_input: what the engine that wrote it is (see `scenarios.Engine`).
        lacks: keys of a scene that it does not follow. A log cannot say who leaves play.

    >>> from truebreak.scenarios import Circle, Scene
    >>> scene = Scene([Circle(0, 0, vx=1, id="a"), Circle(4, 0, id="b")])
    >>> log = LogEngine.of([(2.0, "a", "b")], scene)
    >>> log.run(scene, until=5).stop.message
    'the record ends at time 2.0'
    """

    recording: Recording = field(repr=False, compare=False)
    name: str = "log"
    bits: int | None = 53
    step: float | None = None
    rounds_input: bool = True
    lacks: frozenset[str] = frozenset({"capture"})

    @classmethod
    def of(
        cls,
        log: str | Path | Iterable[tuple[float, str, str]],
        scene: Scene,
        name: str | None = None,
        *,
        bits: int | None = 53,
        step: float | None = None,
        rounds_input: bool = True,
        lacks: frozenset[str] = frozenset({"capture"}),
    ) -> LogEngine:
        """The engine of a log: a file, or (time, a, b) of each event.

        Raises:
            EngineError: naming the line, the field and the remedy.
        """
        if isinstance(log, Iterable) and not isinstance(log, str):
            shown = name or "log"
            recording = Recording(scene, shown, bits=bits, step=step)
            for number, line in enumerate(log):
                recording.where = f"{shown}, event {number}"
                try:
                    time, a, b = line
                except (TypeError, ValueError):
                    raise EngineError(f"{recording.where}: {str(line)[:60]}; must be (time, a, b)") from None
                recording.hit(time, a, b)
            recording.end()
        else:
            shown = name or str(log)
            recording = read_log(log, scene, name, bits=bits, step=step)
        return cls(recording, shown, bits, step, rounds_input, lacks)

    @property
    def scene_keys(self) -> frozenset[str]:
        """All but those that it lacks."""
        return ALL_KEYS - {"wall kinds"} - self.lacks

    @property
    def last(self) -> Trajectory:
        """All that the log says."""
        return self.recording.trajectory()

    @property
    def over(self) -> bool:
        """Whether it says that nothing is left to happen."""
        return self.last.stop.reason is StopReason.QUIET

    def undeclared(self) -> Iterator[str]:
        """What its states look like and was not declared, each with the option that declares it."""
        knots: Sequence[Sequence[tuple[float, ...]]] = getattr(self.last.motion, "knots", ())
        last = [{knot[0]: knot for knot in row if knot[0] > 0.0} for row in knots]  # before it is where it would be
        told = [knot for row in last for knot in row.values()]
        places = [number for knot in told for number in knot[1:3]]
        long = any(number * SHORT != math.floor(number * SHORT) for number in places)
        if self.bits == 53 and long and all(math.ldexp(math.frexp(place)[0], 24).is_integer() for place in places):
            yield "every place in it has 24 bits: if it computes in such numbers, judge it with --bits 24"
        elif self.bits == 53 and long and (digits := max(map(_digits, places))) <= FEW_DIGITS:
            bits = math.floor((digits - 1) * math.log2(10) + 1)  # 2**-bits is no less than half a unit in the last
            yield f"no place in it has more than {digits} digits: write 17, or judge it with --bits {bits}"
        times = sorted({knot[0] for knot in told})
        gaps = [later - time for time, later in pairwise(times)]
        if self.step is None and len(gaps) >= MANY_STEPS and max(gaps) - min(gaps) <= SAME_STEP * times[-1]:
            step = Fraction(times[-1] - times[0]) / len(gaps)
            near = step.limit_denominator(MOST_STEPS)
            shown = near if abs(near - step) <= SAME_STEP * step else float(step)
            yield f"its states come at equal steps of {shown}: if it moves by steps, judge it with --step {shown}"

    def run(
        self,
        scene: Scene,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """What the log says up to the limits; nothing beyond its end is known.

        Raises:
            SceneError: for another scene than that of which it is.
        """
        if scene.digest != self.recording.scene.digest:
            raise SceneError(f"{self.name!r} is a log of {self.recording.scene.name!r}, not of {scene.name!r}")
        time, count = horizon(scene, until, events)
        return self.recording.trajectory(until=time, events=count)
