"""One engine compared with a reference: its run, how far it agrees, why it does not."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..scenarios.trajectory import Trajectory
    from .alignment.align import Alignment, Separation, Verdict
    from .audit.audit import Audit
    from .causes.diagnosis import Diagnosis, Margin
    from .tangent.hazard import ErrorModel


@dataclass(frozen=True)
class Candidate:
    """One engine compared with the reference.

    Attributes:
        engine: the engine as it was asked for, with its parameters.
        trajectory: its run, which goes on a little past the span compared.
        alignment: the causal comparison.
        separation: how far its circles are from the reference's, over time.
        outcomes: its outcomes over the span compared, or up to `until`.
        changed: names of the outcomes that differ from those expected.
        diagnosis: why it diverged, or could not decide; None if it agrees, or if causes were not asked for.
        margin: how close the competing events were, at a divergence.
        return_miss: after a reversal, the largest distance from the start at the return.
        seconds: wall time of the run, and of those that helped to settle it.
        processor: processor time of the run alone, in seconds.
        unable: whether the engine cannot take the scene at all.
        stepped: whether it declares a time step.
        pattern: whom each circle met, and on a table where it ended; None where its run ends before the span does.
        error: the model of its error and log2 of its unit, by what it declares; None if its numbers are exact.
        expected: the reference's outcomes over the same time as `outcomes`.
        until: where its run ends before the span does; what lies beyond is not settled. None: it tells all of the span.
        laws: whether its steps keep the laws, whatever its history; None for an engine that could not take the scene.
    """

    engine: str
    trajectory: Trajectory = field(repr=False)
    alignment: Alignment
    separation: Separation = field(repr=False)
    outcomes: Mapping[str, Any] = field(repr=False)
    changed: tuple[str, ...]
    diagnosis: Diagnosis | None = None
    margin: Margin | None = None
    return_miss: float | None = None
    seconds: float = 0.0
    processor: float = 0.0
    unable: bool = False
    stepped: bool = False
    pattern: Mapping[str, Any] | None = field(repr=False, default=None)
    error: tuple[ErrorModel, float] | None = None
    expected: Mapping[str, Any] = field(repr=False, default_factory=dict[str, Any])
    until: float | None = None
    laws: Audit | None = None

    @property
    def verdict(self) -> Verdict:
        """Whether this engine tells the reference's history."""
        return self.alignment.verdict

    @property
    def lawless(self) -> bool:
        """Whether its steps are known not to keep the laws."""
        return self.laws is not None and self.laws.kept is False

    @property
    def by_law(self) -> bool:
        """Whether a law that it does not keep is why its history differs, or may be: nothing else is known to be."""
        return self.lawless and (self.diagnosis is None or self.diagnosis.name.name in ("LAW", "UNKNOWN"))

    @property
    def right(self) -> bool:
        """Whether it agrees, and is not known to break a law."""
        return self.verdict == "agree" and not self.lawless

    @property
    def whole(self) -> bool:
        """Whether its outcomes are those of all of the span: only then are they right, or wrong."""
        return self.until is None and self.verdict in ("agree", "diverged")
