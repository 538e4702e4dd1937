"""Instants of several contacts that two runs resolve to other velocities: another order, or another law."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import TYPE_CHECKING, TypeAlias

from .divergence import Divergence, Kind
from .impulse_order import impulses_among, merging_changes, order_reproduces

if TYPE_CHECKING:
    from ...scenarios.trajectory import Contact, Event, Trajectory
    from .walk import Walk

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
    return max(
        math.hypot(
            float(mine[m][name].vx) - float(theirs[c][name].vx), float(mine[m][name].vy) - float(theirs[c][name].vy)
        )
        for name, m, c in instant.bodies
    )


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
    fastest = float(abs(candidate.after(instant.theirs[-1]).array()[:, 2:]).max())
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


def _explained(reference: Trajectory, candidate: Trajectory, instant: SharedInstant, step: float, same: float) -> bool:
    """Whether the velocities differ by no more than the error with which the candidate came to the instant.

    An error of position of e turns the direction of an impact by e / reach, which changes an impulse by twice that
    share of the speed; one of velocity counts twice. Each is passed on by every impulse, to two bodies.
    """
    m, c = instant.mine[0], instant.theirs[0]
    here, there = reference.after(m), candidate.after(c)
    mine, theirs = here.array(), there.array()
    lag = abs(float(reference.events[m].time) - float(candidate.events[c].time))
    speed = float(abs(mine[:, 2:]).max()) + float(abs(theirs[:, 2:]).max())
    names = {name for name, _, _ in instant.bodies}
    rows = [row for row, circle in enumerate(here.circles) if circle.id in names]
    apart = float(abs(mine[rows, :2] - theirs[rows, :2]).max()) + speed * (lag + step)
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
