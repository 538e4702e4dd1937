"""Whether a run keeps the laws: each of its steps, on the engine's own numbers, whatever its history."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections import Counter, defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING

from ...exact.numbers import ball
from ...scenarios.errors import SceneError
from ..foreign.guard import allowances, cut_short, finer_of, firmer_of, run_guarded
from .fits import NEAR, Fit, bounces_of, description_of, descriptions, drifts, sampled, with_bounces
from .passages import passages, passes_between
from .residual import AUDIT_BITS, KINDS, Defect, Passage, Residual, Violation, falls_through, met_in_pockets
from .residuals import Laws
from .transcript import Transcript

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.trajectory import Trajectory
    from .fits import BounceRatios, Drift, Sample

TOLD = 2.0**-53
"""The unit of doubles, in which states are reported, whatever an engine computes in."""

Asked = Mapping[tuple[int, ...], int]  # impacts of each contact that a run is to have; under (), in all

LEAST_UNIT = 2.0**-200
"""The least unit by which wide numbers are audited, of whatever bits."""

FITTED = 20_000
"""Impacts, and flights, by which a description is found."""


@dataclass(frozen=True)
class Audit:
    """What an audit of a run comes to.

    Attributes:
        kept: whether the engine keeps the laws; None where that cannot be told.
        reason: why it cannot be told, or that a finer step shows it; "" elsewhere.
        impacts, flights: how many steps were audited: contacts, and straight flights.
        missed: the steps that miss a law, in order of time.
        worst: for each kind, the largest residual as a share of what rounding may make of it.
        unit: of the engine's numbers.
        fit: the simplest description of what is missed.
        defects: of an engine of steps: each kind of defect, and how it falls with the step.
        declared: what the engine declares of its model, as far as steps make use of it, and how many do.
        phantoms: contacts whose impulse is below rounding: how many, the first one's event and approach.
        bounces: of a scene whose restitution is below 1, the restitution that the run's bounces have.
        horizon: of a record without states: how many events of the reference its times were compared to.
    """

    kept: bool | None
    reason: str = ""
    impacts: int = 0
    flights: int = 0
    missed: tuple[Violation, ...] = field(default=(), repr=False)
    worst: Mapping[str, float] = field(default_factory=dict[str, float])
    unit: float = TOLD
    fit: Fit | None = None
    defects: tuple[Defect, ...] = ()
    declared: Mapping[str, int] = field(default_factory=dict[str, int])
    phantoms: tuple[int, int, float] | None = None
    horizon: int | None = None
    bounces: BounceRatios | None = None

    @property
    def first(self) -> Violation | None:
        """The first step that misses a law."""
        return self.missed[0] if self.missed else None

    @property
    def violations(self) -> tuple[Violation, ...]:
        """The first step of each kind that misses a law, in order of time."""
        return tuple(sorted({v.kind: v for v in reversed(self.missed)}.values(), key=self.missed.index))

    @property
    def counts(self) -> dict[str, int]:
        """How many steps of each kind miss a law."""
        return dict(Counter(found.kind for found in self.missed))

    @property
    def steps(self) -> str:
        """How much was audited, in words."""
        counts = ((self.impacts, "impact"), (self.flights, "flight"))
        return " and ".join(f"{many:,} {what}{'s' * (many != 1)}" for many, what in counts)

    @property
    def finding(self) -> str:
        """What explains a law that is not kept, or the first step that misses it."""
        if self.fit is not None:
            return str(self.fit)
        return str(self.first) if self.first is not None else self.reason

    @property
    def _phantoms(self) -> str:
        """Contacts that are told and do nothing."""
        if self.phantoms is None:
            return ""
        count, event, approach = self.phantoms
        if count == 1:
            return f"; one contact, event {event}, has an impulse below rounding: the two approach by {approach:.3g}"
        return f"; {count:,} contacts have an impulse below rounding, first event {event}: approach {approach:.3g}"

    @property
    def sentence(self) -> str:
        """The audit in one sentence."""
        if self.kept:
            through = any(defect.kind == "tunnelling" for defect in self.defects)
            passes = "; between the ends of its steps it passes through what it should hit" if through else ""
            told = "" if self.bounces is None else f"; {self.bounces}"
            return f"keeps the law in all of its {self.steps}{self._phantoms}{passes}{told}"
        if self.kept is None:
            return f"whether it keeps the law is not determined: {self.reason}"
        total = sum(self.counts.values())
        told = f"does not keep the law: {self.finding}"
        if self.fit is not None and self.first is not None:
            told += f"; {total:,} miss{'es' * (total != 1)} in its {self.steps}, first {self.first}"
        return told


def unit_of(engine: Engine, transcript: Transcript) -> float:
    """The unit by which an engine's steps are audited: of its bits, but not below that of the states it reports."""
    declared = 0.0 if engine.bits is None else 2.0**-engine.bits
    return max(declared, LEAST_UNIT if transcript.wide else TOLD)


