"""What the rows of a sweep say together: survival, shares with intervals, and the law of the horizon."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from flint import arb

from .rows.row import SweepRow

Z_95 = 1.959963984540054
"""The normal distribution's two-sided 95 % quantile."""

TAIL = 0.025
"""What a 95 % interval leaves on either side."""

BISECTIONS = 52
"""Of the interval from 0 to 1, until doubles tell no more."""


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
        changed = (count, len(told), *proportion(count, len(told)))
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
    """Kaplan and Meier's estimate, with the 95 % interval of the beta product procedure.

    Without censoring the interval is that of Clopper and Pearson; it holds also where none is left, or nearly all are.

    Args:
        seen: for each scene the event up to which it was watched, and whether it left there (else it is censored: it
            was undecided, not settled, or true to the end). A scene censored at an event was still there at it.

    Sources: E. L. Kaplan and P. Meier, J. Amer. Statist. Assoc. 53 (1958), 457; M. P. Fay, E. H. Brittain and M. A.
    Proschan, Biostatistics 14 (2013), 723, by the method of moments.

    >>> [(s.event, round(s.share, 3), s.at_risk) for s in survival([(1, True), (2, False), (3, True), (4, True)])]
    [(1, 0.75, 4), (3, 0.375, 2), (4, 0.0, 1)]
    """
    told: list[Step] = []
    share, mean, square = 1.0, 1.0, 1.0
    for event in sorted({event for event, left in seen if left}):
        at_risk = sum(watched >= event for watched, _ in seen)
        gone = sum(watched == event and left for watched, left in seen)
        stay = sum(watched > event for watched, _ in seen)
        share *= 1 - gone / at_risk
        mean, square = _times_beta(mean, square, at_risk - gone + 1, gone)
        low = _beta_quantile(TAIL, *_times_beta(mean, square, stay, 1)) if stay else 0.0
        told.append(Step(event, share, low, _beta_quantile(1 - TAIL, mean, square), at_risk))
    return told


def _times_beta(mean: float, square: float, a: int, b: int) -> tuple[float, float]:
    """First and second moment of a quantity times an independent one of the beta distribution."""
    return mean * a / (a + b), square * a * (a + 1) / ((a + b) * (a + b + 1))


def _beta_quantile(share: float, mean: float, square: float) -> float:
    """The quantile of the beta distribution of these first two moments."""
    sum_of_both = (mean - square) / (square - mean * mean)
    a, b = mean * sum_of_both, (1 - mean) * sum_of_both
    low, high = 0.0, 1.0
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        below = float(arb(middle).beta_lower(arb(a), arb(b), regularized=True))
        low, high = (middle, high) if below < share else (low, middle)
    return (low + high) / 2


def proportion(count: int, total: int) -> tuple[float, float]:
    """The exact 95 % interval of a share (C. J. Clopper and E. S. Pearson, Biometrika 26 (1934), 404).

    >>> [round(end, 4) for end in proportion(8, 10)], [round(end, 4) for end in proportion(9, 9)]
    ([0.4439, 0.9748], [0.6637, 1.0])
    """
    below = _times_beta(1.0, 1.0, count, total - count + 1)
    above = _times_beta(1.0, 1.0, count + 1, total - count)
    return (
        _beta_quantile(TAIL, *below) if count else 0.0,
        _beta_quantile(1 - TAIL, *above) if count < total else 1.0,
    )


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
