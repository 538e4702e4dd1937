"""A time step: halved again and again."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flint import arb

from ....exact.numbers import ball
from ...alignment.divergence import Kind
from ...deadline import NO_TIME
from ...foreign.guard import finer_of
from ...study import finer_by, series_steps
from ..diagnosis import CauseName, Experiment
from ..laboratory.variants import gone
from .tie import resolved_otherwise

if TYPE_CHECKING:
    from ..laboratory.laboratory import Laboratory
    from ..so_far import SoFar

CAUSE = CauseName["STEP"]

MOST_HALVINGS = 8
"""A time step is halved up to so many times, as far as `series_steps` allow."""


def step(lab: Laboratory, found: SoFar) -> list[Experiment]:
    """The series of finer steps, for an engine that takes steps."""
    if lab.engine.step is None:
        return []
    tied = bool(resolved_otherwise(lab).suffices)
    row, found.finest = lab.tried(lambda: _series(lab, stays_tied=tied), (Experiment(CAUSE, NO_TIME), None))
    return [row]


def _series(lab: Laboratory, *, stays_tied: bool) -> tuple[Experiment, arb | None]:
    """The step halved again and again, as far as counted work allows; and the decision's number at the finest."""
    assert lab.engine.step is not None
    until, told, last = lab.until(lab.engine.step), [], lab.got
    agrees: list[bool] = []
    for halvings in range(1, MOST_HALVINGS + 1):
        finer = finer_by(lab.engine, halvings)
        if finer is None or finer.step is None or until > series_steps(finer) * finer.step:
            break
        run = lab.run(finer, lab.study.scene, until)
        agrees.append(gone(lab, run, finer.step))
        told.append(f"{finer.step:.3g}")
        if lab.decision is not None:
            reader = lab.reader(run, lab.given, finer.step)
            last = reader.value(lab.decision) if all(reader.follows(p) for p in lab.pairings) else None
        if agrees[-2:] == [True, True]:
            break
    if not agrees and finer_of(lab.engine) is None:
        return Experiment(CAUSE, f"not tried: {lab.name} has no finer step to offer"), None
    if not agrees:
        return Experiment(CAUSE, f"not tried: a finer step takes more than {series_steps(lab.engine):,} steps"), None
    moved = lab.moved(lab.got, last)
    within = _within_a_step(lab, lab.engine.step / 2 ** len(agrees))
    enough = (agrees[-1] or within) and not stays_tied
    if enough and not _explains(lab, moved):
        moved = None  # it is the series that tells
    runs = [f"{size} {'agrees' if flag else 'differs'}" for size, flag in zip(told, agrees, strict=True)]
    first = agrees.index(True) if True in agrees else len(agrees)
    if first > 1 and all(agrees[first:]):
        runs = [f"{told[0]} to {told[first - 1]} differs", *runs[first:]]
    if within:
        runs.append("and the two meetings are nearer than that")
    return Experiment(CAUSE, f"with a step of {', '.join(runs)}", moved, enough), last


def _explains(lab: Laboratory, moved: float | None) -> bool:
    """Whether flights that are displaced by so much decide otherwise: a step may do so without displacing them."""
    if moved is None or lab.margin is None:
        return False
    with ball.precision(4096):
        return lab.changes(lab.margin + arb(moved))


def _within_a_step(lab: Laboratory, size: float) -> bool:
    """Whether the engine takes as one what the exact motion has one after the other, nearer than a step."""
    if lab.divergence.kind is not Kind.TIE or lab.margin is None or lab.decision is None:
        return False
    return lab.decision.kind == "order" and 0 < abs(float(lab.margin.mid())) < size