def audit_run(run: Trajectory, engine: Engine) -> Audit:
    """Audits every step of a run, whatever has become of its history.

    An engine of events is audited by the rounding of its bits. One of steps is, besides, run with its step halved,
    where it can be: what falls is of the step.

    >>> from truebreak.floating import DoubleEngine
    >>> from truebreak.scenarios import Circle, Scene
    >>> engine = DoubleEngine()
    >>> found = audit_run(engine.run(Scene([Circle(0, 0, vx=1), Circle(4, 1)]), until=5), engine)
    >>> found.kept, found.impacts, found.flights, found.sentence
    (True, 1, 2, 'keeps the law in all of its 1 impact and 2 flights')
    """
    if run.scene.settle and engine.step is not None:
        return Audit(None, "what walls carry is not audited yet in steps")
    if run.scene.settle and any(getattr(run.motion, "slides", run.slides).values()):
        return Audit(None, "what slides down a slope is not audited yet")
    if run.scene.moving_solid is not None and engine.step is not None:
        return Audit(None, f"{run.scene.moving_solid} moves, and what meets it is not audited yet in steps")
    if run.scene.other_walls:
        return Audit(None, f"a wall of kind {run.scene.other_walls[0].kind!r} is not audited")
    if engine.step is not None and run.scene.gravity is not None and run.scene.restitution.sign() == 0:
        return Audit(None, "steps with gravity and restitution 0 are not audited yet")
    if engine.step is not None:
        return _audited_steps(run, engine)
    transcript = Transcript(run, engine.bits is not None, 0.0 if engine.bits is None else 2.0**-engine.bits)
    if not transcript.states:
        return Audit(None, "the record has no states, so that only times and partners can be compared")
    if transcript.carries is None:
        return Audit(None, "its motion does not say what walls carry")
    unit = unit_of(engine, transcript)
    with ball.precision(AUDIT_BITS if unit >= TOLD else 2 * AUDIT_BITS):
        laws = Laws(run.scene, unit, engine.rounds_input or not transcript.wide, fall=transcript.fall)
        found = _audited(transcript, laws, run, allowances(engine, run.scene))
        return found if run.scene.elastic else replace(found, bounces=bounces_of(transcript, laws))


class _Notes:
    """What a pass over a run finds."""

    def __init__(self, ids: tuple[str, ...], allows: Mapping[str, float]) -> None:
        self.ids, self.allows = ids, allows
        self.found, self.declared = list[Violation](), Counter[str]()
        self.worst: dict[str, float] = dict.fromkeys(KINDS, 0.0)
        self.phantoms: tuple[int, int, float] | None = None

    def take(self, found: Residual, event: int, time: float, speed: float = math.inf, flown: float = 0.0) -> None:
        """Notes one residual; `flown`: how long those that take part have flown since they were last told."""
        kind, bodies, size, room = found
        if kind == "phantom":
            count, first, faint = self.phantoms or (0, event, size)
            self.phantoms = count + 1, first, faint
            return
        if size > room and self.allows and (key := self._allowed(kind, size - room, speed, flown)) is not None:
            self.declared[key] += 1
            return
        if size > self.worst[kind] * room:
            self.worst[kind] = size / room if room else math.inf
        if size > room:
            self.found.append(Violation(kind, event, time, tuple(self.ids[k] for k in bodies), size, room))

    def _allowed(self, kind: str, over: float, speed: float, flown: float) -> str | None:
        """Which declaration of the engine's grants a residual, if one does."""
        lost = self.allows.get("deceleration", 0.0) * flown
        if kind in ("flight", "gap", "depth"):
            length = next((key for key in ("slop", "margin") if over <= self.allows.get(key, 0.0)), None)
            lengths = self.allows.get("slop", 0.0) + self.allows.get("margin", 0.0)
            return length or ("deceleration" if lost and over <= lengths + lost * flown else None)
        if kind in ("impulse", "energy", "bystander"):
            if speed <= self.allows.get("threshold", 0.0):
                return "threshold"
            if over <= self.allows.get("compliance", 0.0) * speed < math.inf:
                return "compliance"
            return "deceleration" if over <= 4 * lost else None
        return None

    @property
    def missed(self) -> tuple[Violation, ...]:
        """What misses a law, by time."""
        return tuple(sorted(self.found, key=lambda found: (found.time, found.event)))


