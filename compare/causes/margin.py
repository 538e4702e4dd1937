"""The margin of a decision, beside the engine's error: how close it was, and how far off the engine was by then."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ...exact.numbers import ball
from .diagnosis import Bounds, CauseName, Margin

if TYPE_CHECKING:
    from .diagnosis import Diagnosis
    from .laboratory import Laboratory


def margin_of(lab: Laboratory, found: Diagnosis) -> Margin:
    """The margin of a candidate's divergence: as much of it as the user's seconds leave time for.

    A contact below rounding has none: no two flights are close to another decision.
    """
    from ..tangent.growth import error_growth

    divergence = lab.divergence
    gap = distance = None
    ulps: float | None = None
    if found.name is CauseName["PHANTOM"]:
        pass
    elif lab.decision is not None and lab.margin is not None:
        if lab.decision.kind == "hit":
            distance = ball.double_bounds(lab.margin)
        else:
            gap = (0.0, 0.0) if lab.tied else ball.double_bounds(lab.margin)
            ulps = max(abs(gap[0] + gap[1]) / 2, 0.0) / math.ulp(max(abs(divergence.time), math.ulp(0.0)))
            distance = lab.tried(lambda: _second_gap(lab), None)
    elif lab.decision is None and lab.tied:
        gap = distance = (0.0, 0.0)
    error = lab.tried(lambda: _error(lab), None)
    growth = lab.tried(lambda: error_growth(lab.reference, divergence.expected_event), None)
    return Margin(gap, distance, ulps, error, growth, cut=lab.study.watch.over)


def _second_gap(lab: Laboratory) -> Bounds | None:
    """How far the pair that meets second is apart when the first one meets."""
    assert lab.decision is not None and lab.decision.second is not None
    if lab.tied:
        return 0.0, 0.0
    one, other = lab.decision.first, lab.decision.second
    with ball.precision(4096):
        times = lab.truth.hit_time(one), lab.truth.hit_time(other)
        if times[0] is None or times[1] is None:
            return None
        later, time = (other, times[0]) if ball.sign_of(times[1] - times[0]) != -1 else (one, times[1])
        found = lab.truth.gap_at(later, time)
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
