"""What a benchmark measured: as JSON and back, as tables, and compared with an earlier one ratio by ratio."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypedDict

from ...scenarios.errors import SceneError
from ..grids.computer import LEAST_PROCESSES, MOST_PROCESSES, Idleness, Took, calibration, computer, idleness
from ..grids.row import Columns, Row, row_of
from ..grids.tradeoffs import COLUMNS, SUBJECTS, digits_shown, law_shown, steady, subjects, tradeoffs

if TYPE_CHECKING:
    from ..grids.grid import Done
    from .output import TextTable

SCHEMA = "truebreak/bench-5"


SpeedRow = Annotated[dict[str, Any], Columns(COLUMNS)]


class BenchDocument(TypedDict):
    """Run time against error.

    Attributes:
        version: truebreak's version.
        machine: processor, cores, system and Python.
        idle: whether the machine was idle.
        tradeoffs: scene by scene and engine by engine.
    """

    schema: str
    version: str
    machine: dict[str, str | int]
    idle: IdleRow
    tradeoffs: list[SpeedRow]


class IdleRow(TypedDict):
    """Whether the machine was idle while it measured.

    Attributes:
        idle: whether it was.
        wall: time on the wall over time of the processor.
        uneven: the slowest over the fastest of loops that take as long on an idle machine.
        unsteady: what came out too unlike twice.
    """

    idle: bool
    wall: float
    uneven: float
    unsteady: list[str]


@dataclass(frozen=True)
class Report:
    """All that was measured.

    Attributes:
        tradeoffs: run time against error, scene by scene and engine by engine.
        idleness: whether the machine was idle.
    """

    tradeoffs: tuple[Row, ...]
    idleness: Idleness

    def data(self) -> BenchDocument:
        """The report as JSON has it."""
        idle = self.idleness
        return {
            "schema": SCHEMA,
            "version": version("truebreak"),
            "machine": computer(),
            "idle": {"idle": idle.idle, "wall": idle.wall, "uneven": idle.uneven, "unsteady": list(idle.unsteady)},
            "tradeoffs": [row.data(COLUMNS) for row in self.tradeoffs],
        }


def load(path: str, option: str) -> dict[str, Any]:
    """A report that `truebreak bench --json` printed.

    Args:
        option: what named the file, for errors.

    Raises:
        SceneError: for a file that cannot be read, is none, or is of another version.
    """
    where = f"{option} {path!r}"
    try:
        data = json.loads(Path(path).read_text("utf-8"))
    except OSError as error:
        raise SceneError(f"{where}: {error.strerror or error}; name a file that `bench --json` printed") from None
    except (ValueError, RecursionError):
        raise SceneError(f"{where}: is not JSON; name a file that `bench --json` printed") from None
    told = data.get("schema") if isinstance(data, dict) else None
    if told != SCHEMA:
        raise SceneError(f"{where}: is {str(told)[:60]!r}, not {SCHEMA!r}; measure it again with this version")
    if data.get("version") != version("truebreak"):
        raise SceneError(f"{where}: is of version {str(data.get('version'))[:20]}; measure it again with this version")
    try:
        rows, told = rows_of(data), idleness_of(data)
        ratios = [row.ratio for row in rows if row.refused is None]
        assert all(value is not None and 0 < value < math.inf for value in (*ratios, told.wall, told.uneven))
        assert len({row.name for row in rows}) == len(rows)
        assert isinstance(data["machine"], dict)
    except (KeyError, TypeError, ValueError, AttributeError, AssertionError, SceneError):
        raise SceneError(f"{where}: is damaged; measure it again") from None
    return data


def rows_of(data: dict[str, Any]) -> tuple[Row, ...]:
    """The rows of a report's JSON."""
    return tuple(row_of(row, "a row") for row in data["tradeoffs"])


def idleness_of(data: dict[str, Any]) -> Idleness:
    """The idleness of a report's JSON."""
    idle = data["idle"]
    return Idleness(float(idle["wall"]), float(idle["uneven"]), tuple(idle["unsteady"]))


def check_scenes(told: dict[str, str | None], data: dict[str, Any], path: str) -> None:
    """Refuses to compare a report with one of other scenes.

    Args:
        told: names and digests of the scenes to be measured.

    Raises:
        SceneError: naming the first that differs.
    """
    then = {row["scene"]: row["digest"] for row in data["tradeoffs"]}
    for name in sorted(told.keys() ^ then.keys()):
        there = "has not" if name in told else "has besides"
        raise SceneError(f"--against {path!r}: is of another set of scenes: {name!r} it {there}; choose other --scenes")
    for name, digest in told.items():
        if digest != then[name]:
            raise SceneError(f"--against {path!r}: its scene {name!r} is another one; measure it again")


WITHIN = 0.15
"""Share by which a ratio may differ between two runs on one idle machine."""


@dataclass(frozen=True)
class RatioChange:
    """One ratio in both runs."""

    name: str
    then: float
    now: float

    @property
    def share(self) -> float:
        """By how much the greater is more than the less.

        >>> round(RatioChange("gas, double", 2.0, 1.6).share, 9)
        0.25
        """
        return max(self.then, self.now) / min(self.then, self.now) - 1.0

    @property
    def within(self) -> bool:
        """Whether the two are the same, for an idle machine."""
        return self.share <= WITHIN

    def __str__(self) -> str:
        return f"{self.name}: {self.then:.3g} then, {self.now:.3g} now ({self.now / self.then - 1:+.0%})"


