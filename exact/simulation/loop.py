"""Predict, gather the next instant, resolve it, repeat: the event-driven loop, written once for every number system.

1. Every pair's next meeting is predicted from the flights as they are, and put in a queue.
2. The arrivals that may be first are taken off; what may not come is settled; the numbers decide which is first,
   and which fall on the same instant. A limit in time counts as one of them.
3. The whole instant is resolved (`Resolver`), and only then noted.
4. The next meetings of the circles whose flights changed are predicted; on to 2.

A run that has to stop within an instant, because a sign is not to be had or the user interrupts it, ends at the last
whole one.
"""

from __future__ import annotations

import time as clock
from collections.abc import Collection
from math import inf

from ...scenarios.errors import TimeIsUp
from ...scenarios.event import Tie
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ...scenarios.trajectory import OnProgress, Progress, Stop, StopReason
from ..machine import Link
from ..policies import Policy, policy_for
from ..questions import BeforeTime, Closing, Moment
from ..undecided import BudgetSpent, Undecided
from .decider import Decider
from .instant import Instant, Resolved, Resolver
from .limits import Limits
from .queue import Arrival
from .start import rims_at_start, touching_at_start

PROGRESS_EVERY = 0.2
"""Seconds between progress reports."""


class Loop:
    """The loop over one scene.

    Args:
        scene: what runs.
        decider: keeps its state in some numbers, and decides.
        limits: where it ends.
        progress: told now and then how far it is.
        policy: in place of the scene's own.
    """

    def __init__(
        self,
        scene: Scene,
        decider: Decider,
        limits: Limits,
        progress: OnProgress | None,
        policy: Policy | None = None,
    ) -> None:
        self.scene = scene
        self.decider = decider
        self.limits = limits
        self.progress = progress
        self.history = decider.history
        self.queue = decider.queue
        self.resolver = Resolver(scene, decider, policy or policy_for(scene.tie_policy))
        self.n = len(scene.circles)
        self._instants = 0
        self._passed: list[Arrival] = []
        self._split = False
        self._known_bounds: dict[Quantity, tuple[float, float]] = {}
        self._next_report = clock.monotonic() + PROGRESS_EVERY

    def run(self) -> Stop:
        """Runs to the end and says why it ended."""
        self.decider.refresh(self.decider.bodies)
        self.history.knots += [[(*self.decider.knot(body), 0, 0)] for body in self.decider.bodies]
        try:
            self._open()
            while True:
                stop = self._limit_on_events()
                if stop is not None:
                    return stop
                found = self._gather()
                if isinstance(found, Stop):
                    return found
                if found is not None:
                    self._resolve(found)
                self._report()
        except Undecided as outcome:
            return self._stopped(StopReason.UNDECIDED, str(outcome))
        except (BudgetSpent, TimeIsUp) as outcome:
            return self._stopped(StopReason.BUDGET, str(outcome))
        except KeyboardInterrupt:
            return self._stopped(StopReason.INTERRUPTED, "")

    def _stopped(self, reason: StopReason, told: str) -> Stop:
        """Ends at the last whole instant: what was begun of the next is dropped."""
        self.history.drop_unfinished()
        return Stop(reason, f"{reason.value}: {told or f'after {len(self.history.records)} events'}")

    # -- the instants

    def _open(self) -> None:
        """The instant at time 0, and the first predictions."""
        decider = self.decider
        links = touching_at_start(self.scene)
        decider.begin(0)
        decider.gathered(links)
        signs = {link: decider.ask(Closing(link)) for link in links}
        rims = rims_at_start(self.scene)
        instant = Instant(
            0,
            hits=tuple(link for link, sign in signs.items() if sign < 0),
            touches={link: sign for link, sign in signs.items() if sign >= 0},
            arrivals=tuple(link for link in rims if decider.ask(Closing(link)) < 0),
            rims=frozenset(rims),
        )
        for link, sign in signs.items():
            self.resolver.admit(link, sign)
        done = self.resolver.resolve(instant, self.limits.events, self.scene.reverse_after)
        self._note(instant, done)
        standing = {*links, *rims, *self._standing(done)}
        decider.predict(decider.bodies, standing, self.resolver.gone)

    def _standing(self, done: Resolved) -> Collection[Link]:
        """The contacts and rims at gap zero that a prediction must leave out."""
        lasting = self.resolver.touching.all()
        return {*done.standing, *lasting} if lasting else done.standing

    def _resolve(self, instant: Instant) -> None:
        """Resolves an instant, notes it, and predicts anew."""
        decider, records = self.decider, len(self.history.records)
        decider.begin(instant.number)
        left = None if self.limits.events is None else self.limits.events - records
        due = self.scene.reverse_after
        reverse_in = None if due is None or self.history.reversal is not None else due - records
        done = self.resolver.resolve(instant, left, reverse_in)
        self._note(instant, done)
        if done.moved:
            moved = [decider.bodies[i] for i in sorted(done.moved)]
            decider.predict(moved, self._standing(done), self.resolver.gone)

    def _note(self, instant: Instant, done: Resolved) -> None:
        """Puts a whole instant into the history."""
        note, before, history = self.resolver.noted(done), done.before, self.history
        self._split = done.split
        self._instants = instant.number
        for i in done.moved:
            self.decider.bodies[i].serial += 1
        if before is not None:
            history.add(before)
        if note.reversal is not None:
            history.reversal = (len(history.records), note.reversal)
        history.add(note)
        if done.flipped:
            self.queue.clear()
            self._passed.clear()
        history.last = note.last or history.last

    # -- gathering

    def _gather(self) -> Instant | Stop | None:
        """All that falls on the next instant; a reason to stop; or None after a graze that touched nothing else."""
        limit = self._time_limit()
        low, high = (inf, inf) if limit is None else self._bounds(limit[0])
        rivals = self._rivals(high)
        grazes = [rival for rival in rivals if rival.graze]
        chosen, ties = self._first([rival for rival in rivals if not rival.graze] if grazes else rivals)
        if grazes and not chosen:
            self._pass(grazes)
            return None
        place = self._place(chosen[0], limit[0]) if limit is not None and chosen else 1
        if limit is not None and place > 0:
            for arrival in (*chosen, *grazes):
                self.queue.put_back(arrival)
            if not limit[1]:
                return self._horizon_stop()
            known = [g for g in (*self._passed, *self.queue.grazes()) if g.low <= high and g.high >= low]
            at_it = [g for g in known if self.queue.fresh(g) and self._place(g, limit[0]) == 0]
            return self._instant([], at_it, ties, self._set_time(limit[0]))
        if not chosen:
            return Stop(StopReason.QUIET, StopReason.QUIET.value)
        at_limit = None if limit is None or place < 0 else self._set_time(limit[0])
        moment = at_limit if limit is not None and limit[1] else None
        touches = self._grazes_at(chosen, grazes, ties, moment is not None or self._reverses_after(chosen))
        return self._instant(chosen, touches, ties, moment)

    def _set_time(self, time: Quantity | None) -> Quantity | None:
        """Notes that the next instant falls on a set time (None: the return)."""
        if time is not None:
            self.history.set_times[time] = self._instants + 3
        return time

    def _rivals(self, limit: float) -> list[Arrival]:
        """All arrivals that may be first and not after a limit, each certain to come if nothing else does."""
        while True:
            found = self.queue.rivals()
            rivals = [rival for rival in found if rival.low <= limit]
            if len(rivals) < len(found):
                for rival in found:
                    if rival.low > limit:
                        self.queue.put_back(rival)
            if not any(rival.time is None for rival in rivals):
                return rivals
            for rival in rivals:
                settled = rival if rival.time is not None else self.decider.settled(rival)
                if settled is not None:
                    self.queue.put_back(settled)

    def _first(self, rivals: list[Arrival]) -> tuple[list[Arrival], list[Tie]]:
        """Those that come first, together; the others go back to the queue."""
        if len(rivals) < 2:
            return rivals, []
        decider = self.decider
        timed = [decider.timed(rival) for rival in sorted(rivals, key=lambda rival: rival.link[1] < 0)]
        front = []
        for rival in timed:
            if any(decider.certainly_before(other, rival) for other in timed):
                self.queue.put_back(rival)
            else:
                front.append(rival)
        chosen, ties = front[:1], []
        for rival in front[1:]:
            first = chosen[0]
            sign = decider.order(rival, first)
            if sign > 0:
                self.queue.put_back(rival)
            elif sign == 0:
                if rival.link[1] >= 0:
                    ties.append(decider.tie((first.link, rival.link)))
                chosen.append(rival)
            else:
                for other in chosen:
                    self.queue.put_back(other)
                chosen, ties = [rival], []
        return chosen, ties

    def _instant(
        self, chosen: list[Arrival], touches: list[Arrival], ties: list[Tie], moment: Quantity | None
    ) -> Instant:
        entries = [a.link for a in chosen if a.link[1] < 0]
        if len(chosen) == 1 and not touches and moment is None and chosen[0].link[1] >= 0:
            return Instant(self._instants + 2, hits=(chosen[0].link,), clock=chosen[0].link)
        return Instant(
            self._instants + 2,
            hits=tuple(sorted(a.link for a in chosen if a.link[1] >= 0)),
            touches=dict.fromkeys(sorted(a.link for a in touches if a.link[1] >= 0), 0),
            arrivals=tuple(entries),
            rims=frozenset(entries) | {a.link for a in touches if a.link[1] < 0},
            ties=tuple(ties),
            clock=chosen[0].link if chosen else None,
            reversal=moment is not None,
            moment=moment,
        )

    # -- grazes

    def _grazes_at(
        self, chosen: list[Arrival], grazes: list[Arrival], ties: list[Tie], everywhere: bool
    ) -> list[Arrival]:
        """The grazes that fall on the instant of others and can take part in it.

        Those are the ones that its contacts reach through shared circles; if velocities are to be negated at it,
        all of them.
        """
        if not grazes and not everywhere:
            return []
        reached = self._reached({i for a in chosen for i in a.link if i < self.n})
        found: list[Arrival] = []
        waiting = self._overlapping(chosen[0], grazes) if everywhere else grazes
        progress = True
        while progress:
            progress = False
            for graze in list(waiting):
                if not everywhere and not reached & {i for i in graze.link if 0 <= i < self.n}:
                    continue
                waiting.remove(graze)
                sign = self._graze_place(graze, chosen[0])
                if sign == 0:
                    if graze.link[1] >= 0 <= chosen[0].link[1]:
                        ties.append(self.decider.tie((graze.link, chosen[0].link)))
                    found.append(graze)
                    reached = self._reached(reached | {i for i in graze.link if 0 <= i < self.n})
                    progress = True
                elif sign < 0:
                    self._passed.append(graze)
                else:
                    self.queue.put_back(graze)
        for graze in waiting:
            self.queue.put_back(graze)
        return found

    def _graze_place(self, graze: Arrival, other: Arrival) -> int:
        timed, first = self.decider.timed(graze), self.decider.timed(other)
        if self.decider.certainly_before(timed, first):
            return -1
        if self.decider.certainly_before(first, timed):
            return 1
        return self.decider.order(timed, first)

    def _reached(self, bodies: set[int]) -> set[int]:
        """The circles that contacts of some circles reach through lasting contacts."""
        reached = {i for i in bodies if i >= 0}
        lasting = self.resolver.touching.all()
        grown = bool(lasting)
        while grown:
            more = {i for link in lasting if reached & {k for k in link if k < self.n} for i in link if i < self.n}
            grown = not more <= reached
            reached |= more
        return reached

    def _pass(self, grazes: list[Arrival]) -> None:
        """Drops the graze that comes first: it touches nothing that moves otherwise, and changes nothing."""
        first = min(grazes, key=lambda graze: graze.high)
        for graze in grazes:
            if graze is not first:
                self.queue.put_back(graze)
        self._passed.append(first)

    def _overlapping(self, arrival: Arrival, grazes: list[Arrival]) -> list[Arrival]:
        self._passed = [graze for graze in self._passed if self.queue.fresh(graze)]
        near = [g for g in self._passed if g.low <= arrival.high and g.high >= arrival.low]
        return [*grazes, *near]

    # -- limits

    def _limit_on_events(self) -> Stop | None:
        events = self.limits.events
        if events is None or len(self.history.records) < events:
            return None
        left_out = "; the reversal, which falls on the same instant, and what follows it are left out"
        return Stop(StopReason.EVENTS, f"{StopReason.EVENTS.value} ({events}){left_out if self._split else ''}")

    def _reverses_after(self, chosen: list[Arrival]) -> bool:
        due = self.scene.reverse_after
        if due is None or self.history.reversal is not None:
            return False
        return len(self.history.records) + 1 == due and any(arrival.link[1] >= 0 for arrival in chosen)

    def _time_limit(self) -> tuple[Quantity | None, bool] | None:
        """The next time that instants must come before or fall on, and whether it is that of the reversal."""
        until = self.limits.until
        flipped = self.history.reversal is not None
        flip = None if flipped else self.scene.reverse_at
        if flip is not None and (until is None or flip <= until):
            return flip, True
        if self.limits.to_return and flipped:
            return None, False
        return None if until is None else (until, False)

    def _bounds(self, time: Quantity | None) -> tuple[float, float]:
        """Doubles that enclose a set time (None: the return)."""
        if time is None:
            return self.decider.limit_bounds(None)
        if time not in self._known_bounds:
            self._known_bounds[time] = self.decider.limit_bounds(time)
        return self._known_bounds[time]

    def _place(self, arrival: Arrival, time: Quantity | None) -> int:
        """Whether an arrival comes before (negative), at (zero) or after (positive) a set time (None: the return)."""
        low, high = self._bounds(time)
        if arrival.low > high:
            return 1
        if arrival.high < low:
            return -1
        return self.decider.ask(BeforeTime(Moment(arrival.link, arrival.graze), time))

    def _horizon_stop(self) -> Stop:
        if self.limits.to_return:
            return Stop(StopReason.HORIZON, "back at twice the time of the reversal")
        return Stop(StopReason.HORIZON, f"{StopReason.HORIZON.value} {self.limits.until}")

    def _report(self) -> None:
        if self.progress is not None and clock.monotonic() >= self._next_report:
            self._next_report = clock.monotonic() + PROGRESS_EVERY
            last = self.history.last
            reached = 0.0 if last is None else self.decider.rough(last.time)
            self.progress(Progress(len(self.history.records), reached, self.decider.note()))
