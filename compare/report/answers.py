"""The four answers that every report leads with: where an engine diverges, why, so what, and what to do now."""

from __future__ import annotations

import math
import re
import shlex
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ...exact.exact_motion import motion_of
from ...scenarios.errors import SceneError
from ...scenarios.trajectory import AT_AN_END, StopReason
from ..alignment.align import UNKNOWING
from ..alignment.instants import Kind
from ..alternatives import Alternative
from ..causes.diagnosis import SHARE_RANK, CauseName
from ..engines import ENGINES
from ..tangent.hazard import ErrorModel
from ..tangent.impacts import NoTangentMap, impacts
from .sentences import (
    CALM_BITS,
    CHAOS_BITS,
    about,
    account_rows,
    all_of,
    counted,
    ending_phrase,
    entry_words,
    growth_phrase,
    head_phrase,
    headline,
    hit_words,
    listed,
    off,
    right_phrase,
    tied,
    until_phrase,
    verdict_sentence,
    wall_words,
)

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory
    from ..candidate import Candidate
    from ..chaos.foreseen import Foreseen
    from ..chaos.horizon import Horizon
    from ..comparison import Comparison

LARGE = 0.1
"""Share of the shift from which on a kind of error is named."""

MOST_SHARES = 3
"""Kinds of error named at once."""

MOST_OUTCOMES = 3
"""Outcomes named at once."""


ALIKE = (0.75, 1.5)
"""Ratios of times, each measured once, between which they are called the same."""


@dataclass(frozen=True)
class Answers:
    """What a report says of one engine under the verdict; each is one or two sentences.

    Attributes:
        engine: the engine that they are about.
        where: the event at which it diverges: both bodies and both times.
        why: the largest shares of the account, and the margin beside the error.
        so_what: the outcomes that changed, after and before.
        what_now: what was run and is right, and until which event the engine is predicted to be right.
        command: a command that goes on from here.
        read: a page of the documentation.
    """

    engine: str
    where: str
    why: str
    so_what: str
    what_now: str
    command: str
    read: str


def answers(comparison: Comparison, candidate: Candidate | None = None, foreseen: Foreseen | None = None) -> Answers:
    """The answers about an engine; without one, about the engine that the verdict is about.

    Args:
        foreseen: what `chaos.foreseen` says of the comparison; without it nothing is predicted.

    >>> from truebreak.compare import compare
    >>> from truebreak.scenarios import catalogue
    >>> found = answers(compare(catalogue.build("near-tie:k=20"), ["double"]))
    >>> print(found.where.partition("; ")[0])
    From the first event on (event 0), at t = 1, double lets middle hit left and right at once
    >>> print(found.so_what)
    2 collisions instead of 4; middle ends with velocity (-1, 0) instead of (-0.32, 0); who hit whom changed too.
    """
    chosen = candidate or subject(comparison)
    return Answers(
        chosen.engine,
        where(comparison, chosen),
        why(comparison, chosen, foreseen),
        so_what(comparison, chosen),
        what_now(comparison, chosen, foreseen),
        command(comparison, chosen),
        read(comparison, chosen),
    )


def subject(comparison: Comparison) -> Candidate:
    """The engine that the verdict is about: one that diverges, one that breaks a law, one that agrees, or the first."""
    lawless = [c for c in comparison.candidates if c.lawless]
    agreeing = [c for c in comparison.candidates if c.verdict == "agree" and tone(comparison) == "agree"]
    rest = sorted(comparison.candidates, key=lambda c: c.verdict == "agree")
    return headline(comparison) or [*lawless, *agreeing, *rest][0]