def _audited(transcript: Transcript, laws: Laws, run: Trajectory, allows: Mapping[str, float]) -> Audit:
    """One pass over a run of events; a second one, where it misses a law, that looks for what describes it."""
    ids = laws.scene.ids
    notes, gone = _Notes(ids, allows), transcript.gone
    impacts = flights = events = 0
    for found in laws.begun(transcript):
        notes.take(found, 0, 0.0)
    for instant in transcript.instants():
        event = instant.events[0] if instant.events else events
        speed, since = math.inf, {}
        if allows:
            since = {k: instant.time - float(flight.t) for k, flight in instant.before.items()}
        if allows and instant.impulses:
            speed = max(abs(float(laws.meeting(pair, instant, events).opening.mid())) for pair in instant.impulses)
        for found in laws.residuals(instant, events):
            if not (gone and any(gone.get(k, math.inf) <= instant.time for k in found.bodies)):
                notes.take(
                    found, event, instant.time, speed, max((since.get(k, 0.0) for k in found.bodies), default=0.0)
                )
        events += len(instant.events)
        impacts += len(instant.impulses)
        flights += len(instant.after)
    times = sorted(float(event.time) for event in run.events)
    try:
        rows, reason = transcript.flights(partial(with_bounces, laws)), ""
    except ValueError as error:
        rows, reason = [], str(error)
    for passage in passages(laws, rows, transcript.end, gone, transcript.carried):
        if not laws.restitution and math.isinf(passage.time):
            continue  # what slides along is carried into it by the rounding of no speed at all, in endless time
        event, at = bisect_right(times, passage.time), passage.time
        notes.take(passage.residual, event, at, flown=at - passage.began)
    fit, missed = None, notes.missed
    if missed:
        samples, ways = _described(transcript, laws)
        fit = description_of(descriptions(laws, samples, ways, ids), missed)
    return Audit(
        None if reason and not missed else not missed, reason, impacts, flights, missed, notes.worst, laws.unit, fit,
        declared=dict(notes.declared), phantoms=notes.phantoms,
    )  # fmt: skip


def _described(transcript: Transcript, laws: Laws) -> tuple[list[Sample], list[Drift]]:
    """The contacts and flights by which a description is found."""
    samples: list[Sample] = []
    ways: list[Drift] = []
    events = 0
    for instant in transcript.instants():
        if not (instant.turned or instant.rested) and not any(
            transcript.gone.get(k, math.inf) < instant.time for k in instant.after
        ):
            samples += sampled(laws, instant, events)
            ways += drifts(laws, instant, events)
        events += len(instant.events)
        if len(samples) >= FITTED or len(ways) >= FITTED:
            break
    return samples, ways


# -- engines of steps


