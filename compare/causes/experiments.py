"""The experiments on a divergence, each held against the exact margin of the decision."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

from flint import arb

from ...exact.numbers import ball
from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import Quantity
from ..alignment.align import align
from ..alignment.impulse_order import DOUBLE_BITS
from ..deadline import NO_TIME
from .alone import arithmetic_alone
from .diagnosis import CauseName, Diagnosis, Experiment, diagnosed
from .laboratory import Laboratory, verb
from .reader import Reader
from .rounding import rounded, shifted
from .stepped import stepped

if TYPE_CHECKING:
    from ...scenarios.event import Contact
    from .decision import Decision, Pairing

SMALLER = 200
"""Halvings by which the input's rounding is made small, so that the exact run on it stays in the same history."""


def diagnosis_of(lab: Laboratory) -> Diagnosis:
    """The cause of a divergence, by what suffices at the contact in question.

    Each experiment moves the number that decides: input rounding alone (the reference engine on the scene in the
    engine's numbers), arithmetic alone (from there to the engine), both together; for an engine with a time step, the
    step, in a series, passing through within a step, and the iterations of its solver; another resolution of an exact
    tie; and, where none of these, the engine's law. One that moves it past zero suffices. What the user's seconds leave
    no time for is not tried, and says so.
    """
    tie = _tie(lab)
    rows: list[Experiment] = []
    entered, by_input = lab.tried(lambda: _input(lab), (None, Experiment(CauseName.INPUT, NO_TIME)))
    rows.append(by_input)
    if lab.engine.step is None:
        left = [Experiment(CauseName.ARITHMETIC, NO_TIME)]
        rows += left if by_input.result == NO_TIME else lab.tried(lambda: _arithmetic(lab, entered, by_input), left)
    else:
        rows += stepped(lab, entered, by_input, tie)
    if any(e.cause is CauseName.ITERATIONS and e.suffices for e in rows):
        tie = Experiment(CauseName.TIE, "with more iterations it resolves the instant as the policy does", None, False)
    rows.append(tie)
    untried = [
        e for e in rows if e.suffices is None and (e.cause in (CauseName.STEP, CauseName.INPUT) or e.result == NO_TIME)
    ]
    if any(e.suffices for e in rows):
        rows.append(Experiment(CauseName.MODEL, "not tried: something else suffices"))
    elif lab.study.truth.rounds_input:
        told = (
            f"not tried: {lab.study.truth.name}, the reference, rounds too: what it has otherwise may be its own error"
        )
        rows.append(Experiment(CauseName.MODEL, told))
    elif untried:
        rows.append(Experiment(CauseName.MODEL, "not tried: what else there could be was not all tried"))
    else:
        rows.append(_model(lab))
    return diagnosed(rows)


def _tie(lab: Laboratory) -> Experiment:
    """Contacts of one exact instant, which the engine resolves otherwise."""
    divergence, events = lab.divergence, lab.reference.events
    if lab.decision is not None and lab.decision.second is not None:
        names = {lab.decision.first.partner, lab.decision.second.partner}
    else:
        names = {*divergence.partners} & {*lab.study.scene.ids}
    here = events[divergence.event] if divergence.event < len(events) else None
    cluster = _cluster(lab, [] if here is None or not here.coupled else here.contacts)
    together = {name for pair in cluster for name in pair}
    if len(cluster) < 2 or not names or not names <= together:
        return Experiment(CauseName.TIE, "no contacts of one exact instant are in question", None, False)
    policy = lab.study.scene.tie_policy
    own = "" if "tie_policy" in lab.engine.scene_keys else f"; {lab.name} does not follow {policy}"
    return Experiment(
        CauseName.TIE,
        f"{len(cluster)} contacts fall on exactly one instant, the order of their impulses matters, and "
        f"{lab.name} has another{own}",
        None,
        True,
        1.0,
    )