def verdict_line(comparison: Comparison) -> str:
    """The verdict above the answers: what `verdict_sentence` says, without what they say.

    >>> from truebreak.compare import compare
    >>> from truebreak.scenarios import catalogue
    >>> verdict_line(compare(catalogue.build("near-tie:k=40"), ["double", "quad"]))
    'Floating point changed what happened: double diverges at event 0 of 4.'
    """
    if (first := headline(comparison)) is None or first.alignment.divergence is None:
        return verdict_sentence(comparison).partition(f": {comparison.reference.stop.message}")[0].rstrip(".") + "."
    head = "" if first.by_law else f"{head_phrase(first).partition(' (')[0]}: "
    law = "does not keep the law, and diverges" if first.by_law else "diverges"
    event, total = first.alignment.divergence.event, len(comparison.reference.events)
    place = f"at event {event:,}" if event < total else "after the last"
    return f"{head}{first.engine} {law} {f'{place} of {total:,}' if total else 'where the exact run has no event'}."


def tone(comparison: Comparison) -> str:
    """How the verdict is coloured: as what its sentence says."""
    if any(c.lawless or c.verdict == "diverged" for c in comparison.candidates):
        return "diverged"
    verdicts = {c.verdict for c in comparison.candidates}
    settled = "unsettled" not in verdicts and comparison.reference.stop.reason not in UNKNOWING
    return "agree" if "agree" in verdicts and settled else "undecided"


# -- Where.


def where(comparison: Comparison, candidate: Candidate) -> str:
    """The event at which the histories part, both bodies and both times."""
    reference, parted = comparison.reference, candidate.alignment.divergence
    name, events = candidate.engine, len(reference.events)
    if candidate.unable:
        return f"{name} cannot run this scene."
    if parted is None:
        if stopped(comparison, candidate):
            if not events:
                return f"The {reference.engine} run itself stops before its first event."
            upto = f"after {counted(events, 'event')}, at t = {float(reference.final_time):.6g}"
            agreed = f"; up to there {name} agrees" if candidate.verdict == "agree" else ""
            return f"The {reference.engine} run itself stops {upto}{agreed}."
        if candidate.verdict == "agree":
            whole = "the one event" if events == 1 else f"all {events:,} events"
            nowhere = f"Nowhere: {name} has {whole} of the {reference.engine} run." if events else NOTHING
            ending = ending_phrase(reference)
            return f"{nowhere} {_capital(ending)}." if ending else nowhere
        if candidate.verdict == "unsettled":
            return (
                f"Not settled: {counted(candidate.alignment.agreed, 'event')} agree, and {name} is not known further."
            )
        stops = f"{name} stops after {counted(candidate.alignment.agreed, 'agreed event')}"
        return f"{stops}, at t = {float(candidate.trajectory.final_time):.6g}: it cannot decide what comes next."
    first, other = _times(parted.got_time, parted.expected_time)
    agreed = candidate.alignment.agreed
    after = f"After {counted(agreed, 'agreed event')}" if agreed else "From the first event on"
    body, got, expected = parted.body, parted.got, parted.expected
    exact = f"in the {reference.engine} run"
    event = f"{after} (event {parted.event:,})" if agreed != parted.event or not agreed else after
    if first and first == other:  # to a reader they are one time, which is said once
        event, first, other = f"{event},{first},", "", ""
    match parted.kind:
        case Kind.TIE if got == expected:
            return (
                f"{event} {name} lets {body} hit {tied(got)}{first}, as it should, but with other velocities after it."
            )
        case Kind.TIE:
            return f"{event} {name} lets {body} hit {tied(got)}{first}; {exact} {body} hits {tied(expected)}{other}."
        case Kind.DIFFERENT:
            mine, theirs = thing(comparison.scene, got), thing(comparison.scene, expected)
            return f"{event} {name} lets {body} hit {mine}{first}; {exact} {body} hits {theirs}{other}."
        case Kind.MISSING:
            missed = thing(comparison.scene, expected)
            return f"{event} {name} lets {body} miss {missed}; {exact} {body} hits {missed}{other}."
        case Kind.EXTRA:
            return f"{event} {name} lets {body} hit {thing(comparison.scene, got)}{first}; {exact} it does not."


