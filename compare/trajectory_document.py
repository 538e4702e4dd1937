"""A trajectory as the JSON object `truebreak/trajectory-1`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .amounts import bounds, double, plain
from .exact_texts import ExactTexts

if TYPE_CHECKING:
    from ..scenarios.trajectory import Event, State, Stop, Trajectory

TRAJECTORY_SCHEMA = "truebreak/trajectory-1"


def trajectory_json(trajectory: Trajectory, *, exact: bool = False) -> dict[str, Any]:
    """The object that `truebreak run --json` prints.

    Times and coordinates are the nearest doubles; null stands for one beyond the doubles. An engine of
    intervals adds the bounds as `..._interval`.

    Args:
        exact: add each time and coordinate as exact text, under `..._exact`. Values of too many nested roots
            refer to `definitions`, each a text of numbers and of the definitions before it.
    """
    texts = ExactTexts() if exact else None
    final = state_json(trajectory.final, texts)
    data: dict[str, Any] = {
        "schema": TRAJECTORY_SCHEMA,
        "scene": scene_json(trajectory),
        "engine": {"name": trajectory.engine, "parameters": plain(trajectory.parameters)},
        "stop": stop_json(trajectory.stop),
        "certified": trajectory.certified,
        "collisions": trajectory.collisions,
        "events": [event_json(event, texts) for event in trajectory.events],
        "final": final,
        "plan": plain(trajectory.plan),
    }
    if trajectory.reversal is not None:
        data["reversal"] = {
            "after": trajectory.reversal.after,
            **amount("time", trajectory.reversal.time, texts),
        }
    if trajectory.notes:
        data["notes"] = list(trajectory.notes)
    if trajectory.scene.pockets:
        data["pocketed"] = [
            {"circle": entry.circle, "pocket": entry.pocket, **amount("time", entry.time, texts)}
            for entry in trajectory.pocketings
        ]
    definitions = texts.finish() if texts is not None else {}
    if definitions:
        data["definitions"] = definitions
    return data


def scene_json(trajectory: Trajectory) -> dict[str, Any]:
    """The scene by name and digest, and the tie policy that held."""
    scene = trajectory.scene
    return {"name": scene.name, "digest": scene.digest, "tie_policy": str(scene.tie_policy)}


def stop_json(stop: Stop) -> dict[str, Any]:
    """Why a run ended."""
    return {"reason": stop.reason.name.lower(), "message": stop.message}


def event_json(event: Event, texts: ExactTexts | None = None) -> dict[str, Any]:
    """One instant; `ties` only where several contacts fell on it."""
    data: dict[str, Any] = {
        "index": event.index,
        **amount("time", event.time, texts),
        "contacts": [list(pair) for pair in event.contacts],
        "impulses": [list(pair) for pair in event.impulses],
    }
    if event.ties:
        data["ties"] = [
            {
                "contacts": [list(pair) for pair in tie.contacts],
                "proof": tie.proof.name.lower(),
                "proved": tie.proof.proved,
                **({} if tie.bound is None else {"bound": tie.bound}),
            }
            for tie in event.ties
        ]
    if event.coupled:
        data["coupled"] = True
    return data


def state_json(state: State, texts: ExactTexts | None = None) -> dict[str, Any]:
    """All circles at one time."""
    circles = []
    for circle in state.circles:
        row: dict[str, Any] = {"id": circle.id}
        for key in ("x", "y", "vx", "vy"):
            row.update(amount(key, getattr(circle, key), texts))
        circles.append(row)
    return {**amount("time", state.time, texts), "circles": circles}


def amount(key: str, value: Any, texts: ExactTexts | None) -> dict[str, Any]:
    """One number under its key: the nearest double, bounds if it is an interval, exact text if asked for.

    >>> amount("x", 0.5, ExactTexts())
    {'x': 0.5, 'x_exact': '1/2'}
    """
    data: dict[str, Any] = {key: double(value)}
    interval = bounds(value)
    if interval is not None:
        data[f"{key}_interval"] = list(interval)
    elif texts is not None:
        texts.put(data, key, value)
    return data
