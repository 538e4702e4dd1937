"""A comparison in sentences."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import zip_longest
from typing import TYPE_CHECKING

from ...scenarios.trajectory import AT_AN_END, StopReason
from ..alignment.align import UNKNOWING, VERDICTS
from ..alignment.instants import Kind
from ..causes.diagnosis import NO_CAUSE
from ..files.amounts import counted
from ..outcomes.permitted import PatternRelation
from ..tangent.growth import error_growth

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory
    from ..candidate import Candidate
    from ..chaos.foreseen import Foreseen
    from ..comparison import Comparison


LONGEST_LIMIT = 48
"""Characters of a reason to stop with a time limit that is read at a glance."""


CHAOS_BITS, CALM_BITS = 10.0, 3.0
"""Bits by which errors have grown at a divergence from which on it is called chaos, and below which a close call."""


def verdict_sentence(comparison: Comparison) -> str:
    """The one sentence that a report leads with.

    A time step or a difference of model is not called floating-point error, and "did not change what happened" is said
    only where every outcome is the same too.
    """
    by_verdict = {verdict: [c for c in comparison.candidates if c.verdict == verdict] for verdict in VERDICTS}
    reference, events = comparison.reference, counted(len(comparison.reference.events), "event")
    agreeing = [c.engine for c in by_verdict["agree"]]
    lawless = [c for c in comparison.candidates if c.lawless]
    if by_verdict["diverged"]:
        first = headline(comparison)
        assert first is not None
        spared = f"{listed(agreeing)} {'agrees' if len(agreeing) == 1 else 'agree'}, but " if agreeing else ""
        besides = [c for c in lawless if c is not first or not first.by_law]
        others = "".join(f" {c.engine} does not keep the law: {law_phrase(c)}." for c in besides)
        law = f"{law_phrase(first)}; " if first.by_law else ""
        return f"{head_phrase(first)}: {law}{spared}{divergence_phrase(comparison, first)}{others}"
    if lawless and by_verdict["agree"] and lawless[0].verdict == "agree":
        first = lawless[0]
        spared = [c.engine for c in by_verdict["agree"] if not c.lawless]
        kept = f"; {listed(spared)} {'keeps' if len(spared) == 1 else 'keep'} it" if spared else ""
        others = [c.engine for c in lawless[1:]]
        kept += f"; {listed(others)} {'does' if len(others) == 1 else 'do'} not keep it either" if others else ""
        name = f" ({first.engine})" if len(comparison.candidates) > 1 else ""
        return f"The collisions are right, the law is not: {law_phrase(first)}{name}{kept}."
    broken = "".join(f"{c.engine} does not keep the law: {law_phrase(c)}. " for c in lawless)
    stopped = f"the {reference.engine} run itself stopped after {events}: {reference.stop.message}"
    unsettled = listed([c.engine for c in by_verdict["unsettled"]])
    undecided = listed([c.engine for c in by_verdict["undecided"]])
    if by_verdict["unsettled"]:
        where = f"the {reference.engine} run near its end"
        told = f"Not settled: these runs do not show whether {unsettled} diverges from {where}"
        return broken + "; ".join([told, *filter(None, map(further_phrase, by_verdict["unsettled"]))]) + "."
    if comparison.verdict == "undecided" and not by_verdict["undecided"]:
        return f"Undecided: {stopped}."
    if not agreeing:
        return broken + f"Undecided: {undecided} could not follow the {reference.engine} run to the end."
    verb = "agrees" if len(agreeing) == 1 else "agree"
    rest = f"; {undecided} could not follow to the end" if by_verdict["undecided"] else ""
    same = f"{listed(agreeing)} {verb} with the {reference.engine} run{all_of(len(reference.events))}{rest}."
    changed = sorted({name.replace("_", " ") for c in by_verdict["agree"] for name in c.changed})
    if changed:
        return f"No collision changed, but an outcome did ({', '.join(changed)}): {same}"
    if not comparison.certain:
        unknown = "this does not tell whether floating point changed what happened"
        return f"No difference: {same} {reference.engine} proves nothing, so {unknown}."
    return f"Floating point did not change what happened: {same}"


def law_phrase(candidate: Candidate) -> str:
    """What explains that an engine does not keep the law, or the first step that misses it."""
    return "" if candidate.laws is None else candidate.laws.finding


def headline(comparison: Comparison) -> Candidate | None:
    """The engine that the sentence is about: of those that diverge, the first.

    One that does not keep the law comes before all others, and one whose rounding did it before the rest.
    """
    left = [c for c in comparison.candidates if c.verdict == "diverged"]
    first = [c for c in left if c.by_law] or [c for c in left if _is_rounding(c)] or left
    return min(first, key=_place, default=None)


def further_phrase(candidate: Candidate) -> str | None:
    """How far a run that ended too early has to go on; None if it is the reference that does not go far enough."""
    wanted, run = candidate.alignment.wanted.candidate, candidate.trajectory
    if wanted is None:
        return None
    name, end = candidate.engine, f"t = {float(run.final_time):.9g}"
    if run.stop.reason in AT_AN_END:
        return f"{name} ends at {end}: {run.stop.message}"
    if math.isinf(wanted):
        return f"{name} is known up to {end} only: record it until nothing is left to happen, and say so at its end"
    return f"{name} is known up to {end} only: record it farther (t = {wanted:.9g} is enough in any case)"


def _is_rounding(candidate: Candidate) -> bool:
    """Whether rounding is to blame, as far as is known: not a law, a time step, or a difference of model."""
    if candidate.by_law:
        return False
    found = candidate.diagnosis
    known = None if found is None else found.name.entry.rounding
    unseen = candidate.laws is not None and not candidate.laws.kept  # another law may have done it
    unseen = unseen or (found is not None and found.unexplained)
    return not (candidate.stepped or unseen) if known is None else known


def head_phrase(candidate: Candidate) -> str:
    """What changed what happened, as far as is known."""
    if candidate.by_law:
        return f"{candidate.engine} does not keep the law"
    if _is_rounding(candidate):
        cause = "" if candidate.diagnosis is None else f" ({candidate.diagnosis})"
        return f"Floating point changed what happened{cause}"
    return candidate.diagnosis.name.entry.head if candidate.diagnosis else NO_CAUSE


def _place(candidate: Candidate) -> tuple[float, int]:
    divergence = candidate.alignment.divergence
    assert divergence is not None
    return divergence.time, divergence.event


def divergence_phrase(comparison: Comparison, candidate: Candidate) -> str:
    """Who first does what else, and when."""
    divergence = candidate.alignment.divergence
    assert divergence is not None
    scene = comparison.scene
    where = f"{candidate.engine} first differs at event {divergence.event} ({_when(comparison, candidate)})"
    body = named(scene, divergence.body)
    match divergence.kind:
        case Kind.DIFFERENT:
            what = f"{body} meets {named(scene, divergence.got)} instead of {named(scene, divergence.expected)}"
        case Kind.MISSING:
            what = f"{body} does not meet {named(scene, divergence.expected)}{_looked(candidate.trajectory)}"
        case Kind.EXTRA:
            what = f"{body} meets {named(scene, divergence.got)}, which it should not"
        case Kind.TIE if divergence.got == divergence.expected:
            what = f"{body} meets {tied(divergence.got)}, as it should, but the impulses lead to other velocities"
        case Kind.TIE:
            what = f"{body} meets {tied(divergence.got)} where it should meet {tied(divergence.expected)}"
    return f"{where}: {what}."


def _when(comparison: Comparison, candidate: Candidate) -> str:
    """When the histories part, by the clocks of both runs, and the engine's own number where it is another."""
    divergence = candidate.alignment.divergence
    assert divergence is not None
    runs = (comparison.reference.engine, divergence.expected_time), (candidate.engine, divergence.got_time)
    known = [(name, time) for name, time in runs if time is not None]
    times = {f"{time:.9g}" for _, time in known}
    told = f"t = {times.pop()}" if len(times) == 1 else ", ".join(f"t = {time:.9g} in {name}" for name, time in known)
    own = divergence.candidate_event
    return told if own is None or own == divergence.event else f"{told}; event {own} of {candidate.engine}"