def _audited_steps(run: Trajectory, engine: Engine) -> Audit:
    transcript = Transcript(run)
    if not transcript.states:
        return Audit(None, "the record has no states, so that only times and partners can be compared")
    unit, step = unit_of(engine, transcript), engine.step or 0.0
    allows = allowances(engine, run.scene)
    measures, declared = _without_declared(measured(run, unit, step, engine.rounds_input), allows)
    with ball.precision(AUDIT_BITS):
        laws = Laws(run.scene, unit, engine.rounds_input or not transcript.wide, step, transcript.fall)
        begun = _Notes(laws.scene.ids, {})
        for found in (*((told, 0, 0.0) for told in laws.begun(transcript)), *met_in_pockets(run, step, unit, LATE)):
            begun.take(*found)
        fits = _described_steps(laws, measures, {"impulse"})
        bounced = None if run.scene.elastic else bounces_of(transcript, laws)
    if begun.found:
        return Audit(False, "", measures.impacts, measures.flights, begun.missed, {}, unit, bounces=bounced)
    law = any(fit.kind in ("restitution", "mass", "friction") for fit in fits)
    if law:  # unless more iterations of its solver leave at most half of what its impulses miss
        half = defects(engine, measures).get("impulse", 0.0) / 2
        law = _iterated(engine, run, unit, float(run.final_time), "impulse", half) > half
    unseen = transcript.fall is not None and not transcript.fall.step and 2 * transcript.fall.size * step
    if law and unseen and all(s.defect * s.speed <= unseen for s in measures.samples):
        told = f"its states do not say how it falls within a step, and 2 g dt, {unseen:.3g}, may be all that they miss"
        return Audit(None, told, measures.impacts, measures.flights)
    told = () if law else tuple(series(engine, run, unit, measures))
    broken = [d for d in told if d.of_step is False and d.kind != "phantom"]
    open_ones = [d for d in told if d.of_step is None]
    kept: bool | None = False if law or broken else None if open_ones else True
    sizes = ", ".join(f"{d.kind} {d.size:.3g}" for d in open_ones)
    reason = f"no finer step was run to show what is of the step ({sizes})" if kept is None else ""
    if broken and broken[0].step < step:
        reason = f"at step {broken[0].step:.3g} it flies {broken[0].size:.3g} into what it does not collide with"
    kinds = {"impulse"} if law else {d.kind for d in broken}
    violations = _step_violations(measures, laws, kinds, step, law) if kept is False else []
    with ball.precision(AUDIT_BITS):
        fit = description_of(fits if law else _described_steps(laws, measures, kinds), violations)
    return Audit(
        kept, reason, measures.impacts, measures.flights, tuple(violations), {}, unit, fit, told, declared,
        bounces=bounced,
    )  # fmt: skip


def _described_steps(laws: Laws, measures: Measures, kinds: set[str]) -> list[Fit]:
    """What describes the kinds of defects that are not of the step."""
    samples = measures.samples
    if "impulse" not in kinds:
        samples = [s._replace(restitution=1.0, aside=0.0, lost=0.0, masses=1.0) for s in samples]
    if "lateness" not in kinds:
        samples = [s._replace(gap=0.0) for s in samples]
    return descriptions(laws, samples, measures.drifts if "correction" in kinds else (), laws.scene.ids)


def _iterated(engine: Engine, run: Trajectory, unit: float, until: float, kind: str, most: float) -> float:
    """What is left of a kind of defect with up to 16 times the iterations; infinite without a run as far as that."""
    left, firmer, more = math.inf, firmer_of(engine), 4
    while more and left > most and firmer is not None and firmer.step is not None:
        found = _defects_of(firmer, run, unit, until, {}, until)
        left = math.inf if found is None else found[0].get(kind, 0.0)
        firmer, more = firmer_of(firmer), more - 1
    return left


def _defects_of(
    engine: Engine, run: Trajectory, unit: float, until: float, asked: Asked, most: float
) -> tuple[dict[str, float], bool, float] | None:
    """The defects of another engine on a run's scene, up to a time or, past it, to what is asked; None if it refuses
    or ends before. `most`: for how long it may be run. Told besides: whether it has what is asked, how long it ran."""
    flown, sizes = 0.0, dict[str, float]()
    for end in (min(until * more, most) for more in WAITS):
        if flown and flown + end > most:
            break
        try:
            told = run_guarded(engine, run.scene, until=end, events=2**HALVINGS * (4 * len(run.events) + 64))
            found = measured(told, unit, engine.step or 0.0, engine.rounds_input)
        except SceneError:
            break
        if cut_short(told, until):
            break
        reached = _reached(found, asked)
        if not flown or reached < math.inf:
            sizes |= _within(engine, found, reached if flown else math.inf)
        flown += end
        if reached < math.inf:
            return sizes, True, flown
    return (sizes, False, flown) if flown else None