NOTHING = "Nowhere: nothing happens in this span."


def stopped(comparison: Comparison, candidate: Candidate) -> bool:
    """Whether the reference itself ends not knowing what comes next, so that no engine can be right to the end."""
    return comparison.reference.stop.reason in UNKNOWING and candidate.verdict == "agree"


def thing(scene: Scene, name: str | None) -> str:
    """A circle by its id, a wall as such.

    >>> from truebreak.scenarios import catalogue
    >>> thing(catalogue.build("gas"), "bottom"), thing(catalogue.build("gas"), "c7")
    ('wall bottom', 'c7')
    """
    if any(wall.id == name for wall in scene.walls):
        return f"wall {name}"
    return "nothing" if not name else name if name[0].isalpha() else f"circle {name}"


def _times(*times: float | None) -> list[str]:
    """Times with as many digits as it takes to tell them apart; six where ten do not."""
    known = [t for t in times if t is not None]
    digits = next((d for d in (6, 8, 10) if len({f"{t:.{d}g}" for t in known}) == len(set(known))), 6)
    return ["" if t is None else f" at t = {t:.{digits}g}" for t in times]


# -- Why.


def why(comparison: Comparison, candidate: Candidate, foreseen: Foreseen | None = None) -> str:
    """The largest shares of the account in words; for an engine that does not keep the law, what it does instead.

    Args:
        foreseen: with it also whether errors grow, of an engine that agrees, or where no margin is known.
    """
    name, found = candidate.engine, candidate.diagnosis
    if candidate.unable:
        return f"{_capital(candidate.trajectory.stop.message)}."
    if candidate.lawless and candidate.laws is not None:
        law, first = f"{name} does not keep the law: {candidate.laws.finding}.", candidate.laws.first
        if candidate.by_law or (at := candidate.alignment.divergence) is None:
            return law
        return f"{_share_words(candidate)} {'Later' if first and first.time > at.time else 'Besides,'} {law}"
    if found is None:
        if stopped(comparison, candidate):
            return f"{_capital(comparison.reference.stop.message)}."
        if candidate.verdict == "agree":
            if candidate.laws is None or candidate.laws.kept is None:
                small = f"No error of {name} changes an event."
                small += "" if candidate.laws is None else f" {_capital(candidate.laws.sentence)}."
            else:
                small = f"{name} {candidate.laws.sentence}; none of its errors changes an event."
            return " ".join(filter(None, [small, growth_phrase(comparison, candidate, foreseen)]))
        if candidate.verdict == "diverged":
            return " ".join(filter(None, ["Not looked into.", growth_phrase(comparison, candidate, foreseen)]))
        return f"{'' if _at_its_end(candidate) else 'Not looked into. '}{_capital(candidate.trajectory.stop.message)}."
    if candidate.verdict != "diverged":
        return f"{_capital(str(found))}: {found.finding}."
    told = [_share_words(candidate), _margin_words(candidate)]
    grown = _growth_words(candidate) or growth_phrase(comparison, candidate, foreseen)
    return " ".join(filter(None, told if found.name.name == "PARTING" else [*told, grown]))


def _share_words(candidate: Candidate) -> str:
    """What the kinds of error add to the number that decides; of a cause that a run shows, what was seen."""
    found = candidate.diagnosis
    assert found is not None
    cause = _capital(str(found))
    adds = {row[0]: row[1] for row in account_rows(candidate)}
    large = found.large(LARGE)[:MOST_SHARES]
    pushes = [e.cause.value for e in large if (e.share or 0.0) > 0]
    if not found.closed or not found.displacement or not pushes:
        return f"{cause}: {found.finding}."
    against = [e.cause.value for e in large if (e.share or 0.0) < 0]
    summed = lambda causes: listed([f"{cause} {adds[cause]}" for cause in causes])  # noqa: E731
    back = f", against it {summed(against)}" if against else ""
    if found.name.entry.rank < SHARE_RANK:
        return f"{cause}: {found.finding}. Shifts of the margin: {summed(pushes)}{back}."
    if pushes == [str(found)] and not against:
        return f"{cause}: the margin shifts by {found.displacement:+.3g}."
    leads = pushes == [c.value for c in found.causes] or pushes[0] == str(found)
    named = summed(pushes) if leads else f"{cause}: {summed(pushes)}"
    return f"{_capital(named)}{back}, shift the margin by {found.displacement:+.3g}."


