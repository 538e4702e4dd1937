"""The experiments on a divergence, each held against the exact margin of the decision."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

from flint import arb  # type: ignore[attr-defined]

from ...exact.numbers import ball
from ...scenarios.errors import SceneError
from ...scenarios.quantity import Quantity
from ..alignment.align import Span, align
from ..alignment.divergence import Kind
from ..study import SERIES_MORE, SERIES_STEPS, finer_by
from .decision import Decision, Reader, answer, decisions
from .diagnosis import CauseName, Diagnosis, Experiment, diagnosed
from .rounding import rounded, shifted

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import OnProgress, Trajectory
    from ..candidate import Candidate
    from ..study import Study

MOST_HALVINGS = 8
"""A time step is halved up to so many times, as far as `SERIES_STEPS` allow."""

MODEL_FACTOR = 2.0**16
"""An engine whose numbers are this many times farther off than those of doubles does not only round: rounding in
another order of operations changes an error by its digits, not by five orders of magnitude."""

SMALLER = 200
"""Halvings by which the input's rounding is made small, so that the exact run on it stays in the same history."""

ROUNDING_SHARE = 2.0**-40
"""Displacements below this share of the scene's measures are what rounding does in a short run."""


class Laboratory:
    """What every experiment on one divergence needs.

    Attributes:
        decision: what was decided; None where no contact could be named.
        truth, own: the reference and the candidate at it.
    """

    def __init__(self, study: Study, candidate: Candidate, engine: Engine, progress: OnProgress | None) -> None:
        divergence = candidate.alignment.divergence
        assert divergence is not None
        self.study, self.candidate, self.engine, self.progress = study, candidate, engine, progress
        self.divergence = divergence
        self.reference = study.longest or study.reference
        self.name = engine.name
        self.given = rounded_or_none(study.scene) if engine.rounds_input else study.scene
        turned = self.reference.reversal
        self.turned = None if turned is None or turned.after > divergence.event else turned.after
        self.truth = Reader(self.reference, turned_after=self.turned)
        self.own = Reader(candidate.trajectory, candidate.alignment.walks, self.given, self.turned)
        self.decision = self._decision()
        self.margin = None if self.decision is None else self.truth.value(self.decision)
        self.got = None if self.decision is None else self.own.value(self.decision)

    def _decision(self) -> Decision | None:
        """The decision that the candidate has otherwise; where its own flights have none, the closest."""
        found = decisions(self.reference, self.candidate.trajectory, self.candidate.alignment)
        told = [(d, v) for d in found if (v := self.truth.value(d)) is not None]
        for decision, value in told:
            other = self.own.value(decision)
            if other is not None and answer(decision, other) != answer(decision, value):
                return decision
        return min(told, key=lambda pair: abs(float(pair[1].mid())), default=(None, None))[0]

    @property
    def scale(self) -> float:
        """The largest coordinate or radius of the scene."""
        return max(max(abs(float(c.x)), abs(float(c.y)), float(c.r)) for c in self.study.scene.circles)

    def reader(self, run: Trajectory, scene: Scene | None, step: float | None) -> Reader:
        """Another run at the decision."""
        walks = align(self.reference, run, span=self.span, step=step, instants=False).walks
        return Reader(run, walks, scene, self.turned)

    @property
    def span(self) -> Span:
        """Up to the divergence."""
        return Span(min(self.divergence.event + 1, len(self.reference.events)), self.divergence.time)

    def until(self, step: float | None) -> float:
        """How far an experiment has to run: past both meetings, by what an error may delay them."""
        times = (self.divergence.time, self.divergence.expected_time or 0.0)
        return max(times) * 1.125 + SERIES_MORE * (step or 0.0) + self.study.patience(None).slack / 8

    def changes(self, value: arb | None) -> bool:
        """Whether a value of the decision is another answer than the exact one."""
        told = None if self.decision is None else answer(self.decision, value)
        return self.decision is not None and told is not None and told != answer(self.decision, self.margin)

    def moved(self, value: arb | None, start: arb | None) -> float | None:
        """How far a value lies from another."""
        if value is None or start is None:
            return None
        with ball.precision(4096):
            return float((value - start).mid())


def rounded_or_none(scene: Scene) -> Scene | None:
    """The scene in doubles; None if it is no longer valid."""
    try:
        return rounded(scene)
    except SceneError:
        return None


