"""Causal comparison of two runs: the first event at which some body's next partner differs.

Two runs agree while each body meets the same partners in the same order (they are equal as traces). Far-apart
collisions that merely swap their order change nothing; they are counted, not reported as a difference.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal, TypeAlias

from flint import fmpq

from ...exact.exact_motion import READ_BITS, motion_of
from ...exact.numbers import ball
from ...scenarios.numbers.quantity import real
from ...scenarios.trajectory import StopReason
from .instants import (
    Divergence,
    Finer,
    Kind,
    SharedInstant,
    clusters,
    first_changed_instant,
    first_lacked,
    same_velocity,
)
from .walk import REPEATED, Patience, Streams, Walk, history, patience_for, walk, without_tails

if TYPE_CHECKING:
    from ...exact.exact_motion import ExactMotion
    from ...scenarios.numbers.quantity import Real
    from ...scenarios.trajectory import Trajectory

Verdict: TypeAlias = Literal["diverged", "unsettled", "undecided", "agree"]

VERDICTS: tuple[Verdict, ...] = ("diverged", "unsettled", "undecided", "agree")
"""In order of precedence."""

UNKNOWING = (StopReason.UNDECIDED, StopReason.BUDGET, StopReason.INTERRUPTED)
"""Stops after which an engine would not go on, whatever the limits."""


SAME_BITS = 1024
"""Bits to which a time is compared with the end of a span: an event on the end itself agrees with it to any number."""


@dataclass(frozen=True)
class Span:
    """What is compared: a beginning of the reference's history.

    Attributes:
        events: how many of the reference's events lie inside.
        time: its end; infinite where the reference's history is known to be over.
        exact: the same in the reference's own numbers; None: the double is meant.
    """

    events: int
    time: float
    exact: Real | None = field(default=None, repr=False, compare=False)

    @classmethod
    def of(cls, reference: Trajectory) -> Span:
        """All that a run has."""
        quiet = reference.stop.reason is StopReason.QUIET
        end = reference.final_time
        return cls(len(reference.events), math.inf if quiet else float(end), None if quiet else end)

    def holds(self, time: Real) -> bool:
        """Whether a time lies in it; one that agrees with the exact end to `SAME_BITS` bits does.

        >>> from ...scenarios.numbers.quantity import Quantity
        >>> end = Quantity.of("1 - 1/10**60")
        >>> Span(0, 1.0).holds(1.0), Span(0, 1.0, end).holds(1.0), Span(0, 1.0, end).holds(end)
        (True, False, True)
        """
        near = float(time)
        if near != self.time or self.exact is None:
            return near <= self.time
        return ball.sign_of(real(time).ball(SAME_BITS) - real(self.exact).ball(SAME_BITS)) != 1


@dataclass(frozen=True)
class Wanted:
    """How far each run has to go on before the comparison is settled; None: as far as it is."""

    reference: float | None = None
    candidate: float | None = None


@dataclass(frozen=True)
class Alignment:
    """What the causal comparison of two runs found.

    Attributes:
        divergence: the first divergence, or None.
        undecided: whether the candidate stopped not knowing, before all of the span was matched.
        unsettled: whether something in the span can only be told by going on, and a run cannot.
        wanted: how far the runs have to go on to settle all that is open before the divergence, or the span's end.
        agreed: number of reference events before the divergence (or the candidate's stop) found in the
            candidate.
        reordered: independent events that the candidate has in another order.
        split: instants with several contacts that the candidate took apart without consequence.
        merged: candidate events that hold several reference events.
        whole: the reference events that are matched for all that take part.
        walks: each body's meetings as matched.
    """

    divergence: Divergence | None
    undecided: bool
    unsettled: bool
    wanted: Wanted
    agreed: int
    reordered: int
    split: int
    merged: int
    whole: frozenset[int] = field(repr=False, default=frozenset())
    walks: dict[str, Walk] = field(repr=False, default_factory=dict)

    @property
    def taken_together(self) -> int:
        """How many of the reference's events the candidate has as one contact with the one before."""
        return len({m for walked in self.walks.values() for mine in walked.merged.values() for m in sorted(mine)[1:]})

    @property
    def verdict(self) -> Verdict:
        """See `VERDICTS`."""
        if self.divergence is not None:
            return "diverged"
        return "unsettled" if self.unsettled else "undecided" if self.undecided else "agree"


def align(
    reference: Trajectory,
    candidate: Trajectory,
    *,
    span: Span | None = None,
    step: float | None = None,
    bits: int | None = None,
    patience: Patience | None = None,
    finer: Finer | None = None,
    instants: bool = True,
) -> Alignment:
    """Compares two runs of one scene by cause, in time linear in the number of events.

    Contacts that the reference has at one instant may come one after the other in the candidate if that
    changes nothing: if the event is not `coupled`, or if taking them in the candidate's order leads to the
    reference's velocities. In the same way the candidate may have several reference events at one instant.

    Both runs should go on beyond the span: a meeting near its end is told from a missing one by its partner.

    Args:
        span: what is compared; by default, all of the reference.
        step: the candidate's time step, if it has one: it reports a contact once, however many impulses pass
            through it within a step, and takes several events as one instant.
        bits: of the candidate's numbers; None: as many as it takes.
        patience: how late a meeting may be; by default, what the scene's measures grant.
        finer: tells whether velocities after an instant of several contacts come nearer as the step is made finer.
        instants: whether such instants are looked at; without, partners alone are compared.
    """
    span = Span.of(reference) if span is None else span
    patience = patience_for(reference.scene, step) if patience is None else patience
    mine, theirs = history(reference), history(candidate)
    if reference.scene.settle:
        mine, theirs = without_tails(reference, candidate, mine, theirs, patience)
    walks = _walks(mine, theirs, step or 0.0, patience)
    groups = clusters(walks, reference, candidate)
    judge = _Judge(reference, candidate, mine, theirs, span, patience)
    judge.look_round(groups, step or 0.0)
    found = [d for body, walked in walks.items() if (d := judge.divergence(body, walked)) is not None]
    first = min(found, key=lambda d: (d.time, d.event), default=None)
    before = (first.time, first.event) if first else (span.time, span.events - 1)
    lacks = None
    if instants:
        changed = first_changed_instant(
            reference, candidate, walks, groups, before, step or 0.0, finer, same_velocity(bits)
        )
        if changed is not None:
            tie, instant = changed
            event = first_lacked(reference, candidate, instant) if step and len(instant.mine) > 1 else tie.event
            if first is None or (tie.time, tie.event) <= (first.time, first.event):
                first, before, lacks = tie, (tie.time, tie.event), event
    matches = _matches(walks)
    event = min(judge.lacked, first.event if lacks is None else lacks) if first else span.events
    kept = {c: r for c, r in matches.items() if r < event}
    open_ones = [w for w in judge.open if w.inside and w.before(before)]
    wanted = Wanted(
        max((w.until for w in open_ones if w.of_reference), default=None),
        max(
            [
                *(w.until for w in open_ones if not w.of_reference),
                *judge.uncovered(first),
                *(judge.earlier(event) if first else []),
            ],
            default=None,
        ),
    )
    whole = _complete(walks, {r for w in walks.values() for r, c in w.pairs if c in kept and r < event}, span.events)
    stuck = candidate.stop.reason in UNKNOWING and wanted.candidate is not None
    more = wanted.reference is not None or (wanted.candidate is not None and not stuck)
    return Alignment(
        divergence=None if first is None else replace(first, event=event, own_event=first.event),
        undecided=stuck and first is None,
        unsettled=more and first is None,
        wanted=wanted,
        agreed=span.events if reference.scene.settle and first is None and not (stuck or more) else len(whole),
        reordered=_overtaken(kept),
        split=len({r for w in walks.values() for r in w.split if r <= event}),
        merged=len({c for w in walks.values() for c in w.merged if c in kept}),
        whole=frozenset(whole),
        walks=walks,
    )


def _walks(mine: Streams, theirs: Streams, step: float, patience: Patience) -> dict[str, Walk]:
    """Each body's meetings, matched; with a time step, by absorbing rounds, or one for one where that goes on longer.

    Rounds of one instant that come in several steps are no meetings of their own. But a contact that comes again soon
    is one, so that sequences that are equal longer than absorbing finds them are matched one for one. What is kept
    does not depend on the span.
    """

    def walked(absorbing: float) -> dict[str, Walk]:
        return {
            body: walk(met, theirs.meetings.get(body, []), mine.times, theirs.times, absorbing, patience)
            for body, met in mine.meetings.items()
        }

    absorbed = walked(step)
    if not step or (parted := _parted(absorbed, mine, theirs)) == math.inf:
        return absorbed
    plain = walked(0.0)
    return plain if _parted(plain, mine, theirs) > parted else absorbed


def _parted(walks: dict[str, Walk], mine: Streams, theirs: Streams) -> float:
    """When some body's sequences of partners first part, by the reference's clock where it has the meeting."""
    times: list[float] = []
    for parting in (walked.mismatch for walked in walks.values()):
        if parting is not None and parting.mine is not None:
            times.append(mine.times[parting.mine])
        elif parting is not None and parting.theirs is not None:
            times.append(theirs.times[parting.theirs])
    return min(times, default=math.inf)


def _matches(walks: dict[str, Walk]) -> dict[int, int]:
    """For each candidate event, the earliest reference event that a body matched with it."""
    matches: dict[int, int] = {}
    for walked in walks.values():
        for mine, theirs in walked.pairs:
            if mine < matches.get(theirs, mine + 1):
                matches[theirs] = mine
    return matches


def _complete(walks: dict[str, Walk], within: set[int], events: int) -> set[int]:
    """The reference events inside the span that the candidate has for every body that takes part."""
    found = {r for w in walks.values() for r, _ in w.pairs if r < events}
    for walked in walks.values():
        if walked.mismatch is not None and walked.mismatch.mine is not None:
            found.discard(walked.mismatch.mine)
    return found & within


def _overtaken(matches: dict[int, int]) -> int:
    """Number of candidate events that come after one which the reference has later."""
    latest, count = -1, 0
    for theirs in sorted(matches):
        mine = matches[theirs]
        count += mine < latest
        latest = max(latest, mine)
    return count


@dataclass(frozen=True)
class _Open:
    """A meeting that one run has and the other may still come to.

    Attributes:
        inside: whether it lies in the span.
    """

    time: float
    event: int
    of_reference: bool
    until: float
    inside: bool = True

    def before(self, place: tuple[float, int]) -> bool:
        """Whether it could be the first divergence, in place of one that is known."""
        return (self.time, self.event) <= place or self.time <= place[0]


class _Judge:
    """Says what a mismatch is, with regard to how far each run goes.

    Attributes:
        open: the mismatches that more of a run would settle.
        lacked: the first event of the reference that the candidate is known to lack, or before which it has one too
            many, in the span or beyond: the span says whether there is a divergence, and never which.
    """

    def __init__(
        self,
        reference: Trajectory,
        candidate: Trajectory,
        mine: Streams,
        theirs: Streams,
        span: Span,
        patience: Patience,
    ) -> None:
        self.reference, self.candidate = reference, candidate
        self.mine, self.theirs = mine, theirs
        self.span, self.patience = span, patience
        self.open: list[_Open] = []
        self.lacked = len(mine.times)
        self._mine: set[tuple[int, str]] = set()
        self._theirs: set[tuple[int, str]] = set()

    def look_round(self, groups: Sequence[SharedInstant], step: float) -> None:
        """Notes the instants that reach into the span: what belongs to them counts as inside, wherever it lies.

        With a time step, an instant of several contacts may go on for some steps, so both runs must.
        """
        for group in groups:
            first, last = self.mine.times[group.mine[0]], self.mine.times[group.mine[-1]]
            start, end = self.theirs.times[group.theirs[0]], self.theirs.times[group.theirs[-1]]
            if group.mine[0] >= self.span.events and not self.span.holds(self.candidate.events[group.theirs[0]].time):
                continue
            for name, _, _ in group.bodies:
                self._mine.update((m, name) for m in group.mine)
                self._theirs.update((c, name) for c in group.theirs)
            if step and group.coupled(self.reference, self.candidate):
                until = max(last, end) + REPEATED * step
                for run in (self.reference, self.candidate):
                    if run.stop.reason is not StopReason.QUIET and float(run.final_time) < until:
                        self.open.append(_Open(min(first, start), group.mine[0], run is self.reference, until))

    def divergence(self, body: str, walked: Walk) -> Divergence | None:
        """The divergence that a body's mismatch is, if it lies in the span and is settled."""
        mismatch = walked.mismatch
        if mismatch is None:
            return None
        mine = None if mismatch.mine is None else self.mine.times[mismatch.mine]
        theirs = None if mismatch.theirs is None else self.theirs.times[mismatch.theirs]
        inside = mismatch.mine is not None and (mismatch.mine < self.span.events or (mismatch.mine, body) in self._mine)
        met = mismatch.theirs is not None and (
            self.span.holds(self.candidate.events[mismatch.theirs].time) or (mismatch.theirs, body) in self._theirs
        )
        time = min(t for t in (mine, theirs) if t is not None)
        event = mismatch.mine
        if event is None:  # where it would be: after all that the body has had before
            event = max(bisect_left(self.mine.times, time), max((m for m, _ in walked.pairs), default=-1) + 1)
        if not mismatch.final:
            waits, until = (self.candidate if theirs is None else self.reference), self.patience.latest(time)
            if waits.stop.reason is not StopReason.QUIET and float(waits.final_time) < until:
                self.open.append(_Open(time, event, waits is self.reference, until, inside or met))
                return None
        self.lacked = min(self.lacked, event)
        if not inside and not met:
            return None
        kind = Kind.MISSING if theirs is None else Kind.EXTRA if mine is None else Kind.DIFFERENT
        return Divergence(event, time, body, mismatch.expected, mismatch.got, kind, mine, theirs, mismatch.theirs)

    def uncovered(self, first: Divergence | None) -> list[float]:
        """Where the candidate does not come to the end of what is compared: how far settles what may lie near that."""
        end = self.span.time if first is None else min(first.time, self.span.time)
        over = self.candidate.stop.reason is StopReason.QUIET or (first is None and self._at_rest())
        return [] if over or _known_until(self.candidate) >= end else [self.patience.latest(end)]

    def _at_rest(self) -> bool:
        """Whether both runs end with a circle at rest, after as many events; clocks may differ by rounding."""
        reasons = {run.stop.reason for run in (self.reference, self.candidate)}
        return reasons == {StopReason.REST} and len(self.reference.events) == len(self.candidate.events)

    def earlier(self, event: int) -> list[float]:
        """How far the candidate tells whether it lacks events before the one known, which may lie past the span."""
        return [one.until for one in self.open if not one.of_reference and one.event < event]


def _known_until(run: Trajectory) -> float:
    """How far a run goes: where infinitely many collisions end it, these go on alone until all have happened.

    So they do of a circle between two walls that close, until it has no room.
    """
    alone = run.stop.reason in (StopReason.ACCUMULATION, StopReason.CRUSHED)
    return float(run.final_time if run.ending is None or not alone else run.ending)


# ----------------------------------------
# How far apart two runs of one scene are, over time.

SAMPLES = 200
"""Sample times of a separation: as many as a plot of ordinary width can show apart."""

WITHIN = 1 - 2.0**-50
"""The last sample lies this share of the span inside of both runs, whatever the rounding of their end."""


@dataclass(frozen=True)
class Separation:
    """The largest distance between where two runs have a circle, at sample times.

    Attributes:
        times: ascending, from 0 to the end of the shorter run.
        largest: at each time, the largest distance over all circles, in units of the scene.
        circle: id of the circle that is farthest off at the end.
        scale: the largest coordinate of the reference: what a distance is to be compared with.

    A distance of nan was not measured, an infinite one is beyond the doubles.
    """

    times: tuple[float, ...]
    largest: tuple[float, ...]
    circle: str
    scale: float

    @property
    def final(self) -> float:
        """The largest distance at the end."""
        return self.largest[-1]

    @property
    def maximum(self) -> float:
        """The largest distance at any sample time."""
        return max(self.largest)

    def thinned(self, count: int) -> Separation:
        """The same at `count` of the times, first and last included."""
        if len(self.times) <= count:
            return self
        keep = [round(k * (len(self.times) - 1) / (count - 1)) for k in range(count)]
        return Separation(
            tuple(self.times[k] for k in keep), tuple(self.largest[k] for k in keep), self.circle, self.scale
        )


def not_measured(reference: Trajectory) -> Separation:
    """What stands for a separation that there was no time for: nan at time 0, of no circle in particular."""
    return Separation((0.0,), (math.nan,), str(reference.scene.circles[0].id), 0.0)


def separation(
    reference: Trajectory, candidate: Trajectory, end: float, samples: int = SAMPLES, at: Sequence[float] = ()
) -> Separation:
    """The distance between two runs at evenly spaced times, up to `end` or the end of the shorter.

    Args:
        at: other times at which it is measured too, such as a divergence, as far as they lie in between.
    """
    last = WITHIN * min(end, float(reference.final_time), float(candidate.final_time))
    times = [last * k / (samples - 1) for k in range(samples)] if last > 0 else [0.0]
    if at:
        times = sorted({*times, *(time for time in at if 0.0 <= time <= last)})
    try:
        import numpy as np
    except ModuleNotFoundError:
        return _separation_in_lists(reference, candidate, times)
    mine, theirs = reference.sample(times)[:, :, :2], candidate.sample(times)[:, :, :2]
    apart = np.hypot(mine[:, :, 0] - theirs[:, :, 0], mine[:, :, 1] - theirs[:, :, 1])
    farthest = int(np.argmax(apart[-1]))
    scale = float(np.max(np.abs(mine))) if mine.size else 0.0
    return Separation(
        tuple(times),
        tuple(float(value) for value in np.nan_to_num(apart.max(axis=1), nan=math.inf)),
        str(reference.scene.circles[farthest].id),
        scale,
    )


def _separation_in_lists(reference: Trajectory, candidate: Trajectory, times: list[float]) -> Separation:
    """The same where there is no NumPy."""
    mine, theirs = rows_of(reference, times), rows_of(candidate, times)
    apart = [[math.dist(a[:2], b[:2]) for a, b in zip(*rows, strict=True)] for rows in zip(mine, theirs, strict=True)]
    farthest = max(range(len(apart[-1])), key=apart[-1].__getitem__)
    return Separation(
        tuple(times),
        tuple(math.inf if math.isnan(far := max(row)) else far for row in apart),
        str(reference.scene.circles[farthest].id),
        max((abs(value) for rows in mine for row in rows for value in row[:2]), default=0.0),
    )


def rows_of(run: Trajectory, times: Sequence[float]) -> Sequence[Sequence[Sequence[float]]]:
    """`Trajectory.sample` in lists: for each time, x, y, vx and vy of each circle.

    Where there is no NumPy, as in a browser, engines whose motion tells doubles, and the exact one, have them all the
    same.

    >>> from truebreak.scenarios import Circle, Scene
    >>> from truebreak.exact import ExactEngine
    >>> rows_of(ExactEngine().run(Scene([Circle(0, 0, vx=1)]), until=2), [1.5])
    [[[1.5, 0.0, 1.0, 0.0]]]
    """
    try:
        return run.sample(times).tolist()
    except ModuleNotFoundError:
        motion = motion_of(run)
        if motion is not None and run.scene.gravity is None:
            return _exact_rows(motion, times)
        return [[tuple(map(float, row)) for row in run.motion.state(time)] for time in times]


def _exact_rows(motion: ExactMotion, times: Sequence[float]) -> list[list[tuple[float, ...]]]:
    """Beside an event, within some ulps of its time, a velocity may be that before it."""
    rough = [[float(ball.known_ball(knot[0], READ_BITS)) for knot in row] for row in motion.knots]
    found: list[list[tuple[float, ...]]] = []
    for time in times:
        then, rows = fmpq(*float(time).as_integer_ratio()), list[tuple[float, ...]]()
        for knots, about in zip(motion.knots, rough, strict=True):
            t, x, y, vx, vy, *_ = knots[max(bisect_right(about, time) - 1, 0)]
            places = (ball.flown(x, vx, then, t, READ_BITS), ball.flown(y, vy, then, t, READ_BITS))
            rows.append(tuple(float(ball.known_ball(number, READ_BITS)) for number in (*places, vx, vy)))
        found.append(rows)
    return found


RETURNED = 2.0**-40
"""A run that ends within this share of its length of twice the time of reversal ends at the return."""


def return_miss(trajectory: Trajectory, reference: Trajectory) -> float | None:
    """After a reversal, the largest distance from the start when the reference is back at its start.

    That is at twice the time of the reversal. None without a reversal, or if a run does not last that long.
    """
    if reference.reversal is None or trajectory.reversal is None:
        return None
    back, end = 2 * float(reference.reversal.time), float(reference.final_time)
    at_end = abs(end - back) <= RETURNED * back
    if float(trajectory.final_time) < back and not (at_end and trajectory is reference):
        return None
    if end < back and not at_end:
        return None
    state = trajectory.at(reference.final_time if at_end else back)
    return max(
        math.hypot(float(now.x) - float(start.x), float(now.y) - float(start.y))
        for now, start in zip(state.circles, trajectory.scene.circles, strict=True)
    )