def _margin_words(candidate: Candidate) -> str:
    """How close the decision was, and how far off the engine was."""
    margin, name = candidate.margin, candidate.engine
    if margin is None or margin.error is None:
        return ""
    error = f"{name} was {off(margin.error)} off by then" if margin.error else f"{name}'s places were off by {off(0.0)}"
    if margin.gap == (0.0, 0.0):
        return f"The contacts fall on exactly one instant; {error}."
    if margin.gap is not None:
        return f"{'Contact and entry' if margin.entry else 'The two'} are {about(margin.gap)} apart in time; {error}."
    if margin.speed is not None:
        return f"The exact run {wall_words(margin.speed)}; {error}."
    if margin.distance is None:
        return ""
    if margin.distance == (0.0, 0.0):
        return f"The exact run touches without depth; {error}."
    if margin.distance[0] <= 0 <= margin.distance[1]:
        return f"The exact run passes within {about(margin.distance)} of a touch; {error}."
    if margin.entry:
        return f"In the exact run {entry_words(margin.entry, margin.distance)}; {error}."
    return f"The exact run {hit_words(margin.distance)}; {error}."


def _growth_words(candidate: Candidate) -> str:
    """Whether errors grew on the way to the divergence: chaos, none, or on the way to it."""
    margin, parted = candidate.margin, candidate.alignment.divergence
    if parted is not None and not parted.expected_event:
        return "It is no chaos: nothing happens before that instant in which errors could grow."
    if margin is None or margin.error is None or parted is None:
        return ""
    if (0.0, 0.0) in {margin.gap, margin.distance}:
        return "It takes no chaos: any error, however small, decides it."
    if margin.growth is None:
        return "Whether errors grow on the way is not known."
    bits = margin.growth * parted.expected_event
    if _chaotic(candidate):
        return f"It is chaos: errors grow by {margin.growth:.3g} bits an event."
    if bits < CALM_BITS:
        return "It is no chaos: errors hardly grow on the way."
    return f"It is on the way to chaos: errors grow by {bits:.2g} bits on the way."


def _chaotic(candidate: Candidate) -> bool:
    margin, parted = candidate.margin, candidate.alignment.divergence
    if margin is None or margin.growth is None or parted is None:
        return False
    return margin.growth * parted.expected_event >= CHAOS_BITS


# -- So what.


def so_what(comparison: Comparison, candidate: Candidate) -> str:
    """The outcomes that changed, after and before."""
    if candidate.verdict == "unsettled" or candidate.unable:
        return "Nothing is known of its outcomes."
    if candidate.verdict == "undecided":
        return f"What comes after event {candidate.alignment.agreed:,} is open; up to there it is right."
    if stopped(comparison, candidate):
        return "What comes after that is open, and so are the outcomes."
    if not candidate.changed:
        if candidate.until is not None:
            return f"No outcome is seen to change {until_phrase(candidate)}."
        return "Every outcome is the same." if candidate.verdict == "agree" else "No outcome changed."
    mine, theirs, parts, said = candidate.expected, candidate.outcomes, list[str](), set[str]()
    if "collisions" in candidate.changed:
        parts.append(f"{counted(theirs['collisions'], 'collision')} instead of {mine['collisions']:,}")
        said |= {"collisions", "collisions_per_ball"}
    if "final_velocities" in candidate.changed:
        expected, got = mine["final_velocities"], theirs["final_velocities"]
        name = max(expected, key=lambda circle: math.dist(expected[circle], got[circle]))
        shown = [[f"({vx:.{n}g}, {vy:.{n}g})" for vx, vy in (got[name], expected[name])] for n in range(3, 18)]
        pairs = next((pair for pair in shown if pair[0] != pair[1]), shown[0])
        verb = "ends with" if candidate.until is None else "then has"
        parts.append(f"{name} {verb} velocity {pairs[0]} instead of {pairs[1]}")
        said.add("final_velocities")
    for key in candidate.changed:
        before, after = mine.get(key), theirs.get(key)
        if key not in said and len(parts) < MOST_OUTCOMES and _plain(before) and _plain(after):
            parts.append(f"{key.replace('_', ' ')} {_value(after)} instead of {_value(before)}")
            said.add(key)
    rest = [key.replace("_", " ") for key in candidate.changed if key not in said]
    if rest:
        parts.append(f"{listed(rest)} changed{' too' if parts else ''}")
    until = until_phrase(candidate)
    return f"{_capital(f'{until}: ' if until else '')}{'; '.join(parts)}."


