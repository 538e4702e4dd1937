"""Whether a change of an engine changed a verdict, or a law kept: two runs, each judged against the reference."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..candidate import Candidate
    from ..comparison import Comparison


@dataclass(frozen=True)
class Change:
    """What became of the verdict from one candidate to another.

    Attributes:
        before, after: the names of the two.
        verdict: whether the verdict is another.
        laws: whether one is known to break a law, and the other is not.
        divergence: whether the first divergence is another: its event, its circle, or whom that meets.
        outcomes: the outcomes that differ between the two; none where the two are told over different times.
        sentence: all of that in words.
    """

    before: str
    after: str
    verdict: bool
    laws: bool
    divergence: bool
    outcomes: tuple[str, ...]
    sentence: str


def changes_of(comparison: Comparison, span: str = "") -> list[Change]:
    """The change from each candidate to the next; `span` says up to where they were judged, if not to their ends."""
    listed = comparison.candidates
    return [change(before, after, span) for before, after in pairwise(listed)]


def change(before: Candidate, after: Candidate, span: str = "") -> Change:
    """What became of the verdict, and of the laws kept, from one candidate to another, within a span."""
    verdict = before.verdict != after.verdict
    divergence = _place(before) != _place(after)
    laws = before.lawless != after.lawless
    agrees = before.verdict == after.verdict == "agree"
    names = sorted(
        name
        for name in before.outcomes.keys() | after.outcomes.keys()
        if not agrees and before.until == after.until and before.outcomes.get(name) != after.outcomes.get(name)
    )
    if verdict:
        told = f"The change changed the verdict: {_told(before)}, {_told(after)}."
    elif divergence:
        told = f"The change left the verdict, but not the first divergence: {_told(before)}, {_told(after)}."
    elif laws:
        told = "The change left the verdict, but not the law."
    else:
        where = f" at event {after.alignment.divergence.event}" if after.alignment.divergence else ""
        where += f", {span}" if span else ""
        told = f"The change changed no verdict: {before.engine} and {after.engine} both {_verb(after)}{where}."
    if laws:
        told += f" {_kept(before)}; {_kept(after)}."
    return Change(before.engine, after.engine, verdict, laws, divergence, tuple(names), told)


def _kept(candidate: Candidate) -> str:
    """What its audit says, without the first step where a description of all is at hand."""
    found = candidate.laws
    if found is None:
        return f"{candidate.engine} was not audited"
    if found.kept is False:
        return f"{candidate.engine} does not keep the law: {found.finding}"
    return f"{candidate.engine} {found.sentence}" if found.kept else f"{candidate.engine}: {found.sentence}"


def _place(candidate: Candidate) -> tuple[Any, ...] | None:
    first = candidate.alignment.divergence
    return None if first is None else (first.event, first.body, first.expected, first.got, first.kind)


VERBS = {"agree": "agree", "diverged": "diverge", "unsettled": "are not settled", "undecided": "are undecided"}


def _verb(candidate: Candidate) -> str:
    return VERBS[candidate.verdict]


def _told(candidate: Candidate) -> str:
    first = candidate.alignment.divergence
    word = {"agree": "agrees", "unsettled": "is not settled", "undecided": "is undecided"}.get(candidate.verdict)
    return f"{candidate.engine} {word}" if first is None else f"{candidate.engine} diverges at event {first.event}"
