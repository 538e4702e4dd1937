"""Where two histories differ first, and whether an instant of several contacts is resolved alike in both."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from itertools import groupby
from typing import TYPE_CHECKING, TypeAlias

from ...exact.replay import state as exact_state
from ...exact.replay.contact import part_at, touch_of
from ...exact.simulation.policies import pushing_contacts

if TYPE_CHECKING:
    from ...exact.replay.contact import Touch
    from ...scenarios.trajectory import Contact, Event, State, Trajectory
    from .walk import Walk


class Kind(Enum):
    """How a candidate's history leaves the reference's."""

    DIFFERENT = "different"
    """the body meets another partner"""
    MISSING = "missing"
    """the body does not meet the expected partner, nor any other"""
    EXTRA = "extra"
    """the body meets a partner where the reference has none"""
    TIE = "tie"
    """contacts of one instant, whose order matters, taken apart or in another order; or instants taken as
    one"""


@dataclass(frozen=True)
class Divergence:
    """The first event at which the histories differ.

    Attributes:
        event: the first event of the reference that the candidate lacks, or before which it has one too many.
        time: when the histories part, by the earlier of the two clocks.
        body: the circle whose next partner differs then.
        expected: the partner in the reference; None for an extra meeting; for a tie, `b2 + b3` (at once).
        got: the candidate's partner; None for a missing meeting; for a tie, `b2 then b3`.
        kind: how they differ.
        expected_time, got_time: when each run has its meeting.
        candidate_event: index in the candidate of the event got, if there is one.
        own_event: index in the reference of the event that the body comes to next; for an extra one, the index that it
            would have. What one meeting too many leads to may be an earlier event that is missing, of other circles:
            `event` is then before it. None: the same.
    """

    event: int
    time: float
    body: str
    expected: str | None
    got: str | None
    kind: Kind
    expected_time: float | None = None
    got_time: float | None = None
    candidate_event: int | None = None
    own_event: int | None = None

    @property
    def expected_event(self) -> int:
        """Index in the reference of the event that the body comes to next, or would."""
        return self.event if self.own_event is None else self.own_event

    @property
    def partners(self) -> list[str]:
        """Everything that the body meets in either run, each once.

        >>> Divergence(0, 1.0, "b1", "b2 + b3", "b3 then b4", Kind.TIE).partners
        ['b2', 'b3', 'b4']
        """
        told = [text for text in (self.expected, self.got) if text is not None]
        if self.kind is not Kind.TIE:
            return [*dict.fromkeys(told)]
        return [*dict.fromkeys(name for text in told for part in text.split(" then ") for name in part.split(" + "))]


# ----------------------------------------
# Whether taking the contacts of one instant as another run took them leads to the same velocities.

Velocities: TypeAlias = "dict[str, tuple[float, float]]"


def same_velocity(bits: int | None) -> float:
    """The share of the largest speed up to which velocities are the same: half of the digits that they have.

    Both come from one state by some operations, each rounded to so many bits (53 at the most, for they are done again
    in doubles), while another order of coupled impulses changes them by the coupling, in their first digits unless the
    contacts are at right angles but for as little as that share. Half of the digits lies as far from the one as from
    the other.

    >>> same_velocity(None) == same_velocity(106) == 2.0**-26, same_velocity(24) == 2.0**-12
    (True, True)
    """
    return 2.0 ** -(min(bits or DOUBLE_BITS, DOUBLE_BITS) // 2)


DOUBLE_BITS = 53
"""Bits of a double."""


def order_reproduces(
    trajectory: Trajectory,
    index: int,
    impulses: Sequence[Contact],
    groups: Sequence[Sequence[Contact]],
    same: float,
) -> bool:
    """Whether the impulses of `groups`, in order, lead from the state before an event to the state after it.

    A run that took an instant's contacts apart (or took several instants as one) has not changed what
    happened if the way in which it took them leads to the same velocities. Contacts of one group that
    approach together get their impulses together, unless the scene's tie policy is sequential.

    Args:
        trajectory: the run that took the contacts as one instant.
        index: the event in that run.
        impulses: those of its impulses that are meant: they have no circle that can move in common with the others.
        groups: the pairs as the other run took them: a group for each of its instants.
        same: see `same_velocity`.
    """
    before, after = _velocities_before(trajectory, index), trajectory.after(index)
    impact = _Impact(trajectory, {c.id: (float(c.x), float(c.y)) for c in after.circles}, before)
    scale = max((math.hypot(*v) for v in before.values()), default=0.0)
    room = same * scale
    at_once = trajectory.scene.tie_policy.name == "simultaneous"
    if not all(impact.take(group, at_once) for group in groups):
        return False
    touched = {name for pair in (*impulses, *(p for g in groups for p in g)) for name in pair}
    return all(
        math.hypot(impact.velocities[c.id][0] - float(c.vx), impact.velocities[c.id][1] - float(c.vy)) <= room
        for c in after.circles
        if c.id in touched - captured_by(trajectory, index)
    )


def merging_changes(
    trajectory: Trajectory, indices: Sequence[int], groups: Sequence[Sequence[Contact]], same: float
) -> float:
    """By how much velocities differ if the impulses of several instants are given at once; 0 if by no law.

    Args:
        trajectory: the run that has the instants one after the other.
        indices: the events.
        groups: their impulses.
        same: see `same_velocity`.
    """
    before = _velocities_before(trajectory, indices[0])
    first, last = (float(trajectory.events[index].time) for index in (indices[0], indices[-1]))
    places = {c.id: (float(c.x), float(c.y)) for c in trajectory.after(indices[0]).circles}
    one, other = _Impact(trajectory, places, before), _Impact(trajectory, places, before)
    everything = [*dict.fromkeys(pair for group in groups for pair in group)]
    in_turn = all(one.take([pair], False) for group in groups for pair in group)
    at_once = other.take([pair for pair in everything if other.closing(pair) > 0], True)
    scale = max((math.hypot(*v) for v in before.values()), default=0.0)
    if not (in_turn and at_once):
        return scale
    apart = max(math.dist(one.velocities[name], other.velocities[name]) for name in before)
    way = scale * (last - first)
    return apart if apart > same * scale + 4 * len(everything) * scale * way / one.least_reach else 0.0


def follows_the_law(trajectory: Trajectory, index: int, bits: int | None) -> bool:
    """Whether an event of one contact leaves its circles as the law of elastic impact does, from the run's own state.

    What rounding to so many bits makes of places and velocities is granted; a contact that approaches no faster than
    that may do nothing. Beside what moves and has ends nothing is said.
    """
    event = trajectory.events[index]
    if len(event.impulses) != 1 or trajectory.scene.moving_solid is not None:
        return True
    pair = event.impulses[0]
    before, after = _velocities_before(trajectory, index), trajectory.after(index)
    places = {c.id: (float(c.x), float(c.y)) for c in after.circles}
    impact = _Impact(trajectory, places, before)
    speed = max((math.hypot(*v) for v in before.values()), default=0.0)
    far = max(abs(x) for place in places.values() for x in place) + speed * float(event.time)
    turned = 2.0 ** -min(bits or DOUBLE_BITS, DOUBLE_BITS) * far / impact.least_reach
    room = speed * (same_velocity(bits) + TURNS * turned)
    if impact.closing(pair) > 0:
        impact.take([pair], True)
    told = _velocities(after)
    return all(math.dist(impact.velocities[name], told[name]) <= room for name in pair if name in told)


TURNS = 64
"""How many roundings of its place an impact may be turned by: some for each operation that leads to the contact."""


def impulses_among(events: Iterable[Sequence[Contact]], pairs: Sequence[Contact]) -> list[list[Contact]]:
    """For each of some events, its impulses that are between the given pairs; events without any left out."""
    wanted = {frozenset(pair) for pair in pairs}
    groups = [[pair for pair in impulses if frozenset(pair) in wanted] for impulses in events]
    return [group for group in groups if group]


def _velocities_before(trajectory: Trajectory, index: int) -> Velocities:
    """Velocities as an event comes: those that the event before it left, or that circles have fallen to since."""
    time = trajectory.events[index].time
    before = math.nextafter(float(getattr(time, "low", time)), -math.inf)
    last = float(trajectory.events[index - 1].time) if index else 0.0
    if trajectory.scene.gravity is not None and before > last:
        return _velocities(trajectory.at(before))
    if index == 0:
        left = {str(c.id): (float(c.vx), float(c.vy)) for c in trajectory.scene.circles}
    else:
        left = _velocities(trajectory.after(index - 1))
    turned = trajectory.reversal is not None and trajectory.reversal.after == index
    return {name: (-vx, -vy) for name, (vx, vy) in left.items()} if turned else left


def _velocities(state: State) -> Velocities:
    return {c.id: (float(c.vx), float(c.vy)) for c in state.circles}


class _Impact:
    """The circles of a scene at one instant, in doubles, and the exact engine's laws upon them."""

    def __init__(self, trajectory: Trajectory, places: Velocities, velocities: Velocities) -> None:
        from ...floating.double import DOUBLES  # here, since it loads numpy, which a listing does without
        from ...floating.plain import PlainDecider

        scene = trajectory.scene
        self.least_reach = min((r for c in scene.circles if (r := float(c.r)) > 0), default=1.0)
        self._places = {name: place for place, name in enumerate(scene.ids)}
        self._state = exact_state.ReplayState(scene.surfaces, DOUBLES)
        self._scene = scene
        self._names = [str(c.id) for c in scene.circles]
        for name, body in zip(self._names, self._state.bodies.values(), strict=False):  # ends come after them
            (x, y), (vx, vy) = places[name], velocities[name]
            body.flight = body.flight._replace(x=x, y=y, vx=vx, vy=vy)
        self._decider = PlainDecider(scene.surfaces, self._state, DOUBLES)

    @property
    def velocities(self) -> Velocities:
        """(vx, vy) of every circle."""
        return {name: b.flight[2:4] for name, b in zip(self._names, self._state.bodies.values(), strict=False)}

    def take(self, group: Sequence[Contact], at_once: bool) -> bool:
        """Applies the impulses of a group in rounds; False if one of them could not have come about."""
        left = list(group)
        while left:
            links = [self._link(left[0])]
            for pair in left[1:] if at_once else ():
                link = self._link(pair, links)
                if link in links or not link.approach(self._state) < 0:
                    break
                links.append(link)
            left = left[len(links) :]
            if not all(link.approach(self._state) < 0 for link in links):
                return False
            self._state.kick(pushing_contacts(links, self._decider.ask))
        return True

    def closing(self, pair: Contact) -> float:
        """Positive while two approach."""
        return -self._link(pair).approach(self._state)

    def _link(self, pair: Contact, taken: Sequence[Touch] = ()) -> Touch:
        i, j = self._places[pair.first], self._places[pair.second]
        first_segment = len(self._scene.circles) + len(self._scene.walls)
        if j >= first_segment:
            return part_at(self._scene, i, j - first_segment, *self._state.bodies[i].flight[:2], taken)
        return touch_of(self._scene, i, j)


