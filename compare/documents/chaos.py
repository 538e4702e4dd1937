"""Chaos along one run as the JSON object `truebreak/chaos-1`."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from .trajectory import scene_json, stop_json
from .values.amounts import double

if TYPE_CHECKING:
    from ..chaos.chaos import Chaos
    from ..chaos.growth.blocks import Rate
    from ..chaos.horizon import EventTime, Horizon

CHAOS_SCHEMA = "truebreak/chaos-1"

CONVERGENCE_POINTS = 20
"""How many estimates of the largest exponent show how it converges."""


def chaos_json(chaos: Chaos) -> dict[str, Any]:
    """The object that `truebreak chaos --json` prints; exponents are natural logarithms per unit time."""
    found = chaos.spectrum
    return {
        "schema": CHAOS_SCHEMA,
        "scene": scene_json(chaos.reference),
        "events": chaos.events,
        "time": double(chaos.time),
        "stop": stop_json(chaos.reference.stop),
        "certified": chaos.reference.certified,
        "lyapunov": {
            **rate_json(found.per_time()),
            "per_event": rate_json(found.per_event()),
            "bits_per_time": found.per_time().value / math.log(2),
            "bits_per_event": found.per_event().value / math.log(2),
            "left_out": found.skipped,
            "linear": double(found.linear),
            "told_from_zero": found.chaotic,
        },
        "convergence": [
            {"event": event, "time": double(time), "value": double(value)}
            for event, time, value in found.running(CONVERGENCE_POINTS)
        ],
        "spectrum": {
            "dimension": found.dimension,
            "exponents": [rate_json(found.per_time(k)) for k in range(found.gains.shape[1])],
            "pairing": found.pairing(),
            "volume": found.volume(),
        },
        "entropy": None if (entropy := found.entropy()) is None else rate_json(entropy),
        "growth": {
            "certified": None
            if (told := chaos.certified) is None
            else {"events": told.events, "bits": [told.low, told.high], "precision": told.bits},
            "curve": [{"event": g.event, "time": double(g.time), "bits": double(g.bits)} for g in chaos.growth],
        },
        "horizons": [horizon_json(horizon) for horizon in chaos.horizons],
        "exact": list(chaos.exact),
    }


def rate_json(rate: Rate) -> dict[str, Any]:
    """A rate with its interval, `value` first."""
    return {"value": rate.value, "low": rate.low, "high": rate.high, "blocks": rate.blocks}


def horizon_json(horizon: Horizon) -> dict[str, Any]:
    """Where an engine is expected to leave the history, and where it did."""
    seen = horizon.seen
    return {
        "engine": horizon.engine,
        "model": horizon.model.name.lower(),
        "unit_bits": horizon.unit,
        "expected": place_json(horizon.expected),
        "low": place_json(horizon.low),
        "high": place_json(horizon.high),
        "by_exponent": None if horizon.by_exponent is None else double(horizon.by_exponent),
        "seen": None
        if seen is None
        else {
            "verdict": seen.verdict,
            "at": None if seen.place is None else place_json(seen.place),
            "held": None if seen.place is None else horizon.holds(seen.place),
        },
    }


def place_json(place: EventTime) -> dict[str, Any]:
    """An event and its time; null beyond the run."""
    return {"event": place.event, "time": None if place.time is None else double(place.time)}
