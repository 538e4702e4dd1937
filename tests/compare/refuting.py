"""Tries to refute the causes that a comparison names, by other runs; it shares no code with what names them.

    python tests/compare/refuting.py placements racks catalogue survey falls rests pocketings stickings [--json FILE]

A cause is a claim about other runs. "Input rounding suffices" says that the exact engine on the rounded scene lacks,
or gains, the same contact; "time step" says that a finer step passes the event; "law" that the steps do not keep the
law. Each claim is tried by just that run, and stands unless the run says otherwise: what cannot be run refutes nothing.
"""

from __future__ import annotations

import argparse
import json
import math
import re
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict, dataclass
from decimal import localcontext
from fractions import Fraction
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from drawn_falls import edged, fallen, pegged, pocketed, settled, sticking
from other_runs import (
    PASSES,
    PAST,
    PRECISE,
    REFUSED,
    SAME,
    SMALL,
    Runs,
    decimal,
    decisions,
    met,
    pushed,
    rounded_scene,
    rows_of,
)

from truebreak.compare import compare
from truebreak.compare.alignment.instants import Kind
from truebreak.compare.candidate import Candidate
from truebreak.compare.engines import engine as engine_named
from truebreak.exact import ExactEngine
from truebreak.scenarios import (
    Circle,
    Scene,
    SceneError,
    StopReason,
    Trajectory,
    catalogue,
)

# -- what is said of a divergence, in one vocabulary

INPUT, FLIGHTS, IMPACTS = "input rounding", "arithmetic in flights", "arithmetic in impacts"
ARITHMETIC, DECISION = "arithmetic", "arithmetic in the decision"
LATENESS, OVERLAP, POSITIONS, INTEGRATOR = "lateness", "overlap", "position correction", "integrator"
STEP, TUNNELLING, ITERATIONS = "time step", "tunnelling", "solver iterations"
LAW, MISSED, PHANTOM, TIE = "collision law", "missed contact", "phantom contact", "tie"
UNKNOWN = "not determined"

ROUNDING = frozenset({INPUT, FLIGHTS, IMPACTS, ARITHMETIC})
OF_ARITHMETIC = frozenset({FLIGHTS, IMPACTS, ARITHMETIC})
OF_STEP = frozenset({LATENESS, OVERLAP, POSITIONS, INTEGRATOR, STEP, TUNNELLING})
KINDS = ROUNDING | OF_STEP | {ITERATIONS, LAW, MISSED, PHANTOM, TIE}

NAMES: dict[str, tuple[str, ...]] = {
    "arithmetic rounding": (ARITHMETIC,),
    "input and arithmetic rounding together": (INPUT, ARITHMETIC),
    "model": (LAW,),
    "law": (LAW,),
    "law not kept": (LAW,),
    "simultaneous collisions": (TIE,),
    "tie (simultaneous collisions)": (TIE,),
    "iterations": (ITERATIONS,),
    "missed": (MISSED,),
    "phantom": (PHANTOM,),
}
"""Other names of the kinds. A name that is neither here nor a kind is kept, and no rule is about it."""


@dataclass(frozen=True)
class Share:
    """One entry of the account: how far a kind of error moves the decision.

    Attributes:
        kind: one of `KINDS`, or what the report calls it.
        contribution: by how much, in the unit of the displacement; None where it is not said.
        share: of the displacement, signed; None where it is not said.
        how: by a `run`, the `tangent`, or an `estimate`.
    """

    kind: str
    contribution: float | None
    share: float | None
    how: str = "run"


@dataclass(frozen=True)
class Said:
    """What a report says of one divergence.

    Attributes:
        causes: the kinds named as the cause, the main one first; empty where it says that it is not determined.
        suffices: the kinds of which it is said that each by itself is enough.
        shares: the account.
        displacement: what the account is of; None where there is none.
        closed: whether it is said to add up; None where nothing is said.
        refused: kinds that were tried and said not to be enough by themselves.
        without: how many contacts it is said that nothing has changed but for, phantoms all; 0 where it is not.
    """

    causes: tuple[str, ...]
    suffices: frozenset[str]
    shares: tuple[Share, ...] = ()
    displacement: float | None = None
    closed: bool | None = None
    refused: frozenset[str] = frozenset()
    without: int = 0


