"""Which part of a run outcomes are taken over, and what of the reference they are compared with."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeAlias

from ...scenarios.lazy import Later
from ...scenarios.trajectory import AT_AN_END, StopReason
from ..alignment.align import Span
from ..alignment.instants import instants
from ..alignment.walk import bounces_of_one
from ..foreign.impulses import Impacts
from .outcome import Entries, changed_outcomes, wait_to_enter

if TYPE_CHECKING:
    import numpy as np

    from ...scenarios.trajectory import Contact, Event, Motion, Pocketing, Trajectory
    from ..alignment.align import Alignment
    from ..alignment.walk import Patience
else:
    np = Later("numpy")

Impulses: TypeAlias = "tuple[Contact, ...]"

Row: TypeAlias = "tuple[Any, Any, Any, Any]"


def matched_history(
    candidate: Trajectory,
    reference: Trajectory,
    alignment: Alignment,
    span: Span,
    entries: Entries,
    only: Collection[int] | None = None,
) -> Trajectory:
    """The candidate's history over the span.

    A meeting that all of its bodies have matched across the end counts in both runs or in neither, by where the
    reference has it; one that only some of them come to in the same order counts by its own time. An instant that is
    matched wholly, as far as the span has it, has the reference's impulses, in one event: an engine that takes its
    rounds in one step, or in several, reports another number of them for the same thing.

    Args:
        only: the reference's events that alone count, as far as they are matched.
    """
    inside: dict[int, Event] = {}
    has = {name: {c for _, c in walked.pairs} for name, walked in alignment.walks.items()}

    def shared(event: Event, index: int) -> bool:
        return all(index in has[name] for pair in event.impulses for name in pair if name in has)

    matched = {c: m for walked in reversed(alignment.walks.values()) for m, c in reversed(walked.pairs)}
    for index, event in enumerate(candidate.events):
        if index in matched and (only is not None or shared(event, index)):
            if matched[index] < span.events and (only is None or matched[index] in only):
                inside[index] = event
        elif only is None and span.holds(event.time):
            inside[index] = event
    outside = [event for index, event in enumerate(candidate.events) if index not in inside]
    for group in instants(alignment.walks):
        within = [m for m in group.mine if m < span.events]
        if not within or not alignment.whole.issuperset(within):
            continue
        told = [reference.events[m] for m in within]
        theirs = sorted({c for m, c in group.pairs if m < span.events})
        impulses = tuple(pair for event in told for pair in event.impulses)
        others = Counter(p for c in theirs for p in candidate.events[c].impulses)
        if Counter(impulses) != others or len(within) == 1 < len(theirs):
            contacts = tuple(dict.fromkeys(pair for event in told for pair in event.contacts))
            for c in theirs:
                inside.pop(c, None)
            last = max(theirs)
            inside[last] = replace(candidate.events[last], contacts=contacts, impulses=impulses)
    inside = dict(sorted(inside.items()))
    events = tuple(e if e.index == place else replace(e, index=place) for place, e in enumerate(inside.values()))
    end = min(float(candidate.final_time), max(_end(reference, span), *(float(e.time) for e in events), 0.0))
    cut = replace(candidate, events=events, final_time=end, pocketings=entries.inside(span))
    if not (reference.scene.capture or reference.reversal is not None):
        cut = replace(cut, motion=Left(candidate, inside))
    untold = _untold(cut, reference, span, outside)
    return replace(cut, motion=Known(cut, untold, reference, _left_by(reference, span))) if untold else cut


def _untold(cut: Trajectory, reference: Trajectory, span: Span, outside: Sequence[Event]) -> set[str]:
    """The circles whose velocity at the end of the span a run does not tell apart from a later one: what lies beyond
    the end in the reference comes at the same double as what lies within."""
    end, ids = float(cut.final_time), {str(circle.id) for circle in cut.scene.circles}
    if cut.reversal is not None and float(cut.reversal.time) <= end and not _turned(reference, span):
        return ids
    last = dict.fromkeys(ids, 0.0)
    last.update((name, float(event.time)) for event in cut.events for pair in event.impulses for name in pair)
    latest = last if isinstance(cut.motion, Left) else dict.fromkeys(ids, end)
    names = ((name, float(event.time)) for event in outside for pair in event.impulses for name in pair)
    return {name for name, time in names if name in ids and time <= latest[name]}


def _turned(reference: Trajectory, span: Span) -> bool:
    """Whether velocities are reversed within the span, before its end."""
    turn = reference.reversal
    return turn is not None and (turn.after < span.events or float(turn.time) < span.time)


def _left_by(reference: Trajectory, span: Span) -> Left | Motion:
    """The reference's motion to the end of the span, where that and what follows come at the same double."""
    if reference.scene.capture or _turned(reference, span):
        return reference.motion
    return Left(reference, dict(enumerate(reference.events[: span.events])))


