"""What a search for a setting comes to: the settings that were tried, and which is the cheapest that is right."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...scenarios.numbers.quantity import Quantity
    from ...scenarios.scene import Scene
    from ..study import Study
    from .goal import Goal, Judged
    from .ladder import Setting


class End(Enum):
    """How a search ended."""

    FOUND = "a setting is right"
    BUDGET = "the budget is spent"
    LADDER = "no costlier setting is to be had"
    REFERENCE = "the certified run itself is not decided"


@dataclass(frozen=True)
class Instance:
    """One scene on which a setting has to be right.

    Attributes:
        seed: of its velocities; None: the scene as it is.
        study: its certified run.
    """

    seed: int | None
    study: Study = field(repr=False)

    @property
    def label(self) -> str:
        """What reports call it."""
        return "the scene itself" if self.seed is None else f"perturbed {self.seed}"


@dataclass(frozen=True)
class Tried:
    """One setting, held against the certified run of some of the scenes.

    Attributes:
        setting: the setting.
        judged: what came out, by the scene's seed (None: the scene itself).
        of: how many scenes there are.
    """

    setting: Setting
    judged: dict[int | None, Judged]
    of: int

    @property
    def wrong(self) -> list[int | None]:
        """The scenes on which it is wrong, as far as it was tried."""
        return [seed for seed, told in self.judged.items() if not told.right]

    @property
    def right(self) -> bool:
        """Whether it is right on every scene."""
        return len(self.judged) == self.of and not self.wrong


@dataclass(frozen=True)
class Cost:
    """What one run of the setting over the scene took, and the certified run: seconds of this machine's processor."""

    seconds: float
    exact_seconds: float


@dataclass(frozen=True)
class Advice:
    """What a search found.

    Attributes:
        scene, goal, engine: what was asked.
        size, perturbed: of the changes of velocities; the seeds of the scenes beside this one.
        left_out: seeds of those whose certified run is not decided, so that nothing can be held against it.
        budget, spent: units of work.
        tried: every setting that was tried, cheapest first, up to the one that is right.
        end: how the search ended.
        beyond: costlier settings, tried after that.
        cost: of the setting that is right.
        why: where none is, why.
        next: where the budget ended the search, the setting that it did not suffice for.
        instances: the scenes, as far as they were needed.
    """

    scene: Scene
    goal: Goal
    engine: str
    size: Quantity
    perturbed: tuple[int, ...]
    left_out: tuple[int, ...]
    budget: int
    spent: int
    tried: tuple[Tried, ...]
    end: End
    beyond: tuple[Tried, ...] = ()
    cost: Cost | None = None
    why: tuple[str, ...] = ()
    next: Setting | None = None
    instances: tuple[Instance, ...] = field(default=(), repr=False)

    @property
    def named(self) -> Tried | None:
        """The cheapest setting that is right everywhere; None if none was found."""
        return self.tried[-1] if self.end is End.FOUND else None

    @property
    def cheaper(self) -> Tried | None:
        """The one before it: one step cheaper, and wrong; None if it is the cheapest there is."""
        return self.tried[-2] if self.end is End.FOUND and len(self.tried) > 1 else None

    @property
    def lucky(self) -> tuple[Tried, ...]:
        """Cheaper settings that are right on the scene itself, and wrong beside it."""
        cheaper = self.tried[:-1] if self.end is End.FOUND else self.tried
        return tuple(t for t in cheaper if None in t.judged and t.judged[None].right and t.wrong)

    @property
    def worse(self) -> tuple[Tried, ...]:
        """Costlier settings that are wrong."""
        return tuple(t for t in self.beyond if t.wrong)
