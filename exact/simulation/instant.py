"""One instant: all that falls on it is gathered before anything acts, then resolved."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import partial
from math import inf
from typing import Generic

from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ...scenarios.trajectory import Stop, StopReason, Tie
from ..numbers.system import N, Undecided
from ..question import BeforeTime, Beside, Closing, Coupling, Decision, Endless, Falling, Moment, RelativeSpeed, Rim
from ..replay.contact import (
    AtWall,
    Entry,
    Link,
    Sides,
    Touch,
    can_push,
    contact_of,
    is_arc,
    is_flat,
    is_pair,
    name_of,
    scene_order,
)
from ..replay.state import Flip, Go, Kick, Take
from .decider import REVERSAL, Arrived, Decider, K, Limits, Mark, Noted, Record
from .endings import Carrier
from .policies import Lasting, Policy, Rounds, components, leaves_as_is, settle
from .prediction import Arrival

# -- One instant: all that falls on it, gathered before anything acts, and how it is resolved.
#
# The order, for every instant alike:
#
# 1. contacts: rounds of impulses by the tie policy, in each set of contacts that hang together, until none
# approaches; 2. entries: circles whose centres stand on a pocket's rim and move inward, in the state after the
# contacts; 3. the reversal, if it falls on this instant: every velocity is negated; 4. contacts that the reversal
# makes approach: rounds, as in 1; then the entries that they and it make, as in 2.
#
# Nothing is kept of an instant before all of it is decided.

MAX_ROUNDS = 10_000
"""Rounds of impulses at one instant before the run gives up: a cradle of n balls needs about n of them."""


@dataclass(slots=True, repr=False)
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


@dataclass(slots=True, repr=False, eq=False)
class Resolved(Generic[K]):
    """What an instant did; or its part before the reversal, or its part after it.

    Attributes:
        number: of the instant; odd for the part after the reversal.
        moved: the circles whose velocity changed.
        advanced: those that stand at the instant, whether it changed or not.
        standing: contacts and rims at gap zero at its end, with the sign of their closing speed.
        events: what is noted of each event, first of all the circle whose clock stands at it.
        entries: in order.
        split: whether the limit on events left out the reversal, and what would have followed.
        before: the part before the reversal, in the history's terms, if this is the part after it.
    """

    number: int
    moved: set[int] = field(default_factory=set)
    advanced: set[int] = field(default_factory=set)
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
        carrier: knows the circles that walls carry; None where none settles.
    """

    def __init__(self, scene: Scene, decider: Decider[N, K], policy: Policy) -> None:
        self.scene = scene
        self.decider = decider
        self.policy = policy
        self.n = len(scene.circles)
        self._sides = Sides(scene)
        self._closes = scene.restitution.sign() == 0
        self.touching = Lasting()
        self.gone: set[int] = set()
        self.carrier = Carrier(scene, decider.ask, decider.ask_cheaply, decider.do) if scene.settle else None

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
        if self.carrier is not None:
            standing = {**instant.touches, **done.standing}
            self.touching.settle(self.carrier.settle(standing), self.carrier.begun | self.scene.pegs)
            for i in self.carrier.slide(standing, self.decider.reading.fallen, self.decider.history.steps):
                self.leave(i, done)
            here = range(self.n) if done.number == 0 else done.advanced | done.moved
            done.moved |= self.carrier.anchored(here)
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
        decider.refresh([bodies[i] for i in done.moved | done.advanced])
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
        if done.number == 0 and note.last is None and self.carrier is not None and self.carrier.begun:
            first = min(self.carrier.begun)  # what settles as time begins is kept
            note.last = Mark(0, decider.reading.now(bodies[first]), step, first)
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
        done.standing[link] = 0 if self._closes else 1
        if self._closes and self._lasts(link):
            self.touching.add(link)
        done.events.append((circles[0], (link,), (link,), ties, False))

    def _contacts(
        self, hits: Iterable[Touch], touches: Mapping[Touch, int], instant: Instant, done: Resolved[K]
    ) -> None:
        """The rounds of every set of contacts that hang together and holds one that approaches: one event."""
        left = self._left_faces(None if done.flipped or instant.clock is None else Moment(instant.clock))
        lasting = self.touching.all()
        known = {**dict.fromkeys(lasting, 0), **touches, **dict.fromkeys(hits, -1)}
        found = components([*hits, *touches], self.touching)
        struck = [(coming[0], c) for c in found if (coming := [k for k in c.links if known[k] < 0])]
        struck.sort(key=lambda one: scene_order(one[0]))
        done.standing.update(touches.items())
        impulses: list[Touch] = []
        taking_part: set[Touch] = set()
        coupled = False
        for first, component in struck:
            if instant.clock is not None and not done.flipped:
                self.decider.do(Go(first, component.bodies))
                done.advanced.update(component.bodies)
                if self.carrier is not None:
                    self.carrier.lift(component.bodies)
            proves = self.decider.proves and not self.scene.elastic
            turn, again = (self._refuse_turns, self._refuse_collapse) if proves else (None, None)
            ask, do = self.decider.ask, self.decider.do
            leaves = partial(leaves_as_is, self._sides, component.links) if self.carrier is not None else None
            rounds = settle(component.links, known, self.policy, ask, do, MAX_ROUNDS, turn, again, self._closes, leaves)
            impulses += rounds.impulses
            taking_part |= rounds.taking_part
            coupled = coupled or self._coupled(rounds)
            self._keep_lasting(rounds, lasting)
            done.standing |= rounds.signs
            if len(rounds.impulses) > 1:
                self.policy.instant_done(lambda bodies=component.bodies: self.decider.reading.exact_state(bodies))
        hit = {i for link in impulses for i in link.circles}
        for link in left:
            if link.circle not in hit:
                self.touching.add(link)
        if not struck:
            return
        done.moved.update(i for link in impulses for i in link.circles)
        ties = instant.ties if len(taking_part) > 1 else ()
        stands = struck[0][1].bodies[0]
        done.events.append((stands, tuple(sorted(taking_part, key=scene_order)), tuple(impulses), ties, coupled))
        self.decider.gathered(done.standing)

    def _refuse_turns(self, first: Touch, second: Touch) -> None:
        """Stops where two contacts push each other without end within one instant, each time with a part of the speed.

        Raises:
            Undecided: naming the two.
        """
        if self.decider.ask(Endless(first, second)) >= 0 and self.decider.ask(Falling(first, second)) >= 0:
            self._refuse_collapse((first, second))

    def _refuse_collapse(self, links: Iterable[Touch]) -> None:
        """Stops where contacts push each other without end within one instant.

        Raises:
            Undecided: naming them.
        """
        names = " as well as ".join(name_of(self.scene, link) for link in sorted(set(links), key=scene_order))
        raise Undecided(
            f"collapse: {names} push each other without end within one instant; raise the restitution, or leave a gap"
        )

    def _left_faces(self, moment: Moment | None) -> list[AtWall]:
        """Takes from what lasts the faces whose line a circle slides along, but not, at an instant, between the ends.

        At an end itself the end is what it touches: it grazes there.
        """
        faces = self.scene.faces
        if not faces:
            return []
        sliding = sorted(link for link in self.touching.all() if is_flat(link) and link.wall in faces)
        ends = (False, True)
        found = [link for link in sliding if any(self.decider.ask(Beside(link, far, moment)) <= 0 for far in ends)]
        for link in found:
            self.touching.discard(link)
        return found

    def admit(self, link: Touch, sign: int) -> None:
        """Takes up a contact of time 0, which lasts if the two move together."""
        if sign == 0 and self._lasts(link):
            self.touching.add(link)

    def _lasts(self, link: Touch) -> bool:
        """Whether two at gap zero that neither approach nor part stay there: nothing but straight flight together
        keeps two circles at gap zero, and any flight along a wall does, unless gravity bends it.

        Raises:
            Undecided: for a flight along the inside of an arc.
        """
        if is_flat(link):
            return self._sides.pull(*link[:2]) == 0
        if not self.scene.pegs.isdisjoint(link.circles) or (is_arc(link) and self.scene.gravity is not None):
            return False  # whatever falls along something round leaves it, or ends the run (see `Endings`)
        if self.decider.ask(RelativeSpeed(link)) == 0:
            return True
        if link.hollow:
            who = name_of(self.scene, link)
            raise Undecided(
                f"{who} touch from within, and the flight is along the arc, which no straight one can follow"
            )
        return False

    def _coupled(self, rounds: Rounds) -> bool:
        """Whether the order of an instant's impulses could matter; where that is not known, it could."""
        links = sorted(rounds.taking_part, key=scene_order)
        return any(
            self.decider.ask_cheaply(Coupling(first, second)) != 0
            for k, second in enumerate(links)
            for first in links[:k]
            if any(i in second.circles and not self.scene.circles[i].fixed for i in first.circles)
        )

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
        if self.scene.gravity is not None:  # a parabola may leave, and enter again: it is looked at anew from here
            for link in found:
                if link.circle not in done.moved and done.number > 0:
                    if link.circle not in done.advanced:
                        self.decider.do(Go(link, (link.circle,)))
                    done.moved.add(link.circle)
                    done.standing[link] = -1
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
        if i not in done.moved | done.advanced and done.number > 0:
            self.decider.do(Go(link, (i,)))
        self.decider.do(Take(i))
        self.leave(i, done)

    def leave(self, i: int, done: Resolved[K]) -> None:
        """Takes a circle out of play."""
        done.moved.add(i)
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
        touches.update((link, -sign) for link, sign in before.standing.items() if can_push(link))
        hits = [link for link, sign in touches.items() if sign < 0]
        rims = instant.rims | {link for link in before.standing if not can_push(link)}
        self._contacts(hits, {link: sign for link, sign in touches.items() if sign >= 0}, instant, done)
        if self.scene.pockets:
            self._entries((), rims, done)
        return done


