"""Runs an engine beside a certified run no further than it takes to see it leave."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ...exact.exact_engine import ExactEngine
from ...scenarios.trajectory import Stop, StopReason
from ..study import Study, run_or_unable

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.trajectory import Trajectory
    from ..alignment.align import Alignment

FIRST_EVENTS = 32
"""Events compared at first where nothing is foreseen."""

FARTHER = 4


@dataclass(frozen=True)
class Followed:
    """An engine's run up to where it left, or to the end.

    Attributes:
        study: the reference as far as it was compared.
        run, alignment: of the engine.
        unable: whether it could not take the scene at all.
    """

    study: Study
    run: Trajectory
    alignment: Alignment
    unable: bool


def prefix(trajectory: Trajectory, events: int) -> Trajectory:
    """The first events of a run as a run of its own, which ends at the last of them.

    Only of a scene without reversal and pockets, where nothing but events happens.

    >>> from truebreak.scenarios import catalogue
    >>> run = prefix(ExactEngine().run(catalogue.build("gas:n=3"), events=20), 5)
    >>> len(run.events), run.final_time is run.events[-1].time
    (5, True)
    """
    stop = Stop(StopReason.EVENTS, f"{StopReason.EVENTS.value} ({events})")
    return replace(
        trajectory, events=trajectory.events[:events], stop=stop, final_time=trajectory.events[events - 1].time
    )


def follow(
    reference: Trajectory,
    engine: Engine,
    foreseen: int | None = None,
    pay: Callable[[Engine, int], None] | None = None,
) -> Followed:
    """Runs an engine over ever more of a certified run, until it has left it or all is compared.

    A longer span takes no divergence back, and names no other as the first, so what is found early is what a
    comparison over all of the run finds.

    Args:
        foreseen: the event by which it is expected to have left.
        pay: as `Study.pay`.
    """
    for events in _spans(reference, foreseen):
        part = reference if events == len(reference.events) else prefix(reference, events)
        study = Study(reference.scene, ExactEngine(), part, longest=reference, pay=pay)
        run, alignment, unable = run_or_unable(study, engine, None)
        if unable or alignment.divergence is not None or alignment.undecided or part is reference:
            return Followed(study, run, alignment, unable)
    raise AssertionError("the last span is all of the run")


def _spans(reference: Trajectory, foreseen: int | None) -> Iterator[int]:
    scene, total = reference.scene, len(reference.events)
    events = FIRST_EVENTS if foreseen is None else foreseen
    if not (scene.pockets or scene.reverse_after or scene.reverse_at):
        while events < total:
            yield events
            events *= FARTHER
    yield total
