"""Engines of time steps: what of a run's defects is of the step, and what stays as the step is halved."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from ...exact.numbers import ball
from ...scenarios.errors import SceneError
from .fits import NEAR, Drift, Sample, drifts, sampled
from .passages import Passage, passages
from .residuals import AUDIT_BITS, Laws, Residual
from .transcript import Transcript

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...scenarios.engine import Engine
    from ...scenarios.trajectory import Trajectory

HALVINGS = 3
"""How often a step is halved: what is of first order then is an eighth of what it was."""

FALLING = 1 / 4
"""The least order with which what is of the step falls: of first order it has 1, and the phase of the step, which is
chance, makes it less: over three halvings it falls to three fifths at least."""

IMPACTS = 24
"""Impacts by which a series in the step is measured."""

SHARE = 4
"""A series may take a quarter of the steps that one for a cause may (`study.series_steps`), in all of its runs."""

FEW_IMPACTS = 4
"""Impacts by which it is measured where more are not to be had at that price."""

LATE = 2.0
"""An engine that finds an overlap at the end of a step and pushes in the next is late by two steps; one that tells
contacts at the end of the step before is early by one."""


@dataclass
class Measures:
    """What a run of steps misses, impact by impact and flight by flight.

    Attributes:
        samples: single contacts.
        drifts: flights whose end is beyond rounding.
        several: residuals of impacts of several contacts, and of circles that meet nothing.
        passages: depths in the run's own flights.
        impacts: how many contacts there were.
        flights: how many flights.
        back: how long before the end of a step impulses are applied.
        met: when each pair meets.
    """

    samples: list[Sample] = field(default_factory=list[Sample])
    drifts: list[Drift] = field(default_factory=list[Drift])
    several: list[tuple[int, float, Residual]] = field(default_factory=list[tuple[int, float, Residual]])
    passages: list[Passage] = field(default_factory=list[Passage])
    impacts: int = 0
    flights: int = 0
    back: float = 0.0
    met: dict[tuple[int, ...], list[float]] = field(default_factory=dict[tuple[int, ...], list[float]])


@dataclass(frozen=True)
class Defect:
    """One kind of defect of an engine of steps.

    Attributes:
        kind: `impulse`, `restitution`, `lateness`, `correction`, `several`, `bystander`, `missed`.
        size: at the run's own step: a share of the impulse, a time, a length, or how many.
        order: with which power of the step it falls; None where that is not known.
        finest: its size at the finest step that was run.
        step: that step.
        of_step: whether it is of the step; None where that cannot be told.
    """

    kind: str
    size: float
    order: float | None = None
    finest: float = math.nan
    step: float = math.nan
    of_step: bool | None = None


def measured(run: Trajectory, unit: float, step: float, start: bool) -> Measures:
    """All that a run of steps misses, with impulses at the places where it applied them.

    An engine may push circles at the end of a step where they are told to be, or push and then move them on.
    """
    transcript, found = Transcript(run), Measures()
    laws = Laws(run.scene, unit, start, step)
    gone = transcript.gone
    with ball.precision(AUDIT_BITS):
        ways: dict[float, list[Sample]] = {0.0: [], step: []}
        events = 0
        for instant in transcript.instants():
            event = instant.events[0] if instant.events else events
            for pair in instant.impulses:
                found.met.setdefault(pair, []).append(instant.time)
            if any(gone.get(k, math.inf) <= instant.time for k in instant.after):
                events += len(instant.events)
                continue
            if not instant.turned:
                for back, samples in ways.items():
                    samples += sampled(laws, instant, events, back)
                alone = {s.pair for s in ways[0.0][-len(instant.impulses) :] if s.time == instant.time}
                for told in laws.residuals(instant, events):
                    if told.kind in ("energy", "bystander") or (told.kind == "impulse" and told.bodies not in alone):
                        found.several.append((event, instant.time, told))
            found.drifts += [d for d in drifts(laws, instant, events) if math.hypot(d.x, d.y) > NEAR * d.room]
            found.flights += len(instant.after)
            found.impacts += len(instant.impulses)
            events += len(instant.events)
        found.passages = [*passages(laws, transcript.flights(), transcript.end, gone)]
    found.back = min(ways, key=lambda back: _middle_of([s.defect for s in ways[back]]))
    found.samples = ways[found.back]
    return found


def defects(engine: Engine, measures: Measures) -> dict[str, float]:
    """The size of each kind of defect of a run that is not rounding."""
    step = engine.step or 0.0
    bad = [s for s in measures.samples if s.defect > NEAR * s.room]
    several = [r for _, _, r in measures.several if r.broken]
    sizes = {
        "impulse": _middle_of([s.defect for s in bad]) if bad else 0.0,
        "lateness": max((abs(s.late) for s in measures.samples if abs(s.gap) > s.loose), default=0.0),
        "correction": _middle_of([math.hypot(d.x, d.y) for d in measures.drifts]),
        "several": max((r.size / (r.room or 1.0) for r in several if r.kind != "bystander"), default=0.0),
        "bystander": float(sum(r.kind == "bystander" for r in several)),
        "missed": max((p.residual.size for p in lasting(measures, step)), default=0.0),
    }  # fmt: skip
    return {kind: size for kind, size in sizes.items() if size}


def lasting(measures: Measures, step: float) -> list[Passage]:
    """Overlaps of pairs that do not meet within the steps that it takes to see them, and passages."""
    late = LATE * step
    return [
        passage
        for passage in measures.passages
        if not any(abs(time - passage.time) <= late for time in measures.met.get(passage.residual.bodies, ()))
    ]


def _middle_of(values: Sequence[float]) -> float:
    """The median; 0 of none."""
    return sorted(values)[len(values) // 2] if values else 0.0


def series(
    engine: Engine,
    run: Trajectory,
    unit: float,
    measures: Measures,
    finer: Callable[[Engine], Engine | None],
    firmer: Callable[[Engine], Engine | None],
    play: Callable[[Engine, Trajectory, float], Trajectory],
) -> list[Defect]:
    """Each defect of a run, and what becomes of it as the step is halved.

    Args:
        finer: the engine with half the step, if it has one.
        firmer: the engine with twice the iterations of its solver, if it iterates.
        play: runs an engine on the scene up to a time.
    """
    from ..study import series_steps  # here, since it loads numpy, which engines of events do without

    step = engine.step or 0.0
    found = defects(engine, measures)
    known = {kind for kind, size in found.items() if kind == "lateness" and size <= LATE * step}
    if not found.keys() - known:
        return [Defect(kind, size, 1.0, size, step, True) for kind, size in found.items()]
    until, most = _until(run, measures, IMPACTS), series_steps(engine) / SHARE
    if until * (2 ** (HALVINGS + 1) - 2) > most * step:
        until = _until(run, measures, FEW_IMPACTS)
    at: list[tuple[float, dict[str, float]]] = [(step, _within(engine, measures, until))]
    chosen: Engine | None = engine
    for _ in range(HALVINGS):
        chosen = None if chosen is None else finer(chosen)
        if chosen is None or chosen.step is None or until > most * chosen.step:
            break
        most -= until / chosen.step
        try:
            told = play(chosen, run, until)
            at.append((chosen.step, defects(chosen, measured(told, unit, chosen.step, chosen.rounds_input))))
        except SceneError:
            break
    judged = [_judged(kind, size, step, at, kind in known) for kind, size in found.items()]
    return [_iterated(defect, engine, run, unit, until, firmer, play) for defect in judged]


def _iterated(
    defect: Defect,
    engine: Engine,
    run: Trajectory,
    unit: float,
    until: float,
    firmer: Callable[[Engine], Engine | None],
    play: Callable[[Engine, Trajectory, float], Trajectory],
) -> Defect:
    """What impacts miss is of the solver's iterations where twice as many leave half of it."""
    chosen = firmer(engine) if defect.kind in ("several", "impulse") and defect.of_step is not True else None
    if chosen is None or chosen.step is None:
        return defect
    try:
        told = defects(chosen, measured(play(chosen, run, until), unit, chosen.step, chosen.rounds_input))
    except SceneError:
        return defect
    left = told.get(defect.kind, 0.0)
    return replace(defect, kind="iterations", finest=left, of_step=True) if left <= defect.size / 2 else defect