@dataclass(frozen=True)
class MatchedOutcomes:
    """A run's outcomes beside the reference's, over as much of the span as the run tells.

    Attributes:
        history: the part of the run that they are taken over.
        values: its outcomes.
        expected: the reference's, over the same time.
        changed: names of those that differ, and would if what the run may still come to were left out.
        until: where the run ends before the span does: nothing is claimed beyond that. None: it tells all of the span.
    """

    history: Trajectory
    values: Mapping[str, Any]
    expected: Mapping[str, Any]
    changed: tuple[str, ...]
    until: float | None


def held(
    run: Trajectory,
    reference: Trajectory,
    alignment: Alignment,
    span: Span,
    patience: Patience,
    tell: Callable[[Trajectory], Mapping[str, Any]],
    whole: Mapping[str, Any],
    agrees: Callable[[], bool] | None = None,
) -> MatchedOutcomes:
    """The one place that decides over which time outcomes are compared, and with what.

    A run that tells all of the span is compared with `whole`. One that ends before is compared with the reference up to
    there: what lies beyond is not settled, whatever the two have parted over before. A meeting of the reference that
    it may only be late for, by the rule of the comparison itself, changes nothing by being absent.

    Args:
        reference: as far as it is known; it may go on past the span.
        patience: how late the run may be for a meeting.
        tell: gives the outcomes.
        whole: the reference's outcomes over the span.
        agrees: whether numbers that are not whole may differ by error alone; None: if there is no divergence.
    """
    until, settled = told_until(run, reference, span), alignment.verdict in ("agree", "diverged")
    if alignment.verdict == "agree" and reference.stop.reason is run.stop.reason in AT_AN_END:
        until = None  # the motion itself ends there, in both, a rounding earlier or later
    loose = not settled or (alignment.divergence is None if agrees is None else agrees())
    if until is not None:
        until = _before_a_part(run, reference, alignment, until)
        span = Span(sum(float(event.time) <= until for event in reference.events[: span.events]), until)
    entries = Entries(run, reference, alignment, patience)
    history = matched_history(run, reference, alignment, span, entries, None if settled else alignment.whole)
    values, end = tell(history), float(history.final_time)
    if settled:
        told = _end(reference, span) if until is None else until
        end = max(told, *(float(event.time) for event in reference.events[: span.events]), 0.0)
    known = {m: reference.events[m].impulses for m in range(span.events)}
    certain = known if until is None else _certain(reference, alignment, known, patience, end)
    entered, sure = entries.expected(span), entries.certain(span)
    if not settled:
        known = certain = {m: pairs for m, pairs in known.items() if m in alignment.whole}
        entered = sure = entries.shared(span)
    expected = whole if until is None and settled else tell(_part(reference, known, entered.values(), end))
    changed = changed_outcomes(expected, values, agrees=loose)
    if changed and (certain, sure) != (known, entered):
        kept = changed_outcomes(tell(_part(reference, certain, sure.values(), end)), values, agrees=loose)
        changed = [name for name in changed if name in kept]
    if changed and reference.scene.settle and alignment.divergence is None:
        part = _part(reference, known, entered.values(), end)
        both = zip((part, history), bounces_of_one(reference, run, patience), strict=True)
        kept = changed_outcomes(*(tell(_leaving_out(one, bounces)) for one, bounces in both), agrees=loose)
        changed = [name for name in changed if name in kept]
    if getattr(run.motion, "reckoned", ()):  # a record without states: its velocities are computed here, from times
        changed = [name for name in changed if name != "final_velocities"]
    return MatchedOutcomes(history, values, expected, tuple(changed), until)


