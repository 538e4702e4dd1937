"""Why an engine left: how close the decision was beside how far off it was, and what would have been enough."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..sentences import about, middle, off

if TYPE_CHECKING:
    from ...candidate import Candidate

LINEAR, LEAST_SHARE, DECADES = 100.0, 0.02, 20
"""Ratio up to which bars are to scale, and go by powers of ten beyond; length of the shortest, as a share of the
longest; and the most powers of ten that they span."""


@dataclass(frozen=True)
class Amount:
    """One amount with a bar, on a scale that it shares with the others.

    Attributes:
        name: what it is.
        text: its value in words.
        share: length of its bar, from 0 to 1, by `shares`; 0 for none.
        own: whether it is the engine's, not the decision's.
    """

    name: str
    text: str
    share: float
    own: bool = False


def amounts(candidate: Candidate) -> list[Amount]:
    """The margin of the decision beside the engine's error by then.

    Empty where one of them is not known.
    """
    margin = candidate.margin
    if margin is None or margin.distance is None or margin.error is None:
        return []
    close, far = shares(abs(middle(margin.distance)), margin.error)
    told = "exactly 0" if margin.distance == (0.0, 0.0) else about(margin.distance)
    name = "how close it was" if margin.gap is None else "how close it was, as a distance"
    return [
        Amount(name, told, close),
        Amount(f"how far off {candidate.engine} was by then", off(margin.error), far, own=True),
    ]


def shares(*values: float) -> list[float]:
    """Lengths of bars: to scale, or by powers of ten where that would leave one too short to be seen.

    >>> shares(1.0, 2.0), shares(1e-10, 1.0), shares(0.0, 3.0)
    ([0.5, 1.0], [0.02, 1.0], [0.0, 1.0])
    """
    sizes = [value for value in values if value > 0 and math.isfinite(value)]
    if not sizes:
        return [0.0 for _ in values]
    top = max(sizes)
    low = max(min(sizes), top * 10.0**-DECADES)
    if top / low <= LINEAR:
        return [value / top if value in sizes else 0.0 for value in values]
    powers = math.log(top / low)
    return [
        LEAST_SHARE + (1 - LEAST_SHARE) * math.log(max(value, low) / low) / powers if value in sizes else 0.0
        for value in values
    ]


def enough(candidate: Candidate) -> list[tuple[str, str]]:
    """What would have been enough: bits by the growth of errors, and the settings that were run."""
    rows: list[tuple[str, str]] = []
    margin, divergence = candidate.margin, candidate.alignment.divergence
    if margin is not None and divergence is not None and not candidate.stepped:
        foreseen = foreseen_bits(margin.growth, divergence.expected_event, margin.distance, candidate.separation.scale)
        if foreseen is not None:
            told = f"about {foreseen:,}: {margin.growth:.3g} bits an event over {divergence.expected_event:,} events"
            rows.append(("bits, foreseen", told))
    if candidate.diagnosis is not None:
        rows += [(e.cause.value, e.result) for e in candidate.diagnosis.experiments if e.cause.entry.settings]
    return rows


def foreseen_bits(growth: float | None, events: int, distance: tuple[float, float] | None, scale: float) -> int | None:
    """Bits with which a rounding at the start would not have grown to the margin by the decision.

    A rounding of 2**-bits of the scene's size grows by `growth` bits at each of the `events`; it stays below the margin
    if bits > growth * events + log2(scale / margin). None where any of it is not known.

    >>> foreseen_bits(0.325, 161, (0.0395, 0.0397), 20.0)
    62
    """
    if growth is None or growth <= 0 or distance is None or not scale > 0:
        return None
    close = abs(middle(distance))
    if close == 0:
        return None
    return max(1, math.ceil(growth * events + math.log2(scale / close)))