def _plain(value: object) -> bool:
    return value is None or isinstance(value, bool | int | float | str)


def _value(value: object) -> str:
    words = {None: "none", True: "yes", False: "no"}
    if value is None or isinstance(value, bool):
        return words[value]
    return f"{value:.6g}" if isinstance(value, float) else f"{value:,}" if isinstance(value, int) else str(value)


# -- What now.


def what_now(comparison: Comparison, candidate: Candidate, foreseen: Foreseen | None = None) -> str:
    """The cheapest that was run and is right, its cost, and until when the engine is predicted to be right."""
    told: list[str] = []
    if candidate.lawless:
        told.append(f"Correct {candidate.engine}: no setting mends a law.")
    elif stopped(comparison, candidate):
        told.append(_onward(comparison))
    elif candidate.verdict == "agree" and candidate.changed:
        told.append(_where_it_matters(comparison, candidate))
    elif candidate.verdict == "agree":
        told.append(f"{right_phrase(comparison, candidate)}{_cheaper(comparison, candidate)}.")
    elif candidate.verdict == "unsettled" and _at_its_end(candidate):
        told.append(f"No run of {candidate.engine} goes further; compare what comes before that.")
    elif candidate.verdict == "unsettled":
        told.append("Run it further.")
    else:
        told += _instead(comparison, candidate)
    if candidate.verdict != "agree":
        told += filter(None, [predicted(comparison, candidate, foreseen)])
    return " ".join(told)


def _onward(comparison: Comparison) -> str:
    """What lets the reference go on, where it ended not knowing: what its own message says, or more work."""
    reference = comparison.reference
    message, told = reference.stop.message, "Let it run longer."
    if reference.stop.reason is StopReason.UNDECIDED:
        own = "; " in message and not message.endswith("(--work)")
        told = f"{_capital(message.rpartition('; ')[2])}." if own else "Let it cost more (--work)."
    events = len(reference.events)
    return f"{told} Its first {counted(events, 'event')} can be compared alone." if events > 1 else told


def _where_it_matters(comparison: Comparison, candidate: Candidate) -> str:
    """What to take where every collision is right and an outcome is not."""
    names = listed(sorted(name.replace("_", " ") for name in candidate.changed))
    right = [c.engine for c in comparison.candidates if c.verdict == "agree" and not c.changed and not c.lawless]
    instead = (right or [comparison.reference.engine])[0]
    return f"Nothing to change if who hits whom is all that matters; for {names}, take {instead}."


def _at_its_end(candidate: Candidate) -> bool:
    """Whether a run ended where no limit lets it go on."""
    return candidate.trajectory.stop.reason in AT_AN_END


