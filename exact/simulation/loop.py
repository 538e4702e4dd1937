"""Predict, gather the next instant, resolve it, repeat: the event-driven loop, written once for every number system.

1. Every pair's next meeting is predicted from the flights as they are, and put in a queue.
2. What falls on the next instant is gathered (`Gatherer`): what comes first, all that comes with it, and a limit.
3. The whole instant is resolved (`Resolver`), and only then noted.
4. The next meetings of the circles whose flights changed are predicted; on to 2.

A run that has to stop within an instant, because a sign is not to be had or the user interrupts it, ends at the last
whole one.
"""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Collection, Iterable, Sequence
from math import inf
from typing import Generic

from ...scenarios.errors import TimeIsUp, endable
from ...scenarios.scene import Scene
from ...scenarios.trajectory import OnProgress, Progress, Stop, StopReason
from ..numbers.system import N
from ..numbers.undecided import BudgetSpent, Undecided
from ..policies import Policy, policy_for
from ..predicates.hits import Closing
from ..replay.body import Body
from ..replay.contact import Link, Touch
from .arrivals.initial import rims_at_start, touching_at_start
from .decider import Decider, Ordinary
from .history import K
from .instants.gathering import Gatherer
from .instants.instant import Instant, Resolved, Resolver
from .limits import Limits
from .tape import Found, Tape, instant_of

PROGRESS_EVERY = 0.2
"""Seconds between progress reports."""

EVENTS_A_LOOK = 64
"""Events between looks at the clock, at most."""