def kinds_of(name: Any) -> tuple[str, ...]:
    """The kinds that a name of a cause stands for."""
    text = str(getattr(name, "value", name)).strip().lower()
    return NAMES.get(text, (text,))


def share_of(entry: Any) -> Share:
    """One entry of the account: of a report, or a row in the order of `Share`."""
    if isinstance(entry, tuple):
        kind, contribution, share, how = entry[:4]
        return Share(kinds_of(kind)[0], contribution, share, str(getattr(how, "value", how)))
    return Share(kinds_of(entry.cause)[0], entry.displacement, entry.share)


WITHOUT = re.compile(r"without it(?: and ([\d,]+) more below rounding)? nothing else differs")
"""How a report says so."""


def said_of(candidate: Candidate) -> Said:
    """The one place that knows the form of a diagnosis: of shares that add up, or of experiments that suffice."""
    found: Any = candidate.diagnosis
    without = WITHOUT.search(str(getattr(found, "finding", "")))
    phantoms = 1 + int((without[1] or "0").replace(",", "")) if without else 0
    if hasattr(found, "shares"):
        shares = [share_of(s) for s in found.shares]
        causes = tuple(kind for name in found.causes for kind in kinds_of(name) if kind != UNKNOWN)
        named = getattr(found, "sufficient", found.causes if len(causes) == 1 else ())
        enough = frozenset(kind for name in named for kind in kinds_of(name) if kind != UNKNOWN)
        tried = getattr(found, "experiments", ())
        no = frozenset(kind for e in tried if e.suffices is False for kind in kinds_of(e.cause))
        return Said(causes, enough, tuple(shares), found.displacement, found.closed, no, phantoms)
    name = str(getattr(found.name, "value", found.name))
    causes = tuple(kind for kind in kinds_of(found.name) if kind != UNKNOWN)
    listed = {UNKNOWN: (), name: causes}
    enough = {kind for one in found.sufficient for kind in listed.get(str(one.value), kinds_of(one))}
    if len(causes) > 1:
        enough -= set(causes)
    no = {kind for e in found.experiments if e.suffices is False for kind in kinds_of(e.cause)}
    shares = [
        Share(kinds_of(e.cause)[0], e.displacement, e.share)
        for e in found.experiments
        if e.displacement is not None and len(kinds_of(e.cause)) == 1
    ]
    return Said(causes, frozenset(enough), tuple(shares), refused=frozenset(no))


EXACT_FORMS = frozenset({"exact", "sympy"})
OWN = frozenset({"double", "single", "quad", "rounded", "interval", *EXACT_FORMS})
"""Engines whose law is the exact one's, carried out in other numbers: the same loop, contacts and policies."""

# -- the rules


@dataclass(frozen=True)
class Refutation:
    """A claim that another run contradicts.

    Attributes:
        claim: the kind that was named, or said to suffice; `account` for shares.
        rule: which of the rules.
        because: what the other run did.
    """

    claim: str
    rule: str
    because: str


CLOSE = 1e-6
"""To what part of the displacement the shares have to add up: they are shown with six digits, and are doubles."""

NEAR = 0.05
"""How far a displacement may be from that of the states that a run reports, whose circles are doubles."""

FIRST = 0.15
"""How far what is taken to the first order may be from a nearby run: it is taken where the second is below a tenth."""

TOUCH = 2.0**-30
"""A gap, as a share of the radii, that no honest double makes of a contact; and a speed of approach that is none."""


