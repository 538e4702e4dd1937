"""The first event at which two histories differ, and how they do."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


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