def diagnosis_of(lab: Laboratory) -> Diagnosis:
    """The cause of a divergence, by what suffices at the contact in question.

    Each experiment moves the number that decides: input rounding alone (the reference engine on the scene in doubles),
    arithmetic alone (from there to the engine), both together; for an engine with a time step, the step, in a series,
    passing through within a step, and the iterations of its solver; another resolution of an exact tie; and, where
    none of these, the engine's law. One that moves it past zero suffices.
    """
    tie = _tie(lab)
    rows: list[Experiment] = []
    entered, by_input = _input(lab)
    rows.append(by_input)
    if lab.engine.step is None:
        rows += _arithmetic(lab, entered, by_input)
    else:
        rows += _stepped(lab, entered, by_input, tie)
    rows.append(tie)
    if not any(e.suffices for e in rows):
        rows.append(_model(lab))
    else:
        rows.append(Experiment(CauseName.MODEL, "not tried: something else suffices"))
    return diagnosed(rows)


def _tie(lab: Laboratory) -> Experiment:
    """Contacts of one exact instant, which the engine resolves otherwise."""
    divergence, events = lab.divergence, lab.reference.events
    if lab.decision is not None and lab.decision.kind == "order":
        names = {lab.decision.first.partner, lab.decision.second.partner} if lab.decision.second else set()
    else:
        names = {divergence.got, divergence.expected} - {None}
    here = events[divergence.event] if divergence.event < len(events) else None
    together = {name for pair in here.contacts for name in pair} if here is not None else set()
    exact = here is not None and here.coupled and divergence.body in together and names <= together and len(names) > 0
    if not exact:
        return Experiment(CauseName.TIE, "no contacts of one exact instant are in question", None, False)
    assert here is not None
    policy = lab.study.scene.tie_policy
    own = "" if "tie_policy" in lab.engine.scene_keys else f"; {lab.name} does not follow {policy}"
    return Experiment(
        CauseName.TIE,
        f"{len(here.contacts)} contacts fall on exactly one instant, the order of their impulses matters, and "
        f"{lab.name} has another{own}",
        None,
        True,
        1.0,
    )


def _input(lab: Laboratory) -> tuple[Reader | None, Experiment]:
    """The reference engine on the scene in doubles."""
    if not lab.engine.rounds_input:
        return lab.truth, Experiment(CauseName.INPUT, "no input is rounded", 0.0, False)
    if lab.given is None:
        try:
            rounded(lab.study.scene)
        except SceneError as error:
            return None, Experiment(
                CauseName.INPUT, f"rounded to doubles, the scene is no longer valid: {error}", None, True, 1.0
            )
    assert lab.given is not None
    if lab.given.digest == lab.study.scene.digest:
        return lab.truth, Experiment(
            CauseName.INPUT, "the scene is exact in doubles, so no input was rounded", 0.0, False
        )
    run = lab.study.run(lab.study.truth, lab.given, lab.until(None), lab.progress)
    reader = lab.reader(run, lab.given, None)
    if lab.decision is None:
        return reader, Experiment(CauseName.INPUT, "not tried: no contact can be named")
    told = _told(lab, CauseName.INPUT, reader, "the reference engine on the scene in doubles")
    if told.displacement is None:
        told = replace(told, displacement=_linear(lab))
    return reader, told


def _linear(lab: Laboratory) -> float | None:
    """What input rounding moves the decision by, to the first order: by the response to a 2**-`SMALLER` part of it."""
    assert lab.decision is not None
    try:
        scene = shifted(lab.study.scene, Quantity.of(Fraction(1, 2**SMALLER)))
    except SceneError:
        return None
    run = lab.study.run(lab.study.truth, scene, lab.until(None), lab.progress)
    moved = lab.moved(lab.reader(run, scene, None).value(lab.decision), lab.margin)
    return None if moved is None else math.ldexp(moved, SMALLER)