def account(said: Said) -> Iterator[Refutation]:
    """Whether the account adds up, and is led by its largest share, of those that were not seen to be too little.

    Arithmetic that was seen to be too little as a whole does not lead by a part of itself, against which the rest acts.
    """
    told = [s for s in said.shares if s.contribution is not None]
    if said.displacement is not None and told:
        total = math.fsum(s.contribution or 0.0 for s in told)
        size = math.fsum(abs(s.contribution or 0.0) for s in told)
        closes = abs(total - said.displacement) <= CLOSE * max(size, abs(said.displacement))
        if said.closed and not closes:
            yield Refutation("account", "sum", f"the contributions add up to {total!r}, not {said.displacement!r}")
        for s in told:
            ratio = (s.contribution or 0.0) / said.displacement if said.displacement else None
            if s.share is not None and ratio is not None and abs(ratio - s.share) > CLOSE * max(1.0, abs(ratio)):
                yield Refutation("account", "share", f"{s.kind}: {s.share!r} is said, {ratio!r} is what it contributes")
    for claim in sorted(said.suffices & ROUNDING):
        own = [s.contribution for s in said.shares if s.kind == claim]
        if own and None not in own and not any(own):
            yield Refutation(claim, "moves nothing", "it is said to suffice, and to move the decision by 0")
    parts = [s.share for s in said.shares if s.share is not None]
    if said.closed and parts and abs(math.fsum(parts) - 1) > CLOSE * max(1.0, math.fsum(map(abs, parts))):
        yield Refutation("account", "sum", f"the shares add up to {math.fsum(parts)!r}")
    main = said.causes[0] if said.causes else None
    by_kind: Counter[str] = Counter()
    for s in said.shares:
        by_kind[s.kind] += s.share or 0.0  # type: ignore[assignment]
    if said.closed and main in by_kind and main in ROUNDING:
        little = said.refused | (OF_ARITHMETIC if ARITHMETIC in said.refused else set[str]())
        top = max((kind for kind in by_kind if kind == main or kind not in little), key=lambda kind: by_kind[kind])
        if by_kind[top] > by_kind[main] * (1 + CLOSE):
            yield Refutation(main, "largest share", f"{top} has {by_kind[top]:.3g}, {main} {by_kind[main]:.3g}")


def _input(runs: Runs, said: Said, claims: set[str]) -> Iterator[Refutation]:
    bits = runs.engine.bits
    if INPUT in claims:
        if not runs.engine.rounds_input:
            yield Refutation(INPUT, "no rounding", "the engine takes its input as it is")
        elif runs.input == REFUSED and not any(s.kind == INPUT and s.contribution for s in said.shares):
            yield Refutation(INPUT, "refused scene", f"in {bits} bits it is no scene: that is evidence of nothing")
        elif runs.input == PASSES:
            yield Refutation(INPUT, "exact on rounded", f"the exact run of the scene in {bits} bits passes the event")
    laws, lasts = runs.candidate.laws, runs.scene.settle or runs.scene.restitution == 0  # no account, but runs
    honest = lasts and runs.input == PASSES and laws is not None and bool(laws.kept)
    told = said.closed is False and said.causes and said.causes[0] in ROUNDING and runs.input != SAME
    if told and not (honest and said.causes[0] == ARITHMETIC):
        yield Refutation(said.causes[0], "not closed", "the account does not close, and no run says so either")
    if runs.engine.step is None and runs.engine.rounds_input and runs.input == SAME:
        same = f"the exact run of the scene in {bits} bits does the same"
        if INPUT in said.refused:
            yield Refutation("not " + INPUT, "exact on rounded", same)
        if claims & {PHANTOM, MISSED, TIE, LAW} and INPUT not in claims:
            yield Refutation(min(claims - ROUNDING), "exact on rounded", same)
        if claims & OF_ARITHMETIC and INPUT not in said.causes and not any(s.kind == INPUT for s in said.shares):
            yield Refutation(min(claims & OF_ARITHMETIC), "exact on rounded", same)


