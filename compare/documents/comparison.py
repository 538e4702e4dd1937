"""A comparison as the JSON object `truebreak/comparison-1`."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from .amounts import plain
from .trajectory import assumptions_json, scene_json, stop_json

if TYPE_CHECKING:
    from ...scenarios.trajectory import Trajectory
    from ..alignment.separation import Separation
    from ..candidate import Candidate
    from ..comparison import Comparison
    from ..outcomes.permitted import PermittedPatterns

COMPARISON_SCHEMA = "truebreak/comparison-1"

REPORTED_SAMPLES = 50
"""Times at which the JSON gives the separation."""


def comparison_json(comparison: Comparison) -> dict[str, Any]:
    """The object that `truebreak compare --json` prints."""
    from ..report.sentences import verdict_sentence

    reference = comparison.reference
    return {
        "schema": COMPARISON_SCHEMA,
        "verdict": comparison.verdict,
        "sentence": verdict_sentence(comparison),
        "scene": scene_json(reference),
        "span": comparison.span,
        "reference": {
            "engine": reference.engine,
            "parameters": plain(reference.parameters),
            "events": len(reference.events),
            "stop": stop_json(reference.stop),
            "certified": reference.certified,
            "assumptions": assumptions_json(reference),
            "outcomes": plain(comparison.outcomes),
            "return_miss": comparison.return_miss,
            "notes": list(reference.notes),
            "seconds": comparison.seconds,
        },
        "candidates": [
            _marked(candidate_json(candidate, comparison.permitted), reference) for candidate in comparison.candidates
        ],
        "break_patterns": _patterns_json(comparison.permitted),
    }


def _marked(data: dict[str, Any], reference: Trajectory) -> dict[str, Any]:
    """The candidate, marked if what is said of it rests on less than proof in the reference."""
    divergence = data["first_divergence"]
    event = data["events_agreed"] if divergence is None else divergence["event"]
    assumption = reference.rests_on(event)
    data["rests_on"] = (
        None if assumption is None else {"event": assumption.event, "proof": assumption.proof.name.lower()}
    )
    return data


def candidate_json(candidate: Candidate, permitted: PermittedPatterns | None = None) -> dict[str, Any]:
    """One engine held against the reference."""
    run, alignment = candidate.trajectory, candidate.alignment
    return {
        "engine": candidate.engine,
        "parameters": plain(run.parameters),
        "verdict": candidate.verdict,
        "events_agreed": alignment.agreed,
        "first_divergence": _divergence_json(candidate),
        "cause": _cause_json(candidate),
        "harmless_swaps": alignment.harmless_swaps,
        "harmless_splits": alignment.harmless_splits,
        "position_error": _separation_json(candidate.separation),
        "outcomes": plain(candidate.outcomes),
        "break_pattern": _relation_json(candidate, permitted),
        "changed_outcomes": list(candidate.changed),
        "return_miss": candidate.return_miss,
        "stop": stop_json(run.stop),
        "seconds": candidate.seconds,
    }


def _divergence_json(candidate: Candidate) -> dict[str, Any] | None:
    divergence, margin = candidate.alignment.divergence, candidate.margin
    if divergence is None:
        return None
    return {
        "event": divergence.event,
        "time": divergence.time,
        "body": divergence.body,
        "expected": divergence.expected,
        "got": divergence.got,
        "kind": divergence.kind.value,
        "expected_time": divergence.expected_time,
        "got_time": divergence.got_time,
        "cause": str(candidate.cause) if candidate.cause else None,
        "margin": margin.gap if margin else None,
        "margin_ulps": margin.ulps if margin else None,
        "miss_distance": margin.miss if margin else None,
    }


def _relation_json(candidate: Candidate, permitted: PermittedPatterns | None) -> dict[str, str | None] | None:
    """What the candidate's break pattern is among those that the exact engine has under several policies."""
    pattern = candidate.outcomes.get("break_pattern")
    if permitted is None or pattern is None or candidate.verdict == "undecided":
        return None
    return {"relation": permitted.relation(pattern).name.lower(), "policy": permitted.policy(pattern)}


def _patterns_json(permitted: PermittedPatterns | None) -> dict[str, Any] | None:
    """The break patterns that the reference engine has under other orders of simultaneous impulses."""
    if permitted is None:
        return None
    return {
        "by_policy": plain(permitted.by_policy),
        "all_orders": plain(permitted.orders),
        "complete": permitted.complete,
    }


def _cause_json(candidate: Candidate) -> dict[str, str] | None:
    if candidate.cause is None:
        return None
    return {"name": candidate.cause.name.value, "evidence": candidate.cause.evidence}


def _separation_json(separation: Separation) -> dict[str, Any]:
    few = separation.thinned(REPORTED_SAMPLES)
    return {
        "times": list(few.times),
        "max": [value if math.isfinite(value) else None for value in few.largest],
        "final": separation.final if math.isfinite(separation.final) else None,
        "largest": separation.maximum if math.isfinite(separation.maximum) else None,
        "circle": separation.circle,
    }