def _looked(run: Trajectory) -> str:
    """How far a run that lacks a contact goes: it may have it later."""
    end = float(run.final_time)
    return f" by t = {end:.6g}" if math.isfinite(end) else ""


def named(scene: Scene, name: str | None) -> str:
    """A thing by kind and id.

    >>> from truebreak.scenarios import Circle, Scene, Segment
    >>> scene = Scene([Circle(0, 5, id="b3")], segments=[Segment(0, 0, 1, 0, id="bar")])
    >>> named(scene, "b3"), named(scene, "bar")
    ('circle b3', 'segment bar')
    """
    if name is None:
        return "nothing"
    kinds = {"wall": scene.walls, "segment": scene.segments, "polygon": scene.polygons, "arc": scene.arcs}
    kind = next((kind for kind, things in kinds.items() if any(thing.id == name for thing in things)), "circle")
    return f"{kind} {name}"


def tied(partners: str | None) -> str:
    """The partners of a tie in words.

    >>> tied("a + b"), tied("a then b")
    ('a and b at once', 'a, then b')
    """
    groups = [group.split(" + ") for group in (partners or "nothing").split(" then ")]
    return ", then ".join(f"{listed(names)} at once" if len(names) > 1 else names[0] for names in groups)


def all_of(number: int) -> str:
    """In all events, in words, after a run.

    >>> all_of(0), all_of(1), all_of(60)
    (', in which nothing happens', ' in its one event', ' in all 60 events')
    """
    few = {0: ", in which nothing happens", 1: " in its one event"}
    return few.get(number, f" in all {counted(number, 'event')}")