def _step(runs: Runs, said: Said, claims: set[str]) -> Iterator[Refutation]:
    if runs.engine.step is None:
        for claim in sorted(claims & (OF_STEP - {LATENESS, OVERLAP})):
            yield Refutation(claim, "no step", "the engine has no time step")
        return
    main = {said.causes[0]} if said.causes else set[str]()
    outranked = main & (ROUNDING | {LAW, PHANTOM, MISSED, TIE})
    if outranked and not (LAW in main and runs.broken) and runs.step_passes is not None:
        at = f"with a step of {runs.step_passes!r} on the same input it passes the event"
        yield Refutation(min(main), "finer step passes", at)
    for claim in sorted(claims & OF_STEP):
        states = [s for _, s in (runs.finest if claim in (STEP, TUNNELLING) else runs.finer)]
        if not states and runs.engine.finer() is None:
            yield Refutation(claim, "no finer step", "there is no finer step")
        elif claim == TUNNELLING and _without_thickness(runs):
            continue  # no step whatever has an end in that overlap
        elif claim in (STEP, TUNNELLING) and PASSES not in states and len(states) >= 3:
            yield Refutation(claim, "no finer step passes", f"none of {len(states)} finer steps does: {states}")


def _without_thickness(runs: Runs) -> bool:
    """Whether a point passes a segment, or the side of a polygon, of radius 0."""
    radii = {str(thing.id): thing.r for thing in (*runs.scene.circles, *runs.scene.segments, *runs.scene.polygons)}
    return all(not float(radii.get(str(name), 1)) for name in (runs.at.body, runs.at.expected))


def _law(runs: Runs, said: Said, claims: set[str]) -> Iterator[Refutation]:
    laws = runs.candidate.laws
    if LAW in claims and runs.engine.name in OWN:
        yield Refutation(LAW, "own engine", f"the law of {runs.engine.name} is the exact engine's")
    elif LAW in claims and laws is not None and laws.kept:
        yield Refutation(LAW, "law kept", laws.sentence)
    exempt = {LAW, MISSED, PHANTOM, *([ITERATIONS] if ITERATIONS in claims and PASSES in runs.firmer else [])}
    if said.causes and said.causes[0] not in exempt and runs.broken is not None:
        yield Refutation(said.causes[0], "law not kept", f"before the decision a law is not kept: {runs.broken}")


def _contacts(runs: Runs, said: Said, claims: set[str]) -> Iterator[Refutation]:
    at = runs.at
    if TIE in claims and not runs.tied:
        yield Refutation(TIE, "no tie", "the exact run has no two contacts of one instant up to there")
    if PHANTOM in claims:
        if at.kind is Kind.MISSING:
            yield Refutation(PHANTOM, "nothing extra", "the engine has no contact there that the reference lacks")
        elif runs.got is not None and runs.engine.step is None:
            gap, speed = runs.got
            if abs(gap) <= TOUCH and speed > TOUCH:
                yield Refutation(PHANTOM, "real contact", f"they touch to {gap:.2g}, and approach at {speed:.3g}")
    if MISSED in claims:
        if at.kind is Kind.EXTRA:
            yield Refutation(MISSED, "nothing missing", "the engine lacks no contact there")
        elif runs.least is not None and runs.least > TOUCH:
            yield Refutation(MISSED, "never touch", f"in its own flights the two stay {runs.least:.2g} radii apart")


def _alone(runs: Runs, said: Said, claims: set[str]) -> Iterator[Refutation]:
    """But for so many contacts, the one in question among them, every circle meets whom it meets in the reference.

    That is as far as both runs go. What they leave of velocities is seen where nothing else is in their instants.
    """
    at, run = runs.at, runs.candidate.trajectory
    if not said.without or at.candidate_event is None or at.got is None:
        return
    reference = ExactEngine().run(runs.scene, events=max(len(run.events), at.event + PAST))
    over = reference.stop.reason is StopReason.QUIET
    mine, theirs = (met(t) for t in (reference, run))
    named, more = (at.candidate_event, frozenset({at.body, at.got})), Counter[tuple[int, frozenset[str]]]()
    for name, meetings in theirs.items():
        due, left = [partner for _, partner in mine.get(name, [])], Counter({named: 1})
        for event, partner in meetings:
            if due[:1] == [partner] and left[event, frozenset({name, partner})] <= 0:
                due.pop(0)
            elif due or over:
                left[event, frozenset({name, partner})] -= 1
        more |= Counter({key: -many for key, many in left.items()})  # of a pair both have it
    if more.total() > said.without - 1:
        told = f"{' meets '.join(sorted(min(more)[1]))} as well"
        yield Refutation(PHANTOM, "something else", f"{told}: {more.total()} contacts too many beside the one")
    states = [run.at(0), *(run.after(e.index) for e in run.events)]
    fastest = max(math.hypot(*row[2:]) for state in states for row in rows_of(state).values())
    for event in sorted({named[0], *(event for event, _ in more)}):
        pushes = Counter(frozenset(pair) for pair in run.events[event].impulses)
        extra = Counter({pair: many for (index, pair), many in (more + Counter([named])).items() if index == event})
        if pushes <= extra and pushed(run, event) > FAINT * 2.0 ** -(runs.engine.bits or 53) * fastest:
            yield Refutation(PHANTOM, "real contact", f"event {event} of the engine changes a velocity")


