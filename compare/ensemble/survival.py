"""What the rows of a sweep say together: survival, shares with intervals, and the law of the horizon."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from .rows.row import SweepRow

Z_95 = 1.959963984540054
"""The normal distribution's two-sided 95 % quantile."""


@dataclass(frozen=True)
class Step:
    """A step of a survival curve: from this event on, so large a share has still the true history."""

    event: int
    share: float
    low: float
    high: float
    at_risk: int


@dataclass(frozen=True)
class Law:
    """The least-squares line of the time of divergence over ln(1/eps)/lambda.

    Attributes:
        slope, intercept: of the line.
        correlation: of the two.
        scenes: how many.
    """

    slope: float
    intercept: float
    correlation: float
    scenes: int


@dataclass(frozen=True)
class Summary:
    """One engine over all scenes of a sweep.

    Attributes:
        engine: its label.
        verdicts: how often each.
        survival: Kaplan-Meier's estimate of the share that is still true, event by event.
        median: the event by which half have left; None if so many have not.
        inside: of those that left and for which a band was foreseen, how many left inside it, and how many there are.
        law: None for fewer than three scenes, or where there is no exponent.
        changed: of the scenes whose outcomes were compared: how many changed, of how many, and the 95 % interval.
        laws: in how many runs the laws are kept, in how many they are not, and in how many that is not determined.
    """

    engine: str
    verdicts: dict[str, int]
    survival: tuple[Step, ...]
    median: int | None
    inside: tuple[int, int]
    law: Law | None
    changed: tuple[int, int, float, float] | None
    laws: tuple[int, int, int]


def summaries(rows: Iterable[SweepRow]) -> list[Summary]:
    """A summary of each engine, in the order of the rows."""
    groups: dict[str, list[SweepRow]] = {}
    for row in rows:
        groups.setdefault(row["engine"], []).append(row)
    return [_summary(engine, mine) for engine, mine in groups.items()]


def _summary(engine: str, rows: Sequence[SweepRow]) -> Summary:
    verdicts: dict[str, int] = {}
    for row in rows:
        verdicts[row["verdict"]] = verdicts.get(row["verdict"], 0) + 1
    judged = [row for row in rows if row["verdict"] != "refused"]
    left = [row for row in judged if row["event"] is not None]
    curve = survival([(row["event"], True) if row["event"] is not None else (row["agreed"], False) for row in judged])
    banded = [row for row in left if row["foreseen_low"] is not None]
    inside = sum(
        row["foreseen_low"] <= row["event"] and (row["foreseen_high"] is None or row["event"] <= row["foreseen_high"])
        for row in banded
    )
    told = [row for row in judged if row["changed"] is not None]
    changed = None
    if told:
        count = sum(bool(row["changed"]) for row in told)
        changed = (count, len(told), *wilson(count, len(told)))
    median = next((step.event for step in curve if step.share <= 0.5), None)
    law = fitted([(row["by_exponent"], row["at"]) for row in left if row["by_exponent"] is not None])
    return Summary(
        engine, dict(sorted(verdicts.items())), tuple(curve), median, (inside, len(banded)), law, changed, _laws(rows)
    )


def _laws(rows: Sequence[SweepRow]) -> tuple[int, int, int]:
    """In how many runs the laws are kept, in how many they are not, and in how many that is not determined."""
    kept = [row["laws"]["kept"] for row in rows if row.get("laws") is not None]
    return kept.count(True), kept.count(False), kept.count(None)


def survival(seen: Sequence[tuple[int, bool]]) -> list[Step]:
    """Kaplan and Meier's estimate, with Greenwood's interval on the scale of log(-log).

    Args:
        seen: for each scene the event up to which it was watched, and whether it left there (else it is censored: it
            was undecided, not settled, or true to the end). A scene censored at an event was still there at it.

    Source: E. L. Kaplan and P. Meier, J. Amer. Statist. Assoc. 53 (1958), 457.

    >>> [(s.event, round(s.share, 3), s.at_risk) for s in survival([(1, True), (2, False), (3, True), (4, True)])]
    [(1, 0.75, 4), (3, 0.375, 2), (4, 0.0, 1)]
    """
    told: list[Step] = []
    share, variance = 1.0, 0.0
    for event in sorted({event for event, left in seen if left}):
        at_risk = sum(watched >= event for watched, _ in seen)
        gone = sum(watched == event and left for watched, left in seen)
        share *= 1 - gone / at_risk
        if gone < at_risk:
            variance += gone / (at_risk * (at_risk - gone))
        told.append(Step(event, share, *_greenwood(share, variance), at_risk))
    return told


def _greenwood(share: float, variance: float) -> tuple[float, float]:
    if not 0 < share < 1:
        return share, share
    room = Z_95 * math.sqrt(variance) / abs(math.log(share))
    return share ** math.exp(room), share ** math.exp(-room)


def wilson(count: int, total: int) -> tuple[float, float]:
    """Wilson's 95 % interval of a share (J. Amer. Statist. Assoc. 22 (1927), 209).

    >>> [round(end, 4) for end in wilson(8, 10)]
    [0.4902, 0.9433]
    """
    share, square = count / total, Z_95 * Z_95
    middle = (share + square / (2 * total)) / (1 + square / total)
    room = Z_95 * math.sqrt(share * (1 - share) / total + square / (4 * total * total)) / (1 + square / total)
    return max(0.0, middle - room), min(1.0, middle + room)


def fitted(points: Sequence[tuple[float, float]]) -> Law | None:
    """The line through (foreseen, seen) times; None for fewer than three, or where all are foreseen alike.

    >>> fitted([(1.0, 3.0), (2.0, 5.0), (3.0, 7.0)])
    Law(slope=2.0, intercept=1.0, correlation=1.0, scenes=3)
    """
    count = len(points)
    if count < 3:
        return None
    mx, my = sum(x for x, _ in points) / count, sum(y for _, y in points) / count
    xx, yy = sum((x - mx) ** 2 for x, _ in points), sum((y - my) ** 2 for _, y in points)
    xy = sum((x - mx) * (y - my) for x, y in points)
    if xx == 0 or yy == 0:
        return None
    return Law(xy / xx, my - xy / xx * mx, xy / math.sqrt(xx * yy), count)