# -- Gathers all that falls on the next instant.
#
# The arrivals that may be first are taken off the queue; what may not come is settled; the numbers decide which is
# first, and which fall on the same instant. A limit in time counts as one of them.


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
        if self.scene.ends:
            self._refuse_corners(grazes, chosen, limit)
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
        if len(chosen) == 1 and not touches and moment is None and can_push(first):
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
        contacts = [contact_of(self.scene, a.link) for a in (first, second) if can_push(a.link)]
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

    def _refuse_corners(
        self, grazes: list[Arrival[N]], chosen: list[Arrival[N]], limit: tuple[Quantity | None, bool] | None
    ) -> None:
        """Stops where a point circle comes to an end of radius 0, which has no normal.

        Raises:
            Undecided: naming the two.
        """
        circles = self.scene.circles
        for graze in grazes:
            link = graze.link
            if not is_pair(link) or circles[link.a].r.sign() or circles[link.b].r.sign():
                continue
            if limit is not None and self._place(graze, limit[0]) > 0:
                continue
            if not chosen or self._graze_place(graze, chosen[0]).sign <= 0:
                raise Undecided(no_normal(self.scene, link))

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
    return sorted([a.link for a in arrivals if can_push(a.link)], key=scene_order)


def _entries(arrivals: list[Arrival[N]]) -> list[Entry]:
    """The entries among the contacts."""
    return [a.link for a in arrivals if not can_push(a.link)]


def no_normal(scene: Scene, link: Link) -> str:
    """Why a run ends where a point comes to an end of radius 0."""
    who = name_of(scene, link)
    return f"no normal: {who} meet in one point, an end without thickness; give one of them a radius"
