"""Two runs of a known scene: how fast differences grow there by certificate, and whether each run keeps the law."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, TypedDict

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory
    from ..foreign.recording import Recording


@dataclass(frozen=True)
class Audited:
    """Whether one run keeps the law: yes, no, or None where that is not known; and a sentence."""

    log: str
    kept: bool | None
    sentence: str


class LogAuditRow(TypedDict):
    """Whether one run keeps the law.

    Attributes:
        log: its log.
        kept: whether it does; null: not determined.
        sentence: in words.
    """

    log: str
    kept: bool | None
    sentence: str


class LawfulDocument(TypedDict):
    """What is known where both logs are of one scene.

    Attributes:
        scene: its name.
        sentence: what the audits come to.
        events: over how many events growth is certified.
        growth_bits: bounds of the growth in bits; null: not certified.
        audits: whether each run keeps the law.
    """

    scene: str
    sentence: str
    events: int
    growth_bits: list[float] | None
    audits: list[LogAuditRow]


@dataclass(frozen=True)
class Lawful:
    """What a scene says of two runs.

    Attributes:
        scene: its name.
        events: of the certified run, over which growth was measured.
        growth: bits an event by which a difference grows there, as certified; None where that is not known.
        audits: of each run.
        grew: whether they part by a difference that grew from rounding.
        tie: the contacts of the instant at which they first differ, where that has several; "" elsewhere.
    """

    scene: str
    events: int
    growth: tuple[float, float] | None
    audits: tuple[Audited, ...]
    grew: bool = False
    tie: str = ""

    @property
    def sentence(self) -> str:
        """What the audits come to."""
        broken = [audit for audit in self.audits if audit.kept is False]
        if broken:
            return "; ".join(f"{audit.log} does not keep the law: {audit.sentence}" for audit in broken)
        if all(audit.kept for audit in self.audits):
            if self.tie:
                return f"both keep the law; they first differ at {self.tie}: each may take these in its own order"
            return "both keep the law" + ("; where they part, they part as runs do that round" if self.grew else "")
        return "; ".join(f"{audit.log}: {audit.sentence}" for audit in self.audits)

    def lines(self) -> Iterator[str]:
        """For a report."""
        yield self.sentence
        if self.growth is not None:
            low, high = self.growth
            yield (
                f"certified growth in {self.scene}: {low / self.events:.3g} to {high / self.events:.3g} bits an event "
                f"over its first {self.events} events"
            )

    def data(self) -> LawfulDocument:
        """As JSON."""
        return {
            "scene": self.scene,
            "sentence": self.sentence,
            "events": self.events,
            "growth_bits": None if self.growth is None else list(self.growth),
            "audits": [{"log": a.log, "kept": a.kept, "sentence": a.sentence} for a in self.audits],
        }


MOST_EVENTS = 200
"""Events over which growth is certified: beyond the horizon of doubles in most scenes of the catalogue."""


def lawful_runs(
    one: str | Path, other: str | Path, scene: Scene, grew: bool = False, begun: Sequence[float | None] = ()
) -> Lawful:
    """Certified growth of a scene, and the audit of two logs of it.

    Args:
        grew: whether their difference grew from rounding, as far as the logs show.
        begun: by the clock of each, the instant at which they first differ, where that is known.

    Raises:
        EngineError: for a log that is none of this scene.
    """
    from ...exact.exact_engine import ExactEngine
    from ..foreign.log_engine import read_log
    from ..tangent.growth import certified_growth
    from ..tangent.impacts import NoTangentMap

    recordings = [read_log(path, scene) for path in (one, other)]
    runs = [recording.trajectory() for recording in recordings]
    events = max(1, min(MOST_EVENTS, *(len(run.events) for run in runs)))
    reference = ExactEngine().run(scene, events=events)
    events = len(reference.events)
    try:
        found = certified_growth(reference, events) if events else None
    except NoTangentMap:  # nearby runs part at an instant of several contacts, or at a graze
        found = None
    audits = tuple(audited(str(path), told) for path, told in zip((one, other), recordings, strict=True))
    growth = None if found is None else (found.low, found.high)
    return Lawful(scene.name, events, growth, audits, grew, "" if grew else _tie(runs, begun))


def _tie(runs: Sequence[Trajectory], begun: Sequence[float | None]) -> str:
    """The contacts of the instant at which two runs first differ, where several share a circle in one of them."""
    moving = {str(circle.id) for circle in runs[0].scene.circles if not circle.fixed}
    for run, time in zip(runs, begun, strict=False):
        pairs = list(dict.fromkeys(pair for e in run.events if float(e.time) == time for pair in e.impulses))
        met = [name for pair in pairs for name in {*map(str, pair)} & moving]
        if len(met) > len({*met}):
            return f"an instant of several contacts ({', '.join(' and '.join(map(str, pair)) for pair in pairs)})"
    return ""


def audited(log: str, recording: Recording) -> Audited:
    """Whether one run of a scene keeps the law, step by step (docs/audit.md)."""
    from ..audit.audit import audit_run
    from ..foreign.log_engine import LogEngine

    found = audit_run(recording.trajectory(), LogEngine(recording, log))
    told, total = found.finding, sum(found.counts.values())
    if total > 1:
        first = "" if found.fit is None or found.first is None else f", first at t = {found.first.time:.9g}"
        told += f"; {total:,} steps miss it{first}"
    return Audited(log, found.kept, told if found.kept is False else found.sentence)