def _without_declared(measures: Measures, allows: Mapping[str, float]) -> tuple[Measures, dict[str, int]]:
    """What an engine of steps declares is its model, and no defect."""
    if not allows:
        return measures, {}
    declared: Counter[str] = Counter()
    length = max(allows.get("slop", 0.0), allows.get("margin", 0.0))
    kept: list[Sample] = []
    for s in measures.samples:
        if s.defect > NEAR * s.room and s.speed <= allows.get("threshold", 0.0):
            declared["threshold"] += 1
        elif NEAR * s.room < s.defect <= allows.get("compliance", 0.0):
            declared["compliance"] += 1
        else:
            kept.append(s)
    ways = [d for d in measures.drifts if d.size > length]
    through, falls = ([p for p in row if p.residual.size > length] for row in (measures.passages, measures.falls))
    key = "margin" if allows.get("margin", 0.0) >= allows.get("slop", 0.0) else "slop"
    declared[key] += len(measures.drifts) - len(ways) + len(measures.passages) - len(through)
    measures.samples, measures.drifts, measures.passages, measures.falls = kept, ways, through, falls
    return measures, {key: count for key, count in declared.items() if count}


def _step_violations(measures: Measures, laws: Laws, kinds: set[str], step: float, law: bool) -> list[Violation]:
    """Every step of an engine of steps that misses a law by what is not of the step, in order of time.

    What is far smaller than the most may be of the step, unless one `law` describes all impulses.
    """
    impulses, found, ids = list[Violation](), list[Violation](), laws.scene.ids
    worst, e = 0.0 if law else max((s.defect for s in measures.samples), default=0.0), laws.restitution or 1.0
    for s in measures.samples:
        pair = tuple(ids[k] for k in s.pair)
        if "impulse" in kinds and s.defect > max(NEAR * s.room, worst / 2):
            impulses.append(Violation("impulse", s.event, s.time, pair, s.off, s.room * s.speed * e))
        if "lateness" in kinds and abs(s.sunk) > s.loose:
            found.append(Violation("gap", s.event, s.time, pair, abs(s.sunk), s.loose))
    if "correction" in kinds:
        found += [Violation("flight", d.event, d.time, (ids[d.circle],), d.size, d.room) for d in measures.drifts]
    for kind, name in (("several", ("energy", "impulse")), ("bystander", ("bystander",))):
        if kind in kinds:
            found += [
                Violation(r.kind, event, time, tuple(ids[k] for k in r.bodies), r.size, r.room)
                for event, time, r in measures.several
                if r.broken and r.kind in name
            ]
    if "missed" in kinds:
        found += [
            Violation("depth", 0, p.time, tuple(ids[k] for k in p.residual.bodies), p.residual.size, p.residual.room)
            for p in gone_through(measures, step) or lasting(measures, measures.passages, step)
        ]
    most = {v.kind: v.size for v in sorted(found, key=lambda v: v.size)}
    found = impulses + [v for v in found if 2 * v.size >= most[v.kind]]
    return sorted(found, key=lambda violation: (violation.time, violation.event))


# -- engines of steps: what of a run's defects is of the step, and what stays as the step is halved


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

ONCE = {"impulse", "several", "bystander"}
"""Defects of single impacts: that a finer run is without them says something where one has as many impacts."""

WAITS = (1.0, 5 / 4, 2.0)
"""How much longer than the coarse run a finer one is, until it has as many impacts."""

LATE = 2.0
"""Steps by which an engine may be late that finds an overlap at the end of one and pushes in the next."""

LASTING_UNITS = 64
"""Units in the last place of the greatest speeds of two that a contact that lasts may leave, at restitution 0."""


