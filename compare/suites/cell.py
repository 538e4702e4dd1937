"""One engine on one scene of a suite: the verdict, and what of it can be held against a later one."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

from ..files.amounts import plain
from ..files.documents import laws_brief

if TYPE_CHECKING:
    from ...scenarios.trajectory import Trajectory
    from ..alignment.align import Verdict
    from ..candidate import Candidate
    from ..study import Study


@dataclass(frozen=True)
class Cell:
    """What became of one engine on one scene.

    Attributes:
        scene: as the suite names it.
        digest: of the scene.
        engine: as the suite asks for it, or its label.
        settings: the engine's parameters, those it is built with too.
        verdict: as in a comparison.
        agreed, events: events before the first divergence, of so many of the reference's.
        divergence: event, time, body, expected, got, kind; None if there is none.
        cause: why it diverged or stopped; None if it agrees, or causes were not looked for.
        changed: names of the outcomes that differ from the reference's, over the same time.
        drift: the energy that the engine gained by the end of its run, as a share; None where it has none.
        stop: how its run ended.
        unable: whether it cannot take the scene.
        seconds: wall time of its run, and of those that helped to settle the verdict.
        until: where its run ends before the span does: outcomes are told up to there; None: over all of the span.
        laws: whether its steps `kept` the laws (None: not determined), and what is `told` of that; None: not audited.
        times: processor time of its run alone over that of the certified run made beside it; None where there is none.
    """

    scene: str
    digest: str
    engine: str
    settings: dict[str, Any]
    verdict: Verdict
    agreed: int
    events: int
    divergence: dict[str, Any] | None
    cause: str | None
    changed: tuple[str, ...]
    drift: float | None
    stop: str
    unable: bool
    seconds: float
    times: float | None = None
    until: float | None = None
    laws: dict[str, Any] | None = None

    @property
    def lawless(self) -> bool:
        """Whether its steps are known not to keep the laws."""
        return self.laws is not None and self.laws["kept"] is False

    @property
    def right(self) -> bool:
        """Whether it agrees, and is not known to break a law."""
        return self.verdict == "agree" and not self.lawless

    @property
    def key(self) -> tuple[str, str]:
        """What tells it from all others of a suite."""
        return self.scene, self.engine

    def data(self) -> dict[str, Any]:
        """As JSON."""
        return {field.name: plain(getattr(self, field.name)) for field in fields(self)}


def cell_of(study: Study, candidate: Candidate, scene: str) -> Cell:
    """The cell of an engine that was held against a scene's certified run."""
    first = candidate.alignment.divergence
    divergence = None
    if first is not None:
        divergence = {
            "event": first.event,
            "time": first.time,
            "body": first.body,
            "expected": first.expected,
            "got": first.got,
            "kind": first.kind.value,
        }
    return Cell(
        scene=scene,
        digest=study.scene.digest,
        engine=candidate.engine,
        settings=dict(plain(candidate.trajectory.parameters)),
        verdict=candidate.verdict,
        agreed=candidate.alignment.agreed,
        events=len(study.reference.events),
        divergence=divergence,
        cause=None if candidate.diagnosis is None else str(candidate.diagnosis),
        changed=candidate.changed,
        drift=None if candidate.unable else energy_drift(candidate.trajectory),
        stop=candidate.trajectory.stop.message,
        unable=candidate.unable,
        seconds=candidate.seconds,
        times=candidate.processor / study.processor if candidate.processor else None,
        until=candidate.until,
        laws=laws_brief(candidate.laws),
    )


def energy_drift(trajectory: Trajectory) -> float | None:
    """The energy gained by the end of a run, as a share of that at its start; None where there is none at all.

    >>> from truebreak.floating import DoubleEngine
    >>> from truebreak.scenarios import Circle, Scene
    >>> energy_drift(DoubleEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 0)]), until=3))
    0.0
    """
    circles = [circle for circle in trajectory.scene.circles if not circle.fixed]
    before = sum((float(c.vx) ** 2 + float(c.vy) ** 2) / float(c.inverse_mass) for c in circles)
    if not before:
        return None
    final = trajectory.final
    after = sum(
        (float(final[str(c.id)].vx) ** 2 + float(final[str(c.id)].vy) ** 2) / float(c.inverse_mass) for c in circles
    )
    return after / before - 1.0
