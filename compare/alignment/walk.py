"""Walks one body's meetings in two runs side by side, up to the first partner that differs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from .streams import Meeting


@dataclass(frozen=True)
class Mismatch:
    """Where one body's two sequences of partners part.

    Attributes:
        mine, expected: the reference's next event for the body and its partner; None at the end of the
            sequence.
        theirs, got: the same for the candidate.
    """

    mine: int | None
    expected: str | None
    theirs: int | None
    got: str | None


@dataclass
class Walk:
    """One body's meetings, matched.

    Attributes:
        pairs: (reference event, candidate event) for every partner matched.
        split: reference events whose partners the candidate meets in several events, with those.
        merged: candidate events that hold partners of several reference events, with those.
        reordered: reference events whose partners the candidate meets at one instant too, in another order.
        mismatch: where the sequences part, or None if they end together.
    """

    pairs: list[tuple[int, int]] = field(default_factory=list)
    split: dict[int, set[int]] = field(default_factory=dict)
    merged: dict[int, set[int]] = field(default_factory=dict)
    reordered: dict[int, set[int]] = field(default_factory=dict)
    mismatch: Mismatch | None = None


def walk(
    mine: Sequence[Meeting],
    theirs: Sequence[Meeting],
    my_times: Sequence[float],
    their_times: Sequence[float],
    step: float,
) -> Walk:
    """Matches partners in order; those of one instant in any order, and over several instants.

    With a time step, a partner met in several rounds of one instant counts once, and an impulse that
    repeats one within the last step is taken as part of it.

    >>> walk([Meeting(0, ("j", "k"))], [Meeting(0, ("k",)), Meeting(1, ("j",))], [1.0], [1.0, 1.0], 0.0).split
    {0: {0, 1}}
    >>> walk([Meeting(0, ("j",))], [Meeting(0, ("k",))], [1.0], [1.0], 0.0).mismatch
    Mismatch(mine=0, expected='j', theirs=0, got='k')
    """
    walked = Walk()
    waiting: list[tuple[str, int]] = []  # the reference's partners of the current instants, not yet matched
    coming: list[tuple[str, int]] = []  # the candidate's
    last_mine: tuple[int, frozenset[str]] | None = None
    last_theirs: tuple[int, frozenset[str]] | None = None
    i = j = 0
    while True:
        if not waiting and i < len(mine):
            meeting = mine[i]
            i += 1
            if (
                step
                and last_theirs is not None
                and not _next_has(coming, theirs, j, meeting.partners)
                and last_theirs[1].issuperset(meeting.partners)
                and abs(my_times[meeting.event] - their_times[last_theirs[0]]) <= 2 * step
            ):
                walked.pairs.append((meeting.event, last_theirs[0]))
                continue
            waiting = _partners(meeting, step)
            last_mine = (meeting.event, frozenset(meeting.partners))
        if not coming and j < len(theirs):
            meeting = theirs[j]
            j += 1
            if (
                step
                and last_mine is not None
                and not (waiting and _shares(waiting, meeting.partners))
                and last_mine[1].issuperset(meeting.partners)
                and abs(their_times[meeting.event] - my_times[last_mine[0]]) <= 2 * step
            ):
                walked.pairs.append((last_mine[0], meeting.event))
                continue
            coming = _partners(meeting, step)
            last_theirs = (meeting.event, frozenset(meeting.partners))
        if not waiting or not coming:
            if waiting:
                walked.mismatch = Mismatch(waiting[0][1], waiting[0][0], None, None)
            elif coming:
                walked.mismatch = Mismatch(None, None, coming[0][1], coming[0][0])
            break
        waiting, coming = _cancel(walked, waiting, coming)
        if waiting and coming:
            walked.mismatch = Mismatch(waiting[0][1], waiting[0][0], coming[0][1], coming[0][0])
            break
    _group(walked)
    return walked


def _partners(meeting: Meeting, step: float) -> list[tuple[str, int]]:
    names = dict.fromkeys(meeting.partners) if step else meeting.partners
    return [(name, meeting.event) for name in names]


def _shares(waiting: Sequence[tuple[str, int]], partners: Sequence[str]) -> bool:
    return any(name in partners for name, _ in waiting)


def _next_has(coming: Sequence[tuple[str, int]], theirs: Sequence[Meeting], j: int, partners: Sequence[str]) -> bool:
    """Whether the candidate's next meeting has one of the partners."""
    if coming:
        return _shares(coming, partners)
    return j < len(theirs) and any(name in theirs[j].partners for name in partners)


def _cancel(
    walked: Walk, waiting: list[tuple[str, int]], coming: list[tuple[str, int]]
) -> tuple[list[tuple[str, int]], list[tuple[str, int]]]:
    """Removes the partners that both have, and records who was matched with whom."""
    if len(waiting) == 1 == len(coming):  # nearly always
        if waiting[0][0] != coming[0][0]:
            return waiting, coming
        walked.pairs.append((waiting[0][1], coming[0][1]))
        return [], []
    expected, got = [name for name, _ in waiting], [name for name, _ in coming]
    if expected != got and sorted(expected) == sorted(got):
        walked.reordered.setdefault(waiting[0][1], set()).add(coming[0][1])
    left: list[tuple[str, int]] = []
    for name, theirs in coming:
        place = next((p for p, (other, _) in enumerate(waiting) if other == name), None)
        if place is None:
            left.append((name, theirs))
            continue
        mine = waiting.pop(place)[1]
        walked.pairs.append((mine, theirs))
    return waiting, left


def _group(walked: Walk) -> None:
    """Notes the events that were matched with several events of the other run.

    The pairs of one event follow each other, so that one look back suffices.
    """
    for (mine, theirs), (next_mine, next_theirs) in pairwise(walked.pairs):
        if mine == next_mine and theirs != next_theirs:
            walked.split.setdefault(mine, set()).update((theirs, next_theirs))
        if theirs == next_theirs and mine != next_mine:
            walked.merged.setdefault(theirs, set()).update((mine, next_mine))