def _leaving_out(run: Trajectory, bounces: Collection[tuple[float, str]]) -> Trajectory:
    """A run without bounces on walls, by their times and circles: of infinitely many it may list any number."""

    def left(event: Event) -> tuple[Contact, ...]:
        return tuple(p for p in event.impulses if not any((float(event.time), name) in bounces for name in p))

    events = [replace(event, impulses=pairs) for event in run.events if (pairs := left(event))]
    return replace(run, events=tuple(replace(event, index=k) for k, event in enumerate(events)))


def told_until(run: Trajectory, reference: Trajectory, span: Span) -> float | None:
    """Where a run ends before the span does; None where it tells all of it.

    A span without end is told by a run that says that nothing more happens, and by one that goes past the reference's
    last event and has, in doubles, nothing left that comes nearer to anything.
    """
    end = float(run.final_time)
    if run.stop.reason is StopReason.QUIET:
        return None
    if math.isfinite(span.time):
        return end if end < span.time else None
    over = run.stop.reason is StopReason.HORIZON and end >= float(reference.final_time)
    return None if over and _parted(run) else end


def _parted(run: Trajectory) -> bool:
    """Whether no two circles, and no circle and wall, come nearer to each other at a run's end, nor a centre to a
    pocket that it enters."""
    turns = run.scene.reverse_at is not None or run.scene.reverse_after is not None
    if turns and run.reversal is None:
        return False
    rows = [(float(c.x), float(c.y), float(c.vx), float(c.vy)) for c in run.final.circles]
    enters = (wait_to_enter(run.scene, pocket, row) for pocket in run.scene.pockets for row in rows)
    return Impacts(run.scene).quiet(rows, float(run.final_time)) and not any(enters)


def _before_a_part(run: Trajectory, reference: Trajectory, alignment: Alignment, end: float) -> float:
    """The end of a run, or just before its last instant where it has a part of the reference's contacts there.

    A record that ends with one of several contacts of a tie does not say that the others do not follow.
    """
    last, before = {e.index for e in run.events if float(e.time) >= end}, end
    for walked in alignment.walks.values():
        lost = walked.mismatch
        if lost is None or lost.mine is None or lost.theirs is not None:
            continue
        if any(m == lost.mine and c in last for m, c in walked.pairs):
            before = min(before, math.nextafter(min(end, float(reference.events[lost.mine].time)), -math.inf))
    return before


def _certain(
    reference: Trajectory, alignment: Alignment, known: Mapping[int, Impulses], patience: Patience, end: float
) -> dict[int, Impulses]:
    """The impulses without those that a run which ends at `end` may only be late for: its circles still await them."""
    awaited: dict[str, int] = {}
    for body, walked in alignment.walks.items():
        lost = walked.mismatch
        if lost is None or lost.final or lost.mine is None or lost.theirs is not None:
            continue
        if patience.latest(float(reference.events[lost.mine].time)) > end:
            awaited[body] = lost.mine
    never = len(reference.events)

    def waits(event: int, pair: Contact) -> bool:
        return all(event >= awaited.get(name, never) for name in pair if name in alignment.walks)

    return {m: left for m, pairs in known.items() if (left := tuple(pair for pair in pairs if not waits(m, pair)))}


