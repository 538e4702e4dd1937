"""Two runs of a benchmark, ratio by ratio."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..computer import Idleness, computer
from .report import Report, idleness_of, rows_of

WITHIN = 0.15
"""Share by which a ratio may differ between two runs on one idle machine."""


@dataclass(frozen=True)
class RatioChange:
    """One ratio in both runs."""

    name: str
    then: float
    now: float

    @property
    def share(self) -> float:
        """By how much the greater is more than the less.

        >>> round(RatioChange("gas, double", 2.0, 1.6).share, 9)
        0.25
        """
        return max(self.then, self.now) / min(self.then, self.now) - 1.0

    @property
    def within(self) -> bool:
        """Whether the two are the same, for an idle machine."""
        return self.share <= WITHIN

    def __str__(self) -> str:
        return f"{self.name}: {self.then:.3g} then, {self.now:.3g} now ({self.now / self.then - 1:+.0%})"


@dataclass(frozen=True)
class Against:
    """One run held against an earlier one.

    Attributes:
        changes: every ratio that both have, the largest change first.
        missing: rows that were measured in one of the two alone.
        then, now: how idle the machine was.
        same: whether it was the same machine, as far as is told.
    """

    changes: tuple[RatioChange, ...]
    missing: tuple[str, ...]
    then: Idleness
    now: Idleness
    same: bool

    @property
    def beyond(self) -> tuple[RatioChange, ...]:
        """The ratios that differ by more than `WITHIN`."""
        return tuple(change for change in self.changes if not change.within)

    @property
    def told(self) -> bool:
        """Whether a difference says something: the same machine, idle both times."""
        return self.same and self.then.idle and self.now.idle

    def sentences(self) -> list[str]:
        """What came out."""
        count = len(self.changes)
        lines = [f"{count - len(self.beyond)} of {count} ratios agree within {WITHIN:.0%}."]
        if not count:
            lines = ["No ratio was measured both times: there is nothing to compare."]
        lines += [str(change) for change in self.beyond]
        if not self.beyond and self.changes:
            lines.append(f"The largest difference: {self.changes[0]}")
        lines += [f"Then: {self.then}", f"Now: {self.now}"]
        if not self.same:
            lines.append("It is another machine, or another Python: ratios may differ for that.")
        if self.beyond and not self.told and self.same:
            lines.append("As the machine was not idle, the differences say nothing of the engines.")
        if self.missing:
            lines.append(f"Measured in one of the two alone: {'; '.join(self.missing)}.")
        return lines


def against(report: Report, data: dict[str, Any]) -> Against:
    """Holds a report against the JSON of an earlier one, of the same scenes."""
    mine = {figure.name: figure.ratio for figure in report.figures}
    mine |= {row.name: row.ratio for row in report.tradeoffs if row.refused is None}
    theirs = {figure["name"]: figure["ratio"] for figure in data["figures"]}
    theirs |= {row.name: row.ratio for row in rows_of(data) if row.refused is None}
    changes = [RatioChange(name, theirs[name], mine[name]) for name in mine if theirs.get(name)]
    return Against(
        tuple(sorted(changes, key=lambda change: -change.share)),
        tuple(sorted(mine.keys() ^ theirs.keys())),
        idleness_of(data),
        report.idleness,
        data["machine"] == computer(),
    )