def _instead(comparison: Comparison, candidate: Candidate) -> list[str]:
    """What was run and is right to the end, the cheapest; and a setting of the engine itself that goes further."""
    found = [a for a in all_run(comparison, candidate) if a.right or a.agreed > candidate.alignment.agreed]
    right = [a for a in found if a.right][:1]
    own = [a for a in found if a.beside == candidate.engine and a not in right and candidate.stepped]
    told = [f"{_run_words(comparison, candidate, alternative)}." for alternative in right]
    told += [f"As a setting, {_run_words(comparison, candidate, alternative)}." for alternative in own]
    return told or ["Nothing that was run goes further."]


def _run_words(comparison: Comparison, candidate: Candidate, alternative: Alternative) -> str:
    cost = cost_words(alternative, candidate)
    to = right_to(comparison, alternative)
    return f"{alternative.engine} is {to}{f', at {cost}' if cost else ''}"


def all_run(comparison: Comparison, candidate: Candidate) -> list[Alternative]:
    """What was run and may stand in an engine's place: those right to the end first, the cheapest of them before.

    These are the alternatives, the other engines compared that keep the law, and the reference itself, where its
    decisions are proved.
    """
    found = [a for a in comparison.alternatives if a.beside == candidate.engine or a.steps is None]
    found += [
        Alternative(c.engine, "", c.alignment.agreed, c.right, c.alignment.divergence is None, c.processor)
        for c in comparison.candidates
        if c is not candidate and not c.unable and not c.lawless
    ]
    if comparison.certain:
        reference = comparison.reference
        found.append(Alternative(reference.engine, "", len(reference.events), True, True, comparison.processor))
    once = {alternative.engine: alternative for alternative in found}.values()
    return sorted(once, key=lambda a: (not a.right, (a.cost(candidate) or math.inf) if a.right else -a.agreed))


@dataclass(frozen=True)
class Substitute:
    """What was run, and may stand in an engine's place.

    Attributes:
        engine: the engine with its settings, as the command line takes it.
        events_agreed: events of the reference that it has before its first divergence, or its end.
        right: whether it agrees to the end of all that was compared, and is not known to break a law.
        run_no_further: whether `events_agreed` is where the run was ended, not where it diverged.
        cost: what it costs as a multiple of the engine in whose place it stands; None where that is not known.
        cost_in: of what that is a multiple: `time steps`, or `processor time`, measured once; None without a cost.
    """

    engine: str
    events_agreed: int
    right: bool
    run_no_further: bool
    cost: float | None
    cost_in: str | None


def substitutes(comparison: Comparison, candidate: Candidate) -> tuple[Substitute, ...]:
    """What was run and may stand in an engine's place, as `all_run` orders it; none where the engine agrees.

    >>> from truebreak.compare import compare
    >>> from truebreak.scenarios import catalogue
    >>> found = compare(catalogue.build("near-tie:k=20"), ["double"])
    >>> sorted((one.engine, one.events_agreed, one.right) for one in substitutes(found, found.candidates[0]))
    [('exact', 4, True), ('quad', 4, True)]
    """
    if candidate.verdict == "agree" and not candidate.lawless:
        return ()
    costs = [(one, one.cost(candidate)) for one in all_run(comparison, candidate)]
    return tuple(
        Substitute(
            one.engine,
            one.agreed,
            one.right,
            one.ended and not one.right,
            cost,
            None if cost is None else "processor time" if one.steps is None else "time steps",
        )
        for one, cost in costs
    )


def right_to(comparison: Comparison, alternative: Alternative) -> str:
    """To which event what was run is right."""
    if alternative.right:
        return f"right{all_of(len(comparison.reference.events))}"
    last = f"right to event {alternative.agreed - 1:,}" if alternative.agreed else "right in no event"
    return f"{last} (run no further)" if alternative.ended else last


def cost_words(alternative: Alternative, candidate: Candidate) -> str:
    """What it costs beside an engine; empty where that is not known.

    Processor time is given to one digit, as it was measured once.
    """
    cost = alternative.cost(candidate)
    if cost is None:
        return ""
    if alternative.steps is not None:
        return f"{cost:.3g} times the steps"
    if ALIKE[0] < cost < ALIKE[1]:
        return f"about the time of {candidate.engine}"
    return f"about {_one_digit(cost)} times the time of {candidate.engine}"


