"""Measures the margin of the decision at a divergence, and how far off the engine is by then."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from flint import arb

from ...exact.numbers import ball
from ..alignment.divergence import Kind
from .margin import Bounds, Margin
from .widths import bits_past

if TYPE_CHECKING:
    from ..study import Study
    from .laboratory import Laboratory

MOST_EVENTS = 60
"""Events up to which the fewest bits are looked for: a dozen interval runs."""


def margin_of(study: Study, lab: Laboratory) -> Margin:
    """The margin of a candidate's divergence.

    Raises:
        OutOfTime: if the user's seconds are over.
    """
    from ...exact.results.growth import error_growth

    divergence = lab.divergence
    gap = distance = None
    ulps: float | None = None
    if lab.decision is not None and lab.margin is not None:
        if lab.decision.kind == "hit":
            distance = ball.double_bounds(lab.margin)
        else:
            gap, distance = ball.double_bounds(_together(lab) or lab.margin), _second_gap(lab)
            ulps = max(abs(gap[0] + gap[1]) / 2, 0.0) / math.ulp(max(abs(divergence.time), math.ulp(0.0)))
    growth = error_growth(lab.reference, divergence.event)
    return Margin(gap, distance, ulps, _error(lab), growth, _bits(study, lab))


def _together(lab: Laboratory) -> arb | None:
    """Exactly zero, where the reference has both meetings at one instant."""
    assert lab.decision is not None and lab.decision.second is not None
    events, event = lab.reference.events, lab.divergence.event
    if event < len(events):
        pairs = {frozenset(pair) for pair in events[event].contacts}
        asked = {frozenset((p.body, p.partner)) for p in (lab.decision.first, lab.decision.second)}
        if len(asked) == 2 and asked <= pairs:
            return arb(0)
    return None


def _second_gap(lab: Laboratory) -> Bounds | None:
    """How far the pair that meets second is apart when the first one meets."""
    assert lab.decision is not None and lab.decision.second is not None
    if _together(lab) is not None:
        return 0.0, 0.0
    one, other = lab.decision.first, lab.decision.second
    with ball.precision(4096):
        times = lab.truth.hit_time(one, 1024), lab.truth.hit_time(other, 1024)
        if times[0] is None or times[1] is None:
            return None
        later, time = (other, times[0]) if ball.sign_of(times[1] - times[0]) != -1 else (one, times[1])
        found = lab.truth.gap_at(later, time, 1024)
    return None if found is None else ball.double_bounds(found)


def _error(lab: Laboratory) -> float | None:
    """The engine's position error at the earlier of the two events, over the circles in question."""
    run, reference, time = lab.candidate.trajectory, lab.reference, lab.divergence.time
    last = min(float(run.final_time), float(reference.final_time), time)
    if not last > 0:
        return 0.0 if lab.divergence.time == 0 else None
    at = math.nextafter(last, 0.0)
    names = {lab.divergence.body, lab.divergence.expected, lab.divergence.got}
    rows = [k for k, c in enumerate(lab.study.scene.circles) if c.id in names and not c.fixed]
    mine, theirs = reference.sample([at])[0], run.sample([at])[0]
    return max((math.dist(mine[k][:2], theirs[k][:2]) for k in rows), default=None)


def _bits(study: Study, lab: Laboratory) -> int | None:
    """The bits with which intervals decide what comes next at the divergence."""
    from ..engines import engine

    event, events = lab.divergence.event, lab.reference.events
    tied = event < len(events) and len(events[event].contacts) > 1
    if (lab.divergence.kind is Kind.TIE and tied) or event > MOST_EVENTS or study.watch.over:
        return None
    return bits_past(study, engine(NARROWEST), event, lab.divergence.time).bits


NARROWEST = "interval:bits=24"
"""The intervals that the search for the fewest bits begins with: there are none of fewer."""
