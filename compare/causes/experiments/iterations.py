"""The iterations of an engine's solver."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ...alignment.walk import REPEATED
from ...deadline import NO_TIME
from ...foreign.guard import firmer_of
from ...study import series_steps
from ..diagnosis import CauseName, Experiment
from ..laboratory.variants import gone

if TYPE_CHECKING:
    from ..laboratory.laboratory import Laboratory
    from ..so_far import SoFar

CAUSE = CauseName["ITERATIONS"]


def iterations(lab: Laboratory, found: SoFar) -> list[Experiment]:
    """Four times as many, for an engine that takes steps."""
    if lab.engine.step is None:
        return []
    return [lab.tried(lambda: _iterations(lab), Experiment(CAUSE, NO_TIME))]


def _iterations(lab: Laboratory) -> Experiment:
    """The solver's iterations doubled, twice over."""
    more = firmer_of(lab.engine)
    if more is None:
        return Experiment(CAUSE, "it iterates nothing", None, False)
    last = lab.divergence.time + REPEATED * (lab.engine.step or 0.0)
    earlier = [e for e in lab.candidate.trajectory.events if float(e.time) <= last]
    if not any(len(e.contacts) > 1 for e in earlier):
        return Experiment(CAUSE, "no step had several contacts", None, False)
    more = firmer_of(more) or more
    until = lab.until(lab.engine.step)
    most = series_steps(lab.engine)
    if until > most * (lab.engine.step or math.inf):
        return Experiment(CAUSE, f"not tried: it takes more than {most:,} steps")
    run = lab.run(more, lab.study.scene, until)
    agrees = gone(lab, run, more.step)
    return Experiment(CAUSE, f"with four times as many it {'agrees' if agrees else 'differs too'}", None, agrees)
