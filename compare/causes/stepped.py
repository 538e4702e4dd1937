"""Experiments on an engine with a time step: finer steps in a series, passing through, its solver."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from flint import arb

from ...exact.numbers import ball
from ..alignment.align import align
from ..alignment.divergence import Kind
from ..alignment.instants import NEARER, instants, velocity_difference
from ..alignment.walk import REPEATED
from ..deadline import NO_TIME
from ..foreign.guard import finer_of, firmer_of
from ..study import SERIES_STEPS, finer_by
from .decisions import decisions
from .diagnosis import CauseName, Experiment
from .laboratory import Laboratory
from .reader import Reader

if TYPE_CHECKING:
    from ...scenarios.trajectory import Trajectory
    from ..alignment.align import Alignment


MOST_HALVINGS = 8
"""A time step is halved up to so many times, as far as `SERIES_STEPS` allow."""


def stepped(lab: Laboratory, entered: Reader | None, by_input: Experiment, tie: Experiment) -> list[Experiment]:
    """What a time step does: its series, passing through, the solver, and rounding where the series leaves the rest."""
    passed = lab.tried(lambda: _tunnelling(lab), Experiment(CauseName.TUNNELLING, NO_TIME))
    cut = Experiment(CauseName.STEP, NO_TIME)
    series, finest = lab.tried(lambda: _series(lab, stays_tied=bool(tie.suffices)), (cut, None))
    firmer = lab.tried(lambda: _iterations(lab), Experiment(CauseName.ITERATIONS, NO_TIME))
    rows = [series, passed, firmer]
    if any(e.suffices for e in (*rows, by_input, tie)) or lab.decision is None:
        suffices = any(e.suffices for e in (*rows, by_input, tie))
        reason = "something else suffices" if suffices else "no contact can be named"
        rows.append(Experiment(CauseName.ARITHMETIC, f"not tried: {reason}"))
        return rows
    left = Experiment(CauseName.ARITHMETIC, NO_TIME)
    untried = any(e.result == NO_TIME for e in (*rows, by_input))
    return [*rows, left if untried else lab.tried(lambda: _rest(lab, entered, finest), left)]


def _rest(lab: Laboratory, entered: Reader | None, finest: arb | None) -> Experiment:
    """What is left at the finest step, which rounding may explain."""
    assert lab.decision is not None
    start = None if entered is None else entered.value(lab.decision)
    rest = lab.moved(finest, start)
    if rest is None:
        return Experiment(CauseName.ARITHMETIC, "not tried: the finest step does not come to the contact")
    small = abs(rest) <= lab.by_rounding(start)
    told = f"at the finest step, {lab.name} is {abs(rest):.3g} off the exact run of the scene in {lab.numbers}"
    return Experiment(CauseName.ARITHMETIC, told, rest, small and lab.changes(finest))


def _gone(lab: Laboratory, run: Trajectory, step: float | None) -> bool:
    """Whether a variant does not have the divergence.

    Where velocities after one exact instant are in question, they must have come nearer by what a series demands.
    """
    alignment = align(lab.reference, run, span=lab.span, step=step, bits=lab.engine.bits)
    if lab.divergence.kind is Kind.TIE:
        own = _difference(lab, lab.candidate.trajectory, lab.candidate.alignment)
        nearer = _difference(lab, run, alignment)
        if own is not None:
            return nearer is not None and nearer <= own / NEARER
    found = alignment.divergence
    if lab.divergence.kind is Kind.MISSING or lab.divergence.kind is Kind.DIFFERENT:
        walked = alignment.walks[lab.divergence.body]
        if lab.divergence.event not in {m for m, _ in walked.pairs}:
            return False
    return found is None or found.event > lab.divergence.event


def _difference(lab: Laboratory, run: Trajectory, alignment: Alignment) -> float | None:
    """How far the velocities after the instant in question are from the exact ones; None if it is not one instant."""
    event = lab.divergence.event
    for found in instants(alignment.walks):
        if event in found.mine:
            return velocity_difference(lab.reference, run, found) if len(found.mine) == 1 else None
    return None


def _series(lab: Laboratory, *, stays_tied: bool) -> tuple[Experiment, arb | None]:
    """The step halved again and again, as far as counted work allows; and the decision's number at the finest."""
    assert lab.engine.step is not None
    until, told, last = lab.until(lab.engine.step), [], lab.got
    gone: list[bool] = []
    for halvings in range(1, MOST_HALVINGS + 1):
        finer = finer_by(lab.engine, halvings)
        if finer is None or finer.step is None or until > SERIES_STEPS * finer.step:
            break
        run = lab.run(finer, lab.study.scene, until)
        gone.append(_gone(lab, run, finer.step))
        told.append(f"{finer.step:.3g}")
        if lab.decision is not None:
            reader = lab.reader(run, lab.given, finer.step)
            last = reader.value(lab.decision) if all(reader.follows(p) for p in lab.pairings) else None
        if gone[-2:] == [True, True]:
            break
    if not gone and finer_of(lab.engine) is None:
        return Experiment(CauseName.STEP, f"not tried: {lab.name} has no finer step to offer"), None
    if not gone:
        return Experiment(CauseName.STEP, f"not tried: a finer step takes more than {SERIES_STEPS:,} steps"), None
    moved = lab.moved(lab.got, last)
    within = _within_a_step(lab, lab.engine.step / 2 ** len(gone))
    enough = (gone[-1] or within) and not stays_tied
    if enough and not _explains(lab, moved):
        moved = None  # it is the series that tells
    runs = [f"{step} {'agrees' if flag else 'differs'}" for step, flag in zip(told, gone, strict=True)]
    first = gone.index(True) if True in gone else len(gone)
    if first > 1 and all(gone[first:]):
        runs = [f"{told[0]} to {told[first - 1]} differs", *runs[first:]]
    if within:
        runs.append("and the two meetings are nearer than that")
    return Experiment(CauseName.STEP, f"with a step of {', '.join(runs)}", moved, enough), last


