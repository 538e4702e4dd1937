"""One instant: all that falls on it, gathered before anything acts, and how it is resolved.

The order, for every instant alike:

1. contacts: rounds of impulses by the tie policy, in each set of contacts that hang together, until none approaches;
2. entries: circles whose centres stand on a pocket's rim and move inward, in the state after the contacts;
3. the reversal, if it falls on this instant: every velocity is negated;
4. contacts that the reversal makes approach: rounds, as in 1; then the entries that they and it make, as in 2.

Nothing is kept of an instant before all of it is decided.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Generic

from ....scenarios.numbers.quantity import Quantity
from ....scenarios.scene import Scene
from ....scenarios.trajectory import Tie
from ...numbers.system import N
from ...policies.policy import Policy
from ...predicates.hits import Closing, RelativeSpeed, Rim
from ...predicates.impulses import Coupling
from ...replay.contact import Entry, Link, Pair, Touch, scene_order
from ...replay.steps import Flip, Go, Kick, Take
from ..decider import Decider
from ..history import REVERSAL, Arrived, K, Mark, Noted, Record
from .rounds import Lasting, Rounds, components, settle

MAX_ROUNDS = 10_000
"""Rounds of impulses at one instant before the run gives up: a cradle of n balls needs about n of them."""


@dataclass(slots=True)
class Instant:
    """All that falls on one instant.

    Attributes:
        number: tells instants apart, in order; even; 0 is time 0.
        hits: contacts that arrive approaching.
        touches: contacts at gap zero that do not approach as the instant comes, with the sign of their closing speed:
            grazes (0), and at time 0 those that part (+1).
        arrivals: centres that arrive at a rim moving inward.
        rims: centres known to stand on a rim at it, those of `arrivals` among them.
        ties: how it is known that all this is one instant.
        clock: the meeting whose time it is; None at time 0, and where only a set time makes the instant.
        reversal: whether a reversal at a set time falls on it.
        moment: the set time.
    """

    number: int
    hits: tuple[Touch, ...] = ()
    touches: Mapping[Touch, int] = field(default_factory=dict)
    arrivals: tuple[Entry, ...] = ()
    rims: frozenset[Entry] = frozenset()
    ties: tuple[Tie, ...] = ()
    clock: Link | None = None
    reversal: bool = False
    moment: Quantity | None = None


@dataclass(slots=True)
class Resolved(Generic[K]):
    """What an instant did; or its part before the reversal, or its part after it.

    Attributes:
        number: of the instant; odd for the part after the reversal.
        moved: the circles whose velocity changed.
        standing: contacts and rims at gap zero at its end, with the sign of their closing speed.
        events: what is noted of each event, first of all the circle whose clock stands at it.
        entries: in order.
        split: whether the limit on events left out the reversal, and what would have followed.
        before: the part before the reversal, in the history's terms, if this is the part after it.
    """

    number: int
    moved: set[int] = field(default_factory=set)
    standing: dict[Link, int] = field(default_factory=dict)
    events: list[tuple[int, tuple[Touch, ...], tuple[Touch, ...], tuple[Tie, ...], bool]] = field(default_factory=list)
    entries: list[Entry] = field(default_factory=list)
    split: bool = False
    before: Noted[K] | None = None

    @property
    def flipped(self) -> bool:
        """Whether this is the part after the reversal."""
        return self.before is not None


class Resolver(Generic[N, K]):
    """Resolves instants of one run.

    Args:
        scene: what runs.
        decider: its state.
        policy: resolves several contacts.

    Attributes:
        touching: the contacts that last.
        gone: circles out of play.
    """

    def __init__(self, scene: Scene, decider: Decider[N, K], policy: Policy) -> None:
        self.scene = scene
        self.decider = decider
        self.policy = policy
        self.n = len(scene.circles)
        self.touching = Lasting()
        self.gone: set[int] = set()

    def resolve(self, instant: Instant, events_left: int | None, reverse_in: int | None) -> Resolved[K]:
        """Carries an instant out.

        Args:
            instant: what was gathered.
            events_left: how many events the limit still admits; None without a limit.
            reverse_in: the number of events until the reversal; None where none is due by count.
        """
        done: Resolved[K] = Resolved(instant.number)
        if len(instant.hits) == 1 and not instant.touches and not self.touching:
            self._alone(instant.hits[0], instant.ties, done)
        elif instant.hits:
            self._contacts(instant.hits, instant.touches, instant, done)
        if self.scene.pockets:
            self._entries(instant.arrivals, instant.rims, done)
        if instant.reversal or (reverse_in is not None and len(done.events) == reverse_in):
            if events_left is not None and len(done.events) == events_left:
                done.split = True
            else:
                done = self._reverse(instant, done)
        return done

    def noted(self, done: Resolved[K]) -> Noted[K]:
        """What an instant did, in the history's terms; nothing is kept of it yet."""
        decider = self.decider
        bodies = decider.bodies
        decider.refresh([bodies[i] for i in done.moved])
        step = len(decider.history.steps)
        note: Noted[K] = Noted()
        if done.flipped:
            note.reversal = note.last = Mark(done.number, decider.reading.reversal_time(), step, REVERSAL)
        for stands, links, impulses, ties, coupled in done.events:
            note.last = Mark(done.number, decider.reading.now(bodies[stands]), step, stands)
            note.records.append(Record(note.last, links, impulses, ties, coupled))
        for link in done.entries:
            i = link.circle
            if i in done.moved or done.number == 0:
                note.last = Mark(done.number, decider.reading.now(bodies[i]), step, i)
            elif note.last is None:
                note.last = Mark(done.number, decider.reading.entry_time(link), step, link)
            note.entries.append(Arrived(i, link.pocket, note.last))
        note.knots = [(i, (*decider.reading.knot(bodies[i]), step, done.number)) for i in sorted(done.moved)]
        return note

    # -- 1. contacts

    def _alone(self, link: Touch, ties: tuple[Tie, ...], done: Resolved[K]) -> None:
        """One contact with nothing else at gap zero: it is hit, and parts."""
        circles = link.circles
        if done.number > 0:
            self.decider.do(Go(link, circles))
        self.decider.do(Kick((link,), (link,)))
        self.policy.note(link)
        done.moved.update(circles)
        done.standing[link] = 1
        done.events.append((circles[0], (link,), (link,), ties, False))

    def _contacts(
        self, hits: Iterable[Touch], touches: Mapping[Touch, int], instant: Instant, done: Resolved[K]
    ) -> None:
        """The rounds of every set of contacts that hang together and holds one that approaches: one event."""
        lasting = self.touching.all()
        known = {**dict.fromkeys(lasting, 0), **touches, **dict.fromkeys(hits, -1)}
        found = components([*hits, *touches], self.touching)
        struck = [(coming[0], c) for c in found if (coming := [k for k in c.links if known[k] < 0])]
        struck.sort(key=lambda one: scene_order(one[0]))
        for link, sign in touches.items():
            done.standing[link] = sign
        impulses: list[Touch] = []
        taking_part: set[Touch] = set()
        coupled = False
        for first, component in struck:
            if instant.clock is not None and not done.flipped:
                self.decider.do(Go(first, component.bodies))
            rounds = settle(component.links, known, self.policy, self.decider.ask, self.decider.do, MAX_ROUNDS)
            impulses += rounds.impulses
            taking_part |= rounds.taking_part
            coupled = coupled or self._coupled(rounds)
            self._keep_lasting(rounds, lasting)
            done.standing |= rounds.signs
            if len(rounds.impulses) > 1:
                self.policy.instant_done(lambda bodies=component.bodies: self.decider.reading.exact_state(bodies))
        if not struck:
            return
        done.moved.update(i for link in impulses for i in link.circles)
        ties = instant.ties if len(taking_part) > 1 else ()
        stands = struck[0][1].bodies[0]
        done.events.append((stands, tuple(sorted(taking_part, key=scene_order)), tuple(impulses), ties, coupled))
        self.decider.gathered(done.standing)

    def admit(self, link: Touch, sign: int) -> None:
        """Takes up a contact of time 0, which lasts if the two move together."""
        if sign == 0 and self._lasts(link):
            self.touching.add(link)

    def _lasts(self, link: Touch) -> bool:
        """Whether two at gap zero that neither approach nor part stay there: nothing but straight flight together
        keeps two circles at gap zero, and any flight along a wall does."""
        return not isinstance(link, Pair) or self.decider.ask(RelativeSpeed(link)) == 0

    def _coupled(self, rounds: Rounds) -> bool:
        """Whether the order of an instant's impulses could matter; where that is not known, it could."""
        links = sorted(rounds.taking_part, key=scene_order)
        return any(
            self.decider.ask_cheaply(Coupling(first, second)) != 0
            for k, second in enumerate(links)
            for first in links[:k]
            if self._share_a_mover(first, second)
        )

    def _share_a_mover(self, first: Touch, second: Touch) -> bool:
        return any(i in second.circles and not self.scene.circles[i].fixed for i in first.circles)

    def _keep_lasting(self, rounds: Rounds, lasting: frozenset[Touch]) -> None:
        """Keeps the contacts that last through an instant, and drops those that it ends."""
        hit = {i for link in rounds.impulses for i in link.circles}
        for link, sign in rounds.signs.items():
            if link in lasting and hit.isdisjoint(link.circles):
                continue
            if sign == 0 and self._lasts(link):
                self.touching.add(link)
            else:
                self.touching.discard(link)

    # -- 2. entries

    def _entries(self, arrivals: Iterable[Entry], rims: frozenset[Entry], done: Resolved[K]) -> None:
        """The circles that enter a pocket now; captured ones rest from here on."""
        arriving = set(arrivals)
        moved = [i for i in sorted(done.moved) if i not in self.gone and not self.scene.circles[i].fixed]
        self.decider.refresh([self.decider.bodies[i] for i in moved])
        pockets = range(len(self.scene.pockets))
        looked_at = {link for link in rims if link.circle not in self.gone}
        looked_at.update(Entry(i, k) for i in moved for k in pockets)
        found = [
            link
            for link in sorted(looked_at)
            if (self._moves_in(link, link in rims, done) if link.circle in done.moved else link in arriving)
        ]
        done.entries += found
        if self.scene.capture:
            for i in dict.fromkeys(link.circle for link in found):
                self._capture(next(link for link in found if link.circle == i), done)

    def _moves_in(self, link: Entry, known: bool, done: Resolved[K]) -> bool:
        """Whether a centre whose velocity has just changed stands on a rim and moves inward."""
        if not known and self.decider.meetings.off_rim(link):
            return False
        closing = self.decider.ask(Closing(link))
        if not known and (closing >= 0 or self.decider.ask(Rim(link)) != 0):
            return False
        done.standing[link] = closing
        return closing < 0

    def _capture(self, link: Entry, done: Resolved[K]) -> None:
        i = link.circle
        if i not in done.moved and done.number > 0:
            self.decider.do(Go(link, (i,)))
        done.moved.add(i)
        self.decider.do(Take(i))
        self.gone.add(i)
        for contact in self.touching.all():
            if i in contact.circles:
                self.touching.discard(contact)
        for contact in [link for link in done.standing if i in link.circles]:
            del done.standing[contact]

    # -- 3. the reversal

    def _reverse(self, instant: Instant, before: Resolved[K]) -> Resolved[K]:
        """Negates every velocity, at the set time or at the instant of the contacts just resolved."""
        source: int | Quantity = before.events[0][0] if instant.moment is None else instant.moment
        done = Resolved(instant.number + 1, moved=set(range(self.n)), before=self.noted(before))
        self.decider.do(Go(source, tuple(range(self.n))))
        self.decider.do(Flip())
        touches = {link: -sign for link, sign in instant.touches.items() if self.gone.isdisjoint(link.circles)}
        touches.update((link, -sign) for link, sign in before.standing.items() if not isinstance(link, Entry))
        hits = [link for link, sign in touches.items() if sign < 0]
        rims = instant.rims | {link for link in before.standing if isinstance(link, Entry)}
        self._contacts(hits, {link: sign for link, sign in touches.items() if sign >= 0}, instant, done)
        if self.scene.pockets:
            self._entries((), rims, done)
        return done
