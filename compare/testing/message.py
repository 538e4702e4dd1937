"""What a failed check says: the divergence first, then why, then how to see it again."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite, log10
from typing import TYPE_CHECKING

from ..report.sentences import divergence_phrase, listed, margin_phrase, middle, short, until_phrase
from ..report.sentences import off as off_by

if TYPE_CHECKING:
    from ..comparison import Comparison
    from .tolerances.reach import Reach

DIGITS = 15
"""Certified digits of a time that a message shows."""


def failure(
    comparison: Comparison,
    reproduce: str,
    reach: Reach | None,
    off: str | None = None,
    bits: int | None = None,
    violations: Sequence[str] = (),
) -> str:
    """The message of a check that failed.

    Args:
        reproduce: the command that shows the same.
        reach: how far the history was required; None where the span was given.
        off: which number is off, where the history is the same.
        bits: of the engine's numbers; None where they are not known.
        violations: what else is wrong, such as a number before the divergence, or a law.
    """
    (candidate,) = comparison.candidates
    lines = [off if off is not None else divergence_phrase(comparison, candidate)]
    divergence = candidate.alignment.divergence
    if divergence is not None and off is None:
        events = comparison.reference.events
        if divergence.expected is not None and divergence.expected_time is not None:
            own = divergence.expected_event
            told = events[own].time.digits(DIGITS) if own < len(events) else "later"
            lines.append(f"  expected: {divergence.body} meets {divergence.expected} at t = {told}")
        if divergence.got is not None:
            lines.append(f"  got:      {divergence.body} meets {divergence.got} at t = {divergence.got_time!r}")
    lines += [f"  violation: {told}" for told in violations]
    if candidate.margin is not None:
        exact = candidate.margin.gap or candidate.margin.distance
        margin = [] if exact is None else [f"margin {short(abs(middle(exact)))}"]
        by = candidate.margin.error
        beside = [] if by is None else [f"{'beside ' if margin else ''}an error of {off_by(by)}"]
        told = filter(None, (" ".join([*margin, *beside]), margin_phrase(candidate)))
        lines.append(f"  decision: {'; '.join(told)}")
    error = None if candidate.margin is None else candidate.margin.error
    if error is not None and bits is not None:
        expected = int(bits * log10(2))
        left = digits_left(error, _size(comparison), expected)
        lines.append(f"  digits:   {expected} expected of {bits} bits, {left} left of places by then")
    if candidate.diagnosis is not None:
        lines.append(f"  cause:    {candidate.diagnosis}: {candidate.diagnosis.finding}")
        also = [cause.value for cause in candidate.diagnosis.sufficient if cause is not candidate.diagnosis.name]
        lines += [f"            suffices by itself too: {listed(also)}"] if also else []
    total = len(comparison.reference.events)
    required = (
        f"{total} events" if reach is None or reach.limit is None else f"{reach.events} events, up to {reach.limit}"
    )
    lines.append(f"  required: {required}; {candidate.alignment.agreed} agree")
    until = until_phrase(candidate)
    lines += [] if until is None else [f"  known:    {until}; what lies beyond is not settled"]
    lines.append(f"  reproduce: {reproduce}")
    return "\n".join(lines)


def digits_left(error: float, size: float, expected: int) -> int:
    """How many of the expected digits an error leaves of numbers of a size.

    >>> digits_left(1e-12, 10.0, 15), digits_left(0.0, 10.0, 15), digits_left(30.0, 10.0, 15)
    (13, 15, 0)
    """
    if error == 0.0:
        return expected
    return int(min(expected, max(0.0, log10(size / error)))) if isfinite(error) and size > 0.0 else 0


def _size(comparison: Comparison) -> float:
    """The largest coordinate at the divergence."""
    (candidate,) = comparison.candidates
    divergence, reference = candidate.alignment.divergence, comparison.reference
    known = divergence is not None and divergence.expected_event < len(reference.events)
    event = reference.events[divergence.expected_event] if divergence is not None and known else None
    state = reference.final if event is None else reference.at(event.time)
    return max(abs(float(place)) for circle in state.circles for place in (circle.x, circle.y))
