"""What the rows of a sweep say together, by SQL: survival, shares with intervals, the law of the horizon, and the
final-state sensitivity exponent."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from flint import arb

from ...scenarios.numbers.quantity import Quantity
from .family_sweep import PERTURBED
from .row import Row
from .store import Store

Z_95 = 1.959963984540054
"""The normal distribution's two-sided 95 % quantile."""

TAIL = 0.025
"""What a 95 % interval leaves on either side."""

BISECTIONS = 52
"""Steps of a search in the interval from 0 to 1, at most: as many halves as doubles have."""

SETTLED = 2.0**-44
"""Step of a search, as a share of the place, by which it ends: the next one is of the size of its square."""


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
        median: the median divergence event; None if not so many have diverged.
        inside: of those that diverged and for which an interval was predicted, how many did inside it, and how many
            there are.
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


def stored(rows: Iterable[Row]) -> Store:
    """Rows as a store, to which questions can be put."""
    if isinstance(rows, Store):
        return rows
    store = Store(":memory:", {"grid": "rows"})
    for number, row in enumerate(rows):
        store.add(number, "", [row], 0.0)
    return store


COUNTED = ("engine", "laws.kept", "verdict", "event", "agreed", "predicted_low", "predicted_high", "changed")
"""What summaries count of a row."""

COUNTS = f"""
SELECT json_extract(row, {", ".join(f"'$.{key}'" for key in COUNTED)}), json_type(row, '$.laws') IS NOT NULL,
    json_extract(row, '$.by_exponent') IS NOT NULL FROM rows NOT INDEXED
"""
"""It, row by row, and whether it was audited and has an exponent: each is read as JSON once, and counted here, as SQL
would sort all rows to group them. The rows of a scene come in its engines' order, whichever scene is first."""

MEANS = """
SELECT avg(by_exponent), avg(at) FROM rows WHERE engine = ? AND event IS NOT NULL AND by_exponent IS NOT NULL
"""

SPREAD = """
SELECT sum((by_exponent - :x) * (by_exponent - :x)), sum((at - :y) * (at - :y)), sum((by_exponent - :x) * (at - :y))
FROM rows WHERE engine = :engine AND event IS NOT NULL AND by_exponent IS NOT NULL
"""


class _Counts:
    """What is counted of one engine's rows."""

    def __init__(self) -> None:
        self.seen, self.verdicts, self.audits = Counter[tuple[int, bool]](), Counter[str](), Counter[bool | None]()
        self.outcomes = self.changed = self.banded = self.inside = self.points = 0

    def add(
        self,
        count: int,
        audited: int,
        exponent: int,
        kept: bool | None,
        verdict: str,
        event: int | None,
        agreed: int | None,
        low: int | None,
        high: int | None,
        changed: list[str] | None,
    ) -> None:
        """Adds so many rows that are alike in all of this; `kept` is None where that is not determined."""
        self.verdicts[verdict] += count
        if audited:
            self.audits[kept] += count
        if verdict != "refused":
            self.seen[(agreed or 0) if event is None else event, event is not None] += count
        if changed is not None:
            self.outcomes += count
            self.changed += count * bool(changed)
        if event is not None and low is not None:
            self.banded += count
            self.inside += count * (low <= event and (high is None or event <= high))
        self.points += count * (exponent and event is not None)


def summaries(rows: Iterable[Row]) -> list[Summary]:
    """A summary of each engine, in the order of the engines."""
    store = stored(rows)
    told: dict[str, _Counts] = {}
    for (text, audited, exponent), count in store.counted(COUNTS).items():
        engine, *others = json.loads(text)
        told.setdefault(engine, _Counts()).add(count, audited, exponent, *others)
    found: list[Summary] = []
    for engine, counts in told.items():
        law = None
        if counts.points >= FEWEST:
            x, y = store.sql(MEANS, engine)[0]
            law = _law(counts.points, x, y, *store.base.execute(SPREAD, {"x": x, "y": y, "engine": engine}).fetchone())
        curve = kaplan_meier(counts.seen)
        changed, outcomes = counts.changed, counts.outcomes
        found.append(Summary(
            engine,
            dict(sorted(counts.verdicts.items())),
            tuple(curve),
            next((step.event for step in curve if step.share <= 0.5), None),
            (counts.inside, counts.banded),
            law,
            (changed, outcomes, *proportion(changed, outcomes)) if outcomes else None,
            (counts.audits[True], counts.audits[False], counts.audits[None]),
        ))  # fmt: skip
    return found


FEWEST = 3
"""Points, or sizes, for a line and the scatter about it."""


def survival(seen: Iterable[tuple[int, bool]]) -> list[Step]:
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
    return kaplan_meier(Counter(seen))


def kaplan_meier(counts: Mapping[tuple[int, bool], int]) -> list[Step]:
    """The same from how many scenes were watched up to an event, and left there or did not."""
    left = Counter[int]()
    watched = Counter[int]()
    for (event, gone), count in counts.items():
        watched[event] += count
        left[event] += count * gone
    steps: list[Step] = []
    share, mean, square, at_risk = 1.0, 1.0, 1.0, watched.total()
    for event in sorted(watched):
        gone, stay = left[event], at_risk - watched[event]
        if gone:
            share *= 1 - gone / at_risk
            mean, square = _times_beta(mean, square, at_risk - gone + 1, gone)
            low = _beta_quantile(TAIL, *_times_beta(mean, square, stay, 1)) if stay else 0.0
            steps.append(Step(event, share, low, _beta_quantile(1 - TAIL, mean, square), at_risk))
        at_risk = stay
    return steps


