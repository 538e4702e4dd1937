"""What was found so far at one divergence."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ..deadline import NO_TIME
from .diagnosis import CauseName, Experiment

if TYPE_CHECKING:
    from flint import arb

    from .decision.reader import RunReader


@dataclass
class SoFar:
    """What was found so far at one divergence, and what later experiments start from.

    Attributes:
        rows: the experiments, in the order in which they were tried.
        entered: reads the exact run of what the engine is given; None where there is none.
        finest: the number that decides, at the finest time step that was run.
        neither: whether each rounding was measured, and neither suffices alone.
    """

    rows: list[Experiment] = field(default_factory=list)
    entered: RunReader | None = None
    finest: arb | None = None
    neither: bool = False

    def of(self, cause: CauseName) -> Experiment:
        """The experiment on a cause that was tried before."""
        return next(row for row in self.rows if row.cause is cause)

    @property
    def enough(self) -> bool:
        """Whether something suffices already."""
        return any(row.suffices for row in self.rows)

    @property
    def cut(self) -> bool:
        """Whether the user's seconds left no time for one of them."""
        return any(row.result == NO_TIME for row in self.rows)