def _cluster(lab: Laboratory, contacts: Sequence[Contact]) -> list[Contact]:
    """Those contacts of an instant that hang together with the body in question through circles that can move."""
    movable = lab.candidate.alignment.walks
    names, found = {lab.divergence.body}, [pair for pair in contacts if lab.divergence.body in pair]
    while True:
        names |= {name for pair in found for name in pair if name in movable}
        more = [pair for pair in contacts if names & {*pair}]
        if len(more) == len(found):
            return found
        found = more


def _input(lab: Laboratory) -> tuple[Reader | None, Experiment]:
    """The reference engine on the scene in doubles."""
    if not lab.engine.rounds_input:
        return lab.truth, Experiment(CauseName.INPUT, "no input is rounded", 0.0, False)
    if lab.given is None:
        try:
            rounded(lab.study.scene, lab.bits)
        except SceneError as error:
            return None, Experiment(
                CauseName.INPUT, f"rounded to {lab.numbers}, the scene is no longer valid: {error}", None, True, 1.0
            )
    assert lab.given is not None
    if lab.given.digest == lab.study.scene.digest:
        return lab.truth, Experiment(
            CauseName.INPUT, f"the scene is exact in {lab.numbers}, so no input was rounded", 0.0, False
        )
    run = lab.run(lab.study.truth, lab.given, lab.until(None))
    reader = lab.reader(run, lab.given, None)
    if lab.decision is None:
        return reader, Experiment(CauseName.INPUT, "not tried: no contact can be named")
    told = _told(lab, CauseName.INPUT, reader, f"the reference engine on the scene in {lab.numbers}")
    return reader, told if told.displacement is not None else _to_first_order(told, _linear(lab))


def _first(decision: Decision, truth: Reader) -> Pairing | None:
    """Which of two meetings comes first in the exact motion; None where one is in question, or both come at once."""
    value = truth.value(decision)
    sign = None if value is None or decision.second is None else ball.sign_of(value)
    return decision.first if sign == 1 else decision.second if sign == -1 else None


def _to_first_order(told: Experiment, moved: float | None) -> Experiment:
    """With the displacement to the first order, where the run itself does not come to the contact."""
    if moved is None:
        return told
    return replace(
        told, displacement=moved, result=f"{told.result}; to the first order it moves the decision by {abs(moved):.3g}"
    )


def _linear(lab: Laboratory) -> float | None:
    """What input rounding moves the decision by, to the first order: by the response to a 2**-`SMALLER` part of it."""
    assert lab.decision is not None
    try:
        scene = shifted(lab.study.scene, Quantity.of(Fraction(1, 2**SMALLER)), lab.bits)
    except SceneError:
        return None
    run = lab.run(lab.study.truth, scene, lab.until(None))
    moved = lab.moved(lab.reader(run, scene, None).value(lab.decision), lab.margin)
    return None if moved is None else math.ldexp(moved, SMALLER)


def _told(lab: Laboratory, cause: CauseName, reader: Reader, what: str) -> Experiment:
    """What a run shows at the decision."""
    assert lab.decision is not None
    return _shown(lab, cause, lab.decision, lab.truth, reader, what)


def _shown(
    lab: Laboratory, cause: CauseName, decision: Decision, truth: Reader, reader: Reader, what: str
) -> Experiment:
    """What a run shows at a decision, beside the run of which the true answer is read."""
    if not all(reader.follows(p) for p in decision.pairings):
        return Experiment(cause, f"{what} leaves the history before that, among what leads to the contact", None, True)
    value = reader.value(decision)
    if value is None:
        first = _first(decision, truth)
        if first is not None and reader.hit_time(first) is not None:
            return Experiment(cause, f"{what} has only that of the two meetings which comes first", None, False)
        return Experiment(cause, f"{what} does not have both meetings", None, True)
    moved = lab.moved(value, truth.value(decision))
    flips = lab.changes(value)
    return Experiment(cause, f"{what} {verb(moved, flips)}", moved, flips)