def _explains(lab: Laboratory, moved: float | None) -> bool:
    """Whether flights that are displaced by so much decide otherwise: a step may do so without displacing them."""
    if moved is None or lab.margin is None:
        return False
    with ball.precision(4096):
        return lab.changes(lab.margin + arb(moved))


def _within_a_step(lab: Laboratory, step: float) -> bool:
    """Whether the engine takes as one what the exact motion has one after the other, nearer than a step."""
    if lab.divergence.kind is not Kind.TIE or lab.margin is None or lab.decision is None:
        return False
    return lab.decision.kind == "order" and 0 < abs(float(lab.margin.mid())) < step


def _tunnelling(lab: Laboratory) -> Experiment:
    """Whether the two overlap for less than a step, and between two of its instants."""
    cause, step = CauseName.TUNNELLING, lab.engine.step
    assert step is not None
    missed = [d for d in decisions(lab.reference, lab.candidate.trajectory, lab.candidate.alignment) if d.kind == "hit"]
    for decision in missed:
        if decision.first.partner != lab.divergence.expected:
            continue
        stay = lab.own.stay(decision.first)
        if stay is None or not math.isfinite(stay[1]):
            continue
        enter, leave = stay
        base = 0.0
        reversal = lab.candidate.trajectory.reversal
        if reversal is not None and lab.study.scene.reverse_at is not None and float(reversal.time) < enter:
            base = float(reversal.time)
        whole = math.floor((leave - base) / step) * step + base
        body, partner = decision.first.body, decision.first.partner
        told = f"{body} and {partner} overlap for {leave - enter:.3g}, a step takes {step:.3g}"
        if whole < enter:
            return Experiment(cause, f"{told}, and none ends in between: they pass through each other", None, True, 1.0)
        return Experiment(cause, told, None, False)
    return Experiment(cause, "no circle that it should meet is passed through", None, False)


def _iterations(lab: Laboratory) -> Experiment:
    """The solver's iterations doubled, twice over."""
    more = firmer_of(lab.engine)
    if more is None:
        return Experiment(CauseName.ITERATIONS, "it iterates nothing", None, False)
    last = lab.divergence.time + REPEATED * (lab.engine.step or 0.0)
    earlier = [e for e in lab.candidate.trajectory.events if float(e.time) <= last]
    if not any(len(e.contacts) > 1 for e in earlier):
        return Experiment(CauseName.ITERATIONS, "no step had several contacts", None, False)
    more = firmer_of(more) or more
    until = lab.until(lab.engine.step)
    if until > SERIES_STEPS * (lab.engine.step or math.inf):
        return Experiment(CauseName.ITERATIONS, f"not tried: it takes more than {SERIES_STEPS:,} steps")
    run = lab.run(more, lab.study.scene, until)
    gone = _gone(lab, run, more.step)
    return Experiment(
        CauseName.ITERATIONS, f"with four times as many it {'agrees' if gone else 'differs too'}", None, gone
    )
