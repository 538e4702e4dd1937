"""A comparison as one HTML file that needs no network."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from ...scenarios.pictures import PICTURED_CIRCLES, scene_picture
from ...scenarios.scene import made_of
from ..causes.diagnosis import CauseName
from ..chaos.foreseen import foreseen
from ..outcomes.outcome import room_of, same_outcome
from ..picture import gap_values, moment_frames
from .answers import all_run, answers, cost_words, right_to, seen_words, subject, tone, verdict_line
from .charts import NARROW, WIDE, error_plot, error_words, predictions
from .orders_page import gallery
from .page import COMPARED, minimise_command, provenance, rendered
from .player import recording
from .sentences import (
    account_rows,
    counted,
    ended_phrase,
    pattern_phrase,
    proof_phrase,
    settled_phrase,
    short,
    span_phrase,
    until_phrase,
)
from .terminal import side_by_side

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ..alternatives import Alternative
    from ..candidate import Candidate
    from ..chaos.foreseen import Foreseen
    from ..comparison import Comparison


CANNOT_RUN = "cannot run this scene"


def foreseen_phrase(found: Foreseen | None, number: int) -> str:
    """Between which events the engine at a place is predicted to diverge; empty where nothing is predicted of it.

    >>> from truebreak.compare import compare
    >>> from truebreak.compare.chaos.foreseen import foreseen
    >>> from truebreak.scenarios import catalogue
    >>> found = foreseen(compare(catalogue.build("gas:n=4"), ["single", "quad"], events=60))
    >>> foreseen_phrase(found, 0)
    'predicted to diverge between event 25 and 32, half by 26'
    >>> foreseen_phrase(found, 1)
    'predicted to be right in the 60 events looked at'
    >>> near = foreseen(compare(catalogue.build("near-tie:k=40"), ["interval"]))
    >>> foreseen_phrase(near, 0)
    'predicted to diverge at event 0'
    """
    horizon = None if found is None else found.horizons[number]
    if found is None or horizon is None:
        return ""
    if horizon.low.event is None:
        return f"predicted to be right {seen_words(found.events)}"
    if horizon.high.event is None:
        half = f", half by {horizon.expected.event:,}" if horizon.expected.event else ""
        return f"predicted to diverge from event {horizon.low.event:,} on{half}"
    if horizon.low.event == horizon.high.event:
        return f"predicted to diverge at event {horizon.low.event:,}"
    return (
        f"predicted to diverge between event {horizon.low.event:,} and {horizon.high.event:,}, "
        f"half by {horizon.expected.event:,}"
    )


def not_foreseen_phrase(found: Foreseen | None) -> str:
    """Why the run is not looked at to its end, or not at all; empty where it is.

    >>> from truebreak.compare.chaos.foreseen import Foreseen
    >>> not_foreseen_phrase(Foreseen(7, 2.5, (), "the run turns back after 7 events"))
    'Predicted only so far: the run turns back after 7 events'
    >>> not_foreseen_phrase(Foreseen(0, 0.0, (), "a and b touch from the start on"))
    'Nothing is predicted: a and b touch from the start on'
    """
    if found is None or not found.reason:
        return ""
    return f"{'Predicted only so far' if found.events else 'Nothing is predicted'}: {found.reason}"


# ----------------------------------------
# The outcomes of a comparison for the page: what changed, key by key; the rest folded.

SHOWN_ROWS = 400
"""Most rows of one outcome's table; the JSON has them all."""

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
    def settled(self) -> list[int]:
        """Places of the engines of which some value here is settled."""
        return sorted({k for row in self.rows for k, cell in enumerate(row.got) if cell != UNTOLD})


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
    rooms = [room_of(c.expected.get(name)) for c in comparison.candidates]
    rows: list[OutcomeRow] = []
    counts = [0] * len(parts)
    for key in keys:
        cells = []
        for number, (candidate, (mine, theirs)) in enumerate(zip(comparison.candidates, parts, strict=True)):
            cell = _cell(candidate, name, mine.get(key), theirs.get(key), rooms[number])
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
    summary = "; ".join(told)
    if len(keys) == 1 and rows:
        named = zip(comparison.candidates, rows[0].got, strict=True)
        values = [f"{c.engine} {value}" for c, value in named if value not in (SAME, UNTOLD)]
        summary = f"{comparison.reference.engine} {rows[0].expected}; {', '.join(values)}"
    return ChangedOutcome(words(name), tuple(rows[:SHOWN_ROWS]), len(keys), summary)


def _cell(candidate: Candidate, name: str, mine: Any, theirs: Any, room: float) -> str:
    """One engine's value beside the reference's over the same time; equal are what differs by less than a room."""
    same = same_outcome(mine, theirs, room) or _alike(mine, theirs)
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
        named = ((words(str(key)), value_text(item)) for key, item in value.items())
        return _cut("; ".join(item if item.startswith(f"{key} ") else f"{key} {item}" for key, item in named))
    if isinstance(value, list | tuple):
        if value and all(isinstance(item, float) for item in value):
            return f"({', '.join(value_text(item) for item in value)})"
        return _cut(", ".join(value_text(item) for item in value)) or "none"
    return _cut(str(value))


