"""One engine held against the certified run of one scene; why it differs is looked for afterwards, if at all."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ..comparison import candidate_of, explained, studied
from ..deadline import Clock, OutOfTime, checked_seconds
from ..engines import ENGINES, engine, label_of
from ..outcomes.outcome import outcomes_of
from ..scene_argument import scene_from
from ..validation import check_engine, check_until
from .cell import Cell, cell_of

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ..candidate import Candidate
    from ..study import Study
    from .suite import Task


@dataclass(frozen=True)
class Held:
    """An engine's run of a task's scene beside the certified one.

    Attributes:
        task: what was asked.
        engine: what was held against the truth.
        study: the certified run, and what is needed to run on.
        candidate: the engine's.
    """

    task: Task
    engine: Engine
    study: Study
    candidate: Candidate

    @property
    def cell(self) -> Cell:
        """What is told of it."""
        return cell_of(self.study, self.candidate, self.task.scene)

    def why(self, watch: Clock | None = None) -> Held:
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


def hold(task: Task, text: str, max_seconds: float | None) -> Held:
    """Runs a task's scene in the exact engine, and in one that is named as on the command line.

    Raises:
        SceneError: for a scene that the exact engine cannot run, and an engine that raises or hands back nonsense.
        OutOfTime: if the seconds are over and there is nothing of the certified run.
        KeyboardInterrupt: if the user interrupts it.
    """
    scene, truth, chosen = scene_from(task.scene), ENGINES["exact"].load()(), check_engine(engine(text))
    check_until(chosen, scene, task.until)
    study = studied(scene, truth, Clock(checked_seconds(max_seconds)), task.until, task.events)
    candidate = candidate_of(study, label_of(text), chosen, outcomes_of(study.reference), None, None)
    return Held(task, chosen, study, candidate)
