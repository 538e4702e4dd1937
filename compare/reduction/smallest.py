"""What a search for the smallest scene comes to."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING

from .parts import length

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ..candidate import Candidate
    from ..comparison import Comparison


class End(Enum):
    """Why a search ended; the value is what a person reads."""

    MINIMAL = "1-minimal: nothing more can be left out by itself"
    RUNS = "the limit on comparisons was reached: more might be left out"
    SECONDS = "the seconds were over: more might be left out"
    INTERRUPTED = "interrupted: more might be left out"


@dataclass(frozen=True)
class Reduction:
    """One scene that still shows a divergence, or a law not kept, and what was left out for it.

    Attributes:
        kind: what was left out: circles, walls, pockets, settings, events or digits.
        removed: ids of things, names of settings, `ID.KEY` of numbers that were rounded; of events, where the run ends.
        comparison: of what is left: the engine held against the certified run.
        runs: comparisons made by then.
    """

    kind: str
    removed: tuple[str, ...]
    comparison: Comparison = field(repr=False)
    runs: int

    @property
    def told(self) -> str:
        """What was left out, in words.

        >>> Reduction("circles", ("a", "b"), None, 3).told, Reduction("events", ("12",), None, 4).told
        ('circles a, b', 'events after 12')
        >>> Reduction("circles", ("a",), None, 5).told
        'circle a'
        """
        if self.kind == "events":
            return f"events after {self.removed[0]}"
        if self.kind == "digits":
            return f"digits of {', '.join(self.removed)}"
        return f"{self.kind if len(self.removed) > 1 else self.kind.removesuffix('s')} {', '.join(self.removed)}"


@dataclass(frozen=True)
class SceneSize:
    """How large a scene is: its things, the limit on its instants, the characters of its numbers."""

    circles: int
    walls: int
    pockets: int
    events: int | None
    characters: int

    @staticmethod
    def of(scene: Scene) -> SceneSize:
        """The size of a scene."""
        return SceneSize(len(scene.circles), len(scene.walls), len(scene.pockets), scene.events, length(scene))


@dataclass(frozen=True)
class Smallest:
    """The smallest scene found on which an engine diverges, or breaks a law.

    Attributes:
        original: the scene that it comes from, with the limits that were asked for.
        comparison: of the smallest scene: the engine held against the certified run.
        steps: what was left out, in this order.
        runs: comparisons made in the search; one more, of the last scene, tells its cause.
        end: why the search ended.
        law: whether it was for a law not kept, and not for a divergence.
    """

    original: Scene = field(repr=False)
    comparison: Comparison
    steps: tuple[Reduction, ...] = field(repr=False)
    runs: int
    end: End
    law: bool = False

    @property
    def scene(self) -> Scene:
        """The smallest scene; its limits are its own, so that `compare` needs none."""
        return self.comparison.scene

    @property
    def minimal(self) -> bool:
        """Whether it is 1-minimal: without any one circle, wall, pocket, setting, its last event, or the digits that
        any one number has beyond the next shorter rounding, the divergence (or the breach of the law) is gone, or the
        scene is none."""
        return self.end is End.MINIMAL

    @property
    def candidate(self) -> Candidate:
        """The engine's side of the comparison."""
        return self.comparison.candidates[0]
