"""The survey: every installed engine on twelve scenes, as it comes and at its best settings."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib.util import find_spec
from typing import TYPE_CHECKING

from ...scenarios.errors import SceneError
from ..adapters.base.adapted import version_of
from ..deadline import Clock, OutOfTime
from ..engines import ENGINES, engine, suggestion
from ..scene_argument import scene_from
from ..validation import EngineError
from .holding import hold
from .running import SuiteReport, broken, run_cell
from .suite import Task
from .surveys.advised import Advised, adjustable, advised

if TYPE_CHECKING:
    from .cell import Cell
    from .holding import Held
    from .running import OnCell

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
}
"""The twelve, and how far each is followed; what each shows is told by `truebreak scenes`."""


@dataclass(frozen=True)
class Surveyed:
    """An engine of the survey.

    Attributes:
        name: as in `ENGINES`.
        module: what has to be installed for it.
        distribution: whose version is told; empty: truebreak's own.
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
    Surveyed("interval", "mpmath", "", "truebreak's own: stops where its width does not tell", "", ("", "bits=512")),
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
"""Every engine that is held against `exact`; `sympy` is left out, as it asks the same questions of SymPy, slowly."""

FIRST = Task("cradle:n=1", (), events=1)
"""What each engine plays before anything is measured: it is then loaded, and what it compiles is compiled."""

MOST_STEPS = 100_000
"""Time steps of the longest run that a setting is tried for."""


@dataclass(frozen=True)
class SurveyEntry:
    """One engine on one scene of the survey.

    Attributes:
        label: of the scene.
        tried: a cell for each setting tried, the first as the engine comes, an advised one last.
        advice: which setting is advised; None if the engine has none to choose from, or advice was not asked for.
    """

    label: str
    name: str
    tried: tuple[Cell, ...]
    advice: Advised | None = None

    @property
    def first(self) -> Cell:
        """As it comes."""
        return self.tried[0]

    @property
    def best(self) -> Cell:
        """The setting that is right, or else agrees the farthest; of those that agree as far, the first tried."""
        return max(self.tried, key=lambda cell: (cell.right, cell.verdict == "agree", cell.agreed))

    @property
    def shown(self) -> tuple[Cell, ...]:
        """The best, how it comes, and what is advised, each once."""
        setting = None if self.advice is None else self.advice.setting
        told = [cell for cell in self.tried if cell.engine == setting]
        return tuple({cell.engine: cell for cell in (self.best, self.first, *told)}.values())


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
        """All cells, as those of a suite."""
        return SuiteReport("survey", tuple(cell for entry in self.entries for cell in entry.tried), self.max_seconds)


def installed() -> tuple[Surveyed, ...]:
    """The engines that are there to be surveyed."""
    return tuple(one for one in SURVEYED if find_spec(one.module) is not None)


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


def survey(
    engines: Sequence[str] = (),
    scenes: Sequence[str] = (),
    *,
    causes: bool = True,
    advice: bool = True,
    max_seconds: float | None = None,
    progress: OnCell | None = None,
    kept: Mapping[tuple[str, str], SurveyEntry] | None = None,
    keep: Callable[[SurveyEntry], None] | None = None,
) -> Survey:
    """Runs the survey, or a part of it.

    Args:
        engines: names; all by default. Those that are not installed are left out, and named.
        scenes: labels, as in `SCENES`; all by default.
        causes: whether to find out why an engine diverged, of the settings that are shown.
        advice: whether to look for the cheapest setting that is right, as `truebreak advise` does.
        max_seconds: what one run may take, and as much again the search for its causes.
        progress: called with how many of the rows to be made are done.
        kept: rows that are there already, by label and engine: they are not made again.
        keep: called with each row as soon as it is made.

    Raises:
        SceneError: for an unknown name or label.
        KeyboardInterrupt: if the user interrupts it.
    """
    names = chosen(engines, [one.name for one in SURVEYED], "engine")
    labels = chosen(scenes, SCENES, "scene")
    there = tuple(one for one in installed() if one.name in names)
    entries = {key: entry for key, entry in (kept or {}).items() if key[0] in labels}
    todo = [(label, one) for label in labels for one in there if (label, one.name) not in entries]
    for one in there:
        if any(one is other for _, other in todo):
            run_cell(FIRST, one.name, causes=False, max_seconds=max_seconds)
    for done, (label, one) in enumerate(todo):
        told = partial(_tell, progress, done, len(todo), label)
        entry = entries[label, one.name] = _entry(label, one, causes, advice, max_seconds, told)
        if keep is not None:
            keep(entry)
    missing = tuple(name for name in names if name not in {one.name for one in there})
    return Survey(
        {one.name: installed_version(one) for one in there},
        tuple(entries[label, one.name] for label in labels for one in there),
        missing,
        max_seconds,
    )


