"""Runs a suite, cell by cell."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from ..adapters.adapter import NotInstalled
from ..alignment.align import VERDICTS
from ..deadline import OutOfTime
from ..engines import engine, label_of
from ..scene_argument import scene_from
from ..validation import EngineError
from .cell import Cell
from .holding import hold

if TYPE_CHECKING:
    from ..alignment.align import Verdict
    from .suite import Suite, Task

OnCell: TypeAlias = Callable[[int, int, str], None]
"""Called before each cell with how many are done, of how many, and which is next."""


@dataclass(frozen=True)
class SuiteReport:
    """What came out of a suite.

    Attributes:
        suite: its name.
        cells: one for each engine on each scene, in order.
        max_seconds: what a cell was allowed, if the user set it.
    """

    suite: str
    cells: tuple[Cell, ...]
    max_seconds: float | None = None

    @property
    def verdict(self) -> Verdict:
        """The first of `diverged`, `unsettled`, `undecided`, `agree` that holds for any cell."""
        verdicts = {cell.verdict for cell in self.cells} or {"agree"}
        return next(verdict for verdict in VERDICTS if verdict in verdicts)

    @property
    def lawless(self) -> int:
        """How many cells are of an engine whose steps do not keep the laws, whatever its history."""
        return sum(cell.lawless for cell in self.cells)


def run_suite(suite: Suite, *, max_seconds: float | None = None, progress: OnCell | None = None) -> SuiteReport:
    """Every engine of every scene, held against the certified run.

    Args:
        max_seconds: what one cell may take, the causes included.

    Raises:
        SceneError: for a scene that the reference cannot run, and an engine that is not installed.
        KeyboardInterrupt: if the user interrupts it.
    """
    todo = [(task, text) for task in suite.tasks for text in task.engines]
    cells: list[Cell] = []
    for task, text in todo:
        if progress is not None:
            progress(len(cells), len(todo), f"{task.scene}: {label_of(text)}")
        cells.append(run_cell(task, text, causes=suite.causes, max_seconds=max_seconds))
    return SuiteReport(suite.name, tuple(cells), max_seconds)


def run_cell(task: Task, text: str, *, causes: bool, max_seconds: float | None) -> Cell:
    """One engine on one scene; one that raises, or hands back nonsense, has a cell that says so."""
    try:
        held = hold(task, text, max_seconds)
        return (held.why() if causes else held).cell
    except NotInstalled:
        raise
    except (EngineError, OutOfTime) as error:
        return broken(task, text, str(error))


def broken(task: Task, text: str, reason: str) -> Cell:
    """The cell of an engine that raised, or handed back nonsense."""
    settings = {key: str(value) for key, value in getattr(engine(text), "parameters", {}).items()}
    return Cell(
        scene=task.scene,
        digest=scene_from(task.scene).digest,
        engine=label_of(text),
        settings=settings,
        verdict="undecided",
        agreed=0,
        events=0,
        divergence=None,
        cause=None,
        changed=(),
        drift=None,
        stop=reason,
        unable=False,
        seconds=0.0,
    )