def _cut(text: str) -> str:
    return text if len(text) <= SHOWN_LETTERS else f"{text[:SHOWN_LETTERS]}…"


# ----------------------------------------
# A comparison as one HTML file that needs no network.

ABOUT = {
    "Where": "The first event at which the engine's history is another than the reference's. Events are numbered from "
    "0, by the reference, everywhere on this page.",
    "Why": "What moved the number that decides this event, and how close it was. The account below adds up to the "
    "whole shift.",
    "So what": "What the divergence changed of the outcomes. The first value is the engine's, the second the "
    "reference's.",
    "What now": "What was run, and is right where the engine is not. A prediction is made from the exact run alone: "
    "nine in ten such engines are right at least so long.",
    "The moment": "Both runs just before the first divergence, at it, and after. Solid is the reference, dashed the "
    "engine; the circles in question are heavy, arrows are velocities.",
    "Error over time": "How far the circle farthest off is from its place: a straight rise on this logarithmic scale "
    "is chaos, and below the floor places as doubles show nothing. A dot is the first divergence; a band, where 90 in "
    "100 such engines diverge, as the exact run alone predicts.",
    "Engines": "Every engine that was compared, and the reference. Reordered are independent events in another order: "
    "they change nothing. Below, each engine unfolds: on a narrow screen one at a time, on paper all.",
    "The account": "What each kind of error adds to the number that decides, signed; the parts add up. Alone says "
    "whether this kind, and no other, changes the event.",
    "What was run in its place": "Other engines and settings on the same scene, and to which event they are right. "
    "Cost is a multiple of this engine's: in time steps for a finer step, else in processor time, measured once.",
    "Who meets whom": "The meetings of the circle that diverges, in both runs, row by row. The first row that differs "
    "is marked.",
    "Outcomes": "What the histories come to: counts, partners, velocities, patterns. Only what some engine changed is "
    "shown; the rest is folded.",
}
"""What the mark beside a heading says: two sentences each."""

SILENT = ("-", "0%", "no")


def html_report(comparison: Comparison, *, command: str = "") -> str:
    """The report as one page: verdict, the four answers, the moment, player, errors, engines, outcomes, provenance.

    Args:
        command: the command line that the comparison came from, to be told in the page.
    """
    comparison = _repeatable(comparison)
    horizons = foreseen(comparison)
    bands = predictions(comparison, horizons)
    lead = subject(comparison)
    said = answers(comparison, lead, horizons)
    blocks = [
        _block(comparison, number, candidate, horizons, lead)
        for number, candidate in enumerate(comparison.candidates)
        if candidate.verdict != "agree" or candidate.lawless
    ]
    return rendered(
        "report.html.jinja",
        recording=recording(comparison, horizons),
        engines=[candidate.engine for candidate in comparison.candidates],
        title=f"{comparison.scene.name}: truebreak",
        sentence=verdict_line(comparison),
        tone=tone(comparison),
        answers=said,
        about=ABOUT,
        warnings=_warnings(comparison),
        comparison=comparison,
        reference=comparison.reference,
        scene=comparison.scene,
        grounds=_facts(comparison),
        rows=[
            _row(comparison, number, candidate)
            | {"foreseen": CANNOT_RUN if candidate.unable else foreseen_phrase(horizons, number)}
            for number, candidate in enumerate(comparison.candidates)
        ],
        bands=bands,
        not_foreseen="" if horizons and horizons.reason in said.why else not_foreseen_phrase(horizons),
        returns=comparison.return_miss is not None,
        reference_miss=short(comparison.return_miss),
        plots=[Markup(error_plot(comparison, width, bands)) for width in (WIDE, NARROW)],
        picture=Markup(scene_picture(comparison.scene, across=340)) if _drawn(comparison) else "",
        blocks=sorted(blocks, key=lambda block: not block["lead"]),
        lead=next((block for block in blocks if block["lead"]), None),
        gallery=gallery(comparison),
        changed=changed(comparison),
        kept=kept(comparison),
        went_to_the_end=any(c.whole for c in comparison.candidates),
        provenance=provenance(comparison, command),
        player=COMPARED,
        footnote="Solid and blue: the reference.",
    )


def _repeatable(comparison: Comparison) -> Comparison:
    """Without what a machine measured, where a page is wanted that can be made again letter for letter."""
    if not os.environ.get("SOURCE_DATE_EPOCH", "").isdecimal():
        return comparison
    return replace(
        comparison,
        processor=0.0,
        candidates=tuple(replace(c, processor=0.0) for c in comparison.candidates),
        alternatives=tuple(replace(a, processor=0.0) for a in comparison.alternatives),
    )


def _drawn(comparison: Comparison) -> bool:
    return len(comparison.scene.circles) <= PICTURED_CIRCLES