@dataclass
class Measures:
    """What a run of steps misses, impact by impact and flight by flight.

    Attributes:
        samples: single contacts.
        drifts: flights whose end is beyond rounding.
        several: residuals of impacts of several contacts, and of circles that meet nothing.
        passages: depths in the run's own flights.
        tunnels: those of overlaps in which two come nearer between two ends of steps only.
        falling: whether there is gravity.
        falls: overlaps into which two then go on falling (`falls_through`).
        impacts, flights: how many contacts and flights there were; fastest: the greatest speed.
        back: how long before the end of a step impulses are applied.
        end: up to when its flights are known.
        met: when each pair meets.
        behind: by how much places are behind those of a fall, at most, for an engine that moves first.
        wholes: see `Laws.wholes`: what is met of a thing is not always the face or end that is overlapped a step later.
    """

    samples: list[Sample] = field(default_factory=list["Sample"])
    drifts: list[Drift] = field(default_factory=list["Drift"])
    several: list[tuple[int, float, Residual]] = field(default_factory=list[tuple[int, float, Residual]])
    passages: list[Passage] = field(default_factory=list[Passage])
    tunnels: list[Passage] = field(default_factory=list[Passage])
    falling: bool = False
    falls: list[Passage] = field(default_factory=list[Passage])
    impacts: int = 0
    flights: int = 0
    fastest: float = 0.0
    back: float = 0.0
    behind: float = 0.0
    end: float = math.inf
    met: dict[tuple[int, ...], list[float]] = field(default_factory=dict[tuple[int, ...], list[float]])
    wholes: Callable[[tuple[int, ...]], list[tuple[int, ...]]] = lambda bodies: [bodies]


def measured(run: Trajectory, unit: float, step: float, start: bool) -> Measures:
    """All that a run of steps misses, with impulses at the places where it applied them.

    An engine may push circles at the end of a step where they are told to be, or push and then move them on.
    """
    transcript, found = Transcript(run, unit=unit, step=step), Measures()
    laws = Laws(run.scene, unit, start, step, transcript.fall)
    gone = transcript.gone
    with ball.precision(AUDIT_BITS):
        ways: dict[float, list[Sample]] = {0.0: [], step: []}
        fastest: defaultdict[int, float] = defaultdict(float)

        def lasts(bodies: tuple[int, ...], speed: float) -> bool:
            """Whether a speed is what rounding leaves at a contact that has taken all of it, and goes on."""
            return not laws.restitution and speed <= LASTING_UNITS * unit * sum(fastest[k] for k in bodies)

        events = 0
        for instant in transcript.instants():
            event = instant.events[0] if instant.events else events
            for pair in instant.impulses:
                for whole in laws.wholes(pair):
                    found.met.setdefault(whole, []).append(instant.time)
            if any(gone.get(k, math.inf) <= instant.time for k in instant.after):
                events += len(instant.events)
                continue
            for k, flight in instant.before.items():
                fastest[k] = max(fastest[k], flight.speed)
            if not instant.turned:
                for back, samples in ways.items():
                    contacts = sampled(laws, instant, events, back)
                    samples += [s for s in contacts if s.gap > 0.0 or not lasts(s.pair, s.speed)]
                alone = {s.pair for s in ways[0.0][-len(instant.impulses) :] if s.time == instant.time}
                for told in laws.residuals(instant, events):
                    several = told.kind == "impulse" and told.bodies not in alone and not lasts(told.bodies, told.size)
                    if told.kind in ("energy", "bystander") or several:
                        found.several.append((event, instant.time, told))
            if transcript.fall is not None:
                late = transcript.fall.place_late
                ends = ((instant.before[k].time, instant.time) for k in instant.after if laws.moving[k])
                found.behind = max([found.behind, *(late(end - begin) for begin, end in ends)])
            found.drifts += [d for d in drifts(laws, instant, events) if d.size > NEAR * d.room]
            found.flights += len(instant.after)
            found.impacts += len(instant.impulses)
            events += len(instant.events)
        found.end, found.fastest = transcript.end, max(fastest.values(), default=0.0)
        turn = math.inf if run.reversal is None else float(run.reversal.time)
        for passage in passages(laws, transcript.flights(), transcript.end, gone, transcript.carried):
            base = turn if passage.time > turn else 0.0
            through = step > 0.0 and passes_between(passage.enter, passage.deepest, step, base)
            (found.tunnels if through else found.passages).append(passage)
        if transcript.fall is not None:
            late, deep = LATE * step, [*found.tunnels, *found.passages]
            found.falling, found.falls = True, falls_through(deep, late, late * transcript.fall.size)
    found.wholes = laws.wholes
    found.back = min(ways, key=lambda back: _middle_of([s.defect for s in ways[back]]))
    found.samples = ways[found.back]
    return found


