"""The decision at which two histories part: which of two meetings comes first, or whether two circles meet at all."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from flint import arb

from ...exact.numbers import ball
from ...scenarios.numbers.quantity import Real
from ..alignment.instants import Kind, instants

if TYPE_CHECKING:
    from ...scenarios.trajectory import Contact, Trajectory
    from ..alignment.align import Alignment
    from ..alignment.instants import Divergence
    from ..alignment.walk import Walk

FIRST_BITS, MOST_BITS = 256, 1 << 14
"""Precision at which a decision is first looked at, and the most: beyond it is called zero to so many bits."""


@dataclass(frozen=True)
class OwnFlight:
    """One circle from its last meeting on: x, y, vx, vy at time t, in the engine's own numbers."""

    t: Real
    x: Real
    y: Real
    vx: Real
    vy: Real


@dataclass(frozen=True)
class Pairing:
    """A body and a partner, each as its last meeting before the decision left it.

    Attributes:
        body, partner: ids; the partner may be a wall or a fixed circle.
        anchors: for each movable one of the two, the reference's event that is its last before; None: the start.
    """

    body: str
    partner: str
    anchors: Mapping[str, int | None]


@dataclass(frozen=True)
class DecidingNumber:
    """What was decided, as one number whose sign is the answer.

    Attributes:
        kind: `hit`: the least distance of the two surfaces in free flight, negative for the depth of a hit;
            `order`: the time of the second meeting less that of the first.
        first: the pairing whose hit is in question, or the meeting that comes first in the reference.
        second: for an order, the other meeting.
    """

    kind: Literal["hit", "order"]
    first: Pairing
    second: Pairing | None = None

    @property
    def pairings(self) -> list[Pairing]:
        """What it is between."""
        return [self.first] if self.second is None else [self.first, self.second]


def answer(decision: DecidingNumber, value: arb | None) -> int | None:
    """What a value decides: its sign; for a hit, a touch without depth is a miss. None if it is not known."""
    if value is None:
        return None
    sign = ball.sign_of(value)
    if decision.kind == "hit" and sign == 0:
        return 1
    return sign


def decisions(reference: Trajectory, candidate: Trajectory, alignment: Alignment) -> list[DecidingNumber]:
    """What may have been decided otherwise at the first divergence, likeliest first.

    Of the meeting that one run has and the one that the other has instead, the earlier: whatever comes after it, its
    being there or not has changed the history.
    """
    divergence = alignment.divergence
    assert divergence is not None
    walks, body = alignment.walks, divergence.body
    if divergence.kind is Kind.TIE:
        return _of_tie(reference, candidate, alignment, divergence)
    expected = got = None
    if divergence.expected is not None:
        expected = _pairing(reference, walks, body, divergence.expected, divergence.expected_event, None)
    if divergence.got is not None and divergence.candidate_event is not None:
        got = _pairing(reference, walks, body, divergence.got, None, divergence.candidate_event)
    hits = [(divergence.got_time, got), (divergence.expected_time, expected)]
    told = sorted(((time or 0.0, pairing) for time, pairing in hits if pairing is not None), key=lambda hit: hit[0])
    found = [DecidingNumber("hit", pairing) for _, pairing in told]
    if expected is not None and got is not None:
        found.append(DecidingNumber("order", expected, got))
    return found


def _pairing(
    reference: Trajectory, walks: Mapping[str, Walk], body: str, partner: str, event: int | None, theirs: int | None
) -> Pairing | None:
    """Both as their last matched meetings before an event of either run left them."""
    anchors: dict[str, int | None] = {}
    for name in (body, partner):
        if name not in walks:
            continue
        pairs = walks[name].pairs
        if event is not None and name != body:
            before = [m for m in _own_events(reference, name) if m < event]
            anchors[name] = before[-1] if before else None
            continue
        known = [m for m, c in pairs if (m < event if event is not None else theirs is None or c < theirs)]
        if name == body:
            known = [m for m, c in pairs if (event is None or m < event) and (theirs is None or c < theirs)]
        elif theirs is not None and any(c < theirs for c in _unmatched(walks[name])):
            return None
        anchors[name] = max(known, default=None)
    return Pairing(body, partner, anchors)


def _unmatched(walked: Walk) -> list[int]:
    mismatch = walked.mismatch
    return [] if mismatch is None or mismatch.theirs is None else [mismatch.theirs]


def _own_events(reference: Trajectory, name: str) -> list[int]:
    return [e.index for e in reference.events if any(name in pair for pair in e.impulses)]


def _of_tie(
    reference: Trajectory, candidate: Trajectory, alignment: Alignment, divergence: Divergence
) -> list[DecidingNumber]:
    """The order of the first two partners that the body meets at the instant, or in the instants taken as one.

    Where it meets but one of them, the first two of several instants taken as one, of which one leads to the other.
    """
    told = divergence.expected or ""
    if " then " not in told:
        following = _next_of_group(reference, alignment, divergence)
        if following is not None:
            return [following]
        told = divergence.got or ""
    names = list(dict.fromkeys(told.replace(" + ", " then ").split(" then ")))
    pairings = [
        _pairing(reference, alignment.walks, divergence.body, name, divergence.expected_event, None)
        for name in names[:2]
    ]
    if len(pairings) < 2 or pairings[0] is None or pairings[1] is None:
        return []
    return [DecidingNumber("order", pairings[0], pairings[1])]


def _next_of_group(reference: Trajectory, alignment: Alignment, divergence: Divergence) -> DecidingNumber | None:
    """The order of the first of several instants taken as one and of the one after it, to which it leads."""
    group = next((g for g in instants(alignment.walks) if divergence.expected_event in g.mine), None)
    if group is None or len(group.mine) < 2:
        return None
    first = reference.events[group.mine[0]]
    met = {name for pair in first.impulses for name in pair if name in alignment.walks}
    for event in group.mine[1:]:
        pair = next((p for p in reference.events[event].impulses if met & {*p}), None)
        if pair is not None:
            earlier = next(p for p in first.impulses if {*p} & {*pair})
            return DecidingNumber(
                "order",
                _at_event(reference, alignment, earlier, first.index),
                _at_event(reference, alignment, pair, event),
            )
    return None


def _at_event(reference: Trajectory, alignment: Alignment, pair: Contact, event: int) -> Pairing:
    """A contact of an event of the reference, each of the two as its last event before left it."""
    anchors: dict[str, int | None] = {}
    for name in pair:
        if name in alignment.walks:
            anchors[name] = max((m for m in _own_events(reference, name) if m < event), default=None)
    return Pairing(pair.first, pair.second, anchors)