# ----------------------------------------
# Instants of several contacts that two runs resolve to other velocities: another order, or another law.

Finer: TypeAlias = "Callable[[int, SharedInstant], float | None]"
"""How far the velocities after an instant are from the reference's, with the step halved so many times; None if that
run is not to be had, or does not come to the instant."""

HALVINGS = (2, 4, 6)
"""A time step is quartered up to three times: an outcome that the step only blurs then comes 64 times nearer, while
another outcome stays where it is."""

NEARER = 4.0
"""A difference that is linear in the step is 64 times smaller at the end of the series, in the mean; by how much of a
step a contact is late is chance, so that the first may be a sixteenth of what the step makes it. One that the step does
not make stays as it is."""

TOLD = 4
"""How many meetings, one after the other, a divergence names."""


@dataclass(frozen=True)
class SharedInstant:
    """Events of two runs that hold the same meetings: usually one of each.

    Attributes:
        mine, theirs: the events, ascending.
        bodies: for each movable circle that takes part, its last event of each run.
        pairs: which event of the one run shares a meeting with which of the other.
    """

    mine: tuple[int, ...]
    theirs: tuple[int, ...]
    bodies: tuple[tuple[str, int, int], ...]
    pairs: frozenset[tuple[int, int]] = frozenset()

    def coupled(self, reference: Trajectory, candidate: Trajectory) -> bool:
        """Whether the order of its impulses could matter, in either run."""
        return any(reference.events[m].coupled for m in self.mine) or any(
            candidate.events[c].coupled for c in self.theirs
        )

    def among(self, other: SharedInstant) -> SharedInstant:
        """The same, of the circles of another alone."""
        names = {name for name, _, _ in other.bodies}
        return replace(self, bodies=tuple(body for body in self.bodies if body[0] in names))

    def impulses(self, event: Event) -> list[Contact]:
        """The impulses of one of its events that its circles take part in."""
        names = {name for name, _, _ in self.bodies}
        return [pair for pair in event.impulses if names & {*pair}]


