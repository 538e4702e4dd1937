"""A comparison in sentences."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..align import Kind

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ..comparison import Candidate, Comparison


def verdict_sentence(comparison: Comparison) -> str:
    """The one sentence that a report leads with."""
    diverged = [c for c in comparison.candidates if c.alignment.divergence is not None]
    undecided = [c for c in comparison.candidates if c.verdict == "undecided"]
    events = len(comparison.reference.events)
    if diverged:
        first = min(diverged, key=_place)
        head = "Floating point changed what happened" if _is_float_error(first) else "The histories differ"
        return f"{head}: {divergence_phrase(comparison, first)}"
    if comparison.verdict == "undecided" and not undecided:
        return f"Undecided: the {comparison.reference.engine} run itself stopped after {counted(events, 'event')}."
    agreeing = [c.engine for c in comparison.candidates if c.verdict == "agree"]
    if agreeing:
        head = f"Floating point did not change what happened: {listed(agreeing)} " + (
            "agrees" if len(agreeing) == 1 else "agree"
        )
        tail = f" with the {comparison.reference.engine} run in all {counted(events, 'event')}"
        rest = f"; {listed([c.engine for c in undecided])} could not follow to the end" if undecided else ""
        return f"{head}{tail}{rest}."
    return f"Undecided: {listed([c.engine for c in undecided])} could not follow the {comparison.reference.engine} run."


def _is_float_error(candidate: Candidate) -> bool:
    from ..causes import CauseName

    return candidate.cause is None or candidate.cause.name is not CauseName.MODEL


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
            what = f"{body} meets {divergence.got} where it should meet {divergence.expected}"
            what += " at once" if divergence.expected and " + " in divergence.expected else ""
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
