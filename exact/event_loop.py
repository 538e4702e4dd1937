"""Predict, advance, bounce, repeat: the event-driven loop, written once for every number system.

1. Every pair's next hit is predicted from the states as they are, and put in a queue.
2. The earliest candidates are taken off; those whose bodies have met since are stale and dropped. If several
   may be first, the numbers decide which, or that they coincide.
3. The bodies that take part, and no others, are advanced to the instant.
4. Their contacts get impulses, in rounds, by the tie policy, until none approaches.
5. Their next hits are predicted; on to 2.

What a number system decides, and what it does when it cannot, is the subclass's part.
"""

from __future__ import annotations

import time as clock
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass, field
from heapq import heappop, heappush
from math import inf, nextafter
from typing import Any, NamedTuple

from ..scenarios.quantity import Quantity
from ..scenarios.scene import Scene
from ..scenarios.trajectory import OnProgress, Progress, Stop, StopReason, Tie
from .contacts import Instant, Touching, components, settle_contacts
from .formulas import (
    advance,
    pair_approach,
    pair_discriminant,
    pair_gap,
    pair_hit_time,
    wall_approach,
    wall_gap,
    wall_hit_time,
)
from .machine import Body, Flip, Go, Kick, Link, Machine, Number, Step, Take
from .policies import Policy, policy_for
from .questions import BeforeTime, Coupling, Question, RelativeSpeed
from .undecided import BudgetSpent, Undecided

PROGRESS_EVERY = 0.2
"""Seconds between progress reports."""

MAX_ROUNDS = 10_000
"""Rounds of impulses at one instant before the run gives up: a cradle of n balls needs about n of them."""

ROUNDED_DOWN = 1 - 2.0**-50
"""Makes a quotient of doubles a lower bound: its rounding, 2**-53, is less."""


class Candidate(NamedTuple):
    """A predicted hit: doubles that enclose its time, and what it rests on.

    `time` None marks a hit that may not happen at all: `low` then bounds its time from below.
    """

    low: float
    order: int
    high: float
    time: Number
    link: Link
    serials: tuple[int, int]


@dataclass
class Record:
    """One instant as the loop notes it, by index."""

    time: Number
    step: int
    source: int
    links: tuple[Link, ...]
    impulses: tuple[Link, ...]
    ties: tuple[Tie, ...]
    coupled: bool


@dataclass
class Limits:
    """Where a run ends."""

    until: Quantity | None
    events: int | None
    to_return: bool = False


class Pocketing(NamedTuple):
    """The centre of a circle enters a pocket, at a time, after so many steps of the log."""

    circle: int
    pocket: int
    time: Number
    step: int


@dataclass
class History:
    """What a loop has gathered."""

    records: list[Record] = field(default_factory=list)
    knots: list[list[tuple[Any, ...]]] = field(default_factory=list)
    reversal: tuple[int, Number, int] | None = None
    steps: list[Step] = field(default_factory=list)
    pocketings: list[Pocketing] = field(default_factory=list)
    plan: Counter[str] = field(default_factory=Counter)


