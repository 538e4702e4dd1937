"""The survey: every installed engine on sixteen scenes, as it comes, at its best settings, and as is advised."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from importlib.util import find_spec
from typing import Any

from ...scenarios.disk import fits
from ...scenarios.errors import SceneError, cut
from ...scenarios.lazy import VERSION
from ..adapters.adapter import version_of
from ..deadline import Clock, OutOfTime, uninterrupted
from ..engines import ENGINES, engine, suggestion
from ..scene_argument import scene_from
from ..validation import EngineError
from .goals import HistoryGoal
from .grid import OnDone, carry_out
from .row import Row
from .setting_search import advise
from .store import Store
from .suite_file import SuiteDocument, SuiteReport, Task, TaskRun, failed, hold, read_report, suite_json

SCENES: dict[str, Task] = {
    "cradle, touching": Task("cradle:gap=0", (), events=60),
    "cradle, apart": Task("cradle", (), events=60),
    "tennis": Task("tennis", (), events=100),
    "galperin": Task("galperin:n=1", ()),
    "break, touching": Task("rack:rows=3,pockets=no,speed=8", (), events=20),
    "break, loose": Task("rack:rows=3,pockets=no,speed=8,gap=1/10", (), events=20),
    "gas": Task("gas", (), events=200),
    "reversal": Task("reversal:n=5,after=40", ()),
    "lee": Task("lee", ()),
    "near-tie": Task("near-tie", ()),
    "inscribed": Task("inscribed", (), events=12),
    "pinball": Task("pinball", (), events=40),
    "barrier": Task("barrier", (), events=30),
    "funnel": Task("funnel", (), events=30),
    "breakout": Task("breakout", (), events=20),
    "stadium": Task("stadium", (), events=30),
}
"""The sixteen, and how far each is followed; the last four have edges. `truebreak scenes` says what each shows."""


@dataclass(frozen=True)
class Surveyed:
    """An engine of the survey.

    Attributes:
        name: as in `ENGINES`.
        module: what has to be installed for it.
        distribution: whose version is given; empty: truebreak's own.
        made_for: what its authors made it for.
        home: where they are to be found.
        ladder: settings that are tried, the cheapest first; the first is how it comes.
    """

    name: str
    module: str
    distribution: str
    made_for: str
    home: str
    ladder: tuple[str, ...]

    @property
    def texts(self) -> list[str]:
        """The engine at each of these, as the command line takes it."""
        return [f"{self.name}:{settings}" if settings else self.name for settings in self.ladder]

    @property
    def first(self) -> str:
        """As it comes."""
        return self.texts[0]


STEPS = ("", "dt=1/512", "dt=1/2048")
"""Settings of an engine of steps, which it comes with at 1/256."""

SURVEYED = (
    Surveyed("double", "math", "", "truebreak's own baseline: events, in 53 bits", "", ("",)),
    Surveyed("single", "math", "", "the same in 24 bits, in which many games count", "", ("",)),
    Surveyed("quad", "math", "", "the same in 106 bits", "", ("",)),
    Surveyed("interval", "mpmath", "", "truebreak's own: stops where its width does not decide", "", ("", "bits=512")),
    Surveyed("pymunk", "pymunk", "pymunk", "games, by Chipmunk2D", "https://www.pymunk.org", STEPS),
    Surveyed("box2d", "Box2D", "box2d", "games", "https://box2d.org", STEPS),
    Surveyed("rapier", "rapier3d", "rapier3d", "games, robotics; in 3D", "https://rapier.rs", STEPS),
    Surveyed(
        "mujoco", "mujoco", "mujoco", "robotics: smooth contacts, for control and learning", "https://mujoco.org",
        ("", "dt=1/8192"),
    ),
    Surveyed(
        "billiards", "billiards", "billiards", "billiards of hard discs", "https://github.com/markus-ebke/python-billiards",
        ("",),
    ),
    Surveyed(
        "pooltool", "pooltool", "pooltool-billiards", "pool, with sliding, rolling and spin", "https://github.com/ekiefl/pooltool",
        ("", "friction=1/10**7"),
    ),
    Surveyed(
        "perfect-physics", "perfect_physics", "perfect-physics", "exact collisions, to learn from", "https://pypi.org/project/perfect-physics/",
        ("max_events=8",),
    ),
)  # fmt: skip
"""Every engine that is compared with `exact`; `sympy` is left out, as it asks the same questions of SymPy, slowly."""

FIRST = Task("cradle:n=1", (), events=1)
"""What each engine plays before anything is measured: it is then loaded, and what it compiles is compiled."""

MOST_STEPS = 100_000
"""Time steps of the longest run that a setting is tried for."""

BUDGET = 200_000
"""Units of work that all runs of one search may cost: up to some 30,000 time steps for the longest of them."""

PERTURBED = 2
"""Scenes beside each one on which a setting has to be right too."""


@dataclass(frozen=True)
class SurveyEntry:
    """One engine on one scene of the survey.

    Attributes:
        label: of the scene.
        tried: a row for each setting tried, the first as the engine comes, an advised one last.
    """

    label: str
    name: str
    tried: tuple[Row, ...]

    @property
    def advice(self) -> Row | None:
        """The row of the setting that is advised, `right`, or the first, not `right`, where none is; its note says
        what it costs, or why there is none. None: advice was not asked for, or there is nothing to choose from."""
        return next((row for row in self.tried if row.right is not None), None)

    @property
    def first(self) -> Row:
        """As it comes."""
        return self.tried[0]

    @property
    def best(self) -> Row:
        """The setting that is right, or else agrees the farthest; of those that agree as far, the first tried."""
        return max(self.tried, key=lambda row: (row.agrees, row.verdict == "agree", row.agreed or 0))

    @property
    def shown(self) -> tuple[Row, ...]:
        """The best, how it comes, and what is advised, each once."""
        advised = [row for row in self.tried if row.right]
        return tuple({row.engine: row for row in (self.best, self.first, *advised)}.values())


@dataclass(frozen=True)
class Survey:
    """What came out of the survey.

    Attributes:
        versions: of those that are installed, by name; nothing for truebreak's own.
        entries: one for each engine on each scene.
        missing: engines that are not installed.
        max_seconds: what each run was allowed.
    """

    versions: dict[str, str]
    entries: tuple[SurveyEntry, ...]
    missing: tuple[str, ...]
    max_seconds: float | None

    @property
    def engines(self) -> tuple[Surveyed, ...]:
        """Those that are installed."""
        return tuple(one for one in SURVEYED if one.name in self.versions)

    @property
    def report(self) -> SuiteReport:
        """All rows, as those of a suite."""
        return SuiteReport("survey", [row for entry in self.entries for row in entry.tried], self.max_seconds)


def survey_json(found: Survey) -> SuiteDocument:
    """The object that `truebreak survey --json` prints: that of a suite, with versions."""
    return {**suite_json(found.report), "versions": found.versions, "missing": list(found.missing)}


def installed() -> tuple[Surveyed, ...]:
    """The engines that are there to be surveyed."""
    return tuple(one for one in SURVEYED if find_spec(one.module) is not None)


def installed_version(one: Surveyed) -> str:
    """The version of an engine's package; nothing for truebreak's own."""
    return version_of(one.distribution) if one.distribution else ""


def chosen(names: Sequence[str], known: Iterable[str], kind: str) -> list[str]:
    """Those of the known that were named, or all.

    Raises:
        SceneError: for one that is not known.
    """
    known = list(known)
    for name in names:
        if name not in known:
            raise SceneError(f"{kind} {name!r} is not in the survey; {suggestion(name, known)}")
    return [name for name in known if not names or name in names]


# -- the grid: a job for each engine on each scene, numbered over all of them, whichever are asked for


@dataclass(frozen=True)
class SurveyPlan:
    """What a survey asks for: pairs of a scene's label and an engine.

    Attributes:
        labels, engines: of the scenes; those engines that are asked for and installed.
        causes: whether to find out why an engine diverged, of the settings that are shown.
        advice: whether to look for the cheapest setting that is right, as `truebreak advise` does.
        max_seconds: what one run may take, and as much again the search for its causes.
    """

    labels: tuple[str, ...]
    engines: tuple[Surveyed, ...]
    causes: bool = True
    advice: bool = True
    max_seconds: float | None = None

    apart = False

    @property
    def settings(self) -> dict[str, Any]:
        """As a store keeps them: one store may be filled engine by engine."""
        return {"grid": "survey", "truebreak": VERSION, "causes": self.causes, "advice": self.advice,
                "max_seconds": self.max_seconds}  # fmt: skip

    def indices(self) -> list[int]:
        """Of the pairs that are asked for."""
        labels, names = list(SCENES), [one.name for one in SURVEYED]
        return [labels.index(label) * len(names) + names.index(one.name)
                for label in self.labels for one in self.engines]  # fmt: skip

    def key(self, index: int) -> str:
        """The scene, the engine's version and its settings: a row of another day is made again."""
        label, one = list(SCENES)[index // len(SURVEYED)], SURVEYED[index % len(SURVEYED)]
        return f"{scene_digest(label)} {one.name} {installed_version(one)} {' '.join(one.texts)}"

    def job(self, index: int) -> SurveyJob:
        """Of one pair."""
        label, one = list(SCENES)[index // len(SURVEYED)], SURVEYED[index % len(SURVEYED)]
        return SurveyJob(index, label, one, self.causes, self.advice, self.max_seconds)


@lru_cache
def scene_digest(label: str) -> str:
    """The digest of a scene of the survey."""
    return scene_from(SCENES[label].scene).digest


def limit_of(scene: str) -> int | None:
    """How many events of a scene of the survey are followed."""
    return next((task.events for task in SCENES.values() if task.scene == scene), None)


@lru_cache
def warmed(name: str, max_seconds: float | None) -> None:
    """Lets an engine play a scene of two discs: it is then loaded, and what it compiles is compiled."""
    try:
        hold(FIRST, name, max_seconds)
    except (EngineError, OutOfTime):
        return


@dataclass(frozen=True)
class SurveyJob:
    """One engine on one scene: its ladder up to what agrees, what is advised, and why what is shown diverged."""

    index: int
    scene: str
    one: Surveyed
    causes: bool
    advice: bool
    max_seconds: float | None

    @property
    def label(self) -> str:
        """Scene and engine."""
        return f"{self.scene}: {self.one.name}"

    def rows(self) -> list[Row]:
        """A row for each setting tried."""
        warmed(self.one.name, self.max_seconds)
        task, tried, runs = SCENES[self.scene], dict[str, Row](), dict[str, TaskRun]()
        for text in settings_tried(self.one, self.scene):
            if any(row.agrees for row in tried.values()):
                break
            self._try(task, text, tried, runs)
        first = self.one.first
        if self.advice and adjustable(self.one.name) and tried[first].verdict != "refused":
            setting, note = advised(task, self.one.name)
            if setting is not None and setting not in tried:
                self._try(task, setting, tried, runs)
            named = setting or first
            tried[named] = replace(tried[named], right=setting is not None, note=note)
        if self.causes:
            shown = {row.engine for row in SurveyEntry(self.scene, self.one.name, tuple(tried.values())).shown}
            for text, held in runs.items():
                if text in shown and tried[text].verdict in ("diverged", "undecided"):
                    tried[text] = replace(tried[text], cause=_why(held, self.max_seconds))
        return list(tried.values())

    def _try(self, task: Task, text: str, tried: dict[str, Row], runs: dict[str, TaskRun]) -> None:
        try:
            held = hold(task, text, self.max_seconds)
        except (EngineError, OutOfTime) as error:
            tried[text] = failed(task, text, str(error), self.index)
            return
        tried[text] = held.row(self.index, task.scene)
        if not held.candidate.unable:
            runs[text] = held


def _why(held: TaskRun, max_seconds: float | None) -> str | None:
    """The cause, or what stands in the way of one."""
    try:
        found = held.why(Clock(max_seconds)).candidate.diagnosis
    except EngineError as error:
        return f"not found: {error}"
    if found is not None:
        return str(found)
    return None if max_seconds is None else f"not found within {max_seconds:g} s"


def settings_tried(one: Surveyed, label: str) -> list[str]:
    """The engine at the settings to try on a scene: those of its ladder that take no more than `MOST_STEPS` steps."""
    task, listed = SCENES[label], one.texts
    if len(listed) == 1 or engine(listed[0]).step is None:
        return listed
    run = uninterrupted(ENGINES["exact"].load()().run(scene_from(task.scene), until=task.until, events=task.events))
    end = float(run.final_time)
    return [text for number, text in enumerate(listed) if not number or end <= MOST_STEPS * (engine(text).step or 0.0)]


def adjustable(name: str) -> bool:
    """Whether an engine has settings to choose from: a step, or bits.

    >>> adjustable("pymunk"), adjustable("interval"), adjustable("double")
    (True, True, False)
    """
    fields: Any = engine(name)
    return any(field.name in ("dt", "bits") for field in dataclasses.fields(fields))


def advised(task: Task, name: str) -> tuple[str | None, str]:
    """The cheapest setting with which an engine reproduces the whole history of a task, and of scenes beside it, and
    what it costs; None, and why there is none."""
    try:
        goal = HistoryGoal(task.events)
        found = advise(scene_from(task.scene), goal, name, perturbed=PERTURBED, budget=BUDGET, why=False)
    except SceneError as error:
        return None, str(error)
    if found.named is not None:
        return found.named.setting.text, f"{found.named.setting.work:,} units of work a run"
    return None, f"none of the {len(found.tried):,} settings within {BUDGET:,} units of work"


def survey_plan(
    engines: Sequence[str] = (),
    scenes: Sequence[str] = (),
    *,
    causes: bool = True,
    advice: bool = True,
    max_seconds: float | None = None,
) -> tuple[SurveyPlan, tuple[str, ...]]:
    """The survey, or a part of it, and which of the engines are missing.

    Args:
        engines: names; all by default. Those that are not installed are left out, and named.
        scenes: labels, as in `SCENES`; all by default.
        causes, advice, max_seconds: see `SurveyPlan`.

    Raises:
        SceneError: for an unknown name or label.
    """
    names = chosen(engines, [one.name for one in SURVEYED], "engine")
    labels = chosen(scenes, SCENES, "scene")
    there = tuple(one for one in installed() if one.name in names)
    missing = tuple(name for name in names if name not in {one.name for one in there})
    return SurveyPlan(tuple(labels), there, causes, advice, max_seconds), missing


def survey(
    engines: Sequence[str] = (),
    scenes: Sequence[str] = (),
    *,
    store: str = ":memory:",
    jobs: int | None = 1,
    progress: OnDone | None = None,
    **asked: Any,
) -> Survey:
    """Runs the survey, or a part of it.

    Args:
        engines, scenes: see `survey_plan`, as for `asked`.
        store: the file that keeps the rows; what is in it already is not made again.
        jobs, progress: see `carry_out`. Times are ratios of two runs of one worker.

    Raises:
        SceneError: for an unknown name or label, and a store of another survey.
        KeyboardInterrupt: if the user interrupts it; what is done is in the store.
    """
    plan, missing = survey_plan(engines, scenes, **asked)
    rows = Store(store, plan.settings)
    carry_out(plan, rows, jobs=jobs, progress=progress)
    rows.verify()
    wanted = set(plan.indices())
    versions = {one.name: installed_version(one) for one in plan.engines}
    return Survey(versions, entries_of(row for row in rows if row.index in wanted), missing, plan.max_seconds)


def name_of(row: Row) -> str:
    """The engine of a row, without the settings."""
    text = row.engine
    return next((one.name for one in SURVEYED if text == one.name or text.startswith(f"{one.name}:")), text)


def entries_of(rows: Iterable[Row]) -> tuple[SurveyEntry, ...]:
    """The entries of rows, in the order of the scenes and the engines; of rows that come twice the later ones."""
    found: dict[tuple[str, str], dict[str, Row]] = {}
    for row in rows:
        found.setdefault((row.scene, name_of(row)), {})[row.engine] = row
    return tuple(
        SurveyEntry(label, one.name, tuple(found[task.scene, one.name].values()))
        for label, task in SCENES.items()
        for one in SURVEYED
        if (task.scene, one.name) in found
    )


def read_survey(paths: Sequence[str]) -> Survey:
    """The survey of one or more files that `truebreak survey --json` has written.

    Where several tell of an engine on a scene, the last of them is taken.

    Raises:
        SceneError: naming the file and the remedy.
    """
    versions: dict[str, str] = {}
    missing: set[str] = set()
    found: dict[tuple[str, str], list[Row]] = {}
    seconds = None
    for path in paths:
        data, rows = read_report(path)
        hints = {"versions": dict[str, str], "missing": list[str], "max_seconds": float | None}
        if not isinstance(data.get("versions"), dict):
            raise SceneError(f"file {path!r}: is a report of a suite; name one of `truebreak survey --json`")
        for key, hint in hints.items():
            if not fits(data.get(key), hint):
                raise SceneError(f"file {path!r}: {key} = {cut(data.get(key))}; write the report again")
        versions |= data["versions"]
        missing |= set(data["missing"])
        seconds = data["max_seconds"]
        mine: dict[tuple[str, str], list[Row]] = {}
        for row in rows:
            mine.setdefault((row.scene, name_of(row)), []).append(row)
        found |= mine
    return Survey(versions, entries_of(_all(found.values())), tuple(sorted(missing)), seconds)


def _all(lists: Iterable[list[Row]]) -> Iterator[Row]:
    for rows in lists:
        yield from rows