def _times_beta(mean: float, square: float, a: int, b: int) -> tuple[float, float]:
    """First and second moment of a quantity times an independent one of the beta distribution."""
    return mean * a / (a + b), square * a * (a + 1) / ((a + b) * (a + b + 1))


def _beta_quantile(share: float, mean: float, square: float) -> float:
    """The quantile of the beta distribution of these first two moments: Newton's steps from the mean, halves where one
    would leave what encloses it."""
    sum_of_both = (mean - square) / (square - mean * mean)
    a, b = mean * sum_of_both, (1 - mean) * sum_of_both
    log_size = math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b)
    low, high, x = 0.0, 1.0, mean
    near = mean + math.copysign(Z_95 * math.sqrt(square - mean * mean), share - 0.5)
    if mean / 2 < near < (1 + mean) / 2:  # of many, nearly normal: of 500,000 each step takes some milliseconds
        x = near
    for _ in range(BISECTIONS):
        below = float(arb(x).beta_lower(arb(a), arb(b), regularized=True))
        low, high = (x, high) if below < share else (low, x)
        slope = math.exp(log_size + (a - 1) * math.log(x) + (b - 1) * math.log1p(-x))
        step = (below - share) / slope if slope else math.inf
        if abs(step) <= SETTLED * x:
            return x - step
        x = x - step if low < x - step < high else (low + high) / 2
        if not 0.0 < x < 1.0:
            break
    return x


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
    """The line through (predicted, seen) times; None for fewer than three, or where all are predicted alike.

    >>> fitted([(1.0, 3.0), (2.0, 5.0), (3.0, 7.0)])
    Law(slope=2.0, intercept=1.0, correlation=1.0, scenes=3)
    """
    count = len(points)
    if count < FEWEST:
        return None
    mx, my = sum(x for x, _ in points) / count, sum(y for _, y in points) / count
    xx, yy = sum((x - mx) ** 2 for x, _ in points), sum((y - my) ** 2 for _, y in points)
    return _law(count, mx, my, xx, yy, sum((x - mx) * (y - my) for x, y in points))


def _law(count: int, mx: float, my: float, xx: float, yy: float, xy: float) -> Law | None:
    """From the means and the sums about them."""
    return None if xx == 0 or yy == 0 else Law(xy / xx, my - xy / xx * mx, xy / math.sqrt(xx * yy), count)


# -- the uncertainty exponent: how the share of scenes whose outcome a displacement changes falls with its size

SMALL = 0.5
"""The largest share that the line is drawn through: the law is one of small displacements, and where most scenes change
already, the share has no room to grow."""


@dataclass(frozen=True)
class ChangedShare:
    """Of `total` scenes, `count` have another outcome when displaced by up to `size`; the exact 95 % interval."""

    size: float
    count: int
    total: int
    low: float
    high: float


@dataclass(frozen=True)
class Uncertainty:
    """The exponent a of a share that goes as size**a.

    Near 1, an outcome is twice as safe for half the error; near 0, no accuracy helps: the boundary between outcomes
    fills nearly all of the space (of dimension D, it has D - a).

    Attributes:
        shares: for each size.
        exponent, low, high: of the line of ln(share) over ln(size), weighted by how well each share is known, with a
            95 % interval; None for fewer than three sizes with a share above none and up to `SMALL`.
    """

    shares: tuple[ChangedShare, ...]
    exponent: float | None
    low: float | None
    high: float | None


def uncertainty(rows: Iterable[Row], outcome: str) -> Uncertainty:
    """The shares and the exponent of one outcome, from a sweep with `perturb` and `outcomes`.

    Source: C. Grebogi, S. W. McDonald, E. Ott, J. A. Yorke, Final state sensitivity, Physics Letters A 99 (1983), 415.
    """
    asked = "SELECT engine, sum(instr(changed, ?) > 0), count(changed) FROM rows GROUP BY engine ORDER BY min(place)"
    shares = tuple(
        ChangedShare(float(Quantity.of(engine.removeprefix(PERTURBED))), count, total, *proportion(count, total))
        for engine, count, total in stored(rows).sql(asked, json.dumps(outcome))
        if engine.startswith(PERTURBED) and total
    )
    return Uncertainty(tuple(sorted(shares, key=lambda share: share.size)), *slope(shares))


def slope(shares: Sequence[ChangedShare]) -> tuple[float | None, float | None, float | None]:
    """The slope of ln(share) over ln(size), and its 95 % interval.

    The variance of ln(count/total) is 1/count - 1/total, to first order.

    >>> told = slope([ChangedShare(10.0**-k, round(10**6 * 10 ** (-k / 2)), 10**6, 0, 1) for k in (1, 2, 3, 4)])
    >>> round(told[0], 3), told[1] < 0.5 < told[2]
    (0.5, True)
    """
    points = [(math.log(s.size), math.log(s.count / s.total), 1 / (1 / s.count - 1 / s.total))
              for s in shares if 0 < s.count <= SMALL * s.total]  # fmt: skip
    if len(points) < FEWEST:
        return None, None, None
    weight = sum(w for *_, w in points)
    mx, my = sum(w * x for x, _, w in points) / weight, sum(w * y for _, y, w in points) / weight
    xx = sum(w * (x - mx) ** 2 for x, _, w in points)
    value = sum(w * (x - mx) * (y - my) for x, y, w in points) / xx
    room = Z_95 / math.sqrt(xx)
    return value, value - room, value + room