def defects(engine: Engine, measures: Measures) -> dict[str, float]:
    """The size of each kind of defect of a run that is not rounding."""
    step = engine.step or 0.0
    several = [r for _, _, r in measures.several if r.broken]
    gained = max((r.size for r in several if r.kind == "energy"), default=0.0) / (measures.fastest or 1.0) ** 2
    turned = max((r.size / (r.room or 1.0) for r in several if r.kind == "impulse"), default=0.0)
    moved = [d.size for d in measures.drifts]  # the median; under gravity, where most are of rest, the most
    sizes = {
        "impulse": _middle_of([s.defect for s in measures.samples if s.defect > NEAR * s.room]),
        "integrator": measures.behind,
        "lateness": max((abs(s.late) for s in measures.samples if abs(s.sunk) > s.loose), default=0.0),
        "correction": max([0.0, *moved]) if measures.behind else _middle_of(moved),
        "several": gained or turned,  # impulses may be another policy's; energy is none's
        "bystander": float(sum(r.kind == "bystander" for r in several)),
        "missed": max((p.residual.size for p in lasting(measures, measures.passages, step)), default=0.0),
        "through": max((p.residual.size for p in gone_through(measures, step)), default=0.0),
        "tunnelling": max((p.residual.size for p in lasting(measures, measures.tunnels, step)), default=0.0),
    }  # fmt: skip
    return {kind: size for kind, size in sizes.items() if size}


def lasting(measures: Measures, found: Sequence[Passage], step: float, through: bool = False) -> list[Passage]:
    """Overlaps of pairs that do not meet within the steps that it takes to see them; the run may end before that.

    `through`: from where they begin to where they are over.
    """
    late = LATE * step

    def meets(p: Passage) -> bool:
        begin, end = (p.enter, p.over) if through else (p.time, p.time)
        times = (time for whole in measures.wholes(p.residual.bodies) for time in measures.met.get(whole, ()))
        return any(begin - late <= time <= end + late for time in times)

    return [p for p in found if p.enter <= measures.end - late and not meets(p)]


def gone_through(measures: Measures, step: float) -> list[Passage]:
    """Overlaps without a meeting that take more steps than it takes to see one: over, or gone on under gravity."""
    if measures.falling:
        return lasting(measures, measures.falls, step, True)
    left = lasting(measures, measures.passages, step, True)
    return [p for p in left if LATE * step < p.over - p.enter < measures.end - p.enter]