def _told(lab: Laboratory, cause: CauseName, reader: Reader, what: str) -> Experiment:
    """What a run shows at the decision."""
    assert lab.decision is not None
    pairings = [p for p in (lab.decision.first, lab.decision.second) if p is not None]
    if not all(reader.follows(p) for p in pairings):
        return Experiment(cause, f"{what} leaves the history before that, among what leads to the contact", None, True)
    value = reader.value(lab.decision)
    if value is None:
        return Experiment(cause, f"{what} does not have both meetings", None, True)
    moved = lab.moved(value, lab.margin)
    flips = lab.changes(value)
    return Experiment(cause, f"{what} {_verb(moved, flips)}", moved, flips)


def _verb(moved: float | None, flips: bool) -> str:
    by = "decides otherwise" if moved is None else f"moves the decision by {abs(moved):.3g}"
    return f"{by}, which {'changes it' if flips else 'does not change it'}"


def _arithmetic(lab: Laboratory, entered: Reader | None, by_input: Experiment) -> list[Experiment]:
    """From the exact run of what the engine is given to the engine itself, and both roundings together."""
    if lab.engine.bits is None:
        return [Experiment(CauseName.ARITHMETIC, "its numbers are exact", 0.0, False)]
    if lab.decision is None or entered is None:
        reason = "no contact can be named" if lab.decision is None else "there is no exact run of the scene in doubles"
        return [Experiment(CauseName.ARITHMETIC, f"not tried: {reason}")]
    start = entered.value(lab.decision)
    if _other_law(lab, start):
        return [Experiment(CauseName.ARITHMETIC, "not by rounding: doubles stay far nearer", None, False)]
    what = f"{lab.name} against the exact run of {'the scene in doubles' if entered is not lab.truth else 'the scene'}"
    if start is None or lab.got is None:
        whole = lab.moved(lab.got, lab.margin)
        moved = None if whole is None or by_input.displacement is None else whole - by_input.displacement
        if moved is not None:
            assert lab.margin is not None
            flips = lab.changes(lab.margin + arb(moved))
            return [Experiment(CauseName.ARITHMETIC, f"what is left of its error {_verb(moved, flips)}", moved, flips)]
        rest = align(entered.run, lab.candidate.trajectory, span=lab.span, instants=True)
        leaves = rest.divergence is not None and rest.divergence.time <= lab.divergence.time
        told = f"{what} {'leaves it before or there' if leaves else 'does not leave it up to there'}"
        return [Experiment(CauseName.ARITHMETIC, told, moved, leaves)]
    moved = lab.moved(lab.got, start)
    assert lab.margin is not None
    with ball.precision(4096):
        alone = lab.margin + (lab.got - start)
    flips = lab.changes(alone)
    rows = [Experiment(CauseName.ARITHMETIC, f"{what} {_verb(moved, flips)}", moved, flips)]
    if by_input.suffices or flips:
        return rows
    if lab.changes(lab.got):
        rows.append(
            Experiment(
                CauseName.TOGETHER,
                "neither suffices alone; both together do",
                lab.moved(lab.got, lab.margin),
                True,
                1.0,
            )
        )
        return rows
    last = (
        f"{what}: its flights up to the contact would decide as the exact ones do; rounding in the decision changes it"
    )
    return [Experiment(CauseName.ARITHMETIC, last, moved, True)]


def _other_law(lab: Laboratory, start: arb | None) -> bool:
    """Whether the engine is farther off than doubles by more than rounding in another order can explain."""
    from ..engines import engine

    if lab.decision is None or start is None or lab.engine.bits is None or lab.engine.bits < 53:
        return False
    if lab.got is None and lab.own.run.reversal is None and lab.decision is None:
        return False
    control = engine("double")
    if type(control) is type(lab.engine):
        return False
    run = lab.study.run(control, lab.study.scene, lab.until(None), lab.progress)
    value = lab.reader(run, lab.given, None).value(lab.decision)
    off = lab.moved(lab.got, start)
    by_doubles = lab.moved(value, start)
    if off is None or by_doubles is None:
        return False
    least = lab.scale * 2.0**-50
    return abs(off) > MODEL_FACTOR * max(abs(by_doubles), least)