FAINT = 2**10
"""Units in the last place of the greatest speed that contacts below rounding may change a velocity by."""


def entered_in_one(runs: Runs) -> set[tuple[str, str]]:
    """Who has entered which pocket by the divergence in one of the two runs alone, with no contact of its own since."""
    if not runs.scene.capture:
        return set()
    last = 2 * max(t for t in (runs.at.time, runs.at.expected_time, runs.at.got_time) if t is not None)
    reference, names = ExactEngine().run(runs.scene, until=last), {runs.at.body, *runs.at.partners}

    def entered(run: Trajectory) -> set[tuple[str, str]]:
        told: set[tuple[str, str]] = set()
        for entry in run.pocketings:
            since = sum(
                entry.circle in pair for e in run.events if float(e.time) <= float(entry.time) for pair in e.impulses
            )
            among = entry.circle in names and float(entry.time) <= last
            if among and since == _met(reference, runs.at.event, entry.circle):
                told.add((entry.circle, entry.pocket))
        return told

    return entered(reference) ^ entered(runs.candidate.trajectory)


def _met(run: Trajectory, upto: int, name: str | None) -> int:
    """How many contacts a circle has before an event."""
    return sum(name in pair for event in run.events[:upto] for pair in event.impulses)


def _account(runs: Runs, said: Said, claims: set[str]) -> Iterator[Refutation]:
    """The displacement is that of the engine's own state; what rounding the input does is that of a nearby run."""
    at, bits = runs.at, runs.engine.bits
    if runs.engine.step is not None or at.kind is Kind.TIE or said.displacement is None:
        return
    with localcontext() as context:
        context.prec = PRECISE
        reference = ExactEngine().run(runs.scene, events=max(at.event, 1))
        if len(reference.events) < at.event:
            return
        taken = entered_in_one(runs)
        exact = decisions(runs.scene, reference, at.event, at, taken)
        if at.candidate_event is not None:
            given = runs.scene if not taken or runs.given is None else runs.given  # the rims as the engine has them
            own = decisions(given, runs.candidate.trajectory, at.candidate_event, at, taken)
            walls = {str(wall.id) for wall in runs.scene.walls}  # which are where they were, whoever meets them
            moved = {
                name
                for name in (at.expected, at.got)
                if name not in walls
                and _met(reference, at.event, name) != _met(runs.candidate.trajectory, at.candidate_event, name)
            }  # one of the two has met something else meanwhile, in one of the runs
            if at.got in walls:
                moved |= {at.expected, at.got}  # whether the circle comes to the wall may be what was decided
            both = {
                key: float(own[key] - exact[key])
                for key in exact.keys() & own.keys()
                if not any(key == f"gap to {name}" for name in moved) and not (moved and key == "time between")
            }
            if runs.candidate.margin is not None and runs.candidate.margin.speed is None:
                both = {key: by for key, by in both.items() if not key.startswith("speed")}  # a number of another kind
            decision = math.fsum(s.contribution or 0.0 for s in said.shares if s.kind == DECISION)
            moves = said.displacement - (decision if taken else 0.0)  # what the states have
            close = [key for key, by in both.items() if abs(abs(by) - abs(moves)) <= NEAR * abs(by)]
            left_out = any(f"gap to {name}" in exact and f"gap to {name}" in own for name in moved)
            things = {str(thing.id) for thing in (*runs.scene.segments, *runs.scene.polygons, *runs.scene.arcs)}
            left_out = left_out or any(  # how deep it would come in is not looked at
                name in things and f"gap to {name}" not in both for name in (at.expected, at.got)
            )
            # a wall decides only where one run flies from it
            told = [key for key in both if not key.startswith("speed")]
            if told and not close and not left_out:  # else the decision may be about what has moved
                yield Refutation(
                    "account", "displacement", f"{said.displacement!r} is said; from the states it is {both}"
                )
            decided = any(exact[key] * own[key] <= 0 for key in close)  # it is of one of them
            for key in () if decided else close:
                alike = key == "time between" or both[key] * said.displacement > 0  # else it is no more than as large
                if exact[key] * own[key] > 0 and len(both) == len(close) and alike:
                    yield Refutation(
                        "account", "same side", f"{key} is {exact[key]:.3g} and {own[key]:.3g}: that decides nothing"
                    )
        for share in said.shares:
            if share.kind == INPUT and share.how == "tangent" and share.contribution and runs.engine.rounds_input:
                moved = ExactEngine().run(rounded_scene(runs.scene, bits, SMALL), events=max(at.event, 1))
                near = decisions(runs.scene, moved, at.event, at, taken)
                slopes = {key: float((near[key] - exact[key]) / decimal(SMALL)) for key in told or both if key in near}
                if slopes and all(abs(abs(by) - abs(share.contribution)) > FIRST * abs(by) for by in slopes.values()):
                    yield Refutation(INPUT, "tangent", f"{share.contribution!r} is said; nearby runs say {slopes}")