def listed(words: list[str]) -> str:
    """Words as a list in a sentence.

    >>> listed(["a"]), listed(["a", "b", "c"])
    ('a', 'a, b and c')
    """
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}" if words else "no engine"


def short(value: float | None) -> str:
    """A small number for a table; a dash for none, and for nan.

    >>> short(1.23456e-9), short(None), short(0.0)
    ('1.23e-09', '-', '0')
    """
    return "-" if value is None or math.isnan(value) else f"{value:.3g}"


def pattern_phrase(comparison: Comparison, candidate: Candidate) -> str | None:
    """Which of the four classes the engine's pattern is in, if several are permitted."""
    permitted, pattern = comparison.permitted, candidate.pattern
    if permitted is None or pattern is None or candidate.verdict != "diverged":
        return None
    if permitted.orders == (permitted.exact,):  # no order matters, so that there is nothing to choose from
        return None
    policy = permitted.policy(pattern)
    found = counted(len(permitted.orders), "pattern")
    witness = permitted.witness(pattern)
    scene = witness.scene.name if witness else ""
    checked = ", and independently checked" if witness and witness.certificate and witness.certificate.checked else ""
    told = {
        PatternRelation.OWN: "the policy's own",
        PatternRelation.REALISABLE: f"realisable: {scene} comes to it, certified{checked}",
        PatternRelation.SOME_ORDER: f"some order of the impulses leads to it, but none of "
        f"{permitted.tried} nearby scenes",
        PatternRelation.NO_ORDER: f"no order of the impulses leads to it: not among {found} over all orders",
        PatternRelation.NOT_FOUND: f"not found among {counted(permitted.followed, 'order')} followed; there are more",
    }[permitted.relation(pattern)]
    return f"{told}; the exact engine has it under {policy}" if policy and pattern != permitted.exact else told


def consequence_phrase(comparison: Comparison, candidate: Candidate) -> str | None:
    """What the divergence comes to: the collisions, and the circle that ends with the velocity farthest off.

    Of a run that ends before the span does, up to its end: what lies beyond is not settled.
    """
    mine, theirs, parts = candidate.expected, candidate.outcomes, []
    if "collisions" in candidate.changed:
        parts.append(f"{counted(theirs['collisions'], 'collision')} instead of {mine['collisions']:,}")
    if "final_velocities" in candidate.changed:
        expected, got = mine["final_velocities"], theirs["final_velocities"]
        name = max(expected, key=lambda circle: math.dist(expected[circle], got[circle]))
        pairs = [f"({vx:.6g}, {vy:.6g})" for vx, vy in (got[name], expected[name])]
        verb = "ends with" if candidate.until is None else "then has"
        parts.append(f"{named(comparison.scene, name)} {verb} velocity {pairs[0]} instead of {pairs[1]}")
    told, until = "; ".join(parts), until_phrase(candidate)
    return f"{until}: {told}" if told and until else told or None


