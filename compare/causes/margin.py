"""The margin of a decision, beside the engine's error: what a report says of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

Bounds = tuple[float, float]
"""Doubles around a number that is known exactly."""


@dataclass(frozen=True)
class BitsEnough:
    """The fewest bits that decide what a divergence turns on.

    Attributes:
        bits: them; None where none was found.
        short: one less, which was seen not to do; None where there is none so few.
        by: what was seen to decide with so many bits: a whole run in balls, or the log of the exact run carried out in
            balls, of which no decision but the one in question is asked.
        told: where no number of bits is given, why.
    """

    bits: int | None = None
    short: int | None = None
    by: Literal["run", "replay"] | None = None
    told: str = ""


@dataclass(frozen=True)
class Margin:
    """How close the decision was in the exact motion, and how far off the engine was by then.

    Attributes:
        gap: the time between the two meetings, each taken as if nothing hindered it; None for hit or miss.
        distance: for hit or miss, the least distance of the surfaces in free flight, negative for the depth of a hit;
            for an order, how far apart the pair that comes second is when the first one meets.
        ulps: `gap` in units of a double's spacing at that time.
        error: the largest distance between the engine's place and the exact one of the circles in question, at the
            earlier of the two events.
        growth: bits an event by which a small error grows along the exact run up to there; None if not known.
        enough: the bits that would have been enough.
        cut: whether the user's seconds were over before all of this was measured.
    """

    gap: Bounds | None
    distance: Bounds | None
    ulps: float | None
    error: float | None = None
    growth: float | None = None
    enough: BitsEnough = BitsEnough()
    cut: bool = False

    @property
    def ratio(self) -> float | None:
        """The error over the distance: above about 1, the error explains the divergence."""
        if self.error is None or self.distance is None:
            return None
        middle = abs(self.distance[0] + self.distance[1]) / 2
        return self.error / middle if middle else math.inf if self.error else None