def _middle_of(values: Sequence[float]) -> float:
    """The median; 0 of none."""
    return sorted(values)[len(values) // 2] if values else 0.0


def series(engine: Engine, run: Trajectory, unit: float, measures: Measures) -> list[Defect]:
    """Each defect of a run, and what becomes of it as the step is halved, or with twice the solver's iterations."""
    from ..study import series_steps  # here, since it loads numpy, which engines of events do without

    step = engine.step or 0.0
    found = defects(engine, measures)
    through = found.pop("through", 0.0)
    known = {k for k, size in found.items() if k == "integrator" or (k == "lateness" and size <= LATE * step)}
    seen: list[Defect] = []
    if not found.keys() - known and not through:
        return [Defect(kind, size, None, size, step, True) for kind, size in found.items()]
    if through and not measures.falling:  # it has not seen what its own steps end in
        seen.append(Defect("missed", found.pop("missed"), None, through, step, False))
    integrator = [Defect("integrator", b, None, b, step, True) for b in [found.pop("integrator", 0.0)] if b]
    until, most = _until(run, measures, IMPACTS, step), series_steps(engine) / SHARE
    if until * (2 ** (HALVINGS + 1) - 2) > most * step:
        until = _until(run, measures, FEW_IMPACTS, step)
    asked = _asked(measures, until) if found.keys() & ONCE else {}
    at: list[tuple[float, dict[str, float]]] = [(step, _within(engine, measures, until))]
    chosen, without = finer_of(engine), set[str]()
    while chosen is not None and chosen.step is not None and until <= most * chosen.step and len(at) <= HALVINGS:
        told = _defects_of(chosen, run, unit, until, asked, most * chosen.step)
        if told is None:
            break
        sizes, enough, flown = told
        most -= flown / chosen.step
        without |= found.keys() - sizes.keys() if enough else set()
        at.append((chosen.step, sizes))
        chosen = finer_of(chosen)
    finest, sizes = at[-1]
    if measures.falling and through:
        found.setdefault("missed", through)
        if "through" not in at[0][1] or len(at) == 1:  # the series does not go as far
            seen.append(Defect("missed", found.pop("missed"), None, math.nan, finest, None))
        elif "through" in sizes:
            seen.append(Defect("missed", found.pop("missed"), None, sizes["through"], finest, False))
    if "tunnelling" in found and "missed" not in found and not seen and (unseen := sizes.get("missed")):
        seen.append(Defect("missed", unseen, None, unseen, finest, False if sizes.get("through") else None))
    judged = [_judged(kind, size, step, at, kind in known, kind in without) for kind, size in found.items()]
    for place, defect in enumerate(judged):
        asks, half = defect.kind in ("several", "impulse") and not defect.of_step, defect.size / 2
        if asks and (left := _iterated(engine, run, unit, until, defect.kind, half)) <= half:
            judged[place] = replace(defect, kind="iterations", finest=left, of_step=True)
    return [*integrator, *judged, *seen]


def _until(run: Trajectory, measures: Measures, impacts: int, step: float) -> float:
    """The time up to which a series is run: as far as there are enough impacts, and what is to be seen."""
    times = [float(event.time) for event in run.events]
    if not times:
        return float(run.final_time)
    first = [s.time for s in measures.samples if s.defect > NEAR * s.room][:1]
    first += [time for _, time, told in measures.several if told.broken][:1]
    first += [p.time for p in (*measures.passages[:1], *measures.tunnels[:1]) if math.isfinite(p.time)]
    first += [p.time + LATE * step for p in measures.falls[:1]]
    least = times[min(len(times), impacts) - 1]
    return max([least, *(time for time in first if time <= 4 * least)])


def _within(engine: Engine, measures: Measures, until: float) -> dict[str, float]:
    """The defects of a run up to a time."""
    part = replace(
        measures,
        samples=[s for s in measures.samples if s.time <= until],
        drifts=[d for d in measures.drifts if d.time <= until],
        several=[told for told in measures.several if told[1] <= until],
        passages=[p for p in measures.passages if p.time <= until],
        tunnels=[p for p in measures.tunnels if p.time <= until],
        falls=[p for p in measures.falls if p.time <= until],
    )
    return defects(engine, part)


def _asked(measures: Measures, until: float) -> Asked:
    """What a finer run is asked for: as many impacts of each contact whose impulse is wrong, and in all."""
    bad = {s.pair for s in measures.samples if s.defect > NEAR * s.room and s.time <= until}
    counts = {whole: bisect_right(times, until) for whole, times in measures.met.items()}
    wholes = {whole for pair in bad for whole in measures.wholes(pair)}
    return {whole: counts.get(whole, 0) for whole in wholes} | {(): sum(counts.values())}


def _reached(measures: Measures, asked: Asked) -> float:
    """When a run has as many impacts; infinite where it has not."""
    met = {**measures.met, (): sorted(time for times in measures.met.values() for time in times)}
    rows = [(met.get(whole, []), count) for whole, count in asked.items() if count]
    return max([0.0, *(math.inf if len(times) < count else times[count - 1] for times, count in rows)])


def _judged(
    kind: str, size: float, step: float, at: Sequence[tuple[float, dict[str, float]]], known: bool, without: bool
) -> Defect:
    """What a series says of one kind of defect; `without`: a run that has as many impacts does not have it."""
    last, finest = at[-1][0], at[-1][1].get(kind, 0.0)
    if kind == "tunnelling":
        return Defect(kind, size, None, finest, last, True)
    if not known and (kind not in at[0][1] or len(at) <= 2):  # the series is too short to have any, or to show more
        return Defect(kind, size, None, finest, last, None)
    first = at[0][1].get(kind, 0.0) or size
    if len(at) == 1:
        return Defect(kind, size, None, size, step, True)
    if not finest:
        return Defect(kind, size, math.inf, 0.0, last, True if without or kind not in ONCE else None)
    order = math.log(first / finest) / math.log(step / last)
    return Defect(kind, size, order, finest, last, order >= FALLING or (known and finest <= LATE * last))
