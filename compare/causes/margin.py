"""The margin of the decision at a divergence, beside the engine's error."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from flint import arb  # type: ignore[attr-defined]

from ...exact.numbers import ball
from ..alignment.divergence import Kind
from .numbers import ends

if TYPE_CHECKING:
    from ..study import Study
    from .laboratory import Laboratory

Bounds = tuple[float, float]
"""Doubles around a number that is known exactly."""


@dataclass(frozen=True)
class Margin:
    """How close the decision was in the exact motion, and how far off the engine was by then.

    Attributes:
        gap: the time between the two meetings, each taken as if nothing hindered it; None for hit or miss.
        distance: for hit or miss, the least distance of the surfaces in free flight, negative for the depth of a hit;
            for an order, how far apart the pair that comes second is when the first one meets.
        ulps: `gap` in units of a double's spacing at that time.
        error: the largest distance between the engine's place and the exact one of the circles in question, at the
            earlier of the two events.
        growth: bits an event by which a small error grows along the exact run up to there; None if not known.
        bits: the fewest bits with which intervals decide what comes next there, found by running them; None if not
            tried.
    """

    gap: Bounds | None
    distance: Bounds | None
    ulps: float | None
    error: float | None = None
    growth: float | None = None
    bits: int | None = None

    @property
    def ratio(self) -> float | None:
        """The error over the distance: above about 1, the error explains the divergence."""
        if self.error is None or self.distance is None:
            return None
        middle = abs(self.distance[0] + self.distance[1]) / 2
        return self.error / middle if middle else math.inf if self.error else None


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
            distance = ends(lab.margin)
        else:
            gap, distance = ends(_together(lab) or lab.margin), _second_gap(lab)
            ulps = max(abs(gap[0] + gap[1]) / 2, 0.0) / math.ulp(max(abs(divergence.time), math.ulp(0.0)))
    growth = error_growth(lab.reference, divergence.event)
    return Margin(gap, distance, ulps, _error(lab), growth, _bits(study, lab))


def _together(lab: Laboratory) -> arb | None:
    """Exactly zero, where the reference has both meetings at one instant."""
    assert lab.decision is not None and lab.decision.second is not None
    events, event = lab.reference.events, lab.divergence.event
    if event < len(events):
        pairs = {frozenset(pair) for pair in events[event].contacts}
        if {frozenset((p.body, p.partner)) for p in (lab.decision.first, lab.decision.second)} <= pairs:
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
    return None if found is None else ends(found)


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
    from .stops import bits_enough

    event = lab.divergence.event
    events = lab.reference.events
    if event >= len(events) or (lab.divergence.kind is Kind.TIE and len(events[event].contacts) > 1):
        return None
    if event > MOST_EVENTS or study.watch.over:
        return None
    least = engine("interval:bits=24")
    return bits_enough(study, least, event)[0]


MOST_EVENTS = 60
"""Events up to which the fewest bits are looked for: a dozen interval runs."""
