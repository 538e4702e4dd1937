"""Reports of suites and of the survey on a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..report.output import console, grid, say

if TYPE_CHECKING:
    from .cell import Cell
    from .running import SuiteReport
    from .since import Since
    from .survey import Survey, SurveyEntry

WORDS = {"agree": "agrees", "diverged": "diverged", "unsettled": "not settled", "undecided": "undecided"}


def print_suite(report: SuiteReport, changes: Sequence[Since] | None) -> None:
    """A row for each cell, grouped by scene, and what changed."""
    out = console()
    table = grid(
        "scene", "engine", "verdict", "agreed", "differs at", "cause", "outcome", "energy", "law", whole=("verdict",)
    )
    scene = None
    for cell in report.cells:
        table.add_row("" if cell.scene == scene else cell.scene, cell.engine, *columns(cell))
        scene = cell.scene
    out.print(table)
    counts = {verdict: sum(cell.verdict == verdict for cell in report.cells) for verdict in WORDS}
    told = ", ".join(
        f"{count} {verdict.replace('unsettled', 'not settled')}" for verdict, count in counts.items() if count
    )
    broken = f"; in {report.lawless} the law is not kept" if report.lawless else ""
    say(out, f"{report.suite}: {len(report.cells)} comparisons: {told}{broken}.", "bold")
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
                for cell in entry.shown:
                    table.add_row(cell.engine, *columns(cell))
        out.print(table)
        for told in advice_sentence([entry for entry in found.entries if entry.label == label]):
            say(out, told)
    for name in found.missing:
        say(out, f"{name} is not installed: pip install '.[{name}]'")


def advice_sentence(entries: Sequence[SurveyEntry]) -> list[str]:
    """What is advised on one scene, and for which engines nothing is, in a sentence each."""
    asked = [entry.advice for entry in entries if entry.advice is not None]
    named = [f"`{one.setting}` ({one.told})" for one in asked if one.setting is not None]
    without = [f"`{one.engine}` ({one.told})" for one in asked if one.setting is None]
    told = [f"Advised: {'; '.join(named)}."] if named else []
    return [*told, f"No setting to advise: {'; '.join(without)}."] if without else told


def columns(cell: Cell) -> list[str]:
    """Verdict, events agreed, where it parts, why, what became of the outcomes, the energy gained, the law."""
    first = cell.divergence
    if cell.unable:
        return ["cannot", "", "", cell.stop.removeprefix("cannot run this scene: "), "", "", ""]
    if not cell.events:
        return [WORDS[cell.verdict], "", "", cell.stop, "", "", law(cell)]
    return [
        WORDS[cell.verdict],
        f"{cell.agreed:,} of {cell.events:,}",
        "" if first is None else parted(first),
        cell.cause or ("not looked for" if cell.verdict == "diverged" else ""),
        outcome(cell),
        "" if cell.drift is None else f"{cell.drift:.0e}",
        law(cell),
    ]


def law(cell: Cell) -> str:
    """Whether the law is kept, and what explains it if not."""
    if cell.laws is None:
        return ""
    if cell.laws["kept"] is None:
        return "not determined"
    return "kept" if cell.laws["kept"] else f"not kept: {cell.laws['told']}"


def outcome(cell: Cell) -> str:
    """Whether what the history comes to is right; not told of a run that ends before the span does."""
    if cell.verdict in ("unsettled", "undecided") or cell.until is not None:
        return "not told"
    return "wrong" if cell.changed else "right"


def parted(first: dict[str, object]) -> str:
    """Where a history parts, in a few words.

    >>> parted({"event": 24, "body": "c4", "expected": "top", "got": "c9"})
    'event 24: c4 meets c9, not top'
    """
    met = f"meets {first['got']}" if first["got"] else "meets nothing"
    return f"event {first['event']:,}: {first['body']} {met}" + (
        f", not {first['expected']}" if first["expected"] else ""
    )
