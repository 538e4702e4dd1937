"""Runs the event loop in a finite precision, and makes a trajectory of what it gathered."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ..exact.numbers.system import M
from ..exact.policies import Policy
from ..exact.replay.contact import Named
from ..exact.simulation.history import Mark
from ..exact.simulation.limits import run_limits
from ..exact.simulation.loop import Loop
from ..scenarios.event import Event, Pocketing, Reversal
from ..scenarios.numbers.quantity import QuantityLike
from ..scenarios.scene import Scene
from ..scenarios.trajectory import Motion, OnProgress, StopReason, Trajectory
from .plain_decider import PlainDecider


def run_plain(
    scene: Scene,
    engine: str,
    parameters: Mapping[str, Any],
    decider: PlainDecider[M],
    motion: Callable[[list[list[tuple[Any, ...]]], Any], Motion],
    shown: Callable[[Any, int], Any],
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
        motion: makes the motion from knots (t, x, y, vx, vy, number of the instant) and the last time that may be
            asked for.
        shown: makes a time of the trajectory from a number and the number of its instant.
    """
    limits = run_limits(scene, until, events)
    stop = Loop(scene, decider, limits, progress, policy).run()
    ids, history, named = scene.ids, decider.history, Named(scene)

    def at(mark: Mark[M]) -> Any:
        return shown(mark.time, mark.number)

    reversal = None
    if history.reversal is not None:
        reversal = Reversal(history.reversal[0], at(history.reversal[1]))
    end: Any
    if stop.reason is StopReason.HORIZON and limits.to_return:
        assert history.reversal is not None
        assert history.last is not None
        time = history.reversal[1].time
        end = shown(time + time, history.last.number)
    elif stop.reason is StopReason.HORIZON:
        assert limits.until is not None
        late = history.last is not None and float(at(history.last)) > float(limits.until)
        end = at(history.last) if history.last is not None and late else limits.until  # rounded up, it let this in
    else:
        end = shown(decider.state.zero, 0) if history.last is None else at(history.last)
    return Trajectory(
        scene=scene,
        engine=engine,
        parameters=parameters,
        events=tuple(
            Event(
                index,
                at(record.mark),
                named(record.links),
                named(record.impulses),
                record.ties,
                record.coupled,
            )
            for index, record in enumerate(history.records)
        ),
        stop=stop,
        final_time=end,
        motion=motion([[(*knot[:5], knot[-1]) for knot in row] for row in history.knots], end),
        reversal=reversal,
        pocketings=tuple(
            Pocketing(str(ids[e.circle]), str(scene.pockets[e.pocket].id), at(e.mark)) for e in history.entries
        ),
        plan=dict(sorted(history.plan.items())),
    )
