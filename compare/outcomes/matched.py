"""The part of a candidate's history that outcomes are taken over: what is matched in the span, and what is extra."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..alignment.instants import instants

if TYPE_CHECKING:
    from ...scenarios.event import Event
    from ...scenarios.trajectory import Trajectory
    from ..alignment.align import Alignment, Span


def matched_history(candidate: Trajectory, reference: Trajectory, alignment: Alignment, span: Span) -> Trajectory:
    """The candidate's history over the span.

    A meeting that is matched across the end counts in both runs or in neither, by where the reference has it. An
    instant that is matched wholly has the reference's impulses: an engine that takes its rounds in one step, or in
    several, reports another number of them for the same thing.
    """
    inside: dict[int, Event] = {}
    matched = {c: m for walked in reversed(alignment.walks.values()) for m, c in reversed(walked.pairs)}
    for index, event in enumerate(candidate.events):
        if index in matched:
            if matched[index] < span.events:
                inside[index] = event
        elif span.holds(event.time):
            inside[index] = event
    for group in instants(alignment.walks):
        if not alignment.whole.issuperset(group.mine):
            continue
        told = [reference.events[m] for m in group.mine]
        impulses = tuple(pair for event in told for pair in event.impulses)
        if Counter(impulses) != Counter(p for c in group.theirs for p in candidate.events[c].impulses):
            contacts = tuple(dict.fromkeys(pair for event in told for pair in event.contacts))
            for c in group.theirs:
                inside.pop(c, None)
            first = candidate.events[group.theirs[0]]
            inside[group.theirs[0]] = replace(first, contacts=contacts, impulses=impulses)
    events = tuple(replace(inside[c], index=place) for place, c in enumerate(sorted(inside)))
    end = min(float(candidate.final_time), max(_end(reference, span), *(float(e.time) for e in events), 0.0))
    if reference.scene.capture or reference.reversal is not None:
        return replace(candidate, events=events, final_time=end)
    return replace(candidate, events=events, final_time=end, motion=Left(candidate, events))


def decided_part(reference: Trajectory, alignment: Alignment, end: float) -> Trajectory:
    """What of the reference a run that stopped early has told too: the meetings that are matched, up to its end."""
    known = sorted({m for walked in alignment.walks.values() for m, _ in walked.pairs})
    events = tuple(replace(reference.events[m], index=place) for place, m in enumerate(known))
    entries = tuple(entry for entry in reference.pocketings if float(entry.time) <= end)
    cut = replace(reference, events=events, final_time=end, pocketings=entries)
    if reference.scene.capture or reference.reversal is not None:
        return cut
    return replace(cut, motion=Left(reference, events))


def _end(reference: Trajectory, span: Span) -> float:
    return span.time if math.isfinite(span.time) else float(reference.final_time)


@dataclass(frozen=True)
class Left:
    """Every circle as its last meeting inside the span left it, flying straight on.

    Attributes:
        candidate: the whole run.
        events: those inside the span.
    """

    candidate: Trajectory
    events: Sequence[Event]

    def state(self, time: Any) -> list[tuple[Any, Any, Any, Any]]:
        """(x, y, vx, vy) of every circle."""
        last: dict[str, Any] = {}
        for event in self.events:
            if float(event.time) <= float(time):
                last.update((name, event.time) for pair in event.impulses for name in pair)
        states = {id(t): self.candidate.at(t) for t in last.values()}
        start = self.candidate.at(0)
        rows = []
        for circle in start.circles:
            since = last.get(circle.id, 0)
            told = states[id(since)][circle.id] if circle.id in last else circle
            lag = float(time) - float(since)
            vx, vy = float(told.vx), float(told.vy)
            rows.append((float(told.x) + vx * lag, float(told.y) + vy * lag, vx, vy))
        return rows

    def sample(self, times: Sequence[float]) -> Any:
        """Shape (times, circles, 4)."""
        return np.array([self.state(time) for time in times])