def _one_digit(ratio: float) -> str:
    """A ratio that was measured once, to one digit.

    >>> _one_digit(0.1234), _one_digit(2.87), _one_digit(96.0), _one_digit(1234.0)
    ('0.1', '3', '100', '1,000')
    """
    return f"{ratio:.1g}" if ratio < 9.5 else f"{float(f'{ratio:.1g}'):,.0f}"


def _cheaper(comparison: Comparison, candidate: Candidate) -> str:
    """How much less it costs than the reference."""
    mine, exact = candidate.processor, comparison.processor
    if not mine > 0 or not exact > 0 or not comparison.certain:
        return ""
    if ALIKE[0] < exact / mine < ALIKE[1]:
        return f", and {comparison.reference.engine} takes about its time"
    return f", and {comparison.reference.engine} takes about {_one_digit(exact / mine)} times its time"


def predicted(comparison: Comparison, candidate: Candidate, foreseen: Foreseen | None) -> str:
    """Until which event the exact run alone predicts the engine to be right; empty where nothing is predicted."""
    place = next(k for k, each in enumerate(comparison.candidates) if each is candidate)
    horizon: Horizon | None = None if foreseen is None or not foreseen.horizons else foreseen.horizons[place]
    if foreseen is None or horizon is None or candidate.lawless:
        return ""
    name = candidate.engine
    right, ends = ("able to decide", "stop") if encloses(candidate) else ("right", "diverge")
    if horizon.low.event is None:
        seen = f"in the first {counted(foreseen.events, 'event')}, and nothing is predicted beyond them"
        seen = seen if foreseen.reason else seen_words(foreseen.events)
        return f"By the growth of errors alone {name} is predicted to be {right} {seen}."
    if not horizon.low.event:
        return f"{name} is predicted to {'stop at' if encloses(candidate) else 'be wrong from'} the first event."
    half = "" if horizon.expected.event is None else f" (half of such runs {ends} by event {horizon.expected.event:,})"
    if horizon.expected.event == horizon.low.event:
        half = f" (half of such runs {ends} right there)"
    parted = candidate.alignment.divergence
    if parted is not None and parted.event < horizon.low.event:
        return f"{name} was predicted to be right until event {horizon.low.event:,}, and diverged before that."
    return f"{name} is predicted to be {right} until event {horizon.low.event:,}{half}."


def encloses(candidate: Candidate) -> bool:
    """Whether an engine's numbers are enclosures: it stops where they do not tell, and is never wrong."""
    return candidate.error is not None and candidate.error[0] is ErrorModel.ENCLOSED


def seen_words(events: int) -> str:
    """In which events something is predicted, where all were looked at.

    >>> seen_words(1), seen_words(1200)
    ('in the one event looked at', 'in the 1,200 events looked at')
    """
    return "in the one event looked at" if events == 1 else f"in the {events:,} events looked at"


# -- A command to copy, and a page to read.


