"""Run time against error: scenes in every engine, each at several settings, answers checked; a plan of the grid."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, lru_cache
from itertools import groupby
from typing import TYPE_CHECKING, Any

from ...exact.exact_engine import ExactEngine
from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.trajectory import StopReason
from ..chaos.accuracy import end_error
from ..comparison import candidate_of
from ..deadline import uninterrupted
from ..engines import ENGINES, offered, suggestion
from ..engines import engine as engine_named
from ..files.amounts import double
from ..outcomes.outcome import outcomes_of
from ..scene_argument import scene_from
from ..study import Study
from .computer import LEAST_PROCESSES, MOST_PROCESSES, UNEVEN, computer
from .grid import OnDone, carry_out
from .row import Row, laws_brief, versions
from .setting_ladder import RunSize, cost
from .store import Store

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.scene import Scene
    from .measured import MeasuredProcess

SETTINGS = (
    "single",
    "double",
    "quad",
    "interval:bits=53",
    "interval:bits=128",
    "interval:bits=512",
    "pymunk:dt=1/64",
    "pymunk:dt=1/256",
    "pymunk:dt=1/1024",
    "pymunk:dt=1/4096",
    "pymunk:dt=1/1024,iterations=1",
    "pymunk:dt=1/1024,iterations=1000",
)
"""What is set against the exact engine, whose own row comes first. Pymunk's iterations are 64 where nothing is said."""

CROWD = ("double", "pymunk:dt=1/64", "pymunk:dt=1/1024")
"""The same for a scene of many discs."""


@dataclass(frozen=True)
class Subject:
    """One scene of the table.

    Attributes:
        name: as `--scenes` takes it.
        spec: the scene of the catalogue.
        events: how many of its instants are run; fewer where it comes to rest before.
        settings: what is set against the exact engine.
        symbolic: whether engines that count in expressions are run too: elsewhere an event takes them seconds, or
            minutes where roots nest.
    """

    name: str
    spec: str
    events: int
    settings: tuple[str, ...] = SETTINGS
    symbolic: bool = False


SUBJECTS = (
    Subject("gas", "gas:n=10,seed=1", 100),
    Subject("mixed-gas", "gas:n=10,seed=1,mixed=yes", 100),
    Subject("rack-touching", "rack:rows=3", 20),
    Subject("rack-loose", "rack:rows=3,gap=1/50", 20),
    Subject("galperin", "galperin:n=2", 314),
    Subject("cradle", "cradle", 60, symbolic=True),
    Subject("pinball", "pinball", 20),
    Subject("lorentz", "lorentz", 20),
    Subject("near-tie", "near-tie:k=12", 4, symbolic=True),
    Subject("thousand-discs", "gas:n=1000,seed=1", 100, CROWD),
)
"""Every scene. A new one is one line here."""


def subjects(only: Sequence[str] = ()) -> tuple[Subject, ...]:
    """All, or those named.

    Raises:
        SceneError: for an unknown name.

    >>> [subject.name for subject in subjects(["cradle", "gas"])]
    ['gas', 'cradle']
    """
    names = [subject.name for subject in SUBJECTS]
    for name in only:
        if name not in names:
            raise SceneError(f"--scenes {name!r}: is none of this table's; {suggestion(name, names)}")
    return tuple(subject for subject in SUBJECTS if not only or subject.name in only)


def digest_of(subject: Subject) -> str | None:
    """What tells its scene from another; None where it cannot be built."""
    try:
        return scene_from(subject.spec).digest
    except SceneError:
        return None


def settings_of(subject: Subject, only: Sequence[str] = ()) -> tuple[str, ...]:
    """The settings of a scene, those asked for, or all: with every other engine that there is.

    >>> settings_of(SUBJECTS[0], ["double"])
    ('double',)
    """
    if only:
        return tuple(only)
    named = {text.partition(":")[0] for text in (*SETTINGS, "exact")}
    others = [name for name in (*ENGINES, *offered()) if name not in named]
    return (*subject.settings, *others)


# -- a row each

ALL_DIGITS = 1_000.0
"""Beyond so many digits a row says "all": the rest depends on how far one looks."""

MOST_WORK = 8_000_000
"""Counted work of the longest run that the table gives to one row: some ten seconds of pymunk."""


STEADY = 1.05
"""Processes are started until the two fastest differ by no more than this."""

REST = Fraction(17, 16)
"""A scene that comes to rest is run to so many times the time of its last event."""

COLUMNS = (
    "index", "scene", "digest", "engine", "verdict", "note", "agreed", "events", "error", "digits", "changed",
    "laws", "seconds", "loops", "ratio", "spread", "memory", "front",
)  # fmt: skip
"""What a report has of each row."""


