"""A comparison on the terminal: one sentence, a table, the first divergence side by side."""

from __future__ import annotations

import math
import shlex
from dataclasses import dataclass
from itertools import zip_longest
from typing import TYPE_CHECKING

from ...exact.numbers import ball
from ...scenarios.numbers.quantity import real
from ..alignment.walk import history
from .answers import answers, scene_word, stopped, subject, tone, verdict_line
from .listing import LEAST_NORMAL, number
from .output import TextTable, Tinted, console, grid, say
from .sentences import (
    ACCOUNT,
    account_rows,
    consequence_phrase,
    counted,
    divergence_phrase,
    ended_phrase,
    ending_phrase,
    headline,
    law_phrase,
    listed,
    margin_phrase,
    pattern_phrase,
    proof_phrase,
    settled_phrase,
    short,
    span_phrase,
    until_phrase,
)

if TYPE_CHECKING:
    from ...scenarios.trajectory import Event, Trajectory
    from ..candidate import Candidate
    from ..comparison import Comparison

FORESEEN_WORK = 40_000
"""Events times circles along which the terminal predicts when its engine diverges: some tenths of a second."""

BITS = (256, 1_024, 4_096)
"""Bits to which two instants are known before they are called one: near-ties of the catalogue need up to 1,400."""


def later(before: Event, event: Event) -> str:
    """How much later an event is than another that has the same double for its time; empty where that is not known.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import catalogue
    >>> events = ExactEngine().run(catalogue.build("near-tie:k=40")).events
    >>> later(events[0], events[1])
    '5.00e-41'
    """
    for bits in BITS:
        with ball.precision(bits):
            apart = real(event.time).ball(bits) - real(before.time).ball(bits)
            if apart > 0:
                return apart.str(3, radius=False)
    return ""


# ----------------------------------------
# What one body meets in two runs around their first divergence, row by row.

BEFORE, AFTER = 2, 3
"""Meetings shown before and from the divergence on."""


@dataclass(frozen=True)
class MeetingRow:
    """One meeting of the body in each run.

    Attributes:
        expected_time, expected: the reference's time and partners; empty where it has none.
        got_time, got: the candidate's.
        differs: whether this is the first row that differs.
    """

    expected_time: str
    expected: str
    got_time: str
    got: str
    differs: bool


def side_by_side(comparison: Comparison, candidate: Candidate) -> list[MeetingRow]:
    """The meetings of the diverging body, from a little before the divergence."""
    divergence = candidate.alignment.divergence
    if divergence is None:
        return []
    mine = _meetings(comparison.reference, divergence.body)
    theirs = _meetings(candidate.trajectory, divergence.body)
    at_mine = _place(mine, divergence.expected_event if divergence.expected is not None else None)
    at_theirs = _place(theirs, divergence.candidate_event)
    if divergence.expected is None:
        at_mine = next((p for p, m in enumerate(mine) if m[0] >= divergence.expected_event), len(mine))
    if divergence.candidate_event is None:
        at_theirs = len(theirs)
    before_mine = mine[max(0, at_mine - BEFORE) : at_mine]
    before_theirs = theirs[max(0, at_theirs - BEFORE) : at_theirs]
    depth = max(len(before_mine), len(before_theirs))
    rows = [
        *zip(_padded(before_mine, depth), _padded(before_theirs, depth), strict=True),
        *zip_longest(mine[at_mine : at_mine + AFTER], theirs[at_theirs : at_theirs + AFTER]),
    ]
    return [
        MeetingRow(
            _when(comparison.reference, mine, a) if a else "",
            a[2] if a else "nothing more" if k == depth else "",
            _when(candidate.trajectory, theirs, b) if b else "",
            b[2] if b else "nothing more" if k == depth else "",
            k == depth,
        )
        for k, (a, b) in enumerate(rows)
    ]


def _when(run: Trajectory, meetings: list[tuple[int, float, str]], row: tuple[int, float, str]) -> str:
    """When a meeting is; after one at a time that reads the same, how much later, where that is known."""
    time, place = _told(run, row[0], row[1]), meetings.index(row)
    event, time_before, _ = meetings[place - 1] if place else (row[0], -1.0, "")
    if not place or _told(run, event, time_before) != time:
        return time
    apart = row[1] - time_before
    told = f"{apart:.3g}" if apart else later(run.events[event], run.events[row[0]])
    return f"{told} later" if told else time


def _told(run: Trajectory, event: int, time: float) -> str:
    """A time in twelve digits; "0" of what is proved to be zero alone."""
    return f"{time:.12g}" if LEAST_NORMAL <= time < math.inf else number(run.events[event].time, False)


def _meetings(trajectory: Trajectory, body: str) -> list[tuple[int, float, str]]:
    """(event, time, partners) of a body; partners of one instant joined by `+`."""
    seen = history(trajectory)
    return [(m.event, seen.times[m.event], " + ".join(m.partners)) for m in seen.meetings[body]]


def _place(meetings: list[tuple[int, float, str]], event: int | None) -> int:
    """The row of an event, or the end."""
    return next((p for p, m in enumerate(meetings) if m[0] == event), len(meetings))


def _padded(rows: list[tuple[int, float, str]], depth: int) -> list[tuple[int, float, str] | None]:
    return [*[None] * (depth - len(rows)), *rows]


