"""Run time against error: one chaotic scene in every engine, each at several settings."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..alignment.align import align
from ..deadline import uninterrupted
from ..engines import engine

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory

SETTINGS = (
    "double",
    "interval:bits=53",
    "interval:bits=128",
    "interval:bits=512",
    "pymunk:dt=1/64",
    "pymunk:dt=1/1024",
    "pymunk:dt=1/16384",
)
"""What is set against the exact engine, cheapest setting of each engine first."""

SAMPLES = 1_000
"""Times at which positions are compared, evenly spread over the run."""


@dataclass(frozen=True)
class Tradeoff:
    """One engine at one setting.

    Attributes:
        engine: the engine and its setting, as the command line writes them.
        seconds: wall time of the run.
        ratio: that over the exact engine's wall time for the same run.
        agreed: events before the first divergence (or the stop).
        events: events of the exact run.
        reached: the time that the run got to, as a share of the exact run's.
        error: the largest distance of a circle from its exact place while both ran.
    """

    engine: str
    seconds: float
    ratio: float
    agreed: int
    events: int
    reached: float
    error: float


def tradeoffs(scene: Scene, events: int, settings: Iterable[str] = SETTINGS) -> Iterator[Tradeoff]:
    """The exact engine's own row, then one for each setting, all to one time just after an exact event."""
    end = between_events(scene, events)
    reference, exact_seconds = _timed("exact", scene, end)
    yield Tradeoff("exact", exact_seconds, 1.0, len(reference.events), len(reference.events), 1.0, 0.0)
    for text in settings:
        candidate, seconds = _timed(text, scene, end)
        step = float(candidate.parameters.get("dt", 0))
        yield Tradeoff(
            text,
            seconds,
            seconds / exact_seconds,
            align(reference, candidate, step=step).agreed,
            len(reference.events),
            float(candidate.final_time) / end,
            largest_distance(reference, candidate),
        )


def between_events(scene: Scene, events: int) -> float:
    """A time half-way between an exact event and the next, so that rounding decides nothing there."""
    before, after = uninterrupted(engine("exact").run(scene, events=events + 1)).events[-2:]
    return (float(before.time) + float(after.time)) / 2


def _timed(text: str, scene: Scene, until: float) -> tuple[Trajectory, float]:
    runner = engine(text)
    start = time.perf_counter()
    run = uninterrupted(runner.run(scene, until=until))
    return run, time.perf_counter() - start


def largest_distance(reference: Trajectory, candidate: Trajectory) -> float:
    """The largest distance between the two places of a circle, over sampled times while both ran."""
    end = min(float(reference.final_time), float(candidate.final_time))
    times = [end * k / SAMPLES for k in range(SAMPLES)]
    gap = reference.sample(times)[:, :, :2] - candidate.sample(times)[:, :, :2]
    return float(np.max(np.hypot(gap[:, :, 0], gap[:, :, 1]), initial=0.0))
