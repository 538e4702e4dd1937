"""An engine that stopped before the reference's end."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ....scenarios.trajectory import StopReason

if TYPE_CHECKING:
    from ....scenarios.engine import Engine
    from ....scenarios.trajectory import OnProgress, Trajectory
    from ...candidate import Candidate
    from ...study import Study


@dataclass(frozen=True)
class Stopped:
    """A candidate that could not decide, with what it takes to ask why."""

    study: Study
    candidate: Candidate
    engine: Engine
    progress: OnProgress | None = None

    @property
    def message(self) -> str:
        """What it said itself."""
        return self.candidate.trajectory.stop.message

    @property
    def undecided(self) -> bool:
        """Whether it is a decision that stopped it."""
        return not self.candidate.unable and self.candidate.trajectory.stop.reason is StopReason.UNDECIDED

    @property
    def widens(self) -> bool:
        """Whether it is a decision that stopped it, and wider numbers can be tried."""
        return self.undecided and self.engine.wider() is not None

    @property
    def event(self) -> int:
        """How far it came."""
        return len(self.candidate.trajectory.events)

    @property
    def reference(self) -> Trajectory:
        """The longest run of the reference."""
        return self.study.longest or self.study.reference
