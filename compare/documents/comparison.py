"""A comparison as the JSON object `truebreak/comparison-4`."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from .laws import laws_json
from .trajectory import assumptions_json, scene_json, stop_json
from .values.amounts import plain

if TYPE_CHECKING:
    from ...scenarios.trajectory import Trajectory
    from ..alignment.align import Separation
    from ..candidate import Candidate
    from ..causes.diagnosis import Margin
    from ..comparison import Comparison
    from ..outcomes.permitted import PermittedPatterns

COMPARISON_SCHEMA = "truebreak/comparison-4"

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
        "span": comparison.span if math.isfinite(comparison.span) else None,
        "reference": {
            "engine": reference.engine,
            "parameters": plain(reference.parameters),
            "events": len(reference.events),
            "stop": stop_json(reference.stop),
            "certified": reference.certified and comparison.certain,
            "assumptions": assumptions_json(reference),
            "outcomes": plain(comparison.outcomes),
            "return_miss": comparison.return_miss,
            "notes": list(reference.notes),
            "seconds": comparison.seconds,
            **({} if comparison.certificate is None else comparison.certificate.data()),
        },
        "candidates": [
            _marked(candidate_json(candidate, comparison.permitted), reference) for candidate in comparison.candidates
        ],
        "patterns": _patterns_json(comparison.permitted),
        "left_out": list(comparison.cut),
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
        "laws": laws_json(candidate.laws),
        "events_agreed": alignment.agreed,
        "first_divergence": _divergence_json(candidate),
        "causes": _causes_json(candidate),
        "harmless_swaps": alignment.harmless_swaps,
        "harmless_splits": alignment.harmless_splits,
        "position_error": _separation_json(candidate.separation),
        "outcomes": plain(candidate.outcomes),
        "pattern": _relation_json(candidate, permitted),
        "changed_outcomes": list(candidate.changed),
        "outcomes_until": candidate.until,
        "outcomes_expected": None if candidate.whole else plain(candidate.expected),
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
        "cause": str(candidate.diagnosis) if candidate.diagnosis else None,
        "margin": None if margin is None else _margin_json(margin),
    }


def _margin_json(margin: Margin) -> dict[str, Any]:
    ratio = margin.ratio
    return {
        "time": None if margin.gap is None else list(margin.gap),
        "ulps": margin.ulps,
        "distance": None if margin.distance is None else list(margin.distance),
        "position_error": margin.error,
        "ratio": ratio if ratio is not None and math.isfinite(ratio) else None,
        "growth_bits_per_event": margin.growth,
    }


def _relation_json(candidate: Candidate, permitted: PermittedPatterns | None) -> dict[str, Any] | None:
    """Which class the candidate's pattern is in, and the policy or the nearby scene that leads to it."""
    pattern = candidate.pattern
    if permitted is None or pattern is None or candidate.verdict != "diverged":
        return None
    witness = permitted.witness(pattern)
    told = {
        "relation": permitted.relation(pattern).name.lower(),
        "policy": permitted.policy(pattern),
        "witness": None if witness is None else witness.scene.data(),
    }
    if witness is not None and witness.certificate is not None:
        told["witness_certificate"] = witness.certificate.data()
    return told


def _patterns_json(permitted: PermittedPatterns | None) -> dict[str, Any] | None:
    """The patterns that the reference engine has under other policies and orders, and in nearby scenes."""
    if permitted is None:
        return None
    return {
        "by_policy": plain(permitted.by_policy),
        "all_orders": plain(permitted.orders),
        "complete": permitted.complete,
        "orders_followed": permitted.followed,
        "realisable": [plain(w.pattern) for w in permitted.witnesses],
        "nearby_tried": permitted.tried,
    }


def _causes_json(candidate: Candidate) -> dict[str, Any] | None:
    found = candidate.diagnosis
    if found is None:
        return None
    return {
        "names": [cause.value for cause in found.causes],
        "displacement": found.displacement,
        "closed": found.closed,
        "continuations": found.runs,
        "evidence": found.finding,
        "sufficient": [cause.value for cause in found.sufficient],
        "experiments": [
            {
                "cause": e.cause.value,
                "suffices": e.suffices,
                "displacement": e.displacement,
                "share": e.share,
                "result": e.result,
            }
            for e in found.experiments
        ],
    }


def _separation_json(separation: Separation) -> dict[str, Any]:
    few = separation.thinned(REPORTED_SAMPLES)
    return {
        "times": list(few.times),
        "max": [value if math.isfinite(value) else None for value in few.largest],
        "final": separation.final if math.isfinite(separation.final) else None,
        "largest": separation.maximum if math.isfinite(separation.maximum) else None,
        "circle": separation.circle,
    }