@dataclass(frozen=True)
class Against:
    """One run compared with an earlier one.

    Attributes:
        changes: every ratio that both have, the largest change first.
        missing: rows that were measured in one of the two alone.
        then, now: how idle the machine was.
        same: whether it was the same machine, as far as is told.
    """

    changes: tuple[RatioChange, ...]
    missing: tuple[str, ...]
    then: Idleness
    now: Idleness
    same: bool

    @property
    def beyond(self) -> tuple[RatioChange, ...]:
        """The ratios that differ by more than `WITHIN`."""
        return tuple(change for change in self.changes if not change.within)

    @property
    def comparable(self) -> bool:
        """Whether a difference says something: the same machine, idle both times."""
        return self.same and self.then.idle and self.now.idle

    def sentences(self) -> list[str]:
        """What came out."""
        count = len(self.changes)
        lines = [f"{count - len(self.beyond)} of {count} ratios agree within {WITHIN:.0%}."]
        if not count:
            lines = ["No ratio was measured both times: there is nothing to compare."]
        lines += [str(change) for change in self.beyond]
        if not self.beyond and self.changes:
            lines.append(f"The largest difference: {self.changes[0]}")
        lines += [f"Then: {self.then}", f"Now: {self.now}"]
        if not self.same:
            lines.append("It is another machine, or another Python: ratios may differ for that.")
        if self.beyond and not self.comparable and self.same:
            lines.append("As the machine was not idle, the differences say nothing of the engines.")
        if self.missing:
            lines.append(f"Measured in one of the two alone: {'; '.join(self.missing)}.")
        return lines


def against(report: Report, data: dict[str, Any]) -> Against:
    """A report compared with the JSON of an earlier one, of the same scenes."""
    mine = {row.name: row.ratio for row in report.tradeoffs if row.refused is None and row.ratio}
    theirs = {row.name: row.ratio for row in rows_of(data) if row.refused is None and row.ratio}
    changes = [RatioChange(name, theirs[name], mine[name]) for name in mine if theirs.get(name)]
    return Against(
        tuple(sorted(changes, key=lambda change: -change.share)),
        tuple(sorted(mine.keys() ^ theirs.keys())),
        idleness_of(data),
        report.idleness,
        data["machine"] == computer(),
    )


def tables(report: Report) -> Iterator[TextTable]:
    """One table for each scene."""
    for scene, rows in groupby(report.tradeoffs, key=lambda row: row.scene):
        yield _scene(scene, list(rows))


def _scene(name: str, rows: list[Row]) -> TextTable:
    spec = next((f" ({subject.spec})" for subject in SUBJECTS if subject.name == name), "")
    from .output import grid

    title = f"{name}{spec}, {rows[0].events:,} events; * is Pareto's front"
    table = grid("", "engine", "/ exact", "seconds", "agreed", "largest error", "digits", "outcomes", "law", "memory",
                 title=title, whole=("engine", "/ exact", "seconds", "agreed", "digits", "memory"))  # fmt: skip
    for row in rows:
        if row.refused is not None:
            table.add_row("", row.engine, "", "", "", "", "", row.refused, "", "")
            continue
        digits = digits_shown(row.digits)
        table.add_row(
            "*" if row.front else "",
            row.engine,
            f"{row.ratio or 0:.3g}",
            f"{row.seconds or 0:.3g}",
            f"{row.agreed or 0:,}",
            "infinite" if row.error is None else f"{row.error:.2g}",
            "" if digits is None else str(digits),
            _outcomes(row),
            law_shown(row),
            "" if row.memory is None else f"{row.memory / 2**20:.1f} MiB",
        )
    return table


def _outcomes(row: Row) -> str:
    if row.changed is None:
        return str(row.verdict)
    return f"wrong: {', '.join(row.changed)}" if row.changed else "right"


def measure(
    *,
    scenes: Sequence[str] = (),
    engines: Sequence[str] = (),
    processes: tuple[int, int] = (LEAST_PROCESSES, MOST_PROCESSES),
    store: str = ":memory:",
    progress: Callable[[Done], None] | None = None,
) -> Report:
    """Measures the table of run time against error.

    Args:
        scenes, engines: some of the table's; none means all.
        processes: the fewest and the most for each row.
        store: the file that keeps the rows; what is in it already is not measured again.
        progress: called after each row.

    Raises:
        SceneError: for an unknown name, and a store of another machine or table.
    """
    loops = calibration()
    rows = tradeoffs(subjects(scenes), engines, processes=processes, store=store, progress=progress)
    samples = [row.samples for row in rows if row.samples is not None]
    loops += [*(Took(*took) for sample in samples for took in sample["loops"]), *calibration()]
    runs = [Took(*took) for sample in samples for took in sample["runs"]]
    return Report(tuple(rows), idleness(runs, loops, [row.name for row in rows if row.samples and not steady(row)]))
