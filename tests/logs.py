"""Logs of this project's own engines, as a program in any language would write them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from truebreak.scenarios import Scene, Trajectory


def lines_of(run: Trajectory, *, states: bool = False) -> list[dict[str, Any]]:
    """A line for each event."""
    return [_line(run, place, states) for place in range(len(run.events))]


def _line(run: Trajectory, place: int, states: bool) -> dict[str, Any]:
    event = run.events[place]
    line: dict[str, Any] = {"time": float(event.time)}
    if len(event.impulses) == 1:
        line["contact"] = list(event.impulses[0])
    else:
        line["contacts"] = [list(pair) for pair in event.impulses]
    if states:
        names = {name for pair in event.impulses for name in pair}
        moving = {str(c.id) for c in run.scene.circles if not c.fixed} & names
        state = run.after(event.index)
        line["states"] = {name: [float(getattr(state[name], k)) for k in ("x", "y", "vx", "vy")] for name in moving}
    return line


def written(path: Path, lines: list[dict[str, Any]]) -> str:
    """The path of a file of these lines."""
    path.write_text("".join(f"{json.dumps(line)}\n" for line in lines), "utf-8")
    return str(path)


def triples(run: Trajectory) -> list[tuple[float, str, str]]:
    """(time, a, b) of every impulse."""
    return [(float(e.time), *pair) for e in run.events for pair in e.impulses]


def without_limits(scene: Scene) -> Scene:
    """The scene with no horizon of its own."""
    return scene.with_changes(until=None, events=None)
