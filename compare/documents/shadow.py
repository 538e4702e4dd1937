"""What came of looking for a shadow, as the JSON object `truebreak/shadow-1`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .values.amounts import double

if TYPE_CHECKING:
    from ..alignment.instants import Divergence
    from ..shadowing.shadow import Proof, Shadow

SHADOW_SCHEMA = "truebreak/shadow-1"


def shadow_json(told: Shadow, best: Shadow | None = None) -> dict[str, Any]:
    """The object that `truebreak shadow --json` prints.

    Args:
        best: the shadow of a shorter beginning, where one was looked for and found.
    """
    return {
        "schema": SHADOW_SCHEMA,
        "scene": {"name": told.scene.name, "digest": told.scene.digest},
        "engine": told.engine,
        "events": told.events,
        "divergence": None if told.divergence is None else _divergence(told.divergence),
        "proof": None if told.proof is None else _proof(told.proof),
        "obstacle": None
        if told.blocked is None
        else {
            "kind": told.blocked.obstacle.name.lower(),
            "event": told.blocked.event,
            "message": told.blocked.message,
        },
        "drift": told.drift,
        "misfits": [] if told.refinement is None else [double(value) for value in told.refinement.misfits],
        "shorter": None
        if best is None or best is told or best.proof is None
        else {"events": best.events, "proof": _proof(best.proof)},
    }


def _divergence(left: Divergence) -> dict[str, Any]:
    return {
        "event": left.event,
        "time": double(left.time),
        "body": left.body,
        "expected": left.expected,
        "got": left.got,
    }


def _proof(proof: Proof) -> dict[str, Any]:
    return {
        "digest": proof.scene.digest,
        "start": {"position": proof.start.position, "velocity": proof.start.velocity},
        "run": {
            "position": proof.run_distance.position,
            "velocity": proof.run_distance.velocity,
            "time": proof.run_distance.time,
            "circle": proof.run_distance.circle,
        },
        "swaps": proof.swaps,
        "certified": proof.run.certified,
    }