EventPlace: TypeAlias = "tuple[int, int, str]"
"""A run (0: the reference), one of its events, and what of that event is meant."""


def instants(walks: dict[str, Walk]) -> list[SharedInstant]:
    """The events of both runs, grouped by the meetings that they share, by ascending event of the reference.

    >>> from .walk import Walk
    >>> instants({"a": Walk(pairs=[(0, 0), (0, 1), (1, 2)])})[0].theirs
    (0, 1)
    """
    return _grouped(walks, lambda run, event, body: "")


def clusters(walks: dict[str, Walk], reference: Trajectory, candidate: Trajectory) -> list[SharedInstant]:
    """The same, where events are taken apart into what hangs together in them.

    What else falls on the time of an event in one of the runs, far from it, then says nothing of it.
    """
    runs = reference, candidate
    parts: dict[tuple[int, int], dict[str, str]] = {}

    def part(run: int, event: int, body: str) -> str:
        told = runs[run].events[event].impulses
        if len(told) == 1:
            return ""
        if (run, event) not in parts:
            parts[run, event] = hanging_together(told, walks)
        return parts[run, event][body]

    return _grouped(walks, part)


def hanging_together(impulses: Sequence[Contact], movable: Collection[str]) -> dict[str, str]:
    """For each movable circle of some impulses, the first of those with which it hangs together through impulses.

    >>> hanging_together([("a", "wall"), ("b", "c"), ("c", "d"), ("e", "wall")], "abcde")
    {'a': 'a', 'b': 'b', 'c': 'b', 'd': 'b', 'e': 'e'}
    """
    found: dict[str, str] = {}
    for pair in impulses:
        names = [name for name in pair if name in movable]
        firsts = {found.get(name, name) for name in names}
        first = next(iter(name for name in (*found, *names) if name in firsts))
        found.update(dict.fromkeys(names, first))
        found = {name: first if own in firsts else own for name, own in found.items()}
    return found


