"""Instants of several contacts that only one of two runs has as one, with another outcome."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from .divergence import Divergence, Kind
from .impulse_order import impulses_among, order_reproduces

if TYPE_CHECKING:
    from ...scenarios.trajectory import Contact, Trajectory
    from .streams import History
    from .walk import Walk


def first_broken_tie(
    reference: Trajectory,
    candidate: Trajectory,
    walks: dict[str, Walk],
    mine: History,
    before: float,
    step: float,
) -> Divergence | None:
    """The first instant of several contacts that only one of the runs has as one, with another outcome."""
    split: dict[int, set[int]] = {}
    merged: dict[int, set[int]] = {}
    for walked in walks.values():
        taken_apart = [*walked.split.items()]
        if reference.scene.tie_policy.name == "sequential":
            taken_apart += walked.reordered.items()
        for event, others in taken_apart:
            split.setdefault(event, set()).update(others)
        for event, others in walked.merged.items():
            merged.setdefault(event, set()).update(others)
    found: list[Divergence] = []
    for event in sorted(split):
        if mine.times[event] > before:
            break
        told, others = reference.events[event], sorted(split[event])
        groups = impulses_among((candidate.events[c].impulses for c in others), told.impulses)
        if told.coupled and not order_reproduces(reference, event, groups, step):
            found.append(_tie(reference, event, [[*told.impulses]], candidate, others[0], groups))
            break
    for event in sorted(merged, key=lambda event: min(merged[event])):
        told, others = candidate.events[event], sorted(merged[event])
        if mine.times[others[0]] > before:
            break
        groups = impulses_among((reference.events[r].impulses for r in others), told.impulses)
        if told.coupled and not order_reproduces(candidate, event, groups, step):
            found.append(_tie(reference, others[0], groups, candidate, event, [[*told.impulses]]))
            break
    return min(found, key=lambda d: (d.time, d.event), default=None)


def _tie(
    reference: Trajectory,
    event: int,
    expected: Sequence[Sequence[Contact]],
    candidate: Trajectory,
    other: int,
    got: Sequence[Sequence[Contact]],
) -> Divergence:
    """The divergence, told of the first body with the most partners: the one that the order matters to."""
    everyone = [pair for groups in (expected, got) for pairs in groups for pair in pairs]
    movable = [str(c.id) for c in reference.scene.circles if not c.fixed]
    body = max(movable, key=lambda name: len({frozenset(pair) for pair in everyone if name in pair}))

    def partners(groups: Sequence[Sequence[Contact]]) -> str:
        """Partners at once joined by +, one instant after the other by `then`."""
        met = [dict.fromkeys(b if a == body else a for a, b in pairs if body in (a, b)) for pairs in groups]
        return " then ".join(" + ".join(names) for names in met if names)

    times = float(reference.events[event].time), float(candidate.events[other].time)
    return Divergence(event, min(times), body, partners(expected), partners(got), Kind.TIE, *times, other)