def until_phrase(candidate: Candidate) -> str | None:
    """How far a run tells outcomes that ends before the span does; None if it tells all of the span."""
    if candidate.until is None:
        return None
    from ..foreign.recording import RECORD_ENDS

    recorded = candidate.trajectory.stop.message.startswith(RECORD_ENDS)
    return f"up to t = {candidate.until:.9g}, where its {'record' if recorded else 'run'} ends"


def entry_words(entry: tuple[str, str], distance: tuple[float, float]) -> str:
    """How far the centre of a circle passes the rim of a pocket, and on which side.

    >>> entry_words(("b1", "hole"), (-0.5, -0.5))
    'the centre of b1 passes 0.5 inside the rim of hole'
    """
    circle, pocket = entry
    side = "inside" if middle(distance) < 0 else "outside"
    return f"the centre of {circle} passes {about(distance)} {side} the rim of {pocket}"


def hit_words(distance: tuple[float, float]) -> str:
    """How deep two hit each other, or by how much they miss.

    >>> hit_words((-0.5, -0.5)), hit_words((2.0, 2.0))
    ('hits with penetration depth 0.5', 'misses by 2')
    """
    return f"{'hits with penetration depth' if middle(distance) < 0 else 'misses by'} {about(distance)}"


def margin_phrase(candidate: Candidate) -> str | None:
    """How close it was, how far off the engine was by then, and what that makes of it, in words."""
    margin = candidate.margin
    if margin is None:
        return None
    parts: list[str] = []
    if margin.gap is not None:
        if margin.gap == (0.0, 0.0):
            parts.append("the two fall on exactly the same instant")
        else:
            ulps = f" ({margin.ulps:.3g} spacings of a double)" if margin.ulps else ""
            parts.append(
                f"in the exact motion, had the first not happened, the second came {about(margin.gap)} later{ulps}"
            )
    elif margin.distance is not None:
        away = middle(margin.distance)
        if margin.distance == (0.0, 0.0):
            parts.append("in the exact motion they touch without depth: the gap is exactly 0")
        elif margin.distance[0] <= 0 <= margin.distance[1]:
            parts.append(f"in the exact motion it is {about(margin.distance)} from a touch")
        else:
            kind = "the penetration depth is" if away < 0 else "the gap is"
            passes = f"{kind} {about(margin.distance)}"
            if margin.entry is not None:
                passes = entry_words(margin.entry, margin.distance)
            parts.append(f"in the exact motion {passes}")
    elif margin.speed is not None:
        parts.append(f"the exact motion {wall_words(margin.speed)}")
    if margin.error is not None:
        told = margin.gap is None and margin.ratio is not None and math.isfinite(margin.ratio)
        ratio = f", {margin.ratio:.3g} times as much" if told else ""
        told = f"{margin.error:.3g} off by then{ratio}" if margin.error else f"off by {off(margin.error)} then"
        parts.append(f"the engine is {told}")
    if margin.growth is not None and margin.growth > 0:
        parts.append(f"errors grow by {margin.growth:.3g} bits an event")
    return "; ".join(parts) or None


def wall_words(speed: tuple[float, float]) -> str:
    """How a circle flies that comes to a wall in one run alone."""
    if speed == (0.0, 0.0):
        return "flies along the wall"
    return f"{'comes to' if middle(speed) < 0 else 'flies from'} the wall at speed {about(speed)}"


def span_phrase(comparison: Comparison) -> str:
    """How far histories were compared."""
    if math.isfinite(comparison.span):
        return f"to time {comparison.span:.9g}"
    return "for all time"


def ending_phrase(run: Trajectory) -> str:
    """How the motion itself ends a run, though time goes on; empty where it does not.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import catalogue
    >>> ending_phrase(ExactEngine().run(catalogue.build("bounce")))
    'it ends there: infinitely many collisions in finite time (ball and floor by 19)'
    """
    if run.stop.reason not in AT_AN_END:
        return ""
    what = run.stop.reason.value
    who = run.stop.message.removeprefix(what).removeprefix(": ")
    return f"it ends there{',' if ': ' in what else ':'} {what}{f' ({who})' if who else ''}"


SHOWN_SETTLINGS = 4
"""How many are listed in a sentence; the others are counted."""

SETTLED_BY = 1.0 - 2.0**-20
"""A share of the common time of two runs: what settles later may do so beyond the end of the other by rounding."""


