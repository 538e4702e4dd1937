"""A comparison on the terminal: one sentence, a table, the first divergence side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..sentences import (
    ACCOUNT,
    account_rows,
    consequence_phrase,
    counted,
    divergence_phrase,
    ended_phrase,
    listed,
    margin_phrase,
    other_lines,
    pattern_phrase,
    proof_phrase,
    short,
    span_phrase,
    until_phrase,
    verdict_sentence,
)
from .output import TextTable, Tinted, console, grid, say
from .side_by_side import side_by_side

if TYPE_CHECKING:
    from ...candidate import Candidate
    from ...comparison import Comparison

COLOURS = {"agree": "green", "diverged": "red", "unsettled": "yellow", "undecided": "yellow"}


def print_comparison(comparison: Comparison) -> None:
    """Prints the report of a comparison on stdout."""

    out = console()
    lawless = any(candidate.lawless for candidate in comparison.candidates)
    colour = "red" if lawless else COLOURS[comparison.verdict]
    say(out, verdict_sentence(comparison), f"bold {colour}")
    for line in other_lines(comparison):
        say(out, line)
    reference = comparison.reference
    say(
        out,
        f"{comparison.scene.name}: {counted(len(reference.events), 'event')}, "
        f"{counted(reference.collisions, 'collision')} in the {reference.engine} run, "
        f"{span_phrase(comparison)} ({ended_phrase(reference)}). {proof_phrase(comparison)}",
    )
    if comparison.certificate is not None:
        say(out, comparison.certificate.told)
    if reference.assumptions:
        say(out, str(reference.assumptions[0]), "bold yellow")
    for note in reference.notes:
        say(out, note)
    out.print(engines_table(comparison))
    for told in filter(None, map(changed_text, comparison.candidates)):
        say(out, told)
    for candidate in comparison.candidates:
        if candidate.laws is not None and candidate.laws.kept is not True:
            say(out, f"{candidate.engine} {candidate.laws.sentence}.", "bold red" if candidate.lawless else None)
    if comparison.cut:
        say(out, f"Left out, as the time was up: {listed([*comparison.cut])}.", "yellow")
    for candidate in comparison.candidates:
        if candidate.alignment.divergence is not None:
            _print_divergence(comparison, candidate)
        elif candidate.verdict == "undecided":
            say(out, f"{candidate.engine}: {candidate.trajectory.stop.message}")
            if candidate.diagnosis is not None:
                say(out, f"  cause: {candidate.diagnosis}: {candidate.diagnosis.finding}")


def engines_table(comparison: Comparison) -> TextTable:
    """One row an engine; a column for the return only after a reversal."""
    returns = comparison.return_miss is not None or any(c.return_miss is not None for c in comparison.candidates)
    headings = [
        "engine",
        "verdict",
        "law",
        "agreed",
        "differs at",
        "cause",
        "swaps",
        "position\nerror",
        *(["misses\nstart by"] if returns else []),
    ]
    table = grid(*headings, whole=tuple({*headings} - {"engine", "cause"}))
    total = len(comparison.reference.events)
    reference = [comparison.reference.engine, "reference", "", f"{total:,}", "", "", "", ""]
    table.add_row(*reference, *([short(comparison.return_miss)] if returns else []))
    for candidate in comparison.candidates:
        colour = COLOURS[candidate.verdict]
        divergence = candidate.alignment.divergence
        cells = [
            candidate.engine,
            Tinted(candidate.verdict, colour),
            law_cell(candidate),
            f"{candidate.alignment.agreed:,}",
            f"event {divergence.event:,}" if divergence else "",
            str(candidate.diagnosis) if candidate.diagnosis else "",
            str(candidate.alignment.harmless_swaps),
            short(candidate.separation.maximum),
        ]
        table.add_row(*cells, *([short(candidate.return_miss)] if returns else []))
    return table


def law_cell(candidate: Candidate) -> Tinted | str:
    """Whether an engine keeps the law; a dash where that is not determined."""
    if candidate.laws is None or candidate.laws.kept is None:
        return "-"
    return Tinted("kept", "green") if candidate.laws.kept else Tinted("not kept", "red")


def changed_text(candidate: Candidate) -> str:
    """The outcomes that an engine changed, in a sentence; of one that diverged and stopped early, up to there."""
    if candidate.verdict in ("undecided", "unsettled") or not (candidate.changed or candidate.until is not None):
        return ""
    names, until = listed([name.replace("_", " ") for name in candidate.changed]), until_phrase(candidate)
    if until is None:
        return f"{candidate.engine} changed: {names}"
    told = f"changed: {names}" if candidate.changed else "no outcome is seen to be changed"
    return f"{candidate.engine}, {until}: {told}; what lies beyond is not settled"


def _print_divergence(comparison: Comparison, candidate: Candidate) -> None:
    out = console()
    divergence = candidate.alignment.divergence
    assert divergence is not None
    say(out, divergence_phrase(comparison, candidate), "bold")
    if candidate.diagnosis is not None:
        say(out, f"  cause: {candidate.diagnosis}: {candidate.diagnosis.finding}")
        also = [cause.value for cause in candidate.diagnosis.sufficient if cause is not candidate.diagnosis.name]
        if also:
            say(out, f"  suffices by itself too: {listed(also)}")
    pattern = pattern_phrase(comparison, candidate)
    if pattern is not None:
        say(out, f"  whom each circle meets, and where it ends: {pattern}")
    consequence = consequence_phrase(comparison, candidate)
    if consequence is not None:
        say(out, f"  consequence: {consequence}")
    close = margin_phrase(candidate)
    if close is not None:
        say(out, f"  margin: {close}")
    rows = account_rows(candidate)
    if rows:
        experiments = grid(*ACCOUNT, whole=ACCOUNT[1:4])
        for cells in rows:
            experiments.add_row(*cells)
        out.print(experiments)
    names = comparison.reference.engine, candidate.engine
    table = grid(
        "", *(f"{name}{what}" for name in names for what in (" time", f": {divergence.body} meets")), whole=("",)
    )
    for row in side_by_side(comparison, candidate):
        style = "bold red" if row.differs else None
        cells = ("->" if row.differs else "", row.expected_time, row.expected, row.got_time, row.got)
        table.add_row(*cells, style=style)
    out.print(table)