def _iterations(runs: Runs, said: Said, claims: set[str]) -> Iterator[Refutation]:
    if ITERATIONS in claims and PASSES not in runs.firmer:
        yield Refutation(ITERATIONS, "firmer", f"with four and sixteen times as many: {runs.firmer}")


RULES: tuple[Callable[[Runs, Said, set[str]], Iterator[Refutation]], ...] = (
    _input,
    _step,
    _law,
    _contacts,
    _account,
    _alone,
    _iterations,
)


def refute(scene: Scene, engine: Any, candidate: Candidate, said: Said | None = None) -> list[Refutation]:
    """Everything that other runs say against what is said of a candidate; empty for one that did not diverge."""
    if candidate.alignment.divergence is None or candidate.unable:
        return []
    if said is None and candidate.diagnosis is None:
        return []
    said = said_of(candidate) if said is None else said
    claims = set(said.suffices) | set(said.causes[:1])
    if len(said.causes) > 1 and not said.suffices & set(said.causes):
        claims -= set(said.causes)  # neither is said to be enough by itself
    runs = Runs(scene, engine, candidate)
    found = [*account(said)]
    for rule in RULES:
        found += rule(runs, said, claims)
    return found


# -- what it is tried on


@dataclass(frozen=True)
class Job:
    """A scene, an engine by name, and how far."""

    label: str
    scene: Scene
    engine: str
    events: int | None = None


