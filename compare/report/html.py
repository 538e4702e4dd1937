"""A comparison as one HTML file that needs no network."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import jinja2
from markupsafe import Markup

from .picture import STYLE, divergence_picture, scene_picture
from .plot import separation_plot
from .sentences import (
    consequence_phrase,
    counted,
    divergence_phrase,
    experiment_rows,
    margin_phrase,
    pattern_phrase,
    proof_phrase,
    short,
    span_phrase,
    verdict_sentence,
)
from .side_by_side import side_by_side

if TYPE_CHECKING:
    from ..candidate import Candidate
    from ..comparison import Comparison

PICTURED_CIRCLES = 500
"""A scene of more circles is not drawn at a divergence: the picture would say nothing."""


def html_report(comparison: Comparison) -> str:
    """The report: verdict, table, separation over time, and each first divergence with a picture."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader(__package__ or "", ""),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    reference = comparison.reference
    return environment.get_template("report.html.jinja").render(
        title=f"{comparison.scene.name}: truebreak",
        sentence=verdict_sentence(comparison),
        comparison=comparison,
        reference=reference,
        scene=comparison.scene,
        facts=_facts(comparison),
        rows=[_row(candidate) for candidate in comparison.candidates],
        returns=comparison.return_miss is not None,
        reference_miss=short(comparison.return_miss),
        plot=Markup(separation_plot(comparison)),
        picture=Markup(scene_picture(comparison.scene)),
        divergences=[_divergence(comparison, c) for c in comparison.candidates if c.alignment.divergence],
        outcomes=_outcomes(comparison),
        style=Markup(STYLE),
    )


def _facts(comparison: Comparison) -> list[tuple[str, str]]:
    reference, scene = comparison.reference, comparison.scene
    facts = [
        (
            "Scene",
            f"{scene.name} ({counted(len(scene.circles), 'circle')}, {counted(len(scene.walls), 'wall')})",
        ),
        (
            "Reference",
            f"{reference.engine}: {counted(len(reference.events), 'event')}, "
            f"{counted(reference.collisions, 'collision')}",
        ),
        ("Compared", f"{span_phrase(comparison)}; {reference.stop.message}"),
        ("Proof", proof_phrase(comparison)),
        ("Tie policy", str(scene.tie_policy)),
        ("Scene digest", scene.digest),
    ]
    if comparison.certificate is not None:
        facts.append(("Certificate", comparison.certificate.told))
    facts += [("Not proved", str(assumption)) for assumption in reference.assumptions[:1]]
    facts += [("Note", note) for note in reference.notes]
    if scene.source:
        facts.append(("Source", scene.source))
    return facts


def _row(candidate: Candidate) -> dict[str, Any]:
    divergence = candidate.alignment.divergence
    return {
        "engine": candidate.engine,
        "verdict": candidate.verdict,
        "agreed": f"{candidate.alignment.agreed:,}",
        "differs": f"event {divergence.event:,}, t = {divergence.time:.9g}" if divergence else "",
        "cause": str(candidate.diagnosis) if candidate.diagnosis else "",
        "evidence": candidate.diagnosis.evidence if candidate.diagnosis else "",
        "swaps": candidate.alignment.harmless_swaps,
        "error": short(candidate.separation.maximum),
        "changed": ", ".join(n.replace("_", " ") for n in candidate.changed)
        if candidate.verdict not in ("undecided", "unsettled")
        else "",
        "miss": short(candidate.return_miss),
        "stop": candidate.trajectory.stop.message,
        "parameters": ", ".join(f"{k} = {v}" for k, v in candidate.trajectory.parameters.items()),
    }


def _divergence(comparison: Comparison, candidate: Candidate) -> dict[str, Any]:
    drawn = len(comparison.scene.circles) <= PICTURED_CIRCLES
    return {
        "engine": candidate.engine,
        "phrase": divergence_phrase(comparison, candidate),
        "body": candidate.alignment.divergence.body if candidate.alignment.divergence else "",
        "cause": str(candidate.diagnosis) if candidate.diagnosis else "",
        "evidence": sentence_case(candidate.diagnosis.evidence) if candidate.diagnosis else "",
        "pattern": pattern_phrase(comparison, candidate),
        "consequence": consequence_phrase(comparison, candidate),
        "margin": margin_phrase(candidate),
        "experiments": experiment_rows(candidate),
        "rows": side_by_side(comparison, candidate),
        "picture": Markup(divergence_picture(comparison, candidate)) if drawn else "",
    }


def sentence_case(text: str) -> str:
    """The text with a capital first letter.

    >>> sentence_case("with a step")
    'With a step'
    """
    return text[:1].upper() + text[1:]


def _outcomes(comparison: Comparison) -> list[dict[str, Any]]:
    """Outcomes that are one number or short, side by side; those that differ marked."""
    rows = []
    for name, value in comparison.outcomes.items():
        cells = [
            {"text": _short_outcome(c.outcomes.get(name)), "differs": name in c.changed} for c in comparison.candidates
        ]
        rows.append({"name": name.replace("_", " "), "reference": _short_outcome(value), "cells": cells})
    return rows


SHOWN_OUTCOME = 160
"""Longest text of an outcome in the table; the JSON has it all."""


def _short_outcome(value: Any) -> str:
    if value is None:
        return "-"
    if isinstance(value, dict):
        text = ", ".join(f"{key}: {_short_outcome(item)}" for key, item in value.items())
    elif isinstance(value, list):
        text = " ".join(str(item) for item in value)
    else:
        text = str(value)
    return text if len(text) <= SHOWN_OUTCOME else f"{text[:SHOWN_OUTCOME]}…"
