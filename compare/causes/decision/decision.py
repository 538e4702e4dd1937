"""The decision at which two histories part: which of two meetings comes first, or whether two circles meet at all."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from flint import arb

from ....exact.numbers import ball
from ....scenarios.numbers.quantity import Real

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
