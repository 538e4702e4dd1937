"""Causal comparison of two runs: the first event at which some body's next partner differs.

Two runs agree while each body meets the same partners in the same order (they are equal as traces). Far-apart
collisions that merely swap their order change nothing; they are counted, not reported as a difference.
"""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ...scenarios.trajectory import StopReason
from .broken_ties import first_broken_tie
from .divergence import Divergence, Kind
from .streams import History, history
from .walk import Mismatch, Walk, walk

if TYPE_CHECKING:
    from ...scenarios.trajectory import Trajectory

TIME_SAFETY = 100.0
"""Near the end of the span a partner is called missing or extra only if it is this many times farther from
the end than the largest difference of times so far: a time error grows less than this within one flight."""

TIME_FLOOR = 2.0**-30
"""Least difference of times assumed, as a share of the span: what rounding alone may reach in a long run."""

CUT_SHORT = (StopReason.UNDECIDED, StopReason.BUDGET, StopReason.INTERRUPTED, StopReason.EVENTS)
"""Stops after which a candidate's missing events say nothing."""


@dataclass(frozen=True)
class Alignment:
    """What the causal comparison of two runs found.

    Attributes:
        divergence: the first divergence, or None.
        undecided: whether the candidate stopped, before the end of the span and before any divergence.
        agreed: number of reference events before the divergence (or the candidate's stop) found in the
            candidate.
        harmless_swaps: independent events that the candidate has in another order.
        harmless_splits: instants with several contacts that the candidate took apart without consequence.
        merged: candidate events that hold several reference events.
        time_error: largest difference between the two times of one event, over the events agreed.
        unsettled: whether something at the very end of the span could not be told from an error of time.
        matches: for each candidate event that was matched, the reference event.
    """

    divergence: Divergence | None
    undecided: bool
    agreed: int
    harmless_swaps: int
    harmless_splits: int
    merged: int
    time_error: float
    unsettled: bool
    matches: dict[int, int] = field(repr=False, default_factory=dict)

    @property
    def verdict(self) -> str:
        """`agree`, `diverged` or `undecided`."""
        if self.divergence is not None:
            return "diverged"
        return "undecided" if self.undecided else "agree"


def align(reference: Trajectory, candidate: Trajectory, *, span: float | None = None, step: float = 0.0) -> Alignment:
    """Compares two runs of one scene by cause, in time linear in the number of events.

    Contacts that the reference has at one instant may come one after the other in the candidate if that
    changes nothing: if the event is not `coupled`, or if taking them in the candidate's order leads to the
    reference's velocities. In the same way the candidate may have several reference events at one instant.

    Args:
        span: compare up to this time; by default, up to the reference's end. A reference that runs on beyond
            the span settles what a candidate has near its end.
        step: the candidate's time step, if it has one: it reports a contact once, however many impulses pass
            through it within a step, and takes several events as one instant.
    """
    mine, theirs = history(reference), history(candidate)
    end = float(reference.final_time) if span is None else span
    walks = {
        body: walk(mine.meetings[body], theirs.meetings.get(body, []), mine.times, theirs.times, step)
        for body in mine.meetings
    }
    matches = _matches(walks)
    error = max((abs(mine.times[r] - theirs.times[c]) for c, r in matches.items()), default=0.0)
    tail = _Tail(reference, candidate, mine, theirs, end, TIME_SAFETY * max(error, 2 * step, TIME_FLOOR * end))
    found: list[Divergence] = []
    unsettled = False
    for body, walked in walks.items():
        if walked.mismatch is None:
            continue
        divergence, doubtful = tail.judge(body, walked.mismatch)
        unsettled |= doubtful
        if divergence is not None:
            found.append(divergence)
    first = min(found, key=lambda d: (d.time, d.event), default=None)
    before = first.time if first else end
    tie = first_broken_tie(reference, candidate, walks, mine, before, step)
    if tie is not None and (first is None or (tie.time, tie.event) <= (first.time, first.event)):
        first = tie
    cut = candidate.stop.reason in CUT_SHORT and float(candidate.final_time) < end
    stop_at = (first.time, first.event) if first else (end, len(mine.times))
    kept = {c: r for c, r in matches.items() if (mine.times[r], r) < stop_at or (not first and mine.times[r] <= end)}
    return Alignment(
        divergence=first,
        undecided=cut and first is None,
        agreed=len(_complete(walks, {r for w in walks.values() for r, c in w.pairs if c in kept})),
        harmless_swaps=_overtaken(kept),
        harmless_splits=len({r for w in walks.values() for r in w.split if mine.times[r] <= before}),
        merged=len({c for w in walks.values() for c in w.merged if c in kept}),
        time_error=max((abs(mine.times[r] - theirs.times[c]) for c, r in kept.items()), default=0.0),
        unsettled=unsettled and first is None,
        matches=kept,
    )


def _matches(walks: dict[str, Walk]) -> dict[int, int]:
    """For each candidate event, the earliest reference event that a body matched with it."""
    matches: dict[int, int] = {}
    for walked in walks.values():
        for mine, theirs in walked.pairs:
            if mine < matches.get(theirs, mine + 1):
                matches[theirs] = mine
    return matches


def _complete(walks: dict[str, Walk], within: set[int]) -> set[int]:
    """The reference events that the candidate has for every body that takes part."""
    events = {r for w in walks.values() for r, _ in w.pairs}
    for walked in walks.values():
        if walked.mismatch is not None and walked.mismatch.mine is not None:
            events.discard(walked.mismatch.mine)
    return events & within


def _overtaken(matches: dict[int, int]) -> int:
    """Number of candidate events that come after one which the reference has later."""
    latest, count = -1, 0
    for theirs in sorted(matches):
        mine = matches[theirs]
        count += mine < latest
        latest = max(latest, mine)
    return count


@dataclass(frozen=True)
class _Tail:
    """Judges a mismatch with regard to where each run ends."""

    reference: Trajectory
    candidate: Trajectory
    mine: History
    theirs: History
    end: float
    doubt: float

    def judge(self, body: str, mismatch: Mismatch) -> tuple[Divergence | None, bool]:
        """The divergence that a mismatch is, if it is one; and whether it is too near the end to tell."""
        mine = None if mismatch.mine is None else self.mine.times[mismatch.mine]
        theirs = None if mismatch.theirs is None else self.theirs.times[mismatch.theirs]
        quiet = self.reference.stop.reason is StopReason.QUIET
        if mine is not None and theirs is not None:
            if min(mine, theirs) > self.end:
                return None, False
            kind, doubtful = Kind.DIFFERENT, mine > self.end and theirs + self.doubt > self.end
        elif mine is not None:
            if mine > self.end:
                return None, False
            stopped = float(self.candidate.final_time)
            over = self.candidate.stop.reason is StopReason.QUIET
            kind, doubtful = Kind.MISSING, not over and mine + self.doubt > stopped
            if doubtful and self.candidate.stop.reason in CUT_SHORT:
                return None, False
        else:
            assert theirs is not None
            if theirs > self.end and not quiet:
                return None, False
            kind, doubtful = Kind.EXTRA, not quiet and theirs + self.doubt > float(self.reference.final_time)
        if doubtful:
            return None, True
        time = min(t for t in (mine, theirs) if t is not None)
        event = mismatch.mine if mismatch.mine is not None else bisect_left(self.mine.times, time)
        return (
            Divergence(event, time, body, mismatch.expected, mismatch.got, kind, mine, theirs, mismatch.theirs),
            False,
        )
