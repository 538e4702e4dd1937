"""What one body meets in two runs around their first divergence, row by row."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import zip_longest
from typing import TYPE_CHECKING

from ...alignment.walk import history
from ..instants import later
from .listing import LEAST_NORMAL, number

if TYPE_CHECKING:
    from ....scenarios.trajectory import Trajectory
    from ...candidate import Candidate
    from ...comparison import Comparison

BEFORE, AFTER = 2, 3
"""Meetings shown before and from the divergence on."""


@dataclass(frozen=True)
class MeetingRow:
    """One meeting of the body in each run.

    Attributes:
        expected_time, expected: the reference's time and partners; empty where it has none.
        got_time, got: the candidate's.
        differs: whether this is the first row that differs.
    """

    expected_time: str
    expected: str
    got_time: str
    got: str
    differs: bool


def side_by_side(comparison: Comparison, candidate: Candidate) -> list[MeetingRow]:
    """The meetings of the diverging body, from a little before the divergence."""
    divergence = candidate.alignment.divergence
    if divergence is None:
        return []
    mine = _meetings(comparison.reference, divergence.body)
    theirs = _meetings(candidate.trajectory, divergence.body)
    at_mine = _place(mine, divergence.expected_event if divergence.expected is not None else None)
    at_theirs = _place(theirs, divergence.candidate_event)
    if divergence.expected is None:
        at_mine = next((p for p, m in enumerate(mine) if m[0] >= divergence.expected_event), len(mine))
    if divergence.candidate_event is None:
        at_theirs = len(theirs)
    before_mine = mine[max(0, at_mine - BEFORE) : at_mine]
    before_theirs = theirs[max(0, at_theirs - BEFORE) : at_theirs]
    depth = max(len(before_mine), len(before_theirs))
    rows = [
        *zip(_padded(before_mine, depth), _padded(before_theirs, depth), strict=True),
        *zip_longest(mine[at_mine : at_mine + AFTER], theirs[at_theirs : at_theirs + AFTER]),
    ]
    return [
        MeetingRow(
            _when(comparison.reference, mine, a) if a else "",
            a[2] if a else "nothing more" if k == depth else "",
            _when(candidate.trajectory, theirs, b) if b else "",
            b[2] if b else "nothing more" if k == depth else "",
            k == depth,
        )
        for k, (a, b) in enumerate(rows)
    ]


def _when(run: Trajectory, meetings: list[tuple[int, float, str]], row: tuple[int, float, str]) -> str:
    """When a meeting is; after one at a time that reads the same, how much later, where that is known."""
    time, place = _told(run, row[0], row[1]), meetings.index(row)
    event, time_before, _ = meetings[place - 1] if place else (row[0], -1.0, "")
    if not place or _told(run, event, time_before) != time:
        return time
    apart = row[1] - time_before
    told = f"{apart:.3g}" if apart else later(run.events[event], run.events[row[0]])
    return f"{told} later" if told else time


def _told(run: Trajectory, event: int, time: float) -> str:
    """A time in twelve digits; "0" of what is proved to be zero alone."""
    return f"{time:.12g}" if LEAST_NORMAL <= time < math.inf else number(run.events[event].time, False)


def _meetings(trajectory: Trajectory, body: str) -> list[tuple[int, float, str]]:
    """(event, time, partners) of a body; partners of one instant joined by `+`."""
    seen = history(trajectory)
    return [(m.event, seen.times[m.event], " + ".join(m.partners)) for m in seen.meetings[body]]


def _place(meetings: list[tuple[int, float, str]], event: int | None) -> int:
    """The row of an event, or the end."""
    return next((p for p, m in enumerate(meetings) if m[0] == event), len(meetings))


def _padded(rows: list[tuple[int, float, str]], depth: int) -> list[tuple[int, float, str] | None]:
    return [*[None] * (depth - len(rows)), *rows]