def steady(row: Row) -> bool:
    """Whether two processes took the same time."""
    return row.refused is not None or (row.spread is not None and row.spread <= UNEVEN)


def digits_shown(digits: float | None) -> float | str | None:
    """Digits as people are shown them: to a tenth, rounded down; `all` beyond what anyone asks for.

    >>> digits_shown(7.39), digits_shown(1000.0), digits_shown(None), digits_shown(-3.0)
    (7.3, 'all', None, 0.0)
    """
    if digits is None:
        return None
    return "all" if digits >= ALL_DIGITS else max(math.floor(10 * digits) / 10, 0.0)


def law_shown(row: Row) -> str:
    """What the audit of every step says, as people are shown it; nothing where there was none.

    >>> [law_shown(Row(0, "gas", "double", "agree", laws=laws)) for laws in
    ...  (None, {"kept": True, "finding": ""}, {"kept": False, "finding": "restitution 0.98 fits 25 of 25 impacts"})]
    ['', 'kept', 'not kept: restitution 0.98 fits 25 of 25 impacts']
    """
    if row.laws is None:
        return ""
    verdict = {True: "kept", False: "not kept", None: "not determined"}[row.laws["kept"]]
    return f"{verdict}: {row.laws['finding']}" if row.laws["finding"] else verdict


@dataclass(frozen=True)
class TradeoffJob:
    """One engine at one setting on one scene, in processes of its own."""

    index: int
    subject: Subject
    engine: str
    processes: tuple[int, int]

    @property
    def label(self) -> str:
        """Scene and engine."""
        return f"{self.subject.name}, {self.engine}"

    def rows(self) -> list[Row]:
        """The row; its ratio and whether it is on the front are known once all of its scene are there."""
        blank = Row(self.index, self.subject.name, self.engine, "refused", digest=digest_of(self.subject))
        try:
            study = study_of(self.subject)
            blank = replace(blank, events=len(study.reference.events))
            engine = engine_named(self.engine)
            _check_affordable(self.subject, study, engine)
            row = _checked(blank, study, engine)
        except SceneError as error:
            return [replace(blank, note=str(error))]
        if row.refused is not None:
            return [row]
        try:
            found = self._measured(str(study.reference.final_time))
        except RuntimeError as error:
            return [replace(blank, note=f"its process ended: {error}")]
        ratios = sorted(process.ratio for process in found)
        best = min(found, key=lambda process: process.ratio)
        known = [process.memory for process in found if process.memory is not None]
        samples = {
            "runs": [[took.wall, took.cpu] for process in found for took in process.runs],
            "loops": [[took.wall, took.cpu] for process in found for took in process.loops],
        }
        return [
            replace(
                row,
                seconds=min(took.cpu for took in best.runs),
                loops=ratios[0],
                spread=ratios[1] / ratios[0] if len(ratios) > 1 else None,
                memory=max(known, default=None),
                samples=samples,
            )
        ]

    def _measured(self, until: str) -> list[MeasuredProcess]:
        from .measured import measure

        spec, (least, most) = self.subject.spec, self.processes
        found = [measure(spec, self.engine, until) for _ in range(least)]
        while len(found) < most:
            fastest, second, *_ = sorted(process.ratio for process in found) if len(found) > 1 else (1.0, math.inf)
            if second <= STEADY * fastest:
                break
            found.append(measure(spec, self.engine, until))
        return found


@dataclass(frozen=True)
class TradeoffPlan:
    """For each scene the exact engine's row, then one for each setting, all to one time between two exact events."""

    subjects: tuple[Subject, ...]
    engines: tuple[str, ...] = ()
    processes: tuple[int, int] = (LEAST_PROCESSES, MOST_PROCESSES)

    apart = False

    @cached_property
    def pairs(self) -> list[tuple[Subject, str]]:
        """Each scene and each of its engines."""
        return [(one, text) for one in self.subjects for text in ("exact", *settings_of(one, self.engines))]

    @property
    def settings(self) -> dict[str, Any]:
        """As a store keeps them: it is of one machine."""
        return {"grid": "table of run time against error", "versions": versions(), "machine": computer(),
                "scenes": [one.name for one in self.subjects], "engines": list(self.engines),
                "processes": list(self.processes)}  # fmt: skip

    def indices(self) -> range:
        """Of the pairs."""
        return range(len(self.pairs))

    def key(self, index: int) -> str:
        """The digest of the scene, and the engine."""
        subject, text = self.pairs[index]
        return f"{digest_of(subject)} {text}"

    def job(self, index: int) -> TradeoffJob:
        """Of one pair."""
        return TradeoffJob(index, *self.pairs[index], self.processes)


