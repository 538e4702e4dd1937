"""A trajectory as the JSON object `truebreak/trajectory-1`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, SupportsFloat

from ...scenarios.numbers.quantity import real
from ..deadline import Clock
from .values.amounts import bounds, double, plain
from .values.exact_texts import ExactTexts

if TYPE_CHECKING:
    from ...scenarios.trajectory import Assumption, Event, State, Stop, Trajectory

TRAJECTORY_SCHEMA = "truebreak/trajectory-1"


def trajectory_json(trajectory: Trajectory, *, exact: bool = False, watch: Clock | None = None) -> dict[str, Any]:
    """The object that `truebreak run --json` prints.

    Times and coordinates are the nearest doubles; null stands for one beyond the doubles. An engine of
    intervals adds the bounds as `..._interval`.

    Args:
        exact: add each time and coordinate as exact text, under `..._exact`. Values of too many nested roots
            refer to `definitions`, each a text of numbers and of the definitions before it.
        watch: the user's seconds; once they are over, every value that is left does.
    """
    texts = ExactTexts(watch=watch or Clock(None)) if exact else None
    data: dict[str, Any] = {
        "schema": TRAJECTORY_SCHEMA,
        "scene": scene_json(trajectory),
        "engine": {"name": trajectory.engine, "parameters": plain(trajectory.parameters)},
        "stop": stop_json(trajectory.stop),
        "certified": trajectory.certified,
        "collisions": trajectory.collisions,
        "events": [event_json(event, texts, trajectory.rests_on(event.index)) for event in trajectory.events],
        "final": state_json(trajectory.final, texts),
        "plan": plain(trajectory.plan),
    }
    if trajectory.reversal is not None:
        data["reversal"] = {"after": trajectory.reversal.after}
        put(data["reversal"], "time", trajectory.reversal.time, texts)
    if trajectory.assumptions:
        data["assumptions"] = assumptions_json(trajectory)
    if trajectory.notes:
        data["notes"] = list(trajectory.notes)
    if trajectory.scene.pockets:
        data["pocketed"] = [{"circle": entry.circle, "pocket": entry.pocket} for entry in trajectory.pocketings]
        for row, entry in zip(data["pocketed"], trajectory.pocketings, strict=True):
            put(row, "time", entry.time, texts)
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


def assumptions_json(trajectory: Trajectory) -> list[dict[str, Any]]:
    """What a history rests on beyond proof, in order."""
    return [
        {"event": a.event, "question": a.question, "proof": a.proof.name.lower(), "bound": a.bound}
        for a in trajectory.assumptions
    ]


def event_json(event: Event, texts: ExactTexts | None = None, rests_on: Assumption | None = None) -> dict[str, Any]:
    """One instant; `ties` only where several contacts fell on it, `rests_on` only after less than proof."""
    data: dict[str, Any] = {"index": event.index}
    put(data, "time", event.time, texts)
    data["contacts"] = [list(pair) for pair in event.contacts]
    data["impulses"] = [list(pair) for pair in event.impulses]
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
    if rests_on is not None:
        data["rests_on"] = {"event": rests_on.event, "proof": rests_on.proof.name.lower()}
    return data


def state_json(state: State, texts: ExactTexts | None = None) -> dict[str, Any]:
    """All circles at one time."""
    data: dict[str, Any] = {}
    put(data, "time", state.time, texts)
    data["circles"] = [{"id": circle.id} for circle in state.circles]
    for row, circle in zip(data["circles"], state.circles, strict=True):
        for key in ("x", "y", "vx", "vy"):
            put(row, key, getattr(circle, key), texts)
    return data


def put(row: dict[str, Any], key: str, value: SupportsFloat, texts: ExactTexts | None) -> None:
    """Puts one number into a row: the nearest double, bounds if it is an interval, exact text if asked for.

    >>> row = {}
    >>> put(row, "x", 0.5, ExactTexts())
    >>> row
    {'x': 0.5, 'x_exact': '1/2'}
    """
    row[key] = double(value)
    number = real(value)
    interval = bounds(number)
    if interval is not None:
        row[f"{key}_interval"] = list(interval)
    elif texts is not None:
        texts.put(row, key, number)
