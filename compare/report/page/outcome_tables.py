"""The outcomes of a comparison for the page: what changed, key by key; the rest folded."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...outcomes.outcome import room_of, same_outcome
from ..sentences import until_phrase

if TYPE_CHECKING:
    from ...candidate import Candidate
    from ...comparison import Comparison

SHOWN_ROWS = 400
"""Most rows of one outcome's table; the JSON has them all."""

OPEN_ROWS = 6
"""An outcome with at most so many rows is not folded."""

SHOWN_LETTERS = 300
"""Longest text of a cell; the JSON has it all."""

SAME, UNTOLD = "the same", "not settled"


@dataclass(frozen=True)
class OutcomeRow:
    """One value: the reference's, and each engine's as text."""

    key: str
    expected: str
    got: tuple[str, ...]


@dataclass(frozen=True)
class ChangedOutcome:
    """An outcome that some engine changed.

    Attributes:
        name: in words.
        rows: what differs.
        total: of how many values.
        summary: how much of it each engine changed.
    """

    name: str
    rows: tuple[OutcomeRow, ...]
    total: int
    summary: str

    @property
    def open(self) -> bool:
        """Whether it is short enough to be shown at once."""
        return len(self.rows) <= OPEN_ROWS


def changed(comparison: Comparison) -> list[ChangedOutcome]:
    """The outcomes that some engine changed, with those of their values that it changed."""
    told = [c for c in comparison.candidates if settled(c)]
    names = {**comparison.outcomes, **{name: None for c in told for name in c.changed}}
    return [_changed(comparison, name) for name in names if any(name in c.changed for c in told)]


def kept(comparison: Comparison) -> list[tuple[str, str]]:
    """Name and value of every outcome that no engine changed."""
    told = [c for c in comparison.candidates if settled(c)]
    return [
        (words(name), value_text(value))
        for name, value in comparison.outcomes.items()
        if not any(name in c.changed for c in told)
    ]


def settled(candidate: Candidate) -> bool:
    """Whether an engine's outcomes are told: of one that diverged and stopped early, up to there."""
    return candidate.verdict not in ("undecided", "unsettled")


def _changed(comparison: Comparison, name: str) -> ChangedOutcome:
    whole = _parts(comparison.outcomes.get(name))
    parts = [(_parts(c.expected.get(name)), _parts(c.outcomes.get(name))) for c in comparison.candidates]
    keys = list(dict.fromkeys(key for part in (whole, *(p for pair in parts for p in pair)) for key in part))
    rows: list[OutcomeRow] = []
    counts = [0] * len(parts)
    for key in keys:
        cells = []
        for number, (candidate, (mine, theirs)) in enumerate(zip(comparison.candidates, parts, strict=True)):
            cell = _cell(candidate, name, mine.get(key), theirs.get(key))
            counts[number] += cell not in (SAME, UNTOLD)
            cells.append(cell)
        if any(cell not in (SAME, UNTOLD) for cell in cells):
            rows.append(OutcomeRow(words(key), value_text(whole.get(key)), tuple(cells)))
    told = [
        f"{', '.join([candidate.engine, *filter(None, [until_phrase(candidate)])])}: changed {count:,} of {len(keys):,}"
        if candidate.until is not None
        else f"{candidate.engine} changed {count:,} of {len(keys):,}"
        for candidate, count in zip(comparison.candidates, counts, strict=True)
        if count
    ]
    summary = "; ".join(told) if len(keys) > 1 else ""
    return ChangedOutcome(words(name), tuple(rows[:SHOWN_ROWS]), len(keys), summary)


def _cell(candidate: Candidate, name: str, mine: Any, theirs: Any) -> str:
    """One engine's value beside the reference's over the same time."""
    same = same_outcome(mine, theirs, room_of(candidate.expected.get(name))) or _alike(mine, theirs)
    if not settled(candidate) or ((same or name not in candidate.changed) and not candidate.whole):
        return UNTOLD
    if same or name not in candidate.changed:
        return SAME
    told = _against(mine, theirs)
    return told if candidate.until is None else f"{told}, not {value_text(mine)}, up to t = {candidate.until:.9g}"


def _alike(mine: Any, theirs: Any) -> bool:
    """Whether two values read the same."""
    return value_text(mine) == value_text(theirs)


def _parts(value: Any) -> Mapping[str, Any]:
    """The values of an outcome by name; one that is a single value has no name."""
    return value if isinstance(value, Mapping) else {} if value is None else {"": value}


def _against(mine: Any, theirs: Any) -> str:
    """A changed value; of a list of names, what was added and what is missing."""
    if isinstance(mine, list) and isinstance(theirs, list) and all(isinstance(v, str) for v in [*mine, *theirs]):
        more, less = [v for v in theirs if v not in mine], [v for v in mine if v not in theirs]
        told = [f"also {', '.join(more)}"] * bool(more) + [f"not {', '.join(less)}"] * bool(less)
        if told:
            return _cut("; ".join(told))
    return value_text(theirs)


def words(name: str) -> str:
    """A name in words.

    >>> words("who_hit_whom")
    'who hit whom'
    """
    return name.replace("_", " ")


def value_text(value: Any) -> str:
    """A value of an outcome as a person reads it.

    >>> value_text({"met": ["a", "b"], "ended": "C2"}), value_text([0.25, -1.0]), value_text(True), value_text(None)
    ('met a, b; ended C2', '(0.25, -1)', 'yes', 'none')
    """
    if value is None:
        return "none"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, int):
        return f"{value:,}"
    if isinstance(value, Mapping):
        return _cut("; ".join(f"{words(str(key))} {value_text(item)}" for key, item in value.items()))
    if isinstance(value, list | tuple):
        if value and all(isinstance(item, float) for item in value):
            return f"({', '.join(value_text(item) for item in value)})"
        return _cut(", ".join(value_text(item) for item in value)) or "none"
    return _cut(str(value))


def _cut(text: str) -> str:
    return text if len(text) <= SHOWN_LETTERS else f"{text[:SHOWN_LETTERS]}…"
