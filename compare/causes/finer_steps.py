"""Engines of time steps: whether a finer step or more iterations pass the divergence, and whether circles tunnel."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from ..alignment.align import align
from ..alignment.instants import NEARER, Kind, instants, velocity_difference
from ..alignment.walk import REPEATED
from ..audit.passages import passes_between
from ..deadline import NO_TIME
from ..foreign.guard import finer_of, firmer_of
from ..study import finer_by, series_steps
from .diagnosis import CauseName, Diagnosis, Experiment, diagnosed
from .laboratory import decisions

if TYPE_CHECKING:
    from ...scenarios.trajectory import Trajectory
    from ..alignment.align import Alignment
    from .laboratory import Laboratory

MOST_HALVINGS = 8
"""A time step is halved up to so many times, as far as `series_steps` allow."""


def by_finer_steps(lab: Laboratory, told: str) -> Diagnosis:
    """Why two histories part, of an engine of steps in a scene of which there is no account: what runs show alone.

    Args:
        told: why there is no account.
    """
    lab.accounted = told
    rows: list[Experiment] = []
    for name, function in (("STEP", step), ("ITERATIONS", iterations)):
        rows += lab.tried(partial(function, lab, rows), [Experiment(CauseName[name], NO_TIME)])
    found = diagnosed(rows, None, None, 0)
    unknown = CauseName["UNKNOWN"]
    if found.name is not unknown:
        return found
    return Diagnosis((unknown,), (*rows, Experiment(unknown, told, None, True)), told)


def step(lab: Laboratory, rows: Sequence[Experiment]) -> list[Experiment]:
    """The step halved again and again, for an engine that takes steps, as far as counted work allows."""
    if lab.engine.step is None:
        return []
    until, told = lab.until(lab.engine.step), list[str]()
    agrees: list[bool] = []
    for halvings in range(1, MOST_HALVINGS + 1):
        finer = finer_by(lab.engine, halvings)
        if finer is None or finer.step is None or until > series_steps(finer) * finer.step:
            break
        run = lab.run(finer, lab.study.scene, until)
        agrees.append(gone(lab, run, finer.step))
        told.append(f"{finer.step:.3g}")
        if agrees[-2:] == [True, True] and not _by_chance(lab):
            break
    if not agrees and finer_of(lab.engine) is None:
        return [Experiment(CauseName["STEP"], f"not tried: {lab.name} has no finer step to offer")]
    if not agrees:
        why = f"a finer step takes more than {series_steps(lab.engine):,} steps"
        return [Experiment(CauseName["STEP"], f"not tried: {why}")]
    first = agrees.index(True) if True in agrees else len(agrees)
    enough = agrees[-1] and (all(agrees[first:]) or not _by_chance(lab))
    runs = [f"{size} {'agrees' if flag else 'differs'}" for size, flag in zip(told, agrees, strict=True)]
    if first > 1 and all(agrees[first:]):
        runs = [f"{told[0]} to {told[first - 1]} differs", *runs[first:]]
    return [Experiment(CauseName["STEP"], f"a step of {', '.join(runs)}", None, enough)]


def _by_chance(lab: Laboratory) -> bool:
    """Whether finer steps that agree may do so by chance: rounding decides, and what is of the step does not."""
    account = lab.accounted
    return not isinstance(account, str) and lab.margin is not None and account.is_of_rounding(float(lab.margin.mid()))


def iterations(lab: Laboratory, rows: Sequence[Experiment]) -> list[Experiment]:
    """Four times as many iterations of the solver, and sixteen, for an engine that takes steps."""
    cause, more = CauseName["ITERATIONS"], firmer_of(lab.engine)
    if lab.engine.step is None:
        return []
    if more is None:
        return [Experiment(cause, "it iterates nothing", None, False)]
    last = lab.divergence.time + REPEATED * lab.engine.step
    earlier = [e for e in lab.candidate.trajectory.events if float(e.time) <= last]
    laws = lab.candidate.laws
    iterated = laws is not None and any(defect.kind == "iterations" for defect in laws.defects)
    if not iterated and not any(len(e.contacts) > 1 for e in earlier):
        return [Experiment(cause, "no step had several contacts", None, False)]
    until, most = lab.until(lab.engine.step), series_steps(lab.engine)
    if until > most * lab.engine.step:
        return [Experiment(cause, f"not tried: it takes more than {most:,} steps")]
    told, agrees = list[str](), False
    for times in ("four", "sixteen"):
        more = firmer_of(firmer_of(more) or more) or more if told else firmer_of(more) or more
        agrees = gone(lab, lab.run(more, lab.study.scene, until), more.step)
        told.append(f"with {times} times as many it {'agrees' if agrees else 'differs too'}")
        if agrees:
            break
    return [Experiment(cause, ", ".join(told), None, agrees)]


def tunnelling(lab: Laboratory, rows: Sequence[Experiment]) -> list[Experiment]:
    """Whether two that should meet overlap between two ends of steps, or have come as near as they do by the later."""
    cause, step = CauseName["TUNNELLING"], lab.engine.step
    if step is None:
        return []
    missed = [d for d in decisions(lab.reference, lab.candidate.trajectory, lab.candidate.alignment) if d.kind == "hit"]
    for decision in missed:
        if decision.first.partner != lab.divergence.expected:
            continue
        stay = lab.own.stay(decision.first)
        if stay is None or not math.isfinite(stay[1]):
            continue
        enter, leave = stay
        if lab.divergence.got_time is not None and lab.divergence.got_time < enter:
            continue  # what it has too much comes before
        base = 0.0
        reversal = lab.candidate.trajectory.reversal
        if reversal is not None and lab.study.scene.reverse_at is not None and float(reversal.time) < enter:
            base = float(reversal.time)
        body, partner = decision.first.body, decision.first.partner
        told, through = f"{body} and {partner} overlap for {leave - enter:.3g}, a step takes {step:.3g}", False
        if leave <= enter:
            told, through = f"{body} and {partner} have no thickness: they overlap at no step's end", True
        elif passes_between(enter, leave, step, base):
            told, through = f"{told}, and none ends in between: one passes through the other", True
        elif passes_between(enter, (enter + leave) / 2, step, base):
            told = f"{told}, and by the end of a step in between they part again: one passes through the other"
            through = True
        return [Experiment(cause, told, None, through)]
    return [Experiment(cause, "no circle that it should meet is passed through", None, False)]


def gone(lab: Laboratory, run: Trajectory, step: float | None) -> bool:
    """Whether a variant does not have the divergence.

    Where velocities after one exact instant are in question, they must have come nearer by what a series demands.
    """
    alignment = align(lab.reference, run, span=lab.passing, step=step, bits=lab.engine.bits)
    if lab.divergence.kind is Kind.TIE:
        own = _difference(lab, lab.candidate.trajectory, lab.candidate.alignment)
        nearer = _difference(lab, run, alignment)
        if own is not None:
            return nearer is not None and nearer <= own / NEARER
        return alignment.divergence is None or alignment.divergence.expected_event > lab.divergence.expected_event
    found = alignment.divergence
    if lab.divergence.kind is Kind.MISSING or lab.divergence.kind is Kind.DIFFERENT:
        walked = alignment.walks[lab.divergence.body]
        if lab.divergence.expected_event not in {m for m, _ in walked.pairs}:
            return False
    return found is None or found.event > lab.divergence.event


def _difference(lab: Laboratory, run: Trajectory, alignment: Alignment) -> float | None:
    """How far the velocities after the instant in question are from the exact ones; None if it is not one instant."""
    event = lab.divergence.expected_event
    for found in instants(alignment.walks):
        if event in found.mine:
            return velocity_difference(lab.reference, run, found) if len(found.mine) == 1 else None
    return None
