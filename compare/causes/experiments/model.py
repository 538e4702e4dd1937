"""Another law: what is left where nothing else suffices."""

from __future__ import annotations

from statistics import median
from typing import TYPE_CHECKING

from ...alignment.separation import separation
from ...study import SERIES_STEPS, finer_by
from ..diagnosis import CauseName, Experiment
from ..laboratory.laboratory import LEAST_ROUNDING, REORDERED

if TYPE_CHECKING:
    from ..laboratory.laboratory import Laboratory
    from ..so_far import SoFar

CAUSE = CauseName["MODEL"]


MOST_HALVINGS = 4

NEARER = 0.5
"""What is left, at most, of the distance of an engine whose law is right, where its step is a half or less."""


def comes_nearer(lab: Laboratory) -> bool:
    """Whether a shorter step brings the engine nearer to the exact motion before the divergence.

    A law of its own would stay. Looked at while its circles are within a radius of the exact ones: farther off, where
    they are says nothing of the step any more.
    """
    until, radius = lab.divergence.time, min((float(c.r) for c in lab.study.scene.circles if not c.point), default=1.0)
    for halvings in range(MOST_HALVINGS, 0, -1):
        finer = None if lab.engine.step is None else finer_by(lab.engine, halvings)
        if finer is None or finer.step is None or until > SERIES_STEPS * finer.step:
            continue
        runs = lab.candidate.trajectory, lab.run(finer, lab.study.scene, until)
        own, closer = (separation(lab.reference, run, min(until, float(runs[1].final_time))).largest for run in runs)
        least = LEAST_ROUNDING * REORDERED * lab.scale
        shares = [b / a for a, b in zip(own, closer, strict=True) if least < a < radius]
        return bool(shares) and median(shares) <= NEARER
    return False


def model(lab: Laboratory, found: SoFar) -> list[Experiment]:
    """The engine's law, where all else was tried."""
    needed = (CauseName["STEP"], CauseName["INPUT"])
    if found.enough:
        return [Experiment(CAUSE, "not tried: something else suffices")]
    if lab.study.truth.rounds_input:
        told = (
            f"not tried: {lab.study.truth.name}, the reference, rounds too: what it has otherwise may be its own error"
        )
        return [Experiment(CAUSE, told)]
    if found.cut or any(row.suffices is None and row.cause in needed for row in found.rows):
        return [Experiment(CAUSE, "not tried: what else there could be was not all tried")]
    if lab.changes(lab.got) and lab.tried(lambda: comes_nearer(lab), False):
        return [Experiment(CAUSE, "not shown: a shorter step brings its places nearer to the exact ones before")]
    laws = lab.candidate.laws
    if laws is not None and laws.kept and lab.engine.step is None:
        return [Experiment(CAUSE, "no: every step keeps the law", None, False)]
    moved = lab.moved(lab.got, lab.margin)
    return [Experiment(CAUSE, "no rounding, no step and no tie explains it: its law differs", moved, True)]