def _facts(comparison: Comparison) -> list[tuple[str, str]]:
    reference, scene = comparison.reference, comparison.scene
    facts = [
        ("World", world_phrase(scene)),
        ("Reference", f"{reference.engine}, {counted(len(reference.events), 'event')}"),
        ("Compared", f"{span_phrase(comparison)}; {ended_phrase(reference)}"),
        ("Proof", proof_phrase(comparison)),
    ]
    if comparison.certificate is not None:
        facts.append(("Certificate", comparison.certificate.summary))
    if settled := settled_phrase(comparison):
        facts.append(("Settled", settled))
    return facts + [("Note", note) for note in reference.notes]


def world_phrase(scene: Scene) -> str:
    """What a scene is made of, and what acts in it beside collisions.

    >>> from truebreak.scenarios import catalogue
    >>> world_phrase(catalogue.build("bounce"))
    '1 circle, 1 wall; gravity (0, -10), restitution 9/10'
    """
    counts = {
        kind: sum(thing.moves for thing in things)
        for kind, things in (("wall", scene.walls), ("segment", scene.segments), ("polygon", scene.polygons))
    }
    acts = [
        f"gravity ({', '.join(part.brief() for part in scene.gravity)})" if scene.gravity is not None else "",
        f"restitution {scene.restitution.brief()}" if not scene.elastic else "",
        *(f"{counted(count, kind)} that move{'s' * (count == 1)}" if count else "" for kind, count in counts.items()),
    ]
    return "; ".join(filter(None, [made_of(scene), ", ".join(filter(None, acts))]))


def _warnings(comparison: Comparison) -> list[str]:
    """What a reader has to know before the answers are taken for whole."""
    found = [str(assumption) for assumption in comparison.reference.assumptions[:1]]
    return found + ([f"Left out, as the time was up: {', '.join(comparison.cut)}"] if comparison.cut else [])


def _row(comparison: Comparison, number: int, candidate: Candidate) -> dict[str, Any]:
    divergence = candidate.alignment.divergence
    return {
        "number": number,
        "engine": candidate.engine,
        "verdict": candidate.verdict,
        "law": "-"
        if candidate.laws is None or candidate.laws.kept is None
        else ("kept", "not kept")[candidate.lawless],
        "agreed": f"{candidate.alignment.agreed:,}",
        "event": f"{divergence.event:,}" if divergence else "",
        "cause": str(candidate.diagnosis) if candidate.diagnosis else "",
        "swaps": candidate.alignment.reordered,
        "error": error_words(comparison, candidate),
        "miss": short(candidate.return_miss),
        "linked": candidate.verdict != "agree" or candidate.lawless,
    }


def _block(
    comparison: Comparison, number: int, candidate: Candidate, horizons: Foreseen | None, lead: Candidate
) -> dict[str, Any]:
    """What the page says of an engine that does not agree."""
    divergence = candidate.alignment.divergence
    account = account_rows(candidate)
    told = [
        row for row in account if row[3] == "changes it" or (row[2] not in SILENT and not row[4].startswith("not "))
    ]
    drawn = _drawn(comparison) and divergence is not None
    pattern, said = pattern_phrase(comparison, candidate), answers(comparison, candidate, horizons)
    place = f"event {divergence.event:,}" if divergence else f"after {candidate.alignment.agreed:,} events"
    return {
        "number": number,
        "engine": candidate.engine,
        "verdict": candidate.verdict,
        "summary": f"{place}, {candidate.diagnosis}" if candidate.diagnosis else place,
        "lead": candidate is lead,
        "body": divergence.body if divergence else "",
        "event": f"{divergence.event:,}" if divergence else "",
        "answers": said,
        "law": candidate.laws.sentence if candidate.laws and not candidate.laws.kept else "",
        "frames": moment_frames(comparison.reference, candidate, number) if drawn else [],
        "gap": _gap_words(candidate),
        "rows": side_by_side(comparison, candidate) if divergence else [],
        "account": [row[:4] for row in told if row[1] != "-"],
        "runs": [(row[0], row[4]) for row in told if row[1] == "-" and row[4] not in said.why],
        "silent": [(row[0], row[4]) for row in account if row not in told and row[4] not in said.why],
        "pattern": pattern,
        "minimise": minimise_command(comparison, candidate)
        if divergence and not said.command.startswith("truebreak minimise")
        else None,
        "alternatives": [
            (a.engine, right_to(comparison, a).removeprefix("right "), _cost_cell(a, candidate))
            for a in all_run(comparison, candidate)
        ],
        "width": candidate.diagnosis is not None and candidate.diagnosis.name is CauseName["WIDTH"],
    }


def _cost_cell(alternative: Alternative, candidate: Candidate) -> str:
    """What it costs, under a heading that says beside which engine."""
    told = cost_words(alternative, candidate) or "not measured"
    short_told = told.removesuffix(f" the time of {candidate.engine}")
    return "about the same" if short_told == "about" else short_told


def _gap_words(candidate: Candidate) -> str:
    """The gap that decides, in both runs, in words."""
    values = gap_values(candidate)
    if values is None:
        return ""
    exact, own = values

    def said(value: float) -> str:
        return f"{value:+.3g} (a {'miss' if value > 0 else 'hit'})" if value else "exactly 0 (a touch)"

    told = f"exact {said(exact)}"
    return told if own is None else f"{told}, {candidate.engine} {said(own)}"
