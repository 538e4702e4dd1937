"""A comparison in sentences."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..alignment.divergence import Kind
from ..engines import is_stepped

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ..candidate import Candidate
    from ..comparison import Comparison


def verdict_sentence(comparison: Comparison) -> str:
    """The one sentence that a report leads with.

    A time step or a difference of model is not called floating-point error.
    """
    by_verdict = {
        verdict: [c for c in comparison.candidates if c.verdict == verdict]
        for verdict in ("agree", "diverged", "undecided")
    }
    reference, events = comparison.reference, counted(len(comparison.reference.events), "event")
    rounding = [c for c in by_verdict["diverged"] if _is_rounding(c)]
    if by_verdict["diverged"]:
        first = min(rounding or by_verdict["diverged"], key=_place)
        agreeing = [c.engine for c in by_verdict["agree"]]
        spared = f"{listed(agreeing)} {'agrees' if len(agreeing) == 1 else 'agree'}, but " if agreeing else ""
        return f"{_head(first)}: {spared}{divergence_phrase(comparison, first)}"
    stopped = f"the {reference.engine} run itself stopped after {events}: {reference.stop.message}"
    if comparison.verdict == "undecided" and not by_verdict["undecided"]:
        return f"Undecided: {stopped}."
    undecided = listed([c.engine for c in by_verdict["undecided"]])
    if by_verdict["agree"]:
        agreeing = [c.engine for c in by_verdict["agree"]]
        verb = "agrees" if len(agreeing) == 1 else "agree"
        rest = f"; {undecided} could not follow to the end" if by_verdict["undecided"] else ""
        return (
            f"Floating point did not change what happened: {listed(agreeing)} {verb} with the "
            f"{reference.engine} run in {all_of(len(reference.events))}{rest}."
        )
    return f"Undecided: {undecided} could not follow the {reference.engine} run to the end."


def _is_rounding(candidate: Candidate) -> bool:
    """Whether rounding is to blame, as far as is known: not a time step, not a difference of model."""
    from ..causes.causes import CauseName

    cause = candidate.cause
    if cause is None:
        return not is_stepped(candidate.trajectory.engine)
    if cause.name is CauseName.TIE:
        return not is_stepped(candidate.trajectory.engine)
    return cause.name in (CauseName.INPUT, CauseName.ARITHMETIC) or (
        cause.name is CauseName.UNKNOWN and not is_stepped(candidate.trajectory.engine)
    )


def _head(candidate: Candidate) -> str:
    from ..causes.causes import CauseName

    if _is_rounding(candidate):
        return "Floating point changed what happened"
    name = candidate.cause.name if candidate.cause else None
    if name is CauseName.STEP:
        return "The time step changed what happened"
    if name is CauseName.TIE:
        return "A tie was resolved differently"
    return "The histories differ"


def _place(candidate: Candidate) -> tuple[float, int]:
    divergence = candidate.alignment.divergence
    assert divergence is not None
    return divergence.time, divergence.event


def divergence_phrase(comparison: Comparison, candidate: Candidate) -> str:
    """Who first does what else, and when."""
    divergence = candidate.alignment.divergence
    assert divergence is not None
    scene = comparison.scene
    where = f"{candidate.engine} first differs at event {divergence.event} (t = {divergence.time:.9g})"
    body = named(scene, divergence.body)
    match divergence.kind:
        case Kind.DIFFERENT:
            what = f"{body} meets {named(scene, divergence.got)} instead of {named(scene, divergence.expected)}"
        case Kind.MISSING:
            what = f"{body} does not meet {named(scene, divergence.expected)}"
        case Kind.EXTRA:
            what = f"{body} meets {named(scene, divergence.got)}, which it should not"
        case Kind.TIE:
            what = f"{body} meets {tied(divergence.got)} where it should meet {tied(divergence.expected)}"
    return f"{where}: {what}."


def named(scene: Scene, name: str | None) -> str:
    """A thing by kind and id.

    >>> from truebreak.scenarios import Circle, Scene
    >>> named(Scene([Circle(0, 0, id="b3")]), "b3")
    'circle b3'
    """
    if name is None:
        return "nothing"
    if any(wall.id == name for wall in scene.walls):
        return f"wall {name}"
    return f"circle {name}"


def tied(partners: str | None) -> str:
    """The partners of a tie in words.

    >>> tied("a + b"), tied("a then b")
    ('a and b at once', 'a, then b')
    """
    groups = [group.split(" + ") for group in (partners or "nothing").split(" then ")]
    return ", then ".join(f"{listed(names)} at once" if len(names) > 1 else names[0] for names in groups)


def all_of(number: int) -> str:
    """All events in words.

    >>> all_of(0), all_of(1), all_of(60)
    ('it, which has no event', 'its one event', 'all 60 events')
    """
    few = {0: "it, which has no event", 1: "its one event"}
    return few.get(number, f"all {counted(number, 'event')}")


def counted(number: int, noun: str) -> str:
    """A number with its noun.

    >>> counted(1, "event"), counted(1200, "event")
    ('1 event', '1,200 events')
    """
    return f"{number:,} {noun}{'' if number == 1 else 's'}"


def listed(words: list[str]) -> str:
    """Words as a list in a sentence.

    >>> listed(["a"]), listed(["a", "b", "c"])
    ('a', 'a, b and c')
    """
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}" if words else "no engine"


def short(value: float | None) -> str:
    """A small number for a table; a dash for none.

    >>> short(1.23456e-9), short(None), short(0.0)
    ('1.23e-09', '-', '0')
    """
    return "-" if value is None else f"{value:.3g}"


def pattern_phrase(comparison: Comparison, candidate: Candidate) -> str | None:
    """What the engine's break pattern is among those that the physics permits, if those are several."""
    from ..outcomes.permitted import Relation

    permitted, pattern = comparison.permitted, candidate.outcomes.get("break_pattern")
    if permitted is None or pattern is None or candidate.verdict == "undecided":
        return None
    if permitted.orders == (permitted.exact,):  # no order matters, so that there is nothing to choose from
        return None
    policy, found = permitted.policy(pattern), counted(len(permitted.orders), "pattern")
    match permitted.relation(pattern):
        case Relation.EXACT:
            return "the exact one"
        case Relation.PERMITTED if policy is not None:
            return f"not the exact one, but permitted: the exact engine has it under {policy}"
        case Relation.PERMITTED:
            return f"not the exact one, but permitted: one of {found} over all orders of simultaneous impulses"
        case Relation.IMPOSSIBLE:
            return f"impossible: not among {found} over all orders of simultaneous impulses"
        case Relation.UNSEEN:
            return f"not the exact one, and not among {found} over the orders followed; there are more"


def margin_phrase(candidate: Candidate) -> str | None:
    """How close it was, in words."""
    margin = candidate.margin
    if margin is None:
        return None
    if margin.gap is not None and margin.gap == 0:
        return "the two fall on exactly the same instant"
    if margin.gap is not None:
        ulps = f" ({margin.ulps:.3g} spacings of a double)" if margin.ulps is not None else ""
        return f"in the exact motion the two are {margin.gap:.3g} apart in time{ulps}"
    if margin.miss is not None:
        kind = "a hit by a depth of" if margin.miss < 0 else "a miss by"
        return f"in the exact motion it is {kind} {abs(margin.miss):.3g}"
    return None
