"""A comparison as one HTML file that needs no network."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from ...scenarios.pictures import PICTURED_CIRCLES, scene_picture
from ..chaos.foreseen import foreseen
from .foreseen import foreseen_phrase, not_foreseen_phrase
from .page.outcome_tables import changed, kept
from .page.patterns import gallery
from .page.provenance import minimise_command, provenance
from .page.recording import recording
from .page.rendering import COMPARED, rendered
from .page.why import amounts, enough
from .pictures.picture import divergence_picture
from .pictures.plot import NARROW, WIDE, horizon_bands, separation_plot
from .sentences import (
    account_rows,
    consequence_phrase,
    counted,
    divergence_phrase,
    ended_phrase,
    margin_phrase,
    pattern_phrase,
    proof_phrase,
    short,
    span_phrase,
    verdict_sentence,
)
from .text.side_by_side import side_by_side

if TYPE_CHECKING:
    from ..candidate import Candidate
    from ..comparison import Comparison


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
        engines=len(comparison.candidates),
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
