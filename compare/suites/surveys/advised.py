"""What `truebreak advise` says of an engine on a scene of the survey: the cheapest setting that is right, if any."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ....scenarios.errors import SceneError
from ...advice.goal import HistoryGoal
from ...advice.search import advise
from ...engines import engine
from ...scene_argument import scene_from

if TYPE_CHECKING:
    from ..suite import Task

BUDGET = 200_000
"""Units of work that all runs of one search may cost: up to some 30,000 time steps for the longest of them."""

PERTURBED = 2
"""Scenes beside each one on which a setting has to be right too."""


@dataclass(frozen=True)
class Advised:
    """What the search for the cheapest setting came to.

    Attributes:
        scene, engine: as the survey names them.
        setting: the engine with that setting, as the command line takes it; None if none is right.
        told: why there is none, or what it costs, in a few words.
    """

    scene: str
    engine: str
    setting: str | None
    told: str

    def data(self) -> dict[str, Any]:
        """As JSON."""
        return dataclasses.asdict(self)


def adjustable(name: str) -> bool:
    """Whether an engine has settings to choose from: a step, or bits.

    >>> adjustable("pymunk"), adjustable("interval"), adjustable("double")
    (True, True, False)
    """
    chosen: Any = engine(name)
    return any(field.name in ("dt", "bits") for field in dataclasses.fields(chosen))


def advised(task: Task, name: str) -> Advised:
    """Searches for the cheapest setting with which an engine tells the whole history of a task, and beside it."""
    try:
        goal = HistoryGoal(task.events)
        found = advise(scene_from(task.scene), goal, name, perturbed=PERTURBED, budget=BUDGET, why=False)
    except SceneError as error:
        return Advised(task.scene, name, None, str(error))
    if found.named is not None:
        return Advised(task.scene, name, found.named.setting.text, f"{found.named.setting.work:,} units of work a run")
    return Advised(task.scene, name, None, f"none of the {len(found.tried):,} settings within {BUDGET:,} units of work")