def _arithmetic(lab: Laboratory, entered: Reader | None, by_input: Experiment) -> list[Experiment]:
    """From the exact run of what the engine is given to the engine itself, and both roundings together."""
    if lab.engine.bits is None:
        return [Experiment(CauseName.ARITHMETIC, "its numbers are exact", 0.0, False)]
    if lab.decision is None or entered is None:
        no_run = f"there is no exact run of the scene in {lab.numbers}"
        reason = "no contact can be named" if lab.decision is None else no_run
        return [Experiment(CauseName.ARITHMETIC, f"not tried: {reason}")]
    start = entered.value(lab.decision)
    if _other_law(lab, start):
        return [Experiment(CauseName.ARITHMETIC, "not by rounding: doubles stay far nearer", None, False)]
    by_itself = None if entered is lab.truth else _alone(lab, entered)
    if by_itself is not None:
        return [by_itself] if by_itself.suffices or by_input.suffices else _together(lab, start, by_itself)
    given = "the scene" if entered is lab.truth else f"the scene in {lab.numbers}"
    what = f"{lab.name} against the exact run of {given}"
    if start is None or lab.got is None:
        whole = lab.moved(lab.got, lab.margin)
        moved = None if whole is None or by_input.displacement is None else whole - by_input.displacement
        if moved is not None:
            assert lab.margin is not None
            flips = lab.changes(lab.margin + arb(moved))
            return [Experiment(CauseName.ARITHMETIC, f"what is left of its error {verb(moved, flips)}", moved, flips)]
        rest = align(entered.run, lab.candidate.trajectory, span=lab.span, bits=lab.engine.bits)
        leaves = rest.divergence is not None and rest.divergence.time <= lab.divergence.time
        told = f"{what} {'leaves it before or there' if leaves else 'does not leave it up to there'}"
        return [Experiment(CauseName.ARITHMETIC, told, moved, leaves)]
    moved = lab.moved(lab.got, start)
    assert lab.margin is not None
    with ball.precision(4096):
        alone = lab.margin + (lab.got - start)
    flips = lab.changes(alone)
    row = Experiment(CauseName.ARITHMETIC, f"{what} {verb(moved, flips)}", moved, flips)
    return [row] if by_input.suffices or flips else _together(lab, start, row)


def _alone(lab: Laboratory, entered: Reader) -> Experiment | None:
    """The exact run, displaced by what the engine's arithmetic alone has come to while all is small; see `alone`."""
    found = arithmetic_alone(lab, entered)
    if found is None:
        return None
    what = f"the exact run, moved after event {found.after - 1} by what {lab.name}'s arithmetic alone has come to,"
    told = _shown(lab, CauseName.ARITHMETIC, found.decision, found.truth, found.own, what)
    if told.displacement is None:
        little = found.small(Quantity.of(Fraction(1, 2**SMALLER)))
        moved = lab.moved(little.value(found.decision), found.truth.value(found.decision))
        return _to_first_order(told, None if moved is None else math.ldexp(moved, SMALLER))
    return told


def _together(lab: Laboratory, start: arb | None, row: Experiment) -> list[Experiment]:
    """What is left where neither rounding suffices alone: both, or the decision's own rounding at the last."""
    if lab.got is None or lab.changes(lab.got):
        told = "neither suffices alone; both together do"
        return [row, Experiment(CauseName.TOGETHER, told, lab.moved(lab.got, lab.margin), True, 1.0)]
    if start is None or abs(float(lab.got.mid())) > lab.by_rounding(start):
        clear = f"{row.result}; its flights up to the contact decide as the exact ones do, and clearly"
        return [replace(row, result=clear)]
    last = (
        f"{row.result}; its flights up to the contact would decide as the exact ones do: the decision itself is rounded"
    )
    return [replace(row, result=last, suffices=True)]


def _other_law(lab: Laboratory, start: arb | None) -> bool:
    """Whether the engine is farther off than doubles by more than rounding in another order can explain."""
    off = lab.moved(lab.got, start)
    if off is None or lab.engine.bits is None or lab.engine.bits < DOUBLE_BITS or lab.of_doubles(start) is None:
        return False
    return abs(off) > lab.by_rounding(start)


def _model(lab: Laboratory) -> Experiment:
    """What is left: the engine's law."""
    moved = lab.moved(lab.got, lab.margin)
    return Experiment(CauseName.MODEL, "no rounding, no step and no tie explains it: its law differs", moved, True)
