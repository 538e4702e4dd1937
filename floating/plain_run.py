"""Runs the event loop in a finite precision, and makes a trajectory of what it gathered."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ..exact.policies import Policy
from ..exact.simulation.limits import run_limits
from ..exact.simulation.loop import Loop
from ..scenarios.quantity import QuantityLike
from ..scenarios.scene import Scene
from ..scenarios.trajectory import Contact, Event, Motion, OnProgress, Pocketing, Reversal, StopReason, Trajectory
from .plain_decider import PlainDecider


def run_plain(
    scene: Scene,
    engine: str,
    parameters: Mapping[str, Any],
    decider: PlainDecider,
    motion: Callable[[list[list[tuple[Any, ...]]], Any], Motion],
    shown: Callable[[Any], Any],
    *,
    until: QuantityLike | None,
    events: int | None,
    progress: OnProgress | None,
    policy: Policy | None = None,
) -> Trajectory:
    """The trajectory of a scene in the numbers of a decider.

    Args:
        engine: its name.
        parameters: its settings.
        decider: keeps the state and decides.
        motion: makes the motion from knots (t, x, y, vx, vy) and the last time that may be asked for.
        shown: makes a time of the trajectory from a number.
    """
    limits = run_limits(scene, until, events)
    stop = Loop(scene, decider, limits, progress, policy).run()
    ids, history = scene.ids, decider.history
    reversal = None
    if history.reversal is not None:
        reversal = Reversal(history.reversal[0], shown(history.reversal[1].time))
    end: Any
    if stop.reason is StopReason.HORIZON and limits.to_return:
        assert history.reversal is not None
        time = history.reversal[1].time
        end = shown(time + time)
    elif stop.reason is StopReason.HORIZON:
        end = limits.until
    else:
        end = shown(decider.machine.zero if history.last is None else history.last.time)
    return Trajectory(
        scene=scene,
        engine=engine,
        parameters=parameters,
        events=tuple(
            Event(
                index,
                shown(record.mark.time),
                tuple(Contact(ids[i], ids[j]) for i, j in record.links),
                tuple(Contact(ids[i], ids[j]) for i, j in record.impulses),
                record.ties,
                record.coupled,
            )
            for index, record in enumerate(history.records)
        ),
        stop=stop,
        final_time=end,
        motion=motion([[knot[:5] for knot in row] for row in history.knots], end),
        reversal=reversal,
        pocketings=tuple(
            Pocketing(str(ids[e.circle]), str(scene.pockets[e.pocket].id), shown(e.mark.time)) for e in history.entries
        ),
        plan=dict(sorted(history.plan.items())),
    )