class Loop(Generic[N, K]):
    """The loop over one scene.

    Args:
        scene: what runs.
        decider: keeps its state in some numbers, and decides.
        limits: where it ends.
        progress: told now and then how far it is.
        policy: in place of the scene's own.

    Attributes:
        tape: what a run needs that goes on from this one.
    """

    def __init__(
        self,
        scene: Scene,
        decider: Decider[N, K],
        limits: Limits,
        progress: OnProgress | None,
        policy: Policy | None = None,
    ) -> None:
        self.scene = scene
        self.decider = decider
        self.limits = limits
        self.progress = progress
        self.history = decider.history
        self.resolver = Resolver(scene, decider, policy or policy_for(scene.tie_policy))
        self.gatherer = Gatherer(scene, decider, limits, self.resolver.touching)
        self.tape = Tape(limits)
        self._instants = 0
        self._split = False
        self._next_report = clock.monotonic() + PROGRESS_EVERY

    def run(self) -> Stop:
        """Runs to the end and says why it ended."""
        taken_up = bool(self.history.knots)
        if not taken_up:
            self._first_knots()
        ended = self._run(taken_up)
        if isinstance(ended, Stop):
            return ended
        self.history.drop_unfinished()
        reason, told = ended
        return stopped(reason, len(self.history.records), told)

    def _run(self, taken_up: bool) -> Stop | tuple[StopReason, str]:
        """Runs to the end; where it is cut short, gives why. Alarms rise only below this."""
        try:
            with endable():
                if not taken_up:
                    self._predict(list(self.decider.bodies.values()), self._open())
                while True:
                    self._stride()
                    stop = self._limit_on_events()
                    if stop is not None:
                        return stop
                    self._look()
                    found = self.gatherer.gather(self._instants)
                    if isinstance(found, Stop):
                        return found
                    if found is not None:
                        self.tape.add(found, whole=self._strides() is not None)
                        done = self._resolve(found)
                        if done.moved:
                            self._predict([self.decider.bodies[i] for i in sorted(done.moved)], self._standing(done))
                    self._report()
        except Undecided as outcome:
            return StopReason.UNDECIDED, str(outcome)
        except (BudgetSpent, TimeIsUp) as outcome:
            return StopReason.BUDGET, str(outcome)
        except KeyboardInterrupt:
            return StopReason.INTERRUPTED, ""

    def _stride(self) -> None:
        """Instants of one contact that nothing comes near, as far as the decider carries them out by itself."""
        stride = self._strides()
        if stride is None:
            return
        before = self._instants
        most, until = self._most(), self.gatherer.clear_until()
        self._instants = stride(before, most, until, self._look, self._note_alone)
        if self._instants != before:
            self._split = False
            self._report()

    def _strides(self) -> Ordinary | None:
        """What carries out ordinary instants, where it may."""
        return None if self.scene.pockets or self.resolver.touching else self.decider.stride

    def _look(self) -> None:
        self.tape.mark(self.history)

    def _note_alone(self, link: Touch) -> None:
        self.tape.found.append(link)
        self.resolver.policy.note(link)

    def _most(self) -> float:
        """How many events may come before a limit on them, the reversal, or the next look at the clock."""
        records, due = len(self.history.records), self.scene.reverse_after
        most = inf if self.progress is None else EVENTS_A_LOOK
        if self.limits.events is not None:
            most = min(most, self.limits.events - records)
        if due is not None and self.history.reversal is None:
            most = min(most, due - records - 1)
        return most

    def take_up(self, instants: Iterable[Found], after: Callable[[int], None]) -> None:
        """Carries out again what a run gathered before it ended; then `run` goes on from there.

        Nothing is looked for but what comes next at the end: each meeting is predicted once, as it was at the instant
        at which the later of its two flights began.

        Args:
            instants: those after time 0, in order.
            after: called with the number of each instant that is done.
        """
        self._first_knots()
        begun = dict.fromkeys(self.decider.bodies, 0)
        spent: dict[Link, int] = {}  # entries and grazes leave flights as they are, and come no second time on them
        standing = {0: self._open()}
        after(0)
        for found in instants:
            stride = self._strides()
            if stride is not None and not isinstance(found, Instant):
                number = self._instants = self._instants + 2
                stride.again(found, number, self._note_alone)
                self._split = False
                begun.update(dict.fromkeys(found.circles, number))
                standing[number] = (found,)
                after(number)
                self._report()
                continue
            instant = instant_of(found, self._instants + 2)
            self.tape.add(instant, whole=stride is not None)
            done = self._resolve(instant)
            begun.update(dict.fromkeys(done.moved, instant.number))
            spent.update(dict.fromkeys((*instant.touches, *instant.rims), instant.number))
            standing[instant.number] = self._standing(done)
            after(instant.number)
            self._report()
        for number in sorted(set(begun.values())):
            later = {i for i, other in begun.items() if other > number}
            moved = [body for body in self.decider.bodies.values() if begun[body.index] == number]
            self._predict(moved, {*standing[number], *(k for k, at in spent.items() if at > number)}, later)

    # -- the instants

    def _first_knots(self) -> None:
        bodies = list(self.decider.bodies.values())
        self.decider.refresh(bodies)
        self.history.knots += [[(*self.decider.reading.knot(body), 0, 0)] for body in bodies]

    def _open(self) -> Collection[Link]:
        """The instant at time 0; what stands at gap zero after it."""
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
        return {*links, *rims, *self._standing(done)}

    def _predict(self, moved: Sequence[Body[N]], standing: Collection[Link], besides: Collection[int] = ()) -> None:
        """Predicts the next meetings of circles whose flights are new, with all in play but some."""
        gone = self.resolver.gone
        self.decider.meetings.predict(moved, standing, gone.union(besides) if besides else gone)

    def _standing(self, done: Resolved[K]) -> Collection[Link]:
        """The contacts and rims at gap zero that a prediction must leave out."""
        lasting = self.resolver.touching.all()
        return {*done.standing, *lasting} if lasting else done.standing

    def _resolve(self, instant: Instant) -> Resolved[K]:
        """Resolves an instant and notes it."""
        decider, records = self.decider, len(self.history.records)
        decider.begin(instant.number)
        left = None if self.limits.events is None else self.limits.events - records
        due = self.scene.reverse_after
        reverse_in = None if due is None or self.history.reversal is not None else due - records
        done = self.resolver.resolve(instant, left, reverse_in)
        self._note(instant, done)
        return done

    def _note(self, instant: Instant, done: Resolved[K]) -> None:
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
            self.gatherer.forget()
        history.last = note.last or history.last

    def _limit_on_events(self) -> Stop | None:
        events = self.limits.events
        if events is None or len(self.history.records) < events:
            return None
        left_out = "; the reversal, which falls on the same instant, and what follows it are left out"
        return Stop(StopReason.EVENTS, f"{StopReason.EVENTS.value} ({events}){left_out if self._split else ''}")

    def _report(self) -> None:
        if self.progress is not None and clock.monotonic() >= self._next_report:
            self._next_report = clock.monotonic() + PROGRESS_EVERY
            last = self.history.last
            reached = 0.0 if last is None else self.decider.reading.rough(last.time)
            self.progress(Progress(len(self.history.records), reached, self.decider.reading.note()))


def stopped(reason: StopReason, events: int, told: str = "") -> Stop:
    """Why a run ended before its limits; told nothing, with how many events."""
    return Stop(reason, f"{reason.value}: {told or f'after {events} events'}")