def tradeoffs(
    chosen: Iterable[Subject],
    engines: Sequence[str] = (),
    *,
    processes: tuple[int, int] = (LEAST_PROCESSES, MOST_PROCESSES),
    store: str = ":memory:",
    progress: OnDone | None = None,
) -> list[Row]:
    """Measures, one row after the other, since two at once would disturb each other.

    Args:
        engines: settings instead of the table's own.
        processes: the fewest and the most for each row; between them, until the two fastest agree.
        store: the file that keeps the rows; what is in it already is not measured again.
        progress: called after each row.

    Raises:
        SceneError: for a store of another machine, or of other scenes, and a limit out of range.
    """
    plan = TradeoffPlan(tuple(chosen), tuple(engines), processes)
    rows = Store(store, plan.settings)
    carry_out(plan, rows, jobs=1, progress=progress)
    rows.verify()
    scenes = groupby(rows, key=lambda row: row.scene)
    return [row for _, mine in scenes for row in with_front(in_exact(list(mine)))]


@lru_cache(maxsize=1)
def study_of(subject: Subject) -> Study:
    """The certified run of a subject, to a time at which rounding decides nothing.

    Raises:
        SceneError: if there is no such scene, or its certified run is not decided.
    """
    scene, truth = scene_from(subject.spec), ExactEngine()
    reference = uninterrupted(truth.run(scene, until=between_events(scene, subject.events)))
    if reference.stop.reason is not StopReason.HORIZON:
        raise SceneError(f"the certified run stops: {reference.stop.message}")
    return Study(scene, truth, reference)


def between_events(scene: Scene, events: int) -> Quantity:
    """A time half-way between an exact event and the next, so that rounding decides nothing there; a double.

    Of a scene that comes to rest before, a time a little past its last event.
    """
    found = uninterrupted(engine_named("exact").run(scene, events=events + 1)).events
    if len(found) <= events:
        last = found[-1].time if found else 1
        return Quantity.of(Fraction(float(Fraction(float(last)) * REST)))
    before, after = found[-2:]
    return Quantity.of(Fraction((float(before.time) + float(after.time)) / 2))


def _check_affordable(subject: Subject, study: Study, engine: Engine) -> None:
    """Leaves out what would take minutes.

    Raises:
        SceneError: with the reason.
    """
    if engine == study.truth:
        return
    if engine.bits is None and engine.step is None and not subject.symbolic:
        raise SceneError("not run here: it counts in expressions, and would take minutes")
    steps, work = cost(engine, RunSize.of(study.reference))
    if work > MOST_WORK:
        told = f"{work:,} units of work" + ("" if steps is None else f", {steps:,} steps")
        raise SceneError(f"not run: {told}, where this table gives {MOST_WORK:,} units to a row")


def _checked(blank: Row, study: Study, engine: Engine) -> Row:
    """The row with what the run came to, compared with the certified run."""
    if engine == study.truth:
        return replace(blank, verdict="agree", agreed=blank.events, error=0.0, digits=ALL_DIGITS, changed=[])
    expected = outcomes_of(study.reference)
    found = candidate_of(study, blank.engine, engine, expected, None, None)
    if found.unable:
        return replace(blank, note=found.trajectory.stop.message)
    end = end_error(study.reference, found.trajectory)
    return replace(
        blank,
        verdict=found.verdict,
        agreed=found.alignment.agreed,
        error=double(found.separation.maximum),
        digits=None if end is None else min(end.digits, ALL_DIGITS),
        changed=list(found.changed) if found.whole else None,
        laws=laws_brief(found.laws),
    )


def in_exact(rows: Sequence[Row]) -> list[Row]:
    """The rows of one scene with their ratios to the exact engine's."""
    exact = next((row.loops for row in rows if row.engine == "exact" and row.refused is None), None)
    return [replace(row, ratio=row.loops / exact if exact and row.loops else 0.0) for row in rows]


def with_front(rows: Sequence[Row]) -> list[Row]:
    """The rows of one scene, those marked than which none is at once as fast and as right (Pareto's front).

    Digits count as they are shown, to a tenth.

    >>> rows = [Row(0, "s", name, "agree", loops=t, digits=d) for name, t, d in
    ...         (("a", 1.0, 5.0), ("b", 2.0, 4.0), ("c", 3.0, 9.0), ("d", 0.5, None))]
    >>> [row.engine for row in with_front(rows) if row.front]
    ['a', 'c']
    """
    there = [(row.engine, row.loops or 0.0, math.floor(10 * row.digits)) for row in rows
             if row.refused is None and row.digits is not None]  # fmt: skip
    beaten = {
        name
        for name, loops, digits in there
        if any(o <= loops and d >= digits and (o, d) != (loops, digits) for _, o, d in there)
    }
    front = {name for name, _, _ in there} - beaten
    return [replace(row, front=row.engine in front) for row in rows]