def placements(count: int = 180) -> list[Scene]:
    """Three discs in a row, two of them touching (newton-physics #3233), turned by rational angles and moved."""
    places = [(Fraction(0), Fraction(0)), (Fraction(1, 3), Fraction(1, 7)), (Fraction(10), Fraction(3))]
    places += [
        (Fraction(-1000, 7), Fraction(5, 3)),
        (Fraction(1, 10), Fraction(-1, 10)),
        (Fraction(99), Fraction(1, 11)),
    ]
    scenes: list[Scene] = []
    for k in range(count):
        turn, (x, y) = Fraction(k // len(places), 30), places[k % len(places)]
        cos, sin = (1 - turn**2) / (1 + turn**2), 2 * turn / (1 + turn**2)
        if k % 4 >= 2:
            cos, sin = -sin, cos
        at = [(str(x + cos * a), str(y + sin * a)) for a in (Fraction(-31, 100), Fraction(0), Fraction(1, 10))]
        first = Circle(*at[0], "1/20", str(2 * cos), str(2 * sin), id="A")
        others = [Circle(*at[1], "1/20", id="B"), Circle(*at[2], "1/20", id="C")]
        scenes.append(Scene([first, *others], name=f"newton-3233, placement {k}", until=1))
    return scenes


def placed() -> Iterator[Job]:
    """Every placement in `double` and `single`."""
    for scene in placements():
        for name in ("double", "single"):
            yield Job(scene.name, scene, name)


def racks() -> Iterator[Job]:
    """Racks of two to five rows, gapped and touching, in pymunk at four steps."""
    for rows in (2, 3, 4, 5):
        for gap in ("0", "1/50"):
            for step in ("1/64", "1/256", "1/1024", "1/4096"):
                spec = f"rack:rows={rows},gap={gap}"
                yield Job(spec, catalogue.build(spec), f"pymunk:dt={step}", 24)


def rests() -> Iterator[Job]:
    """Scenes in which walls carry what has come to rest, or slides, in the engines that follow it."""
    names = ("double", "single", "quad", "interval", "rounded:bits=12", "rounded:bits=16")
    for seed in range(60):
        for name in names:
            yield Job(f"settled {seed}", settled(seed), name, 40)
    for spec in ("landing", "landing:v=1/3", "struck", "struck:n=5", "struck:n=3,vx=2"):
        for name in names:
            yield Job(spec, catalogue.build(spec), name, 80)


def falls() -> Iterator[Job]:
    """Scenes with gravity, restitution and moving walls in the engines that take them."""
    names = ("pymunk:dt=1/64", f"pymunk:dt=1/64,collision_bias={0.9**60!r}", "pymunk", "double", "single")
    for seed in range(60):
        for name in (*names, "rounded:bits=12"):
            yield Job(f"fallen {seed}", fallen(seed), name, 40)
            yield Job(f"pegged {seed}", pegged(seed), name, 40)
            yield Job(f"edged {seed}", edged(seed), name, 40)
    for spec in (
        "bounce",
        "drop-pair",
        "wedge",
        "wedge:slope=2",
        "falling-line",
        "gas-under-gravity",
        "cooling",
        "beads",
        "axis",
        "peg-mirror",
        "galton",
        "plinko",
        "pinball-table",
        "ramp",
        "bowl",
        "ski-jump",
        "platforms",
    ):
        for name in names:
            yield Job(spec, catalogue.build(spec), name, 60 if name.startswith("pymunk") else 150)


CATALOGUE = (
    "article", "article:figure=diagonal", "cradle", "cradle:gap=0", "tennis", "sizes", "galperin:n=1", "lee",
    "near-tie", "near-tie:k=6", "near-tie:k=40,first=right", "inscribed", "inscribed:n=5", "rack:rows=3",
    "rack:rows=3,gap=1/50", "rack:rows=2,tie=sequential:order=scene", "gas", "gas:n=5,seed=3,mixed=yes",
    "reversal:n=5,after=40", "echo:rows=4,after=40", "pinball", "pinball:discs=3",
)  # fmt: skip
BUILT_IN = ("double", "single", "quad", "rounded:bits=24", "rounded:bits=40", "interval", "pymunk", "pymunk:dt=1/1024")


def pocketings() -> Iterator[Job]:
    """Scenes with pockets that take circles out of play, with gravity and without, and the table with jaws."""
    for seed in range(60):
        for name in ("double", "single", "rounded:bits=12", "rounded:bits=16"):
            yield Job(f"pocketed {seed}", pocketed(seed), name, 60)
    for offset in ("0", "1/7"):
        for name in ("double", "single", "rounded:bits=16"):
            yield Job(f"bumper:rows=3,offset={offset}", catalogue.build(f"bumper:rows=3,offset={offset}"), name, 60)


def stickings() -> Iterator[Job]:
    """Scenes at restitution 0 without gravity, where what has met stays closed, in engines of steps and of events."""
    for seed in range(60):
        for name in ("pymunk:dt=1/64", f"pymunk:dt=1/64,collision_bias={0.9**60!r}", "double", "rounded:bits=12"):
            yield Job(f"sticking {seed}", sticking(seed), name, 20)


def every_scene() -> Iterator[Job]:
    """Every scene of the catalogue in every engine that is built in."""
    listed = {spec.partition(":")[0] for spec in CATALOGUE}
    for spec in (*CATALOGUE, *(name for name in catalogue.names() if name not in listed)):
        for name in BUILT_IN:
            yield Job(spec, catalogue.build(spec), name, 24 if name.startswith("pymunk") else 220)


SURVEYED = {
    "box2d": "Box2D",
    "rapier": "rapier3d",
    "mujoco": "mujoco",
    "billiards": "billiards",
    "pooltool": "pooltool",
}
"""Engines of others, and the module of each; `perfect-physics` is too slow for these scenes."""

SURVEY = {
    "cradle:gap=0": 12, "cradle": 12, "tennis": 12, "galperin:n=1": 31, "rack:rows=3,pockets=no,speed=8": 12,
    "rack:rows=3,pockets=no,speed=8,gap=1/10": 12, "gas": 40, "lee": 2, "near-tie": 4, "inscribed": 12, "pinball": 20,
}  # fmt: skip


def surveyed() -> Iterator[Job]:
    """The survey's scenes in the engines of others that are installed."""
    for name, module in SURVEYED.items():
        if find_spec(module) is not None:
            for spec, events in SURVEY.items():
                yield Job(spec, catalogue.build(spec), name, events)


CAMPAIGNS: dict[str, Callable[[], Iterator[Job]]] = {
    "placements": placed,
    "racks": racks,
    "catalogue": every_scene,
    "survey": surveyed,
    "falls": falls,
    "rests": rests,
    "pocketings": pocketings,
    "stickings": stickings,
}


@dataclass(frozen=True)
class Outcome:
    """What became of one job."""

    label: str
    engine: str
    verdict: str
    event: int | None
    causes: tuple[str, ...]
    suffices: tuple[str, ...]
    refutations: tuple[Refutation, ...]


def tried(job: Job) -> Outcome:
    """Compares, and tries to refute."""
    engine = engine_named(job.engine)
    try:
        limits: dict[str, Any] = {} if job.events is None else {"events": job.events}
        candidate = compare(job.scene, [engine], **limits).candidates[0]
    except SceneError as error:
        return Outcome(job.label, job.engine, f"refused: {error}", None, (), (), ())
    at = candidate.alignment.divergence
    if at is None or candidate.diagnosis is None or candidate.unable:
        return Outcome(job.label, job.engine, candidate.verdict, None, (), (), ())
    said = said_of(candidate)
    against = refute(job.scene, engine, candidate, said)
    enough = tuple(sorted(said.suffices))
    return Outcome(job.label, job.engine, candidate.verdict, at.event, said.causes, enough, tuple(against))


def campaign(names: Iterable[str], only: str = "") -> Iterator[Outcome]:
    """What becomes of every job of some campaigns, those whose label or engine has `only` in it."""
    for name in names:
        for job in CAMPAIGNS[name]():
            if only in f"{job.label} {job.engine}":
                yield tried(job)


def main(arguments: list[str]) -> int:
    """Runs campaigns; exits with 1 where a claim is refuted."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("campaigns", nargs="*", choices=[*CAMPAIGNS, []], default=[])
    parser.add_argument("--only", default="", help="text in the scene or the engine")
    parser.add_argument("--json", default="", help="a file for every outcome, a line each")
    given = parser.parse_args(arguments)
    said, against = Counter[str](), Counter[tuple[str, str]]()
    for one in campaign(given.campaigns or CAMPAIGNS, given.only):
        if given.json:
            with Path(given.json).open("a", encoding="utf-8") as file:
                file.write(json.dumps(asdict(one)) + "\n")
        if one.event is None:
            continue
        said[one.causes[0] if one.causes else UNKNOWN] += 1
        for refutation in one.refutations:
            against[refutation.claim, refutation.rule] += 1
            print(f"{one.label} {one.engine} event {one.event}: {refutation.claim}: {refutation.because}", flush=True)
    print("named:", ", ".join(f"{kind} {count}" for kind, count in said.most_common()))
    refuted = ", ".join(f"{claim} ({rule}) {count}" for (claim, rule), count in against.most_common())
    print("refuted:", refuted or "none")
    return 1 if against else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