def _until(run: Trajectory, measures: Measures, impacts: int) -> float:
    """The time up to which a series is run: as far as there are enough impacts, and what is to be seen."""
    times = [float(event.time) for event in run.events]
    if not times:
        return float(run.final_time)
    first = [s.time for s in measures.samples if s.defect > NEAR * s.room][:1]
    first += [time for _, time, told in measures.several if told.broken][:1]
    first += [p.time for p in measures.passages[:1] if math.isfinite(p.time)]
    least = times[min(len(times), impacts) - 1]
    return max([least, *(time for time in first if time <= 4 * least)])


def _within(engine: Engine, measures: Measures, until: float) -> dict[str, float]:
    """The defects of a run up to a time."""
    part = Measures(
        [s for s in measures.samples if s.time <= until],
        [d for d in measures.drifts if d.time <= until],
        [told for told in measures.several if told[1] <= until],
        [p for p in measures.passages if p.time <= until],
        back=measures.back,
        met=measures.met,
    )
    return defects(engine, part)


def _judged(kind: str, size: float, step: float, at: Sequence[tuple[float, dict[str, float]]], known: bool) -> Defect:
    """What a series says of one kind of defect."""
    last, finest = at[-1][0], at[-1][1].get(kind, 0.0)
    first = at[0][1].get(kind, 0.0) or size
    if len(at) <= 2 and not known:
        return Defect(kind, size, None, finest, last, None)
    if len(at) == 1:
        return Defect(kind, size, None, size, step, True)
    if not finest:
        return Defect(kind, size, math.inf, 0.0, last, True)
    order = math.log(first / finest) / math.log(step / last)
    return Defect(kind, size, order, finest, last, order >= FALLING or (known and finest <= LATE * last))