def _grouped(walks: dict[str, Walk], part: Callable[[int, int, str], str]) -> list[SharedInstant]:
    """What the meetings of all bodies join.

    Args:
        part: which part of an event of a run is meant, for a body.
    """
    root: dict[EventPlace, EventPlace] = {}

    def find(node: EventPlace) -> EventPlace:
        while root.setdefault(node, node) != node:
            root[node] = root[root[node]]
            node = root[node]
        return node

    joined = [
        (body, m, c, (0, m, part(0, m, body)), (1, c, part(1, c, body)))
        for body, walked in walks.items()
        for m, c in walked.pairs
    ]
    for _, _, _, mine, theirs in joined:
        a, b = find(mine), find(theirs)
        root[max(a, b)] = min(a, b)
    groups: dict[EventPlace, tuple[set[tuple[int, int]], dict[str, tuple[int, int]]]] = {}
    for body, m, c, mine, _ in joined:
        pairs, bodies = groups.setdefault(find(mine), (set(), {}))
        pairs.add((m, c))
        last = bodies.get(body, (-1, -1))
        bodies[body] = (max(last[0], m), max(last[1], c))
    found = [
        SharedInstant(
            tuple(sorted({m for m, _ in pairs})),
            tuple(sorted({c for _, c in pairs})),
            tuple((name, *last) for name, last in bodies.items()),
            frozenset(pairs),
        )
        for pairs, bodies in groups.values()
    ]
    return sorted(found, key=lambda instant: instant.mine)


