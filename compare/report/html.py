"""A comparison as one HTML file that needs no network."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from ...scenarios.pictures import PICTURED_CIRCLES, scene_picture
from ..chaos.foreseen import foreseen
from ..outcomes.outcome import room_of, same_outcome
from ..picture import divergence_picture
from .orders_page import gallery
from .page import COMPARED, minimise_command, provenance, rendered
from .player import recording
from .plot import NARROW, WIDE, horizon_bands, separation_plot
from .sentences import (
    about,
    account_rows,
    consequence_phrase,
    counted,
    divergence_phrase,
    ended_phrase,
    margin_phrase,
    middle,
    off,
    pattern_phrase,
    proof_phrase,
    short,
    span_phrase,
    until_phrase,
    verdict_sentence,
)
from .terminal import side_by_side

if TYPE_CHECKING:
    from ..candidate import Candidate
    from ..chaos.foreseen import Foreseen
    from ..comparison import Comparison


def foreseen_phrase(found: Foreseen | None, number: int) -> str:
    """Between which events the engine at a place was to be expected to leave; empty where nothing is foreseen of it.

    >>> from truebreak.compare import compare
    >>> from truebreak.compare.chaos.foreseen import foreseen
    >>> from truebreak.scenarios import catalogue
    >>> found = foreseen(compare(catalogue.build("gas:n=4"), ["single", "quad"], events=60))
    >>> foreseen_phrase(found, 0)
    'foreseen to leave between event 25 and event 33, half of such engines by event 26'
    >>> foreseen_phrase(found, 1)
    'foreseen to keep the history in the 60 events looked at, by the growth of errors alone'
    >>> near = foreseen(compare(catalogue.build("near-tie:k=40"), ["interval"]))
    >>> foreseen_phrase(near, 0)
    'foreseen to leave at event 0'
    """
    horizon = None if found is None else found.horizons[number]
    if found is None or horizon is None:
        return ""
    if horizon.low.event is None:
        return f"foreseen to keep the history in the {found.events:,} events looked at, by the growth of errors alone"
    if horizon.high.event is None:
        half = "" if horizon.expected.event is None else f", half of such engines by event {horizon.expected.event:,}"
        return f"foreseen to leave from event {horizon.low.event:,} on{half}"
    if horizon.low.event == horizon.high.event:
        return f"foreseen to leave at event {horizon.low.event:,}"
    return (
        f"foreseen to leave between event {horizon.low.event:,} and event {horizon.high.event:,}, "
        f"half of such engines by event {horizon.expected.event:,}"
    )


def not_foreseen_phrase(found: Foreseen | None) -> str:
    """Why the run is not looked at to its end, or not at all; empty where it is.

    >>> from truebreak.compare.chaos.foreseen import Foreseen
    >>> not_foreseen_phrase(Foreseen(7, 2.5, (), "the run turns back after 7 events"))
    'Foreseen only so far: the run turns back after 7 events'
    >>> not_foreseen_phrase(Foreseen(0, 0.0, (), "a and b touch from the start on"))
    'No horizon is foreseen: a and b touch from the start on'
    """
    if found is None or not found.reason:
        return ""
    return f"{'Foreseen only so far' if found.events else 'No horizon is foreseen'}: {found.reason}"


# ----------------------------------------
# Why an engine left: how close the decision was beside how far off it was, and what would have been enough.

LINEAR, LEAST_SHARE, DECADES = 100.0, 0.02, 20
"""Ratio up to which bars are to scale, and go by powers of ten beyond; length of the shortest, as a share of the
longest; and the most powers of ten that they span."""


@dataclass(frozen=True)
class Amount:
    """One amount with a bar, on a scale that it shares with the others.

    Attributes:
        name: what it is.
        text: its value in words.
        share: length of its bar, from 0 to 1, by `shares`; 0 for none.
        own: whether it is the engine's, not the decision's.
    """

    name: str
    text: str
    share: float
    own: bool = False


def amounts(candidate: Candidate) -> list[Amount]:
    """The margin of the decision beside the engine's error by then.

    Empty where one of them is not known.
    """
    margin = candidate.margin
    if margin is None or margin.distance is None or margin.error is None:
        return []
    close, far = shares(abs(middle(margin.distance)), margin.error)
    told = "exactly 0" if margin.distance == (0.0, 0.0) else about(margin.distance)
    name = "how close it was" if margin.gap is None else "how close it was, as a distance"
    return [
        Amount(name, told, close),
        Amount(f"how far off {candidate.engine} was by then", off(margin.error), far, own=True),
    ]


def shares(*values: float) -> list[float]:
    """Lengths of bars: to scale, or by powers of ten where that would leave one too short to be seen.

    >>> shares(1.0, 2.0), shares(1e-10, 1.0), shares(0.0, 3.0)
    ([0.5, 1.0], [0.02, 1.0], [0.0, 1.0])
    """
    sizes = [value for value in values if value > 0 and math.isfinite(value)]
    if not sizes:
        return [0.0 for _ in values]
    top = max(sizes)
    low = max(min(sizes), top * 10.0**-DECADES)
    if top / low <= LINEAR:
        return [value / top if value in sizes else 0.0 for value in values]
    powers = math.log(top / low)
    return [
        LEAST_SHARE + (1 - LEAST_SHARE) * math.log(max(value, low) / low) / powers if value in sizes else 0.0
        for value in values
    ]


def enough(candidate: Candidate) -> list[tuple[str, str]]:
    """What would have been enough: bits by the growth of errors, and the settings that were run."""
    rows: list[tuple[str, str]] = []
    margin, divergence = candidate.margin, candidate.alignment.divergence
    if margin is not None and divergence is not None and not candidate.stepped:
        foreseen = foreseen_bits(margin.growth, divergence.expected_event, margin.distance, candidate.separation.scale)
        if foreseen is not None:
            told = f"about {foreseen:,}: {margin.growth:.3g} bits an event over {divergence.expected_event:,} events"
            rows.append(("bits, foreseen", told))
    if candidate.diagnosis is not None:
        rows += [(e.cause.value, e.result) for e in candidate.diagnosis.experiments if e.cause.entry.settings]
    return rows


def foreseen_bits(growth: float | None, events: int, distance: tuple[float, float] | None, scale: float) -> int | None:
    """Bits with which a rounding at the start would not have grown to the margin by the decision.

    A rounding of 2**-bits of the scene's size grows by `growth` bits at each of the `events`; it stays below the margin
    if bits > growth * events + log2(scale / margin). None where any of it is not known.

    >>> foreseen_bits(0.325, 161, (0.0395, 0.0397), 20.0)
    62
    """
    if growth is None or growth <= 0 or distance is None or not scale > 0:
        return None
    close = abs(middle(distance))
    if close == 0:
        return None
    return max(1, math.ceil(growth * events + math.log2(scale / close)))


# ----------------------------------------
# The outcomes of a comparison for the page: what changed, key by key; the rest folded.

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


# ----------------------------------------
# A comparison as one HTML file that needs no network.


def html_report(comparison: Comparison, *, command: str = "") -> str:
    """The report as one page: verdict, player, engines, why each of them left, outcomes, provenance.

    Args:
        command: the command line that the comparison came from, to be told in the page.
    """
    reference = comparison.reference
    horizons = foreseen(comparison)
    bands = horizon_bands(comparison, horizons)
    return rendered(
        "report.html.jinja",
        recording=recording(comparison),
        engines=[candidate.engine for candidate in comparison.candidates],
        title=f"{comparison.scene.name}: truebreak",
        sentence=verdict_sentence(comparison),
        comparison=comparison,
        lawless=any(candidate.lawless for candidate in comparison.candidates),
        reference=reference,
        scene=comparison.scene,
        facts=_facts(comparison),
        rows=[
            _row(number, candidate) | {"foreseen": foreseen_phrase(horizons, number)}
            for number, candidate in enumerate(comparison.candidates)
        ],
        bands=bands,
        not_foreseen=not_foreseen_phrase(horizons),
        returns=comparison.return_miss is not None,
        reference_miss=short(comparison.return_miss),
        plots=[Markup(separation_plot(comparison, width, bands)) for width in (WIDE, NARROW)],
        picture=Markup(scene_picture(comparison.scene)) if _drawn(comparison) else "",
        divergences=[
            _divergence(comparison, number, c)
            for number, c in enumerate(comparison.candidates)
            if c.alignment.divergence
        ],
        gallery=gallery(comparison),
        changed=changed(comparison),
        kept=kept(comparison),
        went_to_the_end=any(c.whole for c in comparison.candidates),
        provenance=provenance(comparison, command),
        player=COMPARED,
        footnote="Solid and blue: the reference.",
    )


def _drawn(comparison: Comparison) -> bool:
    return len(comparison.scene.circles) <= PICTURED_CIRCLES


def _facts(comparison: Comparison) -> list[tuple[str, str]]:
    reference, scene = comparison.reference, comparison.scene
    things = [counted(len(scene.circles), "circle"), counted(len(scene.walls), "wall")]
    if scene.pockets:
        things.append(counted(len(scene.pockets), "pocket"))
    facts = [
        ("Scene", f"{scene.name} ({', '.join(things)})"),
        (
            "Reference",
            f"{reference.engine}: {counted(len(reference.events), 'event')}, "
            f"{counted(reference.collisions, 'collision')}",
        ),
        ("Compared", f"{span_phrase(comparison)}; {ended_phrase(reference)}"),
        ("Proof", proof_phrase(comparison)),
    ]
    if comparison.certificate is not None:
        facts.append(("Certificate", comparison.certificate.told))
    facts += [("Not proved", str(assumption)) for assumption in reference.assumptions[:1]]
    facts += [("Note", note) for note in reference.notes]
    if comparison.cut:
        facts.append(("Left out", f"{', '.join(comparison.cut)}: the time was up"))
    return facts


def _row(number: int, candidate: Candidate) -> dict[str, Any]:
    divergence = candidate.alignment.divergence
    return {
        "number": number,
        "engine": candidate.engine,
        "verdict": candidate.verdict,
        **_law(candidate),
        "agreed": f"{candidate.alignment.agreed:,}",
        "event": f"{divergence.event:,}" if divergence else "",
        "differs": f"event {divergence.event:,}, t = {divergence.time:.9g}" if divergence else "",
        "cause": str(candidate.diagnosis) if candidate.diagnosis else "",
        "finding": candidate.diagnosis.finding if candidate.diagnosis else "",
        "swaps": candidate.alignment.harmless_swaps,
        "error": short(candidate.separation.maximum),
        "miss": short(candidate.return_miss),
        "stop": candidate.trajectory.stop.message,
    }


def _law(candidate: Candidate) -> dict[str, str]:
    """Whether an engine keeps the law, in a sentence."""
    laws = candidate.laws
    if laws is None:
        return {"law_told": ""}
    return {"law_told": laws.sentence}


def _divergence(comparison: Comparison, number: int, candidate: Candidate) -> dict[str, Any]:
    return {
        "number": number,
        "engine": candidate.engine,
        "phrase": divergence_phrase(comparison, candidate),
        "body": candidate.alignment.divergence.body if candidate.alignment.divergence else "",
        "cause": str(candidate.diagnosis) if candidate.diagnosis else "",
        "finding": sentence_case(candidate.diagnosis.finding) if candidate.diagnosis else "",
        "pattern": pattern_phrase(comparison, candidate),
        "consequence": sentence_case(consequence_phrase(comparison, candidate) or ""),
        "margin": sentence_case(margin_phrase(candidate) or ""),
        "amounts": amounts(candidate),
        "enough": enough(candidate),
        "experiments": account_rows(candidate),
        "minimise": minimise_command(comparison, candidate),
        "rows": side_by_side(comparison, candidate),
        "picture": Markup(divergence_picture(comparison.reference, candidate, number)) if _drawn(comparison) else "",
    }


def sentence_case(text: str) -> str:
    """The text with a capital first letter.

    >>> sentence_case("with a step")
    'With a step'
    """
    return text[:1].upper() + text[1:]
