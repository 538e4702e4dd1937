"""Which balls enter a pocket, and when; which of these entries two runs share, and which one of them only has later."""

from __future__ import annotations

import math
from bisect import bisect_right
from typing import TYPE_CHECKING, Any

from ...floating.pymunk_run import time_to_enter
from ...scenarios.trajectory import StopReason

if TYPE_CHECKING:
    from ...scenarios.trajectory import Pocketing, Trajectory
    from ..alignment.align import Alignment, Span
    from ..alignment.patience import Patience


def pocketed(trajectory: Trajectory) -> dict[str, Any] | None:
    """For each circle whose centre enters a pocket, the first pocket and the instant, to a double's precision.

    None for a scene without pockets.
    """
    scene = trajectory.scene
    if not scene.pockets:
        return None
    first = {p.circle: {"pocket": p.pocket, "time": float(p.time)} for p in reversed(trajectory.pocketings)}
    return {str(c.id): first[str(c.id)] for c in scene.circles if str(c.id) in first}


class Entries:
    """The entries of a run beside those of the reference.

    Two entries are the same where one circle enters one pocket in a flight that both runs have: after the same meeting
    of it, on the same side of the reversal.
    """

    def __init__(self, run: Trajectory, reference: Trajectory, alignment: Alignment, patience: Patience) -> None:
        self.run, self.reference, self.patience = run, reference, patience
        self._met = {id(told): _meetings(told) for told in (run, reference)}
        self._matched = {
            name: {c: m for m, c in sorted(walked.pairs)} for name, walked in alignment.walks.items()
        }  # of several of the reference's, the last
        known = {self._flight(reference, entry): m for m, entry in enumerate(reference.pocketings)}
        flights = {k: self._flight(run, entry) for k, entry in enumerate(run.pocketings)}
        self.same = {k: known[flight] for k, flight in flights.items() if flight in known}

    def inside(self, span: Span) -> tuple[Pocketing, ...]:
        """The run's over the span. One that both have counts by where the reference has it, and so does one that the
        reference, where it ends, has yet to come to."""
        return tuple(entry for k, entry in enumerate(self.run.pocketings) if self._holds(span, k, entry))

    def expected(self, span: Span) -> dict[int, Pocketing]:
        """The reference's over the span, by their number."""
        return {m: entry for m, entry in enumerate(self.reference.pocketings) if span.holds(entry.time)}

    def shared(self, span: Span) -> dict[int, Pocketing]:
        """Those of `expected` that the run has too."""
        both = set(self.same.values())
        return {m: entry for m, entry in self.expected(span).items() if m in both}

    def certain(self, span: Span) -> dict[int, Pocketing]:
        """Those of `expected` that the run has too, or will not come to: for the others it may only be late."""
        both = set(self.same.values())
        return {
            m: entry
            for m, entry in self.expected(span).items()
            if m in both or not self._awaited(self.run, entry, self.reference)
        }

    def _holds(self, span: Span, k: int, entry: Pocketing) -> bool:
        if k in self.same:
            return span.holds(self.reference.pocketings[self.same[k]].time)
        if not span.holds(entry.time) or self._awaited(self.reference, entry, self.run):
            return False
        return self.run.stop.reason is StopReason.QUIET or float(entry.time) < float(self.run.final_time)

    def _awaited(self, run: Trajectory, entry: Pocketing, other: Trajectory) -> bool:
        """Whether a run ends in the very flight of an entry of the other, and that flight comes to it, if late; or at
        the entry's own time, of which it may not have told all."""
        if run.stop.reason is StopReason.QUIET:
            return False
        if float(entry.time) == float(run.final_time):
            return True
        state = run.final[entry.circle]
        x, y, vx, vy = (float(value) for value in (state.x, state.y, state.vx, state.vy))
        pocket = next(pocket for pocket in run.scene.pockets if pocket.id == entry.pocket)
        wait = time_to_enter(x - float(pocket.x), y - float(pocket.y), vx, vy, float(pocket.r))
        if wait is None or float(run.final_time) + wait > self.patience.latest(float(entry.time)):
            return False
        here, there = self._flight(run, entry, math.inf), self._flight(other, entry)
        return here == there

    def _flight(
        self, run: Trajectory, entry: Pocketing, time: float | None = None
    ) -> tuple[str, str, int | None, bool]:
        """Who enters what, the reference's number of the last meeting of it before, and whether velocities had been
        reversed; -1 for a meeting that the reference does not have."""
        now = float(entry.time) if time is None else time
        times, indices = self._met[id(run)].get(entry.circle, ((), ()))
        place = bisect_right(times, now)
        last = indices[place - 1] if place else None
        if last is not None and run is self.run:
            last = self._matched[entry.circle].get(last, -1)
        turned = run.reversal is not None and float(run.reversal.time) <= now
        return entry.circle, entry.pocket, last, turned


def _meetings(run: Trajectory) -> dict[str, tuple[list[float], list[int]]]:
    """When each circle is struck, and in which events; nothing where there are no pockets."""
    met: dict[str, tuple[list[float], list[int]]] = {}
    for event in run.events if run.scene.pockets else ():
        for name in {name for pair in event.impulses for name in pair}:
            times, indices = met.setdefault(name, ([], []))
            times.append(float(event.time))
            indices.append(event.index)
    return met
