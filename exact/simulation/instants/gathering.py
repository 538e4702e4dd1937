"""Gathers all that falls on the next instant.

The arrivals that may be first are taken off the queue; what may not come is settled; the numbers decide which is
first, and which fall on the same instant. A limit in time counts as one of them.
"""

from __future__ import annotations

from math import inf
from typing import Generic

from ....scenarios.numbers.quantity import Quantity
from ....scenarios.scene import Scene
from ....scenarios.trajectory import Stop, StopReason, Tie
from ...numbers.system import N
from ...predicates.hits import BeforeTime, Moment
from ...predicates.question import Decision
from ...replay.contact import AtWall, Entry, Pair, Touch, contact_of, scene_order
from ..arrivals.queue import Arrival
from ..decider import Decider
from ..history import K
from ..limits import Limits
from .instant import Instant
from .rounds import Lasting


class Gatherer(Generic[N, K]):
    """Gathers the instants of one run.

    Args:
        scene: what runs.
        decider: decides.
        limits: where the run ends.
        touching: the contacts that last.
    """

    def __init__(self, scene: Scene, decider: Decider[N, K], limits: Limits, touching: Lasting) -> None:
        self.scene = scene
        self.decider = decider
        self.limits = limits
        self.history = decider.history
        self.queue = decider.queue
        self._meetings = decider.meetings
        self._touching = touching
        self._last = 0
        self._passed: list[Arrival[N]] = []
        self._known_bounds: dict[Quantity, tuple[float, float]] = {}

    def forget(self) -> None:
        """Drops every arrival: all flights are new."""
        self.queue.clear()
        self._passed.clear()

    def clear_until(self) -> float:
        """A double before which no limit in time lies: infinite where there is none."""
        limit = self._time_limit()
        return inf if limit is None else self._bounds(limit[0])[0]

    def gather(self, last: int) -> Instant | Stop | None:
        """All that falls on the next instant; a reason to stop; or None after a graze that touched nothing else.

        Args:
            last: the number of the instant before.
        """
        self._last = last
        limit = self._time_limit()
        low, high = (inf, inf) if limit is None else self._bounds(limit[0])
        rivals = self._rivals(high)
        grazes = [rival for rival in rivals if rival.graze]
        chosen, ties = self._first([rival for rival in rivals if not rival.graze] if grazes else rivals)
        if grazes and not chosen:
            self._pass(grazes)
            return None
        if grazes:
            grazes = self._still_to_come(grazes, chosen[0])
        place = self._place(chosen[0], limit[0]) if limit is not None and chosen else 1
        if limit is not None and place > 0:
            for arrival in (*chosen, *grazes):
                self.queue.put_back(arrival)
            if not limit[1]:
                if self.limits.to_return:
                    return Stop(StopReason.HORIZON, "back at twice the time of the reversal")
                return Stop(StopReason.HORIZON, f"{StopReason.HORIZON.value} {self.limits.until}")
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
            self.history.set_times[time] = self._last + 3
        return time

    def _rivals(self, limit: float) -> list[Arrival[N]]:
        """All arrivals that may be first and not after a limit, each certain to come if nothing else does."""
        while True:
            found = self.queue.rivals()
            rivals = [rival for rival in found if rival.low <= limit]
            if len(rivals) < len(found):
                for rival in found:
                    if rival.low > limit:
                        self.queue.put_back(rival)
            if all(rival.certain for rival in rivals):
                return rivals
            for rival in rivals:
                settled = rival if rival.certain else self._meetings.settled(rival)
                if settled is not None:
                    self.queue.put_back(settled)

    def _first(self, rivals: list[Arrival[N]]) -> tuple[list[Arrival[N]], list[Tie]]:
        """Those that come first, together; the others go back to the queue."""
        if len(rivals) < 2:
            return rivals, []
        meetings = self._meetings
        timed = [meetings.timed(rival) for rival in rivals]
        front: list[Arrival[N]] = []
        for rival in timed:
            if any(meetings.certainly_before(other, rival) for other in timed):
                self.queue.put_back(rival)
            else:
                front.append(rival)
        front.sort(key=lambda rival: (not rival.link.pushes, scene_order(rival.link)))  # whatever the queue's order
        chosen, ties = front[:1], []
        for rival in front[1:]:
            first = chosen[0]
            decision = meetings.order(rival, first)
            if decision.sign > 0:
                self.queue.put_back(rival)
            elif decision.sign == 0:
                if rival.link.pushes:
                    ties.append(self._tie(first, rival, decision))
                chosen.append(rival)
            else:
                for other in chosen:
                    self.queue.put_back(other)
                chosen, ties = [rival], []
        return chosen, ties

    def _instant(
        self, chosen: list[Arrival[N]], touches: list[Arrival[N]], ties: list[Tie], moment: Quantity | None
    ) -> Instant:
        first = chosen[0].link if chosen else None
        if len(chosen) == 1 and not touches and moment is None and isinstance(first, (Pair, AtWall)):
            return Instant(self._last + 2, hits=(first,), clock=first)
        entries = _entries(chosen)
        return Instant(
            self._last + 2,
            hits=tuple(_touches(chosen)),
            touches=dict.fromkeys(_touches(touches), 0),
            arrivals=tuple(entries),
            rims=frozenset([*entries, *_entries(touches)]),
            ties=tuple(ties),
            clock=first,
            reversal=moment is not None,
            moment=moment,
        )

    # -- grazes

    def _grazes_at(
        self, chosen: list[Arrival[N]], grazes: list[Arrival[N]], ties: list[Tie], everywhere: bool
    ) -> list[Arrival[N]]:
        """The grazes that fall on the instant of others and can take part in it.

        Those are the ones that its contacts reach through shared circles; if velocities are to be negated at it,
        all of them.
        """
        if not grazes and not everywhere:
            return []
        reached = self._reached({i for a in chosen for i in a.link.circles})
        found: list[Arrival[N]] = []
        waiting = self._overlapping(chosen[0], grazes) if everywhere else grazes
        progress = True
        while progress:
            progress = False
            for graze in list(waiting):
                if not everywhere and reached.isdisjoint(graze.link.circles):
                    continue
                waiting.remove(graze)
                decision = self._graze_place(graze, chosen[0])
                if decision.sign == 0:
                    if graze.link.pushes and chosen[0].link.pushes:
                        ties.append(self._tie(graze, chosen[0], decision))
                    found.append(graze)
                    reached = self._reached(reached.union(graze.link.circles))
                    progress = True
                elif decision.sign < 0:
                    self._passed.append(graze)
                else:
                    self.queue.put_back(graze)
        for graze in waiting:
            self.queue.put_back(graze)
        return found

    def _graze_place(self, graze: Arrival[N], other: Arrival[N]) -> Decision:
        meetings = self._meetings
        timed, first = meetings.timed(graze), meetings.timed(other)
        if meetings.certainly_before(timed, first):
            return Decision(-1, "times")
        if meetings.certainly_before(first, timed):
            return Decision(1, "times")
        return meetings.order(timed, first)

    def _tie(self, first: Arrival[N], second: Arrival[N], decision: Decision) -> Tie:
        contacts = [contact_of(self.scene, a.link) for a in (first, second) if not isinstance(a.link, Entry)]
        return Tie(tuple(contacts), decision.proof, decision.bound)

    def _reached(self, bodies: set[int]) -> set[int]:
        """The circles that contacts of some circles reach through lasting contacts."""
        reached = set(bodies)
        lasting = self._touching.all()
        grown = bool(lasting)
        while grown:
            more = {i for link in lasting if not reached.isdisjoint(link.circles) for i in link.circles}
            grown = not more <= reached
            reached |= more
        return reached

    def _pass(self, grazes: list[Arrival[N]]) -> None:
        """Drops grazes where nothing else comes, which touch nothing that moves otherwise, and change nothing.

        Those are the first, and all before more arrivals may be made.
        """
        first, more = min(grazes, key=lambda graze: graze.high), self.queue.crossings.next_crossing
        for graze in grazes:
            if graze is first or graze.high < more:
                self._passed.append(graze)
            else:
                self.queue.put_back(graze)

    def _still_to_come(self, grazes: list[Arrival[N]], first: Arrival[N]) -> list[Arrival[N]]:
        """Drops the grazes that surely come before all else, as `_pass` does; the others."""
        meetings = self._meetings
        first, later = meetings.timed(first), list[Arrival[N]]()
        for graze in grazes:
            past = graze.high < first.low or meetings.certainly_before(meetings.timed(graze), first)
            (self._passed if past else later).append(graze)
        return later

    def _overlapping(self, arrival: Arrival[N], grazes: list[Arrival[N]]) -> list[Arrival[N]]:
        self._passed = [graze for graze in self._passed if self.queue.fresh(graze)]
        near = [g for g in self._passed if g.low <= arrival.high and g.high >= arrival.low]
        return [*grazes, *near]

    # -- limits

    def _reverses_after(self, chosen: list[Arrival[N]]) -> bool:
        due = self.scene.reverse_after
        if due is None or self.history.reversal is not None:
            return False
        return len(self.history.records) + 1 == due and any(arrival.link.pushes for arrival in chosen)

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
            return self.decider.reading.limit_bounds(None)
        if time not in self._known_bounds:
            self._known_bounds[time] = self.decider.reading.limit_bounds(time)
        return self._known_bounds[time]

    def _place(self, arrival: Arrival[N], time: Quantity | None) -> int:
        """Whether an arrival comes before (negative), at (zero) or after (positive) a set time (None: the return)."""
        low, high = self._bounds(time)
        if arrival.low > high:
            return 1
        if arrival.high < low:
            return -1
        return self.decider.ask(BeforeTime(Moment(arrival.link, arrival.graze), time))


def _touches(arrivals: list[Arrival[N]]) -> list[Touch]:
    """Those of the contacts through which an impulse can pass, in scene order."""
    return sorted([a.link for a in arrivals if not isinstance(a.link, Entry)], key=scene_order)


def _entries(arrivals: list[Arrival[N]]) -> list[Entry]:
    """The entries among the contacts."""
    return [a.link for a in arrivals if isinstance(a.link, Entry)]