SAME_TIME = 2.0**-20
"""A share of a time by which rounding may move it."""


def settled_phrase(comparison: Comparison) -> str:
    """What walls began to carry in the reference, and which engines have it otherwise; empty where nothing settles.

    >>> from truebreak.compare import compare
    >>> from truebreak.scenarios import catalogue
    >>> settled_phrase(compare(catalogue.build("landing"), ["double"]))
    'sitter on floor at time 0.774596669, slider on floor at time 1; the same in double'
    """
    reference, same, late, others = comparison.reference, list[str](), list[str](), list[str]()
    rows = [f"{s.circle} {s.where} at time {float(s.time):.9g}" for s in reference.settlings]
    for candidate in comparison.candidates:
        if comparison.scene.settle and not candidate.unable:
            apart = _settles_apart(comparison, candidate)
            if apart is not None:
                (same if apart <= SAME_TIME else late if apart < math.inf else others).append(candidate.engine)
    if not rows and not others:
        return ""
    more = f" and {len(rows) - SHOWN_SETTLINGS} more" if len(rows) > SHOWN_SETTLINGS else ""
    told = f"{', '.join(rows[:SHOWN_SETTLINGS])}{more}" if rows else f"nothing in {reference.engine}"
    told += f"; the same in {listed(same)}" if same else ""
    told += f"; at other times in {listed(late)}" if late else ""
    return told + (f"; otherwise in {listed(others)}" if others else "")


def _settles_apart(comparison: Comparison, candidate: Candidate) -> float | None:
    """How far the times are apart, as a share, at which walls begin to carry circles in two runs; infinity where they
    do not carry the same circles in the same order, each circle for itself, as long as both runs last.

    After a divergence nothing is compared. None where nothing but what lies from the start has settled by then.
    """
    runs, parted = (comparison.reference, candidate.trajectory), candidate.alignment.divergence
    ends = [float(run.final_time) for run in runs]
    times = () if parted is None else (parted.time, parted.expected_time, parted.got_time)
    end = min([*ends, *(time for time in times if time is not None)]) * SETTLED_BY
    apart: float | None = None
    for circle in map(str, comparison.scene.ids):
        rows = ([({s.wall, s.other}, float(s.time)) for s in run.settlings if s.circle == circle] for run in runs)
        for both in zip_longest(*rows):
            known = [row for row in both if row is not None]
            first, last = min(time for _, time in known), max(time for _, time in known)
            if first >= end:
                continue
            if len(known) < 2 or known[0][0] != known[1][0]:
                return math.inf
            if last > 0.0:
                apart = max(apart or 0.0, (last - first) / last)
    return 0.0 if apart is None and parted is None else apart


def _by_flight(time: float) -> float:
    """Bits by which a displacement of a velocity grows into one of a place in free flight: that is no chaos."""
    return math.log2(max(1.0, time)) if math.isfinite(time) else 0.0


def growth_phrase(comparison: Comparison, candidate: Candidate, foreseen: Foreseen | None) -> str:
    """How errors can grow to the end, or to a divergence without a margin, in the direction that grows most.

    Where an engine agrees and the growth is not measured to the end, that, and why it is not.
    """
    reference, parted = comparison.reference, candidate.alignment.divergence
    if foreseen is None:
        return ""
    unknown = ""
    if parted is None and foreseen.reason:
        beyond = f" beyond event {foreseen.events - 1:,}" if foreseen.events else ""
        unknown = f"Whether it is chaos{beyond} is not known: {foreseen.reason}."
    events = foreseen.events if parted is None else parted.expected_event
    growth = error_growth(reference, events) if 0 < events <= foreseen.events else None
    if growth is None:
        return unknown
    bits, last = growth * events, float(reference.events[events - 1].time)
    if bits - _by_flight(last) >= CHAOS_BITS:
        longer = parted is None and reference.stop.reason in (StopReason.EVENTS, StopReason.HORIZON)
        beyond = "; a longer run may diverge" if longer else ""
        return f"In the direction that grows most errors grow by {growth:.3g} bits an event, which is chaos{beyond}."
    if unknown:
        return unknown
    if bits - _by_flight(last) < CALM_BITS:
        return "It is not chaos: errors hardly grow on the way."
    return f"In the direction that grows most errors grow by {bits:.2g} bits on the way."