class EventLoop(ABC):
    """The loop over one scene; `machine` is the live state."""

    def __init__(
        self,
        scene: Scene,
        machine: Machine,
        limits: Limits,
        progress: OnProgress | None,
        policy: Policy | None = None,
    ) -> None:
        self.scene = scene
        self.machine = machine
        self.limits = limits
        self.progress = progress
        self.n = machine.n
        self.bodies: list[Body] = list(machine.bodies)[: self.n]
        self.pockets = range(len(scene.pockets))
        self.walls = range(len(scene.walls))
        self.queue: list[Candidate] = []
        self.order = 0
        self.policy = policy or policy_for(scene.tie_policy)
        self.touching = Touching(self.n)
        self.just_parted: tuple[Link, ...] = ()
        self.history = History(knots=[[] for _ in self.bodies])
        self.plan = self.history.plan
        self.flipped = False
        self.gone: set[int] = set()
        self._found: list[tuple[Link, Tie]] = []
        self._next_report = clock.monotonic() + PROGRESS_EVERY

    # -- what a number system supplies

    quick_zero: Number
    quick_root: Callable[[Number], Number]

    @abstractmethod
    def refresh(self, bodies: Iterable[Body]) -> None:
        """Sets each body's `q`: the numbers (x, y, vx, vy, t) that predictions use."""

    @abstractmethod
    def to_predict(self) -> None:
        """Prepares for predictions, in numbers of which `quick_zero` and `quick_root` are."""

    @abstractmethod
    def bounds(self, time: Number) -> tuple[float, float]:
        """Doubles at or below, and at or above, every value of a time."""

    @abstractmethod
    def unsure(self, link: Link) -> None:
        """Deals with a prediction whose signs were not all certain."""

    @abstractmethod
    def earliest(self, rivals: list[Candidate]) -> tuple[list[Candidate], list[Candidate], list[Tie]]:
        """Splits candidates that may be first into those that are, together, and the rest; tells how it knows."""

    @abstractmethod
    def ask(self, question: Question) -> int:
        """The sign of a question.

        Raises:
            Undecided: if the number system cannot tell.
        """

    def ask_cheaply(self, question: Question) -> int | None:
        """The sign of a question if it is to be had at once, else None."""
        try:
            return self.ask(question)
        except Undecided:
            return None

    @abstractmethod
    def quick_reach(self, a: Body, b: Body) -> Number:
        """The sum of radii as predictions use it."""

    @abstractmethod
    def knot(self, body: Body) -> tuple[Any, ...]:
        """(t, x, y, vx, vy) of a body as the history keeps them."""

    def now(self, body: Body) -> Number:
        """The instant of a body's last contact, as the history keeps it."""
        return body.instant

    def pocket(self, k: int) -> Body:
        """A pocket as a body at rest, ready for predictions."""
        body = self.machine.bodies[-1 - k]
        if not body.q:
            self.refresh((body,))
            self.to_predict()
        return body

    def quick_line(self, body: Body, wall: int) -> tuple[Number, Number, Number, Number, Number]:
        """(x0, y0, nx, ny, r*|n|) of a wall as seen from a body, as predictions use them."""
        line = self.machine.line(body, wall)
        return line.x0, line.y0, line.nx, line.ny, body.r * line.length

    # -- the loop

    def run(self) -> Stop:
        """Runs to the end and says why it ended."""
        try:
            self._open()
            while True:
                stop = self._limit_on_events() or self._maybe_flip()
                if stop is not None:
                    return stop
                found = self._next()
                if isinstance(found, Stop):
                    return found
                if found is not None:
                    self._collide(*found)
                self._report()
        except Undecided as outcome:
            return Stop(StopReason.UNDECIDED, f"{StopReason.UNDECIDED.value}: {outcome}")
        except BudgetSpent as outcome:
            return Stop(StopReason.BUDGET, f"{StopReason.BUDGET.value}: {outcome}")

    def do(self, step: Step) -> None:
        """Carries out a step and logs it."""
        self.history.steps.append(step)
        self.machine.do(step)

    def _open(self) -> None:
        """Knots and contacts at time 0, first predictions, and whatever collides at once."""
        self.refresh(self.bodies)
        for body in self.bodies:
            self.history.knots[body.index].append(self.knot(body))
        links = self._touching_at_start()
        self.predict(self.bodies)
        if links:
            self._instant(links, [], None)

    def _touching_at_start(self) -> list[Link]:
        """The contacts of the scene itself, decided on the exact scene whatever the engine's numbers."""
        from .start import touching_at_start

        return touching_at_start(self.scene)

    def _limit_on_events(self) -> Stop | None:
        events = self.limits.events
        if events is None or len(self.history.records) < events:
            return None
        return Stop(StopReason.EVENTS, f"{StopReason.EVENTS.value} ({events})")

    def _report(self) -> None:
        if self.progress is not None and clock.monotonic() >= self._next_report:
            self._next_report = clock.monotonic() + PROGRESS_EVERY
            records = self.history.records
            reached = self.bounds(records[-1].time)[0] if records else 0.0
            self.progress(Progress(len(records), reached, self.note()))

    def note(self) -> str:
        """What progress says beside the counts."""
        return ""

    def _fresh(self, candidate: Candidate) -> bool:
        i, j = candidate.link
        if self.bodies[i].serial != candidate.serials[0]:
            return False
        return not 0 <= j < self.n or self.bodies[j].serial == candidate.serials[1]

    def _next(self) -> tuple[list[Candidate], list[Tie]] | Stop | None:
        """The next instant's candidates, a reason to stop, or None after a flip at a set time."""
        queue = self.queue
        while queue and not self._fresh(queue[0]):
            heappop(queue)
        chosen: list[Candidate] = []
        ties: list[Tie] = []
        if queue:
            first = heappop(queue)
            rivals = [first]
            bar = first.high if first.time is not None else inf
            while queue and queue[0].low <= bar:
                other = heappop(queue)
                if self._fresh(other):
                    rivals.append(other)
                    if other.time is not None and other.high < bar:
                        bar = other.high
            if len(rivals) == 1 and first.time is not None:
                chosen = rivals
            else:
                chosen, rest, ties = self._first_of(rivals)
                for candidate in rest:
                    heappush(queue, candidate)
                if not chosen:
                    return None
        limit = self._time_limit()
        if limit is not None and (not chosen or self._beyond(chosen[0], limit[0])):
            for candidate in chosen:
                heappush(queue, candidate)
            if limit[1]:
                self._flip(limit[0])
                return None
            return self._horizon_stop()
        if not chosen:
            return Stop(StopReason.QUIET, StopReason.QUIET.value)
        return chosen, ties

    def _first_of(self, rivals: list[Candidate]) -> tuple[list[Candidate], list[Candidate], list[Tie]]:
        """As `earliest`; an entry into a pocket need only be compared with what its own circle does.

        For it changes nothing for others. If it coincides with a contact of its circle, the contact comes first.
        """
        contacts = [c for c in rivals if c.link[1] >= 0]
        for entry in (c for c in rivals if c.link[1] < 0):
            circle = entry.link[0]
            own = [c for c in rivals if circle in c.link]
            chosen, _, _ = self.earliest(own)
            if [c.link for c in chosen] == [entry.link]:
                return chosen, [c for c in rivals if c.link != entry.link], []
            if not chosen:
                return [], [c for c in rivals if c not in own], []
        chosen, rest, ties = self.earliest(contacts)
        return chosen, rest + [c for c in rivals if c.link[1] < 0], ties

    def _horizon_stop(self) -> Stop:
        if self.limits.to_return:
            return Stop(StopReason.HORIZON, "back at twice the time of the reversal")
        return Stop(StopReason.HORIZON, f"{StopReason.HORIZON.value} {self.limits.until}")

    def _time_limit(self) -> tuple[Quantity | None, bool] | None:
        """The next time that events must come before, and whether it is that of a flip."""
        until = self.limits.until
        flip = None if self.flipped else self.scene.reverse_at
        if flip is not None and (until is None or flip <= until):
            return flip, True
        if self.limits.to_return and self.flipped:
            return None, False
        return None if until is None else (until, False)

    def _beyond(self, candidate: Candidate, time: Quantity | None) -> bool:
        """Whether a hit comes after a time; one exactly at it does not."""
        low, high = self.limit_bounds(time)
        if candidate.low > high:
            return True
        if candidate.high < low:
            return False
        return self.ask(BeforeTime(candidate.link, time)) > 0

    def limit_bounds(self, time: Quantity | None) -> tuple[float, float]:
        """Doubles that enclose a limit (None: the return)."""
        if time is None:
            twice = self.machine.flip_time + self.machine.flip_time
            return self.bounds(twice)
        return self.bounds(self.machine.constant(time))

    # -- reversal

    def _maybe_flip(self) -> Stop | None:
        after = self.scene.reverse_after
        if after is not None and not self.flipped and len(self.history.records) >= after:
            self._flip(None)
        return None

    def _flip(self, time: Quantity | None) -> None:
        """Negates every velocity: at a set time, or (None) at the instant just done."""
        last = self.history.records[-1] if self.history.records else None
        source: int | Quantity = last.source if time is None and last is not None else time or Quantity.of(0)
        parted = self.just_parted
        if time is not None and parted and last is not None:
            self.prepare()
            if not self._happened_at(time):
                parted = ()
        self.prepare()
        self.do(Go(source, tuple(range(self.n))))
        self.do(Flip())
        self.flipped = True
        self.history.reversal = (len(self.history.records), self.machine.flip_time, len(self.history.steps))
        for body in self.bodies:
            body.serial += 1
        self.queue.clear()
        self.refresh(self.bodies)
        for body in self.bodies:
            self.history.knots[body.index].append(self.knot(body))
        touching = sorted({*self.touching.all(), *parted})
        self.predict(self.bodies, frozenset(touching))
        touching = sorted({*touching, *(link for link, _ in self._found)})
        self._found = []
        if touching:
            self._instant(touching, [], None)

    def _happened_at(self, time: Quantity) -> bool:
        """Whether the last instant fell exactly on a set time."""
        from .questions import ClockAt

        return self.ask(ClockAt(self.history.records[-1].source, time)) == 0

    def prepare(self) -> None:
        """Called before steps are carried out."""
        return

    def exact_state(self, bodies: Sequence[int]) -> Hashable | None:
        """A key of the bodies' exact states, equal only for equal states; None where none is at hand."""
        return None

    def order_chosen(self) -> None:
        """Called when a tie policy has chosen an order among contacts."""
        return

    # -- one instant

    def _collide(self, chosen: list[Candidate], ties: list[Tie]) -> None:
        self.prepare()
        if chosen[0].link[1] < 0:
            self._enter(chosen[0].link)
            return
        if len(chosen) == 1 and not self.touching:
            self._bounce(chosen[0].link)
        else:
            self._instant([c.link for c in chosen], ties, chosen[0].link)

    def _enter(self, link: Link) -> None:
        """A centre enters a pocket: noted, and the circle taken out of play if the scene says so."""
        i, j = link
        body = self.bodies[i]
        pocketing = Pocketing(i, -1 - j, self.entry_time(link), len(self.history.steps))
        self.history.pocketings.append(pocketing)
        if not self.scene.capture:
            return
        self.do(Go(link, (i,)))
        self.do(Take(i))
        self.gone.add(i)
        for contact in self.touching.all():
            if i in contact:
                self.touching.discard(contact)
        body.serial += 1
        self.refresh((body,))
        self.history.knots[i].append(self.knot(body))

    def entry_time(self, link: Link) -> Number:
        """The time of an entry, as the history keeps times."""
        clock_then, wait = self.machine.hit(link)
        return clock_then + wait

    def _bounce(self, link: Link) -> None:
        """The common case: one contact, no other touching."""
        i, j = link
        a = self.bodies[i]
        moved = (a, self.bodies[j]) if j < self.n else (a,)
        self.do(Go(link, link if j < self.n else (i,)))
        self.do(Kick((link,)))
        self.history.records.append(
            Record(self.now(a), len(self.history.steps), i, (link,), (link,), (), coupled=False)
        )
        self.policy.note(link)
        self.just_parted = (link,)
        self._resume(moved, frozenset(self.just_parted))

    def _instant(self, links: Sequence[Link], ties: list[Tie], source: Link | None) -> None:
        """Several contacts at one instant; without a source, at the instant where the bodies already stand."""
        impulses: list[Link] = []
        taking_part: set[Link] = set()
        parted: list[Link] = []
        coupled = False
        stands: int | None = None
        self.touching.add_all(links if source is None else ())
        for component in components(links, self.touching, self.n):
            if source is not None:
                genuine = min(link for link in component.links if link in links)
                self.do(Go(genuine, component.bodies))
            instant = settle_contacts(
                component.links,
                frozenset(links) if source is not None else frozenset(),
                self.policy,
                self.ask,
                lambda chosen: self.do(Kick(chosen)),
                MAX_ROUNDS,
                self.order_chosen,
            )
            impulses += instant.impulses
            if instant.impulses:
                taking_part |= instant.taking_part
                coupled = coupled or self._coupled(instant)
                stands = component.bodies[0]
            parted += self._part(component.links, instant)
            if len(instant.impulses) > 1:
                if self.policy.chooses_order:
                    self.order_chosen()
                bodies = component.bodies
                self.policy.instant_done(lambda bodies=bodies: self.exact_state(bodies))
        if stands is None:
            return
        time = self.now(self.bodies[stands])
        self.history.records.append(
            Record(
                time,
                len(self.history.steps),
                stands,
                tuple(sorted(taking_part)),
                tuple(impulses),
                tuple(ties),
                coupled,
            )
        )
        self.just_parted = tuple(parted)
        changed = sorted({i for link in impulses for i in link if i < self.n})
        self._resume([self.bodies[i] for i in changed], frozenset(parted) | self.touching.all())

    def _coupled(self, instant: Instant) -> bool:
        """Whether the order of an instant's impulses could matter; where that is not known, it could."""
        links = sorted(instant.taking_part)
        return any(
            self.ask_cheaply(Coupling(first, second)) != 0
            for k, second in enumerate(links)
            for first in links[:k]
            if self._share_a_mover(first, second)
        )

    def _share_a_mover(self, first: Link, second: Link) -> bool:
        shared = set(first) & set(second)
        return any(i < self.n and not self.scene.circles[i].fixed for i in shared)

    def _part(self, links: Iterable[Link], instant: Instant) -> list[Link]:
        """Keeps the contacts that last, drops the others, and lists all that stand at gap zero now."""
        for link in links:
            sign = instant.signs[link]
            stays = sign == 0 and (link[1] >= self.n or self.ask(RelativeSpeed(link)) == 0)
            if stays:
                self.touching.add(link)
            else:
                self.touching.discard(link)
        return list(links)

    def _resume(self, moved: Sequence[Body], parted: frozenset[Link]) -> None:
        """New serials, knots and predictions for the bodies whose velocities changed."""
        knots = self.history.knots
        for body in moved:
            body.serial += 1
        self.refresh(moved)
        for body in moved:
            knots[body.index].append(self.knot(body))
        self.predict(moved, parted)
        if self._found:
            self._join_instant(parted)

    def found_touching(self, link: Link, tie: Tie) -> None:
        """Notes a contact that has come to gap zero just as one of its circles was hit: it belongs to that instant."""
        self._found.append((link, tie))

    def _join_instant(self, parted: frozenset[Link]) -> None:
        """Carries the rounds of the last instant on through contacts found to touch at it."""
        found, self._found = self._found, []
        links = [link for link, _ in found]
        record = self.history.records[-1]
        self.touching.add_all(links)
        self.touching.add_all(parted)
        self.prepare()
        changed: set[int] = set()
        standing: list[Link] = []
        for component in components(links, self.touching, self.n):
            self.do(Go(record.source, component.bodies))
            instant = settle_contacts(
                component.links,
                frozenset(),
                self.policy,
                self.ask,
                lambda chosen: self.do(Kick(chosen)),
                MAX_ROUNDS,
                self.order_chosen,
            )
            standing += self._part(component.links, instant)
            if instant.impulses:
                record.links = tuple(sorted({*record.links, *instant.taking_part}))
                record.impulses = (*record.impulses, *instant.impulses)
                record.coupled = True
                record.step = len(self.history.steps)
                changed |= {i for link in instant.impulses for i in link if i < self.n}
        record.ties = (*record.ties, *(tie for _, tie in found))
        parted = parted | frozenset(standing)
        self.just_parted = tuple(sorted(parted))
        self._resume([self.bodies[i] for i in sorted(changed)], parted)

    # -- predictions

    def predict(self, moved: Sequence[Body], parted: frozenset[Link] | None = None) -> None:
        """Queues the next hit of each of these bodies with every other body and wall.

        `parted` are contacts at gap zero that do not approach: nothing to predict there until a velocity changes.
        """
        if parted is None:
            parted = self.touching.all() | frozenset(self._touching_at_start())
        bodies, plan, gone = self.bodies, self.plan, self.gone
        self.to_predict()
        done: set[int] = set()
        for a in moved:
            skipped = 0
            if a.index in gone:
                continue
            for b in bodies:
                if b is a or b.index in done or b.index in gone:
                    continue
                if b.rest and a.rest:
                    skipped += 1
                else:
                    self.predict_pair(a, b, parted)
            done.add(a.index)
            plan["pairs predicted"] += len(bodies) - len(done) - skipped
            plan["pairs at rest skipped"] += skipped
            if not a.rest:
                plan["walls predicted"] += len(self.walls)
                for wall in self.walls:
                    self.predict_wall(a, wall, parted)
                for k in self.pockets:
                    self.predict_pair(a, self.pocket(k), parted)

    def predict_pair(self, a: Body, b: Body, parted: frozenset[Link]) -> None:
        """Queues the next hit of a, which has just moved, with b."""
        ax, ay, avx, avy, at = a.q
        bx, by, bvx, bvy, bt = b.q
        if b.rest:
            dx, dy, vx, vy = bx - ax, by - ay, -avx, -avy
        else:
            if bt is at:
                dx, dy = bx - ax, by - ay
            else:
                lag = at - bt
                dx, dy = advance(bx, bvx, lag) - ax, advance(by, bvy, lag) - ay
            vx, vy = bvx - avx, bvy - avy
        zero = self.quick_zero
        approach = pair_approach(dx, dy, vx, vy)
        if approach >= zero:
            return
        link = (b.index, a.index) if 0 <= b.index < a.index else (a.index, b.index)
        if link in parted:
            return
        reach = self.quick_reach(a, b)
        disc = pair_discriminant(dx, dy, vx, vy, reach)
        if disc < zero:
            return
        gap = pair_gap(dx, dy, reach)
        if disc > zero and approach < zero and gap > zero:
            self.push(at + pair_hit_time(gap, approach, self.quick_root(disc)), link)
        else:
            self.unsure(link)
            self.to_predict()

    def predict_wall(self, a: Body, wall: int, parted: frozenset[Link]) -> None:
        """Queues the next hit of a, which has just moved, with a wall."""
        x0, y0, nx, ny, offset = self.quick_line(a, wall)
        ax, ay, avx, avy, at = a.q
        approach = wall_approach(avx, avy, nx, ny)
        if approach >= self.quick_zero:
            return
        link = (a.index, self.n + wall)
        if link in parted:
            return
        gap = wall_gap(ax, ay, x0, y0, nx, ny, offset)
        if approach < self.quick_zero and gap > self.quick_zero:
            self.push(at + wall_hit_time(gap, approach), link)
        else:
            self.unsure(link)
            self.to_predict()

    def earliest_possible(self, link: Link) -> float:
        """A double before which a doubtful hit cannot come: the gap over the greatest closing speed; inf: never."""
        machine = self.machine
        if link[1] < self.n:
            t, dx, dy, vx, vy, reach = machine.relation(*link)
            distance = machine.root(dx * dx + dy * dy)
            speed = machine.root(vx * vx + vy * vy)
            gap = machine.gap(link) / (distance + reach)
        else:
            t, gap, speed = machine.bodies[link[0]].t, machine.gap(link), -machine.approach(link)
        least_gap, top_speed = self.bounds(gap)[0], self.bounds(speed)[1]
        if top_speed <= 0.0:
            return inf
        if not least_gap > 0.0:
            return -inf
        wait = least_gap / top_speed * ROUNDED_DOWN
        return nextafter(self.bounds(t)[0] + wait, -inf)

    def push(self, time: Number, link: Link) -> None:
        """Queues a hit that is certain to come if nothing else does first."""
        low, high = self.bounds(time)
        self._queue(low, high, time, link)

    def push_doubtful(self, low: float, link: Link) -> None:
        """Queues a hit that may not come at all, to be settled when its turn comes."""
        self._queue(low, inf, None, link)

    def _queue(self, low: float, high: float, time: Number, link: Link) -> None:
        i, j = link
        serials = (self.bodies[i].serial, self.bodies[j].serial if 0 <= j < self.n else 0)
        self.order += 1
        heappush(self.queue, Candidate(low, self.order, high, time, link, serials))