def command(comparison: Comparison, candidate: Candidate) -> str:
    """A command that goes on from here."""
    scene, limits = scene_word(comparison.scene), limits_of(comparison.reference)
    known = candidate.engine.partition(":")[0] in ENGINES or re.fullmatch(r"[\w.]+:[\w.]+", candidate.engine)
    if candidate.lawless or not known:
        return shlex.join(["truebreak", "compare", scene, "--engines", "double", *limits])
    if stopped(comparison, candidate) or (candidate.verdict == "unsettled" and _at_its_end(candidate)):
        events = len(comparison.reference.events) - (candidate.verdict == "unsettled")
        if events < 1:
            return shlex.join(["truebreak", "run", scene])
        return shlex.join(["truebreak", "compare", scene, "--engines", candidate.engine, "--events", str(events)])
    if candidate.verdict == "agree":
        most = measurable(comparison)
        if not most:  # nothing says how far it will be right, but coarser numbers may be right as well
            coarser = ["run", scene] if candidate.engine == COARSER else ["compare", scene, "--engines", COARSER]
            return shlex.join(["truebreak", *coarser, *limits])
        some = [] if most == len(comparison.reference.events) else ["--events", str(most)]
        return shlex.join(["truebreak", "chaos", scene, "--engines", candidate.engine, *some])
    if candidate.verdict == "undecided":
        if candidate.diagnosis is not None and candidate.diagnosis.name is CauseName["WIDTH"]:
            return shlex.join(["truebreak", "compare", scene, "--engines", candidate.engine, "--bits", *limits])
        so_far = ["--events", str(candidate.alignment.agreed)]  # what it can follow
        follows = candidate.alignment.agreed and not candidate.unable
        followed = [candidate.engine, *so_far] if follows else ["double", *limits]
        return shlex.join(["truebreak", "compare", scene, "--engines", *followed])
    if candidate.stepped:
        return shlex.join(["truebreak", "advise", scene, "--engine", candidate.engine, *limits])
    if _chaotic(candidate):
        return shlex.join(["truebreak", "chaos", scene, "--engines", candidate.engine])
    return shlex.join(["truebreak", "minimise", scene, "--engine", candidate.engine, *limits])


COARSER = "single"
"""The engine of the fewest bits that takes every scene."""


def measurable(comparison: Comparison) -> int:
    """Over how many events of the reference the growth of errors can be measured: those that have a tangent map."""
    reference = comparison.reference
    if motion_of(reference) is None or not reference.events or reference.scene.moving_walls:
        return 0
    try:
        impacts(reference, len(reference.events))
    except NoTangentMap as error:
        return error.events
    return len(reference.events)


def read(comparison: Comparison, candidate: Candidate) -> str:
    """The page of the documentation to go on with."""
    if stopped(comparison, candidate):
        return "docs/engines.md"
    if candidate.lawless:
        return "docs/audit.md"
    if candidate.verdict == "agree":
        return "docs/chaos.md" if measurable(comparison) else "docs/engines.md"
    if candidate.verdict != "diverged" or candidate.diagnosis is None:
        return "docs/engines.md"
    if candidate.diagnosis.name is CauseName["TIE"]:
        return "docs/policies.md"
    if candidate.stepped:
        return "docs/floating-point-or-bug.md"
    return "docs/chaos.md" if _chaotic(candidate) else "docs/comparison.md"


def scene_word(scene: Scene) -> str:
    """The scene as a command takes it: its name in the catalogue, or a file.

    >>> from truebreak.scenarios import Circle, Scene, catalogue
    >>> scene_word(catalogue.build("near-tie:k=7")), scene_word(Scene([Circle(0, 0)], name="my own"))
    ('near-tie:k=7', 'my-own.toml')
    """
    from ...scenarios import catalogue

    if scene.name.partition(":")[0] in catalogue.names():
        try:
            if catalogue.build(scene.name).digest == scene.digest:
                return scene.name
        except SceneError:
            pass
    return f"{stem_of(scene)}.toml"


def stem_of(scene: Scene) -> str:
    """The scene's name as the name of a file.

    >>> from truebreak.scenarios import catalogue
    >>> stem_of(catalogue.build("rack:rows=2"))
    'rack-rows-2'
    """
    return re.sub(r"[^A-Za-z0-9]+", "-", scene.name).strip("-")[:60] or "scene"


def limits_of(reference: Trajectory) -> list[str]:
    """The options that end a run where this one ended."""
    if reference.stop.reason is StopReason.EVENTS:
        return ["--events", str(len(reference.events))]
    if reference.stop.reason is StopReason.HORIZON:
        return ["--until", reference.final_time.text() or repr(float(reference.final_time))]
    return []


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