def ended_phrase(run: Trajectory) -> str:
    """Why a run ended. A time limit too long to be read, such as a double written exactly, is not told once more."""
    limited = run.stop.reason is StopReason.HORIZON and len(run.stop.message) > LONGEST_LIMIT
    return StopReason.HORIZON.value if limited else run.stop.message


def proof_phrase(comparison: Comparison) -> str:
    """What the reference's history rests on."""
    reference = comparison.reference
    if not comparison.certain:
        return f"{reference.engine} proves nothing: it is taken as the reference."
    told = "Every decision is proved" if reference.certified else "Not every tie in it is proved"
    return f"{told}{', up to its end' if reference.stop.reason in UNKNOWING else ''}."


def right_phrase(comparison: Comparison, candidate: Candidate) -> str:
    """What an engine is that agrees to the end; of a record without states no place and no velocity is known."""
    if comparison.certain and getattr(candidate.trajectory.motion, "reckoned", ()):
        return f"{candidate.engine} has the right contacts in the right order, all that it tells: it has no states"
    if comparison.certain:
        return f"Nothing to change: {candidate.engine} is right to the end"
    return "Take exact as the reference to know which are right"


def middle(bounds: tuple[float, float]) -> float:
    """The middle of two bounds.

    >>> middle((1.0, 2.0))
    1.5
    """
    return bounds[0] + (bounds[1] - bounds[0]) / 2


def about(bounds: tuple[float, float]) -> str:
    """The size of a number that is not zero, from its bounds; a bound where it is too small for a double.

    >>> about((0.25, 0.25)), about((-1e-310, 1e-310))
    ('0.25', 'less than 1e-310')
    """
    size = abs(middle(bounds))
    return f"{size:.3g}" if size else f"less than {max(map(abs, bounds)):.3g}"


def off(error: float) -> str:
    """How far an engine's places are off; places are compared as doubles.

    >>> off(0.0641), off(0.0)
    ('0.0641', 'less than double resolution')
    """
    return f"{error:.3g}" if error else "less than double resolution"


ACCOUNT = ("kind of error", "adds", "share", "alone", "what was seen")
"""Headings of the account."""


def account_rows(candidate: Candidate) -> list[tuple[str, str, str, str, str]]:
    """The account of a divergence: what each kind of error adds to the number that decides, and all of it."""
    found = candidate.diagnosis
    if found is None:
        return []
    words = {True: "changes it", False: "no", None: "-"}
    parts = [e.displacement if e.share is not None else None for e in found.experiments]
    adds = adding_up(parts, found.displacement) if found.closed and found.displacement else parts
    rows = [
        (
            e.cause.value,
            add if isinstance(add, str) else _signed(e.displacement),
            "-" if e.share is None else f"{round(e.share, 2) + 0.0:.0%}",
            words[e.suffices],
            e.result,
        )
        for e, add in zip(found.experiments, adds, strict=True)
    ]
    if found.closed and found.displacement is not None:
        told = f"the engine's value less the exact one; {counted(found.runs, 'continuation')} by the exact law"
        rows.append(("all of it", _signed(found.displacement), "100%", "-", told))
    return rows


def adding_up(parts: Sequence[float | None], total: float) -> list[str | None]:
    """Parts of a total, rounded to the place of its third digit so that they add up as they are shown.

    What is less than that place is shown to three digits of its own.

    >>> adding_up([-0.23361, 0.10631, 0.07108, None, 1e-9], -0.05622)
    ['-0.2336', '+0.1063', '+0.0711', None, '+1e-09']
    """
    place = math.floor(math.log10(abs(total))) - 2
    whole = [0 if part is None else round(part / 10.0**place) for part in parts]
    left = round(total / 10.0**place) - sum(whole)
    largest = sorted((k for k, n in enumerate(whole) if n), key=lambda k: -abs(whole[k]))
    for k in largest[: abs(left)]:
        whole[k] += 1 if left > 0 else -1
    return [
        None if part is None else f"{n * 10.0**place:+.{len(str(abs(n)))}g}" if n else _signed(part)
        for part, n in zip(parts, whole, strict=True)
    ]


def _signed(value: float | None) -> str:
    return "-" if value is None else f"{value:+.3g}" if value else "0"