def velocity_difference(reference: Trajectory, candidate: Trajectory, instant: SharedInstant) -> float:
    """The largest difference between the velocities with which the two runs leave an instant."""
    mine = {m: reference.after(m) for m in {last for _, last, _ in instant.bodies}}
    theirs = {c: candidate.after(c) for c in {last for _, _, last in instant.bodies}}
    gone = {m: captured_by(reference, m) for m in mine}
    return max(
        (
            math.hypot(
                float(mine[m][name].vx) - float(theirs[c][name].vx), float(mine[m][name].vy) - float(theirs[c][name].vy)
            )
            for name, m, c in instant.bodies
            if name not in gone[m]
        ),
        default=0.0,
    )


def captured_by(run: Trajectory, event: int) -> set[str]:
    """Circles that a pocket has captured by the end of an event's instant: that they rest is not of its impulses."""
    time = float(run.events[event].time)
    return {entry.circle for entry in run.pocketings if run.scene.capture and float(entry.time) <= time}


def first_changed_instant(
    reference: Trajectory,
    candidate: Trajectory,
    walks: dict[str, Walk],
    groups: Sequence[SharedInstant],
    before: tuple[float, int],
    step: float,
    finer: Finer | None,
    same: float,
) -> tuple[Divergence, SharedInstant] | None:
    """The first instant of several contacts that the candidate leaves with other velocities.

    An engine of events is asked to lead, by its impulses in its order, from the reference's state before to the one
    after. One with a time step has no such order, so its velocities are compared: they must come nearer as the step
    is made finer.

    Args:
        before: time and event from which on nothing is looked at.
        finer: runs the series; without it, the error that the step explains is granted.
        same: the share of the largest speed up to which velocities are the same.
    """
    sequential = reference.scene.tie_policy.name == "sequential"
    for instant in groups:
        if (_start(reference, candidate, instant), instant.mine[0]) > before:
            continue
        if not instant.coupled(reference, candidate):
            continue
        if step:
            several = len(instant.mine) > 1
            if several and _has_all(reference, candidate, instant):
                continue
            changed = (_matters(reference, candidate, instant, same) if several
                       else not _blurred(reference, candidate, instant, step, finer, same))  # fmt: skip
            if changed:
                return _tie(reference, candidate, instant), instant
            continue
        if _taken_apart(walks, instant, sequential):
            part = _not_reproduced(reference, candidate, walks, instant, same)
            if part is not None:
                return _tie(reference, candidate, part), part
        told = instant.theirs[0] not in getattr(candidate.motion, "reckoned", ())
        alone = told and len(instant.theirs) == 1 == len(instant.mine)
        if alone and not _explained(reference, candidate, instant, step, same):
            return _tie(reference, candidate, instant), instant
    return None