def _part(reference: Trajectory, known: Mapping[int, Impulses], entries: Iterable[Pocketing], end: float) -> Trajectory:
    """The reference with certain impulses of certain events and certain entries alone, up to a time."""
    events = tuple(replace(reference.events[m], index=k, impulses=known[m]) for k, m in enumerate(sorted(known)))
    turned = reference.reversal if reference.reversal and float(reference.reversal.time) <= end else None
    final = reference.final_time if float(reference.final_time) <= end else end  # which a double may be beyond
    cut = replace(reference, events=events, final_time=final, pocketings=tuple(entries), reversal=turned)
    if reference.scene.capture or reference.scene.settle or reference.reversal is not None:
        return cut
    return replace(cut, motion=Left(reference, {m: reference.events[m] for m in sorted(known)}))


def _end(reference: Trajectory, span: Span) -> float:
    return span.time if math.isfinite(span.time) else float(reference.final_time)


@dataclass(frozen=True)
class Left:
    """Every circle as its last meeting inside the span left it, flying straight on; or as a wall carries it.

    Attributes:
        candidate: the whole run.
        events: those inside the span, by their index in the run.
    """

    candidate: Trajectory
    events: Mapping[int, Event]

    def state(self, time: Any) -> list[Row]:
        """(x, y, vx, vy) of every circle."""
        last: dict[str, int] = {}
        for index, event in self.events.items():
            if float(event.time) <= float(time):
                last.update((name, index) for pair in event.impulses for name in pair)
        struck = [last.get(str(circle.id)) for circle in self.candidate.scene.circles]
        states = {k: self.candidate.at(0) if k is None else self.candidate.after(k) for k in {*struck}}
        rows = []
        lying = self._lying(float(time))
        for place, index in enumerate(struck):
            if place in lying:
                rows.append(lying[place])
                continue
            told = states[index].circles[place]
            lag = float(time) - (0.0 if index is None else float(self.events[index].time))
            vx, vy = float(told.vx), float(told.vy)
            gx, gy = map(float, self.candidate.scene.gravity or (0, 0))
            x, y = float(told.x) + vx * lag + gx * lag * lag / 2, float(told.y) + vy * lag + gy * lag * lag / 2
            rows.append((x, y, vx + gx * lag, vy + gy * lag))
        return rows

    def _lying(self, time: float) -> dict[int, Row]:
        """The circles that the run may have at rest, which meet nothing more up to a time, as it has them; by place."""
        run = self.candidate
        if not run.scene.settle or not float(run.final_time) >= time:
            return {}
        more = [e for k, e in enumerate(run.events) if k not in self.events and float(e.time) <= time]
        busy = {name for event in more for pair in event.impulses for name in pair}
        names = [str(circle.id) for circle in run.scene.circles]
        rows = run.at(time if time < float(run.final_time) else run.final_time).circles
        return {
            place: (float(row.x), float(row.y), float(row.vx), float(row.vy))
            for place, row in enumerate(rows)
            if names[place] not in busy
        }

    def sample(self, times: Sequence[float]) -> Any:
        """Shape (times, circles, 4)."""
        return np.array([self.state(time) for time in times])


@dataclass(frozen=True)
class Known:
    """A run's motion; of circles of which it says nothing, the reference's, so that nothing is claimed of them.

    Attributes:
        run: the run.
        untold: those circles.
        reference: the reference.
        motion: how it goes to the end of the span.
    """

    run: Trajectory
    untold: Collection[str]
    reference: Trajectory
    motion: Left | Motion

    def state(self, time: Any) -> list[Row]:
        """(x, y, vx, vy) of every circle."""
        last = self.reference.final_time
        known = self.motion.state(last if float(last) <= float(time) else time)
        rows = zip(self.run.scene.circles, self.run.motion.state(time), known, strict=True)
        return [known if str(circle.id) in self.untold else row for circle, row, known in rows]

    def sample(self, times: Sequence[float]) -> Any:
        """Shape (times, circles, 4)."""
        return np.array([self.state(time) for time in times])
