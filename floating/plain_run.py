"""From a finished plain loop to a trajectory."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ..exact.event_loop import Limits
from ..scenarios.scene import Scene
from ..scenarios.trajectory import Contact, Event, Motion, Pocketing, Reversal, Stop, StopReason, Trajectory
from .plain_loop import PlainLoop


def trajectory(
    scene: Scene,
    engine: str,
    parameters: Mapping[str, Any],
    loop: PlainLoop,
    limits: Limits,
    stop: Stop,
    motion: Callable[[list[list[tuple[Any, ...]]]], Motion],
) -> Trajectory:
    """The trajectory of a loop that has run to its end."""
    ids = scene.ids
    history = loop.history
    events = tuple(
        Event(
            index,
            record.time,
            tuple(Contact(ids[i], ids[j]) for i, j in record.links),
            tuple(Contact(ids[i], ids[j]) for i, j in record.impulses),
            record.ties,
            record.coupled,
        )
        for index, record in enumerate(history.records)
    )
    reversal = None
    if history.reversal is not None:
        reversal = Reversal(history.reversal[0], history.reversal[1])
    end: Any
    if stop.reason is StopReason.HORIZON:
        moment: Any = None if reversal is None else reversal.time
        end = 2 * moment if limits.to_return else limits.until
    else:
        end = events[-1].time if events else loop.machine.zero
    return Trajectory(
        scene=scene,
        engine=engine,
        parameters=parameters,
        events=events,
        stop=stop,
        final_time=end,
        motion=motion(history.knots),
        reversal=reversal,
        pocketings=tuple(
            Pocketing(str(ids[p.circle]), str(scene.pockets[p.pocket].id), p.time) for p in history.pocketings
        ),
        plan=dict(sorted(history.plan.items())),
    )
