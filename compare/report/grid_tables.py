"""Suites and the survey for people, on a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from .output import console, grid, say

if TYPE_CHECKING:
    from ..grids.engine_survey import Survey, SurveyEntry
    from ..grids.row import Row
    from ..grids.suite_file import Since, SuiteReport

WORDS = {"agree": "agrees", "diverged": "diverged", "unsettled": "not settled", "undecided": "undecided",
         "refused": "cannot", "failed": "failed"}  # fmt: skip


def print_suite(report: SuiteReport, changes: Sequence[Since] | None) -> None:
    """A row for each cell, grouped by scene, and what changed."""
    out = console()
    table = grid(
        "scene", "engine", "verdict", "agreed", "differs at", "cause", "outcome", "energy", "law", whole=("verdict",)
    )
    scene = None
    for row in report.rows:
        table.add_row("" if row.scene == scene else row.scene, row.engine, *columns(row))
        scene = row.scene
    out.print(table)
    counts = {verdict: sum(row.verdict == verdict for row in report.rows) for verdict in WORDS}
    told = ", ".join(
        f"{count} {verdict.replace('unsettled', 'not settled')}" for verdict, count in counts.items() if count
    )
    broken = f"; in {report.lawless} the law is not kept" if report.lawless else ""
    say(out, f"{report.suite}: {len(report.rows)} comparisons: {told}{broken}.", "bold")
    if changes is not None:
        for change in changes:
            say(out, f"{change.sentence}.")
        say(out, f"Changed since the earlier report: {len(changes)}." if changes else "Nothing changed.", "bold")


def print_survey(found: Survey) -> None:
    """A table for each scene: each engine at the best of the settings tried, as it comes, and as is advised."""
    out = console()
    for label in dict.fromkeys(entry.label for entry in found.entries):
        table = grid("engine", "verdict", "agreed", "differs at", "cause", "outcome", "energy", "law", title=label)
        for entry in found.entries:
            if entry.label == label:
                for row in entry.shown:
                    table.add_row(row.engine, *columns(row))
        out.print(table)
        for told in advice_sentence([entry for entry in found.entries if entry.label == label]):
            say(out, told)
    for name in found.missing:
        say(out, f"{name} is not installed: pip install '.[{name}]'")


def advice_sentence(entries: Sequence[SurveyEntry]) -> list[str]:
    """What is advised on one scene, and for which engines nothing is, in a sentence each."""
    rows = [entry.advice for entry in entries if entry.advice is not None]
    named = [f"`{row.engine}` ({row.note})" for row in rows if row.right]
    without = [f"`{row.engine.partition(':')[0]}` ({row.note})" for row in rows if not row.right]
    told = [f"Advised: {'; '.join(named)}."] if named else []
    return [*told, f"No setting to advise: {'; '.join(without)}."] if without else told


def columns(row: Row) -> list[str]:
    """Verdict, events agreed, where it diverges, why, what became of the outcomes, the energy gained, the law."""
    if row.verdict == "refused":
        return ["cannot", "", "", str(row.ended).removeprefix("cannot run this scene: "), "", "", ""]
    if not row.events:
        return [WORDS[row.verdict], "", "", row.note or row.ended or "", "", "", law(row)]
    return [
        WORDS[row.verdict],
        f"{row.agreed:,} of {row.events:,}",
        differs(row),
        row.cause or ("not looked for" if row.verdict == "diverged" else ""),
        outcome_words(row),
        "" if row.drift is None else f"{row.drift:.0e}",
        law(row),
    ]


def law(row: Row) -> str:
    """Whether the law is kept, and what explains it if not."""
    if row.laws is None:
        return ""
    if row.laws["kept"] is None:
        return "not determined"
    return "kept" if row.laws["kept"] else f"not kept: {row.laws['told']}"


def outcome_words(row: Row) -> str:
    """Whether the outcomes are right; not known of a run that ends before the span does."""
    if row.verdict not in ("agree", "diverged") or row.until is not None:
        return "not known"
    return "wrong" if row.changed else "right"


def differs(row: Row) -> str:
    """Where a history diverges, in a few words.

    >>> from truebreak.compare.grids.row import Row
    >>> differs(Row(0, "gas", "double", "diverged", event=24, body="c4", expected="top", got="c9"))
    'event 24: c4 meets c9, not top'
    """
    if row.event is None:
        return ""
    met = f"meets {row.got}" if row.got else "meets nothing"
    return f"event {row.event:,}: {row.body} {met}" + (f", not {row.expected}" if row.expected else "")
