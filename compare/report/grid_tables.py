"""Grids for people, on a terminal: suites, the survey, sweeps and stress maps; a stress map as JSON too."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Any, TypedDict

from ...scenarios.numbers.quantity import Quantity
from ..files.amounts import counted
from .output import console, grid, say

if TYPE_CHECKING:
    from ..grids.bounce_survey import Bounces, BounceSurvey
    from ..grids.engine_survey import Survey, SurveyEntry
    from ..grids.row import Row
    from ..grids.store import Store
    from ..grids.stress_map import Ladder, StressRow
    from ..grids.suite_file import Since, SuiteReport
    from ..grids.survival import Summary, Uncertainty
    from ..vectors.scores import Score

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


def print_restitution(found: BounceSurvey) -> None:
    """A row for each engine and restitution: what share of the energy its bounces leave, beside what is asked for."""
    from ..grids.bounce_survey import BOUNCES

    out = console()
    table = grid("engine", "e asked", "e^2 asked", "e^2 on a wall", "e^2 between two discs", "e^2 by heights", "missed")
    lines: dict[tuple[str, str], dict[str, Bounces]] = {}
    for row in found.rows:
        lines.setdefault((row.engine, row.asked), {})[row.contact] = row
    refused = dict.fromkeys((row.engine, row.refused) for row in found.rows if row.refused)
    for (name, asked), kinds in lines.items():
        if not all(row.refused for row in kinds.values()):
            square = float(Quantity.of(asked)) ** 2
            missed = sum(row.missed for row in kinds.values())
            table.add_row(name, asked, f"{square:.6g}", *map(_squared, kinds.values()), f"{missed or ''}")
    out.print(table)
    for name, why in refused:
        say(out, f"{name}: {why}")
    say(out, f"Each of {BOUNCES} bounces of a kind has another speed or height, and another phase of the time step.")


def _squared(row: Bounces) -> str:
    """Mean, and from where to where it goes if that shows; what is of rounding does not."""
    if row.mean is None or row.least is None or row.greatest is None:
        return "cannot" if row.refused else "no bounce"
    mean, least, greatest = (f"{number * number:.5g}" for number in (row.mean, row.least, row.greatest))
    return mean if least == greatest else f"{mean} ({least} to {greatest})"


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
    return "kept" if row.laws["kept"] else f"not kept: {row.laws['finding']}"


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


# -- sweeps


def print_sweep(
    settings: Mapping[str, Any], scenes: int, told: Sequence[Summary], unsure: Mapping[str, Uncertainty]
) -> None:
    """One row an engine, and a line for each outcome that displacements of several sizes change."""
    out = console()
    asked = " ".join([settings["scene"], *settings["vary"]])
    say(out, f"{asked}: {counted(scenes, 'scene')}, each compared with its certified run.", "bold")
    asked_for = any(summary.changed is not None for summary in told)
    audited = any(any(summary.laws) for summary in told)
    foreseen = settings["forecast"]
    last = [*["outcomes changed"] * asked_for, *["law"] * audited]
    predicted = ["in the 90 % interval", "t = a ln(1/eps)/lambda + b"] * foreseen
    table = grid("engine", "verdicts", "median divergence", *predicted, *last)
    for summary in told:
        inside, left = summary.inside
        law, changed = summary.law, summary.changed
        cells = [
            summary.engine,
            ", ".join(f"{count} {verdict}" for verdict, count in summary.verdicts.items()),
            "" if summary.median is None else f"event {summary.median}",
        ]
        if foreseen:
            cells.append(f"{inside} of {left}" if left else "")
            line = "" if law is None else f"a = {law.slope:.3f}, b = {law.intercept:.3g}, r = {law.correlation:.2f}"
            cells.append(line)
        if asked_for:
            cells.append(
                "" if changed is None else f"{changed[0]} of {changed[1]} (95 %: {changed[2]:.3f} to {changed[3]:.3f})"
            )
        if audited:
            words = zip(summary.laws, ("kept", "not kept", "not determined"), strict=True)
            cells.append(", ".join(f"{count} {word}" for count, word in words if count))
        table.add_row(*cells)
    out.print(table)
    for outcome, found in unsure.items():
        if found.exponent is not None:
            say(out, f"{outcome}: a displacement of up to d changes it in a share of scenes that goes as d**a, "
                     f"a = {found.exponent:.3f} (95 %: {found.low:.3f} to {found.high:.3f}).")  # fmt: skip


# -- stress maps


FEW = 6
"""Levels with gaps between them that a heading names one by one."""

STRESS_SCHEMA = "truebreak/stress-2"


Stretch = TypedDict("Stretch", {"mark": str, "from": int, "to": int})
"""One mark from one k to another, as far as k was tried."""


class LadderRow(TypedDict):
    """One engine on ever harder scenes of a family.

    Attributes:
        family: the family.
        side: on which side of the decision, or which variant, its scenes are.
        seed: of the family's parameters.
        engine: the engine.
        levels: the k that were tried.
        first_wrong: the first k at which it is wrong; null: none.
        right_again: larger k at which it is right.
        stretches: the marks, k by k.
    """

    family: str
    side: str
    seed: int
    engine: str
    levels: list[int]
    first_wrong: int | None
    right_again: list[int]
    stretches: list[Stretch]


class StressDocument(TypedDict):
    """Where on families of ever harder scenes each engine turns wrong.

    Attributes:
        settings: what the map is of: its grid, families, engines, levels (null, or first, last and step), whether it is
            a short one, and versions.
        exact: at how many places the exact engine was tried, at how many a closed form agrees, and how many bear each
            mark.
        ladders: engine by engine.
        rows: every place.
    """

    schema: str
    settings: dict[str, Any]
    exact: dict[str, int]
    ladders: list[LadderRow]
    rows: list[StressRow]


def stress_json(settings: Mapping[str, Any], rows: Iterable[Row], told: Sequence[Ladder]) -> StressDocument:
    """The object that `truebreak stress --json` prints: what was asked, where each engine turns wrong, and every row.

    Args:
        settings: what the map is of.
        rows: of its places, in order.
        told: the ladders of the rows.
    """
    from ..grids.stress_map import COLUMNS

    return {
        "schema": STRESS_SCHEMA,
        "settings": dict(settings),
        "exact": exact_counts(rows),
        "ladders": [_ladder(ladder) for ladder in told],
        "rows": [row.data(COLUMNS) for row in rows],
    }


def exact_counts(rows: Iterable[Row]) -> dict[str, int]:
    """At how many places the exact engine bears each mark, those that it bears at any, and to how many a closed form
    agrees.

    >>> from truebreak.compare.grids.row import Row
    >>> exact_counts([Row(0, "near-ties-left-1", "exact", "agree", mark="right", closed_form=True)])
    {'places': 1, 'closed_form': 1, 'right': 1}
    """
    exact = [row for row in rows if row.engine == "exact"]
    marks = [str(row.mark) for row in exact]
    counts = {mark: marks.count(mark) for mark in dict.fromkeys(marks)}
    return {"places": len(exact), "closed_form": sum(row.closed_form is True for row in exact), **counts}


def _ladder(ladder: Ladder) -> LadderRow:
    return {
        "family": ladder.family,
        "side": ladder.side,
        "seed": ladder.seed,
        "engine": ladder.engine,
        "levels": list(ladder.levels),
        "first_wrong": ladder.first_wrong,
        "right_again": list(ladder.right_again),
        "stretches": [{"mark": mark.value, "from": low, "to": high} for mark, low, high in ladder.stretches],
    }


def exact_sentence(rows: Iterable[Row]) -> str:
    """What the witnesses say of the exact engine, with nothing left out.

    >>> from truebreak.compare.grids.row import Row
    >>> exact_sentence([Row(0, "near-ties-left-1", "exact", "agree", mark="right")])
    'The exact engine: right at 1 of 1 places, each proved again by the independent checker.'
    """
    counts = exact_counts(rows)
    others = [f"{count} {mark}" for mark, count in counts.items() if mark not in ("places", "closed_form", "right")]
    told = f"The exact engine: right at {counts.get('right', 0)} of {counts['places']} places, each proved again by the"
    closed = f"; at {counts['closed_form']} of all a closed form agrees" if counts["closed_form"] else ""
    return f"{told} independent checker{closed}{'; ' + ', '.join(others) if others else ''}."


def print_stress(rows: Store, told: Sequence[Ladder]) -> None:
    """One table a family, a row for each engine and lane, a letter for each k, in tens."""
    from ..grids.stress_families import stress_family
    from ..grids.stress_map import MapMark, place_of

    out = console()
    for name, group in groupby(told, key=lambda ladder: ladder.family):
        lanes, one = list(group), stress_family(name)
        say(out, f"{name}: {one.summary} {one.grows}.", "bold")
        levels = lanes[0].levels
        every = len(levels) == levels[-1] - levels[0] + 1
        tried = f"{levels[0]} to {levels[-1]}" if every or len(levels) > FEW else ", ".join(map(str, levels))
        table = grid("engine", "scene", "wrong at", f"k = {tried}")
        for ladder in lanes:
            wrong = "" if ladder.first_wrong is None else ladder.first_words
            tens = [ladder.signs[k : k + 10] for k in range(0, len(ladder.signs), 10)]
            table.add_row(ladder.engine, ladder.lane, wrong, " ".join(tens))
        out.print(table)
    for mark in MapMark:
        say(out, f"{mark.sign}  {mark.meaning}")
    say(out, "")
    say(out, exact_sentence(rows), "bold")
    if len(rows):
        say(out, f"Any of the scenes: {place_of(rows[-1]).show} > scene.toml")
        say(out, "and then: truebreak compare scene.toml --engines ENGINE")


# -- scores of first meetings


def print_scores(found: Mapping[str, Sequence[Score]], *, verbose: bool) -> None:
    """A row for each engine or query; with `verbose` one for each thing and kind too."""
    out = console()
    headings = ("vectors", "meet", "refused", "false hits", "missed", "worst error", "us a query")
    first = ("engine", "thing", "kind") if verbose else ("engine",)
    table = grid(*first, *headings, right=headings)
    for name, rows in found.items():
        for n, row in enumerate(rows if verbose else rows[-1:]):
            worst = "" if row.worst is None else f"{row.worst:.2g}"
            place = (row.thing or "all", row.kind) if verbose else ()
            counts = (f"{n:,}" for n in (row.vectors, row.meet, row.refused, row.false_hits, row.missed))
            table.add_row("" if n else name, *place, *counts, worst, f"{row.microseconds:.3g}")
    out.print(table)
    say(out, "Errors are shares of the certified time. A query's time is processor time, this program's part included.")


def scores_json(found: Mapping[str, Sequence[Score]]) -> dict[str, Any]:
    """The same as plain data: a list of scores for each engine or query, the last for all vectors."""
    return {"scores": {name: [vars(row) for row in rows] for name, rows in found.items()}}