def _has_all(reference: Trajectory, candidate: Trajectory, instant: SharedInstant) -> bool:
    """Whether a step that takes several of the reference's instants has every contact as often as they have."""
    own = Counter(frozenset(pair) for pairs in _impulses(reference, instant, instant.mine) for pair in pairs)
    told = Counter(frozenset(pair) for pairs in _impulses(candidate, instant, instant.theirs) for pair in pairs)
    return own == told


def first_lacked(reference: Trajectory, candidate: Trajectory, instant: SharedInstant) -> int:
    """Of several of the reference's instants that a step takes as one, the first of which it lacks a contact.

    Where it has every contact, and one too many, that is before the first of them: a step says not when.
    """
    for event in instant.theirs:
        told = Counter(frozenset(pair) for pairs in _impulses(candidate, instant, [event]) for pair in pairs)
        taken = sorted(m for m, theirs in instant.pairs if theirs == event)
        for mine, pairs in zip(taken, _impulses(reference, instant, taken), strict=True):
            wanted = Counter(frozenset(pair) for pair in pairs)
            if wanted - told:
                return mine
            told -= wanted
    return instant.mine[0]


def _taken_apart(walks: dict[str, Walk], instant: SharedInstant, sequential: bool) -> bool:
    """Whether the candidate has an instant in several, in one with others, or in another order."""
    return len(instant.mine) + len(instant.theirs) > 2 or (sequential and bool(_reordered(walks, instant)))


def _reordered(walks: dict[str, Walk], instant: SharedInstant) -> set[int]:
    """The reference's events of an instant whose partners a circle meets in another order."""
    return {m for name, _, _ in instant.bodies for m in walks[name].reordered} & {*instant.mine}


def _not_reproduced(
    reference: Trajectory, candidate: Trajectory, walks: dict[str, Walk], instant: SharedInstant, same: float
) -> SharedInstant | None:
    """The first part of an instant at which the impulses of one run, in its order, lead elsewhere than the other's.

    Each event that the other run has in several, or in another order, is asked by itself: what comes later can then
    not change the answer.
    """
    apart = _reordered(walks, instant)
    parts: list[SharedInstant] = []
    for m in instant.mine:
        others = sorted(c for mine, c in instant.pairs if mine == m)
        if (len(others) > 1 or m in apart) and not _leads_to(reference, m, candidate, others, instant, same):
            parts.append(replace(instant, mine=(m,), theirs=tuple(others)))
    for c in instant.theirs:
        others = sorted(m for m, theirs in instant.pairs if theirs == c)
        if len(others) > 1 and not _leads_to(candidate, c, reference, others, instant, same):
            parts.append(replace(instant, mine=tuple(others), theirs=(c,)))
    return min(parts, key=lambda part: (_start(reference, candidate, part), part.mine), default=None)


def _start(reference: Trajectory, candidate: Trajectory, instant: SharedInstant) -> float:
    """The earlier of the times at which the two runs begin an instant."""
    return min(float(reference.events[instant.mine[0]].time), float(candidate.events[instant.theirs[0]].time))


def _leads_to(
    run: Trajectory, index: int, other: Trajectory, events: Sequence[int], instant: SharedInstant, same: float
) -> bool:
    """Whether an event's impulses, as the other run has them in some events, lead to the velocities after it."""
    event = run.events[index]
    own = instant.impulses(event)
    groups = impulses_among(_impulses(other, instant, events), own)
    return not event.coupled or order_reproduces(run, index, own, groups, same)


def _impulses(run: Trajectory, instant: SharedInstant, events: Sequence[int]) -> list[list[Contact]]:
    """The impulses of an instant in one of the two runs, event by event."""
    return [instant.impulses(run.events[event]) for event in events]


def _matters(reference: Trajectory, candidate: Trajectory, instant: SharedInstant, same: float) -> bool:
    """Whether taking several of the reference's instants as one leads to other velocities, as it did here.

    Both outcomes are computed from the reference's state: all impulses at once, and one instant after the other. They
    differ by law if by more than the way that the circles make between the instants turns the impacts.
    """
    sequence = _impulses(reference, instant, instant.mine)
    by_law = merging_changes(reference, instant.mine, sequence, same)
    return by_law > 0 and velocity_difference(reference, candidate, instant) >= by_law / 2


