"""Instants of several contacts that two runs resolve to other velocities: another order, or another law."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING, TypeAlias

from .divergence import Divergence, Kind
from .impulse_order import impulses_among, merging_changes, order_reproduces

if TYPE_CHECKING:
    from ...scenarios.event import Contact
    from ...scenarios.trajectory import Trajectory
    from .walk import Walk

Finer: TypeAlias = "Callable[[int, Instant], float | None]"
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
class Instant:
    """Events of two runs that hold the same meetings: usually one of each.

    Attributes:
        mine, theirs: the events, ascending.
        bodies: for each movable circle that takes part, its last event of each run.
    """

    mine: tuple[int, ...]
    theirs: tuple[int, ...]
    bodies: tuple[tuple[str, int, int], ...]

    def coupled(self, reference: Trajectory, candidate: Trajectory) -> bool:
        """Whether the order of its impulses could matter, in either run."""
        return any(reference.events[m].coupled for m in self.mine) or any(
            candidate.events[c].coupled for c in self.theirs
        )


def instants(walks: dict[str, Walk]) -> list[Instant]:
    """The events of both runs, grouped by the meetings that they share, by ascending event of the reference.

    >>> from .walk import Walk
    >>> instants({"a": Walk(pairs=[(0, 0), (0, 1), (1, 2)])})[0].theirs
    (0, 1)
    """
    root: dict[tuple[int, int], tuple[int, int]] = {}

    def find(node: tuple[int, int]) -> tuple[int, int]:
        while root.setdefault(node, node) != node:
            root[node] = root[root[node]]
            node = root[node]
        return node

    for walked in walks.values():
        for mine, theirs in walked.pairs:
            a, b = find((0, mine)), find((1, theirs))
            root[max(a, b)] = min(a, b)
    groups: dict[tuple[int, int], tuple[set[int], set[int], dict[str, tuple[int, int]]]] = {}
    for body, walked in walks.items():
        for mine, theirs in walked.pairs:
            group = groups.setdefault(find((0, mine)), (set(), set(), {}))
            group[0].add(mine)
            group[1].add(theirs)
            last = group[2].get(body, (-1, -1))
            group[2][body] = (max(last[0], mine), max(last[1], theirs))
    found = [
        Instant(tuple(sorted(m)), tuple(sorted(c)), tuple((name, *last) for name, last in bodies.items()))
        for m, c, bodies in groups.values()
    ]
    return sorted(found, key=lambda instant: instant.mine)


def velocity_difference(reference: Trajectory, candidate: Trajectory, instant: Instant) -> float:
    """The largest difference between the velocities with which the two runs leave an instant."""
    mine = {m: reference.at(reference.events[m].time) for m in {last for _, last, _ in instant.bodies}}
    theirs = {c: candidate.at(candidate.events[c].time) for c in {last for _, _, last in instant.bodies}}
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
    groups: Sequence[Instant],
    before: tuple[float, int],
    step: float,
    finer: Finer | None,
    same: float,
) -> Divergence | None:
    """The first instant of several contacts that the candidate leaves with other velocities.

    An engine of events is asked to lead, by its impulses in its order, from the reference's state before to the one
    after. One with a time step has no such order, so its velocities are compared: they must come nearer as the step
    is made finer.

    Args:
        before: time and event from which on nothing is looked at.
        finer: runs the series; without it, the error that the step explains is granted.
        same: the share of the largest speed up to which velocities are the same.
    """
    apart = _taken_apart(walks, sequential=reference.scene.tie_policy.name == "sequential")
    for instant in groups:
        first, start = reference.events[instant.mine[0]].time, candidate.events[instant.theirs[0]].time
        if (min(float(first), float(start)), instant.mine[0]) > before or not instant.coupled(reference, candidate):
            continue
        if step and len(instant.mine) > 1:
            changed = _matters(reference, candidate, instant, same)
        elif step:
            changed = not _blurred(reference, candidate, instant, step, finer, same)
        else:
            changed = bool(apart & {*instant.mine}) and not _reproduced(reference, candidate, instant, same)
            changed = changed or (len(instant.theirs) == 1 == len(instant.mine)
                                  and not _explained(reference, candidate, instant, step, same))  # fmt: skip
        if changed:
            return _tie(reference, candidate, instant)
    return None


def _taken_apart(walks: dict[str, Walk], sequential: bool) -> set[int]:
    """Reference events that the candidate has in several instants, in one with others, or in another order."""
    found: set[int] = set()
    for walked in walks.values():
        found |= walked.split.keys()
        found |= {m for events in walked.merged.values() for m in events}
        if sequential:
            found |= walked.reordered.keys()
    return found


def _reproduced(reference: Trajectory, candidate: Trajectory, instant: Instant, same: float) -> bool:
    """Whether the impulses of one run, in its order, lead through the other's instant to the same velocities."""
    if len(instant.mine) == 1:
        told = reference.events[instant.mine[0]]
        groups = impulses_among((candidate.events[c].impulses for c in instant.theirs), told.impulses)
        return not told.coupled or order_reproduces(reference, instant.mine[0], groups, same)
    if len(instant.theirs) == 1:
        told = candidate.events[instant.theirs[0]]
        groups = impulses_among((reference.events[m].impulses for m in instant.mine), told.impulses)
        return not told.coupled or order_reproduces(candidate, instant.theirs[0], groups, same)
    return _explained(reference, candidate, instant, 0.0, same)