# ----------------------------------------
# A comparison on the terminal: one sentence, a table, the first divergence side by side.

COLOURS = {"agree": "green", "diverged": "red", "unsettled": "yellow", "undecided": "yellow"}


def print_comparison(comparison: Comparison, *, verbose: bool = False, scene: str | None = None) -> None:
    """Prints the report of a comparison on stdout: the verdict, a table, and the four answers about one engine.

    Args:
        verbose: whether also each other divergence, the account of causes, and both histories side by side.
        scene: the scene as the command line has it; without it no command to go on with is given.
    """
    out, reference = console(), comparison.reference
    say(out, first_line(comparison), f"bold {COLOURS[tone(comparison)]}")
    ending = ending_phrase(reference)
    ended = f"; {ending}" if ending else f" ({ended_phrase(reference)})" if verbose else ""
    say(
        out,
        f"{comparison.scene.name}: {counted(len(reference.events), 'event')}, "
        f"{counted(reference.collisions, 'collision')} in the {reference.engine} run, "
        f"{span_phrase(comparison)}{ended}. {proof_phrase(comparison)}",
    )
    if comparison.certificate is not None:
        say(out, comparison.certificate.summary)
    if reference.assumptions:
        say(out, str(reference.assumptions[0]), "bold yellow")
    for note in reference.notes:
        say(out, note)
    if settled := settled_phrase(comparison):
        say(out, f"settled: {settled}")
    out.print(engines_table(comparison, close=not verbose))
    if comparison.cut:
        say(out, f"Left out, as the time was up: {listed([*comparison.cut])}.", "yellow")
    _print_answers(comparison, verbose, scene)
    if not verbose:
        return
    for told in filter(None, map(changed_text, comparison.candidates)):
        say(out, told)
    for candidate in comparison.candidates:
        if candidate.laws is not None and candidate.laws.kept is not True:
            colon = ":" if candidate.laws.kept is None else ""
            say(out, f"{candidate.engine}{colon} {candidate.laws.sentence}.", "bold red" if candidate.lawless else None)
    for candidate in comparison.candidates:
        if candidate.alignment.divergence is not None:
            _print_divergence(comparison, candidate)
        elif candidate.verdict == "undecided":
            say(out, f"{candidate.engine}: {candidate.trajectory.stop.message}")
            if candidate.diagnosis is not None:
                say(out, f"  cause: {candidate.diagnosis}: {candidate.diagnosis.finding}")


def first_line(comparison: Comparison) -> str:
    """The verdict in a line; other engines that do not keep the law are never left out."""
    first = headline(comparison)
    others = [c for c in comparison.candidates if c.lawless and not (c is first and c.by_law)] if first else []
    return verdict_line(comparison) + "".join(f" {c.engine} does not keep the law: {law_phrase(c)}." for c in others)


def _print_answers(comparison: Comparison, verbose: bool, scene: str | None) -> None:
    """Where, why, so what, what now; of an engine that agrees, what now alone, as the verdict says the rest."""
    lead = subject(comparison)
    agrees = lead.verdict == "agree" and not stopped(comparison, lead)
    ahead = None
    if not agrees:
        from ..chaos.foreseen import foreseen

        ahead = foreseen(comparison, FORESEEN_WORK)
    out, found = console(), answers(comparison, lead, ahead)
    for name, told in (("where", found.where), ("why", found.why), ("so what", found.so_what)):
        if not agrees or (name == "why" and lead.lawless):
            say(out, told, label=f"{name:<10}")
    then = "" if verbose else " -v shows more."
    if scene is not None:
        words = [scene if word == scene_word(comparison.scene) else word for word in shlex.split(found.command)]
        then = f" Try `{shlex.join(words)}`" + (f";{then}" if then else ".")
    say(out, f"{found.what_now}{then}", label=f"{'what now':<10}")


def engines_table(comparison: Comparison, *, close: bool = False) -> TextTable:
    """One row an engine; columns that are empty are left out."""
    reference, total = comparison.reference, len(comparison.reference.events)
    rows: list[list[str | Tinted]] = [
        [reference.engine, "reference", "", f"{total:,}", "", "", "", "", _miss(comparison.return_miss)]
    ]
    for candidate in comparison.candidates:
        divergence = candidate.alignment.divergence
        rows.append(
            [
                candidate.engine,
                Tinted(candidate.verdict, COLOURS[candidate.verdict]),
                law_cell(candidate),
                f"{candidate.alignment.agreed:,}",
                f"event {divergence.event:,}" if divergence else "",
                str(candidate.diagnosis) if candidate.diagnosis else "",
                f"{candidate.alignment.reordered:,}" if candidate.alignment.reordered else "",
                "" if candidate.unable else short(candidate.separation.maximum),
                _miss(candidate.return_miss),
            ]
        )
    shown = [k for k in range(len(HEADINGS)) if any(row[k] for row in rows)]
    headings = [HEADINGS[k] for k in shown]
    table = grid(*headings, whole=tuple({*headings} - {"engine", "cause"}), close=close)
    for row in rows:
        table.add_row(*(row[k] for k in shown))
    return table


HEADINGS = (
    "engine",
    "verdict",
    "law",
    "agreed",
    "differs at",
    "cause",
    "reordered",
    "position error",
    "misses start by",
)


def _miss(value: float | None) -> str:
    return "" if value is None else short(value)


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