def installed_version(one: Surveyed) -> str:
    """The version of an engine's package; nothing for truebreak's own."""
    return version_of(one.distribution) if one.distribution else ""


def _tell(progress: OnCell | None, done: int, total: int, label: str, what: str) -> None:
    if progress is not None:
        progress(done, total, f"{label}: {what}")


def _entry(
    label: str, one: Surveyed, causes: bool, advice: bool, max_seconds: float | None, told: Callable[[str], None]
) -> SurveyEntry:
    """One engine on one scene: its ladder up to what agrees, what is advised, and why what is shown diverged."""
    task = SCENES[label]
    tried: dict[str, Tried] = {}
    for text in texts(one, label):
        if any(before.cell.right for before in tried.values()):
            break
        told(text)
        tried[text] = _try(task, text, max_seconds)
    found = None
    if advice and adjustable(one.name) and not tried[one.first].cell.unable:
        told(f"{one.name}, advice")
        found = advised(task, one.name)
        if found.setting is not None and found.setting not in tried:
            tried[found.setting] = _try(task, found.setting, max_seconds)
    entry = SurveyEntry(label, one.name, tuple(row.cell for row in tried.values()), found)
    if not causes:
        return entry
    shown = {cell.engine for cell in entry.shown}
    for row in tried.values():
        if row.cell.engine in shown and row.held is not None and row.cell.verdict in ("diverged", "undecided"):
            told(f"why {row.cell.engine}")
            row.cell = replace(row.cell, cause=_why(row.held, max_seconds))
    return replace(entry, tried=tuple(row.cell for row in tried.values()))


@dataclass
class Tried:
    """One setting on one scene: what is told of it, and what was run, unless the engine could not."""

    cell: Cell
    held: Held | None = None


def _why(held: Held, max_seconds: float | None) -> str | None:
    """The cause, or what stands in the way of one."""
    try:
        found = held.why(Clock(max_seconds)).cell.cause
    except EngineError as error:
        return f"not found: {error}"
    return found or (None if max_seconds is None else f"not found within {max_seconds:g} s")


def _try(task: Task, text: str, max_seconds: float | None) -> Tried:
    try:
        held = hold(task, text, max_seconds)
    except (EngineError, OutOfTime) as error:
        return Tried(broken(task, text, str(error)))
    return Tried(held.cell, None if held.candidate.unable else held)


def texts(one: Surveyed, label: str) -> list[str]:
    """The engine at the settings to try on a scene: those of its ladder that take no more than `MOST_STEPS` steps."""
    task = SCENES[label]
    scene = scene_from(task.scene)
    listed = one.texts
    stepped = engine(listed[0]).step is not None
    if not stepped or len(listed) == 1:
        return listed
    from ..deadline import uninterrupted

    run = uninterrupted(ENGINES["exact"].load()().run(scene, until=task.until, events=task.events))
    end = float(run.final_time)
    return [text for number, text in enumerate(listed) if not number or end <= MOST_STEPS * (engine(text).step or 0.0)]