def _stepped(lab: Laboratory, entered: Reader | None, by_input: Experiment, tie: Experiment) -> list[Experiment]:
    """What a time step does: its series, passing through, the solver, and rounding where the series leaves the rest."""
    passed = _tunnelling(lab)
    series, finest = _series(lab, stays_tied=bool(tie.suffices))
    firmer = _iterations(lab)
    rows = [series, passed, firmer]
    if any(e.suffices for e in rows) or by_input.suffices or lab.decision is None:
        rows.append(Experiment(CauseName.ARITHMETIC, "not tried: something else suffices"))
        return rows
    start = None if entered is None else entered.value(lab.decision)
    rest = lab.moved(finest, start)
    if rest is None:
        rows.append(Experiment(CauseName.ARITHMETIC, "not tried: the finest step does not come to the contact"))
    else:
        small = abs(rest) <= ROUNDING_SHARE * lab.scale
        told = f"at the finest step, {lab.name} is {abs(rest):.3g} off the exact run of the scene in doubles"
        rows.append(Experiment(CauseName.ARITHMETIC, told, rest, small and lab.changes(finest)))
    return rows


def _gone(lab: Laboratory, run: Trajectory, step: float | None) -> bool:
    """Whether a variant does not have the divergence."""
    alignment = align(lab.reference, run, span=lab.span, step=step)
    found = alignment.divergence
    if lab.divergence.kind is Kind.MISSING or lab.divergence.kind is Kind.DIFFERENT:
        walked = alignment.walks[lab.divergence.body]
        if lab.divergence.event not in {m for m, _ in walked.pairs}:
            return False
    return found is None or found.event > lab.divergence.event


def _series(lab: Laboratory, *, stays_tied: bool) -> tuple[Experiment, arb | None]:
    """The step halved again and again, as far as counted work allows; and the decision's number at the finest."""
    assert lab.engine.step is not None
    until, told, last = lab.until(lab.engine.step), [], lab.got
    gone: list[bool] = []
    for halvings in range(1, MOST_HALVINGS + 1):
        finer = finer_by(lab.engine, halvings)
        if finer is None or finer.step is None or until > SERIES_STEPS * finer.step:
            break
        run = lab.study.run(finer, lab.study.scene, until, lab.progress)
        gone.append(_gone(lab, run, finer.step))
        told.append(f"{finer.step:.3g}")
        if lab.decision is not None:
            reader = lab.reader(run, lab.given, finer.step)
            last = (
                reader.value(lab.decision)
                if all(reader.follows(p) for p in (lab.decision.first, lab.decision.second) if p is not None)
                else None
            )
        if gone[-2:] == [True, True]:
            break
    if not gone:
        return Experiment(CauseName.STEP, f"not tried: a finer step takes more than {SERIES_STEPS:,} steps"), None
    moved = lab.moved(lab.got, last)
    enough = gone[-1] and not stays_tied
    runs = [f"{step} {'agrees' if flag else 'differs'}" for step, flag in zip(told, gone, strict=True)]
    first = gone.index(True) if True in gone else len(gone)
    if all(gone[first:]):
        runs = (
            [f"{told[0]} to {told[first - 1]} differs"] * (first > 1)
            + runs[: first if first == 1 else 0]
            + runs[first:]
        )
    return Experiment(CauseName.STEP, f"with a step of {', '.join(runs)}", moved, enough), last


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
    firmer = lab.engine.firmer()
    if firmer is None:
        return Experiment(CauseName.ITERATIONS, "it iterates nothing", None, False)
    earlier = [
        e for e in lab.candidate.trajectory.events if float(e.time) <= lab.divergence.time + (lab.engine.step or 0)
    ]
    if not any(len(e.contacts) > 1 for e in earlier):
        return Experiment(CauseName.ITERATIONS, "no step had several contacts", None, False)
    firmer = firmer.firmer() or firmer
    until = lab.until(lab.engine.step)
    if until > SERIES_STEPS * (lab.engine.step or math.inf):
        return Experiment(CauseName.ITERATIONS, f"not tried: it takes more than {SERIES_STEPS:,} steps")
    run = lab.study.run(firmer, lab.study.scene, until, lab.progress)
    gone = _gone(lab, run, firmer.step)
    return Experiment(
        CauseName.ITERATIONS, f"with four times as many it {'agrees' if gone else 'differs too'}", None, gone
    )


def _model(lab: Laboratory) -> Experiment:
    """What is left: the engine's law."""
    moved = lab.moved(lab.got, lab.margin)
    return Experiment(CauseName.MODEL, "no rounding, no step and no tie explains it: its law differs", moved, True)
