"""A suite: scenes and engines from a TOML file, compared in one report, and what changed since an earlier one."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NotRequired, TypedDict

from ...scenarios.disk import text_of
from ...scenarios.errors import SceneError
from ...scenarios.files import MAX_TOML, toml_table
from ..adapters.adapter import NotInstalled
from ..alignment.align import VERDICTS
from ..comparison import candidate_of, explained, studied
from ..deadline import Clock, OutOfTime, checked_seconds
from ..engines import ENGINES, engine, label_of, split_engines, suggestion
from ..outcomes.outcome import outcomes_of
from ..scene_argument import FILE_SUFFIXES, scene_from
from ..validation import EngineError, check_engine, check_until
from .grid import OnDone, carry_out
from .row import Columns, Row, compared, row_of, versions
from .store import Store

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ..alignment.align import Verdict
    from ..candidate import Candidate
    from ..study import Study

SUITE_KEYS = ("engines", "until", "events", "causes", "scene")
SCENE_KEYS = ("name", "engines", "until", "events")


@dataclass(frozen=True)
class Task:
    """One scene of a suite.

    Attributes:
        scene: as on the command line: a name of the catalogue, or a file.
        engines: as on the command line.
        until, events: limits of the reference's run; None: the scene's own.
    """

    scene: str
    engines: tuple[str, ...]
    until: str | None = None
    events: int | None = None


@dataclass(frozen=True)
class TaskRun:
    """An engine's run of a task's scene beside the certified one.

    Attributes:
        engine: what was compared with the reference.
        study: the certified run, and what is needed to run on.
        candidate: the engine's.
    """

    engine: Engine
    study: Study
    candidate: Candidate

    def row(self, index: int, scene: str) -> Row:
        """What is reported of it."""
        return compared(self.study, self.candidate, index, scene)

    def why(self, watch: Clock | None = None) -> TaskRun:
        """The same with the cause of a divergence or a stop, if the seconds leave time for that.

        Args:
            watch: the seconds that it may take; None: those that are left of the run's.
        """
        if watch is not None:
            self.study.watch = watch
        if self.study.watch.over:
            return self
        try:
            return replace(self, candidate=explained(self.study, self.candidate, self.engine, None))
        except OutOfTime:
            return self


def study_of_task(task: Task, max_seconds: float | None) -> Study:
    """The certified run of a task's scene.

    Raises:
        SceneError: for a scene that the exact engine cannot run.
        OutOfTime: if the seconds are over and there is nothing of it.
        KeyboardInterrupt: if the user interrupts it.
    """
    scene, truth = scene_from(task.scene), ENGINES["exact"].load()()
    return studied(scene, truth, Clock(checked_seconds(max_seconds)), task.until, task.events)


def hold(task: Task, text: str, max_seconds: float | None, study: Study | None = None) -> TaskRun:
    """Compares an engine, named as on the command line, with the certified run of a task's scene.

    Args:
        study: the certified run; None: it is made.

    Raises:
        SceneError: as `study_of_task`, and for an engine that raises or hands back nonsense.
        OutOfTime, KeyboardInterrupt: as `study_of_task`.
    """
    chosen = check_engine(engine(text))
    check_until(chosen, scene_from(task.scene) if study is None else study.scene, task.until)
    study = study_of_task(task, max_seconds) if study is None else study
    candidate = candidate_of(study, label_of(text), chosen, outcomes_of(study.reference), None, None)
    return TaskRun(chosen, study, candidate)


def failed(task: Task, text: str, reason: str, index: int = 0) -> Row:
    """The row of an engine that raised, or handed back nonsense."""
    settings = {key: str(value) for key, value in getattr(engine(text), "parameters", {}).items()}
    scene = scene_from(task.scene)
    return Row(index, task.scene, label_of(text), "failed", digest=scene.digest, settings=settings, note=reason)


@dataclass(frozen=True)
class SuiteJob:
    """One scene of a suite: its certified run is made once, for all of its engines."""

    index: int
    task: Task
    causes: bool
    max_seconds: float | None

    @property
    def label(self) -> str:
        """Its scene."""
        return self.task.scene

    def rows(self) -> list[Row]:
        """One for each engine; one that raises, or hands back nonsense, has a row that says so."""
        task = self.task
        try:
            study = study_of_task(task, self.max_seconds)
        except OutOfTime as error:
            return [failed(task, text, str(error), self.index) for text in task.engines]
        return [self._row(study, text) for text in task.engines]

    def _row(self, study: Study, text: str) -> Row:
        study.watch = Clock(self.max_seconds)
        try:
            held = hold(self.task, text, self.max_seconds, study)
            return (held.why() if self.causes else held).row(self.index, self.task.scene)
        except NotInstalled:
            raise
        except (EngineError, OutOfTime) as error:
            return failed(self.task, text, str(error), self.index)


@dataclass(frozen=True)
class Suite:
    """Tasks, and whether causes are looked for: a plan of the grid, a scene a job.

    Attributes:
        name: what reports call it.
        max_seconds: what one engine on one scene may take, the causes included.
    """

    name: str
    tasks: tuple[Task, ...]
    causes: bool = True
    max_seconds: float | None = None

    apart = False

    @property
    def settings(self) -> dict[str, Any]:
        """As a store keeps them."""
        tasks = [[task.scene, list(task.engines), task.until, task.events] for task in self.tasks]
        return {"grid": "suite", "versions": versions(), "suite": self.name, "tasks": tasks, "causes": self.causes,
                "max_seconds": self.max_seconds}  # fmt: skip

    def indices(self) -> range:
        """Of the scenes."""
        return range(len(self.tasks))

    def key(self, index: int) -> str:
        """The digest of the scene: a file may have changed."""
        return scene_from(self.tasks[index].scene).digest

    def job(self, index: int) -> SuiteJob:
        """Of one scene."""
        return SuiteJob(index, self.tasks[index], self.causes, self.max_seconds)


def read_suite(path: str) -> Suite:
    """A suite from a file, every scene and engine of it checked before anything is run.

    Scenes that are files are looked for from the suite's folder.

    Raises:
        SceneError: naming the file, the scene, the key and the remedy.
    """
    return parsed_suite(text_of(path, MAX_TOML, "name a suite in TOML"), path)


def parsed_suite(text: str, path: str) -> Suite:
    """A suite from the text of a file; see `read_suite`.

    >>> parsed_suite('engines = ["double"]\\n[[scene]]\\nname = "lee"', "mine.toml").tasks
    (Task(scene='lee', engines=('double',), until=None, events=None),)
    """
    where = f"file {path!r}"
    data = toml_table(text, where)
    _known(where, data, SUITE_KEYS)
    scenes = data.get("scene", [])
    if not isinstance(scenes, list) or not scenes or not all(isinstance(scene, dict) for scene in scenes):
        raise SceneError(f'{where}: has no scene; add [[scene]] with name = "gas:n=5"')
    causes = data.get("causes", True)
    if not isinstance(causes, bool):
        raise SceneError(f"{where}: causes = {causes!r}; must be true or false")
    tasks = tuple(_task(f"{where}: scene {number}", {**data, **scene}, path) for number, scene in enumerate(scenes, 1))
    seen: set[tuple[str, str]] = set()
    for task in tasks:
        for name in map(label_of, task.engines):
            if (task.scene, name) in seen:
                raise SceneError(f"{where}: {task.scene!r} is there twice with {name!r}; leave one out")
            seen.add((task.scene, name))
    for scene in scenes:
        _known(where, scene, SCENE_KEYS)
    return Suite(Path(path).name, tasks, causes)


def _task(where: str, data: Mapping[str, Any], path: str) -> Task:
    name = data.get("name")
    if not isinstance(name, str) or not name.strip():
        raise SceneError(f"{where}: name = {name!r}; must be a scene of the catalogue or a file, as text")
    where = f"{where} ({name})"
    if name.lower().endswith(FILE_SUFFIXES) and not Path(name).is_absolute():
        name = str(Path(path).parent / name)
    until, events = data.get("until"), data.get("events")
    if isinstance(until, int) and not isinstance(until, bool):
        until = str(until)
    if until is not None and not isinstance(until, str):
        raise SceneError(f'{where}: until = {until!r}; must be exact, as text: until = "9/4"')
    if events is not None and (isinstance(events, bool) or not isinstance(events, int) or events < 1):
        raise SceneError(f"{where}: events = {events!r}; must be a whole number from 1")
    engines = data.get("engines", [])
    listed = split_engines(engines) if isinstance(engines, str) else engines
    if not isinstance(listed, list) or not listed or not all(isinstance(text, str) for text in listed):
        raise SceneError(f'{where}: engines = {engines!r}; must be a list such as ["double", "pymunk:dt=1/512"]')
    try:
        scene_from(name)
        for text in listed:
            engine(text)
    except SceneError as error:
        raise type(error)(f"{where}: {error}") from None
    return Task(name, tuple(listed), until, events)


def _known(where: str, data: Mapping[str, Any], keys: tuple[str, ...]) -> None:
    for key in data:
        if key not in keys:
            raise SceneError(f"{where}: {key!r} is no key of it; {suggestion(key, list(keys))}")


# -- the report

SUITE_SCHEMA = "truebreak/suite-2"

COLUMNS = (
    "index", "scene", "digest", "engine", "settings", "verdict", "agreed", "events", "time", "stop", "ended",
    "event", "at", "body", "expected", "got", "kind", "cause", "changed", "until", "drift", "laws",
    "seconds", "times", "right", "note",
)  # fmt: skip
"""What a report has of each row."""


@dataclass(frozen=True)
class SuiteReport:
    """What came out of a suite.

    Attributes:
        suite: its name.
        rows: one for each engine on each scene, in order.
        max_seconds: what a row was allowed, if the user set it.
    """

    suite: str
    rows: Sequence[Row]
    max_seconds: float | None = None

    @property
    def verdict(self) -> Verdict:
        """The first of `diverged`, `unsettled`, `undecided`, `agree` that holds for any row."""
        found = {"undecided" if row.verdict in ("refused", "failed") else row.verdict for row in self.rows} or {"agree"}
        return next(verdict for verdict in VERDICTS if verdict in found)

    @property
    def lawless(self) -> int:
        """How many rows are of an engine whose steps do not keep the laws, whatever its history."""
        return sum(row.lawless for row in self.rows)


def run_suite(
    suite: Suite,
    *,
    store: Store | None = None,
    jobs: int | None = 1,
    executor: Executor | None = None,
    progress: OnDone | None = None,
) -> SuiteReport:
    """Every engine of every scene, compared with the certified run.

    Args:
        store: where the rows are kept, and what is there is not done again; None: in memory.
        jobs, executor, progress: see `carry_out`.

    Raises:
        SceneError: for a scene that the reference cannot run, and an engine that is not installed.
        KeyboardInterrupt: if the user interrupts it; what is done is in the store.
    """
    rows = Store(":memory:", suite.settings) if store is None else store
    carry_out(suite, rows, jobs=jobs, executor=executor, progress=progress)
    rows.verify()
    return SuiteReport(suite.name, rows, suite.max_seconds)


SuiteRow = Annotated[dict[str, Any], Columns(COLUMNS)]


class SuiteDocument(TypedDict):
    """What came out of a suite, or of a survey, row by row.

    Attributes:
        suite: its name.
        verdict: the first of `diverged`, `unsettled`, `undecided`, `agree` that holds for any row.
        max_seconds: what a row was allowed; null: nothing was set.
        rows: one for each engine on each scene, in order.
        changes: what changed since an earlier report; null if none was given.
        versions: of a survey: those of the engines that are installed; nothing for truebreak's own.
        missing: of a survey: engines that are not installed.
    """

    schema: str
    suite: str
    verdict: Verdict
    max_seconds: float | None
    rows: list[SuiteRow]
    changes: list[SinceRow] | None
    versions: NotRequired[dict[str, str]]
    missing: NotRequired[list[str]]


class SinceRow(TypedDict):
    """What became of one row.

    Attributes:
        scene: the scene.
        engine: the engine.
        what: what changed.
        sentence: in words.
    """

    scene: str
    engine: str
    what: str
    sentence: str


def suite_json(report: SuiteReport, changes: Sequence[Since] | None = None) -> SuiteDocument:
    """The object that `truebreak suite --json` prints.

    Args:
        changes: what changed since an earlier report; None if none was given.
    """
    return {
        "schema": SUITE_SCHEMA,
        "suite": report.suite,
        "verdict": report.verdict,
        "max_seconds": report.max_seconds,
        "rows": [row.data(COLUMNS) for row in report.rows],
        "changes": None
        if changes is None
        else [
            {"scene": one.scene, "engine": one.engine, "what": one.what, "sentence": one.sentence} for one in changes
        ],
    }


# -- what changed from one report to the next: after a change of an engine, a compiler, a machine

MOST_BYTES = 64 << 20
"""The longest report that is read: some 100,000 rows."""


@dataclass(frozen=True)
class Since:
    """What became of one row.

    Attributes:
        scene, engine: which.
        what: "verdict", "laws", "divergence", "outcomes", "scene" (its definition), "new" or "gone".
        sentence: in words.
    """

    scene: str
    engine: str
    what: str
    sentence: str


def read_report(path: str) -> tuple[dict[str, Any], list[Row]]:
    """A report that was written with `--json`, and its rows.

    Raises:
        SceneError: naming the file and the remedy.
    """
    where = f"file {path!r}"
    text = text_of(path, MOST_BYTES, "name a report of `truebreak suite --json`")
    try:
        data: Any = json.loads(text)
    except (ValueError, RecursionError):
        raise SceneError(f"{where}: is not JSON; name a report of `truebreak suite --json`") from None
    if not isinstance(data, dict) or data.get("schema") != SUITE_SCHEMA or not isinstance(data.get("rows"), list):
        raise SceneError(f"{where}: is no {SUITE_SCHEMA}; write one with `truebreak suite FILE.toml --json`")
    return data, [row_of(row, f"{where}: row {number}") for number, row in enumerate(data["rows"])]


def since(earlier: Iterable[Row], report: SuiteReport) -> list[Since]:
    """Every row of which something changed, first those that there are, then those that are gone."""
    before = {row.pair: row for row in earlier}
    found = [change for row in report.rows if (change := _change(before.get(row.pair), row)) is not None]
    now = {row.pair for row in report.rows}
    gone = [
        Since(scene, name, "gone", f"{name} on {scene}: was in the earlier report, and is not in this suite")
        for scene, name in before
        if (scene, name) not in now
    ]
    return found + gone


def _change(earlier: Row | None, row: Row) -> Since | None:
    label = f"{row.engine} on {row.scene}"
    if earlier is None:
        return Since(*row.pair, "new", f"{label}: is new, {in_words(row)}")
    if earlier.digest != row.digest:
        return Since(*row.pair, "scene", f"{label}: the scene itself is another, and so nothing is compared")
    if earlier.verdict != row.verdict:
        return Since(*row.pair, "verdict", f"{label}: {in_words(earlier)} before, {in_words(row)} now")
    if earlier.mark != row.mark:
        return Since(*row.pair, "verdict", f"{label}: {earlier.mark} before, {row.mark} now")
    if earlier.laws is not None and earlier.lawless != row.lawless:
        kept = [f"does not keep the law ({r.laws['finding']})" if r.laws and r.lawless else "breaks no law"
                for r in (earlier, row)]  # fmt: skip
        return Since(*row.pair, "laws", f"{label}: same verdict, but {kept[0]} before, {kept[1]} now")
    if _place(earlier) != _place(row):
        return Since(*row.pair, "divergence", f"{label}: {in_words(earlier)} before, {in_words(row)} now")
    if earlier.until == row.until and sorted(earlier.changed or ()) != sorted(row.changed or ()):
        names = ", ".join(sorted(set(earlier.changed or ()) ^ set(row.changed or ())))
        return Since(*row.pair, "outcomes", f"{label}: same verdict, but other outcomes are wrong: {names}")
    return None


def _place(row: Row) -> tuple[Any, ...]:
    """Where a history diverges, whatever the last digits of its times."""
    return row.agreed, row.event, row.body, row.expected, row.got, row.kind


def in_words(row: Row) -> str:
    """A row's verdict in a few words.

    >>> in_words(Row(0, "gas", "double", "diverged", agreed=7, events=9, event=7))
    'diverged at event 7'
    """
    if row.event is not None:
        return f"diverged at event {row.event:,}"
    word = {"agree": "agreed", "unsettled": "not settled"}.get(row.verdict, row.verdict)
    return f"{word}, {row.agreed or 0:,} of {row.events or 0:,} events"
