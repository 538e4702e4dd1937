"""Arithmetic rounding alone: from the exact run of what the engine is given to the engine itself."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

from flint import arb

from ....exact.numbers import ball
from ....scenarios.numbers.quantity import Quantity
from ...alignment.align import align
from ...alignment.impulse_order import DOUBLE_BITS
from ...deadline import NO_TIME
from ..diagnosis import CauseName, Experiment
from ..laboratory.alone import arithmetic_alone
from ..laboratory.shown import SMALLER, shown, to_first_order, verb
from .tie import resolved_otherwise

if TYPE_CHECKING:
    from ..decision.reader import RunReader
    from ..laboratory.laboratory import Laboratory
    from ..so_far import SoFar

CAUSE = CauseName["ARITHMETIC"]


def arithmetic(lab: Laboratory, found: SoFar) -> list[Experiment]:
    """What the engine's own arithmetic does; of an engine with a time step, what the finest step leaves."""
    late = Experiment(CAUSE, NO_TIME)
    if lab.engine.step is None:
        cut = found.of(CauseName["INPUT"]).result == NO_TIME
        return [late if cut else lab.tried(lambda: _alone(lab, found), late)]
    if found.enough or lab.decision is None:
        enough = found.enough or resolved_otherwise(lab).suffices
        return [Experiment(CAUSE, f"not tried: {'something else suffices' if enough else 'no contact can be named'}")]
    return [late if found.cut else lab.tried(lambda: _rest(lab, found), late)]


def _alone(lab: Laboratory, found: SoFar) -> Experiment:
    """From the exact run of what the engine is given to the engine itself."""
    entered, by_input = found.entered, found.of(CauseName["INPUT"])
    if lab.engine.bits is None:
        return Experiment(CAUSE, "its numbers are exact", 0.0, False)
    if lab.decision is None or entered is None:
        no_run = f"there is no exact run of the scene in {lab.numbers}"
        reason = "no contact can be named" if lab.decision is None else no_run
        return Experiment(CAUSE, f"not tried: {reason}")
    start = entered.value(lab.decision)
    if _other_law(lab, start):
        return Experiment(CAUSE, "not by rounding: doubles stay far nearer", None, False)
    by_itself = None if entered is lab.truth else _displaced(lab, entered)
    if by_itself is not None:
        return by_itself if by_itself.suffices or by_input.suffices else _neither(lab, found, start, by_itself)
    given = "the scene" if entered is lab.truth else f"the scene in {lab.numbers}"
    what = f"{lab.name} against the exact run of {given}"
    if start is None or lab.got is None:
        whole = lab.moved(lab.got, lab.margin)
        moved = None if whole is None or by_input.displacement is None else whole - by_input.displacement
        if moved is not None:
            assert lab.margin is not None
            flips = lab.changes(lab.margin + arb(moved))
            return Experiment(CAUSE, f"what is left of its error {verb(moved, flips)}", moved, flips)
        rest = align(entered.run, lab.candidate.trajectory, span=lab.span, bits=lab.engine.bits)
        leaves = rest.divergence is not None and rest.divergence.time <= lab.divergence.time
        told = f"{what} {'leaves it before or there' if leaves else 'does not leave it up to there'}"
        return Experiment(CAUSE, told, moved, leaves)
    moved = lab.moved(lab.got, start)
    assert lab.margin is not None
    with ball.precision(4096):
        alone = lab.margin + (lab.got - start)
    flips = lab.changes(alone)
    row = Experiment(CAUSE, f"{what} {verb(moved, flips)}", moved, flips)
    return row if by_input.suffices or flips else _neither(lab, found, start, row)


def _displaced(lab: Laboratory, entered: RunReader) -> Experiment | None:
    """The exact run, displaced by what the engine's arithmetic alone has come to while all is small; see `alone`."""
    moved_on = arithmetic_alone(lab, entered)
    if moved_on is None:
        return None
    what = f"the exact run, moved after event {moved_on.after - 1} by what {lab.name}'s arithmetic alone has come to,"
    told = shown(lab, CAUSE, moved_on.decision, moved_on.truth, moved_on.own, what)
    if told.displacement is None:
        little = moved_on.small(Quantity.of(Fraction(1, 2**SMALLER)))
        moved = lab.moved(little.value(moved_on.decision), moved_on.truth.value(moved_on.decision))
        return to_first_order(told, None if moved is None else math.ldexp(moved, SMALLER))
    return told


def _neither(lab: Laboratory, found: SoFar, start: arb | None, row: Experiment) -> Experiment:
    """What is left where neither rounding suffices alone: both together, or the decision's own rounding at the last."""
    if lab.got is None or lab.changes(lab.got):
        found.neither = True
        return row
    if start is None or abs(float(lab.got.mid())) > lab.by_rounding(start):
        clear = f"{row.result}; its flights up to the contact decide as the exact ones do, and clearly"
        return replace(row, result=clear)
    last = (
        f"{row.result}; its flights up to the contact would decide as the exact ones do: the decision itself is rounded"
    )
    return replace(row, result=last, suffices=True)


def _other_law(lab: Laboratory, start: arb | None) -> bool:
    """Whether the engine is farther off than doubles by more than rounding in another order can explain."""
    off = lab.moved(lab.got, start)
    if off is None or lab.engine.bits is None or lab.engine.bits < DOUBLE_BITS or lab.of_doubles(start) is None:
        return False
    return abs(off) > lab.by_rounding(start)


def _rest(lab: Laboratory, found: SoFar) -> Experiment:
    """What is left at the finest step, which rounding may explain."""
    assert lab.decision is not None
    start = None if found.entered is None else found.entered.value(lab.decision)
    rest = lab.moved(found.finest, start)
    if rest is None:
        return Experiment(CAUSE, "not tried: the finest step does not come to the contact")
    small = abs(rest) <= lab.by_rounding(start)
    told = f"at the finest step, {lab.name} is {abs(rest):.3g} off the exact run of the scene in {lab.numbers}"
    return Experiment(CAUSE, told, rest, small and lab.changes(found.finest))
