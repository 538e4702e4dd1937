"""What a failed check says: the divergence first, then why, then how to see it again."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..report.sentences import divergence_phrase, listed, margin_phrase, middle, short

if TYPE_CHECKING:
    from ..comparison import Comparison
    from .reach import Reach

DIGITS = 15
"""Certified digits of a time that a message shows."""


def failure(comparison: Comparison, reproduce: str, reach: Reach | None, off: str | None = None) -> str:
    """The message of a check that failed.

    Args:
        reproduce: the command that shows the same.
        reach: how far the history was required; None where the span was given.
        off: which number is off, where the history is the same.
    """
    (candidate,) = comparison.candidates
    lines = [off if off is not None else divergence_phrase(comparison, candidate)]
    divergence = candidate.alignment.divergence
    if divergence is not None and off is None:
        events = comparison.reference.events
        if divergence.expected is not None and divergence.expected_time is not None:
            told = events[divergence.event].time.digits(DIGITS) if divergence.event < len(events) else "later"
            lines.append(f"  expected: {divergence.body} meets {divergence.expected} at t = {told}")
        if divergence.got is not None:
            lines.append(f"  got:      {divergence.body} meets {divergence.got} at t = {divergence.got_time!r}")
    if candidate.margin is not None:
        exact = candidate.margin.gap or candidate.margin.distance
        beside = "" if exact is None else f"margin {short(abs(middle(exact)))} beside an error of "
        lines.append(f"  decision: {beside}{short(candidate.margin.error)}; {margin_phrase(candidate)}")
    if candidate.diagnosis is not None:
        lines.append(f"  cause:    {candidate.diagnosis}: {candidate.diagnosis.evidence}")
        also = [cause.value for cause in candidate.diagnosis.sufficient if cause is not candidate.diagnosis.name]
        lines += [f"            suffices by itself too: {listed(also)}"] if also else []
    total = len(comparison.reference.events)
    required = (
        f"{total} events" if reach is None or reach.limit is None else f"{reach.events} events, up to {reach.limit}"
    )
    lines.append(f"  required: {required}; {candidate.alignment.agreed} agree")
    lines.append(f"  reproduce: {reproduce}")
    return "\n".join(lines)
