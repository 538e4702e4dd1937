"""Engines and settings that are run in place of those that diverge: is one of them right, and at what cost?"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .alignment.align import align
from .causes.diagnosis import CauseName
from .deadline import OutOfTime
from .engines import ENGINES, parsed_settings
from .engines import engine as engine_named
from .foreign.guard import finer_of
from .study import finer_by, run_or_unable

if TYPE_CHECKING:
    from ..scenarios.engine import Engine
    from ..scenarios.trajectory import OnProgress
    from .candidate import Candidate
    from .study import Study

MOST_WORK = 20_000
"""Circles times circles and events up to which wider numbers are run: well under a second."""

MOST_STEPS = 200_000
"""Time steps of the runs with finer steps, together."""

MOST_HALVINGS = 6
"""A time step is halved up to so many times."""

QUAD, QUAD_BITS = "quad", 106
"""The engine of the widest numbers that do not prove what they decide, and their bits."""

LEAST_SECONDS = 0.01
"""Of two runs that both took less processor time than this no ratio is told: it would be another the next time."""

PAST = 2.0
"""A finer step is run to so many times the divergence."""


@dataclass(frozen=True)
class Alternative:
    """An engine with its settings that was run, and how far it is right.

    Attributes:
        engine: the engine as the command line takes it.
        beside: the engine compared in whose place it was run; empty for one of those compared, and the reference.
        agreed: events of the reference that it has before its first divergence, or its end.
        right: whether it agrees to the end of all that was compared, and is not known to break a law.
        ended: whether `agreed` is where the run was ended, not where it diverged.
        processor: processor time of its run, in seconds; 0 where that is not known.
        steps: how many times as many time steps it takes as the engine beside which it was run; None where it has none.
    """

    engine: str
    beside: str
    agreed: int
    right: bool
    ended: bool = False
    processor: float = 0.0
    steps: float | None = None

    def cost(self, candidate: Candidate) -> float | None:
        """What it costs as a multiple of an engine: in time steps beside that engine, else in processor time."""
        if self.steps is not None:
            return self.steps if self.beside == candidate.engine else None
        mine, theirs = self.processor, candidate.processor
        return mine / theirs if mine > 0 and theirs > 0 and max(mine, theirs) > LEAST_SECONDS else None


def alternatives_of(
    study: Study, candidate: Candidate, engine: Engine, progress: OnProgress | None = None
) -> list[Alternative]:
    """What is run in place of an engine that diverged: wider numbers, or a finer time step where a step is to blame.

    Nothing is tried for an engine that does not keep the law: no setting mends that.
    """
    parted = candidate.alignment.divergence
    if parted is None or candidate.lawless or candidate.unable:
        return []
    try:
        if engine.step is not None:
            return list(_finer(study, candidate, engine, progress))
        return list(_wider(study, candidate, engine, progress))
    except OutOfTime:
        return []


def _wider(study: Study, candidate: Candidate, engine: Engine, progress: OnProgress | None) -> Iterator[Alternative]:
    """Quadruple precision, in place of fewer bits."""
    circles, events = len(study.scene.circles), len(study.reference.events)
    if not engine.bits or engine.bits >= QUAD_BITS or circles * (circles + events) > MOST_WORK:
        return
    _, alignment, unable = run_or_unable(study, engine_named(QUAD), progress)
    if not unable:
        right, ended = alignment.verdict == "agree", alignment.divergence is None
        yield Alternative(QUAD, candidate.engine, alignment.agreed, right, ended, study.took)


def _finer(study: Study, candidate: Candidate, engine: Engine, progress: OnProgress | None) -> Iterator[Alternative]:
    """The coarsest of the halved steps that passes the divergence, where a finer step is known to."""
    parted, found = candidate.alignment.divergence, candidate.diagnosis
    assert parted is not None
    tried = [] if found is None else [e for e in found.experiments if e.cause is CauseName["STEP"]]
    if not engine.step or not any(e.suffices for e in tried):
        return
    end = study.past(study.span.time if math.isfinite(study.span.time) else float(study.reference.final_time))
    until, left = min(end, PAST * parted.time + engine.step), MOST_STEPS
    for halvings in range(1, MOST_HALVINGS + 1):
        finer = finer_by(engine, halvings)
        left -= math.ceil(until / finer.step) if finer is not None and finer.step else left + 1
        if finer is None or left < 0:
            return
        run = study.run(finer, study.scene, until, progress)
        alignment = align(study.reference, run, span=study.span, step=finer.step, bits=engine.bits)
        other = alignment.divergence
        if other is None or other.event > parted.event:
            text = finer_text(candidate.engine, engine, finer, halvings)
            right = alignment.verdict == "agree" and until >= end
            yield Alternative(text, candidate.engine, alignment.agreed, right, other is None, steps=2.0**halvings)
            return


def finer_text(text: str, engine: Engine, finer: Engine, halvings: int) -> str:
    """The engine with a finer step as the command line takes it, where it is one of the table with a `dt`.

    >>> coarse = engine_named("pymunk:iterations=30")
    >>> finer_text("pymunk:iterations=30", coarse, finer_by(coarse, 3), 3)
    'pymunk:iterations=30,dt=1/2048'
    """
    name, _, given = text.partition(":")
    known = (
        name in ENGINES and dataclasses.is_dataclass(engine) and "dt" in {f.name for f in dataclasses.fields(engine)}
    )
    if not known or finer_of(engine) is None:
        return f"{text}, step halved {halvings} time{'s' * (halvings != 1)}"
    from fractions import Fraction

    step = Fraction(finer.step or 0.0)
    near = step.limit_denominator(10**6)
    settings = {**parsed_settings(f"engine {name!r}", given), "dt": str(near if float(near) == float(step) else step)}
    return f"{name}:" + ",".join(f"{key}={value}" for key, value in settings.items())
