"""Runs the event loop in a finite precision, and makes a trajectory of what it gathered."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, TypeAlias

from ...exact.numbers.system import M
from ...exact.policies import Policy
from ...exact.replay.contact import Named
from ...exact.simulation.history import Mark
from ...exact.simulation.limits import Limits, run_limits
from ...exact.simulation.loop import Loop
from ...scenarios.lazy import Late
from ...scenarios.numbers.quantity import QuantityLike, Real
from ...scenarios.scene import Scene
from ...scenarios.trajectory import Event, Motion, OnProgress, Pocketing, Reversal, StopReason, Trajectory
from .decider import PlainDecider

Passed: TypeAlias = tuple[M, M, M, M, M, int]
"""(t, x, y, vx, vy) of a circle from a knot on, and the number of the knot's instant."""


def run_plain(
    scene: Scene,
    engine: str,
    parameters: Mapping[str, Any],
    decider: PlainDecider[M],
    motion: Callable[[Sequence[Sequence[Passed[M]]], Real], Motion],
    shown: Callable[[M, int], Real],
    *,
    until: QuantityLike | None,
    events: int | None,
    progress: OnProgress | None,
    policy: Policy | None = None,
    loop: Callable[[Limits], Loop[M, M]] | None = None,
) -> Trajectory:
    """The trajectory of a scene in the numbers of a decider.

    Args:
        engine: its name.
        parameters: its settings.
        decider: keeps the state and decides.
        motion: makes the motion from the knots of each circle, and the last time that may be asked for.
        loop: makes the loop, where it is not the general one.
        shown: makes a time of the trajectory from a number and the number of its instant.
    """
    limits = run_limits(scene, until, events)
    stop = (Loop(scene, decider, limits, progress, policy) if loop is None else loop(limits)).run()
    ids, history, finish, named = scene.ids, decider.history, decider.finish, Named(scene)

    def at(mark: Mark[M]) -> Real:
        return shown(mark.time, mark.number)

    def events_of() -> Iterator[Event]:
        finish()
        for index, record in enumerate(history.records):
            impulses = named(record.impulses)
            yield Event(index, at(record.mark), named(record.links), impulses, record.ties, record.coupled)

    def knots_of() -> Iterator[list[Passed[M]]]:
        finish()
        for row in history.knots:
            yield [(t, x, y, vx, vy, number) for t, x, y, vx, vy, _, number in row]

    reversal = None
    if history.reversal is not None:
        reversal = Reversal(history.reversal[0], at(history.reversal[1]))
    end: Real
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
    decider.close()
    return Trajectory(
        scene=scene,
        engine=engine,
        parameters=parameters,
        events=Late(len(history.records), events_of),
        stop=stop,
        final_time=end,
        motion=motion(Late(len(history.knots), knots_of), end),
        reversal=reversal,
        pocketings=tuple(
            Pocketing(str(ids[e.circle]), str(scene.pockets[e.pocket].id), at(e.mark)) for e in history.entries
        ),
        plan=dict(sorted(history.plan.items())),
    )