def _matters(reference: Trajectory, candidate: Trajectory, instant: Instant, same: float) -> bool:
    """Whether taking several of the reference's instants as one leads to other velocities, as it did here.

    Both outcomes are computed from the reference's state: all impulses at once, and one instant after the other. They
    differ by law if by more than the way that the circles make between the instants turns the impacts.
    """
    sequence = [reference.events[m].impulses for m in instant.mine]
    by_law = merging_changes(reference, instant.mine, sequence, same)
    return by_law > 0 and velocity_difference(reference, candidate, instant) >= by_law / 2


def _blurred(
    reference: Trajectory, candidate: Trajectory, instant: Instant, step: float, finer: Finer | None, same: float
) -> bool:
    """Whether the velocities differ by no more than the time step blurs them."""
    apart = velocity_difference(reference, candidate, instant)
    fastest = float(abs(candidate.at(candidate.events[instant.theirs[-1]].time).array()[:, 2:]).max())
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


def _explained(reference: Trajectory, candidate: Trajectory, instant: Instant, step: float, same: float) -> bool:
    """Whether the velocities differ by no more than the error with which the candidate came to the instant.

    An error of position of e turns the direction of an impact by e / reach, which changes an impulse by twice that
    share of the speed; one of velocity counts twice. Each is passed on by every impulse, to two bodies.
    """
    m, c = instant.mine[0], instant.theirs[0]
    here, there = reference.at(reference.events[m].time), candidate.at(candidate.events[c].time)
    mine, theirs = here.array(), there.array()
    lag = abs(float(reference.events[m].time) - float(candidate.events[c].time))
    speed = float(abs(mine[:, 2:]).max()) + float(abs(theirs[:, 2:]).max())
    names = {name for name, _, _ in instant.bodies}
    rows = [row for row, circle in enumerate(here.circles) if circle.id in names]
    apart = float(abs(mine[rows, :2] - theirs[rows, :2]).max()) + speed * (lag + step)
    reach = min((r for circle in reference.scene.circles if (r := float(circle.r)) > 0), default=1.0)
    impulses = sum(len(reference.events[k].impulses) for k in instant.mine)
    room = same * speed + 4 * impulses * speed * apart / reach
    return velocity_difference(reference, candidate, instant) <= room


def _tie(reference: Trajectory, candidate: Trajectory, instant: Instant) -> Divergence:
    """The divergence, told of the first body with the most partners: the one that the order matters to."""
    mine = [reference.events[m].impulses for m in instant.mine]
    theirs = [candidate.events[c].impulses for c in instant.theirs]
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