def _blurred(
    reference: Trajectory, candidate: Trajectory, instant: SharedInstant, step: float, finer: Finer | None, same: float
) -> bool:
    """Whether the velocities differ by no more than the time step blurs them."""
    apart = velocity_difference(reference, candidate, instant)
    fastest = _fastest(candidate.after(instant.theirs[-1]))
    if apart <= same * fastest:
        return True
    if finer is None:
        return _explained(reference, candidate, instant, step, same)
    widest = apart
    for halvings in HALVINGS:
        nearer = finer(halvings, instant)
        if nearer is None:
            return _explained(reference, candidate, instant, step, same) if widest is apart else False
        if nearer <= widest / NEARER:
            return True
        widest = max(widest, nearer)
    return False


def _fastest(state: State) -> float:
    """The largest component of a velocity."""
    return max(abs(float(speed)) for circle in state.circles for speed in (circle.vx, circle.vy))


def _explained(reference: Trajectory, candidate: Trajectory, instant: SharedInstant, step: float, same: float) -> bool:
    """Whether the velocities differ by no more than the error with which the candidate came to the instant.

    An error of position of e turns the direction of an impact by e / reach, which changes an impulse by twice that
    share of the speed; one of velocity counts twice. Each is passed on by every impulse, to two bodies.
    """
    m, c = instant.mine[0], instant.theirs[0]
    here, there = reference.after(m), candidate.after(c)
    lag = abs(float(reference.events[m].time) - float(candidate.events[c].time))
    speed = _fastest(here) + _fastest(there)
    names = {name for name, _, _ in instant.bodies}
    pairs = [(a, b) for a, b in zip(here.circles, there.circles, strict=True) if a.id in names]
    apart = max(abs(float(p) - float(q)) for a, b in pairs for p, q in ((a.x, b.x), (a.y, b.y))) + speed * (lag + step)
    reach = min((r for circle in reference.scene.circles if (r := float(circle.r)) > 0), default=1.0)
    impulses = sum(map(len, _impulses(reference, instant, instant.mine)))
    room = same * speed + 4 * impulses * speed * apart / reach
    return velocity_difference(reference, candidate, instant) <= room


def _tie(reference: Trajectory, candidate: Trajectory, instant: SharedInstant) -> Divergence:
    """The divergence, told of the first body with the most partners: the one that the order matters to."""
    mine, theirs = _impulses(reference, instant, instant.mine), _impulses(candidate, instant, instant.theirs)
    if len(instant.mine) == 1 and len(instant.theirs) > 1:
        theirs = impulses_among(theirs, mine[0])
    elif len(instant.theirs) == 1 and len(instant.mine) > 1:
        mine = impulses_among(mine, theirs[0])
    everyone = [pair for groups in (mine, theirs) for pairs in groups for pair in pairs]
    movable = [str(c.id) for c in reference.scene.circles if not c.fixed]
    body = max(movable, key=lambda name: len({frozenset(pair) for pair in everyone if name in pair}))

    def partners(groups: Sequence[Sequence[Contact]]) -> str:
        """Partners at once joined by +, one instant after the other by `then`."""
        met = [dict.fromkeys(b if a == body else a for a, b in pairs if body in (a, b)) for pairs in groups]
        told = [text for text, _ in groupby(" + ".join(names) for names in met if names)]
        return " then ".join(told if len(told) <= TOLD else [*told[:TOLD], f"{len(told) - TOLD} more"])

    event, other = min(instant.mine), min(instant.theirs)
    times = float(reference.events[event].time), float(candidate.events[other].time)
    return Divergence(event, min(times), body, partners(mine), partners(theirs), Kind.TIE, *times, other)
